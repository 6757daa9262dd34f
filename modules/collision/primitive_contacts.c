// Contacts of edges and triangles (pass collision.find_primitives), once per substep, after those of particles. In: positions and
// previous positions of a participant, poses of the bodies. Out: up to two half spaces per edge and per triangle, each with the
// weights of the corners of the point that it keeps out, and the lists of edges and triangles that have some.
//
// - Everything is in the frame of the body, as for particles: a corner moves from b0, seen from the old pose, to b1 along a
//   line. The deepest point of an edge or a triangle at a time of the substep is that of deepest_point.c.
// - Conservative advancement finds where the path first comes nearer than a tenth of the thickness h: no point moves farther
//   than the fastest corner, so at distance d nothing can be touched before another d over that displacement. The half space is the
//   tangent plane there. A path that stays away gets the plane of its end. So a needle has the side that it comes from, at any speed.
// - A point that starts nearer than h is moved out at the push-out speed, with its previous position, as particles are.
// - Corners have contacts of their own: what is no deeper than they are, by a twentieth of h, gets none. Nor does a triangle whose
//   deepest point is on its border, which belongs to its edges.
// - Primitives are independent of each other, and lists have their order, so results do not depend on the workers. Push-out, which
//   moves corners, is done contact by contact in that order.
#include "primitive_contacts.h"

#include "near_bodies.h"

#include "body_queries.h"
#include "collision_state.h"
#include "particle_contacts.h"
#include "reaction.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

enum
{
    PRIMITIVE_GRAIN = 256, // primitives, or particles, of a task
    CLEAR_SHAPES = 8,      // bodies from which particles are cleared together
};

// Fractions of the thickness: distance at which a path is stopped, error of the deepest point, what corners may leave.
static const float ROOM = 0.06f;     // beyond the paths that are expected of particles in a step
static const float LITTLE = 0.02f;   // the same in a substep
static const float PACE = 2.0f;      // times the path of a particle: none is longer in the rest of the step
static const float SPEEDING = 10.0f; // m/s^2, with which particles may leave those paths
static const float STOP = 0.1f, TOLERANCE = 0.005f, LEFT_TO_CORNERS = 0.05f;

collision_primitives collision_primitives_of( wisp_frame* frame, wisp_entity e, const collision_state* state,
                                              int corner_count )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, e );
    const bool is_edges = corner_count == 2;
    const wisp_component component = is_edges ? state->edge_contacts : state->triangle_contacts;
    return ( collision_primitives ){
        .corners = is_edges ? fabric->edges : fabric->triangles,
        .count = is_edges ? fabric->edge_count : fabric->triangle_count,
        .corner_count = corner_count,
        .found = wisp_frame_column( frame, e, component, 0 ),
        .active = wisp_frame_column( frame, e, component, 1 ),
        .near = wisp_frame_column( frame, e, component, 2 ),
        .contacts = wisp_frame_column( frame, e, component, 3 ),
        .active_count = wisp_frame_column( frame, e, state->all_features, is_edges ? 0 : 1 ),
        .near_count = wisp_frame_column( frame, e, state->all_features, is_edges ? 2 : 3 ),
    };
}

typedef struct find_loop
{
    wisp_frame* frame;
    const wisp_span* span;
    const collision_state* state;
    collision_primitives primitives;
    float *position, *previous;
    const int32_t* contact_counts; // [slot] of particles
    collision_contact ( *particle_contacts )[WISP_COLLISION_CONTACTS];
    collision_maps maps;
    wisp_clear_args clear;
    float longest;       // m, edge
    collision_walk walk; // over the bodies that may be met in the step
} find_loop;

static wisp_primitive_paths paths_of( const find_loop* loop )
{
    const collision_primitives* p = &loop->primitives;
    return ( wisp_primitive_paths ){ loop->position,    loop->previous,    p->corners,      p->corner_count,
                                     loop->clear.place, loop->clear.words, loop->clear.away };
}

// ---- a primitive and a body ----

static bool load_path( const find_loop* loop, const collision_view* view, const int32_t* corners,
                       primitive_path* path )
{
    path->corner_count = loop->primitives.corner_count;
    path->displacement = 0.0f;
    bool is_finite = true;
    for ( int k = 0; k < path->corner_count; ++k )
    {
        const size_t quad = (size_t)corners[k] * 4;
        path->from[k] = wisp_transform_to_local( view->before, wisp_v3_load( loop->previous + quad ) );
        path->to[k] = wisp_transform_to_local( view->after, wisp_v3_load( loop->position + quad ) );
        is_finite = is_finite && collision_is_finite( path->from[k] ) && collision_is_finite( path->to[k] );
        path->displacement =
            collision_larger( path->displacement, wisp_v3_length( wisp_v3_sub( path->to[k], path->from[k] ) ) );
    }
    return is_finite;
}

