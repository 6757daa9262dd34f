// Strands and bodies: rest, friction, moving heads, starts inside a body, and the same bits for every number of
// workers.
#include "collision_fixture.h"

#include "strands.h"
#include "wisp/generate.h"

static const float DT = 1.0f / 60.0f;
static const float SEGMENT = 0.01f;
static const double DEGREE = 3.14159265358979323846 / 180.0;

typedef struct hair_world
{
    int substeps, iterations, workers;
    const char* isa;
} hair_world;

static hosted* new_hair_world( hair_world w )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module, &wisp_strands_module };
    hosted* h = checked_calloc( 1, sizeof( hosted ) );
    h->def = hosted_def( h );
    h->def.modules = MODULES;
    h->def.module_count = WISP_COUNT( MODULES );
    h->def.substeps = w.substeps;
    h->def.iterations = w.iterations;
    h->def.workers = w.workers;
    h->def.isa = w.isa;
    assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
    return h;
}

static int open_hair( void** state )
{
    *state = new_hair_world( ( hair_world ){ 10, 1, 1, NULL } );
    return 0;
}

#define HAIR_TEST( test ) TEST_WITH( test, open_hair, close_hosted )

// Soft hair that does not keep its initial shape.
static wisp_strand_dynamics_def damped_hair( void )
{
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    def.rest = WISP_STRAND_REST_STRAIGHT;
    def.bend_rigidity = 5e-10f;
    def.damping = 5.0f;
    return def;
}

static wisp_entity add_strands_of( wisp_world* world, test_strands* s, const wisp_strand_dynamics_def* dynamics )
{
    wisp_strands_def def = test_strands_def( s );
    wisp_entity e;
    assert_int_equal( wisp_add_strands( world, &def, &e ), WISP_OK );
    test_strands_free( s );
    wisp_collision_def collision = wisp_default_collision_def();
    if ( wisp_set_strand_dynamics( world, e, dynamics ) != WISP_OK ||
         wisp_set_collision( world, e, &collision ) != WISP_OK )
    {
        fail_msg( "no hair: %s", wisp_world_message( world ) );
    }
    assert_int_equal( wisp_request( world, e, WISP_STRAND_POINTS ), WISP_OK );
    assert_int_equal( wisp_request_collision_stats( world, e, true ), WISP_OK );
    return e;
}

// Straight strands that move and collide, from `roots` along `directions`, a centimetre per segment.
static wisp_entity add_hair( wisp_world* world, const wisp_vec3* roots, const wisp_vec3* directions, int count,
                             int vertices, const wisp_strand_dynamics_def* dynamics )
{
    test_strands s = test_strands_of( count, vertices );
    for ( int i = 0; i < count * vertices; ++i )
    {
        const wisp_vec3 r = roots[i / vertices], d = directions[i / vertices];
        const float t = SEGMENT * (float)( i % vertices );
        s.points[i] = ( wisp_vec3 ){ r.x + t * d.x, r.y + t * d.y, r.z + t * d.z };
    }
    return add_strands_of( world, &s, dynamics );
}

// Twenty strands side by side, level, that fall over a body at the origin.
static wisp_entity add_fringe( wisp_world* world )
{
    wisp_vec3 roots[20], directions[20];
    for ( int i = 0; i < 20; ++i )
    {
        roots[i] = ( wisp_vec3 ){ -0.13f, 0.14f, 0.01f * (float)( i - 10 ) + 0.003f };
        directions[i] = ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f };
    }
    const wisp_strand_dynamics_def dynamics = damped_hair();
    return add_hair( world, roots, directions, 20, 31, &dynamics );
}

// Hair all over the upper half of a head of 0.1 m.
static wisp_entity add_head_of_hair( wisp_world* world, int count )
{
    wisp_vec3* roots = calloc( (size_t)count, sizeof( wisp_vec3 ) );
    wisp_vec3* directions = calloc( (size_t)count, sizeof( wisp_vec3 ) );
    for ( int i = 0; i < count; ++i )
    {
        const double y = 0.1 + 0.85 * ( i + 0.5 ) / count, turn = 2.399963 * i, r = sqrt( 1.0 - y * y );
        directions[i] = ( wisp_vec3 ){ (float)( r * cos( turn ) ), (float)y, (float)( r * sin( turn ) ) };
        roots[i] = ( wisp_vec3 ){ 0.1f * directions[i].x, 0.1f * directions[i].y, 0.1f * directions[i].z };
    }
    const wisp_strand_dynamics_def dynamics = damped_hair();
    wisp_entity e = add_hair( world, roots, directions, count, 21, &dynamics );
    free( roots );
    free( directions );
    return e;
}

