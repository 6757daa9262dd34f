// Kernels of contact with shapes in closed form: closest points have the bits of wisp_shape_closest() and the values of
// the formulas in doubles, for sizes of zero, points at centres and far away. Half spaces, with friction and without,
// are those of scalar code, bit for bit, in every table.
#include "oracle/contact_oracle.h"
#include "kernels_fixture.h"

#include "wisp/module/shapes.h"
#include "wisp/module/taper.h"
#include "wisp/module/vec.h"

enum
{
    COUNT = 200,
    ROOM = COUNT + 8,
    SEEDS = 60,
    KINDS = 5,
};

typedef struct query
{
    wisp_shape shape;
    float thickness, shallow;
    float from[3][ROOM], to[3][ROOM], path[ROOM], reach[ROOM];
    float clearance[ROOM], point[3][ROOM], normal[3][ROOM], distance[ROOM], start[ROOM];
    int32_t near[ROOM], special[ROOM], near_count, special_count, count;
} query;

static float size_of( int seed, int salt )
{
    // zero, tiny, usual, huge
    const float sizes[] = { 0.0f, 1e-6f, 0.3f, 0.7f, 1e5f };
    return sizes[test_random( seed, salt, 5 )];
}

// Some points are at the centre, on axes and edges, and far away; zeros have both signs.
static void place_points( query* q, int seed )
{
    for ( int i = 0; i < COUNT; ++i )
    {
        const int key = seed * COUNT + i;
        const float scale = i % 11 == 0 ? 1e6f : ( i % 7 == 0 ? 1e-7f : 1.0f );
        for ( int k = 0; k < 3; ++k )
        {
            const wisp_vec3 h = q->shape.half_extent;
            const float half[3] = { h.x, h.y, h.z };
            const float way = test_random_float( key, 3 + k, -0.1f, 0.1f );
            float at = scale * test_random_float( key, k, -1.0f, 1.0f );
            const int manner = test_random( key, 10 + k, 8 );
            at = manner == 0 ? 0.0f : ( manner == 1 ? -0.0f : at );
            at = manner == 2 ? half[k] : ( manner == 3 && k == 1 ? q->shape.half_length : at );
            q->to[k][i] = i < 2 ? ( i == 0 ? 0.0f : -0.0f ) : at;
            q->from[k][i] = q->to[k][i] + ( i % 5 == 0 ? 0.0f : way );
        }
        q->path[i] = i % 3 == 0 ? 0.0f : test_random_float( key, 6, 0.0f, 0.3f );
        q->reach[i] = i % 13 == 0 ? 1e7f : test_random_float( key, 7, 0.0f, 1.0f );
    }
}

static void fill_query( void* state, int seed )
{
    query* q = state;
    q->count = COUNT - seed % 9;
    q->shape = ( wisp_shape ){ .kind = (wisp_shape_kind)( seed % KINDS ),
                               .radius = size_of( seed, 1 ),
                               .half_length = size_of( seed, 2 ),
                               .half_extent = { size_of( seed, 3 ), size_of( seed, 4 ), size_of( seed, 5 ) },
                               .top_radius = size_of( seed, 1 ),
                               .bottom_radius = size_of( seed, 6 ) };
    q->thickness = 0.05f;
    q->shallow = 0.1f * q->thickness;
    place_points( q, seed );
}

static void run_query( const wisp_kernels* kernels, void* state, int begin, int end )
{
    query* q = state;
    const wisp_shape_query_args args = {
        .shape = q->shape,
        .from = { q->from[0], q->from[1], q->from[2] },
        .to = { q->to[0], q->to[1], q->to[2] },
        .path = q->path,
        .reach = q->reach,
        .thickness = q->thickness,
        .shallow = q->shallow,
        .clearance = q->clearance,
        .near = q->near,
        .point = { q->point[0], q->point[1], q->point[2] },
        .normal = { q->normal[0], q->normal[1], q->normal[2] },
        .distance = q->distance,
        .start = q->start,
        .special = q->special,
    };
    assert_true( begin == 0 && q->count <= end );
    q->near_count = kernels->query_shape( &args, q->count, &q->special_count );
    for ( int k = 0; k < 3; ++k )
    {
        FORGET_BEHIND( q->point[k], q->near_count );
        FORGET_BEHIND( q->normal[k], q->near_count );
    }
    FORGET_BEHIND( q->distance, q->near_count );
    FORGET_BEHIND( q->start, q->near_count );
    FORGET_BEHIND( q->near, q->near_count );
    FORGET_BEHIND( q->special, q->special_count );
    FORGET_BEHIND( q->clearance, q->count );
}

static bool has_bits( float found, float expected )
{
    return memcmp( &found, &expected, sizeof( float ) ) == 0;
}

