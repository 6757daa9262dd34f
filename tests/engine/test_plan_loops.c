// Which entities run all their substeps before the next one does, and which share the waves of every substep.
#include "plan_fixture.h"

#define ENTITY WISP_DOMAIN_ENTITY
#define PREDICT WISP_STAGE_PREDICT
#define PROJECT WISP_STAGE_PROJECT
#define VELOCITY WISP_STAGE_VELOCITY

// A world with one substep more and some iterations, on one worker.
static wisp_world* open_steps( const fake_pass* passes, int count, int iterations )
{
    declare_fakes( passes, count );
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 2;
    def.iterations = iterations;
    def.workers = 1;
    return open_world_with( &def );
}

#define OPEN_STEPS( passes, iterations ) open_steps( passes, WISP_COUNT( passes ), iterations )

// Entities with A whose C is requested.
static void add_pair( wisp_world* world )
{
    request( world, add_with( world, "A" ), "C" );
    request( world, add_with( world, "A" ), "C" );
}

static const char* trace_of_step( wisp_world* world )
{
    step( world );
    return trace_text();
}

static const fake_pass CHAIN[] = {
    { "a", PREDICT, ENTITY, .required = "A", .reads = "A", .writes = "A" },
    { "b", PROJECT, ENTITY, .required = "A", .reads = "A", .writes = "A" },
    { "c", VELOCITY, ENTITY, .required = "A", .reads = "A", .writes = "C" },
};

TEST( small_entities_run_one_after_another )
{
    wisp_world* world = OPEN_STEPS( CHAIN, 1 );
    add_pair( world );
    assert_string_equal( trace_of_step( world ), "a1 b1 c1 a1 b1 c1 a2 b2 c2 a2 b2 c2" );
    wisp_world_destroy( world );
}

TEST( iterations_run_inside_a_substep )
{
    wisp_world* world = OPEN_STEPS( CHAIN, 2 );
    add_pair( world );
    step( world );
    static const struct
    {
        const char* name;
        int substep, iteration;
    } expected[] = { { "a", 0, 0 }, { "b", 0, 0 }, { "b", 0, 1 }, { "c", 0, 1 },
                     { "a", 1, 0 }, { "b", 1, 0 }, { "b", 1, 1 }, { "c", 1, 1 } };
    for ( int i = 0; i < WISP_COUNT( expected ); ++i )
    {
        assert_string_equal( fake.runs[i].pass->name, expected[i].name );
        assert_int_equal( fake.runs[i].span.substep, expected[i].substep );
        assert_int_equal( fake.runs[i].span.iteration, expected[i].iteration );
    }
    wisp_world_destroy( world );
}

// With two substeps of the world, 3 are rounded up to 4.
TEST( an_entity_has_the_substeps_that_it_asks_for )
{
    wisp_world* world = OPEN_STEPS( CHAIN, 1 );
    wisp_entity pair[2];
    for ( int i = 0; i < 2; ++i )
    {
        pair[i] = add_with( world, "A" );
        request( world, pair[i], "C" );
    }
    assert_int_equal( wisp_set_substeps( world, pair[1], 3 ), WISP_OK );
    assert_string_equal( trace_of_step( world ), "a1 b1 c1 a1 b1 c1 a2 b2 c2 a2 b2 c2 a2 b2 c2 a2 b2 c2" );
    assert_int_equal( wisp_set_substeps( world, pair[1], 0 ), WISP_OK );
    assert_string_equal( trace_of_step( world ), "a1 b1 c1 a1 b1 c1 a2 b2 c2 a2 b2 c2" );
    assert_int_equal( wisp_set_substeps( world, pair[1], -1 ), WISP_BAD_INPUT );
    assert_non_null( strstr( wisp_world_message( world ), "substeps: got -1, expected 0 to 1000000" ) );
    assert_int_equal( wisp_set_substeps( world, ( wisp_entity ){ 9, 9 }, 1 ), WISP_STALE_ID );
    wisp_world_destroy( world );
}

// Waves of the one, then those of the other: iterations keep a single entity without a loop of its own in waves.
TEST( waves_of_entities_with_other_substeps_run_one_after_another )
{
    static const fake_pass passes[] = {
        { "a", PREDICT, ENTITY, .required = "A", .reads = "A", .writes = "A", .asks = true },
        { "c", VELOCITY, ENTITY, .required = "A", .reads = "A", .writes = "C" },
    };
    wisp_world* world = OPEN_STEPS( passes, 1 );
    const wisp_entity fine = add_with( world, "A" ), coarse = add_with( world, "A" );
    request( world, fine, "C" );
    request( world, coarse, "C" );
    fake.due = true;
    assert_int_equal( wisp_set_substeps( world, fine, 4 ), WISP_OK );
    assert_string_equal( trace_of_step( world ), "a2 c2 a2 c2 a1 c1 a1 c1 a1 c1 a1 c1" );
    wisp_plan_info* info = NULL;
    assert_int_equal( wisp_world_explain( world, &info ), WISP_OK );
    assert_int_equal( info->passes[0].runs, 4 );
    assert_int_equal( info->passes[0].fewest_runs, 2 );
    wisp_plan_info_release( info );
    wisp_world_destroy( world );
}

