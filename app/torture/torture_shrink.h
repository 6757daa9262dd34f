/// Makes a scene smaller while something stays true of it, such as that it breaks the same judge.
#pragma once

#include "text_tree.h"

/// @return whether the smaller scene still shows what is looked for
typedef bool torture_shows_fn( void* user, const text_node* scene );

typedef struct torture_shrink_def
{
    torture_shows_fn* shows;
    void* user;
    int max_tries;      ///< runs
    double max_seconds; ///< of wall time
} torture_shrink_def;

/// Take entries, keys and items out, lower counts, and round numbers to one or two digits, over and over, until
/// nothing smaller shows it or a limit is reached. @param scene shows it, and is changed @return tries that were made
int torture_shrink( const torture_shrink_def* def, text_node* scene );
