// Levels of contact. Spheres: they stand for the layer of a surface that has one and push the parents of a point by their weights, no pair
// that is near is missed, momentum is kept. All levels: a change between steps. Exact contact: the margin of the search
// changes the time and not one bit.
#include "boundary_oracle_fixture.h"
#include "contact_fixture.h"

#include "boundary.h"
#include "contact_state.h"
#include "oracle/contact_oracle.h"

static const float DT = 0.01f, THICK = 0.3f; // s, m; above the spacing of the layer

static void set_level( wisp_world* world, wisp_contact_level level )
{
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.level = level;
    assert_status( world, wisp_set_contact_settings( world, &settings ), WISP_OK );
}

static void open_layers( hosted* h, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_contact_module, &wisp_boundary_module };
    OPEN( h, MODULES, .workers = workers );
    set_level( h->world, WISP_CONTACT_SPHERES );
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

static void run_touch( touch* t, double3 at, int number, bool is_fixed )
{
    *t = ( touch ){ 0 };
    open_layers( &t->h, 1 );
    test_mesh falling = triangle_mesh( FALLING[0], FALLING[1], FALLING[2] );
    const float x = (float)at.x, y = (float)at.y - THICK - 0.01f, z = (float)at.z;
    test_mesh needle = triangle_mesh( ( wisp_vec3 ){ x, y, z }, ( wisp_vec3 ){ x - 0.02f, y - 0.3f, z - 0.01f },
                                      ( wisp_vec3 ){ x + 0.02f, y - 0.3f, z - 0.01f } );
    t->body[0] = add_mesh( t->h.world, &falling, NULL, 0, 0.2f );
    t->body[1] = is_fixed ? add_pinned( t->h.world, &needle ) : add_mesh( t->h.world, &needle, NULL, 0, 20.0f );
    const wisp_contact_def def = contact_alone();
    for ( int k = 0; k < 2; ++k )
    {
        set_contact( t->h.world, t->body[k], &def );
    }
    set_layer( t->h.world, t->body[0], LAYER_SPACING );
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
        run_touch( &t, p->y, n, is_fixed );
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
    open_layers( &s->h, workers );
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
        velocity[0] = test_random_float( 5, v, -6.0f, 6.0f );
        velocity[2] = test_random_float( 6, v, -6.0f, 6.0f );
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
    assert_true( first == 25 + 49 && others > first && changes > 2 && contacts > 100 );
    close_world( &s.h );
}

// Otherwise nobody reads the layer in the substeps.
TEST( a_layer_is_shared_only_where_spheres_are_in_contact )
{
    stretching s;
    open_stretching( &s, 1 );
    const int passes = wisp_world_plan_passes( s.h.world );
    set_level( s.h.world, WISP_CONTACT_TRIANGLES );
    assert_int_equal( wisp_world_plan_passes( s.h.world ), passes - 1 );
    set_level( s.h.world, WISP_CONTACT_SPHERES );
    assert_int_equal( wisp_world_plan_passes( s.h.world ), passes );
    run_steps( s.h.world, 2, DT );
    const int with = contact_stats( s.h.world ).points;
    // without the layer, vertices are left
    assert_status( s.h.world, wisp_unset_boundary( s.h.world, s.sheet ), WISP_OK );
    run_steps( s.h.world, 2, DT );
    assert_true( contact_stats( s.h.world ).points < with );
    set_layer( s.h.world, s.sheet, 0.03f );
    assert_status( s.h.world, wisp_unset_contact( s.h.world, s.sheet ), WISP_OK );
    run_steps( s.h.world, 1, DT );
    assert_int_equal( wisp_world_plan_passes( s.h.world ), passes - 1 );
    close_world( &s.h );
}

// ---- the search ----

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

// @param counts out, at the end, with the searches of all steps @return the hash of all state
static uint64_t run_scene( float margin, wisp_contact_stats* counts )
{
    SCOPED( close_world ) hosted h;
    *counts = ( wisp_contact_stats ){ 0 };
    open_contact( &h, 8, 1, 1 );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.margin = margin;
    assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
    add_heap( h.world );
    for ( int step = 0; step < 30; ++step )
    {
        run_steps( h.world, 1, FRAME );
        const int before = counts->searches;
        *counts = contact_stats( h.world );
        counts->searches += before;
    }
    assert_true( counts->contacts > 0 );
    return wisp_world_hash( h.world );
}

