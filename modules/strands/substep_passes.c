// The passes of a substep, each of which passes columns to a kernel.
//
//   v <- v + dt g, p* = p + dt v                  strands.predict    roots at their pose at the end of the substep
//   rod: apply tension, turn frames,
//        (M + dt^2 K) x = -dt^2 dE/dp at p*       strands.rod        pentadiagonal, one for x, y and z, factored once
//   contacts                                      (module collision)
//   J W J^T dlambda = -C, twice                   strands.stretch    tridiagonal: |e_s| = l_s
//   v <- v + (p - p*) / dt                        strands.velocity
//
// Rods and lengths correct v and let p follow, and a vertex is at p + low (strand_place.h). So neither motion nor
// forces are made of rounded positions, and p - p* holds only what contacts did. Without those the last pass adds 0.
//
// Bending is solved before lengths, so tension must be applied first or the order costs accuracy: p* += dt^2 w (T_s
// t_s - T_{s-1} t_{s-1}). A straight rod takes the tension of the substep before, within the bound of rod_factors.c.
// Heavy elasticas of 64 vertices are within 0.3 % of the closed form at any number of substeps from 4 on. In a curled
// rod stretching and bending mix, and tension that is fed back grows without bound; it takes the tension of its rest
// shape in balance instead (none for `rest: shape`).
//
// With BDF2 strands.extrapolate comes before the forces: it shifts starts and extrapolates velocities, so that all that
// follows is implicit Euler with dt = 2h/3 (strand_kernels.h, docs/methods.md). Each strand has a dt of its own, since one
// that was pushed, reset or turned too fast goes back to Euler with dt = h.
//
// A strand whose lengths Newton does not solve is reset to its rest lengths from the root on. The reset makes no
// vertex faster than predicted.
#include "strand_passes.h"

#include "strand_rows.h"

#include <string.h>

// Fraction by which inextensible strands may be too long without being counted.
static const float MAX_STRETCH = 0.05f;

enum
{
    BETWEEN_FLOATS = 7 * WISP_LANES, // of a row: previous position, segment, speed
};

static float* column_of( wisp_frame* frame, const wisp_span* span, wisp_component component, int column )
{
    return wisp_frame_column( frame, span->entity, component, column );
}

static const int32_t* rows_of_group( wisp_frame* frame, const wisp_span* span )
{
    return wisp_frame_strands( frame, span->entity )->group_row;
}

float* strands_scratch( wisp_frame* frame, const wisp_span* span, int floats )
{
    const int32_t* group_row = rows_of_group( frame, span );
    const size_t bytes = (size_t)( group_row[1] - group_row[0] ) * (size_t)floats * sizeof( float );
    float* scratch = wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker, bytes );
    if ( scratch == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for %zu bytes of scratch for strands of %d vertices",
                         bytes, group_row[1] - group_row[0] );
    }
    return scratch;
}

// ---- rows between the passes of a substep ----

// Rows of the span that a worker runs pass by pass: the prediction takes them, the passes after it find them.
typedef struct lent_rows
{
    float* rows;
} lent_rows;

size_t strands_lent_rows_size( void )
{
    return sizeof( lent_rows );
}

typedef struct rows_between
{
    float *previous, *segment, *speed;
} rows_between;

// An address so many floats before a block: kernels add the place of the first row of the span.
static float* before( float* rows, size_t floats )
{
    return (float*)( (uintptr_t)rows - floats * sizeof( float ) );
}

