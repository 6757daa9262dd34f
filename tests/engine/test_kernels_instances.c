// Kernels of instances side by side: bit for bit what the kernels of single surfaces give, with every table. Those
// are held to the oracle.
#include "kernels_fixture.h"

enum
{
    LANES = WISP_INSTANCE_LANES,
    PARTICLES = 40, // the last one is the dummy that pads
    DUMMY = PARTICLES - 1,
    LINKS = 24, // three groups; the last lanes of each pad
    PADS = 3,
    SUBSTEPS = 3,
};

// Sixteen surfaces, and memory for their lanes.
typedef struct surfaces
{
    _Alignas( 64 ) float position[LANES][PARTICLES][4];
    float velocity[LANES][PARTICLES][4], previous[LANES][PARTICLES][4];
    _Alignas( 64 ) float memory[10][PARTICLES][LANES];
    int32_t a_x4[LINKS], b_x4[LINKS], constraint[LINKS];
    float rest[LINKS], material[LINKS];
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

static void make_surfaces( surfaces* s )
{
    memset( s, 0, sizeof( *s ) );
    for ( int i = 0; i < LANES * PARTICLES; ++i )
    {
        place_particle( s, i / PARTICLES, i % PARTICLES );
    }
    s->position[3][DUMMY][1] = -0.0f;
    memcpy( s->position[5][1], s->position[5][0], sizeof( s->position[5][0] ) ); // a link of length 0
    for ( int link = 0; link < LINKS; ++link )
    {
        const bool pads = link % 8 >= 8 - PADS;
        const int a = ( 2 * ( link % 8 ) + 5 * ( link / 8 ) ) % DUMMY;
        s->a_x4[link] = 4 * ( pads ? DUMMY : a );
        s->b_x4[link] = 4 * ( pads ? DUMMY : a + 1 );
        s->constraint[link] = pads ? -1 : link;
        s->rest[link] = pads ? 0.0f : test_random_float( link, 2, 0.2f, 0.8f );
        s->material[link] = pads ? 0.0f : test_random_float( link, 3, 0.1f, 0.9f );
    }
}

static wisp_instances_args args_of( surfaces* s, bool compliant )
{
    wisp_instances_args args = {
        .slot_count = PARTICLES,
        .position = s->memory[0][0],
        .velocity = s->memory[4][0],
        .previous = s->memory[7][0],
        .position_column = s->position[0][0],
        .velocity_column = s->velocity[0][0],
        .previous_column = s->previous[0][0],
        .dt = 0.004f,
        .accelerates = true,
        .damps = true,
        .link_count = LINKS,
        .a_x4 = s->a_x4,
        .b_x4 = s->b_x4,
        .constraint = s->constraint,
        .rest = s->rest,
        .stiffness = compliant ? NULL : s->material,
        .compliance = compliant ? s->material : NULL,
        .inverse_dt2 = 1.0f / ( 0.004f * 0.004f ),
        .edge_count = 8,
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
                                   .stiffness = s->material,
                                   .compliance = s->material,
                                   .inverse_dt2 = all->inverse_dt2 };
    for ( int i = 0; i < SUBSTEPS; ++i )
    {
        k->accelerate( &particles, 0, PARTICLES );
        k->predict( &particles, 0, PARTICLES );
        ( all->stiffness != NULL ? k->link_pbd : k->link_xpbd )( &links, 0, LINKS );
        k->velocity( &particles, 0, PARTICLES );
        for ( int n = 0; n < 4 * PARTICLES; ++n )
        {
            particles.velocity[n] *= all->keep[lane];
        }
    }
}

static void move_together( const wisp_kernels* k, const wisp_instances_args* args, uint32_t lanes )
{
    k->instances_load( args );
    for ( int i = 0; i < SUBSTEPS; ++i )
    {
        assert_int_equal( k->instances_advance( args, i > 0, true ), 0 );
        k->instances_link( args, false );
    }
    assert_int_equal( k->instances_advance( args, true, false ), 0 );
    k->instances_store( args, lanes );
}

TEST( surfaces_side_by_side_have_the_bits_that_each_has_alone )
{
    static surfaces together, alone;
    const uint32_t lanes = 0xff6fu; // two are left as they were
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int i = 0; i < 2 * count; ++i )
    {
        make_surfaces( &together );
        make_surfaces( &alone );
        const wisp_instances_args args = args_of( &together, i % 2 == 1 );
        move_together( tables[i / 2], &args, lanes );
        for ( int lane = 0; lane < LANES; ++lane )
        {
            if ( ( lanes >> lane & 1 ) != 0 )
            {
                move_alone( &alone, tables[i / 2], &args, lane );
            }
        }
        assert_memory_equal( together.position, alone.position, sizeof( alone.position ) );
        assert_memory_equal( together.velocity, alone.velocity, sizeof( alone.velocity ) );
        assert_memory_equal( together.previous, alone.previous, sizeof( alone.previous ) );
    }
}

TEST( lanes_that_fold_or_lose_their_numbers_are_named )
{
    static surfaces s;
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int i = 0; i < count; ++i )
    {
        make_surfaces( &s );
        for ( int link = 0; link < LINKS; ++link )
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
        const wisp_instances_args args = args_of( &s, false );
        tables[i]->instances_load( &args );
        assert_int_equal( tables[i]->instances_link( &args, true ), 1u << 6 | 1u << 11 );
        assert_int_equal( tables[i]->instances_link( &args, false ), 0 );
        assert_int_equal( tables[i]->instances_advance( &args, false, true ), 0 );
        assert_int_equal( tables[i]->instances_advance( &args, true, false ), 1u << 9 );
    }
}
