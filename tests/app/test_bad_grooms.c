// Every file in tests/bad/groom is refused with a message. The folder is walked, so a file dropped there is tested.
#define _XOPEN_SOURCE 700

#include "unit.h"

#include "../bad/bad_grooms.h"
#include "groom.h"

#include <dirent.h>

enum
{
    FEWEST_FILES = 35,
    LARGEST_FILE = 2048,
};

static const char* folder = WISP_SOURCE_ROOT "/tests/bad/groom";

static void path_in_folder( char* path, size_t room, const char* name )
{
    int length = snprintf( path, room, "%s/%s", folder, name );
    assert_true( length > 0 && (size_t)length < room );
}

static void demand_refusal( const char* name, wisp_error* error )
{
    char path[1024];
    path_in_folder( path, sizeof path, name );
    wisp_groom groom;
    wisp_status status = wisp_groom_read( path, &groom, error );
    if ( status != WISP_BAD_INPUT )
    {
        wisp_groom_release( &groom );
        fail_msg( "%s: status is \"%s\" instead of \"bad input\"", name, wisp_status_name( status ) );
    }
    assert_int_equal( error->status, WISP_BAD_INPUT );
    if ( strstr( error->message, name ) == NULL )
    {
        fail_msg( "%s: the sentence does not name the file: %s", name, error->message );
    }
    assert_null( strchr( error->message, '\n' ) );
    assert_null( groom.offsets );
    assert_null( groom.points );
}

static void every_file_of_the_folder_is_refused_with_a_message_that_names_it( void** state )
{
    (void)state;
    DIR* walk = opendir( folder );
    assert_non_null( walk );
    int count = 0;
    for ( struct dirent* entry = readdir( walk ); entry != NULL; entry = readdir( walk ) )
    {
        if ( entry->d_name[0] != '.' )
        {
            wisp_error error = { .status = WISP_OK };
            demand_refusal( entry->d_name, &error );
            ++count;
        }
    }
    closedir( walk );
    assert_true( count >= FEWEST_FILES );
}

// A file that is refused for another reason than its own tests nothing.
static void demand_words( const bad_groom* list, size_t count )
{
    for ( size_t i = 0; i < count; ++i )
    {
        wisp_error error = { .status = WISP_OK };
        demand_refusal( list[i].name, &error );
        if ( strstr( error.message, list[i].words ) == NULL )
        {
            fail_msg( "%s: expected \"%s\" in: %s", list[i].name, list[i].words, error.message );
        }
    }
}

static void every_refusal_gives_the_reason_the_file_was_made_for( void** state )
{
    (void)state;
    demand_words( bad_hairs, sizeof bad_hairs / sizeof bad_hairs[0] );
    demand_words( bad_tfxs, sizeof bad_tfxs / sizeof bad_tfxs[0] );
}

static void demand_bytes( const bad_groom* list, size_t count, void ( *good )( unsigned char* ) )
{
    for ( size_t i = 0; i < count; ++i )
    {
        unsigned char made[BAD_GROOM_ROOM];
        size_t size = bad_groom_build( &list[i], good, made );
        char path[1024];
        path_in_folder( path, sizeof path, list[i].name );
        FILE* file = fopen( path, "rb" );
        assert_non_null( file );
        unsigned char found[LARGEST_FILE + 1];
        size_t length = fread( found, 1, sizeof found, file );
        fclose( file );
        if ( length != size || memcmp( found, made, size ) != 0 )
        {
            fail_msg( "%s: the file is not what make_bad_grooms writes", list[i].name );
        }
    }
}

static void the_committed_files_are_those_that_the_generator_writes( void** state )
{
    (void)state;
    demand_bytes( bad_hairs, sizeof bad_hairs / sizeof bad_hairs[0], bad_groom_good_hair );
    demand_bytes( bad_tfxs, sizeof bad_tfxs / sizeof bad_tfxs[0], bad_groom_good_tfx );
}

static void the_files_they_were_made_from_are_good( void** state )
{
    (void)state;
    unsigned char bytes[BAD_GROOM_ROOM];
    wisp_groom groom;
    bad_groom_good_hair( bytes );
    assert_int_equal( wisp_groom_read_hair( bytes, HAIR_SIZE, "good.hair", &groom, NULL ), WISP_OK );
    assert_int_equal( wisp_groom_check( &groom, NULL ), WISP_OK );
    wisp_groom_release( &groom );
    bad_groom_good_tfx( bytes );
    assert_int_equal( wisp_groom_read_tfx( bytes, TFX_SIZE, "good.tfx", &groom, NULL ), WISP_OK );
    assert_int_equal( wisp_groom_check( &groom, NULL ), WISP_OK );
    wisp_groom_release( &groom );
}

// Shorter by any number of bytes is always wrong; the block is exactly as long, so that a checker sees a read past
// it.
static void every_shorter_beginning_of_a_good_file_is_refused( void** state )
{
    (void)state;
    unsigned char good[BAD_GROOM_ROOM];
    for ( int format = 0; format < 2; ++format )
    {
        format == 0 ? bad_groom_good_hair( good ) : bad_groom_good_tfx( good );
        size_t whole = format == 0 ? HAIR_SIZE : TFX_SIZE;
        for ( size_t size = 0; size < whole; ++size )
        {
            unsigned char* bytes = malloc( size + ( size == 0 ) );
            assert_non_null( bytes );
            memcpy( bytes, good, size );
            wisp_groom groom;
            wisp_status status = format == 0 ? wisp_groom_read_hair( bytes, size, "cut", &groom, NULL )
                                             : wisp_groom_read_tfx( bytes, size, "cut", &groom, NULL );
            free( bytes );
            assert_int_equal( status, WISP_BAD_INPUT );
        }
    }
}

int main( int argc, char** argv )
{
    folder = argc > 1 ? argv[1] : folder;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( every_file_of_the_folder_is_refused_with_a_message_that_names_it ),
        cmocka_unit_test( every_refusal_gives_the_reason_the_file_was_made_for ),
        cmocka_unit_test( the_committed_files_are_those_that_the_generator_writes ),
        cmocka_unit_test( the_files_they_were_made_from_are_good ),
        cmocka_unit_test( every_shorter_beginning_of_a_good_file_is_refused ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
