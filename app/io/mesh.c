// The container: memory, checks, and triangles added one by one.
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io_file.h"

#include "wisp/module/definition.h"

enum
{
    FIRST_TRIANGLES = 256, // initial capacity for the triangles of a file
};

// ---- memory ----------------------------------------------------------------------------------------------------

void wisp_mesh_release( wisp_mesh* mesh )
{
    if ( mesh == NULL )
    {
        return;
    }
    free( mesh->points );
    free( mesh->triangles );
    free( mesh->colours );
    free( mesh->uvs );
    *mesh = ( wisp_mesh ){ 0 };
}

wisp_status mesh_allocate( wisp_mesh* mesh, int vertex_count, int triangle_count, const char* name,
                           wisp_error* error )
{
    *mesh = ( wisp_mesh ){
        .points = malloc( (size_t)vertex_count * sizeof( wisp_vec3 ) ),
        .triangles = malloc( (size_t)triangle_count * 3 * sizeof( int32_t ) ),
        .vertex_count = vertex_count,
        .triangle_count = triangle_count,
    };
    if ( mesh->points == NULL || mesh->triangles == NULL )
    {
        wisp_mesh_release( mesh );
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d vertices and %d triangles",
                          io_short_name( name ), vertex_count, triangle_count );
    }
    return WISP_OK;
}

static wisp_status out_of_memory( const wisp_mesh* mesh, const char* name, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d vertices", io_short_name( name ),
                      mesh->vertex_count );
}

wisp_status mesh_allocate_colours( wisp_mesh* mesh, const char* name, wisp_error* error )
{
    mesh->colours = calloc( (size_t)mesh->vertex_count, sizeof *mesh->colours );
    return mesh->colours != NULL ? WISP_OK : out_of_memory( mesh, name, error );
}

wisp_status mesh_allocate_uvs( wisp_mesh* mesh, const char* name, wisp_error* error )
{
    mesh->uvs = calloc( (size_t)mesh->vertex_count, 2 * sizeof *mesh->uvs );
    return mesh->uvs != NULL ? WISP_OK : out_of_memory( mesh, name, error );
}

wisp_status mesh_copy( const wisp_mesh* mesh, wisp_mesh* out, const char* name, wisp_error* error )
{
    const size_t vertices = (size_t)mesh->vertex_count, triangles = (size_t)mesh->triangle_count;
    wisp_status status = mesh_allocate( out, mesh->vertex_count, mesh->triangle_count, name, error );
    if ( status == WISP_OK && mesh->colours != NULL )
    {
        status = mesh_allocate_colours( out, name, error );
    }
    if ( status == WISP_OK && mesh->uvs != NULL )
    {
        status = mesh_allocate_uvs( out, name, error );
    }
    if ( status != WISP_OK )
    {
        wisp_mesh_release( out );
        return status;
    }
    memcpy( out->points, mesh->points, vertices * sizeof *out->points );
    memcpy( out->triangles, mesh->triangles, 3 * triangles * sizeof *out->triangles );
    if ( out->colours != NULL )
    {
        memcpy( out->colours, mesh->colours, vertices * sizeof *out->colours );
    }
    if ( out->uvs != NULL )
    {
        memcpy( out->uvs, mesh->uvs, 2 * vertices * sizeof *out->uvs );
    }
    out->colour_missing_count = mesh->colour_missing_count;
    out->uv_missing_count = mesh->uv_missing_count;
    out->uv_seam_count = mesh->uv_seam_count;
    return WISP_OK;
}

static wisp_status grow( mesh_fan* fan, wisp_error* error )
{
    if ( fan->mesh->triangle_count >= WISP_MESH_TRIANGLE_CAP )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: expected at most %d triangles", io_short_name( fan->name ),
                          WISP_MESH_TRIANGLE_CAP );
    }
    int capacity = fan->capacity == 0 ? FIRST_TRIANGLES : 2 * fan->capacity;
    int32_t* larger = realloc( fan->mesh->triangles, (size_t)capacity * 3 * sizeof *larger );
    if ( larger == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d triangles", io_short_name( fan->name ),
                          capacity );
    }
    fan->mesh->triangles = larger;
    fan->capacity = capacity;
    return WISP_OK;
}

wisp_status mesh_fan_corner( mesh_fan* fan, int32_t vertex, wisp_error* error )
{
    if ( fan->corner_count >= 2 )
    {
        wisp_mesh* mesh = fan->mesh;
        WISP_TRY( mesh->triangle_count < fan->capacity ? WISP_OK : grow( fan, error ) );
        int32_t* triangle = mesh->triangles + 3 * mesh->triangle_count;
        triangle[0] = fan->first;
        triangle[1] = fan->previous;
        triangle[2] = vertex;
        ++mesh->triangle_count;
    }
    fan->first = fan->corner_count == 0 ? vertex : fan->first;
    fan->previous = vertex;
    ++fan->corner_count;
    return WISP_OK;
}

