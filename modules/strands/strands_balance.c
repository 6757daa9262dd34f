// Rest shapes: the curvature and the twist of a rod in which the given shape is in balance, is free of force, or straight.
// One strand after another, in double: the README's recursion from the tip.
#include "strands_internal.h"

typedef struct vec
{
    double x, y, z;
} vec;

static vec make( wisp_vec3 v )
{
    return ( vec ){ (double)v.x, (double)v.y, (double)v.z };
}

static vec scale( vec v, double s )
{
    return ( vec ){ v.x * s, v.y * s, v.z * s };
}

static vec add( vec a, vec b )
{
    return ( vec ){ a.x + b.x, a.y + b.y, a.z + b.z };
}

static vec sub( vec a, vec b )
{
    return ( vec ){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static double dot( vec a, vec b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vec cross( vec a, vec b )
{
    return ( vec ){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

static vec unit( vec v, vec otherwise )
{
    const double length = sqrt( dot( v, v ) );
    return length > 0.0 ? scale( v, 1.0 / length ) : otherwise;
}

// A strand as it was added, and what the recursion hands from vertex to vertex.
typedef struct strand_shape
{
    const strands_rows* rows;
    int row, count, lane;
    vec growth; // direction of the clamp
} strand_shape;

// Direction of segment s at rest; -1 is the clamp. Without a length it goes on as the one before.
static vec direction( const strand_shape* shape, int s )
{
    for ( ; s >= 0; --s )
    {
        const vec e = sub( make( strands_get( shape->rows->rest, shape->row + s + 1, shape->lane ) ),
                           make( strands_get( shape->rows->rest, shape->row + s, shape->lane ) ) );
        if ( dot( e, e ) > 0.0 )
        {
            return unit( e, e );
        }
    }
    return shape->growth;
}

static strand_shape shape_of( const strands_rows* rows, int row, int count, int lane )
{
    strand_shape shape = { rows, row, count, lane, { 0.0, 0.0, 1.0 } };
    for ( int s = 0; s + 1 < count; ++s )
    {
        const vec e = sub( make( strands_get( rows->rest, row + s + 1, lane ) ),
                           make( strands_get( rows->rest, row + s, lane ) ) );
        if ( dot( e, e ) > 0.0 )
        {
            shape.growth = unit( e, e );
            break;
        }
    }
    return shape;
}

// What holds at vertex s, between segments s - 1 and s.
typedef struct balance
{
    vec moment;     // M_s
    double twist;   // T_s
    double load;    // b_s
    vec pull;       // T_s kb_s
    double tension; // alpha_s, of segment s
    double mass;    // kg, behind segment s - 1
} balance;

// M_s with T_s still unknown is A - T_s kb_s / 2, and b_s = d . (z x M_s) with d = t_s - t_{s-1}, so the balance of the twist is
// linear in T_s: the fixed point that both have together, at once. kb_s is across z, so it has no part in alpha_s.
static balance step( const strand_shape* shape, int s, wisp_vec3 gravity, balance behind )
{
    const vec t = direction( shape, s ), before = direction( shape, s - 1 ), bend = sub( t, before );
    const vec z = unit( add( t, before ), t );
    const double fold = fmax( 1.0 + dot( before, t ), 0.1 ); // as the kernel cuts it
    const vec binormal = scale( cross( before, t ), 2.0 / fold );
    const double w = (double)shape->rows->weight[strands_scalar( shape->row + s + 1, shape->lane )];
    const double l = (double)shape->rows->length[strands_scalar( shape->row + s, shape->lane )];
    // a pinned vertex bears what hangs from it
    const double mass = w > 0.0 ? behind.mass + 1.0 / w : 0.0;
    vec free = add( behind.moment, scale( make( gravity ), l * mass ) );
    free = sub( free, scale( behind.pull, 0.5 ) );
    const double along = l * dot( t, z );
    balance out = { .mass = mass };
    out.tension = along > 0.0 ? dot( free, z ) / along : 0.0;
    const vec across = sub( free, scale( t, l * out.tension ) );
    out.twist = ( behind.twist - 0.5 * behind.load - 0.5 * dot( bend, cross( z, across ) ) ) /
                ( 1.0 - 0.25 * dot( bend, cross( z, binormal ) ) );
    out.moment = sub( across, scale( binormal, 0.5 * out.twist ) );
    out.load = dot( bend, cross( z, out.moment ) );
    out.pull = scale( binormal, out.twist );
    return out;
}

// ---- into columns ----

typedef struct curve_job
{
    const strands_rows* rows;
    const strands_settings* settings;
    const float* stiffness;
    const float* clamp;
    float *rest, *rest_twist, *twist_stiffness, *rest_tension;
    double dt;
} curve_job;

// Into the middle frame of two neighbours, as the kernel takes it out again.
static wisp_vec3 into_middle( wisp_quat a, wisp_quat b, wisp_vec3 k )
{
    const float same = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w < 0.0f ? -1.0f : 1.0f;
    const wisp_quat sum = { a.x + same * b.x, a.y + same * b.y, a.z + same * b.z, a.w + same * b.w };
    const wisp_quat middle = wisp_rigid_make( sum, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ).rotation;
    return wisp_quat_turn_back( middle, k );
}

static void put_vertex( const curve_job* job, int row, int lane, wisp_vec3 k, double half_twist,
                        double twist_stiffness )
{
    strands_put( job->rest, row, lane, k );
    float* twist = job->rest_twist + (size_t)row * 2 * WISP_LANES + lane;
    twist[0] = (float)cos( half_twist );
    twist[WISP_LANES] = (float)sin( half_twist );
    job->twist_stiffness[strands_scalar( row, lane )] = (float)twist_stiffness;
}

// GJ / L_i, lowered with EI / L_i so that their ratio stays.
static double twist_stiffness_of( const curve_job* job, const strand_shape* shape, int s )
{
    const double bend = (double)job->stiffness[strands_scalar( shape->row + s, shape->lane )];
    const double rigidity = (double)job->settings->bend_rigidity;
    return rigidity > 0.0 ? bend * (double)job->settings->twist_rigidity / rigidity : 0.0;
}

// How much a moment bends or twists a vertex: with its stiffness, which was lowered to what a substep bears, and what the
// rest shape may do against it.
typedef struct hold
{
    double needed, most; // rad
} hold;

// Where the stiffness had to be lowered, more curvature holds the shape; but not so much that the rod becomes another one,
// which it would flail against: 30 % of its turn.
static hold hold_of( const strand_shape* shape, int s, double moment, double stiffness, double rigidity )
{
    const double reach = strands_reach( shape->rows, shape->row, s, shape->lane );
    const double turn = strands_sharpest_turn( shape->rows, shape->row, s, shape->count, shape->lane );
    return ( hold ){ .needed = stiffness > 0.0 ? moment / stiffness : 0.0,
                     .most = fmax( moment * reach / fmax( rigidity, 1e-300 ), 0.3 * turn ) };
}

// A tension that moves a vertex by more than the length of its segment in a substep pulls it to and fro.
static double tension_of( const curve_job* job, const strand_shape* shape, int s, double tension )
{
    const size_t at = strands_scalar( shape->row + s, shape->lane );
    const double w = fmax( (double)job->rows->weight[at], (double)job->rows->weight[at + WISP_LANES] );
    const double most = w > 0.0 ? (double)job->rows->length[at] / ( w * job->dt * job->dt ) : 0.0;
    return fmax( -most, fmin( most, tension ) );
}

// M_s and T_s bend and twist a vertex by so much.
static hold bend_of( const curve_job* job, const strand_shape* shape, int s, const balance* now )
{
    const double stiffness = (double)job->stiffness[strands_scalar( shape->row + s, shape->lane )];
    return hold_of( shape, s, sqrt( dot( now->moment, now->moment ) ), stiffness,
                    (double)job->settings->bend_rigidity );
}

static hold twist_of( const curve_job* job, const strand_shape* shape, int s, const balance* now )
{
    return hold_of( shape, s, fabs( now->twist ), twist_stiffness_of( job, shape, s ),
                    (double)job->settings->twist_rigidity );
}

// Rounding of the stiffness is no lack of it.
static double share_of( hold h )
{
    return h.needed > 1.001 * h.most ? h.most / h.needed : 1.0;
}

// Of its weight, what the strand can hold in this shape: all that the recursion hands on is in proportion to gravity. What it
// cannot hold it must not feel, because it would fall into a shape in which neither its curvature nor its tension is in balance,
// and they would throw it about (README). Only curls ask for so much.
static double share_of_weight( const curve_job* job, const strand_shape* shape )
{
    balance now = { .mass = 0.0 };
    double share = 1.0;
    for ( int s = shape->count - 2; s >= 0; --s )
    {
        now = step( shape, s, job->settings->gravity, now );
        const double turn = strands_sharpest_turn( shape->rows, shape->row, s, shape->count, shape->lane );
        if ( strands_is_curl( turn ) )
        {
            share = fmin( share, share_of( bend_of( job, shape, s, &now ) ) );
            share = fmin( share, share_of( twist_of( job, shape, s, &now ) ) );
        }
    }
    return share;
}

// k_i and the twist of every vertex, k_i still in the world. The twist that is there at rest is 0, because frames are laid
// from the clamp without any: so the rest twist is what gives T.
static void curve_vertices( const curve_job* job, const strand_shape* shape, double share )
{
    const bool balanced = job->settings->rest == WISP_STRAND_REST_BALANCED;
    const wisp_vec3 whole = job->settings->gravity;
    const float part = (float)share;
    const wisp_vec3 gravity = { part * whole.x, part * whole.y, part * whole.z };
    balance now = { .mass = 0.0 };
    for ( int s = shape->count - 2; s >= 0; --s )
    {
        now = step( shape, s, gravity, now );
        const double twist_stiffness = twist_stiffness_of( job, shape, s );
        vec k = sub( direction( shape, s ), direction( shape, s - 1 ) );
        double half_twist = 0.0;
        if ( balanced && job->stiffness[strands_scalar( shape->row + s, shape->lane )] > 0.0f )
        {
            const double moment = sqrt( dot( now.moment, now.moment ) );
            const hold bend = bend_of( job, shape, s, &now ), twist = twist_of( job, shape, s, &now );
            k = sub( k, scale( now.moment, moment > 0.0 ? fmin( bend.needed, bend.most ) / moment : 0.0 ) );
            half_twist = -copysign( atan( 0.5 * fmin( twist.needed, twist.most ) ), now.twist );
        }
        job->rest_tension[strands_scalar( shape->row + s, shape->lane )] =
            balanced ? (float)tension_of( job, shape, s, now.tension ) : 0.0f;
        put_vertex( job, shape->row + s, shape->lane, ( wisp_vec3 ){ (float)k.x, (float)k.y, (float)k.z }, half_twist,
                    twist_stiffness );
    }
}

// @return the share of its weight that the strand feels
static double curve_strand( const curve_job* job, int group, int row, int count, int lane )
{
    const strand_shape shape = shape_of( job->rows, row, count, lane );
    const double share = job->settings->rest == WISP_STRAND_REST_BALANCED ? share_of_weight( job, &shape ) : 1.0;
    curve_vertices( job, &shape, share );
    wisp_quat before = strands_get_quat( job->clamp, group, lane );
    for ( int s = 0; s + 1 < count; ++s )
    {
        const wisp_vec3 e = strands_sub( strands_get( job->rows->rest, row + s + 1, lane ),
                                         strands_get( job->rows->rest, row + s, lane ) );
        const wisp_quat frame = strands_carry_frame( before, e );
        const wisp_vec3 k = strands_get( job->rest, row + s, lane );
        strands_put( job->rest, row + s, lane, into_middle( before, frame, k ) );
        before = frame;
    }
    return share;
}

bool strands_balance_is_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    const strands_state* state = user;
    const float* balanced = wisp_frame_column( frame, entity, state->balance, 0 );
    return wisp_frame_strands( frame, entity )->group_count > 0 && balanced[0] != wisp_frame_seconds( frame );
}

// The stiffness that single precision bears depends on the substep, and with it the curvature that holds a shape.
void strands_balance_rest( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const strands_rows rows = strands_rows_in( frame, span->entity );
    const curve_job job = {
        .rows = &rows,
        .settings = wisp_frame_column( frame, span->entity, state->settings, 0 ),
        .stiffness = wisp_frame_column( frame, span->entity, state->rod, 1 ),
        .clamp = wisp_frame_column( frame, span->entity, state->clamp, 0 ),
        .rest = wisp_frame_column( frame, span->entity, state->curve, 1 ),
        .rest_twist = wisp_frame_column( frame, span->entity, state->curve, 2 ),
        .twist_stiffness = wisp_frame_column( frame, span->entity, state->curve, 3 ),
        .rest_tension = wisp_frame_column( frame, span->entity, state->curve, 4 ),
        .dt = (double)wisp_frame_seconds( frame ),
    };
    float* balanced = wisp_frame_column( frame, span->entity, state->balance, 0 );
    float* shares = wisp_frame_column( frame, span->entity, state->balance, 1 );
    uint64_t lightened = 0;
    for ( int g = span->begin; g < span->end; ++g )
    {
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            const int count = rows.topology->lane_count[g * WISP_LANES + lane];
            const double share = curve_strand( &job, g, rows.topology->group_row[g], count, lane );
            shares[g * WISP_LANES + lane] = (float)share;
            lightened += share < 1.0 ? 1 : 0;
        }
        balanced[g] = wisp_frame_seconds( frame );
    }
    if ( lightened > 0 )
    {
        wisp_frame_count( frame, WISP_COUNT_LIGHTENED, lightened );
    }
}
