// Which passes share a wave, which are fused, and which groups leave the substep loop for the item loop.
#include "plan_fixture.h"

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
    wisp_world* world = OPEN_WORLD( CHAIN );
    request( world, add_with( world, "" ), "C" );
    assert_string_equal( plan_text( world ), "[after] a+b+c" );
    step( world );
    assert_string_equal( trace_text(), "a1.0 b1.0 c1.0 a1.1 b1.1 c1.1 a1.2 b1.2 c1.2" );
    wisp_world_destroy( world );
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
    wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "CD" ), "BC" );
    assert_string_equal( plan_text( world ),
                         "[substep] particles [item loop] predict+project+velocity [after] shape" );
    wisp_world_destroy( world );
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
    wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "A" ), "A" );
    assert_string_equal( plan_text( world ), expected );
    wisp_world_destroy( world );
}
