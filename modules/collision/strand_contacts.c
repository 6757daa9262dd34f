// Contacts of strands, once per iteration, before the constraints that restore lengths. In: positions, previous
// positions. Out: both, and per vertex the depth that the next iteration may keep.
//
// - Nothing is found in advance and no contact is stored, so the pass stays in the item loop of strands. The kernel
//   strand_contact answers closed forms for sixteen strands at once and has the contact law. A group whose box is
//   away from the ball around a body costs one test.
// - Meshes are queried vertex by vertex with the whole path, and so are closed forms that move so fast (more than the
//   smallest of their half sizes in a substep) that the end of a path may lie behind the middle of the body.
// - Segments meet bodies that are too thin for vertices, in the points that primitive_contacts.c finds for edges of cloth on the path of
//   the substep, which a body passes at no speed. A push moves both vertices, dx_k = w_k b_k d / sum w_j b_j^2. Sums are kept for each
//   segment, from zero in each substep, and nothing is taken back: the next substep, or meeting, may be with another plane.
// - The depth of a vertex is kept from substep to substep. A vertex that starts inside is moved out at the recovery
//   speed with its previous position. A vertex that restored lengths pulled in is pushed out at once, with the
//   velocity that undoes the pull: else a strand under tension sinks into a head faster than it recovers (links on a
//   shaking head: 0.37 of a segment, now 0.08). A depth of more than one thickness counts as a start inside.
// - Friction is Coulomb's for the sum of the pushes of the substep, of a vertex. Strands that are pushed take
//   turns with their lengths, so that friction feels their tension: a rope over a rod holds. Turns start with pushes and
//   friction of the last substep, and may take back what a body has pushed, never more, however far the vertex is by then: taken
//   back only near a mesh, four substeps held a rope from 1.28 of the critical friction on, not from 1.13 (`wisp validate capstan`).
//   Lengths in turns are those of the direct solve: links and bend links are as stiff as their sweeps are many, so each turn would
//   stiffen them where a body is, and none would be the last (hair on a head: eight turns in every substep, three times as long).
// - A push comes last, so lengths may end too long: on a rope of 1.3 m by 0.02 % with 10 substeps, 0.1 % with 4. A push that changes
//   little needs no lengths behind it: strands that rest on a body take none but those of their iterations.
// - The nearest face decides. A strand put right through a box, whose ends have different nearest faces, stays
//   speared. Vertices near a sharp edge creep by 0.02 of the thickness per substep.
// - Cost per vertex, iteration and substep (one worker of a busy Zen 3): 330 ns on a mesh of 2 048 triangles, 3 to 10
//   ns on a closed form, 3 ns away from all bodies.
#include "body_queries.h"
#include "collision_state.h"
#include "near_bodies.h"
#include "primitive_contacts.h"
#include "reaction.h"

#include <math.h>
#include <string.h>

enum
{
    LENGTH_TURNS = 8,   // of pushes and lengths in a substep
    SEGMENT_TURNS = 16, // the same of segments
    ABREAST = 2,        // groups whose lengths are solved side by side, in a fifth less time than one after another
    // iterations behind those of a substep; the first one is of turns with contact, where a body takes nothing back
    TURN = 1,
    EXACT = 2, // segments end without a factor
    LENGTHS = 3,
};

// Change of the pushes of a strand by a turn that needs no further one, thicknesses/s, in the mean over those of a group that are pushed. More
// lets ropes creep by 0.1 mm/s.
static const float SMALL_PUSH = 1.5f;

// Most that the push of a segment in a turn is multiplied by. More converges faster, and may throw hair that is hit at 5 m/s.
static const float MAX_FACTOR = 4.0f;

typedef struct strand_loop
{
    int32_t* tracked; // [row][COLLISION_TRACKS][lane] closest triangles; null if no body is tracked
    float* free;      // m, the same way: at least the distance of `origin` from the body
    float* origin;    // m, [row][COLLISION_TRACKS][3][lane] in the frame of the body: where this was found
    bool is_first;    // pass of the step
    int substeps_left;
    wisp_strand_contact_args args;         // without the body
    bool has_segments, meets_all, is_turn; // meets_all: segments meet all bodies
    float* segment_push;                   // [row][lane] m, of the last call
    wisp_strand_contact_args segments;     // the same with the sums of segments
    const int32_t* lane_count;             // [lane] vertices
    const wisp_kernels* kernels;
    const collision_body* bodies;
    bool is_shared; // in turns with contact
    int group;
    wisp_strand_bounds reach; // of the group
    // for reactions, else null
    collision_impulse* sums; // [body] of the group
    float dt;
} strand_loop;

// ---- culling ----

