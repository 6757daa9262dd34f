// Kernels over particles: rings against the oracle in double precision, time integration exactly as in scalar code,
// tethers by their properties; drag on vertices and air on the triangles around them agree with formulas in doubles.
#include "kernels_fixture.h"

#include "balloon_meshes.h"
#include "constraint_oracle.h"
#include "double3.h"

#include "wisp/fabric.h"

static void* new_aligned( size_t size )
{
    void* memory = aligned_alloc( 64, ( size + 63 ) / 64 * 64 );
    assert_non_null( memory );
    memset( memory, 0, size );
    return memory;
}

// ---- rings ----

enum
{
    BLOCK = 64, // slices whose sum a kernel keeps in floats
};

typedef struct ball
{
    balloon_mesh mesh;
    wisp_fabric* fabric;
    float ( *position )[4];
    float ( *gradient )[3][8];
    float ( *area )[8];
} ball;

// About `centre`, with inverse masses 1 .. 4. Positions of the mesh are rounded to the kernel's floats.
static ball make_ball( float radius, wisp_vec3 centre )
{
    ball b = { 0 };
    assert_true( balloon_mesh_icosphere( &b.mesh, 3, (double)radius ) );
    wisp_vec3* points = checked_calloc( (size_t)b.mesh.vertex_count, sizeof( wisp_vec3 ) );
    for ( int i = 0; i < b.mesh.vertex_count; ++i )
    {
        double3* p = b.mesh.positions + i;
        points[i] = ( wisp_vec3 ){ centre.x + (float)p->x, centre.y + (float)p->y, centre.z + (float)p->z };
        *p = double3_make( (double)points[i].x, (double)points[i].y, (double)points[i].z );
    }
    wisp_fabric_def def = wisp_default_fabric_def();
    def.points = points;
    def.triangles = b.mesh.triangles;
    def.vertex_count = b.mesh.vertex_count;
    def.triangle_count = b.mesh.triangle_count;
    assert_int_equal( wisp_fabric_cook( &def, NULL, &b.fabric, NULL ), WISP_OK );
    free( points );

    size_t slices = (size_t)b.fabric->ring_slice_count;
    assert_true( b.fabric->ring_slice_count > BLOCK );
    b.position = new_aligned( slices * 8 * sizeof( *b.position ) );
    b.gradient = new_aligned( slices * sizeof( *b.gradient ) );
    b.area = new_aligned( slices * sizeof( *b.area ) );
    for ( int slot = 0; slot < b.fabric->slot_count; ++slot )
    {
        const wisp_vec3 p = b.fabric->rest[slot];
        bool dummy = b.fabric->slot_vertex[slot] < 0;
        const float quad[4] = { p.x, p.y, p.z, dummy ? 0.0f : (float)( 1 + slot % 4 ) };
        memcpy( b.position[slot], quad, sizeof( quad ) );
    }
    return b;
}

static void release_ball( ball* b )
{
    wisp_fabric_release( b->fabric );
    balloon_mesh_destroy( &b->mesh );
    free( b->position );
    free( b->gradient );
    free( b->area );
}

static wisp_ring_args ring_args( ball* b, wisp_vec3 origin )
{
    return ( wisp_ring_args ){
        .position = b->position[0],
        .ring_begin = b->fabric->ring_begin,
        .ring_x4 = b->fabric->ring_x4,
        .origin = origin,
        .gradient = b->gradient[0][0],
        .area = b->area[0],
    };
}

static double3 column_of( float rows[3][8], int lane )
{
    return double3_make( (double)rows[0][lane], (double)rows[1][lane], (double)rows[2][lane] );
}

