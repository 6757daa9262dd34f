// Maps: factors on constants, by slot, edge or triangle. Those of masses, links and hinges are multiplied into columns when a map
// or a constant changes; those of damping and air are read in each substep.
#include "world.h"

#include "wisp/module/vec.h"
#include "wisp/maps.h"
#include "wisp/module/components.h"

#include <math.h>
#include <string.h>

// Compliance from which a link does not act (cloth_bending.c): no factor may make it stiff.
static const float INACTIVE = 1e12f;

static bool is_map( wisp_component map )
{
    return ( map >= WISP_MAP_AREA_DENSITY && map <= WISP_MAP_LIFT ) ||
           ( map >= WISP_MAP_COLLISION_THICKNESS && map <= WISP_MAP_CONTACT_FRICTION );
}

static bool is_of_edges( wisp_component map )
{
    return map >= WISP_MAP_STRETCH_COMPLIANCE && map <= WISP_MAP_BEND_RIGIDITY;
}

static float* column_of( wisp_world* world, const store_entity* e, wisp_component component )
{
    return store_column( &world->store, e, component, 0 );
}

// ---- coefficients ----

static float times( float constant, const float* map, int edge, bool is_stiffness )
{
    if ( map == NULL || ( is_stiffness == false && constant >= INACTIVE ) )
    {
        return constant;
    }
    const float product = constant * map[edge];
    return is_stiffness ? fminf( product, 1.0f ) : fminf( product, INACTIVE );
}

static void multiply_by_map( int slots, const float* constant, const int32_t* edge, const float* map,
                             const wisp_schedule* order, int first, int last, bool is_stiffness, float* column )
{
    for ( int slot = 0; slot < slots; ++slot )
    {
        const int number = order->constraint[slot];
        if ( number >= first && number < last )
        {
            column[slot] = times( constant[slot], map, edge[slot], is_stiffness );
        }
    }
}

static void apply_to_links( wisp_world* world, const store_entity* e )
{
    const wisp_fabric* f = e->fabric;
    const bool stiff = store_mask_has( &e->components, WISP_LINK_STIFFNESS );
    float* column = column_of( world, e, WISP_LINK_OWN );
    const float* constant = column_of( world, e, WISP_LINK_CONSTANT );
    if ( column == NULL || constant == NULL )
    {
        return;
    }
    const int32_t* edge = store_column( &world->store, e, WISP_LINK_CONSTANT, 1 );
    const float* stretch = column_of( world, e, stiff ? WISP_MAP_STRETCH_STIFFNESS : WISP_MAP_STRETCH_COMPLIANCE );
    const float* bend = column_of( world, e, stiff ? WISP_MAP_BEND_STIFFNESS : WISP_MAP_BEND_COMPLIANCE );
    const int slots = f->link_order.slot_count;
    memcpy( column, constant, (size_t)slots * sizeof( float ) );
    multiply_by_map( slots, constant, edge, stretch, &f->link_order, 0, f->edge_count, stiff, column );
    multiply_by_map( slots, constant, edge, bend, &f->link_order, f->edge_count, f->link_count, stiff, column );
}

static void apply_to_hinges( wisp_world* world, const store_entity* e )
{
    const wisp_fabric* f = e->fabric;
    float *column = column_of( world, e, WISP_HINGE_STIFFNESS ),
          *constant = column_of( world, e, WISP_HINGE_CONSTANT );
    if ( column != NULL && constant != NULL )
    {
        const int32_t* edge = store_column( &world->store, e, WISP_HINGE_CONSTANT, 1 );
        memcpy( column, constant, (size_t)f->hinge_order.slot_count * sizeof( float ) );
        multiply_by_map( f->hinge_order.slot_count, constant, edge, column_of( world, e, WISP_MAP_BEND_STIFFNESS ),
                         &f->hinge_order, 0, f->hinge_count, true, column );
    }
}

// Springs in a row add their compliances: the mean over the edges along a link, by their lengths.
static float mean_along( const wisp_fabric* f, const wisp_fabric_level* level, int link, const float* map )
{
    double sum = 0.0, length = 0.0;
    const int group = link / 8, lane = link % 8;
    for ( int e = level->chain_begin[group]; e + 1 < level->chain_begin[group + 1]; ++e )
    {
        const int32_t a = level->chain_x4[e][lane] / 4, b = level->chain_x4[e + 1][lane] / 4;
        if ( a != b )
        {
            const double part = (double)wisp_v3_length( wisp_v3_sub( f->rest[a], f->rest[b] ) );
            sum += part * (double)map[wisp_fabric_find_edge( f, a, b )];
            length += part;
        }
    }
    return length > 0.0 ? (float)( sum / length ) : 1.0f;
}

