// Bodies. In: wisp_collider_def, poses from the host. Out: the list of bodies with their shapes or meshes, and their
// poses in a substep.
//
// A mesh is a solid body or a double-sided sheet. A solid one must be closed and face outwards, because its inside is
// what it keeps free. A sheet keeps each particle on the side from which it comes.
#include "collision_bodies.h"

#include "collision_state.h"
#include "reaction.h"
#include "collision_vectors.h"

#include <math.h>
#include <string.h>

static const wisp_field COLLIDER_FIELDS[] = {
    WISP_CHOICE( wisp_collider_def, kind, WISP_COLLIDER_PLANE, WISP_COLLIDER_COUNT ),
    WISP_NUMBER( wisp_collider_def, radius, 1, 1e-6, 1e6, "m" ),
    WISP_NUMBER( wisp_collider_def, half_length, 1, 0, 1e6, "m" ),
    WISP_NUMBER( wisp_collider_def, top_radius, 1, 1e-6, 1e6, "m" ),
    WISP_NUMBER( wisp_collider_def, bottom_radius, 1, 1e-6, 1e6, "m" ),
    WISP_POINT( wisp_collider_def, half_extent, 1e-6, 1e6, "m", 1, 1, 1 ),
    WISP_SWITCH( wisp_collider_def, double_sided, false ),
    WISP_POSE( wisp_collider_def, pose ),
    WISP_NUMBER( wisp_collider_def, static_friction, 0.5, 0, 1e6, NULL ),
    WISP_NUMBER( wisp_collider_def, kinetic_friction, 0.5, 0, 1e6, NULL ),
    WISP_NUMBER( wisp_collider_def, thickness, 0, 0, 1e6, "m" ),
    WISP_BITS( wisp_collider_def, layers, 1 ),
    WISP_WHOLE_OR( wisp_collider_def, height_count_x, 0, 2, 8192 ),
    WISP_WHOLE_OR( wisp_collider_def, height_count_z, 0, 2, 8192 ),
    WISP_NUMBER( wisp_collider_def, spacing, 1, 1e-6, 1e6, "m" ),
    WISP_NUMBER( wisp_collider_def, restitution, 0, 0, 1, NULL ),
    WISP_SWITCH( wisp_collider_def, tracks, true ),
    WISP_NUMBER( wisp_collider_def, mass, 0, 0, 1e6, "kg" ),
    WISP_POINT( wisp_collider_def, inertia, 0, 1e6, "kg m^2", 0 ),
};
WISP_DEFINE( collider_def, "collider", COLLIDER_FIELDS )

// ---- checks ----

static wisp_status check_together( wisp_world* world, const wisp_collider_def* d )
{
    if ( d->kinetic_friction > d->static_friction )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "collider: kinetic_friction: got %g, expected at most static_friction, which is %g",
                                (double)d->kinetic_friction, (double)d->static_friction );
    }
    return d->kind == WISP_COLLIDER_SURFACE && d->mass > 0.0f
               ? wisp_world_fail( world, WISP_BAD_INPUT, "collider: mass: got %g kg of a surface, expected 0",
                                  (double)d->mass )
               : WISP_OK;
}

wisp_status collision_check_points( wisp_world* world, const wisp_collider_def* d )
{
    for ( int v = 0; v < d->point_count && d->points != NULL; ++v )
    {
        const wisp_vec3 p = d->points[v];
        if ( collision_is_in_range( p ) == false )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "collider: point %d, (%g, %g, %g), is not within 1e6 m of the origin", v,
                                    (double)p.x, (double)p.y, (double)p.z );
        }
    }
    return WISP_OK;
}

// ---- meshes ----

