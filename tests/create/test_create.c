// Covers, and generated meshes and strands.
#include "support.h"

#include "create.h"
#include "wisp/fabric.h"
#include "wisp/generate.h"

#define assert_in_band( value, lower, upper ) assert_true( ( value ) >= ( lower ) && ( value ) <= ( upper ) )

enum
{
    COLUMNS = 13,
    ROWS = 9,
    SEGMENTS = 16,
    RINGS = 8,
    PARTS = 5,
};

// ---- generated meshes ----

static double signed_volume( const wisp_vec3* points, const int32_t* triangles, int count )
{
    double sum = 0.0;
    for ( int t = 0; t < count; ++t )
    {
        const wisp_vec3 a = points[triangles[3 * t]], b = points[triangles[3 * t + 1]],
                        c = points[triangles[3 * t + 2]];
        sum += (double)a.x * ( (double)b.y * (double)c.z - (double)b.z * (double)c.y ) +
               (double)a.y * ( (double)b.z * (double)c.x - (double)b.x * (double)c.z ) +
               (double)a.z * ( (double)b.x * (double)c.y - (double)b.y * (double)c.x );
    }
    return sum / 6.0;
}

static double area( const wisp_vec3* points, const int32_t* triangles, int count )
{
    double sum = 0.0;
    for ( int t = 0; t < count; ++t )
    {
        const wisp_vec3 a = points[triangles[3 * t]], b = points[triangles[3 * t + 1]],
                        c = points[triangles[3 * t + 2]];
        const double u[] = { (double)( b.x - a.x ), (double)( b.y - a.y ), (double)( b.z - a.z ) };
        const double v[] = { (double)( c.x - a.x ), (double)( c.y - a.y ), (double)( c.z - a.z ) };
        const double n[] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] };
        sum += 0.5 * sqrt( n[0] * n[0] + n[1] * n[1] + n[2] * n[2] );
    }
    return sum;
}

// Every directed edge once, and its opposite once: a closed surface whose triangles agree on a side.
static void assert_closed( const int32_t* triangles, int count, int vertex_count )
{
    int* edges = checked_calloc( (size_t)vertex_count * (size_t)vertex_count, sizeof( int ) );
    for ( int c = 0; c < 3 * count; ++c )
    {
        const int a = triangles[c], b = triangles[c % 3 == 2 ? c - 2 : c + 1];
        assert_in_range( a, 0, vertex_count - 1 );
        edges[a * vertex_count + b] += 1;
    }
    for ( int a = 0; a < vertex_count; ++a )
    {
        for ( int b = 0; b < vertex_count; ++b )
        {
            assert_true( edges[a * vertex_count + b] <= 1 );
            assert_int_equal( edges[a * vertex_count + b], edges[b * vertex_count + a] );
        }
    }
    free( edges );
}

TEST( a_grid_has_its_area_and_looks_up )
{
    static wisp_vec3 points[WISP_GRID_VERTICES( COLUMNS, ROWS )];
    static int32_t triangles[WISP_GRID_TRIANGLES( COLUMNS, ROWS )][3];
    wisp_error error;
    assert_ok( wisp_generate_grid( COLUMNS, ROWS, 0.25f, 0.5f, points, &triangles[0][0], &error ), error );
    assert_true( fabs( area( points, &triangles[0][0], WISP_COUNT( triangles ) ) - 3.0 * 4.0 ) < 1e-12 );
    assert_true( points[0].x == -1.5f && points[0].y == 0.0f && points[0].z == -2.0f );
    assert_true( points[COLUMNS].z == -1.5f );
    const wisp_vec3 a = points[triangles[0][0]], b = points[triangles[0][1]], c = points[triangles[0][2]];
    assert_true( ( b.z - a.z ) * ( c.x - a.x ) - ( b.x - a.x ) * ( c.z - a.z ) > 0.0f ); // y of the normal
}

