// Statistics: depth and contacts of a participant at the end of a step. In: positions, bodies. Out:
// wisp_collision_stats. Depths are measured again from the positions, so they include what the contacts missed.
// Each worker measures blocks of its own; of equally deep vertices the lowest index counts, so that results do not
// depend on the workers.
#include "body_queries.h"
#include "near_bodies.h"
#include "particle_contacts.h"

#include <math.h>

enum
{
    GROUPS = 4, // of strands per task
};

static const wisp_collision_stats NOTHING = { .vertex = -1 };

typedef struct measure_loop
{
    wisp_frame* frame;
    const wisp_span* span;
    const collision_state* state;
    bool is_posed; // strands without dynamics
    wisp_collision_stats stats[WISP_MAX_WORKERS];
} measure_loop;

static void add_depth( wisp_collision_stats* f, float depth, float thickness, int vertex )
{
    if ( depth > f->penetration || ( depth == f->penetration && depth > 0.0f && vertex < f->vertex ) )
    {
        f->penetration = depth;
        f->thickness = thickness;
        f->vertex = vertex;
    }
}

typedef struct measure_batch
{
    int vertices[COLLISION_CHUNK];  // in the user's order
    float thinner[COLLISION_CHUNK]; // m, than the participant
    wisp_mesh_query queries[COLLISION_CHUNK];
    wisp_surface_point nearest[COLLISION_CHUNK];
    bool is_near[COLLISION_CHUNK];
    int count;
} measure_batch;

static void add_vertex( measure_batch* batch, const collision_view* view, float slack, int vertex, float thinner,
                        wisp_vec3 p )
{
    batch->vertices[batch->count] = vertex;
    batch->thinner[batch->count] = thinner;
    batch->queries[batch->count++] = ( wisp_mesh_query ){ .point = wisp_transform_to_local( view->after, p ),
                                                          .radius = view->thickness + slack,
                                                          .time = view->end };
}

// @param slack m, within which beyond its thickness a vertex touches @param touches [vertex of the batch] or null
static void measure_batch_of( measure_batch* batch, const collision_view* view, float slack, bool is_solved,
                              bool* touches, wisp_collision_stats* f )
{
    collision_closest( view, batch->queries, batch->count, batch->nearest, batch->is_near, NULL );
    for ( int i = 0; i < batch->count; ++i )
    {
        const float thickness = view->thickness - batch->thinner[i],
                    distance = batch->is_near[i] ? batch->nearest[i].distance : INFINITY;
        add_depth( f, is_solved ? -distance : thickness - distance, thickness, batch->vertices[i] );
        if ( touches != NULL )
        {
            touches[i] = touches[i] || distance < thickness + slack;
        }
    }
    batch->count = 0;
}

// ---- surfaces ----

static void count_contacts( const measure_loop* loop, int begin, int end, wisp_collision_stats* f )
{
    const int32_t* count = wisp_frame_column( loop->frame, loop->span->entity, WISP_PARTICLE_HALF_SPACES, 0 );
    collision_contact( *contact )[WISP_COLLISION_CONTACTS] =
        wisp_frame_column( loop->frame, loop->span->entity, WISP_PARTICLE_HALF_SPACES, 2 );
    for ( int slot = begin; slot < end; ++slot )
    {
        int used = count[slot] < WISP_COLLISION_CONTACTS ? count[slot] : WISP_COLLISION_CONTACTS;
        bool pressed = false;
        for ( int i = 0; i < used; ++i )
        {
            pressed = pressed || contact[slot][i].normal_correction > 0.0f;
        }
        f->contacts += pressed ? 1 : 0;
        f->dropped += count[slot] - used;
    }
}

// A box of nothing yet: bodies that cannot touch one of some points are not asked.
static const wisp_vec3 NOWHERE[2] = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };

static void add_free_slots( measure_batch* batch, const collision_view* view, const collision_maps* maps, float slack,
                            const wisp_fabric* fabric, const float* position, int begin, int end )
{
    for ( int slot = begin; slot < end; ++slot )
    {
        const float* quad = position + (size_t)slot * 4;
        if ( quad[3] > 0.0f )
        {
            add_vertex( batch, view, slack, fabric->slot_vertex[slot], collision_thinner( maps, slot ),
                        wisp_v3_load( quad ) );
        }
    }
}

