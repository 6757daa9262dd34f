// Rest shapes of curled rods. In: rest shape, gravity, stiffness. Out: rest vectors k_i, rest twist, rest tension,
// and the fraction of its weight that a strand feels. Computed strand by strand in double precision.
//
// `rest: balanced` finds k_i and the rest twist for which the given shape is in equilibrium under gravity (sag-free
// initialisation, as Hsu et al. 2023). With M_i = EI / L_i C_i the balance of forces behind segment s is a recursion
// from the tip,
//
//   M_s = M_{s+1} + l_s (W_s - alpha_s t_s) - ((T_s + r_s b_s) kb_s + (T_{s+1} - r_{s+1} b_{s+1}) kb_{s+1}) / 2
//
// where W_s is g times the masses behind segment s, the tension alpha_s is chosen so that M_s has no part along the
// middle tangent, and T_s follows from the balance of twist (rod_factors.c). Then k_s = t_s - t_{s-1} - L_s / EI
// M_s. This is exact for these equations, so the shape stays, if the equilibrium is stable. A strand whose rest
// shape would turn by more than a quarter against its load has another equilibrium, and would whip between the two
// for ever (a horizontal hair of 0.25 m: 4 to 12 m/s after 10 s). So the rest shape turns by a quarter at most, and
// a strand that is too soft for its shape sags calmly. Horizontal hair of 80 um holds up to 0.105 m; the length
// grows with the cube root of EI / (g times the line density).
//
// Where the stiffness was lowered (rod_factors.c), more curvature holds the shape, up to 30 % of the sharpest turn
// next to the vertex. More makes another rod, which a small push throws about (60 %: 12 m/s at 8 substeps after a nod
// of 0.2 rad). The tension is at most m l / dt^2.
//
// A curl feels only the fraction of gravity that this curvature holds: one for the whole strand, the least over its
// vertices. Moments, twist and tension are in proportion to it, so the balance is a fixed point for substeps of any
// length. With all of gravity 96 vertices in a helix of 5 mm and 20 mm per turn reached 17 m/s at 8 substeps, and 31
// m/s with the tension solved in each substep. Now they drift by 0.02 mm in 2 s at 2, 4, 8 and 16 substeps
// (tests/claims/hair.yaml). The price: such a strand falls and swings as under that fraction of gravity
// (this helix 0.5 at 16 substeps, 0.13 at 8, 0.03 at 4), and in another pose of the head it is as soft as its
// stiffness over that fraction. WISP_COUNT_GRAVITY_SCALED counts it. `rest: shape` feels all of its weight, and sags.
#include "strand_passes.h"
#include "wisp/module/double3.h"

#include "strand_rows.h"

// ---- masses and lengths ----

// Masses and rest lengths. In: definition and rest shape. Out: inverse masses, lengths of segments, rest lengths of
// links over one and two segments. Sums are in double precision. A segment gives half of its mass to each of its
// vertices.

// Least length of a segment, as a fraction of the strand's mean: without a length it had no direction.
static const float MIN_SEGMENT = 1e-3f;
// Least mass of a vertex, as a fraction of the strand's mean.
static const float MIN_MASS = 1e-6f;

// ---- lengths and masses ----

static float segment_at_rest( const float* rest, int row, int lane )
{
    return wisp_v3_length( wisp_v3_sub( strands_get( rest, row + 1, lane ), strands_get( rest, row, lane ) ) );
}

static double length_at_rest( const float* rest, int row, int count, int lane )
{
    double sum = 0.0;
    for ( int i = 0; i + 1 < count; ++i )
    {
        sum += (double)segment_at_rest( rest, row + i, lane );
    }
    return sum;
}

static void cook_lengths( const float* rest, float* length, int row, int count, int lane )
{
    const double whole = length_at_rest( rest, row, count, lane );
    const float least = count > 1 ? MIN_SEGMENT * (float)( whole / ( count - 1 ) ) : 0.0f;
    for ( int i = 0; i + 1 < count; ++i )
    {
        length[strands_scalar( row + i, lane )] = fmaxf( segment_at_rest( rest, row + i, lane ), least );
    }
}

