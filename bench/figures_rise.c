// Figure 7: inflated in free air, then released suddenly.
#include "figures_flight.h"

#include <math.h>
#include <stdlib.h>

enum
{
    RISE_STEPS = 60,
    RELEASE_STEPS = 120,
    RISE_FILLS = 3,
};

typedef struct rise_run
{
    double lift, weight;             // N
    double risen, highest, end;      // m, when it is released, at most and at the end
    double fall, spin;               // m/s downwards and rad/s, largest after the release
    double strain, strain_max, left; // of the edges: largest at the release, ever after it, and at the end
} rise_run;

static wisp_status step_and_track( const figures_case* page, surface_implementation* implementation, int step,
                                   figures_tracks* tracks, wisp_balloon_stats* seen, wisp_motion_stats* motion,
                                   wisp_error* error )
{
    wisp_status status = flight_advance( implementation, 1, seen, error );
    status = status == WISP_OK ? flight_track( page, implementation, tracks, step - 1, error ) : status;
    if ( status == WISP_OK )
    {
        status = wisp_read_motion_stats( implementation->world, implementation->entity, motion );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
    }
    return status;
}

static wisp_status fly( const figures_case* page, surface_implementation* implementation, float gas_ratio,
                        figures_album* album, figures_tracks* tracks, rise_run* out, wisp_error* error )
{
    wisp_balloon_stats seen = { 0 };
    wisp_motion_stats motion = { 0 };
    wisp_status status = WISP_OK;
    for ( int step = 1; step <= RISE_STEPS + RELEASE_STEPS && status == WISP_OK; ++step )
    {
        if ( step == RISE_STEPS + 1 )
        {
            *out = ( rise_run ){ .lift = flight_length( seen.buoyancy ),
                                 .weight = flight_length( seen.gravity ),
                                 .risen = motion.centre[1],
                                 .highest = motion.centre[1],
                                 .strain = motion.strain_max };
            status = figures_take( page, album, implementation, error, "released" );
            status = status == WISP_OK ? flight_open( implementation, error ) : status;
        }
        status =
            status == WISP_OK ? step_and_track( page, implementation, step, tracks, &seen, &motion, error ) : status;
        status =
            status == WISP_OK && step == 1 ? figures_take( page, album, implementation, error, "start" ) : status;
        out->fall = fmax( out->fall, -motion.momentum[1] / motion.mass );
        out->spin = fmax( out->spin, flight_length( seen.angular_velocity ) );
        out->highest = fmax( out->highest, motion.centre[1] );
        out->strain_max = fmax( out->strain_max, motion.strain_max );
    }
    out->end = motion.centre[1];
    out->left = motion.strain_max;
    return status == WISP_OK ? figures_take( page, album, implementation, error, "fill %.1f: start, full, empty",
                                             (double)gas_ratio )
                             : status;
}

// A skin of 35 g/m^2, so that the empty body sinks, and 1000 N/m, so that the pressure of the fullest stays below 7.5 kPa, up
// to which Bernoulli's law holds. The jet is 0.5 cm^2.
static wisp_status rise( figures_case* page, float gas_ratio, figures_album* album, figures_tracks* tracks,
                         rise_run* out, wisp_error* error )
{
    balloon_setting setting = balloon_default_setting();
    setting.def.gas_ratio = gas_ratio;
    setting.def.edge_stiffness = 1000.0f;
    setting.def.outlet_area = 5e-5f;
    setting.area_density = 0.035f;
    setting.damping = 1.0f;
    // whose common normal does not flap as that of the tip of an ear does
    flight_give_outlet( page, ( wisp_vec3 ){ -0.07f, 0.2f, 0.01f }, &setting );
    wisp_fabric* fabric = NULL;
    surface_implementation implementation;
    wisp_status status = flight_enter( page, &setting, &fabric, &implementation, error );
    status = status == WISP_OK ? fly( page, &implementation, gas_ratio, album, tracks, out, error ) : status;
    surface_implementation_destroy( &implementation );
    wisp_fabric_release( fabric );
    return status;
}

static void add_rows( figures_case* page, const rise_run* runs )
{
    bool rises = true, reverses = true, grows = true, bounded = true;
    for ( int i = 0; i < RISE_FILLS; ++i )
    {
        const rise_run* r = runs + i;
        rises = rises && r->lift > r->weight && r->risen > ( i > 0 ? 1.1 * runs[i - 1].risen : 0.1 );
        reverses = reverses && r->highest < r->risen + 0.1 && r->end < r->highest - 0.1;
        grows = grows && r->fall > ( i > 0 ? 1.1 * runs[i - 1].fall : 0.5 ) &&
                r->spin > ( i > 0 ? 1.1 * runs[i - 1].spin : 0.0 );
        bounded = bounded && r->strain_max < 1.05 * r->strain && r->left < FLIGHT_STRAIN_LEFT;
    }
    figures_add(
        page, "F7", "1 s in free air at fills of 1.4, 1.7 and 2", "rises, since its lift is above its weight", rises,
        "lift / weight %.2f, %.2f, %.2f; rises %.2f, %.2f, %.2f m", runs[0].lift / runs[0].weight,
        runs[1].lift / runs[1].weight, runs[2].lift / runs[2].weight, runs[0].risen, runs[1].risen, runs[2].risen );
    figures_add( page, "F7", "an outlet in the head opens for 2 s",
                 "the path turns back within 0.1 m, and ends lower", reverses,
                 "highest %.2f, %.2f, %.2f m, at the end %.2f, %.2f, %.2f m", runs[0].highest, runs[1].highest,
                 runs[2].highest, runs[0].end, runs[1].end, runs[2].end );
    figures_add( page, "F7", "the same, fall and spin", "both grow with the fill, by a tenth at least", grows,
                 "%.2f, %.2f, %.2f m/s downwards; %.1f, %.1f, %.1f rad/s", runs[0].fall, runs[1].fall, runs[2].fall,
                 runs[0].spin, runs[1].spin, runs[2].spin );
    figures_add( page, "F7", "the same, skin", "never more strained than full, below 0.15 when empty", bounded,
                 "strain %.2f, %.2f, %.2f full, %.2f, %.2f, %.2f at most, %.3f, %.3f, %.3f empty", runs[0].strain,
                 runs[1].strain, runs[2].strain, runs[0].strain_max, runs[1].strain_max, runs[2].strain_max,
                 runs[0].left, runs[1].left, runs[2].left );
}

wisp_status figures_rise_and_reverse( figures_case* page, wisp_error* error )
{
    static const float fills[RISE_FILLS] = { 1.4f, 1.7f, 2.0f };
    rise_run runs[RISE_FILLS] = { { 0 } };
    figures_album album = { .mesh = &page->figure, .shots_per_picture = 3 };
    figures_tracks tracks[RISE_FILLS];
    wisp_status status = flight_tracks_make( RISE_FILLS, RISE_STEPS + RELEASE_STEPS, 0.004f, tracks, error );
    for ( int i = 0; i < RISE_FILLS && status == WISP_OK; ++i )
    {
        status = rise( page, fills[i], &album, &tracks[i], &runs[i], error );
    }
    if ( status == WISP_OK )
    {
        add_rows( page, runs );
        status = figures_write( page, &album, tracks, "f7_release",
                                "F7, tracks of four vertices: 1 s up, then 2 s with an open outlet", error );
    }
    figures_album_free( &album );
    free( tracks[0].points );
    return status;
}
