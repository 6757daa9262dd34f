// Which bodies a participant can meet in a step. In: positions and velocities at its start, motions of the bodies in it.
// Out: for each participant a box, and the bodies that come near it, in their order. So a crowd costs what its members and
// their own bodies do, not their product.
//
// Nothing else reaches what stays in the box. What leaves it, because constraints move it farther than its velocity would, asks
// all bodies. Bodies are looked up by intervals of x.
#include "near_bodies.h"

#include "collision_vectors.h"

#include "wisp/module/space.h"

#include <math.h>
#include <string.h>

enum
{
    FEW_BODIES = 16, // bodies of a world that each participant asks
};

#define MOST_TURN 0.1f // of a body in a step, as of a view, that is looked up by where it is

typedef struct collision_motion
{
    float lower[3], upper[3]; // m, of the host: the centre in the step
    float radius;             // m, of a ball about it that holds the body; infinite: it may be anywhere
    float thickness;
    float shift, turn; // as of a view
    uint32_t layers;
    int next; // in its interval of x; -1: none
} collision_motion;

// ---- memory ----

static bool reserve_near( const wisp_allocator* allocator, wisp_buffer* buffer, void** array, size_t bytes )
{
    const bool enough = wisp_buffer_reserve( buffer, allocator, bytes );
    *array = buffer->data;
    return enough;
}

void collision_release_near( collision_state* state, const wisp_allocator* allocator )
{
    for ( int i = 0; i < WISP_COUNT( state->nearness.buffers ); ++i )
    {
        wisp_buffer_release( state->nearness.buffers + i, allocator );
    }
}

size_t collision_near_bytes( const collision_state* state )
{
    return wisp_buffer_bytes( state->nearness.buffers, WISP_COUNT( state->nearness.buffers ) );
}

// ---- motions of bodies ----

static void load_shifted( float to[3], wisp_vec3 from, float factor, wisp_vec3 add )
{
    to[0] = from.x + factor * add.x;
    to[1] = from.y + factor * add.y;
    to[2] = from.z + factor * add.z;
}

// A body that turns may leave the straight line between its poses by as much as its centre is away from its origin. One with a
// mass moves as contact tells it, and tracks of a body are kept by all.
static void find_body_motion( wisp_frame* frame, const collision_state* state, const collision_body* body,
                              collision_motion* motion )
{
    const collision_collider* c = wisp_frame_column( frame, body->entity, state->collider, 0 );
    collision_view view = { .shift = 0.0f };
    if ( memcmp( &c->from, &c->to, sizeof( c->to ) ) != 0 )
    {
        collision_set_motion( c, &view );
    }
    const bool turns = view.turn > 0.0f;
    const bool is_known = body->is_coupled == false && body->track < 0 && view.turn <= MOST_TURN;
    const wisp_vec3 middle = turns ? ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } : body->centre;
    const wisp_vec3 p = wisp_transform_to_world( c->from, middle ), q = wisp_transform_to_world( c->to, middle );
    wisp_vec3 lower = p, upper = p;
    collision_widen( &lower, &upper, q );
    const wisp_entity rows = body->follows && body->surface.index != 0 ? body->surface : body->entity;
    const wisp_vec3 offset = wisp_frame_offset( frame, rows );
    load_shifted( motion->lower, lower, -1.0f, offset );
    load_shifted( motion->upper, upper, -1.0f, offset );
    motion->radius = is_known ? body->ball_radius + ( turns ? wisp_v3_length( body->centre ) : 0.0f ) : INFINITY;
    motion->thickness = c->thickness;
    motion->shift = view.shift;
    motion->turn = view.turn;
    motion->layers = c->layers;
    motion->next = -1;
}

// Return a lower bound of the distance of a body in the step from all points of a box, less what the turning of the body
// makes of it in its own frame, m. That is so much that a path within the box, seen from the body, does not come near it.
static float apart_in_step( const collision_motion* m, const float lower[3], const float upper[3] )
{
    float squared = 0.0f, farthest = 0.0f, diagonal = 0.0f, size = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        const float above = m->lower[k] - upper[k], below = lower[k] - m->upper[k];
        const float out = collision_larger( 0.0f, collision_larger( above, below ) );
        const float across = collision_larger( m->upper[k] - lower[k], upper[k] - m->lower[k] );
        squared += out * out;
        farthest += across * across;
        diagonal += ( upper[k] - lower[k] ) * ( upper[k] - lower[k] );
        size += fabsf( lower[k] ) + fabsf( upper[k] );
    }
    const float distance = sqrtf( squared ), rounding = 1e-5f * ( size + distance );
    float turned = 0.0f;
    if ( m->turn > 0.0f )
    {
        turned = sqrtf( diagonal ) + 2.0f * ( m->shift + m->turn * ( 3.0f * sqrtf( farthest ) + m->shift ) );
    }
    return distance - m->radius - turned - rounding;
}

