// Contact of strands with one body in closed form, with Coulomb friction, sixteen strands at a time.
//
// Distances to the body are measured with its pose at the start and at the end of the substep. Let h be the
// thickness. A vertex must end at distance h. A vertex that began nearer, for example inside the body, may keep its
// depth, less the depth recovered in this substep:
//
//   allowed = tolerated depth, at most the depth at the start (or the depth at the start, if contact is new)
//   recovered <= recovery per call: position and previous position move together, so no velocity is added
//   push = h - (allowed - recovered) - distance, the remaining correction: represents the normal impulse
//
// The remaining depth comes from other constraints. It is corrected with velocity, otherwise a strand under tension
// would sink into the body. Friction follows, on the motion relative to the body's surface:
//
//   u = tangential part of f + (p - previous) - motion,   f' = u if |u| <= mu_s N, else mu_k N u / |u|,   p -= f' - f
//
// with the sums N of pushes and f of friction in the substep, so that friction in turns with lengths feels their tension.
// Turns converge slowly, so a vertex that one body pushes starts with N and f of the last substep, out = max( N, .. ), and
// turns may take back what they or this gave, out >= -N, so that N stays >= 0.
#include "pose.h"

#include "wisp/module/taper.h"

// Fraction of the thickness. A vertex allowed to be deeper than this keeps no velocity from its own outward motion.
static const float SHALLOW = 0.1f;

static const size_t STRIDE = 3 * WISP_LANES;

typedef struct contact_pose
{
    lane16v axis; // vector part of the rotation
    lane16 w;
    lane16v place;
} contact_pose;

// Values shared by all rows.
typedef struct contact_body
{
    lane16 radius, half_length;
    lane16v half;
    lane16 lower, upper, slope, sine; // of a tapered capsule, as in taper.h; its middle is the radius
    wisp_vec3 fallback;
    contact_pose before, after;
    lane16 thickness, shallow, recovery, static_friction, kinetic_friction;
    lane16 ball; // m, of a ball about the origin of its frame that holds it; infinite for a plane
} contact_body;

typedef struct contact_surface
{
    lane16v normal;
    lane16 distance;
} contact_surface;

static contact_pose spread_pose( wisp_transform pose )
{
    const wisp_quat q = pose.rotation;
    return ( contact_pose ){ lane16v_set1( ( wisp_vec3 ){ q.x, q.y, q.z } ), lane16_set1( q.w ),
                             lane16v_set1( pose.translation ) };
}

static float ball_around( const wisp_shape* s )
{
    const float radius = s->top_radius > s->bottom_radius ? s->top_radius : s->bottom_radius;
    const wisp_vec3 h = s->half_extent;
    switch ( s->kind )
    {
        case WISP_SHAPE_SPHERE:
            return s->radius;
        case WISP_SHAPE_CAPSULE:
            return s->radius + s->half_length;
        case WISP_SHAPE_BOX:
            return h.x + h.y + h.z;
        case WISP_SHAPE_TAPERED_CAPSULE:
            return radius + s->half_length;
        default:
            return INFINITY;
    }
}

static contact_body spread_body( const wisp_strand_contact_args* args )
{
    const bool is_tapered = args->shape.kind == WISP_SHAPE_TAPERED_CAPSULE;
    const wisp_taper t = is_tapered ? wisp_taper_of( &args->shape ) : ( wisp_taper ){ 0 };
    return ( contact_body ){
        .radius = lane16_set1( is_tapered ? (float)t.middle : args->shape.radius ),
        .half_length = lane16_set1( args->shape.half_length ),
        .lower = lane16_set1( (float)t.lower ),
        .upper = lane16_set1( (float)t.upper ),
        .slope = lane16_set1( (float)t.slope ),
        .sine = lane16_set1( (float)t.sine ),
        .fallback = { (float)t.cosine, (float)t.sine, 0.0f },
        .half = lane16v_set1( args->shape.half_extent ),
        .before = spread_pose( args->before ),
        .after = spread_pose( args->after ),
        .thickness = lane16_set1( args->thickness ),
        .shallow = lane16_set1( SHALLOW * args->thickness ),
        .recovery = lane16_set1( args->max_push_out ),
        .static_friction = lane16_set1( args->static_friction ),
        .kinetic_friction = lane16_set1( args->kinetic_friction ),
        .ball = lane16_set1( ball_around( &args->shape ) ),
    };
}