// Note the half spaces that corners have of their own, of whatever body.
static void load_planes( const find_loop* loop, const collision_view* view, const int32_t* corners,
                         primitive_path* path )
{
    const wisp_quat q = view->after.rotation, back = { -q.x, -q.y, -q.z, q.w };
    path->plane_count = 0;
    for ( int k = 0; k < path->corner_count; ++k )
    {
        const wisp_vec3 p = wisp_v3_load( loop->position + (size_t)corners[k] * 4 );
        for ( int i = 0; i < loop->contact_counts[corners[k]] && i < WISP_COLLISION_CONTACTS; ++i )
        {
            const collision_contact* c = &loop->particle_contacts[corners[k]][i];
            const wisp_vec3 n = wisp_v3_load( c->normal );
            path->normals[path->plane_count] = wisp_quat_rotate( back, n );
            path->distances[path->plane_count++] = wisp_v3_dot( n, wisp_v3_sub( p, wisp_v3_load( c->point ) ) );
        }
    }
}

static void corners_at( const primitive_path* path, float time, wisp_vec3* corners )
{
    for ( int k = 0; k < path->corner_count; ++k )
    {
        const wisp_vec3 displacement = wisp_v3_sub( path->to[k], path->from[k] );
        corners[k] = wisp_v3_mul_add( path->from[k], time, displacement );
    }
}

// Find the first time at which a path is as near as `stop`, or one shortly before, 1 if it never is.
// @return false if a corner is not finite
static bool advance( const collision_view* view, const primitive_path* path, float stop, float* time,
                     collision_deepest* deepest )
{
    const float tolerance = TOLERANCE * view->thickness;
    wisp_vec3 corners[3];
    *time = 0.0f;
    for ( int i = 0; i < COLLISION_ADVANCES && *time < 1.0f; ++i )
    {
        corners_at( path, *time, corners );
        if ( collision_find_deepest( &view->body->shape, corners, path->corner_count, tolerance, deepest ) == false )
        {
            return false;
        }
        if ( deepest->surface.distance <= stop )
        {
            break;
        }
        // not quite, so that rounding and the tolerance do not carry it through
        const float step =
            ( deepest->surface.distance - 0.5f * stop ) / collision_larger( path->displacement, 1e-30f );
        *time = step < 1.0f - *time ? *time + step : 1.0f;
    }
    return true;
}

// Find the point that meets a body: where the path is stopped, or at its end, if that is near and deeper than the corners.
// @return false if there is none
static bool find_meeting( const collision_view* view, const primitive_path* path, collision_deepest* deepest )
{
    const wisp_shape* shape = &view->body->shape;
    const float stop = STOP * view->thickness, left = LEFT_TO_CORNERS * view->thickness;
    float corner, time = 1.0f;
    // most paths are too far from the body to be stopped in the substep
    if ( collision_bound_deepest( shape, path->from, path->corner_count, &corner ) - path->displacement <= stop &&
         advance( view, path, stop, &time, deepest ) == false )
    {
        return false;
    }
    if ( time < 1.0f )
    {
        return true;
    }
    const float bound = collision_bound_deepest( shape, path->to, path->corner_count, &corner );
    const float most = collision_smaller( corner - left, 2.0f * view->thickness + path->displacement );
    return bound < most &&
           collision_find_deepest( shape, path->to, path->corner_count, TOLERANCE * view->thickness, deepest ) &&
           deepest->surface.distance < most;
}

static bool is_on_border( const collision_deepest* d )
{
    return d->weights[0] < COLLISION_BORDER || d->weights[1] < COLLISION_BORDER || d->weights[2] < COLLISION_BORDER;
}

float collision_meeting_gap( const collision_view* view, const primitive_path* path, const collision_meeting* m )
{
    const collision_deepest* d = &m->deepest;
    wisp_vec3 start = { 0.0f, 0.0f, 0.0f };
    for ( int k = 0; k < path->corner_count; ++k )
    {
        start = wisp_v3_mul_add( start, d->weights[k], path->from[k] );
    }
    const float gap = collision_plane_gap( view, &d->surface, wisp_v3_mul_add( start, 1.0f, m->motion ) );
    return gap >= -COLLISION_SHALLOW * view->thickness ? gap : collision_exact_gap( view, start, -1, gap );
}

