/// Balls of cloth that fall, swing and dent, with boundary particles on them.
#pragma once

#include "surface_fixture.h"

#include "boundary.h"

typedef struct ball_world
{
    test_host host;
    test_log log;
    wisp_world* world;
    wisp_entity ball;
    test_mesh mesh;
} ball_world;

static inline wisp_entity add_ball( ball_world* b, const test_mesh* mesh )
{
    static const int32_t PINS[] = { 0, 2 };
    const wisp_fabric_def fabric = test_fabric_def( mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = PINS;
    surface.pin_count = WISP_COUNT( PINS );
    const wisp_entity e = test_surface_of( b->world, &fabric, surface );
    SET( b->world, e, cloth, d.internal_damping = 0.0f );
    assert_int_equal( wisp_set_gravity( b->world, e, ( wisp_vec3 ){ 0.0f, -9.81f, 0.0f } ), WISP_OK );
    assert_int_equal( wisp_request( b->world, e, WISP_SURFACE_POINTS ), WISP_OK );
    return e;
}

static inline ball_world* ball_open( int level, int workers, const char* isa )
{
    static const wisp_module* const MODULES[] = { &wisp_boundary_module, &wisp_cloth_module };
    ball_world* b = checked_calloc( 1, sizeof( ball_world ) );
    wisp_world_def def = wisp_default_world_def();
    def.modules = MODULES;
    def.module_count = WISP_COUNT( MODULES );
    def.allocator = test_host_allocator( &b->host );
    def.log = test_log_write;
    def.log_user = &b->log;
    def.workers = workers;
    def.isa = isa;
    def.substeps = 2;
    assert_int_equal( wisp_world_create( &def, &b->world, NULL ), WISP_OK );
    b->mesh = test_ball( level );
    b->ball = add_ball( b, &b->mesh );
    return b;
}

static inline void ball_close( ball_world** local )
{
    ball_world* b = *local;
    wisp_world_destroy( b->world );
    assert_host_memory_is_released( &b->host );
    test_mesh_free( &b->mesh );
    free( b );
}

static inline void ball_steps( ball_world* b, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( wisp_world_step( b->world, 1.0f / 60.0f ) != WISP_OK )
        {
            fail_msg( "no step: %s", wisp_world_message( b->world ) );
        }
    }
}

static inline wisp_boundary_def ball_layer( float spacing )
{
    wisp_boundary_def def = wisp_default_boundary_def();
    def.spacing = spacing;
    return def;
}

static inline void set_layer( ball_world* b, wisp_entity e, const wisp_boundary_def* def )
{
    if ( wisp_set_boundary( b->world, e, def ) != WISP_OK )
    {
        fail_msg( "no layer: %s", wisp_world_message( b->world ) );
    }
}

static inline wisp_boundary_view layer_of( ball_world* b, wisp_entity e )
{
    wisp_boundary_view view;
    assert_int_equal( wisp_read_boundary( b->world, e, &view ), WISP_OK );
    return view;
}

static inline wisp_boundary_stats stats_of( ball_world* b, wisp_entity e )
{
    wisp_boundary_stats stats;
    assert_int_equal( wisp_read_boundary_stats( b->world, e, &stats ), WISP_OK );
    return stats;
}

static inline uint64_t layer_hash_bytes( uint64_t seed, const void* bytes, size_t size )
{
    const unsigned char* p = bytes;
    uint64_t hash = seed;
    for ( size_t i = 0; i < size; ++i )
    {
        hash = ( hash ^ p[i] ) * 0x100000001b3u; // FNV-1a
    }
    return hash;
}

/// Hash of all outputs of a layer.
static inline uint64_t layer_hash( ball_world* b, wisp_entity e )
{
    const wisp_boundary_view view = layer_of( b, e );
    const wisp_samples* s = view.samples;
    const size_t bytes = (size_t)s->count * 4 * sizeof( float );
    const int32_t counts[3] = { s->count, s->edge_count, s->changed_elements };
    uint64_t hash = layer_hash_bytes( 0xcbf29ce484222325u, counts, sizeof( counts ) );
    hash = layer_hash_bytes( hash, s->xyzw, bytes );
    hash = layer_hash_bytes( hash, s->normals, bytes );
    hash = layer_hash_bytes( hash, s->parents, bytes );
    hash = layer_hash_bytes( hash, s->weights, bytes );
    return layer_hash_bytes( hash, view.edges, (size_t)view.edge_count * 2 * sizeof( int32_t ) );
}
