// Sixteen strands against a body at once: the kernel against a scalar version in double on wisp_shape_closest(), and
// every table against the first, bit for bit.
#include "collision_vectors.h"
#include "kernels_fixture.h"

#include "wisp/module/shapes.h"

enum
{
    ROWS = 40,
    LANES = ROWS * WISP_LANES,
};

typedef struct contact_rows
{
    _Alignas( 64 ) float position[ROWS * 48];
    float previous[ROWS * 48], friction[ROWS * 48];
    float weight[LANES], depth[LANES], pushed[LANES], left[LANES], body[LANES], last[LANES];
    int variant; // two a shape: at rest or moving, of which the latter takes back; from the sixth on with a vertex in the middle
} contact_rows;

static const int32_t GROUP_ROW[] = { 0, 17, 17, ROWS };

static const wisp_shape SHAPES[] = {
    { .kind = WISP_SHAPE_PLANE },
    { .kind = WISP_SHAPE_SPHERE, .radius = 0.8f },
    { .kind = WISP_SHAPE_CAPSULE, .radius = 0.4f, .half_length = 0.6f },
    { .kind = WISP_SHAPE_BOX, .half_extent = { 0.7f, 0.5f, 0.6f } },
    { .kind = WISP_SHAPE_TAPERED_CAPSULE, .top_radius = 0.3f, .bottom_radius = 0.5f, .half_length = 0.6f },
};

// Around the origin, most of them near the surfaces of bodies of about a metre; a fifth is pinned, a third has
// contacts from before.
static void make_rows( contact_rows* r )
{
    for ( int i = 0; i < LANES; ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const size_t at = (size_t)( i / WISP_LANES * 48 + k * WISP_LANES + i % WISP_LANES );
            r->position[at] = test_random_float( i, k, -1.0f, 1.0f );
            r->friction[at] = test_random_float( i, 7 + k, -0.1f, 0.1f );
            r->previous[at] = r->position[at] + test_random_float( i, 3 + k, -0.1f, 0.1f );
        }
        r->weight[i] = i % 5 == 0 ? 0.0f : 1.0f;
        r->depth[i] = i % 3 == 0 ? test_random_float( i, 6, 0.0f, 0.2f ) : INFINITY;
        r->pushed[i] = i % 2 == 0 ? 0.25f : i % 3 == 0 ? -0.05f : 0.0f;
        r->last[i] = 0.1f * (float)( i % 4 );
        r->body[i] = (float)( i / 4 % 3 - 1 );
        r->left[i] = i % 7 == 0 ? 0.03f : 0.0f;
    }
}

static wisp_strand_contact_args job_on( contact_rows* r )
{
    const wisp_transform before =
        wisp_transform_make( ( wisp_quat ){ 0.3f, -0.2f, 0.5f, 0.9f }, ( wisp_vec3 ){ 0.1f, 0, 0.2f } );
    const wisp_transform after =
        wisp_transform_make( ( wisp_quat ){ 0.35f, -0.2f, 0.45f, 0.9f }, ( wisp_vec3 ){ 0.15f, 0.05f, 0.2f } );
    return ( wisp_strand_contact_args ){
        .group_row = GROUP_ROW,
        .position = r->position,
        .previous = r->previous,
        .inverse_mass = r->weight,
        .allowed_depth = r->depth,
        .normal_correction = r->pushed,
        .friction = r->friction,
        .remaining_depth = r->left,
        .body = r->body,
        .last_correction = r->last,
        .body_number = 1.0f,
        .starts = r->variant % 2 == 0,
        .gives_back = r->variant % 2 == 1,
        .shape = SHAPES[r->variant / 2 % WISP_COUNT( SHAPES )],
        .before = r->variant % 2 == 1 ? before : after,
        .after = after,
        .thickness = 0.1f,
        .static_friction = 0.6f,
        .kinetic_friction = 0.4f,
        .max_push_out = 0.02f,
    };
}

// ---- the same contact of one vertex in double ----

typedef struct contact_vertex
{
    double3 p, previous, friction;
    double pushed, left, body;
    bool touches, near_edge; // near a discontinuity of the result
} contact_vertex;

