// Contacts of strands without dynamics (ghosts, and strands that stand still), once per step, after they are posed.
// In: positions. Out: positions, and a bit for each vertex that moved.
//
// - They have no velocity, previous position or mass, so there is no path and no friction. A vertex that is nearer to
//   a body than the thickness moves out along the normal of the closest point, with the body at its pose at the end
//   of the step. Roots stay. Between two bodies the last decides. Lengths give way; what poses the strands resets
//   them in the next step.
// - The pass is in the stage of appearances, so it runs after guide_hair.ghosts, lengths and carry whatever the order
//   of modules. It reads positions, so it also runs after frozen_hair.start, which only writes them. Freezing and
//   aligning run after it by the order of modules. The copy strand.posed needs no push then, and hair that starts
//   from its rest shape is kept out as well.
// - Cost per vertex (ghosts of head_shake.yaml, one worker of a busy Zen 3): 22 to 30 ns around a sphere, 12 ns where
//   hardly any vertex of a group touches, 6 to 8 ns away from all bodies.
#include "body_queries.h"
#include "collision_state.h"

#include <string.h>

typedef struct posed_group
{
    const wisp_strand_topology* strands;
    float* position; // of the entity
    uint32_t* moved; // of the entity
    int group;
    wisp_vec3 lower, upper; // of the vertices that may move
} posed_group;

static int first_row( const posed_group* g )
{
    return g->strands->group_row[g->group];
}

static bool is_vertex( const posed_group* g, int row, int lane )
{
    return row - first_row( g ) < g->strands->lane_count[g->group * WISP_LANES + lane];
}

// Compute the box of a group. NaN does not extend it. The first loop runs over lanes, so that the compiler vectorises
// it.
static void find_box( posed_group* g )
{
    float lower[3 * WISP_LANES], upper[3 * WISP_LANES];
    int32_t last[3 * WISP_LANES]; // vertices of the lane
    for ( int i = 0; i < 3 * WISP_LANES; ++i )
    {
        lower[i] = INFINITY;
        upper[i] = -INFINITY;
        last[i] = g->strands->lane_count[g->group * WISP_LANES + i % WISP_LANES];
    }
    const int rows = g->strands->group_row[g->group + 1] - first_row( g );
    for ( int vertex = 1; vertex < rows; ++vertex )
    {
        const float* x = g->position + (size_t)( first_row( g ) + vertex ) * COLLISION_ROW;
        for ( int i = 0; i < 3 * WISP_LANES; ++i )
        {
            const float down = vertex < last[i] ? x[i] : INFINITY, up = vertex < last[i] ? x[i] : -INFINITY;
            lower[i] = down < lower[i] ? down : lower[i];
            upper[i] = up > upper[i] ? up : upper[i];
        }
    }
    g->lower = collision_load_lane( lower );
    g->upper = collision_load_lane( upper );
    for ( int lane = 1; lane < WISP_LANES; ++lane )
    {
        const wisp_vec3 l = collision_load_lane( lower + lane ), h = collision_load_lane( upper + lane );
        g->lower = ( wisp_vec3 ){ fminf( g->lower.x, l.x ), fminf( g->lower.y, l.y ), fminf( g->lower.z, l.z ) };
        g->upper = ( wisp_vec3 ){ fmaxf( g->upper.x, h.x ), fmaxf( g->upper.y, h.y ), fmaxf( g->upper.z, h.z ) };
    }
}

// A box around the body in its frame, and the transform from the world.
typedef struct posed_box
{
    float axis[3][3], origin[3]; // in the world
    float lower[3], upper[3];
    float reach; // m^2
} posed_box;

static posed_box box_of( const collision_view* view )
{
    const collision_body* body = view->body;
    const wisp_vec3 c = body->centre, h = body->half;
    const float reach = 1.001f * view->thickness; // wider by rounding: the closest point query decides
    posed_box box = { .reach = reach * reach };
    collision_store( box.origin, view->after.translation );
    collision_store( box.lower, ( wisp_vec3 ){ c.x - h.x, c.y - h.y, c.z - h.z } );
    collision_store( box.upper, ( wisp_vec3 ){ c.x + h.x, c.y + h.y, c.z + h.z } );
    for ( int k = 0; k < 3; ++k )
    {
        const wisp_vec3 axis = { k == 0 ? 1.0f : 0.0f, k == 1 ? 1.0f : 0.0f, k == 2 ? 1.0f : 0.0f };
        collision_store( box.axis[k], wisp_quat_rotate( view->after.rotation, axis ) );
    }
    // a plane is infinite except upwards
    box.upper[1] = body->inner < INFINITY ? box.upper[1] : 0.0f;
    return box;
}

