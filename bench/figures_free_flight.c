// Noh and Jung, section 3.3: a cloth that is stretched, spins and flies free. What is conserved is the energy of the
// rows: their masses, the stretch of eq. 5 and the potential of eq. 12. The implicit step and damping may only take
// from it.
#include "figures_drape.h"

#include "cells.h"

#include "oracle/triangle_oracle.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>

enum
{
    SECONDS = 10,
    QUICK_VERTICES = 250,
};

#define STRETCHED 1.1f
// Allowed rise above the least energy so far. Against the first nothing could rise: three quarters of it go in one step.
#define GROWTH_ALLOWED 0.01

static const wisp_vec3 spin = { 1.0f, 4.0f, 0.5f }; // rad/s

typedef struct flight
{
    float damping; // N s/m
    float seconds; // a step
    wisp_integrator integrator;
    double first, last;           // J, before and at the end
    double growth;                // the most that it ever was above the least before, as a fraction of that
    double observations[SECONDS]; // J, after each second
    double iterations, solves;    // a step, mean
    bool is_finite;
} flight;

typedef struct free_cloth
{
    triangle_scene scene;
    wisp_vec3* stretched; // [vertex_count]
    double* fraction;     // [vertex_count] of a row's mass in the vertex's
} free_cloth;

// ---- the masses of the rows ----

static wisp_status count_neighbours( const wisp_mesh* mesh, double* fraction, wisp_error* error )
{
    const size_t count = (size_t)mesh->vertex_count;
    double3* points = malloc( count * sizeof( double3 ) );
    double* masses = malloc( count * sizeof( double ) );
    wisp_status status = WISP_OK;
    if ( points == NULL || masses == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for a cloth that flies" );
    }
    else
    {
        for ( size_t i = 0; i < count; ++i )
        {
            points[i] =
                ( double3 ){ (double)mesh->points[i].x, (double)mesh->points[i].y, (double)mesh->points[i].z };
            masses[i] = 1.0;
        }
        const triangle_oracle_params params = triangle_oracle_default_params();
        const triangle_oracle_def def = {
            .count = mesh->vertex_count,
            .points = points,
            .triangle_count = mesh->triangle_count,
            .triangles = mesh->triangles,
            .masses = masses,
        };
        triangle_oracle oracle = triangle_oracle_create( &def, &params );
        for ( size_t i = 0; i < count; ++i )
        {
            fraction[i] = oracle.mass[i];
        }
        triangle_oracle_destroy( &oracle );
    }
    free( points );
    free( masses );
    return status;
}

static double kinetic_energy( surface_implementation* implementation, const double* fraction )
{
    const wisp_fabric* fabric = implementation->fabric;
    const float* position =
        wisp_world_column( implementation->world, implementation->entity, WISP_PARTICLE_POSITION, 0 );
    const float* velocity =
        wisp_world_column( implementation->world, implementation->entity, WISP_PARTICLE_VELOCITY, 0 );
    double sum = 0.0;
    for ( int i = 0; i < fabric->vertex_count; ++i )
    {
        const size_t row = 4 * (size_t)fabric->vertex_slot[i];
        const double v[3] = { (double)velocity[row], (double)velocity[row + 1], (double)velocity[row + 2] };
        sum += 0.5 * fraction[i] / (double)position[row + 3] * ( v[0] * v[0] + v[1] * v[1] + v[2] * v[2] );
    }
    return sum;
}

// Every edge is a tenth longer than at rest, so that no diagonal bends.
static double stretch_energy_at_first( const wisp_fabric* fabric, double stiffness )
{
    double sum = 0.0;
    for ( int e = 0; e < fabric->edge_count; ++e )
    {
        const wisp_vec3 a = fabric->rest[fabric->edges[2 * e]], b = fabric->rest[fabric->edges[2 * e + 1]];
        const double d[3] = { (double)a.x - (double)b.x, (double)a.y - (double)b.y, (double)a.z - (double)b.z };
        const double over = (double)STRETCHED - 1.0;
        sum += 0.5 * stiffness * over * over * ( d[0] * d[0] + d[1] * d[1] + d[2] * d[2] );
    }
    return sum;
}

// ---- flights ----

