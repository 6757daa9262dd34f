// The header of a PLY file: lines of text that announce elements and their properties.
#include "mesh_ply.h"

#include <stdlib.h>
#include <string.h>

#include "io_file.h"

#include "wisp/module/definition.h"

// The lines of the header and the state so far.
typedef struct header_reading
{
    ply_header* header;
    wisp_error* error;
    mesh_word rest; // of the file
    bool has_format;
} header_reading;

static const struct
{
    const char* name;
    ply_type type;
    int width;
} types[] = {
    { "char", PLY_INT8, 1 },   { "int8", PLY_INT8, 1 },     { "uchar", PLY_UINT8, 1 },   { "uint8", PLY_UINT8, 1 },
    { "short", PLY_INT16, 2 }, { "int16", PLY_INT16, 2 },   { "ushort", PLY_UINT16, 2 }, { "uint16", PLY_UINT16, 2 },
    { "int", PLY_INT32, 4 },   { "int32", PLY_INT32, 4 },   { "uint", PLY_UINT32, 4 },   { "uint32", PLY_UINT32, 4 },
    { "float", PLY_FLOAT, 4 }, { "float32", PLY_FLOAT, 4 }, { "double", PLY_DOUBLE, 8 }, { "float64", PLY_DOUBLE, 8 },
};

int ply_width( ply_type type )
{
    for ( int i = 0; i < WISP_COUNT( types ); ++i )
    {
        if ( types[i].type == type )
        {
            return types[i].width;
        }
    }
    return 0;
}

static ply_type find_type( mesh_word word )
{
    for ( int i = 0; i < WISP_COUNT( types ); ++i )
    {
        if ( mesh_word_is( word, types[i].name ) )
        {
            return types[i].type;
        }
    }
    return PLY_NONE;
}

static bool is_integer_type( ply_type type )
{
    return type >= PLY_INT8 && type <= PLY_UINT32;
}

// ---- lines -----------------------------------------------------------------------------------------------------

static wisp_status refuse_word( const header_reading* r, const char* expected, mesh_word word )
{
    return wisp_fail( r->error, WISP_BAD_INPUT, "%s: line %d: got \"%s\", expected %s", r->header->name,
                      r->header->line_count, mesh_quote_word( word ).text, expected );
}

static wisp_status refuse_line( const header_reading* r, const char* problem )
{
    return wisp_fail( r->error, WISP_BAD_INPUT, "%s: line %d: %s", r->header->name, r->header->line_count, problem );
}

// Ends in
// or \r\n only: a lone \r before binary rows could not be distinguished from their first byte.
static wisp_status next_header_line( header_reading* r, mesh_word* line )
{
    ++r->header->line_count;
    const char* end = r->rest.length > 0 ? memchr( r->rest.text, '\n', r->rest.length ) : NULL;
    if ( end == NULL )
    {
        return refuse_line( r, "the file ends inside the header" );
    }
    size_t length = (size_t)( end - r->rest.text );
    *line = ( mesh_word ){ r->rest.text, length > 0 && end[-1] == '\r' ? length - 1 : length };
    r->rest = ( mesh_word ){ end + 1, r->rest.length - length - 1 };
    return WISP_OK;
}

static void keep_name( char* name, mesh_word word )
{
    mesh_quote quote = mesh_quote_word( word );
    memcpy( name, quote.text, sizeof quote.text );
}

static wisp_status demand_end( const header_reading* r, mesh_word line )
{
    mesh_word word = mesh_next_word( &line );
    return word.length == 0 ? WISP_OK : refuse_word( r, "the end of the line", word );
}

static wisp_status read_format( header_reading* r, mesh_word line )
{
    static const char* const encodings[] = { "ascii", "binary_little_endian", "binary_big_endian" };
    mesh_word encoding = mesh_next_word( &line ), version = mesh_next_word( &line );
    int found = -1;
    for ( int i = 0; i < WISP_COUNT( encodings ); ++i )
    {
        found = mesh_word_is( encoding, encodings[i] ) ? i : found;
    }
    if ( found < 0 )
    {
        return refuse_word( r, "ascii, binary_little_endian or binary_big_endian", encoding );
    }
    if ( !mesh_word_is( version, "1.0" ) )
    {
        return refuse_word( r, "version 1.0", version );
    }
    if ( r->has_format )
    {
        return refuse_line( r, "got a second format, expected one" );
    }
    r->has_format = true;
    r->header->encoding = (ply_encoding)found;
    return demand_end( r, line );
}

