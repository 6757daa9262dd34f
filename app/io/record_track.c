// Vertex tracks as comma-separated values. Names of bodies have no commas and no quotes, so nothing needs quoting.
#include "record_internal.h"

#include <errno.h>

static wisp_status check_track( const wisp_recorder* recorder, int i, wisp_error* error )
{
    const int body = recorder->tracks[i].body, vertex = recorder->tracks[i].vertex;
    if ( body < 0 || body >= recorder->body_count )
    {
        return record_wrong( error, recorder->path, "track %d names body %d of %d", i, body, recorder->body_count );
    }
    const wisp_record_body* of = &recorder->bodies[body];
    return vertex >= 0 && vertex < of->vertex_count
               ? WISP_OK
               : record_wrong( error, recorder->path, "track %d names vertex %d of body %s, which has %d", i, vertex,
                               of->name, of->vertex_count );
}

static wisp_status track_begin( wisp_recorder* recorder, wisp_error* error )
{
    wisp_status status = WISP_OK;
    if ( recorder->track_count < 1 )
    {
        status = record_wrong( error, recorder->path, "got %d vertices, expected at least 1", recorder->track_count );
    }
    for ( int i = 0; status == WISP_OK && i < recorder->track_count; ++i )
    {
        status = check_track( recorder, i, error );
    }
    status = status == WISP_OK ? io_output_open( recorder->path, &recorder->outputs[0], error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    FILE* out = recorder->outputs[0].stream;
    fputs( "time", out );
    for ( int i = 0; i < 3 * recorder->track_count; ++i )
    {
        const wisp_track_point point = recorder->tracks[i / 3];
        fprintf( out, ",%s.%d.%c", recorder->bodies[point.body].name, point.vertex, "xyz"[i % 3] );
    }
    fputs( "\n", out );
    return WISP_OK;
}

static wisp_status track_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    FILE* out = recorder->outputs[0].stream;
    errno = 0;
    // Seventeen digits restore every double bit for bit, nine every float.
    fprintf( out, "%.17g", frame->time );
    for ( int i = 0; i < recorder->track_count; ++i )
    {
        const wisp_vec3 p = frame->points[recorder->tracks[i].body][recorder->tracks[i].vertex];
        fprintf( out, ",%.9g,%.9g,%.9g", (double)p.x, (double)p.y, (double)p.z );
    }
    fputs( "\n", out );
    recorder->lost = ferror( out ) != 0;
    return recorder->lost ? record_refused( recorder->path, "write", error ) : WISP_OK;
}

const record_format record_format_tracks = { ".csv", .begin = track_begin, .frame = track_frame };
