// Projection of contacts and friction, after all other constraints of an iteration. In: contacts of the substep. Out:
// positions.
//
// The normal correction accumulates and never gets negative; friction is a tangential displacement within Coulomb's
// cone of it. Both start at 0 with the substep and each iteration corrects them, which is projected Gauss-Seidel
// (accumulated and clamped as the impulses of Catto 2005). With a the normal and b the tangential correction,
//
//   a <- max( 0, a + gap - n (p - q) )
//   u = tangential part of (p - previous) - motion, without b
//   b <- -u if |u| <= mu_s a, else -mu_k a u / |u|
//
// At a body with a mass a vertex takes a share of what both miss (reaction.h): a <- s ( a + gap - n (p - q) ), likewise b.
//
// They stand for the impulses m a / dt and m b / dt. So with mu_s = mu_k the two are exactly Coulomb's law over the
// substep, and no velocity relative to the body is reversed. Particles with one contact, which are nearly all, go to
// the kernel half_space, which computes the same bits.
#include "body_queries.h"
#include "collision_state.h"
#include "particle_contacts.h"
#include "near_bodies.h"
#include "reaction.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static void project_contact( collision_contact* c, wisp_vec3* p, wisp_vec3 previous, collision_share share )
{
    const wisp_vec3 n = wisp_v3_load( c->normal );
    float missing = c->gap - wisp_v3_dot( n, wisp_v3_sub( *p, wisp_v3_load( c->point ) ) );
    float normal = collision_larger( share.normal * ( c->normal_correction + missing ), 0.0f );
    *p = wisp_v3_mul_add( *p, normal - c->normal_correction, n );
    c->normal_correction = normal;
    const wisp_vec3 before = wisp_v3_load( c->tangential_correction );
    wisp_vec3 u = wisp_v3_sub( wisp_v3_sub( *p, previous ), wisp_v3_load( c->motion ) );
    u = wisp_v3_mul_add( u, -wisp_v3_dot( n, u ), n );
    u = wisp_v3_sub( u, before );
    float length = wisp_v3_length( u );
    const float part = share.tangential;
    float fraction = part * length <= c->static_friction * normal ? part : c->kinetic_friction * normal / length;
    const wisp_vec3 now = { -fraction * u.x, -fraction * u.y, -fraction * u.z };
    *p = wisp_v3_mul_add( *p, 1.0f, wisp_v3_sub( now, before ) );
    collision_store( c->tangential_correction, now );
}

// Sweep several contacts: pushing out of one half space may push into another.
static void project_contacts( collision_contact* contacts, int count, wisp_vec3* p, wisp_vec3 previous )
{
    for ( int sweep = 0; sweep < COLLISION_SWEEPS; ++sweep )
    {
        for ( int i = 0; i < count; ++i )
        {
            project_contact( contacts + i, p, previous, ( collision_share ){ 1.0f, 1.0f } );
        }
    }
}

// ---- the end of the substep ----

// Sweep a particle that moved farther than the distance that is clear. If its path enters a body, it stops where it
// enters. If the way there is blocked as well, it keeps its old place in the frame of the body.
static void stop_at_entry( const collision_view* view, float thickness, wisp_vec3* p, wisp_vec3 previous )
{
    const wisp_vec3 from = wisp_transform_to_local( view->before, previous );
    wisp_vec3 to = wisp_transform_to_local( view->after, *p );
    wisp_surface_point hit;
    wisp_vec3 motion;
    if ( collision_cast( view, from, to, &hit, &motion ) == false )
    {
        return;
    }
    // no farther from the body than it was: an approach must not become a separation
    const wisp_vec3 body_motion = wisp_v3_mul_add( from, 1.0f, motion );
    float height = wisp_v3_dot( hit.normal, wisp_v3_sub( body_motion, hit.point ) );
    to = wisp_v3_mul_add( hit.point, fminf( thickness, fmaxf( 0.0f, height ) ), hit.normal );
    to = collision_cast( view, from, to, &hit, &motion ) ? body_motion : to;
    *p = wisp_transform_to_world( view->after, to );
}

typedef struct project_loop
{
    wisp_entity entity;
    float* position;
    const float* previous;
    const int32_t* count;
    const float* found;
    collision_contact ( *contact )[WISP_COLLISION_CONTACTS];
    int32_t single[COLLISION_CHUNK + 8],
        several[COLLISION_CHUNK + 8];       // of the block, those with one contact and with more
    int32_t displaced[COLLISION_CHUNK + 8]; // slots that left the distance that is clear
    int displaced_count;
    // for reactions, else null
    collision_impulse* sums; // [body] of the block
    int32_t ( *contact_body )[WISP_COLLISION_CONTACTS];
    float dt;
} project_loop;

