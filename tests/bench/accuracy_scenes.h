/// Scenes of the cases `accuracy` and `validate` at their smallest, run setting by setting without the driver.
#pragma once

#include "unit.h"

#include "accuracy/accuracy.h"
#include "accuracy/accuracy_parts.h"
#include "program_data.h"
#include "suite_study.h"

/// The suite of that name among those of `accuracy`. @param suite to be released after the scene
static inline void open_suite( const char* name, wisp_suite* suite, accuracy_scene* out )
{
    const bench_options options = { .quick = true, .workers = 2 };
    char inner[128], path[1024];
    wisp_error error = { 0 };
    setenv( "WISP_CACHE", "suite-cache", 1 );
    snprintf( inner, sizeof inner, "suites/accuracy/%s.yaml", name );
    program_data_path( inner, path, sizeof path );
    assert_ok( suite_read( path, suite, &error ), error );
    assert_ok( suite_study_make( suite, &options, out, &error ), error );
}

static inline void close_scene( accuracy_scene* scene )
{
    scene->destroy( scene->context );
    free( scene->settings );
}

static inline void close_suite( wisp_suite* suite, accuracy_scene* scene )
{
    close_scene( scene );
    suite_release( suite );
}

static inline accuracy_run run_setting( const accuracy_scene* scene, const char* name, int workers, bool is_observed )
{
    accuracy_run run = { .error = NAN };
    wisp_error error = { 0 };
    for ( int m = 0; m < ACCURACY_MEASURES_MAX; ++m )
    {
        run.measures[m] = NAN;
    }
    int setting = 0;
    while ( setting < scene->setting_count && strcmp( scene->settings[setting].name, name ) != 0 )
    {
        ++setting;
    }
    if ( setting == scene->setting_count )
    {
        fail_msg( "there is no setting '%s'", name );
    }
    if ( scene->run( scene->context, setting, workers, is_observed, &run, &error ) != WISP_OK )
    {
        fail_msg( "%s: %s", name, error.message );
    }
    assert_true( run.ms_count > 0 || is_observed );
    assert_int_equal( run.halted_at, 0 );
    free( run.ms );
    run.ms = NULL;
    profile_samples_free( &run.profile );
    return run;
}

static inline double error_of( const accuracy_scene* scene, const char* name )
{
    return run_setting( scene, name, 1, true ).error;
}

static inline double measure_of( const accuracy_scene* scene, const accuracy_run* run, const char* measure )
{
    for ( int m = 0; m < scene->measure_count; ++m )
    {
        if ( strcmp( scene->measure_names[m], measure ) == 0 )
        {
            return run->measures[m];
        }
    }
    fail_msg( "there is no measure '%s'", measure );
    return NAN;
}

/// The observed order between two settings whose parameters have this ratio.
static inline double order_between( const accuracy_scene* scene, const char* coarse, const char* fine, double ratio )
{
    return log( error_of( scene, coarse ) / error_of( scene, fine ) ) / log( ratio );
}

/// Workers and sampling change nothing.
static inline void assert_same_hash( const accuracy_scene* scene, const char* name )
{
    const uint64_t observed = run_setting( scene, name, 1, true ).hash;
    assert_true( observed != 0 );
    assert_true( run_setting( scene, name, 1, false ).hash == observed );
    assert_true( run_setting( scene, name, 2, false ).hash == observed );
}

/// Names are distinct, series have parameters above 0, and settings of a series have different ones.
static inline void assert_well_formed( const accuracy_scene* scene )
{
    assert_true( scene->setting_count > 1 );
    assert_true( scene->reference[0] != '\0' && scene->error_name[0] != '\0' && scene->error_unit[0] != '\0' );
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        const accuracy_setting* s = &scene->settings[i];
        assert_true( strlen( s->name ) < sizeof( s->name ) - 1 ); // a longer one may have been truncated
        assert_true( s->series[0] == '\0' || s->parameter > 0.0 );
        for ( int k = 0; k < i; ++k )
        {
            const accuracy_setting* other = &scene->settings[k];
            assert_string_not_equal( other->name, s->name );
            assert_true( s->series[0] == '\0' || strcmp( other->series, s->series ) != 0 ||
                         other->parameter != s->parameter );
        }
    }
}