static collision_primitive_contact contact_of( const find_loop* loop, const collision_view* view,
                                               const float weights[3] )
{
    return ( collision_primitive_contact ){
        .half_space = { .gap = view->thickness,
                        .static_friction = view->static_friction,
                        .kinetic_friction = view->kinetic_friction },
        .weights = { weights[0], weights[1], weights[2] },
        .body = (int32_t)( view->body - loop->state->bodies ),
    };
}

static void write_contact( const find_loop* loop, const collision_view* view, const int32_t* corners,
                           const primitive_path* path, const collision_meeting* m, collision_primitive_contact* out )
{
    const collision_deepest* d = &m->deepest;
    const wisp_vec3 point = wisp_transform_to_world( view->after, d->surface.point ),
                    normal = wisp_quat_rotate( view->after.rotation, d->surface.normal );
    *out = contact_of( loop, view, d->weights );
    collision_store( out->half_space.point, point );
    collision_store( out->half_space.normal, normal );
    const wisp_vec3 old = wisp_v3_sub( d->surface.point, m->motion );
    collision_store( out->half_space.motion, wisp_v3_sub( point, wisp_transform_to_world( view->before, old ) ) );
    // the start is measured again when other contacts have moved the corners: here what is not in the plane
    float along = 0.0f;
    for ( int k = 0; k < path->corner_count; ++k )
    {
        along += d->weights[k] * wisp_v3_dot( normal, wisp_v3_load( loop->previous + (size_t)corners[k] * 4 ) );
    }
    out->half_space.normal_correction = collision_meeting_gap( view, path, m ) - along;
}

static bool is_pinned( const find_loop* loop, const int32_t* corners, const float weights[3] )
{
    float sum = 0.0f;
    for ( int k = 0; k < loop->primitives.corner_count; ++k )
    {
        sum += loop->position[(size_t)corners[k] * 4 + 3] * weights[k] * weights[k];
    }
    return !( sum > 0.0f );
}

int collision_meet_body( const collision_view* view, const primitive_path* path, collision_meeting* out )
{
    if ( collision_has_features( view->body ) )
    {
        return collision_meet_features( view, path, out );
    }
    *out = ( collision_meeting ){ .motion = { 0.0f, 0.0f, 0.0f } };
    const bool meets = find_meeting( view, path, &out->deepest );
    return meets && ( path->corner_count == 2 || is_on_border( &out->deepest ) == false ) ? 1 : 0;
}

bool collision_take_meeting( const collision_view* view, const primitive_path* path,
                             const wisp_primitive_meeting* met, collision_meeting* out )
{
    wisp_vec3 corners[3], p = { 0.0f, 0.0f, 0.0f };
    *out = ( collision_meeting ){ .motion = p };
    corners_at( path, met->time, corners );
    for ( int k = 0; k < path->corner_count; ++k )
    {
        out->deepest.weights[k] = met->weights[k];
        p = wisp_v3_mul_add( p, met->weights[k], corners[k] );
    }
    return wisp_shape_closest( &view->body->shape, p, &out->deepest.surface );
}

// Make room for a contact of a primitive. @return null if it cannot be kept, or moves nothing
static collision_primitive_contact* place_contact( const find_loop* loop, int primitive, const float weights[3] )
{
    const collision_primitives* p = &loop->primitives;
    if ( is_pinned( loop, p->corners + (size_t)primitive * (size_t)p->corner_count, weights ) )
    {
        return NULL;
    }
    const int place = p->found[primitive]++;
    return place < COLLISION_PRIMITIVE_CONTACTS ? &p->contacts[primitive][place] : NULL;
}

// Add the contact of a primitive where it meets a closed form.
static void add_met( const find_loop* loop, const collision_view* of_all, const wisp_primitive_meeting* met )
{
    const collision_primitives* p = &loop->primitives;
    collision_primitive_contact* to = place_contact( loop, met->primitive, met->weights );
    if ( to == NULL )
    {
        return;
    }
    *to = contact_of( loop, of_all, met->weights );
    if ( loop->maps.thickness != NULL || loop->maps.friction != NULL )
    {
        collision_view view = *of_all;
        collision_view_at( &loop->maps, p->corners + (size_t)met->primitive * (size_t)p->corner_count,
                           p->corner_count, &view );
        *to = contact_of( loop, &view, met->weights );
    }
    memcpy( to->half_space.point, met->point, sizeof( met->point ) );
    memcpy( to->half_space.normal, met->normal, sizeof( met->normal ) );
    memcpy( to->half_space.motion, met->motion, sizeof( met->motion ) );
    to->half_space.normal_correction = met->start;
}

