// Kernels of sums over particles: moments, small rotations, the virial and the strain of links; their rigid motion, to which velocities
// go by the given fraction of their difference; displacements, deviations and separation bounds. Every table gives the
// same bits, and results agree with plain loops in doubles.
#include "kernels_fixture.h"

// ---- moments ----

enum
{
    SLOTS = 608,
    COUNT = 603, // slots from here on pad
    LINKS = 400,
    EDGES = 250,
    KINDS = 3,
};

typedef struct body_of_particles
{
    _Alignas( 64 ) float position[SLOTS][4], previous[SLOTS][4], velocity[SLOTS][4];
    int32_t a_x4[LINKS], b_x4[LINKS];
    uint8_t bends[LINKS / 8 + 3];
    float rest[LINKS];
    wisp_moments sums[2];
    double virial, strain;
    float largest;
    int kind;
} body_of_particles;

// Near the world's origin, far from it, or far from it with pinned particles. Positions are a step apart.
static void fill_body( void* state, int kind )
{
    body_of_particles* b = state;
    b->kind = kind;
    const float far = kind > 0 ? 300.0f : 0.0f;
    for ( int i = 0; i < SLOTS; ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            b->previous[i][k] = far * (float)( 1 - k ) + test_random_float( i, k, -1.0f, 1.0f );
            b->velocity[i][k] = i < COUNT ? test_random_float( i, 3 + k, -5.0f, 5.0f ) : 0.0f;
            b->position[i][k] = b->previous[i][k] + test_random_float( i, 6 + k, -0.01f, 0.01f );
        }
        const bool pinned = i >= COUNT || ( kind == 2 && i % 7 == 3 );
        b->position[i][3] = b->previous[i][3] = pinned ? 0.0f : test_random_float( i, 9, 0.5f, 2000.0f );
    }
    for ( int i = 0; i < LINKS; ++i )
    {
        const bool pads = i % 50 == 49;
        const unsigned is_bend = pads == false && i * 7 % LINKS >= EDGES;
        b->bends[i / 8] = (uint8_t)( b->bends[i / 8] | is_bend << i % 8 );
        b->a_x4[i] = 4 * ( pads ? SLOTS - 1 : i );
        b->b_x4[i] = 4 * ( pads ? SLOTS - 1 : ( i * 5 + 1 ) % COUNT );
        b->rest[i] = pads ? 0.0f : test_random_float( i, 10, 0.1f, 1.5f );
    }
}

static wisp_moment_args moment_args( const body_of_particles* b )
{
    return ( wisp_moment_args ){ .position = b->position[0],
                                 .previous = b->previous[0],
                                 .velocity = b->velocity[0],
                                 .origin = { b->previous[0][0], b->previous[0][1], b->previous[0][2] } };
}

static wisp_link_args link_args_of( body_of_particles* b )
{
    return ( wisp_link_args ){
        .position = b->position[0], .a_x4 = b->a_x4, .b_x4 = b->b_x4, .rest = b->rest, .bends = b->bends
    };
}

static wisp_turn_args turn_args( const body_of_particles* b, float* rows )
{
    const float* first = b->previous[0];
    return ( wisp_turn_args ){ .position = b->position[0],
                               .rows = rows,
                               .angle = { 0.3e-3, -0.2e-3, 1e-3 },
                               .centre = { (double)first[0] + 0.1, (double)first[1], (double)first[2] - 0.2 } };
}

static void run_body( const wisp_kernels* kernels, void* state, int begin, int end )
{
    body_of_particles* b = state;
    wisp_moment_args moments = moment_args( b );
    const wisp_link_args links = link_args_of( b );
    const wisp_turn_args speeds = turn_args( b, b->velocity[0] ), places = turn_args( b, b->position[0] );
    kernels->moments( &moments, begin, end, &b->sums[0] );
    moments.previous = moments.position;
    kernels->moments( &moments, begin, end, &b->sums[1] );
    b->virial = kernels->link_virial( &links, 2000.0f, 20.0f, 8, LINKS );
    b->strain = kernels->link_strain( &links, 8, LINKS, &b->largest );
    kernels->turn( &speeds, begin, end );
    kernels->turn( &places, begin, end );
}

enum
{
    SUMS = sizeof( wisp_moments ) / sizeof( double ),
};

