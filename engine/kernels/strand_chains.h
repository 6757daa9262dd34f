/// A recurrence along a strand has to finish each row before the next. Where sixteen lanes fit one register, two
/// groups are interleaved so that their latencies overlap. Where they need several registers, these overlap by
/// themselves.
#pragma once

#include "kernel_isa.h"

#define CHAINS ( LANE16_REGISTERS == 1 ? 2 : 1 )

/// Return how many groups from `g` on can be interleaved: CHAINS if all have the same number of rows, otherwise
/// one.
static inline int strand_groups_alike( const int32_t* group_row, int g, int end )
{
    if ( CHAINS > 1 && g + CHAINS <= end && group_row[g + 2] - group_row[g + 1] == group_row[g + 1] - group_row[g] )
    {
        return CHAINS;
    }
    return 1;
}
