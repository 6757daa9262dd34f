// Wavefront OBJ. The first pass checks and counts lines of vertices and faces, so that memory is bounded by the file.
// Then tinyobjloader reads those lines and no others, and every number from it is checked against the counts.
#include "mesh_internal.h"

#include <stdlib.h>
#include <string.h>

#include "io_file.h"

typedef enum line_kind
{
    LINE_OTHER,
    LINE_VERTEX,
    LINE_FACE,
} line_kind;

// The state of the checked text while the library reads it.
typedef struct obj_reading
{
    mesh_word rest; // lines not yet read by the library
    const char* name;
    wisp_error* error;
    wisp_status status; // the reason for stopping
    wisp_mesh* mesh;
    mesh_fan fan;
    int vertex_count; // announced by the first pass; mesh->vertex_count counts what arrived
    int face_count, faces_seen;
    int line; // of the library's current line, from 1
} obj_reading;

// Cuts off the text after a #, which the library would read as an index.
static line_kind kind_of( mesh_word* whole )
{
    const char* comment = whole->length > 0 ? memchr( whole->text, '#', whole->length ) : NULL;
    whole->length = comment != NULL ? (size_t)( comment - whole->text ) : whole->length;
    mesh_word line = *whole;
    mesh_word word = mesh_next_word( &line );
    // A keyword alone is a line of its kind without content, which the checks below refuse.
    return mesh_word_is( word, "v" ) ? LINE_VERTEX : mesh_word_is( word, "f" ) ? LINE_FACE : LINE_OTHER;
}

// ---- the first pass --------------------------------------------------------------------------------------------

static wisp_status check_vertex_line( mesh_word line, int number, const char* name, wisp_error* error )
{
    mesh_next_word( &line );
    int count = 0;
    for ( mesh_word word = mesh_next_word( &line ); word.length > 0; word = mesh_next_word( &line ) )
    {
        if ( !mesh_word_is_number( word ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: line %d: got \"%s\", expected a number", name, number,
                              mesh_quote_word( word ).text );
        }
        ++count;
    }
    if ( count != 3 && count != 4 && count != 6 && count != 7 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: line %d: got a vertex of %d numbers, expected 3, 4, 6 or 7",
                          name, number, count );
    }
    return WISP_OK;
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

static wisp_status check_face_line( mesh_word line, int number, const char* name, wisp_error* error )
{
    mesh_next_word( &line );
    int count = 0;
    for ( mesh_word word = mesh_next_word( &line ); word.length > 0; word = mesh_next_word( &line ) )
    {
        if ( !is_corner( word ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: line %d: got \"%s\", expected a corner of a face", name,
                              number, mesh_quote_word( word ).text );
        }
        if ( ++count > WISP_MESH_CORNER_CAP )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: line %d: expected a face of at most %d corners", name,
                              number, WISP_MESH_CORNER_CAP );
        }
    }
    if ( count < 3 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: line %d: got a face of %d corners, expected at least 3", name,
                          number, count );
    }
    return WISP_OK;
}

// A zero byte would end a line for the library but not here.
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

static wisp_status check_counts( int vertices, int faces, const char* name, wisp_error* error )
{
    if ( vertices == 0 || faces == 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: not a mesh: got %d vertices and %d faces", name, vertices,
                          faces );
    }
    if ( vertices > WISP_MESH_VERTEX_CAP )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %d vertices, expected at most %d", name, vertices,
                          WISP_MESH_VERTEX_CAP );
    }
    return WISP_OK;
}

// Counts fit an int: a line has at least one byte and a file no more than WISP_MESH_FILE_CAP of them.
static wisp_status check_lines( obj_reading* reading, wisp_error* error )
{
    mesh_word rest = reading->rest, line;
    int number = 0;
    wisp_status status = WISP_OK;
    while ( status == WISP_OK && mesh_next_line( &rest, &line ) )
    {
        ++number;
        switch ( kind_of( &line ) )
        {
            case LINE_VERTEX:
                ++reading->vertex_count;
                status = check_vertex_line( line, number, reading->name, error );
                break;
            case LINE_FACE:
                ++reading->face_count;
                status = check_face_line( line, number, reading->name, error );
                break;
            case LINE_OTHER:
                break;
        }
    }
    return status == WISP_OK ? check_counts( reading->vertex_count, reading->face_count, reading->name, error )
                             : status;
}

