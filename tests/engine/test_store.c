// Entities, rows and columns.
#include "store_fixture.h"

// ---- handles ----

STORE_TEST( a_null_handle_finds_nothing )
{
    fixture* f = *state;
    assert_null( store_find( &f->s, ( wisp_entity ){ 0, 0 } ) );
    add( &f->s, 1 );
    assert_null( store_find( &f->s, ( wisp_entity ){ 0, 0 } ) );
    assert_null( store_find( &f->s, ( wisp_entity ){ 0, 1 } ) );
}

STORE_TEST( a_handle_beyond_the_slots_finds_nothing )
{
    fixture* f = *state;
    wisp_entity e = add( &f->s, 1 );
    assert_null( store_find( &f->s, ( wisp_entity ){ e.index + 1, e.generation } ) );
    assert_null( store_find( &f->s, ( wisp_entity ){ UINT32_MAX, e.generation } ) );
    assert_null( store_find( &f->s, ( wisp_entity ){ e.index, e.generation + 1 } ) );
}

STORE_TEST( a_removed_entity_is_stale_and_its_slot_returns_under_a_new_generation )
{
    fixture* f = *state;
    wisp_entity first = add( &f->s, 1 );
    wisp_entity second = add( &f->s, 1 );
    store_remove( &f->s, first );
    assert_null( store_find( &f->s, first ) );
    assert_non_null( store_find( &f->s, second ) );

    wisp_entity third = add( &f->s, 1 );
    assert_int_equal( third.index, first.index );
    assert_int_not_equal( third.generation, first.generation );
    assert_null( store_find( &f->s, first ) );
    assert_non_null( store_find( &f->s, third ) );
}

STORE_TEST( handles_outlive_the_growth_of_the_slots )
{
    fixture* f = *state;
    wisp_entity entities[100];
    for ( int i = 0; i < WISP_COUNT( entities ); ++i )
    {
        entities[i] = add( &f->s, i % 3 );
        write_all( &f->s, entities[i] );
    }
    for ( int i = 0; i < WISP_COUNT( entities ); ++i )
    {
        assert_non_null( store_find( &f->s, entities[i] ) );
        assert_int_equal( wrong_bytes( &f->s, entities[i] ), 0 );
    }
}

// ---- declarations ----

STORE_TEST( a_component_declared_again_is_the_same_one )
{
    fixture* f = *state;
    const wisp_column_def columns[] = { SHAPE_COLUMNS( WISP_COLUMN_DEF ) };
    wisp_component_def again = { "test.shape", WISP_TABLE_STRAND_ROW, columns, WISP_COUNT( columns ) };
    assert_int_equal( store_declare( &f->s, &again ), SHAPE );
}

STORE_TEST( a_component_declared_with_another_shape_is_refused )
{
    fixture* f = *state;
    const wisp_column_def wider[] = { { "mass", 8 } }, renamed[] = { { "weight", 4 } };
    const wisp_column_def more[] = { { "mass", 4 }, { "extra", 4 } };
    const wisp_component_def others[] = {
        { "test.mass", WISP_TABLE_POINT, mass_columns, 1 }, { "test.mass", WISP_TABLE_ENTITY, wider, 1 },
        { "test.mass", WISP_TABLE_ENTITY, renamed, 1 },     { "test.mass", WISP_TABLE_ENTITY, more, 2 },
        { "test.mass", WISP_TABLE_ENTITY, NULL, 0 },
    };
    for ( int i = 0; i < WISP_COUNT( others ); ++i )
    {
        assert_int_equal( store_declare( &f->s, others + i ), 0 );
    }
    assert_int_equal( f->s.component_count, COMPONENT_END );
}

