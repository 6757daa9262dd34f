#include "fabric.h"

#include "alloc.h"

#include <inttypes.h>
#include <string.h>

#define SAVED_MAGIC "WISPFAB4"

// Header: magic, number of words, hash of the content; eight bytes each, integers little-endian.
#define SAVED_HEAD 24

_Static_assert( sizeof( int ) == 4 && sizeof( float ) == 4 && sizeof( wisp_vec3 ) == 12,
                "a fabric is made of words" );

// Callbacks for the numbers of a fabric. Returning false stops the traversal.
typedef struct fabric_walk
{
    bool ( *number )( void* context, int* number );

    // may replace the array by one with the same number of words
    bool ( *array )( void* context, void** array, uint64_t words );

    // allocates levels that do not exist yet; null for traversals that only read
    wisp_fabric_level* ( *levels )( void* context, int count );
    void* context;
} fabric_walk;

static uint64_t w( int count )
{
    return count > 0 ? (uint64_t)count : 0;
}

static uint64_t padded_w( int count )
{
    return ( w( count ) + WISP_FABRIC_LANES - 1 ) / WISP_FABRIC_LANES * WISP_FABRIC_LANES;
}

#define WALK_COUNT( name ) done = done && walk->number( walk->context, &o->name );
#define WALK_ARRAY( name, words )                                                                                    \
    {                                                                                                                \
        void* array = (void*)o->name;                                                                                \
        done = done && walk->array( walk->context, &array, words );                                                  \
        o->name = array;                                                                                             \
    }

static bool walk_schedule( const fabric_walk* walk, wisp_schedule* o )
{
    bool done = true;
    FABRIC_SCHEDULE_COUNTS( WALK_COUNT )
    FABRIC_SCHEDULE_ARRAYS( WALK_ARRAY, o )
    return done;
}

static bool walk_level( const fabric_walk* walk, wisp_fabric_level* o )
{
    bool done = true;
    FABRIC_LEVEL_COUNTS( WALK_COUNT )
    done = done && walk_schedule( walk, &o->schedule );
    FABRIC_LEVEL_ARRAYS( WALK_ARRAY, o )
    return done;
}

static bool walk_levels( const fabric_walk* walk, wisp_fabric* o )
{
    wisp_fabric_level* room = walk->levels != NULL ? walk->levels( walk->context, o->level_count ) : NULL;
    bool done = walk->levels == NULL || room != NULL;
    for ( int i = 0; i < o->level_count && done; ++i )
    {
        wisp_fabric_level level = room != NULL ? room[i] : o->levels[i];
        done = walk_level( walk, &level );
        if ( room != NULL )
        {
            room[i] = level;
        }
    }
    o->levels = room != NULL ? room : o->levels;
    return done;
}

// Visits everything but the hash. The fabric belongs to the caller; traversals that only read use a copy of the
// struct.
static bool walk_fabric( const fabric_walk* walk, wisp_fabric* o )
{
    int solve_order = (int)o->solve_order;
    bool done = true;
    FABRIC_COUNTS( WALK_COUNT )
    done = done && walk->number( walk->context, &solve_order );
    o->solve_order = (wisp_solve_order)solve_order;
    done = done && walk_schedule( walk, &o->link_order ) && walk_schedule( walk, &o->hinge_order );
    FABRIC_ARRAYS( WALK_ARRAY, o )
    return done && walk_levels( walk, o );
}

// ---- hash ----

// Each step is a bijection of the hash, so that a single damaged word always changes the result.
static uint64_t hash_word( uint64_t hash, uint32_t word )
{
    hash = ( hash ^ word ) * 0xff51afd7ed558ccdu;
    return hash ^ hash >> 32;
}

static uint32_t read_host_word( const void* array, uint64_t index )
{
    uint32_t word;
    memcpy( &word, (const char*)array + 4 * index, 4 );
    return word;
}

static bool hash_number( void* context, int* number )
{
    *(uint64_t*)context = hash_word( *(uint64_t*)context, (uint32_t)*number );
    return true;
}

static bool hash_array( void* context, void** array, uint64_t words )
{
    uint64_t hash = *(uint64_t*)context;
    for ( uint64_t i = 0; i < words; ++i )
    {
        hash = hash_word( hash, read_host_word( *array, i ) );
    }
    *(uint64_t*)context = hash;
    return true;
}

