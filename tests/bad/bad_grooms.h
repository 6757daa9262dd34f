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
};

#define BITS_MINUS_INF 0xff800000u

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
    { "of_tressfx.tfx", 160, { { 0, 4, 0x40800000u } }, "not a groom, expected a file that starts with \"HAIR\"" },
    { "called_txt.txt", HAIR_SIZE, { { 0, 4, 0x3a696148u } }, "not a groom" },
};

static const bad_file_list bad_groom_list = { bad_hairs, sizeof bad_hairs / sizeof bad_hairs[0], bad_groom_good_hair,
                                              NULL };
