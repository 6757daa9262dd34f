// Bending of thin plates on a mesh: creation, and what the kernels read. Equations: wisp/module/plate.h.
#include "plate_parts.h"

#include "fabric.h"

#include <math.h>

// Squared gradients of an angle may be so many times those of the rest shape before the moment is scaled down.
static const double STEEPEST = 2.0;

// The steepest gradients, and the least height of the triangles at each vertex; vertices without a hinge do not bend.
static void measure_hinges( wisp_plate* plate, const wisp_fabric* f )
{
    for ( int slot = 0; slot < f->slot_count; ++slot )
    {
        plate->least_height[slot] = INFINITY;
    }
    for ( int n = 0; n < plate->hinge_count; ++n )
    {
        const int32_t* corner = plate_corners( f, plate->hinges + n );
        plate_shape shape = { 0 };
        plate_measure_hinge( f, plate->hinges + n, &shape );
        const double k = shape.height[0], l = shape.height[1];
        plate->steepest[plate->turns.item_row[n]] = (float)( STEEPEST * ( 1.0 / ( k * k ) + 1.0 / ( l * l ) ) );
        for ( int i = 0; i < PLATE_CORNERS; ++i )
        {
            plate->least_height[corner[i]] = fminf( plate->least_height[corner[i]], (float)fmin( k, l ) );
        }
    }
}

// Groups of triangles, and where they read moments: at the slots of hinges.
static bool cook_triangles( wisp_plate* plate, const wisp_fabric* f )
{
    const fabric_constraints triangles = {
        .slots = f->triangles,
        .count = f->triangle_count,
        .arity = 3,
        .vertex_count = f->vertex_count,
        .tile_size = f->tile_size,
        .solve_order = f->solve_order,
    };
    wisp_schedule* order = &plate->triangles;
    if ( fabric_schedule_build( &triangles, &plate->pool, order ) == false ||
         fabric_schedule_corners( order, &triangles, &plate->pool, &plate->corner_x4 ) == false )
    {
        return false;
    }
    plate->moment_of = fabric_pool_push( &plate->pool, 3 * (size_t)order->slot_count, sizeof( int32_t ) );
    for ( int i = 0; i < 3 * order->slot_count && plate->moment_of != NULL; ++i )
    {
        const int32_t triangle = order->constraint[i / 24 * 8 + i % 8];
        const int32_t hinge = triangle >= 0 ? plate->triangle_hinge[triangle][( i / 8 + 1 ) % 3] : -1;
        plate->moment_of[i] = hinge >= 0 ? plate->turns.item_row[hinge] : f->hinge_order.slot_count;
    }
    return plate->moment_of != NULL;
}

// Rows of hinges are the slots of their schedule.
static bool cook_turns( wisp_plate* plate, const wisp_fabric* f, fabric_pool* scratch )
{
    const size_t slots = (size_t)f->hinge_order.slot_count;
    plate_row_set* set = &plate->turns;
    *set =
        ( plate_row_set ){ .of_hinges = true, .item_count = plate->hinge_count, .slice_count = (int)( slots / 8 ) };
    int32_t* slot_of = fabric_pool_push( scratch, (size_t)f->hinge_count, sizeof( int32_t ) );
    set->item_row = fabric_pool_push( &plate->pool, (size_t)plate->hinge_count, sizeof( int32_t ) );
    plate->stiffness = fabric_pool_push_zeroed( &plate->pool, slots, sizeof( float ) );
    plate->steepest = fabric_pool_push_zeroed( &plate->pool, slots, sizeof( float ) );
    plate->least_height = fabric_pool_push( &plate->pool, (size_t)f->slot_count, sizeof( float ) );
    if ( slot_of == NULL || set->item_row == NULL || plate->stiffness == NULL || plate->steepest == NULL ||
         plate->least_height == NULL )
    {
        return false;
    }
    for ( size_t slot = 0; slot < slots; ++slot )
    {
        if ( f->hinge_order.constraint[slot] >= 0 )
        {
            slot_of[f->hinge_order.constraint[slot]] = (int32_t)slot;
        }
    }
    for ( int32_t n = 0; n < plate->hinge_count; ++n )
    {
        set->item_row[n] = slot_of[plate->hinges[n].constraint];
    }
    measure_hinges( plate, f );
    return cook_triangles( plate, f ) && plate_cook_rows( plate, f, set, scratch );
}

