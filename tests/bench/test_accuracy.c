// The case `accuracy`: comparisons, the turns of runs, and the content of its tables.
#include "accuracy_scenes.h"
#include "bench_tables.h"

#include "accuracy/accuracy.h"
#include "accuracy/accuracy_parts.h"

// ---- the front ----

TEST( the_front_is_what_nobody_beats )
{
    const double error[] = { 1.0, 2.0, 4.0, 2.0, 0.5, 4.0 };
    const double ms[] = { 4.0, 2.0, 1.0, 3.0, 9.0, 1.5 };
    const bool expected[] = { true, true, true, false, true, false };
    bool front[6];
    accuracy_front( error, ms, NULL, 6, front );
    assert_memory_equal( front, expected, sizeof( front ) );
}

TEST( those_that_tie_are_on_the_front_together )
{
    // the third is as accurate as the first two and slower, the fourth as fast and less accurate
    const double error[] = { 1.0, 1.0, 1.0, 2.0 }, ms[] = { 2.0, 2.0, 3.0, 2.0 };
    const bool expected[] = { true, true, false, false };
    bool front[4];
    accuracy_front( error, ms, NULL, 4, front );
    assert_memory_equal( front, expected, sizeof( front ) );
}

TEST( what_has_no_error_or_no_time_is_not_on_the_front )
{
    const double error[] = { NAN, 1.0, 0.0, 5.0 }, ms[] = { 1.0, 2.0, NAN, 1.5 };
    const bool expected[] = { false, true, false, true };
    bool front[4];
    accuracy_front( error, ms, NULL, 4, front );
    assert_memory_equal( front, expected, sizeof( front ) );
}

// ---- orders ----

TEST( a_power_law_has_its_power_as_order )
{
    double parameter[6], error[6];
    for ( int i = 0; i < 6; ++i )
    {
        parameter[i] = 0.1 / ( 1 << i );
        error[i] = 3.0 * pow( parameter[i], 1.5 );
    }
    const accuracy_order order = accuracy_observed_order( parameter, error, 6 );
    // logarithms and a straight line lose a few roundings of numbers about 10
    assert_true( fabs( order.slope - 1.5 ) < 1e-12 );
    assert_int_equal( order.used, 6 );
    assert_int_equal( order.count, 6 );
}

TEST( points_at_the_floor_and_halted_ones_are_left_out )
{
    // in no order; first order down to 0.05, then a fluctuating floor; the coarsest was halted, and one is exact
    const double parameter[] = { 0.1, 0.8, 0.4, 0.2, 0.05, 0.0125, 0.025, 0.00625 };
    const double error[] = { 0.1, NAN, 0.4, 0.2, 0.05, 0.051, 0.047, 0.0 };
    const accuracy_order order = accuracy_observed_order( parameter, error, 8 );
    assert_true( fabs( order.slope - 1.0 ) < 1e-12 );
    assert_int_equal( order.used, 4 );
    assert_int_equal( order.count, 6 );
}

TEST( a_series_that_does_not_fall_has_no_order )
{
    const double parameter[] = { 0.4, 0.2, 0.1 }, error[] = { 1.0, 1.1, 1.2 };
    const accuracy_order order = accuracy_observed_order( parameter, error, 3 );
    assert_true( isnan( order.slope ) );
    assert_int_equal( order.used, 1 );
    assert_int_equal( accuracy_observed_order( parameter, error, 0 ).count, 0 );
}

// ---- levels ----

TEST( levels_are_round_numbers_around_the_values )
{
    const double values[] = { 0.7, NAN, 0.0, -3.0, 21.0, 5.0 }, expected[] = { 1.0, 2.0, 5.0, 10.0, 20.0, 50.0 };
    double levels[ACCURACY_LEVELS_MAX];
    assert_int_equal( accuracy_levels( values, 6, levels ), 6 );
    assert_memory_equal( levels, expected, sizeof( expected ) );
}

TEST( many_levels_are_picked_evenly_and_keep_both_ends )
{
    const double values[] = { 1e-3, 1e2 }, expected[] = { 1e-3, 1e-2, 1e-1, 1.0, 10.0, 100.0 };
    double levels[ACCURACY_LEVELS_MAX];
    assert_int_equal( accuracy_levels( values, 2, levels ), ACCURACY_LEVELS_MAX );
    assert_memory_equal( levels, expected, sizeof( expected ) );
}

