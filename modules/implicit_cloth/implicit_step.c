// One substep: gather the surface and its contacts into rows, linearise the forces and solve, once or several times, and scatter
// the new velocities and positions. Equations: docs/methods.md.

#include "implicit_internal.h"

#include <string.h>

// ---- setup ----

// Set up a substep: its integrator, the columns of its surface, and memory for its rows.

// k h^2 / m of the stiffest link and the mean mass (bench case `stability`).
static const double RATIO_BDF2 = 512.0;   // beyond, the last substep does not predict this one
static const double RATIO_STIFF = 1024.0; // beyond, one linear solve may gain energy
static const double RATIO_LOOSE = 8192.0; // beyond, what a loose solve leaves is energy of stiff links
static const double MAX_RATIO = 1e6;      // beyond, floats lose the mass next to the stiffness

// ---- the integrator ----

static double mean_mass( const implicit_links* links, const float* position )
{
    double mass = 0.0;
    int count = 0;
    for ( int row = 0; row < links->row_count; ++row )
    {
        const int slot = links->row_slot[row];
        const float weight = slot >= 0 ? position[(size_t)slot * 4 + 3] : 0.0f;
        if ( weight > 0.0f )
        {
            mass += (double)( links->fraction[row] / weight );
            count += 1;
        }
    }
    return count > 0 ? mass / count : INFINITY;
}

// Set the weights of the substep before. @param w h / h_before; 0: Euler
static void implicit_set_weights( implicit_substep* s, float h, float w )
{
    s->recent = ( 1.0f + w ) * ( 1.0f + w ) / ( 1.0f + 2.0f * w );
    s->older = w * w / ( 1.0f + 2.0f * w );
    s->system.spring.dt = h * ( 1.0f + w ) / ( 1.0f + 2.0f * w );
}

// Two step BDF with w = h / h_before; Euler in the first substep, and in substeps too long, compared with the links,
// for an extrapolation.
static void implicit_choose_integrator( wisp_frame* frame, const wisp_span* span, implicit_substep* s )
{
    const implicit_material* m = s->system.material;
    const implicit_links* links = s->system.links;
    const float h = wisp_frame_dt( frame, span->entity );
    const double mass = mean_mass( links, wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ) );
    const double ratio = (double)links->stiffest * (double)h * (double)h / mass;
    s->stiff = ratio > RATIO_STIFF && m->max_newton_iterations > 1;
    s->system.looseness = fmin( 1.0, RATIO_LOOSE * RATIO_LOOSE / ( ratio * ratio ) );
    s->guarded = s->stiff == false && m->max_newton_iterations > 1;
    const bool two = m->bdf2 != 0 && m->before > 0.0f && ratio <= RATIO_BDF2;
    s->extrapolates = two;
    if ( m->bdf2 != 0 && ratio > RATIO_BDF2 )
    {
        wisp_frame_count( frame, WISP_COUNT_FIRST_ORDER, 1 );
    }
    if ( ratio > MAX_RATIO )
    {
        s->system.spring.max_stiffness = (float)( MAX_RATIO / ratio * (double)links->stiffest );
        wisp_frame_count( frame, WISP_COUNT_STIFFNESS_CLAMPED, 1 );
    }
    implicit_set_weights( s, h, two ? h / m->before : 0.0f );
}

// ---- memory ----

typedef struct arena
{
    char* at; // null: only adds up
    size_t used;
} arena;

static void* take( arena* a, size_t bytes )
{
    void* block = a->at != NULL ? a->at + a->used : NULL;
    a->used += ( bytes + 63 ) & ~(size_t)63;
    return block;
}

