// Kernels over groups of strands: every instruction set gives the same bits, lanes are independent, and properties of
// each kernel for a single strand. tests/modules compares them with the oracle in double precision. The table of values
// that ghosts share (Park and Kim 2024, eq. 4-5): the range of the elastic weight where rounding could leave it, and the
// factor that a group has in common.
#include "kernels_fixture.h"

enum
{
    STRAND_GROUPS = 8,
    // vertices of each group's longest strands: equal in pairs, and different
    STRAND_ROWS = 3 + 20 + 20 + 9 + 1 + 1 + 2 + 2,
};

typedef struct strands_state
{
    _Alignas( 64 ) float position[STRAND_ROWS][3][16];
    float previous[STRAND_ROWS][3][16], velocity[STRAND_ROWS][3][16], low[STRAND_ROWS][3][16],
        segment[STRAND_ROWS][3][16];
    float speed[STRAND_ROWS][16];
    float weight[STRAND_ROWS][16], length[STRAND_ROWS][16], tension[STRAND_ROWS][16];
    float max_tension[STRAND_ROWS][16];
    float rest2[STRAND_ROWS][16], lambda[STRAND_ROWS][16]; // of links two apart
    float inverse_length[STRAND_ROWS][16], stiffness[STRAND_ROWS][16], factor[STRAND_ROWS][3][16];
    float frame[STRAND_ROWS][4][16], rest[STRAND_ROWS][3][16], rest_twist[STRAND_ROWS][2][16];
    float twist_stiffness[STRAND_ROWS][16];
    float root[STRAND_GROUPS][3][16], root_low[STRAND_GROUPS][3][16], turn[STRAND_GROUPS][4][16],
        clamp[STRAND_GROUPS][4][16];
    float fraction[STRAND_GROUPS][16];
    float displacement[STRAND_ROWS][3][16], before[STRAND_ROWS][3][16], step[STRAND_ROWS][16];
    float first_order_factor[STRAND_ROWS][3][16];
    float scratch[20 * WISP_STRAND_SCRATCH];
    int32_t group_row[STRAND_GROUPS + 1];
    int count[STRAND_GROUPS][16]; // vertices of a lane's strand
    bool has_history;
    int kind; // rods, curved rods, links, or lengths alone
} strands_state;

static float strand_random( int row, int lane, int what, float lower, float upper )
{
    return test_random_float( row * 16 + lane, what, lower, upper );
}

// A frame whose z axis points along e.
static void strand_frame( float ( *frame )[16], int lane, const float e[3] )
{
    const double length = sqrt( (double)( e[0] * e[0] + e[1] * e[1] + e[2] * e[2] ) );
    const double t[3] = { e[0] / length, e[1] / length, e[2] / length };
    const double norm = sqrt( 2.0 * ( 1.0 + t[2] ) );
    frame[0][lane] = (float)( -t[1] / norm );
    frame[1][lane] = (float)( t[0] / norm );
    frame[2][lane] = 0.0f;
    frame[3][lane] = (float)( ( 1.0 + t[2] ) / norm );
}

// The start of a substep of 1/600 s that ends at the positions, and the segments there.
static void find_start( strands_state* s )
{
    for ( int i = 0; i < STRAND_ROWS * 48; ++i )
    {
        const int row = i / 48, k = i / 16 % 3, lane = i % 16;
        const float path = s->weight[row][lane] > 0.0f ? s->velocity[row][k][lane] / 600.0f : 0.0f;
        const float v = s->velocity[row][k][lane];
        s->speed[row][lane] = ( k > 0 ? s->speed[row][lane] : 0.0f ) + v * v;
        s->previous[row][k][lane] = s->position[row][k][lane] - path;
        if ( row > 0 )
        {
            s->segment[row - 1][k][lane] = s->position[row - 1][k][lane] - s->position[row][k][lane];
        }
    }
}

