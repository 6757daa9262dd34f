// What a definition of strands must hold: ranges, what excludes what, lists.
#include "strands_definition.h"

#include "masses_lengths.h"
#include "strand_rows.h"

// Largest EI' / EI. The flatness sqrt( 1 - EI / EI' ) is in single precision, and EI is what it leaves of EI': 0.05 % off at
// 1e4, 1 % at 1e5, nothing that is left, and rest shapes that are NaN, from 3e7 on.
#define MAX_EDGEWISE 1e5f

static wisp_status check_ranges( wisp_world* world, const wisp_strand_dynamics_def* d )
{
    const wisp_number_range ranges[] = {
        { "stretch", (float)d->stretch, 0.0f, (float)( WISP_STRAND_STRETCH_COUNT - 1 ) },
        { "stretch_passes", (float)d->stretch_passes, 1.0f, 16.0f },
        { "stretch_tolerance", d->stretch_tolerance, 1e-6f, 1.0f },
        { "integrator", (float)d->integrator, 0.0f, (float)( WISP_INTEGRATOR_COUNT - 1 ) },
        { "bending", (float)d->bending, 0.0f, (float)( WISP_STRAND_BEND_COUNT - 1 ) },
        { "bend_rigidity", d->bend_rigidity, 0.0f, 1e12f },
        { "twist_rigidity", d->twist_rigidity, 0.0f, 1e12f },
        { "edgewise_rigidity", d->edgewise_rigidity, 0.0f, 1e12f },
        { "natural_twist", d->natural_twist, -1e5f, 1e5f },
        { "closing_twist", d->closing_twist, -1e4f, 1e4f },
        { "bend_damping", d->bend_damping, 0.0f, 1e3f },
        { "rest", (float)d->rest, 0.0f, (float)( WISP_STRAND_REST_COUNT - 1 ) },
        { "solver", (float)d->solver, 0.0f, (float)( WISP_SOLVER_COUNT - 1 ) },
        { "stretch_compliance", d->stretch_compliance, 0.0f, 1e12f },
        { "bend_compliance", d->bend_compliance, 0.0f, 1e12f },
        { "stretch_stiffness", d->stretch_stiffness, 0.0f, 1.0f },
        { "bend_stiffness", d->bend_stiffness, 0.0f, 1.0f },
        { "line_density", d->line_density, 1e-12f, 1e12f },
        { "vertex_mass", d->vertex_mass, 0.0f, 1e12f },
        { "damping", d->damping, 0.0f, 1e9f },
        { "air_density", d->air_density, 0.0f, 1e6f },
        { "drag_coefficient", d->drag_coefficient, 0.0f, 1e6f },
        { "diameter", d->diameter, 1e-12f, 1e6f },
        { "teleport", d->teleport, 1e-6f, 1e12f },
    };
    return wisp_world_check_ranges( world, "strands", ranges, WISP_COUNT( ranges ) );
}

wisp_status strands_check_vector( wisp_world* world, const char* name, wisp_vec3 v, float most )
{
    if ( !( wisp_v3_length( v ) <= most ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "strands: %s (%g, %g, %g) is not finite or above %g", name,
                                (double)v.x, (double)v.y, (double)v.z, (double)most );
    }
    return WISP_OK;
}

static wisp_status check_integrator( wisp_world* world, const wisp_strand_dynamics_def* d )
{
    if ( d->integrator == WISP_INTEGRATOR_BDF2 && d->stretch != WISP_STRAND_STRETCH_DIRECT )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strands: got integrator bdf2 with stretch links, expected direct" );
    }
    return WISP_OK;
}

static wisp_status check_section( wisp_world* world, const wisp_strand_dynamics_def* d )
{
    const wisp_vec3 n = d->flat_normal;
    const bool is_flat = d->edgewise_rigidity > 0.0f;
    if ( is_flat && ( d->edgewise_rigidity < d->bend_rigidity || d->bend_rigidity <= 0.0f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strands: got edgewise_rigidity %g with bend_rigidity %g, expected 0 or at least a "
                                "bend_rigidity above 0",
                                (double)d->edgewise_rigidity, (double)d->bend_rigidity );
    }
    if ( is_flat && d->edgewise_rigidity > MAX_EDGEWISE * d->bend_rigidity )
    {
        return wisp_world_fail(
            world, WISP_BAD_INPUT,
            "strands: got edgewise_rigidity %g with bend_rigidity %g, expected at most %g times it",
            (double)d->edgewise_rigidity, (double)d->bend_rigidity, (double)MAX_EDGEWISE );
    }
    if ( is_flat && d->bending != WISP_STRAND_BEND_ROD )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strands: got edgewise_rigidity %g with bending other than rod",
                                (double)d->edgewise_rigidity );
    }
    if ( is_flat == false && ( d->natural_twist != 0.0f || n.x != 0.0f || n.y != 0.0f || n.z != 0.0f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strands: natural_twist and flat_normal need an edgewise_rigidity above 0" );
    }
    return strands_check_vector( world, "flat_normal", n, 1e6f );
}