TEST( round_meshes_are_closed_and_have_nearly_their_volume )
{
    static wisp_vec3 points[WISP_CAPSULE_VERTICES( SEGMENTS, RINGS, PARTS )];
    static int32_t triangles[WISP_CAPSULE_TRIANGLES( SEGMENTS, RINGS, PARTS )][3];
    int32_t* t = &triangles[0][0];
    const double PI = 3.14159265358979;
    wisp_error error;

    assert_ok( wisp_generate_sphere( SEGMENTS, RINGS, 2.0f, points, t, &error ), error );
    assert_closed( t, WISP_SPHERE_TRIANGLES( SEGMENTS, RINGS ), WISP_SPHERE_VERTICES( SEGMENTS, RINGS ) );
    const double sphere = 4.0 / 3.0 * PI * 8.0;
    // inside the sphere, by less than a tenth for 16 x 8 parts
    assert_in_band( signed_volume( points, t, WISP_SPHERE_TRIANGLES( SEGMENTS, RINGS ) ) / sphere, 0.9, 1.0 );

    assert_ok( wisp_generate_capsule( SEGMENTS, RINGS, PARTS, 1.0f, 3.0f, points, t, &error ), error );
    assert_closed( t, WISP_COUNT( triangles ), WISP_COUNT( points ) );
    const double capsule = PI * 3.0 + 4.0 / 3.0 * PI;
    assert_in_band( signed_volume( points, t, WISP_COUNT( triangles ) ) / capsule, 0.9, 1.0 );

    assert_ok( wisp_generate_torus( SEGMENTS, RINGS, 2.0f, 0.5f, points, t, &error ), error );
    assert_closed( t, WISP_TORUS_TRIANGLES( SEGMENTS, RINGS ), WISP_TORUS_VERTICES( SEGMENTS, RINGS ) );
    const double torus = 2.0 * PI * PI * 2.0 * 0.25;
    assert_in_band( signed_volume( points, t, WISP_TORUS_TRIANGLES( SEGMENTS, RINGS ) ) / torus, 0.85, 1.0 );

    assert_ok( wisp_generate_cylinder( SEGMENTS, PARTS, 1.0f, 3.0f, points, t, &error ), error );
    const double mantle = 2.0 * PI * 3.0;
    assert_in_band( area( points, t, WISP_CYLINDER_TRIANGLES( SEGMENTS, PARTS ) ) / mantle, 0.99, 1.0 );
    assert_true( points[0].y == 1.5f && points[WISP_CYLINDER_VERTICES( SEGMENTS, PARTS ) - 1].y == -1.5f );
}

TEST( strands_hang_from_a_grid_of_roots )
{
    wisp_vec3 points[3 * 2 * 5];
    int32_t offsets[3 * 2 + 1];
    wisp_error error;
    assert_ok( wisp_generate_strand_rows( 3, 2, 0.1f, 5, 0.2f, points, offsets, &error ), error );
    for ( int s = 0; s <= 6; ++s )
    {
        assert_int_equal( offsets[s], 5 * s );
    }
    assert_true( points[0].x == -0.1f && points[0].y == 0.0f && points[0].z == -0.05f );
    assert_true( points[4].y == -0.2f && points[4].x == points[0].x );
    assert_true( points[5].x == 0.0f && points[3 * 5].z == 0.05f );
}

