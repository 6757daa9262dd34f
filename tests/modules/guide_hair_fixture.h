/// Shared by the tests of the engine's guide hair: the scenes of the oracle's tests in a world, moved by hand, with
/// every number rounded to a float before either side uses it.
#pragma once

#include "guide_oracle_fixture.h"
#include "support.h"

#include "frozen_hair.h"
#include "guide_hair.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

#define FRAME ( 1.0f / 60.0f )

/// Settings of the engine. Zero-initialised: one worker, the best instruction set.
typedef struct guide_host
{
    int workers;
    const char* isa;
    wisp_allocator allocator;
} guide_host;

// ---- a module that moves strands inside a step ----

static wisp_component guide_mover_speed;

static inline void guide_mover_run( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const float* speed = wisp_frame_column( frame, span->entity, guide_mover_speed, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    float* position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 );
    for ( int row = t->group_row[span->begin]; row < t->group_row[span->end]; ++row )
    {
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            position[(size_t)row * 48 + (size_t)lane] += wisp_frame_dt( frame, span->entity ) * *speed;
        }
    }
}

static inline wisp_status guide_mover_declare( wisp_registry* r )
{
    static const wisp_column_def columns[] = { WISP_COLUMN_DEF( float, speed, 1 ) };
    guide_mover_speed =
        wisp_declare_component( r, &( wisp_component_def ){ "mover.speed", WISP_TABLE_ENTITY, columns, 1 } );
    return wisp_declare_pass( r, &( wisp_pass ){
                                     WISP_PASS( "mover.move", PREDICT, STRAND_GROUP, guide_mover_run ),
                                     .required = { guide_mover_speed },
                                     .reads = { guide_mover_speed, WISP_STRAND_POSITION },
                                     .writes = { WISP_STRAND_POSITION },
                                 } );
}

static const wisp_module guide_mover_module = { .name = "mover", .declare = guide_mover_declare };

// ---- worlds ----

static inline void guide_forget( void* user, wisp_log_level level, const char* message )
{
    (void)user;
    (void)level;
    (void)message;
}

static inline wisp_world* guide_world( const guide_host* host )
{
    static const wisp_module* const modules[] = { &wisp_frozen_hair_module, &wisp_guide_hair_module,
                                                  &guide_mover_module };
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    def.log = guide_forget;
    def.workers = host != NULL && host->workers > 0 ? host->workers : 1;
    def.isa = host != NULL ? host->isa : NULL;
    if ( host != NULL )
    {
        def.allocator = host->allocator;
    }
    wisp_world* world = NULL;
    wisp_error error = { WISP_OK, "" };
    if ( wisp_world_create( &def, &world, &error ) != WISP_OK )
    {
        fail_msg( "no world: %s", error.message );
    }
    return world;
}

static inline void guide_ok( wisp_world* world, wisp_status status )
{
    if ( status != WISP_OK )
    {
        fail_msg( "%s: %s", wisp_status_name( status ), wisp_world_message( world ) );
    }
}

static inline void guide_step( wisp_world* world )
{
    guide_ok( world, wisp_world_step( world, FRAME ) );
}

static inline wisp_vec3 guide_narrow( double3 p )
{
    return ( wisp_vec3 ){ (float)p.x, (float)p.y, (float)p.z };
}

// Volatile, because gcc 12 drops the conversion to floats and back where it vectorises a pair of doubles.
static inline double3 guide_round( double3 p )
{
    const volatile float x = (float)p.x, y = (float)p.y, z = (float)p.z;
    return double3_make( (double)x, (double)y, (double)z );
}

