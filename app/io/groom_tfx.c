// Guide strands of AMD TressFX 4 and 5. Little-endian: a header of 160 bytes whose offsets, in bytes from the start
// of the file, give the position of each array; 0 means that there is none. All strands have the same number of
// vertices, strand after strand, root first. The format's own limit (4 to 64 vertices, a power of two) belongs to its
// GPU kernels and is not enforced here.
#include "groom_internal.h"

#include <limits.h>

#include "io_file.h"

enum
{
    HEADER_SIZE = 160,
    AT_STRAND_COUNT = 4,
    AT_VERTICES_PER_STRAND = 8,
    AT_POSITIONS = 12,
    AT_STRAND_UV = 16,
    AT_VERTEX_UV = 20,
    AT_THICKNESS = 24,
    AT_COLOUR = 28,
};

typedef struct tfx_layout
{
    const unsigned char* bytes;
    const char* name;
    uint32_t strand_count;
    uint32_t vertices_per_strand;
    size_t positions;
    size_t thickness; // 0: none
    size_t colour;    // 0: none
} tfx_layout;

static wisp_status read_header( const unsigned char* bytes, size_t size, tfx_layout* layout, wisp_error* error )
{
    if ( size < HEADER_SIZE )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %zu: the file ends inside the header of %d bytes",
                          layout->name, size, HEADER_SIZE );
    }
    float version = io_get_float( bytes );
    if ( !( version >= 4.0f && version < 6.0f ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: byte 0: got version %g, expected a TressFX file of version 4 or 5", layout->name,
                          (double)version );
    }
    layout->bytes = bytes;
    layout->strand_count = io_get_u32( bytes + AT_STRAND_COUNT );
    layout->vertices_per_strand = io_get_u32( bytes + AT_VERTICES_PER_STRAND );
    if ( layout->strand_count == 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: got 0 strands, expected at least 1", layout->name,
                          AT_STRAND_COUNT );
    }
    if ( layout->vertices_per_strand < 2 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: got strands of %u vertices, expected at least 2",
                          layout->name, AT_VERTICES_PER_STRAND, layout->vertices_per_strand );
    }
    return WISP_OK;
}

// Texture coordinates are not kept, but if they do not fit the file is truncated, so they are checked.
static wisp_status place_arrays( tfx_layout* layout, size_t size, wisp_error* error )
{
    // At most 2^64 - 2^33 + 1, and a product with 16 would not fit: the positions are bounded by division.
    uint64_t vertices = (uint64_t)layout->strand_count * layout->vertices_per_strand;
    size_t dropped = 0;
    const struct
    {
        const char* name;
        int field;
        uint64_t count;
        unsigned width;
        size_t* start;
    } arrays[] = {
        { "positions", AT_POSITIONS, vertices, 16, &layout->positions },
        { "texture coordinates of strands", AT_STRAND_UV, layout->strand_count, 8, &dropped },
        { "texture coordinates of vertices", AT_VERTEX_UV, vertices, 8, &dropped },
        { "thickness of strands", AT_THICKNESS, layout->strand_count, 4, &layout->thickness },
        { "colours", AT_COLOUR, vertices, 16, &layout->colour },
    };
    for ( int i = 0; i < WISP_COUNT( arrays ); ++i )
    {
        size_t start = io_get_u32( layout->bytes + arrays[i].field );
        if ( start == 0 && arrays[i].field != AT_POSITIONS )
        {
            continue;
        }
        if ( start < HEADER_SIZE || start > size )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "%s: byte %d: the %s cannot start at byte %zu of a file with a header of %d bytes and "
                              "a size of %zu",
                              layout->name, arrays[i].field, arrays[i].name, start, HEADER_SIZE, size );
        }
        if ( arrays[i].count > ( size - start ) / arrays[i].width )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "%s: byte %zu: the file ends inside the %s, which start at byte %zu and are %llu times "
                              "%u bytes",
                              layout->name, size, arrays[i].name, start, (unsigned long long)arrays[i].count,
                              arrays[i].width );
        }
        *arrays[i].start = start;
    }
    if ( vertices >= INT_MAX )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: %llu vertices are more than a groom can hold",
                          layout->name, AT_STRAND_COUNT, (unsigned long long)vertices );
    }
    return WISP_OK;
}

static void read_arrays( const tfx_layout* layout, wisp_groom* out )
{
    int per_strand = (int)layout->vertices_per_strand;
    for ( int s = 0; s <= out->strand_count; ++s )
    {
        out->offsets[s] = s * per_strand;
    }
    for ( int v = 0; v < out->vertex_count; ++v )
    {
        out->points[v] = io_get_vec3( layout->bytes + layout->positions + 16 * (size_t)v );
        if ( out->thickness != NULL )
        {
            size_t strand = (size_t)( v / per_strand );
            out->thickness[v] = io_get_float( layout->bytes + layout->thickness + 4 * strand );
        }
        if ( out->colour != NULL )
        {
            out->colour[v] = io_get_vec3( layout->bytes + layout->colour + 16 * (size_t)v );
        }
    }
    out->dimension = groom_dimension_of( out );
}

wisp_status wisp_groom_read_tfx( const void* bytes, size_t size, const char* name, wisp_groom* out,
                                 wisp_error* error )
{
    *out = ( wisp_groom ){ 0 };
    tfx_layout layout = { .name = io_short_name( name ) };
    wisp_status status = read_header( bytes, size, &layout, error );
    if ( status == WISP_OK )
    {
        status = place_arrays( &layout, size, error );
    }
    if ( status != WISP_OK )
    {
        return status;
    }
    int vertex_count = (int)( layout.strand_count * layout.vertices_per_strand );
    int columns = ( layout.thickness != 0 ? GROOM_THICKNESS : 0 ) | ( layout.colour != 0 ? GROOM_COLOUR : 0 );
    status = groom_allocate( out, (int)layout.strand_count, vertex_count, columns, layout.name, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    read_arrays( &layout, out );
    status = groom_check_finite( out, layout.name, error );
    if ( status != WISP_OK )
    {
        wisp_groom_release( out );
    }
    return status;
}
