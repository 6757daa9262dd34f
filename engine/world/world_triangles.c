// Other triangles of a surface. In: triangles by slot, and which vertices are copies. Out: a fabric of its own, and columns that fit it.
#include "world_blend.h"

#include "alloc.h"
#include "fabric_triangles.h"
#include "wisp/module/components.h"

#include <string.h>

// ---- rows of edges, links and hinges ----

// Rows of one table, copied before they move.
typedef struct kept_rows
{
    char* data;
    size_t bytes;
} kept_rows;

static size_t triangle_row_bytes( const store_component* c )
{
    size_t bytes = 0;
    for ( int k = 0; k < c->def.column_count; ++k )
    {
        bytes += c->def.columns[k].row_size;
    }
    return bytes;
}

static bool is_held( const store* s, const store_entity* e, int component, wisp_table table )
{
    return s->components[component].def.table == table && store_mask_has( &e->components, component );
}

// Column after column of the components of a table that the entity has.
static bool keep_rows( const store* s, const store_entity* e, wisp_table table, kept_rows* out )
{
    const size_t rows = (size_t)e->rows[table].count;
    out->bytes = 0;
    for ( int c = 1; c < s->component_count; ++c )
    {
        out->bytes += is_held( s, e, c, table ) ? rows * triangle_row_bytes( s->components + c ) : 0;
    }
    out->data = out->bytes > 0 ? base_allocate( s->allocator, out->bytes, BASE_BUFFER_ALIGNMENT ) : NULL;
    if ( out->data == NULL )
    {
        return out->bytes == 0;
    }
    char* cursor = out->data;
    for ( int c = 1; c < s->component_count; ++c )
    {
        for ( int k = 0; k < s->components[c].def.column_count && is_held( s, e, c, table ); ++k )
        {
            const size_t bytes = rows * s->components[c].def.columns[k].row_size;
            memcpy( cursor, store_column( s, e, (wisp_component)c, k ), bytes );
            cursor += bytes;
        }
    }
    return true;
}

// @param origins [rows now] row among those that were kept, -1: zero
static void put_rows( const store* s, const store_entity* e, wisp_table table, const kept_rows* kept, int kept_count,
                      const int32_t* origins )
{
    size_t first = 0; // byte of a column in what was kept
    for ( int c = 1; c < s->component_count; ++c )
    {
        for ( int k = 0; k < s->components[c].def.column_count && is_held( s, e, c, table ); ++k )
        {
            const size_t size = s->components[c].def.columns[k].row_size;
            char* to = store_column( s, e, (wisp_component)c, k );
            for ( int row = 0; row < e->rows[table].count; ++row )
            {
                if ( origins[row] >= 0 )
                {
                    memcpy( to + (size_t)row * size, kept->data + first + (size_t)origins[row] * size, size );
                }
                else
                {
                    memset( to + (size_t)row * size, 0, size );
                }
            }
            first += (size_t)kept_count * size;
        }
    }
}

enum
{
    TABLES = 3,
};

typedef struct table_change
{
    wisp_table table;
    int count_before, count;
    const int32_t* origins;
    kept_rows kept;
} table_change;

// @return false without memory: rows are as they were
static bool carry_rows( store* s, store_entity* e, table_change changes[TABLES] )
{
    bool done = true;
    for ( int t = 0; t < TABLES && done; ++t )
    {
        changes[t].count_before = e->rows[changes[t].table].count;
        done = store_reserve_rows( s, e, changes[t].table, changes[t].count ) &&
               keep_rows( s, e, changes[t].table, &changes[t].kept );
    }
    for ( int t = 0; t < TABLES && done; ++t )
    {
        store_resize_rows( s, e, changes[t].table, changes[t].count );
        put_rows( s, e, changes[t].table, &changes[t].kept, changes[t].count_before, changes[t].origins );
    }
    return done;
}

// ---- particles ----

static void copy_row( const store* s, const store_entity* e, wisp_table table, int from, int to )
{
    for ( int c = 1; c < s->component_count; ++c )
    {
        for ( int k = 0; k < s->components[c].def.column_count && is_held( s, e, c, table ); ++k )
        {
            const size_t size = s->components[c].def.columns[k].row_size;
            char* rows = store_column( s, e, (wisp_component)c, k );
            memcpy( rows + (size_t)to * size, rows + (size_t)from * size, size );
        }
    }
}

// A vertex that was in no triangle is a copy of its parent, in its slot and in the user's order.
static void copy_vertices( wisp_world* world, const store_entity* e, const int32_t* parents )
{
    const wisp_fabric* f = e->fabric;
    wisp_vec3* shown = world_kept_rows( world, e, WISP_SURFACE_POINTS );
    for ( int slot = 0; slot < f->vertex_count; ++slot )
    {
        const int parent = parents[slot];
        if ( parent != slot )
        {
            const int from = f->slot_vertex[parent], to = f->slot_vertex[slot];
            copy_row( &world->store, e, WISP_TABLE_PARTICLE, parent, slot );
            copy_row( &world->store, e, WISP_TABLE_POINT, from, to );
            if ( shown != NULL )
            {
                shown[to] = shown[from];
            }
        }
    }
}

