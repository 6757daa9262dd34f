// The lowest folder: messages, the assert hook, the clock, random numbers; blocks of the host's memory, the growing buffer,
// the arena.
// Standard error is redirected and a child process aborts: POSIX functions, which -std=c17 hides by default.
#define _POSIX_C_SOURCE 200809L

#include "unit.h"

#include "alloc.h"
#include "arena.h"
#include "log.h"

#include "wisp/module/random.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

// ---- messages

TEST( failing_fills_the_error_and_hands_the_status_back )
{
    wisp_error error = { 0 };
    wisp_status status = wisp_fail( &error, WISP_BAD_INPUT, "%s:%d: edge %d has no length", "a.obj", 7, 12 );
    assert_int_equal( status, WISP_BAD_INPUT );
    assert_int_equal( error.status, WISP_BAD_INPUT );
    assert_string_equal( error.message, "a.obj:7: edge 12 has no length" );
    assert_int_equal( wisp_fail( NULL, WISP_IO_ERROR, "nobody listens" ), WISP_IO_ERROR );
}

TEST( a_message_too_long_is_cut_at_the_end )
{
    char text[1000];
    memset( text, 'x', sizeof text - 1 );
    text[sizeof text - 1] = '\0';
    wisp_error error;
    memset( &error, 0x7f, sizeof error );

    wisp_fail( &error, WISP_CONFLICT, "%s", text );

    assert_int_equal( strlen( error.message ), sizeof error.message - 1 );
    assert_memory_equal( error.message, text, sizeof error.message - 1 );
}

TEST( a_cut_never_splits_a_utf8_character )
{
    const char* characters[] = { "\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\x8e\x88" };
    for ( int c = 0; c < WISP_COUNT( characters ); ++c )
    {
        size_t size = strlen( characters[c] );
        for ( size_t lead = 490; lead <= 500; ++lead )
        {
            char text[600];
            memset( text, 'x', lead );
            memcpy( text + lead, characters[c], size );
            strcpy( text + lead + size, "-tail-beyond-the-end" );
            wisp_error error = { 0 };
            wisp_fail( &error, WISP_BAD_INPUT, "%s", text );

            size_t capacity = sizeof error.message - 1;
            bool whole = lead + size <= capacity;
            size_t expected = whole || lead > capacity ? capacity : lead;
            assert_int_equal( strlen( error.message ), expected );
            assert_memory_equal( error.message, text, expected );
        }
    }
}

TEST( a_message_is_one_line )
{
    wisp_error error = { 0 };
    wisp_fail( &error, WISP_BAD_INPUT, "no file\tnamed \"%s\"\r\n", "two\nlines" );
    assert_string_equal( error.message, "no file named \"two lines\"" );
}

TEST( a_message_may_quote_the_one_it_replaces )
{
    wisp_error error = { 0 };
    wisp_fail( &error, WISP_BAD_INPUT, "vertex 3 is not a number" );
    wisp_fail( &error, error.status, "drape.scene: %s", error.message );
    assert_string_equal( error.message, "drape.scene: vertex 3 is not a number" );
}

TEST( every_status_has_a_name_of_its_own )
{
    for ( int a = WISP_OK; a <= WISP_IO_ERROR + 1; ++a )
    {
        for ( int b = WISP_OK; b < a; ++b )
        {
            assert_string_not_equal( wisp_status_name( (wisp_status)a ), wisp_status_name( (wisp_status)b ) );
        }
    }
    assert_string_equal( wisp_status_name( WISP_OK ), "ok" );
    assert_string_equal( wisp_status_name( WISP_NO_MEMORY ), "out of memory" );
    assert_string_equal( wisp_status_name( WISP_BAD_INPUT ), "bad input" );
    assert_string_equal( wisp_status_name( (wisp_status)77 ), "unknown status" );
}

// ---- log, assert, clock

typedef struct heard
{
    int count;
    wisp_log_level level;
    char message[600];
} heard;

