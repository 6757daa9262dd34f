#include "world.h"

#include "alloc.h"
#include "fabric.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// ---- memory ----

// Where the memory of a world goes.

// Parts as they are found.
typedef struct part_list
{
    wisp_memory_part* out;
    int count, capacity;
} part_list;

static void add( part_list* parts, const char* name, wisp_memory_kind kind, size_t bytes, size_t capacity )
{
    if ( capacity == 0 )
    {
        return;
    }
    if ( parts->count < parts->capacity )
    {
        parts->out[parts->count] = ( wisp_memory_part ){ name, kind, bytes, capacity };
    }
    parts->count += 1;
}

static void add_whole( part_list* parts, const char* name, wisp_memory_kind kind, size_t bytes )
{
    add( parts, name, kind, bytes, bytes );
}

// Instances share what they are instances of, so each is counted where the first entity has it.
static bool is_first( const store* s, int slot, const void* shared, bool is_fabric )
{
    for ( int i = 0; i < slot; ++i )
    {
        const store_entity* e = s->entities + i;
        const void* other = is_fabric ? (const void*)e->fabric : (const void*)e->strands;
        if ( e->alive && other == shared )
        {
            return false;
        }
    }
    return true;
}

// A surface whose triangles have changed has a fabric in the memory of the world.
static bool is_own( const store* s, const wisp_fabric* fabric )
{
    return ( (const cook_fabric*)fabric )->keep.allocator == s->allocator;
}

static size_t topology_bytes( const store* s )
{
    size_t bytes = 0;
    for ( int i = 0; i < s->entity_count; ++i )
    {
        const store_entity* e = s->entities + i;
        bytes += e->alive && e->strands != NULL && is_first( s, i, e->strands, false )
                     ? ( (const cook_strands*)e->strands )->bytes
                     : 0;
        bytes += e->alive && e->fabric != NULL && is_own( s, e->fabric ) && is_first( s, i, e->fabric, true )
                     ? wisp_fabric_bytes( e->fabric )
                     : 0;
    }
    return bytes;
}

static size_t fabric_bytes( const store* s )
{
    size_t bytes = 0;
    for ( int i = 0; i < s->entity_count; ++i )
    {
        const store_entity* e = s->entities + i;
        bytes += e->alive && e->fabric != NULL && is_own( s, e->fabric ) == false && is_first( s, i, e->fabric, true )
                     ? wisp_fabric_bytes( e->fabric )
                     : 0;
    }
    return bytes;
}

static void add_engine( part_list* parts, const wisp_world* world )
{
    const store* s = &world->store;
    size_t pool = 0;
    const size_t scratch = jobs_memory( world->pool, &pool );
    const size_t clocks = (size_t)world->registry.workers * sizeof( plan_clock );
    const wisp_buffer* passes = world->registry.pass_rows;
    add_whole( parts, "world", WISP_MEMORY_ENGINE,
               sizeof( *world ) + passes[0].size + passes[1].size + passes[2].size );
    add_whole( parts, "workers", WISP_MEMORY_ENGINE, pool + clocks );
    add_whole( parts, "scratch", WISP_MEMORY_ENGINE, scratch );
    add( parts, "entities", WISP_MEMORY_ENGINE, (size_t)s->entity_count * sizeof( store_entity ),
         (size_t)s->entity_capacity * sizeof( store_entity ) );
    add_whole( parts, "topology", WISP_MEMORY_ENGINE, topology_bytes( s ) );
    add_whole( parts, "plan", WISP_MEMORY_ENGINE, plan_memory( &world->plan ) );
    add_whole( parts, "blended points", WISP_MEMORY_ENGINE, world->blend.previous.size + world->blend.points.size );
    add_whole( parts, "sleep", WISP_MEMORY_ENGINE, world->sleep.boxes.size );
    add_whole( parts, "origins", WISP_MEMORY_ENGINE, world->origin_members.size );
}

// @return sum over the parts
static size_t sum_of( const wisp_memory_part* parts, int count )
{
    size_t sum = 0;
    for ( int i = 0; i < count; ++i )
    {
        sum += parts[i].capacity;
    }
    return sum;
}

