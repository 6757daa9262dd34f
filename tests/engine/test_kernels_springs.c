// Springs and conjugate gradients over rows: every table gives the same bits, and forces, derivatives, right sides,
// products, and the potential that links gain in a motion agree with formulas in double precision.
#include "springs_state.h"

// ---- the arc ----

// Eight bending links of length 1 at a length of y, each between a vertex and one at the origin, with a ramp so steep
// that the arc determines the force.
typedef struct arcs
{
    _Alignas( 64 ) float position[16][4];
    _Alignas( 64 ) float nothing[16][4];
    int32_t begin[5];
    _Alignas( 64 ) int32_t other_x4[1][8];
    _Alignas( 64 ) float one[1][8], ramp[1][8], zero[1][8], axis[1][4][8], rhs[2][3][8], inverse[2][6][8];
} arcs;

static void bend_arcs( const float y[8], arcs* a )
{
    *a = ( arcs ){ .begin = { 0, 0, 1, 1, 1 } };
    for ( int lane = 0; lane < 8; ++lane )
    {
        a->position[lane][0] = y[lane];
        a->position[lane][3] = a->position[8 + lane][3] = 1.0f;
        a->other_x4[0][lane] = 4 * ( 8 + lane );
        a->one[0][lane] = 1.0f;
        a->ramp[0][lane] = 1e12f;
    }
    const wisp_spring_args args = {
        .links = { a->begin, (const int32_t( * )[8])a->other_x4, (const float( * )[8])a->one,
                   (const float( * )[8])a->one, (const float( * )[8])a->ramp, (const float( * )[8])a->zero, NULL },
        .position = a->position[0],
        .velocity = a->nothing[0],
        .start_velocity = a->nothing[0],
        .dt = 1.0f,
        .axis = a->axis,
        .rhs = a->rhs,
        .inverse = a->inverse,
    };
    assert_int_equal( widest_table()->spring_assemble( &args, 0, 1 ), 0 );
}

// The fit is within 3e-9 of F s and 6e-7 of F', s = sqrt( y + 0.217 ) being 0.47 to 1.1. Rounding: t carries three roundings of a
// number of up to 1.1 and a factor of 3.1, which a polynomial of slope 2.5 to 4 carries on; the sum, the root and the
// quotient round F itself. F' is the difference of two such numbers, over 2 s^2.
static void assert_arc( float y, double load, double slope )
{
    const double f = triangle_oracle_arc_load( (double)y ), df = triangle_oracle_arc_slope( (double)y );
    const double s2 = (double)y + 0.217;
    assert_near( load, f, 3e-9 / sqrt( s2 ) + 6.0 * EPSILON * fabs( f ), "load at 1e6 y", (int)( 1e6f * y ) );
    const double rounding = 6.0 * EPSILON * ( fabs( f ) + 2.0 * s2 * df ) / ( 2.0 * s2 );
    assert_near( slope, df, 6e-7 + rounding, "slope at 1e6 y", (int)( 1e6f * y ) );
}

TEST( an_arc_has_the_load_and_slope_of_its_equation )
{
    SCOPED( free_local ) arcs* a = new_aligned( sizeof( arcs ) );
    for ( int n = 0; n < 8192; n += 8 )
    {
        float y[8];
        for ( int lane = 0; lane < 8; ++lane )
        {
            y[lane] = (float)( n + lane + 1 ) / 8192.0f;
        }
        y[7] = n == 8184 ? 1.0f - 0.5f * FLT_EPSILON : y[7];
        y[0] = n == 0 ? 1e-6f : y[0];
        bend_arcs( y, a );
        for ( int lane = 0; lane < 8; ++lane )
        {
            // towards the other end, which is at the origin
            const double root = -(double)a->axis[0][0][lane];
            assert_arc( y[lane], -(double)a->rhs[0][0][lane], root * root );
        }
    }
}

