#include "suite_motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// The body of a recording whose only vertex holds kinetic and potential energy. Files are one whole with it.
static const char ENERGIES[] = "energies_of_the_run";

// Two times are one if they differ by less than this part of a step.
static const double SAME_TIME = 1e-3;

int suite_motion_points( const suite_motion* motion )
{
    return motion->body_count > 0 ? motion->first[motion->body_count] : 0;
}

void suite_motion_release( suite_motion* motion )
{
    for ( int i = 0; i < motion->body_count; ++i )
    {
        free( (void*)(uintptr_t)motion->bodies[i].name );
        free( (void*)(uintptr_t)motion->bodies[i].triangles );
        free( (void*)(uintptr_t)motion->bodies[i].offsets );
    }
    free( motion->bodies );
    free( motion->first );
    free( motion->start );
    free( motion->points );
    free( motion->times );
    free( motion->energies );
    *motion = ( suite_motion ){ 0 };
}

// ---- when ----

// How a row divides time into steps.
typedef struct row_steps
{
    wisp_scene scene;
    int count;
    double seconds; // of all of them
} row_steps;

static wisp_status steps_of( const suite_row* row, row_steps* out, wisp_error* error )
{
    const wisp_status status = suite_scene( row, &out->scene, error );
    if ( status == WISP_OK )
    {
        out->count = row->steps > 0 ? row->steps : out->scene.steps;
        out->seconds = wisp_scene_step_time( &out->scene, out->count );
    }
    return status;
}

// The ends of some steps, evenly, up to a time.
static void spread( const row_steps* row, double end, suite_times* out )
{
    int steps = row->count;
    while ( steps > 0 && wisp_scene_step_time( &row->scene, steps ) > end + SAME_TIME * (double)row->scene.dt )
    {
        --steps;
    }
    int stride = ( steps + SUITE_MAX_FRAMES - 2 ) / ( SUITE_MAX_FRAMES - 1 );
    // multiples of a divisor of the first moment meet it and the later ones, which are its multiples
    const double moment = suite_moments[0], dt = (double)row->scene.dt;
    const int until = (int)lround( moment / dt );
    if ( until >= stride && until <= steps &&
         fabs( wisp_scene_step_time( &row->scene, until ) - moment ) <= SAME_TIME * dt )
    {
        while ( until % stride != 0 )
        {
            ++stride;
        }
    }
    out->count = 0;
    for ( int step = stride; stride > 0 && step <= steps; step += stride )
    {
        out->at[out->count++] = wisp_scene_step_time( &row->scene, step );
    }
}

wisp_status suite_choose_times( const wisp_suite* suite, suite_times* out, wisp_error* error )
{
    double end = INFINITY;
    row_steps longest = { .count = 0 };
    const char *longest_name = "", *first_to_end = "";
    wisp_status status = WISP_OK;
    for ( int i = -1; i < suite->row_count && status == WISP_OK; ++i )
    {
        row_steps next = { .count = 0 };
        const suite_row* row = i < 0 ? &suite->reference : suite->rows + i;
        status = row->text ? steps_of( row, &next, error ) : WISP_OK;
        if ( status != WISP_OK || next.count == 0 )
        {
            wisp_scene_release( &next.scene );
            continue;
        }
        const char* name = i < 0 ? "the reference" : row->name;
        first_to_end = next.seconds < end ? name : first_to_end;
        end = fmin( end, next.seconds );
        const bool is_longer = longest.count == 0 || next.seconds / next.count > longest.seconds / longest.count;
        wisp_scene_release( is_longer ? &longest.scene : &next.scene );
        longest = is_longer ? next : longest;
        longest_name = is_longer ? name : longest_name;
    }
    spread( &longest, end, out );
    wisp_scene_release( &longest.scene );
    if ( status == WISP_OK && longest.count > 0 && out->count == 0 )
    {
        status = wisp_fail( error, WISP_BAD_INPUT,
                            "no moment is common to all rows: %s ends after %g s, and %s makes steps of %g s",
                            first_to_end, end, longest_name, longest.seconds / longest.count );
    }
    return status;
}

// ---- bodies ----

