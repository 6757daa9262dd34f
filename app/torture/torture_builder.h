/// What the files of the generator share: a scene in the making, pieces of it, and who makes its entities.
#pragma once

#include "torture_generate.h"

/// A scene in the making. The lists belong to no scene until the end.
typedef struct torture_builder
{
    torture_random random;
    const torture_generator* generator;
    text_node *surfaces, *strands, *colliders, *events, *hair_events;
    int steps;
    bool has_contact; ///< surfaces and strands may touch each other
    bool is_stack;    ///< flat cloths of other weights lie on the ground, one on the other
} torture_builder;

// ---- pieces ----

/// @return true with this probability
bool torture_chance( torture_builder* b, int percent );
/// The table of `surfaces`, `strands` or `colliders`. @param entry needed for colliders, else null
torture_block torture_entry_block( const char* list, const text_node* entry );
/// Give a map a block with random values. @return the block
text_node* torture_put_block( torture_builder* b, torture_block outer, text_node* map, const char* key, int percent );
text_node* torture_put_linear( torture_builder* b, text_node* map, const char* key, double lower, double upper );
text_node* torture_put_log( torture_builder* b, text_node* map, const char* key, double lower, double upper );
text_node* torture_put_vector( torture_builder* b, text_node* map, const char* key, const double lower[3],
                               const double upper[3] );
/// Move along random keyframes about a place for a second or two. A jump is a keyframe a thousandth of a second
/// later.
text_node* torture_put_keyframes( torture_builder* b, text_node* map, const char* key, const char* position,
                                  const char* rotation, const double centre[3] );
/// A mesh by a generator, or one of the files. @param is_closed without open edges
void torture_put_mesh( torture_builder* b, torture_block block, text_node* entry, bool is_closed );

// ---- entities ----

void torture_make_surface( torture_builder* b );
void torture_make_strands( torture_builder* b );
