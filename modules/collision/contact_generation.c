// Contact generation: once per substep, the half spaces that each particle must stay in. In: positions and previous
// positions of a participant, poses of the bodies. Out: up to three contacts per particle, and the distance within
// which nothing else is met.
//
// - Everything is computed in the frame of the body: the particle moves from b0, seen from the old pose, to b1. So a
//   body at 100 m/s is the same as a particle at 100 m/s, and the path decides. (Speculative contacts, as in Jolt and
//   Bullet.)
// - A path that enters the body gets the tangent plane where it enters; any other the plane at the closest point to
//   b1. Bodies farther from b1 than 2 h + |b1 - b0| are skipped, with h the thickness. That leaves room for the
//   constraints to move the particle; what moves farther is swept at the end of the substep (contact_projection.c).
// - A particle that starts nearer than h is moved out at the push-out speed, together with its previous position, so
//   that the correction gives no velocity. While it is deeper than COLLISION_SHALLOW, its own outward motion gives
//   none either: links between particles that are moved out in different directions would gain energy.
// - Lengths come from the participant (thickness a quarter of its mean edge), so a scene at 1/100 or 100 times its
//   size behaves the same.
#include "contact_generation.h"

#include "block_culling.h"
#include "body_queries.h"
#include "collision_passes.h"

#include <math.h>

// ---- one particle, one body ----

static float gap_at( wisp_vec3 p, wisp_vec3 point, wisp_vec3 normal, float gap )
{
    return collision_dot( normal, collision_sub( p, point ) ) - gap;
}

static float contact_gap( const collision_contact* c, wisp_vec3 p )
{
    return gap_at( p, collision_load( c->point ), collision_load( c->normal ), c->gap );
}

// Return room for one more contact, or the farthest if it is farther than the new one, else null.
static collision_contact* find_room( const collision_find_args* args, int slot, wisp_vec3 p, float gap )
{
    collision_contact* all = args->contact[slot];
    int place = args->count[slot]++;
    if ( place < WISP_COLLISION_CONTACTS )
    {
        return all + place;
    }
    place = 0;
    for ( int i = 1; i < WISP_COLLISION_CONTACTS; ++i )
    {
        place = contact_gap( all + i, p ) > contact_gap( all + place, p ) ? i : place;
    }
    return gap >= contact_gap( all + place, p ) ? NULL : all + place;
}

static wisp_vec3 load_one( float ( *from )[COLLISION_BLOCK], int i )
{
    return ( wisp_vec3 ){ from[0][i], from[1][i], from[2][i] };
}

static void store_one( float ( *to )[COLLISION_BLOCK], int i, wisp_vec3 v )
{
    to[0][i] = v.x;
    to[1][i] = v.y;
    to[2][i] = v.z;
}

static void lower_clear( collision_block* block, int i, float clear )
{
    block->clear[i] = clear < block->clear[i] ? clear : block->clear[i];
}

// Move a particle out, in the block too, because later bodies see its new position.
// @param recovered m, of position and previous position @param absorbed m, outward displacement that shall give no
// velocity
static void move_out( const collision_find_args* args, collision_block* block, int i, wisp_vec3 normal,
                      float recovered, float absorbed )
{
    const size_t quad = (size_t)block->slot[i] * 4;
    store_one( block->now, i, collision_add_scaled( load_one( block->now, i ), recovered, normal ) );
    store_one( block->old, i, collision_add_scaled( load_one( block->old, i ), recovered + absorbed, normal ) );
    collision_store( args->position + quad, load_one( block->now, i ) );
    collision_store( args->previous + quad, load_one( block->old, i ) );
}

