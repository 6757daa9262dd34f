// How long an entity has been still: the largest displacement of a vertex over a step. In: positions at the end of the step, and at
// the end of the one before. Out: the displacement and the time for which it was short enough. Whether the entity falls asleep is
// decided when all passes have run, see world_sleep.c.
#include "passes.h"

#include "wisp/module/components.h"

#include <stdatomic.h>
#include <string.h>

static const wisp_column_def STATE_COLUMNS[] = { { "state", sizeof( passes_sleep ) } };
static const wisp_column_def PARTICLE_COLUMNS[] = { { "before", 4 * sizeof( float ) } };
static const wisp_column_def STRAND_COLUMNS[] = { { "before", 3 * WISP_LANES * sizeof( float ) } };
static const wisp_column_def MOVED_COLUMNS[] = { { "moved", sizeof( float ) } };

_Static_assert( sizeof( passes_sleep ) == 56, "without padding" );

typedef struct measure_loop
{
    const float* now;
    float* before;
    int row, coordinate, vertices; // floats from row to row, and from x to y; vertices of a row
    _Atomic uint32_t most;         // m^2, bits of the largest square: those of numbers >= 0 are in their order
} measure_loop;

static float row_motion( const measure_loop* loop, size_t first )
{
    float most = 0.0f;
    for ( int i = 0; i < loop->vertices; ++i )
    {
        const float *a = loop->now + first + i, *b = loop->before + first + i;
        const size_t y = (size_t)loop->coordinate, z = 2 * y;
        const float d[3] = { a[0] - b[0], a[y] - b[y], a[z] - b[z] };
        const float square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        most = square > most ? square : most; // what is not finite was halted before (constraints.c)
    }
    return most;
}

static void measure_rows( void* context, int begin, int end, int worker )
{
    (void)worker;
    measure_loop* loop = context;
    float most = 0.0f;
    for ( int r = begin; r < end; ++r )
    {
        const float square = row_motion( loop, (size_t)r * (size_t)loop->row );
        most = square > most ? square : most;
    }
    const size_t first = (size_t)begin * (size_t)loop->row, count = (size_t)( end - begin ) * (size_t)loop->row;
    memcpy( loop->before + first, loop->now + first, count * sizeof( float ) );
    uint32_t bits, largest = atomic_load_explicit( &loop->most, memory_order_relaxed );
    memcpy( &bits, &most, sizeof( bits ) );
    while ( bits > largest && atomic_compare_exchange_weak( &loop->most, &largest, bits ) == false )
    {
    }
}

static void measure_motion( wisp_frame* frame, const wisp_span* span, void* user )
{
    enum
    {
        GRAIN = 2048 / WISP_LANES, // rows of lanes
    };
    const passes_sleep_components* c = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const wisp_component position = t != NULL ? WISP_STRAND_POSITION : WISP_PARTICLE_POSITION;
    measure_loop loop = {
        .now = wisp_frame_column( frame, span->entity, position, 0 ),
        .before = wisp_frame_column( frame, span->entity, t != NULL ? c->strands : c->particles, 0 ),
        .row = t != NULL ? 3 * WISP_LANES : 4,
        .coordinate = t != NULL ? WISP_LANES : 1,
        .vertices = t != NULL ? WISP_LANES : 1,
    };
    atomic_init( &loop.most, 0u );
    const int rows = t != NULL ? t->row_count : wisp_frame_fabric( frame, span->entity )->slot_count;
    wisp_parallel_for( wisp_frame_parallel( frame, span ), rows, t != NULL ? GRAIN : GRAIN * WISP_LANES, measure_rows,
                       &loop );
    const uint32_t bits = atomic_load( &loop.most );
    float square;
    memcpy( &square, &bits, sizeof( square ) );
    passes_sleep* state = wisp_frame_column( frame, span->entity, c->state, 0 );
    const float seconds = wisp_frame_dt( frame, span->entity ) * (float)wisp_frame_substeps( frame, span->entity );
    const float moved = sqrtf( square );
    *(float*)wisp_frame_column( frame, span->entity, c->moved, 0 ) = moved;
    state->still = moved <= state->max_speed * seconds ? state->still + seconds : 0.0f;
}

wisp_status passes_declare_sleep( wisp_registry* registry, passes_sleep_components* out )
{
    out->state = WISP_COMPONENT( registry, "sleep.state", WISP_TABLE_ENTITY, STATE_COLUMNS );
    out->particles = WISP_COMPONENT( registry, "sleep.particles", WISP_TABLE_PARTICLE, PARTICLE_COLUMNS );
    out->strands = WISP_COMPONENT( registry, "sleep.strands", WISP_TABLE_STRAND_ROW, STRAND_COLUMNS );
    out->moved = WISP_COMPONENT( registry, "sleep.moved", WISP_TABLE_ENTITY, MOVED_COLUMNS );
    wisp_declare_places( registry, out->particles, 0, WISP_PLACE_QUADS );
    wisp_declare_places( registry, out->strands, 0, WISP_PLACE_LANES );
    const wisp_index_range phase = WISP_MEMBER_RANGE( out->state, passes_sleep, phase, 0, 2 * PASSES_TOUCHED - 1 );
    WISP_TRY( wisp_declare_indices( registry, &phase, 1 ) );
    const wisp_pass passes[] = {
        {
            WISP_PASS( "sleep.measure", CHECK, ENTITY, measure_motion ),
            .required = { out->state, out->particles },
            .reads = { out->state, out->particles, WISP_PARTICLE_POSITION },
            .writes = { out->moved, out->state, out->particles },
        },
        {
            WISP_PASS( "sleep.measure_strands", CHECK, ENTITY, measure_motion ),
            .required = { out->state, out->strands },
            .reads = { out->state, out->strands, WISP_STRAND_POSITION },
            .writes = { out->moved, out->state, out->strands },
        },
    };
    return out->moved != 0 ? wisp_declare_passes( registry, passes, WISP_COUNT( passes ), out ) : WISP_BAD_INPUT;
}
