// Contact that acts on the boundary particles of a surface: it reads the layer of a surface that has one, and pushes the
// parents of a point by their weights. The margin of the search changes the time and not one bit; and boundary particles
// as contact primitives: their contact, and what passes between them.
#include "boundary_oracle_fixture.h"
#include "contact_fixture.h"

#include "boundary.h"
#include "contact_state.h"
#include "oracle/contact_oracle.h"

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
    SET( world, e, boundary, d.spacing = spacing );
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
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = one_triangle( corner[0], corner[1], corner[2] );
    const boundary_oracle_options options = { .spacing = (double)LAYER_SPACING, .cap = 1e6 };
    SCOPED( boundary_oracle_destroy ) boundary_oracle_layer layer = layer_on( &mesh, &options );
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
    SET( s->h.world, s->sheet, cloth, d.warp_compliance = d.weft_compliance = d.shear_compliance = 0.05f );
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
        SCOPED( close_world ) hosted h;
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
    }
}

// ---- the search ----

typedef struct scene_counts
{
    int candidates; // at the end
    int searches;
} scene_counts;

// A cloth that falls on a balloon on a sheet, so that there are points of all kinds.
static void add_heap( wisp_world* world )
{
    test_mesh ball = ball_of( 2, 0.1f, ( wisp_vec3 ){ 0.01f, 0.12f, 0.02f } ),
              double_sided = level_sheet( 7, 0.5f, ( wisp_vec3 ){ 0 } ),
              cloth = level_sheet( 11, 0.4f, ( wisp_vec3 ){ 0.0f, 0.26f, 0.0f } );
    const wisp_entity e[3] = { add_pinned( world, &double_sided ), add_balloon( world, &ball, EARTH ),
                               add_draping( world, &cloth, NULL, 0, EARTH ) };
    const wisp_contact_def def = wisp_default_contact_def();
    for ( int i = 0; i < 3; ++i )
    {
        set_contact( world, e[i], &def );
    }
    request_stats( world );
}

// @return the hash of all state
static uint64_t run_scene( wisp_contact_primitives primitives, float margin, scene_counts* counts )
{
    SCOPED( close_world ) hosted h;
    *counts = ( scene_counts ){ 0 };
    open_contact( &h, 8, 1, 1 );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.primitives = primitives;
    settings.margin = margin;
    settings.particle_spacing = 0.02f;
    assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
    add_heap( h.world );
    for ( int step = 0; step < 30; ++step )
    {
        run_steps( h.world, 1, FRAME );
        const wisp_contact_stats f = contact_stats( h.world );
        counts->candidates = (int)f.candidates;
        counts->searches += f.searches;
    }
    assert_true( contact_stats( h.world ).contacts > 0 );
    return wisp_world_hash( h.world );
}

TEST( how_far_pairs_are_looked_for_does_not_change_a_bit )
{
    static const float MARGINS[] = { 0.05f, 0.3f, 1.0f, 6.0f, 30.0f };
    for ( int primitives = 0; primitives < WISP_CONTACT_PRIMITIVES_COUNT; ++primitives )
    {
        uint64_t first = 0;
        scene_counts counts[WISP_COUNT( MARGINS )];
        for ( int i = 0; i < WISP_COUNT( MARGINS ); ++i )
        {
            const uint64_t hash = run_scene( (wisp_contact_primitives)primitives, MARGINS[i], counts + i );
            first = i == 0 ? hash : first;
            assert_true( hash == first );
        }
        // and it does change the candidates: far more pairs, far less often
        assert_true( counts[4].candidates > 2 * counts[0].candidates );
        assert_true( counts[4].searches < counts[0].searches );
    }
}

