// The binary part of a .glb file: indices and points of bodies, their morph targets, and the animation.
//
// A morph target moves vertices and cannot change triangles. Where a body tears, all frames have the triangles of the last
// one, and a vertex is where its corners are in the frame: in one place with its twins until they are split.
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

// Carry vectors at the vertices of a frame to those of the last frame.
static void carry_to_last( const wisp_recorder* recorder, int b, wisp_vec3* vectors )
{
    const glb_file* file = recorder->file;
    const wisp_record_body* body = &recorder->bodies.list[b];
    if ( body->triangles_change )
    {
        record_carry_corners( body, body->triangles, file->last, vectors );
    }
}

// @param normals [vertex_count] unit normals of the frame; null if not needed
static wisp_status load_frame( const wisp_recorder* recorder, int b, int frame, wisp_vec3* points, wisp_vec3* normals,
                               wisp_error* error )
{
    const glb_file* file = recorder->file;
    const wisp_record_body* body = &recorder->bodies.list[b];
    const size_t bytes = (size_t)body->vertex_count * sizeof *points;
    if ( body->is_static )
    {
        memcpy( points, recorder->fixed[b], bytes );
    }
    const wisp_status status =
        body->is_static ? WISP_OK : record_waiting_points( recorder, file->waiting, frame, b, points, error );
    if ( status == WISP_OK && normals != NULL )
    {
        memcpy( normals, record_normals( recorder, b, points ), bytes );
        carry_to_last( recorder, b, normals );
    }
    if ( status == WISP_OK )
    {
        carry_to_last( recorder, b, points );
    }
    return status;
}

// Load the triangles of the last frame into file->last.
static wisp_status load_last( const wisp_recorder* recorder, int b, wisp_error* error )
{
    const glb_file* file = recorder->file;
    const wisp_record_body* body = &recorder->bodies.list[b];
    if ( body->triangles_change == false )
    {
        return WISP_OK;
    }
    const wisp_status status =
        record_waiting_points( recorder, file->waiting, recorder->frame_count - 1, b, file->points, error );
    memcpy( file->last, body->triangles, (size_t)record_triangle_bytes( body ) );
    return status;
}

// Load a target of a body: file->points become displacements from the first frame.
static wisp_status load_target( const wisp_recorder* recorder, int b, int target, wisp_error* error )
{
    const glb_file* file = recorder->file;
    wisp_status status = load_frame( recorder, b, target + 1, file->points, NULL, error );
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
    wisp_status status = load_last( recorder, b, error );
    status = status == WISP_OK ? load_frame( recorder, b, 0, file->first, NULL, error ) : status;
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
        status = load_frame( recorder, b, target + 1, file->points, file->normals, error );
        for ( int v = 0; status == WISP_OK && v < count; ++v )
        {
            const wisp_vec3 turned = difference( unit_normal( file->normals[v] ), file->first_normals[v] );
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
    wisp_status status = load_last( recorder, b, error );
    if ( status == WISP_OK )
    {
        put_indices( out, body );
        status = load_frame( recorder, b, 0, file->first, place->has_normals ? file->first_normals : NULL, error );
    }
    if ( status != WISP_OK )
    {
        return status;
    }
    put_vectors( out, file->first, body->vertex_count );
    if ( place->has_normals )
    {
        for ( int v = 0; v < body->vertex_count; ++v )
        {
            file->first_normals[v] = unit_normal( file->first_normals[v] );
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