TEST( volume_and_area_of_a_ball_are_those_of_the_oracle )
{
    const wisp_vec3 centre = { 3000.0f, -2000.0f, 10000.0f };
    ball b = make_ball( 0.7f, centre );
    wisp_ring_args args = ring_args( &b, centre );
    wisp_ring_sums sums;
    widest_table()->ring_gradient( &args, 0, b.fabric->ring_slice_count, &sums );

    // a lane adds the terms of 64 slices in floats, and each addition rounds once
    const double sum_rounding = BLOCK * (double)FLT_EPSILON;
    double volume = constraint_oracle_volume( b.mesh.positions, b.mesh.triangles, b.mesh.triangle_count );
    assert_near( sums.volume, volume, sum_rounding * volume, "volume", 0 );

    double3* gradient = calloc( (size_t)b.mesh.vertex_count, sizeof( double3 ) );
    double* area = calloc( (size_t)b.mesh.vertex_count, sizeof( double ) );
    assert_true( gradient != NULL && area != NULL );
    constraint_oracle_volume_gradient( b.mesh.positions, b.mesh.vertex_count, b.mesh.triangles, b.mesh.triangle_count,
                                       gradient );
    for ( int t = 0; t < b.mesh.triangle_count; ++t )
    {
        const int* corner = b.mesh.triangles + 3 * t;
        const double3* p = b.mesh.positions;
        double3 cross =
            double3_cross( double3_sub( p[corner[1]], p[corner[0]] ), double3_sub( p[corner[2]], p[corner[0]] ) );
        for ( int k = 0; k < 3; ++k )
        {
            area[corner[k]] += double3_length( cross ) / 6.0;
        }
    }
    double weighted = 0.0, area_sum = 0.0;
    for ( int slot = 0; slot < b.fabric->slot_count; ++slot )
    {
        int vertex = b.fabric->slot_vertex[slot];
        double3 expected = vertex < 0 ? double3_make( 0.0, 0.0, 0.0 ) : gradient[vertex];
        double expected_area = vertex < 0 ? 0.0 : area[vertex];
        double3 found = column_of( b.gradient[slot / 8], slot % 8 );

        // about six products and sums per triangle, of the size of the area
        double tolerance = 8.0 * (double)FLT_EPSILON * expected_area;
        assert_near( double3_distance( found, expected ), 0.0, tolerance, "gradient of slot", slot );
        assert_near( (double)b.area[slot / 8][slot % 8], expected_area, tolerance, "area of slot", slot );
        weighted += (double)b.position[slot][3] * double3_dot( expected, expected );
        area_sum += expected_area;
    }
    assert_near( sums.weighted, weighted, sum_rounding * weighted, "weighted gradient", 0 );

    // an icosphere of 1280 triangles lacks one percent of the sphere
    assert_near( area_sum / ( 4.0 * 3.14159265358979 * 0.49 ), 0.995, 0.005, "share of the sphere", 0 );
    free( gradient );
    free( area );
    release_ball( &b );
}

TEST( sums_are_those_of_ranges_of_sixty_four_slices_added_in_order )
{
    ball b = make_ball( 1.0f, ( wisp_vec3 ){ 0.5f, 0.25f, -0.125f } );
    wisp_ring_args args = ring_args( &b, b.fabric->rest[0] );
    wisp_ring_sums whole, sum = { 0.0, 0.0 };
    widest_table()->ring_gradient( &args, 0, b.fabric->ring_slice_count, &whole );
    float( *gradient )[3][8] = new_aligned( BLOCK * sizeof( *gradient ) );
    float( *area )[8] = new_aligned( BLOCK * sizeof( *area ) );
    args.gradient = gradient[0][0];
    args.area = area[0];
    for ( int begin = 0; begin < b.fabric->ring_slice_count; begin += BLOCK )
    {
        int end = begin + BLOCK < b.fabric->ring_slice_count ? begin + BLOCK : b.fabric->ring_slice_count;
        wisp_ring_sums part;
        args.first_slice = begin;
        widest_table()->ring_gradient( &args, begin, end, &part );
        sum.volume += part.volume;
        sum.weighted += part.weighted;
        assert_memory_equal( gradient, b.gradient + begin, (size_t)( end - begin ) * sizeof( *gradient ) );
        assert_memory_equal( area, b.area + begin, (size_t)( end - begin ) * sizeof( *area ) );
    }
    assert_true( sum.volume == whole.volume && sum.weighted == whole.weighted );
    free( gradient );
    free( area );
    release_ball( &b );
}

TEST( normals_are_unit_vectors_along_the_area_vectors )
{
    ball b = make_ball( 0.7f, ( wisp_vec3 ){ 1.0f, 2.0f, 3.0f } );
    wisp_ring_args args = ring_args( &b, b.fabric->rest[0] );
    widest_table()->ring_normal( &args, 0, b.fabric->ring_slice_count );
    double3* gradient = checked_calloc( (size_t)b.mesh.vertex_count, sizeof( double3 ) );
    constraint_oracle_volume_gradient( b.mesh.positions, b.mesh.vertex_count, b.mesh.triangles, b.mesh.triangle_count,
                                       gradient );
    for ( int slot = 0; slot < b.fabric->slot_count; ++slot )
    {
        double3 normal = column_of( b.gradient[slot / 8], slot % 8 ), expected = { 0.0, 0.0, 0.0 };
        int vertex = b.fabric->slot_vertex[slot];
        if ( vertex >= 0 )
        {
            expected = double3_scale( 1.0 / double3_length( gradient[vertex] ), gradient[vertex] );
            double3 out = double3_sub( b.mesh.positions[vertex], double3_make( 1.0, 2.0, 3.0 ) );
            assert_true( double3_dot( normal, out ) > 0.6 );
        }

        // a sum of six products, and a quotient
        double gap = double3_distance( normal, expected );
        assert_near( gap, 0.0, 8.0 * (double)FLT_EPSILON, "normal of slot", slot );
    }
    free( gradient );
    release_ball( &b );
}

