// Contacts of a block of particles against contacts found one by one: particles that are left out early must have
// none. Every kind of body, at rest, translating and rotating; particles around them, in them, and exactly at the
// limit of the search distance. The deepest point of segments and triangles in convex bodies, against samples in double
// precision.
#include "collision_fixture.h"
#include "surface_fixture.h"

#include "body_queries.h"
#include "particle_contacts.h"
#include "primitive_contacts.h"
#include "kernel_tables.h"
#include "oracle/contact_oracle.h"

#include "wisp/module/shapes.h"

// ---- one by one ----

typedef struct find_one
{
    const collision_find_args* args;
    const collision_view* view;
    int slot;
    wisp_vec3 from, to; // in the body's frame
    float path;
} find_one;

static void one_lowers_clear( const find_one* one, float clear )
{
    float* found = one->args->found + (size_t)one->slot * 4;
    found[3] = clear < found[3] ? clear : found[3];
}

static float one_gap( const collision_contact* c, wisp_vec3 p )
{
    return wisp_v3_dot( wisp_v3_load( c->normal ), wisp_v3_sub( p, wisp_v3_load( c->point ) ) ) - c->gap;
}

static void one_keeps( const find_one* one, const collision_contact* c )
{
    collision_contact* all = one->args->contact[one->slot];
    const wisp_vec3 p = wisp_v3_load( one->args->position + (size_t)one->slot * 4 );
    int place = one->args->count[one->slot]++;
    if ( place >= WISP_COLLISION_CONTACTS )
    {
        place = 0;
        for ( int i = 1; i < WISP_COLLISION_CONTACTS; ++i )
        {
            place = one_gap( all + i, p ) > one_gap( all + place, p ) ? i : place;
        }
        if ( one_gap( c, p ) >= one_gap( all + place, p ) )
        {
            return;
        }
    }
    all[place] = *c;
}

static void one_moves_out( const find_one* one, wisp_vec3 normal, float recovered, float absorbed )
{
    float *p = one->args->position + (size_t)one->slot * 4, *old = one->args->previous + (size_t)one->slot * 4;
    collision_store( p, wisp_v3_mul_add( wisp_v3_load( p ), recovered, normal ) );
    collision_store( old, wisp_v3_mul_add( wisp_v3_load( old ), recovered + absorbed, normal ) );
}

static void one_touches( const find_one* one, const wisp_surface_point* nearest )
{
    const collision_view* view = one->view;
    wisp_surface_point plane;
    wisp_vec3 motion = { 0.0f, 0.0f, 0.0f };
    bool swept =
        fabsf( nearest->distance ) <= one->path && collision_cast( view, one->from, one->to, &plane, &motion );
    plane = swept ? plane : *nearest;
    one_lowers_clear( one, swept ? 0.0f : ( nearest->distance > 0.0f ? nearest->distance : INFINITY ) );
    float now = swept ? wisp_v3_dot( plane.normal, wisp_v3_sub( one->to, plane.point ) ) : nearest->distance;
    if ( now > 2.0f * view->thickness + one->path )
    {
        return;
    }
    float start = collision_start_gap( view, &plane, one->from, motion, swept, -1 );
    float outward = fmaxf( 0.0f, now - view->thickness - start ), recovered = 0.0f;
    if ( start + outward < 0.0f )
    {
        recovered = fminf( -start - outward, fmaxf( 0.0f, one->args->recovery - outward ) );
    }
    const wisp_vec3 normal = wisp_quat_rotate( view->after.rotation, plane.normal );
    const wisp_vec3 point = wisp_transform_to_world( view->after, plane.point );
    collision_contact c = {
        .gap = start < 0.0f ? view->thickness + start + recovered : view->thickness,
        .static_friction = view->static_friction,
        .kinetic_friction = view->kinetic_friction,
    };
    collision_store( c.point, point );
    collision_store( c.normal, normal );
    collision_store( c.motion, wisp_v3_sub( point, wisp_transform_to_world( view->before, plane.point ) ) );
    one_moves_out( one, normal, recovered, start < -COLLISION_SHALLOW * view->thickness ? outward : 0.0f );
    one_keeps( one, &c );
}