// A soft cloth that falls over a rotating ball and winds around it. @return the ball
static wisp_entity add_folding( wisp_world* world )
{
    test_mesh mesh = level_sheet( 48, 1.0f, ( wisp_vec3 ){ 0.0f, 0.6f, 0.0f } );
    const wisp_entity e = add_draping( world, &mesh, NULL, 0, EARTH );
    SET( world, e, cloth, d.bend_compliance = 0.5f, d.internal_damping = 1.0f );
    wisp_collider_def ball = wisp_default_collider_def();
    ball.kind = WISP_COLLIDER_SPHERE;
    ball.radius = 0.15f;
    ball.pose.translation = ( wisp_vec3 ){ 0.045f, 0.3f, 0.015f };
    wisp_entity body;
    assert_status( world, wisp_add_collider( world, &ball, &body ), WISP_OK );
    add_floor( world, ( wisp_vec3 ){ 0 }, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    set_collision( world, e );
    const wisp_contact_def def = wisp_default_contact_def();
    set_contact( world, e, &def );
    assert_status( world, wisp_request_contact_stats( world, true, false ), WISP_OK );
    return body;
}

static void swing( wisp_world* world, wisp_entity ball, float t )
{
    wisp_transform pose = wisp_default_collider_def().pose;
    pose.translation =
        ( wisp_vec3 ){ 0.15f * ( 0.3f + sinf( 3.0f * t ) ), 0.3f, 0.15f * ( 0.1f + sinf( 2.0f * t ) ) };
    assert_status( world, wisp_move_collider( world, ball, pose ), WISP_OK );
}

// Cached bounds of clusters do not hold where a snapshot puts points elsewhere, so all pairs are tested
// again. A scene that is restored into another world in every substep, from one substep on, must continue as one with cached
// bounds. The smaller the margin, the more pairs are new in a list.
static void check_remembered( bool folds, int steps, float seconds )
{
    SCOPED( close_world ) hosted h, other;
    hosted* const both[2] = { &h, &other };
    wisp_entity ball = { 0 }; // the same in both worlds
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.margin = 0.01f;
    for ( int w = 0; w < 2; ++w )
    {
        open_contact( both[w], 1, 1, 1 );
        assert_status( both[w]->world, wisp_set_contact_settings( both[w]->world, &settings ), WISP_OK );
        if ( folds )
        {
            ball = add_folding( both[w]->world );
            swing( both[w]->world, ball, 0.0f );
        }
        else
        {
            add_heap( both[w]->world );
        }
        run_steps( both[w]->world, 1, seconds );
    }
    const size_t size = wisp_world_snapshot_size( h.world );
    SCOPED( free_local ) void* bytes = checked_malloc( size );
    int contacts = 0, searches = 0;
    for ( int step = 0; step < steps; ++step )
    {
        assert_status( h.world, wisp_world_snapshot( h.world, bytes, size ), WISP_OK );
        run_steps( other.world, 1, seconds );
        assert_status( other.world, wisp_world_restore( other.world, bytes, size ), WISP_OK );
        for ( int w = 0; w < 2; ++w )
        {
            if ( folds )
            {
                swing( both[w]->world, ball, seconds * (float)( step + 1 ) );
            }
            run_steps( both[w]->world, 1, seconds );
        }
        assert_true( wisp_world_hash( h.world ) == wisp_world_hash( other.world ) );
        assert_true( contact_stats( other.world ).searches > 0 );
        searches += contact_stats( h.world ).searches > 0 ? 1 : 0;
        contacts += contact_stats( h.world ).contacts;
    }
    assert_true( contacts > steps && searches > 0 && 2 * searches < steps );
}

TEST( what_is_remembered_does_not_change_a_bit )
{
    check_remembered( false, 120, FRAME / 8.0f );
    check_remembered( true, 320, FRAME / 10.0f );
}

// ---- lists and owners against brute force ----

static double3 start_of( const contact_contact_mesh* s, int point )
{
    const float* p = s->intersection_free + (size_t)point * 4;
    return ( double3 ){ (double)p[0], (double)p[1], (double)p[2] };
}

// Return the distance of a point and a triangle, or of two edges; infinity if they share a point.
static double distance_between( const contact_contact_mesh* s, bool are_edges, int a, int b )
{
    const int32_t* first = are_edges ? s->edges + 2 * a : &a;
    const int32_t* second = are_edges ? s->edges + 2 * b : s->triangles + 3 * b;
    double3 x[2][3];
    for ( int i = 0; i < ( are_edges ? 2 : 1 ); ++i )
    {
        x[0][i] = start_of( s, first[i] );
        for ( int k = 0; k < ( are_edges ? 2 : 3 ); ++k )
        {
            x[1][k] = start_of( s, second[k] );
            if ( first[i] == second[k] )
            {
                return INFINITY;
            }
        }
    }
    return are_edges ? contact_oracle_segments( x[0], x[1] ).distance
                     : contact_oracle_point_triangle( x[0][0], x[1] ).distance;
}

// Return what the list of two clusters says of a pair: the least that its distance is above its gap.
static double listed_bound( const contact_contact_mesh* s, int pair, int kind, int a, int b, double* gap )
{
    const contact_list* list = s->bounds->pairs[0].list + pair;
    const int first = list->first + ( kind == CONTACT_EDGES ? list->points : 0 ),
              count = kind == CONTACT_EDGES ? list->edges : list->points;
    const double slack = (double)s->bounds->pairs[0].slack[pair];
    for ( int i = first; i < first + count; ++i )
    {
        const contact_listed* l = s->bounds->listed + i;
        if ( ( l->a == a && l->b == b ) || ( kind == CONTACT_EDGES && l->a == b && l->b == a ) )
        {
            *gap = (double)l->gap;
            return (double)l->key + slack;
        }
    }
    return slack;
}

// Check all primitives of two clusters. @return how many pairs were checked
static int check_list( const contact_contact_mesh* s, int pair, double whole_gap )
{
    static const int KINDS[3][2] = { { 1, 1 }, { 0, 2 }, { 2, 0 } };
    const int both[2] = { s->bounds->pairs[0].cluster[pair], s->bounds->pairs[0].other[pair] };
    const double gone = (double)contact_closing_of( s->motion->gone + both[0], s->motion->gone + both[1] );
    int count = 0;
    for ( int k = 0; k < 3; ++k )
    {
        const contact_cluster *a = s->clusters->items + both[0], *b = s->clusters->items + both[1];
        const contact_pack *p = s->clusters->packs + a->kind_row[KINDS[k][0]],
                           *q = s->clusters->packs + b->kind_row[KINDS[k][1]];
        for ( int n = 0; n < 64 * a->rows[KINDS[k][0]] * b->rows[KINDS[k][1]]; ++n )
        {
            const int i = p[n / 64 / b->rows[KINDS[k][1]]].item[n % 8],
                      j = q[n / 64 % b->rows[KINDS[k][1]]].item[n / 8 % 8];
            if ( i >= 0 && j >= 0 )
            {
                const int kind = k == 0 ? CONTACT_EDGES : CONTACT_POINTS, point = k == 2 ? j : i;
                double gap = whole_gap;
                const double bound = listed_bound( s, pair, kind, point, k == 2 ? i : j, &gap );
                assert_true( distance_between( s, k == 0, point, k == 2 ? i : j ) - gap > bound - gone - 1e-6 );
                count += 1;
            }
        }
    }
    return count;
}

// Bounds are those at the start of the last substep, in which clusters have approached since.
TEST( no_pair_is_nearer_than_its_list_says )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, 4, 1, 1 );
    const wisp_entity ball = add_folding( h.world );
    contact_state* found;
    assert_status( h.world, contact_find_state( h.world, &found ), WISP_OK );
    int count = 0, listed = 0;
    for ( int step = 0; step < 40; ++step )
    {
        swing( h.world, ball, FRAME * (float)step );
        run_steps( h.world, 1, FRAME );
        const contact_contact_mesh* s = &found->contact_mesh;
        for ( int pair = step % 8; pair < s->bounds->pairs[0].count && step > 20; pair += 8 )
        {
            count += check_list( s, pair, (double)found->participants[0].settings.thickness );
            listed += s->bounds->pairs[0].list[pair].points + s->bounds->pairs[0].list[pair].edges;
        }
    }
    assert_true( count > 100000 && listed > 1000 );
}

