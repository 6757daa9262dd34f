/// Shared by the tests of strands: worlds with chosen workers and substeps, strands that hang, stick out or curl,
/// plans as text.
#pragma once

#include "engine/surface_fixture.h"
#include "plan_says.h"

#include "collision.h"
#include "strands.h"

/// The hair of a test of free motion.
static inline wisp_strand_dynamics_def undamped_hair( void )
{
    wisp_strand_dynamics_def hair = wisp_default_strand_dynamics_def();
    hair.damping = 0.0f;
    return hair;
}

/// A world of these modules that is not created yet: further settings go into s->def. Modules live as long as it
/// does.
static inline void prepare_strands( hosted* s, const wisp_module* const* modules, int module_count )
{
    *s = ( hosted ){ 0 };
    s->def = wisp_default_world_def();
    s->def.substeps = 1;
    s->def.modules = modules;
    s->def.module_count = module_count;
    s->def.allocator = test_host_allocator( &s->host );
    s->def.log = test_log_write;
    s->def.log_user = &s->log;
}

/// Close with close_world().
static inline void open_prepared( hosted* s )
{
    assert_int_equal( wisp_world_create( &s->def, &s->world, NULL ), WISP_OK );
}

static inline void open_strands( hosted* s, int substeps, int iterations, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module,
                                                  &wisp_strand_appearance_module, &wisp_strands_module };
    prepare_strands( s, MODULES, WISP_COUNT( MODULES ) );
    s->def.workers = workers;
    s->def.substeps = substeps;
    s->def.iterations = iterations;
    open_prepared( s );
}

/// Position of vertex i of a strand of `count` vertices; `length` is the strand's, in m.
typedef wisp_vec3 strand_curve( int strand, int i, int count, float length );

/// Out along x.
static inline wisp_vec3 straight_out( int strand, int i, int count, float length )
{
    return ( wisp_vec3 ){ length * (float)i / (float)( count > 1 ? count - 1 : 1 ), 0.0f, 0.01f * (float)strand };
}

/// Down along -y.
static inline wisp_vec3 straight_down( int strand, int i, int count, float length )
{
    return ( wisp_vec3 ){ 0.01f * (float)strand, -length * (float)i / (float)( count > 1 ? count - 1 : 1 ), 0.0f };
}

/// A helix of two turns that grows down, its radius a tenth of the length.
static inline wisp_vec3 curl_down( int strand, int i, int count, float length )
{
    const float t = (float)i / (float)( count > 1 ? count - 1 : 1 ), angle = 12.566f * t + (float)strand;
    const float radius = 0.1f * length;
    return ( wisp_vec3 ){ 0.01f * (float)strand + radius * ( cosf( angle ) - cosf( (float)strand ) ),
                          -0.6f * length * t, radius * ( sinf( angle ) - sinf( (float)strand ) ) };
}

/// Strands of the given vertex counts. @param counts [strand_count]
static inline wisp_entity add_strands( wisp_world* world, const int* counts, int strand_count, strand_curve* curve,
                                       float length )
{
    int32_t* offsets = checked_calloc( (size_t)strand_count + 1, sizeof( int32_t ) );
    for ( int s = 0; s < strand_count; ++s )
    {
        offsets[s + 1] = offsets[s] + counts[s];
    }
    wisp_vec3* points = checked_calloc( (size_t)offsets[strand_count] + 1, sizeof( wisp_vec3 ) );
    for ( int s = 0; s < strand_count; ++s )
    {
        for ( int i = 0; i < counts[s]; ++i )
        {
            points[offsets[s] + i] = curve( s, i, counts[s], length );
        }
    }
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = strand_count;
    wisp_entity e;
    if ( wisp_add_strands( world, &def, &e ) != WISP_OK )
    {
        fail_msg( "no strands: %s", wisp_world_message( world ) );
    }
    free( points );
    free( offsets );
    return e;
}

/// As add_strands, all of one vertex count, with dynamics; points are requested.
static inline wisp_entity add_moving( wisp_world* world, int strand_count, int vertex_count, strand_curve* curve,
                                      float length, const wisp_strand_dynamics_def* def )
{
    int counts[256];
    assert_true( strand_count <= WISP_COUNT( counts ) );
    for ( int s = 0; s < strand_count; ++s )
    {
        counts[s] = vertex_count;
    }
    const wisp_entity e = add_strands( world, counts, strand_count, curve, length );
    if ( wisp_set_strand_dynamics( world, e, def ) != WISP_OK )
    {
        fail_msg( "no dynamics: %s", wisp_world_message( world ) );
    }
    assert_int_equal( wisp_request( world, e, WISP_STRAND_POINTS ), WISP_OK );
    return e;
}

static inline void strand_steps( wisp_world* world, int steps, float seconds )
{
    for ( int i = 0; i < steps; ++i )
    {
        if ( wisp_world_step( world, seconds ) != WISP_OK )
        {
            fail_msg( "no step: %s", wisp_world_message( world ) );
        }
    }
}

static inline const wisp_vec3* strand_points( wisp_world* world, wisp_entity e )
{
    return view_of( world, e, WISP_STRAND_POINTS ).data;
}

static inline wisp_transform head_at( float angle, wisp_vec3 axis, wisp_vec3 place )
{
    const float s = sinf( 0.5f * angle );
    return wisp_transform_make( ( wisp_quat ){ s * axis.x, s * axis.y, s * axis.z, cosf( 0.5f * angle ) }, place );
}

/// A measured value agrees with a closed form to this fraction of it.
static inline void assert_fraction( double measured, double reference, double tolerance, const char* what )
{
    // written so that a NaN fails
    if ( !( fabs( measured / reference - 1.0 ) <= tolerance ) )
    {
        fail_msg( "%s: %.9g measured, %.9g by the closed form: %.4f %% off, tolerated %.4f %%", what, measured,
                  reference, 100.0 * ( measured / reference - 1.0 ), 100.0 * tolerance );
    }
}
