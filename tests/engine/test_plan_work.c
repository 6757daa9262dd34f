// Passes with work, for every number of workers: results, failures, counters, workspaces, assignment of workers, and
// the profile.
#include "plan_fixture.h"

#define GROUP WISP_DOMAIN_STRAND_GROUP
#define ENTITY WISP_DOMAIN_ENTITY
#define SHAPE WISP_STAGE_SHAPE

// ---- a module that counts up, doubles and sums ----

enum
{
    WORK_GROUPS = 70,
};

static struct
{
    wisp_component a, b, sum;
    int workspace, released;
    uint64_t steps[8];
    _Atomic int step_count;
    bool fails;
    _Atomic int finished, missing_rows;
} work;

typedef struct work_space
{
    int64_t uses;
    unsigned char mark;
} work_space;

static int32_t* rows_of( wisp_frame* frame, const wisp_span* span, wisp_component c )
{
    int32_t* rows = wisp_frame_column( frame, span->entity, c, 0 );
    atomic_fetch_add( &work.missing_rows, rows == NULL ? 1 : 0 );
    return rows;
}

static void count_up( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    for ( int i = span->begin; i < span->end; ++i )
    {
        rows_of( frame, span, work.a )[i] += 3 * i + 1;
    }
    work_space* own = wisp_frame_workspace( frame, work.workspace, span->worker );
    own->uses += span->end - span->begin;
    wisp_frame_count( frame, WISP_COUNT_NEIGHBOURS, (uint64_t)( span->end - span->begin ) );
    if ( work.fails && span->begin == 0 )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "work: out of memory for entity %u", span->entity.index );
    }
}

static void twice( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    int32_t *a = rows_of( frame, span, work.a ), *b = rows_of( frame, span, work.b );
    for ( int i = span->begin; i < span->end && a != NULL && b != NULL; ++i )
    {
        b[i] = 2 * a[i];
    }
}

typedef struct sum_args
{
    const int32_t* values;
    _Atomic int64_t sum;
} sum_args;

static void sum_range( void* context, int begin, int end, int worker )
{
    (void)worker;
    sum_args* args = context;
    for ( int i = begin; i < end; ++i )
    {
        atomic_fetch_add( &args->sum, args->values[i] );
    }
}

static void sum_up( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    sum_args args = { .values = rows_of( frame, span, work.b ) };
    int groups = args.values != NULL ? wisp_frame_strands( frame, span->entity )->group_count : 0;
    wisp_parallel_for( wisp_frame_parallel( frame, span ), groups, 3, sum_range, &args );
    int64_t* sum = wisp_frame_column( frame, span->entity, work.sum, 0 );
    *sum = atomic_load( &args.sum );
    work.steps[atomic_fetch_add( &work.step_count, 1 ) % WISP_COUNT( work.steps )] = wisp_frame_step( frame );
    atomic_fetch_add( &work.finished, 1 );
}

static void release_space( void* workspace, const wisp_allocator* allocator )
{
    (void)workspace, (void)allocator;
    work.released += 1;
}

static wisp_status declare_work( wisp_registry* r )
{
    static const wisp_column_def value[] = { { "value", 4 } }, sum[] = { { "sum", 8 } };
    work.a = wisp_declare_component( r, &( wisp_component_def ){ "work.a", WISP_TABLE_STRAND_GROUP, value, 1 } );
    work.b = wisp_declare_component( r, &( wisp_component_def ){ "work.b", WISP_TABLE_STRAND_GROUP, value, 1 } );
    work.sum = wisp_declare_component( r, &( wisp_component_def ){ "work.sum", WISP_TABLE_ENTITY, sum, 1 } );
    work.workspace = wisp_declare_workspace( r, sizeof( work_space ), release_space, NULL );
    const wisp_pass passes[] = {
        { .name = "work.count",
          .stage = SHAPE,
          .domain = GROUP,
          .required = { work.a },
          .writes = { work.a },
          .run = count_up },
        { .name = "work.twice",
          .stage = SHAPE,
          .domain = GROUP,
          .reads = { work.a },
          .writes = { work.b },
          .run = twice },
        { .name = "work.sum",
          .stage = SHAPE,
          .domain = ENTITY,
          .reads = { work.b },
          .writes = { work.sum },
          .run = sum_up },
    };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( passes ) && status == WISP_OK; ++i )
    {
        status = wisp_declare_pass( r, passes + i );
    }
    return status;
}

static const wisp_module work_module = { .name = "work", .declare = declare_work };

