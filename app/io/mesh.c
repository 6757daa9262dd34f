// The container: memory, checks, and triangles added one by one.
#include "mesh_internal.h"

#include "gltf.h"
#include "io_bytes.h"
#include "io_file.h"

#include "wisp/module/definition.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- formats ----

// The format of a path; reading and writing of whole files.

typedef wisp_status mesh_reader( const void* bytes, size_t size, const char* name, wisp_mesh* out,
                                 wisp_error* error );
typedef wisp_status mesh_writer( FILE* out, const wisp_mesh* mesh, const char* name, wisp_error* error );

typedef struct mesh_format
{
    const char* extension;
    mesh_reader* read;
    mesh_writer* write;
} mesh_format;

static const mesh_format formats[] = {
    { ".obj", wisp_mesh_read_obj, mesh_put_obj },
    { ".ply", wisp_mesh_read_ply, mesh_put_ply },
};

static const mesh_format* find_format( const char* path )
{
    for ( int i = 0; i < WISP_COUNT( formats ); ++i )
    {
        if ( io_has_extension( path, formats[i].extension ) )
        {
            return &formats[i];
        }
    }
    return NULL;
}

wisp_status wisp_mesh_read( const char* path, wisp_mesh* out, wisp_error* error )
{
    *out = ( wisp_mesh ){ 0 };
    const bool has_name = !io_is_standard( path );
    if ( gltf_is_path( path ) )
    {
        return gltf_mesh_read( path, out, error );
    }
    const mesh_format* format = find_format( path );
    if ( format == NULL && has_name )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: not a mesh, expected a file that ends in .obj, .ply, .glb or .gltf",
                          io_short_name( path ) );
    }
    unsigned char* bytes = NULL;
    size_t size = 0;
    WISP_TRY( io_file_read( path, WISP_MESH_FILE_CAP, &bytes, &size, error ) );
    // Standard input has no extension, but a PLY begins with its name.
    format = has_name ? format : &formats[size >= 3 && memcmp( bytes, "ply", 3 ) == 0 ? 1 : 0];
    const wisp_status status = format->read( bytes, size, io_input_name( path ), out, error );
    free( bytes );
    return status;
}

wisp_status wisp_mesh_write( const char* path, const wisp_mesh* mesh, wisp_error* error )
{
    const mesh_format* format = find_format( path );
    if ( format == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: expected a file that ends in .obj or .ply",
                          io_short_name( path ) );
    }
    io_output output;
    WISP_TRY( io_output_open( path, &output, error ) );
    return io_output_end( &output, format->write( output.stream, mesh, path, error ), error );
}

// ---- text ----

// Lines, words and numbers of untrusted files. Independent of the locale, and needs no zero at the end.

enum
{
    SHOWN = 24, // limit of characters of a word in a message
    MAX_EXPONENT_DIGITS = 4,
};

static bool is_blank( char c )
{
    return c == ' ' || c == '\t';
}

static bool is_digit( char c )
{
    return c >= '0' && c <= '9';
}

mesh_word mesh_next_word( mesh_word* line )
{
    size_t begin = 0;
    while ( begin < line->length && is_blank( line->text[begin] ) )
    {
        ++begin;
    }
    size_t end = begin;
    while ( end < line->length && !is_blank( line->text[end] ) )
    {
        ++end;
    }
    mesh_word word = { line->text + begin, end - begin };
    *line = ( mesh_word ){ line->text + end, line->length - end };
    return word;
}

bool mesh_next_line( mesh_word* rest, mesh_word* line )
{
    if ( rest->length == 0 )
    {
        return false;
    }
    size_t end = 0;
    while ( end < rest->length && rest->text[end] != '\n' && rest->text[end] != '\r' )
    {
        ++end;
    }
    *line = ( mesh_word ){ rest->text, end };
    bool is_pair = end + 1 < rest->length && rest->text[end] == '\r' && rest->text[end + 1] == '\n';
    size_t next = end == rest->length ? end : end + ( is_pair ? 2 : 1 );
    *rest = ( mesh_word ){ rest->text + next, rest->length - next };
    return true;
}

bool mesh_word_is( mesh_word word, const char* expected )
{
    return word.length == strlen( expected ) && memcmp( word.text, expected, word.length ) == 0;
}

