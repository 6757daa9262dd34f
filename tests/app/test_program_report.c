// The built program, whose path is the first argument, writes a report next to its results, and fails before it
// measures if it cannot.
#include "program_fixture.h"

#include <sys/stat.h>

static char page[4 << 20];

TEST( a_report_is_written_beside_the_usual_output )
{
    run_ok( "bench boundary --quick --seconds 0.01 --workers 1 --report page.html" );
    read_text( "page.html", page, sizeof( page ) );
    assert_memory_equal( page, "<!DOCTYPE html>\n", 16 );
    assert_non_null( strstr( page, "<h1>boundary</h1>" ) );
    assert_non_null( strstr( page, "quick, about 0.01 s per case, up to 1 worker<" ) );
    assert_non_null( strstr( page, "</html>\n" ) );

    // every title of the output is one of the page
    int tables = 0;
    for ( const char* rule = strstr( result.out, "\n---" ); rule; rule = strstr( rule + 1, "\n---" ) )
    {
        ++tables;
    }
    // a table that is too wide for a terminal has further parts there
    for ( const char* part = strstr( result.out, "\n(continued)\n" ); part;
          part = strstr( part + 1, "\n(continued)\n" ) )
    {
        --tables;
    }
    char last[40];
    snprintf( last, sizeof( last ), " id=\"table-%d\"", tables );
    assert_true( tables > 0 );
    assert_non_null( strstr( page, last ) );
}

TEST( a_report_that_cannot_be_written_is_refused_before_anything_is_measured )
{
    assert_int_equal( mkdir( "folder", 0700 ), 0 );
    assert_refused( "bench boundary --quick --seconds 0.01 --report nowhere/page.html",
                    "nowhere/page.html: cannot be written: No such" );
    assert_string_equal( result.out, "" );
    assert_refused( "bench boundary --quick --seconds 0.01 --report folder",
                    "folder: cannot be written: Is a directory" );
    assert_refused( "bench boundary --quick --seconds 0.01 --output nowhere/out.json --format json",
                    "nowhere/out.json" );
    assert_false( exists( "nowhere" ) );
}

TEST( a_report_over_the_output_is_wrong_usage )
{
    assert_usage( "bench boundary --quick --seconds 0.01 --report a.html --output a.html",
                  "--report and --output both write to 'a.html'" );
    assert_false( exists( "a.html" ) );
}

TEST( looking_whether_a_file_can_be_written_leaves_it_as_it_was )
{
    write_text( "kept.html", "a page of last week" );
    assert_refused( "bench boundary --quick --seconds 0.01 --report kept.html --output nowhere/out.txt",
                    "nowhere/out.txt" );
    read_text( "kept.html", page, sizeof( page ) );
    assert_string_equal( page, "a page of last week" );
    assert_refused( "bench boundary --quick --seconds 0.01 --output new.txt --report nowhere/page.html",
                    "nowhere/page.html" );
    assert_false( exists( "new.txt" ) );
}

TEST( a_disk_that_fills_up_is_a_failed_run )
{
    if ( access( "/dev/full", W_OK ) != 0 )
    {
        SKIP( "there is no /dev/full" );
    }
    run( "bench boundary --quick --seconds 0.01 --workers 1 --report /dev/full" );
    assert_int_equal( result.status, 2 );
    assert_int_equal( line_count( result.err ), 1 );
    assert_non_null( strstr( result.err, "/dev/full: the report could not be written" ) );
    // the results themselves are printed already
    assert_non_null( strstr( result.out, "\n---" ) );
}

TEST( help_tells_of_the_report )
{
    run_ok( "bench --help" );
    assert_non_null( strstr( result.out, "--report=FILE" ) );
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_new_folder, leave_folder )