TEST( normals_of_what_is_too_small_to_square_are_zero )
{
    ball b = make_ball( 1e-10f, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    wisp_ring_args args = ring_args( &b, b.fabric->rest[0] );
    widest_table()->ring_normal( &args, 0, b.fabric->ring_slice_count );
    for ( int slot = 0; slot < b.fabric->slot_count; ++slot )
    {
        assert_true( double3_length( column_of( b.gradient[slot / 8], slot % 8 ) ) == 0.0 );
    }
    release_ball( &b );
}

// ---- particles ----

enum
{
    COUNT = 256,
};

typedef struct particle_batch
{
    _Alignas( 64 ) float position[COUNT][4];
    float previous[COUNT][4], velocity[COUNT][4];
    float gradient[COUNT / 8][3][8];
    int32_t anchor_x4[2 * COUNT];
    float rest[2 * COUNT];
} particle_batch;

// The first two slices are anchors, every other one of them pinned.
static particle_batch* new_particle_batch( void )
{
    particle_batch* s = new_aligned( sizeof( particle_batch ) );
    for ( int i = 0; i < COUNT; ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            s->position[i][k] = test_random_float( i, k, -1.0f, 1.0f );
            s->previous[i][k] = test_random_float( i, 3 + k, -1.0f, 1.0f );
            s->velocity[i][k] = test_random_float( i, 6 + k, -9.0f, 9.0f );
            s->gradient[i / 8][k][i % 8] = test_random_float( i, 12 + k, -1.0f, 1.0f );
        }
        s->position[i][3] = i < 16 ? (float)( i % 2 ) : i % 5 == 0 ? 0.0f : 0.5f * (float)( i % 7 + 1 );
        s->previous[i][3] = s->position[i][3];
        s->anchor_x4[i] = 4 * ( i < 16 || i % 11 == 0 ? i : i % 16 );
        s->rest[i] = i < 16 || i % 11 == 0 ? 0.0f : test_random_float( i, 15, 0.2f, 1.5f );

        // the second layer: one anchor for eight slots, in every other slice a pinned one
        s->anchor_x4[COUNT + i] = 4 * ( i / 8 % 16 );
        s->rest[COUNT + i] = i < 16 ? 0.0f : test_random_float( i, 16, 0.2f, 1.5f );
    }
    return s;
}

static wisp_particle_args particle_args( particle_batch* s )
{
    return ( wisp_particle_args ){
        .position = s->position[0],
        .previous = s->previous[0],
        .velocity = s->velocity[0],
        .acceleration = { 0.3f, -9.81f, 1.7f },
        .dt = 1.0f / 600.0f,
    };
}

static wisp_tether_args tether_args( particle_batch* s )
{
    return ( wisp_tether_args ){
        .position = s->position[0],
        .anchor_x4 = s->anchor_x4,
        .rest = s->rest,
        .layer_count = 1,
        .slot_count = COUNT,
        .slack = 1.125f,
    };
}

static void run_all( const wisp_kernels* kernels, particle_batch* s )
{
    wisp_particle_args args = particle_args( s );
    wisp_tether_args tether = tether_args( s );
    wisp_push_args push = { s->position[0], s->gradient[0][0], 0.01f };
    kernels->accelerate( &args, 0, COUNT );
    kernels->predict( &args, 0, COUNT );
    tether.layer_count = 2;
    kernels->tether( &tether, 0, COUNT );
    kernels->push( &push, 0, COUNT / 8 );
    kernels->velocity( &args, 0, COUNT );
}

