// Any bytes as a suite: refused with one message, or rows whose scenes can be read.
#include "fuzz.h"

#include "suite.h"

static void demand_row( const suite_row* row )
{
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    demand( memchr( row->name, 0, sizeof row->name ) && memchr( row->variant, 0, sizeof row->variant ) );
    demand( suite_scene( row, &scene, &error ) == WISP_OK && row->steps >= 0 );
    for ( int m = 0; m < SUITE_MEASURE_COUNT; ++m )
    {
        demand( row->budgets[m].relative >= 0.0 && row->budgets[m].absolute >= 0.0 );
    }
    wisp_scene_release( &scene );
}

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size )
{
    wisp_suite suite;
    wisp_error error = { .status = WISP_OK };
    const wisp_status status =
        suite_parse( (const char*)data, size, WISP_SOURCE_ROOT "/tests/bad/suite/fuzz.yaml", NULL, &suite, &error );
    if ( status != WISP_OK )
    {
        demand( error.status == status && error.message[0] != 0 );
    }
    else
    {
        demand( suite.row_count > 0 && suite.row_count <= SUITE_MAX_ROWS );
        demand_row( suite.rows );
        demand_row( suite.rows + suite.row_count - 1 );
    }
    suite_release( &suite );
    return 0;
}