// Points of sheets that lie on one another, whose edges and corners meet in all ways, have one row each.
TEST( each_closest_point_has_one_row )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, 1, 1, 1 );
    for ( int i = 0; i < 2; ++i )
    {
        test_mesh mesh = level_sheet( 9, 0.2f, ( wisp_vec3 ){ 0.005f * (float)i, 0.0095f * (float)i, 0.0f } );
        const wisp_entity e = add_draping( h.world, &mesh, NULL, 0, ( wisp_vec3 ){ 0 } );
        wisp_contact_def def = contact_of( 0.01f );
        def.max_push_out_speed = 1e-9f; // m/s: nothing moves
        set_contact( h.world, e, &def );
    }
    run_steps( h.world, 1, FRAME );
    contact_state* found;
    assert_status( h.world, contact_find_state( h.world, &found ), WISP_OK );
    const contact_contact_mesh* s = &found->contact_mesh;
    const contact_participant* sheets = found->participants;
    int met = 0;
    for ( int p = 0; p < sheets[0].point_count; ++p )
    {
        double nearest = INFINITY;
        for ( int t = 0; t < sheets[1].triangle_count; ++t )
        {
            nearest = fmin( nearest, distance_between( s, false, p, sheets[1].first_triangle + t ) );
        }
        int rows = 0;
        for ( int r = 0; r < s->constraints->split; ++r )
        {
            const contact_row* row = s->constraints->rows + r;
            rows += row->point[0] == p && fabs( (double)row->distance - nearest ) < 1e-6 ? 1 : 0;
        }
        assert_true( rows == 1 || ( rows == 0 && nearest >= 0.01 ) );
        met += rows;
    }
    assert_true( met > 50 );
}

