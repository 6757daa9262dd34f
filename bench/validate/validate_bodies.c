// What the cases of rods, strips and sheets share.
#include "validate/validate_bodies.h"

#include "interruption.h"
#include "surfaces.h"

#include "balloon/balloon.h"
#include "cloth/cloth.h"
#include "collision/collision.h"
#include "implicit_cloth/implicit_cloth.h"
#include "strands/strands.h"
#include "wisp/fabric.h"
#include "wisp/maps.h"
#include "wisp/module/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- settings ----

static accuracy_setting* put( accuracy_scene* out, validate_setting setting, const char* name )
{
    validate_settings* settings = out->context;
    WISP_ASSERT( out->setting_count < VALIDATE_MAX_SETTINGS );
    settings->list[out->setting_count] = setting;
    return accuracy_put_setting( out, "%s, %d cells, %d substeps", name, setting.cells, setting.substeps );
}

void validate_put_cells( accuracy_scene* out, int solver, const char* name, const char* cell, const int* cells,
                         int substeps )
{
    char series[64];
    snprintf( series, sizeof series, "%s by cells", name );
    for ( ; *cells > 0; ++cells )
    {
        const validate_setting setting = { solver, *cells, substeps };
        accuracy_join_series( put( out, setting, name ), series, cell, 1.0 / *cells, NAN );
    }
}

void validate_put_substeps( accuracy_scene* out, int solver, const char* name, int cells, const int* substeps )
{
    char series[64];
    snprintf( series, sizeof series, "%s by substeps", name );
    for ( ; *substeps > 0; ++substeps )
    {
        const validate_setting setting = { solver, cells, *substeps };
        accuracy_join_series( put( out, setting, name ), series, "substep, s", (double)VALIDATE_STEP / *substeps,
                              NAN );
    }
}

static void put_grid( accuracy_scene* out, const validate_grid* g )
{
    const char* cell = g->cell != NULL ? g->cell : "cell / L";
    for ( int k = 0; g->solvers >> k != 0; ++k )
    {
        for ( int part = 0; part < 2 && ( g->solvers >> k & 1 ) != 0; ++part )
        {
            if ( ( part == 1 ) == g->starts_with_substeps )
            {
                validate_put_cells( out, k, g->names[k], cell, g->cells, g->substeps );
            }
            else
            {
                validate_put_substeps( out, k, g->names[k], g->middle, g->fewer );
            }
        }
    }
}

static wisp_status play_setting( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                                 wisp_error* error )
{
    const validate_settings* all = context;
    const validate_setting* w = all->list + setting;
    validate_bodies bodies = { .def = { .cells = w->cells, .substeps = w->substeps, .workers = workers },
                               .world = { .is_observed = is_observed, .run = out },
                               .method = w->solver,
                               .own = validate_own( context ) };
    return validate_end( all->of->play( &bodies, error ), &bodies, error );
}

wisp_status validate_make( const void* subject, const bench_options* options, double seconds, accuracy_scene* out,
                           wisp_error* error )
{
    const validate_case* of = subject;
    *out = of->scene;
    WISP_TRY( accuracy_begin_scene( out, sizeof( validate_settings ) + of->own_size, VALIDATE_MAX_SETTINGS, error ) );
    validate_settings* all = out->context;
    all->of = of;
    all->is_quick = options->quick;
    all->seconds = seconds;
    out->run = of->play != NULL ? play_setting : out->run;
    out->uncertainty = of->rungs > 0 ? validate_ladder_doubt( of->rungs ) : out->uncertainty;
    put_grid( out, &of->grid );
    const wisp_status status = of->prepare != NULL ? of->prepare( out, error ) : WISP_OK;
    if ( status == WISP_OK && of->put != NULL )
    {
        of->put( out );
    }
    return status == WISP_OK ? WISP_OK : accuracy_abandon( out, status );
}

// ---- a world of bodies ----