// @return whether the particle is special
static bool check_near( const query* q, int m, int i, const wisp_surface_point* s )
{
    const float point[3] = { s->point.x, s->point.y, s->point.z },
                normal[3] = { s->normal.x, s->normal.y, s->normal.z };
    float away[3];
    for ( int k = 0; k < 3; ++k )
    {
        if ( !has_bits( q->point[k][m], point[k] ) || !has_bits( q->normal[k][m], normal[k] ) )
        {
            fail_msg( "shape %d, (%.9g, %.9g, %.9g): component %d is at %.9g along %.9g, expected %.9g along %.9g",
                      (int)q->shape.kind, (double)q->to[0][i], (double)q->to[1][i], (double)q->to[2][i], k,
                      (double)q->point[k][m], (double)q->normal[k][m], (double)point[k], (double)normal[k] );
        }
        away[k] = q->from[k][i] - point[k];
    }
    const float start = normal[0] * away[0] + normal[1] * away[1] + normal[2] * away[2] - q->thickness;
    assert_int_equal( q->near[m], i );
    assert_true( has_bits( q->distance[m], s->distance ) && has_bits( q->start[m], start ) );
    assert_true( q->clearance[i] == ( s->distance > 0.0f ? s->distance : INFINITY ) );
    return fabsf( s->distance ) <= q->path[i] || start < -q->shallow;
}

static int near_of[KINDS], special_of[KINDS];

static void check_query( void* start, void* end )
{
    (void)start;
    query* q = end;
    int near = 0, special = 0;
    for ( int i = 0; i < q->count; ++i )
    {
        wisp_surface_point s;
        assert_true( wisp_shape_closest( &q->shape, ( wisp_vec3 ){ q->to[0][i], q->to[1][i], q->to[2][i] }, &s ) );
        if ( s.distance > q->reach[i] )
        {
            assert_true( q->clearance[i] == q->reach[i] );
            continue;
        }
        const bool is_special = check_near( q, near, i, &s );
        assert_true( is_special == false || q->special[special] == near );
        special += is_special ? 1 : 0;
        near += 1;
    }
    assert_int_equal( q->near_count, near );
    assert_int_equal( q->special_count, special );
    near_of[q->shape.kind] += near;
    special_of[q->shape.kind] += special;
}

TEST( closest_points_have_the_bits_of_the_scalar_query )
{
    check_kernel( KERNEL_ROW( query, SEEDS, 0, COUNT, 0, fill_query, run_query, check_query ) );
    for ( int k = 0; k < KINDS; ++k )
    {
        assert_true( near_of[k] > 500 && special_of[k] > 100 );
    }
}

// ---- half spaces ----

typedef struct rows
{
    _Alignas( 64 ) float position[ROOM][4], previous[ROOM][4], row[ROOM][16];
    float point[3][ROOM], normal[3][ROOM], now[ROOM], start[ROOM];
    int32_t particle_x4[ROOM], row_x16[ROOM];
    wisp_transform before, after;
    bool moved;
} rows;

static void fill_rows( void* state, int seed )
{
    rows* r = state;
    for ( int i = 0; i < COUNT; ++i )
    {
        const int key = seed * COUNT + i;
        for ( int k = 0; k < 4; ++k )
        {
            r->position[i][k] = i % 9 == 0 ? -0.0f : test_random_float( key, k, -1.0f, 1.0f );
            r->previous[i][k] = i % 8 == 0 ? -0.0f : test_random_float( key, 4 + k, -1.0f, 1.0f );
        }
        const int axis = i % 3;
        for ( int k = 0; k < 3; ++k )
        {
            r->point[k][i] = i % 10 == 0 ? -0.0f : test_random_float( key, 8 + k, -1.0f, 1.0f );
            r->normal[k][i] =
                i % 4 == 0 ? ( k == axis ? -1.0f : -0.0f ) : test_random_float( key, 11 + k, -1.0f, 1.0f );
        }
        r->now[i] = test_random_float( key, 14, -0.1f, 0.1f );
        r->start[i] = seed % 3 == 0 ? 0.1f : test_random_float( key, 15, -0.1f, 0.1f );
        r->particle_x4[i] = 4 * ( COUNT - 1 - i );
        r->row_x16[i] = 16 * ( i * 7 % COUNT );
    }
    const float t = test_random_float( seed, 16, -1.0f, 1.0f );
    const wisp_quat none = { 0.0f, 0.0f, 0.0f, 1.0f };
    r->before = wisp_transform_make( seed % 2 == 0 ? none : ( wisp_quat ){ t, 0.3f, 0.1f, 0.8f },
                                     ( wisp_vec3 ){ seed % 4 < 2 ? 0.0f : t, 0.0f, 0.2f } );
    r->after = seed % 5 < 2 ? r->before
                            : wisp_transform_make( seed % 3 == 0 ? none : ( wisp_quat ){ t, 0.2f, 0.1f, 0.8f },
                                                   ( wisp_vec3 ){ t, 0.1f, 0.2f } );
}

static const float THICKNESS = 0.04f, SHALLOW = 0.004f, RECOVERY = 0.01f;