// Between a floor and a sheet that spins far above it, whose pair is listed from the start, another sheet descends
// slowly: its pair with the floor is new in a list, before the other.
TEST( a_pair_that_is_new_in_a_list_has_nothing_of_the_next )
{
    static const float TURN = 20.0f, FALL = 0.4f, SUBSTEP = 0.01f, GAP = 0.01f; // rad/s, m/s, s, m
    SCOPED( close_world ) hosted h;
    open_contact( &h, 1, 1, 1 );
    test_mesh floor = level_sheet( 3, 0.3f, ( wisp_vec3 ){ 0 } ),
              falling = level_sheet( 3, 0.2f, ( wisp_vec3 ){ 0.0f, 0.1f, 0.0f } ),
              spinning = level_sheet( 3, 0.2f, ( wisp_vec3 ){ 0.0f, 0.15f, 0.0f } );
    const wisp_vec3 none = { 0 };
    const wisp_entity e[3] = { add_pinned( h.world, &floor ), add_draping( h.world, &falling, NULL, 0, none ),
                               add_draping( h.world, &spinning, NULL, 0, none ) };
    const wisp_contact_def def = contact_of( GAP );
    for ( int i = 0; i < 3; ++i )
    {
        set_contact( h.world, e[i], &def );
    }
    for ( int v = 0; v < 9; ++v )
    {
        const float* p = place_of( h.world, e[2], v );
        float* turning = velocity_of( h.world, e[2], v );
        turning[0] = TURN * p[2];
        turning[2] = -TURN * p[0];
        velocity_of( h.world, e[1], v )[1] = -FALL;
    }
    run_steps( h.world, 50, SUBSTEP );
    assert_true( mean_of( h.world, e[1], 1 ) > 0.99 * (double)GAP );
}

// ---- boundary particles ----

static const float SHEET_THICKNESS = 0.125f; // m

typedef struct six
{
    hosted h;
    wisp_entity body[2];
    double3 before[6], predicted[6], after[6];
    double w[6];
} six;

