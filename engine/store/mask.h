/// Sets of small numbers: components, or passes.
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum
{
    STORE_MASK_WORDS = 4,
    STORE_MASK_BITS = 64 * STORE_MASK_WORDS,
};

/// Bit i % 64 of word i / 64: number i is in the set. Sets in memory go by pointer, so that a test reads one word.
typedef struct store_mask
{
    uint64_t word[STORE_MASK_WORDS];
} store_mask;

static inline bool store_mask_has( const store_mask* mask, int number )
{
    return ( mask->word[(unsigned)number / 64] >> (unsigned)number % 64 & 1 ) != 0;
}

static inline void store_mask_add( store_mask* mask, int number )
{
    mask->word[(unsigned)number / 64] |= (uint64_t)1 << (unsigned)number % 64;
}

static inline void store_mask_remove( store_mask* mask, int number )
{
    mask->word[(unsigned)number / 64] &= ~( (uint64_t)1 << (unsigned)number % 64 );
}

/// The set of one number.
static inline store_mask store_bit( int number )
{
    store_mask mask = { { 0 } };
    store_mask_add( &mask, number );
    return mask;
}

/// The set of all numbers.
static inline store_mask store_mask_all( void )
{
    return ( store_mask ){ { UINT64_MAX, UINT64_MAX, UINT64_MAX, UINT64_MAX } };
}

static inline store_mask store_mask_or( store_mask a, store_mask b )
{
    for ( int i = 0; i < STORE_MASK_WORDS; ++i )
    {
        a.word[i] |= b.word[i];
    }
    return a;
}

static inline store_mask store_mask_and( store_mask a, store_mask b )
{
    for ( int i = 0; i < STORE_MASK_WORDS; ++i )
    {
        a.word[i] &= b.word[i];
    }
    return a;
}

/// What is in a and not in b.
static inline store_mask store_mask_and_not( store_mask a, store_mask b )
{
    for ( int i = 0; i < STORE_MASK_WORDS; ++i )
    {
        a.word[i] &= ~b.word[i];
    }
    return a;
}

static inline bool store_mask_any( store_mask mask )
{
    uint64_t any = 0;
    for ( int i = 0; i < STORE_MASK_WORDS; ++i )
    {
        any |= mask.word[i];
    }
    return any != 0;
}

/// Whether a and b share a number.
static inline bool store_mask_meets( store_mask a, store_mask b )
{
    return store_mask_any( store_mask_and( a, b ) );
}

/// Whether all of b is in a.
static inline bool store_mask_holds( store_mask a, store_mask b )
{
    return store_mask_any( store_mask_and_not( b, a ) ) == false;
}
