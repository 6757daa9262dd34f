// Kernels of sheets as a whole. Bending of plates: the step around the stages against plain loops, moments of angles
// against the oracle. Coarse sheets: the same bits from every table, prolongation by its sums; links and their band are held to the oracle by
// tests/modules/test_cloth_coarse.c. Instances side by side: bit for bit what the kernels of single surfaces
// give, with every table; those are held to the oracle.
#include "kernels_fixture.h"

#include "constraint_oracle.h"

// ---- plates ----

enum
{
    SLICES = 13,
    BEGIN = 1, // slices outside the range must stay as they are
    END = 12,
    SLOTS = 8 * SLICES,
    NUMBERS = 4 * SLOTS,
    MAX_ENTRIES = 6 * SLICES,
};

typedef struct plate
{
    float position[NUMBERS], target[NUMBERS], velocity[NUMBERS], predicted[NUMBERS], impulse[NUMBERS];
    float newer[NUMBERS], older[NUMBERS], least_height[SLOTS];
    int32_t begin[SLICES + 1], other_x4[MAX_ENTRIES][8];
    int16_t near_x4[MAX_ENTRIES][8];
    float weight[MAX_ENTRIES][8];
    float largest;
    int variant;
} plate;

static void fill_random( float* numbers, int count, int seed )
{
    for ( int i = 0; i < count; ++i )
    {
        numbers[i] = test_random_float( i, seed, -1.0f, 1.0f );
    }
}

// Every third particle is pinned, and every second one has a target. Slices have one to six entries.
static void fill_plate( void* state, int variant )
{
    plate* p = state;
    p->variant = variant;
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
    for ( int slice = 0; slice < SLICES; ++slice )
    {
        for ( int i = 8 * p->begin[slice]; i < 8 * p->begin[slice + 1]; ++i )
        {
            p->near_x4[i / 8][i % 8] = (int16_t)( p->other_x4[i / 8][i % 8] - 32 * slice );
        }
    }
}