static void read_places( six* s, double3* out )
{
    for ( int i = 0; i < 6; ++i )
    {
        const float* at = place_of( s->h.world, s->body[i / 3], i % 3 );
        out[i] = double3_make( (double)at[0], (double)at[1], (double)at[2] );
    }
}

// Two triangles, one rotated and above the other, approach each other.
static void open_six( six* s, int n )
{
    *s = ( six ){ 0 };
    open_contact( &s->h, 1, 1, 1 );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.primitives = WISP_CONTACT_PARTICLES;
    settings.particle_spacing = 0.2f;
    assert_status( s->h.world, wisp_set_contact_settings( s->h.world, &settings ), WISP_OK );
    for ( int k = 0; k < 2; ++k )
    {
        wisp_vec3 p[3];
        for ( int v = 0; v < 3; ++v )
        {
            const float angle = 2.0944f * (float)v + test_random_float( n, 10 * k + v, -0.4f, 0.4f ) + (float)k;
            p[v] = ( wisp_vec3 ){ 0.5f * cosf( angle ) + test_random_float( n, 30 + k, -0.1f, 0.1f ),
                                  k == 0 ? SHEET_THICKNESS * test_random_float( n, 40 + v, 1.1f, 1.3f ) : 0.0f,
                                  0.5f * sinf( angle ) + test_random_float( n, 50 + k, -0.1f, 0.1f ) };
        }
        test_mesh mesh = triangle_mesh( p[0], p[1], p[2] );
        s->body[k] = add_mesh( s->h.world, &mesh, NULL, 0, k == 0 ? 0.2f : 0.5f );
        wisp_contact_def def = contact_of( SHEET_THICKNESS );
        def.max_push_out_speed = 1e-9f; // contact alone
        set_contact( s->h.world, s->body[k], &def );
    }
    request_stats( s->h.world );
    read_places( s, s->before );
    for ( int i = 0; i < 6; ++i )
    {
        float* velocity = velocity_of( s->h.world, s->body[i / 3], i % 3 );
        velocity[1] = test_random_float( n, 60 + i, 0.0f, 4.0f ) * ( i < 3 ? -1.0f : 1.0f );
        s->w[i] = (double)place_of( s->h.world, s->body[i / 3], i % 3 )[3];
        s->predicted[i] = double3_add( s->before[i], double3_make( 0.0, (double)( velocity[1] * DT ), 0.0 ) );
    }
    run_steps( s->h.world, 1, DT );
    read_places( s, s->after );
}

// Displacements give the weights: a parent moves by its own weight times its inverse mass. With these weights, the
// oracle must push as far, along the line between the two points at their initial positions.
static bool check_six( const six* s )
{
    contact_oracle_contact c = { .a = { .count = 3, .vertex = { 0, 1, 2 } },
                                 .b = { .count = 3, .vertex = { 3, 4, 5 } },
                                 .gap = (double)SHEET_THICKNESS };
    double3 sums[2] = { { 0 } }, ways[6];
    for ( int i = 0; i < 6; ++i )
    {
        ways[i] = double3_scale( 1.0 / s->w[i], double3_sub( s->after[i], s->predicted[i] ) );
        sums[i / 3] = double3_add( sums[i / 3], ways[i] );
    }
    const double length = double3_length( sums[0] );
    // of a push of a millimetre, known to six digits
    assert_near( double3_length( double3_add( sums[0], sums[1] ) ), 0.0, 1e-6 * fmax( length, 1.0 ) );
    if ( length * s->w[0] < 1e-3 )
    {
        return false;
    }
    c.normal = double3_scale( 1.0 / length, sums[0] );
    for ( int i = 0; i < 3; ++i )
    {
        c.a.weight[i] = double3_dot( ways[i], c.normal ) / length;
        c.b.weight[i] = -double3_dot( ways[3 + i], c.normal ) / length;
        assert_true( c.a.weight[i] > -1e-3 && c.b.weight[i] > -1e-3 );
    }
    const double3 between =
        double3_sub( contact_oracle_point_of( &c.a, s->before ), contact_oracle_point_of( &c.b, s->before ) );
    const double distance = double3_length( between );
    assert_near( double3_distance( double3_scale( 1.0 / distance, between ), c.normal ), 0.0, 0.02 );
    c.gap = fmin( c.gap, distance );
    double3 x[6];
    memcpy( x, s->predicted, sizeof( x ) );
    contact_oracle_push( &c, s->w, x );
    for ( int i = 0; i < 6; ++i )
    {
        // weights come from displacements of millimetres, known to 1e-7 m
        assert_near( double3_distance( x[i], s->after[i] ), 0.0, 2e-5 );
    }
    return c.a.weight[0] > 0.05 && c.a.weight[1] > 0.05 && c.a.weight[2] > 0.05;
}

