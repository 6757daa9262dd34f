// One substep: gather the surface and its contacts into rows, linearise the forces and solve, once or several times, and scatter
// the new velocities and positions. Equations: docs/methods.md.
#include "implicit_substep.h"

#include <string.h>

enum
{
    ONE_BLOCK = 256, // slices; a smaller surface is solved by one worker, since waking another costs more
    GRAIN = 64,      // slices a block of a larger one
};

// ---- into rows ----

static void extrapolate( const implicit_substep* s, const float* now, const float* before, float out[3] )
{
    for ( int k = 0; k < 3; ++k )
    {
        out[k] = before != NULL ? s->recent * now[k] - s->older * before[k] : now[k];
    }
}

static void gather_row( implicit_substep* s, int row )
{
    const implicit_system* system = &s->system;
    const int slot = system->links->row_slot[row];
    float *place = system->place + (size_t)row * 4, *start = system->start + (size_t)row * 4;
    memset( place, 0, 4 * sizeof( float ) );
    memset( start, 0, 4 * sizeof( float ) );
    place[3] = 1.0f;
    if ( slot < 0 )
    {
        return;
    }
    const implicit_columns* c = &s->columns;
    const size_t quad = (size_t)slot * 4;
    const float weight = c->position[quad + 3];
    extrapolate( s, c->position + quad, c->before_position != NULL ? c->before_position + quad : NULL, place );
    extrapolate( s, c->velocity + quad, c->before_velocity != NULL ? c->before_velocity + quad : NULL, start );
    if ( weight > 0.0f )
    {
        const float fall = system->spring.dt;
        place[3] = system->links->fraction[row] / weight;
        start[0] = s->kept * start[0] + fall * s->gravity.x;
        start[1] = s->kept * start[1] + fall * s->gravity.y;
        start[2] = s->kept * start[2] + fall * s->gravity.z;
    }
}

// The second attempt must judge contacts as the first.
static void keep_row( implicit_substep* s, int row )
{
    const int slot = s->system.links->row_slot[row];
    if ( s->held == NULL )
    {
        return;
    }
    if ( slot < 0 )
    {
        memset( s->from + (size_t)row * 4, 0, 4 * sizeof( float ) ); // whole slices are read
        return;
    }
    memcpy( s->from + (size_t)row * 4, s->columns.position + (size_t)slot * 4, 4 * sizeof( float ) );
    implicit_contact* now = s->contact_input.contact + slot;
    *( s->is_second ? now : s->held + row ) = s->is_second ? s->held[row] : *now;
}

static void gather_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    implicit_substep* s = context;
    implicit_tally* tally = s->tallies + begin / s->system.grain;
    *tally = ( implicit_tally ){ 0 };
    double motion = 0.0;
    for ( int slice = begin; slice < end; ++slice )
    {
        s->system.filtered[slice] = 0;
        for ( int row = slice * WISP_SLICE; row < ( slice + 1 ) * WISP_SLICE; ++row )
        {
            keep_row( s, row );
            gather_row( s, row );
            implicit_touch_row( &s->system, &s->contact_input, row, tally );
            const float* v = s->system.start + (size_t)row * 4;
            motion += (double)s->system.place[(size_t)row * 4 + 3] *
                      ( (double)v[0] * (double)v[0] + (double)v[1] * (double)v[1] + (double)v[2] * (double)v[2] );
        }
    }
    s->motion[begin / s->system.grain] = motion;
    const size_t first = (size_t)begin * WISP_SLICE * 4,
                 bytes = (size_t)( end - begin ) * WISP_SLICE * 4 * sizeof( float );
    memcpy( s->point + first, s->system.place + first, bytes );
    memcpy( s->velocity + first, s->system.start + first, bytes );
}

// ---- out of rows ----

// Contact of surfaces corrects what the solve leaves: it needs the way of the substep, and what bodies allow.
static void pass_on( implicit_substep* s, int slot, const float from[4] )
{
    const implicit_columns* c = &s->columns;
    const float* x = c->position + (size_t)slot * 4;
    memcpy( c->previous + (size_t)slot * 4, from, 4 * sizeof( float ) );
    for ( int k = 0; k < 3; ++k )
    {
        c->solved[(size_t)slot * 3 + (size_t)k] = x[k] - from[k];
    }
}

