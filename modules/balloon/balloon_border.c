// Holes of a skin (`allow_open`): each is closed by a virtual fan of triangles about the mean of its border
// loop. Fans belong to V and to its gradient: with them the gradients of all vertices sum to zero, so
// the gas cannot push its own balloon along. They have no mass, links, area or normal.
#include "balloon_internal.h"

#include "wisp/module/double3.h"

#include <string.h>

// Entry e of the ring of a slot.
static int32_t ring_entry( const wisp_fabric* f, int slot, int e )
{
    return f->ring_x4[e][slot % WISP_FABRIC_LANES] / 4;
}

// Count the triangles at the edge between two slots: each pair of consecutive ring entries without the own slot is one.
static int triangles_of_edge( const wisp_fabric* f, int slot, int32_t other )
{
    int count = 0, slice = slot / WISP_FABRIC_LANES;
    for ( int e = f->ring_begin[slice] + 1; e < f->ring_begin[slice + 1]; ++e )
    {
        int32_t a = ring_entry( f, slot, e - 1 ), b = ring_entry( f, slot, e );
        count += a != slot && b != slot && ( a == other || b == other ) ? 1 : 0;
    }
    return count;
}

// Both ends of an open fan are the far ends of border edges.
static int border_edges_at( const wisp_fabric* f, int slot )
{
    int count = 0, slice = slot / WISP_FABRIC_LANES;
    for ( int e = f->ring_begin[slice]; e < f->ring_begin[slice + 1]; ++e )
    {
        int32_t other = ring_entry( f, slot, e );
        count += other != slot && triangles_of_edge( f, slot, other ) == 1 ? 1 : 0;
    }
    return count;
}

// Next vertex of the open edge loop, along its triangles. An open fan begins with the edge that leaves its vertex and comes
// before closed ones. Where two open edges meet there is one open fan.
static int32_t border_after( const wisp_fabric* f, int slot )
{
    return ring_entry( f, slot, f->ring_begin[slot / WISP_FABRIC_LANES] );
}

wisp_status balloon_refuse_open( wisp_world* world, const wisp_fabric* f )
{
    int32_t from = f->triangles[0], to = f->triangles[1];
    for ( int corner = 0; corner < 3 * f->triangle_count && triangles_of_edge( f, from, to ) != 1; ++corner )
    {
        from = f->triangles[corner];
        to = f->triangles[corner - corner % 3 + ( corner + 1 ) % 3];
    }
    return wisp_world_fail( world, WISP_BAD_INPUT,
                            "balloon: got %d open edges, the first from vertex %d to vertex %d, expected a closed "
                            "mesh; allow_open closes holes",
                            f->open_edge_count, f->slot_vertex[from], f->slot_vertex[to] );
}

wisp_status balloon_check_border( wisp_world* world, const wisp_fabric* f )
{
    for ( int v = 0; v < f->vertex_count && f->open_edge_count > 0; ++v )
    {
        int edges = border_edges_at( f, f->vertex_slot[v] );
        if ( edges != 0 && edges != 2 )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "balloon: got %d open edges at vertex %d, expected two at each vertex of a hole",
                                    edges, v );
        }
    }
    return WISP_OK;
}

// A simple loop has as many vertices as edges. The bounds hold even if a fabric from a file miscounts them. `size` first marks
// vertices that are already listed.
void balloon_find_loops( const wisp_fabric* f, int32_t* vertex, int32_t* size )
{
    int count = 0;
    memset( size, 0, (size_t)f->slot_count * sizeof( int32_t ) );
    memset( vertex, 0, (size_t)f->slot_count * sizeof( int32_t ) );
    for ( int first = 0; first < f->vertex_count && count < f->open_edge_count; ++first )
    {
        bool open_edge = border_edges_at( f, first ) > 0;
        for ( int slot = first; open_edge && size[slot] == 0; slot = border_after( f, slot ) )
        {
            vertex[count++] = slot;
            size[slot] = 1;
        }
    }
    memset( size, 0, (size_t)f->slot_count * sizeof( int32_t ) );
    for ( int begin = 0, end; begin < count; begin = end )
    {
        for ( end = begin + 1; end < count && border_after( f, vertex[end - 1] ) != vertex[begin]; ++end )
        {
        }
        size[begin] = end - begin;
    }
}

