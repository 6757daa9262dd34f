#include "fabric.h"

#include "alloc.h"
#include "fabric_schedule.h"

#include <string.h>

// ---- colours ----

// Colours of constraints and tiles.

int32_t schedule_give_colour( schedule_state* s, const int32_t* slots, size_t count )
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

void schedule_forget_colours( schedule_state* s, const int32_t* slots, size_t count )
{
    for ( size_t k = 0; k < count; ++k )
    {
        s->taken[slots[k]] = 0;
        s->later[slots[k]] = 0;
    }
}

int schedule_sort_by_colour( const int32_t* colour, int n, int32_t* begin, int32_t* sorted )
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

// Groups of eight constraints: by colour, in mesh order, and those at attachments last.

// Maximum number of constraints of later colours that are tried to fill a colour's last group.
#define FILL_LOOKS 64

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

void schedule_close_tile( schedule_state* s )
{
    s->tile_end[s->tile_count++] = s->slot_count;
}

void schedule_close_colour( schedule_state* s )
{
    s->colour_end[s->colour_count++] = s->tile_count;
}

static void stamp( schedule_state* s, int place )
{
    for ( int k = 0; k < s->in->arity; ++k )
    {
        s->stamp[schedule_slots_of( s, place )[k]] = s->stamps;
    }
}

