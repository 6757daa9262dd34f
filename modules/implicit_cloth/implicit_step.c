// One substep: gather the surface and its contacts into rows, linearise the forces and solve, once or several times, and scatter
// the new velocities and positions. Equations: docs/methods.md.
#include "implicit_substep.h"

#include <float.h>
#include <string.h>

enum
{
    ONE_BLOCK = 256, // slices; a smaller surface is solved by one worker, since waking another costs more
    GRAIN = 64,      // slices a block of a larger one
    SHORTENINGS = 4, // of a solve's answer, at most
};

// Of a stiff substep, by the same case. REACH: a link this fraction shorter than its rest length still counts as stiff. At 0, slack
// links are found stretched by the next solve, in turns; at 1, slack cloth hardly moves. SETTLED: the repeats end when a solve
// gains less than this fraction of the motion. PAST: a step is too long if the slope at its end is more than this fraction of
// the slope at its start.
static const float REACH = 0.01f;
static const double SETTLED = 1e-4, PAST = 0.5;

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

// ---- a solve ----

static void assemble_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    implicit_substep* s = context;
    s->undirected[begin / s->system.grain] = s->system.kernels->spring_assemble( &s->system.spring, begin, end );
}

// Initial guess: (I - S)( goal - v ) of a held row and S times the solution of the last substep.
static bool guess_row( implicit_substep* s, int row )
{
    const implicit_system* system = &s->system;
    const int slot = system->links->row_slot[row], lane = row % WISP_SLICE;
    const bool warm = s->columns.change != NULL && system->spring.is_repeat == false && slot >= 0;
    const float *goal = system->goal + (size_t)row * 4, *v = s->velocity + (size_t)row * 4;
    float free[3] = { 0.0f }, held[3] = { 0.0f };
    for ( int k = 0; k < 3; ++k )
    {
        free[k] = warm ? s->columns.change[(size_t)slot * 3 + (size_t)k] : 0.0f;
        held[k] = goal[3] != 0.0f ? goal[k] - v[k] : 0.0f;
    }
    float* guess = system->conjugate.direction + (size_t)row * 4;
    if ( system->filtered[row / WISP_SLICE] != 0 )
    {
        const float* f = system->filter_floats + (size_t)( row / WISP_SLICE ) * 6 * WISP_SLICE + lane;
        const float d[3] = { free[0] - held[0], free[1] - held[1], free[2] - held[2] };
        free[0] = held[0] + f[0] * d[0] + f[WISP_SLICE] * d[1] + f[2 * WISP_SLICE] * d[2];
        free[1] = held[1] + f[WISP_SLICE] * d[0] + f[3 * WISP_SLICE] * d[1] + f[4 * WISP_SLICE] * d[2];
        free[2] = held[2] + f[2 * WISP_SLICE] * d[0] + f[4 * WISP_SLICE] * d[1] + f[5 * WISP_SLICE] * d[2];
    }
    memcpy( guess, free, sizeof( free ) );
    guess[3] = s->point[(size_t)row * 4 + 3];
    const float* rubbing = system->rubbing + (size_t)row * 4;
    for ( int k = 0; k < 3; ++k )
    {
        system->conjugate.residual[row / WISP_SLICE][k][lane] += rubbing[k];
    }
    return free[0] != 0.0f || free[1] != 0.0f || free[2] != 0.0f;
}

static void prepare_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    implicit_substep* s = context;
    bool guessed = false;
    for ( int row = begin * WISP_SLICE; row < end * WISP_SLICE; ++row )
    {
        guessed = guess_row( s, row ) || guessed;
    }
    s->guesses[begin / s->system.grain] = guessed;
    const size_t slices = (size_t)( end - begin );
    memset( s->system.conjugate.solution[begin], 0, slices * sizeof( s->system.conjugate.solution[0] ) );
    memset( s->system.conjugate.product[begin], 0, slices * sizeof( s->system.conjugate.product[0] ) );
}

