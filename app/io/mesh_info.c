// Text of the doctor: `wisp info` for a mesh, rejections, and repairs that were done.
#include "mesh_internal.h"

#include <stdlib.h>

#include "io_file.h"

// ---- findings --------------------------------------------------------------------------------------------------

typedef enum element_kind
{
    ELEMENT_EDGE,
    ELEMENT_FANS,
    ELEMENT_SHELL,
    ELEMENT_DUPLICATE,
    ELEMENT_TRIANGLE,
    ELEMENT_VERTEX,
} element_kind;

// The kinds of defect, in the order of the text, and the demand that each of them violates.
typedef struct finding_kind
{
    size_t at; // of the finding in a report
    int demand;
    element_kind element;
    const char* title;
} finding_kind;

static const finding_kind kinds[] = {
    { offsetof( wisp_mesh_diagnostics, open_edges ), WISP_MESH_CLOSED, ELEMENT_EDGE, "open edges" },
    { offsetof( wisp_mesh_diagnostics, nonmanifold_edges ), WISP_MESH_MANIFOLD, ELEMENT_EDGE,
      "edges of more than two triangles" },
    { offsetof( wisp_mesh_diagnostics, nonmanifold_vertices ), WISP_MESH_MANIFOLD, ELEMENT_FANS,
      "vertices where separate fans of triangles meet" },
    { offsetof( wisp_mesh_diagnostics, windings ), WISP_MESH_ORIENTED, ELEMENT_EDGE,
      "edges along which the winding disagrees" },
    { offsetof( wisp_mesh_diagnostics, inside_out ), WISP_MESH_ORIENTED, ELEMENT_SHELL,
      "components turned inside out" },
    { offsetof( wisp_mesh_diagnostics, duplicates ), WISP_MESH_CLEAN, ELEMENT_DUPLICATE, "duplicate triangles" },
    { offsetof( wisp_mesh_diagnostics, degenerates ), WISP_MESH_CLEAN, ELEMENT_TRIANGLE, "triangles without area" },
    { offsetof( wisp_mesh_diagnostics, unreferenced ), WISP_MESH_CLEAN, ELEMENT_VERTEX, "unreferenced vertices" },
};

static const wisp_mesh_finding* finding_of( const wisp_mesh_diagnostics* report, const finding_kind* kind )
{
    return (const wisp_mesh_finding*)( (const char*)report + kind->at );
}

typedef struct element_words
{
    char text[80];
} element_words;

static element_words name_element( const wisp_mesh_finding* finding, element_kind kind, int i )
{
    element_words words;
    int a = finding->first[i], b = finding->second[i];
    switch ( kind )
    {
        case ELEMENT_EDGE:
            snprintf( words.text, sizeof words.text, "edge of vertices %d and %d", a, b );
            break;
        case ELEMENT_FANS:
            snprintf( words.text, sizeof words.text, "vertex %d, fans %d", a, b );
            break;
        case ELEMENT_DUPLICATE:
            snprintf( words.text, sizeof words.text, "triangle %d, as triangle %d", a, b );
            break;
        case ELEMENT_SHELL:
        case ELEMENT_TRIANGLE:
        case ELEMENT_VERTEX:
            snprintf( words.text, sizeof words.text, "%s %d",
                      kind == ELEMENT_SHELL      ? "component"
                      : kind == ELEMENT_TRIANGLE ? "triangle"
                                                 : "vertex",
                      a );
            break;
    }
    return words;
}

wisp_status wisp_mesh_require( const wisp_mesh_diagnostics* report, int demands, const char* name, wisp_error* error )
{
    for ( int k = 0; k < WISP_COUNT( kinds ); ++k )
    {
        const wisp_mesh_finding* finding = finding_of( report, &kinds[k] );
        if ( ( demands & kinds[k].demand ) != 0 && finding->count > 0 )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: %s: %d, the first is %s", io_short_name( name ),
                              kinds[k].title, finding->count, name_element( finding, kinds[k].element, 0 ).text );
        }
    }
    if ( ( demands & WISP_MESH_ONE_COMPONENT ) != 0 && report->component_count != 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: got %d components, expected one; the second starts with triangle %d",
                          io_short_name( name ), report->component_count, report->components[1].first_triangle );
    }
    return WISP_OK;
}

