// Level of detail: what is not solved goes along with its pins, its frame or its head, as rigid motions in closed form do;
// ghosts with the roots of their targets, and the way back.
#include "detail_fixture.h"
#include "strands_fixture.h"

#include "guide_hair.h"

#include "wisp/detail.h"
#include "wisp/moving_frame.h"

// ---- ghosts ----

typedef struct grown
{
    hosted h;
    wisp_entity guides, ghosts;
} grown;

static wisp_vec3 beside( int strand, int i, int count, float length )
{
    const wisp_vec3 p = straight_out( strand / 4, i, count, length );
    return ( wisp_vec3 ){ p.x, p.y + 0.002f * (float)( strand % 4 ), p.z + 0.001f * (float)( strand % 3 ) };
}

static void grow( grown* g, int workers, bool has_head )
{
    static const wisp_module* const MODULES[] = { &wisp_strands_module, &wisp_guide_hair_module };
    prepare_strands( &g->h, MODULES, WISP_COUNT( MODULES ) );
    g->h.def.workers = workers;
    g->h.def.substeps = 4;
    open_prepared( &g->h );
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.damping = 2.0f;
    int counts[80];
    for ( int s = 0; s < WISP_COUNT( counts ); ++s )
    {
        counts[s] = 12;
    }
    g->guides = has_head ? add_moving( g->h.world, 20, 12, straight_out, 0.12f, &dynamics )
                         : add_strands( g->h.world, counts, 20, straight_out, 0.12f );
    g->ghosts = add_strands( g->h.world, counts, 80, beside, 0.12f );
    SET( g->h.world, g->ghosts, ghosts, d.targets = g->guides );
    assert_status( g->h.world, wisp_request( g->h.world, g->ghosts, WISP_STRAND_POINTS ), WISP_OK );
}

static wisp_transform pose_of_head( int step )
{
    const float angle = 0.04f * (float)step;
    return wisp_transform_make( ( wisp_quat ){ 0.0f, sinf( 0.5f * angle ), 0.0f, cosf( 0.5f * angle ) },
                                ( wisp_vec3 ){ 0.01f * (float)step, 0.0f, 0.0f } );
}

static void move_and_step( grown* g, int step )
{
    assert_status( g->h.world, wisp_move_strand_head( g->h.world, g->guides, pose_of_head( step ) ), WISP_OK );
    strand_steps( g->h.world, 1, FRAME );
}

static const wisp_vec3* ghosts_now( grown* g )
{
    return view_of( g->h.world, g->ghosts, WISP_STRAND_POINTS ).data;
}

enum
{
    POINTS = 80 * 12,
};

static float largest_distance( const wisp_vec3* a, const wisp_vec3* b )
{
    float most = 0.0f;
    for ( int v = 0; v < POINTS; ++v )
    {
        most = fmaxf( most, distance( a[v], b[v] ) );
    }
    return most;
}

static bool runs( grown* g, const char* pass )
{
    const wisp_profile profile = wisp_world_profile( g->h.world );
    bool found = false;
    for ( int i = 0; i < profile.count; ++i )
    {
        found = found || ( strcmp( profile.lines[i].pass, pass ) == 0 && profile.lines[i].items > 0 );
    }
    return found;
}

// The guides go on moving, and what ghosts would do is not computed.
TEST( coarse_ghosts_go_along_with_the_head )
{
    grown g;
    grow( &g, 1, true );
    int step = 0;
    set_level( g.h.world, g.ghosts, WISP_DETAIL_FULL ); // the shape that is kept is not that of the first call
    while ( step < 20 )
    {
        move_and_step( &g, ++step );
    }
    wisp_vec3 from[POINTS], expected[POINTS];
    memcpy( from, ghosts_now( &g ), sizeof( from ) );
    const wisp_transform before = pose_of_head( step );
    set_level( g.h.world, g.ghosts, WISP_DETAIL_COARSE );
    while ( step < 60 )
    {
        move_and_step( &g, ++step );
        for ( int v = 0; v < POINTS; ++v )
        {
            expected[v] = wisp_transform_to_world( pose_of_head( step ), wisp_transform_to_local( before, from[v] ) );
        }
        assert_true( largest_distance( ghosts_now( &g ), expected ) < 1e-6f );
        assert_false( runs( &g, "guide_hair.ghosts" ) );
        assert_true( runs( &g, "strands.predict" ) );
    }
    close_world( &g.h );
}

// A ghost has no state of its own, so after the blend it has the bits that it would have had.
TEST( ghosts_that_are_computed_again_come_back )
{
    grown a, b;
    grow( &a, 1, true );
    grow( &b, 1, true );
    float apart = 0.0f, closest = 0.0f;
    wisp_vec3 offset[POINTS] = { { 0.0f, 0.0f, 0.0f } }, before[POINTS];
    for ( int step = 1; step <= 60; ++step )
    {
        if ( step == 10 )
        {
            set_level( a.h.world, a.ghosts, WISP_DETAIL_COARSE );
        }
        if ( step == 30 )
        {
            set_level( a.h.world, a.ghosts, WISP_DETAIL_FULL );
        }
        if ( step == 37 )
        {
            set_level( a.h.world, a.ghosts, WISP_DETAIL_FEWER_SUBSTEPS ); // the same for ghosts
        }
        move_and_step( &a, step );
        move_and_step( &b, step );
        const wisp_vec3 *p = ghosts_now( &a ), *full = ghosts_now( &b );
        memcpy( before, offset, sizeof( before ) );
        for ( int v = 0; v < POINTS; ++v )
        {
            offset[v] = ( wisp_vec3 ){ p[v].x - full[v].x, p[v].y - full[v].y, p[v].z - full[v].z };
        }
        apart = step < 30 ? largest_distance( p, full ) : apart;
        closest = step >= 30 ? fmaxf( closest, largest_distance( offset, before ) ) : closest;
        if ( step >= 44 )
        {
            assert_memory_equal( p, full, sizeof( offset ) );
        }
    }
    assert_true( apart > 0.01f && closest < apart / 5.0f ); // it comes nearer in fifteen steps
    close_world( &a.h );
    close_world( &b.h );
}

TEST( ghosts_of_strands_without_roots_stay )
{
    grown g;
    grow( &g, 1, false );
    strand_steps( g.h.world, 2, FRAME );
    wisp_vec3 from[POINTS];
    memcpy( from, ghosts_now( &g ), sizeof( from ) );
    set_level( g.h.world, g.ghosts, WISP_DETAIL_COARSE );
    strand_steps( g.h.world, 5, FRAME );
    assert_true( largest_distance( ghosts_now( &g ), from ) < 1e-7f );
    wisp_detail_def def = wisp_default_detail_def();
    def.level = WISP_DETAIL_COARSE;
    expect_refusal( g.h.world, wisp_set_detail( g.h.world, g.guides, &def ), WISP_CONFLICT,
                    "strands that follow others" );
    assert_status( g.h.world, wisp_remove( g.h.world, g.guides ), WISP_OK );
    strand_steps( g.h.world, 2, FRAME ); // nothing to follow
    close_world( &g.h );
}
