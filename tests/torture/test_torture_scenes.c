// Scenes that broke once and hold now: every file of the folder, with all twins.
#define _XOPEN_SOURCE 700

#include "torture_fixture.h"

#include "files.h"

#include <glob.h>

TEST( scenes_that_broke_once_hold )
{
    glob_t found;
    assert_int_equal( glob( WISP_SOURCE_ROOT "/tests/torture/*.yaml", 0, NULL, &found ), 0 );
    int broken = 0;
    for ( size_t i = 0; i < found.gl_pathc; ++i )
    {
        size_t size = 0;
        char* text = read_bytes( found.gl_pathv[i], &size );
        const stability_verdict verdict = judge_text( text, TORTURE_TWIN_ALL );
        if ( verdict.check != STABILITY_HOLDS )
        {
            print_error( "%s: %s: %s\n", found.gl_pathv[i], stability_check_names[verdict.check], verdict.message );
            ++broken;
        }
        free( text );
    }
    globfree( &found );
    assert_int_equal( broken, 0 );
}
