/// Pictures of strands for the case `figures`: layers of strands in one colour each, shots side by side.
#pragma once

#include "figures_bench.h"

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
