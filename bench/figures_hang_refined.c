// Check that a finer mesh stays the same cloth (extension, not in Noh and Jung). Stiffness that belongs to the sheet
// gives each link its share; stiffness that belongs to links does not.
#include "figures_hang.h"

#include "cells.h"

#include <math.h>
#include <stdlib.h>

enum
{
    MESH_COUNT = 3,
    QUICK_MESHES = 2,
    ROUND = 0, // of the forms below
    STIFF,
    CORNERS,
    SIDE,
    FORM_COUNT,
    STEPS = 200, // of 0.01 s: the energy that is left is below 1e-7 J
};

static const int sizes[MESH_COUNT] = { 250, 1000, 4000 };

// Rigid enough that no arc gives way, or as cloth is.
#define STIFF_RIGIDITY 5e-2f // N m, of `sheet`
#define STIFF_BENDING 1e-2f  // N m^2, of `link`

static const struct
{
    hang_form form;
    bool is_stiff;
    const char *name, *measured;
} forms[FORM_COUNT] = {
    [ROUND] = { HANG_ROUND, false, "all round, level", "middle" },
    [STIFF] = { HANG_SIDE, true, "one side, D 5e-2 N m", "lower side" },
    [CORNERS] = { HANG_CORNERS, false, "two corners", "upper side" },
    [SIDE] = { HANG_SIDE, false, "one side", "lower side" },
};

typedef struct sag_row
{
    double sag[MESH_COUNT]; // m
    double iterations, ms;  // a step of the finest mesh
    int count;
} sag_row;

// How far down gravity has drawn it: the lowest place of what is held, or the mean of the side across.
static double sag_of( const wisp_mesh* mesh, const wisp_vec3* points, hang_form form )
{
    const double edge = 0.5 * (double)TRIANGLE_WIDTH - 1e-4;
    double most = 0.0, sum = 0.0;
    int count = 0;
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        const double down = (double)TRIANGLE_HEIGHT - (double)points[i].y, z = (double)mesh->points[i].z;
        if ( form == HANG_ROUND || ( form == HANG_CORNERS && z < -edge ) )
        {
            most = fmax( most, down );
        }
        if ( z > edge )
        {
            sum += down - (double)TRIANGLE_WIDTH;
            ++count;
        }
    }
    return form == HANG_SIDE ? sum / count : most;
}

static wisp_status hang_all( const triangle_scene* scenes, int count, int which, wisp_implicit_stiffness stiffness,
                             sag_row* out, wisp_error* error )
{
    const hang_form form = forms[which].form;
    *out = ( sag_row ){ .count = count };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        hang_plan plan = {
            .form = form,
            .is_upright = form != HANG_ROUND,
            .cloth = wisp_default_implicit_cloth_def(),
            .seconds = 0.01f,
            .steps = STEPS,
        };
        plan.cloth.stiffness_model = stiffness;
        plan.cloth.weights = WISP_IMPLICIT_WEIGHTS_NONE;
        plan.cloth.bend_rigidity = forms[which].is_stiff ? STIFF_RIGIDITY : plan.cloth.bend_rigidity;
        plan.cloth.bend_stiffness = forms[which].is_stiff ? STIFF_BENDING : plan.cloth.bend_stiffness;
        hang_result result;
        status = hang_run( &scenes[i], &plan, &result, error );
        if ( status == WISP_OK )
        {
            out->sag[i] = sag_of( &scenes[i].mesh, result.points, form );
            out->iterations = result.iterations / STEPS;
            out->ms = result.ms / STEPS;
            free( result.points );
        }
    }
    return status;
}

// Of the sag of the finest.
static double change( const sag_row* row, int from )
{
    return row->sag[from] / row->sag[row->count - 1] - 1.0;
}

// ---- the page ----

static int begin_table( figures_case* page, int count )
{
    cells header = { .count = 0 };
    cells_put( &header, "held" );
    cells_put( &header, "sag of" );
    cells_put( &header, "stiffness" );
    for ( int i = 0; i < count; ++i )
    {
        cells_put( &header, "%d mm", sizes[i] );
    }
    for ( int i = 0; i + 1 < count; ++i )
    {
        cells_put( &header, "%d %%", sizes[i] );
    }
    cells_put( &header, "iterations" );
    cells_put( &header, "ms per step" );
    return cells_begin_table( &header,
                              "Finer meshes: the sag by number of vertices, k_s 200 N/m, D 5e-6 N m unless stated "
                              "(extension, not in Noh and Jung)",
                              page->out );
}

static void add_line( figures_case* page, int table, int form, wisp_implicit_stiffness stiffness, const sag_row* row )
{
    cells line = { .count = 0 };
    cells_put( &line, "%s", forms[form].name );
    cells_put( &line, "%s", forms[form].measured );
    cells_put( &line, "%s", stiffness == WISP_IMPLICIT_STIFFNESS_MATERIAL ? "sheet" : "link" );
    for ( int i = 0; i < row->count; ++i )
    {
        cells_put_number( &line, 1e3 * row->sag[i], 2 );
    }
    for ( int i = 0; i + 1 < row->count; ++i )
    {
        cells_put( &line, "%+.1f", 100.0 * change( row, i ) );
    }
    cells_put_number( &line, row->iterations, 1 );
    cells_put_number( &line, row->ms, 2 );
    cells_end_row( &line, table, page->out );
}