static wisp_collider_def small_body( wisp_collider_kind kind )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = kind;
    def.radius = 0.1f;
    def.half_length = 0.1f;
    def.half_extent = ( wisp_vec3 ){ 0.08f, 0.1f, 0.2f };
    def.pose.rotation =
        kind == WISP_COLLIDER_CAPSULE ? ( wisp_quat ){ sqrtf( 0.5f ), 0.0f, 0.0f, sqrtf( 0.5f ) } : def.pose.rotation;
    return def;
}

static wisp_entity add_mesh_ball( wisp_world* world, float radius )
{
    test_mesh mesh = test_ball( 4 );
    move_mesh( &mesh, radius, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_MESH;
    def.points = mesh.points;
    def.triangles = mesh.triangles;
    def.point_count = mesh.vertex_count;
    def.triangle_count = mesh.triangle_count;
    const wisp_entity e = add_collider( world, &def );
    test_mesh_free( &mesh );
    return e;
}

static const wisp_vec3* points_of( wisp_world* world, wisp_entity e, int* count )
{
    const wisp_view view = view_of( world, e, WISP_STRAND_POINTS );
    *count = view.count;
    return view.data;
}

static double mean_height( wisp_world* world, wisp_entity e )
{
    int count;
    const wisp_vec3* points = points_of( world, e, &count );
    double sum = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        sum += (double)points[i].y;
    }
    return sum / count;
}

static double fastest( wisp_world* world, wisp_entity e )
{
    const wisp_strand_topology* t = wisp_world_strands( world, e );
    const float* v = wisp_world_column( world, e, WISP_STRAND_VELOCITY, 0 );
    double most = 0.0;
    for ( size_t i = 0; i < (size_t)t->row_count * WISP_LANES; ++i )
    {
        const float* x = v + i / WISP_LANES * 48 + i % WISP_LANES;
        most = fmax( most, sqrt( (double)( x[0] * x[0] + x[16] * x[16] + x[32] * x[32] ) ) );
    }
    return most;
}

// ---- rest ----

TEST( strands_that_fall_on_a_body_rest_outside )
{
    for ( int kind = 0; kind < WISP_COLLIDER_MESH; ++kind )
    {
        hosted* h = new_hair_world( ( hair_world ){ 10, 1, 1, NULL } );
        wisp_collider_def body = small_body( (wisp_collider_kind)kind );
        body.pose.translation.y = kind == WISP_COLLIDER_PLANE ? -0.05f : 0.0f;
        add_collider( h->world, &body );
        wisp_entity e = add_fringe( h->world );
        run_for( h->world, DT, 180 );
        const wisp_collision_stats f = collision_of( h->world, e );
        print_message( "kind %d: %d contacts, %.3f of a segment deep, %.2g m/s\n", kind, f.contacts,
                       (double)( f.penetration / SEGMENT ), fastest( h->world, e ) );
        assert_true( f.contacts >= 40 );
        // lengths are restored after contact; at rest that undoes next to nothing
        assert_true( f.penetration < 0.02f * SEGMENT );
        // vertices near the sharp edge of a box creep by a few hundredths of the thickness per substep
        assert_true( fastest( h->world, e ) < ( kind == WISP_COLLIDER_BOX ? 0.1 : 0.005 ) );
        free_colliding( h );
    }
}

