// The built program, whose path is the first argument, draws: pictures are read back by libpng, and every invalid
// argument and file gives one message.
#include "flying_sheet.h"
#include "png_fixture.h"

#include <sys/stat.h>

// ---- pictures, read back ----

static const unsigned char* pixel( const picture* p, int x, int y )
{
    return p->rgb + 3 * ( (size_t)y * (size_t)p->width + (size_t)x );
}

static bool is_like_corner( const picture* p, int x, int y )
{
    return memcmp( pixel( p, x, y ), pixel( p, 0, 0 ), 3 ) == 0;
}

static int count_unlike_corner( const picture* p )
{
    int count = 0;
    for ( int y = 0; y < p->height; ++y )
    {
        for ( int x = 0; x < p->width; ++x )
        {
            count += !is_like_corner( p, x, y );
        }
    }
    return count;
}

static bool is_edge_empty( const picture* p )
{
    bool is_empty = true;
    for ( int x = 0; x < p->width; ++x )
    {
        is_empty = is_empty && is_like_corner( p, x, 0 ) && is_like_corner( p, x, p->height - 1 );
    }
    for ( int y = 0; y < p->height; ++y )
    {
        is_empty = is_empty && is_like_corner( p, 0, y ) && is_like_corner( p, p->width - 1, y );
    }
    return is_empty;
}

/// The last run must have succeeded, and the picture have this size.
static picture assert_picture( const char* path, int width, int height )
{
    if ( result.status != 0 )
    {
        fail_msg( "it ended with %d and said: %s", result.status, result.err );
    }
    assert_string_equal( result.err, "" );
    picture p = read_picture( path );
    assert_int_equal( p.width, width );
    assert_int_equal( p.height, height );
    return p;
}

static bool same_file( const char* a, const char* b )
{
    picture p = read_picture( a ), q = read_picture( b );
    bool same = p.width == q.width && p.height == q.height &&
                memcmp( p.rgb, q.rgb, 3 * (size_t)p.width * (size_t)p.height ) == 0;
    free( p.rgb );
    free( q.rgb );
    return same;
}

// ---- pictures ----

TEST( every_kind_of_input_becomes_a_picture_of_the_size_queried_for )
{
    static const char* const inputs[] = {
        "hair.yaml", "fly.wisp", "fly.pc2 --mesh sheet.obj", "sheet.obj", "hair.hair",
    };
    run_ok( "run hair.yaml --steps 1" );
    char scene[1024];
    snprintf( scene, sizeof( scene ), "%soutput:\n  - { strands: hair, file: hair.hair }\n", hair_scene );
    write_text( "hair_out.yaml", scene );
    run_ok( "run hair_out.yaml" );
    for ( int i = 0; i < WISP_COUNT( inputs ); ++i )
    {
        char command[200];
        snprintf( command, sizeof( command ), "render %s -o kind.png --size 96x64 --samples 1", inputs[i] );
        remove( "kind.png" );
        run( command );
        picture p = assert_picture( "kind.png", 96, 64 );
        assert_true( count_unlike_corner( &p ) > 96 );
        assert_non_null( strstr( result.out, "kind.png: 96 x 64 pixels" ) );
        free( p.rgb );
    }
}

TEST( frames_and_times_name_the_same_pictures )
{
    run( "render fly.wisp -o frame.png --size 64x48 --samples 1 --frame 2" );
    free( assert_picture( "frame.png", 64, 48 ).rgb );
    // nearest to a time: a little before and a little after frame 2 at 0.2 s
    run( "render fly.wisp -o before.png --size 64x48 --samples 1 --time 0.17" );
    run( "render fly.wisp -o after.png --size 64x48 --samples 1 --time 0.24" );
    assert_true( same_file( "frame.png", "before.png" ) );
    assert_true( same_file( "frame.png", "after.png" ) );
    run( "render fly.wisp -o last.png --size 64x48 --samples 1" );
    run( "render fly.wisp -o five.png --size 64x48 --samples 1 --frame 5" );
    assert_true( same_file( "last.png", "five.png" ) );
    assert_false( same_file( "last.png", "frame.png" ) );
}

