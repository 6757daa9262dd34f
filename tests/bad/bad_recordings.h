/// Recordings and point caches that must be refused: a good file, what is done to it, and words of the message that
/// must follow. make_bad_files.c writes them to tests/bad/recording, test_bad_recordings.c reads them there.
/// The good files and the checksums are built from the description of the format, not by the code under test.
#pragma once

#include "bad_files.h"

enum
{
    // A good .wisp file: a triangle "cloth", two strands "hairs" of two vertices, two frames, the mark of the end.
    WISP_CLOTH = 40,
    WISP_CLOTH_NAME = 56,
    WISP_CLOTH_TRIANGLES = 64,
    WISP_HAIR = 76,
    WISP_HAIR_NAME = 92,
    WISP_HAIR_OFFSETS = 100,
    WISP_HEADER = 120, // bytes, with its checksum
    WISP_FRAME = 132,  // bytes
    WISP_FRAME_0 = 120,
    WISP_FRAME_1 = 252,
    WISP_END = 384,
    WISP_SIZE = 408,

    // A good .pc2 file: 2 points, 2 samples.
    PC2_SIZE = 80,
};

#define BITS_DOUBLE_NAN 0x7ff8000000000000u
#define BITS_DOUBLE_ONE 0x3ff0000000000000u

static inline uint64_t bad_recording_get( const unsigned char* bytes, size_t at )
{
    uint64_t value = 0;
    for ( size_t i = 0; i < 8; ++i )
    {
        value |= (uint64_t)bytes[at + i] << 8 * i;
    }
    return value;
}

/// Words of eight bytes, the last one filled up with zeros.
static inline uint64_t bad_recording_checksum( uint64_t seed, const unsigned char* bytes, size_t size )
{
    uint64_t hash = seed ^ ( (uint64_t)size * 0x9e3779b97f4a7c15u );
    for ( size_t at = 0; at < size; at += 8 )
    {
        unsigned char word[8] = { 0 };
        memcpy( word, bytes + at, size - at < 8 ? size - at : 8 );
        hash = ( hash ^ bad_recording_get( word, 0 ) ) * 0xff51afd7ed558ccdu;
        hash ^= hash >> 32;
    }
    return hash;
}

/// Make every checksum of any bytes right, as far as their header says where they are.
static inline void bad_recording_seal( unsigned char* bytes, size_t size )
{
    if ( size < 48 )
    {
        return;
    }
    uint64_t header = bad_recording_get( bytes, 16 ), frame = bad_recording_get( bytes, 24 );
    if ( header < 48 || header > size || frame < 16 )
    {
        return;
    }
    size_t at = (size_t)header;
    uint64_t seed = bad_recording_checksum( 0, bytes, at - 8 );
    put_number( bytes + at - 8, 0, 8, seed );
    for ( ; frame <= size - at; at += (size_t)frame )
    {
        size_t end = (size_t)frame - 8;
        put_number( bytes + at + end, 0, 8, bad_recording_checksum( seed, bytes + at, end ) );
    }
    if ( size - at == 24 )
    {
        put_number( bytes + at + 16, 0, 8, bad_recording_checksum( seed, bytes + at, 16 ) );
    }
}

static inline void bad_recording_good_frame( unsigned char* bytes, int index )
{
    memcpy( bytes, "WISPFRAM", 8 );
    put_number( bytes, 8, 8, WISP_FRAME );
    put_number( bytes, 16, 8, (uint64_t)index );
    put_number( bytes, 24, 8, index == 0 ? 0 : BITS_DOUBLE_ONE );
    put_number( bytes, 32, 8, 7 );
    for ( int at = 40; at < WISP_FRAME - 8; at += 4 )
    {
        put_number( bytes, at, 4, BITS_ONE );
    }
}