static void hear( void* user, wisp_log_level level, const char* message )
{
    heard* h = user;
    h->count += 1;
    h->level = level;
    strncpy( h->message, message, sizeof h->message - 1 );
}

TEST( the_log_reaches_the_host_as_one_line )
{
    heard h = { 0 };
    base_log log = { .function = hear, .user = &h };
    base_log_write( &log, WISP_LOG_INFO, "step %d\n", 5 );
    assert_int_equal( h.count, 1 );
    assert_int_equal( h.level, WISP_LOG_INFO );
    assert_string_equal( h.message, "step 5" );
    base_log_write( &log, WISP_LOG_ERROR, "%s", "late" );
    assert_int_equal( h.count, 2 );
    assert_int_equal( h.level, WISP_LOG_ERROR );
}

TEST( without_a_host_warnings_go_to_stderr_and_information_goes_nowhere )
{
    const base_log zero = { 0 };
    FILE* file = tmpfile();
    assert_non_null( file );
    int kept = dup( STDERR_FILENO );
    dup2( fileno( file ), STDERR_FILENO );
    base_log_write( NULL, WISP_LOG_INFO, "quiet" );
    base_log_write( &zero, WISP_LOG_INFO, "quiet" );
    base_log_write( NULL, WISP_LOG_WARNING, "tight %d", 3 );
    base_log_write( &zero, WISP_LOG_ERROR, "torn\n" );
    fflush( stderr );
    dup2( kept, STDERR_FILENO );
    close( kept );

    char text[200] = { 0 };
    rewind( file );
    assert_int_equal( fread( text, 1, sizeof text - 1, file ), 25 );
    fclose( file );
    assert_string_equal( text, "wisp: tight 3\nwisp: torn\n" );
}

// An assert handler has no user pointer, so its message is kept here.
static int assert_count;
static const char* assert_condition;
static const char* assert_file;
static int assert_line;

static bool remember_assert( const char* condition, const char* file, int line )
{
    assert_count += 1;
    assert_condition = condition;
    assert_file = file;
    assert_line = line;
    return false;
}

TEST( a_failed_assert_calls_the_handler_and_may_go_on )
{
    assert_count = 0;
    wisp_set_assert_handler( remember_assert );
    int count = -1;
    WISP_ASSERT( count >= 0 ), count = __LINE__;
    wisp_set_assert_handler( NULL );

    assert_int_equal( assert_count, 1 );
    assert_string_equal( assert_condition, "count >= 0" );
    assert_string_equal( assert_file, __FILE__ );
    assert_int_equal( assert_line, count );
}

TEST( a_failed_assert_without_a_handler_aborts )
{
    pid_t child = fork();
    assert_true( child >= 0 );
    if ( child == 0 )
    {
        // cmocka may have set a handler of its own.
        signal( SIGABRT, SIG_DFL );
        close( STDERR_FILENO );
        wisp_assert_failed( "never", __FILE__, __LINE__ );
        _exit( 0 );
    }
    int status = 0;
    assert_int_equal( waitpid( child, &status, 0 ), child );
    assert_true( WIFSIGNALED( status ) && WTERMSIG( status ) == SIGABRT );
}

TEST( an_assert_that_holds_calls_nobody )
{
    assert_count = 0;
    wisp_set_assert_handler( remember_assert );
    WISP_ASSERT( sizeof( int32_t ) == 4 );
    wisp_set_assert_handler( NULL );
    assert_int_equal( assert_count, 0 );
}

TEST( the_clock_never_goes_back_and_does_go_on )
{
    double begin = wisp_clock_seconds();
    double last = begin;
    for ( int k = 0; k < 1000000 && last == begin; ++k )
    {
        double now = wisp_clock_seconds();
        assert_true( now >= last );
        last = now;
    }
    assert_true( last > begin );
}

// ---- random numbers