// The ends of a loop are nearer to each other than this fraction of its mean segment.
static const double LOOP = 1e-3;

bool strands_is_loop( const float* rest, int row, int count, int lane )
{
    const wisp_vec3 gap = wisp_v3_sub( strands_get( rest, row + count - 1, lane ), strands_get( rest, row, lane ) );
    const double whole = count > 3 ? length_at_rest( rest, row, count, lane ) : 0.0;
    return whole > 0.0 && (double)wisp_v3_length( gap ) <= LOOP * whole / ( count - 1 );
}

// Return half the mass of both segments, unless the definition gives masses.
static double mass_of( const wisp_strand_dynamics_def* def, const float* rest, int first_point, int row, int i,
                       int count, int lane )
{
    if ( def->vertex_masses != NULL )
    {
        return (double)def->vertex_masses[first_point + i];
    }
    if ( def->vertex_mass > 0.0f )
    {
        return (double)def->vertex_mass;
    }
    const int joined = i > 0 || def->closed == false ? i : count - 1; // the last vertex of a loop is its first
    const double before = joined > 0 ? (double)segment_at_rest( rest, row + joined - 1, lane ) : 0.0;
    const double behind = i + 1 < count ? (double)segment_at_rest( rest, row + i, lane ) : 0.0;
    return 0.5 * (double)def->line_density * ( before + behind );
}

static void cook_weights( const wisp_strand_dynamics_def* def, const float* rest, float* weight, int first_point,
                          int row, int count, int lane )
{
    const double whole = length_at_rest( rest, row, count, lane );
    const double least = (double)MIN_MASS * (double)def->line_density * whole / ( count > 0 ? count : 1 );
    weight[strands_scalar( row, lane )] = 0.0f;
    for ( int i = def->free_roots || def->closed ? 0 : 1; i < count; ++i )
    {
        const double mass = fmax( mass_of( def, rest, first_point, row, i, count, lane ), least );
        // a strand without length is a point, and moves with its root
        weight[strands_scalar( row + i, lane )] = whole > 0.0 && mass > 0.0 ? (float)( 1.0 / mass ) : 0.0f;
    }
    if ( def->closed )
    {
        weight[strands_scalar( row + count - 1, lane )] = weight[strands_scalar( row, lane )];
    }
}

// Lanes are sorted by falling length, then by strand.
int strands_lane_of( const wisp_strand_topology* t, int vertex )
{
    int strand = 0;
    for ( int end = t->strand_count; end - strand > 1; )
    {
        const int middle = strand + ( end - strand ) / 2;
        strand = t->offsets[middle] <= vertex ? middle : strand;
        end = t->offsets[middle] <= vertex ? end : middle;
    }
    const int count = t->offsets[strand + 1] - t->offsets[strand];
    int first = 0;
    for ( int end = t->group_count * WISP_LANES; end - first > 1; )
    {
        const int middle = first + ( end - first ) / 2;
        const bool is_before =
            t->lane_count[middle] > count || ( t->lane_count[middle] == count && t->lane_strand[middle] <= strand );
        first = is_before ? middle : first;
        end = is_before ? end : middle;
    }
    return first;
}

static void pin( const wisp_strand_topology* t, const wisp_strand_dynamics_def* def, float* weight )
{
    for ( int k = 0; k < def->pin_count; ++k )
    {
        const int i = strands_lane_of( t, def->pins[k] );
        const int first = t->group_row[i / WISP_LANES], last = first + t->lane_count[i] - 1;
        const int row = first + def->pins[k] - t->offsets[t->lane_strand[i]];
        weight[strands_scalar( row, i % WISP_LANES )] = 0.0f;
        if ( def->closed && ( row == first || row == last ) )
        {
            weight[strands_scalar( first, i % WISP_LANES )] = 0.0f;
            weight[strands_scalar( last, i % WISP_LANES )] = 0.0f;
        }
    }
}

