// The report: for any content of the results, the page is complete and self-contained, and contains nothing else. Its
// charts are data of a script and, without it, tables. web/tests/report_layout.test.mjs covers what the script draws.
#include "files.h"
#include "unit.h"

#include "report.h"
#include "report_data.h"

#include <jansson.h>
#include <locale.h>
#include <sys/stat.h>

static const report_run quiet_run = { .what = "a case", .how = "quick" };

// The page of some results, to be freed. Never inlined, because gcc 12 would mistake the stream's text for the
// variable that points to it, and warn at its end.
static __attribute__( ( noinline ) ) char* page_of( const results* all, const report_run* run )
{
    char* text = NULL;
    size_t size = 0;
    FILE* stream = open_memstream( &text, &size );
    wisp_error error = { 0 };
    assert_non_null( stream );
    assert_int_equal( report_write( all, run, stream, &error ), WISP_OK );
    fclose( stream );
    assert_int_equal( strlen( text ), size );
    return text;
}

static results empty_results( void )
{
    return ( results ){ .machine = machine_describe( "avx2" ) };
}

static int count_of( const char* page, const char* text )
{
    int count = 0;
    for ( const char* at = strstr( page, text ); at; at = strstr( at + 1, text ) )
    {
        ++count;
    }
    return count;
}

// ---- tags ----

#define DEPTH_MAX 64

// Every tag is closed in the right order. Scripts and styles have no tags.
static void assert_whole( const char* page )
{
    const char* open[DEPTH_MAX];
    int depth = 0;
    for ( const char* at = strchr( page, '<' ); at; at = strchr( at + 1, '<' ) )
    {
        const char* name = at + 1 + ( at[1] == '/' );
        const char* end = strchr( name, '>' );
        const size_t length = strcspn( name, " />" );
        assert_non_null( end );
        if ( at[1] == '!' || end[-1] == '/' )
        {
            continue;
        }
        if ( at[1] != '/' )
        {
            assert_true( depth < DEPTH_MAX );
            open[depth++] = name;
            const char* const foreign = strncmp( name, "script", length ) == 0  ? "</script>"
                                        : strncmp( name, "style", length ) == 0 ? "</style>"
                                                                                : NULL;
            at = foreign ? strstr( end, foreign ) - 1 : at;
            continue;
        }
        const char* begun = depth > 0 ? open[--depth] : "nothing";
        if ( strncmp( begun, name, length ) != 0 || strcspn( begun, " />" ) != length )
        {
            fail_msg( "<%.30s ends with </%.30s", begun, name );
        }
    }
    assert_int_equal( depth, 0 );
}

// Needs no network.
static void assert_stands_alone( const char* page )
{
    static const char* const foreign[] = { "http:", "https:", "<link", "<iframe", "url(", "@import", "javascript:" };
    for ( int i = 0; i < WISP_COUNT( foreign ); ++i )
    {
        assert_null( strstr( page, foreign[i] ) );
    }
    assert_null( strstr( page, "src=\"" ) );
    assert_non_null( strstr( page, "content=\"default-src 'none'; img-src data:;" ) );
}

#define DATA_BEGIN "<script type=\"application/json\" id=\"chart-data\">"

// Cut the data of the charts out of a page. @return it, to be released
static json_t* take_charts( char* page )
{
    char* begin = strstr( page, DATA_BEGIN );
    assert_non_null( begin );
    begin += strlen( DATA_BEGIN );
    char* end = strchr( begin, '<' );
    json_t* charts = json_loadb( begin, (size_t)( end - begin ), 0, NULL );
    assert_non_null( charts );
    memmove( begin, end, strlen( end ) + 1 );
    return charts;
}

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
    results_add_note( all, "%s", text );
    results_add_failure( all, "%s", text );
}

// ---- the page ----

TEST( a_page_of_everything_is_whole_and_stands_alone )
{
    results all;
    fill( &all, "quiet" );
    char* page = page_of( &all, &quiet_run );
    assert_whole( page );
    assert_stands_alone( page );
    assert_non_null( strstr( page, "<h1>a case</h1>" ) );
    free( page );
    results_free( &all );
}

TEST( an_empty_page_is_whole_too )
{
    results all = { .failed = false }; // without a machine: every text of it is null or empty
    char* page = page_of( &all, &( report_run ){ .what = "", .how = "" } );
    assert_whole( page );
    assert_non_null( strstr( page, "Nothing failed." ) );
    assert_null( strstr( page, "<h2>" ) );
    free( page );
    results_free( &all );
}

TEST( a_page_of_errors_without_limits_does_not_say_that_nothing_failed )
{
    results all = { .failed = false };
    char* page = page_of( &all, &( report_run ){ .what = "", .how = "", .errors = "2 of 3 come near `theory`." } );
    assert_whole( page );
    assert_null( strstr( page, "Nothing failed." ) );
    assert_non_null( strstr( page, "2 of 3 come near <code>theory</code>." ) );
    free( page );
    results_free( &all );
}

// A mark counts the same on every page with the same parts, since text has none.
static void count_marks( const char* page, int counts[4] )
{
    static const char* const marks[] = { "<", ">", "\"", "'" };
    for ( int i = 0; i < 4; ++i )
    {
        counts[i] = count_of( page, marks[i] );
    }
}