static void run_rows( const wisp_kernels* kernels, void* state, int begin, int end )
{
    rows* r = state;
    const wisp_half_space_rows_args args = {
        .before = r->before,
        .after = r->after,
        .thickness = THICKNESS,
        .shallow = SHALLOW,
        .recovery = RECOVERY,
        .static_friction = 0.5f,
        .kinetic_friction = 0.3f,
        .point = { r->point[0], r->point[1], r->point[2] },
        .normal = { r->normal[0], r->normal[1], r->normal[2] },
        .now = r->now,
        .start = r->start,
        .position = r->position[0],
        .previous = r->previous[0],
        .rows = r->row[0],
        .particle_x4 = r->particle_x4,
        .row_x16 = r->row_x16,
    };
    r->moved = kernels->half_space_rows( &args, end - begin );
}

static void make_row_alone( rows* r, int i )
{
    const float outward = fmaxf( 0.0f, r->now[i] - THICKNESS - r->start[i] );
    const float recovered =
        r->start[i] + outward < 0.0f ? fminf( -r->start[i] - outward, fmaxf( 0.0f, RECOVERY - outward ) ) : 0.0f;
    const float absorbed = r->start[i] < -SHALLOW ? outward : 0.0f;
    const wisp_vec3 local = { r->point[0][i], r->point[1][i], r->point[2][i] };
    const wisp_vec3 point = wisp_transform_to_world( r->after, local ),
                    was = wisp_transform_to_world( r->before, local ),
                    normal = wisp_quat_rotate( r->after.rotation,
                                               ( wisp_vec3 ){ r->normal[0][i], r->normal[1][i], r->normal[2][i] } );
    const float gap = r->start[i] < 0.0f ? THICKNESS + r->start[i] + recovered : THICKNESS;
    const float row[16] = { point.x,
                            point.y,
                            point.z,
                            normal.x,
                            normal.y,
                            normal.z,
                            point.x - was.x,
                            point.y - was.y,
                            point.z - was.z,
                            gap,
                            0.0f,
                            0.0f,
                            0.0f,
                            0.0f,
                            0.5f,
                            0.3f };
    memcpy( r->row[r->row_x16[i] / 16], row, sizeof( row ) );
    const float n[3] = { normal.x, normal.y, normal.z };
    for ( int k = 0; k < 3; ++k )
    {
        float *p = r->position[r->particle_x4[i] / 4] + k, *old = r->previous[r->particle_x4[i] / 4] + k;
        const float moved = *p + recovered * n[k], from = *old + ( recovered + absorbed ) * n[k];
        r->moved = r->moved || !has_bits( moved, *p ) || !has_bits( from, *old );
        *p = moved;
        *old = from;
    }
}

static void check_rows( void* start, void* end )
{
    rows *expected = start, *r = end;
    for ( int i = 0; i < COUNT; ++i )
    {
        make_row_alone( expected, i );
    }
    assert_memory_equal( r->row, expected->row, sizeof( r->row ) );
    assert_memory_equal( r->position, expected->position, sizeof( r->position ) );
    assert_memory_equal( r->previous, expected->previous, sizeof( r->previous ) );
    assert_true( r->moved == expected->moved );
}

TEST_KERNEL( half_spaces_have_the_bits_of_scalar_code, rows, SEEDS, 0, COUNT, 0, fill_rows, run_rows, check_rows )

// ---- half spaces with friction ----

enum
{
    PARTICLES = 72,
    SWEEPS = 3,
};

typedef struct half_spaces
{
    _Alignas( 64 ) float position[PARTICLES][4];
    float previous[PARTICLES][4];
    float rows[PARTICLES][3][16]; // each particle has the middle one of three rows
    int32_t particle_x4[PARTICLES], row16[PARTICLES], count;
} half_spaces;

enum
{
    POINT = 0,
    NORMAL = 3,
    MOTION = 6,
    GAP = 9,
    PUSHED = 10,
    RUBBED = 11,
    STATIC = 14,
    KINETIC = 15,
};

// Particles a few thicknesses to both sides of their planes; every fifth is exactly at the gap and at rest. Half of
// the sums have values that a previous iteration may have left. In the second variant three fill up a group.
static void fill_half_spaces( void* state, int variant )
{
    half_spaces* h = state;
    for ( int i = 0; i < PARTICLES; ++i )
    {
        float* row = h->rows[i][1];
        const bool at_rest = i % 5 == 0, fresh = i % 2 == 0;
        float n[3], squared = 0.0f;
        for ( int k = 0; k < 3; ++k )
        {
            n[k] = at_rest ? ( k == 1 ? 1.0f : 0.0f ) : test_random_float( i, k, -1.0f, 1.0f );
            squared += n[k] * n[k];
        }
        const float height = at_rest ? 0.25f : test_random_float( i, 3, 0.0f, 0.5f ), length = sqrtf( squared );
        for ( int k = 0; k < 3; ++k )
        {
            row[POINT + k] = at_rest ? 0.0f : test_random_float( i, 4 + k, -1.0f, 1.0f );
            row[NORMAL + k] = n[k] / length;
            row[MOTION + k] = at_rest ? 0.0f : test_random_float( i, 8 + k, -0.05f, 0.05f );
            row[RUBBED + k] = fresh ? 0.0f : test_random_float( i, 12 + k, -0.05f, 0.05f );
            h->position[i][k] = row[POINT + k] + height * row[NORMAL + k];
            h->previous[i][k] = h->position[i][k] - ( at_rest ? 0.0f : test_random_float( i, 16 + k, -0.1f, 0.1f ) );
        }
        row[GAP] = 0.25f;
        row[PUSHED] = fresh ? 0.0f : test_random_float( i, 20, 0.0f, 0.1f );
        row[STATIC] = test_random_float( i, 21, 0.0f, 1.0f );
        row[KINETIC] = 0.5f * row[STATIC];
        h->position[i][3] = 1.0f + (float)i;
        h->particle_x4[i] = 4 * ( ( i + 5 ) % PARTICLES );
        h->row16[i] = 16 * ( 3 * ( ( i + 5 ) % PARTICLES ) + 1 );
    }
    h->count = variant == 0 ? PARTICLES : 3;
    for ( int k = 0; k < 8 && variant == 1; ++k )
    {
        const int i = k < 3 ? k : 2;
        h->particle_x4[k] = 4 * i;
        h->row16[k] = 16 * ( 3 * i + 1 );
    }
}

