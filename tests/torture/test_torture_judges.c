// Every judge holds for a run that is good and breaks for one that is not: numbers of a run that are made up, so that
// each judge is seen alone.
#include "torture_fixture.h"

#include <math.h>

enum
{
    STEPS = 300,
    BODIES = 2,
};

// Two bodies of 1 kg and 1 m that hang at rest for five seconds, one metre up.
static stability_trace make_trace( void )
{
    stability_trace trace = {
        .body_count = BODIES, .steps = STEPS, .intersections_before = 0, .intersections_after = 0, .extent = 1.0
    };
    trace.bodies = text_alloc( BODIES * sizeof *trace.bodies );
    trace.samples = text_alloc( ( STEPS + 1 ) * BODIES * sizeof *trace.samples );
    trace.times = text_alloc( ( STEPS + 1 ) * sizeof *trace.times );
    for ( int row = 0; row <= STEPS; ++row )
    {
        trace.times[row] = row / 60.0;
        for ( int body = 0; body < BODIES; ++body )
        {
            *stability_sample_of( &trace, row, body ) = ( stability_sample ){
                .potential = 9.8, .thickness = 0.01, .is_finite = true, .centre = { 0.0, 1.0, 0.0 }
            };
        }
    }
    for ( int body = 0; body < BODIES; ++body )
    {
        trace.bodies[body] = ( stability_body ){ .name = "cloth",
                                                 .moves = true,
                                                 .mass = 1.0,
                                                 .size = 1.0,
                                                 .area = 1.0,
                                                 .edge = 0.05,
                                                 .gravity = 9.8,
                                                 .damping = 2.0,
                                                 .softness = 0.01,
                                                 .start = { 0.0, 1.0, 0.0 } };
    }
    return trace;
}

static void assert_trace( stability_trace* trace, stability_check judge, const char* words )
{
    stability_verdict verdict;
    assert_int_equal( stability_judge_trace( trace, STABILITY_ALL, NULL, &verdict ), judge == STABILITY_HOLDS );
    assert_judged( verdict, judge );
    assert_contains( verdict.message, words );
    stability_trace_release( trace );
}

TEST( a_run_at_rest_holds )
{
    stability_trace trace = make_trace();
    assert_trace( &trace, STABILITY_HOLDS, "" );
}

TEST( a_step_that_fails_breaks )
{
    stability_trace trace = make_trace();
    trace.status = WISP_CONFLICT;
    trace.steps = 41;
    snprintf( trace.message, sizeof trace.message, "no such thing" );
    assert_trace( &trace, STABILITY_STATUS, "step 42 failed: no such thing" );
}

TEST( a_body_that_is_not_finite_breaks )
{
    stability_trace trace = make_trace();
    stability_sample_of( &trace, 60, 1 )->is_finite = false;
    assert_trace( &trace, STABILITY_FINITE, "cloth is not finite at 1 s" );
}

TEST( a_body_that_was_halted_breaks )
{
    stability_trace trace = make_trace();
    trace.bodies[1].is_halted = true;
    assert_trace( &trace, STABILITY_HALTED, "cloth was halted" );
}

// 20 J are what lifts both by the metre that everything is large, with one percent of 4 times 9.8 J for rounding.
TEST( energy_from_nowhere_breaks )
{
    stability_trace trace = make_trace();
    stability_sample_of( &trace, 120, 0 )->kinetic = 19.0;
    assert_trace( &trace, STABILITY_HOLDS, "" );
    trace = make_trace();
    stability_sample_of( &trace, 120, 0 )->kinetic = 21.0;
    stability_sample_of( &trace, 120, 0 )->speed = 6.5;
    assert_trace( &trace, STABILITY_ENERGY, "energy is 21 J above the start at 2 s" );
}

// A pin of 3 m/s may throw both with 6 m/s.
TEST( inputs_may_bring_energy )
{
    stability_trace trace = make_trace();
    stability_sample_of( &trace, 120, 0 )->kinetic = 50.0;
    trace.inputs.speed = 3.0;
    assert_trace( &trace, STABILITY_HOLDS, "" );
    trace = make_trace();
    stability_sample_of( &trace, 120, 0 )->kinetic = 70.0;
    trace.inputs.speed = 3.0;
    assert_trace( &trace, STABILITY_ENERGY, "inputs explain 56" );
}

