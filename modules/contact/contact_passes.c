// The passes of contact: the order of the stages in a substep.
//
//   contact.reach    mark who has nothing within reach
//   contact.find     gather; predict displacements; mark intersections after a reset; broad phase when the lists do
//                    not hold; narrow phase; constraints; colouring
//   contact.push     gather; project, in turns with lengths of strands; in the last iteration recover, untangle, limit displacements; scatter
//   contact.limit_strands  where strands take part: limit displacements once more, after lengths are restored
// With spheres, contact.find searches once per step, contact.push projects and recovers, and nothing is limited or stored.
//
//   contact.keep     store the intersection-free positions of a participant
//   contact.stats  statistics, on request
#include "contact_state.h"

#include "constraints.h"
#include "gather_scatter.h"
#include "narrow_phase.h"
#include "solve.h"
#include "spheres.h"
#include "untangling.h"

#include "wisp/module/sleep.h"

#include <math.h>
#include <string.h>

// ---- statistics of a step ----

// Add the impulse of a row.
static void add_row( const contact_work* work, const contact_row* row, double* sum )
{
    double impulse[3], squared = 0.0;
    contact_participant *a = contact_participant_of( work, row->point[0] ),
                        *b = contact_participant_of( work, row->point[CONTACT_MAX_POINTS - 1] );
    for ( int k = 0; k < 3; ++k )
    {
        impulse[k] = ( (double)row->normal_impulse * (double)row->normal[k] + (double)row->tangential_impulse[k] ) /
                     (double)work->seconds;
        squared += impulse[k] * impulse[k];
        a->impulse[k] += impulse[k];
        b->impulse[k] -= impulse[k];
    }
    *sum += sqrt( squared );
}

static void sum_impulses_of_rows( const contact_work* work )
{
    const contact_contact_mesh* s = work->contact_mesh;
    wisp_contact_stats* f = &work->memory->stats;
    f->contacts = 0;
    for ( int r = 0; r < s->constraints->row_count; ++r )
    {
        if ( s->constraints->rows[r].normal_impulse > 0.0f )
        {
            add_row( work, s->constraints->rows + r, &f->impulse );
            f->contacts += 1;
        }
    }
}

static float distance_now( const contact_work* work, const contact_row* row )
{
    const contact_contact_mesh* s = work->contact_mesh;
    contact_primitives primitives;
    primitives.are_edges = row->split == 2;
    contact_put_primitives( &primitives, 0, row->point );
    return contact_measure_primitives( work, s->now, &primitives, 1, NULL, NULL )[0];
}

// Return the smallest distance at the end, in gaps, over the rows of the last substep: all other pairs are farther
// than their gap.
static float min_gap( const contact_work* work )
{
    const contact_contact_mesh* s = work->contact_mesh;
    float least = INFINITY;
    for ( int r = 0; r < s->constraints->row_count; ++r )
    {
        least = contact_smaller( least,
                                 distance_now( work, s->constraints->rows + r ) / s->constraints->rows[r].requested );
    }
    return least;
}

static void count_intersections( const contact_work* work )
{
    wisp_error error = { 0 };
    const wisp_status status = contact_find_intersections( work, work->contact_mesh->now, &error );
    if ( status != WISP_OK )
    {
        wisp_frame_fail( work->frame, status, "%s", error.message );
    }
    const wisp_intersections* found = &work->contact_mesh->intersections->intersections;
    work->memory->stats.intersections = 0;
    for ( int i = 0; i < found->count && status == WISP_OK; ++i )
    {
        work->memory->stats.intersections += contact_is_movable( work->contact_mesh, found->list + i );
    }
}

static void fill_stats( const contact_work* work, bool counts_intersections )
{
    const contact_contact_mesh* s = work->contact_mesh;
    wisp_contact_stats* f = &work->memory->stats;
    if ( counts_intersections )
    {
        count_intersections( work );
    }
    f->participants = work->participant_count;
    const bool are_spheres = work->settings->level == WISP_CONTACT_SPHERES;
    f->points = are_spheres ? s->spheres->count : s->point_count;
    f->edges = s->edge_count;
    f->triangles = s->triangle_count;
    f->min_gap = are_spheres ? contact_least_sphere_gap( work ) : min_gap( work );
    memset( f->net_impulse, 0, sizeof( f->net_impulse ) );
    for ( int g = 0; g < work->participant_count; ++g )
    {
        for ( int k = 0; k < 3; ++k )
        {
            f->net_impulse[k] += work->participants[g].impulse[k];
        }
    }
}