static void* copy_of( const void* from, size_t size )
{
    void* to = from ? malloc( size ) : NULL;
    return to ? memcpy( to, from, size ) : NULL;
}

// Copy the description of a body.
static wisp_status add_body( suite_motion* motion, const wisp_record_body* from, wisp_error* error )
{
    wisp_record_body* to = &motion->bodies[motion->body_count];
    *to = *from;
    to->name = copy_of( from->name, strlen( from->name ) + 1 );
    to->triangles = copy_of( from->triangles, 3 * (size_t)from->triangle_count * sizeof *from->triangles );
    to->offsets = copy_of( from->offsets, ( (size_t)from->strand_count + 1 ) * sizeof *from->offsets );
    motion->first[motion->body_count + 1] = motion->first[motion->body_count] + from->vertex_count;
    ++motion->body_count;
    const bool has_all = to->name && ( to->triangles || !from->triangles ) && ( to->offsets || !from->offsets );
    return has_all ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for the bodies of a motion" );
}

static wisp_status reserve_bodies( suite_motion* motion, int count, wisp_error* error )
{
    motion->bodies = calloc( (size_t)count + 1, sizeof *motion->bodies );
    motion->first = calloc( (size_t)count + 1, sizeof *motion->first );
    return motion->bodies && motion->first
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "no memory for the bodies of a motion" );
}

// @return where the points of the next frame go; null without memory
static wisp_vec3* add_frame( suite_motion* motion, double time )
{
    const size_t n = (size_t)suite_motion_points( motion );
    if ( motion->frame_count == motion->frame_capacity )
    {
        const int capacity = motion->frame_capacity > 0 ? 2 * motion->frame_capacity : 8;
        wisp_vec3* points = realloc( motion->points, ( (size_t)capacity * n + 1 ) * sizeof *points );
        motion->points = points ? points : motion->points;
        double* times = realloc( motion->times, (size_t)capacity * sizeof *times );
        motion->times = times ? times : motion->times;
        wisp_vec3* energies = realloc( motion->energies, (size_t)capacity * sizeof *energies );
        motion->energies = energies ? energies : motion->energies;
        if ( points == NULL || times == NULL || energies == NULL )
        {
            return NULL;
        }
        motion->frame_capacity = capacity;
    }
    motion->times[motion->frame_count] = time;
    motion->energies[motion->frame_count] = ( wisp_vec3 ){ NAN, NAN, 0.0f };
    return motion->points + n * (size_t)motion->frame_count++;
}

// ---- a run ----

typedef struct frame_recorder
{
    suite_motion* motion;
    const suite_times* times;
    const suite_observer* also; // null: nobody
} frame_recorder;

static wisp_status begin( suite_motion* motion, const scene_world* world, wisp_error* error )
{
    const int count = scene_world_moving_count( world );
    wisp_status status = reserve_bodies( motion, count, error );
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        const scene_body body = scene_world_body( world, i );
        const wisp_record_body copied = {
            .name = body.name,
            .triangles = body.triangles,
            .offsets = body.offsets,
            .vertex_count = body.vertex_count,
            .triangle_count = body.triangle_count,
            .strand_count = body.strand_count,
        };
        status = add_body( motion, &copied, error );
    }
    motion->start = calloc( (size_t)suite_motion_points( motion ) + 1, sizeof *motion->start );
    for ( int i = 0; i < count && status == WISP_OK && motion->start; ++i )
    {
        status = scene_world_points( world, i, motion->start + motion->first[i], error );
    }
    return motion->start ? status : wisp_fail( error, WISP_NO_MEMORY, "no memory for the start of a motion" );
}

static wisp_vec3 energies_of( const scene_world* world )
{
    double kinetic = 0.0, potential = 0.0;
    for ( int body = 0; body < scene_world_moving_count( world ); ++body )
    {
        wisp_motion_stats stats;
        if ( scene_world_motion_stats( world, body, &stats, NULL ) == WISP_OK )
        {
            kinetic += stats.kinetic_energy;
            potential += stats.potential_energy;
        }
    }
    return ( wisp_vec3 ){ (float)kinetic, (float)potential, 0.0f };
}

