// Defects of a mesh, by element. Half-edges sorted by their vertices show everything: an edge is a run, its length
// gives open, manifold or nonmanifold, its directions show whether the winding agrees.
#include "mesh_internal.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stdlib.h>

// ---- info ----

// Text of the doctor: `wisp info` for a mesh, rejections, and repairs that were done.

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
    fprintf( out, "  %-20s ", "bounds" );
    io_print_bounds( out, &( io_bounds ){ r->lowest, r->highest, true } );
    fputc( '\n', out );
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

static void print_report( FILE* out, const wisp_mesh_diagnostics* report, const char* name )
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
    io_memory scratch = { 0 };
    int32_t* became = io_get( &scratch, (size_t)mesh->vertex_count * sizeof *became );
    const wisp_status status =
        became == NULL ? wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d vertices", mesh->vertex_count )
                       : mesh_weld_find( mesh, 0.0f, became, error );
    *out = 0;
    for ( int v = 0; v < mesh->vertex_count && status == WISP_OK; ++v )
    {
        *out += became[v] != v;
    }
    io_release( &scratch );
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
        print_report( out, &report, name );
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

// ---- doctor ----

typedef struct examination
{
    const wisp_mesh* mesh;
    wisp_mesh_diagnostics* report;
    io_memory memory; // of all below
    mesh_edges edges;
    int32_t* component_sets;         // of triangles that share an edge
    int32_t* fan_sets;               // of corners 3 * t + k whose triangles share an edge at the corner's vertex
    int32_t* border_sets;            // of vertices joined by open edges
    int32_t* first_of;               // [triangle_count] of duplicates
    int32_t* component_number;       // [triangle_count] representative triangle of a shell
    int32_t* vertex_count;           // [vertex_count] number of fans
    bool* flags;                     // [vertex_count] referenced by a triangle, on a border
    wisp_mesh_component* components; // [report->shell_count]
} examination;

enum
{
    VERTEX_NAMED,
    VERTEX_ON_BORDER,
    VERTEX_FLAGS,
};

static void note( wisp_mesh_finding* finding, int first, int second )
{
    if ( finding->count < WISP_MESH_LISTED )
    {
        finding->first[finding->count] = first;
        finding->second[finding->count] = second;
    }
    ++finding->count;
}

// ---- edges -----------------------------------------------------------------------------------------------------

static void measure_edge( wisp_mesh_diagnostics* report, const wisp_mesh* mesh, int32_t half )
{
    mesh_vector d = mesh_between( mesh->points[mesh_from( mesh, half )], mesh->points[mesh_to( mesh, half )] );
    double length = sqrt( mesh_dot( d, d ) );
    bool is_first = report->edge_count == 0;
    report->min_edge = is_first || length < report->min_edge ? length : report->min_edge;
    report->max_edge = is_first || length > report->max_edge ? length : report->max_edge;
    report->edge_mean += length;
    ++report->edge_count;
}

static void note_edge( wisp_mesh_finding* finding, const wisp_mesh* mesh, int32_t half )
{
    int32_t a = mesh_from( mesh, half ), b = mesh_to( mesh, half );
    note( finding, a < b ? a : b, a < b ? b : a );
}

// The corner of the half-edge's triangle that lies at vertex v, one end of the half-edge.
static int32_t corner_at( const wisp_mesh* mesh, int32_t half, int32_t v )
{
    return mesh_from( mesh, half ) == v ? half : mesh_next_half( half );
}

static void join_neighbours( examination* x, int32_t half, int32_t other )
{
    const wisp_mesh* mesh = x->mesh;
    int32_t a = mesh_from( mesh, half ), b = mesh_to( mesh, half );
    mesh_sets_merge( x->component_sets, half / 3, other / 3 );
    mesh_sets_merge( x->fan_sets, corner_at( mesh, half, a ), corner_at( mesh, other, a ) );
    mesh_sets_merge( x->fan_sets, corner_at( mesh, half, b ), corner_at( mesh, other, b ) );
}

static void examine_edge( examination* x, int begin, int end )
{
    const wisp_mesh* mesh = x->mesh;
    const int32_t* half = x->edges.half;
    int32_t first = half[begin];
    measure_edge( x->report, mesh, first );
    if ( end - begin == 1 )
    {
        note_edge( &x->report->open_edges, mesh, first );
        int32_t a = mesh_from( mesh, first ), b = mesh_to( mesh, first );
        mesh_sets_merge( x->border_sets, a, b );
        x->flags[VERTEX_FLAGS * (size_t)a + VERTEX_ON_BORDER] = true;
        x->flags[VERTEX_FLAGS * (size_t)b + VERTEX_ON_BORDER] = true;
    }
    if ( end - begin == 2 && mesh_from( mesh, first ) == mesh_from( mesh, half[begin + 1] ) )
    {
        note_edge( &x->report->windings, mesh, first );
    }
    if ( end - begin > 2 )
    {
        note_edge( &x->report->nonmanifold_edges, mesh, first );
    }
    for ( int i = begin + 1; i < end; ++i )
    {
        join_neighbours( x, first, half[i] );
    }
}

