// How deep a surface is in bodies when the step is done. Measured afresh, so it also sees what the contacts missed.
#include "collision_internal.h"

#include <math.h>

enum
{
    CHUNK = WISP_PARTICLE_BLOCK,
};

static const wisp_collision_figures NOTHING = { .vertex = -1 };

typedef struct measure_loop
{
    const wisp_fabric* fabric;
    const float* position;
    wisp_collision_figures figures;
    int slots[CHUNK];
    wisp_mesh_query queries[CHUNK];
    wisp_surface_point nearest[CHUNK];
    bool is_near[CHUNK];
} measure_loop;

static void measure_chunk( measure_loop* loop, const collision_view* view, int begin, int end )
{
    int n = 0;
    for ( int slot = begin; slot < end; ++slot )
    {
        const float* quad = loop->position + (size_t)slot * 4;
        if ( quad[3] > 0.0f )
        {
            loop->slots[n] = slot;
            loop->queries[n++] = ( wisp_mesh_query ){
                wisp_rigid_to_body( view->after, collision_load( quad ) ),
                view->thickness,
            };
        }
    }
    collision_closest( view->body, loop->queries, n, loop->nearest, loop->is_near );
    for ( int i = 0; i < n; ++i )
    {
        float depth = loop->is_near[i] ? view->thickness - loop->nearest[i].distance : 0.0f;
        if ( depth > loop->figures.penetration )
        {
            loop->figures.penetration = depth;
            loop->figures.thickness = view->thickness;
            loop->figures.vertex = loop->fabric->slot_vertex[loop->slots[i]];
        }
    }
}

static void count_contacts( wisp_frame* frame, const wisp_span* span, const collision_state* state,
                            measure_loop* loop )
{
    const int32_t* count = wisp_frame_column( frame, span->entity, state->contact, 0 );
    collision_contact( *contact )[WISP_COLLISION_CONTACTS] =
        wisp_frame_column( frame, span->entity, state->contact, 2 );
    for ( int slot = 0; slot < loop->fabric->vertex_count; ++slot )
    {
        int used = count[slot] < WISP_COLLISION_CONTACTS ? count[slot] : WISP_COLLISION_CONTACTS;
        bool pressed = false;
        for ( int i = 0; i < used; ++i )
        {
            pressed = pressed || contact[slot][i].pushed > 0.0f;
        }
        loop->figures.contacts += pressed ? 1 : 0;
        loop->figures.dropped += count[slot] - used;
    }
}

void collision_measure( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    measure_loop loop;
    loop.fabric = wisp_frame_fabric( frame, span->entity );
    loop.position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    loop.figures = NOTHING;
    collision_view view;
    for ( int next = 0; collision_next( frame, span, state, &next, &view ); )
    {
        for ( int begin = 0; begin < loop.fabric->vertex_count; begin += CHUNK )
        {
            int left = loop.fabric->vertex_count - begin;
            measure_chunk( &loop, &view, begin, begin + ( left < CHUNK ? left : CHUNK ) );
        }
    }
    count_contacts( frame, span, state, &loop );
    *(wisp_collision_figures*)wisp_frame_column( frame, span->entity, state->figures, 0 ) = loop.figures;
}

// ---- the public face ----

static wisp_status find_settings( wisp_world* world, wisp_entity surface, collision_state** state,
                                  collision_settings** out )
{
    wisp_status status = collision_find_state( world, state );
    if ( status != WISP_OK )
    {
        return status;
    }
    *out = wisp_world_column( world, surface, ( *state )->settings, 0 );
    return *out != NULL ? WISP_OK
                        : wisp_world_fail( world, WISP_CONFLICT, "entity %u has no collision", surface.index );
}

wisp_status wisp_want_collision_figures( wisp_world* world, wisp_entity surface, bool wanted )
{
    collision_state* state;
    collision_settings* settings;
    wisp_status status = find_settings( world, surface, &state, &settings );
    if ( status != WISP_OK )
    {
        return status;
    }
    int32_t before = settings->figures;
    settings->figures = wanted ? 1 : 0;
    status = collision_dress_surfaces( world, state );
    if ( status != WISP_OK )
    {
        settings->figures = before;
    }
    return status;
}

wisp_status wisp_read_collision_figures( wisp_world* world, wisp_entity surface, wisp_collision_figures* out )
{
    *out = NOTHING;
    collision_state* state;
    collision_settings* settings;
    wisp_status status = find_settings( world, surface, &state, &settings );
    if ( status == WISP_OK && settings->figures == 0 )
    {
        status = wisp_world_fail( world, WISP_CONFLICT,
                                  "entity %u takes no figures of collision: ask with wisp_want_collision_figures",
                                  surface.index );
    }
    const wisp_collision_figures* column =
        status == WISP_OK ? wisp_world_column( world, surface, state->figures, 0 ) : NULL;
    if ( column != NULL && column->thickness > 0.0f )
    {
        *out = *column;
    }
    else if ( column != NULL )
    {
        *out = ( wisp_collision_figures ){ .vertex = -1, .contacts = column->contacts, .dropped = column->dropped };
    }
    return status;
}
