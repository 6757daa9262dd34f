// The passes. Each is in the file that is named.
#pragma once

#include "wisp/module/module.h"

void collision_update_poses( wisp_frame* frame, const wisp_span* span, void* user ); // collision_bodies.c
void collision_follow( wisp_frame* frame, const wisp_span* span, void* user );       // collision_surface.c
void collision_find( wisp_frame* frame, const wisp_span* span, void* user );         // contact_generation.c
void collision_project( wisp_frame* frame, const wisp_span* span, void* user );      // contact_projection.c
void collision_keep_outside( wisp_frame* frame, const wisp_span* span, void* user ); // closed_forms.c
void collision_keep_crowd_outside( wisp_frame* frame, const wisp_crowd* crowd, const wisp_span* span, void* user );
void collision_find_primitives( wisp_frame* frame, const wisp_span* span, void* user );    // primitive_contacts.c
void collision_project_primitives( wisp_frame* frame, const wisp_span* span, void* user ); // primitive_projection.c
void collision_sense( wisp_frame* frame, const wisp_span* span, void* user );              // contact_input.c
void collision_bounce_off( wisp_frame* frame, const wisp_span* span, void* user );         // restitution.c
void collision_gather_impulses( wisp_frame* frame, const wisp_span* span, void* user );    // reaction.c
void collision_share_contacts( wisp_frame* frame, const wisp_span* span, void* user );     // reaction.c
void collision_couple( wisp_frame* frame, const wisp_span* span, void* user );             // reaction.c
void collision_read_reactions( wisp_frame* frame, const wisp_span* span, void* user );     // reaction.c
void collision_touch_strands( wisp_frame* frame, const wisp_span* span, void* user );      // strand_contacts.c
void collision_part_strands( wisp_frame* frame, const wisp_span* span, void* user );       // strand_contacts.c
void collision_keep_out( wisp_frame* frame, const wisp_span* span, void* user );           // posed_strands.c
void collision_measure( wisp_frame* frame, const wisp_span* span, void* user );            // collision_stats.c
void collision_measure_strands( wisp_frame* frame, const wisp_span* span, void* user );    // collision_stats.c
void collision_measure_posed( wisp_frame* frame, const wisp_span* span, void* user );      // collision_stats.c

/// As wisp_state_hooks.lines, collision_lines.c.
void collision_add_lines( const void* state, wisp_world* world, wisp_entity entity, wisp_line_kind kind,
                          wisp_line_list* list );