uint64_t fabric_hash( const wisp_fabric* fabric )
{
    uint64_t hash = 0;
    wisp_fabric copy = *fabric;
    walk_fabric( &( fabric_walk ){ .number = hash_number, .array = hash_array, .context = &hash }, &copy );
    return hash;
}

// ---- save ----

static void write_word( unsigned char* out, uint32_t word )
{
    for ( int i = 0; i < 4; ++i )
    {
        out[i] = (unsigned char)( word >> ( 8 * i ) );
    }
}

static void write_long( unsigned char* out, uint64_t number )
{
    write_word( out, (uint32_t)number );
    write_word( out + 4, (uint32_t)( number >> 32 ) );
}

static bool size_number( void* context, int* number )
{
    (void)number;
    *(uint64_t*)context += 1;
    return true;
}

static bool size_array( void* context, void** array, uint64_t words )
{
    (void)array;
    *(uint64_t*)context += words;
    return true;
}

static bool save_number( void* context, int* number )
{
    unsigned char** out = context;
    write_word( *out, (uint32_t)*number );
    *out += 4;
    return true;
}

static bool save_array( void* context, void** array, uint64_t words )
{
    unsigned char** out = context;
    for ( uint64_t i = 0; i < words; ++i )
    {
        write_word( *out + 4 * i, read_host_word( *array, i ) );
    }
    *out += 4 * words;
    return true;
}

size_t wisp_fabric_saved_size( const wisp_fabric* fabric )
{
    uint64_t words = 0;
    if ( wisp_fabric_need( fabric, WISP_FABRIC_EDGES | WISP_FABRIC_RINGS ) != WISP_OK )
    {
        return 0;
    }
    wisp_fabric copy = *fabric;
    walk_fabric( &( fabric_walk ){ .number = size_number, .array = size_array, .context = &words }, &copy );
    return SAVED_HEAD + 4 * (size_t)words;
}

wisp_status wisp_fabric_save( const wisp_fabric* fabric, void* out, size_t size, wisp_error* error )
{
    if ( fabric == NULL || out == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got null", fabric == NULL ? "fabric" : "out" );
    }
    const size_t needed = wisp_fabric_saved_size( fabric );
    if ( needed == 0 )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for the arrays of a lean fabric" );
    }
    if ( size < needed )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "fabric: got room for %zu bytes, expected at least %zu", size,
                          needed );
    }
    unsigned char* head = out;
    unsigned char* cursor = head + SAVED_HEAD;
    wisp_fabric copy = *fabric;
    walk_fabric( &( fabric_walk ){ .number = save_number, .array = save_array, .context = &cursor }, &copy );
    memcpy( head, SAVED_MAGIC, 8 );
    write_long( head + 8, (uint64_t)( cursor - head - SAVED_HEAD ) / 4 );
    write_long( head + 16, fabric->hash );
    return WISP_OK;
}

// ---- load ----

static uint32_t read_word( const unsigned char* bytes )
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static uint64_t read_long( const unsigned char* bytes )
{
    return read_word( bytes ) | (uint64_t)read_word( bytes + 4 ) << 32;
}

typedef struct load_state
{
    const unsigned char *content, *cursor, *end;
    fabric_pool* keep;
    wisp_status status;
    wisp_error* error;
} load_state;

static bool load_fails( load_state* s, wisp_status status )
{
    size_t word = (size_t)( s->cursor - s->content ) / 4;
    s->status = status == WISP_NO_MEMORY
                    ? wisp_fail( s->error, status, "out of memory to load a fabric of %zu bytes",
                                 (size_t)( s->end - s->content ) )
                    : wisp_fail( s->error, status,
                                 "saved fabric: got too few bytes, ends at word %zu before its last array", word );
    return false;
}

static bool load_number( void* context, int* number )
{
    load_state* s = context;
    if ( s->end - s->cursor < 4 )
    {
        return load_fails( s, WISP_BAD_INPUT );
    }
    *number = (int)(int32_t)read_word( s->cursor );
    if ( *number < 0 )
    {
        s->status =
            wisp_fail( s->error, WISP_BAD_INPUT, "saved fabric: got a count of %d at word %zu, which is out of range",
                       *number, (size_t)( s->cursor - s->content ) / 4 );
        return false;
    }
    s->cursor += 4;
    return true;
}

