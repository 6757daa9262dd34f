// The scalar C cloth against each equation in double precision: a comparison of times is meaningful only if both
// sides compute the same.
#include "unit.h"

#include "oracle/constraint_oracle.h"
#include "plain/cloth_plain.h"

enum
{
    SIDE = 4,
    VERTICES = SIDE * SIDE,
    TRIANGLES = 2 * ( SIDE - 1 ) * ( SIDE - 1 ),
};

static const float SPACING = 0.25f;

typedef struct patch
{
    wisp_vec3 points[VERTICES];
    int32_t triangles[3 * TRIANGLES];
} patch;

static patch make_patch( void )
{
    patch p;
    int count = 0;
    for ( int v = 0; v < VERTICES; ++v )
    {
        p.points[v] = ( wisp_vec3 ){ SPACING * (float)( v % SIDE ), 0.0f, SPACING * (float)( v / SIDE ) };
    }
    for ( int j = 0; j + 1 < SIDE; ++j )
    {
        for ( int i = 0; i + 1 < SIDE; ++i )
        {
            int32_t a = j * SIDE + i, b = a + 1, c = a + SIDE, d = c + 1;
            const int32_t corners[6] = { a, c, d, a, d, b };
            for ( int k = 0; k < 6; ++k )
            {
                p.triangles[count++] = corners[k];
            }
        }
    }
    return p;
}

static plain_cloth make_cloth( const patch* p, float mass, float bend_stiffness )
{
    plain_cloth cloth;
    assert_true( plain_cloth_create( &cloth, p->points, VERTICES, p->triangles, TRIANGLES, mass, bend_stiffness ) );
    return cloth;
}

// Positions at which every link is deformed, the same in every run.
static void shake( plain_cloth* cloth )
{
    for ( int v = 0; v < cloth->vertex_count; ++v )
    {
        cloth->position[v].x += 0.03f * (float)( ( 7 * v ) % 5 - 2 );
        cloth->position[v].y += 0.02f * (float)( ( 5 * v ) % 7 - 3 );
        cloth->position[v].z += 0.01f * (float)( ( 3 * v ) % 11 - 5 );
    }
}

static void every_edge_is_a_link_once_and_every_interior_edge_a_pair( void** state )
{
    (void)state;
    patch p = make_patch();
    plain_cloth cloth = make_cloth( &p, 1.0f, 0.2f );
    int rows = SIDE * ( SIDE - 1 ), diagonals = ( SIDE - 1 ) * ( SIDE - 1 ), border = 4 * ( SIDE - 1 );
    assert_int_equal( cloth.edge_count, 2 * rows + diagonals );
    assert_int_equal( cloth.link_count - cloth.edge_count, cloth.edge_count - border );
    for ( int i = 0; i < cloth.link_count; ++i )
    {
        const plain_link* link = &cloth.links[i];
        double rest = double3_distance( double3_widen( p.points[link->a] ), double3_widen( p.points[link->b] ) );
        assert_true( fabs( (double)link->rest - rest ) <= 2.0 * (double)FLT_EPSILON );
        assert_true( link->stiffness == ( i < cloth.edge_count ? 1.0f : 0.2f ) );
    }
    plain_cloth_destroy( &cloth );
}

static void a_pass_is_equation_6_link_by_link( void** state )
{
    (void)state;
    patch p = make_patch();
    plain_cloth cloth = make_cloth( &p, 0.5f, 0.2f );
    plain_cloth_pin( &cloth, 0 );
    shake( &cloth );
    double3 expected[VERTICES];
    for ( int v = 0; v < VERTICES; ++v )
    {
        expected[v] = double3_widen( cloth.position[v] );
    }
    for ( int i = 0; i < cloth.link_count; ++i )
    {
        const plain_link* link = &cloth.links[i];
        double3 da, db;
        constraint_oracle_distance_step( expected[link->a], expected[link->b], (double)cloth.inverse_mass[link->a],
                                         (double)cloth.inverse_mass[link->b], (double)link->rest, &da, &db );
        expected[link->a] = double3_add( expected[link->a], double3_scale( (double)link->stiffness, da ) );
        expected[link->b] = double3_add( expected[link->b], double3_scale( (double)link->stiffness, db ) );
    }
    plain_cloth_project( &cloth );
    for ( int v = 0; v < VERTICES; ++v )
    {
        // coordinates below 1 m, a dozen links at a vertex and the roundings of their neighbours
        assert_true( double3_distance( double3_widen( cloth.position[v] ), expected[v] ) <
                     64.0 * (double)FLT_EPSILON );
    }
    plain_cloth_destroy( &cloth );
}

static void free_fall_is_the_sum_of_its_substeps( void** state )
{
    (void)state;
    patch p = make_patch();
    plain_cloth cloth = make_cloth( &p, 1.0f, 0.2f );
    cloth.substeps = 4;
    for ( int step = 0; step < 10; ++step )
    {
        plain_cloth_step( &cloth, 0.01f );
    }
    // symplectic Euler: g h^2 (1 + 2 + ... + n)
    double h = 0.0025, n = 40.0, fallen = 9.81 * h * h * n * ( n + 1.0 ) / 2.0;
    for ( int v = 0; v < VERTICES; ++v )
    {
        // every substep rounds a coordinate and its velocity, which remains until the end: 40^2 roundings of 0.1 m
        assert_true( fabs( (double)cloth.position[v].y + fallen ) < 1600.0 * 0.1 * (double)FLT_EPSILON );
    }
    plain_cloth_destroy( &cloth );
}

static void a_pinned_vertex_stays_and_its_neighbours_hang( void** state )
{
    (void)state;
    patch p = make_patch();
    plain_cloth cloth = make_cloth( &p, 1.0f, 0.2f );
    plain_cloth_pin( &cloth, 0 );
    plain_cloth_pin( &cloth, SIDE - 1 );
    cloth.substeps = 10;
    for ( int step = 0; step < 30; ++step )
    {
        plain_cloth_step( &cloth, 1.0f / 60.0f );
    }
    assert_memory_equal( &cloth.position[0], &p.points[0], sizeof( wisp_vec3 ) );
    assert_memory_equal( &cloth.position[SIDE - 1], &p.points[SIDE - 1], sizeof( wisp_vec3 ) );
    assert_true( cloth.position[VERTICES - 1].y < -SPACING );
    plain_cloth_destroy( &cloth );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( every_edge_is_a_link_once_and_every_interior_edge_a_pair ),
        cmocka_unit_test( a_pass_is_equation_6_link_by_link ),
        cmocka_unit_test( free_fall_is_the_sum_of_its_substeps ),
        cmocka_unit_test( a_pinned_vertex_stays_and_its_neighbours_hang ),
    };
    return cmocka_run_group_tests_name( "cloth_plain", tests, NULL, NULL );
}
