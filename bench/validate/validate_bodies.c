#include "validate_bodies.h"

#include "bench_world.h"

#include "cloth/cloth.h"
#include "implicit_cloth/implicit_cloth.h"
#include "strands/strands.h"
#include "wisp/fabric.h"
#include "wisp/module/random.h"

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

// Where the free part of a body starts aside, x in lengths: the first two cells are straight, so that the clamp is.
static float aside( const validate_def* def, double x )
{
    const double s = x - 2.0 / def->cells;
    return s > 0.0 ? (float)( def->lateral * VALIDATE_LENGTH * s * s ) : 0.0f;
}

double validate_start( const validate_def* def )
{
    return (double)aside( def, 1.0 );
}

double validate_frequency( double load )
{
    return 3.516 * sqrt( VALIDATE_GRAVITY / ( load * VALIDATE_LENGTH ) );
}

// ---- rods ----

static wisp_status add_rod( validate_bodies* b, int body, wisp_error* error )
{
    const validate_def* def = &b->def;
    wisp_vec3 points[VALIDATE_MAX_CELLS + 1];
    const int32_t offsets[2] = { 0, def->cells + 1 };
    for ( int i = 0; i <= def->cells; ++i )
    {
        points[i] =
            ( wisp_vec3 ){ (float)( VALIDATE_LENGTH * i / def->cells ), aside( def, (double)i / def->cells ), 0.0f };
    }
    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = points;
    strands.offsets = offsets;
    strands.strand_count = 1;
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.rest = WISP_STRAND_REST_STRAIGHT;
    dynamics.line_density = (float)LINE_DENSITY;
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
    wisp_status status = wisp_add_strands( b->world, &strands, b->bodies + body );
    status = status == WISP_OK ? wisp_set_strand_dynamics( b->world, b->bodies[body], &dynamics ) : status;
    status = status == WISP_OK ? wisp_request( b->world, b->bodies[body], WISP_STRAND_POINTS ) : status;
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world, status, error );
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

// ---- strips and sheets ----

// Cells of a sheet: those before the origin are pinned, and it begins where they end.
typedef struct grid
{
    int columns, rows; // of vertices, along x and across it
    wisp_vec3* points; // [columns * rows] flat, m
} grid;

static int vertex_count_of( const validate_def* def )
{
    const int across = def->width > 0.0 ? (int)fmax( 2.0, round( def->width * def->cells ) ) : 1;
    return def->solver == VALIDATE_ROD ? def->cells + 1 : ( def->cells + 2 ) * ( across + 1 );
}

static wisp_status lay_grid( const validate_def* def, grid* out, wisp_error* error )
{
    const int columns = def->cells + 2, rows = vertex_count_of( def ) / columns;
    const double cell = 1.0 / def->cells, width = def->width > 0.0 ? def->width : cell, row = width / ( rows - 1 );
    *out = ( grid ){ columns, rows, malloc( (size_t)( columns * rows ) * sizeof( wisp_vec3 ) ) };
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

static wisp_status cook_sheet( const validate_def* def, const grid* g, wisp_fabric** out, wisp_error* error )
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

static wisp_status set_material( validate_bodies* b, int body )
{
    const validate_def* def = &b->def;
    const float rigidity =
        (float)( AREA_DENSITY * VALIDATE_GRAVITY * pow( VALIDATE_LENGTH, 3.0 ) / def->loads[body] );
    // 12 D / h^2 of a plate of the thickness h
    const float membrane = def->thickness > 0.0
                               ? (float)( 12.0 * (double)rigidity / pow( def->thickness * VALIDATE_LENGTH, 2.0 ) )
                               : 0.0f;
    if ( def->solver == VALIDATE_IMPLICIT )
    {
        wisp_implicit_cloth_def cloth = wisp_default_implicit_cloth_def();
        cloth.stiffness_model = WISP_IMPLICIT_STIFFNESS_MATERIAL;
        cloth.weights = WISP_IMPLICIT_WEIGHTS_PAIR;
        cloth.bend_rigidity = rigidity;
        cloth.stretch_stiffness = membrane > 0.0f ? membrane : 2000.0f;
        cloth.integrator = WISP_INTEGRATOR_BDF2;
        cloth.damping_form = WISP_IMPLICIT_DAMPING_AXIAL;
        return wisp_set_implicit_cloth( b->world, b->bodies[body], &cloth );
    }
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = def->solver == VALIDATE_DIHEDRAL ? WISP_CLOTH_BENDING_DIHEDRAL : WISP_CLOTH_BENDING_ISOMETRIC;
    cloth.bend_rigidity = rigidity;
    // of equilateral triangles; a mesh of squares has 4/3 instead of 2 / sqrt( 3 )
    cloth.warp_compliance = membrane > 0.0f ? 2.0f / ( sqrtf( 3.0f ) * membrane ) : 0.0f;
    cloth.weft_compliance = cloth.warp_compliance;
    cloth.shear_compliance = 2.0f * cloth.warp_compliance;
    return wisp_set_cloth( b->world, b->bodies[body], &cloth );
}

// Pinned along the first two columns, and the free part aside.
static wisp_status add_sheet( validate_bodies* b, const grid* g, wisp_fabric* fabric, int body, wisp_error* error )
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
        points[i] = g->points[i];
        points[i].y = aside( &b->def, (double)g->points[i].x / VALIDATE_LENGTH );
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
    wisp_status status = wisp_add_surface( b->world, &surface, b->bodies + body );
    free( points );
    status = status == WISP_OK ? wisp_set_damping( b->world, b->bodies[body], (float)b->def.damping ) : status;
    status = status == WISP_OK ? set_material( b, body ) : status;
    status = status == WISP_OK ? wisp_request( b->world, b->bodies[body], WISP_SURFACE_POINTS ) : status;
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world, status, error );
}