// Strands of about 5 mm a segment that wander upward; lane l of a group lacks l / 4 vertices of the longest.
static void make_strands( strands_state* s )
{
    static const int LONGEST[STRAND_GROUPS] = { 3, 20, 20, 9, 1, 1, 2, 2 };
    memset( s, 0, sizeof( *s ) );
    for ( int g = 0; g < STRAND_GROUPS; ++g )
    {
        s->group_row[g + 1] = s->group_row[g] + LONGEST[g];
        for ( int lane = 0; lane < 16; ++lane )
        {
            s->count[g][lane] = LONGEST[g] - lane / 4 > 0 ? LONGEST[g] - lane / 4 : ( lane == 15 ? 0 : 1 );
            s->turn[g][3][lane] = s->clamp[g][3][lane] = 1.0f;
            s->fraction[g][lane] = strand_random( g, lane, 18, 0.2f, 1.0f );
            float at[3] = { 0.02f * (float)lane, 0.01f * (float)g, 0.0f };
            for ( int row = s->group_row[g]; row < s->group_row[g + 1]; ++row )
            {
                const int i = row - s->group_row[g], left = s->count[g][lane] - 1 - i;
                const float step[3] = { strand_random( row, lane, 0, -2e-3f, 2e-3f ),
                                        strand_random( row, lane, 1, -2e-3f, 2e-3f ), 4.5e-3f };
                for ( int k = 0; k < 3; ++k )
                {
                    s->position[row][k][lane] = s->count[g][lane] > 0 ? at[k] : 0.0f;
                    s->root[g][k][lane] =
                        i == 0 ? at[k] + strand_random( row, lane, 2 + k, 0.0f, 1e-3f ) : s->root[g][k][lane];
                    s->velocity[row][k][lane] =
                        left >= 0 && i > 0 ? strand_random( row, lane, 5 + k, -1.0f, 1.0f ) : 0.0f;
                    at[k] += left > 0 ? step[k] : 0.0f;
                }
                s->weight[row][lane] = i > 0 && left >= 0 ? strand_random( row, lane, 8, 1e7f, 3e7f ) : 0.0f;
                s->length[row][lane] = left > 0 ? strand_random( row, lane, 9, 4e-3f, 6e-3f ) : 0.0f;
                s->inverse_length[row][lane] = left > 0 ? 1.0f / s->length[row][lane] : 0.0f;
                s->rest2[row][lane] = left > 1 ? strand_random( row, lane, 10, 8e-3f, 1.1e-2f ) : -1.0f;
                s->lambda[row][lane] = strand_random( row, lane, 11, -1e-9f, 1e-9f );
                s->tension[row][lane] = left > 0 ? strand_random( row, lane, 12, -1e-5f, 1e-4f ) : 0.0f;
                s->max_tension[row][lane] = 6e-5f;
                s->stiffness[row][lane] = left > 0 ? strand_random( row, lane, 13, 1e-6f, 3e-6f ) : 0.0f;
                s->twist_stiffness[row][lane] = left > 0 ? 0.7f * s->stiffness[row][lane] : 0.0f;
                s->factor[row][0][lane] = 0.1f * s->weight[row][lane];
                s->factor[row][1][lane] = left >= 0 && i > 1 ? strand_random( row, lane, 14, -0.5f, 0.1f ) : 0.0f;
                s->factor[row][2][lane] = left >= 0 && i > 2 ? strand_random( row, lane, 15, 0.0f, 0.2f ) : 0.0f;
                strand_frame( s->frame[row], lane, step );
                s->rest_twist[row][0][lane] = 0.8f;
                s->rest_twist[row][1][lane] = 0.6f;
                for ( int k = 0; k < 2; ++k )
                {
                    s->rest[row][k][lane] = left > 0 ? strand_random( row, lane, 16 + k, -0.3f, 0.3f ) : 0.0f;
                }
            }
        }
    }
    find_start( s );
}

// What BDF2 looks back on after a substep of 1/600 s: of half of the strands nothing, or what was lost.
static void make_history( strands_state* s )
{
    s->has_history = true;
    for ( int i = 0; i < STRAND_ROWS * 48; ++i )
    {
        const int row = i / 48, k = i / 16 % 3, lane = i % 16;
        const float v = s->velocity[row][k][lane];
        s->before[row][k][lane] = 0.9f * v;
        s->displacement[row][k][lane] = s->weight[row][lane] > 0.0f ? v / 600.0f : 0.0f;
        s->step[row][lane] = lane % 4 == 3 ? -1.0f : lane % 4 == 2 ? 0.0f : 1.0f / 600.0f;
        s->first_order_factor[row][k][lane] = 1.1f * s->factor[row][k][lane];
    }
}

