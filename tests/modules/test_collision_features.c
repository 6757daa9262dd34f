// Edges and triangles of surfaces against bodies: needles, box edges, small balls, rails, workers, refusals.
#include "collision_fixture.h"
#include "oracle/contact_oracle.h"

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
    SET_DEFAULT( s.h->world, s.surface, cloth );
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
    return ( wisp_shape ){
        .kind = kinds[d->kind], .radius = d->radius, .half_length = d->half_length, .half_extent = d->half_extent
    };
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

// ---- needles ----

TEST( a_needle_at_rest_carries_a_loaded_sheet )
{
    for ( int standing = 0; standing < 2; ++standing )
    {
        // the sheet is held 3 cm below the top of the needle would be; the needle rises, then ten times gravity loads the sheet
        const wisp_collider_def needle = standing ? standing_needle( -0.008f ) : lying_needle( -0.008f );
        SCOPED( free_sheet ) sheet s = new_sheet( WISP_COLLISION_ALL, &needle, true, 10.0f * GRAVITY, 10, 1 );
        double least = INFINITY, above = INFINITY;
        for ( int n = 1; n <= 60; ++n )
        {
            wisp_transform pose = needle.pose;
            pose.translation.y += 0.03f * fminf( 1.0f, (float)n / 30.0f );
            move_body( &s, pose );
            run_for( s.h->world, DT, 1 );
            least = n % 10 == 0 ? fmin( least, least_distance( &s ) ) : least;
            above = n % 10 == 0 ? fmin( above, height_above_needle( &s ) ) : above;
        }
        assert_true( above > 0.0 );
        assert_true( least >= 0.9 * (double)THICKNESS - 1e-4 );
    }
}

TEST( a_needle_passes_between_vertices_that_alone_collide )
{
    const wisp_collider_def needle = standing_needle( -0.008f );
    SCOPED( free_sheet ) sheet s = new_sheet( WISP_COLLISION_VERTICES, &needle, true, 10.0f * GRAVITY, 10, 1 );
    for ( int n = 1; n <= 60; ++n )
    {
        wisp_transform pose = needle.pose;
        pose.translation.y += 0.03f * fminf( 1.0f, (float)n / 30.0f );
        move_body( &s, pose );
        run_for( s.h->world, DT, 1 );
    }
    assert_true( height_above_needle( &s ) < 0.0 );
}

TEST( a_needle_that_moves_does_not_pass )
{
    static const float speeds[] = { 0.5f, 5.0f, 20.0f };
    for ( int k = 0; k < 2 * WISP_COUNT( speeds ); ++k )
    {
        const bool standing = k % 2 == 1;
        const float speed = speeds[k / 2]; // it ends above the plane of the sheet
        const float start = speed < 1.0f ? -0.02f : -0.1f, rise = speed < 1.0f ? 0.06f : speed < 10.0f ? 0.2f : 0.34f;
        const wisp_collider_def needle = standing ? standing_needle( start ) : lying_needle( start );
        // free, so that it can be carried along
        SCOPED( free_sheet ) sheet s = new_sheet( WISP_COLLISION_ALL, &needle, false, 0.0f, 10, 1 );
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
        }
        assert_true( above > 0.0 );
        assert_true( least > 0.7 * (double)THICKNESS );
    }
}

// ---- a box and a ball ----

static wisp_collider_def box_under_sheet( void )
{
    wisp_collider_def d = body_of( WISP_COLLIDER_BOX );
    const wisp_vec3 m = middle_of_sheet();
    d.half_extent = ( wisp_vec3 ){ 0.1f, 0.05f, 0.08f };
    d.pose = wisp_transform_make( ( wisp_quat ){ 0.0f, sinf( 0.15f ), 0.0f, cosf( 0.15f ) },
                                  ( wisp_vec3 ){ m.x + 0.003f, -0.06f, m.z - 0.004f } );
    return d;
}

static double draped_distance( wisp_collision_features features )
{
    const wisp_collider_def box = box_under_sheet();
    SCOPED( free_sheet ) sheet s = new_sheet( features, &box, false, GRAVITY, 10, 1 );
    assert_int_equal( wisp_set_damping( s.h->world, s.surface, 2.0f ), WISP_OK );
    double least = INFINITY;
    for ( int n = 1; n <= 60; ++n )
    {
        run_for( s.h->world, DT, 1 );
        least = n > 30 && n % 10 == 0 ? fmin( least, least_distance( &s ) ) : least;
    }
    return least;
}

TEST( no_edge_of_a_box_shows_through_a_sheet_draped_on_it )
{
    const double all = draped_distance( WISP_COLLISION_ALL ), vertices = draped_distance( WISP_COLLISION_VERTICES );
    // a tenth of the thickness and a tenth of a millimetre
    assert_true( all >= 0.9 * (double)THICKNESS - 1e-4 );
    assert_true( vertices < 0.0 );
}

TEST( a_small_ball_is_held_by_a_sheet_that_is_held_at_its_border )
{
    wisp_collider_def ball = body_of( WISP_COLLIDER_SPHERE );
    const wisp_vec3 m = middle_of_sheet();
    ball.radius = 0.005f;
    ball.pose.translation = ( wisp_vec3 ){ m.x + 0.005f, 0.02f, m.z + 0.012f };
    for ( int features = 0; features < 2; ++features )
    {
        SCOPED( free_sheet ) sheet s = new_sheet( (wisp_collision_features)features, &ball, true, 0.0f, 10, 1 );
        double least = INFINITY;
        for ( int n = 1; n <= 60; ++n )
        {
            wisp_transform pose = ball.pose;
            pose.translation.y -= 0.06f * fminf( 1.0f, (float)n / 40.0f );
            move_body( &s, pose );
            run_for( s.h->world, DT, 1 );
            least = fmin( least, least_distance( &s ) );
        }
        // it hangs 4 cm below the border, and the sheet is below it
        const double above = height_above( &s, s.pose.translation );
        assert_true( features == 0 ? least < 0.0 : above < -0.9 * (double)( THICKNESS + ball.radius ) );
        assert_true( features == 0 || least >= 0.9 * (double)THICKNESS - 1e-4 );
    }
}

