// Worlds for every solver setting of the cloth, stepped in turns from sample to sample.
#include "compare_bench.h"

#include "cloth/cloth.h"
#include "collision/collision.h"
#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>

wisp_status compare_cook( const compare_scene* scene, wisp_fabric** out, wisp_error* error )
{
    wisp_fabric_def def = wisp_default_fabric_def();
    def.hinges = true;
    return surface_cook( &scene->base.mesh, def, out, error );
}

// ---- worlds ----

static wisp_cloth_def cloth_of( const compare_scene* scene, const compare_variant* variant )
{
    wisp_cloth_def def = wisp_default_cloth_def();
    const bool bends = scene->physics.bend > 0.0f;
    if ( variant->method == COMPARE_PBD )
    {
        def.solver = WISP_SOLVER_PBD;
        def.stretch_stiffness = def.shear_stiffness = variant->stiffness;
        def.bending = bends ? WISP_CLOTH_BENDING_LINKS : WISP_CLOTH_BENDING_NONE;
        return def;
    }
    // the sum is isotropic: every edge has 1 / k
    def.warp_compliance = def.weft_compliance = 1.0f / COMPARE_STRETCH_STIFFNESS;
    def.shear_compliance = 2.0f / COMPARE_STRETCH_STIFFNESS;
    def.bending = bends ? WISP_CLOTH_BENDING_DIHEDRAL : WISP_CLOTH_BENDING_NONE;
    def.bend_rigidity = bends ? (float)scene->rigidity : def.bend_rigidity;
    return def;
}

static wisp_status add_position_based( const compare_scene* scene, const compare_variant* variant,
                                       const wisp_vec3* start, surface_implementation* out )
{
    wisp_surface_def surface = wisp_default_surface_def();
    surface.fabric = out->fabric;
    surface.points = start;
    surface.area_density = TRIANGLE_DENSITY;
    surface.pins = scene->border;
    surface.pin_count = scene->physics.has_ball ? 0 : scene->border_count;
    const wisp_cloth_def cloth = cloth_of( scene, variant );
    wisp_status status = wisp_add_surface( out->world, &surface, &out->entity );
    status = status ? status : wisp_set_gravity( out->world, out->entity, out->generator.gravity );
    status = status ? status : wisp_set_cloth( out->world, out->entity, &cloth );
    status = status ? status : wisp_request( out->world, out->entity, WISP_SURFACE_POINTS );
    return status == WISP_OK && scene->physics.has_ball ? triangle_add_ball( out ) : status;
}

static wisp_status enter_position_based( const compare_scene* scene, wisp_fabric* fabric,
                                         const compare_variant* variant, const wisp_vec3* start, int workers,
                                         surface_implementation* out, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_cloth_module, &wisp_collision_module };
    *out = ( surface_implementation ){ .fabric = fabric,
                                       .generator = surface_default_generator( &wisp_cloth_module, fabric ) };
    out->generator.gravity = ( wisp_vec3 ){ 0.0f, -TRIANGLE_GRAVITY, 0.0f };
    out->generator.seconds = COMPARE_FRAME;
    wisp_world_def def = wisp_default_world_def();
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    def.log = bench_world_drop_log;
    def.workers = workers;
    def.substeps = variant->substeps;
    wisp_status status = wisp_world_create( &def, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_position_based( scene, variant, start, out );
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        surface_implementation_destroy( out );
    }
    return status;
}

static wisp_status enter_implicit( const compare_scene* scene, wisp_fabric* fabric, const compare_variant* variant,
                                   const wisp_vec3* start, int workers, surface_implementation* out,
                                   wisp_error* error )
{
    triangle_setting setting = triangle_default_setting();
    setting.cloth.weights = WISP_IMPLICIT_WEIGHTS_NONE;
    setting.cloth.stretch_stiffness = COMPARE_STRETCH_STIFFNESS;
    setting.cloth.bend_stiffness = scene->physics.bend;
    setting.cloth.link_damping = scene->physics.damping_link;
    setting.cloth.integrator = variant->bdf2 ? WISP_IMPLICIT_BDF2 : WISP_IMPLICIT_EULER;
    setting.cloth.tolerance = variant->tolerance;
    setting.cloth.newton_iterations = variant->repeats;
    setting.seconds = 1.0f / (float)variant->rate;
    setting.workers = workers;
    setting.has_ball = scene->physics.has_ball;
    setting.points = start;
    setting.pins = scene->border;
    setting.pin_count = scene->physics.has_ball ? 0 : scene->border_count;
    triangle_scene base = scene->base;
    base.fabric = fabric;
    return triangle_enter( &base, &setting, out, error );
}

