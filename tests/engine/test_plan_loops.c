// Order of passes: which share a wave, which are fused, which entities run all their substeps before the next one does,
// and the place of passes that touch components of other entities, which neither make passes exist nor supply anything.
#include "plan_fixture.h"

// ---- waves ----

#define GROUP WISP_DOMAIN_STRAND_GROUP
#define ENTITY WISP_DOMAIN_ENTITY
#define SHAPE WISP_STAGE_SHAPE

static const fake_pass CHAIN[] = {
    { "d", SHAPE, GROUP, .reads = "C", .writes = "D" },
    { "c", SHAPE, GROUP, .reads = "B", .writes = "C" },
    { "b", SHAPE, GROUP, .reads = "A", .writes = "B" },
    { "a", SHAPE, GROUP, .writes = "A" },
};

TEST( passes_without_a_conflict_share_a_wave )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, GROUP, .reads = "N", .writes = "A" },
        { "b", SHAPE, GROUP, .reads = "N", .writes = "B" },
        { "c", SHAPE, ENTITY, .reads = "N", .writes = "C" },
    };
    ASSERT_PLAN( passes, "N", "ABC", "[after] a,b,c" );
}

TEST( any_pair_of_writes_or_of_a_read_and_a_write_conflicts )
{
    static const struct
    {
        const char *first_reads, *first_writes, *second_reads, *second_writes, *requests, *plan;
    } pairs[] = {
        { NULL, "A", "A", "B", "B", "[after] a b" },  // read after write
        { "A", "B", "A", "A", "AB", "[after] a b" },  // write after read
        { NULL, "A", NULL, "A", "A", "[after] a b" }, // write after write
        { "A", "B", "A", "C", "BC", "[after] a,b" },  // two reads
    };
    for ( int i = 0; i < WISP_COUNT( pairs ); ++i )
    {
        const fake_pass passes[] = {
            { "a", SHAPE, ENTITY, .reads = pairs[i].first_reads, .writes = pairs[i].first_writes },
            { "b", SHAPE, ENTITY, .reads = pairs[i].second_reads, .writes = pairs[i].second_writes },
        };
        ASSERT_PLAN( passes, "A", pairs[i].requests, pairs[i].plan );
    }
}

TEST( a_pass_moves_into_the_first_wave_behind_its_conflicts )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, ENTITY, .writes = "A" },
        { "b", SHAPE, ENTITY, .reads = "A", .writes = "B" },
        { "late", SHAPE, ENTITY, .reads = "B", .writes = "C" },
        { "early", SHAPE, ENTITY, .reads = "A", .writes = "D" },
        { "free", SHAPE, ENTITY, .writes = "E" },
    };
    ASSERT_PLAN( passes, "", "CDE", "[after] a,free b,early late" );
}

TEST( local_passes_over_the_same_groups_are_fused )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( CHAIN );
    request( world, add_with( world, "" ), "C" );
    assert_string_equal( plan_text( world ), "[after] a+b+c" );
    step( world );
    assert_string_equal( trace_text(), "a1.0 b1.0 c1.0 a1.1 b1.1 c1.1 a1.2 b1.2 c1.2" );
}

TEST( an_entity_pass_in_between_keeps_local_passes_apart )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, GROUP, .writes = "A" },
        { "whole", SHAPE, ENTITY, .reads = "A", .writes = "A" },
        { "b", SHAPE, GROUP, .reads = "A", .writes = "B" },
    };
    ASSERT_PLAN( passes, "", "B", "[after] a whole b" );
}

TEST( an_entity_pass_beside_does_not_keep_local_passes_apart )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, GROUP, .writes = "A" },
        { "beside", SHAPE, ENTITY, .writes = "C" },
        { "b", SHAPE, GROUP, .reads = "A", .writes = "B" },
    };
    ASSERT_PLAN( passes, "", "BC", "[after] a+b,beside" );
}

TEST( entity_passes_are_never_fused )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, ENTITY, .writes = "A" },
        { "b", SHAPE, ENTITY, .reads = "A", .writes = "B" },
        { "c", SHAPE, GROUP, .reads = "B", .writes = "C" },
    };
    ASSERT_PLAN( passes, "", "C", "[after] a b c" );
}

