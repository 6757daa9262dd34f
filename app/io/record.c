// The recorder: bodies and frames are checked here, so that formats only write.
#include "record_internal.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

// ---- formats ---------------------------------------------------------------------------------------------------

// In the order of wisp_record_format, which starts with the name's choice.
static const record_format* const formats[] = {
    &record_format_wisp, &record_format_pc2,  &record_format_pvd,
    &record_format_obj,  &record_format_usda, &record_format_glb,
};

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
    int number = (int)requested;
    if ( number < 0 || number > WISP_COUNT( formats ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got recording format %d, which does not exist",
                          io_short_name( path ), number );
    }
    *format = number > 0 ? formats[number - 1] : format_of( path );
    return *format != NULL ? WISP_OK
                           : wisp_fail( error, WISP_BAD_INPUT,
                                        "%s: expected a file that ends in .wisp, .pc2, .pvd, .obj, .usda or .glb",
                                        io_short_name( path ) );
}

// ---- the recorder ----------------------------------------------------------------------------------------------

static void release_recorder( wisp_recorder* recorder )
{
    for ( int b = 0; recorder->fixed != NULL && b < recorder->bodies.count; ++b )
    {
        free( recorder->fixed[b] );
    }
    free( recorder->fixed );
    free( recorder->normal_sums );
    free( recorder->normals );
    record_release_bodies( &recorder->bodies );
    free( recorder->path );
    free( recorder );
}

// Room for where static bodies stand, and for the normals of any mesh.
static bool make_room( wisp_recorder* recorder )
{
    size_t largest = 1;
    recorder->fixed = calloc( (size_t)recorder->bodies.count, sizeof *recorder->fixed );
    bool made = recorder->fixed != NULL;
    for ( int b = 0; made && b < recorder->bodies.count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies.list[b];
        size_t count = (size_t)body->vertex_count;
        largest = body->offsets == NULL && count > largest ? count : largest;
        recorder->fixed[b] = body->is_static ? malloc( count * sizeof **recorder->fixed ) : NULL;
        made = !body->is_static || recorder->fixed[b] != NULL;
    }
    if ( !made || !recorder->format->has_normals )
    {
        return made;
    }
    recorder->normal_sums = malloc( 3 * largest * sizeof *recorder->normal_sums );
    recorder->normals = malloc( largest * sizeof *recorder->normals );
    return recorder->normal_sums != NULL && recorder->normals != NULL;
}

static wisp_status start( wisp_recorder* recorder, const char* path, const wisp_recorder_def* def, wisp_error* error )
{
    recorder->dt = def->dt;
    recorder->frames_expected = def->frame_count;
    recorder->path = strdup( path );
    if ( recorder->path == NULL )
    {
        return record_no_memory( path, error );
    }
    wisp_status status = record_copy_bodies( def->bodies, def->body_count, path, &recorder->bodies, error );
    if ( status == WISP_OK && !make_room( recorder ) )
    {
        status = record_no_memory( path, error );
    }
    return status == WISP_OK ? recorder->format->open( recorder, error ) : status;
}

