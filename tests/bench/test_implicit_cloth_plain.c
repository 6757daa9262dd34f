// The scalar C implicit cloth against the double oracle and the engine: a comparison of times is meaningful only if
// both sides compute the same.
#include "unit.h"

#include "oracle/triangle_oracle.h"
#include "plain/implicit_cloth_plain.h"
#include "triangle_scene.h"

enum
{
    VERTICES = 120,
    STEPS = 25,
};

static const float TOLERANCE = 1e-7f;

typedef struct fixture
{
    triangle_scene scene;
    plain_implicit_material material;
    double3* points;
    double* masses;
} fixture;

static int make_fixture( void** state )
{
    fixture* f = calloc( 1, sizeof( fixture ) );
    wisp_error error = { 0 };
    if ( !f || triangle_scene_make( VERTICES, &f->scene, &error ) != WISP_OK )
    {
        free( f );
        return 1;
    }
    f->material = ( plain_implicit_material ){
        .stretch_stiffness = 200.0f,
        .bend_stiffness = 1e-3f, // so stiff that arcs are reached
        .compression_stiffness = 200.0f,
        .damping = 0.02f,
        .area_density = TRIANGLE_DENSITY,
        .gravity = { 0.0f, -TRIANGLE_GRAVITY, 0.0f },
        .tolerance = TOLERANCE,
    };
    f->points = calloc( VERTICES, sizeof( double3 ) );
    f->masses = calloc( VERTICES, sizeof( double ) );
    for ( int v = 0; v < VERTICES; ++v )
    {
        f->points[v] = double3_widen( f->scene.mesh.points[v] );
    }
    *state = f;
    return 0;
}

static int free_fixture( void** state )
{
    fixture* f = *state;
    triangle_scene_free( &f->scene );
    free( f->points );
    free( f->masses );
    free( f );
    return 0;
}

static plain_implicit_cloth make_plain( const fixture* f )
{
    plain_implicit_cloth cloth;
    const wisp_mesh* mesh = &f->scene.mesh;
    assert_true( plain_implicit_cloth_create( &cloth, mesh->points, VERTICES, mesh->triangles, mesh->triangle_count,
                                              &f->material ) );
    return cloth;
}

static triangle_oracle make_oracle( const fixture* f )
{
    const wisp_mesh* mesh = &f->scene.mesh;
    const triangle_oracle_def def = { .count = VERTICES,
                                      .points = f->points,
                                      .triangle_count = mesh->triangle_count,
                                      .triangles = mesh->triangles,
                                      .masses = f->masses };
    triangle_oracle_params params = triangle_oracle_default_params();
    params.bend_stiffness = (double)f->material.bend_stiffness;
    triangle_oracle_lump( &def, (double)f->material.area_density, f->masses );
    return triangle_oracle_create( &def, &params );
}

static void its_springs_and_masses_are_those_of_the_oracle( void** state )
{
    plain_implicit_cloth plain = make_plain( *state );
    triangle_oracle oracle = make_oracle( *state );
    assert_int_equal( plain.spring_count, oracle.link_count );
    assert_int_equal( plain.edge_count, oracle.stretch_count );
    for ( int i = 0; i < plain.spring_count; ++i )
    {
        const plain_spring* s = &plain.springs[i];
        const triangle_oracle_link* link = &oracle.link[i];
        assert_true( s->a == link->i && s->b == link->j && s->bends == link->bends );
        assert_true( fabs( (double)s->rest - link->length ) <= 4.0 * (double)FLT_EPSILON * link->length );
    }
    for ( int v = 0; v < VERTICES; ++v )
    {
        // a dozen triangles are added up, each with a few roundings
        assert_true( fabs( (double)plain.mass[v] - oracle.mass[v] ) <= 32.0 * (double)FLT_EPSILON * oracle.mass[v] );
    }
    triangle_oracle_destroy( &oracle );
    plain_implicit_cloth_destroy( &plain );
}

static double farthest( const plain_implicit_cloth* plain, const triangle_oracle* oracle )
{
    double most = 0.0;
    for ( int v = 0; v < VERTICES; ++v )
    {
        most = fmax( most, double3_distance( double3_widen( plain->position[v] ), oracle->x[v] ) );
    }
    return most;
}

