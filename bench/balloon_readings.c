#include "balloon_readings.h"

#include "oracle/balloon_oracle.h"

#include <math.h>

double balloon_stiffness_sum( const wisp_fabric* fabric, const wisp_balloon_def* def )
{
    double sum = 0.0;
    for ( int slot = 0; slot < fabric->link_order.slot_count; ++slot )
    {
        int link = fabric->link_order.constraint[slot];
        double rest = (double)fabric->link_rest[slot];
        double stiffness = (double)( link < fabric->edge_count ? def->edge_stiffness : def->bend_link_stiffness );
        sum += link >= 0 ? stiffness * rest * rest : 0.0;
    }
    return sum;
}

// Every link of the mesh is s times as long: sum(k l^2) (s - 1) / (3 V_rest s^2).
static double closed_form( const wisp_fabric* fabric, const wisp_balloon_def* def, const wisp_balloon_stats* seen )
{
    return balloon_oracle_true_scaled_pressure( balloon_stiffness_sum( fabric, def ), seen->rest_volume,
                                                cbrt( seen->volume / seen->rest_volume ) );
}

wisp_status balloon_read_all( surface_implementation* implementation, const balloon_setting* setting,
                              balloon_readings* out, wisp_error* error )
{
    wisp_balloon_stats seen = { 0 };
    wisp_status status = wisp_request_balloon_stats( implementation->world, implementation->entity, true );
    if ( status != WISP_OK )
    {
        return bench_world_fail( implementation->world, status, error );
    }
    status = surface_implementation_step( implementation, error );
    status = status == WISP_OK ? balloon_implementation_read( implementation, &seen, error ) : status;
    const double lacking = seen.target_volume - seen.volume;
    *out = ( balloon_readings ){
        .pressure = seen.pressure,
        .gas_law = (double)setting->def.atmospheric_pressure * lacking / seen.volume,
        .volume_error = -lacking / seen.target_volume,
        .closed_form = closed_form( implementation->fabric, &setting->def, &seen ),
    };
    return status;
}