// Test sixteen vertices against a box. NaN is not near.
static void find_near( const posed_box* box, const float* x, bool* near )
{
    float squared[WISP_LANES] = { 0 };
    for ( int k = 0; k < 3; ++k )
    {
        const float* a = box->axis[k];
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            const float q = a[0] * ( x[lane] - box->origin[0] ) + a[1] * ( x[WISP_LANES + lane] - box->origin[1] ) +
                            a[2] * ( x[2 * WISP_LANES + lane] - box->origin[2] );
            const float under = box->lower[k] - q, over = q - box->upper[k], beside = under > over ? under : over;
            squared[lane] += beside > 0.0f ? beside * beside : 0.0f * q;
        }
    }
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        near[lane] = squared[lane] <= box->reach;
    }
}

// Push the vertices of a row out. @return whether one moved
static bool push_row( const posed_group* g, const collision_view* view, const posed_box* box, int row )
{
    int lanes[WISP_LANES], n = 0;
    uint32_t moved = 0;
    wisp_mesh_query queries[WISP_LANES];
    wisp_surface_point nearest[WISP_LANES];
    bool is_near[WISP_LANES];
    bool near[WISP_LANES];
    find_near( box, g->position + (size_t)row * COLLISION_ROW, near );
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        if ( near[lane] && is_vertex( g, row, lane ) )
        {
            const wisp_vec3 p = collision_load_lane( g->position + (size_t)row * COLLISION_ROW + lane );
            lanes[n] = lane;
            queries[n++] = ( wisp_mesh_query ){ .point = wisp_transform_to_local( view->after, p ),
                                                .radius = view->thickness,
                                                .time = view->end };
        }
    }
    if ( n == 0 )
    {
        return false;
    }
    collision_closest( view, queries, n, nearest, is_near, NULL );
    for ( int i = 0; i < n; ++i )
    {
        if ( is_near[i] && nearest[i].distance < view->thickness )
        {
            float* at = g->position + (size_t)row * COLLISION_ROW + lanes[i];
            const wisp_vec3 normal = wisp_quat_rotate( view->after.rotation, nearest[i].normal );
            const float out = view->thickness - nearest[i].distance;
            collision_store_lane( at, wisp_v3_mul_add( collision_load_lane( at ), out, normal ) );
            moved |= 1u << lanes[i];
        }
    }
    g->moved[row] |= moved;
    return moved != 0;
}

static bool push_group( const posed_group* g, const collision_view* view )
{
    const posed_box box = box_of( view );
    bool moved = false;
    for ( int row = first_row( g ) + 1; row < g->strands->group_row[g->group + 1]; ++row )
    {
        moved = push_row( g, view, &box, row ) || moved;
    }
    return moved;
}

// Push a group out of one body after another. A vertex that one body moved may touch the next.
static void keep_group_out( wisp_frame* frame, const wisp_span* span, const collision_state* state, posed_group* g )
{
    const int rows = g->strands->group_row[g->group + 1] - first_row( g );
    memset( g->moved + first_row( g ), 0, (size_t)rows * sizeof( uint32_t ) );
    find_box( g );
    collision_view view;
    for ( int next = 0; g->lower.x <= g->upper.x && collision_next( frame, span, state, &next, &view ); )
    {
        view.before = view.after; // the path does not matter
        view.begin = view.end;
        const bool is_near = collision_ball_distance( &view, g->lower, g->upper ) <= view.thickness;
        if ( is_near && push_group( g, &view ) )
        {
            find_box( g );
        }
    }
}

void collision_keep_out( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    posed_group g = {
        .strands = wisp_frame_strands( frame, span->entity ),
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .moved = wisp_frame_column( frame, span->entity, state->posed, 0 ),
    };
    for ( g.group = span->begin; g.group < span->end; ++g.group )
    {
        keep_group_out( frame, span, state, &g );
    }
}