static void apply_to_levels( wisp_world* world, store_entity* e )
{
    const wisp_fabric* f = e->fabric;
    float *column = column_of( world, e, WISP_LEVEL_COMPLIANCE ),
          *constant = column_of( world, e, WISP_LEVEL_CONSTANT );
    const float* map = column_of( world, e, WISP_MAP_STRETCH_COMPLIANCE );
    for ( int l = 0; l < f->level_count && column != NULL && constant != NULL; ++l )
    {
        const wisp_fabric_level* level = f->levels + l;
        for ( int i = 0; i < level->schedule.slot_count; ++i )
        {
            const bool acts = map != NULL && level->schedule.constraint[i] >= 0;
            const float factor = acts ? mean_along( f, level, i, map ) : 1.0f;
            column[level->first_link + i] = constant[level->first_link + i] * factor;
        }
    }
}

// Rows of columns, those that the effect has filled: kept before maps change them, or put back.
static void copy_rows( wisp_world* world, store_entity* e, bool keep )
{
    const struct
    {
        float* column;
        wisp_component constant;
        wisp_table table;
    } all[] = {
        { column_of( world, e, WISP_LINK_OWN ), WISP_LINK_CONSTANT, WISP_TABLE_LINK },
        { column_of( world, e, WISP_HINGE_STIFFNESS ), WISP_HINGE_CONSTANT, WISP_TABLE_HINGE },
        { column_of( world, e, WISP_LEVEL_COMPLIANCE ), WISP_LEVEL_CONSTANT, WISP_TABLE_LEVEL_LINK },
    };
    for ( int i = 0; i < WISP_COUNT( all ); ++i )
    {
        float* constant = column_of( world, e, all[i].constant );
        if ( all[i].column != NULL && constant != NULL )
        {
            memcpy( keep ? constant : all[i].column, keep ? all[i].column : constant,
                    (size_t)e->rows[all[i].table].count * sizeof( float ) );
        }
    }
}

static void apply_all( wisp_world* world, store_entity* e )
{
    apply_to_links( world, e );
    apply_to_hinges( world, e );
    apply_to_levels( world, e );
}

void wisp_world_apply_maps( wisp_world* world, wisp_entity surface )
{
    store_entity* e = store_find( &world->store, surface );
    if ( e != NULL && store_mask_has( &e->components, WISP_LINK_CONSTANT ) )
    {
        copy_rows( world, e, true );
        apply_all( world, e );
    }
}

// ---- checks ----

static wisp_status check_factors( wisp_world* world, wisp_component map, const float* factors, int count )
{
    // Searches reach as far as the constant thickness. Between surfaces none is 0: at distance 0 they have passed each other.
    const bool is_thickness = map == WISP_MAP_COLLISION_THICKNESS || map == WISP_MAP_CONTACT_THICKNESS;
    const float least = map == WISP_MAP_AREA_DENSITY ? 1e-6f : map == WISP_MAP_CONTACT_THICKNESS ? 0.01f : 0.0f;
    const float most = is_thickness ? 1.0f : 1e6f;
    for ( int i = 0; i < count; ++i )
    {
        if ( !( factors[i] >= least && factors[i] <= most ) )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT, "%s: vertex %d: got the factor %g, expected %g to %g",
                                    wisp_world_component_name( world, map ), i, (double)factors[i], (double)least,
                                    (double)most );
        }
    }
    return WISP_OK;
}

// A map acts where a module, or the engine, has said so, and nothing refuses it.
static wisp_status check_use( wisp_world* world, const store_entity* e, wisp_entity surface, wisp_component map )
{
    bool acts = map == WISP_MAP_AREA_DENSITY;
    for ( int i = 0; i < world->registry.map_count; ++i )
    {
        const plan_map* use = world->registry.maps + i;
        const bool is_here = use->map == map && store_mask_has( &e->components, use->component );
        if ( is_here && use->refusal != NULL )
        {
            return wisp_world_fail( world, WISP_CONFLICT, "%s: entity %u: %s",
                                    wisp_world_component_name( world, map ), surface.index, use->refusal );
        }
        acts = acts || is_here;
    }
    return acts ? WISP_OK
                : wisp_world_fail( world, WISP_CONFLICT,
                                   "%s: entity %u has no such constant above 0: set the effect first",
                                   wisp_world_component_name( world, map ), surface.index );
}

