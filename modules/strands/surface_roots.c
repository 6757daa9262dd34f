// Roots on a surface: barycentric coordinates in a triangle, and a rotation relative to it. In: positions of the
// surface. Out: positions and rotations of roots. The surface has moved before strands run their substeps, so each
// substep takes its fraction of the motion of the triangle in this step.
#include "surface_roots.h"

#include "head_roots.h"
#include "strand_rows.h"

#include <string.h>

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
    const bool is_carried = wisp_frame_detail( frame, span->entity ).level == WISP_DETAIL_NOTHING;
    const bool moves = memcmp( &end.translation, &root, sizeof( root ) ) != 0 ||
                       memcmp( &end.rotation, &before, sizeof( before ) ) != 0;
    const bool stops = is_carried && moves == false && memcmp( &last, &NO_JUMP, sizeof( last ) ) != 0;
    wisp_quat turn = NO_JUMP;
    if ( stops )
    {
        strands_turn( frame, span->entity, state, group, lane, root, root, IDENTITY );
    }
    else if ( wisp_v3_length( wisp_v3_sub( end.translation, root ) ) > teleport || ( is_carried && moves ) )
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