// Add the terms of one particle, and their absolute values.
static void add_terms( const wisp_moment_args* args, int slot, double sums[SUMS], double sizes[SUMS] )
{
    const double w = (double)args->position[4 * slot + 3], mass = w > 0.0 ? 1.0 / w : 0.0;
    const double3 origin = double3_widen( args->origin );
    const double3 at = double3_sub( double3_from( args->position + 4 * slot ), origin );
    const double3 was = double3_sub( double3_from( args->previous + 4 * slot ), origin );
    const double3 v = double3_from( args->velocity + 4 * slot ), spin = double3_cross( was, v );
    const double p[3] = { at.x, at.y, at.z }, x[3] = { was.x, was.y, was.z }, u[3] = { v.x, v.y, v.z };
    const double l[3] = { spin.x, spin.y, spin.z };
    wisp_moments m = { .mass = mass, .pinned = w > 0.0 ? 0.0 : 1.0 };
    for ( int a = 0; a < 3; ++a )
    {
        m.first[a] = mass * p[a];
        m.previous[a] = mass * x[a];
        m.momentum[a] = mass * u[a];
        m.angular_momentum[a] = mass * l[a];
        for ( int b = 0; b < 3; ++b )
        {
            m.mixed[a][b] = mass * p[a] * x[b];
        }
    }
    for ( int k = 0; k < SUMS; ++k )
    {
        sums[k] += ( &m.mass )[k];
        sizes[k] += fabs( ( &m.mass )[k] );
    }
}

static void check_moments( const wisp_moment_args* args, int begin, int end, const wisp_moments* found )
{
    double sums[SUMS] = { 0.0 }, sizes[SUMS] = { 0.0 };
    for ( int slot = begin; slot < end; ++slot )
    {
        add_terms( args, slot, sums, sizes );
    }
    for ( int k = 0; k < SUMS; ++k )
    {
        // another order of as many terms; products of a cross product may be larger than their difference
        assert_near( ( &found->mass )[k], sums[k], 1e-13 * ( sizes[k] + sizes[0] ), "moment", k );
    }
    assert_true( found->pinned == sums[1] );
}

// A rotation of all positions adds angle x (p - c) to each, rounded once, and leaves the rest alone.
static void check_turn( body_of_particles* before, float ( *old )[4], float ( *rows )[4] )
{
    const wisp_turn_args args = turn_args( before, NULL );
    const double3 angle = { args.angle[0], args.angle[1], args.angle[2] },
                  centre = { args.centre[0], args.centre[1], args.centre[2] };
    for ( int slot = 0; slot < SLOTS; ++slot )
    {
        const bool turns = slot >= 8 && before->position[slot][3] > 0.0f;
        const double3 r = double3_sub( double3_from( before->position[slot] ), centre );
        const double3 to = double3_add( double3_from( old[slot] ), double3_cross( angle, r ) );
        const float expected[4] = { turns ? (float)to.x : old[slot][0], turns ? (float)to.y : old[slot][1],
                                    turns ? (float)to.z : old[slot][2], old[slot][3] };
        assert_memory_equal( rows[slot], expected, sizeof( expected ) );
    }
}

static void check_links( body_of_particles* before, const body_of_particles* found )
{
    const wisp_link_args args = link_args_of( before );
    double sum = 0.0, size = 0.0, strain = 0.0, largest = 0.0;
    for ( int i = 8; i < LINKS; ++i )
    {
        const double length = double3_distance( double3_from( args.position + args.a_x4[i] ),
                                                double3_from( args.position + args.b_x4[i] ) );
        const double stiffness = ( before->bends[i / 8] >> i % 8 & 1 ) == 0 ? 2000.0 : 20.0,
                     rest = (double)before->rest[i];
        sum += stiffness * ( length - rest ) * length;
        size += stiffness * ( length + rest ) * length;
        const double of_edge = stiffness > 20.0 && rest > 0.0 ? fabs( length / rest - 1.0 ) : 0.0;
        strain += of_edge;
        largest = fmax( largest, of_edge );
    }
    assert_near( found->virial, sum, (double)FLT_EPSILON * size, "virial", before->kind );
    assert_near( found->strain, strain, (double)FLT_EPSILON * ( strain + LINKS ), "strain", before->kind );
    assert_near( (double)found->largest, largest, 4.0 * (double)FLT_EPSILON * largest, "largest", before->kind );
    assert_true( widest_table()->link_virial( &args, 2000.0f, 20.0f, 8, 8 ) == 0.0 );
}

static void check_body( void* start, void* end )
{
    static const int RANGES[][2] = { { 0, COUNT }, { 16, COUNT }, { 8, 64 }, { 600, COUNT }, { 0, 0 } };
    body_of_particles *before = start, *b = end;
    for ( int n = 0; n < 2; ++n )
    {
        wisp_moment_args args = moment_args( before );
        args.previous = n == 0 ? args.previous : args.position;
        check_moments( &args, 8, COUNT, &b->sums[n] );
        for ( int i = 0; i < WISP_COUNT( RANGES ); ++i )
        {
            wisp_moments found;
            widest_table()->moments( &args, RANGES[i][0], RANGES[i][1], &found );
            check_moments( &args, RANGES[i][0], RANGES[i][1], &found );
        }
    }
    check_links( before, b );
    check_turn( before, before->velocity, b->velocity );
    check_turn( before, before->position, b->position );
}