TEST( a_scene_that_is_drawn_gives_the_pictures_of_its_recording )
{
    run_ok( "run hair.yaml --record drawn.wisp" );
    // a recording has neither widths nor colours, which the scene has: only occupied pixels can be equal
    run_ok( "render drawn.wisp -o recorded.png --size 64x48 --samples 1 --frames 0:3 --background white" );
    run_ok( "render hair.yaml -o drawn.png --size 64x48 --samples 1 --frames 0:3 --background white" );
    for ( int i = 1; i <= 4; ++i )
    {
        char a[40], b[40];
        snprintf( a, sizeof( a ), "recorded_%04d.png", i );
        snprintf( b, sizeof( b ), "drawn_%04d.png", i );
        picture p = read_picture( a ), q = read_picture( b );
        for ( int y = 0; y < p.height; ++y )
        {
            for ( int x = 0; x < p.width; ++x )
            {
                assert_int_equal( is_like_corner( &p, x, y ), is_like_corner( &q, x, y ) );
            }
        }
        free( p.rgb );
        free( q.rgb );
    }
}

// A recording has neither materials nor planes: both are derived.
TEST( cloth_and_collider_look_alike_in_a_scene_and_in_its_recording )
{
    run_ok( "run cloth.yaml --record cloth.wisp" );
    run( "info cloth.wisp" );
    assert_non_null( strstr( result.out, "cloth " ) );
    assert_non_null( strstr( result.out, "ball " ) );
    assert_null( strstr( result.out, "floor" ) );
    run( "render cloth.yaml -o from_scene.png --size 80x60 --samples 1" );
    free( assert_picture( "from_scene.png", 80, 60 ).rgb );
    run( "render cloth.wisp -o from_file.png --size 80x60 --samples 1 --ground 0" );
    free( assert_picture( "from_file.png", 80, 60 ).rgb );
    assert_true( same_file( "from_scene.png", "from_file.png" ) );
    run_ok( "run cloth.yaml --verify cloth.wisp --workers 3" );
    assert_non_null( strstr( result.out, ": 7 frames, every bit equal" ) );
}

// Nor does a small sheet far away make the other one a speck.
TEST( a_ceiling_does_not_hide_what_is_below_it )
{
    static const char sheets[] = "wisp: 1\nsteps: 1\nsurfaces:\n"
                                 "  - { name: sheet, generate: { shape: plane, columns: 9, rows: 9 }, cloth: {} }\n"
                                 "%s";
    static const char* const more[] = {
        "",
        "colliders: [{ name: ceiling, shape: plane, position: [0, 1, 0], rotation: { axis: [1, 0, 0], degrees: 180 } "
        "}]\n",
        "  - { name: scrap, generate: { shape: plane, columns: 2, rows: 2 }, transform: { translate: [9, -99, 0] }, "
        "cloth: {} }\n",
    };
    for ( int i = 0; i < WISP_COUNT( more ); ++i )
    {
        char text[800], command[160];
        snprintf( text, sizeof text, sheets, more[i] );
        write_text( "sheets.yaml", text );
        snprintf( command, sizeof command,
                  "render sheets.yaml -o sheets%d.png --steps 2 --size 64x48 --samples 1 --from 32,50 --ground none",
                  i );
        run( command );
        result.err[0] = '\0'; // a ceiling that nothing collides with is told
        picture p = assert_picture( i == 0 ? "sheets0.png" : i == 1 ? "sheets1.png" : "sheets2.png", 64, 48 );
        assert_true( count_unlike_corner( &p ) > 64 * 48 / 8 );
        free( p.rgb );
    }
    assert_true( same_file( "sheets0.png", "sheets1.png" ) );
    run_ok( "render sheets.yaml -o longer.png --steps 9 --size 64x48 --samples 1 --from 32,50 --ground none" );
    assert_non_null( strstr( result.out, "frame 9 of sheets.yaml" ) );
    assert_refused( "render fly.wisp -o longer.png --steps 9", "--steps expects a scene" );
}

