/// Small modules named by letters: passes a, b, c over components A, B, C. A test declares what each pass requires,
/// reads and writes, and compares the plan and the trace as text.
#pragma once

#include "support.h"

#include "world.h"

#include "wisp/explain.h"

enum
{
    FAKE_COMPONENTS = 16, // letters A to P
    FAKE_TRACE = 4000,
};

typedef struct fake_pass
{
    const char* name; // as the plan prints it
    wisp_stage stage;
    wisp_domain domain;
    const char *required, *excluded, *reads, *writes, *foreign; // letters; null for none
    char among;                                                 // a letter, or 0
    char on_change;                                             // a letter, or 0
    bool follows;                                               // an entity that it does not list
    bool asks;                                                  // should_run returns fake.due
    int grain;
} fake_pass;

typedef struct fake_run
{
    const fake_pass* pass; // null: all passes of a fusion
    wisp_span span;
    int substep_end; // of a fusion
} fake_run;

// The module that tests declare, and the trace of its passes. One test, one thread and one world at a time.
static struct
{
    const fake_pass* passes;
    int pass_count;
    const wisp_fusion* join; // null: none
    wisp_component components[FAKE_COMPONENTS];
    fake_run runs[FAKE_TRACE];
    _Atomic int run_count;
    bool due;
    int queried;     // number of calls of should_run
    int runs_before; // number of runs at its last call
    test_log log;
} fake;

static inline void fake_trace( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)frame;
    int at = atomic_fetch_add( &fake.run_count, 1 );
    if ( at < FAKE_TRACE )
    {
        fake.runs[at] = ( fake_run ){ user, *span, 0 };
    }
}

static inline void fake_trace_joined( wisp_frame* frame, const wisp_span* span, int substep_end, void* user )
{
    (void)frame, (void)user;
    int at = atomic_fetch_add( &fake.run_count, 1 );
    if ( at < FAKE_TRACE )
    {
        fake.runs[at] = ( fake_run ){ NULL, *span, substep_end };
    }
}

static inline bool fake_is_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    (void)frame, (void)entity, (void)user;
    fake.queried += 1;
    fake.runs_before = atomic_load( &fake.run_count );
    return fake.due;
}

static inline wisp_component letter( char name )
{
    return fake.components[name - 'A'];
}

static inline void fill_uses( wisp_component* uses, const char* letters )
{
    for ( int i = 0; letters != NULL && letters[i] != 0; ++i )
    {
        uses[i] = letter( letters[i] );
    }
}

static inline wisp_status fake_declare( wisp_registry* r )
{
    static const wisp_column_def columns[] = { { "value", sizeof( int32_t ) } };
    static const char* const NAMES[FAKE_COMPONENTS] = {
        "fake.A", "fake.B", "fake.C", "fake.D", "fake.E", "fake.F", "fake.G", "fake.H",
        "fake.I", "fake.J", "fake.K", "fake.L", "fake.M", "fake.N", "fake.O", "fake.P",
    };
    for ( int i = 0; i < FAKE_COMPONENTS; ++i )
    {
        fake.components[i] = wisp_declare_component(
            r, &( wisp_component_def ){ NAMES[i], WISP_TABLE_STRAND_GROUP, columns, WISP_COUNT( columns ) } );
    }
    wisp_status status = WISP_OK;
    for ( int i = 0; i < fake.pass_count && status == WISP_OK; ++i )
    {
        const fake_pass* f = fake.passes + i;
        wisp_pass pass = {
            .name = f->name,
            .stage = f->stage,
            .domain = f->domain,
            .run = fake_trace,
            .follows = f->follows,
            .among = f->among != 0 ? letter( f->among ) : (wisp_component)0,
            .on_change = f->on_change != 0 ? letter( f->on_change ) : (wisp_component)0,
            .should_run = f->asks ? fake_is_due : NULL,
            .user = (void*)(uintptr_t)f,
            .grain = f->grain,
        };
        fill_uses( pass.required, f->required );
        fill_uses( pass.excluded, f->excluded );
        fill_uses( pass.reads, f->reads );
        fill_uses( pass.writes, f->writes );
        fill_uses( pass.foreign, f->foreign );
        status = wisp_declare_pass( r, &pass );
    }
    return status == WISP_OK && fake.join != NULL ? wisp_declare_fusion( r, fake.join ) : status;
}

static const wisp_module fake_module = { .name = "fake", .declare = fake_declare };

// ---- worlds ----

static inline wisp_world* open_world_with( const wisp_world_def* requested )
{
    static const wisp_module* const modules[] = { &fake_module };
    wisp_world_def def = *requested;
    def.modules = def.modules != NULL ? def.modules : modules;
    def.module_count = def.module_count > 0 ? def.module_count : WISP_COUNT( modules );
    def.log = test_log_write;
    def.log_user = &fake.log;
    wisp_world* world = NULL;
    wisp_error error = { WISP_OK, "" };
    if ( wisp_world_create( &def, &world, &error ) != WISP_OK )
    {
        fail_msg( "no world: %s", error.message );
    }
    return world;
}

// Forget the last test, and declare these passes.
static inline void declare_fakes( const fake_pass* passes, int count )
{
    memset( (void*)&fake, 0, sizeof( fake ) );
    fake.passes = passes;
    fake.pass_count = count;
    fake.due = true;
}