TEST( numbers_that_make_no_mesh_are_named )
{
    wisp_vec3 points[4] = { { 7.0f, 7.0f, 7.0f } };
    int32_t t[6];
    wisp_error error;
#define NAMED( call, words )                                                                                         \
    assert_int_equal( call, WISP_BAD_INPUT );                                                                        \
    assert_contains( error.message, words );
    NAMED( wisp_generate_grid( 1, 2, 1.0f, 1.0f, points, t, &error ), "grid: columns: got 1" )
    NAMED( wisp_generate_grid( 2, 2, NAN, 1.0f, points, t, &error ), "grid: dx: got nan" )
    NAMED( wisp_generate_grid( 2, 2, 1.0f, 1.0f, NULL, t, &error ), "points: got null" )
    NAMED( wisp_generate_grid( 2, 2, 1.0f, 1.0f, points, NULL, &error ), "triangles: got null" )
    NAMED( wisp_generate_grid( 60000, 60000, 1.0f, 1.0f, points, t, &error ), "60000 times 60000" )
    NAMED( wisp_generate_sphere( 2, 4, 1.0f, points, t, &error ), "sphere: segments: got 2" )
    NAMED( wisp_generate_cylinder( 3, 0, 1.0f, 1.0f, points, t, &error ), "cylinder: parts: got 0" )
    NAMED( wisp_generate_capsule( 3, 2000000000, 1, 1.0f, 1.0f, points, t, &error ), "capsule: rings" )
    NAMED( wisp_generate_torus( 3, 3, 1.0f, 1.0f, points, t, &error ), "torus: tube radius: got 1 m" )
    NAMED( wisp_generate_strand_rows( 1, 1, 1.0f, 1, 1.0f, points, t, &error ), "strand rows: vertices: got 1" )
#undef NAMED
    assert_int_equal( wisp_generate_grid( 0, 0, 0.0f, 0.0f, NULL, NULL, NULL ), WISP_BAD_INPUT );
    assert_true( points[0].x == 7.0f );
}

// ---- covers ----

typedef struct grid
{
    wisp_vec3 points[WISP_GRID_VERTICES( COLUMNS, ROWS )];
    int32_t triangles[WISP_GRID_TRIANGLES( COLUMNS, ROWS )][3];
} grid;

static const int32_t corners[] = { 0, COLUMNS - 1 };

static wisp_create_cloth_def cloth_of( grid* g )
{
    wisp_create_cloth_def def = wisp_default_create_cloth_def();
    assert_int_equal( wisp_generate_grid( COLUMNS, ROWS, 0.1f, 0.1f, g->points, &g->triangles[0][0], NULL ),
                      WISP_OK );
    def.points = g->points;
    def.vertex_count = WISP_COUNT( g->points );
    def.triangles = &g->triangles[0][0];
    def.triangle_count = WISP_COUNT( g->triangles );
    def.pins = corners;
    def.pin_count = WISP_COUNT( corners );
    return def;
}

static wisp_world* new_world( void )
{
    wisp_world* world;
    wisp_error error;
    wisp_world_def def = wisp_default_world_def();
    def.modules = wisp_all_modules( &def.module_count );
    assert_ok( wisp_world_create( &def, &world, &error ), error );
    return world;
}

TEST( a_created_cloth_is_what_its_parts_make )
{
    static grid g;
    const wisp_create_cloth_def def = cloth_of( &g );
    wisp_world* covered = new_world();
    wisp_entity cloth;
    assert_int_equal( wisp_create_cloth( covered, &def, &cloth ), WISP_OK );

    wisp_world* parts = new_world();
    wisp_fabric_def fabric = wisp_default_fabric_def();
    fabric.points = g.points, fabric.vertex_count = WISP_COUNT( g.points );
    fabric.triangles = &g.triangles[0][0], fabric.triangle_count = WISP_COUNT( g.triangles );
    fabric.attachments = corners, fabric.attachment_count = WISP_COUNT( corners );
    wisp_surface_def surface = wisp_default_surface_def();
    surface.pins = corners, surface.pin_count = WISP_COUNT( corners );
    const wisp_cloth_def material = wisp_default_cloth_def();
    const wisp_collision_def collision = wisp_default_collision_def();
    wisp_entity made;
    assert_int_equal( wisp_fabric_cook( &fabric, NULL, &surface.fabric, NULL ), WISP_OK );
    assert_int_equal( wisp_add_surface( parts, &surface, &made ), WISP_OK );
    wisp_fabric_release( surface.fabric );
    assert_int_equal( wisp_set_cloth( parts, made, &material ), WISP_OK );
    assert_int_equal( wisp_set_collision( parts, made, &collision ), WISP_OK );
    assert_int_equal( wisp_request( parts, made, WISP_SURFACE_NORMALS ), WISP_OK );
    assert_int_equal( wisp_request( parts, made, WISP_SURFACE_POINTS ), WISP_OK );

    wisp_world* worlds[] = { covered, parts };
    for ( int w = 0; w < 2; ++w )
    {
        for ( int step = 0; step < 20; ++step )
        {
            assert_int_equal( wisp_world_step( worlds[w], 1.0f / 60.0f ), WISP_OK );
        }
    }
    uint64_t a, b;
    assert_int_equal( wisp_world_hash_column( covered, cloth, WISP_SURFACE_POINTS, &a ), WISP_OK );
    assert_int_equal( wisp_world_hash_column( parts, made, WISP_SURFACE_POINTS, &b ), WISP_OK );
    assert_true( a == b );
    wisp_world_destroy( covered );
    wisp_world_destroy( parts );
}

