// Triangulations in integers, each checked by the definition: covered once, connected, circles empty.
#include "delaunay_fixture.h"

#include "wisp/module/random.h"

enum
{
    MAX_POINTS = 4000,
    LAST = DELAUNAY_SIDE - 1,
};

static const double TAU = 6.28318530717958648;

typedef struct places
{
    delaunay_point points[MAX_POINTS];
    int32_t triangles[6 * MAX_POINTS];
    int count, outline_count;
} places;

static places set; // too large for a stack

static void begin( void )
{
    set.count = set.outline_count = 0;
}

static void put( int32_t x, int32_t y )
{
    assert_true( set.count < MAX_POINTS );
    set.points[set.count++] = ( delaunay_point ){ x, y };
}

static void end_outline( void )
{
    set.outline_count = set.count;
}

static wisp_status fill( wisp_error* error )
{
    return delaunay_fill( set.points, set.count, set.outline_count, set.triangles, "set", error );
}

static fixture_net filled( void )
{
    wisp_error error = { .status = WISP_OK };
    assert_ok( fill( &error ), error );
    return ( fixture_net ){ set.points, set.count, set.outline_count, set.triangles,
                            delaunay_triangle_count( set.count, set.outline_count ) };
}

// @return number of points in circles that are hidden by the outline
static int assert_sound( void )
{
    fixture_net net = filled();
    assert_covers( &net );
    assert_joined_and_delaunay( &net );
    return assert_empty_circles( &net );
}

static void put_square( int32_t lower, int32_t upper )
{
    put( lower, lower );
    put( upper, lower );
    put( upper, upper );
    put( lower, upper );
    end_outline();
}

static int32_t draw( uint64_t seed, int i, uint32_t axis, int32_t lower, int32_t upper )
{
    wisp_random_key key = wisp_random_make_key( seed, 0, 0 );
    return lower + (int32_t)( wisp_random_unit( key, (uint32_t)i, axis, 0 ) * ( (double)upper - lower ) );
}

// ---- results ---------------------------------------------------------------------------------------------------

TEST( three_points_are_one_triangle )
{
    begin();
    put( 0, 0 );
    put( 5, 1 );
    put( 2, 7 );
    end_outline();
    assert_int_equal( assert_sound(), 0 );
}

TEST( random_points_in_a_square_have_empty_circles )
{
    for ( uint64_t seed = 1; seed <= 4; ++seed )
    {
        begin();
        put_square( 0, LAST );
        for ( int i = 0; i < 700; ++i )
        {
            put( draw( seed, i, 0, 1, LAST ), draw( seed, i, 1, 1, LAST ) );
        }
        assert_int_equal( assert_sound(), 0 );
    }
}

TEST( a_grid_whose_cells_are_all_cocircular_is_cut_in_a_fixed_way )
{
    enum
    {
        SIDE = 24,
    };
    begin();
    for ( int turn = 0; turn < 4; ++turn )
    {
        for ( int i = 0; i < SIDE; ++i )
        {
            const int along[] = { i, SIDE, SIDE - i, 0 }, up[] = { 0, i, SIDE, SIDE - i };
            put( 1000 * along[turn], 1000 * up[turn] );
        }
    }
    end_outline();
    for ( int i = 1; i < SIDE; ++i )
    {
        for ( int j = 1; j < SIDE; ++j )
        {
            put( 1000 * i, 1000 * j );
        }
    }
    assert_int_equal( assert_sound(), 0 );
    static int32_t first[6 * MAX_POINTS];
    memcpy( first, set.triangles, sizeof first );
    filled();
    assert_memory_equal( first, set.triangles, sizeof first );
}

TEST( twelve_points_of_one_circle_and_its_middle_are_joined )
{
    static const int32_t x[] = { 5, 4, 3, 0, -3, -4, -5, -4, -3, 0, 3, 4 };
    static const int32_t y[] = { 0, 3, 4, 5, 4, 3, 0, -3, -4, -5, -4, -3 };
    for ( int with_middle = 0; with_middle < 2; ++with_middle )
    {
        begin();
        for ( int i = 0; i < WISP_COUNT( x ); ++i )
        {
            put( 6000000 * ( x[i] + 5 ), 6000000 * ( y[i] + 5 ) );
        }
        end_outline();
        if ( with_middle )
        {
            put( 30000000, 30000000 );
        }
        assert_int_equal( assert_sound(), 0 );
    }
}

TEST( points_in_long_straight_rows_are_joined )
{
    begin();
    for ( int i = 0; i <= 300; ++i )
    {
        put( 100000 * i, 0 );
    }
    for ( int i = 300; i >= 0; --i )
    {
        put( 100000 * i, 3 );
    }
    end_outline();
    for ( int i = 1; i < 300; ++i )
    {
        put( 100000 * i + 17, 1 );
        put( 100000 * i + 29, 2 );
    }
    assert_int_equal( assert_sound(), 0 );
}

