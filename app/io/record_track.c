// Vertex tracks as comma-separated values. Names of bodies have no commas and no quotes, so nothing needs quoting.
#include "record_internal.h"

#include <errno.h>
#include <math.h>

struct wisp_track
{
    record_memory memory;
    io_output output;
    char* path;
    wisp_track_point* points;
    int point_count;
};

static wisp_status check_points( const char* path, const wisp_track_def* def, wisp_error* error )
{
    wisp_status status = record_check_bodies( def->bodies, def->body_count, path, error );
    if ( status == WISP_OK && def->point_count < 1 )
    {
        status = record_wrong( error, path, "got %d vertices, expected at least 1", def->point_count );
    }
    for ( int i = 0; status == WISP_OK && i < def->point_count; ++i )
    {
        const int body = def->points[i].body, vertex = def->points[i].vertex;
        if ( body < 0 || body >= def->body_count )
        {
            status = record_wrong( error, path, "track %d names body %d of %d", i, body, def->body_count );
        }
        else if ( vertex < 0 || vertex >= def->bodies[body].vertex_count )
        {
            status = record_wrong( error, path, "track %d names vertex %d of body %s, which has %d", i, vertex,
                                   def->bodies[body].name, def->bodies[body].vertex_count );
        }
    }
    return status;
}

static void write_names( FILE* out, const wisp_track_def* def )
{
    fputs( "time", out );
    for ( int i = 0; i < 3 * def->point_count; ++i )
    {
        const wisp_track_point point = def->points[i / 3];
        fprintf( out, ",%s.%d.%c", def->bodies[point.body].name, point.vertex, "xyz"[i % 3] );
    }
    fputs( "\n", out );
}

static void release( wisp_track* track )
{
    record_memory memory = track->memory; // the track is in it
    record_release( &memory );
}

wisp_status wisp_track_open( const char* path, const wisp_track_def* def, wisp_track** out, wisp_error* error )
{
    *out = NULL;
    wisp_status status = check_points( path, def, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    record_memory memory = { 0 };
    wisp_track* track = record_get( &memory, sizeof *track );
    char* own_path = record_copy( &memory, path, strlen( path ) + 1 );
    wisp_track_point* points = record_copy( &memory, def->points, (size_t)def->point_count * sizeof *points );
    if ( memory.is_short )
    {
        record_release( &memory );
        return record_no_memory( path, error );
    }
    *track = ( wisp_track ){ .path = own_path, .points = points, .point_count = def->point_count, .memory = memory };
    status = io_output_open( path, &track->output, error );
    if ( status != WISP_OK )
    {
        release( track );
        return status;
    }
    write_names( track->output.stream, def );
    *out = track;
    return WISP_OK;
}

static wisp_status check_frame( const wisp_track* track, double time, const wisp_vec3* const* points,
                                wisp_error* error )
{
    if ( !isfinite( time ) )
    {
        return record_wrong( error, track->path, "the time is not finite" );
    }
    for ( int i = 0; i < track->point_count; ++i )
    {
        const wisp_track_point point = track->points[i];
        if ( record_find_not_finite( &points[point.body][point.vertex].x, 3 ) >= 0 )
        {
            return record_wrong( error, track->path, "track %d at %.9g s: vertex %d of body %d is not finite", i,
                                 time, point.vertex, point.body );
        }
    }
    return WISP_OK;
}

wisp_status wisp_track_frame( wisp_track* track, double time, const wisp_vec3* const* points, wisp_error* error )
{
    io_numbers numbers;
    wisp_status status = check_frame( track, time, points, error );
    status = status == WISP_OK ? io_numbers_begin( &numbers, error ) : status;
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
        const wisp_vec3 p = points[track->points[i].body][track->points[i].vertex];
        fprintf( out, ",%.9g,%.9g,%.9g", (double)p.x, (double)p.y, (double)p.z );
    }
    const int last = fputs( "\n", out );
    io_numbers_end( &numbers );
    return last >= 0 && !ferror( out ) ? WISP_OK : record_refused( track->path, "write", error );
}

wisp_status wisp_track_close( wisp_track* track, wisp_error* error )
{
    const wisp_status status = track != NULL ? io_output_commit( &track->output, error ) : WISP_OK;
    if ( track != NULL )
    {
        release( track );
    }
    return status;
}