// From a second implementation, in Python, written from the two papers.
TEST( random_bits_equal_golden_values )
{
    wisp_random_key zero = wisp_random_make_key( 0, 0, 0 );
    assert_int_equal( zero.word[0], 0xfbe98833u );
    assert_int_equal( zero.word[3], 0xf4430b33u );
    assert_true( wisp_random_bits( zero, 0, 0, 0 ) == 0xaba12db6e8a94103u );
    assert_true( wisp_random_bits( wisp_random_make_key( 1, 2, 3 ), 4, 5, 6 ) == 0xf994e02adf73c57bu );
    assert_true( wisp_random_bits( wisp_random_make_key( UINT64_MAX, 1, (uint64_t)1 << 40 ), UINT32_MAX, 7,
                                   0x80000000u ) == 0x3c0d2e4308809a21u );
    assert_true( wisp_random_bits( wisp_random_make_key( 42, 3, 0 ), 1000, 20, 2 ) == 0x25eaed1ea0f7d825u );
}

TEST( the_float_is_the_double_with_fewer_bits )
{
    wisp_random_key key = wisp_random_make_key( 5, 6, 7 );
    for ( uint32_t a = 0; a < 100000; ++a )
    {
        double exact = wisp_random_unit( key, a, 1, 2 );
        double rounded = (double)wisp_random_unit_float( key, a, 1, 2 );
        assert_true( exact >= 0.0 && exact < 1.0 );
        assert_true( rounded <= exact && exact - rounded < 0x1p-24 );
    }
}

#define SAMPLE_COUNT 65536

// Chi-square of 255 degrees of freedom: mean 255, standard deviation sqrt( 510 ) = 22.6. A value that is too small is
// an error as well.
static void assert_uniform_over_256_bins( const int bins[256], double sample_count )
{
    double expected = sample_count / 256.0, chi_square = 0.0;
    for ( int k = 0; k < 256; ++k )
    {
        chi_square += ( bins[k] - expected ) * ( bins[k] - expected ) / expected;
    }
    assert_true( fabs( chi_square - 255.0 ) < 4.0 * sqrt( 510.0 ) );
}

TEST( random_numbers_fill_the_bins_evenly )
{
    for ( uint64_t seed = 0; seed < 8; ++seed )
    {
        wisp_random_key key = wisp_random_make_key( seed, 2, 0 );
        int upper[256] = { 0 }, lower[256] = { 0 };
        for ( uint32_t a = 0; a < SAMPLE_COUNT; ++a )
        {
            uint64_t bits = wisp_random_bits( key, a, 0, 0 );
            upper[bits >> 56] += 1;
            lower[bits >> 40 & 255] += 1; // the lowest bits that a float keeps
        }
        assert_uniform_over_256_bins( upper, SAMPLE_COUNT );
        assert_uniform_over_256_bins( lower, SAMPLE_COUNT );
    }
}

// Pairs of u and a neighbour's u over a 16 x 16 grid, and their correlation.
static void assert_independent( wisp_random_key first, wisp_random_key second, uint32_t da, uint32_t db, uint32_t dc )
{
    int bins[256] = { 0 };
    double sum = 0.0;
    for ( uint32_t k = 0; k < SAMPLE_COUNT; ++k )
    {
        uint32_t a = k / 1024, b = k / 4 % 256, c = k % 4;
        double u = wisp_random_unit( first, a, b, c );
        double v = wisp_random_unit( second, a + da, b + db, c + dc );
        bins[(int)( u * 16.0 ) * 16 + (int)( v * 16.0 )] += 1;
        sum += ( u - 0.5 ) * ( v - 0.5 );
    }
    assert_uniform_over_256_bins( bins, SAMPLE_COUNT );

    // the product of two independent centred uniforms has standard deviation 1/12; 4 of the mean's
    assert_true( fabs( sum / SAMPLE_COUNT ) < 4.0 / 12.0 / sqrt( SAMPLE_COUNT ) );
}

TEST( neighbouring_elements_are_independent )
{
    wisp_random_key key = wisp_random_make_key( 11, 3, 4 );
    assert_independent( key, key, 1, 0, 0 );
    assert_independent( key, key, 0, 1, 0 );
    assert_independent( key, key, 0, 0, 1 );
    assert_independent( key, key, 1, 1, 1 );
}

