// The built program, whose path is the first argument, records, tracks, verifies and describes files: recordings are
// read back by the library.
#include "flying_sheet.h"

// ---- recordings of a run ----

TEST( a_run_is_recorded_in_every_format )
{
    static const char* const files[][2] = {
        { "a.wisp", "a.wisp" },    { "a.pc2", "a.pc2" },   { "a.pvd", "a/hair_0004.vtp" },
        { "a.obj", "a_0004.obj" }, { "a.usda", "a.usda" }, { "a.glb", "a.glb" },
    };
    for ( int i = 0; i < WISP_COUNT( files ); ++i )
    {
        char command[100];
        snprintf( command, sizeof( command ), "run hair.yaml --record %s", files[i][0] );
        run_ok( command );
        assert_string_equal( result.err, "" );
        assert_non_null( strstr( result.out, ": 4 frames\n" ) );
        assert_true( exists( files[i][1] ) );
    }
}

/// The sixteen digits after the last `hash`.
static void read_hash( char* out )
{
    const char* line = strstr( result.out, "\nhash " );
    assert_non_null( line );
    assert_int_equal( sscanf( line, "\nhash %16s", out ), 1 );
}

static bool has_array( const char* path, const char* name )
{
    char words[60];
    size_t size;
    SCOPED( free_local ) char* text = read_bytes( path, &size );
    snprintf( words, sizeof( words ), "Name=\"%s\"", name );
    return strstr( text, words ) != NULL;
}

TEST( recording_does_not_change_the_hash_unless_more_is_computed )
{
    static const char* const files[] = { "h.wisp", "h.pc2", "h.pvd", "h.obj", "h.usda", "h.glb" };
    char plain[20], recorded[20];
    run_ok( "run cloth.yaml" );
    read_hash( plain );
    for ( int i = 0; i < WISP_COUNT( files ); ++i )
    {
        char command[100];
        snprintf( command, sizeof( command ), "run cloth.yaml --record %s", files[i] );
        run_ok( command );
        read_hash( recorded );
        assert_string_equal( recorded, plain );
        const char* named = i == 1 ? "h_cloth.pc2, h_ball.pc2: 7" : i == 3 ? "h_0001.obj to h_0007.obj: 7" : files[i];
        assert_non_null( strstr( result.out, named ) );
    }
    assert_true( has_array( "h/cloth_0007.vtp", "Normals" ) );
    assert_false( has_array( "h/cloth_0007.vtp", "strain" ) );
    assert_false( exists( "h/ball_0002.vtp" ) );
    assert_true( has_array( "h/ball_0001.vtp", "Normals" ) );
}

TEST( values_that_are_asked_for_are_computed_and_move_no_vertex )
{
    run_ok( "run cloth.yaml --record plain.usda" );
    run_ok( "run cloth.yaml --record with.usda --record-with strain,speed" );
    run_ok( "run cloth.yaml --record plain.pvd" );
    run_ok( "run cloth.yaml --record with.pvd --record-with speed" );
    assert_true( has_array( "with/cloth_0007.vtp", "speed" ) );
    assert_false( has_array( "with/cloth_0007.vtp", "strain" ) );
    size_t size;
    char *plain = read_bytes( "plain/cloth_0007.vtp", &size ), *with = read_bytes( "with/cloth_0007.vtp", &size );
    const char *points = strstr( plain, "<Points>" ), *same = strstr( with, "<Points>" );
    assert_true( points && same );
    assert_string_equal( points, same );
    free( plain );
    free( with );
    SCOPED( free_local ) char* text = read_bytes( "with.usda", &size );
    assert_non_null( strstr( text, "primvars:strain.timeSamples" ) );
    assert_non_null( strstr( text, "primvars:speed.timeSamples" ) );
}

TEST( what_the_scene_computes_is_recorded_without_asking )
{
    char scene[1200];
    const char* at = strstr( cloth_scene, "    cloth: {}\n" );
    assert_non_null( at );
    snprintf( scene, sizeof( scene ), "%.*s    compute: [points, strain]\n%s", (int)( at - cloth_scene ), cloth_scene,
              at );
    write_text( "strained.yaml", scene );
    run_ok( "run strained.yaml --record strained.pvd" );
    assert_true( has_array( "strained/cloth_0007.vtp", "strain" ) );
    assert_false( has_array( "strained/cloth_0007.vtp", "speed" ) );
}

TEST( hair_is_recorded_with_the_widths_and_colours_of_its_appearance )
{
    run_ok( "run hair.yaml --record dressed.pvd" );
    assert_true( has_array( "dressed/hair_0001.vtp", "width" ) );
    assert_true( has_array( "dressed/hair_0001.vtp", "RGB" ) );
}

