// Construction of voxels: their size, and the triangles that touch them.
#include "voxels.h"

#include <string.h>

enum
{
    VOXELS_A_TRIANGLE = 16,
    PLACES_A_TRIANGLE = 64, // list entries per triangle
    MAX_VOXELS = 1 << 24,
    MAX_ALONG = 1 << 20, // maximum number of voxels along an axis, so that the product of three fits
    SMALL_BOX = 27,      // voxels: triangles with a box of no more voxels are listed without the edge test
};

// Widening relative to the mesh's extent and to its largest coordinate. Inputs are floats, so differences are
// nearly exact in double. The first covers triangles so thin that the nearest point computed on their face is not
// exact.
static const double WIDENING = 4e-6;
static const double WIDENING_PLACE = 1e-14;
static const double GROWTH = 1.25;
// Minimum squared sine of an angle of a triangle whose plane is used in the overlap test.
static const double SLENDER = 1e-12;

static double along( const double3* p, int axis )
{
    return axis == 0 ? p->x : ( axis == 1 ? p->y : p->z );
}

// ---- sizes ----

static double find_mean_edge( const mesh_surface* s )
{
    double sum = 0.0;
    for ( int32_t t = 0; t < s->triangle_count; ++t )
    {
        triangle_corners c = triangle_load( s->xyzw, s->triangles, t );
        for ( int i = 0; i < 3; ++i )
        {
            double3 edge = double3_sub( c.at[( i + 1 ) % 3], c.at[i] );
            sum += sqrt( double3_dot( edge, edge ) );
        }
    }
    return sum / ( 3.0 * (double)s->triangle_count );
}

// Computes the grid of voxels around a mesh for a voxel edge of `size`.
// @return number of voxels, which may exceed an int
static int64_t lay_out( voxels* v, const mesh_surface* s, double size )
{
    int64_t product = 1;
    v->size = size;
    v->per_metre = 1.0 / size;
    for ( int k = 0; k < 3; ++k )
    {
        // twice the widening, so that everything within the widening of a triangle is inside the grid
        v->lower[k] = (double)s->lower[k] - 2.0 * v->widening;
        double edges = ceil( ( (double)s->upper[k] + 2.0 * v->widening - v->lower[k] ) / size );
        v->count[k] = (int)fmin( fmax( edges, 1.0 ), (double)MAX_ALONG );
        v->blocks[k] = ( v->count[k] + VOXELS_BLOCK - 1 ) / VOXELS_BLOCK;
        product *= v->count[k];
    }
    return product;
}

// Computes the first and last voxel of a triangle's box along each axis.
// @return number of voxels
static int64_t find_range( const voxels* v, const triangle_corners* t, int first[3], int last[3] )
{
    int64_t product = 1;
    for ( int k = 0; k < 3; ++k )
    {
        double a = along( t->at, k ), b = along( t->at + 1, k ), c = along( t->at + 2, k );
        first[k] = voxels_at( v, k, fmin( a, fmin( b, c ) ) - v->widening );
        last[k] = voxels_at( v, k, fmax( a, fmax( b, c ) ) + v->widening );
        product *= last[k] - first[k] + 1;
    }
    return product;
}

// Counts voxels in the boxes of all triangles: an upper bound of the list entries and the cost of a build. Stops
// counting above `most`.
static int64_t count_places( const voxels* v, const mesh_surface* s, int64_t most )
{
    int64_t sum = 0;
    for ( int32_t t = 0; t < s->triangle_count && sum <= most; ++t )
    {
        int first[3], last[3];
        triangle_corners c = triangle_load( s->xyzw, s->triangles, t );
        sum += find_range( v, &c, first, last );
    }
    return sum;
}

static int64_t count_blocks( const voxels* v )
{
    return (int64_t)v->blocks[0] * v->blocks[1] * v->blocks[2];
}

static bool is_within( const voxels* v, const mesh_surface* s, int64_t count )
{
    int64_t triangles = s->triangle_count, most = PLACES_A_TRIANGLE * triangles;
    if ( count > MAX_VOXELS || count > VOXELS_A_TRIANGLE * triangles )
    {
        return count == 1;
    }
    most = most < INT32_MAX ? most : INT32_MAX;
    int64_t places = count_places( v, s, most );
    uint64_t bytes =
        sizeof( int32_t ) * (uint64_t)( count + 1 + places ) + sizeof( uint64_t ) * (uint64_t)count_blocks( v );
    return places <= most && ( v->max_bytes == 0 || bytes <= v->max_bytes );
}