TEST( an_arc_as_long_as_at_rest_or_longer_pulls_nowhere )
{
    SCOPED( free_local ) arcs* a = new_aligned( sizeof( arcs ) );
    const float y[8] = { 1.0f, 1.0f + FLT_EPSILON, 1.5f, 2.0f, 10.0f, 1e3f, 1e6f, 1e9f };
    bend_arcs( y, a );
    for ( int lane = 0; lane < 8; ++lane )
    {
        assert_true( a->rhs[0][0][lane] == 0.0f && a->axis[0][0][lane] == 0.0f );
        assert_near( (double)a->inverse[0][0][lane], 1.0, 4.0 * EPSILON, "inverse of a mass of 1 kg, lane", lane );
    }
}

// ---- formulas ----

// A link at the positions of its ends, in double: pull, K1', K2', and the error bounds of single precision.
typedef struct term
{
    double3 d;
    double pull, along, foreign; // N; kg, with time and damping
    double damping;              // kg
    double pull_off, along_off;  // bounds
} term;

static term term_of( const springs* s, const spring* l )
{
    const double h = (double)STEP, damping = h * (double)l->damping, rest = (double)l->rest, load = (double)l->load;
    const double3 way = double3_sub( double3_from( s->position[l->j] ), double3_from( s->position[l->i] ) );
    const double r = double3_length( way ), y = r / rest;
    term t = { .d = way, .along = damping, .foreign = damping, .damping = damping };
    if ( r == 0.0 )
    {
        return t;
    }
    t.d = double3_scale( 1.0 / r, way );
    double k1 = 0.0, k2 = 0.0;
    if ( l->bends == false && r >= rest )
    {
        t.pull = load * ( r - rest );
        k1 = load;
        k2 = t.pull / r;
        t.pull_off = 4.0 * EPSILON * load * r; // r has some four roundings
    }
    else if ( l->bends && r < rest )
    {
        const double arc = load * triangle_oracle_arc_load( y ), straight = (double)l->ramp * ( r - rest );
        const bool ramps = arc < straight;
        t.pull = ramps ? straight : arc;
        k1 = ramps ? (double)l->ramp : load / rest * triangle_oracle_arc_slope( y );
        t.pull_off = ramps ? 4.0 * EPSILON * (double)l->ramp * r : 16.0 * EPSILON * fabs( arc );
        t.along_off = ramps ? 0.0 : h * h * 100.0 * EPSILON * k1; // a difference over 2 s^2, above
    }
    t.along += h * h * k1;
    t.foreign += h * h * k2;
    return t;
}

// K2' u + ( K1' - K2' ) d d'u
static double3 spread( double3 d, double along, double foreign, double3 u )
{
    return double3_add( double3_scale( foreign, u ), double3_scale( ( along - foreign ) * double3_dot( d, u ), d ) );
}

// Where the larger of two bending loads is a matter of rounding, so is the slope.
static bool is_at_a_corner( const springs* s, const spring* l )
{
    const double r = double3_distance( double3_from( s->position[l->i] ), double3_from( s->position[l->j] ) ),
                 rest = (double)l->rest;
    const double arc = (double)l->load * triangle_oracle_arc_load( fmin( r / rest, 1.0 ) );
    const double straight = (double)l->ramp * ( r - rest );
    return fabs( r - rest ) < 1e-5 * rest || ( l->bends && fabs( arc - straight ) < 1e-4 * fabs( arc ) );
}

typedef struct plain_rows
{
    double3 rhs[ROWS];
    double off[ROWS]; // kg m/s
    double3 product[ROWS];
    double product_off[ROWS];
    double matrix[ROWS][3][3];
    int undirected;
} plain_rows;

static void add_matrix( double matrix[3][3], const term* t )
{
    const double d[3] = { t->d.x, t->d.y, t->d.z };
    for ( int a = 0; a < 3; ++a )
    {
        for ( int b = 0; b < 3; ++b )
        {
            matrix[a][b] += ( t->along - t->foreign ) * d[a] * d[b] + ( a == b ? t->foreign : 0.0 );
        }
    }
}