// Move to v_k plus a fraction of dv, and to x^ plus h times that.
static void move_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    implicit_substep* s = context;
    const float h = s->system.spring.dt;
    for ( int row = begin * WISP_SLICE; row < end * WISP_SLICE; ++row )
    {
        const float* place = s->system.place + (size_t)row * 4;
        float *v = s->velocity + (size_t)row * 4, *x = s->point + (size_t)row * 4;
        for ( int k = 0; k < 3; ++k )
        {
            v[k] += s->moved * s->system.conjugate.solution[row / WISP_SLICE][k][row % WISP_SLICE];
            x[k] = place[k] + h * v[k];
        }
    }
}

static void for_slices( implicit_substep* s, wisp_range_fn* run )
{
    wisp_parallel_for( s->system.parallel, s->system.links->slice_count, s->system.grain, run, s );
}

static void move( implicit_substep* s, double fraction )
{
    s->moved = (float)fraction;
    for_slices( s, move_slices );
}

static void count_outcome( wisp_frame* frame, const implicit_outcome* outcome )
{
    if ( outcome->unsolved )
    {
        wisp_frame_count( frame, WISP_COUNT_NOT_CONVERGED, 1 );
    }
    if ( outcome->indefinite )
    {
        wisp_frame_count( frame, WISP_COUNT_INDEFINITE, 1 );
    }
}

static int assemble( implicit_substep* s, bool repeat )
{
    s->system.spring.is_repeat = repeat;
    s->system.spring.compression_margin = s->stiff ? REACH : 0.0f;
    s->system.spring.base_position = repeat && s->stiff ? s->system.place : NULL;
    for_slices( s, assemble_slices );
    int undirected = 0;
    for ( int block = 0; block < s->system.block_count; ++block )
    {
        undirected += s->undirected[block];
    }
    return undirected / 2; // each link is counted at both ends
}

// Lower bound of the residual: rounding of the initial velocities leaves a right side that a solve cannot reduce.
static double find_floor( const implicit_substep* s )
{
    double motion = (double)FLT_MIN;
    for ( int block = 0; block < s->system.block_count; ++block )
    {
        motion += s->motion[block];
    }
    const double rounding = 2.0 * (double)FLT_EPSILON;
    return rounding * rounding * motion;
}

// ---- stiff substeps ----

// A link that is slack where forces are evaluated does not resist, and may be stretched in the next substep: it then stores
// k h^2 / m times the energy that moved. But a substep is the minimum of a convex sum, 1/2 m |v - v^|^2 plus the energies of links.
// So a stiff substep is solved until a solve gains little, and a step beyond the minimum is shortened.

typedef struct slope_loop
{
    const implicit_substep* s;
    float ( *right )[3][WISP_SLICE];
    bool rubs; // friction is not included yet
} slope_loop;

static void slope_slices( void* context, int begin, int end, int worker )
{
    (void)worker;
    const slope_loop* loop = context;
    const implicit_system* y = &loop->s->system;
    double sum = 0.0;
    for ( int row = begin * WISP_SLICE; row < end * WISP_SLICE; ++row )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const float rubbing = loop->rubs ? y->rubbing[(size_t)row * 4 + (size_t)k] : 0.0f;
            const float right = loop->right[row / WISP_SLICE][k][row % WISP_SLICE] + rubbing;
            sum += (double)right * (double)y->conjugate.solution[row / WISP_SLICE][k][row % WISP_SLICE];
        }
    }
    y->sums[begin / y->grain] = sum;
}

// Slope of that sum along the last step, J.
static double add_slopes( implicit_substep* s, float ( *right )[3][WISP_SLICE], bool rubs )
{
    slope_loop loop = { s, right, rubs };
    wisp_parallel_for( s->system.parallel, s->system.links->slice_count, s->system.grain, slope_slices, &loop );
    double sum = 0.0;
    for ( int block = 0; block < s->system.block_count; ++block )
    {
        sum += s->system.sums[block];
    }
    return sum;
}

static bool is_settled( const implicit_substep* s, double slope )
{
    double motion = 0.0;
    for ( int block = 0; block < s->system.block_count; ++block )
    {
        motion += s->motion[block];
    }
    return !( slope > SETTLED * motion );
}