static void add_reaction( const project_loop* loop, int slot, int64_t body, wisp_vec3 before )
{
    const float* p = loop->position + (size_t)slot * 4;
    const wisp_vec3 previous = wisp_v3_load( loop->previous + (size_t)slot * 4 );
    collision_add_reaction( loop->sums[body], 1.0 / ( (double)p[3] * (double)loop->dt ), before, previous,
                            wisp_v3_load( p ), previous );
}

static void stop_displaced( wisp_frame* frame, const wisp_span* span, const collision_state* state,
                            project_loop* loop )
{
    const collision_maps maps = collision_maps_of( frame, span->entity, state );
    wisp_vec3 lower = { INFINITY, INFINITY, INFINITY }, upper = { -INFINITY, -INFINITY, -INFINITY };
    for ( int i = 0; i < loop->displaced_count; ++i )
    {
        size_t quad = (size_t)loop->displaced[i] * 4;
        collision_widen( &lower, &upper, wisp_v3_load( loop->position + quad ) );
        collision_widen( &lower, &upper, wisp_v3_load( loop->previous + quad ) );
    }
    if ( loop->displaced_count == 0 )
    {
        return;
    }
    collision_view view;
    collision_walk walk = collision_begin_walk( state, span->entity, lower, upper );
    while ( collision_walk_on( frame, span, state, &walk, 0.0f, &view ) )
    {
        // a particle that one body moved may touch the next
        const bool near = collision_ball_distance( &view, lower, upper ) <= 2.0f * view.thickness;
        for ( int i = 0; i < loop->displaced_count && near; ++i )
        {
            size_t quad = (size_t)loop->displaced[i] * 4;
            wisp_vec3 p = wisp_v3_load( loop->position + quad );
            const wisp_vec3 before = p;
            const float thickness = view.thickness - collision_thinner( &maps, loop->displaced[i] );
            stop_at_entry( &view, thickness, &p, wisp_v3_load( loop->previous + quad ) );
            collision_store( loop->position + quad, p );
            if ( loop->sums != NULL && loop->position[quad + 3] > 0.0f )
            {
                add_reaction( loop, loop->displaced[i], view.body - state->bodies, before );
            }
            collision_widen( &lower, &upper, p );
        }
    }
}

// The layout of a contact is that of a row of the kernel.
_Static_assert( sizeof( collision_contact ) == 16 * sizeof( float ), "a row of half_space" );
_Static_assert( WISP_COLLISION_CONTACTS == WISP_MAX_HALF_SPACES, "contacts are half spaces" );
_Static_assert( offsetof( collision_contact, gap ) == 9 * sizeof( float ), "as in half_space" );
_Static_assert( offsetof( collision_contact, tangential_correction ) == 11 * sizeof( float ), "as in half_space" );
_Static_assert( offsetof( collision_contact, kinetic_friction ) == 15 * sizeof( float ), "as in half_space" );

// Project the particles with one contact, of the block that begins at `begin`.
static void project_singles( const wisp_kernels* kernels, project_loop* loop, int begin, int n )
{
    // the last group is padded with its last particle
    const int padded = ( n + 7 ) / 8 * 8;
    int32_t particle_x4[COLLISION_CHUNK], row_x16[COLLISION_CHUNK];
    for ( int i = 0; i < padded; ++i )
    {
        const int32_t number = loop->single[i < n ? i : n - 1];
        particle_x4[i] = 4 * number;
        row_x16[i] = 16 * WISP_COLLISION_CONTACTS * number;
    }
    const wisp_half_space_args args = {
        .position = loop->position + (size_t)begin * 4,
        .previous = loop->previous + (size_t)begin * 4,
        .rows = loop->contact[begin][0].point,
        .particle_x4 = particle_x4,
        .row_x16 = row_x16,
    };
    kernels->half_space( &args, 0, padded );
}

static void project_several( project_loop* loop, int begin, int n )
{
    for ( int i = 0; i < n; ++i )
    {
        const int slot = begin + loop->several[i], count = loop->count[slot];
        size_t quad = (size_t)slot * 4;
        wisp_vec3 p = wisp_v3_load( loop->position + quad );
        int used = count < WISP_COLLISION_CONTACTS ? count : WISP_COLLISION_CONTACTS;
        project_contacts( loop->contact[slot], used, &p, wisp_v3_load( loop->previous + quad ) );
        collision_store( loop->position + quad, p );
    }
}

