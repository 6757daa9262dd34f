// Roots on the triangles of a surface: where they are nearest, and how the triangles carry them. The surface has moved when
// strands run their substeps, so each substep takes its share of the way from where the triangle was a step before.
#include "strands_internal.h"

#include <string.h>

typedef struct triangle
{
    wisp_vec3 corner[3];
} triangle;

static const wisp_quat NO_JUMP = { 0.0f, 0.0f, 0.0f, 0.0f };

static wisp_vec3 scale( wisp_vec3 v, float s )
{
    return ( wisp_vec3 ){ s * v.x, s * v.y, s * v.z };
}

static float dot( wisp_vec3 a, wisp_vec3 b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static wisp_vec3 cross( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

static wisp_vec3 weigh( const triangle* t, const float weights[3] )
{
    const wisp_vec3 ab = strands_add( scale( t->corner[0], weights[0] ), scale( t->corner[1], weights[1] ) );
    return strands_add( ab, scale( t->corner[2], weights[2] ) );
}

// The rotation whose columns are x along the first edge, y, and z along the normal. @return false without an area
static bool frame_of( const triangle* t, wisp_quat* out )
{
    const wisp_vec3 edge = strands_sub( t->corner[1], t->corner[0] );
    const wisp_vec3 normal = cross( edge, strands_sub( t->corner[2], t->corner[0] ) );
    const float length = strands_norm( edge ), area = strands_norm( normal );
    if ( !( length > 0.0f && area > 0.0f ) )
    {
        return false;
    }
    const wisp_vec3 x = scale( edge, 1.0f / length ), z = scale( normal, 1.0f / area ), y = cross( z, x );
    // of the four ways to read the quaternion off, the one that divides by the largest
    wisp_quat q = { y.z - z.y, z.x - x.z, x.y - y.x, 1.0f + x.x + y.y + z.z };
    if ( q.w < 1.0f && x.x >= y.y && x.x >= z.z )
    {
        q = ( wisp_quat ){ 1.0f + x.x - y.y - z.z, x.y + y.x, z.x + x.z, y.z - z.y };
    }
    else if ( q.w < 1.0f && y.y >= z.z )
    {
        q = ( wisp_quat ){ x.y + y.x, 1.0f + y.y - x.x - z.z, y.z + z.y, z.x - x.z };
    }
    else if ( q.w < 1.0f )
    {
        q = ( wisp_quat ){ z.x + x.z, y.z + z.y, 1.0f + z.z - x.x - y.y, x.y - y.x };
    }
    *out = wisp_rigid_make( q, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ).rotation;
    return true;
}

// ---- the pass ----

typedef struct anchor_columns
{
    const int32_t* slot;
    const float *weight, *turn;
    float *corner, *jump;
    float *root, *rotation;
    const float* particles; // of the surface; null: it was removed
} anchor_columns;

static triangle get_corners( const float* corner, int group, int lane )
{
    return ( triangle ){ { strands_get( corner, 3 * group, lane ), strands_get( corner, 3 * group + 1, lane ),
                           strands_get( corner, 3 * group + 2, lane ) } };
}

static void put_corners( float* corner, int group, int lane, const triangle* t )
{
    for ( int k = 0; k < 3; ++k )
    {
        strands_put( corner, 3 * group + k, lane, t->corner[k] );
    }
}

// The triangle as the surface has it now. One that is not finite stays where it was: its own guard deals with it.
static triangle triangle_now( const anchor_columns* c, int group, int lane, const triangle* before )
{
    triangle now = *before;
    for ( int k = 0; k < 3 && c->particles != NULL; ++k )
    {
        const float* p = c->particles + (size_t)c->slot[strands_vector( group, lane ) + (size_t)k * WISP_LANES] * 4;
        if ( !( fabsf( p[0] ) <= 1e6f && fabsf( p[1] ) <= 1e6f && fabsf( p[2] ) <= 1e6f ) )
        {
            return *before;
        }
        now.corner[k] = ( wisp_vec3 ){ p[0], p[1], p[2] };
    }
    return now;
}

static triangle between( const triangle* from, const triangle* to, float time )
{
    triangle t = *to;
    for ( int k = 0; k < 3 && time < 1.0f; ++k )
    {
        t.corner[k] = strands_add( from->corner[k], scale( strands_sub( to->corner[k], from->corner[k] ), time ) );
    }
    return t;
}

static void get_weights( const anchor_columns* c, int group, int lane, float weights[3] )
{
    const wisp_vec3 w = strands_get( c->weight, group, lane );
    weights[0] = w.x;
    weights[1] = w.y;
    weights[2] = w.z;
}

static wisp_rigid pose_on( const anchor_columns* c, const triangle* t, int group, int lane )
{
    float weights[3];
    get_weights( c, group, lane, weights );
    wisp_quat frame;
    wisp_rigid pose = { strands_get_quat( c->rotation, group, lane ), weigh( t, weights ) };
    if ( frame_of( t, &frame ) )
    {
        pose.rotation = strands_quat_multiply( frame, strands_get_quat( c->turn, group, lane ) );
    }
    return pose;
}

static anchor_columns columns_of( wisp_frame* frame, const wisp_span* span, const strands_state* state )
{
    const wisp_entity* surface = wisp_frame_column( frame, span->entity, state->surface, 0 );
    return ( anchor_columns ){
        .slot = wisp_frame_column( frame, span->entity, state->anchor, 0 ),
        .weight = wisp_frame_column( frame, span->entity, state->anchor, 1 ),
        .turn = wisp_frame_column( frame, span->entity, state->anchor, 2 ),
        .corner = wisp_frame_column( frame, span->entity, state->anchor, 3 ),
        .jump = wisp_frame_column( frame, span->entity, state->anchor, 4 ),
        .root = wisp_frame_column( frame, span->entity, WISP_STRAND_ROOT, 0 ),
        .rotation = wisp_frame_column( frame, span->entity, WISP_STRAND_ROOT, 1 ),
        .particles = surface->index != 0 ? wisp_frame_column( frame, *surface, WISP_PARTICLE_POSITION, 0 ) : NULL,
    };
}

// A root that goes farther in the step than its strand could follow takes it along, and then stands for the step.
static void jump( wisp_frame* frame, const wisp_span* span, const anchor_columns* c, int group, int lane,
                  const triangle* now, float teleport )
{
    const wisp_vec3 root = strands_get( c->root, group, lane );
    const wisp_rigid end = pose_on( c, now, group, lane );
    wisp_quat turn = NO_JUMP;
    if ( strands_norm( strands_sub( end.translation, root ) ) > teleport )
    {
        turn =
            strands_quat_multiply( end.rotation, strands_quat_back( strands_get_quat( c->rotation, group, lane ) ) );
        strands_turn( frame, span->entity, group, lane, root, end.translation, turn );
        put_corners( c->corner, group, lane, now );
    }
    strands_put_quat( c->jump, group, lane, turn );
}

void strands_anchor( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const strands_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const anchor_columns c = columns_of( frame, span, state );
    const int substeps = wisp_frame_substeps( frame );
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES; ++i )
    {
        const int group = i / WISP_LANES, lane = i % WISP_LANES;
        if ( t->lane_count[i] == 0 )
        {
            continue;
        }
        triangle before = get_corners( c.corner, group, lane );
        const triangle now = triangle_now( &c, group, lane, &before );
        if ( span->substep == 0 )
        {
            jump( frame, span, &c, group, lane, &now, settings->teleport );
            before = get_corners( c.corner, group, lane );
        }
        const triangle on = between( &before, &now, (float)( span->substep + 1 ) / (float)substeps );
        const wisp_rigid pose = pose_on( &c, &on, group, lane );
        strands_put( c.root, group, lane, pose.translation );
        strands_put_quat( c.rotation, group, lane, pose.rotation );
        if ( span->substep + 1 == substeps )
        {
            put_corners( c.corner, group, lane, &now );
        }
    }
}

void strands_anchor_frames( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const float* jumps = wisp_frame_column( frame, span->entity, state->anchor, 4 );
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES && span->substep == 0; ++i )
    {
        const wisp_quat turn = strands_get_quat( jumps, i / WISP_LANES, i % WISP_LANES );
        if ( memcmp( &turn, &NO_JUMP, sizeof( turn ) ) != 0 )
        {
            strands_turn_frames( frame, span->entity, state->curve, i / WISP_LANES, i % WISP_LANES, turn );
        }
    }
}

