// The report: for any content of the results, the page is complete and self-contained, and contains nothing else.
#include "files.h"
#include "report_fixture.h"

#include "report_text.h"

#include <locale.h>
#include <sys/stat.h>

// ---- results ----

static const char* const hostile[] = {
    "<script>alert(1)</script>",
    "\"><img src=x onerror=alert(1)>",
    "a' b & c &lt; d",
    "]]></style></svg></table>",
    "\xff\xfe\xc3",
    "\x01\x02\x1b[31m",
    "<!-- ",
    "caf\xc3\xa9 \xe2\x80\xa8 \xf0\x9f\x8e\x88",
};

// All elements of a page, with this text wherever a text can be.
static void fill( results* all, const char* text )
{
    *all = empty_results();
    snprintf( all->machine.cpu, sizeof( all->machine.cpu ), "%s", text );
    snprintf( all->machine.os, sizeof( all->machine.os ), "%s", text );
    int table = results_add_table( all, text, 3, ( const char* const[] ){ text, "ms", "hash" } );
    results_add_cells( all, table, ( const char* const[] ){ text, "0.75", "0123456789abcdef" } );
    results_add_cells( all, table, ( const char* const[] ){ "b", "-", text } );
    for ( int i = 0; i < 2; ++i )
    {
        int chart = results_add_chart( all, text, text, text );
        int series = results_add_series( all, chart, text, true );
        results_chart_at( all, chart )->is_bars = i == 1;
        snprintf( results_chart_at( all, chart )->caption, 400, "%s", text );
        for ( int k = 0; k < 3; ++k )
        {
            results_point point = { .x = k, .y = 1.0 + k, .is_marked = k == 1 };
            snprintf( point.label, sizeof( point.label ), "%s", text );
            results_add_point( all, chart, series, point );
        }
    }
    results_add_picture( all, "no such picture.png", text );
    results_add_note( all, "%s", text );
    results_add_failure( all, "%s", text );
}

// ---- the page ----

TEST( a_page_of_everything_is_whole_and_stands_alone )
{
    results all;
    fill( &all, "quiet" );
    char* page = page_of( &all, &quiet_run );
    assert_well_formed( page );
    assert_stands_alone( page );
    assert_anchors( page );
    assert_non_null( strstr( page, "<h1>a case</h1>" ) );
    free( page );
    results_free( &all );
}

TEST( an_empty_page_is_whole_too )
{
    results all = { .failed = false }; // without a machine: every text of it is null or empty
    char* page = page_of( &all, &( report_run ){ .what = "", .how = "" } );
    assert_well_formed( page );
    assert_non_null( strstr( page, "Nothing failed." ) );
    assert_null( strstr( page, "<h2>" ) );
    free( page );
    results_free( &all );
}

TEST( a_page_of_errors_without_limits_does_not_say_that_nothing_failed )
{
    results all = { .failed = false };
    char* page = page_of( &all, &( report_run ){ .what = "", .how = "", .errors = "2 of 3 come near `theory`." } );
    assert_well_formed( page );
    assert_null( strstr( page, "Nothing failed." ) );
    assert_non_null( strstr( page, "2 of 3 come near <code>theory</code>." ) );
    free( page );
    results_free( &all );
}

// The tags of a page without its text and its values.
static char* skeleton_of( const char* page )
{
    char* bones = malloc( strlen( page ) + 1 );
    char* to = bones;
    assert_non_null( bones );
    for ( const char* at = strchr( page, '<' ); at; at = strchr( at, '<' ) )
    {
        const char* end = skip_name( at + 1 + ( at[1] == '/' ) );
        memcpy( to, at, (size_t)( end - at ) );
        to += end - at;
        at = end;
    }
    *to = '\0';
    return bones;
}

TEST( hostile_names_add_no_tag_and_no_attribute )
{
    results all;
    fill( &all, "quiet" );
    char* page = page_of( &all, &quiet_run );
    char* quiet = skeleton_of( strstr( page, "<figure" ) );
    free( page );
    results_free( &all );
    for ( int i = 0; i < WISP_COUNT( hostile ); ++i )
    {
        fill( &all, hostile[i] );
        page = page_of( &all, &( report_run ){ hostile[i], hostile[i], hostile[i] } );
        assert_well_formed( page );
        assert_stands_alone( page );
        char* bones = skeleton_of( strstr( page, "<figure" ) );
        // the name next to a marked point is drawn where there is room for it
        int names = count_of( page, "class=\"label" );
        assert_int_equal( count_of( bones, "<" ) - 2 * names, count_of( quiet, "<" ) - 2 );
        free( bones );
        free( page );
        results_free( &all );
    }
    free( quiet );
}

