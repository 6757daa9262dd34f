// The rows of a PLY file: text, little-endian or big-endian, every value as a double, which holds all their types.
#include "mesh_ply.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io_file.h"

#include "wisp/module/definition.h"

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
    wisp_status status = WISP_OK;
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
    for ( int64_t i = 0; status == WISP_OK && i < count; ++i )
    {
        double value = 0.0;
        status = next_value( r, property, property->type, &value );
        if ( status == WISP_OK && is_face )
        {
            status = take_corner( r, property, value );
        }
    }
    return status;
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
    wisp_status status = next_value( r, property, property->type, &value );
    if ( status != WISP_OK || property->role == PLY_PASSED_OVER )
    {
        return status;
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
    bool is_text = r->header->encoding == PLY_TEXT;
    wisp_status status = is_text ? begin_text_row( r, properties ) : WISP_OK;
    for ( int p = 0; status == WISP_OK && p < r->element->property_count; ++p )
    {
        status =
            properties[p].count_type != PLY_NONE ? read_list( r, &properties[p] ) : read_scalar( r, &properties[p] );
    }
    return status == WISP_OK && is_text ? end_text_row( r ) : status;
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
    wisp_status status = WISP_OK;
    for ( int e = 0; e < r->header->element_count; ++e )
    {
        r->element = &r->header->elements[e];
        for ( r->row_number = 0; status == WISP_OK && r->row_number < r->element->count; ++r->row_number )
        {
            status = read_row( r );
        }
        if ( status != WISP_OK )
        {
            return status;
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
    wisp_status status = WISP_OK;
    out->vertex_count = (int)header->elements[header->vertex_element].count;
    out->points = malloc( (size_t)out->vertex_count * sizeof *out->points );
    if ( out->points == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d vertices", header->name,
                          out->vertex_count );
    }
    if ( ply_vertex_has( header, PLY_RED ) && ply_vertex_has( header, PLY_GREEN ) &&
         ply_vertex_has( header, PLY_BLUE ) )
    {
        status = mesh_allocate_colours( out, header->name, error );
    }
    if ( status == WISP_OK && ply_vertex_has( header, PLY_U ) && ply_vertex_has( header, PLY_V ) )
    {
        status = mesh_allocate_uvs( out, header->name, error );
    }
    io_numbers numbers;
    status = status == WISP_OK ? io_numbers_begin( &numbers, error ) : status;
    if ( status == WISP_OK )
    {
        status = read_elements( &r );
        io_numbers_end( &numbers );
        mesh_fan_finish( &r.fan );
    }
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
    if ( status == WISP_OK )
    {
        status = read_rows( header, bytes, size, out, error );
    }
    free( header );
    if ( status != WISP_OK )
    {
        wisp_mesh_release( out );
    }
    return status;
}
