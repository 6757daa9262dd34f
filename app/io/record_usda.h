/// Private to the writer of .usda.
#pragma once

#include "record_internal.h"

typedef struct usda_file
{
    io_output output;
    record_waiting* waiting;
    wisp_vec3* points[2]; ///< [largest vertex_count] of two frames
    float* numbers;       ///< [largest vertex_count]
    int32_t* triangles;   ///< [largest triangle_count of those that change][3] of the frame before
} usda_file;

/// The name of a prim: USD allows neither a dash nor a leading digit. @param out room for two more letters
void usda_name( const char* name, char* out );
/// Time code of a frame that waits.
double usda_code( const wisp_recorder* recorder, int frame );
/// Write the prim of a body with all its samples.
wisp_status usda_write_body( const wisp_recorder* recorder, int body, wisp_error* error );