int validate_steps( double seconds )
{
    return (int)ceil( seconds / (double)VALIDATE_STEP );
}

wisp_status validate_world_create( const bench_world_def* def, validate_world* out, wisp_error* error )
{
    out->substeps = def->substeps;
    return bench_world_create( def, &out->world, error );
}

void validate_world_release( validate_world* w )
{
    wisp_world_destroy( w->world );
    w->world = NULL;
}

wisp_status validate_world_add( validate_world* w, wisp_entity entity, wisp_component points, int vertex_count )
{
    WISP_ASSERT( w->count < VALIDATE_MAX_BODIES );
    w->bodies[w->count++] = ( validate_body ){ entity, points, vertex_count };
    return wisp_request( w->world, entity, points );
}

static wisp_status step( validate_world* w, wisp_error* error )
{
    const double begin = wisp_clock_seconds();
    const wisp_status status = wisp_world_step( w->world, VALIDATE_STEP );
    const double ms = 1e3 * ( wisp_clock_seconds() - begin );
    w->steps += 1;
    if ( w->halted_at == 0 && wisp_world_counter( w->world, WISP_COUNT_HALTED ) > 0 )
    {
        w->halted_at = w->steps;
    }
    return status == WISP_OK ? accuracy_keep_ms( w->run, ms ) : bench_world_fail( w->world, status, error );
}

wisp_status validate_world_step( validate_world* w, int steps, wisp_error* error )
{
    for ( int i = 0; i < steps; ++i )
    {
        WISP_TRY( interruption_check( error ) );
        WISP_TRY( step( w, error ) );
    }
    return WISP_OK;
}

wisp_status validate_world_points( validate_world* w, int body, const wisp_vec3** out, wisp_error* error )
{
    const validate_body* b = w->bodies + body;
    return bench_world_points( w->world, b->entity, b->points, b->vertex_count, out, error );
}

wisp_status validate_world_watch( validate_world* w, int body, wisp_error* error )
{
    const wisp_status status =
        w->is_observed ? wisp_request( w->world, w->bodies[body].entity, WISP_MOTION_STATS ) : WISP_OK;
    return status == WISP_OK ? WISP_OK : bench_world_fail( w->world, status, error );
}

wisp_status validate_world_motion( validate_world* w, int body, wisp_motion_stats* out, wisp_error* error )
{
    const wisp_status status = wisp_read_motion_stats( w->world, w->bodies[body].entity, out );
    return status == WISP_OK ? WISP_OK : bench_world_fail( w->world, status, error );
}

wisp_status validate_world_finish( validate_world* w, wisp_error* error )
{
    accuracy_run* out = w->run;
    double vertices = 0.0;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < w->count && status == WISP_OK; ++i )
    {
        uint64_t hash = 0;
        status = bench_world_hash( w->world, w->bodies[i].entity, w->bodies[i].points, &hash, error );
        out->hash = ( out->hash ^ hash ) * 0x100000001b3u;
        vertices += w->bodies[i].vertex_count;
    }
    out->halted_at = out->halted_at > 0 ? out->halted_at : w->halted_at;
    out->work = ( accuracy_work ){ .vertices = vertices,
                                   .substeps = w->substeps,
                                   .bytes = (double)wisp_world_memory( w->world ) };
    return status;
}

// ---- materials ----

// Membrane of implicit cloth that has to be inextensible, N/m.
static const double STIFF = 2000.0;

// @param rigidity N m, against bending @param stiffness N/m, of the membrane; 0: as stiff as it can be
static wisp_implicit_cloth_def validate_implicit_material( double rigidity, double stiffness )
{
    wisp_implicit_cloth_def cloth = wisp_default_implicit_cloth_def();
    cloth.tolerance = 1e-3f;   // plates that buckle need it: the default of 1e-2 is 2.5 % off
    cloth.link_damping = 0.0f; // of a strip that bends it would be drag
    cloth.integrator = WISP_INTEGRATOR_BDF2;
    cloth.bend_rigidity = (float)rigidity;
    cloth.stretch_stiffness = (float)( stiffness > 0.0 ? stiffness : STIFF );
    return cloth;
}

