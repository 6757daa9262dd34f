// Kernels over groups of strands: every instruction set gives the same bits, lanes are independent, and properties of
// each kernel for a single strand. tests/modules compares them with the oracle in double precision.
#include "strands_state.h"

static const float DT = 1.0f / 600.0f;

// ---- the same bits ----

static void a_substep( const wisp_kernels* k, strands_state* s, int kind )
{
    const wisp_strand_motion_args motion = motion_args( s, DT );
    const wisp_strand_damp_args damp = { .group_row = s->group_row,
                                         .position = s->position[0][0],
                                         .velocity = s->velocity[0][0],
                                         .inverse_mass = s->weight[0],
                                         .rate = 66.0f,
                                         .linear = { 1, 2, 3 },
                                         .angular = { 0.5f, -1.0f, 2.0f },
                                         .centre = { 0.1f, 0, 0 },
                                         .dt = DT,
                                         .history = history_of( s ) };
    const wisp_strand_air_args air = { .group_row = s->group_row,
                                       .position = s->position[0][0],
                                       .velocity = s->velocity[0][0],
                                       .inverse_mass = s->weight[0],
                                       .length = s->length[0],
                                       .wind = { 3, 0, 1 },
                                       .drag = 4e-5f,
                                       .dt = DT,
                                       .history = history_of( s ) };
    if ( s->has_history )
    {
        k->strand_extrapolate( &motion, 0, STRAND_GROUPS );
    }
    k->strand_damp( &damp, 0, STRAND_GROUPS );
    k->strand_air( &air, 0, STRAND_GROUPS );
    k->strand_predict( &motion, 0, STRAND_GROUPS );
    if ( kind == 0 || kind == 1 )
    {
        const wisp_strand_rod_args rod = rod_args( s, DT, kind == 1, kind == 1 ? 0.01f : 0.0f );
        k->strand_rod( &rod, 0, STRAND_GROUPS );
    }
    for ( int stride = 2; stride > 0 && kind == 2; --stride )
    {
        const wisp_strand_link_args pbd = strand_links( s, stride, true ), xpbd = strand_links( s, stride, false );
        k->strand_link( &pbd, 0, STRAND_GROUPS );
        k->strand_link( &xpbd, 0, STRAND_GROUPS );
    }
    const wisp_strand_stretch_args stretch = stretch_args( s, DT, 2 );
    k->strand_stretch( &stretch, 0, STRAND_GROUPS );
    k->strand_velocity( &motion, 0, STRAND_GROUPS );
}

TEST( every_instruction_set_moves_strands_to_the_same_bits )
{
    static strands_state first, other;
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int n = 0; n < 7; ++n )
    {
        const int kind = n % 4; // 4 to 6 are 0 to 2 with history
        for ( int t = 0; t < count; ++t )
        {
            strands_state* s = t == 0 ? &first : &other;
            make_strands( s );
            if ( n >= 4 )
            {
                make_history( s );
            }
            for ( int step = 0; step < 3; ++step )
            {
                a_substep( tables[t], s, kind );
            }
            memset( s->scratch, 0, sizeof( s->scratch ) );
            if ( memcmp( &first, s, sizeof( first ) ) != 0 )
            {
                fail_msg( "kind %d, history %d: %s and %s differ", kind, n >= 4, tables[0]->isa, tables[t]->isa );
            }
        }
    }
}