TEST( every_table_gives_the_same_bits )
{
    const wisp_kernels* tables[MAX_TABLES];
    int table_count = usable_tables( tables );
    particle_batch* reference = new_particle_batch();
    ball reference_ball = make_ball( 0.7f, ( wisp_vec3 ){ 1.0f, 2.0f, 3.0f } );
    wisp_ring_args reference_args = ring_args( &reference_ball, ( wisp_vec3 ){ 1.0f, 2.0f, 2.5f } );
    wisp_ring_sums reference_sums, sums;
    int slices = reference_ball.fabric->ring_slice_count;
    size_t gradient_size = (size_t)slices * sizeof( *reference_ball.gradient );
    float* normals = new_aligned( gradient_size );
    run_all( tables[0], reference );
    tables[0]->ring_normal( &reference_args, 0, slices );
    memcpy( normals, reference_ball.gradient, gradient_size );
    tables[0]->ring_gradient( &reference_args, 0, slices, &reference_sums );
    for ( int t = 1; t < table_count; ++t )
    {
        particle_batch* s = new_particle_batch();
        run_all( tables[t], s );
        assert_memory_equal( s, reference, sizeof( *s ) );
        free( s );

        ball b = make_ball( 0.7f, ( wisp_vec3 ){ 1.0f, 2.0f, 3.0f } );
        wisp_ring_args args = ring_args( &b, reference_args.origin );
        tables[t]->ring_normal( &args, 0, slices );
        assert_memory_equal( b.gradient, normals, gradient_size );
        tables[t]->ring_gradient( &args, 0, slices, &sums );
        assert_memory_equal( b.gradient, reference_ball.gradient, gradient_size );
        assert_memory_equal( b.area, reference_ball.area, (size_t)slices * sizeof( *b.area ) );
        assert_memory_equal( &sums, &reference_sums, sizeof( sums ) );
        release_ball( &b );
    }
    free( reference );
    free( normals );
    release_ball( &reference_ball );
}

TEST( particles_fall_as_in_scalars_and_pinned_ones_stay )
{
    particle_batch *s = new_particle_batch(), *start = new_particle_batch();
    wisp_particle_args args = particle_args( s );
    const float a[3] = { args.acceleration.x, args.acceleration.y, args.acceleration.z };
    widest_table()->accelerate( &args, 0, COUNT );
    for ( int i = 0; i < COUNT; ++i )
    {
        for ( int k = 0; k < 4; ++k )
        {
            bool moves = start->position[i][3] > 0.0f && k < 3;
            float expected = moves ? start->velocity[i][k] + a[k] * args.dt : start->velocity[i][k];
            assert_true( s->velocity[i][k] == expected );
        }
    }
    widest_table()->predict( &args, 0, COUNT );
    for ( int i = 0; i < COUNT; ++i )
    {
        assert_memory_equal( s->previous[i], start->position[i], sizeof( s->previous[i] ) );
        for ( int k = 0; k < 4; ++k )
        {
            bool moves = start->position[i][3] > 0.0f && k < 3;
            float expected = moves ? start->position[i][k] + s->velocity[i][k] * args.dt : start->position[i][k];
            assert_true( s->position[i][k] == expected );
        }
    }
    free( s );
    free( start );
}

// Eq. 2 with both sides written about the prediction: the same number in exact arithmetic.
TEST( velocities_are_differences_over_time )
{
    particle_batch *s = new_particle_batch(), *start = new_particle_batch();
    wisp_particle_args args = particle_args( s );
    widest_table()->velocity( &args, 0, COUNT );
    for ( int i = 0; i < COUNT; ++i )
    {
        for ( int k = 0; k < 4; ++k )
        {
            bool moves = s->position[i][3] > 0.0f && k < 3;
            float v = start->velocity[i][k], predicted = v * args.dt + s->previous[i][k];
            float expected = moves ? v + ( s->position[i][k] - predicted ) / args.dt : 0.0f;
            assert_true( s->velocity[i][k] == expected );
            double exact = ( (double)s->position[i][k] - (double)s->previous[i][k] ) / (double)args.dt;
            // four roundings of numbers no larger than the largest of position, prediction and velocity dt, over dt
            double largest = fmax( fabs( (double)s->position[i][k] ), fabs( (double)predicted ) );
            double allowed = 4.0 * FLT_EPSILON * ( largest / (double)args.dt + fabs( (double)v ) );
            assert_true( moves == false || fabs( (double)expected - exact ) <= allowed );
        }
    }
    free( s );
    free( start );
}

TEST( what_no_constraint_moved_keeps_its_velocity_to_the_last_bit )
{
    particle_batch *s = new_particle_batch(), *start = new_particle_batch();
    wisp_particle_args args = particle_args( s );
    for ( int i = 0; i < COUNT; ++i )
    {
        s->position[i][0] += 1000.0f; // where a difference of positions would have few digits left
    }
    widest_table()->predict( &args, 0, COUNT );
    widest_table()->velocity( &args, 0, COUNT );
    for ( int i = 0; i < COUNT; ++i )
    {
        for ( int k = 0; k < 3 && s->position[i][3] > 0.0f; ++k )
        {
            assert_true( s->velocity[i][k] == start->velocity[i][k] );
        }
    }
    free( s );
    free( start );
}

