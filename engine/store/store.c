#include "store.h"

#include "alloc.h"

#include <string.h>

static const size_t STORE_ALIGNMENT = 64;

void store_init( store* s, const wisp_allocator* allocator )
{
    *s = ( store ){ .allocator = allocator, .component_count = 1, .structure = 1 };
}

// A table without rows still gives its columns an address.
static size_t column_bytes( const store* s, const store_component* c, int column )
{
    size_t bytes = (size_t)s->row_capacity[c->def.table] * c->def.columns[column].row_size;
    return bytes > 0 ? bytes : STORE_ALIGNMENT;
}

static void release_columns( store* s, store_component* c )
{
    for ( int k = 0; k < c->def.column_count; ++k )
    {
        base_release( s->allocator, c->columns[k], column_bytes( s, c, k ) );
        c->columns[k] = NULL;
    }
}

void store_release( store* s )
{
    for ( int i = 1; i < s->component_count; ++i )
    {
        release_columns( s, s->components + i );
    }
    base_release( s->allocator, s->entities, (size_t)s->entity_capacity * sizeof( store_entity ) );
    *s = ( store ){ 0 };
}

static bool same_shape( const wisp_component_def* a, const wisp_component_def* b )
{
    if ( a->table != b->table || a->column_count != b->column_count )
    {
        return false;
    }
    for ( int k = 0; k < a->column_count; ++k )
    {
        if ( strcmp( a->columns[k].name, b->columns[k].name ) != 0 ||
             a->columns[k].row_size != b->columns[k].row_size )
        {
            return false;
        }
    }
    return true;
}

wisp_component store_declare( store* s, const wisp_component_def* def )
{
    for ( int i = 1; i < s->component_count; ++i )
    {
        if ( strcmp( s->components[i].def.name, def->name ) == 0 )
        {
            return same_shape( &s->components[i].def, def ) ? (wisp_component)i : 0;
        }
    }
    if ( s->component_count == STORE_MAX_COMPONENTS || def->column_count > STORE_MAX_COLUMNS )
    {
        return 0;
    }
    s->components[s->component_count] = ( store_component ){ .def = *def };
    return (wisp_component)s->component_count++;
}

bool store_declare_ranges( store* s, const wisp_index_range* ranges, int count )
{
    if ( count > STORE_MAX_RANGES - s->range_count )
    {
        return false;
    }
    memcpy( s->ranges + s->range_count, ranges, (size_t)count * sizeof( *ranges ) );
    s->range_count += count;
    return true;
}

store_entity* store_find( const store* s, wisp_entity entity )
{
    if ( entity.index == 0 || entity.index > (uint32_t)s->entity_count )
    {
        return NULL;
    }
    store_entity* e = s->entities + entity.index - 1;
    return e->alive && e->generation == entity.generation ? e : NULL;
}

wisp_entity store_handle( const store* s, int slot )
{
    return ( wisp_entity ){ (uint32_t)slot + 1, s->entities[slot].generation };
}

// A slot to reuse, or a new one; -1 without memory.
static int find_slot( store* s )
{
    for ( int i = 0; i < s->entity_count && s->dead_count > 0; ++i )
    {
        if ( s->entities[i].alive == false )
        {
            s->dead_count -= 1;
            return i;
        }
    }
    if ( s->entity_count == s->entity_capacity )
    {
        int capacity = s->entity_capacity < 8 ? 8 : s->entity_capacity / 4 * 5 + 2;
        store_entity* grown =
            base_allocate( s->allocator, (size_t)capacity * sizeof( store_entity ), STORE_ALIGNMENT );
        if ( grown == NULL )
        {
            return -1;
        }
        memset( grown, 0, (size_t)capacity * sizeof( store_entity ) );
        if ( s->entity_count > 0 )
        {
            memcpy( grown, s->entities, (size_t)s->entity_count * sizeof( store_entity ) );
        }
        base_release( s->allocator, s->entities, (size_t)s->entity_capacity * sizeof( store_entity ) );
        s->entities = grown;
        s->entity_capacity = capacity;
    }
    return s->entity_count++;
}

