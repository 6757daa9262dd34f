/// Groom files that must be refused: a good file, what is done to it, and words of the message that must follow.
/// make_bad_files.c writes them to tests/bad/groom; test_bad_grooms.c reads them from there.
#pragma once

#include "bad_files.h"

enum
{
    // A good .hair file: strands of 2 and 1 segments, all five arrays.
    HAIR_SEGMENTS = 128,
    HAIR_POINTS = 132,
    HAIR_THICKNESS = 192,
    HAIR_TRANSPARENCY = 212,
    HAIR_COLOURS = 232,
    HAIR_SIZE = 292,

    // A good .tfx file: 2 strands of 4 vertices, all five arrays.
    TFX_POSITIONS = 160,
    TFX_STRAND_UV = 288,
    TFX_VERTEX_UV = 304,
    TFX_THICKNESS = 368,
    TFX_COLOURS = 376,
    TFX_SIZE = 504,
};

#define BITS_MINUS_INF 0xff800000u
#define BITS_FOUR 0x40800000u
#define BITS_SIX 0x40c00000u

static inline void bad_groom_good_hair( unsigned char* bytes )
{
    memset( bytes, 0, BAD_FILE_MAX );
    memcpy( bytes, "HAIR", 4 );
    put_number( bytes, 4, 4, 2 );
    put_number( bytes, 8, 4, 5 );
    put_number( bytes, 12, 4, 31 );
    put_number( bytes, HAIR_SEGMENTS, 2, 2 );
    put_number( bytes, HAIR_SEGMENTS + 2, 2, 1 );
    for ( int at = HAIR_POINTS; at < HAIR_SIZE; at += 4 )
    {
        put_number( bytes, at, 4, BITS_ONE );
    }
}

static inline void bad_groom_good_tfx( unsigned char* bytes )
{
    memset( bytes, 0, BAD_FILE_MAX );
    put_number( bytes, 0, 4, BITS_FOUR );
    put_number( bytes, 4, 4, 2 );
    put_number( bytes, 8, 4, 4 );
    put_number( bytes, 12, 4, TFX_POSITIONS );
    put_number( bytes, 16, 4, TFX_STRAND_UV );
    put_number( bytes, 20, 4, TFX_VERTEX_UV );
    put_number( bytes, 24, 4, TFX_THICKNESS );
    put_number( bytes, 28, 4, TFX_COLOURS );
    for ( int at = TFX_POSITIONS; at < TFX_SIZE; at += 4 )
    {
        put_number( bytes, at, 4, BITS_ONE );
    }
}

