// Every file in tests/bad/scene is rejected with exactly its line of tests/bad/scene.txt: position, key and error.
#define _XOPEN_SOURCE 700

#include "files.h"

#include "scene.h"

#include <dirent.h>

static const char FOLDER[] = WISP_SOURCE_ROOT "/tests/bad/scene";

static void path_in_folder( char* path, size_t room, const char* file )
{
    int length = snprintf( path, room, "%s/%s", FOLDER, file );
    assert_true( length > 0 && (size_t)length < room );
}

// The file must be refused with this message, behind its name.
static void demand_message( const char* file, const char* expected, size_t length )
{
    char path[1024];
    path_in_folder( path, sizeof path, file );
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    wisp_status status = wisp_scene_read( path, &scene, &error );

    if ( status != WISP_BAD_INPUT || error.status != WISP_BAD_INPUT )
    {
        wisp_scene_release( &scene );
        fail_msg( "%s: status is \"%s\": %s", file, wisp_status_name( status ), error.message );
    }
    // The folder before the name differs from machine to machine.
    const char* message = strstr( error.message, file );
    assert_non_null( message );
    message += strlen( file );
    // A message that is full ends within its list of keys, at a place that depends on the folder.
    const bool is_full = strlen( error.message ) == sizeof error.message - 1;
    if ( strncmp( message, expected, strlen( message ) ) != 0 || ( !is_full && strlen( message ) != length ) )
    {
        fail_msg( "%s%s, expected %.*s", file, message, (int)length, expected );
    }
    assert_null( scene.strands );
    assert_null( scene.blocks );
}

TEST( every_bad_file_is_refused_with_its_place_its_key_and_what_is_wrong )
{
    size_t size = 0;
    char* messages = read_bytes( WISP_SOURCE_ROOT "/tests/bad/scene.txt", &size );
    DIR* walk = opendir( FOLDER );
    assert_non_null( walk );
    int extra_lines = -1; // the first line is no message
    for ( const char* c = messages; *c; ++c )
    {
        extra_lines += *c == '\n';
    }
    for ( struct dirent* entry = readdir( walk ); entry; entry = readdir( walk ) )
    {
        if ( entry->d_name[0] != '.' )
        {
            char start[300];
            snprintf( start, sizeof start, "\n%s:", entry->d_name );
            const char* line = strstr( messages, start );
            if ( line == NULL )
            {
                fail_msg( "%s has no line in scene.txt", entry->d_name );
            }
            line += strlen( start ) - 1;
            demand_message( entry->d_name, line, strcspn( line, "\n" ) );
            --extra_lines;
        }
    }
    closedir( walk );
    free( messages );
    assert_int_equal( extra_lines, 0 );
}

TEST( a_refusal_without_an_error_to_fill_still_has_its_status )
{
    char path[1024];
    path_in_folder( path, sizeof path, "alias.yaml" );
    wisp_scene scene;
    assert_int_equal( wisp_scene_read( path, &scene, NULL ), WISP_BAD_INPUT );
}
