// The binary part of a .glb file: indices and points of bodies, their morph targets, and the animation.
#include "record_glb.h"

#include <stdlib.h>

// ---- binary part -----------------------------------------------------------------------------------------------

static void put_vectors( FILE* out, const wisp_vec3* vectors, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        unsigned char bytes[RECORD_POINT_SIZE];
        io_put_vec3( bytes, vectors[v] );
        fwrite( bytes, 1, sizeof bytes, out );
    }
}

static void put_index( FILE* out, int index )
{
    unsigned char bytes[4];
    io_put_u32( bytes, (uint32_t)index );
    fwrite( bytes, 1, sizeof bytes, out );
}

static void put_float( FILE* out, float number )
{
    unsigned char bytes[4];
    io_put_float( bytes, number );
    fwrite( bytes, 1, sizeof bytes, out );
}

static void put_indices( FILE* out, const wisp_record_body* body )
{
    for ( size_t i = 0; body->offsets == NULL && i < 3 * (size_t)body->triangle_count; ++i )
    {
        put_index( out, body->triangles[i] );
    }
    for ( int s = 0; body->offsets != NULL && s < body->strand_count; ++s )
    {
        for ( int v = body->offsets[s]; v + 1 < body->offsets[s + 1]; ++v )
        {
            put_index( out, v );
            put_index( out, v + 1 );
        }
    }
}

static wisp_vec3 difference( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x - b.x, a.y - b.y, a.z - b.z };
}

// The format demands unit normals, also of vertices whose triangles cancel.
static wisp_vec3 unit_normal( wisp_vec3 n )
{
    return n.x != 0.0f || n.y != 0.0f || n.z != 0.0f ? n : ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f };
}

static wisp_status load_points( const wisp_recorder* recorder, int b, int frame, wisp_vec3* out, wisp_error* error )
{
    const glb_file* file = recorder->file;
    const wisp_record_body* body = &recorder->bodies.list[b];
    if ( body->is_static )
    {
        memcpy( out, recorder->fixed[b], (size_t)body->vertex_count * sizeof *out );
        return WISP_OK;
    }
    return record_waiting_points( recorder, file->waiting, frame, b, out, error );
}

// Load a target of a body: file->points become displacements from the first frame.
static wisp_status load_target( const wisp_recorder* recorder, int b, int target, wisp_error* error )
{
    const glb_file* file = recorder->file;
    wisp_status status = load_points( recorder, b, target + 1, file->points, error );
    for ( int v = 0; status == WISP_OK && v < recorder->bodies.list[b].vertex_count; ++v )
    {
        file->points[v] = difference( file->points[v], file->first[v] );
    }
    return status;
}

wisp_status glb_find_bounds( const wisp_recorder* recorder, int b, wisp_error* error )
{
    const glb_file* file = recorder->file;
    glb_body* place = &file->layout.bodies[b];
    const int count = recorder->bodies.list[b].vertex_count;
    place->bounds = calloc( (size_t)place->target_count + 1, sizeof *place->bounds );
    if ( place->bounds == NULL )
    {
        return record_no_memory( recorder->path, error );
    }
    wisp_status status = load_points( recorder, b, 0, file->first, error );
    if ( status == WISP_OK )
    {
        record_extend_bounds( &place->bounds[0], file->first, count );
    }
    for ( int t = 0; t < place->target_count && status == WISP_OK; ++t )
    {
        status = load_target( recorder, b, t, error );
        if ( status == WISP_OK )
        {
            record_extend_bounds( &place->bounds[1 + t], file->points, count );
        }
    }
    return status;
}

static wisp_status put_target( const wisp_recorder* recorder, int b, int target, wisp_error* error )
{
    const glb_file* file = recorder->file;
    const int count = recorder->bodies.list[b].vertex_count;
    FILE* out = file->output.stream;
    wisp_status status = load_target( recorder, b, target, error );
    if ( status == WISP_OK )
    {
        put_vectors( out, file->points, count );
    }
    if ( status == WISP_OK && file->layout.bodies[b].has_normals )
    {
        // The normals are those of the points, not of the displacements.
        status = load_points( recorder, b, target + 1, file->points, error );
        const wisp_vec3* normals = status == WISP_OK ? record_normals( recorder, b, file->points ) : NULL;
        for ( int v = 0; normals != NULL && v < count; ++v )
        {
            const wisp_vec3 turned = difference( unit_normal( normals[v] ), file->first_normals[v] );
            put_vectors( out, &turned, 1 );
        }
    }
    return status;
}

static wisp_status put_body( const wisp_recorder* recorder, int b, wisp_error* error )
{
    const glb_file* file = recorder->file;
    const wisp_record_body* body = &recorder->bodies.list[b];
    const glb_body* place = &file->layout.bodies[b];
    FILE* out = file->output.stream;
    put_indices( out, body );
    wisp_status status = load_points( recorder, b, 0, file->first, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    put_vectors( out, file->first, body->vertex_count );
    if ( place->has_normals )
    {
        const wisp_vec3* normals = record_normals( recorder, b, file->first );
        for ( int v = 0; v < body->vertex_count; ++v )
        {
            file->first_normals[v] = unit_normal( normals[v] );
        }
        put_vectors( out, file->first_normals, body->vertex_count );
    }
    if ( body->colours != NULL )
    {
        put_vectors( out, body->colours, body->vertex_count );
    }
    for ( int t = 0; t < place->target_count && status == WISP_OK; ++t )
    {
        status = put_target( recorder, b, t, error );
    }
    return status;
}

// In frame f the weight of target f - 1 is 1, in the first frame none.
static void put_animation( const wisp_recorder* recorder )
{
    const glb_file* file = recorder->file;
    const int count = file->layout.frame_count;
    for ( int f = 0; f < count; ++f )
    {
        put_float( file->output.stream, (float)record_waiting_time( file->waiting, f ) );
    }
    for ( int f = 0; f < count; ++f )
    {
        for ( int t = 0; t + 1 < count; ++t )
        {
            put_float( file->output.stream, t + 1 == f ? 1.0f : 0.0f );
        }
    }
}

wisp_status glb_put_binary( const wisp_recorder* recorder, wisp_error* error )
{
    const glb_file* file = recorder->file;
    wisp_status status = WISP_OK;
    for ( int b = 0; b < recorder->bodies.count && status == WISP_OK; ++b )
    {
        status = put_body( recorder, b, error );
    }
    if ( status == WISP_OK && file->layout.is_animated )
    {
        put_animation( recorder );
    }
    return status;
}