// ---- the nearest triangle ----

// Weights of the point of a triangle that is closest to p (Ericson 2005, section 5.1.5).
static void closest( const triangle* t, wisp_vec3 p, float weights[3] )
{
    const wisp_vec3 ab = strands_sub( t->corner[1], t->corner[0] ), ac = strands_sub( t->corner[2], t->corner[0] );
    const wisp_vec3 ap = strands_sub( p, t->corner[0] ), bp = strands_sub( p, t->corner[1] );
    const wisp_vec3 cp = strands_sub( p, t->corner[2] );
    const float d1 = dot( ab, ap ), d2 = dot( ac, ap ), d3 = dot( ab, bp ), d4 = dot( ac, bp );
    const float d5 = dot( ab, cp ), d6 = dot( ac, cp );
    const float va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    float v = 0.0f, w = 0.0f; // of the second and the third corner
    if ( d1 <= 0.0f && d2 <= 0.0f )
    {
        v = w = 0.0f;
    }
    else if ( d3 >= 0.0f && d4 <= d3 )
    {
        v = 1.0f;
    }
    else if ( vc <= 0.0f && d1 >= 0.0f && d3 <= 0.0f )
    {
        v = d1 / ( d1 - d3 );
    }
    else if ( d6 >= 0.0f && d5 <= d6 )
    {
        w = 1.0f;
    }
    else if ( vb <= 0.0f && d2 >= 0.0f && d6 <= 0.0f )
    {
        w = d2 / ( d2 - d6 );
    }
    else if ( va <= 0.0f && d4 >= d3 && d5 >= d6 )
    {
        w = ( d4 - d3 ) / ( ( d4 - d3 ) + ( d5 - d6 ) );
        v = 1.0f - w;
    }
    else if ( va + vb + vc > 0.0f )
    {
        v = vb / ( va + vb + vc );
        w = vc / ( va + vb + vc );
    }
    weights[0] = 1.0f - v - w;
    weights[1] = v;
    weights[2] = w;
}