static wisp_status add_sheets( validate_bodies* b, wisp_error* error )
{
    grid g;
    wisp_fabric* fabric = NULL;
    WISP_ASSERT( vertex_count_of( &b->def ) <= ( b->def.cells + 2 ) * ( VALIDATE_MAX_CELLS + 1 ) );
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

// ---- all of them ----

wisp_status validate_create( const validate_def* def, validate_bodies* out, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_strands_module, &wisp_cloth_module,
                                                  &wisp_implicit_cloth_module };
    *out = ( validate_bodies ){ .def = *def };
    const bool is_cloth = def->solver == VALIDATE_DIHEDRAL || def->solver == VALIDATE_ISOMETRIC;
    const bench_world_def world = { modules, WISP_COUNT( modules ), def->workers, def->substeps,
                                    is_cloth ? STRIP_ITERATIONS : 1 };
    const wisp_status status = bench_world_create( &world, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    return def->solver == VALIDATE_ROD ? add_rods( out, error ) : add_sheets( out, error );
}

void validate_release( validate_bodies* b )
{
    wisp_world_destroy( b->world );
    b->world = NULL;
}

wisp_status validate_damp( validate_bodies* b, double damping, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < b->def.count && status == WISP_OK; ++i )
    {
        status = wisp_set_damping( b->world, b->bodies[i], (float)damping );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( b->world, status, error );
    }
    return status;
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

wisp_status validate_step_for( validate_bodies* b, double seconds, accuracy_run* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < (int)ceil( seconds / (double)SECONDS ) && status == WISP_OK; ++i )
    {
        status = validate_step( b, out, error );
    }
    return status;
}

static wisp_component points_of( const validate_bodies* b )
{
    return b->def.solver == VALIDATE_ROD ? WISP_STRAND_POINTS : WISP_SURFACE_POINTS;
}

static wisp_status read_points( validate_bodies* b, int body, const wisp_vec3** out, wisp_error* error )
{
    return bench_world_points( b->world, b->bodies[body], points_of( b ), vertex_count_of( &b->def ), out, error );
}

wisp_status validate_tip( validate_bodies* b, int body, wisp_vec3* out, wisp_error* error )
{
    const int count = vertex_count_of( &b->def );
    const wisp_vec3* points = NULL;
    const wisp_status status = read_points( b, body, &points, error );
    if ( status == WISP_OK )
    {
        const wisp_vec3 p = points[count - 1], q = b->def.solver == VALIDATE_ROD ? p : points[b->def.cells + 1];
        *out = ( wisp_vec3 ){ 0.5f * ( p.x + q.x ), 0.5f * ( p.y + q.y ), 0.5f * ( p.z + q.z ) };
    }
    return status;
}

wisp_status validate_aside( validate_bodies* b, int body, double* out, wisp_error* error )
{
    const int count = vertex_count_of( &b->def );
    const wisp_vec3* points = NULL;
    const wisp_status status = read_points( b, body, &points, error );
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
    wisp_status status = WISP_OK;
    for ( int i = 0; i < b->def.count && status == WISP_OK; ++i )
    {
        uint64_t hash = 0;
        status = bench_world_hash( b->world, b->bodies[i], points_of( b ), &hash, error );
        out->hash = ( out->hash ^ hash ) * 0x100000001b3u;
    }
    out->halted_at = out->halted_at > 0 ? out->halted_at : b->halted_at;
    out->work = ( accuracy_work ){ .vertices = (double)b->def.count * vertex_count_of( &b->def ),
                                   .substeps = b->def.substeps,
                                   .bytes = (double)wisp_world_memory( b->world ) };
    return status;
}