static void add_plain( plain_rows* p, const springs* s, const spring* l, int variant )
{
    const bool repeat = ( variant & REPEAT ) != 0;
    const term t = term_of( s, l );
    const bool lost = double3_length( t.d ) == 0.0;
    const double h = (double)STEP, along = repeat ? t.damping : t.along;
    const double foreign = repeat ? t.damping : t.foreign;
    const double3 u = double3_sub( double3_from( s->velocity[l->i] ), double3_from( s->velocity[l->j] ) );
    const double3 drag = lost ? double3_scale( foreign, u ) : spread( t.d, along, foreign, u );
    const double3 push = double3_sub( double3_scale( h * t.pull, t.d ), drag );
    const double off =
        h * t.pull_off + 8.0 * EPSILON * h * fabs( t.pull ) +
        ( 12.0 * EPSILON * ( along + fabs( foreign ) ) + t.along_off ) * ( double3_length( u ) + EPSILON );
    p->rhs[l->i] = double3_add( p->rhs[l->i], push );
    p->rhs[l->j] = double3_sub( p->rhs[l->j], push );
    const double3 change = double3_sub( double3_from( s->direction[l->i] ), double3_from( s->direction[l->j] ) );
    const double3 pull = spread( t.d, lost ? t.foreign : t.along, t.foreign, change );
    p->product[l->i] = double3_add( p->product[l->i], pull );
    p->product[l->j] = double3_sub( p->product[l->j], pull );
    const int ends[2] = { l->i, l->j };
    for ( int k = 0; k < 2; ++k )
    {
        p->product_off[ends[k]] +=
            ( 16.0 * EPSILON * ( t.along + t.foreign ) + t.along_off ) * double3_length( change );
        p->off[ends[k]] += off;
        add_matrix( p->matrix[ends[k]], &t );
    }
    p->undirected += lost ? 2 : 0;
}

static plain_rows* plain_formulas( springs* s, int variant )
{
    plain_rows* p = checked_calloc( 1, sizeof( plain_rows ) );
    for ( int row = 0; row < ROWS; ++row )
    {
        p->product[row] = double3_scale( (double)s->position[row][3], double3_from( s->direction[row] ) );
        const double m = (double)s->position[row][3];
        p->matrix[row][0][0] = p->matrix[row][1][1] = p->matrix[row][2][2] = m;
        if ( ( variant & REPEAT ) != 0 )
        {
            const double3 back = double3_sub( double3_from( s->start[row] ), double3_from( s->velocity[row] ) );
            p->rhs[row] = double3_scale( m, back );
            p->off[row] = 4.0 * EPSILON * m * double3_length( back );
        }
    }
    for ( int k = 0; k < s->link_count; ++k )
    {
        add_plain( p, s, s->link + k, variant );
    }
    return p;
}

static void fill_solve( void* state, int variant )
{
    springs* s = state;
    copy_springs( s );
    s->variant = variant;
}

static void run_solve( const wisp_kernels* kernels, void* state, int begin, int end )
{
    springs* s = state;
    const wisp_spring_args args = spring_args( s, s->variant );
    const wisp_conjugate_args product = conjugate( s );
    s->undirected += kernels->spring_assemble( &args, begin, end );
    s->sum[0] += kernels->spring_product( &product, begin, end );
}

static void check_padding( springs* s )
{
    for ( int row = VERTICES; row < ROWS; ++row )
    {
        assert_true( double3_length( row_vector( s->rhs, row ) ) == 0.0 );
        assert_true( double3_length( row_vector( s->product, row ) ) == 0.0 );
        assert_near( (double)s->inverse[row / 8][0][row % 8], 1.0, 4.0 * EPSILON, "inverse of row", row );
        assert_true( s->inverse[row / 8][1][row % 8] == 0.0f );
    }
    // lanes of a row with fewer links than its slice have
    for ( int i = 0; i < 8 * s->entry_count; ++i )
    {
        const int e = i / 8, lane = i % 8;
        const float sum = s->axis[e][0][lane] + s->axis[e][1][lane] + s->axis[e][2][lane];
        assert_true( s->rest[e][lane] != 0.0f || ( sum == 0.0f && s->axis[e][3][lane] == 0.0f ) );
    }
}

