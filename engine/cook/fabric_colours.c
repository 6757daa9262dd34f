// Colours of constraints and tiles.
#include "fabric_schedule.h"

#include <string.h>

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
