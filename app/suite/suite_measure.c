#include "suite_measure.h"

#include "implicit_cloth/implicit_cloth.h"
#include "interruption.h"
#include "wisp/explain.h"
#include "wisp/module/collision_mesh.h"
#include "wisp/module/definition.h"

#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

// ---- balloons in each other ----

// A balloon after the last step.
typedef struct balloon
{
    wisp_vec3* points; // [count]
    int count;
    float thickness, reach; // m, what it keeps apart; half of its smallest extent
    double centre[3];       // m
    wisp_collision_mesh* mesh;
} balloon;

typedef struct work
{
    balloon* balloons; // [count]
    int count, largest;
    wisp_mesh_query* queries;   // [largest]
    wisp_mesh_nearest* nearest; // [largest]
    io_memory memory;
} work;

// As contact has it.
static float thickness_of( const scene_world* world, int surface )
{
    const wisp_fabric* fabric = world->surfaces[surface].fabric;
    const float given = world->scene->surfaces[surface].contact.thickness;
    double sum = 0.0;
    for ( int e = 0; e < fabric->edge_count; ++e )
    {
        const wisp_vec3 a = fabric->rest[fabric->edges[2 * e]], b = fabric->rest[fabric->edges[2 * e + 1]];
        const double x = (double)( a.x - b.x ), y = (double)( a.y - b.y ), z = (double)( a.z - b.z );
        sum += sqrt( x * x + y * y + z * z );
    }
    return given > 0.0f ? given : (float)( 0.25 * sum / fabric->edge_count );
}

static void measure( balloon* b )
{
    wisp_vec3 low = b->points[0], high = low;
    for ( int v = 0; v < b->count; ++v )
    {
        const wisp_vec3 p = b->points[v];
        low = ( wisp_vec3 ){ fminf( low.x, p.x ), fminf( low.y, p.y ), fminf( low.z, p.z ) };
        high = ( wisp_vec3 ){ fmaxf( high.x, p.x ), fmaxf( high.y, p.y ), fmaxf( high.z, p.z ) };
        b->centre[0] += (double)p.x / b->count;
        b->centre[1] += (double)p.y / b->count;
        b->centre[2] += (double)p.z / b->count;
    }
    b->reach = 0.5f * fminf( high.x - low.x, fminf( high.y - low.y, high.z - low.z ) );
}

static wisp_status add_balloon( const scene_world* world, int surface, work* w, wisp_error* error )
{
    const int number = world->scene->strands_count + surface;
    const scene_body body = scene_world_body( world, number );
    balloon* b = &w->balloons[w->count++];
    *b = ( balloon ){ .points = io_get( &w->memory, (size_t)body.vertex_count * sizeof( wisp_vec3 ) ),
                      .count = body.vertex_count };
    w->largest = body.vertex_count > w->largest ? body.vertex_count : w->largest;
    WISP_TRY( b->points ? scene_world_points( world, number, b->points, error )
                        : wisp_fail( error, WISP_NO_MEMORY, "no memory to measure how balloons overlap" ) );
    b->thickness = thickness_of( world, surface );
    measure( b );
    const wisp_collision_mesh_def def = {
        .points = b->points,
        .triangles = body.triangles,
        .point_count = body.vertex_count,
        .triangle_count = body.triangle_count,
        .deforms = true,
    };
    return wisp_collision_mesh_create( &def, NULL, &b->mesh, error );
}

static float distance_from( const wisp_mesh_nearest* nearest )
{
    return nearest->triangle >= 0 ? nearest->distance : INFINITY;
}

// Distances of the vertices of one balloon from another, into `nearest`.
static void ask( work* w, const balloon* from, const balloon* to )
{
    for ( int v = 0; v < from->count; ++v )
    {
        w->queries[v] = ( wisp_mesh_query ){ .point = from->points[v], .radius = to->reach };
    }
    wisp_collision_mesh_closest( to->mesh, w->queries, from->count, w->nearest, NULL );
}

static void find_depth( work* w, suite_overlap* out )
{
    int missed = 0, vertices = 0;
    for ( int i = 0; i < w->count * w->count; ++i )
    {
        const balloon *from = &w->balloons[i / w->count], *to = &w->balloons[i % w->count];
        const float thickness = 0.5f * ( from->thickness + to->thickness );
        if ( from == to )
        {
            vertices += from->count;
            continue;
        }
        ask( w, from, to );
        for ( int v = 0; v < from->count; ++v )
        {
            const float distance = distance_from( &w->nearest[v] );
            out->depth = fmax( out->depth, (double)( thickness - distance ) );
            missed += distance < 0.5f * thickness ? 1 : 0;
        }
    }
    out->missed = (double)missed / vertices;
}