enum
{
    ENGINE_PARTS = 8,
    ALL_PARTS = ENGINE_PARTS + PLAN_MAX_STATES + STORE_MAX_COMPONENTS,
};

int wisp_world_memory_parts( const wisp_world* world, wisp_memory_part* out, int capacity )
{
    if ( world == NULL )
    {
        return 0;
    }
    wisp_memory_part found[ALL_PARTS + 2];
    part_list engine = { found, 0, ENGINE_PARTS };
    add_engine( &engine, world );
    wisp_memory_part* own = found + ENGINE_PARTS;
    part_list rest = { own, 0, ALL_PARTS + 2 - ENGINE_PARTS };
    size_t outside = 0;
    for ( int i = 0; i < world->registry.state_count; ++i )
    {
        size_t held;
        const size_t bytes = plan_registry_memory( &world->registry, i, &held, &outside );
        add( &rest, world->registry.states[i].module, WISP_MEMORY_MODULE, held, bytes );
    }
    for ( int i = 1; i < world->store.component_count; ++i )
    {
        size_t used;
        const size_t bytes = store_memory( &world->store, (wisp_component)i, &used );
        add( &rest, world->store.components[i].def.name, WISP_MEMORY_COMPONENT, used, bytes );
    }
    // descriptions of the plan that a host has, and what modules of a host keep without saying so
    const size_t known = sum_of( found, engine.count ) + sum_of( own, rest.count );
    const size_t all = wisp_world_memory( world );
    add_whole( &engine, "other", WISP_MEMORY_ENGINE, all > known ? all - known : 0 );
    add_whole( &rest, "fabrics", WISP_MEMORY_OUTSIDE, fabric_bytes( &world->store ) );
    add_whole( &rest, "trees of Embree", WISP_MEMORY_OUTSIDE, outside );
    for ( int i = 0; out != NULL && i < engine.count + rest.count && i < capacity; ++i )
    {
        out[i] = i < engine.count ? found[i] : own[i - engine.count];
    }
    return engine.count + rest.count;
}

// ---- fixed steps ----

// Fixed steps from any frame time.

enum
{
    MAX_STEPS = 8, // of one call; a host that needs more would fall ever further behind
};

// Compiling before the last step keeps the layout of the kept points.
static wisp_status make_step( wisp_world* world, float dt, bool is_last, wisp_before_step_fn* before_step,
                              void* user )
{
    if ( before_step != NULL )
    {
        before_step( user, world );
    }
    if ( is_last && wisp_world_plan_passes( world ) < 0 )
    {
        return world->error.status;
    }
    if ( is_last && world_keep_points( world ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "advance: out of memory for the points of a step" );
    }
    return wisp_world_step( world, dt );
}

wisp_status wisp_world_advance( wisp_world* world, float seconds, float dt, wisp_before_step_fn* before_step,
                                void* user )
{
    WISP_TRY( wisp_world_begin( world ) );
    if ( !( seconds >= 0.0f && seconds < 1e6f ) || !( dt > 0.0f && dt < 1e6f ) )
    {
        return wisp_world_fail(
            world, WISP_BAD_INPUT,
            "advance: got %g s in steps of %g s, expected a time of at least 0 and a step above 0", (double)seconds,
            (double)dt );
    }
    const double ROUNDING = 1e-6; // of a step
    const double pending = world->clock.pending + (double)seconds, due = floor( pending / (double)dt + ROUNDING );
    const int steps = due < MAX_STEPS ? (int)due : MAX_STEPS;
    for ( int i = 0; i < steps; ++i )
    {
        const wisp_status status = make_step( world, dt, i + 1 == steps, before_step, user );
        if ( status != WISP_OK )
        {
            world->clock.pending = pending - i * (double)dt; // due in the next call
            return status;
        }
    }
    world->clock.pending = fmax( pending - due * (double)dt, 0.0 );
    world_count_cut( world, (double)seconds, ( due - steps ) * (double)dt );
    world_blend_points( world, (float)( world->clock.pending / (double)dt ) );
    return WISP_OK;
}

// ---- world ----

