// Every file of tests/bad/mesh, groom and recording is refused by the words of its line in the list beside the folder, and says nothing
// that a terminal would obey. Good meshes that are cut or damaged anywhere get an answer.
#include "files.h"

#include "groom.h"
#include "mesh.h"
#include "record.h"

#include <dirent.h>

#define FOLDER WISP_SOURCE_ROOT "/tests/bad/"

// ---- readers of a file in memory ----

// @return whether nothing is left behind by a refusal
typedef bool read_fn( const char* path, const char* name, wisp_error* error );

static bool is_ply( const char* name )
{
    return strstr( name, ".ply" ) != NULL;
}

// The block is exactly as long as the file, so that a sanitizer detects a read beyond its end.
static wisp_status read_exactly( const char* name, const char* bytes, size_t size, wisp_mesh* mesh,
                                 wisp_error* error )
{
    SCOPED( free_local ) char* exact = checked_malloc( size + ( size == 0 ) );
    memcpy( exact, bytes, size );
    return is_ply( name ) ? wisp_mesh_read_ply( exact, size, name, mesh, error )
                          : wisp_mesh_read_obj( exact, size, name, mesh, error );
}

static bool read_mesh( const char* path, const char* name, wisp_error* error )
{
    wisp_mesh mesh;
    size_t size;
    SCOPED( free_local ) char* bytes = read_bytes( path, &size );
    read_exactly( name, bytes, size, &mesh, error );
    return mesh.points == NULL && mesh.triangles == NULL;
}

static bool read_groom( const char* path, const char* name, wisp_error* error )
{
    wisp_groom groom;
    (void)name;
    wisp_groom_read( path, &groom, error );
    return groom.offsets == NULL && groom.points == NULL;
}

// Refused when it is opened, or when a frame is read.
static bool read_recording( const char* path, const char* name, wisp_error* error )
{
    wisp_recording* recording = NULL;
    wisp_status status = strstr( name, ".pc2" ) ? wisp_pc2_open( path, &recording, error )
                                                : wisp_recording_open( path, &recording, error );
    const bool is_clean = ( recording == NULL ) == ( status != WISP_OK );
    for ( int f = 0; status == WISP_OK && f < wisp_recording_describe( recording ).frame_count; ++f )
    {
        status = wisp_recording_frame( recording, f, NULL, NULL, NULL, error );
    }
    wisp_recording_close( recording );
    return is_clean;
}

// ---- bad files ----

static void demand_refusal( read_fn* read, const char* path, const char* name, const char* words )
{
    wisp_error error = { .status = WISP_OK };
    assert_true( read( path, name, &error ) );
    if ( error.status != WISP_BAD_INPUT || !strstr( error.message, name ) || !strstr( error.message, words ) )
    {
        fail_msg( "%s: expected \"%s\" in: %s: %s", name, words, wisp_status_name( error.status ), error.message );
    }
    for ( const char* c = error.message; *c != 0; ++c )
    {
        assert_true( (unsigned char)*c >= 0x20 && *c != 0x7f );
    }
}

static int count_files( const char* folder )
{
    int count = 0;
    DIR* walk = opendir( folder );
    assert_non_null( walk );
    for ( struct dirent* entry = readdir( walk ); entry; entry = readdir( walk ) )
    {
        count += entry->d_name[0] != '.';
    }
    closedir( walk );
    return count;
}

TEST( every_bad_file_is_refused_for_the_reason_it_was_made_for )
{
    static const struct
    {
        const char* name;
        read_fn* read;
        int good; // files that are none
    } folders[] = { { "mesh", read_mesh, 14 }, { "groom", read_groom, 0 }, { "recording", read_recording, 0 } };
    for ( int i = 0; i < WISP_COUNT( folders ); ++i )
    {
        char path[1024];
        size_t size;
        int count = 0;
        snprintf( path, sizeof path, FOLDER "%s.txt", folders[i].name );
        SCOPED( free_local ) char* list = read_bytes( path, &size );
        for ( char* line = strtok( list, "\n" ); line != NULL; line = strtok( NULL, "\n" ) )
        {
            char* words = strstr( line, ": " );
            if ( line[0] != '#' && words != NULL )
            {
                *words = '\0';
                words[2 + strcspn( words + 2, "\t" )] = '\0'; // what the file is made of follows
                snprintf( path, sizeof path, FOLDER "%s/%s", folders[i].name, line );
                demand_refusal( folders[i].read, path, line, words + 2 );
                ++count;
            }
        }
        snprintf( path, sizeof path, FOLDER "%s", folders[i].name );
        assert_int_equal( count + folders[i].good, count_files( path ) );
    }
}

