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
#include "collision_passes.h"
#include "primitive_contacts.h"
#include "reaction.h"

#include <math.h>

enum
{
    SWEEPS = 4,
};

typedef struct corner_quads
{
    int count;
    size_t quad[3];
    float part[3]; // displacement of a corner per displacement of the point
} corner_quads;

typedef struct primitive_loop
{
    float* position;
    const float* previous;
    collision_impulse* sums; // null without reactions
    float dt;
} primitive_loop;

static corner_quads quads_of( const primitive_loop* loop, const int32_t* corners, int count,
                              const collision_primitive_contact* c )
{
    corner_quads q = { .count = count };
    float sum = 0.0f;
    for ( int k = 0; k < count; ++k )
    {
        q.quad[k] = (size_t)corners[k] * 4;
        q.part[k] = loop->position[q.quad[k] + 3] * c->weights[k];
        sum += q.part[k] * c->weights[k];
    }
    for ( int k = 0; k < count; ++k )
    {
        q.part[k] /= sum;
    }
    return q;
}

static wisp_vec3 point_of( const corner_quads* q, const collision_primitive_contact* c, const float* rows )
{
    wisp_vec3 p = { 0.0f, 0.0f, 0.0f };
    for ( int k = 0; k < q->count; ++k )
    {
        p = collision_add_scaled( p, c->weights[k], collision_load( rows + q->quad[k] ) );
    }
    return p;
}

static void move_point( const primitive_loop* loop, const corner_quads* q, const collision_primitive_contact* c,
                        wisp_vec3 by )
{
    for ( int k = 0; k < q->count; ++k )
    {
        float* at = loop->position + q->quad[k];
        const wisp_vec3 before = collision_load( at ), now = collision_add_scaled( before, q->part[k], by );
        collision_store( at, now );
        if ( loop->sums != NULL && at[3] > 0.0f )
        {
            const wisp_vec3 previous = collision_load( loop->previous + q->quad[k] );
            collision_add_reaction( loop->sums[c->body], 1.0 / ( (double)at[3] * (double)loop->dt ), before, previous,
                                    now, previous );
        }
    }
}

static void project_contact( const primitive_loop* loop, const int32_t* corners, int count,
                             collision_primitive_contact* contact )
{
    collision_contact* c = &contact->half_space;
    const corner_quads quads = quads_of( loop, corners, count, contact );
    const wisp_vec3 start = point_of( &quads, contact, loop->position ), n = collision_load( c->normal );
    const float missing = c->gap - collision_dot( n, collision_sub( start, collision_load( c->point ) ) );
    const float normal = collision_larger( c->normal_correction + missing, 0.0f );
    if ( normal == 0.0f && c->normal_correction == 0.0f )
    {
        return; // friction is 0 too
    }
    const wisp_vec3 pushed = collision_add_scaled( start, normal - c->normal_correction, n ),
                    before = collision_load( c->tangential_correction );
    c->normal_correction = normal;
    wisp_vec3 u = collision_sub( pushed, point_of( &quads, contact, loop->previous ) );
    u = collision_sub( u, collision_load( c->motion ) );
    u = collision_add_scaled( u, -collision_dot( n, u ), n );
    u = collision_sub( u, before );
    const float length = collision_length( u );
    const float fraction = length <= c->static_friction * normal ? 1.0f : c->kinetic_friction * normal / length;
    const wisp_vec3 now = { -fraction * u.x, -fraction * u.y, -fraction * u.z };
    collision_store( c->tangential_correction, now );
    const wisp_vec3 p = collision_add_scaled( pushed, 1.0f, collision_sub( now, before ) );
    move_point( loop, &quads, contact, collision_sub( p, start ) );
}

static void project_list( const primitive_loop* loop, const collision_primitives* p )
{
    for ( int a = 0; a < *p->active_count; ++a )
    {
        const int i = p->active[a];
        const int used = p->found[i] < COLLISION_PRIMITIVE_CONTACTS ? p->found[i] : COLLISION_PRIMITIVE_CONTACTS;
        for ( int k = 0; k < used; ++k )
        {
            project_contact( loop, p->corners + (size_t)i * (size_t)p->corner_count, p->corner_count,
                             &p->contacts[i][k] );
        }
    }
}

void collision_project_primitives( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    const primitive_loop loop = {
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 ),
        .sums = collision_reaction_sums( frame, span->entity, state, 0 ),
        .dt = wisp_frame_dt( frame, span->entity ),
    };
    const collision_primitives edges = collision_primitives_of( frame, span->entity, state, 2 );
    const collision_primitives triangles = collision_primitives_of( frame, span->entity, state, 3 );
    for ( int sweep = 0; sweep < SWEEPS; ++sweep )
    {
        project_list( &loop, &edges );
        project_list( &loop, &triangles );
    }
}