static const wisp_field WORLD_FIELDS[] = {
    WISP_WHOLE( wisp_world_def, workers, 0, 0, WISP_MAX_WORKERS ),
    WISP_WHOLE( wisp_world_def, substeps, 10, 1, WORLD_MAX_SUBSTEPS ),
    WISP_WHOLE( wisp_world_def, iterations, 1, 1, WORLD_MAX_SUBSTEPS ),
    WISP_WHOLE( wisp_world_def, longest_step, 8, 1, WORLD_MAX_USUAL_STEPS ),
};
WISP_DEFINE( world_def, "world", WORLD_FIELDS )

static void* counted_allocate( void* user, size_t size, size_t alignment )
{
    world_memory* memory = user;
    void* block = base_allocate( &memory->host, size, alignment );
    atomic_fetch_add( &memory->bytes, block != NULL ? size : 0 );
    return block;
}

static void counted_release( void* user, void* block, size_t size )
{
    world_memory* memory = user;
    if ( block != NULL )
    {
        atomic_fetch_sub( &memory->bytes, size );
        base_release( &memory->host, block, size );
    }
}

static wisp_status check_def( const wisp_world_def* def, wisp_error* error )
{
    if ( ( def->allocator.allocate == NULL ) != ( def->allocator.release == NULL ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "allocator: got one function, expected both or neither" );
    }
    if ( def->module_count < 0 || ( def->module_count > 0 && def->modules == NULL ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "module_count: got %d without a list of modules",
                          def->module_count );
    }
    for ( int i = 0; i < def->module_count; ++i )
    {
        if ( def->modules[i] == NULL )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "modules: entry %d of %d is null", i, def->module_count );
        }
    }
    return WISP_OK;
}

static wisp_status register_modules( wisp_world* world, const wisp_world_def* def )
{
    wisp_status status = world_declare_strands( &world->registry );
    status = status == WISP_OK ? world_declare_places( &world->registry ) : status;
    status = status == WISP_OK ? passes_declare( &world->registry ) : status;
    status = status == WISP_OK ? passes_declare_detail( &world->registry, &world->registry.detail ) : status;
    status = status == WISP_OK ? passes_declare_sleep( &world->registry, &world->sleep.components ) : status;
    for ( int i = 0; i < def->module_count && status == WISP_OK; ++i )
    {
        status = plan_registry_add( &world->registry, def->modules[i] );
    }
    return status;
}

static wisp_status build( wisp_world* world, const wisp_world_def* def, wisp_error* error )
{
    int workers = def->workers > 0 ? def->workers : jobs_default_workers();
    store_init( &world->store, &world->allocator );
    plan_registry_init( &world->registry, &world->store, workers );
    world->registry.substeps = def->substeps;
    world->registry.iterations = def->iterations;
    const wisp_kernels* kernels = kernels_select( def->isa, error );
    if ( kernels == NULL )
    {
        return WISP_BAD_INPUT;
    }
    wisp_status status = register_modules( world, def );
    if ( status != WISP_OK )
    {
        return wisp_fail( error, status, "%s", world->registry.error.message );
    }
    size_t clock_bytes = (size_t)workers * sizeof( plan_clock );
    world->pool = jobs_create( &world->allocator, workers, def->parallel_for, def->parallel_for_user );
    world->frame.clocks = base_allocate( &world->allocator, clock_bytes, 64 );
    if ( world->pool == NULL || world->frame.clocks == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for a world of %d workers", workers );
    }
    memset( world->frame.clocks, 0, clock_bytes );
    world->frame.registry = &world->registry;
    world->frame.plan = &world->plan;
    world->frame.pool = world->pool;
    world->frame.kernels = kernels;
    world->frame.iterations = def->iterations;
    world->longest_step = def->longest_step;
    return WISP_OK;
}