static wisp_plate_move_args move_args( plate* p )
{
    return ( wisp_plate_move_args ){
        .position = p->position,
        .target = p->variant == 0 ? p->target : p->position,
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

RUN_KERNEL( run_predict, plate_predict, wisp_plate_move_args, move_args )

static void check_predict( void* start, void* end )
{
    plate *before = start, *p = end;
    const float g[3] = { 0.3f, -9.81f, 0.1f };
    for ( int i = 0; i < NUMBERS; ++i )
    {
        const float *x = p->position + i / 4 * 4, *t = p->target + i / 4 * 4;
        const int k = i % 4;
        const bool is_inside = i >= 32 * BEGIN && i < 32 * END;
        float expected = is_inside ? x[k] : before->predicted[i];
        if ( is_inside && k < 3 && x[3] != 0.0f )
        {
            expected = x[k] + 0.013f * ( p->velocity[i] + 0.013f * g[k] );
        }
        else if ( is_inside && k < 3 && p->variant == 0 && t[3] != 0.0f )
        {
            expected = x[k] + 0.4f * ( t[k] - x[k] );
        }
        assert_memory_equal( p->predicted + i, &expected, sizeof( float ) );
        assert_true( p->impulse[i] == ( is_inside ? 0.0f : before->impulse[i] ) );
    }
}

TEST_KERNEL( particles_go_where_gravity_or_targets_lead, plate, 2, BEGIN, END, 1, fill_plate, run_predict,
             check_predict )

static void run_stage( const wisp_kernels* kernels, void* state, int begin, int end )
{
    plate* p = state;
    wisp_plate_args args = {
        .rows = { SLICES, p->begin, (const int32_t( * )[8])p->other_x4, (const float( * )[8])p->weight, NULL },
        .position = p->position,
        .impulse = p->impulse,
        .newer = p->newer,
        .older = p->older,
        .rate = 0.3f,
        .momentum = 0.7f,
        .gain = 0.9f,
    };
    if ( p->variant == 2 )
    {
        args.rows.other_x4 = NULL;
        args.rows.near_x4 = (const int16_t( * )[8])p->near_x4;
    }
    ( p->variant != 1 ? kernels->plate_stage : kernels->plate_begin )( &args, begin, end );
}

static void check_stage( void* start, void* end )
{
    plate *before = start, *p = end;
    for ( int i = 0; i < NUMBERS; ++i )
    {
        const int row = i / 4, k = i % 4, slice = row / 8;
        float sum = 0.0f, y = before->newer[i], weight = p->position[4 * row + 3];
        for ( int entry = p->begin[slice]; entry < p->begin[slice + 1]; ++entry )
        {
            sum += p->weight[entry][row % 8] * ( y - before->newer[p->other_x4[entry][row % 8] + k] );
        }
        const float b = before->impulse[i] + -0.3f * sum, further = y + 0.7f * ( y - before->older[i] );
        const bool is_inside = i >= 32 * BEGIN && i < 32 * END, begins = is_inside && p->variant == 1;
        const float older = k < 3 && begins == false ? further + 0.9f * weight * b : 0.0f;
        assert_true( p->older[i] == ( is_inside ? older : before->older[i] ) );
        assert_true( p->newer[i] == ( begins ? 0.9f * weight * before->impulse[i] : y ) );
    }
}

TEST_KERNEL( stages_are_those_of_a_plain_loop, plate, 3, BEGIN, END, 1, fill_plate, run_stage, check_stage )

// What is not a number, or lies in no triangle, does not count.
static void fill_moves( void* state, int variant )
{
    plate* p = state;
    fill_plate( p, variant );
    p->newer[32 * BEGIN + 5] = variant == 0 ? NAN : 0.5f;
    p->newer[0] = p->newer[32 * END] = 1e6f;
}

static void run_moves( const wisp_kernels* kernels, void* state, int begin, int end )
{
    plate* p = state;
    const wisp_plate_move_args args = move_args( p );
    p->largest = fmaxf( p->largest, kernels->plate_largest_move( &args, begin, end ) );
    assert_true( kernels->plate_largest_move( &args, begin, begin ) == 0.0f );
    if ( p->variant == 1 )
    {
        kernels->plate_accelerate( &args, begin, end );
    }
}

static void check_moves( void* start, void* end )
{
    plate *before = start, *p = end;
    float expected = 0.0f;
    for ( int i = 0; i < NUMBERS; ++i )
    {
        const float *y = p->newer + i / 4 * 4, least = p->least_height[i / 4], change = 0.6f * p->newer[i] / 0.013f;
        const bool is_inside = i >= 32 * BEGIN && i < 32 * END;
        const float square = ( y[0] * y[0] + y[1] * y[1] + y[2] * y[2] ) / ( least * least );
        expected = is_inside ? fmaxf( expected, square ) : expected;
        assert_true( p->velocity[i] ==
                     ( is_inside && p->variant == 1 ? before->velocity[i] + change : before->velocity[i] ) );
    }
    assert_true( p->largest == expected );
}

TEST_KERNEL( moves_are_measured_and_become_velocities, plate, 2, BEGIN, END, 1, fill_moves, run_moves, check_moves )

// ---- moments of angles ----

enum
{
    TURN_ENTRIES = 5 * GROUPS,
};

typedef struct moments
{
    constraints s;
    int32_t begin[GROUPS + 1], other[TURN_ENTRIES][8];
    uint16_t near[TURN_ENTRIES][8];
    float weight[TURN_ENTRIES][8], steepest[CONSTRAINTS], angle[CONSTRAINTS];
    float moment[CONSTRAINTS + 1];
    int32_t corner_x4[2 * GROUPS][3][8], moment_of[2 * GROUPS][3][8]; // sides of the hinges of a group
    _Alignas( 64 ) float impulse[BODIES][4];
    bool is_tangled, is_near;
} moments;

// The triangles (i, j, k) and (j, i, l) of each hinge, which has its moment opposite to k and l.
static void fill_triangles( moments* m )
{
    for ( int i = 0; i < 6 * CONSTRAINTS; ++i )
    {
        const int side = i / 24 % 2, k = i / 8 % 3, c = i / 48 * 8 + i % 8;
        const int corner = k == 2 ? 2 + side : ( k + side ) % 2;
        m->corner_x4[i / 24][k][i % 8] = m->s.slot_x4[c / 8][corner][c % 8];
        m->moment_of[i / 24][k][i % 8] = k == 2 ? c : CONSTRAINTS;
    }
}

// Groups have none to four entries, the first of them the own hinge. Every second hinge is steep: its moment gives way. Groups that share particles add
// up, in their order.
static void fill_moments( void* state, int variant )
{
    moments* m = state;
    make_constraints( &m->s, true );
    m->is_tangled = variant == 1;
    m->is_near = variant > 0;
    if ( m->is_tangled )
    {
        tangle( &m->s );
    }
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
        m->steepest[c] = c % 2 == 0 ? 1e6f : 0.5f;
        if ( m->begin[c / 8] < m->begin[c / 8 + 1] )
        {
            m->other[m->begin[c / 8]][c % 8] = c;
            m->weight[m->begin[c / 8]][c % 8] = test_random_float( c, 32, 0.5f, 2.0f );
        }
    }
    for ( int i = 0; i < 8 * TURN_ENTRIES; ++i )
    {
        m->near[i / 8][i % 8] = (uint16_t)m->other[i / 8][i % 8];
    }
    fill_random( m->impulse[0], 4 * BODIES, 33 );
    fill_triangles( m );
}

static void run_moments( const wisp_kernels* kernels, void* state, int begin, int end )
{
    moments* m = state;
    const wisp_plate_angle_args args = {
        .turns = { .begin = m->begin,
                   .other = m->is_near ? NULL : (const int32_t( * )[8])m->other,
                   .near = m->is_near ? (const uint16_t( * )[8])m->near : NULL,
                   .weight = (const float( * )[8])m->weight,
                   .steepest = m->steepest,
                   .corner_x4 = m->corner_x4[0][0],
                   .moment_of = m->moment_of[0][0] },
        .slot_x4 = m->s.slot_x4[0][0],
        .rest = m->s.angle,
        .position = m->s.position[0],
        .angle = m->angle,
        .moment = m->moment,
        .impulse = m->impulse[0],
        .rate = 0.2f,
    };
    kernels->plate_measure_angles( &args, 0, CONSTRAINTS );
    kernels->plate_couple_angles( &args, 0, CONSTRAINTS );
    kernels->plate_add_moments( &args, 2 * begin, 2 * end );
}

// The kernel's angle is positive where the oracle's is negative.
static void expect_moment( moments* m, const moments* before, int c )
{
    double3 p[4], gradient[4];
    double weight[4], moment = 0.0, own = 0.0, steep = 0.0, sum = 0.0;
    for ( int k = 0; k < 4; ++k )
    {
        p[k] = double3_from( body( &m->s, c, k ) );
        weight[k] = (double)body( &m->s, c, k )[3];
    }
    const constraint_oracle_term term = constraint_oracle_dihedral( p, -(double)m->s.angle[c] );
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
        own += m->other[entry][c % 8] == c ? (double)m->weight[entry][c % 8] : 0.0;
    }
    const double within = fmin( (double)m->steepest[c] / steep, 1.0 );
    moment /= 1.0 + 8.0 * 0.2 * own * sum * ( 1.0 - within );
    for ( int k = 0; k < 4; ++k )
    {
        const int slot = m->s.slot_x4[c / 8][k][c % 8] / 4;
        const bool runs = c >= 8 && c < CONSTRAINTS - 8;
        const double3 added = double3_sub( double3_from( m->impulse[slot] ), double3_from( before->impulse[slot] ) );
        const double3 expected = double3_scale( runs ? moment : 0.0, gradient[k] );
        const double tolerance = 1e-5 * ( 1.0 + double3_length( expected ) );
        assert_near_vector( added, expected, tolerance, "impulse of hinge", c );
        assert_true( m->impulse[slot][3] == before->impulse[slot][3] );
    }
}