TEST( values_between_two_round_numbers_have_the_one_above )
{
    const double values[] = { 0.021, 0.03 };
    double levels[ACCURACY_LEVELS_MAX];
    assert_int_equal( accuracy_levels( values, 2, levels ), 1 );
    assert_true( levels[0] == 0.05 );
    assert_int_equal( accuracy_levels( values, 0, levels ), 0 );
}

TEST( the_best_within_a_limit_is_the_cheapest_that_takes_part )
{
    const double ms[] = { 1.0, 3.0, 2.0, 2.0, NAN }, error[] = { 9.0, 0.5, 1.0, 1.0, 0.1 };
    const bool takes_part[] = { true, true, false, false, true };
    assert_int_equal( accuracy_best_within( ms, error, 1.0, NULL, 5 ), 2 );
    assert_int_equal( accuracy_best_within( ms, error, 1.0, takes_part, 5 ), 1 );
    assert_int_equal( accuracy_best_within( ms, error, 10.0, takes_part, 5 ), 0 );
    assert_int_equal( accuracy_best_within( ms, error, 0.4, NULL, 5 ), -1 );
}

// ---- a synthetic scene ----

enum
{
    FAKE_SETTINGS = 5,
    FAKE_STEPS = 4,
    FAKE_HALTS = 4, // the setting that is halted
};

/// Requests to the scene, and its failures.
typedef struct fake_log
{
    int observed[FAKE_SETTINGS], timed[FAKE_SETTINGS][2]; // by 1 worker, by others
    int observed_after_times;
    int destroyed;
    int differs;   // setting whose hash depends on workers; -1: none
    int fails_at;  // setting that fails; -1: none
    double cost;   // s per run of setting 0
    double slower; // times, the steps of setting 0
} fake_log;

static fake_log fake;

static void spend( double seconds )
{
    const double end = wisp_clock_seconds() + seconds;
    while ( wisp_clock_seconds() < end )
    {
        // a run of that duration
    }
}

// The time of a step is 1 ms, half with two workers, times the rank of the setting: 0 is expensive and accurate.
static wisp_status fake_run( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                             wisp_error* error )
{
    assert_ptr_equal( context, &fake );
    assert_true( isnan( out->error ) && isnan( out->measures[0] ) && out->halted_at == 0 );
    if ( setting == fake.fails_at )
    {
        return wisp_fail( error, WISP_CONFLICT, "setting %d has no world", setting );
    }
    if ( is_observed )
    {
        assert_int_equal( workers, 1 );
        ++fake.observed[setting];
        fake.observed_after_times += fake.timed[0][0];
        out->error = 1.0 + setting;
        out->measures[0] = 10.0 * setting;
    }
    else
    {
        ++fake.timed[setting][workers > 1];
        spend( setting == 0 ? fake.cost : 0.0 );
    }
    out->hash = 0x1000u + (uint64_t)setting + ( setting == fake.differs ? (uint64_t)workers - 1u : 0u );
    out->halted_at = setting == FAKE_HALTS ? 3 : 0;
    for ( int i = 0; i < FAKE_STEPS; ++i )
    {
        // the first step compiles the plan, the sampled run is slow
        const double ms = ( i == 0 || is_observed ? 100.0 : 8.0 / ( 1 << setting ) ) / workers;
        assert_int_equal( accuracy_keep_ms( out, setting == 0 ? fake.slower * ms : ms ), WISP_OK );
    }
    return WISP_OK;
}

static void fake_destroy( void* context )
{
    assert_ptr_equal( context, &fake );
    ++fake.destroyed;
}

static wisp_status fake_make( const void* subject, const bench_options* options, double seconds, accuracy_scene* out,
                              wisp_error* error )
{
    (void)subject;
    (void)options;
    (void)error;
    assert_true( seconds > 0.0 );
    *out = ( accuracy_scene ){ .reference = "closed form: the number of the setting",
                               .error_name = "distance",
                               .error_unit = "mm",
                               .measure_names = { "sag, mm" },
                               .measure_count = 1,
                               .setting_count = FAKE_SETTINGS,
                               .context = &fake,
                               .run = fake_run,
                               .destroy = fake_destroy };
    out->settings = checked_calloc( FAKE_SETTINGS, sizeof( accuracy_setting ) );
    for ( int i = 0; i < FAKE_SETTINGS; ++i )
    {
        accuracy_setting* s = &out->settings[i];
        *s = ( accuracy_setting ){ .parameter_name = "substep, s", .parameter = 1.0 + i, .order = 1.0 };
        snprintf( s->name, sizeof( s->name ), "setting %d", i );
        snprintf( s->series, sizeof( s->series ), "%s", i < 3 ? "falling" : "" );
    }
    return WISP_OK;
}