// ---- what the passes share ----

enum
{
    LENGTH_TURNS = 12, // of pushes and lengths of strands in a substep, at most
    USUAL_TURNS = 4,   // behind these a turn has to lessen the push
    WIDE_TURNS = 1,    // lengths move strands farthest in the first turn; behind these only near rows are projected
};

// What is left of the farthest push in a turn that leads somewhere. Where strands are pressed, pushes and lengths do the same turn for turn.
static const float LESS = 0.95f;

static contact_work begin_work( wisp_frame* frame, const wisp_span* span, contact_state* state )
{
    return ( contact_work ){
        .contact_mesh = &state->contact_mesh,
        .memory = wisp_frame_column( frame, span->entity, state->active, 0 ),
        .participants = state->participants,
        .participant_count = state->participant_count,
        .settings = &state->world,
        .components = &state->components,
        .parallel = wisp_frame_parallel( frame, span ),
        .frame = frame,
        .seconds = wisp_frame_dt( frame, span->entity ),
        .worker = span->worker,
        .substeps_left = wisp_frame_substeps( frame, span->entity ) - span->substep,
        .counts_intersections = state->counts_intersections,
        .counts_impulses = state->requests_stats,
    };
}

// Nothing moves while all participants sleep.
static bool all_sleep( wisp_frame* frame, const contact_state* state )
{
    bool sleep = true;
    for ( int g = 0; g < state->participant_count && sleep; ++g )
    {
        sleep = wisp_frame_is_asleep( frame, state->participants[g].entity );
    }
    return sleep;
}

// ---- stages that can fail ----

typedef wisp_status stage_fn( const contact_work* work, wisp_error* error );

// Run a stage. After a failure the lists are incomplete, so the next step searches again.
static bool run_stage( const contact_work* work, stage_fn* stage )
{
    wisp_error error = { 0 };
    const wisp_status status = stage( work, &error );
    if ( status != WISP_OK )
    {
        work->contact_mesh->is_listed = false;
        wisp_frame_fail( work->frame, status, "%s", error.message );
    }
    return status == WISP_OK;
}

static wisp_status build_mesh( const contact_work* work, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    s->constraints->row_count = s->constraints->missed_row_count = 0;
    s->untangling->has_faces = false;
    bool enough = contact_build_contact_mesh( work ) && contact_reserve_intersections( work );
    if ( work->settings->level != WISP_CONTACT_SPHERES )
    {
        enough = enough && contact_make_clusters( work ) && contact_reserve_motion( work ) &&
                 contact_reserve_colouring( work ) && contact_reserve_limit( work );
    }
    if ( enough == false )
    {
        s->point_count = s->edge_count = s->triangle_count = 0;
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for the points of %d entities in contact",
                          work->participant_count );
    }
    return WISP_OK;
}

// ---- contact.find ----

static void begin_step( const contact_work* work )
{
    work->memory->stats = ( wisp_contact_stats ){ .intersections = -1 };
    work->contact_mesh->broad_phase->searches = 0;
    work->contact_mesh->limit->tests = 0;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        memset( work->participants[g].impulse, 0, sizeof( work->participants[g].impulse ) );
    }
}

// Before intersections are marked: whether what touches in one plane intersects is a matter of rounding. Lists hold unless something moves.
static bool part_coincident( const contact_work* work )
{
    work->memory->tangled = 0;
    work->contact_mesh->is_parting = true;
    const bool found = run_stage( work, contact_mark_intersections ) && run_stage( work, contact_search ) &&
                       run_stage( work, contact_find_rows );
    work->contact_mesh->is_parting = false;
    work->memory->tangled = 1;
    work->contact_mesh->is_listed = found && contact_part_coincident( work ) == false;
    return found;
}

