// Recordings: written while a world runs, and read frame by frame.
#include "binding_internal.h"

#include "record.h"
#include "run_recorder.h"

#include <stdlib.h>

// ---- writing ----

struct binding_recorder
{
    run_recorder* recorder;
};

wisp_status binding_recorder_open( binding_world* w, const char* path, int every, binding_recorder** out,
                                   wisp_error* error )
{
    *out = NULL;
    // Its list of tracks is too long for the stack of a thread that the host has made.
    run_recorder_def* def = calloc( 1, sizeof *def );
    binding_recorder* r = calloc( 1, sizeof *r );
    wisp_status status = def && r ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for it", path );
    if ( status == WISP_OK )
    {
        def->record = path;
        def->every = every;
        def->steps = w->scene.steps;
        status = run_recorder_open( def, &w->world, &r->recorder, error );
    }
    free( def );
    if ( status != WISP_OK )
    {
        free( r );
        return status;
    }
    *out = r;
    return WISP_OK;
}

wisp_status binding_recorder_step( binding_recorder* r, wisp_error* error )
{
    return run_recorder_step( r->recorder, error );
}

int binding_recorder_frames( const binding_recorder* r )
{
    return run_recorder_count( r->recorder ).written;
}

wisp_status binding_recorder_close( binding_recorder* r, wisp_error* error )
{
    const wisp_status status = r ? run_recorder_close( r->recorder, error ) : WISP_OK;
    free( r );
    return status;
}

// ---- reading ----

struct binding_recording
{
    wisp_recording* recording;
    wisp_recording_info info;
    wisp_vec3** points; // [body_count][vertex_count] of the last frame that was read
    double time;
    uint64_t hash;
};

void binding_recording_close( binding_recording* r )
{
    if ( !r )
    {
        return;
    }
    for ( int i = 0; r->points && i < r->info.body_count; ++i )
    {
        free( r->points[i] );
    }
    free( r->points );
    wisp_recording_close( r->recording );
    free( r );
}

static bool reserve( binding_recording* r )
{
    r->points = calloc( (size_t)r->info.body_count, sizeof *r->points );
    bool is_there = r->points != NULL;
    for ( int i = 0; is_there && i < r->info.body_count; ++i )
    {
        const wisp_record_body* body = wisp_recording_body( r->recording, i );
        r->points[i] = calloc( (size_t)body->vertex_count, sizeof **r->points );
        is_there = r->points[i] != NULL;
    }
    return is_there;
}

// A recording that was opened becomes part of the handle, or is closed.
static wisp_status wrap( wisp_recording* recording, const char* name, binding_recording** out, wisp_error* error )
{
    binding_recording* r = calloc( 1, sizeof *r );
    if ( !r )
    {
        wisp_recording_close( recording );
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for the recording", name );
    }
    r->recording = recording;
    r->info = wisp_recording_describe( recording );
    // Without a frame nothing confirms how many vertices there are.
    const wisp_status status =
        r->info.frame_count == 0 ? wisp_fail( error, WISP_BAD_INPUT, "%s: the recording has no whole frame", name )
        : !reserve( r )          ? wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for a frame", name )
                                 : WISP_OK;
    if ( status != WISP_OK )
    {
        binding_recording_close( r );
        return status;
    }
    *out = r;
    return WISP_OK;
}

wisp_status binding_recording_open( const char* path, binding_recording** out, wisp_error* error )
{
    *out = NULL;
    wisp_recording* recording = NULL;
    const wisp_status status = wisp_recording_open( path, &recording, error );
    return status == WISP_OK ? wrap( recording, path, out, error ) : status;
}

wisp_status binding_recording_open_memory( const void* bytes, size_t size, const char* name, binding_recording** out,
                                           wisp_error* error )
{
    *out = NULL;
    wisp_recording* recording = NULL;
    const wisp_status status = wisp_recording_open_memory( bytes, size, name, &recording, error );
    return status == WISP_OK ? wrap( recording, name, out, error ) : status;
}

int binding_recording_frames( const binding_recording* r )
{
    return r->info.frame_count;
}

bool binding_recording_is_complete( const binding_recording* r )
{
    return r->info.complete;
}

double binding_recording_dt( const binding_recording* r )
{
    return r->info.dt;
}

wisp_status binding_recording_seek( binding_recording* r, int frame, wisp_error* error )
{
    return wisp_recording_frame( r->recording, frame, r->points, &r->time, &r->hash, error );
}

double binding_recording_time( const binding_recording* r )
{
    return r->time;
}

uint64_t binding_recording_hash( const binding_recording* r )
{
    return r->hash;
}

int binding_recording_bodies( const binding_recording* r )
{
    return r->info.body_count;
}

const char* binding_recording_name( const binding_recording* r, int body )
{
    return wisp_recording_body( r->recording, body )->name;
}

int binding_recording_vertices( const binding_recording* r, int body )
{
    return wisp_recording_body( r->recording, body )->vertex_count;
}

const int32_t* binding_recording_triangles( const binding_recording* r, int body )
{
    return wisp_recording_body( r->recording, body )->triangles;
}

bool binding_recording_tears( const binding_recording* r, int body )
{
    return wisp_recording_body( r->recording, body )->triangles_change;
}

int binding_recording_triangle_count( const binding_recording* r, int body )
{
    return wisp_recording_body( r->recording, body )->triangle_count;
}

const int32_t* binding_recording_offsets( const binding_recording* r, int body )
{
    return wisp_recording_body( r->recording, body )->offsets;
}

int binding_recording_strands( const binding_recording* r, int body )
{
    return wisp_recording_body( r->recording, body )->strand_count;
}

const float* binding_recording_points( const binding_recording* r, int body )
{
    return &r->points[body]->x;
}