static float one_box_distance( const collision_body* body, wisp_vec3 p )
{
    const wisp_vec3 d = wisp_v3_sub( p, body->centre );
    return wisp_v3_length( ( wisp_vec3 ){
        fmaxf( 0.0f, fabsf( d.x ) - body->half.x ),
        fmaxf( 0.0f, fabsf( d.y ) - body->half.y ),
        fmaxf( 0.0f, fabsf( d.z ) - body->half.z ),
    } );
}

static void one_meets( const collision_find_args* args, const collision_view* view, int slot )
{
    const wisp_vec3 old = wisp_v3_load( args->previous + (size_t)slot * 4 );
    const wisp_vec3 now = wisp_v3_load( args->position + (size_t)slot * 4 );
    find_one one = {
        args, view, slot, wisp_transform_to_local( view->before, old ), wisp_transform_to_local( view->after, now ),
        0.0f
    };
    one.path = wisp_v3_length( wisp_v3_sub( one.to, one.from ) );
    const wisp_mesh_query query = { .point = one.to, .radius = 2.0f * view->thickness + one.path };
    wisp_surface_point nearest;
    bool is_near = false;
    if ( one_box_distance( view->body, one.to ) <= query.radius )
    {
        collision_closest( view, &query, 1, &nearest, &is_near, NULL );
    }
    if ( is_near )
    {
        one_touches( &one, &nearest );
    }
    else
    {
        one_lowers_clear( &one, query.radius );
    }
}

static bool one_moves( const collision_find_args* args, int slot )
{
    const float *quad = args->position + (size_t)slot * 4, *old = args->previous + (size_t)slot * 4;
    return quad[3] > 0.0f && collision_is_finite( wisp_v3_load( quad ) ) &&
           collision_is_finite( wisp_v3_load( old ) );
}

/// All bodies for one block of slots, in their order. The block matters: if a body is beyond reach of the whole
/// block, its distance to each particle is taken as the distance to the block's box.
static void find_one_by_one( const collision_find_args* args, const collision_view* views, int view_count, int begin,
                             int end )
{
    wisp_vec3 lower = { INFINITY, INFINITY, INFINITY }, upper = { -INFINITY, -INFINITY, -INFINITY };
    for ( int slot = begin; slot < end; ++slot )
    {
        args->count[slot] = 0;
        collision_store( args->found + (size_t)slot * 4, wisp_v3_load( args->position + (size_t)slot * 4 ) );
        args->found[(size_t)slot * 4 + 3] = INFINITY;
        if ( one_moves( args, slot ) )
        {
            collision_widen( &lower, &upper, wisp_v3_load( args->position + (size_t)slot * 4 ) );
            collision_widen( &lower, &upper, wisp_v3_load( args->previous + (size_t)slot * 4 ) );
        }
    }
    bool moves[COLLISION_BLOCK]; // before any body moved anything
    for ( int slot = begin; slot < end; ++slot )
    {
        moves[slot - begin] = one_moves( args, slot );
    }
    for ( int v = 0; v < view_count; ++v )
    {
        const float apart = collision_ball_distance( views + v, lower, upper );
        const bool is_far = apart > 2.0f * views[v].thickness;
        for ( int slot = begin; slot < end; ++slot )
        {
            const find_one one = { .args = args, .view = views + v, .slot = slot };
            if ( moves[slot - begin] && is_far )
            {
                one_lowers_clear( &one, apart );
            }
            else if ( moves[slot - begin] )
            {
                one_meets( args, views + v, slot );
            }
        }
    }
}

enum
{
    PARTICLES = 3 * COLLISION_BLOCK + 72, // the last block is not full
    BODIES = 7,
    TRIALS = 12,
    MOTIONS = 3,
};

static const float THICKNESS = 0.0125f;

typedef struct particles
{
    float position[PARTICLES][4], previous[PARTICLES][4], found[PARTICLES][4];
    int32_t count[PARTICLES];
    collision_contact contact[PARTICLES][WISP_COLLISION_CONTACTS];
} particles;

typedef struct meeting
{
    hosted* h;
    collision_state* state;
    particles *blocks, *singly; // found in blocks, and one by one
    collision_view views[BODIES];
} meeting;

// ---- bodies ----

static void add_shape( wisp_world* world, wisp_collider_kind kind, float radius, wisp_vec3 half )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = kind;
    def.radius = radius;
    def.half_length = 0.25f;
    def.half_extent = half;
    add_collider( world, &def );
}

