/// A folder with the inputs of tests of pictures and recordings: two scenes, and a recorded sheet that flies and is
/// stretched.
#pragma once

#include "program_fixture.h"

#include "mesh.h"
#include "record.h"

#include <sys/stat.h>

enum
{
    FRAMES = 6,
    SIDE = 5, // vertices
};

#define STEP 0.1
#define SPEED 10.0f // m/s

static const char hair_scene[] =
    "wisp: 1\n"
    "steps: 3\n"
    "strands:\n"
    "  - name: hair\n"
    "    generate: { shape: wavy, dimension: 2, strands: 40, vertices: 20, spacing: 0.001 }\n"
    "    frozen_hair: { freeze: {}, align: { cursor: [0, -0.3, 0] }, clump: { radius: 0.006 } }\n"
    "    appearance: {}\n"
    "hair_events:\n"
    "  - { step: 1, strands: hair, cursor: [0.1, -0.2, 0] }\n";

static const char cloth_scene[] = "wisp: 1\n"
                                  "steps: 6\n"
                                  "substeps: 4\n"
                                  "surfaces:\n"
                                  "  - name: cloth\n"
                                  "    generate: { shape: plane, columns: 12, rows: 12, spacing: 0.05 }\n"
                                  "    transform: { translate: [0, 0.43, 0] }\n"
                                  "    cloth: {}\n"
                                  "    collision: { thickness: 0.01 }\n"
                                  "colliders:\n"
                                  "  - { name: ball, shape: sphere, radius: 0.2, position: [0, 0.2, 0] }\n"
                                  "  - { name: floor, shape: plane }\n";

/// Upright, 0.4 m wide, wider by a quarter with each frame.
static inline void place_sheet( int frame, float shift, wisp_vec3* points )
{
    for ( int i = 0; i < SIDE * SIDE; ++i )
    {
        float stretch = 1.0f + 0.25f * (float)frame;
        points[i] = ( wisp_vec3 ){ stretch * 0.1f * (float)( i % SIDE - 2 ) + shift * (float)frame,
                                   stretch * 0.1f * (float)( i / SIDE ), 0.0f };
    }
}

static inline void make_triangles( int32_t* triangles )
{
    for ( int j = 0; j + 1 < SIDE; ++j )
    {
        for ( int i = 0; i + 1 < SIDE; ++i )
        {
            int a = j * SIDE + i;
            const int32_t two[6] = { a, a + 1, a + SIDE, a + 1, a + SIDE + 1, a + SIDE };
            memcpy( triangles, two, sizeof( two ) );
            triangles += 6;
        }
    }
}

/// @param shift m along x, of each frame relative to the previous one
static inline void record_sheet( const char* path, float shift )
{
    int32_t triangles[6 * ( SIDE - 1 ) * ( SIDE - 1 )];
    make_triangles( triangles );
    const wisp_record_body body = {
        .name = "sheet",
        .triangles = triangles,
        .vertex_count = SIDE * SIDE,
        .triangle_count = 2 * ( SIDE - 1 ) * ( SIDE - 1 ),
    };
    const wisp_recorder_def def = { .bodies = &body, .body_count = 1, .dt = STEP };
    wisp_error error = { 0 };
    wisp_recorder* recorder;
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, &error ), WISP_OK );
    for ( int f = 0; f < FRAMES; ++f )
    {
        wisp_vec3 points[SIDE * SIDE];
        place_sheet( f, shift, points );
        const wisp_vec3* all[] = { points };
        assert_int_equal( wisp_recorder_frame( recorder, f * STEP, 0, all, &error ), WISP_OK );
    }
    assert_int_equal( wisp_recorder_close( recorder, &error ), WISP_OK );
}

static inline void write_sheet_mesh( const char* path )
{
    wisp_vec3 points[SIDE * SIDE];
    int32_t triangles[6 * ( SIDE - 1 ) * ( SIDE - 1 )];
    place_sheet( 0, 0.0f, points );
    make_triangles( triangles );
    const wisp_mesh mesh = { .points = points,
                             .triangles = triangles,
                             .vertex_count = SIDE * SIDE,
                             .triangle_count = 2 * ( SIDE - 1 ) * ( SIDE - 1 ) };
    wisp_error error = { 0 };
    assert_int_equal( wisp_mesh_write( path, &mesh, &error ), WISP_OK );
}

static inline int enter_folder( void** state )
{
    static const text_file files[] = { { "hair.yaml", hair_scene },
                                       { "cloth.yaml", cloth_scene },
                                       { "other.txt", "a letter\n" },
                                       { "triangle.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" } };
    const int status = enter_folder_with( state, files, WISP_COUNT( files ) );
    record_sheet( "fly.wisp", SPEED * (float)STEP );
    record_sheet( "fly.pc2", SPEED * (float)STEP );
    record_sheet( "stay.wisp", 0.0f );
    write_sheet_mesh( "sheet.obj" );
    return status;
}