static wisp_strand_history history_of( strands_state* s )
{
    return s->has_history ? ( wisp_strand_history ){ s->displacement[0][0], s->before[0][0], s->step[0] }
                          : ( wisp_strand_history ){ .step = NULL };
}

static const float DT = 1.0f / 600.0f;

// Members that arguments of strands have in common.
#define LANES_OF( s )                                                                                                \
    .group_row = ( s )->group_row, .position = ( s )->position[0][0], .velocity = ( s )->velocity[0][0],             \
    .inverse_mass = ( s )->weight[0], .dt = DT, .history = history_of( s )
#define MOTION_OF( s )                                                                                               \
    LANES_OF( s ), .previous = ( s )->previous[0][0], .low = ( s )->low[0][0], .segment = ( s )->segment[0][0]

static wisp_strand_motion_args motion_args( strands_state* s )
{
    return ( wisp_strand_motion_args ){ MOTION_OF( s ),
                                        .speed = s->speed[0],
                                        .root = s->root[0][0],
                                        .root_low = s->root_low[0][0],
                                        .acceleration = { 0.5f, -9.81f, 0.25f },
                                        .acceleration_scale = s->fraction[0] };
}

static wisp_strand_stretch_args stretch_args( strands_state* s, int passes )
{
    return ( wisp_strand_stretch_args ){ MOTION_OF( s ),           .length = s->length[0],
                                         .tension = s->tension[0], .accumulates_tension = true,
                                         .iterations = passes,     .tolerance = 1e-3f,
                                         .speed = s->speed[0],     .scratch = s->scratch };
}

static wisp_strand_link_args strand_links( strands_state* s, int stride, bool pbd )
{
    return ( wisp_strand_link_args ){ MOTION_OF( s ),
                                      .rest = stride == 1 ? s->length[0] : s->rest2[0],
                                      .lambda = pbd ? NULL : s->lambda[0],
                                      .stride = stride,
                                      .stiffness = 0.7f,
                                      .compliance = 1e-3f,
                                      .inverse_dt2 = pbd ? 0.0f : 1e4f };
}

static wisp_strand_rod_args rod_args( strands_state* s, bool curved, float damping )
{
    return ( wisp_strand_rod_args ){ MOTION_OF( s ),
                                     .inverse_length = s->inverse_length[0],
                                     .stiffness = s->stiffness[0],
                                     .factor = s->factor[0][0],
                                     .tension = s->tension[0],
                                     .max_tension = s->max_tension[0],
                                     .acceleration = { 0.5f, -9.81f, 0.25f },
                                     .acceleration_scale = s->fraction[0],
                                     .root = s->turn[0][0],
                                     .clamp = s->clamp[0][0],
                                     .frame = curved ? s->frame[0][0] : NULL,
                                     .rest = s->rest[0][0],
                                     .rest_twist = s->rest_twist[0][0],
                                     .twist_stiffness = s->twist_stiffness[0],
                                     .damping = damping,
                                     .scratch = s->scratch,
                                     .first_order_factor = s->first_order_factor[0][0] };
}

static wisp_strand_air_args air_args( strands_state* s, wisp_vec3 wind )
{
    return ( wisp_strand_air_args ){ LANES_OF( s ), .length = s->length[0], .wind = wind, .drag = 4e-5f };
}

// ---- the same bits ----

static void a_substep( const wisp_kernels* k, strands_state* s, int begin, int end )
{
    const wisp_strand_motion_args motion = motion_args( s );
    const wisp_strand_damp_args damp = { LANES_OF( s ), .rate = 66.0f, .linear = { 1, 2, 3 },
                                         .angular = { 0.5f, -1.0f, 2.0f }, .centre = { 0.1f, 0, 0 } };
    const wisp_strand_air_args air = air_args( s, ( wisp_vec3 ){ 3, 0, 1 } );
    if ( s->has_history )
    {
        k->strand_extrapolate( &motion, begin, end );
    }
    k->strand_damp( &damp, begin, end );
    k->strand_air( &air, begin, end );
    k->strand_predict( &motion, begin, end );
    if ( s->kind == 0 || s->kind == 1 )
    {
        const wisp_strand_rod_args rod = rod_args( s, s->kind == 1, s->kind == 1 ? 0.01f : 0.0f );
        k->strand_rod( &rod, begin, end );
    }
    for ( int stride = 2; stride > 0 && s->kind == 2; --stride )
    {
        const wisp_strand_link_args pbd = strand_links( s, stride, true ), xpbd = strand_links( s, stride, false );
        k->strand_link( &pbd, begin, end );
        k->strand_link( &xpbd, begin, end );
    }
    const wisp_strand_stretch_args stretch = stretch_args( s, s->kind == 3 ? 3 : 2 );
    k->strand_stretch( &stretch, begin, end );
    k->strand_velocity( &motion, begin, end );
}

