// Contact and friction, behind all other constraints of an iteration.
//
// A contact is a push along the normal that only ever adds up to something positive, and friction is a displacement
// across it that lies in Coulomb's cone of that sum. Both sums start at 0 with the substep and are corrected by each
// iteration, so several iterations count nothing twice: the answer is that of projected Gauss-Seidel.
//
//   pushed <- max( 0, pushed + gap - n (p - q) )
//   u = tangential part of (p - previous) - motion, without what friction has done so far
//   rubbed <- -u if |u| <= mu_s pushed, else -mu_k pushed u / |u|
//
// Who has one contact, and that is nearly everybody, goes to the kernel half_space, which does the same to the last bit.
//
// The push stands for an impulse m pushed / dt and friction for m rubbed / dt, so that with mu_s = mu_k the two are
// exactly Coulomb's law over the substep, and no velocity relative to the body is ever turned round.
#include "collision_internal.h"

#include <math.h>
#include <stddef.h>

enum
{
    CHUNK = WISP_PARTICLE_BLOCK,
};

static void project_contact( collision_contact* c, wisp_vec3* p, wisp_vec3 previous )
{
    const wisp_vec3 n = collision_load( c->normal );
    float lacks = c->gap - collision_dot( n, collision_sub( *p, collision_load( c->point ) ) );
    float pushed = collision_larger( c->pushed + lacks, 0.0f );
    *p = collision_add_scaled( *p, pushed - c->pushed, n );
    c->pushed = pushed;
    const wisp_vec3 rubbed = collision_load( c->rubbed );
    wisp_vec3 u = collision_sub( collision_sub( *p, previous ), collision_load( c->motion ) );
    u = collision_add_scaled( u, -collision_dot( n, u ), n );
    u = collision_sub( u, rubbed );
    float length = collision_length( u );
    float share = length <= c->static_friction * pushed ? 1.0f : c->kinetic_friction * pushed / length;
    const wisp_vec3 now = { -share * u.x, -share * u.y, -share * u.z };
    *p = collision_add_scaled( *p, 1.0f, collision_sub( now, rubbed ) );
    collision_store( c->rubbed, now );
}

// What pushes out of one half space may push into another, so several are gone through a few times.
static void project_contacts( collision_contact* contacts, int count, wisp_vec3* p, wisp_vec3 previous )
{
    enum
    {
        SWEEPS = 4,
    };
    for ( int sweep = 0; sweep < SWEEPS; ++sweep )
    {
        for ( int i = 0; i < count; ++i )
        {
            project_contact( contacts + i, p, previous );
        }
    }
}

// ---- the end of the substep ----

// The particle was carried out of where it is known that it meets nothing. If its path enters a body after all, it
// stays where it enters; if that is behind something else, it rides along with the body instead.
static void catch_at( const collision_view* view, wisp_vec3* p, wisp_vec3 previous )
{
    const wisp_vec3 from = wisp_rigid_to_body( view->before, previous );
    wisp_vec3 to = wisp_rigid_to_body( view->after, *p );
    wisp_surface_point hit;
    if ( collision_sweep( view->body, from, to, &hit ) == false )
    {
        return;
    }
    // no farther from the body than it was: coming nearer must not end in going away
    float height = collision_dot( hit.normal, collision_sub( from, hit.point ) );
    to = collision_add_scaled( hit.point, fminf( view->thickness, fmaxf( 0.0f, height ) ), hit.normal );
    to = collision_sweep( view->body, from, to, &hit ) ? from : to;
    *p = wisp_rigid_to_world( view->after, to );
}

typedef struct project_loop
{
    float* position;
    const float* previous;
    const int32_t* count;
    const float* found;
    collision_contact ( *contact )[WISP_COLLISION_CONTACTS];
    int32_t strays[CHUNK]; // slots that left the place that is known
    int stray_count;
} project_loop;