TEST( strands_lie_on_a_mesh_as_on_the_closed_form )
{
    double height[2];
    for ( int k = 0; k < 2; ++k )
    {
        hosted* h = new_hair_world( ( hair_world ){ 10, 1, 1, NULL } );
        const wisp_collider_def ball = small_body( WISP_COLLIDER_SPHERE );
        if ( k == 0 )
        {
            add_collider( h->world, &ball );
        }
        else
        {
            add_mesh_ball( h->world, 0.1f );
        }
        wisp_entity e = add_fringe( h->world );
        run_for( h->world, DT, 120 );
        height[k] = mean_height( h->world, e );
        assert_true( collision_of( h->world, e ).penetration < 0.05f * SEGMENT );
        assert_true( collision_of( h->world, e ).contacts >= 40 );
        free_colliding( h );
    }
    // faces lie up to 0.1 (1 - cos( 90 / 32 degrees )), 1.2e-4 m, inside the ball, and strands roll off along their
    // edges
    assert_near( height[1], height[0], 2e-3 );
}

// ---- friction ----

// Chains across a slope, held at their roots. @return downhill motion of their tips in two seconds, m
static double downhill( double angle, float mu )
{
    hosted* h = new_hair_world( ( hair_world ){ 10, 1, 1, NULL } );
    wisp_collider_def plane = small_body( WISP_COLLIDER_PLANE );
    plane.static_friction = plane.kinetic_friction = mu;
    add_collider( h->world, &plane );
    const wisp_vec3 root = { 0.0f, 0.25f * SEGMENT, 0.0f }, direction = { 1.0f, 0.0f, 0.0f };
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.bending = WISP_STRAND_BEND_NONE;
    dynamics.gravity = ( wisp_vec3 ){ 0.0f, (float)( -9.8 * cos( angle ) ), (float)( 9.8 * sin( angle ) ) };
    wisp_entity e = add_hair( h->world, &root, &direction, 1, 21, &dynamics );
    run_for( h->world, DT, 120 );
    int count;
    const double z = (double)points_of( h->world, e, &count )[20].z;
    free_colliding( h );
    return z;
}

TEST( friction_holds_a_strand_below_its_angle_alone )
{
    // mu 0.5 holds up to 26.6 degrees; static friction cancels each substep's slip up to rounding
    assert_near( downhill( 25.0 * DEGREE, 0.5f ), 0.0, 1e-5 );
    assert_near( downhill( 5.0 * DEGREE, 0.5f ), 0.0, 1e-5 );
    assert_true( downhill( 29.0 * DEGREE, 0.5f ) > 0.05 );
    assert_true( downhill( 5.0 * DEGREE, 0.0f ) > 0.05 );
}

// A rope over a rod, with four fifths of what hangs on one side, by few substeps. @return how far its heavy end sinks in two seconds, m
static double sinks( bool is_mesh, float mu )
{
    enum
    {
        VERTICES = 67
    };
    static wisp_vec3 points[WISP_CAPSULE_VERTICES( 400, 1, 1 )];
    static int32_t triangles[WISP_CAPSULE_TRIANGLES( 400, 1, 1 )][3];
    hosted* h = new_hair_world( ( hair_world ){ 4, 1, 1, NULL } );
    wisp_collider_def rod = small_body( is_mesh ? WISP_COLLIDER_MESH : WISP_COLLIDER_CAPSULE );
    rod.pose.rotation = ( wisp_quat ){ sqrtf( 0.5f ), 0.0f, 0.0f, sqrtf( 0.5f ) };
    rod.static_friction = rod.kinetic_friction = mu;
    rod.points = points, rod.point_count = WISP_COUNT( points );
    rod.triangles = &triangles[0][0], rod.triangle_count = WISP_COUNT( triangles );
    assert_int_equal( wisp_generate_capsule( 400, 1, 1, 0.1f, 0.2f, points, &triangles[0][0], NULL ), WISP_OK );
    add_collider( h->world, &rod );
    test_strands rope = test_strands_of( 1, VERTICES );
    const double arc = 0.101 * M_PI;
    for ( int i = 0; i < VERTICES; ++i )
    {
        const double s = ( 1.0 + arc ) * i / ( VERTICES - 1 ) - 0.2, on = fmin( fmax( s, 0.0 ), arc );
        const double below = fmax( -s, 0.0 ) + fmax( s - arc, 0.0 );
        rope.points[i] = ( wisp_vec3 ){ (float)( -0.101 * cos( on / 0.101 ) ),
                                        (float)( 0.101 * sin( on / 0.101 ) - below ), 0.0f };
    }
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.bending = WISP_STRAND_BEND_NONE;
    dynamics.free_roots = true;
    const wisp_entity e = add_strands_of( h->world, &rope, &dynamics );
    int count;
    run_for( h->world, DT, 60 );
    const float before = points_of( h->world, e, &count )[VERTICES - 1].y;
    run_for( h->world, DT, 120 );
    const double sunk = (double)( before - points_of( h->world, e, &count )[VERTICES - 1].y );
    free_colliding( h );
    return sunk;
}