TEST( a_value_that_cannot_be_recorded_is_refused )
{
    assert_refused( "run hair.yaml --record r.pvd --record-with strain", "hair.yaml has no body with strain" );
    assert_false( exists( "r.pvd" ) );
    run( "run cloth.yaml --record r.glb --record-with strain" );
    assert_int_equal( result.status, 64 );
    assert_non_null(
        strstr( result.err, "--record-with: expected together with --record and a file that ends in .pvd" ) );
    run( "run cloth.yaml --record r.pvd --record-with strain,mass" );
    assert_int_equal( result.status, 64 );
    assert_non_null( strstr( result.err, "--record-with: got 'strain,mass', expected strain, speed or both" ) );
    run( "run cloth.yaml --record r.pvd --record-with strain --verify fly.wisp" );
    assert_int_equal( result.status, 64 );
    assert_refused( "run cloth.yaml --record r.glb --steps 1001", "r.glb: got 1002 frames, expected at most 1000" );
    assert_false( exists( "r.glb" ) );
}

TEST( a_recording_has_the_start_and_every_nth_step_with_hashes )
{
    run_ok( "run hair.yaml --steps 7 --every 3 --record nth.wisp" );
    wisp_error error = { 0 };
    wisp_recording* recording;
    assert_int_equal( wisp_recording_open( "nth.wisp", &recording, &error ), WISP_OK );
    wisp_recording_info info = wisp_recording_describe( recording );
    assert_int_equal( info.frame_count, 3 );
    assert_true( info.complete );
    assert_string_equal( wisp_recording_body( recording, 0 )->name, "hair" );
    assert_int_equal( wisp_recording_body( recording, 0 )->strand_count, 40 );
    for ( int f = 0; f < 3; ++f )
    {
        double time;
        uint64_t hash;
        assert_int_equal( wisp_recording_frame( recording, f, NULL, &time, &hash, &error ), WISP_OK );
        // a step is a float of 1/60 s
        assert_true( fabs( time - 3.0 * f / 60.0 ) < 1e-7 * ( f + 1 ) );
        assert_true( hash != 0 );
    }
    wisp_recording_close( recording );
}

// ---- frames between steps ----

enum
{
    GHOST_STEPS = 12,
    GUIDE_POINTS = 3 * 8,
    GHOST_POINTS = 4 * GUIDE_POINTS,
};

static const char ghost_scene[] =
    "wisp: 1\nsteps: 12\nsubsteps: 4\nstrands:\n"
    "  - name: guides\n    generate: { strands: 3, vertices: 8, length: 0.2, seed: 3 }\n    dynamics: {}\n"
    "    head: { keyframes: [ { time: 0.08, position: [0.03, 0, 0] }, { time: 0.2, position: [0, 0, 0] } ] }\n"
    "  - name: ghosts\n    scatter: { around: guides, count: 4, radius: 0.008 }\n    ghosts: {}\n";

typedef struct ghost_frames
{
    int per_step;
    wisp_vec3 guides[32 * GHOST_STEPS + 1][GUIDE_POINTS], ghosts[32 * GHOST_STEPS + 1][GHOST_POINTS];
} ghost_frames;

static void record_ghosts( const char* options, int per_step, ghost_frames* out )
{
    char command[100];
    snprintf( command, sizeof( command ), "run ghosts.yaml --record ghosts.wisp %s", options );
    run_ok( command );
    wisp_error error = { 0 };
    wisp_recording* recording;
    assert_int_equal( wisp_recording_open( "ghosts.wisp", &recording, &error ), WISP_OK );
    const wisp_recording_info info = wisp_recording_describe( recording );
    assert_int_equal( info.frame_count, GHOST_STEPS * per_step + 1 );
    assert_true( fabs( info.dt * per_step - 1.0 / 60.0 ) < 1e-7 );
    out->per_step = per_step;
    for ( int f = 0; f < info.frame_count; ++f )
    {
        double time;
        uint64_t hash;
        wisp_vec3* all[] = { out->guides[f], out->ghosts[f] };
        assert_int_equal( wisp_recording_frame( recording, f, all, &time, &hash, &error ), WISP_OK );
        assert_true( fabs( time - f / ( 60.0 * per_step ) ) < 1e-6 );
        assert_true( ( hash != 0 ) == ( f % per_step == 0 ) ); // no world was in a state between steps
    }
    wisp_recording_close( recording );
}

static double change_of_way( wisp_vec3 a, wisp_vec3 b, wisp_vec3 c )
{
    const double x = (double)( c.x - b.x ) - (double)( b.x - a.x ), y = (double)( c.y - b.y ) - (double)( b.y - a.y );
    const double z = (double)( c.z - b.z ) - (double)( b.z - a.z );
    return sqrt( x * x + y * y + z * z );
}

