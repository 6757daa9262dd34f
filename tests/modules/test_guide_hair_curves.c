// The engine's curves against the oracle, and the properties in Eq. 6 and Fig. 3. The strands are a metre from the
// origin, so a float is exact to 6e-8 m, and the four weights of a sample sum to 1 within as much.
#include "guide_hair_fixture.h"

static const double tolerance = 5e-7; // m

enum
{
    STRANDS = 37,
    LONGEST = 13,
    MAX_POINTS = 16 * LONGEST + 1,
};

typedef struct tuft
{
    int counts[STRANDS], first[STRANDS + 1];
    double3 nodes[STRANDS * LONGEST];
} tuft;

static tuft make_tuft( int least, int most )
{
    tuft t = { .first = { 0 } };
    for ( int s = 0; s < STRANDS; ++s )
    {
        t.counts[s] = least + ( 5 * s ) % ( most - least + 1 );
        t.first[s + 1] = t.first[s] + t.counts[s];
        double3 p = random_vector( s, 0 );
        for ( int i = 0; i < t.counts[s]; ++i )
        {
            p = double3_add( p, double3_scale( 0.03, random_vector( 100 + s, i ) ) );
            t.nodes[t.first[s] + i] = guide_round( p );
        }
    }
    return t;
}

typedef struct drawn
{
    wisp_world* world;
    wisp_entity source, curves;
    wisp_curves_def def;
} drawn;

static drawn draw( const tuft* t, wisp_curve_kind kind, int samples, const guide_host* host )
{
    drawn d = { .world = guide_world( host ), .def = wisp_default_curves_def() };
    d.source = guide_add_mixed( d.world, t->nodes, STRANDS, t->counts );
    d.def.source = d.source;
    d.def.kind = kind;
    d.def.samples = samples;
    guide_ok( d.world, wisp_add_curves( d.world, &d.def, &d.curves ) );
    guide_ok( d.world, wisp_request( d.world, d.curves, WISP_STRAND_POINTS ) );
    return d;
}

static int expected( const double3* nodes, int count, wisp_curve_kind kind, int samples, double3* points )
{
    static const guide_oracle_curve curves[] = {
        [WISP_CURVE_BEZIER] = GUIDE_ORACLE_CURVE_JOINED,
        [WISP_CURVE_CATMULL_ROM] = GUIDE_ORACLE_CURVE_SMOOTH,
    };
    const guide_oracle_curve curve = curves[kind];
    double3 controls[4 * LONGEST];
    guide_oracle_curve_controls( nodes, count, curve, controls );
    return guide_oracle_draw( controls, guide_oracle_curve_count( count, curve ), samples, false, points );
}

// Every sample of every strand against the oracle.
static void check( const drawn* d, const tuft* t, const double3* nodes )
{
    const wisp_vec3* points = guide_points( d->world, d->curves );
    int at = 0;
    for ( int s = 0; s < STRANDS; ++s )
    {
        double3 reference[MAX_POINTS];
        const int count = expected( nodes + t->first[s], t->counts[s], d->def.kind, d->def.samples, reference );
        for ( int k = 0; k < count; ++k, ++at )
        {
            assert_at( double3_widen( points[at] ), reference[k], tolerance );
        }
    }
    wisp_view view;
    guide_ok( d->world, wisp_world_view( d->world, d->curves, WISP_STRAND_POINTS, &view ) );
    assert_int_equal( view.count, at );
}

// Lengths from no vertex to thirteen; with Bezier groups lanes do not keep the order of their strands.
TEST( curves_of_all_lengths_are_the_oracles )
{
    const int samples[] = { 1, 2, 8, 16 };
    const tuft t = make_tuft( 0, LONGEST ), even = make_tuft( 10, 10 );
    for ( int kind = 0; kind < WISP_CURVE_KIND_COUNT; ++kind )
    {
        for ( int n = 0; n < WISP_COUNT( samples ); ++n )
        {
            drawn d = draw( &t, (wisp_curve_kind)kind, samples[n], NULL );
            guide_step( d.world );
            check( &d, &t, t.nodes );
            wisp_world_destroy( d.world );
            d = draw( &even, (wisp_curve_kind)kind, samples[n], NULL );
            guide_step( d.world );
            check( &d, &even, even.nodes );
            wisp_world_destroy( d.world );
        }
    }
}

TEST( curves_follow_their_source_and_a_source_that_stays_is_not_drawn_again )
{
    const tuft t = make_tuft( 2, LONGEST );
    drawn d = draw( &t, WISP_CURVE_BEZIER, 8, NULL );
    double3 moved[STRANDS * LONGEST];
    for ( int step = 0; step < 5; ++step )
    {
        for ( int n = 0; n < t.first[STRANDS]; ++n )
        {
            // a translation commutes with the curve; another shape is computed again
            moved[n] =
                guide_round( double3_add( t.nodes[n], step < 3 ? double3_make( 0.25 * step, -0.5, 0.125 )
                                                               : double3_scale( 0.1, random_vector( n, step ) ) ) );
        }
        guide_write( d.world, d.source, WISP_STRAND_POSITION, moved );
        guide_step( d.world );
        check( &d, &t, moved );
        guide_step( d.world );
        const wisp_profile profile = wisp_world_profile( d.world );
        for ( int i = 0; i < profile.count; ++i )
        {
            const bool draws = strcmp( profile.lines[i].pass, "guide_hair.curves" ) == 0;
            assert_true( draws == false || profile.lines[i].items == 0 );
        }
        check( &d, &t, moved );
    }
    wisp_world_destroy( d.world );
}