static void check_moments( void* start, void* end )
{
    moments* m = end;
    for ( int c = 0; c < CONSTRAINTS && m->is_tangled == false; ++c )
    {
        expect_moment( m, start, c );
    }
}

TEST_KERNEL( moments_act_along_the_gradients_of_their_angles, moments, 3, 8, CONSTRAINTS - 8, 8, fill_moments,
             run_moments, check_moments )

// ---- coarse sheets ----

enum
{
    LINKS = 256,
    ROWS = 2 * LINKS, // every link has its own
    CHAIN = 4,        // vertices of a chain
    LINK_SLOTS = CHAIN * LINKS,
    FINER = 128, // rows that follow
};

typedef struct batch
{
    _Alignas( 64 ) float position[ROWS][4], start[ROWS][4], particle[LINK_SLOTS][4];
    int32_t a_x4[LINKS], b_x4[LINKS], chain_begin[LINKS / 8 + 1], chain_x4[LINKS / 8 * CHAIN][8];
    float rest[LINKS], compliance[LINKS], lower[LINKS], lambda[LINKS], factor[LINKS], chain_rest[LINKS];
    _Alignas( 64 ) float target[FINER][4], value[ROWS][4];
    int32_t parent_x4[FINER / 8][WISP_FABRIC_PARENTS][8];
    float weight[FINER / 8][WISP_FABRIC_PARENTS][8];
} batch;