/// Add strands of given lengths, back to back.
static inline wisp_entity guide_add_mixed( wisp_world* world, const double3* nodes, int strands, const int* counts )
{
    SCOPED( free_local ) int32_t* offsets = checked_calloc( (size_t)strands + 1, sizeof( int32_t ) );
    for ( int s = 0; s < strands; ++s )
    {
        offsets[s + 1] = offsets[s] + counts[s];
    }
    SCOPED( free_local ) wisp_vec3* points = checked_calloc( (size_t)offsets[strands] + 1, sizeof( wisp_vec3 ) );
    for ( int n = 0; n < offsets[strands]; ++n )
    {
        points[n] = guide_narrow( nodes[n] );
    }
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = strands;
    wisp_entity entity;
    guide_ok( world, wisp_add_strands( world, &def, &entity ) );
    return entity;
}

static inline wisp_entity guide_add( wisp_world* world, const double3* nodes, int strands, int node_count )
{
    int counts[64];
    assert_true( strands <= 64 );
    for ( int s = 0; s < strands; ++s )
    {
        counts[s] = node_count;
    }
    return guide_add_mixed( world, nodes, strands, counts );
}

static inline const wisp_vec3* guide_points( wisp_world* world, wisp_entity entity )
{
    wisp_view view;
    guide_ok( world, wisp_world_view( world, entity, WISP_STRAND_POINTS, &view ) );
    return view.data;
}

/// Write [3][16] rows in the user's order.
static inline void guide_write( wisp_world* world, wisp_entity entity, wisp_component component,
                                const double3* values )
{
    const wisp_strand_topology* t = wisp_world_strands( world, entity );
    float* rows = wisp_world_column( world, entity, component, 0 );
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        for ( int i = 0; i < t->lane_count[lane]; ++i )
        {
            float* row = rows + (size_t)( t->group_row[lane / WISP_LANES] + i ) * 48 + lane % WISP_LANES;
            const wisp_vec3 p = guide_narrow( values[t->offsets[t->lane_strand[lane]] + i] );
            row[0] = p.x;
            row[16] = p.y;
            row[32] = p.z;
        }
    }
}

/// Turn every root of an entity about an axis. The strand's index times `more` is added to the angle.
static inline void guide_turn_roots( wisp_world* world, wisp_entity entity, double3 axis, double angle, double more )
{
    guide_ok( world, wisp_world_attach( world, entity, WISP_STRAND_ROOT ) );
    const wisp_strand_topology* t = wisp_world_strands( world, entity );
    float* rotation = wisp_world_column( world, entity, WISP_STRAND_ROOT, 1 );
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        const double half = 0.5 * ( angle + more * ( t->lane_strand[lane] > 0 ? t->lane_strand[lane] : 0 ) );
        float* q = rotation + lane / WISP_LANES * 64 + lane % WISP_LANES;
        q[0] = (float)( axis.x * sin( half ) );
        q[16] = (float)( axis.y * sin( half ) );
        q[32] = (float)( axis.z * sin( half ) );
        q[48] = (float)cos( half );
    }
}

// ---- a scene in both ----

/// A scene whose ghosts may have another number of nodes than its targets.
typedef struct flock
{
    scene s;
    int ghost_nodes;
    double3 ghost[MAX_GHOSTS * 2 * NODES];
    double3 x[MAX_TARGETS * NODES], v[MAX_TARGETS * NODES]; // of the frame, as floats
    wisp_world* world;
    wisp_entity targets, ghosts;
} flock;

static inline void guide_end( flock* f )
{
    wisp_world_destroy( f->world );
}

// A point of a polyline at a fraction of its segments.
static inline double3 guide_along( const double3* nodes, int count, double fraction )
{
    const double at = fraction * ( count - 1 );
    const int k = at < count - 2 ? (int)at : count - 2;
    return double3_add( nodes[k], double3_scale( at - k, double3_sub( nodes[k + 1], nodes[k] ) ) );
}

