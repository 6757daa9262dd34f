// Kernels over particles: rings against the oracle in double precision, time integration exactly as in scalar code,
// tethers by their formula; drag on vertices and air on the triangles around them agree with formulas in doubles.
#include "kernels_fixture.h"

#include "balloon_meshes.h"
#include "constraint_oracle.h"

#include "wisp/fabric.h"

// ---- rings ----

enum
{
    BLOCK = 64, // slices whose sum a kernel keeps in floats
    BALL_SLICES = 81,
};

typedef struct ball
{
    _Alignas( 64 ) float position[8 * BALL_SLICES][4];
    float gradient[BALL_SLICES][3][8], normal[BALL_SLICES][3][8], area[BALL_SLICES][8];
    wisp_vec3 centre;
    float radius;
    wisp_ring_sums sums;
    balloon_mesh mesh;
    wisp_fabric* fabric;
} ball;

// Near the origin, far from it, and too small to square. Inverse masses are 1 .. 4. Positions of the mesh are rounded to
// the kernel's floats.
static void fill_ball( void* state, int variant )
{
    ball* b = state;
    b->radius = variant == 2 ? 1e-10f : 0.7f;
    b->centre = variant == 0 ? ( wisp_vec3 ){ 1.0f, 2.0f, 3.0f } : ( wisp_vec3 ){ 3000.0f, -2000.0f, 10000.0f };
    b->centre = variant == 2 ? ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } : b->centre;
    assert_true( balloon_mesh_icosphere( &b->mesh, 3, (double)b->radius ) );
    wisp_vec3* points = checked_calloc( (size_t)b->mesh.vertex_count, sizeof( wisp_vec3 ) );
    for ( int i = 0; i < b->mesh.vertex_count; ++i )
    {
        double3* p = b->mesh.positions + i;
        points[i] = ( wisp_vec3 ){ b->centre.x + (float)p->x, b->centre.y + (float)p->y, b->centre.z + (float)p->z };
        *p = double3_widen( points[i] );
    }
    wisp_fabric_def def = wisp_default_fabric_def();
    def.points = points;
    def.triangles = b->mesh.triangles;
    def.vertex_count = b->mesh.vertex_count;
    def.triangle_count = b->mesh.triangle_count;
    assert_int_equal( wisp_fabric_cook( &def, NULL, &b->fabric, NULL ), WISP_OK );
    free( points );
    assert_int_equal( b->fabric->ring_slice_count, BALL_SLICES );
    for ( int slot = 0; slot < b->fabric->slot_count; ++slot )
    {
        memcpy( b->position[slot], &b->fabric->rest[slot], sizeof( wisp_vec3 ) );
        b->position[slot][3] = b->fabric->slot_vertex[slot] < 0 ? 0.0f : (float)( 1 + slot % 4 );
    }
}

static void release_ball( void* state )
{
    ball* b = state;
    wisp_fabric_release( b->fabric );
    balloon_mesh_destroy( &b->mesh );
}

static void run_ball( const wisp_kernels* kernels, void* state, int begin, int end )
{
    ball* b = state;
    wisp_ring_args args = { .position = b->position[0],
                            .ring_begin = b->fabric->ring_begin,
                            .ring_x4 = b->fabric->ring_x4,
                            .origin = b->centre,
                            .gradient = b->normal[begin][0],
                            .area = b->area[begin],
                            .first_slice = begin };
    wisp_ring_sums part;
    kernels->ring_normal( &args, begin, end );
    args.gradient = b->gradient[begin][0];
    kernels->ring_gradient( &args, begin, end, &part );
    b->sums.volume += part.volume;
    b->sums.weighted += part.weighted;
}

// The gradient of the volume by the oracle, and a third of the area of the triangles of each vertex.
static void find_gradient( const balloon_mesh* mesh, double3* gradient, double* area )
{
    constraint_oracle_volume_gradient( mesh->positions, mesh->vertex_count, mesh->triangles, mesh->triangle_count,
                                       gradient );
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        const int* corner = mesh->triangles + 3 * t;
        const double3* p = mesh->positions;
        double3 cross =
            double3_cross( double3_sub( p[corner[1]], p[corner[0]] ), double3_sub( p[corner[2]], p[corner[0]] ) );
        for ( int k = 0; k < 3; ++k )
        {
            area[corner[k]] += double3_length( cross ) / 6.0;
        }
    }
}