// Of the finest.
static double largest_change( const sag_row* row )
{
    double most = 0.0;
    for ( int i = 0; i + 1 < row->count; ++i )
    {
        most = fmax( most, fabs( change( row, i ) ) );
    }
    return most;
}

// No link is pressed where a cloth is pulled both ways, or arcs do not give way: this is what the shares are made
// for.
static void add_pulled_rows( figures_case* page, const sag_row* sheet, const sag_row* link )
{
    const int finest = sheet[ROUND].count - 1;
    figures_add( page, "Finer meshes (extension)", "`sheet`, level, held all round, 250 vertices and more",
                 "sags within 3 % of each other", largest_change( &sheet[ROUND] ) < 0.03,
                 "%.2f to %.2f mm, %.1f %% apart; with `link` %.1f %%", 1e3 * sheet[ROUND].sag[0],
                 1e3 * sheet[ROUND].sag[finest], 100.0 * largest_change( &sheet[ROUND] ),
                 100.0 * largest_change( &link[ROUND] ) );

    // rho g L^2 / (2 k_s) of a strip that may narrow; the side that is held may not
    const double side = (double)TRIANGLE_WIDTH,
                 stiffness = (double)wisp_default_implicit_cloth_def().stretch_stiffness;
    const double strip = (double)TRIANGLE_DENSITY * (double)TRIANGLE_GRAVITY * side * side / ( 2.0 * stiffness );
    const double apart = sheet[STIFF].sag[finest] / strip - 1.0;
    figures_add( page, "Finer meshes (extension)",
                 "`sheet`, hung by one side, diagonals that do not give way (D 5e-2 N m)",
                 "sags within 5 % of each other, and within 15 % of a strip's in closed form",
                 largest_change( &sheet[STIFF] ) < 0.05 && fabs( apart ) < 0.15,
                 "%.2f to %.2f mm, at most %.1f %% apart; strip %.2f mm, %+.1f %%; with `link` %.1f %%",
                 1e3 * sheet[STIFF].sag[0], 1e3 * sheet[STIFF].sag[finest], 100.0 * largest_change( &sheet[STIFF] ),
                 1e3 * strip, 100.0 * apart, 100.0 * largest_change( &link[STIFF] ) );
}

// Edges take no pressure. A cloth that is pulled one way narrows until its diagonals hold it, and a short arc holds
// more.
static void add_narrow_rows( figures_case* page, const sag_row* sheet, const sag_row* link )
{
    const sag_row *corners = &sheet[CORNERS], *limp = &sheet[SIDE];
    figures_add( page, "Finer meshes (extension)", "`sheet`, hung by two corners, 1000 and 4000 vertices",
                 "sags within 5 % of each other", fabs( change( corners, 1 ) ) < 0.05,
                 "%.1f and %.1f mm, %+.1f %%; with `link` %.1f and %.1f mm", 1e3 * corners->sag[1],
                 1e3 * corners->sag[2], 100.0 * change( corners, 1 ), 1e3 * link[CORNERS].sag[1],
                 1e3 * link[CORNERS].sag[2] );
    results_add_note( page->out,
                      "Finer meshes, more than a few percent from 4000 vertices: hung by two corners 250 (%+.1f %%); "
                      "hung by one side 250 and 1000 (%+.1f %%, %+.1f %%).",
                      100.0 * change( corners, 0 ), 100.0 * change( limp, 0 ), 100.0 * change( limp, 1 ) );
    results_add_note( page->out, "Finer meshes: edges take no pressure, so a pulled cloth narrows until its "
                                 "diagonals hold it, and how much they hold depends on their length." );
}

wisp_status figures_hang_refined( figures_case* page, wisp_error* error )
{
    const int count = page->quick ? QUICK_MESHES : MESH_COUNT;
    triangle_scene scenes[MESH_COUNT] = { { .fabric = NULL } };
    sag_row sheet[FORM_COUNT], link[FORM_COUNT];
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        status = triangle_scene_make( sizes[i], &scenes[i], error );
    }
    const int table = begin_table( page, count );
    for ( int i = 0; i < ( page->quick ? CORNERS : FORM_COUNT ) && status == WISP_OK; ++i )
    {
        status = hang_all( scenes, count, i, WISP_IMPLICIT_STIFFNESS_MATERIAL, &sheet[i], error );
        status =
            status == WISP_OK ? hang_all( scenes, count, i, WISP_IMPLICIT_STIFFNESS_LINK, &link[i], error ) : status;
        if ( status == WISP_OK )
        {
            add_line( page, table, i, WISP_IMPLICIT_STIFFNESS_MATERIAL, &sheet[i] );
            add_line( page, table, i, WISP_IMPLICIT_STIFFNESS_LINK, &link[i] );
        }
    }
    if ( status == WISP_OK )
    {
        add_pulled_rows( page, sheet, link );
        if ( count == MESH_COUNT )
        {
            add_narrow_rows( page, sheet, link );
        }
    }
    for ( int i = 0; i < count; ++i )
    {
        triangle_scene_free( &scenes[i] );
    }
    return status;
}
