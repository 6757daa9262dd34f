/// Worlds of one entity each, shared by tests of all effects: cloth of three kinds, implicit cloth, a balloon,
/// strands of two kinds.
#pragma once

#include "cloth_fixture.h"

#include "balloon.h"
#include "collision.h"
#include "contact.h"
#include "implicit_cloth.h"
#include "motion_constraints.h"
#include "strands.h"

static const wisp_module* const EFFECTS[] = {
    &wisp_cloth_module,
    &wisp_implicit_cloth_module,
    &wisp_balloon_module,
    &wisp_strands_module,
    &wisp_collision_module,
    &wisp_contact_module,
    &wisp_motion_constraints_module,
};

/// Add an entity with its effect.
typedef wisp_entity effect_setup( wisp_world* world );

static inline wisp_entity hang( wisp_world* world, wisp_cloth_bending bending, bool is_implicit )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 21, 0.05f );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.hinges = bending != WISP_CLOTH_BENDING_LINKS;
    wisp_surface_def surface = support_weightless_surface_def();
    const int32_t pins[2] = { 0, 20 };
    surface.pins = pins;
    surface.pin_count = 2;
    const wisp_entity e = test_surface_of( world, &fabric, surface );
    wisp_cloth_def cloth = undamped_cloth();
    cloth.bending = bending;
    const wisp_implicit_cloth_def implicit = wisp_default_implicit_cloth_def();
    assert_status( world,
                   is_implicit ? wisp_set_implicit_cloth( world, e, &implicit ) : wisp_set_cloth( world, e, &cloth ),
                   WISP_OK );
    assert_status( world, wisp_set_gravity( world, e, EARTH ), WISP_OK );
    assert_status( world, wisp_set_damping( world, e, 3.0f ), WISP_OK );
    return e;
}

static inline wisp_entity cloth_of_links( wisp_world* world )
{
    return hang( world, WISP_CLOTH_BENDING_LINKS, false );
}

static inline wisp_entity dihedral_cloth( wisp_world* world )
{
    return hang( world, WISP_CLOTH_BENDING_DIHEDRAL, false );
}

static inline wisp_entity isometric_cloth( wisp_world* world )
{
    return hang( world, WISP_CLOTH_BENDING_ISOMETRIC, false );
}

static inline wisp_entity implicit_cloth( wisp_world* world )
{
    return hang( world, WISP_CLOTH_BENDING_LINKS, true );
}

// Without gravity, so that it stays: it swells and comes to rest.
static inline wisp_entity balloon( wisp_world* world )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_ball( 3 );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        mesh.points[v] = ( wisp_vec3 ){ 0.2f * mesh.points[v].x, 0.2f * mesh.points[v].y, 0.2f * mesh.points[v].z };
    }
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    const wisp_entity e = test_surface_of( world, &fabric, support_weightless_surface_def() );
    SET( world, e, balloon, d.gas_ratio = 1.5f );
    assert_status( world, wisp_set_damping( world, e, 3.0f ), WISP_OK );
    return e;
}

static inline wisp_entity hair( wisp_world* world, wisp_strand_stretch stretch )
{
    wisp_vec3 points[4 * 12];
    int32_t offsets[5];
    for ( int v = 0; v < 48; ++v )
    {
        points[v] = ( wisp_vec3 ){ 0.01f * (float)( v % 12 ), 0.0f, 0.01f * (float)( v / 12 ) };
    }
    for ( int s = 0; s < 5; ++s )
    {
        offsets[s] = 12 * s;
    }
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = 4;
    wisp_entity e;
    assert_status( world, wisp_add_strands( world, &def, &e ), WISP_OK );
    SET( world, e, strand_dynamics, d.stretch = stretch,
         d.bending = stretch == WISP_STRAND_STRETCH_LINKS ? WISP_STRAND_BEND_LINKS : WISP_STRAND_BEND_ROD,
         d.damping = 3.0f );
    return e;
}

static inline wisp_entity hair_of_links( wisp_world* world )
{
    return hair( world, WISP_STRAND_STRETCH_LINKS );
}

static inline wisp_entity hair_of_rods( wisp_world* world )
{
    return hair( world, WISP_STRAND_STRETCH_DIRECT );
}