// Return an upper bound of the path of a vertex in the frame of the body. A rigid motion moves a box most at one of
// its corners, and all of them alike if it does not turn.
static float path_seen( const strand_loop* loop, const collision_view* view )
{
    const wisp_transform *from = &view->before, *to = &view->after;
    const bool turns = memcmp( &from->rotation, &to->rotation, sizeof( wisp_quat ) ) != 0;
    float most = turns ? 0.0f : wisp_v3_length( wisp_v3_sub( to->translation, from->translation ) );
    for ( int corner = 0; corner < 8 && turns; ++corner )
    {
        const wisp_vec3 c = {
            ( corner & 1 ) != 0 ? loop->reach.upper.x : loop->reach.lower.x,
            ( corner & 2 ) != 0 ? loop->reach.upper.y : loop->reach.lower.y,
            ( corner & 4 ) != 0 ? loop->reach.upper.z : loop->reach.lower.z,
        };
        const wisp_vec3 body_motion = wisp_transform_to_world( *to, wisp_transform_to_local( *from, c ) );
        most = fmaxf( most, wisp_v3_length( wisp_v3_sub( body_motion, c ) ) );
    }
    return most + loop->reach.max_path + collision_surface_shift( view );
}

static float beside( float x, float lower, float upper )
{
    return fmaxf( 0.0f, fmaxf( lower - x, x - upper ) );
}

// Return a lower bound of the distance of the group's box from the ball around the body at a pose, m.
static float apart_at( const strand_loop* loop, const collision_body* body, wisp_transform pose )
{
    const wisp_vec3 c = wisp_transform_to_world( pose, body->centre );
    const wisp_vec3 d = { beside( c.x, loop->reach.lower.x, loop->reach.upper.x ),
                          beside( c.y, loop->reach.lower.y, loop->reach.upper.y ),
                          beside( c.z, loop->reach.lower.z, loop->reach.upper.z ) };
    return wisp_v3_length( d ) - body->ball_radius;
}

// ---- one vertex ----

typedef struct strand_push
{
    float out;       // m, outward displacement of the position; below 0: taken back
    float recovered; // m, the part of it that gives no velocity
    float absorbed;  // m, own outward displacement that gives none either
    float left;      // m, depth that stays
} strand_push;

// Compute the displacement of a vertex, as the kernel strand_contact does.
static strand_push find_push( const strand_loop* loop, float thickness, float start, float now, float depth,
                              float least )
{
    const float began = fmaxf( 0.0f, thickness - start );
    const float may = began > depth + thickness ? began : fminf( depth, began );
    const float outward = fmaxf( 0.0f, now - start - ( began - may ) );
    const float left = fmaxf( 0.0f, may - outward );
    strand_push push;
    push.recovered = fminf( left, fmaxf( 0.0f, loop->args.max_push_out - outward ) );
    push.left = left - push.recovered;
    push.out = fmaxf( least, thickness - push.left - now );
    push.absorbed = may > COLLISION_SHALLOW * thickness ? outward : 0.0f;
    return push;
}

static wisp_vec3 tangential( wisp_vec3 u, wisp_vec3 normal )
{
    return wisp_v3_mul_add( u, -wisp_v3_dot( normal, u ), normal );
}

// Return the friction of the substep. @param u what it would have to remove, push the sum of the substep
static wisp_vec3 friction_of( const collision_view* view, wisp_vec3 u, float push )
{
    const float length = wisp_v3_length( u );
    const float fraction = length <= view->static_friction * push ? 1.0f : view->kinetic_friction * push / length;
    return ( wisp_vec3 ){ fraction * u.x, fraction * u.y, fraction * u.z };
}

// A point of a strand: a vertex, or a point between two.
typedef struct strand_point
{
    const wisp_strand_contact_args* sums;
    size_t i;         // its place in them
    int count;        // vertices
    size_t corner[2]; // their places in rows of vectors
    float weight[2];
    float part[2]; // displacement of a vertex per displacement of the point
    float factor;  // on corrections
} strand_point;

static wisp_vec3 place_of( const strand_point* q, const float* rows )
{
    wisp_vec3 p = { 0.0f, 0.0f, 0.0f };
    for ( int k = 0; k < q->count; ++k )
    {
        p = wisp_v3_mul_add( p, q->weight[k], collision_load_lane( rows + q->corner[k] ) );
    }
    return p;
}

static void move_by( const strand_point* q, float* rows, float distance, wisp_vec3 along )
{
    for ( int k = 0; k < q->count; ++k )
    {
        float* at = rows + q->corner[k];
        collision_store_lane( at, wisp_v3_mul_add( collision_load_lane( at ), q->part[k] * distance, along ) );
    }
}

// Pushes in turns with contact are no start for the next substep: contact takes nothing back.
static float number_of( const strand_loop* loop, const collision_view* view )
{
    return loop->is_shared ? -1.0f : (float)( view->body - loop->bodies );
}

// What a body has done to a point so far.
typedef struct strand_sum
{
    float sum; // m, of pushes
    bool is_held, is_own, starts;
    float least; // m, push, below 0: what may be taken back, or the last substep's
    float reach; // m, at which the body acts
} strand_sum;