TEST( a_scene_shows_strain_and_speed_of_its_surfaces )
{
    run_ok( "render cloth.yaml -o body.png --size 80x60 --samples 1 --frames 0:6:3" );
    run_ok( "render cloth.yaml -o pace.png --size 80x60 --samples 1 --frames 0:6:3 --colour speed" );
    run_ok( "render cloth.yaml -o pull.png --size 80x60 --samples 1 --frames 0:6:3 --colour strain" );
    assert_false( same_file( "body_0003.png", "pace_0003.png" ) );
    assert_false( same_file( "body_0003.png", "pull_0003.png" ) );
    assert_false( same_file( "pace_0003.png", "pull_0003.png" ) );
}

TEST( a_scene_shows_the_map_of_a_surface )
{
    write_text( "weights.txt", "1 2 3 1 2 3 1 2 3" );
    write_text( "map.yaml", "wisp: 1\n"
                            "surfaces:\n"
                            "  - name: sheet\n"
                            "    generate: { shape: plane, columns: 3, rows: 3 }\n"
                            "    area_density: { map: weights.txt }\n"
                            "    pins: [0, 2]\n"
                            "    cloth: {}\n" );
    run( "render map.yaml -o plain.png --size 80x60 --samples 1 --frame 0" );
    free( assert_picture( "plain.png", 80, 60 ).rgb );
    run( "render map.yaml -o map.png --size 80x60 --samples 1 --frame 0 --colour map" );
    free( assert_picture( "map.png", 80, 60 ).rgb );
    run( "render map.yaml -o wide.png --size 80x60 --samples 1 --frame 0 --colour map --range 0,30" );
    free( assert_picture( "wide.png", 80, 60 ).rgb );
    assert_false( same_file( "plain.png", "map.png" ) );
    assert_false( same_file( "wide.png", "map.png" ) );
    write_text( "weights.txt", "3 2 1 3 2 1 3 2 1" ); // mirrored
    run( "render map.yaml -o mirrored.png --size 80x60 --samples 1 --frame 0 --colour map" );
    free( assert_picture( "mirrored.png", 80, 60 ).rgb );
    assert_false( same_file( "mirrored.png", "map.png" ) );
    char weights[400] = "9"; // the scale reaches single vertices
    for ( int v = 1; v < 36; ++v )
    {
        strcat( weights, " 0.1" );
    }
    write_text( "weights.txt", weights );
    write_text( "spot.yaml", "wisp: 1\n"
                             "surfaces:\n"
                             "  - name: sheet\n"
                             "    generate: { shape: plane, columns: 6, rows: 6 }\n"
                             "    area_density: { map: weights.txt }\n"
                             "    cloth: {}\n" );
    run( "render spot.yaml -o spot.png --size 80x60 --samples 1 --frame 0 --colour map" );
    free( assert_picture( "spot.png", 80, 60 ).rgb );
    run( "render spot.yaml -o whole.png --size 80x60 --samples 1 --frame 0 --colour map --range 0,9" );
    assert_true( same_file( "spot.png", "whole.png" ) );
}

TEST( a_sequence_is_numbered_from_one )
{
    run_ok( "render fly.wisp -o run.png --size 40x30 --samples 1 --frames 0:4:2" );
    assert_non_null( strstr( result.out, "run_0001.png: the first of 3 pictures of 40 x 30 pixels, frames 0 to 4" ) );
    assert_true( exists( "run_0001.png" ) && exists( "run_0003.png" ) );
    assert_false( exists( "run_0004.png" ) || exists( "run.png" ) );
}

TEST( parts_of_a_range_of_frames_may_be_left_out )
{
    run( "render fly.wisp -o tail.png --size 40x30 --samples 1 --frames 4:" );
    assert_true( exists( "tail_0002.png" ) && !exists( "tail_0003.png" ) );
    run( "render fly.wisp -o all.png --size 40x30 --samples 1 --frames ::3" );
    assert_true( exists( "all_0002.png" ) && !exists( "all_0003.png" ) );
    assert_int_equal( result.status, 0 );
}