static wisp_status read_element( header_reading* r, mesh_word line )
{
    ply_header* header = r->header;
    mesh_word name = mesh_next_word( &line ), number = mesh_next_word( &line );
    int32_t count = 0;
    if ( name.length == 0 )
    {
        return refuse_line( r, "got an element without a name" );
    }
    if ( !mesh_word_is_integer( number, &count ) || count < 0 )
    {
        return refuse_word( r, "a number of elements in 0 .. 2147483647", number );
    }
    if ( header->element_count == PLY_MAX_ELEMENTS )
    {
        return wisp_fail( r->error, WISP_BAD_INPUT, "%s: line %d: expected at most %d elements", header->name,
                          header->line_count, PLY_MAX_ELEMENTS );
    }
    int* role = mesh_word_is( name, "vertex" ) ? &header->vertex_element
                : mesh_word_is( name, "face" ) ? &header->face_element
                                               : NULL;
    if ( role != NULL && *role >= 0 )
    {
        return refuse_word( r, "an element with another name", name );
    }
    if ( role != NULL )
    {
        *role = header->element_count;
    }
    ply_element* element = &header->elements[header->element_count++];
    *element = ( ply_element ){ .count = count, .first_property = header->property_count };
    keep_name( element->name, name );
    return demand_end( r, line );
}

static bool element_has( const ply_header* header, int element, ply_role role )
{
    const ply_element* e = &header->elements[element];
    for ( int p = 0; p < e->property_count; ++p )
    {
        if ( header->properties[e->first_property + p].role == role )
        {
            return true;
        }
    }
    return false;
}

bool ply_vertex_has( const ply_header* header, ply_role role )
{
    return element_has( header, header->vertex_element, role );
}

// The number of a mesh that this property holds.
static ply_role role_of( const header_reading* r, mesh_word name )
{
    static const struct
    {
        const char* name;
        ply_role role;
    } known[] = { { "x", PLY_X },
                  { "y", PLY_Y },
                  { "z", PLY_Z },
                  { "red", PLY_RED },
                  { "green", PLY_GREEN },
                  { "blue", PLY_BLUE },
                  { "s", PLY_U },
                  { "t", PLY_V },
                  { "u", PLY_U },
                  { "v", PLY_V },
                  { "texture_u", PLY_U },
                  { "texture_v", PLY_V },
                  { "vertex_indices", PLY_CORNERS },
                  { "vertex_index", PLY_CORNERS } };
    int element = r->header->element_count - 1;
    for ( int i = 0; i < WISP_COUNT( known ); ++i )
    {
        int owner = known[i].role == PLY_CORNERS ? r->header->face_element : r->header->vertex_element;
        if ( element == owner && mesh_word_is( name, known[i].name ) )
        {
            return known[i].role;
        }
    }
    return PLY_PASSED_OVER;
}

// What a mesh may lack: a second one of its kind, or a list, is skipped rather than refused.
static bool is_optional( ply_role role )
{
    return role >= PLY_RED && role <= PLY_V;
}

static wisp_status check_role( const header_reading* r, const ply_property* property, mesh_word name )
{
    const ply_header* header = r->header;
    const ply_element* element = &header->elements[header->element_count - 1];
    if ( property->role == PLY_PASSED_OVER )
    {
        return WISP_OK;
    }
    for ( int p = element->first_property; p < header->property_count; ++p )
    {
        if ( header->properties[p].role == property->role )
        {
            return refuse_word( r, "a property with another meaning", name );
        }
    }
    bool is_list = property->count_type != PLY_NONE;
    if ( property->role == PLY_CORNERS ? !is_list || !is_integer_type( property->type ) : is_list )
    {
        return refuse_word( r, property->role == PLY_CORNERS ? "a list of integers" : "a single number", name );
    }
    return WISP_OK;
}