// Columns that mean nothing between substeps. An entity whose substeps are fused has none: where one of them runs pass by pass
// all the same, to measure times, its rows are scratch memory.
// @param begins the pass is the first of the substep that has them
// @return false without memory
static bool find_rows_between( wisp_frame* frame, const wisp_span* span, const strands_state* state, bool begins,
                               rows_between* out )
{
    out->previous = column_of( frame, span, WISP_STRAND_PREVIOUS, 0 );
    if ( out->previous != NULL )
    {
        out->segment = column_of( frame, span, WISP_STRAND_PREVIOUS, 1 );
        out->speed = column_of( frame, span, WISP_STRAND_PREVIOUS, 2 );
        return true;
    }
    lent_rows* lent = wisp_frame_workspace( frame, state->lent_rows, span->worker );
    const int groups = span->end - span->begin;
    lent->rows = begins ? strands_scratch( frame, span, groups * BETWEEN_FLOATS ) : lent->rows;
    if ( lent->rows == NULL )
    {
        return false;
    }
    const int32_t* group_row = rows_of_group( frame, span );
    const int first = group_row[span->begin], longest = group_row[1] - group_row[0];
    const size_t vector = strands_vector( first, 0 ), all = (size_t)( groups * longest ) * 3 * WISP_LANES;
    out->previous = before( lent->rows, vector );
    out->segment = before( lent->rows + all, vector );
    out->speed = before( lent->rows + 2 * all, strands_scalar( first, 0 ) );
    return true;
}

// ---- forces ----

static wisp_strand_history history_of( wisp_frame* frame, const wisp_span* span, const strands_state* state )
{
    if ( wisp_frame_has( frame, span->entity, state->history ) == false )
    {
        return ( wisp_strand_history ){ .step = NULL };
    }
    return ( wisp_strand_history ){
        .displacement = column_of( frame, span, state->history, 0 ),
        .before = column_of( frame, span, state->history, 1 ),
        .step = column_of( frame, span, state->history, 2 ),
    };
}

static wisp_strand_damp_args damp_args( wisp_frame* frame, const wisp_span* span, const strands_state* state )
{
    const float* rate = column_of( frame, span, state->damping, 0 );
    return ( wisp_strand_damp_args ){
        .group_row = rows_of_group( frame, span ),
        .position = column_of( frame, span, WISP_STRAND_POSITION, 0 ),
        .velocity = column_of( frame, span, WISP_STRAND_VELOCITY, 0 ),
        .inverse_mass = column_of( frame, span, WISP_STRAND_INVERSE_MASS, 0 ),
        .rate = *rate,
        .dt = wisp_frame_dt( frame, span->entity ),
        .history = history_of( frame, span, state ),
    };
}

// Return the angular velocity of the rotation from a to b in dt.
static wisp_vec3 angular_velocity( wisp_quat a, wisp_quat b, float dt )
{
    wisp_quat turn = wisp_quat_multiply( b, strands_quat_inverse( a ) );
    const float sign = turn.w < 0.0f ? -1.0f : 1.0f;
    const wisp_vec3 axis = { sign * turn.x, sign * turn.y, sign * turn.z };
    const float half_sine = wisp_v3_length( axis );
    const float scale = half_sine > 0.0f ? 2.0f * atan2f( half_sine, sign * turn.w ) / ( half_sine * dt ) : 0.0f;
    return ( wisp_vec3 ){ scale * axis.x, scale * axis.y, scale * axis.z };
}

// Damp motion relative to the rigid motion of the head.
void strands_damp( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const strands_head* head = wisp_frame_column( frame, span->entity, state->head, 0 );
    const float dt = wisp_frame_dt( frame, span->entity );
    const wisp_transform a = strands_head_pose( frame, span->entity, head, span->substep );
    const wisp_transform b = strands_head_pose( frame, span->entity, head, span->substep + 1 );
    wisp_strand_damp_args args = damp_args( frame, span, state );
    args.centre = a.translation;
    const wisp_vec3 displacement = wisp_v3_sub( b.translation, a.translation );
    args.linear = ( wisp_vec3 ){ displacement.x / dt, displacement.y / dt, displacement.z / dt };
    args.angular = angular_velocity( a.rotation, b.rotation, dt );
    wisp_vec3 linear, angular; // velocities are without what carries
    if ( head->jumped == 0 && strands_find_frame_velocity( frame, span, a.translation, &linear, &angular ) )
    {
        args.linear = wisp_v3_sub( args.linear, linear );
        args.angular = wisp_v3_sub( args.angular, angular );
    }
    wisp_frame_kernels( frame )->strand_damp( &args, span->begin, span->end );
}