// ---- printing --------------------------------------------------------------------------------------------------

static void print_stats( FILE* out, const wisp_mesh_diagnostics* r, const char* name )
{
    fprintf( out, "%s: %s mesh of triangles\n", name, r->closed ? "closed" : "open" );
    fprintf( out, "  %-20s %d\n", "vertices", r->vertex_count );
    fprintf( out, "  %-20s %d\n", "triangles", r->triangle_count );
    fprintf( out, "  %-20s %d\n", "edges", r->edge_count );
    fprintf( out, "  %-20s %d\n", "Euler characteristic", r->euler_characteristic );
    fprintf( out, "  %-20s x %.6g .. %.6g, y %.6g .. %.6g, z %.6g .. %.6g m\n", "bounds", (double)r->lowest.x,
             (double)r->highest.x, (double)r->lowest.y, (double)r->highest.y, (double)r->lowest.z,
             (double)r->highest.z );
    fprintf( out, "  %-20s min %.6g, mean %.6g, max %.6g m\n", "edge length", r->min_edge, r->edge_mean,
             r->max_edge );
    fprintf( out, "  %-20s %.6g m^2\n", "area", r->area );
    if ( r->closed )
    {
        fprintf( out, "  %-20s %.6g m^3\n", "volume", r->volume );
    }
}

// What per-vertex values the file has, and how it was made one per vertex.
static void print_attributes( FILE* out, const wisp_mesh_diagnostics* r )
{
    const wisp_vec3 low = r->lowest_colour, high = r->highest_colour;
    if ( r->has_colours )
    {
        fprintf( out, "  %-20s red %.4g .. %.4g, green %.4g .. %.4g, blue %.4g .. %.4g\n", "colours", (double)low.x,
                 (double)high.x, (double)low.y, (double)high.y, (double)low.z, (double)high.z );
    }
    if ( r->colour_missing_count > 0 )
    {
        fprintf( out, "  note: vertices without a colour, which are white: %d\n", r->colour_missing_count );
    }
    if ( r->has_uvs )
    {
        fprintf( out, "  %-20s u %.6g .. %.6g, v %.6g .. %.6g\n", "texture coordinates", (double)r->lowest_uv[0],
                 (double)r->highest_uv[0], (double)r->lowest_uv[1], (double)r->highest_uv[1] );
    }
    if ( r->uv_seam_count > 0 )
    {
        fprintf( out, "  note: vertices with several texture coordinates, of which the first are kept: %d\n",
                 r->uv_seam_count );
    }
    if ( r->uv_missing_count > 0 )
    {
        fprintf( out, "  note: vertices without texture coordinates, which are at (0, 0): %d\n",
                 r->uv_missing_count );
    }
}

static void print_shells( FILE* out, const wisp_mesh_diagnostics* r )
{
    fprintf( out, "  %-20s %d\n", "components", r->component_count );
    int listed = r->component_count < WISP_MESH_LISTED ? r->component_count : WISP_MESH_LISTED;
    for ( int s = 0; r->component_count > 1 && s < listed; ++s )
    {
        const wisp_mesh_component* component = &r->components[s];
        fprintf( out, "    component %d, from triangle %d: %d triangles, %s, area %.6g m^2", s,
                 component->first_triangle, component->triangle_count, component->closed ? "closed" : "open",
                 component->area );
        if ( component->closed && component->consistent )
        {
            fprintf( out, ", volume %.6g m^3", component->volume );
        }
        fputc( '\n', out );
    }
    if ( r->component_count > WISP_MESH_LISTED )
    {
        fprintf( out, "    and %d more\n", r->component_count - WISP_MESH_LISTED );
    }
}

