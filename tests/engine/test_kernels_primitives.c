// Kernels of primitives near each other: every table gives the same bits, and pairs, bounds and distances are
// compared with double precision over all pairs.
#include "primitives_fixture.h"

enum
{
    SEEDS = 60,
    SCENES = WISP_COUNT( KINDS ) * SHAPES * SEEDS,
};

// Positions are sums of a few numbers of at most the size, each rounded.
static const double ROUNDING = 8.0 * (double)FLT_EPSILON;

static make_fn* kind_of( int number )
{
    return KINDS[number / SEEDS / SHAPES];
}

// The scene with a number below SCENES.
static void fill_scene( void* state, int number )
{
    place_scene( state, number / SEEDS % SHAPES == 0 ? EDGES : FACES, number % SEEDS );
    kind_of( number )( state );
    ( (scene*)state )->number = number;
}

// What follows the pairs that were found is left open.
static void run_scene( const wisp_kernels* kernels, void* state, int begin, int end )
{
    scene* s = state;
    run( kernels, s );
    assert_true( begin == 0 && s->found <= end );
    FORGET_BEHIND( s->of, s->found );
    FORGET_BEHIND( s->first, s->found );
    FORGET_BEHIND( s->second, s->found );
    for ( int k = 0; k < 4; ++k )
    {
        FORGET_BEHIND( s->point_x4[k], s->found );
    }
}

// ---- several at a time ----

// Scenes queried one after the other give the same results as when queried at once.
static void check_together( const wisp_kernels* kernels, int first, int count )
{
    static int32_t of[WISP_PRIMITIVE_BATCH * ROOM], names[2][WISP_PRIMITIVE_BATCH * ROOM],
        point_x4[4][WISP_PRIMITIVE_BATCH * ROOM];
    scene* scenes[WISP_PRIMITIVE_BATCH];
    wisp_primitive_near_args batch[WISP_PRIMITIVE_BATCH];
    float least[WISP_PRIMITIVE_BATCH][8];
    for ( int i = 0; i < count; ++i )
    {
        scenes[i] = new_aligned( sizeof( scene ) );
        fill_scene( scenes[i], first + i );
        run( kernels, scenes[i] );
        batch[i] = job_of( scenes[i] );
        batch[i].min_distance = least[i];
        for ( int l = 0; l < 8; ++l )
        {
            least[i][l] = INFINITY;
        }
    }
    const wisp_primitive_pairs to = {
        of, names[0], names[1], { point_x4[0], point_x4[1], point_x4[2], point_x4[3] }
    };
    const int found =
        ( scenes[0]->shape == EDGES ? kernels->find_near_edges : kernels->find_near_points )( batch, count, &to );
    int before = 0;
    for ( int i = 0; i < count; ++i )
    {
        const scene* s = scenes[i];
        const size_t size = (size_t)s->found * sizeof( int32_t );
        for ( int f = 0; f < s->found; ++f )
        {
            assert_int_equal( of[before + f], s->seed );
        }
        assert_memory_equal( names[0] + before, s->first, size );
        assert_memory_equal( names[1] + before, s->second, size );
        for ( int k = 0; k < 4; ++k )
        {
            assert_memory_equal( point_x4[k] + before, s->point_x4[k], size );
        }
        assert_memory_equal( least[i], s->least, sizeof( least[i] ) );
        before += s->found;
    }
    assert_int_equal( found, before );
    for ( int i = 0; i < count; ++i )
    {
        free( scenes[i] );
    }
}

TEST( jobs_at_once_find_what_each_finds_alone )
{
    for ( int i = 0; i + WISP_PRIMITIVE_BATCH <= SCENES; i += SEEDS )
    {
        for ( const wisp_kernels* const* k = every_table(); *k != NULL; ++k )
        {
            check_together( *k, i, 1 + i / SEEDS % WISP_PRIMITIVE_BATCH );
            check_together( *k, i + SEEDS - WISP_PRIMITIVE_BATCH, WISP_PRIMITIVE_BATCH );
        }
    }
    assert_int_equal( widest_table()->find_near_edges( NULL, 0, &( wisp_primitive_pairs ){ .id = NULL } ), 0 );
    assert_int_equal( widest_table()->find_near_points( NULL, 0, &( wisp_primitive_pairs ){ .id = NULL } ), 0 );
}

// ---- bounds of primitives ----

static double3 lane_of( float rows[3][8], int primitive )
{
    return lane_vector( rows, primitive % 8 );
}

