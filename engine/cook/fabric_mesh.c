#include "fabric.h"

#include "alloc.h"
#include "wisp/module/double3.h"
#include "fabric_parts.h"

#include <string.h>

// ---- rings ----

// Triangles around a vertex v as fans. Each triangle (v, a, b) is an arrow from neighbour a to neighbour b, and a
// fan is a path of consecutive arrows. On a manifold that is one cycle, or one path between open edges. On a
// nonmanifold mesh there is a path for each arrow that begins where none ends, and some cycles.

#define NO_ARROW ( -1 )

// Arrows of one vertex that are not in a fan yet. When all arrows are taken the arrays are back in their initial
// state, so the next vertex needs no reset.
typedef struct fan_state
{
    const wisp_fabric* f;
    int32_t* leaving; // [vertex_count] first arrow that leaves a neighbour, in the user's order
    int32_t* excess;  // [vertex_count] number of arrows that leave a neighbour minus number that arrive
    int32_t* next;    // [maximum arrows of a vertex] next arrow that leaves the same neighbour
    int32_t* taken;   // corners in the order of the fans
} fan_state;

// Returns the neighbour where the arrow of a corner begins (step 1) or ends (step 2).
static int32_t arrow_end( const wisp_fabric* f, int32_t corner, int step )
{
    return f->triangles[3 * (size_t)( corner / 3 ) + (size_t)( ( corner % 3 + step ) % 3 )];
}

// Adds arrows in reverse order, so that each list is in the user's order.
static void list_arrows( fan_state* s, const int32_t* corner, int32_t count )
{
    for ( int32_t i = count - 1; i >= 0; --i )
    {
        int32_t from = arrow_end( s->f, corner[i], 1 ), to = arrow_end( s->f, corner[i], 2 );
        s->next[i] = s->leaving[from];
        s->leaving[from] = i;
        s->excess[from] += 1;
        s->excess[to] -= 1;
    }
}

// Takes arrows until none continues: at the begin of a closed fan, or at an open edge.
// @return total number of arrows taken
static int32_t walk_fan( fan_state* s, const int32_t* corner, int32_t from, int32_t count, int32_t* taken )
{
    int32_t at = from;
    while ( s->leaving[at] != NO_ARROW )
    {
        int32_t arrow = s->leaving[at];
        s->leaving[at] = s->next[arrow];
        taken[count++] = corner[arrow];
        at = arrow_end( s->f, corner[arrow], 2 );
    }
    s->excess[from] -= 1;
    s->excess[at] += 1;
    return count;
}

// Lists the fans. Open fans come first, because a cycle could continue into their remaining arrows. Once no
// neighbour has more leaving than arriving arrows, only cycles remain.
static void order_fans( fan_state* s, const int32_t* corner, int32_t count, int32_t* taken )
{
    int32_t done = 0;
    list_arrows( s, corner, count );
    for ( int closed = 0; closed < 2; ++closed )
    {
        for ( int32_t i = 0; i < count && done < count; ++i )
        {
            int32_t from = arrow_end( s->f, corner[i], 1 );
            if ( s->leaving[from] == i && ( closed == 1 || s->excess[from] > 0 ) )
            {
                done = walk_fan( s, corner, from, done, taken );
            }
        }
    }
}

static bool order_all_fans( const wisp_fabric* f, const fabric_mesh* mesh, fabric_pool* scratch, fan_state* s )
{
    int32_t most = 0;
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        int32_t count = mesh->corner_begin[v + 1] - mesh->corner_begin[v];
        most = count > most ? count : most;
    }
    *s = ( fan_state ){
        .f = f,
        .leaving = fabric_pool_push( scratch, (size_t)f->vertex_count, sizeof( int32_t ) ),
        .excess = fabric_pool_push_zeroed( scratch, (size_t)f->vertex_count, sizeof( int32_t ) ),
        .next = fabric_pool_push( scratch, (size_t)most, sizeof( int32_t ) ),
        .taken = fabric_pool_push( scratch, 3 * (size_t)f->triangle_count, sizeof( int32_t ) ),
    };
    if ( s->leaving == NULL || s->excess == NULL || s->next == NULL || s->taken == NULL )
    {
        return false;
    }
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        s->leaving[v] = NO_ARROW;
    }
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        int32_t begin = mesh->corner_begin[v];
        order_fans( s, mesh->corner + begin, mesh->corner_begin[v + 1] - begin, s->taken + begin );
    }
    return true;
}

