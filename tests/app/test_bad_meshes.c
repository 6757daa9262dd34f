// Every mesh file of tests/bad/mesh.txt is rejected with words of its line, and so is every valid one that was truncated
// or damaged, unless it is still valid.
#include "files.h"

#include "mesh.h"

enum
{
    FEWEST_FILES = 45,
};

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
    wisp_status status = is_ply( name ) ? wisp_mesh_read_ply( exact, size, name, mesh, error )
                                        : wisp_mesh_read_obj( exact, size, name, mesh, error );
    return status;
}

static void demand_refusal( const mesh_file* bad, const char* words )
{
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    wisp_status status = read_exactly( bad->name, bad->bytes, bad->size, &mesh, &error );
    if ( status != WISP_BAD_INPUT )
    {
        wisp_mesh_release( &mesh );
        fail_msg( "%s: status is \"%s\" instead of \"bad input\"", bad->name, wisp_status_name( status ) );
    }
    assert_int_equal( error.status, WISP_BAD_INPUT );
    if ( strncmp( error.message, bad->name, strlen( bad->name ) ) != 0 )
    {
        fail_msg( "%s: the message does not name the file: %s", bad->name, error.message );
    }
    if ( strstr( error.message, words ) == NULL )
    {
        fail_msg( "%s: expected \"%s\" in: %s", bad->name, words, error.message );
    }
    for ( const char* c = error.message; *c != 0; ++c )
    {
        assert_true( (unsigned char)*c >= 0x20 && *c != 0x7f );
    }
    assert_null( mesh.points );
    assert_null( mesh.triangles );
}

TEST( every_bad_file_is_refused_for_the_reason_it_was_made_for )
{
    size_t size;
    SCOPED( free_local ) char* list = read_bytes( WISP_SOURCE_ROOT "/tests/bad/mesh.txt", &size );
    int count = -1; // the first line names no file
    for ( char* line = strtok( list, "\n" ); line != NULL; line = strtok( NULL, "\n" ), ++count )
    {
        char* words = strstr( line, ": " );
        if ( words != NULL )
        {
            SCOPED( close_file ) mesh_file bad = open_file( line, (int)( words - line ) );
            demand_refusal( &bad, words + 2 );
        }
    }
    assert_true( count >= FEWEST_FILES );
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
