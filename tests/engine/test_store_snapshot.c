// Walks over the columns: hash, snapshot, restore; and pending changes of an entity.
#include "store_fixture.h"

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