// Add the contacts of a primitive and a body that is no closed form.
static void meet_body( const find_loop* loop, const collision_view* of_all, int primitive )
{
    const collision_primitives* p = &loop->primitives;
    const int32_t* corners = p->corners + (size_t)primitive * (size_t)p->corner_count;
    collision_view view = *of_all;
    collision_view_at( &loop->maps, corners, p->corner_count, &view );
    primitive_path path;
    collision_meeting meetings[COLLISION_PRIMITIVE_CONTACTS];
    if ( load_path( loop, &view, corners, &path ) == false )
    {
        return;
    }
    if ( collision_has_features( view.body ) )
    {
        load_planes( loop, &view, corners, &path );
    }
    const int count = collision_meet_body( &view, &path, meetings );
    for ( int i = 0; i < count; ++i )
    {
        collision_primitive_contact* to = place_contact( loop, primitive, meetings[i].deepest.weights );
        if ( to != NULL )
        {
            write_contact( loop, &view, corners, &path, &meetings[i], to );
        }
    }
}

// ---- what may meet a body in the step ----

// What a body reaches in the rest of the step, or in the substep; of what is no closed form its box.
static void set_reach( const collision_view* view, bool in_step, wisp_shape_lanes* shape )
{
    collision_view seen = *view;
    collision_body box = *view->body;
    if ( collision_is_closed_form( &box ) == false )
    {
        box.shape = ( wisp_shape ){ .kind = WISP_SHAPE_BOX, .half_extent = box.half };
        seen.before.translation = wisp_transform_to_world( view->before, box.centre );
        seen.after.translation = wisp_transform_to_world( view->after, box.centre );
        seen.body = &box;
    }
    const float around = wisp_v3_length( view->body->centre );
    shape->turns = false;
    collision_set_shape( shape, 0, &seen, 0.0f );
    if ( in_step )
    {
        shape->shift[0] = view->body->is_coupled ? INFINITY : view->shift + view->turn * around;
        shape->rate[0] = view->turn;
    }
}

// Return the most that a point may be away from its nearest corner, squared, where contacts of a body of which a ball of a radius
// touches the inside are all left to corners: ( r + d )^2 - away^2 >= ( r + d - left )^2.
static float blunt_limit( const find_loop* loop, const collision_view* view )
{
    const bool is_round = collision_is_closed_form( view->body ) && view->body->shape.kind != WISP_SHAPE_BOX;
    const float left = LEFT_TO_CORNERS * view->thickness,
                limit = 0.98f * left * ( 2.0f * view->body->bluntness - left );
    return is_round && loop->maps.thickness == NULL && limit >= 0.25f * loop->longest * loop->longest ? limit : 0.0f;
}

// The place of a shape among the words of particles: the last ones share one.
static int32_t bit_of( int number )
{
    return (int32_t)( 1u << 4 * ( number < CLEAR_SHAPES ? number : CLEAR_SHAPES - 1 ) );
}

static bool walk_to_body( const find_loop* loop, collision_walk* walk, collision_view* view )
{
    return collision_walk_on( loop->frame, loop->span, loop->state, walk, INFINITY, view );
}

// In a crowd each asks the bodies that its points can meet, all others in no substep while it stays in its box.
static void begin_body_walk( find_loop* loop, int slots )
{
    wisp_vec3 lower = { INFINITY, INFINITY, INFINITY }, upper = { -INFINITY, -INFINITY, -INFINITY };
    for ( int i = 0; i < slots && loop->state->nearness.near_count > 0; ++i )
    {
        collision_widen( &lower, &upper, wisp_v3_load( loop->position + (size_t)i * 4 ) );
        collision_widen( &lower, &upper, wisp_v3_load( loop->previous + (size_t)i * 4 ) );
    }
    loop->walk = collision_begin_walk( loop->state, loop->span->entity, lower, upper );
}

static void find_away( find_loop* loop )
{
    collision_view view;
    loop->clear.away = 0.6f * loop->longest;
    for ( collision_walk walk = loop->walk; walk_to_body( loop, &walk, &view ); )
    {
        const float limit = blunt_limit( loop, &view );
        loop->clear.away = limit > 0.0f ? collision_smaller( sqrtf( limit ), loop->clear.away ) : loop->clear.away;
    }
}

