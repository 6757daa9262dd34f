// What holds for every call that gives an entity something: a world without the module says so, a call without memory changes
// nothing, an entity of another kind or none is refused, so is a value out of its range, by its name, a step without memory is refused and
// the next ones are made, and all memory returns to the host.
#include "surface_fixture.h"

#include "balloon.h"
#include "boundary.h"
#include "collision.h"
#include "contact.h"
#include "create.h"
#include "guide_hair.h"
#include "implicit_cloth.h"
#include "membrane.h"
#include "motion_constraints.h"
#include "seams.h"
#include "strands.h"
#include "tearing.h"
#include "wisp/detail.h"
#include "wisp/moving_frame.h"
#include "wisp/sleep.h"

typedef struct stage
{
    hosted h;
    wisp_world* world;
    wisp_entity sheet, other, ball, hair, more;
    bool is_plain; // definitions are the defaults
} stage;

static const int32_t PAIRS[] = { 0, 0, 1, 1, 2, 2 };

// A number of a definition, and values just out of its range: NaN if that side is not tested, infinity if it has no end.
typedef struct field
{
    const char *call, *name;
    size_t at;
    bool is_whole;
    double lower, upper;
} field;

// What the next calls have in place of a value of theirs.
static const field* spoilt;
static double spoilt_value;

static void spoil( const char* call, void* def )
{
    if ( spoilt != NULL && strcmp( spoilt->call, call ) == 0 )
    {
        const int whole = spoilt->is_whole ? (int)spoilt_value : 0;
        const float number = (float)spoilt_value;
        memcpy( (char*)def + spoilt->at, spoilt->is_whole ? (const void*)&whole : &number, sizeof( float ) );
    }
}