static void examine_edges( examination* x )
{
    for ( int e = 0; e < x->edges.edge_count; ++e )
    {
        examine_edge( x, x->edges.starts[e], x->edges.starts[e + 1] );
    }
    x->report->edge_mean /= x->report->edge_count > 0 ? x->report->edge_count : 1;
}

// ---- triangles and vertices ------------------------------------------------------------------------------------

static void examine_triangles( examination* x )
{
    const wisp_mesh* mesh = x->mesh;
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        if ( mesh_is_degenerate( mesh, t ) )
        {
            note( &x->report->degenerates, t, 0 );
        }
        if ( x->first_of[t] != t )
        {
            note( &x->report->duplicates, t, x->first_of[t] );
        }
        for ( int32_t c = 3 * t; c < 3 * t + 3; ++c )
        {
            x->flags[VERTEX_FLAGS * (size_t)mesh->triangles[c] + VERTEX_NAMED] = true;
            // A corner that represents its set represents a fan.
            x->vertex_count[mesh->triangles[c]] += !mesh_names_twice( mesh, t ) && x->fan_sets[c] == c;
        }
    }
}

static void examine_vertices( examination* x )
{
    wisp_mesh_diagnostics* report = x->report;
    io_bounds bounds = { .filled = false };
    int in_use = 0;
    io_extend_bounds( &bounds, x->mesh->points, x->mesh->vertex_count );
    report->lowest = bounds.least;
    report->highest = bounds.most;
    for ( int v = 0; v < x->mesh->vertex_count; ++v )
    {
        const bool* flags = x->flags + VERTEX_FLAGS * (size_t)v;
        in_use += x->vertex_count[v] > 0;
        if ( x->vertex_count[v] > 1 )
        {
            note( &report->nonmanifold_vertices, v, x->vertex_count[v] );
        }
        if ( !flags[VERTEX_NAMED] )
        {
            note( &report->unreferenced, v, 0 );
        }
        report->open_loop_count += flags[VERTEX_ON_BORDER] && x->border_sets[v] == v;
    }
    report->euler_characteristic = in_use - report->edge_count + x->edges.half_count / 3;
}

// ---- shells ----------------------------------------------------------------------------------------------------

static wisp_status number_shells( examination* x, wisp_error* error )
{
    const wisp_mesh* mesh = x->mesh;
    int count = 0;
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        bool is_first = x->component_sets[t] == t && !mesh_names_twice( mesh, t );
        x->component_number[t] = is_first ? count++ : 0;
    }
    x->report->component_count = count;
    x->components = io_get( &x->memory, ( (size_t)count + 1 ) * sizeof *x->components );
    if ( x->components == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d components", count );
    }
    return WISP_OK;
}

static wisp_mesh_component* component_of( examination* x, int t )
{
    return x->components + x->component_number[mesh_sets_find( x->component_sets, t )];
}

// Volume is summed over tetrahedra whose apex is a vertex of the shell itself: far from the origin nothing cancels.
static void measure_triangle( examination* x, int t )
{
    const wisp_mesh* mesh = x->mesh;
    wisp_mesh_component* component = component_of( x, t );
    component->first_triangle = component->triangle_count == 0 ? t : component->first_triangle;
    ++component->triangle_count;
    const int32_t* c = mesh->triangles + 3 * t;
    wisp_vec3 tip = mesh->points[mesh->triangles[3 * component->first_triangle]];
    mesh_vector normal = mesh_cross( mesh_between( mesh->points[c[0]], mesh->points[c[1]] ),
                                     mesh_between( mesh->points[c[0]], mesh->points[c[2]] ) );
    component->area += 0.5 * sqrt( mesh_dot( normal, normal ) );
    component->volume += mesh_dot( mesh_between( tip, mesh->points[c[0]] ), normal ) / 6.0;
}

static void judge_edge( examination* x, int begin, int end )
{
    const int32_t* half = x->edges.half;
    wisp_mesh_component* component = component_of( x, half[begin] / 3 );
    int balance = 0;
    for ( int i = begin; i < end; ++i )
    {
        balance += mesh_from( x->mesh, half[i] ) < mesh_to( x->mesh, half[i] ) ? 1 : -1;
    }
    component->closed = component->closed && ( end - begin ) % 2 == 0;
    component->consistent = component->consistent && ( end - begin == 1 || balance == 0 );
}