// No link of the test may be at a corner of its force law, where the two precisions may take different sides.
static void check_solve( void* start, void* end )
{
    springs* s = end;
    for ( int k = 2; k < s->link_count; ++k )
    {
        assert_false( is_at_a_corner( s, s->link + k ) );
    }
    SCOPED( free_local ) plain_rows* p = plain_formulas( start, s->variant );
    assert_int_equal( s->undirected, p->undirected );
    assert_int_equal( s->undirected, 4 );
    double reference = 0.0, size = 0.0;
    for ( int row = 0; row < ROWS; ++row )
    {
        // a row of up to 30 links adds as many roundings of its partial sums, which the bound of each link has
        assert_near_vector( row_vector( s->rhs, row ), p->rhs[row], p->off[row] + 1e-30, "right side of row", row );
        const double3 c = double3_from( s->direction[row] );
        const double rounding = EPSILON * (double)s->position[row][3] * double3_length( c );
        assert_near_vector( row_vector( s->product, row ), p->product[row], p->product_off[row] + 2.0 * rounding,
                            "product of row", row );
        reference += double3_dot( c, p->product[row] );
        size += 2.0 * ( p->product_off[row] + rounding );
    }
    assert_near( s->sum[0], reference, size + 64.0 * EPSILON * reference, "c . q of variant", s->variant );
    check_padding( s );
}

TEST_KERNEL( forces_right_sides_and_products_are_those_of_plain_formulas_in_blocks, springs, VARIANTS, 0, SLICES, 64,
             fill_solve, run_solve, check_solve )

// ---- stiff links ----

static void assert_same_rows( const springs* s, const springs* expected )
{
    assert_memory_equal( s->rhs, expected->rhs, sizeof( s->rhs ) );
    assert_memory_equal( s->inverse, expected->inverse, sizeof( s->inverse ) );
    assert_memory_equal( s->axis, expected->axis, sizeof( s->axis ) );
}

// Forces of bending links add no stiffness.
TEST( no_link_is_stiffer_than_the_stiffest )
{
    const float stiffest = 20.0f;
    SCOPED( free_local ) springs *s = new_springs(), *softer = new_springs(), *whole = new_springs();
    int lowered = 0;
    for ( int part = 0; part < 2 * SLICES; ++part )
    {
        for ( int i = 8 * s->begin[part]; i < 8 * s->begin[part + 1]; ++i )
        {
            float* k = part % 2 == 1 ? softer->ramp[0] + i : softer->load[0] + i;
            lowered += *k > stiffest ? 1 : 0;
            *k = fminf( *k, stiffest );
        }
    }
    assert_true( lowered > 0 );
    for ( int variant = 0; variant < VARIANTS; ++variant )
    {
        wisp_spring_args args = spring_args( s, variant );
        args.max_stiffness = stiffest;
        widest_table()->spring_assemble( &args, 0, SLICES );
        assemble( widest_table(), softer, variant );
        assert_same_rows( s, softer );
        assemble( widest_table(), whole, variant );
        assert_memory_not_equal( whole->inverse, softer->inverse, sizeof( whole->inverse ) );
    }
}

// With zero velocities, places are the positions, of which no coordinate is read.
TEST( links_span_places_where_there_are_some )
{
    SCOPED( free_local ) springs *s = new_springs(), *expected = new_springs();
    static float place[ROWS][4];
    memcpy( place, s->position, sizeof( place ) );
    memset( s->velocity, 0, sizeof( s->velocity ) );
    memset( expected->velocity, 0, sizeof( expected->velocity ) );
    for ( int row = 0; row < ROWS; ++row )
    {
        s->position[row][0] = s->position[row][1] = s->position[row][2] = 7.0f;
    }
    wisp_spring_args args = spring_args( s, REPEAT );
    args.base_position = place[0];
    widest_table()->spring_assemble( &args, 0, SLICES );
    assemble( widest_table(), expected, REPEAT );
    assert_same_rows( s, expected );
}

// The missing length of a slack link within its reach stiffens the matrix, and pulls nothing.
TEST( a_reach_stiffens_and_does_not_pull )
{
    SCOPED( free_local ) springs *s = new_springs(), *plain = new_springs();
    wisp_spring_args args = spring_args( s, REPEAT );
    args.compression_margin = 1.0f;
    widest_table()->spring_assemble( &args, 0, SLICES );
    assemble( widest_table(), plain, REPEAT );
    assert_memory_equal( s->rhs, plain->rhs, sizeof( s->rhs ) );
    assert_memory_not_equal( s->inverse, plain->inverse, sizeof( s->inverse ) );
}

// ---- the inverse ----

