#include "validate_bodies.h"

#include "validate_floors.h"
#include "validate_strips.h"

#include "cloth/cloth.h"
#include "collision/collision.h"
#include "implicit_cloth/implicit_cloth.h"

#include <math.h>

const char* const validate_solver_names[VALIDATE_SOLVER_COUNT] = { "rod", "dihedral", "isometric", "implicit" };

// kg/m. What is shown has no unit, so it only keeps numbers ordinary.
static const double LINE_DENSITY = 0.01;

enum
{
    STRIP_ITERATIONS = 8, // of cloth: links along a clamped strip converge slowly
};

// Where the free part of a body starts aside, x in lengths: the first two cells are straight, so that the clamp is.
static double aside( const validate_def* def, double x )
{
    const double s = x - 2.0 / def->cells;
    return s > 0.0 ? def->lateral * VALIDATE_LENGTH * s * s : 0.0;
}

double validate_start( const validate_def* def )
{
    return (double)(float)aside( def, 1.0 );
}

// Points before the clamp and beside a shape are straight.
wisp_vec3 validate_start_of( const validate_def* def, int body, int cell, double x )
{
    const double length = VALIDATE_LENGTH;
    if ( def->shapes != NULL && cell >= 0 )
    {
        const validate_point p = def->shapes[body * ( def->cells + 1 ) + cell];
        return ( wisp_vec3 ){ (float)( length * p.x ), (float)( length * p.y ), 0.0f };
    }
    return ( wisp_vec3 ){ (float)( length * x ), (float)aside( def, x ), 0.0f };
}

double validate_frequency( double load )
{
    return 3.516 * sqrt( VALIDATE_GRAVITY / ( load * VALIDATE_LENGTH ) );
}

// ---- rods ----

wisp_status validate_add_strands( validate_bodies* b, int strand_count, const wisp_vec3* points,
                                  const wisp_strand_dynamics_def* dynamics, wisp_error* error )
{
    int32_t offsets[VALIDATE_MAX_BODIES + 1];
    for ( int i = 0; i <= strand_count; ++i )
    {
        offsets[i] = i * ( b->def.cells + 1 );
    }
    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = points;
    strands.offsets = offsets;
    strands.strand_count = strand_count;
    wisp_entity rod;
    wisp_status status = wisp_add_strands( b->world.world, &strands, &rod );
    status = status == WISP_OK ? wisp_set_strand_dynamics( b->world.world, rod, dynamics ) : status;
    status =
        status == WISP_OK ? validate_world_add( &b->world, rod, WISP_STRAND_POINTS, offsets[strand_count] ) : status;
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

static wisp_status add_rod( validate_bodies* b, int body, wisp_error* error )
{
    const validate_def* def = &b->def;
    const double cell = VALIDATE_LENGTH / def->cells;
    wisp_vec3 points[VALIDATE_MAX_CELLS + 1];
    float masses[VALIDATE_MAX_CELLS + 1];
    for ( int i = 0; i <= def->cells; ++i )
    {
        points[i] = validate_start_of( def, body, i, (double)i / def->cells );
        masses[i] = (float)( LINE_DENSITY * cell );
    }
    masses[def->cells] = (float)( LINE_DENSITY * ( 0.5 * cell + def->tip * VALIDATE_LENGTH ) );
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.rest = def->is_curled ? WISP_STRAND_REST_SHAPE : WISP_STRAND_REST_STRAIGHT;
    dynamics.line_density = (float)LINE_DENSITY;
    dynamics.vertex_masses = def->tip > 0.0 ? masses : NULL;
    dynamics.bend_rigidity =
        (float)( LINE_DENSITY * VALIDATE_GRAVITY * pow( VALIDATE_LENGTH, 3.0 ) / def->loads[body] );
    dynamics.twist_rigidity = (float)( def->twist_ratio > 0.0 ? def->twist_ratio : 1.0 ) * dynamics.bend_rigidity;
    dynamics.damping = (float)def->damping;
    dynamics.gravity = def->gravity;
    if ( def->is_blade )
    {
        dynamics.edgewise_rigidity = 1000.0f * dynamics.bend_rigidity;
        dynamics.flat_normal = ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f };
    }
    return validate_add_strands( b, 1, points, &dynamics, error );
}