static const accuracy_entry fake_entry = { "fake", "a scene that pretends", fake_make, NULL, NULL };

static int forget_fake( void** state )
{
    (void)state;
    fake = ( fake_log ){ .differs = -1, .fails_at = -1, .slower = 1.0 };
    return 0;
}

static results run_fake( double seconds, int workers )
{
    results all = { 0 };
    wisp_error error = { 0 };
    bench_options options = bench_default_options();
    options.workers = workers;
    assert_int_equal( accuracy_bench_run( &fake_entry, 1, seconds, &options, &all, &error ), WISP_OK );
    assert_int_equal( fake.destroyed, 1 );
    return all;
}

TEST_WITH( each_setting_is_observed_once_and_timed_at_least_once, forget_fake, NULL )
{
    SCOPED( results_free ) results all = run_fake( 1e-9, 2 );
    assert_false( all.failed );
    assert_int_equal( fake.observed_after_times, 0 );
    for ( int i = 0; i < FAKE_SETTINGS; ++i )
    {
        assert_int_equal( fake.observed[i], 1 );
        assert_int_equal( fake.timed[i][0], 1 );
        assert_int_equal( fake.timed[i][1], 1 );
    }
}

TEST_WITH( with_one_worker_nothing_runs_twice, forget_fake, NULL )
{
    SCOPED( results_free ) results all = run_fake( 1e-9, 1 );
    assert_int_equal( fake.timed[0][0], 1 );
    assert_int_equal( fake.timed[0][1], 0 );
    assert_int_equal( all.row_count, FAKE_SETTINGS );
}

TEST_WITH( who_takes_more_than_its_share_sits_out, forget_fake, NULL )
{
    // the fraction is 0.1 s: one run of the first, at least one more of the others, none of the halted one after its
    // first
    fake.cost = 0.15;
    SCOPED( results_free ) results all = run_fake( 1.0, 2 );
    assert_int_equal( fake.timed[0][0], 1 );
    assert_int_equal( fake.timed[0][1], 1 );
    int others = 0;
    for ( int i = 1; i < FAKE_HALTS; ++i )
    {
        others += fake.timed[i][0] + fake.timed[i][1];
    }
    assert_true( others > 2 * ( FAKE_HALTS - 1 ) );
    assert_int_equal( fake.timed[FAKE_HALTS][1], 1 );
    const results_table* table = find_table( &all, "Accuracy `fake`: a scene that pretends, ms per step" );
    assert_string_equal( named_cell( table, 1, "timed" ), "3" );
}

TEST_WITH( the_table_has_times_errors_measures_and_the_front, forget_fake, NULL )
{
    SCOPED( results_free ) results all = run_fake( 1e-9, 2 );
    const results_table* table = find_table( &all, "Accuracy `fake`: a scene that pretends, ms per step" );
    assert_int_equal( table->row_count, 1 + FAKE_SETTINGS );
    assert_string_equal( named_cell( table, 2, "setting" ), "setting 1" );
    assert_string_equal( named_cell( table, 2, "1 worker ms" ), "4.00" );
    assert_string_equal( named_cell( table, 2, "2 workers ms" ), "2.00" );
    assert_string_equal( named_cell( table, 2, "distance, mm" ), "2.000" );
    assert_string_equal( named_cell( table, 2, "sag, mm" ), "10.00" );
    assert_string_equal( named_cell( table, 2, "front" ), "front" );
    assert_string_equal( named_cell( table, 2, "hash" ), "0000000000001001" );
    // both fronts are the same, so one is shown
    assert_int_equal( table->column_count, 8 );
    const int halted = 1 + FAKE_HALTS;
    assert_string_equal( named_cell( table, halted, "2 workers ms" ), "halted at step 3" );
    assert_string_equal( named_cell( table, halted, "distance, mm" ), "-" );
    assert_string_equal( named_cell( table, halted, "front" ), "" );
}