static inline flock guide_flock( const guide_host* host, int targets, int ghosts_a_target, int ghost_nodes )
{
    flock f = { .s = make_scene( targets, ghosts_a_target ), .ghost_nodes = ghost_nodes };
    for ( int n = 0; n < targets * NODES; ++n )
    {
        f.s.target[n] = f.s.x[n] = guide_round( f.s.target[n] );
    }
    for ( int g = 0; g < f.s.ghost_count; ++g )
    {
        for ( int i = 0; i < ghost_nodes; ++i )
        {
            const double3* strand = f.s.ghost + g * NODES;
            const double3 p =
                ghost_nodes == NODES ? strand[i] : guide_along( strand, NODES, (double)i / ( ghost_nodes - 1 ) );
            f.ghost[g * ghost_nodes + i] = guide_round( p );
        }
    }
    f.world = guide_world( host );
    f.targets = guide_add( f.world, f.s.target, targets, NODES );
    f.ghosts = guide_add( f.world, f.ghost, f.s.ghost_count, ghost_nodes );
    guide_ok( f.world, wisp_world_attach( f.world, f.targets, WISP_STRAND_VELOCITY ) );
    guide_ok( f.world, wisp_request( f.world, f.ghosts, WISP_STRAND_POINTS ) );
    return f;
}

static inline void guide_follow( flock* f, wisp_ghosts_def def )
{
    def.targets = f->targets;
    guide_ok( f->world, wisp_set_ghosts( f->world, f->ghosts, &def ) );
}

/// Give the same rounded targets to the engine and the caller.
static inline void guide_place( flock* f, const double3* x, const double3* v )
{
    for ( int n = 0; n < f->s.target_count * NODES; ++n )
    {
        f->x[n] = guide_round( x[n] );
        f->v[n] = guide_round( v[n] );
    }
    guide_write( f->world, f->targets, WISP_STRAND_POSITION, f->x );
    guide_write( f->world, f->targets, WISP_STRAND_VELOCITY, f->v );
}

/// Advance the swinging head by one frame, and the engine by one step.
static inline void guide_swing( flock* f )
{
    swing( &f->s, 8 );
    guide_place( f, f->s.x, f->s.v );
    guide_step( f->world );
}

static inline double3 guide_ghost( const flock* f, int ghost, int node )
{
    const wisp_vec3 p = guide_points( f->world, f->ghosts )[ghost * f->ghost_nodes + node];
    return double3_make( (double)p.x, (double)p.y, (double)p.z );
}

/// Defaults without weights.
static inline wisp_ghosts_def guide_without_weights( void )
{
    wisp_ghosts_def def = wisp_default_ghosts_def();
    def.elastic = WISP_GHOST_ELASTIC_OFF;
    def.tip_gain = def.centre_gain = 0.0f;
    return def;
}

/// The oracle of ghosts that follow by this definition.
static inline guide_oracle guide_oracle_of( const flock* f, const wisp_ghosts_def* def )
{
    guide_oracle_options o = guide_oracle_default_options();
    o.pairing = def->resample ? GUIDE_ORACLE_PAIRING_SPLINE : GUIDE_ORACLE_PAIRING_NODE;
    o.link_count = def->target_count;
    o.dt = (double)FRAME;
    o.tau = def->time > 0.0f ? (double)def->time : (double)FRAME;
    o.elastic_gain = def->elastic == WISP_GHOST_ELASTIC_OFF ? 0.0 : 1.0;
    o.frame = GUIDE_ORACLE_FRAME_PARALLEL;
    o.tip_gain = (double)def->tip_gain;
    o.centre_gain = (double)def->centre_gain;
    o.use_spread = def->spread != 1.0f;
    o.spread = (double)def->spread;
    o.repair_lengths = def->repair_length;
    const guide_oracle_def strands = { f->s.target_count, NODES, f->s.ghost_count, f->ghost_nodes, f->s.target,
                                       f->ghost,          NULL };
    guide_oracle hair;
    wisp_error error = { 0 };
    assert_ok( guide_oracle_create( &strands, &o, &hair, &error ), error );
    return hair;
}