// ---- friction and reaction ----

// A triangle on two rails that run down a slope. Its corners are beside the rails, so that they touch nothing.
typedef struct slide
{
    hosted* h;
    wisp_entity surface, rails[2];
    double angle, start;
} slide;

static double along_slope( const slide* s )
{
    const wisp_motion_stats q = motion_stats_of( s->h->world, s->surface );
    return q.centre[0] * cos( s->angle ) + q.centre[1] * sin( s->angle );
}

static slide new_slide( double angle, float mu, wisp_collision_features features, float gravity )
{
    slide s = { .h = new_colliding( 4, 1, 1 ), .angle = angle };
    const float radius = 0.002f, z[2] = { 0.07f, 0.13f };
    for ( int i = 0; i < 2; ++i )
    {
        wisp_collider_def rail = wisp_default_collider_def();
        rail.kind = WISP_COLLIDER_CAPSULE;
        rail.radius = radius;
        rail.half_length = 20.0f;
        rail.static_friction = rail.kinetic_friction = mu;
        rail.pose = ( wisp_transform ){ about_z( angle - 1.5707963267948966 ), { 0.0f, 0.0f, z[i] } };
        s.rails[i] = add_collider( s.h->world, &rail );
        assert_int_equal( wisp_request_reaction( s.h->world, s.rails[i], true ), WISP_OK );
    }
    test_mesh mesh = test_triangle( ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, 0.1f );
    mesh.points[1] = ( wisp_vec3 ){ 0.0f, 0.0f, 0.2f };
    mesh.points[2] = ( wisp_vec3 ){ 0.2f, 0.0f, 0.1f };
    for ( int v = 0; v < 3; ++v )
    {
        const double x = (double)mesh.points[v].x, y = (double)( THICKNESS + radius );
        mesh.points[v].x = (float)( cos( angle ) * x - sin( angle ) * y );
        mesh.points[v].y = (float)( sin( angle ) * x + cos( angle ) * y );
    }
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = THICKNESS;
    collision.features = features;
    s.surface = add_colliding( s.h->world, &mesh, &collision );
    test_mesh_free( &mesh );
    SET_DEFAULT( s.h->world, s.surface, cloth );
    run_for( s.h->world, DT, 1 );
    s.start = along_slope( &s );
    give_gravity( s.h->world, s.surface, gravity );
    return s;
}

TEST( rails_carry_the_weight_of_what_lies_on_edges_alone )
{
    slide s = new_slide( 0.3, 0.5f, WISP_COLLISION_ALL, GRAVITY );
    run_for( s.h->world, DT, 30 );
    double sum[3] = { 0.0, 0.0, 0.0 };
    for ( int i = 0; i < 2; ++i )
    {
        wisp_reaction r;
        assert_int_equal( wisp_read_reaction( s.h->world, s.rails[i], &r ), WISP_OK );
        sum[0] += (double)r.impulse.x;
        sum[1] += (double)r.impulse.y;
        sum[2] += (double)r.impulse.z;
    }
    const double weight = motion_stats_of( s.h->world, s.surface ).mass * 9.8 * (double)DT;
    assert_near( sum[0], 0.0, 1e-3 * weight );
    assert_near( sum[1], -weight, 1e-3 * weight );
    assert_near( sum[2], 0.0, 1e-3 * weight );
    free_colliding( s.h );
}

// ---- the rest ----

TEST( without_the_option_there_is_no_pass_and_no_other_bit )
{
    const wisp_collider_def needle = lying_needle( -0.008f );
    SCOPED( free_sheet )
    sheet s = new_sheet( WISP_COLLISION_VERTICES, &needle, true, GRAVITY, 2, 1 ),
          t = new_sheet( WISP_COLLISION_ALL, &needle, true, GRAVITY, 2, 1 );
    run_for( s.h->world, DT, 1 );
    run_for( t.h->world, DT, 1 );
    const int without = wisp_world_plan_passes( s.h->world );
    assert_int_equal( wisp_world_plan_passes( t.h->world ), without + 3 ); // what is found is stored, to be projected
    // and it goes again
    SET( t.h->world, t.surface, collision, d.thickness = THICKNESS );
    assert_int_equal( wisp_world_plan_passes( t.h->world ), without );
    free_sheet( &t );
    // what never comes near a body moves as without it
    free_sheet( &s );
    const wisp_collider_def far = lying_needle( 5.0f );
    s = new_sheet( WISP_COLLISION_VERTICES, &far, true, GRAVITY, 2, 1 );
    t = new_sheet( WISP_COLLISION_ALL, &far, true, GRAVITY, 2, 1 );
    run_for( s.h->world, DT, 20 );
    run_for( t.h->world, DT, 20 );
    for ( int v = 0; v < s.mesh.vertex_count; ++v )
    {
        const wisp_vec3 a = point_of( s.h->world, s.surface, v ), b = point_of( t.h->world, t.surface, v );
        assert_memory_equal( &a, &b, sizeof( a ) );
    }
}