static void add_mesh( wisp_world* world, test_mesh mesh, float scale, wisp_vec3 by, bool double_sided )
{
    move_mesh( &mesh, scale, by );
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_MESH;
    def.points = mesh.points;
    def.triangles = mesh.triangles;
    def.point_count = mesh.vertex_count;
    def.triangle_count = mesh.triangle_count;
    def.double_sided = double_sided;
    add_collider( world, &def );
    test_mesh_free( &mesh );
}

// The last is a small ball that blocks are far away from.
static meeting* new_meeting( void )
{
    meeting* m = checked_calloc( 1, sizeof( *m ) );
    m->h = new_colliding( 1, 1, 1 );
    m->blocks = calloc( 1, sizeof( particles ) );
    m->singly = calloc( 1, sizeof( particles ) );
    assert_true( m->blocks != NULL && m->singly != NULL );
    wisp_world* world = m->h->world;
    const wisp_vec3 none = { 1.0f, 1.0f, 1.0f }, half = { 0.4f, 0.15f, 0.3f };
    add_shape( world, WISP_COLLIDER_PLANE, 1.0f, none );
    add_shape( world, WISP_COLLIDER_SPHERE, 0.35f, none );
    add_shape( world, WISP_COLLIDER_CAPSULE, 0.2f, none );
    add_shape( world, WISP_COLLIDER_BOX, 0.01f, half );
    add_mesh( world, test_ball( 2 ), 0.3f, ( wisp_vec3 ){ 0.1f, 0.0f, 0.0f }, false );
    add_mesh( world, test_plane( 3, 0.4f ), 1.0f, ( wisp_vec3 ){ -0.4f, 0.1f, -0.4f }, true );
    add_shape( world, WISP_COLLIDER_SPHERE, 0.05f, none );
    m->state = wisp_world_module_state( world, "collision" );
    assert_int_equal( m->state->body_count, BODIES );
    return m;
}

static void free_meeting( meeting* m )
{
    free_colliding( m->h );
    free( m->blocks );
    free( m->singly );
    free( m );
}

// A body is at rest, translates, or translates and rotates; every fourth has the axes of the world and is at the
// origin, so that nothing is rounded on the way into its frame.
static void place_bodies( meeting* m, int trial )
{
    for ( int b = 0; b < BODIES; ++b )
    {
        const int key = trial * BODIES + b, motion = ( trial + b ) % MOTIONS;
        const float far = b == BODIES - 1 ? 4.0f : 0.0f;
        const bool plain = ( trial / MOTIONS + b ) % 4 == 0;
        float r[8];
        for ( int k = 0; k < 8; ++k )
        {
            r[k] = test_random_float( key, 100 + k, -0.5f, 0.5f );
        }
        wisp_transform before = wisp_transform_make( ( wisp_quat ){ r[0], r[1], r[2], 1.0f },
                                                     ( wisp_vec3 ){ far + 0.4f * r[3], 0.4f * r[4], 0.4f * r[5] } );
        before =
            plain ? wisp_transform_make( ( wisp_quat ){ 0.0f, 0.0f, 0.0f, 1.0f }, ( wisp_vec3 ){ far, 0.0f, 0.0f } )
                  : before;
        wisp_transform after = before;
        after.translation.x += motion > 0 ? 0.05f * r[6] : 0.0f;
        after.translation.y += motion > 0 ? 0.05f * r[7] : 0.0f;
        const wisp_quat q = before.rotation;
        after = motion < 2 ? after
                           : wisp_transform_make( ( wisp_quat ){ q.x, q.y + 0.05f, q.z, q.w }, after.translation );
        m->views[b] = ( collision_view ){
            .body = m->state->bodies + b,
            .before = before,
            .after = after,
            .thickness = THICKNESS,
            .static_friction = 0.5f,
            .kinetic_friction = 0.3f,
        };
    }
}

// ---- particles ----

