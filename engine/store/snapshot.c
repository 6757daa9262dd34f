// Snapshot, restore and hash walk the components' column lists, so none can forget a column.
#include "store.h"

#include <string.h>

#define SNAPSHOT_MAGIC "WISPSNP5"

typedef struct snapshot_header
{
    char magic[8];
    uint64_t structure; // hash of passes, entities, topology, components and row counts
    uint64_t size;      // bytes after the header
    uint64_t content;   // hash of those bytes
} snapshot_header;

uint64_t store_hash_bytes( uint64_t seed, const void* bytes, size_t size )
{
    const unsigned char* p = bytes;
    uint64_t hash = seed ^ ( (uint64_t)size * 0x9e3779b97f4a7c15u );
    while ( size > 0 )
    {
        size_t n = size < 8 ? size : 8;
        uint64_t word = 0;
        for ( size_t i = 0; i < n; ++i )
        {
            word |= (uint64_t)p[i] << ( 8 * i );
        }
        hash = ( hash ^ word ) * 0xff51afd7ed558ccdu;
        hash ^= hash >> 32;
        p += n;
        size -= n;
    }
    return hash;
}

// Calls visit for every living entity in slot order: what waits to be done on it, whether it is halted, then every column range in
// component and column order, without those that mean nothing between steps.
typedef void visit_fn( void* context, void* rows, size_t bytes );

static void visit_columns( const store* s, visit_fn* visit, void* context )
{
    for ( int i = 0; i < s->entity_count; ++i )
    {
        store_entity* e = s->entities + i;
        if ( e->alive )
        {
            visit( context, &e->dirty, sizeof( e->dirty ) );
            visit( context, &e->halted, sizeof( e->halted ) );
        }
        for ( int c = 1; c < s->component_count && e->alive; ++c )
        {
            const wisp_component_def* def = &s->components[c].def;
            const bool is_held = store_mask_has( &e->components, c ) && store_mask_has( &s->transient, c ) == false;
            for ( int k = 0; k < def->column_count && is_held; ++k )
            {
                visit( context, store_column( s, e, (wisp_component)c, k ),
                       (size_t)e->rows[def->table].count * def->columns[k].row_size );
            }
        }
    }
}

static uint64_t structure_hash( const store* s )
{
    uint64_t hash = s->passes;
    for ( int i = 0; i < s->entity_count; ++i )
    {
        const store_entity* e = s->entities + i;
        uint32_t identity[2] = { (uint32_t)i, e->generation };
        hash = e->alive ? store_hash_bytes( hash, identity, sizeof( identity ) ) : hash;
        if ( e->alive && e->strands != NULL )
        {
            hash = store_hash_bytes( hash, &e->strands->dimension, sizeof( int ) );
            hash = store_hash_bytes( hash, e->strands->offsets,
                                     ( (size_t)e->strands->strand_count + 1 ) * sizeof( int32_t ) );
        }
        if ( e->alive && e->fabric != NULL )
        {
            hash = store_hash_bytes( hash, &e->fabric->hash, sizeof( uint64_t ) );
        }
        for ( int c = 1; c < s->component_count && e->alive; ++c )
        {
            const wisp_component_def* def = &s->components[c].def;
            if ( store_mask_has( &e->components, c ) )
            {
                hash = store_hash_bytes( hash, def->name, strlen( def->name ) );
                hash = store_hash_bytes( hash, &e->rows[def->table].count, sizeof( int ) );
            }
        }
    }
    return hash;
}

static void add_size( void* context, void* rows, size_t bytes )
{
    (void)rows;
    *(size_t*)context += bytes;
}

static void copy_out( void* context, void* rows, size_t bytes )
{
    char** cursor = context;
    memcpy( *cursor, rows, bytes );
    *cursor += bytes;
}

static void copy_in( void* context, void* rows, size_t bytes )
{
    const char** cursor = context;
    memcpy( rows, *cursor, bytes );
    *cursor += bytes;
}

static void add_hash( void* context, void* rows, size_t bytes )
{
    *(uint64_t*)context = store_hash_bytes( *(uint64_t*)context, rows, bytes );
}

static size_t content_size( const store* s )
{
    size_t size = 0;
    visit_columns( s, add_size, &size );
    return size;
}

size_t store_snapshot_size( const store* s )
{
    return sizeof( snapshot_header ) + content_size( s );
}

void store_snapshot( const store* s, void* out )
{
    char* content = (char*)out + sizeof( snapshot_header );
    char* cursor = content;
    visit_columns( s, copy_out, &cursor );

    snapshot_header header = { .structure = structure_hash( s ), .size = (uint64_t)( cursor - content ) };
    memcpy( header.magic, SNAPSHOT_MAGIC, sizeof( header.magic ) );
    header.content = store_hash_bytes( 0, content, (size_t)header.size );
    memcpy( out, &header, sizeof( header ) );
}

wisp_status store_restore( store* s, const void* bytes, size_t size, wisp_error* error )
{
    snapshot_header header;
    if ( size < sizeof( header ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "snapshot: got %zu bytes, expected at least %zu for the header",
                          size, sizeof( header ) );
    }
    memcpy( &header, bytes, sizeof( header ) );
    const char* content = (const char*)bytes + sizeof( header );
    if ( memcmp( header.magic, SNAPSHOT_MAGIC, sizeof( header.magic ) ) != 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "snapshot: got an unknown header, expected a snapshot of this version" );
    }
    if ( header.size != size - sizeof( header ) || header.size != content_size( s ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "snapshot: got %zu bytes of columns, but this world has %zu",
                          size - sizeof( header ), content_size( s ) );
    }
    if ( header.structure != structure_hash( s ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "snapshot: was taken of other entities, components or modules" );
    }
    if ( header.content != store_hash_bytes( 0, content, (size_t)header.size ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "snapshot: the hash does not match, the bytes are damaged" );
    }
    visit_columns( s, copy_in, &content );
    return WISP_OK;
}

uint64_t store_hash( const store* s )
{
    uint64_t hash = structure_hash( s );
    visit_columns( s, add_hash, &hash );
    return hash;
}

uint64_t store_hash_entity( const store* s, const store_entity* e, store_mask excluded )
{
    uint64_t hash = store_hash_bytes( 0, &e->components, sizeof( e->components ) );
    hash = store_hash_bytes( hash, &e->requests, sizeof( e->requests ) );
    excluded = store_mask_or( excluded, s->transient );
    for ( int c = 1; c < s->component_count; ++c )
    {
        const wisp_component_def* def = &s->components[c].def;
        for ( int k = 0; k < def->column_count && store_mask_has( &e->components, c ); ++k )
        {
            const size_t bytes = (size_t)e->rows[def->table].count * def->columns[k].row_size;
            hash = store_mask_has( &excluded, c )
                       ? hash
                       : store_hash_bytes( hash, store_column( s, e, (wisp_component)c, k ), bytes );
        }
    }
    return hash;
}