TEST( seeds_streams_and_events_are_independent )
{
    wisp_random_key key = wisp_random_make_key( 11, 3, 4 );
    assert_independent( key, wisp_random_make_key( 12, 3, 4 ), 0, 0, 0 );
    assert_independent( key, wisp_random_make_key( 11, 4, 4 ), 0, 0, 0 );
    assert_independent( key, wisp_random_make_key( 11, 3, 5 ), 0, 0, 0 );
    assert_independent( key, wisp_random_make_key( 3, 11, 4 ), 0, 0, 0 );
    assert_independent( key, wisp_random_make_key( 11, 4, 3 ), 0, 0, 0 );
}

// A host that counts, and that can run out of memory.
typedef struct counting_host
{
    int allocate_count;
    int release_count;
    size_t bytes_held;
    bool out_of_memory;
} counting_host;

static void* counting_allocate( void* user, size_t size, size_t alignment )
{
    counting_host* host = user;
    if ( host->out_of_memory )
    {
        return NULL;
    }
    host->allocate_count += 1;
    host->bytes_held += size;
    return aligned_alloc( alignment, ( size + alignment - 1 ) / alignment * alignment );
}

static void counting_release( void* user, void* block, size_t size )
{
    counting_host* host = user;
    host->release_count += 1;
    host->bytes_held -= size;
    free( block );
}

static wisp_allocator allocator_of( counting_host* host )
{
    return ( wisp_allocator ){ .allocate = counting_allocate, .release = counting_release, .user = host };
}

// ---- single blocks

TEST( blocks_come_from_the_hooks_and_return_to_them_with_their_size )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );

    void* block = base_allocate( &allocator, 100, 64 );
    assert_non_null( block );
    assert_int_equal( host.allocate_count, 1 );
    assert_int_equal( host.bytes_held, 100 );

    base_release( &allocator, block, 100 );
    assert_int_equal( host.release_count, 1 );
    assert_int_equal( host.bytes_held, 0 );
}

TEST( blocks_without_hooks_are_aligned_as_queried )
{
    const wisp_allocator zero = { 0 };
    for ( size_t alignment = 1; alignment <= 4096; alignment *= 2 )
    {
        void* block = base_allocate( alignment % 3 == 1 ? NULL : &zero, 3 * alignment + 1, alignment );
        assert_non_null( block );
        assert_int_equal( (uintptr_t)block % alignment, 0 );
        memset( block, 0x5a, 3 * alignment + 1 );
        base_release( NULL, block, 3 * alignment + 1 );
    }
}

TEST( no_bytes_are_no_block )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );

    assert_null( base_allocate( &allocator, 0, 16 ) );
    assert_null( base_allocate( NULL, 0, 16 ) );
    base_release( &allocator, NULL, 0 );
    assert_int_equal( host.allocate_count, 0 );
    assert_int_equal( host.release_count, 0 );
}

TEST( impossible_sizes_are_refused_before_they_reach_the_hooks )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );

    assert_null( base_allocate( &allocator, SIZE_MAX, 64 ) );
    assert_null( base_allocate( NULL, SIZE_MAX - 63, 64 ) );
    assert_null( base_allocate( NULL, (size_t)PTRDIFF_MAX, 64 ) );
    assert_int_equal( host.allocate_count, 0 );
}

TEST( a_product_of_sizes_that_overflows_is_noticed )
{
    size_t product = 7;
    assert_true( base_size_multiply( SIZE_MAX, 0, &product ) );
    assert_int_equal( product, 0 );
    assert_true( base_size_multiply( SIZE_MAX / 3, 3, &product ) );
    assert_int_equal( product, SIZE_MAX / 3 * 3 );

    product = 7;
    assert_false( base_size_multiply( SIZE_MAX / 3 + 1, 3, &product ) );
    assert_false( base_size_multiply( SIZE_MAX, SIZE_MAX, &product ) );
    assert_int_equal( product, 7 );
}

// ---- the growing buffer