// Pushes that a mesh takes back less of than a closed form brake the rope less, by 0.05 of 6.2 m.
TEST( a_rope_slides_over_a_mesh_and_sticks_to_it_as_to_the_closed_form )
{
    assert_near( sinks( true, 0.38f ), sinks( false, 0.38f ), 0.015 );
    assert_near( sinks( true, 0.44f ), 0.0, 5e-4 );
    assert_near( sinks( false, 0.44f ), 0.0, 5e-4 );
}

// ---- bodies that move ----

static wisp_transform shaken( int n )
{
    const double t = (double)n / 60.0;
    return ( wisp_transform ){ about_z( 0.5 * sin( 9.0 * t ) ),
                               { (float)( 0.15 * sin( 7.0 * t ) ), (float)( 0.05 * sin( 11.0 * t ) ), 0.0f } };
}

static float deepest_on_a_shaken_head( hair_world w, wisp_strand_stretch stretch, bool as_mesh )
{
    hosted* h = new_hair_world( w );
    const wisp_collider_def ball = small_body( WISP_COLLIDER_SPHERE );
    wisp_entity head = as_mesh ? add_mesh_ball( h->world, 0.1f ) : add_collider( h->world, &ball );
    wisp_entity e = add_head_of_hair( h->world, 100 );
    wisp_strand_dynamics_def dynamics = damped_hair();
    dynamics.stretch = stretch;
    assert_int_equal( wisp_set_strand_dynamics( h->world, e, &dynamics ), WISP_OK );
    float deepest = 0.0f;
    for ( int n = 1; n <= 120; ++n )
    {
        assert_int_equal( wisp_move_collider( h->world, head, shaken( n ) ), WISP_OK );
        assert_int_equal( wisp_move_strand_head( h->world, e, shaken( n ) ), WISP_OK );
        run_for( h->world, DT, 1 );
        deepest = fmaxf( deepest, collision_of( h->world, e ).penetration );
    }
    assert_true( collision_of( h->world, e ).contacts > 100 );
    free_colliding( h );
    return deepest / SEGMENT;
}

TEST( hair_on_a_head_that_shakes_stays_out_of_it )
{
    float direct = deepest_on_a_shaken_head( ( hair_world ){ 10, 1, 1, NULL }, WISP_STRAND_STRETCH_DIRECT, false );
    float twice = deepest_on_a_shaken_head( ( hair_world ){ 10, 2, 1, NULL }, WISP_STRAND_STRETCH_DIRECT, false );
    float links = deepest_on_a_shaken_head( ( hair_world ){ 10, 2, 1, NULL }, WISP_STRAND_STRETCH_LINKS, false );
    float mesh = deepest_on_a_shaken_head( ( hair_world ){ 10, 1, 1, NULL }, WISP_STRAND_STRETCH_DIRECT, true );
    print_message( "10 substeps: %.3f of a segment deep, 2 iterations %.3f, links %.3f, mesh %.3f\n", (double)direct,
                   (double)twice, (double)links, (double)mesh );
    // the thickness is a quarter of a segment, so hair cannot enter the head itself
    assert_true( direct < 0.2f && twice < 0.2f && links < 0.2f && mesh < 0.2f );
}

