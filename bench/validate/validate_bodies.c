#include "validate_bodies.h"

#include "bench_world.h"

#include "cloth/cloth.h"
#include "collision/collision.h"
#include "implicit_cloth/implicit_cloth.h"
#include "strands/strands.h"
#include "wisp/fabric.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char* const validate_solver_names[VALIDATE_SOLVER_COUNT] = { "rod", "dihedral", "isometric", "implicit" };

// Of a rod kg/m, of a strip kg/m^2. What is shown has no unit, so they only keep numbers ordinary.
static const double LINE_DENSITY = 0.01, AREA_DENSITY = 0.15;
static const float SECONDS = 1.0f / 60.0f;

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

// A point of the centre line, m. Points before the clamp and beside a shape are straight.
static wisp_vec3 start_of( const validate_def* def, int body, int cell )
{
    const double length = VALIDATE_LENGTH;
    if ( def->shapes != NULL && cell >= 0 )
    {
        const validate_point p = def->shapes[body * ( def->cells + 1 ) + cell];
        return ( wisp_vec3 ){ (float)( length * p.x ), (float)( length * p.y ), 0.0f };
    }
    return ( wisp_vec3 ){ (float)( length * cell / def->cells ), aside( def, cell ), 0.0f };
}

// ---- rods ----

static wisp_status add_rod( validate_bodies* b, int body )
{
    const validate_def* def = &b->def;
    wisp_vec3 points[VALIDATE_MAX_CELLS + 1];
    const int32_t offsets[2] = { 0, def->cells + 1 };
    for ( int i = 0; i <= def->cells; ++i )
    {
        points[i] = start_of( def, body, i );
    }
    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = points;
    strands.offsets = offsets;
    strands.strand_count = 1;
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.rest = def->is_curled ? WISP_STRAND_REST_SHAPE : WISP_STRAND_REST_STRAIGHT;
    dynamics.line_density = (float)LINE_DENSITY;
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
    wisp_status status = wisp_add_strands( b->world, &strands, b->bodies + body );
    status = status == WISP_OK ? wisp_set_strand_dynamics( b->world, b->bodies[body], &dynamics ) : status;
    return status == WISP_OK ? wisp_request( b->world, b->bodies[body], WISP_STRAND_POINTS ) : status;
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

static wisp_status set_material( validate_bodies* b, int body )
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
        return wisp_set_implicit_cloth( b->world, b->bodies[body], &cloth );
    }
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = def->solver == VALIDATE_DIHEDRAL ? WISP_CLOTH_BENDING_DIHEDRAL : WISP_CLOTH_BENDING_ISOMETRIC;
    cloth.bend_rigidity = rigidity;
    return wisp_set_cloth( b->world, b->bodies[body], &cloth );
}

static wisp_status add_strip( validate_bodies* b, wisp_fabric* fabric, int body )
{
    const int columns = b->def.cells + 2;
    const int32_t pins[] = { 0, 1, columns, columns + 1 };
    wisp_vec3 points[2 * ( VALIDATE_MAX_CELLS + 2 )];
    const float a = (float)( VALIDATE_LENGTH / b->def.cells );
    for ( int i = 0; i < 2 * columns; ++i )
    {
        points[i] = start_of( &b->def, body, i % columns - 1 );
        points[i].z = i < columns ? -0.5f * a : 0.5f * a;
    }
    wisp_surface_def surface = wisp_default_surface_def();
    surface.fabric = fabric;
    surface.points = points;
    surface.area_density = (float)AREA_DENSITY;
    surface.pins = pins;
    surface.pin_count = WISP_COUNT( pins );
    surface.gravity = b->def.gravity;
    wisp_status status = wisp_add_surface( b->world, &surface, b->bodies + body );
    status = status == WISP_OK ? wisp_set_damping( b->world, b->bodies[body], (float)b->def.damping ) : status;
    status = status == WISP_OK ? set_material( b, body ) : status;
    return status == WISP_OK ? wisp_request( b->world, b->bodies[body], WISP_SURFACE_POINTS ) : status;
}

// ---- floors ----

// How far bodies stay off their floors: less than the last cell rises from it.
static double gap_of( const validate_def* def )
{
    return 0.125 * VALIDATE_LENGTH / def->cells;
}

static wisp_status set_collision( validate_bodies* b, int body, double mu )
{
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = (float)gap_of( &b->def );
    collision.friction_scale = (float)mu;
    collision.mask = b->masks[body];
    return wisp_set_collision( b->world, b->bodies[body], &collision );
}

// A plane behind x, with a friction of 1 that is scaled for each body, and a layer of its own.
static wisp_status add_floor( validate_bodies* b, double x, uint32_t layer )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_PLANE;
    def.static_friction = def.kinetic_friction = 1.0f;
    def.layers = layer;
    def.pose.translation.x = (float)( VALIDATE_LENGTH * x + gap_of( &b->def ) );
    def.pose.rotation = ( wisp_quat ){ 0.0f, 0.0f, sqrtf( 0.5f ), sqrtf( 0.5f ) }; // up is -x
    wisp_entity floor;
    return wisp_add_collider( b->world, &def, &floor );
}

