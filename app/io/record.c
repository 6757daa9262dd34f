// The recorder: bodies and frames are checked here, so that formats only write. And what all files of recordings use.
#define _XOPEN_SOURCE 700

#include "record_internal.h"

#include "wisp/module/definition.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <unistd.h>

enum
{
    MESSAGE_MAX = 512,
};

// ---- messages --------------------------------------------------------------------------------------------------

wisp_status record_wrong( wisp_error* error, const char* name, const char* format, ... )
{
    char message[MESSAGE_MAX];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( message, sizeof message, format, arguments );
    va_end( arguments );
    return wisp_fail( error, WISP_BAD_INPUT, "%s: %s", io_short_name( name ), message );
}

wisp_status record_wrong_byte( const record_source* source, uint64_t at, wisp_error* error, const char* format, ... )
{
    char message[MESSAGE_MAX];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( message, sizeof message, format, arguments );
    va_end( arguments );
    return record_wrong( error, source->name, "byte %llu: %s", (unsigned long long)at, message );
}

wisp_status record_no_memory( const char* name, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for the recording", io_short_name( name ) );
}

wisp_status record_refused( const char* path, const char* what, wisp_error* error )
{
    return wisp_fail( error, WISP_IO_ERROR, "%s: cannot %s: %s", io_short_name( path ), what,
                      errno != 0 ? strerror( errno ) : "an earlier write failed" );
}

// ---- formats ---------------------------------------------------------------------------------------------------

static const record_format* const formats[] = { &record_format_wisp, &record_format_pc2,  &record_format_pvd,
                                                &record_format_obj,  &record_format_usda, &record_format_glb };

static const record_format* format_of( const char* path )
{
    for ( int i = 0; i < WISP_COUNT( formats ); ++i )
    {
        if ( io_has_extension( path, formats[i]->extension ) )
        {
            return formats[i];
        }
    }
    return NULL;
}

bool wisp_record_has_values( const char* path )
{
    const record_format* format = format_of( path );
    return format != NULL && format->has_values;
}

static wisp_status find_format( const char* path, wisp_record_format requested, const record_format** format,
                                wisp_error* error )
{
    *format = requested == WISP_RECORD_TRACKS ? &record_format_tracks
              : requested == WISP_RECORD_WISP ? &record_format_wisp
                                              : format_of( path );
    return *format != NULL
               ? WISP_OK
               : record_wrong( error, path, "expected a file that ends in .wisp, .pc2, .pvd, .obj, .usda or .glb" );
}

// ---- paths -----------------------------------------------------------------------------------------------------

const char* record_extension( const wisp_recorder* recorder )
{
    const char* name = io_file_name( recorder->path );
    const char* dot = strrchr( name, '.' );
    return dot == NULL || dot == name ? name + strlen( name ) : dot;
}

const char* record_path_beside( wisp_recorder* recorder, const char* format, ... )
{
    const size_t stem = (size_t)( record_extension( recorder ) - recorder->path );
    memcpy( recorder->beside, recorder->path, stem );
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( recorder->beside + stem, recorder->beside_size - stem, format, arguments );
    va_end( arguments );
    return recorder->beside;
}

// ---- opening ---------------------------------------------------------------------------------------------------

// Runs a function of the format with decimal points.
static wisp_status run( wisp_status ( *function )( wisp_recorder*, wisp_error* ), wisp_recorder* recorder,
                        wisp_error* error )
{
    io_numbers numbers;
    wisp_status status = function != NULL ? io_numbers_begin( &numbers, error ) : WISP_OK;
    if ( status == WISP_OK && function != NULL )
    {
        status = function( recorder, error );
        io_numbers_end( &numbers );
    }
    return status;
}

static void release( wisp_recorder* recorder )
{
    for ( int i = 0; recorder->outputs != NULL && i < recorder->body_count; ++i )
    {
        if ( recorder->outputs[i].stream != NULL )
        {
            io_output_discard( &recorder->outputs[i] );
        }
    }
    if ( recorder->descriptor >= 0 )
    {
        close( recorder->descriptor );
    }
    record_wait_close( recorder, NULL );
    io_memory memory = recorder->memory; // the recorder is in it
    io_release( &memory );
}

static bool has_origin( const wisp_recorder* recorder )
{
    return recorder->origin[0] != 0.0 || recorder->origin[1] != 0.0 || recorder->origin[2] != 0.0;
}