STORE_TEST( a_component_of_too_many_columns_is_refused )
{
    fixture* f = *state;
    // static: the store keeps the descriptors until it is torn down
    static wisp_column_def columns[STORE_MAX_COLUMNS + 1];
    static char names[STORE_MAX_COLUMNS + 1][16];
    for ( int i = 0; i < WISP_COUNT( columns ); ++i )
    {
        snprintf( names[i], sizeof( names[i] ), "c%d", i );
        columns[i] = ( wisp_column_def ){ names[i], 4 };
    }
    assert_int_equal( store_declare( &f->s, &( wisp_component_def ){ "test.wide", WISP_TABLE_POINT, columns,
                                                                     WISP_COUNT( columns ) } ),
                      0 );
    assert_int_not_equal(
        store_declare( &f->s, &( wisp_component_def ){ "test.full", WISP_TABLE_POINT, columns, STORE_MAX_COLUMNS } ),
        0 );
}

STORE_TEST( one_component_too_many_is_refused )
{
    fixture* f = *state;
    static char names[STORE_MAX_COMPONENTS][24]; // the store keeps them until it is torn down
    for ( int i = COMPONENT_END; i <= STORE_MAX_COMPONENTS; ++i )
    {
        snprintf( names[i - 1], sizeof( names[0] ), "test.%d", i );
        wisp_component_def def = { names[i - 1], WISP_TABLE_ENTITY, mass_columns, 1 };
        assert_int_equal( store_declare( &f->s, &def ), i < STORE_MAX_COMPONENTS ? i : 0 );
    }
}

// ---- rows ----

STORE_TEST( ranges_are_contiguous_in_the_order_of_arrival )
{
    fixture* f = *state;
    const int rows[] = { 3, 0, 5, 1 };
    int begin = 0;
    for ( int i = 0; i < WISP_COUNT( rows ); ++i )
    {
        store_rows range = store_find( &f->s, add( &f->s, rows[i] ) )->rows[WISP_TABLE_STRAND_ROW];
        assert_int_equal( range.begin, begin );
        assert_int_equal( range.count, rows[i] );
        begin += rows[i];
    }
    assert_int_equal( f->s.row_count[WISP_TABLE_STRAND_ROW], begin );
}

STORE_TEST( ranges_close_up_behind_a_removed_entity_and_keep_their_contents )
{
    fixture* f = *state;
    const int rows[] = { 4, 0, 7, 2, 0, 9, 1 };
    for ( int removed = 0; removed < WISP_COUNT( rows ); ++removed )
    {
        wisp_entity entities[WISP_COUNT( rows )];
        for ( int i = 0; i < WISP_COUNT( rows ); ++i )
        {
            entities[i] = add( &f->s, rows[i] );
            write_all( &f->s, entities[i] );
        }
        store_remove( &f->s, entities[removed] );
        int begin = 0;
        for ( int i = 0; i < WISP_COUNT( rows ); ++i )
        {
            if ( i != removed )
            {
                assert_int_equal( store_find( &f->s, entities[i] )->rows[WISP_TABLE_STRAND_ROW].begin, begin );
                assert_int_equal( wrong_bytes( &f->s, entities[i] ), 0 );
                begin += rows[i];
                store_remove( &f->s, entities[i] );
                begin -= rows[i];
            }
        }
        assert_int_equal( f->s.row_count[WISP_TABLE_POINT], 0 );
    }
}

// Random addition, change and removal of entities; the remaining ones always keep their own bytes.
STORE_TEST( contents_survive_any_order_of_coming_and_going )
{
    fixture* f = *state;
    wisp_entity entities[40];
    bool present[40] = { false };
    for ( int turn = 0; turn < 400; ++turn )
    {
        int i = test_random( turn, 0, WISP_COUNT( entities ) );
        if ( present[i] )
        {
            store_remove( &f->s, entities[i] );
        }
        else
        {
            entities[i] = add( &f->s, test_random( turn, 1, 30 ) );
            write_all( &f->s, entities[i] );
        }
        present[i] = !present[i];
        int wrong = 0;
        for ( int k = 0; k < WISP_COUNT( entities ); ++k )
        {
            wrong += present[k] ? wrong_bytes( &f->s, entities[k] ) : 0;
        }
        assert_int_equal( wrong, 0 );
    }
}

