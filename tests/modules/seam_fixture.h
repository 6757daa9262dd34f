/// Shared by the tests of seams: worlds with planes of loose vertices or cloth, and seams between them.
#pragma once

#include "cloth_fixture.h"

#include "seams.h"

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

static inline wisp_seam_pair pair_of( wisp_world* world, wisp_entity seam, int number )
{
    wisp_seam_pair pairs[256];
    assert_true( number < 256 );
    assert_status( world, wisp_read_seam_pairs( world, seam, pairs, number + 1 ), WISP_OK );
    return pairs[number];
}

/// Row of a vertex in a column of particles.
static inline float* row_of( wisp_world* world, wisp_entity e, wisp_component component, int vertex )
{
    float* column = wisp_world_column( world, e, component, 0 );
    assert_non_null( column );
    return column + (size_t)wisp_world_fabric( world, e )->vertex_slot[vertex] * 4;
}
