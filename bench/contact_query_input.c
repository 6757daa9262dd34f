#include "contact_query_input.h"

#include "surface_implementation.h"

#include <math.h>
#include <stdlib.h>

const char* const query_input_source_names[QUERY_INPUT_SOURCES] = { "sheet in 4 layers", "2 spheres" };
const char* const query_input_kind_names[QUERY_INPUT_KINDS] = { "particles", "vertices, triangles", "edges" };

static const float SPHERE_RADIUS = 0.5f, SHEET_SPACING = 0.01f; // m
static const int SHEET_LAYERS = 4;

// A box is half a thickness and the reach wide; the default margin is two thicknesses, shared by both sides.
static const float HALF_WIDTH = 1.5f;

// ---- meshes ----

wisp_status query_input_make_mesh( query_input_source source, int size, query_input_mesh* out, wisp_error* error )
{
    const bool is_sheet = source == QUERY_INPUT_SHEET;
    wisp_mesh mesh = { 0 };
    wisp_mesh_generator generator =
        wisp_default_mesh_generator( is_sheet ? WISP_MESH_PLANE_ALTERNATING : WISP_MESH_ICOSPHERE );
    generator.columns = generator.rows = generator.level = size;
    generator.spacing = SHEET_SPACING;
    generator.radius = SPHERE_RADIUS;
    *out = ( query_input_mesh ){ .source = source, .copies = is_sheet ? 1 : 2 };
    wisp_fabric_def def = wisp_default_fabric_def();
    def.bend_links = false; // only points, edges and triangles are of use
    wisp_status status = wisp_mesh_generate( &generator, &mesh, error );
    status = status == WISP_OK ? surface_cook( &mesh, def, &out->fabric, error ) : status;
    const float edge_of_level_0 = 1.0515f; // of an icosahedron in the unit sphere; each level halves it
    out->edge = is_sheet ? SHEET_SPACING : ldexpf( edge_of_level_0 * SPHERE_RADIUS, -size );
    out->extent = is_sheet ? SHEET_SPACING * (float)( size - 1 ) : SPHERE_RADIUS;
    wisp_mesh_release( &mesh );
    return status;
}

void query_input_free_mesh( query_input_mesh* mesh )
{
    wisp_fabric_release( mesh->fabric );
    *mesh = ( query_input_mesh ){ .fabric = NULL };
}

// ---- places ----

// To and fro along x in layers a thickness apart, which go up and down together along z.
static wisp_vec3 fold( const query_input_mesh* mesh, wisp_vec3 p, float gap )
{
    const float length = mesh->extent / (float)SHEET_LAYERS, along = p.x + 0.5f * mesh->extent;
    const int layer = (int)fminf( fmaxf( along / length, 0.0f ), (float)( SHEET_LAYERS - 1 ) );
    const float in = along - length * (float)layer;
    const float ripple = 3.0f * mesh->edge * sinf( 0.16f * p.z / mesh->edge );
    return ( wisp_vec3 ){ layer % 2 == 0 ? in : length - in, gap * (float)layer + ripple, p.z };
}

// Aslant to the axes, so that no box is flat.
static wisp_vec3 tilt( wisp_vec3 p )
{
    const float c = 0.8f, s = 0.6f;
    const wisp_vec3 q = { c * p.x - s * p.y, s * p.x + c * p.y, p.z };
    return ( wisp_vec3 ){ q.x, c * q.y - s * q.z, s * q.y + c * q.z };
}

static wisp_vec3 place( const query_input_mesh* mesh, wisp_vec3 rest, int copy, float gap )
{
    wisp_vec3 p = rest;
    if ( mesh->source == QUERY_INPUT_SHEET )
    {
        p = fold( mesh, rest, gap );
    }
    else
    {
        p.x += (float)copy * ( 2.0f * mesh->extent + gap );
    }
    return tilt( p );
}

// What moves goes about as far as its reach, neighbours alike.
static wisp_vec3 move( wisp_vec3 p, float reach )
{
    return ( wisp_vec3 ){ p.x + reach * sinf( 9.0f * p.y ), p.y + reach * sinf( 8.0f * p.z + 1.0f ),
                          p.z + reach * sinf( 7.0f * p.x + 2.0f ) };
}

// ---- boxes ----