STORE_TEST( rows_start_at_zero_in_memory_that_held_others )
{
    fixture* f = *state;
    wisp_entity stays = add( &f->s, 3 );
    write_all( &f->s, stays );
    for ( int turn = 0; turn < 6; ++turn )
    {
        wisp_entity e = add( &f->s, 1 << turn );
        for ( wisp_component c = 1; c < COMPONENT_END; ++c )
        {
            assert_true( store_attach( &f->s, e, c ) );
            for ( int k = 0; k < f->s.components[c].def.column_count; ++k )
            {
                assert_true( all_zero( bytes_of( &f->s, e, c, k ), column_size( &f->s, e, c, k ) ) );
            }
        }
        write_all( &f->s, e );
        store_remove( &f->s, e );
    }
}

STORE_TEST( rows_of_a_component_taken_and_given_again_start_at_zero )
{
    fixture* f = *state;
    wisp_entity other = add( &f->s, 2 ), e = add( &f->s, 5 );
    write_all( &f->s, other );
    write_all( &f->s, e );
    store_detach( &f->s, e, SHAPE );
    assert_true( store_attach( &f->s, e, SHAPE ) );
    for ( int k = 0; k < f->s.components[SHAPE].def.column_count; ++k )
    {
        assert_true( all_zero( bytes_of( &f->s, e, SHAPE, k ), column_size( &f->s, e, SHAPE, k ) ) );
    }
    assert_int_equal( wrong_bytes( &f->s, other ), 0 );
}

// ---- columns ----

STORE_TEST( columns_exist_from_the_first_user_to_the_last )
{
    fixture* f = *state;
    wisp_entity a = add( &f->s, 2 ), b = add( &f->s, 2 );
    void* const* columns = f->s.components[SHAPE].columns;
    assert_null( columns[0] );
    assert_null( store_column( &f->s, store_find( &f->s, a ), SHAPE, 0 ) );

    assert_true( store_attach( &f->s, a, SHAPE ) );
    assert_non_null( columns[0] );
    assert_non_null( columns[2] );
    assert_null( store_column( &f->s, store_find( &f->s, b ), SHAPE, 0 ) );

    assert_true( store_attach( &f->s, b, SHAPE ) );
    store_detach( &f->s, a, SHAPE );
    assert_non_null( columns[0] );
    store_remove( &f->s, b );
    assert_null( columns[0] );
    assert_null( columns[2] );
}

STORE_TEST( a_column_takes_and_gives_back_its_memory )
{
    fixture* f = *state;
    wisp_entity e = add( &f->s, 1000 );
    int64_t before = atomic_load( &f->host.bytes );
    assert_true( store_attach( &f->s, e, POINT ) );
    assert_true( atomic_load( &f->host.bytes ) >= before + 2000 * (int64_t)sizeof( wisp_vec3 ) );
    store_detach( &f->s, e, POINT );
    assert_int_equal( atomic_load( &f->host.bytes ), before );
}

STORE_TEST( attaching_or_detaching_twice_is_attaching_or_detaching_once )
{
    fixture* f = *state;
    wisp_entity e = add( &f->s, 2 );
    assert_true( store_attach( &f->s, e, MASS ) );
    uint32_t structure = f->s.structure;
    assert_true( store_attach( &f->s, e, MASS ) );
    assert_int_equal( f->s.components[MASS].entity_count, 1 );
    assert_int_equal( f->s.structure, structure );

    store_detach( &f->s, e, MASS );
    structure = f->s.structure;
    store_detach( &f->s, e, MASS );
    assert_int_equal( f->s.components[MASS].entity_count, 0 );
    assert_int_equal( f->s.structure, structure );
}

STORE_TEST( every_column_starts_on_a_cache_line )
{
    fixture* f = *state;
    for ( int turn = 0; turn < 5; ++turn )
    {
        write_all( &f->s, add( &f->s, 1 + 10 * turn ) );
        for ( int c = 1; c < COMPONENT_END; ++c )
        {
            for ( int k = 0; k < f->s.components[c].def.column_count; ++k )
            {
                assert_int_equal( (uintptr_t)f->s.components[c].columns[k] % 64, 0 );
            }
        }
    }
}