static void put( float* quad, int item, int first, float w )
{
    for ( int k = 0; k < 3; ++k )
    {
        quad[k] = test_random_float( item, first + k, -1.0f, 1.0f );
    }
    quad[3] = w;
}

static void fill_batch( void* state, int seed )
{
    batch* s = state;
    for ( int i = 0; i < LINKS; ++i )
    {
        put( s->position[2 * i], i + 1000 * seed, 0, i % 7 == 0 ? 0.0f : 0.5f * (float)( i % 5 + 1 ) );
        put( s->position[2 * i + 1], i + 1000 * seed, 3, i % 14 == 0 ? 0.0f : 1.5f );
        s->a_x4[i] = 8 * i;
        s->b_x4[i] = 8 * i + 4;
        s->rest[i] = test_random_float( i + 1000 * seed, 6, 0.3f, 2.5f );
        s->lower[i] = s->rest[i] * test_random_float( i + 1000 * seed, 7, 0.7f, 1.0f );
        s->compliance[i] = i % 3 == 0 ? 0.0f : 1e-3f;
        s->chain_rest[i] = s->rest[i] * test_random_float( i + 1000 * seed, 8, 1.0f, 1.3f );
        for ( int e = 0; e < CHAIN; ++e )
        {
            put( s->particle[CHAIN * i + e], i + 1000 * seed, 10 + 3 * e, 1.0f );
            for ( int k = 0; k < 3; ++k )
            {
                s->particle[CHAIN * i + e][k] *= 0.3f;
            }
            s->chain_x4[i / 8 * CHAIN + e][i % 8] = 4 * ( CHAIN * i + e );
        }
        s->chain_begin[i / 8 + 1] = ( i / 8 + 1 ) * CHAIN;
    }
    for ( int r = 0; r < ROWS; ++r )
    {
        put( s->value[r], r, 30, 0.0f );
        put( s->start[r], r + 1000 * seed, 50, 1.0f );
    }
    for ( int i = 0; i < FINER; ++i )
    {
        put( s->target[i], i + 1000 * seed, 40, i % 5 == 0 ? 0.0f : 2.0f );
        for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
        {
            s->parent_x4[i / 8][k][i % 8] = 4 * ( ( i * 5 + k * 17 ) % ROWS );
            s->weight[i / 8][k][i % 8] = i / 8 == 3 && k == 2 ? 0.0f : 0.25f * (float)( k == 0 ? 2 : 1 );
        }
    }

    // ends on each other
    memcpy( s->position[2 * 9 + 1], s->position[2 * 9], 3 * sizeof( float ) );
}

