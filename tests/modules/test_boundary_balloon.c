// The balloon of the boundary particle paper in the engine: the sample run with its gust. Its layer is compared with the oracle's for the
// same positions. Volumes, long steps and strong gravity are in tests/claims/balloon.yaml.
#include "boundary_fixture.h"
#include "boundary_oracle_fixture.h"

#include "balloon.h"

// of the paper's program
static const float SPACING = 0.1f, SKIN = 0.9f, STEP = 1.0f / 60.0f; // m, 1, s
static const double DECAY = 31.7;                                    // 1/s: velocity times 0.59 in 1/60 s

typedef struct balloon
{
    test_host host;
    test_log log;
    wisp_world* world;
    wisp_entity sphere;
    balloon_mesh mesh;
} balloon;

static wisp_entity add_sphere( balloon* b )
{
    SCOPED( free_local ) wisp_vec3* points = checked_calloc( (size_t)b->mesh.vertex_count, sizeof( wisp_vec3 ) );
    for ( int i = 0; i < b->mesh.vertex_count; ++i )
    {
        const double3 p = b->mesh.positions[i];
        points[i] = ( wisp_vec3 ){ (float)p.x, (float)p.y, (float)p.z };
    }
    wisp_fabric_def fabric = wisp_default_fabric_def();
    fabric.points = points;
    fabric.vertex_count = b->mesh.vertex_count;
    fabric.triangles = b->mesh.triangles;
    fabric.triangle_count = b->mesh.triangle_count;
    fabric.bend_links = false;
    wisp_surface_def surface = wisp_default_surface_def();
    surface.area_density = 0.0f;
    surface.vertex_mass = 1.0f;
    surface.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    return test_surface_of( b->world, &fabric, surface );
}

static void fill( balloon* b )
{
    wisp_balloon_def def = wisp_default_balloon_def();
    def.solver = def.volume = WISP_SOLVER_PBD;
    def.stretch_stiffness = SKIN;
    def.bend_stiffness = 0.0f;
    def.volume_stiffness = 1.0f;
    def.gas_ratio = 1.0f;
    def.min_gas_ratio = 0.001f;
    def.buoyancy = false; // not in the paper
    def.drag_coefficient = 0.0f;
    // the engine's implicit step of a rate that keeps the same velocity as the paper's decay, for any step
    const double damping = expm1( DECAY * (double)STEP ) / (double)STEP;
    assert_int_equal( wisp_set_damping( b->world, b->sphere, (float)damping ), WISP_OK );
    assert_int_equal( wisp_set_balloon( b->world, b->sphere, &def ), WISP_OK );
    assert_int_equal( wisp_request_balloon_stats( b->world, b->sphere, true ), WISP_OK );
    assert_int_equal( wisp_request( b->world, b->sphere, WISP_SURFACE_POINTS ), WISP_OK );
    const wisp_boundary_def layer = ball_layer( SPACING );
    assert_int_equal( wisp_set_boundary( b->world, b->sphere, &layer ), WISP_OK );
}

static balloon* open_balloon( void )
{
    static const wisp_module* const MODULES[] = { &wisp_boundary_module, &wisp_balloon_module };
    balloon* b = checked_calloc( 1, sizeof( balloon ) );
    wisp_world_def def = wisp_default_world_def();
    def.modules = MODULES;
    def.module_count = WISP_COUNT( MODULES );
    def.allocator = test_host_allocator( &b->host );
    def.log = test_log_write;
    def.log_user = &b->log;
    def.workers = 1;
    def.substeps = 1;
    def.iterations = 5;
    assert_int_equal( wisp_world_create( &def, &b->world, NULL ), WISP_OK );
    b->mesh = reference_sphere();
    b->sphere = add_sphere( b );
    fill( b );
    return b;
}

static void close_balloon( balloon* b )
{
    wisp_world_destroy( b->world );
    assert_host_memory_is_released( &b->host );
    balloon_mesh_destroy( &b->mesh );
    free( b );
}

static void step_balloon( balloon* b )
{
    if ( wisp_world_step( b->world, STEP ) != WISP_OK )
    {
        fail_msg( "no step: %s", wisp_world_message( b->world ) );
    }
}

static wisp_balloon_stats balloon_stats( balloon* b )
{
    wisp_balloon_stats stats;
    assert_int_equal( wisp_read_balloon_stats( b->world, b->sphere, &stats ), WISP_OK );
    return stats;
}

