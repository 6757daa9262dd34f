// Definition of a balloon: ranges, requirements on the mesh, and the components, which select the passes.
#include "balloon_internal.h"

#include <string.h>

static const wisp_field BALLOON_FIELDS[] = {
    WISP_CHOICE( wisp_balloon_def, solver, WISP_SOLVER_XPBD, WISP_SOLVER_COUNT ),
    WISP_NUMBER( wisp_balloon_def, edge_stiffness, 2000, 1e-6, 1e12, "N/m" ),
    WISP_NUMBER( wisp_balloon_def, bend_link_stiffness, 20, 1e-6, 1e12, "N/m" ),
    WISP_NUMBER( wisp_balloon_def, stretch_stiffness, 0.9, 0, 1, NULL ),
    WISP_NUMBER( wisp_balloon_def, bend_stiffness, 0.1, 0, 1, NULL ),
    WISP_CHOICE( wisp_balloon_def, volume, WISP_SOLVER_XPBD, WISP_SOLVER_COUNT ),
    WISP_NUMBER( wisp_balloon_def, volume_stiffness, 1, 1e-6, 1, NULL ),
    WISP_NUMBER( wisp_balloon_def, min_gas_ratio, 1, 1e-3, 1, NULL ),
    WISP_NUMBER( wisp_balloon_def, gas_ratio, 1, 1e-3, 1e6, NULL ),
    WISP_NUMBER( wisp_balloon_def, inflation_rate, 0, -1e6, 1e6, "m^3/s" ),
    WISP_NUMBER( wisp_balloon_def, atmospheric_pressure, 101325, 1e-3, 1e12, "Pa" ),
    WISP_NUMBER( wisp_balloon_def, temperature, 293.15, 1e-3, 1e6, "K" ),
    WISP_NUMBER( wisp_balloon_def, gas_molar_mass, 4.0026e-3, 1e-6, 10, "kg/mol" ),
    WISP_NUMBER( wisp_balloon_def, air_molar_mass, 28.9647e-3, 1e-6, 10, "kg/mol" ),
    WISP_SWITCH( wisp_balloon_def, buoyancy, true ),
    WISP_NUMBER( wisp_balloon_def, drag_coefficient, 0.5, 0, 1e6, NULL ),
    WISP_WHOLE( wisp_balloon_def, outlet_count, 0, 0, WISP_BALLOON_MAX_OUTLET ),
    WISP_NUMBER( wisp_balloon_def, outlet_area, 1e-4, 1e-12, 1e6, "m^2" ),
    WISP_SWITCH( wisp_balloon_def, outlet_open, false ),
    WISP_SWITCH( wisp_balloon_def, allow_open, false ),
};
WISP_DEFINE( balloon_def, "balloon", BALLOON_FIELDS )

// ---- checks ----

static wisp_status check_gas( wisp_world* world, const wisp_balloon_def* d )
{
    return d->gas_ratio >= d->min_gas_ratio
               ? WISP_OK
               : wisp_world_fail( world, WISP_BAD_INPUT,
                                  "balloon: gas_ratio: got %g, expected at least min_gas_ratio, which is %g",
                                  (double)d->gas_ratio, (double)d->min_gas_ratio );
}

static wisp_status check_outlet( wisp_world* world, const wisp_fabric* f, const wisp_balloon_def* d )
{
    for ( int i = 0; i < d->outlet_count; ++i )
    {
        if ( d->outlet[i] < 0 || d->outlet[i] >= f->vertex_count )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "balloon: outlet %d: got vertex %d, but the surface has %d vertices", i,
                                    d->outlet[i], f->vertex_count );
        }
    }
    return WISP_OK;
}

static double rest_volume( const wisp_fabric* f, const balloon_loops* loops )
{
    double volume = 0.0;
    const wisp_vec3 o = f->rest[0];
    for ( int t = 0; t < f->triangle_count; ++t )
    {
        double e[3][3];
        for ( int corner = 0; corner < 3; ++corner )
        {
            const wisp_vec3 p = f->rest[f->triangles[3 * t + corner]];
            e[corner][0] = (double)p.x - (double)o.x;
            e[corner][1] = (double)p.y - (double)o.y;
            e[corner][2] = (double)p.z - (double)o.z;
        }
        volume += e[0][0] * ( e[1][1] * e[2][2] - e[1][2] * e[2][1] ) +
                  e[0][1] * ( e[1][2] * e[2][0] - e[1][0] * e[2][2] ) +
                  e[0][2] * ( e[1][0] * e[2][1] - e[1][1] * e[2][0] );
    }
    return volume / 6.0 + balloon_fan_volume( loops, (const float*)f->rest, 3 );
}

