// Edges and triangles of surfaces against bodies: needles, box edges, small balls, friction, workers, refusals.
#include "collision_fixture.h"
#include "oracle/deepest_oracle.h"

static const float DT = 1.0f / 60.0f;
static const float CELL = 0.02f;
static const float THICKNESS = 0.005f;
static const float GRAVITY = 9.8f;

enum
{
    SIDE = 21, // vertices
};

typedef struct sheet
{
    hosted* h;
    wisp_entity surface, body;
    wisp_collider_def collider;
    wisp_transform pose; // of the collider now
    test_mesh mesh;
} sheet;

static wisp_vec3 middle_of_sheet( void )
{
    const float half = 0.5f * CELL * (float)( SIDE - 1 );
    return ( wisp_vec3 ){ half, 0.0f, half };
}

static bool is_border( int v )
{
    const int i = v % SIDE, k = v / SIDE;
    return i == 0 || k == 0 || i == SIDE - 1 || k == SIDE - 1;
}

// A sheet of cells of 2 cm in the plane y = 0, held at its border or free, and a body.
static sheet new_sheet( wisp_collision_features features, const wisp_collider_def* body, bool is_held, float gravity,
                        int substeps, int workers )
{
    sheet s = { .h = new_colliding( substeps, 1, workers ), .collider = *body, .pose = body->pose };
    s.body = add_collider( s.h->world, body );
    s.mesh = test_plane( SIDE, CELL );
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = THICKNESS;
    collision.features = features;
    s.surface = add_colliding( s.h->world, &s.mesh, &collision );
    wisp_cloth_def cloth = wisp_default_cloth_def();
    assert_int_equal( wisp_set_cloth( s.h->world, s.surface, &cloth ), WISP_OK );
    give_gravity( s.h->world, s.surface, gravity );
    for ( int32_t v = 0; is_held && v < s.mesh.vertex_count; ++v )
    {
        if ( is_border( v ) )
        {
            assert_int_equal( wisp_pin( s.h->world, s.surface, &v, 1 ), WISP_OK );
        }
    }
    return s;
}

static void free_sheet( sheet* s )
{
    test_mesh_free( &s->mesh );
    free_colliding( s->h );
}

static void move_body( sheet* s, wisp_transform pose )
{
    s->pose = pose;
    assert_int_equal( wisp_move_collider( s->h->world, s->body, pose ), WISP_OK );
}

static wisp_shape shape_of( const wisp_collider_def* d )
{
    const wisp_shape_kind kinds[] = { WISP_SHAPE_PLANE, WISP_SHAPE_SPHERE, WISP_SHAPE_CAPSULE, WISP_SHAPE_BOX };
    return ( wisp_shape ){ .kind = kinds[d->kind], .radius = d->radius, .half_length = d->half_length,
                           .half_extent = d->half_extent };
}

// Smallest signed distance of all triangles from the body, in double precision.
static double least_distance( const sheet* s )
{
    const wisp_shape shape = shape_of( &s->collider );
    const deepest_oracle_body body = deepest_oracle_body_of( &shape );
    double least = INFINITY;
    for ( int t = 0; t < s->mesh.triangle_count; ++t )
    {
        double3 corners[3], mean = { 0.0, 0.0, 0.0 };
        for ( int k = 0; k < 3; ++k )
        {
            const wisp_vec3 p = point_of( s->h->world, s->surface, s->mesh.triangles[3 * t + k] );
            corners[k] = double3_widen( wisp_transform_to_local( s->pose, p ) );
            mean = double3_add_scaled( mean, 1.0 / 3.0, corners[k] );
        }
        double radius = 0.0;
        for ( int k = 0; k < 3; ++k )
        {
            const double3 arm = double3_sub( corners[k], mean );
            radius = fmax( radius, sqrt( double3_dot( arm, arm ) ) );
        }
        if ( deepest_oracle_distance( &body, mean ) - radius < least )
        {
            least = fmin( least, deepest_oracle_find( &body, corners, 3, NULL ) );
        }
    }
    return least;
}

// Largest height of the sheet above a point, where a vertical line through it meets the sheet. A sheet that is carried may hang
// down below the point as well; one that was pierced is nowhere above. Infinite where the line does not meet it.
static double height_above( const sheet* s, wisp_vec3 at )
{
    double most = -INFINITY;
    for ( int t = 0; t < s->mesh.triangle_count; ++t )
    {
        double3 p[3];
        for ( int k = 0; k < 3; ++k )
        {
            p[k] = double3_sub( double3_widen( point_of( s->h->world, s->surface, s->mesh.triangles[3 * t + k] ) ),
                                double3_widen( at ) );
        }
        double w[3], sum = 0.0;
        for ( int k = 0; k < 3; ++k )
        {
            const double3 a = p[( k + 1 ) % 3], b = p[( k + 2 ) % 3];
            w[k] = a.x * b.z - a.z * b.x;
            sum += w[k];
        }
        if ( w[0] * sum >= 0.0 && w[1] * sum >= 0.0 && w[2] * sum >= 0.0 && sum != 0.0 )
        {
            most = fmax( most, ( w[0] * p[0].y + w[1] * p[1].y + w[2] * p[2].y ) / sum );
        }
    }
    return most > -INFINITY ? most : INFINITY;
}