STORE_TEST( an_entity_without_rows_still_has_a_column )
{
    fixture* f = *state;
    wisp_entity e = add( &f->s, 0 );
    assert_true( store_attach( &f->s, e, POINT ) );
    assert_non_null( store_column( &f->s, store_find( &f->s, e ), POINT, 0 ) );
    wisp_entity more = add( &f->s, 3 );
    write_all( &f->s, more );
    assert_int_equal( wrong_bytes( &f->s, more ), 0 );
}

STORE_TEST( more_rows_than_a_number_holds_are_refused )
{
    fixture* f = *state;
    wisp_entity e = add( &f->s, 1 ), out = { 0, 0 };
    const int counts[WISP_TABLE_COUNT] = { [WISP_TABLE_ENTITY] = 1, [WISP_TABLE_POINT] = INT32_MAX };
    assert_false( store_add( &f->s, counts, &out ) );
    assert_int_equal( f->s.row_count[WISP_TABLE_ENTITY], 1 );
    assert_int_equal( f->s.row_count[WISP_TABLE_POINT], 2 );
    assert_non_null( store_find( &f->s, e ) );
}

// ---- no memory ----

enum
{
    FIRST_SLOTS = 8, // entities that fill the first block of slots, so that one more needs another
};

typedef bool change_fn( store* s, wisp_entity entity );

static bool add_many_rows( store* s, wisp_entity entity )
{
    (void)entity;
    const int counts[WISP_TABLE_COUNT] = { 1, 50, 500, 5000 };
    wisp_entity out;
    return store_add( s, counts, &out );
}

static bool attach_shape( store* s, wisp_entity entity )
{
    return store_attach( s, entity, SHAPE );
}

// Refuse the n-th request of a change for every n: it fails and changes nothing until n is beyond its last request,
// and succeeds at once when memory is available again. @return how many requests could be refused
static int refuse_every_request( fixture* f, bool shaped, change_fn* change, bool rest )
{
    int failures = 0;
    for ( int n = 1; n < 1000; ++n )
    {
        store s;
        store_init( &s, &f->allocator );
        for ( int i = 0; i < WISP_COUNT( COMPONENTS ); ++i )
        {
            store_declare( &s, COMPONENTS + i );
        }
        wisp_entity last = { 0, 0 };
        for ( int i = 0; i < FIRST_SLOTS; ++i )
        {
            last = add( &s, 2 );
            write_all( &s, last );
            if ( shaped == false )
            {
                store_detach( &s, last, SHAPE );
            }
        }
        wisp_entity first = { 1, 1 };
        visible before = look_at( &s );
        test_host_refuse( &f->host, n, rest );
        bool done = change( &s, last );
        test_host_refuse( &f->host, 0, false );
        if ( done == false )
        {
            failures += 1;
            assert_same_visible( look_at( &s ), before );
            assert_non_null( store_find( &s, first ) );
            assert_true( change( &s, last ) );
        }
        store_release( &s );
        assert_host_memory_is_released( &f->host );
        if ( done )
        {
            return failures;
        }
    }
    fail_msg( "the change asks for memory without end" );
    return failures;
}

STORE_TEST( adding_without_memory_changes_nothing )
{
    // three columns of shape and one of points must grow, and the slots
    assert_int_equal( refuse_every_request( *state, true, add_many_rows, false ), 5 );
    assert_int_equal( refuse_every_request( *state, true, add_many_rows, true ), 5 );
}

STORE_TEST( attaching_without_memory_changes_nothing )
{
    assert_int_equal( refuse_every_request( *state, false, attach_shape, false ), WISP_COUNT( shape_columns ) );
    assert_int_equal( refuse_every_request( *state, false, attach_shape, true ), WISP_COUNT( shape_columns ) );
}