// A kind of body: loops over rows are compiled for each.
typedef struct contact_kind
{
    wisp_shape_kind shape;
    bool is_turned;
} contact_kind;

// Rotates v: v + 2 w (q x v) + 2 q x (q x v).
LANE_INLINE lane16v turn( contact_kind kind, lane16v q, lane16 w, lane16v v )
{
    lane16v t = lane16v_scale( lane16v_cross( q, v ), lane16_set1( 2.0f ) );
    return kind.is_turned ? lane16v_add( lane16v_mul_add( v, w, t ), lane16v_cross( q, t ) ) : v;
}

LANE_INLINE lane16v to_world( contact_kind kind, const contact_pose* pose, lane16v p )
{
    return lane16v_add( turn( kind, pose->axis, pose->w, p ), pose->place );
}

LANE_INLINE lane16v to_body( contact_kind kind, const contact_pose* pose, lane16v p )
{
    const lane16v q = { lane16_neg( pose->axis.x ), lane16_neg( pose->axis.y ), lane16_neg( pose->axis.z ) };
    return turn( kind, q, pose->w, lane16v_sub( p, pose->place ) );
}

// ---- closest points ----

// Returns the surface around a point, with `away` the vector from that point.
LANE_INLINE contact_surface around( lane16v away, lane16 radius, wisp_vec3 fallback )
{
    lane16 length = lane16v_length( away );
    lane16m has_normal = lane16_gt( length, lane16_zero() );
    lane16v normal = lane16v_scale( away, lane16_div( lane16_set1( 1.0f ), length ) );
    return ( contact_surface ){ lane16v_select( has_normal, normal, lane16v_set1( fallback ) ),
                                lane16_sub( length, radius ) };
}

static lane16 clamp( lane16 x, lane16 half )
{
    return lane16_min( lane16_max( x, lane16_neg( half ) ), half );
}

static lane16 with_sign_of( float size, lane16 x )
{
    return lane16_select( lane16_lt( x, lane16_zero() ), lane16_set1( -size ), lane16_set1( size ) );
}

// Returns the nearest face for a point inside or on the surface; the first of equals.
static contact_surface inside_box( lane16v p, lane16v half )
{
    lane16 zero = lane16_zero();
    lane16 x = lane16_sub( lane16_abs( p.x ), half.x ), y = lane16_sub( lane16_abs( p.y ), half.y );
    lane16 z = lane16_sub( lane16_abs( p.z ), half.z ), most = lane16_max( x, y );
    lane16m is_z = lane16_gt( z, most ), is_y = lane16m_and_not( lane16_gt( y, x ), is_z );
    lane16m is_x = lane16m_not( lane16m_or( is_y, is_z ) );
    lane16v normal = {
        lane16_select( is_x, with_sign_of( 1.0f, p.x ), zero ),
        lane16_select( is_y, with_sign_of( 1.0f, p.y ), zero ),
        lane16_select( is_z, with_sign_of( 1.0f, p.z ), zero ),
    };
    return ( contact_surface ){ normal, lane16_max( z, most ) };
}

static contact_surface closest_on_box( lane16v p, lane16v half )
{
    const lane16v q = { clamp( p.x, half.x ), clamp( p.y, half.y ), clamp( p.z, half.z ) };
    lane16v away = lane16v_sub( p, q );
    lane16 length = lane16v_length( away );
    lane16m outside = lane16_gt( length, lane16_zero() );
    const contact_surface in = inside_box( p, half );
    lane16v normal = lane16v_scale( away, lane16_div( lane16_set1( 1.0f ), length ) );
    return ( contact_surface ){ lane16v_select( outside, normal, in.normal ),
                                lane16_select( outside, length, in.distance ) };
}

