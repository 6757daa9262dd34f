// Surfaces: the particles of a triangle mesh, their pins, and properties that all effects share.
#include "world.h"

#include "alloc.h"
#include "fabric_parts.h"

#include "wisp/module/anchor.h"
#include "wisp/module/components.h"
#include "wisp/module/vec.h"
#include <math.h>
#include <string.h>

// ---- triangles ----

// Other triangles of a surface. In: triangles by slot, and which vertices are copies. Out: a fabric of its own, and columns that fit it.

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
static bool move_rows( store* s, store_entity* e, table_change changes[TABLES] )
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
    for ( int slot = 0; slot < e->fabric->vertex_count; ++slot )
    {
        float* inverse_mass = position + 4 * (size_t)slot + 3;
        if ( *inverse_mass > 0.0f && e->fabric->area[slot] != area_before[slot] )
        {
            *inverse_mass = world_inverse_mass( world, e, slot );
        }
    }
}

// ---- the change ----

static wisp_status out_of_memory( wisp_world* world, wisp_entity surface )
{
    return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for other triangles of entity %u", surface.index );
}

static wisp_status move_rows_of_edges( wisp_world* world, wisp_entity surface, store_entity* e, wisp_fabric* to,
                                       const int32_t* parents )
{
    fabric_origins origins;
    if ( wisp_fabric_need( e->fabric, WISP_FABRIC_EDGES | WISP_FABRIC_HINGES ) != WISP_OK ||
         fabric_find_origins( e->fabric, to, parents, &world->allocator, &origins ) == false )
    {
        return out_of_memory( world, surface );
    }
    table_change changes[TABLES] = {
        { .table = WISP_TABLE_EDGE, .count = to->edge_count, .origins = origins.edges },
        { .table = WISP_TABLE_LINK, .count = to->link_order.slot_count, .origins = origins.links },
        { .table = WISP_TABLE_HINGE, .count = to->hinge_order.slot_count, .origins = origins.hinges },
    };
    const bool done = move_rows( &world->store, e, changes );
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
    store_entity* e = store_find( &world->store, surface );
    wisp_fabric *from = (wisp_fabric*)(void*)e->fabric, *to;
    wisp_error error = { 0 };
    wisp_status status = fabric_change_triangles( from, triangles, parents, &world->allocator, &to, &error );
    if ( status != WISP_OK )
    {
        return wisp_world_fail( world, status, "%s", error.message );
    }
    int copies = 0;
    const bool keeps_points = world->blend.structure == world->store.structure;
    status = move_rows_of_edges( world, surface, e, to, parents );
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

// ---- surfaces ----

static const wisp_field SURFACE_FIELDS[] = {
    WISP_FIELD( wisp_surface_def, area_density, WISP_FIELD_NUMBER, 1e-12, 1e12, 0, "kg/m^2", 0.15 ),
    WISP_NUMBER_OR( wisp_surface_def, vertex_mass, 0, 1e-12, 1e12, "kg" ),
    WISP_VECTOR( wisp_surface_def, gravity, 0, 1e6, "m/s^2", 0, -9.81, 0 ),
};
WISP_DEFINE( surface_def, "surface", SURFACE_FIELDS )

// ---- a new surface ----

static wisp_status check_vertices( wisp_world* world, const wisp_fabric* fabric, const int32_t* vertices, int count )
{
    if ( count < 0 || ( count > 0 && vertices == NULL ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "got %d vertices, but the list is null", count );
    }
    for ( int i = 0; i < count; ++i )
    {
        if ( vertices[i] < 0 || vertices[i] >= fabric->vertex_count )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT, "pin %d: got vertex %d, but the surface has %d vertices",
                                    i, vertices[i], fabric->vertex_count );
        }
    }
    return WISP_OK;
}