static void report_shell( wisp_mesh_diagnostics* report, wisp_mesh_component* component, int number )
{
    component->volume = component->closed && component->consistent ? component->volume : 0.0;
    report->closed = report->closed && component->closed;
    report->area += component->area;
    report->volume += component->volume;
    if ( component->volume < 0.0 )
    {
        note( &report->inside_out, number, 0 );
    }
    if ( number < WISP_MESH_LISTED )
    {
        report->components[number] = *component;
    }
}

static void examine_shells( examination* x )
{
    for ( int s = 0; s < x->report->component_count; ++s )
    {
        x->components[s].closed = true;
        x->components[s].consistent = true;
    }
    for ( int t = 0; t < x->mesh->triangle_count; ++t )
    {
        if ( !mesh_names_twice( x->mesh, t ) )
        {
            measure_triangle( x, t );
        }
    }
    for ( int e = 0; e < x->edges.edge_count; ++e )
    {
        judge_edge( x, x->edges.starts[e], x->edges.starts[e + 1] );
    }
    x->report->closed = x->report->component_count > 0;
    for ( int s = 0; s < x->report->component_count; ++s )
    {
        report_shell( x->report, &x->components[s], s );
    }
}

// ---- colours and texture coordinates ---------------------------------------------------------------------------

static void examine_attributes( const wisp_mesh* mesh, wisp_mesh_diagnostics* report )
{
    report->has_colours = mesh->colours != NULL;
    report->has_uvs = mesh->uvs != NULL;
    report->colour_missing_count = mesh->colour_missing_count;
    report->uv_missing_count = mesh->uv_missing_count;
    report->uv_seam_count = mesh->uv_seam_count;
    io_bounds colours = { .filled = false };
    io_extend_bounds( &colours, mesh->colours, report->has_colours ? mesh->vertex_count : 0 );
    report->lowest_colour = colours.least;
    report->highest_colour = colours.most;
    for ( int i = 0; report->has_uvs && i < 2 * mesh->vertex_count; ++i )
    {
        const float value = mesh->uvs[i];
        report->lowest_uv[i % 2] = i < 2 ? value : fminf( report->lowest_uv[i % 2], value );
        report->highest_uv[i % 2] = i < 2 ? value : fmaxf( report->highest_uv[i % 2], value );
    }
}

// ---- examination -----------------------------------------------------------------------------------------------

static wisp_status examine( examination* x, wisp_error* error )
{
    const size_t triangles = (size_t)x->mesh->triangle_count, vertices = (size_t)x->mesh->vertex_count;
    io_memory* memory = &x->memory;
    x->component_sets = mesh_sets_make( memory, x->mesh->triangle_count );
    x->fan_sets = mesh_sets_make( memory, 3 * x->mesh->triangle_count );
    x->border_sets = mesh_sets_make( memory, x->mesh->vertex_count );
    x->first_of = io_get( memory, triangles * sizeof *x->first_of );
    x->component_number = io_get( memory, triangles * sizeof *x->component_number );
    x->vertex_count = io_get( memory, vertices * sizeof *x->vertex_count );
    x->flags = io_get( memory, vertices * VERTEX_FLAGS * sizeof *x->flags );
    if ( memory->is_short )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory to examine %d triangles", x->mesh->triangle_count );
    }
    WISP_TRY( mesh_edges_build( x->mesh, memory, &x->edges, error ) );
    WISP_TRY( mesh_find_duplicates( x->mesh, NULL, x->first_of, error ) );
    examine_attributes( x->mesh, x->report );
    examine_edges( x );
    examine_triangles( x );
    examine_vertices( x );
    WISP_TRY( number_shells( x, error ) );
    examine_shells( x );
    return WISP_OK;
}

wisp_status wisp_mesh_examine( const wisp_mesh* mesh, wisp_mesh_diagnostics* report, wisp_error* error )
{
    *report = ( wisp_mesh_diagnostics ){ .vertex_count = mesh->vertex_count, .triangle_count = mesh->triangle_count };
    examination x = { .mesh = mesh, .report = report };
    wisp_status status = mesh_check( mesh, "mesh", error );
    status = status == WISP_OK ? examine( &x, error ) : status;
    io_release( &x.memory );
    if ( status != WISP_OK )
    {
        *report = ( wisp_mesh_diagnostics ){ 0 };
    }
    return status;
}
