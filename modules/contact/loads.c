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
#include "loads.h"

#include "slip.h"

#include <string.h>

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