static void clear_range( void* context, int begin, int end, int worker )
{
    (void)worker;
    const find_loop* loop = context;
    const wisp_kernels* kernels = wisp_frame_kernels( loop->frame );
    wisp_shape_lanes shapes[CLEAR_SHAPES];
    bool blunt[CLEAR_SHAPES];
    int32_t absent = 0;
    wisp_clear_args clear = loop->clear;
    clear.shapes = shapes;
    clear.blunt = blunt;
    collision_view view;
    for ( collision_walk walk = loop->walk; walk_to_body( loop, &walk, &view ); )
    {
        if ( collision_meets_primitives( view.body ) )
        {
            blunt[clear.count] = blunt_limit( loop, &view ) > 0.0f;
            set_reach( &view, clear.place != NULL, shapes + clear.count++ );
        }
        if ( clear.count == CLEAR_SHAPES )
        {
            kernels->clear_particles( &clear, begin, end );
            clear.first += clear.count;
            clear.count = 0;
        }
    }
    kernels->clear_particles( &clear, begin, end );
    // nothing is far from the places of no shape
    for ( int number = clear.first + clear.count; number < CLEAR_SHAPES; ++number )
    {
        absent |= bit_of( number );
    }
    for ( int i = begin; i < end; ++i )
    {
        clear.words[i] |= absent;
    }
}

static void list_near_range( void* context, int begin, int end, int worker )
{
    (void)worker;
    const find_loop* loop = context;
    const wisp_primitive_paths paths = paths_of( loop );
    loop->primitives.found[begin] =
        wisp_frame_kernels( loop->frame )->list_near_primitives( &paths, begin, end, loop->primitives.near + begin );
}

static void list_near( find_loop* loop, const wisp_parallel* parallel )
{
    const collision_primitives* p = &loop->primitives;
    wisp_parallel_for( parallel, p->count, PRIMITIVE_GRAIN, list_near_range, loop );
    int count = 0;
    for ( int begin = 0; begin < p->count; begin += PRIMITIVE_GRAIN )
    {
        memmove( p->near + count, p->near + begin, (size_t)p->found[begin] * sizeof( *p->near ) );
        count += p->found[begin];
    }
    *p->near_count = count;
}

// Return whether no particle has got farther, nor faster, than was expected when the lists were made.
static bool is_as_expected( const find_loop* loop, int slots, float pace )
{
    const wisp_kernels* kernels = wisp_frame_kernels( loop->frame );
    bool is_near = true;
    for ( int i = 0; i < slots; ++i )
    {
        const float *p = loop->position + (size_t)i * 4, *q = loop->previous + (size_t)i * 4,
                    longest = pace * loop->clear.place[(size_t)i * 4 + 3];
        const float x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
        is_near &= x * x + y * y + z * z <= longest * longest;
    }
    for ( int begin = 0; begin < slots && is_near; begin += COLLISION_BLOCK )
    {
        const int end = slots - begin < COLLISION_BLOCK ? slots : begin + COLLISION_BLOCK;
        is_near = kernels->find_unclear( loop->position, loop->previous, loop->clear.place, begin, end ) == 0;
    }
    return is_near;
}

// ---- the pass ----

// Find the contacts of some primitives that are near with a closed form.
static void meet_closed_form( const find_loop* loop, const collision_view* view, const int32_t* near, int count )
{
    const collision_primitives* p = &loop->primitives;
    const wisp_primitive_paths paths = paths_of( loop );
    wisp_primitive_meeting met[PRIMITIVE_GRAIN];
    float thickness[PRIMITIVE_GRAIN] = { 0.0f };
    for ( int i = 0; i < count && loop->maps.thickness != NULL; ++i )
    {
        collision_view at = *view;
        collision_view_at( &loop->maps, p->corners + (size_t)near[i] * (size_t)p->corner_count, p->corner_count,
                           &at );
        thickness[i] = at.thickness;
    }
    wisp_shape_lanes shape = { .turns = false };
    collision_set_shape( &shape, 0, view, 0.0f );
    const int n =
        wisp_frame_kernels( loop->frame )
            ->meet_shape( &paths, &shape, loop->maps.thickness != NULL ? thickness : NULL, near, count, met );
    for ( int i = 0; i < n; ++i )
    {
        add_met( loop, view, met + i );
    }
}

// Find contacts of those that may have some in this substep, and list them: behind the last of a range is -1.
static void find_range( void* context, int begin, int end, int worker )
{
    (void)worker;
    const find_loop* loop = context;
    const collision_primitives* p = &loop->primitives;
    const wisp_primitive_paths paths = paths_of( loop );
    int32_t *near = p->active + begin, looks[PRIMITIVE_GRAIN], some[PRIMITIVE_GRAIN];
    const int count = wisp_frame_kernels( loop->frame )
                          ->select_near_primitives( &paths, p->near + begin, end - begin, near, looks );
    for ( int i = 0; i < count; ++i )
    {
        p->found[near[i]] = 0;
    }
    collision_view view;
    int number = 0;
    for ( collision_walk walk = loop->walk; count > 0 && walk_to_body( loop, &walk, &view ); )
    {
        if ( collision_meets_primitives( view.body ) == false )
        {
            continue;
        }
        const bool is_closed_form = collision_is_closed_form( view.body );
        const int32_t bit = bit_of( number++ );
        int n = 0;
        for ( int i = 0; i < count; ++i )
        {
            some[n] = near[i];
            n += ( looks[i] & bit ) != 0 ? 1 : 0;
        }
        if ( is_closed_form )
        {
            meet_closed_form( loop, &view, some, n );
        }
        for ( int i = 0; i < n && is_closed_form == false; ++i )
        {
            meet_body( loop, &view, some[i] );
        }
    }
    if ( count < end - begin )
    {
        near[count] = -1;
    }
}