static void lay_out( implicit_substep* s, arena* a )
{
    implicit_system* y = &s->system;
    const size_t rows = (size_t)y->links->row_count, slices = (size_t)y->links->slice_count;
    const size_t entries = (size_t)y->links->springs.begin[2 * slices], xyzw = rows * 4 * sizeof( float );
    const size_t blocks = (size_t)y->block_count;
    y->place = take( a, xyzw );
    y->start = take( a, xyzw );
    y->goal = take( a, xyzw );
    y->rubbing = take( a, xyzw );
    s->point = take( a, xyzw );
    s->velocity = take( a, xyzw );
    y->conjugate.direction = take( a, xyzw );
    y->spring.axis = take( a, entries * sizeof( y->spring.axis[0] ) );
    y->spring.rhs = take( a, slices * sizeof( y->spring.rhs[0] ) );
    y->spring.inverse = take( a, slices * sizeof( y->spring.inverse[0] ) );
    y->filter_floats = take( a, slices * sizeof( y->conjugate.filter[0] ) );
    y->conjugate.product = take( a, slices * sizeof( y->conjugate.product[0] ) );
    y->conjugate.solution = take( a, slices * sizeof( y->conjugate.solution[0] ) );
    y->conjugate.search = take( a, slices * sizeof( y->conjugate.search[0] ) );
    y->requested = take( a, s->stiff || s->guarded ? slices * sizeof( y->requested[0] ) : 0 );
    s->from = s->guarded ? take( a, xyzw ) : NULL;
    s->held = s->guarded ? take( a, rows * sizeof( implicit_contact ) ) : NULL;
    s->gains = take( a, s->guarded ? blocks * sizeof( implicit_gain ) : 0 );
    y->filtered = take( a, slices );
    y->sums = take( a, blocks * sizeof( double ) );
    s->counts = take( a, blocks * sizeof( implicit_counts ) );
    s->undirected = take( a, blocks * sizeof( int ) );
    s->motion = take( a, blocks * sizeof( double ) );
    s->guesses = take( a, blocks * sizeof( bool ) );
    s->worst = take( a, blocks * sizeof( float ) );
}

// Take scratch memory for rows and blocks. @return false without memory
static bool implicit_find_room( implicit_substep* s, int worker )
{
    arena a = { NULL, 0 };
    lay_out( s, &a );
    a = ( arena ){ wisp_parallel_scratch( s->system.parallel, worker, a.used ), 0 };
    if ( a.at == NULL )
    {
        return false;
    }
    lay_out( s, &a );
    implicit_system* y = &s->system;
    y->spring.links = y->conjugate.links = y->links->springs;
    y->spring.position = s->point;
    y->spring.velocity = s->velocity;
    y->spring.start_velocity = y->start;
    y->conjugate.axis = (const float( * )[4][WISP_SLICE])y->spring.axis;
    y->conjugate.inverse = (const float( * )[6][WISP_SLICE])y->spring.inverse;
    y->conjugate.filter = ( const float( * )[6][WISP_SLICE] )(const void*)y->filter_floats;
    y->conjugate.filtered = y->filtered;
    y->conjugate.residual = y->spring.rhs;
    return true;
}

// ---- columns and settings ----

static void implicit_find_columns( wisp_frame* frame, const wisp_span* span, const implicit_state* state,
                                   implicit_substep* s )
{
    const wisp_entity e = span->entity;
    s->columns = ( implicit_columns ){
        .position = wisp_frame_column( frame, e, WISP_PARTICLE_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, e, WISP_PARTICLE_VELOCITY, 0 ),
        .change = wisp_frame_column( frame, e, state->change, 0 ),
        .before_position = wisp_frame_column( frame, e, state->history, 0 ),
        .before_velocity = wisp_frame_column( frame, e, state->history, 1 ),
        .body = wisp_frame_column( frame, e, WISP_PARTICLE_CONTACTS, 0 ),
    };
    s->columns.given = ( implicit_given ){
        .body = wisp_frame_column( frame, e, WISP_PARTICLE_CONTACT_IMPULSES, 0 ),
        .impulse = wisp_frame_column( frame, e, WISP_PARTICLE_CONTACT_IMPULSES, 1 ),
        .point = wisp_frame_column( frame, e, WISP_PARTICLE_CONTACT_IMPULSES, 2 ),
    };
    if ( wisp_frame_has( frame, e, state->corrected ) )
    {
        s->columns.previous = wisp_frame_column( frame, e, WISP_PARTICLE_PREVIOUS, 0 );
        s->columns.solved = wisp_frame_column( frame, e, state->solved, 0 );
        s->columns.half_space_count = wisp_frame_column( frame, e, WISP_PARTICLE_HALF_SPACES, 0 );
        s->columns.half_space_rows = wisp_frame_column( frame, e, WISP_PARTICLE_HALF_SPACES, 2 );
    }
    const wisp_vec3* gravity = wisp_frame_column( frame, e, WISP_PARTICLE_GRAVITY, 0 );
    s->gravity = gravity != NULL ? *gravity : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    const float h = wisp_frame_dt( frame, span->entity ), gx = s->gravity.x, gy = s->gravity.y, gz = s->gravity.z;
    const float HYSTERESIS = 1e-9f; // of the weight: the sign decides
    s->contact_input = ( implicit_contact_input ){
        .body = s->columns.body,
        .plane = wisp_frame_column( frame, e, WISP_PARTICLE_CONTACTS, 1 ),
        .motion = wisp_frame_column( frame, e, WISP_PARTICLE_CONTACTS, 2 ),
        .friction = wisp_frame_column( frame, e, WISP_PARTICLE_CONTACTS, 3 ),
        .contact = wisp_frame_column( frame, e, state->contact, 0 ),
        .position = s->columns.position,
        .velocity = s->columns.velocity,
        .target = wisp_frame_column( frame, e, WISP_PARTICLE_TARGET, 0 ),
        .seconds = h,
        .hysteresis = HYSTERESIS * h * sqrtf( gx * gx + gy * gy + gz * gz ),
        .target_fraction = wisp_frame_progress_left( frame, span->entity, span->substep ),
    };
}