TEST_KERNEL( moments_turns_and_virials_are_those_of_plain_loops, body_of_particles, KINDS, 8, COUNT, 0, fill_body,
             run_body, check_body )

// ---- rigid motion ----

enum
{
    CROWD = 600, // more than two blocks of the sums
    CROWD_KINDS = 5,
};

typedef struct crowd
{
    _Alignas( 64 ) float position[CROWD][4], velocity[CROWD][4];
    wisp_rigid_args args;
    wisp_rigid_sums sums;
} crowd;

// Near the world's origin or far from it, slow or fast, spread out or along a line, or so heavy that squares
// overflow.
static void fill_crowd( void* state, int kind )
{
    crowd* c = state;
    const float far = kind == 1 ? 300.0f : 0.0f, fast = kind == 2 ? 200.0f : 0.0f;
    for ( int i = 0; i < CROWD; ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const float along = test_random_float( i, 9, -1.0f, 1.0f ) * (float)( k + 1 );
            c->position[i][k] = far + ( kind == 3 ? along : test_random_float( i, k, -1.0f, 1.0f ) );
            c->velocity[i][k] = fast + test_random_float( i, 3 + k, -1.0f, 1.0f );
        }
        c->position[i][3] =
            i % 7 == 3 ? 0.0f : test_random_float( i, 6, 0.5f, 100.0f ) * ( kind == 4 ? 1e-35f : 1.0f );
    }
    c->args.origin = ( wisp_vec3 ){ c->position[1][0], c->position[1][1], c->position[1][2] };
    c->args.linear_velocity = ( wisp_vec3 ){ c->velocity[1][0], c->velocity[1][1], c->velocity[1][2] };
    c->args.inverse_mass = kind == 4 ? 1e-35f : 4.0f;
    c->args.angular_velocity = ( wisp_vec3 ){ 0.5f, -2.0f, 1.25f };
    c->args.fraction = 0.375f;
}

static wisp_rigid_args rigid_job_of( crowd* c )
{
    wisp_rigid_args args = c->args;
    args.position = c->position[0];
    args.velocity = c->velocity[0];
    return args;
}

static void run_crowd( const wisp_kernels* kernels, void* state, int begin, int end )
{
    crowd* c = state;
    const wisp_rigid_args args = rigid_job_of( c );
    kernels->rigid_sums( &args, begin, end, &c->sums );
    kernels->rigid_approach( &args, begin, end );
}

// Sums, and those of the absolute values of their terms.
static void add_rigid_terms( const crowd* c, int i, double sums[16], double sizes[16] )
{
    const float *p = c->position[i], *v = c->velocity[i];
    const wisp_vec3 o = c->args.origin, d = c->args.linear_velocity;
    const double mass = p[3] > 0.0f ? (double)c->args.inverse_mass / (double)p[3] : 0.0;
    const double r[3] = { (double)p[0] - (double)o.x, (double)p[1] - (double)o.y, (double)p[2] - (double)o.z },
                 u[3] = { (double)v[0] - (double)d.x, (double)v[1] - (double)d.y, (double)v[2] - (double)d.z };
    double terms[16] = { 1.0, r[0], r[1], r[2], u[0], u[1], u[2] };
    double most[16] = { 1.0 };
    for ( int k = 0; k < 3; ++k )
    {
        const int a = ( k + 1 ) % 3, b = ( k + 2 ) % 3;
        terms[7 + k] = r[a] * u[b] - r[b] * u[a];
        terms[10 + k] = r[k] * r[k];
        terms[13 + k] = k == 0 ? r[0] * r[1] : r[k - 1] * r[2];
        most[7 + k] = fabs( r[a] * u[b] ) + fabs( r[b] * u[a] );
    }
    for ( int k = 0; k < 16; ++k )
    {
        sums[k] += mass * terms[k];
        sizes[k] += mass * fmax( most[k], fabs( terms[k] ) );
    }
}

