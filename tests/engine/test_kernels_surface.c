// Kernels of surfaces: every table gives the same bits, and one projection agrees with the oracle in double
// precision. Sharp folds: bend links that give way, and that all other links move as without folds; hinges that are
// found.
#include "kernels_fixture.h"

#include "constraint_oracle.h"

#include "wisp/fabric.h"

// Positions are below 3 m and every step of a projection rounds a number of at most that size. The longest chain of
// roundings between two positions is that of the dihedral: differences, a product, a normal and its square, an arc
// tangent of a few roundings, a quotient, two products, a sum.
static const double ROUNDING = 24.0 * (double)FLT_EPSILON;

static const int ALL[4] = { 0, 1, 2, 3 };

typedef struct particles
{
    double3 p[4];
    double w[4];
} particles;

static particles particles_of( constraints* s, int c )
{
    particles found;
    for ( int k = 0; k < 4; ++k )
    {
        found.p[k] = double3_from( body( s, c, k ) );
        found.w[k] = (double)body( s, c, k )[3];
    }
    return found;
}

static void assert_at( constraints* s, const particles* expected, int c, double tolerance )
{
    for ( int k = 0; k < 4; ++k )
    {
        double gap = double3_distance( double3_from( body( s, c, k ) ), expected->p[k] );
        assert_near( gap, 0.0, tolerance, "gap of constraint", c );
        assert_near( (double)body( s, c, k )[3], expected->w[k], 0.0, "inverse mass of constraint", c );
    }
}

static constraints* new_constraints( bool pins )
{
    constraints* s = new_aligned( sizeof( constraints ) );
    make_constraints( s, pins );
    return s;
}

static constraints* copy_of( const constraints* s )
{
    return memcpy( new_aligned( sizeof( *s ) ), s, sizeof( *s ) );
}

// ---- projections ----

// Constraints that are satisfied, so small that they underflow, or so large that they nearly overflow.
static void make_odd( constraints* s, int first )
{
    for ( int c = first; c < first + 48; ++c )
    {
        float tiny = ldexpf( 1.0f, -3 * ( c - first ) ), upper = c % 3 == 0 ? 0.0f : tiny;
        place( s, c, 0, 0.1f, 0.2f, 0.0f, 1.0f );
        place( s, c, 1, 0.1f, 0.2f, tiny, c % 2 == 0 ? 1.0f : 1e-12f );
        place( s, c, 2, 0.1f, 0.2f + upper, 0.0f, 0.0f );
        place( s, c, 3, 0.1f, 0.2f, upper, 1e9f );
    }
}

// Constraints with particles of their own, some of them odd, or with shared ones.
static void fill_constraints( void* state, int variant )
{
    constraints* s = state;
    make_constraints( s, variant % 2 == 1 );
    if ( variant >= 2 )
    {
        tangle( s );
    }
    else
    {
        make_odd( s, 40 );
    }
}

// How constraints may be projected.
typedef enum projection
{
    LINK_PBD,
    LINK_XPBD,
    LINK_XPBD_ONCE,
    LINK_LIMIT,
    DIHEDRAL_PBD,
    DIHEDRAL_XPBD,
    ISOMETRIC_PBD,
    PROJECTIONS,
} projection;

static void project_range( const wisp_kernels* kernels, constraints* s, projection kind, int begin, int end )
{
    wisp_link_args links = link_args( s );
    links.lambda = kind == LINK_XPBD_ONCE ? NULL : links.lambda;
    links.own = kind == LINK_PBD ? s->stiffness : links.own;
    const wisp_hinge_args hinges = hinge_args( s, kind == ISOMETRIC_PBD, kind != DIHEDRAL_XPBD );
    switch ( kind )
    {
        case LINK_PBD:
            kernels->link_pbd( &links, begin, end );
            break;
        case LINK_XPBD:
        case LINK_XPBD_ONCE:
            kernels->link_xpbd( &links, begin, end );
            break;
        case LINK_LIMIT:
            kernels->link_limit( &links, begin, end );
            break;
        case ISOMETRIC_PBD:
            kernels->hinge_isometric( &hinges, begin, end );
            break;
        default:
            kernels->hinge_dihedral( &hinges, begin, end );
    }
}

static void project( constraints* s, projection kind )
{
    project_range( widest_table(), s, kind, 0, CONSTRAINTS );
}

// The kernel's angle is positive where the oracle's is negative, so a rest angle changes its sign.
static constraint_oracle_term dihedral_of_oracle( const constraints* s, int c, const particles* all )
{
    return constraint_oracle_dihedral( all->p, -(double)s->angle[c] );
}