// 4 to 6 are 0 to 2 with history.
static void fill_strands( void* state, int variant )
{
    strands_state* s = state;
    make_strands( s );
    s->kind = variant % 4;
    if ( variant >= 4 )
    {
        make_history( s );
    }
}

static void three_substeps( const wisp_kernels* kernels, void* state, int begin, int end )
{
    strands_state* s = state;
    for ( int step = 0; step < 3; ++step )
    {
        a_substep( kernels, s, begin, end );
    }
    memset( s->scratch, 0, sizeof( s->scratch ) );
}

TEST_KERNEL( ranges_of_groups_move_to_the_same_bits_however_they_are_cut, strands_state, 7, 0, STRAND_GROUPS, 1,
             fill_strands, three_substeps, NULL )

// ---- moving and held vertices ----

static bool is_vertex( const strands_state* s, int g, int row, int lane )
{
    return row - s->group_row[g] < s->count[g][lane];
}

static double3 vertex_at( float ( *rows )[16], int lane )
{
    return double3_make( (double)rows[0][lane], (double)rows[1][lane], (double)rows[2][lane] );
}

static double largest_error( strands_state* s )
{
    double largest = 0.0;
    for ( int g = 0; g < STRAND_GROUPS; ++g )
    {
        for ( int i = 16 * s->group_row[g]; i < 16 * ( s->group_row[g + 1] - 1 ); ++i )
        {
            const int row = i / 16, lane = i % 16;
            if ( is_vertex( s, g, row + 1, lane ) )
            {
                const double length =
                    double3_distance( vertex_at( s->position[row], lane ), vertex_at( s->position[row + 1], lane ) );
                const double error = fabs( length / (double)s->length[row][lane] - 1.0 );
                largest = error <= largest ? largest : error; // NaN too
            }
        }
    }
    return largest;
}

TEST( segments_have_their_rest_length_after_the_direct_solve )
{
    static strands_state s;
    make_strands( &s );
    assert_true( largest_error( &s ) > 0.05 );
    const wisp_strand_stretch_args args = stretch_args( &s, 8 );
    assert_int_equal( widest_table()->strand_stretch( &args, 0, STRAND_GROUPS ), 0 );
    // lengths of 5 mm at 0.3 m from the origin: rounding of a position is 6e-6 of a length
    assert_true( largest_error( &s ) < 2e-5 );
}

TEST( what_is_no_vertex_stays_with_the_tip_and_pins_stay_where_they_are )
{
    static strands_state s, before;
    make_strands( &s );
    before = s;
    const wisp_strand_stretch_args args = stretch_args( &s, 3 );
    const wisp_strand_rod_args rod = rod_args( &s, true, 0.01f );
    const wisp_strand_link_args links = strand_links( &s, 2, false );
    widest_table()->strand_rod( &rod, 0, STRAND_GROUPS );
    widest_table()->strand_link( &links, 0, STRAND_GROUPS );
    widest_table()->strand_stretch( &args, 0, STRAND_GROUPS );
    for ( int i = 0; i < STRAND_ROWS * 48; ++i )
    {
        const int row = i / 48, k = i / 16 % 3, lane = i % 16;
        assert_true( s.weight[row][lane] != 0.0f || s.position[row][k][lane] == before.position[row][k][lane] );
    }
}

TEST( strands_without_a_direction_are_laid_out_from_the_root )
{
    static strands_state s;
    make_strands( &s );
    memset( s.position, 0, sizeof( s.position ) );
    memset( s.velocity, 0, sizeof( s.velocity ) );
    find_start( &s );
    const wisp_strand_stretch_args args = stretch_args( &s, 2 );
    int strands = 0;
    for ( int i = 0; i < STRAND_GROUPS * 16; ++i )
    {
        strands += s.count[i / 16][i % 16] > 1 ? 1 : 0;
    }
    assert_int_equal( widest_table()->strand_stretch( &args, 0, STRAND_GROUPS ), strands );
    assert_true( largest_error( &s ) < 1e-6 );
    assert_true( s.position[1][1][0] < 0.0f && s.position[1][0][0] == 0.0f ); // downwards
}

