// The generator: a seed is a sequence of scenes, they hold everything that a scene can say, and the reader takes
// them.
#include "torture_fixture.h"

#include "torture_generate.h"

static char* text_of( uint64_t seed, int number )
{
    const torture_generator generator = { .seed = seed };
    text_node* scene = torture_generate( &generator, number );
    char* text = text_write( scene, NULL );
    text_release( scene );
    return text;
}

TEST( a_scene_of_a_seed_is_always_the_same_text )
{
    for ( int i = 0; i < 20; ++i )
    {
        char *a = text_of( 7, i ), *b = text_of( 7, i );
        assert_string_equal( a, b );
        free( a );
        free( b );
    }
}

TEST( seeds_and_numbers_are_different_scenes )
{
    char *a = text_of( 7, 1 ), *b = text_of( 7, 2 ), *c = text_of( 8, 1 );
    assert_string_not_equal( a, b );
    assert_string_not_equal( a, c );
    free( a );
    free( b );
    free( c );
}

// Computed from the definition of SplitMix64 with whole numbers of any length.
TEST( random_numbers_are_those_of_every_machine )
{
    torture_random random = torture_random_start( 1, 2 );
    assert_true( torture_random_next( &random ) == UINT64_C( 0xd2f6d0470be1a7b1 ) );
}

TEST( every_scene_is_read )
{
    for ( int i = 0; i < 400; ++i )
    {
        const torture_generator generator = { .seed = 11 };
        text_node* tree = torture_generate( &generator, i );
        const torture_subject subject = { tree, "test" };
        wisp_scene scene;
        wisp_error error = { 0 };
        if ( torture_read( &subject, &scene, &error ) != WISP_OK )
        {
            fail_msg( "scene %d: %s", i, error.message );
        }
        wisp_scene_release( &scene );
        text_release( tree );
    }
}

TEST( text_of_a_scene_is_read_as_the_same_tree )
{
    for ( int i = 0; i < 50; ++i )
    {
        char* text = text_of( 13, i );
        text_node* tree = parse_scene( text );
        char* again = text_write( tree, NULL );
        assert_string_equal( text, again );
        text_release( tree );
        free( again );
        free( text );
    }
}

TEST( every_kind_is_drawn )
{
    static const char* const words[] = { "cloth:",
                                         "balloon:",
                                         "implicit:",
                                         "contact:",
                                         "seams:",
                                         "boundary:",
                                         "instance_of:",
                                         "dynamics:",
                                         "ghosts:",
                                         "curves:",
                                         "frozen_hair:",
                                         "environment:",
                                         "appearance:",
                                         "grid:",
                                         "head:",
                                         "on_surface:",
                                         "hair_events:",
                                         "events:",
                                         "keyframes:",
                                         "pin_keyframes:",
                                         "dt_factors:",
                                         "gravity:",
                                         "shape: plane",
                                         "shape: sphere",
                                         "shape: capsule",
                                         "shape: box",
                                         "shape: mesh",
                                         "shape: torus",
                                         "shape: tube",
                                         "shape: pear",
                                         "shape: garment",
                                         "shape: delaunay",
                                         "shape: icosphere",
                                         "release:",
                                         "gas_ratio_keyframes:",
                                         "strain_limit:",
                                         "vertex_masses:",
                                         "coarse_substeps:",
                                         "level: spheres",
                                         "stretch: links",
                                         "bending: dihedral",
                                         "bending: isometric",
                                         "solver: pbd",
                                         "integrator: bdf2",
                                         "links: quad",
                                         "time: 0.001" };
    bool found[WISP_COUNT( words )] = { false };
    for ( int i = 0; i < 2000; ++i )
    {
        char* text = text_of( 17, i );
        for ( int k = 0; k < WISP_COUNT( words ); ++k )
        {
            found[k] |= strstr( text, words[k] ) != NULL;
        }
        free( text );
    }
    for ( int k = 0; k < WISP_COUNT( words ); ++k )
    {
        if ( !found[k] )
        {
            fail_msg( "no scene has '%s'", words[k] );
        }
    }
}

// A key that no scene has is one that the generator should draw, or that is listed here with its reason.
TEST( every_key_of_an_effect_is_drawn )
{
    static const char* const effects[] = { "cloth", "balloon", "implicit", "collision" };
    static const char* const left_out[] = { "max_iterations", "outlet", "outlet_radius",
                                            "min_gas_ratio",  "mask",   "allow_open" };
    text_node* found = text_map();
    for ( int i = 0; i < 2000; ++i )
    {
        const torture_generator generator = { .seed = 19 };
        text_node* tree = torture_generate( &generator, i );
        const text_node* surfaces = text_find( tree, "surfaces" );
        for ( int k = 0; surfaces && k < surfaces->count; ++k )
        {
            for ( int e = 0; e < WISP_COUNT( effects ); ++e )
            {
                const text_node* effect = text_find( surfaces->children[k], effects[e] );
                for ( int c = 0; effect && c < effect->count; ++c )
                {
                    text_put( found, effect->children[c]->key, text_scalar( "1" ) );
                }
            }
        }
        text_release( tree );
    }
    for ( int e = 0; e < WISP_COUNT( effects ); ++e )
    {
        const torture_block surface = torture_block_below( torture_block_of_scene(), "surfaces", NULL );
        const torture_block block = torture_block_below( surface, effects[e], NULL );
        for ( int i = 0; i < block.table->field_count; ++i )
        {
            const char* key = block.table->fields[i].key;
            bool is_left_out = false;
            for ( int k = 0; k < WISP_COUNT( left_out ); ++k )
            {
                is_left_out |= strcmp( key, left_out[k] ) == 0;
            }
            if ( !is_left_out && text_find( found, key ) == NULL )
            {
                fail_msg( "no scene has %s.%s", effects[e], key );
            }
        }
    }
    text_release( found );
}

TEST( a_mesh_that_is_given_is_used )
{
    static const char* const meshes[] = { WISP_SOURCE_ROOT "/data/bunny.obj" };
    const torture_generator generator = { .seed = 1, .meshes = meshes, .mesh_count = 1 };
    int count = 0;
    for ( int i = 0; i < 40; ++i )
    {
        text_node* scene = torture_generate( &generator, i );
        char* text = text_write( scene, NULL );
        count += strstr( text, "bunny.obj" ) != NULL;
        free( text );
        text_release( scene );
    }
    assert_true( count > 5 );
}