static int count_pins( const wisp_strand_topology* t, const float* weight )
{
    int count = 0;
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        for ( int v = 1; v < t->lane_count[i]; ++v )
        {
            const size_t at = strands_scalar( t->group_row[i / WISP_LANES] + v, i % WISP_LANES );
            count += weight[at] == 0.0f ? 1 : 0;
        }
    }
    return count;
}

int strands_cook_masses( wisp_world* world, wisp_entity strands, const wisp_strand_dynamics_def* def )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const float* rest = wisp_world_column( world, strands, WISP_STRAND_REST, 0 );
    float* weight = wisp_world_column( world, strands, WISP_STRAND_INVERSE_MASS, 0 );
    float* length = wisp_world_column( world, strands, WISP_STRAND_LENGTH, 0 );
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        const int row = t->group_row[i / WISP_LANES], lane = i % WISP_LANES, count = t->lane_count[i];
        if ( count > 0 )
        {
            cook_lengths( rest, length, row, count, lane );
            cook_weights( def, rest, weight, t->offsets[t->lane_strand[i]], row, count, lane );
        }
    }
    pin( t, def, weight );
    return count_pins( t, weight );
}

float strands_longest( const strands_rows* rows )
{
    const wisp_strand_topology* t = rows->topology;
    float longest = 0.0f;
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        const int row = t->group_row[i / WISP_LANES];
        const float length = (float)length_at_rest( rows->rest, row, t->lane_count[i], i % WISP_LANES );
        longest = fmaxf( longest, length );
    }
    return longest;
}

// ---- links ----

static void cook_link( const strands_rows* rows, int stride, float* rest )
{
    const wisp_strand_topology* t = rows->topology;
    for ( size_t i = 0; i < (size_t)t->row_count * WISP_LANES; ++i )
    {
        rest[i] = -1.0f;
    }
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        const int lane = i % WISP_LANES;
        for ( int v = 0; v + stride < t->lane_count[i]; ++v )
        {
            const int row = t->group_row[i / WISP_LANES] + v;
            const wisp_vec3 along =
                wisp_v3_sub( strands_get( rows->rest, row + stride, lane ), strands_get( rows->rest, row, lane ) );
            const size_t at = strands_scalar( row, lane );
            rest[at] = stride == 1 ? rows->length[at] : wisp_v3_length( along );
        }
    }
}

void strands_cook_links( wisp_world* world, wisp_entity strands, const strands_state* state )
{
    const strands_rows rows = strands_rows_of( world, strands );
    float* stretch = wisp_world_column( world, strands, state->stretch_link, 0 );
    float* bend = wisp_world_column( world, strands, state->bend_link, 0 );
    if ( stretch != NULL )
    {
        cook_link( &rows, 1, stretch );
    }
    if ( bend != NULL )
    {
        cook_link( &rows, 2, bend );
    }
}

// ---- rest curvature ----

static const double MAX_TURN = 1.57; // rad, a quarter of a turn

static double3 unit( double3 v, double3 otherwise )
{
    const double length = double3_length( v );
    return length > 0.0 ? double3_scale( v, 1.0 / length ) : otherwise;
}

// A strand at rest.
typedef struct strand_shape
{
    const strands_rows* rows;
    int row, count, lane;
    double3 growth; // direction of the clamp; of a closed strand of its last segment
} strand_shape;

// Return the direction of segment s at rest; -1 is the clamp. A segment without length has that of the one before.
static double3 direction( const strand_shape* shape, int s )
{
    for ( ; s >= 0; --s )
    {
        const double3 e =
            double3_sub( double3_widen( strands_get( shape->rows->rest, shape->row + s + 1, shape->lane ) ),
                         double3_widen( strands_get( shape->rows->rest, shape->row + s, shape->lane ) ) );
        if ( double3_dot( e, e ) > 0.0 )
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
        const double3 e = double3_sub( double3_widen( strands_get( rows->rest, row + s + 1, lane ) ),
                                       double3_widen( strands_get( rows->rest, row + s, lane ) ) );
        if ( double3_dot( e, e ) > 0.0 )
        {
            shape.growth = unit( e, e );
            break;
        }
    }
    return shape;
}