// ---- push-out ----

// Move the corners of a contact so that its point moves by a distance along the normal.
static void move_corners( const find_loop* loop, float* to, const int32_t* corners,
                          const collision_primitive_contact* c, float distance )
{
    const float* position = loop->position;
    const int corner_count = loop->primitives.corner_count;
    float sum = 0.0f;
    for ( int k = 0; k < corner_count; ++k )
    {
        sum += position[(size_t)corners[k] * 4 + 3] * c->weights[k] * c->weights[k];
    }
    for ( int k = 0; k < corner_count; ++k )
    {
        const size_t quad = (size_t)corners[k] * 4;
        const float part = position[quad + 3] * c->weights[k] / sum;
        collision_store( to + quad, wisp_v3_mul_add( wisp_v3_load( to + quad ), part * distance,
                                                     wisp_v3_load( c->half_space.normal ) ) );
        loop->clear.words[corners[k]] = 0x77777777; // near everything, for triangles behind edges
    }
}

// Return how far the point of a contact is along its normal, beyond a distance.
static float along_normal( const find_loop* loop, const int32_t* corners, const collision_primitive_contact* c,
                           const float* rows, float beyond )
{
    const wisp_vec3 n = wisp_v3_load( c->half_space.normal );
    float sum = -beyond;
    for ( int k = 0; k < loop->primitives.corner_count; ++k )
    {
        sum += c->weights[k] * wisp_v3_dot( n, wisp_v3_load( rows + (size_t)corners[k] * 4 ) );
    }
    return sum;
}

// Return a contact's distance at the start of the substep, less the thickness.
static float starts_at( const find_loop* loop, const int32_t* corners, const collision_primitive_contact* c )
{
    return along_normal( loop, corners, c, loop->previous, -c->half_space.normal_correction );
}

// Return the one now.
static float ends_at( const find_loop* loop, const int32_t* corners, const collision_primitive_contact* c )
{
    const wisp_vec3 n = wisp_v3_load( c->half_space.normal ), q = wisp_v3_load( c->half_space.point );
    return along_normal( loop, corners, c, loop->position, wisp_v3_dot( n, q ) + c->half_space.gap );
}

// Complete a contact: its gap, and what moves out a point that starts too near, as find_push_out() of the kernel half_space_rows
// does for particles. @param most m, that it is moved out; negative: not at all, and it gets no nearer
static void push_out( const find_loop* loop, const int32_t* corners, float most, collision_primitive_contact* c )
{
    const int corner_count = loop->primitives.corner_count;
    const float shallow = COLLISION_SHALLOW * c->half_space.gap;
    const float start = starts_at( loop, corners, c );
    c->half_space.normal_correction = 0.0f;
    if ( start >= 0.0f )
    {
        return;
    }
    const float now = ends_at( loop, corners, c );
    const float outward = collision_larger( now - start, 0.0f );
    const float depth = collision_larger( -start - outward, 0.0f );
    const float recovered = collision_smaller( depth, collision_larger( most - outward, 0.0f ) );
    const float absorbed = start < -shallow ? outward : 0.0f;
    c->half_space.gap += start + recovered;
    if ( most < 0.0f )
    {
        return;
    }
    float before[3][6];
    for ( int k = 0; k < corner_count; ++k )
    {
        memcpy( before[k], loop->position + (size_t)corners[k] * 4, 3 * sizeof( float ) );
        memcpy( before[k] + 3, loop->previous + (size_t)corners[k] * 4, 3 * sizeof( float ) );
    }
    move_corners( loop, loop->position, corners, c, recovered );
    move_corners( loop, loop->previous, corners, c, recovered + absorbed );
    collision_impulse* sums = collision_reaction_sums( loop->frame, loop->span->entity, loop->state, 0 );
    for ( int k = 0; k < corner_count && sums != NULL; ++k )
    {
        const size_t quad = (size_t)corners[k] * 4;
        if ( loop->position[quad + 3] > 0.0f )
        {
            const double mass = 1.0 / (double)loop->position[quad + 3];
            const double dt = (double)wisp_frame_dt( loop->frame, loop->span->entity );
            collision_add_reaction( sums[c->body], mass / dt, wisp_v3_load( before[k] ),
                                    wisp_v3_load( before[k] + 3 ), wisp_v3_load( loop->position + quad ),
                                    wisp_v3_load( loop->previous + quad ) );
        }
    }
}

