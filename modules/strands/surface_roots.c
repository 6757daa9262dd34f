// Roots on a surface: barycentric coordinates in a triangle, and a rotation relative to it. In: positions of the
// surface. Out: positions and rotations of roots. The surface has moved before strands run their substeps, so each
// substep takes its fraction of the motion of the triangle in this step.
#include "strand_passes.h"

#include "strand_rows.h"

#include "wisp/module/anchor.h"

#include <string.h>

static const wisp_quat NO_JUMP = { 0.0f, 0.0f, 0.0f, 0.0f }, IDENTITY = { 0.0f, 0.0f, 0.0f, 1.0f };

// ---- rooting ----

// The rotation whose columns are the axes of a triangle. @return false without an area
static bool frame_of( const wisp_triangle* t, wisp_quat* out )
{
    wisp_vec3 axes[3];
    if ( wisp_triangle_axes( t, axes ) == false )
    {
        return false;
    }
    const wisp_vec3 x = axes[0], y = axes[1], z = axes[2];
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

static void put_corners( float* corner, int group, int lane, const wisp_triangle* t )
{
    for ( int k = 0; k < 3; ++k )
    {
        strands_put( corner, 3 * group + k, lane, t->corner[k] );
    }
}

static void root_all( wisp_world* world, wisp_entity strands, const strands_state* state, wisp_entity surface,
                      wisp_collision_mesh* mesh )
{
    const wisp_strand_topology* topology = wisp_world_strands( world, strands );
    const wisp_fabric* fabric = wisp_world_fabric( world, surface );
    const float* particles = wisp_world_column( world, surface, WISP_PARTICLE_POSITION, 0 );
    const float* position = wisp_world_column( world, strands, WISP_STRAND_POSITION, 0 );
    const float* rotation = wisp_world_column( world, strands, WISP_STRAND_ROOT, 1 );
    float* low = wisp_world_column( world, strands, WISP_STRAND_ROOT, 2 );
    int32_t* triangle = wisp_world_column( world, strands, state->anchor, 0 );
    float* weights = wisp_world_column( world, strands, state->anchor, 1 );
    float* turn = wisp_world_column( world, strands, state->anchor, 2 );
    float* corners = wisp_world_column( world, strands, state->anchor, 3 );
    for ( int i = 0; i < topology->group_count * WISP_LANES; ++i )
    {
        const int group = i / WISP_LANES, lane = i % WISP_LANES;
        if ( topology->lane_count[i] == 0 )
        {
            continue;
        }
        const wisp_anchor found = wisp_find_anchor( mesh, strands_get( position, topology->group_row[group], lane ) );
        const wisp_anchor at = found.triangle >= 0 ? found : ( wisp_anchor ){ 0, { 1.0f, 0.0f, 0.0f } };
        const wisp_triangle t = wisp_triangle_of( fabric, particles, at.triangle );
        wisp_quat frame = IDENTITY;
        (void)frame_of( &t, &frame ); // roots on a triangle without area do not turn
        triangle[i] = at.triangle;
        strands_put( weights, group, lane, wisp_v3_load( at.weights ) );
        strands_put_quat(
            turn, group, lane,
            wisp_quat_multiply( strands_quat_inverse( frame ), strands_get_quat( rotation, group, lane ) ) );
        put_corners( corners, group, lane, &t );
        strands_put( low, group, lane,
                     ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ); // a surface has no digits beyond those of its positions
    }
}

wisp_status wisp_root_strands( wisp_world* world, wisp_entity strands, wisp_entity surface )
{
    strands_state* state;
    WISP_TRY( strands_find( world, strands, &state ) );
    if ( ( (const strands_settings*)wisp_world_column( world, strands, state->settings, 0 ) )->is_free != 0 )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "strands: the roots of entity %u are free", strands.index );
    }
    WISP_TRY( wisp_world_check_entity( world, surface ) );
    wisp_collision_mesh* mesh;
    WISP_TRY( wisp_world_build_mesh( world, surface, &mesh ) );
    // roots read positions of the surface, so those must be requested
    wisp_status status = wisp_world_request( world, surface, WISP_PARTICLE_POSITION, true );
    const wisp_component_use uses[] = { { state->surface, true }, { state->anchor, true }, { state->head, false } };
    status = status == WISP_OK ? wisp_world_set_components( world, strands, uses, WISP_COUNT( uses ) ) : status;
    if ( status == WISP_OK )
    {
        wisp_world_tie( world, surface, strands );
        root_all( world, strands, state, surface, mesh );
        *(wisp_entity*)wisp_world_column( world, strands, state->surface, 0 ) = surface;
    }
    wisp_collision_mesh_release( mesh );
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