static void sweep_half_spaces( const wisp_kernels* kernels, void* state, int begin, int end )
{
    half_spaces* h = state;
    const wisp_half_space_args args = { h->position[0], h->previous[0], h->rows[0][0], h->particle_x4, h->row16 };
    for ( int s = 0; s < SWEEPS; ++s )
    {
        kernels->half_space( &args, begin, h->count < PARTICLES ? 8 : end );
    }
}

static float dot( const float a[3], const float b[3] )
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// @return whether it sticks
static bool push_one( float p[4], const float previous[4], float row[16] )
{
    const float* n = row + NORMAL;
    const float d[3] = { p[0] - row[POINT], p[1] - row[POINT + 1], p[2] - row[POINT + 2] };
    const float sum = row[PUSHED] + ( row[GAP] - dot( n, d ) ), pushed = sum > 0.0f ? sum : 0.0f;
    float u[3];
    for ( int k = 0; k < 3; ++k )
    {
        p[k] += ( pushed - row[PUSHED] ) * n[k];
        u[k] = p[k] - previous[k] - row[MOTION + k];
    }
    row[PUSHED] = pushed;
    const float up = dot( n, u );
    for ( int k = 0; k < 3; ++k )
    {
        u[k] = u[k] - up * n[k] - row[RUBBED + k];
    }
    const float length = sqrtf( dot( u, u ) );
    const bool sticks = length <= row[STATIC] * pushed;
    const float fraction = sticks ? 1.0f : row[KINETIC] * pushed / length;
    for ( int k = 0; k < 3; ++k )
    {
        const float now = -fraction * u[k];
        p[k] += now - row[RUBBED + k];
        row[RUBBED + k] = now;
    }
    return sticks;
}

// The groups are in the order of their particles; a group that is filled up moves each particle once.
static void check_half_spaces( void* start, void* end )
{
    half_spaces *expected = start, *found = end;
    int sticking = 0, sliding = 0, free = 0;
    for ( int i = 0; i < SWEEPS * expected->count; ++i )
    {
        const int p = i % expected->count;
        float* row = expected->rows[p][1];
        const bool sticks = push_one( expected->position[p], expected->previous[p], row ),
                   pushed = row[PUSHED] > 0.0f;
        sticking += pushed && sticks ? 1 : 0;
        sliding += pushed && sticks == false ? 1 : 0;
        free += pushed ? 0 : 1;
    }
    assert_true( expected->count < PARTICLES || ( sticking > 10 && sliding > 10 && free > 10 ) );
    assert_memory_equal( found, expected, sizeof( *found ) );
}

TEST_KERNEL( half_spaces_push_and_rub_as_one_by_one, half_spaces, 2, 0, PARTICLES, 0, fill_half_spaces,
             sweep_half_spaces, check_half_spaces )

// ---- shapes in closed form, found and projected in one sweep ----

enum
{
    OUTSIDE = 64, // particles
    SHAPES = 2,
};

typedef struct outside
{
    _Alignas( 64 ) float position[OUTSIDE][4], previous[OUTSIDE][4];
    _Alignas( 64 ) float lanes[OUTSIDE / 8][4][WISP_INSTANCE_LANES], old_lanes[OUTSIDE / 8][3][WISP_INSTANCE_LANES];
    wisp_shape_lanes shapes[SHAPES];
    wisp_shape shape[SHAPES];
    wisp_transform before[SHAPES], after[SHAPES];
    int32_t count;
    uint32_t left, left_lanes;
} outside;

