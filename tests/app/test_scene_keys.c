// The reference of all keys: it equals docs/scenes.md, describes every key completely, and what is gone has an answer.
#define _XOPEN_SOURCE 700

#include "files.h"

#include "scene.h"
#include "scene_keys.h"
#include "scene_removed.h"

static const char DOCUMENT[] = WISP_SOURCE_ROOT "/docs/scenes.md";

// @return text for free()
// Not inlined: gcc 12 would mistake the stream's buffer for the local that held its address.
__attribute__( ( noinline ) ) static char* keys_of( const char* block, int* count )
{
    char* text = NULL;
    size_t size = 0;
    FILE* stream = open_memstream( &text, &size );
    assert_non_null( stream );
    *count = wisp_scene_write_keys( stream, block );
    fclose( stream );
    return text;
}

static char* read_document( void )
{
    size_t size;
    return read_bytes( DOCUMENT, &size );
}

// ---- the document ----

TEST( the_document_has_the_keys_of_the_tables )
{
    static const char begin_mark[] = "<!-- keys: begin -->\n", end_mark[] = "<!-- keys: end -->\n";
    int count = 0;
    char *document = read_document(), *keys = keys_of( NULL, &count );
    char* begin = strstr( document, begin_mark );
    assert_non_null( begin );
    begin += strlen( begin_mark );
    char* end = strstr( begin, end_mark );
    assert_non_null( end );
    *end = 0;
    if ( strcmp( begin, keys ) != 0 )
    {
        fail_msg( "docs/scenes.md differs from the tables of the reader; run ./dev docs" );
    }
    free( keys );
    free( document );
}

TEST( every_example_of_the_document_is_a_scene )
{
    static const char fence[] = "```yaml\n";
    char* document = read_document();
    int examples = 0;
    for ( char* at = strstr( document, fence ); at; at = strstr( at, fence ) )
    {
        at += strlen( fence );
        char* end = strstr( at, "```" );
        assert_non_null( end );
        wisp_scene scene;
        wisp_error error = { .status = WISP_OK };
        if ( wisp_scene_parse( at, (size_t)( end - at ), "example", &scene, &error ) != WISP_OK )
        {
            fail_msg( "example %d is refused: %s", examples, error.message );
        }
        wisp_scene_release( &scene );
        ++examples;
        at = end + 3;
    }
    assert_true( examples >= 5 );
    free( document );
}

// ---- the text ----

TEST( every_key_has_a_message )
{
    int count = 0, keys = 0;
    char* text = keys_of( NULL, &count );
    assert_true( count > 30 );
    assert_null( strstr( text, "(null)" ) );
    for ( char* line = strtok( text, "\n" ); line; line = strtok( NULL, "\n" ) )
    {
        if ( strncmp( line, "- `", 3 ) == 0 )
        {
            const char* message = strstr( line, "): " );
            assert_non_null( message );
            assert_true( line[strlen( line ) - 1] == '.' );
            ++keys;
        }
    }
    assert_true( keys > 250 );
    free( text );
}

TEST( a_block_is_written_with_the_blocks_in_it )
{
    int count = 0;
    char* text = keys_of( "frozen_hair", &count );
    assert_int_equal( count, 4 );
    assert_non_null( strstr( text, "### `strands[].frozen_hair`\n" ) );
    assert_non_null( strstr( text, "### `strands[].frozen_hair.clump`\n" ) );
    assert_null( strstr( text, "### `strands[]`\n" ) );
    free( text );
    text = keys_of( "surfaces.cloth", &count );
    assert_int_equal( count, 1 );
    free( text );
    text = keys_of( "scene", &count );
    assert_int_equal( count, 1 );
    free( text );
}

TEST( an_unknown_block_writes_nothing )
{
    int count = 1;
    char* text = keys_of( "clot", &count );
    assert_int_equal( count, 0 );
    assert_string_equal( text, "" );
    free( text );
}

TEST( a_default_is_that_of_the_module )
{
    int count = 0;
    char expected[100], *text = keys_of( "surfaces.balloon", &count );
    snprintf( expected, sizeof expected, "- `edge_stiffness` (number, N/m, 1e-6 .. 1e12, default %g):",
              (double)wisp_default_balloon_def().edge_stiffness );
    assert_non_null( strstr( text, expected ) );
    free( text );
}

// ---- what is gone ----

TEST( what_is_gone_is_found_in_its_own_block )
{
    const char* use = scene_find_removed( "strands[3].dynamics", "leader_correction", false );
    assert_non_null( use );
    assert_null( scene_find_removed( "strands[3].frozen_hair", "leader_correction", false ) );
    assert_null( scene_find_removed( "strands[3].dynamics.leader_correction", "leader_correction", true ) );
    assert_non_null( scene_find_removed( "strands[3].dynamics.stretch", "follow", true ) );
    assert_non_null( scene_find_removed( "strands[3].dynamics.stretch[2]", "follow", true ) );
    assert_null( scene_find_removed( "strands[3].dynamics.stretch", "fellow", true ) );
    assert_null( scene_find_removed( "strands[3].dynamics.bending", "follow", true ) );
    assert_null( scene_find_removed( "stretch", "follow", true ) );
    assert_null( scene_find_removed( "", "leader_correction", false ) );
}