HAIR_TEST( a_body_that_strikes_hair_in_one_step_carries_it_along )
{
    hosted* h = *state;
    wisp_collider_def ball = small_body( WISP_COLLIDER_SPHERE );
    ball.radius = 0.05f;
    ball.pose.translation = ( wisp_vec3 ){ 0.1f, 0.0f, 0.5f };
    wisp_entity body = add_collider( h->world, &ball );
    wisp_entity e = add_fringe( h->world );
    for ( int n = 1; n <= 3; ++n )
    {
        // from one side of the strands to the other at 30 m/s, half its width per substep, turning by 1 rad
        ball.pose.rotation = about_z( 1.0 * n );
        ball.pose.translation = ( wisp_vec3 ){ 0.1f, 0.12f, n == 1 ? 0.0f : -0.5f * (float)( n - 1 ) };
        assert_int_equal( wisp_move_collider( h->world, body, ball.pose ), WISP_OK );
        run_for( h->world, DT, 1 );
    }
    int count;
    const wisp_vec3* points = points_of( h->world, e, &count );
    float least = 0.0f;
    for ( int i = 0; i < count; ++i )
    {
        least = fminf( least, points[i].z );
    }
    assert_true( least < -0.25f ); // roots end at -0.1
    assert_int_equal( collision_of( h->world, e ).vertex, -1 );
    run_for( h->world, DT, 120 );
    assert_int_equal( collision_of( h->world, e ).vertex, -1 );
    assert_true( fastest( h->world, e ) < 0.5 );
}

// Without gravity, so that all speed comes from being moved out.
static void leaves_calmly( wisp_collider_kind kind )
{
    hosted* h = new_hair_world( ( hair_world ){ 4, 1, 1, NULL } );
    wisp_collider_def body = small_body( kind );
    body.half_extent.y = 0.04f; // otherwise strands would pass through the box, with the nearest faces at its ends
    body.pose.translation = ( wisp_vec3 ){ 0.05f, 0.13f, 0.0f };
    wisp_entity ball = { 0, 0 };
    if ( kind == WISP_COLLIDER_MESH )
    {
        ball = add_mesh_ball( h->world, 0.1f );
        assert_int_equal( wisp_move_collider( h->world, ball, body.pose ), WISP_OK );
        run_for( h->world, DT, 1 );
    }
    else
    {
        add_collider( h->world, &body );
    }
    wisp_entity e = add_fringe( h->world );
    wisp_strand_dynamics_def dynamics = damped_hair();
    dynamics.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    assert_int_equal( wisp_set_strand_dynamics( h->world, e, &dynamics ), WISP_OK );
    double most = 0.0;
    for ( int n = 0; n < 240; ++n )
    {
        run_for( h->world, DT, 1 );
        most = fmax( most, fastest( h->world, e ) );
    }
    const float left = collision_of( h->world, e ).penetration;
    print_message( "kind %d: at most %.2f m/s, %.3f of a segment left\n", (int)kind, most,
                   (double)( left / SEGMENT ) );
    // ten segments a second are 0.1 m/s, and strands that have to go round the body pull their tips along faster;
    // with an immediate push they would move 0.1 m in a substep, 24 m/s
    assert_true( most < 2.0 );
    assert_true( left < 0.2f * SEGMENT );
    free_colliding( h );
}

TEST( what_starts_inside_leaves_without_being_thrown )
{
    for ( int kind = WISP_COLLIDER_SPHERE; kind <= WISP_COLLIDER_MESH; ++kind )
    {
        leaves_calmly( (wisp_collider_kind)kind );
    }
}

// ---- bodies that are thinner than segments ----

// A bar of 6 mm along z.
static wisp_entity add_bar( wisp_world* world, wisp_collider_kind kind, float friction )
{
    static const int32_t BOX[12][3] = {
        { 0, 2, 1 }, { 1, 2, 3 }, { 4, 5, 6 }, { 5, 7, 6 }, { 0, 1, 4 }, { 1, 5, 4 },
        { 2, 6, 3 }, { 3, 6, 7 }, { 0, 4, 2 }, { 2, 4, 6 }, { 1, 3, 5 }, { 3, 7, 5 }
    };
    wisp_vec3 corners[8];
    for ( int i = 0; i < 8; ++i )
    {
        corners[i] = ( wisp_vec3 ){ ( i & 1 ) != 0 ? 0.003f : -0.003f, ( i & 2 ) != 0 ? 0.003f : -0.003f,
                                    ( i & 4 ) != 0 ? 0.2f : -0.2f };
    }
    wisp_collider_def def = small_body( kind );
    def.radius = def.top_radius = def.bottom_radius = 0.003f;
    def.half_length = 0.2f;
    def.half_extent = ( wisp_vec3 ){ 0.003f, 0.003f, 0.2f };
    def.points = corners;
    def.point_count = 8;
    def.triangles = &BOX[0][0];
    def.triangle_count = 12;
    def.static_friction = def.kinetic_friction = friction;
    def.pose.translation = ( wisp_vec3 ){ -0.05f, -0.2f, 0.0f };
    def.pose.rotation =
        kind == WISP_COLLIDER_TAPERED_CAPSULE ? small_body( WISP_COLLIDER_CAPSULE ).pose.rotation : def.pose.rotation;
    return add_collider( world, &def );
}

