// A row is run on one worker, so that allocations and instructions repeat. Requests of statistics change no bit.
#include "suite_measure.h"

#include "implicit_cloth/implicit_cloth.h"
#include "interruption.h"
#include "wisp/explain.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const double suite_moments[SUITE_MOMENT_COUNT] = { 0.5, 1.0, 2.0 };

const suite_comparison suite_not_compared = { NAN, NAN, { NAN, NAN, NAN }, NAN, NAN };

// ---- in this process ----

enum
{
    PAGE = 4096,
};

// The allocator of the world, which counts. The C library's memcpy chooses its path by the positions of source and target within a
// page; blocks with pages of their own have the same positions in every run. @param user double, allocations
static void* allocate( void* user, size_t size, size_t alignment )
{
    *(double*)user += 1.0;
    return alignment <= PAGE ? aligned_alloc( PAGE, ( size + PAGE - 1 ) / PAGE * PAGE ) : NULL;
}

static void release( void* user, void* block, size_t size )
{
    (void)user;
    (void)size;
    free( block );
}

// What lasts from step to step.
typedef struct watch
{
    wisp_vec3* points; // [vertices of the scene]
    double energy;     // J, after the first step
} watch;

// FNV-1a over the bits of points.
static uint64_t hash_body( const wisp_vec3* points, int count, uint64_t hash )
{
    for ( int i = 0; i < count; ++i )
    {
        uint32_t words[3];
        memcpy( words, points + i, sizeof words );
        for ( int k = 0; k < 3; ++k )
        {
            hash = ( hash ^ words[k] ) * 0x100000001b3u;
        }
    }
    return hash;
}

uint64_t suite_hash_points( const scene_world* world, wisp_vec3* points, uint64_t hash )
{
    for ( int body = 0; body < scene_world_moving_count( world ); ++body )
    {
        if ( scene_world_points( world, body, points, NULL ) == WISP_OK )
        {
            hash = hash_body( points, scene_world_body( world, body ).vertex_count, hash );
        }
    }
    return hash;
}

// Iterations of the linear solves of a step. @return NaN if no surface has any
static double count_iterations( const scene_world* world )
{
    double sum = NAN;
    for ( int i = 0; i < world->scene->surface_count; ++i )
    {
        wisp_implicit_cloth_stats stats;
        if ( world->scene->surfaces[i].has_implicit &&
             wisp_read_implicit_cloth_stats( world->world, world->surfaces[i].entity, &stats ) == WISP_OK )
        {
            sum = ( isnan( sum ) ? 0.0 : sum ) + stats.iterations;
        }
    }
    return sum;
}

bool suite_motion_stats( const scene_world* world, int body, wisp_motion_stats* out )
{
    const int surface = body - world->scene->strands_count;
    return ( surface < 0 || !scene_is_driven( &world->scene->surfaces[surface] ) ) &&
           scene_world_motion_stats( world, body, out, NULL ) == WISP_OK;
}

static void watch_step( const scene_world* world, watch* w, suite_measurement* out )
{
    double sum = 0.0;
    for ( int body = 0; body < scene_world_moving_count( world ); ++body )
    {
        wisp_motion_stats m;
        wisp_collision_stats c;
        if ( suite_motion_stats( world, body, &m ) )
        {
            sum += m.kinetic_energy + m.potential_energy;
            out->values[SUITE_STRETCH] = fmax( out->values[SUITE_STRETCH], m.strain_mean );
        }
        if ( scene_world_collision_stats( world, body, &c, NULL ) == WISP_OK && c.vertex >= 0 )
        {
            out->values[SUITE_PENETRATION] = fmax( out->values[SUITE_PENETRATION], (double)c.penetration );
        }
    }
    out->hash = suite_hash_points( world, w->points, out->hash );
    out->values[SUITE_SOLVER_ITERATIONS] += count_iterations( world );
    w->energy = out->steps == 0 ? sum : w->energy;
    out->values[SUITE_ENERGY] = fmax( out->values[SUITE_ENERGY], sum - w->energy );
}

static void finish( const scene_world* world, suite_measurement* out )
{
    wisp_contact_stats contact;
    out->values[SUITE_BYTES] = (double)wisp_world_memory( world->world );
    out->values[SUITE_RESETS] = (double)wisp_world_counter( world->world, WISP_COUNT_STRAND_RESET );
    out->values[SUITE_NOT_CONVERGED] = (double)wisp_world_counter( world->world, WISP_COUNT_NOT_CONVERGED );
    out->values[SUITE_HALTED] = (double)wisp_world_counter( world->world, WISP_COUNT_HALTED );
    if ( scene_has_contact( world->scene ) && wisp_read_contact_stats( world->world, &contact ) == WISP_OK )
    {
        out->values[SUITE_INTERSECTIONS] = contact.intersections;
    }
}

