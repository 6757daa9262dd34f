/// The case `figures`: the figures of the balloon paper, of Park and Kim 2024, of Kim 2026 and
/// of Noh and Jung (figures_drape.h) as experiments, each with a measured check.
#pragma once

#include "bench.h"
#include "bench_output.h"
#include "results.h"
#include "surfaces.h"

// ---- the page ----

// The page of the case `figures`: what experiments share, and its rows.

/// What the experiments share.
typedef struct figures_case
{
    results* out;
    int table;
    const char* pictures; ///< folder, or null
    bool quick;           ///< fewer and shorter runs
    wisp_mesh figure;     ///< an asymmetric closed body
    const char* figure_name;
} figures_case;

/// A row of the page. A check that is not met fails the run, unless it is `known`: a time that depends on what else the machine does, or
/// what is in no paper and is known to miss.
/// @param format what was measured
void figures_add( figures_case* page, const char* id, const char* experiment, const char* expected, bool meets_target,
                  const char* format, ... ) __attribute__( ( format( printf, 6, 7 ) ) );
void figures_add_known( figures_case* page, const char* id, const char* experiment, const char* expected,
                        bool meets_target, const char* format, ... ) __attribute__( ( format( printf, 6, 7 ) ) );

// ---- experiments ----

// The case `figures`: the figures of the balloon paper, of Park and Kim 2024, of Kim 2026 and
// of Noh and Jung (figures_drape.h) as experiments, each with a measured check.

typedef wisp_status figures_fn( figures_case* page, wisp_error* error );

figures_fn figures_two_particles;   ///< F1: one projection restores the length, in proportion to inverse masses
figures_fn figures_links;           ///< F2: edges and bend pairs of a pair of triangles and of a closed mesh
figures_fn figures_fixed_volume;    ///< F3: the body shrinks and swells to a given volume
figures_fn figures_four_forces;     ///< F4: gravity, buoyancy, drag and jet
figures_fn figures_inflate_release; ///< F5: volume rises, then falls; pressure nears the atmosphere's; the body turns
figures_fn figures_spin;            ///< F6: an outlet beside the centre, tracks of four vertices
figures_fn figures_rise_and_reverse; ///< F7: rises in free air, comes back when the outlet opens
figures_fn figures_real_time;        ///< F8: milliseconds a step against vertices

figures_fn figures_ghost_centre; ///< Park and Kim 2024, Fig. 1: the mean of the ghosts is their target
figures_fn figures_ghost_sway;   ///< Park and Kim 2024, Fig. 2a: ghosts sway more where the velocity changes more
figures_fn
    figures_ghost_block; ///< Park and Kim 2024, Fig. 2b: with the elastic weight alone a group moves as a block
figures_fn figures_ghost_apart;  ///< Park and Kim 2024, Fig. 2c: with the weight of the centre it does not
figures_fn figures_ghost_curves; ///< Park and Kim 2024, Fig. 3: curves have fewer sharp turns
figures_fn figures_ghost_spread; ///< the spread of a group is the requested one (extension)
figures_fn
    figures_ghost_pairing; ///< extension: ghosts with twice as many vertices, by the nearest vertex and by arc length

figures_fn figures_frozen_intensity; ///< Kim 2026, Fig. 1: intensity 0.8 and 0.2 along one cursor path
figures_fn figures_frozen_stiffness; ///< Kim 2026, Fig. 2: original, stiffness 7 and 3
figures_fn figures_frozen_clumps;    ///< Kim 2026, Fig. 3: aligned strands form locks, and gaps stay

/// Run some of the experiments. @param pictures folder, or null
wisp_status figures_run( figures_fn* const* experiments, int count, const bench_options* options, results* out,
                         wisp_error* error );

// ---- pictures ----

#define FIGURES_SHOTS_MAX 12

/// Shapes of one mesh, in the order in which they were taken.
typedef struct figures_album
{
    const wisp_mesh* mesh;
    wisp_vec3* shots[FIGURES_SHOTS_MAX]; ///< [vertex_count]
    char labels[FIGURES_SHOTS_MAX][40];
    int count;
    int shots_per_picture; ///< 0 counts as 1; with more, a picture has the label of its last shot
    bool is_centred;       ///< each shape is moved to the origin: the camera goes along with the body
} figures_album;

#define FIGURES_TRACKS_MAX 4

/// Lines through space, such as the tracks of vertices, each in a colour of its own.
typedef struct figures_tracks
{
    wisp_vec3* points;       ///< [track_count][length]
    int track_count, length; ///< at most FIGURES_TRACKS_MAX tracks
    float radius;            ///< m
} figures_tracks;

/// Keep the present shape of an implementation. Does nothing if there is no folder for pictures.
wisp_status figures_take( const figures_case* page, figures_album* album, surface_implementation* implementation,
                          wisp_error* error, const char* format, ... ) __attribute__( ( format( printf, 5, 6 ) ) );
/// Write the shapes side by side as FOLDER/<name>.png and link it from the page.
/// @param tracks [pictures], one set drawn into each picture, or null
wisp_status figures_write( figures_case* page, const figures_album* album, const figures_tracks* tracks,
                           const char* name, const char* caption, wisp_error* error );
void figures_album_free( figures_album* album );
