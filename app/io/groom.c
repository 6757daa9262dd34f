// The container: memory and checks.
#include "groom_internal.h"

#include "io_file.h"
#include "mesh.h"

#include "wisp/module/definition.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- formats ----

// The format of a path; reading and writing of whole files.

static wisp_status read_bytes( const char* path, const unsigned char* bytes, size_t size, wisp_groom* out,
                               wisp_error* error )
{
    bool magic = size >= 4 && memcmp( bytes, "HAIR", 4 ) == 0;
    if ( magic || io_has_extension( path, ".hair" ) )
    {
        return wisp_groom_read_hair( bytes, size, path, out, error );
    }
    return wisp_fail( error, WISP_BAD_INPUT,
                      "%s: not a groom, expected a file that starts with \"HAIR\" or ends in .hair",
                      io_short_name( path ) );
}

wisp_status wisp_groom_read( const char* path, wisp_groom* out, wisp_error* error )
{
    *out = ( wisp_groom ){ 0 };
    unsigned char* bytes = NULL;
    size_t size = 0;
    WISP_TRY( io_file_read( path, WISP_GROOM_FILE_CAP, &bytes, &size, error ) );
    const wisp_status status = read_bytes( io_input_name( path ), bytes, size, out, error );
    free( bytes );
    return status;
}

typedef wisp_status groom_writer( FILE* out, const wisp_groom* groom, const char* name, wisp_error* error );

static groom_writer* find_writer( const char* path )
{
    static const struct
    {
        const char* extension;
        groom_writer* write;
    } formats[] = {
        { ".hair", wisp_groom_write_hair },
        { ".usda", wisp_groom_write_usda },
        { ".obj", wisp_groom_write_obj },
    };
    for ( int i = 0; i < WISP_COUNT( formats ); ++i )
    {
        if ( io_has_extension( path, formats[i].extension ) )
        {
            return formats[i].write;
        }
    }
    return NULL;
}

wisp_status wisp_groom_write( const char* path, const wisp_groom* groom, wisp_error* error )
{
    groom_writer* write = find_writer( path );
    if ( write == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: expected a file that ends in .hair, .usda or .obj",
                          io_short_name( path ) );
    }
    io_output output;
    WISP_TRY( io_output_open( path, &output, error ) );
    return io_output_end( &output, write( output.stream, groom, path, error ), error );
}

// ---- info ----

// Output of `wisp info` for a groom: its statistics, then its defects, by element.

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
    io_bounds bounds = { .filled = false };
    io_extend_bounds( &bounds, groom->points, groom->vertex_count );
    fprintf( out, "  %-20s ", "bounds" );
    io_print_bounds( out, &bounds );
    fputc( '\n', out );
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
    io_memory scratch = { 0 };
    root* roots = io_get( &scratch, (size_t)groom->strand_count * sizeof *roots );
    int* first_of = io_get( &scratch, (size_t)groom->strand_count * sizeof *first_of );
    const wisp_status status = scratch.is_short ? WISP_NO_MEMORY : WISP_OK;
    if ( status == WISP_OK )
    {
        find_first_of( groom, roots, first_of );
    }
    for ( int s = 0; s < groom->strand_count && status == WISP_OK; ++s )
    {
        if ( first_of[s] != s )
        {
            note( f, s, first_of[s] );
        }
    }
    io_release( &scratch );
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

// ---- grooms ----

// ---- memory ----------------------------------------------------------------------------------------------------

void wisp_groom_release( wisp_groom* groom )
{
    free( groom->offsets );
    free( groom->points );
    free( groom->thickness );
    free( groom->transparency );
    free( groom->colour );
    *groom = ( wisp_groom ){ 0 };
}

