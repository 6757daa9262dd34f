// Passes that touch components of other entities: their place among those entities' passes, and that they neither
// make passes exist nor supply anything.
#include "plan_fixture.h"

#define GROUP WISP_DOMAIN_STRAND_GROUP
#define ENTITY WISP_DOMAIN_ENTITY
#define SHAPE WISP_STAGE_SHAPE
#define FORCE WISP_STAGE_FORCE

static const fake_pass ACROSS[] = {
    { "first", SHAPE, GROUP, .required = "N", .writes = "A" },
    { "meet", SHAPE, ENTITY, .required = "M", .writes = "B", .foreign = "A" },
    { "last", SHAPE, GROUP, .required = "N", .reads = "A", .writes = "C" },
};

TEST( it_runs_between_those_before_and_those_behind_it )
{
    wisp_world* world = OPEN_WORLD( ACROSS );
    request( world, add_with( world, "N" ), "C" );
    request( world, add_with( world, "M" ), "B" );
    assert_string_equal( plan_text( world ), "[after] first meet last" );
    step( world );
    assert_string_equal( trace_text(), "first1.0-3 meet2 last1.0-3" );
    wisp_world_destroy( world );
}

TEST( without_it_the_same_passes_share_waves )
{
    static const fake_pass passes[] = {
        { "first", SHAPE, GROUP, .required = "N", .writes = "A" },
        { "meet", SHAPE, ENTITY, .required = "M", .writes = "B" },
        { "last", SHAPE, GROUP, .required = "N", .reads = "A", .writes = "C" },
    };
    wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "N" ), "C" );
    request( world, add_with( world, "M" ), "B" );
    assert_string_equal( plan_text( world ), "[after] first+last,meet" );
    wisp_world_destroy( world );
}

TEST( it_makes_no_pass_of_another_entity_exist )
{
    wisp_world* world = OPEN_WORLD( ACROSS );
    add_with( world, "N" ); // nothing requests a component of it
    request( world, add_with( world, "M" ), "B" );
    assert_string_equal( plan_text( world ), "[after] meet" );
    wisp_world_destroy( world );
}

TEST( it_supplies_nothing )
{
    static const fake_pass passes[] = {
        { "meet", SHAPE, ENTITY, .required = "M", .writes = "B", .foreign = "A" },
        { "last", SHAPE, GROUP, .required = "N", .reads = "A", .writes = "C" },
    };
    wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "M" ), "B" );
    request( world, add_with( world, "N" ), "C" );
    assert_string_equal( plan_text( world ), "refused" );
    wisp_world_destroy( world );
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
    wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "NA" ), "A" );
    assert_string_equal( plan_text( world ), "[item loop] move" );
    request( world, add_with( world, "M" ), "B" );
    assert_string_equal( plan_text( world ), "[substep] move meet" );
    wisp_world_destroy( world );
}