wisp_status compare_enter( const compare_scene* scene, wisp_fabric* fabric, const compare_variant* variant,
                           const wisp_vec3* start, int workers, surface_implementation* out, wisp_error* error )
{
    const bool is_implicit = variant->method == COMPARE_IMPLICIT;
    wisp_status status =
        ( is_implicit ? enter_implicit : enter_position_based )( scene, fabric, variant, start, workers, out, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    out->generator.workers = workers;
    status = wisp_set_damping( out->world, out->entity, scene->physics.damping );
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        surface_implementation_destroy( out );
    }
    return status;
}

// ---- a run ----

typedef struct contest
{
    const compare_plan* plan;
    const compare_scene* scene;
    const compare_reference* reference;
    wisp_fabric* fabric;
    wisp_vec3* start;
    surface_implementation* implementations; // [variant_count][worker_count]
    double* samples[COMPARE_VARIANTS_MAX][COMPARE_WORKERS_MAX];
    int sample_count[COMPARE_VARIANTS_MAX][COMPARE_WORKERS_MAX];
    int sample_room[COMPARE_VARIANTS_MAX][COMPARE_WORKERS_MAX];
    double* points;     // [vertex_count][3] of an observation
    double* velocities; // likewise
    compare_stats* stats;
    results* out;
} contest;

// The limit is included for its error, and is not timed.
static int workers_of( const contest* c, int variant )
{
    return c->plan->variants[variant].is_limit ? 1 : c->plan->worker_count;
}

static surface_implementation* implementation_of( const contest* c, int variant, int worker )
{
    return &c->implementations[variant * c->plan->worker_count + worker];
}

static wisp_status enter_all( contest* c, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < c->plan->variant_count; ++i )
    {
        for ( int w = 0; w < workers_of( c, i ) && status == WISP_OK; ++w )
        {
            status = compare_enter( c->scene, c->fabric, &c->plan->variants[i], c->start, c->plan->workers[w],
                                    implementation_of( c, i, w ), error );
        }
    }
    return status;
}

static void leave_all( contest* c )
{
    for ( int i = 0; i < c->plan->variant_count * c->plan->worker_count; ++i )
    {
        surface_implementation_destroy( &c->implementations[i] );
    }
}

static wisp_status keep_sample( contest* c, int variant, int worker, double ms, wisp_error* error )
{
    int *count = &c->sample_count[variant][worker], *room = &c->sample_room[variant][worker];
    if ( *count == *room )
    {
        const int longer = *room > 0 ? 2 * *room : 256;
        double* samples = realloc( c->samples[variant][worker], (size_t)longer * sizeof( double ) );
        if ( !samples )
        {
            return wisp_fail( error, WISP_NO_MEMORY, "no memory for the samples" );
        }
        c->samples[variant][worker] = samples;
        *room = longer;
    }
    c->samples[variant][worker][( *count )++] = ms;
    return WISP_OK;
}

// On to the next sample. The first step of a turn refills the caches and is not counted.
static wisp_status take_turn( contest* c, int variant, int worker, bool is_timed, wisp_error* error )
{
    surface_implementation* implementation = implementation_of( c, variant, worker );
    const double seconds = (double)implementation->generator.seconds;
    const int steps = (int)lround( (double)COMPARE_OBSERVATION_SECONDS / seconds );
    wisp_status status = WISP_OK;
    for ( int k = 0; k < steps && status == WISP_OK; ++k )
    {
        const double begin = wisp_clock_seconds();
        status = surface_implementation_step( implementation, error );
        const double ms = 1e3 * ( wisp_clock_seconds() - begin ) * (double)COMPARE_FRAME / seconds;
        if ( status == WISP_OK && is_timed && k > 0 )
        {
            status = keep_sample( c, variant, worker, ms, error );
        }
    }
    return status;
}