static inline void bad_recording_good_wisp( unsigned char* bytes )
{
    static const uint32_t numbers[] = { 0, 1, 2 }, offsets[] = { 0, 2, 4 };
    memset( bytes, 0, BAD_FILE_MAX );
    memcpy( bytes, "WISP\r\n\x1a\n", 8 );
    put_number( bytes, 8, 4, 1 );
    put_number( bytes, 12, 4, 2 );
    put_number( bytes, 16, 8, WISP_HEADER );
    put_number( bytes, 24, 8, WISP_FRAME );
    put_number( bytes, 32, 8, BITS_DOUBLE_ONE );
    put_number( bytes, WISP_CLOTH + 4, 4, 5 );
    put_number( bytes, WISP_CLOTH + 8, 4, 3 );
    put_number( bytes, WISP_CLOTH + 12, 4, 1 );
    memcpy( bytes + WISP_CLOTH_NAME, "cloth", 5 );
    put_number( bytes, WISP_HAIR, 4, 1 );
    put_number( bytes, WISP_HAIR + 4, 4, 5 );
    put_number( bytes, WISP_HAIR + 8, 4, 4 );
    put_number( bytes, WISP_HAIR + 12, 4, 2 );
    memcpy( bytes + WISP_HAIR_NAME, "hairs", 5 );
    for ( int i = 0; i < 3; ++i )
    {
        put_number( bytes, WISP_CLOTH_TRIANGLES + 4 * i, 4, numbers[i] );
        put_number( bytes, WISP_HAIR_OFFSETS + 4 * i, 4, offsets[i] );
    }
    bad_recording_good_frame( bytes + WISP_FRAME_0, 0 );
    bad_recording_good_frame( bytes + WISP_FRAME_1, 1 );
    memcpy( bytes + WISP_END, "WISPEND\n", 8 );
    put_number( bytes, WISP_END + 8, 8, 2 );
    bad_recording_seal( bytes, WISP_SIZE );
}

static inline void bad_recording_good_pc2( unsigned char* bytes )
{
    memset( bytes, 0, BAD_FILE_MAX );
    memcpy( bytes, "POINTCACHE2", 12 );
    put_number( bytes, 12, 4, 1 );
    put_number( bytes, 16, 4, 2 );
    put_number( bytes, 24, 4, BITS_ONE );
    put_number( bytes, 28, 4, 2 );
    for ( int at = 32; at < PC2_SIZE; at += 4 )
    {
        put_number( bytes, at, 4, BITS_ONE );
    }
}

// Refused when they are opened, or when a frame is read.
static const bad_file bad_wisps[] = {
    { "empty.wisp", 0, { { 0 } }, "the file is empty" },
    { "one_byte.wisp", 1, { { 0 } }, "byte 1: the file ends inside the header" },
    { "only_magic.wisp", 8, { { 0 } }, "byte 8: the file ends inside the header" },
    { "header_cut.wisp", 39, { { 0 } }, "byte 39: the file ends inside the header" },
    { "bodies_missing.wisp", 40, { { 0 } }, "byte 40: the file ends inside the list of bodies" },
    { "bodies_cut.wisp", 119, { { 0 } }, "byte 119: the file ends inside the list of bodies" },
    { "header_short.wisp", WISP_SIZE, { { 16, 8, 47 } }, "byte 16: got a header of 47 bytes" },
    { "header_minus_one.wisp", WISP_SIZE, { { 16, 8, UINT64_MAX } }, "byte 16: got a header of 184467" },
    { "header_long.wisp", WISP_SIZE, { { 16, 8, 409 } }, "byte 408: the file ends inside the list of bodies" },
    { "header_other.wisp", WISP_SIZE, { { 16, 8, 112 } }, "byte 104: the header is damaged" },
    { "frame_zero.wisp", WISP_SIZE, { { 24, 8, 0 } }, "byte 112: the header is damaged" },
    { "header_damaged.wisp", WISP_SIZE, { { WISP_CLOTH_NAME, 1, 'k' } }, "byte 112: the header is damaged" },
    { "frame_damaged.wisp",
      WISP_SIZE,
      { { WISP_FRAME_1 + 60, 1, 1 } },
      "frame 1 at byte 252 is damaged: its checksum" },
};