// Count connected components by union-find; unreferenced vertices do not count.
static int count_shells( const wisp_fabric* f, int32_t* parent )
{
    int components = 0;
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        parent[v] = v;
    }
    for ( int e = 0; e < f->edge_count; ++e )
    {
        int32_t root[2];
        for ( int k = 0; k < 2; ++k )
        {
            root[k] = f->edges[2 * e + k];
            while ( parent[root[k]] != root[k] )
            {
                parent[root[k]] = parent[parent[root[k]]];
                root[k] = parent[root[k]];
            }
        }
        parent[root[0]] = root[1];
    }
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        components += parent[v] == v && f->area[v] > 0.0f ? 1 : 0;
    }
    return components;
}

// @param scratch [2][slot_count]
static wisp_status check_mesh( wisp_world* world, const wisp_fabric* f, int32_t* scratch )
{
    if ( f->nonmanifold_edge_count > 0 )
    {
        return wisp_world_fail(
            world, WISP_BAD_INPUT,
            "balloon: got %d nonmanifold edges, expected each edge in at most two triangles of equal winding",
            f->nonmanifold_edge_count );
    }
    int components = count_shells( f, scratch );
    if ( components != 1 )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "balloon: got %d components, expected one: make each a surface of its own",
                                components );
    }
    WISP_TRY( balloon_check_border( world, f ) );
    balloon_find_loops( f, scratch, scratch + f->slot_count );
    double volume = rest_volume( f, &( balloon_loops ){ scratch, scratch + f->slot_count, f->slot_count } );
    if ( !( volume > 0.0 ) )
    {
        return wisp_world_fail(
            world, WISP_BAD_INPUT,
            "balloon: got an enclosed volume of %g m^3, expected triangles that are counter-clockwise seen from "
            "outside",
            volume );
    }
    return WISP_OK;
}

// ---- components ----

static wisp_status set_components( wisp_world* world, wisp_entity surface, const wisp_balloon_def* d,
                                   const balloon_state* s )
{
    const bool pbd = d->solver == WISP_SOLVER_PBD;
    const bool linked = wisp_world_has( world, surface, WISP_SURFACE_ELASTIC ) == false;
    const bool open = wisp_world_fabric( world, surface )->open_edge_count > 0;
    const wisp_component_use all[] = {
        { s->gas, true },
        { s->volume, true },
        { s->skin, true },
        { s->open_edge, open },
        { s->inflation, d->inflation_rate != 0.0f },
        { s->buoyancy, d->buoyancy },
        { s->air, d->drag_coefficient > 0.0f },
        { s->outlet, d->outlet_count > 0 },
        { WISP_LINK_STIFFNESS, pbd && linked },
        { WISP_LINK_COMPLIANCE, pbd == false && linked },
        { WISP_LINK_OWN, linked && wisp_world_has( world, surface, WISP_LINK_CONSTANT ) },
    };
    return wisp_world_set_components( world, surface, all, WISP_COUNT( all ) );
}

static void fill_links( wisp_world* world, wisp_entity surface, const wisp_balloon_def* d )
{
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    const bool pbd = d->solver == WISP_SOLVER_PBD;
    const float of_edge = pbd ? d->stretch_stiffness : 1.0f / d->edge_stiffness;
    const float of_bend = pbd ? d->bend_stiffness : 1.0f / d->bend_link_stiffness;
    float* alike = wisp_world_column( world, surface, pbd ? WISP_LINK_STIFFNESS : WISP_LINK_COMPLIANCE, 0 );
    float* column = wisp_world_column( world, surface, WISP_LINK_OWN, 0 );
    if ( alike != NULL )
    {
        alike[0] = of_edge, alike[1] = of_bend;
    }
    for ( int slot = 0; slot < f->link_order.slot_count && column != NULL; ++slot )
    {
        const int kind = wisp_fabric_link_kind( f, slot );
        column[slot] = kind < 0 ? 0.0f : kind == 0 ? of_edge : of_bend;
    }
    wisp_world_apply_maps( world, surface );
}

static double density_of( const wisp_balloon_def* d, float molar_mass )
{
    return (double)d->atmospheric_pressure * (double)molar_mass / ( BALLOON_GAS_CONSTANT * (double)d->temperature );
}