// @return the momentum that it gives to the slot, kg m/s
static wisp_vec3 settle( implicit_substep* s, int slot )
{
    const implicit_columns* c = &s->columns;
    const size_t quad = (size_t)slot * 4;
    float *v = c->velocity + quad, *v_before = c->before_velocity + quad;
    const wisp_vec3 old = implicit_momentum( &s->contact_input, slot, v, s->extrapolates ? v_before : NULL );
    implicit_settle_row( &s->contact_input, slot, c->position + quad, v, c->before_position + quad, v_before );
    const wisp_vec3 new = implicit_momentum( &s->contact_input, slot, v, s->extrapolates ? v_before : NULL );
    return ( wisp_vec3 ){ new.x - old.x, new.y - old.y, new.z - old.z };
}

static void scatter_row( implicit_substep* s, int row )
{
    const implicit_system* system = &s->system;
    const int slot = system->links->row_slot[row];
    if ( slot < 0 )
    {
        return;
    }
    const implicit_columns* c = &s->columns;
    const size_t quad = (size_t)slot * 4;
    float *x = c->position + quad, *v = c->velocity + quad, from[4];
    memcpy( from, x, sizeof( from ) );
    implicit_press_row( system, &s->contact_input, row );
    if ( c->half_space_rows != NULL )
    {
        c->half_space_count[slot] =
            implicit_fill_half_spaces( &s->contact_input, slot, x, s->point + (size_t)row * 4,
                                       c->half_space_rows + (size_t)slot * WISP_MAX_HALF_SPACES );
    }
    if ( c->before_position != NULL )
    {
        memcpy( c->before_position + quad, x, 4 * sizeof( float ) );
        memcpy( c->before_velocity + quad, v, 4 * sizeof( float ) );
    }
    for ( int k = 0; k < 3; ++k )
    {
        v[k] = s->velocity[(size_t)row * 4 + (size_t)k];
        x[k] = s->point[(size_t)row * 4 + (size_t)k];
        c->change[(size_t)slot * 3 + (size_t)k] = v[k] - system->start[(size_t)row * 4 + (size_t)k];
        // contacts are valid for this substep only
        c->body[(size_t)slot * WISP_MAX_PARTICLE_CONTACTS + (size_t)( k % WISP_MAX_PARTICLE_CONTACTS )] = 0;
    }
    wisp_vec3 settled = { 0.0f, 0.0f, 0.0f };
    if ( c->before_position != NULL )
    {
        settled = settle( s, slot );
    }
    if ( c->given.body != NULL )
    {
        implicit_give_row( system, &s->contact_input, &c->given, row, settled, from );
    }
    const float* target = s->contact_input.target != NULL ? s->contact_input.target + quad : NULL;
    if ( x[3] == 0.0f && target != NULL && target[3] != 0.0f && s->contact_input.target_fraction >= 1.0f )
    {
        memcpy( x, target, 3 * sizeof( float ) ); // to the last bit
    }
    if ( c->previous != NULL )
    {
        pass_on( s, slot, from );
    }
}

static void scatter_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    for ( int row = begin * WISP_SLICE; row < end * WISP_SLICE; ++row )
    {
        scatter_row( context, row );
    }
}

// Error of free rows against the nonlinear step: |b| / m of one more right side.
static void residual_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    implicit_substep* s = context;
    float worst = 0.0f;
    for ( int row = begin * WISP_SLICE; row < end * WISP_SLICE; ++row )
    {
        float( *b )[WISP_SLICE] = s->system.conjugate.residual[row / WISP_SLICE];
        const int lane = row % WISP_SLICE;
        if ( s->system.goal[(size_t)row * 4 + 3] == 0.0f )
        {
            const float size = sqrtf( b[0][lane] * b[0][lane] + b[1][lane] * b[1][lane] + b[2][lane] * b[2][lane] );
            worst = fmaxf( worst, size / s->system.place[(size_t)row * 4 + 3] );
        }
    }
    s->worst[begin / s->system.grain] = worst;
}