TEST( a_push_moves_by_inverse_mass_and_gradient )
{
    particle_batch *s = new_particle_batch(), *start = new_particle_batch();
    wisp_push_args args = { s->position[0], s->gradient[0][0], -0.37f };
    widest_table()->push( &args, 0, COUNT / 8 );
    for ( int i = 0; i < COUNT; ++i )
    {
        float w = start->position[i][3];
        for ( int k = 0; k < 4; ++k )
        {
            float change = k < 3 ? w * args.factor * s->gradient[i / 8][k][i % 8] : 0.0f;
            assert_true( s->position[i][k] == start->position[i][k] + change );
        }
    }
    free( s );
    free( start );
}

TEST( tethers_only_pull_and_only_towards_pinned_anchors )
{
    particle_batch *s = new_particle_batch(), *start = new_particle_batch();
    wisp_tether_args args = tether_args( s );
    widest_table()->tether( &args, 0, COUNT );
    int pulled = 0, slack = 0;
    for ( int i = 0; i < COUNT; ++i )
    {
        const float *p = start->position[i], *a = start->position[s->anchor_x4[i] / 4];
        double3 from =
            double3_make( (double)p[0] - (double)a[0], (double)p[1] - (double)a[1], (double)p[2] - (double)a[2] );
        double longest = (double)( s->rest[i] * args.slack ), length = double3_length( from );
        bool may = s->rest[i] > 0.0f && p[3] > 0.0f && a[3] == 0.0f;
        if ( may == false || length <= longest )
        {
            assert_memory_equal( s->position[i], p, sizeof( s->position[i] ) );
            slack += may ? 1 : 0;
            continue;
        }
        double3 there = double3_scale( longest / length, from );
        for ( int k = 0; k < 3; ++k )
        {
            double expected = (double)a[k] + ( k == 0 ? there.x : k == 1 ? there.y : there.z );

            // a length of up to three metres with five roundings, then a product and a sum
            assert_near( (double)s->position[i][k], expected, 12.0 * (double)FLT_EPSILON, "tethered slot", i );
        }
        assert_true( s->position[i][3] == p[3] );
        pulled += 1;
    }
    assert_true( pulled > 20 && slack > 20 );
    free( s );
    free( start );
}

TEST( layers_of_tethers_pull_one_after_another )
{
    particle_batch *together = new_particle_batch(), *in_turn = new_particle_batch();
    wisp_tether_args both = tether_args( together ), one = tether_args( in_turn );
    both.layer_count = 2;
    widest_table()->tether( &both, 0, COUNT );
    widest_table()->tether( &one, 0, COUNT );
    particle_batch* first = new_particle_batch();
    memcpy( first, in_turn, sizeof( particle_batch ) );
    one.anchor_x4 += COUNT;
    one.rest += COUNT;
    widest_table()->tether( &one, 0, COUNT );
    assert_memory_equal( together, in_turn, sizeof( particle_batch ) );
    assert_memory_not_equal( in_turn, first, sizeof( particle_batch ) );
    free( together );
    free( in_turn );
    free( first );
}

// Every invalid value in every number of every particle.
TEST( the_first_particle_beyond_the_bound_is_found )
{
    const float wrong[] = { NAN, INFINITY, -INFINITY, 10.5f, -10.5f };
    const wisp_kernels* tables[MAX_TABLES];
    int table_count = usable_tables( tables );
    particle_batch* s = new_particle_batch();
    const wisp_bound_args args = { s->position[0], s->velocity[0], 10.0f };
    for ( int t = 0; t < table_count; ++t )
    {
        s->position[3][3] = 1e9f; // an inverse mass may be anything
        assert_int_equal( tables[t]->find_out_of_bounds( &args, 0, COUNT ), COUNT );
        for ( int i = 0; i < 6 * COUNT; ++i )
        {
            float* number = i % 6 < 3 ? &s->position[i / 6][i % 6] : &s->velocity[i / 6][i % 6 - 3];
            const float kept = *number, later = s->velocity[COUNT - 1][2];
            s->velocity[COUNT - 1][2] = NAN;
            *number = wrong[i % WISP_COUNT( wrong )];
            assert_int_equal( tables[t]->find_out_of_bounds( &args, 0, COUNT ), i / 6 );
            assert_int_equal( tables[t]->find_out_of_bounds( &args, 0, i / 48 * 8 ), i / 48 * 8 );
            *number = kept;
            s->velocity[COUNT - 1][2] = later;
        }
    }
    free( s );
}

// ---- drag ----

enum
{
    DRAG_SLOTS = 96,
};

typedef struct skin
{
    _Alignas( 64 ) float position[DRAG_SLOTS][4], velocity[DRAG_SLOTS][4], vectors[DRAG_SLOTS / 8][3][8];
    _Alignas( 64 ) float areas[DRAG_SLOTS];
} skin;