// ---- boxes of participants ----

// Points of a participant that move: particle i of a surface, or lane i of the rows of strands.
typedef struct mobile_points
{
    const float *position, *velocity, *weight; // inverse masses
    int count, stride;                         // floats from one to the next; 1: lanes
} mobile_points;

static mobile_points points_of( wisp_frame* frame, wisp_entity e )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, e );
    if ( fabric != NULL )
    {
        const float* position = wisp_frame_column( frame, e, WISP_PARTICLE_POSITION, 0 );
        return ( mobile_points ){ position, wisp_frame_column( frame, e, WISP_PARTICLE_VELOCITY, 0 ), position + 3,
                                  fabric->slot_count, 4 };
    }
    const float* weight = wisp_frame_column( frame, e, WISP_STRAND_INVERSE_MASS, 0 );
    return ( mobile_points ){ wisp_frame_column( frame, e, WISP_STRAND_POSITION, 0 ),
                              wisp_frame_column( frame, e, WISP_STRAND_VELOCITY, 0 ), weight,
                              weight != NULL ? wisp_frame_strands( frame, e )->row_count * WISP_LANES : 0, 1 };
}

static wisp_vec3 load_mobile( const mobile_points* p, const float* from, int i )
{
    return p->stride == 4 ? wisp_v3_load( from + (size_t)i * 4 )
                          : collision_load_lane( from + (size_t)( i / WISP_LANES ) * COLLISION_ROW + i % WISP_LANES );
}

// Bound what moves at the start of the step, with some room for what it does in it: the fastest way along each axis.
static void bound_participant( wisp_frame* frame, wisp_entity e, float thickness, collision_near* n )
{
    const mobile_points p = points_of( frame, e );
    const float seconds = wisp_frame_dt( frame, e ) * (float)wisp_frame_substeps( frame, e );
    wisp_vec3 slowest = { 0.0f, 0.0f, 0.0f }, fastest = slowest;
    n->lower = ( wisp_vec3 ){ INFINITY, INFINITY, INFINITY };
    n->upper = ( wisp_vec3 ){ -INFINITY, -INFINITY, -INFINITY };
    for ( int i = 0; i < p.count; ++i )
    {
        if ( p.weight[(size_t)i * (size_t)p.stride] > 0.0f )
        {
            collision_widen( &n->lower, &n->upper, load_mobile( &p, p.position, i ) );
            collision_widen( &slowest, &fastest, load_mobile( &p, p.velocity, i ) );
        }
    }
    const float size = wisp_v3_length( wisp_v3_sub( n->upper, n->lower ) );
    const float room = 0.1f * size + 4.0f * thickness + 10.0f * seconds * seconds;
    const wisp_vec3 all = { room, room, room };
    n->lower = wisp_v3_mul_add( wisp_v3_mul_add( n->lower, seconds, slowest ), -1.0f, all );
    n->upper = wisp_v3_mul_add( wisp_v3_mul_add( n->upper, seconds, fastest ), 1.0f, all );
}

// ---- lists ----

static int interval_of( const collision_nearness* all, float x )
{
    const float at = ( x - all->first_x ) * all->per_metre;
    return at > 0.0f ? ( at < (float)( all->interval_count - 1 ) ? (int)at : all->interval_count - 1 ) : 0;
}

// Put bodies that are somewhere into intervals of x by the middle of their motion.
static void sort_motions( collision_nearness* all, int count )
{
    float lowest = INFINITY, highest = -INFINITY;
    all->widest = all->most_turn = 0.0f;
    for ( int i = 0; i < count; ++i )
    {
        const collision_motion* m = all->motions + i;
        const float half = 0.5f * ( m->upper[0] - m->lower[0] ), x = m->lower[0] + half;
        if ( m->radius < INFINITY )
        {
            lowest = collision_smaller( x, lowest );
            highest = collision_larger( x, highest );
            all->widest = collision_larger( half + m->radius + 4.0f * m->shift, all->widest );
            all->most_turn = collision_larger( m->turn, all->most_turn );
        }
    }
    all->interval_count = count;
    all->first_x = lowest;
    all->per_metre = highest > lowest ? (float)count / ( highest - lowest ) : 0.0f;
    memset( all->interval, -1, ( (size_t)count + 1 ) * sizeof( *all->interval ) );
    for ( int i = count - 1; i >= 0; --i )
    {
        collision_motion* m = all->motions + i;
        const bool is_somewhere = m->radius < INFINITY;
        const float x = 0.5f * ( m->lower[0] + m->upper[0] );
        int* head =
            all->interval + ( is_somewhere ? interval_of( all, x ) : count ); // the last has those that are anywhere
        m->next = *head;
        *head = i;
    }
}

