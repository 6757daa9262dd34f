// Masses and rest lengths. In: definition and rest shape. Out: inverse masses, lengths of segments, rest lengths of
// links over one and two segments. Sums are in double precision. A segment gives half of its mass to each of its
// vertices.
#include "masses_lengths.h"

#include "strand_rows.h"

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