// Open edges are usual in cloth, so they are a note and no defect.
static void print_finding( FILE* out, const wisp_mesh_diagnostics* r, const finding_kind* kind )
{
    const wisp_mesh_finding* finding = finding_of( r, kind );
    if ( finding->count == 0 )
    {
        return;
    }
    fprintf( out, "  %s: %s: %d", kind->demand == WISP_MESH_CLOSED ? "note" : "wrong", kind->title, finding->count );
    if ( kind->demand == WISP_MESH_CLOSED )
    {
        fprintf( out, " in %d %s", r->open_loop_count, r->open_loop_count == 1 ? "loop" : "loops" );
    }
    fputc( '\n', out );
    int listed = finding->count < WISP_MESH_LISTED ? finding->count : WISP_MESH_LISTED;
    for ( int i = 0; i < listed; ++i )
    {
        fprintf( out, "    %s\n", name_element( finding, kind->element, i ).text );
    }
    if ( finding->count > listed )
    {
        fprintf( out, "    and %d more\n", finding->count - listed );
    }
}

void wisp_mesh_print( FILE* out, const wisp_mesh_diagnostics* report, const char* name )
{
    // A host's decimal comma is a matter of appearance: if memory for a locale is missing, it is printed.
    io_numbers numbers = { 0 };
    wisp_status plain = io_numbers_begin( &numbers, NULL );
    print_stats( out, report, name );
    print_attributes( out, report );
    print_shells( out, report );
    bool found = false;
    for ( int k = 0; k < WISP_COUNT( kinds ); ++k )
    {
        found = found || ( finding_of( report, &kinds[k] )->count > 0 && kinds[k].demand != WISP_MESH_CLOSED );
        print_finding( out, report, &kinds[k] );
    }
    if ( !found )
    {
        fputs( "  no defects\n", out );
    }
    if ( plain == WISP_OK )
    {
        io_numbers_end( &numbers );
    }
}

wisp_status wisp_mesh_count_near( const wisp_mesh* mesh, int* out, wisp_error* error )
{
    int32_t* became = malloc( (size_t)mesh->vertex_count * sizeof *became );
    wisp_status status = became == NULL
                             ? wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d vertices", mesh->vertex_count )
                             : mesh_weld_find( mesh, 0.0f, became, error );
    *out = 0;
    for ( int v = 0; v < mesh->vertex_count && status == WISP_OK; ++v )
    {
        *out += became[v] != v;
    }
    free( became );
    return status;
}

wisp_status wisp_mesh_info( FILE* out, const wisp_mesh* mesh, const char* name )
{
    wisp_mesh_diagnostics report;
    wisp_error error = { .status = WISP_OK };
    int near = 0;
    wisp_status status = wisp_mesh_examine( mesh, &report, &error );
    if ( status == WISP_OK )
    {
        wisp_mesh_print( out, &report, name );
        status = wisp_mesh_count_near( mesh, &near, &error );
    }
    if ( near > 0 )
    {
        fprintf( out, "  note: vertices that the repair `weld` merges into others: %d\n", near );
    }
    if ( status != WISP_OK )
    {
        fprintf( out, "%s: %s\n", name, error.message );
    }
    return status;
}

void wisp_mesh_print_repairs( FILE* out, const wisp_mesh_repairs* repairs, const char* name )
{
    const struct
    {
        int count;
        const char *one, *many;
    } deeds[] = {
        { repairs->vertices_welded, "vertex was merged into another", "vertices were merged into others" },
        { repairs->collapsed_dropped, "triangle that collapsed was removed",
          "triangles that collapsed were removed" },
        { repairs->degenerates_dropped, "triangle without area was removed", "triangles without area were removed" },
        { repairs->duplicates_dropped, "duplicate triangle was removed", "duplicate triangles were removed" },
        { repairs->triangles_turned, "triangle was turned over", "triangles were turned over" },
        { repairs->triangles_flipped, "triangle was flipped", "triangles were flipped" },
        { repairs->unreferenced_dropped, "unreferenced vertex was removed", "unreferenced vertices were removed" },
    };
    bool done = false;
    for ( int i = 0; i < WISP_COUNT( deeds ); ++i )
    {
        if ( deeds[i].count > 0 )
        {
            fprintf( out, "%s: %d %s\n", name, deeds[i].count, deeds[i].count == 1 ? deeds[i].one : deeds[i].many );
            done = true;
        }
    }
    if ( !done )
    {
        fprintf( out, "%s: nothing to repair\n", name );
    }
}
