// Schedules of constraints: sorted, cut into tiles, and as slots for kernels.
#include "fabric_schedule.h"

#include <string.h>

// ---- sorting ----

// Sorts by the largest or the smallest slot with a stable counting sort. A null `from` means by index.
static void sort_by( const fabric_constraints* in, bool largest, const int32_t* from, int32_t* to, int32_t* place )
{
    memset( place, 0, ( (size_t)in->vertex_count + 1 ) * sizeof( int32_t ) );
    for ( int32_t c = 0; c < in->count; ++c )
    {
        place[schedule_extreme( in, c, largest ) + 1] += 1;
    }
    for ( int v = 0; v < in->vertex_count; ++v )
    {
        place[v + 1] += place[v];
    }
    for ( int32_t i = 0; i < in->count; ++i )
    {
        int32_t c = from != NULL ? from[i] : i;
        to[place[schedule_extreme( in, c, largest )]++] = c;
    }
}

// Sorts by smallest, then largest slot: the order of a sweep over the mesh, in which tiles are contiguous.
static bool sort( schedule_state* s )
{
    const fabric_constraints* in = s->in;
    size_t arity = (size_t)in->arity;
    fabric_pool scratch = { .allocator = s->scratch.allocator };
    int32_t* by_largest = fabric_pool_push( &scratch, (size_t)in->count, sizeof( int32_t ) );
    int32_t* place = fabric_pool_push( &scratch, (size_t)in->vertex_count + 1, sizeof( int32_t ) );
    bool done = by_largest != NULL && place != NULL;
    if ( done )
    {
        sort_by( in, true, NULL, by_largest, place );
        sort_by( in, false, by_largest, s->order, place );
        for ( size_t i = 0; i < (size_t)in->count; ++i )
        {
            memcpy( s->slots + i * arity, in->slots + (size_t)s->order[i] * arity, arity * sizeof( int32_t ) );
        }
    }
    fabric_pool_release( &scratch );
    return done;
}

// ---- tiles ----

// A schedule before it is converted to the fabric's arrays.
static bool reserve( schedule_state* s, int max_in_tile, int max_tiles )
{
    fabric_pool* pool = &s->scratch;
    size_t n = (size_t)max_in_tile, vertices = (size_t)s->in->vertex_count, tiles = (size_t)max_tiles;
    s->taken = fabric_pool_push_zeroed( pool, vertices, sizeof( uint64_t ) );
    s->later = fabric_pool_push_zeroed( pool, vertices, sizeof( int32_t ) );
    s->stamp = fabric_pool_push_zeroed( pool, vertices, sizeof( int32_t ) );
    s->colour = fabric_pool_push( pool, n, sizeof( int32_t ) );
    s->member = fabric_pool_push( pool, n, sizeof( int32_t ) );
    s->begin = fabric_pool_push( pool, n + WORD_COLOURS + 2, sizeof( int32_t ) );
    s->tile_end = fabric_pool_push( pool, tiles, sizeof( int32_t ) );
    s->colour_end = fabric_pool_push( pool, tiles, sizeof( int32_t ) );
    return s->taken != NULL && s->later != NULL && s->stamp != NULL && s->colour != NULL && s->member != NULL &&
           s->begin != NULL && s->tile_end != NULL && s->colour_end != NULL;
}

// Finds the begin of each tile in the sorted order; tiles without constraints are skipped.
// @param first [constraints + 1] output
// @return number of tiles
static int find_tiles( const schedule_state* s, int32_t* first, int* max_in_tile )
{
    int tiles = 0, last_tile = -1;
    for ( int i = 0; i < s->in->count; ++i )
    {
        int tile = schedule_extreme( s->in, s->order[i], false ) / s->in->tile_size;
        if ( tile != last_tile )
        {
            first[tiles++] = i;
            last_tile = tile;
        }
    }
    first[tiles] = s->in->count;
    *max_in_tile = 0;
    for ( int t = 0; t < tiles; ++t )
    {
        *max_in_tile = first[t + 1] - first[t] > *max_in_tile ? first[t + 1] - first[t] : *max_in_tile;
    }
    return tiles;
}

