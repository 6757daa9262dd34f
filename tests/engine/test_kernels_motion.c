// Kernels of particles one by one: motion constraints, carried particles and largest speeds, whose positions are those of
// the oracle; and particles in blocks. Every table gives the same bits as the first, or as scalar code.
#include "kernels_fixture.h"

#include "motion_oracle.h"

// ---- motion constraints, carried particles, largest speeds ----

enum
{
    MOVED_COUNT = 512,
    KINDS = 12, // what answers (pbd, hard, compliant, with multipliers), by what is behind (nothing, planes, spheres)
};

typedef struct crowd
{
    _Alignas( 64 ) float position[MOVED_COUNT][4];
    _Alignas( 64 ) float velocity[MOVED_COUNT][4], bound[MOVED_COUNT][4];
    _Alignas( 64 ) float target[3 * MOVED_COUNT], displacement[3 * MOVED_COUNT], next[3 * MOVED_COUNT];
    _Alignas( 64 ) float normal[3 * MOVED_COUNT], change[3 * MOVED_COUNT], next_normal[3 * MOVED_COUNT];
    _Alignas( 64 ) float max_distance[MOVED_COUNT],
        backstop_distance[MOVED_COUNT], curvature[MOVED_COUNT], lambda[2 * MOVED_COUNT];
} crowd;

static size_t row_of( int slot )
{
    return 24 * (size_t)( slot / 8 ) + (size_t)( slot % 8 );
}

static float pick( int i, int k, float a, float b )
{
    return test_random_float( i, k, a, b );
}

// Particles around targets at distances of the order of their limits: inside, outside, at the target, pinned, free.
static void fill( crowd* c, int kind )
{
    memset( c, 0, sizeof( *c ) );
    for ( int i = 0; i < MOVED_COUNT; ++i )
    {
        const size_t row = row_of( i );
        const float spread = i % 64 < 16 ? 0.02f : 0.3f; // some groups are well inside
        for ( int k = 0; k < 3; ++k )
        {
            c->next[row + 8 * (size_t)k] = pick( i, k, -2.0f, 2.0f );
            c->target[row + 8 * (size_t)k] = c->next[row + 8 * (size_t)k] + pick( i, 3 + k, -0.05f, 0.05f );
            c->next_normal[row + 8 * (size_t)k] = pick( i, 6 + k, -1.0f, 1.0f );
            c->normal[row + 8 * (size_t)k] = c->next_normal[row + 8 * (size_t)k] + pick( i, 9 + k, -0.1f, 0.1f );
            c->position[i][k] = c->target[row + 8 * (size_t)k] + pick( i, 12 + k, -spread, spread );
            c->velocity[i][k] = pick( i, 20 + k, -1.0f, 1.0f );
        }
        c->position[i][3] = i % 7 == 3 ? 0.0f : pick( i, 15, 0.5f, 100.0f );
        c->max_distance[i] = i % 64 < 16   ? 0.2f
                             : i % 11 == 0 ? 0.0f
                             : i % 11 == 1 ? INFINITY
                                           : pick( i, 16, 0.05f, 0.4f );
        c->backstop_distance[i] = i % 64 < 16  ? 0.3f
                                  : i % 5 == 0 ? INFINITY
                                  : i % 5 == 1 ? 0.0f
                                               : pick( i, 17, 0.0f, 0.2f );
        c->curvature[i] = kind / 4 == 2 ? 1.0f / pick( i, 18, 0.3f, 2.0f ) : 0.0f;
    }
}

static wisp_motion_constraint_args args_of( crowd* c, int kind, float left )
{
    wisp_motion_constraint_args args = {
        .position = c->position[0],
        .bound = c->bound[0],
        .target = c->target,
        .displacement = c->displacement,
        .max_distance = c->max_distance,
        .left = left,
        .distance = { kind % 4 == 0 ? 0.25f : 1.0f, kind % 4 >= 2 ? 20.0f : 0.0f },
        .backstop = { kind % 4 == 0 ? 0.5f : 1.0f, kind % 4 >= 2 ? 5.0f : 0.0f },
        .lambda = kind % 4 == 3 ? c->lambda : NULL,
    };
    if ( kind / 4 > 0 )
    {
        args.normal = c->normal;
        args.normal_change = c->change;
        args.backstop_distance = c->backstop_distance;
        args.curvature = c->curvature;
    }
    return args;
}

