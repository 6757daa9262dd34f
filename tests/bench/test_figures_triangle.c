// Noh and Jung: energy in free flight (section 3.3), and edges, hems and folds on the ball (Fig. 8 and 10). Rest
// and depth are in data/suites/figures/drape.yaml.
#include "app/scene_world_fixture.h"

#include "implicit_cloth/implicit_cloth.h"
#include "oracle/triangle_oracle.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

// ---- section 3.3 ----

static const float STRETCHED = 1.1f;

// Share of a row's mass in the vertex's. @param fraction [vertex_count]
static void weigh_rows( const wisp_mesh* mesh, double* fraction )
{
    const size_t count = (size_t)mesh->vertex_count;
    double3* points = checked_calloc( count, sizeof( double3 ) );
    double* masses = checked_calloc( count, sizeof( double ) );
    for ( size_t i = 0; i < count; ++i )
    {
        points[i] = double3_widen( mesh->points[i] );
        masses[i] = 1.0;
    }
    const triangle_oracle_params params = triangle_oracle_default_params();
    const triangle_oracle_def def = { .count = mesh->vertex_count,
                                      .points = points,
                                      .triangle_count = mesh->triangle_count,
                                      .triangles = mesh->triangles,
                                      .masses = masses };
    triangle_oracle oracle = triangle_oracle_create( &def, &params );
    memcpy( fraction, oracle.mass, count * sizeof( double ) );
    triangle_oracle_destroy( &oracle );
    free( points );
    free( masses );
}

// Kinetic energy with the masses of the rows, stretch of eq. 5 and potential of eq. 12, in J.
static double energy_of( const fixture* f, const double* fraction, double* solves )
{
    wisp_implicit_cloth_stats seen;
    wisp_world* world = f->world.world;
    const scene_world_surface* cloth = f->world.surfaces;
    assert_int_equal( wisp_read_implicit_cloth_stats( world, cloth->entity, &seen ), WISP_OK );
    const float* position = wisp_world_column( world, cloth->entity, WISP_PARTICLE_POSITION, 0 );
    const float* velocity = wisp_world_column( world, cloth->entity, WISP_PARTICLE_VELOCITY, 0 );
    double sum = seen.stretch_energy + seen.bend_energy;
    for ( int i = 0; i < cloth->fabric->vertex_count; ++i )
    {
        const size_t row = 4 * (size_t)cloth->fabric->vertex_slot[i];
        const double x = (double)velocity[row], y = (double)velocity[row + 1], z = (double)velocity[row + 2];
        sum += 0.5 * fraction[i] / (double)position[row + 3] * ( x * x + y * y + z * z );
    }
    *solves += seen.newton_iterations;
    return sum;
}

// A cloth that is stretched by a tenth and spins flies free for 10 s. @return J at the end
static double fly( double damping, const char* integrator )
{
    enum
    {
        STEPS = 1000,
    };
    char text[600];
    SCOPED( release ) fixture f;
    snprintf( text, sizeof text,
              "wisp: 1\ndt: 0.01\nsubsteps: 1\niterations: 1\nsteps: 1000\ngravity: [0, 0, 0]\nsurfaces:\n"
              "  - name: cloth\n    generate: { shape: delaunay, width: 1, depth: 1, vertices: 250 }\n"
              "    transform: { translate: [0, 1, 0] }\n    area_density: 0.2\n"
              "    implicit: { stiffness_model: link, weights: effective, tolerance: 1e-4, link_damping: %g, "
              "integrator: %s }\n",
              damping, integrator );
    build( &f, text );
    const scene_world_surface* cloth = f.world.surfaces;
    SCOPED( free_local )
    double* fraction = checked_calloc( (size_t)cloth->mesh.vertex_count, sizeof( double ) );
    weigh_rows( &cloth->mesh, fraction );
    float* position = wisp_world_column( f.world.world, cloth->entity, WISP_PARTICLE_POSITION, 0 );
    for ( int i = 0; i < cloth->fabric->vertex_count; ++i )
    {
        position[4 * cloth->fabric->vertex_slot[i]] *= STRETCHED;
        position[4 * cloth->fabric->vertex_slot[i] + 2] *= STRETCHED;
    }
    assert_int_equal( wisp_request_implicit_cloth_stats( f.world.world, cloth->entity, true ), WISP_OK );
    assert_int_equal( wisp_set_velocity( f.world.world, cloth->entity, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f },
                                         ( wisp_vec3 ){ 1.0f, 4.0f, 0.5f } ),
                      WISP_OK );
    double least = INFINITY, energy = 0.0, solves = 0.0;
    for ( int i = 0; i < STEPS; ++i )
    {
        step( &f, 1 );
        energy = energy_of( &f, fraction, &solves );
        // never 1 % above its least so far: against the first nothing could rise, as three quarters of it go in one step
        assert_true( energy <= 1.01 * least );
        least = fmin( least, energy );
    }
    assert_int_equal( wisp_world_counter( f.world.world, WISP_COUNT_HALTED ), 0 );
    // the guard costs little: the paper's single solve is what most steps make
    assert_true( solves < 1.5 * STEPS );
    return energy;
}