float collision_bluntness( const wisp_vec3* points, const int32_t* triangles, int count )
{
    const wisp_vec3 o = points[triangles[0]];
    double volume = 0.0, area = 0.0;
    for ( int t = 0; t < count; ++t )
    {
        double e[3][3], n[3];
        for ( int corner = 0; corner < 3; ++corner )
        {
            const wisp_vec3 p = points[triangles[3 * (size_t)t + (size_t)corner]];
            e[corner][0] = (double)p.x - (double)o.x;
            e[corner][1] = (double)p.y - (double)o.y;
            e[corner][2] = (double)p.z - (double)o.z;
        }
        for ( int k = 0; k < 3; ++k )
        {
            const int y = ( k + 1 ) % 3, z = ( k + 2 ) % 3;
            volume += e[0][k] * ( e[1][y] * e[2][z] - e[1][z] * e[2][y] ) / 6.0;
            n[k] = ( e[1][y] - e[0][y] ) * ( e[2][z] - e[0][z] ) - ( e[1][z] - e[0][z] ) * ( e[2][y] - e[0][y] );
        }
        area += 0.5 * sqrt( n[0] * n[0] + n[1] * n[1] + n[2] * n[2] );
    }
    return area > 0.0 ? (float)( 2.0 * volume / area ) : 0.0f;
}

void collision_measure_points( const wisp_collider_def* d, collision_body* body )
{
    wisp_vec3 lower = d->points[0], upper = lower;
    for ( int v = 1; v < d->point_count; ++v )
    {
        const wisp_vec3 p = d->points[v];
        lower = ( wisp_vec3 ){ fminf( lower.x, p.x ), fminf( lower.y, p.y ), fminf( lower.z, p.z ) };
        upper = ( wisp_vec3 ){ fmaxf( upper.x, p.x ), fmaxf( upper.y, p.y ), fmaxf( upper.z, p.z ) };
    }
    // slightly larger, against rounding of the sums
    const float most = 0.50001f;
    body->half =
        ( wisp_vec3 ){ most * ( upper.x - lower.x ), most * ( upper.y - lower.y ), most * ( upper.z - lower.z ) };
    body->centre =
        ( wisp_vec3 ){ 0.5f * ( lower.x + upper.x ), 0.5f * ( lower.y + upper.y ), 0.5f * ( lower.z + upper.z ) };
    body->ball_radius = wisp_v3_length( body->half );
    float farthest = 0.0f;
    for ( int v = 0; v < d->point_count; ++v )
    {
        farthest = fmaxf( farthest, wisp_v3_length( wisp_v3_sub( d->points[v], body->centre ) ) );
    }
    body->tight_radius = 2.0f * most * farthest;
}

static wisp_status make_mesh( wisp_world* world, const wisp_collider_def* d, collision_body* body )
{
    WISP_TRY( collision_check_points( world, d ) );
    const wisp_collision_mesh_def def = {
        .points = d->points,
        .triangles = d->triangles,
        .point_count = d->point_count,
        .triangle_count = d->triangle_count,
    };
    wisp_error error = { 0 };
    wisp_status status = wisp_collision_mesh_create( &def, wisp_world_allocator( world ), &body->tree, &error );
    if ( status != WISP_OK )
    {
        return wisp_world_fail( world, status, "collider: %s", error.message );
    }
    int open = wisp_collision_mesh_get_stats( body->tree ).open_edge_count;
    if ( d->double_sided == false && open > 0 )
    {
        status = wisp_world_fail( world, WISP_BAD_INPUT,
                                  "collider: the mesh has %d open edges, so nothing is inside: close it or call it a "
                                  "sheet",
                                  open );
    }
    body->bluntness = d->double_sided ? 0.0f : collision_bluntness( d->points, d->triangles, d->triangle_count );
    if ( status == WISP_OK && d->double_sided == false && !( body->bluntness > 0.0f ) )
    {
        status = wisp_world_fail( world, WISP_BAD_INPUT, "collider: the triangles of the mesh face inwards" );
    }
    if ( status != WISP_OK )
    {
        wisp_collision_mesh_release( body->tree );
        body->tree = NULL;
        return status;
    }
    collision_measure_points( d, body );
    return WISP_OK;
}

// ---- closed forms ----