static double3 times_inverse( springs* s, int row, double3 v )
{
    float( *m )[8] = s->inverse[row / 8];
    const int l = row % 8;
    const double xx = (double)m[0][l], xy = (double)m[1][l], xz = (double)m[2][l], yy = (double)m[3][l];
    const double yz = (double)m[4][l], zz = (double)m[5][l];
    return double3_make( xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z,
                         xz * v.x + yz * v.y + zz * v.z );
}

// |1 - P A| of a row, over the largest entry of A times that of P: the factor of a condition number.
static double error_bound_of( springs* s, const plain_rows* p, int row )
{
    double worst = 0.0;
    for ( int column = 0; column < 3; ++column )
    {
        const double3 a = { p->matrix[row][0][column], p->matrix[row][1][column], p->matrix[row][2][column] };
        const double3 unit = { column == 0, column == 1, column == 2 };
        worst = fmax( worst, double3_distance( times_inverse( s, row, a ), unit ) );
    }
    return worst;
}

static double condition_of( springs* s, const plain_rows* p, int row )
{
    double trace = 0.0, inverse = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        const int diagonal[3] = { 0, 3, 5 };
        trace += p->matrix[row][k][k];
        inverse += (double)s->inverse[row / 8][diagonal[k]][row % 8];
    }
    return trace * inverse;
}

// From the lightest mass to the heaviest. An adjugate is a difference of products, so its error is the square of the condition
// number in roundings: a sum of traces is above 9 for the identity.
TEST( the_preconditioner_is_the_inverse_for_any_mass )
{
    SCOPED( free_local ) springs* s = new_springs();
    for ( int row = 0; row < VERTICES; ++row )
    {
        s->position[row][3] = powf( 10.0f, test_random_float( row, 50, -12.0f, 12.0f ) );
    }
    for ( int k = 0; k < s->link_count; ++k )
    {
        s->link[k].damping = 0.05f; // so that a light vertex is free in no direction
    }
    place_entries( s );
    for ( int variant = 0; variant < VARIANTS; ++variant )
    {
        SCOPED( free_local ) plain_rows* p = plain_formulas( s, variant );
        assemble( widest_table(), s, variant );
        for ( int row = 1; row < ROWS; ++row )
        {
            const double condition = condition_of( s, p, row );
            assert_true( condition >= 8.9 );
            assert_near( error_bound_of( s, p, row ), 0.0, 4.0 * EPSILON * condition * condition, "inverse of row",
                         row );
        }
    }
}

// One link with k h^2 / m of 1 to 1e12 relative to the vertex at its end: conjugate gradients need r'Pr > 0 for any
// r.
TEST( the_preconditioner_is_positive_however_light_a_vertex_is )
{
    SCOPED( free_local ) springs* s = new_springs();
    s->link_count = 0;
    memset( s->rest, 0, sizeof( s->rest ) );
    memset( s->damping, 0, sizeof( s->damping ) );
    for ( int i = 0; i + 1 < VERTICES; i += 2 )
    {
        add_spring( s, i, i + 1, false );
        spring* l = s->link + s->link_count - 1;
        l->rest =
            0.999999f * (float)double3_distance( double3_from( s->position[i] ), double3_from( s->position[i + 1] ) );
        l->load = 200.0f;
        l->damping = 0.0f;
        s->position[i][3] = s->position[i + 1][3] =
            200.0f * STEP * STEP * powf( 10.0f, -12.0f * (float)i / VERTICES );
    }
    place_entries( s );
    assemble( widest_table(), s, 0 );
    for ( int i = 0; i < VERTICES; ++i )
    {
        for ( int n = 0; n < 16; ++n )
        {
            const double3 r = { (double)test_random_float( i, 100 + 3 * n, -1.0f, 1.0f ),
                                (double)test_random_float( i, 101 + 3 * n, -1.0f, 1.0f ),
                                (double)test_random_float( i, 102 + 3 * n, -1.0f, 1.0f ) };
            const double squared = double3_dot( r, times_inverse( s, i, r ) );
            if ( !( squared > 0.0 && isfinite( squared ) ) )
            {
                fail_msg( "r'Pr is %g where the link outweighs the mass %g times", squared,
                          200.0 * (double)( STEP * STEP ) / (double)s->position[i][3] );
            }
        }
    }
}

