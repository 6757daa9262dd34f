// Layers of a world by entity, and their elements in the user's numbers.
#include "boundary_internal.h"

#include <stdlib.h>
#include <string.h>

// ---- layers by entity ----

// Index of the first layer whose entity is not below `index`.
static int place_of( const boundary_state* state, uint32_t index )
{
    int lower = 0, upper = state->layer_count;
    while ( lower < upper )
    {
        const int middle = lower + ( upper - lower ) / 2;
        const bool below = state->layers[middle]->entity.index < index;
        lower = below ? middle + 1 : lower;
        upper = below ? upper : middle;
    }
    return lower;
}

static bool is_at( const boundary_state* state, int place, wisp_entity entity )
{
    return place < state->layer_count && wisp_entity_equal( state->layers[place]->entity, entity );
}

boundary_layer* boundary_find_layer( const boundary_state* state, wisp_entity entity )
{
    const int place = place_of( state, entity.index );
    return is_at( state, place, entity ) ? state->layers[place] : NULL;
}

void boundary_put_layer( boundary_state* state, boundary_layer* layer )
{
    const int place = place_of( state, layer->entity.index );
    WISP_ASSERT( state->layer_count < state->layer_capacity && is_at( state, place, layer->entity ) == false );
    memmove( state->layers + place + 1, state->layers + place,
             (size_t)( state->layer_count - place ) * sizeof( *state->layers ) );
    state->layers[place] = layer;
    state->layer_count += 1;
}

void boundary_drop_layer( boundary_state* state, const wisp_allocator* allocator, wisp_entity entity )
{
    const int place = place_of( state, entity.index );
    if ( is_at( state, place, entity ) )
    {
        boundary_layer_release( state->layers[place], allocator );
        state->layer_count -= 1;
        memmove( state->layers + place, state->layers + place + 1,
                 (size_t)( state->layer_count - place ) * sizeof( *state->layers ) );
    }
}

// ---- elements ----

static int compare_pairs( const void* a, const void* b )
{
    const int32_t *p = a, *q = b;
    const int first = ( p[0] > q[0] ) - ( p[0] < q[0] );
    return first != 0 ? first : ( p[1] > q[1] ) - ( p[1] < q[1] );
}

static void name_edges( boundary_layer* layer, const wisp_fabric* fabric )
{
    for ( size_t e = 0; e < (size_t)layer->edge_count; ++e )
    {
        const int32_t a = fabric->slot_vertex[fabric->edges[2 * e]],
                      b = fabric->slot_vertex[fabric->edges[2 * e + 1]];
        layer->edges[2 * e] = a < b ? a : b;
        layer->edges[2 * e + 1] = a < b ? b : a;
    }
    if ( layer->edge_count > 0 )
    {
        qsort( layer->edges, (size_t)layer->edge_count, 2 * sizeof( int32_t ), compare_pairs );
    }
    for ( size_t i = 0; i < 2 * (size_t)layer->edge_count; ++i )
    {
        layer->edge_slots[i] = fabric->vertex_slot[layer->edges[i]];
    }
}

static int32_t find_edge( const boundary_layer* layer, int32_t a, int32_t b )
{
    const int32_t requested[2] = { a < b ? a : b, a < b ? b : a };
    const int32_t* found =
        bsearch( requested, layer->edges, (size_t)layer->edge_count, 2 * sizeof( int32_t ), compare_pairs );
    WISP_ASSERT( found != NULL );
    return (int32_t)( ( found - layer->edges ) / 2 );
}

static void name_triangle_edges( boundary_layer* layer, const wisp_fabric* fabric )
{
    for ( size_t side = 0; side < 3 * (size_t)layer->triangle_count; ++side )
    {
        const int32_t* slots = fabric->triangles + side / 3 * 3;
        layer->triangle_edge[side] =
            find_edge( layer, fabric->slot_vertex[slots[side % 3]], fabric->slot_vertex[slots[( side + 1 ) % 3]] );
    }
}

boundary_layer* boundary_layer_create( const wisp_allocator* allocator, const wisp_fabric* fabric,
                                       wisp_entity entity )
{
    const size_t edges = (size_t)fabric->edge_count * 2, sides = (size_t)fabric->triangle_count * 3;
    const size_t bytes = sizeof( boundary_layer ) + ( 2 * edges + sides ) * sizeof( int32_t );
    boundary_layer* layer = allocator->allocate( allocator->user, bytes, 64 );
    if ( layer == NULL )
    {
        return NULL;
    }
    int32_t* arrays = (int32_t*)( layer + 1 );
    *layer = ( boundary_layer ){
        .entity = entity,
        .edge_count = fabric->edge_count,
        .triangle_count = fabric->triangle_count,
        .edges = arrays,
        .edge_slots = arrays + edges,
        .triangle_edge = arrays + 2 * edges,
        .bytes = bytes,
    };
    name_edges( layer, fabric );
    name_triangle_edges( layer, fabric );
    return layer;
}

void boundary_layer_release( boundary_layer* layer, const wisp_allocator* allocator )
{
    if ( layer != NULL )
    {
        wisp_samples_release( &layer->samples, allocator );
        wisp_buffer_release( &layer->moved, allocator );
        allocator->release( allocator->user, layer, layer->bytes );
    }
}
