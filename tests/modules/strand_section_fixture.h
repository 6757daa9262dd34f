/// Rods of one strand, or of several alike, for tests of sections and of tips that are held.
#pragma once

#include "strands_fixture.h"

enum
{
    ROD_VERTICES_MAX = 128,
};

/// One entity in a world of its own.
typedef struct rod_world
{
    hosted s;
    wisp_entity e;
    int count; ///< vertices
} rod_world;

/// A rod that is straight without load, 1 m long in most tests: EI and GJ in N m^2, 1 kg/m, no gravity.
static inline wisp_strand_dynamics_def rod_def( float bend_rigidity, float twist_rigidity )
{
    wisp_strand_dynamics_def def = undamped_hair();
    def.rest = WISP_STRAND_REST_STRAIGHT;
    def.bend_rigidity = bend_rigidity;
    def.twist_rigidity = twist_rigidity;
    def.line_density = 1.0f;
    def.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    return def;
}

/// Close with close_rod().
static inline void open_rod( rod_world* rod, const wisp_vec3* points, int count, int substeps,
                             const wisp_strand_dynamics_def* dynamics )
{
    rod->count = count;
    const int32_t offsets[2] = { 0, count };
    open_strands( &rod->s, substeps, 1, 1 );
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = 1;
    assert_int_equal( wisp_add_strands( rod->s.world, &def, &rod->e ), WISP_OK );
    if ( wisp_set_strand_dynamics( rod->s.world, rod->e, dynamics ) != WISP_OK )
    {
        fail_msg( "no dynamics: %s", wisp_world_message( rod->s.world ) );
    }
    assert_int_equal( wisp_request( rod->s.world, rod->e, WISP_STRAND_POINTS ), WISP_OK );
}

static inline void close_rod( rod_world* rod )
{
    assert_false( wisp_is_halted( rod->s.world, rod->e ) );
    close_world( &rod->s );
}

/// Straight along a unit direction.
static inline void lay_rod( wisp_vec3 direction, float length, int count, wisp_vec3* points )
{
    for ( int v = 0; v < count; ++v )
    {
        const float along = length * (float)v / (float)( count - 1 );
        points[v] = ( wisp_vec3 ){ along * direction.x, along * direction.y, along * direction.z };
    }
}

static inline void hold_tip( rod_world* rod, wisp_strand_tip hold )
{
    if ( wisp_hold_strand_tip( rod->s.world, rod->e, 0, hold ) != WISP_OK )
    {
        fail_msg( "no hold: %s", wisp_world_message( rod->s.world ) );
    }
}

/// Turn the tip about an axis by so many rad, beyond half a turn in several calls.
static inline void turn_tip( rod_world* rod, wisp_vec3 axis, double angle, wisp_vec3 displacement )
{
    const float s = (float)sin( 0.5 * angle ), c = (float)cos( 0.5 * angle );
    const wisp_quat turn = { s * axis.x, s * axis.y, s * axis.z, c };
    assert_int_equal( wisp_move_strand_tip( rod->s.world, rod->e, 0, ( wisp_transform ){ turn, displacement } ),
                      WISP_OK );
}

static inline wisp_vec3 rod_point( const rod_world* rod, int i )
{
    return strand_points( rod->s.world, rod->e )[i];
}