// ---- the product ----

static double product_of( springs* s, const float p[ROWS][4], const float q[ROWS][4] )
{
    memcpy( s->direction, q, sizeof( s->direction ) );
    const wisp_conjugate_args args = conjugate( s );
    widest_table()->spring_product( &args, 0, SLICES );
    double sum = 0.0;
    for ( int row = 0; row < ROWS; ++row )
    {
        sum += double3_dot( double3_from( p[row] ), row_vector( s->product, row ) );
    }
    return sum;
}

// Both ends of a link compute the same axis from differences of opposite signs.
TEST( the_matrix_is_symmetric_and_positive )
{
    SCOPED( free_local ) springs* s = new_springs();
    static float p[ROWS][4], q[ROWS][4];
    for ( int variant = 0; variant < VARIANTS; ++variant )
    {
        assemble( widest_table(), s, variant );
        for ( int n = 0; n < 8; ++n )
        {
            memset( p, 0, sizeof( p ) );
            memset( q, 0, sizeof( q ) );
            for ( int i = 0; i < 3 * VERTICES; ++i )
            {
                p[i / 3][i % 3] = test_random_float( i, 60 + n, -1.0f, 1.0f );
                q[i / 3][i % 3] = test_random_float( i, 70 + n, -1.0f, 1.0f );
            }
            const double pq = product_of( s, (const float( * )[4])p, (const float( * )[4])q );
            const double qp = product_of( s, (const float( * )[4])q, (const float( * )[4])p );
            const double pp = product_of( s, (const float( * )[4])p, (const float( * )[4])p );
            const double qq = product_of( s, (const float( * )[4])q, (const float( * )[4])q );
            assert_true( pp > 0.0 && qq > 0.0 );
            assert_near( pq, qp, 8.0 * EPSILON * sqrt( pp * qq ), "p'Aq of variant", variant );
        }
    }
}

// ---- vectors ----

// What is advanced is the factor of the variant, times the direction.
static float factor_of( const springs* s )
{
    return s->variant == 0 ? 0.25f : 0.0f;
}

static void fill_advance( void* state, int variant )
{
    springs* s = state;
    fill_solve( s, 0 );
    make_filters( s );
    run_solve( widest_table(), s, 0, SLICES );
    s->variant = variant;
}

static void run_advance( const wisp_kernels* kernels, void* state, int begin, int end )
{
    springs* s = state;
    const wisp_conjugate_args args = conjugate( s );
    s->sum[1] += kernels->conjugate_advance( &args, factor_of( s ), begin, end );
    kernels->conjugate_update( &args, factor_of( s ), 0.5f, begin, end );
}

static double3 times( const double3 rows[3], double3 v )
{
    return double3_make( double3_dot( rows[0], v ), double3_dot( rows[1], v ), double3_dot( rows[2], v ) );
}

static double3 filtered( springs* s, int row, double3 v )
{
    double m[6];
    for ( int i = 0; i < 6; ++i )
    {
        m[i] = (double)s->filter[row / 8][i][row % 8];
    }
    const double3 rows[3] = { { m[0], m[1], m[2] }, { m[1], m[3], m[4] }, { m[2], m[4], m[5] } };
    return s->filtered[row / 8] != 0 ? times( rows, v ) : v;
}

static void check_advance( void* start, void* end )
{
    springs *before = start, *s = end;
    const double a = (double)factor_of( s );
    double reference = 0.0, size = 0.0;
    for ( int row = 0; row < ROWS; ++row )
    {
        const double3 q = row_vector( before->product, row ), was = row_vector( before->rhs, row );
        const double3 r = double3_sub( was, double3_scale( a, q ) ), left = filtered( s, row, r );
        const double largest = double3_length( was ) + double3_length( q );
        assert_near_vector( row_vector( s->rhs, row ), r, EPSILON * largest, "r", row );
        const double3 search = filtered( s, row, times_inverse( s, row, left ) );
        const int l = row % 8;
        const double scale = largest * ( (double)s->inverse[row / 8][0][l] + (double)s->inverse[row / 8][3][l] +
                                         (double)s->inverse[row / 8][5][l] );
        assert_near_vector( row_vector( s->search, row ), search, 16.0 * EPSILON * scale, "s", row );
        reference += double3_dot( left, search );
        size += largest * scale;
        const double3 old = double3_from( before->direction[row] );
        const double3 c = double3_add_scaled( row_vector( s->search, row ), 0.5, old );
        assert_near3( row_vector( s->solution, row ), double3_scale( a, old ), 0.0, "dv", row );
        assert_true( s->direction[row][3] == before->position[row][3] );
        assert_near_vector( double3_from( s->direction[row] ), c, EPSILON * double3_length( c ) + 1e-30, "c", row );
    }
    assert_near( s->sum[1], reference, 32.0 * EPSILON * size, "r . s", 0 );
}