// ---- the pass ----

typedef struct root_columns
{
    const int32_t* triangle;
    const float *weight, *turn;
    float *corner, *jump;
    float *root, *rotation;
    const wisp_fabric* fabric; // of the surface; null: it was removed
    const float* particles;
} root_columns;

static wisp_triangle get_corners( const float* corner, int group, int lane )
{
    return ( wisp_triangle ){ { strands_get( corner, 3 * group, lane ), strands_get( corner, 3 * group + 1, lane ),
                                strands_get( corner, 3 * group + 2, lane ) } };
}

// Return the triangle at the current positions of the surface. One that is not finite stays in place; the state check
// of the surface handles it.
static wisp_triangle triangle_now( const root_columns* c, int group, int lane, const wisp_triangle* before )
{
    if ( c->fabric == NULL )
    {
        return *before;
    }
    const wisp_triangle now = wisp_triangle_of( c->fabric, c->particles, c->triangle[group * WISP_LANES + lane] );
    bool is_finite = true;
    for ( int k = 0; k < 3; ++k )
    {
        const wisp_vec3 p = now.corner[k];
        is_finite = is_finite && fabsf( p.x ) <= 1e6f && fabsf( p.y ) <= 1e6f && fabsf( p.z ) <= 1e6f;
    }
    return is_finite ? now : *before;
}

static wisp_triangle between( const wisp_triangle* from, const wisp_triangle* to, float time )
{
    wisp_triangle t = *to;
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

static wisp_transform pose_on( const root_columns* c, const wisp_triangle* t, int group, int lane )
{
    float weights[3];
    get_weights( c, group, lane, weights );
    wisp_quat frame;
    wisp_transform pose = { strands_get_quat( c->rotation, group, lane ), wisp_triangle_point( t, weights ) };
    if ( frame_of( t, &frame ) )
    {
        pose.rotation = wisp_quat_multiply( frame, strands_get_quat( c->turn, group, lane ) );
    }
    return pose;
}

static root_columns columns_of_roots( wisp_frame* frame, const wisp_span* span, const strands_state* state )
{
    const wisp_entity* surface = wisp_frame_column( frame, span->entity, state->surface, 0 );
    return ( root_columns ){
        .triangle = wisp_frame_column( frame, span->entity, state->anchor, 0 ),
        .weight = wisp_frame_column( frame, span->entity, state->anchor, 1 ),
        .turn = wisp_frame_column( frame, span->entity, state->anchor, 2 ),
        .corner = wisp_frame_column( frame, span->entity, state->anchor, 3 ),
        .jump = wisp_frame_column( frame, span->entity, state->anchor, 4 ),
        .root = wisp_frame_column( frame, span->entity, WISP_STRAND_ROOT, 0 ),
        .rotation = wisp_frame_column( frame, span->entity, WISP_STRAND_ROOT, 1 ),
        .fabric = surface->index != 0 ? wisp_frame_fabric( frame, *surface ) : NULL,
        .particles = surface->index != 0 ? wisp_frame_column( frame, *surface, WISP_PARTICLE_POSITION, 0 ) : NULL,
    };
}

// Teleport the strand of a root that moves too far in the step, or that is not solved; the root then stays for the rest of the step.
// One that is not solved gets a velocity by that, so there is one more such motion when the root stops.
static void jump( wisp_frame* frame, const wisp_span* span, const strands_state* state, const root_columns* c,
                  int group, int lane, const wisp_triangle* now, float teleport )
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
        put_corners( c->corner, group, lane, now );
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
        wisp_triangle before = get_corners( c.corner, group, lane );
        const wisp_triangle now = triangle_now( &c, group, lane, &before );
        if ( span->substep == 0 )
        {
            jump( frame, span, state, &c, group, lane, &now, settings->teleport );
            before = get_corners( c.corner, group, lane );
        }
        const wisp_triangle on = between( &before, &now, (float)( span->substep + 1 ) / (float)substeps );
        const wisp_transform pose = pose_on( &c, &on, group, lane );
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