static strand_sum sum_of( const strand_loop* loop, const collision_view* view, const wisp_strand_contact_args* sums,
                          size_t i )
{
    const float sum = sums->normal_correction[i];
    const bool is_held = sum > 0.0f, is_own = sums->body[i] == number_of( loop, view );
    const bool starts = sums->starts && is_own && sum < 0.0f, gives = sums->gives_back && is_own && is_held;
    const float least = starts || gives ? -sum : 0.0f;
    return ( strand_sum ){ sum, is_held, is_own, starts, least, gives ? INFINITY : view->thickness + least };
}

// Keep a point a thickness away from a plane. @param start m, distance from the plane at the start of the substep
// @param now m, the same now @param body_motion of the plane in the substep
static void push_point( const strand_loop* loop, const collision_view* view, const strand_point* q,
                        const strand_sum* s, const wisp_surface_point* plane, float start, float now,
                        wisp_vec3 body_motion )
{
    const wisp_strand_contact_args* sums = q->sums;
    strand_push push = find_push( loop, view->thickness, start, now, sums->allowed_depth[q->i], s->least );
    push.out *= q->factor;
    const wisp_vec3 normal = wisp_quat_rotate( view->after.rotation, plane->normal );
    move_by( q, sums->position, push.out, normal );
    move_by( q, sums->previous, push.recovered + push.absorbed, normal );
    const wisp_vec3 turned = wisp_v3_sub( wisp_transform_to_world( view->after, plane->point ),
                                          wisp_transform_to_world( view->before, plane->point ) );
    const wisp_vec3 motion = wisp_v3_mul_add( turned, 1.0f, body_motion );
    sums->normal_correction[q->i] = fmaxf( 0.0f, s->sum ) + fmaxf( s->least, push.out - push.recovered );
    sums->body[q->i] = s->is_held && s->is_own == false ? -1.0f : number_of( loop, view );
    float* rubbed = sums->friction + q->i / WISP_LANES * COLLISION_ROW + q->i % WISP_LANES;
    const wisp_vec3 last = tangential( collision_load_lane( rubbed ), normal ),
                    before = s->is_held ? last : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    const wisp_vec3 moved = wisp_v3_sub( place_of( q, sums->position ), place_of( q, sums->previous ) );
    const wisp_vec3 u = tangential( wisp_v3_sub( moved, motion ), normal );
    const wisp_vec3 friction = friction_of( view, s->starts ? last : wisp_v3_mul_add( before, q->factor, u ),
                                            sums->normal_correction[q->i] );
    move_by( q, sums->position, -1.0f, wisp_v3_sub( friction, before ) );
    collision_store_lane( rubbed, friction );
    sums->remaining_depth[q->i] = fmaxf( sums->remaining_depth[q->i], push.left );
}

static void push_vertex( strand_loop* loop, const collision_view* view, int row, int lane, wisp_vec3 from,
                         wisp_vec3 to, const wisp_surface_point* nearest, wisp_vec3 body_motion, int32_t seed )
{
    // as path_along() of contact_generation.c
    const bool is_solid = view->body->follows && view->body->double_sided == false;
    const wisp_vec3 along = wisp_v3_sub( to, is_solid ? wisp_v3_mul_add( from, 1.0f, body_motion ) : from );
    const float path = wisp_v3_length( along ) + ( is_solid ? 0.0f : collision_surface_shift( view ) );
    wisp_vec3 swept_motion;
    wisp_surface_point plane;
    const bool swept = fabsf( nearest->distance ) <= path && collision_cast( view, from, to, &plane, &swept_motion );
    body_motion = swept ? swept_motion : body_motion;
    plane = swept ? plane : *nearest;
    const float now = swept ? wisp_v3_dot( plane.normal, wisp_v3_sub( to, plane.point ) ) : nearest->distance;
    const strand_point point = { .sums = &loop->args,
                                 .i = (size_t)row * WISP_LANES + (size_t)lane,
                                 .count = 1,
                                 .corner = { (size_t)row * COLLISION_ROW + (size_t)lane },
                                 .weight = { 1.0f },
                                 .part = { 1.0f },
                                 .factor = 1.0f };
    const strand_sum s = sum_of( loop, view, point.sums, point.i );
    if ( now < s.reach )
    {
        const float start = collision_start_gap( view, &plane, from, body_motion, false, seed ) + view->thickness;
        push_point( loop, view, &point, &s, &plane, start, now, body_motion );
    }
}

static bool has_strand_tracks( const strand_loop* loop, const collision_view* view )
{
    return loop->tracked != NULL && view->body->tree != NULL && view->body->track >= 0;
}

static wisp_vec3 lane_of( float ( *x )[WISP_LANES], int lane )
{
    return ( wisp_vec3 ){ x[0][lane], x[1][lane], x[2][lane] };
}

// What is kept of a row of vertices.
typedef struct strand_tracks
{
    int32_t* triangle;
    float *free, *origin;
} strand_tracks;

static strand_tracks tracks_of( const strand_loop* loop, const collision_view* view, int row )
{
    const size_t at = ( (size_t)row * COLLISION_TRACKS + (size_t)view->body->track ) * WISP_LANES;
    return ( strand_tracks ){ loop->tracked + at, loop->free + at, loop->origin + 3 * at };
}