// Sizes of thickness and recovery are those of the half spaces above.
static void fill_shape( outside* o, int number, int seed )
{
    const int key = 2 * seed + number;
    wisp_shape* shape = o->shape + number;
    *shape = ( wisp_shape ){ .kind = (wisp_shape_kind)( ( seed + 3 * number ) % KINDS ),
                             .radius = 0.3f,
                             .half_length = 0.4f,
                             .half_extent = { 0.3f, 0.2f, 0.4f },
                             .top_radius = 0.2f,
                             .bottom_radius = 0.35f };
    const float t = test_random_float( key, 20, -1.0f, 1.0f ), x = test_random_float( key, 21, -0.2f, 0.2f );
    o->before[number] = wisp_transform_make( ( wisp_quat ){ t, 0.3f, 0.1f, 0.8f }, ( wisp_vec3 ){ x, 0.0f, 0.2f } );
    const wisp_quat turned = { t, 0.32f, 0.11f, 0.8f };
    o->after[number] =
        wisp_transform_make( seed % 3 == 0 ? o->before[number].rotation : turned, ( wisp_vec3 ){ x, 0.01f, 0.2f } );
    wisp_shape_lanes* s = o->shapes + number;
    s->kind = shape->kind;
    s->turns = seed % 3 != 0;
    const wisp_taper taper = wisp_taper_of( shape );
    const bool is_tapered = shape->kind == WISP_SHAPE_TAPERED_CAPSULE, is_box = shape->kind == WISP_SHAPE_BOX;
    const wisp_quat a = o->after[number].rotation, back = { -a.x, -a.y, -a.z, a.w };
    for ( int l = 0; l < 8; ++l )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const wisp_vec3 unit = { k == 0 ? 1.0f : 0.0f, k == 1 ? 1.0f : 0.0f, k == 2 ? 1.0f : 0.0f };
            const wisp_vec3 axis = wisp_quat_rotate( a, unit ),
                            row = wisp_quat_rotate( o->before[number].rotation, wisp_quat_rotate( back, unit ) );
            const float axes[3] = { axis.x, axis.y, axis.z }, turn[3] = { row.x, row.y, row.z };
            for ( int c = 0; c < 3; ++c )
            {
                s->axis[k][c][l] = axes[c];
                s->turn[k][c][l] = turn[c];
            }
        }
        const wisp_vec3 at = o->after[number].translation, was = o->before[number].translation;
        const float places[2][3] = { { at.x, at.y, at.z }, { was.x, was.y, was.z } };
        for ( int k = 0; k < 3; ++k )
        {
            s->at[k][l] = places[0][k];
            s->was[k][l] = places[1][k];
        }
        s->size[0][l] = is_box ? 0.3f : ( is_tapered ? (float)taper.middle : 0.3f );
        s->size[1][l] = is_box ? 0.2f : ( is_tapered ? (float)taper.lower : -0.4f );
        s->size[2][l] = is_box ? 0.4f : ( is_tapered ? (float)taper.upper : 0.4f );
        s->size[3][l] = (float)taper.slope;
        s->size[4][l] = (float)taper.sine;
        s->shift[l] = s->rate[l] = 0.1f;
        s->farther[l] = 1.3f;
        s->thickness[l] = THICKNESS;
        s->shallow[l] = SHALLOW;
        s->recovery[l] = RECOVERY;
        s->static_friction[l] = 0.5f;
        s->kinetic_friction[l] = 0.3f;
    }
}

// A start within two thicknesses of the surface of a shape, and a path of at most one; some have no inverse mass.
static void fill_outside( void* state, int seed )
{
    outside* o = state;
    o->count = 1 + seed % SHAPES;
    for ( int i = 0; i < o->count; ++i )
    {
        fill_shape( o, i, seed );
    }
    for ( int i = 0; i < OUTSIDE; ++i )
    {
        const int key = seed * OUTSIDE + i, number = i % o->count;
        wisp_surface_point s;
        const wisp_vec3 any = { test_random_float( key, 0, -0.6f, 0.6f ), test_random_float( key, 1, -0.7f, 0.7f ),
                                test_random_float( key, 2, -0.6f, 0.6f ) };
        wisp_shape_closest( o->shape + number, any, &s );
        const float height = test_random_float( key, 3, i % 4 == 0 ? 0.1f : 0.8f, 2.0f ) * THICKNESS;
        const wisp_vec3 from =
            wisp_transform_to_world( o->before[number], wisp_v3_mul_add( s.point, height, s.normal ) );
        const float start[3] = { from.x, from.y, from.z };
        for ( int k = 0; k < 3; ++k )
        {
            o->previous[i][k] = start[k];
            o->position[i][k] =
                start[k] + test_random_float( key, 4 + k, -0.5f, 0.5f ) * THICKNESS * ( i / 8 == 5 ? 1000.0f : 1.0f );
        }
        o->position[i][3] = i % 11 == 0 ? 0.0f : 2.0f;
        for ( int k = 0; k < 4; ++k )
        {
            // the same eight in both halves
            o->lanes[i / 8][k][i % 8] = o->lanes[i / 8][k][8 + i % 8] = o->position[i][k];
            if ( k < 3 )
            {
                o->old_lanes[i / 8][k][i % 8] = o->old_lanes[i / 8][k][8 + i % 8] = o->previous[i][k];
            }
        }
    }
}