static const bad_file bad_hairs[] = {
    { "empty.hair", 0, { { 0 } }, "the file is empty" },
    { "one_byte.hair", 1, { { 0 } }, "byte 1: the file ends inside the header" },
    { "only_magic.hair", 4, { { 0 } }, "byte 4: the file ends inside the header" },
    { "header_cut.hair", 127, { { 0 } }, "byte 127: the file ends inside the header" },
    { "header_only.hair", 128, { { 0 } }, "inside the segments, which start at byte 128" },
    { "wrong_magic.hair", HAIR_SIZE, { { 0, 4, 0x52494147u } }, "byte 0: expected \"HAIR\"" },
    { "lower_case_magic.hair", HAIR_SIZE, { { 0, 4, 0x72696168u } }, "byte 0: expected \"HAIR\"" },
    { "big_endian_counts.hair", HAIR_SIZE, { { 4, 4, 0x02000000u }, { 8, 4, 0x05000000u } }, "inside the segments" },
    { "no_strands.hair", HAIR_SIZE, { { 4, 4, 0 } }, "byte 4: got 0 strands" },
    { "no_points.hair", HAIR_SIZE, { { 8, 4, 0 } }, "byte 8: got 0 points" },
    { "fewer_points_than_strands.hair", HAIR_SIZE, { { 4, 4, 6 } }, "expected at least one for each of 6 strands" },
    { "strands_minus_one.hair", HAIR_SIZE, { { 4, 4, 0xffffffffu } }, "for each of 4294967295 strands" },
    { "points_minus_one.hair", HAIR_SIZE, { { 8, 4, 0xffffffffu } }, "inside the points" },
    { "both_minus_one.hair", HAIR_SIZE, { { 4, 4, 0xffffffffu }, { 8, 4, 0xffffffffu } }, "need 8589934590 bytes" },
    { "strands_wrap_16_bits.hair",
      HAIR_SIZE,
      { { 4, 4, 0x80000002u }, { 8, 4, 0x80000005u } },
      "inside the segments" },
    { "points_wrap_32_bits.hair", HAIR_SIZE, { { 8, 4, 0x40000005u } }, "need 12884901948 bytes" },
    { "flags_without_points.hair", HAIR_SIZE, { { 12, 4, 29 } }, "got flags 0x1d, expected those of points" },
    { "flags_none.hair", HAIR_SIZE, { { 12, 4, 0 } }, "expected those of points" },
    { "flags_unknown.hair", HAIR_SIZE, { { 12, 4, 63 } }, "byte 12: got flags 0x3f, expected only those of" },
    { "flags_all.hair", HAIR_SIZE, { { 12, 4, 0xffffffffu } }, "byte 12: got flags 0xffffffff" },
    { "segments_cut.hair", 131, { { 0 } }, "byte 131: the file ends inside the segments" },
    { "points_cut.hair", 180, { { 0 } }, "byte 180: the file ends inside the points, which start at byte 132" },
    { "points_missing.hair", 132, { { 0 } }, "byte 132: the file ends inside the points" },
    { "thickness_cut.hair", 200, { { 0 } }, "byte 200: the file ends inside the thickness" },
    { "transparency_cut.hair", 231, { { 0 } }, "byte 231: the file ends inside the transparency" },
    { "colours_cut.hair", 291, { { 0 } }, "byte 291: the file ends inside the colours" },
    { "one_byte_more.hair", 293, { { 0 } }, "byte 292: 1 bytes follow the last array" },
    { "many_bytes_more.hair", 1000, { { 0 } }, "byte 292: 708 bytes follow" },
    { "colours_unannounced.hair", HAIR_SIZE, { { 12, 4, 15 } }, "byte 232: 60 bytes follow" },
    { "sum_too_large.hair", HAIR_SIZE, { { 130, 2, 2 } }, "byte 130: the segments of strand 1 need 6 points" },
    { "sum_too_small.hair", HAIR_SIZE, { { 128, 2, 1 } }, "the segments of all 2 strands need 4 points" },
    { "segments_minus_one.hair", HAIR_SIZE, { { 128, 2, 0xffffu } }, "the segments of strand 0 need 65536 points" },
    { "default_sum_mismatch.hair", 288, { { 12, 4, 30 }, { 16, 4, 1 } }, "byte 16: the segments of all 2 strands" },
    { "default_segments_huge.hair",
      288,
      { { 12, 4, 30 }, { 16, 4, 0xffffffffu } },
      "strand 0 need 4294967296 points" },
    { "x_nan.hair", HAIR_SIZE, { { HAIR_POINTS, 4, BITS_NAN } }, "strand 0, vertex 0: x is NaN" },
    { "y_inf.hair", HAIR_SIZE, { { HAIR_POINTS + 40, 4, BITS_INF } }, "strand 1, vertex 0: y is infinite" },
    { "z_minus_inf.hair",
      HAIR_SIZE,
      { { HAIR_POINTS + 56, 4, BITS_MINUS_INF } },
      "strand 1, vertex 1: z is infinite" },
    { "thickness_nan.hair", HAIR_SIZE, { { HAIR_THICKNESS + 8, 4, 0xffffffffu } }, "vertex 2: thickness is NaN" },
    { "transparency_inf.hair",
      HAIR_SIZE,
      { { HAIR_TRANSPARENCY, 4, BITS_INF } },
      "vertex 0: transparency is infinite" },
    { "green_nan.hair", HAIR_SIZE, { { HAIR_COLOURS + 4, 4, BITS_NAN } }, "strand 0, vertex 0: green is NaN" },
    { "text.hair", HAIR_SIZE, { { 0, 4, 0x3a696148u }, { 4, 4, 0x6e6f6c20u } }, "byte 0: expected \"HAIR\"" },
    { "called_txt.txt", HAIR_SIZE, { { 0, 4, 0x3a696148u } }, "not a groom" },
};

