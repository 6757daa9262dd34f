// Every case of `wisp validate` comes as near to its answer as data/suites/validate/cases.yaml says, with the same bits for one worker and two.
#include "accuracy_scenes.h"

#include "validate/validate.h"

TEST( no_setting_is_farther_from_its_answer_than_its_limit )
{
    int count, failed = 0;
    const validate_case* const* cases = validate_cases( &count );
    wisp_error error = { 0 };
    text_node* said;
    const bench_options options = { .workers = 2 };
    accuracy_scene scene = { .setting_count = 0 };
    assert_ok( validate_read( &said, &error ), error );
    for ( int i = 0; i < count; ++i )
    {
        const text_node* limits = text_find( text_find( said, cases[i]->name ), "limits" );
        assert_true( limits != NULL && limits->count > 0 );
        assert_ok( validate_make( cases[i], &options, 20.0, &scene, &error ), error );
        assert_well_formed( &scene );
        for ( int k = 0; k < limits->count; ++k )
        {
            const char* setting = limits->children[k]->key;
            const accuracy_run run = run_setting( &scene, setting, 1, true );
            double most;
            assert_true( text_is_number( limits->children[k], &most ) );
            if ( !( run.error <= most ) )
            {
                print_message( "%s, %s: an error of %.4g, expected at most %g\n", cases[i]->name, setting, run.error,
                               most );
                ++failed;
            }
            assert_true( k > 0 || ( run.hash != 0 && run_setting( &scene, setting, 2, false ).hash == run.hash ) );
        }
        close_scene( &scene );
    }
    assert_int_equal( failed, 0 );
    text_release( said );
}