static void reserve_moved( wisp_recorder* recorder )
{
    io_memory* memory = &recorder->memory;
    recorder->moved = io_get( memory, (size_t)recorder->body_count * sizeof *recorder->moved );
    for ( int b = 0; !memory->is_short && b < recorder->body_count; ++b )
    {
        recorder->moved[b] = io_get( memory, (size_t)recorder->bodies[b].vertex_count * sizeof( wisp_vec3 ) );
    }
}

static void copy( wisp_recorder* recorder, const char* path, const wisp_recorder_def* def )
{
    io_memory* memory = &recorder->memory;
    const size_t count = (size_t)def->body_count;
    recorder->body_count = def->body_count;
    recorder->dt = def->dt;
    recorder->frames_expected = def->frame_count;
    recorder->track_count = def->track_count > 0 ? def->track_count : 0;
    recorder->tracks = io_copy( memory, def->tracks, (size_t)recorder->track_count * sizeof *recorder->tracks );
    recorder->path = io_copy( memory, path, strlen( path ) + 1 );
    recorder->beside_size = 2 * strlen( path ) + WISP_RECORD_MAX_NAME + 32;
    recorder->beside = io_get( memory, recorder->beside_size );
    recorder->outputs = io_get( memory, count * sizeof *recorder->outputs );
    recorder->inputs = io_get( memory, count * sizeof *recorder->inputs );
    recorder->bodies = record_copy_bodies( memory, def->bodies, def->body_count );
    recorder->file = io_get( memory, recorder->format->file_size );
    for ( int b = 0; !memory->is_short && b < def->body_count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies[b];
        const size_t points = body->is_static ? (size_t)body->vertex_count * sizeof( wisp_vec3 ) : 0;
        recorder->inputs[b].triangles = def->bodies[b].triangles;
        recorder->inputs[b].fixed = io_get( memory, points );
        recorder->most_vertices =
            body->vertex_count > recorder->most_vertices ? body->vertex_count : recorder->most_vertices;
    }
    memcpy( recorder->origin, def->origin, sizeof recorder->origin );
    if ( recorder->format->has_origin == false && has_origin( recorder ) && !memory->is_short )
    {
        reserve_moved( recorder );
    }
    if ( recorder->format->has_normals )
    {
        const size_t most = (size_t)recorder->most_vertices;
        recorder->normal_sums = io_get( memory, 3 * most * sizeof *recorder->normal_sums );
        recorder->normals = io_get( memory, most * sizeof *recorder->normals );
    }
}

wisp_status wisp_recorder_open( const char* path, wisp_record_format format, const wisp_recorder_def* def,
                                wisp_recorder** out, wisp_error* error )
{
    *out = NULL;
    const record_format* found = NULL;
    WISP_TRY( find_format( path, format, &found, error ) );
    if ( !isfinite( def->dt ) || def->dt <= 0.0 )
    {
        return record_wrong( error, path, "got %g seconds between two frames, expected more than 0", def->dt );
    }
    if ( !isfinite( def->origin[0] + def->origin[1] + def->origin[2] ) )
    {
        return record_wrong( error, path, "the origin is not finite" );
    }
    WISP_TRY( record_check_bodies( def->bodies, def->body_count, path, error ) );
    io_memory memory = { 0 };
    wisp_recorder* recorder = io_get( &memory, sizeof *recorder );
    if ( recorder == NULL )
    {
        return record_no_memory( path, error );
    }
    *recorder = ( wisp_recorder ){ .format = found, .memory = memory, .descriptor = -1 };
    copy( recorder, path, def );
    wisp_status status =
        recorder->memory.is_short ? record_no_memory( path, error ) : run( found->begin, recorder, error );
    if ( status != WISP_OK )
    {
        release( recorder );
        return status;
    }
    *out = recorder;
    return WISP_OK;
}

// ---- frames ----------------------------------------------------------------------------------------------------