TEST( ranges_of_groups_may_be_cut_anywhere )
{
    static strands_state whole, cut;
    const wisp_kernels* k = widest_table();
    make_strands( &whole );
    make_strands( &cut );
    const wisp_strand_rod_args rod = rod_args( &whole, DT, true, 0.0f ), rod_cut = rod_args( &cut, DT, true, 0.0f );
    const wisp_strand_stretch_args stretch = stretch_args( &whole, DT, 3 ), stretch_cut = stretch_args( &cut, DT, 3 );
    const wisp_strand_link_args links = strand_links( &whole, 2, false ), links_cut = strand_links( &cut, 2, false );
    const wisp_strand_link_args sweep = strand_links( &whole, 1, true ), sweep_cut = strand_links( &cut, 1, true );
    k->strand_rod( &rod, 0, STRAND_GROUPS );
    k->strand_link( &links, 0, STRAND_GROUPS );
    k->strand_link( &sweep, 0, STRAND_GROUPS );
    k->strand_stretch( &stretch, 0, STRAND_GROUPS );
    for ( int g = STRAND_GROUPS - 1; g >= 0; --g )
    {
        k->strand_rod( &rod_cut, g, g + 1 );
        k->strand_link( &links_cut, g, g + 1 );
        k->strand_link( &sweep_cut, g, g + 1 );
        k->strand_stretch( &stretch_cut, g, g + 1 );
    }
    assert_memory_equal( whole.position, cut.position, sizeof( whole.position ) );
    assert_memory_equal( whole.frame, cut.frame, sizeof( whole.frame ) );
    assert_memory_equal( whole.lambda, cut.lambda, sizeof( whole.lambda ) );
    assert_memory_equal( whole.tension, cut.tension, sizeof( whole.tension ) );
}

// ---- moving and held vertices ----

static bool is_vertex( const strands_state* s, int g, int row, int lane )
{
    return row - s->group_row[g] < s->count[g][lane];
}

static double segment_error( const strands_state* s, int row, int lane )
{
    double squared = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        const double e = (double)s->position[row + 1][k][lane] - (double)s->position[row][k][lane];
        squared += e * e;
    }
    return fabs( sqrt( squared ) / (double)s->length[row][lane] - 1.0 );
}