/// A world on one worker, so that the trace has an order.
static inline wisp_world* open_world( const fake_pass* passes, int count )
{
    declare_fakes( passes, count );
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.workers = 1;
    return open_world_with( &def );
}

#define OPEN_WORLD( passes ) open_world( passes, WISP_COUNT( passes ) )

/// Three groups of strands that have these components.
static inline wisp_entity add_with( wisp_world* world, const char* components )
{
    wisp_entity entity = test_add_strands( world, 48, 2 );
    for ( int i = 0; components[i] != 0; ++i )
    {
        assert_int_equal( wisp_world_attach( world, entity, letter( components[i] ) ), WISP_OK );
    }
    return entity;
}

static inline void request( wisp_world* world, wisp_entity entity, const char* components )
{
    for ( int i = 0; components[i] != 0; ++i )
    {
        assert_int_equal( wisp_request( world, entity, letter( components[i] ) ), WISP_OK );
    }
}

static inline void cancel_request( wisp_world* world, wisp_entity entity, const char* components )
{
    for ( int i = 0; components[i] != 0; ++i )
    {
        assert_int_equal( wisp_cancel_request( world, entity, letter( components[i] ) ), WISP_OK );
    }
}

static inline void step( wisp_world* world )
{
    if ( wisp_world_step( world, 0.01f ) != WISP_OK )
    {
        fail_msg( "no step: %s", wisp_world_message( world ) );
    }
}

// ---- plans as data ----

/// The pass of that name, which must exist.
static inline const wisp_plan_pass* pass_of( const wisp_plan_info* report, const char* name )
{
    for ( int i = 0; i < report->pass_count; ++i )
    {
        if ( strcmp( report->passes[i].name, name ) == 0 )
        {
            return report->passes + i;
        }
    }
    fail_msg( "no pass is called %s", name );
    return NULL;
}

// ---- plans and traces as text ----

static inline void append_text( char* text, size_t size, const char* more )
{
    size_t length = strlen( text );
    snprintf( text + length, size - length, "%s", more );
}

// Nodes of a wave: a+b are fused, a,b share the wave.
static inline void append_wave( char* text, size_t size, const wisp_world* world, int section, int wave )
{
    const char* separator = "";
    for ( int n = 0; n < world->plan.node_count; ++n )
    {
        const plan_node* node = world->plan.nodes + n;
        for ( int i = 0; i < node->pass_count && (int)node->section == section && node->wave == wave; ++i )
        {
            append_text( text, size, i > 0 ? "+" : separator );
            append_text( text, size, world->registry.passes[node->passes[i]].name );
            separator = ",";
        }
    }
}

/// The plan: waves in order, sections in brackets as far as they exist, "refused" if there is none.
static inline const char* plan_text( wisp_world* world )
{
    static const char* const SECTIONS[PLAN_SECTION_COUNT] = { "before",      "substep",   "iteration",
                                                              "substep end", "item loop", "after" };
    static char text[1000];
    text[0] = 0;
    if ( wisp_world_plan_passes( world ) < 0 )
    {
        return "refused";
    }
    for ( int section = 0; section < PLAN_SECTION_COUNT; ++section )
    {
        for ( int wave = 0; wave < world->plan.wave_count[section]; ++wave )
        {
            append_text( text, sizeof( text ), text[0] != 0 ? " " : "" );
            append_text( text, sizeof( text ), wave == 0 ? "[" : "" );
            append_text( text, sizeof( text ), wave == 0 ? SECTIONS[section] : "" );
            append_text( text, sizeof( text ), wave == 0 ? "] " : "" );
            append_wave( text, sizeof( text ), world, section, wave );
        }
    }
    return text;
}

/// Strands with some components, of which others are requested, have this plan.
static inline void assert_plan( wisp_world* world, const char* components, const char* requests, const char* text )
{
    request( world, add_with( world, components ), requests );
    assert_string_equal( plan_text( world ), text );
    wisp_world_destroy( world );
}

#define ASSERT_PLAN( passes, components, requests, text )                                                            \
    assert_plan( OPEN_WORLD( passes ), components, requests, text )

/// Trace since the last call: "a1.0" is pass a on group 0 of entity 1, "a1.0-3" on groups 0 to 2, "a1" an entity
/// pass.
static inline const char* trace_text( void )
{
    static char text[FAKE_TRACE];
    text[0] = 0;
    for ( int i = 0; i < atomic_load( &fake.run_count ); ++i )
    {
        const fake_run* run = fake.runs + i;
        char item[64], range[40] = "";
        bool entity = run->pass->domain == WISP_DOMAIN_ENTITY;
        bool lone = run->span.end == run->span.begin + 1;
        snprintf( range, sizeof( range ), lone ? ".%d" : ".%d-%d", run->span.begin, run->span.end );
        snprintf( item, sizeof( item ), "%s%s%u%s", i > 0 ? " " : "", run->pass->name, run->span.entity.index,
                  entity ? "" : range );
        append_text( text, sizeof( text ), item );
    }
    atomic_store( &fake.run_count, 0 );
    return text;
}

/// Number of runs of a pass since the last trace_text().
static inline int runs_of( const char* pass )
{
    int count = 0;
    for ( int i = 0; i < atomic_load( &fake.run_count ); ++i )
    {
        count += strcmp( fake.runs[i].pass->name, pass ) == 0 ? 1 : 0;
    }
    return count;
}