static wisp_status keep_frame( suite_motion* motion, const scene_world* world, double time, wisp_error* error )
{
    wisp_vec3* points = add_frame( motion, time );
    if ( points == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the frames of a motion" );
    }
    motion->energies[motion->frame_count - 1] = energies_of( world );
    wisp_status status = WISP_OK;
    for ( int i = 0; i < motion->body_count && status == WISP_OK; ++i )
    {
        status = scene_world_points( world, i, points + motion->first[i], error );
    }
    return status;
}

static wisp_status observe( void* user, const scene_world* world, wisp_error* error )
{
    frame_recorder* r = user;
    const wisp_status status = r->also ? r->also->observe( r->also->user, world, error ) : WISP_OK;
    if ( world->next_step == 0 || status != WISP_OK )
    {
        return status == WISP_OK ? begin( r->motion, world, error ) : status;
    }
    const double time = scene_world_time( world ), near = SAME_TIME * (double)world->scene->dt;
    const int next = r->motion->frame_count;
    return next < r->times->count && fabs( r->times->at[next] - time ) <= near
               ? keep_frame( r->motion, world, r->times->at[next], error )
               : WISP_OK;
}

wisp_status suite_motion_run( const suite_row* row, const char* isa, const suite_times* times,
                              const suite_observer* also, suite_motion* out, suite_measurement* measured,
                              wisp_error* error )
{
    *out = ( suite_motion ){ 0 };
    frame_recorder r = { .motion = out, .times = times, .also = also };
    const suite_observer observer = { observe, &r, also && also->requests_contact };
    const wisp_status status = suite_run_row( row, isa, &observer, measured, error );
    if ( status == WISP_OK && out->frame_count < times->count )
    {
        return wisp_fail(
            error, WISP_BAD_INPUT,
            "%s%s%s: no step ends at %.6g s, where motions are compared; the longest step of a suite must be a "
            "multiple of all others",
            row->name, row->variant[0] ? ", " : "", row->variant, times->at[out->frame_count] );
    }
    return status;
}

// ---- extrapolation ----

static void extrapolate_points( wisp_vec3* points, const wisp_vec3* coarser, size_t count, double part )
{
    for ( size_t i = 0; i < count; ++i )
    {
        const wisp_vec3 p = points[i], q = coarser[i];
        points[i].x = (float)( (double)p.x + part * ( (double)p.x - (double)q.x ) );
        points[i].y = (float)( (double)p.y + part * ( (double)p.y - (double)q.y ) );
        points[i].z = (float)( (double)p.z + part * ( (double)p.z - (double)q.z ) );
    }
}

wisp_status suite_motion_extrapolate( suite_motion* motion, const suite_motion* coarser, double part,
                                      wisp_error* error )
{
    const int n = suite_motion_points( motion );
    if ( suite_motion_points( coarser ) != n || coarser->frame_count != motion->frame_count )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "extrapolation: got motions of %d and %d vertices, expected the same", n,
                          suite_motion_points( coarser ) );
    }
    const size_t frames = (size_t)motion->frame_count;
    extrapolate_points( motion->points, coarser->points, (size_t)n * frames, part );
    extrapolate_points( motion->energies, coarser->energies, frames, part );
    return WISP_OK;
}

// ---- recordings ----

static wisp_status read_frames( wisp_recording* recording, const char* path, const suite_times* times,
                                suite_motion* out, wisp_error* error )
{
    const wisp_recording_info info = wisp_recording_describe( recording );
    // a file of our own has energies in its last body
    wisp_vec3 unused, **places = calloc( (size_t)info.body_count, sizeof *places );
    wisp_status status =
        places ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for the frames of a motion" );
    for ( int frame = 0; frame < info.frame_count && out->frame_count < times->count && status == WISP_OK; ++frame )
    {
        double time = 0.0;
        status = wisp_recording_frame( recording, frame, NULL, &time, NULL, error );
        const double wanted = times->at[out->frame_count], near = SAME_TIME * info.dt;
        if ( status != WISP_OK || ( frame > 0 && time < wanted - near ) || time > wanted + near )
        {
            continue;
        }
        wisp_vec3* points = frame == 0 ? out->start : add_frame( out, wanted );
        for ( int i = 0; i < out->body_count && points; ++i )
        {
            places[i] = points + out->first[i];
        }
        if ( places && out->body_count < info.body_count )
        {
            places[out->body_count] = frame == 0 || points == NULL ? &unused : &out->energies[out->frame_count - 1];
        }
        status = points ? wisp_recording_frame( recording, frame, places, NULL, NULL, error )
                        : wisp_fail( error, WISP_NO_MEMORY, "no memory for the frames of a motion" );
    }
    free( places );
    return status != WISP_OK || out->frame_count == times->count
               ? status
               : wisp_fail( error, WISP_BAD_INPUT,
                            "%s: the recording has no frame at %.6g s, where motions are compared", path,
                            times->at[out->frame_count] );
}

