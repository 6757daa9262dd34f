// Any bytes as an .obj mesh.
#define FUZZ_READ wisp_mesh_read_obj
#include "fuzz_mesh.h"