static wisp_level_link_args level_args( batch* s )
{
    return ( wisp_level_link_args ){
        .position = s->position[0],
        .a_x4 = s->a_x4,
        .b_x4 = s->b_x4,
        .rest = s->rest,
        .compliance = s->compliance,
        .lower = s->lower,
        .lambda = s->lambda,
        .factor = s->factor,
        .inverse_dt2 = 3600.0f,
        .relaxation = 1.5f,
        .start = s->start[0],
        .held = 0.05f,
        .particle = s->particle[0],
        .chain_begin = s->chain_begin,
        .chain_x4 = (const int32_t( * )[8])s->chain_x4,
        .chain_rest = s->chain_rest,
    };
}

RUN_KERNEL( run_band, level_band, wisp_level_link_args, level_args )

TEST_KERNEL( bands_of_links_have_the_same_bits, batch, 3, 0, LINKS, 8, fill_batch, run_band, NULL )

static void run_links( const wisp_kernels* kernels, void* state, int begin, int end )
{
    const wisp_level_link_args args = level_args( state );
    kernels->level_prepare( &args, begin, end );
    for ( int pass = 0; pass < 3; ++pass )
    {
        kernels->level_link( &args, begin, end );
    }
}

TEST_KERNEL( coarse_links_have_the_same_bits, batch, 3, 0, LINKS, 8, fill_batch, run_links, NULL )

static void run_prolong( const wisp_kernels* kernels, void* state, int begin, int end )
{
    batch* s = state;
    const wisp_prolong_args args = { s->target[0], s->target[0], s->value[0], s->parent_x4[0][0], s->weight[0][0] };
    kernels->prolong( &args, begin, end );
}

static void check_prolong( void* begun, void* end )
{
    batch *start = begun, *s = end;
    for ( int i = 0; i < 4 * FINER; ++i )
    {
        const int row = i / 4, k = i % 4;
        const bool follows = start->target[row][3] > 0.0f;
        double expected = (double)start->target[row][k];
        for ( int p = 0; p < WISP_FABRIC_PARENTS && follows; ++p )
        {
            expected +=
                (double)s->weight[row / 8][p][row % 8] * (double)s->value[s->parent_x4[row / 8][p][row % 8] / 4][k];
        }
        assert_near( (double)s->target[row][k], expected, follows ? 4.0 * FLT_EPSILON : 0.0, "row", row );
    }
}

TEST_KERNEL( rows_follow_their_parents_unless_they_are_pinned, batch, 3, 0, FINER / 8, 1, fill_batch, run_prolong,
             check_prolong )

// ---- instances ----

enum
{
    LANES = WISP_INSTANCE_LANES,
    PARTICLES = 40, // the last one is the dummy that pads
    DUMMY = PARTICLES - 1,
    SHEET_LINKS = 24, // three groups; the last lanes of each pad
    PADS = 3,
    SUBSTEPS = 3,
};

static const float ALIKE[2] = { 0.2f, 0.7f }; // of edges and bend links

// Sixteen surfaces, and memory for their lanes.
typedef struct surfaces
{
    _Alignas( 64 ) float position[LANES][PARTICLES][4];
    float velocity[LANES][PARTICLES][4], previous[LANES][PARTICLES][4];
    _Alignas( 64 ) float memory[10][PARTICLES][LANES];
    int32_t a_x4[SHEET_LINKS], b_x4[SHEET_LINKS];
    uint8_t bends[SHEET_LINKS / 8 + 3];
    float rest[SHEET_LINKS], material[SHEET_LINKS], area[PARTICLES];
    bool compliant, alike;
} surfaces;