static wisp_strand_contact_args args_with( const strand_loop* loop, const collision_view* view )
{
    wisp_strand_contact_args args = loop->args;
    args.body_number = number_of( loop, view );
    args.shape = view->body->shape;
    args.before = view->before;
    args.after = view->after;
    args.thickness = view->thickness;
    args.static_friction = view->static_friction;
    args.kinetic_friction = view->kinetic_friction;
    return args;
}

// Push a row of vertices that are tracked. @param seeds [lane] triangle near the vertex before, or -1
static void push_tracked_row( strand_loop* loop, const collision_view* view, const wisp_strand_contact_args* args,
                              int row, int32_t* seeds )
{
    wisp_strand_row r;
    const strand_tracks t = tracks_of( loop, view, row );
    uint32_t bound = loop->kernels->strand_see_row( args, row, loop->is_first ? NULL : t.free, t.origin, &r );
    const float shift = collision_surface_shift( view );
    int lanes[WISP_LANES], n = 0;
    int32_t from[WISP_LANES];
    collision_tracked_query queries[WISP_LANES];
    collision_track tracks[WISP_LANES];
    for ( ; bound != 0; bound &= bound - 1 )
    {
        const int l = lanes[n] = __builtin_ctz( bound );
        const float ahead = COLLISION_MARGIN * r.path[l] * (float)loop->substeps_left;
        queries[n] = ( collision_tracked_query ){ lane_of( r.to, l ), r.near[l] + shift, r.near[l], ahead };
        tracks[n] = ( collision_track ){ t.triangle[l], t.free[l], collision_load_lane( t.origin + l ) };
        from[n++] = seeds[l];
    }
    wisp_surface_point nearest[WISP_LANES];
    bool is_near[WISP_LANES];
    wisp_vec3 motion[WISP_LANES];
    collision_track_closest( loop->kernels, view, queries, tracks, n, loop->is_first, from, nearest, is_near,
                             motion );
    for ( int i = 0; i < n; ++i )
    {
        const int l = lanes[i];
        t.triangle[l] = seeds[l] = tracks[i].triangle;
        t.free[l] = tracks[i].free;
        collision_store_lane( t.origin + l, tracks[i].origin );
        if ( is_near[i] )
        {
            push_vertex( loop, view, row, l, lane_of( r.from, l ), queries[i].point, nearest + i, motion[i],
                         tracks[i].triangle );
        }
    }
}

static void push_strand_row( strand_loop* loop, const collision_view* view, const wisp_strand_contact_args* args,
                             int row )
{
    int lanes[WISP_LANES], n = 0;
    wisp_mesh_query queries[WISP_LANES];
    wisp_surface_point nearest[WISP_LANES];
    bool is_near[WISP_LANES];
    wisp_vec3 motion[WISP_LANES];
    wisp_strand_row r;
    const uint32_t moving = loop->kernels->strand_see_row( args, row, NULL, NULL, &r );
    for ( int l = 0; l < WISP_LANES; ++l )
    {
        const wisp_vec3 to = lane_of( r.to, l );
        const float reach = r.near[l] + collision_surface_shift( view );
        // false for NaN too
        if ( ( moving >> l & 1u ) != 0 && collision_box_distance( view->body, to ) <= reach )
        {
            lanes[n] = l;
            queries[n++] = ( wisp_mesh_query ){ .point = to, .radius = reach, .time = view->end };
        }
    }
    collision_closest( view, queries, n, nearest, is_near, motion );
    for ( int i = 0; i < n; ++i )
    {
        if ( is_near[i] )
        {
            push_vertex( loop, view, row, lanes[i], lane_of( r.from, lanes[i] ), queries[i].point, nearest + i,
                         motion[i], -1 );
        }
    }
}

// ---- segments ----

// A box in the world around a body on its way through the substep, wider by the thickness and by what chords cut off.
static wisp_strand_bounds box_around( const strand_loop* loop, const collision_view* view )
{
    const wisp_transform poses[2] = { view->before, view->after };
    const wisp_vec3 half = view->body->half;
    const float more = view->thickness + 0.5f * path_seen( loop, view );
    wisp_strand_bounds box = { .lower = { INFINITY, INFINITY, INFINITY },
                               .upper = { -INFINITY, -INFINITY, -INFINITY } };
    for ( int pose = 0; pose < 2; ++pose )
    {
        const wisp_vec3 centre = wisp_transform_to_world( poses[pose], view->body->centre );
        const wisp_vec3 sides[3] = { { half.x, 0.0f, 0.0f }, { 0.0f, half.y, 0.0f }, { 0.0f, 0.0f, half.z } };
        wisp_vec3 extent = { more, more, more };
        for ( int side = 0; side < 3; ++side )
        {
            const wisp_vec3 turned = wisp_quat_rotate( poses[pose].rotation, sides[side] );
            extent = wisp_v3_add( extent, ( wisp_vec3 ){ fabsf( turned.x ), fabsf( turned.y ), fabsf( turned.z ) } );
        }
        collision_widen( &box.lower, &box.upper, wisp_v3_sub( centre, extent ) );
        collision_widen( &box.lower, &box.upper, wisp_v3_add( centre, extent ) );
    }
    return box;
}