TEST( gravity_pulls_cloth_and_hair_unless_it_is_zero )
{
    static grid g;
    wisp_world* world = new_world();
    wisp_create_cloth_def def = cloth_of( &g );
    wisp_entity falling, floating, hair;
    def.pin_count = 0;
    assert_int_equal( wisp_create_cloth( world, &def, &falling ), WISP_OK );
    def.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    assert_int_equal( wisp_create_cloth( world, &def, &floating ), WISP_OK );
    wisp_vec3 points[2 * 8];
    int32_t offsets[3];
    assert_int_equal( wisp_generate_strand_rows( 2, 1, 0.1f, 8, 0.2f, points, offsets, NULL ), WISP_OK );
    for ( int v = 0; v < 16; ++v )
    {
        points[v] = ( wisp_vec3 ){ points[v].x, 0.0f, points[v].y }; // lying
    }
    wisp_create_hair_def hair_def = wisp_default_create_hair_def();
    wisp_strand_dynamics_def soft = wisp_default_strand_dynamics_def();
    soft.rest = WISP_STRAND_REST_STRAIGHT;
    hair_def.points = points, hair_def.offsets = offsets, hair_def.strand_count = 2;
    hair_def.dynamics = &soft;
    assert_int_equal( wisp_create_hair( world, &hair_def, &hair ), WISP_OK );
    for ( int step = 0; step < 30; ++step )
    {
        assert_int_equal( wisp_world_step( world, 1.0f / 60.0f ), WISP_OK );
    }
    wisp_view view;
    assert_int_equal( wisp_world_view( world, falling, WISP_SURFACE_POINTS, &view ), WISP_OK );
    // free fall for 0.5 s: g t^2 / 2 = 1.226 m; by implicit Euler in 300 substeps a little more
    assert_in_band( -( (const wisp_vec3*)view.data )[40].y, 1.22, 1.24 );
    assert_int_equal( wisp_world_view( world, floating, WISP_SURFACE_POINTS, &view ), WISP_OK );
    assert_true( ( (const wisp_vec3*)view.data )[40].y == 0.0f );
    assert_int_equal( wisp_world_view( world, hair, WISP_STRAND_POINTS, &view ), WISP_OK );
    assert_true( ( (const wisp_vec3*)view.data )[7].y < -0.05f );
    wisp_world_destroy( world );
}