TEST( what_is_laid_out_is_no_faster_than_it_was_predicted_to_be )
{
    static strands_state s;
    make_strands( &s );
    memset( s.position, 0, sizeof( s.position ) );
    find_start( &s );
    static strands_state predicted;
    predicted = s;
    const wisp_strand_stretch_args args = stretch_args( &s, 2 );
    assert_true( widest_table()->strand_stretch( &args, 0, STRAND_GROUPS ) > 0 );
    for ( int i = 0; i < STRAND_ROWS * 16; ++i )
    {
        const int row = i / 16, lane = i % 16;
        const double path =
            double3_distance( vertex_at( s.position[row], lane ), vertex_at( s.previous[row], lane ) );
        // positions of up to 0.1 m are rounded by 4e-9 m
        const double most = (double)DT * double3_length( vertex_at( predicted.velocity[row], lane ) ) + 2e-8;
        assert_true( s.weight[row][lane] == 0.0f || path <= most );
    }
}

TEST( what_is_not_finite_is_laid_out_too )
{
    static strands_state s;
    make_strands( &s );
    s.position[5][1][3] = NAN;
    s.position[6][2][7] = INFINITY;
    s.position[8][0][1] = 3e30f;
    const wisp_strand_stretch_args args = stretch_args( &s, 8 );
    assert_int_equal( widest_table()->strand_stretch( &args, 0, STRAND_GROUPS ), 3 );
    assert_true( largest_error( &s ) < 1e-2 ); // false for NaN and infinity
    assert_true( s.tension[5][3] == 0.0f );
}

TEST( air_leaves_motion_along_the_strand_alone )
{
    static strands_state s;
    make_strands( &s );
    for ( int i = 0; i < STRAND_ROWS * 48; ++i )
    {
        const int row = i / 48, k = i / 16 % 3, lane = i % 16;
        s.position[row][k][lane] = k == 1 ? 0.005f * (float)row : 0.0f;
        s.velocity[row][k][lane] = k == 1 ? 2.0f : 0.0f;
    }
    const wisp_strand_air_args air = air_args( &s, ( wisp_vec3 ){ 1, 0, 0 } );
    widest_table()->strand_air( &air, 1, 2 );
    const int row = s.group_row[1] + 4;
    assert_true( s.velocity[row][1][0] == 2.0f );
    assert_true( s.velocity[row][0][0] > 0.0f && s.velocity[row][0][0] < 1.0f );
}

TEST( damping_leaves_the_rigid_motion_alone )
{
    static strands_state s, before;
    make_strands( &s );
    for ( int i = 0; i < STRAND_ROWS * 16; ++i )
    {
        const int row = i / 16, lane = i % 16;
        s.velocity[row][0][lane] = 1.0f - 2.0f * ( s.position[row][1][lane] - 0.2f );
        s.velocity[row][1][lane] = 2.0f + 2.0f * ( s.position[row][0][lane] - 0.1f );
        s.velocity[row][2][lane] = 3.0f;
    }
    before = s;
    const wisp_strand_damp_args args = { LANES_OF( &s ), .rate = 600.0f, .linear = { 1, 2, 3 },
                                         .angular = { 0, 0, 2 }, .centre = { 0.1f, 0.2f, 0 } };
    widest_table()->strand_damp( &args, 0, STRAND_GROUPS );
    for ( int i = 0; i < STRAND_ROWS * 48; ++i )
    {
        const int row = i / 48, k = i / 16 % 3, lane = i % 16;
        assert_near( (double)s.velocity[row][k][lane], (double)before.velocity[row][k][lane], 1e-6, "velocity", i );
    }
}

