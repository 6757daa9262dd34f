/// Shared by all tests: a host whose memory is counted and can run out, a log that keeps the last message, and
/// strands of chosen lengths.
#pragma once

#include "unit.h"

#include "wisp/module/random.h"
#include "wisp/wisp.h"

#include <stdatomic.h>

/// Defaults of a surface that no force acts on, for tests that add their own.
static inline wisp_surface_def support_weightless_surface_def( void )
{
    wisp_surface_def def = wisp_default_surface_def();
    def.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    return def;
}

/// For locals that point to a world.
static inline void destroy_local( wisp_world** world )
{
    wisp_world_destroy( *world );
}

// ---- memory ----

/// A host that counts its allocations, fills them with a pattern, checks releases, and can refuse one request or all
/// from one on. Zero-initialised refuses nothing.
typedef struct test_host
{
    _Atomic int64_t queried; ///< requests so far
    _Atomic int64_t blocks;  ///< allocated now
    _Atomic int64_t bytes;   ///< allocated now
    _Atomic int faults;      ///< blocks that were released with another size than they were allocated with
    int64_t refuse;          ///< number of the request to refuse, from 1; 0 refuses none
    bool refuse_rest;        ///< and all later ones
} test_host;

/// Data of a block for its release. They are in front of it, so that the block's end stays the end of the memory that
/// a sanitizer watches.
typedef struct test_block
{
    size_t front, size;
} test_block;

static inline void* test_host_allocate( void* user, size_t size, size_t alignment )
{
    test_host* host = user;
    int64_t number = atomic_fetch_add( &host->queried, 1 ) + 1;
    if ( host->refuse != 0 && ( number == host->refuse || ( number > host->refuse && host->refuse_rest ) ) )
    {
        return NULL;
    }
    test_block head = { alignment < sizeof( test_block ) ? sizeof( test_block ) : alignment, size };
    void* memory = NULL;
    if ( posix_memalign( &memory, head.front, head.front + size ) != 0 )
    {
        return NULL;
    }
    char* block = (char*)memory + head.front;
    memcpy( block - sizeof( head ), &head, sizeof( head ) );
    memset( block, 0xa5, size );
    atomic_fetch_add( &host->blocks, 1 );
    atomic_fetch_add( &host->bytes, (int64_t)size );
    return block;
}

static inline void test_host_release( void* user, void* block, size_t size )
{
    test_host* host = user;
    if ( block == NULL )
    {
        return;
    }
    test_block head;
    memcpy( &head, (char*)block - sizeof( head ), sizeof( head ) );
    atomic_fetch_add( &host->faults, head.size != size ? 1 : 0 );
    atomic_fetch_sub( &host->blocks, 1 );
    atomic_fetch_sub( &host->bytes, (int64_t)head.size );
    free( (char*)block - head.front );
}

static inline wisp_allocator test_host_allocator( test_host* host )
{
    return ( wisp_allocator ){ test_host_allocate, test_host_release, host };
}

/// Refuse the n-th request from now on, or with `rest` that one and all later ones; n = 0 refuses none.
static inline void test_host_refuse( test_host* host, int64_t n, bool rest )
{
    host->refuse = n > 0 ? atomic_load( &host->queried ) + n : 0;
    host->refuse_rest = rest;
}

/// True after the request given to test_host_refuse().
static inline bool test_host_has_refused( const test_host* host )
{
    return host->refuse != 0 && atomic_load( &host->queried ) >= host->refuse;
}

/// All memory was released, with the size of its allocation.
static inline void assert_host_memory_is_released( test_host* host )
{
    assert_int_equal( atomic_load( &host->blocks ), 0 );
    assert_int_equal( atomic_load( &host->bytes ), 0 );
    assert_int_equal( atomic_load( &host->faults ), 0 );
}

// ---- log ----

/// Keeps the last message of a world. Zero-initialised has none.
typedef struct test_log
{
    int count;
    wisp_log_level level;
    char last[600];
} test_log;