TEST( what_is_created_comes_to_rest )
{
    static grid g;
    wisp_world* world = new_world();
    const wisp_create_cloth_def cloth_def = cloth_of( &g );
    wisp_create_hair_def hair_def = wisp_default_create_hair_def();
    wisp_vec3 points[16];
    int32_t offsets[3];
    wisp_entity moving[2];
    assert_int_equal( wisp_generate_strand_rows( 2, 1, 0.1f, 8, 0.2f, points, offsets, NULL ), WISP_OK );
    hair_def.points = points, hair_def.offsets = offsets, hair_def.strand_count = 2;
    assert_int_equal( wisp_create_cloth( world, &cloth_def, &moving[0] ), WISP_OK );
    assert_int_equal( wisp_create_hair( world, &hair_def, &moving[1] ), WISP_OK );
    for ( int step = 0; step < 300; ++step )
    {
        const float aside = 0.02f * (float)( step < 10 ? step : 10 );
        const wisp_transform head = { { 0.0f, 0.0f, 0.0f, 1.0f }, { aside, 0.0f, 0.0f } };
        assert_int_equal( wisp_move_strand_head( world, moving[1], head ), WISP_OK );
        for ( int i = 0; i < 2; ++i )
        {
            assert_int_equal( wisp_request( world, moving[i], WISP_MOTION_STATS ), WISP_OK );
        }
        assert_int_equal( wisp_world_step( world, 1.0f / 60.0f ), WISP_OK );
        for ( int i = 0; i < 2 && ( step == 20 || step == 299 ); ++i )
        {
            wisp_motion_stats stats;
            assert_int_equal( wisp_read_motion_stats( world, moving[i], &stats ), WISP_OK );
            assert_true( step == 20 ? stats.speed_max > 0.3 : stats.speed_max < 0.01 ); // m/s
        }
    }
    wisp_world_destroy( world );
}

TEST( an_instance_has_the_gravity_of_its_source )
{
    static grid g;
    wisp_world* world = new_world();
    wisp_create_cloth_def def = cloth_of( &g );
    wisp_entity sources[2], copies[2];
    def.gravity = ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f };
    assert_int_equal( wisp_create_cloth( world, &def, &sources[0] ), WISP_OK );
    def.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    assert_int_equal( wisp_create_cloth( world, &def, &sources[1] ), WISP_OK );
    for ( int i = 0; i < 2; ++i )
    {
        assert_int_equal( wisp_add_instance( world, sources[i], NULL, &copies[i] ), WISP_OK );
        assert_int_equal( wisp_request( world, copies[i], WISP_SURFACE_POINTS ), WISP_OK );
    }
    for ( int step = 0; step < 60; ++step )
    {
        assert_int_equal( wisp_world_step( world, 1.0f / 60.0f ), WISP_OK );
    }
    wisp_view view;
    assert_int_equal( wisp_world_view( world, copies[0], WISP_SURFACE_POINTS, &view ), WISP_OK );
    assert_in_band( ( (const wisp_vec3*)view.data )[40].y, -0.51, -0.49 ); // t^2 / 2
    assert_int_equal( wisp_world_view( world, copies[1], WISP_SURFACE_POINTS, &view ), WISP_OK );
    assert_true( ( (const wisp_vec3*)view.data )[40].y == 0.0f );
    wisp_world_destroy( world );
}

TEST( a_fabric_is_cooked_with_what_the_material_needs )
{
    static grid g;
    static wisp_vec3 points[WISP_GRID_VERTICES( 40, 40 )];
    static int32_t triangles[WISP_GRID_TRIANGLES( 40, 40 )][3];
    wisp_cloth_def materials[4];
    for ( int i = 0; i < 4; ++i )
    {
        materials[i] = wisp_default_cloth_def();
    }
    materials[0].bending = WISP_CLOTH_BENDING_DIHEDRAL;
    materials[1].bending = WISP_CLOTH_BENDING_NONE;
    materials[2].tethers = true;
    materials[3].coarse_substeps = 1;
    wisp_world* world = new_world();
    for ( int i = 0; i < 4; ++i )
    {
        wisp_create_cloth_def def = cloth_of( &g );
        wisp_entity cloth;
        def.material = &materials[i];
        if ( i == 3 ) // large enough for coarse sheets
        {
            assert_int_equal( wisp_generate_grid( 40, 40, 0.02f, 0.02f, points, &triangles[0][0], NULL ), WISP_OK );
            def.points = points, def.vertex_count = WISP_COUNT( points );
            def.triangles = &triangles[0][0], def.triangle_count = WISP_COUNT( triangles );
        }
        assert_int_equal( wisp_create_cloth( world, &def, &cloth ), WISP_OK );
    }
    assert_int_equal( wisp_world_step( world, 1.0f / 60.0f ), WISP_OK );
    wisp_world_destroy( world );
}

