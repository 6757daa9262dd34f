/// For modules: definitions that know their size, so that a library reads those of hosts that were compiled with an older one.
///
///     void wisp_init_cloth_def( wisp_cloth_def* def, size_t size )
///     {
///         const wisp_cloth_def values = { .stretch_stiffness = 1.0f };     // of the current version
///         wisp_def_init( def, size, &values, sizeof( values ) );
///     }
///
///     wisp_cloth_def values = wisp_default_cloth_def();
///     WISP_TRY( wisp_def_read( &values, given, "wisp_default_cloth_def", error ) );
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

/// Return the status of a call from the function around it, unless it is WISP_OK.
#define WISP_TRY( call )                                                                                             \
    do                                                                                                               \
    {                                                                                                                \
        const wisp_status tried_status = ( call );                                                                   \
        if ( tried_status != WISP_OK )                                                                               \
        {                                                                                                            \
            return tried_status;                                                                                     \
        }                                                                                                            \
    } while ( 0 )

/// Write defaults to a definition of a host, which may be shorter than that of the library.
/// @param def begins with a uint32_t, which receives `size`; null does nothing
/// @param size bytes of `def`
/// @param values [value_size] defaults of the library's own version
WISP_API void wisp_def_init( void* def, size_t size, const void* values, size_t value_size );

/// Read a definition of a host. Members that it does not have keep their defaults.
/// @param values in: defaults, with their size first. Out: what the host gave
/// @param given of the host @param filled_by name of the function that fills it, for the message
/// @return WISP_BAD_INPUT it is null, was not filled by that function, or is of a newer version
WISP_API wisp_status wisp_def_read( void* values, const void* given, const char* filled_by, wisp_error* error );

WISP_END_C
