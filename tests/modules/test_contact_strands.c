// What flies does not pass what is held, and a heap does not mingle; strands apart from everything. What lies on what, and what it gives, is
// in tests/claims/strands_contact.yaml.
#include "contact_fixture.h"

// ---- strands and surfaces ----

enum
{
    STRANDS = 12,
    VERTICES = 14,
    SUBSTEPS = 10,
};

static const float LENGTH = 0.4f; // m, of a strand

// Strands side by side along z, straight out along x from a head at `root`.
static wisp_entity add_rake( wisp_world* world, wisp_vec3 root, float apart )
{
    wisp_vec3 points[STRANDS * VERTICES];
    int32_t offsets[STRANDS + 1] = { 0 };
    for ( int s = 0; s < STRANDS; ++s )
    {
        offsets[s + 1] = offsets[s] + VERTICES;
        for ( int i = 0; i < VERTICES; ++i )
        {
            points[s * VERTICES + i] = ( wisp_vec3 ){ root.x + LENGTH * (float)i / (float)( VERTICES - 1 ), root.y,
                                                      root.z + apart * ( (float)s - 0.5f * (float)( STRANDS - 1 ) ) };
        }
    }
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = STRANDS;
    wisp_entity e;
    assert_status( world, wisp_add_strands( world, &def, &e ), WISP_OK );
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.bending = WISP_STRAND_BEND_NONE;
    dynamics.line_density = 0.01f; // threads of 10 g per metre
    dynamics.damping = 1.0f;
    assert_status( world, wisp_set_strand_dynamics( world, e, &dynamics ), WISP_OK );
    assert_status( world, wisp_request( world, e, WISP_STRAND_POINTS ), WISP_OK );
    assert_status( world, wisp_request( world, e, WISP_MOTION_STATS ), WISP_OK );
    return e;
}

static int count_segments_through( wisp_world* world, wisp_entity strands, wisp_entity surface )
{
    const wisp_vec3* p = view_of( world, strands, WISP_STRAND_POINTS ).data;
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    const float* x = wisp_world_column( world, surface, WISP_PARTICLE_POSITION, 0 );
    int count = 0;
    for ( int i = 0; i < STRANDS * VERTICES; ++i )
    {
        for ( int t = 0; t < f->triangle_count && i % VERTICES > 0; ++t )
        {
            const int32_t* c = f->triangles + 3 * (size_t)t;
            const float from[3] = { p[i - 1].x, p[i - 1].y, p[i - 1].z }, to[3] = { p[i].x, p[i].y, p[i].z };
            count +=
                wisp_segment_intersects( from, to, x + 4 * (size_t)c[0], x + 4 * (size_t)c[1], x + 4 * (size_t)c[2] )
                    ? 1
                    : 0;
        }
    }
    return count;
}

static const float FRAME_TIME = 1.0f / 60.0f;

typedef struct sticks
{
    hosted* h;
    wisp_world* world;
} sticks;

// Modules in the order of the program: contact projects before lengths are restored.
static sticks open_sticks( int substeps, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module, &wisp_contact_module,
                                                  &wisp_strands_module };
    sticks s = { .h = new_hosted( MODULES, WISP_COUNT( MODULES ), substeps, 1, workers ) };
    s.world = s.h->world;
    return s;
}

static void close_sticks( sticks* s )
{
    void* h = s->h;
    close_hosted( &h );
}

static wisp_strand_dynamics_def stick_def( void )
{
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    def.rest = WISP_STRAND_REST_STRAIGHT;
    def.bend_rigidity = 0.01f;
    def.twist_rigidity = 0.01f;
    def.line_density = 0.05f;
    def.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    def.free_roots = true;
    return def;
}