TEST( a_boundary_particle_moves_its_parents_by_their_weights )
{
    int checked = 0, inner = 0;
    for ( int n = 0; n < 250; ++n )
    {
        six s;
        open_six( &s, n );
        double momentum[3];
        momentum_of( s.h.world, s.body, 2, momentum );
        double expected = 0.0;
        for ( int i = 0; i < 6; ++i )
        {
            expected += ( s.predicted[i].y - s.before[i].y ) / ( s.w[i] * (double)DT );
        }
        // a rounding of positions (6e-8 m) over the step, times 0.3 kg
        assert_near( momentum[1], expected, 1e-5 );
        assert_near( momentum[0], 0.0, 1e-5 );
        if ( contact_stats( s.h.world ).contacts == 1 )
        {
            checked += 1;
            inner += check_six( &s ) ? 1 : 0;
        }
        close_world( &s.h );
    }
    assert_true( checked > 30 && inner > 3 );
}

// A needle falls on a sheet: it passes between particles whose spacing is that of its edges, but not where they are
// closer.
static bool needle_passes( wisp_contact_primitives primitives, float spacing )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, 4, 1, 1 );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.primitives = primitives;
    settings.particle_spacing = spacing;
    assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
    test_mesh double_sided = level_sheet( 3, 1.0f, ( wisp_vec3 ){ 0 } ),
              needle = triangle_mesh( ( wisp_vec3 ){ 0.13f, 0.03f, 0.31f }, ( wisp_vec3 ){ 0.14f, 0.13f, 0.31f },
                                      ( wisp_vec3 ){ 0.13f, 0.13f, 0.32f } );
    const wisp_entity a = add_pinned( h.world, &double_sided ), b = add_draping( h.world, &needle, NULL, 0, EARTH );
    const wisp_contact_def def = contact_of( 0.02f );
    set_contact( h.world, a, &def );
    set_contact( h.world, b, &def );
    request_stats( h.world );
    run_steps( h.world, 30, DT );
    assert_int_equal( contact_stats( h.world ).participants, 2 );
    return mean_of( h.world, b, 1 ) < 0.0;
}

TEST( what_is_finer_than_the_spacing_passes )
{
    assert_true( needle_passes( WISP_CONTACT_PARTICLES, 0.5f ) );
    assert_false( needle_passes( WISP_CONTACT_PARTICLES, 0.01f ) );
    assert_false( needle_passes( WISP_CONTACT_TRIANGLES, 0.5f ) );
}

TEST( more_particles_stand_on_a_finer_spacing )
{
    int points[3];
    for ( int i = 0; i < 3; ++i )
    {
        SCOPED( close_world ) hosted h;
        open_contact( &h, 1, 1, 1 );
        wisp_contact_settings settings = wisp_default_contact_settings();
        settings.primitives = WISP_CONTACT_PARTICLES;
        settings.particle_spacing = i == 2 ? 0.0f : 0.1f / (float)( 1 + i ); // of the last: the thickness, 0.0125 m
        assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
        test_mesh double_sided = level_sheet( 3, 0.5f, ( wisp_vec3 ){ 0 } );
        const wisp_entity e = add_draping( h.world, &double_sided, NULL, 0, EARTH );
        const wisp_contact_def def = contact_of( 0.0125f );
        set_contact( h.world, e, &def );
        request_stats( h.world );
        run_steps( h.world, 1, DT );
        points[i] = contact_stats( h.world ).points;
    }
    assert_true( points[0] > 9 && points[1] > 2 * points[0] && points[2] > 2 * points[1] );
}

