// Passes that exclude components: which exist, their line in the printed plan, and that the engine's own passes skip
// surfaces with an external solver.
#include "plan_fixture.h"

#include "wisp/fabric.h"
#include "wisp/module/components.h"

#define GROUP WISP_DOMAIN_STRAND_GROUP
#define SHAPE WISP_STAGE_SHAPE

// ---- which passes exist ----

static const fake_pass SHY[] = { { "shy", SHAPE, GROUP, .required = "N", .excluded = "L", .writes = "A" } };

TEST( a_pass_exists_for_what_lacks_the_component )
{
    ASSERT_PLAN( SHY, "N", "A", "[after] shy" );
}

TEST( a_pass_is_absent_for_what_has_the_component )
{
    wisp_world* world = OPEN_WORLD( SHY );
    wisp_entity e = add_with( world, "NLA" );
    request( world, e, "A" );
    assert_string_equal( plan_text( world ), "" );
    step( world );
    assert_string_equal( trace_text(), "" );
    wisp_world_destroy( world );
}

TEST( each_entity_of_a_mixed_world_is_queried_for_itself )
{
    static const fake_pass passes[] = {
        { "a", SHAPE, GROUP, .required = "N", .excluded = "L", .writes = "A" },
        { "b", SHAPE, GROUP, .required = "NL", .writes = "A" },
        { "c", SHAPE, GROUP, .required = "N", .excluded = "LM", .writes = "A" },
    };
    wisp_world* world = OPEN_WORLD( passes );
    static const char* const KINDS[] = { "N", "NL", "NM", "NLM", "N" };
    for ( int i = 0; i < WISP_COUNT( KINDS ); ++i )
    {
        request( world, add_with( world, KINDS[i] ), "A" );
    }
    step( world );
    assert_string_equal( trace_text(), "a1.0 c1.0 a1.1 c1.1 a1.2 c1.2 b2.0 b2.1 b2.2 a3.0 a3.1 a3.2 b4.0 b4.1 b4.2 "
                                       "a5.0 c5.0 a5.1 c5.1 a5.2 c5.2" );
    wisp_world_destroy( world );
}

