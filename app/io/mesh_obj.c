// Wavefront OBJ. The first pass checks and counts lines of vertices and faces, so that memory is bounded by the file.
// The second pass reads their numbers.
#include "mesh_internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "io_file.h"

#include "wisp/module/definition.h"

typedef enum line_kind
{
    LINE_OTHER,
    LINE_VERTEX,
    LINE_UV,
    LINE_FACE,
} line_kind;

typedef struct obj_reading
{
    mesh_word text;
    const char* name;
    wisp_error* error;
    wisp_mesh* mesh;
    mesh_fan fan;
    int vertex_count; // counted by the first pass; mesh->vertex_count counts what the second has read
    int face_count, faces_seen;
    int line;               // the current one, from 1
    int coloured_count;     // vertices with a colour, counted by the first pass
    float* uvs;             // [uv_count][2] of the `vt` lines
    int uv_count, uvs_seen; // in all, and before the current line
    io_memory memory;       // of the arrays here
    bool* is_seam;          // [vertex_count] has several coordinates
    bool* has_uv;           // [vertex_count]
} obj_reading;

// Cuts off the text after a #.
static line_kind kind_of( mesh_word* whole )
{
    const char* comment = whole->length > 0 ? memchr( whole->text, '#', whole->length ) : NULL;
    whole->length = comment != NULL ? (size_t)( comment - whole->text ) : whole->length;
    mesh_word line = *whole;
    mesh_word word = mesh_next_word( &line );
    // A keyword alone is a line of its kind without content, which the checks below refuse.
    return mesh_word_is( word, "v" )    ? LINE_VERTEX
           : mesh_word_is( word, "vt" ) ? LINE_UV
           : mesh_word_is( word, "f" )  ? LINE_FACE
                                        : LINE_OTHER;
}

// Refuse the current line.
WISP_PRINTF( 2, 3 ) static wisp_status refuse( const obj_reading* reading, const char* format, ... )
{
    char message[200];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( message, sizeof message, format, arguments );
    va_end( arguments );
    return wisp_fail( reading->error, WISP_BAD_INPUT, "%s: line %d: %s", reading->name, reading->line, message );
}

// ---- the first pass --------------------------------------------------------------------------------------------

static wisp_status check_numbers( obj_reading* reading, mesh_word line, int* count )
{
    mesh_next_word( &line );
    *count = 0;
    for ( mesh_word word = mesh_next_word( &line ); word.length > 0; word = mesh_next_word( &line ) )
    {
        if ( !mesh_word_is_number( word ) || word.length > MESH_WORD_LONGEST )
        {
            return refuse( reading, "got \"%s\", expected a number", mesh_quote_word( word ).text );
        }
        ++*count;
    }
    return WISP_OK;
}

static wisp_status check_uv_line( obj_reading* reading, mesh_word line )
{
    int count = 0;
    ++reading->uv_count;
    WISP_TRY( check_numbers( reading, line, &count ) );
    return count >= 1 && count <= 3
               ? WISP_OK
               : refuse( reading, "got texture coordinates of %d numbers, expected 1 .. 3", count );
}

static wisp_status check_vertex_line( obj_reading* reading, mesh_word line )
{
    int count = 0;
    ++reading->vertex_count;
    WISP_TRY( check_numbers( reading, line, &count ) );
    reading->coloured_count += count > 4;
    return count == 3 || count == 4 || count == 6 || count == 7
               ? WISP_OK
               : refuse( reading, "got a vertex of %d numbers, expected 3, 4, 6 or 7", count );
}

static mesh_word cut_at_slash( mesh_word* word )
{
    const char* slash = word->length > 0 ? memchr( word->text, '/', word->length ) : NULL;
    size_t length = slash == NULL ? word->length : (size_t)( slash - word->text );
    mesh_word part = { word->text, length };
    size_t next = slash == NULL ? length : length + 1;
    *word = ( mesh_word ){ word->text + next, word->length - next };
    return part;
}

// v, v/t, v//n or v/t/n; none of them 0.
static bool is_corner( mesh_word word )
{
    int slashes = 0;
    for ( size_t i = 0; i < word.length; ++i )
    {
        slashes += word.text[i] == '/';
    }
    for ( int part = 0; part <= slashes; ++part )
    {
        mesh_word index = cut_at_slash( &word );
        int32_t value = 0;
        bool may_miss = part == 1 && slashes == 2;
        if ( !( index.length == 0 && may_miss ) && ( !mesh_word_is_integer( index, &value ) || value == 0 ) )
        {
            return false;
        }
    }
    return slashes <= 2;
}

static wisp_status check_face_line( obj_reading* reading, mesh_word line )
{
    mesh_next_word( &line );
    int count = 0;
    ++reading->face_count;
    for ( mesh_word word = mesh_next_word( &line ); word.length > 0; word = mesh_next_word( &line ) )
    {
        if ( !is_corner( word ) )
        {
            return refuse( reading, "got \"%s\", expected a corner of a face", mesh_quote_word( word ).text );
        }
        if ( ++count > WISP_MESH_CORNER_CAP )
        {
            return refuse( reading, "expected a face of at most %d corners", WISP_MESH_CORNER_CAP );
        }
    }
    return count >= 3 ? WISP_OK : refuse( reading, "got a face of %d corners, expected at least 3", count );
}