// Balance at vertex s, between segments s - 1 and s.
typedef struct balance
{
    double3 moment; // M_s
    double twist;   // T_s
    double load;    // b_s
    double3 pull;   // (T_s - r b_s) kb_s, on the segment before
    double tension; // alpha_s, of segment s
    double mass;    // kg, behind segment s - 1
} balance;

// Step the recursion towards the root. With T_s unknown M_s is A - T_s kb_s / 2, and b_s = d . (z x M_s) with d = t_s
// - t_{s-1}. So the balance of twist is linear in T_s, and both are solved at once. kb_s is across z, so it does not
// contribute to alpha_s.
static balance step( const strand_shape* shape, int s, wisp_vec3 gravity, balance behind )
{
    const double3 t = direction( shape, s ), before = direction( shape, s - 1 ), bend = double3_sub( t, before );
    const double3 z = unit( double3_add( t, before ), t );
    const double fold = fmax( 1.0 + double3_dot( before, t ), 0.1 ); // clamped as in the kernel
    const double3 binormal = double3_scale( double3_cross( before, t ), 2.0 / fold );
    const double w = (double)shape->rows->weight[strands_scalar( shape->row + s + 1, shape->lane )];
    const double l = (double)shape->rows->length[strands_scalar( shape->row + s, shape->lane )];
    // a pinned vertex bears all that hangs from it
    const double mass = w > 0.0 ? behind.mass + 1.0 / w : 0.0;
    double3 free = double3_add( behind.moment, double3_scale( double3_widen( gravity ), l * mass ) );
    free = double3_sub( free, double3_scale( behind.pull, 0.5 ) );
    const double along = l * double3_dot( t, z );
    balance out = { .mass = mass };
    out.tension = along > 0.0 ? double3_dot( free, z ) / along : 0.0;
    const double3 foreign = double3_sub( free, double3_scale( t, l * out.tension ) );
    // b_s = across - pull_load (T_s + r b_s) / 2
    const double cosine = sqrt( 0.5 * ( 1.0 + double3_dot( before, t ) ) ); // of half the angle
    const double ratio = 0.5 * cosine / ( 1.0 + cosine );
    const double pull_load = double3_dot( bend, double3_cross( z, binormal ) ),
                 across = double3_dot( bend, double3_cross( z, foreign ) );
    const double own = 1.0 / ( 1.0 + 0.5 * ratio * pull_load );
    out.twist = ( behind.twist - 0.5 * behind.load - 0.5 * across * own ) / ( 1.0 - 0.25 * pull_load * own );
    out.load = own * ( across - 0.5 * out.twist * pull_load );
    out.moment = double3_sub( foreign, double3_scale( binormal, 0.5 * ( out.twist + ratio * out.load ) ) );
    out.pull = double3_scale( binormal, out.twist - ratio * out.load );
    return out;
}

// ---- into columns ----

typedef struct curve_args
{
    const strands_rows* rows;
    const strands_settings* settings;
    const float* stiffness;
    const float* clamp;
    strands_section section;      // zero: circular
    const int32_t* hold;          // [group][16] wisp_strand_tip; null: tips are free
    const float* tip;             // [group][4][16] frames of tips at rest
    const strands_closed* closed; // null: strands are open
    float *rest, *rest_twist, *twist_stiffness, *rest_tension;
    double dt;
} curve_args;

// Return the middle frame of two neighbours, as the kernel finds it.
static wisp_quat middle_frame( wisp_quat a, wisp_quat b )
{
    const float same = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w < 0.0f ? -1.0f : 1.0f;
    const wisp_quat sum = { a.x + same * b.x, a.y + same * b.y, a.z + same * b.z, a.w + same * b.w };
    return wisp_transform_make( sum, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ).rotation;
}

static void put_vertex( const curve_args* args, int row, int lane, wisp_vec3 k, double half_twist,
                        double twist_stiffness )
{
    strands_put( args->rest, row, lane, k );
    float* twist = args->rest_twist + (size_t)row * 2 * WISP_LANES + lane;
    twist[0] = (float)cos( half_twist );
    twist[WISP_LANES] = (float)sin( half_twist );
    args->twist_stiffness[strands_scalar( row, lane )] = (float)twist_stiffness;
}

