// Drag on vertices: every table gives the same bits, and forces agree with the formula in doubles.
#include "kernels_fixture.h"

#include "double3.h"

enum
{
    SLOTS = 96,
};

typedef struct skin
{
    _Alignas( 64 ) float position[SLOTS][4], velocity[SLOTS][4], vectors[SLOTS / 8][3][8];
    _Alignas( 64 ) float areas[SLOTS];
} skin;

// Some are pinned, at rest, or with a vector that cancels.
static skin* new_skin( void )
{
    skin* s = checked_calloc( 1, sizeof( *s ) );
    for ( int i = 0; i < SLOTS; ++i )
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

TEST( every_table_gives_the_same_bits )
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
            kernels->sum_vertex_drag( &args, 8, SLOTS, sum[k] );
            kernels->vertex_drag( &args, 8, SLOTS );
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
    widest_table()->sum_vertex_drag( &args, 8, SLOTS, sum );
    widest_table()->vertex_drag( &args, 8, SLOTS );
    for ( int i = 0; i < SLOTS; ++i )
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