static void place_particle( surfaces* s, int surface, int particle )
{
    for ( int k = 0; k < 3; ++k )
    {
        const int number = ( surface * PARTICLES + particle ) * 8 + k;
        s->position[surface][particle][k] = test_random_float( number, 0, -1.0f, 1.0f );
        s->velocity[surface][particle][k] = test_random_float( number, 1, -3.0f, 3.0f );
    }
    s->position[surface][particle][3] = particle == DUMMY || ( particle + surface ) % 7 == 0 ? 0.0f : 2.0f;
}

static void fill_surfaces( void* state, int variant )
{
    surfaces* s = state;
    s->compliant = variant % 2 == 1;
    s->alike = variant >= 2;
    for ( int i = 0; i < LANES * PARTICLES; ++i )
    {
        place_particle( s, i / PARTICLES, i % PARTICLES );
    }
    for ( int i = 0; i < PARTICLES; ++i )
    {
        s->area[i] = i == DUMMY ? 0.0f : 0.5f;
    }
    s->position[3][DUMMY][1] = -0.0f;
    memcpy( s->position[5][1], s->position[5][0], sizeof( s->position[5][0] ) ); // a link of length 0
    for ( int link = 0; link < SHEET_LINKS; ++link )
    {
        const bool pads = link % 8 >= 8 - PADS;
        const int a = ( 2 * ( link % 8 ) + 5 * ( link / 8 ) ) % DUMMY;
        s->a_x4[link] = 4 * ( pads ? DUMMY : a );
        s->b_x4[link] = 4 * ( pads ? DUMMY : a + 1 );
        s->bends[link / 8] = link < 8 ? 0 : 0xff >> PADS;
        s->rest[link] = pads ? 0.0f : test_random_float( link, 2, 0.2f, 0.8f );
        s->material[link] = pads ? 0.0f : s->alike ? ALIKE[link >= 8] : test_random_float( link, 3, 0.1f, 0.9f );
    }
}

static wisp_instances_args args_of( surfaces* s )
{
    wisp_instances_args args = {
        .slot_count = PARTICLES,
        .area = s->area,
        .position = s->memory[0][0],
        .velocity = s->memory[4][0],
        .previous = s->memory[7][0],
        .position_column = s->position[0][0],
        .velocity_column = s->velocity[0][0],
        .previous_column = s->previous[0][0],
        .dt = 0.004f,
        .accelerates = true,
        .damps = true,
        .link_count = SHEET_LINKS,
        .a_x4 = s->a_x4,
        .b_x4 = s->b_x4,
        .bends = s->bends,
        .rest = s->rest,
        .is_compliant = s->compliant,
        .own = s->alike ? NULL : s->material,
        .alike = { ALIKE[0], ALIKE[1] },
        .inverse_dt2 = 1.0f / ( 0.004f * 0.004f ),
    };
    for ( int l = 0; l < LANES; ++l )
    {
        args.offset[l] = 4 * PARTICLES * l;
        args.keep[l] = 1.0f - 0.01f * (float)l;
        args.acceleration[LANES + l] = -9.81f - (float)l;
    }
    return args;
}

