// Contact that acts on the boundary particles of a surface: it reads the layer of a surface that has one, and pushes the parents of
// a point by their weights.
#include "saved_world.h"
#include "contact_fixture.h"

#include "boundary.h"
#include "boundary_oracle_fixture.h"

static const float DT = 0.01f, THICK = 0.05f, NO_PARTICLES = 10.0f; // s, m, m

static void open_layers( hosted* h, int workers, float particle_spacing )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_contact_module, &wisp_boundary_module };
    *h = ( hosted ){ 0 };
    h->def = hosted_def( h );
    h->def.modules = MODULES;
    h->def.module_count = WISP_COUNT( MODULES );
    h->def.substeps = h->def.iterations = 1;
    h->def.workers = workers;
    assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.primitives = WISP_CONTACT_PARTICLES;
    settings.particle_spacing = particle_spacing;
    assert_status( h->world, wisp_set_contact_settings( h->world, &settings ), WISP_OK );
}

static void set_layer( wisp_world* world, wisp_entity e, float spacing )
{
    wisp_boundary_def def = wisp_default_boundary_def();
    def.spacing = spacing;
    assert_status( world, wisp_set_boundary( world, e, &def ), WISP_OK );
}

static int layer_points( wisp_world* world, wisp_entity e )
{
    wisp_boundary_stats stats;
    assert_status( world, wisp_read_boundary_stats( world, e, &stats ), WISP_OK );
    return stats.points;
}

static wisp_contact_def contact_alone( void )
{
    wisp_contact_def def = contact_of( THICK );
    def.max_push_out_speed = 1e-9f;
    def.self = false;
    return def;
}

// ---- a point on a plane ----

static const wisp_vec3 FALLING[3] = { { -0.4f, 1.0f, 0.0f }, { 0.6f, 1.0f, 0.0f }, { 0.2f, 1.0f, 1.1f } };
static const float LAYER_SPACING = 0.25f;

// A triangle that falls, level, and the tip of a needle below one of its boundary points.
typedef struct touch
{
    hosted h;
    wisp_entity body[2];
    double3 predicted[4], after[4]; // of the corners and of the tip
    double w[4];
    double momentum; // along y, before the step
} touch;

static void read_touch( touch* t, double3 out[4] )
{
    for ( int i = 0; i < 4; ++i )
    {
        out[i] = double3_from( place_of( t->h.world, t->body[i / 3], i % 3 ) );
    }
}

static void run_touch( touch* t, double3 at, int number, bool has_layer, bool is_fixed )
{
    *t = ( touch ){ 0 };
    open_layers( &t->h, 1, NO_PARTICLES );
    test_mesh falling = triangle_mesh( FALLING[0], FALLING[1], FALLING[2] );
    const float x = (float)at.x, y = (float)at.y - 0.06f, z = (float)at.z;
    test_mesh needle = triangle_mesh( ( wisp_vec3 ){ x, y, z }, ( wisp_vec3 ){ x - 0.02f, y - 0.5f, z - 0.01f },
                                      ( wisp_vec3 ){ x + 0.02f, y - 0.5f, z - 0.01f } );
    t->body[0] = add_mesh( t->h.world, &falling, NULL, 0, 0.2f );
    t->body[1] = is_fixed ? add_pinned( t->h.world, &needle ) : add_mesh( t->h.world, &needle, NULL, 0, 20.0f );
    const wisp_contact_def def = contact_alone();
    for ( int k = 0; k < 2; ++k )
    {
        set_contact( t->h.world, t->body[k], &def );
    }
    if ( has_layer )
    {
        set_layer( t->h.world, t->body[0], LAYER_SPACING );
    }
    read_touch( t, t->predicted );
    for ( int i = 0; i < 4; ++i )
    {
        float* velocity = velocity_of( t->h.world, t->body[i / 3], i % 3 );
        velocity[1] = i < 3 ? test_random_float( number, i, -4.0f, -2.0f ) : is_fixed ? 0.0f : 1.0f;
        t->w[i] = (double)place_of( t->h.world, t->body[i / 3], i % 3 )[3];
        t->predicted[i].y += (double)( velocity[1] * DT );
        t->momentum += t->w[i] > 0.0 ? (double)velocity[1] / t->w[i] : 0.0;
    }
    request_stats( t->h.world );
    run_steps( t->h.world, 1, DT );
    read_touch( t, t->after );
}

