#include "run_recorder.h"

#include "nearest.h"
#include "run_between.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct run_recorder
{
    scene_world* world;
    int every;
    int frames_per_step;     ///< 1 unless every step is recorded
    run_between* between;    ///< null: one frame per step
    double last_time;        ///< s, of the last frame that is a step
    wisp_recorder* recorder; ///< or null
    wisp_recorder* track;    ///< or null

    run_bodies bodies;

    const char* proof_name;
    wisp_recording* proof;    ///< the recording to compare, or null
    int proof_every;          ///< steps between its frames
    int proof_frames;         ///<
    wisp_vec3** proof_points; ///< [bodies.count] recorded positions

    int written, verified;
};

static wisp_status no_memory( const run_recorder* r, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its recording", r->world->scene->name );
}

// ---- writing ----

static wisp_recorder_def def_of( const run_recorder* r, const run_recorder_def* def )
{
    return ( wisp_recorder_def ){
        .bodies = r->bodies.list,
        .body_count = r->bodies.count,
        .dt = def->every * (double)r->world->scene->dt / r->frames_per_step,
        .frame_count = def->steps / def->every * r->frames_per_step + 1,
    };
}

static int find_body( const run_recorder* r, const run_track* track )
{
    for ( int i = 0; i < r->bodies.count; ++i )
    {
        const char* name = r->bodies.list[i].name;
        if ( strlen( name ) == (size_t)track->name_length && memcmp( name, track->name, strlen( name ) ) == 0 )
        {
            return i;
        }
    }
    return -1;
}

static wisp_status refuse_name( const run_recorder* r, const run_track* track, wisp_error* error )
{
    char word[2 * WISP_RECORD_MAX_NAME];
    snprintf( word, sizeof( word ), "%.*s", track->name_length, track->name );
    const char** names = calloc( (size_t)r->bodies.count + 1, sizeof *names );
    for ( int i = 0; names && i < r->bodies.count; ++i )
    {
        names[i] = r->bodies.list[i].name;
    }
    const char* nearest = names ? nearest_word( word, names, r->bodies.count ) : NULL;
    free( names );
    return nearest ? wisp_fail( error, WISP_BAD_INPUT, "--track: %s has no body '%s'; did you mean '%s'?",
                                r->world->scene->name, word, nearest )
                   : wisp_fail( error, WISP_BAD_INPUT, "--track: %s has no body '%s'", r->world->scene->name, word );
}

static wisp_status find_tracks( const run_recorder* r, const run_recorder_def* def, wisp_track_point* points,
                                wisp_error* error )
{
    for ( int i = 0; i < def->track_count; ++i )
    {
        const run_track* track = &def->tracks[i];
        int body = find_body( r, track );
        if ( body < 0 )
        {
            return refuse_name( r, track, error );
        }
        if ( track->vertex >= r->bodies.list[body].vertex_count )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "--track: %s: got vertex %d, expected 0 to %d",
                              r->bodies.list[body].name, track->vertex, r->bodies.list[body].vertex_count - 1 );
        }
        points[i] = ( wisp_track_point ){ body, track->vertex };
    }
    return WISP_OK;
}

static wisp_status open_track( run_recorder* r, const run_recorder_def* def, wisp_error* error )
{
    wisp_track_point points[RUN_TRACKS_MAX];
    wisp_status status = find_tracks( r, def, points, error );
    wisp_recorder_def recorder = def_of( r, def );
    recorder.tracks = points;
    recorder.track_count = def->track_count;
    return status == WISP_OK ? wisp_recorder_open( def->track_file, WISP_RECORD_TRACKS, &recorder, &r->track, error )
                             : status;
}

// ---- comparison ----

static bool same_numbers( const int32_t* a, const int32_t* b, size_t count )
{
    return count == 0 || ( a && b && memcmp( a, b, count * sizeof *a ) == 0 );
}

static bool same_body( const wisp_record_body* a, const wisp_record_body* b )
{
    return strcmp( a->name, b->name ) == 0 && a->vertex_count == b->vertex_count &&
           a->triangle_count == b->triangle_count && a->strand_count == b->strand_count &&
           a->triangles_change == b->triangles_change &&
           same_numbers( a->triangles, b->triangles, 3 * (size_t)a->triangle_count ) &&
           same_numbers( a->offsets, b->offsets, a->strand_count > 0 ? (size_t)a->strand_count + 1 : 0 );
}

// A run that compares less than the recording, or more than it has, proves nothing about the rest.
static wisp_status check_length( const run_recorder* r, const run_recorder_def* def, wisp_error* error )
{
    const int frames = def->steps / r->proof_every + 1;
    if ( frames == r->proof_frames || ( def->is_part && frames < r->proof_frames ) )
    {
        return WISP_OK;
    }
    return wisp_fail( error, WISP_BAD_INPUT, "%s: got %d frames, expected %d, since the run has %d steps%s",
                      r->proof_name, r->proof_frames, frames, def->steps,
                      frames < r->proof_frames ? "; --steps compares the first ones" : "" );
}