static strand_point point_between( const strand_loop* loop, int row, int lane, const float weights[2] )
{
    const size_t i = (size_t)row * WISP_LANES + (size_t)lane;
    strand_point q = { .sums = &loop->segments, .i = i, .count = 2, .factor = 1.0f };
    float sum = 0.0f;
    for ( int k = 0; k < 2; ++k )
    {
        q.corner[k] = (size_t)( row + k ) * COLLISION_ROW + (size_t)lane;
        q.weight[k] = weights[k];
        q.part[k] = loop->args.inverse_mass[i + (size_t)k * WISP_LANES] * weights[k];
        sum += q.part[k] * weights[k];
    }
    for ( int k = 0; k < 2; ++k )
    {
        q.part[k] = sum > 0.0f ? q.part[k] / sum : 0.0f; // 0: the point is at a root
    }
    return q;
}

// Push a segment. In turns lengths take back nearly all of a push where it has to move a whole tail. From the part that they
// took of the last one follows what is missing (a secant).
static void push_again( const strand_loop* loop, const collision_view* view, strand_point* q, const strand_sum* s,
                        const wisp_surface_point* plane, float start, float now, wisp_vec3 body_motion )
{
    float* last = loop->segment_push + q->i;
    const float before = fmaxf( 0.0f, s->sum ), missing = view->thickness - now;
    if ( loop->is_turn && *last > 0.0f )
    {
        q->factor = missing < *last ? fminf( *last / ( *last - missing ), MAX_FACTOR ) : MAX_FACTOR;
    }
    push_point( loop, view, q, s, plane, start, now, body_motion );
    *last = q->sums->normal_correction[q->i] - before;
}

// @param met where it meets a closed form; null: the body is none
static void push_segment( const strand_loop* loop, const collision_view* view, const wisp_primitive_meeting* met,
                          int row, int lane, double* sum )
{
    primitive_path path = { .corner_count = 2 };
    wisp_vec3 before[2][2];
    bool is_finite = true;
    for ( int k = 0; k < 2; ++k )
    {
        const size_t corner = (size_t)( row + k ) * COLLISION_ROW + (size_t)lane;
        before[k][0] = collision_load_lane( loop->args.position + corner );
        before[k][1] = collision_load_lane( loop->args.previous + corner );
        path.to[k] = wisp_transform_to_local( view->after, before[k][0] );
        path.from[k] = wisp_transform_to_local( view->before, before[k][1] );
        is_finite = is_finite && collision_is_finite( path.from[k] ) && collision_is_finite( path.to[k] );
        path.displacement =
            collision_larger( path.displacement, wisp_v3_length( wisp_v3_sub( path.to[k], path.from[k] ) ) );
    }
    collision_meeting meetings[COLLISION_PRIMITIVE_CONTACTS];
    const int count = is_finite == false ? 0
                      : met == NULL      ? collision_meet_body( view, &path, meetings )
                      : collision_take_meeting( view, &path, met, meetings ) ? 1
                                                                             : 0;
    for ( int m = 0; m < count; ++m )
    {
        const wisp_surface_point* plane = &meetings[m].deepest.surface;
        strand_point q = point_between( loop, row, lane, meetings[m].deepest.weights );
        const wisp_vec3 p = wisp_transform_to_local( view->after, place_of( &q, loop->args.position ) );
        const float now = wisp_v3_dot( plane->normal, wisp_v3_sub( p, plane->point ) );
        const strand_sum s = sum_of( loop, view, q.sums, q.i );
        if ( now < s.reach )
        {
            const float start = collision_meeting_gap( view, &path, &meetings[m] ) + view->thickness;
            push_again( loop, view, &q, &s, plane, start, now, meetings[m].motion );
        }
    }
    for ( int k = 0; k < 2 && count > 0 && sum != NULL; ++k )
    {
        const size_t i = (size_t)( row + k ) * WISP_LANES + (size_t)lane;
        const size_t corner = (size_t)( row + k ) * COLLISION_ROW + (size_t)lane;
        if ( loop->args.inverse_mass[i] > 0.0f )
        {
            collision_add_reaction( sum, 1.0 / ( (double)loop->args.inverse_mass[i] * (double)loop->dt ),
                                    before[k][0], before[k][1], collision_load_lane( loop->args.position + corner ),
                                    collision_load_lane( loop->args.previous + corner ) );
        }
    }
}