// Sticks of `count` vertices each.
static wisp_entity add_sticks( sticks* s, const wisp_vec3* points, int strands, int count,
                               const wisp_strand_dynamics_def* dynamics, float thickness )
{
    int32_t offsets[512];
    for ( int i = 0; i <= strands; ++i )
    {
        offsets[i] = i * count;
    }
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = strands;
    wisp_entity e;
    assert_status( s->world, wisp_add_strands( s->world, &def, &e ), WISP_OK );
    assert_status( s->world, wisp_set_strand_dynamics( s->world, e, dynamics ), WISP_OK );
    assert_status( s->world, wisp_request( s->world, e, WISP_STRAND_POINTS ), WISP_OK );
    wisp_contact_def contact = wisp_default_contact_def();
    contact.thickness = thickness;
    contact.between_strands = true;
    assert_status( s->world, wisp_set_contact( s->world, e, &contact ), WISP_OK );
    return e;
}

static void lay( wisp_vec3 from, wisp_vec3 to, int count, wisp_vec3* points )
{
    for ( int i = 0; i < count; ++i )
    {
        const float t = (float)i / (float)( count - 1 );
        points[i] = ( wisp_vec3 ){ from.x + t * ( to.x - from.x ), from.y + t * ( to.y - from.y ),
                                   from.z + t * ( to.z - from.z ) };
    }
}

// ---- crossings ----

// Two segments in a substep: ends at its start and at its end.
typedef struct moving_pair
{
    wisp_vec3 start[4], end[4];
} moving_pair;

static void place_at( const moving_pair* m, double t, double out[4][3] )
{
    for ( int i = 0; i < 4; ++i )
    {
        out[i][0] = (double)m->start[i].x + t * ( (double)m->end[i].x - (double)m->start[i].x );
        out[i][1] = (double)m->start[i].y + t * ( (double)m->end[i].y - (double)m->start[i].y );
        out[i][2] = (double)m->start[i].z + t * ( (double)m->end[i].z - (double)m->start[i].z );
    }
}

// Six times the volume that the four ends span: 0 where the segments are in one plane.
static double volume_at( const moving_pair* m, double t )
{
    double p[4][3], u[3][3];
    place_at( m, t, p );
    for ( int k = 0; k < 3; ++k )
    {
        u[0][k] = p[1][k] - p[0][k];
        u[1][k] = p[3][k] - p[2][k];
        u[2][k] = p[2][k] - p[0][k];
    }
    return ( u[0][1] * u[1][2] - u[0][2] * u[1][1] ) * u[2][0] + ( u[0][2] * u[1][0] - u[0][0] * u[1][2] ) * u[2][1] +
           ( u[0][0] * u[1][1] - u[0][1] * u[1][0] ) * u[2][2];
}

// Do segments in one plane cross?
static bool cross_at( const moving_pair* m, double t )
{
    double p[4][3], a = 0.0, b = 0.0, c = 0.0, d = 0.0, e = 0.0;
    place_at( m, t, p );
    for ( int k = 0; k < 3; ++k )
    {
        const double u = p[1][k] - p[0][k], v = p[3][k] - p[2][k], w = p[0][k] - p[2][k];
        a += u * u;
        b += u * v;
        c += v * v;
        d += u * w;
        e += v * w;
    }
    const double determinant = a * c - b * b;
    const double s = ( b * e - c * d ) / determinant, r = ( a * e - b * d ) / determinant;
    return determinant > 1e-12 * a * c && s >= 0.0 && s <= 1.0 && r >= 0.0 && r <= 1.0;
}

// Do two segments pass through each other while their ends go straight?
static bool passes( const moving_pair* m )
{
    enum
    {
        PARTS = 8,
    };
    for ( int i = 0; i < PARTS; ++i )
    {
        double from = (double)i / PARTS, to = (double)( i + 1 ) / PARTS;
        const double first = volume_at( m, from );
        if ( ( first > 0.0 ) == ( volume_at( m, to ) > 0.0 ) )
        {
            continue;
        }
        for ( int k = 0; k < 40; ++k )
        {
            const double middle = 0.5 * ( from + to );
            const bool is_before = ( volume_at( m, middle ) > 0.0 ) == ( first > 0.0 );
            from = is_before ? middle : from;
            to = is_before ? to : middle;
        }
        if ( cross_at( m, from ) )
        {
            return true;
        }
    }
    return false;
}