// Velocities go their share of the way.
static void check_velocity( const crowd* before, const crowd* c, int i )
{
    const wisp_rigid_args args = c->args;
    const bool goes = i >= 16 && i < CROWD - 8 && c->position[i][3] > 0.0f;
    const double3 r = double3_sub( double3_from( c->position[i] ), double3_widen( args.origin ) );
    const double3 rigid = double3_add( double3_widen( args.linear_velocity ),
                                       double3_cross( double3_widen( args.angular_velocity ), r ) );
    const double to[3] = { rigid.x, rigid.y, rigid.z };
    for ( int k = 0; k < 3; ++k )
    {
        const double v = (double)before->velocity[i][k], there = v + (double)args.fraction * ( to[k] - v );
        assert_near( (double)c->velocity[i][k], goes ? there : v,
                     goes ? 4.0 * (double)FLT_EPSILON * ( 8.0 + fabs( v ) ) : 0.0, "velocity", 3 * i + k );
    }
    assert_true( c->velocity[i][3] == 0.0f );
}

static void check_crowd( void* start, void* end )
{
    crowd *before = start, *c = end;
    double sums[16] = { 0.0 }, sizes[16] = { 0.0 }, numbers[16];
    for ( int i = 0; i < CROWD; ++i )
    {
        check_velocity( before, c, i );
        if ( i >= 16 && i < CROWD - 8 )
        {
            add_rigid_terms( before, i, sums, sizes );
        }
    }
    memcpy( numbers, &c->sums, sizeof( numbers ) );
    for ( int k = 0; k < 16; ++k )
    {
        // a product of three numbers, and 32 terms to a sum
        assert_near( numbers[k], sums[k], 4.0 * (double)FLT_EPSILON * sizes[k], "sum", k );
    }
    const wisp_rigid_args args = rigid_job_of( c );
    widest_table()->rigid_sums( &args, 16, 16, &c->sums );
    assert_true( c->sums.mass == 0.0 && c->sums.yz == 0.0 );
}

TEST_KERNEL( velocities_approach_the_rigid_motion_of_all_that_move, crowd, CROWD_KINDS, 16, CROWD - 8, 0, fill_crowd,
             run_crowd, check_crowd )

enum
{
    POINTS = 40,
    SIDES = 24,
    PAIRS = 56,
    SEEDS = 40,
};

static const double ROUNDING = 4.0 * (double)FLT_EPSILON;

static float chance( int seed, int number )
{
    return test_random_float( seed, number, -1.0f, 1.0f );
}

// ---- displacements of points ----

// Room for groups of eight, followed by guard values that must not change.
typedef struct walk
{
    _Alignas( 64 ) float before[POINTS + 8][4], now[POINTS + 8][4], way[POINTS + 8][4];
    float common[3];
} walk;

static void fill_walk( void* state, int seed )
{
    walk* w = state;
    for ( int i = 0; i < POINTS + 8; ++i )
    {
        for ( int k = 0; k < 4; ++k )
        {
            w->before[i][k] = chance( seed, 8 * i + k );
            w->now[i][k] = w->before[i][k] + 0.1f * chance( seed, 8 * i + k + 4 );
            w->way[i][k] = -7.0f;
        }
    }
    for ( int k = 0; k < 3; ++k )
    {
        w->common[k] = 0.05f * chance( seed, 5000 + k );
    }
}

static walk make_walk( int seed )
{
    walk w;
    fill_walk( &w, seed );
    return w;
}

static wisp_displacement_args job_of( walk* w )
{
    return ( wisp_displacement_args ){
        .before = w->before[0],
        .now = w->now[0],
        .common_displacement = { w->common[0], w->common[1], w->common[2] },
        .relative_margin = 0.25f,
        .margin = 0.01f,
        .displacement = w->way[0],
    };
}

RUN_KERNEL( take, measure_displacements, wisp_displacement_args, job_of )

static double spare_of( const walk* w, int i )
{
    const double3 path = double3_sub( double3_from( w->now[i] ), double3_from( w->before[i] ) );
    const double beside = double3_distance( path, double3_from( w->common ) );
    return 0.25 * beside + (double)0.01f;
}

static void check_walk( void* start, void* end )
{
    walk *before = start, *w = end;
    for ( int p = 0; p < POINTS + 8; ++p )
    {
        const bool is_queried = p >= 8 && p < POINTS;
        for ( int k = 0; k < 3; ++k )
        {
            assert_true( w->way[p][k] == ( is_queried ? w->now[p][k] - w->before[p][k] : before->way[p][k] ) );
        }
        assert_near( (double)w->way[p][3], is_queried ? spare_of( w, p ) : (double)before->way[p][3], 4.0 * ROUNDING,
                     "spare of", p );
    }
}

TEST_KERNEL( a_way_leads_from_before_to_now_give_or_take_a_share_of_it, walk, SEEDS, 8, POINTS, 8, fill_walk, take,
             check_walk )