// ---- numbers ---------------------------------------------------------------------------------------------------

static size_t skip_sign( mesh_word word, size_t at )
{
    return at < word.length && ( word.text[at] == '+' || word.text[at] == '-' ) ? at + 1 : at;
}

static size_t skip_digits( mesh_word word, size_t at )
{
    while ( at < word.length && is_digit( word.text[at] ) )
    {
        ++at;
    }
    return at;
}

bool mesh_word_is_number( mesh_word word )
{
    size_t begin = skip_sign( word, 0 );
    size_t at = skip_digits( word, begin );
    size_t digits = at - begin;
    if ( at < word.length && word.text[at] == '.' )
    {
        size_t end = skip_digits( word, at + 1 );
        digits += end - ( at + 1 );
        at = end;
    }
    if ( digits == 0 )
    {
        return false;
    }
    if ( at < word.length && ( word.text[at] == 'e' || word.text[at] == 'E' ) )
    {
        size_t exponent = skip_sign( word, at + 1 );
        at = skip_digits( word, exponent );
        if ( at == exponent || at - exponent > MAX_EXPONENT_DIGITS )
        {
            return false;
        }
    }
    return at == word.length;
}

double mesh_word_value( mesh_word word )
{
    // strtod needs a zero after the number, and the file has none.
    char text[MESH_WORD_LONGEST + 1] = { 0 };
    memcpy( text, word.text, word.length < MESH_WORD_LONGEST ? word.length : MESH_WORD_LONGEST );
    return strtod( text, NULL );
}

bool mesh_word_is_integer( mesh_word word, int32_t* value )
{
    size_t begin = skip_sign( word, 0 );
    if ( begin == word.length || skip_digits( word, begin ) != word.length )
    {
        return false;
    }
    int64_t sum = 0;
    for ( size_t at = begin; at < word.length; ++at )
    {
        sum = 10 * sum + ( word.text[at] - '0' );
        if ( sum > INT32_MAX )
        {
            return false;
        }
    }
    *value = (int32_t)( word.text[0] == '-' ? -sum : sum );
    return true;
}

// ---- messages -------------------------------------------------------------------------------------------------

mesh_quote mesh_quote_word( mesh_word word )
{
    mesh_quote quote = { { 0 } };
    size_t shown = word.length < SHOWN ? word.length : SHOWN;
    for ( size_t i = 0; i < shown; ++i )
    {
        char c = word.text[i];
        quote.text[i] = (char)( c > ' ' && c <= '~' ? c : '?' );
    }
    if ( shown < word.length )
    {
        memcpy( quote.text + shown, "...", 4 );
    }
    return quote;
}

// ---- writing ----

// Writes meshes: OBJ for readers and modelling programs, little-endian PLY for size and speed.

// Nine digits restore every float bit for bit.
static void put_obj_vertex( FILE* out, const wisp_mesh* mesh, int v )
{
    const wisp_vec3 p = mesh->points[v];
    fprintf( out, "v %.9g %.9g %.9g", (double)p.x, (double)p.y, (double)p.z );
    if ( mesh->colours != NULL )
    {
        const wisp_vec3 c = mesh->colours[v];
        fprintf( out, " %.9g %.9g %.9g", (double)c.x, (double)c.y, (double)c.z );
    }
    fputc( '\n', out );
}

wisp_status mesh_put_obj( FILE* out, const wisp_mesh* mesh, const char* name, wisp_error* error )
{
    WISP_TRY( mesh_check( mesh, name, error ) );
    io_numbers numbers;
    WISP_TRY( io_numbers_begin( &numbers, error ) );
    fprintf( out, "# Wisp %s: %d vertices, %d triangles, metres\n", WISP_VERSION_STRING, mesh->vertex_count,
             mesh->triangle_count );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        put_obj_vertex( out, mesh, v );
    }
    for ( int v = 0; mesh->uvs != NULL && v < mesh->vertex_count; ++v )
    {
        fprintf( out, "vt %.9g %.9g\n", (double)mesh->uvs[2 * v], (double)mesh->uvs[2 * v + 1] );
    }
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        const int a = mesh->triangles[3 * t] + 1, b = mesh->triangles[3 * t + 1] + 1,
                  c = mesh->triangles[3 * t + 2] + 1;
        mesh->uvs != NULL ? fprintf( out, "f %d/%d %d/%d %d/%d\n", a, a, b, b, c, c )
                          : fprintf( out, "f %d %d %d\n", a, b, c );
    }
    io_numbers_end( &numbers );
    return WISP_OK;
}