// @param rigidity N m, against bending; 0: the default
// @param stiffness N/m, of the membrane; 0: inextensible
static wisp_cloth_def validate_cloth_material( wisp_cloth_bending bending, double rigidity, double stiffness )
{
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.internal_damping = 0.0f;
    cloth.bending = bending;
    if ( rigidity > 0.0 )
    {
        cloth.bend_rigidity = (float)rigidity;
    }
    if ( stiffness > 0.0 )
    {
        // equilateral triangles of links of stiffness k have 2 / sqrt( 3 ) k; a mesh of squares has 4/3 instead
        cloth.warp_compliance = cloth.weft_compliance = 2.0f / ( sqrtf( 3.0f ) * (float)stiffness );
        cloth.shear_compliance = 2.0f * cloth.warp_compliance;
    }
    return cloth;
}

// ---- where bodies start ----

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
static wisp_vec3 validate_start_of( const validate_def* def, int body, int cell, double x )
{
    const double length = VALIDATE_LENGTH;
    if ( def->shapes != NULL && cell >= 0 )
    {
        const validate_point p = def->shapes[body * ( def->cells + 1 ) + cell];
        return ( wisp_vec3 ){ (float)( length * p.x ), (float)( length * p.y ), 0.0f };
    }
    return ( wisp_vec3 ){ (float)( length * x ), (float)aside( def, x ), 0.0f };
}

// ---- strips and sheets ----

// kg/m^2. What is shown has no unit, so it only keeps numbers ordinary.
static const double AREA_DENSITY = 0.15;

// Cells of a sheet: those before the origin are pinned, and it begins where they end.
typedef struct sheet_grid
{
    int columns, rows; // of vertices, along x and across it
    wisp_vec3* points; // [columns * rows] flat, m
} sheet_grid;

static int rows_of( const validate_def* def )
{
    return def->width > 0.0 ? (int)fmax( 2.0, round( def->width * def->cells ) ) + 1 : 2;
}

static wisp_status lay_grid( const validate_def* def, sheet_grid* out, wisp_error* error )
{
    const int columns = def->cells + 2, rows = rows_of( def );
    const double cell = 1.0 / def->cells, width = def->width > 0.0 ? def->width : cell, row = width / ( rows - 1 );
    *out = ( sheet_grid ){ columns, rows, malloc( (size_t)( columns * rows ) * sizeof( wisp_vec3 ) ) };
    const wisp_random_key key = wisp_random_make_key( 1, 0, 0 );
    for ( int v = 0; v < columns * rows && out->points != NULL; ++v )
    {
        const int i = v % columns, j = v / columns;
        const bool is_moved =
            def->mesh == VALIDATE_MESH_IRREGULAR && i > 1 && i + 1 < columns && j > 0 && j + 1 < rows;
        const double shift_x = is_moved ? 0.5 * wisp_random_unit( key, (uint32_t)v, 0, 0 ) - 0.25 : 0.0,
                     shift_z = is_moved ? 0.5 * wisp_random_unit( key, (uint32_t)v, 1, 0 ) - 0.25 : 0.0;
        out->points[v] = ( wisp_vec3 ){ (float)( VALIDATE_LENGTH * cell * ( i - 1 + shift_x ) ), 0.0f,
                                        (float)( VALIDATE_LENGTH * ( row * ( j + shift_z ) - 0.5 * width ) ) };
    }
    return out->points != NULL ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for a sheet" );
}

