// Entities, rows and columns; walks over the columns: hash, snapshot, restore; and pending changes of an entity.
#include "support.h"

#include "store.h"

// ---- a store with components of every kind ----

#define MASS_COLUMNS( X ) X( float, mass, 1 )
#define SHAPE_COLUMNS( X )                                                                                           \
    X( float, position, 3 )                                                                                          \
    X( uint32_t, colour, 5 )                                                                                         \
    X( double, weight, 1 )
#define POINT_COLUMNS( X ) X( wisp_vec3, place, 1 )

static const wisp_column_def mass_columns[] = { MASS_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def shape_columns[] = { SHAPE_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def point_columns[] = { POINT_COLUMNS( WISP_COLUMN_DEF ) };

static const wisp_component_def COMPONENTS[] = {
    { "test.mass", WISP_TABLE_ENTITY, mass_columns, WISP_COUNT( mass_columns ) },
    { "test.shape", WISP_TABLE_STRAND_ROW, shape_columns, WISP_COUNT( shape_columns ) },
    { "test.point", WISP_TABLE_POINT, point_columns, WISP_COUNT( point_columns ) },
    { "test.flag", WISP_TABLE_ENTITY, NULL, 0 },
};

enum
{
    MASS = 1,
    SHAPE,
    POINT,
    FLAG,
    COMPONENT_END,
};

typedef struct fixture
{
    test_host host;
    wisp_allocator allocator;
    store s;
} fixture;

static int set_up( void** state )
{
    fixture* f = calloc( 1, sizeof( fixture ) );
    f->allocator = test_host_allocator( &f->host );
    store_init( &f->s, &f->allocator );
    for ( int i = 0; i < WISP_COUNT( COMPONENTS ); ++i )
    {
        assert_int_equal( store_declare( &f->s, COMPONENTS + i ), i + 1 );
    }
    *state = f;
    return 0;
}

static int tear_down( void** state )
{
    SCOPED( free_local ) fixture* f = *state;
    store_release( &f->s );
    assert_host_memory_is_released( &f->host );
    return 0;
}

// An entity with this number of strand rows and twice as many points; it must fit.
static wisp_entity add( store* s, int rows )
{
    const int counts[WISP_TABLE_COUNT] = {
        [WISP_TABLE_ENTITY] = 1,
        [WISP_TABLE_STRAND_GROUP] = rows > 0 ? 1 : 0,
        [WISP_TABLE_STRAND_ROW] = rows,
        [WISP_TABLE_POINT] = 2 * rows,
    };
    wisp_entity entity = { 0, 0 };
    assert_true( store_add( s, counts, &entity ) );
    return entity;
}

static size_t column_size( const store* s, wisp_entity entity, wisp_component c, int column )
{
    const store_component* component = s->components + c;
    return (size_t)store_find( s, entity )->rows[component->def.table].count *
           component->def.columns[column].row_size;
}

static unsigned char* bytes_of( const store* s, wisp_entity entity, wisp_component c, int column )
{
    return store_column( s, store_find( s, entity ), c, column );
}

// Every byte of every column of an entity identifies its owner.
static void write_all( store* s, wisp_entity entity )
{
    for ( wisp_component c = 1; c < COMPONENT_END; ++c )
    {
        assert_true( store_attach( s, entity, c ) );
        for ( int k = 0; k < s->components[c].def.column_count; ++k )
        {
            for ( size_t i = 0; i < column_size( s, entity, c, k ); ++i )
            {
                bytes_of( s, entity, c, k )[i] = (unsigned char)( entity.index * 89 + c * 31u + (size_t)k * 7 + i );
            }
        }
    }
}

static int wrong_bytes( const store* s, wisp_entity entity )
{
    int wrong = 0;
    for ( wisp_component c = 1; c < COMPONENT_END; ++c )
    {
        for ( int k = 0; k < s->components[c].def.column_count; ++k )
        {
            for ( size_t i = 0; i < column_size( s, entity, c, k ); ++i )
            {
                unsigned char expected = (unsigned char)( entity.index * 89 + c * 31u + (size_t)k * 7 + i );
                wrong += bytes_of( s, entity, c, k )[i] != expected ? 1 : 0;
            }
        }
    }
    return wrong;
}

static bool all_zero( const void* bytes, size_t size )
{
    const unsigned char* p = bytes;
    size_t i = 0;
    while ( i < size && p[i] == 0 )
    {
        ++i;
    }
    return i == size;
}

typedef struct visible
{
    uint64_t hash;
    uint32_t structure;
    int rows[WISP_TABLE_COUNT];
    int entities, users_of_shape;
    size_t snapshot;
} visible;

static visible look_at( const store* s )
{
    visible v = {
        .hash = store_hash( s ),
        .structure = s->structure,
        .entities = s->entity_count,
        .users_of_shape = s->components[SHAPE].entity_count,
        .snapshot = store_snapshot_size( s ),
    };
    memcpy( v.rows, s->row_count, sizeof( v.rows ) );
    return v;
}

static void assert_same_visible( visible a, visible b )
{
    assert_int_equal( a.hash, b.hash );
    assert_int_equal( a.structure, b.structure );
    assert_int_equal( a.entities, b.entities );
    assert_int_equal( a.users_of_shape, b.users_of_shape );
    assert_int_equal( a.snapshot, b.snapshot );
    assert_memory_equal( a.rows, b.rows, sizeof( a.rows ) );
}

#define STORE_TEST( test ) TEST_WITH( test, set_up, tear_down )

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
    // three columns of shape, one of points and one of entities must grow, and the slots
    assert_int_equal( refuse_every_request( *state, true, add_many_rows, false ), 6 );
    assert_int_equal( refuse_every_request( *state, true, add_many_rows, true ), 6 );
}

STORE_TEST( attaching_without_memory_changes_nothing )
{
    assert_int_equal( refuse_every_request( *state, false, attach_shape, false ), WISP_COUNT( shape_columns ) );
    assert_int_equal( refuse_every_request( *state, false, attach_shape, true ), WISP_COUNT( shape_columns ) );
}

// A table without columns asks for no memory.
STORE_TEST( a_table_grows_by_a_quarter_up_to_what_an_int_counts )
{
    fixture* f = *state;
    wisp_entity e;
    int rows[WISP_TABLE_COUNT] = { [WISP_TABLE_POINT] = INT32_MAX / 8 * 7 };
    assert_true( store_add( &f->s, rows, &e ) );
    rows[WISP_TABLE_POINT] = 1;
    assert_true( store_add( &f->s, rows, &e ) );
    assert_int_equal( f->s.row_capacity[WISP_TABLE_POINT], INT32_MAX );
    rows[WISP_TABLE_POINT] = INT32_MAX / 2;
    assert_false( store_add( &f->s, rows, &e ) );
}

// ---- hash ----

STORE_TEST( equal_stores_hash_equal )
{
    fixture* f = *state;
    store twin;
    store_init( &twin, &f->allocator );
    for ( int i = 0; i < WISP_COUNT( COMPONENTS ); ++i )
    {
        store_declare( &twin, COMPONENTS + i );
    }
    for ( int i = 0; i < 3; ++i )
    {
        write_all( &f->s, add( &f->s, 2 + i ) );
        write_all( &twin, add( &twin, 2 + i ) );
    }
    uint64_t a = store_hash( &f->s ), b = store_hash( &twin );
    store_release( &twin );
    assert_int_equal( a, b );
}

STORE_TEST( any_byte_of_any_column_changes_the_hash )
{
    fixture* f = *state;
    wisp_entity entities[3];
    for ( int i = 0; i < WISP_COUNT( entities ); ++i )
    {
        entities[i] = add( &f->s, 3 * i + 1 );
        write_all( &f->s, entities[i] );
    }
    uint64_t hash = store_hash( &f->s );
    int changed = 0, bytes = 0;
    for ( int i = 0; i < WISP_COUNT( entities ); ++i )
    {
        for ( wisp_component c = 1; c < COMPONENT_END; ++c )
        {
            for ( int k = 0; k < f->s.components[c].def.column_count; ++k )
            {
                for ( size_t at = 0; at < column_size( &f->s, entities[i], c, k ); ++at, ++bytes )
                {
                    unsigned char* byte = bytes_of( &f->s, entities[i], c, k ) + at;
                    *byte ^= (unsigned char)( 1u << bytes % 8 );
                    changed += store_hash( &f->s ) != hash ? 1 : 0;
                    *byte ^= (unsigned char)( 1u << bytes % 8 );
                }
            }
        }
    }
    // a row of shape has 40 bytes, of point 2 * 12; 12 rows in all, and a mass an entity
    assert_int_equal( bytes, 12 * ( 40 + 24 ) + 3 * 4 );
    assert_int_equal( changed, bytes );
    assert_int_equal( store_hash( &f->s ), hash );
}

STORE_TEST( a_tag_without_columns_changes_the_hash )
{
    fixture* f = *state;
    wisp_entity e = add( &f->s, 1 );
    uint64_t hash = store_hash( &f->s );
    assert_true( store_attach( &f->s, e, FLAG ) );
    assert_int_not_equal( store_hash( &f->s ), hash );
}

STORE_TEST( hashed_bytes_of_another_length_hash_differently )
{
    const unsigned char zeros[64] = { 0 };
    for ( size_t a = 0; a < sizeof( zeros ); ++a )
    {
        for ( size_t b = 0; b < a; ++b )
        {
            assert_int_not_equal( store_hash_bytes( 0, zeros, a ), store_hash_bytes( 0, zeros, b ) );
        }
    }
}

// ---- snapshots ----

typedef struct snapshot
{
    unsigned char* bytes;
    size_t size;
} snapshot;

// Three entities, and a snapshot whose block has no byte to spare.
static snapshot take_snapshot( store* s )
{
    snapshot shot = { .size = store_snapshot_size( s ) };
    shot.bytes = checked_malloc( shot.size );
    store_snapshot( s, shot.bytes );
    return shot;
}

static void fill_three( store* s )
{
    for ( int i = 0; i < 3; ++i )
    {
        write_all( s, add( s, 2 * i ) );
    }
}

static void spoil_all( store* s )
{
    for ( int c = 1; c < COMPONENT_END; ++c )
    {
        for ( int k = 0; k < s->components[c].def.column_count; ++k )
        {
            size_t size = (size_t)s->row_count[s->components[c].def.table] * s->components[c].def.columns[k].row_size;
            memset( s->components[c].columns[k], 0x3c, size );
        }
    }
}

STORE_TEST( a_restored_store_is_the_one_that_was_taken )
{
    fixture* f = *state;
    fill_three( &f->s );
    uint64_t hash = store_hash( &f->s );
    snapshot shot = take_snapshot( &f->s );
    spoil_all( &f->s );
    assert_int_not_equal( store_hash( &f->s ), hash );

    wisp_status status = store_restore( &f->s, shot.bytes, shot.size, NULL );
    free( shot.bytes );
    assert_int_equal( status, WISP_OK );
    assert_int_equal( store_hash( &f->s ), hash );
    assert_int_equal( wrong_bytes( &f->s, store_handle( &f->s, 2 ) ), 0 );
}

STORE_TEST( what_means_nothing_between_steps_is_in_no_hash_and_no_snapshot )
{
    fixture* f = *state;
    fill_three( &f->s );
    const wisp_component c = MASS;
    const wisp_entity e = store_handle( &f->s, 2 );
    const size_t whole = store_snapshot_size( &f->s ), column = column_size( &f->s, e, c, 0 );
    f->s.transient = store_bit( c );
    assert_true( store_snapshot_size( &f->s ) < whole );

    snapshot shot = take_snapshot( &f->s );
    const uint64_t hash = store_hash( &f->s );
    memset( bytes_of( &f->s, e, c, 0 ), 0x3c, column );
    assert_int_equal( store_hash( &f->s ), hash );
    assert_int_equal( store_restore( &f->s, shot.bytes, shot.size, NULL ), WISP_OK );
    free( shot.bytes );
    for ( size_t i = 0; i < column; ++i )
    {
        assert_int_equal( bytes_of( &f->s, e, c, 0 )[i], 0x3c );
    }
}

// The bytes are rejected with a message, and nothing has changed.
static void assert_refused( store* s, const void* bytes, size_t size )
{
    visible before = look_at( s );
    wisp_error error = { WISP_OK, "" };
    assert_int_equal( store_restore( s, bytes, size, &error ), WISP_BAD_INPUT );
    assert_int_equal( error.status, WISP_BAD_INPUT );
    assert_one_message( error.message );
    assert_same_visible( look_at( s ), before );
}

STORE_TEST( a_snapshot_cut_anywhere_is_refused )
{
    fixture* f = *state;
    fill_three( &f->s );
    snapshot shot = take_snapshot( &f->s );
    spoil_all( &f->s );
    for ( size_t size = 0; size < shot.size; ++size )
    {
        // a block of exactly this size, so that a sanitizer detects a byte read beyond the end
        unsigned char* cut = checked_malloc( size > 0 ? size : 1 );
        memcpy( cut, shot.bytes, size );
        assert_refused( &f->s, cut, size );
        free( cut );
    }
    free( shot.bytes );
}

STORE_TEST( a_snapshot_with_bytes_behind_it_is_refused )
{
    fixture* f = *state;
    fill_three( &f->s );
    snapshot shot = take_snapshot( &f->s );
    unsigned char* longer = checked_calloc( 1, shot.size + 8 );
    memcpy( longer, shot.bytes, shot.size );
    assert_refused( &f->s, longer, shot.size + 1 );
    assert_refused( &f->s, longer, shot.size + 8 );
    free( longer );
    free( shot.bytes );
}

STORE_TEST( a_snapshot_with_any_bit_flipped_is_refused )
{
    fixture* f = *state;
    fill_three( &f->s );
    snapshot shot = take_snapshot( &f->s );
    spoil_all( &f->s );
    for ( size_t bit = 0; bit < shot.size * 8; ++bit )
    {
        shot.bytes[bit / 8] ^= (unsigned char)( 1u << bit % 8 );
        assert_refused( &f->s, shot.bytes, shot.size );
        shot.bytes[bit / 8] ^= (unsigned char)( 1u << bit % 8 );
    }
    free( shot.bytes );
}

STORE_TEST( a_snapshot_of_another_structure_is_refused )
{
    fixture* f = *state;
    wisp_entity a = add( &f->s, 3 ), b = add( &f->s, 1 );
    write_all( &f->s, a );
    write_all( &f->s, b );
    snapshot shot = take_snapshot( &f->s );

    // one component fewer
    store_detach( &f->s, b, FLAG );
    assert_refused( &f->s, shot.bytes, shot.size );
    // the same rows in all, split differently
    store_remove( &f->s, a );
    store_remove( &f->s, b );
    a = add( &f->s, 1 );
    b = add( &f->s, 3 );
    write_all( &f->s, a );
    write_all( &f->s, b );
    assert_refused( &f->s, shot.bytes, shot.size );
    // the same rows again, of entities of another generation
    store_remove( &f->s, a );
    store_remove( &f->s, b );
    write_all( &f->s, add( &f->s, 3 ) );
    write_all( &f->s, add( &f->s, 1 ) );
    assert_refused( &f->s, shot.bytes, shot.size );
    free( shot.bytes );
}

STORE_TEST( an_empty_store_restores_an_empty_snapshot )
{
    fixture* f = *state;
    snapshot shot = take_snapshot( &f->s );
    assert_int_equal( store_restore( &f->s, shot.bytes, shot.size, NULL ), WISP_OK );
    add( &f->s, 0 );
    assert_refused( &f->s, shot.bytes, shot.size );
    free( shot.bytes );
}

// ---- pending changes ----

enum
{
    WATCHER = 5,  // a pass that watches the shape
    WRITER = 200, // a pass that writes it
};

static const store_mask NOTHING = { { 0 } };

// The passes that wait on an entity are these and no others.
static bool waits( const store* s, wisp_entity e, store_mask passes )
{
    return memcmp( &store_find( s, e )->dirty, &passes, sizeof( passes ) ) == 0;
}

static void watch_shape( store* s )
{
    s->watchers[SHAPE] = store_bit( WATCHER );
    s->writers[SHAPE] = store_bit( WRITER );
}

STORE_TEST( everything_waits_on_a_new_entity )
{
    fixture* f = *state;
    wisp_entity a = add( &f->s, 1 );
    store_find( &f->s, a )->dirty = NOTHING;
    store_remove( &f->s, a );
    wisp_entity b = add( &f->s, 1 );
    assert_int_equal( b.index, a.index );
    assert_true( waits( &f->s, b, store_mask_all() ) );
}

STORE_TEST( a_write_wakes_who_watches_the_component_on_that_entity_alone )
{
    fixture* f = *state;
    watch_shape( &f->s );
    wisp_entity a = add( &f->s, 1 ), b = add( &f->s, 1 );
    store_find( &f->s, a )->dirty = store_find( &f->s, b )->dirty = NOTHING;
    store_touch( &f->s, store_find( &f->s, a ), POINT );
    assert_true( waits( &f->s, a, NOTHING ) );
    store_touch( &f->s, store_find( &f->s, a ), SHAPE );
    assert_true( waits( &f->s, a, store_bit( WATCHER ) ) );
    assert_true( waits( &f->s, b, NOTHING ) );
}

STORE_TEST( rows_that_are_new_wake_their_watchers_and_their_writers )
{
    fixture* f = *state;
    watch_shape( &f->s );
    wisp_entity e = add( &f->s, 1 );
    store_find( &f->s, e )->dirty = NOTHING;
    assert_true( store_attach( &f->s, e, SHAPE ) );
    assert_true( waits( &f->s, e, store_mask_or( store_bit( WATCHER ), store_bit( WRITER ) ) ) );
    store_find( &f->s, e )->dirty = NOTHING;
    assert_true( store_attach( &f->s, e, SHAPE ) ); // they exist already
    assert_true( waits( &f->s, e, NOTHING ) );
}

STORE_TEST( what_waits_is_part_of_the_snapshot )
{
    fixture* f = *state;
    wisp_entity e = add( &f->s, 1 );
    store_find( &f->s, e )->dirty = store_bit( WRITER );
    size_t size = store_snapshot_size( &f->s );
    void* bytes = checked_malloc( size );
    store_snapshot( &f->s, bytes );
    store_find( &f->s, e )->dirty = store_bit( WATCHER );
    assert_int_equal( store_restore( &f->s, bytes, size, NULL ), WISP_OK );
    free( bytes );
    assert_true( waits( &f->s, e, store_bit( WRITER ) ) );
}