// Largest change of velocity from the frame before a step to the frame after it, m per step.
static double corner( const ghost_frames* r, bool of_ghosts )
{
    const int points = of_ghosts ? GHOST_POINTS : GUIDE_POINTS;
    double largest = 0.0;
    for ( int n = 2 * points; n < GHOST_STEPS * points; ++n )
    {
        const int f = n / points * r->per_step;
        const wisp_vec3* all[3];
        for ( int k = 0; k < 3; ++k )
        {
            all[k] = of_ghosts ? r->ghosts[f + k - 1] : r->guides[f + k - 1];
        }
        const int v = n % points;
        largest = fmax( largest, r->per_step * change_of_way( all[0][v], all[1][v], all[2][v] ) );
    }
    return largest;
}

// Once continuously differentiable: the change of velocity at a step falls with the distance of frames. On straight lines, which the
// other points move along, it stays.
TEST( frames_between_steps_pass_through_the_steps_and_ghosts_turn_no_corner_there )
{
    static ghost_frames plain, some, many;
    write_text( "ghosts.yaml", ghost_scene );
    record_ghosts( "", 1, &plain );
    record_ghosts( "--frames-per-step 16", 16, &some );
    record_ghosts( "--frames-per-step 32", 32, &many );
    for ( int step = 0; step <= GHOST_STEPS; ++step )
    {
        assert_memory_equal( some.ghosts[16 * step], plain.ghosts[step], sizeof( plain.ghosts[0] ) );
        assert_memory_equal( some.guides[16 * step], plain.guides[step], sizeof( plain.guides[0] ) );
    }
    assert_true( corner( &some, true ) > 1e-4 );
    assert_true( corner( &many, true ) < 0.6 * corner( &some, true ) );
    assert_true( corner( &many, false ) > 0.95 * corner( &some, false ) );
    assert_true( corner( &many, true ) < 0.2 * corner( &many, false ) );
}

TEST( a_scene_has_frames_between_steps_and_an_option_has_the_last_word )
{
    static ghost_frames asked, written;
    char scene[1200];
    write_text( "ghosts.yaml", ghost_scene );
    record_ghosts( "--frames-per-step 4", 4, &asked );
    snprintf( scene, sizeof( scene ), "wisp: 1\nframes_per_step: 4\n%s", strchr( ghost_scene, '\n' ) + 1 );
    write_text( "ghosts.yaml", scene );
    record_ghosts( "", 4, &written );
    assert_memory_equal( asked.ghosts, written.ghosts, sizeof( asked.ghosts[0] ) * ( 4 * GHOST_STEPS + 1 ) );
    record_ghosts( "--frames-per-step 1", 1, &written );
}

TEST( tracks_are_the_points_of_the_recording )
{
    run_ok( "run hair.yaml --record t.wisp --track hair:19,0 --track hair:7 --track-file t.csv" );
    assert_non_null( strstr( result.out, "t.csv: 3 vertices over 4 frames" ) );
    FILE* table = fopen( "t.csv", "r" );
    assert_non_null( table );
    char line[400];
    assert_non_null( fgets( line, sizeof( line ), table ) );
    assert_memory_equal( line, "time,hair.19.x,hair.19.y,hair.19.z,hair.0.x", 43 );

    wisp_error error = { 0 };
    wisp_recording* recording;
    wisp_vec3 points[800];
    wisp_vec3* all[] = { points };
    assert_int_equal( wisp_recording_open( "t.wisp", &recording, &error ), WISP_OK );
    assert_int_equal( wisp_recording_body( recording, 0 )->vertex_count, 800 );
    for ( int f = 0; f < 4; ++f )
    {
        float x, y, z;
        assert_int_equal( wisp_recording_frame( recording, f, all, NULL, NULL, &error ), WISP_OK );
        assert_non_null( fgets( line, sizeof( line ), table ) );
        assert_int_equal( sscanf( line, "%*f,%f,%f,%f", &x, &y, &z ), 3 );
        // nine digits restore every float
        assert_true( x == points[19].x && y == points[19].y && z == points[19].z );
    }
    assert_null( fgets( line, sizeof( line ), table ) );
    fclose( table );
    wisp_recording_close( recording );
}

// ---- verification ----

