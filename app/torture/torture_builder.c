#include "torture_builder.h"

#include <string.h>

torture_block torture_entry_block( const char* list, const torture_node* entry )
{
    return torture_block_below( torture_block_of_scene(), list, entry );
}

torture_node* torture_put_block( torture_builder* b, torture_block outer, torture_node* map, const char* key,
                                 int percent )
{
    torture_node* block = torture_put( map, key, torture_map() );
    torture_draw_keys( &b->random, torture_block_below( outer, key, block ), percent, block );
    return block;
}

torture_node* torture_put_linear( torture_builder* b, torture_node* map, const char* key, double lower, double upper )
{
    return torture_put( map, key, torture_scalar( "%s", torture_random_linear( &b->random, lower, upper ).text ) );
}

torture_node* torture_put_log( torture_builder* b, torture_node* map, const char* key, double lower, double upper )
{
    return torture_put( map, key, torture_scalar( "%s", torture_random_log( &b->random, lower, upper ).text ) );
}

torture_node* torture_put_vector( torture_builder* b, torture_node* map, const char* key, const double lower[3],
                                  const double upper[3] )
{
    torture_node* list = torture_put( map, key, torture_list() );
    for ( int i = 0; i < 3; ++i )
    {
        torture_add( list, torture_scalar( "%s", torture_random_linear( &b->random, lower[i], upper[i] ).text ) );
    }
    return list;
}

static void put_rotation( torture_builder* b, torture_node* map, const char* key )
{
    torture_node* rotation = torture_put( map, key, torture_map() );
    torture_put_vector( b, rotation, "degrees", ( const double[] ){ -180, -180, -180 },
                        ( const double[] ){ 180, 180, 180 } );
}

torture_node* torture_put_keyframes( torture_builder* b, torture_node* map, const char* key, const char* position,
                                     const char* rotation, const double centre[3] )
{
    const double REACH = 0.3;
    const int count = torture_random_whole( &b->random, 1, 4 );
    const double lower[3] = { centre[0] - REACH, centre[1] - REACH, centre[2] - REACH };
    const double upper[3] = { centre[0] + REACH, centre[1] + REACH, centre[2] + REACH };
    torture_node* list = torture_put( map, key, torture_list() );
    double time = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        torture_node* keyframe = torture_add( list, torture_map() );
        // Cloth that collapses in a jump touches itself everywhere, and a step of it costs a thousand times as much.
        const bool is_jump = torture_random_chance( &b->random, b->has_contact ? 2 : 15 );
        time += is_jump ? 0.001 : 0.05 * torture_random_whole( &b->random, 1, 8 );
        torture_put( keyframe, "time", torture_scalar( "%.5g", time ) );
        torture_put_vector( b, keyframe, position, lower, upper );
        if ( torture_random_chance( &b->random, 40 ) )
        {
            put_rotation( b, keyframe, rotation );
        }
    }
    return list;
}

// Words of the shapes in the order of the reader; closed ones come last but for the tube.
void torture_put_mesh( torture_builder* b, torture_block block, torture_node* entry, bool is_closed )
{
    static const char* const closed[] = { "icosphere", "uv_sphere", "torus", "capsule", "pear" };
    static const char* const open[] = { "plane",   "plane", "alternating_plane", "irregular_plane", "delaunay",
                                        "garment", "tube" };
    const torture_generator* g = b->generator;
    if ( g->mesh_count > 0 && torture_random_chance( &b->random, 30 ) )
    {
        torture_put( entry, "file",
                     torture_scalar( "%s", g->meshes[torture_random_whole( &b->random, 0, g->mesh_count - 1 )] ) );
        return;
    }
    const bool takes_closed = is_closed || torture_random_chance( &b->random, 15 );
    torture_node* generate = torture_put( entry, "generate", torture_map() );
    const char* shape = takes_closed ? closed[torture_random_whole( &b->random, 0, WISP_COUNT( closed ) - 1 )]
                                     : open[torture_random_whole( &b->random, 0, WISP_COUNT( open ) - 1 )];
    torture_put( generate, "shape", torture_scalar( "%s", shape ) );
    const torture_block table = torture_block_below( block, "generate", generate );
    if ( strcmp( shape, "torus" ) == 0 )
    {
        torture_put_linear( b, generate, "radius", 0.1, 0.2 );
        torture_put_linear( b, generate, "tube_radius", 0.03, 0.08 );
    }
    const bool is_by_count = strcmp( shape, "delaunay" ) == 0 || strcmp( shape, "garment" ) == 0;
    if ( is_by_count )
    {
        torture_put( generate, "vertices", torture_scalar( "%d", torture_random_whole( &b->random, 64, 160 ) ) );
    }
    torture_draw_keys( &b->random, table, 100, generate );
}