static void run_outside( const wisp_kernels* kernels, void* state, int begin, int end )
{
    outside* o = state;
    const wisp_outside_args args = { o->position[0], o->previous[0], o->shapes, o->count };
    o->left = kernels->stay_outside( &args, begin, end );
    wisp_shape_lanes both[SHAPES][2];
    for ( int i = 0; i < SHAPES; ++i )
    {
        both[i][0] = both[i][1] = o->shapes[i];
    }
    const wisp_instances_args instances = { .slot_count = OUTSIDE / 8,
                                            .position = o->lanes[0][0],
                                            .previous = o->old_lanes[0][0] };
    o->left_lanes = kernels->instances_stay_outside( &instances, both[0], o->count );
}

// A half space of one particle, in doubles.
typedef struct space
{
    double3 point, normal, motion, rubbed;
    double gap, pushed;
} space;

static void project_space( space* s, double3* p, double3 previous )
{
    const double sum = s->pushed + s->gap - double3_dot( s->normal, double3_sub( *p, s->point ) );
    const double pushed = sum > 0.0 ? sum : 0.0;
    *p = double3_add_scaled( *p, pushed - s->pushed, s->normal );
    s->pushed = pushed;
    double3 u = double3_sub( double3_sub( *p, previous ), s->motion );
    u = double3_sub( double3_add_scaled( u, -double3_dot( s->normal, u ), s->normal ), s->rubbed );
    const double length = double3_length( u );
    const double3 none = { 0 },
                  now = double3_add_scaled( none, length <= 0.5 * pushed ? -1.0 : -0.3 * pushed / length, u );
    *p = double3_add( *p, double3_sub( now, s->rubbed ) );
    s->rubbed = now;
}

// @param passes receives whether its path enters a shape @return false where the kernel may leave the particle
static bool stay_alone( const outside* o, double3* p, double3* previous, bool* passes )
{
    *passes = false;
    space spaces[SHAPES];
    int near = 0;
    for ( int i = 0; i < o->count; ++i )
    {
        const wisp_vec3 world = { (float)p->x, (float)p->y, (float)p->z },
                        old = { (float)previous->x, (float)previous->y, (float)previous->z };
        const wisp_vec3 to = wisp_transform_to_local( o->after[i], world ),
                        from = wisp_transform_to_local( o->before[i], old );
        wisp_surface_point s, was;
        wisp_shape_closest( o->shape + i, to, &s );
        wisp_shape_closest( o->shape + i, from, &was );
        const double h = (double)THICKNESS, now = (double)s.distance;
        double start =
            double3_dot( double3_widen( s.normal ), double3_sub( double3_widen( from ), double3_widen( s.point ) ) ) -
            h;
        if ( o->shape[i].kind != WISP_SHAPE_PLANE && ( now < 1e-4 || start + h < 1e-4 ) )
        {
            wisp_shape_hit hit;
            *passes = was.distance > 1e-3f && ( now < -1e-3 || start + h < -1e-3 ) &&
                      wisp_shape_cast( o->shape + i, from, to, &hit );
            return false;
        }
        if ( now > 2.0 * h )
        {
            continue;
        }
        start = start < -(double)SHALLOW ? fmax( start, (double)was.distance - h ) : start;
        const double outward = fmax( now - h - start, 0.0 );
        const double most = fmax( (double)RECOVERY - outward, 0.0 );
        const double recovered = start + outward < 0.0 ? fmin( -start - outward, most ) : 0.0;
        const double absorbed = start < -(double)SHALLOW ? outward : 0.0;
        const double3 normal = double3_widen( wisp_quat_rotate( o->after[i].rotation, s.normal ) ),
                      point = double3_widen( wisp_transform_to_world( o->after[i], s.point ) );
        *p = double3_add_scaled( *p, recovered, normal );
        *previous = double3_add_scaled( *previous, recovered + absorbed, normal );
        spaces[near++] = ( space ){
            .point = point,
            .normal = normal,
            .motion = double3_sub( point, double3_widen( wisp_transform_to_world( o->before[i], s.point ) ) ),
            .gap = start < 0.0 ? h + start + recovered : h,
        };
        // at this depth the two formulas for the start meet
        if ( fabs( start + (double)SHALLOW ) < 1e-5 )
        {
            return false;
        }
    }
    if ( near == 2 && double3_dot( spaces[0].normal, spaces[1].normal ) < 1e-4 )
    {
        return false;
    }
    for ( int i = 0; i < ( near > 1 ? WISP_OUTSIDE_SWEEPS * near : near ); ++i )
    {
        project_space( spaces + i % near, p, *previous );
    }
    return true;
}