TEST( a_buffer_grows_geometrically_and_keeps_its_contents )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );
    wisp_buffer buffer = { 0 };

    for ( size_t count = 1; count <= 100000; ++count )
    {
        assert_true( base_buffer_reserve( &allocator, &buffer, count ) );
        assert_int_equal( (uintptr_t)buffer.data % BASE_BUFFER_ALIGNMENT, 0 );
        ( (unsigned char*)buffer.data )[count - 1] = (unsigned char)( count * 37 );
    }
    for ( size_t count = 1; count <= 100000; ++count )
    {
        assert_int_equal( ( (unsigned char*)buffer.data )[count - 1], (unsigned char)( count * 37 ) );
    }

    // log( 100000 ) / log( 1.5 ) = 28.4 growths, and a few more while half of a tiny size rounds down
    assert_in_range( host.allocate_count, 20, 34 );
    assert_int_equal( host.bytes_held, buffer.size );

    base_buffer_release( &allocator, &buffer );
    assert_null( buffer.data );
    assert_int_equal( buffer.size, 0 );
    assert_int_equal( host.bytes_held, 0 );
    assert_int_equal( host.allocate_count, host.release_count );
}

TEST( a_buffer_that_is_large_enough_is_left_alone )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );
    wisp_buffer buffer = { 0 };
    assert_true( base_buffer_reserve( &allocator, &buffer, 1000 ) );
    void* data = buffer.data;

    assert_true( base_buffer_reserve( &allocator, &buffer, 0 ) );
    assert_true( base_buffer_reserve( &allocator, &buffer, 1000 ) );

    assert_ptr_equal( buffer.data, data );
    assert_int_equal( host.allocate_count, 1 );
    base_buffer_release( &allocator, &buffer );
}

TEST( a_buffer_that_cannot_grow_is_unchanged )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );
    wisp_buffer buffer = { 0 };
    assert_true( base_buffer_reserve( &allocator, &buffer, 100 ) );
    memset( buffer.data, 42, 100 );
    wisp_buffer before = buffer;

    host.out_of_memory = true;
    assert_false( base_buffer_reserve( &allocator, &buffer, 101 ) );
    host.out_of_memory = false;
    assert_false( base_buffer_reserve( &allocator, &buffer, SIZE_MAX ) );

    assert_ptr_equal( buffer.data, before.data );
    assert_int_equal( buffer.size, before.size );
    assert_int_equal( ( (unsigned char*)buffer.data )[99], 42 );
    assert_int_equal( host.release_count, 0 );
    base_buffer_release( &allocator, &buffer );
}

// ---- the arena

// One step: pieces of many sizes and alignments, each filled, so that an overlap would show.
static void run_step( base_arena* arena )
{
    unsigned char* primitive[50];
    for ( size_t k = 0; k < 50; ++k )
    {
        size_t alignment = (size_t)1 << ( k * 7 % 9 );
        primitive[k] = base_arena_push( arena, 13 * k + 1, alignment );
        assert_non_null( primitive[k] );
        assert_int_equal( (uintptr_t)primitive[k] % alignment, 0 );
        memset( primitive[k], (int)k, 13 * k + 1 );
    }
    for ( size_t k = 0; k < 50; ++k )
    {
        for ( size_t byte = 0; byte < 13 * k + 1; ++byte )
        {
            assert_int_equal( primitive[k][byte], k );
        }
    }
}

TEST( an_arena_stops_allocating_once_it_is_warm )
{
    const size_t capacities[] = { 0, 1, 1000, 1000000 };
    for ( int c = 0; c < WISP_COUNT( capacities ); ++c )
    {
        counting_host host = { 0 };
        wisp_allocator allocator = allocator_of( &host );
        base_arena arena;
        base_arena_init( &arena, &allocator, capacities[c] );

        run_step( &arena );
        base_arena_reset( &arena );
        int warm = host.allocate_count;
        for ( int step = 0; step < 10; ++step )
        {
            run_step( &arena );
            assert_null( arena.overflow );
            base_arena_reset( &arena );
        }
        assert_int_equal( host.allocate_count, warm );
        assert_int_equal( host.bytes_held, arena.capacity );

        base_arena_release( &arena );
        assert_int_equal( host.bytes_held, 0 );
        assert_int_equal( host.allocate_count, host.release_count );
    }
}