// Writes the entries of one vertex into its lane of a slice. A fan never begins where the previous one ended, since
// that one would have continued. So an arrow that does not begin there begins a new fan.
// @param lane first entry, null to count only
// @return number of entries
static int32_t write_fans( const fan_state* s, const fabric_mesh* mesh, int slot, int32_t* lane )
{
    int32_t count = 0, last = slot;
    int32_t begin = slot < mesh->vertex_count ? mesh->corner_begin[slot] : 0;
    int32_t end = slot < mesh->vertex_count ? mesh->corner_begin[slot + 1] : 0;
    for ( int32_t i = begin; i < end; ++i )
    {
        int32_t from = arrow_end( s->f, s->taken[i], 1 ), to = arrow_end( s->f, s->taken[i], 2 );
        const int32_t entry[3] = { slot, from, to };
        for ( int k = last == from ? 2 : i == begin ? 1 : 0; k < 3; ++k, ++count )
        {
            if ( lane != NULL )
            {
                lane[(size_t)count * WISP_FABRIC_LANES] = 4 * entry[k];
            }
        }
        last = to;
    }
    return count;
}

bool fabric_rings_list( const wisp_fabric* f, const fabric_mesh* mesh, fabric_pool* scratch, fabric_pool* keep,
                        fabric_rings* out )
{
    fan_state s;
    int32_t* begin = fabric_pool_push( keep, (size_t)f->ring_slice_count + 1, sizeof( int32_t ) );
    if ( begin == NULL || order_all_fans( f, mesh, scratch, &s ) == false )
    {
        return false;
    }
    begin[0] = 0;
    for ( int slice = 0; slice < f->ring_slice_count; ++slice )
    {
        int32_t longest = 0;
        for ( int lane = 0; lane < WISP_FABRIC_LANES; ++lane )
        {
            int32_t count = write_fans( &s, mesh, slice * WISP_FABRIC_LANES + lane, NULL );
            longest = count > longest ? count : longest;
        }
        begin[slice + 1] = begin[slice] + longest;
    }
    int32_t( *ring_x4 )[WISP_FABRIC_LANES] =
        fabric_pool_push( keep, (size_t)begin[f->ring_slice_count], sizeof( *ring_x4 ) );
    for ( int slot = 0; slot < f->slot_count && ring_x4 != NULL; ++slot )
    {
        int slice = slot / WISP_FABRIC_LANES, lane = slot % WISP_FABRIC_LANES;
        int32_t length = begin[slice + 1] - begin[slice];
        int32_t* first = ring_x4[begin[slice]] + lane;
        for ( int32_t e = write_fans( &s, mesh, slot, first ); e < length; ++e )
        {
            first[(size_t)e * WISP_FABRIC_LANES] = 4 * slot;
        }
    }
    *out = ( fabric_rings ){ .begin = begin, .ring_x4 = (const int32_t( * )[WISP_FABRIC_LANES])ring_x4 };
    return ring_x4 != NULL;
}

// ---- other triangles ----

// Other triangles for the same vertices. In: a fabric, its new triangles, which vertices were copied. Out: a fabric in the same slots,
// and where each of its edges, links and hinges comes from.

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

// ---- mesh ----

// ---- neighbours ----

// Converts counts at [v + 2] to first indices at [v + 1]. After filling the lists, [v] is the begin of the list of
// v.
static void counts_to_places( int32_t* begin, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        begin[v + 2] += begin[v + 1];
    }
}

// Lists both other corners of every triangle at every vertex, so neighbours occur once per triangle.
static void list_pairs( const int32_t* triangles, int triangle_count, int32_t* begin, int32_t* pairs )
{
    for ( size_t t = 0; t < (size_t)triangle_count; ++t )
    {
        for ( int k = 0; k < 3; ++k )
        {
            int32_t* place = &begin[triangles[3 * t + (size_t)k] + 1];
            pairs[*place] = triangles[3 * t + (size_t)( ( k + 1 ) % 3 )];
            pairs[*place + 1] = triangles[3 * t + (size_t)( ( k + 2 ) % 3 )];
            *place += 2;
        }
    }
}

