#include "figures_drape.h"

wisp_status figures_run( figures_fn* const* experiments, int count, const bench_options* options, results* out,
                         wisp_error* error )
{
    static const char* const header[] = { "figure", "experiment", "expected", "measured", "met" };
    figures_case page = { .out = out, .pictures = options->pictures, .quick = options->quick };
    page.table = results_add_table( out, "Figures of the papers as experiments", WISP_COUNT( header ), header );
    wisp_status status = balloon_mesh_figure( &page.figure, &page.figure_name, error );
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        bench_progress( options, (double)i / count, "figures" );
        status = experiments[i]( &page, error );
    }
    if ( status == WISP_OK )
    {
        results_add_note( out,
                          "Figures: the scanned body is the %s, %d vertices, scaled to the area of a sphere of 0.15 "
                          "m. Unless stated: steps of 1/60 s, 10 x 2, 0.02 kg/m^2, k_edge 2000 N/m, helium.",
                          page.figure_name, page.figure.vertex_count );
    }
    wisp_mesh_release( &page.figure );
    return status;
}

wisp_status figures_bench( const bench_options* options, results* out, wisp_error* error )
{
    static figures_fn* const all[] = {
        figures_two_particles,
        figures_links,
        figures_fixed_volume,
        figures_four_forces,
        figures_inflate_release,
        figures_spin,
        figures_rise_and_reverse,
        figures_real_time,
        figures_ghost_centre,
        figures_ghost_sway,
        figures_ghost_block,
        figures_ghost_apart,
        figures_ghost_curves,
        figures_ghost_spread,
        figures_ghost_pairing,
        figures_frozen_intensity,
        figures_frozen_stiffness,
        figures_frozen_clumps,
        figures_drape,
        figures_drape_steps,
        figures_free_flight,
        figures_hang_accuracy,
        figures_hang_refined,
    };
    return figures_run( all, WISP_COUNT( all ), options, out, error );
}
