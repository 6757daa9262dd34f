// Balloons in the matrix: an icosphere of 162 vertices, full of helium, held at a triangle, because a body held at
// one point rotates about it.
#include "stability_surface.h"

#include "balloon/balloon.h"
#include "collision/collision.h"
#include "contact/contact.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>

#define RADIUS 0.15f
#define DENSITY 0.1f // kg/m^2
#define DAMPING 4.0f // 1/s
#define FILL 1.1f    // of the rest volume: the skin is taut
#define SUBSTEPS 10
#define VERTICES 162

enum
{
    PBD,
    XPBD,
};

// The signed volume inside the triangles. @param gradient [vertex][3] to add to, m^2; may be null
static double volume_of( const wisp_fabric* f, const float* x, double ( *gradient )[3] )
{
    double sum = 0.0;
    for ( int t = 0; t < f->triangle_count; ++t )
    {
        const int32_t* corners = f->triangles + 3 * (size_t)t;
        for ( int i = 0; i < 3; ++i )
        {
            const float *p = x + 4 * (size_t)corners[( i + 1 ) % 3], *q = x + 4 * (size_t)corners[( i + 2 ) % 3];
            const float* own = x + 4 * (size_t)corners[i];
            for ( int k = 0; k < 3; ++k )
            {
                const int u = ( k + 1 ) % 3, v = ( k + 2 ) % 3;
                const double area = ( (double)p[u] * (double)q[v] - (double)p[v] * (double)q[u] ) / 6.0; // of p x q
                sum += area * (double)own[k] / 3.0;
                if ( gradient != NULL )
                {
                    gradient[corners[i]][k] += area;
                }
            }
        }
    }
    return sum;
}

// A spring between the volume and its target: compliance V0 / P_atm for the gas, plus sum w |dV/dx|^2 h^2 for the
// compliance of a projection within a substep, which is all with pbd.
static double energy_of_gas( stability_surface* s, int frame )
{
    (void)frame;
    const float* x =
        wisp_world_column( s->implementation.world, s->implementation.entity, WISP_PARTICLE_POSITION, 0 );
    float rest[4 * VERTICES] = { 0 };
    double gradient[VERTICES][3] = { { 0.0 } };
    for ( int i = 0; i < s->fabric->vertex_count; ++i )
    {
        const wisp_vec3 r = s->fabric->rest[i];
        rest[4 * i] = r.x;
        rest[4 * i + 1] = r.y;
        rest[4 * i + 2] = r.z;
    }
    const double target = (double)FILL * volume_of( s->fabric, rest, NULL );
    const double error = volume_of( s->fabric, x, gradient ) - target;
    const double h = (double)s->implementation.generator.seconds / s->implementation.generator.substeps;
    double soft = s->is_pbd ? 0.0 : target / 101325.0;
    for ( int i = 0; i < s->fabric->vertex_count; ++i )
    {
        const double* g = gradient[i];
        soft += (double)x[4 * i + 3] * h * h * ( g[0] * g[0] + g[1] * g[1] + g[2] * g[2] );
    }
    return soft > 0.0 ? 0.5 * error * error / soft : 0.0;
}

static wisp_status fill( stability_surface* s, int way, const stability_axes* axes, wisp_error* error )
{
    wisp_balloon_def def = wisp_default_balloon_def();
    def.solver = def.volume = way == PBD ? WISP_SOLVER_PBD : WISP_SOLVER_XPBD;
    def.edge_stiffness = axes->stiffness > 0.0f ? axes->stiffness : def.edge_stiffness;
    def.gas_ratio = FILL;
    def.buoyancy = false; // its work would have to be known; the balloon hangs instead
    s->stored = energy_of_gas;
    s->is_pbd = way == PBD;
    s->taut =
        4.0 * ( cbrt( (double)FILL ) - 1.0 ); // twice at five-fold vertices, twice around the triangle that is held
    s->compliance = 1.0 / (double)def.edge_stiffness;
    const wisp_status status = wisp_set_balloon( s->implementation.world, s->implementation.entity, &def );
    return status == WISP_OK ? WISP_OK : bench_world_fail( s->implementation.world, status, error );
}

static wisp_status enter_surface( stability_surface* s, int way, const stability_axes* axes, int workers,
                                  wisp_error* error )
{
    surface_generator generator = surface_default_generator( &wisp_balloon_module, NULL );
    generator.second = &wisp_collision_module;
    generator.third = &wisp_contact_module;
    generator.area_density = DENSITY;
    generator.gravity = ( wisp_vec3 ){ 0.0f, -STABILITY_GRAVITY, 0.0f };
    generator.damping = DAMPING / sqrtf( axes->scale );
    generator.substeps = SUBSTEPS;
    generator.workers = workers;
    wisp_mesh_generator mesh = wisp_default_mesh_generator( WISP_MESH_ICOSPHERE );
    mesh.level = 2;
    mesh.radius = RADIUS * axes->scale;
    const wisp_fabric_def def = wisp_default_fabric_def();
    wisp_status status = wisp_mesh_generate( &mesh, &s->mesh, error );
    if ( status == WISP_OK )
    {
        generator.pins = s->mesh.triangles;
        generator.pin_count = 3;
        status = stability_surface_enter( s, &def, generator, axes, error );
    }
    if ( status == WISP_OK )
    {
        stability_surface_weigh( s, axes->mass_ratio );
        status = fill( s, way, axes, error );
    }
    return status;
}

static wisp_status enter( int way, const stability_axes* axes, int workers, stability_trial* out, wisp_error* error )
{
    stability_surface* s = calloc( 1, sizeof( *s ) );
    if ( s == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a cell" );
    }
    const wisp_status status = enter_surface( s, way, axes, workers, error );
    if ( status != WISP_OK )
    {
        stability_surface_close( s );
        return status;
    }
    *out = stability_surface_trial( s, axes );
    return WISP_OK;
}

static const stability_subject subjects[] = {
    { "balloon pbd", PBD, enter, false, true, false, 0.0f },
    { "balloon xpbd", XPBD, enter, true, true, true, 0.0f },
};

const stability_subject* stability_balloons( int* count )
{
    *count = WISP_COUNT( subjects );
    return subjects;
}