static double largest_error( const strands_state* s )
{
    double largest = 0.0;
    for ( int g = 0; g < STRAND_GROUPS; ++g )
    {
        for ( int row = s->group_row[g]; row + 1 < s->group_row[g + 1]; ++row )
        {
            for ( int lane = 0; lane < 16; ++lane )
            {
                if ( is_vertex( s, g, row + 1, lane ) )
                {
                    const double error = segment_error( s, row, lane );
                    largest = error <= largest ? largest : error;
                }
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
    const wisp_strand_stretch_args args = stretch_args( &s, DT, 8 );
    assert_int_equal( widest_table()->strand_stretch( &args, 0, STRAND_GROUPS ), 0 );
    // lengths of 5 mm at 0.3 m from the origin: rounding of a position is 6e-6 of a length
    assert_true( largest_error( &s ) < 2e-5 );
}

TEST( what_is_no_vertex_stays_with_the_tip_and_pins_stay_where_they_are )
{
    static strands_state s, before;
    make_strands( &s );
    before = s;
    const wisp_strand_stretch_args args = stretch_args( &s, DT, 3 );
    const wisp_strand_rod_args rod = rod_args( &s, DT, true, 0.01f );
    const wisp_strand_link_args links = strand_links( &s, 2, false );
    widest_table()->strand_rod( &rod, 0, STRAND_GROUPS );
    widest_table()->strand_link( &links, 0, STRAND_GROUPS );
    widest_table()->strand_stretch( &args, 0, STRAND_GROUPS );
    for ( int row = 0; row < STRAND_ROWS; ++row )
    {
        for ( int lane = 0; lane < 16; ++lane )
        {
            for ( int k = 0; k < 3 && s.weight[row][lane] == 0.0f; ++k )
            {
                assert_true( s.position[row][k][lane] == before.position[row][k][lane] );
            }
        }
    }
}

TEST( strands_without_a_direction_are_laid_out_from_the_root )
{
    static strands_state s;
    make_strands( &s );
    memset( s.position, 0, sizeof( s.position ) );
    memset( s.velocity, 0, sizeof( s.velocity ) );
    find_start( &s );
    const wisp_strand_stretch_args args = stretch_args( &s, DT, 2 );
    int strands = 0;
    for ( int g = 0; g < STRAND_GROUPS; ++g )
    {
        for ( int lane = 0; lane < 16; ++lane )
        {
            strands += s.count[g][lane] > 1 ? 1 : 0;
        }
    }
    assert_int_equal( widest_table()->strand_stretch( &args, 0, STRAND_GROUPS ), strands );
    assert_true( largest_error( &s ) < 1e-6 );
    assert_true( s.position[1][1][0] < 0.0f && s.position[1][0][0] == 0.0f ); // downwards
}

static double squared_of( float ( *p )[16], float ( *q )[16], int lane )
{
    double sum = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        const double d = (double)p[k][lane] - ( q != NULL ? (double)q[k][lane] : 0.0 );
        sum += d * d;
    }
    return sum;
}

TEST( what_is_laid_out_is_no_faster_than_it_was_predicted_to_be )
{
    static strands_state s;
    make_strands( &s );
    memset( s.position, 0, sizeof( s.position ) );
    find_start( &s );
    static strands_state predicted;
    predicted = s;
    const wisp_strand_stretch_args args = stretch_args( &s, DT, 2 );
    assert_true( widest_table()->strand_stretch( &args, 0, STRAND_GROUPS ) > 0 );
    for ( int i = 0; i < STRAND_ROWS * 16; ++i )
    {
        const int row = i / 16, lane = i % 16;
        const double way = sqrt( squared_of( s.position[row], s.previous[row], lane ) );
        // positions of up to 0.1 m are rounded by 4e-9 m
        if ( s.weight[row][lane] > 0.0f &&
             !( way <= (double)DT * sqrt( squared_of( predicted.velocity[row], NULL, lane ) ) + 2e-8 ) )
        {
            fail_msg( "row %d, lane %d goes %g m", row, lane, way );
        }
    }
}

TEST( what_is_not_finite_is_laid_out_too )
{
    static strands_state s;
    make_strands( &s );
    s.position[5][1][3] = NAN;
    s.position[6][2][7] = INFINITY;
    s.position[8][0][1] = 3e30f;
    const wisp_strand_stretch_args args = stretch_args( &s, DT, 8 );
    assert_int_equal( widest_table()->strand_stretch( &args, 0, STRAND_GROUPS ), 3 );
    assert_true( largest_error( &s ) < 1e-2 ); // false for NaN and infinity
    assert_true( s.tension[5][3] == 0.0f );
}

TEST( air_leaves_motion_along_the_strand_alone )
{
    static strands_state s;
    make_strands( &s );
    for ( int row = 0; row < STRAND_ROWS; ++row )
    {
        for ( int lane = 0; lane < 16; ++lane )
        {
            const float at[3] = { 0.0f, 0.005f * (float)row, 0.0f }, v[3] = { 0.0f, 2.0f, 0.0f };
            for ( int k = 0; k < 3; ++k )
            {
                s.position[row][k][lane] = at[k];
                s.velocity[row][k][lane] = v[k];
            }
        }
    }
    const wisp_strand_air_args air = { .group_row = s.group_row,
                                       .position = s.position[0][0],
                                       .velocity = s.velocity[0][0],
                                       .inverse_mass = s.weight[0],
                                       .length = s.length[0],
                                       .wind = { 1, 0, 0 },
                                       .drag = 4e-5f,
                                       .dt = DT };
    widest_table()->strand_air( &air, 1, 2 );
    const int row = s.group_row[1] + 4;
    assert_true( s.velocity[row][1][0] == 2.0f );
    assert_true( s.velocity[row][0][0] > 0.0f && s.velocity[row][0][0] < 1.0f );
}

TEST( damping_leaves_the_rigid_motion_alone )
{
    static strands_state s, before;
    make_strands( &s );
    const float linear[3] = { 1.0f, 2.0f, 3.0f };
    for ( int row = 0; row < STRAND_ROWS; ++row )
    {
        for ( int lane = 0; lane < 16; ++lane )
        {
            const float x = s.position[row][0][lane], y = s.position[row][1][lane];
            s.velocity[row][0][lane] = linear[0] - 2.0f * y;
            s.velocity[row][1][lane] = linear[1] + 2.0f * x;
            s.velocity[row][2][lane] = linear[2];
        }
    }
    before = s;
    const wisp_strand_damp_args args = { .group_row = s.group_row,
                                         .position = s.position[0][0],
                                         .velocity = s.velocity[0][0],
                                         .inverse_mass = s.weight[0],
                                         .rate = 600.0f,
                                         .linear = { 1, 2, 3 },
                                         .angular = { 0, 0, 2 },
                                         .dt = DT };
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
    const wisp_strand_motion_args args = motion_args( &s, DT );
    widest_table()->strand_predict( &args, 0, STRAND_GROUPS );
    const int row = s.group_row[1];
    assert_true( s.position[row][0][2] == s.root[1][0][2] );
    assert_near( (double)s.velocity[row][0][2], (double)( ( s.root[1][0][2] - before ) / DT ), 1e-4, "root", 2 );
    const float v = s.velocity[row][0][2];
    widest_table()->strand_velocity( &args, 0, STRAND_GROUPS );
    assert_true( s.velocity[row][0][2] == v );
}

// Two substeps of prediction and lengths, with the end of the first and the begin of the second in one call or several.
static void two_substeps( const wisp_kernels* k, strands_state* s, bool in_one, bool is_predicted )
{
    wisp_strand_motion_args motion = motion_args( s, DT );
    wisp_strand_stretch_args stretch = stretch_args( s, DT, 2 );
    if ( is_predicted == false )
    {
        motion.previous = stretch.previous = NULL;
    }
    if ( s->has_history )
    {
        k->strand_extrapolate( &motion, 0, STRAND_GROUPS );
    }
    k->strand_predict( &motion, 0, STRAND_GROUPS );
    k->strand_stretch( &stretch, 0, STRAND_GROUPS );
    if ( in_one )
    {
        k->strand_advance( &motion, 0, STRAND_GROUPS );
        return;
    }
    k->strand_velocity( &motion, 0, STRAND_GROUPS );
    if ( s->has_history )
    {
        k->strand_extrapolate( &motion, 0, STRAND_GROUPS );
    }
    k->strand_predict( &motion, 0, STRAND_GROUPS );
}

TEST( advancing_is_taking_velocities_and_predicting )
{
    static strands_state one, two;
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int n = 0; n < 4 * count; ++n )
    {
        strands_state* const s[2] = { &one, &two };
        for ( int k = 0; k < 2; ++k )
        {
            make_strands( s[k] );
            if ( n % 2 == 1 )
            {
                make_history( s[k] );
            }
            two_substeps( tables[n / 4], s[k], k == 1, n / 2 % 2 == 1 );
        }
        assert_memory_equal( &one, &two, sizeof( one ) );
    }
}

TEST( the_first_row_beyond_the_bound_is_found )
{
    static const float WRONG[] = { NAN, INFINITY, -INFINITY, 10.1f, -10.1f };
    static strands_state s;
    make_strands( &s );
    const wisp_strand_bound_args args = { s.position[0][0], s.velocity[0][0], 10.0f };
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int t = 0; t < count; ++t )
    {
        assert_int_equal( tables[t]->strand_find_out_of_bounds( &args, 0, STRAND_ROWS ), STRAND_ROWS );
        for ( int i = 0; i < STRAND_ROWS * 96; ++i )
        {
            const int row = i / 96, k = i / 16 % 3, lane = i % 16;
            float* number = i / 48 % 2 == 0 ? &s.position[row][k][lane] : &s.velocity[row][k][lane];
            const float kept = *number;
            *number = WRONG[i % WISP_COUNT( WRONG )];
            assert_int_equal( tables[t]->strand_find_out_of_bounds( &args, 0, STRAND_ROWS ), row );
            assert_int_equal( tables[t]->strand_find_out_of_bounds( &args, 0, row ), row );
            assert_int_equal( tables[t]->strand_find_out_of_bounds( &args, row + 1, STRAND_ROWS ), STRAND_ROWS );
            *number = kept;
        }
    }
}
