/// Recurrences along strands wait for every row before them. Where sixteen lanes are one register, two groups are taken in
/// turns, so that one has something to do while the other waits; where they are several, these do not wait for each other anyway.
#pragma once

#include "kernel_isa.h"

#define CHAINS ( LANE16_REGISTERS == 1 ? 2 : 1 )

/// How many groups from `g` on may be taken in turns: CHAINS if all have as many rows, else one.
static inline int strand_groups_alike( const int32_t* group_row, int g, int end )
{
    if ( CHAINS > 1 && g + CHAINS <= end && group_row[g + 2] - group_row[g + 1] == group_row[g + 1] - group_row[g] )
    {
        return CHAINS;
    }
    return 1;
}
