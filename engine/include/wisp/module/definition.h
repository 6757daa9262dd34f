/// For modules: definitions by table. One row says the name, default, range and unit of a member; defaults, checks, scenes and tests walk
/// the rows.
///
///     static const wisp_field FIELDS[] = {
///         WISP_NUMBER( wisp_cloth_def, stretch_stiffness, 1, 0, 1, NULL ),
///         WISP_SWITCH( wisp_cloth_def, tethers, false ),
///     };
///     WISP_DEFINE( cloth_def, "cloth", FIELDS )
///
///     wisp_cloth_def def;
///     WISP_TRY( wisp_world_begin_def( world, &cloth, &wisp_cloth_def_fields, &def, given ) ); // in its ranges from here on
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

#define WISP_FIELD( def, name, type, lower, upper, other, unit, ... )                                                \
    {                                                                                                                \
#name, type, offsetof( def, name ), { __VA_ARGS__ }, lower, upper, other, unit                               \
    }
#define WISP_NUMBER( def, name, initial, lower, upper, unit )                                                        \
    WISP_FIELD( def, name, WISP_FIELD_NUMBER, lower, upper, lower, unit, initial )
/// A number that is in its range or is `other`, its default.
#define WISP_NUMBER_OR( def, name, other, lower, upper, unit )                                                       \
    WISP_FIELD( def, name, WISP_FIELD_NUMBER, lower, upper, other, unit, other )
#define WISP_WHOLE( def, name, initial, lower, upper )                                                               \
    WISP_FIELD( def, name, WISP_FIELD_WHOLE, lower, upper, lower, NULL, initial )
#define WISP_WHOLE_OR( def, name, other, lower, upper )                                                              \
    WISP_FIELD( def, name, WISP_FIELD_WHOLE, lower, upper, other, NULL, other )
/// @param count of the enumerators
#define WISP_CHOICE( def, name, initial, count )                                                                     \
    WISP_FIELD( def, name, WISP_FIELD_CHOICE, 0, (count)-1, 0, NULL, initial )
#define WISP_SWITCH( def, name, initial ) WISP_FIELD( def, name, WISP_FIELD_SWITCH, 0, 1, 0, NULL, initial )
/// Bits, all of them by default or the lowest one.
#define WISP_BITS( def, name, initial ) WISP_FIELD( def, name, WISP_FIELD_BITS, 0, 0, 0, NULL, initial )
#define WISP_SEED( def, name, initial ) WISP_FIELD( def, name, WISP_FIELD_SEED, 0, 0, 0, NULL, initial )
/// @param ... the three numbers that it has by default
#define WISP_VECTOR( def, name, shortest, longest, unit, ... )                                                       \
    WISP_FIELD( def, name, WISP_FIELD_VECTOR, shortest, longest, shortest, unit, __VA_ARGS__ )
#define WISP_POINT( def, name, lower, upper, unit, ... )                                                             \
    WISP_FIELD( def, name, WISP_FIELD_POINT, lower, upper, lower, unit, __VA_ARGS__ )
#define WISP_POSE( def, name ) WISP_FIELD( def, name, WISP_FIELD_POSE, -1e6, 1e6, 0, "m", 0 )

/// Define what WISP_DEFINITION( name ) declares, by its rows.
#define WISP_DEFINE( name, subject, rows )                                                                           \
    const wisp_fields wisp_##name##_fields = { #name, subject, rows, WISP_COUNT( rows ), sizeof( wisp_##name ) };    \
    void wisp_init_##name( wisp_##name* def, size_t size )                                                           \
    {                                                                                                                \
        wisp_def_init( &wisp_##name##_fields, def, size );                                                           \
    }

/// Write defaults to a definition of a host, which may be shorter than that of the library. What has no row is zero.
/// @param def begins with a uint32_t, which receives `size`; null does nothing
/// @param size bytes of `def`
WISP_API void wisp_def_init( const wisp_fields* fields, void* def, size_t size );

/// Read a definition of a host. Members that it does not have keep their defaults.
/// @param def [fields->size] receives it
/// @return WISP_BAD_INPUT it is null, was not filled by its function, is of a newer version, or a value is out of its range
WISP_API wisp_status wisp_def_read( const wisp_fields* fields, void* def, const void* given, wisp_error* error );

WISP_END_C
