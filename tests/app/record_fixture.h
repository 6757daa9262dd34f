/// Bodies and points shared by the recording tests.
#pragma once

#include "folder_fixture.h"

#include "record.h"

/// For locals that point to a recording.
static inline void recording_local( wisp_recording** local )
{
    wisp_recording_close( *local );
}

enum
{
    FIXTURE_BODIES = 2,
    CLOTH_VERTICES = 4,
    HAIR_VERTICES = 5,
};

static const int32_t fixture_triangles[] = { 0, 1, 2, 2, 1, 3 };
static const int32_t fixture_offsets[] = { 0, 3, 5 };

/// A square of two triangles, and two strands.
static const wisp_record_body fixture_bodies[FIXTURE_BODIES] = {
    { .name = "cloth", .triangles = fixture_triangles, .vertex_count = CLOTH_VERTICES, .triangle_count = 2 },
    { .name = "hair-2", .offsets = fixture_offsets, .vertex_count = HAIR_VERTICES, .strand_count = 2 },
};

/// Points of all bodies in one frame.
typedef struct fixture_frame
{
    wisp_vec3 cloth[CLOTH_VERTICES];
    wisp_vec3 hair[HAIR_VERTICES];
} fixture_frame;

/// Numbers that need nine digits to be restored, different in every frame.
static inline fixture_frame fixture_points( int f )
{
    fixture_frame frame = {
        .cloth = { { 0.1f, -0.0f, 1e-40f },
                   { 1.0f / 3.0f, -123456.789f, 0x1.fffffep-1f },
                   { 1.17549435e-38f, 2.5f, -7.0f },
                   { 16777217.0f, 1e6f, -1e-10f } },
        .hair = { { 0.3f, 0.6f, 0.9f },
                  { 3.4028235e38f, -0.7f, 8.0f },
                  { 0.0f, 0.0f, 0.0f },
                  { -0.1f, -0.2f, -0.3f },
                  { 121.360634f, 122.243706f, 100.670395f } },
    };
    frame.cloth[2].y += 0.1f * (float)f;
    frame.hair[4].x *= (float)( f + 1 );
    return frame;
}

static inline double fixture_time( int f )
{
    return ( f + 1 ) / 60.0;
}

static inline uint64_t fixture_hash( int f )
{
    return 0x0123456789abcdefu * (uint64_t)( f + 1 );
}

/// Vertices to follow; the first one is in the first body.
static const wisp_track_point fixture_tracks[] = { { 0, 1 }, { 1, 4 } };

static inline wisp_recorder_def fixture_def( void )
{
    return ( wisp_recorder_def ){ .bodies = fixture_bodies,
                                  .body_count = FIXTURE_BODIES,
                                  .dt = 1.0 / 60.0,
                                  .tracks = fixture_tracks,
                                  .track_count = 2 };
}

static inline wisp_status fixture_open( const char* path, const wisp_recorder_def* def, wisp_recorder** recorder,
                                        wisp_error* error )
{
    const bool is_table = strstr( path, ".csv" ) != NULL;
    return wisp_recorder_open( path, is_table ? WISP_RECORD_TRACKS : WISP_RECORD_BY_NAME, def, recorder, error );
}

static inline wisp_status fixture_add_frame( wisp_recorder* recorder, int f, wisp_error* error )
{
    fixture_frame frame = fixture_points( f );
    const wisp_vec3* points[] = { frame.cloth, frame.hair };
    return wisp_recorder_frame( recorder, fixture_time( f ), fixture_hash( f ), points, error );
}

/// Record this number of frames of the fixture; everything must succeed.
static inline void fixture_record( const char* path, const wisp_recorder_def* def, int frame_count )
{
    wisp_error error = { .status = WISP_OK };
    wisp_recorder* recorder = NULL;
    assert_ok( fixture_open( path, def, &recorder, &error ), error );
    for ( int f = 0; f < frame_count; ++f )
    {
        assert_ok( fixture_add_frame( recorder, f, &error ), error );
    }
    assert_ok( wisp_recorder_close( recorder, &error ), error );
}

static inline void assert_one_message( const wisp_error* error, wisp_status status, const char* words )
{
    assert_int_equal( error->status, status );
    assert_null( strchr( error->message, '\n' ) );
    assert_contains( error->message, words );
}