static const bad_file bad_tfxs[] = {
    { "empty.tfx", 0, { { 0 } }, "byte 0: the file ends inside the header" },
    { "header_cut.tfx", 159, { { 0 } }, "byte 159: the file ends inside the header" },
    { "header_only.tfx", 160, { { 0 } }, "byte 160: the file ends inside the positions" },
    { "version_3.tfx", TFX_SIZE, { { 0, 4, 0x40400000u } }, "got version 3" },
    { "version_6.tfx", TFX_SIZE, { { 0, 4, BITS_SIX } }, "got version 6" },
    { "version_nan.tfx", TFX_SIZE, { { 0, 4, BITS_NAN } }, "expected a TressFX file" },
    { "version_as_integer.tfx", TFX_SIZE, { { 0, 4, 4 } }, "expected a TressFX file" },
    { "no_strands.tfx", TFX_SIZE, { { 4, 4, 0 } }, "byte 4: got 0 strands" },
    { "strands_minus_one.tfx", TFX_SIZE, { { 4, 4, 0xffffffffu } }, "17179869180 times 16 bytes" },
    { "no_vertices.tfx", TFX_SIZE, { { 8, 4, 0 } }, "byte 8: got strands of 0 vertices" },
    { "one_vertex.tfx", TFX_SIZE, { { 8, 4, 1 } }, "byte 8: got strands of 1 vertices" },
    { "vertices_minus_one.tfx", TFX_SIZE, { { 8, 4, 0xffffffffu } }, "8589934590 times 16 bytes" },
    { "both_minus_one.tfx", TFX_SIZE, { { 4, 4, 0xffffffffu }, { 8, 4, 0xffffffffu } }, "inside the positions" },
    { "counts_wrap_32_bits.tfx", TFX_SIZE, { { 4, 4, 0x80000000u }, { 8, 4, 2 } }, "4294967296 times 16 bytes" },
    { "counts_wrap_64_bits.tfx", TFX_SIZE, { { 4, 4, 0x80000000u }, { 8, 4, 0x20000000u } }, "inside the positions" },
    { "positions_nowhere.tfx", TFX_SIZE, { { 12, 4, 0 } }, "byte 12: the positions cannot start at byte 0" },
    { "positions_in_header.tfx", TFX_SIZE, { { 12, 4, 159 } }, "the positions cannot start at byte 159" },
    { "positions_beyond_end.tfx", TFX_SIZE, { { 12, 4, 505 } }, "the positions cannot start at byte 505" },
    { "positions_minus_one.tfx", TFX_SIZE, { { 12, 4, 0xffffffffu } }, "cannot start at byte 4294967295" },
    { "positions_cut.tfx", 287, { { 16, 4, 0 }, { 20, 4, 0 }, { 24, 4, 0 }, { 28, 4, 0 } }, "inside the positions" },
    { "strand_uv_beyond_end.tfx", TFX_SIZE, { { 16, 4, 490 } }, "inside the texture coordinates of strands" },
    { "vertex_uv_beyond_end.tfx", TFX_SIZE, { { 20, 4, 441 } }, "inside the texture coordinates of vertices" },
    { "thickness_beyond_end.tfx", TFX_SIZE, { { 24, 4, 497 } }, "inside the thickness of strands" },
    { "colours_cut.tfx", 503, { { 0 } }, "byte 503: the file ends inside the colours" },
    { "colours_in_header.tfx", TFX_SIZE, { { 28, 4, 32 } }, "byte 28: the colours cannot start at byte 32" },
    { "x_nan.tfx", TFX_SIZE, { { TFX_POSITIONS + 80, 4, BITS_NAN } }, "strand 1, vertex 1: x is NaN" },
    { "z_inf.tfx", TFX_SIZE, { { TFX_POSITIONS + 8, 4, BITS_INF } }, "strand 0, vertex 0: z is infinite" },
    { "thickness_nan.tfx", TFX_SIZE, { { TFX_THICKNESS + 4, 4, BITS_NAN } }, "strand 1, vertex 0: thickness is NaN" },
    { "blue_inf.tfx", TFX_SIZE, { { TFX_COLOURS + 8, 4, BITS_INF } }, "strand 0, vertex 0: blue is infinite" },
};

/// The two formats.
static const bad_file_list bad_groom_lists[] = {
    { bad_hairs, sizeof bad_hairs / sizeof bad_hairs[0], bad_groom_good_hair, NULL },
    { bad_tfxs, sizeof bad_tfxs / sizeof bad_tfxs[0], bad_groom_good_tfx, NULL },
};
