/// Shared by tests of accuracy scenes: creating a scene, and running settings by name.
#pragma once

#include "unit.h"

#include "accuracy/accuracy.h"
#include "accuracy/accuracy_parts.h"

static const bench_options quick_options = { .quick = true, .workers = 2 };

static inline void expect_made( accuracy_scene_fn* make, accuracy_scene* out )
{
    wisp_error error = { 0 };
    assert_ok( make( &quick_options, 7.0, out, &error ), error );
}

static inline void free_scene( accuracy_scene* scene )
{
    scene->destroy( scene->context );
    free( scene->settings );
}

static inline int setting_of( const accuracy_scene* scene, const char* name )
{
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        if ( strcmp( scene->settings[i].name, name ) == 0 )
        {
            return i;
        }
    }
    fail_msg( "there is no setting '%s'", name );
    return -1;
}

/// The run without its times, of which there must be one per step.
static inline accuracy_run run_setting( const accuracy_scene* scene, int setting, int workers, bool is_observed )
{
    wisp_error error = { 0 };
    accuracy_run run = { .error = NAN };
    if ( scene->run( scene->context, setting, workers, is_observed, &run, &error ) != WISP_OK )
    {
        fail_msg( "%s: %s", scene->settings[setting].name, error.message );
    }
    assert_true( run.ms_count > 0 && run.halted_at == 0 );
    free( run.ms );
    run.ms = NULL;
    return run;
}

static inline accuracy_run observe( const accuracy_scene* scene, const char* name )
{
    return run_setting( scene, setting_of( scene, name ), 1, true );
}

/// Observe one setting of a scene that is made for it.
static inline accuracy_run observe_one( accuracy_scene_fn* make, bool is_quick, const char* name )
{
    bench_options options = quick_options;
    wisp_error error = { 0 };
    accuracy_scene scene;
    options.quick = is_quick;
    assert_ok( make( &options, 7.0, &scene, &error ), error );
    const accuracy_run run = observe( &scene, name );
    free_scene( &scene );
    return run;
}

/// The same bits for every number of workers, sampled or not.
static inline void expect_one_hash( const accuracy_scene* scene, const char* name )
{
    const int setting = setting_of( scene, name );
    const uint64_t observed = run_setting( scene, setting, 1, true ).hash;
    const uint64_t alone = run_setting( scene, setting, 1, false ).hash;
    const uint64_t shared = run_setting( scene, setting, 2, false ).hash;
    assert_true( observed != 0 );
    assert_true( observed == alone );
    assert_true( observed == shared );
}

/// Tables and files are read by these names.
static inline void expect_names_differ( const accuracy_scene* scene )
{
    assert_true( scene->setting_count > 0 );
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        assert_true( scene->settings[i].series[0] == '\0' || scene->settings[i].parameter > 0.0 );
        for ( int k = 0; k < i; ++k )
        {
            assert_string_not_equal( scene->settings[i].name, scene->settings[k].name );
        }
    }
}
