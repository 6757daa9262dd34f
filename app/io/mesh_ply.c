// PLY files. The header: lines of text that announce elements and their properties. Behind it: their rows.
#include "mesh_internal.h"

#include "io_file.h"

#include "wisp/module/definition.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    PLY_MAX_ELEMENTS = 32,
    PLY_MAX_PROPERTIES = 256, // of all elements together
    PLY_NAME_ROOM = 32,
};

typedef enum ply_encoding
{
    PLY_TEXT,
    PLY_LITTLE,
    PLY_BIG,
} ply_encoding;

typedef enum ply_type
{
    PLY_NONE,
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_FLOAT,
    PLY_DOUBLE,
} ply_type;

// Meaning of a property for a mesh.
typedef enum ply_role
{
    PLY_X,
    PLY_Y,
    PLY_Z,
    PLY_RED,
    PLY_GREEN,
    PLY_BLUE,
    PLY_U,
    PLY_V,
    PLY_CORNERS,
    PLY_PASSED_OVER,
} ply_role;

typedef struct ply_property
{
    ply_type count_type; // PLY_NONE unless it is a list
    ply_type type;
    ply_role role;
    char name[PLY_NAME_ROOM]; // cut if longer
} ply_property;

typedef struct ply_element
{
    int64_t count;
    int first_property, property_count;
    char name[PLY_NAME_ROOM];
} ply_element;

typedef struct ply_header
{
    const char* name; // for messages
    ply_encoding encoding;
    int element_count, property_count;
    ply_element elements[PLY_MAX_ELEMENTS];
    ply_property properties[PLY_MAX_PROPERTIES];
    int vertex_element, face_element;
    int line_count; // of the header
    size_t size;    // bytes of the header; the first row begins here
} ply_header;

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

// Bytes of a binary value.
static int ply_width( ply_type type )
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

// Whether the element `vertex` has a property of this meaning.
static bool ply_vertex_has( const ply_header* header, ply_role role )
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

// Read and check a header: one element `vertex` with scalars x, y and z, one element `face` with a list of corners.
static wisp_status ply_read_header( const unsigned char* bytes, size_t size, ply_header* header, wisp_error* error )
{
    header_reading r = { .header = header, .error = error, .rest = { (const char*)bytes, size } };
    header->vertex_element = -1;
    header->face_element = -1;
    if ( size == 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the file is empty", header->name );
    }
    mesh_word line;
    WISP_TRY( next_header_line( &r, &line ) );
    if ( !mesh_word_is( line, "ply" ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte 0: expected a first line \"ply\"", header->name );
    }
    for ( bool ended = false; !ended; )
    {
        WISP_TRY( next_header_line( &r, &line ) );
        WISP_TRY( read_line( &r, line, &ended ) );
    }
    header->size = size - r.rest.length;
    return check_header( &r );
}

// ---- rows ----

// The rows of a PLY file: text, little-endian or big-endian, every value as a double, which holds all their types.

typedef struct row_reading
{
    const ply_header* header;
    const unsigned char* bytes;
    size_t size, at; // of the whole file
    mesh_word row;   // the rest of the line, in text
    int line;        // in text, from 1
    const ply_element* element;
    int64_t row_number;
    wisp_mesh* mesh;
    mesh_fan fan;
    wisp_error* error;
} row_reading;

// ---- messages -------------------------------------------------------------------------------------------------

// Position of an error: its element, its number, and the line or the byte.
static wisp_status refuse( const row_reading* r, const ply_property* property, const char* problem )
{
    bool is_text = r->header->encoding == PLY_TEXT;
    size_t place = is_text ? (size_t)r->line : r->at;
    return wisp_fail( r->error, WISP_BAD_INPUT, "%s: %s %zu: %s %lld: %s %s", r->header->name,
                      is_text ? "line" : "byte", place, r->element->name, (long long)r->row_number, property->name,
                      problem );
}

// ---- values ----------------------------------------------------------------------------------------------------

