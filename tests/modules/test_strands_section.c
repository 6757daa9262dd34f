// Rods with an elliptic section against closed forms: cantilevers flat, on edge and askew, natural twist, lateral buckling;
// what is refused.
#include "strand_section_fixture.h"

static const float FRAME = 1.0f / 60.0f;

static const wisp_vec3 ALONG_X = { 1.0f, 0.0f, 0.0f };

static void assert_fraction( double measured, double reference, double tolerance, const char* what )
{
    // written so that a NaN fails
    if ( !( fabs( measured / reference - 1.0 ) <= tolerance ) )
    {
        fail_msg( "%s: %.9g measured, %.9g by the closed form: %.4f %% off, tolerated %.4f %%", what, measured,
                  reference, 100.0 * ( measured / reference - 1.0 ), 100.0 * tolerance );
    }
}

// ---- cantilevers ----

// The tip of a cantilever of 1 m along x under 0.05 N/m along -y, after so many steps.
static wisp_vec3 tip_after( int steps, wisp_strand_dynamics_def def )
{
    enum
    {
        COUNT = 33,
    };
    wisp_vec3 points[COUNT];
    lay_rod( ALONG_X, 1.0f, COUNT, points );
    def.gravity = ( wisp_vec3 ){ 0.0f, -0.05f, 0.0f };
    def.damping = 5.0f;
    rod_world rod;
    open_rod( &rod, points, COUNT, 8, &def );
    strand_steps( rod.s.world, steps, FRAME );
    const wisp_vec3 tip = rod_point( &rod, COUNT - 1 );
    close_rod( &rod );
    return tip;
}

// The same at rest.
static wisp_vec3 sagged_tip( wisp_strand_dynamics_def def )
{
    return tip_after( 600, def );
}

static wisp_strand_dynamics_def ribbon_def( wisp_vec3 normal )
{
    wisp_strand_dynamics_def def = rod_def( 0.1f, 1.0f );
    def.edgewise_rigidity = 1.0f;
    def.flat_normal = normal;
    return def;
}

TEST( a_ribbon_sags_as_the_rod_that_it_is_in_each_plane )
{
    const wisp_vec3 flat = sagged_tip( ribbon_def( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } ) );
    const wisp_vec3 on_edge = sagged_tip( ribbon_def( ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f } ) );
    const wisp_vec3 soft = sagged_tip( rod_def( 0.1f, 1.0f ) ), stiff = sagged_tip( rod_def( 1.0f, 1.0f ) );
    // w L^4 / 8 EI, off by the square of a segment over the length, 0.1 %, and on the flat side by the large rotation
    assert_fraction( -(double)on_edge.y, 0.05 / 8.0, 2e-3, "on edge, m" );
    assert_fraction( -(double)flat.y, (double)-soft.y, 1e-4, "flat, m" );
    assert_fraction( -(double)on_edge.y, (double)-stiff.y, 1e-4, "as a round rod, m" );
    assert_true( fabsf( flat.z ) < 1e-6f && fabsf( on_edge.z ) < 1e-6f );
}

// Askew by 45 degrees the load has a part in each plane, and the tip moves sideways.
TEST( a_ribbon_askew_deflects_sideways )
{
    wisp_strand_dynamics_def def = ribbon_def( ( wisp_vec3 ){ 0.0f, 1.0f, 1.0f } );
    def.bend_rigidity = 0.5f; // small rotations
    const wisp_vec3 tip = sagged_tip( def );
    const double flat = 0.05 / ( 8.0 * 0.5 ), edge = 0.05 / 8.0;
    assert_fraction( -(double)tip.y, 0.5 * ( flat + edge ), 5e-3, "down, m" );
    assert_fraction( -(double)tip.z, 0.5 * ( flat - edge ), 5e-3, "sideways, m" );
}