static wisp_status check_vertex_places( wisp_world* world, const wisp_vec3* points, int count, const char* what )
{
    for ( int v = 0; points != NULL && v < count; ++v )
    {
        const wisp_vec3 p = points[v];
        if ( !( fabsf( p.x ) <= 1e6f && fabsf( p.y ) <= 1e6f && fabsf( p.z ) <= 1e6f ) )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "%s %d: got (%g, %g, %g), expected finite coordinates within 1e6 m of the origin",
                                    what, v, (double)p.x, (double)p.y, (double)p.z );
        }
    }
    return WISP_OK;
}

static wisp_status check_surface( wisp_world* world, const wisp_surface_def* def )
{
    if ( def->fabric == NULL )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "surface: got no fabric" );
    }
    if ( def->vertex_mass == 0.0f && def->area_density == 0.0f )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "surface: area_density: got 0, expected 1e-12 to 1e12 kg/m^2" );
    }
    WISP_TRY( check_vertices( world, def->fabric, def->pins, def->pin_count ) );
    return check_vertex_places( world, def->points, def->fabric->vertex_count, "vertex" );
}

// Inverse mass of a vertex that is not pinned, 1/kg; 0 if it has no mass.
static float inverse_mass( const wisp_fabric* fabric, int slot, float area_density, float vertex_mass )
{
    float mass = vertex_mass > 0.0f ? vertex_mass : area_density * fabric->area[slot];
    return mass > 0.0f ? 1.0f / mass : 0.0f;
}

float world_inverse_mass( wisp_world* world, const store_entity* surface, int slot )
{
    const float density = *(float*)store_column( &world->store, surface, WISP_PARTICLE_MASS, 0 );
    const float vertex_mass = *(float*)store_column( &world->store, surface, WISP_PARTICLE_MASS, 1 );
    const float* map = store_column( &world->store, surface, WISP_MAP_AREA_DENSITY, 0 );
    const float factor = map != NULL ? map[slot] : 1.0f;
    return inverse_mass( surface->fabric, slot, factor * density, factor * vertex_mass );
}

static wisp_status add_surface_entity( wisp_world* world, const wisp_surface_def* def, wisp_entity* out )
{
    wisp_fabric* fabric = def->fabric;
    const bool has_gravity = wisp_v3_length( def->gravity ) > 0.0f;
    const wisp_fabric_level none = { 0 };
    const wisp_fabric_level* coarsest = fabric->level_count > 0 ? fabric->levels + fabric->level_count - 1 : &none;
    const int rows[WISP_TABLE_COUNT] = {
        [WISP_TABLE_ENTITY] = 1,
        [WISP_TABLE_POINT] = fabric->vertex_count,
        [WISP_TABLE_PARTICLE] = fabric->slot_count,
        [WISP_TABLE_LINK] = fabric->link_order.slot_count,
        [WISP_TABLE_HINGE] = fabric->hinge_order.slot_count,
        [WISP_TABLE_EDGE] = fabric->edge_count,
        [WISP_TABLE_TRIANGLE] = fabric->triangle_count,
        [WISP_TABLE_LEVEL_ROW] = coarsest->first_row + coarsest->row_count,
        [WISP_TABLE_LEVEL_LINK] = coarsest->first_link + coarsest->schedule.slot_count,
        [WISP_TABLE_COARSEST_ROW] = coarsest->row_count,
    };
    wisp_entity entity;
    if ( store_add( &world->store, rows, &entity ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for a surface of %d vertices",
                                fabric->vertex_count );
    }
    const wisp_component_use given[] = { { WISP_PARTICLE_POSITION, true },
                                         { WISP_PARTICLE_VELOCITY, true },
                                         { WISP_SURFACE_POINTS, true },
                                         { WISP_PARTICLE_MASS, true },
                                         { WISP_PARTICLE_GRAVITY, has_gravity } };
    const wisp_status status = wisp_world_set_components( world, entity, given, WISP_COUNT( given ) );
    if ( status != WISP_OK )
    {
        store_remove( &world->store, entity );
        return status;
    }
    wisp_fabric_retain( fabric );
    store_entity* e = store_find( &world->store, entity );
    e->fabric = fabric;
    if ( has_gravity )
    {
        *(wisp_vec3*)store_column( &world->store, e, WISP_PARTICLE_GRAVITY, 0 ) = def->gravity;
    }
    *out = entity;
    return WISP_OK;
}