// The normal is a sum of six products, and a quotient.
static void check_normal( ball* b, int slot, double3 gradient )
{
    const double3 normal = lane_vector( b->normal[slot / 8], slot % 8 ), none = { 0.0, 0.0, 0.0 };
    const bool is_none = b->fabric->slot_vertex[slot] < 0 || b->radius < 1e-9f;
    const double3 expected = is_none ? none : double3_unit( gradient );
    assert_near_vector( normal, expected, is_none ? 0.0 : 8.0 * (double)FLT_EPSILON, "normal of slot", slot );
    const double3 out = double3_sub( double3_from( b->position[slot] ), double3_widen( b->centre ) );
    assert_true( is_none || double3_dot( normal, out ) > 0.6 );
}

static void check_ball( void* start, void* end )
{
    (void)start;
    ball* b = end;
    double3* gradient = checked_calloc( (size_t)b->mesh.vertex_count, sizeof( double3 ) );
    double* area = checked_calloc( (size_t)b->mesh.vertex_count, sizeof( double ) );
    find_gradient( &b->mesh, gradient, area );
    double weighted = 0.0, area_sum = 0.0;
    for ( int slot = 0; slot < b->fabric->slot_count; ++slot )
    {
        const int vertex = b->fabric->slot_vertex[slot];
        const double3 expected = vertex < 0 ? double3_make( 0.0, 0.0, 0.0 ) : gradient[vertex];
        const double expected_area = vertex < 0 ? 0.0 : area[vertex];
        check_normal( b, slot, expected );
        if ( b->radius < 1e-9f )
        {
            continue; // areas of 1e-22 m^2 are below what a float has
        }
        // about six products and sums per triangle, of the size of the area
        const double tolerance = 8.0 * (double)FLT_EPSILON * expected_area;
        assert_near_vector( lane_vector( b->gradient[slot / 8], slot % 8 ), expected, tolerance, "gradient of slot",
                            slot );
        assert_near( (double)b->area[slot / 8][slot % 8], expected_area, tolerance, "area of slot", slot );
        weighted += (double)b->position[slot][3] * double3_dot( expected, expected );
        area_sum += expected_area;
    }
    // a lane adds the terms of 64 slices in floats, and each addition rounds once
    const double rounding = BLOCK * (double)FLT_EPSILON;
    const double volume = constraint_oracle_volume( b->mesh.positions, b->mesh.triangles, b->mesh.triangle_count );
    assert_near( b->sums.volume, volume, rounding * fabs( volume ), "volume", 0 );
    assert_near( b->sums.weighted, weighted, rounding * weighted + 1e-37, "weighted gradient", 0 );
    // an icosphere of 1280 triangles lacks one percent of the sphere
    assert_near( area_sum / ( 4.0 * 3.14159265358979 * 0.49 ), b->radius < 1e-9f ? 0.0 : 0.995, 0.005,
                 "share of the sphere", 0 );
    free( gradient );
    free( area );
}

TEST( volume_area_and_normals_of_a_ball_are_those_of_the_oracle_in_ranges_of_sixty_four_slices )
{
    kernel_row row = *KERNEL_ROW( ball, 3, 0, BALL_SLICES, BLOCK, fill_ball, run_ball, check_ball );
    row.release = release_ball;
    check_kernel( &row );
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
    int layer_count;
} particle_batch;