// How many pixels are unlike the background, and the middle of them from left to right.
static int measure_body( const char* name, int number, double* middle )
{
    char path[40];
    snprintf( path, sizeof( path ), "%s_%04d.png", name, number );
    picture p = read_picture( path );
    assert_true( is_edge_empty( &p ) );
    int count = 0;
    *middle = 0.0;
    for ( int k = 0; k < p.width * p.height; ++k )
    {
        if ( !is_like_corner( &p, k % p.width, k / p.width ) )
        {
            *middle += k % p.width;
            ++count;
        }
    }
    *middle /= count > 0 ? count : 1;
    free( p.rgb );
    return count;
}

TEST( a_body_that_moves_is_seen_by_a_camera_that_stands_still )
{
    run_ok( "render fly.wisp -o still.png --size 160x90 --samples 1 --frames 0:2 --background white --ground none" );
    double first, last;
    assert_true( measure_body( "still", 1, &first ) > 50 );
    assert_true( measure_body( "still", 3, &last ) > 50 );
    assert_true( last > first + 60.0 );
}

// A body that travels several times its size would be a speck.
TEST( the_camera_goes_along_with_a_body_that_travels_far )
{
    run_ok( "render fly.wisp -o along.png --size 160x90 --samples 1 --frames : --background white --ground none" );
    for ( int f = 0; f < FRAMES; ++f )
    {
        double middle;
        const int count = measure_body( "along", f + 1, &middle );
        // the last one is the largest and fills the picture; the first is 1 / 2.25 as large
        assert_true( count > ( f == FRAMES - 1 ? 160 * 90 / 5 : 160 * 90 / 40 ) );
        assert_true( fabs( middle - 79.5 ) < 4.0 );
    }
}

TEST( a_sheet_has_its_pictures_in_columns )
{
    run_ok( "render fly.wisp -o sheet.png --size 60x40 --samples 1 --frames 0:4 --sheet=3" );
    assert_non_null( strstr( result.out, "sheet.png: 5 pictures of 60 x 40 pixels, frames 0 to 4" ) );
    picture p = read_picture( "sheet.png" );
    // three columns and two rows, with gaps and labels between them that are narrower than a picture
    assert_true( p.width > 3 * 60 && p.width < 4 * 60 );
    assert_true( p.height > 2 * 40 && p.height < 3 * 40 );
    free( p.rgb );
    assert_false( exists( "sheet_0001.png" ) );
}

TEST( a_sheet_without_frames_shows_all_of_a_short_recording )
{
    run_ok( "render fly.wisp -o few.png --size 40x30 --samples 1 --sheet" );
    assert_non_null( strstr( result.out, "6 pictures of 40 x 30 pixels, frames 0 to 5" ) );
}

TEST( a_turntable_shows_other_sides_and_keeps_the_body_in_view )
{
    run_ok( "render sheet.obj -o turn.png --size 80x60 --samples 1 --turntable 4 --background white --ground none" );
    for ( int i = 1; i <= 4; ++i )
    {
        char path[40];
        snprintf( path, sizeof( path ), "turn_%04d.png", i );
        picture p = read_picture( path );
        assert_true( is_edge_empty( &p ) );
        assert_true( count_unlike_corner( &p ) > 10 );
        free( p.rgb );
    }
    assert_false( same_file( "turn_0001.png", "turn_0002.png" ) );
    assert_false( exists( "turn_0005.png" ) );
}

// ---- content of pictures ----

/// Mean colour of what is not background. @return how much greener than blue
static double green_over_blue( const char* path )
{
    picture p = read_picture( path );
    double sum = 0.0;
    int count = 0;
    for ( int y = 0; y < p.height; ++y )
    {
        // Below is the legend.
        for ( int x = 0; x < p.width && y < p.height / 2; ++x )
        {
            const unsigned char* c = pixel( &p, x, y );
            sum += is_like_corner( &p, x, y ) ? 0.0 : (double)c[1] - (double)c[2];
            count += !is_like_corner( &p, x, y );
        }
    }
    free( p.rgb );
    assert_true( count > 0 );
    return sum / count;
}