static wisp_status cook_sheet( const validate_def* def, const sheet_grid* g, wisp_fabric** out, wisp_error* error )
{
    const int cells = ( g->columns - 1 ) * ( g->rows - 1 );
    int32_t* triangles = malloc( 6 * (size_t)cells * sizeof( int32_t ) );
    if ( triangles == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %d cells", cells );
    }
    for ( int c = 0; c < cells; ++c )
    {
        const int i = c % ( g->columns - 1 ), j = c / ( g->columns - 1 );
        const int p = j * g->columns + i, q = p + 1, r = p + g->columns, s = r + 1;
        const int32_t falling[] = { p, r, s, p, s, q }, rising[] = { p, r, q, q, r, s };
        const bool is_falling = def->mesh == VALIDATE_MESH_ONE_WAY || ( i + j ) % 2 == 0;
        memcpy( triangles + 6 * c, is_falling ? falling : rising, sizeof falling );
    }
    wisp_fabric_def fabric = wisp_default_fabric_def();
    fabric.points = g->points;
    fabric.vertex_count = g->columns * g->rows;
    fabric.triangles = triangles;
    fabric.triangle_count = 2 * cells;
    fabric.hinges = true;
    fabric.bend_links = def->solver == VALIDATE_IMPLICIT;
    const wisp_status status = wisp_fabric_cook( &fabric, NULL, out, error );
    free( triangles );
    return status;
}

