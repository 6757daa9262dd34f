// Springs and conjugate gradients over rows: every table gives the same bits; the arc, the inverses of blocks and the potential that links
// gain in a motion agree with double precision. Forces, right sides and solutions are held to the oracle in
// tests/modules/test_implicit_cloth_against_oracle.c.
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

// ---- assembly and product ----

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

// The formulas are those of the oracle that implicit cloth follows. Rows that pad, and lanes of a row with fewer links than its slice has,
// are nothing.
static void check_padding( void* start, void* end )
{
    (void)start;
    springs* s = end;
    assert_int_equal( s->undirected, 4 );
    for ( int row = VERTICES; row < ROWS; ++row )
    {
        assert_true( double3_length( row_vector( s->rhs, row ) ) == 0.0 );
        assert_true( double3_length( row_vector( s->product, row ) ) == 0.0 );
        assert_near( (double)s->inverse[row / 8][0][row % 8], 1.0, 4.0 * EPSILON, "inverse of row", row );
        assert_true( s->inverse[row / 8][1][row % 8] == 0.0f );
    }
    for ( int i = 0; i < 8 * s->entry_count; ++i )
    {
        const int e = i / 8, lane = i % 8;
        const float sum = s->axis[e][0][lane] + s->axis[e][1][lane] + s->axis[e][2][lane];
        assert_true( s->rest[e][lane] != 0.0f || ( sum == 0.0f && s->axis[e][3][lane] == 0.0f ) );
    }
}

TEST_KERNEL( forces_right_sides_and_products_have_the_same_bits_in_blocks, springs, VARIANTS, 0, SLICES, 64,
             fill_solve, run_solve, check_padding )

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

// Rows of which no two are linked: of a direction that is 0 elsewhere, their products are those of their own blocks.
static void choose_apart( const springs* s, bool apart[ROWS] )
{
    for ( int row = 1; row < VERTICES; ++row )
    {
        apart[row] = true;
        for ( int k = 0; k < s->link_count; ++k )
        {
            const int i = s->link[k].i, j = s->link[k].j, other = i == row ? j : i;
            apart[row] = apart[row] && ( ( i != row && j != row ) || other > row || apart[other] == false );
        }
    }
}

// |1 - P A| of a row, from the lightest mass to the heaviest. An adjugate is a difference of products, so its error is the square of the
// condition number in roundings: a sum of traces is above 9 for the identity.
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
    bool apart[ROWS] = { false };
    choose_apart( s, apart );
    int checked = 0;
    for ( int variant = 0; variant < VARIANTS; ++variant )
    {
        assemble( widest_table(), s, variant );
        double error[ROWS] = { 0.0 }, trace[ROWS] = { 0.0 };
        for ( int k = 0; k < 3; ++k )
        {
            for ( int row = 0; row < ROWS; ++row )
            {
                for ( int j = 0; j < 4; ++j )
                {
                    s->direction[row][j] = j == 3 ? s->position[row][3] : apart[row] && j == k ? 1.0f : 0.0f;
                }
            }
            const wisp_conjugate_args product = conjugate( s );
            widest_table()->spring_product( &product, 0, SLICES );
            for ( int row = 0; row < VERTICES; ++row )
            {
                const double3 column = row_vector( s->product, row ), unit = { k == 0, k == 1, k == 2 };
                error[row] = fmax( error[row], double3_distance( times_inverse( s, row, column ), unit ) );
                trace[row] += double3_dot( column, unit );
            }
        }
        for ( int row = 0; row < VERTICES; ++row )
        {
            float( *inverse )[8] = s->inverse[row / 8];
            const double condition =
                trace[row] * (double)( inverse[0][row % 8] + inverse[3][row % 8] + inverse[5][row % 8] );
            if ( apart[row] )
            {
                assert_true( condition >= 8.9 );
                assert_near( error[row], 0.0, 4.0 * EPSILON * condition * condition, "inverse of row", row );
                checked += 1;
            }
        }
    }
    assert_true( checked > 200 );
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

TEST_KERNEL( an_advance_and_a_turn_have_the_same_bits_in_blocks, springs, 2, 0, SLICES, 64, fill_advance, run_advance,
             NULL )

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
