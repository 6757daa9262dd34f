// Grooms on disk: the format of a path, the file after a failed write, and the output of `wisp info`.
#include "groom_fixture.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

static void assert_file_is( const char* path, const char* text )
{
    size_t length = 0;
    char* found = read_bytes( path, &length );
    assert_int_equal( length, strlen( text ) );
    assert_string_equal( found, text );
    free( found );
}

// ---- reading and writing files ---------------------------------------------------------------------------------

TEST_IN_FOLDER( a_hair_file_on_disk_comes_back_bit_for_bit )
{
    wisp_groom groom = fixture_groom();
    wisp_groom again;
    assert_int_equal( wisp_groom_write( path_in( state, "a.HAIR" ), &groom, NULL ), WISP_OK );
    assert_int_equal( wisp_groom_read( path_in( state, "a.HAIR" ), &again, NULL ), WISP_OK );
    assert_same_groom( &groom, &again );
    wisp_groom_release( &again );
    assert_int_equal( count_files( state ), 1 );
}

TEST_IN_FOLDER( a_file_that_starts_with_HAIR_is_a_hair_file_whatever_it_is_called )
{
    wisp_groom groom = fixture_groom();
    wisp_groom again;
    size_t size = 0;
    char* bytes = fixture_written( wisp_groom_write_hair, &groom, &size );
    write_bytes( path_in( state, "a.bin" ), bytes, size );
    free( bytes );
    assert_int_equal( wisp_groom_read( path_in( state, "a.bin" ), &again, NULL ), WISP_OK );
    assert_same_groom( &groom, &again );
    wisp_groom_release( &again );
}

TEST_IN_FOLDER( a_large_groom_on_disk_comes_back_bit_for_bit )
{
    // More than the reader's first block of 64 KiB, and the extension in every text format.
    wisp_groom_generator generator = wisp_default_groom_generator( WISP_GROOM_CURLY, 3 );
    generator.strand_count = 500;
    wisp_groom groom, again;
    assert_int_equal( wisp_groom_generate( &generator, &groom, NULL ), WISP_OK );
    assert_int_equal( wisp_groom_write( path_in( state, "a.hair" ), &groom, NULL ), WISP_OK );
    assert_int_equal( wisp_groom_write( path_in( state, "a.usda" ), &groom, NULL ), WISP_OK );
    assert_int_equal( wisp_groom_write( path_in( state, "a.obj" ), &groom, NULL ), WISP_OK );
    assert_int_equal( wisp_groom_read( path_in( state, "a.hair" ), &again, NULL ), WISP_OK );
    assert_same_groom( &groom, &again );
    wisp_groom_release( &again );
    wisp_groom_release( &groom );
    assert_int_equal( count_files( state ), 3 );
}

TEST_IN_FOLDER( a_path_that_cannot_be_read_is_an_error_that_names_it )
{
    wisp_groom groom;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_groom_read( path_in( state, "none.hair" ), &groom, &error ), WISP_IO_ERROR );
    assert_contains( error.message, "none.hair: cannot open: " );
    assert_int_equal( wisp_groom_read( path_in( state, "." ), &groom, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "got a folder" );
    wisp_groom_release( &groom );
}

TEST_IN_FOLDER( an_unknown_extension_is_refused_before_anything_is_written )
{
    wisp_groom groom = fixture_groom();
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_groom_write( path_in( state, "a.abc" ), &groom, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "a.abc: expected a file that ends in .hair, .usda or .obj" );
    assert_int_equal( wisp_groom_write( path_in( state, "none/a.hair" ), &groom, &error ), WISP_IO_ERROR );
    assert_contains( error.message, "none/a.hair: cannot create a file beside it" );
    assert_int_equal( count_files( state ), 0 );
}

