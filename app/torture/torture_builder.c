#include "torture_builder.h"

#include <string.h>

torture_block torture_entry_block( const char* list, const text_node* entry )
{
    return torture_block_below( torture_block_of_scene(), list, entry );
}

text_node* torture_put_block( torture_builder* b, torture_block outer, text_node* map, const char* key, int percent )
{
    text_node* block = text_put( map, key, text_map() );
    torture_draw_keys( &b->random, torture_block_below( outer, key, block ), percent, block );
    return block;
}

text_node* torture_put_linear( torture_builder* b, text_node* map, const char* key, double lower, double upper )
{
    return text_put( map, key, text_scalar( "%s", torture_random_linear( &b->random, lower, upper ).text ) );
}

text_node* torture_put_log( torture_builder* b, text_node* map, const char* key, double lower, double upper )
{
    return text_put( map, key, text_scalar( "%s", torture_random_log( &b->random, lower, upper ).text ) );
}

text_node* torture_put_vector( torture_builder* b, text_node* map, const char* key, const double lower[3],
                               const double upper[3] )
{
    text_node* list = text_put( map, key, text_list() );
    for ( int i = 0; i < 3; ++i )
    {
        text_add( list, text_scalar( "%s", torture_random_linear( &b->random, lower[i], upper[i] ).text ) );
    }
    return list;
}

static void put_rotation( torture_builder* b, text_node* map, const char* key )
{
    text_node* rotation = text_put( map, key, text_map() );
    torture_put_vector( b, rotation, "degrees", ( const double[] ){ -180, -180, -180 },
                        ( const double[] ){ 180, 180, 180 } );
}

text_node* torture_put_keyframes( torture_builder* b, text_node* map, const char* key, const char* position,
                                  const char* rotation, const double centre[3] )
{
    const double REACH = 0.3;
    const int count = torture_random_whole( &b->random, 1, 4 );
    const double lower[3] = { centre[0] - REACH, centre[1] - REACH, centre[2] - REACH };
    const double upper[3] = { centre[0] + REACH, centre[1] + REACH, centre[2] + REACH };
    text_node* list = text_put( map, key, text_list() );
    double time = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        text_node* keyframe = text_add( list, text_map() );
        // Cloth that collapses in a jump touches itself everywhere, and a step of it costs a thousand times as much.
        const bool is_jump = torture_random_chance( &b->random, b->has_contact ? 2 : 15 );
        time += is_jump ? 0.001 : 0.05 * torture_random_whole( &b->random, 1, 8 );
        text_put( keyframe, "time", text_scalar( "%.5g", time ) );
        torture_put_vector( b, keyframe, position, lower, upper );
        if ( torture_random_chance( &b->random, 40 ) )
        {
            put_rotation( b, keyframe, rotation );
        }
    }
    return list;
}

// Words of the shapes in the order of the reader; closed ones come last but for the tube.
void torture_put_mesh( torture_builder* b, torture_block block, text_node* entry, bool is_closed )
{
    static const char* const closed[] = { "icosphere", "uv_sphere", "torus", "capsule", "pear" };
    static const char* const open[] = { "plane",   "plane", "alternating_plane", "irregular_plane", "delaunay",
                                        "garment", "tube" };
    const torture_generator* g = b->generator;
    if ( g->mesh_count > 0 && torture_random_chance( &b->random, 30 ) )
    {
        text_put( entry, "file",
                  text_scalar( "%s", g->meshes[torture_random_whole( &b->random, 0, g->mesh_count - 1 )] ) );
        return;
    }
    const bool takes_closed = is_closed || torture_random_chance( &b->random, 15 );
    text_node* generate = text_put( entry, "generate", text_map() );
    const char* shape = takes_closed ? closed[torture_random_whole( &b->random, 0, WISP_COUNT( closed ) - 1 )]
                                     : open[torture_random_whole( &b->random, 0, WISP_COUNT( open ) - 1 )];
    text_put( generate, "shape", text_scalar( "%s", shape ) );
    const torture_block table = torture_block_below( block, "generate", generate );
    if ( strcmp( shape, "torus" ) == 0 )
    {
        torture_put_linear( b, generate, "radius", 0.1, 0.2 );
        torture_put_linear( b, generate, "tube_radius", 0.03, 0.08 );
    }
    const bool is_by_count = strcmp( shape, "delaunay" ) == 0 || strcmp( shape, "garment" ) == 0;
    if ( is_by_count )
    {
        text_put( generate, "vertices", text_scalar( "%d", torture_random_whole( &b->random, 64, 160 ) ) );
    }
    torture_draw_keys( &b->random, table, 100, generate );
}