static inline void test_log_write( void* user, wisp_log_level level, const char* message )
{
    test_log* log = user;
    log->count += 1;
    log->level = level;
    snprintf( log->last, sizeof( log->last ), "%s", message );
}

/// One message: some words, no newline, no full stop.
static inline void assert_one_message( const char* message )
{
    size_t length = strlen( message );
    assert_true( length > 10 );
    assert_null( strchr( message, '\n' ) );
    assert_true( message[length - 1] != '.' );
}

/// A call was refused with one message that has these words.
static inline void expect_refusal( wisp_world* world, wisp_status actual, wisp_status expected, const char* words )
{
    assert_int_equal( actual, expected );
    assert_one_message( wisp_world_message( world ) );
    assert_contains( wisp_world_message( world ), words );
}

// ---- numbers ----

/// A number below `count`, the same in every run, selected by (a, b).
static inline int test_random( int a, int b, int count )
{
    uint64_t bits = wisp_random_bits( wisp_random_make_key( 7, 0, 0 ), (uint32_t)a, (uint32_t)b, 0 );
    return (int)( bits % (uint64_t)count );
}

/// Uniform in [low, high).
static inline float test_random_float( int a, int b, float lower, float upper )
{
    return lower +
           ( upper - lower ) * wisp_random_unit_float( wisp_random_make_key( 8, 0, 0 ), (uint32_t)a, (uint32_t)b, 0 );
}

static inline double vec_distance( wisp_vec3 a, wisp_vec3 b )
{
    const double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
    return sqrt( x * x + y * y + z * z );
}

// ---- strands ----

/// Strands as a user provides them.
typedef struct test_strands
{
    int strand_count, vertex_count;
    int32_t* offsets;
    wisp_vec3* points;
} test_strands;

/// Strands of the given lengths, a millimetre apart, a centimetre per segment, a little crooked. Free with
/// test_strands_free().
static inline test_strands test_strands_make( const int* lengths, int strand_count )
{
    test_strands s = { .strand_count = strand_count };
    s.offsets = checked_calloc( (size_t)strand_count + 1, sizeof( int32_t ) );
    for ( int i = 0; i < strand_count; ++i )
    {
        s.offsets[i + 1] = s.offsets[i] + lengths[i];
    }
    s.vertex_count = s.offsets[strand_count];
    s.points = checked_calloc( (size_t)s.vertex_count + 1, sizeof( wisp_vec3 ) );
    for ( int i = 0; i < strand_count; ++i )
    {
        for ( int v = 0; v < lengths[i]; ++v )
        {
            s.points[s.offsets[i] + v] = ( wisp_vec3 ){
                .x = 1e-3f * (float)i + test_random_float( i, 2 * v, 0.0f, 1e-3f ),
                .y = 0.1f + 1e-2f * (float)v,
                .z = test_random_float( i, 2 * v + 1, 0.0f, 1e-3f ),
            };
        }
    }
    return s;
}

/// Strands that all have the same length.
static inline test_strands test_strands_of( int strand_count, int length )
{
    int* lengths = checked_calloc( (size_t)strand_count + 1, sizeof( int ) );
    for ( int i = 0; i < strand_count; ++i )
    {
        lengths[i] = length;
    }
    test_strands s = test_strands_make( lengths, strand_count );
    free( lengths );
    return s;
}

static inline void test_strands_free( test_strands* s )
{
    free( s->offsets );
    free( s->points );
    *s = ( test_strands ){ 0 };
}

static inline wisp_strands_def test_strands_def( const test_strands* s )
{
    wisp_strands_def def = wisp_default_strands_def();
    def.points = s->points;
    def.offsets = s->offsets;
    def.strand_count = s->strand_count;
    return def;
}

/// Add strands of equal length to a world; this must succeed.
static inline wisp_entity test_add_strands( wisp_world* world, int strand_count, int length )
{
    test_strands s = test_strands_of( strand_count, length );
    wisp_strands_def def = test_strands_def( &s );
    wisp_entity entity;
    wisp_status status = wisp_add_strands( world, &def, &entity );
    test_strands_free( &s );
    assert_int_equal( status, WISP_OK );
    return entity;
}