// If one ball holds the other, the box is that of the larger one.
static void measure_tapered( collision_body* body )
{
    const wisp_shape* s = &body->shape;
    const float r = fmaxf( s->top_radius, s->bottom_radius );
    const float lower = fminf( -s->half_length - s->bottom_radius, s->half_length - s->top_radius );
    const float upper = fmaxf( s->half_length + s->top_radius, -s->half_length + s->bottom_radius );
    body->centre = ( wisp_vec3 ){ 0.0f, 0.5f * ( lower + upper ), 0.0f };
    // slightly larger, against rounding of the sums
    body->half = ( wisp_vec3 ){ r, 0.50001f * ( upper - lower ), r };
    body->inner = body->bluntness = fminf( s->top_radius, s->bottom_radius );
}

static wisp_status make_body( wisp_world* world, const wisp_collider_def* d, collision_body* body )
{
    static const wisp_shape_kind KINDS[] = { [WISP_COLLIDER_PLANE] = WISP_SHAPE_PLANE,
                                             [WISP_COLLIDER_SPHERE] = WISP_SHAPE_SPHERE,
                                             [WISP_COLLIDER_CAPSULE] = WISP_SHAPE_CAPSULE,
                                             [WISP_COLLIDER_BOX] = WISP_SHAPE_BOX,
                                             [WISP_COLLIDER_TAPERED_CAPSULE] = WISP_SHAPE_TAPERED_CAPSULE };
    const bool has_mesh = d->kind == WISP_COLLIDER_MESH || d->kind == WISP_COLLIDER_SURFACE;
    *body = ( collision_body ){ .double_sided = has_mesh && d->double_sided,
                                .tracks = has_mesh && d->tracks && d->mass == 0.0f,
                                .layers = d->layers,
                                .restitution = d->restitution };
    if ( d->kind == WISP_COLLIDER_SURFACE )
    {
        return collision_make_surface( world, d, body );
    }
    if ( d->kind == WISP_COLLIDER_MESH )
    {
        return make_mesh( world, d, body );
    }
    if ( d->kind == WISP_COLLIDER_CONVEX )
    {
        return collision_make_convex( world, d, body );
    }
    if ( d->kind == WISP_COLLIDER_HEIGHT_FIELD )
    {
        return collision_make_height_field( world, d, body );
    }
    body->shape = ( wisp_shape ){
        .kind = KINDS[d->kind],
        .radius = d->radius,
        .half_length = d->half_length,
        .half_extent = d->half_extent,
        .top_radius = d->top_radius,
        .bottom_radius = d->bottom_radius,
    };
    if ( d->kind == WISP_COLLIDER_TAPERED_CAPSULE )
    {
        measure_tapered( body );
        body->ball_radius = wisp_v3_length( body->half );
        return WISP_OK;
    }
    const float r = d->radius, all = INFINITY;
    const wisp_vec3 halves[] = { { all, all, all }, { r, r, r }, { r, r + d->half_length, r }, d->half_extent };
    body->half = halves[d->kind];
    body->ball_radius = wisp_v3_length( body->half );
    const wisp_vec3 h = d->half_extent;
    const float inner[] = { all, r, r, fminf( h.x, fminf( h.y, h.z ) ) };
    body->inner = inner[d->kind];
    body->bluntness = d->kind == WISP_COLLIDER_BOX ? 0.0f : body->inner;
    return WISP_OK;
}

// ---- the list ----

// Number a body if it is tracked, and note what participants need to know of all bodies together.
static void count_body( collision_state* state, collision_body* body )
{
    const bool is_bouncy = body->restitution > 0.0f;
    body->track = body->tracks && state->track_count < COLLISION_TRACKS ? state->track_count++ : -1;
    state->has_trees = state->has_trees || body->tree != NULL;
    state->has_bouncy = state->has_bouncy || is_bouncy;
    state->stored_layers |= is_bouncy || collision_is_closed_form( body ) == false ? body->layers : 0;
}

// What participants keep of tracks has no meaning between steps, so numbers may change.
static void count_bodies( collision_state* state )
{
    state->track_count = 0;
    state->has_trees = state->has_bouncy = false;
    state->stored_layers = 0;
    for ( int i = 0; i < state->body_count; ++i )
    {
        count_body( state, state->bodies + i );
    }
}