TEST( an_arena_keeps_its_size_through_smaller_steps )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );
    SCOPED( base_arena_release ) base_arena arena;
    base_arena_init( &arena, &allocator, 0 );
    assert_non_null( base_arena_push( &arena, 5000, 64 ) );
    base_arena_reset( &arena );
    int warm = host.allocate_count;

    assert_non_null( base_arena_push( &arena, 10, 64 ) );
    base_arena_reset( &arena );
    assert_non_null( base_arena_push( &arena, 5000, 64 ) );

    assert_int_equal( host.allocate_count, warm );
    assert_int_equal( arena.high_water, 5000 );
}

TEST( an_arena_without_memory_says_null_and_recovers )
{
    counting_host host = { .out_of_memory = true };
    wisp_allocator allocator = allocator_of( &host );
    base_arena arena;
    base_arena_init( &arena, &allocator, 100 );
    assert_null( base_arena_push( &arena, 100, 8 ) );
    host.out_of_memory = false;

    // The request was recorded, so the reset provides it in one block.
    base_arena_reset( &arena );
    assert_int_equal( host.allocate_count, 1 );
    assert_non_null( base_arena_push( &arena, 100, 8 ) );
    assert_int_equal( host.allocate_count, 1 );
    base_arena_release( &arena );
    assert_int_equal( host.bytes_held, 0 );
}

TEST( an_absurd_push_does_not_keep_an_arena_from_growing )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );
    SCOPED( base_arena_release ) base_arena arena;
    base_arena_init( &arena, &allocator, 256 );
    void* block = arena.block;

    assert_null( base_arena_push( &arena, SIZE_MAX - 5, 4096 ) );
    base_arena_reset( &arena );
    assert_ptr_equal( arena.block, block );
    assert_int_equal( arena.capacity, 256 );

    run_step( &arena );
    base_arena_reset( &arena );
    int warm = host.allocate_count;
    run_step( &arena );
    assert_int_equal( host.allocate_count, warm );
}

TEST( an_arena_rewinds_to_a_mark_and_makes_the_room_it_is_told_to_expect )
{
    SCOPED( base_arena_release ) base_arena arena;
    base_arena_init( &arena, NULL, 0 );
    base_arena_expect( &arena, 1000 );
    base_arena_reset( &arena );
    unsigned char* first = base_arena_push( &arena, 10, 8 );
    base_arena_mark mark = base_arena_get_mark( &arena );
    for ( int block = 0; block < 10; ++block )
    {
        assert_ptr_equal( base_arena_push( &arena, 900, 64 ), first + 64 );
        base_arena_rewind( &arena, mark );
    }
    assert_null( arena.overflow );
    assert_int_equal( arena.capacity, 1000 );
}

// The first step of a world has a thousand blocks, one after the other, before its arena can grow.
TEST( a_cold_arena_holds_only_what_is_pushed_since_its_mark )
{
    counting_host host = { 0 };
    wisp_allocator allocator = allocator_of( &host );
    base_arena arena;
    base_arena_init( &arena, &allocator, 0 );
    unsigned char* kept = base_arena_push( &arena, 10, 8 );
    kept[9] = 42;
    const base_arena_mark mark = base_arena_get_mark( &arena );
    const size_t held = host.bytes_held;
    for ( int block = 0; block < 1000; ++block )
    {
        assert_non_null( base_arena_push( &arena, 900, 64 ) );
        assert_non_null( base_arena_push( &arena, 100, 64 ) );
        base_arena_rewind( &arena, mark );
        assert_int_equal( host.bytes_held, held );
    }
    assert_int_equal( kept[9], 42 );
    base_arena_reset( &arena );
    assert_true( arena.capacity >= 1010 && arena.capacity < 2000 );
    base_arena_release( &arena );
    assert_int_equal( host.bytes_held, 0 );
}