// Roots on a surface have no common rigid motion, so each group is damped relative to the mean of its own roots.
void strands_damp_anchored( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const float* root = column_of( frame, span, WISP_STRAND_ROOT, 0 );
    wisp_strand_damp_args args = damp_args( frame, span, state );
    for ( int g = span->begin; g < span->end; ++g )
    {
        wisp_vec3 sum = { 0.0f, 0.0f, 0.0f }, place = sum, linear, angular;
        int count = 0;
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            if ( t->lane_count[g * WISP_LANES + lane] > 0 )
            {
                sum = wisp_v3_add( sum, wisp_v3_sub( strands_get( root, g, lane ),
                                                     strands_get( args.position, t->group_row[g], lane ) ) );
                place = wisp_v3_add( place, strands_get( root, g, lane ) );
                count += 1;
            }
        }
        const float scale = 1.0f / ( (float)count * wisp_frame_dt( frame, span->entity ) );
        args.linear = ( wisp_vec3 ){ scale * sum.x, scale * sum.y, scale * sum.z };
        const float mean = 1.0f / (float)count;
        const wisp_vec3 centre = { mean * place.x, mean * place.y, mean * place.z };
        if ( strands_find_frame_velocity( frame, span, centre, &linear, &angular ) )
        {
            args.centre = centre;
            args.linear = wisp_v3_sub( args.linear, linear );
            args.angular = ( wisp_vec3 ){ -angular.x, -angular.y, -angular.z };
        }
        wisp_frame_kernels( frame )->strand_damp( &args, g, g + 1 );
    }
}

void strands_drag( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const strands_air* air = wisp_frame_column( frame, span->entity, state->air, 0 );
    const wisp_strand_air_args args = {
        .group_row = rows_of_group( frame, span ),
        .position = column_of( frame, span, WISP_STRAND_POSITION, 0 ),
        .velocity = column_of( frame, span, WISP_STRAND_VELOCITY, 0 ),
        .inverse_mass = column_of( frame, span, WISP_STRAND_INVERSE_MASS, 0 ),
        .length = column_of( frame, span, WISP_STRAND_LENGTH, 0 ),
        .wind = air->wind,
        .drag = air->drag,
        .dt = wisp_frame_dt( frame, span->entity ),
        .history = history_of( frame, span, state ),
    };
    wisp_frame_kernels( frame )->strand_air( &args, span->begin, span->end );
}

// ---- prediction ----

// Return the fractions of gravity (rest_curvature.c), or null without rest curvature. The pass runs for both, so it
// does not declare the component.
static const float* part_of_substep( wisp_frame* frame, const wisp_span* span, const strands_state* state )
{
    return wisp_frame_has( frame, span->entity, state->balance ) ? column_of( frame, span, state->balance, 1 ) : NULL;
}

wisp_strand_motion_args strands_motion_args( wisp_frame* frame, const wisp_span* span, const strands_state* state )
{
    const strands_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    return ( wisp_strand_motion_args ){
        .group_row = rows_of_group( frame, span ),
        .position = column_of( frame, span, WISP_STRAND_POSITION, 0 ),
        .low = column_of( frame, span, state->low, 0 ),
        .velocity = column_of( frame, span, WISP_STRAND_VELOCITY, 0 ),
        .inverse_mass = column_of( frame, span, WISP_STRAND_INVERSE_MASS, 0 ),
        .root = column_of( frame, span, WISP_STRAND_ROOT, 0 ),
        .root_low = column_of( frame, span, WISP_STRAND_ROOT, 2 ),
        .acceleration = settings->gravity,
        .acceleration_scale = part_of_substep( frame, span, state ),
        .dt = wisp_frame_dt( frame, span->entity ),
        .history = history_of( frame, span, state ),
    };
}

