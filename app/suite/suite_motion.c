#include "suite_motion.h"

#include "suite_compare.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// The body of a recording whose only vertex holds kinetic and potential energy. Files are one whole with it.
static const char ENERGIES[] = "energies_of_the_run";

// Two times are one if they differ by less than this part of a step.
static const double SAME_TIME = 1e-3;

int suite_motion_points( const suite_motion* motion )
{
    return motion->body_count > 0 ? motion->first[motion->body_count] : 0;
}

static void release_motion( suite_motion* motion )
{
    io_release( &motion->memory );
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
    WISP_TRY( suite_scene( row, &out->scene, error ) );
    out->count = out->scene.steps;
    out->seconds = wisp_scene_step_time( &out->scene, out->count );
    return WISP_OK;
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

// @return WISP_BAD_INPUT a row is no scene
static wisp_status choose_times( const suite_references* references, int number, suite_reference* out,
                                 wisp_error* error )
{
    const wisp_suite* suite = references->suite;
    double end = INFINITY;
    row_steps longest = { .count = 0 };
    const char *longest_name = "", *first_to_end = "";
    wisp_status status = WISP_OK;
    for ( int i = -1; i < suite->row_count && status == WISP_OK; ++i )
    {
        row_steps next = { .count = 0 };
        const suite_row* row = i >= 0                       ? suite->rows + i
                               : suite->reference_count > 0 ? &suite->references[number].fine
                                                            : NULL;
        const bool is_of = row != NULL && ( i < 0 || references->of_row[i] == number ) && !row->is_refused;
        status = is_of ? steps_of( row, &next, error ) : WISP_OK;
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
    spread( &longest, end, &out->times );
    out->gravity = longest.scene.gravity;
    wisp_scene_release( &longest.scene );
    if ( status == WISP_OK && longest.count > 0 && out->times.count == 0 )
    {
        status = wisp_fail( error, WISP_BAD_INPUT,
                            "no moment is common to all rows: %s ends after %g s, and %s makes steps of %g s",
                            first_to_end, end, longest_name, longest.seconds / longest.count );
    }
    return status;
}

// ---- bodies ----

// Copy the description of a body.
static void add_body( suite_motion* motion, const wisp_record_body* from )
{
    io_memory* memory = &motion->memory;
    wisp_record_body* to = &motion->bodies[motion->body_count];
    *to = *from;
    to->name = io_copy( memory, from->name, strlen( from->name ) + 1 );
    to->triangles = io_copy( memory, from->triangles, 3 * (size_t)from->triangle_count * sizeof *from->triangles );
    to->offsets = io_copy( memory, from->offsets, ( (size_t)from->strand_count + 1 ) * sizeof *from->offsets );
    motion->first[motion->body_count + 1] = motion->first[motion->body_count] + from->vertex_count;
    ++motion->body_count;
}

static wisp_status check_memory( const suite_motion* motion, wisp_error* error )
{
    return motion->memory.is_short ? wisp_fail( error, WISP_NO_MEMORY, "no memory for a motion" ) : WISP_OK;
}

static wisp_status reserve_bodies( suite_motion* motion, int count, wisp_error* error )
{
    motion->bodies = io_get( &motion->memory, ( (size_t)count + 1 ) * sizeof *motion->bodies );
    motion->first = io_get( &motion->memory, ( (size_t)count + 1 ) * sizeof *motion->first );
    return check_memory( motion, error );
}

// Of the bodies that have been added.
static wisp_status reserve_frames( suite_motion* motion, int frames, wisp_error* error )
{
    const size_t points = (size_t)suite_motion_points( motion ), count = (size_t)frames + 1;
    motion->start = io_get( &motion->memory, ( points + 1 ) * sizeof *motion->start );
    motion->points = io_get( &motion->memory, count * points * sizeof *motion->points );
    motion->times = io_get( &motion->memory, count * sizeof *motion->times );
    motion->energies = io_get( &motion->memory, count * sizeof *motion->energies );
    return check_memory( motion, error );
}

// @return where the points of the next frame go
static wisp_vec3* add_frame( suite_motion* motion, double time )
{
    motion->times[motion->frame_count] = time;
    motion->energies[motion->frame_count] = ( wisp_vec3 ){ NAN, NAN, 0.0f };
    return motion->points + (size_t)suite_motion_points( motion ) * (size_t)motion->frame_count++;
}

// ---- a run ----

typedef struct frame_recorder
{
    suite_motion* motion;
    const suite_times* times;
    const suite_observer* also; // null: nobody
} frame_recorder;

static wisp_status begin( suite_motion* motion, const scene_world* world, int frames, wisp_error* error )
{
    const int count = scene_world_moving_count( world );
    WISP_TRY( reserve_bodies( motion, count, error ) );
    for ( int i = 0; i < count; ++i )
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
        add_body( motion, &copied );
    }
    WISP_TRY( reserve_frames( motion, frames, error ) );
    for ( int i = 0; i < count; ++i )
    {
        WISP_TRY( scene_world_points( world, i, motion->start + motion->first[i], error ) );
    }
    return WISP_OK;
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
    motion->energies[motion->frame_count - 1] = energies_of( world );
    for ( int i = 0; i < motion->body_count; ++i )
    {
        WISP_TRY( scene_world_points( world, i, points + motion->first[i], error ) );
    }
    return WISP_OK;
}

static wisp_status observe( void* user, const scene_world* world, wisp_error* error )
{
    frame_recorder* r = user;
    WISP_TRY( r->also ? r->also->observe( r->also->user, world, error ) : WISP_OK );
    if ( world->next_step == 0 )
    {
        return begin( r->motion, world, r->times->count, error );
    }
    const double time = scene_world_time( world ), near = SAME_TIME * (double)world->scene->dt;
    const int next = r->motion->frame_count;
    return next < r->times->count && fabs( r->times->at[next] - time ) <= near
               ? keep_frame( r->motion, world, r->times->at[next], error )
               : WISP_OK;
}

// Run a row and keep its points at some times.
// @param also told of the run, too; may be null
// @param out to be released, after a failure too
// @return WISP_BAD_INPUT no step of the row ends at one of the times (the message names it)
static wisp_status run_motion( const suite_row* row, const char* isa, const suite_times* times,
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

// Move the points and energies of a motion away from those of a coarser one by a part of their difference.
// @return WISP_BAD_INPUT the motions have other bodies or frames
static wisp_status extrapolate_motion( suite_motion* motion, const suite_motion* coarser, double part,
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
    wisp_vec3 unused, **places = io_get( &out->memory, (size_t)info.body_count * sizeof *places );
    WISP_TRY( check_memory( out, error ) );
    for ( int frame = 0; frame < info.frame_count && out->frame_count < times->count; ++frame )
    {
        double time = 0.0;
        WISP_TRY( wisp_recording_frame( recording, frame, NULL, &time, NULL, error ) );
        const double wanted = times->at[out->frame_count], near = SAME_TIME * info.dt;
        if ( ( frame > 0 && time < wanted - near ) || time > wanted + near )
        {
            continue;
        }
        wisp_vec3* points = frame == 0 ? out->start : add_frame( out, wanted );
        for ( int i = 0; i < out->body_count; ++i )
        {
            places[i] = points + out->first[i];
        }
        if ( out->body_count < info.body_count )
        {
            places[out->body_count] = frame == 0 ? &unused : &out->energies[out->frame_count - 1];
        }
        WISP_TRY( wisp_recording_frame( recording, frame, places, NULL, NULL, error ) );
    }
    return out->frame_count == times->count
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT,
                            "%s: the recording has no frame at %.6g s, where motions are compared", path,
                            times->at[out->frame_count] );
}

static wisp_status read_bodies( wisp_recording* recording, const char* path, const suite_times* times,
                                suite_motion* out, wisp_error* error )
{
    const wisp_recording_info info = wisp_recording_describe( recording );
    WISP_TRY( info.frame_count > 0 ? reserve_bodies( out, info.body_count, error )
                                   : wisp_fail( error, WISP_BAD_INPUT, "%s: the recording has no frame", path ) );
    for ( int i = 0; i < info.body_count; ++i )
    {
        const wisp_record_body* body = wisp_recording_body( recording, i );
        if ( i == 0 || i < info.body_count - 1 || body->vertex_count != 1 || strcmp( body->name, ENERGIES ) != 0 )
        {
            add_body( out, body );
        }
    }
    WISP_TRY( reserve_frames( out, times->count, error ) );
    return read_frames( recording, path, times, out, error );
}

// Read a recording. @param out to be released, after a failure too
// @return WISP_BAD_INPUT it is none, or has no frame at one of the times; WISP_IO_ERROR; WISP_NO_MEMORY
static wisp_status read_motion( const char* path, const suite_times* times, suite_motion* out, wisp_error* error )
{
    *out = ( suite_motion ){ 0 };
    wisp_recording* recording = NULL;
    WISP_TRY( wisp_recording_open( path, &recording, error ) );
    const wisp_status status = read_bodies( recording, path, times, out, error );
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
    WISP_TRY( write_frame( motion, motion->start, &none, 0.0, recorder, places, error ) );
    for ( int i = 0; i < motion->frame_count; ++i )
    {
        WISP_TRY( write_frame( motion, motion->points + (size_t)i * n, motion->energies + i, motion->times[i],
                               recorder, places, error ) );
    }
    return WISP_OK;
}

static wisp_status write_motion( suite_motion* motion, const char* path, wisp_error* error )
{
    const size_t count = (size_t)motion->body_count + 1;
    wisp_recorder* recorder = NULL;
    wisp_record_body* bodies = io_get( &motion->memory, count * sizeof *bodies );
    const wisp_vec3** places = io_get( &motion->memory, count * sizeof *places );
    WISP_TRY( check_memory( motion, error ) );
    memcpy( bodies, motion->bodies, (size_t)motion->body_count * sizeof *bodies );
    bodies[motion->body_count] = ( wisp_record_body ){ .name = ENERGIES, .vertex_count = 1 };
    const wisp_recorder_def def = { .bodies = bodies, .body_count = (int)count, .dt = motion->times[0] };
    wisp_status status = wisp_recorder_open( path, WISP_RECORD_WISP, &def, &recorder, error );
    status = status == WISP_OK ? write_frames( motion, recorder, places, error ) : status;
    const wisp_status closed = wisp_recorder_close( recorder, status == WISP_OK ? error : NULL );
    return status == WISP_OK ? closed : status;
}

// ---- what errors are measured against ----

enum
{
    PATH_SIZE = 1024,
    CACHE_VERSION = 3, // of what a kept run depends on; one more where converged motions change
};

// Distance between two runs that should be one, as part of their size, at which their motion is chaotic.
static const double APART = 0.01;

// ---- the cache ----

// `$WISP_CACHE`, else `$XDG_CACHE_HOME/wisp`, else `$HOME/.cache/wisp`. @return false: none of them is set
static bool cache_folder( char* out, size_t size )
{
    const char *own = getenv( "WISP_CACHE" ), *xdg = getenv( "XDG_CACHE_HOME" ), *home = getenv( "HOME" );
    const int length = own && own[0]     ? snprintf( out, size, "%s", own )
                       : xdg && xdg[0]   ? snprintf( out, size, "%s/wisp", xdg )
                       : home && home[0] ? snprintf( out, size, "%s/.cache/wisp", home )
                                         : -1;
    return length > 0 && length < (int)size;
}

// Make a folder and those that it is in.
static bool make_folders( const char* path )
{
    char part[PATH_SIZE];
    snprintf( part, sizeof part, "%s", path );
    for ( char* slash = strchr( part + 1, '/' ); slash; slash = strchr( slash + 1, '/' ) )
    {
        *slash = '\0';
        (void)mkdir( part, 0777 );
        *slash = '/';
    }
    return io_folder_make( part, NULL ) == WISP_OK;
}

// What decides about the motion: the scene with its settings, the files that it reads, and when it is looked at.
static wisp_status hash_row( const suite_row* row, const suite_times* times, uint64_t* out, wisp_error* error )
{
    wisp_scene scene;
    scene_world world;
    const scene_world_options options = { .workers = 1, .is_quiet = true };
    const int version = CACHE_VERSION;
    WISP_TRY( suite_scene( row, &scene, error ) );
    *out = suite_hash_bytes( &version, sizeof version, SUITE_HASH_BEGIN );
    *out = suite_hash_bytes( row->text, strlen( row->text ), *out );
    *out = suite_hash_bytes( times->at, (size_t)times->count * sizeof *times->at, *out );
    wisp_status status = scene_world_create( &scene, &options, &world, error );
    if ( status == WISP_OK )
    {
        const uint64_t state = wisp_world_hash( world.world ); // with the defaults of the library
        *out = suite_hash_bytes( &state, sizeof state, *out );
        scene_world_destroy( &world );
    }
    wisp_scene_release( &scene );
    return status;
}

// Find a run in the cache, or make and keep it. A file of the cache that cannot be read is made again.
static wisp_status find_run( const suite_references* references, const suite_row* row, const suite_times* times,
                             suite_motion* out, wisp_error* error )
{
    char folder[PATH_SIZE], path[2 * PATH_SIZE];
    uint64_t hash = 0;
    WISP_TRY( hash_row( row, times, &hash, error ) );
    const bool keeps = cache_folder( folder, sizeof folder ) && make_folders( folder );
    snprintf( path, sizeof path, "%s/%016llx.wisp", folder, (unsigned long long)hash );
    struct stat found;
    if ( keeps && stat( path, &found ) == 0 )
    {
        if ( read_motion( path, times, out, NULL ) == WISP_OK )
        {
            return WISP_OK;
        }
        release_motion( out );
    }
    suite_measurement measured;
    wisp_status status = run_motion( row, NULL, times, references->observer, out, &measured, error );
    if ( status == WISP_OK && measured.values[SUITE_HALTED] > 0.0 )
    {
        return wisp_fail( error, WISP_CONFLICT,
                          "%s: the %s was halted, it cannot be what errors are measured against",
                          references->suite->name, row->name );
    }
    // a folder that is full or read-only costs time the next time, and nothing else
    if ( status == WISP_OK && keeps )
    {
        (void)write_motion( out, path, NULL );
    }
    return status;
}

// ---- both kinds ----

static wisp_status read_stored( const wisp_suite* suite, suite_reference* out, wisp_error* error )
{
    wisp_status status = read_motion( suite->stored, &out->times, &out->motion, error );
    out->frame_count = out->motion.frame_count;
    status = status == WISP_OK ? suite_compare( &out->motion, out, "the reference", &out->doubt, error ) : status;
    out->doubt.distance = suite->stored_doubt;
    return status;
}

// Two references that should be one part where motion is chaotic: what comes after that is not compared.
static void find_chaos( const suite_match* match, const suite_motion* coarser, suite_reference* out )
{
    const double most = APART * suite_motion_size( coarser );
    int frame = 0;
    while ( frame < coarser->frame_count && suite_distance( match, coarser, &out->motion, frame, 1, NULL ) <= most )
    {
        ++frame;
    }
    out->parts_at = frame < coarser->frame_count ? coarser->times[frame] : INFINITY;
    out->frame_count = frame > 0 ? frame : coarser->frame_count;
}

// Runs of order p that halve their substeps differ by 2^p - 1 times what the finer one lacks.
static wisp_status extrapolate( const suite_references* references, suite_motion* half, suite_reference* out,
                                wisp_error* error )
{
    const double part = 1.0 / ( pow( 2.0, references->suite->extrapolate ) - 1.0 );
    suite_motion quarter = { 0 };
    wisp_status status = find_run( references, &out->runs->coarsest, &out->times, &quarter, error );
    status = status == WISP_OK ? extrapolate_motion( &out->motion, half, part, error ) : status;
    status = status == WISP_OK ? extrapolate_motion( half, &quarter, part, error ) : status;
    release_motion( &quarter );
    return status;
}

static void describe( const wisp_suite* suite, char* out, size_t size )
{
    const char* set = suite->reference_count > 0 ? suite->references[0].fine.variant : "";
    if ( suite->compares_start || suite->stored )
    {
        snprintf( out, size, "%s%s", suite->compares_start ? "where every vertex starts" : "the stored motion ",
                  suite->stored ? io_short_name( suite->stored ) : "" );
    }
    else if ( suite->reference_count > 0 )
    {
        snprintf( out, size, "the same scene with %.*s%s", suite->extrapolate > 0.0 ? 80 : 150, set,
                  suite->extrapolate > 0.0 ? " and half of its substeps, extrapolated to infinitely many" : "" );
    }
}

static wisp_status make_runs( const suite_references* references, suite_reference* out, wisp_error* error )
{
    const char name[] = "the coarser reference";
    suite_motion coarser = { 0 };
    suite_match match = { 0 };
    wisp_status status = find_run( references, &out->runs->fine, &out->times, &out->motion, error );
    status = status == WISP_OK ? find_run( references, &out->runs->check, &out->times, &coarser, error ) : status;
    status = status == WISP_OK && references->suite->extrapolate > 0.0
                 ? extrapolate( references, &coarser, out, error )
                 : status;
    status = status == WISP_OK ? suite_match_motions( &coarser, &out->motion, name, &match, error ) : status;
    if ( status == WISP_OK )
    {
        find_chaos( &match, &coarser, out );
        status = suite_compare( &coarser, out, name, &out->doubt, error );
    }
    suite_match_release( &match );
    release_motion( &coarser );
    return status;
}

// ---- which rows have one ----

// What a scene is, whatever solves it.
typedef struct scene_facts
{
    uint64_t world; // hash of bodies and pins
    text_node* text;
    double seconds, dt;
} scene_facts;

static uint64_t hash_world( const scene_world* world, uint64_t hash )
{
    for ( int i = 0; i < scene_world_body_count( world ); ++i )
    {
        const scene_body body = scene_world_body( world, i );
        const size_t corners = 3 * (size_t)body.triangle_count, strands = (size_t)body.strand_count;
        hash = suite_hash_bytes( body.name, strlen( body.name ) + 1, hash );
        hash = suite_hash_bytes( body.triangles, body.triangles ? corners * sizeof( int32_t ) : 0, hash );
        hash = suite_hash_bytes( body.offsets, body.offsets ? ( strands + 1 ) * sizeof( int32_t ) : 0, hash );
        wisp_vec3* points = text_alloc( (size_t)body.vertex_count * sizeof *points );
        (void)scene_world_points( world, i, points, NULL );
        hash = suite_hash_bytes( points, (size_t)body.vertex_count * sizeof *points, hash );
        free( points );
    }
    for ( int i = 0; i < world->scene->surface_count; ++i )
    {
        const scene_world_surface* surface = &world->surfaces[i];
        const wisp_fabric* fabric = surface->fabric;
        hash = suite_hash_bytes( surface->pins, (size_t)surface->pin_count * sizeof( int32_t ), hash );
        for ( int v = 0; fabric && v < fabric->vertex_count; ++v )
        {
            hash = suite_hash_bytes( fabric->rest + fabric->vertex_slot[v], sizeof( wisp_vec3 ), hash );
        }
    }
    return hash;
}

static wisp_status find_facts( const suite_row* row, scene_facts* out, wisp_error* error )
{
    const scene_world_options options = { .workers = 1, .is_quiet = true };
    scene_world world;
    row_steps steps = { .count = 0 };
    wisp_status status = steps_of( row, &steps, error );
    status = status == WISP_OK ? text_parse( row->text, strlen( row->text ), row->path, &out->text, error ) : status;
    status = status == WISP_OK ? scene_world_create( &steps.scene, &options, &world, error ) : status;
    if ( status == WISP_OK )
    {
        out->world = hash_world( &world, SUITE_HASH_BEGIN );
        out->seconds = steps.seconds;
        out->dt = (double)steps.scene.dt;
        scene_world_destroy( &world );
    }
    wisp_scene_release( &steps.scene );
    return status;
}

// Blocks that move what they name, and parts of the keys of materials and loads.
static const char* const motions[] = { "colliders", "seams",      "events", "hair_events", "keyframes",       "pins",
                                       "animation", "pin_groups", "tips",   "velocity",    "angular_velocity" };
static const char* const loads[] = { "compliance", "stiffness", "rigidity", "damping", "density", "mass", "friction",
                                     "thickness",  "gravity",   "wind",     "drag",    "lift",    "gas" };

static bool is_same_text( const text_node* a, const text_node* b )
{
    double x, y;
    if ( a == NULL || b == NULL || ( text_is_number( a, &x ) && text_is_number( b, &y ) ) )
    {
        return a == b || ( a && b && x == y );
    }
    char *one = text_write( a, NULL ), *other = text_write( b, NULL );
    const bool is_same = strcmp( one, other ) == 0;
    free( one );
    free( other );
    return is_same;
}

// Whether one scene says nothing of motions, and of loads, that the other one does not say too. What a scene does not say is a load only if
// another one says it: solvers differ in the materials that they know.
static bool has_no_other( const text_node* one, const text_node* other, bool has_loads )
{
    bool is_same = true;
    for ( int i = 0; i < one->count && i < ( one->kind == TEXT_MAP ? one->count : other->count ) && is_same; ++i )
    {
        const text_node* child = one->children[i];
        const text_node* its = one->kind == TEXT_MAP ? text_find( other, child->key ) : other->children[i];
        bool counts = false;
        for ( int k = 0; k < WISP_COUNT( motions ) && child->key; ++k )
        {
            counts = counts || strcmp( child->key, motions[k] ) == 0;
        }
        for ( int k = 0; k < WISP_COUNT( loads ) && child->key && has_loads; ++k )
        {
            counts = counts || strstr( child->key, loads[k] ) != NULL;
        }
        is_same = counts ? is_same_text( child, its )
                         : its == NULL || its->kind != child->kind || child->kind == TEXT_SCALAR ||
                               has_no_other( child, its, has_loads );
    }
    return is_same;
}

static bool is_same_scene( const scene_facts* row, const scene_facts* reference )
{
    return row->world == reference->world &&
           fabs( row->seconds - reference->seconds ) < fmax( row->dt, reference->dt ) &&
           has_no_other( row->text, reference->text, true ) && has_no_other( reference->text, row->text, false );
}

// Give rows of one scene the first reference that has it. Where the fields of the reference make no world, as of another solver, that is the
// suite's own.
static wisp_status join( const wisp_suite* suite, suite_references* out, scene_facts* facts, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < out->count && out->count > 1 && status == WISP_OK; ++i )
    {
        wisp_error inner = { 0 };
        int same = 0;
        status = find_facts( &suite->references[i].fine, facts + i, i > 0 ? &inner : error );
        const bool has_world = status == WISP_OK;
        status = status == WISP_BAD_INPUT && i > 0 ? WISP_OK : status;
        while ( has_world && same < i && ( !facts[same].text || !is_same_scene( facts + i, facts + same ) ) )
        {
            ++same;
        }
        for ( int row = 0; row < suite->row_count && same < i; ++row )
        {
            out->of_row[row] = out->of_row[row] == i ? same : out->of_row[row];
        }
        if ( same < i )
        {
            text_release( facts[i].text );
            facts[i].text = NULL;
        }
        if ( status != WISP_OK && i > 0 )
        {
            wisp_fail( error, status, "%s", inner.message );
        }
    }
    return status;
}