// Some are pinned, at rest, or with a vector that cancels.
static skin* new_skin( void )
{
    skin* s = checked_calloc( 1, sizeof( *s ) );
    for ( int i = 0; i < DRAG_SLOTS; ++i )
    {
        s->areas[i] = test_random_float( i, 0, 1e-4f, 2e-4f );
        for ( int k = 0; k < 3; ++k )
        {
            s->position[i][k] = test_random_float( i, 1 + k, 299.0f, 301.0f );
            s->velocity[i][k] = i % 13 == 5 ? 0.0f : test_random_float( i, 4 + k, -20.0f, 20.0f );
            s->vectors[i / 8][k][i % 8] =
                i % 11 == 7 ? 1e-18f : s->areas[i] * test_random_float( i, 7 + k, -0.6f, 0.6f );
        }
        s->position[i][3] = i % 7 == 3 ? 0.0f : test_random_float( i, 10, 100.0f, 1e5f );
        s->velocity[i][3] = (float)i;
    }
    return s;
}

static wisp_vertex_drag_args args_of( skin* s )
{
    return ( wisp_vertex_drag_args ){ .position = s->position[0],
                                      .velocity = s->velocity[0],
                                      .vectors = s->vectors[0][0],
                                      .areas = s->areas,
                                      .half_density_drag = 0.3f,
                                      .dt = 1.0f / 600.0f };
}

TEST( every_table_gives_the_same_bits_of_drag )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int i = 0; i < count; ++i )
    {
        skin* s[2] = { new_skin(), new_skin() };
        double sum[2][3];
        for ( int k = 0; k < 2; ++k )
        {
            const wisp_kernels* kernels = tables[k == 0 ? i : 0];
            const wisp_vertex_drag_args args = args_of( s[k] );
            kernels->sum_vertex_drag( &args, 8, DRAG_SLOTS, sum[k] );
            kernels->vertex_drag( &args, 8, DRAG_SLOTS );
        }
        assert_memory_equal( sum[0], sum[1], sizeof( sum[0] ) );
        assert_memory_equal( s[0]->velocity, s[1]->velocity, sizeof( s[0]->velocity ) );
        free( s[0] );
        free( s[1] );
    }
}

// - 1/2 rho C_d A max( 0, cos ) |v| v, divided by 1 + dt w times its rate.
static double3 force_on( skin* s, const wisp_vertex_drag_args* args, int i )
{
    const double3 v = double3_from( s->velocity[i] );
    const double3 a = { (double)s->vectors[i / 8][0][i % 8], (double)s->vectors[i / 8][1][i % 8],
                        (double)s->vectors[i / 8][2][i % 8] };
    const double speed = double3_length( v ), size = double3_length( a ), area = (double)s->areas[i];
    if ( speed == 0.0 || size < 1e-12 * area )
    {
        return ( double3 ){ 0.0, 0.0, 0.0 };
    }
    const double along = double3_dot( v, a ) / ( speed * size ), c = (double)args->half_density_drag * area;
    const double rate = c * fmax( along, 0.0 ) * speed;
    return double3_scale( -rate / ( 1.0 + (double)args->dt * (double)s->position[i][3] * rate ), v );
}

TEST( vertices_lose_the_velocity_of_the_formula )
{
    skin *s = new_skin(), *before = new_skin();
    const wisp_vertex_drag_args args = args_of( s );
    double sum[3], size = 0.0;
    double3 expected_sum = { 0.0, 0.0, 0.0 };
    widest_table()->sum_vertex_drag( &args, 8, DRAG_SLOTS, sum );
    widest_table()->vertex_drag( &args, 8, DRAG_SLOTS );
    for ( int i = 0; i < DRAG_SLOTS; ++i )
    {
        const double3 f = force_on( before, &args, i ), v = double3_from( before->velocity[i] );
        const double impulse = i < 8 ? 0.0 : (double)args.dt * (double)s->position[i][3];
        const double3 to = double3_add_scaled( v, impulse, f );
        // a force of ten roundings or so, and the angle of three products
        const double tolerance = 32.0 * (double)FLT_EPSILON * double3_length( v );
        assert_near( (double)s->velocity[i][0], to.x, tolerance, "velocity along x of slot", i );
        assert_near( (double)s->velocity[i][1], to.y, tolerance, "velocity along y of slot", i );
        assert_near( (double)s->velocity[i][2], to.z, tolerance, "velocity along z of slot", i );
        assert_true( s->velocity[i][3] == (float)i );
        expected_sum = double3_add_scaled( expected_sum, i < 8 ? 0.0 : 1.0, f );
        size += 0.3 * (double)s->areas[i] * double3_dot( v, v );
    }
    assert_near( sum[0], expected_sum.x, 8.0 * (double)FLT_EPSILON * size, "force along x", 0 );
    assert_near( sum[1], expected_sum.y, 8.0 * (double)FLT_EPSILON * size, "force along y", 0 );
    assert_near( sum[2], expected_sum.z, 8.0 * (double)FLT_EPSILON * size, "force along z", 0 );
    free( s );
    free( before );
}