wisp_status wisp_world_create( const wisp_world_def* given, wisp_world** out, wisp_error* error )
{
    if ( out == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "out: got null, expected where to store the world" );
    }
    *out = NULL;
    wisp_world_def values;
    const wisp_world_def* def = &values;
    WISP_TRY( wisp_def_read( &wisp_world_def_fields, &values, given, error ) );
    WISP_TRY( check_def( def, error ) );
    wisp_world* world = base_allocate( &def->allocator, sizeof( wisp_world ), 64 );
    if ( world == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for a world" );
    }
    memset( (void*)world, 0, sizeof( *world ) );
    world->memory.host = def->allocator;
    world->allocator = ( wisp_allocator ){ counted_allocate, counted_release, &world->memory };
    world->log = ( base_log ){ def->log, def->log_user };
    wisp_status status = build( world, def, error );
    if ( status != WISP_OK )
    {
        wisp_world_destroy( world );
        return status;
    }
    *out = world;
    return WISP_OK;
}

void wisp_world_destroy( wisp_world* world )
{
    if ( world == NULL )
    {
        return;
    }
    if ( atomic_load( &world->is_stepping ) )
    {
        wisp_world_warn( world, "destroy: a step of this world runs, so the world stays" );
        return;
    }
    const wisp_allocator host = world->memory.host;
    for ( int i = 0; i < world->store.entity_count; ++i )
    {
        cook_strands_release( (cook_strands*)(void*)world->store.entities[i].strands );
        wisp_fabric_release( (wisp_fabric*)(void*)world->store.entities[i].fabric );
    }
    plan_release( &world->plan, &world->allocator );
    base_release( &world->allocator, world->frame.clocks, (size_t)world->registry.workers * sizeof( plan_clock ) );
    base_buffer_release( &world->allocator, &world->blend.previous );
    base_buffer_release( &world->allocator, &world->blend.points );
    base_buffer_release( &world->allocator, &world->sleep.boxes );
    base_buffer_release( &world->allocator, &world->origin_members );
    plan_registry_release( &world->registry );
    store_release( &world->store );
    jobs_destroy( world->pool );
    base_release( &host, world, sizeof( *world ) );
}

void world_set_kernels( wisp_world* world, const wisp_kernels* kernels )
{
    world->frame.kernels = kernels;
}

// ---- steps ----

static wisp_status compile_if_changed( wisp_world* world )
{
    if ( world->plan.structure == world->store.structure && world->plan_is_stale == false )
    {
        if ( world->rates_are_stale )
        {
            plan_update_rates( &world->plan, &world->registry );
            world->rates_are_stale = false;
        }
        return WISP_OK;
    }
    WISP_TRY( plan_registry_planning( &world->registry, world ) );
    const bool has_other_rows = world->plan.structure != world->store.structure;
    wisp_error error = { 0 };
    wisp_status status = plan_compile( &world->plan, &world->registry, &error );
    wisp_frame_count( &world->frame, WISP_COUNT_PLANS, 1 );
    if ( status != WISP_OK )
    {
        world->plan_is_stale = true;
        return wisp_world_fail( world, status, "%s", error.message );
    }
    world->plan_is_stale = world->rates_are_stale = false;
    world->plan_is_new = world->plan_is_new || has_other_rows;
    plan_registry_planned( &world->registry, world );
    return WISP_OK;
}

static void drive( void* context )
{
    plan_execute( context );
}

static void write_profile( wisp_world* world )
{
    world->line_count = 0;
    for ( int n = 0; n < world->plan.node_count; ++n )
    {
        for ( int i = 0; i < world->plan.nodes[n].pass_count && world->plan.nodes[n].repeats == false; ++i )
        {
            int pass = world->plan.nodes[n].passes[i];
            world->lines[world->line_count++] = ( wisp_profile_line ){
                .pass = world->registry.passes[pass].name,
                .seconds = world->frame.pass_seconds[pass],
                .items = (int)( world->frame.pass_items[pass] < INT_MAX ? world->frame.pass_items[pass] : INT_MAX ),
            };
        }
    }
}

// Once; the results are the same, and only late.
static void warn_without_threads( wisp_world* world, bool has_threads )
{
    if ( has_threads == false && world->has_warned_of_threads == false )
    {
        world->has_warned_of_threads = true;
        base_log_write( &world->log, WISP_LOG_WARNING,
                        "workers: the system starts no threads, so steps for %d workers run on one",
                        jobs_workers( world->pool ) );
    }
}