static double largest_move( const touch* t )
{
    double most = 0.0;
    for ( int i = 0; i < 4; ++i )
    {
        most = fmax( most, double3_distance( t->after[i], t->predicted[i] ) );
    }
    return most;
}

// The oracle knows where the points of the layer are, and what a point does on a plane. Both sides start from floats near 1 m and
// add a few: 5e-7 m.
static void assert_pushed( const touch* t, const double weight[3], bool is_fixed )
{
    double3 x[3] = { t->predicted[0], t->predicted[1], t->predicted[2] };
    const double3 up = { 0.0, 1.0, 0.0 };
    double plane_move = 0.0;
    assert_true(
        boundary_oracle_contact( 3, x, t->w, weight, up, t->predicted[3].y + (double)THICK, t->w[3], &plane_move ) );
    assert_true( is_fixed == ( plane_move == 0.0 ) );
    for ( int i = 0; i < 3; ++i )
    {
        assert_close( double3_distance( x[i], t->after[i] ), 0.0, 5e-7 );
    }
    assert_close( t->after[3].y - t->predicted[3].y, plane_move, 5e-7 );
    assert_true( largest_move( t ) > 5e-3 );
}

TEST( a_point_of_a_layer_moves_its_parents_by_their_weights_off_a_plane )
{
    const double3 corner[3] = { double3_widen( FALLING[0] ), double3_widen( FALLING[1] ),
                                double3_widen( FALLING[2] ) };
    balloon_mesh mesh = one_triangle( corner[0], corner[1], corner[2] );
    const boundary_oracle_options options = { .spacing = (double)LAYER_SPACING, .cap = 1e6 };
    boundary_oracle_layer layer = layer_on( &mesh, &options );
    assert_true( layer.edge_point_count == 10 && inner_points( &layer ) == 3 );
    for ( int n = 0; n < 2 * layer.point_count; ++n )
    {
        const boundary_oracle_point* p = layer.points + n / 2;
        const bool is_fixed = n % 2 == 0;
        double weight[3] = { 0.0, 0.0, 0.0 };
        for ( int k = 0; k < 3; ++k )
        {
            weight[p->parent[k]] += p->weight[k];
        }
        touch t;
        run_touch( &t, p->y, n, true, is_fixed );
        assert_int_equal( contact_stats( t.h.world ).points, 6 + layer.point_count );
        assert_int_equal( contact_stats( t.h.world ).contacts, 1 );
        assert_pushed( &t, weight, is_fixed );
        if ( is_fixed == false )
        {
            double momentum[3];
            momentum_of( t.h.world, t.body, 2, momentum );
            // a rounding of positions (6e-8 m) over the step, times 0.3 kg
            assert_close( momentum[1], t.momentum, 1e-5 );
        }
        close_world( &t.h );
        // without its layer there is no point here, and the tip passes
        run_touch( &t, p->y, n, false, is_fixed );
        assert_int_equal( contact_stats( t.h.world ).points, 6 );
        assert_true( largest_move( &t ) < 5e-7 );
        close_world( &t.h );
    }
    boundary_oracle_destroy( &layer );
    balloon_mesh_destroy( &mesh );
}

// ---- a layer that changes ----

// A sheet that is torn about over a pinned one; its edges stretch, so its points change from step to step.
typedef struct stretching
{
    hosted h;
    wisp_entity sheet;
} stretching;

