// Bending of plates: the step around the stages against plain loops, moments of angles against the oracle.
#include "kernels_fixture.h"

#include "constraint_oracle.h"

enum
{
    SLICES = 13,
    BEGIN = 1, // slices outside the range must stay as they are
    END = 12,
    SLOTS = 8 * SLICES,
    NUMBERS = 4 * SLOTS,
    MAX_ENTRIES = 6 * SLICES,
};

static const float UNTOUCHED = -7.0f;

typedef struct plate
{
    float position[NUMBERS], target[NUMBERS], velocity[NUMBERS], predicted[NUMBERS], impulse[NUMBERS];
    float newer[NUMBERS], older[NUMBERS], least_height[SLOTS];
    int32_t begin[SLICES + 1], other_x4[MAX_ENTRIES][8];
    float weight[MAX_ENTRIES][8];
} plate;

static void fill_random( float* numbers, int count, int seed )
{
    for ( int i = 0; i < count; ++i )
    {
        numbers[i] = test_random_float( i, seed, -1.0f, 1.0f );
    }
}

// Every third particle is pinned, and every second one has a target. Slices have one to six entries.
static plate* new_plate( void )
{
    plate* p = calloc( 1, sizeof( plate ) );
    assert_non_null( p );
    float* const columns[] = { p->position, p->target, p->velocity, p->predicted, p->impulse, p->newer, p->older };
    for ( int i = 0; i < WISP_COUNT( columns ); ++i )
    {
        fill_random( columns[i], NUMBERS, i );
    }
    for ( int s = 0; s < SLOTS; ++s )
    {
        p->position[4 * s + 3] = s % 3 == 0 ? 0.0f : test_random_float( s, 20, 1.0f, 2.0f );
        p->target[4 * s + 3] = s % 2 == 0 ? 1.0f : 0.0f;
        p->impulse[4 * s + 3] = p->newer[4 * s + 3] = p->older[4 * s + 3] = p->velocity[4 * s + 3] = 0.0f;
        p->least_height[s] = s % 7 == 0 ? INFINITY : test_random_float( s, 21, 0.5f, 1.0f );
    }
    for ( int slice = 0; slice < SLICES; ++slice )
    {
        p->begin[slice + 1] = p->begin[slice] + 1 + slice % 6;
    }
    for ( int i = 0; i < 8 * MAX_ENTRIES; ++i )
    {
        p->other_x4[i / 8][i % 8] = 4 * (int)( test_random_float( i, 22, 0.0f, 0.999f ) * (float)SLOTS );
        p->weight[i / 8][i % 8] = test_random_float( i, 23, -1.0f, 2.0f );
    }
    return p;
}

static wisp_plate_args stage_args( plate* p )
{
    return ( wisp_plate_args ){
        .rows = { SLICES, p->begin, (const int32_t( * )[8])p->other_x4, (const float( * )[8])p->weight },
        .position = p->position,
        .impulse = p->impulse,
        .newer = p->newer,
        .older = p->older,
        .rate = 0.3f,
        .momentum = 0.7f,
        .gain = 0.9f,
    };
}

static wisp_plate_move_args move_args( plate* p, bool with_targets )
{
    return ( wisp_plate_move_args ){
        .position = p->position,
        .target = with_targets ? p->target : p->position,
        .predicted = p->predicted,
        .impulse = p->impulse,
        .velocity = p->velocity,
        .moved = p->newer,
        .least_height = p->least_height,
        .gravity = { 0.3f, -9.81f, 0.1f },
        .dt = 0.013f,
        .to_target = 0.4f,
        .scale = 0.6f,
    };
}

static void expect_predicted( plate* p, bool with_targets )
{
    const float g[3] = { 0.3f, -9.81f, 0.1f };
    for ( int i = 32 * BEGIN; i < 32 * END; ++i )
    {
        const float *x = p->position + i / 4 * 4, *t = p->target + i / 4 * 4;
        const int k = i % 4;
        float expected = x[k];
        if ( k < 3 && x[3] != 0.0f )
        {
            expected = x[k] + 0.013f * ( p->velocity[i] + 0.013f * g[k] );
        }
        else if ( k < 3 && with_targets && t[3] != 0.0f )
        {
            expected = x[k] + 0.4f * ( t[k] - x[k] );
        }
        assert_memory_equal( p->predicted + i, &expected, sizeof( float ) );
        assert_true( p->impulse[i] == 0.0f );
    }
}