// What a search over all triangles needs of one: most are farther than their ball, and are passed by.
typedef struct ball
{
    wisp_vec3 centre;
    float radius;
} ball;

typedef struct surface_view
{
    const wisp_fabric* fabric;
    const float* particles;
    ball* balls; // [triangle_count]
} surface_view;

static triangle triangle_of( const surface_view* s, int number )
{
    triangle t;
    for ( int k = 0; k < 3; ++k )
    {
        const float* p = s->particles + (size_t)s->fabric->triangles[3 * (size_t)number + (size_t)k] * 4;
        t.corner[k] = ( wisp_vec3 ){ p[0], p[1], p[2] };
    }
    return t;
}

static ball ball_of( const triangle* t )
{
    static const float THIRDS[3] = { 1.0f / 3.0f, 1.0f / 3.0f, 1.0f / 3.0f };
    ball b = { weigh( t, THIRDS ), 0.0f };
    for ( int k = 0; k < 3; ++k )
    {
        b.radius = fmaxf( b.radius, strands_norm( strands_sub( t->corner[k], b.centre ) ) );
    }
    b.radius *= 1.0f + 1e-5f; // rounding excludes nobody
    return b;
}

// The nearest triangle, the lowest of equals. Neighbours in the user's order are often neighbours on the surface, so the
// search begins with the triangle that was found last. @param weights receives those of the point
static int nearest( const surface_view* s, wisp_vec3 p, int begin, float weights[3] )
{
    int best = -1;
    float distance = INFINITY;
    for ( int k = -1; k < s->fabric->triangle_count; ++k )
    {
        const int number = k < 0 ? begin : k;
        const ball b = s->balls[number];
        if ( strands_norm( strands_sub( p, b.centre ) ) - b.radius > distance )
        {
            continue;
        }
        const triangle t = triangle_of( s, number );
        float w[3];
        closest( &t, p, w );
        const float d = strands_norm( strands_sub( p, weigh( &t, w ) ) );
        if ( d < distance || ( d == distance && number < best ) )
        {
            best = number;
            distance = d;
            memcpy( weights, w, sizeof( w ) );
        }
    }
    return best;
}

// ---- rooting ----

static void root_lane( wisp_world* world, wisp_entity strands, const strands_state* state, const surface_view* s,
                       int i, int* last )
{
    const wisp_strand_topology* topology = wisp_world_strands( world, strands );
    const int group = i / WISP_LANES, lane = i % WISP_LANES;
    const float* position = wisp_world_column( world, strands, WISP_STRAND_POSITION, 0 );
    const float* rotation = wisp_world_column( world, strands, WISP_STRAND_ROOT, 1 );
    int32_t* slot = wisp_world_column( world, strands, state->anchor, 0 );
    float weights[3] = { 1.0f, 0.0f, 0.0f };
    const int found = nearest( s, strands_get( position, topology->group_row[group], lane ), *last, weights );
    *last = found >= 0 ? found : *last;
    const triangle t = triangle_of( s, *last );
    for ( size_t k = 0; k < 3; ++k )
    {
        slot[strands_vector( group, lane ) + k * WISP_LANES] = s->fabric->triangles[3 * (size_t)*last + k];
    }
    strands_put( wisp_world_column( world, strands, state->anchor, 1 ), group, lane,
                 ( wisp_vec3 ){ weights[0], weights[1], weights[2] } );
    wisp_quat frame = { 0.0f, 0.0f, 0.0f, 1.0f };
    (void)frame_of( &t, &frame ); // a triangle without area does not turn its roots
    strands_put_quat(
        wisp_world_column( world, strands, state->anchor, 2 ), group, lane,
        strands_quat_multiply( strands_quat_back( frame ), strands_get_quat( rotation, group, lane ) ) );
    put_corners( wisp_world_column( world, strands, state->anchor, 3 ), group, lane, &t );
}