// The flat side turns along the rod. Under a small load the tip sinks by the integral of q (L - s)^3 / 2 times the
// compliance in the plane of the load at s, cos^2 / EI + sin^2 / EI'.
TEST( natural_twist_turns_the_flat_side_along_the_rod )
{
    const double twist = 3.141592653589793;
    wisp_strand_dynamics_def def = ribbon_def( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    def.bend_rigidity = 0.5f;
    def.natural_twist = (float)twist;
    double sum = 0.0;
    for ( int i = 0; i < 1000; ++i )
    {
        const double s = ( i + 0.5 ) / 1000.0, c = cos( twist * s );
        sum += 0.05 * 0.5 * pow( 1.0 - s, 3.0 ) * ( c * c / 0.5 + ( 1.0 - c * c ) ) / 1000.0;
    }
    assert_fraction( -(double)sagged_tip( def ).y, sum, 5e-3, "twisted ribbon, m" );
    def.rest = WISP_STRAND_REST_SHAPE;
    assert_fraction( -(double)sagged_tip( def ).y, sum, 5e-3, "twisted ribbon of its shape, m" );
    def.rest = WISP_STRAND_REST_SAG_FREE;
    assert_true( fabsf( sagged_tip( def ).y ) < 1e-5f );
}

// ---- lateral buckling ----

// How far the tip of a deep cantilever with a point load at its end moves sideways, over a sideways load of a thousandth.
static double sideways( float load, float edgewise )
{
    enum
    {
        COUNT = 17,
    };
    wisp_vec3 points[COUNT];
    float masses[COUNT];
    lay_rod( ALONG_X, 1.0f, COUNT, points );
    for ( int i = 0; i < COUNT; ++i )
    {
        masses[i] = i + 1 < COUNT ? 1e-4f : 0.1f;
    }
    wisp_strand_dynamics_def def = rod_def( 1.0f, 1.0f );
    def.edgewise_rigidity = edgewise;
    def.flat_normal = ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f };
    def.gravity = ( wisp_vec3 ){ 0.0f, -10.0f * load, 1e-3f * load };
    def.vertex_masses = masses;
    def.damping = 3.0f;
    rod_world rod;
    open_rod( &rod, points, COUNT, 16, &def );
    strand_steps( rod.s.world, 1200, FRAME );
    const double z = (double)rod_point( &rod, COUNT - 1 ).z / (double)load;
    close_rod( &rod );
    return z;
}

// P = 4.013 sqrt( EI GJ ) / L^2 (Prandtl 1899, Michell 1899), over sqrt( ( 1 - EI/EI' ) ( 1 - GJ/EI' ) ) because the bent
// beam is an arch. Below it a sideways load is amplified by 1 / ( 1 - (P / P_cr)^2 ).
TEST( a_deep_cantilever_buckles_sideways_at_the_load_of_prandtl )
{
    const double low = 1.0, high = 3.8 * 3.8, amplified = sideways( 1.0f, 200.0f ) / sideways( 3.8f, 200.0f );
    const double critical = sqrt( ( high - amplified * low ) / ( 1.0 - amplified ) );
    assert_fraction( critical, 4.013 / ( 1.0 - 1.0 / 200.0 ), 0.03, "lateral buckling, N" );
}

// ---- the flattest section ----

// EI is what flatness in single precision leaves of EI'. Across the flat side motion is slow, so it takes long to rest.
TEST( the_flattest_ribbons_sag_as_the_rod_that_they_are )
{
    wisp_strand_dynamics_def def = ribbon_def( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    const double round = (double)tip_after( 3000, rod_def( 0.1f, 1.0f ) ).y;
    def.edgewise_rigidity = 1e4f * def.bend_rigidity;
    assert_fraction( (double)tip_after( 3000, def ).y, round, 1e-3, "1e4 times stiffer on edge, m" );
    def.edgewise_rigidity = 1e5f * def.bend_rigidity;
    assert_fraction( (double)tip_after( 3000, def ).y, round, 0.02, "1e5 times stiffer on edge, m" );
}

// ---- refusals ----

TEST( sections_that_cannot_be_are_refused )
{
    wisp_vec3 points[3];
    lay_rod( ALONG_X, 1.0f, 3, points );
    const wisp_strand_dynamics_def good = ribbon_def( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    rod_world rod;
    open_rod( &rod, points, 3, 1, &good );
    wisp_strand_dynamics_def bad[7] = { good, good, good, good, good, good, good };
    bad[0].edgewise_rigidity = 0.05f;
    bad[1].edgewise_rigidity = NAN;
    bad[2].edgewise_rigidity = 0.0f;
    bad[3].natural_twist = INFINITY;
    bad[4].flat_normal.x = NAN;
    bad[5].bending = WISP_STRAND_BEND_NONE;
    bad[6].edgewise_rigidity = 1.1e5f * good.bend_rigidity;
    for ( int i = 0; i < WISP_COUNT( bad ); ++i )
    {
        assert_int_equal( wisp_set_strand_dynamics( rod.s.world, rod.e, bad + i ), WISP_BAD_INPUT );
        assert_non_null( strstr( wisp_world_message( rod.s.world ), "strands: " ) );
    }
    strand_steps( rod.s.world, 1, FRAME );
    close_rod( &rod );
}
