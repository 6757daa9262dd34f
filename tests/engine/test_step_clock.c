// The step clock: substeps of constant length from steps of any length, and the interpolation of kinematic targets.
#include "unit.h"

#include "step_clock.h"

enum
{
    SUBSTEPS = 8,
    SPLIT = 3,
};

// Take a step. @return its substeps
static int advance( step_clock* clock, wisp_frame* frame, double dt )
{
    step_clock_advance( clock, (float)dt, SUBSTEPS, false, frame );
    assert_true( step_clock_check( clock ) );
    return frame->substeps;
}

// A frame of two entities: one with the substeps of the world, one that splits each of those into three.
static wisp_frame* new_frame( void )
{
    static plan_entity entities[] = { { .split = 1 }, { .split = SPLIT } };
    static plan p = { .entities = entities, .entity_count = WISP_COUNT( entities ) };
    wisp_frame* frame = checked_calloc( 1, sizeof( wisp_frame ) );
    frame->plan = &p;
    return frame;
}

static const wisp_entity WHOLE = { .index = 1 }, FINER = { .index = 2 };

static double random_dt( int number )
{
    const uint32_t bits = ( (uint32_t)number * 2654435761u ) >> 8;
    return 1e-3 * pow( 50.0, (double)bits / 16777216.0 ); // 1/1000 to 1/20 s
}

TEST( constant_steps_have_the_same_substeps_exactly )
{
    step_clock clock = { 0 };
    wisp_frame* frame = new_frame();
    for ( int i = 0; i < 1500; ++i )
    {
        assert_int_equal( advance( &clock, frame, 1.0 / 60.0 ), SUBSTEPS );
        assert_true( frame->seconds == (float)( 1.0 / 60.0 ) / (float)SUBSTEPS );
        assert_true( wisp_frame_progress( frame, WHOLE, 3 ) == 3.0f / 8.0f );
        assert_true( wisp_frame_progress_left( frame, WHOLE, SUBSTEPS - 1 ) == 1.0f );
        assert_int_equal( wisp_frame_substeps( frame, FINER ), SUBSTEPS * SPLIT );
        assert_true( wisp_frame_dt( frame, FINER ) == frame->seconds / (float)SPLIT );
        assert_true( wisp_frame_progress( frame, FINER, 3 ) == 1.0f / 8.0f );
        assert_true( wisp_frame_progress_left( frame, FINER, SUBSTEPS * SPLIT - 1 ) == 1.0f );
        assert_true( frame->reached == 1.0f && clock.remainder == 0.0 );
    }
    free( frame );
}

// Substeps never shrink by more than 0.2 % from step to step, and their sum follows that of the steps within one substep.
TEST( steps_of_any_length_have_substeps_that_barely_change )
{
    step_clock clock = { 0 };
    wisp_frame* frame = new_frame();
    double asked = 0.0, simulated = 0.0, last = 0.0;
    int changes = 0;
    for ( int i = 0; i < 5000; ++i )
    {
        const double dt = (double)(float)random_dt( i );
        asked += dt;
        simulated += advance( &clock, frame, dt ) * (double)frame->seconds;
        assert_true( (double)frame->seconds > 0.997 * last );
        changes += i > 0 && fabs( (double)frame->seconds - last ) > 1e-6 * last ? 1 : 0;
        last = (double)frame->seconds;
        assert_true( fabs( asked - simulated - clock.remainder ) < 1e-5 * asked );
        assert_true( clock.remainder >= 0.0 && clock.remainder < last );
    }
    assert_true( changes <= 3 ); // up to what the longest steps need
    free( frame );
}

// A pin with a target for the end of each step moves at constant speed over all substeps.
static void check_steady_target( wisp_entity entity )
{
    step_clock clock = { 0 };
    wisp_frame* frame = new_frame();
    double place = 0.0, from = 0.0, to = 0.0, time = 0.0;
    for ( int i = 0; i < 500; ++i )
    {
        const double dt = (double)(float)random_dt( i );
        time += dt;
        advance( &clock, frame, dt );
        if ( frame->substeps == 0 )
        {
            continue;
        }
        from += (double)frame->reached * ( to - from );
        to = time;
        for ( int s = 0; s < wisp_frame_substeps( frame, entity ); ++s )
        {
            const double before = place;
            place += (double)wisp_frame_progress_left( frame, entity, s ) * ( time - place );
            const double same = from + (double)wisp_frame_progress( frame, entity, s + 1 ) * ( to - from );
            assert_true( fabs( place - same ) < 1e-5 * time );
            assert_true( fabs( ( place - before ) / (double)wisp_frame_dt( frame, entity ) - 1.0 ) < 2e-2 );
        }
        assert_true( fabs( time - place - clock.remainder ) < 1e-5 * time );
    }
    free( frame );
}