// A zero byte is in no text.
static wisp_status check_is_text( const char* bytes, size_t size, const char* name, wisp_error* error )
{
    if ( size == 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the file is empty", name );
    }
    const char* zero = memchr( bytes, 0, size );
    if ( zero != NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %zu: got a zero byte, expected text", name,
                          (size_t)( zero - bytes ) );
    }
    return WISP_OK;
}

static wisp_status check_counts( const obj_reading* reading )
{
    if ( reading->vertex_count == 0 || reading->face_count == 0 )
    {
        return wisp_fail( reading->error, WISP_BAD_INPUT, "%s: not a mesh: got %d vertices and %d faces",
                          reading->name, reading->vertex_count, reading->face_count );
    }
    return reading->vertex_count <= WISP_MESH_VERTEX_CAP
               ? WISP_OK
               : wisp_fail( reading->error, WISP_BAD_INPUT, "%s: got %d vertices, expected at most %d", reading->name,
                            reading->vertex_count, WISP_MESH_VERTEX_CAP );
}

// Counts fit an int: a line has at least one byte and a file no more than WISP_MESH_FILE_CAP of them.
static wisp_status check_lines( obj_reading* reading )
{
    mesh_word rest = reading->text, line;
    for ( reading->line = 1; mesh_next_line( &rest, &line ); ++reading->line )
    {
        const line_kind kind = kind_of( &line );
        WISP_TRY( kind == LINE_VERTEX ? check_vertex_line( reading, line )
                  : kind == LINE_UV   ? check_uv_line( reading, line )
                  : kind == LINE_FACE ? check_face_line( reading, line )
                                      : WISP_OK );
    }
    return check_counts( reading );
}

// ---- the second pass -------------------------------------------------------------------------------------------

// All `vt` lines, before the others: a face may come before what it names.
static wisp_status read_uvs( obj_reading* reading )
{
    mesh_word rest = reading->text, line;
    int found = 0;
    for ( reading->line = 1; found < reading->uv_count && mesh_next_line( &rest, &line ); ++reading->line )
    {
        const bool is_uv = kind_of( &line ) == LINE_UV;
        mesh_next_word( &line );
        for ( int k = 0; k < 2 && is_uv; ++k )
        {
            const mesh_word word = mesh_next_word( &line );
            const float value = word.length > 0 ? (float)mesh_word_value( word ) : 0.0f;
            if ( !isfinite( value ) )
            {
                return refuse( reading, "\"%s\" is too large for a float", mesh_quote_word( word ).text );
            }
            reading->uvs[2 * (size_t)found + (size_t)k] = value;
        }
        found += is_uv;
    }
    return WISP_OK;
}

// Three numbers, or four of which the last is a weight that is not used; then maybe a colour.
static wisp_status read_vertex( obj_reading* reading, mesh_word line )
{
    float values[7] = { 0.0f };
    int count = 0;
    for ( mesh_word word = mesh_next_word( &line ); word.length > 0; word = mesh_next_word( &line ) )
    {
        values[count++] = (float)mesh_word_value( word );
    }
    wisp_mesh* mesh = reading->mesh;
    const int v = mesh->vertex_count++;
    const float* c = values + count - 3;
    mesh->points[v] = ( wisp_vec3 ){ values[0], values[1], values[2] };
    if ( mesh->colours != NULL )
    {
        mesh->colours[v] = count > 4 ? ( wisp_vec3 ){ c[0], c[1], c[2] } : ( wisp_vec3 ){ 1.0f, 1.0f, 1.0f };
    }
    return mesh_check_vertex( mesh->points[v], v, reading->name, reading->error );
}

// The first coordinates of a vertex stay. An index without a line gives none.
static void take_uv( obj_reading* reading, int32_t vertex, int number )
{
    const int64_t index = number > 0 ? (int64_t)number - 1 : (int64_t)reading->uvs_seen + number;
    if ( reading->mesh->uvs == NULL || number == 0 || index < 0 || index >= reading->uv_count )
    {
        return;
    }
    float* kept = reading->mesh->uvs + 2 * (size_t)vertex;
    const float* given = reading->uvs + 2 * index;
    if ( !reading->has_uv[vertex] )
    {
        kept[0] = given[0];
        kept[1] = given[1];
        reading->has_uv[vertex] = true;
    }
    reading->is_seam[vertex] = reading->is_seam[vertex] || kept[0] != given[0] || kept[1] != given[1];
}