void contact_reach( wisp_frame* frame, const wisp_span* span, void* user )
{
    contact_state* state = user;
    if ( all_sleep( frame, state ) == false )
    {
        const contact_work work = begin_work( frame, span, state );
        state->changed = contact_mark_far( &work, span->substep == 0 || state->changed ) || state->changed;
    }
}

bool contact_join( wisp_frame* frame, wisp_entity entity, void* user )
{
    (void)entity;
    const contact_state* state = user;
    for ( int g = 0; g < state->participant_count; ++g )
    {
        if ( state->participants[g].joins )
        {
            wisp_frame_join( frame, state->participants[g].entity );
        }
    }
    return true;
}

// List spheres at the start of a step, or after a change, and find what is near in this substep.
static void find_spheres( const contact_work* work, bool is_start )
{
    contact_contact_mesh* s = work->contact_mesh;
    work->memory->tangled = 0;
    if ( is_start || s->is_listed == false )
    {
        s->is_listed = run_stage( work, contact_make_spheres ) && run_stage( work, contact_list_spheres );
    }
    const bool holds = s->is_listed && run_stage( work, contact_begin_spheres );
    work->memory->stats.outran += holds ? s->spheres->strayed : 0;
}

void contact_find( wisp_frame* frame, const wisp_span* span, void* user )
{
    contact_state* state = user;
    if ( all_sleep( frame, state ) )
    {
        return;
    }
    const contact_work work = begin_work( frame, span, state );
    contact_contact_mesh* s = work.contact_mesh;
    if ( span->substep == 0 )
    {
        begin_step( &work );
    }
    if ( state->changed && run_stage( &work, build_mesh ) == false )
    {
        return;
    }
    state->changed = false;
    if ( s->point_count == 0 ) // nobody has anything within reach
    {
        return;
    }
    contact_gather( &work, true );
    if ( work.settings->level == WISP_CONTACT_SPHERES )
    {
        find_spheres( &work, span->substep == 0 );
        return;
    }
    contact_reached reached = contact_expect_ways( &work );
    if ( s->is_reset )
    {
        s->is_listed = false;
        if ( part_coincident( &work ) == false )
        {
            return;
        }
        reached = CONTACT_WITHIN;
        s->is_reset = false;
    }
    // intersections change from substep to substep
    if ( ( s->is_listed == false || work.memory->tangled != 0 ) &&
         run_stage( &work, contact_mark_intersections ) == false )
    {
        return;
    }
    if ( ( s->is_listed && reached != CONTACT_BEYOND ) || run_stage( &work, contact_search ) )
    {
        (void)( run_stage( &work, contact_find_rows ) && run_stage( &work, contact_colour_rows ) );
    }
}

// ---- contact.push ----

// Limit displacements. Points that left their tolerance may lack constraints: those are found first, from where the
// points went. Points that are cut leave their tolerance again, so this repeats until none does.
static void limit_displacements( const contact_work* work )
{
    enum
    {
        MAX_ROUNDS = 8, // two were the most in any test
    };
    contact_begin_limit( work );
    work->memory->stats.displacement_limited += contact_stay_in_reach( work );
    contact_reached reached = contact_measure_ways( work );
    for ( int round = 0; round < MAX_ROUNDS; ++round )
    {
        const bool is_unbounded = work->contact_mesh->motion->reach == INFINITY;
        const bool is_searched = reached != CONTACT_BEYOND || run_stage( work, contact_search );
        if ( is_searched == false ||
             ( reached != CONTACT_WITHIN && run_stage( work, contact_find_missed_rows ) == false ) )
        {
            return;
        }
        int cut = is_unbounded ? contact_stay_in_reach( work ) : 0; // there were too many missed pairs
        cut += contact_limit_displacements( work );
        work->memory->stats.displacement_limited += cut;
        reached = cut > 0 ? contact_measure_ways( work ) : CONTACT_WITHIN;
        if ( reached == CONTACT_WITHIN )
        {
            return;
        }
    }
    contact_hold( work );
}

static void end_substep( const contact_work* work )
{
    contact_keep_impulses( work );
    contact_recover( work );
    contact_untangle( work );
    if ( work->counts_impulses )
    {
        sum_impulses_of_rows( work );
    }
}