static wisp_world* open_work( int workers, wisp_parallel_for_fn* host, void* host_user )
{
    static const wisp_module* const modules[] = { &work_module };
    memset( (void*)&work, 0, sizeof( work ) );
    memset( (void*)&fake, 0, sizeof( fake ) );
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    def.workers = workers;
    def.parallel_for = host;
    def.parallel_for_user = host_user;
    return open_world_with( &def );
}

static wisp_entity add_work( wisp_world* world, int groups, int length )
{
    wisp_entity e = test_add_strands( world, 16 * groups, length );
    assert_int_equal( wisp_world_attach( world, e, work.a ), WISP_OK );
    assert_int_equal( wisp_world_attach( world, e, work.b ), WISP_OK );
    assert_int_equal( wisp_request( world, e, work.sum ), WISP_OK );
    return e;
}

static int64_t sum_of( wisp_world* world, wisp_entity e )
{
    const int64_t* sum = wisp_world_column( world, e, work.sum, 0 );
    return *sum;
}

// After n steps row i of a is n (3 i + 1), and b twice that.
static int64_t expected_sum( int groups, int steps )
{
    int64_t sum = 0;
    for ( int i = 0; i < groups; ++i )
    {
        sum += 2 * steps * ( 3 * i + 1 );
    }
    return sum;
}

TEST( results_do_not_depend_on_the_workers )
{
    static const int workers[] = { 1, 2, 3, 5, 8 };
    uint64_t first = 0;
    for ( int i = 0; i < WISP_COUNT( workers ); ++i )
    {
        wisp_world* world = open_work( workers[i], NULL, NULL );
        wisp_entity entities[6];
        for ( int k = 0; k < WISP_COUNT( entities ); ++k )
        {
            entities[k] = add_work( world, 1 + k * k * 2, 4 );
        }
        for ( int k = 0; k < 5; ++k )
        {
            step( world );
        }
        for ( int k = 0; k < WISP_COUNT( entities ); ++k )
        {
            assert_int_equal( sum_of( world, entities[k] ), expected_sum( 1 + k * k * 2, 5 ) );
        }
        first = i == 0 ? wisp_world_hash( world ) : first;
        assert_int_equal( wisp_world_hash( world ), first );
        wisp_world_destroy( world );
    }
}

TEST( rows_between_two_passes_exist_because_the_plan_needs_them )
{
    wisp_world* world = open_work( 1, NULL, NULL );
    wisp_entity e = test_add_strands( world, 16, 2 );
    assert_int_equal( wisp_world_attach( world, e, work.a ), WISP_OK );
    assert_int_equal( wisp_request( world, e, work.sum ), WISP_OK );
    // the plan holds, because work.twice writes work.b and work.sum reads it
    step( world );
    int64_t sum = sum_of( world, e );
    wisp_world_destroy( world );
    assert_int_equal( work.missing_rows, 0 );
    assert_int_equal( sum, expected_sum( 1, 1 ) );
}

TEST( a_failing_pass_fails_the_step_and_the_others_finish )
{
    wisp_world* world = open_work( 2, NULL, NULL );
    add_work( world, 2, 2 );
    add_work( world, 2, 2 );
    work.fails = true;
    assert_int_equal( wisp_world_step( world, 0.01f ), WISP_NO_MEMORY );
    assert_non_null( strstr( wisp_world_message( world ), "work: out of memory for entity" ) );
    assert_int_equal( work.finished, 2 );
    work.fails = false;
    step( world );
    assert_int_equal( work.finished, 4 );
    wisp_world_destroy( world );
}

TEST( counters_add_up_over_blocks_and_steps )
{
    wisp_world* world = open_work( 3, NULL, NULL );
    add_work( world, WORK_GROUPS, 4 );
    for ( int i = 0; i < 3; ++i )
    {
        step( world );
    }
    assert_int_equal( wisp_world_counter( world, WISP_COUNT_NEIGHBOURS ), 3 * WORK_GROUPS );
    assert_int_equal( wisp_world_counter( world, WISP_COUNT_STEPS ), 3 );
    wisp_world_destroy( world );
}

TEST( a_pass_knows_how_many_steps_came_before )
{
    wisp_world* world = open_work( 1, NULL, NULL );
    add_work( world, 1, 2 );
    for ( int i = 0; i < 3; ++i )
    {
        step( world );
    }
    assert_int_equal( work.steps[0], 0 );
    assert_int_equal( work.steps[2], 2 );
    wisp_world_destroy( world );
}