TEST( strain_is_measured_from_the_first_frame )
{
    run_ok(
        "render stay.wisp -o rest.png --size 120x90 --samples 1 --frame 0 --colour strain --range 0,1 --background "
        "white --ground none" );
    run_ok(
        "render stay.wisp -o wide.png --size 120x90 --samples 1 --frame 4 --colour strain --range 0,1 --background "
        "white --ground none" );
    // from dark violet at no strain to yellow at a strain of 1, which frame 4 has
    assert_true( green_over_blue( "rest.png" ) < -10.0 );
    assert_true( green_over_blue( "wide.png" ) > 40.0 );
}

TEST( speed_is_measured_between_neighbouring_frames )
{
    run_ok(
        "render fly.wisp -o slow.png --size 120x90 --samples 1 --frame 2 --color speed --range 10,1000 --background "
        "white --ground none" );
    run_ok( "render fly.wisp -o fast.png --size 120x90 --samples 1 --frame 2 --colour speed --range 0,9 --background "
            "white --ground none" );
    // the sheet flies with 10 m/s and is stretched with at most 2.5 m/s
    assert_true( green_over_blue( "slow.png" ) < -10.0 );
    assert_true( green_over_blue( "fast.png" ) > 40.0 );
}

TEST( the_user_places_camera_ground_and_background )
{
    assert_refused( "render sheet.obj -o away.png --size 40x30 --samples 1 --camera 0,0,5,0,0,10",
                    "the picture is empty" );
    assert_int_equal( access( "away.png", F_OK ), -1 );
    run( "render sheet.obj -o far.png --size 40x30 --samples 1 --camera 0,0,15,0,0,0 --background #204060 --ground "
         "none" );
    picture p = assert_picture( "far.png", 40, 30 );
    assert_true( pixel( &p, 0, 0 )[2] > pixel( &p, 0, 0 )[1] && pixel( &p, 0, 0 )[1] > pixel( &p, 0, 0 )[0] );
    free( p.rgb );
    run( "render sheet.obj -o near.png --size 40x30 --samples 1 --camera 0,0.2,3,0,0.2,0 --fov 20 --background "
         "#ffffff,#000000 --ground -1" );
    p = assert_picture( "near.png", 40, 30 );
    assert_false( is_like_corner( &p, 20, 15 ) );
    free( p.rgb );
}

// ---- invalid files ----

TEST( input_that_cannot_be_drawn_is_refused_in_one_message )
{
    static const char* const commands[][2] = {
        { "render other.txt -o b.png", "unknown kind of file, expected a scene" },
        { "render fly.wisp -o b.png --frame 6", "got frame 6, expected 0 to 5" },
        { "render fly.wisp -o b.png --frames 0:9", "got frame 9, expected 0 to 5" },
        { "render fly.wisp -o b.png --frames 7:", "got frame 7" },
        { "render hair.yaml -o b.png --frame 4", "got frame 4, expected 0 to 3" },
        { "render fly.wisp -o b.png --time 9", "no frame at 9 s" },
        { "render fly.pc2 -o b.png", "--mesh" },
        { "render fly.pc2 -o b.png --mesh absent.obj", "absent.obj" },
        { "render fly.pc2 -o b.png --mesh triangle.obj", "got 3 vertices, but fly.pc2 has 25 points" },
        { "render fly.pc2 -o b.png --mesh sheet.obj --time 1", "no times" },
        { "render fly.wisp -o b.png --mesh sheet.obj", "--mesh" },
        { "render sheet.obj -o b.png --colour strain", "no strain and no speed" },
        { "render hair.yaml -o b.png --colour strain", "only surfaces" },
        { "render cloth.yaml -o b.png --colour map", "no surface has a map" },
        { "render fly.wisp -o b.png --colour map", "only surfaces of scenes have maps" },
        { "render sheet.obj -o b.png --colour map", "only surfaces of scenes have maps" },
        { "render sheet.obj -o b.png --camera 0,0,1,0,0,1", "sheet.obj" },
        { "render fly.wisp -o b.png --size 16000x16000 --sheet", "too large for one sheet" },
    };
    for ( int i = 0; i < WISP_COUNT( commands ); ++i )
    {
        assert_refused( commands[i][0], commands[i][1] );
        assert_string_equal( result.out, "" );
    }
    assert_false( exists( "b.png" ) );
}

