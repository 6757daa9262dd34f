/// Shared by the tests of seams: worlds with planes of loose vertices or cloth, and seams between them.
#pragma once

#include "cloth_fixture.h"

#include "seams_state.h"

#include <math.h>
#include <stdlib.h>

static inline hosted* open_sewing( int substeps, int iterations, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_seams_module };
    return new_hosted( MODULES, WISP_COUNT( MODULES ), substeps, iterations, workers );
}

static inline void close_sewing( hosted* h )
{
    void* state = h;
    close_hosted( &state );
}

/// A surface of a mesh whose points are requested, without cloth unless given.
static inline wisp_entity add_panel( wisp_world* world, const test_mesh* mesh, wisp_surface_def surface,
                                     const wisp_cloth_def* cloth )
{
    wisp_fabric_def fabric = test_fabric_def( mesh );
    const wisp_entity e = test_surface_of( world, &fabric, surface );
    if ( cloth != NULL )
    {
        assert_status( world, wisp_set_cloth( world, e, cloth ), WISP_OK );
    }
    assert_status( world, wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    return e;
}

static inline wisp_entity sew( wisp_world* world, const wisp_seam_def* def )
{
    wisp_entity seam;
    assert_status( world, wisp_add_seam( world, def, &seam ), WISP_OK );
    return seam;
}

static inline void step_for( wisp_world* world, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        assert_status( world, wisp_world_step( world, 1.0f / 60.0f ), WISP_OK );
    }
}

/// A pair of a seam, at the end of the last step.
typedef struct sewn_pair
{
    int32_t vertices[2]; ///< of `a` and `b`, the user's order
    int row;
    double opening; ///< m
    double force;   ///< N, of the last substep; negative: it pushes
    bool broken;
} sewn_pair;

static inline int compare_pairs( const void* left, const void* right )
{
    const sewn_pair *a = left, *b = right;
    const int first = a->vertices[0] - b->vertices[0], second = a->vertices[1] - b->vertices[1];
    return first != 0 ? first : second != 0 ? second : a->row - b->row;
}

static inline sewn_pair read_pair( wisp_world* world, const seams_state* state, const seam_topology* s, int row )
{
    const wisp_entity surfaces[2] = { s->a, s->b };
    const seam_settings* settings = wisp_world_column( world, s->entity, state->settings, 0 );
    const float* rest = wisp_world_column( world, s->entity, state->pairs, 0 );
    const float* impulse = wisp_world_column( world, s->entity, state->pairs, 1 );
    const int32_t* broken = wisp_world_column( world, s->entity, state->pairs, 2 );
    sewn_pair pair = { .row = row, .broken = broken[row] != 0 };
    const float* x[2];
    float d[3];
    for ( int k = 0; k < 2; ++k )
    {
        const int32_t x4 = s->ends_x4[2 * row + k];
        pair.vertices[k] = wisp_world_fabric( world, surfaces[k] )->slot_vertex[x4 / 4];
        x[k] = (const float*)wisp_world_column( world, surfaces[k], WISP_PARTICLE_POSITION, 0 ) + x4;
    }
    for ( int k = 0; k < 3; ++k )
    {
        d[k] = x[0][k] - x[1][k];
    }
    pair.opening = sqrt( (double)( d[0] * d[0] + d[1] * d[1] + d[2] * d[2] ) );
    pair.force = (double)seams_pull( impulse + 3 * (size_t)row, d, rest[row], settings->inverse_dt2 );
    return pair;
}

/// The pair with this number in the order of its vertices; those of the same vertices are in the order in which they were given.
static inline sewn_pair pair_of( wisp_world* world, wisp_entity entity, int number )
{
    const seams_state* state = wisp_world_module_state( world, "seams" );
    sewn_pair pairs[256];
    const int count = wisp_count_seam_pairs( world, entity );
    assert_true( number < count && count <= 256 );
    for ( int row = 0; row < count; ++row )
    {
        pairs[row] = read_pair( world, state, wisp_find_object( state->seams, entity ), row );
    }
    qsort( pairs, (size_t)count, sizeof( *pairs ), compare_pairs );
    return pairs[number];
}

/// Row of a vertex in a column of particles.
static inline float* row_of( wisp_world* world, wisp_entity e, wisp_component component, int vertex )
{
    float* column = wisp_world_column( world, e, component, 0 );
    assert_non_null( column );
    return column + (size_t)wisp_world_fabric( world, e )->vertex_slot[vertex] * 4;
}