static wisp_status set_strip_material( validate_bodies* b, wisp_entity sheet, int body )
{
    const validate_def* def = &b->def;
    const float rigidity =
        (float)( AREA_DENSITY * VALIDATE_GRAVITY * pow( VALIDATE_LENGTH, 3.0 ) / def->loads[body] );
    // 12 D / h^2 of a plate of the thickness h
    const double membrane =
        def->thickness > 0.0 ? 12.0 * (double)rigidity / pow( def->thickness * VALIDATE_LENGTH, 2.0 ) : 0.0;
    if ( def->solver == VALIDATE_IMPLICIT )
    {
        const wisp_implicit_cloth_def cloth = validate_implicit_material( (double)rigidity, membrane );
        return wisp_set_implicit_cloth( b->world.world, sheet, &cloth );
    }
    const wisp_cloth_def cloth = validate_cloth_material(
        def->solver == VALIDATE_DIHEDRAL ? WISP_CLOTH_BENDING_DIHEDRAL : WISP_CLOTH_BENDING_ISOMETRIC,
        (double)rigidity, membrane );
    return wisp_set_cloth( b->world.world, sheet, &cloth );
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

// Pinned along the first two columns, and the free part aside.
static wisp_status add_sheet( validate_bodies* b, const sheet_grid* g, wisp_fabric* fabric, int body,
                              wisp_error* error )
{
    const int count = g->columns * g->rows;
    int32_t pins[2 * ( VALIDATE_MAX_CELLS + 1 )];
    wisp_vec3* points = malloc( (size_t)count * sizeof( wisp_vec3 ) );
    if ( points == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a sheet" );
    }
    for ( int i = 0; i < count; ++i )
    {
        points[i] = validate_start_of( &b->def, body, i % g->columns - 1, (double)g->points[i].x / VALIDATE_LENGTH );
        points[i].z = g->points[i].z;
    }
    for ( int j = 0; j < g->rows; ++j )
    {
        pins[2 * j] = j * g->columns;
        pins[2 * j + 1] = j * g->columns + 1;
    }
    wisp_surface_def surface = wisp_default_surface_def();
    surface.fabric = fabric;
    surface.points = points;
    surface.area_density = (float)AREA_DENSITY;
    surface.pins = pins;
    surface.pin_count = 2 * g->rows;
    surface.gravity = b->def.gravity;
    wisp_entity sheet;
    wisp_status status = wisp_add_surface( b->world.world, &surface, &sheet );
    free( points );
    status = status == WISP_OK ? wisp_set_damping( b->world.world, sheet, (float)b->def.damping ) : status;
    status = status == WISP_OK ? set_strip_material( b, sheet, body ) : status;
    status = status == WISP_OK && b->def.tip > 0.0 ? load_tip( b, sheet ) : status;
    status = status == WISP_OK ? validate_world_add( &b->world, sheet, WISP_SURFACE_POINTS, count ) : status;
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

// Add those of a definition, whose solver is one of cloth.
static wisp_status validate_add_sheets( validate_bodies* b, wisp_error* error )
{
    sheet_grid g;
    wisp_fabric* fabric = NULL;
    WISP_ASSERT( rows_of( &b->def ) <= VALIDATE_MAX_CELLS + 1 );
    WISP_ASSERT( ( b->def.tip <= 0.0 && b->def.shapes == NULL ) || rows_of( &b->def ) == 2 );
    wisp_status status = lay_grid( &b->def, &g, error );
    status = status == WISP_OK ? cook_sheet( &b->def, &g, &fabric, error ) : status;
    for ( int i = 0; i < b->def.count && status == WISP_OK; ++i )
    {
        status = add_sheet( b, &g, fabric, i, error );
    }
    wisp_fabric_release( fabric );
    free( g.points );
    return status;
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
    return wisp_set_collision( b->world.world, b->world.bodies[body].entity, &collision );
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
    return wisp_add_collider( b->world.world, &def, &floor );
}

// Add those of a definition that has floors, when its bodies are there.
static wisp_status validate_add_floors( validate_bodies* b, wisp_error* error )
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
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

wisp_status validate_set_friction( validate_bodies* b, const double* mu, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < b->def.count && status == WISP_OK; ++i )
    {
        status = set_collision( b, i, mu[i] );
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

// ---- rods and sheets, clamped ----

const char* const validate_solver_names[VALIDATE_SOLVER_COUNT] = { "rod", "dihedral", "isometric", "implicit" };

// kg/m. What is shown has no unit, so it only keeps numbers ordinary.
static const double LINE_DENSITY = 0.01;

enum
{
    STRIP_ITERATIONS = 8, // of cloth: links along a clamped strip converge slowly
};

// Where the free part of a body starts aside, x in lengths: the first two cells are straight, so that the clamp is.
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
    for ( int i = 0; i < b->def.count; ++i )
    {
        WISP_TRY( add_rod( b, i, error ) );
    }
    return WISP_OK;
}

// ---- all of them ----

wisp_status validate_open( validate_bodies* b, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_strands_module, &wisp_cloth_module,
                                                  &wisp_implicit_cloth_module, &wisp_collision_module };
    const validate_def* def = &b->def;
    const bool is_cloth = def->solver == VALIDATE_DIHEDRAL || def->solver == VALIDATE_ISOMETRIC;
    const int needed = is_cloth ? STRIP_ITERATIONS : 1;
    // without floors there is no collision either, as in a world of a user who has none
    const int module_count = WISP_COUNT( modules ) - ( def->floors != NULL ? 0 : 1 );
    const bench_world_def world = { modules, module_count, def->workers, def->substeps,
                                    def->iterations > 0 ? def->iterations : needed };
    return validate_world_create( &world, &b->world, error );
}

wisp_status validate_create( validate_bodies* b, wisp_error* error )
{
    WISP_TRY( validate_open( b, error ) );
    WISP_TRY( b->def.solver == VALIDATE_ROD ? add_rods( b, error ) : validate_add_sheets( b, error ) );
    return b->def.floors != NULL ? validate_add_floors( b, error ) : WISP_OK;
}

wisp_status validate_step( validate_bodies* b, int steps, wisp_error* error )
{
    return validate_world_step( &b->world, steps, error );
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

wisp_status validate_step_for( validate_bodies* b, double seconds, wisp_error* error )
{
    return validate_step( b, validate_steps( seconds ), error );
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

wisp_status validate_end( wisp_status status, validate_bodies* b, wisp_error* error )
{
    status = status == WISP_OK ? validate_world_finish( &b->world, error ) : status;
    validate_world_release( &b->world );
    return status;
}

// ---- ladders of loads ----

static const double HALF = 0.3; // of the ladder, in critical loads

static double half_rung( int count )
{
    return HALF / ( count - 1 );
}

double validate_rung( int i, int count )
{
    return 1.0 - HALF + 2.0 * half_rung( count ) * i;
}

double validate_ladder_doubt( int count )
{
    return 100.0 * half_rung( count );
}

double validate_measure_ladder( const bool* has_lost, int count, double critical, double measures[2] )
{
    int first = 0;
    while ( first < count && !has_lost[first] )
    {
        ++first;
    }
    const bool is_beyond = first == 0 || first == count;
    const double lost_at = is_beyond ? (double)NAN : validate_rung( first, count ) - half_rung( count );
    measures[0] = lost_at * critical;
    measures[1] = critical;
    return 100.0 * ( is_beyond ? HALF : fabs( lost_at - 1.0 ) );
}

void validate_judge_ladder( validate_bodies* b, const bool* has_lost, int count, double critical )
{
    accuracy_run* out = b->world.run;
    if ( b->world.is_observed )
    {
        out->error = validate_measure_ladder( has_lost, count, critical, out->measures );
    }
}

// ---- sheets with supports, friction or air ----

const char* const sheet_solver_names[SHEET_SOLVER_COUNT] = { "strands",   "xpbd",     "dihedral",
                                                             "isometric", "implicit", "balloon" };

// Volumes of gas in a balloon: the air dents one that is slack.
static const float TAUT = 1.05f;

enum
{
    CLOTH_ITERATIONS = 8, // links of a sheet converge slowly
};

static bool is_cloth( sheet_solver solver )
{
    return solver == SHEET_XPBD || solver == SHEET_DIHEDRAL || solver == SHEET_ISOMETRIC;
}

wisp_status sheet_world_create( validate_bodies* b, bool has_ground, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_strands_module, &wisp_cloth_module,
                                                  &wisp_implicit_cloth_module, &wisp_balloon_module,
                                                  &wisp_collision_module };
    validate_world* out = &b->world;
    const bench_world_def def = { modules, WISP_COUNT( modules ), b->def.workers, b->def.substeps,
                                  is_cloth( (sheet_solver)b->method ) ? CLOTH_ITERATIONS : 1 };
    wisp_status status = validate_world_create( &def, out, error );
    if ( status != WISP_OK || !has_ground )
    {
        return status;
    }
    wisp_collider_def ground = wisp_default_collider_def();
    ground.kind = WISP_COLLIDER_PLANE;
    ground.static_friction = ground.kinetic_friction = 1.0f;
    wisp_entity plane;
    status = wisp_add_collider( out->world, &ground, &plane );
    return status == WISP_OK ? WISP_OK : bench_world_fail( out->world, status, error );
}

// ---- materials ----

static wisp_status set_implicit( wisp_world* world, wisp_entity surface, const sheet_def* def )
{
    const wisp_implicit_cloth_def cloth = validate_implicit_material( def->rigidity, def->stiffness );
    return wisp_set_implicit_cloth( world, surface, &cloth );
}

static wisp_status set_cloth( wisp_world* world, wisp_entity surface, const sheet_def* def )
{
    wisp_cloth_def cloth = validate_cloth_material( def->solver == SHEET_DIHEDRAL    ? WISP_CLOTH_BENDING_DIHEDRAL
                                                    : def->solver == SHEET_ISOMETRIC ? WISP_CLOTH_BENDING_ISOMETRIC
                                                                                     : WISP_CLOTH_BENDING_NONE,
                                                    def->rigidity, def->stiffness );
    cloth.air_density = SHEET_AIR;
    cloth.drag_coefficient = (float)def->drag;
    return wisp_set_cloth( world, surface, &cloth );
}

static wisp_status set_balloon( wisp_world* world, wisp_entity surface, const sheet_def* def )
{
    wisp_balloon_def balloon = wisp_default_balloon_def();
    balloon.drag_coefficient = (float)def->drag;
    balloon.gas_ratio = TAUT;
    return wisp_set_balloon( world, surface, &balloon );
}

static wisp_status set_material( wisp_world* world, wisp_entity surface, const sheet_def* def )
{
    return def->solver == SHEET_IMPLICIT  ? set_implicit( world, surface, def )
           : def->solver == SHEET_BALLOON ? set_balloon( world, surface, def )
                                          : set_cloth( world, surface, def );
}

// ---- bodies ----

static wisp_status add_strand( validate_world* w, const sheet_def* def, wisp_entity* out )
{
    const int32_t offsets[2] = { 0, def->row };
    const bool is_pinned = def->pin_count > 0;
    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = def->start != NULL ? def->start : def->mesh->points;
    strands.offsets = offsets;
    strands.strand_count = 1;
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.bending = WISP_STRAND_BEND_NONE;
    dynamics.line_density = (float)( def->density * SHEET_STRAND_WIDTH );
    dynamics.diameter = (float)SHEET_STRAND_WIDTH;
    dynamics.gravity = def->gravity;
    dynamics.damping = (float)def->damping;
    dynamics.air_density = SHEET_AIR;
    dynamics.drag_coefficient = (float)def->drag;
    dynamics.free_roots = !is_pinned;
    wisp_status status = wisp_add_strands( w->world, &strands, out );
    status = status == WISP_OK ? wisp_set_strand_dynamics( w->world, *out, &dynamics ) : status;
    status =
        status == WISP_OK && is_pinned ? wisp_hold_strand_tip( w->world, *out, 0, WISP_STRAND_TIP_PINNED ) : status;
    return status == WISP_OK ? validate_world_add( w, *out, WISP_STRAND_POINTS, def->row ) : status;
}

static wisp_status add_surface( validate_world* w, const sheet_def* def, wisp_fabric* fabric, wisp_entity* out )
{
    wisp_surface_def surface = wisp_default_surface_def();
    surface.fabric = fabric;
    surface.points = def->start;
    surface.area_density = (float)def->density;
    surface.pins = def->pins;
    surface.pin_count = def->pin_count;
    surface.gravity = def->gravity;
    wisp_status status = wisp_add_surface( w->world, &surface, out );
    status = status == WISP_OK ? wisp_set_damping( w->world, *out, (float)def->damping ) : status;
    status = status == WISP_OK ? set_material( w->world, *out, def ) : status;
    return status == WISP_OK ? validate_world_add( w, *out, WISP_SURFACE_POINTS, def->mesh->vertex_count ) : status;
}

static wisp_status set_friction( wisp_world* world, wisp_entity entity, double friction )
{
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = SHEET_MARGIN;
    collision.friction_scale = (float)friction; // of the ground's, which is 1
    return wisp_set_collision( world, entity, &collision );
}

wisp_status sheet_add( validate_world* w, const sheet_def* def, wisp_error* error )
{
    wisp_fabric_def cooked = wisp_default_fabric_def();
    cooked.hinges = def->solver == SHEET_DIHEDRAL || def->solver == SHEET_ISOMETRIC;
    cooked.bend_links = def->solver == SHEET_IMPLICIT || def->solver == SHEET_BALLOON;
    wisp_fabric* fabric = NULL;
    wisp_entity entity;
    wisp_status status = def->solver != SHEET_STRANDS ? surface_cook( def->mesh, cooked, &fabric, error ) : WISP_OK;
    if ( status != WISP_OK )
    {
        return status;
    }
    status = fabric != NULL ? add_surface( w, def, fabric, &entity ) : add_strand( w, def, &entity );
    status = status == WISP_OK && def->friction >= 0.0 ? set_friction( w->world, entity, def->friction ) : status;
    status = status == WISP_OK && w->is_observed ? wisp_request( w->world, entity, WISP_MOTION_STATS ) : status;
    wisp_fabric_release( fabric );
    return status == WISP_OK ? WISP_OK : bench_world_fail( w->world, status, error );
}