TEST( output_that_cannot_be_written_is_refused_in_one_message )
{
    assert_int_equal( mkdir( "folder.png", 0700 ), 0 );
    assert_refused( "render sheet.obj -o no/such/c.png --size 20x20", "no/such/c.png" );
    assert_refused( "render sheet.obj -o folder.png --size 20x20 --samples 1", "folder.png" );
    assert_refused( "run hair.yaml --record no/such/c.wisp", "no/such/c.wisp" );
    assert_refused( "run hair.yaml --record c.mpg", "c.mpg" );
    assert_refused( "run hair.yaml --track hair:0 --track-file no/such/c.csv", "no/such/c.csv" );
    assert_refused( "run hair.yaml --track hiar:0 --track-file c.csv", "did you mean 'hair'?" );
    assert_refused( "run hair.yaml --track hair:800 --track-file c.csv", "got vertex 800, expected 0 to 799" );
    assert_false( exists( "c.csv" ) );
}

// ---- terminals ----

TEST( progress_is_drawn_on_a_terminal_and_wiped_out_again )
{
    static const char* const commands[] = { "run hair.yaml",
                                            "render fly.wisp -o bar.png --size 40x30 --samples 1 --frames 0:2" };
    setenv( "TERM", "xterm", 1 );
    for ( int i = 0; i < WISP_COUNT( commands ); ++i )
    {
        run_on_terminal( commands[i] );
        assert_int_equal( result.status, 0 );
        // the first phase is always drawn; later ones only if a tenth of a second has passed
        assert_non_null( strstr( result.err, i == 0 ? "\033[32m" : " % frames" ) );
        assert_int_equal( result.err[strlen( result.err ) - 1], '\r' );
    }
}

TEST( no_color_takes_the_colour_away_and_leaves_the_bar )
{
    setenv( "TERM", "xterm", 1 );
    setenv( "NO_COLOR", "1", 1 );
    run_on_terminal( "run hair.yaml" );
    assert_int_equal( result.status, 0 );
    assert_null( strchr( result.err, '\033' ) );
    assert_non_null( strstr( result.err, "\r[" ) );
    setenv( "NO_COLOR", "", 1 );
    run_on_terminal( "run hair.yaml" );
    assert_non_null( strstr( result.err, "\033[32m" ) );
    unsetenv( "NO_COLOR" );
}

TEST( a_dumb_terminal_and_a_file_see_no_bar )
{
    setenv( "TERM", "dumb", 1 );
    run_on_terminal( "run hair.yaml" );
    assert_int_equal( result.status, 0 );
    assert_string_equal( result.err, "" );
    setenv( "TERM", "xterm", 1 );
    run( "render fly.wisp -o bar.png --size 40x30 --samples 1" );
    assert_string_equal( result.err, "" );
    run( "run hair.yaml" );
    assert_string_equal( result.err, "" );
    assert_null( strchr( result.out, '\033' ) );
}

// A terminal shows a mess, and may take it for commands.
TEST( a_picture_is_not_written_to_a_terminal )
{
    int near_end, far_end;
    if ( openpty( &near_end, &far_end, NULL, NULL, NULL ) != 0 )
    {
        SKIP( "there are no terminals here" );
    }
    FILE* err = tmpfile();
    const pid_t child = fork();
    if ( child == 0 )
    {
        char* arguments[] = { program, "render", "sheet.obj", "-o", "-", NULL };
        become_program( arguments, far_end, fileno( err ) );
    }
    result.status = wait_for( child );
    read_back( err, result.err );
    close( near_end );
    close( far_end );
    assert_int_equal( result.status, 64 );
    assert_non_null( strstr( result.err, "standard output is a terminal" ) );
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