// A needle of 1 mm radius below the middle of the sheet, in a direction that no edge has.
static wisp_collider_def lying_needle( float y )
{
    wisp_collider_def d = body_of( WISP_COLLIDER_CAPSULE );
    const wisp_vec3 m = middle_of_sheet();
    d.radius = 0.001f;
    d.half_length = 0.1f;
    // the y axis of the needle to x, then by 0.37 rad about y
    const float s = sqrtf( 0.5f ) * sinf( 0.185f ), c = sqrtf( 0.5f ) * cosf( 0.185f );
    d.pose = wisp_transform_make( ( wisp_quat ){ -s, s, -c, c }, ( wisp_vec3 ){ m.x + 0.003f, y, m.z + 0.0045f } );
    return d;
}

static wisp_collider_def standing_needle( float tip )
{
    wisp_collider_def d = lying_needle( 0.0f );
    d.pose.rotation = ( wisp_quat ){ 0.0f, 0.0f, 0.0f, 1.0f };
    d.pose.translation.y = tip - d.half_length - d.radius;
    return d;
}

// Return the height of the sheet above the axis of the needle, the least of points along it.
static double height_above_needle( const sheet* s )
{
    double least = INFINITY;
    for ( int i = -20; i <= 20; ++i )
    {
        const wisp_vec3 local = { 0.0f, s->collider.half_length * (float)i / 20.0f, 0.0f };
        least = fmin( least, height_above( s, wisp_transform_to_world( s->pose, local ) ) );
    }
    return least;
}

static void report( const char* what, const sheet* s )
{
    if ( getenv( "WISP_TEST_REPORT" ) )
    {
        print_message( "%s: distance %.3f mm, above %.3f mm, speed %.3f\n", what, 1e3 * least_distance( s ),
                       1e3 * height_above_needle( s ), motion_stats_of( s->h->world, s->surface ).speed_max );
    }
}

// ---- needles ----

static void a_needle_at_rest_carries_a_loaded_sheet( void** state )
{
    (void)state;
    for ( int standing = 0; standing < 2; ++standing )
    {
        // the sheet is held 3 cm below the top of the needle would be; the needle rises, then ten times gravity loads the sheet
        const wisp_collider_def needle = standing ? standing_needle( -0.008f ) : lying_needle( -0.008f );
        sheet s = new_sheet( WISP_COLLISION_ALL, &needle, true, 10.0f * GRAVITY, 10, 1 );
        double least = INFINITY, above = INFINITY;
        for ( int n = 1; n <= 120; ++n )
        {
            wisp_transform pose = needle.pose;
            pose.translation.y += 0.03f * fminf( 1.0f, (float)n / 30.0f );
            move_body( &s, pose );
            run_for( s.h->world, DT, 1 );
            least = n % 10 == 0 ? fmin( least, least_distance( &s ) ) : least;
            above = n % 10 == 0 ? fmin( above, height_above_needle( &s ) ) : above;
            if ( n % 10 == 0 ) report( standing ? "standing" : "lying", &s );
        }
        assert_true( above > 0.0 );
        assert_true( least >= 0.9 * (double)THICKNESS - 1e-4 );
        free_sheet( &s );
    }
}

static void a_needle_passes_between_vertices_that_alone_collide( void** state )
{
    (void)state;
    const wisp_collider_def needle = standing_needle( -0.008f );
    sheet s = new_sheet( WISP_COLLISION_VERTICES, &needle, true, 10.0f * GRAVITY, 10, 1 );
    for ( int n = 1; n <= 60; ++n )
    {
        wisp_transform pose = needle.pose;
        pose.translation.y += 0.03f * fminf( 1.0f, (float)n / 30.0f );
        move_body( &s, pose );
        run_for( s.h->world, DT, 1 );
    }
    assert_true( height_above_needle( &s ) < 0.0 );
    free_sheet( &s );
}

static void a_needle_that_moves_does_not_pass( void** state )
{
    (void)state;
    static const float speeds[] = { 0.5f, 5.0f, 20.0f };
    for ( int k = 0; k < 2 * WISP_COUNT( speeds ); ++k )
    {
        const bool standing = k % 2 == 1;
        const float speed = speeds[k / 2], start = -0.1f, rise = 0.2f; // ends 10 cm above the plane of the sheet
        const wisp_collider_def needle = standing ? standing_needle( start ) : lying_needle( start );
        // free, so that it can be carried along
        sheet s = new_sheet( WISP_COLLISION_ALL, &needle, false, 0.0f, 10, 1 );
        double above = INFINITY, least = INFINITY;
        const int steps = (int)ceilf( rise / ( speed * DT ) );
        for ( int n = 1; n <= steps + 5; ++n )
        {
            wisp_transform pose = needle.pose;
            pose.translation.y += fminf( rise, speed * DT * (float)n );
            move_body( &s, pose );
            run_for( s.h->world, DT, 1 );
            above = fmin( above, height_above_needle( &s ) );
            least = fmin( least, least_distance( &s ) );
            if ( n >= steps || n % 5 == 0 ) report( standing ? "standing moves" : "lying moves", &s );
        }
        assert_true( above > 0.0 );
        assert_true( least > 0.0 );
        free_sheet( &s );
    }
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_needle_at_rest_carries_a_loaded_sheet ),
        cmocka_unit_test( a_needle_passes_between_vertices_that_alone_collide ),
        cmocka_unit_test( a_needle_that_moves_does_not_pass ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
