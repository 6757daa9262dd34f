#include "fabric.h"

#include "alloc.h"

#include <string.h>

// Colours per vertex in a bit mask; also the number of open groups of a list schedule.
#define WORD_COLOURS 64
#define OPEN_GROUPS 64

// Maximum number of constraints of later colours that are tried to fill a colour's last group.
#define FILL_LOOKS 64

_Static_assert( WISP_FABRIC_LANES == 8, "a slot of a schedule knows its group by a shift of three" );

// State of a schedule under construction. Constraints are identified by their sorted index until they are emitted.
typedef struct schedule_state
{
    const fabric_constraints* in;
    fabric_pool scratch;
    int32_t* order;  // [count] constraint at each sorted index
    int32_t* slots;  // [count][arity] sorted, so that slots of a tile are contiguous
    uint64_t* taken; // [vertex_count] mask of colours, or of open groups, that contain the vertex
    int32_t* later;  // [vertex_count] next colour beyond those of the mask
    int32_t* stamp;  // [vertex_count] last group that was filled around the vertex
    int32_t stamps;
    int32_t* colour;                // [maximum constraints per tile]
    int32_t* member;                // [maximum constraints per tile] sorted indices by colour, -1 once emitted
    int32_t* begin;                 // [maximum constraints per tile + WORD_COLOURS + 2] first member of each colour
    wisp_buffer emitted;            // constraints, -1 for padding
    wisp_buffer attached;           // groups of a tile that are postponed to its end
    int slot_count;                 // number of emitted slots
    int32_t *tile_end, *colour_end; // ends of tiles in slots, ends of colours in tiles
    int tile_count, colour_count;   // finished ones
    int colours;                    // number of colours of tiles, including skipped ones
} schedule_state;

static const int32_t* slots_of( const schedule_state* s, int place )
{
    return s->slots + (size_t)place * (size_t)s->in->arity;
}

// ---- sorting ----

static int32_t extreme( const fabric_constraints* in, int32_t constraint, bool largest )
{
    const int32_t* slots = in->slots + (size_t)constraint * (size_t)in->arity;
    int32_t found = slots[0];
    for ( int k = 1; k < in->arity; ++k )
    {
        found = ( largest ? slots[k] > found : slots[k] < found ) ? slots[k] : found;
    }
    return found;
}

