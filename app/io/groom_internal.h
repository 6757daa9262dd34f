/// Private to the groom files.
#pragma once

#include <string.h>

#include "groom.h"
#include "io_bytes.h"

enum
{
    GROOM_THICKNESS = 1,
    GROOM_TRANSPARENCY = 2,
    GROOM_COLOUR = 4,
};

/// Allocate the arrays, contents undefined.
/// @param columns GROOM_THICKNESS, GROOM_TRANSPARENCY and GROOM_COLOUR, or-ed
/// @return WISP_NO_MEMORY and an empty groom
wisp_status groom_allocate( wisp_groom* groom, int strand_count, int vertex_count, int columns, const char* name,
                            wisp_error* error );

/// Malformed or not finite: rejected by readers and writers. wisp_groom_check() is stricter.
wisp_status groom_check_finite( const wisp_groom* groom, const char* name, wisp_error* error );

/// The first defect of strands, of a groom or a recording; empty: there is none.
typedef struct groom_defect
{
    char text[100];
} groom_defect;

/// @param offsets [strand_count + 1]
groom_defect groom_check_offsets( const int32_t* offsets, int strand_count, int vertex_count );

/// 2 when every z is zero, else 3.
int groom_dimension_of( const wisp_groom* groom );