TEST( text_is_escaped_and_what_is_no_text_is_replaced )
{
    static const char* const pairs[][2] = {
        { "a<b>&\"c'", "a&lt;b&gt;&amp;&quot;c&#39;" },
        { "caf\xc3\xa9 \xf0\x9f\x8e\x88\ttab", "caf\xc3\xa9 \xf0\x9f\x8e\x88\ttab" },
        { "\xff|\xc3", "\xef\xbf\xbd|\xef\xbf\xbd" },                               // no beginning; cut off
        { "\xc0\xbc", "\xef\xbf\xbd\xef\xbf\xbd" },                                 // '<' in two bytes
        { "\xed\xa0\x80", "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd" },                 // half of a pair
        { "\xf4\x90\x80\x80", "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd" }, // beyond the last
        { "\x1b\x7f\xef\xbf\xbf", "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd" },
    };
    for ( int i = 0; i < WISP_COUNT( pairs ); ++i )
    {
        char text[80] = "";
        FILE* stream = fmemopen( text, sizeof( text ), "w" );
        report_put_text( pairs[i][0], stream );
        fclose( stream );
        assert_string_equal( text, pairs[i][1] );
    }
}

TEST( failures_stand_on_top_and_nowhere_else )
{
    results all = empty_results();
    results_add_table( &all, "numbers", 1, ( const char* const[] ){ "ms" } );
    results_add_note( &all, "A claim is met." );
    results_add_failure( &all, "hash %d differs", 7 );
    char* page = page_of( &all, &quiet_run );
    assert_int_equal( count_of( page, "hash 7 differs" ), 1 );
    assert_true( strstr( page, "hash 7 differs" ) < strstr( page, "<main>" ) );
    assert_non_null( strstr( page, "1 failure." ) );
    assert_null( strstr( page, "Nothing failed." ) );
    assert_true( strstr( page, "A claim is met." ) > strstr( page, "<h2>Notes</h2>" ) );
    free( page );
    results_free( &all );
}

TEST( numbers_stand_right_and_hashes_in_a_face_of_their_own )
{
    results all = empty_results();
    int table = results_add_table( &all, "t", 3, ( const char* const[] ){ "who", "ms", "hash" } );
    results_add_cells( &all, table, ( const char* const[] ){ "wisp", "0.75", "0123456789abcdef" } );
    results_add_cells( &all, table, ( const char* const[] ){ "plain", "-", "-" } );
    char* page = page_of( &all, &quiet_run );
    assert_non_null( strstr( page, "<tr><th scope=\"col\">who</th><th scope=\"col\" class=\"n\">ms</th>" ) );
    assert_non_null(
        strstr( page, "<tr><td>wisp</td><td class=\"n\">0.75</td><td class=\"hash\">0123456789abcdef</td></tr>" ) );
    assert_non_null( strstr( page, "<tr><td>plain</td><td class=\"n\">-</td>" ) );
    free( page );
    results_free( &all );
}

TEST( the_same_results_give_the_same_bytes )
{
    results all;
    fill( &all, "quiet" );
    char* first = page_of( &all, &quiet_run );
    all.machine.mhz += 100.0; // which changes from second to second
    char* second = page_of( &all, &quiet_run );
    assert_string_equal( first, second );
    free( first );
    free( second );
    results_free( &all );
}

TEST( a_decimal_comma_changes_no_byte )
{
    results all;
    fill( &all, "quiet" );
    all.charts[0].series[0].points[1].y = 1.2345;
    char* usual = page_of( &all, &quiet_run );
    static const char* const places[] = { "de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "fr_FR.utf8", "sv_SE.UTF-8" };
    bool is_set = false;
    for ( int i = 0; i < WISP_COUNT( places ) && !is_set; ++i )
    {
        is_set = setlocale( LC_NUMERIC, places[i] ) != NULL;
    }
    char* other = page_of( &all, &quiet_run );
    setlocale( LC_NUMERIC, "C" );
    results_free( &all );
    assert_string_equal( usual, other );
    free( usual );
    free( other );
    if ( !is_set )
    {
        SKIP( "no locale with a decimal comma is installed" );
    }
}

// ---- pictures ----

#define PICTURE_SIZE 3000

// What the page checks of a PNG, with other bytes between.
static size_t make_picture( unsigned char* out, size_t size )
{
    static const unsigned char head[24] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n', 0, 0, 0, 13,
                                            'I',  'H', 'D', 'R', 0,    0,    1,    44,   0, 0, 0, 200 };
    static const unsigned char tail[12] = { 0, 0, 0, 0, 'I', 'E', 'N', 'D', 0xae, 0x42, 0x60, 0x82 };
    for ( size_t i = 0; i < size; ++i )
    {
        out[i] = (unsigned char)( i * i * 2654435761u >> 13 );
    }
    memcpy( out, head, sizeof( head ) );
    memcpy( out + size - sizeof( tail ), tail, sizeof( tail ) );
    return size;
}