void world_count_cut( wisp_world* world, double seconds, double cut )
{
    if ( cut > 0.0 && wisp_world_counter( world, WISP_COUNT_CUT_STEPS ) == 0 )
    {
        base_log_write( &world->log, WISP_LOG_WARNING, "step: %g s are too long, so the last %g s are left out",
                        seconds, cut );
    }
    wisp_frame_count( &world->frame, WISP_COUNT_CUT_STEPS, cut > 0.0 ? 1 : 0 );
}

// Cut a step into substeps. A plan without substeps, such as one of appearance alone, runs in every step.
static void cut_step( wisp_world* world, float dt, bool is_new_plan )
{
    wisp_frame* frame = &world->frame;
    if ( plan_has_substeps( &world->plan ) )
    {
        const double cut = step_clock_advance( &world->clock, dt, world->registry.substeps, world->longest_step,
                                               is_new_plan, frame );
        world_count_cut( world, (double)dt, cut );
        return;
    }
    frame->substeps = world->registry.substeps;
    frame->even = dt;
    frame->seconds = dt / (float)world->registry.substeps;
    frame->progress = 0.0f;
    frame->reached = 1.0f;
}

// Once: a newcomer's world that does not move has a reason. It is information, and without a log it is printed like a warning.
static void tell_of_nothing( wisp_world* world )
{
    if ( world->plan.node_count == 0 && world->store.entity_count > 0 && world->has_warned_of_nothing == false )
    {
        world->has_warned_of_nothing = true;
        base_log_write( &world->log, world->log.function != NULL ? WISP_LOG_INFO : WISP_LOG_WARNING,
                        "step: nothing is requested of any entity, so nothing is computed; see wisp_request()" );
    }
}

// Run a step, or a part of it.
static void run_part( wisp_world* world )
{
    wisp_frame* frame = &world->frame;
    const bool can_sleep = plan_has_substeps( &world->plan ) && frame->substeps > 0;
    if ( can_sleep )
    {
        world_sleep_begin( world );
    }
    if ( world->plan.node_count > 0 )
    {
        warn_without_threads( world, jobs_enter( world->pool, drive, frame ) );
    }
    if ( can_sleep && atomic_load( &frame->failed ) == false )
    {
        world_sleep_end( world );
    }
}

// A step as it was cut.
typedef struct step_span
{
    int substeps;
    float progress, reached;
} step_span;

// Have the frame make the part of a step behind some substeps: a usual step, or what is left.
static void set_part( wisp_world* world, step_span whole, int done )
{
    wisp_frame* frame = &world->frame;
    const int usual = world->registry.substeps, left = whole.substeps - done;
    const double each = whole.progress > 0.0f ? (double)whole.progress : 1.0 / whole.substeps, before = done - usual;
    frame->substeps = left < usual ? left : usual;
    frame->even =
        left >= usual && frame->seconds == world->clock.usual_dt / (float)usual ? world->clock.usual_dt : 0.0f;
    frame->progress = whole.progress == 0.0f && left <= usual ? 0.0f : (float)( each / ( 1.0 - done * each ) );
    frame->reached = done > 0 ? (float)( usual * each / ( 1.0 - before * each ) ) : whole.reached;
    frame->continues = done > 0;
    frame->goes_on = left > usual;
    const float end = frame->progress * (float)frame->substeps;
    world->clock.reached = frame->progress > 0.0f && end < 1.0f ? end : 1.0f;
}

// Run a step. One of several usual ones is so many, one behind the other, towards the same targets.
static wisp_status run_parts( wisp_world* world )
{
    wisp_frame* frame = &world->frame;
    const step_span whole = { frame->substeps, frame->progress, frame->reached };
    const bool has_parts = plan_has_substeps( &world->plan ) && whole.substeps >= 2 * world->registry.substeps;
    int done = 0;
    frame->continues = frame->goes_on = false;
    do
    {
        if ( has_parts )
        {
            set_part( world, whole, done );
        }
        run_part( world );
        done += frame->substeps;
        if ( atomic_load( &frame->failed ) )
        {
            return wisp_world_fail( world, frame->error.status, "%s", frame->error.message );
        }
        WISP_TRY( plan_end_step( &world->plan, &world->registry, world ) );
        if ( frame->goes_on )
        {
            WISP_TRY( compile_if_changed( world ) );
            world->plan_is_new = false; // this step has substeps
        }
    } while ( frame->goes_on );
    return WISP_OK;
}