static contact_surface closest_on_tapered( const contact_body* body, lane16v p )
{
    lane16 rho = lane16_sqrt( lane16_add( lane16_mul( p.x, p.x ), lane16_mul( p.z, p.z ) ) );
    lane16 y = lane16_sub( p.y, lane16_mul( body->slope, rho ) );
    y = lane16_min( lane16_max( y, body->lower ), body->upper );
    p.y = lane16_sub( p.y, y );
    return around( p, lane16_sub( body->radius, lane16_mul( body->sine, y ) ), body->fallback );
}

LANE_INLINE contact_surface closest( contact_kind kind, const contact_body* body, lane16v p )
{
    switch ( kind.shape )
    {
        case WISP_SHAPE_SPHERE:
            return around( p, body->radius, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
        case WISP_SHAPE_CAPSULE:
            p.y = lane16_sub( p.y, clamp( p.y, body->half_length ) );
            return around( p, body->radius, ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f } );
        case WISP_SHAPE_BOX:
            return closest_on_box( p, body->half );
        case WISP_SHAPE_TAPERED_CAPSULE:
            return closest_on_tapered( body, p );
        default:
            return ( contact_surface ){ lane16v_set1( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } ), p.y };
    }
}

// ---- one row ----

// Correction of a vertex along the normal, and its parts.
typedef struct contact_correction
{
    lane16 out;       // m, along the normal; below 0: taken back
    lane16 recovered; // m of `out` by which the previous position moves too
    lane16 damped;    // m by which the previous position moves in addition
    lane16 remaining; // m of depth that remains
} contact_correction;

static contact_correction find_correction( const contact_body* body, lane16 start, lane16 now, lane16 depth,
                                           lane16 least )
{
    lane16 zero = lane16_zero();
    lane16 start_depth = lane16_max( lane16_sub( body->thickness, start ), zero );
    lane16m is_new = lane16_gt( start_depth, lane16_add( depth, body->thickness ) );
    lane16 allowed = lane16_select( is_new, start_depth, lane16_min( depth, start_depth ) );
    lane16 excess = lane16_sub( start_depth, allowed );
    lane16 outward = lane16_max( lane16_sub( lane16_sub( now, start ), excess ), zero );
    lane16 remaining = lane16_max( lane16_sub( allowed, outward ), zero );
    contact_correction correction;
    correction.recovered = lane16_min( remaining, lane16_max( lane16_sub( body->recovery, outward ), zero ) );
    correction.remaining = lane16_sub( remaining, correction.recovered );
    correction.out = lane16_max( lane16_sub( lane16_sub( body->thickness, correction.remaining ), now ), least );
    correction.damped = lane16_select( lane16_gt( allowed, body->shallow ), outward, zero );
    return correction;
}

// Computes the friction of the substep, from the tangential motion that it would have to remove.
static lane16v find_friction( const contact_body* body, lane16v u, lane16 push )
{
    lane16 length = lane16v_length( u );
    lane16m sticks = lane16_le( length, lane16_mul( body->static_friction, push ) );
    lane16 fraction = lane16_div( lane16_mul( body->kinetic_friction, push ), length );
    return lane16v_scale( u, lane16_select( sticks, lane16_set1( 1.0f ), fraction ) );
}

static lane16v tangential( lane16v u, lane16v normal )
{
    return lane16v_mul_add( u, lane16_neg( lane16v_dot( normal, u ) ), normal );
}

// Computes the motion of the body's surface below the vertex in the substep.
LANE_INLINE lane16v surface_motion( contact_kind kind, const contact_body* body, lane16v local,
                                    const contact_surface* s )
{
    lane16v point = lane16v_mul_add( local, lane16_neg( s->distance ), s->normal );
    return lane16v_sub( to_world( kind, &body->after, point ), to_world( kind, &body->before, point ) );
}