// ---- fans ----

// One loop at its present shape. A triangle of the fan is (next, vertex, mean), so that it runs against the skin's.
typedef struct border_fan
{
    const int32_t* vertex;
    int count;
    double3 mean; // about the origin of the sums
    double3 hub;  // dV / d mean: a sixth of the sum of (next - mean) x (vertex - mean)
} border_fan;

// Return a vertex of a loop, counted around it from the first one, about the mean.
static double3 corner_of( const border_fan* fan, int i, const float* position, int stride )
{
    const float* p = position + (size_t)fan->vertex[( i + fan->count ) % fan->count] * (size_t)stride;
    return double3_sub( double3_sub( double3_from( p ), double3_from( position ) ), fan->mean );
}

static border_fan measure_fan( const balloon_loops* loops, int begin, const float* position, int stride )
{
    const double3 none = { 0.0, 0.0, 0.0 };
    border_fan fan = { loops->vertex + begin, loops->size[begin], none, none };
    double3 mean = none;
    for ( int i = 0; i < fan.count; ++i )
    {
        const double3 p = corner_of( &fan, i, position, stride );
        mean = double3_add( mean, double3_make( p.x / fan.count, p.y / fan.count, p.z / fan.count ) );
    }
    fan.mean = mean;
    for ( int i = 0; i < fan.count; ++i )
    {
        const double3 here = corner_of( &fan, i, position, stride ),
                      next = corner_of( &fan, i + 1, position, stride );
        fan.hub = double3_mul_add( fan.hub, 1.0 / 6.0, double3_cross( next, here ) );
    }
    return fan;
}

double balloon_fan_volume( const balloon_loops* loops, const float* position, int stride )
{
    double volume = 0.0;
    for ( int begin = 0; begin < loops->count && loops->size[begin] > 0; begin += loops->size[begin] )
    {
        const border_fan fan = measure_fan( loops, begin, position, stride );
        volume += double3_dot( fan.mean, fan.hub );
    }
    return volume;
}

// The kernel has already added the gradient of the skin. The sum is stored as a float, so its square is computed again.
static void add_to_gradient( const border_fan* fan, const float* position, float* gradient, double* weighted )
{
    for ( int i = 0; i < fan->count; ++i )
    {
        const int32_t slot = fan->vertex[i];
        const double3 here = corner_of( fan, i, position, 4 ), last = corner_of( fan, i - 1, position, 4 ),
                      next = corner_of( fan, i + 1, position, 4 );
        const double n = fan->count; // moving a vertex moves the mean along
        const double3 all = double3_mul_add( double3_make( fan->hub.x / n, fan->hub.y / n, fan->hub.z / n ),
                                             1.0 / 6.0, double3_cross( here, double3_sub( last, next ) ) );
        const double fraction[3] = { all.x, all.y, all.z };
        float* g = gradient + (size_t)( slot / 8 ) * 24 + slot % 8;
        for ( int k = 0; k < 3; ++k )
        {
            double old = (double)g[8 * k];
            g[8 * k] = (float)( old + fraction[k] );
            *weighted += (double)position[4 * (size_t)slot + 3] * ( (double)g[8 * k] * (double)g[8 * k] - old * old );
        }
    }
}

void balloon_add_fans( const balloon_loops* loops, const float* position, float* gradient, wisp_ring_sums* sums )
{
    for ( int begin = 0; begin < loops->count && loops->size[begin] > 0; begin += loops->size[begin] )
    {
        const border_fan fan = measure_fan( loops, begin, position, 4 );
        sums->volume += double3_dot( fan.mean, fan.hub );
        add_to_gradient( &fan, position, gradient, &sums->weighted );
    }
}