static wisp_status read_corner( obj_reading* reading, mesh_word corner )
{
    const int known = reading->mesh->vertex_count;
    int32_t number = 0, uv = 0;
    mesh_word_is_integer( cut_at_slash( &corner ), &number );
    mesh_word_is_integer( cut_at_slash( &corner ), &uv );
    const int64_t vertex = number > 0 ? (int64_t)number - 1 : (int64_t)known + number;
    if ( vertex < 0 || vertex >= reading->vertex_count )
    {
        return refuse( reading, "face %d: got vertex %d, the file has %d", reading->faces_seen, number,
                       number < 0 ? known : reading->vertex_count );
    }
    take_uv( reading, (int32_t)vertex, uv );
    return mesh_fan_corner( &reading->fan, (int32_t)vertex, reading->error );
}

static wisp_status read_face( obj_reading* reading, mesh_word line )
{
    for ( mesh_word word = mesh_next_word( &line ); word.length > 0; word = mesh_next_word( &line ) )
    {
        WISP_TRY( read_corner( reading, word ) );
    }
    reading->fan.corner_count = 0;
    ++reading->faces_seen;
    return WISP_OK;
}

// Coordinates of no vertex are none; the others are counted.
static void finish_uvs( obj_reading* reading )
{
    wisp_mesh* mesh = reading->mesh;
    int given = 0;
    for ( int v = 0; mesh->uvs != NULL && v < mesh->vertex_count; ++v )
    {
        given += reading->has_uv[v];
        mesh->uv_seam_count += reading->is_seam[v];
    }
    mesh->uv_missing_count = given > 0 ? mesh->vertex_count - given : 0;
    if ( given == 0 )
    {
        free( mesh->uvs );
        mesh->uvs = NULL;
    }
}

static wisp_status allocate( obj_reading* reading )
{
    wisp_mesh* mesh = reading->mesh;
    const size_t vertices = (size_t)reading->vertex_count, uvs = (size_t)reading->uv_count;
    mesh->points = malloc( vertices * sizeof *mesh->points );
    mesh->colours = reading->coloured_count > 0 ? malloc( vertices * sizeof *mesh->colours ) : NULL;
    mesh->colour_missing_count = reading->coloured_count > 0 ? reading->vertex_count - reading->coloured_count : 0;
    bool enough = mesh->points != NULL && ( mesh->colours != NULL ) == ( reading->coloured_count > 0 );
    if ( enough && uvs > 0 )
    {
        mesh->uvs = calloc( vertices, 2 * sizeof *mesh->uvs );
        reading->uvs = io_get( &reading->memory, 2 * uvs * sizeof *reading->uvs );
        reading->has_uv = io_get( &reading->memory, vertices * sizeof *reading->has_uv );
        reading->is_seam = io_get( &reading->memory, vertices * sizeof *reading->is_seam );
        enough = mesh->uvs != NULL && !reading->memory.is_short;
    }
    return enough ? WISP_OK
                  : wisp_fail( reading->error, WISP_NO_MEMORY, "%s: out of memory for %d vertices", reading->name,
                               reading->vertex_count );
}

static wisp_status read_lines( obj_reading* reading )
{
    mesh_word rest = reading->text, line;
    WISP_TRY( read_uvs( reading ) );
    for ( reading->line = 1; mesh_next_line( &rest, &line ); ++reading->line )
    {
        const line_kind kind = kind_of( &line );
        mesh_next_word( &line );
        reading->uvs_seen += kind == LINE_UV;
        WISP_TRY( kind == LINE_VERTEX ? read_vertex( reading, line )
                  : kind == LINE_FACE ? read_face( reading, line )
                                      : WISP_OK );
    }
    finish_uvs( reading );
    return WISP_OK;
}

static wisp_status read_text( obj_reading* reading, size_t size )
{
    io_numbers numbers;
    WISP_TRY( check_is_text( reading->text.text, size, reading->name, reading->error ) );
    if ( size > WISP_MESH_FILE_CAP )
    {
        return wisp_fail( reading->error, WISP_BAD_INPUT, "%s: expected at most %zu bytes", reading->name,
                          WISP_MESH_FILE_CAP );
    }
    WISP_TRY( check_lines( reading ) );
    WISP_TRY( allocate( reading ) );
    WISP_TRY( io_numbers_begin( &numbers, reading->error ) );
    const wisp_status status = read_lines( reading );
    io_numbers_end( &numbers );
    WISP_TRY( status );
    mesh_fan_finish( &reading->fan );
    return mesh_check( reading->mesh, reading->name, reading->error );
}

wisp_status wisp_mesh_read_obj( const void* bytes, size_t size, const char* name, wisp_mesh* out, wisp_error* error )
{
    *out = ( wisp_mesh ){ 0 };
    name = io_short_name( name );
    obj_reading reading = { .text = { bytes, size }, .name = name, .error = error, .mesh = out };
    reading.fan = ( mesh_fan ){ .mesh = out, .name = name };
    const wisp_status status = read_text( &reading, size );
    io_release( &reading.memory );
    if ( status != WISP_OK )
    {
        wisp_mesh_release( out );
    }
    return status;
}