// Shorten the last step; forces at its end are known. @return links without direction, of the last assembly
static int shorten( implicit_substep* s, double slope, int undirected )
{
    double fraction = 1.0;
    for ( int i = 0; i < SHORTENINGS; ++i )
    {
        const double end = add_slopes( s, s->system.spring.rhs, true );
        if ( !( end < -PAST * slope ) )
        {
            break;
        }
        const double nearer = fraction * slope / ( slope - end );
        move( s, nearer - fraction );
        fraction = nearer;
        undirected = assemble( s, true );
    }
    return undirected;
}

// Solve what has been assembled.
static implicit_outcome solve_linear( implicit_substep* s )
{
    for_slices( s, prepare_slices );
    s->system.guessed = false;
    for ( int block = 0; block < s->system.block_count; ++block )
    {
        s->system.guessed = s->system.guessed || s->guesses[block];
    }
    if ( s->stiff )
    {
        memcpy( s->system.requested, s->system.conjugate.residual,
                (size_t)s->system.links->slice_count * sizeof( s->system.requested[0] ) );
    }
    return implicit_solve( &s->system );
}

static void solve( wisp_frame* frame, implicit_substep* s, implicit_tally* total )
{
    s->system.floor = find_floor( s );
    int undirected = 0;
    const int queried = s->system.material->newton_iterations;
    const int stiff = s->system.material->max_newton_iterations, most = s->stiff && queried < stiff ? stiff : queried;
    const int least = s->stiff && queried < 2 ? 2 : queried; // the first one also moves pins to their targets
    double slope = 0.0;
    for ( int k = 0; k < least || ( k < most && is_settled( s, slope ) == false ); ++k )
    {
        undirected = assemble( s, k > 0 );
        if ( s->stiff && k > 1 )
        {
            undirected = shorten( s, slope, undirected );
        }
        implicit_outcome outcome = solve_linear( s );
        count_outcome( frame, &outcome );
        total->iterations += outcome.iterations;
        if ( outcome.indefinite && s->system.spring.full_jacobian )
        {
            // what a stopped solve has may be any motion; without the negative terms the matrix is definite
            s->system.spring.full_jacobian = false;
            undirected = assemble( s, k > 0 );
            outcome = solve_linear( s );
            count_outcome( frame, &outcome );
            total->iterations += outcome.iterations;
        }
        slope = s->stiff ? add_slopes( s, s->system.requested, false ) : 0.0;
        move( s, 1.0 );
        total->residual = outcome.residual;
        total->repeats += 1;
    }
    wisp_frame_count( frame, WISP_COUNT_DEGENERATE_LINK, s->is_second ? 0 : (uint64_t)undirected );
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
        if ( c->change != NULL )
        {
            c->change[(size_t)slot * 3 + (size_t)k] = v[k] - system->start[(size_t)row * 4 + (size_t)k];
        }
        // contacts are valid for this substep only
        c->body[(size_t)slot * WISP_MAX_PARTICLE_CONTACTS + (size_t)( k % WISP_MAX_PARTICLE_CONTACTS )] = 0;
    }
    if ( c->before_position != NULL )
    {
        implicit_settle_row( &s->contact_input, slot, x, v, c->before_position + quad, c->before_velocity + quad );
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
    assemble( s, true );
    for_slices( s, residual_slices );
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
    for_slices( s, gather_slices );
    solve( frame, s, tally );
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
    s->system.spring.full_jacobian = s->system.material->full_jacobian != 0;
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
            .spring = { .axial_damping = material->axial_damping != 0, .full_jacobian = material->full_jacobian != 0 },
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
    for_slices( &s, scatter_slices );
    // after the impulses, because the right side overwrites them
    tally.newton_residual = material->requests_stats != 0 ? newton_residual( &s ) : 0.0f;
    material->before = wisp_frame_dt( frame, span->entity );
    *(implicit_tally*)wisp_frame_column( frame, span->entity, state->tally, 0 ) = tally;
}