TEST( a_large_cloth_hardly_stretches_by_default )
{
    enum
    {
        SIDE = 50,
    };
    static wisp_vec3 points[WISP_GRID_VERTICES( SIDE, SIDE )];
    static int32_t triangles[WISP_GRID_TRIANGLES( SIDE, SIDE )][3];
    const int32_t pins[] = { 0, SIDE - 1 };
    wisp_cloth_def plain = wisp_default_cloth_def();
    plain.coarse_substeps = 0;
    double mean[2];
    for ( int variant = 0; variant < 2; ++variant )
    {
        wisp_world* world = new_world();
        wisp_create_cloth_def def = wisp_default_create_cloth_def();
        wisp_entity cloth;
        wisp_motion_stats stats;
        assert_int_equal( wisp_generate_grid( SIDE, SIDE, 0.02f, 0.02f, points, &triangles[0][0], NULL ), WISP_OK );
        def.points = points, def.vertex_count = WISP_COUNT( points );
        def.triangles = &triangles[0][0], def.triangle_count = WISP_COUNT( triangles );
        def.pins = pins, def.pin_count = WISP_COUNT( pins );
        def.material = variant == 0 ? NULL : &plain;
        assert_int_equal( wisp_create_cloth( world, &def, &cloth ), WISP_OK );
        assert_int_equal( wisp_request( world, cloth, WISP_MOTION_STATS ), WISP_OK );
        for ( int step = 0; step < 40; ++step )
        {
            assert_int_equal( wisp_world_step( world, 1.0f / 60.0f ), WISP_OK );
        }
        assert_int_equal( wisp_read_motion_stats( world, cloth, &stats ), WISP_OK );
        mean[variant] = stats.strain_mean;
        wisp_world_destroy( world );
    }
    // coarse sheets carry what ten plain substeps let fall: 0.08 % against 3.1 %
    assert_true( mean[0] < 0.01 && mean[0] < 0.25 * mean[1] );
}

// Wind of a cover is that of the definition under it; without a coefficient it is that of a later call, with a drag coefficient of 1.
TEST( what_is_created_in_wind_is_blown )
{
    static grid g;
    uint64_t hashes[3];
    wisp_vec3 points[2 * 2 * 5];
    int32_t offsets[5];
    assert_int_equal( wisp_generate_strand_rows( 2, 2, 0.1f, 5, 0.2f, points, offsets, NULL ), WISP_OK );
    for ( int way = 0; way < 3; ++way )
    {
        wisp_world* world = new_world();
        const wisp_vec3 wind = { 0.0f, 1.0f, 6.0f };
        wisp_create_cloth_def cloth_def = cloth_of( &g );
        wisp_create_hair_def hair_def = wisp_default_create_hair_def();
        hair_def.points = points, hair_def.offsets = offsets, hair_def.strand_count = 4;
        cloth_def.wind = hair_def.wind = way < 2 ? wind : ( wisp_vec3 ){ 0 };
        cloth_def.drag_coefficient = hair_def.drag_coefficient = way == 0 ? 1.0f : 0.0f;
        wisp_entity cloth, hair;
        assert_int_equal( wisp_create_cloth( world, &cloth_def, &cloth ), WISP_OK );
        assert_int_equal( wisp_create_hair( world, &hair_def, &hair ), WISP_OK );
        if ( way == 2 )
        {
            assert_int_equal( wisp_set_cloth_wind( world, cloth, wind ), WISP_OK );
            assert_int_equal( wisp_set_strand_wind( world, hair, wind ), WISP_OK );
        }
        wisp_view view;
        for ( int step = 0; step < 20; ++step )
        {
            assert_int_equal( wisp_world_step( world, 1.0f / 60.0f ), WISP_OK );
        }
        assert_int_equal( wisp_world_view( world, hair, WISP_STRAND_POINTS, &view ), WISP_OK );
        assert_true( ( (const wisp_vec3*)view.data )[4].z > points[4].z + 0.01f );
        hashes[way] = wisp_world_hash( world );
        wisp_world_destroy( world );
    }
    assert_true( hashes[0] == hashes[1] && hashes[1] == hashes[2] );
}