// The same with the rows between passes, for a pass alone. @return false without memory
static bool motion_args_between( wisp_frame* frame, const wisp_span* span, const strands_state* state, bool begins,
                                 wisp_strand_motion_args* out )
{
    rows_between rows;
    const bool has_memory = find_rows_between( frame, span, state, begins, &rows );
    *out = strands_motion_args( frame, span, state );
    out->previous = has_memory ? rows.previous : NULL;
    out->segment = has_memory ? rows.segment : NULL;
    out->speed = has_memory ? rows.speed : NULL;
    return has_memory;
}

void strands_extrapolate( wisp_frame* frame, const wisp_span* span, void* user )
{
    const wisp_strand_motion_args args = strands_motion_args( frame, span, user );
    wisp_frame_kernels( frame )->strand_extrapolate( &args, span->begin, span->end );
}

// Whether other passes move the strands, and may have their lengths solved in turns.
static bool takes_turns( wisp_frame* frame, const wisp_span* span )
{
    return column_of( frame, span, WISP_STRAND_PREVIOUS, 0 ) != NULL;
}

// Clear tensions that the turns of the last substep sum. Those of rods begin by themselves.
static void begin_tension( wisp_frame* frame, const wisp_span* span, const strands_state* state )
{
    const strands_direct* direct = wisp_frame_column( frame, span->entity, state->direct, 0 );
    if ( direct != NULL && direct->has_rod == 0 && takes_turns( frame, span ) &&
         span->substep + 1 == wisp_frame_substeps( frame, span->entity ) )
    {
        const int32_t* group_row = rows_of_group( frame, span );
        const size_t begin = strands_scalar( group_row[span->begin], 0 );
        memset( column_of( frame, span, state->tension, 0 ) + begin, 0,
                ( strands_scalar( group_row[span->end], 0 ) - begin ) * sizeof( float ) );
    }
}

void strands_predict( wisp_frame* frame, const wisp_span* span, void* user )
{
    wisp_strand_motion_args args;
    begin_tension( frame, span, user );
    if ( motion_args_between( frame, span, user, true, &args ) )
    {
        wisp_frame_kernels( frame )->strand_predict( &args, span->begin, span->end );
    }
}

void strands_count_first_order( wisp_frame* frame, int strands )
{
    if ( strands > 0 )
    {
        wisp_frame_count( frame, WISP_COUNT_FIRST_ORDER, (uint64_t)strands );
    }
}

// Count strands of exact lengths that end a step with a segment too long, because contact had the last word.
static void count_pulled( wisp_frame* frame, const wisp_span* span, const strands_state* state )
{
    if ( wisp_frame_has( frame, span->entity, state->direct ) == false || takes_turns( frame, span ) == false ||
         span->substep + 1 < wisp_frame_substeps( frame, span->entity ) )
    {
        return;
    }
    const int32_t* group_row = rows_of_group( frame, span );
    const float *position = column_of( frame, span, WISP_STRAND_POSITION, 0 ),
                *length = column_of( frame, span, WISP_STRAND_LENGTH, 0 );
    uint64_t count = 0;
    for ( int g = span->begin; g < span->end; ++g )
    {
        float longest[WISP_LANES] = { 0 }; // square of length over length at rest
        for ( int row = group_row[g]; row + 1 < group_row[g + 1]; ++row )
        {
            const float *a = position + strands_vector( row, 0 ), *b = position + strands_vector( row + 1, 0 );
            for ( int l = 0; l < WISP_LANES; ++l )
            {
                const float x = b[l] - a[l], y = b[WISP_LANES + l] - a[WISP_LANES + l],
                            z = b[2 * WISP_LANES + l] - a[2 * WISP_LANES + l],
                            rest = length[strands_scalar( row, l )];
                const float ratio = rest > 0.0f ? ( x * x + y * y + z * z ) / ( rest * rest ) : 0.0f;
                longest[l] = ratio > longest[l] ? ratio : longest[l];
            }
        }
        for ( int l = 0; l < WISP_LANES; ++l )
        {
            count += longest[l] > ( 1.0f + MAX_STRETCH ) * ( 1.0f + MAX_STRETCH ) ? 1 : 0;
        }
    }
    if ( count > 0 )
    {
        wisp_frame_count( frame, WISP_COUNT_STRETCHED, count );
    }
}

