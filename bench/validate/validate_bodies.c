#include "validate_bodies.h"

#include "cloth/cloth.h"
#include "implicit_cloth/implicit_cloth.h"
#include "wisp/fabric.h"
#include "wisp/maps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char* const validate_solver_names[VALIDATE_SOLVER_COUNT] = { "rod", "dihedral", "isometric", "implicit" };

// Of a rod kg/m, of a strip kg/m^2. What is shown has no unit, so they only keep numbers ordinary.
static const double LINE_DENSITY = 0.01, AREA_DENSITY = 0.15;

enum
{
    STRIP_ITERATIONS = 8, // of cloth: links along a clamped strip converge slowly
};

// Where the free part of a body starts aside: the first two cells are straight, so that the clamp is.
static float aside( const validate_def* def, int cell )
{
    const double s = (double)cell / def->cells - 2.0 / def->cells;
    return s > 0.0 ? (float)( def->lateral * VALIDATE_LENGTH * s * s ) : 0.0f;
}

double validate_start( const validate_def* def )
{
    return (double)aside( def, def->cells );
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
        points[i] = ( wisp_vec3 ){ (float)( cell * i ), aside( def, i ), 0.0f };
        masses[i] = (float)( LINE_DENSITY * cell );
    }
    masses[def->cells] = (float)( LINE_DENSITY * ( 0.5 * cell + def->tip * VALIDATE_LENGTH ) );
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.rest = WISP_STRAND_REST_STRAIGHT;
    dynamics.line_density = (float)LINE_DENSITY;
    dynamics.vertex_masses = def->tip > 0.0 ? masses : NULL;
    dynamics.bend_rigidity =
        (float)( LINE_DENSITY * VALIDATE_GRAVITY * pow( VALIDATE_LENGTH, 3.0 ) / def->loads[body] );
    dynamics.twist_rigidity = dynamics.bend_rigidity;
    dynamics.damping = (float)def->damping;
    dynamics.gravity = def->gravity;
    if ( def->is_blade )
    {
        dynamics.edgewise_rigidity = 1000.0f * dynamics.bend_rigidity;
        dynamics.flat_normal = ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f };
    }
    return validate_add_strands( b, 1, points, &dynamics, error );
}

// ---- strips ----

// A row of square cells with diagonals in turn. The first cell is pinned, and the strip begins where it ends.
static wisp_status cook_strip( const validate_def* def, wisp_fabric** out, wisp_error* error )
{
    const int columns = def->cells + 2;
    const float a = (float)( VALIDATE_LENGTH / def->cells );
    wisp_vec3 points[2 * ( VALIDATE_MAX_CELLS + 2 )];
    int32_t triangles[6 * ( VALIDATE_MAX_CELLS + 1 )];
    for ( int i = 0; i < columns; ++i )
    {
        points[i] = ( wisp_vec3 ){ a * (float)( i - 1 ), 0.0f, -0.5f * a };
        points[columns + i] = ( wisp_vec3 ){ a * (float)( i - 1 ), 0.0f, 0.5f * a };
    }
    for ( int i = 0; i + 1 < columns; ++i )
    {
        const int p = i, q = i + 1, r = columns + i, s = r + 1;
        const int32_t falling[] = { p, r, s, p, s, q }, rising[] = { p, r, q, q, r, s };
        memcpy( triangles + 6 * i, i % 2 == 0 ? falling : rising, sizeof falling );
    }
    wisp_fabric_def fabric = wisp_default_fabric_def();
    fabric.points = points;
    fabric.vertex_count = 2 * columns;
    fabric.triangles = triangles;
    fabric.triangle_count = 2 * ( columns - 1 );
    fabric.hinges = true;
    fabric.bend_links = def->solver == VALIDATE_IMPLICIT;
    return wisp_fabric_cook( &fabric, NULL, out, error );
}

static wisp_status set_material( validate_bodies* b, wisp_entity strip, int body )
{
    const validate_def* def = &b->def;
    const float rigidity =
        (float)( AREA_DENSITY * VALIDATE_GRAVITY * pow( VALIDATE_LENGTH, 3.0 ) / def->loads[body] );
    if ( def->solver == VALIDATE_IMPLICIT )
    {
        wisp_implicit_cloth_def cloth = wisp_default_implicit_cloth_def();
        cloth.stiffness_model = WISP_IMPLICIT_STIFFNESS_MATERIAL;
        cloth.weights = WISP_IMPLICIT_WEIGHTS_PAIR;
        cloth.bend_rigidity = rigidity;
        cloth.stretch_stiffness = 2000.0f;
        cloth.integrator = WISP_INTEGRATOR_BDF2;
        cloth.damping_form = WISP_IMPLICIT_DAMPING_AXIAL;
        return wisp_set_implicit_cloth( b->world.world, strip, &cloth );
    }
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = def->solver == VALIDATE_DIHEDRAL ? WISP_CLOTH_BENDING_DIHEDRAL : WISP_CLOTH_BENDING_ISOMETRIC;
    cloth.bend_rigidity = rigidity;
    return wisp_set_cloth( b->world.world, strip, &cloth );
}