// Set twice and stepped twice, by another plan each; what meets or blows is not told of.
TEST( what_has_no_effect_is_told_once )
{
    static grid g;
    test_log log = { 0 };
    wisp_world_def world_def = wisp_default_world_def();
    world_def.modules = wisp_all_modules( &world_def.module_count );
    world_def.log = test_log_write, world_def.log_user = &log;
    wisp_world* world;
    assert_int_equal( wisp_world_create( &world_def, &world, NULL ), WISP_OK );
    wisp_create_cloth_def def = cloth_of( &g );
    wisp_cloth_def material = wisp_default_cloth_def();
    wisp_contact_def contact = wisp_default_contact_def();
    wisp_collider_def ball = wisp_default_collider_def();
    wisp_entity cloth, body;
    material.wind.x = 3.0f, contact.self = false, ball.layers = 2, ball.pose.translation.y = 5.0f;
    wisp_collision_def collision = wisp_default_collision_def();
    collision.mask = 1;
    def.material = &material, def.contact = &contact, def.collision = &collision;
    assert_int_equal( wisp_create_cloth( world, &def, &cloth ), WISP_OK );
    assert_int_equal( wisp_set_cloth( world, cloth, &material ), WISP_OK );
    assert_int_equal( wisp_add_collider( world, &ball, &body ), WISP_OK );
    for ( int step = 0; step < 2; ++step )
    {
        assert_int_equal( wisp_world_step( world, 1.0f / 60.0f ), WISP_OK );
        assert_int_equal( wisp_request( world, cloth, WISP_MOTION_STATS ), WISP_OK );
    }
    assert_int_equal( log.count, 3 ); // wind, contact, collider
    ball.layers = 1, material.drag_coefficient = 1.0f, contact.self = true;
    assert_int_equal( wisp_create_cloth( world, &def, &cloth ), WISP_OK );
    assert_int_equal( wisp_add_collider( world, &ball, &body ), WISP_OK );
    assert_int_equal( wisp_world_step( world, 1.0f / 60.0f ), WISP_OK );
    assert_int_equal( log.count, 3 );
    wisp_world_destroy( world );
}

TEST( what_cannot_be_created_leaves_nothing_behind )
{
    static grid g;
    wisp_world* world = new_world();
    const uint64_t empty = wisp_world_hash( world );
    wisp_create_cloth_def def = cloth_of( &g );
    wisp_cloth_def material = wisp_default_cloth_def();
    wisp_contact_def contact = wisp_default_contact_def();
    wisp_entity cloth;
    material.bend_compliance = -1.0f;
    def.material = &material;
    expect_refusal( world, wisp_create_cloth( world, &def, &cloth ), WISP_BAD_INPUT, "bend_compliance: got -1" );
    material = wisp_default_cloth_def();
    contact.friction = NAN;
    def.contact = &contact;
    expect_refusal( world, wisp_create_cloth( world, &def, &cloth ), WISP_BAD_INPUT, "friction: got nan" );
    def.contact = NULL;
    wisp_create_cloth_def none = def;
    none.vertex_count = none.triangle_count = 0;
    expect_refusal( world, wisp_create_cloth( world, &none, &cloth ), WISP_BAD_INPUT, "no points" );
    g.triangles[3][1] = 5000;
    expect_refusal( world, wisp_create_cloth( world, &def, &cloth ), WISP_BAD_INPUT, "5000" );
    assert_int_equal( cloth.index, 0 );
    assert_true( wisp_world_hash( world ) == empty );
    wisp_create_hair_def hair = wisp_default_create_hair_def();
    hair.strand_count = 3;
    expect_refusal( world, wisp_create_hair( world, &hair, &cloth ), WISP_BAD_INPUT, "strand_count: got 3" );
    wisp_world_destroy( world );

    // without a module the message names it
    wisp_world_def world_def = wisp_default_world_def();
    assert_int_equal( wisp_world_create( &world_def, &world, NULL ), WISP_OK );
    def = cloth_of( &g );
    expect_refusal( world, wisp_create_cloth( world, &def, &cloth ), WISP_CONFLICT, "module cloth: not registered" );
    wisp_world_destroy( world );
}