static void open_stretching( stretching* s, int workers )
{
    open_layers( &s->h, workers, 0.1f );
    test_mesh floor = level_sheet( 5, 1.2f, ( wisp_vec3 ){ 0 } ),
              above = level_sheet( 7, 1.0f, ( wisp_vec3 ){ 0.02f, 0.06f, 0.01f } );
    const wisp_entity pinned = add_pinned( s->h.world, &floor );
    s->sheet = add_draping( s->h.world, &above, NULL, 0, EARTH );
    wisp_cloth_def soft = wisp_default_cloth_def();
    soft.warp_compliance = soft.weft_compliance = soft.shear_compliance = 0.05f;
    assert_status( s->h.world, wisp_set_cloth( s->h.world, s->sheet, &soft ), WISP_OK );
    const wisp_contact_def def = contact_alone();
    set_contact( s->h.world, pinned, &def );
    set_contact( s->h.world, s->sheet, &def );
    set_layer( s->h.world, s->sheet, 0.03f );
    for ( int v = 0; v < 49; ++v )
    {
        float* velocity = velocity_of( s->h.world, s->sheet, v );
        velocity[0] = test_random_float( 5, v, -3.0f, 3.0f );
        velocity[2] = test_random_float( 6, v, -3.0f, 3.0f );
    }
    request_stats( s->h.world );
}

static uint64_t hash_after( stretching* s, int steps )
{
    run_steps( s->h.world, steps, DT );
    return wisp_world_hash( s->h.world );
}

TEST( contact_follows_a_layer_whose_points_change )
{
    stretching s;
    open_stretching( &s, 1 );
    run_steps( s.h.world, 1, DT );
    const int others = contact_stats( s.h.world ).points;
    int changes = 0, contacts = 0, before = layer_points( s.h.world, s.sheet ), first = 0;
    for ( int step = 0; step < 40; ++step )
    {
        const int points = layer_points( s.h.world, s.sheet );
        run_steps( s.h.world, 1, DT );
        // contact has the points of the start of the step, and those of the other sheet beside them
        const int rest = contact_stats( s.h.world ).points - points;
        first = step == 0 ? rest : first;
        assert_int_equal( rest, first );
        changes += points != before ? 1 : 0;
        contacts += contact_stats( s.h.world ).contacts;
        before = points;
    }
    print_message( "%d changes of the number of points, %d contacts\n", changes, contacts );
    assert_true( first > 25 + 49 && others > first && changes > 5 && contacts > 100 );
    close_world( &s.h );
}

TEST( workers_and_a_restore_do_not_change_a_bit )
{
    stretching s;
    open_stretching( &s, 1 );
    run_steps( s.h.world, 12, DT );
    const saved_world saved = save_world( s.h.world );
    const uint64_t expected = hash_after( &s, 12 );
    run_steps( s.h.world, 5, DT );
    assert_int_equal( wisp_world_restore( s.h.world, saved.bytes, saved.size ), WISP_OK );
    assert_true( hash_after( &s, 12 ) == expected );
    close_world( &s.h );
    for ( int workers = 2; workers <= 5; workers += 3 )
    {
        open_stretching( &s, workers );
        assert_true( hash_after( &s, 24 ) == expected );
        close_world( &s.h );
    }
    // another world that never had the layer of those steps
    open_stretching( &s, 1 );
    run_steps( s.h.world, 1, DT );
    assert_int_equal( wisp_world_restore( s.h.world, saved.bytes, saved.size ), WISP_OK );
    assert_true( hash_after( &s, 12 ) == expected );
    free( saved.bytes );
    close_world( &s.h );
}

