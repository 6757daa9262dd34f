// What a definition becomes: masses and lengths, links, clamps, and the factors of the rods' systems, in double.
#include "strands_internal.h"

#include <float.h>
#include <string.h>

// A segment shorter than this share of the strand's mean one gets its length: without a length it had no direction.
static const float LEAST_SEGMENT = 1e-3f;
// A vertex that no segment gives a mass has this share of the strand's mean one.
static const float LEAST_MASS = 1e-6f;
// dt^2 EI / (m l^3): single precision solves no stiffer system.
static const double MOST_STIFFNESS = 6e4;
// Of a curled rod the same times the fourth power of its turn at a vertex, which is dt^2 EI curvature^4 / line density: above 0.1
// the turning of the frames, which waits for the next substep, feeds on itself (README).
static const double MOST_CURLED = 0.08;

strands_rows strands_rows_of( wisp_world* world, wisp_entity strands )
{
    return ( strands_rows ){
        .topology = wisp_world_strands( world, strands ),
        .rest = wisp_world_column( world, strands, WISP_STRAND_REST, 0 ),
        .weight = wisp_world_column( world, strands, WISP_STRAND_WEIGHT, 0 ),
        .length = wisp_world_column( world, strands, WISP_STRAND_LENGTH, 0 ),
    };
}

strands_rows strands_rows_in( wisp_frame* frame, wisp_entity strands )
{
    return ( strands_rows ){
        .topology = wisp_frame_strands( frame, strands ),
        .rest = wisp_frame_column( frame, strands, WISP_STRAND_REST, 0 ),
        .weight = wisp_frame_column( frame, strands, WISP_STRAND_WEIGHT, 0 ),
        .length = wisp_frame_column( frame, strands, WISP_STRAND_LENGTH, 0 ),
    };
}

// ---- lengths and masses ----

static float segment_at_rest( const float* rest, int row, int lane )
{
    return strands_norm( strands_sub( strands_get( rest, row + 1, lane ), strands_get( rest, row, lane ) ) );
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
    const float least = count > 1 ? LEAST_SEGMENT * (float)( whole / ( count - 1 ) ) : 0.0f;
    for ( int i = 0; i + 1 < count; ++i )
    {
        length[strands_scalar( row + i, lane )] = fmaxf( segment_at_rest( rest, row + i, lane ), least );
    }
}

// Half the mass of both segments, unless the definition gives masses itself.
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
    const double before = i > 0 ? (double)segment_at_rest( rest, row + i - 1, lane ) : 0.0;
    const double behind = i + 1 < count ? (double)segment_at_rest( rest, row + i, lane ) : 0.0;
    return 0.5 * (double)def->line_density * ( before + behind );
}

static void cook_weights( const wisp_strand_dynamics_def* def, const float* rest, float* weight, int first_point,
                          int row, int count, int lane )
{
    const double whole = length_at_rest( rest, row, count, lane );
    const double least = (double)LEAST_MASS * (double)def->line_density * whole / ( count > 0 ? count : 1 );
    weight[strands_scalar( row, lane )] = 0.0f;
    for ( int i = 1; i < count; ++i )
    {
        const double mass = fmax( mass_of( def, rest, first_point, row, i, count, lane ), least );
        // a strand without any length is a point, and goes with its root
        weight[strands_scalar( row + i, lane )] = whole > 0.0 && mass > 0.0 ? (float)( 1.0 / mass ) : 0.0f;
    }
}

// The lane of a vertex. Lanes stand in the order of falling length, and of strands where lengths are equal.
static int lane_of( const wisp_strand_topology* t, int vertex )
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
        const int i = lane_of( t, def->pins[k] );
        const int row = t->group_row[i / WISP_LANES] + def->pins[k] - t->offsets[t->lane_strand[i]];
        weight[strands_scalar( row, i % WISP_LANES )] = 0.0f;
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
    float* weight = wisp_world_column( world, strands, WISP_STRAND_WEIGHT, 0 );
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
                strands_sub( strands_get( rows->rest, row + stride, lane ), strands_get( rows->rest, row, lane ) );
            const size_t at = strands_scalar( row, lane );
            rest[at] = stride == 1 ? rows->length[at] : strands_norm( along );
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

// ---- rods ----