wisp_status groom_allocate( wisp_groom* groom, int strand_count, int vertex_count, int columns, const char* name,
                            wisp_error* error )
{
    size_t vertices = (size_t)vertex_count;
    bool thick = ( columns & GROOM_THICKNESS ) != 0;
    bool clear = ( columns & GROOM_TRANSPARENCY ) != 0;
    bool coloured = ( columns & GROOM_COLOUR ) != 0;
    *groom = ( wisp_groom ){
        .strand_count = strand_count,
        .vertex_count = vertex_count,
        .dimension = 3,
        .offsets = malloc( ( (size_t)strand_count + 1 ) * sizeof( int ) ),
        .points = malloc( vertices * sizeof( wisp_vec3 ) ),
        .thickness = thick ? malloc( vertices * sizeof( float ) ) : NULL,
        .transparency = clear ? malloc( vertices * sizeof( float ) ) : NULL,
        .colour = coloured ? malloc( vertices * sizeof( wisp_vec3 ) ) : NULL,
    };
    if ( groom->offsets == NULL || groom->points == NULL || ( thick && groom->thickness == NULL ) ||
         ( clear && groom->transparency == NULL ) || ( coloured && groom->colour == NULL ) )
    {
        wisp_groom_release( groom );
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d strands with %d vertices",
                          io_short_name( name ), strand_count, vertex_count );
    }
    return WISP_OK;
}

// ---- checks ----------------------------------------------------------------------------------------------------

int groom_dimension_of( const wisp_groom* groom )
{
    for ( int v = 0; v < groom->vertex_count; ++v )
    {
        if ( groom->points[v].z != 0.0f )
        {
            return 3;
        }
    }
    return 2;
}

groom_defect groom_check_offsets( const int32_t* offsets, int strand_count, int vertex_count )
{
    groom_defect defect = { "" };
    int s = 0;
    while ( s < strand_count && offsets[s + 1] >= offsets[s] && offsets[s + 1] <= vertex_count )
    {
        ++s;
    }
    if ( offsets[0] != 0 )
    {
        snprintf( defect.text, sizeof defect.text, "strand 0 starts at vertex %d, expected 0", offsets[0] );
    }
    else if ( s < strand_count )
    {
        snprintf( defect.text, sizeof defect.text, "strand %d runs from vertex %d to %d of %d", s, offsets[s],
                  offsets[s + 1], vertex_count );
    }
    else if ( offsets[strand_count] != vertex_count )
    {
        snprintf( defect.text, sizeof defect.text, "the strands end at vertex %d of %d", offsets[strand_count],
                  vertex_count );
    }
    return defect;
}

static wisp_status check_offsets( const wisp_groom* groom, const char* name, wisp_error* error )
{
    if ( groom->strand_count < 1 || groom->vertex_count < 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the groom is empty: %d strands, %d vertices", name,
                          groom->strand_count, groom->vertex_count );
    }
    if ( groom->offsets == NULL || groom->points == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the groom has no %s", name,
                          groom->offsets == NULL ? "offsets" : "points" );
    }
    const groom_defect defect = groom_check_offsets( groom->offsets, groom->strand_count, groom->vertex_count );
    return defect.text[0] == '\0' ? WISP_OK : wisp_fail( error, WISP_BAD_INPUT, "%s: %s", name, defect.text );
}

// The numbers of one vertex with their names in messages.
typedef struct vertex_numbers
{
    const char* name[8];
    float value[8];
    int count;
} vertex_numbers;

static void add_number( vertex_numbers* numbers, const char* name, float value )
{
    numbers->name[numbers->count] = name;
    numbers->value[numbers->count] = value;
    ++numbers->count;
}

static vertex_numbers gather( const wisp_groom* groom, int v )
{
    vertex_numbers numbers = { .count = 0 };
    add_number( &numbers, "x", groom->points[v].x );
    add_number( &numbers, "y", groom->points[v].y );
    add_number( &numbers, "z", groom->points[v].z );
    if ( groom->thickness != NULL )
    {
        add_number( &numbers, "thickness", groom->thickness[v] );
    }
    if ( groom->transparency != NULL )
    {
        add_number( &numbers, "transparency", groom->transparency[v] );
    }
    if ( groom->colour != NULL )
    {
        add_number( &numbers, "red", groom->colour[v].x );
        add_number( &numbers, "green", groom->colour[v].y );
        add_number( &numbers, "blue", groom->colour[v].z );
    }
    return numbers;
}