// Where the closest point is at the search distance, up to the last bits.
static bool place_at_limit( const collision_view* view, int i, wisp_vec3* old, wisp_vec3* now )
{
    const wisp_vec3 q = wisp_transform_to_local( view->after, *now ), way = wisp_v3_sub( *now, *old );
    const wisp_mesh_query query = { .point = q, .radius = 2.0f };
    wisp_surface_point s;
    bool is_near;
    collision_closest( view, &query, 1, &s, &is_near, NULL );
    if ( is_near == false )
    {
        return false;
    }
    const float bits = (float)( test_random( i, 20, 9 ) - 4 ) * FLT_EPSILON;
    const float limit = ( 2.0f * view->thickness + wisp_v3_length( way ) ) * ( 1.0f + bits );
    const wisp_vec3 to = wisp_v3_mul_add( s.point, limit, s.normal );
    *now = wisp_transform_to_world( view->after, to );
    *old = wisp_transform_to_world( view->before, wisp_v3_sub( to, way ) );
    return true;
}

// Number of particles at the limit.
static int place_particle( const meeting* m, int trial, int slot, float quad[4], float old_quad[4] )
{
    const int key = trial * PARTICLES + slot, manner = slot % 6;
    const float size = manner == 0 ? 1.2f : 0.5f, span = manner == 1 ? 0.5f : ( manner == 2 ? 0.0f : 0.02f );
    float r[6];
    for ( int k = 0; k < 6; ++k )
    {
        r[k] = test_random_float( key, k, -1.0f, 1.0f );
    }
    wisp_vec3 now = { size * r[0], size * r[1], size * r[2] };
    wisp_vec3 old = { now.x + span * r[3], now.y + span * r[4], now.z + span * r[5] };
    const int at_limit =
        manner >= 4 && place_at_limit( m->views + slot / 6 % ( BODIES - 1 ), key, &old, &now ) ? 1 : 0;
    collision_store( quad, now );
    collision_store( old_quad, old );
    quad[3] = slot % 19 == 0 ? 0.0f : 2.0f;
    old_quad[3] = 0.0f;
    quad[slot % 3] = slot % 29 == 0 ? NAN : quad[slot % 3];
    old_quad[slot % 3] = slot % 31 == 0 ? ( slot % 2 == 0 ? INFINITY : 2e9f ) : old_quad[slot % 3];
    return at_limit;
}

static int place_particles( meeting* m, int trial )
{
    int at_limit = 0;
    memset( m->blocks, 0, sizeof( particles ) );
    for ( int slot = 0; slot < PARTICLES; ++slot )
    {
        at_limit += place_particle( m, trial, slot, m->blocks->position[slot], m->blocks->previous[slot] );
    }
    memcpy( m->singly, m->blocks, sizeof( particles ) );
    return at_limit;
}

static collision_find_args job_on( particles* p )
{
    return ( collision_find_args ){
        .kernels = kernels_select( "avx512", NULL ),
        .position = p->position[0],
        .previous = p->previous[0],
        .count = p->count,
        .found = p->found[0],
        .contact = p->contact,
        .recovery = 0.002f,
    };
}

// ---- both methods ----

// @return the number of particles without a query, over all bodies
static int find_in_blocks( const meeting* m, particles* p, int first_body, int size )
{
    const collision_find_args args = job_on( p );
    int spared = 0;
    for ( int begin = 0; begin < PARTICLES; begin += size )
    {
        collision_block block;
        collision_begin_block( &args, begin, begin + size < PARTICLES ? begin + size : PARTICLES, &block );
        for ( int b = first_body; b < BODIES; ++b )
        {
            block.candidate_count = 0;
            collision_meet( &args, m->views + b, &block );
            spared += block.count - block.candidate_count;
        }
        collision_end_block( &args, &block );
    }
    return spared;
}

static void find_singly( const meeting* m, particles* p, int first_body )
{
    const collision_find_args args = job_on( p );
    for ( int begin = 0; begin < PARTICLES; begin += COLLISION_BLOCK )
    {
        const int end = begin + COLLISION_BLOCK < PARTICLES ? begin + COLLISION_BLOCK : PARTICLES;
        find_one_by_one( &args, m->views + first_body, BODIES - first_body, begin, end );
    }
}