// A call with its default definition, changed by the last argument.
#define CALL( name, call, changes )                                                                                  \
    static wisp_status give_##name( stage* s )                                                                       \
    {                                                                                                                \
        wisp_##name##_def d = wisp_default_##name##_def();                                                           \
        wisp_entity made;                                                                                            \
        (void)made;                                                                                                  \
        if ( s->is_plain == false )                                                                                  \
        {                                                                                                            \
            changes;                                                                                                 \
        }                                                                                                            \
        spoil( #name, &d );                                                                                          \
        return call;                                                                                                 \
    }

CALL( cloth, wisp_set_cloth( s->world, s->sheet, &d ),
      ( d.bending = WISP_CLOTH_BENDING_DIHEDRAL, d.drag_coefficient = d.internal_damping = 1.0f ) )
CALL( balloon, wisp_set_balloon( s->world, s->ball, &d ), d.inflation_rate = 1e-3f )
CALL( boundary, wisp_set_boundary( s->world, s->ball, &d ), d.spacing = 0.3f )
CALL( collider, wisp_add_collider( s->world, &d, &made ), d.kind = WISP_COLLIDER_PLANE )
CALL( collision, wisp_set_collision( s->world, s->sheet, &d ), d.features = WISP_COLLISION_ALL )
CALL( contact, wisp_set_contact( s->world, s->sheet, &d ), d.thickness = 0.01f )
CALL( implicit_cloth, wisp_set_implicit_cloth( s->world, s->other, &d ), d.integrator = WISP_INTEGRATOR_BDF2 )
CALL( environment, wisp_set_environment( s->world, s->hair, &d ), )
CALL( frozen_hair, wisp_set_frozen_hair( s->world, s->hair, &d ), )
CALL( ghosts, wisp_set_ghosts( s->world, s->more, &d ), d.targets = s->hair )
CALL( curves, wisp_add_curves( s->world, &d, &made ), d.source = s->hair )
CALL( strand_appearance, wisp_set_strand_appearance( s->world, s->hair, &d ), )
CALL( strand_dynamics, wisp_set_strand_dynamics( s->world, s->hair, &d ), )
CALL( membrane, wisp_set_membrane( s->world, s->ball, &d ), d.shear_modulus = 100.0f )
CALL( tearing, wisp_set_tearing( s->world, s->sheet, &d ), d.strength = 10.0f )
CALL( motion_constraints, wisp_set_motion_constraints( s->world, s->sheet, &d ), d.max_distance = 0.1f )
CALL( seam, wisp_add_seam( s->world, &d, &made ),
      ( d.a = s->sheet, d.b = s->other, d.pairs = PAIRS, d.pair_count = 3 ) )
CALL( detail, wisp_set_detail( s->world, s->more, &d ), d.level = WISP_DETAIL_COARSE )
CALL( sleep, wisp_set_sleep( s->world, s->sheet, &d ), )
CALL( moving_frame, wisp_set_moving_frame( s->world, s->sheet, &d ), )

enum
{
    OF_ENGINE = 1, // no module is needed
    ON_CLOTH = 2,  // what must be there before
    ON_STRANDS = 4,
    ON_GHOSTS = 8 | ON_STRANDS,
    ANY_ENTITY = 16, // of any kind
    NO_ENTITY = 32 | ANY_ENTITY,
    OTHER_FIRST = 128, // the default is a definition too
    AS_EVER = 64,      // a step that fails leaves what the next one makes as it would have been
};

static const struct
{
    const char* name;
    wisp_status ( *call )( stage* s );
    unsigned is;
} CALLS[] = {
    { "cloth", give_cloth, OTHER_FIRST },
    { "balloon", give_balloon, OTHER_FIRST },
    { "boundary", give_boundary, AS_EVER },
    { "collider", give_collider, NO_ENTITY | AS_EVER },
    { "collision", give_collision, OTHER_FIRST | ON_CLOTH | ANY_ENTITY },
    { "contact", give_contact, ON_CLOTH },
    { "implicit_cloth", give_implicit_cloth, OTHER_FIRST | AS_EVER },
    { "environment", give_environment, AS_EVER },
    { "frozen_hair", give_frozen_hair, 0 },
    { "ghosts", give_ghosts, ON_STRANDS },
    { "curves", give_curves, AS_EVER },
    { "strand_appearance", give_strand_appearance, AS_EVER },
    { "strand_dynamics", give_strand_dynamics, 0 },
    { "membrane", give_membrane, AS_EVER },
    { "tearing", give_tearing, ON_CLOTH },
    { "motion_constraints", give_motion_constraints, ON_CLOTH },
    { "seam", give_seam, ON_CLOTH },
    { "detail", give_detail, OF_ENGINE | ON_GHOSTS },
    { "sleep", give_sleep, OF_ENGINE | ON_CLOTH | ANY_ENTITY },
    { "moving_frame", give_moving_frame, OF_ENGINE | ON_CLOTH | ANY_ENTITY },
};

static wisp_entity add_mesh( wisp_world* world, test_mesh mesh )
{
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.hinges = true;
    const wisp_entity e = test_surface_of( world, &fabric, support_weightless_surface_def() );
    assert_status( world, wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    test_mesh_free( &mesh );
    return e;
}

// @param number of the call, for what must be there before; -1: nothing, and no module
static stage* open_stage( int number )
{
    stage* s = checked_calloc( 1, sizeof( stage ) );
    s->h.def = hosted_def( &s->h );
    s->h.def.modules = wisp_all_modules( &s->h.def.module_count );
    s->h.def.module_count = number < 0 ? 0 : s->h.def.module_count;
    assert_int_equal( wisp_world_create( &s->h.def, &s->h.world, NULL ), WISP_OK );
    s->world = s->h.world;
    s->sheet = add_mesh( s->world, test_plane( 5, 0.1f ) );
    s->other = add_mesh( s->world, test_plane( 5, 0.1f ) );
    s->ball = add_mesh( s->world, test_ball( 1 ) );
    s->hair = test_add_strands( s->world, 4, 5 );
    s->more = test_add_strands( s->world, 8, 5 );
    assert_status( s->world, wisp_request( s->world, s->hair, WISP_STRAND_POINTS ), WISP_OK );
    const unsigned is = number >= 0 ? CALLS[number].is : 0;
    assert_status( s->world, is & ON_CLOTH ? give_cloth( s ) : WISP_OK, WISP_OK );
    assert_status( s->world, is & ON_STRANDS ? give_strand_dynamics( s ) : WISP_OK, WISP_OK );
    assert_status( s->world, ( is & ON_GHOSTS ) == ON_GHOSTS ? give_ghosts( s ) : WISP_OK, WISP_OK );
    return s;
}

static void close_stage( stage* s )
{
    close_world( &s->h );
    free( s );
}

TEST( a_world_without_the_module_says_so )
{
    stage* s = open_stage( -1 );
    const uint64_t hash = wisp_world_hash( s->world );
    for ( int n = 0; n < WISP_COUNT( CALLS ); ++n )
    {
        if ( ( CALLS[n].is & OF_ENGINE ) == 0 )
        {
            expect_refusal( s->world, CALLS[n].call( s ), WISP_CONFLICT, "not registered" );
            assert_string_equal( s->h.log.last, wisp_world_message( s->world ) );
        }
    }
    assert_true( wisp_world_hash( s->world ) == hash );
    close_stage( s );
}

static void expect_call( stage* s, stage* entities, int n, wisp_status expected )
{
    const wisp_status status = CALLS[n].call( entities );
    if ( status != expected )
    {
        fail_msg( "%s: %s, '%s'", CALLS[n].name, wisp_status_name( status ), wisp_world_message( s->world ) );
    }
    assert_one_message( wisp_world_message( s->world ) );
}

// A call of a surface gets strands and the other way round, then what does not exist.
TEST( an_entity_of_another_kind_and_one_that_is_gone_are_refused )
{
    for ( int n = 0; n < WISP_COUNT( CALLS ); ++n )
    {
        stage* s = open_stage( n );
        const uint64_t hash = wisp_world_hash( s->world );
        stage other = *s, gone = *s;
        other.sheet = other.other = other.ball = s->hair;
        other.hair = other.more = s->sheet;
        gone.sheet = gone.other = gone.ball = gone.hair = gone.more = ( wisp_entity ){ 99, 1 };
        if ( ( CALLS[n].is & ANY_ENTITY ) == 0 )
        {
            expect_call( s, &other, n, WISP_CONFLICT );
        }
        if ( ( CALLS[n].is & NO_ENTITY ) == 0 )
        {
            expect_call( s, &gone, n, WISP_STALE_ID );
        }
        assert_true( wisp_world_hash( s->world ) == hash );
        close_stage( s );
    }
}

// ---- values ----

#define NUMBER( call, name, lower, upper )                                                                           \
    {                                                                                                                \
#call, #name, offsetof( wisp_##call##_def, name ), false, (double)( lower ), (double)( upper )               \
    }
#define WHOLE( call, name, lower, upper )                                                                            \
    {                                                                                                                \
#call, #name, offsetof( wisp_##call##_def, name ), true, ( lower ), ( upper )                                \
    }

static const field FIELDS[] = {
    WHOLE( cloth, solver, -1, WISP_SOLVER_COUNT ),
    WHOLE( cloth, bending, -1, WISP_CLOTH_BENDING_COUNT ),
    WHOLE( cloth, coarse_substeps, -2, 65 ),
    WHOLE( cloth, coarse_passes, -1, 66 ),
    NUMBER( cloth, warp_compliance, -1e-9f, 1.1e12f ),
    NUMBER( cloth, weft_compliance, -1e-9f, 1.1e12f ),
    NUMBER( cloth, shear_compliance, -1e-9f, 1.1e12f ),
    NUMBER( cloth, stretch_stiffness, -1e-9f, 1.0001f ),
    NUMBER( cloth, shear_stiffness, -1e-9f, 1.0001f ),
    NUMBER( cloth, bend_stiffness, -1e-9f, 1.0001f ),
    NUMBER( cloth, bend_compliance, -1e-9f, 1.1e12f ),
    NUMBER( cloth, bend_rigidity, 0.0f, 1.1e12f ),
    NUMBER( cloth, internal_damping, -1e-9f, 1.1e9f ),
    NUMBER( cloth, air_density, -1e-9f, 1.1e6f ),
    NUMBER( cloth, drag_coefficient, -1e-9f, 1.1e6f ),
    NUMBER( cloth, lift_coefficient, -1e-9f, 1.1e6f ),
    NUMBER( cloth, tether_slack, 0.999f, 1.1e6f ),
    WHOLE( balloon, solver, -1, WISP_SOLVER_COUNT ),
    WHOLE( balloon, volume, -1, WISP_SOLVER_COUNT ),
    NUMBER( balloon, edge_stiffness, 0.0f, 2e12f ),
    NUMBER( balloon, bend_link_stiffness, 0.0f, 2e12f ),
    NUMBER( balloon, stretch_stiffness, -0.1f, 1.1f ),
    NUMBER( balloon, bend_stiffness, -0.1f, 1.1f ),
    NUMBER( balloon, volume_stiffness, 0.0f, 1.5f ),
    NUMBER( balloon, gas_ratio, 0.99f, NAN ),
    NUMBER( balloon, inflation_rate, NAN, NAN ),
    NUMBER( balloon, min_gas_ratio, 0.0f, NAN ),
    NUMBER( balloon, atmospheric_pressure, 0.0f, NAN ),
    NUMBER( balloon, temperature, -1.0f, NAN ),
    NUMBER( balloon, gas_molar_mass, 0.0f, NAN ),
    NUMBER( balloon, air_molar_mass, NAN, 11.0f ),
    NUMBER( balloon, drag_coefficient, -0.5f, NAN ),
    NUMBER( balloon, outlet_area, 0.0f, NAN ),
    WHOLE( balloon, outlet_count, -1, WISP_BALLOON_MAX_OUTLET + 1 ),
    NUMBER( implicit_cloth, stretch_stiffness, -1e-9f, 1.1e9f ),
    NUMBER( implicit_cloth, bend_stiffness, -1e-9f, 1.1e9f ),
    NUMBER( implicit_cloth, bend_rigidity, -1e-9f, 1.1e9f ),
    NUMBER( implicit_cloth, compression_stiffness, -1e-9f, 1.1e9f ),
    NUMBER( implicit_cloth, link_damping, -1e-9f, 1.1e9f ),
    NUMBER( implicit_cloth, tolerance, 0.99e-7f, 0.101f ),
    WHOLE( implicit_cloth, newton_iterations, 0, 65 ),
    WHOLE( implicit_cloth, max_newton_iterations, 0, 65 ),
    WHOLE( implicit_cloth, max_iterations, -1, 1000001 ),
    WHOLE( implicit_cloth, stiffness_model, -1, WISP_IMPLICIT_STIFFNESS_COUNT ),
    WHOLE( implicit_cloth, weights, -1, WISP_IMPLICIT_WEIGHTS_COUNT ),
    WHOLE( implicit_cloth, integrator, -1, WISP_INTEGRATOR_COUNT ),
    NUMBER( frozen_hair, stretch_stiffness, 0.0f, 2e12f ),
    NUMBER( frozen_hair, bend_stiffness, 9e-4f, NAN ),
    NUMBER( frozen_hair, max_bend_angle, -0.1f, 3.15f ),
    NUMBER( frozen_hair, intensity, -0.01f, 1.01f ),
    NUMBER( frozen_hair, cursor.x, -1.1e6f, 1.1e6f ),
    NUMBER( frozen_hair, cursor.y, -1.1e6f, 1.1e6f ),
    NUMBER( frozen_hair, cursor.z, -1.1e6f, 1.1e6f ),
    NUMBER( frozen_hair, reach, -1.0f, NAN ),
    NUMBER( frozen_hair, clump_radius, 0.0f, NAN ),
    WHOLE( frozen_hair, clump_iterations, -1, 1001 ),
    NUMBER( frozen_hair, clump_step_length, -0.5f, NAN ),
    NUMBER( frozen_hair, min_distance, -2.0f, NAN ),
    NUMBER( frozen_hair, min_lambda, NAN, 1.5f ),
    WHOLE( frozen_hair, max_neighbours, 0, 4097 ),
    NUMBER( frozen_hair, max_depth_change, -0.5f, 2e6f ),
    WHOLE( frozen_hair, gap, -1, WISP_GAP_COUNT ),
    WHOLE( frozen_hair, base, -1, WISP_FROZEN_BASE_COUNT ),
    WHOLE( frozen_hair, update_on, -1, WISP_FROZEN_UPDATE_COUNT ),
    WHOLE( ghosts, target_count, 0, 5 ),
    NUMBER( ghosts, tip_gain, -0.1f, NAN ),
    NUMBER( ghosts, centre_gain, NAN, 1e4f ),
    NUMBER( ghosts, time, -1.0f, NAN ),
    NUMBER( ghosts, spread, 0.0f, NAN ),
    WHOLE( ghosts, elastic, -1, WISP_GHOST_ELASTIC_COUNT ),
    NUMBER( environment, temperature_celsius, -300.0f, NAN ),
    NUMBER( environment, freezing_celsius, NAN, NAN ),
    NUMBER( environment, wetness, -0.1f, 1.1f ),
    NUMBER( environment, span, 0.0f, NAN ),
    NUMBER( boundary, spacing, -1.0f, NAN ),
    WHOLE( boundary, policy, -1, WISP_SPACING_COUNT ),
    WHOLE( boundary, rounding, -1, WISP_ROUND_COUNT ),
    NUMBER( boundary, hysteresis, -0.1f, 0.6f ),
    WHOLE( boundary, max_points, -5, 0 ),
    NUMBER( boundary, min_spacing, -1.0f, NAN ),
    NUMBER( boundary, max_spacing, -1.0f, NAN ),
    NUMBER( boundary, curvature_gain, -1.0f, NAN ),
    NUMBER( boundary, strain_gain, NAN, NAN ),
    NUMBER( boundary, eye_angle, -1.0f, NAN ),
    NUMBER( boundary, eye.y, NAN, NAN ),
    NUMBER( tearing, strength, 0.0f, INFINITY ),
    WHOLE( tearing, max_splits, -1, 0 ),
    NUMBER( membrane, thickness, 0.0f, NAN ),
    NUMBER( membrane, shear_modulus, NAN, NAN ),
    NUMBER( motion_constraints, distance_stiffness, NAN, 1.5f ),
    NUMBER( motion_constraints, max_distance, -1.0f, INFINITY ),
    NUMBER( seam, within, -1.0f, NAN ),
    NUMBER( seam, distance, -1.0f, NAN ),
    NUMBER( seam, closing_speed, 0.0f, INFINITY ),
    NUMBER( seam, compliance, NAN, NAN ),
    NUMBER( seam, strength, 0.0f, INFINITY ),
    WHOLE( detail, level, -1, 4 ),
    WHOLE( detail, substep_divisor, -1, 0 ),
    WHOLE( detail, blend_steps, -2, -1 ),
    NUMBER( sleep, max_speed, -1.0f, NAN ),
    NUMBER( sleep, seconds, -1.0f, NAN ),
    NUMBER( moving_frame, linear_inertia, -0.5f, NAN ),
    NUMBER( moving_frame, angular_inertia, NAN, NAN ),
};

static void check_value( stage* s, int call, const field* f, double value )
{
    const int passes = wisp_world_plan_passes( s->world ); // which attaches columns
    const uint64_t hash = wisp_world_hash( s->world );
    spoilt = f, spoilt_value = value;
    const wisp_status status = CALLS[call].call( s );
    spoilt = NULL;
    const char* message = wisp_world_message( s->world );
    char named[60];
    snprintf( named, sizeof named, "%s: got ", f->name );
    if ( status != WISP_BAD_INPUT || strstr( message, named ) == NULL )
    {
        fail_msg( "%s.%s: got %g: %s, '%s'", f->call, f->name, value, wisp_status_name( status ), message );
    }
    assert_true( wisp_world_hash( s->world ) == hash );
    assert_int_equal( wisp_world_plan_passes( s->world ), passes );
}

// For an entity that has not been given anything yet, and for one that has.
TEST( a_value_out_of_its_range_is_named_and_changes_nothing )
{
    for ( int i = 0; i < WISP_COUNT( FIELDS ); ++i )
    {
        const field* f = FIELDS + i;
        int call = 0;
        while ( strcmp( CALLS[call].name, f->call ) != 0 )
        {
            call += 1;
        }
        const double bad[] = { f->lower, f->upper < INFINITY ? f->upper : NAN, -INFINITY, NAN, INFINITY };
        const int count = f->is_whole ? 2 : f->upper < INFINITY || isnan( f->upper ) ? 5 : 4;
        for ( int again = 0; again < 2; ++again )
        {
            stage* s = open_stage( call );
            assert_status( s->world, again == 1 ? CALLS[call].call( s ) : WISP_OK, WISP_OK );
            for ( int k = 0; k < count; ++k )
            {
                check_value( s, call, f, bad[k] );
            }
            close_stage( s );
        }
    }
}

TEST( what_an_entity_has_not_been_given_is_a_conflict )
{
    stage* s = open_stage( 0 );
    const uint64_t hash = wisp_world_hash( s->world );
    const wisp_vec3 cursor = { 0 };
    const wisp_status got[] = {
        wisp_set_balloon_gas_ratio( s->world, s->ball, 1.2f ),
        wisp_set_balloon_inflation( s->world, s->ball, 1.0f ),
        wisp_open_balloon( s->world, s->ball, true ),
        wisp_read_balloon_stats( s->world, s->ball, &( wisp_balloon_stats ){ 0 } ),
        wisp_read_boundary( s->world, s->ball, &( wisp_boundary_view ){ 0 } ),
        wisp_read_boundary_stats( s->world, s->ball, &( wisp_boundary_stats ){ 0 } ),
        wisp_request_implicit_cloth_stats( s->world, s->sheet, true ),
        wisp_read_implicit_cloth_stats( s->world, s->sheet, &( wisp_implicit_cloth_stats ){ 0 } ),
        wisp_set_cloth_wind( s->world, s->hair, cursor ),
        wisp_command_frozen_hair( s->world, s->hair, cursor ),
        wisp_replay_frozen_hair( s->world, s->hair, cursor, 0 ),
        wisp_read_frozen_hair_stats( s->world, s->hair, &( wisp_frozen_hair_stats ){ 0 } ),
        wisp_read_tearing_stats( s->world, s->sheet, &( wisp_tearing_stats ){ 0 } ),
    };
    for ( int i = 0; i < WISP_COUNT( got ); ++i )
    {
        assert_int_equal( got[i], WISP_CONFLICT );
    }
    assert_true( wisp_world_hash( s->world ) == hash );
    close_stage( s );
}

// @param before it was made before: 1 as it is, 2 with the default definition. @param rest refuse the n-th request and all later ones. @return false if it makes fewer requests
static bool call_with_a_refusal( int number, int n, int before, bool rest )
{
    stage* s = open_stage( number );
    s->is_plain = before == 2;
    assert_status( s->world, before > 0 ? CALLS[number].call( s ) : WISP_OK, WISP_OK );
    s->is_plain = false;
    const int passes = wisp_world_plan_passes( s->world ); // which attaches columns
    const uint64_t hash = wisp_world_hash( s->world );
    const size_t memory = wisp_world_memory( s->world );
    test_host_refuse( &s->h.host, n, rest );
    const wisp_status status = CALLS[number].call( s );
    const bool refused = test_host_has_refused( &s->h.host );
    test_host_refuse( &s->h.host, 0, false );
    if ( status != ( refused ? WISP_NO_MEMORY : WISP_OK ) )
    {
        fail_msg( "%s, request %d: %s, '%s'", CALLS[number].name, n, wisp_status_name( status ),
                  wisp_world_message( s->world ) );
    }
    if ( refused )
    {
        assert_one_message( wisp_world_message( s->world ) );
        if ( before == 2 && wisp_world_memory( s->world ) > memory + 128 ) // room in a list
        {
            fail_msg( "%s, request %d: memory stays", CALLS[number].name, n );
        }
        assert_true( wisp_world_hash( s->world ) == hash );
        assert_int_equal( wisp_world_plan_passes( s->world ), passes );
        assert_status( s->world, CALLS[number].call( s ), WISP_OK );
    }
    step( s->world );
    close_stage( s );
    return refused;
}

TEST( a_call_without_memory_changes_nothing_and_can_be_made_again )
{
    for ( int number = 0; number < WISP_COUNT( CALLS ); ++number )
    {
        for ( int before = 0; before < ( CALLS[number].is & OTHER_FIRST ? 3 : 2 ); ++before )
        {
            int n = 1;
            while ( call_with_a_refusal( number, n, before, n % 2 == 0 ) )
            {
                n += 1;
            }
            assert_true( n > 1 || before == 1 || ( CALLS[number].is & OF_ENGINE ) != 0 );
        }
    }
}

// @param n 0: nothing is refused. @return whether the first step made n requests
static bool step_with_a_refusal( int number, int n, uint64_t* hash )
{
    stage* s = open_stage( number );
    assert_status( s->world, CALLS[number].call( s ), WISP_OK );
    test_host_refuse( &s->h.host, n, false );
    const wisp_status status = wisp_world_step( s->world, 0.01f );
    const bool refused = test_host_has_refused( &s->h.host );
    test_host_refuse( &s->h.host, 0, false );
    if ( status != WISP_OK )
    {
        assert_true( refused );
        expect_refusal( s->world, status, WISP_NO_MEMORY, "memory" );
    }
    run_steps( s->world, status == WISP_OK ? 2 : 3, 0.01f );
    *hash = n == 0 ? wisp_world_hash( s->world ) : *hash;
    assert_true( ( CALLS[number].is & AS_EVER ) == 0 || wisp_world_hash( s->world ) == *hash );
    assert_int_equal( wisp_world_counter( s->world, WISP_COUNT_HALTED ), 0 );
    close_stage( s );
    return refused;
}

TEST( a_step_without_memory_is_refused_and_the_next_ones_are_made )
{
    for ( int number = 0; number < WISP_COUNT( CALLS ); ++number )
    {
        uint64_t hash;
        step_with_a_refusal( number, 0, &hash );
        int n = 1;
        while ( step_with_a_refusal( number, n, &hash ) )
        {
            n += 1;
        }
        assert_true( n > 5 ); // the plan at least
    }
}