// Push segments of a row, which share no vertex, by a body in closed form. @param near their bits
static void push_row_from_shape( const strand_loop* loop, const collision_view* view, const wisp_shape_lanes* shape,
                                 int row, uint32_t near, double* sum )
{
    _Alignas( 16 ) float ends[2][2 * WISP_LANES][4];
    int32_t corners[2 * WISP_LANES], lanes[WISP_LANES];
    wisp_primitive_meeting met[WISP_LANES];
    int n = 0;
    for ( ; near != 0; near &= near - 1 )
    {
        const int lane = lanes[n++] = __builtin_ctz( near );
        for ( int k = 0; k < 2; ++k )
        {
            const size_t corner = (size_t)( row + k ) * COLLISION_ROW + (size_t)lane;
            const int at = corners[2 * lane + k] = 2 * lane + k;
            collision_store( ends[0][at], collision_load_lane( loop->args.position + corner ) );
            collision_store( ends[1][at], collision_load_lane( loop->args.previous + corner ) );
            ends[0][at][3] = ends[1][at][3] = 0.0f;
        }
    }
    const wisp_primitive_paths paths = {
        .position = ends[0][0], .previous = ends[1][0], .corners = corners, .corner_count = 2
    };
    const int count = loop->kernels->meet_shape( &paths, shape, NULL, lanes, n, met );
    for ( int i = 0; i < count; ++i )
    {
        push_segment( loop, view, met + i, row, met[i].primitive, sum );
    }
}

// Push the segments of a group, from the roots on.
static void push_segments( const strand_loop* loop, const collision_view* view, double* sum )
{
    const wisp_strand_bounds box = box_around( loop, view );
    const bool is_closed = collision_is_closed_form( view->body );
    const int first = loop->args.group_row[loop->group], end = loop->args.group_row[loop->group + 1];
    const int32_t* count = loop->lane_count + (size_t)loop->group * WISP_LANES;
    wisp_shape_lanes shape;
    bool has_shape = false;
    uint32_t found = 0;
    for ( int row = first; row < end; ++row )
    {
        row = loop->kernels->strand_find_segments( &loop->args, row, end, &box, &found );
        uint32_t near = 0;
        for ( ; found != 0; found &= found - 1 )
        {
            const int lane = __builtin_ctz( found );
            near |= row + 1 - first < count[lane] ? 1u << lane : 0u;
        }
        if ( is_closed && near != 0 && has_shape == false )
        {
            shape = ( wisp_shape_lanes ){ .turns = false };
            collision_set_shape( &shape, 0, view, 0.0f );
            has_shape = true;
        }
        if ( has_shape && near != 0 )
        {
            push_row_from_shape( loop, view, &shape, row, near, sum );
        }
        for ( ; is_closed == false && near != 0; near &= near - 1 )
        {
            push_segment( loop, view, NULL, row, __builtin_ctz( near ), sum );
        }
    }
}

// ---- the pass ----

static void add_row_reaction( const strand_loop* loop, int row, double* sum, float ( *before )[3 * WISP_LANES] )
{
    for ( int l = 0; l < WISP_LANES; ++l )
    {
        const float inverse_mass = loop->args.inverse_mass[(size_t)row * WISP_LANES + (size_t)l];
        if ( inverse_mass > 0.0f )
        {
            const size_t at = (size_t)row * COLLISION_ROW + (size_t)l;
            collision_add_reaction( sum, 1.0 / ( (double)inverse_mass * (double)loop->dt ),
                                    collision_load_lane( before[0] + l ), collision_load_lane( before[1] + l ),
                                    collision_load_lane( loop->args.position + at ),
                                    collision_load_lane( loop->args.previous + at ) );
        }
    }
}

// How far a group that is not looked at moves is not known.
static void forget_group( strand_loop* loop, const collision_view* view )
{
    const int begin = loop->args.group_row[loop->group], end = loop->args.group_row[loop->group + 1];
    for ( int row = begin; row < end && has_strand_tracks( loop, view ); ++row )
    {
        const strand_tracks t = tracks_of( loop, view, row );
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            t.triangle[lane] = -1;
            t.free[lane] = 0.0f;
        }
    }
}

static void push_vertices( strand_loop* loop, const collision_view* view, double* sum )
{
    const collision_body* body = view->body;
    const bool round_about = body->inner < INFINITY;
    const float path = round_about ? path_seen( loop, view ) : 0.0f;
    const bool slow = collision_is_closed_form( body ) && path <= body->inner;
    // the middle of a chord may be nearer than both ends, by at most half of it
    const float then = slow ? INFINITY : apart_at( loop, body, view->before );
    const float apart = fminf( then, apart_at( loop, body, view->after ) ) - ( slow ? 0.0f : 0.5f * path );
    if ( apart > view->thickness )
    {
        forget_group( loop, view );
        return;
    }
    wisp_strand_contact_args args = args_with( loop, view );
    if ( slow && sum == NULL )
    {
        loop->kernels->strand_contact( &args, loop->group, loop->group + 1 );
        return;
    }
    const bool is_tracked = has_strand_tracks( loop, view );
    int32_t seeds[WISP_LANES], one[2];
    memset( seeds, -1, sizeof( seeds ) );
    for ( int row = loop->args.group_row[loop->group]; row < loop->args.group_row[loop->group + 1]; ++row )
    {
        float before[2][3 * WISP_LANES];
        if ( sum != NULL )
        {
            memcpy( before[0], loop->args.position + (size_t)row * COLLISION_ROW, sizeof( before[0] ) );
            memcpy( before[1], loop->args.previous + (size_t)row * COLLISION_ROW, sizeof( before[1] ) );
        }
        if ( slow )
        {
            one[0] = row, one[1] = row + 1;
            args.group_row = one;
            loop->kernels->strand_contact( &args, 0, 1 );
        }
        else
        {
            is_tracked ? push_tracked_row( loop, view, &args, row, seeds )
                       : push_strand_row( loop, view, &args, row );
        }
        if ( sum != NULL )
        {
            add_row_reaction( loop, row, sum, before );
        }
    }
}

