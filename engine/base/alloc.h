/// Memory from the host: single blocks and a buffer that grows.
#pragma once

#include "wisp/base.h"

/// Every buffer starts on a cache line, which also satisfies the widest vector load.
#define BASE_BUFFER_ALIGNMENT 64

/// a * b
/// @return false when the product does not fit into a size_t; *out is then unchanged
bool base_size_multiply( size_t a, size_t b, size_t* out );

/// Allocate a block from the host's hooks, or from aligned_alloc where there are none.
/// @param allocator may be null, which means no hooks
/// @param alignment a power of two
/// @return null when size is 0 or memory is short; sizes near PTRDIFF_MAX never reach the hooks
void* base_allocate( const wisp_allocator* allocator, size_t size, size_t alignment );

/// Release a block. A null block is ignored.
/// @param size as requested
void base_release( const wisp_allocator* allocator, void* block, size_t size );

/// Make room for at least `bytes` and keep the contents. The buffer grows by half its size or more, so that repeated
/// small requests copy little. Its data is aligned to BASE_BUFFER_ALIGNMENT; new bytes are not initialised.
/// @return false when memory is short; the buffer is then unchanged
bool base_buffer_reserve( const wisp_allocator* allocator, wisp_buffer* buffer, size_t bytes );

/// Release the memory; the buffer is empty and may be used again.
void base_buffer_release( const wisp_allocator* allocator, wisp_buffer* buffer );
