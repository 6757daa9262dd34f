// The passes of a step: vertex normals and points; and points at its start, for modules that read them.
#include "boundary_internal.h"

enum
{
    NORMAL_GRAIN = 16, // slices of eight slots a block: a triangle's normal costs a root and a quotient
};

typedef struct normal_loop
{
    const wisp_kernels* kernels;
    wisp_ring_args args;
    float* xyzw;
} normal_loop;

static void find_normals( void* context, int begin, int end, int worker )
{
    (void)worker;
    const normal_loop* loop = context;
    loop->kernels->ring_mean_normal( &loop->args, begin, end, loop->xyzw );
}

void boundary_find_normals( wisp_frame* frame, const wisp_span* span, void* user )
{
    const boundary_state* state = user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    normal_loop loop = {
        .kernels = wisp_frame_kernels( frame ),
        .args = { .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
                  .ring_begin = fabric->ring_begin,
                  .ring_x4 = fabric->ring_x4 },
        .xyzw = wisp_frame_column( frame, span->entity, state->normals, 0 ),
    };
    wisp_parallel_for( wisp_frame_parallel( frame, span ), fabric->ring_slice_count, NORMAL_GRAIN, find_normals,
                       &loop );
}

void boundary_place_points( wisp_frame* frame, const wisp_span* span, void* user )
{
    const boundary_state* state = user;
    boundary_layer* layer = boundary_find_layer( state, span->entity );
    const wisp_entity e = span->entity;
    const boundary_settings* s = wisp_frame_column( frame, e, state->settings, 0 );
    const bool local = wisp_frame_has( frame, e, state->local );
    if ( layer->is_early )
    {
        wisp_samples_release( &layer->samples, wisp_parallel_allocator( wisp_frame_parallel( frame, span ) ) );
        layer->is_early = false;
    }
    const wisp_samples_args args = {
        .position = wisp_frame_column( frame, e, WISP_PARTICLE_POSITION, 0 ),
        .normal = wisp_frame_column( frame, e, state->normals, 0 ),
        .edges = layer->edge_slots,
        .edge_count = layer->edge_count,
        .triangles = wisp_frame_fabric( frame, e )->triangles,
        .triangle_count = layer->triangle_count,
        .edge_spacing = local ? wisp_frame_column( frame, e, state->edges, BOUNDARY_SPACING ) : NULL,
        .triangle_spacing = local ? wisp_frame_column( frame, e, state->triangles, BOUNDARY_SPACING ) : NULL,
        .spacing = s->spacing,
        .policy = (wisp_spacing)s->policy,
        .rounding = (wisp_rounding)s->rounding,
        .hysteresis = s->hysteresis,
        .limit = s->limit,
        .edge_length = wisp_frame_column( frame, e, state->edges, BOUNDARY_EXTENT ),
        .edge_points = wisp_frame_column( frame, e, state->edges, BOUNDARY_POINTS ),
        .triangle_extent = wisp_frame_column( frame, e, state->triangles, BOUNDARY_EXTENT ),
        .triangle_axis = wisp_frame_column( frame, e, state->triangles, BOUNDARY_AXIS ),
        .triangle_points = wisp_frame_column( frame, e, state->triangles, BOUNDARY_POINTS ),
    };
    const wisp_status status = wisp_samples_update( &layer->samples, wisp_frame_parallel( frame, span ),
                                                    wisp_frame_kernels( frame ), &args );
    if ( status != WISP_OK )
    {
        wisp_frame_fail( frame, status, "boundary: out of memory for the %.0f points of entity %u",
                         layer->samples.requested, e.index );
    }
    layer->made = true;
}

// The points of the start of the step are a function of columns alone: the same after a restore, or after the host has moved the
// surface, and there in the first step.
void boundary_share_points( wisp_frame* frame, const wisp_span* span, void* user )
{
    const boundary_state* state = user;
    boundary_find_normals( frame, span, user );
    if ( wisp_frame_has( frame, span->entity, state->local ) )
    {
        boundary_find_spacing( frame, span, user );
    }
    boundary_place_points( frame, span, user );
}