static void assert_same( const particles* a, const particles* b, int trial )
{
    for ( int i = 0; i < PARTICLES; ++i )
    {
        if ( a->count[i] != b->count[i] || memcmp( a->position[i], b->position[i], sizeof( a->position[i] ) ) != 0 ||
             memcmp( a->previous[i], b->previous[i], sizeof( a->previous[i] ) ) != 0 ||
             memcmp( a->found[i], b->found[i], sizeof( a->found[i] ) ) != 0 ||
             memcmp( a->contact[i], b->contact[i], sizeof( a->contact[i] ) ) != 0 )
        {
            fail_msg( "trial %d: particle %d has %d contacts and is clear for %.9g, one by one %d and %.9g", trial, i,
                      a->count[i], (double)a->found[i][3], b->count[i], (double)b->found[i][3] );
        }
    }
}

TEST( a_block_finds_what_is_found_one_by_one )
{
    meeting* m = new_meeting();
    int at_limit = 0, spared = 0, met = 0, crowded = 0;
    for ( int trial = 0; trial < TRIALS; ++trial )
    {
        place_bodies( m, trial );
        at_limit += place_particles( m, trial );
        spared += find_in_blocks( m, m->blocks, 0, COLLISION_BLOCK );
        find_singly( m, m->singly, 0 );
        assert_same( m->blocks, m->singly, trial );
        for ( int i = 0; i < PARTICLES; ++i )
        {
            met += m->blocks->count[i] > 0 ? 1 : 0;
            crowded += m->blocks->count[i] > WISP_COLLISION_CONTACTS ? 1 : 0;
        }
    }
    // of 10 140 particles, which means 70 980 queries
    assert_true( at_limit > 2000 && spared > 20000 && met > 2000 && crowded > 20 );
    free_meeting( m );
}

// Alone, so that at a limit nothing else is met; on both sides of it, so that it is a limit.
TEST( each_kind_of_body_is_exact_at_its_limit )
{
    meeting* m = new_meeting();
    for ( int b = 0; b + 1 < BODIES; ++b )
    {
        int met = 0, missed = 0;
        for ( int trial = 0; trial < TRIALS; ++trial )
        {
            place_bodies( m, trial );
            m->views[BODIES - 1] = m->views[b];
            place_particles( m, trial );
            find_in_blocks( m, m->blocks, BODIES - 1, COLLISION_BLOCK );
            find_singly( m, m->singly, BODIES - 1 );
            assert_same( m->blocks, m->singly, trial );
            for ( int i = 0; i < PARTICLES; ++i )
            {
                const bool at_limit = i % 6 >= 4 && i / 6 % ( BODIES - 1 ) == b && m->blocks->position[i][3] > 0.0f;
                met += at_limit && m->blocks->count[i] > 0 ? 1 : 0;
                missed += at_limit && m->blocks->count[i] == 0 ? 1 : 0;
            }
        }
        assert_true( met > 50 && missed > 50 );
    }
    free_meeting( m );
}

// A rotating body is queried particle by particle, wherever the block is, so that no border can show.
TEST( contacts_do_not_depend_on_where_blocks_begin )
{
    static const int SIZES[] = { 8, 24, 64, 248 };
    meeting* m = new_meeting();
    place_bodies( m, 1 );
    for ( int b = 0; b < BODIES; ++b )
    {
        const wisp_transform to = m->views[b].after;
        m->views[b].after = wisp_transform_make( ( wisp_quat ){ 0.1f, 0.2f, (float)b, 1.0f }, to.translation );
    }
    for ( int k = 0; k < WISP_COUNT( SIZES ); ++k )
    {
        place_particles( m, 1 );
        find_in_blocks( m, m->blocks, 0, COLLISION_BLOCK );
        find_in_blocks( m, m->singly, 0, SIZES[k] );
        assert_same( m->blocks, m->singly, SIZES[k] );
    }
    free_meeting( m );
}

// ---- particles without contact ----

// Queried without any bounding box or ball: the closest point of every body, and the path to it.
static void assert_clear( const meeting* m, const particles* before, const particles* p, int i )
{
    const wisp_vec3 now = wisp_v3_load( before->position[i] ), old = wisp_v3_load( before->previous[i] );
    for ( int b = 0; b < BODIES; ++b )
    {
        const collision_view* view = m->views + b;
        const wisp_mesh_query query = { .point = wisp_transform_to_local( view->after, now ), .radius = INFINITY };
        wisp_surface_point nearest, hit;
        wisp_vec3 motion;
        bool is_near;
        collision_closest( view, &query, 1, &nearest, &is_near, NULL );
        const wisp_vec3 from = wisp_transform_to_local( view->before, old );
        // 1e-6 of the metre between positions: rounding of two poses
        if ( ( is_near && nearest.distance < p->found[i][3] - 1e-6f ) ||
             ( nearest.distance > 1e-6f && collision_cast( view, from, query.point, &hit, &motion ) ) )
        {
            fail_msg( "particle %d is said to be clear for %.9g, but body %d is at %.9g", i, (double)p->found[i][3],
                      b, (double)nearest.distance );
        }
    }
}