// With primitives nobody reads the layer in the substeps.
TEST( a_layer_is_shared_only_where_particles_are_in_contact )
{
    stretching s;
    open_stretching( &s, 1 );
    const int passes = wisp_world_plan_passes( s.h.world );
    wisp_contact_settings settings = wisp_default_contact_settings();
    assert_status( s.h.world, wisp_set_contact_settings( s.h.world, &settings ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( s.h.world ), passes - 1 );
    settings.primitives = WISP_CONTACT_PARTICLES;
    assert_status( s.h.world, wisp_set_contact_settings( s.h.world, &settings ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( s.h.world ), passes );
    run_steps( s.h.world, 2, DT );
    const int with = contact_stats( s.h.world ).points;
    // without the layer, contact has particles of its own again
    assert_status( s.h.world, wisp_unset_boundary( s.h.world, s.sheet ), WISP_OK );
    run_steps( s.h.world, 2, DT );
    assert_true( contact_stats( s.h.world ).points < with );
    set_layer( s.h.world, s.sheet, 0.03f );
    assert_status( s.h.world, wisp_unset_contact( s.h.world, s.sheet ), WISP_OK );
    run_steps( s.h.world, 1, DT );
    assert_int_equal( wisp_world_plan_passes( s.h.world ), passes - 1 );
    close_world( &s.h );
}

// ---- particles that contact makes itself ----

// Six vertices, two of them 1.2 m apart and all others closer than a spacing.
static test_mesh four_triangles( const int32_t triangles[12], int a, int b, float away )
{
    static const wisp_vec3 MIDDLE[4] = {
        { 0.55f, 0.0f, -0.2f }, { 0.65f, 0.0f, -0.1f }, { 0.6f, 0.0f, 0.1f }, { 0.62f, 0.0f, 0.2f }
    };
    test_mesh m = { calloc( 6, sizeof( wisp_vec3 ) ), calloc( 12, sizeof( int32_t ) ), 6, 4 };
    assert_true( m.points != NULL && m.triangles != NULL );
    for ( int v = 0, next = 0; v < 6; ++v )
    {
        const wisp_vec3 p = v == a ? ( wisp_vec3 ){ 0 } : v == b ? ( wisp_vec3 ){ 1.2f, 0.0f, 0.0f } : MIDDLE[next++];
        m.points[v] = ( wisp_vec3 ){ p.x + away, p.y, p.z };
    }
    memcpy( m.triangles, triangles, 12 * sizeof( int32_t ) );
    return m;
}

// A fan and a strip have as many edges and triangles. The only point of the strip is on its long edge, whichever that is; the fan,
// which is sampled before it, has none on an edge of that number.
TEST( each_fabric_has_the_particles_of_its_own_elements )
{
    static const int32_t FAN[12] = { 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5 };
    static const int32_t STRIP[12] = { 0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4 };
    static const int EDGES[9][2] = { { 0, 1 }, { 0, 2 }, { 1, 2 }, { 1, 3 }, { 2, 3 },
                                     { 2, 4 }, { 3, 4 }, { 3, 5 }, { 4, 5 } };
    for ( int n = 0; n < 9; ++n )
    {
        hosted h;
        open_layers( &h, 1, 0.7f );
        const wisp_contact_def def = contact_alone();
        // the fan's vertices 1 and 4 are no edge
        test_mesh fan = four_triangles( FAN, 1, 4, 3.0f ),
                  strip = four_triangles( STRIP, EDGES[n][0], EDGES[n][1], 0.0f );
        const wisp_entity e[2] = { add_pinned( h.world, &fan ), add_pinned( h.world, &strip ) };
        // a vertex falls on the middle of the long edge
        test_mesh needle = triangle_mesh( ( wisp_vec3 ){ 0.6f, 0.06f, 0.0f }, ( wisp_vec3 ){ 0.58f, 0.6f, 0.0f },
                                          ( wisp_vec3 ){ 0.62f, 0.6f, 0.0f } );
        const wisp_entity falling = add_mesh( h.world, &needle, NULL, 0, 0.2f );
        set_contact( h.world, e[0], &def );
        set_contact( h.world, e[1], &def );
        set_contact( h.world, falling, &def );
        velocity_of( h.world, falling, 0 )[1] = -4.0f;
        run_steps( h.world, 1, DT );
        assert_close( (double)place_of( h.world, falling, 0 )[1], (double)THICK, 1e-6 );
        close_world( &h );
    }
}
