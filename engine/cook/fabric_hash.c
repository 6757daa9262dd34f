#include "fabric.h"

#include <string.h>

_Static_assert( sizeof( int ) == 4 && sizeof( float ) == 4 && sizeof( wisp_vec3 ) == 12,
                "a fabric is made of words" );

// Contents of a fabric, listed once, in the order of the hash, with all counts before the arrays. All data is 32-bit words;
// w( n ) is a length in a type that cannot overflow.

#define FABRIC_COUNTS( X )                                                                                           \
    X( vertex_count )                                                                                                \
    X( triangle_count )                                                                                              \
    X( tile_size )                                                                                                   \
    X( tile_count )                                                                                                  \
    X( slot_count )                                                                                                  \
    X( edge_count )                                                                                                  \
    X( hinge_count )                                                                                                 \
    X( open_edge_count )                                                                                             \
    X( nonmanifold_edge_count )                                                                                      \
    X( link_count )                                                                                                  \
    X( ring_slice_count )                                                                                            \
    X( tether_count )                                                                                                \
    X( attachment_count )                                                                                            \
    X( level_count )

#define FABRIC_SCHEDULE_COUNTS( X )                                                                                  \
    X( slot_count )                                                                                                  \
    X( tile_count )                                                                                                  \
    X( colour_count )

#define FABRIC_LEVEL_COUNTS( X )                                                                                     \
    X( vertex_count )                                                                                                \
    X( tile_size )                                                                                                   \
    X( row_count )                                                                                                   \
    X( first_row )                                                                                                   \
    X( first_link )                                                                                                  \
    X( unlinked_count )                                                                                              \
    X( link_count )                                                                                                  \
    X( chain_group_count )                                                                                           \
    X( finer_row_count )

#define FABRIC_SCHEDULE_ARRAYS( X, o )                                                                               \
    X( colour_tile, w( o->colour_count ) + 1 )                                                                       \
    X( tile_begin, w( o->tile_count ) + 1 )                                                                          \
    X( constraint, w( o->slot_count ) )

#define FABRIC_ARRAYS( X, o )                                                                                        \
    X( vertex_slot, w( o->vertex_count ) )                                                                           \
    X( slot_vertex, w( o->slot_count ) )                                                                             \
    X( rest, 3 * w( o->slot_count ) )                                                                                \
    X( area, w( o->slot_count ) )                                                                                    \
    X( triangles, 3 * w( o->triangle_count ) )                                                                       \
    X( edges, 2 * w( o->edge_count ) )                                                                               \
    X( hinges, 4 * w( o->hinge_count ) )                                                                             \
    X( link_a_x4, w( o->link_order.slot_count ) )                                                                    \
    X( link_b_x4, w( o->link_order.slot_count ) )                                                                    \
    X( link_rest, w( o->link_order.slot_count ) )                                                                    \
    X( hinge_slot_x4, 4 * w( o->hinge_order.slot_count ) )                                                           \
    X( ring_begin, w( o->ring_slice_count ) + 1 )                                                                    \
    X( ring_x4, WISP_FABRIC_LANES* w( o->ring_begin[o->ring_slice_count] ) )                                         \
    X( tether_x4, w( o->tether_count ) * w( o->slot_count ) )                                                        \
    X( tether_rest, w( o->tether_count ) * w( o->slot_count ) )                                                      \
    X( attachments, w( o->attachment_count ) )

#define FABRIC_LEVEL_ARRAYS( X, o )                                                                                  \
    X( slot_x4, w( o->row_count ) )                                                                                  \
    X( a_x4, w( o->schedule.slot_count ) )                                                                           \
    X( b_x4, w( o->schedule.slot_count ) )                                                                           \
    X( rest, w( o->schedule.slot_count ) )                                                                           \
    X( fraction, w( o->schedule.slot_count ) )                                                                       \
    X( chain_begin, w( o->chain_group_count ) + 1 )                                                                  \
    X( chain_x4, WISP_FABRIC_LANES* w( o->chain_begin[o->chain_group_count] ) )                                      \
    X( chain_rest, w( o->schedule.slot_count ) )                                                                     \
    X( parent_x4, WISP_FABRIC_PARENTS* padded_w( o->finer_row_count ) )                                              \
    X( weight, WISP_FABRIC_PARENTS* padded_w( o->finer_row_count ) )

static uint64_t w( int count )
{
    return count > 0 ? (uint64_t)count : 0;
}

static uint64_t padded_w( int count )
{
    return ( w( count ) + WISP_FABRIC_LANES - 1 ) / WISP_FABRIC_LANES * WISP_FABRIC_LANES;
}

// Each step is a bijection of the hash, so that a single different word always changes the result.
static uint64_t hash_word( uint64_t hash, uint32_t word )
{
    hash = ( hash ^ word ) * 0xff51afd7ed558ccdu;
    return hash ^ hash >> 32;
}

static uint64_t hash_array( uint64_t hash, const void* array, uint64_t words )
{
    for ( uint64_t i = 0; i < words; ++i )
    {
        uint32_t word;
        memcpy( &word, (const char*)array + 4 * i, 4 );
        hash = hash_word( hash, word );
    }
    return hash;
}

#define HASH_COUNT( name ) hash = hash_word( hash, (uint32_t)o->name );
#define HASH_ARRAY( name, words ) hash = hash_array( hash, o->name, words );

static uint64_t hash_schedule( uint64_t hash, const wisp_schedule* o )
{
    FABRIC_SCHEDULE_COUNTS( HASH_COUNT )
    FABRIC_SCHEDULE_ARRAYS( HASH_ARRAY, o )
    return hash;
}

static uint64_t hash_level( uint64_t hash, const wisp_fabric_level* o )
{
    FABRIC_LEVEL_COUNTS( HASH_COUNT )
    hash = hash_schedule( hash, &o->schedule );
    FABRIC_LEVEL_ARRAYS( HASH_ARRAY, o )
    return hash;
}

uint64_t fabric_hash( const wisp_fabric* o )
{
    uint64_t hash = 0;
    FABRIC_COUNTS( HASH_COUNT )
    hash = hash_word( hash, (uint32_t)o->solve_order );
    hash = hash_schedule( hash, &o->link_order );
    hash = hash_schedule( hash, &o->hinge_order );
    FABRIC_ARRAYS( HASH_ARRAY, o )
    for ( int i = 0; i < o->level_count; ++i )
    {
        hash = hash_level( hash, &o->levels[i] );
    }
    return hash;
}
