// HAIR files (Cem Yuksel, hair models). Little-endian: a header of 128 bytes, then the arrays that its flags
// announce, in this order: segments a strand, points, thickness, transparency, colours.
#include "groom_internal.h"

#include <limits.h>

#include "io_file.h"

#include "wisp/module/definition.h"

enum
{
    HEADER_SIZE = 128,
    AT_STRAND_COUNT = 4,
    AT_POINT_COUNT = 8,
    AT_FLAGS = 12,
    AT_DEFAULT_SEGMENTS = 16,
    AT_DEFAULT_THICKNESS = 20,
    AT_DEFAULT_TRANSPARENCY = 24,
    AT_DEFAULT_COLOUR = 28,
    AT_TEXT = 40,

    HAS_SEGMENTS = 1,
    HAS_POINTS = 2,
    HAS_THICKNESS = 4,
    HAS_TRANSPARENCY = 8,
    HAS_COLOUR = 16,
    KNOWN_FLAGS = 31,

    MAX_VERTICES_A_STRAND = 65536, // segments are counted in 16 bits
};

// Contents of the header, and the start of each array; a missing array starts at 0.
typedef struct hair_layout
{
    const unsigned char* bytes;
    const char* name;
    uint32_t strand_count;
    uint32_t point_count;
    uint32_t flags;
    uint32_t default_segments;
    size_t segments;
    size_t points;
    size_t thickness;
    size_t transparency;
    size_t colour;
} hair_layout;

// ---- reading ---------------------------------------------------------------------------------------------------

static wisp_status read_magic( const unsigned char* bytes, size_t size, const char* name, wisp_error* error )
{
    if ( size == 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the file is empty", name );
    }
    size_t shown = size < 4 ? size : 4;
    if ( memcmp( bytes, "HAIR", shown ) != 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte 0: expected \"HAIR\"", name );
    }
    if ( size < HEADER_SIZE )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %zu: the file ends inside the header of %d bytes", name,
                          size, HEADER_SIZE );
    }
    return WISP_OK;
}

static wisp_status read_header( const unsigned char* bytes, size_t size, hair_layout* layout, wisp_error* error )
{
    WISP_TRY( read_magic( bytes, size, layout->name, error ) );
    layout->bytes = bytes;
    layout->strand_count = io_get_u32( bytes + AT_STRAND_COUNT );
    layout->point_count = io_get_u32( bytes + AT_POINT_COUNT );
    layout->flags = io_get_u32( bytes + AT_FLAGS );
    layout->default_segments = io_get_u32( bytes + AT_DEFAULT_SEGMENTS );

    if ( layout->strand_count == 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: got 0 strands, expected at least 1", layout->name,
                          AT_STRAND_COUNT );
    }
    if ( layout->point_count < layout->strand_count )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: byte %d: got %u points, expected at least one for each of %u strands", layout->name,
                          AT_POINT_COUNT, layout->point_count, layout->strand_count );
    }
    if ( ( layout->flags & ~(uint32_t)KNOWN_FLAGS ) != 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: byte %d: got flags 0x%x, expected only those of the five known arrays", layout->name,
                          AT_FLAGS, layout->flags );
    }
    if ( ( layout->flags & HAS_POINTS ) == 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: got flags 0x%x, expected those of points",
                          layout->name, AT_FLAGS, layout->flags );
    }
    return WISP_OK;
}

// Finds every array, and rejects a file that is shorter or longer than they need. After this the counts are bounded
// by the size of the file, so memory may be allocated.
static wisp_status place_arrays( hair_layout* layout, size_t size, wisp_error* error )
{
    const struct
    {
        const char* name;
        uint32_t flag;
        uint32_t count;
        unsigned width;
        size_t* start;
    } arrays[] = {
        { "segments", HAS_SEGMENTS, layout->strand_count, 2, &layout->segments },
        { "points", HAS_POINTS, layout->point_count, 12, &layout->points },
        { "thickness", HAS_THICKNESS, layout->point_count, 4, &layout->thickness },
        { "transparency", HAS_TRANSPARENCY, layout->point_count, 4, &layout->transparency },
        { "colours", HAS_COLOUR, layout->point_count, 12, &layout->colour },
    };
    size_t at = HEADER_SIZE;
    for ( int i = 0; i < WISP_COUNT( arrays ); ++i )
    {
        if ( ( layout->flags & arrays[i].flag ) == 0 )
        {
            continue;
        }
        uint64_t needed = (uint64_t)arrays[i].count * arrays[i].width;
        if ( needed > size - at )
        {
            return wisp_fail(
                error, WISP_BAD_INPUT,
                "%s: byte %zu: the file ends inside the %s, which start at byte %zu and need %llu bytes",
                layout->name, size, arrays[i].name, at, (unsigned long long)needed );
        }
        *arrays[i].start = at;
        at += (size_t)needed;
    }
    if ( at < size )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %zu: %zu bytes follow the last array", layout->name, at,
                          size - at );
    }
    if ( layout->point_count >= INT_MAX )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: %u points are more than a groom can hold",
                          layout->name, AT_POINT_COUNT, layout->point_count );
    }
    return WISP_OK;
}

static uint64_t segments_of( const hair_layout* layout, uint32_t strand )
{
    if ( ( layout->flags & HAS_SEGMENTS ) == 0 )
    {
        return layout->default_segments;
    }
    return io_get_u16( layout->bytes + layout->segments + 2 * (size_t)strand );
}

static size_t byte_of_segments( const hair_layout* layout, uint32_t strand )
{
    bool listed = ( layout->flags & HAS_SEGMENTS ) != 0;
    return listed ? layout->segments + 2 * (size_t)strand : AT_DEFAULT_SEGMENTS;
}

