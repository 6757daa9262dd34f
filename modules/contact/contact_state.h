// State of the module, and its passes.
#pragma once

#include "broad_phase.h"
#include "clusters.h"
#include "solve.h"
#include "constraints.h"
#include "contact_mesh.h"
#include "displacement_limit.h"
#include "predicted_motion.h"
#include "narrow_phase.h"
#include "spheres.h"
#include "untangling.h"

typedef struct contact_state
{
    contact_components components;
    wisp_component active;   // contact_memory, of the entity `mesh_entity`, while there are participants
    wisp_component touches;  // of `mesh_entity`: strands take part
    wisp_component reached;  // written by contact.reach, read by contact.find
    wisp_component pairs;    // written by contact.find, read by contact.push
    wisp_component result;   // requested of `mesh_entity`
    wisp_component stats;    // wisp_contact_stats, on request
    wisp_entity mesh_entity; // the entity whose passes work on the contact mesh
    contact_participant* participants;
    int participant_count, participant_capacity;
    wisp_contact_settings world;
    bool changed; // participants or settings: the contact mesh is to be built again
    bool requests_stats, counts_intersections;

    contact_contact_mesh contact_mesh;
    contact_clusters clusters;
    contact_motion motion;
    contact_cached_bounds bounds;
    contact_broad_phase broad_phase;
    contact_intersections intersections;
    contact_primitive_pairs primitives;
    contact_constraints constraints;
    contact_spheres spheres;
    contact_colouring colouring;
    contact_limit limit;
    contact_untangling untangling;
} contact_state;

// contact_passes.c
void contact_reach( wisp_frame* frame, const wisp_span* span, void* user );
bool contact_join( wisp_frame* frame, wisp_entity entity, void* user );
void contact_find( wisp_frame* frame, const wisp_span* span, void* user );
void contact_project( wisp_frame* frame, const wisp_span* span, void* user );
void contact_limit_strands( wisp_frame* frame, const wisp_span* span, void* user );
void contact_keep( wisp_frame* frame, const wisp_span* span, void* user );
void contact_measure( wisp_frame* frame, const wisp_span* span, void* user );

// contact_participants.c
/// Find a participant. @return its index, or -1
int contact_find_participant( const contact_state* state, wisp_entity entity );
/// Mark the surfaces that spheres stand for, so that modules that share points bring them up to date before the substeps.
/// @return WISP_NO_MEMORY: marks are as before
wisp_status contact_mark_participants( wisp_world* world, const contact_state* state, wisp_contact_level level );
/// Remove a participant. Only takes away, so it cannot fail.
void contact_forget_participant( wisp_world* world, contact_state* state, int number );