static wisp_vec3 lane_of( const float* rows, int i )
{
    const float* x = rows + i / WISP_LANES * 48 + i % WISP_LANES;
    return ( wisp_vec3 ){ x[0], x[WISP_LANES], x[2 * WISP_LANES] };
}

static void rub( const wisp_strand_contact_args* args, contact_vertex* v, double3 n, double3 motion, bool is_held,
                 bool starts )
{
    double3 u = double3_sub( double3_sub( v->p, v->previous ), motion );
    u = double3_add_scaled( u, -double3_dot( u, n ), n );
    const double3 last = double3_add_scaled( v->friction, -double3_dot( v->friction, n ), n );
    v->friction = is_held ? last : ( double3 ){ 0 };
    const double3 all = starts ? last : double3_add_scaled( v->friction, 1.0, u );
    const double length = double3_length( all ), cone = (double)args->static_friction * v->pushed;
    v->near_edge = v->near_edge || fabs( length - cone ) < 1e-5;
    const double fraction = length <= cone ? 1.0 : (double)args->kinetic_friction * v->pushed / length;
    v->p = double3_add_scaled( double3_add_scaled( v->p, -fraction, all ), 1.0, v->friction );
    v->friction = double3_add_scaled( ( double3 ){ 0 }, fraction, all );
}

static contact_vertex expected_at( const wisp_strand_contact_args* args, int i )
{
    contact_vertex v = { .pushed = (double)args->normal_correction[i],
                         .left = (double)args->remaining_depth[i],
                         .body = (double)args->body[i] };
    const double sum = v.pushed;
    const bool is_held = sum > 0.0, is_own = args->body[i] == args->body_number;
    const bool starts = args->starts && is_own && sum < 0.0, gives = args->gives_back && is_own && is_held;
    const double least = starts || gives ? -sum : 0.0;
    const wisp_vec3 p = lane_of( args->position, i ), previous = lane_of( args->previous, i );
    v.p = double3_widen( p );
    v.previous = double3_widen( previous );
    v.friction = double3_widen( lane_of( args->friction, i ) );
    wisp_surface_point s, first;
    assert_true( wisp_shape_closest( &args->shape, wisp_transform_to_local( args->after, p ), &s ) );
    assert_true( wisp_shape_closest( &args->shape, wisp_transform_to_local( args->before, previous ), &first ) );
    const double h = (double)args->thickness, now = (double)s.distance, start = (double)first.distance;
    const double began = fmax( 0.0, h - start ), depth = (double)args->allowed_depth[i];
    v.touches = args->inverse_mass[i] > 0.0f && ( gives || now < h + least );
    v.near_edge = ( !gives && fabs( now - h - least ) < 1e-5 ) || fabs( began - depth - h ) < 1e-5;
    if ( v.touches == false )
    {
        return v;
    }
    const double may = began > depth + h ? began : fmin( began, depth );
    const double outward = fmax( 0.0, now - start - ( began - may ) );
    const double free = fmax( 0.0, may - outward );
    const double healed = fmin( free, fmax( 0.0, (double)args->max_push_out - outward ) );
    const double out = fmax( least, h - ( free - healed ) - now ), push = fmax( least, out - healed );
    const double3 n = double3_widen( wisp_quat_rotate( args->after.rotation, s.normal ) ),
                  a = double3_widen( wisp_transform_to_world( args->after, s.point ) ),
                  b = double3_widen( wisp_transform_to_world( args->before, s.point ) );
    v.p = double3_add_scaled( v.p, out, n );
    v.previous = double3_add_scaled( v.previous, healed + ( may > 0.1 * h ? outward : 0.0 ), n );
    v.near_edge = v.near_edge || fabs( may - 0.1 * h ) < 1e-5;
    v.pushed = fmax( 0.0, sum ) + push;
    v.body = is_held && !is_own ? -1.0 : (double)args->body_number;
    rub( args, &v, n, double3_sub( a, b ), is_held, starts );
    v.left = fmax( v.left, free - healed );
    return v;
}