wisp_status suite_references_find( const wisp_suite* suite, suite_references* out, wisp_error* error )
{
    const size_t count = suite->reference_count > 0 ? (size_t)suite->reference_count : 1;
    *out = ( suite_references ){ .suite = suite, .count = (int)count };
    describe( suite, out->description, sizeof out->description );
    out->list = calloc( count, sizeof *out->list );
    out->is_made = calloc( count, sizeof *out->is_made );
    out->of_row = calloc( (size_t)suite->row_count + 1, sizeof *out->of_row );
    scene_facts* facts = calloc( count, sizeof *facts );
    wisp_status status = out->list && out->is_made && out->of_row && facts
                             ? WISP_OK
                             : wisp_fail( error, WISP_NO_MEMORY, "no memory for the references of a suite" );
    for ( int i = 0; i < suite->row_count && status == WISP_OK; ++i )
    {
        out->of_row[i] = suite->rows[i].reference;
    }
    status = status == WISP_OK ? join( suite, out, facts, error ) : status;
    for ( size_t i = 0; facts && i < count; ++i )
    {
        text_release( facts[i].text );
    }
    free( facts );
    return status;
}

void suite_references_release( suite_references* references )
{
    for ( int i = 0; references->list && i < references->count; ++i )
    {
        release_motion( &references->list[i].motion );
    }
    free( references->list );
    free( references->is_made );
    free( references->of_row );
    *references = ( suite_references ){ 0 };
}