static void begin_step( const wisp_kernels* kernels, crowd* c, int kind )
{
    const bool behind = kind / 4 > 0;
    const wisp_motion_target_args args = {
        .target = c->target,
        .displacement = c->displacement,
        .next = c->next,
        .normal = behind ? c->normal : NULL,
        .normal_change = behind ? c->change : NULL,
        .next_normal = behind ? c->next_normal : NULL,
        .max_distance = c->max_distance,
        .backstop_distance = behind ? c->backstop_distance : NULL,
        .bound = c->bound[0],
    };
    kernels->motion_targets( &args, 0, MOVED_COUNT );
}

TEST( every_table_gives_the_same_bits_of_motion )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    static crowd found, expected;
    for ( int i = 0; i < KINDS * count; ++i )
    {
        const int kind = i % KINDS;
        const wisp_kernels* pair[2] = { tables[i / KINDS], tables[0] };
        crowd* crowds[2] = { &found, &expected };
        for ( int k = 0; k < 2; ++k )
        {
            fill( crowds[k], kind );
            begin_step( pair[k], crowds[k], kind );
            for ( int pass = 0; pass < 3; ++pass )
            {
                wisp_motion_constraint_args args = args_of( crowds[k], kind, 0.5f * (float)( 2 - pass ) );
                args.velocity = crowds[k]->velocity[0];
                args.inverse_dt = 60.0f;
                pair[k]->motion_constraint( &args, 8, MOVED_COUNT );
            }
            const wisp_carry_args carried = { { -0.02f, -0.2f, 0.1f, 0.2f, -0.03f, 0.01f, -0.1f, 0.02f, -0.01f },
                                              { 1.0f, 2.0f, 3.0f },
                                              { 0.1f, 0.0f, -0.1f } };
            pair[k]->carry_points( &carried, crowds[k]->position[0], 8, MOVED_COUNT );
            pair[k]->carry_vectors( &carried, crowds[k]->velocity[0], 8, MOVED_COUNT );
            crowds[k]->lambda[0] = (float)pair[k]->limit_speed( crowds[k]->velocity[0], 0.75f, 0, MOVED_COUNT );
        }
        assert_memory_equal( &found, &expected, sizeof( found ) );
        assert_true( found.lambda[0] > 10.0f );
    }
}

static double3 vector_at( const float* end, const float* change, int slot, double left )
{
    const size_t r = row_of( slot );
    return ( double3 ){ (double)end[r] - left * (double)change[r], (double)end[r + 8] - left * (double)change[r + 8],
                        (double)end[r + 16] - left * (double)change[r + 16] };
}

