// State of the module: the seams, and what their rows hold.
#pragma once

#include "seams.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

typedef struct seam_settings
{
    float distance;      // m
    float closing_speed; // m/s
    float compliance;    // m/N
    float strength;      // N
    float inverse_dt2;   // 1/s^2, of the last substep; 0 before the first
} seam_settings;

enum
{
    SEAM_COLOURS = 64, // the last one holds what found no other, and runs serially
};

/// Topology of a seam, an object of its entity. Rows are in the order of their colours: pairs of a colour share no vertex.
typedef struct seam_topology
{
    wisp_entity entity;
    wisp_entity a, b; // zero: a surface was removed
    int pair_count;
    int colour_count;
    int colour_begin[SEAM_COLOURS + 1]; // first row of a colour
    int32_t ends_x4[];                  // [pair_count][2] slots times 4
} seam_topology;

/// The components, a row each: X( member, "name", table, columns ).
#define SEAMS_COMPONENTS( X )                                                                                        \
    X( settings, "seams.settings", ENTITY, WISP_COLUMN( seam_settings, settings, 1 ) )                               \
    X( pairs, "seams.pairs", PAIR, WISP_COLUMN( float, rest, 1 ),                                                    \
       /* m, that the pair holds now */ WISP_COLUMN( float, impulse, 3 ),                                            \
       /* N s^2, of the substep, on the vertex of a */ WISP_COLUMN( int32_t, broken, 1 ) )                           \
    X( sewn, "seams.sewn", ENTITY, WISP_NO_COLUMNS )                     /* marks surfaces */                        \
    X( active, "seams.active", ENTITY, WISP_COLUMN( int32_t, mark, 1 ) ) /* of `hub` */                              \
    X( result, "seams.result", ENTITY, WISP_COLUMN( int32_t, mark, 1 ) ) /* of `hub` */

typedef struct seams_state
{
    SEAMS_COMPONENTS( WISP_COMPONENT_MEMBER )
    wisp_entity hub;
    wisp_objects* seams; // seam_topology
} seams_state;

/// Compute the force that pulls at a pair; negative: it pushes. @param d from the vertex of b to that of a
float seams_pull( const float impulse[3], const float d[3], float rest, float inverse_dt2 ); // seams_project.c
/// Bytes of a topology.
static inline size_t seams_bytes( const void* seam )
{
    return sizeof( seam_topology ) + 2 * (size_t)( (const seam_topology*)seam )->pair_count * sizeof( int32_t );
}
/// Check pairs and order them in colours, or find them first if the definition says within. @param out receives topology and surfaces
wisp_status seams_cook_pairs( wisp_world* world, const wisp_seam_def* def, seam_topology** out ); // seams_project.c
/// The pass.
void seams_project( wisp_frame* frame, const wisp_span* span, void* user ); // seams_project.c