// Return GJ / L_i, lowered in the same ratio as EI / L_i.
static double twist_stiffness_of( const curve_args* args, const strand_shape* shape, int s )
{
    const double bend = (double)args->stiffness[strands_scalar( shape->row + s, shape->lane )];
    const double rigidity = (double)args->settings->bend_rigidity;
    return rigidity > 0.0 ? bend * (double)args->settings->twist_rigidity / rigidity : 0.0;
}

// How far a moment bends or twists a vertex with its lowered stiffness, and the most that the rest shape may
// compensate.
typedef struct compensation
{
    double needed, most; // rad
} compensation;

static compensation compensation_of( const strand_shape* shape, int s, double moment, double stiffness,
                                     double rigidity )
{
    const double reach = strands_bend_length( shape->rows, shape->row, s, shape->lane );
    const double turn = strands_sharpest_turn( shape->rows, shape->row, s, shape->count, shape->lane );
    return ( compensation ){ .needed = stiffness > 0.0 ? moment / stiffness : 0.0,
                             .most = fmax( moment * reach / fmax( rigidity, 1e-300 ), 0.3 * turn ) };
}

// Bound a tension: one that moves a vertex by more than the length of its segment in a substep oscillates.
static double tension_of( const curve_args* args, const strand_shape* shape, int s, double tension )
{
    const size_t at = strands_scalar( shape->row + s, shape->lane );
    const double w = fmax( (double)args->rows->weight[at], (double)args->rows->weight[at + WISP_LANES] );
    const double most = w > 0.0 ? (double)args->rows->length[at] / ( w * args->dt * args->dt ) : 0.0;
    return fmax( -most, fmin( most, tension ) );
}

// Return M + EI' / EI times its part along the soft axis, less that part: the moment that would bend a circular section of
// EI' as M bends this one. The axes at rest are in place of the rest vectors, which the recursion replaces.
static double3 bending_moment( const curve_args* args, const strand_shape* shape, int s, double3 moment )
{
    const double flat = (double)args->section.flatness;
    if ( flat == 0.0 )
    {
        return moment;
    }
    const double3 axis = double3_widen( strands_get( args->rest, shape->row + s, shape->lane ) );
    return double3_add( moment,
                        double3_scale( axis, flat * flat / ( 1.0 - flat * flat ) * double3_dot( moment, axis ) ) );
}

static compensation bend_of( const curve_args* args, const strand_shape* shape, int s, const balance* now )
{
    const double stiffness = (double)args->stiffness[strands_scalar( shape->row + s, shape->lane )];
    const double3 moment = bending_moment( args, shape, s, now->moment );
    return compensation_of( shape, s, double3_length( moment ), stiffness, (double)args->settings->bend_rigidity );
}

static compensation twist_of( const curve_args* args, const strand_shape* shape, int s, const balance* now )
{
    return compensation_of( shape, s, fabs( now->twist ), twist_stiffness_of( args, shape, s ),
                            (double)args->settings->twist_rigidity );
}

// Return the fraction of a moment that the rest shape holds. The factor allows for rounding of the stiffness.
static double fraction_of( compensation h )
{
    return h.needed > 1.001 * h.most ? h.most / h.needed : 1.0;
}

// Return half of what the closing twist leaves a vertex at rest: the strand was turned, so this is the other way.
static double closing_half_twist( const curve_args* args, const strand_shape* shape, int i )
{
    double whole = 0.0;
    for ( int s = 0; s + 1 < shape->count; ++s )
    {
        whole += (double)args->rows->length[strands_scalar( shape->row + s, shape->lane )];
    }
    const int before = i > 0 ? i - 1 : shape->count - 2;
    const double reach = 0.5 * ( (double)args->rows->length[strands_scalar( shape->row + before, shape->lane )] +
                                 (double)args->rows->length[strands_scalar( shape->row + i, shape->lane )] );
    return -0.5 * (double)args->closed->twist * reach / whole;
}