// The first two slices are anchors, every other one of them pinned.
static void fill_batch( void* state, int variant )
{
    particle_batch* s = state;
    s->layer_count = 1 + variant;
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

static void run_fall( const wisp_kernels* kernels, void* state, int begin, int end )
{
    const wisp_particle_args args = particle_args( state );
    kernels->accelerate( &args, begin, end );
    kernels->predict( &args, begin, end );
}

static void check_fall( void* start, void* end )
{
    particle_batch *before = start, *s = end;
    const wisp_particle_args args = particle_args( s );
    const float a[3] = { args.acceleration.x, args.acceleration.y, args.acceleration.z };
    for ( int i = 0; i < 4 * COUNT; ++i )
    {
        const float v = before->velocity[i / 4][i % 4], p = before->position[i / 4][i % 4];
        const bool moves = before->position[i / 4][3] > 0.0f && i % 4 < 3;
        assert_true( s->velocity[i / 4][i % 4] == ( moves ? v + a[i % 4] * args.dt : v ) );
        assert_true( s->previous[i / 4][i % 4] == p );
        assert_true( s->position[i / 4][i % 4] == ( moves ? p + s->velocity[i / 4][i % 4] * args.dt : p ) );
    }
}

TEST_KERNEL( particles_fall_as_in_scalars_and_pinned_ones_stay, particle_batch, 1, 0, COUNT, 8, fill_batch, run_fall,
             check_fall )

RUN_KERNEL( run_velocity, velocity, wisp_particle_args, particle_args )

// Eq. 2 with both sides written about the prediction: the same number in exact arithmetic.
static void check_velocity( void* start, void* end )
{
    particle_batch *before = start, *s = end;
    const wisp_particle_args args = particle_args( s );
    for ( int i = 0; i < 4 * COUNT; ++i )
    {
        const bool moves = s->position[i / 4][3] > 0.0f && i % 4 < 3;
        const float v = before->velocity[i / 4][i % 4], p = s->position[i / 4][i % 4],
                    old = s->previous[i / 4][i % 4];
        const float predicted = v * args.dt + old, expected = moves ? v + ( p - predicted ) / args.dt : 0.0f;
        assert_true( s->velocity[i / 4][i % 4] == expected );
        const double exact = ( (double)p - (double)old ) / (double)args.dt;
        // four roundings of numbers no larger than the largest of position, prediction and velocity dt, over dt
        const double largest = fmax( fabs( (double)p ), fabs( (double)predicted ) );
        const double allowed = 4.0 * FLT_EPSILON * ( largest / (double)args.dt + fabs( (double)v ) );
        assert_true( moves == false || fabs( (double)expected - exact ) <= allowed );
    }
}

TEST_KERNEL( velocities_are_differences_over_time, particle_batch, 1, 0, COUNT, 8, fill_batch, run_velocity,
             check_velocity )

static void run_free( const wisp_kernels* kernels, void* state, int begin, int end )
{
    particle_batch* s = state;
    const wisp_particle_args args = particle_args( s );
    for ( int i = begin; i < end; ++i )
    {
        s->position[i][0] += 1000.0f; // where a difference of positions would have few digits left
    }
    kernels->predict( &args, begin, end );
    kernels->velocity( &args, begin, end );
}

static void check_free( void* start, void* end )
{
    particle_batch *before = start, *s = end;
    for ( int i = 0; i < 4 * COUNT; ++i )
    {
        const bool moves = s->position[i / 4][3] > 0.0f && i % 4 < 3;
        assert_true( moves == false || s->velocity[i / 4][i % 4] == before->velocity[i / 4][i % 4] );
    }
}

TEST_KERNEL( what_no_constraint_moved_keeps_its_velocity_to_the_last_bit, particle_batch, 1, 0, COUNT, 8, fill_batch,
             run_free, check_free )

static void run_push( const wisp_kernels* kernels, void* state, int begin, int end )
{
    particle_batch* s = state;
    const wisp_push_args args = { s->position[0], s->gradient[0][0], -0.37f };
    kernels->push( &args, begin, end );
}

static void check_push( void* start, void* end )
{
    particle_batch *before = start, *s = end;
    for ( int i = 0; i < 4 * COUNT; ++i )
    {
        const float w = before->position[i / 4][3];
        const float change = i % 4 < 3 ? w * -0.37f * s->gradient[i / 32][i % 4][i / 4 % 8] : 0.0f;
        assert_true( s->position[i / 4][i % 4] == before->position[i / 4][i % 4] + change );
    }
}

TEST_KERNEL( a_push_moves_by_inverse_mass_and_gradient, particle_batch, 1, 0, COUNT / 8, 1, fill_batch, run_push,
             check_push )

static void run_tether( const wisp_kernels* kernels, void* state, int begin, int end )
{
    particle_batch* s = state;
    const wisp_tether_args args = { .position = s->position[0],
                                    .anchor_x4 = s->anchor_x4,
                                    .rest = s->rest,
                                    .layer_count = s->layer_count,
                                    .slot_count = COUNT,
                                    .slack = 1.125f };
    kernels->tether( &args, begin, end );
}

// Tethers pull only, towards pinned anchors only, one layer after the other.
static void check_tether( void* start, void* end )
{
    particle_batch *before = start, *s = end;
    int pulled = 0, slack = 0;
    for ( int i = 0; i < COUNT; ++i )
    {
        double3 p = double3_from( before->position[i] );
        bool is_pulled = false;
        for ( int n = i; n < s->layer_count * COUNT; n += COUNT )
        {
            const float* a = before->position[s->anchor_x4[n] / 4];
            const double3 from = double3_sub( p, double3_from( a ) );
            const double longest = (double)( s->rest[n] * 1.125f ), length = double3_length( from );
            const bool may = s->rest[n] > 0.0f && s->position[i][3] > 0.0f && a[3] == 0.0f;
            slack += may && length <= longest ? 1 : 0;
            pulled += may && length > longest ? 1 : 0;
            is_pulled = is_pulled || ( may && length > longest );
            p = may && length > longest ? double3_add_scaled( double3_from( a ), longest / length, from ) : p;
        }
        // a length of up to three metres with five roundings, then a product and a sum
        const double tolerance = is_pulled ? 12.0 * s->layer_count * (double)FLT_EPSILON : 0.0;
        assert_near3( double3_from( s->position[i] ), p, tolerance, "tethered slot", i );
        assert_true( s->position[i][3] == before->position[i][3] );
    }
    assert_true( pulled > 20 && slack > 20 );
}

// Anchors are before all that they pull.
TEST_KERNEL( tethers_only_pull_and_only_towards_pinned_anchors, particle_batch, 2, 0, COUNT, 8, fill_batch,
             run_tether, check_tether )

// Every invalid value in every number of every particle.
TEST( the_first_particle_beyond_the_bound_is_found )
{
    const float wrong[] = { NAN, INFINITY, -INFINITY, 10.5f, -10.5f };
    static _Alignas( 64 ) particle_batch s;
    fill_batch( &s, 0 );
    const wisp_bound_args args = { s.position[0], s.velocity[0], 10.0f };
    s.position[3][3] = 1e9f; // an inverse mass may be anything
    for ( const wisp_kernels* const* k = every_table(); *k != NULL; ++k )
    {
        assert_int_equal( ( *k )->find_out_of_bounds( &args, 0, COUNT ), COUNT );
        for ( int i = 0; i < 6 * COUNT; ++i )
        {
            float* number = i % 6 < 3 ? &s.position[i / 6][i % 6] : &s.velocity[i / 6][i % 6 - 3];
            const float kept = *number, later = s.velocity[COUNT - 1][2];
            s.velocity[COUNT - 1][2] = NAN;
            *number = wrong[i % WISP_COUNT( wrong )];
            assert_int_equal( ( *k )->find_out_of_bounds( &args, 0, COUNT ), i / 6 );
            assert_int_equal( ( *k )->find_out_of_bounds( &args, 0, i / 48 * 8 ), i / 48 * 8 );
            *number = kept;
            s.velocity[COUNT - 1][2] = later;
        }
    }
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
    double sum[3];
} skin;

// Some are pinned, at rest, or with a vector that cancels.
static void fill_skin( void* state, int seed )
{
    skin* s = state;
    for ( int i = 0; i < DRAG_SLOTS; ++i )
    {
        s->areas[i] = test_random_float( i + 1000 * seed, 0, 1e-4f, 2e-4f );
        for ( int k = 0; k < 3; ++k )
        {
            s->position[i][k] = test_random_float( i + 1000 * seed, 1 + k, 299.0f, 301.0f );
            s->velocity[i][k] = i % 13 == 5 ? 0.0f : test_random_float( i + 1000 * seed, 4 + k, -20.0f, 20.0f );
            s->vectors[i / 8][k][i % 8] =
                i % 11 == 7 ? 1e-18f : s->areas[i] * test_random_float( i + 1000 * seed, 7 + k, -0.6f, 0.6f );
        }
        s->position[i][3] = i % 7 == 3 ? 0.0f : test_random_float( i + 1000 * seed, 10, 100.0f, 1e5f );
        s->velocity[i][3] = (float)i;
    }
}

static wisp_vertex_drag_args drag_args( skin* s )
{
    return ( wisp_vertex_drag_args ){ .position = s->position[0],
                                      .velocity = s->velocity[0],
                                      .vectors = s->vectors[0][0],
                                      .areas = s->areas,
                                      .half_density_drag = 0.3f,
                                      .dt = 1.0f / 600.0f };
}

static void run_drag( const wisp_kernels* kernels, void* state, int begin, int end )
{
    skin* s = state;
    const wisp_vertex_drag_args args = drag_args( s );
    kernels->sum_vertex_drag( &args, begin, end, s->sum );
    kernels->vertex_drag( &args, begin, end );
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

static void check_drag( void* start, void* end )
{
    skin *before = start, *s = end;
    const wisp_vertex_drag_args args = drag_args( s );
    double size = 0.0;
    double3 expected = { 0.0, 0.0, 0.0 };
    for ( int i = 0; i < DRAG_SLOTS; ++i )
    {
        const double3 f = force_on( before, &args, i ), v = double3_from( before->velocity[i] );
        const double impulse = i < 8 ? 0.0 : (double)args.dt * (double)s->position[i][3];
        // a force of ten roundings or so, and the angle of three products
        assert_near3( double3_from( s->velocity[i] ), double3_add_scaled( v, impulse, f ),
                      32.0 * (double)FLT_EPSILON * double3_length( v ), "velocity of slot", i );
        assert_true( s->velocity[i][3] == (float)i );
        expected = double3_add_scaled( expected, i < 8 ? 0.0 : 1.0, f );
        size += 0.3 * (double)s->areas[i] * double3_dot( v, v );
    }
    assert_near3( double3_make( s->sum[0], s->sum[1], s->sum[2] ), expected, 8.0 * (double)FLT_EPSILON * size,
                  "force", 0 );
}

TEST_KERNEL( vertices_lose_the_velocity_of_the_formula, skin, 3, 8, DRAG_SLOTS, 0, fill_skin, run_drag, check_drag )

// ---- air ----

enum
{
    AIR_SLOTS = 8 * BALL_SLICES,
};

typedef struct air_scene
{
    ball ball; // its triangles between points that know nothing of each other
    _Alignas( 64 ) float old_velocity[AIR_SLOTS][4];
    _Alignas( 64 ) float velocity[AIR_SLOTS][4];
    _Alignas( 64 ) float sum[AIR_SLOTS][4];
    float lift;
    bool is_strange;
} air_scene;

static void make_strange( float ( *position )[4], float ( *velocity )[4] )
{
    position[20][0] = NAN;
    position[21][1] = INFINITY;
    position[22][2] = -INFINITY;
    position[23][0] = 1e30f;
    velocity[26][1] = INFINITY;
}

// Drag alone takes no root. Every second variant has corners that are not finite.
static void fill_air( void* state, int variant )
{
    air_scene* s = state;
    fill_ball( &s->ball, 0 );
    assert_int_equal( wisp_fabric_need( s->ball.fabric, WISP_FABRIC_STRIPS ), WISP_OK );
    s->lift = variant < 2 ? 0.4f : 0.0f;
    s->is_strange = variant % 2 == 1;
    float( *position )[4] = s->ball.position;
    for ( int v = 0; v < AIR_SLOTS; ++v )
    {
        for ( int k = 0; k < 3; ++k )
        {
            position[v][k] = test_random_float( v, k, -1.0f, 1.0f );
            s->velocity[v][k] = test_random_float( v, 3 + k, -5.0f, 5.0f );
        }
        position[v][3] = v % 5 == 0 ? 0.0f : test_random_float( v, 7, 10.0f, 2000.0f ); // 1/kg; some are pinned
        s->velocity[v][3] = (float)v;
    }
    const int32_t* corner = s->ball.fabric->triangles;
    memcpy( position[corner[0]], position[corner[1]], 3 * sizeof( float ) ); // triangles without area
    if ( s->is_strange )
    {
        make_strange( position, s->velocity );
    }
    memcpy( s->old_velocity, s->velocity, sizeof( s->velocity ) );
}

static wisp_strip_air_args job_of( air_scene* s )
{
    return ( wisp_strip_air_args ){
        .position = s->ball.position[0],
        .velocity = s->velocity[0],
        .sum = s->sum[0],
        .strips = s->ball.fabric->strips,
        .wind = { 3.0f, -1.0f, 0.5f },
        .density = 1.2f,
        .drag = 1.1f,
        .lift = s->lift,
        .dt = 1.0f / 600.0f,
    };
}

// Slices are cut, whose velocities are read by all strips before.
static void run_air( const wisp_kernels* kernels, void* state, int begin, int end )
{
    const wisp_strip_air_args args = job_of( state );
    if ( begin == 0 )
    {
        kernels->strip_air( &args, 0, args.strips.order.slot_count );
    }
    kernels->blow( &args, begin, end );
}

static double3 combine( double s, double3 a, double t, double3 b )
{
    return double3_add_scaled( double3_scale( s, a ), t, b );
}

// F = 1/2 rho A |u . n| ( C_d u + C_l ( |u| n' - (u . n') / |u| u ) )
static double3 triangle_force( const wisp_strip_air_args* args, air_scene* s, const int32_t slots[3], double* rate )
{
    const double3 p = double3_from( s->ball.position[slots[0]] );
    const double3 e = combine( 1.0, double3_from( s->ball.position[slots[1]] ), -1.0, p );
    const double3 f = combine( 1.0, double3_from( s->ball.position[slots[2]] ), -1.0, p );
    const double3 normal = double3_cross( e, f );
    double3 u = double3_widen( args->wind );
    for ( int k = 0; k < 3; ++k )
    {
        u = combine( 1.0, u, -1.0 / 3.0, double3_from( s->old_velocity[slots[k]] ) );
    }
    const double area = 0.5 * double3_length( normal ), speed = double3_length( u );
    *rate = 0.0;
    if ( area == 0.0 )
    {
        return ( double3 ){ 0.0, 0.0, 0.0 };
    }
    const double facing = double3_dot( u, normal ) / ( 2.0 * area );
    const double3 n = combine( ( facing < 0.0 ? -1.0 : 1.0 ) / ( 2.0 * area ), normal, 0.0, normal );
    const double pressure = 0.5 * (double)args->density * area * fabs( facing );
    const double3 foreign = combine( speed, n, -double3_dot( u, n ) / speed, u );
    *rate = pressure * ( (double)args->drag + (double)args->lift );
    return combine( pressure * (double)args->drag, u, pressure * (double)args->lift, foreign );
}

static double3 air_velocity( air_scene* s, int v )
{
    const wisp_strip_air_args args = job_of( s );
    double3 force = { 0.0, 0.0, 0.0 };
    double rate = 0.0;
    for ( int t = 0; t < s->ball.fabric->triangle_count; ++t )
    {
        const int32_t* slots = s->ball.fabric->triangles + 3 * t;
        if ( slots[0] == v || slots[1] == v || slots[2] == v )
        {
            double own;
            force = combine( 1.0, force, 1.0 / 3.0, triangle_force( &args, s, slots, &own ) );
            rate += own / 3.0;
        }
    }
    const double w = (double)s->ball.position[v][3], dt = (double)args.dt;
    const double3 step = double3_scale( dt * w / ( 1.0 + dt * w * rate ), force ), wind = double3_widen( args.wind );
    const double3 before = combine( 1.0, double3_from( s->old_velocity[v] ), -1.0, wind );
    const double3 after = combine( 1.0, before, 1.0, step );
    // lift turns the relative wind: only the part of a step along it changes the speed
    const double speed = double3_length( before );
    const double left = fabs( speed + double3_dot( step, before ) / speed );
    return combine( 1.0, wind, s->lift > 0.0f ? left / double3_length( after ) : 1.0, after );
}

// What is pinned keeps its velocity, and a corner that is not finite spoils no neighbour.
static void check_air( void* start, void* end )
{
    (void)start;
    air_scene* s = end;
    for ( int v = 0; v < s->ball.fabric->vertex_count; ++v )
    {
        const double3 found = double3_from( s->velocity[v] );
        if ( s->ball.position[v][3] == 0.0f )
        {
            assert_memory_equal( s->velocity[v], s->old_velocity[v], sizeof( s->velocity[v] ) );
        }
        else if ( s->is_strange )
        {
            assert_true( v == 26 || isfinite( double3_length( found ) ) );
        }
        else
        {
            // forces of a few newtons on as little as half a gram are reduced by the implicit rate: the result is below
            // the speeds of wind and vertices, and so is its rounding, about thirty times
            assert_near3( found, air_velocity( s, v ), 30.0 * 10.0 * (double)FLT_EPSILON, "velocity of slot", v );
            assert_true( s->velocity[v][3] == (float)v );
        }
    }
}

TEST( a_vertex_takes_a_third_of_the_air_on_its_triangles )
{
    kernel_row row = *KERNEL_ROW( air_scene, 4, 0, BALL_SLICES, 1, fill_air, run_air, check_air );
    row.release = release_ball;
    check_kernel( &row );
}