static void sort_listed( int32_t* list, int count )
{
    for ( int gap = count / 2; gap > 0; gap /= 2 )
    {
        for ( int i = gap; i < count; ++i )
        {
            const int32_t value = list[i];
            int at = i;
            for ( ; at >= gap && list[at - gap] > value; at -= gap )
            {
                list[at] = list[at - gap];
            }
            list[at] = value;
        }
    }
}

// A participant whose list is being made.
typedef struct listing
{
    collision_nearness* all;
    collision_near* near;
    const collision_settings* settings;
    float lower[3], upper[3]; // m, of the host
    float reach[2];           // m, beyond twice the thickness: who is nearer can be met, or is listed
} listing;

static void list_interval( const listing* l, int interval, size_t* count )
{
    for ( int i = l->all->interval[interval]; i >= 0; i = l->all->motions[i].next )
    {
        const collision_motion* m = l->all->motions + i;
        const float margin = 2.0f * ( l->settings->thickness + m->thickness );
        const float apart = apart_in_step( m, l->lower, l->upper );
        if ( ( m->layers & l->settings->mask ) == 0 )
        {
            continue;
        }
        const bool is_met = apart <= margin + l->reach[0], is_listed = apart <= margin + l->reach[1];
        if ( is_met == false )
        {
            float* least = is_listed ? &l->near->nearest_around : &l->near->beyond;
            *least = collision_smaller( apart, *least );
            l->near->free = collision_smaller( 0.33f * ( apart - margin ), l->near->free );
        }
        if ( is_met || is_listed )
        {
            // those that can be met have the sign bit, so that they sort to the front
            l->all->listed[( *count )++] = is_met ? i | INT32_MIN : i;
            l->near->around += is_met ? 0 : 1;
        }
    }
}

static void list_bodies( wisp_frame* frame, collision_state* state, wisp_entity e, size_t* count )
{
    collision_nearness* all = &state->nearness;
    listing l = { .all = all, .near = all->near + e.index };
    l.settings = wisp_frame_column( frame, e, state->settings, 0 );
    collision_near* n = l.near;
    bound_participant( frame, e, l.settings->thickness, n );
    n->offset = wisp_frame_offset( frame, e );
    load_shifted( l.lower, n->lower, -1.0f, n->offset );
    load_shifted( l.upper, n->upper, -1.0f, n->offset );
    const float diagonal = wisp_v3_length( wisp_v3_sub( n->upper, n->lower ) );
    if ( !( diagonal <= 1e6f ) )
    {
        return; // not finite
    }
    l.reach[0] =
        wisp_frame_fabric( frame, e ) != NULL ? 0.0f : diagonal; // of groups of strands: see collision_walk_on()
    l.reach[1] = collision_larger( l.reach[0], 0.5f * diagonal );
    n->nearest_around = INFINITY;
    n->beyond = n->free = l.reach[1];
    // apart_in_step() of what is farther away along x than this is above the reach
    const float margin = 2.0f * ( l.settings->thickness + all->thickest );
    const float near = 1.01f * ( l.reach[1] + margin + all->widest );
    const float window =
        all->most_turn > 0.0f ? ( near + all->widest + 3.0f * diagonal ) / ( 1.0f - 6.0f * all->most_turn ) : near;
    const size_t first = *count;
    list_interval( &l, all->interval_count, count );
    for ( int i = interval_of( all, l.lower[0] - window ); i <= interval_of( all, l.upper[0] + window ); ++i )
    {
        list_interval( &l, i, count );
    }
    n->is_there = true;
    n->first = (int)first;
    n->count = (int)( *count - first );
    sort_listed( all->listed + first, n->count );
    for ( int i = 0; i < n->count; ++i )
    {
        all->listed[first + (size_t)i] &= INT32_MAX;
    }
}