// The sum over [8, 8 + count), and whether one is fixed; with an invalid number inside the range, and beyond its end.
static void check_sum( const wisp_kernels* kernels, int seed, int count, bool has_fixed )
{
    static const float WRONG[] = { NAN, INFINITY, -INFINITY, 3e38f, -1.1e6f };
    walk w = make_walk( seed );
    w.now[8 + seed % count][3] = has_fixed ? 0.0f : w.now[8 + seed % count][3];
    w.now[8 + count][0] = 1e5f;
    w.now[8 + count][3] = 0.0f;
    w.now[10][seed % 3] = seed % 2 == 0 ? WRONG[seed / 2 % WISP_COUNT( WRONG )] : w.now[10][seed % 3];
    double found[3], expected[3] = { 0.0, 0.0, 0.0 };
    for ( int i = 8; i < 8 + count; ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const float way = w.now[i][k] - w.before[i][k];
            expected[k] += fabsf( way ) < 1e6f ? (double)way : 0.0;
        }
    }
    const wisp_displacement_args args = job_of( &w );
    assert_true( kernels->sum_displacements( &args, 8, 8 + count, found ) == has_fixed );
    for ( int k = 0; k < 3; ++k )
    {
        assert_near( found[k], expected[k], ROUNDING, "sum of ways, seed", seed );
    }
}

TEST( ways_are_summed_and_who_is_fixed_is_seen )
{
    for ( const wisp_kernels* const* k = every_table(); *k != NULL; ++k )
    {
        for ( int seed = 0; seed < SEEDS; ++seed )
        {
            check_sum( *k, seed, 3 + seed % 29, seed % 3 == 0 );
            check_sum( *k, seed, 3 + seed % 29, seed % 3 != 0 );
        }
    }
}

static void fill_wrong( void* state, int variant )
{
    static const float WRONG[] = { NAN, INFINITY, -INFINITY, 3e38f, 1.1e6f };
    walk* w = state;
    fill_walk( w, variant );
    w->now[11][variant / WISP_COUNT( WRONG ) % 3] = WRONG[variant % WISP_COUNT( WRONG )];
}

static void check_wrong( void* start, void* end )
{
    (void)start;
    walk* w = end;
    assert_true( w->way[11][3] == 0.01f );
    assert_near( (double)w->way[12][3], spare_of( w, 12 ), 4.0 * ROUNDING, "spare beside what is wrong", 12 );
}

TEST_KERNEL( what_is_too_long_or_no_number_adds_nothing, walk, 15, 0, POINTS, 8, fill_wrong, take, check_wrong )

// All points keep their displacements except one, which deviates by this multiple of its limit.
static bool leaves( const wisp_kernels* kernels, int seed, int point, float times, int end )
{
    walk w = make_walk( seed );
    take( kernels, &w, 0, POINTS + 8 );
    const float most = w.way[point][3];
    w.now[point][seed % 3] += times * most;
    const wisp_displacement_args args = job_of( &w );
    return kernels->exceeds_prediction( &args, 0, end );
}

TEST( who_goes_farther_from_its_way_than_it_may_leaves_it )
{
    for ( const wisp_kernels* const* k = every_table(); *k != NULL; ++k )
    {
        for ( int p = 0; p < POINTS; ++p )
        {
            assert_false( leaves( *k, p, p, 0.0f, POINTS ) );
            assert_false( leaves( *k, p, p, 0.999f, POINTS ) );
            assert_true( leaves( *k, p, p, 1.001f, POINTS ) );
            assert_true( leaves( *k, p, p, -1.001f, p + 1 ) );
            assert_false( leaves( *k, p, p, 1.001f, p ) ); // beyond the end
            assert_false( leaves( *k, p, p, NAN, POINTS ) );
        }
    }
}

// ---- separation bounds ----

typedef struct standing
{
    _Alignas( 64 ) float gone[SIDES][4], ways[SIDES][4];
    int32_t first[PAIRS], second[PAIRS], due[PAIRS];
    float slack[PAIRS];
    int due_count, end;
    bool is_gone;
} standing;

static void fill_standing( void* state, int variant )
{
    standing* s = state;
    const int seed = variant / 2;
    s->is_gone = variant % 2 == 0;
    s->end = PAIRS - seed % 8;
    for ( int i = 0; i < SIDES; ++i )
    {
        for ( int k = 0; k < 4; ++k )
        {
            s->gone[i][k] = 0.1f * chance( seed, 8 * i + k );
            s->ways[i][k] = 0.1f * chance( seed, 8 * i + k + 4 );
        }
        s->gone[i][3] = fabsf( s->gone[i][3] );
        s->ways[i][3] = fabsf( s->ways[i][3] );
    }
    for ( int i = 0; i < PAIRS; ++i )
    {
        s->first[i] = ( 7 * i + seed ) % SIDES;
        s->second[i] = ( 5 * i + 3 * seed + i / SIDES ) % SIDES;
        s->slack[i] = 0.4f + 0.4f * chance( seed, 1000 + i );
        s->due[i] = -7;
    }
}