static wisp_status read_property( header_reading* r, mesh_word line )
{
    ply_header* header = r->header;
    if ( header->element_count == 0 )
    {
        return refuse_line( r, "got a property before the first element" );
    }
    if ( header->property_count == PLY_MAX_PROPERTIES )
    {
        return wisp_fail( r->error, WISP_BAD_INPUT, "%s: line %d: expected at most %d properties", header->name,
                          header->line_count, PLY_MAX_PROPERTIES );
    }
    ply_property property = { .count_type = PLY_NONE };
    mesh_word type = mesh_next_word( &line );
    if ( mesh_word_is( type, "list" ) )
    {
        mesh_word count = mesh_next_word( &line );
        property.count_type = find_type( count );
        if ( !is_integer_type( property.count_type ) )
        {
            return refuse_word( r, "an integer type for the length of a list", count );
        }
        type = mesh_next_word( &line );
    }
    property.type = find_type( type );
    if ( property.type == PLY_NONE )
    {
        return refuse_word( r, "a type", type );
    }
    mesh_word name = mesh_next_word( &line );
    if ( name.length == 0 )
    {
        return refuse_line( r, "got a property without a name" );
    }
    property.role = role_of( r, name );
    if ( is_optional( property.role ) &&
         ( property.count_type != PLY_NONE || ply_vertex_has( header, property.role ) ) )
    {
        property.role = PLY_PASSED_OVER;
    }
    keep_name( property.name, name );
    WISP_TRY( check_role( r, &property, name ) );
    header->properties[header->property_count++] = property;
    ++header->elements[header->element_count - 1].property_count;
    return demand_end( r, line );
}

// ---- whole header ----------------------------------------------------------------------------------------------

static wisp_status read_line( header_reading* r, mesh_word line, bool* ended )
{
    mesh_word word = mesh_next_word( &line );
    if ( mesh_word_is( word, "comment" ) || mesh_word_is( word, "obj_info" ) )
    {
        return WISP_OK;
    }
    if ( mesh_word_is( word, "end_header" ) )
    {
        *ended = true;
        return demand_end( r, line );
    }
    if ( mesh_word_is( word, "format" ) )
    {
        return read_format( r, line );
    }
    if ( mesh_word_is( word, "element" ) )
    {
        return read_element( r, line );
    }
    if ( mesh_word_is( word, "property" ) )
    {
        return read_property( r, line );
    }
    return refuse_word( r, "a keyword of the header", word );
}

// Requirements of a mesh, and of a later loop: rows that are not empty.
static wisp_status check_header( const header_reading* r )
{
    const ply_header* header = r->header;
    const char* missing = !r->has_format               ? "no format"
                          : header->vertex_element < 0 ? "no element vertex"
                          : header->face_element < 0   ? "no element face"
                                                       : NULL;
    if ( missing == NULL )
    {
        missing = !element_has( header, header->vertex_element, PLY_X )   ? "no property x of vertex"
                  : !element_has( header, header->vertex_element, PLY_Y ) ? "no property y of vertex"
                  : !element_has( header, header->vertex_element, PLY_Z ) ? "no property z of vertex"
                  : !element_has( header, header->face_element, PLY_CORNERS )
                      ? "no property vertex_indices or vertex_index of face"
                      : NULL;
    }
    if ( missing != NULL )
    {
        return wisp_fail( r->error, WISP_BAD_INPUT, "%s: the header has %s", header->name, missing );
    }
    for ( int e = 0; e < header->element_count; ++e )
    {
        const ply_element* element = &header->elements[e];
        if ( element->count > 0 && element->property_count == 0 )
        {
            return wisp_fail( r->error, WISP_BAD_INPUT, "%s: the element %s has no property", header->name,
                              element->name );
        }
    }
    int64_t vertices = header->elements[header->vertex_element].count;
    int64_t faces = header->elements[header->face_element].count;
    if ( vertices == 0 || faces == 0 || vertices > WISP_MESH_VERTEX_CAP || faces > WISP_MESH_TRIANGLE_CAP )
    {
        return wisp_fail( r->error, WISP_BAD_INPUT,
                          "%s: got %lld vertices and %lld faces, expected 1 .. %d and 1 .. %d", header->name,
                          (long long)vertices, (long long)faces, WISP_MESH_VERTEX_CAP, WISP_MESH_TRIANGLE_CAP );
    }
    return WISP_OK;
}

wisp_status ply_read_header( const unsigned char* bytes, size_t size, ply_header* header, wisp_error* error )
{
    header_reading r = { .header = header, .error = error, .rest = { (const char*)bytes, size } };
    header->vertex_element = -1;
    header->face_element = -1;
    if ( size == 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the file is empty", header->name );
    }
    mesh_word line;
    wisp_status status = next_header_line( &r, &line );
    if ( status == WISP_OK && !mesh_word_is( line, "ply" ) )
    {
        status = wisp_fail( error, WISP_BAD_INPUT, "%s: byte 0: expected a first line \"ply\"", header->name );
    }
    bool ended = false;
    while ( status == WISP_OK && !ended )
    {
        status = next_header_line( &r, &line );
        status = status == WISP_OK ? read_line( &r, line, &ended ) : status;
    }
    header->size = size - r.rest.length;
    return status == WISP_OK ? check_header( &r ) : status;
}