bool collision_forget_body( collision_state* state, const wisp_allocator* allocator, wisp_entity entity,
                            collision_body* forgotten )
{
    for ( int i = 0; i < state->body_count; ++i )
    {
        collision_body* body = state->bodies + i;
        if ( wisp_entity_equal( body->entity, entity ) )
        {
            *forgotten = *body;
            collision_release_body( allocator, body );
            state->coupled_count -= body->is_coupled ? 1 : 0;
            state->body_count -= 1;
            memmove( body, body + 1, (size_t)( state->body_count - i ) * sizeof( *body ) );
            count_bodies( state );
            return true;
        }
    }
    return false;
}

static void fill_collider( collision_collider* to, const wisp_collider_def* d )
{
    const wisp_transform pose = wisp_transform_make( d->pose.rotation, d->pose.translation );
    *to = ( collision_collider ){ pose, pose, d->static_friction, d->kinetic_friction, d->thickness, d->layers };
}

// A body that moves is where it is until the host says otherwise.
static wisp_status give_motion( wisp_world* world, const collision_state* state, wisp_entity entity )
{
    if ( wisp_world_has( world, entity, state->motion ) )
    {
        return WISP_OK;
    }
    const wisp_transform now = ( (collision_collider*)wisp_world_column( world, entity, state->collider, 0 ) )->to;
    WISP_TRY( wisp_world_attach( world, entity, state->motion ) );
    WISP_TRY( wisp_world_request( world, entity, state->collider, true ) );
    *(wisp_transform*)wisp_world_column( world, entity, state->motion, 0 ) = now;
    return WISP_OK;
}

static float inverse_of( float x )
{
    return x > 0.0f ? 1.0f / x : 0.0f;
}

static wisp_status couple_body( wisp_world* world, collision_state* state, wisp_entity entity,
                                const wisp_collider_def* d )
{
    state->bodies[state->body_count - 1].is_coupled = true;
    state->coupled_count += 1;
    WISP_TRY( give_motion( world, state, entity ) );
    WISP_TRY( wisp_world_attach( world, entity, state->coupled ) );
    WISP_TRY( wisp_world_request( world, entity, state->coupled, true ) );
    const wisp_vec3 turns = { inverse_of( d->inertia.x ), inverse_of( d->inertia.y ), inverse_of( d->inertia.z ) };
    *(collision_coupled*)wisp_world_column( world, entity, state->coupled, 0 ) = ( collision_coupled ){
        .before = wisp_transform_make( d->pose.rotation, d->pose.translation ),
        .turn = { 0.0f, 0.0f, 0.0f, 1.0f },
        .inverse_mass = 1.0f / d->mass,
        .inverse_inertia = turns,
        .most_turns = fmaxf( turns.x, fmaxf( turns.y, turns.z ) ),
    };
    return wisp_request_reaction( world, entity, true );
}

// Add a body to the list. On failure removing its entity undoes everything.
static wisp_status append_body( wisp_world* world, collision_state* state, const wisp_collider_def* d,
                                collision_body* body )
{
    WISP_TRY( wisp_world_add_pairs( world, 0, &body->entity ) );
    const wisp_entity entity = body->entity;
    state->bodies[state->body_count] = *body;
    count_body( state, state->bodies + state->body_count++ );
    const bool follows = body->follows;
    *body = ( collision_body ){ .entity = entity }; // the list owns what it had
    wisp_status status = wisp_world_attach( world, entity, state->collider );
    if ( status == WISP_OK )
    {
        fill_collider( wisp_world_column( world, entity, state->collider, 0 ), d );
        status = follows ? collision_follow_surface( world, state, entity, d->surface ) : WISP_OK;
        status = status == WISP_OK && d->mass > 0.0f ? couple_body( world, state, entity, d ) : status;
        status =
            status == WISP_OK ? collision_update_for( world, state, state->bodies + state->body_count - 1 ) : status;
    }
    if ( status != WISP_OK )
    {
        wisp_world_remove( world, entity );
    }
    return status;
}