static wisp_status step( wisp_world* world, float seconds )
{
    if ( !( seconds > 0.0f && seconds < 1e6f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "step: got %g s, expected a number above 0 and below 1e6",
                                (double)seconds );
    }
    world_detail_show( world, true );
    wisp_status compiled = compile_if_changed( world );
    compiled = compiled == WISP_OK ? world_origins_begin( world ) : compiled;
    if ( compiled != WISP_OK )
    {
        world_detail_show( world, false );
        return compiled;
    }
    world_detail_begin( world );
    world->blend.is_shown = false;
    double begin = wisp_clock_seconds();
    wisp_frame* frame = &world->frame;
    atomic_flag_clear( &frame->failing );
    atomic_store( &frame->failed, false );
    atomic_flag_clear( &frame->halting );
    frame->halted_message[0] = '\0';
    cut_step( world, seconds, world->plan_is_new );
    world->plan_is_new = false;
    const wisp_status status = run_parts( world );
    tell_of_nothing( world );
    write_profile( world );
    frame->step += 1;
    wisp_frame_count( frame, WISP_COUNT_STEPS, 1 );
    world->seconds = wisp_clock_seconds() - begin;
    if ( frame->halted_message[0] != '\0' )
    {
        base_log_write( &world->log, WISP_LOG_WARNING, "%s", frame->halted_message );
    }
    return status;
}

wisp_status wisp_world_run( wisp_world* world, wisp_entity entity, wisp_pass_fn* run, void* user )
{
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    WISP_TRY( compile_if_changed( world ) );
    wisp_frame* frame = &world->frame;
    atomic_flag_clear( &frame->failing );
    atomic_store( &frame->failed, false );
    frame->wide = false;
    run( frame, &( wisp_span ){ .entity = entity }, user );
    return atomic_load( &frame->failed ) ? wisp_world_fail( world, frame->error.status, "%s", frame->error.message )
                                         : WISP_OK;
}

wisp_status wisp_world_step( wisp_world* world, float seconds )
{
    WISP_TRY( wisp_world_begin( world ) );
    if ( atomic_exchange( &world->is_stepping, true ) )
    {
        return WISP_CONFLICT; // another thread was first
    }
    world->error.message[0] = '\0'; // of a call that ended meanwhile
    const wisp_status status = step( world, seconds );
    atomic_store( &world->is_stepping, false );
    return status;
}

wisp_profile wisp_world_profile( const wisp_world* world )
{
    if ( world == NULL )
    {
        return ( wisp_profile ){ NULL, 0, 0.0 };
    }
    return ( wisp_profile ){ world->lines, world->line_count, world->seconds };
}

// ---- numbers about the world ----

uint64_t wisp_world_counter( const wisp_world* world, wisp_counter counter )
{
    return world != NULL && (unsigned)counter < WISP_COUNTER_COUNT ? atomic_load( &world->frame.counters[counter] )
                                                                   : 0;
}

const char* wisp_counter_name( wisp_counter counter )
{
    static const char* const NAMES[WISP_COUNTER_COUNT] = {
        "steps",
        "plans",
        "neighbours",
        "capped neighbour lists",
        "coarse grids",
        "neighbour searches",
        "halted entities",
        "strand reset",
        "not converged",
        "indefinite solves",
        "degenerate link",
        "stiffness clamped",
        "first order substeps",
        "gravity scaled",
        "sagging strands",
        "stretched strands",
        "limited speeds",
        "split vertices",
        "cut steps",
        "many solves",
    };
    return counter >= 0 && counter < WISP_COUNTER_COUNT ? NAMES[counter] : "unknown";
}

size_t wisp_world_memory( const wisp_world* world )
{
    return world != NULL ? sizeof( *world ) + atomic_load( &world->memory.bytes ) : 0;
}