TEST( hostile_names_add_no_tag_and_no_attribute )
{
    results all;
    int quiet[4], counts[4];
    fill( &all, "quiet" );
    char* page = page_of( &all, &( report_run ){ "quiet", "quiet", "quiet" } );
    json_decref( take_charts( page ) );
    count_marks( page, quiet );
    free( page );
    results_free( &all );
    for ( int i = 0; i < WISP_COUNT( hostile ); ++i )
    {
        fill( &all, hostile[i] );
        page = page_of( &all, &( report_run ){ hostile[i], hostile[i], hostile[i] } );
        json_t* charts = take_charts( page );
        const json_t* title = json_object_get( json_array_get( charts, 0 ), "title" );
        const bool is_utf8 = hostile[i][0] != '\xff';
        assert_string_equal( json_string_value( title ), is_utf8 ? hostile[i] : "(not UTF-8)" );
        assert_whole( page );
        assert_stands_alone( page );
        count_marks( page, counts );
        assert_memory_equal( counts, quiet, sizeof counts );
        json_decref( charts );
        free( page );
        results_free( &all );
    }
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

// ---- charts ----

static double number_at( const json_t* point, const char* name )
{
    return json_number_value( json_object_get( point, name ) );
}

TEST( the_data_of_a_chart_has_its_series_points_and_axes )
{
    static const double y[] = { 0.1, 1e-300, NAN, 12345.0 };
    results all = empty_results();
    const int chart = results_add_chart( &all, "Time", "strands", "ms" );
    results_add_series( &all, chart, "theirs", false );
    const int ours = results_add_series( &all, chart, "ours", true );
    for ( int i = 0; i < WISP_COUNT( y ); ++i )
    {
        results_add_point( &all, chart, ours,
                           ( results_point ){ .x = i + 0.5, .y = y[i], .is_marked = i == 1, .label = "</script>" } );
    }
    results_chart_at( &all, chart )->y_log = true;
    char* page = page_of( &all, &quiet_run );
    json_t* charts = take_charts( page );
    const json_t* data = json_array_get( charts, 0 );
    assert_int_equal( json_array_size( charts ), 1 );
    assert_string_equal( json_string_value( json_object_get( data, "title" ) ), "Time" );
    assert_string_equal( json_string_value( json_object_get( data, "x" ) ), "strands" );
    assert_string_equal( json_string_value( json_object_get( data, "y" ) ), "ms" );
    assert_true( json_is_false( json_object_get( data, "xLog" ) ) &&
                 json_is_true( json_object_get( data, "yLog" ) ) );
    assert_true( json_is_false( json_object_get( data, "bars" ) ) );
    const json_t* series = json_object_get( data, "series" );
    assert_int_equal( json_array_size( series ), 2 );
    assert_true( json_is_false( json_object_get( json_array_get( series, 0 ), "joined" ) ) );
    series = json_array_get( series, 1 );
    assert_string_equal( json_string_value( json_object_get( series, "name" ) ), "ours" );
    assert_true( json_is_true( json_object_get( series, "joined" ) ) );
    const json_t* points = json_object_get( series, "points" );
    assert_int_equal( json_array_size( points ), WISP_COUNT( y ) );
    for ( int i = 0; i < WISP_COUNT( y ); ++i )
    {
        const json_t* point = json_array_get( points, (size_t)i );
        assert_true( number_at( point, "x" ) == i + 0.5 );
        assert_true( isnan( y[i] ) ? json_is_null( json_object_get( point, "y" ) )
                                   : fabs( number_at( point, "y" ) - y[i] ) <= 1e-8 * y[i] );
        assert_string_equal( json_string_value( json_object_get( point, "label" ) ), "</script>" );
        assert_true( json_is_true( json_object_get( point, "marked" ) ) == ( i == 1 ) );
    }
    json_decref( charts );
    free( page );
    results_free( &all );
}

TEST( a_chart_is_a_table_without_script )
{
    results all = empty_results();
    for ( int bars = 0; bars < 2; ++bars )
    {
        const int chart = results_add_chart( &all, "Time", "strands & more", "ms" );
        const int series = results_add_series( &all, chart, "a < b", true );
        results_chart_at( &all, chart )->is_bars = bars == 1;
        results_add_point( &all, chart, series,
                           ( results_point ){ .x = 2000.0, .y = 0.0123456, .label = "tethers" } );
        results_add_point( &all, chart, series, ( results_point ){ .x = 1.0, .y = NAN } );
    }
    char* page = page_of( &all, &quiet_run );
    assert_int_equal( count_of( page, "<noscript>" ), 2 );
    assert_int_equal( count_of( page, "<th scope=\"col\" class=\"n\">strands &amp; more</th></tr>" ), 1 );
    assert_int_equal( count_of( page, "<tr><td>a &lt; b</td><td>tethers</td><td class=\"n\">0.01235</td>" ), 2 );
    assert_int_equal( count_of( page, "<td class=\"n\">0.01235</td><td class=\"n\">2000</td></tr>" ), 1 );
    assert_int_equal( count_of( page, "<tr><td>a &lt; b</td><td></td><td class=\"n\">-</td></tr>" ), 1 );
    free( page );
    results_free( &all );
}

TEST( a_page_without_charts_has_no_data_of_charts )
{
    results all = empty_results();
    results_add_table( &all, "numbers", 1, ( const char* const[] ){ "ms" } );
    char* page = page_of( &all, &quiet_run );
    assert_whole( page );
    assert_null( strstr( page, DATA_BEGIN ) );
    assert_null( strstr( page, "<noscript>" ) );
    free( page );
    results_free( &all );
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