void strands_read_velocity( wisp_frame* frame, const wisp_span* span, void* user )
{
    wisp_strand_motion_args args;
    if ( motion_args_between( frame, span, user, false, &args ) )
    {
        strands_count_first_order( frame,
                                   wisp_frame_kernels( frame )->strand_velocity( &args, span->begin, span->end ) );
        count_pulled( frame, span, user );
    }
}

wisp_strand_rod_args strands_rod_args( wisp_frame* frame, const wisp_span* span, const strands_state* state,
                                       bool has_frames )
{
    const strands_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    wisp_strand_rod_args args = {
        .group_row = rows_of_group( frame, span ),
        .position = column_of( frame, span, WISP_STRAND_POSITION, 0 ),
        .low = column_of( frame, span, state->low, 0 ),
        .velocity = column_of( frame, span, WISP_STRAND_VELOCITY, 0 ),
        .inverse_mass = column_of( frame, span, WISP_STRAND_INVERSE_MASS, 0 ),
        .inverse_length = column_of( frame, span, state->rod, 0 ),
        .stiffness = column_of( frame, span, state->rod, 1 ),
        .factor = column_of( frame, span, state->rod, 2 ),
        .tension = column_of( frame, span, state->tension, 0 ),
        .max_tension = column_of( frame, span, state->rod, 3 ),
        .root = column_of( frame, span, WISP_STRAND_ROOT, 1 ),
        .clamp = column_of( frame, span, state->clamp, 0 ),
        .damping = settings->bend_damping,
        .acceleration = settings->gravity,
        .acceleration_scale = part_of_substep( frame, span, state ),
        .dt = wisp_frame_dt( frame, span->entity ),
        .history = history_of( frame, span, state ),
    };
    if ( args.history.step != NULL )
    {
        args.first_order_factor = column_of( frame, span, state->history, 3 );
    }
    if ( has_frames )
    {
        args.frame = column_of( frame, span, state->curve, 0 );
        args.rest = column_of( frame, span, state->curve, 1 );
        args.rest_twist = column_of( frame, span, state->curve, 2 );
        args.twist_stiffness = column_of( frame, span, state->curve, 3 );
    }
    if ( has_frames && wisp_frame_has( frame, span->entity, state->tip_rows ) )
    {
        args.tip = column_of( frame, span, state->tip_rows, 0 );
    }
    if ( has_frames && wisp_frame_has( frame, span->entity, state->section ) )
    {
        const strands_section* section = wisp_frame_column( frame, span->entity, state->section, 0 );
        args.flatness = section->flatness;
    }
    if ( has_frames && wisp_frame_has( frame, span->entity, state->response ) )
    {
        args.response = column_of( frame, span, state->response, 0 );
    }
    return args;
}

// Return the memory behind the scratch that every kernel has.
static float* behind_scratch( wisp_frame* frame, const wisp_span* span, float* scratch )
{
    const int32_t* group_row = rows_of_group( frame, span );
    return scratch + (size_t)( group_row[1] - group_row[0] ) * WISP_STRAND_SCRATCH;
}

static void bend( wisp_frame* frame, const wisp_span* span, const strands_state* state, bool has_frames )
{
    wisp_strand_rod_args args = strands_rod_args( frame, span, state, has_frames );
    rows_between rows;
    const bool is_flat = args.flatness > 0.0f || args.response != NULL;
    args.scratch =
        strands_scratch( frame, span, WISP_STRAND_SCRATCH + ( is_flat ? WISP_STRAND_SECTION_SCRATCH : 0 ) );
    args.section_scratch = is_flat && args.scratch != NULL ? behind_scratch( frame, span, args.scratch ) : NULL;
    if ( args.scratch != NULL && find_rows_between( frame, span, state, false, &rows ) )
    {
        args.previous = rows.previous;
        args.segment = rows.segment;
        wisp_frame_kernels( frame )->strand_rod( &args, span->begin, span->end );
    }
}

