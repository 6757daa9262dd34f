/// Scratch memory of one step: pushed in any number of pieces, released all at once.
///
/// The arena adapts its size. Pieces beyond its block go into overflow blocks, and the next reset replaces all of
/// them by one block as large as the step required. A step that repeats therefore stops allocating.
#pragma once

#include "alloc.h"

typedef struct base_arena_overflow base_arena_overflow;

/// Pushes are not thread-safe: one arena per worker.
typedef struct base_arena
{
    wisp_allocator allocator;      ///< a copy, all null for the C library's memory
    void* block;                   ///< [capacity], null while cold
    size_t capacity;               ///< bytes
    size_t used;                   ///< bytes of the block in use
    size_t requested;              ///< bytes that one block for all pushes since the last reset would need
    size_t high_water;             ///< the largest `requested` so far
    base_arena_overflow* overflow; ///< the newest of the blocks that hold what did not fit
} base_arena;

/// Make an empty arena. Allocates only when capacity is not 0, and continues without the block if memory is short.
/// @param allocator may be null
/// @param capacity bytes to begin with
void base_arena_init( base_arena* arena, const wisp_allocator* allocator, size_t capacity );

/// A piece of uninitialised memory that lives until the next reset, or a rewind to before it.
/// @param alignment a power of two
/// @return null when size is 0, or when the block is full and the host has no memory for an overflow block
void* base_arena_push( base_arena* arena, size_t size, size_t alignment );

/// A position in an arena to return to.
typedef struct base_arena_mark
{
    size_t used, requested;
    base_arena_overflow* overflow;
} base_arena_mark;

base_arena_mark base_arena_get_mark( const base_arena* arena );

/// Release all pushes since the mark, and the overflow blocks that hold them: a thousand blocks of a cold arena need the
/// memory of one.
void base_arena_rewind( base_arena* arena, base_arena_mark mark );

/// Reserve this many bytes from the next reset on, as if they had been pushed before it.
void base_arena_expect( base_arena* arena, size_t bytes );

/// Release all pieces, and grow the block to the high-water mark. If memory is too short for that, the arena keeps
/// its block and forgets the mark.
void base_arena_reset( base_arena* arena );

/// @return bytes that it holds, overflow blocks included
size_t base_arena_bytes( const base_arena* arena );

/// Return all memory to the host. The arena is as after an init with capacity 0.
void base_arena_release( base_arena* arena );