static wisp_aabb box_around( const wisp_vec3* points, const int32_t* corners, int count, int first, float wide )
{
    wisp_aabb box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    for ( int i = 0; i < count; ++i )
    {
        const wisp_vec3 p = points[first + corners[i]];
        const float x[3] = { p.x, p.y, p.z };
        for ( int k = 0; k < 3; ++k )
        {
            box.lower[k] = fminf( box.lower[k], x[k] - wide );
            box.upper[k] = fmaxf( box.upper[k], x[k] + wide );
        }
    }
    return box;
}

// Boxes around this many corners each, or around single points without a list.
static void fill( const query_input_mesh* mesh, const wisp_vec3* points, const int32_t* corners, int size, int count,
                  float wide, wisp_aabb* out )
{
    for ( int copy = 0; copy < mesh->copies; ++copy )
    {
        for ( int32_t i = 0; i < count; ++i )
        {
            const int32_t* list = corners != NULL ? corners + (size_t)size * (size_t)i : &i;
            out[copy * count + i] = box_around( points, list, size, copy * mesh->fabric->vertex_count, wide );
        }
    }
}

static wisp_aabb* take( int count )
{
    return malloc( (size_t)count * sizeof( wisp_aabb ) );
}

static bool reserve( const query_input_mesh* mesh, query_input_kind kind, query_input_boxes* out )
{
    const wisp_fabric* f = mesh->fabric;
    const int counts[QUERY_INPUT_KINDS] = { f->vertex_count, f->triangle_count, f->edge_count };
    out->box_count = mesh->copies * counts[kind];
    out->particle_count = mesh->copies * f->vertex_count;
    out->query_count = kind == QUERY_INPUT_VERTICES ? out->particle_count : out->box_count;
    bool is_there = true;
    for ( int t = 0; t < QUERY_INPUT_TIMES; ++t )
    {
        out->boxes[t] = take( out->box_count );
        out->queries[t] = kind == QUERY_INPUT_VERTICES ? take( out->query_count ) : NULL;
        is_there = is_there && out->boxes[t] && ( kind != QUERY_INPUT_VERTICES || out->queries[t] );
    }
    return is_there;
}

static void fill_kind( const query_input_mesh* mesh, query_input_kind kind, const wisp_vec3* points, float wide,
                       int time, query_input_boxes* out )
{
    const wisp_fabric* f = mesh->fabric;
    switch ( kind )
    {
        case QUERY_INPUT_EDGES:
            fill( mesh, points, f->edges, 2, f->edge_count, wide, out->boxes[time] );
            break;
        case QUERY_INPUT_VERTICES:
            fill( mesh, points, f->triangles, 3, f->triangle_count, wide, out->boxes[time] );
            fill( mesh, points, NULL, 1, f->vertex_count, wide, out->queries[time] );
            break;
        default:
            fill( mesh, points, NULL, 1, f->vertex_count, wide, out->boxes[time] );
            break;
    }
}

wisp_status query_input_make_boxes( const query_input_mesh* mesh, query_input_kind kind, query_input_boxes* out,
                                    wisp_error* error )
{
    const wisp_fabric* f = mesh->fabric;
    const float thickness = kind == QUERY_INPUT_PARTICLES ? mesh->edge : 0.25f * mesh->edge;
    *out = ( query_input_boxes ){ .box_count = 0 };
    wisp_vec3* points = calloc( (size_t)mesh->copies * (size_t)f->vertex_count, sizeof( wisp_vec3 ) );
    if ( points == NULL || reserve( mesh, kind, out ) == false )
    {
        free( points );
        query_input_free_boxes( out );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the boxes of %d vertices", f->vertex_count );
    }
    for ( int i = 0; i < mesh->copies * f->vertex_count; ++i )
    {
        points[i] = place( mesh, f->rest[i % f->vertex_count], i / f->vertex_count, thickness );
    }
    fill_kind( mesh, kind, points, HALF_WIDTH * thickness, QUERY_INPUT_BEFORE, out );
    for ( int i = 0; i < mesh->copies * f->vertex_count; ++i )
    {
        points[i] = move( points[i], thickness );
    }
    fill_kind( mesh, kind, points, HALF_WIDTH * thickness, QUERY_INPUT_AFTER, out );
    free( points );
    return WISP_OK;
}

void query_input_free_boxes( query_input_boxes* boxes )
{
    for ( int t = 0; t < QUERY_INPUT_TIMES; ++t )
    {
        free( boxes->boxes[t] );
        free( boxes->queries[t] );
    }
    *boxes = ( query_input_boxes ){ .box_count = 0 };
}
