// What the program records, tracks and verifies, read back by the library; what it says of recordings is in transcripts/record.t.
#include "flying_sheet.h"

// ---- recordings of a run ----

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

// ---- info ----

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