// Return whether no vertex of a row is within reach of a ball around the body: before anything is turned into its frame.
LANE_INLINE bool is_beyond( const wisp_strand_contact_args* args, const contact_body* body, lane16v p, lane16 sum )
{
    const lane16 zero = lane16_zero(), far = lane16_set1( args->gives_back ? INFINITY : 0.0f );
    const lane16 least = args->starts ? lane16_max( lane16_neg( sum ), zero ) : zero;
    const lane16 reach = lane16_add( body->thickness, lane16_select( lane16_gt( sum, zero ), far, least ) );
    const lane16v d = lane16v_sub( p, body->after.place );
    const lane16 limit = lane16_add( reach, body->ball ), rounded = lane16_mul( lane16_set1( 1.0001f ), limit );
    return lane16m_all( lane16_gt( lane16v_dot( d, d ), lane16_mul( rounded, limit ) ) );
}

// Finds what sums of a row let a body do.
typedef struct contact_sums
{
    lane16 held, number, least,
        reach; // least: m, push, below 0 what may be taken back or was that of the last substep
    lane16m is_held, is_own, starts;
} contact_sums;

LANE_INLINE contact_sums find_sums( const wisp_strand_contact_args* args, size_t row, lane16 sum )
{
    const lane16 zero = lane16_zero(), own = lane16_set1( args->body_number );
    contact_sums s = { .held = lane16_max( sum, zero ), .number = lane16_load( args->body + row * WISP_LANES ) };
    s.is_held = lane16_gt( sum, zero );
    s.is_own = lane16_eq( s.number, own );
    s.starts = lane16m_and( lane16m_first( args->starts ? WISP_LANES : 0 ),
                            lane16m_and( s.is_own, lane16_lt( sum, zero ) ) );
    const lane16m gives =
        lane16m_and( lane16m_first( args->gives_back ? WISP_LANES : 0 ), lane16m_and( s.is_own, s.is_held ) );
    s.least = lane16_select( lane16m_or( s.starts, gives ), lane16_neg( sum ), zero );
    s.reach = lane16_select( gives, lane16_set1( INFINITY ), lane16_add( lane16_set1( args->thickness ), s.least ) );
    return s;
}

LANE_INLINE void touch_row( const wisp_strand_contact_args* args, const contact_body* body, size_t row,
                            contact_kind kind )
{
    float *at = args->position + row * STRIDE, *from = args->previous + row * STRIDE;
    float* normal_sum = args->normal_correction + row * WISP_LANES;
    const lane16v p = lane16v_load( at );
    if ( is_beyond( args, body, p, lane16_load( normal_sum ) ) )
    {
        return;
    }
    float *remaining = args->remaining_depth + row * WISP_LANES, *numbers = args->body + row * WISP_LANES;
    const lane16 zero = lane16_zero(), sum = lane16_load( normal_sum );
    const contact_sums sums = find_sums( args, row, sum );
    lane16v local = to_body( kind, &body->after, p );
    const contact_surface s = closest( kind, body, local );
    lane16m moves = lane16_gt( lane16_load( args->inverse_mass + row * WISP_LANES ), zero );
    lane16m touches = lane16m_and( moves, lane16_lt( s.distance, sums.reach ) );
    if ( lane16m_any( touches ) == false )
    {
        return;
    }
    lane16v previous = lane16v_load( from );
    lane16 start = closest( kind, body, to_body( kind, &body->before, previous ) ).distance;
    const contact_correction correction =
        find_correction( body, start, s.distance, lane16_load( args->allowed_depth + row * WISP_LANES ), sums.least );
    lane16v normal = turn( kind, body->after.axis, body->after.w, s.normal );
    lane16v out = lane16v_mul_add( p, correction.out, normal );
    lane16v moved = lane16v_mul_add( previous, lane16_add( correction.recovered, correction.damped ), normal );

    lane16 push = lane16_max( lane16_sub( correction.out, correction.recovered ), sums.least );
    lane16 deepest = lane16_load( remaining ), total = lane16_add( sums.held, push );
    lane16v rubbed = lane16v_load( args->friction + row * STRIDE ), last = tangential( rubbed, normal );
    lane16v before = lane16v_select( sums.is_held, last, lane16v_set1( ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ) );
    lane16v u =
        tangential( lane16v_sub( lane16v_sub( out, moved ), surface_motion( kind, body, local, &s ) ), normal );
    lane16v friction = find_friction( body, lane16v_select( sums.starts, last, lane16v_add( before, u ) ), total );
    out = lane16v_sub( out, lane16v_sub( friction, before ) );

    lane16v_store( at, lane16v_select( touches, out, p ) );
    lane16v_store( from, lane16v_select( touches, moved, previous ) );
    lane16v_store( args->friction + row * STRIDE, lane16v_select( touches, friction, rubbed ) );
    lane16_store( normal_sum, lane16_select( touches, total, sum ) );
    lane16_store( remaining, lane16_select( touches, lane16_max( deepest, correction.remaining ), deepest ) );
    lane16 pusher = lane16_select( lane16m_and_not( sums.is_held, sums.is_own ), lane16_set1( -1.0f ),
                                   lane16_set1( args->body_number ) );
    lane16_store( numbers, lane16_select( touches, pusher, sums.number ) );
}