// ---- samples ----

static wisp_status see( contest* c, surface_implementation* implementation, wisp_error* error )
{
    const wisp_vec3* points;
    wisp_status status = surface_implementation_points( implementation, &points, error );
    for ( int i = 0; i < c->reference->vertex_count && status == WISP_OK; ++i )
    {
        c->points[3 * i] = (double)points[i].x;
        c->points[3 * i + 1] = (double)points[i].y;
        c->points[3 * i + 2] = (double)points[i].z;
    }
    return status;
}

static double square_distance( const contest* c, int observation )
{
    const float* reference = c->reference->points + (size_t)observation * 3 * (size_t)c->reference->vertex_count;
    double sum = 0.0;
    for ( int i = 0; i < 3 * c->reference->vertex_count; ++i )
    {
        const double off = c->points[i] - (double)reference[i];
        sum += off * off;
    }
    return sum / c->reference->vertex_count;
}

static wisp_status observe_path( contest* c, int variant, int observation, wisp_error* error )
{
    compare_stats* stats = &c->stats[variant];
    wisp_status status = see( c, implementation_of( c, variant, 0 ), error );
    const double square = square_distance( c, observation );
    stats->path += square / ( c->scene->physics.observation_count - 1 );
    // not fmax, which would ignore a NaN
    stats->worst = sqrt( square ) <= stats->worst ? stats->worst : sqrt( square );
    return status;
}

static wisp_status observe_rest( contest* c, int variant, wisp_error* error )
{
    surface_implementation* implementation = implementation_of( c, variant, 0 );
    compare_stats* stats = &c->stats[variant];
    wisp_vec3* velocities = malloc( (size_t)c->reference->vertex_count * sizeof( wisp_vec3 ) );
    if ( !velocities )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for velocities" );
    }
    wisp_status status = see( c, implementation, error );
    surface_implementation_velocities( implementation, velocities );
    for ( int i = 0; i < c->reference->vertex_count; ++i )
    {
        c->velocities[3 * i] = (double)velocities[i].x;
        c->velocities[3 * i + 1] = (double)velocities[i].y;
        c->velocities[3 * i + 2] = (double)velocities[i].z;
    }
    free( velocities );
    stats->has_rest = implementation->halted_at == 0;
    stats->rest = compare_observe( c->scene, c->points, c->velocities );
    stats->rest_distance = sqrt( square_distance( c, c->reference->observation_count - 1 ) );
    return status;
}

static wisp_status go_to_rest( contest* c, int variant, wisp_error* error )
{
    const compare_physics* physics = &c->scene->physics;
    const int observations = (int)lround( (double)( physics->rest_seconds / COMPARE_OBSERVATION_SECONDS ) );
    wisp_status status = WISP_OK;
    for ( int k = physics->observation_count - 1; k < observations && status == WISP_OK; ++k )
    {
        status = take_turn( c, variant, 0, false, error );
    }
    return status == WISP_OK ? observe_rest( c, variant, error ) : status;
}

// ---- rounds ----

// Two worker counts, and two rounds, must end with the same bits.
static wisp_status check_hash( contest* c, int variant, int worker, bool is_first, wisp_error* error )
{
    uint64_t hash;
    surface_implementation* implementation = implementation_of( c, variant, worker );
    compare_stats* stats = &c->stats[variant];
    wisp_status status = surface_implementation_hash( implementation, &hash, error );
    if ( status == WISP_OK && is_first && worker == 0 )
    {
        stats->hash = hash;
        stats->halted_at = implementation->halted_at;
    }
    else if ( status == WISP_OK && hash != stats->hash )
    {
        results_add_failure( c->out, "cloth.compare.%s, %s: %d workers give hash %016llx, expected %016llx.",
                             c->scene->physics.name, c->plan->variants[variant].name, c->plan->workers[worker],
                             (unsigned long long)hash, (unsigned long long)stats->hash );
    }
    return status;
}