// ---- air ----

enum
{
    AIR_SLOTS = 64,
    RING = 7, // entries of a slice
};

typedef struct air_scene
{
    _Alignas( 64 ) float position[AIR_SLOTS][4];
    _Alignas( 64 ) float old_velocity[AIR_SLOTS][4];
    _Alignas( 64 ) float velocity[AIR_SLOTS][4];
    int32_t ring_begin[AIR_SLOTS / 8 + 1];
    int32_t ring_x4[AIR_SLOTS / 8 * RING][8];
    float lift;
} air_scene;

static air_scene* new_scene( void )
{
    air_scene* s = checked_calloc( 1, sizeof( air_scene ) );
    s->lift = 0.4f;
    for ( int v = 0; v < AIR_SLOTS; ++v )
    {
        for ( int k = 0; k < 3; ++k )
        {
            s->position[v][k] = test_random_float( v, k, -1.0f, 1.0f );
            s->old_velocity[v][k] = test_random_float( v, 3 + k, -5.0f, 5.0f );
        }
        s->position[v][3] = v % 5 == 0 ? 0.0f : test_random_float( v, 7, 10.0f, 2000.0f ); // 1/kg; some are pinned
        s->old_velocity[v][3] = (float)v;
    }
    memcpy( s->position[7], s->position[6], 3 * sizeof( float ) ); // triangles without area
    for ( int slice = 0; slice < AIR_SLOTS / 8; ++slice )
    {
        s->ring_begin[slice + 1] = ( slice + 1 ) * RING;
        for ( int e = 0; e < RING; ++e )
        {
            for ( int lane = 0; lane < 8; ++lane )
            {
                // every third fan is short: its own slot pads
                const int own = slice * 8 + lane, other = ( own + 1 + e * 7 % 5 + e ) % AIR_SLOTS;
                s->ring_x4[slice * RING + e][lane] = 4 * ( own % 3 == 0 && e > 3 ? own : other );
            }
        }
    }
    return s;
}

static wisp_ring_air_args job_of( air_scene* s )
{
    return ( wisp_ring_air_args ){
        .position = s->position[0],
        .old_velocity = s->old_velocity[0],
        .velocity = s->velocity[0],
        .ring_begin = s->ring_begin,
        .ring_x4 = (const int32_t( * )[8])s->ring_x4,
        .wind = { 3.0f, -1.0f, 0.5f },
        .density = 1.2f,
        .drag = 1.1f,
        .lift = s->lift,
        .dt = 1.0f / 600.0f,
    };
}

static void run( const wisp_kernels* kernels, air_scene* s )
{
    const wisp_ring_air_args args = job_of( s );
    kernels->ring_air( &args, 0, AIR_SLOTS / 8 );
}

static void make_strange( air_scene* s )
{
    s->position[20][0] = NAN;
    s->position[21][1] = INFINITY;
    s->position[22][2] = -INFINITY;
    s->position[23][0] = 1e30f;
    s->old_velocity[26][1] = INFINITY;
}

TEST( every_table_gives_the_same_bits_of_air )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int variant = 0; variant < 4; ++variant )
    {
        air_scene* found[MAX_TABLES];
        for ( int t = 0; t < count; ++t )
        {
            found[t] = new_scene();
            found[t]->lift = variant < 2 ? 0.4f : 0.0f;
            if ( variant % 2 == 1 )
            {
                make_strange( found[t] );
            }
            run( tables[t], found[t] );
            assert_memory_equal( found[t]->velocity, found[0]->velocity, sizeof( found[t]->velocity ) );
        }
        for ( int t = 0; t < count; ++t )
        {
            free( found[t] );
        }
    }
}

// ---- against double precision ----

static double3 combine( double s, double3 a, double t, double3 b )
{
    return double3_add_scaled( double3_scale( s, a ), t, b );
}