TEST( who_has_no_contact_is_as_clear_as_it_says )
{
    meeting* m = new_meeting();
    int clear = 0;
    for ( int trial = 0; trial < TRIALS; ++trial )
    {
        place_bodies( m, trial );
        place_particles( m, trial );
        // the smaller a block, the farther its particles are from bodies as a whole
        find_in_blocks( m, m->blocks, 0, trial % 2 == 0 ? 8 : COLLISION_BLOCK );
        const collision_find_args args = job_on( m->singly );
        for ( int i = 0; i < PARTICLES; ++i )
        {
            if ( one_moves( &args, i ) && m->blocks->count[i] == 0 )
            {
                assert_clear( m, m->singly, m->blocks, i );
                ++clear;
            }
        }
    }
    assert_true( clear > 1000 );
    free_meeting( m );
}

// ---- deepest points ----

static uint32_t seed;

static double random_in( double lower, double upper )
{
    seed = seed * 1664525u + 1013904223u;
    return lower + ( upper - lower ) * (double)( seed >> 8 ) / 16777216.0;
}

static wisp_vec3 random_point( double size )
{
    return ( wisp_vec3 ){ (float)random_in( -size, size ), (float)random_in( -size, size ),
                          (float)random_in( -size, size ) };
}

// Compare a primitive. Exact is what the tolerance and single precision leave.
static void compare( const wisp_shape* shape, const deepest_oracle_body* body, const wisp_vec3* corners, int count,
                     double tolerance )
{
    collision_deepest found;
    assert_true( collision_find_deepest( shape, corners, count, (float)tolerance, &found ) );
    double3 wide[3];
    double3 at = { 0.0, 0.0, 0.0 };
    double sum = 0.0, corner = INFINITY;
    for ( int k = 0; k < count; ++k )
    {
        wide[k] = double3_widen( corners[k] );
        assert_true( found.weights[k] >= 0.0f );
        at = double3_add_scaled( at, (double)found.weights[k], wide[k] );
        sum += (double)found.weights[k];
        corner = fmin( corner, deepest_oracle_distance( body, wide[k] ) );
    }
    const double rounding = 1e-6;
    const double least = deepest_oracle_find( body, wide, count, NULL );
    assert_near( sum, 1.0, rounding );
    float nearest;
    const float bound = collision_bound_deepest( shape, corners, count, &nearest );
    assert_near( (double)nearest, corner, rounding );
    assert_true( (double)bound <= least + rounding );
    // the distance is that of the point with these weights
    assert_near( (double)found.surface.distance, deepest_oracle_distance( body, at ), rounding );
    // and not above the smallest one by more than the tolerance
    if ( (double)found.surface.distance > least + tolerance + rounding )
    {
        fail_msg( "kind %d, %d corners: got %g, expected %g", (int)shape->kind, count, (double)found.surface.distance,
                  least );
    }
}

static void compare_many( const wisp_shape* shape, const deepest_oracle_body* body, int rounds )
{
    static const double sizes[] = { 0.02, 0.1, 0.5, 2.0 };
    for ( int n = 0; n < rounds; ++n )
    {
        const wisp_vec3 near = random_point( 1.0 );
        const double size = sizes[n % WISP_COUNT( sizes )];
        wisp_vec3 corners[3];
        for ( int k = 0; k < 3; ++k )
        {
            corners[k] = wisp_v3_mul_add( near, 1.0f, random_point( size ) );
        }
        compare( shape, body, corners, 2, 1e-4 );
        compare( shape, body, corners, 3, 1e-4 );
    }
}