void collision_list_near( void* memory, wisp_frame* frame, const wisp_allocator* allocator )
{
    collision_state* state = memory;
    collision_nearness* all = &state->nearness;
    all->near_count = 0;
    size_t places = 0, listed = 0;
    for ( wisp_entity e = { 0, 0 }; collision_next_participant( state, &e ); )
    {
        places = (size_t)e.index + 1;
    }
    const size_t bodies = (size_t)state->body_count;
    if ( state->body_count <= FEW_BODIES || state->searches_all ||
         reserve_near( allocator, all->buffers, (void**)&all->near, places * sizeof( *all->near ) ) == false ||
         reserve_near( allocator, all->buffers + 1, (void**)&all->motions, bodies * sizeof( *all->motions ) ) ==
             false ||
         reserve_near( allocator, all->buffers + 2, (void**)&all->interval,
                       ( bodies + 1 ) * sizeof( *all->interval ) ) == false )
    {
        return;
    }
    memset( all->near, 0, places * sizeof( *all->near ) );
    all->thickest = 0.0f;
    for ( int i = 0; i < state->body_count; ++i )
    {
        find_body_motion( frame, state, state->bodies + i, all->motions + i );
        all->thickest = collision_larger( all->motions[i].thickness, all->thickest );
    }
    sort_motions( all, state->body_count );
    for ( wisp_entity e = { 0, 0 }; collision_next_participant( state, &e ); )
    {
        if ( reserve_near( allocator, all->buffers + 3, (void**)&all->listed,
                           ( listed + bodies ) * sizeof( *all->listed ) ) == false )
        {
            return;
        }
        if ( wisp_frame_is_halted( frame, e ) == false )
        {
            list_bodies( frame, state, e, &listed );
        }
    }
    all->near_count = (int)places;
}

// ---- walks ----

static bool holds_box( const collision_near* n, wisp_vec3 lower, wisp_vec3 upper )
{
    return n->lower.x <= lower.x && n->lower.y <= lower.y && n->lower.z <= lower.z && upper.x <= n->upper.x &&
           upper.y <= n->upper.y && upper.z <= n->upper.z;
}

collision_walk collision_begin_walk( const collision_state* state, wisp_entity entity, wisp_vec3 lower,
                                     wisp_vec3 upper )
{
    const collision_near* n =
        (int)entity.index < state->nearness.near_count ? state->nearness.near + entity.index : NULL;
    collision_walk walk = { .passed = INFINITY,
                            .last = -1,
                            .near = n != NULL && n->is_there && holds_box( n, lower, upper ) ? n : NULL };
    if ( walk.near != NULL )
    {
        walk.free = n->free;
        walk.passed = n->nearest_around;
        load_shifted( walk.lower, lower, -1.0f, n->offset );
        load_shifted( walk.upper, upper, -1.0f, n->offset );
    }
    return walk;
}

// Compute the view of a body that is listed. @return false if the entity does not collide with it after all
static bool view_listed( wisp_frame* frame, const wisp_span* span, const collision_state* state, int body,
                         collision_view* view )
{
    int next = body;
    return collision_next( frame, span, state, &next, view ) && next == body + 1;
}

bool collision_walk_on( wisp_frame* frame, const wisp_span* span, const collision_state* state, collision_walk* walk,
                        float reach, collision_view* view )
{
    if ( walk->near == NULL )
    {
        return collision_next( frame, span, state, &walk->next, view );
    }
    const collision_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    while ( walk->next < walk->near->count - walk->near->around )
    {
        const int body = state->nearness.listed[walk->near->first + walk->next++];
        const collision_motion* m = state->nearness.motions + body;
        const float margin = 2.0f * ( settings->thickness + m->thickness ),
                    apart = apart_in_step( m, walk->lower, walk->upper );
        if ( apart <= margin + reach && view_listed( frame, span, state, body, view ) )
        {
            return true;
        }
        if ( apart > margin + reach )
        {
            walk->free = collision_smaller( 0.33f * ( apart - margin ), walk->free );
            walk->passed = collision_smaller( apart, walk->passed );
        }
    }
    return false;
}

bool collision_walk_back( wisp_frame* frame, const wisp_span* span, const collision_state* state,
                          collision_walk* walk, float limit, collision_view* view )
{
    while ( walk->near != NULL && walk->passed < limit )
    {
        // the nearest that was passed, and the distance of the next one
        int nearest = -1;
        float next = INFINITY;
        for ( int i = 0; i < walk->near->count; ++i )
        {
            const int body = state->nearness.listed[walk->near->first + i];
            const float apart = apart_in_step( state->nearness.motions + body, walk->lower, walk->upper );
            nearest = apart == walk->passed && nearest < 0 && body > walk->last ? body : nearest;
            next = apart > walk->passed || ( apart == walk->passed && nearest >= 0 && body > nearest )
                       ? collision_smaller( apart, next )
                       : next;
        }
        walk->last = next == walk->passed ? nearest : -1;
        walk->passed = next;
        if ( nearest >= 0 && view_listed( frame, span, state, nearest, view ) )
        {
            return true;
        }
    }
    return false;
}