static void find_wall( work* w, suite_overlap* out )
{
    static const float NEXT_TO = 1.5f; // thicknesses
    const balloon *one = &w->balloons[0], *other = &w->balloons[1];
    double axis[3], length = 0.0, sum = 0.0, squares = 0.0, farthest = 0.0;
    int count = 0;
    for ( int k = 0; k < 3; ++k )
    {
        axis[k] = other->centre[k] - one->centre[k];
        length += axis[k] * axis[k];
    }
    ask( w, one, other );
    for ( int v = 0; v < one->count; ++v )
    {
        const wisp_vec3 p = one->points[v];
        const double d[3] = { (double)p.x - one->centre[0], (double)p.y - one->centre[1],
                              (double)p.z - one->centre[2] };
        if ( distance_from( &w->nearest[v] ) < NEXT_TO * one->thickness )
        {
            const double along = ( d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2] ) / sqrt( length );
            const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - along * along;
            sum += along;
            squares += along * along;
            farthest = fmax( farthest, sqrt( fmax( square, 0.0 ) ) );
            ++count;
        }
    }
    const double mean = sum / count;
    out->wall_radius = count > 0 ? farthest : NAN;
    out->wall_unevenness = count > 0 ? sqrt( fmax( squares / count - mean * mean, 0.0 ) ) : NAN;
}

static wisp_status find_overlap( const scene_world* world, work* w, suite_overlap* out, wisp_error* error )
{
    const int surfaces = world->scene->surface_count;
    w->balloons = io_get( &w->memory, (size_t)surfaces * sizeof *w->balloons );
    WISP_TRY( w->balloons ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for balloons" ) );
    for ( int i = 0; i < surfaces; ++i )
    {
        WISP_TRY( world->scene->surfaces[i].has_balloon ? add_balloon( world, i, w, error ) : WISP_OK );
    }
    w->queries = io_get( &w->memory, (size_t)w->largest * sizeof *w->queries );
    w->nearest = io_get( &w->memory, (size_t)w->largest * sizeof *w->nearest );
    if ( w->memory.is_short )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory to measure how balloons overlap" );
    }
    if ( w->count > 1 )
    {
        find_depth( w, out );
        find_wall( w, out );
    }
    return WISP_OK;
}

wisp_status suite_overlap_find( const scene_world* world, suite_overlap* out, wisp_error* error )
{
    *out = ( suite_overlap ){ .wall_radius = NAN, .wall_unevenness = NAN };
    work w = { .count = 0 };
    const wisp_status status = find_overlap( world, &w, out, error );
    for ( int i = 0; i < w.count; ++i )
    {
        wisp_collision_mesh_release( w.balloons[i].mesh );
    }
    io_release( &w.memory );
    return status;
}

const double suite_moments[SUITE_MOMENT_COUNT] = { 0.5, 1.0, 2.0 };

const suite_comparison suite_not_compared = { NAN, NAN, { NAN, NAN, NAN }, NAN, NAN, 0.0, false, NAN, NAN, NAN, NAN };

void suite_horizon_add( suite_horizon* horizon, double until, bool parts )
{
    horizon->least = horizon->least > 0.0 && !( until > 0.0 && until < horizon->least ) ? horizon->least : until;
    horizon->most = fmax( horizon->most, until );
    horizon->parts = horizon->parts || parts;
}

void suite_horizon_text( const suite_horizon* horizon, char* out, size_t size )
{
    char from[32] = "";
    out[0] = '\0';
    if ( horizon->least < horizon->most )
    {
        snprintf( from, sizeof from, "%.3g to ", horizon->least );
    }
    if ( horizon->most > 0.0 )
    {
        snprintf( out, size, "; compared until %s%.3g s, %s", from, horizon->most,
                  horizon->parts ? "where two converged runs part" : "the end" );
    }
}

// ---- in this process ----

// A row is run on one worker, so that allocations and instructions repeat. Requests of statistics change no bit.

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