static int fill_particles( wisp_world* world, wisp_entity entity, const wisp_surface_def* def )
{
    const wisp_fabric* fabric = def->fabric;
    const store_entity* e = store_find( &world->store, entity );
    float* position = store_column( &world->store, e, WISP_PARTICLE_POSITION, 0 );
    wisp_vec3* points = store_column( &world->store, e, WISP_SURFACE_POINTS, 0 );
    float* density = store_column( &world->store, e, WISP_PARTICLE_MASS, 0 );
    float* vertex_mass = store_column( &world->store, e, WISP_PARTICLE_MASS, 1 );
    *density = def->area_density;
    *vertex_mass = def->vertex_mass;
    int weightless = 0;
    for ( int slot = 0; slot < fabric->slot_count; ++slot )
    {
        int vertex = fabric->slot_vertex[slot];
        const wisp_vec3 p = vertex >= 0 && def->points != NULL ? def->points[vertex] : fabric->rest[slot];
        float w = vertex >= 0 ? inverse_mass( fabric, slot, def->area_density, def->vertex_mass ) : 0.0f;
        weightless += vertex >= 0 && vertex < fabric->vertex_count - def->spare_count && w == 0.0f ? 1 : 0;
        float* to = position + (size_t)slot * 4;
        to[0] = p.x;
        to[1] = p.y;
        to[2] = p.z;
        to[3] = w;
        if ( vertex >= 0 )
        {
            points[vertex] = p;
        }
    }
    for ( int i = 0; i < def->pin_count; ++i )
    {
        position[(size_t)fabric->vertex_slot[def->pins[i]] * 4 + 3] = 0.0f;
    }
    return weightless;
}

wisp_status wisp_add_surface( wisp_world* world, const wisp_surface_def* given, wisp_entity* out )
{
    if ( out != NULL )
    {
        *out = ( wisp_entity ){ 0, 0 };
    }
    wisp_surface_def values;
    const wisp_surface_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, NULL, &wisp_surface_def_fields, &values, given ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    WISP_TRY( check_surface( world, def ) );
    WISP_TRY( add_surface_entity( world, def, out ) );
    int weightless = fill_particles( world, *out, def );
    if ( weightless > 0 )
    {
        base_log_write( &world->log, WISP_LOG_WARNING,
                        "entity %u: %d vertices belong to no triangle and have no mass, so they are pinned",
                        out->index, weightless );
    }
    return WISP_OK;
}

// An instance has the masses of its source.
static wisp_status copy_mass_map( wisp_world* world, wisp_entity source, wisp_entity to )
{
    const store_entity* from = store_find( &world->store, source );
    if ( store_mask_has( &from->components, WISP_MAP_AREA_DENSITY ) == false )
    {
        return WISP_OK;
    }
    WISP_TRY( wisp_world_attach( world, to, WISP_MAP_AREA_DENSITY ) );
    const store_entity* e = store_find( &world->store, to );
    memcpy( store_column( &world->store, e, WISP_MAP_AREA_DENSITY, 0 ),
            store_column( &world->store, store_find( &world->store, source ), WISP_MAP_AREA_DENSITY, 0 ),
            (size_t)e->fabric->slot_count * sizeof( float ) );
    float* position = store_column( &world->store, e, WISP_PARTICLE_POSITION, 0 );
    for ( int slot = 0; slot < e->fabric->vertex_count; ++slot )
    {
        position[4 * (size_t)slot + 3] = world_inverse_mass( world, e, slot );
    }
    return WISP_OK;
}