wisp_status suite_motion_read( const char* path, const suite_times* times, suite_motion* out, wisp_error* error )
{
    *out = ( suite_motion ){ 0 };
    wisp_recording* recording = NULL;
    wisp_status status = wisp_recording_open( path, &recording, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const wisp_recording_info info = wisp_recording_describe( recording );
    status = info.frame_count > 0 ? reserve_bodies( out, info.body_count, error )
                                  : wisp_fail( error, WISP_BAD_INPUT, "%s: the recording has no frame", path );
    for ( int i = 0; i < info.body_count && status == WISP_OK; ++i )
    {
        const wisp_record_body* body = wisp_recording_body( recording, i );
        const bool is_energies =
            i > 0 && i == info.body_count - 1 && body->vertex_count == 1 && strcmp( body->name, ENERGIES ) == 0;
        status = is_energies ? WISP_OK : add_body( out, body, error );
    }
    out->start = status == WISP_OK ? calloc( (size_t)suite_motion_points( out ) + 1, sizeof *out->start ) : NULL;
    if ( status == WISP_OK )
    {
        status = out->start ? read_frames( recording, path, times, out, error )
                            : wisp_fail( error, WISP_NO_MEMORY, "no memory for the start of a motion" );
    }
    wisp_recording_close( recording );
    return status;
}

static wisp_status write_frame( const suite_motion* motion, const wisp_vec3* points, const wisp_vec3* energies,
                                double time, wisp_recorder* recorder, const wisp_vec3** places, wisp_error* error )
{
    for ( int i = 0; i < motion->body_count; ++i )
    {
        places[i] = points + motion->first[i];
    }
    places[motion->body_count] = energies;
    return wisp_recorder_frame( recorder, time, 0, places, error );
}

static wisp_status write_frames( const suite_motion* motion, wisp_recorder* recorder, const wisp_vec3** places,
                                 wisp_error* error )
{
    const size_t n = (size_t)suite_motion_points( motion );
    const wisp_vec3 none = { 0.0f, 0.0f, 0.0f };
    wisp_status status = write_frame( motion, motion->start, &none, 0.0, recorder, places, error );
    for ( int i = 0; i < motion->frame_count && status == WISP_OK; ++i )
    {
        status = write_frame( motion, motion->points + (size_t)i * n, motion->energies + i, motion->times[i],
                              recorder, places, error );
    }
    return status;
}

wisp_status suite_motion_write( const suite_motion* motion, const char* path, wisp_error* error )
{
    const size_t count = (size_t)motion->body_count + 1;
    wisp_recorder* recorder = NULL;
    wisp_record_body* bodies = calloc( count, sizeof *bodies );
    const wisp_vec3** places = calloc( count, sizeof *places );
    wisp_status status = bodies && places ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for a recording" );
    if ( status == WISP_OK )
    {
        memcpy( bodies, motion->bodies, (size_t)motion->body_count * sizeof *bodies );
        bodies[motion->body_count] = ( wisp_record_body ){ .name = ENERGIES, .vertex_count = 1 };
        const wisp_recorder_def def = { .bodies = bodies, .body_count = (int)count, .dt = motion->times[0] };
        status = wisp_recorder_open( path, WISP_RECORD_WISP, &def, &recorder, error );
        status = status == WISP_OK ? write_frames( motion, recorder, places, error ) : status;
    }
    const wisp_status closed = wisp_recorder_close( recorder, status == WISP_OK ? error : NULL );
    free( places );
    free( bodies );
    return status == WISP_OK ? closed : status;
}
