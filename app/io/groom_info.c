// Output of `wisp info` for a groom: its statistics, then its defects, by element.
#include "groom_internal.h"

#include <math.h>
#include <stdlib.h>

#include "io_file.h"
#include "mesh.h"

#include "wisp/module/definition.h"

enum
{
    LISTED = 10, // limit of listed elements of one kind; the others are counted
};

// ---- figures ---------------------------------------------------------------------------------------------------

typedef struct figure
{
    double least, most, sum;
    int count;
} figure;

static void add_to( figure* f, double value )
{
    f->least = f->count == 0 || value < f->least ? value : f->least;
    f->most = f->count == 0 || value > f->most ? value : f->most;
    f->sum += value;
    ++f->count;
}

static void print_figure( FILE* out, const char* label, const figure* f, const char* unit )
{
    fprintf( out, "  %-20s min %.6g, mean %.6g, max %.6g%s\n", label, f->least, f->sum / f->count, f->most, unit );
}

static double strand_length( const wisp_groom* groom, int s )
{
    double length = 0.0;
    for ( int v = groom->offsets[s]; v + 1 < groom->offsets[s + 1]; ++v )
    {
        length += wisp_mesh_distance( groom->points[v], groom->points[v + 1] );
    }
    return length;
}

static void print_bounds( FILE* out, const wisp_groom* groom )
{
    figure x = { .count = 0 };
    figure y = { .count = 0 };
    figure z = { .count = 0 };
    for ( int v = 0; v < groom->vertex_count; ++v )
    {
        add_to( &x, (double)groom->points[v].x );
        add_to( &y, (double)groom->points[v].y );
        add_to( &z, (double)groom->points[v].z );
    }
    fprintf( out, "  %-20s x %.6g .. %.6g, y %.6g .. %.6g, z %.6g .. %.6g m\n", "bounds", x.least, x.most, y.least,
             y.most, z.least, z.most );
}

static void print_column( FILE* out, const char* label, const float* values, int count, const char* unit )
{
    if ( values == NULL )
    {
        return;
    }
    figure f = { .count = 0 };
    for ( int v = 0; v < count; ++v )
    {
        add_to( &f, (double)values[v] );
    }
    print_figure( out, label, &f, unit );
}

static void print_stats( FILE* out, const wisp_groom* groom, const char* name )
{
    figure vertices = { .count = 0 };
    figure length = { .count = 0 };
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        add_to( &vertices, groom->offsets[s + 1] - groom->offsets[s] );
        add_to( &length, strand_length( groom, s ) );
    }
    fprintf( out, "%s: groom in %d dimensions\n", name, groom->dimension );
    fprintf( out, "  %-20s %d\n", "strands", groom->strand_count );
    fprintf( out, "  %-20s %d\n", "vertices", groom->vertex_count );
    print_figure( out, "vertices a strand", &vertices, "" );
    print_bounds( out, groom );
    print_figure( out, "length", &length, " m" );
    print_column( out, "thickness", groom->thickness, groom->vertex_count, " m" );
    print_column( out, "transparency", groom->transparency, groom->vertex_count, "" );
    fprintf( out, "  %-20s %s\n", "colour", groom->colour != NULL ? "a vertex" : "none" );
}

// ---- findings --------------------------------------------------------------------------------------------------

// Elements with one kind of defect.
typedef struct finding
{
    int count;
    int strand[LISTED];
    int other[LISTED]; // vertex within the strand, vertex count, or another strand
} finding;

static void note( finding* f, int strand, int other )
{
    if ( f->count < LISTED )
    {
        f->strand[f->count] = strand;
        f->other[f->count] = other;
    }
    ++f->count;
}

static void print_finding( FILE* out, const finding* f, const char* title, const char* line )
{
    if ( f->count == 0 )
    {
        return;
    }
    fprintf( out, "  wrong: %s: %d\n", title, f->count );
    int listed = f->count < LISTED ? f->count : LISTED;
    for ( int i = 0; i < listed; ++i )
    {
        fprintf( out, "    strand %d, %s %d\n", f->strand[i], line, f->other[i] );
    }
    if ( f->count > LISTED )
    {
        fprintf( out, "    and %d more\n", f->count - LISTED );
    }
}

static finding find_zero_segments( const wisp_groom* groom )
{
    finding f = { .count = 0 };
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        for ( int v = groom->offsets[s]; v + 1 < groom->offsets[s + 1]; ++v )
        {
            wisp_vec3 a = groom->points[v];
            wisp_vec3 b = groom->points[v + 1];
            if ( a.x == b.x && a.y == b.y && a.z == b.z )
            {
                note( &f, s, v - groom->offsets[s] );
            }
        }
    }
    return f;
}

groom_shorts groom_find_shorts( const wisp_groom* groom )
{
    groom_shorts found = { .shortest = INFINITY };
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        const int begin = groom->offsets[s], last = groom->offsets[s + 1] - 1;
        const double mean = strand_length( groom, s ) / ( last > begin ? last - begin : 1 );
        for ( int v = begin; v < last; ++v )
        {
            const double length = wisp_mesh_distance( groom->points[v], groom->points[v + 1] );
            const bool is_short = length < 1e-5 || length < 0.01 * mean;
            found.count += is_short ? 1 : 0;
            if ( is_short && length < found.shortest )
            {
                found = ( groom_shorts ){ found.count, s, v - begin, length };
            }
        }
    }
    return found;
}