// Two iterations in the middle of a step. Groups that are well inside, and lanes that are free, keep their bits.
TEST( positions_are_those_of_the_oracle )
{
    const wisp_kernels* kernels = widest_table();
    static crowd c, start;
    for ( int kind = 0; kind < KINDS; ++kind )
    {
        fill( &c, kind );
        begin_step( kernels, &c, kind );
        start = c;
        const wisp_motion_constraint_args args = args_of( &c, kind, 0.25f );
        kernels->motion_constraint( &args, 0, MOVED_COUNT );
        kernels->motion_constraint( &args, 0, MOVED_COUNT );
        int moved = 0, kept = 0;
        for ( int i = 0; i < MOVED_COUNT; ++i )
        {
            motion_oracle m = {
                .target = vector_at( c.target, c.displacement, i, 0.25 ),
                .max_distance = (double)c.max_distance[i],
                .normal = kind / 4 > 0 ? vector_at( c.normal, c.change, i, 0.25 ) : ( double3 ){ 0.0, 0.0, 0.0 },
                .backstop_distance = (double)c.backstop_distance[i],
                .backstop_radius = kind / 4 == 2 ? 1.0 / (double)c.curvature[i] : (double)INFINITY,
                .stiffness = { (double)args.distance.stiffness, (double)args.backstop.stiffness },
                .alpha = { (double)args.distance.compliance, (double)args.backstop.compliance },
            };
            const float* p = start.position[i];
            double3 x = { (double)p[0], (double)p[1], (double)p[2] };
            x = motion_oracle_project( &m, x, (double)p[3], kind % 4 == 3 );
            x = motion_oracle_project( &m, x, (double)p[3], kind % 4 == 3 );
            const double expected[3] = { x.x, x.y, x.z };
            for ( int k = 0; k < 3; ++k )
            {
                // coordinates of 2 m, a handful of operations in floats
                assert_near( (double)c.position[i][k], expected[k], 2e-6, "coordinate of", 100 * kind + i );
            }
            const bool same = memcmp( p, c.position[i], sizeof( c.position[i] ) ) == 0;
            moved += same ? 0 : 1;
            kept += same ? 1 : 0;
        }
        assert_true( moved > 150 );
        assert_true( kept > 100 );
    }
}

// The cube in which a group is left out lies within what is allowed, wherever the target is in the step.
TEST( a_group_that_is_left_out_is_within_its_limits )
{
    static crowd c;
    int left_out = 0;
    for ( int kind = 1; kind < KINDS; kind += 4 )
    {
        fill( &c, kind );
        begin_step( widest_table(), &c, kind );
        for ( int i = 0; i < MOVED_COUNT; ++i )
        {
            const double h = (double)c.bound[i][3];
            for ( int corner = 0; h >= 0.0 && corner < 8 * 5; ++corner )
            {
                const double left = 0.25 * (double)( corner / 8 );
                motion_oracle m = {
                    .target = vector_at( c.target, c.displacement, i, left ),
                    .max_distance = (double)c.max_distance[i],
                    .normal = kind / 4 > 0 ? vector_at( c.normal, c.change, i, left ) : ( double3 ){ 0.0, 0.0, 0.0 },
                    .backstop_distance = (double)c.backstop_distance[i],
                    .backstop_radius = kind / 4 == 2 ? 1.0 / (double)c.curvature[i] : (double)INFINITY,
                    .stiffness = { 1.0, 1.0 },
                };
                const double3 x = { (double)c.bound[i][0] + ( corner & 1 ? h : -h ),
                                    (double)c.bound[i][1] + ( corner & 2 ? h : -h ),
                                    (double)c.bound[i][2] + ( corner & 4 ? h : -h ) };
                const double3 to = motion_oracle_project( &m, x, 1.0, false );
                assert_true( to.x == x.x && to.y == x.y && to.z == x.z );
                left_out += 1;
            }
        }
    }
    assert_true( left_out > 3 * 40 * 100 );
}

TEST( a_speed_above_the_largest_one_is_scaled_to_it )
{
    _Alignas(
        64 ) float v[16][4] = { { 3.0f, 0.0f, 4.0f, 0.0f }, { 0.3f, 0.0f, 0.4f, 0.0f }, { 0.0f, -2.0f, 0.0f, 0.0f } };
    const float slow[4] = { 0.3f, 0.0f, 0.4f, 0.0f };
    assert_int_equal( widest_table()->limit_speed( v[0], 1.0f, 0, 16 ), 2 );
    assert_near( (double)v[0][0], 0.6, 1e-7, "x", 0 );
    assert_near( (double)v[0][2], 0.8, 1e-7, "z", 0 );
    assert_memory_equal( v[1], slow, sizeof( slow ) );
    assert_near( (double)v[2][1], -1.0, 0.0, "y", 2 );
}

enum
{
    COUNT = 256,
    LANES = 8,
    ROOM = COUNT + LANES, // kernels compress into it
    SEEDS = 40,
    BOUNDS = 4,
};

