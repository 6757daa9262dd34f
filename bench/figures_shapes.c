// Figures 1 to 3: what a projection does, which links there are, and how a body follows its volume.
#include "figures_bench.h"

#include "cloth/cloth.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>

// ---- F1 ----

static const wisp_vec3 triangle_points[] = { { 0.0f, 0.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 0.5f, 0.0f, -0.8f } };
static const int32_t triangle[] = { 0, 1, 2 };

// Only the link between the first two vertices answers; the third makes a triangle of them and stays out of it.
static void leave_two( surface_implementation* implementation, float w0, float w1 )
{
    const wisp_fabric* f = implementation->fabric;
    float* stiffness = wisp_world_column( implementation->world, implementation->entity, WISP_LINK_STIFFNESS, 0 );
    float* position = wisp_world_column( implementation->world, implementation->entity, WISP_PARTICLE_POSITION, 0 );
    int first = 4 * f->vertex_slot[0], second = 4 * f->vertex_slot[1];
    for ( int slot = 0; slot < f->link_order.slot_count; ++slot )
    {
        int a = f->link_a_x4[slot], b = f->link_b_x4[slot];
        bool is_theirs = ( a == first && b == second ) || ( a == second && b == first );
        stiffness[slot] = is_theirs ? 1.0f : 0.0f;
    }
    position[first + 3] = w0;
    position[second + 3] = w1;
}

// @param error_out receives the larger error of length (m) and of the ratio of the two ways
static wisp_status project_pair( float w0, float w1, double* error_out, wisp_error* error )
{
    const wisp_vec3 stretched[] = { { -0.25f, 0.0f, 0.0f }, { 1.25f, 0.0f, 0.0f }, { 0.5f, 0.0f, -0.8f } };
    wisp_fabric_def def = wisp_default_fabric_def();
    def.points = triangle_points;
    def.triangles = triangle;
    def.vertex_count = 3;
    def.triangle_count = 1;
    wisp_fabric* fabric = NULL;
    surface_implementation implementation = { 0 };
    wisp_status status = wisp_fabric_cook( &def, NULL, &fabric, error );
    if ( status == WISP_OK )
    {
        surface_generator generator = surface_default_generator( &wisp_cloth_module, fabric );
        generator.points = stretched;
        generator.vertex_mass = 1.0f;
        status = surface_implementation_create( &generator, &implementation, error );
    }
    if ( status == WISP_OK )
    {
        wisp_cloth_def cloth = wisp_default_cloth_def();
        cloth.solver = WISP_SOLVER_PBD;
        status = wisp_set_cloth( implementation.world, implementation.entity, &cloth );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( implementation.world, status, error );
    }
    const wisp_vec3* points = NULL;
    if ( status == WISP_OK )
    {
        leave_two( &implementation, w0, w1 );
        status = surface_implementation_step( &implementation, error );
        status = status == WISP_OK ? surface_implementation_points( &implementation, &points, error ) : status;
    }
    if ( status == WISP_OK )
    {
        double way0 = (double)( points[0].x - stretched[0].x ), way1 = (double)( stretched[1].x - points[1].x );
        double wrong_length = fabs( (double)( points[1].x - points[0].x ) - 1.0 );
        double wrong_ratio = fabs( way0 * (double)w1 - way1 * (double)w0 );
        *error_out = fmax( *error_out, fmax( wrong_length, wrong_ratio ) );
    }
    surface_implementation_destroy( &implementation );
    wisp_fabric_release( fabric );
    return status;
}

wisp_status figures_two_particles( figures_case* page, wisp_error* error )
{
    static const float weights[][2] = { { 1.0f, 1.0f }, { 1.0f, 3.0f }, { 0.0f, 1.0f } };
    double largest = 0.0;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( weights ) && status == WISP_OK; ++i )
    {
        status = project_pair( weights[i][0], weights[i][1], &largest, error );
    }
    if ( status == WISP_OK )
    {
        // a handful of roundings of coordinates of 1 m
        figures_add( page, "F1", "two particles 1.5 m apart, rest 1 m, w1 : w2 = 1:1, 1:3, 0:1",
                     "one projection restores 1 m, ways in the ratio of w", largest < 1e-6, "largest error %.1e m",
                     largest );
    }
    return status;
}

// ---- F2 ----

