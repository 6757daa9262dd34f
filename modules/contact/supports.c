// Supports. In: half spaces that bodies leave to particles, rows of the substep. Out: for each point the layer that it
// is in above a body, and the direction away from what is below it; displacements that respect both.
//
// - Bodies win: a point that touches one is not pushed into it. The constraint takes no displacement along the normal of
//   the body, as a solver takes none along a prescribed direction (Baraff and Witkin 1998); the other points of the row
//   move by the rest.
// - Layers that lie on a supported layer count as supported in turn. In a row of two layers the lower one takes no
//   displacement against its support: the upper one moves alone, as in shock propagation (Guendelman, Bridson and Fedkiw
//   2003). So a pile stands after one sweep, whatever its height and its ratio of masses, and a heavy layer cannot
//   crush a light one. Displacements along the layers are shared by mass as everywhere.
#include "supports.h"

#include <string.h>

// ---- half spaces ----

contact_half_spaces contact_half_spaces_of( const contact_work* work, int point )
{
    const contact_participant* participant = contact_participant_of( work, point );
    const int i = point - participant->first_point;
    if ( participant->half_spaces == NULL || participant->half_spaces[i] == 0 )
    {
        return ( contact_half_spaces ){ NULL, 0 };
    }
    const int found = participant->half_spaces[i];
    return ( contact_half_spaces ){ participant->half_space_row + (size_t)i * 16 * WISP_MAX_HALF_SPACES,
                                    found < WISP_MAX_HALF_SPACES ? found : WISP_MAX_HALF_SPACES };
}

// Return how far a point is from the border of a half space, m; negative: it has left it.
static float distance_in( const float* half, const float p[3] )
{
    const float from[3] = { p[0] - half[0], p[1] - half[1], p[2] - half[2] };
    return contact_dot( half + 3, from ) - half[9];
}

static void remove_along( const float normal[3], float direction[3] )
{
    const float along = contact_dot( normal, direction );
    for ( int c = 0; c < 3; ++c )
    {
        direction[c] -= along * normal[c];
    }
}

// ---- layers ----

// Cosine of the largest angle between the directions of two layers of a pile.
static const float STEEPEST = 0.5f;

bool contact_reserve_supports( const contact_work* work )
{
    contact_supports* supports = work->contact_mesh->supports;
    const size_t points = (size_t)work->contact_mesh->point_count;
    return contact_reserve( work, supports->buffers, points * sizeof( contact_support ),
                            (void**)&supports->points ) &&
           contact_reserve( work, supports->buffers + 1, points * sizeof( contact_load ),
                            (void**)&supports->loads ) &&
           contact_reserve( work, supports->buffers + 2, points * sizeof( contact_tally ),
                            (void**)&supports->tallies );
}

// Points that touch a body are the lowest layer.
static void find_lowest( const contact_work* work, const contact_participant* participant )
{
    contact_contact_mesh* s = work->contact_mesh;
    const float near = 0.5f * participant->settings.thickness;
    for ( int i = 0; i < participant->point_count; ++i )
    {
        const int point = participant->first_point + i;
        contact_support* support = s->supports->points + point;
        support->layer = CONTACT_NO_SUPPORT;
        const contact_half_spaces held = contact_half_spaces_of( work, point );
        for ( int k = 0; k < held.count && support->layer != 0; ++k )
        {
            const float* half = held.row + (size_t)k * 16;
            if ( distance_in( half, s->now + (size_t)point * 4 ) < near )
            {
                memcpy( support->normal, half + 3, 3 * sizeof( float ) );
                memcpy( support->motion, half + 6, 3 * sizeof( float ) );
                support->layer = 0;
                s->supports->any = true;
            }
        }
    }
}