typedef struct block
{
    _Alignas( 64 ) float position[COUNT][4], previous[COUNT][4], place[COUNT][4];
    int32_t slot[COUNT / LANES], queried[ROOM], strays[ROOM], counts[COUNT], single[ROOM], several[ROOM];
    uint8_t moving[COUNT / LANES], pinned[COUNT / LANES];
    float now[3][COUNT], old[3][COUNT], from[3][ROOM], to[3][ROOM];
    float path[ROOM], reach[ROOM], clear[COUNT], free_radius[COUNT], lower[3], upper[3];
    uint32_t groups, unsettled;
    int begin, end, count, queried_count, stray_count, single_count, several_count;
} block;

// Some are pinned, some NaN, some too far away to be particles.
static block* new_block( int seed )
{
    block* b = aligned_alloc( 64, ( sizeof( block ) + 63 ) / 64 * 64 );
    assert_non_null( b );
    memset( b, 0, sizeof( *b ) );
    b->begin = seed % 3 * 8;
    b->end = COUNT - seed % 5 * 8;
    for ( int i = 0; i < COUNT; ++i )
    {
        const int key = seed * COUNT + i;
        for ( int k = 0; k < 3; ++k )
        {
            b->position[i][k] = test_random_float( key, k, -1.0f, 1.0f );
            b->previous[i][k] = b->position[i][k] + test_random_float( key, 3 + k, -0.1f, 0.1f );
        }
        b->position[i][3] = i % 5 == seed % 5 ? 0.0f : 2.0f;
        b->previous[i][3] = NAN; // not read
        memcpy( b->place[i], b->position[i], sizeof( b->place[i] ) );
        b->place[i][3] = INFINITY;
        b->counts[i] = test_random( key, 7, 5 );
        b->free_radius[i] = i % 7 == 0 ? 0.01f : INFINITY;
        b->clear[i] = i % 3 == 0 ? INFINITY : test_random_float( key, 6, 0.0f, 0.5f );
    }
    // every fifth block is gathered as a whole, the others but for some groups
    b->groups = seed % 5 == 0 ? UINT32_MAX : 0xf6b7dd9fu;
    b->position[30][seed % 3] = NAN;
    b->position[41][seed % 3] = 2e9f;
    b->previous[52][seed % 3] = -INFINITY;
    b->previous[63][seed % 3] = NAN;
    b->position[74][3] = NAN;
    return b;
}

static wisp_particle_batch particle_batch_of( block* b )
{
    return ( wisp_particle_batch ){
        b->slot, b->moving, b->pinned, { b->now[0], b->now[1], b->now[2] }, { b->old[0], b->old[1], b->old[2] }
    };
}

static wisp_cull_args sight_of( block* b, int seed )
{
    float r[9];
    for ( int k = 0; k < 9; ++k )
    {
        r[k] = test_random_float( seed, 10 + k, -1.0f, 1.0f );
    }
    const wisp_transform before =
        wisp_transform_make( ( wisp_quat ){ r[0], r[1], r[2], 1.0f }, ( wisp_vec3 ){ r[3], r[4], r[5] } );
    wisp_transform after = before;
    after.translation.x += 0.1f * r[6];
    return ( wisp_cull_args ){
        .batch = particle_batch_of( b ),
        .before = before,
        .after =
            seed % 2 == 0 ? after : wisp_transform_make( ( wisp_quat ){ r[0], r[1], r[2], 1.1f }, after.translation ),
        .shape = (wisp_cull_shape)( seed % BOUNDS ),
        .centre = { seed % BOUNDS == WISP_CULL_ROUND ? 0.0f : 0.1f * r[7], 0.0f, 0.0f },
        .half = { 0.3f, 0.4f, 0.3f },
        .radius = 0.3f,
        .half_length = seed % 4 < 2 ? 0.1f : 0.0f,
        .margin = 0.05f,
        .shift = seed % 4 == 0 ? 0.0f : 0.02f,
        .turn = seed % 4 < 2 ? 0.0f : 0.03f,
        .free_radius = b->free_radius,
        .from = { b->from[0], b->from[1], b->from[2] },
        .to = { b->to[0], b->to[1], b->to[2] },
        .path = b->path,
        .reach = b->reach,
        .clearance = b->clear,
        .candidates = b->queried,
    };
}

