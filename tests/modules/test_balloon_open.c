// Open skins (`allow_open`): each hole is closed by a virtual fan for the volume alone. The oracle is compared with
// central differences, the engine with the oracle, and both with properties that hold for any method.
#include "saved_world.h"
#include "balloon_engine_fixture.h"

#include "balloon_internal.h"

// ---- open meshes ----

// The part of a mesh on the near side of two planes: triangles with a vertex beyond one are removed, and so are
// vertices without a triangle.
static balloon_mesh cut( const balloon_mesh* whole, double3 normal, double above, double below )
{
    balloon_mesh mesh = { .positions = calloc( (size_t)whole->vertex_count, sizeof( double3 ) ),
                          .triangles = calloc( 3 * (size_t)whole->triangle_count, sizeof( int ) ) };
    SCOPED( free_local ) int* number = calloc( (size_t)whole->vertex_count, sizeof( int ) );
    assert_true( mesh.positions != NULL && mesh.triangles != NULL && number != NULL );
    for ( int t = 0; t < whole->triangle_count; ++t )
    {
        const int* corner = whole->triangles + 3 * t;
        bool stays = true;
        for ( int k = 0; k < 3; ++k )
        {
            double height = double3_dot( normal, whole->positions[corner[k]] );
            stays = stays && height <= above && height >= below;
        }
        for ( int k = 0; k < 3 && stays; ++k )
        {
            if ( number[corner[k]] == 0 )
            {
                mesh.positions[mesh.vertex_count++] = whole->positions[corner[k]];
                number[corner[k]] = mesh.vertex_count;
            }
            mesh.triangles[3 * mesh.triangle_count + k] = number[corner[k]] - 1;
        }
        mesh.triangle_count += stays ? 1 : 0;
    }
    return mesh;
}

static const double3 AXIS = { 0.8, 0.36, 0.48 };

// A pear with a mouth at each end; no border is flat or round.
static balloon_mesh pear_with_two_holes( int level )
{
    balloon_mesh pear = balloon_pear( level ), mesh = cut( &pear, AXIS, 0.11, -0.09 );
    balloon_mesh_topology topology;
    assert_true( balloon_mesh_build_topology( &mesh, &topology ) );
    assert_true( topology.border_count > 12 );
    balloon_mesh_destroy_topology( &topology );
    balloon_mesh_destroy( &pear );
    return mesh;
}

static balloon_oracle_caps caps_of( const balloon_mesh* mesh )
{
    balloon_oracle_caps caps;
    assert_true( balloon_oracle_make_caps( mesh, &caps ) );
    return caps;
}

static balloon_scene open_scene( const balloon_mesh* mesh )
{
    balloon_scene scene = balloon_scene_of( mesh );
    scene.def.allow_open = true;
    return scene;
}

static wisp_balloon_stats first_stats( const balloon_scene* scene )
{
    SCOPED( balloon_end ) balloon_flight flight = balloon_start( scene );
    balloon_steps( &flight, 1 );
    return balloon_read( &flight );
}

// ---- the oracle ----

TEST( the_oracles_gradient_is_that_of_the_capped_volume )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = pear_with_two_holes( 2 );
    SCOPED( balloon_oracle_destroy_caps ) balloon_oracle_caps caps = caps_of( &mesh );
    assert_int_equal( caps.hub_count, 2 );
    SCOPED( free_local ) double3* gradient = checked_calloc( (size_t)mesh.vertex_count, sizeof( double3 ) );
    double volume = balloon_oracle_capped_volume( &caps, mesh.positions ), other, largest = 0.0, dot = 0.0;
    assert_true( balloon_mesh_capped_volume( &mesh, &other ) );
    balloon_assert_fraction( volume, other, 1e-13 );
    balloon_oracle_capped_gradient( &caps, mesh.positions, gradient );
    double3 sum = { 0.0, 0.0, 0.0 };
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        largest = fmax( largest, double3_length( gradient[v] ) );
        sum = double3_add( sum, gradient[v] );
        dot += double3_dot( mesh.positions[v], gradient[v] );
    }
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        const double of[3] = { gradient[v].x, gradient[v].y, gradient[v].z };
        double* coordinates = &mesh.positions[v].x;
        for ( int k = 0; k < 3; ++k )
        {
            const double h = 1e-5, kept = coordinates[k];
            coordinates[k] = kept + h;
            double above = balloon_oracle_capped_volume( &caps, mesh.positions );
            coordinates[k] = kept - h;
            double below = balloon_oracle_capped_volume( &caps, mesh.positions );
            coordinates[k] = kept;
            balloon_assert_close( ( above - below ) / ( 2.0 * h ), of[k], 1e-6 * largest );
        }
    }
    // V does not depend on the position, and is of the third degree
    balloon_assert_close( double3_length( sum ) / largest, 0.0, 1e-12 );
    balloon_assert_fraction( dot, 3.0 * volume, 1e-12 );
}