// With correct checksums.
static const bad_file bad_sealed_wisps[] = {
    { "wrong_magic.wisp", WISP_SIZE, { { 0, 1, 'V' } }, "byte 0: expected the start of a recording" },
    { "taken_for_text.wisp", WISP_SIZE, { { 4, 2, 0x1a0a } }, "byte 0: expected the start of a recording" },
    { "version_0.wisp", WISP_SIZE, { { 8, 4, 0 } }, "byte 8: got version 0" },
    { "version_3.wisp", WISP_SIZE, { { 8, 4, 3 } }, "byte 8: got version 3" },
    { "big_endian.wisp", WISP_SIZE, { { 8, 4, 0x01000000u } }, "byte 8: got version 16777216" },
    { "no_bodies.wisp", WISP_SIZE, { { 12, 4, 0 } }, "byte 12: got 0 bodies, expected 1 to 4096" },
    { "bodies_minus_one.wisp", WISP_SIZE, { { 12, 4, 0xffffffffu } }, "byte 12: got 4294967295 bodies" },
    { "one_body_less.wisp", WISP_SIZE, { { 12, 4, 1 } }, "byte 76: 36 bytes follow the last body" },
    { "one_body_more.wisp", WISP_SIZE, { { 12, 4, 3 } }, "byte 112: the list of bodies ends inside body 2" },
    { "frame_short.wisp", WISP_SIZE, { { 24, 8, 131 } }, "byte 24: got frames of 131 bytes" },
    { "frame_minus_one.wisp", WISP_SIZE, { { 24, 8, UINT64_MAX } }, "byte 24: got frames of 18446744073709551615" },
    { "step_zero.wisp", WISP_SIZE, { { 32, 8, 0 } }, "byte 32: got 0 seconds" },
    { "step_nan.wisp", WISP_SIZE, { { 32, 8, BITS_DOUBLE_NAN } }, "byte 32: " },
    { "step_negative.wisp", WISP_SIZE, { { 39, 1, 0xbf } }, "byte 32: got -1 seconds" },
    { "kind_unknown.wisp", WISP_SIZE, { { WISP_CLOTH, 4, 3 } }, "byte 40: body 0 cannot be of kind 3" },
    { "kind_changing.wisp", WISP_SIZE, { { WISP_CLOTH, 4, 2 } }, "byte 24: got frames of 132 bytes, expected 144" },
    { "name_long.wisp", WISP_SIZE, { { WISP_CLOTH + 4, 4, 65 } }, "with a name of 65 letters" },
    { "name_minus_one.wisp", WISP_SIZE, { { WISP_CLOTH + 4, 4, 0xffffffffu } }, "a name of 4294967295 letters" },
    { "name_empty.wisp", WISP_SIZE, { { WISP_HAIR + 4, 4, 0 } }, "byte 104: 8 bytes follow the last body" },
    { "name_slash.wisp", WISP_SIZE, { { WISP_CLOTH_NAME, 2, 0x2f2e } }, "body 0: expected a name" },
    { "name_escape.wisp", WISP_SIZE, { { WISP_CLOTH_NAME, 1, 0x1b } }, "body 0: expected a name" },
    { "name_zero.wisp", WISP_SIZE, { { WISP_CLOTH_NAME + 2, 1, 0 } }, "byte 56: a zero is inside the name" },
    { "names_equal.wisp",
      WISP_SIZE,
      { { WISP_HAIR_NAME, 4, 0x746f6c63u }, { WISP_HAIR_NAME + 4, 1, 'h' } },
      "bodies 0 and 1 are both called cloth" },
    { "no_vertices.wisp", WISP_SIZE, { { WISP_CLOTH + 8, 4, 0 } }, "body cloth: got 0 vertices" },
    { "vertices_minus_one.wisp", WISP_SIZE, { { WISP_CLOTH + 8, 4, 0xffffffffu } }, "4294967295 vertices" },
    { "vertices_wrap.wisp", WISP_SIZE, { { WISP_CLOTH + 8, 4, 0x7ffffffeu } }, "2147483650 vertices are more than" },
    { "vertices_many.wisp",
      WISP_SIZE,
      { { WISP_CLOTH + 8, 4, 0x40000000u } },
      "expected 12884901984 for these bodies" },
    { "triangles_many.wisp", WISP_SIZE, { { WISP_CLOTH + 12, 4, 0x7ffffffeu } }, "byte 56: the list of bodies" },
    { "triangles_wrap.wisp", WISP_SIZE, { { WISP_CLOTH + 12, 4, 0x55555556u } }, "byte 56: the list of bodies" },
    { "triangle_beyond.wisp",
      WISP_SIZE,
      { { WISP_CLOTH_TRIANGLES + 8, 4, 3 } },
      "body cloth: triangle 0: got vertex 3, expected 0 .. 2" },
    { "triangle_negative.wisp",
      WISP_SIZE,
      { { WISP_CLOTH_TRIANGLES, 4, 0xffffffffu } },
      "body cloth: triangle 0: got vertex -1, expected 0 .. 2" },
    { "offsets_late.wisp", WISP_SIZE, { { WISP_HAIR_OFFSETS, 4, 1 } }, "body hairs: strand 0 starts at vertex 1" },
    { "offsets_fall.wisp",
      WISP_SIZE,
      { { WISP_HAIR_OFFSETS + 4, 4, 5 } },
      "body hairs: strand 0 runs from vertex 0 to 5 of 4" },
    { "offsets_negative.wisp",
      WISP_SIZE,
      { { WISP_HAIR_OFFSETS + 4, 4, 0x80000000u } },
      "body hairs: strand 0 runs from" },
    { "offsets_early.wisp", WISP_SIZE, { { WISP_HAIR_OFFSETS + 8, 4, 3 } }, "the strands end at vertex 3 of 4" },
    { "frame_magic.wisp",
      WISP_SIZE,
      { { WISP_FRAME_0, 1, 'w' } },
      "frame 0 at byte 120 is damaged: it does not start" },
    { "frame_length.wisp",
      WISP_SIZE,
      { { WISP_FRAME_0 + 8, 8, 131 } },
      "frame 0 at byte 120 is damaged: it does not start" },
    { "frame_number.wisp",
      WISP_SIZE,
      { { WISP_FRAME_1 + 16, 8, 0 } },
      "frame 1 at byte 252 is damaged: it has the number" },
    { "frame_time_nan.wisp",
      WISP_SIZE,
      { { WISP_FRAME_0 + 24, 8, BITS_DOUBLE_NAN } },
      "frame 0 at byte 120 is damaged: its time" },
    { "frame_nan.wisp",
      WISP_SIZE,
      { { WISP_FRAME_1 + 40, 4, BITS_NAN } },
      "frame 1 at byte 252: body cloth, vertex 0 is not finite" },
    { "frame_inf.wisp",
      WISP_SIZE,
      { { WISP_FRAME_1 + 120, 4, BITS_INF } },
      "frame 1 at byte 252: body hairs, vertex 3 is not finite" },
    { "end_count.wisp",
      WISP_SIZE,
      { { WISP_END + 8, 8, 3 } },
      "byte 384: the mark of the end counts 3 frames, the file has 2" },
};