static wisp_status begin_map( wisp_world* world, wisp_entity surface, wisp_component map, store_entity** out )
{
    WISP_TRY( world_find_surface( world, surface, out ) );
    return is_map( map ) ? WISP_OK
                         : wisp_world_fail( world, WISP_BAD_INPUT, "map: component %d is not a map", (int)map );
}

// ---- setting ----

bool world_list_map_edges( wisp_world* world, store_entity* e )
{
    const wisp_fabric* f = e->fabric;
    const wisp_allocator* allocator = &world->allocator;
    const size_t bytes = ( 2 * (size_t)f->hinge_count + 1 ) * sizeof( int32_t );
    int32_t* of_hinge = allocator->allocate( allocator->user, bytes, 64 ); // [hinge], then [bend link]
    if ( of_hinge == NULL )
    {
        return false;
    }
    int32_t *of_link = of_hinge + f->hinge_count, *links = store_column( &world->store, e, WISP_LINK_CONSTANT, 1 ),
            *hinges = store_column( &world->store, e, WISP_HINGE_CONSTANT, 1 );
    for ( int h = 0, count = 0; h < f->hinge_count; ++h )
    {
        const int32_t* corner = f->hinges + 4 * (size_t)h;
        of_hinge[h] = wisp_fabric_find_edge( f, corner[0], corner[1] );
        of_link[count] = of_hinge[h];
        count += corner[2] != corner[3] ? 1 : 0; // as the fabric lists bend links
    }
    for ( int slot = 0; slot < f->link_order.slot_count; ++slot )
    {
        const int link = f->link_order.constraint[slot];
        links[slot] = link < f->edge_count ? link : of_link[link - f->edge_count];
    }
    for ( int slot = 0; slot < f->hinge_order.slot_count; ++slot )
    {
        const int hinge = f->hinge_order.constraint[slot];
        hinges[slot] = hinge >= 0 ? of_hinge[hinge] : -1;
    }
    allocator->release( allocator->user, of_hinge, bytes );
    return true;
}

static const wisp_component CONSTANTS[] = { WISP_LINK_CONSTANT, WISP_HINGE_CONSTANT, WISP_LEVEL_CONSTANT };

static bool has_edge_map( const store_entity* e )
{
    bool has = false;
    for ( int map = WISP_MAP_STRETCH_COMPLIANCE; map < WISP_MAP_BEND_RIGIDITY; ++map )
    {
        has = has || store_mask_has( &e->components, map );
    }
    return has;
}

// @return stiffness or compliance of edges and of bend links; null without links
static const float* alike_of( wisp_world* world, const store_entity* e )
{
    const float* stiffness = column_of( world, e, WISP_LINK_STIFFNESS );
    return stiffness != NULL ? stiffness : column_of( world, e, WISP_LINK_COMPLIANCE );
}

// Gives each link a coefficient of its own, for maps to multiply.
static wisp_status tell_links_apart( wisp_world* world, wisp_entity surface, const store_entity* e )
{
    if ( alike_of( world, e ) == NULL || store_mask_has( &e->components, WISP_LINK_OWN ) )
    {
        return WISP_OK;
    }
    WISP_TRY( wisp_world_attach( world, surface, WISP_LINK_OWN ) );
    const float* alike = alike_of( world, e );
    float* own = column_of( world, e, WISP_LINK_OWN );
    for ( int slot = 0; slot < e->fabric->link_order.slot_count; ++slot )
    {
        const int kind = wisp_fabric_link_kind( e->fabric, slot );
        own[slot] = kind < 0 ? 0.0f : alike[kind];
    }
    return WISP_OK;
}

static void detach_constants( wisp_world* world, wisp_entity surface )
{
    const float* alike = alike_of( world, store_find( &world->store, surface ) );
    if ( alike != NULL && *alike >= 0.0f )
    {
        (void)wisp_world_detach( world, surface, WISP_LINK_OWN );
    }
    for ( int i = 0; i < WISP_COUNT( CONSTANTS ); ++i )
    {
        (void)wisp_world_detach( world, surface, CONSTANTS[i] ); // only frees memory
    }
}