static void a_hanging_cloth_moves_as_that_of_the_oracle( void** state )
{
    plain_implicit_cloth plain = make_plain( *state );
    triangle_oracle oracle = make_oracle( *state );
    plain_implicit_cloth_pin( &plain, 0 );
    plain_implicit_cloth_pin( &plain, 1 );
    triangle_oracle_pin( &oracle, 0 );
    triangle_oracle_pin( &oracle, 1 );
    for ( int step = 0; step < STEPS; ++step )
    {
        plain_implicit_cloth_step( &plain, 0.01f );
        triangle_oracle_step( &oracle, 0.01, NULL );
        assert_true( plain.is_solved );
    }
    // a rounding of coordinates of 1 m per step, and some more from forces; solves end far below that
    assert_true( oracle.x[VERTICES - 1].y < 0.95 );
    assert_true( farthest( &plain, &oracle ) < 32.0 * (double)FLT_EPSILON );
    assert_true( plain.iterations_all > STEPS );
    triangle_oracle_destroy( &oracle );
    plain_implicit_cloth_destroy( &plain );
}

static void a_hanging_cloth_moves_as_that_of_the_engine( void** state )
{
    const fixture* f = *state;
    static const int32_t pins[2] = { 0, 1 };
    plain_implicit_cloth plain = make_plain( f );
    plain_implicit_cloth_pin( &plain, pins[0] );
    plain_implicit_cloth_pin( &plain, pins[1] );
    triangle_setting setting = triangle_default_setting();
    setting.cloth.bend_stiffness = f->material.bend_stiffness;
    setting.cloth.tolerance = TOLERANCE;
    setting.has_ball = false;
    setting.pins = pins;
    setting.pin_count = 2;
    surface_implementation ours;
    wisp_error error = { 0 };
    assert_int_equal( triangle_enter( &f->scene, &setting, &ours, &error ), WISP_OK );
    const wisp_vec3* points = NULL;
    for ( int step = 0; step < STEPS; ++step )
    {
        plain_implicit_cloth_step( &plain, setting.seconds );
        assert_int_equal( surface_implementation_step( &ours, &error ), WISP_OK );
    }
    assert_int_equal( surface_implementation_points( &ours, &points, &error ), WISP_OK );
    for ( int v = 0; v < VERTICES; ++v )
    {
        // twice as far as scalar C may be from the oracle
        assert_true( double3_distance( double3_widen( plain.position[v] ), double3_widen( points[v] ) ) <
                     64.0 * (double)FLT_EPSILON );
    }
    surface_implementation_destroy( &ours );
    plain_implicit_cloth_destroy( &plain );
}

static void what_nothing_holds_falls_freely( void** state )
{
    plain_implicit_cloth plain = make_plain( *state );
    for ( int step = 0; step < STEPS; ++step )
    {
        plain_implicit_cloth_step( &plain, 0.01f );
    }
    // v_n = n h g, x by its sum; every step rounds coordinates of 1 m and velocities of 2 m/s, which remains until
    // the end
    const double v = STEPS * 0.01 * 9.81, y = 1.0 - 9.81 * 1e-4 * STEPS * ( STEPS + 1 ) / 2.0;
    for ( int i = 0; i < VERTICES; ++i )
    {
        assert_true( fabs( (double)plain.velocity[i].y + v ) < STEPS * 4.0 * (double)FLT_EPSILON );
        assert_true( fabs( (double)plain.position[i].y - y ) < STEPS * 4.0 * (double)FLT_EPSILON );
    }
    plain_implicit_cloth_destroy( &plain );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( its_springs_and_masses_are_those_of_the_oracle ),
        cmocka_unit_test( a_hanging_cloth_moves_as_that_of_the_oracle ),
        cmocka_unit_test( a_hanging_cloth_moves_as_that_of_the_engine ),
        cmocka_unit_test( what_nothing_holds_falls_freely ),
    };
    return cmocka_run_group_tests_name( "implicit_cloth_plain", tests, make_fixture, free_fixture );
}