uint64_t suite_hash_bytes( const void* bytes, size_t size, uint64_t hash )
{
    const unsigned char* at = bytes;
    for ( size_t i = 0; i < size; ++i )
    {
        hash = ( hash ^ at[i] ) * 0x100000001b3u;
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
    return ( surface < 0 || !wisp_scene_is_driven( &world->scene->surfaces[surface] ) ) &&
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
    out->strands = scene_world_strands( world );
    out->vertices = scene_world_vertices( world );
    out->substeps = world->scene->substeps;
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

static wisp_status time_steps( scene_world* world, int steps, const suite_observer* observer, double* ms,
                               uint64_t* hash, wisp_error* error )
{
    wisp_vec3* points = malloc( ( (size_t)scene_world_vertices( world ) + 1 ) * sizeof *points );
    wisp_status status = points != NULL ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for points" );
    *hash = SUITE_HASH_BEGIN;
    for ( int step = 0; step < steps && status == WISP_OK; ++step )
    {
        const double begin = wisp_clock_seconds();
        status = interruption_check( error );
        status = status == WISP_OK ? scene_world_step( world, error ) : status;
        ms[step] = 1e3 * ( wisp_clock_seconds() - begin );
        status = status == WISP_OK && observer != NULL ? observer->observe( observer->user, world, error ) : status;
        *hash = status == WISP_OK ? suite_hash_points( world, points, *hash ) : 0;
    }
    free( points );
    return status;
}

wisp_status suite_time_row( const suite_row* row, int workers, const char* isa, const suite_observer* observer,
                            double** ms, int* steps, uint64_t* hash, wisp_error* error )
{
    const scene_world_options options = { .workers = workers, .isa = isa, .is_quiet = true };
    wisp_scene scene;
    scene_world world;
    *ms = NULL;
    WISP_TRY( suite_scene( row, &scene, error ) );
    scene_request_points( &scene );
    *steps = scene.steps;
    *ms = calloc( (size_t)*steps + 1, sizeof **ms );
    wisp_status status = *ms != NULL ? scene_world_create( &scene, &options, &world, error )
                                     : wisp_fail( error, WISP_NO_MEMORY, "no memory for times" );
    if ( status == WISP_OK )
    {
        status = time_steps( &world, *steps, observer, *ms, hash, error );
        scene_world_destroy( &world );
    }
    wisp_scene_release( &scene );
    return status;
}

wisp_status suite_run_row( const suite_row* row, const char* isa, const suite_observer* observer,
                           suite_measurement* out, wisp_error* error )
{
    *out = ( suite_measurement ){ .hash = SUITE_HASH_BEGIN, .compared = suite_not_compared };
    out->values[SUITE_INSTRUCTIONS] = out->values[SUITE_CYCLES] = out->values[SUITE_ERROR] =
        out->values[SUITE_INTERSECTIONS] = NAN;
    wisp_scene scene;
    WISP_TRY( suite_scene( row, &scene, error ) );
    scene_request_statistics( &scene );
    if ( observer && observer->requests_contact )
    {
        scene_request_intersections( &scene );
    }
    double allocations = 0.0;
    const wisp_allocator allocator = { allocate, release, &allocations };
    const scene_world_options options = { .workers = 1, .isa = isa, .is_quiet = true, .allocator = &allocator };
    scene_world world;
    wisp_status status = scene_world_create( &scene, &options, &world, error );
    if ( status == WISP_OK )
    {
        snprintf( out->isa, sizeof out->isa, "%s", wisp_world_isa( world.world ) );
        status = run_steps( &world, scene.steps, &allocations, observer, out, error );
        finish( &world, out );
        gather_passes( &world, out );
        scene_world_destroy( &world );
    }
    wisp_scene_release( &scene );
    return status;
}

// ---- instructions ----

// ---- the process ----

enum
{
    MAX_PATH = 4096,
};

// Run `wisp gate step` under callgrind, which counts inside of wisp_world_step(), and what the self-test wastes. Its environment
// is empty, because the C library and the place of the stack depend on it.
static _Noreturn void be_child( const char* program, const char* suite, int number,
                                const suite_count_options* options, const char* out )
{
    char row[16], file[MAX_PATH + 32];
    snprintf( row, sizeof row, "--row=%d", number );
    snprintf( file, sizeof file, "--callgrind-out-file=%s", out );
    char* const arguments[] = { "valgrind",
                                "--tool=callgrind",
                                "--toggle-collect=wisp_world_step",
                                "--toggle-collect=gate_slow_waste",
                                "--dump-instr=yes", // tells passes by the addresses of their functions
                                "--compress-pos=no",
                                "--compress-strings=no",
                                options->has_cycles ? "--cache-sim=yes" : "--cache-sim=no",
                                "--I1=32768,8,64", // caches of one machine, whatever this one has
                                "--D1=32768,8,64",
                                "--LL=4194304,16,64",
                                file,
                                "--",
                                (char*)(uintptr_t)program,
                                "gate",
                                "step",
                                row,
                                "--isa=avx2",
                                (char*)(uintptr_t)suite,
                                (char*)(uintptr_t)options->step,
                                NULL };
    char* const environment[] = { "PATH=/usr/local/bin:/usr/bin:/bin", "LC_ALL=C", NULL };
    interruption_leave_to_parent();
    const int nothing = open( "/dev/null", O_RDWR );
    dup2( nothing, STDIN_FILENO );
    dup2( nothing, STDOUT_FILENO );
    dup2( nothing, STDERR_FILENO );
    execvpe( "valgrind", arguments, environment );
    _exit( 127 );
}

// ---- the file that callgrind writes ----

// What callgrind counts, in the order of its columns.
enum
{
    INSTRUCTIONS,
    READS,
    WRITES,
    MISSES_I1,
    MISSES_D1_READ,
    MISSES_D1_WRITE,
    MISSES_LL_CODE,
    MISSES_LL_READ,
    MISSES_LL_WRITE,
    EVENTS,
};

// Cycles that a miss or a slow instruction is taken to cost, beyond the one of the instruction.
static const double FIRST_LEVEL = 10.0, LAST_LEVEL = 100.0, SLOW = 10.0;

typedef struct call
{
    char caller[160], callee[160]; // without the marks of recursion
    uintptr_t code;                // of the callee, in its file
    double instructions;
} call;

// What a file says beside its calls.
typedef struct totals
{
    double events[EVENTS]; // NaN: the file has no such line
    double slow;           // divisions and roots of the program
    bool is_program;       // whether lines are of the program, not of a library
} totals;

static void copy_name( const char* from, char* out, size_t size )
{
    snprintf( out, size, "%.*s", (int)strcspn( from, "\n'" ), from );
}

// Whether an instruction divides or takes a root, which takes several times as long as others.
static bool is_slow( const uint8_t* code )
{
#if defined( __x86_64__ )
    while ( *code == 0x66 || *code == 0xf2 || *code == 0xf3 || ( *code & 0xf0 ) == 0x40 )
    {
        ++code; // prefixes
    }
    if ( *code == 0xf6 || *code == 0xf7 ) // of integers
    {
        return ( code[1] & 0x30 ) == 0x30;
    }
    const bool is_map = *code == 0x0f || *code == 0xc5 || ( *code == 0xc4 && ( code[1] & 0x1f ) == 1 ) ||
                        ( *code == 0x62 && ( code[1] & 0x07 ) == 1 );
    const uint8_t operation = code[*code == 0x0f ? 1 : *code == 0xc5 ? 2 : *code == 0xc4 ? 3 : 4];
    return is_map && ( operation == 0x5e || operation == 0x51 );
#else
    (void)code;
    return false;
#endif
}

// A line of an instruction: its address, the line of its source, and what it cost. @param bias where the program was loaded
static void add_own_cost( const char* line, uintptr_t bias, totals* t )
{
    char* end;
    const uintptr_t place = (uintptr_t)strtoull( line, &end, 16 ) + bias;
    (void)strtol( end, &end, 10 );
    const double count = strtod( end, NULL );
    t->slow += t->is_program && is_slow( (const uint8_t*)place ) ? count : 0.0;
}

static void read_totals( const char* text, totals* t )
{
    char* end = (char*)(uintptr_t)text;
    for ( int i = 0; i < EVENTS; ++i ) // without caches there is one
    {
        t->events[i] = strtod( end, &end );
    }
}

// The next call of a file; `caller` lasts from one to the next. @param t receives what is not of calls
static bool next_call( FILE* file, const char* program, uintptr_t bias, call* out, totals* t )
{
    char line[4096];
    while ( fgets( line, sizeof line, file ) )
    {
        if ( strncmp( line, "totals:", 7 ) == 0 )
        {
            read_totals( line + 7, t );
        }
        else if ( strncmp( line, "ob=", 3 ) == 0 )
        {
            line[strcspn( line, "\n" )] = '\0';
            t->is_program = strcmp( line + 3, program ) == 0;
        }
        else if ( line[0] == '0' )
        {
            add_own_cost( line, bias, t );
        }
        else if ( strncmp( line, "fn=", 3 ) == 0 )
        {
            copy_name( line + 3, out->caller, sizeof out->caller );
        }
        else if ( strncmp( line, "cfn=", 4 ) == 0 )
        {
            copy_name( line + 4, out->callee, sizeof out->callee );
        }
        else if ( strncmp( line, "calls=", 6 ) == 0 )
        {
            // calls=COUNT CODE LINE, then a line with the place of the call, its line and what it cost
            const char* place = strchr( line, ' ' );
            out->code = place ? (uintptr_t)strtoull( place, NULL, 16 ) : 0;
            char* cost = fgets( line, sizeof line, file ) ? strchr( line, ' ' ) : NULL;
            cost = cost ? strchr( cost + 1, ' ' ) : NULL;
            out->instructions = cost ? strtod( cost, NULL ) : 0.0;
            return true;
        }
    }
    return false;
}

// Where the program was loaded, since files have addresses without that.
static int keep_bias( struct dl_phdr_info* info, size_t size, void* user )
{
    (void)size;
    *(uintptr_t*)user = (uintptr_t)info->dlpi_addr;
    return 1; // the first is the program
}

static suite_pass* pass_at( suite_measurement* m, uintptr_t code )
{
    for ( int i = 0; i < m->pass_count; ++i )
    {
        if ( m->passes[i].code == code )
        {
            return &m->passes[i];
        }
    }
    return NULL;
}

// Calls of passes count with all that they call, unless a pass makes them: that has them already.
static totals read_counts( const char* path, const char* program, suite_measurement* out )
{
    char names[SUITE_MAX_PASSES][160] = { "" };
    totals t = { .events = { NAN } };
    uintptr_t bias = 0;
    dl_iterate_phdr( keep_bias, &bias );
    FILE* file = fopen( path, "r" );
    for ( int round = 0; round < 2 && file; ++round )
    {
        call c = { .caller = "" };
        t = ( totals ){ .events = { NAN } };
        rewind( file );
        while ( next_call( file, program, bias, &c, &t ) )
        {
            suite_pass* pass = pass_at( out, c.code + bias );
            bool is_inside = false;
            for ( int i = 0; i < out->pass_count; ++i )
            {
                is_inside = is_inside || strcmp( names[i], c.caller ) == 0;
            }
            if ( pass && round == 0 )
            {
                snprintf( names[pass - out->passes], sizeof names[0], "%s", c.callee );
            }
            else if ( pass && !is_inside )
            {
                pass->instructions = ( isfinite( pass->instructions ) ? pass->instructions : 0.0 ) + c.instructions;
            }
        }
    }
    if ( file )
    {
        fclose( file );
    }
    return t;
}

static void keep_counts( const totals* t, bool has_cycles, suite_measurement* out )
{
    const double* e = t->events;
    out->values[SUITE_INSTRUCTIONS] = e[INSTRUCTIONS];
    const double first = e[MISSES_I1] + e[MISSES_D1_READ] + e[MISSES_D1_WRITE];
    const double last = e[MISSES_LL_CODE] + e[MISSES_LL_READ] + e[MISSES_LL_WRITE];
    out->values[SUITE_CYCLES] =
        has_cycles ? e[INSTRUCTIONS] + FIRST_LEVEL * first + LAST_LEVEL * last + SLOW * t->slow : NAN;
}

wisp_status suite_count_instructions( const char* suite, int number, const suite_count_options* options,
                                      suite_measurement* out, wisp_error* error )
{
    char program[MAX_PATH], path[] = "/tmp/wisp-gate-XXXXXX";
    const ssize_t length = readlink( "/proc/self/exe", program, sizeof program - 1 );
    const int file = length > 0 ? mkstemp( path ) : -1;
    if ( file < 0 )
    {
        return wisp_fail( error, WISP_IO_ERROR, "gate: no file for counts of instructions: %s", strerror( errno ) );
    }
    close( file );
    program[length] = '\0';
    fflush( NULL );
    const pid_t child = fork();
    if ( child == 0 )
    {
        be_child( program, suite, number, options, path );
    }
    int ended = 0xff00;
    if ( child > 0 )
    {
        interruption_wait( child, &ended );
    }
    const bool is_good = WIFEXITED( ended ) && WEXITSTATUS( ended ) == 0;
    const totals t = is_good ? read_counts( path, program, out ) : ( totals ){ .events = { NAN } };
    keep_counts( &t, options->has_cycles, out );
    unlink( path );
    if ( !is_good && interruption_came() )
    {
        return interruption_check( error );
    }
    if ( !( out->values[SUITE_INSTRUCTIONS] > 0.0 ) )
    {
        return wisp_fail( error, WISP_IO_ERROR, "gate: valgrind %s",
                          WIFEXITED( ended ) && WEXITSTATUS( ended ) == 127
                              ? "is not installed; --no-instructions gates without it"
                              : "counted no instructions of this row" );
    }
    return WISP_OK;
}