static void check_outside( void* start, void* end )
{
    const outside *o = start, *found = end;
    int met = 0;
    for ( int i = 0; i < OUTSIDE; ++i )
    {
        double3 p = double3_make( (double)o->position[i][0], (double)o->position[i][1], (double)o->position[i][2] );
        double3 previous =
            double3_make( (double)o->previous[i][0], (double)o->previous[i][1], (double)o->previous[i][2] );
        const double3 before = p;
        bool passes = false;
        const bool is_sure = o->position[i][3] == 0.0f || stay_alone( o, &p, &previous, &passes );
        p = o->position[i][3] == 0.0f ? before : p;
        const bool is_left = ( found->left >> i / 8 & 1u ) != 0;
        for ( int k = 0; k < 3 && ( is_left || o->position[i][3] == 0.0f ); ++k )
        {
            assert_true( has_bits( found->position[i][k], o->position[i][k] ) );
        }
        assert_true( passes == false || is_left );
        if ( is_sure && is_left == false )
        {
            const double tolerance = i / 8 == 5 ? 2e-5 : 3e-6; // some paths are long
            const float *x = found->position[i], *y = found->previous[i];
            assert_near_vector( double3_make( (double)x[0], (double)x[1], (double)x[2] ), p, tolerance, "position",
                                i );
            assert_near_vector( double3_make( (double)y[0], (double)y[1], (double)y[2] ), previous, tolerance,
                                "previous", i );
            met += double3_distance( p, before ) > 1e-4 ? 1 : 0;
        }
        // a surface in a lane has the bits that it has alone
        for ( int k = 0; k < 3 && is_left == false && ( found->left_lanes >> i % 8 & 1u ) == 0; ++k )
        {
            assert_true( has_bits( found->lanes[i / 8][k][i % 8], found->position[i][k] ) );
            assert_true( has_bits( found->lanes[i / 8][k][8 + i % 8], found->position[i][k] ) );
        }
    }
    assert_true( o->shape[0].kind == WISP_SHAPE_BOX || met > 0 || found->left != 0 );
}

TEST_KERNEL( particles_stay_outside_shapes_as_in_doubles, outside, SEEDS, 0, OUTSIDE, 0, fill_outside, run_outside,
             check_outside )

// ---- edges and triangles on their way into a shape ----

enum
{
    ENDS = 96,
    MEETING = 32, // edges, and triangles
};

typedef struct meetings
{
    outside o; // the first shape
    _Alignas( 64 ) float position[ENDS][4], previous[ENDS][4], place[ENDS][4];
    int32_t words[ENDS], words_now[ENDS];
    int32_t corners[3 * MEETING], listed[MEETING];
    wisp_primitive_meeting met[2][MEETING];
    int32_t near[2][MEETING], met_count[2], near_count[2];
} meetings;

static void fill_meetings( void* state, int seed )
{
    meetings* m = state;
    fill_shape( &m->o, 0, seed );
    for ( int i = 0; i < ENDS; ++i )
    {
        const int primitive = i / 3, key = seed * ENDS + i, of = 7 * ( seed * MEETING + primitive );
        const float size = primitive % 4 == 0 ? 0.05f : ( primitive % 4 == 1 ? 1.0f : 0.3f ),
                    speed = primitive % 5 == 0 ? 20.0f : 0.2f;
        for ( int k = 0; k < 3; ++k )
        {
            m->position[i][k] =
                test_random_float( of, k, -0.6f, 0.6f ) + size * test_random_float( key, k, -0.5f, 0.5f );
            m->previous[i][k] = m->position[i][k] + speed * THICKNESS *
                                                        ( test_random_float( of, 3 + k, -1.0f, 1.0f ) +
                                                          test_random_float( key, 3 + k, -0.1f, 0.1f ) );
        }
        m->corners[i] = i;
        m->listed[primitive] = primitive;
    }
}

static void run_meetings( const wisp_kernels* kernels, void* state, int begin, int end )
{
    (void)begin;
    (void)end;
    meetings* m = state;
    const bool blunt = false;
    const wisp_clear_args clear = { .position = m->position[0],
                                    .previous = m->previous[0],
                                    .shapes = m->o.shapes,
                                    .count = m->o.shapes[0].kind == WISP_SHAPE_PLANE ? 0 : 1,
                                    .place = m->place[0],
                                    .ahead = 1.25f,
                                    .blunt = &blunt,
                                    .away = 0.5f,
                                    .words = m->words };
    kernels->clear_particles( &clear, 0, ENDS );
    for ( int is_triangle = 0; is_triangle < 2 && clear.count > 0; ++is_triangle )
    {
        wisp_primitive_paths paths = { m->position[0], m->previous[0], m->corners, 2 + is_triangle,
                                       m->place[0],    m->words,       0.5f };
        // what is listed for the step, and of that what is left in the substep
        int32_t listed[MEETING], looks[MEETING];
        const int count = kernels->list_near_primitives( &paths, 0, MEETING, listed );
        wisp_clear_args clear_now = clear;
        clear_now.place = NULL;
        clear_now.words = m->words_now;
        kernels->clear_particles( &clear_now, 0, ENDS );
        paths.place = NULL;
        paths.words = m->words_now;
        m->near_count[is_triangle] =
            kernels->select_near_primitives( &paths, listed, count, m->near[is_triangle], looks );
        m->met_count[is_triangle] =
            kernels->meet_shape( &paths, m->o.shapes, NULL, m->listed, MEETING, m->met[is_triangle] );
    }
}

// Corners at a time, seen from the shape.
static void corners_seen( const meetings* m, int primitive, int count, double time, double3* out )
{
    for ( int k = 0; k < count; ++k )
    {
        const int32_t slot = m->corners[primitive * count + k];
        const double3 from = double3_widen(
                          wisp_transform_to_local( m->o.before[0], wisp_v3_load( m->previous[slot] ) ) ),
                      to = double3_widen(
                          wisp_transform_to_local( m->o.after[0], wisp_v3_load( m->position[slot] ) ) );
        out[k] = double3_add_scaled( from, time, double3_sub( to, from ) );
    }
}