TEST( a_run_verifies_its_recording_on_other_workers )
{
    run_ok( "run hair.yaml --record proof.wisp --workers 1" );
    run_ok( "run hair.yaml --verify proof.wisp --workers 3 --isa baseline" );
    assert_non_null( strstr( result.out, "proof.wisp: 4 frames, every bit equal" ) );
    run_ok( "run hair.yaml --verify proof.wisp --steps 2" );
    assert_non_null( strstr( result.out, "proof.wisp: 3 frames, every bit equal" ) );
    assert_non_null( strstr( result.out, "proof.wisp: 1 frames after the last step" ) );
}

TEST( a_recording_that_is_cut_or_of_another_length_proves_nothing )
{
    run_ok( "run hair.yaml --record proof.wisp" );
    run_ok( "run hair.yaml --record short.wisp --steps 2" );
    assert_refused( "run hair.yaml --verify short.wisp", "short.wisp: got 3 frames, expected 4" );
    run_ok( "run hair.yaml --verify short.wisp --steps 2" );
    assert_refused( "run hair.yaml --verify proof.wisp --steps 4", "proof.wisp: got 4 frames, expected 5" );
    size_t size;
    char* bytes = read_bytes( "proof.wisp", &size );
    FILE* cut = fopen( "cut.wisp", "wb" );
    assert_int_equal( fwrite( bytes, 1, size - 100, cut ), size - 100 );
    fclose( cut );
    free( bytes );
    assert_refused( "run hair.yaml --verify cut.wisp", "cut.wisp: the recording is cut" );
}

/// A copy in which one number of one vertex in one frame is the next float.
static void copy_with_one_bit_off( const char* from, const char* to )
{
    wisp_error error = { 0 };
    wisp_recording* recording;
    assert_int_equal( wisp_recording_open( from, &recording, &error ), WISP_OK );
    wisp_recording_info info = wisp_recording_describe( recording );
    const wisp_recorder_def def = { .bodies = wisp_recording_body( recording, 0 ),
                                    .body_count = info.body_count,
                                    .dt = info.dt };
    wisp_recorder* recorder;
    assert_int_equal( wisp_recorder_open( to, WISP_RECORD_WISP, &def, &recorder, &error ), WISP_OK );
    for ( int f = 0; f < info.frame_count; ++f )
    {
        wisp_vec3 points[800];
        wisp_vec3* all[] = { points };
        double time;
        uint64_t hash;
        assert_int_equal( wisp_recording_frame( recording, f, all, &time, &hash, &error ), WISP_OK );
        if ( f == 2 )
        {
            points[123].y = nextafterf( points[123].y, 9.0f );
        }
        const wisp_vec3* changed[] = { points };
        assert_int_equal( wisp_recorder_frame( recorder, time, hash, changed, &error ), WISP_OK );
    }
    assert_int_equal( wisp_recorder_close( recorder, &error ), WISP_OK );
    wisp_recording_close( recording );
}

TEST( a_difference_of_one_bit_is_named_by_frame_body_and_vertex )
{
    run_ok( "run hair.yaml --record proof.wisp" );
    copy_with_one_bit_off( "proof.wisp", "off.wisp" );
    assert_refused( "run hair.yaml --verify off.wisp", "off.wisp: frame 2 " );
    assert_non_null( strstr( result.err, "hair differs at vertex 123: " ) );
    assert_string_equal( result.out, "" );
}

TEST( a_recording_of_something_else_is_not_compared )
{
    assert_refused( "run hair.yaml --verify fly.wisp", "body 0 differs in its name" );
    assert_refused( "run hair.yaml --verify absent.wisp", "absent.wisp" );
    assert_refused( "run hair.yaml --verify sheet.obj", "sheet.obj" );
}

// ---- info ----

TEST( info_names_what_is_wrong_with_a_mesh_by_element )
{
    run_ok( "info sheet.obj" );
    assert_non_null( strstr( result.out, "triangles            32" ) );
    assert_non_null( strstr( result.out, "open edges" ) );
    write_text( "turned.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n" );
    run_ok( "info turned.obj" );
    assert_non_null( strstr( result.out, "winding" ) );
    write_text( "broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n" );
    assert_refused( "info broken.obj", "broken.obj" );
    assert_string_equal( result.out, "" );
}

TEST( info_tells_whether_a_recording_is_whole )
{
    run_ok( "info fly.wisp" );
    assert_non_null( strstr( result.out, "6 frames" ) );
    run_ok( "info fly.pc2" );

    size_t size;
    char* bytes = read_bytes( "fly.wisp", &size );
    assert_true( size > 1000 );
    bytes[size - 200] ^= 1;
    write_bytes( "damaged.wisp", bytes, size );
    free( bytes );
    assert_refused( "info damaged.wisp", "frame 5" );
    assert_refused( "render damaged.wisp -o damaged.png", "frame 5" );
    assert_false( exists( "damaged.png" ) );
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