// A fast sheet has a large search margin. After it stops, the search runs once more with a smaller margin.
TEST( what_has_stopped_is_not_looked_for_far_around )
{
    static const float SPEED = 2.6f, GAP = 0.02f;             // m/s, m
    const float START = 0.12f + 8.0f * ( SPEED - 0.8f ) * DT; // m
    SCOPED( close_world ) hosted h;
    open_contact( &h, 1, 1, 1 );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.primitives = WISP_CONTACT_PARTICLES;
    settings.particle_spacing = GAP;
    settings.margin = 0.05f;
    assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
    test_mesh floor = level_sheet( 4, 0.5f, ( wisp_vec3 ){ 0 } ),
              falling = level_sheet( 4, 0.4f, ( wisp_vec3 ){ 0.01f, START, 0.02f } );
    const wisp_entity e[2] = { add_pinned( h.world, &floor ),
                               add_draping( h.world, &falling, NULL, 0, ( wisp_vec3 ){ 0 } ) };
    const wisp_contact_def def = contact_of( GAP );
    for ( int i = 0; i < 2; ++i )
    {
        set_contact( h.world, e[i], &def );
    }
    request_stats( h.world );
    int64_t candidates[2];
    int searches = 0;
    for ( int step = 0; step < 60; ++step )
    {
        for ( int v = 0; v < 16; ++v )
        {
            velocity_of( h.world, e[1], v )[1] = step < 8 ? -SPEED : 0.0f;
        }
        run_steps( h.world, 1, DT );
        candidates[step < 8 ? 0 : 1] = (int64_t)contact_stats( h.world ).candidates;
        searches += step < 8 ? 0 : contact_stats( h.world ).searches;
    }
    assert_near( mean_of( h.world, e[1], 1 ), (double)START - 8.0 * (double)( SPEED * DT ), 1e-5 );
    assert_true( candidates[0] > 1000 );
    assert_int_equal( candidates[1], 0 );
    assert_int_equal( searches, 1 );
}

// Candidates grow with the square of the search margin, and the search repeats as soon as it is used up.
TEST( fast_particles_have_few_candidates )
{
    enum
    {
        MAX_PER_PARTICLE = 50, // 27 are found; a margin of four substeps gives 217
    };
    SCOPED( close_world ) hosted h;
    open_contact( &h, 10, 1, 1 );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.primitives = WISP_CONTACT_PARTICLES;
    assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
    test_mesh floor = level_sheet( 4, 0.2f, ( wisp_vec3 ){ 0, -1.0f, 0 } ),
              turning = level_sheet( 6, 0.2f, ( wisp_vec3 ){ 0 } );
    const wisp_entity pinned = add_pinned( h.world, &floor ),
                      free = add_draping( h.world, &turning, NULL, 0, ( wisp_vec3 ){ 0 } );
    const wisp_contact_def def = contact_of( 0.004f );
    set_contact( h.world, pinned, &def );
    set_contact( h.world, free, &def );
    assert_status( h.world, wisp_set_velocity( h.world, free, ( wisp_vec3 ){ 4, 0, 0 }, ( wisp_vec3 ){ 0, 5, 0 } ),
                   WISP_OK );
    request_stats( h.world );
    for ( int step = 0; step < 10; ++step )
    {
        run_steps( h.world, 1, FRAME );
        const wisp_contact_stats stats = contact_stats( h.world );
        if ( stats.candidates > (int64_t)MAX_PER_PARTICLE * stats.points )
        {
            fail_msg( "%d candidates of %d particles", (int)stats.candidates, stats.points );
        }
    }
}
