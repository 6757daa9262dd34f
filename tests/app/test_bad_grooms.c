// Every file in tests/bad/groom is rejected with a message. The test walks the folder, so any file in it is tested.
#include "bad_folder.h"

#include "../bad/bad_grooms.h"
#include "groom.h"

static const char* const bad_folder = WISP_SOURCE_ROOT "/tests/bad/groom";

static void demand_refusal( const char* path, const char* name, wisp_error* error )
{
    wisp_groom groom;
    wisp_status status = wisp_groom_read( path, &groom, error );
    if ( status != WISP_BAD_INPUT )
    {
        wisp_groom_release( &groom );
        fail_msg( "%s: status is \"%s\" instead of \"bad input\"", name, wisp_status_name( status ) );
    }
    assert_null( groom.offsets );
    assert_null( groom.points );
}

TEST( every_file_of_the_folder_is_refused_with_a_message_that_names_it )
{
    demand_refusal_of_folder( 35, demand_refusal );
}

TEST( every_refusal_gives_the_reason_the_file_was_made_for )
{
    demand_words( &bad_groom_list, demand_refusal );
}

TEST( the_committed_files_are_those_that_the_generator_writes )
{
    demand_bytes( &bad_groom_list );
}

TEST( the_file_they_were_made_from_is_good )
{
    unsigned char bytes[BAD_FILE_MAX];
    SCOPED( wisp_groom_release ) wisp_groom groom;
    bad_groom_good_hair( bytes );
    assert_int_equal( wisp_groom_read_hair( bytes, HAIR_SIZE, "good.hair", &groom, NULL ), WISP_OK );
    assert_int_equal( wisp_groom_check( &groom, NULL ), WISP_OK );
}

// Truncated by any number of bytes it is always invalid; the block is exactly as long, so that a sanitizer detects a
// read beyond it.
TEST( every_shorter_beginning_of_a_good_file_is_refused )
{
    unsigned char good[BAD_FILE_MAX];
    bad_groom_good_hair( good );
    for ( size_t size = 0; size < HAIR_SIZE; ++size )
    {
        unsigned char* bytes = checked_malloc( size + ( size == 0 ) );
        memcpy( bytes, good, size );
        wisp_groom groom;
        wisp_status status = wisp_groom_read_hair( bytes, size, "cut", &groom, NULL );
        free( bytes );
        assert_int_equal( status, WISP_BAD_INPUT );
    }
}