TEST( a_pass_comes_and_goes_with_the_component )
{
    wisp_world* world = OPEN_WORLD( SHY );
    wisp_entity e = add_with( world, "NA" );
    request( world, e, "A" );
    assert_int_equal( wisp_world_plan_passes( world ), 1 );
    assert_int_equal( wisp_world_attach( world, e, letter( 'L' ) ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( world ), 0 );
    assert_int_equal( wisp_world_detach( world, e, letter( 'L' ) ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( world ), 1 );
    wisp_world_destroy( world );
}

TEST( a_request_for_the_component_keeps_nobody_out )
{
    static const fake_pass passes[] = {
        { "make", SHAPE, GROUP, .required = "N", .writes = "L" },
        { "shy", SHAPE, GROUP, .required = "N", .excluded = "L", .writes = "A" },
    };
    ASSERT_PLAN( passes, "N", "LA", "[after] make,shy" );
}

TEST( what_a_pass_kept_out_would_have_written_is_missed_by_its_reader )
{
    static const fake_pass passes[] = {
        { "shy", SHAPE, GROUP, .excluded = "L", .writes = "A" },
        { "reader", SHAPE, GROUP, .reads = "A", .writes = "B" },
    };
    wisp_world* world = OPEN_WORLD( passes );
    request( world, add_with( world, "" ), "B" );
    assert_string_equal( plan_text( world ), "[after] shy+reader" );
    request( world, add_with( world, "L" ), "B" );
    assert_string_equal( plan_text( world ), "refused" );
    assert_non_null( strstr( wisp_world_message( world ), "fake.A" ) );
    wisp_world_destroy( world );
}

// ---- print ----

typedef struct printed
{
    char pass[40]; // whose line
    char line[512];
} printed;

static void keep_line( void* user, const char* line )
{
    printed* p = user;
    char name[48];
    snprintf( name, sizeof( name ), " %s ", p->pass );
    if ( strstr( line, name ) != NULL )
    {
        snprintf( p->line, sizeof( p->line ), "%s", line );
    }
}

static void assert_line( wisp_world* world, const char* pass, const char* word, const char* reason )
{
    printed p = { .line = "" };
    snprintf( p.pass, sizeof( p.pass ), "%s", pass );
    assert_int_equal( wisp_world_plan( world, keep_line, &p ), WISP_OK );
    if ( strstr( p.line, word ) == NULL || strstr( p.line, reason ) == NULL )
    {
        fail_msg( "'%s' does not say '%s' and '%s'", p.line, word, reason );
    }
}

TEST( a_printed_plan_says_what_keeps_a_pass_away )
{
    wisp_world* world = OPEN_WORLD( SHY );
    assert_line( world, "shy", "absent", "needs component fake.N, which no entity has" );
    wisp_entity kept_out = add_with( world, "NL" );
    assert_line( world, "shy", "absent", "excluded by component fake.L" );
    request( world, kept_out, "A" );
    assert_int_equal( wisp_world_attach( world, kept_out, letter( 'A' ) ), WISP_OK );
    assert_line( world, "shy", "absent", "excluded by component fake.L" );
    // the entity that is not excluded does not request it
    wisp_entity free = add_with( world, "N" );
    assert_line( world, "shy", "absent", "neither requested nor read: component fake.A" );
    request( world, free, "A" );
    assert_line( world, "shy", "wave", "fake.A requested by the scene" );
    assert_int_equal( wisp_remove( world, free ), WISP_OK );
    assert_line( world, "shy", "absent", "excluded by component fake.L" );
    wisp_world_destroy( world );
}

// ---- surfaces with an external solver ----

// A triangle with everything that makes the engine's own passes run: gravity, a moving pin, damping.
static wisp_entity add_surface( wisp_world* world )
{
    static const wisp_vec3 POINTS[3] = { { 0.0f, 0.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 1.0f } };
    static const int32_t CORNERS[3] = { 0, 1, 2 };
    static const int32_t PIN = 0;
    wisp_fabric_def fabric = wisp_default_fabric_def();
    fabric.points = POINTS;
    fabric.triangles = CORNERS;
    fabric.vertex_count = 3;
    fabric.triangle_count = 1;
    wisp_surface_def def = support_weightless_surface_def();
    def.pins = &PIN;
    def.pin_count = 1;
    wisp_error error = { WISP_OK, "" };
    assert_int_equal( wisp_fabric_cook( &fabric, NULL, &def.fabric, &error ), WISP_OK );
    wisp_entity e;
    assert_int_equal( wisp_add_surface( world, &def, &e ), WISP_OK );
    wisp_fabric_release( def.fabric );
    assert_int_equal( wisp_set_gravity( world, e, ( wisp_vec3 ){ 0.0f, -10.0f, 0.0f } ), WISP_OK );
    assert_int_equal( wisp_set_damping( world, e, 1.0f ), WISP_OK );
    assert_int_equal( wisp_move_pins( world, e, &PIN, &( wisp_vec3 ){ 0.5f, 0.0f, 0.0f }, 1 ), WISP_OK );
    assert_int_equal( wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    return e;
}

static const char* const MOVERS[] = { "particles.gravity", "particles.targets", "particles.predict",
                                      "particles.velocity", "particles.damping" };

TEST( a_solved_surface_is_moved_by_no_pass_of_the_engine )
{
    wisp_world* world = OPEN_WORLD( SHY );
    wisp_entity e = add_surface( world );
    for ( int i = 0; i < WISP_COUNT( MOVERS ); ++i )
    {
        assert_line( world, MOVERS[i], "wave", "" );
    }
    assert_int_equal( wisp_world_attach( world, e, WISP_PARTICLE_EXTERNAL_SOLVER ), WISP_OK );
    for ( int i = 0; i < WISP_COUNT( MOVERS ); ++i )
    {
        assert_line( world, MOVERS[i], "absent", "excluded by component particle.external_solver" );
    }
    step( world );
    wisp_view view;
    assert_int_equal( wisp_world_view( world, e, WISP_SURFACE_POINTS, &view ), WISP_OK );
    const wisp_vec3* points = view.data;
    assert_true( points[0].x == 0.0f && points[1].y == 0.0f && points[2].y == 0.0f );
    wisp_world_destroy( world );
}

TEST( a_surface_beside_a_solved_one_goes_on_falling )
{
    wisp_world* world = OPEN_WORLD( SHY );
    wisp_entity solved = add_surface( world ), other = add_surface( world );
    assert_int_equal( wisp_world_attach( world, solved, WISP_PARTICLE_EXTERNAL_SOLVER ), WISP_OK );
    step( world );
    wisp_view view;
    assert_int_equal( wisp_world_view( world, solved, WISP_SURFACE_POINTS, &view ), WISP_OK );
    assert_true( ( (const wisp_vec3*)view.data )[1].y == 0.0f );
    assert_int_equal( wisp_world_view( world, other, WISP_SURFACE_POINTS, &view ), WISP_OK );
    assert_true( ( (const wisp_vec3*)view.data )[1].y < -1e-4f );
    assert_true( ( (const wisp_vec3*)view.data )[0].x == 0.5f );
    wisp_world_destroy( world );
}

TEST( strain_limits_of_a_solved_surface_are_refused )
{
    wisp_world* world = OPEN_WORLD( SHY );
    wisp_entity e = add_surface( world );
    assert_int_equal( wisp_world_attach( world, e, WISP_PARTICLE_EXTERNAL_SOLVER ), WISP_OK );
    uint64_t before = wisp_world_hash( world );
    expect_refusal( world, wisp_set_strain_limit( world, e, 0.9f, 1.1f ), WISP_CONFLICT, "strain limits" );
    assert_int_equal( wisp_world_hash( world ), before );
    assert_false( wisp_world_has( world, e, WISP_LINK_LIMIT ) );
    assert_int_equal( wisp_set_strain_limit( world, e, 0.0f, INFINITY ), WISP_OK ); // there is none to remove
    assert_int_equal( wisp_world_detach( world, e, WISP_PARTICLE_EXTERNAL_SOLVER ), WISP_OK );
    assert_int_equal( wisp_set_strain_limit( world, e, 0.9f, 1.1f ), WISP_OK );
    wisp_world_destroy( world );
}