TEST( a_stretch_that_weight_does_not_explain_breaks )
{
    stability_trace trace = make_trace();
    trace.bodies[0].stretch = 0.5;
    assert_trace( &trace, STABILITY_HOLDS, "" );
    trace = make_trace();
    trace.bodies[0].stretch = 0.6;
    assert_trace( &trace, STABILITY_STRAIN, "stretched by 60 % at the end" );
    trace = make_trace();
    trace.bodies[0].stretch = 0.6;
    trace.bodies[0].softness = 0.1;
    assert_trace( &trace, STABILITY_HOLDS, "" );
    trace = make_trace();
    trace.bodies[0].stretch = 0.6;
    trace.bodies[0].is_pinned = trace.inputs.moves_pins = true;
    assert_trace( &trace, STABILITY_HOLDS, "" );
}

// The same bodies, of half a metre, with what the close limits read: edges 5 % too long where 10 % are explained.
static stability_trace make_close_trace( void )
{
    stability_trace trace = make_trace();
    for ( int row = 0; row <= STEPS; ++row )
    {
        for ( int body = 0; body < BODIES; ++body )
        {
            stability_sample* s = stability_sample_of( &trace, row, body );
            s->energy = 9.8;
            s->strain = 0.05;
            s->reach = 0.1;
            s->travel = 0.001;
            s->coordinate = 1.0;
        }
    }
    for ( int body = 0; body < BODIES; ++body )
    {
        trace.bodies[body].extent = 0.5;
        trace.bodies[body].substep = trace.bodies[body].shortest = 1.0 / 600.0;
        trace.bodies[body].damping = 4.0;
        trace.bodies[body].twin = INFINITY;
        trace.bodies[body].is_pinned = true;
    }
    return trace;
}

static void assert_close( stability_trace* trace, stability_check check, const char* words )
{
    stability_verdict verdict;
    assert_true( stability_judge_trace( trace, STABILITY_ALL, NULL, &verdict ) ); // coarse limits let it pass
    assert_int_equal( stability_judge_trace( trace, STABILITY_ALL | STABILITY_CLOSE, NULL, &verdict ),
                      check == STABILITY_HOLDS );
    assert_judged( verdict, check );
    assert_contains( verdict.message, words );
    stability_trace_release( trace );
}

TEST( close_limits_see_what_coarse_ones_let_pass )
{
    stability_trace trace = make_close_trace();
    assert_close( &trace, STABILITY_HOLDS, "" );
    trace = make_close_trace();
    stability_sample_of( &trace, STEPS, 1 )->strain = 0.2;
    assert_close( &trace, STABILITY_STRAIN, "20 % off its length at the end, and 10 % are allowed" );
    trace = make_close_trace();
    trace.bodies[1].twin = 0.02; // from rest it would have half of that
    assert_close( &trace, STABILITY_STRAIN, "and 2 % are allowed" );
    trace = make_close_trace();
    stability_sample_of( &trace, 100, 0 )->energy += 0.2;
    assert_close( &trace, STABILITY_ENERGY, "energy is 0.2 J above that when inputs came to rest" );
    trace = make_close_trace();
    stability_sample_of( &trace, STEPS - 3, 0 )->travel = 0.1;
    assert_close( &trace, STABILITY_REST, "moves with 0.1 m/s in the last twentieth" );
    trace = make_close_trace();
    trace.inputs.speed = 1.0;
    stability_sample_of( &trace, 100, 0 )->travel = 100.0;
    assert_close( &trace, STABILITY_SPEED, "a vertex moves with 100 m/s" );
}

// Three fifths of five seconds may pass before edges are within their limit.
TEST( what_recovers_too_late_breaks )
{
    stability_trace trace = make_close_trace();
    stability_sample_of( &trace, 150, 0 )->strain = 0.5;
    assert_close( &trace, STABILITY_HOLDS, "" );
    trace = make_close_trace();
    stability_sample_of( &trace, 240, 0 )->strain = 0.5;
    assert_close( &trace, STABILITY_RECOVERY, "until 4 s after all inputs rest, and 3 s are allowed" );
}

// Steps of several lengths store other energies, and a body without damping need not come to rest.
TEST( close_limits_hold_where_they_are_not_known )
{
    stability_trace trace = make_close_trace();
    trace.inputs.is_uneven = true;
    stability_sample_of( &trace, 100, 0 )->energy += 0.2;
    assert_close( &trace, STABILITY_HOLDS, "" );
    trace = make_close_trace();
    trace.bodies[0].damping = 0.0;
    stability_sample_of( &trace, STEPS - 3, 0 )->travel = 0.1;
    assert_close( &trace, STABILITY_HOLDS, "" );
    trace = make_close_trace();
    trace.inputs.last = INFINITY;
    stability_sample_of( &trace, STEPS, 1 )->strain = 0.2;
    assert_close( &trace, STABILITY_HOLDS, "" );
}