// Fig. 3: both kinds that are smooth, at every drawn joint, on arcs and helices of 4, 7, 10 and 13 vertices and others between
TEST( curves_turn_less_at_every_joint_than_the_strands_they_smooth )
{
    static const wisp_curve_kind kinds[] = { WISP_CURVE_BEZIER, WISP_CURVE_CATMULL_ROM };
    for ( int n = 0; n < 2 * 2 * ( LONGEST - 3 ); ++n )
    {
        const wisp_curve_kind kind = kinds[n % 2];
        const int length = 4 + n / 4;
        tuft t = make_tuft( length, length );
        for ( int k = 0; k < STRANDS * length; ++k )
        {
            const double angle = ( 0.1 + 0.03 * ( k / length ) ) * ( k % length ), rise = n / 2 % 2 == 0 ? 0.0 : 0.01;
            t.nodes[k] =
                guide_round( double3_make( 0.02 * cos( angle ), -rise * ( k % length ), 0.02 * sin( angle ) ) );
        }
        drawn d = draw( &t, kind, 8, NULL );
        guide_step( d.world );
        const int count = 8 * ( kind == WISP_CURVE_BEZIER ? ( length + 1 ) / 3 : length - 1 ) + 1;
        const wisp_vec3* points = guide_points( d.world, d.curves );
        for ( int s = 0; s < STRANDS; ++s )
        {
            double3 curve[MAX_POINTS];
            for ( int k = 0; k < count; ++k )
            {
                curve[k] = double3_widen( points[s * count + k] );
            }
            const double3* nodes = t.nodes + t.first[s];
            assert_true( guide_oracle_largest_turn( curve, count ) < guide_oracle_largest_turn( nodes, length ) );
            assert_at( curve[0], nodes[0], 0.0 );
            assert_at( curve[count - 1], nodes[length - 1], 0.0 );
        }
        wisp_world_destroy( d.world );
    }
}

// The curve shows the source after its appearance effect, in the same step.
TEST( curves_are_drawn_behind_the_appearance_of_their_source )
{
    for ( int workers = 1; workers <= 2; ++workers )
    {
        const guide_host host = { .workers = workers };
        const tuft t = make_tuft( 3, LONGEST );
        drawn d = draw( &t, WISP_CURVE_CATMULL_ROM, 4, &host );
        wisp_frozen_hair_def look = wisp_default_frozen_hair_def();
        look.update_on = WISP_FROZEN_UPDATE_FRAME;
        guide_ok( d.world, wisp_set_frozen_hair( d.world, d.source, &look ) );
        guide_ok( d.world, wisp_request( d.world, d.source, WISP_STRAND_POINTS ) );
        for ( int step = 0; step < 5; ++step )
        {
            guide_step( d.world );
            double3 frozen[STRANDS * LONGEST];
            const wisp_vec3* points = guide_points( d.world, d.source );
            for ( int n = 0; n < t.first[STRANDS]; ++n )
            {
                frozen[n] = double3_widen( points[n] );
            }
            check( &d, &t, frozen );
        }
        wisp_world_destroy( d.world );
    }
}

TEST( when_the_source_goes_its_curves_stay )
{
    const tuft t = make_tuft( 2, LONGEST );
    drawn d = draw( &t, WISP_CURVE_CATMULL_ROM, 8, NULL );
    guide_step( d.world );
    guide_ok( d.world, wisp_remove( d.world, d.source ) );
    guide_step( d.world );
    check( &d, &t, t.nodes );

    // and a source whose curves are removed is released: nothing runs for it
    drawn other = draw( &t, WISP_CURVE_BEZIER, 8, NULL );
    guide_step( other.world );
    guide_ok( other.world, wisp_remove( other.world, other.curves ) );
    assert_int_equal( wisp_world_plan_passes( other.world ), 0 );
    guide_step( other.world );
    wisp_world_destroy( other.world );
    wisp_world_destroy( d.world );
}

static void refuse( wisp_world* world, wisp_curves_def def, wisp_status status, const char* word )
{
    wisp_entity out = { 7, 7 };
    assert_int_equal( wisp_add_curves( world, &def, &out ), status );
    assert_int_equal( out.index, 0 );
    assert_contains( wisp_world_message( world ), word );
}

TEST( curves_that_cannot_be_are_refused_by_name )
{
    const tuft t = make_tuft( 2, LONGEST );
    drawn d = draw( &t, WISP_CURVE_BEZIER, 8, NULL );
    wisp_curves_def def = d.def;
    def.samples = 0;
    refuse( d.world, def, WISP_BAD_INPUT, "samples" );
    def.samples = 65;
    refuse( d.world, def, WISP_BAD_INPUT, "samples" );
    def = d.def;
    def.kind = WISP_CURVE_KIND_COUNT;
    refuse( d.world, def, WISP_BAD_INPUT, "kind" );
    def = d.def;
    def.source = d.curves;
    refuse( d.world, def, WISP_CONFLICT, "holds curves" );
    def.source = ( wisp_entity ){ 0, 0 };
    refuse( d.world, def, WISP_CONFLICT, "does not exist" );
    guide_ok( d.world, wisp_world_add_pairs( d.world, 0, &def.source ) );
    refuse( d.world, def, WISP_CONFLICT, "no strands" );
    wisp_world_destroy( d.world );
}