// Return the fraction of its weight that the strand can hold in this shape. All terms of the recursion are in
// proportion to gravity. Only curls need less than 1.
static double fraction_of_weight( const curve_args* args, const strand_shape* shape )
{
    balance now = { .mass = 0.0 };
    double fraction = 1.0;
    for ( int s = shape->count - 2; s >= 0; --s )
    {
        now = step( shape, s, args->settings->gravity, now );
        const double turn = strands_sharpest_turn( shape->rows, shape->row, s, shape->count, shape->lane );
        if ( strands_is_curl( turn ) )
        {
            fraction = fmin( fraction, fraction_of( bend_of( args, shape, s, &now ) ) );
            fraction = fmin( fraction, fraction_of( twist_of( args, shape, s, &now ) ) );
        }
    }
    return fraction;
}

// Return the fraction of a balance under `gravity` that is stable. The rest shape turns against the load by M_i /
// (EI / L_i) at each vertex, without what compensates for a lowered stiffness; a strand that turns farther in all
// has another equilibrium, and whips between the two.
static double stable_fraction( const curve_args* args, const strand_shape* shape, wisp_vec3 gravity )
{
    const double rigidity = fmax( (double)args->settings->bend_rigidity, 1e-300 );
    balance now = { .mass = 0.0 };
    double3 sum = { 0.0, 0.0, 0.0 };
    double turn = 0.0;
    for ( int s = shape->count - 2; s >= 0; --s )
    {
        now = step( shape, s, gravity, now );
        const double reach = strands_bend_length( shape->rows, shape->row, s, shape->lane );
        sum = double3_add( sum, double3_scale( bending_moment( args, shape, s, now.moment ), reach / rigidity ) );
        turn = fmax( turn, double3_length( sum ) );
    }
    return turn > MAX_TURN ? MAX_TURN / turn : 1.0;
}

// Compute k_i (in the world) and the rest twist of each vertex. Frames are laid without twist, so the rest twist
// alone gives T. @return the fraction of the load that the rest shape holds
static double curve_vertices( const curve_args* args, const strand_shape* shape, double fraction )
{
    const bool balanced = args->settings->rest == WISP_STRAND_REST_SAG_FREE;
    const bool is_straight = args->settings->rest == WISP_STRAND_REST_STRAIGHT;
    const wisp_vec3 whole = args->settings->gravity;
    const float felt = (float)fraction;
    const wisp_vec3 load = { felt * whole.x, felt * whole.y, felt * whole.z };
    const double stable = balanced ? stable_fraction( args, shape, load ) : 1.0;
    const float held = (float)stable;
    const wisp_vec3 gravity = { held * load.x, held * load.y, held * load.z };
    balance now = { .mass = 0.0 };
    for ( int s = shape->count - 2; s >= 0; --s )
    {
        now = step( shape, s, gravity, now );
        const double twist_stiffness = twist_stiffness_of( args, shape, s );
        double3 k = is_straight ? double3_scale( now.moment, 0.0 )
                                : double3_sub( direction( shape, s ), direction( shape, s - 1 ) );
        double half_twist = 0.5 * strands_natural_twist( args->rows->length, shape->row, s, shape->count, shape->lane,
                                                         (double)args->section.twist );
        half_twist =
            args->closed != NULL && args->closed->twist != 0.0f ? closing_half_twist( args, shape, s ) : half_twist;
        if ( balanced && args->stiffness[strands_scalar( shape->row + s, shape->lane )] > 0.0f )
        {
            const double3 bending = bending_moment( args, shape, s, now.moment );
            const double moment = double3_length( bending );
            const compensation bend = bend_of( args, shape, s, &now ), twist = twist_of( args, shape, s, &now );
            k = double3_sub( k,
                             double3_scale( bending, moment > 0.0 ? fmin( bend.needed, bend.most ) / moment : 0.0 ) );
            half_twist -= copysign( atan( 0.5 * fmin( twist.needed, twist.most ) ), now.twist );
        }
        args->rest_tension[strands_scalar( shape->row + s, shape->lane )] =
            balanced ? (float)tension_of( args, shape, s, now.tension ) : 0.0f;
        put_vertex( args, shape->row + s, shape->lane, ( wisp_vec3 ){ (float)k.x, (float)k.y, (float)k.z },
                    half_twist, twist_stiffness );
    }
    return stable;
}

