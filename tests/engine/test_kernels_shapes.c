// Kernels of contact with shapes in closed form: closest points have the bits of wisp_shape_closest() and the values of
// the formulas in doubles, for sizes of zero, points at centres and far away. Half spaces, with friction and without,
// are those of scalar code, bit for bit, in every table.
#include "kernels_fixture.h"

#include "wisp/module/shapes.h"

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
