// Every case of `wisp validate` comes as near to its answer as limits.inc says, with the same bits for one worker and two.
#include "accuracy_scenes.h"

#include "validate/validate.h"

static accuracy_scene_fn* find_case( const char* name )
{
    int count;
    const validate_case* cases = validate_cases( &count );
    for ( int i = 0; i < count; ++i )
    {
        if ( strcmp( cases[i].name, name ) == 0 )
        {
            return cases[i].make;
        }
    }
    fail_msg( "there is no case '%s'", name );
    return NULL;
}

TEST( no_setting_is_farther_from_its_answer_than_its_limit )
{
    int count, case_count = 0, failed = 0;
    const validate_limit* limits = validate_limits( &count );
    accuracy_scene scene = { .setting_count = 0 };
    for ( int i = 0; i < count; ++i )
    {
        const bool begins = i == 0 || strcmp( limits[i].name, limits[i - 1].name ) != 0;
        if ( begins )
        {
            open_scene( find_case( limits[i].name ), &scene );
            assert_well_formed( &scene );
            ++case_count;
        }
        const accuracy_run run = run_setting( &scene, limits[i].setting, 1, true );
        if ( !( run.error <= limits[i].most ) )
        {
            print_message( "%s, %s: an error of %.4g, expected at most %g\n", limits[i].name, limits[i].setting,
                           run.error, limits[i].most );
            ++failed;
        }
        if ( begins )
        {
            assert_true( run.hash != 0 && run_setting( &scene, limits[i].setting, 2, false ).hash == run.hash );
        }
        if ( i + 1 == count || strcmp( limits[i].name, limits[i + 1].name ) != 0 )
        {
            close_scene( &scene );
        }
    }
    assert_int_equal( failed, 0 );
    int all;
    (void)validate_cases( &all );
    assert_int_equal( case_count, all );
}