// The plane of the edge vectors: its normal is known to a rounding over the height, and no corner is outside it
// except for `rounded`.
static void check_plane( scene* s, int primitive, double size )
{
    wisp_primitive_pack* row = s->row[1] + primitive / 8;
    const double3 a = at( s, 1, primitive, 0 ), u = double3_sub( at( s, 1, primitive, 1 ), a ),
                  v = double3_sub( at( s, 1, primitive, 2 ), a ), foreign = double3_cross( u, v ),
                  normal = lane_of( row->normal, primitive );
    const double area = double3_length( foreign ), length = double3_length( normal );
    const double longest = fmax( double3_length( u ), double3_length( v ) ),
                 rounded = (double)row->rounding[primitive % 8];
    const double3 edge_vectors[3] = { lane_of( row->edge_vector, primitive ),
                                      lane_of( row->other_edge_vector[0], primitive ),
                                      lane_of( row->other_edge_vector[1], primitive ) };
    double out = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        out = fmax( out, fabs( double3_dot( normal, edge_vectors[k] ) ) );
    }
    assert_near( rounded, out, 4.0 * (double)FLT_EPSILON * longest, "out of its plane, triangle", s->seed );
    assert_true( length == 0.0 || fabs( length - 1.0 ) <= 4.0 * (double)FLT_EPSILON );
    assert_true( length == 0.0 ? rounded == 0.0 && area <= ROUNDING * size * longest : longest > 0.0 );
    if ( area > 0.05 * longest * longest )
    {
        assert_near_vector( normal, double3_scale( 1.0 / area, foreign ), 4.0 * ROUNDING * size * longest / area,
                            "normal of a triangle", s->seed );
        assert_true( rounded <= ROUNDING * size );
    }
}

static void check_place( scene* s, int side, int primitive )
{
    wisp_primitive_pack* row = s->row[side] + primitive / 8;
    const int corners = s->corners[side];
    const double3 centre = lane_of( row->centre, primitive );
    float( *const edge_vectors[3] )[8] = { row->edge_vector, row->other_edge_vector[0], row->other_edge_vector[1] };
    double3 sum = double3_make( 0.0, 0.0, 0.0 );
    double size = 0.0;
    for ( int k = 0; k < corners; ++k )
    {
        sum = double3_add( sum, at( s, side, primitive, k ) );
        size = fmax( size, double3_length( at( s, side, primitive, k ) ) );
    }
    const double tolerance = corners == 1 ? 0.0 : 4.0 * (double)FLT_EPSILON * size;
    assert_near_vector( centre, double3_scale( 1.0 / corners, sum ), tolerance, "middle, seed", s->seed );
    for ( int k = 0; k < ( corners == 2 ? 1 : corners ) && corners > 1; ++k )
    {
        assert_near_vector( lane_of( edge_vectors[k], primitive ), double3_sub( at( s, side, primitive, k ), centre ),
                            tolerance, "arm, seed", s->seed );
    }
    if ( corners == 3 )
    {
        check_plane( s, primitive, size );
    }
}

// ---- pairs found ----

// Number of pairs found that are farther apart than twice the query distance.
typedef struct tally
{
    int far, far_found;
} tally;

static void check_points( scene* s, int f, int query, int queried )
{
    for ( int k = 0; k < 4; ++k )
    {
        assert_int_equal( s->point_x4[k][f], k < s->corners[0]
                                                 ? *point_x4_of( s, 0, query, k )
                                                 : *point_x4_of( s, queried_side( s ), queried, k - s->corners[0] ) );
    }
}

static float min_of( const scene* s )
{
    float least = s->least[0];
    for ( int l = 0; l < 8; ++l )
    {
        assert_true( s->least[l] > s->within ); // also false for NaN
        least = fminf( least, s->least[l] );
    }
    return least;
}

// A pair that is not found is farther than the query distance, and at least as far as the smallest bound or the limit
// of the search.
static void check_pair( scene* s, int query, int queried, bool is_found, tally* t )
{
    const bool is_lower = queried_side( s ) == 0 && item_of( s, 0, query ) >= item_of( s, 0, queried );
    if ( is_lower || share_a_point( s, query, queried ) )
    {
        assert_false( is_found );
        return;
    }
    const double distance = distance_of( s, query, queried ), bound = (double)fminf( min_of( s ), s->seen );
    if ( !isnan( distance ) )
    {
        assert_false( is_found && is_beyond( s, 0, query, s->box + queried_side( s ) ) );
        assert_false( is_found && is_beyond( s, queried_side( s ), queried, s->box ) );
        assert_true( is_found || distance >= bound * ( 1.0 - 1e-5 ) - 1e-6 );
        assert_true( is_found || distance > (double)s->within * ( 1.0 - 1e-5 ) );
        t->far += distance > 2.0 * (double)s->within ? 1 : 0;
        t->far_found += is_found && distance > 2.0 * (double)s->within ? 1 : 0;
    }
}

