// The lowest folder: blocks of the host's memory, the growing buffer, the arena.
#include "unit.h"

#include "alloc.h"
#include "arena.h"

// A host that counts, and that can run out of memory.
typedef struct counting_host
{
    int allocate_count;
    int release_count;
    size_t bytes_held;
    bool out_of_memory;
} counting_host;

static void* counting_allocate( void* user, size_t size, size_t alignment )
{
    counting_host* host = user;
    if ( host->out_of_memory )
    {
        return NULL;
    }
    host->allocate_count += 1;
    host->bytes_held += size;
    return aligned_alloc( alignment, ( size + alignment - 1 ) / alignment * alignment );
}

static void counting_release( void* user, void* block, size_t size )
{
    counting_host* host = user;
    host->release_count += 1;
    host->bytes_held -= size;
    free( block );
}

static wisp_allocator allocator_of( counting_host* host )
{
    return ( wisp_allocator ){ .allocate = counting_allocate, .release = counting_release, .user = host };
}

// ---- single blocks

TEST( blocks_come_from_the_hooks_and_return_to_them_with_their_size )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );

    void* block = base_allocate( &allocator, 100, 64 );
    assert_non_null( block );
    assert_int_equal( host.allocate_count, 1 );
    assert_int_equal( host.bytes_held, 100 );

    base_release( &allocator, block, 100 );
    assert_int_equal( host.release_count, 1 );
    assert_int_equal( host.bytes_held, 0 );
}

TEST( blocks_without_hooks_are_aligned_as_queried )
{
    const wisp_allocator zero = { 0 };
    for ( size_t alignment = 1; alignment <= 4096; alignment *= 2 )
    {
        void* block = base_allocate( alignment % 3 == 1 ? NULL : &zero, 3 * alignment + 1, alignment );
        assert_non_null( block );
        assert_int_equal( (uintptr_t)block % alignment, 0 );
        memset( block, 0x5a, 3 * alignment + 1 );
        base_release( NULL, block, 3 * alignment + 1 );
    }
}

TEST( no_bytes_are_no_block )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );

    assert_null( base_allocate( &allocator, 0, 16 ) );
    assert_null( base_allocate( NULL, 0, 16 ) );
    base_release( &allocator, NULL, 0 );
    assert_int_equal( host.allocate_count, 0 );
    assert_int_equal( host.release_count, 0 );
}

TEST( impossible_sizes_are_refused_before_they_reach_the_hooks )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );

    assert_null( base_allocate( &allocator, SIZE_MAX, 64 ) );
    assert_null( base_allocate( NULL, SIZE_MAX - 63, 64 ) );
    assert_null( base_allocate( NULL, (size_t)PTRDIFF_MAX, 64 ) );
    assert_int_equal( host.allocate_count, 0 );
}

TEST( a_product_of_sizes_that_overflows_is_noticed )
{
    size_t product = 7;
    assert_true( base_size_multiply( SIZE_MAX, 0, &product ) );
    assert_int_equal( product, 0 );
    assert_true( base_size_multiply( SIZE_MAX / 3, 3, &product ) );
    assert_int_equal( product, SIZE_MAX / 3 * 3 );

    product = 7;
    assert_false( base_size_multiply( SIZE_MAX / 3 + 1, 3, &product ) );
    assert_false( base_size_multiply( SIZE_MAX, SIZE_MAX, &product ) );
    assert_int_equal( product, 7 );
}

// ---- the growing buffer

TEST( a_buffer_grows_geometrically_and_keeps_its_contents )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );
    wisp_buffer buffer = { 0 };

    for ( size_t count = 1; count <= 100000; ++count )
    {
        assert_true( base_buffer_reserve( &allocator, &buffer, count ) );
        assert_int_equal( (uintptr_t)buffer.data % BASE_BUFFER_ALIGNMENT, 0 );
        ( (unsigned char*)buffer.data )[count - 1] = (unsigned char)( count * 37 );
    }
    for ( size_t count = 1; count <= 100000; ++count )
    {
        assert_int_equal( ( (unsigned char*)buffer.data )[count - 1], (unsigned char)( count * 37 ) );
    }

    // log( 100000 ) / log( 1.5 ) = 28.4 growths, and a few more while half of a tiny size rounds down
    assert_in_range( host.allocate_count, 20, 34 );
    assert_int_equal( host.bytes_held, buffer.size );

    base_buffer_release( &allocator, &buffer );
    assert_null( buffer.data );
    assert_int_equal( buffer.size, 0 );
    assert_int_equal( host.bytes_held, 0 );
    assert_int_equal( host.allocate_count, host.release_count );
}

TEST( a_buffer_that_is_large_enough_is_left_alone )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );
    wisp_buffer buffer = { 0 };
    assert_true( base_buffer_reserve( &allocator, &buffer, 1000 ) );
    void* data = buffer.data;

    assert_true( base_buffer_reserve( &allocator, &buffer, 0 ) );
    assert_true( base_buffer_reserve( &allocator, &buffer, 1000 ) );

    assert_ptr_equal( buffer.data, data );
    assert_int_equal( host.allocate_count, 1 );
    base_buffer_release( &allocator, &buffer );
}

TEST( a_buffer_that_cannot_grow_is_unchanged )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );
    wisp_buffer buffer = { 0 };
    assert_true( base_buffer_reserve( &allocator, &buffer, 100 ) );
    memset( buffer.data, 42, 100 );
    wisp_buffer before = buffer;

    host.out_of_memory = true;
    assert_false( base_buffer_reserve( &allocator, &buffer, 101 ) );
    host.out_of_memory = false;
    assert_false( base_buffer_reserve( &allocator, &buffer, SIZE_MAX ) );

    assert_ptr_equal( buffer.data, before.data );
    assert_int_equal( buffer.size, before.size );
    assert_int_equal( ( (unsigned char*)buffer.data )[99], 42 );
    assert_int_equal( host.release_count, 0 );
    base_buffer_release( &allocator, &buffer );
}

