// Kernels of particles one by one: motion constraints, carried particles and largest speeds, whose positions are those of
// the oracle; and particles in blocks. Every table gives the same bits as the first, or as scalar code.
#include "kernels_fixture.h"

#include "constraint_oracle.h"

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
    int kind, limited;
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
static void fill( void* state, int kind )
{
    crowd* c = state;
    c->kind = kind;
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

static wisp_motion_constraint_args args_of( crowd* c, float left )
{
    const int kind = c->kind;
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

static void begin_step( const wisp_kernels* kernels, crowd* c, int begin, int end )
{
    const bool behind = c->kind / 4 > 0;
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
    kernels->motion_targets( &args, begin, end );
}

static void move_all( const wisp_kernels* kernels, void* state, int begin, int end )
{
    crowd* c = state;
    begin_step( kernels, c, begin, end );
    for ( int pass = 0; pass < 3; ++pass )
    {
        wisp_motion_constraint_args args = args_of( c, 0.5f * (float)( 2 - pass ) );
        args.velocity = c->velocity[0];
        args.inverse_dt = 60.0f;
        kernels->motion_constraint( &args, begin, end );
    }
    const wisp_frame_motion_args carried = { { -0.02f, -0.2f, 0.1f, 0.2f, -0.03f, 0.01f, -0.1f, 0.02f, -0.01f },
                                             { 1.0f, 2.0f, 3.0f },
                                             { 0.1f, 0.0f, -0.1f } };
    kernels->move_points( &carried, c->position[0], begin, end );
    kernels->turn_vectors( &carried, c->velocity[0], begin, end );
    c->limited += kernels->limit_speed( c->velocity[0], 0.75f, begin, end );
}

static void check_limited( void* start, void* end )
{
    (void)start;
    assert_true( ( (crowd*)end )->limited > 10 );
}

TEST_KERNEL( motions_have_the_same_bits_in_any_ranges, crowd, KINDS, 0, MOVED_COUNT, 8, fill, move_all,
             check_limited )

static double3 vector_at( const float* end, const float* change, int slot, double left )
{
    const float *e = end + row_of( slot ), *c = change + row_of( slot );
    return double3_make( (double)e[0] - left * (double)c[0], (double)e[8] - left * (double)c[8],
                         (double)e[16] - left * (double)c[16] );
}

static motion_oracle oracle_at( crowd* c, int i, double left )
{
    const wisp_motion_constraint_args args = args_of( c, 0.0f );
    const double3 none = { 0.0, 0.0, 0.0 };
    return ( motion_oracle ){
        .target = vector_at( c->target, c->displacement, i, left ),
        .max_distance = (double)c->max_distance[i],
        .normal = c->kind / 4 > 0 ? vector_at( c->normal, c->change, i, left ) : none,
        .backstop_distance = (double)c->backstop_distance[i],
        .backstop_radius = c->kind / 4 == 2 ? 1.0 / (double)c->curvature[i] : (double)INFINITY,
        .stiffness = { (double)args.distance.stiffness, (double)args.backstop.stiffness },
        .alpha = { (double)args.distance.compliance, (double)args.backstop.compliance },
    };
}

// Two iterations in the middle of a step.
static void move_twice( const wisp_kernels* kernels, void* state, int begin, int end )
{
    const wisp_motion_constraint_args args = args_of( state, 0.25f );
    begin_step( kernels, state, begin, end );
    kernels->motion_constraint( &args, begin, end );
    kernels->motion_constraint( &args, begin, end );
}

// Groups that are well inside, and lanes that are free, keep their bits.
static void check_twice( void* begun, void* end )
{
    crowd *start = begun, *c = end;
    int moved = 0, kept = 0;
    for ( int i = 0; i < MOVED_COUNT; ++i )
    {
        motion_oracle m = oracle_at( c, i, 0.25 );
        const float* p = start->position[i];
        double3 x = double3_from( p );
        x = motion_oracle_project( &m, x, (double)p[3], c->kind % 4 == 3 );
        x = motion_oracle_project( &m, x, (double)p[3], c->kind % 4 == 3 );
        // coordinates of 2 m, a handful of operations in floats
        assert_near3( double3_from( c->position[i] ), x, 2e-6, "position of", 1000 * c->kind + i );
        const bool same = memcmp( p, c->position[i], sizeof( c->position[i] ) ) == 0;
        moved += same ? 0 : 1;
        kept += same ? 1 : 0;
    }
    assert_true( moved > 150 );
    assert_true( kept > 100 );
}

TEST_KERNEL( positions_are_those_of_the_oracle, crowd, KINDS, 0, MOVED_COUNT, 8, fill, move_twice, check_twice )

// The cube in which a group is left out lies within what is allowed, wherever the target is in the step.
TEST( a_group_that_is_left_out_is_within_its_limits )
{
    static crowd c;
    int left_out = 0;
    for ( int kind = 1; kind < KINDS; kind += 4 )
    {
        memset( &c, 0, sizeof( c ) );
        fill( &c, kind );
        begin_step( widest_table(), &c, 0, MOVED_COUNT );
        for ( int i = 0; i < MOVED_COUNT; ++i )
        {
            const double h = (double)c.bound[i][3];
            for ( int corner = 0; h >= 0.0 && corner < 8 * 5; ++corner )
            {
                motion_oracle m = oracle_at( &c, i, 0.25 * (double)( corner / 8 ) );
                const double3 to_corner = { corner & 1 ? h : -h, corner & 2 ? h : -h, corner & 4 ? h : -h };
                const double3 x = double3_add( double3_from( c.bound[i] ), to_corner );
                assert_near3( motion_oracle_project( &m, x, 1.0, false ), x, 0.0, "corner", corner );
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
    int seed, begin, end, count, queried_count, stray_count, single_count, several_count;
} block;

// Some are pinned, some NaN, some too far away to be particles.
static void fill_block( void* state, int seed )
{
    block* b = state;
    b->seed = seed;
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
}

static wisp_particle_batch particle_batch_of( block* b )
{
    return ( wisp_particle_batch ){
        b->slot, b->moving, b->pinned, { b->now[0], b->now[1], b->now[2] }, { b->old[0], b->old[1], b->old[2] }
    };
}

static wisp_cull_args sight_of( block* b )
{
    const int seed = b->seed;
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

static void run( const wisp_kernels* kernels, block* b )
{
    const wisp_gather_args args = { .position = b->position[0],
                                    .previous = b->previous[0],
                                    .search_origin = b->place[0],
                                    .groups = b->groups,
                                    .batch = particle_batch_of( b ),
                                    .lower = b->lower,
                                    .upper = b->upper };
    const wisp_cull_args sight = sight_of( b );
    b->count = kernels->gather_particles( &args, b->begin, b->end );
    b->queried_count = kernels->cull_particles( &sight, b->count );
    for ( int i = b->begin; i < b->end; ++i )
    {
        b->place[i][3] = i % 2 == 0 ? ( i % 4 == 0 ? 0.05f : -0.05f ) : b->place[i][3];
    }
    b->single_count = kernels->list_counts( b->counts, b->end, b->single, b->several, &b->several_count );
    b->stray_count = kernels->find_displaced( b->previous[0], b->place[0], b->begin, b->end, b->strays );
}

// Kernels compress whole groups: what is behind the last one is left open, and so is what is no number.
static void run_block( const wisp_kernels* kernels, void* state, int begin, int end )
{
    block* b = state;
    assert_true( begin <= b->begin && b->end <= end );
    run( kernels, b );
    for ( int k = 0; k < 3; ++k )
    {
        FORGET_BEHIND( b->now[k], b->count );
        FORGET_BEHIND( b->old[k], b->count );
        FORGET_BEHIND( b->from[k], b->queried_count );
        FORGET_BEHIND( b->to[k], b->queried_count );
    }
    FORGET_BEHIND( b->path, b->queried_count );
    FORGET_BEHIND( b->reach, b->queried_count );
    FORGET_BEHIND( b->queried, b->queried_count );
    FORGET_BEHIND( b->strays, b->stray_count );
    FORGET_BEHIND( b->single, b->single_count );
    FORGET_BEHIND( b->several, b->several_count );
    FORGET_BEHIND( b->slot, b->count / LANES );
    FORGET_BEHIND( b->moving, b->count / LANES );
    FORGET_BEHIND( b->pinned, b->count / LANES );
    for ( int i = 0; i < COUNT; ++i )
    {
        const bool moves = i < b->count && ( b->moving[i / LANES] >> i % LANES & 1 ) != 0;
        b->clear[i] = moves ? b->clear[i] : 0.0f;
        b->free_radius[i] = moves ? b->free_radius[i] : 0.0f;
    }
}

// ---- scalar code ----

static bool is_place( const float* p )
{
    return fabsf( p[0] ) <= 1e9f && fabsf( p[1] ) <= 1e9f && fabsf( p[2] ) <= 1e9f;
}

static bool moves_at( const block* b, int n )
{
    return ( b->moving[n / LANES] >> n % LANES & 1 ) != 0;
}

static bool is_gathered( const block* b, int slot )
{
    return ( b->groups >> ( slot - b->begin ) / LANES & 1u ) != 0;
}

static void check_gathered( block* b )
{
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
        assert_int_equal( moves_at( b, n ), moves );
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
}

TEST( a_block_without_anyone_who_moves_is_nowhere )
{
    static block b;
    fill_block( &b, 0 );
    for ( int i = 0; i < COUNT; ++i )
    {
        b.position[i][3] = 0.0f;
    }
    run( widest_table(), &b );
    assert_true( b.count == 0 && b.queried_count == 0 && b.lower[1] == INFINITY && b.upper[1] == -INFINITY );
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

static int queried_of[BOUNDS], left_out[BOUNDS], tried, strays;

static bool is_at( float ( *found )[ROOM], int n, wisp_vec3 p )
{
    return found[0][n] == p.x && found[1][n] == p.y && found[2][n] == p.z;
}

// Who is within reach is queried, and the rest is clear.
static void check_queried( block* before, block* b )
{
    const wisp_cull_args s = sight_of( b );
    int queried = 0, moving = 0;
    for ( int i = 0; i < b->count; ++i )
    {
        if ( moves_at( b, i ) == false )
        {
            continue;
        }
        const wisp_vec3 from = wisp_transform_to_local( s.before, particle_at( b->old, i ) ),
                        to = wisp_transform_to_local( s.after, particle_at( b->now, i ) );
        const float path = length_of( to.x - from.x, to.y - from.y, to.z - from.z ), reach = s.margin + path;
        float distance;
        const bool is_far = is_far_from( &s, to, reach, &distance );
        assert_true( b->clear[i] == ( is_far ? fminf( reach, before->clear[i] ) : before->clear[i] ) );
        assert_true( b->free_radius[i] <= before->free_radius[i] && ( is_far || b->free_radius[i] <= 0.0f ) );
        assert_true( b->free_radius[i] <= 0.0f || 3.0f * b->free_radius[i] < distance - s.margin - 2.0f * s.shift );
        assert_true( is_far ||
                     ( b->queried[queried] == i && is_at( b->from, queried, from ) && is_at( b->to, queried, to ) &&
                       b->path[queried] == path && b->reach[queried] == reach ) );
        queried += is_far ? 0 : 1;
        ++moving;
    }
    assert_int_equal( b->queried_count, queried );
    queried_of[s.shape] += queried;
    left_out[s.shape] += moving - queried;
}

// What free_radius promises: wherever a particle goes within its radius, and however the body moves within its bounds,
// a search would find nothing.
static void check_free_radius( block* b, int i )
{
    const wisp_cull_args s = sight_of( b );
    wisp_vec3 local[2];
    for ( int k = 0; k < 2; ++k )
    {
        float r[9];
        for ( int c = 0; c < 9; ++c )
        {
            r[c] = test_random_float( 2 * ( b->seed * COUNT + i ) + k, 20 + c, -1.0f, 1.0f );
        }
        const float way = b->free_radius[i] / length_of( r[0], r[1], r[2] ), shift = 0.57f * s.shift,
                    turn = 0.14f * s.turn;
        const wisp_vec3 p = particle_at( b->now, i ), t = s.after.translation;
        const wisp_quat q = s.after.rotation;
        // 2 |q - q'| is no more than the turn: four components of 0.14 each, and making it a unit
        const wisp_transform pose = wisp_transform_make(
            ( wisp_quat ){ q.x + turn * r[6], q.y + turn * r[7], q.z + turn * r[8], q.w + turn * r[0] },
            ( wisp_vec3 ){ t.x + shift * r[3], t.y + shift * r[4], t.z + shift * r[5] } );
        local[k] =
            wisp_transform_to_local( pose, ( wisp_vec3 ){ p.x + way * r[0], p.y + way * r[1], p.z + way * r[2] } );
    }
    const wisp_vec3 from = local[0], to = local[1];
    float distance;
    const float reach = s.margin + length_of( to.x - from.x, to.y - from.y, to.z - from.z );
    assert_true( is_far_from( &s, to, reach, &distance ) && distance > reach );
    ++tried;
}

static void check_lists( block* b )
{
    int one = 0, more = 0, n = 0;
    for ( int i = 0; i < b->end; ++i )
    {
        assert_true( b->counts[i] != 1 || b->single[one] == i );
        assert_true( b->counts[i] < 2 || b->several[more] == i );
        one += b->counts[i] == 1 ? 1 : 0;
        more += b->counts[i] > 1 ? 1 : 0;
        const float *p = b->previous[i], *q = b->place[i];
        if ( i >= b->begin && length_of( p[0] - q[0], p[1] - q[1], p[2] - q[2] ) > fabsf( q[3] ) )
        {
            assert_int_equal( b->strays[n++], i );
        }
    }
    assert_true( b->single_count == one && b->several_count == more && one > 10 && more > 10 );
    assert_int_equal( b->stray_count, n );
    strays += n;
}

static void check_block( void* start, void* end )
{
    block* b = end;
    check_gathered( b );
    check_queried( start, b );
    check_lists( b );
    for ( int i = 0; i < b->count; ++i )
    {
        if ( moves_at( b, i ) && b->free_radius[i] > 0.0f && b->free_radius[i] < INFINITY )
        {
            check_free_radius( b, i );
        }
    }
}

TEST( who_moves_is_gathered_who_is_near_is_queried_and_who_leaves_its_place_is_a_stray )
{
    check_kernel( KERNEL_ROW( block, SEEDS, 0, COUNT, 0, fill_block, run_block, check_block ) );
    for ( int k = 0; k < BOUNDS; ++k )
    {
        assert_true( queried_of[k] >= 50 && left_out[k] >= 100 );
    }
    assert_true( tried > 500 );
    assert_true( strays > 1000 && strays < SEEDS * COUNT / 2 );
}

// ---- settled groups ----

TEST( a_group_is_settled_while_all_are_within_their_radius )
{
    for ( int seed = 0; seed < SEEDS; ++seed )
    {
        static block made;
        block* b = &made;
        fill_block( b, 1 );
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
        for ( const wisp_kernels* const* k = every_table(); *k != NULL; ++k )
        {
            const uint32_t groups =
                ( *k )->find_unclear( b->position[0], b->previous[0], b->place[0], 0, 13 * LANES );
            assert_int_equal( groups, 1u << 1 | 1u << 3 | 1u << 5 | 1u << 7 | 1u << 9 | 1u << 11 );
        }
    }
}