TEST( the_deepest_point_is_that_of_samples_in_each_closed_form )
{
    seed = 7;
    const wisp_shape shapes[] = {
        { .kind = WISP_SHAPE_SPHERE, .radius = 0.4f },
        { .kind = WISP_SHAPE_CAPSULE, .radius = 0.1f, .half_length = 0.6f },
        { .kind = WISP_SHAPE_CAPSULE, .radius = 0.001f, .half_length = 0.6f },
        { .kind = WISP_SHAPE_BOX, .half_extent = { 0.3f, 0.5f, 0.2f } },
        { .kind = WISP_SHAPE_TAPERED_CAPSULE, .top_radius = 0.1f, .bottom_radius = 0.3f, .half_length = 0.5f },
    };
    for ( int i = 0; i < WISP_COUNT( shapes ); ++i )
    {
        const deepest_oracle_body body = deepest_oracle_body_of( shapes + i );
        compare_many( shapes + i, &body, shapes[i].kind == WISP_SHAPE_TAPERED_CAPSULE ? 8 : 80 );
    }
}

TEST( the_deepest_point_is_that_of_samples_in_a_convex_polyhedron )
{
    seed = 11;
    SCOPED( test_mesh_free ) test_mesh ball = test_ball( 0 );
    for ( int v = 0; v < ball.vertex_count; ++v )
    {
        const wisp_vec3 p = ball.points[v];
        ball.points[v] = ( wisp_vec3 ){ 0.5f * p.x + 0.1f * p.y, 0.3f * p.y, 0.4f * p.z };
    }
    wisp_convex* convex;
    assert_int_equal( wisp_convex_create( ball.points, ball.vertex_count, NULL, &convex, NULL ), WISP_OK );
    const wisp_shape shape = { .kind = WISP_SHAPE_CONVEX, .convex = convex };
    const deepest_oracle_body body = { .kind = WISP_SHAPE_CONVEX,
                                       .points = ball.points,
                                       .triangles = ball.triangles,
                                       .triangle_count = ball.triangle_count };
    compare_many( &shape, &body, 60 );
    wisp_convex_release( convex );
}

// The hard cases: parallel to an axis or a face, through the middle, degenerate.
TEST( flat_and_degenerate_primitives_have_a_deepest_point )
{
    const wisp_shape shapes[] = {
        { .kind = WISP_SHAPE_SPHERE, .radius = 0.4f },
        { .kind = WISP_SHAPE_CAPSULE, .radius = 0.1f, .half_length = 0.5f },
        { .kind = WISP_SHAPE_BOX, .half_extent = { 0.3f, 0.5f, 0.2f } },
    };
    static const wisp_vec3 cases[][3] = {
        { { -1, 0, 0 }, { 1, 0, 0 }, { 0, 0, 1 } },                           // through the middle
        { { 0, -1, 0 }, { 0, 1, 0 }, { 0.5f, 0, 0 } },                        // along the axis of the capsule
        { { -1, 0.5f, -1 }, { 1, 0.5f, -1 }, { 0, 0.5f, 1 } },                // in the plane of a face
        { { -1, 0.6f, -1 }, { 1, 0.6f, -1 }, { 0, 0.6f, 1 } },                // parallel to it
        { { 0.3f, 0.5f, 0.2f }, { 0.3f, 0.5f, 0.2f }, { 0.3f, 0.5f, 0.2f } }, // a point, the corner of the box
        { { 1, 1, 1 }, { 1, 1, 1 }, { -1, -1, -1 } },                         // a line
        { { -1, 0.7f, 0.2f }, { 0, 0.7f, 0.2f }, { 1, 0.7f, 0.2f } },
    };
    for ( int i = 0; i < WISP_COUNT( shapes ); ++i )
    {
        const deepest_oracle_body body = deepest_oracle_body_of( shapes + i );
        for ( int n = 0; n < WISP_COUNT( cases ); ++n )
        {
            compare( shapes + i, &body, cases[n], 2, 1e-4 );
            compare( shapes + i, &body, cases[n], 3, 1e-4 );
        }
    }
}

TEST( what_is_not_finite_has_no_deepest_point )
{
    const wisp_shape ball = { .kind = WISP_SHAPE_SPHERE, .radius = 0.4f };
    collision_deepest found;
    const wisp_vec3 corners[3] = { { 0, 1, 0 }, { NAN, 0, 0 }, { 1, 0, INFINITY } };
    assert_false( collision_find_deepest( &ball, corners, 2, 1e-4f, &found ) );
    assert_false( collision_find_deepest( &ball, corners, 3, 1e-4f, &found ) );
}