TEST_KERNEL( an_advance_and_a_turn_are_what_they_say, springs, 2, 0, SLICES, 64, fill_advance, run_advance,
             check_advance )

// ---- potential ----

// Rows move by up to as much as they are apart, so that links go slack and taut and arcs buckle. In the second variant
// arcs are alone, which links that stretch would hide.
static void fill_motion( void* state, int variant )
{
    springs* s = state;
    fill_solve( s, variant );
    for ( int i = 0; i < 3 * VERTICES; ++i )
    {
        const int row = i / 3, k = i % 3;
        s->start[row][k] = s->position[row][k] + test_random_float( row, 50 + k, -0.05f, 0.05f );
    }
    for ( int part = 0; part < 2 * SLICES && variant == 1; part += 2 )
    {
        memset( s->load[s->begin[part]], 0, (size_t)( s->begin[part + 1] - s->begin[part] ) * 32 );
    }
}

static void run_gain( const wisp_kernels* kernels, void* state, int begin, int end )
{
    springs* s = state;
    wisp_spring_args args = spring_args( s, 0 );
    args.base_position = s->start[0];
    const wisp_spring_gain found = kernels->spring_gain( &args, begin, end );
    s->sum[0] += found.gain;
    s->sum[1] += found.stored;
}

static double potential_of( const spring* l, const float ( *position )[4] )
{
    const double r = double3_distance( double3_from( position[l->i] ), double3_from( position[l->j] ) );
    const double rest = (double)l->rest, load = (double)l->load, ramp_end = (double)l->ramp_end;
    if ( l->bends == false )
    {
        return 0.5 * load * fmax( 0.0, r - rest ) * fmax( 0.0, r - rest );
    }
    const double y = fmin( r / rest, 1.0 ), straight = rest * fmin( 1.0 - y, 1.0 - ramp_end );
    const double arc = triangle_oracle_arc_energy( fmin( y, ramp_end ) ) - triangle_oracle_arc_energy( ramp_end );
    return 0.5 * (double)l->ramp * straight * straight + load * rest * arc;
}

static void check_gain( void* start, void* end )
{
    (void)start;
    springs* s = end;
    double gain = 0.0, stored = 0.0, off = 0.0;
    int slack = 0, buckled = 0;
    for ( const spring* l = s->link; l < s->link + s->link_count; ++l )
    {
        const bool counts = l->bends || s->variant == 0;
        const double before = counts ? potential_of( l, (const float( * )[4])s->start ) : 0.0,
                     after = counts ? potential_of( l, (const float( * )[4])s->position ) : 0.0;
        gain += after - before;
        stored += after;
        // a length has some four roundings, and the polynomial is within 3e-7 of 6
        off += 1e-6 * ( before + after ) +
               8.0 * EPSILON * 0.2 * sqrt( ( s->variant == 0 ? 400.0 : 80.0 ) * ( before + after ) );
        slack += l->bends == false && ( before == 0.0 ) != ( after == 0.0 ) ? 1 : 0;
        buckled += l->bends && l->ramp_end > 0.0f && after > before ? 1 : 0;
    }
    assert_true( ( s->variant == 1 || slack > 100 ) && buckled > 100 );
    assert_near( s->sum[0], gain, off, "gain, variant", s->variant );
    assert_near( s->sum[1], stored, off, "potential, variant", s->variant );
    assert_true( s->variant == 0 || off < 1e-2 * stored );
}

TEST_KERNEL( a_gain_is_the_change_of_the_potential_of_links, springs, 2, 0, SLICES, 64, fill_motion, run_gain,
             check_gain )