// Check what free roots and closed strands do without.
static wisp_status check_free( wisp_world* world, wisp_entity strands, const strands_state* s,
                               const wisp_strand_dynamics_def* d )
{
    const char* name = d->closed ? "closed" : "free_roots";
    const bool rod = d->bending == WISP_STRAND_BEND_ROD;
    if ( ( d->closed == false || rod == false ) && d->closing_twist != 0.0f )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "strands: closing_twist needs closed and bending rod" );
    }
    if ( d->closed == false && d->free_roots == false )
    {
        return WISP_OK;
    }
    if ( rod && d->rest == WISP_STRAND_REST_SAG_FREE )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strands: got %s with rest sag_free, expected shape or straight", name );
    }
    if ( d->closed && ( d->stretch != WISP_STRAND_STRETCH_DIRECT || d->bending == WISP_STRAND_BEND_LINKS ||
                        d->integrator != WISP_INTEGRATOR_EULER || d->edgewise_rigidity > 0.0f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strands: closed needs stretch direct, bending rod or none, integrator euler and no "
                                "edgewise_rigidity" );
    }
    if ( wisp_world_has( world, strands, s->anchor ) || wisp_world_has( world, strands, s->tips ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT,
                                "strands: got %s for entity %u, whose roots are on a surface or whose tips are held",
                                name, strands.index );
    }
    return WISP_OK;
}

// Check that each strand is a loop whose segments have a length.
static wisp_status check_loops( wisp_world* world, wisp_entity strands )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const float* rest = wisp_world_column( world, strands, WISP_STRAND_REST, 0 );
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        if ( t->lane_count[i] > 0 &&
             strands_is_loop( rest, t->group_row[i / WISP_LANES], t->lane_count[i], i % WISP_LANES ) == false )
        {
            return wisp_world_fail(
                world, WISP_BAD_INPUT,
                "strands: strand %d is no loop, closed needs at least four vertices and the last on "
                "the first",
                t->lane_strand[i] );
        }
    }
    return WISP_OK;
}

static wisp_status check_lists( wisp_world* world, const wisp_strand_topology* t, const wisp_strand_dynamics_def* d )
{
    for ( int v = 0; d->vertex_masses != NULL && v < t->vertex_count; ++v )
    {
        if ( !( d->vertex_masses[v] >= 1e-15f && d->vertex_masses[v] <= 1e12f ) )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "strands: the mass of vertex %d is %g kg, it must be 1e-15 to 1e12", v,
                                    (double)d->vertex_masses[v] );
        }
    }
    if ( d->vertex_mass != 0.0f && d->vertex_mass < 1e-15f )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "strands: vertex_mass is %g kg, it must be 0 or 1e-15 to 1e12",
                                (double)d->vertex_mass );
    }
    if ( d->pin_count < 0 || ( d->pin_count > 0 && d->pins == NULL ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "strands: %d pins without a list of them", d->pin_count );
    }
    for ( int k = 0; k < d->pin_count; ++k )
    {
        if ( d->pins[k] < 0 || d->pins[k] >= t->vertex_count )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "strands: pin %d is vertex %d, the strands have %d vertices", k, d->pins[k],
                                    t->vertex_count );
        }
    }
    return WISP_OK;
}

wisp_status strands_check_definition( wisp_world* world, wisp_entity strands, const strands_state* s,
                                      const wisp_strand_dynamics_def* d )
{
    WISP_TRY( check_ranges( world, d ) );
    WISP_TRY( strands_check_vector( world, "gravity", d->gravity, 1e6f ) );
    WISP_TRY( strands_check_vector( world, "wind", d->wind, 1e5f ) );
    WISP_TRY( check_integrator( world, d ) );
    WISP_TRY( check_section( world, d ) );
    WISP_TRY( check_free( world, strands, s, d ) );
    WISP_TRY( d->closed ? check_loops( world, strands ) : WISP_OK );
    return check_lists( world, wisp_world_strands( world, strands ), d );
}