TEST( a_pass_behind_two_nodes_of_a_wave_is_not_fused_with_one_of_them )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, GROUP, .writes = "A" },
        { "b", SHAPE, GROUP, .writes = "B" },
        { "c", SHAPE, GROUP, .reads = "AB", .writes = "C" },
    };
    ASSERT_PLAN( passes, "", "C", "[after] a,b c" );
}

TEST( passes_of_another_loop_are_not_fused )
{
    static const fake_pass passes[] = {
        { "predict", WISP_STAGE_PREDICT, ENTITY, .writes = "A" },
        { "contact", WISP_STAGE_CONTACT, GROUP, .reads = "A", .writes = "A" },
        { "project", WISP_STAGE_PROJECT, GROUP, .reads = "A", .writes = "A" },
        { "shape", WISP_STAGE_SHAPE, GROUP, .reads = "A", .writes = "B" },
    };
    ASSERT_PLAN( passes, "", "B", "[substep] predict contact [iteration] project [after] shape" );
}

TEST( groups_run_their_substeps_item_by_item_behind_the_other_loops )
{
    static const fake_pass passes[] = {
        { "particles", WISP_STAGE_PREDICT, ENTITY, .reads = "C", .writes = "C" },
        { "velocity", WISP_STAGE_VELOCITY, GROUP, .reads = "A", .writes = "A" },
        { "predict", WISP_STAGE_PREDICT, GROUP, .reads = "D", .writes = "A" },
        { "project", WISP_STAGE_PROJECT, GROUP, .reads = "A", .writes = "A" },
        { "shape", WISP_STAGE_SHAPE, GROUP, .reads = "A", .writes = "B" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "CD" ), "BC" );
    assert_string_equal( plan_text( world ),
                         "[substep] particles [item loop] predict+project+velocity [after] shape" );
}

TEST( groups_stay_in_the_substep_loop_if_another_pass_there_reads_what_they_write )
{
    static const fake_pass passes[] = {
        { "predict", WISP_STAGE_PREDICT, GROUP, .writes = "A" },
        { "sum", WISP_STAGE_CONTACT, ENTITY, .reads = "A", .writes = "B" },
    };
    ASSERT_PLAN( passes, "", "B", "[substep] predict sum" );
}

TEST( groups_stay_in_the_substep_loop_if_another_pass_there_writes_what_they_read )
{
    static const fake_pass passes[] = {
        { "wind", WISP_STAGE_FORCE, ENTITY, .writes = "B" },
        { "predict", WISP_STAGE_PREDICT, GROUP, .reads = "B", .writes = "A" },
    };
    ASSERT_PLAN( passes, "", "A", "[substep] wind predict" );
}

TEST( groups_whose_passes_ask_whether_they_are_due_stay_in_the_substep_loop )
{
    static const fake_pass passes[] = {
        { "predict", WISP_STAGE_PREDICT, GROUP, .writes = "A", .asks = true },
        { "project", WISP_STAGE_PROJECT, GROUP, .reads = "A", .writes = "A" },
    };
    ASSERT_PLAN( passes, "", "A", "[substep] predict [iteration] project" );
}

TEST( a_node_takes_only_so_many_passes )
{
    static char names[PLAN_MAX_FUSED + 1][4];
    fake_pass passes[PLAN_MAX_FUSED + 1];
    char expected[sizeof( names ) + 16] = "[after] ";
    for ( int i = 0; i < WISP_COUNT( passes ); ++i )
    {
        snprintf( names[i], sizeof( names[i] ), "%d", i % 100 );
        passes[i] = ( fake_pass ){ names[i], SHAPE, GROUP, .reads = "A", .writes = "A" };
        strcat( strcat( expected, i == 0 ? "" : i < PLAN_MAX_FUSED ? "+" : " " ), names[i] );
    }
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "A" ), "A" );
    assert_string_equal( plan_text( world ), expected );
}

// ---- loops ----
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