TEST( points_on_edges_and_at_the_rim_of_the_lattice_are_joined )
{
    begin();
    put_square( 0, LAST );
    // the middle of the first diagonal, points on edges that then exist, and some one float from a corner
    const int32_t half = DELAUNAY_SIDE / 2;
    put( half, half );
    put( half / 2, half / 2 );
    put( half + half / 2, half / 2 );
    put( half / 2, half + half / 2 );
    put( 1, 1 );
    put( LAST - 1, LAST - 1 );
    put( LAST - 1, 1 );
    put( 1, LAST - 1 );
    put( 2, 1 );
    put( half, 1 );
    put( half, LAST - 1 );
    assert_int_equal( assert_sound(), 0 );
}

// ---- outlines that hide points ---------------------------------------------------------------------------------

// Every other corner far out, the others near the middle: the edges cross most edges of the unconstrained
// triangulation.
static void put_star( uint64_t seed, int corners, double inner )
{
    for ( int i = 0; i < corners; ++i )
    {
        double reach = i % 2 ? inner : 0.5 + 0.5 * draw( seed, i, 2, 0, 1000 ) / 1000.0;
        double angle = TAU * i / corners, middle = 0.5 * DELAUNAY_SIDE;
        put( (int32_t)( middle * ( 1.0 + 0.99 * reach * cos( angle ) ) ),
             (int32_t)( middle * ( 1.0 + 0.99 * reach * sin( angle ) ) ) );
    }
    end_outline();
}

TEST( stars_with_many_thin_points_keep_their_outline )
{
    static const int corners[] = { 10, 40, 150, 400 };
    int hidden = 0;
    for ( int i = 0; i < WISP_COUNT( corners ); ++i )
    {
        begin();
        put_star( (uint64_t)i, corners[i], 0.25 );
        for ( int k = 0; k < 200; ++k )
        {
            put( draw( 9, k, 0, 7 * ( DELAUNAY_SIDE / 16 ), 9 * ( DELAUNAY_SIDE / 16 ) ),
                 draw( 9, k, 1, 7 * ( DELAUNAY_SIDE / 16 ), 9 * ( DELAUNAY_SIDE / 16 ) ) );
        }
        hidden += assert_sound();
    }
    // else the outlines were Delaunay by themselves and nothing was tested
    assert_true( hidden > 1000 );
}

TEST( a_long_edge_is_cut_through_many_triangles )
{
    // a slit from the left almost to the right side, through a crowd
    begin();
    put( 0, 0 );
    put( LAST, 0 );
    put( LAST, LAST );
    put( 0, LAST );
    put( 0, DELAUNAY_SIDE / 2 + 5 );
    put( LAST - 1000, DELAUNAY_SIDE / 2 );
    put( 0, DELAUNAY_SIDE / 2 - 5 );
    end_outline();
    for ( int i = 0; i < 1200; ++i )
    {
        int32_t away = draw( 3, i, 1, 100, DELAUNAY_SIDE / 2 - 100 );
        put( draw( 3, i, 0, 1, LAST ), DELAUNAY_SIDE / 2 + ( i % 2 ? away : -away ) );
    }
    assert_true( assert_sound() > 100 );
}

// Few points at few positions, so that many are collinear or cocircular, some close to the slit and some far from it:
// its edges meet every order of higher and lower corners on both sides.
static void put_crowd( uint64_t seed, int count )
{
    enum
    {
        SIDE = 200,
    };
    static bool taken[SIDE * SIDE];
    memset( taken, 0, sizeof taken );
    for ( int i = 0; i < count; ++i )
    {
        double part = draw( seed, i, 1, 0, 1000 ) / 1000.0;
        int32_t x = draw( seed, i, 0, 1, SIDE ), away = 2 + (int32_t)( 97.0 * part * part * part );
        int32_t y = SIDE / 2 + ( draw( seed, i, 2, 0, 2 ) ? away : -away );
        if ( !taken[SIDE * y + x] )
        {
            taken[SIDE * y + x] = true;
            put( x, y );
        }
    }
}

TEST( a_slit_is_kept_in_any_small_crowd )
{
    for ( uint64_t seed = 0; seed < 2000; ++seed )
    {
        begin();
        put( 0, 0 );
        put( 200, 0 );
        put( 200, 200 );
        put( 0, 200 );
        put( 0, 101 );
        put( 199, 100 );
        put( 0, 99 );
        end_outline();
        put_crowd( seed, 5 + (int)( seed % 60 ) );
        fixture_net net = filled();
        assert_covers( &net );
        assert_joined_and_delaunay( &net );
    }
}

TEST( teeth_of_a_comb_are_not_joined_across_the_gaps )
{
    // long and short teeth in turn, so that the circles of the long ones contain the tips of the short ones
    begin();
    put( 0, 0 );
    put( 20000 * 50, 0 );
    for ( int i = 49; i >= 0; --i )
    {
        put( 20000 * i + 10000, i % 2 ? 900000 : 500000 );
        put( 20000 * i, 100000 );
    }
    end_outline();
    assert_true( assert_sound() > 0 );
}