// Colours tiles so that tiles of one colour share no vertex. Constraints extend into later tiles only, so tiles
// that touch only the next one alternate between two colours.
static bool colour_tiles( schedule_state* s, const int32_t* first, int tiles, int32_t* begin, int32_t* sorted )
{
    size_t arity = (size_t)s->in->arity;
    int32_t* colour = fabric_pool_push( &s->scratch, (size_t)tiles, sizeof( int32_t ) );
    if ( colour == NULL )
    {
        return false;
    }
    for ( int t = 0; t < tiles; ++t )
    {
        colour[t] =
            schedule_give_colour( s, schedule_slots_of( s, first[t] ), (size_t)( first[t + 1] - first[t] ) * arity );
    }
    schedule_forget_colours( s, s->slots, (size_t)s->in->count * arity );
    s->colours = schedule_sort_by_colour( colour, tiles, begin, sorted );
    return true;
}

static bool emit_tiles( schedule_state* s )
{
    fabric_pool* pool = &s->scratch;
    int max_in_tile = 0;
    int32_t* first = fabric_pool_push( pool, (size_t)s->in->count + 1, sizeof( int32_t ) );
    if ( first == NULL )
    {
        return false;
    }
    int tiles = find_tiles( s, first, &max_in_tile );
    int32_t* begin = fabric_pool_push( pool, (size_t)tiles + WORD_COLOURS + 2, sizeof( int32_t ) );
    int32_t* sorted = fabric_pool_push( pool, (size_t)tiles, sizeof( int32_t ) );
    if ( begin == NULL || sorted == NULL || reserve( s, max_in_tile, tiles ) == false ||
         colour_tiles( s, first, tiles, begin, sorted ) == false )
    {
        return false;
    }
    for ( int c = 0; c < s->colours; ++c )
    {
        for ( int i = begin[c]; i < begin[c + 1]; ++i )
        {
            int t = sorted[i], tile_begin = s->slot_count;
            bool done = s->in->solve_order == WISP_SOLVE_ORDER_LIST
                            ? schedule_emit_by_list( s, first[t], first[t + 1] )
                            : schedule_emit_by_colour( s, first[t], first[t + 1] ) &&
                                  schedule_put_attached_last( s, tile_begin );
            if ( done == false )
            {
                return false;
            }
            schedule_close_tile( s );
        }

        // beyond the colours of the mask, colours may be skipped
        if ( begin[c + 1] > begin[c] )
        {
            schedule_close_colour( s );
        }
    }
    return true;
}

// ---- construction ----

// Converts ends to offsets, with a leading 0.
static int32_t* keep_ends( fabric_pool* keep, const int32_t* ends, int count )
{
    int32_t* kept = fabric_pool_push( keep, (size_t)count + 1, sizeof( int32_t ) );
    if ( kept != NULL )
    {
        kept[0] = 0;
        memcpy( kept + 1, ends, (size_t)count * sizeof( int32_t ) );
    }
    return kept;
}

static bool keep_schedule( const schedule_state* s, fabric_pool* keep, wisp_schedule* out )
{
    int32_t* constraint = fabric_pool_push( keep, (size_t)s->slot_count, sizeof( int32_t ) );
    int32_t* colour_tile = keep_ends( keep, s->colour_end, s->colour_count );
    int32_t* tile_begin = keep_ends( keep, s->tile_end, s->tile_count );
    if ( constraint == NULL || colour_tile == NULL || tile_begin == NULL )
    {
        return false;
    }
    if ( s->slot_count > 0 )
    {
        memcpy( constraint, s->emitted.data, (size_t)s->slot_count * sizeof( int32_t ) );
    }
    *out = ( wisp_schedule ){
        .slot_count = s->slot_count,
        .tile_count = s->tile_count,
        .colour_count = s->colour_count,
        .colour_tile = colour_tile,
        .tile_begin = tile_begin,
        .constraint = constraint,
    };
    return true;
}

