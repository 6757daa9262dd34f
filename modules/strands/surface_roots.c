// Roots on a surface: barycentric coordinates in a triangle, and a rotation relative to it. In: positions of the
// surface. Out: positions and rotations of roots. The surface has moved before strands run their substeps, so each
// substep takes its fraction of the motion of the triangle in this step.
#include "strand_passes.h"

#include "strand_rows.h"

#include <string.h>

// ---- rooting ----

// Rooting: the nearest triangle of a surface for each root. In: positions of roots and surface. Out: triangle,
// barycentric coordinates, and the rotation of the root relative to the triangle. Brute force over triangles; a
// bounding sphere culls most of them.

// ---- the nearest triangle ----

// Compute the barycentric coordinates of the point of a triangle closest to p (Ericson 2005, section 5.1.5).
static void closest( const strands_triangle* t, wisp_vec3 p, float weights[3] )
{
    const wisp_vec3 ab = wisp_v3_sub( t->corner[1], t->corner[0] ), ac = wisp_v3_sub( t->corner[2], t->corner[0] );
    const wisp_vec3 ap = wisp_v3_sub( p, t->corner[0] ), bp = wisp_v3_sub( p, t->corner[1] );
    const wisp_vec3 cp = wisp_v3_sub( p, t->corner[2] );
    const float d1 = wisp_v3_dot( ab, ap ), d2 = wisp_v3_dot( ac, ap ), d3 = wisp_v3_dot( ab, bp ),
                d4 = wisp_v3_dot( ac, bp );
    const float d5 = wisp_v3_dot( ab, cp ), d6 = wisp_v3_dot( ac, cp );
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

// A bounding sphere of a triangle.
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

static strands_triangle triangle_of( const surface_view* s, int number )
{
    strands_triangle t;
    for ( int k = 0; k < 3; ++k )
    {
        const float* p = s->particles + (size_t)s->fabric->triangles[3 * (size_t)number + (size_t)k] * 4;
        t.corner[k] = ( wisp_vec3 ){ p[0], p[1], p[2] };
    }
    return t;
}

static ball ball_of( const strands_triangle* t )
{
    static const float THIRDS[3] = { 1.0f / 3.0f, 1.0f / 3.0f, 1.0f / 3.0f };
    ball b = { strands_point_of( t, THIRDS ), 0.0f };
    for ( int k = 0; k < 3; ++k )
    {
        b.radius = fmaxf( b.radius, wisp_v3_length( wisp_v3_sub( t->corner[k], b.centre ) ) );
    }
    b.radius *= 1.0f + 1e-5f; // against rounding
    return b;
}

// Find the nearest triangle, the lowest index of equals. The search starts with the triangle that was found last,
// because neighbours in the user's order are often neighbours on the surface. @param weights receives the barycentric
// coordinates
static int nearest( const surface_view* s, wisp_vec3 p, int begin, float weights[3] )
{
    int best = -1;
    float distance = INFINITY;
    for ( int k = -1; k < s->fabric->triangle_count; ++k )
    {
        const int number = k < 0 ? begin : k;
        const ball b = s->balls[number];
        if ( wisp_v3_length( wisp_v3_sub( p, b.centre ) ) - b.radius > distance )
        {
            continue;
        }
        const strands_triangle t = triangle_of( s, number );
        float w[3];
        closest( &t, p, w );
        const float d = wisp_v3_length( wisp_v3_sub( p, strands_point_of( &t, w ) ) );
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
    const strands_triangle t = triangle_of( s, *last );
    for ( size_t k = 0; k < 3; ++k )
    {
        slot[strands_vector( group, lane ) + k * WISP_LANES] = s->fabric->triangles[3 * (size_t)*last + k];
    }
    strands_put( wisp_world_column( world, strands, state->anchor, 1 ), group, lane,
                 ( wisp_vec3 ){ weights[0], weights[1], weights[2] } );
    wisp_quat frame = { 0.0f, 0.0f, 0.0f, 1.0f };
    (void)strands_triangle_frame( &t, &frame ); // roots on a triangle without area do not turn
    strands_put_quat(
        wisp_world_column( world, strands, state->anchor, 2 ), group, lane,
        wisp_quat_multiply( strands_quat_inverse( frame ), strands_get_quat( rotation, group, lane ) ) );
    strands_put_corners( wisp_world_column( world, strands, state->anchor, 3 ), group, lane, &t );
    strands_put( wisp_world_column( world, strands, WISP_STRAND_ROOT, 2 ), group, lane,
                 ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ); // a surface has no digits beyond those of its positions
}

static void root_all( wisp_world* world, wisp_entity strands, const strands_state* state, const surface_view* s )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    for ( int number = 0; number < s->fabric->triangle_count; ++number )
    {
        const strands_triangle corners = triangle_of( s, number );
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

wisp_status wisp_root_strands( wisp_world* world, wisp_entity strands, wisp_entity surface )
{
    WISP_TRY( wisp_world_check_entity( world, strands ) );
    strands_state* state;
    WISP_TRY( strands_find( world, strands, &state ) );
    if ( ( (const strands_settings*)wisp_world_column( world, strands, state->settings, 0 ) )->is_free != 0 )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "strands: the roots of entity %u are free", strands.index );
    }
    WISP_TRY( wisp_world_check_entity( world, surface ) );
    surface_view view = { .fabric = wisp_world_fabric( world, surface ) };
    if ( view.fabric == NULL || view.fabric->triangle_count == 0 )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "strands: entity %u is not a surface with triangles to root in",
                                surface.index );
    }
    const wisp_allocator* allocator = wisp_world_allocator( world );
    const size_t bytes = (size_t)view.fabric->triangle_count * sizeof( ball );
    view.balls = allocator->allocate( allocator->user, bytes, 64 );
    if ( view.balls == NULL )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory to root strands in %d triangles",
                                view.fabric->triangle_count );
    }
    // roots read positions of the surface, so those must be requested
    wisp_status status = wisp_world_request( world, surface, WISP_PARTICLE_POSITION, true );
    const wisp_component_use uses[] = { { state->surface, true }, { state->anchor, true } };
    status = status == WISP_OK ? wisp_world_set_components( world, strands, uses, WISP_COUNT( uses ) ) : status;
    if ( status == WISP_OK )
    {
        (void)wisp_world_detach( world, strands, state->head );
        wisp_world_tie( world, surface, strands );
        view.particles = wisp_world_column( world, surface, WISP_PARTICLE_POSITION, 0 );
        root_all( world, strands, state, &view );
        *(wisp_entity*)wisp_world_column( world, strands, state->surface, 0 ) = surface;
    }
    allocator->release( allocator->user, view.balls, bytes );
    return status;
}