TEST_WITH( rows_for_machines_name_scene_setting_reference_and_parameter, forget_fake, NULL )
{
    SCOPED( results_free ) results all = run_fake( 1e-9, 2 );
    assert_int_equal( all.row_count, 2 * FAKE_SETTINGS );
    const results_row* row = &all.rows[3];
    assert_string_equal( row->name, "accuracy.fake" );
    assert_string_equal( row->variant, "setting 1" );
    assert_string_equal( row->error_reference, "closed form: the number of the setting" );
    assert_int_equal( row->workers, 2 );
    assert_true( row->ms_median == 2.0 && row->ms_p10 == 2.0 && row->ms_p90 == 2.0 );
    assert_int_equal( row->steps, FAKE_STEPS - 1 );
    assert_string_equal( row->size.items[0].name, "substep_s" );
    assert_string_equal( row->error.items[0].name, "distance_mm" );
    assert_true( row->error.items[0].value == 2.0 );
    assert_string_equal( row->error.items[1].name, "sag_mm" );
    const results_row* halted = &all.rows[2 * FAKE_HALTS];
    assert_true( isnan( halted->ms_median ) );
    assert_string_equal( halted->error.items[halted->error.count - 1].name, "halted_at_step" );
}

TEST_WITH( levels_that_would_say_the_same_are_said_once, forget_fake, NULL )
{
    fake.slower = 64.0;
    SCOPED( results_free ) results all = run_fake( 1e-9, 2 );
    // 256 ms, 2, 1 and 0.5 for the single setting: there is none between 2 and 256 ms
    const results_table* time = find_table( &all, "Accuracy `fake`, at equal time" );
    assert_int_equal( time->row_count, 1 + 2 + 2 + 1 );
    assert_string_equal( named_cell( time, 1, "ms, at most" ), "500" );
    assert_string_equal( named_cell( time, 1, "most accurate setting" ), "setting 0" );
    assert_string_equal( named_cell( time, 3, "ms, at most" ), "2" );
    assert_string_equal( named_cell( time, 3, "most accurate setting" ), "setting 1" );
    assert_string_equal( named_cell( time, 5, "ms, at most" ), "0.5" );
}

TEST_WITH( at_equal_error_the_best_of_each_method_is_ranked_by_time, forget_fake, NULL )
{
    SCOPED( results_free ) results all = run_fake( 1e-9, 2 );
    const results_table* table = find_table( &all, "Accuracy `fake`, at equal error" );
    // errors 1 to 4: within 5 mm the single setting is the fastest, with half the time of the series
    assert_string_equal( named_cell( table, 1, "fastest setting" ), "setting 3" );
    assert_string_equal( named_cell( table, 2, "fastest setting" ), "setting 2" );
    assert_string_equal( named_cell( table, 2, "times the fastest" ), "2.00" );

    // within 2 mm only the second setting of the series is left
    const int at_two = row_of( table, "2" );
    assert_string_equal( table->cells[( at_two + 1 ) * table->column_count], "1" );
    assert_string_equal( named_cell( table, at_two, "method" ), "falling" );
    assert_string_equal( named_cell( table, at_two, "fastest setting" ), "setting 1" );
    assert_string_equal( named_cell( table, at_two, "ms" ), "2.00" );
    assert_string_equal( named_cell( table, at_two, "times the fastest" ), "1.00" );

    // times 4, 2, 1 and 0.5 ms: within 1 ms the series has an error of 3 mm, and the single setting one of 4
    const results_table* time = find_table( &all, "Accuracy `fake`, at equal time" );
    const int at_one = row_of( time, "1" );
    assert_string_equal( named_cell( time, at_one, "most accurate setting" ), "setting 2" );
    assert_string_equal( named_cell( time, at_one + 1, "most accurate setting" ), "setting 3" );
    assert_string_equal( named_cell( time, at_one + 1, "times the most accurate" ), "1.33" );
}

TEST_WITH( observed_orders_stand_beside_the_promised, forget_fake, NULL )
{
    SCOPED( results_free ) results all = run_fake( 1e-9, 2 );
    const results_table* table = find_table( &all, "Accuracy `fake`, observed order" );
    assert_int_equal( table->row_count, 2 );
    assert_string_equal( named_cell( table, 1, "series" ), "falling" );
    assert_string_equal( named_cell( table, 1, "observed order" ), "1.00" );
    assert_string_equal( named_cell( table, 1, "promised" ), "1.0" );
    assert_string_equal( named_cell( table, 1, "points used" ), "3 of 3" );
}

