// Participants that meet nothing but bodies in closed form: contacts are found where they are projected, in one sweep behind all other
// constraints, and kept nowhere. In: positions and previous positions, poses of the bodies. Out: the same, outside of them.
//
// What the kernel leaves, because a path enters a body or two bodies squeeze a particle, is searched as by contact_generation.c. A crowd
// whose lanes have that leaves the surface for this step.
#include "body_queries.h"
#include "collision_state.h"
#include "particle_contacts.h"
#include "near_bodies.h"

#include "wisp/module/taper.h"

#include <math.h>
#include <string.h>

enum
{
    FEW_SHAPES = 2, // bodies that each block of particles asks, wherever it is
    LANES = 8,
};

// ---- shapes in lanes ----

static void set_vector( float ( *rows )[LANES], int lane, wisp_vec3 v )
{
    rows[0][lane] = v.x;
    rows[1][lane] = v.y;
    rows[2][lane] = v.z;
}

static void set_size( wisp_shape_lanes* s, int lane, const wisp_shape* shape )
{
    const wisp_taper t = shape->kind == WISP_SHAPE_TAPERED_CAPSULE
                             ? wisp_taper_of( shape )
                             : ( wisp_taper ){ .lower = -(double)shape->half_length,
                                               .upper = (double)shape->half_length,
                                               .middle = (double)shape->radius };
    const wisp_vec3 e = shape->half_extent;
    const bool is_box = shape->kind == WISP_SHAPE_BOX;
    s->size[0][lane] = is_box ? e.x : (float)t.middle;
    s->size[1][lane] = is_box ? e.y : (float)t.lower;
    s->size[2][lane] = is_box ? e.z : (float)t.upper;
    s->size[3][lane] = (float)t.slope;
    s->size[4][lane] = (float)t.sine;
}

static void set_motion( wisp_shape_lanes* s, int lane, const collision_view* view, bool turns )
{
    const collision_collider c = { .from = view->before, .to = view->after };
    collision_view motion = { .shift = 0.0f };
    collision_set_motion( &c, &motion );
    const float rate = turns ? motion.turn : 0.0f, turned = turns ? rate * view->body->ball_radius : 0.0f;
    const float rounding = 1.001f;
    s->rate[lane] = rounding * rate;
    s->shift[lane] = rounding * ( ( 1.0f + rate ) * motion.shift + turned );
    // distance > 1.001 path + shift + rate ( path + distance )
    s->farther[lane] = s->rate[lane] < 0.5f ? ( 1.002f + s->rate[lane] ) / ( 1.0f - s->rate[lane] ) : INFINITY;
}

void collision_set_shape( wisp_shape_lanes* s, int lane, const collision_view* view, float recovery )
{
    static const wisp_vec3 AXES[3] = { { 1.0f, 0.0f, 0.0f }, { 0.0f, 1.0f, 0.0f }, { 0.0f, 0.0f, 1.0f } };
    const wisp_quat before = view->before.rotation, after = view->after.rotation;
    const bool turns = memcmp( &before, &after, sizeof( before ) ) != 0;
    const wisp_quat back = { -after.x, -after.y, -after.z, after.w };
    s->kind = view->body->shape.kind;
    s->turns = s->turns || turns;
    for ( int k = 0; k < 3; ++k )
    {
        set_vector( s->axis[k], lane, wisp_quat_rotate( after, AXES[k] ) );
        set_vector( s->turn[k], lane,
                    turns ? wisp_quat_rotate( before, wisp_quat_rotate( back, AXES[k] ) ) : AXES[k] );
    }
    set_motion( s, lane, view, turns );
    set_vector( s->at, lane, view->after.translation );
    set_vector( s->was, lane, view->before.translation );
    set_size( s, lane, &view->body->shape );
    s->thickness[lane] = view->thickness;
    s->shallow[lane] = COLLISION_SHALLOW * view->thickness;
    s->recovery[lane] = recovery;
    s->static_friction[lane] = view->static_friction;
    s->kinetic_friction[lane] = view->kinetic_friction;
}