// Return the lowest point of a side of a row that supports in a direction, null if none does.
static const contact_support* find_below( const contact_supports* supports, const contact_row* row, contact_side side,
                                          const float up[3] )
{
    const contact_support* lowest = NULL;
    for ( int i = side.begin; i < side.end; ++i )
    {
        const contact_support* support = supports->points + row->point[i];
        if ( support->layer < ( lowest != NULL ? lowest->layer : CONTACT_MAX_LAYERS ) && row->weight[i] != 0.0f &&
             contact_dot( support->normal, up ) > STEEPEST )
        {
            lowest = support;
        }
    }
    return lowest;
}

// Return the lowest or the highest layer of a side.
static int layer_of( const contact_supports* supports, const contact_row* row, contact_side side, bool highest )
{
    int layer = supports->points[row->point[side.begin]].layer;
    for ( int i = side.begin + 1; i < side.end; ++i )
    {
        const int other = supports->points[row->point[i]].layer;
        layer = ( other > layer ) == highest ? other : layer;
    }
    return layer;
}

// Lay one side of a row on the other. @return whether a layer changed
static bool lay_on( contact_supports* supports, const contact_row* row, contact_side side, contact_side other,
                    const float up[3] )
{
    if ( layer_of( supports, row, other, false ) + 1 >= layer_of( supports, row, side, true ) )
    {
        return false; // nearly all rows, so before anything is computed
    }
    const contact_support* below = find_below( supports, row, other, up );
    bool any = false;
    for ( int i = side.begin; i < side.end && below != NULL; ++i )
    {
        contact_support* support = supports->points + row->point[i];
        if ( below->layer + 1 < support->layer )
        {
            memcpy( support->normal, up, 3 * sizeof( float ) );
            memcpy( support->motion, below->motion, 3 * sizeof( float ) );
            support->layer = below->layer + 1;
            any = true;
        }
    }
    return any;
}

static bool lay_row( contact_supports* supports, const contact_row* row )
{
    const float* n = row->normal;
    const float down[3] = { -n[0], -n[1], -n[2] };
    const contact_side first = { 0, row->split }, second = { row->split, row->count };
    const bool any = lay_on( supports, row, first, second, n );
    return lay_on( supports, row, second, first, down ) || any;
}

void contact_find_supports( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    s->supports->any = false;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        find_lowest( work, work->participants + g );
    }
    bool changes = s->supports->any;
    for ( int sweep = 0; sweep < CONTACT_MAX_LAYERS && changes; ++sweep )
    {
        changes = false;
        for ( int r = 0; r < s->constraints->row_count; ++r )
        {
            const contact_row* row = s->constraints->rows + r;
            const bool touches = row->distance < 1.5f * row->requested;
            changes = ( touches && lay_row( s->supports, row ) ) || changes;
        }
    }
}

// ---- displacements ----

float contact_mobility_of( const contact_contact_mesh* s, const contact_row* row, contact_side side )
{
    float sum = 0.0f, farthest = 0.0f;
    for ( int i = side.begin; i < side.end; ++i )
    {
        const float way = s->now[(size_t)row->point[i] * 4 + 3] * row->weight[i];
        sum += way * row->weight[i];
        farthest = contact_larger( farthest, fabsf( way ) );
    }
    return contact_larger( sum, farthest / CONTACT_MAX_LEVER );
}

bool contact_is_supported( const contact_work* work, const contact_row* row )
{
    const contact_supports* supports = work->contact_mesh->supports;
    bool any = false;
    for ( int i = 0; i < row->count && supports->any; ++i )
    {
        any = any || supports->points[row->point[i]].layer < CONTACT_NO_SUPPORT;
    }
    return any;
}

const contact_support* contact_highest( const contact_supports* supports, const contact_row* row, contact_side side )
{
    const contact_support* highest = NULL;
    for ( int i = side.begin; i < side.end; ++i )
    {
        const contact_support* support = supports->points + row->point[i];
        if ( support->layer < CONTACT_NO_SUPPORT && ( highest == NULL || support->layer > highest->layer ) )
        {
            highest = support;
        }
    }
    return highest;
}

