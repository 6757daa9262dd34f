// Kernels over particles: rings against the oracle in double precision, time integration exactly as in scalar code,
// tethers by their properties.
#include "kernels_fixture.h"

#include "balloon_meshes.h"
#include "constraint_oracle.h"

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