TEST( how_far_pairs_are_looked_for_does_not_change_a_bit )
{
    static const float MARGINS[] = { 0.05f, 0.3f, 1.0f, 6.0f, 30.0f };
    uint64_t first = 0;
    wisp_contact_stats counts[WISP_COUNT( MARGINS )];
    for ( int i = 0; i < WISP_COUNT( MARGINS ); ++i )
    {
        const uint64_t hash = run_scene( MARGINS[i], counts + i );
        first = i == 0 ? hash : first;
        assert_true( hash == first );
    }
    // and it does change the candidates: far more pairs, far less often
    assert_true( counts[4].candidates > 2 * counts[0].candidates );
    assert_true( counts[4].searches < counts[0].searches );
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

// Return the closest points of a point and a triangle, or of two edges; infinitely far if they share a point.
static contact_oracle_closest closest_between( const contact_contact_mesh* s, const float* xyzw, bool are_edges,
                                               int a, int b )
{
    const int32_t* first = are_edges ? s->edges + 2 * a : &a;
    const int32_t* second = are_edges ? s->edges + 2 * b : s->triangles + 3 * b;
    double3 x[2][3];
    for ( int i = 0; i < ( are_edges ? 2 : 1 ); ++i )
    {
        x[0][i] = double3_from( xyzw + 4 * first[i] );
        for ( int k = 0; k < ( are_edges ? 2 : 3 ); ++k )
        {
            x[1][k] = double3_from( xyzw + 4 * second[k] );
            if ( first[i] == second[k] )
            {
                return ( contact_oracle_closest ){ .distance = INFINITY };
            }
        }
    }
    return are_edges ? contact_oracle_segments( x[0], x[1] ) : contact_oracle_point_triangle( x[0][0], x[1] );
}

static double distance_between( const contact_contact_mesh* s, bool are_edges, int a, int b )
{
    return closest_between( s, s->intersection_free, are_edges, a, b ).distance;
}

// Return what the list of two clusters says of a pair: the least that its distance is above its gap.
static double listed_bound( const contact_contact_mesh* s, int pair, int kind, int a, int b, double* gap )
{
    const contact_list* list = s->bounds->pairs.list + pair;
    const int first = list->first + ( kind == CONTACT_EDGES ? list->points : 0 ),
              count = kind == CONTACT_EDGES ? list->edges : list->points;
    const double slack = (double)s->bounds->pairs.slack[pair];
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
    const int both[2] = { s->bounds->pairs.cluster[pair], s->bounds->pairs.other[pair] };
    const double gone = (double)contact_closing_of( s->motion->gone + both[0], s->motion->gone + both[1] );
    int count = 0;
    for ( int k = 0; k < 3; ++k )
    {
        const contact_cluster *a = s->clusters->items + both[0], *b = s->clusters->items + both[1];
        int32_t( *p )[WISP_SLICE] = s->clusters->packs + a->kind_row[KINDS[k][0]];
        int32_t( *q )[WISP_SLICE] = s->clusters->packs + b->kind_row[KINDS[k][1]];
        for ( int n = 0; n < 64 * a->rows[KINDS[k][0]] * b->rows[KINDS[k][1]]; ++n )
        {
            const int i = p[n / 64 / b->rows[KINDS[k][1]] * contact_pack_rows( KINDS[k][0] )][n % 8],
                      j = q[n / 64 % b->rows[KINDS[k][1]] * contact_pack_rows( KINDS[k][1] )][n / 8 % 8];
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
    contact_state* found = wisp_world_module_state( h.world, "contact" );
    int count = 0, listed = 0;
    for ( int step = 0; step < 40; ++step )
    {
        swing( h.world, ball, FRAME * (float)step );
        run_steps( h.world, 1, FRAME );
        const contact_contact_mesh* s = &found->contact_mesh;
        for ( int pair = step % 8; pair < s->bounds->pairs.count && step > 20; pair += 8 )
        {
            count += check_list( s, pair, (double)found->participants[0].settings.thickness );
            listed += s->bounds->pairs.list[pair].points + s->bounds->pairs.list[pair].edges;
        }
    }
    assert_true( count > 100000 && listed > 1000 );
}

// Points of sheets that lie on one another, whose edges and corners meet in all ways, have one row each. Two more that start in one
// place are parted, and pairs are searched again: without them the search of a start holds.
TEST( each_closest_point_has_one_row )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, 1, 1, 1 );
    contact_state* found = wisp_world_module_state( h.world, "contact" );
    wisp_contact_def def = contact_of( 0.01f );
    def.max_push_out_speed = 1e-9f; // m/s: nothing moves
    for ( int i = 0; i < 4; ++i )
    {
        const wisp_vec3 place = { 0.005f * (float)( i % 2 ), 0.0095f * (float)i, 0.0f };
        test_mesh mesh = level_sheet( 9, 0.2f, i < 2 ? place : ( wisp_vec3 ){ 0.0f, 5.0f, 0.0f } );
        set_contact( h.world, add_draping( h.world, &mesh, NULL, 0, ( wisp_vec3 ){ 0 } ), &def );
        if ( i % 2 == 1 )
        {
            run_steps( h.world, 1, FRAME );
            assert_int_equal( found->contact_mesh.broad_phase->searches, i < 2 ? 1 : 2 );
        }
    }
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

// Return how far the sides of a pair are from each other at the end, along the normal at the start.
static double separation_of( const contact_contact_mesh* s, bool are_edges, int a, int b, double3 normal )
{
    const int32_t* sides[2] = { are_edges ? s->edges + 2 * a : &a,
                                are_edges ? s->edges + 2 * b : s->triangles + 3 * b };
    double front = INFINITY, back = -INFINITY;
    for ( int i = 0; i < 4; ++i )
    {
        const int split = are_edges ? 2 : 1;
        const float* p = s->now + (size_t)( i < split ? sides[0][i] : sides[1][i - split] ) * 4;
        const double at = double3_dot( normal, double3_from( p ) );
        front = i < split ? fmin( front, at ) : front;
        back = i < split ? back : fmax( back, at );
    }
    return front - back;
}

// Check all pairs of a kind. @param start [point][4] m, of the substep @return how many came near their plane
static int check_planes( const contact_contact_mesh* s, const float* start, bool are_edges, double gap )
{
    int near = 0;
    for ( int a = 0; a < ( are_edges ? s->edge_count : s->point_count ); ++a )
    {
        for ( int b = are_edges ? a + 1 : 0; b < ( are_edges ? s->edge_count : s->triangle_count ); ++b )
        {
            const contact_oracle_closest closest = closest_between( s, start, are_edges, a, b );
            if ( closest.distance == INFINITY )
            {
                continue;
            }
            const int of_a = are_edges ? s->edges[2 * a] : a,
                      of_b = are_edges ? s->edges[2 * b] : s->triangles[3 * b];
            const bool is_own = s->rest[4 * of_a + 3] == s->rest[4 * of_b + 3];
            const double most =
                is_own ? fmin( gap, 0.9 * closest_between( s, s->rest, are_edges, a, b ).distance ) : gap;
            const double least = fmin( 0.1 * most, 0.99 * closest.distance ),
                         end = separation_of( s, are_edges, a, b, closest.normal );
            assert_true( end > least - 1e-6 );
            near += end < 2.0 * least ? 1 : 0;
        }
    }
    return near;
}

// Sheets that would go through each other in a substep end on their sides of the planes between all of their primitives, and what
// one loses the other gets.
TEST( no_pair_passes_its_plane_and_momentum_is_kept )
{
    enum
    {
        SHEETS = 4,
        VERTICES = 7 * 7,
    };
    static const float GAP = 0.004f, FAST = 1.0f; // m, m/s
    SCOPED( close_world ) hosted h;
    open_contact( &h, 1, 1, 1 );
    wisp_entity e[SHEETS];
    const wisp_contact_def def = contact_of( GAP );
    for ( int i = 0; i < SHEETS; ++i )
    {
        const float height = 0.0044f * (float)i + ( i == SHEETS - 1 ? 0.03f : 0.0f );
        test_mesh sheet = level_sheet( 7, 0.2f, ( wisp_vec3 ){ 0.013f * (float)i, height, 0.003f * (float)i } );
        e[i] = add_draping( h.world, &sheet, NULL, 0, ( wisp_vec3 ){ 0 } );
        set_contact( h.world, e[i], &def );
    }
    request_stats( h.world );
    run_steps( h.world, 1, FRAME );
    for ( int v = 0; v < VERTICES; ++v )
    {
        velocity_of( h.world, e[SHEETS - 1], v )[1] = -FAST * ( 1.0f + 0.2f * (float)( v % 3 ) );
    }
    contact_state* found = wisp_world_module_state( h.world, "contact" );
    const contact_contact_mesh* s = &found->contact_mesh;
    assert_int_equal( s->point_count, SHEETS * VERTICES );
    run_steps( h.world, 1, FRAME ); // nothing touches yet
    double before[3], after[3];
    momentum_of( h.world, e, SHEETS, before );
    int limited = 0, near = 0;
    for ( int step = 0; step < 12; ++step )
    {
        float start[SHEETS * VERTICES * 4];
        memcpy( start, s->intersection_free, sizeof( start ) );
        run_steps( h.world, 1, FRAME );
        limited += contact_stats( h.world ).displacement_limited;
        near += check_planes( s, start, false, (double)GAP );
        near += check_planes( s, start, true, (double)GAP );
    }
    momentum_of( h.world, e, SHEETS, after );
    assert_true( limited > 0 && near > 0 );
    for ( int k = 0; k < 3; ++k )
    {
        assert_near( after[k], before[k], 1e-5 * fabs( before[1] ) );
    }
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

// ---- spheres ----

enum
{
    BODIES = 2,
};

// A sheet that falls on one that is wrinkled, both free, in a world of a level.
typedef struct meeting
{
    hosted h;
    wisp_entity body[BODIES];
    int vertices[BODIES];
} meeting;

static void open_meeting( meeting* m, wisp_contact_level level, float speed )
{
    *m = ( meeting ){ .vertices = { 13 * 13, 11 * 11 } };
    open_contact( &m->h, 10, 1, 1 );
    set_level( m->h.world, level );
    test_mesh lower = level_sheet( 13, 0.6f, ( wisp_vec3 ){ 0 } ),
              upper = level_sheet( 11, 0.4f, ( wisp_vec3 ){ 0.02f, 0.13f, 0.01f } );
    for ( int v = 0; v < lower.vertex_count; ++v )
    {
        lower.points[v].y += test_random_float( 3, v, -0.01f, 0.01f );
    }
    const wisp_vec3 none = { 0 };
    m->body[0] = add_draping( m->h.world, &lower, NULL, 0, none );
    m->body[1] = add_draping( m->h.world, &upper, NULL, 0, none );
    wisp_contact_def def = contact_of( 0.02f );
    def.friction = 0.4f;
    for ( int i = 0; i < BODIES; ++i )
    {
        set_contact( m->h.world, m->body[i], &def );
        assert_status( m->h.world,
                       wisp_set_velocity( m->h.world, m->body[i],
                                          ( wisp_vec3 ){ i == 0 ? 0.0f : 0.3f, i == 0 ? 0.0f : -speed, 0.0f }, none ),
                       WISP_OK );
    }
    request_stats( m->h.world );
}

enum
{
    VERTICES = 13 * 13 + 11 * 11,
};

// Find the smallest distance of two vertices over what they keep, in double. Vertices of one sheet that are neighbours at rest are no pair.
static double least_gap( const meeting* m, const double3 rest[VERTICES], const double keeps[VERTICES] )
{
    double3 now[VERTICES];
    double least = INFINITY;
    for ( int a = 0; a < VERTICES; ++a )
    {
        const int one = a < m->vertices[0] ? 0 : 1;
        now[a] = double3_from( place_of( m->h.world, m->body[one], a - one * m->vertices[0] ) );
        for ( int b = 0; b < a; ++b )
        {
            const int other = b < m->vertices[0] ? 0 : 1;
            const double gap = fmax( keeps[a], keeps[b] );
            const bool is_pair = one != other || double3_distance( rest[a], rest[b] ) > 1.3 * gap;
            least = is_pair ? fmin( least, double3_distance( now[a], now[b] ) / gap ) : least;
        }
    }
    return least;
}

// Vertices keep 0.72 of their longest edge, which is more than the thickness here.
static void find_keeps( const meeting* m, double3 rest[VERTICES], double keeps[VERTICES] )
{
    memset( keeps, 0, VERTICES * sizeof( *keeps ) );
    for ( int body = 0; body < BODIES; ++body )
    {
        const wisp_fabric* f = wisp_world_fabric( m->h.world, m->body[body] );
        const int first = body * m->vertices[0];
        for ( int v = 0; v < f->vertex_count; ++v )
        {
            rest[first + f->slot_vertex[v]] = double3_widen( f->rest[v] );
        }
        for ( int i = 0; i < 2 * f->edge_count; ++i )
        {
            const int v = first + f->slot_vertex[f->edges[i]], other = first + f->slot_vertex[f->edges[i ^ 1]];
            keeps[v] = fmax( keeps[v], 0.72 * double3_distance( rest[v], rest[other] ) );
        }
    }
}

// Where no sphere leaves its margin, the nearest of all pairs is in the lists. Where one does it is counted, and where many do lists are made again.
TEST( no_pair_of_spheres_that_is_near_is_missed )
{
    static const float SPEEDS[] = { 0.2f, 0.8f, 20.0f }; // m/s
    int counted[WISP_COUNT( SPEEDS )] = { 0 }, searches[WISP_COUNT( SPEEDS )] = { 0 }, near = 0;
    for ( int i = 0; i < WISP_COUNT( SPEEDS ); ++i )
    {
        meeting m;
        open_meeting( &m, WISP_CONTACT_SPHERES, SPEEDS[i] );
        double3 rest[VERTICES];
        double keeps[VERTICES];
        find_keeps( &m, rest, keeps );
        assert_status( m.h.world, wisp_set_gravity( m.h.world, m.body[1], ( wisp_vec3 ){ 0.0f, -1.5f, 0.0f } ),
                       WISP_OK );
        for ( int step = 0; step < 60; ++step )
        {
            run_steps( m.h.world, 1, FRAME );
            const wisp_contact_stats f = contact_stats( m.h.world );
            const double least = least_gap( &m, rest, keeps );
            counted[i] += f.outran;
            searches[i] += f.searches;
            near += least < 1.0 ? 1 : 0;
            if ( f.outran == 0 && least < 1.0 )
            {
                assert_near( (double)f.min_gap, least, 1e-5 );
            }
        }
        close_world( &m.h );
    }
    print_message( "%d, %d, %d outran, %d, %d, %d searches; near in %d steps\n", counted[0], counted[1], counted[2],
                   searches[0], searches[1], searches[2], near );
    assert_int_equal( counted[0], 0 );
    assert_true( searches[0] == 60 && searches[2] > 60 && counted[2] > 0 && near > 40 );
}

// ---- a change of the level ----

TEST( a_level_may_change_between_steps )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, 8, 1, 1 );
    add_heap( h.world );
    int contacts[WISP_CONTACT_LEVEL_COUNT] = { 0 };
    for ( int step = 0; step < 90; ++step )
    {
        const wisp_contact_level level = (wisp_contact_level)( step / 10 % WISP_CONTACT_LEVEL_COUNT );
        set_level( h.world, level );
        run_steps( h.world, 1, FRAME );
        contacts[level] += contact_stats( h.world ).contacts;
    }
    set_level( h.world, WISP_CONTACT_EXACT );
    run_steps( h.world, 30, FRAME );
    assert_true( contacts[0] > 50 && contacts[1] > 50 && contacts[2] > 50 );
    assert_int_equal( contact_stats( h.world ).intersections, 0 );
}