static float recovery_of( wisp_frame* frame, wisp_entity e, const collision_state* state )
{
    const collision_settings* settings = wisp_frame_column( frame, e, state->settings, 0 );
    return settings->max_push_out_speed * wisp_frame_dt( frame, e );
}

// ---- a walk over the bodies near some paths ----

typedef struct shape_walk
{
    collision_walk walk;
    wisp_vec3 lower, upper;
    bool is_bounded;
} shape_walk;

static shape_walk begin_walk( const collision_state* state, wisp_entity entity, bool is_bounded, wisp_vec3 lower,
                              wisp_vec3 upper )
{
    return ( shape_walk ){ collision_begin_walk( state, entity, lower, upper ), lower, upper, is_bounded };
}

// Whether a body may come as near to paths in a box as twice the thickness. Seen from a body that turns by a small angle, a point
// leaves the straight line by less than the angle times its distance.
static bool is_near( const collision_view* view, wisp_vec3 lower, wisp_vec3 upper )
{
    collision_view turned = *view;
    turned.before.rotation = view->after.rotation;
    const collision_collider c = { .from = view->before, .to = view->after };
    collision_set_motion( &c, &turned );
    const wisp_vec3 at = view->after.translation, middle = wisp_v3_mul_add( lower, 1.0f, upper );
    const float far = 0.5f * wisp_v3_length( wisp_v3_mul_add( middle, -2.0f, at ) ) +
                      0.5f * wisp_v3_length( wisp_v3_sub( upper, lower ) );
    const bool turns = memcmp( &view->before.rotation, &view->after.rotation, sizeof( wisp_quat ) ) != 0;
    const float bend = turns ? turned.turn * ( far + turned.shift ) : 0.0f;
    return collision_ball_distance( &turned, lower, upper ) - bend <= 2.0f * view->thickness;
}

static bool walk_on( wisp_frame* frame, const wisp_span* span, const collision_state* state, shape_walk* w,
                     collision_view* view )
{
    while ( collision_walk_on( frame, span, state, &w->walk, 0.0f, view ) )
    {
        if ( w->is_bounded == false || is_near( view, w->lower, w->upper ) )
        {
            return true;
        }
    }
    return false;
}

// ---- a surface ----

// @return whether all bodies near are there
static bool list_shapes( wisp_frame* frame, const wisp_span* span, const collision_state* state, shape_walk* w,
                         wisp_shape_lanes* shapes, int* count )
{
    const float recovery = recovery_of( frame, span->entity, state );
    collision_view view;
    *count = 0;
    while ( walk_on( frame, span, state, w, &view ) )
    {
        if ( *count == WISP_OUTSIDE_SHAPES || collision_is_closed_form( view.body ) == false )
        {
            return false;
        }
        shapes[*count].turns = false;
        collision_set_shape( shapes + ( *count )++, 0, &view, recovery );
    }
    return true;
}

static uint32_t keep_block( wisp_frame* frame, const wisp_span* span, const collision_state* state, int begin,
                            int end )
{
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    wisp_outside_args args = {
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 ),
    };
    const bool is_bounded = state->body_count > FEW_SHAPES;
    float lower[3] = { -INFINITY, -INFINITY, -INFINITY }, upper[3] = { INFINITY, INFINITY, INFINITY };
    if ( is_bounded )
    {
        kernels->bound_paths( args.position, args.previous, begin, end, lower, upper );
    }
    wisp_shape_lanes shapes[WISP_OUTSIDE_SHAPES];
    args.shapes = shapes;
    shape_walk w = begin_walk( state, span->entity, is_bounded, wisp_v3_load( lower ), wisp_v3_load( upper ) );
    if ( list_shapes( frame, span, state, &w, shapes, &args.count ) == false )
    {
        return UINT32_MAX;
    }
    return args.count > 0 ? kernels->stay_outside( &args, begin, end ) : 0;
}