// Set what the surface's damping leaves of a velocity.
static void implicit_set_kept( wisp_frame* frame, const wisp_span* span, implicit_substep* s )
{
    const float* damping = wisp_frame_column( frame, span->entity, WISP_PARTICLE_DAMPING, 0 );
    s->kept = damping != NULL ? 1.0f / ( 1.0f + *damping * s->system.spring.dt ) : 1.0f;
}

// Bending of a material. Beyond MAX_RATIO floats lose the mass next to it, as they do with links.
static void implicit_set_plate( wisp_frame* frame, const wisp_span* span, implicit_substep* s )
{
    implicit_system* y = &s->system;
    const implicit_links* links = y->links;
    if ( links->plate == NULL )
    {
        return;
    }
    const double rate = (double)links->rigidity * (double)y->spring.dt * (double)y->spring.dt;
    const wisp_plate_input input = { .position = s->columns.position,
                                     .has_mass_map = wisp_frame_has( frame, span->entity, WISP_MAP_AREA_DENSITY ),
                                     .max_rate = (float)( MAX_RATIO / rate ) };
    wisp_plate* plate = links->plate; // nobody else has it
    const int lowered = wisp_plate_update( &plate, wisp_frame_fabric( frame, span->entity ), &input );
    if ( lowered < 0 )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the bending of entity %u", span->entity.index );
    }
    if ( lowered > 0 )
    {
        wisp_frame_count( frame, WISP_COUNT_STIFFNESS_CLAMPED, 1 );
    }
    y->spring.plate = y->conjugate.plate = wisp_plate_get_rows( links->plate );
    y->spring.rigidity = links->rigidity;
    y->conjugate.plate_rate = (float)rate;
}

// ---- reactions ----

// What implicit cloth gives to bodies. In: impulses of the last solve. Out: particle.contact_impulses, of which collision makes
// reactions. The impulse of a solve acts for the time of its equations, 2/3 h with BDF2; what settles the history of BDF2 after an
// impact takes momentum too (implicit_apply_contact_correction).

// Momentum of a slot as BDF2 conserves it, kg m/s: m (3 v - v_before) / 2; by Euler m v.
// @param v_before [3], null: Euler
static wisp_vec3 implicit_momentum( const implicit_contact_input* f, int slot, const float* v, const float* v_before )
{
    const float weight = f->position[(size_t)slot * 4 + 3], mass = weight > 0.0f ? 1.0f / weight : 0.0f;
    float p[3];
    for ( int k = 0; k < 3; ++k )
    {
        p[k] = mass * ( v_before != NULL ? 1.5f * v[k] - 0.5f * v_before[k] : v[k] );
    }
    return ( wisp_vec3 ){ p[0], p[1], p[2] };
}