// ---- the second pass -------------------------------------------------------------------------------------------

static bool feed_line( void* user, const char** text, size_t* length )
{
    obj_reading* reading = user;
    mesh_word line;
    while ( mesh_next_line( &reading->rest, &line ) )
    {
        ++reading->line;
        if ( kind_of( &line ) != LINE_OTHER )
        {
            *text = line.text;
            *length = line.length;
            return true;
        }
    }
    return false;
}

static bool take_vertex( void* user, wisp_vec3 point )
{
    obj_reading* reading = user;
    wisp_mesh* mesh = reading->mesh;
    if ( mesh->vertex_count >= reading->vertex_count )
    {
        reading->status = wisp_fail( reading->error, WISP_BAD_INPUT,
                                     "%s: the OBJ library found more vertices than the %d of the file", reading->name,
                                     reading->vertex_count );
        return false;
    }
    reading->status = mesh_check_vertex( point, mesh->vertex_count, reading->name, reading->error );
    mesh->points[mesh->vertex_count++] = point;
    return reading->status == WISP_OK;
}

static bool take_corner( void* user, int number, bool last )
{
    obj_reading* reading = user;
    int known = reading->mesh->vertex_count;
    int64_t vertex = number > 0 ? (int64_t)number - 1 : (int64_t)known + number;
    if ( number == 0 || vertex < 0 || vertex >= reading->vertex_count )
    {
        reading->status = wisp_fail(
            reading->error, WISP_BAD_INPUT, "%s: line %d: face %d: got vertex %d, the file has %d", reading->name,
            reading->line, reading->faces_seen, number, number < 0 ? known : reading->vertex_count );
        return false;
    }
    reading->status = mesh_fan_corner( &reading->fan, (int32_t)vertex, reading->error );
    if ( last )
    {
        reading->fan.corner_count = 0;
        ++reading->faces_seen;
    }
    return reading->status == WISP_OK;
}

static wisp_status check_arrived( const obj_reading* reading )
{
    if ( reading->mesh->vertex_count != reading->vertex_count || reading->faces_seen != reading->face_count )
    {
        return wisp_fail( reading->error, WISP_BAD_INPUT,
                          "%s: the OBJ library found %d vertices and %d faces where the file has %d and %d",
                          reading->name, reading->mesh->vertex_count, reading->faces_seen, reading->vertex_count,
                          reading->face_count );
    }
    return WISP_OK;
}

static wisp_status read_lines( obj_reading* reading )
{
    wisp_mesh* mesh = reading->mesh;
    mesh->points = malloc( (size_t)reading->vertex_count * sizeof *mesh->points );
    if ( mesh->points == NULL )
    {
        return wisp_fail( reading->error, WISP_NO_MEMORY, "%s: out of memory for %d vertices", reading->name,
                          reading->vertex_count );
    }
    mesh_obj_feed feed = { reading, feed_line, take_vertex, take_corner };
    wisp_status status = mesh_obj_parse( &feed, reading->name, reading->error );
    status = status == WISP_OK ? reading->status : status;
    return status == WISP_OK ? check_arrived( reading ) : status;
}

wisp_status wisp_mesh_read_obj( const void* bytes, size_t size, const char* name, wisp_mesh* out, wisp_error* error )
{
    *out = ( wisp_mesh ){ 0 };
    name = io_short_name( name );
    obj_reading reading = { .rest = { bytes, size }, .name = name, .error = error, .mesh = out };
    reading.fan = ( mesh_fan ){ .mesh = out, .name = name };
    wisp_status status = check_is_text( bytes, size, name, error );
    if ( status == WISP_OK && size > WISP_MESH_FILE_CAP )
    {
        status = wisp_fail( error, WISP_BAD_INPUT, "%s: expected at most %zu bytes", name, WISP_MESH_FILE_CAP );
    }
    if ( status == WISP_OK )
    {
        status = check_lines( &reading, error );
    }
    if ( status == WISP_OK )
    {
        status = read_lines( &reading );
    }
    if ( status == WISP_OK )
    {
        mesh_fan_finish( &reading.fan );
    }
    else
    {
        wisp_mesh_release( out );
    }
    return status;
}