wisp_status wisp_recorder_open( const char* path, wisp_record_format format, const wisp_recorder_def* def,
                                wisp_recorder** out, wisp_error* error )
{
    *out = NULL;
    const record_format* found = NULL;
    wisp_status status = find_format( path, format, &found, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( !isfinite( def->dt ) || def->dt <= 0.0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %g seconds between two frames, expected more than 0",
                          io_short_name( path ), def->dt );
    }
    status = record_check_bodies( def->bodies, def->body_count, path, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_recorder* recorder = calloc( 1, sizeof *recorder );
    if ( recorder == NULL )
    {
        return record_no_memory( path, error );
    }
    recorder->format = found;
    status = start( recorder, path, def, error );
    if ( status != WISP_OK )
    {
        release_recorder( recorder );
        return status;
    }
    *out = recorder;
    return WISP_OK;
}

static wisp_status check_values( const wisp_recorder* recorder, const wisp_record_body* body, wisp_error* error )
{
    for ( int i = 0; i < body->value_count; ++i )
    {
        for ( int v = 0; v < body->vertex_count; ++v )
        {
            if ( !isfinite( body->values[i].numbers[v] ) )
            {
                return wisp_fail( error, WISP_BAD_INPUT, "%s: frame %d: body %s, vertex %d: %s is not finite",
                                  io_short_name( recorder->path ), recorder->frame_count, body->name, v,
                                  body->values[i].name );
            }
        }
    }
    return WISP_OK;
}

static wisp_status check_body( const wisp_recorder* recorder, int b, const wisp_vec3* points, wisp_error* error )
{
    const wisp_record_body* body = &recorder->bodies.list[b];
    int64_t found = record_find_not_finite( points, body->vertex_count );
    if ( found >= 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: frame %d: body %s, vertex %d: %c is not finite",
                          io_short_name( recorder->path ), recorder->frame_count, body->name, (int)( found / 3 ),
                          "xyz"[found % 3] );
    }
    if ( body->is_static && recorder->frame_count > 0 &&
         memcmp( points, recorder->fixed[b], (size_t)body->vertex_count * sizeof *points ) != 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: frame %d: body %s has moved, but it was opened as static",
                          io_short_name( recorder->path ), recorder->frame_count, body->name );
    }
    if ( body->triangles_change )
    {
        record_set_triangles( body, recorder->bodies.sources[b] );
        const wisp_status status = record_check_mesh( body, io_short_name( recorder->path ), error );
        if ( status != WISP_OK )
        {
            return status;
        }
    }
    return recorder->format->has_values ? check_values( recorder, body, error ) : WISP_OK;
}

static wisp_status check_frame( const wisp_recorder* recorder, double time, const wisp_vec3* const* points,
                                wisp_error* error )
{
    const char* name = io_short_name( recorder->path );
    if ( recorder->frame_count == INT_MAX )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: expected at most %d frames", name, INT_MAX );
    }
    if ( !isfinite( time ) || ( recorder->frame_count > 0 && time <= recorder->last_time ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: frame %d: got time %.9g s, expected more than %.9g s, that of the frame before", name,
                          recorder->frame_count, time, recorder->last_time );
    }
    wisp_status status = WISP_OK;
    for ( int b = 0; b < recorder->bodies.count && status == WISP_OK; ++b )
    {
        status = check_body( recorder, b, points[b], error );
    }
    return status;
}

// Before the format writes, because it takes them from here.
static void keep_static_points( wisp_recorder* recorder, const wisp_vec3* const* points )
{
    for ( int b = 0; recorder->frame_count == 0 && b < recorder->bodies.count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies.list[b];
        if ( body->is_static )
        {
            memcpy( recorder->fixed[b], points[b], (size_t)body->vertex_count * sizeof **points );
        }
    }
}

wisp_status wisp_recorder_frame( wisp_recorder* recorder, double time, uint64_t hash, const wisp_vec3* const* points,
                                 wisp_error* error )
{
    if ( recorder->lost )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: an earlier frame could not be written",
                          io_short_name( recorder->path ) );
    }
    wisp_status status = check_frame( recorder, time, points, error );
    if ( status == WISP_OK )
    {
        record_frame frame = { time, hash, points };
        keep_static_points( recorder, points );
        status = recorder->format->frame( recorder, &frame, error );
    }
    if ( status == WISP_OK )
    {
        recorder->last_time = time;
        ++recorder->frame_count;
    }
    return status;
}

wisp_status wisp_recorder_close( wisp_recorder* recorder, wisp_error* error )
{
    if ( recorder == NULL )
    {
        return WISP_OK;
    }
    wisp_status status = recorder->format->close( recorder, error );
    if ( recorder->lost )
    {
        status = wisp_fail( error, WISP_IO_ERROR, "%s: the recording is not complete: a frame could not be written",
                            io_short_name( recorder->path ) );
    }
    release_recorder( recorder );
    return status;
}
