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

// Loads. In: corrections of rows in a pile. Out: the weight of upper layers in the friction of lower ones.
//
// Upper layers do not move lower ones (supports.c), so their weight has to reach the friction below in another way. Each
// substep hands the impulse J of a row down to the points of its lower layer, which share it among the rows below them
// in the next substep; on the lowest layer it acts on the friction of the body at once.
//
// - The grip of a point is the smallest coefficient of friction on the way down to the body. Up to min( mu, grip ) J the
//   upper layer is held by the body itself, through the layers between. Were friction only between neighbours, both of
//   which move, a pile on a slope would creep by the displacement of a substep, each substep.
// - What is left up to mu J acts between the two layers, by their masses: an upper layer that slides on the floor takes
//   lower ones along.
// - Friction that an upper layer got from below is no longer there for the layers between: it is handed down as well.

void contact_begin_loads( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        const size_t bytes = (size_t)participant->point_count * sizeof( contact_load );
        contact_load* to = s->supports->loads + participant->first_point;
        if ( participant->loads != NULL )
        {
            memcpy( to, participant->loads, bytes );
        }
        else
        {
            memset( to, 0, bytes );
        }
    }
}

static bool is_in( contact_side side, int i )
{
    return i >= side.begin && i < side.end;
}

// Return the load that a row carries, and the smallest grip of its lower layer.
static contact_load load_of( const contact_work* work, const contact_row* row, contact_side upper )
{
    const contact_load* loads = work->contact_mesh->supports->loads;
    const bool is_pile = upper.end > 0;
    contact_load sum = { .normal = row->mobility > 0.0f ? row->normal_correction / row->mobility : 0.0f,
                         .grip = is_pile ? row->friction : 0.0f };
    for ( int i = 0; i < row->count && is_pile; ++i )
    {
        const contact_load* load = loads + row->point[i];
        sum.normal += is_in( upper, i ) ? load->normal : 0.0f;
        sum.held += is_in( upper, i ) ? load->held : 0.0f;
        sum.grip = is_in( upper, i ) || row->weight[i] == 0.0f ? sum.grip : contact_smaller( sum.grip, load->grip );
    }
    return sum;
}

// Move the points of a side so that the sides shift by this way along each other.
static void shift_side( contact_contact_mesh* s, const contact_row* row, contact_side side, float mobility,
                        const float by[3] )
{
    for ( int i = side.begin; i < side.end; ++i )
    {
        const size_t at = (size_t)row->point[i] * 4;
        const float fraction = s->now[at + 3] * row->weight[i] / mobility;
        for ( size_t k = 0; k < 3; ++k )
        {
            s->now[at + k] += fraction * by[k];
        }
    }
}

// How far the upper side moved relative to the body below, as a way of the first side relative to the second.
static void way_on_body( const contact_work* work, const contact_row* row, contact_side upper, float way[3] )
{
    const contact_contact_mesh* s = work->contact_mesh;
    const float* motion = contact_highest( s->supports, row, upper )->motion;
    const float sign = upper.begin == 0 ? -1.0f : 1.0f;
    for ( int k = 0; k < 3; ++k )
    {
        way[k] = sign * motion[k];
    }
    contact_add_way( s, row, upper.begin, upper.end, way );
}

void contact_apply_pile_friction( const contact_work* work, contact_row* row )
{
    contact_contact_mesh* s = work->contact_mesh;
    const contact_side upper = contact_upper_side( work, row ), both = { 0, row->count };
    const contact_load load = load_of( work, row, upper );
    const float mobility = contact_mobility_of( s, row, upper ), all = contact_mobility_of( s, row, both );
    float way[3], by[3], left = row->friction * load.normal - load.held;
    if ( mobility > 0.0f && load.grip > 0.0f )
    {
        way_on_body( work, row, upper, way );
        contact_find_slip( row, way, mobility * contact_larger( load.grip * load.normal - load.held, 0.0f ), by );
        shift_side( s, row, upper, mobility, by );
        left -= sqrtf( contact_dot( row->tangential_correction, row->tangential_correction ) ) / mobility;
    }
    if ( all > 0.0f && left > 0.0f )
    {
        contact_row rest = *row;
        memset( rest.tangential_correction, 0, sizeof( rest.tangential_correction ) );
        memset( way, 0, sizeof( way ) );
        contact_add_way( s, row, 0, row->count, way );
        contact_find_slip( &rest, way, all * left, by );
        shift_side( s, row, both, all, by );
    }
}