// Make room for `rows` in a table. All of its columns move together or none does.
static bool grow_table( store* s, wisp_table table, int rows )
{
    if ( rows <= s->row_capacity[table] )
    {
        return true;
    }
    const int64_t more = (int64_t)s->row_capacity[table] / 4 * 5;
    const int most = more < INT32_MAX ? (int)more : INT32_MAX, capacity = rows > most ? rows : most;
    void* grown[STORE_MAX_COMPONENTS][STORE_MAX_COLUMNS] = { { NULL } };
    bool complete = true;
    for ( int i = 1; i < s->component_count && complete; ++i )
    {
        const store_component* c = s->components + i;
        for ( int k = 0; k < c->def.column_count && complete; ++k )
        {
            if ( c->def.table == table && c->columns[k] != NULL )
            {
                size_t bytes;
                complete = base_size_multiply( (size_t)capacity, c->def.columns[k].row_size, &bytes );
                grown[i][k] = complete ? base_allocate( s->allocator, bytes, STORE_ALIGNMENT ) : NULL;
                complete = grown[i][k] != NULL;
            }
        }
    }
    for ( int i = 1; i < s->component_count; ++i )
    {
        store_component* c = s->components + i;
        for ( int k = 0; k < c->def.column_count; ++k )
        {
            size_t row_size = c->def.columns[k].row_size;
            if ( grown[i][k] != NULL && complete )
            {
                size_t used = (size_t)s->row_count[table] * row_size;
                memcpy( grown[i][k], c->columns[k], used );
                memset( (char*)grown[i][k] + used, 0, (size_t)capacity * row_size - used );
                base_release( s->allocator, c->columns[k], column_bytes( s, c, k ) );
                c->columns[k] = grown[i][k];
            }
            else if ( grown[i][k] != NULL )
            {
                base_release( s->allocator, grown[i][k], (size_t)capacity * row_size );
            }
        }
    }
    s->row_capacity[table] = complete ? capacity : s->row_capacity[table];
    return complete;
}

bool store_add( store* s, const int row_counts[WISP_TABLE_COUNT], wisp_entity* out )
{
    for ( int t = 0; t < WISP_TABLE_COUNT; ++t )
    {
        if ( row_counts[t] > INT32_MAX - s->row_count[t] ||
             grow_table( s, (wisp_table)t, s->row_count[t] + row_counts[t] ) == false )
        {
            return false; // a table that grew keeps its room; nothing else changed
        }
    }
    int slot = find_slot( s );
    if ( slot < 0 )
    {
        return false;
    }
    store_entity* e = s->entities + slot;
    *e = ( store_entity ){ .generation = e->generation + 1, .alive = true, .dirty = store_mask_all() };
    for ( int t = 0; t < WISP_TABLE_COUNT; ++t )
    {
        e->rows[t] = ( store_rows ){ s->row_count[t], row_counts[t] };
        s->row_count[t] += row_counts[t];
    }
    s->structure += 1;
    *out = store_handle( s, slot );
    return true;
}

// Move the rows after a range down over it, and clear the vacated rows.
static void close_rows( store* s, wisp_table table, store_rows gap )
{
    for ( int i = 1; i < s->component_count; ++i )
    {
        store_component* c = s->components + i;
        for ( int k = 0; k < c->def.column_count; ++k )
        {
            if ( c->def.table != table || c->columns[k] == NULL )
            {
                continue;
            }
            size_t row_size = c->def.columns[k].row_size;
            char* data = c->columns[k];
            size_t behind = (size_t)( s->row_count[table] - gap.begin - gap.count );
            memmove( data + (size_t)gap.begin * row_size, data + (size_t)( gap.begin + gap.count ) * row_size,
                     behind * row_size );
            memset( data + (size_t)( s->row_count[table] - gap.count ) * row_size, 0, (size_t)gap.count * row_size );
        }
    }
    for ( int i = 0; i < s->entity_count; ++i )
    {
        store_rows* rows = s->entities[i].rows + table;
        rows->begin -= s->entities[i].alive && rows->begin > gap.begin ? gap.count : 0;
    }
    s->row_count[table] -= gap.count;
}

void store_remove( store* s, wisp_entity entity )
{
    store_entity* e = store_find( s, entity );
    WISP_ASSERT( e != NULL );
    for ( int i = 1; i < s->component_count; ++i )
    {
        store_detach( s, entity, (wisp_component)i );
    }
    for ( int t = 0; t < WISP_TABLE_COUNT; ++t )
    {
        close_rows( s, (wisp_table)t, e->rows[t] );
    }
    *e = ( store_entity ){ .generation = e->generation };
    s->dead_count += 1;
    s->structure += 1;
}

bool store_reserve_rows( store* s, const store_entity* e, wisp_table table, int count )
{
    const int others = s->row_count[table] - e->rows[table].count;
    return count <= INT32_MAX - others && grow_table( s, table, others + count );
}