static bounds_of bounds_of_way( const wisp_vec3* before, const wisp_vec3* now )
{
    const wisp_vec3 ends[4] = { before[0], before[1], now[0], now[1] };
    bounds_of b = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    for ( int i = 0; i < 4; ++i )
    {
        const float p[3] = { ends[i].x, ends[i].y, ends[i].z };
        for ( int k = 0; k < 3; ++k )
        {
            b.lower[k] = p[k] < b.lower[k] ? p[k] : b.lower[k];
            b.upper[k] = p[k] > b.upper[k] ? p[k] : b.upper[k];
        }
    }
    return b;
}

// Segments that pass through each other between two lists of points, of strands with `count` vertices each.
static int count_passes( const wisp_vec3* before, const wisp_vec3* now, int points, int count )
{
    bounds_of* ways = checked_calloc( (size_t)points, sizeof( *ways ) );
    int found = 0;
    for ( int a = 0; a + 1 < points; ++a )
    {
        ways[a] = bounds_of_way( before + a, now + a );
    }
    for ( int a = 0; a + 1 < points; ++a )
    {
        for ( int b = a + 2; b + 1 < points; ++b )
        {
            if ( bounds_part( ways + a, ways + b ) || ( a + 1 ) % count == 0 || ( b + 1 ) % count == 0 )
            {
                continue;
            }
            const moving_pair m = { { before[a], before[a + 1], before[b], before[b + 1] },
                                    { now[a], now[a + 1], now[b], now[b + 1] } };
            found += passes( &m ) ? 1 : 0;
        }
    }
    free( ways );
    return found;
}

// ---- two sticks ----

enum
{
    COUNT = 9,
};

// A stick along x is held at both ends; one along z flies at it from above. @param same both are in one entity
static void fly_at( float speed, float seconds, bool same )
{
    static const int32_t ENDS[2] = { 0, COUNT - 1 };
    wisp_vec3 points[2 * COUNT];
    lay( ( wisp_vec3 ){ -0.2f, 0.0f, 0.01f }, ( wisp_vec3 ){ 0.2f, 0.0f, 0.01f }, COUNT, points );
    lay( ( wisp_vec3 ){ 0.013f, 0.1f, -0.2f }, ( wisp_vec3 ){ 0.013f, 0.1f, 0.2f }, COUNT, points + COUNT );
    sticks s = open_sticks( 1, 1 );
    wisp_strand_dynamics_def held = stick_def(), flies = stick_def();
    held.pins = ENDS;
    held.pin_count = 2;
    const float thickness = 0.01f;
    wisp_entity e[2];
    e[0] = add_sticks( &s, points, same ? 2 : 1, COUNT, &held, thickness );
    e[1] = same ? e[0] : add_sticks( &s, points + COUNT, 1, COUNT, &flies, thickness );
    float* velocity = wisp_world_column( s.world, e[1], WISP_STRAND_VELOCITY, 0 );
    for ( int i = 0; i < COUNT; ++i )
    {
        velocity[( 3 * i + 1 ) * WISP_LANES + ( same ? 1 : 0 )] = -speed;
    }
    wisp_vec3 before[2 * COUNT], now[2 * COUNT];
    int pressed = 0;
    request_stats( s.world );
    memcpy( before, points, sizeof( before ) );
    const int steps = 40 + (int)( 0.2f / ( speed * seconds ) );
    for ( int step = 0; step < steps; ++step )
    {
        assert_status( s.world, wisp_world_step( s.world, seconds ), WISP_OK );
        memcpy( now, view_of( s.world, e[0], WISP_STRAND_POINTS ).data, ( same ? 2u : 1u ) * COUNT * sizeof( *now ) );
        if ( same == false )
        {
            memcpy( now + COUNT, view_of( s.world, e[1], WISP_STRAND_POINTS ).data, COUNT * sizeof( *now ) );
        }
        if ( count_passes( before, now, 2 * COUNT, COUNT ) > 0 )
        {
            fail_msg( "%g m/s, %g s: passed in step %d", (double)speed, (double)seconds, step );
        }
        pressed += contact_stats( s.world ).contacts > 0 ? 1 : 0;
        assert_int_equal( wisp_world_counter( s.world, WISP_COUNT_HALTED ), 0 );
        memcpy( before, now, sizeof( before ) );
    }
    assert_true( pressed > 0 );
    close_sticks( &s );
}