TEST_IN_FOLDER( a_groom_that_cannot_be_written_leaves_the_old_file )
{
    wisp_groom groom = fixture_curves();
    wisp_vec3 points[6];
    memcpy( points, groom.points, sizeof points );
    points[5].x = NAN;
    groom.points = points;
    static const char* const names[] = { "a.hair", "a.usda", "a.obj" };
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        char* path = path_in( state, names[i] );
        write_bytes( path, "precious", 8 );
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( wisp_groom_write( path, &groom, &error ), WISP_BAD_INPUT );
        assert_contains( error.message, names[i] );
        assert_contains( error.message, "strand 1, vertex 1: x is NaN" );
        assert_file_is( path, "precious" );
    }
    assert_int_equal( count_files( state ), 3 );
}

TEST_IN_FOLDER( a_disk_without_room_leaves_the_old_file )
{
    wisp_groom_generator generator = wisp_default_groom_generator( WISP_GROOM_WAVY, 3 );
    wisp_groom groom;
    assert_int_equal( wisp_groom_generate( &generator, &groom, NULL ), WISP_OK );
    char* path = path_in( state, "a.hair" );
    write_bytes( path, "precious", 8 );

    // Files may not grow beyond 8 KiB: the write fails in the middle, as on a full disk.
    struct rlimit before;
    assert_int_equal( getrlimit( RLIMIT_FSIZE, &before ), 0 );
    struct rlimit small = { 8192, before.rlim_max };
    void ( *old )( int ) = signal( SIGXFSZ, SIG_IGN );
    assert_int_equal( setrlimit( RLIMIT_FSIZE, &small ), 0 );
    wisp_error error = { .status = WISP_OK };
    wisp_status status = wisp_groom_write( path, &groom, &error );
    assert_int_equal( setrlimit( RLIMIT_FSIZE, &before ), 0 );
    signal( SIGXFSZ, old );

    assert_int_equal( status, WISP_IO_ERROR );
    assert_contains( error.message, "a.hair: cannot write" );
    assert_file_is( path, "precious" );
    assert_int_equal( count_files( state ), 1 );
    wisp_groom_release( &groom );
}

TEST_IN_FOLDER( a_device_is_written_in_place_and_survives_a_failed_write )
{
    char target[] = "/dev/full";
    struct stat info;
    if ( stat( target, &info ) != 0 || !S_ISCHR( info.st_mode ) )
    {
        SKIP( "there is no /dev/full" );
    }
    wisp_groom groom = fixture_groom();
    char* path = path_in( state, "full.hair" );
    assert_int_equal( symlink( target, path ), 0 );
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_groom_write( path, &groom, &error ), WISP_IO_ERROR );
    assert_contains( error.message, "full.hair: cannot write: " );
    assert_int_equal( stat( target, &info ), 0 );
    assert_true( S_ISCHR( info.st_mode ) );
    assert_int_equal( count_files( state ), 1 );
}

TEST_IN_FOLDER( a_symbolic_link_and_the_permissions_of_its_file_survive_a_write )
{
    wisp_groom groom = fixture_groom();
    char file[512];
    strcpy( file, path_in( state, "file.hair" ) );
    char* link = path_in( state, "link.hair" );
    write_bytes( file, "old", 3 );
    assert_int_equal( chmod( file, 0640 ), 0 );
    assert_int_equal( symlink( "file.hair", link ), 0 );
    assert_int_equal( wisp_groom_write( link, &groom, NULL ), WISP_OK );

    struct stat info;
    assert_int_equal( lstat( link, &info ), 0 );
    assert_true( S_ISLNK( info.st_mode ) );
    assert_int_equal( stat( file, &info ), 0 );
    assert_int_equal( info.st_mode & 0777, 0640 );
    wisp_groom again;
    assert_int_equal( wisp_groom_read( file, &again, NULL ), WISP_OK );
    assert_same_groom( &groom, &again );
    wisp_groom_release( &again );
}

// ---- wisp info -------------------------------------------------------------------------------------------------

