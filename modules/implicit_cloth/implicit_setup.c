// Set up a substep: its integrator, the columns of its surface, and memory for its rows.
#include "implicit_substep.h"

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

void implicit_set_weights( implicit_substep* s, float h, float w )
{
    s->recent = ( 1.0f + w ) * ( 1.0f + w ) / ( 1.0f + 2.0f * w );
    s->older = w * w / ( 1.0f + 2.0f * w );
    s->system.spring.dt = h * ( 1.0f + w ) / ( 1.0f + 2.0f * w );
}

// Two step BDF with w = h / h_before; Euler in the first substep, and in substeps too long, compared with the links,
// for an extrapolation.
void implicit_choose_integrator( wisp_frame* frame, const wisp_span* span, implicit_substep* s )
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
    s->tallies = take( a, blocks * sizeof( implicit_tally ) );
    s->undirected = take( a, blocks * sizeof( int ) );
    s->motion = take( a, blocks * sizeof( double ) );
    s->guesses = take( a, blocks * sizeof( bool ) );
    s->worst = take( a, blocks * sizeof( float ) );
}

bool implicit_find_room( implicit_substep* s, int worker )
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

void implicit_find_columns( wisp_frame* frame, const wisp_span* span, const implicit_state* state,
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

// Of a velocity, by the surface's damping.
void implicit_set_kept( wisp_frame* frame, const wisp_span* span, implicit_substep* s )
{
    const float* damping = wisp_frame_column( frame, span->entity, WISP_PARTICLE_DAMPING, 0 );
    s->kept = damping != NULL ? 1.0f / ( 1.0f + *damping * s->system.spring.dt ) : 1.0f;
}

// Bending of a material. Beyond MAX_RATIO floats lose the mass next to it, as they do with links.
void implicit_set_plate( wisp_frame* frame, const wisp_span* span, implicit_substep* s )
{
    implicit_system* y = &s->system;
    const implicit_links* links = y->links;
    if ( links->plate == NULL )
    {
        return;
    }
    const double rate = (double)links->rigidity * (double)y->spring.dt * (double)y->spring.dt;
    wisp_plate_follow_maps( links->plate, wisp_frame_fabric( frame, span->entity ), s->columns.position, NULL,
                            wisp_frame_has( frame, span->entity, WISP_MAP_AREA_DENSITY ) );
    const int lowered = wisp_plate_update( links->plate, wisp_frame_fabric( frame, span->entity ),
                                           s->columns.position, (float)( MAX_RATIO / rate ) );
    if ( lowered > 0 )
    {
        wisp_frame_count( frame, WISP_COUNT_STIFFNESS_CLAMPED, 1 );
    }
    y->spring.plate = y->conjugate.plate = wisp_plate_get_rows( links->plate );
    y->spring.rigidity = links->rigidity;
    y->conjugate.plate_rate = (float)rate;
}
