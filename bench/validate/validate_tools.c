#include "validate_tools.h"

#include "accuracy/scene_tools.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- settings ----

static accuracy_setting* put( const validate_grid* grid, validate_way way, validate_way* ways, accuracy_scene* out )
{
    ways[out->setting_count] = way;
    return accuracy_put_setting( out, "%s, %d cells, %d substeps", grid->names[way.method], way.cells, way.substeps );
}

void validate_put_settings( const validate_grid* grid, validate_way* ways, accuracy_scene* out )
{
    for ( int m = 0; m < grid->method_count; ++m )
    {
        const int method = grid->methods[m];
        char series[64];
        snprintf( series, sizeof series, "%s by cells", grid->names[method] );
        for ( int i = 0; i < grid->cell_count; ++i )
        {
            const validate_way way = { method, grid->cells[i], grid->substeps };
            accuracy_join_series( put( grid, way, ways, out ), series, "cell / L", 1.0 / grid->cells[i], NAN );
        }
        snprintf( series, sizeof series, "%s by substeps", grid->names[method] );
        for ( int i = 1; i <= grid->halvings; ++i )
        {
            const validate_way way = { method, grid->middle, grid->substeps >> i };
            accuracy_join_series( put( grid, way, ways, out ), series, "substep, s", VALIDATE_SECONDS / way.substeps,
                                  NAN );
        }
    }
}

wisp_status validate_make( const accuracy_scene* scene, const void* like, size_t size, accuracy_scene* out,
                           wisp_error* error )
{
    *out = *scene;
    out->context = malloc( size );
    out->destroy = free;
    const wisp_status status = out->context != NULL ? accuracy_reserve_settings( out, VALIDATE_MAX_SETTINGS, error )
                                                    : wisp_fail( error, WISP_NO_MEMORY, "no memory for a case" );
    if ( status != WISP_OK )
    {
        return accuracy_abandon( out, status );
    }
    memcpy( out->context, like, size );
    return WISP_OK;
}

wisp_status validate_make_grid( const accuracy_scene* scene, const validate_grid* grid, accuracy_scene* out,
                                wisp_error* error )
{
    const validate_way none[VALIDATE_MAX_SETTINGS] = { { 0 } };
    const wisp_status status = validate_make( scene, none, sizeof none, out, error );
    if ( status == WISP_OK )
    {
        validate_put_settings( grid, out->context, out );
    }
    return status;
}

const validate_way* validate_way_of( const void* context, int setting )
{
    return (const validate_way*)context + setting;
}

// ---- ladders ----

double validate_rung( int i )
{
    return 0.7 + 2.0 * VALIDATE_RUNG * i;
}

double validate_measure_ladder( const bool* has_lost, double critical, double measures[2] )
{
    int first = 0;
    while ( first < VALIDATE_LADDER && !has_lost[first] )
    {
        ++first;
    }
    const bool is_beyond = first == 0 || first == VALIDATE_LADDER;
    const double lost_at = is_beyond ? NAN : validate_rung( first ) - VALIDATE_RUNG;
    measures[0] = lost_at * critical;
    measures[1] = critical;
    return 100.0 * ( is_beyond ? 0.3 : fabs( lost_at - 1.0 ) );
}