static wisp_status add_floors( validate_bodies* b )
{
    const double* floors = b->def.floors;
    uint32_t layer = 1;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < b->def.count && status == WISP_OK; ++i )
    {
        const bool is_new = i == 0 || floors[i] != floors[i - 1];
        layer = is_new && i > 0 ? layer << 1 : layer;
        b->masks[i] = layer;
        status = is_new ? add_floor( b, floors[i], layer ) : WISP_OK;
        status = status == WISP_OK ? set_collision( b, i, b->def.friction ) : status;
    }
    return status;
}

wisp_status validate_set_friction( validate_bodies* b, const double* mu, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < b->def.count && status == WISP_OK; ++i )
    {
        status = set_collision( b, i, mu[i] );
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world, status, error );
}

wisp_status validate_turn_gravity( validate_bodies* b, wisp_vec3 gravity, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < b->def.count && status == WISP_OK; ++i )
    {
        status = wisp_set_strand_gravity( b->world, b->bodies[i], gravity );
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world, status, error );
}

// ---- all of them ----

wisp_status validate_create( const validate_def* def, validate_bodies* out, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_strands_module, &wisp_cloth_module,
                                                  &wisp_implicit_cloth_module, &wisp_collision_module };
    *out = ( validate_bodies ){ .def = *def };
    const bool is_cloth = def->solver == VALIDATE_DIHEDRAL || def->solver == VALIDATE_ISOMETRIC;
    // without floors there is no collision either, as in a world of a user who has none
    const int module_count = WISP_COUNT( modules ) - ( def->floors != NULL ? 0 : 1 );
    const bench_world_def world = { modules, module_count, def->workers, def->substeps,
                                    is_cloth ? STRIP_ITERATIONS : 1 };
    wisp_fabric* fabric = NULL;
    wisp_status status = bench_world_create( &world, &out->world, error );
    status = status == WISP_OK && def->solver != VALIDATE_ROD ? cook_strip( def, &fabric, error ) : status;
    for ( int i = 0; i < def->count && status == WISP_OK; ++i )
    {
        status = def->solver == VALIDATE_ROD ? add_rod( out, i ) : add_strip( out, fabric, i );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( out->world, status, error );
    }
    if ( status == WISP_OK && def->floors != NULL )
    {
        status = add_floors( out );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( out->world, status, error );
    }
    wisp_fabric_release( fabric );
    return status;
}

void validate_release( validate_bodies* b )
{
    wisp_world_destroy( b->world );
    b->world = NULL;
}

wisp_status validate_step( validate_bodies* b, accuracy_run* out, wisp_error* error )
{
    const double begin = wisp_clock_seconds();
    const wisp_status status = wisp_world_step( b->world, SECONDS );
    const double ms = 1e3 * ( wisp_clock_seconds() - begin );
    b->steps += 1;
    if ( b->halted_at == 0 && wisp_world_counter( b->world, WISP_COUNT_HALTED ) > 0 )
    {
        b->halted_at = b->steps;
    }
    return status == WISP_OK ? accuracy_keep_ms( out, ms ) : bench_world_fail( b->world, status, error );
}

static wisp_component points_of( const validate_bodies* b )
{
    return b->def.solver == VALIDATE_ROD ? WISP_STRAND_POINTS : WISP_SURFACE_POINTS;
}

wisp_status validate_tip( validate_bodies* b, int body, wisp_vec3* out, wisp_error* error )
{
    const bool is_rod = b->def.solver == VALIDATE_ROD;
    const int count = is_rod ? b->def.cells + 1 : 2 * ( b->def.cells + 2 );
    const wisp_vec3* points = NULL;
    const wisp_status status = bench_world_points( b->world, b->bodies[body], points_of( b ), count, &points, error );
    if ( status == WISP_OK )
    {
        const wisp_vec3 p = points[count - 1], q = is_rod ? p : points[count / 2 - 1];
        *out = ( wisp_vec3 ){ 0.5f * ( p.x + q.x ), 0.5f * ( p.y + q.y ), 0.5f * ( p.z + q.z ) };
    }
    return status;
}

wisp_status validate_finish( validate_bodies* b, accuracy_run* out, wisp_error* error )
{
    const int vertices = b->def.solver == VALIDATE_ROD ? b->def.cells + 1 : 2 * ( b->def.cells + 2 );
    wisp_status status = WISP_OK;
    out->hash = 0;
    for ( int i = 0; i < b->def.count && status == WISP_OK; ++i )
    {
        uint64_t hash = 0;
        status = bench_world_hash( b->world, b->bodies[i], points_of( b ), &hash, error );
        out->hash = ( out->hash ^ hash ) * 0x100000001b3u;
    }
    out->halted_at = b->halted_at;
    out->work = ( accuracy_work ){ .vertices = (double)b->def.count * vertices,
                                   .substeps = b->def.substeps,
                                   .bytes = (double)wisp_world_memory( b->world ) };
    return status;
}
