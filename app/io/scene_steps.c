// Lengths of steps: all `dt`, or `dt` times factors that repeat.
#include "scene_parts.h"
#include "scene_ranges.h"

#include <math.h>

wisp_status scene_read_dt_factors( scene_reader* r, const scene_node* node, void* at )
{
    static const scene_field factor = { "factor", SCENE_NUMBER, .range = DT_FACTOR };
    wisp_scene* scene = at;
    void* items;
    wisp_status status =
        scene_begin_list( r, node, "a list of numbers", WISP_SCENE_MAX_DT_FACTORS, sizeof( float ), &items );
    if ( !status && node->count == 0 )
    {
        return scene_refuse_node( r, node, "got an empty list, expected numbers" );
    }
    scene->dt_factors = items;
    scene->dt_factor_count = node->count;
    return status ? status : scene_read_numbers( r, node, &factor, items );
}

float wisp_scene_step_length( const wisp_scene* scene, int step )
{
    return scene->dt_factor_count > 0 ? scene->dt * scene->dt_factors[step % scene->dt_factor_count] : scene->dt;
}

// Return the sum of the lengths of the first steps of a round.
static double sum_of( const wisp_scene* scene, int steps )
{
    double sum = 0.0;
    for ( int i = 0; i < steps; ++i )
    {
        sum += (double)wisp_scene_step_length( scene, i );
    }
    return sum;
}

double wisp_scene_step_time( const wisp_scene* scene, int step )
{
    const int count = scene->dt_factor_count;
    if ( count == 0 )
    {
        return (double)step * (double)scene->dt;
    }
    return ( step / count ) * sum_of( scene, count ) + sum_of( scene, step % count );
}

// A time is written in decimals, and a step may be 1/60 s: what is within a thousandth of a step is meant to be the same.
double wisp_scene_step_at( const wisp_scene* scene, float time )
{
    const int count = scene->dt_factor_count;
    if ( count == 0 )
    {
        return fmax( 0.0, ceil( (double)time / (double)scene->dt - 1e-3 ) );
    }
    const double target = (double)time - 1e-3 * (double)scene->dt, round = sum_of( scene, count );
    const double rounds = fmax( 0.0, floor( target / round ) );
    int step = 0;
    while ( step < count && rounds * round + sum_of( scene, step ) < target )
    {
        ++step;
    }
    return rounds * count + step;
}

void wisp_scene_refine( wisp_scene* scene, int factor )
{
    scene->substeps *= factor;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        scene->surfaces[i].substeps *= factor;
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        scene->strands[i].substeps *= factor;
    }
}

int wisp_scene_own_substeps( const wisp_scene* scene )
{
    int most = 0;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        most = scene->surfaces[i].substeps > most ? scene->surfaces[i].substeps : most;
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        most = scene->strands[i].substeps > most ? scene->strands[i].substeps : most;
    }
    return most;
}
