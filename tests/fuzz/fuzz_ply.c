// Any bytes as a .ply mesh.
#define FUZZ_READ wisp_mesh_read_ply
#include "fuzz_mesh.h"