// The least distance of the border of a triangle, or of the ends of an edge.
static double least_of_border( const deepest_oracle_body* body, const double3* p, int count )
{
    double least = INFINITY;
    for ( int k = 0; k < count; ++k )
    {
        const double3 side[2] = { p[k], p[( k + 1 ) % count] };
        least = fmin( least, count == 3 ? deepest_oracle_find( body, side, 2, NULL )
                                        : deepest_oracle_distance( body, p[k] ) );
    }
    return least;
}

static double displacement_of( const double3* from, const double3* to, int count )
{
    double most = 0.0;
    for ( int k = 0; k < count; ++k )
    {
        most = fmax( most, double3_distance( from[k], to[k] ) );
    }
    return most;
}

static void check_met( const meetings* m, const deepest_oracle_body* body, const wisp_primitive_meeting* met,
                       int count, double limit )
{
    const double h = (double)THICKNESS, rounding = 3e-6;
    double3 p[3], at = { 0 };
    corners_seen( m, met->primitive, count, (double)met->time, p );
    for ( int k = 0; k < count; ++k )
    {
        at = double3_add_scaled( at, (double)met->weights[k], p[k] );
        assert_true( count == 2 || met->weights[k] >= 0.00999f );
    }
    const double distance = deepest_oracle_distance( body, at ), least = deepest_oracle_find( body, p, count, NULL );
    if ( !( fabs( distance - least ) <= 0.005 * h + rounding ) )
    {
        fail_msg( "kind %d, %d corners, primitive %d, time %g: %.9g, expected %.9g", (int)body->kind, count,
                  met->primitive, (double)met->time, distance, least );
    }
    assert_true( distance < ( met->time < 1.0f ? h : limit ) + rounding ); // an advance may end before it is stopped
}

static void check_not_met( const meetings* m, const deepest_oracle_body* body, int primitive, int count,
                           double limit )
{
    const double h = (double)THICKNESS, rounding = 3e-6;
    double3 ends[2][3];
    corners_seen( m, primitive, count, 0.0, ends[0] );
    corners_seen( m, primitive, count, 1.0, ends[1] );
    const double between = 0.125 * displacement_of( ends[0], ends[1], count );
    bool is_left = false; // a triangle whose border has come near first is left to its edges
    for ( int i = 0; i <= 8; ++i )
    {
        double3 p[3];
        corners_seen( m, primitive, count, 0.125 * (double)i, p );
        const double least = deepest_oracle_find( body, p, count, NULL ),
                     expected = i == 8 ? limit - 0.005 * h : 0.1 * h;
        // a border is no nearer than the triangle, and its search takes most of the time
        const bool has_border = count == 3 && least < fmax( 0.1 * h + between, expected );
        const double border = has_border ? least_of_border( body, p, 3 ) : INFINITY;
        // what is on the border of a triangle belongs to its edges; a border is a hundredth wide
        const bool is_border = border <= least + 0.02 * displacement_of( p, p + 1, 2 ) + rounding;
        is_left = is_left || border < 0.1 * h + between;
        if ( is_border == false && is_left == false && least < expected - rounding )
        {
            fail_msg( "kind %d, %d corners, primitive %d, time %d/8: %.9g, expected %.9g at least, border %.9g",
                      (int)body->kind, count, primitive, i, least, expected, border );
        }
    }
}

static void check_meetings( void* start, void* end )
{
    const meetings* m = end;
    (void)start;
    const deepest_oracle_body body = deepest_oracle_body_of( m->o.shape );
    const double h = (double)THICKNESS;
    for ( int count = 2; count <= 3 && body.kind != WISP_SHAPE_PLANE; ++count )
    {
        const wisp_primitive_meeting* met = m->met[count - 2];
        const int32_t* near = m->near[count - 2];
        for ( int i = 0, n = 0, listed = 0; i < MEETING; ++i )
        {
            double3 from[3], to[3];
            corners_seen( m, i, count, 0.0, from );
            corners_seen( m, i, count, 1.0, to );
            double corner = INFINITY;
            for ( int k = 0; k < count; ++k )
            {
                corner = fmin( corner, deepest_oracle_distance( &body, to[k] ) );
            }
            const double limit = fmin( corner - 0.05 * h, 2.0 * h + displacement_of( from, to, count ) );
            const bool is_met = n < m->met_count[count - 2] && met[n].primitive == i,
                       is_near = listed < m->near_count[count - 2] && near[listed] == i;
            is_met ? check_met( m, &body, met + n, count, limit ) : check_not_met( m, &body, i, count, limit );
            assert_true( is_near || is_met == false );
            n += is_met ? 1 : 0;
            listed += is_near ? 1 : 0;
        }
    }
}

TEST_KERNEL( edges_and_triangles_meet_shapes_as_in_doubles, meetings, 3 * KINDS, 0, 1, 0, fill_meetings, run_meetings,
             check_meetings )