// Limit what points do in a substep, if they are limited.
static void end_ways( const contact_work* work, bool is_final )
{
    if ( work->settings->level == WISP_CONTACT_EXACT )
    {
        limit_displacements( work );
    }
    else
    {
        contact_measure_ways( work );
    }
    if ( is_final )
    {
        contact_add_deviation( work );
    }
}

// Project what presses: constraints, or spheres, which recover at the same time.
static void project( const contact_work* work, bool recovers, bool is_turn )
{
    if ( work->settings->level == WISP_CONTACT_SPHERES )
    {
        contact_push_spheres( work, recovers );
    }
    else
    {
        contact_project_rows( work, is_turn );
    }
}

void contact_project( wisp_frame* frame, const wisp_span* span, void* user )
{
    const contact_state* state = user;
    const contact_work work = begin_work( frame, span, user );
    if ( work.contact_mesh->is_listed == false || all_sleep( frame, state ) )
    {
        return; // the step has failed, or there is nothing to do
    }
    const bool is_end = span->iteration + 1 == wisp_frame_iterations( frame );
    const bool has_rows = state->world.level != WISP_CONTACT_SPHERES;
    contact_gather( &work, false );
    memset( work.contact_mesh->shift, 0, (size_t)work.contact_mesh->point_count * 4 * sizeof( float ) );
    if ( has_rows )
    {
        contact_begin_rows( &work, span->iteration == 0 );
    }
    project( &work, is_end, false );
    // what strands do is limited once more when their lengths are restored
    const bool is_final = has_rows && is_end && wisp_frame_has( frame, span->entity, state->touches ) == false;
    // before the last iteration the next one restores lengths
    float before = INFINITY, pushed = is_end ? contact_restore_lengths( &work, span ) : 0.0f;
    for ( int turn = 1; turn < LENGTH_TURNS && pushed > 0.0f && ( turn < USUAL_TURNS || pushed < LESS * before );
          ++turn )
    {
        project( &work, false, turn > WIDE_TURNS );
        before = pushed;
        pushed = contact_restore_lengths( &work, span );
    }
    if ( is_end && has_rows )
    {
        end_substep( &work );
        end_ways( &work, is_final );
    }
    contact_scatter( &work, is_end, is_final );
}

// ---- contact.limit_strands ----

// Surfaces have their velocities, and stay where they are.
static void hold_surfaces( const contact_work* work )
{
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        for ( int i = 0; i < participant->point_count && participant->is_strands == false; ++i )
        {
            work->contact_mesh->now[(size_t)( participant->first_point + i ) * 4 + 3] = 0.0f;
        }
    }
}

void contact_limit_strands( wisp_frame* frame, const wisp_span* span, void* user )
{
    const contact_state* state = user;
    const contact_work work = begin_work( frame, span, user );
    if ( work.contact_mesh->is_listed == false || all_sleep( frame, state ) ||
         state->world.level == WISP_CONTACT_SPHERES )
    {
        return; // the step has failed, or there is nothing to do
    }
    contact_gather( &work, false );
    memset( work.contact_mesh->shift, 0, (size_t)work.contact_mesh->point_count * 4 * sizeof( float ) );
    hold_surfaces( &work );
    end_ways( &work, true );
    contact_scatter( &work, true, true );
}

// ---- contact.keep, contact.stats ----

void contact_keep( wisp_frame* frame, const wisp_span* span, void* user )
{
    contact_state* state = user;
    const contact_work work = { .contact_mesh = &state->contact_mesh,
                                .components = &state->components,
                                .frame = frame };
    if ( state->contact_mesh.is_listed && state->world.level != WISP_CONTACT_SPHERES )
    {
        contact_keep_participant( &work, state->participants + contact_find_participant( state, span->entity ) );
    }
}

void contact_measure( wisp_frame* frame, const wisp_span* span, void* user )
{
    const contact_state* state = user;
    const contact_work work = begin_work( frame, span, user );
    if ( work.contact_mesh->is_listed == false && work.contact_mesh->point_count > 0 )
    {
        return; // the step has failed
    }
    contact_gather( &work, false );
    fill_stats( &work, state->counts_intersections );
    *(wisp_contact_stats*)wisp_frame_column( frame, span->entity, state->stats, 0 ) = work.memory->stats;
}