void strands_entity_removed( void* memory, wisp_world* world, wisp_entity entity )
{
    strands_state* state = memory;
    for ( wisp_entity e = { 0, 0 }; wisp_next_entity( state->registry, state->surface, &e ); )
    {
        wisp_entity* surface = wisp_world_column( world, e, state->surface, 0 );
        *surface = wisp_entity_equal( *surface, entity ) ? ( wisp_entity ){ 0, 0 } : *surface;
    }
}

static void follow_triangle( const strands_state* state, wisp_world* world, wisp_entity strands,
                             const int32_t* before, const int32_t* now )
{
    int32_t* slot = wisp_world_column( world, strands, state->anchor, 0 );
    for ( int i = 0; i < wisp_world_strands( world, strands )->group_count * WISP_LANES; ++i )
    {
        int32_t* corner = slot + strands_vector( i / WISP_LANES, i % WISP_LANES );
        if ( corner[0] == before[0] && corner[WISP_LANES] == before[1] && corner[2 * WISP_LANES] == before[2] )
        {
            corner[0] = now[0];
            corner[WISP_LANES] = now[1];
            corner[2 * WISP_LANES] = now[2];
        }
    }
}

wisp_status strands_triangles_changed( void* memory, wisp_world* world, wisp_entity surface,
                                       const wisp_fabric* before )
{
    const strands_state* state = memory;
    const int32_t *now = wisp_world_fabric( world, surface )->triangles, *then = before->triangles;
    for ( wisp_entity e = { 0, 0 }; wisp_next_entity( state->registry, state->surface, &e ); )
    {
        const wisp_entity* of = wisp_world_column( world, e, state->surface, 0 );
        const bool is_here = wisp_entity_equal( *of, surface );
        for ( int t = 0; t < before->triangle_count && is_here; ++t )
        {
            const size_t first = 3 * (size_t)t;
            if ( memcmp( now + first, then + first, 3 * sizeof( int32_t ) ) != 0 )
            {
                follow_triangle( state, world, e, then + first, now + first );
            }
        }
    }
    return WISP_OK;
}

// ---- roots ----

static const wisp_quat NO_JUMP = { 0.0f, 0.0f, 0.0f, 0.0f }, IDENTITY = { 0.0f, 0.0f, 0.0f, 1.0f };

wisp_vec3 strands_point_of( const strands_triangle* t, const float weights[3] )
{
    const wisp_vec3 ab =
        wisp_v3_add( wisp_v3_scale( t->corner[0], weights[0] ), wisp_v3_scale( t->corner[1], weights[1] ) );
    return wisp_v3_add( ab, wisp_v3_scale( t->corner[2], weights[2] ) );
}

// Columns of the rotation: x along the first edge, z along the normal.
bool strands_triangle_frame( const strands_triangle* t, wisp_quat* out )
{
    const wisp_vec3 edge = wisp_v3_sub( t->corner[1], t->corner[0] );
    const wisp_vec3 normal = wisp_v3_cross( edge, wisp_v3_sub( t->corner[2], t->corner[0] ) );
    const float length = wisp_v3_length( edge ), area = wisp_v3_length( normal );
    if ( !( length > 0.0f && area > 0.0f ) )
    {
        return false;
    }
    const wisp_vec3 x = wisp_v3_scale( edge, 1.0f / length ), z = wisp_v3_scale( normal, 1.0f / area ),
                    y = wisp_v3_cross( z, x );
    // of the four formulas for a quaternion, the one with the largest divisor
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
    *out = wisp_transform_make( q, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ).rotation;
    return true;
}