wisp_status suite_reference_of( suite_references* references, int row, const suite_reference** out,
                                wisp_error* error )
{
    const wisp_suite* suite = references->suite;
    const int number = references->of_row[row];
    suite_reference* own = references->list + number;
    *out = own;
    if ( references->is_made[number] )
    {
        return WISP_OK;
    }
    *own =
        ( suite_reference ){ .doubt = suite_not_compared, .parts_at = INFINITY, .is_start = suite->compares_start };
    own->runs = suite->reference_count > 0 ? suite->references + number : NULL;
    own->exists = own->runs || suite->stored || suite->compares_start;
    wisp_status status = own->exists ? choose_times( references, number, own, error ) : WISP_OK;
    status = status != WISP_OK || !own->exists || own->is_start ? status
             : suite->stored                                    ? read_stored( suite, own, error )
                                                                : make_runs( references, own, error );
    const int compared = own->is_start ? own->times.count : own->frame_count;
    own->until = status == WISP_OK && compared > 0 ? own->times.at[compared - 1] : 0.0;
    references->is_made[number] = status == WISP_OK;
    return status;
}

bool suite_reference_parts( const suite_reference* reference )
{
    return isfinite( reference->parts_at ) && reference->until < reference->parts_at;
}

// ---- errors ----

static wisp_status compare( const suite_reference* reference, const suite_row* row, const suite_motion* motion,
                            suite_measurement* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    if ( reference->is_start )
    {
        out->compared.distance = suite_drift( motion );
    }
    else
    {
        status = suite_compare( motion, reference, row->name, &out->compared, error );
    }
    out->values[SUITE_ERROR] = isfinite( out->compared.distance ) ? out->compared.distance : INFINITY;
    out->compared.until = reference->until;
    out->compared.parts = suite_reference_parts( reference );
    return status;
}

wisp_status suite_reference_run( const suite_reference* reference, const suite_row* row, const char* isa,
                                 const suite_observer* observer, suite_measurement* out, wisp_error* error )
{
    if ( !reference->exists )
    {
        return suite_run_row( row, isa, observer, out, error );
    }
    suite_motion motion = { 0 };
    wisp_status status = run_motion( row, isa, &reference->times, observer, &motion, out, error );
    if ( status == WISP_OK )
    {
        out->values[SUITE_ERROR] = INFINITY;
        status = out->values[SUITE_HALTED] > 0.0 ? WISP_OK : compare( reference, row, &motion, out, error );
    }
    release_motion( &motion );
    return status;
}