static wisp_status advance( surface_implementation* implementation, const double* fraction, flight* f,
                            wisp_error* error )
{
    const int steps = (int)lrint( SECONDS / (double)f->seconds );
    double least = f->first;
    for ( int step = 1; step <= steps; ++step )
    {
        wisp_implicit_cloth_stats seen;
        wisp_status status = surface_implementation_step( implementation, error );
        if ( status != WISP_OK )
        {
            return status;
        }
        status = wisp_read_implicit_cloth_stats( implementation->world, implementation->entity, &seen );
        if ( status != WISP_OK )
        {
            return bench_world_fail( implementation->world, status, error );
        }
        f->last = kinetic_energy( implementation, fraction ) + seen.stretch_energy + seen.bend_energy;
        f->growth = fmax( f->growth, f->last / least - 1.0 );
        least = fmin( least, f->last );
        f->is_finite = f->is_finite && isfinite( f->last ) && implementation->halted_at == 0;
        f->iterations += (double)seen.iterations / steps;
        f->solves += (double)seen.newton_iterations / steps;
        if ( step * SECONDS % steps == 0 )
        {
            f->observations[step * SECONDS / steps - 1] = f->last;
        }
    }
    return WISP_OK;
}

static wisp_status fly( const free_cloth* cloth, flight* f, wisp_error* error )
{
    f->is_finite = true;
    triangle_setting setting = triangle_default_setting();
    setting.cloth.link_damping = f->damping;
    setting.cloth.integrator = f->integrator;
    setting.seconds = f->seconds;
    setting.has_ball = false;
    setting.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    setting.points = cloth->stretched;
    setting.requests_stats = true;
    surface_implementation implementation;
    wisp_status status = triangle_enter( &cloth->scene, &setting, &implementation, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status =
        wisp_set_velocity( implementation.world, implementation.entity, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, spin );
    if ( status == WISP_OK )
    {
        f->first = kinetic_energy( &implementation, cloth->fraction ) +
                   stretch_energy_at_first( cloth->scene.fabric, (double)setting.cloth.stretch_stiffness );
        status = advance( &implementation, cloth->fraction, f, error );
    }
    else
    {
        bench_world_fail( implementation.world, status, error );
    }
    surface_implementation_destroy( &implementation );
    return status;
}

static void free_cloth_free( free_cloth* cloth )
{
    free( cloth->stretched );
    free( cloth->fraction );
    triangle_scene_free( &cloth->scene );
}

static wisp_status free_cloth_make( int vertices, free_cloth* out, wisp_error* error )
{
    *out = ( free_cloth ){ .stretched = NULL };
    wisp_status status = triangle_scene_make( vertices, &out->scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const wisp_mesh* mesh = &out->scene.mesh;
    out->stretched = malloc( (size_t)mesh->vertex_count * sizeof( wisp_vec3 ) );
    out->fraction = malloc( (size_t)mesh->vertex_count * sizeof( double ) );
    if ( out->stretched == NULL || out->fraction == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for a cloth that flies" );
    }
    else
    {
        for ( int i = 0; i < mesh->vertex_count; ++i )
        {
            const wisp_vec3 p = mesh->points[i];
            out->stretched[i] = ( wisp_vec3 ){ STRETCHED * p.x, p.y, STRETCHED * p.z };
        }
        status = count_neighbours( mesh, out->fraction, error );
    }
    if ( status != WISP_OK )
    {
        free_cloth_free( out );
    }
    return status;
}

// ---- the page ----

enum
{
    EULER_COUNT = 4, // the first flights: in steps of the paper, with more and more damping
    QUICK_COUNT = 6,
    FLIGHT_COUNT = 8,
};

static int begin_table( figures_case* page )
{
    cells header = { .count = 0 };
    cells_put( &header, "k_d N s/m" );
    cells_put( &header, "step s" );
    cells_put( &header, "integrator" );
    cells_put( &header, "first J" );
    for ( int i = 1; i <= SECONDS; i += 3 )
    {
        cells_put( &header, "%d s", i );
    }
    cells_put( &header, "growth %%" );
    cells_put( &header, "solves" );
    cells_put( &header, "iterations" );
    return cells_begin_table( &header, "Noh and Jung 3.3: energy in free flight, J", page->out );
}

static void add_line( figures_case* page, int table, const flight* f )
{
    cells row = { .count = 0 };
    cells_put( &row, "%g", (double)f->damping );
    cells_put( &row, "%g", (double)f->seconds );
    cells_put( &row, "%s", f->integrator == WISP_INTEGRATOR_EULER ? "Euler" : "BDF2" );
    cells_put_number( &row, f->first, 3 );
    for ( int i = 1; i <= SECONDS; i += 3 )
    {
        cells_put( &row, "%.2e", f->observations[i - 1] );
    }
    cells_put_number( &row, 100.0 * f->growth, 2 );
    cells_put_number( &row, f->solves, 2 );
    cells_put_number( &row, f->iterations, 1 );
    cells_end_row( &row, table, page->out );
}

static void add_row( figures_case* page, int vertices, const flight* flights, int count )
{
    int worst = 0;
    bool is_finite = true, falls_faster = true;
    for ( int i = 0; i < count; ++i )
    {
        is_finite = is_finite && flights[i].is_finite;
        worst = flights[i].growth > flights[worst].growth ? i : worst;
        falls_faster = falls_faster && ( i == 0 || i >= EULER_COUNT || flights[i].last < flights[i - 1].last );
    }
    const flight* f = &flights[worst];
    char experiment[120];
    snprintf( experiment, sizeof( experiment ),
              "%d vertices stretched by 10 %%, spinning, free for 10 s, k_d 0 to 0.2, Euler and BDF2", vertices );
    figures_add( page, "Noh and Jung, sect. 3.3", experiment,
                 "energy never 1 % above its least so far; less is left with more damping",
                 is_finite && f->growth <= GROWTH_ALLOWED && falls_faster,
                 "at most %+.2f %% (k_d %g, steps of %g s, %s); %.1e, %.1e, %.1e, %.1e of the first left",
                 100.0 * f->growth, (double)f->damping, (double)f->seconds,
                 f->integrator == WISP_INTEGRATOR_EULER ? "Euler" : "BDF2", flights[0].last / flights[0].first,
                 flights[1].last / flights[1].first, flights[2].last / flights[2].first,
                 flights[3].last / flights[3].first );
}

wisp_status figures_free_flight( figures_case* page, wisp_error* error )
{
    flight flights[FLIGHT_COUNT] = {
        { .damping = 0.0f, .seconds = 0.01f, .integrator = WISP_INTEGRATOR_EULER },
        { .damping = 0.002f, .seconds = 0.01f, .integrator = WISP_INTEGRATOR_EULER },
        { .damping = 0.02f, .seconds = 0.01f, .integrator = WISP_INTEGRATOR_EULER },
        { .damping = 0.2f, .seconds = 0.01f, .integrator = WISP_INTEGRATOR_EULER },
        { .damping = 0.0f, .seconds = 0.01f, .integrator = WISP_INTEGRATOR_BDF2 },
        { .damping = 0.002f, .seconds = 0.01f, .integrator = WISP_INTEGRATOR_BDF2 },
        { .damping = 0.02f, .seconds = 0.01f, .integrator = WISP_INTEGRATOR_BDF2 },
        { .damping = 0.002f, .seconds = 0.0025f, .integrator = WISP_INTEGRATOR_EULER },
    };
    const int vertices = page->quick ? QUICK_VERTICES : TRIANGLE_VERTICES;
    free_cloth cloth;
    wisp_status status = free_cloth_make( vertices, &cloth, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const int table = begin_table( page );
    const int count = page->quick ? QUICK_COUNT : FLIGHT_COUNT;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        status = fly( &cloth, &flights[i], error );
        if ( status == WISP_OK )
        {
            add_line( page, table, &flights[i] );
        }
    }
    if ( status == WISP_OK )
    {
        add_row( page, vertices, flights, count );
        results_add_note( page->out,
                          "Noh and Jung, section 3.3, energy: kinetic with the masses of the rows, stretch (eq. 5) "
                          "and bend (eq. 12). growth: above the least so far. solves and iterations: per step." );
    }
    free_cloth_free( &cloth );
    return status;
}