static const bad_file bad_pc2s[] = {
    { "empty.pc2", 0, { { 0 } }, "the file is empty" },
    { "one_byte.pc2", 1, { { 0 } }, "byte 1: the file ends inside the header" },
    { "header_cut.pc2", 31, { { 0 } }, "byte 31: the file ends inside the header" },
    { "wrong_magic.pc2", PC2_SIZE, { { 10, 1, '1' } }, "byte 0: expected \"POINTCACHE2\"" },
    { "magic_without_zero.pc2", PC2_SIZE, { { 11, 1, ' ' } }, "byte 0: expected \"POINTCACHE2\"" },
    { "version_2.pc2", PC2_SIZE, { { 12, 4, 2 } }, "byte 12: got version 2" },
    { "big_endian.pc2", PC2_SIZE, { { 12, 4, 0x01000000u } }, "byte 12: got version 16777216" },
    { "no_points.pc2", PC2_SIZE, { { 16, 4, 0 } }, "byte 16: got 0 points" },
    { "points_minus_one.pc2", PC2_SIZE, { { 16, 4, 0xffffffffu } }, "byte 16: got 4294967295 points" },
    { "points_wrap.pc2", PC2_SIZE, { { 16, 4, 0x55555556u } }, "inside sample 0 of 2" },
    { "start_nan.pc2", PC2_SIZE, { { 20, 4, BITS_NAN } }, "byte 20: the start frame is not finite" },
    { "rate_zero.pc2", PC2_SIZE, { { 24, 4, 0 } }, "byte 24: got a sample rate of 0" },
    { "rate_inf.pc2", PC2_SIZE, { { 24, 4, BITS_INF } }, "byte 24: got a sample rate of inf" },
    { "samples_minus_one.pc2", PC2_SIZE, { { 28, 4, 0xffffffffu } }, "byte 28: got 4294967295 samples" },
    { "samples_many.pc2", PC2_SIZE, { { 28, 4, 0x7fffffffu } }, "inside sample 2 of 2147483647" },
    { "samples_missing.pc2", 32, { { 0 } }, "byte 32: the file ends inside sample 0 of 2" },
    { "sample_cut.pc2", 79, { { 0 } }, "byte 79: the file ends inside sample 1 of 2" },
    { "one_byte_more.pc2", 81, { { 0 } }, "byte 80: 1 bytes follow the last sample" },
    { "unfinished.pc2", PC2_SIZE, { { 28, 4, 0 } }, "byte 32: 48 bytes follow the last sample" },
    { "point_nan.pc2", PC2_SIZE, { { 68, 4, BITS_NAN } }, "byte 68: frame 1, point 1 is not finite" },
    { "point_inf.pc2", PC2_SIZE, { { 40, 4, BITS_INF } }, "byte 32: frame 0, point 0 is not finite" },
};

static const bad_file_list bad_recording_lists[] = {
    { bad_wisps, sizeof bad_wisps / sizeof bad_wisps[0], bad_recording_good_wisp, NULL },
    { bad_sealed_wisps, sizeof bad_sealed_wisps / sizeof bad_sealed_wisps[0], bad_recording_good_wisp,
      bad_recording_seal },
    { bad_pc2s, sizeof bad_pc2s / sizeof bad_pc2s[0], bad_recording_good_pc2, NULL },
};
