// Vertex tracks as comma-separated values. Names of bodies have no commas and no quotes, so nothing needs quoting.
#include "record_internal.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

struct wisp_track
{
    io_output output;
    char* path;
    wisp_track_point* points;
    int point_count;
};

static wisp_status check_points( const char* path, const wisp_track_def* def, wisp_error* error )
{
    const char* name = io_short_name( path );
    wisp_status status = record_check_bodies( def->bodies, def->body_count, path, error );
    if ( status == WISP_OK && def->point_count < 1 )
    {
        status =
            wisp_fail( error, WISP_BAD_INPUT, "%s: got %d vertices, expected at least 1", name, def->point_count );
    }
    for ( int i = 0; status == WISP_OK && i < def->point_count; ++i )
    {
        wisp_track_point point = def->points[i];
        if ( point.body < 0 || point.body >= def->body_count )
        {
            status = wisp_fail( error, WISP_BAD_INPUT, "%s: track %d names body %d of %d", name, i, point.body,
                                def->body_count );
        }
        else if ( point.vertex < 0 || point.vertex >= def->bodies[point.body].vertex_count )
        {
            status = wisp_fail( error, WISP_BAD_INPUT, "%s: track %d names vertex %d of body %s, which has %d", name,
                                i, point.vertex, def->bodies[point.body].name, def->bodies[point.body].vertex_count );
        }
    }
    return status;
}

static void write_names( FILE* out, const wisp_track_def* def )
{
    fputs( "time", out );
    for ( int i = 0; i < def->point_count; ++i )
    {
        const char* name = def->bodies[def->points[i].body].name;
        for ( int k = 0; k < 3; ++k )
        {
            fprintf( out, ",%s.%d.%c", name, def->points[i].vertex, "xyz"[k] );
        }
    }
    fputs( "\n", out );
}

static void release_track( wisp_track* track )
{
    free( track->path );
    free( track->points );
    free( track );
}

wisp_status wisp_track_open( const char* path, const wisp_track_def* def, wisp_track** out, wisp_error* error )
{
    *out = NULL;
    wisp_status status = check_points( path, def, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_track* track = calloc( 1, sizeof *track );
    if ( track == NULL )
    {
        return record_no_memory( path, error );
    }
    size_t count = (size_t)def->point_count;
    track->path = strdup( path );
    track->points = malloc( count * sizeof *track->points );
    track->point_count = def->point_count;
    status = track->path != NULL && track->points != NULL ? io_output_open( path, &track->output, error )
                                                          : record_no_memory( path, error );
    if ( status != WISP_OK )
    {
        release_track( track );
        return status;
    }
    memcpy( track->points, def->points, count * sizeof *track->points );
    write_names( track->output.stream, def );
    *out = track;
    return WISP_OK;
}

static wisp_status check_frame( const wisp_track* track, double time, const wisp_vec3* const* points,
                                wisp_error* error )
{
    if ( !isfinite( time ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the time is not finite", io_short_name( track->path ) );
    }
    for ( int i = 0; i < track->point_count; ++i )
    {
        wisp_track_point point = track->points[i];
        if ( record_find_not_finite( &points[point.body][point.vertex], 1 ) >= 0 )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: track %d at %.9g s: vertex %d of body %d is not finite",
                              io_short_name( track->path ), i, time, point.vertex, point.body );
        }
    }
    return WISP_OK;
}

wisp_status wisp_track_frame( wisp_track* track, double time, const wisp_vec3* const* points, wisp_error* error )
{
    wisp_status status = check_frame( track, time, points, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    io_numbers numbers;
    status = io_numbers_begin( &numbers, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    FILE* out = track->output.stream;
    errno = 0;
    // Seventeen digits restore every double bit for bit, nine every float.
    fprintf( out, "%.17g", time );
    for ( int i = 0; i < track->point_count; ++i )
    {
        wisp_vec3 p = points[track->points[i].body][track->points[i].vertex];
        fprintf( out, ",%.9g,%.9g,%.9g", (double)p.x, (double)p.y, (double)p.z );
    }
    int last = fputs( "\n", out );
    io_numbers_end( &numbers );
    return last >= 0 && !ferror( out ) ? WISP_OK : record_refused( track->path, "write", error );
}

wisp_status wisp_track_close( wisp_track* track, wisp_error* error )
{
    if ( track == NULL )
    {
        return WISP_OK;
    }
    wisp_status status = io_output_commit( &track->output, error );
    release_track( track );
    return status;
}