TEST( roots_go_where_they_are_carried_and_their_velocity_says_so )
{
    static strands_state s;
    make_strands( &s );
    const float before = s.position[s.group_row[1]][0][2];
    const wisp_strand_motion_args args = motion_args( &s );
    widest_table()->strand_predict( &args, 0, STRAND_GROUPS );
    const int row = s.group_row[1];
    assert_true( s.position[row][0][2] == s.root[1][0][2] );
    assert_near( (double)s.velocity[row][0][2], (double)( ( s.root[1][0][2] - before ) / DT ), 1e-4, "root", 2 );
    const float v = s.velocity[row][0][2];
    widest_table()->strand_velocity( &args, 0, STRAND_GROUPS );
    assert_true( s.velocity[row][0][2] == v );
}

static void predict( const wisp_kernels* k, strands_state* s, const wisp_strand_motion_args* motion )
{
    if ( s->has_history )
    {
        k->strand_extrapolate( motion, 0, STRAND_GROUPS );
    }
    k->strand_predict( motion, 0, STRAND_GROUPS );
}

// Two predictions with lengths between them, with the end of the first substep and the begin of the second in one call or
// several.
static void two_substeps( const wisp_kernels* k, strands_state* s, bool in_one, bool is_predicted )
{
    wisp_strand_motion_args motion = motion_args( s );
    wisp_strand_stretch_args stretch = stretch_args( s, 2 );
    motion.previous = stretch.previous = is_predicted ? motion.previous : NULL;
    predict( k, s, &motion );
    k->strand_stretch( &stretch, 0, STRAND_GROUPS );
    if ( in_one )
    {
        k->strand_advance( &motion, 0, STRAND_GROUPS );
        return;
    }
    k->strand_velocity( &motion, 0, STRAND_GROUPS );
    predict( k, s, &motion );
}

TEST( advancing_is_taking_velocities_and_predicting )
{
    static strands_state one, two;
    for ( int n = 0; n < 4; ++n )
    {
        for ( const wisp_kernels* const* t = every_table(); *t != NULL; ++t )
        {
            fill_strands( &one, n % 2 * 4 );
            fill_strands( &two, n % 2 * 4 );
            two_substeps( *t, &one, false, n > 1 );
            two_substeps( *t, &two, true, n > 1 );
            assert_memory_equal( &one, &two, sizeof( one ) );
        }
    }
}

TEST( the_first_row_beyond_the_bound_is_found )
{
    static const float WRONG[] = { NAN, INFINITY, -INFINITY, 10.1f, -10.1f };
    static strands_state s;
    make_strands( &s );
    const wisp_strand_bound_args args = { s.position[0][0], s.velocity[0][0], 10.0f };
    for ( const wisp_kernels* const* t = every_table(); *t != NULL; ++t )
    {
        assert_int_equal( ( *t )->strand_find_out_of_bounds( &args, 0, STRAND_ROWS ), STRAND_ROWS );
        for ( int i = 0; i < STRAND_ROWS * 96; ++i )
        {
            const int row = i / 96, k = i / 16 % 3, lane = i % 16;
            float* number = i / 48 % 2 == 0 ? &s.position[row][k][lane] : &s.velocity[row][k][lane];
            const float kept = *number;
            *number = WRONG[i % WISP_COUNT( WRONG )];
            assert_int_equal( ( *t )->strand_find_out_of_bounds( &args, 0, STRAND_ROWS ), row );
            assert_int_equal( ( *t )->strand_find_out_of_bounds( &args, 0, row ), row );
            assert_int_equal( ( *t )->strand_find_out_of_bounds( &args, row + 1, STRAND_ROWS ), STRAND_ROWS );
            *number = kept;
        }
    }
}

// ---- ghosts ----

enum
{
    NODES = 64,
    STRIDE = 12,
    LANES = WISP_LANES,
};

// One group of sixteen targets, and its table.
typedef struct table_state
{
    _Alignas( 64 ) float position[NODES][3][LANES];
    _Alignas( 64 ) float velocity[NODES][3][LANES];
    _Alignas( 64 ) float before[NODES][3][LANES];
    _Alignas( 64 ) float cap[NODES][LANES];
    _Alignas( 64 ) float reach[NODES][LANES];
    _Alignas( 64 ) float table[LANES * NODES * STRIDE];
    _Alignas( 64 ) int32_t lane_count[LANES];
    _Alignas( 64 ) int32_t lane_node[LANES];
    int32_t group_row[2];
} table_state;

