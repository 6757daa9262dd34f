/// Status and errors, hooks for memory, log and asserts, vectors. C17, usable from C++.
///
///     wisp_error error = { 0 };
///     if ( wisp_fabric_cook( &def, NULL, &fabric, &error ) != WISP_OK )
///         fprintf( stderr, "%s: %s\n", wisp_status_name( error.status ), error.message );
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define WISP_VERSION_MAJOR 0
#define WISP_VERSION_MINOR 15
#define WISP_VERSION_PATCH 0
#define WISP_VERSION_STRING "0.15.0"

#if defined( _WIN32 )
#define WISP_API __declspec( dllexport )
#else
#define WISP_API __attribute__( ( visibility( "default" ) ) )
#endif

#ifdef __cplusplus
#define WISP_BEGIN_C                                                                                                 \
    extern "C"                                                                                                       \
    {
#define WISP_END_C }
#else
#define WISP_BEGIN_C
#define WISP_END_C
#endif

WISP_BEGIN_C

/// What a call returns. Wrong data is a status other than WISP_OK, with a message that names the element.
typedef enum wisp_status
{
    WISP_OK = 0,
    WISP_NO_MEMORY, ///< the host's allocator returned null; the call changed nothing
    WISP_BAD_INPUT, ///< a value, file or scene is wrong; the message names file, line or element
    WISP_STALE_ID,  ///< the entity was removed, or never existed
    WISP_CONFLICT,  ///< the call does not fit the state of the world (no such component, plan that cannot be met)
    WISP_IO_ERROR,  ///< the operating system refused to open, read or write a file
} wisp_status;

/// Name a status for logs: "ok", "out of memory", "bad input" ...
/// @return a static string, never null
WISP_API const char* wisp_status_name( wisp_status status );

/// A status with its message. Zero-initialised means no error yet.
typedef struct wisp_error
{
    wisp_status status;
    char message[500]; ///< one line, zero-terminated, without a newline; truncated if longer
} wisp_error;

/// Fill an error and return its status, so that a failing function ends in one line.
/// @param error may be null: then only the status is returned
/// @return status
WISP_API wisp_status wisp_fail( wisp_error* error, wisp_status status, const char* format, ... )
    __attribute__( ( format( printf, 3, 4 ) ) );

/// The host's memory. Both functions or neither; a zero-initialised struct means the C library's aligned_alloc and free.
/// Called from the thread that calls the engine, and from workers when a buffer must grow: must be thread-safe.
typedef struct wisp_allocator
{
    void* ( *allocate )( void* user, size_t size,
                         size_t alignment );                   ///< bytes; alignment a power of two; null on failure
    void ( *release )( void* user, void* block, size_t size ); ///< block may be null; size as it was allocated
    void* user;
} wisp_allocator;

/// A buffer that keeps its memory between uses. Zero-initialised means empty.
typedef struct wisp_buffer
{
    void* data;  ///< null while empty
    size_t size; ///< bytes that may be used
} wisp_buffer;

typedef enum wisp_log_level
{
    WISP_LOG_INFO,
    WISP_LOG_WARNING,
    WISP_LOG_ERROR,
} wisp_log_level;

/// Receives one message without a newline. Called on the thread that called the engine.
typedef void wisp_log_fn( void* user, wisp_log_level level, const char* message );

/// Handles a failed assert, that is, wrong code. @return true to abort, false to continue
typedef bool wisp_assert_fn( const char* condition, const char* file, int line );

/// Replace the process-wide assert handler; null restores the default (print to stderr, abort). Thread-safe.
WISP_API void wisp_set_assert_handler( wisp_assert_fn* handler );

/// Called by WISP_ASSERT; not for direct use.
WISP_API void wisp_assert_failed( const char* condition, const char* file, int line );

#if defined( WISP_NO_ASSERT )
#define WISP_ASSERT( condition ) ( (void)sizeof( condition ) )
#else
#define WISP_ASSERT( condition ) ( ( condition ) ? (void)0 : wisp_assert_failed( #condition, __FILE__, __LINE__ ) )
#endif

#define WISP_COUNT( array ) ( (int)( sizeof( array ) / sizeof( ( array )[0] ) ) )

/// Three floats, packed, no padding.
typedef struct wisp_vec3
{
    float x, y, z;
} wisp_vec3;

/// A handle by value. Zero is null. The generation distinguishes a reused slot from the entity that it held before.
typedef struct wisp_entity
{
    uint32_t index;      ///< slot + 1, 0 is null
    uint32_t generation; ///< how often the slot was reused
} wisp_entity;

static inline bool wisp_entity_equal( wisp_entity a, wisp_entity b )
{
    return a.index == b.index && a.generation == b.generation;
}

/// @return seconds on a monotonic clock with nanosecond resolution; only differences have a meaning
WISP_API double wisp_clock_seconds( void );

WISP_END_C
