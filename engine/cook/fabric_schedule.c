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

static bool keep_schedule( const schedule_state* s, fabric_pool* keep, fabric_pool* numbers, wisp_schedule* out )
{
    int32_t* constraint = fabric_pool_push( numbers, (size_t)s->slot_count, sizeof( int32_t ) );
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

bool fabric_schedule_build( const fabric_constraints* constraints, fabric_pool* keep, fabric_pool* numbers,
                            wisp_schedule* out )
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
    done = done && keep_schedule( &s, keep, numbers, out );
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

// Lists one slot of each constraint, in groups of lanes that are so many words apart.
static void put_slots( const wisp_schedule* schedule, const fabric_constraints* in, size_t slot, size_t group,
                       int32_t* out_x4 )
{
    for ( int tile = 0; tile < schedule->tile_count; ++tile )
    {
        const int32_t pad = dummy4( schedule, in, tile );
        for ( int32_t i = schedule->tile_begin[tile]; i < schedule->tile_begin[tile + 1]; ++i )
        {
            const int32_t c = schedule->constraint[i];
            out_x4[(size_t)( i / WISP_FABRIC_LANES ) * group + (size_t)( i % WISP_FABRIC_LANES )] =
                c >= 0 ? 4 * in->slots[(size_t)in->arity * (size_t)c + slot] : pad;
        }
    }
}

bool fabric_schedule_links( const wisp_schedule* schedule, const fabric_constraints* constraints, const float* rest,
                            fabric_pool* keep, fabric_links* out )
{
    const size_t count = (size_t)schedule->slot_count;
    int32_t* a_x4 = fabric_pool_push( keep, count, sizeof( int32_t ) );
    int32_t* b_x4 = fabric_pool_push( keep, count, sizeof( int32_t ) );
    float* lane_rest = fabric_pool_push( keep, count, sizeof( float ) );
    if ( a_x4 == NULL || b_x4 == NULL || lane_rest == NULL )
    {
        return false;
    }
    put_slots( schedule, constraints, 0, WISP_FABRIC_LANES, a_x4 );
    put_slots( schedule, constraints, 1, WISP_FABRIC_LANES, b_x4 );
    for ( size_t i = 0; i < count; ++i )
    {
        lane_rest[i] = schedule->constraint[i] >= 0 ? rest[schedule->constraint[i]] : 0.0f;
    }
    *out = ( fabric_links ){ .a_x4 = a_x4, .b_x4 = b_x4, .rest = lane_rest };
    return true;
}

bool fabric_schedule_corners( const wisp_schedule* schedule, const fabric_constraints* constraints, fabric_pool* keep,
                              const int32_t** out )
{
    const size_t arity = (size_t)constraints->arity;
    int32_t* slot_x4 = fabric_pool_push( keep, arity * (size_t)schedule->slot_count, sizeof( int32_t ) );
    for ( size_t k = 0; k < arity && slot_x4 != NULL; ++k )
    {
        put_slots( schedule, constraints, k, arity * WISP_FABRIC_LANES, slot_x4 + k * WISP_FABRIC_LANES );
    }
    *out = slot_x4;
    return slot_x4 != NULL;
}

// ---- strips of triangles ----

// What a lane takes in a step.
typedef struct strip_step
{
    int32_t slot;
    bool is_triangle, first_stays; // of the two vertices before it, the older one
} strip_step;

typedef struct strip_state
{
    const wisp_fabric* f;
    const int32_t* corner_begin;
    int32_t *corner, *corner_count; // of the vertices, without triangles that are found to be taken
    int32_t* tile;                  // [triangle], -1 once it is taken
    strip_step* steps;              // of all tiles
    int32_t* end;                   // [tile] of its steps
    int32_t count, at;              // steps so far, and the tile
} strip_state;

static bool has_corner( const int32_t* t, int32_t v )
{
    return t[0] == v || t[1] == v || t[2] == v;
}

// Finds a triangle of the tile at the edge of two vertices, by the one that has fewer triangles left.
static int32_t find_at_edge( strip_state* s, int32_t a, int32_t b )
{
    const int32_t v = s->corner_count[a] < s->corner_count[b] ? a : b;
    int32_t* corner = s->corner + s->corner_begin[v];
    for ( int32_t i = 0; i < s->corner_count[v]; )
    {
        const int32_t t = corner[i] / 3;
        if ( s->tile[t] == s->at && has_corner( s->f->triangles + 3 * (size_t)t, v == a ? b : a ) )
        {
            return t;
        }
        if ( s->tile[t] < 0 )
        {
            corner[i] = corner[--s->corner_count[v]];
            continue;
        }
        ++i;
    }
    return -1;
}

// Begin a strip with the edge across which it goes on, if there is one, as the last.
static void begin_strip( strip_state* s, int32_t t )
{
    const int32_t* v = s->f->triangles + 3 * (size_t)t;
    int k = 0;
    s->tile[t] = -1;
    while ( k < 2 && find_at_edge( s, v[( k + 1 ) % 3], v[( k + 2 ) % 3] ) < 0 )
    {
        ++k;
    }
    for ( int c = 0; c < 3; ++c )
    {
        s->steps[s->count++] = ( strip_step ){ v[( k + c ) % 3], c == 2, false };
    }
}

// Walk from triangle to triangle: across the edge of the two newest vertices, or around the oldest one.
static void walk_strip( strip_state* s, int32_t t )
{
    begin_strip( s, t );
    int32_t a = s->steps[s->count - 3].slot, b = s->steps[s->count - 2].slot;
    for ( ;; )
    {
        const int32_t c = s->steps[s->count - 1].slot;
        int32_t next = find_at_edge( s, b, c );
        if ( next < 0 )
        {
            next = find_at_edge( s, a, c );
            s->steps[s->count - 1].first_stays = next >= 0;
        }
        if ( next < 0 )
        {
            return;
        }
        a = s->steps[s->count - 1].first_stays ? a : b;
        b = c;
        const int32_t* v = s->f->triangles + 3 * (size_t)next;
        int k = 0;
        while ( v[k] == a || v[k] == b )
        {
            ++k;
        }
        s->tile[next] = -1;
        s->steps[s->count++] = ( strip_step ){ v[k], true, false };
    }
}

typedef struct strip_lanes
{
    int32_t ( *next_x4 )[WISP_FABRIC_LANES], ( *leaving_x4 )[WISP_FABRIC_LANES];
    uint16_t* flags;
} strip_lanes;

enum
{
    EXTRA = 2, // steps to take a strip up, or to let its last vertices leave
};

// Returns the steps of each lane for a number of them in a row.
static int32_t lane_length( int32_t count )
{
    return fabric_padded( count + EXTRA * ( WISP_FABRIC_LANES - 1 ) ) / WISP_FABRIC_LANES + EXTRA;
}

// Cut the steps of a tile into lanes of equal length, which take up an interrupted strip with its two vertices.
// @param pad slot of a dummy
static void put_in_lanes( const strip_step* steps, int32_t count, int32_t pad, strip_lanes out )
{
    const int32_t length = lane_length( count );
    int32_t done = 0, cut[EXTRA] = { pad, pad };
    memset( out.flags, 0, (size_t)length * sizeof( uint16_t ) );
    for ( int lane = 0; lane < WISP_FABRIC_LANES; ++lane )
    {
        const int32_t first[EXTRA] = { cut[0], cut[1] };
        int32_t pair[2] = { pad, pad };
        for ( int32_t i = 0; i < length; ++i )
        {
            strip_step step = { pad, false, false };
            if ( lane > 0 && i < EXTRA )
            {
                step.slot = first[i];
            }
            else if ( done < count && i < length - EXTRA )
            {
                step = steps[done++];
            }
            out.next_x4[i][lane] = 4 * step.slot;
            out.leaving_x4[i][lane] = 4 * pair[step.first_stays];
            out.flags[i] = (uint16_t)( out.flags[i] | step.is_triangle << lane | step.first_stays << ( 8 + lane ) );
            pair[0] = pair[!step.first_stays];
            pair[1] = step.slot;
            if ( i < length - EXTRA )
            {
                memcpy( cut, pair, sizeof( cut ) );
            }
        }
    }
}

static bool begin_strips( const wisp_fabric* f, const wisp_schedule* order, fabric_pool* scratch, strip_state* s )
{
    fabric_mesh mesh = { .vertex_count = f->vertex_count, .triangle_count = f->triangle_count };
    if ( fabric_mesh_list_corners( f, scratch, &mesh ) == false )
    {
        return false;
    }
    *s = ( strip_state ){ .f = f,
                          .corner_begin = mesh.corner_begin,
                          .corner = (int32_t*)(uintptr_t)mesh.corner,
                          .corner_count = fabric_pool_push( scratch, (size_t)f->vertex_count, sizeof( int32_t ) ),
                          .tile = fabric_pool_push( scratch, (size_t)f->triangle_count, sizeof( int32_t ) ),
                          .steps = fabric_pool_push( scratch, 3 * (size_t)f->triangle_count, sizeof( strip_step ) ),
                          .end = fabric_pool_push( scratch, (size_t)order->tile_count + 1, sizeof( int32_t ) ) };
    if ( s->corner_count == NULL || s->tile == NULL || s->steps == NULL || s->end == NULL )
    {
        return false;
    }
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        s->corner_count[v] = mesh.corner_begin[v + 1] - mesh.corner_begin[v];
    }
    for ( int32_t i = 0, tile = 0; i < order->slot_count; ++i )
    {
        tile += i == order->tile_begin[tile + 1] ? 1 : 0;
        if ( order->constraint[i] >= 0 )
        {
            s->tile[order->constraint[i]] = tile;
        }
    }
    return true;
}