static constraint_oracle_term isometric_of_oracle( constraints* s, int c, const particles* all )
{
    double q[4][4];
    for ( int i = 0; i < 16; ++i )
    {
        q[i / 4][i % 4] =
            (double)s->scale[c] * (double)s->weights[c / 8][i / 4][c % 8] * (double)s->weights[c / 8][i % 4][c % 8];
    }
    return constraint_oracle_isometric_root( all->p, q );
}

// What the oracle makes of a constraint. @return its multiplier
static double project_by_oracle( constraints* s, projection kind, int c, particles* all )
{
    constraint_oracle_skips skips = { 0 };
    const double rest = (double)s->rest[c];
    const bool is_dihedral = kind == DIHEDRAL_PBD || kind == DIHEDRAL_XPBD;
    const constraint_oracle_term term =
        is_dihedral             ? dihedral_of_oracle( s, c, all )
        : kind == ISOMETRIC_PBD ? isometric_of_oracle( s, c, all )
        : kind == LINK_LIMIT
            ? constraint_oracle_strain_limit( all->p[0], all->p[1], rest, (double)0.9f, (double)1.1f )
            : constraint_oracle_distance( all->p[0], all->p[1], rest );
    const double sign = is_dihedral ? -1.0 : 1.0, before = (double)s->lambda[c];
    double lambda = kind == LINK_XPBD_ONCE ? 0.0 : sign * before;
    if ( kind == LINK_XPBD || kind == LINK_XPBD_ONCE || kind == DIHEDRAL_XPBD )
    {
        constraint_oracle_project_compliant( &term, ALL, all->w, 1e4 * (double)s->compliance[c], &lambda, all->p,
                                             &skips );
        return kind == LINK_XPBD_ONCE ? before : sign * lambda;
    }
    constraint_oracle_project( &term, ALL, all->w, kind == LINK_LIMIT ? 1.0 : (double)s->stiffness[c], all->p,
                               &skips );
    return before;
}

// Every constraint has its own particles, so the oracle may check them one by one.
static void expect_oracle( projection kind )
{
    SCOPED( free_local ) constraints *before = new_constraints( true ), *after = copy_of( before );
    project( after, kind );
    for ( int c = 0; c < CONSTRAINTS; ++c )
    {
        particles expected = particles_of( before, c );
        const double lambda = project_by_oracle( before, kind, c, &expected );
        assert_at( after, &expected, c, ROUNDING );
        assert_near( (double)after->lambda[c], lambda, ROUNDING * ( 1.0 + fabs( lambda ) ), "lambda", c );
    }
}

