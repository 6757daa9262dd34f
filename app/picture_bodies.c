// Memory for the bodies of a picture, of every kind of input.
#include "picture_source.h"

#include <limits.h>
#include <stdlib.h>

wisp_status picture_no_memory( const picture_source* source, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its bodies", source->path );
}

wisp_status picture_make_bodies( picture_source* source, int count, wisp_error* error )
{
    if ( count < 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: contains nothing to draw", source->path );
    }
    source->bodies = calloc( (size_t)count, sizeof *source->bodies );
    source->points = calloc( (size_t)count, sizeof *source->points );
    source->body_count = source->bodies && source->points ? count : 0;
    return source->body_count > 0 ? WISP_OK : picture_no_memory( source, error );
}

wisp_status picture_make_points( picture_source* source, int body, bool has_values, wisp_error* error )
{
    picture_body* b = &source->bodies[body];
    size_t count = (size_t)b->vertex_count + 1;
    b->points = malloc( count * sizeof *b->points );
    source->points[body] = b->points;
    if ( has_values )
    {
        b->values = calloc( count, sizeof *b->values );
    }
    return b->points && ( b->values || !has_values ) ? WISP_OK : picture_no_memory( source, error );
}

wisp_status picture_make_layer( picture_source* source, int body, int count, wisp_error* error )
{
    picture_layer* layer = &source->bodies[body].layer;
    layer->count = 0;
    if ( count <= layer->room )
    {
        return WISP_OK;
    }
    free( layer->points );
    free( layer->normals );
    // A layer that grows from frame to frame is not reallocated in each of them.
    const size_t room = (size_t)count + ( count <= INT_MAX / 2 ? (size_t)count / 4 : 0 );
    layer->points = malloc( room * sizeof *layer->points );
    layer->normals = malloc( room * sizeof *layer->normals );
    layer->room = layer->points && layer->normals ? (int)room : 0;
    return layer->room > 0 ? WISP_OK : picture_no_memory( source, error );
}

wisp_status picture_is_closed( const picture_body* body, bool* is_closed, wisp_error* error )
{
    // The doctor only reads, but the type of a mesh has writable arrays.
    const wisp_mesh mesh = {
        .points = body->points,
        .triangles = (int32_t*)(uintptr_t)body->triangles,
        .vertex_count = body->vertex_count,
        .triangle_count = body->triangle_count,
    };
    *is_closed = false;
    if ( mesh.triangle_count == 0 )
    {
        return WISP_OK;
    }
    wisp_mesh_diagnostics report;
    wisp_status status = wisp_mesh_examine( &mesh, &report, error );
    *is_closed = status == WISP_OK && report.closed;
    return status;
}