TEST_WITH( charts_have_a_series_each_and_mark_the_front, forget_fake, NULL )
{
    SCOPED( results_free ) results all = run_fake( 1e-9, 2 );
    assert_int_equal( all.chart_count, 2 );
    const results_chart* time = &all.charts[0];
    assert_true( time->x_log && time->y_log );
    assert_string_equal( time->x_label, "ms per step" );
    assert_int_equal( time->series_count, 2 );
    assert_string_equal( time->series[0].name, "falling" );
    assert_string_equal( time->series[1].name, "other settings" );
    const results_point* point = &time->series[0].points[1];
    assert_true( point->x == 2.0 && point->y == 2.0 && point->is_marked );
    assert_string_equal( point->label, "setting 1" );

    // from coarse to fine
    const results_chart* parameter = &all.charts[1];
    assert_string_equal( parameter->x_label, "substep, s" );
    assert_int_equal( parameter->series_count, 1 );
    assert_int_equal( parameter->series[0].count, 3 );
    assert_true( parameter->series[0].points[0].x == 3.0 && parameter->series[0].points[2].x == 1.0 );
}

TEST_WITH( a_hash_that_depends_on_workers_fails_the_run_and_is_named, forget_fake, NULL )
{
    fake.differs = 2;
    SCOPED( results_free ) results all = run_fake( 1e-9, 2 );
    assert_true( all.failed );
    bool is_named = false;
    for ( int i = 0; i < all.note_count; ++i )
    {
        is_named =
            is_named || strncmp( all.notes[i],
                                 "FAILED: accuracy.fake, setting 2: hash 0000000000001003 with 2 workers, expected "
                                 "0000000000001002",
                                 90 ) == 0;
    }
    assert_true( is_named );
}

TEST_WITH( a_setting_that_fails_ends_the_case_with_its_message, forget_fake, NULL )
{
    fake.fails_at = 1;
    results all = { 0 };
    wisp_error error = { 0 };
    const bench_options options = bench_default_options();
    assert_int_equal( accuracy_bench_run( &fake_entry, 1, 1.0, &options, &all, &error ), WISP_CONFLICT );
    assert_string_equal( error.message, "setting 1 has no world" );
    assert_int_equal( fake.destroyed, 1 );
    results_free( &all );
}

// ---- quick runs ----

TEST( a_quick_run_has_the_coarsest_and_the_middle_of_each_series_and_all_of_no_series )
{
    static const struct
    {
        const char* series;
        double parameter;
        bool is_kept;
    } expected[] = {
        { "", NAN, true },       { "first", 8.0, true },   { "first", 4.0, false },  { "first", 2.0, true },
        { "first", 1.0, true },  { "second", 1.0, false }, { "", NAN, true },        { "second", 2.0, false },
        { "second", 3.0, true }, { "second", 9.0, false }, { "second", 10.0, true }, { "alone", 1.0, true },
        { "two", 2.0, true },    { "two", 1.0, true },
    };
    accuracy_setting settings[WISP_COUNT( expected )];
    int numbers[WISP_COUNT( expected )];
    for ( int i = 0; i < WISP_COUNT( expected ); ++i )
    {
        settings[i] = ( accuracy_setting ){ .parameter = expected[i].parameter };
        snprintf( settings[i].name, sizeof( settings[i].name ), "%d", i );
        snprintf( settings[i].series, sizeof( settings[i].series ), "%s", expected[i].series );
    }
    accuracy_scene scene = { .settings = settings, .setting_count = WISP_COUNT( expected ) };
    accuracy_thin( &scene, NULL, numbers );

    int kept = 0;
    for ( int i = 0; i < WISP_COUNT( expected ); ++i )
    {
        if ( expected[i].is_kept )
        {
            assert_true( kept < scene.setting_count );
            assert_int_equal( numbers[kept], i );
            assert_int_equal( atoi( scene.settings[kept].name ), i );
            ++kept;
        }
    }
    assert_int_equal( scene.setting_count, kept );
}

