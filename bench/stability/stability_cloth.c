// Cloth in the matrix: 12 x 12 vertices that hang from two corners, by position-based links and by linear solves.
#include "stability_cloth.h"

#include "boundary/boundary.h"
#include "cloth/cloth.h"
#include "collision/collision.h"
#include "contact/contact.h"
#include "implicit_cloth/implicit_cloth.h"
#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>

#define SHEET_STIFFNESS 200.0f // N/m, default of the implicit cloth

// ---- position-based ----

static wisp_status dress( stability_surface* s, const stability_cloth_plan* plan, const stability_axes* axes,
                          wisp_error* error )
{
    const int way = plan->way;
    wisp_cloth_def def = wisp_default_cloth_def();
    const float soft = axes->stiffness > 0.0f ? 1.0f / axes->stiffness : 0.0f;
    const float h = axes->seconds / (float)plan->substeps, edge = plan->spacing * axes->scale;
    const float mass = plan->density * edge * edge;
    def.solver = way == STABILITY_PBD ? WISP_SOLVER_PBD : WISP_SOLVER_XPBD;
    def.warp_compliance = def.weft_compliance = soft;
    def.shear_compliance = 2.0f * soft;
    // the fraction that one sweep with such a compliance removes
    def.stretch_stiffness = def.shear_stiffness = 2.0f * h * h / ( 2.0f * h * h + soft * mass );
    def.bending = way == STABILITY_XPBD_DIHEDRAL    ? WISP_CLOTH_BENDING_DIHEDRAL
                  : way == STABILITY_XPBD_ISOMETRIC ? WISP_CLOTH_BENDING_ISOMETRIC
                                                    : WISP_CLOTH_BENDING_LINKS;
    def.tethers = way == STABILITY_XPBD_FAR;
    def.level_passes = way == STABILITY_XPBD_FAR ? 1 : 0;
    s->compliance = (double)( way == STABILITY_PBD ? soft : 2.0f * soft );
    const wisp_status status = wisp_set_cloth( s->implementation.world, s->implementation.entity, &def );
    return status == WISP_OK ? WISP_OK : bench_world_fail( s->implementation.world, status, error );
}

// ---- by linear solves ----

static double edge_length( const wisp_fabric* f, const float* x, int a, int b, double* rest )
{
    const float *p = x + 4 * (size_t)a, *q = x + 4 * (size_t)b;
    *rest = stability_distance( f->rest[a], f->rest[b] );
    return stability_distance( ( wisp_vec3 ){ p[0], p[1], p[2] }, ( wisp_vec3 ){ q[0], q[1], q[2] } );
}

// Upper bound before the first step: a diagonal under pressure never stores more than by its initial slope, and no
// link is stiffer than sheet stiffness times area over length squared, which is at most 1 for the two halves of a
// right triangle.
static double energy_from_above( stability_surface* s, double stiffness )
{
    const wisp_fabric* f = s->fabric;
    const float* x =
        wisp_world_column( s->implementation.world, s->implementation.entity, WISP_PARTICLE_POSITION, 0 );
    double sum = 0.0, rest;
    for ( int e = 0; e < f->edge_count; ++e )
    {
        const double error = edge_length( f, x, f->edges[2 * e], f->edges[2 * e + 1], &rest ) - rest;
        sum += error > 0.0 ? 0.5 * stiffness * error * error : 0.0;
    }
    for ( int i = 0; i < f->hinge_count; ++i )
    {
        const double error = edge_length( f, x, f->hinges[4 * i + 2], f->hinges[4 * i + 3], &rest ) - rest;
        sum += error < 0.0 ? 0.5 * stiffness * error * error : 0.0;
    }
    return sum;
}

static double energy_of_springs( stability_surface* s, int frame )
{
    wisp_implicit_cloth_stats stats = { 0 };
    if ( frame == 0 )
    {
        return energy_from_above( s, 2.0 / s->compliance );
    }
    wisp_read_implicit_cloth_stats( s->implementation.world, s->implementation.entity, &stats );
    return stats.stretch_energy + stats.bend_energy;
}