TEST( a_picture_is_embedded_byte_by_byte )
{
    for ( size_t more = 0; more < 3; ++more ) // base64 has three kinds of ends
    {
        unsigned char picture[PICTURE_SIZE + 3], decoded[PICTURE_SIZE + 3];
        size_t size = make_picture( picture, PICTURE_SIZE + more );
        write_bytes( "report_picture.png", picture, size );
        results all = empty_results();
        results_add_picture( &all, "./report_picture.png", "A <cloth>" );
        results_add_note( &all, "A cloth: ![A cloth](./report_picture.png)" );
        char* page = page_of( &all, &quiet_run );
        assert_well_formed( page );
        const char* data = strstr( page, "base64," );
        assert_non_null( data );
        assert_int_equal( decode_base64( data + 7, decoded, sizeof( decoded ) ), size );
        assert_memory_equal( decoded, picture, size );
        assert_non_null( strstr( page, "<img width=\"300\" height=\"200\" alt=\"A &lt;cloth&gt;\"" ) );
        // the note would only show a broken link
        assert_null( strstr( page, "![A cloth]" ) );
        free( page );
        results_free( &all );
        remove( "report_picture.png" );
    }
}

static void assert_one_message( const char* path, const char* why )
{
    results all = empty_results();
    results_add_picture( &all, path, "a caption" );
    char* page = page_of( &all, &quiet_run );
    assert_well_formed( page );
    assert_null( strstr( page, "<img" ) );
    assert_int_equal( count_of( page, "cannot be shown" ), 1 );
    assert_non_null( strstr( page, why ) );
    assert_non_null( strstr( page, "a caption" ) );
    free( page );
    results_free( &all );
}

TEST( a_picture_that_cannot_be_read_is_one_message )
{
    unsigned char picture[PICTURE_SIZE];
    size_t size = make_picture( picture, PICTURE_SIZE );
    assert_one_message( "report_missing.png", "The picture report_missing.png cannot be shown: No such file" );
    assert_one_message( "/", "it is not a file" );
    write_bytes( "report_bad.png", "a letter", 8 );
    assert_one_message( "report_bad.png", "it is not a whole PNG" );
    write_bytes( "report_bad.png", picture, size - 1 );
    assert_one_message( "report_bad.png", "it is not a whole PNG" );
    write_bytes( "report_bad.png", "", 0 );
    assert_one_message( "report_bad.png", "it is not a whole PNG" );
    write_bytes( "report_bad.png", picture, size );
    assert_int_equal( truncate( "report_bad.png", ( 16 << 20 ) + 1 ), 0 );
    assert_one_message( "report_bad.png", "it is larger than 16 MB" );
    remove( "report_bad.png" );
    assert_int_equal( mkfifo( "report_bad.png", 0600 ), 0 );
    assert_one_message( "report_bad.png", "it is not a file" ); // and it does not wait for a writer
    remove( "report_bad.png" );
}

// ---- files ----

TEST( a_file_holds_what_a_stream_would )
{
    results all;
    wisp_error error = { 0 };
    fill( &all, "quiet" );
    char* page = page_of( &all, &quiet_run );
    size_t size = strlen( page );
    char* read = calloc( 1, size + 2 );
    assert_int_equal( report_write_file( &all, &quiet_run, "report_whole.html", &error ), WISP_OK );
    FILE* file = fopen( "report_whole.html", "r" );
    assert_true( file && read );
    assert_int_equal( fread( read, 1, size + 1, file ), size );
    assert_string_equal( read, page );
    fclose( file );
    remove( "report_whole.html" );
    free( read );
    free( page );
    results_free( &all );
}

TEST( a_file_that_cannot_be_written_is_an_error_that_names_it )
{
    results all;
    wisp_error error = { 0 };
    fill( &all, "quiet" );
    assert_int_equal( report_write_file( &all, &quiet_run, "no such folder/out.html", &error ), WISP_IO_ERROR );
    assert_non_null( strstr( error.message, "no such folder/out.html" ) );
    if ( access( "/dev/full", W_OK ) == 0 )
    {
        assert_int_equal( report_write_file( &all, &quiet_run, "/dev/full", &error ), WISP_IO_ERROR );
        assert_non_null( strstr( error.message, "/dev/full" ) );
        FILE* full = fopen( "/dev/full", "w" );
        assert_non_null( full );
        assert_int_equal( report_write( &all, &quiet_run, full, &error ), WISP_IO_ERROR );
        fclose( full );
    }
    all.incomplete = true;
    assert_int_equal( report_write_file( &all, &quiet_run, "/dev/null", &error ), WISP_NO_MEMORY );
    results_free( &all );
}