// Selects the smallest voxels, of the requested size or coarser, whose number is allowed.
static wisp_status choose_size( voxels* v, const mesh_surface* s, wisp_error* error )
{
    double extent = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        extent = fmax( extent, (double)s->upper[k] - (double)s->lower[k] );
    }
    v->widening = WIDENING * extent + WIDENING_PLACE * s->largest + MIN_SEARCH_SLACK;
    double span = extent + 4.0 * v->widening;
    double requested = v->size_queried > 0.0 ? v->size_queried : fmax( find_mean_edge( s ), v->widening );

    double size = fmax( requested, span / ( 0.5 * (double)MAX_ALONG ) );
    int64_t count = lay_out( v, s, size );
    while ( !is_within( v, s, count ) )
    {
        if ( count == 1 )
        {
            return wisp_fail(
                error, WISP_NO_MEMORY,
                "mesh collider: the voxels of %d triangles need more than %zu bytes, which is the limit",
                s->triangle_count, v->max_bytes );
        }
        size *= GROWTH;
        count = lay_out( v, s, size );
    }
    v->voxel_count = (int)count;
    v->block_count = (int)count_blocks( v );
    v->coarse = size > requested;
    return WISP_OK;
}

// ---- overlap of triangles and voxels ----

// Tests the cross products of triangle edges and grid axes of Akenine-Moeller 2001, "Fast 3D triangle-box overlap
// testing". Returns whether one of them separates the triangle from a cube of half edge `half` around `centre`.
static bool is_separated_by_edges( const triangle_corners* t, const double3* centre, double half )
{
    for ( int e = 0; e < 3; ++e )
    {
        double3 edge = double3_sub( t->at[( e + 1 ) % 3], t->at[e] );
        for ( int k = 0; k < 3; ++k )
        {
            int i = ( k + 1 ) % 3, j = ( k + 2 ) % 3;
            double axis_i = -along( &edge, j ), axis_j = along( &edge, i );
            double least = DBL_MAX, most = -DBL_MAX, reach = half * ( fabs( axis_i ) + fabs( axis_j ) );
            for ( int m = 0; m < 3; ++m )
            {
                double3 corner = double3_sub( t->at[m], *centre );
                double at = axis_i * along( &corner, i ) + axis_j * along( &corner, j );
                least = fmin( least, at );
                most = fmax( most, at );
            }
            if ( least > reach || most < -reach )
            {
                return true;
            }
        }
    }
    return false;
}

// Precomputed values of a triangle for the overlap test.
typedef struct voxel_finder
{
    triangle_corners t;
    double3 normal;
    double reach; // extent of a cube along the normal; infinite for a triangle without a plane
    double half;  // m, half edge of a cube, widened
    bool is_large;
} voxel_finder;

static voxel_finder make_finder( const voxels* v, const triangle_corners* t, int64_t box )
{
    voxel_finder f = { .t = *t, .half = 0.5 * v->size + v->widening, .is_large = box > SMALL_BOX };
    double3 ab = double3_sub( t->at[1], t->at[0] ), ac = double3_sub( t->at[2], t->at[0] );
    f.normal = double3_cross( ab, ac );
    bool has_plane = double3_dot( f.normal, f.normal ) > SLENDER * ( double3_dot( ab, ab ) * double3_dot( ac, ac ) );
    f.reach =
        has_plane ? f.half * ( fabs( f.normal.x ) + fabs( f.normal.y ) + fabs( f.normal.z ) ) : (double)INFINITY;
    return f;
}

static bool is_touched( const voxels* v, const voxel_finder* f, int x, int y, int z )
{
    double3 centre = { v->lower[0] + ( (double)x + 0.5 ) * v->size, v->lower[1] + ( (double)y + 0.5 ) * v->size,
                       v->lower[2] + ( (double)z + 0.5 ) * v->size };
    return fabs( double3_dot( double3_sub( centre, f->t.at[0] ), f->normal ) ) <= f->reach &&
           !( f->is_large && is_separated_by_edges( &f->t, &centre, f->half ) );
}