// Store field by field: copying a whole contact stalls on store forwarding.
static void fill_contact( collision_contact* c, const collision_view* view, wisp_vec3 point, wisp_vec3 normal,
                          wisp_vec3 motion, float gap )
{
    collision_store( c->point, point );
    collision_store( c->normal, normal );
    collision_store( c->motion, motion );
    c->gap = gap;
    c->normal_correction = 0.0f;
    collision_store( c->tangential_correction, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    c->static_friction = view->static_friction;
    c->kinetic_friction = view->kinetic_friction;
}

static void add_contact( const collision_find_args* args, const collision_view* view, collision_block* block, int i,
                         const wisp_surface_point* nearest )
{
    const wisp_vec3 from = load_one( block->from, i ), to = load_one( block->to, i );
    float path = block->path[i];
    wisp_surface_point plane;
    bool swept = fabsf( nearest->distance ) <= path && collision_cast( view->body, from, to, &plane );
    plane = swept ? plane : *nearest;
    lower_clear( block, i, swept ? 0.0f : ( nearest->distance > 0.0f ? nearest->distance : INFINITY ) );
    float now = swept ? collision_dot( plane.normal, collision_sub( to, plane.point ) ) : nearest->distance;
    if ( now > block->reach[i] )
    {
        return;
    }
    float start = collision_start_gap( view, &plane, from, swept );
    float outward = collision_larger( now - view->thickness - start, 0.0f ), recovered = 0.0f;
    if ( start + outward < 0.0f )
    {
        recovered = collision_smaller( -start - outward, collision_larger( args->recovery - outward, 0.0f ) );
    }
    const wisp_vec3 normal = wisp_quat_rotate( view->after.rotation, plane.normal );
    const wisp_vec3 point = wisp_transform_to_world( view->after, plane.point );
    const wisp_vec3 was = wisp_transform_to_world( view->before, plane.point );
    move_out( args, block, i, normal, recovered, start < -COLLISION_SHALLOW * view->thickness ? outward : 0.0f );

    const float gap = start < 0.0f ? view->thickness + start + recovered : view->thickness;
    const wisp_vec3 p = load_one( block->now, i );
    collision_contact* c = find_room( args, block->slot[i], p, gap_at( p, point, normal, gap ) );
    if ( c != NULL )
    {
        fill_contact( c, view, point, normal, collision_sub( point, was ), gap );
    }
}

// ---- a block and its bodies ----

static void query_candidates( const collision_find_args* args, const collision_view* view, collision_block* block )
{
    wisp_mesh_query queries[COLLISION_BLOCK];
    wisp_surface_point nearest[COLLISION_BLOCK];
    bool is_near[COLLISION_BLOCK];
    for ( int n = 0; n < block->candidate_count; ++n )
    {
        const int i = block->candidates[n];
        queries[n] = ( wisp_mesh_query ){ load_one( block->to, i ), block->reach[i] };
    }
    collision_closest( view->body, queries, block->candidate_count, nearest, is_near );
    for ( int n = 0; n < block->candidate_count; ++n )
    {
        const int i = block->candidates[n];
        if ( is_near[n] )
        {
            add_contact( args, view, block, i, nearest + n );
        }
        else
        {
            lower_clear( block, i, block->reach[i] );
        }
    }
}

void collision_meet( const collision_find_args* args, const collision_view* view, collision_block* block )
{
    float apart = collision_ball_distance( view, block->lower, block->upper );
    if ( apart > 2.0f * view->thickness )
    {
        for ( int i = 0; i < block->count; ++i )
        {
            block->clear[i] = apart < block->clear[i] ? apart : block->clear[i];
        }
        return;
    }
    collision_cull_block( args->kernels, view, block );
    query_candidates( args, view, block );
}

void collision_end_block( const collision_find_args* args, const collision_block* block )
{
    for ( int i = 0; i < block->count; ++i )
    {
        args->found[(size_t)block->slot[i] * 4 + 3] = block->clear[i];
    }
}

void collision_find( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    const collision_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const collision_find_args args = {
        .kernels = wisp_frame_kernels( frame ),
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 ),
        .count = wisp_frame_column( frame, span->entity, WISP_PARTICLE_HALF_SPACES, 0 ),
        .found = wisp_frame_column( frame, span->entity, WISP_PARTICLE_HALF_SPACES, 1 ),
        .contact = wisp_frame_column( frame, span->entity, WISP_PARTICLE_HALF_SPACES, 2 ),
        .recovery = settings->max_push_out_speed * wisp_frame_dt( frame ),
    };
    const wisp_span particles = wisp_frame_particles( frame, span );
    collision_block block;
    for ( int begin = particles.begin; begin < particles.end; begin += COLLISION_BLOCK )
    {
        const int left = particles.end - begin;
        collision_begin_block( &args, begin, left < COLLISION_BLOCK ? particles.end : begin + COLLISION_BLOCK,
                               &block );
        collision_view view;
        for ( int next = 0; block.count > 0 && collision_next( frame, span, state, &next, &view ); )
        {
            collision_meet( &args, &view, &block );
        }
        collision_end_block( &args, &block );
    }
}