static double closing_of( const float* a, const float* b )
{
    return double3_distance( double3_from( a ), double3_from( b ) ) + (double)a[3] + (double)b[3];
}

static void count_slack( const wisp_kernels* kernels, standing* s, int begin, int end )
{
    const wisp_separation_args args = {
        .moved = s->is_gone ? s->gone[0] : NULL,
        .predicted = s->ways[0],
        .first = s->first,
        .second = s->second,
        .separation_bound = s->slack,
        .active = s->due,
    };
    s->due_count = kernels->find_active_pairs( &args, begin, end );
}

// The bound is lowered by at least the approach of the sides, and hardly more; a pair with less than the possible
// approach is active.
static void check_pair( const standing* before, const standing* found, int pair, int* next )
{
    const bool is_gone = before->is_gone;
    const int a = before->first[pair], b = before->second[pair];
    const double left =
        (double)before->slack[pair] - ( is_gone ? closing_of( before->gone[a], before->gone[b] ) : 0.0 );
    assert_true( (double)found->slack[pair] <= left + ( is_gone ? 0.0 : ROUNDING ) );
    assert_near( (double)found->slack[pair], left, is_gone ? 2e-4 : 0.0, "slack of pair", pair );
    const bool is_due = found->due[*next] == pair;
    const double over = (double)found->slack[pair] - closing_of( before->ways[a], before->ways[b] );
    assert_true( is_due ? over < 2e-4 : over > 0.0 );
    *next += is_due ? 1 : 0;
}

static void run_standing( const wisp_kernels* kernels, void* state, int begin, int end )
{
    standing* s = state;
    count_slack( kernels, s, begin, s->end );
    assert_true( s->end <= end );
    FORGET_BEHIND( s->slack, s->end );
    FORGET_BEHIND( s->due, begin + s->due_count );
}

static int due;

static void check_standing( void* start, void* end )
{
    standing *before = start, *s = end;
    assert_memory_equal( s->slack, before->slack, 8 * sizeof( float ) );
    int next = 8; // what follows the last one is 0, which is no pair of the range
    for ( int pair = 8; pair < s->end; ++pair )
    {
        check_pair( before, s, pair, &next );
    }
    assert_int_equal( next - 8, s->due_count );
    due += s->due_count;
}

TEST( pairs_are_due_that_may_use_up_their_slack )
{
    check_kernel( KERNEL_ROW( standing, 2 * SEEDS, 8, PAIRS, 0, fill_standing, run_standing, check_standing ) );
    assert_in_range( due, SEEDS * 10, 2 * SEEDS * ( PAIRS - 16 ) ); // some are, and not all
}

TEST( who_has_a_slack_or_a_way_that_is_no_number_is_due )
{
    const wisp_kernels* const* k = every_table();
    for ( int i = 0; k[i / 5] != NULL; ++i )
    {
        standing s;
        fill_standing( &s, 2 );
        for ( int pair = 0; pair < PAIRS; ++pair )
        {
            s.slack[pair] = 100.0f;
            s.first[pair] = pair % 7;
            s.second[pair] = 8 + pair % 5;
        }
        s.slack[19] = i % 5 == 0 ? NAN : ( i % 5 == 1 ? -INFINITY : 100.0f );
        s.first[19] = SIDES - 1; // of no other pair
        s.ways[SIDES - 1][2] = i % 5 == 2 ? NAN : 0.0f;
        s.ways[SIDES - 1][3] = i % 5 == 3 ? INFINITY : 0.0f;
        s.gone[SIDES - 1][0] = i % 5 == 4 ? NAN : 0.0f;
        count_slack( k[i / 5], &s, 0, PAIRS - 3 );
        assert_int_equal( s.due_count, 1 );
        assert_int_equal( s.due[0], 19 );
        count_slack( k[i / 5], &s, 0, 19 ); // it is beyond the end, but in the same group of eight
        assert_int_equal( s.due_count, 0 );
    }
}

// ---- pairs of points ----

enum
{
    BALLS = 32,
    BALL_POINTS = 27, // of the packs
    PACKS = 2,
    PACK_PAIRS = 3,
};

