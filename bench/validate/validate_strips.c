#include "validate_strips.h"

#include "validate_material.h"

#include "wisp/fabric.h"
#include "wisp/maps.h"
#include "wisp/module/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// kg/m^2. What is shown has no unit, so it only keeps numbers ordinary.
static const double AREA_DENSITY = 0.15;

// Cells of a sheet: those before the origin are pinned, and it begins where they end.
typedef struct grid
{
    int columns, rows; // of vertices, along x and across it
    wisp_vec3* points; // [columns * rows] flat, m
} grid;

static int rows_of( const validate_def* def )
{
    return def->width > 0.0 ? (int)fmax( 2.0, round( def->width * def->cells ) ) + 1 : 2;
}

static wisp_status lay_grid( const validate_def* def, grid* out, wisp_error* error )
{
    const int columns = def->cells + 2, rows = rows_of( def );
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

static wisp_status set_material( validate_bodies* b, wisp_entity sheet, int body )
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
    status = status == WISP_OK ? set_material( b, sheet, body ) : status;
    status = status == WISP_OK && b->def.tip > 0.0 ? load_tip( b, sheet ) : status;
    status = status == WISP_OK ? validate_world_add( &b->world, sheet, WISP_SURFACE_POINTS, count ) : status;
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

wisp_status validate_add_sheets( validate_bodies* b, wisp_error* error )
{
    grid g;
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