TEST( a_stick_does_not_pass_one_that_is_held )
{
    const float speeds[] = { 0.5f, 5.0f, 50.0f, 500.0f };
    for ( int k = 0; k < WISP_COUNT( speeds ); ++k )
    {
        for ( int k2 = 1; k2 <= 8; k2 *= 8 )
        {
            fly_at( speeds[k], FRAME_TIME / (float)k2, false );
            fly_at( speeds[k], FRAME_TIME / (float)k2, true );
        }
    }
}

// ---- a heap ----

enum
{
    HEAP = 300,
    HEAP_VERTICES = 5,
    HEAP_POINTS = HEAP * HEAP_VERTICES,
};

// Sticks of 0.1 m above a floor, each turned another way.
static void lay_heap( wisp_vec3* points )
{
    for ( int i = 0; i < HEAP; ++i )
    {
        const float angle = 2.4f * (float)i, x = 0.05f * sinf( 7.0f * (float)i ), z = 0.05f * cosf( 3.0f * (float)i ),
                    y = 0.02f + 0.006f * (float)( i / 2 ) + 0.003f * (float)( i % 2 );
        lay( ( wisp_vec3 ){ x - 0.05f * cosf( angle ), y, z - 0.05f * sinf( angle ) },
             ( wisp_vec3 ){ x + 0.05f * cosf( angle ), y, z + 0.05f * sinf( angle ) }, HEAP_VERTICES,
             points + i * HEAP_VERTICES );
    }
}

static uint64_t fall( int workers, int steps, bool counts )
{
    static wisp_vec3 points[HEAP_POINTS];
    lay_heap( points );
    sticks s = open_sticks( 1, workers );
    wisp_strand_dynamics_def def = stick_def();
    def.gravity.y = -9.81f;
    def.bend_rigidity = 1e-4f;
    def.damping = 0.5f;
    const wisp_entity e = add_sticks( &s, points, HEAP, HEAP_VERTICES, &def, 0.002f );
    wisp_collider_def plane = wisp_default_collider_def();
    plane.kind = WISP_COLLIDER_PLANE;
    wisp_entity floor_entity;
    const wisp_collision_def collision = wisp_default_collision_def();
    assert_status( s.world, wisp_add_collider( s.world, &plane, &floor_entity ), WISP_OK );
    assert_status( s.world, wisp_set_collision( s.world, e, &collision ), WISP_OK );
    int passed = 0;
    for ( int step = 0; step < steps; ++step )
    {
        assert_status( s.world, wisp_world_step( s.world, 1.0f / 120.0f ), WISP_OK );
        const wisp_vec3* now = view_of( s.world, e, WISP_STRAND_POINTS ).data;
        passed += counts ? count_passes( points, now, HEAP_POINTS, HEAP_VERTICES ) : 0;
        memcpy( points, now, sizeof( points ) );
    }
    assert_int_equal( passed, 0 );
    double height = 0.0;
    for ( int i = 0; i < HEAP_POINTS; ++i )
    {
        height += (double)points[i].y / HEAP_POINTS;
    }
    assert_true( steps < 100 || ( height > 0.01 && height < 0.2 ) ); // it is a heap
    const uint64_t hash = wisp_world_hash( s.world );
    close_sticks( &s );
    return hash;
}

TEST( a_heap_of_sticks_does_not_mingle )
{
    (void)fall( 2, 120, true );
}

// ---- strands that nothing comes near ----

