#include "frozen_hair_scenes.h"

#include "wisp/module/random.h"

#include <stdlib.h>
#include <string.h>

static const double two_pi = 6.28318530717958647692;

static bool allocate( frozen_scene* scene, int strand_count, int vertex_count )
{
    size_t strands = (size_t)strand_count, vertices = (size_t)vertex_count;
    scene->vertex_count = vertex_count;
    scene->offsets = calloc( strands + 1, sizeof( int ) );
    scene->rest = calloc( vertices + 1, sizeof( double3 ) );
    scene->stretch_stiffness = calloc( strands + 1, sizeof( double ) );
    scene->bend_stiffness = calloc( strands + 1, sizeof( double ) );
    scene->intensity = calloc( strands + 1, sizeof( double ) );
    if ( scene->offsets == NULL || scene->rest == NULL || scene->stretch_stiffness == NULL ||
         scene->bend_stiffness == NULL || scene->intensity == NULL )
    {
        frozen_scene_destroy( scene );
        return false;
    }
    for ( int s = 0; s < strand_count; ++s )
    {
        scene->stretch_stiffness[s] = 7.0;
        scene->bend_stiffness[s] = 7.0;
        scene->intensity[s] = 0.8;
    }
    scene->hair = ( frozen_oracle_hair ){
        .strand_count = strand_count,
        .offsets = scene->offsets,
        .rest = scene->rest,
        .stretch_stiffness = scene->stretch_stiffness,
        .bend_stiffness = scene->bend_stiffness,
        .intensity = scene->intensity,
    };
    return true;
}

static double3 round_to_float( double3 p )
{
    return double3_make( (float)p.x, (float)p.y, (float)p.z );
}

// Vertex i of a strand, relative to its root. Straight hair is made of multiples of 2^-10 m, and 2, 6, 3 have the
// whole-number length 7, so that all its tangents are the same bits in any precision.
static double3 offset_from_root( frozen_scene_shape shape, int dimension, double phase, double heading, int i )
{
    const double unit = 0x1p-10;
    double turn = phase + i * two_pi / 5.0;
    if ( shape == FROZEN_SCENE_STRAIGHT )
    {
        double3 step = dimension == 2 ? double3_make( 0.0, -7.0, 0.0 ) : double3_make( 2.0, -6.0, 3.0 );
        return double3_scale( i * unit, step );
    }
    if ( shape == FROZEN_SCENE_WAVY )
    {
        double swing = 3.0 * unit * ( sin( turn ) - sin( phase ) );
        double depth = dimension == 2 ? 0.0 : swing * sin( heading );
        return double3_make( dimension == 2 ? swing : swing * cos( heading ), -i * 7.0 * unit, depth );
    }
    double across = 4.0 * unit * ( cos( turn ) - cos( phase ) );
    double along = 4.0 * unit * ( sin( turn ) - sin( phase ) );
    // loops in the plane fall more slowly than they turn, so that no two neighbouring segments are collinear
    double fall = -i * ( dimension == 2 ? 2.0 : 4.0 ) * unit;
    return dimension == 2 ? double3_make( across, fall + along, 0.0 ) : double3_make( across, fall, along );
}

bool frozen_scene_create( frozen_scene* scene, frozen_scene_shape shape, int dimension, int strand_count,
                          int vertices_per_strand, double spacing )
{
    if ( !allocate( scene, strand_count, strand_count * vertices_per_strand ) )
    {
        return false;
    }
    wisp_random_key key = wisp_random_make_key( 2024, 0, 0 );
    int side = dimension == 2 ? strand_count : (int)ceil( sqrt( strand_count ) );
    double grid = floor( spacing * 0x1p14 + 0.5 ) * 0x1p-14;
    for ( int s = 0; s < strand_count; ++s )
    {
        // a little freedom, small enough that no bend of a wave is nearly straight
        double phase = 0.3 + 0.2 * ( wisp_random_unit( key, (uint32_t)s, 0, 0 ) - 0.5 );
        double heading = two_pi * wisp_random_unit( key, (uint32_t)s, 1, 0 );
        double3 root = double3_make( grid * ( s % side ), 0.0, dimension == 2 ? 0.0 : grid * ( s / side ) );
        scene->offsets[s + 1] = ( s + 1 ) * vertices_per_strand;
        for ( int i = 0; i < vertices_per_strand; ++i )
        {
            double3 offset = offset_from_root( shape, dimension, phase, heading, i );
            scene->rest[s * vertices_per_strand + i] = round_to_float( double3_add( root, offset ) );
        }
    }
    return true;
}

void frozen_scene_destroy( frozen_scene* scene )
{
    free( scene->offsets );
    free( scene->rest );
    free( scene->stretch_stiffness );
    free( scene->bend_stiffness );
    free( scene->intensity );
    memset( scene, 0, sizeof( *scene ) );
}
