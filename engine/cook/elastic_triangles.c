// Elastic triangles of a mesh: their schedule, and rest shapes as the kernels read them.
#include "wisp/module/elastic_triangles.h"

#include "wisp/module/double3.h"
#include "fabric.h"

// Below this height over its longest edge a triangle has no shape that could be strained: rounding alone would be a large strain.
static const double THINNEST = 1e-4;

struct wisp_elastic_triangles
{
    fabric_pool pool; // the mesh itself lies in it
    wisp_schedule order;
    const int32_t* slot_x4;
    float* shape;  // [group][4][8]
    float* stress; // [group][3][8]; null without
};

typedef struct rest_shape
{
    double b11, b12, b22, area; // 1/m, m^2; all 0: not usable
} rest_shape;

// With edges (a, 0) and (b, h) in the plane of the triangle, the inverse of their matrix.
static rest_shape measure( const wisp_fabric* f, const int32_t* corner )
{
    const wisp_vec3 p = f->rest[corner[0]];
    const double3 e = double3_between( p, f->rest[corner[1]] ), g = double3_between( p, f->rest[corner[2]] );
    const double a = double3_length( e ), twice = double3_length( double3_cross( e, g ) ),
                 longest = fmax( a, fmax( double3_length( g ), double3_length( double3_sub( g, e ) ) ) );
    if ( !( twice > THINNEST * longest * longest && a > 0.0 ) )
    {
        return ( rest_shape ){ 0.0, 0.0, 0.0, 0.0 };
    }
    const double b = double3_dot( e, g ) / a, h = twice / a;
    return ( rest_shape ){ 1.0 / a, -b / ( a * h ), 1.0 / h, 0.5 * twice };
}

static void fill_shapes( wisp_elastic_triangles* mesh, const wisp_fabric* f )
{
    for ( int i = 0; i < mesh->order.slot_count; ++i )
    {
        const int32_t triangle = mesh->order.constraint[i];
        if ( triangle >= 0 )
        {
            const rest_shape s = measure( f, f->triangles + 3 * (size_t)triangle );
            float* lane = mesh->shape + 4 * (size_t)( i - i % WISP_FABRIC_LANES ) + (size_t)( i % WISP_FABRIC_LANES );
            lane[0] = (float)s.b11;
            lane[WISP_FABRIC_LANES] = (float)s.b12;
            lane[2 * WISP_FABRIC_LANES] = (float)s.b22;
            lane[3 * WISP_FABRIC_LANES] = (float)s.area;
        }
    }
}

static bool cook_elastic_triangles( wisp_elastic_triangles* mesh, const wisp_fabric* f, bool with_stress )
{
    fabric_constraints triangles = fabric_triangle_constraints( f );
    triangles.last_slots = f->attachment_count;
    if ( fabric_schedule_build( &triangles, &mesh->pool, &mesh->pool, &mesh->order ) == false ||
         fabric_schedule_corners( &mesh->order, &triangles, &mesh->pool, &mesh->slot_x4 ) == false )
    {
        return false;
    }
    const size_t count = (size_t)mesh->order.slot_count;
    mesh->shape = fabric_pool_push_zeroed( &mesh->pool, 4 * count, sizeof( float ) );
    mesh->stress = with_stress ? fabric_pool_push_zeroed( &mesh->pool, 3 * count, sizeof( float ) ) : NULL;
    if ( mesh->shape == NULL || ( with_stress && mesh->stress == NULL ) )
    {
        return false;
    }
    fill_shapes( mesh, f );
    return true;
}

wisp_status wisp_elastic_triangles_create( const wisp_fabric* fabric, bool with_stress,
                                           const wisp_allocator* allocator, wisp_elastic_triangles** out )
{
    fabric_pool pool = { .allocator = allocator };
    wisp_elastic_triangles* mesh = fabric_pool_push_zeroed( &pool, 1, sizeof( wisp_elastic_triangles ) );
    *out = NULL;
    if ( mesh == NULL )
    {
        return WISP_NO_MEMORY;
    }
    mesh->pool = pool;
    if ( cook_elastic_triangles( mesh, fabric, with_stress ) == false )
    {
        wisp_elastic_triangles_release( mesh, allocator );
        return WISP_NO_MEMORY;
    }
    *out = mesh;
    return WISP_OK;
}

void wisp_elastic_triangles_release( wisp_elastic_triangles* mesh, const wisp_allocator* allocator )
{
    if ( mesh != NULL )
    {
        fabric_pool pool = mesh->pool;
        pool.allocator = allocator;
        fabric_pool_release( &pool );
    }
}

size_t wisp_elastic_triangles_bytes( const wisp_elastic_triangles* mesh )
{
    return mesh != NULL ? mesh->pool.bytes : 0;
}

const wisp_schedule* wisp_elastic_triangles_order( const wisp_elastic_triangles* mesh )
{
    return &mesh->order;
}

wisp_elastic_triangle_args wisp_elastic_triangles_args( const wisp_elastic_triangles* mesh )
{
    return ( wisp_elastic_triangle_args ){ .slot_x4 = mesh->slot_x4, .shape = mesh->shape, .stress = mesh->stress };
}
