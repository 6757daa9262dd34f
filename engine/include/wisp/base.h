/// Version, status and errors, hooks for memory, threads, log and asserts, vectors. C17, usable from C++.
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

// Names that the shared library exports, and printf formats that the compiler checks: number of the format, of the first argument.
#if defined( __GNUC__ ) && !defined( _WIN32 )
#define WISP_API __attribute__( ( visibility( "default" ) ) )
#define WISP_PRINTF( text, first ) __attribute__( ( format( printf, text, first ) ) )
#else
#define WISP_API
#define WISP_PRINTF( text, first )
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

/// @return the version of the library that runs, such as "0.15.0". WISP_VERSION_STRING is that of the headers
WISP_API const char* wisp_version( void );

/// What a member of a definition is.
typedef enum wisp_field_type
{
    WISP_FIELD_NUMBER = 0, ///< float
    WISP_FIELD_DOUBLE = 1, ///< double
    WISP_FIELD_WHOLE = 2,  ///< int32_t
    WISP_FIELD_CHOICE = 3, ///< an enumeration of 0 .. `upper`
    WISP_FIELD_SWITCH = 4, ///< bool
    WISP_FIELD_BITS = 5,   ///< uint32_t, any
    WISP_FIELD_SEED = 6,   ///< uint64_t, any
    WISP_FIELD_VECTOR = 7, ///< wisp_vec3 whose length is in the range
    WISP_FIELD_POINT = 8,  ///< wisp_vec3, each coordinate of which is in the range
    WISP_FIELD_POSE = 9,   ///< wisp_transform within `upper` of the origin
} wisp_field_type;

/// A member of a definition: where it is, what it is by default, and what it may be.
typedef struct wisp_field
{
    const char* name;
    wisp_field_type type;
    size_t offset;       ///< bytes from the start of the definition
    double initial[3];   ///< the first alone but of vectors and points
    double lower, upper; ///< both belong to the range, as the type of the member rounds them
    double other;        ///< allowed besides the range, such as 0 for "by the mesh"; `lower` where nothing is
    const char* unit;    ///< symbol; null: none
} wisp_field;

/// The members of a definition that hold values. Pointers, their counts and entities are not among them.
typedef struct wisp_fields
{
    const char* definition; ///< such as "cloth_def"
    const char* subject;    ///< such as "cloth", which messages begin with
    const wisp_field* rows; ///< [count]
    int count;
    size_t size; ///< bytes of the definition
} wisp_fields;

/// Declare wisp_default_NAME(), which returns the defaults of the definition wisp_NAME, and wisp_init_NAME( def, size ), which writes
/// them, for languages that cannot include this header. Both store the size of the definition in its first member: a program
/// that was compiled with an older version of Wisp has a shorter one, and members that it does not know keep their defaults.
/// wisp_NAME_fields has the default, range and unit of each member.
#define WISP_DEFINITION( name )                                                                                      \
    WISP_API extern const wisp_fields wisp_##name##_fields;                                                          \
    WISP_API void wisp_init_##name( struct wisp_##name* def, size_t size );                                          \
    static inline wisp_##name wisp_default_##name( void )                                                            \
    {                                                                                                                \
        wisp_##name def;                                                                                             \
        wisp_init_##name( &def, sizeof( def ) );                                                                     \
        return def;                                                                                                  \
    }                                                                                                                \
    struct wisp_##name

/// What a call returns. Wrong data is a status other than WISP_OK, with a message that names the element.
typedef enum wisp_status
{
    WISP_OK = 0,
    WISP_NO_MEMORY = 1, ///< the host's allocator returned null; the call changed nothing
    WISP_BAD_INPUT = 2, ///< a value, file or scene is wrong; the message names file, line or element
    WISP_STALE_ID = 3,  ///< the entity was removed, or never existed
    WISP_CONFLICT = 4,  ///< the call does not fit the state of the world (no such component, plan that cannot be met)
    WISP_IO_ERROR = 5,  ///< the operating system refused to open, read or write a file
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
WISP_API wisp_status wisp_fail( wisp_error* error, wisp_status status, const char* format, ... ) WISP_PRINTF( 3, 4 );

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

#define WISP_MAX_WORKERS 64

/// Runs one block of a parallel loop. Blocks do not depend on the number of workers, so results do not either.
typedef void wisp_block_fn( void* context, int block, int worker );

/// A parallel loop of a host with its own job system: call run( context, block, worker ) once for every block in
/// [0, block_count), in any order, on any thread, with worker in [0, workers) and no two threads on the same worker at once; return
/// when all are done.
///
///     static void host_parallel_for( void* user, int block_count, wisp_block_fn* run, void* context )
///     {
///         for ( int block = 0; block < block_count; ++block ) // or on the host's threads, each with a worker of its own
///             run( context, block, 0 );
///     }
typedef void wisp_parallel_for_fn( void* user, int block_count, wisp_block_fn* run, void* context );

typedef enum wisp_log_level
{
    WISP_LOG_INFO = 0,
    WISP_LOG_WARNING = 1,
    WISP_LOG_ERROR = 2,
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