static void check_near( scene* s, tally* t )
{
    bool is_found[PRIMITIVES][PRIMITIVES] = { { false } };
    const int queried = queried_side( s );
    for ( int f = 0; f < s->found; ++f )
    {
        const int a = primitive_of( s, 0, s->first[f] ), b = primitive_of( s, queried, s->second[f] );
        check_points( s, f, a, b );
        assert_false( is_found[a][b] ); // not twice
        is_found[a][b] = true;
    }
    for ( int i = 0; i < s->count[0] * s->count[queried]; ++i )
    {
        const int a = i / s->count[queried], b = i % s->count[queried];
        check_pair( s, a, b, is_found[a][b], t );
    }
}

// The smallest distance is never raised.
static void check_min( scene* s )
{
    for ( int l = 0; l < 8; ++l )
    {
        s->least[l] = -1.0f - (float)l;
    }
    look( widest_table(), s );
    for ( int l = 0; l < 8; ++l )
    {
        assert_true( s->least[l] == -1.0f - (float)l );
    }
}

static tally tallies[SCENES / SEEDS];

static void check_scene( void* start, void* end )
{
    (void)start;
    scene* s = end;
    for ( int i = 0; i < s->count[0] + s->count[1] && kind_of( s->number ) != make_strange; ++i )
    {
        check_place( s, i < s->count[0] ? 0 : 1, i < s->count[0] ? i : i - s->count[0] );
    }
    check_near( s, tallies + s->number / SEEDS );
    check_min( s );
}

TEST( what_is_near_is_found_and_the_rest_is_no_nearer_than_told )
{
    check_kernel( KERNEL_ROW( scene, SCENES, 0, ROOM, 0, fill_scene, run_scene, check_scene ) );
    for ( int i = 0; i < WISP_COUNT( tallies ); ++i )
    {
        assert_true( tallies[i].far > 1000 && 20 * tallies[i].far_found < tallies[i].far );
    }
}

// One not directly above the middle of the other, found and not.
static void check_over( primitive_shape shape, float away )
{
    float points[SHAPES][4][3] = {
        { { -1, 0, 0 }, { 1, 0, 0 }, { 0.75f, -0.5f, away }, { 0.75f, 1.5f, away } },
        { { 0.25f, 0.5f, 0 }, { -1, -1, away }, { 2, -1, away }, { -1, 2, away } },
    };
    const bool is_near = fabsf( away ) <= 0.5f;
    SCOPED( free_local ) scene* s = make_two( shape, points[shape], 0.5f, 4.0f );
    assert_int_equal( s->found, is_near ? 1 : 0 );
    assert_true( min_of( s ) == ( is_near ? INFINITY : fabsf( away ) ) );
    free( s );
    s = make_two( shape, points[shape], 0.5f, 0.6f );
    for ( int side = 0; side < 2; ++side )
    {
        // one of them alone is out of reach
        const wisp_aabb box = s->box[side];
        s->box[side].lower[2] -= 10.0f;
        s->box[side].upper[2] += 10.0f;
        look( widest_table(), s );
        assert_int_equal( s->found, is_near ? 1 : 0 );
        assert_true( min_of( s ) == INFINITY );
        s->box[side] = box;
    }
    // its neighbour is within reach, and on the query's points
    s->count[1] = 2;
    s->row[1][0].item[1] = 0;
    for ( int k = 0; k < s->corners[1]; ++k )
    {
        *point_x4_of( s, 1, 1, k ) = *point_x4_of( s, 0, 0, k % s->corners[0] );
    }
    run( widest_table(), s );
    assert_true( s->found == ( is_near ? 1 : 0 ) && min_of( s ) == INFINITY );
}

TEST( primitives_over_each_other_are_as_far_as_the_plane_between_tells )
{
    static const float AWAY[] = { 0.25f, 0.5f, 0.75f, 2.0f };
    for ( int i = 0; i < 2 * WISP_COUNT( AWAY ); ++i )
    {
        const float away = i % 2 == 0 ? AWAY[i / 2] : -AWAY[i / 2];
        check_over( EDGES, away );
        check_over( FACES, away );
    }
}