TEST( a_steady_target_is_followed_at_a_steady_speed )
{
    check_steady_target( WHOLE );
    check_steady_target( FINER );
}

TEST( a_new_usual_length_is_followed )
{
    step_clock clock = { 0 };
    wisp_frame* frame = new_frame();
    const double lengths[] = { 1.0 / 60.0, 1.0 / 120.0, 1.0 / 30.0 };
    for ( int k = 0; k < 3; ++k )
    {
        for ( int i = 0; i < 1500; ++i )
        {
            advance( &clock, frame, lengths[k] );
        }
        assert_true( clock.usual_dt == (float)lengths[k] );
        assert_true( fabs( (double)frame->seconds * SUBSTEPS / lengths[k] - 1.0 ) < 1e-6 );
    }
    free( frame );
}

TEST( one_long_step_costs_at_most_eight )
{
    step_clock clock = { 0 };
    wisp_frame* frame = new_frame();
    for ( int i = 0; i < 50; ++i )
    {
        advance( &clock, frame, 1.0 / 60.0 );
    }
    assert_int_equal( advance( &clock, frame, 0.1 ), 6 * SUBSTEPS );
    assert_int_equal( advance( &clock, frame, 2.0 ), STEP_CLOCK_MAX_RATIO * SUBSTEPS );
    assert_true( fabs( (double)frame->seconds * STEP_CLOCK_MAX_RATIO * SUBSTEPS - 2.0 ) < 1e-4 );
    for ( int i = 0; i < 1500; ++i )
    {
        advance( &clock, frame, 1.0 / 60.0 );
    }
    assert_true( fabs( (double)frame->seconds * SUBSTEPS * 60.0 - 1.0 ) < 1e-6 );
    free( frame );
}

TEST( a_trial_step_at_the_start_does_not_set_the_usual_length )
{
    step_clock clock = { 0 };
    wisp_frame* frame = new_frame();
    advance( &clock, frame, 1e-6 );
    assert_int_equal( advance( &clock, frame, 1.0 / 60.0 ), SUBSTEPS );
    assert_true( frame->seconds == (float)( 1.0 / 60.0 ) / (float)SUBSTEPS );
    free( frame );
}

TEST( a_step_that_must_run_has_one_substep )
{
    step_clock clock = { 0 };
    wisp_frame* frame = new_frame();
    advance( &clock, frame, 1.0 / 60.0 );
    assert_int_equal( advance( &clock, frame, 1e-5 ), 0 );
    step_clock_advance( &clock, 1e-5f, SUBSTEPS, true, frame );
    assert_int_equal( frame->substeps, 1 );
    assert_true( fabs( (double)frame->seconds - 2e-5 ) < 1e-9 && clock.remainder == 0.0 );
    free( frame );
}

TEST( clocks_that_no_step_leaves_are_refused )
{
    const float nan = nanf( "" );
    assert_true( step_clock_check( &( step_clock ){ 0 } ) );
    assert_false( step_clock_check( &( step_clock ){ .usual_dt = nan } ) );
    assert_false( step_clock_check( &( step_clock ){ .usual_dt = -1.0f } ) );
    assert_false( step_clock_check( &( step_clock ){ .reached = 1.5f } ) );
    assert_false( step_clock_check( &( step_clock ){ .remainder = INFINITY } ) );
    assert_false( step_clock_check( &( step_clock ){ .substep = -1.0 } ) );
    assert_false( step_clock_check( &( step_clock ){ .agreeing = STEP_CLOCK_WINDOW + 1 } ) );
    assert_false( step_clock_check( &( step_clock ){ .step_count = -1 } ) );
    assert_false( step_clock_check( &( step_clock ){ .longest = nan } ) );
}