TEST( all_modules_are_listed_once )
{
    int count;
    const wisp_module* const* modules = wisp_all_modules( &count );
    assert_int_equal( count, 16 );
    assert_ptr_equal( wisp_all_modules( NULL ), modules );
    for ( int i = 0; i < count; ++i )
    {
        for ( int j = 0; j < i; ++j )
        {
            assert_ptr_not_equal( modules[i], modules[j] );
        }
    }
}

// ---- waves ----

// Calls of a host's loop, and their blocks.
typedef struct wave_count
{
    int waves, blocks;
} wave_count;

static void count_blocks( void* user, int block_count, wisp_block_fn* run, void* context )
{
    wave_count* c = user;
    c->waves += 1, c->blocks += block_count;
    for ( int block = 0; block < block_count; ++block )
    {
        run( context, block, block % 4 );
    }
}

// Step cloths of 33 x 33 vertices twice, and count the calls of the second step. @param shared they have one fabric
static uint64_t step_cloths( int count, bool shared, int workers, wave_count* c )
{
    static wisp_vec3 points[WISP_GRID_VERTICES( 33, 33 )];
    static int32_t triangles[WISP_GRID_TRIANGLES( 33, 33 )][3];
    wisp_create_cloth_def cloth = wisp_default_create_cloth_def();
    const wisp_cloth_def material = wisp_default_cloth_def();
    wisp_world_def def = wisp_default_world_def();
    wisp_world* world = NULL;
    wisp_entity first, other;
    def.modules = wisp_all_modules( &def.module_count );
    def.workers = workers, def.parallel_for = workers > 1 ? count_blocks : NULL, def.parallel_for_user = c;
    assert_int_equal( wisp_world_create( &def, &world, NULL ), WISP_OK );
    assert_int_equal( wisp_generate_grid( 33, 33, 0.02f, 0.02f, points, &triangles[0][0], NULL ), WISP_OK );
    cloth.points = points, cloth.vertex_count = WISP_COUNT( points );
    cloth.triangles = &triangles[0][0], cloth.triangle_count = WISP_COUNT( triangles );
    assert_int_equal( wisp_create_cloth( world, &cloth, &first ), WISP_OK );
    for ( int i = 1; i < count; ++i )
    {
        assert_int_equal( shared ? wisp_add_instance( world, first, NULL, &other )
                                 : wisp_create_cloth( world, &cloth, &other ),
                          WISP_OK );
        assert_int_equal( wisp_set_cloth( world, other, &material ), WISP_OK );
        assert_int_equal( wisp_request( world, other, WISP_PARTICLE_POSITION ), WISP_OK );
    }
    for ( int step = 0; step < 2; ++step )
    {
        *c = ( wave_count ){ 0, 0 };
        assert_int_equal( wisp_world_step( world, 1.0f / 60.0f ), WISP_OK );
    }
    const uint64_t hash = wisp_world_hash( world );
    wisp_world_destroy( world );
    return hash;
}

// One for all substeps, with a block for each cloth, and those before and behind them. A lone cloth wakes nobody in its substeps.
TEST( small_cloths_take_one_wave_a_step_for_all_substeps )
{
    for ( int count = 1; count <= 6; ++count )
    {
        wave_count c, alone;
        const bool shared = count > 3;
        assert_true( step_cloths( count, shared, 4, &c ) == step_cloths( count, shared, 1, &alone ) );
        assert_true( c.waves <= 4 && c.blocks == ( shared ? 4 * count + 3 : 5 * count ) );
    }
}
