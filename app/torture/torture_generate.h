/// Random scenes over everything that a scene can say. Scene number i of a seed is the same text on every machine.
#pragma once

#include "torture_keys.h"

typedef struct torture_generator
{
    uint64_t seed;
    const char* const* meshes; ///< [mesh_count] files that surfaces and colliders may be made of
    int mesh_count;
} torture_generator;

/// Make a scene. @return to be released
text_node* torture_generate( const torture_generator* generator, int number );