static float newton_residual( implicit_substep* s )
{
    implicit_assemble( s, true );
    implicit_for_slices( s, residual_slices );
    float worst = 0.0f;
    for ( int block = 0; block < s->system.block_count; ++block )
    {
        worst = fmaxf( worst, s->worst[block] );
    }
    return worst;
}

// ---- the pass ----

static void add_contacts( const implicit_substep* s, implicit_tally* total )
{
    for ( int block = 0; block < s->system.block_count; ++block )
    {
        total->sticking += s->tallies[block].sticking;
        total->sliding += s->tallies[block].sliding;
        total->landing += s->tallies[block].landing;
        total->released += s->tallies[block].released;
    }
}

// Energy is judged where the last solve left off. @return whether the substep gained more than it may
static bool gains( implicit_substep* s )
{
    const implicit_motion motion = {
        .system = &s->system,
        .from = s->from,
        .point = s->point,
        .velocity = s->velocity,
        .before = s->columns.velocity,
        .weight = s->columns.position,
        .gravity = s->gravity,
        .seconds = s->contact_input.seconds,
    };
    const implicit_gain gain = implicit_find_gain( &motion, s->gains );
    s->gained = implicit_add_gain( (double)s->system.material->gained, &gain );
    return implicit_gains( s->gained, &gain );
}

static void attempt( wisp_frame* frame, const wisp_span* span, implicit_substep* s, implicit_tally* tally )
{
    implicit_set_kept( frame, span, s );
    implicit_set_plate( frame, span, s );
    implicit_for_slices( s, gather_slices );
    implicit_iterate( frame, s, tally );
}

// A substep that gained energy is made again, as a stiff one and by Euler.
static void attempt_again( wisp_frame* frame, const wisp_span* span, implicit_substep* s, implicit_tally* tally )
{
    if ( s->extrapolates )
    {
        implicit_set_weights( s, s->contact_input.seconds, 0.0f );
        wisp_frame_count( frame, WISP_COUNT_FIRST_ORDER, 1 );
    }
    s->is_second = s->stiff = true;
    attempt( frame, span, s, tally );
    (void)gains( s );
}

void implicit_step( wisp_frame* frame, const wisp_span* span, void* user )
{
    const implicit_state* state = user;
    const implicit_links* links = implicit_find_links( state, span->entity );
    implicit_material* material = wisp_frame_column( frame, span->entity, state->material, 0 );
    const bool small = links->slice_count <= ONE_BLOCK;
    implicit_substep s = {
        .system = {
            .links = links,
            .material = material,
            .kernels = wisp_frame_kernels( frame ),
            .parallel = wisp_frame_parallel( frame, span ),
            .grain = small && links->slice_count > 0 ? links->slice_count : GRAIN,
            .limit = material->max_iterations > 0 ? material->max_iterations : 3 * links->row_count,
        },
    };
    s.system.block_count = ( links->slice_count + s.system.grain - 1 ) / s.system.grain;
    implicit_choose_integrator( frame, span, &s );
    implicit_find_columns( frame, span, state, &s );
    if ( implicit_find_room( &s, span->worker ) == false )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory to solve for %d particles",
                         wisp_frame_fabric( frame, span->entity )->vertex_count );
        return;
    }
    implicit_tally tally = { 0 };
    attempt( frame, span, &s, &tally );
    if ( s.guarded && gains( &s ) )
    {
        attempt_again( frame, span, &s, &tally );
    }
    material->gained = (float)s.gained;
    add_contacts( &s, &tally );
    tally.stiffest = s.system.spring.max_stiffness;
    s.columns.given.per_solve = s.contact_input.seconds / s.system.spring.dt;
    implicit_for_slices( &s, scatter_slices );
    // after the impulses, because the right side overwrites them
    tally.newton_residual = material->requests_stats != 0 ? newton_residual( &s ) : 0.0f;
    material->before = wisp_frame_dt( frame, span->entity );
    *(implicit_tally*)wisp_frame_column( frame, span->entity, state->tally, 0 ) = tally;
}