typedef struct balls
{
    wisp_point_pack packs[PACKS];
    float start[BALLS][4], now[BALLS][4], push[BALLS][4], shift[BALLS][4], gap[BALLS], friction[BALLS], recovery;
    int32_t point_x4[2][BALLS], count[PACK_PAIRS], strayed;
    uint16_t near[PACKS], presses[PACKS], found[PACK_PAIRS][16];
    wisp_aabb boxes[PACKS];
} balls;

// Each point is in a pair with another, and in a pack.
static void fill_balls( void* state, int variant )
{
    balls* c = state;
    c->recovery = variant % 4 < 2 ? 0.0f : 0.1f;
    for ( int i = 0; i < BALLS; ++i )
    {
        wisp_point_pack* pack = c->packs + i / 16;
        for ( int k = 0; k < 3; ++k )
        {
            c->start[i][k] = test_random_float( variant, 16 * i + k, -1.0f, 1.0f );
            c->now[i][k] = c->start[i][k] + test_random_float( variant, 16 * i + 3 + k, -0.3f, 0.3f );
            pack->rest[k][i % 16] = test_random_float( variant, 16 * i + 6 + k, -0.8f, 0.8f );
        }
        c->point_x4[0][i] = pack->point_x4[i % 16] = 4 * ( i * 5 % BALLS );
        c->point_x4[1][i] = 4 * ( ( i * 5 + 1 + variant % ( BALLS - 1 ) ) % BALLS );
        c->gap[i] = variant % 3 == 0 ? 0.9f : 0.6f;
        c->friction[i] = test_random_float( variant, 16 * i + 9, 0.0f, 1.0f );
        pack->half[i % 16] = test_random_float( variant, 16 * i + 10, 0.0f, 0.2f );
        pack->cover[i % 16] = test_random_float( variant, 16 * i + 11, 0.0f, 0.4f );
        pack->group[i % 16] = (float)( i % 2 );
    }
}

static const float BALLS_COMMON[3] = { 0.3f, -0.2f, 0.1f };

static void push_balls( const wisp_kernels* kernels, void* state, int begin, int end )
{
    balls* c = state;
    const int32_t packs[2][PACK_PAIRS] = { { 0, 0, 1 }, { 0, 1, 1 } };
    wisp_point_pair_args args = { .start = c->start[0],
                                  .now = c->now[0],
                                  .point_x4 = { c->point_x4[0], c->point_x4[1] },
                                  .gap = c->gap,
                                  .friction = c->friction,
                                  .reach = 1.25f,
                                  .recovery = c->recovery,
                                  .found = c->near,
                                  .push = c->push[0],
                                  .shift = c->shift[0] };
    kernels->find_near_pairs( &args, begin, end );
    args.found = c->presses;
    const bool any = kernels->push_points( &args, begin, end );
    assert_true( any == ( c->presses[begin] != 0 || c->presses[end - 1] != 0 ) );
    const wisp_point_list_args list = { .packs = c->packs,
                                        .point_count = BALL_POINTS,
                                        .start = c->start[0],
                                        .now = c->now[0],
                                        .boxes = c->boxes,
                                        .common = { BALLS_COMMON[0], BALLS_COMMON[1], BALLS_COMMON[2] },
                                        .substeps = 2.0f,
                                        .stray_by_gap = 0.1f,
                                        .stray_by_motion = 0.05f,
                                        .largest_cover = 0.4f,
                                        .neighbours = 2.0f,
                                        .first = packs[0],
                                        .second = packs[1],
                                        .found = c->found,
                                        .count = c->count };
    kernels->predict_points( &list, 0, PACKS );
    kernels->list_point_pairs( &list, 0, PACK_PAIRS );
    c->strayed = kernels->count_strayed( &list, 0.1f, 0, PACKS );
}

static int pressing, at_rest, met, apart;

// Find the correction of a pair in doubles. @return whether it presses
static bool correction( const balls* c, int pair, double3* push, double3* shift )
{
    const int a = c->point_x4[0][pair] / 4, b = c->point_x4[1][pair] / 4;
    const double gap = (double)c->gap[pair];
    const double3 before = double3_sub( double3_from( c->start[a] ), double3_from( c->start[b] ) ),
                  after = double3_sub( double3_from( c->now[a] ), double3_from( c->now[b] ) ),
                  motion = double3_sub( after, before );
    const double start = double3_length( before );
    const double3 n = double3_scale( 1.0 / start, before );
    const double now = double3_dot( n, after ), kept = fmin( gap, start ),
                 recovered = fmin( gap, start + (double)c->recovery * gap );
    const double time = fmin( fmax( -double3_dot( before, motion ) / double3_dot( motion, motion ), 0.0 ), 1.0 );
    const double short_by = fmax( kept - now, 0.0 ), left = recovered - fmax( now, kept );
    const double3 slip = double3_add_scaled( motion, start - now, n );
    const double held = fmin( 1.0, (double)c->friction[pair] * short_by / double3_length( slip ) );
    *push = double3_add_scaled( double3_scale( short_by, n ), short_by > 0.0 ? -held : 0.0, slip );
    *shift = double3_scale( left, n );
    return double3_length( double3_add_scaled( before, time, motion ) ) <= gap && now < recovered;
}