TEST( a_free_cloth_never_rises_above_its_least_energy_and_loses_more_with_more_damping )
{
    static const double dampings[] = { 0.0, 0.002, 0.02, 0.2 };
    double last = INFINITY;
    for ( int i = 0; i < WISP_COUNT( dampings ); ++i )
    {
        const double left = fly( dampings[i], "euler" );
        assert_true( left < last );
        last = left;
    }
    (void)fly( 0.0, "bdf2" );
    (void)fly( 0.002, "bdf2" );
}

// ---- figures 8 and 10 ----

enum
{
    PLACES = 240,     // round the border
    WINDOW = 5,       // places that it is smoothed over, each way: 18 cm of 4 m
    BORDER_MAX = 400, // vertices
};

typedef struct border_vertex
{
    double place; // share of the border's length at rest
    int vertex;
} border_vertex;

static int by_place( const void* a, const void* b )
{
    const double x = ( (const border_vertex*)a )->place, y = ( (const border_vertex*)b )->place;
    return ( x > y ) - ( x < y );
}

// The border of the square of 1 m at rest, one vertex after another. @return their number
static int find_border( const wisp_mesh* mesh, border_vertex* out )
{
    int count = 0;
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        const double x = (double)mesh->points[i].x, z = (double)mesh->points[i].z;
        if ( fmax( fabs( x ), fabs( z ) ) > 0.4999 )
        {
            assert_true( count < BORDER_MAX );
            const double along = z < -0.4999 ? x + 0.5 : x > 0.4999 ? z + 1.5 : z > 0.4999 ? 2.5 - x : 3.5 - z;
            out[count++] = ( border_vertex ){ along / 4.0, i };
        }
    }
    qsort( out, (size_t)count, sizeof *out, by_place );
    return count;
}

// How far from the ball's axis the border is, at places that are evenly apart at rest, smoothed.
static void measure_border( const border_vertex* border, int count, const wisp_vec3* points, double* even )
{
    double radius[PLACES];
    for ( int i = 0, k = 0; i < PLACES; ++i )
    {
        const double place = (double)i / PLACES;
        while ( k + 1 < count && border[k + 1].place <= place )
        {
            ++k;
        }
        const double to = k + 1 < count ? border[k + 1].place : 1.0;
        const float t = (float)( ( place - border[k].place ) / ( to - border[k].place ) );
        const wisp_vec3 a = points[border[k].vertex], b = points[border[( k + 1 ) % count].vertex];
        radius[i] = hypot( (double)( a.x + t * ( b.x - a.x ) ), (double)( a.z + t * ( b.z - a.z ) ) );
    }
    for ( int i = 0; i < PLACES; ++i )
    {
        even[i] = 0.0;
        for ( int k = -WINDOW; k <= WINDOW; ++k )
        {
            even[i] += radius[( i + k + PLACES ) % PLACES] / ( 2 * WINDOW + 1 );
        }
    }
}