// The same sweeps contact by contact, with the reaction to each. What is squeezed is held whole: its contacts begin with a load.
static void project_reacting( wisp_frame* frame, const collision_state* state, project_loop* loop, int slot )
{
    float* at = loop->position + (size_t)slot * 4;
    const wisp_vec3 previous = wisp_v3_load( loop->previous + (size_t)slot * 4 );
    const int found = loop->count[slot], count = found < WISP_COLLISION_CONTACTS ? found : WISP_COLLISION_CONTACTS;
    wisp_vec3 p = wisp_v3_load( at );
    collision_share share[WISP_COLLISION_CONTACTS];
    for ( int i = 0; i < count; ++i )
    {
        share[i] = collision_share_of( frame, state, loop->contact_body[slot][i], loop->entity, p,
                                       wisp_v3_load( loop->contact[slot][i].normal ) );
    }
    int a, b;
    if ( collision_find_loaded( loop->contact[slot], count, &a, &b ) )
    {
        share[a] = share[b] = ( collision_share ){ 1.0f, 1.0f };
    }
    for ( int i = 0; i < COLLISION_SWEEPS * count; ++i )
    {
        const wisp_vec3 before = p;
        project_contact( loop->contact[slot] + i % count, &p, previous, share[i % count] );
        collision_store( at, p );
        add_reaction( loop, slot, loop->contact_body[slot][i % count], before );
    }
}

// Project a block and add reactions: of a particle with one contact from its motion, of others contact by contact.
static void project_with_reactions( wisp_frame* frame, const collision_state* state, project_loop* loop, int begin,
                                    int single_count, int several_count )
{
    for ( int i = 0; i < several_count; ++i )
    {
        project_reacting( frame, state, loop, begin + loop->several[i] );
    }
    for ( int i = 0; i < single_count && state->coupled_count > 0; ++i )
    {
        project_reacting( frame, state, loop, begin + loop->single[i] );
    }
    if ( state->coupled_count > 0 )
    {
        return;
    }
    float before[COLLISION_CHUNK][3];
    for ( int i = 0; i < single_count; ++i )
    {
        memcpy( before[i], loop->position + (size_t)( begin + loop->single[i] ) * 4, sizeof( before[i] ) );
    }
    project_singles( wisp_frame_kernels( frame ), loop, begin, single_count );
    for ( int i = 0; i < single_count; ++i )
    {
        const int slot = begin + loop->single[i];
        add_reaction( loop, slot, loop->contact_body[slot][0], wisp_v3_load( before[i] ) );
    }
}

// @param last nothing moves the particles afterwards
static void project_block( wisp_frame* frame, const wisp_span* span, const collision_state* state, project_loop* loop,
                           int begin, int end, bool last )
{
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    int32_t several_count;
    const int single_count =
        kernels->list_counts( loop->count + begin, end - begin, loop->single, loop->several, &several_count );
    if ( loop->sums != NULL )
    {
        project_with_reactions( frame, state, loop, begin, single_count, several_count );
    }
    else
    {
        project_singles( kernels, loop, begin, single_count );
        project_several( loop, begin, several_count );
    }
    if ( last )
    {
        loop->displaced_count = kernels->find_displaced( loop->position, loop->found, begin, end, loop->displaced );
        stop_displaced( frame, span, state, loop );
    }
}

static project_loop loop_of( wisp_entity entity, const collision_find_args* columns )
{
    return ( project_loop ){
        .entity = entity,
        .position = columns->position,
        .previous = columns->previous,
        .count = columns->count,
        .found = columns->found,
        .contact = columns->contact,
        .contact_body = columns->contact_body,
        .dt = columns->dt,
    };
}

void collision_project( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    const collision_find_args columns = collision_find_args_of( frame, span, state );
    project_loop loop = loop_of( span->entity, &columns );
    const bool last = span->iteration + 1 == wisp_frame_iterations( frame );
    const wisp_span s = wisp_frame_particles( frame, span );
    for ( int begin = s.begin; begin < s.end; begin += COLLISION_CHUNK )
    {
        const int end = s.end - begin < COLLISION_CHUNK ? s.end : begin + COLLISION_CHUNK;
        loop.sums = collision_reaction_sums( frame, span->entity, state, begin / COLLISION_CHUNK );
        project_block( frame, span, state, &loop, begin, end, last );
    }
}

// ---- groups that one sweep leaves ----

void collision_find_and_project( wisp_frame* frame, const wisp_span* span, const collision_state* state, int begin,
                                 int end, uint32_t groups )
{
    int32_t count[COLLISION_CHUNK] = { 0 };
    float found[COLLISION_CHUNK][4];
    _Alignas( 64 ) collision_contact contact[COLLISION_CHUNK][WISP_COLLISION_CONTACTS];
    for ( int i = 0; i < COLLISION_CHUNK; ++i )
    {
        memset( found[i], 0, sizeof( found[i] ) );
        found[i][3] = INFINITY;
    }
    collision_find_args args = collision_find_args_of( frame, span, state );
    args.position += (size_t)begin * 4;
    args.previous += (size_t)begin * 4;
    args.count = count;
    args.found = found[0];
    args.contact = contact;
    args.tracked = NULL;
    args.left_out = ~groups;
    args.has_settled = args.settles = false;
    collision_find_block( frame, span, &args, 0, end - begin );
    project_loop loop = loop_of( span->entity, &args );
    project_block( frame, span, state, &loop, 0, end - begin, true );
}