// Counts a triangle in the voxels that it touches, or appends it to their lists.
static void list_triangle( voxels* v, const mesh_surface* s, int32_t triangle, int32_t* begins, int32_t* lists )
{
    int first[3], last[3];
    triangle_corners t = triangle_load( s->xyzw, s->triangles, triangle );
    int64_t box = find_range( v, &t, first, last );
    voxel_finder finder = make_finder( v, &t, box );
    for ( int z = first[2]; z <= last[2]; ++z )
    {
        for ( int y = first[1]; y <= last[1]; ++y )
        {
            for ( int x = first[0]; x <= last[0]; ++x )
            {
                if ( box > 1 && !is_touched( v, &finder, x, y, z ) )
                {
                    continue;
                }
                int32_t voxel = voxels_number( v, x, y, z );
                if ( lists == NULL )
                {
                    begins[voxel + 1] += 1;
                }
                else
                {
                    lists[begins[voxel]++] = triangle;
                }
            }
        }
    }
}

// ---- build ----

static void mark_blocks( voxels* v )
{
    const int32_t* begins = v->begins.data;
    uint64_t* masks = v->masks.data;
    memset( masks, 0, (size_t)v->block_count * sizeof( *masks ) );
    int32_t voxel = 0;
    for ( int z = 0; z < v->count[2]; ++z )
    {
        for ( int y = 0; y < v->count[1]; ++y )
        {
            uint64_t* row = masks + ( z / VOXELS_BLOCK * v->blocks[1] + y / VOXELS_BLOCK ) * v->blocks[0];
            int bit = ( z % VOXELS_BLOCK * VOXELS_BLOCK + y % VOXELS_BLOCK ) * VOXELS_BLOCK;
            for ( int x = 0; x < v->count[0]; ++x, ++voxel )
            {
                uint64_t has = begins[voxel + 1] > begins[voxel] ? 1 : 0;
                row[x / VOXELS_BLOCK] |= has << ( bit + x % VOXELS_BLOCK );
            }
        }
    }
}

static wisp_status no_memory( const mesh_surface* s, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "out of memory for the voxels of a collider of %d triangles",
                      s->triangle_count );
}

// Lists triangles by voxel with a counting sort. Triangles are visited in order, so lists are in increasing order.
wisp_status voxels_build( voxels* v, const mesh_surface* s, wisp_error* error )
{
    wisp_status status = choose_size( v, s, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    size_t begin_bytes = ( (size_t)v->voxel_count + 1 ) * sizeof( int32_t );
    if ( !base_buffer_reserve( &s->allocator, &v->begins, begin_bytes ) ||
         !base_buffer_reserve( &s->allocator, &v->masks, (size_t)v->block_count * sizeof( uint64_t ) ) )
    {
        return no_memory( s, error );
    }
    int32_t* begins = v->begins.data;
    memset( begins, 0, begin_bytes );
    for ( int32_t t = 0; t < s->triangle_count; ++t )
    {
        list_triangle( v, s, t, begins, NULL );
    }
    for ( int i = 0; i < v->voxel_count; ++i )
    {
        begins[i + 1] += begins[i];
    }
    if ( !base_buffer_reserve( &s->allocator, &v->lists, (size_t)begins[v->voxel_count] * sizeof( int32_t ) ) )
    {
        return no_memory( s, error );
    }
    for ( int32_t t = 0; t < s->triangle_count; ++t )
    {
        list_triangle( v, s, t, begins, v->lists.data );
    }
    // each begin has advanced to the end of its list, which is the begin of the next one
    memmove( begins + 1, begins, begin_bytes - sizeof( int32_t ) );
    begins[0] = 0;
    mark_blocks( v );
    v->build_count += 1;
    return WISP_OK;
}

void voxels_release( voxels* v, const wisp_allocator* allocator )
{
    base_buffer_release( allocator, &v->begins );
    base_buffer_release( allocator, &v->lists );
    base_buffer_release( allocator, &v->masks );
    *v = ( voxels ){ 0 };
}

size_t voxels_bytes( const voxels* v )
{
    return v->begins.size + v->lists.size + v->masks.size;
}