int wisp_world_workers( const wisp_world* world )
{
    return world != NULL ? world->registry.workers : 0;
}

const char* wisp_world_isa( const wisp_world* world )
{
    return world != NULL ? world->frame.kernels->isa : "none";
}

wisp_status wisp_read_substeps( wisp_world* world, wisp_entity entity, int* out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    WISP_TRY( compile_if_changed( world ) );
    *out = plan_substeps_of_rate( &world->registry,
                                  plan_rate( world->plan.entities + entity.index - 1, &world->registry ),
                                  world->registry.substeps );
    return WISP_OK;
}

wisp_status wisp_world_explain( wisp_world* world, wisp_plan_info** out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    WISP_TRY( compile_if_changed( world ) );
    *out = plan_explain( &world->plan, &world->registry, world->registry.substeps, world->frame.iterations );
    return *out != NULL ? WISP_OK : wisp_world_fail( world, WISP_NO_MEMORY, "out of memory to explain the plan" );
}

wisp_status wisp_world_plan( wisp_world* world, void ( *write )( void* user, const char* line ), void* user )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( wisp_world_check_pointer( world, "write", (const void*)(uintptr_t)write ) );
    wisp_plan_info* report = NULL;
    wisp_status status = wisp_world_explain( world, &report );
    if ( status == WISP_OK )
    {
        plan_print( report, write, user );
    }
    wisp_plan_info_release( report );
    return status;
}

int wisp_world_plan_passes( wisp_world* world )
{
    return wisp_world_begin( world ) == WISP_OK && compile_if_changed( world ) == WISP_OK ? world->plan.pass_count
                                                                                          : -1;
}

// ---- snapshots ----

uint64_t wisp_world_hash( const wisp_world* world )
{
    return world != NULL ? store_hash( &world->store ) : 0;
}

// Passes attach what they write when the plan is compiled, so a world has all its columns only then.
size_t wisp_world_snapshot_size( wisp_world* world )
{
    return wisp_world_begin( world ) == WISP_OK && compile_if_changed( world ) == WISP_OK
               ? store_snapshot_size( &world->store ) + world_origins_size( world ) + sizeof( world->clock )
               : 0;
}

wisp_status wisp_world_snapshot( wisp_world* world, void* out, size_t size )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    WISP_TRY( compile_if_changed( world ) );
    const size_t store_size = store_snapshot_size( &world->store ), origins_size = world_origins_size( world );
    if ( size < store_size + origins_size + sizeof( world->clock ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "snapshot: got room for %zu bytes, expected at least %zu",
                                size, store_size + origins_size + sizeof( world->clock ) );
    }
    world_sleep_to_rows( world, false );
    store_snapshot( &world->store, out );
    world_sleep_to_rows( world, true );
    world_origins_write( world, (char*)out + store_size );
    memcpy( (char*)out + store_size + origins_size, &world->clock, sizeof( world->clock ) );
    return WISP_OK;
}

wisp_status wisp_world_restore( wisp_world* world, const void* bytes, size_t size )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( wisp_world_check_pointer( world, "bytes", bytes ) );
    WISP_TRY( compile_if_changed( world ) );
    step_clock clock = { 0 };
    const size_t origins_size = world_origins_size( world ), behind = origins_size + sizeof( clock );
    const size_t store_size = size > behind ? size - behind : 0;
    const char* origins = (const char*)bytes + store_size;
    if ( store_size > 0 )
    {
        memcpy( &clock, origins + origins_size, sizeof( clock ) );
    }
    wisp_error error = { 0 };
    wisp_status status = step_clock_check( &clock ) && ( store_size == 0 || world_origins_check( world, origins ) )
                             ? store_restore( &world->store, bytes, store_size, &error )
                             : wisp_fail( &error, WISP_BAD_INPUT, "snapshot: the step clock is damaged" );
    if ( status != WISP_OK )
    {
        return wisp_world_fail( world, status, "%s", error.message );
    }
    world_origins_read( world, origins );
    world_sleep_from_rows( world );
    world_detail_from_rows( world );
    world->clock = clock;
    world->blend.is_shown = false;
    return WISP_OK;
}