TEST( a_workspace_is_one_zeroed_block_a_worker_kept_from_step_to_step )
{
    wisp_world* world = open_work( 3, NULL, NULL );
    add_work( world, WORK_GROUPS, 4 );
    step( world );
    step( world );
    int64_t uses = 0;
    for ( int worker = 0; worker < 3; ++worker )
    {
        const work_space* own = wisp_frame_workspace( &world->frame, work.workspace, worker );
        assert_int_equal( (uintptr_t)own % 64, 0 );
        assert_int_equal( own->mark, 0 );
        uses += own->uses;
    }
    assert_int_equal( uses, 2 * WORK_GROUPS );
    wisp_world_destroy( world );
    assert_int_equal( work.released, 3 );
}

// ---- assignment of workers ----

// A host's loop that counts its calls and runs backwards.
static void counting_parallel_for( void* user, int block_count, wisp_block_fn* run, void* context )
{
    *(int*)user += 1;
    for ( int b = block_count - 1; b >= 0; --b )
    {
        run( context, b, b % 2 );
    }
}

static int calls_of_a_step( int entities, int groups, int length )
{
    int calls = 0;
    wisp_world* world = open_work( 2, counting_parallel_for, &calls );
    for ( int i = 0; i < entities; ++i )
    {
        add_work( world, groups, length );
    }
    step( world );
    for ( int i = 0; i < entities; ++i )
    {
        assert_int_equal( sum_of( world, store_handle( &world->store, i ) ), expected_sum( groups, 1 ) );
    }
    wisp_world_destroy( world );
    return calls;
}

TEST( a_host_is_called_once_a_wave_of_the_plan_and_once_a_loop_of_a_lone_entity )
{
    // one wave of fused groups; the sum runs alone, and its own loop is the second call
    assert_int_equal( calls_of_a_step( 1, 20, 4 ), 2 );
}

TEST( many_small_entities_share_a_wave_and_loop_alone )
{
    // one wave of fused groups, one wave of nine sums that keep to their workers
    assert_int_equal( calls_of_a_step( 9, 4, 4 ), 2 );
}

TEST( large_entities_get_all_workers_one_after_the_other )
{
    // one wave of fused groups; two entities of more than 256 rows, a loop each
    assert_int_equal( calls_of_a_step( 2, 20, 20 ), 3 );
}

TEST( a_tiny_wave_wakes_nobody )
{
    assert_int_equal( calls_of_a_step( 1, 3, 2 ), 0 );
}

// ---- profile ----

static void spin( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)frame, (void)span;
    double begin = wisp_clock_seconds(), requested = *(const double*)user;
    while ( wisp_clock_seconds() - begin < requested )
    {
    }
}

static const double SHORT = 1e-4, LONG = 1e-3;

static wisp_status declare_spinning( wisp_registry* r )
{
    static const wisp_column_def value[] = { { "value", 4 } };
    wisp_component a =
        wisp_declare_component( r, &( wisp_component_def ){ "spin.a", WISP_TABLE_STRAND_GROUP, value, 1 } );
    wisp_component b =
        wisp_declare_component( r, &( wisp_component_def ){ "spin.b", WISP_TABLE_STRAND_GROUP, value, 1 } );
    const wisp_pass passes[] = {
        { .name = "spin.short",
          .stage = SHAPE,
          .domain = GROUP,
          .writes = { a },
          .run = spin,
          .user = (void*)(uintptr_t)&SHORT },
        { .name = "spin.long",
          .stage = SHAPE,
          .domain = GROUP,
          .reads = { a },
          .writes = { b },
          .run = spin,
          .user = (void*)(uintptr_t)&LONG },
        { .name = "spin.alone",
          .stage = WISP_STAGE_OBSERVE,
          .domain = ENTITY,
          .reads = { b },
          .writes = { b },
          .run = spin,
          .user = (void*)(uintptr_t)&LONG },
        { .name = "spin.absent",
          .stage = SHAPE,
          .domain = ENTITY,
          .required = { b },
          .writes = { a },
          .run = spin,
          .user = (void*)(uintptr_t)&LONG },
    };
    for ( int i = 0; i < WISP_COUNT( passes ); ++i )
    {
        wisp_declare_pass( r, passes + i );
    }
    return WISP_OK;
}

static const wisp_module spinning_module = { .name = "spinning", .declare = declare_spinning };

static wisp_world* open_spinning( int workers )
{
    static const wisp_module* const modules[] = { &spinning_module };
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    def.workers = workers;
    wisp_world* world = open_world_with( &def );
    wisp_entity e = test_add_strands( world, 16 * 8, 6 );
    assert_int_equal( wisp_request( world, e, (wisp_component)( world->store.component_count - 1 ) ), WISP_OK );
    step( world );
    return world;
}

