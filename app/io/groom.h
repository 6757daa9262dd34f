/// Grooms: strands of hair as polylines. Reading, writing, checking, generating and describing them.
///
///     format  read  write  what it is
///     .hair   yes   yes    the HAIR files of Cem Yuksel's hair models
///     .usda   no    yes    USD BasisCurves as text
///     .obj    no    yes    vertices, and lines of two vertices each
///
/// Files are untrusted bytes: memory is allocated only after the file is known to be long enough to fill it. Readers
/// reject malformed and non-finite values. Values that are finite and yet unusable (a coordinate of 1e30, a colour of
/// 7) are accepted so that wisp_groom_info() can report them: call wisp_groom_check() before simulating.
#pragma once

#include <stdio.h>

#include "wisp/base.h"

#ifdef __cplusplus
extern "C"
{
#endif

    /// Vertices of all strands, strand after strand, root first. Every array is the C library's malloc.
    typedef struct wisp_groom
    {
        int strand_count;
        int vertex_count;
        int dimension;       ///< 2: every z is 0; else 3
        int* offsets;        ///< [strand_count + 1]; strand s has the vertices offsets[s] .. offsets[s + 1] - 1
        wisp_vec3* points;   ///< [vertex_count], m
        float* thickness;    ///< [vertex_count] or null, m, diameter
        float* transparency; ///< [vertex_count] or null, 0 (opaque) .. 1
        wisp_vec3* colour;   ///< [vertex_count] or null, red, green and blue in 0..1
    } wisp_groom;

/// Bytes of the longest file that is read.
#define WISP_GROOM_FILE_CAP ( (size_t)1 << 30 )

/// Farthest coordinate that wisp_groom_check() accepts, m.
#define WISP_GROOM_MAX_COORDINATE 1e6f

    /// Free the arrays and leave an empty groom, which may be released again.
    WISP_API void wisp_groom_release( wisp_groom* groom );

    /// Read a file. A file that starts with "HAIR" is a .hair file whatever its name; otherwise the name decides.
    /// @param out receives the groom, to be released by the caller; empty on failure
    /// @return WISP_IO_ERROR an error of the operating system; WISP_BAD_INPUT the message names the file, and the
    ///        byte, strand or vertex; WISP_NO_MEMORY
    WISP_API wisp_status wisp_groom_read( const char* path, wisp_groom* out, wisp_error* error );

    /// Read the bytes of a .hair file. The file must be exactly as long as its header states: trailing bytes are
    /// rejected, because they mean that the header and the arrays come from different files. Bits 5 to 31 of the
    /// header's flags are rejected too, because an unknown array shifts the following ones. A strand of 0 segments
    /// has one vertex. The header's default segment count applies where the array is missing. Its other defaults and
    /// its text are not kept: a missing array stays null.
    /// @param name of the file in messages
    WISP_API wisp_status wisp_groom_read_hair( const void* bytes, size_t size, const char* name, wisp_groom* out,
                                               wisp_error* error );

    /// Make a groom of arrays, checked by wisp_groom_check(). It has two dimensions if every z is 0.
    /// @param points [offsets[strand_count]] m @param offsets [strand_count + 1]
    /// @param name of the groom in messages
    /// @param out receives a copy, to be released by the caller; empty on failure
    WISP_API wisp_status wisp_groom_of_arrays( const wisp_vec3* points, int vertex_count, const int32_t* offsets,
                                               int strand_count, const char* name, wisp_groom* out,
                                               wisp_error* error );

    /// Write a file in the format of its extension: .hair, .usda or .obj. The old file, if there is one, is replaced
    /// only when the new one is complete.
    /// @return WISP_BAD_INPUT the groom does not fit the format, or the extension is unknown; WISP_IO_ERROR;
    ///         WISP_NO_MEMORY
    WISP_API wisp_status wisp_groom_write( const char* path, const wisp_groom* groom, wisp_error* error );

    /// Write to a stream. Errors of the stream itself are left to the caller's ferror().
    /// @param name of the file in messages
    /// @return WISP_BAD_INPUT the groom is malformed or not finite, or the format cannot hold a strand: .hair needs 1
    ///        to 65536 vertices per strand, .usda at least 2; nothing is written then. .obj keeps strands of one
    ///        vertex as vertices without a line.
    WISP_API wisp_status wisp_groom_write_hair( FILE* out, const wisp_groom* groom, const char* name,
                                                wisp_error* error );
    WISP_API wisp_status wisp_groom_write_usda( FILE* out, const wisp_groom* groom, const char* name,
                                                wisp_error* error );
    WISP_API wisp_status wisp_groom_write_obj( FILE* out, const wisp_groom* groom, const char* name,
                                               wisp_error* error );

    /// Whether a groom may be simulated: offsets start at 0, never fall and end at vertex_count; every number is
    /// finite; coordinates are within WISP_GROOM_MAX_COORDINATE; thickness is not negative; transparency and colour are in
    /// 0..1; two dimensions mean z = 0.
    /// @return WISP_BAD_INPUT the message names the first strand and vertex
    WISP_API wisp_status wisp_groom_check( const wisp_groom* groom, wisp_error* error );

    /// Shape of a strand along its length.
    typedef enum wisp_groom_shape
    {
        WISP_GROOM_STRAIGHT,
        WISP_GROOM_WAVY,  ///< swings from side to side
        WISP_GROOM_CURLY, ///< winds: a helix in three dimensions, a looping cycloid in two
        WISP_GROOM_RING,  ///< a regular polygon whose last vertex is on its first
    } wisp_groom_shape;

    /// A groom to generate. Fill from wisp_default_groom_generator().
    typedef struct wisp_groom_generator
    {
        wisp_groom_shape shape;
        int dimension;    ///< 2: roots on the x axis, strands along -y, z = 0. 3: roots on the upper cap of a sphere
                          ///< around the origin, strands grow outwards and fall along -y
        int strand_count; ///< >= 1
        int vertices_per_strand; ///< >= 2
        float length;            ///< m, > 0, of a strand's centre line, before waves lengthen it
        float spacing;           ///< m, >= 0, between neighbouring roots; used in two dimensions
        float scalp_radius;      ///< m, > 0; used in three dimensions, where it decides the spacing
        float wave_amplitude;    ///< m, >= 0, sideways from the centre line; unused by straight strands
        float wave_length;       ///< m, > 0, along the centre line; unused by straight strands
        float length_variation;  ///< in [0, 1): lengths are uniform in length * (1 - v) .. length * (1 + v)
        float thickness;         ///< m, >= 0, diameter of every vertex; 0 leaves the array out
        uint64_t seed;           ///< of lengths and phases
    } wisp_groom_generator;

    /// Typical hair of 25 cm: 2000 strands on a head in three dimensions, 64 strands 2 mm apart in two; 24 vertices
    /// per strand, 64 for curls; waves of 6 mm every 7 cm, curls of 8 mm every 4 cm; lengths vary by 8 percent; 0.08
    /// mm thick.
    /// @param dimension 2 or 3; anything else is kept and then rejected by wisp_groom_generate()
    WISP_API wisp_groom_generator wisp_default_groom_generator( wisp_groom_shape shape, int dimension );

/// Most vertices that wisp_groom_generate() makes.
#define WISP_GROOM_MAX_GENERATED ( 1 << 27 )

    /// Generate a groom. The same definition gives the same bits on every machine. Straight strands in two dimensions
    /// have exactly one x each. Vertices are evenly spaced along the centre line.
    /// @return WISP_BAD_INPUT the message names the invalid value; WISP_NO_MEMORY
    WISP_API wisp_status wisp_groom_generate( const wisp_groom_generator* generator, wisp_groom* out,
                                              wisp_error* error );

    /// Segments thinner than a hair, below 10 um, or shorter than a hundredth of the mean of their strand: they keep their length
    /// badly, and turn by rounding.
    typedef struct groom_shorts
    {
        int count, strand,
            segment;     ///< the latter two of the shortest one, the segment by its first vertex in the strand
        double shortest; ///< m
    } groom_shorts;

    groom_shorts groom_find_shorts( const wisp_groom* groom );
#define GROOM_SHORTS_FORMAT                                                                                          \
    "%d of the segments are below 10 um or a hundredth of their strand's mean, the shortest %.3g um (strand %d, "    \
    "vertex %d)"
#define GROOM_SHORTS( found ) ( found ).count, 1e6 * ( found ).shortest, ( found ).strand, ( found ).segment

    /// Print the contents of a groom (counts, vertices per strand, bounds, lengths, thickness) and its defects, by
    /// element: segments of zero length, strands without a segment, strands that share a root, coordinates beyond
    /// WISP_GROOM_MAX_COORDINATE; the first ten of each kind and their number.
    /// @param name of the groom in the text
    /// @return WISP_BAD_INPUT the groom is malformed or not finite, which is then the only thing printed;
    ///         WISP_NO_MEMORY
    WISP_API wisp_status wisp_groom_info( FILE* out, const wisp_groom* groom, const char* name );

#ifdef __cplusplus
}
#endif