static void run( const wisp_kernels* kernels, block* b, int seed )
{
    const wisp_gather_args args = { .position = b->position[0],
                                    .previous = b->previous[0],
                                    .search_origin = b->place[0],
                                    .groups = b->groups,
                                    .batch = particle_batch_of( b ),
                                    .lower = b->lower,
                                    .upper = b->upper };
    const wisp_cull_args sight = sight_of( b, seed );
    b->count = kernels->gather_particles( &args, b->begin, b->end );
    b->queried_count = kernels->cull_particles( &sight, b->count );
    for ( int i = b->begin; i < b->end; ++i )
    {
        b->place[i][3] = i % 2 == 0 ? ( i % 4 == 0 ? 0.05f : -0.05f ) : b->place[i][3];
    }
    b->single_count = kernels->list_counts( b->counts, b->end, b->single, b->several, &b->several_count );
    b->stray_count = kernels->find_displaced( b->previous[0], b->place[0], b->begin, b->end, b->strays );
}

static void assert_same_floats( const float* found, const float* expected, int count )
{
    assert_memory_equal( found, expected, (size_t)count * sizeof( float ) );
}

TEST( every_table_gives_the_same_bits )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int tables_count = usable_tables( tables );
    for ( int n = 0; n < SEEDS * tables_count; ++n )
    {
        const int seed = n % SEEDS;
        block *b = new_block( seed ), *expected = new_block( seed );
        run( tables[n / SEEDS], b, seed );
        run( tables[0], expected, seed );
        assert_int_equal( b->count, expected->count );
        assert_int_equal( b->queried_count, expected->queried_count );
        assert_int_equal( b->stray_count, expected->stray_count );
        assert_memory_equal( b->slot, expected->slot, (size_t)( b->count / LANES ) * sizeof( int32_t ) );
        assert_memory_equal( b->moving, expected->moving, (size_t)( b->count / LANES ) );
        assert_memory_equal( b->pinned, expected->pinned, (size_t)( b->count / LANES ) );
        assert_memory_equal( b->queried, expected->queried, (size_t)b->queried_count * sizeof( int32_t ) );
        assert_memory_equal( b->strays, expected->strays, (size_t)b->stray_count * sizeof( int32_t ) );
        assert_int_equal( b->single_count, expected->single_count );
        assert_int_equal( b->several_count, expected->several_count );
        assert_memory_equal( b->single, expected->single, (size_t)b->single_count * sizeof( int32_t ) );
        assert_memory_equal( b->several, expected->several, (size_t)b->several_count * sizeof( int32_t ) );
        for ( int k = 0; k < 3; ++k )
        {
            assert_same_floats( b->now[k], expected->now[k], b->count );
            assert_same_floats( b->old[k], expected->old[k], b->count );
            assert_same_floats( b->from[k], expected->from[k], b->queried_count );
            assert_same_floats( b->to[k], expected->to[k], b->queried_count );
        }
        assert_same_floats( b->path, expected->path, b->queried_count );
        assert_same_floats( b->reach, expected->reach, b->queried_count );
        for ( int i = 0; i < b->count; ++i )
        {
            // of what is no number, the bits are left open
            const bool moves = ( b->moving[i / LANES] >> i % LANES & 1 ) != 0;
            assert_true( moves == false || memcmp( b->clear + i, expected->clear + i, sizeof( float ) ) == 0 );
            assert_true( moves == false ||
                         memcmp( b->free_radius + i, expected->free_radius + i, sizeof( float ) ) == 0 );
        }
        assert_same_floats( b->lower, expected->lower, 3 );
        assert_same_floats( b->upper, expected->upper, 3 );
        free( b );
        free( expected );
    }
}

// ---- scalar code ----

static bool is_place( const float* p )
{
    return fabsf( p[0] ) <= 1e9f && fabsf( p[1] ) <= 1e9f && fabsf( p[2] ) <= 1e9f;
}