// ---- squeezed primitives: as vertices are in squeeze.c ----

// Return the least gap that a squeezed corner has from the side of a contact; infinity if none is squeezed from there. Before the
// projection only contacts that squeeze have a correction.
static float squeezed_gap( const find_loop* loop, const int32_t* corners, const collision_contact* c )
{
    float least = INFINITY;
    for ( int k = 0; k < loop->primitives.corner_count && loop->contact_counts != NULL; ++k )
    {
        const collision_contact* of_corner = loop->particle_contacts[corners[k]];
        for ( int i = 0; i < loop->contact_counts[corners[k]] && i < WISP_COLLISION_CONTACTS; ++i )
        {
            const bool loaded = of_corner[i].normal_correction > 0.0f &&
                                wisp_v3_dot( wisp_v3_load( of_corner[i].normal ), wisp_v3_load( c->normal ) ) > 0.0f;
            least = loaded ? collision_smaller( of_corner[i].gap, least ) : least;
        }
    }
    return least;
}

// Hold a primitive that two bodies squeeze between its corners in the middle, and load its contacts. @return whether it is one
static bool squeeze_pair( const find_loop* loop, const int32_t* corners, float most, collision_primitive_contact* c )
{
    const float dt = wisp_frame_dt( loop->frame, loop->span->entity );
    const wisp_vec3 normals[2] = { wisp_v3_load( c[0].half_space.normal ), wisp_v3_load( c[1].half_space.normal ) };
    const float oppose = -wisp_v3_dot( normals[0], normals[1] ), both = c[0].half_space.gap + c[1].half_space.gap;
    float aside = 0.5f * ( starts_at( loop, corners, c ) - starts_at( loop, corners, c + 1 ) );
    const float depth = -ends_at( loop, corners, c ) - ends_at( loop, corners, c + 1 );
    if ( collision_is_squeezed( oppose, depth, both ) == false )
    {
        return false;
    }
    const float shift = collision_larger( -most, collision_smaller( -aside, most ) );
    move_corners( loop, loop->position, corners, c, shift );
    move_corners( loop, loop->previous, corners, c, shift );
    aside = 0.5f * ( starts_at( loop, corners, c ) - starts_at( loop, corners, c + 1 ) );
    collision_impulse* sums = collision_reaction_sums( loop->frame, loop->span->entity, loop->state, 0 );
    // the force is that of the mean mass of free corners; the correction that stands for it is of the point
    float inverse_mass = 0.0f, mean_mass = 0.0f;
    wisp_vec3 at = { 0.0f, 0.0f, 0.0f };
    for ( int k = 0; k < loop->primitives.corner_count; ++k )
    {
        const float* p = loop->position + (size_t)corners[k] * 4;
        const float b = c[0].weights[k];
        inverse_mass += p[3] * b * b;
        mean_mass += p[3] > 0.0f ? b / p[3] : 0.0f;
        at = wisp_v3_mul_add( at, b, wisp_v3_load( p ) );
    }
    const float load = collision_squeeze_load( dt, oppose, depth, both ) * mean_mass * inverse_mass;
    for ( int i = 0; i < 2; ++i )
    {
        c[i].half_space.gap += ( i == 0 ? aside : -aside ) - 0.5f * depth;
        c[i].half_space.normal_correction = load;
        if ( sums != NULL )
        {
            const wisp_vec3 axis = wisp_v3_sub( normals[i], normals[1 - i] ), none = { 0.0f, 0.0f, 0.0f };
            const wisp_vec3 push = wisp_v3_mul_add( none, load / wisp_v3_length( axis ), axis );
            collision_add_impulse( sums[c[i].body], 1.0 / ( (double)inverse_mass * (double)dt ), none, push, at );
        }
    }
    return true;
}

