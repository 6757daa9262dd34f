// Reading, writing and checking grooms. On disk: the format of a path, the file after a failed write. What `wisp info` says
// is in tests/app/transcripts/meshes.t, the arrays of a .hair file are in formats.t.
#define _XOPEN_SOURCE 700

#include "groom_fixture.h"
#include "locale_fixture.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

// ---- reading ----

TEST( a_message_keeps_its_reason_when_the_name_is_very_long )
{
    char name[2000];
    memset( name, 'a', sizeof name - 1 );
    strcpy( name + sizeof name - 11, "/last.hair" );
    wisp_groom groom;
    wisp_error error = { .status = WISP_OK };
    wisp_groom_read_hair( "HAIR", 4, name, &groom, &error );
    assert_contains( error.message, "/last.hair: byte 4: the file ends inside the header" );
}

// ---- writing ----

TEST( a_hair_file_comes_back_bit_for_bit )
{
    wisp_groom groom = fixture_groom();
    for ( int columns = 0; columns < 8; ++columns )
    {
        wisp_groom some = groom;
        some.thickness = ( columns & 1 ) != 0 ? groom.thickness : NULL;
        some.transparency = ( columns & 2 ) != 0 ? groom.transparency : NULL;
        some.colour = ( columns & 4 ) != 0 ? groom.colour : NULL;
        size_t size = 0;
        SCOPED( free_local ) char* bytes = fixture_written( wisp_groom_write_hair, &some, &size );
        SCOPED( wisp_groom_release ) wisp_groom again;
        assert_int_equal( wisp_groom_read_hair( bytes, size, "again", &again, NULL ), WISP_OK );
        assert_same_groom( &some, &again );
    }
}

// The block is exactly as long as what is left, so that a sanitizer detects a read beyond it.
TEST( every_shorter_beginning_of_a_hair_file_is_refused )
{
    wisp_groom groom = fixture_groom();
    size_t whole = 0;
    SCOPED( free_local ) char* good = fixture_written( wisp_groom_write_hair, &groom, &whole );
    for ( size_t size = 0; size < whole; ++size )
    {
        SCOPED( free_local ) char* bytes = checked_malloc( size + ( size == 0 ) );
        memcpy( bytes, good, size );
        wisp_groom cut;
        assert_int_equal( wisp_groom_read_hair( bytes, size, "cut", &cut, NULL ), WISP_BAD_INPUT );
    }
}