// ---- good meshes, cut and damaged ----

typedef struct mesh_file
{
    char name[64];
    char* bytes;
    size_t size;
} mesh_file;

static const char* const good_meshes[] = { "good.obj", "good_text.ply", "good_little.ply", "good_big.ply" };

static mesh_file open_file( const char* name, int length )
{
    mesh_file file;
    char path[1024];
    snprintf( file.name, sizeof file.name, "%.*s", length, name );
    snprintf( path, sizeof path, WISP_SOURCE_ROOT "/tests/bad/mesh/%s", file.name );
    file.bytes = read_bytes( path, &file.size );
    return file;
}

static mesh_file open_good( int number )
{
    return open_file( good_meshes[number], (int)strlen( good_meshes[number] ) );
}

static void close_file( mesh_file* file )
{
    free( file->bytes );
}

TEST( the_files_that_are_cut_and_damaged_are_good )
{
    for ( int i = 0; i < WISP_COUNT( good_meshes ); ++i )
    {
        SCOPED( wisp_mesh_release ) wisp_mesh mesh;
        wisp_error error = { .status = WISP_OK };
        SCOPED( close_file ) mesh_file good = open_good( i );
        assert_ok( read_exactly( good.name, good.bytes, good.size, &mesh, &error ), error );
    }
}

// A damaged file may be accepted or rejected, with everything that belongs to it.
static void demand_answer( const char* name, const char* bytes, size_t size )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh;
    wisp_mesh_diagnostics report;
    wisp_error error = { .status = WISP_OK };
    wisp_status status = read_exactly( name, bytes, size, &mesh, &error );
    if ( status == WISP_OK )
    {
        assert_int_equal( wisp_mesh_examine( &mesh, &report, NULL ), WISP_OK );
    }
    else
    {
        assert_int_equal( status, WISP_BAD_INPUT );
        assert_true( strlen( error.message ) > strlen( name ) );
        assert_null( mesh.points );
        assert_null( mesh.triangles );
    }
}

TEST( every_shorter_beginning_of_a_good_file_gets_an_answer )
{
    for ( int i = 0; i < WISP_COUNT( good_meshes ); ++i )
    {
        SCOPED( close_file ) mesh_file good = open_good( i );
        for ( size_t size = 0; size < good.size; ++size )
        {
            demand_answer( good.name, good.bytes, size );
        }
    }
}

TEST( a_binary_file_that_misses_its_last_byte_is_refused )
{
    for ( int i = 2; i < WISP_COUNT( good_meshes ); ++i )
    {
        wisp_mesh mesh;
        SCOPED( close_file ) mesh_file good = open_good( i );
        assert_int_equal( read_exactly( good.name, good.bytes, good.size - 1, &mesh, NULL ), WISP_BAD_INPUT );
    }
}

TEST( every_byte_of_a_good_file_may_be_anything )
{
    static const unsigned char telling[] = { 0x00, 0xff, 0x7f, 0x80, 0x01, '0',  '9', '-',
                                             '.',  'e',  '/',  '#',  '\n', '\r', ' ' };
    char damaged[1024];
    for ( int i = 0; i < WISP_COUNT( good_meshes ); ++i )
    {
        SCOPED( close_file ) mesh_file good = open_good( i );
        assert_true( good.size <= sizeof damaged );
        for ( size_t at = 0; at < good.size; ++at )
        {
            for ( int k = 0; k < WISP_COUNT( telling ); ++k )
            {
                memcpy( damaged, good.bytes, good.size );
                damaged[at] = (char)telling[k];
                demand_answer( good.name, damaged, good.size );
            }
        }
    }
}

TEST( a_face_of_more_corners_than_the_cap_is_refused )
{
    enum
    {
        CORNERS = WISP_MESH_CORNER_CAP + 1
    };
    static char text[16 + 2 * CORNERS];
    memcpy( text, "v 0 0 0\nf ", 10 );
    for ( int i = 0; i < CORNERS; ++i )
    {
        memcpy( text + 10 + 2 * i, "1 ", 2 );
    }
    SCOPED( wisp_mesh_release ) wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( read_exactly( "wide.obj", text, 10 + 2 * CORNERS, &mesh, &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, "line 2: expected a face of at most 65536 corners" ) );
    // one fewer is a fan
    assert_int_equal( read_exactly( "wide.obj", text, 10 + 2 * ( CORNERS - 1 ), &mesh, &error ), WISP_OK );
    assert_int_equal( mesh.triangle_count, WISP_MESH_CORNER_CAP - 2 );
}