static void push_strand_group( strand_loop* loop, const collision_view* view, double* sum )
{
    push_vertices( loop, view, sum );
    const float longest = loop->meets_all ? INFINITY : loop->reach.longest;
    if ( loop->has_segments && collision_meets_segments( view->body, view->thickness, longest ) )
    {
        push_segments( loop, view, sum );
    }
}

// Have segments take part, with sums of their own.
static void begin_segments( wisp_frame* frame, const wisp_span* span, const collision_state* state,
                            strand_loop* loop )
{
    loop->has_segments = wisp_frame_has( frame, span->entity, state->segment_contact );
    if ( loop->has_segments == false )
    {
        return;
    }
    loop->lane_count = wisp_frame_strands( frame, span->entity )->lane_count;
    loop->segments = loop->args;
    loop->meets_all = wisp_frame_has( frame, span->entity, state->all_features );
    loop->segments.length = wisp_frame_column( frame, span->entity, WISP_STRAND_LENGTH, 0 );
    loop->segments.starts = loop->segments.gives_back = false; // contacts slide along a segment
    loop->is_turn = span->iteration == wisp_frame_iterations( frame ) + TURN;
    loop->segments.normal_correction = wisp_frame_column( frame, span->entity, state->segment_contact, 0 );
    loop->segments.allowed_depth = wisp_frame_column( frame, span->entity, state->segment_contact, 1 );
    loop->segments.remaining_depth = wisp_frame_column( frame, span->entity, state->segment_contact, 2 );
    loop->segments.friction = wisp_frame_column( frame, span->entity, state->segment_contact, 3 );
    loop->segment_push = wisp_frame_column( frame, span->entity, state->segment_contact, 6 );
    loop->segments.last_correction = wisp_frame_column( frame, span->entity, state->segment_contact, 5 );
    loop->segments.body = wisp_frame_column( frame, span->entity, state->segment_contact, 4 );
}

void collision_touch_strands( wisp_frame* frame, const wisp_span* span, void* user )
{
    if ( span->iteration == wisp_frame_iterations( frame ) + LENGTHS )
    {
        return;
    }
    const collision_state* state = user;
    const collision_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    strand_loop loop;
    loop.args = ( wisp_strand_contact_args ){
        .group_row = wisp_frame_strands( frame, span->entity )->group_row,
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .previous = wisp_frame_column( frame, span->entity, WISP_STRAND_PREVIOUS, 0 ),
        .inverse_mass = wisp_frame_column( frame, span->entity, WISP_STRAND_INVERSE_MASS, 0 ),
        .normal_correction = wisp_frame_column( frame, span->entity, state->strand_contact, 0 ),
        .allowed_depth = wisp_frame_column( frame, span->entity, state->strand_contact, 1 ),
        .friction = wisp_frame_column( frame, span->entity, state->strand_contact, 3 ),
        .remaining_depth = wisp_frame_column( frame, span->entity, state->strand_contact, 2 ),
        .body = wisp_frame_column( frame, span->entity, state->strand_contact, 4 ),
        .last_correction = wisp_frame_column( frame, span->entity, state->strand_contact, 5 ),
        .starts = span->iteration == 0,
        .gives_back = span->iteration > wisp_frame_iterations( frame ),
        .max_push_out =
            span->iteration == 0 ? settings->max_push_out_speed * wisp_frame_dt( frame, span->entity ) : 0.0f,
    };
    loop.tracked = wisp_frame_column( frame, span->entity, state->strand_tracked, 0 );
    loop.free = wisp_frame_column( frame, span->entity, state->strand_tracked, 1 );
    loop.origin = wisp_frame_column( frame, span->entity, state->strand_tracked, 2 );
    loop.bodies = state->bodies;
    loop.is_shared = span->iteration == wisp_frame_iterations( frame );
    loop.is_first = span->substep == 0 && span->iteration == 0;
    loop.substeps_left = wisp_frame_substeps( frame, span->entity ) - 1 - span->substep;
    loop.dt = wisp_frame_dt( frame, span->entity );
    begin_segments( frame, span, state, &loop );
    const wisp_kernels* kernels = loop.kernels = wisp_frame_kernels( frame );
    for ( loop.group = span->begin; loop.group < span->end; ++loop.group )
    {
        loop.sums = collision_reaction_sums( frame, span->entity, state, loop.group );
        kernels->strand_contact_begin( &loop.args, loop.has_segments ? &loop.segments : NULL, loop.group,
                                       span->iteration == 0, &loop.reach );
        const bool moves = loop.reach.lower.x <= loop.reach.upper.x;
        const float across = wisp_v3_length( wisp_v3_sub( loop.reach.upper, loop.reach.lower ) );
        collision_view view;
        collision_walk walk = collision_begin_walk( state, span->entity, loop.reach.lower, loop.reach.upper );
        while ( moves && collision_walk_on( frame, span, state, &walk, across, &view ) )
        {
            push_strand_group( &loop, &view, loop.sums != NULL ? loop.sums[view.body - state->bodies] : NULL );
        }
    }
}