// Drive a bar 0.2 m through eight strands of 0.4 m that hang. @return the largest strain of a segment, if none hangs behind it
static double strain_by_bar( wisp_collider_kind kind, float speed, float friction )
{
    enum
    {
        STRANDS = 8,
        VERTICES = 41
    };
    hosted* h = new_hair_world( ( hair_world ){ 10, 1, 1, NULL } );
    wisp_vec3 roots[STRANDS], directions[STRANDS];
    for ( int s = 0; s < STRANDS; ++s )
    {
        roots[s] = ( wisp_vec3 ){ 0.002f * (float)( s % 3 ), 0.0013f * (float)s, 0.005f * (float)s };
        directions[s] = ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f };
    }
    const wisp_entity bar = add_bar( h->world, kind, friction );
    const wisp_strand_dynamics_def dynamics = damped_hair();
    const wisp_entity e = add_hair( h->world, roots, directions, STRANDS, VERTICES, &dynamics );
    wisp_transform pose = { small_body( kind ).pose.rotation, { -0.05f, -0.2f, 0.0f } };
    pose.rotation =
        kind == WISP_COLLIDER_TAPERED_CAPSULE ? small_body( WISP_COLLIDER_CAPSULE ).pose.rotation : pose.rotation;
    double most = 0.0;
    for ( int n = 0; pose.translation.x < 0.15f; ++n )
    {
        pose.translation.x += speed * DT;
        assert_int_equal( wisp_move_collider( h->world, bar, pose ), WISP_OK );
        run_for( h->world, DT, 1 );
        int count;
        const wisp_vec3* points = points_of( h->world, e, &count );
        for ( int i = 0; i < count; ++i )
        {
            const wisp_vec3 p = points[i], q = points[i % VERTICES + 1 < VERTICES ? i + 1 : i];
            const double length = sqrt( pow( (double)( q.x - p.x ), 2.0 ) + pow( (double)( q.y - p.y ), 2.0 ) +
                                        pow( (double)( q.z - p.z ), 2.0 ) );
            most = q.y != p.y || q.x != p.x ? fmax( most, fabs( length / (double)SEGMENT - 1.0 ) ) : most;
            if ( p.y >= -0.2f && q.y < -0.2f )
            {
                const float across = p.x + ( p.y + 0.2f ) / ( p.y - q.y ) * ( q.x - p.x );
                assert_true( across > pose.translation.x || pose.translation.x < -0.003f );
                i += VERTICES - 1 - i % VERTICES; // where it hangs, not where its tip turns up
            }
        }
    }
    free_colliding( h );
    return most;
}

TEST( strands_are_not_drawn_through_bodies_thinner_than_their_segments )
{
    static const wisp_collider_kind KINDS[] = { WISP_COLLIDER_CAPSULE, WISP_COLLIDER_BOX, WISP_COLLIDER_MESH,
                                                WISP_COLLIDER_TAPERED_CAPSULE, WISP_COLLIDER_CONVEX };
    static const float SPEEDS[] = { 0.2f, 1.0f, 2.0f };
    for ( int k = 0; k < WISP_COUNT( KINDS ); ++k )
    {
        for ( int v = 0; v < WISP_COUNT( SPEEDS ); ++v )
        {
            const double smooth = strain_by_bar( KINDS[k], SPEEDS[v], 0.0f ),
                         rough = strain_by_bar( KINDS[k], SPEEDS[v], 1.0f );
            print_message( "kind %d at %.1f m/s: strain %.4f, with friction 1 %.4f\n", (int)KINDS[k],
                           (double)SPEEDS[v], smooth, rough );
            assert_true( smooth < ( SPEEDS[v] > 1.0f ? 0.025 : 0.01 ) && rough < ( SPEEDS[v] > 1.0f ? 0.08 : 0.03 ) );
        }
    }
}