TEST( a_profile_has_one_line_a_kept_pass_in_plan_order )
{
    wisp_world* world = open_spinning( 2 );
    wisp_profile p = wisp_world_profile( world );
    assert_int_equal( p.count, 3 );
    assert_string_equal( p.lines[0].pass, "spin.short" );
    assert_string_equal( p.lines[1].pass, "spin.long" );
    assert_string_equal( p.lines[2].pass, "spin.alone" );
    assert_int_equal( p.lines[0].items, 8 );
    assert_int_equal( p.lines[1].items, 8 );
    assert_int_equal( p.lines[2].items, 1 );
    wisp_world_destroy( world );
}

TEST( a_profile_sums_to_no_more_than_its_step )
{
    for ( int workers = 1; workers <= 3; ++workers )
    {
        wisp_world* world = open_spinning( workers );
        for ( int k = 0; k < 5; ++k )
        {
            wisp_profile p = wisp_world_profile( world );
            double sum = 0.0;
            for ( int i = 0; i < p.count; ++i )
            {
                assert_true( p.lines[i].seconds >= 0.0 );
                sum += p.lines[i].seconds;
            }
            // fractions of a wave are quotients, so their sum may round up
            assert_true( sum <= p.seconds * ( 1.0 + 1e-12 ) );
            step( world );
        }
        wisp_world_destroy( world );
    }
}

// Each entity has a substep loop of its own, and one of them works ten times as long.
static wisp_status declare_uneven( wisp_registry* r )
{
    static const wisp_column_def value[] = { { "value", 4 } };
    wisp_component c[3];
    static const char* const names[] = { "uneven.all", "uneven.one", "uneven.end" };
    for ( int i = 0; i < 3; ++i )
    {
        c[i] = wisp_declare_component( r, &( wisp_component_def ){ names[i], WISP_TABLE_ENTITY, value, 1 } );
    }
    const wisp_pass passes[] = {
        { .name = "uneven.short",
          .stage = WISP_STAGE_PREDICT,
          .domain = ENTITY,
          .required = { c[0] },
          .reads = { c[0] },
          .writes = { c[0], c[2] },
          .run = spin,
          .user = (void*)(uintptr_t)&SHORT },
        { .name = "uneven.long",
          .stage = WISP_STAGE_VELOCITY,
          .domain = ENTITY,
          .required = { c[1] },
          .reads = { c[0] },
          .writes = { c[2] },
          .run = spin,
          .user = (void*)(uintptr_t)&LONG },
    };
    return wisp_declare_passes( r, passes, 2, NULL );
}

TEST( a_profile_tells_entities_apart )
{
    static const wisp_module module = { .name = "uneven", .declare = declare_uneven };
    static const wisp_module* const modules[] = { &module };
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 2, def.modules = modules, def.module_count = 1, def.workers = 1;
    wisp_world* world = open_world_with( &def );
    int told_apart = 0;
    for ( int i = 0; i < 2; ++i )
    {
        const wisp_entity e = test_add_strands( world, 16, 6 );
        const wisp_component end = (wisp_component)( world->store.component_count - 1 );
        for ( int k = 0; k <= i; ++k )
        {
            assert_int_equal( wisp_world_attach( world, e, (wisp_component)( end - 2 + k ) ), WISP_OK );
        }
        assert_int_equal( wisp_request( world, e, end ), WISP_OK );
    }
    for ( int k = 0; k < 20; ++k )
    {
        step( world );
        const wisp_profile p = wisp_world_profile( world );
        assert_string_equal( p.lines[1].pass, "uneven.long" );
        told_apart += p.lines[1].seconds > 2.0 * p.lines[0].seconds ? 1 : 0;
    }
    assert_true( told_apart > 15 ); // a busy machine may disturb some
    wisp_world_destroy( world );
}

TEST( a_profile_tells_fused_passes_apart )
{
    wisp_world* world = open_spinning( 1 );
    assert_non_null( strstr( plan_text( world ), "spin.short+spin.long" ) );
    int told_apart = 0;
    for ( int k = 0; k < 20; ++k )
    {
        step( world );
        wisp_profile p = wisp_world_profile( world );
        assert_true( p.lines[0].seconds > 0.0 );
        // each of eight groups spins at least this long; fractions of a wave are quotients, so their sum may round
        // down
        assert_true( p.lines[0].seconds + p.lines[1].seconds >= 8.0 * ( SHORT + LONG ) * ( 1.0 - 1e-12 ) );
        told_apart += p.lines[1].seconds > 3.0 * p.lines[0].seconds ? 1 : 0;
    }
    // fractions come from samples, and a busy machine may disturb one; ten times the work shows in most of them
    assert_true( told_apart > 10 );
    wisp_world_destroy( world );
}