TEST( info_prints_counts_bounds_and_lengths )
{
    static int offsets[] = { 0, 3, 5 };
    static wisp_vec3 points[] = { { 0, 0, 0 }, { 0, -1, 0 }, { 0, -2, 0 }, { 3, 0, 0 }, { 3, 0, 4 } };
    static float thickness[] = { 0.5f, 0.5f, 0.5f, 0.25f, 0.25f };
    wisp_groom groom = { 2, 5, 3, offsets, points, thickness, NULL, NULL };
    char* text = fixture_info( &groom, WISP_OK );
    assert_string_equal( text, "head.hair: groom in 3 dimensions\n"
                               "  strands              2\n"
                               "  vertices             5\n"
                               "  vertices a strand    min 2, mean 2.5, max 3\n"
                               "  bounds               x 0 .. 3, y -2 .. 0, z 0 .. 4 m\n"
                               "  length               min 2, mean 3, max 4 m\n"
                               "  thickness            min 0.25, mean 0.4, max 0.5 m\n"
                               "  colour               none\n"
                               "  no defects\n" );
    free( text );
}

TEST( info_names_what_is_wrong_by_element )
{
    static int offsets[] = { 0, 2, 2, 3, 6, 8 };
    static wisp_vec3 points[] = {
        { 1, 0, 0 }, { 1, 1, 0 },                  // strand 0
        { 5, 0, 0 },                               // strand 2, no segment
        { 1, 0, 0 }, { 2, 2, 0 },     { 2, 2, 0 }, // strand 3, the root of strand 0, a segment of zero length
        { 7, 0, 0 }, { 0, -2e6f, 0 },              // strand 4, with impossible coordinates
    };
    wisp_groom groom = { 5, 8, 2, offsets, points, NULL, NULL, NULL };
    char* text = fixture_info( &groom, WISP_OK );
    assert_contains( text, "  wrong: segments of zero length: 1\n    strand 3, from vertex 1\n" );
    assert_contains( text,
                     "  wrong: strands without a segment: 2\n    strand 1, vertices 0\n    strand 2, vertices 1\n" );
    assert_contains( text, "  wrong: strands that repeat a root: 1\n    strand 3, the root of strand 0\n" );
    assert_contains( text, "  wrong: vertices beyond 1e+06 m: 1\n    strand 4, vertex 1\n" );
    assert_null( strstr( text, "nothing is wrong" ) );
    free( text );
}

TEST( info_lists_the_first_ten_and_counts_the_rest )
{
    int offsets[14];
    wisp_vec3 points[26];
    for ( int s = 0; s < 14; ++s )
    {
        offsets[s] = 2 * s;
    }
    for ( int v = 0; v < 26; ++v )
    {
        points[v] = ( wisp_vec3 ){ 0.5f, 0.25f, 0.0f };
    }
    wisp_groom groom = { 13, 26, 2, offsets, points, NULL, NULL, NULL };
    char* text = fixture_info( &groom, WISP_OK );
    assert_contains( text, "segments of zero length: 13\n    strand 0, from vertex 0\n" );
    assert_contains( text, "    strand 9, from vertex 0\n    and 3 more\n" );
    assert_null( strstr( text, "strand 10, from vertex" ) );
    // the first of the thirteen does not repeat a root, the others repeat its
    assert_contains( text, "repeat a root: 12\n    strand 1, the root of strand 0\n" );
    assert_contains( text, "    strand 10, the root of strand 0\n    and 2 more\n" );
    free( text );
}

TEST( info_says_which_number_is_out_of_its_range )
{
    static int offsets[] = { 0, 2 };
    static wisp_vec3 points[] = { { 0, 0, 0 }, { 0, -1, 0 } };
    static float transparency[] = { 0.0f, 7.0f };
    wisp_groom groom = { 1, 2, 2, offsets, points, NULL, transparency, NULL };
    char* text = fixture_info( &groom, WISP_OK );
    assert_contains( text, "  wrong: groom: strand 0, vertex 1: transparency: got 7, expected 0 .. 1\n" );
    free( text );
}

TEST( info_of_a_malformed_groom_is_one_message )
{
    static int offsets[] = { 0, 9 };
    static wisp_vec3 points[] = { { 0, 0, 0 }, { 0, -1, 0 } };
    wisp_groom groom = { 1, 2, 2, offsets, points, NULL, NULL, NULL };
    char* text = fixture_info( &groom, WISP_BAD_INPUT );
    assert_string_equal( text, "head.hair: strand 0 runs from vertex 0 to 9 of 2\n" );
    free( text );
}
