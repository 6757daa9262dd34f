#include "validate_helium.h"

#include "validate_equilibrium.h"
#include "oracle/balloon_oracle.h"
#include "oracle/balloon_theory.h"

#include <math.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;

balloon_setting validate_helium_setting( const validate_helium_way* way, int workers )
{
    balloon_setting setting = balloon_default_setting();
    setting.def.gas_ratio = (float)way->fill;
    setting.def.solver = way->skin;
    setting.def.volume = way->volume;
    setting.gravity = ( wisp_vec3 ){ 0.0f, (float)-VALIDATE_HELIUM_GRAVITY, 0.0f };
    setting.substeps = way->substeps;
    setting.iterations = 1;
    setting.workers = workers;
    setting.seconds = ACCURACY_FRAME;
    return setting;
}

// Weight of the air displaced, without that of the gas.
static double lift_of( const validate_helium_sphere* sphere, double rest_volume, double scale, double fill )
{
    return rest_volume * ( sphere->air * scale * scale * scale - sphere->helium * fill );
}

validate_helium_sphere validate_helium_theory( const balloon_setting* setting )
{
    const wisp_balloon_def* def = &setting->def;
    const double atmosphere = (double)def->atmospheric_pressure, kelvin = (double)def->temperature;
    const balloon_theory_sphere skin = { .radius = (double)BALLOON_RADIUS,
                                         .edge_stiffness = (double)def->edge_stiffness,
                                         .bend_link_stiffness = (double)def->bend_link_stiffness,
                                         .atmosphere = atmosphere,
                                         .gas_ratio = (double)def->gas_ratio };
    validate_helium_sphere sphere = {
        .scale = balloon_theory_sphere_scale( &skin ),
        .air = balloon_oracle_density( atmosphere, (double)def->air_molar_mass, kelvin ),
        .helium = balloon_oracle_density( atmosphere, (double)def->gas_molar_mass, kelvin ),
    };
    sphere.radius = sphere.scale * skin.radius;
    sphere.lift = lift_of( &sphere, 4.0 / 3.0 * PI * pow( skin.radius, 3.0 ), sphere.scale, skin.gas_ratio );
    return sphere;
}

wisp_status validate_helium_make( const validate_helium_way* way, validate_helium_body* out, wisp_error* error )
{
    const balloon_setting setting = validate_helium_setting( way, 1 );
    const validate_helium_sphere sphere = validate_helium_theory( &setting );
    *out = ( validate_helium_body ){ .fabric = NULL };
    wisp_status status = balloon_mesh_sphere( way->level, BALLOON_RADIUS, &out->mesh, error );
    status = status == WISP_OK ? balloon_cook( &out->mesh, &setting, &out->fabric, error ) : status;
    if ( status == WISP_OK )
    {
        const balloon_equilibrium full = balloon_equilibrium_of( out->fabric, &setting.def, false );
        for ( int i = 0; i < out->fabric->slot_count; ++i )
        {
            out->area += (double)out->fabric->area[i];
        }
        out->lift = lift_of( &sphere, full.volume, full.scale, (double)setting.def.gas_ratio );
        out->points = balloon_scaled_points( &out->mesh, full.scale );
        status = out->points != NULL ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for a full balloon" );
    }
    return status;
}

void validate_helium_free( validate_helium_body* body )
{
    wisp_fabric_release( body->fabric );
    wisp_mesh_release( &body->mesh );
    free( body->points );
    *body = ( validate_helium_body ){ .fabric = NULL };
}

void validate_helium_name( const validate_helium_way* way, char* out, size_t size )
{
    snprintf( out, size, "%s skin, %s gas", way->skin == WISP_SOLVER_XPBD ? "xpbd" : "pbd",
              way->volume == WISP_SOLVER_XPBD ? "xpbd" : "pbd" );
}