static void add_pass( const char* name, uintptr_t code, suite_measurement* out )
{
    for ( int i = 0; i < out->pass_count; ++i )
    {
        if ( out->passes[i].code == code )
        {
            return;
        }
    }
    if ( out->pass_count < SUITE_MAX_PASSES )
    {
        suite_pass* pass = &out->passes[out->pass_count++];
        *pass = ( suite_pass ){ .code = code, .instructions = NAN };
        snprintf( pass->name, sizeof pass->name, "%s", name );
    }
}

// The passes that ran, and the functions that run several of them together.
static void gather_passes( const scene_world* world, suite_measurement* out )
{
    wisp_plan_info* info = NULL;
    if ( wisp_world_explain( world->world, &info ) == WISP_OK )
    {
        for ( int i = 0; i < info->active_count; ++i )
        {
            add_pass( info->passes[i].name, info->passes[i].code, out );
            if ( info->passes[i].fusion )
            {
                add_pass( info->passes[i].fusion, info->passes[i].fusion_code, out );
            }
        }
    }
    wisp_plan_info_release( info );
}

static wisp_status run_steps( scene_world* world, int steps, const double* allocations,
                              const suite_observer* observer, suite_measurement* out, wisp_error* error )
{
    double warm = 0.0;
    watch w = { .points = malloc( ( (size_t)scene_world_vertices( world ) + 1 ) * sizeof *w.points ) };
    wisp_status status =
        w.points ? WISP_OK
                 : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its points", world->scene->name );
    status = status == WISP_OK && observer ? observer->observe( observer->user, world, error ) : status;
    for ( int step = 0; step < steps && status == WISP_OK; ++step )
    {
        // counting intersections takes memory, so it is asked for last
        if ( step + 1 == steps )
        {
            out->values[SUITE_ALLOCATIONS] = *allocations - warm;
            if ( scene_has_contact( world->scene ) )
            {
                (void)wisp_request_contact_stats( world->world, true, true );
            }
        }
        status = interruption_check( error );
        status = status == WISP_OK ? scene_world_step( world, error ) : status;
        warm = step < steps / 2 ? *allocations : warm;
        if ( status == WISP_OK )
        {
            watch_step( world, &w, out );
            out->steps = step + 1;
            status = observer ? observer->observe( observer->user, world, error ) : WISP_OK;
        }
    }
    free( w.points );
    return status;
}

wisp_status suite_time_step( scene_world* world, double* ms, wisp_error* error )
{
    const double begin = wisp_clock_seconds();
    wisp_status status = interruption_check( error );
    status = status == WISP_OK ? scene_world_step( world, error ) : status;
    *ms = 1e3 * ( wisp_clock_seconds() - begin );
    return status;
}

wisp_status suite_run_row( const suite_row* row, const char* isa, const suite_observer* observer,
                           suite_measurement* out, wisp_error* error )
{
    *out = ( suite_measurement ){ .hash = SUITE_HASH_BEGIN, .compared = suite_not_compared };
    out->values[SUITE_INSTRUCTIONS] = out->values[SUITE_CYCLES] = out->values[SUITE_ERROR] =
        out->values[SUITE_INTERSECTIONS] = NAN;
    wisp_scene scene;
    wisp_status status = suite_scene( row, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    scene_request_statistics( &scene );
    if ( observer && observer->requests_contact )
    {
        scene_request_intersections( &scene );
    }
    double allocations = 0.0;
    const wisp_allocator allocator = { allocate, release, &allocations };
    const scene_world_options options = { .workers = 1, .isa = isa, .is_quiet = true, .allocator = &allocator };
    scene_world world;
    status = scene_world_create( &scene, &options, &world, error );
    if ( status == WISP_OK )
    {
        snprintf( out->isa, sizeof out->isa, "%s", wisp_world_isa( world.world ) );
        status = run_steps( &world, row->steps > 0 ? row->steps : scene.steps, &allocations, observer, out, error );
        finish( &world, out );
        gather_passes( &world, out );
        scene_world_destroy( &world );
    }
    wisp_scene_release( &scene );
    return status;
}