static void catch_strays( wisp_frame* frame, const wisp_span* span, const collision_state* state, project_loop* loop )
{
    wisp_vec3 low = { INFINITY, INFINITY, INFINITY }, high = { -INFINITY, -INFINITY, -INFINITY };
    for ( int i = 0; i < loop->stray_count; ++i )
    {
        size_t quad = (size_t)loop->strays[i] * 4;
        collision_widen( &low, &high, collision_load( loop->position + quad ) );
        collision_widen( &low, &high, collision_load( loop->previous + quad ) );
    }
    collision_view view;
    for ( int next = 0; loop->stray_count > 0 && collision_next( frame, span, state, &next, &view ); )
    {
        // a particle that a body has moved may be in the way of the next
        const bool near = collision_ball_distance( &view, low, high ) <= 2.0f * view.thickness;
        for ( int i = 0; i < loop->stray_count && near; ++i )
        {
            size_t quad = (size_t)loop->strays[i] * 4;
            wisp_vec3 p = collision_load( loop->position + quad );
            catch_at( &view, &p, collision_load( loop->previous + quad ) );
            collision_store( loop->position + quad, p );
            collision_widen( &low, &high, p );
        }
    }
}

// A contact is a row of the kernel.
_Static_assert( sizeof( collision_contact ) == 16 * sizeof( float ), "a row of half_space" );
_Static_assert( offsetof( collision_contact, gap ) == 9 * sizeof( float ), "where half_space has it" );
_Static_assert( offsetof( collision_contact, rubbed ) == 11 * sizeof( float ), "where half_space has it" );
_Static_assert( offsetof( collision_contact, kinetic_friction ) == 15 * sizeof( float ), "where half_space has it" );

// Particles with one contact each, of the block that begins at `begin`.
static void project_singles( const wisp_kernels* kernels, project_loop* loop, int begin, int end )
{
    int32_t particle4[CHUNK], row16[CHUNK];
    int n = 0;
    for ( int slot = begin; slot < end; ++slot )
    {
        particle4[n] = 4 * ( slot - begin );
        row16[n] = 16 * WISP_COLLISION_CONTACTS * ( slot - begin );
        n += loop->count[slot] == 1 ? 1 : 0;
    }
    // the last group is filled with its last particle
    const int padded = ( n + 7 ) / 8 * 8;
    for ( int i = n; i < padded; ++i )
    {
        particle4[i] = particle4[n - 1];
        row16[i] = row16[n - 1];
    }
    const wisp_half_space_job job = {
        .position = loop->position + (size_t)begin * 4,
        .previous = loop->previous + (size_t)begin * 4,
        .rows = loop->contact[begin][0].point,
        .particle4 = particle4,
        .row16 = row16,
    };
    kernels->half_space( &job, 0, padded );
}

static void project_crowded( project_loop* loop, int begin, int end )
{
    for ( int slot = begin; slot < end; ++slot )
    {
        const int32_t count = loop->count[slot];
        if ( count > 1 )
        {
            size_t quad = (size_t)slot * 4;
            wisp_vec3 p = collision_load( loop->position + quad );
            int used = count < WISP_COLLISION_CONTACTS ? count : WISP_COLLISION_CONTACTS;
            project_contacts( loop->contact[slot], used, &p, collision_load( loop->previous + quad ) );
            collision_store( loop->position + quad, p );
        }
    }
}

void collision_project( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    project_loop loop = {
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 ),
        .count = wisp_frame_column( frame, span->entity, state->contact, 0 ),
        .found = wisp_frame_column( frame, span->entity, state->contact, 1 ),
        .contact = wisp_frame_column( frame, span->entity, state->contact, 2 ),
    };
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    const bool last = span->iteration + 1 == wisp_frame_iterations( frame );
    const wisp_span s = wisp_frame_particles( frame, span );
    for ( int begin = s.begin; begin < s.end; begin += CHUNK )
    {
        const int end = s.end - begin < CHUNK ? s.end : begin + CHUNK;
        project_singles( kernels, &loop, begin, end );
        project_crowded( &loop, begin, end );
        if ( last )
        {
            loop.stray_count = kernels->swarm_stray( loop.position, loop.found, begin, end, loop.strays );
            catch_strays( frame, span, state, &loop );
        }
    }
}
