// `wisp view`: the page holds the scene, its files and the hashes of a native run. The page itself is tested in a browser by
// `./dev web test`; here a short one takes its place.
#include "program_fixture.h"

#include <jansson.h>
#include <sys/stat.h>
#include <unistd.h>

#define PLACE "<script type=\"application/json\" id=\"wisp-data\">"

static const char scene[] = "wisp: 1\n"
                            "steps: 130\n"
                            "surfaces:\n"
                            "  - name: \"cloth\"  # </script><!--\n"
                            "    file: ../meshes/square.obj\n"
                            "    pins: [0]\n"
                            "    cloth: {}\n";
static const char square[] = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3\nf 1 3 4\n";

static int enter_folder( void** state )
{
    static const text_file files[] = {
        { "viewer.html", "<html>" PLACE "null</script><p>after</p></html>" },
        { "wrong.txt", "nothing" },
    };
    if ( enter_folder_with( state, files, WISP_COUNT( files ) ) != 0 )
    {
        return -1;
    }
    static const text_file inner[] = { { "scenes/square.yaml", scene }, { "meshes/square.obj", square } };
    mkdir( "scenes", 0777 );
    mkdir( "meshes", 0777 );
    for ( int i = 0; i < WISP_COUNT( inner ); ++i )
    {
        write_text( inner[i].name, inner[i].text );
    }
    setenv( "WISP_DATA", ".", 1 );
    return 0;
}

// The data of a page, which must be all between their place and the next end of a script.
static json_t* data_of( const char* path )
{
    size_t size;
    char* page = read_bytes( path, &size );
    const char* begin = strstr( page, PLACE );
    assert_non_null( begin );
    begin += sizeof PLACE - 1;
    const char* end = strstr( begin, "</script>" );
    assert_non_null( end );
    assert_string_equal( end, "</script><p>after</p></html>" );
    json_error_t error;
    json_t* data = json_loadb( begin, (size_t)( end - begin ), JSON_REJECT_DUPLICATES, &error );
    if ( data == NULL )
    {
        fail_msg( "%s", error.text );
    }
    free( page );
    return data;
}

static void decode( const char* text, char* out, size_t size )
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    unsigned bits = 0;
    size_t count = 0, length = 0;
    for ( const char* at = text; *at && *at != '='; ++at )
    {
        bits = bits << 6 | (unsigned)( strchr( letters, *at ) - letters );
        if ( ++count % 4 != 1 )
        {
            assert_true( length + 1 < size );
            out[length++] = (char)( bits >> ( 6 - 2 * ( ( count - 1 ) % 4 ) ) & 255 );
        }
    }
    out[length] = '\0';
}

static void assert_file( const json_t* data, const char* name, const char* content )
{
    char text[2000];
    const json_t* file = json_object_get( json_object_get( data, "files" ), name );
    assert_non_null( file );
    decode( json_string_value( file ), text, sizeof text );
    assert_string_equal( text, content );
}

TEST( a_page_holds_the_scene_and_the_files_that_it_reads )
{
    run_ok( "view scenes/square.yaml -o page.html --steps 0" );
    json_t* data = data_of( "page.html" );
    assert_string_equal( json_string_value( json_object_get( data, "kind" ) ), "scene" );
    assert_string_equal( json_string_value( json_object_get( data, "name" ) ), "square.yaml" );
    assert_string_equal( json_string_value( json_object_get( data, "title" ) ), "square" );
    assert_int_equal( json_object_size( json_object_get( data, "files" ) ), 2 );
    assert_file( data, "square.yaml", scene );
    assert_file( data, "../meshes/square.obj", square );
    json_decref( data );
}

TEST( hashes_of_a_page_are_those_of_wisp_run )
{
    run_ok( "view scenes/square.yaml -o page.html" );
    json_t* data = data_of( "page.html" );
    const json_t* hashes = json_object_get( data, "hashes" );
    const json_t* values = json_object_get( hashes, "values" );
    assert_int_equal( json_integer_value( json_object_get( hashes, "every" ) ), 60 );
    assert_int_equal( json_array_size( values ), 2 ); // of 130 steps
    for ( int i = 0; i < 2; ++i )
    {
        char command[80];
        snprintf( command, sizeof command, "run scenes/square.yaml --steps %d", 60 * ( i + 1 ) );
        run_ok( command );
        assert_non_null( strstr( result.out, json_string_value( json_array_get( values, (size_t)i ) ) ) );
    }
    json_decref( data );
}

TEST( a_page_of_a_recording_holds_its_bytes )
{
    run_ok( "run scenes/square.yaml --steps 3 --record run.wisp" );
    run_ok( "view run.wisp -o page.html" );
    json_t* data = data_of( "page.html" );
    assert_string_equal( json_string_value( json_object_get( data, "kind" ) ), "recording" );
    const json_t* file = json_object_get( json_object_get( data, "files" ), "run.wisp" );
    size_t size;
    free( read_bytes( "run.wisp", &size ) );
    assert_int_equal( json_string_length( file ), ( size + 2 ) / 3 * 4 );
    json_decref( data );
}

TEST( wrong_input_is_refused_and_writes_nothing )
{
    assert_refused( "view wrong.txt -o none.html",
                    "wrong.txt: got another kind of file, expected a scene or a recording" );
    assert_refused( "view gone.yaml -o none.html", "gone.yaml: No such file or directory" );
    assert_usage( "view scenes/square.yaml -o none.png", "expected a file name that ends in .html" );
    assert_usage( "view scenes/square.yaml", "expected an output file" );
    assert_usage( "view scenes/square.yaml -o none.html --steps -1", "--steps: got '-1'" );
    assert_refused( "view \xff.yaml -o none.html", "No such file" );
    write_text( "bad\xff.yaml", "wisp: 1\n" );
    assert_refused( "view bad\xff.yaml -o none.html", "not UTF-8" );
    run_ok( "run scenes/square.yaml --steps 3 --record run.wisp" );
    assert_refused( "view run.wisp --steps 3 -o none.html", "a recording is played, not simulated" );
    write_text( "viewer.html", "<html></html>" );
    assert_refused( "view scenes/square.yaml -o none.html --steps 0", "the page has no place for data" );
    remove( "viewer.html" );
    assert_refused( "view scenes/square.yaml -o none.html --steps 0", "'./dev web' builds it" );
    assert_int_not_equal( access( "none.html", F_OK ), 0 );
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