void mesh_put_triangles( FILE* out, const wisp_mesh* mesh )
{
    unsigned char row[13];
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        const int32_t* triangle = mesh->triangles + 3 * t;
        row[0] = 3;
        for ( int k = 0; k < 3; ++k )
        {
            io_put_u32( row + 1 + 4 * k, (uint32_t)triangle[k] );
        }
        fwrite( row, 1, sizeof row, out );
    }
}

// A byte is read back as this float.
static float colour_of_byte( int byte )
{
    return (float)( (double)byte / 255.0 );
}

static int byte_of_colour( float channel )
{
    return (int)( 255.0f * fminf( fmaxf( channel, 0.0f ), 1.0f ) + 0.5f );
}

// Whether bytes, which most readers expect, restore every colour bit for bit.
static bool colours_are_bytes( const wisp_mesh* mesh )
{
    bool same = true;
    for ( int v = 0; mesh->colours != NULL && v < mesh->vertex_count; ++v )
    {
        const float c[3] = { mesh->colours[v].x, mesh->colours[v].y, mesh->colours[v].z };
        for ( int k = 0; k < 3; ++k )
        {
            same = same && colour_of_byte( byte_of_colour( c[k] ) ) == c[k] && !signbit( c[k] );
        }
    }
    return same;
}

static void put_ply_vertex( FILE* out, const wisp_mesh* mesh, int v, bool bytes )
{
    unsigned char row[32];
    size_t size = 12;
    io_put_vec3( row, mesh->points[v] );
    if ( mesh->colours != NULL && bytes )
    {
        const wisp_vec3 c = mesh->colours[v];
        row[size] = (unsigned char)byte_of_colour( c.x );
        row[size + 1] = (unsigned char)byte_of_colour( c.y );
        row[size + 2] = (unsigned char)byte_of_colour( c.z );
        size += 3;
    }
    else if ( mesh->colours != NULL )
    {
        io_put_vec3( row + size, mesh->colours[v] );
        size += 12;
    }
    if ( mesh->uvs != NULL )
    {
        io_put_float( row + size, mesh->uvs[2 * v] );
        io_put_float( row + size + 4, mesh->uvs[2 * v + 1] );
        size += 8;
    }
    fwrite( row, 1, size, out );
}

wisp_status mesh_put_ply( FILE* out, const wisp_mesh* mesh, const char* name, wisp_error* error )
{
    WISP_TRY( mesh_check( mesh, name, error ) );
    const bool bytes = colours_are_bytes( mesh );
    fprintf( out,
             "ply\nformat binary_little_endian 1.0\ncomment Wisp %s, metres\n"
             "element vertex %d\nproperty float x\nproperty float y\nproperty float z\n",
             WISP_VERSION_STRING, mesh->vertex_count );
    if ( mesh->colours != NULL )
    {
        const char* type = bytes ? "uchar" : "float";
        fprintf( out, "property %s red\nproperty %s green\nproperty %s blue\n", type, type, type );
    }
    fprintf( out, "%selement face %d\nproperty list uchar int vertex_indices\nend_header\n",
             mesh->uvs != NULL ? "property float s\nproperty float t\n" : "", mesh->triangle_count );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        put_ply_vertex( out, mesh, v, bytes );
    }
    mesh_put_triangles( out, mesh );
    return WISP_OK;
}

// ---- meshes ----

enum
{
    FIRST_TRIANGLES = 256, // initial capacity for the triangles of a file
};

// ---- memory ----------------------------------------------------------------------------------------------------

void wisp_mesh_release( wisp_mesh* mesh )
{
    if ( mesh == NULL )
    {
        return;
    }
    free( mesh->points );
    free( mesh->triangles );
    free( mesh->colours );
    free( mesh->uvs );
    *mesh = ( wisp_mesh ){ 0 };
}