// ---- the sample run ----

enum
{
    REST = 10, // steps at a multiplier of 1
    RAMP = 60, // steps from 1 to 2, and back
    HOLD = 40, // steps at 2; the gust acts in their middle
    GUST = REST + RAMP + HOLD / 2,
    SHRINKS = REST + RAMP + HOLD,
    END = SHRINKS + RAMP + REST,
};

static float gas_ratio_at( int step )
{
    const double up = (double)( step - REST ) / RAMP, down = (double)( SHRINKS + RAMP - step ) / RAMP;
    return (float)( 1.0 + fmin( 1.0, fmax( 0.0, fmin( up, down ) ) ) );
}

// A point is a sum of three products with computed weights: some roundings of its largest coordinate.
static void assert_layer_is_the_oracles( balloon* b, boundary_oracle_layer* oracle, double3* x )
{
    wisp_boundary_view view;
    double reach = 0.0;
    for ( int i = 0; i < b->mesh.vertex_count; ++i )
    {
        x[i] = double3_widen( point_of( b->world, b->sphere, i ) );
        reach = fmax( reach, double3_length( x[i] ) );
    }
    must_update( oracle, x );
    assert_int_equal( wisp_read_boundary( b->world, b->sphere, &view ), WISP_OK );
    assert_int_equal( view.samples->edge_count, oracle->edge_point_count );
    assert_int_equal( view.samples->count, oracle->point_count );
    for ( int p = 0; p < oracle->point_count; ++p )
    {
        const double3 y = double3_from( view.samples->xyzw + 4 * (size_t)p );
        assert_close( double3_distance( y, oracle->points[p].y ), 0.0, 8.0 * (double)FLT_EPSILON * reach );
    }
}

// As printed: each triangle that the gust meets passes it to its three vertices. Velocities decay as a geometric series, and neither
// links nor volume move the centre.
static double gust_at_centre( balloon* b, const double gust[3] )
{
    static const wisp_vec3 GUST_KEY = { 0.5f, 0.25f, 0.5f }; // m/s, of the paper's program
    const wisp_fabric* f = wisp_world_fabric( b->world, b->sphere );
    const float* v = wisp_world_column( b->world, b->sphere, WISP_PARTICLE_VELOCITY, 0 );
    double sum = 0.0;
    for ( int after = 0; after < 2; ++after )
    {
        for ( int i = 0; i < 3 * f->vertex_count; ++i )
        {
            const double one = gust[i % 3] * (double)v[4 * (size_t)f->vertex_slot[i / 3] + (size_t)( i % 3 )];
            sum += after == 1 ? one : -one;
        }
        if ( after == 0 )
        {
            assert_int_equal( wisp_apply_gust( b->world, b->sphere, GUST_KEY, true ), WISP_OK );
        }
    }
    return sum / f->vertex_count;
}

TEST( the_sample_run_has_the_oracles_points_in_each_step_and_its_gust_moves_the_centre )
{
    const double gust[3] = { 2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0 }, dt = (double)STEP;
    balloon* b = open_balloon();
    const boundary_oracle_options options = { .spacing = (double)SPACING, .cap = 1e6 };
    boundary_oracle_layer oracle = layer_on( &b->mesh, &options );
    double3* x = checked_calloc( (size_t)b->mesh.vertex_count, sizeof( double3 ) );
    double start = 0.0, expected = 0.0;
    for ( int step = 1; step <= END; ++step )
    {
        assert_int_equal( wisp_set_balloon_gas_ratio( b->world, b->sphere, gas_ratio_at( step ) ), WISP_OK );
        if ( step == GUST )
        {
            expected = gust_at_centre( b, gust ) * dt / ( 1.0 - exp( -DECAY * dt ) );
        }
        step_balloon( b );
        assert_layer_is_the_oracles( b, &oracle, x );
        const wisp_balloon_stats stats = balloon_stats( b );
        const double along = gust[0] * stats.centre[0] + gust[1] * stats.centre[1] + gust[2] * stats.centre[2];
        start = step < GUST ? along : start;
        expected += step == END ? start - along : 0.0;
    }
    print_message( "the centre is %.2g m from where the gust takes it\n", fabs( expected ) );
    assert_close( expected, 0.0, 0.01 * 0.06 );
    boundary_oracle_destroy( &oracle );
    free( x );
    close_balloon( b );
}