// ---- a row, for queries one by one ----

// Sees half a row from a body. A frame of the world changes nothing.
static void see_half( wisp_transform pose, const float* rows, float ( *seen )[WISP_LANES], int half )
{
    const wisp_vec3 t = pose.translation;
    const bool is_turned = pose_is_turned( pose.rotation ),
               is_world = is_turned == false && t.x == 0.0f && t.y == 0.0f && t.z == 0.0f;
    const float* at = rows + half;
    const lane8v p = { lane8_loadu( at ), lane8_loadu( at + WISP_LANES ), lane8_loadu( at + 2 * WISP_LANES ) },
                 e = is_world ? p : pose_to_local( pose, is_turned, p );
    lane8_storeu( seen[0] + half, e.x );
    lane8_storeu( seen[1] + half, e.y );
    lane8_storeu( seen[2] + half, e.z );
}

static lane16v load_seen( float ( *seen )[WISP_LANES] )
{
    return ( lane16v ){ lane16_loadu( seen[0] ), lane16_loadu( seen[1] ), lane16_loadu( seen[2] ) };
}

uint32_t KERNEL( strand_see_row )( const wisp_strand_contact_args* args, int row, const float* free,
                                   const float* origin, wisp_strand_row* out )
{
    const size_t at = (size_t)row * WISP_LANES;
    for ( int half = 0; half < WISP_LANES; half += WISP_LANES / 2 )
    {
        see_half( args->before, args->previous + (size_t)row * STRIDE, out->from, half );
        see_half( args->after, args->position + (size_t)row * STRIDE, out->to, half );
    }
    const lane16v to = load_seen( out->to );
    const lane16 path = lane16v_length( lane16v_sub( to, load_seen( out->from ) ) );
    const lane16 reach = find_sums( args, (size_t)row, lane16_load( args->normal_correction + at ) ).reach,
                 near = lane16_max( lane16_add( lane16_set1( args->thickness ), path ), reach );
    lane16_storeu( out->path, path );
    lane16_storeu( out->near, near );
    lane16m moves = lane16_gt( lane16_load( args->inverse_mass + at ), lane16_zero() );
    if ( free != NULL )
    {
        const lane16v away = lane16v_sub( to, lane16v_load( origin ) );
        const lane16m is_free = lane16_gt( lane16_sub( lane16_load( free ), lane16v_length( away ) ), near );
        moves = lane16m_and_not( moves, is_free );
    }
    return lane16m_bits( moves );
}