// ---- the plan, and refusals ----

typedef struct plan_lines
{
    bool in_item_loop, before_stretch, seen_stretch;
} plan_lines;

static void read_plan_line( void* user, const char* line )
{
    plan_lines* found = user;
    char pass[64] = "";
    const char* wave = strstr( line, " wave " );
    if ( wave == NULL || sscanf( wave, " wave %*d %63s", pass ) != 1 )
    {
        return;
    }
    const bool mine = strcmp( pass, "collision.strands" ) == 0;
    found->in_item_loop = found->in_item_loop || ( mine && strstr( line, "item loop" ) != NULL );
    found->before_stretch = found->before_stretch || ( mine && found->seen_stretch == false );
    found->seen_stretch = found->seen_stretch || strcmp( pass, "strands.stretch" ) == 0;
}

HAIR_TEST( contact_comes_before_lengths_in_the_item_loop )
{
    hosted* h = *state;
    wisp_entity e = add_fringe( h->world );
    int bare = wisp_world_plan_passes( h->world );
    const wisp_collider_def ball = small_body( WISP_COLLIDER_SPHERE );
    wisp_entity body = add_collider( h->world, &ball );
    assert_int_equal( wisp_world_plan_passes( h->world ), bare + 3 );
    plan_lines found = { 0 };
    assert_int_equal( wisp_world_plan( h->world, read_plan_line, &found ), WISP_OK );
    assert_true( found.in_item_loop && found.before_stretch && found.seen_stretch );
    assert_int_equal( wisp_request_collision_stats( h->world, e, false ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( h->world ), bare + 2 );
    assert_int_equal( wisp_remove( h->world, body ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( h->world ), bare );
}

HAIR_TEST( layers_and_pins_are_kept )
{
    hosted* h = *state;
    wisp_collider_def ball = small_body( WISP_COLLIDER_SPHERE );
    ball.layers = 4;
    ball.pose.translation = ( wisp_vec3 ){ -0.13f, 0.14f, 0.0f }; // over the roots
    add_collider( h->world, &ball );
    wisp_entity e = add_fringe( h->world );
    run_for( h->world, DT, 10 );
    int count;
    const wisp_vec3 root = points_of( h->world, e, &count )[0];
    assert_near( (double)root.x, -0.13, 1e-6 );
    assert_near( (double)root.y, 0.14, 1e-6 );
    assert_true( collision_of( h->world, e ).contacts > 0 );
    wisp_collision_def collision = wisp_default_collision_def();
    collision.mask = 3;
    assert_int_equal( wisp_set_collision( h->world, e, &collision ), WISP_OK );
    run_for( h->world, DT, 10 );
    assert_int_equal( collision_of( h->world, e ).contacts, 0 );
    assert_int_equal( collision_of( h->world, e ).vertex, -1 );
}

HAIR_TEST( strands_that_cannot_collide_are_refused_with_a_message )
{
    hosted* h = *state;
    wisp_entity still = test_add_strands( h->world, 3, 5 );
    assert_int_equal( wisp_world_attach( h->world, still, WISP_STRAND_VELOCITY ),
                      WISP_OK ); // it moves, but has no weights
    wisp_collision_def collision = wisp_default_collision_def();
    expect_refusal( h->world, wisp_set_collision( h->world, still, &collision ), WISP_CONFLICT, "dynamics" );
    wisp_collision_stats stats;
    assert_int_equal( wisp_read_collision_stats( h->world, still, &stats ), WISP_CONFLICT );
    wisp_entity e = add_fringe( h->world );
    assert_int_equal( wisp_remove( h->world, e ), WISP_OK );
    assert_int_equal( wisp_set_collision( h->world, e, &collision ), WISP_STALE_ID );
}