TEST( a_strand_without_vertices_is_refused_by_number )
{
    static int with_empty[] = { 0, 3, 3, 6 };
    wisp_groom groom = fixture_groom();
    wisp_error error = { .status = WISP_OK };
    groom.offsets = with_empty;
    assert_int_equal( wisp_groom_write_hair( stdout, &groom, "a.hair", &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "a.hair: strand 1 has 0 vertices" );
}

// ---- text formats, which tests/app/transcripts/formats.t reads ----

TEST( text_has_decimal_points_where_the_locale_has_commas )
{
    wisp_groom groom = fixture_curves();
    SCOPED( free_local ) char* expected = fixture_written( wisp_groom_write_usda, &groom, NULL );
    enter_comma_locale();
    SCOPED( free_local ) char* text = fixture_written( wisp_groom_write_usda, &groom, NULL );
    bool comma_afterwards = localeconv()->decimal_point[0] == ',';
    setlocale( LC_ALL, "C" );
    assert_string_equal( text, expected );
    assert_true( comma_afterwards );
}

// ---- checking ----

static void assert_check_says( const wisp_groom* groom, const char* words )
{
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_groom_check( groom, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, words );
}

// Two strands of two vertices, all arrays, for tests to break.
typedef struct small_groom
{
    int offsets[3];
    wisp_vec3 points[4];
    float thickness[4];
    float transparency[4];
    wisp_vec3 colour[4];
    wisp_groom groom;
} small_groom;

static wisp_groom* make_small( small_groom* small )
{
    *small = ( small_groom ){ .offsets = { 0, 2, 4 } };
    small->groom = ( wisp_groom ){
        2, 4, 2, small->offsets, small->points, small->thickness, small->transparency, small->colour
    };
    return &small->groom;
}

TEST( a_check_accepts_the_limits_themselves )
{
    small_groom small;
    wisp_groom* groom = make_small( &small );
    small.points[0] = ( wisp_vec3 ){ WISP_GROOM_MAX_COORDINATE, -WISP_GROOM_MAX_COORDINATE, 0.0f };
    small.transparency[3] = 1.0f;
    small.colour[1] = ( wisp_vec3 ){ 1.0f, 1.0f, 1.0f };
    assert_int_equal( wisp_groom_check( groom, NULL ), WISP_OK );
}

TEST( a_check_names_the_first_wrong_number_by_strand_and_vertex )
{
    small_groom small;
    wisp_groom* groom = make_small( &small );
    small.points[3].y = NAN;
    assert_check_says( groom, "strand 1, vertex 1: y is NaN" );
    groom = make_small( &small );
    small.points[2].x = -1.5e6f;
    assert_check_says( groom, "strand 1, vertex 0: x: got -1500000, expected -1e+06 .. 1e+06" );
    groom = make_small( &small );
    small.points[1].z = 0.5f;
    assert_check_says( groom, "strand 0, vertex 1: z: got 0.5, expected 0 in two dimensions" );
    groom = make_small( &small );
    small.thickness[0] = -1e-5f;
    assert_check_says( groom, "strand 0, vertex 0: thickness: got" );
    groom = make_small( &small );
    small.transparency[0] = 1.5f;
    assert_check_says( groom, "strand 0, vertex 0: transparency: got 1.5, expected 0 .. 1" );
    groom = make_small( &small );
    small.groom.thickness = NULL;
    small.transparency[0] = 2.0f;
    assert_check_says( groom, "transparency: got 2, expected 0 .. 1" );
    groom = make_small( &small );
    small.colour[2].z = -0.5f;
    assert_check_says( groom, "strand 1, vertex 0: blue: got -0.5" );
}

TEST( a_check_refuses_offsets_that_do_not_partition_the_vertices )
{
    small_groom small;
    wisp_groom* groom = make_small( &small );
    small.offsets[0] = 1;
    assert_check_says( groom, "strand 0 starts at vertex 1" );
    groom = make_small( &small );
    small.offsets[1] = -1;
    assert_check_says( groom, "strand 0 runs from vertex 0 to -1" );
    groom = make_small( &small );
    small.offsets[1] = 5;
    assert_check_says( groom, "strand 0 runs from vertex 0 to 5 of 4" );
    groom = make_small( &small );
    small.offsets[2] = 3;
    assert_check_says( groom, "the strands end at vertex 3 of 4" );
    groom = make_small( &small );
    groom->strand_count = 0;
    assert_check_says( groom, "the groom is empty" );
    groom = make_small( &small );
    groom->points = NULL;
    assert_check_says( groom, "the groom has no points" );
    groom = make_small( &small );
    groom->dimension = 4;
    assert_check_says( groom, "4 dimensions" );
}

static void assert_file_is( const char* path, const char* text )
{
    size_t length = 0;
    SCOPED( free_local ) char* found = read_bytes( path, &length );
    assert_int_equal( length, strlen( text ) );
    assert_string_equal( found, text );
}

// ---- reading and writing files ----

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
    SCOPED( wisp_groom_release ) wisp_groom groom;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_groom_read( path_in( state, "none.hair" ), &groom, &error ), WISP_IO_ERROR );
    assert_contains( error.message, "none.hair: cannot open: " );
    assert_int_equal( wisp_groom_read( path_in( state, "." ), &groom, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "got a folder" );
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
    SCOPED( wisp_groom_release ) wisp_groom groom;
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
    SCOPED( wisp_groom_release ) wisp_groom again;
    assert_int_equal( wisp_groom_read( file, &again, NULL ), WISP_OK );
    assert_same_groom( &groom, &again );
}
