// Projection of the contacts of edges and triangles (pass collision.project_primitives), before that of particles. In: contacts of
// the substep. Out: positions.
//
// A contact keeps the point p = sum b_k x_k of its corners out of a half space, as contact_projection.c keeps a particle: with the
// same accumulated normal and tangential corrections. A correction d of p moves the corners by
//
//   dx_k = w_k b_k d / sum w_j b_j^2
//
// so that linear and angular momentum are those of one impulse at p. Contacts are projected one after another, edges first, in the
// order of the mesh, which no worker changes; a few sweeps let neighbours that share corners settle.
#include "body_queries.h"
#include "collision_state.h"
#include "primitive_contacts.h"
#include "reaction.h"

#include <math.h>

enum
{
    ROUNDS = 8, // of the search after fast motion
};

static const float FAST = 0.5f; // of the thickness: displacement against a body behind which is searched again

typedef struct primitive_loop
{
    wisp_entity entity;
    wisp_frame* frame;
    const collision_state* state;
    float* position;
    const float* previous;
    collision_impulse* sums; // null without reactions
    float dt;
} primitive_loop;

enum
{
    ROW = 4, // floats of a particle: the compiler takes rows at once
};

static void blend_rows( const int32_t* corners, int count, const float* weights, const float* rows, float* p )
{
    const float* first = rows + (size_t)corners[0] * ROW;
    for ( int c = 0; c < ROW; ++c )
    {
        p[c] = weights[0] * first[c];
    }
    for ( int k = 1; k < count; ++k )
    {
        const float* row = rows + (size_t)corners[k] * ROW;
        for ( int c = 0; c < ROW; ++c )
        {
            p[c] += weights[k] * row[c];
        }
    }
}

// Move the point of a contact by a displacement, whose fourth number is 0.
static void move_point( const primitive_loop* loop, const int32_t* corners, int count,
                        const collision_primitive_contact* c, const float* by )
{
    float sum = 0.0f, part[3];
    for ( int k = 0; k < count; ++k )
    {
        part[k] = loop->position[(size_t)corners[k] * ROW + 3] * c->weights[k];
        sum += part[k] * c->weights[k];
    }
    for ( int k = 0; k < count; ++k )
    {
        float* at = loop->position + (size_t)corners[k] * ROW;
        const wisp_vec3 before = wisp_v3_load( at );
        const float fraction = part[k] / sum;
        for ( int i = 0; i < ROW; ++i )
        {
            at[i] += fraction * by[i];
        }
        if ( loop->sums != NULL && at[3] > 0.0f )
        {
            const wisp_vec3 previous = wisp_v3_load( loop->previous + (size_t)corners[k] * ROW );
            collision_add_reaction( loop->sums[c->body], 1.0 / ( (double)at[3] * (double)loop->dt ), before, previous,
                                    wisp_v3_load( at ), previous );
        }
    }
}