// Loads an array. Checks that enough bytes remain before it allocates.
static bool load_array( void* context, void** array, uint64_t words )
{
    load_state* s = context;
    if ( words > (uint64_t)( s->end - s->cursor ) / 4 )
    {
        return load_fails( s, WISP_BAD_INPUT );
    }
    char* loaded = fabric_pool_push( s->keep, (size_t)words, 4 );
    if ( loaded == NULL )
    {
        return load_fails( s, WISP_NO_MEMORY );
    }
    for ( size_t i = 0; i < (size_t)words; ++i )
    {
        uint32_t word = read_word( s->cursor + 4 * i );
        memcpy( loaded + 4 * i, &word, 4 );
    }
    s->cursor += 4 * words;
    *array = loaded;
    return true;
}

static wisp_fabric_level* load_levels( void* context, int count )
{
    load_state* s = context;
    if ( count > WISP_FABRIC_MAX_LEVELS )
    {
        s->status = wisp_fail( s->error, WISP_BAD_INPUT, "saved fabric: got %d levels, expected at most %d", count,
                               WISP_FABRIC_MAX_LEVELS );
        return NULL;
    }
    wisp_fabric_level* levels = fabric_pool_push_zeroed( s->keep, (size_t)count, sizeof( *levels ) );
    if ( levels == NULL )
    {
        load_fails( s, WISP_NO_MEMORY );
    }
    return levels;
}

static wisp_status check_head( const unsigned char* bytes, size_t size, wisp_error* error )
{
    if ( size < SAVED_HEAD )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "saved fabric: got %zu bytes, expected at least %d for the header",
                          size, SAVED_HEAD );
    }
    if ( memcmp( bytes, SAVED_MAGIC, 8 ) != 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "saved fabric: got an unknown header, expected a fabric saved by this version" );
    }
    uint64_t words = read_long( bytes + 8 );
    if ( ( size - SAVED_HEAD ) % 4 != 0 || words != ( size - SAVED_HEAD ) / 4 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "saved fabric: expected %" PRIu64 " words, got %zu bytes", words,
                          size - SAVED_HEAD );
    }
    uint64_t hash = 0;
    for ( size_t i = SAVED_HEAD; i < size; i += 4 )
    {
        hash = hash_word( hash, read_word( bytes + i ) );
    }
    if ( hash != read_long( bytes + 16 ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "saved fabric: the hash does not match, the bytes are damaged" );
    }
    return WISP_OK;
}

static wisp_status load( const unsigned char* bytes, size_t size, cook_fabric* cooked, wisp_error* error )
{
    load_state state = {
        .content = bytes + SAVED_HEAD,
        .cursor = bytes + SAVED_HEAD,
        .end = bytes + size,
        .keep = &cooked->keep,
        .status = WISP_OK,
        .error = error,
    };
    fabric_walk walk = { .number = load_number, .array = load_array, .levels = load_levels, .context = &state };
    if ( walk_fabric( &walk, &cooked->fabric ) == false )
    {
        return state.status;
    }
    if ( state.cursor != state.end )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "saved fabric: got %zu extra words after the last array",
                          (size_t)( state.end - state.cursor ) / 4 );
    }
    cooked->fabric.hash = read_long( bytes + 16 );
    fabric_pool scratch = { .allocator = cooked->keep.allocator };
    wisp_status status = fabric_check( &cooked->fabric, &scratch, error );
    fabric_pool_release( &scratch );
    return status;
}

wisp_status wisp_fabric_load( const void* bytes, size_t size, const wisp_allocator* allocator, wisp_fabric** out,
                              wisp_error* error )
{
    if ( out != NULL )
    {
        *out = NULL;
    }
    if ( out == NULL || bytes == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got null", out == NULL ? "out" : "bytes" );
    }
    wisp_status status = check_head( bytes, size, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    cook_fabric* cooked = fabric_create( allocator );
    if ( cooked == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory to load a fabric of %zu bytes", size );
    }
    status = load( bytes, size, cooked, error );
    if ( status != WISP_OK )
    {
        wisp_fabric_release( &cooked->fabric );
        return status;
    }
    *out = &cooked->fabric;
    return WISP_OK;
}
