/// What the flights of figures 4 to 8 share.
#pragma once

#include "figures_bench.h"

#include "balloon_scene.h"

/// Of the edges of an emptied body. A scanned figure with thin ears keeps a few creases.
#define FLIGHT_STRAIN_LEFT 0.15

double flight_length( const double a[3] );

/// A shut outlet of the vertices within 2 cm of the one that is nearest to a point: their common normal is steadier than that
/// of a single vertex.
void flight_give_outlet( const figures_case* page, wisp_vec3 at, balloon_setting* setting );

/// A balloon of the scanned figure. Destroy the implementation and release the fabric, also on failure.
wisp_status flight_enter( const figures_case* page, const balloon_setting* setting, wisp_fabric** fabric,
                          surface_implementation* implementation, wisp_error* error );
/// @param out the statistics after the last step
wisp_status flight_advance( surface_implementation* implementation, int steps, wisp_balloon_stats* out,
                            wisp_error* error );
wisp_status flight_open( surface_implementation* implementation, wisp_error* error );

/// Empty tracks of four vertices. Free out[0].points, also on failure.
/// @param out receives [count]
/// @param length points of a track
wisp_status flight_tracks_make( int count, int length, float radius, figures_tracks* out, wisp_error* error );
/// Add a point to each track: of the vertices that are farthest along four directions.
wisp_status flight_track( const figures_case* page, surface_implementation* implementation, figures_tracks* tracks,
                          int step, wisp_error* error );