// ---- refusals --------------------------------------------------------------------------------------------------

static void demand_refusal( const char* words )
{
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( fill( &error ), WISP_BAD_INPUT );
    assert_contains( error.message, words );
}

TEST( points_that_no_outline_makes_are_refused )
{
    begin();
    put_square( 10, 90 );
    set.outline_count = 2;
    demand_refusal( "4 points in all, 2 of them the outline" );
    set.outline_count = 5;
    demand_refusal( "4 points in all, 5 of them the outline" );
    set.outline_count = 4;
    put( DELAUNAY_SIDE, 5 );
    demand_refusal( "point 4 is off the lattice" );
    set.points[4] = ( delaunay_point ){ 5, -1 };
    demand_refusal( "point 4 is off the lattice" );
    set.points[4] = ( delaunay_point ){ 50, 91 };
    demand_refusal( "point 4 lies outside of the outline" );
    set.points[4] = ( delaunay_point ){ 90, 90 };
    demand_refusal( "points 2 and 4 are at the same place" );
    set.points[4] = ( delaunay_point ){ 90, 50 };
    demand_refusal( "the outline from point 1 to point 2 passes through point 4" );
}

TEST( an_outline_that_runs_clockwise_or_has_no_area_is_refused )
{
    begin();
    put( 0, 0 );
    put( 0, 9 );
    put( 9, 0 );
    end_outline();
    demand_refusal( "the outline of 3 points runs clockwise" );
    set.points[2] = ( delaunay_point ){ 0, 20 };
    demand_refusal( "the outline of 3 points has no area" );
}

TEST( an_outline_that_crosses_or_touches_itself_is_refused )
{
    begin();
    put( 0, 0 );
    put( 100, 0 );
    put( 100, 100 );
    put( 40, 50 );
    put( 50, 100 );
    put( 60, 40 );
    end_outline();
    demand_refusal( "the outline crosses itself: from point " );
    begin();
    put( 0, 0 );
    put( 100, 0 );
    put( 100, 100 );
    put( 50, 0 );
    end_outline();
    demand_refusal( "the outline from point 0 to point 1 passes through point 3" );
    begin();
    put_square( 0, 100 );
    put( 100, 100 );
    end_outline();
    demand_refusal( "points 2 and 4 are at the same place" );
}

// ---- the lattice -----------------------------------------------------------------------------------------------

TEST( the_longer_side_becomes_the_whole_lattice )
{
    const double coordinates[] = { -1.0, 7.0, 3.0, 8.0, 1.0, 7.5 };
    delaunay_point out[3];
    assert_int_equal( delaunay_snap( coordinates, 3, out, "set", NULL ), WISP_OK );
    assert_true( out[0].x == 0 && out[0].y == 0 && out[1].x == LAST );
    // a quarter and an eighth of an odd number, rounded
    assert_true( out[1].y == DELAUNAY_SIDE / 4 && out[2].x == DELAUNAY_SIDE / 2 && out[2].y == DELAUNAY_SIDE / 8 );
}

TEST( points_that_no_lattice_fits_are_refused )
{
    static const double bad[][4] = { { 0.0, NAN, 1.0, 1.0 },
                                     { 0.0, 0.0, HUGE_VAL, 1.0 },
                                     { 2.0, 3.0, 2.0, 3.0 },
                                     { -1e308, 0.0, 1e308, 0.0 },
                                     { 0.0, 0.0, 5e-324, 0.0 } };
    static const char* const words[] = { "coordinate y of point 0 is not finite",
                                         "coordinate x of point 1 is not finite", "the 2 points span 0,",
                                         "the 2 points span inf,", "the 2 points span 4.94" };
    for ( int i = 0; i < WISP_COUNT( bad ); ++i )
    {
        delaunay_point out[2];
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( delaunay_snap( bad[i], 2, out, "set", &error ), WISP_BAD_INPUT );
        assert_contains( error.message, words[i] );
    }
}

TEST( hilberts_curve_goes_from_neighbour_to_neighbour )
{
    enum
    {
        SIDE = 64,
        STEP = DELAUNAY_SIDE / SIDE,
    };
    static delaunay_point at[SIDE * SIDE];
    static bool taken[SIDE * SIDE];
    for ( int i = 0; i < SIDE * SIDE; ++i )
    {
        delaunay_point p = { i % SIDE * STEP, i / SIDE * STEP };
        uint64_t along = delaunay_curve( p ) / ( (uint64_t)STEP * STEP );
        assert_true( along < SIDE * SIDE && !taken[along] );
        taken[along] = true;
        at[along] = p;
    }
    for ( int i = 1; i < SIDE * SIDE; ++i )
    {
        assert_int_equal( abs( at[i].x - at[i - 1].x ) + abs( at[i].y - at[i - 1].y ), STEP );
    }
}
