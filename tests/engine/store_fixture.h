/// A store with components of every kind, and the state that its tests check.
#pragma once

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

static inline int set_up( void** state )
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

static inline int tear_down( void** state )
{
    fixture* f = *state;
    store_release( &f->s );
    assert_host_memory_is_released( &f->host );
    free( f );
    return 0;
}

// An entity with this number of strand rows and twice as many points; it must fit.
static inline wisp_entity add( store* s, int rows )
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

static inline size_t column_size( const store* s, wisp_entity entity, wisp_component c, int column )
{
    const store_component* component = s->components + c;
    return (size_t)store_find( s, entity )->rows[component->def.table].count *
           component->def.columns[column].row_size;
}

static inline unsigned char* bytes_of( const store* s, wisp_entity entity, wisp_component c, int column )
{
    return store_column( s, store_find( s, entity ), c, column );
}

// Every byte of every column of an entity identifies its owner.
static inline void write_all( store* s, wisp_entity entity )
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

static inline int wrong_bytes( const store* s, wisp_entity entity )
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

static inline bool all_zero( const void* bytes, size_t size )
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

static inline visible look_at( const store* s )
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

static inline void assert_same_visible( visible a, visible b )
{
    assert_int_equal( a.hash, b.hash );
    assert_int_equal( a.structure, b.structure );
    assert_int_equal( a.entities, b.entities );
    assert_int_equal( a.users_of_shape, b.users_of_shape );
    assert_int_equal( a.snapshot, b.snapshot );
    assert_memory_equal( a.rows, b.rows, sizeof( a.rows ) );
}

#define STORE_TEST( test ) TEST_WITH( test, set_up, tear_down )