static bool stamped( const schedule_state* s, int place )
{
    bool found = false;
    for ( int k = 0; k < s->in->arity; ++k )
    {
        found = found || s->stamp[schedule_slots_of( s, place )[k]] == s->stamps;
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

bool schedule_emit_by_colour( schedule_state* s, int first, int last )
{
    size_t arity = (size_t)s->in->arity;
    int n = last - first;
    for ( int i = 0; i < n; ++i )
    {
        s->colour[i] = schedule_give_colour( s, schedule_slots_of( s, first + i ), arity );
    }
    schedule_forget_colours( s, schedule_slots_of( s, first ), (size_t)n * arity );
    int colours = schedule_sort_by_colour( s->colour, n, s->begin, s->member );
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
            schedule_close_tile( s );
            schedule_close_colour( s );
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

bool schedule_put_attached_last( schedule_state* s, int tile_begin )
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
            s->taken[schedule_slots_of( s, open->place[g][i] )[k]] &= ~( (uint64_t)1 << g );
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

bool schedule_emit_by_list( schedule_state* s, int first, int last )
{
    open_groups open = { 0 };
    bool done = true;
    for ( int place = first; place < last && done; ++place )
    {
        const int32_t* slots = schedule_slots_of( s, place );
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

// ---- order ----

// Maximum number of breadth-first searches for a far vertex, converged or not: each is a pass over the component.
#define MAX_SEARCHES 8

// Data shared by the steps of ordering.
typedef struct sweep_state
{
    fabric_graph graph; // lists by degree, then number
    int32_t* component; // [count] numbered by smallest vertex
    int32_t* mark;      // [count] last search that visited the vertex
    int search;         // number of the last search
    bool* placed;       // [count]
    int32_t* order;     // [count] vertices in order; space after the placed ones is used by searches
    int placed_count;
    int component_count;
} sweep_state;

static int degree( const fabric_graph* graph, int32_t v )
{
    return graph->begin[v + 1] - graph->begin[v];
}

// Sorts vertices by increasing degree, ties by index, with a counting sort.
static bool sort_by_degree( fabric_pool* scratch, const fabric_graph* graph, int32_t* sorted )
{
    int most = 0;
    for ( int v = 0; v < graph->count; ++v )
    {
        most = degree( graph, v ) > most ? degree( graph, v ) : most;
    }
    int32_t* place = fabric_pool_push_zeroed( scratch, (size_t)most + 2, sizeof( int32_t ) );
    if ( place == NULL )
    {
        return false;
    }
    for ( int v = 0; v < graph->count; ++v )
    {
        place[degree( graph, v ) + 1] += 1;
    }
    for ( int d = 0; d < most; ++d )
    {
        place[d + 1] += place[d];
    }
    for ( int v = 0; v < graph->count; ++v )
    {
        sorted[place[degree( graph, v )]++] = v;
    }
    return true;
}

// Lists all vertices reachable from a vertex after the placed ones, nearest first.
// @param depth output, number of rings
// @param last_ring output, begin of the last one
// @return end of the list
static int search( sweep_state* s, int32_t from, int* depth, int* last_ring )
{
    int head = s->placed_count, end = s->placed_count, ring_end = head;
    s->search += 1;
    s->mark[from] = s->search;
    s->order[end++] = from;
    *depth = 0;
    *last_ring = head;
    while ( head < end )
    {
        if ( head == ring_end )
        {
            *depth += 1;
            *last_ring = head;
            ring_end = end;
        }
        int32_t v = s->order[head++];
        for ( int32_t e = s->graph.begin[v]; e < s->graph.begin[v + 1]; ++e )
        {
            int32_t u = s->graph.neighbour[e];
            if ( s->mark[u] != s->search )
            {
                s->mark[u] = s->search;
                s->order[end++] = u;
            }
        }
    }
    return end;
}

static void label_components( sweep_state* s )
{
    for ( int v = 0; v < s->graph.count; ++v )
    {
        if ( s->mark[v] == 0 )
        {
            int depth, last_ring;

            // one search number for all, so that each vertex is visited once
            s->search = 0;
            int end = search( s, v, &depth, &last_ring );
            for ( int i = s->placed_count; i < end; ++i )
            {
                s->component[s->order[i]] = s->component_count;
            }
            s->component_count += 1;
        }
    }
}

// Finds a vertex at the far end of its component (George and Liu 1979): moves to the vertex of lowest degree in the
// farthest ring while its distance increases. An order that starts there has thin rings.
static int32_t find_far_end( sweep_state* s, int32_t from )
{
    int deepest = 0;
    int32_t candidate = from;
    for ( int i = 0; i < MAX_SEARCHES; ++i )
    {
        int depth, last_ring;
        int end = search( s, candidate, &depth, &last_ring );
        if ( depth <= deepest )
        {
            break;
        }
        deepest = depth;
        from = candidate;
        candidate = s->order[last_ring];
        for ( int k = last_ring; k < end; ++k )
        {
            int32_t v = s->order[k];
            int fewer = degree( &s->graph, v ) - degree( &s->graph, candidate );
            candidate = fewer < 0 || ( fewer == 0 && v < candidate ) ? v : candidate;
        }
    }
    return from;
}

static void place( sweep_state* s, int32_t v )
{
    if ( s->placed[v] == false )
    {
        s->placed[v] = true;
        s->order[s->placed_count++] = v;
    }
}

// Places vertices reachable from those placed since `head`.
static void sweep( sweep_state* s, int head )
{
    while ( head < s->placed_count )
    {
        int32_t v = s->order[head++];
        for ( int32_t e = s->graph.begin[v]; e < s->graph.begin[v + 1]; ++e )
        {
            place( s, s->graph.neighbour[e] );
        }
    }
}

// Places components with attachments, each from all of its attachments at once.
static bool place_attached( sweep_state* s, fabric_pool* scratch, const int32_t* attachments, int count )
{
    int32_t* begin = fabric_pool_push_zeroed( scratch, (size_t)s->component_count + 2, sizeof( int32_t ) );
    int32_t* list = fabric_pool_push( scratch, (size_t)count, sizeof( int32_t ) );
    if ( begin == NULL || list == NULL )
    {
        return false;
    }
    for ( int i = 0; i < count; ++i )
    {
        begin[s->component[attachments[i]] + 2] += 1;
    }
    for ( int c = 0; c < s->component_count; ++c )
    {
        begin[c + 2] += begin[c + 1];
    }
    for ( int i = 0; i < count; ++i )
    {
        list[begin[s->component[attachments[i]] + 1]++] = attachments[i];
    }
    for ( int i = 0; i < count; ++i )
    {
        int32_t v = attachments[i];
        int c = s->component[v], head = s->placed_count;
        if ( s->placed[v] == false && degree( &s->graph, v ) > 0 )
        {
            for ( int32_t k = begin[c]; k < begin[c + 1]; ++k )
            {
                place( s, list[k] );
            }
            sweep( s, head );
        }
    }
    return true;
}

static void place_others( sweep_state* s )
{
    for ( int v = 0; v < s->graph.count; ++v )
    {
        if ( s->placed[v] == false && degree( &s->graph, v ) > 0 )
        {
            int head = s->placed_count;
            place( s, find_far_end( s, v ) );
            sweep( s, head );
        }
    }
    for ( int v = 0; v < s->graph.count; ++v )
    {
        place( s, v );
    }
}

static bool order_in( fabric_pool* scratch, const fabric_graph* graph, const int32_t* attachments,
                      int attachment_count, int32_t* slot_vertex )
{
    size_t count = (size_t)graph->count;
    int32_t* by_degree = fabric_pool_push( scratch, count, sizeof( int32_t ) );
    int32_t* own_name = fabric_pool_push( scratch, count, sizeof( int32_t ) );
    sweep_state s = {
        .component = fabric_pool_push( scratch, count, sizeof( int32_t ) ),
        .mark = fabric_pool_push_zeroed( scratch, count, sizeof( int32_t ) ),
        .placed = fabric_pool_push_zeroed( scratch, count, sizeof( bool ) ),
        .order = slot_vertex,
    };
    if ( by_degree == NULL || own_name == NULL || s.component == NULL || s.mark == NULL || s.placed == NULL )
    {
        return false;
    }
    for ( int v = 0; v < graph->count; ++v )
    {
        own_name[v] = v;
    }
    if ( sort_by_degree( scratch, graph, by_degree ) == false ||
         fabric_graph_relist( scratch, graph, by_degree, own_name, &s.graph ) == false )
    {
        return false;
    }
    label_components( &s );
    if ( place_attached( &s, scratch, attachments, attachment_count ) == false )
    {
        return false;
    }
    place_others( &s );
    return true;
}

bool fabric_order_vertices( const wisp_allocator* allocator, const fabric_graph* graph, const int32_t* attachments,
                            int attachment_count, int32_t* vertex_slot, int32_t* slot_vertex )
{
    fabric_pool scratch = { .allocator = allocator };
    bool done = order_in( &scratch, graph, attachments, attachment_count, slot_vertex );
    for ( int s = 0; s < graph->count && done; ++s )
    {
        vertex_slot[slot_vertex[s]] = s;
    }
    fabric_pool_release( &scratch );
    return done;
}

int fabric_choose_tile_size( int vertex_count )
{
    // Few large tiles leave workers idle. Small tiles propagate corrections less far per pass: a hanging sheet of
    // 64 rows stretches by 1.21 % on average in tiles of 256, by 1.09 % in tiles of 1024.
    int size = 1024;
    while ( size > 256 && fabric_tiles( vertex_count, size ) < 4 )
    {
        size /= 2;
    }
    return size;
}