static bool is_gathered( const block* b, int slot )
{
    return ( b->groups >> ( slot - b->begin ) / LANES & 1u ) != 0;
}

TEST( groups_are_gathered_with_who_moves )
{
    for ( int seed = 0; seed < SEEDS; ++seed )
    {
        block* b = new_block( seed );
        memset( b->place, 0, sizeof( b->place ) );
        run( widest_table(), b, seed );
        int n = 0;
        float lower[3] = { INFINITY, INFINITY, INFINITY }, upper[3] = { -INFINITY, -INFINITY, -INFINITY };
        for ( int i = b->begin; i < b->end; ++i )
        {
            const float *p = b->position[i], *old = b->previous[i];
            if ( is_gathered( b, i ) == false )
            {
                assert_true( b->place[i][0] == 0.0f && b->place[i][2] == 0.0f );
                continue;
            }
            const bool finite = is_place( p ) && is_place( old ), moves = p[3] > 0.0f && finite;
            assert_int_equal( b->slot[n / LANES] + n % LANES, i );
            assert_int_equal( b->moving[n / LANES] >> n % LANES & 1, moves );
            assert_int_equal( b->pinned[n / LANES] >> n % LANES & 1, finite && p[3] == 0.0f );
            for ( int k = 0; k < 3; ++k )
            {
                assert_true( moves == false || ( b->now[k][n] == p[k] && b->old[k][n] == old[k] ) );
                lower[k] = moves ? fminf( lower[k], fminf( p[k], old[k] ) ) : lower[k];
                upper[k] = moves ? fmaxf( upper[k], fmaxf( p[k], old[k] ) ) : upper[k];
            }
            assert_memory_equal( b->place[i], p, 3 * sizeof( float ) );
            assert_true( i % 2 == 0 || b->place[i][3] == INFINITY );
            ++n;
        }
        assert_int_equal( b->count, n );
        assert_memory_equal( b->lower, lower, sizeof( lower ) );
        assert_memory_equal( b->upper, upper, sizeof( upper ) );
        free( b );
    }
}

TEST( a_block_without_anyone_who_moves_is_nowhere )
{
    block* b = new_block( 0 );
    for ( int i = 0; i < COUNT; ++i )
    {
        b->position[i][3] = 0.0f;
    }
    run( widest_table(), b, 0 );
    assert_true( b->count == 0 && b->queried_count == 0 && b->lower[1] == INFINITY && b->upper[1] == -INFINITY );
    free( b );
}

static float length_of( float x, float y, float z )
{
    return sqrtf( x * x + y * y + z * z );
}

static float outside( float distance, float half )
{
    return fmaxf( fabsf( distance ) - half, 0.0f );
}

// Whether a particle is beyond reach, and a lower bound of its distance.
static bool is_far_from( const wisp_cull_args* s, wisp_vec3 p, float reach, float* distance )
{
    if ( s->shape == WISP_CULL_HALF_SPACE )
    {
        *distance = p.y;
        return p.y > reach;
    }
    if ( s->shape == WISP_CULL_ROUND )
    {
        const float y = outside( p.y, s->half_length ), limit = s->radius + reach;
        *distance = length_of( p.x, y, p.z ) - s->radius;
        return p.x * p.x + y * y + p.z * p.z > 1.00001f * limit * limit;
    }
    *distance = length_of( outside( p.x - s->centre.x, s->half.x ), outside( p.y - s->centre.y, s->half.y ),
                           outside( p.z - s->centre.z, s->half.z ) );
    const float box = *distance, away = length_of( p.x - s->centre.x, p.y - s->centre.y, p.z - s->centre.z );
    const float limit = s->radius + reach;
    if ( s->shape == WISP_CULL_BOX_AND_BALL )
    {
        *distance = fmaxf( box, away - s->radius );
        const float x = p.x - s->centre.x, y = p.y - s->centre.y, z = p.z - s->centre.z;
        return box > reach || x * x + y * y + z * z > 1.00001f * limit * limit;
    }
    return box > reach;
}