typedef struct apart_run
{
    int steps_apart, contacts, through;
    wisp_vec3 points[STRANDS * VERTICES]; // at the end
} apart_run;

// A sheet flies down to a rake of strands on a moving head, and starts so high above it. Without culling the mark that strands are
// apart is taken back before each step.
static apart_run fly_sheet( float height, float speed, int workers, bool has_contact, bool is_culled )
{
    enum
    {
        STEPS = 12,
    };
    hosted h;
    open_contact( &h, SUBSTEPS, 1, workers );
    const wisp_entity strands = add_rake( h.world, ( wisp_vec3 ){ -0.2f, 0.0f, 0.0f }, 0.02f );
    test_mesh mesh = level_sheet( 21, 1.2f, ( wisp_vec3 ){ 0.013f, height, 0.017f } );
    const wisp_entity sheet = add_draping( h.world, &mesh, NULL, 0, ( wisp_vec3 ){ 0 } );
    wisp_contact_def def = contact_of( 0.01f );
    def.self = false;
    if ( has_contact )
    {
        set_contact( h.world, strands, &def );
        set_contact( h.world, sheet, &def );
        request_stats( h.world );
    }
    assert_status( h.world, wisp_set_velocity( h.world, sheet, ( wisp_vec3 ){ 0, -speed, 0 }, ( wisp_vec3 ){ 0 } ),
                   WISP_OK );
    apart_run run = { 0 };
    for ( int s = 1; s <= STEPS; ++s )
    {
        const float turn = 0.02f * (float)s;
        const wisp_transform pose =
            wisp_transform_make( ( wisp_quat ){ 0, sinf( turn ), 0, cosf( turn ) }, ( wisp_vec3 ){ 0, 0, turn } );
        assert_status( h.world, wisp_move_strand_head( h.world, strands, pose ), WISP_OK );
        int32_t* apart = wisp_world_column( h.world, strands, WISP_STRAND_REACH, 2 );
        run.steps_apart += apart != NULL ? *apart : 0;
        if ( apart != NULL && is_culled == false )
        {
            *apart = 0;
        }
        run_steps( h.world, 1, FRAME );
        run.contacts += has_contact ? contact_stats( h.world ).contacts : 0;
        run.through += has_contact ? count_segments_through( h.world, strands, sheet ) : 0;
    }
    memcpy( run.points, view_of( h.world, strands, WISP_STRAND_POINTS ).data, sizeof( run.points ) );
    close_world( &h );
    return run;
}

// Strands far from everything take part in contact, and move bit for bit as if they did not.
TEST( strands_far_from_everything_run_apart_and_move_as_without_contact )
{
    const apart_run without = fly_sheet( 50.0f, 0.0f, 1, false, true );
    for ( int workers = 1; workers <= 3; workers += 2 )
    {
        const apart_run with = fly_sheet( 50.0f, 0.0f, workers, true, true );
        assert_int_equal( with.steps_apart, 11 ); // the first step finds it out
        assert_memory_equal( with.points, without.points, sizeof( with.points ) );
    }
}

// What comes near within a step finds them where they would be without culling, at any speed, and nothing passes.
TEST( strands_apart_join_within_the_step_in_which_something_comes_near )
{
    static const float SPEEDS[] = { 10.0f, 40.0f, 150.0f }; // m/s
    for ( int i = 0; i < WISP_COUNT( SPEEDS ); ++i )
    {
        const float height = 0.4f + 5.3f * SPEEDS[i] * FRAME;
        const apart_run plain = fly_sheet( height, SPEEDS[i], 1, true, false );
        assert_true( plain.contacts > 0 );
        for ( int workers = 1; workers <= 3; workers += 2 )
        {
            const apart_run culled = fly_sheet( height, SPEEDS[i], workers, true, true );
            assert_true( culled.steps_apart > 0 );
            assert_int_equal( culled.through, plain.through );
            assert_int_equal( culled.contacts, plain.contacts );
            assert_memory_equal( culled.points, plain.points, sizeof( plain.points ) );
        }
    }
}