// ---- before the first body ----

static lane16v smaller( lane16v a, lane16v b )
{
    return ( lane16v ){ lane16_min( a.x, b.x ), lane16_min( a.y, b.y ), lane16_min( a.z, b.z ) };
}

static lane16v larger( lane16v a, lane16v b )
{
    return ( lane16v ){ lane16_max( a.x, b.x ), lane16_max( a.y, b.y ), lane16_max( a.z, b.z ) };
}

// Sets the depths; a vertex without contact in the last iteration is allowed the depth that it has. Sums of the last
// substep become negative: not applied yet.
LANE_INLINE void begin_row( const wisp_strand_contact_args* args, size_t row, bool first_iteration )
{
    float *normal_sum = args->normal_correction + row * WISP_LANES,
          *remaining = args->remaining_depth + row * WISP_LANES;
    lane16 sum = lane16_load( normal_sum ), deep = lane16_load( remaining );
    lane16m held = lane16_gt( lane16_max( sum, deep ), lane16_zero() );
    lane16_store( args->allowed_depth + row * WISP_LANES, lane16_select( held, deep, lane16_set1( INFINITY ) ) );
    lane16_store( remaining, lane16_zero() );
    if ( first_iteration )
    {
        float* last = args->last_correction + row * WISP_LANES;
        lane16 now = lane16_max( sum, lane16_zero() );
        lane16_store( normal_sum, lane16_neg( lane16_min( now, lane16_load( last ) ) ) );
        lane16_store( last, now );
    }
}

static wisp_vec3 reduce( lane16v v, bool to_smallest )
{
    _Alignas( 64 ) float lanes[3 * WISP_LANES];
    float least[3];
    lane16v_store( lanes, v );
    for ( int k = 0; k < 3; ++k )
    {
        least[k] = lanes[k * WISP_LANES];
        for ( int l = 1; l < WISP_LANES; ++l )
        {
            const float x = lanes[k * WISP_LANES + l];
            least[k] = ( to_smallest ? x < least[k] : x > least[k] ) ? x : least[k];
        }
    }
    return ( wisp_vec3 ){ least[0], least[1], least[2] };
}

// Extends bounds; NaN is ignored, because a comparison then selects the other operand.
void KERNEL( strand_contact_begin )( const wisp_strand_contact_args* args, const wisp_strand_contact_args* segments,
                                     int group, bool first_iteration, wisp_strand_bounds* reach )
{
    const lane16v plus_infinity = lane16v_set1( ( wisp_vec3 ){ INFINITY, INFINITY, INFINITY } );
    const lane16v minus_infinity = lane16v_set1( ( wisp_vec3 ){ -INFINITY, -INFINITY, -INFINITY } );
    lane16v lower = plus_infinity, upper = minus_infinity;
    lane16 longest = lane16_zero(), segment = longest;
    for ( int row = args->group_row[group]; row < args->group_row[group + 1]; ++row )
    {
        lane16v p = lane16v_load( args->position + (size_t)row * STRIDE );
        lane16v q = lane16v_load( args->previous + (size_t)row * STRIDE ), d = lane16v_sub( p, q );
        lane16m moves = lane16_gt( lane16_load( args->inverse_mass + (size_t)row * WISP_LANES ), lane16_zero() );
        lower = smaller( lane16v_select( moves, smaller( p, q ), plus_infinity ), lower );
        upper = larger( lane16v_select( moves, larger( p, q ), minus_infinity ), upper );
        longest = lane16_max( lane16_select( moves, lane16v_dot( d, d ), lane16_zero() ), longest );
        begin_row( args, (size_t)row, first_iteration );
        if ( segments != NULL )
        {
            begin_row( segments, (size_t)row, first_iteration );
            segment = lane16_max( lane16_load( segments->length + (size_t)row * WISP_LANES ), segment );
        }
    }
    *reach = ( wisp_strand_bounds ){ .lower = reduce( lower, true ), .upper = reduce( upper, false ) };
    lane16 length = lane16_sqrt( longest );
    const wisp_vec3 most = reduce( ( lane16v ){ length, segment, segment }, false );
    reach->max_path = most.x;
    reach->longest = most.y;
}