static wisp_status check_vertex_finite( const wisp_groom* groom, int s, int v, const char* name, wisp_error* error )
{
    vertex_numbers numbers = gather( groom, v );
    for ( int k = 0; k < numbers.count; ++k )
    {
        if ( !isfinite( numbers.value[k] ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: strand %d, vertex %d: %s is %s", name, s,
                              v - groom->offsets[s], numbers.name[k],
                              isnan( numbers.value[k] ) ? "NaN" : "infinite" );
        }
    }
    return WISP_OK;
}

wisp_status groom_check_finite( const wisp_groom* groom, const char* name, wisp_error* error )
{
    name = io_short_name( name );
    wisp_status status = check_offsets( groom, name, error );
    for ( int s = 0; status == WISP_OK && s < groom->strand_count; ++s )
    {
        for ( int v = groom->offsets[s]; status == WISP_OK && v < groom->offsets[s + 1]; ++v )
        {
            status = check_vertex_finite( groom, s, v, name, error );
        }
    }
    return status;
}

// Coordinates come first in gather(), thickness by name, all others are fractions.
static wisp_status check_vertex_range( const wisp_groom* groom, int s, int v, wisp_error* error )
{
    vertex_numbers numbers = gather( groom, v );
    for ( int k = 0; k < numbers.count; ++k )
    {
        bool coordinate = k < 3;
        bool thickness = groom->thickness != NULL && k == 3;
        float least = coordinate ? -WISP_GROOM_MAX_COORDINATE : 0.0f;
        float most = coordinate || thickness ? WISP_GROOM_MAX_COORDINATE : 1.0f;
        if ( numbers.value[k] < least || numbers.value[k] > most )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "groom: strand %d, vertex %d: %s: got %.9g, expected %g .. %g",
                              s, v - groom->offsets[s], numbers.name[k], (double)numbers.value[k], (double)least,
                              (double)most );
        }
    }
    if ( groom->dimension == 2 && groom->points[v].z != 0.0f )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "groom: strand %d, vertex %d: z: got %.9g, expected 0 in two dimensions", s,
                          v - groom->offsets[s], (double)groom->points[v].z );
    }
    return WISP_OK;
}

wisp_status wisp_groom_check( const wisp_groom* groom, wisp_error* error )
{
    WISP_TRY( groom_check_finite( groom, "groom", error ) );
    if ( groom->dimension != 2 && groom->dimension != 3 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "groom: got %d dimensions, expected 2 or 3", groom->dimension );
    }
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        for ( int v = groom->offsets[s]; v < groom->offsets[s + 1]; ++v )
        {
            WISP_TRY( check_vertex_range( groom, s, v, error ) );
        }
    }
    return WISP_OK;
}

wisp_status wisp_groom_of_arrays( const wisp_vec3* points, int vertex_count, const int32_t* offsets, int strand_count,
                                  const char* name, wisp_groom* out, wisp_error* error )
{
    *out = ( wisp_groom ){ 0 };
    // The checks only read; there is no groom of read-only arrays.
    wisp_groom given = { .strand_count = strand_count,
                         .vertex_count = vertex_count,
                         .dimension = 3,
                         .offsets = (int*)(uintptr_t)offsets,
                         .points = (wisp_vec3*)(uintptr_t)points };
    wisp_error cause = { 0 };
    if ( wisp_groom_check( &given, &cause ) != WISP_OK )
    {
        return wisp_fail( error, cause.status, "%s: %s", io_short_name( name ), cause.message );
    }
    WISP_TRY( groom_allocate( out, strand_count, vertex_count, 0, name, error ) );
    memcpy( out->points, points, (size_t)vertex_count * sizeof *points );
    memcpy( out->offsets, offsets, ( (size_t)strand_count + 1 ) * sizeof *offsets );
    out->dimension = groom_dimension_of( out );
    return WISP_OK;
}