// Across both, no direction has any valid digits.
TEST( edges_that_are_all_but_parallel_are_found )
{
    for ( float skew = 1e-16f; skew > 0.0f; skew *= 0.1f )
    {
        float points[4][3] = { { -0.01f, 0, 0 }, { 0.01f, 0, 0 }, { -0.01f, 0, 0.001f }, { 0.01f, skew, 0.001f } };
        SCOPED( free_local ) scene* s = make_two( EDGES, points, 0.002f, 0.004f );
        assert_int_equal( s->found, 1 );
    }
}

TEST( a_triangle_is_seen_as_far_as_any_of_its_corners_reaches )
{
    static const float CORNER[3][3] = { { -1, -1, 0 }, { 1, -1, 0 }, { 0, 4, 0 } };
    for ( int turn = 0; turn < 3; ++turn )
    {
        float points[4][3] = { { 0, 4.5f, 0 } };
        for ( int k = 0; k < 3; ++k )
        {
            memcpy( points[1 + k], CORNER[( k + turn ) % 3], sizeof( points[0] ) );
        }
        SCOPED( free_local ) scene* s = make_two( FACES, points, 0.75f, 0.75f );
        assert_int_equal( s->found, 1 );
    }
}

// ---- sets of points ----

typedef struct closings
{
    point_sets sets;
    int split;
    float closing[LIST];
} closings;

static void fill_closings( void* state, int variant )
{
    closings* c = state;
    c->sets = make_sets( variant / 2 );
    c->split = 1 + variant % 2;
}

static void find_closing( const wisp_kernels* kernels, void* state, int begin, int end )
{
    closings* c = state;
    const point_sets* s = &c->sets;
    const wisp_approach_args args = { .predicted = s->point[0],
                                      .point_x4 = { s->point_x4[0], s->point_x4[1], s->point_x4[2], s->point_x4[3] },
                                      .are_edges = c->split == 2,
                                      .max_approach = c->closing };
    kernels->max_approach( &args, begin, end );
}

static double closing_of( const point_sets* s, int pair, int split )
{
    double most = 0.0;
    for ( int i = 0; i < split; ++i )
    {
        for ( int k = split; k < 4; ++k )
        {
            const float *p = in_set( s, i, pair ), *q = in_set( s, k, pair );
            most =
                fmax( most, double3_distance( double3_from( p ), double3_from( q ) ) + (double)p[3] + (double)q[3] );
        }
    }
    return most;
}

static void check_closings( void* start, void* end )
{
    (void)start;
    closings* c = end;
    for ( int pair = 0; pair < LIST; ++pair )
    {
        assert_near( (double)c->closing[pair], pair < 8 ? 0.0 : closing_of( &c->sets, pair, c->split ),
                     ROUNDING * 4.0, "closing of pair", pair );
    }
}

TEST_KERNEL( pairs_come_nearer_by_no_more_than_their_points, closings, 2 * SEEDS, 8, LIST, 8, fill_closings,
             find_closing, check_closings )

// Two sets with a given distance along the first direction. Some points of the second set occur twice.
static point_sets make_apart( int seed, float along[3][3] )
{
    point_sets s = make_sets( seed );
    const double3 way = double3_unit( random_vector( seed, 500, 1.0 ) );
    const double distance = 0.1 * seed;
    for ( int i = 0; i < LIST; ++i )
    {
        float* p = s.point[s.point_x4[1][i] / 4];
        p[0] += (float)( distance * way.x );
        p[1] += (float)( distance * way.y );
        p[2] += (float)( distance * way.z );
    }
    memcpy( s.point_x4[1] + 3, s.point_x4[1], 3 * sizeof( int32_t ) );
    const double3 directions[3] = { double3_scale( pow( 10.0, seed % 13 - 6 ), way ), random_vector( seed, 501, 1.0 ),
                                    random_vector( seed, 502, 100.0 ) };
    for ( int k = 0; k < 3; ++k )
    {
        const float xyz[3] = { (float)directions[k].x, (float)directions[k].y, (float)directions[k].z };
        memcpy( along[k], xyz, sizeof( xyz ) );
    }
    return s;
}