void strands_bend( wisp_frame* frame, const wisp_span* span, void* user )
{
    bend( frame, span, user, false );
}

void strands_begin_with_rest_tension( wisp_frame* frame, const wisp_span* span, const strands_state* state )
{
    const strands_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    if ( settings->rest == WISP_STRAND_REST_STRAIGHT )
    {
        return; // as a straight rod without frames
    }
    const int32_t* group_row = rows_of_group( frame, span );
    const size_t begin = strands_scalar( group_row[span->begin], 0 ), end = strands_scalar( group_row[span->end], 0 );
    memcpy( column_of( frame, span, state->tension, 0 ) + begin, column_of( frame, span, state->curve, 4 ) + begin,
            ( end - begin ) * sizeof( float ) );
}

void strands_bend_curved( wisp_frame* frame, const wisp_span* span, void* user )
{
    strands_begin_with_rest_tension( frame, span, user );
    bend( frame, span, user, true );
}

// ---- lengths ----

// Multipliers accumulate over the iterations; with a single iteration they start at 0 and are not stored.
static wisp_strand_link_args link_args( wisp_frame* frame, const wisp_span* span, const strands_state* state,
                                        const strands_link* link, wisp_component rows, int stride )
{
    const float dt = wisp_frame_dt( frame, span->entity );
    const bool keeps = link->xpbd != 0 && wisp_frame_iterations( frame ) > 1;
    return ( wisp_strand_link_args ){
        .group_row = rows_of_group( frame, span ),
        .position = column_of( frame, span, WISP_STRAND_POSITION, 0 ),
        .low = column_of( frame, span, state->low, 0 ),
        .velocity = column_of( frame, span, WISP_STRAND_VELOCITY, 0 ),
        .inverse_mass = column_of( frame, span, WISP_STRAND_INVERSE_MASS, 0 ),
        .rest = column_of( frame, span, rows, 0 ),
        .lambda = keeps ? column_of( frame, span, rows, 1 ) : NULL,
        .stride = stride,
        .stiffness = link->stiffness,
        .compliance = link->compliance,
        .inverse_dt2 = link->xpbd != 0 ? 1.0f / ( dt * dt ) : 0.0f,
        .dt = dt,
        .history = history_of( frame, span, state ),
    };
}

wisp_strand_link_args strands_bend_link_args( wisp_frame* frame, const wisp_span* span, const strands_state* state )
{
    return link_args( frame, span, state, wisp_frame_column( frame, span->entity, state->bend_links, 0 ),
                      state->bend_link, 2 );
}

// @return false without memory
static bool project_links( wisp_frame* frame, const wisp_span* span, const strands_state* state,
                           wisp_strand_link_args* args )
{
    rows_between rows;
    if ( find_rows_between( frame, span, state, false, &rows ) == false )
    {
        return false;
    }
    args->previous = rows.previous;
    args->segment = rows.segment;
    if ( args->lambda != NULL && span->iteration == 0 )
    {
        const size_t begin = strands_scalar( args->group_row[span->begin], 0 );
        const size_t end = strands_scalar( args->group_row[span->end], 0 );
        memset( args->lambda + begin, 0, ( end - begin ) * sizeof( float ) );
    }
    wisp_frame_kernels( frame )->strand_link( args, span->begin, span->end );
    return true;
}

