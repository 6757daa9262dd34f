// Memory of a fabric: arrays that are released together, and the reference count.
#include "fabric.h"

#include "alloc.h"

#include <string.h>

// ---- memory ----

struct fabric_block
{
    fabric_block* previous;
    size_t size; // including this header
};

// The header occupies a cache line, so that the array after it is aligned to one.
#define BLOCK_HEAD BASE_BUFFER_ALIGNMENT

void* fabric_pool_push( fabric_pool* pool, size_t count, size_t element_size )
{
    size_t size = 0;
    if ( base_size_multiply( count, element_size, &size ) == false || size > SIZE_MAX - BLOCK_HEAD )
    {
        return NULL;
    }
    size += BLOCK_HEAD;
    fabric_block* block = base_allocate( pool->allocator, size, BASE_BUFFER_ALIGNMENT );
    if ( block == NULL )
    {
        return NULL;
    }
    *block = ( fabric_block ){ .previous = pool->last, .size = size };
    pool->last = block;
    pool->bytes += size;
    return (char*)block + BLOCK_HEAD;
}

void* fabric_pool_push_zeroed( fabric_pool* pool, size_t count, size_t element_size )
{
    void* array = fabric_pool_push( pool, count, element_size );
    if ( array != NULL )
    {
        memset( array, 0, count * element_size );
    }
    return array;
}

void fabric_pool_release( fabric_pool* pool )
{
    while ( pool->last != NULL )
    {
        fabric_block* block = pool->last;
        pool->last = block->previous;
        base_release( pool->allocator, block, block->size );
    }
    pool->bytes = 0;
}

// ---- references ----

cook_fabric* fabric_create( const wisp_allocator* allocator )
{
    cook_fabric* cooked = base_allocate( allocator, sizeof( cook_fabric ), BASE_BUFFER_ALIGNMENT );
    if ( cooked != NULL )
    {
        memset( cooked, 0, sizeof( *cooked ) );
        cooked->keep.allocator = cooked->edges.allocator = allocator;
        cooked->rings.allocator = cooked->spans.allocator = allocator;
        atomic_flag_clear( &cooked->is_making );
        atomic_init( &cooked->owners, 1 );
    }
    return cooked;
}

void wisp_fabric_retain( wisp_fabric* fabric )
{
    cook_fabric* cooked = (cook_fabric*)fabric;
    if ( cooked != NULL )
    {
        atomic_fetch_add_explicit( &cooked->owners, 1, memory_order_relaxed );
    }
}

void wisp_fabric_release( wisp_fabric* fabric )
{
    cook_fabric* cooked = (cook_fabric*)fabric;

    // acquire: the last reference must see the writes of the others before it frees
    if ( cooked != NULL && atomic_fetch_sub_explicit( &cooked->owners, 1, memory_order_acq_rel ) == 1 )
    {
        fabric_pool keep = cooked->keep;
        fabric_pool_release( &cooked->edges );
        fabric_pool_release( &cooked->rings );
        fabric_pool_release( &cooked->spans );
        fabric_pool_release( &keep );
        base_release( keep.allocator, cooked, sizeof( *cooked ) );
    }
}

size_t wisp_fabric_bytes( const wisp_fabric* fabric )
{
    const cook_fabric* cooked = (const cook_fabric*)fabric;
    return cooked != NULL ? sizeof( cook_fabric ) + cooked->keep.bytes + cooked->edges.bytes + cooked->rings.bytes +
                                cooked->spans.bytes
                          : 0;
}