// Return the frame of segment s at rest from the one before it.
static wisp_quat next_frame( const curve_args* args, const strand_shape* shape, int s, wisp_quat before )
{
    const wisp_vec3 e = wisp_v3_sub( strands_get( args->rows->rest, shape->row + s + 1, shape->lane ),
                                     strands_get( args->rows->rest, shape->row + s, shape->lane ) );
    return strands_twist_frame( strands_transport_frame( before, e ),
                                strands_natural_twist( args->rows->length, shape->row, s, shape->count, shape->lane,
                                                       (double)args->section.twist ) );
}

// Put the axis across the flat side at each vertex, where the recursion from the tip finds it.
static void put_axes( const curve_args* args, const strand_shape* shape, wisp_quat clamp )
{
    wisp_quat before = clamp;
    for ( int s = 0; s + 1 < shape->count; ++s )
    {
        const wisp_quat frame = next_frame( args, shape, s, before );
        strands_put( args->rest, shape->row + s, shape->lane,
                     wisp_quat_rotate( middle_frame( before, frame ), ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f } ) );
        before = frame;
    }
}

// Let the vertex at a tip whose direction is held be without load at rest. A straight rod that is joined to a loop is not:
// it is as it was before it was joined.
static void rest_tip( const curve_args* args, const strand_shape* shape, wisp_quat last, wisp_quat tip )
{
    const int i = shape->count - 1, row = shape->row + i;
    const wisp_vec3 z = { 0.0f, 0.0f, 1.0f };
    const wisp_quat r = wisp_quat_multiply( strands_quat_inverse( last ), tip );
    const bool is_straight = args->settings->rest == WISP_STRAND_REST_STRAIGHT;
    const wisp_vec3 bend = wisp_v3_sub( wisp_quat_rotate( tip, z ), wisp_quat_rotate( last, z ) );
    const double natural = strands_natural_twist( args->rows->length, shape->row, i, shape->count, shape->lane,
                                                  (double)args->section.twist );
    const double half_twist = is_straight ? 0.5 * natural : atan2( (double)r.z, (double)r.w );
    const wisp_vec3 none = { 0.0f, 0.0f, 0.0f };
    const wisp_vec3 k = is_straight ? none : wisp_quat_inverse_rotate( middle_frame( last, tip ), bend );
    put_vertex( args, row, shape->lane, k, half_twist, twist_stiffness_of( args, shape, i ) );
}

// Give the joint of a closed strand its rest vector and twist: the given loop is without load but for its closing twist, which
// is the same all along.
static void rest_joint( const curve_args* args, const strand_shape* shape, wisp_quat last, wisp_quat clamp,
                        wisp_vec3 k )
{
    const wisp_quat first = next_frame( args, shape, 0, clamp );
    const wisp_quat r = wisp_quat_multiply( strands_quat_inverse( last ), first );
    const double sign = r.w < 0.0f ? -1.0 : 1.0; // of the two quaternions the smaller rotation
    const double given = atan2( sign * (double)r.z, sign * (double)r.w );
    put_vertex( args, shape->row, shape->lane, wisp_quat_inverse_rotate( middle_frame( last, first ), k ),
                given + closing_half_twist( args, shape, 0 ), twist_stiffness_of( args, shape, 0 ) );
}

