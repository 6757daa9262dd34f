// Lines of what a world holds, for a host's renderer. In: rows. Out: the lines alone. Modules add those of their own rows.
#include "world.h"

#include "wisp/module/vec.h"
#include "wisp/lines.h"
#include "wisp/module/components.h"

#include <limits.h>

static const float LARGE_STRAIN = 0.05f;
static const wisp_vec3 GREY = { 0.4f, 0.4f, 0.4f }, RED = { 1.0f, 0.0f, 0.0f }, BLUE = { 0.0f, 0.2f, 1.0f },
                       MAGENTA = { 1.0f, 0.0f, 1.0f };

struct wisp_line_list
{
    wisp_world* world;
    double origin[3];
    wisp_line* lines;
    int capacity, count;
};

void wisp_add_line( wisp_line_list* list, wisp_entity entity, wisp_vec3 from, wisp_vec3 to, wisp_vec3 colour )
{
    if ( list->count < list->capacity )
    {
        double at[3];
        store_row_origin( store_find( &list->world->store, entity ), at );
        const wisp_vec3 by = { (float)( at[0] - list->origin[0] ), (float)( at[1] - list->origin[1] ),
                               (float)( at[2] - list->origin[2] ) };
        list->lines[list->count] =
            ( wisp_line ){ { { wisp_v3_add( from, by ), colour }, { wisp_v3_add( to, by ), colour } } };
    }
    list->count += list->count < INT_MAX ? 1 : 0;
}

static void add_link_line( wisp_line_list* list, wisp_entity entity, wisp_vec3 from, wisp_vec3 to, float rest )
{
    const float strain = rest > 0.0f ? wisp_v3_length( wisp_v3_sub( to, from ) ) / rest - 1.0f : 0.0f;
    const float share = fminf( fabsf( strain ) / LARGE_STRAIN, 1.0f );
    const wisp_vec3 change = wisp_v3_sub( strain > 0.0f ? RED : BLUE, GREY );
    wisp_add_line( list, entity, from, to, wisp_v3_mul_add( GREY, share, change ) );
}

// @param weight 1/kg, inverse mass
static void add_pin_lines( wisp_line_list* list, wisp_entity entity, wisp_vec3 at, float weight, float size )
{
    const wisp_vec3 axes[] = { { size, 0.0f, 0.0f }, { 0.0f, size, 0.0f }, { 0.0f, 0.0f, size } };
    for ( int k = 0; k < 3 && weight == 0.0f; ++k )
    {
        wisp_add_line( list, entity, wisp_v3_sub( at, axes[k] ), wisp_v3_add( at, axes[k] ), MAGENTA );
    }
}

static void add_surface_lines( wisp_line_list* list, wisp_entity entity, const store_entity* e, bool links,
                               float size )
{
    const wisp_fabric* f = e->fabric;
    const float* rows = store_column( &list->world->store, e, WISP_PARTICLE_POSITION, 0 );
    for ( int i = 0; i < f->edge_count && links; ++i )
    {
        const int32_t a = f->edges[2 * i], b = f->edges[2 * i + 1];
        const float *p = rows + 4 * (size_t)a, *q = rows + 4 * (size_t)b;
        add_link_line( list, entity, wisp_v3_load( p ), wisp_v3_load( q ),
                       wisp_v3_length( wisp_v3_sub( f->rest[a], f->rest[b] ) ) );
    }
    for ( int v = 0; v < f->vertex_count && links == false; ++v )
    {
        const float* p = rows + 4 * (size_t)f->vertex_slot[v];
        add_pin_lines( list, entity, wisp_v3_load( p ), p[3], size );
    }
}

static void add_strand_lines( wisp_line_list* list, wisp_entity entity, const store_entity* e, bool links,
                              float size )
{
    const wisp_strand_topology* t = e->strands;
    const float* rows = store_column( &list->world->store, e, WISP_STRAND_POSITION, 0 );
    const float* lengths = store_column( &list->world->store, e, WISP_STRAND_LENGTH, 0 );
    const float* weights = store_column( &list->world->store, e, WISP_STRAND_INVERSE_MASS, 0 );
    for ( int i = 0; i < WISP_LANES * t->group_count; ++i )
    {
        wisp_vec3 last = { 0.0f, 0.0f, 0.0f };
        for ( int k = 0; k < t->lane_count[i]; ++k )
        {
            const size_t row = (size_t)( t->group_row[i / WISP_LANES] + k ), lane = (size_t)( i % WISP_LANES );
            const float* p = rows + 3 * WISP_LANES * row + lane;
            const wisp_vec3 at = { p[0], p[WISP_LANES], p[2 * WISP_LANES] };
            if ( links && k > 0 )
            {
                add_link_line( list, entity, last, at,
                               lengths != NULL ? lengths[WISP_LANES * ( row - 1 ) + lane] : 0.0f );
            }
            if ( links == false && weights != NULL )
            {
                add_pin_lines( list, entity, at, weights[WISP_LANES * row + lane], size );
            }
            last = at;
        }
    }
}

static void add_row_lines( wisp_line_list* list, wisp_entity entity, wisp_line_kind kind )
{
    const store_entity* e = store_find( &list->world->store, entity );
    const bool links = kind == WISP_LINES_LINKS;
    const float size = links ? 0.0f : 0.25f * wisp_world_rest_lengths( list->world, entity ).mean;
    if ( store_mask_has( &e->components, WISP_PARTICLE_POSITION ) )
    {
        add_surface_lines( list, entity, e, links, size );
    }
    if ( store_mask_has( &e->components, WISP_STRAND_POSITION ) )
    {
        add_strand_lines( list, entity, e, links, size );
    }
}

static wisp_status add_lines_of( wisp_line_list* list, wisp_line_kind kind )
{
    wisp_world* world = list->world;
    for ( int slot = 0; slot < world->store.entity_count; ++slot )
    {
        const wisp_entity entity = store_handle( &world->store, slot );
        if ( world->store.entities[slot].alive && ( kind == WISP_LINES_PINS || kind == WISP_LINES_LINKS ) )
        {
            WISP_TRY( wisp_world_need_fabric( world, entity, WISP_FABRIC_EDGES ) );
            add_row_lines( list, entity, kind );
        }
        for ( int i = 0; i < world->registry.state_count && world->store.entities[slot].alive; ++i )
        {
            const plan_state* s = world->registry.states + i;
            if ( s->hooks.lines != NULL )
            {
                s->hooks.lines( s->memory, world, entity, kind, list );
            }
        }
    }
    return WISP_OK;
}

wisp_status wisp_debug_lines( wisp_world* world, unsigned kinds, const double origin[3], wisp_line* lines,
                              int capacity, int* count )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( wisp_world_check_pointer( world, "count", count ) );
    *count = 0;
    WISP_TRY( wisp_world_check_list( world, "lines", lines, capacity ) );
    wisp_line_list list = { .world = world, .lines = lines, .capacity = capacity };
    bool is_place = true;
    for ( int k = 0; k < 3 && origin != NULL; ++k )
    {
        list.origin[k] = origin[k];
        is_place = is_place && isfinite( origin[k] );
    }
    if ( is_place == false || kinds > WISP_LINES_ALL )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "lines: %s",
                                is_place ? "kinds has bits that no kind has" : "origin is not finite" );
    }
    for ( unsigned kind = 1; kind < WISP_LINES_ALL; kind *= 2 )
    {
        if ( ( kinds & kind ) != 0 )
        {
            WISP_TRY( add_lines_of( &list, (wisp_line_kind)kind ) );
        }
    }
    *count = list.count;
    return WISP_OK;
}