wisp_status world_add_surface_instance( wisp_world* world, wisp_entity source_entity, wisp_entity* out )
{
    const store_entity* source = store_find( &world->store, source_entity );
    wisp_surface_def def = wisp_default_surface_def();
    def.fabric = (wisp_fabric*)(void*)source->fabric;
    def.area_density = *(float*)store_column( &world->store, source, WISP_PARTICLE_MASS, 0 );
    def.vertex_mass = *(float*)store_column( &world->store, source, WISP_PARTICLE_MASS, 1 );
    const wisp_vec3* gravity = store_column( &world->store, source, WISP_PARTICLE_GRAVITY, 0 );
    def.gravity = gravity != NULL ? *gravity : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    wisp_status status = wisp_add_surface( world, &def, out );
    if ( status == WISP_OK && copy_mass_map( world, source_entity, *out ) != WISP_OK )
    {
        wisp_world_remove( world, *out );
        *out = ( wisp_entity ){ 0, 0 };
        status = WISP_NO_MEMORY;
    }
    return status;
}

// ---- pins ----

wisp_status world_find_surface( wisp_world* world, wisp_entity entity, store_entity** out )
{
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    *out = store_find( &world->store, entity );
    if ( ( *out )->fabric == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "entity %u: is not a surface%s", entity.index,
                                ( *out )->strands != NULL ? ": it has strands" : "" );
    }
    return WISP_OK;
}

void wisp_world_share_samples( wisp_world* world, wisp_entity surface, const struct wisp_samples* samples )
{
    store_entity* e = store_find( &world->store, surface );
    if ( e != NULL )
    {
        e->samples = samples;
    }
}

void wisp_world_restart_levels( wisp_world* world, wisp_entity surface )
{
    int32_t* state = wisp_world_column( world, surface, WISP_SURFACE_LEVELS, 2 );
    if ( state != NULL )
    {
        *state = 0;
    }
}

static wisp_status set_pinned( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count,
                               bool pinned )
{
    store_entity* e;
    WISP_TRY( world_find_surface( world, surface, &e ) );
    WISP_TRY( wisp_world_check_list( world, "vertices", vertices, count ) );
    WISP_TRY( check_vertices( world, e->fabric, vertices, count ) );
    float* position = store_column( &world->store, e, WISP_PARTICLE_POSITION, 0 );
    float* velocity = store_column( &world->store, e, WISP_PARTICLE_VELOCITY, 0 );
    float* target = store_column( &world->store, e, WISP_PARTICLE_TARGET, 0 );
    for ( int i = 0; i < count; ++i )
    {
        int slot = e->fabric->vertex_slot[vertices[i]];
        position[(size_t)slot * 4 + 3] = pinned ? 0.0f : world_inverse_mass( world, e, slot );
        if ( pinned )
        {
            memset( velocity + (size_t)slot * 4, 0, 4 * sizeof( float ) );
        }
        if ( target != NULL )
        {
            target[(size_t)slot * 4 + 3] = 0.0f;
        }
    }
    store_touch( &world->store, e, WISP_PARTICLE_POSITION );
    wisp_world_restart_levels( world, surface );
    return WISP_OK;
}

wisp_status wisp_pin( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count )
{
    return set_pinned( world, surface, vertices, count, true );
}

wisp_status wisp_unpin( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count )
{
    return set_pinned( world, surface, vertices, count, false );
}

static wisp_status check_pinned( wisp_world* world, const store_entity* e, const int32_t* vertices, int count )
{
    const float* position = store_column( &world->store, e, WISP_PARTICLE_POSITION, 0 );
    for ( int i = 0; i < count; ++i )
    {
        if ( position[(size_t)e->fabric->vertex_slot[vertices[i]] * 4 + 3] != 0.0f )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT, "vertex %d: is not pinned, so it cannot be moved",
                                    vertices[i] );
        }
    }
    return WISP_OK;
}

wisp_status wisp_move_pins( wisp_world* world, wisp_entity surface, const int32_t* vertices, const wisp_vec3* targets,
                            int count )
{
    store_entity* e;
    WISP_TRY( world_find_surface( world, surface, &e ) );
    WISP_TRY( wisp_world_check_list( world, "vertices", vertices, count ) );
    WISP_TRY( wisp_world_check_list( world, "targets", targets, count ) );
    WISP_TRY( check_vertices( world, e->fabric, vertices, count ) );
    WISP_TRY( check_vertex_places( world, targets, count, "target" ) );
    WISP_TRY( check_pinned( world, e, vertices, count ) );
    WISP_TRY( wisp_world_attach( world, surface, WISP_PARTICLE_TARGET ) );
    float* target = wisp_world_column( world, surface, WISP_PARTICLE_TARGET, 0 );
    for ( int i = 0; i < count; ++i )
    {
        float* to = target + (size_t)e->fabric->vertex_slot[vertices[i]] * 4;
        const wisp_vec3 p = wisp_to_rows( targets[i], e->offset );
        to[0] = p.x;
        to[1] = p.y;
        to[2] = p.z;
        to[3] = 1.0f;
    }
    return WISP_OK;
}