static void update_masses( wisp_world* world, const store_entity* e, const float* area_before )
{
    float* position = store_column( &world->store, e, WISP_PARTICLE_POSITION, 0 );
    float* last_valid = store_column( &world->store, e, WISP_PARTICLE_LAST_VALID, 0 );
    for ( int slot = 0; slot < e->fabric->vertex_count; ++slot )
    {
        float* inverse_mass = position + 4 * (size_t)slot + 3;
        if ( *inverse_mass > 0.0f && e->fabric->area[slot] != area_before[slot] )
        {
            *inverse_mass = last_valid[4 * (size_t)slot + 3] = world_inverse_mass( world, e, slot );
        }
    }
}

// ---- the change ----

static wisp_status out_of_memory( wisp_world* world, wisp_entity surface )
{
    return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for other triangles of entity %u", surface.index );
}

static wisp_status carry( wisp_world* world, wisp_entity surface, store_entity* e, wisp_fabric* to,
                          const int32_t* parents )
{
    fabric_origins origins;
    if ( wisp_fabric_need( e->fabric, WISP_FABRIC_EDGES ) != WISP_OK ||
         fabric_find_origins( e->fabric, to, parents, &world->allocator, &origins ) == false )
    {
        return out_of_memory( world, surface );
    }
    table_change changes[TABLES] = {
        { .table = WISP_TABLE_EDGE, .count = to->edge_count, .origins = origins.edges },
        { .table = WISP_TABLE_LINK, .count = to->link_order.slot_count, .origins = origins.links },
        { .table = WISP_TABLE_HINGE, .count = to->hinge_order.slot_count, .origins = origins.hinges },
    };
    const bool done = carry_rows( &world->store, e, changes );
    for ( int t = 0; t < TABLES; ++t )
    {
        base_release( &world->allocator, changes[t].kept.data, changes[t].kept.bytes );
    }
    fabric_release_origins( &origins, &world->allocator );
    return done ? WISP_OK : out_of_memory( world, surface );
}

wisp_status wisp_world_change_triangles( wisp_world* world, wisp_entity surface, const int32_t* triangles,
                                         const int32_t* parents )
{
    store_entity* e;
    WISP_TRY( world_find_surface( world, surface, &e ) );
    wisp_fabric *from = (wisp_fabric*)(void*)e->fabric, *to;
    wisp_error error = { 0 };
    wisp_status status = fabric_change_triangles( from, triangles, parents, &world->allocator, &to, &error );
    if ( status != WISP_OK )
    {
        return wisp_world_fail( world, status, "%s", error.message );
    }
    int copies = 0;
    const bool keeps_points = world->blend.structure == world->store.structure;
    status = carry( world, surface, e, to, parents );
    if ( status != WISP_OK )
    {
        wisp_fabric_release( to );
        return status;
    }
    e->fabric = to;
    world->store.structure += 1;
    world->blend.structure = keeps_points ? world->store.structure : world->blend.structure; // rows of points stay
    copy_vertices( world, e, parents );
    update_masses( world, e, from->area );
    for ( int slot = 0; slot < to->vertex_count; ++slot )
    {
        copies += parents[slot] != slot ? 1 : 0;
    }
    wisp_frame_count( &world->frame, WISP_COUNT_SPLIT_VERTICES, (uint64_t)copies );
    e->dirty = store_mask_all();
    e->is_touched = true;
    if ( store_mask_has( &e->components, WISP_LINK_CONSTANT ) && world_list_map_edges( world, e ) == false )
    {
        status = out_of_memory( world, surface );
    }
    status = status == WISP_OK ? plan_registry_triangles_changed( &world->registry, world, surface, from ) : status;
    wisp_fabric_release( from );
    return status;
}

wisp_status wisp_read_triangles( wisp_world* world, wisp_entity surface, int32_t* out, int count )
{
    WISP_TRY( wisp_world_check_entity( world, surface ) );
    store_entity* e;
    WISP_TRY( world_find_surface( world, surface, &e ) );
    WISP_TRY( wisp_world_check_list( world, "out", out, count ) );
    if ( count != e->fabric->triangle_count )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "got room for %d triangles, but entity %u has %d", count,
                                surface.index, e->fabric->triangle_count );
    }
    for ( size_t i = 0; i < 3 * (size_t)count; ++i )
    {
        out[i] = e->fabric->slot_vertex[e->fabric->triangles[i]];
    }
    return WISP_OK;
}