// Coordinates of about 1 m are rounded to 6e-8 about ten times; a normal near a centre amplifies that.
static void assert_vertex( const contact_rows* r, int i, const contact_vertex* v )
{
    const double rounding = 2e-6;
    assert_near3( double3_widen( lane_of( r->position, i ) ), v->p, rounding, "lane", i );
    assert_near3( double3_widen( lane_of( r->previous, i ) ), v->previous, rounding, "start of lane", i );
    assert_near3( double3_widen( lane_of( r->friction, i ) ), v->friction, rounding, "friction of lane", i );
    assert_near( (double)r->pushed[i], v->pushed, rounding, "push of lane", i );
    assert_near( (double)r->left[i], v->left, rounding, "depth of lane", i );
    assert_near( (double)r->body[i], v->body, 0.0, "body of lane", i );
}

// In the middle of a body, no direction is the nearest.
static bool is_in_the_middle( const contact_rows* r )
{
    return r->variant >= 2 * WISP_COUNT( SHAPES );
}

static void fill_contacts( void* state, int variant )
{
    contact_rows* r = state;
    make_rows( r );
    r->variant = variant;
    const wisp_vec3 middle = job_on( r ).after.translation;
    if ( is_in_the_middle( r ) )
    {
        r->position[1] = middle.x;
        r->position[1 + WISP_LANES] = middle.y;
        r->position[1 + 2 * WISP_LANES] = middle.z;
    }
}

RUN_KERNEL( run_contacts, strand_contact, wisp_strand_contact_args, job_on )

static void check_contacts( void* start, void* end )
{
    const wisp_strand_contact_args args = job_on( start );
    int touched = 0, skipped = 0;
    for ( int i = is_in_the_middle( start ) ? LANES : 0; i < LANES; ++i )
    {
        const contact_vertex v = expected_at( &args, i );
        touched += v.touches && v.near_edge == false ? 1 : 0;
        skipped += v.near_edge ? 1 : 0;
        if ( v.near_edge == false )
        {
            assert_vertex( end, i, &v );
        }
    }
    assert_true( is_in_the_middle( start ) || ( touched > LANES / 20 && skipped < LANES / 50 ) );
}

TEST_KERNEL( lanes_answer_as_a_scalar_does, contact_rows, 4 * WISP_COUNT( SHAPES ), 0, 3, 1, fill_contacts,
             run_contacts, check_contacts )

TEST( what_is_pinned_away_or_no_number_is_left_alone )
{
    static contact_rows made = { .variant = 3 }, rows;
    make_rows( &made );
    made.position[2] = NAN;
    made.previous[2 + WISP_LANES] = INFINITY;
    for ( int i = 0; i < LANES; ++i )
    {
        made.weight[i] = i % 3 == 0 || i == 2 ? 1.0f : 0.0f;
    }
    rows = made;
    wisp_strand_contact_args args = job_on( &rows );
    args.thickness = 0.0f;
    args.gives_back = false;
    widest_table()->strand_contact( &args, 0, 3 );
    for ( int i = 0; i < LANES; ++i )
    {
        const wisp_vec3 p = lane_of( made.position, i ), now = lane_of( rows.position, i );
        wisp_surface_point s;
        const bool known = wisp_shape_closest( SHAPES + 1, wisp_transform_to_local( args.after, p ), &s );
        if ( made.weight[i] == 0.0f || known == false || s.distance > 1e-6f )
        {
            assert_memory_equal( &p, &now, sizeof( p ) );
        }
    }
}

