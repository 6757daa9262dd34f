#include "validate_equilibrium.h"

#include "balloon_readings.h"

#include "oracle/balloon_oracle.h"

#include <math.h>

// V of the rest shape, by the slots of the fabric.
static double rest_volume( const wisp_fabric* f )
{
    double sum = 0.0;
    for ( int t = 0; t < f->triangle_count; ++t )
    {
        const int32_t* c = f->triangles + 3 * (size_t)t;
        const wisp_vec3 p = f->rest[c[0]], q = f->rest[c[1]], r = f->rest[c[2]];
        const double qx = (double)q.x, qy = (double)q.y, qz = (double)q.z;
        const double rx = (double)r.x, ry = (double)r.y, rz = (double)r.z;
        sum += (double)p.x * ( qy * rz - qz * ry ) + (double)p.y * ( qz * rx - qx * rz ) +
               (double)p.z * ( qx * ry - qy * rx );
    }
    return sum / 6.0;
}

typedef struct elastic_skin
{
    double sum, volume, atmosphere; // N m; m^3, at rest; Pa
    bool is_linear;
} elastic_skin;

static elastic_skin skin_of( const wisp_fabric* fabric, const wisp_balloon_def* def, bool is_linear )
{
    return ( elastic_skin ){ balloon_stiffness_sum( fabric, def ), rest_volume( fabric ),
                             (double)def->atmospheric_pressure, is_linear };
}

// The skin's load grows with s up to 2 and the gas pressure falls, so there is one solution s.
static double find_scale( const elastic_skin* skin, double gas_ratio )
{
    double lower = 1.0, upper = cbrt( gas_ratio );
    for ( int i = 0; i < 60; ++i )
    {
        const double s = 0.5 * ( lower + upper ), volume = s * s * s;
        const double pressed = skin->atmosphere * ( gas_ratio - volume ) / ( skin->is_linear ? gas_ratio : volume );
        const double held = balloon_oracle_true_scaled_pressure( skin->sum, skin->volume, s );
        *( held < pressed ? &lower : &upper ) = s;
    }
    return lower;
}

balloon_equilibrium balloon_equilibrium_at( const wisp_fabric* fabric, const wisp_balloon_def* def, double gas_ratio,
                                            bool is_linear )
{
    const elastic_skin skin = skin_of( fabric, def, is_linear );
    const double s = find_scale( &skin, gas_ratio );
    return ( balloon_equilibrium ){ s, balloon_oracle_true_scaled_pressure( skin.sum, skin.volume, s ), skin.volume };
}

balloon_equilibrium balloon_equilibrium_of( const wisp_fabric* fabric, const wisp_balloon_def* def, bool is_linear )
{
    return balloon_equilibrium_at( fabric, def, (double)def->gas_ratio, is_linear );
}