static wisp_status next_text_value( row_reading* r, const ply_property* property, double* value )
{
    mesh_word word = mesh_next_word( &r->row );
    if ( word.length == 0 )
    {
        return refuse( r, property, "is missing" );
    }
    if ( !mesh_word_is_number( word ) || word.length > MESH_WORD_LONGEST )
    {
        char problem[64];
        snprintf( problem, sizeof problem, "is \"%s\", which is not a number", mesh_quote_word( word ).text );
        return refuse( r, property, problem );
    }
    *value = mesh_word_value( word );
    return WISP_OK;
}

static uint64_t put_together( const unsigned char* bytes, int width, bool big )
{
    uint64_t bits = 0;
    for ( int i = 0; i < width; ++i )
    {
        bits |= (uint64_t)bytes[i] << ( 8 * ( big ? width - 1 - i : i ) );
    }
    return bits;
}

static double value_of_bits( uint64_t bits, ply_type type )
{
    uint32_t lower = (uint32_t)bits;
    float single;
    double twice;
    memcpy( &single, &lower, sizeof single );
    memcpy( &twice, &bits, sizeof twice );
    switch ( type )
    {
        case PLY_INT8:
            return (double)bits - ( bits > INT8_MAX ? 256.0 : 0.0 );
        case PLY_INT16:
            return (double)bits - ( bits > INT16_MAX ? 65536.0 : 0.0 );
        case PLY_INT32:
            return (double)bits - ( bits > INT32_MAX ? 4294967296.0 : 0.0 );
        case PLY_FLOAT:
            return (double)single;
        case PLY_DOUBLE:
            return twice;
        default:
            return (double)bits;
    }
}

static wisp_status next_binary_value( row_reading* r, const ply_property* property, ply_type type, double* value )
{
    size_t width = (size_t)ply_width( type );
    if ( width > r->size - r->at )
    {
        return refuse( r, property, "is missing, the file ends" );
    }
    *value = value_of_bits( put_together( r->bytes + r->at, (int)width, r->header->encoding == PLY_BIG ), type );
    r->at += width;
    return WISP_OK;
}

static wisp_status next_value( row_reading* r, const ply_property* property, ply_type type, double* value )
{
    return r->header->encoding == PLY_TEXT ? next_text_value( r, property, value )
                                           : next_binary_value( r, property, type, value );
}

// ---- properties ------------------------------------------------------------------------------------------------

// A count is accepted only up to the rest of the file: a value has at least one byte.
static wisp_status next_count( row_reading* r, const ply_property* property, int64_t* count )
{
    double value = 0.0;
    WISP_TRY( next_value( r, property, property->count_type, &value ) );
    size_t left =
        r->header->encoding == PLY_TEXT ? r->row.length : ( r->size - r->at ) / (size_t)ply_width( property->type );
    // Written so that NaN fails.
    if ( !( value >= 0.0 && value <= (double)left && value == floor( value ) ) )
    {
        char problem[96];
        snprintf( problem, sizeof problem, "announces a list of %g values, and the %s is too short", value,
                  r->header->encoding == PLY_TEXT ? "line" : "file" );
        return refuse( r, property, value >= 0.0 && value == floor( value ) ? problem : "has no length" );
    }
    *count = (int64_t)value;
    return WISP_OK;
}

static wisp_status take_corner( row_reading* r, const ply_property* property, double value )
{
    if ( !( value >= 0.0 && value < (double)r->mesh->vertex_count && value == floor( value ) ) )
    {
        char problem[96];
        snprintf( problem, sizeof problem, "names vertex %.17g, the file has %d", value, r->mesh->vertex_count );
        return refuse( r, property, problem );
    }
    return mesh_fan_corner( &r->fan, (int32_t)value, r->error );
}

static wisp_status read_list( row_reading* r, const ply_property* property )
{
    int64_t count = 0;
    WISP_TRY( next_count( r, property, &count ) );
    bool is_face = property->role == PLY_CORNERS;
    if ( is_face && ( count < 3 || count > WISP_MESH_CORNER_CAP ) )
    {
        char problem[96];
        snprintf( problem, sizeof problem, "has %lld corners, and 3 .. %d are accepted", (long long)count,
                  WISP_MESH_CORNER_CAP );
        return refuse( r, property, problem );
    }
    if ( !is_face && r->header->encoding != PLY_TEXT )
    {
        r->at += (size_t)count * (size_t)ply_width( property->type );
        return WISP_OK;
    }
    r->fan.corner_count = 0;
    for ( int64_t i = 0; i < count; ++i )
    {
        double value = 0.0;
        WISP_TRY( next_value( r, property, property->type, &value ) );
        WISP_TRY( is_face ? take_corner( r, property, value ) : WISP_OK );
    }
    return WISP_OK;
}