static wisp_status read_segments( const hair_layout* layout, wisp_groom* out, wisp_error* error )
{
    uint64_t total = 0;
    out->offsets[0] = 0;
    for ( uint32_t s = 0; s < layout->strand_count; ++s )
    {
        total += segments_of( layout, s ) + 1;
        if ( total > layout->point_count )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "%s: byte %zu: the segments of strand %u need %llu points, the header announces %u",
                              layout->name, byte_of_segments( layout, s ), s, (unsigned long long)total,
                              layout->point_count );
        }
        out->offsets[s + 1] = (int)total;
    }
    if ( total != layout->point_count )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: byte %zu: the segments of all %u strands need %llu points, the header announces %u",
                          layout->name, byte_of_segments( layout, 0 ), layout->strand_count,
                          (unsigned long long)total, layout->point_count );
    }
    return WISP_OK;
}

static void read_floats( const unsigned char* bytes, size_t count, void* values )
{
    io_get_words( values, bytes, values != NULL ? count : 0 );
}

static wisp_status read_arrays( const hair_layout* layout, wisp_groom* out, wisp_error* error )
{
    WISP_TRY( read_segments( layout, out, error ) );
    const size_t count = (size_t)out->vertex_count;
    read_floats( layout->bytes + layout->points, 3 * count, out->points );
    read_floats( layout->bytes + layout->thickness, count, out->thickness );
    read_floats( layout->bytes + layout->transparency, count, out->transparency );
    read_floats( layout->bytes + layout->colour, 3 * count, out->colour );
    out->dimension = groom_dimension_of( out );
    return groom_check_finite( out, layout->name, error );
}

wisp_status wisp_groom_read_hair( const void* bytes, size_t size, const char* name, wisp_groom* out,
                                  wisp_error* error )
{
    *out = ( wisp_groom ){ 0 };
    hair_layout layout = { .name = io_short_name( name ) };
    WISP_TRY( read_header( bytes, size, &layout, error ) );
    WISP_TRY( place_arrays( &layout, size, error ) );
    int columns = ( ( layout.flags & HAS_THICKNESS ) != 0 ? GROOM_THICKNESS : 0 ) |
                  ( ( layout.flags & HAS_TRANSPARENCY ) != 0 ? GROOM_TRANSPARENCY : 0 ) |
                  ( ( layout.flags & HAS_COLOUR ) != 0 ? GROOM_COLOUR : 0 );
    wisp_status status =
        groom_allocate( out, (int)layout.strand_count, (int)layout.point_count, columns, layout.name, error );
    if ( status == WISP_OK )
    {
        status = read_arrays( &layout, out, error );
    }
    if ( status != WISP_OK )
    {
        wisp_groom_release( out );
    }
    return status;
}

// ---- writing ---------------------------------------------------------------------------------------------------

static wisp_status check_fits( const wisp_groom* groom, const char* name, wisp_error* error )
{
    wisp_status status = groom_check_finite( groom, name, error );
    for ( int s = 0; status == WISP_OK && s < groom->strand_count; ++s )
    {
        int count = groom->offsets[s + 1] - groom->offsets[s];
        if ( count < 1 || count > MAX_VERTICES_A_STRAND )
        {
            status = wisp_fail( error, WISP_BAD_INPUT,
                                "%s: strand %d has %d vertices; a .hair file holds 1 to %d a strand",
                                io_short_name( name ), s, count, MAX_VERTICES_A_STRAND );
        }
    }
    return status;
}

// The defaults are for other readers, which use them where an array is missing: a human hair, opaque, brown.
static void write_header( FILE* out, const wisp_groom* groom )
{
    static const char text[] = "Wisp " WISP_VERSION_STRING ", metres";
    unsigned char header[HEADER_SIZE] = { 'H', 'A', 'I', 'R' };
    uint32_t flags = HAS_SEGMENTS | HAS_POINTS;
    flags |= groom->thickness != NULL ? HAS_THICKNESS : 0;
    flags |= groom->transparency != NULL ? HAS_TRANSPARENCY : 0;
    flags |= groom->colour != NULL ? HAS_COLOUR : 0;
    io_put_u32( header + AT_STRAND_COUNT, (uint32_t)groom->strand_count );
    io_put_u32( header + AT_POINT_COUNT, (uint32_t)groom->vertex_count );
    io_put_u32( header + AT_FLAGS, flags );
    io_put_u32( header + AT_DEFAULT_SEGMENTS, (uint32_t)( groom->offsets[1] - 1 ) );
    io_put_float( header + AT_DEFAULT_THICKNESS, 8e-5f );
    io_put_float( header + AT_DEFAULT_TRANSPARENCY, 0.0f );
    io_put_vec3( header + AT_DEFAULT_COLOUR, ( wisp_vec3 ){ 0.35f, 0.22f, 0.13f } );
    memcpy( header + AT_TEXT, text, sizeof text );
    fwrite( header, 1, sizeof header, out );
}

wisp_status wisp_groom_write_hair( FILE* out, const wisp_groom* groom, const char* name, wisp_error* error )
{
    WISP_TRY( check_fits( groom, name, error ) );
    write_header( out, groom );
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        unsigned char bytes[2];
        io_put_u16( bytes, (uint32_t)( groom->offsets[s + 1] - groom->offsets[s] - 1 ) );
        fwrite( bytes, 1, sizeof bytes, out );
    }
    const size_t count = (size_t)groom->vertex_count;
    io_write_words( out, groom->points, 3 * count );
    io_write_words( out, groom->thickness, groom->thickness != NULL ? count : 0 );
    io_write_words( out, groom->transparency, groom->transparency != NULL ? count : 0 );
    io_write_words( out, groom->colour, groom->colour != NULL ? 3 * count : 0 );
    return WISP_OK;
}
