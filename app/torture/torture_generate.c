#include "torture_generate.h"

#include "torture_builder.h"
#include "torture_twins.h"

#include <stdlib.h>
#include <string.h>

static text_node* make_steps( torture_builder* b, text_node* scene )
{
    static const char* const lengths[] = { "0.004", "0.008", "0.0166667", "0.0166667", "0.0166667", "0.033", "0.05" };
    static const char* const substeps[] = { "2", "4", "5", "8", "10", "10", "10", "16", "20" };
    const double seconds = torture_random_whole( &b->random, 2, 5 );
    const char* dt = lengths[torture_random_whole( &b->random, 0, WISP_COUNT( lengths ) - 1 )];
    const int MOST = b->has_contact ? 150 : 240; // contact is what costs most
    const int steps = (int)( seconds / strtod( dt, NULL ) );
    b->steps = steps < MOST ? steps : MOST;
    text_put( scene, "dt", text_scalar( "%s", dt ) );
    if ( torture_random_chance( &b->random, 25 ) )
    {
        text_node* factors = text_put( scene, "dt_factors", text_list() );
        for ( int i = torture_random_whole( &b->random, 2, 7 ); i > 0; --i )
        {
            text_add( factors, text_scalar( "%s", torture_random_log( &b->random, 0.1, 3.0 ).text ) );
        }
    }
    text_put( scene, "steps", text_scalar( "%d", b->steps ) );
    text_put( scene, "substeps",
              text_scalar( "%s", substeps[torture_random_whole( &b->random, 0, WISP_COUNT( substeps ) - 1 )] ) );
    if ( torture_random_chance( &b->random, 25 ) )
    {
        text_put( scene, "iterations", text_scalar( "%d", torture_random_whole( &b->random, 1, 4 ) ) );
    }
    return scene;
}

static void make_world( torture_builder* b, text_node* scene )
{
    if ( torture_random_chance( &b->random, 20 ) )
    {
        torture_put_vector( b, scene, "gravity", ( const double[] ){ -4, -20, -4 }, ( const double[] ){ 4, 0, 4 } );
    }
    if ( b->has_contact && torture_random_chance( &b->random, 40 ) )
    {
        text_node* contact = torture_put_block( b, torture_block_of_scene(), scene, "contact", 30 );
        const bool are_particles = strcmp( text_at( contact, "primitives" ), "particles" ) == 0;
        text_remove_key( contact, are_particles ? "displacement_limit" : "particle_spacing" );
        // By default they are as far apart as the smallest thickness, which makes ten thousands of them.
        if ( are_particles )
        {
            torture_put_linear( b, contact, "particle_spacing", 0.01, 0.03 );
        }
    }
}

// Lists that nothing is in are not written.
static void take_list( text_node* scene, const char* key, text_node* list )
{
    if ( list->count > 0 )
    {
        text_put( scene, key, list );
    }
    else
    {
        text_release( list );
    }
}

text_node* torture_generate( const torture_generator* generator, int number )
{
    torture_builder b = { .random = torture_random_start( generator->seed, (uint64_t)number ),
                          .generator = generator,
                          .surfaces = text_list(),
                          .strands = text_list(),
                          .colliders = text_list(),
                          .events = text_list(),
                          .hair_events = text_list() };
    text_node* scene = text_map();
    text_put( scene, "wisp", text_scalar( "1" ) );
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
    // by numbers of their own: other scenes of a seed stay what they are without seams
    text_node* seams = text_list();
    const torture_random random = b.random;
    b.random = torture_random_start( generator->seed ^ UINT64_C( 0x5ea5 ), (uint64_t)number );
    if ( surfaces > 0 && torture_random_chance( &b.random, 15 ) )
    {
        torture_make_seam( &b, seams );
    }
    b.random = random;
    take_list( scene, "seams", seams );
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