#define TEST_PROJECTION( name, kind )                                                                                \
    static void run_##name( const wisp_kernels* kernels, void* state, int begin, int end )                           \
    {                                                                                                                \
        project_range( kernels, state, kind, begin, end );                                                           \
    }                                                                                                                \
    TEST_KERNEL( name, constraints, 4, 0, CONSTRAINTS, 8, fill_constraints, run_##name, NULL )                       \
    TEST( name##_as_the_oracle_says )                                                                                \
    {                                                                                                                \
        expect_oracle( kind );                                                                                       \
    }

TEST_PROJECTION( links_move_by_their_stiffness, LINK_PBD )
TEST_PROJECTION( links_move_by_their_compliance, LINK_XPBD )
TEST_PROJECTION( links_move_by_their_compliance_once, LINK_XPBD_ONCE )
TEST_PROJECTION( links_move_to_their_limits, LINK_LIMIT )
TEST_PROJECTION( angles_move_by_their_stiffness, DIHEDRAL_PBD )
TEST_PROJECTION( angles_move_by_their_compliance, DIHEDRAL_XPBD )
TEST_PROJECTION( isometric_hinges_move_by_their_stiffness, ISOMETRIC_PBD )

// ---- links ----

TEST( two_ends_share_a_step_as_their_inverse_masses )
{
    SCOPED( free_local ) constraints* s = new_constraints( false );
    const float weights[3][2] = { { 1.0f, 1.0f }, { 1.0f, 3.0f }, { 0.0f, 1.0f } };
    const float rest[2] = { 1.0f, 0x1p-20f }; // a metre and a micrometre
    for ( int c = 0; c < 6; ++c )
    {
        place( s, c, 0, 0.0f, 0.0f, 0.0f, weights[c % 3][0] );
        place( s, c, 1, 2.0f * rest[c / 3], 0.0f, 0.0f, weights[c % 3][1] );
        s->rest[c] = rest[c / 3];
        s->stiffness[c] = 1.0f;
    }
    project( s, LINK_PBD );

    // halves, quarters and wholes of powers of two are exact
    const float first[3] = { 0.5f, 0.25f, 0.0f }, second[3] = { 1.5f, 1.25f, 1.0f };
    for ( int c = 0; c < 6; ++c )
    {
        assert_true( body( s, c, 0 )[0] == first[c % 3] * rest[c / 3] );
        assert_true( body( s, c, 1 )[0] == second[c % 3] * rest[c / 3] );
    }
}

// ---- hinges ----

TEST( an_angle_is_positive_where_the_opposite_vertices_are_on_the_side_of_the_normals )
{
    SCOPED( free_local ) constraints* s = new_constraints( false );

    // counter-clockwise seen from +z, so normals point up, and both wings are up by 0.1 of 0.5
    place( s, 0, 0, 0.0f, 0.0f, 0.0f, 1.0f );
    place( s, 0, 1, 1.0f, 0.0f, 0.0f, 1.0f );
    place( s, 0, 2, 0.5f, 0.5f, 0.1f, 1.0f );
    place( s, 0, 3, 0.5f, -0.5f, 0.1f, 1.0f );
    s->angle[0] = 2.0f * atanf( 0.2f );
    s->stiffness[0] = 1.0f;
    particles before = particles_of( s, 0 );
    project( s, DIHEDRAL_PBD );
    assert_at( s, &before, 0, ROUNDING );

    s->angle[0] = 0.0f;
    project( s, DIHEDRAL_PBD );
    assert_true( body( s, 0, 2 )[2] < 0.099f && body( s, 0, 3 )[2] < 0.099f && body( s, 0, 0 )[2] > 0.001f );
}

// Rest data of an isometric hinge are c = sqrt( Q / s ), as cooking must compute them from a column of the oracle's Q. Every
// second hinge is flat, moved and turned, and has no energy.
TEST( an_isometric_hinge_knows_bending_from_moving )
{
    SCOPED( free_local ) constraints* s = new_constraints( false );
    static double q[CONSTRAINTS][4][4];
    for ( int c = 0; c < CONSTRAINTS; ++c )
    {
        const float turn = test_random_float( c, 20, -3.0f, 3.0f );
        const float fold = turn + ( c % 2 == 0 ? 0.0f : test_random_float( c, 21, 0.2f, 2.0f ) );
        const float up = test_random_float( c, 22, 0.3f, 0.7f ), down = test_random_float( c, 23, 0.3f, 0.7f );
        const double3 rest[4] = {
            { 0.0, 0.0, 0.0 }, { 0.6, 0.0, 0.0 }, { 0.1, (double)up, 0.0 }, { 0.4, -(double)down, 0.0 }
        };
        place( s, c, 0, 1.0f, 0.5f, -1.0f, 1.0f );
        place( s, c, 1, 1.6f, 0.5f, -1.0f, 1.0f );
        place( s, c, 2, 1.1f, 0.5f + up * cosf( turn ), -1.0f + up * sinf( turn ), 1.0f );
        place( s, c, 3, 1.4f, 0.5f - down * cosf( fold ), -1.0f - down * sinf( fold ), 1.0f );
        assert_true( constraint_oracle_isometric_matrix( rest, q[c] ) );
        s->stiffness[c] = 1.0f;
        for ( int k = 0; k < 4; ++k )
        {
            s->weights[c / 8][k][c % 8] =
                (float)( q[c][k][2] / sqrt( 3.0 / ( 0.3 * (double)( up + down ) ) * q[c][2][2] ) );
        }
    }
    SCOPED( free_local ) constraints* after = copy_of( s );
    project( after, ISOMETRIC_PBD );
    for ( int c = 0; c < CONSTRAINTS; ++c )
    {
        particles expected = particles_of( s, c );
        const constraint_oracle_term term = constraint_oracle_isometric_root( expected.p, q[c] );
        constraint_oracle_skips skips = { 0 };
        constraint_oracle_project( &term, ALL, expected.w, c % 2 == 0 ? 0.0 : 1.0, expected.p, &skips );
        assert_at( after, &expected, c, ROUNDING );
        assert_true( c % 2 == 0 ? term.value < 1e-5 : term.value > 0.1 );
    }
}

// ---- invariants of projections ----

// Sums of m dp and of p x m dp, and the size of the terms that cancel in them.
static void sum_momentum( constraints* before, constraints* after, int c, int corners )
{
    double3 linear = { 0.0, 0.0, 0.0 }, angular = linear;
    double mass = 0.0;
    for ( int k = 0; k < corners; ++k )
    {
        double m = 1.0 / (double)body( before, c, k )[3];
        double3 p = double3_from( body( before, c, k ) );
        double3 moved = double3_scale( m, double3_sub( double3_from( body( after, c, k ) ), p ) );
        linear = double3_add( linear, moved );
        angular = double3_add( angular, double3_cross( p, moved ) );
        mass += m;
    }
    assert_near( double3_length( linear ), 0.0, mass * ROUNDING, "linear momentum of constraint", c );
    assert_near( double3_length( angular ), 0.0, 2.0 * mass * ROUNDING, "angular momentum of constraint", c );
}

TEST( projections_keep_linear_and_angular_momentum )
{
    SCOPED( free_local ) constraints* before = new_constraints( false );
    for ( int k = 0; k < PROJECTIONS; ++k )
    {
        SCOPED( free_local ) constraints* after = copy_of( before );
        project( after, (projection)k );
        bool is_link = k < 4;
        for ( int c = 0; c < CONSTRAINTS; ++c )
        {
            sum_momentum( before, after, c, is_link ? 2 : 4 );
        }
    }
}

// Coincident, without area, pinned (some of them a thousand kilometres apart), or padding: no bit of positions or
// lambda changes.
TEST( constraints_without_a_direction_or_a_free_end_leave_every_bit )
{
    constraints* before = new_constraints( false );
    for ( int c = 0; c < CONSTRAINTS; ++c )
    {
        for ( int k = 0; k < 4; ++k )
        {
            const float* first = body( before, c, 0 );
            switch ( c % 3 )
            {
                case 0:
                    place( before, c, k, first[0], first[1], first[2], 1.0f );
                    break;
                case 1:
                    body( before, c, k )[0] *= c % 2 == 0 ? 1.0f : 1e6f;
                    body( before, c, k )[3] = 0.0f;
                    break;
                default:
                    set_slot( before, c, k, c );
                    break;
            }
        }
    }
    for ( int k = 0; k < PROJECTIONS; ++k )
    {
        SCOPED( free_local ) constraints* after = copy_of( before );
        project( after, (projection)k );
        assert_memory_equal( after->position, before->position, sizeof( after->position ) );
        assert_memory_equal( after->lambda, before->lambda, sizeof( after->lambda ) );
    }
    free( before );
}

// Lengths and heights of all magnitudes, far from rest, and masses from a milligram to that of a mountain.
TEST( no_projection_throws_a_particle_to_infinity )
{
    SCOPED( free_local ) constraints* before = new_constraints( false );
    for ( int c = 0; c < CONSTRAINTS; ++c )
    {
        float length = ldexpf( 1000.0f, -( c % 50 ) * 3 ), height = ldexpf( length, -( c / 50 ) * 16 );
        float weight = c / 2 % 2 == 0 ? 1e6f : 1e-15f;
        place( before, c, 0, 0.0f, 0.0f, 0.0f, weight );
        place( before, c, 1, length, 0.0f, 0.0f, weight );
        place( before, c, 2, 0.5f * length, height, 0.0f, weight );
        place( before, c, 3, 0.5f * length, height, height, c % 3 == 0 ? 0.0f : weight );
        before->rest[c] = 1000.0f;
        before->stiffness[c] = 1.0f;
        before->compliance[c] = 0.0f;
    }
    for ( int k = 0; k < PROJECTIONS; ++k )
    {
        SCOPED( free_local ) constraints* after = copy_of( before );
        project( after, (projection)k );
        for ( int i = 0; i < BODIES * 4; ++i )
        {
            if ( !( fabsf( after->position[i / 4][i % 4] ) <= 1e7f ) )
            {
                fail_msg( "projection %d: particle %d is at %g", k, i / 4, (double)after->position[i / 4][i % 4] );
            }
        }
    }
}

// ---- folds ----

enum
{
    EDGES = CONSTRAINTS / 2,    // the rest are bend links
    SEARCHED = CONSTRAINTS - 8, // whole groups, not all of them
    HINGES = SEARCHED - 3,      // the last group is padded
};

static const float ALIKE[2] = { 1e-4f, 3e-2f }; // of edges and of bend links

typedef struct folds
{
    constraints s;
    uint8_t bends[GROUPS + 3], folded[GROUPS];
    float span2[CONSTRAINTS];
    projection kind;
} folds;

static double length_of( constraints* s, int c )
{
    return double3_distance( double3_from( body( s, c, 0 ) ), double3_from( body( s, c, 1 ) ) );
}

// Every third link is far too short.
static void fill_folds( void* state, int variant )
{
    folds* f = state;
    make_constraints( &f->s, true );
    f->kind = (projection)( LINK_PBD + variant );
    for ( int c = 0; c < CONSTRAINTS; ++c )
    {
        f->bends[c / 8] = c < EDGES ? 0 : 0xff;
        f->s.compliance[c] = f->kind == LINK_XPBD ? f->s.compliance[c] : ALIKE[c >= EDGES];
        f->s.stiffness[c] = ALIKE[c >= EDGES];
        f->s.rest[c] = c % 3 == 0 ? (float)( 2.5 * length_of( &f->s, c ) ) : f->s.rest[c];
    }
}

static void run_folds( const wisp_kernels* kernels, void* state, int begin, int end )
{
    folds* f = state;
    wisp_link_args args = link_args( &f->s );
    args.lambda = f->kind == LINK_XPBD_ONCE ? NULL : args.lambda;
    args.own = f->kind == LINK_XPBD ? args.own : NULL;
    memcpy( args.alike, ALIKE, sizeof( ALIKE ) );
    args.bends = f->bends, args.folded = f->folded;
    ( f->kind == LINK_PBD ? kernels->link_pbd : kernels->link_xpbd )( &args, begin, end );
}

static void check_folds( void* before, void* after )
{
    folds *start = before, *most = after;
    SCOPED( free_local ) constraints* all = copy_of( &start->s );
    project( all, start->kind );
    int found = 0;
    for ( int c = 0; c < CONSTRAINTS; ++c )
    {
        const bool is_left = c >= EDGES && 2.0 * length_of( &start->s, c ) < (double)start->s.rest[c];
        constraints* expected = is_left ? &start->s : all;
        assert_int_equal( most->folded[c / 8] >> c % 8 & 1, is_left );
        for ( int k = 0; k < 2; ++k )
        {
            assert_memory_equal( body( &most->s, c, k ), body( expected, c, k ), 4 * sizeof( float ) );
        }
        assert_true( most->s.lambda[c] == expected->lambda[c] );
        found += is_left;
    }
    assert_true( found > CONSTRAINTS / 8 && found < CONSTRAINTS / 2 );
}

TEST_KERNEL( short_bend_links_stay_and_are_marked, folds, 3, 0, CONSTRAINTS, 8, fill_folds, run_folds, check_folds )

static float span2_of( constraints* s, int c )
{
    const float *k = body( s, c, 2 ), *l = body( s, c, 3 );
    const float x = l[0] - k[0], y = l[1] - k[1], z = l[2] - k[2];
    return x * x + y * y + z * z;
}

// A quarter of the square is a bound that many distances meet exactly; one place is not a number. The padding of the
// last group is k and l at one place.
static void fill_hinges( void* state, int seed )
{
    folds* f = state;
    make_constraints( &f->s, true );
    memset( f->folded, 0xa5, sizeof( f->folded ) );
    for ( int c = 0; c < HINGES; ++c )
    {
        f->span2[c] = span2_of( &f->s, c ) * ( c % 3 == 0 ? 4.0f : test_random_float( c, 17 + seed, 3.0f, 5.0f ) );
    }
    for ( int c = HINGES; c < CONSTRAINTS; ++c )
    {
        set_slot( &f->s, c, 3, f->s.slot_x4[c / 8][2][c % 8] / 4 );
    }
    body( &f->s, 17, 2 )[1] = NAN;
}

static void run_hinges( const wisp_kernels* kernels, void* state, int begin, int end )
{
    folds* f = state;
    const wisp_fold_args args = { f->s.position[0], f->s.slot_x4[0][0], f->span2, f->folded };
    kernels->hinge_find_folds( &args, begin, end );
}

static void check_hinges( void* start, void* end )
{
    (void)start;
    folds* f = end;
    int found = 0;
    for ( int c = 8; c < SEARCHED; ++c )
    {
        const bool near = 4.0f * span2_of( &f->s, c ) < f->span2[c];
        assert_int_equal( f->folded[c / 8] >> c % 8 & 1, near );
        found += near;
    }
    assert_true( found > CONSTRAINTS / 8 && found < CONSTRAINTS / 2 );
    assert_true( f->folded[0] == 0xa5 && f->folded[GROUPS - 1] == 0xa5 ); // out of the range
}

TEST_KERNEL( hinges_nearer_than_half_their_span_are_found, folds, 2, 8, SEARCHED, 8, fill_hinges, run_hinges,
             check_hinges )
