/// Hair in figures: pictures of strands, and a tuft of ghosts on a head that sways.
#pragma once

#include "figures_bench.h"
#include "strands_scene.h"

#define FIGURES_HAIR_SHOTS_MAX 6
#define FIGURES_HAIR_LAYERS_MAX 4

typedef struct figures_hair_layer
{
    wisp_vec3* points;
    int32_t* offsets;
    wisp_vec3* colours; ///< of each point; null: the one colour below
    int strand_count;
    wisp_vec3 colour;
    float radius; ///< m
} figures_hair_layer;

/// Zero-initialised is empty.
typedef struct figures_hair_album
{
    figures_hair_layer layers[FIGURES_HAIR_SHOTS_MAX][FIGURES_HAIR_LAYERS_MAX];
    int layer_count[FIGURES_HAIR_SHOTS_MAX];
    char labels[FIGURES_HAIR_SHOTS_MAX][40];
    int count;
    bool is_flat; ///< strands in the plane z = 0, drawn from the front on white
} figures_hair_album;

/// Begin a shot. Without a folder for pictures, or beyond the last shot, nothing is kept.
void figures_hair_begin( const figures_case* page, figures_hair_album* album, const char* format, ... )
    __attribute__( ( format( printf, 3, 4 ) ) );
/// Add strands of equally many vertices to the shot begun last. @param points [strand_count][vertices] m
wisp_status figures_hair_add( const figures_case* page, figures_hair_album* album, const wisp_vec3* points,
                              int strand_count, int vertices, wisp_vec3 colour, float radius, wisp_error* error );
/// As figures_hair_add(), with colours that blend from root to tip.
wisp_status figures_hair_add_blended( const figures_case* page, figures_hair_album* album, const wisp_vec3* points,
                                      int strand_count, int vertices, wisp_vec3 root_colour, wisp_vec3 tip_colour,
                                      float radius, wisp_error* error );
/// Write the shots side by side as FOLDER/<name>.png and link it from the page.
wisp_status figures_hair_write( figures_case* page, const figures_hair_album* album, const char* name,
                                const char* caption, wisp_error* error );
void figures_hair_free( figures_hair_album* album );

// ---- tufts ----

// A tuft for the figures of Park and Kim 2024: one target, ghosts around it, seen with and without their weights.

#define TUFT_NODES 10
#define TUFT_STEPS 60
#define TUFT_GROUP 4 ///< ghosts
#define TUFT_SHOT 25 ///< step of the picture
/// Half a rounding of a float at 0.4 m is 1.5e-8 m; sums of a few such numbers stay below this.
#define TUFT_ROUNDING 3e-7

extern const wisp_vec3 tuft_target_colour, tuft_ghost_colour, tuft_line_colour;

/// Ghosts of one target, once as they are and once without any weight: what differs is the sway.
typedef struct tuft
{
    strands_shape target, ghosts;
    hair_head swaying, plain;
} tuft;

/// What is seen after a step. Velocities are of the target, now and a step before.
typedef struct tuft_seen
{
    const wisp_vec3 *target, *swaying, *base;
    wisp_vec3 now[TUFT_NODES], before[TUFT_NODES];
} tuft_seen;

/// Ghosts at rising distances from the target, each in a direction of its own, farther apart towards the tip.
wisp_status tuft_make( int ghost_count, int ghost_nodes, tuft* t, wisp_error* error );
void tuft_free( tuft* t );
/// Ghosts that only follow.
wisp_ghosts_def tuft_without_weights( void );
wisp_status tuft_enter( tuft* t, const wisp_ghosts_def* follow, wisp_error* error );
wisp_status tuft_advance( tuft* t, tuft_seen* s, wisp_error* error );

/// Lines of a shot, besides the target and its ghosts. Zero-initialised: difference lines at their own length, without a bar.
typedef struct tuft_lines
{
    bool
        to_centre; ///< from every ghost to the mean of its group; otherwise from where a ghost would be without weights
                   ///< towards where it is
    float magnified; ///< times that difference lines are drawn; 0 is once
    float bar;       ///< m: a line under the tuft is as long as a difference of this is drawn; 0: none
} tuft_lines;

/// Keep the target, its ghosts and lines, as seen from the root of the target. Lines shorter than their radius are left out: the
/// renderer's round cones have no direction there, and show strokes of a centimetre.
wisp_status tuft_take( const figures_case* page, figures_hair_album* album, const tuft* t, const tuft_seen* s,
                       const tuft_lines* lines, wisp_error* error );

wisp_vec3 tuft_minus( wisp_vec3 a, wisp_vec3 b );
double tuft_dot( wisp_vec3 a, wisp_vec3 b );
double tuft_length( wisp_vec3 a );
