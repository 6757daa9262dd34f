// How soft bodies are: the stretch that their weight, the wind and their solver explain.
#include "stability_parts.h"

// The stretch of an edge that carries the weight of everything: by its compliance c, and by what a projection of
// weight w leaves, which is about 2 w h^2 for each newton: a chain of n masses m hangs longer by n g h^2 in every
// link.
static double softness_of( double compliance, double stiffness, double inverse_mass, double h, double force,
                           double edge )
{
    return ( compliance + 2.0 * inverse_mass * h * h / fmax( stiffness, 1e-2 ) ) * force / edge;
}

static double surface_softness( const wisp_scene_surface* s, const stability_body* body, double inverse_mass,
                                double force )
{
    const double h = body->substep;
    if ( s->has_implicit )
    {
        return softness_of( 1.0 / (double)s->implicit.stretch_stiffness, 1.0, 0.0, h, force, body->edge );
    }
    if ( s->has_cloth && !s->has_membrane )
    {
        const bool is_pbd = s->cloth.solver == WISP_SOLVER_PBD;
        const double c = fmax( (double)s->cloth.warp_compliance,
                               fmax( (double)s->cloth.weft_compliance, (double)s->cloth.shear_compliance ) );
        const double k = is_pbd ? fmin( (double)s->cloth.stretch_stiffness, (double)s->cloth.shear_stiffness ) : 1.0;
        return softness_of( is_pbd ? 0.0 : c, k, inverse_mass, h, force, body->edge );
    }
    return INFINITY; // a skin that gas stretches, rubber, or vertices without links
}

static double strands_softness( const wisp_scene_strands* s, const stability_body* body, double inverse_mass,
                                double force )
{
    const double h = body->substep;
    if ( s->dynamics.stretch != WISP_STRAND_STRETCH_LINKS )
    {
        return (double)s->dynamics.stretch_tolerance;
    }
    const bool is_pbd = s->dynamics.solver == WISP_SOLVER_PBD;
    return softness_of( is_pbd ? 0.0 : (double)s->dynamics.stretch_compliance,
                        is_pbd ? (double)s->dynamics.stretch_stiffness : 1.0, inverse_mass, h, force, body->edge );
}

static double total_mass( const scene_world* world )
{
    double mass = 0.0;
    for ( int body = 0; body < scene_world_moving_count( world ); ++body )
    {
        wisp_motion_stats m;
        mass += scene_world_motion_stats( world, body, &m, NULL ) == WISP_OK ? m.mass : 0.0;
    }
    return mass;
}

void stability_find_softness( const scene_world* world, stability_trace* trace )
{
    const wisp_scene* scene = world->scene;
    const double mass = total_mass( world );
    for ( int i = 0; i < trace->body_count; ++i )
    {
        stability_body* b = &trace->bodies[i];
        // What stands on the body counts, as does the wind.
        const double force = mass * fmax( b->gravity, 1.0 ) + trace->inputs.drag + trace->inputs.lift;
        const int vertices = scene_world_body( world, i ).vertex_count;
        const double inverse_mass = b->mass > 0.0 ? vertices / b->mass : 0.0;
        b->burden = ( b->has_contact ? fmax( mass - b->mass, 0.0 ) * fmax( b->gravity, 1.0 ) : 0.0 ) +
                    trace->inputs.drag + trace->inputs.lift;
        if ( b->moves )
        {
            b->softness = i < scene->strands_count ? strands_softness( &scene->strands[i], b, inverse_mass, force )
                                                   : surface_softness( &scene->surfaces[i - scene->strands_count], b,
                                                                       inverse_mass, force );
        }
    }
}