wisp_status figures_links( figures_case* page, wisp_error* error )
{
    const wisp_vec3 points[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0.5f, 0, 0.8f }, { 0.5f, 0, -0.8f } };
    const int32_t pair[] = { 0, 2, 1, 0, 1, 3 };
    wisp_fabric_def def = wisp_default_fabric_def();
    def.points = points;
    def.triangles = pair;
    def.vertex_count = 4;
    def.triangle_count = 2;
    wisp_fabric* fabric = NULL;
    wisp_status status = wisp_fabric_cook( &def, NULL, &fabric, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    int bends = fabric->link_count - fabric->edge_count;
    figures_add( page, "F2", "a pair of triangles", "5 structural edges, 1 bend pair",
                 fabric->edge_count == 5 && bends == 1, "%d edges, %d bend pairs", fabric->edge_count, bends );
    wisp_fabric_release( fabric );

    status = surface_cook( &page->figure, wisp_default_fabric_def(), &fabric, error );
    if ( status == WISP_OK )
    {
        bends = fabric->link_count - fabric->edge_count;
        figures_add( page, "F2", "a closed mesh", "edges = 3/2 triangles, as many bend pairs",
                     2 * fabric->edge_count == 3 * fabric->triangle_count && bends == fabric->edge_count,
                     "%d triangles, %d edges, %d bend pairs", fabric->triangle_count, fabric->edge_count, bends );
        wisp_fabric_release( fabric );
    }
    return status;
}

// ---- F3 ----

#define RAMP_STEPS 60
#define SETTLE_STEPS 30

typedef struct volume_run
{
    double error;  // V / V_0 - 1 at the end
    int reversals; // steps in which the volume went against the ramp by more than rounding
} volume_run;

static wisp_status follow_volume( figures_case* page, wisp_fabric* fabric, float gas_ratio, figures_album* album,
                                  volume_run* out, wisp_error* error )
{
    balloon_setting setting = balloon_setting_in_vacuum();
    setting.def.solver = WISP_SOLVER_PBD;
    setting.def.volume = WISP_SOLVER_PBD;
    setting.def.min_gas_ratio = 0.5f;
    setting.damping = 5.0f;
    surface_implementation implementation = { 0 };
    wisp_status status = balloon_implementation_create( fabric, &setting, &implementation, error );
    double rest = balloon_volume( &page->figure, page->figure.points ), before = rest;
    for ( int s = 1; s <= RAMP_STEPS + SETTLE_STEPS && status == WISP_OK; ++s )
    {
        float fraction = fminf( (float)s / RAMP_STEPS, 1.0f );
        status = wisp_set_balloon_gas_ratio( implementation.world, implementation.entity,
                                             1.0f + fraction * ( gas_ratio - 1.0f ) );
        status = status == WISP_OK ? surface_implementation_step( &implementation, error )
                                   : bench_world_fail( implementation.world, status, error );
        const wisp_vec3* points = NULL;
        status = status == WISP_OK ? surface_implementation_points( &implementation, &points, error ) : status;
        if ( status == WISP_OK )
        {
            double now = balloon_volume( &page->figure, points );
            double along = ( now - before ) * ( gas_ratio < 1.0f ? -1.0 : 1.0 );
            out->reversals += s <= RAMP_STEPS && along < -1e-4 * rest;
            before = now;
        }
    }
    out->error = before / ( rest * (double)gas_ratio ) - 1.0;
    status = status == WISP_OK
                 ? figures_take( page, album, &implementation, error, "V0 / V = %.1f", (double)gas_ratio )
                 : status;
    surface_implementation_destroy( &implementation );
    return status;
}

wisp_status figures_fixed_volume( figures_case* page, wisp_error* error )
{
    static const float fills[] = { 0.5f, 1.0f, 1.5f, 2.0f };
    figures_album album = { .mesh = &page->figure };
    wisp_fabric* fabric = NULL;
    wisp_status status = surface_cook( &page->figure, wisp_default_fabric_def(), &fabric, error );
    for ( int i = 0; i < WISP_COUNT( fills ) && status == WISP_OK; ++i )
    {
        volume_run run = { 0.0, 0 };
        char experiment[80];
        status = follow_volume( page, fabric, fills[i], &album, &run, error );
        snprintf( experiment, sizeof( experiment ), "the %s led to %.1f of its volume in 1 s", page->figure_name,
                  (double)fills[i] );
        if ( status == WISP_OK )
        {
            figures_add( page, "F3", experiment, "V within 1 % of V_0, never against the ramp",
                         fabs( run.error ) < 0.01 && run.reversals == 0, "V / V_0 - 1 = %.4f %%, %d steps against it",
                         100.0 * run.error, run.reversals );
        }
    }
    status = status == WISP_OK ? figures_write( page, &album, NULL, "f3_volume", "F3, shrinking and swelling", error )
                               : status;
    figures_album_free( &album );
    wisp_fabric_release( fabric );
    return status;
}