// The share of the second of two bodies: what presses along its normal. The first has the rest, friction included.
static wisp_vec3 share_of_second( const implicit_contact_input* f, int slot, float scale )
{
    const float *n = f->plane + (size_t)slot * 4 * WISP_MAX_PARTICLE_CONTACTS, *m = n + 4;
    const float x = n[1] * m[2] - n[2] * m[1], y = n[2] * m[0] - n[0] * m[2], z = n[0] * m[1] - n[1] * m[0];
    const float pressed = x * x + y * y + z * z < IMPLICIT_SAME_NORMALS ? 0.0f : scale * f->contact[slot].pressed[1];
    return ( wisp_vec3 ){ pressed * m[0], pressed * m[1], pressed * m[2] };
}

static void put( const implicit_given* given, size_t at, int32_t body, float x, float y, float z )
{
    given->body[at] = body;
    given->impulse[3 * at] = -x;
    given->impulse[3 * at + 1] = -y;
    given->impulse[3 * at + 2] = -z;
}

// Write what a row gave to its bodies, from the impulse that implicit_press_row() stored.
// @param settled kg m/s, what contact took from the row besides
// @param from [3] m, where the row was
static void implicit_give_row( const implicit_system* s, const implicit_contact_input* f, const implicit_given* given,
                               int row, wisp_vec3 settled, const float* from )
{
    const int slot = s->links->row_slot[row];
    const implicit_contact* contact = f->contact + slot;
    if ( contact->body[0] == 0 && contact->body[1] == 0 )
    {
        return;
    }
    const float scale = given->per_solve / s->links->fraction[row];
    const float* rubbing = s->rubbing + (size_t)row * 4;
    const wisp_vec3 held = implicit_impulse( s, row );
    const float x = scale * ( held.x + rubbing[0] ) + settled.x, y = scale * ( held.y + rubbing[1] ) + settled.y,
                z = scale * ( held.z + rubbing[2] ) + settled.z;
    const size_t first = (size_t)slot * WISP_MAX_PARTICLE_CONTACTS;
    if ( contact->body[0] == 0 || contact->body[1] == 0 )
    {
        const size_t place = contact->body[0] != 0 ? 0 : 1;
        put( given, first + place, contact->body[place], x, y, z );
    }
    else
    {
        const wisp_vec3 second = share_of_second( f, slot, scale );
        put( given, first, contact->body[0], x - second.x, y - second.y, z - second.z );
        put( given, first + 1, contact->body[1], second.x, second.y, second.z );
    }
    for ( int k = 0; k < 3; ++k )
    {
        given->point[(size_t)slot * 3 + (size_t)k] = from[k];
    }
}

// ---- correction by contact ----

// Contact of surfaces, which corrects the positions that the solver leaves. In: positions after the correction, and the
// displacement that the solve gave. Out: velocities; for the correction, the half spaces outside bodies.
//
//   c = ( x - x_previous ) - ( way of the solve ),   v <- v + c / h
//
// What moves position and previous position alike (recovery, untangling) gives no velocity. After a correction BDF2 starts again
// with a substep of Euler: it would extrapolate the impact, and a particle at rest would keep half the velocity g h.

// ---- half spaces ----

// Write the half spaces that contact may not push a particle out of, from the bodies of this substep.
// @param from, x [3] m, where the particle was and is @param rows [WISP_MAX_HALF_SPACES], as of the kernel half_space @return how many
static int32_t implicit_fill_half_spaces( const implicit_contact_input* f, int slot, const float* from,
                                          const float* x, float ( *rows )[16] )
{
    int32_t count = 0;
    for ( int place = 0; place < WISP_MAX_PARTICLE_CONTACTS; ++place )
    {
        const size_t at = (size_t)slot * WISP_MAX_PARTICLE_CONTACTS + (size_t)place;
        if ( f->body[at] == 0 )
        {
            continue;
        }
        const float *plane = f->plane + 4 * at, *motion = f->motion + 4 * at, *friction = f->friction + 3 * at;
        float* row = rows[count++];
        memset( row, 0, 16 * sizeof( float ) );
        float gap = plane[3];
        for ( int k = 0; k < 3; ++k )
        {
            const float displacement = f->seconds * motion[k];
            gap += plane[k] * ( x[k] - from[k] - displacement );
            row[k] = x[k];
            row[3 + k] = plane[k];
            row[6 + k] = displacement;
        }
        row[9] = fminf( gap, 0.5f * motion[3] ) - gap;
        row[14] = friction[0];
        row[15] = friction[1];
    }
    return count;
}