// The smallest rotation from z to a direction.
static wisp_quat from_z( wisp_vec3 d )
{
    const double length = sqrt( (double)d.x * (double)d.x + (double)d.y * (double)d.y + (double)d.z * (double)d.z );
    if ( length == 0.0 || (double)d.z < -0.999999 * length )
    {
        return length == 0.0 ? ( wisp_quat ){ 0.0f, 0.0f, 0.0f, 1.0f } : ( wisp_quat ){ 1.0f, 0.0f, 0.0f, 0.0f };
    }
    const wisp_quat q = { -d.y, d.x, 0.0f, (float)( length + (double)d.z ) };
    return wisp_rigid_make( q, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ).rotation;
}

// The smallest rotation that takes the frame's z axis along e, after the frame.
wisp_quat strands_carry_frame( wisp_quat q, wisp_vec3 e )
{
    if ( strands_norm( e ) == 0.0f )
    {
        return q;
    }
    const wisp_quat carried = strands_quat_multiply( q, from_z( wisp_quat_turn_back( q, e ) ) );
    return wisp_rigid_make( carried, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ).rotation;
}

void strands_lay_group( const wisp_strand_topology* t, const float* position, const float* clamp, const float* root,
                        float* frame, int group )
{
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        wisp_quat q =
            strands_quat_multiply( strands_get_quat( root, group, lane ), strands_get_quat( clamp, group, lane ) );
        const int count = t->lane_count[group * WISP_LANES + lane];
        for ( int row = t->group_row[group]; row < t->group_row[group + 1]; ++row )
        {
            if ( row - t->group_row[group] + 1 < count )
            {
                const wisp_vec3 to = strands_get( position, row + 1, lane );
                q = strands_carry_frame( q, strands_sub( to, strands_get( position, row, lane ) ) );
            }
            strands_put_quat( frame, row, lane, q );
        }
    }
}

// A strand grows in the direction of its first segment that has one.
static wisp_quat clamp_of( const float* rest, int row, int count, int lane )
{
    for ( int i = 0; i + 1 < count; ++i )
    {
        const wisp_vec3 e = strands_sub( strands_get( rest, row + i + 1, lane ), strands_get( rest, row + i, lane ) );
        if ( strands_norm( e ) > 0.0f )
        {
            return from_z( e );
        }
    }
    return ( wisp_quat ){ 0.0f, 0.0f, 0.0f, 1.0f };
}

// The tension of what hangs still is never above its weight. One that a body has pushed into the strand may be: carried into
// the next substep it would throw the strand off the body. Between two pins a strand bears four times its own weight.
static void cook_most_tension( const strands_rows* rows, double gravity, int row, int count, int lane, float* most )
{
    double whole = 0.0, behind = 0.0;
    bool is_held = false;
    for ( int i = 1; i < count; ++i )
    {
        const double w = (double)rows->weight[strands_scalar( row + i, lane )];
        whole += w > 0.0 ? 1.0 / w : 0.0;
        is_held = is_held || w == 0.0;
    }
    for ( int i = count - 1; i > 0; --i )
    {
        const double w = (double)rows->weight[strands_scalar( row + i, lane )];
        behind += w > 0.0 ? 1.0 / w : 0.0;
        most[strands_scalar( row + i - 1, lane )] = (float)( gravity * ( is_held ? 4.0 * whole : behind ) );
    }
}

void strands_cook_rods( wisp_world* world, wisp_entity strands, const strands_state* state )
{
    const strands_rows rows = strands_rows_of( world, strands );
    const strands_settings* settings = wisp_world_column( world, strands, state->settings, 0 );
    float* most = wisp_world_column( world, strands, state->rod, 3 );
    const wisp_strand_topology* t = rows.topology;
    float* inverse = wisp_world_column( world, strands, state->rod, 0 );
    float* clamp = wisp_world_column( world, strands, state->clamp, 0 );
    float* factored = wisp_world_column( world, strands, state->clamp, 1 );
    if ( inverse == NULL )
    {
        return;
    }
    for ( size_t i = 0; i < (size_t)t->row_count * WISP_LANES; ++i )
    {
        inverse[i] = rows.length[i] > 0.0f ? 1.0f / rows.length[i] : 0.0f;
    }
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        const int group = i / WISP_LANES, lane = i % WISP_LANES;
        strands_put_quat( clamp, group, lane, clamp_of( rows.rest, t->group_row[group], t->lane_count[i], lane ) );
        cook_most_tension( &rows, (double)strands_norm( settings->gravity ), t->group_row[group], t->lane_count[i],
                           lane, most );
        factored[group] = 0.0f;
    }
    // the tension of a curled rod is that of its balance, which does not change
    for ( size_t i = 0; i < (size_t)t->row_count * WISP_LANES && wisp_world_has( world, strands, state->curve ); ++i )
    {
        most[i] = FLT_MAX;
    }
}