static void root_all( wisp_world* world, wisp_entity strands, const strands_state* state, const surface_view* s )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    for ( int number = 0; number < s->fabric->triangle_count; ++number )
    {
        const triangle corners = triangle_of( s, number );
        s->balls[number] = ball_of( &corners );
    }
    for ( int i = 0, last = 0; i < t->group_count * WISP_LANES; ++i )
    {
        if ( t->lane_count[i] > 0 )
        {
            root_lane( world, strands, state, s, i, &last );
        }
    }
}

static bool is_same( wisp_entity a, wisp_entity b )
{
    return a.index == b.index && a.generation == b.generation;
}

static bool reserve_rooted( wisp_world* world, strands_state* state )
{
    if ( state->rooted_count < state->rooted_capacity )
    {
        return true;
    }
    const wisp_allocator* allocator = wisp_world_allocator( world );
    const int more = state->rooted_capacity > 0 ? 2 * state->rooted_capacity : 4;
    wisp_entity* grown = allocator->allocate( allocator->user, (size_t)more * sizeof( wisp_entity ), 64 );
    if ( grown == NULL )
    {
        return false;
    }
    if ( state->rooted != NULL )
    {
        memcpy( grown, state->rooted, (size_t)state->rooted_count * sizeof( wisp_entity ) );
        allocator->release( allocator->user, state->rooted, (size_t)state->rooted_capacity * sizeof( wisp_entity ) );
    }
    state->rooted = grown;
    state->rooted_capacity = more;
    return true;
}

// Both components or none.
static wisp_status dress( wisp_world* world, wisp_entity strands, const strands_state* state )
{
    const bool had = wisp_world_has( world, strands, state->surface );
    wisp_status status = wisp_world_attach( world, strands, state->surface );
    if ( status == WISP_OK )
    {
        status = wisp_world_attach( world, strands, state->anchor );
        if ( status != WISP_OK && had == false )
        {
            (void)wisp_world_detach( world, strands, state->surface );
        }
    }
    return status;
}

wisp_status wisp_root_strands( wisp_world* world, wisp_entity strands, wisp_entity surface )
{
    strands_state* state;
    wisp_status status = strands_find( world, strands, &state );
    if ( status != WISP_OK )
    {
        return status;
    }
    surface_view view = { .fabric = wisp_world_fabric( world, surface ) };
    if ( view.fabric == NULL || view.fabric->triangle_count == 0 )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "strands: entity %u is no surface with triangles to root in",
                                surface.index );
    }
    const wisp_allocator* allocator = wisp_world_allocator( world );
    const size_t bytes = (size_t)view.fabric->triangle_count * sizeof( ball );
    view.balls = allocator->allocate( allocator->user, bytes, 64 );
    if ( view.balls == NULL || reserve_rooted( world, state ) == false )
    {
        allocator->release( allocator->user, view.balls, bytes );
        return wisp_world_fail( world, WISP_NO_MEMORY, "no memory to root strands in %d triangles",
                                view.fabric->triangle_count );
    }
    const bool is_new = wisp_world_has( world, strands, state->anchor ) == false;
    // roots read where the surface is, so it must be somebody's wish that it moves
    status = wisp_want( world, surface, WISP_PARTICLE_POSITION );
    status = status == WISP_OK ? dress( world, strands, state ) : status;
    if ( status == WISP_OK )
    {
        (void)wisp_world_detach( world, strands, state->head );
        view.particles = wisp_world_column( world, surface, WISP_PARTICLE_POSITION, 0 );
        root_all( world, strands, state, &view );
        *(wisp_entity*)wisp_world_column( world, strands, state->surface, 0 ) = surface;
        if ( is_new )
        {
            state->rooted[state->rooted_count++] = strands;
        }
    }
    allocator->release( allocator->user, view.balls, bytes );
    return status;
}

void strands_entity_removed( void* memory, wisp_world* world, wisp_entity entity )
{
    strands_state* state = memory;
    for ( int i = 0; i < state->rooted_count; ++i )
    {
        wisp_entity* surface = wisp_world_column( world, state->rooted[i], state->surface, 0 );
        if ( surface != NULL && is_same( *surface, entity ) )
        {
            *surface = ( wisp_entity ){ 0, 0 };
        }
    }
    for ( int i = 0; i < state->rooted_count; ++i )
    {
        if ( is_same( state->rooted[i], entity ) )
        {
            state->rooted_count -= 1;
            memmove( state->rooted + i, state->rooted + i + 1,
                     (size_t)( state->rooted_count - i ) * sizeof( wisp_entity ) );
            return;
        }
    }
}
