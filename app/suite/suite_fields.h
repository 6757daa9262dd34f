/// Fields of a scene by path: `substeps`, `surfaces[0].cloth.bending`, `surfaces[sheet].damping`, `strands[*].damping`.
#pragma once

#include "text_tree.h"

/// Give every field that the path names a copy of a value. Blocks on the way that are absent are added, entries of lists are not. The
/// value `null` removes a field.
/// @return how many fields were set; 0: the path names nothing of the scene
int suite_set_field( text_node* scene, const char* path, const text_node* value );