static bool cook_plate( wisp_plate* plate, const wisp_fabric* f, const int32_t* slot_row, bool with_turns,
                        fabric_pool* scratch )
{
    fabric_pool* keep = &plate->pool;
    int32_t* item_row = fabric_pool_push( keep, (size_t)f->vertex_count, sizeof( int32_t ) );
    plate->hinges = fabric_pool_push( keep, (size_t)f->hinge_count, sizeof( plate_hinge ) );
    plate->triangle_hinge = fabric_pool_push( keep, (size_t)f->triangle_count, sizeof( plate->triangle_hinge[0] ) );
    plate->pinned = fabric_pool_push_zeroed( keep, (size_t)f->vertex_count, sizeof( uint8_t ) );
    const int rows = 8 * plate->vertices.slice_count, hinges = with_turns ? f->hinge_order.slot_count : 0;
    plate->place = fabric_pool_push_zeroed( keep, (size_t)( rows > hinges ? rows : hinges ), sizeof( uint8_t ) );
    if ( item_row == NULL || plate->hinges == NULL || plate->triangle_hinge == NULL || plate->pinned == NULL ||
         plate->place == NULL || plate_cook_hinges( plate, f, scratch ) == false )
    {
        return false;
    }
    for ( int32_t v = 0; v < f->vertex_count; ++v )
    {
        item_row[v] = slot_row != NULL ? slot_row[v] : v;
    }
    plate->vertices.item_row = item_row;
    plate->vertices.item_count = f->vertex_count;
    return plate_cook_rows( plate, f, &plate->vertices, scratch ) &&
           ( with_turns == false || cook_turns( plate, f, scratch ) );
}

wisp_status wisp_plate_create( const wisp_fabric* fabric, const int32_t* slot_row, int row_count, bool with_turns,
                               const wisp_allocator* allocator, wisp_plate** out )
{
    fabric_pool pool = { .allocator = allocator }, scratch = { .allocator = allocator };
    wisp_plate* plate = fabric_pool_push_zeroed( &pool, 1, sizeof( wisp_plate ) );
    *out = NULL;
    if ( plate == NULL )
    {
        return WISP_NO_MEMORY;
    }
    plate->pool = pool;
    plate->vertices.slice_count = row_count / 8;
    const bool done = cook_plate( plate, fabric, slot_row, with_turns, &scratch );
    fabric_pool_release( &scratch );
    if ( done == false )
    {
        wisp_plate_release( plate, allocator );
        return WISP_NO_MEMORY;
    }
    *out = plate;
    return WISP_OK;
}

void wisp_plate_release( wisp_plate* plate, const wisp_allocator* allocator )
{
    if ( plate != NULL )
    {
        fabric_pool pool = plate->pool; // the plate itself lies in it
        pool.allocator = allocator;
        fabric_pool_release( &pool );
    }
}

size_t wisp_plate_bytes( const wisp_plate* plate )
{
    return plate != NULL ? plate->pool.bytes : 0;
}

wisp_plate_rows wisp_plate_get_rows( const wisp_plate* plate )
{
    return ( wisp_plate_rows ){
        .slice_count = plate->vertices.slice_count,
        .begin = plate->vertices.begin,
        .other_x4 = (const int32_t( * )[8])plate->vertices.other,
        .weight = (const float( * )[8])plate->vertices.weight,
    };
}

wisp_plate_turns wisp_plate_get_turns( const wisp_plate* plate )
{
    return ( wisp_plate_turns ){
        .begin = plate->turns.begin,
        .other = (const int32_t( * )[8])plate->turns.other,
        .weight = (const float( * )[8])plate->turns.weight,
        .stiffness = plate->stiffness,
        .steepest = plate->steepest,
        .least_height = plate->least_height,
        .triangles = &plate->triangles,
        .corner_x4 = plate->corner_x4,
        .moment_of = plate->moment_of,
    };
}

float wisp_plate_max_rate( const wisp_plate* plate )
{
    return plate->max_rate;
}