TEST( particles_go_where_gravity_or_targets_lead )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int table_count = usable_tables( tables );
    for ( int n = 0; n < 2 * table_count; ++n )
    {
        plate* p = new_plate();
        p->predicted[32 * BEGIN - 1] = p->predicted[32 * END] = UNTOUCHED;
        const wisp_plate_move_args args = move_args( p, n % 2 == 0 );
        tables[n / 2]->plate_predict( &args, BEGIN, END );
        expect_predicted( p, n % 2 == 0 );
        assert_true( p->predicted[32 * BEGIN - 1] == UNTOUCHED && p->predicted[32 * END] == UNTOUCHED );
        free( p );
    }
}

TEST( stages_are_those_of_a_plain_loop )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int table_count = usable_tables( tables );
    for ( int t = 0; t < table_count; ++t )
    {
        plate *p = new_plate(), *before = new_plate(), *first = new_plate();
        const wisp_plate_args args = stage_args( p ), begun = stage_args( first );
        tables[t]->plate_stage( &args, BEGIN, END );
        tables[t]->plate_begin( &begun, BEGIN, END );
        for ( int i = 32 * BEGIN; i < 32 * END; ++i )
        {
            const int row = i / 4, k = i % 4, slice = row / 8;
            float sum = 0.0f, y = before->newer[i];
            for ( int entry = p->begin[slice]; entry < p->begin[slice + 1]; ++entry )
            {
                sum += p->weight[entry][row % 8] * ( y - before->newer[p->other_x4[entry][row % 8] + k] );
            }
            const float b = before->impulse[i] + -0.3f * sum, weight = p->position[4 * row + 3];
            y = y + 0.7f * ( y - before->older[i] );
            assert_true( p->older[i] == ( k < 3 ? y + 0.9f * weight * b : 0.0f ) );
            assert_true( first->newer[i] == 0.9f * weight * before->impulse[i] );
            assert_true( first->older[i] == 0.0f );
        }
        assert_memory_equal( first->newer, before->newer, 32 * BEGIN * sizeof( float ) );
        assert_memory_equal( first->newer + 32 * END, before->newer + 32 * END, 32 * sizeof( float ) );
        free( p );
        free( before );
        free( first );
    }
}

// What is not a number, or lies in no triangle, does not count.
TEST( moves_are_measured_and_become_velocities )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int table_count = usable_tables( tables );
    for ( int t = 0; t < table_count; ++t )
    {
        plate *p = new_plate(), *before = new_plate();
        p->newer[32 * BEGIN + 5] = NAN;
        p->newer[0] = p->newer[32 * END] = 1e6f;
        float expected = 0.0f;
        for ( int slot = 8 * BEGIN; slot < 8 * END; ++slot )
        {
            const float *y = p->newer + 4 * slot, least = p->least_height[slot];
            expected = fmaxf( expected, ( y[0] * y[0] + y[1] * y[1] + y[2] * y[2] ) / ( least * least ) );
        }
        const wisp_plate_move_args args = move_args( p, true );
        assert_true( tables[t]->plate_largest_move( &args, BEGIN, END ) == expected );
        assert_true( tables[t]->plate_largest_move( &args, BEGIN, BEGIN ) == 0.0f );
        p->newer[32 * BEGIN + 5] = 0.5f;
        tables[t]->plate_accelerate( &args, BEGIN, END );
        for ( int i = 0; i < NUMBERS; ++i )
        {
            const bool inside = i >= 32 * BEGIN && i < 32 * END;
            const float change = 0.6f * p->newer[i] / 0.013f;
            assert_true( p->velocity[i] == ( inside ? before->velocity[i] + change : before->velocity[i] ) );
        }
        free( p );
        free( before );
    }
}

// ---- moments of angles ----

enum
{
    TURN_ENTRIES = 5 * GROUPS,
};

typedef struct moments
{
    constraints* s;
    int32_t begin[GROUPS + 1], other[TURN_ENTRIES][8];
    float weight[TURN_ENTRIES][8], stiffness[CONSTRAINTS], steepest[CONSTRAINTS], angle[CONSTRAINTS];
    _Alignas( 64 ) float impulse[BODIES][4];
} moments;

// Groups have none to four entries. Every second hinge is steep: its moment gives way.
static moments* new_moments( void )
{
    moments* m = aligned_alloc( 64, ( sizeof( moments ) + 63 ) / 64 * 64 );
    constraints* s = aligned_alloc( 64, ( sizeof( constraints ) + 63 ) / 64 * 64 );
    assert_true( m != NULL && s != NULL );
    memset( m, 0, sizeof( *m ) );
    m->s = s;
    make_constraints( s, true );
    for ( int g = 0; g < GROUPS; ++g )
    {
        m->begin[g + 1] = m->begin[g] + g % 5;
    }
    for ( int i = 0; i < 8 * TURN_ENTRIES; ++i )
    {
        m->other[i / 8][i % 8] = (int)( test_random_float( i, 30, 0.0f, 0.999f ) * (float)CONSTRAINTS );
        m->weight[i / 8][i % 8] = test_random_float( i, 31, -1.0f, 2.0f );
    }
    for ( int c = 0; c < CONSTRAINTS; ++c )
    {
        m->stiffness[c] = test_random_float( c, 32, 0.5f, 2.0f );
        m->steepest[c] = c % 2 == 0 ? 1e6f : 0.5f;
    }
    fill_random( m->impulse[0], 4 * BODIES, 33 );
    return m;
}