typedef struct ball_path
{
    double3 at, motion, rest;
    double stray;
} ball_path;

static ball_path path_of( const balls* c, int i )
{
    const wisp_point_pack* pack = c->packs + i / 16;
    const int lane = i % 16, point = pack->point_x4[lane] / 4;
    const double3 from = double3_from( c->start[point] ),
                  motion = double3_scale( 2.0, double3_sub( double3_from( c->now[point] ), from ) );
    const double keeps = fmax( 2.0 * (double)pack->half[lane], (double)pack->cover[lane] );
    return ( ball_path ){ double3_add_scaled( from, 0.5, motion ), motion,
                          double3_make( (double)pack->rest[0][lane], (double)pack->rest[1][lane],
                                        (double)pack->rest[2][lane] ),
                          0.1 * keeps + 0.05 * double3_distance( motion, double3_from( BALLS_COMMON ) ) };
}

// A listed pair is one whose paths come near, beside neighbours; what is on the border is left out.
static void check_listed( const balls* c, int i, int j )
{
    const ball_path a = path_of( c, i ), b = path_of( c, j );
    const wisp_point_pack *one = c->packs + i / 16, *other = c->packs + j / 16;
    const double gap = fmax( (double)one->half[i % 16] + (double)other->half[j % 16],
                             fmax( (double)one->cover[i % 16], (double)other->cover[j % 16] ) );
    const double3 d = double3_sub( a.at, b.at ), u = double3_sub( a.motion, b.motion );
    const double time = fmin( fmax( -double3_dot( d, u ) / double3_dot( u, u ), -0.5 ), 0.5 );
    const double over = double3_length( double3_add_scaled( d, time, u ) ) - gap - a.stray - b.stray;
    const double beyond =
        one->group[i % 16] == other->group[j % 16] ? double3_distance( a.rest, b.rest ) - 2.0 * gap : 1.0;
    const bool is_found = ( c->found[i / 16 + j / 16][i % 16] >> j % 16 & 1 ) != 0;
    assert_true( is_found == ( over < 0.0 && beyond > 0.0 ) || fabs( over ) < 1e-5 || fabs( beyond ) < 1e-6 );
    met += is_found ? 1 : 0;
    apart += is_found ? 0 : 1;
}

static void check_balls( void* start, void* end )
{
    (void)start;
    const balls* c = end;
    int bits = 0, strayed = 0;
    for ( int i = 0; i < BALLS; ++i )
    {
        double3 push, shift;
        const bool presses = ( c->presses[i / 16] >> i % 16 & 1 ) != 0;
        assert_true( presses == correction( c, i, &push, &shift ) );
        assert_true( presses == false || ( c->near[i / 16] >> i % 16 & 1 ) != 0 );
        // places are rounded to 1e-7, over distances of 0.1
        assert_true( presses == false || double3_distance( double3_from( c->push[i] ), push ) < 1e-5 );
        assert_true( presses == false || c->recovery == 0.0f ||
                     double3_distance( double3_from( c->shift[i] ), shift ) < 1e-5 );
        pressing += presses ? 1 : 0;
        at_rest += presses ? 0 : 1;
        for ( int j = i + 1; j < BALL_POINTS && i < BALL_POINTS; ++j )
        {
            check_listed( c, i, j );
            bits += c->found[i / 16 + j / 16][i % 16] >> j % 16 & 1;
        }
        const ball_path path = path_of( c, i );
        const double3 now = double3_from( c->now[c->packs[i / 16].point_x4[i % 16] / 4] );
        strayed +=
            i < BALL_POINTS && double3_distance( now, double3_add_scaled( path.at, 0.1, path.motion ) ) > path.stray;
    }
    assert_int_equal( bits, c->count[0] + c->count[1] + c->count[2] );
    assert_int_equal( strayed, c->strayed );
}

TEST( pairs_of_points_are_found_and_pushed_apart )
{
    check_kernel( KERNEL_ROW( balls, 4 * SEEDS, 0, PACKS, 0, fill_balls, push_balls, check_balls ) );
    assert_true( pressing > 10 * SEEDS && at_rest > SEEDS && met > 20 * SEEDS && apart > 20 * SEEDS );
}