static wisp_status check_proof( run_recorder* r, const run_recorder_def* def, wisp_error* error )
{
    wisp_recording_info info = wisp_recording_describe( r->proof );
    const wisp_scene* scene = r->world->scene;
    if ( info.frame_count < 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got no complete frame, expected at least one", r->proof_name );
    }
    if ( !info.complete )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the recording is cut: it has no end after frame %d",
                          r->proof_name, info.frame_count - 1 );
    }
    if ( info.body_count != r->bodies.count )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %d bodies, but %s has %d", r->proof_name, info.body_count,
                          scene->name, r->bodies.count );
    }
    for ( int i = 0; i < r->bodies.count; ++i )
    {
        if ( !same_body( &r->bodies.list[i], wisp_recording_body( r->proof, i ) ) )
        {
            return wisp_fail(
                error, WISP_BAD_INPUT,
                "%s: body %d differs in its name or in its number of vertices, triangles or strands from %s of %s",
                r->proof_name, i, r->bodies.list[i].name, scene->name );
        }
    }
    double steps = info.dt / (double)scene->dt;
    r->proof_every = steps >= 1.0 && steps <= 1e9 ? (int)lround( steps ) : 0;
    r->proof_frames = info.frame_count;
    // The recorder multiplied by the number of steps, which is exact enough to be compared with a small tolerance.
    return fabs( steps - r->proof_every ) <= 1e-6 * steps
               ? check_length( r, def, error )
               : wisp_fail( error, WISP_BAD_INPUT,
                            "%s: got frames %g s apart, expected a multiple of the step of %g s", r->proof_name,
                            info.dt, (double)scene->dt );
}

static wisp_status open_proof( run_recorder* r, const run_recorder_def* def, wisp_error* error )
{
    r->proof_name = def->verify;
    wisp_status status = wisp_recording_open( def->verify, &r->proof, error );
    if ( status == WISP_OK )
    {
        status = check_proof( r, def, error );
    }
    // Only now: a recording that matches the scene does not need more memory than the scene.
    r->proof_points = status == WISP_OK ? run_bodies_make_points( &r->bodies ) : NULL;
    return status != WISP_OK ? status : r->proof_points ? WISP_OK : no_memory( r, error );
}

static wisp_status compare_body( const run_recorder* r, int body, int frame, double time, wisp_error* error )
{
    const wisp_vec3 *now = r->bodies.points[body], *then = r->proof_points[body];
    for ( int v = 0; v < r->bodies.list[body].vertex_count; ++v )
    {
        if ( memcmp( &now[v], &then[v], sizeof now[v] ) != 0 )
        {
            return wisp_fail( error, WISP_CONFLICT,
                              "%s: frame %d at %g s: %s differs at vertex %d: got (%.9g, %.9g, %.9g), expected "
                              "(%.9g, %.9g, %.9g)",
                              r->proof_name, frame, time, r->bodies.list[body].name, v, (double)now[v].x,
                              (double)now[v].y, (double)now[v].z, (double)then[v].x, (double)then[v].y,
                              (double)then[v].z );
        }
    }
    const wisp_record_body* list = r->bodies.list;
    const int32_t* corners = wisp_recording_body( r->proof, body )->triangles;
    for ( int t = 0; list[body].triangles_change && t < list[body].triangle_count; ++t )
    {
        if ( same_numbers( list[body].triangles + 3 * (size_t)t, corners + 3 * (size_t)t, 3 ) == false )
        {
            return wisp_fail(
                error, WISP_CONFLICT,
                "%s: frame %d at %g s: the vertices of triangle %d of %s differ: one was torn, the other not",
                r->proof_name, frame, time, t, list[body].name );
        }
    }
    return WISP_OK;
}

static wisp_status compare( run_recorder* r, int frame, uint64_t hash, wisp_error* error )
{
    double time = 0.0;
    uint64_t old_hash = 0;
    wisp_status status = wisp_recording_frame( r->proof, frame, r->proof_points, &time, &old_hash, error );
    for ( int i = 0; i < r->bodies.count && status == WISP_OK; ++i )
    {
        status = compare_body( r, i, frame, time, error );
    }
    if ( status == WISP_OK && old_hash != 0 && old_hash != hash )
    {
        status = wisp_fail(
            error, WISP_CONFLICT,
            "%s: frame %d at %g s: all points are equal, but the world differs: got hash %016llx, expected "
            "%016llx",
            r->proof_name, frame, time, (unsigned long long)hash, (unsigned long long)old_hash );
    }
    r->verified += status == WISP_OK;
    return status;
}

// ---- whole recorder ----