static wisp_vec3 particle_at( float ( *from )[COUNT], int i )
{
    return ( wisp_vec3 ){ from[0][i], from[1][i], from[2][i] };
}

TEST( who_is_within_reach_is_queried_and_the_rest_is_clear )
{
    int queried_of[BOUNDS] = { 0 }, left_out[BOUNDS] = { 0 };
    for ( int seed = 0; seed < SEEDS; ++seed )
    {
        block *b = new_block( seed ), *before = new_block( seed );
        run( widest_table(), b, seed );
        const wisp_cull_args s = sight_of( b, seed );
        int queried = 0, moving = 0;
        for ( int i = 0; i < b->count; ++i )
        {
            if ( ( b->moving[i / LANES] >> i % LANES & 1 ) == 0 )
            {
                continue;
            }
            const wisp_vec3 from = wisp_transform_to_local( s.before, particle_at( b->old, i ) ),
                            to = wisp_transform_to_local( s.after, particle_at( b->now, i ) );
            const float path = length_of( to.x - from.x, to.y - from.y, to.z - from.z ), reach = s.margin + path;
            float distance;
            const bool is_far = is_far_from( &s, to, reach, &distance );
            assert_true( b->clear[i] == ( is_far ? fminf( reach, before->clear[i] ) : before->clear[i] ) );
            assert_true( is_far || b->queried[queried] == i );
            assert_true( b->free_radius[i] <= before->free_radius[i] && ( is_far || b->free_radius[i] <= 0.0f ) );
            assert_true( b->free_radius[i] <= 0.0f ||
                         3.0f * b->free_radius[i] < distance - s.margin - 2.0f * s.shift );
            if ( is_far == false )
            {
                assert_true( b->from[0][queried] == from.x && b->from[1][queried] == from.y &&
                             b->from[2][queried] == from.z );
                assert_true( b->to[0][queried] == to.x && b->to[1][queried] == to.y && b->to[2][queried] == to.z );
                assert_true( b->path[queried] == path && b->reach[queried] == reach );
            }
            queried += is_far ? 0 : 1;
            ++moving;
        }
        assert_int_equal( b->queried_count, queried );
        queried_of[s.shape] += queried;
        left_out[s.shape] += moving - queried;
        free( b );
        free( before );
    }
    for ( int k = 0; k < BOUNDS; ++k )
    {
        if ( queried_of[k] < 50 || left_out[k] < 100 )
        {
            fail_msg( "bound %d: %d queried, %d left out", k, queried_of[k], left_out[k] );
        }
    }
}

// ---- settled groups ----

// What free_radius promises: wherever a particle goes within its radius, and however the body moves within its bounds,
// a search would find nothing.
TEST( within_its_free_radius_no_body_finds_a_particle )
{
    int tried = 0;
    for ( int seed = 0; seed < SEEDS; ++seed )
    {
        block* b = new_block( seed );
        run( widest_table(), b, seed );
        const wisp_cull_args s = sight_of( b, seed );
        for ( int i = 0; i < b->count; ++i )
        {
            const float radius = b->free_radius[i];
            if ( ( b->moving[i / LANES] >> i % LANES & 1 ) == 0 || !( radius > 0.0f ) || radius == INFINITY )
            {
                continue;
            }
            wisp_vec3 at[2];
            wisp_transform pose[2];
            for ( int k = 0; k < 2; ++k )
            {
                float r[9];
                for ( int c = 0; c < 9; ++c )
                {
                    r[c] = test_random_float( 2 * ( seed * COUNT + i ) + k, 20 + c, -1.0f, 1.0f );
                }
                const float way = radius / length_of( r[0], r[1], r[2] ), shift = 0.57f * s.shift,
                            turn = 0.14f * s.turn;
                const wisp_vec3 p = particle_at( b->now, i ), t = s.after.translation;
                const wisp_quat q = s.after.rotation;
                at[k] = ( wisp_vec3 ){ p.x + way * r[0], p.y + way * r[1], p.z + way * r[2] };
                // 2 |q - q'| is no more than the turn: four components of 0.14 each, and making it a unit
                pose[k] = wisp_transform_make(
                    ( wisp_quat ){ q.x + turn * r[6], q.y + turn * r[7], q.z + turn * r[8], q.w + turn * r[0] },
                    ( wisp_vec3 ){ t.x + shift * r[3], t.y + shift * r[4], t.z + shift * r[5] } );
            }
            const wisp_vec3 from = wisp_transform_to_local( pose[0], at[0] ),
                            to = wisp_transform_to_local( pose[1], at[1] );
            float distance;
            const float reach = s.margin + length_of( to.x - from.x, to.y - from.y, to.z - from.z );
            assert_true( is_far_from( &s, to, reach, &distance ) && distance > reach );
            ++tried;
        }
        free( b );
    }
    assert_true( tried > 500 );
}