// Removes duplicates in place, keeping the first, and closes the gaps between lists.
static void drop_repeated( int32_t* begin, int32_t* pairs, int count, int32_t* met_at )
{
    int32_t from = 0, to = 0;
    for ( int v = 0; v < count; ++v )
    {
        int32_t end = begin[v + 1];
        begin[v] = to;
        for ( ; from < end; ++from )
        {
            if ( met_at[pairs[from]] != v + 1 )
            {
                met_at[pairs[from]] = v + 1;
                pairs[to++] = pairs[from];
            }
        }
    }
    begin[count] = to;
}

bool fabric_graph_make( fabric_pool* pool, const int32_t* triangles, int triangle_count, int vertex_count,
                        fabric_graph* out )
{
    int32_t* begin = fabric_pool_push_zeroed( pool, (size_t)vertex_count + 2, sizeof( int32_t ) );
    int32_t* pairs = fabric_pool_push( pool, 6 * (size_t)triangle_count, sizeof( int32_t ) );
    int32_t* met_at = fabric_pool_push_zeroed( pool, (size_t)vertex_count, sizeof( int32_t ) );
    if ( begin == NULL || pairs == NULL || met_at == NULL )
    {
        return false;
    }
    for ( size_t i = 0; i < 3 * (size_t)triangle_count; ++i )
    {
        begin[triangles[i] + 2] += 2;
    }
    counts_to_places( begin, vertex_count );
    list_pairs( triangles, triangle_count, begin, pairs );
    drop_repeated( begin, pairs, vertex_count, met_at );
    *out = ( fabric_graph ){ .count = vertex_count, .begin = begin, .neighbour = pairs };
    return true;
}

bool fabric_graph_relist( fabric_pool* pool, const fabric_graph* graph, const int32_t* sequence, const int32_t* name,
                          fabric_graph* out )
{
    int32_t* begin = fabric_pool_push_zeroed( pool, (size_t)graph->count + 2, sizeof( int32_t ) );
    int32_t* neighbour = fabric_pool_push( pool, (size_t)graph->begin[graph->count], sizeof( int32_t ) );
    if ( begin == NULL || neighbour == NULL )
    {
        return false;
    }
    for ( int v = 0; v < graph->count; ++v )
    {
        begin[( name != NULL ? name[v] : v ) + 2] = graph->begin[v + 1] - graph->begin[v];
    }
    counts_to_places( begin, graph->count );
    for ( int i = 0; i < graph->count; ++i )
    {
        const int32_t v = sequence != NULL ? sequence[i] : i;
        for ( int32_t e = graph->begin[v]; e < graph->begin[v + 1]; ++e )
        {
            const int32_t to = graph->neighbour[e];
            neighbour[begin[( name != NULL ? name[to] : to ) + 1]++] = name != NULL ? name[v] : v;
        }
    }
    *out = ( fabric_graph ){ .count = graph->count, .begin = begin, .neighbour = neighbour };
    return true;
}

// ---- edges and hinges ----

// Triangles of an edge (a, b): the only corner whose triangle runs from a to b, and the only one from b to a.
typedef struct edge_use
{
    int32_t forward, backward; // triangle * 3 + index of the corner
} edge_use;

#define NO_CORNER ( -1 )
#define MANY_CORNERS ( -2 )

static bool list_edges( const fabric_graph* graph, fabric_pool* scratch, cook_fabric* cooked, int32_t** first_edge )
{
    wisp_fabric* f = &cooked->fabric;
    size_t count = (size_t)graph->begin[graph->count] / 2;
    int32_t* edges = fabric_pool_push( &cooked->edges, 2 * count, sizeof( int32_t ) );
    int32_t* first = fabric_pool_push( scratch, (size_t)graph->count + 1, sizeof( int32_t ) );
    if ( edges == NULL || first == NULL )
    {
        return false;
    }
    int32_t edge = 0;
    for ( int a = 0; a < graph->count; ++a )
    {
        first[a] = edge;
        for ( int32_t e = graph->begin[a]; e < graph->begin[a + 1]; ++e )
        {
            if ( graph->neighbour[e] > a )
            {
                edges[2 * (size_t)edge] = a;
                edges[2 * (size_t)edge + 1] = graph->neighbour[e];
                edge += 1;
            }
        }
    }
    first[graph->count] = edge;
    f->edge_count = edge;
    f->edges = edges;
    *first_edge = first;
    return true;
}

