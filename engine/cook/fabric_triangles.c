// Other triangles for the same vertices. In: a fabric, its new triangles, which vertices were copied. Out: a fabric in the same slots,
// and where each of its edges, links and hinges comes from.
#include "fabric_triangles.h"

#include "fabric.h"

#include "alloc.h"

#include <string.h>

// ---- cooking ----

typedef struct user_mesh
{
    wisp_vec3* points;
    int32_t *triangles, *attachments;
} user_mesh;

// Back to the user's order, from which everything is cooked.
static bool restore_mesh( const wisp_fabric* from, const int32_t* triangles, const int32_t* parents,
                          fabric_pool* pool, user_mesh* out )
{
    const size_t corners = 3 * (size_t)from->triangle_count;
    out->points = fabric_pool_push( pool, (size_t)from->vertex_count, sizeof( wisp_vec3 ) );
    out->triangles = fabric_pool_push( pool, corners, sizeof( int32_t ) );
    out->attachments = fabric_pool_push( pool, (size_t)from->attachment_count, sizeof( int32_t ) );
    if ( out->points == NULL || out->triangles == NULL || out->attachments == NULL )
    {
        return false;
    }
    for ( int slot = 0; slot < from->vertex_count; ++slot )
    {
        out->points[from->slot_vertex[slot]] = from->rest[parents[slot]];
    }
    for ( size_t i = 0; i < corners; ++i )
    {
        out->triangles[i] = from->slot_vertex[triangles[i]];
    }
    for ( int i = 0; i < from->attachment_count; ++i )
    {
        out->attachments[i] = from->slot_vertex[from->attachments[i]];
    }
    return true;
}

wisp_status fabric_change_triangles( const wisp_fabric* from, const int32_t* triangles, const int32_t* parents,
                                     const wisp_allocator* allocator, wisp_fabric** out, wisp_error* error )
{
    fabric_pool pool = { .allocator = allocator };
    user_mesh mesh;
    *out = NULL;
    wisp_status status = restore_mesh( from, triangles, parents, &pool, &mesh )
                             ? WISP_OK
                             : wisp_fail( error, WISP_NO_MEMORY,
                                          "out of memory to cook a fabric of %d vertices again", from->vertex_count );
    if ( status == WISP_OK )
    {
        wisp_fabric_def def = wisp_default_fabric_def();
        def.points = mesh.points, def.vertex_count = from->vertex_count;
        def.triangles = mesh.triangles, def.triangle_count = from->triangle_count;
        def.attachments = mesh.attachments, def.attachment_count = from->attachment_count;
        def.bend_links = from->link_count > from->edge_count;
        def.hinges = from->hinge_order.slot_count > 0;
        def.solve_order = from->solve_order;
        def.tile_size = from->tile_size;
        status = fabric_cook_checked( &def, from, allocator, out, error );
    }
    fabric_pool_release( &pool );
    return status;
}

// ---- origins ----

// Numbers of the earlier fabric by edge.
typedef struct edge_numbers
{
    int32_t *hinge, *bend_link; // [edge_count], -1: none
    int32_t* link_slot;         // [link_count]
    int32_t* hinge_slot;        // [hinge_count]
} edge_numbers;

static void list_slots( const wisp_schedule* order, int32_t* slot_of )
{
    for ( int slot = 0; slot < order->slot_count; ++slot )
    {
        if ( order->constraint[slot] >= 0 )
        {
            slot_of[order->constraint[slot]] = slot;
        }
    }
}

static bool number_edges( const wisp_fabric* f, fabric_pool* pool, edge_numbers* out )
{
    const size_t edges = (size_t)f->edge_count * sizeof( int32_t );
    out->hinge = fabric_pool_push( pool, (size_t)f->edge_count, sizeof( int32_t ) );
    out->bend_link = fabric_pool_push( pool, (size_t)f->edge_count, sizeof( int32_t ) );
    out->link_slot = fabric_pool_push( pool, (size_t)f->link_count, sizeof( int32_t ) );
    out->hinge_slot = fabric_pool_push( pool, (size_t)f->hinge_count, sizeof( int32_t ) );
    if ( out->hinge == NULL || out->bend_link == NULL || out->link_slot == NULL || out->hinge_slot == NULL )
    {
        return false;
    }
    memset( out->hinge, 0xff, edges );
    memset( out->bend_link, 0xff, edges );
    int32_t link = f->edge_count;
    for ( int h = 0; h < f->hinge_count; ++h )
    {
        const int32_t* corner = f->hinges + 4 * (size_t)h;
        const int edge = wisp_fabric_find_edge( f, corner[0], corner[1] );
        out->hinge[edge] = h;
        if ( corner[2] != corner[3] && link < f->link_count ) // as the fabric lists bend links
        {
            out->bend_link[edge] = link++;
        }
    }
    list_slots( &f->link_order, out->link_slot );
    list_slots( &f->hinge_order, out->hinge_slot );
    return true;
}

static int32_t slot_of( const int32_t* slots, int32_t number )
{
    return number >= 0 ? slots[number] : -1;
}

static void fill_origins( const wisp_fabric* from, const wisp_fabric* to, const int32_t* parents,
                          const edge_numbers* before, const edge_numbers* now, fabric_origins* out )
{
    memset( out->links, 0xff, (size_t)to->link_order.slot_count * sizeof( int32_t ) );
    memset( out->hinges, 0xff, (size_t)to->hinge_order.slot_count * sizeof( int32_t ) );
    for ( int e = 0; e < to->edge_count; ++e )
    {
        const int old =
            wisp_fabric_find_edge( from, parents[to->edges[2 * (size_t)e]], parents[to->edges[2 * (size_t)e + 1]] );
        out->edges[e] = old;
        out->links[now->link_slot[e]] = before->link_slot[old];
        if ( now->bend_link[e] >= 0 )
        {
            out->links[now->link_slot[now->bend_link[e]]] = slot_of( before->link_slot, before->bend_link[old] );
        }
        if ( now->hinge[e] >= 0 && to->hinge_order.slot_count > 0 )
        {
            out->hinges[now->hinge_slot[now->hinge[e]]] = slot_of( before->hinge_slot, before->hinge[old] );
        }
    }
}

bool fabric_find_origins( const wisp_fabric* from, const wisp_fabric* to, const int32_t* parents,
                          const wisp_allocator* allocator, fabric_origins* out )
{
    fabric_pool pool = { .allocator = allocator };
    edge_numbers before, now;
    const size_t count =
        (size_t)to->edge_count + (size_t)to->link_order.slot_count + (size_t)to->hinge_order.slot_count;
    *out = ( fabric_origins ){ .bytes = count * sizeof( int32_t ) };
    out->edges = base_allocate( allocator, out->bytes, BASE_BUFFER_ALIGNMENT );
    const bool done = out->edges != NULL && number_edges( from, &pool, &before ) && number_edges( to, &pool, &now );
    if ( done )
    {
        out->links = out->edges + to->edge_count;
        out->hinges = out->links + to->link_order.slot_count;
        fill_origins( from, to, parents, &before, &now, out );
    }
    else
    {
        fabric_release_origins( out, allocator );
    }
    fabric_pool_release( &pool );
    return done;
}

void fabric_release_origins( fabric_origins* origins, const wisp_allocator* allocator )
{
    base_release( allocator, origins->edges, origins->bytes );
    *origins = ( fabric_origins ){ 0 };
}
