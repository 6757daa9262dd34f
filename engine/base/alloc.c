#include "alloc.h"

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
