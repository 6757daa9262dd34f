// Triangles around a vertex v as fans. Each triangle (v, a, b) is an arrow from neighbour a to neighbour b, and a
// fan is a path of consecutive arrows. On a manifold that is one cycle, or one path between open edges. On a
// nonmanifold mesh there is a path for each arrow that begins where none ends, and some cycles.
#include "fabric.h"

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