wisp_status wisp_add_collider( wisp_world* world, const wisp_collider_def* given, wisp_entity* out )
{
    if ( out != NULL )
    {
        *out = ( wisp_entity ){ 0, 0 };
    }
    wisp_collider_def values;
    const wisp_collider_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, NULL, &wisp_collider_def_fields, &values, given ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    WISP_FIND_STATE( collision_state, state, world, "collision", NULL, 0 );
    WISP_TRY( check_together( world, def ) );
    if ( wisp_world_reserve( world, (void**)&state->bodies, &state->body_capacity, state->body_count,
                             sizeof( collision_body ) ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for %d colliders", state->body_count + 1 );
    }
    collision_body body;
    wisp_status status = make_body( world, def, &body );
    status = status == WISP_OK ? append_body( world, state, def, &body ) : status;
    if ( status != WISP_OK )
    {
        collision_release_body( wisp_world_allocator( world ), &body );
        return status;
    }
    *out = body.entity;
    return WISP_OK;
}

// ---- motion ----

wisp_status wisp_move_collider( wisp_world* world, wisp_entity entity, wisp_transform pose )
{
    WISP_FIND_STATE( collision_state, state, world, "collision", &entity, 0 );
    const collision_collider* collider = wisp_world_column( world, entity, state->collider, 0 );
    if ( collider == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "entity %u is not a collider", entity.index );
    }
    if ( wisp_world_has( world, entity, state->follower ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "collider: entity %u moves with its surface", entity.index );
    }
    WISP_TRY( wisp_world_check_values( world, &wisp_collider_def_fields, "pose", &pose, 1, NULL ) );
    WISP_TRY( give_motion( world, state, entity ) );
    *(wisp_transform*)wisp_world_column( world, entity, state->motion, 0 ) =
        wisp_transform_make( pose.rotation, pose.translation );
    return WISP_OK;
}

void collision_update_poses( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    collision_collider* collider = wisp_frame_column( frame, span->entity, state->collider, 0 );
    const wisp_transform* target = wisp_frame_column( frame, span->entity, state->motion, 0 );
    collider->from = wisp_frame_reached( frame, collider->from, collider->to );
    collider->to = *target;
    collision_coupled* coupled = wisp_frame_column( frame, span->entity, state->coupled, 0 );
    if ( coupled != NULL )
    {
        const wisp_vec3 none = { 0.0f, 0.0f, 0.0f };
        collider->from = coupled->before;
        coupled->turn = ( wisp_quat ){ 0.0f, 0.0f, 0.0f, 1.0f };
        coupled->shift = coupled->velocity = coupled->spin = none;
        memset( coupled->impulse, 0, sizeof( coupled->impulse ) );
        coupled->done = 0;
        coupled->total = wisp_frame_substeps( frame, span->entity );
    }
}

// Compute bounds of the motion in a step. Two rotations q and r turn a point at unit distance by no more than
// 2 |q - r| away from each other, with the signs that are nearer.
void collision_set_motion( const collision_collider* collider, collision_view* view )
{
    const wisp_quat q = collider->from.rotation, r = collider->to.rotation;
    const float sign = q.x * r.x + q.y * r.y + q.z * r.z + q.w * r.w < 0.0f ? -1.0f : 1.0f;
    const float d[4] = { q.x - sign * r.x, q.y - sign * r.y, q.z - sign * r.z, q.w - sign * r.w };
    const float rounding = 1.001f; // and that of interpolated poses
    view->turn = 2.0f * rounding * sqrtf( d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + d[3] * d[3] );
    view->shift = rounding * wisp_v3_length( wisp_v3_sub( collider->to.translation, collider->from.translation ) );
}

// Poses of a body with a mass: what it has of the step, and where it gets with the velocity that it has. What makes its substeps
// afterwards sees the way that the body went, and nothing is settled, because nobody knows how far it gets.
static void set_coupled_poses( const wisp_frame* frame, const wisp_span* span, const collision_collider* collider,
                               const collision_coupled* coupled, float progress[2], collision_view* view )
{
    const float far = 1e6f;
    view->shift = far;
    if ( coupled->done < coupled->total )
    {
        view->before = coupled->before;
        view->after = collision_coupled_pose( collider, coupled, progress[1], wisp_frame_dt( frame, span->entity ) );
        return;
    }
    view->before = wisp_transform_interpolate( collider->from, coupled->before, progress[0] );
    view->after = wisp_transform_interpolate( collider->from, coupled->before, progress[1] );
}