// Links that are inextensible by definition, but not by so few sweeps: masses that grow along a strand need about as many
// sweeps as their ratio.
static void count_stretched( wisp_frame* frame, const wisp_span* span, const strands_link* link,
                             const wisp_strand_link_args* args )
{
    const bool is_last = span->substep + 1 == wisp_frame_substeps( frame, span->entity ) &&
                         span->iteration + 1 == wisp_frame_iterations( frame );
    const bool is_inextensible = link->xpbd != 0 ? link->compliance <= 0.0f : link->stiffness >= 1.0f;
    if ( is_last && is_inextensible )
    {
        const int count =
            wisp_frame_kernels( frame )->strand_count_stretched( args, MAX_STRETCH, span->begin, span->end );
        if ( count > 0 )
        {
            wisp_frame_count( frame, WISP_COUNT_STRETCHED, (uint64_t)count );
        }
    }
}

// Links are as stiff as their sweeps are many, so turns with bodies, which would add some where a body is, make none; turns with
// contact restore lengths alone.
void strands_link_rows( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    if ( span->iteration > wisp_frame_iterations( frame ) )
    {
        return;
    }
    const strands_link* link = wisp_frame_column( frame, span->entity, state->links, 0 );
    wisp_strand_link_args args = link_args( frame, span, state, link, state->stretch_link, 1 );
    if ( project_links( frame, span, state, &args ) )
    {
        count_stretched( frame, span, link, &args );
    }
}

void strands_bend_link( wisp_frame* frame, const wisp_span* span, void* user )
{
    if ( span->iteration < wisp_frame_iterations( frame ) )
    {
        wisp_strand_link_args args = strands_bend_link_args( frame, span, user );
        (void)project_links( frame, span, user, &args );
    }
}

// Return where to store tensions. They are read after the last substep; after others only by rods.
static float* tension_column( wisp_frame* frame, const wisp_span* span, const strands_state* state, bool has_rod )
{
    const bool is_read = has_rod || span->substep + 1 == wisp_frame_substeps( frame, span->entity );
    return is_read ? column_of( frame, span, state->tension, 0 ) : NULL;
}

// A rod has applied tension already, so the solve adds to it.
wisp_strand_stretch_args strands_stretch_args( wisp_frame* frame, const wisp_span* span, const strands_state* state )
{
    const strands_direct* direct = wisp_frame_column( frame, span->entity, state->direct, 0 );
    const strands_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    return ( wisp_strand_stretch_args ){
        .group_row = rows_of_group( frame, span ),
        .position = column_of( frame, span, WISP_STRAND_POSITION, 0 ),
        .low = column_of( frame, span, state->low, 0 ),
        .velocity = column_of( frame, span, WISP_STRAND_VELOCITY, 0 ),
        .inverse_mass = column_of( frame, span, WISP_STRAND_INVERSE_MASS, 0 ),
        .length = column_of( frame, span, WISP_STRAND_LENGTH, 0 ),
        .tension = tension_column( frame, span, state, direct->has_rod != 0 ),
        .accumulates_tension = direct->has_rod != 0 || takes_turns( frame, span ) || span->iteration > 0,
        .iterations = direct->passes,
        .tolerance = direct->tolerance,
        .dt = wisp_frame_dt( frame, span->entity ),
        .scratch = strands_scratch( frame, span, WISP_STRAND_SCRATCH ),
        .acceleration = direct->has_rod != 0 ? ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } : settings->gravity,
        .history = history_of( frame, span, state ),
        .is_held = wisp_frame_has( frame, span->entity, state->tips ),
        .is_closed = wisp_frame_has( frame, span->entity, state->closed ),
    };
}

void strands_count_reset( wisp_frame* frame, int laid )
{
    if ( laid > 0 )
    {
        wisp_frame_count( frame, WISP_COUNT_STRAND_RESET, (uint64_t)laid );
    }
}

void strands_stretch( wisp_frame* frame, const wisp_span* span, void* user )
{
    wisp_strand_stretch_args args = strands_stretch_args( frame, span, user );
    rows_between rows;
    if ( args.scratch != NULL && find_rows_between( frame, span, user, false, &rows ) )
    {
        args.previous = rows.previous;
        args.segment = rows.segment;
        args.speed = rows.speed;
        strands_count_reset( frame, wisp_frame_kernels( frame )->strand_stretch( &args, span->begin, span->end ) );
    }
}