static void complete_contacts( const find_loop* loop, int primitive, float recovery )
{
    const collision_primitives* p = &loop->primitives;
    const int32_t* corners = p->corners + (size_t)primitive * (size_t)p->corner_count;
    collision_primitive_contact* c = p->contacts[primitive];
    const int count = collision_contacts_of( p, primitive );
    float held[COLLISION_PRIMITIVE_CONTACTS] = { INFINITY, INFINITY };
    for ( int k = 0; k < count && recovery >= 0.0f && loop->state->body_count > 1; ++k )
    {
        held[k] = squeezed_gap( loop, corners, &c[k].half_space );
    }
    if ( recovery >= 0.0f && count == 2 && held[0] == INFINITY && held[1] == INFINITY &&
         squeeze_pair( loop, corners, recovery, c ) )
    {
        return;
    }
    for ( int k = 0; k < count; ++k )
    {
        push_out( loop, corners, held[k] < INFINITY ? -1.0f : recovery, c + k );
        c[k].half_space.gap = collision_smaller( c[k].half_space.gap, held[k] );
    }
}

static void list_active( const find_loop* loop, float recovery )
{
    const collision_primitives* p = &loop->primitives;
    int count = 0;
    for ( int begin = 0; begin < *p->near_count; begin += PRIMITIVE_GRAIN )
    {
        const int end = *p->near_count - begin < PRIMITIVE_GRAIN ? *p->near_count : begin + PRIMITIVE_GRAIN;
        for ( int i = begin; i < end; ++i )
        {
            const int32_t primitive = p->active[i];
            if ( primitive < 0 )
            {
                p->active[i] = 0;
                break;
            }
            p->active[count] = primitive;
            count += p->found[primitive] > 0 ? 1 : 0;
        }
    }
    *p->active_count = count;
    for ( int a = 0; a < count; ++a )
    {
        complete_contacts( loop, p->active[a], recovery );
    }
}

void collision_search_primitives( wisp_frame* frame, const wisp_span* span, const collision_state* state,
                                  float recovery )
{
    find_loop loop = {
        .frame = frame,
        .span = span,
        .state = state,
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 ),
        .contact_counts = wisp_frame_column( frame, span->entity, WISP_PARTICLE_HALF_SPACES, 0 ),
        .particle_contacts = wisp_frame_column( frame, span->entity, WISP_PARTICLE_HALF_SPACES, 2 ),
        .maps = collision_maps_of( frame, span->entity, state ),
    };
    const collision_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const int slots = wisp_frame_fabric( frame, span->entity )->slot_count;
    const int left = wisp_frame_substeps( frame, span->entity ) - span->substep;
    const float seconds = (float)left * wisp_frame_dt( frame, span->entity );
    loop.clear = ( wisp_clear_args ){
        .position = loop.position,
        .previous = loop.previous,
        .ahead = COLLISION_MARGIN * (float)left,
        .room = ROOM * settings->thickness + SPEEDING * seconds * seconds,
        .words = wisp_frame_column( frame, span->entity, state->clearance, 0 ),
        .place = wisp_frame_column( frame, span->entity, state->clearance, 1 ),
    };
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    float* pace = wisp_frame_column( frame, span->entity, state->all_features, 5 );
    begin_body_walk( &loop, slots );
    const bool is_lost = loop.walk.near == NULL && state->nearness.near_count > 0;
    const bool is_new =
        ( span->substep == 0 && recovery >= 0.0f ) || is_lost || is_as_expected( &loop, slots, *pace ) == false;
    loop.longest = *(const float*)wisp_frame_column( frame, span->entity, state->all_features, 4 );
    find_away( &loop );
    if ( is_new )
    {
        *pace = PACE / loop.clear.ahead;
        wisp_parallel_for( parallel, slots, PRIMITIVE_GRAIN, clear_range, &loop );
    }
    collision_primitives lists[2];
    for ( int i = 0; i < 2; ++i )
    {
        loop.primitives = lists[i] = collision_primitives_of( frame, span->entity, state, 2 + i );
        if ( is_new )
        {
            list_near( &loop, parallel );
        }
    }
    // the same of this substep alone, which leaves out most of what is listed
    loop.clear.place = NULL;
    loop.clear.ahead = 1.0f;
    loop.clear.room = LITTLE * settings->thickness;
    if ( *lists[0].near_count + *lists[1].near_count > 0 )
    {
        wisp_parallel_for( parallel, slots, PRIMITIVE_GRAIN, clear_range, &loop );
    }
    for ( int i = 0; i < 2; ++i )
    {
        loop.primitives = lists[i];
        wisp_parallel_for( parallel, *loop.primitives.near_count, PRIMITIVE_GRAIN, find_range, &loop );
        list_active( &loop, recovery );
    }
}

void collision_find_primitives( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    const collision_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    collision_search_primitives( frame, span, state,
                                 settings->max_push_out_speed * wisp_frame_dt( frame, span->entity ) );
}