static void project_primitive( const primitive_loop* loop, const int32_t* corners, int count,
                               collision_primitive_contact* contact )
{
    collision_contact* c = &contact->half_space;
    float p[ROW], old[ROW];
    blend_rows( corners, count, contact->weights, loop->position, p );
    const wisp_vec3 start = wisp_v3_load( p ), n = wisp_v3_load( c->normal );
    const float missing = c->gap - wisp_v3_dot( n, wisp_v3_sub( start, wisp_v3_load( c->point ) ) );
    const collision_share share =
        loop->state->coupled_count == 0
            ? ( collision_share ){ 1.0f, 1.0f }
            : collision_share_of( loop->frame, loop->state, contact->body, loop->entity, start, n );
    const float normal = collision_larger( share.normal * ( c->normal_correction + missing ), 0.0f );
    if ( normal == 0.0f && c->normal_correction == 0.0f )
    {
        return; // friction is 0 too
    }
    const wisp_vec3 pushed = wisp_v3_mul_add( start, normal - c->normal_correction, n ),
                    before = wisp_v3_load( c->tangential_correction );
    c->normal_correction = normal;
    blend_rows( corners, count, contact->weights, loop->previous, old );
    wisp_vec3 u = wisp_v3_sub( pushed, wisp_v3_load( old ) );
    u = wisp_v3_sub( u, wisp_v3_load( c->motion ) );
    u = wisp_v3_mul_add( u, -wisp_v3_dot( n, u ), n );
    u = wisp_v3_sub( u, before );
    const float length = wisp_v3_length( u );
    const float part = share.tangential;
    const float fraction =
        part * length <= c->static_friction * normal ? part : c->kinetic_friction * normal / length;
    const wisp_vec3 now = { -fraction * u.x, -fraction * u.y, -fraction * u.z };
    collision_store( c->tangential_correction, now );
    const wisp_vec3 moved = wisp_v3_sub( wisp_v3_mul_add( pushed, 1.0f, wisp_v3_sub( now, before ) ), start );
    const float by[ROW] = { moved.x, moved.y, moved.z, 0.0f };
    move_point( loop, corners, count, contact, by );
}

typedef struct primitive_lists
{
    collision_primitives edges, triangles;
} primitive_lists;

typedef struct contact_place
{
    const int32_t* corners;
    int corner_count;
    collision_primitive_contact* contact;
} contact_place;

// Iterate over all contacts, edges first. Start with a place of zero.
typedef struct contact_walk
{
    int list, at, contact;
} contact_walk;

static bool next_contact( const primitive_lists* lists, contact_walk* walk, contact_place* out )
{
    for ( ; walk->list < 2; ++walk->list, walk->at = walk->contact = 0 )
    {
        const collision_primitives* p = walk->list == 0 ? &lists->edges : &lists->triangles;
        for ( ; walk->at < *p->active_count; ++walk->at, walk->contact = 0 )
        {
            const int i = p->active[walk->at];
            if ( walk->contact < collision_contacts_of( p, i ) )
            {
                *out = ( contact_place ){ p->corners + (size_t)i * (size_t)p->corner_count, p->corner_count,
                                          &p->contacts[i][walk->contact++] };
                return true;
            }
        }
    }
    return false;
}

static void sweep( const primitive_loop* loop, const primitive_lists* lists )
{
    for ( int n = 0; n < 2 * COLLISION_SWEEPS; ++n )
    {
        const collision_primitives* p = n % 2 == 0 ? &lists->edges : &lists->triangles;
        for ( int a = 0; a < *p->active_count; ++a )
        {
            const int i = p->active[a], count = collision_contacts_of( p, i );
            for ( int k = 0; k < count; ++k )
            {
                project_primitive( loop, p->corners + (size_t)i * (size_t)p->corner_count, p->corner_count,
                                   &p->contacts[i][k] );
            }
        }
    }
}

// ---- fast motion ----

// Return the distance of the point of a contact from the plane of the body.
static float distance_of( const primitive_loop* loop, const contact_place* c )
{
    const collision_contact* h = &c->contact->half_space;
    float p[ROW];
    blend_rows( c->corners, c->corner_count, c->contact->weights, loop->position, p );
    return wisp_v3_dot( wisp_v3_load( h->normal ), wisp_v3_sub( wisp_v3_load( p ), wisp_v3_load( h->point ) ) );
}

// Return whether a corner with contact moved so far against a body that another part of a primitive may have got through.
static bool is_fast( const primitive_loop* loop, const primitive_lists* lists, const collision_settings* settings )
{
    contact_place c;
    for ( contact_walk walk = { 0 }; next_contact( lists, &walk, &c ); )
    {
        for ( int k = 0; k < c.corner_count; ++k )
        {
            const size_t quad = (size_t)c.corners[k] * 4;
            wisp_vec3 displacement =
                wisp_v3_sub( wisp_v3_load( loop->position + quad ), wisp_v3_load( loop->previous + quad ) );
            displacement = wisp_v3_sub( displacement, wisp_v3_load( c.contact->half_space.motion ) );
            if ( wisp_v3_length( displacement ) > FAST * settings->thickness )
            {
                return true;
            }
        }
    }
    return false;
}