static wisp_status add_rods( validate_bodies* b, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < b->def.count && status == WISP_OK; ++i )
    {
        status = add_rod( b, i, error );
    }
    return status;
}

// ---- all of them ----

wisp_status validate_open( const validate_def* def, validate_bodies* out, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_strands_module, &wisp_cloth_module,
                                                  &wisp_implicit_cloth_module, &wisp_collision_module };
    *out = ( validate_bodies ){ .def = *def };
    const bool is_cloth = def->solver == VALIDATE_DIHEDRAL || def->solver == VALIDATE_ISOMETRIC;
    const int needed = is_cloth ? STRIP_ITERATIONS : 1;
    // without floors there is no collision either, as in a world of a user who has none
    const int module_count = WISP_COUNT( modules ) - ( def->floors != NULL ? 0 : 1 );
    const bench_world_def world = { modules, module_count, def->workers, def->substeps,
                                    def->iterations > 0 ? def->iterations : needed };
    return validate_world_create( &world, &out->world, error );
}

wisp_status validate_create( const validate_def* def, validate_bodies* out, wisp_error* error )
{
    wisp_status status = validate_open( def, out, error );
    if ( status == WISP_OK )
    {
        status = def->solver == VALIDATE_ROD ? add_rods( out, error ) : validate_add_sheets( out, error );
    }
    return status == WISP_OK && def->floors != NULL ? validate_add_floors( out, error ) : status;
}

void validate_release( validate_bodies* b )
{
    validate_world_release( &b->world );
}

wisp_status validate_step( validate_bodies* b, int steps, accuracy_run* out, wisp_error* error )
{
    return validate_world_step( &b->world, steps, out, error );
}

wisp_status validate_turn_gravity( validate_bodies* b, wisp_vec3 gravity, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < b->def.count && status == WISP_OK; ++i )
    {
        status = wisp_set_strand_gravity( b->world.world, b->world.bodies[i].entity, gravity );
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

wisp_status validate_step_for( validate_bodies* b, double seconds, accuracy_run* out, wisp_error* error )
{
    return validate_step( b, validate_steps( seconds ), out, error );
}

wisp_status validate_damp( validate_bodies* b, double damping, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < b->def.count && status == WISP_OK; ++i )
    {
        status = wisp_set_damping( b->world.world, b->world.bodies[i].entity, (float)damping );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
    }
    return status;
}

wisp_status validate_tip( validate_bodies* b, int body, wisp_vec3* out, wisp_error* error )
{
    const bool is_rod = b->def.solver == VALIDATE_ROD;
    const int count = b->world.bodies[body].vertex_count;
    const wisp_vec3* points = NULL;
    const wisp_status status = validate_world_points( &b->world, body, &points, error );
    if ( status == WISP_OK )
    {
        // the last vertices of the last row and of the first
        const wisp_vec3 p = points[count - 1], q = is_rod ? p : points[b->def.cells + 1];
        *out = ( wisp_vec3 ){ 0.5f * ( p.x + q.x ), 0.5f * ( p.y + q.y ), 0.5f * ( p.z + q.z ) };
    }
    return status;
}

wisp_status validate_aside( validate_bodies* b, int body, double* out, wisp_error* error )
{
    const int count = b->world.bodies[body].vertex_count;
    const wisp_vec3* points = NULL;
    const wisp_status status = validate_world_points( &b->world, body, &points, error );
    double sum = 0.0;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        sum += (double)points[i].y * (double)points[i].y;
    }
    *out = sqrt( sum / count );
    return status;
}

wisp_status validate_finish( validate_bodies* b, accuracy_run* out, wisp_error* error )
{
    return validate_world_finish( &b->world, out, error );
}