void mesh_fan_finish( mesh_fan* fan )
{
    size_t size = (size_t)fan->mesh->triangle_count * 3 * sizeof( int32_t );
    int32_t* exact = size > 0 ? realloc( fan->mesh->triangles, size ) : NULL;
    fan->mesh->triangles = exact != NULL ? exact : fan->mesh->triangles;
}

// ---- checks ----------------------------------------------------------------------------------------------------

wisp_status mesh_check_vertex( wisp_vec3 p, int v, const char* name, wisp_error* error )
{
    const float values[] = { p.x, p.y, p.z };
    for ( int axis = 0; axis < 3; ++axis )
    {
        if ( !isfinite( values[axis] ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: vertex %d: %c is %s", io_short_name( name ), v, "xyz"[axis],
                              isnan( values[axis] ) ? "NaN" : "infinite" );
        }
    }
    return WISP_OK;
}

static wisp_status check_attributes( const wisp_mesh* mesh, int v, const char* name, wisp_error* error )
{
    const wisp_vec3 c = mesh->colours != NULL ? mesh->colours[v] : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    const bool good_uv = mesh->uvs == NULL || ( isfinite( mesh->uvs[2 * v] ) && isfinite( mesh->uvs[2 * v + 1] ) );
    const bool good_colour = isfinite( c.x ) && isfinite( c.y ) && isfinite( c.z );
    return good_uv && good_colour
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "%s: vertex %d: %s not finite", io_short_name( name ), v,
                            good_uv ? "its colour is" : "its texture coordinates are" );
}

static wisp_status check_sizes( const wisp_mesh* mesh, const char* name, wisp_error* error )
{
    if ( mesh->vertex_count < 1 || mesh->triangle_count < 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the mesh is empty: %d vertices, %d triangles",
                          io_short_name( name ), mesh->vertex_count, mesh->triangle_count );
    }
    if ( mesh->vertex_count > WISP_MESH_VERTEX_CAP || mesh->triangle_count > WISP_MESH_TRIANGLE_CAP )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %d vertices and %d triangles, expected at most %d and %d",
                          io_short_name( name ), mesh->vertex_count, mesh->triangle_count, WISP_MESH_VERTEX_CAP,
                          WISP_MESH_TRIANGLE_CAP );
    }
    if ( mesh->points == NULL || mesh->triangles == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the mesh has no %s", io_short_name( name ),
                          mesh->points == NULL ? "points" : "triangles" );
    }
    return WISP_OK;
}

wisp_status mesh_check( const wisp_mesh* mesh, const char* name, wisp_error* error )
{
    wisp_status status = check_sizes( mesh, name, error );
    for ( int v = 0; status == WISP_OK && v < mesh->vertex_count; ++v )
    {
        status = mesh_check_vertex( mesh->points[v], v, name, error );
        status = status == WISP_OK ? check_attributes( mesh, v, name, error ) : status;
    }
    for ( int c = 0; status == WISP_OK && c < 3 * mesh->triangle_count; ++c )
    {
        int32_t vertex = mesh->triangles[c];
        if ( vertex < 0 || vertex >= mesh->vertex_count )
        {
            status = wisp_fail( error, WISP_BAD_INPUT, "%s: triangle %d: corner %d: got vertex %d, expected 0 .. %d",
                                io_short_name( name ), c / 3, c % 3, vertex, mesh->vertex_count - 1 );
        }
    }
    return status;
}

wisp_status wisp_mesh_of_arrays( const wisp_vec3* points, int vertex_count, const int32_t* triangles,
                                 int triangle_count, const char* name, wisp_mesh* out, wisp_error* error )
{
    *out = ( wisp_mesh ){ 0 };
    // The check only reads; there is no mesh of read-only arrays.
    const wisp_mesh given = { .points = (wisp_vec3*)(uintptr_t)points,
                              .triangles = (int32_t*)(uintptr_t)triangles,
                              .vertex_count = vertex_count,
                              .triangle_count = triangle_count };
    WISP_TRY( mesh_check( &given, name, error ) );
    WISP_TRY( mesh_allocate( out, vertex_count, triangle_count, name, error ) );
    memcpy( out->points, points, (size_t)vertex_count * sizeof *points );
    memcpy( out->triangles, triangles, 3 * (size_t)triangle_count * sizeof *triangles );
    return WISP_OK;
}
