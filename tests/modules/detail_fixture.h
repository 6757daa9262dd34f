/// Shared by the tests of levels of detail: worlds of all modules, a sheet that hangs by two corners, and rigid motions.
#pragma once

#include "effects_fixture.h"

#include "passes.h"
#include "wisp/detail.h"

static const float FRAME = 1.0f / 60.0f; // s

enum
{
    SIDE = 33, // vertices along a side of a sheet of a metre
};

static inline void open_levels( hosted* h, int substeps, int workers )
{
    OPEN( h, EFFECTS, .substeps = substeps, .workers = workers );
}

/// A level sheet that falls about two of its corners.
static inline wisp_entity add_sheet( wisp_world* world, bool has_coarse_sheets )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( SIDE, 1.0f / (float)( SIDE - 1 ) );
    const int32_t pins[2] = { 0, SIDE - 1 };
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.bend_links = true;
    fabric.coarse_sheets = has_coarse_sheets;
    fabric.attachments = pins;
    fabric.attachment_count = 2;
    wisp_surface_def surface = support_weightless_surface_def();
    surface.area_density = 0.2f;
    surface.pins = pins;
    surface.pin_count = 2;
    const wisp_cloth_def cloth = undamped_cloth();
    const wisp_entity e = add_cloth( world, &fabric, surface, &cloth, EARTH );
    assert_status( world, wisp_set_damping( world, e, 0.5f ), WISP_OK );
    return e;
}

static inline void set_level( wisp_world* world, wisp_entity e, wisp_detail level )
{
    wisp_detail_def def = wisp_default_detail_def();
    def.level = level;
    assert_status( world, wisp_set_detail( world, e, &def ), WISP_OK );
}

/// A change of the level is under way.
static inline bool is_blending( wisp_world* world, wisp_entity e )
{
    const passes_detail* d = wisp_world_column( world, e, wisp_world_find_component( world, "detail.state" ), 0 );
    return d != NULL && ( d->elapsed < d->blend_steps || d->active != d->level );
}

static inline int items_of( const wisp_world* world, const char* pass )
{
    const wisp_profile profile = wisp_world_profile( world );
    int items = -1;
    for ( int i = 0; i < profile.count; ++i )
    {
        items = strcmp( profile.lines[i].pass, pass ) == 0 ? profile.lines[i].items : items;
    }
    return items;
}

static inline wisp_component points_of( wisp_world* world, wisp_entity e )
{
    return wisp_has_strands( world, e ) ? WISP_STRAND_POINTS : WISP_SURFACE_POINTS;
}

static inline const wisp_vec3* points_now( wisp_world* world, wisp_entity e, int* count )
{
    const wisp_view view = view_of( world, e, points_of( world, e ) );
    *count = view.count;
    return view.data;
}

/// Make a step. @return the largest displacement of a vertex in it
static inline float step_and_measure( wisp_world* world, wisp_entity e )
{
    int count;
    const wisp_vec3* now = points_now( world, e, &count );
    SCOPED( free_local ) wisp_vec3* before = checked_calloc( (size_t)count, sizeof( *before ) );
    memcpy( before, now, (size_t)count * sizeof( *before ) );
    run_steps( world, 1, FRAME );
    now = points_now( world, e, &count );
    float most = 0.0f;
    for ( int v = 0; v < count; ++v )
    {
        const float moved = distance( before[v], now[v] );
        most = moved <= most ? most : moved;
    }
    return most;
}

static inline void set_level_at_once( wisp_world* world, wisp_entity e, wisp_detail level )
{
    SET( world, e, detail, d.level = level, d.blend_steps = 0 );
}

static inline wisp_entity add_effect( wisp_world* world, effect_setup* setup )
{
    const wisp_entity e = setup( world );
    assert_status( world, wisp_request( world, e, points_of( world, e ) ), WISP_OK );
    return e;
}

static inline wisp_vec3* copy_points( wisp_world* world, wisp_entity e, int* count )
{
    const wisp_vec3* now = points_now( world, e, count );
    wisp_vec3* copy = checked_calloc( (size_t)*count, sizeof( *copy ) );
    memcpy( copy, now, (size_t)*count * sizeof( *copy ) );
    return copy;
}