// Attach a map, and what keeps the constants that it multiplies. Without memory nothing changes.
static wisp_status attach_map( wisp_world* world, wisp_entity surface, wisp_component map )
{
    store_entity* e = store_find( &world->store, surface );
    const bool is_new = store_mask_has( &e->components, map ) == false;
    const bool keeps = is_of_edges( map ) && map != WISP_MAP_BEND_RIGIDITY;
    const bool keeps_already = store_mask_has( &e->components, WISP_LINK_CONSTANT );
    wisp_status status = is_of_edges( map )
                             ? wisp_world_need_fabric( world, surface, WISP_FABRIC_EDGES | WISP_FABRIC_HINGES )
                             : WISP_OK;
    status = status == WISP_OK && keeps ? tell_links_apart( world, surface, e ) : status;
    for ( int i = 0; i < WISP_COUNT( CONSTANTS ) && keeps && status == WISP_OK; ++i )
    {
        status = wisp_world_attach( world, surface, CONSTANTS[i] );
    }
    status = status == WISP_OK ? wisp_world_attach( world, surface, map ) : status;
    if ( status == WISP_OK && keeps && keeps_already == false )
    {
        status = world_list_map_edges( world, e )
                     ? WISP_OK
                     : wisp_world_fail( world, WISP_NO_MEMORY, "%s: out of memory for its edges",
                                        wisp_world_component_name( world, map ) );
        copy_rows( world, e, true );
    }
    if ( status != WISP_OK && is_new )
    {
        (void)wisp_world_detach( world, surface, map );
    }
    if ( status != WISP_OK && keeps_already == false )
    {
        detach_constants( world, surface );
    }
    return status;
}

// Free vertices get their masses, and what depends on them is found again.
static void update_mapped_masses( wisp_world* world, wisp_entity surface, store_entity* e )
{
    float* position = column_of( world, e, WISP_PARTICLE_POSITION );
    for ( int slot = 0; slot < e->fabric->vertex_count; ++slot )
    {
        float* inverse_mass = position + 4 * (size_t)slot + 3;
        *inverse_mass = *inverse_mass > 0.0f ? world_inverse_mass( world, e, slot ) : *inverse_mass;
    }
    store_touch( &world->store, e, WISP_PARTICLE_POSITION );
    wisp_world_restart_levels( world, surface );
}

static void update( wisp_world* world, wisp_entity surface, wisp_component map )
{
    store_entity* e = store_find( &world->store, surface );
    if ( map == WISP_MAP_AREA_DENSITY )
    {
        update_mapped_masses( world, surface, e );
    }
    else if ( is_of_edges( map ) && store_mask_has( &e->components, WISP_LINK_CONSTANT ) )
    {
        apply_all( world, e );
        wisp_world_restart_levels( world, surface );
    }
}

static wisp_status remove_map( wisp_world* world, wisp_entity surface, wisp_component map )
{
    store_entity* e = store_find( &world->store, surface );
    if ( store_mask_has( &e->components, map ) == false )
    {
        return WISP_OK;
    }
    (void)wisp_world_detach( world, surface, map );
    update( world, surface, map );
    if ( has_edge_map( e ) == false )
    {
        detach_constants( world, surface );
    }
    return WISP_OK;
}

static void fill( wisp_world* world, const store_entity* e, wisp_component map, const float* factors )
{
    const wisp_fabric* f = e->fabric;
    float* row = column_of( world, e, map );
    if ( map == WISP_MAP_BEND_RIGIDITY )
    {
        for ( int t = 0; t < f->triangle_count; ++t )
        {
            const int32_t* corner = f->triangles + 3 * (size_t)t;
            row[t] = ( factors[f->slot_vertex[corner[0]]] + factors[f->slot_vertex[corner[1]]] +
                       factors[f->slot_vertex[corner[2]]] ) /
                     3.0f;
        }
        return;
    }
    for ( int edge = 0; edge < f->edge_count && is_of_edges( map ); ++edge )
    {
        const int32_t* end = f->edges + 2 * (size_t)edge;
        row[edge] = 0.5f * ( factors[f->slot_vertex[end[0]]] + factors[f->slot_vertex[end[1]]] );
    }
    for ( int slot = 0; slot < f->slot_count && is_of_edges( map ) == false; ++slot )
    {
        row[slot] = f->slot_vertex[slot] >= 0 ? factors[f->slot_vertex[slot]] : 1.0f;
    }
}

// ---- public function ----

wisp_status wisp_set_map( wisp_world* world, wisp_entity surface, wisp_component map, const float* factors,
                          int count )
{
    store_entity* e;
    WISP_TRY( begin_map( world, surface, map, &e ) );
    if ( factors == NULL )
    {
        return remove_map( world, surface, map );
    }
    if ( count != e->fabric->vertex_count )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "%s: got %d factors, but the surface has %d vertices",
                                wisp_world_component_name( world, map ), count, e->fabric->vertex_count );
    }
    WISP_TRY( check_factors( world, map, factors, count ) );
    WISP_TRY( check_use( world, e, surface, map ) );
    WISP_TRY( attach_map( world, surface, map ) );
    fill( world, store_find( &world->store, surface ), map, factors );
    update( world, surface, map );
    return WISP_OK;
}