static float find_apart( const wisp_kernels* kernels, const point_sets* s, float along[3][3] )
{
    wisp_separating_axis_args args = { .xyzw = s->point[0],
                                       .point_x4 = { s->point_x4[0], s->point_x4[1] },
                                       .count = { 8, LIST } };
    memcpy( args.axis, along, sizeof( args.axis ) );
    return kernels->separation( &args );
}

// By the best of the directions, not below -1; @return the distance of the points.
static double apart_of( const point_sets* s, float along[3][3], double* parted )
{
    double nearest = INFINITY;
    *parted = -1.0;
    for ( int k = 0; k < 3; ++k )
    {
        const double3 direction = double3_unit( double3_from( along[k] ) );
        double one = INFINITY, other = INFINITY;
        for ( int i = 0; i < 8 * LIST; ++i )
        {
            const double3 between =
                double3_sub( double3_from( in_set( s, 1, i / 8 ) ), double3_from( in_set( s, 0, i % 8 ) ) );
            one = fmin( one, double3_dot( direction, between ) );
            other = fmin( other, -double3_dot( direction, between ) );
            nearest = fmin( nearest, double3_length( between ) );
        }
        *parted = fmax( *parted, fmax( one, other ) );
    }
    return nearest;
}

TEST( sets_are_apart_as_the_best_direction_has_it )
{
    int apart = 0, all = 0;
    const wisp_kernels* const* tables = every_table();
    for ( int seed = 0; seed < SEEDS; ++seed )
    {
        float along[3][3];
        double parted;
        const point_sets s = make_apart( seed, along );
        const double nearest = apart_of( &s, along, &parted ), tolerance = ROUNDING * ( 2.0 + 0.1 * seed );
        for ( int turn = 0; tables[turn / 3] != NULL; ++turn )
        {
            // for any order of the directions
            float turned[3][3];
            memcpy( turned, along[turn % 3], ( 3 - (size_t)( turn % 3 ) ) * sizeof( along[0] ) );
            memcpy( turned[3 - turn % 3], along, (size_t)( turn % 3 ) * sizeof( along[0] ) );
            const float found = find_apart( tables[turn / 3], &s, turned );
            const float first = find_apart( tables[0], &s, turned );
            assert_memory_equal( &found, &first, sizeof( found ) );
            assert_near( (double)found, parted, tolerance, "sets, seed", seed );
            assert_true( (double)found <= nearest + tolerance );
            apart += found > 0.0f ? 1 : 0;
            all += 1;
        }
    }
    assert_true( 3 * apart > all && apart < all );
}

TEST( directions_of_no_length_tell_nothing )
{
    for ( int seed = 0; seed < SEEDS; ++seed )
    {
        float along[3][3];
        const point_sets s = make_apart( seed, along );
        for ( int k = 0; k < 3; ++k )
        {
            float with[3][3] = { { 0 } };
            assert_true( find_apart( widest_table(), &s, with ) < 0.0f );
            with[k][0] = 1e-23f; // whose square overflows
            assert_true( find_apart( widest_table(), &s, with ) < 0.0f );
            memcpy( with[k], along[1], sizeof( along[1] ) );
            const float alone = find_apart( widest_table(), &s, with );
            memcpy( with[( k + 1 ) % 3], along[1], sizeof( along[1] ) );
            assert_true( find_apart( widest_table(), &s, with ) == alone );
        }
    }
}

TEST( ranges_are_those_of_all_numbers_that_are )
{
    const wisp_kernels* const* tables = every_table();
    for ( int i = 0; tables[i / 6 / SEEDS] != NULL; ++i )
    {
        point_sets s = make_sets( i / 6 % SEEDS );
        const int points = 8 + 8 * ( i % 3 );
        float lower[4], upper[4], least[4], most[4];
        for ( int k = 0; k < 4; ++k )
        {
            least[k] = INFINITY;
            most[k] = -INFINITY;
            s.point[s.point_x4[0][( i + k ) % 8] / 4][k] = NAN;
            for ( int p = 0; p < points; ++p )
            {
                const int32_t at = s.point_x4[0][p] / 4;
                const float v = s.point[at][k] - ( i % 6 < 3 ? s.less[at][k] : 0.0f );
                least[k] = fminf( least[k], v );
                most[k] = fmaxf( most[k], v );
            }
        }
        tables[i / 6 / SEEDS]->xyzw_range( s.point[0], i % 6 < 3 ? s.less[0] : NULL, s.point_x4[0], points, lower,
                                           upper );
        assert_memory_equal( lower, least, sizeof( lower ) );
        assert_memory_equal( upper, most, sizeof( upper ) );
    }
}