// ---- segments ----

// Bounds of the way of a row, and which of its vertices move.
typedef struct row_way
{
    lane16v lower, upper;
    lane16 inverse_mass;
} row_way;

static row_way way_of( const wisp_strand_contact_args* args, int row )
{
    const lane16v p = lane16v_load( args->position + (size_t)row * STRIDE ),
                  q = lane16v_load( args->previous + (size_t)row * STRIDE );
    return ( row_way ){ smaller( p, q ), larger( p, q ),
                        lane16_load( args->inverse_mass + (size_t)row * WISP_LANES ) };
}

static lane16m is_inside( lane16v lower, lane16v upper, const wisp_strand_bounds* box )
{
    const lane16v l = lane16v_set1( box->lower ), u = lane16v_set1( box->upper );
    const lane16m x = lane16m_and( lane16_le( lower.x, u.x ), lane16_ge( upper.x, l.x ) ),
                  y = lane16m_and( lane16_le( lower.y, u.y ), lane16_ge( upper.y, l.y ) ),
                  z = lane16m_and( lane16_le( lower.z, u.z ), lane16_ge( upper.z, l.z ) );
    return lane16m_and( x, lane16m_and( y, z ) );
}

int KERNEL( strand_find_segments )( const wisp_strand_contact_args* args, int row, int end,
                                    const wisp_strand_bounds* box, uint32_t* lanes )
{
    row_way own = way_of( args, row );
    for ( ; row + 1 < end; ++row )
    {
        const row_way next = way_of( args, row + 1 );
        const lane16m moves = lane16_gt( lane16_add( own.inverse_mass, next.inverse_mass ), lane16_zero() );
        const lane16m is_near = is_inside( smaller( own.lower, next.lower ), larger( own.upper, next.upper ), box );
        *lanes = lane16m_bits( lane16m_and( moves, is_near ) );
        if ( *lanes != 0 )
        {
            break;
        }
        own = next;
    }
    return row;
}

// ---- one body ----

LANE_INLINE void touch_rows( const wisp_strand_contact_args* args, int begin, int end, contact_kind kind )
{
    const contact_body body = spread_body( args );
    for ( int row = args->group_row[begin]; row < args->group_row[end]; ++row )
    {
        touch_row( args, &body, (size_t)row, kind );
    }
}

// A ball that is not turned, as most heads, is compiled apart.
void KERNEL( strand_contact )( const wisp_strand_contact_args* args, int begin, int end )
{
    const wisp_shape_kind shape = args->shape.kind;
    if ( shape == WISP_SHAPE_SPHERE && pose_is_turned( args->before.rotation ) == false &&
         pose_is_turned( args->after.rotation ) == false )
    {
        touch_rows( args, begin, end, ( contact_kind ){ WISP_SHAPE_SPHERE, false } );
    }
    else
    {
        touch_rows( args, begin, end, ( contact_kind ){ shape, true } );
    }
}

// ---- after the last body ----

bool KERNEL( strand_contact_sum )( const wisp_strand_contact_args* args, int group, float shallow, float* sums )
{
    const lane16 zero = lane16_zero(), limit = lane16_set1( shallow );
    lane16 sum = lane16_loadu( sums );
    lane16m deep = lane16_lt( zero, zero );
    for ( int row = args->group_row[group]; row < args->group_row[group + 1]; ++row )
    {
        const size_t at = (size_t)row * WISP_LANES;
        sum = lane16_add( sum, lane16_max( lane16_load( args->normal_correction + at ), zero ) );
        deep = lane16m_or( deep, lane16_gt( lane16_load( args->remaining_depth + at ), limit ) );
    }
    lane16_storeu( sums, sum );
    return lane16m_any( deep );
}