static wisp_status open_all( run_recorder* r, const run_recorder_def* def, wisp_error* error )
{
    const bool has_values = def->record && wisp_record_has_values( def->record );
    wisp_status status = run_bodies_open( r->world, has_values, def->values, &r->bodies, error );
    if ( status == WISP_OK && r->frames_per_step > 1 )
    {
        r->between = run_between_open( &r->bodies, r->world );
        status = r->between ? WISP_OK : no_memory( r, error );
    }
    // Read-only steps come first, so that a rejection leaves no file behind.
    if ( status == WISP_OK && def->verify )
    {
        status = open_proof( r, def, error );
    }
    if ( status == WISP_OK && def->track_count > 0 )
    {
        status = open_track( r, def, error );
    }
    if ( status == WISP_OK && def->record )
    {
        const wisp_recorder_def recorder = def_of( r, def );
        status = wisp_recorder_open( def->record, WISP_RECORD_BY_NAME, &recorder, &r->recorder, error );
    }
    return status;
}

wisp_status run_recorder_open( const run_recorder_def* def, scene_world* world, run_recorder** out,
                               wisp_error* error )
{
    *out = NULL;
    if ( !def->record && def->track_count == 0 && !def->verify )
    {
        return WISP_OK;
    }
    run_recorder* r = calloc( 1, sizeof *r );
    if ( !r )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "run: out of memory for a recording" );
    }
    r->world = world;
    r->every = def->every;
    // a run that leaves steps out, or writes nothing, has no frames between steps
    const bool is_dense = def->every == 1 && ( def->record || def->track_count > 0 );
    r->frames_per_step = is_dense && world->scene->frames_per_step > 1 ? world->scene->frames_per_step : 1;
    wisp_status status = open_all( r, def, error );
    if ( status != WISP_OK )
    {
        wisp_error later = { 0 };
        run_recorder_close( r, &later );
        return status;
    }
    *out = r;
    return WISP_OK;
}

static wisp_status write_points( run_recorder* r, double time, uint64_t hash, const wisp_vec3* const* points,
                                 wisp_error* error )
{
    wisp_status status = WISP_OK;
    if ( r->recorder )
    {
        status = wisp_recorder_frame( r->recorder, time, hash, points, error );
    }
    if ( status == WISP_OK && r->track )
    {
        status = wisp_recorder_frame( r->track, time, hash, points, error );
    }
    r->written += status == WISP_OK;
    return status;
}

// Frames between the step before and this one have no hash, because no world was ever in their state.
static wisp_status write_between( run_recorder* r, double time, wisp_error* error )
{
    wisp_status status = run_between_note( r->between, error );
    for ( int k = 1; k < r->frames_per_step && r->world->next_step > 0 && status == WISP_OK; ++k )
    {
        const double fraction = (double)k / r->frames_per_step;
        const wisp_vec3* const* points = NULL;
        status = run_between_at( r->between, (float)fraction, &points, error );
        status = status == WISP_OK
                     ? write_points( r, r->last_time + fraction * ( time - r->last_time ), 0, points, error )
                     : status;
    }
    return status;
}

static wisp_status write_frame( run_recorder* r, uint64_t hash, wisp_error* error )
{
    const double time = scene_world_time( r->world );
    wisp_status status = r->between ? write_between( r, time, error ) : WISP_OK;
    r->last_time = time;
    return status == WISP_OK ? write_points( r, time, hash, (const wisp_vec3* const*)r->bodies.points, error )
                             : status;
}

wisp_status run_recorder_step( run_recorder* r, wisp_error* error )
{
    if ( !r )
    {
        return WISP_OK;
    }
    int step = r->world->next_step;
    bool is_written = ( r->recorder || r->track ) && step % r->every == 0;
    bool is_compared = r->proof && step % r->proof_every == 0 && step / r->proof_every < r->proof_frames;
    wisp_status status = WISP_OK;
    if ( is_written || is_compared )
    {
        status = run_bodies_load( &r->bodies, r->world, is_written, error );
    }
    uint64_t hash = is_written || is_compared ? wisp_world_hash( r->world->world ) : 0;
    if ( status == WISP_OK && is_written )
    {
        status = write_frame( r, hash, error );
    }
    return status == WISP_OK && is_compared ? compare( r, step / r->proof_every, hash, error ) : status;
}

run_recorder_counts run_recorder_count( const run_recorder* r )
{
    return r ? ( run_recorder_counts ){ r->written, r->verified, r->proof_frames - r->verified }
             : ( run_recorder_counts ){ 0 };
}

wisp_status run_recorder_close( run_recorder* r, wisp_error* error )
{
    if ( !r )
    {
        return WISP_OK;
    }
    wisp_status status = wisp_recorder_close( r->recorder, error );
    wisp_error later = { 0 };
    wisp_status track = wisp_recorder_close( r->track, status == WISP_OK ? error : &later );
    wisp_recording_close( r->proof );
    run_bodies_free_points( &r->bodies, r->proof_points );
    run_between_close( r->between );
    run_bodies_release( &r->bodies );
    free( r );
    return status == WISP_OK ? track : status;
}