// An external solver holds vertices within the thickness, so only what is behind the surface itself is depth.
static void measure_slots( void* context, int begin, int end, int worker )
{
    static const float TOUCH_SLACK = 1e-3f; // of the thickness: vertices are held at it
    measure_loop* loop = context;
    const wisp_entity e = loop->span->entity;
    const wisp_fabric* fabric = wisp_frame_fabric( loop->frame, e );
    const float* position = wisp_frame_column( loop->frame, e, WISP_PARTICLE_POSITION, 0 );
    const bool is_solved = wisp_frame_has( loop->frame, e, WISP_PARTICLE_EXTERNAL_SOLVER ),
               is_stored = wisp_frame_has( loop->frame, e, WISP_PARTICLE_HALF_SPACES );
    bool touches[COLLISION_CHUNK] = { false }; // [free vertex of the chunk]
    const collision_maps maps = collision_maps_of( loop->frame, e, loop->state );
    measure_batch batch;
    batch.count = 0;
    collision_view view;
    wisp_vec3 lower = NOWHERE[0], upper = NOWHERE[1];
    for ( int slot = begin; slot < end; ++slot )
    {
        const float* quad = position + (size_t)slot * 4;
        if ( quad[3] > 0.0f )
        {
            collision_widen( &lower, &upper, wisp_v3_load( quad ) );
        }
    }
    for ( collision_walk walk = collision_begin_walk( loop->state, e, lower, upper );
          collision_walk_on( loop->frame, loop->span, loop->state, &walk, 0.0f, &view ); )
    {
        const float slack = is_solved || is_stored ? 0.0f : TOUCH_SLACK * view.thickness;
        add_free_slots( &batch, &view, &maps, slack, fabric, position, begin, end );
        measure_batch_of( &batch, &view, slack, is_solved, touches, loop->stats + worker );
    }
    if ( is_stored )
    {
        count_contacts( loop, begin, end, loop->stats + worker );
    }
    for ( int i = 0; i < COLLISION_CHUNK && is_stored == false; ++i )
    {
        loop->stats[worker].contacts += touches[i] ? 1 : 0;
    }
}

// ---- strands ----

typedef struct measure_rows
{
    const wisp_strand_topology* strands;
    const float *position, *weight, *pushed; // without dynamics only positions
    const uint32_t* moved;                   // without dynamics
} measure_rows;

// Return whether a vertex may move. Strands without dynamics have no masses; their roots stay.
static bool is_free( const measure_rows* rows, int group, int row, int lane )
{
    const int i = row - rows->strands->group_row[group];
    return rows->weight != NULL ? rows->weight[(size_t)row * WISP_LANES + (size_t)lane] > 0.0f
                                : i > 0 && i < rows->strands->lane_count[group * WISP_LANES + lane];
}

static void measure_row( const measure_rows* rows, const collision_view* view, int group, int row,
                         wisp_collision_stats* f )
{
    const int32_t* strand = rows->strands->lane_strand + (size_t)group * WISP_LANES;
    measure_batch batch;
    batch.count = 0;
    for ( int l = 0; l < WISP_LANES; ++l )
    {
        if ( is_free( rows, group, row, l ) )
        {
            const int vertex = rows->strands->offsets[strand[l]] + row - rows->strands->group_row[group];
            add_vertex( &batch, view, 0.0f, vertex, 0.0f,
                        collision_load_lane( rows->position + (size_t)row * 3 * WISP_LANES + l ) );
        }
    }
    measure_batch_of( &batch, view, 0.0f, false, NULL, f );
}

static int count_touched( const measure_rows* rows, int row )
{
    if ( rows->moved != NULL )
    {
        return __builtin_popcount( rows->moved[row] );
    }
    int count = 0;
    for ( int l = 0; l < WISP_LANES; ++l )
    {
        count += rows->pushed[(size_t)row * WISP_LANES + (size_t)l] > 0.0f ? 1 : 0;
    }
    return count;
}

static void measure_groups( void* context, int begin, int end, int worker )
{
    measure_loop* loop = context;
    const wisp_entity e = loop->span->entity;
    const measure_rows rows = {
        .strands = wisp_frame_strands( loop->frame, e ),
        .position = wisp_frame_column( loop->frame, e, WISP_STRAND_POSITION, 0 ),
        .weight = loop->is_posed ? NULL : wisp_frame_column( loop->frame, e, WISP_STRAND_INVERSE_MASS, 0 ),
        .pushed = loop->is_posed ? NULL : wisp_frame_column( loop->frame, e, loop->state->strand_contact, 0 ),
        .moved = loop->is_posed ? wisp_frame_column( loop->frame, e, loop->state->posed, 0 ) : NULL,
    };
    wisp_collision_stats* f = loop->stats + worker;
    const int32_t* group_row = rows.strands->group_row;
    for ( int group = begin; group < end; ++group )
    {
        collision_view view;
        wisp_vec3 lower = NOWHERE[0], upper = NOWHERE[1];
        for ( int i = group_row[group] * WISP_LANES; i < group_row[group + 1] * WISP_LANES; ++i )
        {
            const int row = i / WISP_LANES, lane = i % WISP_LANES;
            if ( is_free( &rows, group, row, lane ) )
            {
                collision_widen( &lower, &upper, collision_load_lane( rows.position + row * COLLISION_ROW + lane ) );
            }
        }
        for ( collision_walk walk = collision_begin_walk( loop->state, e, lower, upper );
              collision_walk_on( loop->frame, loop->span, loop->state, &walk, 0.0f, &view ); )
        {
            for ( int row = group_row[group]; row < group_row[group + 1]; ++row )
            {
                measure_row( &rows, &view, group, row, f );
            }
        }
        for ( int row = group_row[group]; row < group_row[group + 1]; ++row )
        {
            f->contacts += count_touched( &rows, row );
        }
    }
}

