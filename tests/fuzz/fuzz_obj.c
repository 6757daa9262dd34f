// Any bytes as an .obj mesh: rejected with a message, or read, examined, repaired, described, written and read back.
#include "fuzz_mesh.h"

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size )
{
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    wisp_status status = wisp_mesh_read_obj( data, size, "fuzz.obj", &mesh, &error );
    fuzz_use( status, &error, &mesh );
    return 0;
}