static void fill_outlet( const wisp_fabric* f, const wisp_balloon_def* d, balloon_outlet* outlet )
{
    memset( outlet, 0, sizeof( *outlet ) );
    outlet->area = (double)d->outlet_area;
    outlet->count = d->outlet_count;
    outlet->open = d->outlet_open ? 1 : 0;
    for ( int i = 0; i < d->outlet_count; ++i )
    {
        outlet->slots[i] = f->vertex_slot[d->outlet[i]];
    }
}

static void fill( wisp_world* world, wisp_entity surface, const wisp_balloon_def* d, const balloon_state* s )
{
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    balloon_loops loops = { 0 };
    int32_t* open_edge = wisp_world_column( world, surface, s->open_edge, 0 );
    if ( open_edge != NULL )
    {
        int32_t* size = wisp_world_column( world, surface, s->open_edge, 1 );
        balloon_find_loops( f, open_edge, size );
        loops = ( balloon_loops ){ open_edge, size, f->slot_count };
    }
    double volume = rest_volume( f, &loops );
    *(balloon_gas*)wisp_world_column( world, surface, s->gas, 0 ) = ( balloon_gas ){
        .rest_volume = volume,
        .target_volume = (double)d->gas_ratio * volume,
        .min_volume = (double)d->min_gas_ratio * volume,
        .atmosphere = (double)d->atmospheric_pressure,
        .gas_density = density_of( d, d->gas_molar_mass ),
        .air_density = density_of( d, d->air_molar_mass ),
    };
    WISP_FILL( world, surface, s->skin, balloon_skin, d->edge_stiffness, d->bend_link_stiffness );
    WISP_FILL( world, surface, s->volume, float, d->volume == WISP_SOLVER_PBD ? d->volume_stiffness : -1.0f );
    WISP_FILL( world, surface, s->inflation, float, d->inflation_rate );
    WISP_FILL( world, surface, s->air, balloon_air,
               (float)( 0.5 * density_of( d, d->air_molar_mass ) * (double)d->drag_coefficient ) );
    balloon_outlet* outlet = wisp_world_column( world, surface, s->outlet, 0 );
    if ( outlet != NULL )
    {
        fill_outlet( f, d, outlet );
    }
    fill_links( world, surface, d );
}

// ---- the call of the host ----

// A balloon has passed the rest of this check with the same fabric. Only balloons have rings, so their rows serve as scratch
// memory of the right size.
static wisp_status check_skin( wisp_world* world, wisp_entity surface, const wisp_balloon_def* d,
                               const balloon_state* s )
{
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    WISP_TRY( wisp_world_need_fabric( world, surface, WISP_FABRIC_EDGES | WISP_FABRIC_RINGS ) );
    if ( f->open_edge_count > 0 && d->allow_open == false )
    {
        return balloon_refuse_open( world, f );
    }
    if ( wisp_world_has( world, surface, s->gas ) )
    {
        return WISP_OK;
    }
    wisp_status status = wisp_world_attach( world, surface, s->rings );
    if ( status == WISP_OK )
    {
        status = check_mesh( world, f, wisp_world_column( world, surface, s->rings, 0 ) );
        wisp_world_detach( world, surface, s->rings );
    }
    return status;
}

static wisp_status check_alone( wisp_world* world, wisp_entity surface )
{
    return wisp_world_has( world, surface, WISP_PARTICLE_EXTERNAL_SOLVER )
               ? wisp_world_fail( world, WISP_CONFLICT, "balloon: entity %u already has another solver",
                                  surface.index )
               : WISP_OK;
}

wisp_status wisp_set_balloon( wisp_world* world, wisp_entity surface, const wisp_balloon_def* given )
{
    wisp_balloon_def values;
    const wisp_balloon_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, &surface, &wisp_balloon_def_fields, &values, given ) );
    WISP_FIND_STATE( const balloon_state, state, world, "balloon", &surface, WISP_IS_SURFACE );
    WISP_TRY( check_alone( world, surface ) );
    WISP_TRY( check_gas( world, def ) );
    WISP_TRY( check_outlet( world, wisp_world_fabric( world, surface ), def ) );
    WISP_TRY( check_skin( world, surface, def, state ) );
    WISP_TRY( set_components( world, surface, def, state ) );
    fill( world, surface, def, state );
    return WISP_OK;
}