// F = 1/2 rho A |u . n| ( C_d u + C_l ( |u| n' - (u . n') / |u| u ) ). @param lift receives the second term
static double3 triangle_force( const wisp_ring_air_args* args, air_scene* s, const int slots[3], double* rate,
                               double3* lift )
{
    const double3 p = double3_from( s->position[slots[0]] );
    const double3 e = combine( 1.0, double3_from( s->position[slots[1]] ), -1.0, p );
    const double3 f = combine( 1.0, double3_from( s->position[slots[2]] ), -1.0, p ), normal = double3_cross( e, f );
    double3 u = double3_widen( args->wind );
    for ( int k = 0; k < 3; ++k )
    {
        u = combine( 1.0, u, -1.0 / 3.0, double3_from( s->old_velocity[slots[k]] ) );
    }
    const double area = 0.5 * double3_length( normal ), speed = double3_length( u );
    *rate = 0.0;
    *lift = ( double3 ){ 0.0, 0.0, 0.0 };
    if ( area == 0.0 )
    {
        return ( double3 ){ 0.0, 0.0, 0.0 };
    }
    const double facing = double3_dot( u, normal ) / ( 2.0 * area );
    const double3 n = combine( ( facing < 0.0 ? -1.0 : 1.0 ) / ( 2.0 * area ), normal, 0.0, normal );
    const double pressure = 0.5 * (double)args->density * area * fabs( facing );
    const double3 foreign = combine( speed, n, -double3_dot( u, n ) / speed, u );
    *rate = pressure * ( (double)args->drag + (double)args->lift );
    *lift = double3_scale( pressure * (double)args->lift, foreign );
    return combine( pressure * (double)args->drag, u, 1.0, *lift );
}

static void compare_with_formula( float lift_coefficient )
{
    air_scene* s = new_scene();
    s->lift = lift_coefficient;
    const wisp_ring_air_args args = job_of( s );
    run( widest_table(), s );
    for ( int v = 0; v < AIR_SLOTS; ++v )
    {
        double3 force = { 0.0, 0.0, 0.0 }, lift = force;
        double rate = 0.0;
        for ( int e = 1; e < RING; ++e )
        {
            double own;
            double3 own_lift;
            const int slots[3] = { v, s->ring_x4[v / 8 * RING + e - 1][v % 8] / 4,
                                   s->ring_x4[v / 8 * RING + e][v % 8] / 4 };
            force = combine( 1.0, force, 1.0 / 3.0, triangle_force( &args, s, slots, &own, &own_lift ) );
            lift = combine( 1.0, lift, 1.0 / 3.0, own_lift );
            rate += own / 3.0;
        }
        const double w = (double)s->position[v][3], dt = (double)args.dt, change = dt * w / ( 1.0 + dt * w * rate );
        // lift turns the relative wind: the square of its step is taken out of the speed again
        const double3 wind = double3_widen( args.wind );
        const double3 blown = combine( 1.0, double3_from( s->old_velocity[v] ), change, force );
        const double3 relative = combine( 1.0, blown, -1.0, wind );
        const double square = double3_dot( relative, relative );
        const double left = fmax( square - change * change * double3_dot( lift, lift ), 0.0 );
        const double3 expected =
            w > 0.0 ? combine( 1.0, wind, sqrt( left / square ), relative ) : double3_from( s->old_velocity[v] );
        // forces of a few newtons on as little as half a gram are reduced by the implicit rate: the result is below
        // the speeds of wind and vertices, and so is its rounding, about thirty times
        const double tolerance = 30.0 * 10.0 * (double)FLT_EPSILON;
        assert_near( (double)s->velocity[v][0], expected.x, tolerance, "velocity along x of slot", v );
        assert_near( (double)s->velocity[v][1], expected.y, tolerance, "velocity along y of slot", v );
        assert_near( (double)s->velocity[v][2], expected.z, tolerance, "velocity along z of slot", v );
        assert_true( s->velocity[v][3] == (float)v );
    }
    free( s );
}

TEST( a_vertex_takes_a_third_of_the_air_on_its_triangles )
{
    compare_with_formula( 0.4f );
    compare_with_formula( 0.0f ); // drag alone takes no root
}

TEST( what_is_pinned_keeps_its_velocity )
{
    air_scene* s = new_scene();
    make_strange( s );
    run( widest_table(), s );
    for ( int v = 0; v < AIR_SLOTS; v += 5 )
    {
        assert_memory_equal( s->velocity[v], s->old_velocity[v], sizeof( s->velocity[v] ) );
    }
    free( s );
}

TEST( a_corner_that_is_not_finite_spoils_no_neighbour )
{
    air_scene* s = new_scene();
    make_strange( s );
    run( widest_table(), s );
    for ( int v = 0; v < AIR_SLOTS; ++v )
    {
        assert_true( v == 26 || ( isfinite( s->velocity[v][0] ) && isfinite( s->velocity[v][1] ) &&
                                  isfinite( s->velocity[v][2] ) ) );
    }
    free( s );
}