static const fake_pass LOOP[] = {
    { "a", PREDICT, ENTITY, .required = "A", .reads = "A", .writes = "A" },
    { "b", PROJECT, ENTITY, .required = "A", .reads = "A", .writes = "A" },
    { "c", VELOCITY, ENTITY, .required = "A", .reads = "A", .writes = "C" },
};

TEST( small_entities_run_one_after_another )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_STEPS( LOOP, 1 );
    add_pair( world );
    assert_string_equal( trace_of_step( world ), "a1 b1 c1 a1 b1 c1 a2 b2 c2 a2 b2 c2" );
}

TEST( iterations_run_inside_a_substep )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_STEPS( LOOP, 2 );
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
}

// With two substeps of the world, 3 are rounded up to 4.
TEST( an_entity_has_the_substeps_that_it_asks_for )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_STEPS( LOOP, 1 );
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
}

// Waves of the one, then those of the other: iterations keep a single entity without a loop of its own in waves.
TEST( waves_of_entities_with_other_substeps_run_one_after_another )
{
    static const fake_pass passes[] = {
        { "a", PREDICT, ENTITY, .required = "A", .reads = "A", .writes = "A", .asks = true },
        { "c", VELOCITY, ENTITY, .required = "A", .reads = "A", .writes = "C" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_STEPS( passes, 1 );
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
    SCOPED( destroy_local ) wisp_world* world = OPEN_STEPS( passes, 1 );
    add_pair( world );
    assert_string_equal( trace_of_step( world ), "whole1 whole2 part1.0-2 part1.2 part2.0-2 part2.2 c1 c2 "
                                                 "whole1 whole2 part1.0-2 part1.2 part2.0-2 part2.2 c1 c2" );
}

TEST( a_pass_over_several_entities_keeps_those_it_touches_together )
{
    static const fake_pass passes[] = {
        { "a", PREDICT, ENTITY, .required = "A", .reads = "A", .writes = "A" },
        { "meet", WISP_STAGE_CONTACT, ENTITY, .required = "M", .reads = "M", .writes = "D", .foreign = "A" },
        { "c", VELOCITY, ENTITY, .required = "A", .reads = "A", .writes = "C" },
        { "e", VELOCITY, ENTITY, .required = "E", .reads = "E", .writes = "F" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_STEPS( passes, 1 );
    add_pair( world );
    request( world, add_with( world, "M" ), "D" );
    request( world, add_with( world, "E" ), "F" );
    request( world, add_with( world, "E" ), "F" );
    assert_string_equal( trace_of_step( world ), "a1 a2 meet3 c1 c2 a1 a2 meet3 c1 c2 e4 e4 e5 e5" );
    // those that it touches have the substeps of the one with the most; the others have theirs
    assert_int_equal( wisp_set_substeps( world, ( wisp_entity ){ 1, 1 }, 4 ), WISP_OK );
    assert_string_equal( trace_of_step( world ), "a1 a2 meet3 c1 c2 a1 a2 meet3 c1 c2 a1 a2 meet3 c1 c2 "
                                                 "a1 a2 meet3 c1 c2 e4 e4 e5 e5" );
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
    SCOPED( destroy_local ) wisp_world* world = OPEN_STEPS( passes, 1 );
    const wisp_entity guest = add_with( world, "AP" );
    request( world, guest, "C" );
    add_pair( world );
    request( world, add_with( world, "M" ), "D" );
    assert_int_equal( wisp_set_substeps( world, guest, 4 ), WISP_OK );
    assert_string_equal( trace_of_step( world ), "a1 meet4 c1 a1 meet4 c1 a1 meet4 c1 a1 meet4 c1 "
                                                 "a2 c2 a2 c2 a3 c3 a3 c3" );
}

TEST( a_pass_that_is_asked_in_every_substep_keeps_its_entities_together )
{
    static const fake_pass passes[] = {
        { "a", PREDICT, ENTITY, .required = "A", .reads = "A", .writes = "A", .asks = true },
        { "c", VELOCITY, ENTITY, .required = "A", .reads = "A", .writes = "C" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_STEPS( passes, 1 );
    add_pair( world );
    assert_string_equal( trace_of_step( world ), "a1 a2 c1 c2 a1 a2 c1 c2" );
}

TEST( what_watches_a_loop_runs_behind_it )
{
    static const fake_pass passes[] = {
        { "a", PREDICT, ENTITY, .required = "A", .reads = "A", .writes = "B" },
        { "watch", WISP_STAGE_OBSERVE, ENTITY, .reads = "B", .writes = "C", .on_change = 'B' },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_STEPS( passes, 1 );
    add_pair( world );
    const char* expected = "a1 a1 a2 a2 watch1 watch2";
    assert_string_equal( trace_of_step( world ), expected );
    assert_string_equal( trace_of_step( world ), expected );
}

TEST( a_profile_counts_all_items )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_STEPS( LOOP, 3 );
    add_pair( world );
    step( world );
    const wisp_profile profile = wisp_world_profile( world );
    assert_int_equal( profile.count, 3 );
    for ( int i = 0; i < profile.count; ++i )
    {
        const bool iterated = strcmp( profile.lines[i].pass, "b" ) == 0;
        assert_int_equal( profile.lines[i].items, 2 * 2 * ( iterated ? 3 : 1 ) );
    }
}

// ---- passes that touch other entities ----
#define FORCE WISP_STAGE_FORCE

static const fake_pass ACROSS[] = {
    { "first", SHAPE, GROUP, .required = "N", .writes = "A" },
    { "meet", SHAPE, ENTITY, .required = "M", .writes = "B", .foreign = "A" },
    { "last", SHAPE, GROUP, .required = "N", .reads = "A", .writes = "C" },
};

TEST( it_runs_between_those_before_and_those_behind_it )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( ACROSS );
    request( world, add_with( world, "N" ), "C" );
    request( world, add_with( world, "M" ), "B" );
    assert_string_equal( plan_text( world ), "[after] first meet last" );
    step( world );
    assert_string_equal( trace_text(), "first1.0-3 meet2 last1.0-3" );
}

TEST( without_it_the_same_passes_share_waves )
{
    static const fake_pass passes[] = {
        { "first", SHAPE, GROUP, .required = "N", .writes = "A" },
        { "meet", SHAPE, ENTITY, .required = "M", .writes = "B" },
        { "last", SHAPE, GROUP, .required = "N", .reads = "A", .writes = "C" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "N" ), "C" );
    request( world, add_with( world, "M" ), "B" );
    assert_string_equal( plan_text( world ), "[after] first+last,meet" );
}

TEST( it_makes_no_pass_of_another_entity_exist )
{
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( ACROSS );
    add_with( world, "N" ); // nothing requests a component of it
    request( world, add_with( world, "M" ), "B" );
    assert_string_equal( plan_text( world ), "[after] meet" );
}

TEST( it_supplies_nothing )
{
    static const fake_pass passes[] = {
        { "meet", SHAPE, ENTITY, .required = "M", .writes = "B", .foreign = "A" },
        { "last", SHAPE, GROUP, .required = "N", .reads = "A", .writes = "C" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "M" ), "B" );
    request( world, add_with( world, "N" ), "C" );
    assert_string_equal( plan_text( world ), "refused" );
}

TEST( two_of_them_never_share_a_wave )
{
    static const fake_pass passes[] = {
        { "one", SHAPE, ENTITY, .required = "M", .writes = "B", .foreign = "A" },
        { "two", SHAPE, ENTITY, .required = "M", .writes = "C", .foreign = "A" },
    };
    ASSERT_PLAN( passes, "M", "BC", "[after] one two" );
}

TEST( groups_that_it_touches_stay_in_the_substep_loop )
{
    static const fake_pass passes[] = {
        { "move", FORCE, GROUP, .required = "N", .reads = "A", .writes = "A" },
        { "meet", WISP_STAGE_CONTACT, ENTITY, .required = "M", .writes = "B", .foreign = "A" },
    };
    SCOPED( destroy_local ) wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "NA" ), "A" );
    assert_string_equal( plan_text( world ), "[item loop] move" );
    request( world, add_with( world, "M" ), "B" );
    assert_string_equal( plan_text( world ), "[substep] move meet" );
}
