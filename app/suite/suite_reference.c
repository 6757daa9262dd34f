#include "suite_reference.h"

#include "io_file.h"
#include "suite_compare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum
{
    PATH_SIZE = 1024,
    CACHE_VERSION = 2, // of what a kept run depends on
};

// Distance between two runs that should be one, as part of their size, at which their motion is chaotic.
static const double APART = 0.01;

void suite_reference_release( suite_reference* reference )
{
    suite_motion_release( &reference->motion );
}

// ---- the cache ----

bool suite_cache_folder( char* out, size_t size )
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

static uint64_t hash_bytes( const void* bytes, size_t size, uint64_t hash )
{
    const unsigned char* at = bytes;
    for ( size_t i = 0; i < size; ++i )
    {
        hash = ( hash ^ at[i] ) * 0x100000001b3u;
    }
    return hash;
}

// What decides about the motion: the scene with its settings, the files that it reads, and when it is looked at.
static wisp_status hash_row( const suite_row* row, const suite_times* times, uint64_t* out, wisp_error* error )
{
    wisp_scene scene;
    scene_world world;
    const scene_world_options options = { .workers = 1, .is_quiet = true };
    const int version = CACHE_VERSION;
    wisp_status status = suite_scene( row, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    *out = hash_bytes( &version, sizeof version, SUITE_HASH_BEGIN );
    *out = hash_bytes( row->text, strlen( row->text ), *out );
    *out = hash_bytes( times->at, (size_t)times->count * sizeof *times->at, *out );
    status = scene_world_create( &scene, &options, &world, error );
    if ( status == WISP_OK )
    {
        wisp_vec3* points = malloc( ( (size_t)scene_world_vertices( &world ) + 1 ) * sizeof *points );
        *out = points ? suite_hash_points( &world, points, *out ) : *out;
        status = points ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for the points of a reference" );
        free( points );
        scene_world_destroy( &world );
    }
    wisp_scene_release( &scene );
    return status;
}

// Find a run in the cache, or make and keep it. A file of the cache that cannot be read is made again.
static wisp_status find_run( const wisp_suite* suite, const suite_row* row, const suite_times* times,
                             suite_motion* out, wisp_error* error )
{
    char folder[PATH_SIZE], path[2 * PATH_SIZE];
    uint64_t hash = 0;
    wisp_status status = hash_row( row, times, &hash, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const bool keeps = suite_cache_folder( folder, sizeof folder ) && make_folders( folder );
    snprintf( path, sizeof path, "%s/%s-%016llx.wisp", folder, suite->name, (unsigned long long)hash );
    struct stat found;
    if ( keeps && stat( path, &found ) == 0 )
    {
        if ( suite_motion_read( path, times, out, NULL ) == WISP_OK )
        {
            return WISP_OK;
        }
        suite_motion_release( out );
    }
    suite_measurement measured;
    status = suite_motion_run( row, NULL, times, NULL, out, &measured, error );
    if ( status == WISP_OK && measured.values[SUITE_HALTED] > 0.0 )
    {
        return wisp_fail( error, WISP_CONFLICT,
                          "%s: the %s was halted, it cannot be what errors are measured against", suite->name,
                          row->name );
    }
    // a folder that is full or read-only costs time the next time, and nothing else
    if ( status == WISP_OK && keeps )
    {
        (void)suite_motion_write( out, path, NULL );
    }
    return status;
}

// ---- both kinds ----

static wisp_status read_stored( const wisp_suite* suite, suite_reference* out, wisp_error* error )
{
    snprintf( out->description, sizeof out->description, "the stored motion %s", io_short_name( suite->stored ) );
    wisp_status status = suite_motion_read( suite->stored, &out->times, &out->motion, error );
    out->frame_count = out->motion.frame_count;
    status = status == WISP_OK
                 ? suite_compare( &out->motion, &out->motion, out->frame_count, "the reference", &out->doubt, error )
                 : status;
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
static wisp_status extrapolate( const wisp_suite* suite, suite_motion* half, suite_reference* out, wisp_error* error )
{
    const double part = 1.0 / ( pow( 2.0, suite->extrapolate ) - 1.0 );
    suite_motion quarter = { 0 };
    wisp_status status = find_run( suite, &suite->coarsest, &out->times, &quarter, error );
    status = status == WISP_OK ? suite_motion_extrapolate( &out->motion, half, part, error ) : status;
    status = status == WISP_OK ? suite_motion_extrapolate( half, &quarter, part, error ) : status;
    suite_motion_release( &quarter );
    return status;
}

static void describe( const wisp_suite* suite, suite_reference* out )
{
    if ( suite->extrapolate > 0.0 )
    {
        snprintf( out->description, sizeof out->description,
                  "the same scene with %.80s and half of its substeps, extrapolated to infinitely many",
                  suite->reference.variant );
    }
    else
    {
        snprintf( out->description, sizeof out->description, "the same scene with %.150s", suite->reference.variant );
    }
}

static wisp_status make_runs( const wisp_suite* suite, suite_reference* out, wisp_error* error )
{
    const char name[] = "the coarser reference";
    suite_motion coarser = { 0 };
    suite_match match = { 0 };
    wisp_status status = find_run( suite, &suite->reference, &out->times, &out->motion, error );
    status = status == WISP_OK ? find_run( suite, &suite->check, &out->times, &coarser, error ) : status;
    status = status == WISP_OK && suite->extrapolate > 0.0 ? extrapolate( suite, &coarser, out, error ) : status;
    status = status == WISP_OK ? suite_match_motions( &coarser, &out->motion, name, &match, error ) : status;
    if ( status == WISP_OK )
    {
        find_chaos( &match, &coarser, out );
        status = suite_compare( &coarser, &out->motion, out->frame_count, name, &out->doubt, error );
        describe( suite, out );
    }
    suite_match_release( &match );
    suite_motion_release( &coarser );
    return status;
}

wisp_status suite_reference_make( const wisp_suite* suite, suite_reference* out, wisp_error* error )
{
    *out =
        ( suite_reference ){ .doubt = suite_not_compared, .parts_at = INFINITY, .is_start = suite->compares_start };
    out->exists = suite->reference.text != NULL || suite->stored != NULL || suite->compares_start;
    const wisp_status status = out->exists ? suite_choose_times( suite, &out->times, error ) : WISP_OK;
    return status != WISP_OK || !out->exists || out->is_start ? status
           : suite->stored                                    ? read_stored( suite, out, error )
                                                              : make_runs( suite, out, error );
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
        status =
            suite_compare( motion, &reference->motion, reference->frame_count, row->name, &out->compared, error );
    }
    out->values[SUITE_ERROR] = isfinite( out->compared.distance ) ? out->compared.distance : INFINITY;
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
    wisp_status status = suite_motion_run( row, isa, &reference->times, observer, &motion, out, error );
    if ( status == WISP_OK )
    {
        out->values[SUITE_ERROR] = INFINITY;
        status = out->values[SUITE_HALTED] > 0.0 ? WISP_OK : compare( reference, row, &motion, out, error );
    }
    suite_motion_release( &motion );
    return status;
}
