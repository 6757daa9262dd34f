#include "contact_probe.h"

#include "bench_world.h"
// What the pass calls in the next step.
typedef struct probe_state
{
    wisp_component called;
    contact_probe_fn* run;
    void* context;
} probe_state;

static void call( wisp_frame* frame, const wisp_span* span, void* user )
{
    const probe_state* state = user;
    wisp_error error = { 0 };
    const wisp_status status =
        state->run( state->context, wisp_frame_parallel( frame, span ), wisp_frame_kernels( frame ), &error );
    if ( status != WISP_OK )
    {
        wisp_frame_fail( frame, status, "%s", error.message );
    }
}

static wisp_status declare( wisp_registry* registry )
{
    static const wisp_column_def columns[] = { WISP_COLUMN_DEF( int32_t, called, 1 ) };
    probe_state* state = wisp_declare_state( registry, sizeof( probe_state ) );
    if ( state == NULL )
    {
        return WISP_NO_MEMORY;
    }
    state->called = wisp_declare_component( registry, &( wisp_component_def ){
                                                          .name = "probe.called",
                                                          .table = WISP_TABLE_ENTITY,
                                                          .columns = columns,
                                                          .column_count = WISP_COUNT( columns ),
                                                      } );
    return wisp_declare_pass( registry, &( wisp_pass ){
                                            .name = "probe.call",
                                            .stage = WISP_STAGE_OBSERVE,
                                            .domain = WISP_DOMAIN_ENTITY,
                                            .required = { state->called },
                                            .writes = { state->called },
                                            .run = call,
                                            .user = state,
                                        } );
}

static const wisp_module probe_module = { .name = "probe", .declare = declare };

wisp_status contact_probe_open( int workers, contact_probe* out, wisp_error* error )
{
    static const wisp_module* const modules[] = { &probe_module };
    *out = ( contact_probe ){ .world = NULL };
    const bench_world_def def = { modules, WISP_COUNT( modules ), .workers = workers };
    wisp_status status = bench_world_create( &def, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const probe_state* state = wisp_world_module_state( out->world, probe_module.name );
    status = wisp_world_add_empty( out->world, &out->entity );
    status = status ? status : wisp_world_attach( out->world, out->entity, state->called );
    status = status ? status : wisp_request( out->world, out->entity, state->called );
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        contact_probe_close( out );
    }
    return status;
}

const wisp_allocator* contact_probe_allocator( const contact_probe* probe )
{
    return wisp_world_allocator( probe->world );
}

void contact_probe_close( contact_probe* probe )
{
    wisp_world_destroy( probe->world );
    *probe = ( contact_probe ){ .world = NULL };
}

wisp_status contact_probe_run( contact_probe* probe, contact_probe_fn* run, void* context, wisp_error* error )
{
    probe_state* state = wisp_world_module_state( probe->world, probe_module.name );
    state->run = run;
    state->context = context;
    const wisp_status status = wisp_world_step( probe->world, 1.0f );
    return status == WISP_OK ? WISP_OK : bench_world_fail( probe->world, status, error );
}