// ---- velocities ----

void implicit_take_correction( wisp_frame* frame, const wisp_span* span, void* user )
{
    const implicit_state* state = user;
    const wisp_entity e = span->entity;
    const float *position = wisp_frame_column( frame, e, WISP_PARTICLE_POSITION, 0 ),
                *previous = wisp_frame_column( frame, e, WISP_PARTICLE_PREVIOUS, 0 ),
                *solved = wisp_frame_column( frame, e, state->solved, 0 );
    float* velocity = wisp_frame_column( frame, e, WISP_PARTICLE_VELOCITY, 0 );
    const float h = wisp_frame_dt( frame, e );
    const size_t slots = (size_t)wisp_frame_fabric( frame, e )->slot_count;
    bool is_corrected = false;
    for ( size_t i = 0; i < slots * 4; ++i )
    {
        const float correction =
            i % 4 < 3 && position[i | 3] > 0.0f ? position[i] - previous[i] - solved[i / 4 * 3 + i % 4] : 0.0f;
        velocity[i] += correction / h;
        is_corrected = is_corrected || correction != 0.0f;
    }
    implicit_material* material = wisp_frame_column( frame, e, state->material, 0 );
    if ( is_corrected && material->bdf2 != 0 )
    {
        material->before = 0.0f;
        wisp_frame_count( frame, WISP_COUNT_FIRST_ORDER, 1 );
    }
}

// ---- step ----

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
    implicit_counts* counts = s->counts + begin / s->system.grain;
    *counts = ( implicit_counts ){ 0 };
    double motion = 0.0;
    for ( int slice = begin; slice < end; ++slice )
    {
        s->system.filtered[slice] = 0;
        for ( int row = slice * WISP_SLICE; row < ( slice + 1 ) * WISP_SLICE; ++row )
        {
            keep_row( s, row );
            gather_row( s, row );
            implicit_touch_row( &s->system, &s->contact_input, row, counts );
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
    implicit_apply_contact_correction( &s->contact_input, slot, c->position + quad, v, c->before_position + quad,
                                       v_before );
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

static void add_contacts( const implicit_substep* s, implicit_counts* total )
{
    for ( int block = 0; block < s->system.block_count; ++block )
    {
        total->sticking += s->counts[block].sticking;
        total->sliding += s->counts[block].sliding;
        total->landing += s->counts[block].landing;
        total->released += s->counts[block].released;
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

static void attempt( wisp_frame* frame, const wisp_span* span, implicit_substep* s, implicit_counts* counts )
{
    implicit_set_kept( frame, span, s );
    implicit_set_plate( frame, span, s );
    implicit_for_slices( s, gather_slices );
    implicit_iterate( frame, s, counts );
}

// A substep that gained energy is made again, as a stiff one and by Euler.
static void attempt_again( wisp_frame* frame, const wisp_span* span, implicit_substep* s, implicit_counts* counts )
{
    if ( s->extrapolates )
    {
        implicit_set_weights( s, s->contact_input.seconds, 0.0f );
        wisp_frame_count( frame, WISP_COUNT_FIRST_ORDER, 1 );
    }
    s->is_second = s->stiff = true;
    attempt( frame, span, s, counts );
    (void)gains( s );
}

void implicit_step( wisp_frame* frame, const wisp_span* span, void* user )
{
    const implicit_state* state = user;
    const implicit_links* links = wisp_find_object( state->links, span->entity );
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
    implicit_counts counts = { 0 };
    attempt( frame, span, &s, &counts );
    if ( s.guarded && gains( &s ) )
    {
        attempt_again( frame, span, &s, &counts );
    }
    material->gained = (float)s.gained;
    add_contacts( &s, &counts );
    counts.stiffest = s.system.spring.max_stiffness;
    s.columns.given.per_solve = s.contact_input.seconds / s.system.spring.dt;
    implicit_for_slices( &s, scatter_slices );
    // after the impulses, because the right side overwrites them
    counts.newton_residual = material->requests_stats != 0 ? newton_residual( &s ) : 0.0f;
    material->before = wisp_frame_dt( frame, span->entity );
    *(implicit_counts*)wisp_frame_column( frame, span->entity, state->counts, 0 ) = counts;
}