wisp_status mesh_allocate( wisp_mesh* mesh, int vertex_count, int triangle_count, const char* name,
                           wisp_error* error )
{
    *mesh = ( wisp_mesh ){
        .points = malloc( (size_t)vertex_count * sizeof( wisp_vec3 ) ),
        .triangles = malloc( (size_t)triangle_count * 3 * sizeof( int32_t ) ),
        .vertex_count = vertex_count,
        .triangle_count = triangle_count,
    };
    if ( mesh->points == NULL || mesh->triangles == NULL )
    {
        wisp_mesh_release( mesh );
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d vertices and %d triangles",
                          io_short_name( name ), vertex_count, triangle_count );
    }
    return WISP_OK;
}

static wisp_status out_of_memory( const wisp_mesh* mesh, const char* name, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d vertices", io_short_name( name ),
                      mesh->vertex_count );
}

wisp_status mesh_allocate_colours( wisp_mesh* mesh, const char* name, wisp_error* error )
{
    mesh->colours = calloc( (size_t)mesh->vertex_count, sizeof *mesh->colours );
    return mesh->colours != NULL ? WISP_OK : out_of_memory( mesh, name, error );
}

wisp_status mesh_allocate_uvs( wisp_mesh* mesh, const char* name, wisp_error* error )
{
    mesh->uvs = calloc( (size_t)mesh->vertex_count, 2 * sizeof *mesh->uvs );
    return mesh->uvs != NULL ? WISP_OK : out_of_memory( mesh, name, error );
}

static wisp_status copy_attributes( const wisp_mesh* mesh, wisp_mesh* out, const char* name, wisp_error* error )
{
    const size_t vertices = (size_t)mesh->vertex_count;
    if ( mesh->colours != NULL )
    {
        WISP_TRY( mesh_allocate_colours( out, name, error ) );
        memcpy( out->colours, mesh->colours, vertices * sizeof *out->colours );
    }
    if ( mesh->uvs != NULL )
    {
        WISP_TRY( mesh_allocate_uvs( out, name, error ) );
        memcpy( out->uvs, mesh->uvs, 2 * vertices * sizeof *out->uvs );
    }
    out->colour_missing_count = mesh->colour_missing_count;
    out->uv_missing_count = mesh->uv_missing_count;
    out->uv_seam_count = mesh->uv_seam_count;
    return WISP_OK;
}

wisp_status mesh_copy( const wisp_mesh* mesh, wisp_mesh* out, const char* name, wisp_error* error )
{
    WISP_TRY( mesh_allocate( out, mesh->vertex_count, mesh->triangle_count, name, error ) );
    memcpy( out->points, mesh->points, (size_t)mesh->vertex_count * sizeof *out->points );
    memcpy( out->triangles, mesh->triangles, 3 * (size_t)mesh->triangle_count * sizeof *out->triangles );
    const wisp_status status = copy_attributes( mesh, out, name, error );
    if ( status != WISP_OK )
    {
        wisp_mesh_release( out );
    }
    return status;
}

static wisp_status grow( mesh_fan* fan, wisp_error* error )
{
    if ( fan->mesh->triangle_count >= WISP_MESH_TRIANGLE_CAP )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: expected at most %d triangles", io_short_name( fan->name ),
                          WISP_MESH_TRIANGLE_CAP );
    }
    int capacity = fan->capacity == 0 ? FIRST_TRIANGLES : 2 * fan->capacity;
    int32_t* larger = realloc( fan->mesh->triangles, (size_t)capacity * 3 * sizeof *larger );
    if ( larger == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d triangles", io_short_name( fan->name ),
                          capacity );
    }
    fan->mesh->triangles = larger;
    fan->capacity = capacity;
    return WISP_OK;
}

wisp_status mesh_fan_corner( mesh_fan* fan, int32_t vertex, wisp_error* error )
{
    if ( fan->corner_count >= 2 )
    {
        wisp_mesh* mesh = fan->mesh;
        WISP_TRY( mesh->triangle_count < fan->capacity ? WISP_OK : grow( fan, error ) );
        int32_t* triangle = mesh->triangles + 3 * mesh->triangle_count;
        triangle[0] = fan->first;
        triangle[1] = fan->previous;
        triangle[2] = vertex;
        ++mesh->triangle_count;
    }
    fan->first = fan->corner_count == 0 ? vertex : fan->first;
    fan->previous = vertex;
    ++fan->corner_count;
    return WISP_OK;
}

