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
#include "wisp/fabric.h"
#include "wisp/moving_frame.h"
#include "wisp/skin.h"
#include "wisp/sleep.h"

typedef struct stage
{
    hosted h;
    wisp_world* world;
    wisp_entity sheet, other, ball, hair, more;
    bool is_plain; // definitions are the defaults
} stage;

static const int32_t PAIRS[] = { 0, 0, 1, 1, 2, 2 };

// A value that the next call of its definition has in place of its own.
typedef struct bad_value
{
    const wisp_field* field;
    size_t at; // in the definition
    double value;
} bad_value;

static const bad_value* spoilt;

static void spoil( const wisp_fields* fields, void* def )
{
    const wisp_field* f = spoilt != NULL ? spoilt->field : NULL;
    if ( f >= fields->rows && f < fields->rows + fields->count )
    {
        const float number = (float)spoilt->value;
        const bool is_whole = f->type == WISP_FIELD_WHOLE || f->type == WISP_FIELD_CHOICE;
        const int whole = is_whole ? (int)spoilt->value : 0;
        if ( f->type == WISP_FIELD_SWITCH )
        {
            *( (unsigned char*)def + spoilt->at ) = 2;
            return;
        }
        memcpy( (char*)def + spoilt->at, is_whole ? (const void*)&whole : &number, sizeof( float ) );
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
        spoil( &wisp_##name##_def_fields, &d );                                                                      \
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
CALL( strand_grid, wisp_set_strand_grid( s->world, s->hair, &d ), )
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

#define ROW( name, is )                                                                                              \
    {                                                                                                                \
#name, give_##name, &wisp_##name##_def_fields, is                                                            \
    }

static const struct
{
    const char* name;
    wisp_status ( *call )( stage* s );
    const wisp_fields* fields;
    unsigned is;
} CALLS[] = {
    ROW( cloth, OTHER_FIRST ),
    ROW( balloon, OTHER_FIRST ),
    ROW( boundary, AS_EVER ),
    ROW( collider, NO_ENTITY | AS_EVER ),
    ROW( collision, OTHER_FIRST | ON_CLOTH | ANY_ENTITY ),
    ROW( contact, ON_CLOTH ),
    ROW( implicit_cloth, OTHER_FIRST | AS_EVER ),
    ROW( environment, AS_EVER ),
    ROW( frozen_hair, 0 ),
    ROW( ghosts, ON_STRANDS ),
    ROW( curves, AS_EVER ),
    ROW( strand_appearance, AS_EVER ),
    ROW( strand_dynamics, 0 ),
    ROW( strand_grid, ON_STRANDS ),
    ROW( membrane, AS_EVER ),
    ROW( tearing, ON_CLOTH ),
    ROW( motion_constraints, ON_CLOTH ),
    ROW( seam, ON_CLOTH ),
    ROW( detail, OF_ENGINE | ON_GHOSTS ),
    ROW( sleep, OF_ENGINE | ON_CLOTH | ANY_ENTITY ),
    ROW( moving_frame, OF_ENGINE | ON_CLOTH | ANY_ENTITY ),
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

static void check_value( stage* s, int call, bad_value bad )
{
    const int passes = wisp_world_plan_passes( s->world ); // which attaches columns
    const uint64_t hash = wisp_world_hash( s->world );
    spoilt = &bad;
    const wisp_status status = CALLS[call].call( s );
    spoilt = NULL;
    const char* message = wisp_world_message( s->world );
    char named[100];
    snprintf( named, sizeof named, "%s: %s", CALLS[call].fields->subject, bad.field->name );
    if ( status != WISP_BAD_INPUT || strncmp( message, named, strlen( named ) ) != 0 )
    {
        fail_msg( "%s.%s: got %g: %s, '%s'", CALLS[call].name, bad.field->name, bad.value, wisp_status_name( status ),
                  message );
    }
    assert_true( wisp_world_hash( s->world ) == hash );
    assert_int_equal( wisp_world_plan_passes( s->world ), passes );
}

// List values just out of the range of a field, and those that are no numbers. @return how many
static int list_bad( const wisp_field* f, double bad[5] )
{
    int count = 0;
    const float lower = (float)f->lower, upper = (float)f->upper;
    if ( f->type == WISP_FIELD_WHOLE || f->type == WISP_FIELD_CHOICE )
    {
        const double both[] = { f->lower - 1.0 - ( f->lower - 1.0 == f->other ), f->upper + 1.0 };
        memcpy( bad, both, sizeof both );
        return 2;
    }
    if ( f->type == WISP_FIELD_SWITCH )
    {
        bad[0] = 2.0;
        return 1;
    }
    if ( f->type != WISP_FIELD_VECTOR )
    {
        bad[count++] = (double)nextafterf( lower, -INFINITY );
    }
    if ( upper < INFINITY )
    {
        bad[count++] = f->type == WISP_FIELD_VECTOR ? 1.1 * f->upper : (double)nextafterf( upper, INFINITY );
        bad[count++] = INFINITY;
    }
    bad[count++] = -INFINITY;
    bad[count++] = NAN;
    return count;
}

static void check_field( stage* s, int call, const wisp_field* f )
{
    const bool is_pose = f->type == WISP_FIELD_POSE;
    const int parts = is_pose || f->type == WISP_FIELD_VECTOR || f->type == WISP_FIELD_POINT ? 3 : 1;
    const size_t at = f->offset + ( is_pose ? offsetof( wisp_transform, translation ) : 0 );
    double bad[5];
    const int count = f->type == WISP_FIELD_BITS || f->type == WISP_FIELD_SEED ? 0 : list_bad( f, bad );
    for ( int k = 0; k < count * parts; ++k )
    {
        check_value( s, call, ( bad_value ){ f, at + (size_t)( k / count ) * sizeof( float ), bad[k % count] } );
    }
}

// Of all rows of all tables: for an entity that has not been given anything yet, and for one that has.
TEST( a_value_out_of_its_range_is_named_and_changes_nothing )
{
    for ( int call = 0; call < WISP_COUNT( CALLS ); ++call )
    {
        for ( int again = 0; again < 2; ++again )
        {
            stage* s = open_stage( call );
            assert_status( s->world, again == 1 ? CALLS[call].call( s ) : WISP_OK, WISP_OK );
            for ( int i = 0; i < CALLS[call].fields->count; ++i )
            {
                check_field( s, call, CALLS[call].fields->rows + i );
            }
            close_stage( s );
        }
    }
}

// Of the definitions that no call above takes, too.
TEST( defaults_can_be_read_and_values_out_of_range_are_named )
{
    static const wisp_fields* const OTHERS[] = { &wisp_world_def_fields,        &wisp_surface_def_fields,
                                                 &wisp_strands_def_fields,      &wisp_fabric_def_fields,
                                                 &wisp_contact_settings_fields, &wisp_create_cloth_def_fields,
                                                 &wisp_create_hair_def_fields,  &wisp_skin_def_fields };
    for ( int n = 0; n < WISP_COUNT( OTHERS ); ++n )
    {
        const wisp_fields* fields = OTHERS[n];
        char* def = checked_calloc( 2, fields->size );
        for ( int i = 0; i < fields->count; ++i )
        {
            const wisp_field* f = fields->rows + i;
            double bad[5];
            const int count = f->type == WISP_FIELD_DOUBLE ? 0 : list_bad( f, bad );
            for ( int k = 0; k < count; ++k )
            {
                wisp_error error = { 0 };
                spoilt = &( bad_value ){ f, f->offset, bad[k] };
                wisp_def_init( fields, def, fields->size );
                spoil( fields, def );
                assert_int_equal( wisp_def_read( fields, def + fields->size, def, &error ), WISP_BAD_INPUT );
                assert_contains( error.message, f->name );
            }
        }
        spoilt = NULL;
        wisp_def_init( fields, def, fields->size );
        assert_true( fields == &wisp_skin_def_fields || // which needs a bone
                     wisp_def_read( fields, def + fields->size, def, NULL ) == WISP_OK );
        free( def );
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
