// Every kernel table gives the same bits, and the sums through the grid equal those of brute force, bit for bit.
#include "kernels_fixture.h"

#include "frozen_hair.h"
#include "trig.h"
#include "world.h"

#include "wisp/module/space.h"

// ---- whole pipeline ----

enum
{
    STRANDS = 150,
    LONGEST = 23,
};

typedef struct groom
{
    wisp_vec3 points[STRANDS * LONGEST];
    int32_t offsets[STRANDS + 1];
} groom;

// Curly strands of 1 to 23 vertices, dense enough that every vertex of a long one has neighbours.
static void make_groom( groom* g, int dimension )
{
    g->offsets[0] = 0;
    for ( int s = 0; s < STRANDS; ++s )
    {
        int count = 1 + ( s * 7 ) % LONGEST;
        g->offsets[s + 1] = g->offsets[s] + count;
        for ( int i = 0; i < count; ++i )
        {
            float sine, cosine;
            trig_sincos( 0.7f * (float)i + 0.3f * (float)s, &sine, &cosine );
            g->points[g->offsets[s] + i] = ( wisp_vec3 ){
                0.002f * (float)( s % 15 ) + 0.003f * sine,
                -0.01f * (float)i,
                dimension == 3 ? 0.002f * (float)( s / 15 ) + 0.003f * cosine : 0.0f,
            };
        }
    }
}

static uint64_t run_pipeline( const wisp_kernels* kernels, const groom* g, int dimension,
                              const wisp_frozen_hair_def* def )
{
    const wisp_module* modules[] = { &wisp_frozen_hair_module };
    wisp_world_def world_def = wisp_default_world_def();
    world_def.substeps = 1;
    world_def.modules = modules;
    world_def.module_count = 1;
    world_def.workers = 2;
    SCOPED( destroy_local ) wisp_world* world;
    assert_int_equal( wisp_world_create( &world_def, &world, NULL ), WISP_OK );
    world_set_kernels( world, kernels );

    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = g->points;
    strands.offsets = g->offsets;
    strands.strand_count = STRANDS;
    strands.dimension = dimension;
    wisp_entity id;
    assert_int_equal( wisp_add_strands( world, &strands, &id ), WISP_OK );
    assert_int_equal( wisp_set_frozen_hair( world, id, def ), WISP_OK );
    assert_int_equal( wisp_request( world, id, WISP_STRAND_POINTS ), WISP_OK );
    for ( int step = 0; step < 3; ++step )
    {
        wisp_vec3 cursor = { 0.05f, -0.1f - 0.03f * (float)step, 0.0f };
        assert_int_equal( wisp_command_frozen_hair( world, id, cursor ), WISP_OK );
        assert_int_equal( wisp_world_step( world, 0.01f ), WISP_OK );
    }
    uint64_t hash;
    assert_int_equal( wisp_world_hash_column( world, id, WISP_STRAND_POINTS, &hash ), WISP_OK );
    return hash;
}

TEST( every_table_gives_the_same_bits )
{
    SCOPED( free_local ) groom* g = checked_malloc( sizeof( groom ) );
    for ( int dimension = 2; dimension <= 3; ++dimension )
    {
        make_groom( g, dimension );
        for ( int variant = 0; variant < 8; ++variant )
        {
            wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
            def.reach = 0.3f;
            def.gap = (wisp_gap)( variant % 2 );
            def.reach_nearest = variant % 3 == 2;
            def.clump_iterations = 1 + variant;
            def.base = variant == 6 ? WISP_FROZEN_BASE_STROKE : WISP_FROZEN_BASE_REST;
            const wisp_kernels* const* tables = every_table();
            uint64_t reference = run_pipeline( tables[0], g, dimension, &def );
            for ( int t = 1; tables[t] != NULL; ++t )
            {
                if ( run_pipeline( tables[t], g, dimension, &def ) != reference )
                {
                    fail_msg( "%s differs: dimension %d, variant %d", tables[t]->isa, dimension, variant );
                }
            }
        }
    }
}

// ---- the sum of eq. 15 against brute force ----

enum
{
    CLOUD = 1003, // not a multiple of eight
    OWNERS = 60,
};

typedef struct cloud
{
    float xyzw[CLOUD + 8][4];
    int32_t vertex[CLOUD + 8];
} cloud;

static void make_cloud( cloud* c, int dimension, uint64_t seed )
{
    memset( c, 0, sizeof( *c ) );
    wisp_random_key key = wisp_random_make_key( seed, 0, 0 );
    for ( int i = 0; i < CLOUD; ++i )
    {
        int32_t owner = i % OWNERS;
        c->xyzw[i][0] = 0.1f * wisp_random_unit_float( key, (uint32_t)i, 0, 0 );
        c->xyzw[i][1] = 0.1f * wisp_random_unit_float( key, (uint32_t)i, 1, 0 );
        c->xyzw[i][2] = dimension == 3 ? 0.1f * wisp_random_unit_float( key, (uint32_t)i, 2, 0 ) : 0.0f;
        memcpy( &c->xyzw[i][3], &owner, sizeof( owner ) );
        c->vertex[i] = 1 + i / OWNERS;
    }
    memcpy( c->xyzw[77], c->xyzw[3], 3 * sizeof( float ) ); // a pair without a direction
}