static wisp_status run_window( contest* c, bool is_first, wisp_error* error )
{
    const compare_physics* physics = &c->scene->physics;
    wisp_status status = WISP_OK;
    for ( int observation = 1; observation < physics->observation_count; ++observation )
    {
        for ( int i = 0; i < c->plan->variant_count && status == WISP_OK; ++i )
        {
            for ( int w = 0; w < workers_of( c, i ) && status == WISP_OK; ++w )
            {
                status = take_turn( c, i, w, observation > physics->timed_observation, error );
            }
            status = status == WISP_OK && is_first ? observe_path( c, i, observation, error ) : status;
        }
    }
    for ( int i = 0; i < c->plan->variant_count; ++i )
    {
        for ( int w = 0; w < workers_of( c, i ) && status == WISP_OK; ++w )
        {
            status = check_hash( c, i, w, is_first, error );
        }
    }
    return status;
}

static wisp_status run_round( contest* c, bool is_first, wisp_error* error )
{
    wisp_status status = enter_all( c, error );
    status = status == WISP_OK ? run_window( c, is_first, error ) : status;
    for ( int i = 0; i < c->plan->variant_count && status == WISP_OK && is_first; ++i )
    {
        if ( c->plan->variants[i].has_rest && c->stats[i].halted_at == 0 )
        {
            status = go_to_rest( c, i, error );
        }
    }
    leave_all( c );
    return status;
}

static void conclude( contest* c )
{
    for ( int i = 0; i < c->plan->variant_count; ++i )
    {
        compare_stats* stats = &c->stats[i];
        const bool is_halted = stats->halted_at > 0;
        stats->path = is_halted ? NAN : sqrt( stats->path );
        stats->worst = is_halted ? NAN : stats->worst;
        for ( int w = 0; w < c->plan->worker_count; ++w )
        {
            stats->ms[w] = stats_summarise( c->samples[i][w], is_halted ? 0 : c->sample_count[i][w] );
        }
    }
}

static wisp_status run_rounds( contest* c, double seconds, wisp_error* error )
{
    const double begin = wisp_clock_seconds();
    wisp_status status = WISP_OK;
    for ( int round = 0; round < c->plan->rounds_max && status == WISP_OK; ++round )
    {
        if ( round > 0 && wisp_clock_seconds() - begin > seconds )
        {
            break;
        }
        status = run_round( c, round == 0, error );
    }
    if ( status == WISP_OK )
    {
        conclude( c );
    }
    return status;
}

static void free_contest( contest* c )
{
    for ( int i = 0; i < c->plan->variant_count * c->plan->worker_count; ++i )
    {
        free( c->samples[i / c->plan->worker_count][i % c->plan->worker_count] );
    }
    wisp_fabric_release( c->fabric );
    free( c->start );
    free( c->implementations );
    free( c->points );
    free( c->velocities );
}

wisp_status compare_scene_run( const compare_plan* plan, const compare_scene* scene,
                               const compare_reference* reference, double seconds, compare_stats* stats, results* out,
                               wisp_error* error )
{
    const size_t n = (size_t)reference->vertex_count,
                 implementations = (size_t)( plan->variant_count * plan->worker_count );
    contest c = { .plan = plan, .scene = scene, .reference = reference, .stats = stats, .out = out };
    c.start = calloc( n, sizeof( wisp_vec3 ) );
    c.implementations = calloc( implementations, sizeof( surface_implementation ) );
    c.points = calloc( n, 3 * sizeof( double ) );
    c.velocities = calloc( n, 3 * sizeof( double ) );
    wisp_status status = WISP_OK;
    if ( !c.start || !c.implementations || !c.points || !c.velocities )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for a comparison of %zu worlds", implementations );
    }
    for ( size_t i = 0; i < n && status == WISP_OK; ++i )
    {
        c.start[i] =
            ( wisp_vec3 ){ reference->points[3 * i], reference->points[3 * i + 1], reference->points[3 * i + 2] };
    }
    status = status == WISP_OK ? compare_cook( scene, &c.fabric, error ) : status;
    status = status == WISP_OK ? run_rounds( &c, seconds, error ) : status;
    free_contest( &c );
    return status;
}