// ---- factors ----

// The three bands of L D L^T of one strand, row by row: what the two rows before have left.
typedef struct band
{
    double pivot, first, second; // D(i), L(i, i-1), L(i, i-2)
} band;

typedef struct factor_job
{
    const strands_rows* rows;
    const strands_settings* settings;
    float *stiffness, *factor;
    double dt;
    bool curled; // with frames
} factor_job;

static double mass_at( const strands_rows* rows, int row, int lane )
{
    const double w = (double)rows->weight[strands_scalar( row, lane )];
    return w > 0.0 ? 1.0 / w : 0.0;
}

static double length_at_row( const strands_rows* rows, int row, int lane )
{
    return (double)rows->length[strands_scalar( row, lane )];
}

double strands_reach( const strands_rows* rows, int row, int i, int lane )
{
    const double behind = length_at_row( rows, row + i, lane );
    return 0.5 * ( ( i > 0 ? length_at_row( rows, row + i - 1, lane ) : 0.0 ) + behind );
}

// |t_i - t_{i-1}| of the rest shape; nothing at the ends.
static double turn_at_rest( const strands_rows* rows, int row, int i, int count, int lane )
{
    if ( i < 1 || i + 1 >= count )
    {
        return 0.0;
    }
    const wisp_vec3 a =
        strands_sub( strands_get( rows->rest, row + i, lane ), strands_get( rows->rest, row + i - 1, lane ) );
    const wisp_vec3 b =
        strands_sub( strands_get( rows->rest, row + i + 1, lane ), strands_get( rows->rest, row + i, lane ) );
    const float s = 1.0f / (float)length_at_row( rows, row + i - 1, lane ),
                t = 1.0f / (float)length_at_row( rows, row + i, lane );
    return (double)strands_norm( ( wisp_vec3 ){ t * b.x - s * a.x, t * b.y - s * a.y, t * b.z - s * a.z } );
}

double strands_sharpest_turn( const strands_rows* rows, int row, int i, int count, int lane )
{
    double turn = 0.0;
    for ( int k = i - 1; k <= i + 1; ++k )
    {
        turn = fmax( turn, turn_at_rest( rows, row, k, count, lane ) );
    }
    return turn;
}

bool strands_is_curl( double turn )
{
    return turn * turn * turn * turn * MOST_STIFFNESS > MOST_CURLED;
}

static double most_stiffness( const factor_job* job, int row, int i, int count, int lane )
{
    const double turn = job->curled ? strands_sharpest_turn( job->rows, row, i, count, lane ) : 0.0;
    return fmin( MOST_STIFFNESS, MOST_CURLED / fmax( turn * turn * turn * turn, 1e-12 ) );
}

// EI / L_i of vertex i, lowered to what can be solved for.
static double stiffness_of( const factor_job* job, int row, int i, int count, int lane )
{
    if ( i + 1 >= count || ( i == 0 && job->settings->clamped == 0 ) )
    {
        return 0.0;
    }
    const double behind = length_at_row( job->rows, row + i, lane );
    const double before = i > 0 ? length_at_row( job->rows, row + i - 1, lane ) : behind;
    double mass = 0.0;
    int masses = 0;
    for ( int k = i > 0 ? i - 1 : 0; k <= i + 1; ++k )
    {
        const double m = mass_at( job->rows, row + k, lane );
        mass += m;
        masses += m > 0.0 ? 1 : 0;
    }
    const double step = job->dt * ( job->dt + (double)job->settings->bend_damping );
    const double l = fmin( before, behind ), mean = masses > 0 ? mass / masses : 0.0;
    const double most = most_stiffness( job, row, i, count, lane ) * mean * l * l * l / step;
    const double reach = strands_reach( job->rows, row, i, lane );
    return reach > 0.0 ? fmin( (double)job->settings->bend_rigidity, most ) / reach : 0.0;
}