// A mass at the free end, in equal parts of both corners, one of which is of one triangle and the other of two.
static wisp_status load_tip( validate_bodies* b, wisp_entity strip )
{
    const int columns = b->def.cells + 2;
    const double cell = VALIDATE_LENGTH / b->def.cells, triangle = cell * cell / 2.0;
    // squares with an even number have a falling diagonal, whose end is at the second row
    const int more = b->def.cells % 2 == 0 ? 2 * columns - 1 : columns - 1;
    float factors[2 * ( VALIDATE_MAX_CELLS + 2 )];
    for ( int i = 0; i < 2 * columns; ++i )
    {
        const double own = ( i == more ? 2.0 : 1.0 ) * triangle / 3.0;
        const double added = i % columns == columns - 1 ? 0.5 * b->def.tip * cell * VALIDATE_LENGTH : 0.0;
        factors[i] = (float)( 1.0 + added / own );
    }
    return wisp_set_map( b->world.world, strip, WISP_MAP_AREA_DENSITY, factors, 2 * columns );
}

static wisp_status add_strip( validate_bodies* b, wisp_fabric* fabric, int body, wisp_error* error )
{
    const int columns = b->def.cells + 2;
    const int32_t pins[] = { 0, 1, columns, columns + 1 };
    wisp_vec3 points[2 * ( VALIDATE_MAX_CELLS + 2 )];
    const float a = (float)( VALIDATE_LENGTH / b->def.cells );
    for ( int i = 0; i < 2 * columns; ++i )
    {
        const int column = i % columns;
        points[i] = ( wisp_vec3 ){ a * (float)( column - 1 ), aside( &b->def, column - 1 ),
                                   i < columns ? -0.5f * a : 0.5f * a };
    }
    wisp_surface_def surface = wisp_default_surface_def();
    surface.fabric = fabric;
    surface.points = points;
    surface.area_density = (float)AREA_DENSITY;
    surface.pins = pins;
    surface.pin_count = WISP_COUNT( pins );
    surface.gravity = b->def.gravity;
    wisp_entity strip;
    wisp_status status = wisp_add_surface( b->world.world, &surface, &strip );
    status = status == WISP_OK ? wisp_set_damping( b->world.world, strip, (float)b->def.damping ) : status;
    status = status == WISP_OK ? set_material( b, strip, body ) : status;
    status = status == WISP_OK && b->def.tip > 0.0 ? load_tip( b, strip ) : status;
    status = status == WISP_OK ? validate_world_add( &b->world, strip, WISP_SURFACE_POINTS, 2 * columns ) : status;
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

// ---- all of them ----

wisp_status validate_open( const validate_def* def, validate_bodies* out, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_strands_module, &wisp_cloth_module,
                                                  &wisp_implicit_cloth_module };
    *out = ( validate_bodies ){ .def = *def };
    const bool is_cloth = def->solver == VALIDATE_DIHEDRAL || def->solver == VALIDATE_ISOMETRIC;
    const int needed = is_cloth ? STRIP_ITERATIONS : 1;
    const bench_world_def world = { modules, WISP_COUNT( modules ), def->workers, def->substeps,
                                    def->iterations > 0 ? def->iterations : needed };
    return validate_world_create( &world, &out->world, error );
}

wisp_status validate_create( const validate_def* def, validate_bodies* out, wisp_error* error )
{
    wisp_fabric* fabric = NULL;
    wisp_status status = validate_open( def, out, error );
    status = status == WISP_OK && def->solver != VALIDATE_ROD ? cook_strip( def, &fabric, error ) : status;
    for ( int i = 0; i < def->count && status == WISP_OK; ++i )
    {
        status = def->solver == VALIDATE_ROD ? add_rod( out, i, error ) : add_strip( out, fabric, i, error );
    }
    wisp_fabric_release( fabric );
    return status;
}

void validate_release( validate_bodies* b )
{
    validate_world_release( &b->world );
}

wisp_status validate_step( validate_bodies* b, int steps, accuracy_run* out, wisp_error* error )
{
    return validate_world_step( &b->world, steps, out, error );
}

wisp_status validate_step_for( validate_bodies* b, double seconds, accuracy_run* out, wisp_error* error )
{
    return validate_step( b, validate_steps( seconds ), out, error );
}

wisp_status validate_tip( validate_bodies* b, int body, wisp_vec3* out, wisp_error* error )
{
    const bool is_rod = b->def.solver == VALIDATE_ROD;
    const int count = b->world.bodies[body].vertex_count;
    const wisp_vec3* points = NULL;
    const wisp_status status = validate_world_points( &b->world, body, &points, error );
    if ( status == WISP_OK )
    {
        const wisp_vec3 p = points[count - 1], q = is_rod ? p : points[count / 2 - 1];
        *out = ( wisp_vec3 ){ 0.5f * ( p.x + q.x ), 0.5f * ( p.y + q.y ), 0.5f * ( p.z + q.z ) };
    }
    return status;
}

wisp_status validate_finish( validate_bodies* b, accuracy_run* out, wisp_error* error )
{
    return validate_world_finish( &b->world, out, error );
}