// They follow surfaces from substep to substep.
TEST( a_follower_in_the_substep_loop_keeps_all_in_waves )
{
    static const fake_pass passes[] = {
        { "whole", PREDICT, ENTITY, .required = "A", .reads = "A", .writes = "A" },
        { "part", PREDICT, WISP_DOMAIN_STRAND_GROUP, .required = "A", .reads = "A", .writes = "A", .follows = true,
          .grain = 2 },
        { "c", VELOCITY, ENTITY, .required = "A", .reads = "A", .writes = "C" },
    };
    wisp_world* world = OPEN_STEPS( passes, 1 );
    add_pair( world );
    assert_string_equal( trace_of_step( world ), "whole1 whole2 part1.0-2 part1.2 part2.0-2 part2.2 c1 c2 "
                                                 "whole1 whole2 part1.0-2 part1.2 part2.0-2 part2.2 c1 c2" );
    wisp_world_destroy( world );
}

TEST( a_pass_over_several_entities_keeps_those_it_touches_together )
{
    static const fake_pass passes[] = {
        { "a", PREDICT, ENTITY, .required = "A", .reads = "A", .writes = "A" },
        { "meet", WISP_STAGE_CONTACT, ENTITY, .required = "M", .reads = "M", .writes = "D", .foreign = "A" },
        { "c", VELOCITY, ENTITY, .required = "A", .reads = "A", .writes = "C" },
        { "e", VELOCITY, ENTITY, .required = "E", .reads = "E", .writes = "F" },
    };
    wisp_world* world = OPEN_STEPS( passes, 1 );
    add_pair( world );
    request( world, add_with( world, "M" ), "D" );
    request( world, add_with( world, "E" ), "F" );
    request( world, add_with( world, "E" ), "F" );
    assert_string_equal( trace_of_step( world ), "a1 a2 meet3 c1 c2 a1 a2 meet3 c1 c2 e4 e4 e5 e5" );
    // those that it touches have the substeps of the one with the most; the others have theirs
    assert_int_equal( wisp_set_substeps( world, ( wisp_entity ){ 1, 1 }, 4 ), WISP_OK );
    assert_string_equal( trace_of_step( world ), "a1 a2 meet3 c1 c2 a1 a2 meet3 c1 c2 a1 a2 meet3 c1 c2 "
                                                 "a1 a2 meet3 c1 c2 e4 e4 e5 e5" );
    wisp_world_destroy( world );
}

// Entities without the component are left alone: they keep their loops and their substeps.
TEST( a_pass_keeps_together_only_those_among_which_it_works )
{
    static const fake_pass passes[] = {
        { "a", PREDICT, ENTITY, .required = "A", .reads = "A", .writes = "A" },
        { "meet", WISP_STAGE_CONTACT, ENTITY, .required = "M", .reads = "M", .writes = "D", .foreign = "A",
          .among = 'P' },
        { "c", VELOCITY, ENTITY, .required = "A", .reads = "A", .writes = "C" },
    };
    wisp_world* world = OPEN_STEPS( passes, 1 );
    const wisp_entity guest = add_with( world, "AP" );
    request( world, guest, "C" );
    add_pair( world );
    request( world, add_with( world, "M" ), "D" );
    assert_int_equal( wisp_set_substeps( world, guest, 4 ), WISP_OK );
    assert_string_equal( trace_of_step( world ), "a1 meet4 c1 a1 meet4 c1 a1 meet4 c1 a1 meet4 c1 "
                                                 "a2 c2 a2 c2 a3 c3 a3 c3" );
    wisp_world_destroy( world );
}

TEST( a_pass_that_is_asked_in_every_substep_keeps_its_entities_together )
{
    static const fake_pass passes[] = {
        { "a", PREDICT, ENTITY, .required = "A", .reads = "A", .writes = "A", .asks = true },
        { "c", VELOCITY, ENTITY, .required = "A", .reads = "A", .writes = "C" },
    };
    wisp_world* world = OPEN_STEPS( passes, 1 );
    add_pair( world );
    assert_string_equal( trace_of_step( world ), "a1 a2 c1 c2 a1 a2 c1 c2" );
    wisp_world_destroy( world );
}

TEST( what_watches_a_loop_runs_behind_it )
{
    static const fake_pass passes[] = {
        { "a", PREDICT, ENTITY, .required = "A", .reads = "A", .writes = "B" },
        { "watch", WISP_STAGE_OBSERVE, ENTITY, .reads = "B", .writes = "C", .on_change = 'B' },
    };
    wisp_world* world = OPEN_STEPS( passes, 1 );
    add_pair( world );
    const char* expected = "a1 a1 a2 a2 watch1 watch2";
    assert_string_equal( trace_of_step( world ), expected );
    assert_string_equal( trace_of_step( world ), expected );
    wisp_world_destroy( world );
}

TEST( a_profile_counts_all_items )
{
    wisp_world* world = OPEN_STEPS( CHAIN, 3 );
    add_pair( world );
    step( world );
    const wisp_profile profile = wisp_world_profile( world );
    assert_int_equal( profile.count, 3 );
    for ( int i = 0; i < profile.count; ++i )
    {
        const bool iterated = strcmp( profile.lines[i].pass, "b" ) == 0;
        assert_int_equal( profile.lines[i].items, 2 * 2 * ( iterated ? 3 : 1 ) );
    }
    wisp_world_destroy( world );
}