// Return how much nearer than its gap a contact is, the most of all.
static float worst_of( const primitive_loop* loop, const primitive_lists* lists )
{
    float worst = 0.0f;
    contact_place c;
    for ( contact_walk walk = { 0 }; next_contact( lists, &walk, &c ); )
    {
        worst = collision_larger( worst, c.contact->half_space.gap - distance_of( loop, &c ) );
    }
    return worst;
}

// Corners of what still enters a body go along with the body. @return whether there are any
static bool move_contacts_along( wisp_frame* frame, const wisp_span* span, const collision_state* state,
                                 const primitive_loop* loop, const primitive_lists* lists, float stop )
{
    bool any = false;
    contact_place c;
    for ( contact_walk walk = { 0 }; next_contact( lists, &walk, &c ); )
    {
        collision_view view;
        int next = c.contact->body;
        const float allowed = collision_smaller( stop, 0.5f * c.contact->half_space.gap );
        if ( distance_of( loop, &c ) >= allowed || collision_next( frame, span, state, &next, &view ) == false )
        {
            continue;
        }
        for ( int k = 0; k < c.corner_count; ++k )
        {
            float* at = loop->position + (size_t)c.corners[k] * 4;
            const wisp_vec3 before = wisp_v3_load( at ),
                            previous = wisp_v3_load( loop->previous + (size_t)c.corners[k] * 4 );
            // a surface moves in the world
            const wisp_vec3 now =
                view.body->follows
                    ? wisp_v3_mul_add( previous, 1.0f, wisp_v3_load( c.contact->half_space.motion ) )
                    : wisp_transform_to_world( view.after, wisp_transform_to_local( view.before, previous ) );
            if ( at[3] > 0.0f )
            {
                collision_store( at, now );
                any = true;
            }
            if ( at[3] > 0.0f && loop->sums != NULL )
            {
                collision_add_reaction( loop->sums[c.contact->body], 1.0 / ( (double)at[3] * (double)loop->dt ),
                                        before, previous, now, previous );
            }
        }
    }
    return any;
}

// Where primitives moved far, other points of them than those in contact may have come through. So they are searched again on
// the way that they took, and projected again.
static void search_again( wisp_frame* frame, const wisp_span* span, const collision_state* state,
                          const primitive_loop* loop, const primitive_lists* lists )
{
    const collision_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    for ( int round = 0; round < ROUNDS; ++round )
    {
        collision_search_primitives( frame, span, state, -1.0f );
        if ( worst_of( loop, lists ) <= COLLISION_SHALLOW * settings->thickness )
        {
            return;
        }
        sweep( loop, lists );
    }
    for ( int round = 0; round < ROUNDS; ++round )
    {
        collision_search_primitives( frame, span, state, -1.0f );
        if ( move_contacts_along( frame, span, state, loop, lists, COLLISION_SHALLOW * settings->thickness ) ==
             false )
        {
            return;
        }
    }
}

void collision_project_primitives( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    const collision_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const primitive_loop loop = {
        .frame = frame,
        .state = state,
        .entity = span->entity,
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 ),
        .sums = collision_reaction_sums( frame, span->entity, state, 0 ),
        .dt = wisp_frame_dt( frame, span->entity ),
    };
    const primitive_lists lists = { collision_primitives_of( frame, span->entity, state, 2 ),
                                    collision_primitives_of( frame, span->entity, state, 3 ) };
    sweep( &loop, &lists );
    if ( span->iteration + 1 == wisp_frame_iterations( frame ) && is_fast( &loop, &lists, settings ) )
    {
        search_again( frame, span, state, &loop, &lists );
    }
}