TEST( a_vertex_inside_a_collider_breaks )
{
    stability_trace trace = make_trace();
    stability_sample_of( &trace, STEPS, 1 )->penetration = 0.019;
    assert_trace( &trace, STABILITY_HOLDS, "" );
    trace = make_trace();
    stability_sample_of( &trace, STEPS, 1 )->penetration = 0.03;
    assert_trace( &trace, STABILITY_PENETRATION, "20 mm inside a collider" );
    trace = make_trace();
    stability_sample_of( &trace, STEPS, 1 )->penetration = 0.03;
    trace.inputs.last = 4.5;
    assert_trace( &trace, STABILITY_HOLDS, "" );
}

TEST( intersections_that_come_break )
{
    stability_trace trace = make_trace();
    trace.intersections_after = 3;
    assert_trace( &trace, STABILITY_INTERSECTIONS, "3 edges pass through triangles" );
    trace = make_trace();
    trace.intersections_before = 1;
    trace.intersections_after = 3;
    assert_trace( &trace, STABILITY_HOLDS, "" );
}

static void set_speeds( stability_trace* trace, double early, double late, double travel )
{
    for ( int row = 0; row <= STEPS; ++row )
    {
        stability_sample* s = stability_sample_of( trace, row, 0 );
        s->speed = row < STEPS / 2 ? early : late;
        s->centre[0] = travel * trace->times[row];
    }
}

TEST( motion_that_does_not_die_breaks )
{
    stability_trace trace = make_trace();
    set_speeds( &trace, 0.2, 0.21, 0.0 );
    assert_trace( &trace, STABILITY_REST, "moves with 0.21 m/s at the end" );
    trace = make_trace();
    set_speeds( &trace, 0.2, 0.1, 0.0 ); // it dies
    assert_trace( &trace, STABILITY_HOLDS, "" );
    trace = make_trace();
    set_speeds( &trace, 0.2, 0.21, 0.0 );
    trace.rounding = 0.05; // far from the origin
    assert_trace( &trace, STABILITY_HOLDS, "" );
    trace = make_trace();
    set_speeds( &trace, 0.01, 0.02, 0.0 ); // slower than a hundredth of a fall
    assert_trace( &trace, STABILITY_HOLDS, "" );
    trace = make_trace();
    set_speeds( &trace, 0.6, 0.5, 0.0 ); // hardly, in three seconds of 2 1/s
    assert_trace( &trace, STABILITY_REST, "moves with 0.5 m/s at the end" );
    trace = make_trace();
    set_speeds( &trace, 0.2, 0.21, 0.2 ); // it slides
    assert_trace( &trace, STABILITY_HOLDS, "" );
    trace = make_trace();
    set_speeds( &trace, 0.2, 0.21, 0.0 );
    trace.bodies[1].damping = 0.0; // the other one keeps it in motion
    assert_trace( &trace, STABILITY_HOLDS, "" );
}

TEST( runs_that_differ_at_another_size_break )
{
    stability_trace trace = make_trace(), twin = make_trace();
    stability_verdict verdict = { .check = STABILITY_HOLDS };
    assert_true( torture_compare_traces( &trace, &twin, STABILITY_SCALE, &verdict ) );
    trace.bodies[0].stretch = 0.01;
    twin.bodies[0].stretch = 0.4; // other folds
    assert_true( torture_compare_traces( &trace, &twin, STABILITY_SCALE, &verdict ) );
    trace.bodies[0].softness = twin.bodies[0].softness = 0.2;
    twin.bodies[0].stretch = 0.7;
    assert_false( torture_compare_traces( &trace, &twin, STABILITY_SCALE, &verdict ) );
    assert_judged( verdict, STABILITY_SCALE );
    twin.bodies[0].is_halted = true;
    assert_false( torture_compare_traces( &trace, &twin, STABILITY_SHIFT, &verdict ) );
    assert_judged( verdict, STABILITY_SHIFT );
    assert_contains( verdict.message, "100 m away: cloth was halted" );
    stability_trace_release( &trace );
    stability_trace_release( &twin );
}

TEST( runs_with_other_bits_break )
{
    const uint64_t expected[] = { 1, 2, 3 }, other[] = { 1, 2, 4 };
    stability_verdict verdict = { .check = STABILITY_HOLDS };
    assert_true( stability_compare_bits( expected, 3, expected, 3, STABILITY_BITS, 0, "with 2 workers", &verdict ) );
    assert_false( stability_compare_bits( expected, 3, other, 3, STABILITY_BITS, 0, "with 2 workers", &verdict ) );
    assert_judged( verdict, STABILITY_BITS );
    assert_contains( verdict.message, "step 3 has other bits with 2 workers" );
    assert_false(
        stability_compare_bits( expected, 3, expected, 2, STABILITY_SNAPSHOT, 10, "in a new world", &verdict ) );
    assert_judged( verdict, STABILITY_SNAPSHOT );
    assert_int_equal( verdict.step, 13 );
}

