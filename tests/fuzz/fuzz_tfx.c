// Any bytes as a .tfx file: rejected with a message, or read, checked, described, written and read back.
#include "fuzz_groom.h"

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size )
{
    wisp_groom groom;
    wisp_error error = { .status = WISP_OK };
    wisp_status status = wisp_groom_read_tfx( data, size, "fuzz.tfx", &groom, &error );
    fuzz_use( status, &error, &groom );
    return 0;
}