TEST( rows_that_a_suite_names_as_quick_are_those_of_a_quick_run )
{
    accuracy_setting settings[4] = { { .series = "one", .parameter = 1.0 },
                                     { .series = "one", .parameter = 2.0 },
                                     { .series = "one", .parameter = 3.0 },
                                     { .series = "" } };
    suite_row rows[4] = { { .is_slow = true }, { .is_slow = false }, { .is_slow = true }, { .is_slow = true } };
    const wisp_suite suite = { .rows = rows, .row_count = 4 };
    int numbers[4];
    accuracy_scene scene = { .settings = settings, .setting_count = 4 };
    accuracy_thin( &scene, &suite, numbers );
    assert_int_equal( scene.setting_count, 1 );
    assert_int_equal( numbers[0], 1 );
}

// Setting 1 is the fine end of the second series.
static wisp_status make_two_series( const void* subject, const bench_options* options, double seconds,
                                    accuracy_scene* out, wisp_error* error )
{
    const wisp_status status = fake_make( subject, options, seconds, out, error );
    for ( int i = 0; i < 4 && status == WISP_OK; ++i )
    {
        accuracy_setting* s = &out->settings[i];
        snprintf( s->series, sizeof( s->series ), "%s", i == 0 ? "first" : "second" );
    }
    return status;
}

TEST_WITH( a_quick_run_runs_the_settings_that_it_names_and_says_how_many_there_are, forget_fake, NULL )
{
    const accuracy_entry entry = { "fake", "a scene of two series", make_two_series, NULL, NULL };
    bench_options options = bench_default_options();
    options.quick = true;
    results all = { 0 };
    wisp_error error = { 0 };
    assert_int_equal( accuracy_bench_run( &entry, 1, 1e-9, &options, &all, &error ), WISP_OK );
    assert_false( all.failed );
    const results_table* table = find_table( &all, "Accuracy `fake`" );
    for ( int i = 0, line = 1; i < FAKE_SETTINGS; ++i )
    {
        const int expected = i == 1 ? 0 : 1;
        assert_int_equal( fake.observed[i], expected );
        assert_int_equal( fake.timed[i][0], expected );
        assert_int_equal( fake.timed[i][1], expected );
        if ( expected > 0 && i != FAKE_HALTS )
        {
            assert_true( atof( named_cell( table, line, "distance, mm" ) ) == 1.0 + i );
        }
        line += expected;
    }
    bool is_said = false;
    char said[40];
    snprintf( said, sizeof( said ), "has %d of %d settings", FAKE_SETTINGS - 1, FAKE_SETTINGS );
    for ( int i = 0; i < all.note_count; ++i )
    {
        is_said = is_said || strstr( all.notes[i], said ) != NULL;
    }
    assert_true( is_said );
    results_free( &all );
}

// ---- a suite ----

// Euler's steps are of first order, and every hash with one worker and with two is that of the sampled run.
TEST( a_real_scene_comes_nearer_with_shorter_steps )
{
    wisp_suite suite;
    accuracy_scene scene;
    results all = { 0 };
    wisp_error error = { 0 };
    const bench_options options = bench_default_options();
    open_suite( "cloth_taut", &suite, &scene );
    close_scene( &scene );
    const int all_rows = suite.row_count;
    suite.row_count = 6; // those of Euler's, and one of BDF2
    const accuracy_entry entry = { "cloth_taut", "a few of its settings", NULL, &suite, NULL };
    assert_int_equal( accuracy_bench_run( &entry, 1, 1e-9, &options, &all, &error ), WISP_OK );
    assert_false( all.failed );
    double errors[6];
    int on_front = 0;
    const results_table* table = find_table( &all, "Accuracy `cloth_taut`: a few of its settings, ms per" );
    for ( int k = 0; k < 6; ++k )
    {
        errors[k] = atof( named_cell( table, 1 + k, "RMS distance to the reference, mm" ) );
        on_front += strcmp( named_cell( table, 1 + k, "front" ), "front" ) == 0;
        assert_true( all.rows[2 * k].hash == all.rows[2 * k + 1].hash && all.rows[2 * k].ms_median > 0.0 );
    }
    assert_true( on_front >= 1 );
    for ( int k = 1; k < 5; ++k )
    {
        assert_true( errors[k] < 0.75 * errors[k - 1] );
    }
    const results_table* orders = find_table( &all, "Accuracy `cloth_taut`, observed order" );
    const int euler = row_of( orders, "implicit, integrator=euler, tolerance=1e-4, newton_iterations=1" );
    assert_true( fabs( atof( named_cell( orders, euler, "observed order" ) ) - 1.0 ) < 0.25 );
    results_free( &all );
    suite.row_count = all_rows;
    suite_release( &suite );
}
