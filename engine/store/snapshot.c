// Snapshot, restore and hash walk the components' column lists, so none can forget a column.
#include "store.h"

#include "wisp/module/definition.h"

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

static bool is_held( const store* s, const store_entity* e, int c )
{
    return store_mask_has( &e->components, c ) && store_mask_has( &s->transient, c ) == false;
}

static size_t column_size( const store* s, const store_entity* e, int c, int k )
{
    const wisp_component_def* def = &s->components[c].def;
    return is_held( s, e, c ) ? (size_t)e->rows[def->table].count * def->columns[k].row_size : 0;
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
            for ( int k = 0; k < s->components[c].def.column_count && is_held( s, e, c ); ++k )
            {
                visit( context, store_column( s, e, (wisp_component)c, k ), column_size( s, e, c, k ) );
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

// ---- ranges ----

// An entity in a snapshot. Its columns follow each other as visit_columns() has them.
typedef struct snapshot_entity
{
    const store* s;
    const store_entity* e;
    const char* columns;
} snapshot_entity;

// @param component that the entity has; behind the last one for the end of the columns
static const char* find_column( const snapshot_entity* in, int component, int column )
{
    const char* at = in->columns;
    for ( int c = 1; c <= component && c < in->s->component_count; ++c )
    {
        const int count = c < component ? in->s->components[c].def.column_count : column;
        for ( int k = 0; k < count; ++k )
        {
            at += column_size( in->s, in->e, c, k );
        }
    }
    return at;
}

// @return null for no handle of a surface. @param is_null receives whether the handle names nothing
static const store_entity* find_surface( const store* s, const char* handle, bool* is_null )
{
    wisp_entity entity;
    memcpy( &entity, handle, sizeof( entity ) );
    *is_null = entity.index == 0;
    const store_entity* e = store_find( s, entity );
    return e != NULL && e->fabric != NULL ? e : NULL;
}

// The highest number that a row may have.
static int last_of( const snapshot_entity* in, const wisp_index_range* r, const char* row )
{
    if ( r->kind == WISP_INDEX_ROW || r->kind == WISP_INDEX_COUNT )
    {
        return in->e->rows[r->table].count - ( r->kind == WISP_INDEX_ROW ? 1 : 0 );
    }
    if ( r->kind == WISP_INDEX_TRIANGLE )
    {
        bool is_null;
        const char* handle = r->surface != 0 ? find_column( in, r->surface, 0 ) : row;
        const store_entity* surface = find_surface( in->s, handle, &is_null );
        return surface != NULL ? surface->rows[WISP_TABLE_TRIANGLE].count - 1 : is_null ? INT32_MAX : -1;
    }
    return r->highest;
}

static wisp_status check_row( const snapshot_entity* in, const wisp_index_range* r, int row, const char* bytes,
                              wisp_error* error )
{
    const wisp_component_def* def = &in->s->components[r->component].def;
    const char* name = def->columns[r->column].name;
    const int number = (int)( in->e - in->s->entities ) + 1;
    if ( r->kind == WISP_INDEX_SURFACE )
    {
        bool is_null;
        const store_entity* surface = find_surface( in->s, bytes + r->offset, &is_null );
        return is_null || ( surface != NULL && surface != in->e )
                   ? WISP_OK
                   : wisp_fail( error, WISP_BAD_INPUT,
                                "snapshot: entity %d, %s, column '%s', row %d: got no other surface", number,
                                def->name, name, row );
    }
    int lowest = r->lowest, last = last_of( in, r, bytes );
    const char* here = store_column( in->s, in->e, r->component, r->column );
    here += (size_t)row * def->columns[r->column].row_size + r->offset;
    const size_t left = ( def->columns[r->column].row_size - r->offset ) / sizeof( int32_t );
    const size_t count = r->count > 0 ? (size_t)r->count : left;
    for ( size_t i = 0; i < count; ++i )
    {
        int32_t value;
        memcpy( &value, bytes + r->offset + i * sizeof( value ), sizeof( value ) );
        if ( r->kind == WISP_INDEX_SAME )
        {
            memcpy( &lowest, here + i * sizeof( lowest ), sizeof( lowest ) );
            last = lowest;
        }
        if ( value < lowest || value > last )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "snapshot: entity %d, %s, column '%s', row %d: got %d, expected %d to %d", number,
                              def->name, name, row, value, lowest, last );
        }
    }
    return WISP_OK;
}

static wisp_status check_entity( const snapshot_entity* in, wisp_error* error )
{
    for ( const wisp_index_range* r = in->s->ranges; r < in->s->ranges + in->s->range_count; ++r )
    {
        const size_t size = column_size( in->s, in->e, r->component, r->column );
        const size_t row_size = in->s->components[r->component].def.columns[r->column].row_size;
        const char* rows = size > 0 ? find_column( in, r->component, r->column ) : NULL;
        for ( size_t row = 0; row < size / row_size; ++row )
        {
            WISP_TRY( check_row( in, r, (int)row, rows + row * row_size, error ) );
        }
    }
    return WISP_OK;
}

// Whoever writes a snapshot can compute its hash, so what is used as an index is checked.
static wisp_status check_ranges( const store* s, const char* content, wisp_error* error )
{
    for ( int i = 0; i < s->entity_count; ++i )
    {
        const store_entity* e = s->entities + i;
        if ( e->alive )
        {
            uint64_t halted;
            memcpy( &halted, content + sizeof( e->dirty ), sizeof( halted ) );
            if ( halted > 1 )
            {
                return wisp_fail( error, WISP_BAD_INPUT, "snapshot: entity %d: got halted %llu, expected 0 or 1",
                                  i + 1, (unsigned long long)halted );
            }
            const snapshot_entity in = { s, e, content + sizeof( e->dirty ) + sizeof( e->halted ) };
            WISP_TRY( check_entity( &in, error ) );
            content = find_column( &in, s->component_count, 0 );
        }
    }
    return WISP_OK;
}

// ---- snapshots ----

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
    WISP_TRY( check_ranges( s, content, error ) );
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