// ---- the engine against the oracle ----

static balloon_scene busy_scene( const balloon_mesh* mesh, wisp_solver solver )
{
    balloon_scene scene = balloon_scene_in_air( mesh );
    scene.def.allow_open = true;
    scene.scale = 1.05;
    scene.def.gas_ratio = 1.2f;
    scene.def.inflation_rate = 1e-3f;
    scene.def.bend_link_stiffness = scene.def.edge_stiffness;
    scene.def.bend_stiffness = scene.def.stretch_stiffness = 0.5f;
    scene.def.solver = scene.def.volume = solver;
    scene.def.volume_stiffness = 0.8f;
    return scene;
}

// As for a closed skin: positions of 0.3 m are kept to 1.5e-8 m, and the dozen links of a vertex, its volume and its
// prediction round once each per iteration.
static const double ROUNDING = 1e-6;

TEST( a_step_of_an_open_skin_is_the_oracles )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = pear_with_two_holes( 2 );
    for ( int solver = 0; solver < WISP_SOLVER_COUNT; ++solver )
    {
        balloon_scene scene = busy_scene( &mesh, (wisp_solver)solver );
        scene.dt = 1.0f / 600.0f;
        scene.substeps = 1;
        SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
        balloon_stir( &flight, 0.5f );
        SCOPED( balloon_oracle_destroy ) balloon_oracle oracle = balloon_oracle_of( &flight, BALLOON_ORDER_ENGINE );
        balloon_steps( &flight, 2 );
        balloon_oracle_step( &oracle );
        balloon_oracle_step( &oracle );
        double distance = balloon_distance( &flight, &oracle );
        print_message( "           %s: engine and oracle are %.2g m apart\n",
                       solver == WISP_SOLVER_PBD ? "pbd" : "xpbd", distance );
        balloon_assert_close( distance, 0.0, ROUNDING );
        // forces at the start of the second step, of vertices that differ by a rounding then
        wisp_balloon_stats f = balloon_read( &flight );
        balloon_assert_fraction( f.rest_volume, oracle.rest_volume, 1e-12 );
        balloon_assert_fraction( f.volume, oracle.volume, 1e-5 );
        double3 drag = double3_sub( balloon_from( f.drag ), oracle.forces.drag );
        double3 lift = double3_sub( balloon_from( f.buoyancy ), oracle.forces.buoyancy );
        assert_true( double3_length( oracle.forces.drag ) > 0.0 );
        balloon_assert_close( double3_length( drag ) / double3_length( oracle.forces.drag ), 0.0, 1e-3 );
        balloon_assert_close( double3_length( lift ) / double3_length( oracle.forces.buoyancy ), 0.0, 1e-5 );
    }
}

// ---- references ----

TEST( a_flat_fan_restores_the_volume_of_the_closed_mesh )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_pear( 2 );
    balloon_scene closed = balloon_scene_of( &mesh ), scene = open_scene( &mesh );
    const wisp_balloon_stats whole = first_stats( &closed );
    SCOPED( free_local ) int* kept = checked_calloc( 3 * (size_t)mesh.triangle_count, sizeof( int ) );
    memcpy( kept, mesh.triangles, 3 * (size_t)mesh.triangle_count * sizeof( int ) );
    for ( int t = 0; t < mesh.triangle_count; t += 23 )
    {
        // the fan over three vertices lies in their triangle
        memcpy( mesh.triangles + 3 * t, kept + 3 * ( mesh.triangle_count - 1 ), 3 * sizeof( int ) );
        mesh.triangle_count -= 1;
        const wisp_balloon_stats open = first_stats( &scene );
        balloon_assert_fraction( open.rest_volume, whole.rest_volume, 1e-13 ); // doubles
        balloon_assert_fraction( open.volume, whole.volume, 1e-6 );            // sums of floats, which need 1e-3
        mesh.triangle_count += 1;
        memcpy( mesh.triangles + 3 * t, kept + 3 * t, 3 * sizeof( int ) );
    }
}