static wisp_status solve( stability_surface* s, int way, const stability_axes* axes, wisp_error* error )
{
    wisp_implicit_cloth_def def = wisp_default_implicit_cloth_def();
    def.stiffness_model = WISP_IMPLICIT_STIFFNESS_MATERIAL;
    def.weights = WISP_IMPLICIT_WEIGHTS_NONE;
    def.stretch_stiffness = axes->stiffness > 0.0f ? axes->stiffness : SHEET_STIFFNESS;
    def.integrator = way == STABILITY_IMPLICIT_BDF2 ? WISP_IMPLICIT_BDF2 : WISP_IMPLICIT_EULER;
    s->slack = true;
    s->stored = energy_of_springs;
    s->is_solved = true;
    s->compliance = 2.0 / (double)def.stretch_stiffness; // open edges have half of it
    wisp_status status = wisp_set_implicit_cloth( s->implementation.world, s->implementation.entity, &def );
    if ( status == WISP_OK )
    {
        status = wisp_request_implicit_cloth_stats( s->implementation.world, s->implementation.entity, true );
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( s->implementation.world, status, error );
}

// ---- both ----

stability_cloth_plan stability_default_cloth_plan( int way )
{
    const bool is_implicit = way == STABILITY_IMPLICIT_EULER || way == STABILITY_IMPLICIT_BDF2;
    return ( stability_cloth_plan ){
        .way = way,
        .side = 12,
        .spacing = 0.05f,
        .density = 0.15f,
        .damping = 4.0f, // a swing of 0.55 m has ended after 5 s
        .substeps = is_implicit ? 2 : 10,
        .iterations = way == STABILITY_XPBD_FOUR ? 4 : 1,
    };
}

static surface_generator generator_of( const stability_cloth_plan* plan, const stability_axes* axes,
                                       const int32_t* pins, int workers )
{
    const bool is_implicit = plan->way == STABILITY_IMPLICIT_EULER || plan->way == STABILITY_IMPLICIT_BDF2;
    surface_generator generator =
        surface_default_generator( is_implicit ? &wisp_implicit_cloth_module : &wisp_cloth_module, NULL );
    // an entity without contact has none of these passes
    generator.second = &wisp_collision_module;
    generator.third = plan->has_boundary ? &wisp_boundary_module : &wisp_contact_module;
    generator.pins = pins;
    generator.pin_count = plan->is_free ? 0 : 2;
    generator.area_density = plan->density;
    generator.gravity = ( wisp_vec3 ){ 0.0f, -STABILITY_GRAVITY, 0.0f };
    generator.damping = plan->damping / sqrtf( axes->scale );
    generator.substeps = plan->substeps;
    generator.iterations = plan->iterations;
    generator.workers = workers;
    return generator;
}

static wisp_status enter_surface( stability_surface* s, const stability_cloth_plan* plan, const stability_axes* axes,
                                  int workers, wisp_error* error )
{
    const int way = plan->way;
    const int32_t pins[2] = { 0, plan->side - 1 };
    const surface_generator generator = generator_of( plan, axes, pins, workers );
    wisp_fabric_def def = wisp_default_fabric_def();
    def.attachments = pins;
    def.attachment_count = generator.pin_count;
    def.tethers = way == STABILITY_XPBD_FAR;
    def.levels = way == STABILITY_XPBD_FAR ? WISP_FABRIC_MAX_LEVELS : 0;
    def.hinges = way == STABILITY_XPBD_DIHEDRAL || way == STABILITY_XPBD_ISOMETRIC;
    def.tile_size = plan->tile_size;
    s->at = plan->at;
    wisp_status status = stability_hanging_mesh( plan->side, plan->spacing * axes->scale, &s->mesh, error );
    if ( status == WISP_OK )
    {
        status = stability_surface_enter( s, &def, generator, axes, error );
        s->implementation.generator.pins = NULL; // owned by this function
    }
    if ( status != WISP_OK )
    {
        return status;
    }
    stability_surface_weigh( s, axes->mass_ratio );
    return way == STABILITY_IMPLICIT_EULER || way == STABILITY_IMPLICIT_BDF2 ? solve( s, way, axes, error )
                                                                             : dress( s, plan, axes, error );
}

wisp_status stability_cloth_enter( const stability_cloth_plan* plan, const stability_axes* axes, int workers,
                                   stability_surface** out, wisp_error* error )
{
    *out = calloc( 1, sizeof( **out ) );
    if ( *out == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a cell" );
    }
    const wisp_status status = enter_surface( *out, plan, axes, workers, error );
    if ( status != WISP_OK )
    {
        stability_surface_close( *out );
        *out = NULL;
    }
    return status;
}

static wisp_status enter( int way, const stability_axes* axes, int workers, stability_trial* out, wisp_error* error )
{
    const stability_cloth_plan plan = stability_default_cloth_plan( way );
    stability_surface* s;
    const wisp_status status = stability_cloth_enter( &plan, axes, workers, &s, error );
    if ( status == WISP_OK )
    {
        *out = stability_surface_trial( s, axes );
    }
    return status;
}

static const stability_subject subjects[] = {
    { "cloth pbd", STABILITY_PBD, enter, true, true, false, 0.0f },
    { "cloth xpbd", STABILITY_XPBD, enter, true, true, true, 0.0f },
    { "cloth xpbd x4", STABILITY_XPBD_FOUR, enter, true, true, false, 0.0f },
    { "cloth xpbd far", STABILITY_XPBD_FAR, enter, true, true, false, 0.0f },
    { "cloth dihedral", STABILITY_XPBD_DIHEDRAL, enter, true, true, true, 0.0f },
    { "cloth isometric", STABILITY_XPBD_ISOMETRIC, enter, true, true, false, 0.0f },
    { "implicit euler", STABILITY_IMPLICIT_EULER, enter, true, true, true, 1e9f },
    { "implicit bdf2", STABILITY_IMPLICIT_BDF2, enter, true, true, false, 1e9f },
};

const stability_subject* stability_cloths( int* count )
{
    *count = WISP_COUNT( subjects );
    return subjects;
}