bool fabric_schedule_build( const fabric_constraints* constraints, fabric_pool* keep, wisp_schedule* out )
{
    schedule_state s = { .in = constraints, .scratch = { .allocator = keep->allocator } };
    size_t count = (size_t)constraints->count;
    s.order = fabric_pool_push( &s.scratch, count, sizeof( int32_t ) );
    s.slots = fabric_pool_push( &s.scratch, count * (size_t)constraints->arity, sizeof( int32_t ) );
    bool done = s.order != NULL && s.slots != NULL && sort( &s );
    if ( done && constraints->tile_size > 0 )
    {
        done = emit_tiles( &s );
    }
    else if ( done )
    {
        done = reserve( &s, constraints->count, constraints->count ) &&
               schedule_emit_by_colour( &s, 0, constraints->count );
    }
    done = done && keep_schedule( &s, keep, out );
    base_buffer_release( s.scratch.allocator, &s.emitted );
    base_buffer_release( s.scratch.allocator, &s.attached );
    fabric_pool_release( &s.scratch );
    return done;
}

// ---- slots of scheduled constraints ----

// Returns the padding of a tile: the dummy of the slot tile that contains its first constraint.
static int32_t dummy4( const wisp_schedule* schedule, const fabric_constraints* in, int tile )
{
    int32_t first = schedule->constraint[schedule->tile_begin[tile]];
    int32_t slots_tile = in->tile_size > 0 ? schedule_extreme( in, first, false ) / in->tile_size : 0;
    return 4 * ( in->vertex_count + slots_tile );
}

bool fabric_schedule_links( const wisp_schedule* schedule, const fabric_constraints* constraints, const float* rest,
                            fabric_pool* keep, fabric_links* out )
{
    size_t count = (size_t)schedule->slot_count;
    int32_t* a_x4 = fabric_pool_push( keep, count, sizeof( int32_t ) );
    int32_t* b_x4 = fabric_pool_push( keep, count, sizeof( int32_t ) );
    float* lane_rest = fabric_pool_push( keep, count, sizeof( float ) );
    if ( a_x4 == NULL || b_x4 == NULL || lane_rest == NULL )
    {
        return false;
    }
    for ( int tile = 0; tile < schedule->tile_count; ++tile )
    {
        int32_t pad = dummy4( schedule, constraints, tile );
        for ( int32_t i = schedule->tile_begin[tile]; i < schedule->tile_begin[tile + 1]; ++i )
        {
            int32_t c = schedule->constraint[i];
            a_x4[i] = c >= 0 ? 4 * constraints->slots[2 * (size_t)c] : pad;
            b_x4[i] = c >= 0 ? 4 * constraints->slots[2 * (size_t)c + 1] : pad;
            lane_rest[i] = c >= 0 ? rest[c] : 0.0f;
        }
    }
    *out = ( fabric_links ){ .a_x4 = a_x4, .b_x4 = b_x4, .rest = lane_rest };
    return true;
}

bool fabric_schedule_corners( const wisp_schedule* schedule, const fabric_constraints* constraints, fabric_pool* keep,
                              const int32_t** out )
{
    const size_t arity = (size_t)constraints->arity;
    int32_t* slot_x4 = fabric_pool_push( keep, arity * (size_t)schedule->slot_count, sizeof( int32_t ) );
    for ( int tile = 0; tile < schedule->tile_count && slot_x4 != NULL; ++tile )
    {
        int32_t pad = dummy4( schedule, constraints, tile );
        for ( int32_t i = schedule->tile_begin[tile]; i < schedule->tile_begin[tile + 1]; ++i )
        {
            int32_t c = schedule->constraint[i];
            int32_t* lane = slot_x4 + arity * (size_t)( i - i % WISP_FABRIC_LANES ) + i % WISP_FABRIC_LANES;
            for ( size_t k = 0; k < arity; ++k )
            {
                lane[k * WISP_FABRIC_LANES] = c >= 0 ? 4 * constraints->slots[arity * (size_t)c + k] : pad;
            }
        }
    }
    *out = slot_x4;
    return slot_x4 != NULL;
}