// Add what a row carries to the points of its lower layer, and its grip to those of its upper one.
static void press_down( const contact_work* work, const contact_row* row )
{
    contact_supports* supports = work->contact_mesh->supports;
    if ( !( row->normal_correction > 0.0f ) )
    {
        return; // most rows
    }
    const contact_side upper = contact_upper_side( work, row );
    if ( upper.end == 0 )
    {
        return;
    }
    const contact_load load = load_of( work, row, upper );
    const float mobility = contact_mobility_of( work->contact_mesh, row, upper );
    const float* t = row->tangential_correction;
    const float held = load.held + ( mobility > 0.0f ? sqrtf( contact_dot( t, t ) ) / mobility : 0.0f );
    for ( int i = 0; i < row->count; ++i )
    {
        contact_tally* tally = supports->tallies + row->point[i];
        if ( is_in( upper, i ) )
        {
            tally->grip = tally->rows == 0 ? load.grip : contact_smaller( tally->grip, load.grip );
            tally->rows += 1;
        }
        else
        {
            tally->normal += fabsf( row->weight[i] ) * load.normal;
            tally->held += fabsf( row->weight[i] ) * held;
        }
    }
}

// The half space that supports a point of the lowest layer.
static const float* ground_of( const contact_work* work, int point )
{
    const contact_half_spaces held = contact_half_spaces_of( work, point );
    const float* normal = work->contact_mesh->supports->points[point].normal;
    int k = 0;
    while ( k + 1 < held.count && memcmp( held.row + (size_t)k * 16 + 3, normal, 3 * sizeof( float ) ) != 0 )
    {
        ++k;
    }
    return held.row + (size_t)k * 16;
}

// Friction of a body on a point of the lowest layer, whose normal correction the load adds to: the law of the kernel
// half_space, less what upper layers got.
static void rub_on_body( const contact_work* work, const float* half, int point, const contact_tally* tally )
{
    contact_contact_mesh* s = work->contact_mesh;
    float* p = s->now + (size_t)point * 4;
    const float* start = s->intersection_free + (size_t)point * 4;
    const float *n = half + 3, *motion = half + 6, *done = half + 11;
    const float normal = half[10] + tally->normal * p[3];
    float way[3] = { p[0] - start[0] - motion[0], p[1] - start[1] - motion[1], p[2] - start[2] - motion[2] };
    const float along = contact_dot( n, way );
    for ( int k = 0; k < 3; ++k )
    {
        way[k] -= along * n[k] + done[k];
    }
    const float length = sqrtf( contact_dot( way, way ) ), held = tally->held * p[3];
    const bool stands = length == 0.0f || length <= half[14] * normal - held;
    const float fraction = stands ? 1.0f : contact_larger( half[15] * normal - held, 0.0f ) / length;
    for ( int k = 0; k < 3; ++k )
    {
        p[k] += -fraction * way[k] - done[k];
    }
}

void contact_hand_down_loads( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    contact_supports* supports = s->supports;
    memset( supports->tallies, 0, (size_t)s->point_count * sizeof( contact_tally ) );
    for ( int r = 0; r < s->constraints->row_count && supports->any; ++r )
    {
        press_down( work, s->constraints->rows + r );
    }
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        for ( int i = 0; i < participant->point_count && participant->loads != NULL; ++i )
        {
            const int point = participant->first_point + i;
            const contact_tally* tally = supports->tallies + point;
            const bool is_lowest = supports->points[point].layer == 0 && s->now[(size_t)point * 4 + 3] > 0.0f;
            const float* half = is_lowest ? ground_of( work, point ) : NULL;
            if ( is_lowest && tally->normal > 0.0f )
            {
                rub_on_body( work, half, point, tally );
            }
            const float part = tally->rows > 0 ? 1.0f / (float)tally->rows : 0.0f;
            participant->loads[i] = ( contact_load ){
                .normal = part * tally->normal,
                .held = part * tally->held,
                .grip = is_lowest ? half[14] : tally->grip,
            };
        }
    }
}

void contact_add_way( const contact_contact_mesh* s, const contact_row* row, int begin, int end, float way[3] )
{
    for ( int i = begin; i < end; ++i )
    {
        const float *p = s->now + (size_t)row->point[i] * 4, *q = s->intersection_free + (size_t)row->point[i] * 4;
        for ( int k = 0; k < 3; ++k )
        {
            way[k] += row->weight[i] * ( p[k] - q[k] );
        }
    }
}

void contact_find_slip( contact_row* row, const float way[3], float most, float by[3] )
{
    const float* n = row->normal;
    const float along = n[0] * way[0] + n[1] * way[1] + n[2] * way[2];
    float requested[3], squared = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        requested[k] = row->tangential_correction[k] - ( way[k] - along * n[k] );
        squared += requested[k] * requested[k];
    }
    const float scale = squared > most * most ? most / sqrtf( squared ) : 1.0f;
    for ( int k = 0; k < 3; ++k )
    {
        by[k] = scale * requested[k] - row->tangential_correction[k];
        row->tangential_correction[k] = scale * requested[k];
    }
}