contact_side contact_upper_side( const contact_work* work, const contact_row* row )
{
    const contact_supports* supports = work->contact_mesh->supports;
    const contact_side first = { 0, row->split }, second = { row->split, row->count };
    const contact_support *a = contact_highest( supports, row, first ), *b = contact_highest( supports, row, second );
    if ( a == NULL || b == NULL || a->layer == b->layer )
    {
        return ( contact_side ){ 0, 0 };
    }
    return a->layer > b->layer ? first : second;
}

// Take from a direction what would push the point against its support or out of a half space.
// @param length of the displacement along the direction, m @param above highest layer of the other side
static void keep_supported( const contact_work* work, int point, float length, int above, float direction[3] )
{
    const contact_contact_mesh* s = work->contact_mesh;
    const contact_support* support = s->supports->points + point;
    const float against =
        length > 0.0f ? -contact_dot( support->normal, direction ) : contact_dot( support->normal, direction );
    if ( support->layer < above && against > STEEPEST )
    {
        memset( direction, 0, 3 * sizeof( float ) );
        return;
    }
    const contact_half_spaces held = contact_half_spaces_of( work, point );
    for ( int k = 0; k < held.count; ++k )
    {
        const float* half = held.row + (size_t)k * 16;
        const float way = length * contact_dot( half + 3, direction );
        if ( way < 0.0f && distance_in( half, s->now + (size_t)point * 4 ) + way < 0.0f )
        {
            remove_along( half + 3, direction );
        }
    }
}

void contact_move_supported( const contact_work* work, contact_row* row, float change, float sum )
{
    contact_contact_mesh* s = work->contact_mesh;
    const contact_side sides[2] = { { 0, row->split }, { row->split, row->count } };
    const contact_support* highest[2] = { contact_highest( s->supports, row, sides[0] ),
                                          contact_highest( s->supports, row, sides[1] ) };
    float directions[CONTACT_MAX_POINTS][3], left = 0.0f, farthest = 0.0f;
    for ( int i = 0; i < row->count; ++i )
    {
        const float fraction = s->now[(size_t)row->point[i] * 4 + 3] * row->weight[i];
        memcpy( directions[i], row->normal, 3 * sizeof( float ) );
        const contact_support* other = highest[i < row->split ? 1 : 0];
        keep_supported( work, row->point[i], change / sum * fraction, other != NULL ? other->layer : -1,
                        directions[i] );
        left += fraction * row->weight[i] * contact_dot( row->normal, directions[i] );
        farthest =
            contact_larger( farthest, fabsf( fraction ) * sqrtf( contact_dot( directions[i], directions[i] ) ) );
    }
    left = contact_larger( left, farthest / CONTACT_MAX_LEVER );
    const bool moves = left > 1e-6f * sum;
    // in a second sweep the push over the sum of both impulses, whose directions may differ
    const float before = row->mobility > 0.0f ? ( row->normal_correction - change ) / row->mobility : 0.0f;
    const float impulse = before + ( moves ? change / left : 0.0f );
    row->mobility = before != 0.0f && impulse > 0.0f ? row->normal_correction / impulse : moves ? left : 0.0f;
    for ( int i = 0; i < row->count && moves; ++i )
    {
        const size_t at = (size_t)row->point[i] * 4;
        const float length = change / left * s->now[at + 3] * row->weight[i];
        for ( size_t c = 0; c < 3; ++c )
        {
            s->now[at + c] += length * directions[i][c];
        }
    }
}

void contact_keep_inside( const contact_work* work, const contact_row* row )
{
    for ( int i = 0; i < row->count; ++i )
    {
        float* p = work->contact_mesh->now + (size_t)row->point[i] * 4;
        const contact_half_spaces held = contact_half_spaces_of( work, row->point[i] );
        for ( int k = 0; k < held.count && p[3] > 0.0f; ++k )
        {
            const float* half = held.row + (size_t)k * 16;
            const float out = contact_smaller( distance_in( half, p ), 0.0f );
            for ( int c = 0; c < 3; ++c )
            {
                p[c] -= out * half[3 + c];
            }
        }
    }
}