// ---- scenes ----

static const char QUIET[] = "wisp: 1\n"
                            "steps: 120\n"
                            "surfaces:\n"
                            "  - name: cloth\n"
                            "    generate: { shape: plane, columns: 6, rows: 6, spacing: 0.04 }\n"
                            "    transform: { translate: [0, 0.3, 0] }\n"
                            "    pins: [0, 5]\n"
                            "    cloth: {}\n"
                            "    damping: 1\n"
                            "    contact: { thickness: 0.004 }\n"
                            "colliders:\n"
                            "  - { name: ground, shape: plane }\n";

TEST( a_cloth_that_hangs_holds_with_all_twins )
{
    assert_judged( judge_text( QUIET, TORTURE_TWIN_ALL ), STABILITY_HOLDS );
}

TEST( a_scene_that_the_reader_refuses_is_refused )
{
    const stability_verdict verdict = judge_text( "wisp: 1\nsteps: -1\n", 0 );
    assert_judged( verdict, STABILITY_REFUSED );
    assert_contains( verdict.message, "steps: got" );
}

// The mesh is open, which only the engine finds.
TEST( a_scene_that_the_engine_refuses_is_refused )
{
    assert_judged( judge_text( "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: plane }, balloon: {} }\n", 0 ),
                   STABILITY_REFUSED );
}

TEST( a_scene_without_an_end_is_stopped )
{
    text_node* tree = parse_scene( "wisp: 1\nsteps: 1000000\nsubsteps: 100\nsurfaces:\n  - { name: a, generate: { "
                                   "shape: plane }, cloth: {} }\n" );
    const torture_subject subject = { tree, "test" };
    const stability_verdict verdict = torture_judge_scene( &subject, 0, 0.3 );
    assert_judged( verdict, STABILITY_TIME );
    text_release( tree );
}

// A subject without a name is an address that the child cannot read.
TEST( a_process_that_dies_is_a_crash )
{
    text_node* tree = parse_scene( "wisp: 1\n" );
    const torture_subject subject = { tree, NULL };
    assert_judged( torture_judge_scene( &subject, 0, 60.0 ), STABILITY_CRASH );
    text_release( tree );
}

// ---- size and place ----

TEST( a_scene_at_another_size_is_another_choice_of_the_metre )
{
    text_node* tree =
        parse_scene( "wisp: 1\n"
                     "surfaces:\n"
                     "  - name: a\n"
                     "    generate: { shape: icosphere, radius: 0.2 }\n"
                     "    transform: { translate: [0, 1, 0] }\n"
                     "    pin_nearest: [[0, 1.2, 0]]\n"
                     "    area_density: 0.1\n"
                     "    balloon: { temperature: 300, edge_stiffness: 500 }\n"
                     "colliders:\n"
                     "  - { name: b, shape: sphere, keyframes: [{ time: 1, position: [1, 2, 3] }] }\n" );
    torture_scale( tree, 10.0 );
    char* text = text_write( tree, NULL );
    assert_contains( text, "gravity: [0, -98" ); // m/s^2, by default
    assert_contains( text, "radius: 2" );
    assert_contains( text, "translate: [0, 10, 0]" );
    assert_contains( text, "pin_nearest: [[0, 12, 0]]" );
    assert_contains( text, "area_density: 0.001" );
    assert_contains( text, "temperature: 30000" );
    assert_contains( text, "edge_stiffness: 500" );
    assert_contains( text, "atmospheric_pressure: 10132.5" );
    assert_contains( text, "radius: 10\n" ); // of the sphere, by default
    assert_contains( text, "time: 1, position: [10, 20, 30]" );
    free( text );
    text_release( tree );
}

TEST( a_scene_elsewhere_has_all_places_moved )
{
    text_node* tree =
        parse_scene( "wisp: 1\n"
                     "surfaces:\n"
                     "  - name: a\n"
                     "    generate: { shape: plane }\n"
                     "    pin_nearest: [[1, 2, 3]]\n"
                     "    pin_keyframes: [{ time: 1, translate: [0, 0, 1] }]\n"
                     "colliders:\n"
                     "  - { name: b, shape: sphere, keyframes: [{ time: 1, position: [1, 2, 3] }] }\n" );
    torture_shift( tree, ( const double[] ){ 100.0, 0.0, 10.0 } );
    char* text = text_write( tree, NULL );
    assert_contains( text, "transform: { translate: [100, 0, 10] }" );
    assert_contains( text, "pin_nearest: [[101, 2, 13]]" );
    assert_contains( text, "translate: [0, 0, 1]" );
    assert_contains( text, "position: [100, 0, 10]" );
    assert_contains( text, "position: [101, 2, 13]" );
    free( text );
    text_release( tree );
}