static void free_moments( moments* m )
{
    free( m->s );
    free( m );
}

static wisp_plate_angle_args angle_args( moments* m )
{
    return ( wisp_plate_angle_args ){
        .turns = { m->begin, (const int32_t( * )[8])m->other, (const float( * )[8])m->weight, m->stiffness,
                   m->steepest, NULL },
        .slot_x4 = m->s->slot_x4[0][0],
        .rest = m->s->angle,
        .position = m->s->position[0],
        .angle = m->angle,
        .impulse = m->impulse[0],
        .rate = 0.2f,
    };
}

static void run_moments( const wisp_kernels* kernels, moments* m )
{
    const wisp_plate_angle_args args = angle_args( m );
    kernels->plate_measure_angles( &args, 0, CONSTRAINTS );
    kernels->plate_add_moments( &args, 8, CONSTRAINTS - 8 );
}

// The kernel's angle is positive where the oracle's is negative.
static void expect_moment( moments* m, const moments* before, int c )
{
    double3 p[4], gradient[4];
    double weight[4], moment = 0.0, steep = 0.0, sum = 0.0;
    for ( int k = 0; k < 4; ++k )
    {
        p[k] = double3_from( body( m->s, c, k ) );
        weight[k] = (double)body( m->s, c, k )[3];
    }
    const constraint_oracle_term term = constraint_oracle_dihedral( p, -(double)m->s->angle[c] );
    assert_near( (double)m->angle[c], -term.value, 2e-5, "angle of hinge", c );
    for ( int k = 0; k < 4; ++k )
    {
        gradient[k] = double3_scale( -1.0, term.gradient[k] );
        const double square = double3_dot( gradient[k], gradient[k] );
        sum += weight[k] * square;
        steep += k >= 2 ? square : 0.0;
    }
    for ( int entry = m->begin[c / 8]; entry < m->begin[c / 8 + 1]; ++entry )
    {
        moment -= 0.2 * (double)m->weight[entry][c % 8] * (double)m->angle[m->other[entry][c % 8]];
    }
    const double within = fmin( (double)m->steepest[c] / steep, 1.0 );
    moment /= 1.0 + 8.0 * 0.2 * (double)m->stiffness[c] * sum * ( 1.0 - within );
    for ( int k = 0; k < 4; ++k )
    {
        const int slot = m->s->slot_x4[c / 8][k][c % 8] / 4;
        const bool runs = c >= 8 && c < CONSTRAINTS - 8;
        const double3 added = double3_sub( double3_from( m->impulse[slot] ), double3_from( before->impulse[slot] ) );
        const double3 expected = double3_scale( runs ? moment : 0.0, gradient[k] );
        const double tolerance = 1e-5 * ( 1.0 + double3_length( expected ) );
        assert_near( double3_distance( added, expected ), 0.0, tolerance, "impulse of hinge", c );
        assert_true( m->impulse[slot][3] == before->impulse[slot][3] );
    }
}

TEST( moments_act_along_the_gradients_of_their_angles )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int table_count = usable_tables( tables );
    moments *before = new_moments(), *plain = new_moments();
    run_moments( &kernels_plain, plain );
    for ( int t = 0; t < table_count; ++t )
    {
        moments* m = new_moments();
        run_moments( tables[t], m );
        assert_memory_equal( m->impulse, plain->impulse, sizeof( m->impulse ) );
        for ( int c = 0; c < CONSTRAINTS; ++c )
        {
            expect_moment( m, before, c );
        }
        free_moments( m );
    }
    free_moments( before );
    free_moments( plain );
}

// Groups that share particles add up, in their order.
TEST( moments_of_shared_particles_have_the_bits_of_a_plain_table )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int table_count = usable_tables( tables );
    moments* plain = new_moments();
    tangle( plain->s );
    run_moments( &kernels_plain, plain );
    for ( int t = 0; t < table_count; ++t )
    {
        moments* m = new_moments();
        tangle( m->s );
        run_moments( tables[t], m );
        assert_memory_equal( m->impulse, plain->impulse, sizeof( m->impulse ) );
        free_moments( m );
    }
    free_moments( plain );
}
