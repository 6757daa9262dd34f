#include "torture_generate.h"

#include "torture_judges.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- pieces ----

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

// ---- the scene ----

static torture_node* make_steps( torture_builder* b, torture_node* scene )
{
    static const char* const lengths[] = { "0.004", "0.008", "0.0166667", "0.0166667", "0.0166667", "0.033", "0.05" };
    static const char* const substeps[] = { "2", "4", "5", "8", "10", "10", "10", "16", "20" };
    const double seconds = torture_random_whole( &b->random, 2, 5 );
    const char* dt = lengths[torture_random_whole( &b->random, 0, WISP_COUNT( lengths ) - 1 )];
    const int MOST = b->has_contact ? 150 : 240; // contact is what costs most
    const int steps = (int)( seconds / strtod( dt, NULL ) );
    b->steps = steps < MOST ? steps : MOST;
    torture_put( scene, "dt", torture_scalar( "%s", dt ) );
    if ( torture_random_chance( &b->random, 25 ) )
    {
        torture_node* factors = torture_put( scene, "dt_factors", torture_list() );
        for ( int i = torture_random_whole( &b->random, 2, 7 ); i > 0; --i )
        {
            torture_add( factors, torture_scalar( "%s", torture_random_log( &b->random, 0.1, 3.0 ).text ) );
        }
    }
    torture_put( scene, "steps", torture_scalar( "%d", b->steps ) );
    torture_put(
        scene, "substeps",
        torture_scalar( "%s", substeps[torture_random_whole( &b->random, 0, WISP_COUNT( substeps ) - 1 )] ) );
    if ( torture_random_chance( &b->random, 25 ) )
    {
        torture_put( scene, "iterations", torture_scalar( "%d", torture_random_whole( &b->random, 1, 4 ) ) );
    }
    return scene;
}

static void make_world( torture_builder* b, torture_node* scene )
{
    if ( torture_random_chance( &b->random, 20 ) )
    {
        torture_put_vector( b, scene, "gravity", ( const double[] ){ -4, -20, -4 }, ( const double[] ){ 4, 0, 4 } );
    }
    if ( b->has_contact && torture_random_chance( &b->random, 40 ) )
    {
        torture_node* contact = torture_put_block( b, torture_block_of_scene(), scene, "contact", 30 );
        const bool are_particles = strcmp( torture_text_at( contact, "primitives" ), "particles" ) == 0;
        torture_remove_key( contact, are_particles ? "displacement_limit" : "particle_spacing" );
        // By default they are as far apart as the smallest thickness, which makes ten thousands of them.
        if ( are_particles )
        {
            torture_put_linear( b, contact, "particle_spacing", 0.01, 0.03 );
        }
    }
}

// Lists that nothing is in are not written.
static void take_list( torture_node* scene, const char* key, torture_node* list )
{
    if ( list->count > 0 )
    {
        torture_put( scene, key, list );
    }
    else
    {
        torture_release( list );
    }
}

torture_node* torture_generate( const torture_generator* generator, int number )
{
    torture_builder b = { .random = torture_random_start( generator->seed, (uint64_t)number ),
                          .generator = generator,
                          .surfaces = torture_list(),
                          .strands = torture_list(),
                          .colliders = torture_list(),
                          .events = torture_list(),
                          .hair_events = torture_list() };
    torture_node* scene = torture_map();
    torture_put( scene, "wisp", torture_scalar( "1" ) );
    b.is_stack = torture_random_chance( &b.random, 8 );
    b.has_contact = b.is_stack || torture_random_chance( &b.random, 45 );
    make_steps( &b, scene );
    make_world( &b, scene );
    const int surfaces = torture_random_whole( &b.random, b.is_stack ? 2 : 0, 3 );
    const int strands = surfaces == 0 ? 1 : torture_random_whole( &b.random, 0, 5 ) / 4;
    for ( int i = 0; i < surfaces; ++i )
    {
        torture_make_surface( &b );
    }
    for ( int i = 0; i < strands; ++i )
    {
        torture_make_strands( &b );
    }
    for ( int i = b.is_stack ? 1 : torture_random_whole( &b.random, 0, 3 ); i > 0; --i )
    {
        torture_make_collider( &b );
    }
    for ( int i = torture_random_whole( &b.random, 0, 3 ); i > 0; --i )
    {
        torture_make_event( &b, i );
    }
    take_list( scene, "surfaces", b.surfaces );
    take_list( scene, "strands", b.strands );
    take_list( scene, "colliders", b.colliders );
    take_list( scene, "events", b.events );
    take_list( scene, "hair_events", b.hair_events );
    // The same materials at another size are stiff or soft, and fall through their own size at once or never.
    static const double sizes[] = { 0.01, 0.02, 0.1, 5.0 };
    if ( torture_random_chance( &b.random, 18 ) )
    {
        torture_resize( scene, sizes[torture_random_whole( &b.random, 0, WISP_COUNT( sizes ) - 1 )] );
    }
    return scene;
}