// ---- properties of all effects ----

wisp_status wisp_set_gravity( wisp_world* world, wisp_entity surface, wisp_vec3 gravity )
{
    store_entity* e;
    WISP_TRY( world_find_surface( world, surface, &e ) );
    WISP_TRY( wisp_world_check_values( world, &wisp_surface_def_fields, "gravity", &gravity, 1, NULL ) );
    return wisp_world_set_row( world, surface, WISP_PARTICLE_GRAVITY,
                               wisp_v3_length( gravity ) > 0.0f ? &gravity : NULL, sizeof( gravity ) );
}

wisp_status wisp_set_damping( wisp_world* world, wisp_entity surface, float rate )
{
    store_entity* e;
    WISP_TRY( world_find_surface( world, surface, &e ) );
    if ( !( rate >= 0.0f && rate <= 1e9f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "damping: got %g 1/s, expected 0 to 1e9", (double)rate );
    }
    return wisp_world_set_row( world, surface, WISP_PARTICLE_DAMPING, rate > 0.0f ? &rate : NULL, sizeof( rate ) );
}

wisp_status wisp_set_strain_limit( wisp_world* world, wisp_entity surface, float minimum, float maximum )
{
    store_entity* e;
    WISP_TRY( world_find_surface( world, surface, &e ) );
    if ( !( minimum >= 0.0f && minimum <= 1.0f && maximum >= 1.0f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strain limits: got %g and %g times the rest length, expected 0 to 1 and at least 1",
                                (double)minimum, (double)maximum );
    }
    bool requested = minimum > 0.0f || maximum < INFINITY;
    if ( requested && wisp_world_has( world, surface, WISP_PARTICLE_EXTERNAL_SOLVER ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT,
                                "entity %u: has an external solver, which does not support strain limits",
                                surface.index );
    }
    WISP_TRY( wisp_world_set_row( world, surface, WISP_LINK_LIMIT, requested ? &minimum : NULL, sizeof( minimum ) ) );
    float* column = wisp_world_column( world, surface, WISP_LINK_LIMIT, 1 );
    if ( column != NULL )
    {
        *column = maximum;
    }
    return WISP_OK;
}

// ---- reading ----

wisp_status wisp_read_motion_stats( wisp_world* world, wisp_entity entity, wisp_motion_stats* out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    const store_entity* e = store_find( &world->store, entity );
    const wisp_motion_stats* column = store_column( &world->store, e, WISP_MOTION_STATS, 0 );
    if ( column == NULL || store_mask_has( &e->requests, WISP_MOTION_STATS ) == false )
    {
        return wisp_world_fail( world, WISP_CONFLICT,
                                "entity %u: has no statistics, request them with wisp_request first", entity.index );
    }
    *out = *column;
    return WISP_OK;
}

bool wisp_is_halted( const wisp_world* world, wisp_entity entity )
{
    const store_entity* e = world != NULL ? store_find( &world->store, entity ) : NULL;
    return e != NULL && e->halted != 0;
}

wisp_status wisp_resume( wisp_world* world, wisp_entity entity )
{
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    store_entity* e = store_find( &world->store, entity );
    e->halted = 0;
    return WISP_OK;
}

const wisp_fabric* wisp_world_fabric( wisp_world* world, wisp_entity entity )
{
    const store_entity* e = store_find( &world->store, entity );
    return e != NULL ? e->fabric : NULL;
}