// ---- turns with lengths ----

// A group of strands in its turns.
typedef struct turning_group
{
    wisp_span span;
    float push;  // m, mean of the strands that are pushed in this substep
    bool inside; // a vertex is: turns would make speed of depth
    bool is_done;
} turning_group;

static void sum_pushes( wisp_frame* frame, const collision_state* state, turning_group* group )
{
    const wisp_entity e = group->span.entity;
    const collision_settings* settings = wisp_frame_column( frame, e, state->settings, 0 );
    const wisp_component parts[2] = { state->strand_contact, state->segment_contact };
    float sums[WISP_LANES] = { 0.0f }, sum = 0.0f;
    int strands = 0;
    group->inside = false;
    for ( int part = 0; part < 2 && wisp_frame_has( frame, e, parts[part] ); ++part )
    {
        const wisp_strand_contact_args args = { .group_row = wisp_frame_strands( frame, e )->group_row,
                                                .normal_correction = wisp_frame_column( frame, e, parts[part], 0 ),
                                                .remaining_depth = wisp_frame_column( frame, e, parts[part], 2 ) };
        group->inside |= wisp_frame_kernels( frame )->strand_contact_sum(
            &args, group->span.begin, COLLISION_SHALLOW * settings->thickness, sums );
    }
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        sum += sums[lane];
        strands += sums[lane] > 0.0f;
    }
    group->push = strands > 0 ? sum / (float)strands : 0.0f;
}

static bool goes_on( const turning_group* group )
{
    return group->push > 0.0f && group->inside == false && group->is_done == false;
}

// Solve the lengths of the groups that need it, side by side where neighbours do.
static void restore_lengths( wisp_frame* frame, const turning_group* groups, int count, const bool* needs )
{
    for ( int i = 0; i < count; ++i )
    {
        wisp_span span = groups[i].span;
        span.iteration = wisp_frame_iterations( frame ) + LENGTHS;
        for ( ; needs[i] && i + 1 < count && needs[i + 1]; ++i )
        {
            span.end += 1;
        }
        if ( needs[i] )
        {
            wisp_frame_project_again( frame, &span );
        }
    }
}

void collision_part_strands( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    const collision_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const int iterations = wisp_frame_iterations( frame );
    const bool has_segments = wisp_frame_has( frame, span->entity, state->segment_contact );
    // segments are pushed farther than they need, so their turns end with lengths
    const int turns = has_segments ? SEGMENT_TURNS - 1 : LENGTH_TURNS;
    const float small = SMALL_PUSH * settings->thickness * wisp_frame_dt( frame, span->entity );
    for ( int first = span->begin; first < span->end; first += ABREAST )
    {
        turning_group groups[ABREAST];
        const int count = first + ABREAST < span->end ? ABREAST : span->end - first;
        bool needs_lengths[ABREAST] = { true };
        for ( int i = 0; i < count; ++i )
        {
            groups[i] = ( turning_group ){ .span = *span };
            groups[i].span.begin = first + i;
            groups[i].span.end = first + i + 1;
            sum_pushes( frame, state, groups + i );
        }
        for ( int turn = 0, going = count; going > 0; ++turn )
        {
            going = 0;
            for ( int i = 0; i < count; ++i )
            {
                turning_group* group = groups + i;
                const float before = group->push;
                needs_lengths[i] = goes_on( group );
                if ( needs_lengths[i] )
                {
                    group->span.iteration = iterations + TURN;
                    collision_touch_strands( frame, &group->span, user );
                    sum_pushes( frame, state, group );
                    group->is_done = turn == turns || fabsf( group->push - before ) <= small;
                    needs_lengths[i] = ( group->is_done == false || has_segments ) && group->inside == false;
                }
                going += goes_on( group );
            }
            restore_lengths( frame, groups, count, needs_lengths );
        }
        for ( int i = 0; i < count && has_segments; ++i )
        {
            if ( groups[i].push > 0.0f && groups[i].inside == false )
            {
                groups[i].span.iteration = iterations + EXACT;
                collision_touch_strands( frame, &groups[i].span, user );
            }
        }
    }
}