// Velocities that are multiples of those before: 0.1 .. 10 times as large, or reversed.
static void make_state( table_state* s, float direction )
{
    memset( s, 0, sizeof( *s ) );
    s->group_row[1] = NODES;
    for ( int lane = 0; lane < LANES; ++lane )
    {
        s->lane_count[lane] = NODES;
        s->lane_node[lane] = lane * NODES * STRIDE;
    }
    for ( int n = 0; n < NODES * LANES; ++n )
    {
        const int i = n / LANES, lane = n % LANES;
        const float scale = direction * test_random_float( n, 3, 0.1f, 10.0f );
        for ( int axis = 0; axis < 3; ++axis )
        {
            s->before[i][axis][lane] = test_random_float( n, axis, -2.0f, 2.0f );
            s->velocity[i][axis][lane] = scale * s->before[i][axis][lane];
        }
        s->cap[i][lane] = 0.02f;
        s->reach[i][lane] = test_random_float( n, 4, 0.0f, 0.5f );
    }
}

static void fill( const wisp_kernels* kernels, table_state* s )
{
    const wisp_strand_target_args args = {
        .group_row = s->group_row,
        .lane_count = s->lane_count,
        .lane_node = s->lane_node,
        .position = s->position[0][0],
        .rest = s->position[0][0],
        .velocity = s->velocity[0][0],
        .previous_velocity = s->before[0][0],
        .max_sway = s->cap[0],
        .reach = s->reach[0],
        .table = s->table,
        .stride = STRIDE,
        .is_elastic = true,
        .sway_time = 0.1f,
    };
    kernels->strand_target( &args, 0, 1 );
}

static const float* node_of( const table_state* s, int lane, int i )
{
    return s->table + ( lane * NODES + i ) * STRIDE;
}

// Without its clamp the cosine of parallel velocities is 1 + 1e-7 as often as not, and the weight leaves [0, 1].
TEST( the_elastic_weight_of_parallel_velocities_stays_between_0_and_1 )
{
    static table_state s;
    for ( const wisp_kernels* const* t = every_table(); *t != NULL; ++t )
    {
        for ( int is_reversed = 0; is_reversed < 2; ++is_reversed )
        {
            make_state( &s, is_reversed ? -1.0f : 1.0f );
            fill( *t, &s );
            for ( int k = LANES; k < NODES * LANES; ++k )
            {
                const float weight = node_of( &s, k % LANES, k / LANES )[3];
                assert_true( weight >= 0.0f && weight <= 1.0f );
                assert_near( (double)weight, is_reversed, 4e-7, "weight of node", k );
            }
        }
    }
}

// The farthest ghost of a node sways by a segment where it would sway farther; where it would not, no bit changes.
TEST( the_factor_of_a_group_takes_its_farthest_ghost_to_the_limit )
{
    static table_state capped, free;
    for ( const wisp_kernels* const* t = every_table(); *t != NULL; ++t )
    {
        int cut = 0, kept = 0;
        make_state( &capped, -1.0f );
        for ( int n = 0; n < NODES * LANES; ++n )
        {
            // half of the nodes are slow enough
            for ( int axis = 0; axis < 3 && n % 2 == 0; ++axis )
            {
                capped.velocity[n / LANES][axis][n % LANES] *= 1e-3f;
            }
        }
        free = capped;
        for ( int n = 0; n < NODES * LANES; ++n )
        {
            free.cap[n / LANES][n % LANES] = 1e6f;
        }
        fill( *t, &capped );
        fill( *t, &free );
        for ( int n = LANES; n < NODES * LANES; ++n )
        {
            const float *a = node_of( &capped, n % LANES, n / LANES ), *b = node_of( &free, n % LANES, n / LANES );
            const double reach = (double)b[3] + (double)capped.reach[n / LANES][n % LANES];
            const double free_sway = double3_length( double3_from( b + 4 ) ) * reach,
                         sway = double3_length( double3_from( a + 4 ) ) * reach;
            assert_true( a[3] == b[3] );
            if ( free_sway < 0.0199 )
            {
                assert_memory_equal( a + 4, b + 4, 3 * sizeof( float ) );
                kept += 1;
            }
            else if ( free_sway > 0.0201 )
            {
                assert_near( sway, 0.02, 1e-8, "sway of node", n );
                cut += 1;
            }
        }
        assert_true( cut > 100 && kept > 100 );
    }
}