// Finds the edge between two neighbours; the second ends of a vertex's edges are in increasing order.
static int32_t find_edge( const int32_t* edges, const int32_t* first_edge, int32_t a, int32_t b )
{
    int32_t lower = first_edge[a], upper = first_edge[a + 1];
    while ( upper - lower > 1 )
    {
        int32_t middle = lower + ( upper - lower ) / 2;
        bool beyond = edges[2 * (size_t)middle + 1] > b;
        upper = beyond ? middle : upper;
        lower = beyond ? lower : middle;
    }
    return lower;
}

static edge_use* find_uses( const wisp_fabric* f, const int32_t* first_edge, fabric_pool* scratch )
{
    edge_use* uses = fabric_pool_push( scratch, (size_t)f->edge_count, sizeof( edge_use ) );
    for ( int e = 0; e < f->edge_count && uses != NULL; ++e )
    {
        uses[e] = ( edge_use ){ NO_CORNER, NO_CORNER };
    }
    for ( int32_t t = 0; t < f->triangle_count && uses != NULL; ++t )
    {
        const int32_t* v = f->triangles + 3 * (size_t)t;
        for ( int k = 0; k < 3; ++k )
        {
            int32_t from = v[k], to = v[( k + 1 ) % 3];
            bool forward = from < to;
            edge_use* use = &uses[find_edge( f->edges, first_edge, forward ? from : to, forward ? to : from )];
            int32_t* corner = forward ? &use->forward : &use->backward;
            *corner = *corner == NO_CORNER ? 3 * t + k : MANY_CORNERS;
        }
    }
    return uses;
}

// Returns the vertex of a corner's triangle that is opposite its edge.
static int32_t opposite( const wisp_fabric* f, int32_t corner )
{
    return f->triangles[3 * (size_t)( corner / 3 ) + (size_t)( ( corner % 3 + 2 ) % 3 )];
}

static bool is_hinge( edge_use use )
{
    return use.forward >= 0 && use.backward >= 0;
}

static bool list_hinges( const edge_use* uses, cook_fabric* cooked )
{
    wisp_fabric* f = &cooked->fabric;
    for ( int e = 0; e < f->edge_count; ++e )
    {
        bool nonmanifold = uses[e].forward == MANY_CORNERS || uses[e].backward == MANY_CORNERS;
        f->nonmanifold_edge_count += nonmanifold ? 1 : 0;
        f->hinge_count += is_hinge( uses[e] ) ? 1 : 0;
        f->open_edge_count += nonmanifold == false && is_hinge( uses[e] ) == false ? 1 : 0;
    }
    int32_t* hinges = fabric_pool_push( &cooked->hinges, 4 * (size_t)f->hinge_count, sizeof( int32_t ) );
    int32_t* next = hinges;
    for ( size_t e = 0; e < (size_t)f->edge_count && hinges != NULL; ++e )
    {
        if ( is_hinge( uses[e] ) )
        {
            next[0] = f->edges[2 * e];
            next[1] = f->edges[2 * e + 1];
            next[2] = opposite( f, uses[e].forward );
            next[3] = opposite( f, uses[e].backward );
            next += 4;
        }
    }
    f->hinges = hinges;
    return hinges != NULL;
}