// What the kernels of single surfaces make of one.
static void move_alone( surfaces* s, const wisp_kernels* k, const wisp_instances_args* all, int lane )
{
    const wisp_particle_args particles = { .position = s->position[lane][0],
                                           .previous = s->previous[lane][0],
                                           .velocity = s->velocity[lane][0],
                                           .dt = all->dt,
                                           .acceleration = { 0.0f, all->acceleration[LANES + lane], 0.0f } };
    const wisp_link_args links = { .position = s->position[lane][0],
                                   .a_x4 = s->a_x4,
                                   .b_x4 = s->b_x4,
                                   .rest = s->rest,
                                   .own = s->material,
                                   .bends = s->bends,
                                   .inverse_dt2 = all->inverse_dt2 };
    for ( int i = 0; i < SUBSTEPS; ++i )
    {
        k->accelerate( &particles, 0, PARTICLES );
        k->predict( &particles, 0, PARTICLES );
        ( all->is_compliant ? k->link_xpbd : k->link_pbd )( &links, 0, SHEET_LINKS );
        k->velocity( &particles, 0, PARTICLES );
        for ( int n = 0; n < 4 * PARTICLES; ++n )
        {
            particles.velocity[n] *= all->keep[lane];
        }
    }
}

static const uint32_t MOVED = 0xff6fu; // two are left as they were

static void move_together( const wisp_kernels* k, void* state, int begin, int end )
{
    surfaces* s = state;
    const wisp_instances_args args = args_of( s );
    uint32_t pinned = 0;
    for ( int i = 0; i < LANES * DUMMY; ++i )
    {
        pinned |= s->position[i / DUMMY][i % DUMMY][3] == 0.0f ? 1u << i / DUMMY : 0;
    }
    assert_int_equal( k->instances_load( &args ), pinned );
    for ( int i = begin; i < end; ++i )
    {
        assert_int_equal( k->instances_advance( &args, i > 0, true ), 0 );
        k->instances_link( &args, false );
    }
    assert_int_equal( k->instances_advance( &args, true, false ), 0 );
    k->instances_store( &args, MOVED );
}

static void check_together( void* start, void* end )
{
    surfaces *alone = start, *together = end;
    const wisp_instances_args args = args_of( alone );
    for ( int lane = 0; lane < LANES; ++lane )
    {
        if ( ( MOVED >> lane & 1 ) != 0 )
        {
            move_alone( alone, widest_table(), &args, lane );
        }
    }
    assert_memory_equal( together->position, alone->position, sizeof( alone->position ) );
    assert_memory_equal( together->velocity, alone->velocity, sizeof( alone->velocity ) );
    assert_memory_equal( together->previous, alone->previous, sizeof( alone->previous ) );
}

TEST_KERNEL( surfaces_side_by_side_have_the_bits_that_each_has_alone, surfaces, 4, 0, SUBSTEPS, 0, fill_surfaces,
             move_together, check_together )

TEST( lanes_that_fold_or_lose_their_numbers_are_named )
{
    static surfaces s;
    for ( const wisp_kernels* const* k = every_table(); *k != NULL; ++k )
    {
        memset( &s, 0, sizeof( s ) );
        fill_surfaces( &s, 0 );
        for ( int link = 0; link < SHEET_LINKS; ++link )
        {
            s.rest[link] = 1e-3f; // none is short
        }
        s.rest[8] = 0.5f; // the first bend link
        for ( int lane = 0; lane < LANES; ++lane )
        {
            float *a = s.position[lane][s.a_x4[8] / 4], *b = s.position[lane][s.b_x4[8] / 4];
            a[3] = b[3] = 0.0f; // no other link moves it
            b[0] = a[0] + ( lane == 6 || lane == 11 ? 0.2f : 0.4f );
            b[1] = a[1];
            b[2] = a[2];
        }
        s.velocity[9][2][1] = NAN;
        s.position[9][2][3] = 1.0f;
        const wisp_instances_args args = args_of( &s );
        ( *k )->instances_load( &args );
        assert_int_equal( ( *k )->instances_link( &args, true ), 1u << 6 | 1u << 11 );
        assert_int_equal( ( *k )->instances_link( &args, false ), 0 );
        assert_int_equal( ( *k )->instances_advance( &args, false, true ), 0 );
        assert_int_equal( ( *k )->instances_advance( &args, true, false ), 1u << 9 );
    }
}