TEST( a_group_tells_how_far_it_reaches_and_what_it_remembers )
{
    static contact_rows made = { .variant = 3 }, rows, others;
    make_rows( &made );
    made.position[3] = NAN;
    const wisp_kernels* const* tables = every_table();
    for ( int t = 0; tables[t / 2] != NULL; ++t )
    {
        rows = others = made;
        const wisp_strand_contact_args args = job_on( &rows );
        wisp_strand_contact_args segments = job_on( &others );
        segments.length = made.weight;
        wisp_strand_bounds reach, empty;
        tables[t / 2]->strand_contact_begin( &args, &segments, 2, t % 2 == 0, &reach );
        tables[t / 2]->strand_contact_begin( &args, NULL, 1, t % 2 == 0, &empty );
        assert_memory_equal( &others, &rows, sizeof( rows ) );
        assert_true( empty.lower.x > empty.upper.x );
        wisp_vec3 lower = { INFINITY, INFINITY, INFINITY };
        double path = 0.0;
        for ( int i = 0; i < LANES; ++i )
        {
            const wisp_vec3 p = lane_of( made.position, i ), q = lane_of( made.previous, i );
            const bool inside = i >= GROUP_ROW[2] * WISP_LANES, held = made.pushed[i] > 0.0f || made.left[i] > 0.0f;
            if ( inside && made.weight[i] > 0.0f )
            {
                lower = ( wisp_vec3 ){ fminf( lower.x, fminf( p.x, q.x ) ), fminf( lower.y, fminf( p.y, q.y ) ),
                                       fminf( lower.z, fminf( p.z, q.z ) ) };
                const float d[3] = { p.x - q.x, p.y - q.y, p.z - q.z };
                path = fmax( path, sqrt( (double)( d[0] * d[0] + d[1] * d[1] + d[2] * d[2] ) ) );
            }
            const float depth = held ? made.left[i] : INFINITY;
            assert_true( rows.depth[i] == ( inside ? depth : made.depth[i] ) );
            assert_true( rows.left[i] == ( inside ? 0.0f : made.left[i] ) );
            assert_true(
                rows.pushed[i] ==
                ( inside && t % 2 == 0 ? -fminf( fmaxf( made.pushed[i], 0.0f ), made.last[i] ) : made.pushed[i] ) );
            assert_true( rows.last[i] == ( inside && t % 2 == 0 ? fmaxf( made.pushed[i], 0.0f ) : made.last[i] ) );
        }
        assert_true( reach.lower.x == lower.x && reach.lower.y == lower.y && reach.lower.z == lower.z );
        assert_near( (double)reach.max_path, path, 1e-7, "path", t );
    }
}

TEST( a_kernel_finds_the_segments_whose_way_meets_a_box_and_sums_the_pushes_of_strands )
{
    static contact_rows rows = { .variant = 3 };
    make_rows( &rows );
    rows.position[3] = NAN;
    const wisp_strand_contact_args args = job_on( &rows );
    const wisp_strand_bounds box = { .lower = { -0.3f, -0.4f, -0.3f }, .upper = { 0.2f, 0.1f, 0.4f } };
    const wisp_vec3 u = box.upper, l = box.lower;
    const wisp_kernels* const* tables = every_table();
    int found = 0, rest = 0;
    for ( int t = 0; tables[t] != NULL; ++t )
    {
        uint32_t lanes = 0;
        for ( int i = 0; i + WISP_LANES < LANES; ++i )
        {
            wisp_vec3 lower = { INFINITY, INFINITY, INFINITY }, upper = { -INFINITY, -INFINITY, -INFINITY };
            for ( int e = 0; e < 4; ++e )
            {
                collision_widen( &lower, &upper,
                                 lane_of( e % 2 == 0 ? rows.position : rows.previous, i + e / 2 * WISP_LANES ) );
            }
            const int row = i / WISP_LANES,
                      next = tables[t]->strand_find_segments( &args, row, row + 2, &box, &lanes );
            const bool moves = rows.weight[i] + rows.weight[i + WISP_LANES] > 0.0f,
                       is_told = lanes >> i % WISP_LANES & 1u;
            assert_true( next == row + ( lanes == 0 ) );
            assert_true( is_told == ( moves && lower.x <= u.x && lower.y <= u.y && lower.z <= u.z && upper.x >= l.x &&
                                      upper.y >= l.y && upper.z >= l.z ) );
            assert_true( tables[t]->strand_find_segments( &args, 0, ROWS, &box, &lanes ) <= row || is_told == false );
            found += is_told;
            rest += is_told == false;
        }
        float sums[WISP_LANES] = { [2] = 1.0f }, expected[WISP_LANES] = { [2] = 1.0f };
        for ( int i = GROUP_ROW[2] * WISP_LANES; i < LANES; ++i )
        {
            expected[i % WISP_LANES] += fmaxf( rows.pushed[i], 0.0f );
        }
        rows.left[LANES - 5] = 0.75f;
        assert_true( tables[t]->strand_contact_sum( &args, 2, 0.5f, sums ) );
        assert_false( tables[t]->strand_contact_sum( &args, 2, 0.8f, ( float[WISP_LANES] ){ 0 } ) );
        assert_memory_equal( sums, expected, sizeof( sums ) );
    }
    assert_true( found > LANES / 20 && rest > LANES / 20 );
}