static wisp_status check_body( const wisp_recorder* recorder, int b, const wisp_vec3* points, wisp_error* error )
{
    const wisp_record_body* body = &recorder->bodies[b];
    const size_t count = (size_t)body->vertex_count;
    const int64_t found = record_find_not_finite( &points->x, 3 * count );
    if ( found >= 0 )
    {
        return record_wrong( error, recorder->path, "frame %d: body %s, vertex %d: %c is not finite",
                             recorder->frame_count, body->name, (int)( found / 3 ), "xyz"[found % 3] );
    }
    if ( body->is_static && recorder->frame_count > 0 &&
         memcmp( points, recorder->inputs[b].fixed, count * sizeof *points ) != 0 )
    {
        return record_wrong( error, recorder->path, "frame %d: body %s has moved, but it was opened as static",
                             recorder->frame_count, body->name );
    }
    record_set_triangles( body, recorder->inputs[b].triangles );
    wisp_status status = body->triangles_change ? record_check_mesh( body, recorder->path, error ) : WISP_OK;
    for ( int i = 0; recorder->format->has_values && i < body->value_count && status == WISP_OK; ++i )
    {
        const int64_t vertex = record_find_not_finite( body->values[i].numbers, count );
        if ( vertex >= 0 )
        {
            status = record_wrong( error, recorder->path, "frame %d: body %s, vertex %d: %s is not finite",
                                   recorder->frame_count, body->name, (int)vertex, body->values[i].name );
        }
    }
    return status;
}

static wisp_status check_frame( const wisp_recorder* recorder, double time, const wisp_vec3* const* points,
                                wisp_error* error )
{
    if ( recorder->lost )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: an earlier frame could not be written",
                          io_short_name( recorder->path ) );
    }
    if ( recorder->frame_count == INT_MAX )
    {
        return record_wrong( error, recorder->path, "expected at most %d frames", INT_MAX );
    }
    if ( !isfinite( time ) || ( recorder->frame_count > 0 && time <= recorder->last_time ) )
    {
        return record_wrong( error, recorder->path,
                             "frame %d: got time %.9g s, expected more than %.9g s, that of the frame before",
                             recorder->frame_count, time, recorder->last_time );
    }
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        WISP_TRY( check_body( recorder, b, points[b], error ) );
    }
    return WISP_OK;
}

static const wisp_vec3* const* move_points( wisp_recorder* recorder, const wisp_vec3* const* points )
{
    const double* o = recorder->origin;
    for ( int b = 0; b < recorder->body_count && recorder->moved != NULL; ++b )
    {
        for ( int v = 0; v < recorder->bodies[b].vertex_count; ++v )
        {
            const wisp_vec3 p = points[b][v];
            recorder->moved[b][v] = ( wisp_vec3 ){ (float)( (double)p.x + o[0] ), (float)( (double)p.y + o[1] ),
                                                   (float)( (double)p.z + o[2] ) };
        }
    }
    return recorder->moved != NULL ? (const wisp_vec3* const*)recorder->moved : points;
}

wisp_status wisp_recorder_frame( wisp_recorder* recorder, double time, uint64_t hash, const wisp_vec3* const* points,
                                 wisp_error* error )
{
    io_numbers numbers;
    WISP_TRY( check_frame( recorder, time, points, error ) );
    WISP_TRY( io_numbers_begin( &numbers, error ) );
    for ( int b = 0; b < recorder->body_count && recorder->frame_count == 0; ++b )
    {
        if ( recorder->bodies[b].is_static )
        {
            memcpy( recorder->inputs[b].fixed, points[b],
                    (size_t)recorder->bodies[b].vertex_count * sizeof **points );
        }
    }
    wisp_status status =
        recorder->format->frame( recorder, &( record_frame ){ time, hash, move_points( recorder, points ) }, error );
    io_numbers_end( &numbers );
    if ( status == WISP_OK )
    {
        recorder->last_time = time;
        ++recorder->frame_count;
    }
    return status;
}

// ---- closing ---------------------------------------------------------------------------------------------------

wisp_status wisp_recorder_close( wisp_recorder* recorder, wisp_error* error )
{
    if ( recorder == NULL )
    {
        return WISP_OK;
    }
    wisp_status status = recorder->lost ? WISP_OK : run( recorder->format->end, recorder, error );
    status = status == WISP_OK ? record_wait_close( recorder, error ) : status;
    for ( int i = 0; i < recorder->body_count && status == WISP_OK && !recorder->lost; ++i )
    {
        status = recorder->outputs[i].stream != NULL ? io_output_commit( &recorder->outputs[i], error ) : WISP_OK;
    }
    if ( recorder->descriptor >= 0 && close( recorder->descriptor ) != 0 && status == WISP_OK )
    {
        status = record_refused( recorder->path, "write", error );
    }
    recorder->descriptor = -1;
    if ( recorder->lost )
    {
        status = wisp_fail( error, WISP_IO_ERROR, "%s: the recording is not complete: a frame could not be written",
                            io_short_name( recorder->path ) );
    }
    release( recorder );
    return status;
}