static finding find_short_strands( const wisp_groom* groom )
{
    finding f = { .count = 0 };
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        int count = groom->offsets[s + 1] - groom->offsets[s];
        if ( count < 2 )
        {
            note( &f, s, count );
        }
    }
    return f;
}

static finding find_far_vertices( const wisp_groom* groom )
{
    finding f = { .count = 0 };
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        for ( int v = groom->offsets[s]; v < groom->offsets[s + 1]; ++v )
        {
            wisp_vec3 p = groom->points[v];
            if ( fmaxf( fmaxf( fabsf( p.x ), fabsf( p.y ) ), fabsf( p.z ) ) > WISP_GROOM_MAX_COORDINATE )
            {
                note( &f, s, v - groom->offsets[s] );
            }
        }
    }
    return f;
}

typedef struct root
{
    wisp_vec3 place;
    int strand;
} root;

static int compare_floats( float a, float b )
{
    return ( a > b ) - ( a < b );
}

// By position; strands break ties, so the first of equals has the lowest index.
static int compare_roots( const void* left, const void* right )
{
    const root* a = left;
    const root* b = right;
    int order = compare_floats( a->place.x, b->place.x );
    order = order != 0 ? order : compare_floats( a->place.y, b->place.y );
    order = order != 0 ? order : compare_floats( a->place.z, b->place.z );
    return order != 0 ? order : ( a->strand > b->strand ) - ( a->strand < b->strand );
}

static bool same_place( wisp_vec3 a, wisp_vec3 b )
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

// Sorting finds equals without comparing every pair. first_of[s] is the strand whose root strand s repeats, or s
// itself.
static void find_first_of( const wisp_groom* groom, root* roots, int* first_of )
{
    int count = 0;
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        first_of[s] = s;
        if ( groom->offsets[s + 1] > groom->offsets[s] )
        {
            roots[count++] = ( root ){ groom->points[groom->offsets[s]], s };
        }
    }
    qsort( roots, (size_t)count, sizeof *roots, compare_roots );
    for ( int i = 1; i < count; ++i )
    {
        if ( same_place( roots[i].place, roots[i - 1].place ) )
        {
            first_of[roots[i].strand] = first_of[roots[i - 1].strand];
        }
    }
}

static wisp_status find_shared_roots( const wisp_groom* groom, finding* f )
{
    root* roots = malloc( (size_t)groom->strand_count * sizeof *roots );
    int* first_of = malloc( (size_t)groom->strand_count * sizeof *first_of );
    wisp_status status = roots != NULL && first_of != NULL ? WISP_OK : WISP_NO_MEMORY;
    if ( status == WISP_OK )
    {
        find_first_of( groom, roots, first_of );
        for ( int s = 0; s < groom->strand_count; ++s )
        {
            if ( first_of[s] != s )
            {
                note( f, s, first_of[s] );
            }
        }
    }
    free( roots );
    free( first_of );
    return status;
}

static void print_findings( FILE* out, const wisp_groom* groom, const finding* shared )
{
    finding zero = find_zero_segments( groom );
    finding brief = find_short_strands( groom );
    finding far = find_far_vertices( groom );
    print_finding( out, &zero, "segments of zero length", "from vertex" );
    print_finding( out, &brief, "strands without a segment", "vertices" );
    print_finding( out, shared, "strands that repeat a root", "the root of strand" );
    print_finding( out, &far, "vertices beyond 1e+06 m", "vertex" );

    const groom_shorts shorts = groom_find_shorts( groom );
    if ( shorts.count > zero.count )
    {
        fprintf( out, "  note: " GROOM_SHORTS_FORMAT "\n", GROOM_SHORTS( shorts ) );
    }

    // The remaining checks concern one vertex only: the range of thickness, transparency and colour, and z in two
    // dimensions.
    wisp_error error = { .status = WISP_OK };
    bool found = zero.count + brief.count + shared->count + far.count > 0;
    if ( far.count == 0 && wisp_groom_check( groom, &error ) != WISP_OK )
    {
        fprintf( out, "  wrong: %s\n", error.message );
    }
    else if ( !found )
    {
        fputs( "  no defects\n", out );
    }
}

wisp_status wisp_groom_info( FILE* out, const wisp_groom* groom, const char* name )
{
    wisp_error error = { .status = WISP_OK };
    io_numbers numbers;
    WISP_TRY( io_numbers_begin( &numbers, &error ) );
    finding shared = { .count = 0 };
    wisp_status status = groom_check_finite( groom, name, &error );
    if ( status == WISP_OK )
    {
        status = find_shared_roots( groom, &shared );
    }
    if ( status == WISP_OK )
    {
        print_stats( out, groom, name );
        print_findings( out, groom, &shared );
    }
    else if ( error.status != WISP_OK )
    {
        fprintf( out, "%s\n", error.message );
    }
    io_numbers_end( &numbers );
    return status;
}