void store_resize_rows( store* s, store_entity* e, wisp_table table, int count )
{
    const store_rows rows = e->rows[table];
    const int change = count - rows.count, end = rows.begin + rows.count, total = s->row_count[table];
    const int cleared = change < 0 ? total + change : end; // vacated at the end, or new
    for ( int i = 1; i < s->component_count; ++i )
    {
        const store_component* c = s->components + i;
        for ( int k = 0; k < c->def.column_count; ++k )
        {
            if ( c->def.table == table && c->columns[k] != NULL )
            {
                const size_t row_size = c->def.columns[k].row_size;
                char* data = c->columns[k];
                memmove( data + (size_t)( end + change ) * row_size, data + (size_t)end * row_size,
                         (size_t)( total - end ) * row_size );
                memset( data + (size_t)cleared * row_size, 0, (size_t)( change < 0 ? -change : change ) * row_size );
            }
        }
    }
    for ( int i = 0; i < s->entity_count; ++i )
    {
        store_entity* other = s->entities + i;
        other->rows[table].begin += other->alive && other != e && other->rows[table].begin >= end ? change : 0;
    }
    e->rows[table].count = count;
    s->row_count[table] += change;
    s->structure += 1;
}

static bool allocate_columns( store* s, store_component* c )
{
    for ( int k = 0; k < c->def.column_count; ++k )
    {
        size_t bytes = column_bytes( s, c, k );
        c->columns[k] = base_allocate( s->allocator, bytes, STORE_ALIGNMENT );
        if ( c->columns[k] == NULL )
        {
            release_columns( s, c );
            return false;
        }
        memset( c->columns[k], 0, bytes );
    }
    return true;
}

bool store_attach( store* s, wisp_entity entity, wisp_component component )
{
    store_entity* e = store_find( s, entity );
    store_component* c = s->components + component;
    WISP_ASSERT( e != NULL && component > 0 && component < s->component_count );
    if ( store_mask_has( &e->components, component ) )
    {
        return true;
    }
    if ( c->entity_count == 0 && allocate_columns( s, c ) == false )
    {
        return false;
    }
    c->entity_count += 1;
    store_mask_add( &e->components, component );
    // its rows are new and zero
    e->dirty = store_mask_or( e->dirty, store_mask_or( s->watchers[component], s->writers[component] ) );
    e->is_touched = true;
    s->structure += 1;
    return true;
}

void store_detach( store* s, wisp_entity entity, wisp_component component )
{
    store_entity* e = store_find( s, entity );
    store_component* c = s->components + component;
    WISP_ASSERT( e != NULL && component > 0 && component < s->component_count );
    if ( store_mask_has( &e->components, component ) == false )
    {
        return;
    }
    // rows of an entity without the component are zero, so that adding it again starts from zero
    for ( int k = 0; k < c->def.column_count; ++k )
    {
        size_t row_size = c->def.columns[k].row_size;
        const store_rows rows = e->rows[c->def.table];
        memset( (char*)c->columns[k] + (size_t)rows.begin * row_size, 0, (size_t)rows.count * row_size );
    }
    store_mask_remove( &e->components, component );
    store_mask_remove( &e->requests, component );
    store_mask_remove( &e->derived, component );
    e->is_touched = true;
    c->entity_count -= 1;
    if ( c->entity_count == 0 )
    {
        release_columns( s, c );
    }
    s->structure += 1;
}

size_t store_memory( const store* s, wisp_component component, size_t* used )
{
    const store_component* c = s->components + component;
    size_t row_size = 0, bytes = 0;
    *used = 0;
    if ( c->entity_count == 0 )
    {
        return 0;
    }
    for ( int k = 0; k < c->def.column_count; ++k )
    {
        row_size += c->def.columns[k].row_size;
        bytes += column_bytes( s, c, k );
    }
    for ( int i = 0; i < s->entity_count; ++i )
    {
        const store_entity* e = s->entities + i;
        *used += store_mask_has( &e->components, component ) ? row_size * (size_t)e->rows[c->def.table].count : 0;
    }
    return bytes;
}

void* store_column( const store* s, const store_entity* e, wisp_component component, int column )
{
    if ( store_mask_has( &e->components, component ) == false || component == 0 )
    {
        return NULL;
    }
    const store_component* c = s->components + component;
    WISP_ASSERT( column >= 0 && column < c->def.column_count );
    return (char*)c->columns[column] + (size_t)e->rows[c->def.table].begin * c->def.columns[column].row_size;
}