// Sorts by the largest or the smallest slot with a stable counting sort. A null `from` means by index.
static void sort_by( const fabric_constraints* in, bool largest, const int32_t* from, int32_t* to, int32_t* place )
{
    memset( place, 0, ( (size_t)in->vertex_count + 1 ) * sizeof( int32_t ) );
    for ( int32_t c = 0; c < in->count; ++c )
    {
        place[extreme( in, c, largest ) + 1] += 1;
    }
    for ( int v = 0; v < in->vertex_count; ++v )
    {
        place[v + 1] += place[v];
    }
    for ( int32_t i = 0; i < in->count; ++i )
    {
        int32_t c = from != NULL ? from[i] : i;
        to[place[extreme( in, c, largest )]++] = c;
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

// ---- colouring ----

// Assigns the lowest colour that none of the slots has. Beyond the colours of the mask, a vertex stores only its
// last colour. This wastes colours, but a vertex with a million edges then needs only a million steps.
static int32_t give_colour( schedule_state* s, const int32_t* slots, size_t count )
{
    uint64_t taken = 0;
    for ( size_t k = 0; k < count; ++k )
    {
        taken |= s->taken[slots[k]];
    }
    if ( ~taken != 0 )
    {
        uint64_t lowest = ~taken & ( taken + 1 );
        for ( size_t k = 0; k < count; ++k )
        {
            s->taken[slots[k]] |= lowest;
        }
        return __builtin_ctzll( lowest );
    }
    int32_t colour = 0;
    for ( size_t k = 0; k < count; ++k )
    {
        colour = s->later[slots[k]] > colour ? s->later[slots[k]] : colour;
    }
    for ( size_t k = 0; k < count; ++k )
    {
        s->later[slots[k]] = colour + 1;
    }
    return WORD_COLOURS + colour;
}

static void forget_colours( schedule_state* s, const int32_t* slots, size_t count )
{
    for ( size_t k = 0; k < count; ++k )
    {
        s->taken[slots[k]] = 0;
        s->later[slots[k]] = 0;
    }
}

// Sorts n items by colour, ties by index.
// @param begin [colours + 1] output
// @return number of colours
static int sort_by_colour( const int32_t* colour, int n, int32_t* begin, int32_t* sorted )
{
    int colours = 0;
    for ( int i = 0; i < n; ++i )
    {
        colours = colour[i] >= colours ? colour[i] + 1 : colours;
    }
    memset( begin, 0, ( (size_t)colours + 2 ) * sizeof( int32_t ) );
    for ( int i = 0; i < n; ++i )
    {
        begin[colour[i] + 2] += 1;
    }
    for ( int c = 0; c < colours; ++c )
    {
        begin[c + 2] += begin[c + 1];
    }
    for ( int i = 0; i < n; ++i )
    {
        sorted[begin[colour[i] + 1]++] = i;
    }
    return colours;
}

// ---- groups ----

static bool emit_group( schedule_state* s, const int32_t* places, int count )
{
    size_t used = (size_t)s->slot_count * sizeof( int32_t );
    if ( s->slot_count > INT32_MAX - WISP_FABRIC_LANES ||
         base_buffer_reserve( s->scratch.allocator, &s->emitted, used + WISP_FABRIC_LANES * sizeof( int32_t ) ) ==
             false )
    {
        return false;
    }
    int32_t* to = (int32_t*)s->emitted.data + s->slot_count;
    for ( int lane = 0; lane < WISP_FABRIC_LANES; ++lane )
    {
        to[lane] = lane < count ? s->order[places[lane]] : -1;
    }
    s->slot_count += WISP_FABRIC_LANES;
    return true;
}

static void close_tile( schedule_state* s )
{
    s->tile_end[s->tile_count++] = s->slot_count;
}

static void close_colour( schedule_state* s )
{
    s->colour_end[s->colour_count++] = s->tile_count;
}

static void stamp( schedule_state* s, int place )
{
    for ( int k = 0; k < s->in->arity; ++k )
    {
        s->stamp[slots_of( s, place )[k]] = s->stamps;
    }
}

static bool stamped( const schedule_state* s, int place )
{
    bool found = false;
    for ( int k = 0; k < s->in->arity; ++k )
    {
        found = found || s->stamp[slots_of( s, place )[k]] == s->stamps;
    }
    return found;
}

// Fills free lanes of a group with constraints of earlier colours. Those are the large colours, so the few edges
// that a high-degree vertex has in each of its many colours fill up. The remaining padding is that of the first
// colour.
// @param head, end range of the members of earlier colours
// @return number of members of the group
static int fill_group( schedule_state* s, int head, int end, int32_t* group, int count )
{
    int last = end - head > FILL_LOOKS ? head + FILL_LOOKS : end;
    for ( int i = head; i < last && count < WISP_FABRIC_LANES; ++i )
    {
        int32_t place = s->member[i];
        if ( place >= 0 && stamped( s, place ) == false )
        {
            stamp( s, place );
            group[count++] = place;
            s->member[i] = -1;
        }
    }
    return count;
}

// Emits the remaining members of one colour.
// @param head first member of any colour that is not emitted yet
static bool emit_colour( schedule_state* s, int colour, int* head )
{
    int32_t group[WISP_FABRIC_LANES];
    int count = 0;
    bool done = true;

    // without tiles no two constraints of a colour share a vertex; with tiles this holds only within a group
    bool whole_colour = s->in->tile_size == 0;
    s->stamps += 1;
    for ( int i = s->begin[colour]; i < s->begin[colour + 1] && done; ++i )
    {
        int32_t place = s->member[i];
        if ( place >= 0 )
        {
            group[count++] = place;
            if ( whole_colour )
            {
                stamp( s, place );
            }
        }
        if ( count == WISP_FABRIC_LANES )
        {
            done = emit_group( s, group, count );
            count = 0;
        }
    }
    if ( count > 0 && done )
    {
        for ( int i = 0; i < count; ++i )
        {
            stamp( s, group[i] );
        }
        count = fill_group( s, *head, s->begin[colour], group, count );
        done = emit_group( s, group, count );
    }
    while ( *head < s->begin[colour] && s->member[*head] < 0 )
    {
        *head += 1;
    }
    return done;
}

// Emits constraints [first, last) by colour, last colour first. Without tiles each colour becomes a tile.
static bool emit_by_colour( schedule_state* s, int first, int last )
{
    size_t arity = (size_t)s->in->arity;
    int n = last - first;
    for ( int i = 0; i < n; ++i )
    {
        s->colour[i] = give_colour( s, slots_of( s, first + i ), arity );
    }
    forget_colours( s, slots_of( s, first ), (size_t)n * arity );
    int colours = sort_by_colour( s->colour, n, s->begin, s->member );
    for ( int i = 0; i < n; ++i )
    {
        s->member[i] += first;
    }
    int head = 0;
    for ( int c = colours - 1; c >= 0; --c )
    {
        int before = s->slot_count;
        if ( emit_colour( s, c, &head ) == false )
        {
            return false;
        }
        if ( s->in->tile_size == 0 && s->slot_count > before )
        {
            close_tile( s );
            close_colour( s );
        }
    }
    return true;
}

// ---- attachments ----

static bool touches_first_slots( const schedule_state* s, const int32_t* group )
{
    bool touches = false;
    for ( int lane = 0; lane < WISP_FABRIC_LANES; ++lane )
    {
        for ( int k = 0; k < s->in->arity && group[lane] >= 0; ++k )
        {
            touches =
                touches || s->in->slots[(size_t)group[lane] * (size_t)s->in->arity + (size_t)k] < s->in->last_slots;
        }
    }
    return touches;
}

// Moves groups at attachments to the end of their tile. A mesh hangs on its attachments, so stretch is largest
// there, and the constraints projected last are exact. A hanging sheet of 64 rows then stretches by at most 75 %
// instead of 93 % (10 substeps), with the same average.
static bool put_attached_last( schedule_state* s, int tile_begin )
{
    const size_t group_bytes = WISP_FABRIC_LANES * sizeof( int32_t );
    int count = ( s->slot_count - tile_begin ) / WISP_FABRIC_LANES, kept = 0, last = 0;
    if ( s->in->last_slots == 0 ||
         base_buffer_reserve( s->scratch.allocator, &s->attached, (size_t)count * group_bytes ) == false )
    {
        return s->in->last_slots == 0;
    }
    int32_t* groups = (int32_t*)s->emitted.data + tile_begin;
    int32_t* attached = s->attached.data;
    for ( int g = 0; g < count; ++g )
    {
        const int32_t* group = groups + (size_t)g * WISP_FABRIC_LANES;
        bool is_last = touches_first_slots( s, group );
        memmove( is_last ? attached + (size_t)last * WISP_FABRIC_LANES : groups + (size_t)kept * WISP_FABRIC_LANES,
                 group, group_bytes );
        last += is_last ? 1 : 0;
        kept += is_last ? 0 : 1;
    }
    if ( last > 0 )
    {
        memcpy( groups + (size_t)kept * WISP_FABRIC_LANES, attached, (size_t)last * group_bytes );
    }
    return true;
}

// ---- list scheduling ----

// Groups with free lanes. Bit i of a vertex's mask stands for the open group with index i modulo the window.
typedef struct open_groups
{
    int64_t oldest, next;
    uint64_t room; // mask of groups that are not full
    int count[OPEN_GROUPS];
    int32_t place[OPEN_GROUPS][WISP_FABRIC_LANES];
} open_groups;

static bool close_oldest( schedule_state* s, open_groups* open )
{
    int g = (int)( open->oldest % OPEN_GROUPS );
    for ( int i = 0; i < open->count[g]; ++i )
    {
        for ( int k = 0; k < s->in->arity; ++k )
        {
            s->taken[slots_of( s, open->place[g][i] )[k]] &= ~( (uint64_t)1 << g );
        }
    }
    open->room &= ~( (uint64_t)1 << g );
    open->oldest += 1;
    return emit_group( s, open->place[g], open->count[g] );
}

// Returns the oldest open group with a free lane that contains none of the slots, or -1.
static int find_group( const schedule_state* s, const open_groups* open, const int32_t* slots )
{
    uint64_t taken = 0;
    for ( int k = 0; k < s->in->arity; ++k )
    {
        taken |= s->taken[slots[k]];
    }
    uint64_t fit = open->room & ~taken;
    if ( fit == 0 )
    {
        return -1;
    }
    int turn = (int)( open->oldest % OPEN_GROUPS );
    uint64_t turned = turn == 0 ? fit : fit >> turn | fit << ( OPEN_GROUPS - turn );
    return ( __builtin_ctzll( turned ) + turn ) % OPEN_GROUPS;
}

// Schedules constraints [first, last) in mesh order: each goes into the oldest open group that it fits. The window
// of open groups preserves the sweep order: a constraint stays close to its neighbours.
static bool emit_by_list( schedule_state* s, int first, int last )
{
    open_groups open = { 0 };
    bool done = true;
    for ( int place = first; place < last && done; ++place )
    {
        const int32_t* slots = slots_of( s, place );
        int g = find_group( s, &open, slots );
        if ( g < 0 )
        {
            done = open.next - open.oldest < OPEN_GROUPS || close_oldest( s, &open );
            g = (int)( open.next % OPEN_GROUPS );
            open.next += 1;
            open.count[g] = 0;
            open.room |= (uint64_t)1 << g;
        }
        for ( int k = 0; k < s->in->arity; ++k )
        {
            s->taken[slots[k]] |= (uint64_t)1 << g;
        }
        open.place[g][open.count[g]++] = place;
        if ( open.count[g] == WISP_FABRIC_LANES )
        {
            open.room &= ~( (uint64_t)1 << g );
        }
        while ( done && open.oldest < open.next && open.count[open.oldest % OPEN_GROUPS] == WISP_FABRIC_LANES )
        {
            done = close_oldest( s, &open );
        }
    }
    while ( done && open.oldest < open.next )
    {
        done = close_oldest( s, &open );
    }
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
        int tile = extreme( s->in, s->order[i], false ) / s->in->tile_size;
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
        colour[t] = give_colour( s, slots_of( s, first[t] ), (size_t)( first[t + 1] - first[t] ) * arity );
    }
    forget_colours( s, s->slots, (size_t)s->in->count * arity );
    s->colours = sort_by_colour( colour, tiles, begin, sorted );
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
                            ? emit_by_list( s, first[t], first[t + 1] )
                            : emit_by_colour( s, first[t], first[t + 1] ) && put_attached_last( s, tile_begin );
            if ( done == false )
            {
                return false;
            }
            close_tile( s );
        }

        // beyond the colours of the mask, colours may be skipped
        if ( begin[c + 1] > begin[c] )
        {
            close_colour( s );
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
        done = reserve( &s, constraints->count, constraints->count ) && emit_by_colour( &s, 0, constraints->count );
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
    int32_t slots_tile = in->tile_size > 0 ? extreme( in, first, false ) / in->tile_size : 0;
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

bool fabric_schedule_hinges( const wisp_schedule* schedule, const fabric_constraints* constraints, fabric_pool* keep,
                             const int32_t** out )
{
    int32_t* slot_x4 = fabric_pool_push( keep, 4 * (size_t)schedule->slot_count, sizeof( int32_t ) );
    for ( int tile = 0; tile < schedule->tile_count && slot_x4 != NULL; ++tile )
    {
        int32_t pad = dummy4( schedule, constraints, tile );
        for ( int32_t i = schedule->tile_begin[tile]; i < schedule->tile_begin[tile + 1]; ++i )
        {
            int32_t c = schedule->constraint[i];
            int32_t* lane = slot_x4 + 4 * (size_t)( i - i % WISP_FABRIC_LANES ) + i % WISP_FABRIC_LANES;
            for ( int k = 0; k < 4; ++k )
            {
                lane[k * WISP_FABRIC_LANES] = c >= 0 ? 4 * constraints->slots[4 * (size_t)c + (size_t)k] : pad;
            }
        }
    }
    *out = slot_x4;
    return slot_x4 != NULL;
}