// Entries (i, i), (i, i-1), (i, i-2) of M + (dt^2 + damping dt) K. Each vertex k bends with c_k over k-1, k, k+1.
static band row_of_system( const factor_job* job, int row, int i, int count, int lane )
{
    const double step = job->dt * ( job->dt + (double)job->settings->bend_damping );
    band out = { mass_at( job->rows, row + i, lane ), 0.0, 0.0 };
    for ( int k = i > 0 ? i - 1 : 0; k <= i + 1 && k + 1 < count; ++k )
    {
        const double stiffness = step * (double)job->stiffness[strands_scalar( row + k, lane )];
        const double behind = 1.0 / length_at_row( job->rows, row + k, lane );
        const double before = k > 0 ? 1.0 / length_at_row( job->rows, row + k - 1, lane ) : 0.0;
        const double c[3] = { before, -( before + behind ), behind }; // of k-1, k, k+1
        const int own = i - k + 1;
        out.pivot += stiffness * c[own] * c[own];
        out.first += own > 0 ? stiffness * c[own] * c[own - 1] : 0.0;
        out.second += own > 1 ? stiffness * c[own] * c[own - 2] : 0.0;
    }
    const bool pinned_before = i < 1 || mass_at( job->rows, row + i - 1, lane ) == 0.0;
    const bool pinned_first = i < 2 || mass_at( job->rows, row + i - 2, lane ) == 0.0;
    out.first = pinned_before ? 0.0 : out.first;
    out.second = pinned_first ? 0.0 : out.second;
    return out;
}

static void put_factor( const factor_job* job, int row, int lane, double inverse, double first, double second )
{
    strands_put( job->factor, row, lane, ( wisp_vec3 ){ (float)inverse, (float)first, (float)second } );
}

static void factor_strand( const factor_job* job, int row, int count, int lane )
{
    for ( int i = 0; i < count; ++i )
    {
        job->stiffness[strands_scalar( row + i, lane )] = (float)stiffness_of( job, row, i, count, lane );
    }
    band before = { 1.0, 0.0, 0.0 }, first = before;
    for ( int i = 0; i < count; ++i )
    {
        if ( mass_at( job->rows, row + i, lane ) == 0.0 )
        {
            put_factor( job, row + i, lane, 0.0, 0.0, 0.0 );
            first = before;
            before = ( band ){ 1.0, 0.0, 0.0 };
            continue;
        }
        const band a = row_of_system( job, row, i, count, lane );
        band l = { 0.0, 0.0, a.second / first.pivot };
        l.first = ( a.first - l.second * first.pivot * before.first ) / before.pivot;
        l.pivot = a.pivot - l.first * l.first * before.pivot - l.second * l.second * first.pivot;
        put_factor( job, row + i, lane, 1.0 / l.pivot, l.first, l.second );
        first = before;
        before = l;
    }
}

bool strands_factor_is_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    const strands_state* state = user;
    const float* factored = wisp_frame_column( frame, entity, state->clamp, 1 );
    return wisp_frame_strands( frame, entity )->group_count > 0 && factored[0] != wisp_frame_seconds( frame );
}

void strands_factor( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const strands_rows rows = strands_rows_in( frame, span->entity );
    const factor_job job = {
        .rows = &rows,
        .settings = wisp_frame_column( frame, span->entity, state->settings, 0 ),
        .stiffness = wisp_frame_column( frame, span->entity, state->rod, 1 ),
        .factor = wisp_frame_column( frame, span->entity, state->rod, 2 ),
        .dt = (double)wisp_frame_seconds( frame ),
        .curled = wisp_frame_has( frame, span->entity, state->curve ),
    };
    float* factored = wisp_frame_column( frame, span->entity, state->clamp, 1 );
    for ( int g = span->begin; g < span->end; ++g )
    {
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            factor_strand( &job, rows.topology->group_row[g], rows.topology->lane_count[g * WISP_LANES + lane],
                           lane );
        }
        factored[g] = wisp_frame_seconds( frame );
    }
}