wisp_status wisp_world_need_fabric( wisp_world* world, wisp_entity surface, unsigned arrays )
{
    const wisp_fabric* fabric = wisp_world_fabric( world, surface );
    return fabric == NULL || wisp_fabric_need( fabric, arrays ) == WISP_OK
               ? WISP_OK
               : wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for the topology of entity %u",
                                  surface.index );
}

wisp_status wisp_world_build_mesh( wisp_world* world, wisp_entity surface, wisp_collision_mesh** out )
{
    const store_entity* e = store_find( &world->store, surface );
    const wisp_fabric* f = e->fabric;
    if ( f == NULL || f->triangle_count == 0 )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "entity %u is not a surface with triangles", surface.index );
    }
    const float* position = store_column( &world->store, e, WISP_PARTICLE_POSITION, 0 );
    const size_t bytes = (size_t)f->slot_count * sizeof( wisp_vec3 );
    wisp_vec3* points = base_allocate( &world->allocator, bytes, BASE_BUFFER_ALIGNMENT );
    for ( int slot = 0; points != NULL && slot < f->slot_count; ++slot )
    {
        points[slot] = wisp_v3_load( position + (size_t)slot * 4 );
    }
    // a mesh that deforms needs no Embree
    const wisp_collision_mesh_def def = { .points = points,
                                          .triangles = f->triangles,
                                          .point_count = f->slot_count,
                                          .triangle_count = f->triangle_count,
                                          .deforms = true };
    wisp_error error = { .message = "out of memory" };
    const wisp_status status =
        points != NULL ? wisp_collision_mesh_create( &def, &world->allocator, out, &error ) : WISP_NO_MEMORY;
    base_release( &world->allocator, points, bytes );
    return status == WISP_OK ? WISP_OK
                             : wisp_world_fail( world, status, "entity %u: %s", surface.index, error.message );
}

// ---- lengths at rest ----

typedef struct length_sum
{
    double sum, shortest, longest; // m
    int count;
} length_sum;

// Add the distance of two points whose coordinates are `stride` apart, unless they coincide.
static void add_length( length_sum* s, const float* a, const float* b, size_t stride )
{
    double squared = 0.0;
    for ( size_t k = 0; k < 3; ++k )
    {
        const double d = (double)a[k * stride] - (double)b[k * stride];
        squared += d * d;
    }
    const double length = sqrt( squared );
    if ( length > 0.0 )
    {
        s->sum += length;
        s->shortest = s->count == 0 || length < s->shortest ? length : s->shortest;
        s->longest = length > s->longest ? length : s->longest;
        s->count += 1;
    }
}

static void add_segments( length_sum* s, const wisp_strand_topology* strands, const float* rest )
{
    for ( int lane = 0; lane < strands->group_count * WISP_LANES; ++lane )
    {
        const float* x = rest + (size_t)strands->group_row[lane / WISP_LANES] * 3 * WISP_LANES + lane % WISP_LANES;
        for ( int i = 1; i < strands->lane_count[lane]; ++i, x += 3 * WISP_LANES )
        {
            add_length( s, x, x + 3 * WISP_LANES, WISP_LANES );
        }
    }
}

wisp_rest_lengths wisp_world_rest_lengths( wisp_world* world, wisp_entity entity )
{
    length_sum s = { 0 };
    const store_entity* e = store_find( &world->store, entity );
    if ( e->strands != NULL )
    {
        add_segments( &s, wisp_world_strands( world, entity ),
                      store_column( &world->store, e, WISP_STRAND_REST, 0 ) );
    }
    const wisp_fabric* f = e->fabric;
    for ( int i = 0; f != NULL && i < f->link_order.slot_count; ++i )
    {
        if ( wisp_fabric_link_kind( f, i ) == 0 )
        {
            add_length( &s, &f->rest[f->link_a_x4[i] / 4].x, &f->rest[f->link_b_x4[i] / 4].x, 1 );
        }
    }
    return ( wisp_rest_lengths ){ s.count > 0 ? (float)( s.sum / s.count ) : 0.0f, (float)s.shortest,
                                  (float)s.longest };
}