// ---- the arena

// One step: pieces of many sizes and alignments, each filled, so that an overlap would show.
static void run_step( base_arena* arena )
{
    unsigned char* primitive[50];
    for ( size_t k = 0; k < 50; ++k )
    {
        size_t alignment = (size_t)1 << ( k * 7 % 9 );
        primitive[k] = base_arena_push( arena, 13 * k + 1, alignment );
        assert_non_null( primitive[k] );
        assert_int_equal( (uintptr_t)primitive[k] % alignment, 0 );
        memset( primitive[k], (int)k, 13 * k + 1 );
    }
    for ( size_t k = 0; k < 50; ++k )
    {
        for ( size_t byte = 0; byte < 13 * k + 1; ++byte )
        {
            assert_int_equal( primitive[k][byte], k );
        }
    }
}

TEST( an_arena_stops_allocating_once_it_is_warm )
{
    const size_t capacities[] = { 0, 1, 1000, 1000000 };
    for ( int c = 0; c < WISP_COUNT( capacities ); ++c )
    {
        counting_host host = { 0 };
        wisp_allocator allocator = allocator_of( &host );
        base_arena arena;
        base_arena_init( &arena, &allocator, capacities[c] );

        run_step( &arena );
        base_arena_reset( &arena );
        int warm = host.allocate_count;
        for ( int step = 0; step < 10; ++step )
        {
            run_step( &arena );
            assert_null( arena.overflow );
            base_arena_reset( &arena );
        }
        assert_int_equal( host.allocate_count, warm );
        assert_int_equal( host.bytes_held, arena.capacity );

        base_arena_release( &arena );
        assert_int_equal( host.bytes_held, 0 );
        assert_int_equal( host.allocate_count, host.release_count );
    }
}

TEST( an_arena_keeps_its_size_through_smaller_steps )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );
    base_arena arena;
    base_arena_init( &arena, &allocator, 0 );
    assert_non_null( base_arena_push( &arena, 5000, 64 ) );
    base_arena_reset( &arena );
    int warm = host.allocate_count;

    assert_non_null( base_arena_push( &arena, 10, 64 ) );
    base_arena_reset( &arena );
    assert_non_null( base_arena_push( &arena, 5000, 64 ) );

    assert_int_equal( host.allocate_count, warm );
    assert_int_equal( arena.high_water, 5000 );
    base_arena_release( &arena );
}

TEST( an_arena_without_memory_says_null_and_recovers )
{
    counting_host host = { .out_of_memory = true };
    wisp_allocator allocator = allocator_of( &host );
    base_arena arena;
    base_arena_init( &arena, &allocator, 100 );
    assert_null( base_arena_push( &arena, 100, 8 ) );
    host.out_of_memory = false;

    // The request was recorded, so the reset provides it in one block.
    base_arena_reset( &arena );
    assert_int_equal( host.allocate_count, 1 );
    assert_non_null( base_arena_push( &arena, 100, 8 ) );
    assert_int_equal( host.allocate_count, 1 );
    base_arena_release( &arena );
    assert_int_equal( host.bytes_held, 0 );
}

TEST( an_absurd_push_does_not_keep_an_arena_from_growing )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );
    base_arena arena;
    base_arena_init( &arena, &allocator, 256 );
    void* block = arena.block;

    assert_null( base_arena_push( &arena, SIZE_MAX - 5, 4096 ) );
    base_arena_reset( &arena );
    assert_ptr_equal( arena.block, block );
    assert_int_equal( arena.capacity, 256 );

    run_step( &arena );
    base_arena_reset( &arena );
    int warm = host.allocate_count;
    run_step( &arena );
    assert_int_equal( host.allocate_count, warm );
    base_arena_release( &arena );
}

TEST( an_arena_rewinds_to_a_mark_and_makes_the_room_it_is_told_to_expect )
{
    base_arena arena;
    base_arena_init( &arena, NULL, 0 );
    base_arena_expect( &arena, 1000 );
    base_arena_reset( &arena );
    unsigned char* first = base_arena_push( &arena, 10, 8 );
    base_arena_mark mark = base_arena_get_mark( &arena );
    for ( int block = 0; block < 10; ++block )
    {
        assert_ptr_equal( base_arena_push( &arena, 900, 64 ), first + 64 );
        base_arena_rewind( &arena, mark );
    }
    assert_null( arena.overflow );
    assert_int_equal( arena.capacity, 1000 );
    base_arena_release( &arena );
}

// The first step of a world has a thousand blocks, one after the other, before its arena can grow.
TEST( a_cold_arena_holds_only_what_is_pushed_since_its_mark )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );
    base_arena arena;
    base_arena_init( &arena, &allocator, 0 );
    unsigned char* kept = base_arena_push( &arena, 10, 8 );
    kept[9] = 42;
    const base_arena_mark mark = base_arena_get_mark( &arena );
    const size_t held = host.bytes_held;
    for ( int block = 0; block < 1000; ++block )
    {
        assert_non_null( base_arena_push( &arena, 900, 64 ) );
        assert_non_null( base_arena_push( &arena, 100, 64 ) );
        base_arena_rewind( &arena, mark );
        assert_int_equal( host.bytes_held, held );
    }
    assert_int_equal( kept[9], 42 );
    base_arena_reset( &arena );
    assert_true( arena.capacity >= 1010 && arena.capacity < 2000 );
    base_arena_release( &arena );
    assert_int_equal( host.bytes_held, 0 );
}