// The displacement of one slot by a loop over all slots, with the kernel's own roundings.
static wisp_vec3 brute_force( const float ( *q )[4], const int32_t* owner, int slot, float h, float step )
{
    float inverse_h = 1.0f / h;
    wisp_vec3 force = { 0.0f, 0.0f, 0.0f };
    for ( int j = 0; j < CLOUD; ++j )
    {
        float x = q[j][0] - q[slot][0], y = q[j][1] - q[slot][1], z = q[j][2] - q[slot][2];
        float r = sqrtf( x * x + y * y + z * z );
        if ( owner[j] != owner[slot] && r > 0.0f && r < h )
        {
            float u = 1.0f - r * inverse_h, pull = u * u / r;
            force.x += x * pull;
            force.y += y * pull;
            force.z += z * pull;
        }
    }
    return ( wisp_vec3 ){ force.x * step, force.y * step, force.z * step };
}

typedef struct attraction
{
    wisp_grid grid;
    wisp_neighbours neighbours;
    _Alignas( 64 ) float xyzw[CLOUD + 8][4];
    _Alignas( 64 ) float tentative[CLOUD + 8][4];
    _Alignas( 64 ) float displacement[( CLOUD + 7 ) / 8][3][8];
    int32_t vertex[CLOUD + 8];
} attraction;

static void attract( attraction* a, const wisp_kernels* kernels, const wisp_parallel* parallel, const cloud* c,
                     float h, bool planar )
{
    assert_int_equal( wisp_grid_build( &a->grid, parallel, c->xyzw[0], CLOUD, 1.6f * h, 3 ), WISP_OK );
    memset( a->xyzw, 0, sizeof( a->xyzw ) );
    memset( a->vertex, 0, sizeof( a->vertex ) );
    for ( int slot = 0; slot < CLOUD; ++slot )
    {
        memcpy( a->xyzw[slot], c->xyzw[a->grid.item[slot]], 4 * sizeof( float ) );
        a->vertex[slot] = c->vertex[a->grid.item[slot]];
    }
    wisp_neighbour_query query = {
        .xyzw = a->xyzw[0], .query_count = CLOUD, .near_radius = 1.0001f * h, .skin_radius = 1.6f * h, .limit = 512
    };
    assert_int_equal( wisp_neighbours_build( &a->neighbours, parallel, kernels, &a->grid, &query ), WISP_OK );
    wisp_adhesion_args args = {
        .current = a->xyzw[0],
        .tentative = a->tentative[0],
        .displacement = a->displacement[0][0],
        .search_position = a->xyzw[0],
        .owner = a->grid.owner,
        .vertex = a->vertex,
        .attracting = { a->neighbours.near },
        .attracting_count = 1,
        .radius = h,
        .step = 0.1f * h,
        .distance_min = -1.0f, // the guard limits nothing
        .planar = planar,
        .brakes = true,
    };
    kernels->adhesion_attract( &args, 0, a->neighbours.slice_count );
}

TEST( sums_through_the_grid_are_those_of_brute_force )
{
    const wisp_allocator allocator = { 0 };
    jobs_pool* pool = jobs_create( &allocator, 1, NULL, NULL );
    cloud* c = checked_malloc( sizeof( cloud ) );
    attraction* a = new_aligned( sizeof( attraction ) );
    for ( int round = 0; every_table()[round / 2] != NULL; ++round )
    {
        int dimension = 2 + round % 2;
        float h = dimension == 2 ? 0.006f : 0.015f;
        make_cloud( c, dimension, (uint64_t)round );
        attract( a, every_table()[round / 2], jobs_everyone( pool ), c, h, dimension == 2 );
        for ( int slot = 0; slot < CLOUD; ++slot )
        {
            wisp_vec3 reference = brute_force( (const float( * )[4])a->xyzw, a->grid.owner, slot, h, 0.1f * h );
            float found[3] = { a->displacement[slot / 8][0][slot % 8], a->displacement[slot / 8][1][slot % 8],
                               a->displacement[slot / 8][2][slot % 8] };
            assert_memory_equal( found, &reference, sizeof( reference ) );
        }
    }
    wisp_grid_release( &a->grid, &allocator );
    wisp_neighbours_release( &a->neighbours, &allocator );
    free( a );
    free( c );
    jobs_destroy( pool );
}

TEST( a_cap_names_a_table_at_most_that_wide_or_is_refused )
{
    wisp_error error = { 0 };
    assert_string_equal( kernels_select( "baseline", &error )->isa, "baseline" );
    assert_null( kernels_select( "avx9", &error ) );
    assert_int_equal( error.status, WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, "avx9" ) );

    assert_int_equal( setenv( "WISP_ISA", "baseline", 1 ), 0 );
    assert_string_equal( kernels_select( NULL, &error )->isa, "baseline" );
    assert_int_equal( setenv( "WISP_ISA", "sse9", 1 ), 0 );
    assert_null( kernels_select( NULL, &error ) );
    assert_non_null( strstr( error.message, "WISP_ISA" ) );
    unsetenv( "WISP_ISA" );
}