// @return the fraction of its weight that the strand feels @param held out: the fraction of that which it holds
static double curve_strand( const curve_args* args, int group, int row, int count, int lane, double* held )
{
    strand_shape shape = shape_of( args->rows, row, count, lane );
    if ( args->closed != NULL && count > 1 )
    {
        shape.growth = direction( &shape, count - 2 );
    }
    const wisp_quat clamp = strands_get_quat( args->clamp, group, lane );
    if ( args->section.flatness > 0.0f )
    {
        put_axes( args, &shape, clamp );
    }
    const double fraction =
        args->settings->rest == WISP_STRAND_REST_SAG_FREE ? fraction_of_weight( args, &shape ) : 1.0;
    *held = curve_vertices( args, &shape, fraction );
    wisp_quat before = clamp;
    const wisp_vec3 joint = strands_get( args->rest, row, lane );
    for ( int s = 0; s + 1 < count; ++s )
    {
        const wisp_quat frame = next_frame( args, &shape, s, before );
        const wisp_vec3 k = strands_get( args->rest, row + s, lane );
        strands_put( args->rest, row + s, lane, wisp_quat_inverse_rotate( middle_frame( before, frame ), k ) );
        before = frame;
    }
    if ( args->hold != NULL && ( args->hold[group * WISP_LANES + lane] & WISP_STRAND_TIP_GUIDED ) != 0 )
    {
        rest_tip( args, &shape, before, strands_get_quat( args->tip, group, lane ) );
    }
    if ( args->closed != NULL && count > 1 )
    {
        rest_joint( args, &shape, before, clamp, joint );
    }
    return fraction;
}

bool strands_balance_is_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    const strands_state* state = user;
    const float* balanced = wisp_frame_column( frame, entity, state->balance, 0 );
    return wisp_frame_strands( frame, entity )->group_count > 0 && balanced[0] != wisp_frame_dt( frame, entity );
}

void strands_balance_rest( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const strands_rows rows = strands_rows_in( frame, span->entity );
    curve_args args = {
        .rows = &rows,
        .settings = wisp_frame_column( frame, span->entity, state->settings, 0 ),
        .stiffness = wisp_frame_column( frame, span->entity, state->rod, 1 ),
        .clamp = wisp_frame_column( frame, span->entity, state->clamp, 0 ),
        .rest = wisp_frame_column( frame, span->entity, state->curve, 1 ),
        .rest_twist = wisp_frame_column( frame, span->entity, state->curve, 2 ),
        .twist_stiffness = wisp_frame_column( frame, span->entity, state->curve, 3 ),
        .rest_tension = wisp_frame_column( frame, span->entity, state->curve, 4 ),
        .dt = (double)wisp_frame_dt( frame, span->entity ),
    };
    if ( wisp_frame_has( frame, span->entity, state->section ) )
    {
        args.section = *(const strands_section*)wisp_frame_column( frame, span->entity, state->section, 0 );
    }
    if ( wisp_frame_has( frame, span->entity, state->tips ) )
    {
        args.hold = wisp_frame_column( frame, span->entity, state->tips, 0 );
        args.tip = wisp_frame_column( frame, span->entity, state->tips, 4 );
    }
    if ( wisp_frame_has( frame, span->entity, state->closed ) )
    {
        args.closed = wisp_frame_column( frame, span->entity, state->closed, 0 );
    }
    float* balanced = wisp_frame_column( frame, span->entity, state->balance, 0 );
    float* fractions = wisp_frame_column( frame, span->entity, state->balance, 1 );
    float* held = wisp_frame_column( frame, span->entity, state->balance, 2 );
    uint64_t lightened = 0, soft = 0;
    for ( int g = span->begin; g < span->end; ++g )
    {
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            const int count = rows.topology->lane_count[g * WISP_LANES + lane];
            double own;
            const double fraction = curve_strand( &args, g, rows.topology->group_row[g], count, lane, &own );
            fractions[g * WISP_LANES + lane] = (float)fraction;
            held[g * WISP_LANES + lane] = (float)own;
            lightened += fraction < 1.0 ? 1 : 0;
            soft += own < 1.0 ? 1 : 0;
        }
        balanced[g] = wisp_frame_dt( frame, span->entity );
    }
    if ( lightened > 0 )
    {
        wisp_frame_count( frame, WISP_COUNT_GRAVITY_SCALED, lightened );
    }
    if ( soft > 0 )
    {
        wisp_frame_count( frame, WISP_COUNT_SAGGING, soft );
    }
}
