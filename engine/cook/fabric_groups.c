// Groups of eight constraints: by colour, in mesh order, and those at attachments last.
#include "fabric_schedule.h"

#include <string.h>

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