// Pressure on skin and fans together exerts no force: the gradients sum to zero. Without the fans' part the two
// mouths of different size would drive this pear along its axis.
TEST( gas_behind_fans_moves_no_centre_of_mass )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = pear_with_two_holes( 3 );
    balloon_scene scene = open_scene( &mesh );
    scene.def.gas_ratio = 1.3f;
    SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
    balloon_steps( &flight, 30 );
    const wisp_balloon_stats f = balloon_read( &flight );
    const balloon_state* s = wisp_world_module_state( flight.world, "balloon" );
    const float* vectors = wisp_world_column( flight.world, flight.entity, s->rings, 0 );
    assert_non_null( vectors );
    const wisp_fabric* fabric = wisp_world_fabric( flight.world, flight.entity );
    double3 skin = { 0.0, 0.0, 0.0 };
    double mass = 0.0;
    for ( int slot = 0; slot < fabric->vertex_count; ++slot )
    {
        const float* g = vectors + (size_t)( slot / 8 ) * 24 + slot % 8;
        skin = double3_add( skin, double3_make( (double)g[0], (double)g[8], (double)g[16] ) );
        mass += (double)( scene.area_density * fabric->area[slot] );
    }
    // the effect of the pressure in half a second on the skin alone, against rounding in 300 substeps: 1.5e-8 m per
    // vertex and projection is 1e-5 m/s, and hundreds of vertices average theirs
    double alone = f.pressure * double3_length( skin ) * 0.5 / mass;
    double speed = double3_length( balloon_momentum( &flight ) ) / mass;
    print_message( "           %.2g m/s, and %.2g m/s if the skin were pushed alone\n", speed, alone );
    assert_true( alone > 10.0 );
    balloon_assert_close( speed, 0.0, 1e-4 );
}

TEST( an_open_skin_takes_the_volume_it_is_queried_for )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = pear_with_two_holes( 2 );
    for ( int solver = 0; solver < WISP_SOLVER_COUNT; ++solver )
    {
        balloon_scene scene = open_scene( &mesh );
        scene.def.solver = scene.def.volume = (wisp_solver)solver;
        scene.def.edge_stiffness = scene.def.bend_link_stiffness = 1.0f;
        scene.def.stretch_stiffness = scene.def.bend_stiffness = 1e-3f;
        scene.def.gas_ratio = 1.5f;
        scene.damping = 20.0f;
        SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
        balloon_steps( &flight, 120 );
        wisp_balloon_stats f = balloon_read( &flight );
        balloon_assert_fraction( f.volume, 1.5 * f.rest_volume, 0.01 ); // Fig. 3 demands 1 % of a closed skin
    }
}

// ---- switches, bits ----

static uint64_t hash_of( const balloon_scene* scene, int steps )
{
    SCOPED( balloon_end ) balloon_flight flight = balloon_start( scene );
    balloon_steps( &flight, steps );
    assert_true( balloon_is_finite( &flight ) );
    return balloon_hash( &flight );
}

TEST( a_closed_skin_is_the_same_to_a_bit_whether_it_may_be_open_or_not )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_pear( 2 );
    balloon_scene scene = balloon_scene_in_air( &mesh );
    scene.def.gas_ratio = 1.2f;
    uint64_t refused = hash_of( &scene, 10 );
    scene.def.allow_open = true;
    assert_true( hash_of( &scene, 10 ) == refused );
}

TEST( a_lost_border_vertex_halts_its_balloon_and_what_is_kept_stays_a_number )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = pear_with_two_holes( 2 );
    balloon_scene scene = busy_scene( &mesh, WISP_SOLVER_XPBD );
    SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
    balloon_steps( &flight, 3 );
    uint64_t before = balloon_hash( &flight );
    const balloon_state* s = wisp_world_module_state( flight.world, "balloon" );
    const int32_t* open_edge = wisp_world_column( flight.world, flight.entity, s->open_edge, 0 );
    assert_non_null( open_edge );
    balloon_velocities( &flight )[4 * open_edge[0]] = NAN;
    balloon_steps( &flight, 1 );
    assert_true( wisp_is_halted( flight.world, flight.entity ) );
    assert_true( balloon_hash( &flight ) == before );
    assert_int_equal( wisp_resume( flight.world, flight.entity ), WISP_OK );
    balloon_steps( &flight, 5 );
    wisp_balloon_stats f = balloon_read( &flight );
    assert_true( balloon_is_finite( &flight ) && isfinite( f.volume ) && isfinite( f.target_volume ) );
}

// ---- refusals ----

