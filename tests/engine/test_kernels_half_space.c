// Half spaces with friction: the kernel against scalar code for one particle, bit for bit, in every table.
#include "kernels_fixture.h"

enum
{
    PARTICLES = 72,
    SWEEPS = 3,
};

typedef struct half_spaces
{
    _Alignas( 64 ) float position[PARTICLES][4];
    float previous[PARTICLES][4];
    float rows[PARTICLES][3][16]; // each particle has the middle one of three rows
    int32_t particle_x4[PARTICLES], row16[PARTICLES];
} half_spaces;

enum
{
    POINT = 0,
    NORMAL = 3,
    MOTION = 6,
    GAP = 9,
    PUSHED = 10,
    RUBBED = 11,
    STATIC = 14,
    KINETIC = 15,
};

// Particles a few thicknesses to both sides of their planes; every fifth is exactly at the gap and at rest. Half of
// the sums have values that a previous iteration may have left.
static void make_rows( half_spaces* h )
{
    memset( h, 0, sizeof( *h ) );
    for ( int i = 0; i < PARTICLES; ++i )
    {
        float* row = h->rows[i][1];
        const bool at_rest = i % 5 == 0, fresh = i % 2 == 0;
        float n[3], squared = 0.0f;
        for ( int k = 0; k < 3; ++k )
        {
            n[k] = at_rest ? ( k == 1 ? 1.0f : 0.0f ) : test_random_float( i, k, -1.0f, 1.0f );
            squared += n[k] * n[k];
        }
        const float height = at_rest ? 0.25f : test_random_float( i, 3, 0.0f, 0.5f ), length = sqrtf( squared );
        for ( int k = 0; k < 3; ++k )
        {
            row[POINT + k] = at_rest ? 0.0f : test_random_float( i, 4 + k, -1.0f, 1.0f );
            row[NORMAL + k] = n[k] / length;
            row[MOTION + k] = at_rest ? 0.0f : test_random_float( i, 8 + k, -0.05f, 0.05f );
            row[RUBBED + k] = fresh ? 0.0f : test_random_float( i, 12 + k, -0.05f, 0.05f );
            h->position[i][k] = row[POINT + k] + height * row[NORMAL + k];
            h->previous[i][k] = h->position[i][k] - ( at_rest ? 0.0f : test_random_float( i, 16 + k, -0.1f, 0.1f ) );
        }
        row[GAP] = 0.25f;
        row[PUSHED] = fresh ? 0.0f : test_random_float( i, 20, 0.0f, 0.1f );
        row[STATIC] = test_random_float( i, 21, 0.0f, 1.0f );
        row[KINETIC] = 0.5f * row[STATIC];
        h->position[i][3] = 1.0f + (float)i;
        h->particle_x4[i] = 4 * ( ( i + 5 ) % PARTICLES );
        h->row16[i] = 16 * ( 3 * ( ( i + 5 ) % PARTICLES ) + 1 );
    }
}

static wisp_half_space_args job_on( half_spaces* h )
{
    return ( wisp_half_space_args ){ h->position[0], h->previous[0], h->rows[0][0], h->particle_x4, h->row16 };
}

static float dot( const float a[3], const float b[3] )
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// @return whether it sticks
static bool push_one( float p[4], const float previous[4], float row[16] )
{
    const float* n = row + NORMAL;
    const float d[3] = { p[0] - row[POINT], p[1] - row[POINT + 1], p[2] - row[POINT + 2] };
    const float sum = row[PUSHED] + ( row[GAP] - dot( n, d ) ), pushed = sum > 0.0f ? sum : 0.0f;
    float u[3];
    for ( int k = 0; k < 3; ++k )
    {
        p[k] += ( pushed - row[PUSHED] ) * n[k];
        u[k] = p[k] - previous[k] - row[MOTION + k];
    }
    row[PUSHED] = pushed;
    const float up = dot( n, u );
    for ( int k = 0; k < 3; ++k )
    {
        u[k] = u[k] - up * n[k] - row[RUBBED + k];
    }
    const float length = sqrtf( dot( u, u ) );
    const bool sticks = length <= row[STATIC] * pushed;
    const float fraction = sticks ? 1.0f : row[KINETIC] * pushed / length;
    for ( int k = 0; k < 3; ++k )
    {
        const float now = -fraction * u[k];
        p[k] += now - row[RUBBED + k];
        row[RUBBED + k] = now;
    }
    return sticks;
}

TEST( every_table_pushes_and_rubs_as_one_by_one )
{
    static half_spaces expected, found;
    int sticking = 0, sliding = 0, free = 0;
    make_rows( &expected );
    for ( int s = 0; s < SWEEPS; ++s )
    {
        for ( int i = 0; i < PARTICLES; ++i )
        {
            const bool sticks = push_one( expected.position[i], expected.previous[i], expected.rows[i][1] );
            const bool pushed = expected.rows[i][1][PUSHED] > 0.0f;
            sticking += pushed && sticks ? 1 : 0;
            sliding += pushed && sticks == false ? 1 : 0;
            free += pushed ? 0 : 1;
        }
    }
    assert_true( sticking > 10 && sliding > 10 && free > 10 );
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int t = 0; t < count; ++t )
    {
        make_rows( &found );
        const wisp_half_space_args args = job_on( &found );
        for ( int s = 0; s < SWEEPS; ++s )
        {
            tables[t]->half_space( &args, 0, PARTICLES );
        }
        assert_memory_equal( &found, &expected, sizeof( found ) );
    }
}

TEST( a_group_that_is_filled_up_moves_each_particle_once )
{
    static half_spaces expected, found;
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int t = 0; t < count; ++t )
    {
        make_rows( &expected );
        make_rows( &found );
        for ( int k = 0; k < 8; ++k )
        {
            const int i = k < 3 ? k : 2;
            found.particle_x4[k] = expected.particle_x4[k] = 4 * i;
            found.row16[k] = expected.row16[k] = 16 * ( 3 * i + 1 );
        }
        for ( int i = 0; i < 3; ++i )
        {
            push_one( expected.position[i], expected.previous[i], expected.rows[i][1] );
        }
        const wisp_half_space_args args = job_on( &found );
        tables[t]->half_space( &args, 0, 8 );
        assert_memory_equal( &found, &expected, sizeof( found ) );
    }
}
