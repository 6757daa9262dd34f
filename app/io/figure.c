// The figure as a whole: the size of the cubes that gives the number of triangles, checks of the mesh, scale.
#include "figure_internal.h"

#include <math.h>
#include <stdlib.h>

enum
{
    TRIES = 6,
};

#define AREA 0.62        // of the surface of height 1, about
#define PER_CELL 3.0     // triangles times cell^2 over area, about
#define LEAST_RADIUS 0.8 // of a part, in cells

wisp_figure_generator wisp_default_figure_generator( void )
{
    return ( wisp_figure_generator ){ .height = 1.75f, .triangle_count = 8000 };
}

void wisp_figure_release( wisp_figure* figure )
{
    if ( figure != NULL )
    {
        wisp_mesh_release( &figure->mesh );
        wisp_skeleton_release( &figure->skeleton );
        wisp_skin_weights_release( &figure->weights );
    }
}

static wisp_status make_mesh( double cell, double shift, wisp_mesh* out, wisp_error* error )
{
    const double least = LEAST_RADIUS * cell;
    // planes of nodes beside the mirror plane, so that both sides are cut alike
    const double half = ( ceil( 0.42 / cell ) + 0.5 + shift ) * cell, margin = ( 2.2 + shift ) * cell;
    const mesh_vector lower = { -half, -margin, -0.12 - margin }, upper = { half, 1.0 + margin, 0.16 + margin };
    return figure_mesh( figure_body, &least, lower, upper, cell, out, error );
}

static wisp_status is_sound( const wisp_mesh* mesh, bool* sound, wisp_error* error )
{
    wisp_mesh_diagnostics report;
    const wisp_status status = wisp_mesh_examine( mesh, &report, error );
    *sound = status == WISP_OK && report.closed && report.component_count == 1 &&
             report.nonmanifold_edges.count == 0 && report.nonmanifold_vertices.count == 0 &&
             report.windings.count == 0 && report.inside_out.count == 0 && report.degenerates.count == 0 &&
             report.duplicates.count == 0;
    return status;
}

// Cubes of another size until the number of triangles fits; of another place where two sheets of the surface touch.
static wisp_status fit_mesh( int triangle_count, wisp_mesh* mesh, wisp_error* error )
{
    double cell = sqrt( AREA * PER_CELL / triangle_count );
    for ( int i = 0; i < TRIES; ++i )
    {
        bool sound = false;
        wisp_status status = make_mesh( cell, 0.13 * i, mesh, error );
        status = status == WISP_OK ? is_sound( mesh, &sound, error ) : status;
        const double ratio = (double)mesh->triangle_count / triangle_count;
        if ( status != WISP_OK || ( sound && ratio > 0.95 && ratio < 1.05 ) )
        {
            return status;
        }
        wisp_mesh_release( mesh );
        cell *= sqrt( ratio > 0.5 && ratio < 2.0 ? ratio : 1.0 );
    }
    return wisp_fail( error, WISP_BAD_INPUT,
                      "figure: got %d triangles, for which no closed mesh was found; try another number",
                      triangle_count );
}

wisp_status wisp_figure_bind( float height, const wisp_vec3* points, int point_count, wisp_skin_weights* out,
                              wisp_error* error )
{
    const size_t count = (size_t)point_count;
    *out = ( wisp_skin_weights ){ .vertex_count = point_count,
                                  .joints = malloc( count * sizeof *out->joints ),
                                  .weights = malloc( count * sizeof *out->weights ) };
    if ( out->joints == NULL || out->weights == NULL )
    {
        wisp_skin_weights_release( out );
        return wisp_fail( error, WISP_NO_MEMORY, "figure: out of memory for %d vertices", point_count );
    }
    const double tall = (double)height;
    for ( int v = 0; v < point_count; ++v )
    {
        const wisp_vec3 p = points[v];
        figure_weights( ( mesh_vector ){ (double)p.x / tall, (double)p.y / tall, (double)p.z / tall }, out->joints[v],
                        out->weights[v] );
    }
    return WISP_OK;
}

wisp_status wisp_figure_generate( const wisp_figure_generator* generator, wisp_figure* out, wisp_error* error )
{
    *out = ( wisp_figure ){ 0 };
    if ( !( generator->height >= 1e-3f && generator->height <= 1e3f ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "figure: height: got %g, expected 0.001 .. 1000",
                          (double)generator->height );
    }
    if ( generator->triangle_count < WISP_FIGURE_MIN_TRIANGLES ||
         generator->triangle_count > WISP_FIGURE_MAX_TRIANGLES )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "figure: triangles: got %d, expected %d .. %d",
                          generator->triangle_count, WISP_FIGURE_MIN_TRIANGLES, WISP_FIGURE_MAX_TRIANGLES );
    }
    wisp_status status = fit_mesh( generator->triangle_count, &out->mesh, error );
    status = status == WISP_OK ? wisp_figure_skeleton( generator->height, &out->skeleton, error ) : status;
    for ( int v = 0; v < out->mesh.vertex_count && status == WISP_OK; ++v )
    {
        wisp_vec3* p = &out->mesh.points[v];
        *p = ( wisp_vec3 ){ generator->height * p->x, generator->height * p->y, generator->height * p->z };
    }
    status = status == WISP_OK ? wisp_figure_bind( generator->height, out->mesh.points, out->mesh.vertex_count,
                                                   &out->weights, error )
                               : status;
    if ( status != WISP_OK )
    {
        wisp_figure_release( out );
    }
    return status;
}