// ---- the passes ----

static void measure_particles( measure_loop loop, int count, int grain, wisp_range_fn* run )
{
    wisp_frame* frame = loop.frame;
    const wisp_span* span = loop.span;
    for ( int w = 0; w < WISP_MAX_WORKERS; ++w )
    {
        loop.stats[w] = NOTHING;
    }
    wisp_parallel_for( wisp_frame_parallel( frame, span ), count, grain, run, &loop );
    wisp_collision_stats* all = wisp_frame_column( frame, span->entity, loop.state->stats, 0 );
    *all = NOTHING;
    for ( int w = 0; w < WISP_MAX_WORKERS; ++w )
    {
        const wisp_collision_stats* f = loop.stats + w;
        add_depth( all, f->penetration, f->thickness, f->vertex );
        all->contacts += f->contacts;
        all->dropped += f->dropped;
    }
}

void collision_measure( wisp_frame* frame, const wisp_span* span, void* user )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    measure_particles( ( measure_loop ){ .frame = frame, .span = span, .state = user }, fabric->vertex_count,
                       COLLISION_CHUNK, measure_slots );
}

void collision_measure_strands( wisp_frame* frame, const wisp_span* span, void* user )
{
    const wisp_strand_topology* strands = wisp_frame_strands( frame, span->entity );
    measure_particles( ( measure_loop ){ .frame = frame, .span = span, .state = user }, strands->group_count, GROUPS,
                       measure_groups );
}

void collision_measure_posed( wisp_frame* frame, const wisp_span* span, void* user )
{
    const wisp_strand_topology* strands = wisp_frame_strands( frame, span->entity );
    measure_particles( ( measure_loop ){ .frame = frame, .span = span, .state = user, .is_posed = true },
                       strands->group_count, GROUPS, measure_groups );
}

// ---- reading ----

static wisp_status find_settings( wisp_world* world, wisp_entity participant, collision_state** state,
                                  collision_settings** out )
{
    WISP_FIND_STATE( collision_state, found, world, "collision", &participant, 0 );
    *state = found;
    *out = wisp_world_column( world, participant, found->settings, 0 );
    return *out != NULL ? WISP_OK
                        : wisp_world_fail( world, WISP_CONFLICT, "entity %u has no collision", participant.index );
}

wisp_status wisp_request_collision_stats( wisp_world* world, wisp_entity participant, bool requested )
{
    collision_state* state;
    collision_settings* settings;
    WISP_TRY( find_settings( world, participant, &state, &settings ) );
    int32_t before = settings->stats;
    settings->stats = requested ? 1 : 0;
    wisp_status status = collision_update_participant( world, state, participant );
    if ( status != WISP_OK )
    {
        settings->stats = before;
    }
    return status;
}

wisp_status wisp_read_collision_stats( wisp_world* world, wisp_entity participant, wisp_collision_stats* out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    *out = NOTHING;
    collision_state* state;
    collision_settings* settings;
    wisp_status status = find_settings( world, participant, &state, &settings );
    if ( status == WISP_OK && settings->stats == 0 )
    {
        status = wisp_world_fail(
            world, WISP_CONFLICT,
            "collision: statistics of entity %u were not requested with wisp_request_collision_stats",
            participant.index );
    }
    const wisp_collision_stats* column =
        status == WISP_OK ? wisp_world_column( world, participant, state->stats, 0 ) : NULL;
    if ( column != NULL && column->thickness > 0.0f )
    {
        *out = *column;
    }
    else if ( column != NULL )
    {
        *out = ( wisp_collision_stats ){ .vertex = -1, .contacts = column->contacts, .dropped = column->dropped };
    }
    return status;
}