// Walk all triangles, tile by tile. @return steps of the lanes
static int32_t walk_tiles( strip_state* s, const wisp_schedule* order )
{
    int32_t length = 0;
    for ( s->at = 0; s->at < order->tile_count; ++s->at )
    {
        const int32_t first = s->count;
        for ( int32_t i = order->tile_begin[s->at]; i < order->tile_begin[s->at + 1]; ++i )
        {
            const int32_t t = order->constraint[i];
            if ( t >= 0 && s->tile[t] == s->at )
            {
                walk_strip( s, t );
            }
        }
        s->end[s->at] = s->count;
        length += lane_length( s->count - first );
    }
    return length;
}

bool fabric_strips_build( const wisp_fabric* f, fabric_pool* keep, wisp_strips* out )
{
    fabric_pool scratch = { .allocator = keep->allocator };
    const fabric_constraints triangles = fabric_triangle_constraints( f );
    wisp_schedule order = { 0 };
    strip_state s;
    bool done =
        fabric_schedule_build( &triangles, &scratch, &scratch, &order ) && begin_strips( f, &order, &scratch, &s );
    const int32_t length = done ? walk_tiles( &s, &order ) : 0;
    int32_t* tile_begin = fabric_pool_push( keep, (size_t)order.tile_count + 1, sizeof( int32_t ) );
    int32_t* colour_tile = fabric_pool_push( keep, (size_t)order.colour_count + 1, sizeof( int32_t ) );
    strip_lanes lanes = { .next_x4 = fabric_pool_push( keep, (size_t)length, sizeof( *lanes.next_x4 ) ),
                          .leaving_x4 = fabric_pool_push( keep, (size_t)length, sizeof( *lanes.leaving_x4 ) ),
                          .flags = fabric_pool_push( keep, (size_t)length, sizeof( uint16_t ) ) };
    done = done && tile_begin != NULL && colour_tile != NULL && lanes.next_x4 != NULL && lanes.leaving_x4 != NULL &&
           lanes.flags != NULL;
    if ( done )
    {
        memcpy( colour_tile, order.colour_tile, ( (size_t)order.colour_count + 1 ) * sizeof( int32_t ) );
        tile_begin[0] = 0;
        for ( int tile = 0, first = 0; tile < order.tile_count; first = s.end[tile++] )
        {
            const int32_t at = tile_begin[tile], count = s.end[tile] - first;
            put_in_lanes( s.steps + first, count, dummy4( &order, &triangles, tile ) / 4,
                          ( strip_lanes ){ lanes.next_x4 + at, lanes.leaving_x4 + at, lanes.flags + at } );
            tile_begin[tile + 1] = at + lane_length( count );
        }
        order.slot_count = length, order.constraint = NULL;
        order.tile_begin = tile_begin, order.colour_tile = colour_tile;
        *out = ( wisp_strips ){ order, (const int32_t( * )[WISP_FABRIC_LANES])lanes.next_x4,
                                (const int32_t( * )[WISP_FABRIC_LANES])lanes.leaving_x4, lanes.flags };
    }
    fabric_pool_release( &scratch );
    return done;
}