// ---- the pass ----

typedef struct root_columns
{
    const int32_t* slot;
    const float *weight, *turn;
    float *corner, *jump;
    float *root, *rotation;
    const float* particles; // of the surface; null: it was removed
} root_columns;

static strands_triangle get_corners( const float* corner, int group, int lane )
{
    return ( strands_triangle ){ { strands_get( corner, 3 * group, lane ), strands_get( corner, 3 * group + 1, lane ),
                                   strands_get( corner, 3 * group + 2, lane ) } };
}

void strands_put_corners( float* corner, int group, int lane, const strands_triangle* t )
{
    for ( int k = 0; k < 3; ++k )
    {
        strands_put( corner, 3 * group + k, lane, t->corner[k] );
    }
}

// Return the triangle at the current positions of the surface. One that is not finite stays in place; the state check
// of the surface handles it.
static strands_triangle triangle_now( const root_columns* c, int group, int lane, const strands_triangle* before )
{
    strands_triangle now = *before;
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

static strands_triangle between( const strands_triangle* from, const strands_triangle* to, float time )
{
    strands_triangle t = *to;
    for ( int k = 0; k < 3 && time < 1.0f; ++k )
    {
        t.corner[k] =
            wisp_v3_add( from->corner[k], wisp_v3_scale( wisp_v3_sub( to->corner[k], from->corner[k] ), time ) );
    }
    return t;
}

static void get_weights( const root_columns* c, int group, int lane, float weights[3] )
{
    const wisp_vec3 w = strands_get( c->weight, group, lane );
    weights[0] = w.x;
    weights[1] = w.y;
    weights[2] = w.z;
}

static wisp_transform pose_on( const root_columns* c, const strands_triangle* t, int group, int lane )
{
    float weights[3];
    get_weights( c, group, lane, weights );
    wisp_quat frame;
    wisp_transform pose = { strands_get_quat( c->rotation, group, lane ), strands_point_of( t, weights ) };
    if ( strands_triangle_frame( t, &frame ) )
    {
        pose.rotation = wisp_quat_multiply( frame, strands_get_quat( c->turn, group, lane ) );
    }
    return pose;
}

static root_columns columns_of_roots( wisp_frame* frame, const wisp_span* span, const strands_state* state )
{
    const wisp_entity* surface = wisp_frame_column( frame, span->entity, state->surface, 0 );
    return ( root_columns ){
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

// Teleport the strand of a root that moves too far in the step, or that is not solved; the root then stays for the rest of the step.
// One that is not solved gets a velocity by that, so there is one more such motion when the root stops.
static void jump( wisp_frame* frame, const wisp_span* span, const strands_state* state, const root_columns* c,
                  int group, int lane, const strands_triangle* now, float teleport )
{
    const wisp_vec3 root = strands_get( c->root, group, lane );
    const wisp_transform end = pose_on( c, now, group, lane );
    const wisp_quat before = strands_get_quat( c->rotation, group, lane ),
                    last = strands_get_quat( c->jump, group, lane );
    const bool is_posed = wisp_frame_detail( frame, span->entity ).level == WISP_DETAIL_NOTHING;
    const bool moves = memcmp( &end.translation, &root, sizeof( root ) ) != 0 ||
                       memcmp( &end.rotation, &before, sizeof( before ) ) != 0;
    const bool stops = is_posed && moves == false && memcmp( &last, &NO_JUMP, sizeof( last ) ) != 0;
    wisp_quat turn = NO_JUMP;
    if ( stops )
    {
        strands_turn( frame, span->entity, state, group, lane, root, root, IDENTITY );
    }
    else if ( wisp_v3_length( wisp_v3_sub( end.translation, root ) ) > teleport || ( is_posed && moves ) )
    {
        turn = wisp_quat_multiply( end.rotation, strands_quat_inverse( before ) );
        strands_turn( frame, span->entity, state, group, lane, root, end.translation, turn );
        strands_put_corners( c->corner, group, lane, now );
    }
    strands_put_quat( c->jump, group, lane, turn );
}

void strands_anchor( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const strands_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const root_columns c = columns_of_roots( frame, span, state );
    const int substeps = wisp_frame_substeps( frame, span->entity );
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES; ++i )
    {
        const int group = i / WISP_LANES, lane = i % WISP_LANES;
        if ( t->lane_count[i] == 0 )
        {
            continue;
        }
        strands_triangle before = get_corners( c.corner, group, lane );
        const strands_triangle now = triangle_now( &c, group, lane, &before );
        if ( span->substep == 0 )
        {
            jump( frame, span, state, &c, group, lane, &now, settings->teleport );
            before = get_corners( c.corner, group, lane );
        }
        const strands_triangle on = between( &before, &now, (float)( span->substep + 1 ) / (float)substeps );
        const wisp_transform pose = pose_on( &c, &on, group, lane );
        strands_put( c.root, group, lane, pose.translation );
        strands_put_quat( c.rotation, group, lane, pose.rotation );
        if ( span->substep + 1 == substeps )
        {
            strands_put_corners( c.corner, group, lane, &now );
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