TEST( a_group_is_settled_while_all_are_within_their_radius )
{
    for ( int seed = 0; seed < SEEDS; ++seed )
    {
        block* b = new_block( 1 );
        for ( int i = 0; i < COUNT; ++i )
        {
            for ( int k = 0; k < 3; ++k )
            {
                b->place[i][k] = test_random_float( i, k, -1.0f, 1.0f );
                b->position[i][k] = b->place[i][k] + test_random_float( i, 3 + k, -0.05f, 0.05f );
                b->previous[i][k] = b->place[i][k] + test_random_float( i, 6 + k, -0.05f, 0.05f );
            }
            b->place[i][3] = i % 5 == 0 ? -INFINITY : -0.1f;
        }
        // one each leaves, by one position or the other, is no number, is infinite, has no radius
        const int who = seed % LANES;
        b->position[8 + who][seed % 3] += 0.2f;
        b->previous[24 + who][seed % 3] -= 0.2f;
        b->position[40 + who][seed % 3] = NAN;
        b->previous[56 + who][seed % 3] = NAN;
        b->position[72 + who][seed % 3] = INFINITY;
        b->place[88 + who][3] = 0.1f;
        b->place[8 + who][3] = b->place[24 + who][3] = -0.1f;
        const wisp_kernels* tables[MAX_TABLES];
        const int tables_count = usable_tables( tables );
        for ( int t = 0; t < tables_count; ++t )
        {
            const uint32_t groups =
                tables[t]->find_unsettled( b->position[0], b->previous[0], b->place[0], 0, 13 * LANES );
            assert_int_equal( groups, 1u << 1 | 1u << 3 | 1u << 5 | 1u << 7 | 1u << 9 | 1u << 11 );
        }
        free( b );
    }
}

TEST( counts_are_listed_by_one_and_more )
{
    for ( int seed = 0; seed < SEEDS; ++seed )
    {
        block* b = new_block( seed );
        run( widest_table(), b, seed );
        int one = 0, more = 0;
        for ( int i = 0; i < b->end; ++i )
        {
            assert_true( b->counts[i] != 1 || b->single[one] == i );
            assert_true( b->counts[i] < 2 || b->several[more] == i );
            one += b->counts[i] == 1 ? 1 : 0;
            more += b->counts[i] > 1 ? 1 : 0;
        }
        assert_true( b->single_count == one && b->several_count == more && one > 10 && more > 10 );
        free( b );
    }
}

TEST( who_leaves_its_place_is_a_stray )
{
    int all = 0;
    for ( int seed = 0; seed < SEEDS; ++seed )
    {
        block* b = new_block( seed );
        run( widest_table(), b, seed );
        int n = 0;
        for ( int i = b->begin; i < b->end; ++i )
        {
            const float *p = b->previous[i], *q = b->place[i];
            if ( length_of( p[0] - q[0], p[1] - q[1], p[2] - q[2] ) > fabsf( q[3] ) )
            {
                assert_int_equal( b->strays[n++], i );
            }
        }
        assert_int_equal( b->stray_count, n );
        all += n;
        free( b );
    }
    assert_true( all > 1000 && all < SEEDS * COUNT / 2 );
}