void collision_keep_outside( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    const wisp_span particles = wisp_frame_particles( frame, span );
    for ( int begin = particles.begin; begin < particles.end; begin += COLLISION_BLOCK )
    {
        const int end = particles.end - begin < COLLISION_BLOCK ? particles.end : begin + COLLISION_BLOCK;
        const uint32_t left = keep_block( frame, span, state, begin, end );
        if ( left != 0 )
        {
            collision_find_and_project( frame, span, state, begin, end, left );
        }
    }
}

// ---- a crowd ----

// Return the first row from `row` on whose lane is free and whose shape is of a kind.
static int find_row( wisp_shape_lanes ( *rows )[2], int row, int* count, wisp_shape_kind kind )
{
    while ( row < *count && rows[row][0].kind != kind )
    {
        row += 1;
    }
    if ( row == *count && row < WISP_OUTSIDE_SHAPES )
    {
        memset( rows[row], 0, sizeof( rows[row] ) );
        for ( int l = 0; l < LANES; ++l )
        {
            rows[row][0].thickness[l] = rows[row][1].thickness[l] = -1.0f;
        }
        rows[row][0].kind = rows[row][1].kind = kind;
        *count += 1;
    }
    return row;
}

// List the bodies of a lane in their order, each in a row of its kind. @return whether all are there
static bool list_lane( wisp_frame* frame, const wisp_span* span, const collision_state* state, shape_walk* w,
                       int lane, wisp_shape_lanes ( *rows )[2], int* count )
{
    const float recovery = recovery_of( frame, span->entity, state );
    collision_view view;
    int row = 0;
    while ( walk_on( frame, span, state, w, &view ) )
    {
        if ( collision_is_closed_form( view.body ) == false )
        {
            return false;
        }
        row = find_row( rows, row, count, view.body->shape.kind );
        if ( row == WISP_OUTSIDE_SHAPES )
        {
            return false;
        }
        collision_set_shape( rows[row++] + lane / LANES, lane % LANES, &view, recovery );
    }
    return true;
}

void collision_keep_crowd_outside( wisp_frame* frame, const wisp_crowd* crowd, const wisp_span* span, void* user )
{
    enum
    {
        WIDTH = WISP_INSTANCE_LANES,
    };
    const collision_state* state = user;
    wisp_shape_lanes( *rows )[2] = wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker,
                                                          WISP_OUTSIDE_SHAPES * sizeof( *rows ) );
    if ( rows == NULL )
    {
        *crowd->left = UINT32_MAX;
        return;
    }
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    float lower[3 * WIDTH], upper[3 * WIDTH];
    const bool is_bounded = state->body_count > FEW_SHAPES;
    if ( is_bounded )
    {
        kernels->instances_bound_paths( crowd->args, lower, upper );
    }
    int count = 0;
    for ( int lane = 0; lane < crowd->count; ++lane )
    {
        wisp_span own = *span;
        own.entity = crowd->entities[lane];
        wisp_vec3 low = { -INFINITY, -INFINITY, -INFINITY }, high = { INFINITY, INFINITY, INFINITY };
        if ( is_bounded )
        {
            low = ( wisp_vec3 ){ lower[lane], lower[WIDTH + lane], lower[2 * WIDTH + lane] };
            high = ( wisp_vec3 ){ upper[lane], upper[WIDTH + lane], upper[2 * WIDTH + lane] };
        }
        shape_walk w = begin_walk( state, own.entity, is_bounded, low, high );
        *crowd->left |= list_lane( frame, &own, state, &w, lane, rows, &count ) ? 0u : 1u << lane;
    }
    *crowd->left |= count > 0 ? kernels->instances_stay_outside( crowd->args, rows[0], count ) : 0u;
}