bool fabric_mesh_list_corners( const wisp_fabric* f, fabric_pool* scratch, fabric_mesh* mesh )
{
    int32_t* begin = fabric_pool_push_zeroed( scratch, (size_t)f->vertex_count + 2, sizeof( int32_t ) );
    int32_t* corner = fabric_pool_push( scratch, 3 * (size_t)f->triangle_count, sizeof( int32_t ) );
    if ( begin == NULL || corner == NULL )
    {
        return false;
    }
    for ( int32_t i = 0; i < 3 * f->triangle_count; ++i )
    {
        begin[f->triangles[i] + 2] += 1;
    }
    counts_to_places( begin, f->vertex_count );
    for ( int32_t i = 0; i < 3 * f->triangle_count; ++i )
    {
        corner[begin[f->triangles[i] + 1]++] = i;
    }
    mesh->corner_begin = begin;
    mesh->corner = corner;
    return true;
}

// Computes lengths and adjacency for tethers and levels.
static bool measure_adjacency( const wisp_fabric* f, const edge_use* uses, fabric_pool* scratch, fabric_mesh* mesh )
{
    size_t neighbour_count = (size_t)mesh->neighbour_begin[f->vertex_count];
    float* length = fabric_pool_push( scratch, neighbour_count, sizeof( float ) );
    int32_t* across = fabric_pool_push( scratch, 3 * (size_t)f->triangle_count, sizeof( int32_t ) );
    if ( length == NULL || across == NULL )
    {
        return false;
    }
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        for ( int32_t e = mesh->neighbour_begin[v]; e < mesh->neighbour_begin[v + 1]; ++e )
        {
            length[e] = (float)double3_length( double3_between( f->rest[v], f->rest[mesh->neighbour[e]] ) );
        }
    }
    memset( across, 0xff, 3 * (size_t)f->triangle_count * sizeof( int32_t ) );
    for ( int e = 0; e < f->edge_count; ++e )
    {
        if ( is_hinge( uses[e] ) )
        {
            across[uses[e].forward] = uses[e].backward / 3;
            across[uses[e].backward] = uses[e].forward / 3;
        }
    }
    mesh->neighbour_length = length;
    mesh->across = across;
    return true;
}

bool fabric_mesh_connect( const fabric_graph* graph, bool across, fabric_pool* scratch, cook_fabric* cooked,
                          fabric_mesh* out )
{
    wisp_fabric* f = &cooked->fabric;
    fabric_pool edges = { .allocator = scratch->allocator };
    int32_t* first_edge = NULL;
    edge_use* uses = NULL;
    *out = ( fabric_mesh ){
        .vertex_count = f->vertex_count,
        .triangle_count = f->triangle_count,
        .neighbour_begin = graph->begin,
        .neighbour = graph->neighbour,
    };
    bool done = list_edges( graph, &edges, cooked, &first_edge ) &&
                ( uses = find_uses( f, first_edge, &edges ) ) != NULL && list_hinges( uses, cooked ) &&
                fabric_mesh_list_corners( f, scratch, out ) &&
                ( across == false || measure_adjacency( f, uses, scratch, out ) );
    fabric_pool_release( &edges );
    return done;
}

// ---- areas ----

static double triangle_area( const wisp_fabric* f, int32_t triangle )
{
    const int32_t* v = f->triangles + 3 * (size_t)triangle;
    const double3 a = double3_between( f->rest[v[0]], f->rest[v[1]] );
    return 0.5 * double3_length( double3_cross( a, double3_between( f->rest[v[0]], f->rest[v[2]] ) ) );
}

bool fabric_mesh_measure_areas( const fabric_mesh* mesh, fabric_pool* scratch, cook_fabric* cooked )
{
    wisp_fabric* f = &cooked->fabric;
    double* of_triangle = fabric_pool_push( scratch, (size_t)f->triangle_count, sizeof( double ) );
    float* area = fabric_pool_push_zeroed( &cooked->keep, (size_t)f->slot_count, sizeof( float ) );
    if ( of_triangle == NULL || area == NULL )
    {
        return false;
    }
    for ( int32_t t = 0; t < f->triangle_count; ++t )
    {
        of_triangle[t] = triangle_area( f, t );
    }
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        double sum = 0.0;
        for ( int32_t c = mesh->corner_begin[v]; c < mesh->corner_begin[v + 1]; ++c )
        {
            sum += of_triangle[mesh->corner[c] / 3];
        }
        area[v] = (float)( sum / 3.0 );
    }
    f->area = area;
    return true;
}
