// The shrinker, with judges that need no engine.
#include "torture_fixture.h"

#include "torture_search.h"

static const char SCENE[] = "wisp: 1\n"
                            "steps: 240\n"
                            "substeps: 10\n"
                            "surfaces:\n"
                            "  - name: a\n"
                            "    generate: { shape: plane, columns: 12, rows: 9, spacing: 0.0385 }\n"
                            "    cloth: { solver: pbd, bending: none }\n"
                            "  - name: b\n"
                            "    generate: { shape: torus, radius: 0.173, tube_radius: 0.0361 }\n"
                            "    balloon: { gas_ratio: 1.43 }\n"
                            "    transform: { translate: [0.113, 0.87, 0] }\n"
                            "colliders:\n"
                            "  - { name: ground, shape: plane, friction: 0.5 }\n";

// What breaks is a balloon of more than 1.2 times its volume.
static bool has_full_balloon( void* user, const text_node* scene )
{
    ++*(int*)user;
    const text_node* surfaces = text_find( scene, "surfaces" );
    for ( int i = 0; surfaces && i < surfaces->count; ++i )
    {
        double ratio;
        if ( text_is_number( text_find( text_find( surfaces->children[i], "balloon" ), "gas_ratio" ), &ratio ) &&
             ratio > 1.2 )
        {
            return true;
        }
    }
    return false;
}

TEST( only_what_breaks_is_left )
{
    int tries = 0;
    text_node* tree = parse_scene( SCENE );
    const torture_shrink_def def = { has_full_balloon, &tries, 1000, 60.0 };
    const int made = torture_shrink( &def, tree );
    assert_int_equal( made, tries );
    char* text = text_write( tree, NULL );
    assert_string_equal( text, "surfaces:\n  - { balloon: { gas_ratio: 1.4 } }\n" );
    free( text );
    text_release( tree );
}

// What breaks is a plane of 5 columns or more over at least 30 steps.
static bool is_wide_and_long( void* user, const text_node* scene )
{
    (void)user;
    double steps = 0.0, columns = 0.0;
    const text_node* surfaces = text_find( scene, "surfaces" );
    const text_node* first = surfaces && surfaces->count > 0 ? surfaces->children[0] : NULL;
    return text_is_number( text_find( scene, "steps" ), &steps ) && steps >= 30.0 &&
           text_is_number( text_find( text_find( first, "generate" ), "columns" ), &columns ) && columns >= 5.0;
}

TEST( counts_come_down_to_the_smallest_that_break )
{
    text_node* tree = parse_scene( SCENE );
    const torture_shrink_def def = { is_wide_and_long, NULL, 1000, 60.0 };
    torture_shrink( &def, tree );
    char* text = text_write( tree, NULL );
    assert_string_equal( text, "steps: 30\nsurfaces:\n  - { generate: { columns: 5 } }\n" );
    free( text );
    text_release( tree );
}

static bool breaks_always( void* user, const text_node* scene )
{
    (void)user;
    (void)scene;
    return true;
}

TEST( tries_have_a_limit )
{
    text_node* tree = parse_scene( SCENE );
    const torture_shrink_def def = { breaks_always, NULL, 3, 60.0 };
    assert_int_equal( torture_shrink( &def, tree ), 3 );
    text_release( tree );
}

static bool breaks_never( void* user, const text_node* scene )
{
    (void)user;
    (void)scene;
    return false;
}

TEST( a_scene_of_which_nothing_can_go_stays_as_it_is )
{
    text_node* tree = parse_scene( SCENE );
    char* before = text_write( tree, NULL );
    const torture_shrink_def def = { breaks_never, NULL, 1000, 60.0 };
    torture_shrink( &def, tree );
    char* after = text_write( tree, NULL );
    assert_string_equal( before, after );
    free( before );
    free( after );
    text_release( tree );
}