static void expect_message( wisp_world* world, wisp_status actual, const char* message )
{
    assert_int_equal( actual, WISP_BAD_INPUT );
    assert_string_equal( wisp_world_message( world ), message );
}

static void refuse_mesh( const balloon_mesh* mesh, bool allow_open, const char* message )
{
    balloon_scene scene = balloon_scene_of( mesh );
    scene.def.allow_open = allow_open;
    SCOPED( destroy_local ) wisp_world* world = balloon_world_create( &scene );
    wisp_entity entity = balloon_surface_add( world, &scene );
    uint64_t hash = wisp_world_hash( world );
    expect_message( world, wisp_set_balloon( world, entity, &scene.def ), message );
    assert_true( wisp_world_hash( world ) == hash );
}

TEST( an_open_mesh_without_leave_is_refused_with_its_first_open_edge )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh;
    assert_true( balloon_mesh_cube( &mesh, 1.0 ) );
    // the last triangle is removed: its first edge in the user's order is that of the first neighbour
    const int* gone = mesh.triangles + 33;
    int from = -1, to = -1;
    for ( int n = 0; n < 33 && from < 0; ++n )
    {
        int a = mesh.triangles[n], b = mesh.triangles[n - n % 3 + ( n + 1 ) % 3];
        for ( int k = 0; k < 3; ++k )
        {
            if ( gone[k] == b && gone[( k + 1 ) % 3] == a )
            {
                from = a;
                to = b;
            }
        }
    }
    mesh.triangle_count = 11;
    char message[256];
    snprintf( message, sizeof message,
              "balloon: got 3 open edges, the first from vertex %d to vertex %d, expected a closed mesh; "
              "allow_open closes holes",
              from, to );
    refuse_mesh( &mesh, false, message );
}

TEST( holes_that_meet_at_a_vertex_are_refused )
{
    balloon_mesh sphere = balloon_sphere( 1, 0.15 ), mesh = { sphere.vertex_count, 0, sphere.positions, NULL };
    mesh.triangles = checked_calloc( 3 * (size_t)sphere.triangle_count, sizeof( int ) );
    // every other triangle around vertex 0: five or six triangles leave at least two holes that meet there
    int around = 0, left_out = 0;
    int taken[2][2] = { { -1, -1 }, { -1, -1 } };
    for ( int t = 0; t < sphere.triangle_count; ++t )
    {
        const int* corner = sphere.triangles + 3 * t;
        int at = corner[0] == 0 ? 0 : corner[1] == 0 ? 1 : corner[2] == 0 ? 2 : -1;
        int a = at >= 0 ? corner[( at + 1 ) % 3] : -1, b = at >= 0 ? corner[( at + 2 ) % 3] : -1;
        bool apart = a != taken[0][0] && a != taken[0][1] && b != taken[0][0] && b != taken[0][1];
        around += at >= 0 ? 1 : 0;
        if ( at >= 0 && left_out < 2 && apart )
        {
            taken[left_out][0] = a;
            taken[left_out++][1] = b;
            continue;
        }
        memcpy( mesh.triangles + 3 * mesh.triangle_count++, corner, 3 * sizeof( int ) );
    }
    assert_true( around >= 5 && left_out == 2 );
    refuse_mesh( &mesh, true, "balloon: got 4 open edges at vertex 0, expected two at each vertex of a hole" );
    free( mesh.triangles );
    balloon_mesh_destroy( &sphere );
}

TEST( a_sheet_encloses_nothing )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh;
    assert_true( balloon_mesh_two_triangles( &mesh, 1.0 ) );
    refuse_mesh(
        &mesh, true,
        "balloon: got an enclosed volume of 0 m^3, expected triangles that are counter-clockwise seen from outside" );
}

TEST( an_open_balloon_cannot_become_one_that_must_be_closed )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = pear_with_two_holes( 1 );
    balloon_scene scene = open_scene( &mesh );
    SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
    balloon_steps( &flight, 1 );
    uint64_t hash = wisp_world_hash( flight.world );
    wisp_balloon_def def = scene.def;
    def.allow_open = false;
    assert_int_equal( wisp_set_balloon( flight.world, flight.entity, &def ), WISP_BAD_INPUT );
    assert_one_message( wisp_world_message( flight.world ) );
    assert_true( wisp_world_hash( flight.world ) == hash );
    def.allow_open = true;
    assert_int_equal( wisp_set_balloon( flight.world, flight.entity, &def ), WISP_OK );
    balloon_steps( &flight, 1 );
}