void mesh_fan_finish( mesh_fan* fan )
{
    size_t size = (size_t)fan->mesh->triangle_count * 3 * sizeof( int32_t );
    int32_t* exact = size > 0 ? realloc( fan->mesh->triangles, size ) : NULL;
    fan->mesh->triangles = exact != NULL ? exact : fan->mesh->triangles;
}

// ---- checks ----------------------------------------------------------------------------------------------------

wisp_status mesh_check_vertex( wisp_vec3 p, int v, const char* name, wisp_error* error )
{
    const float values[] = { p.x, p.y, p.z };
    for ( int axis = 0; axis < 3; ++axis )
    {
        if ( !isfinite( values[axis] ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: vertex %d: %c is %s", io_short_name( name ), v, "xyz"[axis],
                              isnan( values[axis] ) ? "NaN" : "infinite" );
        }
    }
    return WISP_OK;
}

static wisp_status check_attributes( const wisp_mesh* mesh, int v, const char* name, wisp_error* error )
{
    const wisp_vec3 c = mesh->colours != NULL ? mesh->colours[v] : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    const bool good_uv = mesh->uvs == NULL || ( isfinite( mesh->uvs[2 * v] ) && isfinite( mesh->uvs[2 * v + 1] ) );
    const bool good_colour = isfinite( c.x ) && isfinite( c.y ) && isfinite( c.z );
    return good_uv && good_colour
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "%s: vertex %d: %s not finite", io_short_name( name ), v,
                            good_uv ? "its colour is" : "its texture coordinates are" );
}

static wisp_status check_sizes( const wisp_mesh* mesh, const char* name, wisp_error* error )
{
    if ( mesh->vertex_count < 1 || mesh->triangle_count < 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the mesh is empty: %d vertices, %d triangles",
                          io_short_name( name ), mesh->vertex_count, mesh->triangle_count );
    }
    if ( mesh->vertex_count > WISP_MESH_VERTEX_CAP || mesh->triangle_count > WISP_MESH_TRIANGLE_CAP )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %d vertices and %d triangles, expected at most %d and %d",
                          io_short_name( name ), mesh->vertex_count, mesh->triangle_count, WISP_MESH_VERTEX_CAP,
                          WISP_MESH_TRIANGLE_CAP );
    }
    if ( mesh->points == NULL || mesh->triangles == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the mesh has no %s", io_short_name( name ),
                          mesh->points == NULL ? "points" : "triangles" );
    }
    return WISP_OK;
}

wisp_status mesh_check( const wisp_mesh* mesh, const char* name, wisp_error* error )
{
    WISP_TRY( check_sizes( mesh, name, error ) );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        WISP_TRY( mesh_check_vertex( mesh->points[v], v, name, error ) );
        WISP_TRY( check_attributes( mesh, v, name, error ) );
    }
    for ( int c = 0; c < 3 * mesh->triangle_count; ++c )
    {
        const int32_t vertex = mesh->triangles[c];
        if ( vertex < 0 || vertex >= mesh->vertex_count )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: triangle %d: corner %d: got vertex %d, expected 0 .. %d",
                              io_short_name( name ), c / 3, c % 3, vertex, mesh->vertex_count - 1 );
        }
    }
    return WISP_OK;
}

wisp_status wisp_mesh_of_arrays( const wisp_vec3* points, int vertex_count, const int32_t* triangles,
                                 int triangle_count, const char* name, wisp_mesh* out, wisp_error* error )
{
    *out = ( wisp_mesh ){ 0 };
    // The check only reads; there is no mesh of read-only arrays.
    const wisp_mesh given = { .points = (wisp_vec3*)(uintptr_t)points,
                              .triangles = (int32_t*)(uintptr_t)triangles,
                              .vertex_count = vertex_count,
                              .triangle_count = triangle_count };
    WISP_TRY( mesh_check( &given, name, error ) );
    WISP_TRY( mesh_allocate( out, vertex_count, triangle_count, name, error ) );
    memcpy( out->points, points, (size_t)vertex_count * sizeof *points );
    memcpy( out->triangles, triangles, 3 * (size_t)triangle_count * sizeof *triangles );
    return WISP_OK;
}