// Compute the poses of a substep. A body that stands still keeps its pose exactly, which interpolation would not.
static void set_poses( const wisp_frame* frame, const wisp_span* span, const collision_collider* collider,
                       const collision_coupled* coupled, collision_view* view )
{
    view->begin = view->end = view->shift = view->turn = 0.0f;
    const float before = wisp_frame_progress( frame, span->entity, span->substep ),
                after = wisp_frame_progress( frame, span->entity, span->substep + 1 );
    if ( view->body->follows )
    {
        view->begin = before;
        view->end = after;
        view->shift = view->body->shift;
    }
    if ( coupled != NULL )
    {
        set_coupled_poses( frame, span, collider, coupled, ( float[2] ){ before, after }, view );
        return;
    }
    if ( memcmp( &collider->from, &collider->to, sizeof( wisp_transform ) ) == 0 )
    {
        view->before = view->after = collider->to;
        return;
    }
    collision_set_motion( collider, view );
    view->before = wisp_transform_interpolate( collider->from, collider->to, before );
    view->after = wisp_transform_interpolate( collider->from, collider->to, after );
}

// Return the poses of a body in the frame of an entity's rows. A plane that is far away is as well described by its point nearest to
// there; one that rotates is not.
static collision_collider place_collider( wisp_frame* frame, const collision_state* state, const collision_body* body,
                                          wisp_entity entity )
{
    collision_collider c = *(const collision_collider*)wisp_frame_column( frame, body->entity, state->collider, 0 );
    const wisp_vec3 by =
        body->follows ? ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } : wisp_frame_between( frame, body->entity, entity );
    if ( collision_is_apart( by ) == false )
    {
        return c;
    }
    c.from.translation = wisp_to_rows( c.from.translation, by );
    c.to.translation = wisp_to_rows( c.to.translation, by );
    const bool is_plane = collision_is_closed_form( body ) && body->shape.kind == WISP_SHAPE_PLANE;
    if ( is_plane && memcmp( &c.from.rotation, &c.to.rotation, sizeof( wisp_quat ) ) == 0 )
    {
        const wisp_vec3 n = wisp_quat_rotate( c.to.rotation, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
        const wisp_vec3 p = c.to.translation;
        const double gap = (double)n.x * (double)p.x + (double)n.y * (double)p.y + (double)n.z * (double)p.z;
        c.to.translation = wisp_v3_mul_add( ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, (float)gap, n );
        c.from.translation = wisp_v3_mul_add( c.to.translation, 1.0f, wisp_v3_sub( c.from.translation, p ) );
    }
    return c;
}

bool collision_next( wisp_frame* frame, const wisp_span* span, const collision_state* state, int* next,
                     collision_view* out )
{
    const collision_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    for ( ; *next < state->body_count; ++*next )
    {
        const collision_body* body = state->bodies + *next;
        const collision_collider* collider = wisp_frame_column( frame, body->entity, state->collider, 0 );
        const bool is_left_out =
            body->follows && ( body->surface.index == 0 || wisp_entity_equal( body->surface, span->entity ) ||
                               collision_is_apart( wisp_frame_between( frame, body->surface, span->entity ) ) );
        if ( ( collider->layers & settings->mask ) != 0 && is_left_out == false )
        {
            const collision_collider placed = place_collider( frame, state, body, span->entity );
            out->body = body;
            collision_coupled coupled;
            if ( body->is_coupled )
            {
                coupled = *(const collision_coupled*)wisp_frame_column( frame, body->entity, state->coupled, 0 );
                coupled.before.translation = wisp_to_rows( coupled.before.translation,
                                                           wisp_frame_between( frame, body->entity, span->entity ) );
            }
            set_poses( frame, span, &placed, body->is_coupled ? &coupled : NULL, out );
            out->restitution = body->restitution;
            out->thickness = settings->thickness + collider->thickness;
            out->static_friction = settings->friction * collider->static_friction;
            out->kinetic_friction = settings->friction * collider->kinetic_friction;
            ++*next;
            return true;
        }
    }
    return false;
}
