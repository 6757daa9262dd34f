/// The figures of Noh and Jung: a cloth that falls onto a ball, and what its engine makes of
/// energy, of long steps, of accuracy and of finer meshes.
#pragma once

#include "figures_bench.h"
#include "surfaces.h"

figures_fn
    figures_drape; ///< Noh and Jung, Fig. 8 to 11: at rest for stiffness 50 to 350, frames, against the quad mesh
figures_fn figures_drape_steps; ///< the stiffest cloth in steps of 1/100, 1/60 and 1/30 s
figures_fn
    figures_free_flight; ///< Noh and Jung, section 3.3: energy does not grow, and falls faster with more damping
figures_fn figures_hang_accuracy; ///< extension: gain and cost of tolerance, iterations and shorter steps
figures_fn figures_hang_refined;  ///< extension: stiffness of the sheet makes a finer mesh the same cloth

// ---- pictures ----

/// Write each shape as FOLDER/<name>_<number>.png, all of them side by side as FOLDER/<name>.png, and link that.
/// @param has_ball show the ball too
wisp_status drape_write( figures_case* page, const figures_album* album, bool has_ball, const char* name,
                         const char* caption, wisp_error* error );
