#include "alloc.h"

#include "arena.h"

#include <stdlib.h>
#include <string.h>

bool base_size_multiply( size_t a, size_t b, size_t* out )
{
    if ( b != 0 && a > SIZE_MAX / b )
    {
        return false;
    }
    *out = a * b;
    return true;
}

void* base_allocate( const wisp_allocator* allocator, size_t size, size_t alignment )
{
    WISP_ASSERT( alignment != 0 && ( alignment & ( alignment - 1 ) ) == 0 );

    // No object is larger than a ptrdiff_t can span; a host's hook need not expect such sizes either.
    if ( size == 0 || size > PTRDIFF_MAX - alignment )
    {
        return NULL;
    }
    if ( allocator != NULL && allocator->allocate != NULL )
    {
        return allocator->allocate( allocator->user, size, alignment );
    }

    // aligned_alloc requires at least the alignment of a pointer, and a size that is a multiple of the alignment.
    alignment = alignment < sizeof( void* ) ? sizeof( void* ) : alignment;
    return aligned_alloc( alignment, ( size + alignment - 1 ) & ~( alignment - 1 ) );
}

void base_release( const wisp_allocator* allocator, void* block, size_t size )
{
    if ( block == NULL )
    {
        return;
    }
    if ( allocator != NULL && allocator->release != NULL )
    {
        allocator->release( allocator->user, block, size );
    }
    else
    {
        free( block );
    }
}

bool base_buffer_reserve( const wisp_allocator* allocator, wisp_buffer* buffer, size_t bytes )
{
    if ( bytes <= buffer->size )
    {
        return true;
    }

    size_t grown = buffer->size <= SIZE_MAX / 2 ? buffer->size + buffer->size / 2 : 0;
    size_t size = bytes > grown ? bytes : grown;
    void* data = base_allocate( allocator, size, BASE_BUFFER_ALIGNMENT );
    if ( data == NULL )
    {
        return false;
    }

    if ( buffer->data != NULL )
    {
        memcpy( data, buffer->data, buffer->size );
        base_release( allocator, buffer->data, buffer->size );
    }
    *buffer = ( wisp_buffer ){ .data = data, .size = size };
    return true;
}

void base_buffer_release( const wisp_allocator* allocator, wisp_buffer* buffer )
{
    base_release( allocator, buffer->data, buffer->size );
    *buffer = ( wisp_buffer ){ 0 };
}

// ---- arenas ----

// Written at the start of an overflow block; the piece follows at the first aligned byte.
struct base_arena_overflow
{
    base_arena_overflow* next;
    size_t size; // of the whole block
};

// Round up to a multiple of a power of two; SIZE_MAX when that overflows, which no host can allocate.
static size_t align_up( size_t value, size_t alignment )
{
    return value > SIZE_MAX - ( alignment - 1 ) ? SIZE_MAX : ( value + alignment - 1 ) & ~( alignment - 1 );
}

static size_t add_saturating( size_t a, size_t b )
{
    return a > SIZE_MAX - b ? SIZE_MAX : a + b;
}

// Release the overflow blocks that are newer than `kept`.
static void release_overflow( base_arena* arena, const base_arena_overflow* kept )
{
    while ( arena->overflow != kept )
    {
        base_arena_overflow* next = arena->overflow->next;
        base_release( &arena->allocator, arena->overflow, arena->overflow->size );
        arena->overflow = next;
    }
}

static void* push_overflow( base_arena* arena, size_t size, size_t alignment )
{
    size_t header = align_up( sizeof( base_arena_overflow ), alignment );
    size_t whole = add_saturating( header, size );
    size_t block_alignment = alignment > BASE_BUFFER_ALIGNMENT ? alignment : BASE_BUFFER_ALIGNMENT;
    base_arena_overflow* link = base_allocate( &arena->allocator, whole, block_alignment );
    if ( link == NULL )
    {
        return NULL;
    }
    *link = ( base_arena_overflow ){ .next = arena->overflow, .size = whole };
    arena->overflow = link;
    return (unsigned char*)link + header;
}

// The new block is allocated before the old one is released, so that a failure leaves the arena unchanged.
static bool replace_block( base_arena* arena, size_t capacity )
{
    void* block = base_allocate( &arena->allocator, capacity, BASE_BUFFER_ALIGNMENT );
    if ( block == NULL )
    {
        return false;
    }
    base_release( &arena->allocator, arena->block, arena->capacity );
    arena->block = block;
    arena->capacity = capacity;
    return true;
}

// Size of a single block that would have sufficed. Padding to more than a cache line depends on the address of that
// block, so the worst case is counted.
static void record_requested( base_arena* arena, size_t size, size_t alignment )
{
    bool coarse = alignment > BASE_BUFFER_ALIGNMENT;
    size_t begin = align_up( arena->requested, coarse ? BASE_BUFFER_ALIGNMENT : alignment );
    size_t padding = coarse ? alignment - BASE_BUFFER_ALIGNMENT : 0;
    arena->requested = add_saturating( begin, add_saturating( padding, size ) );
    arena->high_water = arena->requested > arena->high_water ? arena->requested : arena->high_water;
}

void base_arena_init( base_arena* arena, const wisp_allocator* allocator, size_t capacity )
{
    *arena = ( base_arena ){ 0 };
    if ( allocator != NULL )
    {
        arena->allocator = *allocator;
    }
    replace_block( arena, capacity );
}

void* base_arena_push( base_arena* arena, size_t size, size_t alignment )
{
    WISP_ASSERT( alignment != 0 && ( alignment & ( alignment - 1 ) ) == 0 );
    if ( size == 0 )
    {
        return NULL;
    }
    record_requested( arena, size, alignment );

    // Aligned by address, because the block itself guarantees only a cache line.
    uintptr_t base = (uintptr_t)arena->block;
    size_t begin = (size_t)( align_up( base + arena->used, alignment ) - base );
    if ( begin > arena->capacity || size > arena->capacity - begin )
    {
        return push_overflow( arena, size, alignment );
    }
    arena->used = begin + size;
    return (unsigned char*)arena->block + begin;
}

base_arena_mark base_arena_get_mark( const base_arena* arena )
{
    return ( base_arena_mark ){ arena->used, arena->requested, arena->overflow };
}

void base_arena_rewind( base_arena* arena, base_arena_mark mark )
{
    release_overflow( arena, mark.overflow );
    arena->used = mark.used;
    arena->requested = mark.requested;
}

void base_arena_expect( base_arena* arena, size_t bytes )
{
    arena->high_water = bytes > arena->high_water ? bytes : arena->high_water;
}

void base_arena_reset( base_arena* arena )
{
    release_overflow( arena, NULL );

    // A size that the host cannot give is forgotten: one absurd request must not keep the arena from growing later.
    if ( arena->high_water > arena->capacity && !replace_block( arena, arena->high_water ) )
    {
        arena->high_water = arena->capacity;
    }
    arena->used = 0;
    arena->requested = 0;
}

void base_arena_release( base_arena* arena )
{
    release_overflow( arena, NULL );
    base_release( &arena->allocator, arena->block, arena->capacity );
    *arena = ( base_arena ){ .allocator = arena->allocator };
}

size_t base_arena_bytes( const base_arena* arena )
{
    size_t bytes = arena->capacity;
    for ( const base_arena_overflow* o = arena->overflow; o != NULL; o = o->next )
    {
        bytes += o->size;
    }
    return bytes;
}