// The value of a channel at full brightness.
static double full_colour( ply_type type )
{
    return type == PLY_FLOAT || type == PLY_DOUBLE ? 1.0 : type == PLY_UINT16 ? 65535.0 : 255.0;
}

// The float of the mesh that a property of this row becomes, or null: a lone channel or coordinate is not kept.
static float* place_of( const row_reading* r, ply_role role )
{
    const int64_t v = r->row_number;
    wisp_vec3* point = &r->mesh->points[v];
    wisp_vec3* colour = r->mesh->colours != NULL ? &r->mesh->colours[v] : NULL;
    float* uv = r->mesh->uvs != NULL ? r->mesh->uvs + 2 * v : NULL;
    switch ( role )
    {
        case PLY_X:
            return &point->x;
        case PLY_Y:
            return &point->y;
        case PLY_Z:
            return &point->z;
        case PLY_RED:
            return colour != NULL ? &colour->x : NULL;
        case PLY_GREEN:
            return colour != NULL ? &colour->y : NULL;
        case PLY_BLUE:
            return colour != NULL ? &colour->z : NULL;
        case PLY_U:
            return uv;
        case PLY_V:
            return uv != NULL ? uv + 1 : NULL;
        case PLY_CORNERS:
        case PLY_PASSED_OVER:
            break;
    }
    return NULL;
}

static wisp_status read_scalar( row_reading* r, const ply_property* property )
{
    double value = 0.0;
    WISP_TRY( next_value( r, property, property->type, &value ) );
    if ( property->role == PLY_PASSED_OVER )
    {
        return WISP_OK;
    }
    if ( !isfinite( value ) || fabs( value ) > (double)FLT_MAX )
    {
        return refuse( r, property, isnan( value ) ? "is NaN" : "is infinite, or too large for a float" );
    }
    float* place = place_of( r, property->role );
    if ( place != NULL )
    {
        *place =
            (float)( property->role >= PLY_RED && property->role <= PLY_BLUE ? value / full_colour( property->type )
                                                                             : value );
    }
    return WISP_OK;
}

// ---- rows ------------------------------------------------------------------------------------------------------

// Blank lines between rows are skipped.
static wisp_status begin_text_row( row_reading* r, const ply_property* property )
{
    mesh_word rest = { (const char*)r->bytes + r->at, r->size - r->at }, line;
    while ( mesh_next_line( &rest, &line ) )
    {
        ++r->line;
        r->at = r->size - rest.length;
        r->row = line;
        if ( mesh_next_word( &line ).length > 0 )
        {
            return WISP_OK;
        }
    }
    return refuse( r, property, "is missing, the file ends" );
}

static wisp_status end_text_row( row_reading* r )
{
    mesh_word word = mesh_next_word( &r->row );
    return word.length == 0 ? WISP_OK
                            : wisp_fail( r->error, WISP_BAD_INPUT, "%s: line %d: %s %lld: one value too many: \"%s\"",
                                         r->header->name, r->line, r->element->name, (long long)r->row_number,
                                         mesh_quote_word( word ).text );
}

static wisp_status read_row( row_reading* r )
{
    const ply_property* properties = r->header->properties + r->element->first_property;
    const bool is_text = r->header->encoding == PLY_TEXT;
    WISP_TRY( is_text ? begin_text_row( r, properties ) : WISP_OK );
    for ( int p = 0; p < r->element->property_count; ++p )
    {
        WISP_TRY( properties[p].count_type != PLY_NONE ? read_list( r, &properties[p] )
                                                       : read_scalar( r, &properties[p] ) );
    }
    return is_text ? end_text_row( r ) : WISP_OK;
}