// Maxima from which the border falls by 1 cm on both sides, from the lowest place on, where a rise must begin.
static int count_folds( const double* even )
{
    int first = 0, folds = 0;
    for ( int i = 1; i < PLACES; ++i )
    {
        first = even[i] < even[first] ? i : first;
    }
    bool rises = true;
    double extreme = even[first];
    for ( int i = 1; i <= PLACES; ++i )
    {
        const double value = even[( first + i ) % PLACES], turned = rises ? extreme - value : value - extreme;
        if ( turned < 0.0 )
        {
            extreme = value;
        }
        else if ( turned > 0.01 )
        {
            folds += rises ? 1 : 0;
            rises = !rises;
            extreme = value;
        }
    }
    return folds;
}

typedef struct hem
{
    double mean, lowest; // m, that it came down
    double stretch;      // of the longest edge
    int folds;
} hem;

static double longest_edge( const scene_world_surface* cloth, const wisp_vec3* points )
{
    const wisp_mesh* mesh = &cloth->mesh;
    double most = 0.0;
    for ( int i = 0; i < 3 * mesh->triangle_count; ++i )
    {
        const int a = mesh->triangles[i], b = mesh->triangles[i % 3 == 2 ? i - 2 : i + 1];
        const double rest = wisp_mesh_distance( mesh->points[a], mesh->points[b] );
        most = fmax( most, wisp_mesh_distance( points[a], points[b] ) / rest - 1.0 );
    }
    return most;
}

static hem drop( const char* file, float stiffness )
{
    SCOPED( release ) fixture f = { .scene = read_good( file ) };
    border_vertex border[BORDER_MAX];
    double even[PLACES];
    hem out = { .folds = 0 };
    f.scene.surfaces[0].implicit.stretch_stiffness = stiffness;
    create( &f, 1 );
    step( &f, 1500 );
    const scene_world_surface* cloth = f.world.surfaces;
    SCOPED( free_local )
    wisp_vec3* points = checked_calloc( (size_t)cloth->mesh.vertex_count, sizeof *points );
    assert_ok( scene_world_points( &f.world, 0, points, &f.error ), f.error );
    const int count = find_border( &cloth->mesh, border );
    for ( int i = 0; i < count; ++i )
    {
        const double down = (double)cloth->mesh.points[border[i].vertex].y - (double)points[border[i].vertex].y;
        out.mean += down / count;
        out.lowest = fmax( out.lowest, down );
    }
    measure_border( border, count, points, even );
    out.folds = count_folds( even );
    out.stretch = longest_edge( cloth, points );
    print_message( "           k %.0f: %d folds; the hem came down by %.4f m, %.4f at most; longest edge +%.2f %%\n",
                   (double)stiffness, out.folds, out.mean, out.lowest, 100.0 * out.stretch );
    return out;
}

// Quads above the ball have its fourfold symmetry, and so have their folds: 12. The irregular mesh can have any number: 9.
TEST( quads_hang_as_deep_as_triangles_and_fold_in_fours )
{
    const hem triangles = drop( "triangle_drape.yaml", 200.0f ), quads = drop( "quad_drape.yaml", 200.0f );
    assert_true( fabs( quads.mean / triangles.mean - 1.0 ) < 0.1 );
    assert_true( fabs( quads.lowest / triangles.lowest - 1.0 ) < 0.1 );
    assert_true( quads.folds > 0 && quads.folds % 4 == 0 && abs( quads.folds - triangles.folds ) <= 4 );
}

TEST( softer_cloth_has_longer_edges_and_a_lower_hem )
{
    const hem soft = drop( "triangle_drape.yaml", 50.0f ), usual = drop( "triangle_drape.yaml", 100.0f ),
              firm = drop( "triangle_drape.yaml", 350.0f );
    assert_true( soft.stretch > usual.stretch && usual.stretch > firm.stretch );
    assert_true( soft.mean > usual.mean && usual.mean > firm.mean );
}