// Minimum bytes of a row, with empty lists.
static uint64_t min_row( const ply_header* header, const ply_element* element )
{
    uint64_t sum = 0;
    for ( int p = 0; p < element->property_count; ++p )
    {
        const ply_property* property = &header->properties[element->first_property + p];
        ply_type type = property->count_type != PLY_NONE ? property->count_type : property->type;
        // In text a digit and a separator.
        sum += header->encoding == PLY_TEXT ? 2 : (uint64_t)ply_width( type );
    }
    return sum;
}

// Before memory is allocated: the file must be long enough for all rows in its header.
static wisp_status check_length( const row_reading* r )
{
    const ply_header* header = r->header;
    uint64_t least = 0;
    for ( int e = 0; e < header->element_count; ++e )
    {
        least += (uint64_t)header->elements[e].count * min_row( header, &header->elements[e] );
    }
    // The last line of a text may lack its end.
    uint64_t there = r->size - r->at + ( header->encoding == PLY_TEXT );
    return least <= there
               ? WISP_OK
               : wisp_fail( r->error, WISP_BAD_INPUT,
                            "%s: byte %zu: the rows that the header announces need at least %llu bytes, and "
                            "%llu follow",
                            header->name, r->at, (unsigned long long)least, (unsigned long long)there );
}

static wisp_status check_rest( const row_reading* r )
{
    for ( size_t i = r->at; i < r->size; ++i )
    {
        if ( memchr( " \t\r\n", r->bytes[i], 4 ) == NULL )
        {
            return wisp_fail( r->error, WISP_BAD_INPUT, "%s: byte %zu: %zu bytes follow the last element",
                              r->header->name, r->at, r->size - r->at );
        }
    }
    return WISP_OK;
}

static wisp_status read_elements( row_reading* r )
{
    for ( int e = 0; e < r->header->element_count; ++e )
    {
        r->element = &r->header->elements[e];
        for ( r->row_number = 0; r->row_number < r->element->count; ++r->row_number )
        {
            WISP_TRY( read_row( r ) );
        }
    }
    return check_rest( r );
}

// The caller releases the contents of `out` after a failure.
static wisp_status read_rows( const ply_header* header, const unsigned char* bytes, size_t size, wisp_mesh* out,
                              wisp_error* error )
{
    row_reading r = { .header = header,
                      .bytes = bytes,
                      .size = size,
                      .at = header->size,
                      .line = header->line_count,
                      .mesh = out,
                      .fan = { .mesh = out, .name = header->name },
                      .error = error };
    WISP_TRY( check_length( &r ) );
    out->vertex_count = (int)header->elements[header->vertex_element].count;
    out->points = malloc( (size_t)out->vertex_count * sizeof *out->points );
    if ( out->points == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d vertices", header->name,
                          out->vertex_count );
    }
    const bool has_colours = ply_vertex_has( header, PLY_RED ) && ply_vertex_has( header, PLY_GREEN ) &&
                             ply_vertex_has( header, PLY_BLUE );
    const bool has_uvs = ply_vertex_has( header, PLY_U ) && ply_vertex_has( header, PLY_V );
    io_numbers numbers;
    WISP_TRY( has_colours ? mesh_allocate_colours( out, header->name, error ) : WISP_OK );
    WISP_TRY( has_uvs ? mesh_allocate_uvs( out, header->name, error ) : WISP_OK );
    WISP_TRY( io_numbers_begin( &numbers, error ) );
    const wisp_status status = read_elements( &r );
    io_numbers_end( &numbers );
    mesh_fan_finish( &r.fan );
    return status;
}

wisp_status wisp_mesh_read_ply( const void* bytes, size_t size, const char* name, wisp_mesh* out, wisp_error* error )
{
    *out = ( wisp_mesh ){ 0 };
    name = io_short_name( name );
    if ( size > WISP_MESH_FILE_CAP )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: expected at most %zu bytes", name, WISP_MESH_FILE_CAP );
    }
    ply_header* header = calloc( 1, sizeof *header );
    if ( header == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for a header", name );
    }
    header->name = name;
    wisp_status status = ply_read_header( bytes, size, header, error );
    status = status == WISP_OK ? read_rows( header, bytes, size, out, error ) : status;
    free( header );
    if ( status != WISP_OK )
    {
        wisp_mesh_release( out );
    }
    return status;
}
