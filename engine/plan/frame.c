// Callbacks of a pass: the columns, substeps and fractions of a frame, its kernels, memory and counters.
#include "execute_parts.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static store_entity* entity_of( const wisp_frame* frame, wisp_entity entity )
{
    return frame->registry->store->entities + entity.index - 1;
}

void* wisp_frame_column( wisp_frame* frame, wisp_entity entity, wisp_component component, int column )
{
    return store_column( frame->registry->store, entity_of( frame, entity ), component, column );
}

bool wisp_frame_has( wisp_frame* frame, wisp_entity entity, wisp_component component )
{
    return store_mask_has( &entity_of( frame, entity )->components, component );
}

wisp_vec3 wisp_frame_offset( wisp_frame* frame, wisp_entity entity )
{
    return entity_of( frame, entity )->offset;
}

wisp_vec3 wisp_frame_between( wisp_frame* frame, wisp_entity from, wisp_entity to )
{
    return store_between( entity_of( frame, from ), entity_of( frame, to ) );
}

const wisp_strand_topology* wisp_frame_strands( wisp_frame* frame, wisp_entity entity )
{
    return entity_of( frame, entity )->strands;
}

const wisp_fabric* wisp_frame_fabric( wisp_frame* frame, wisp_entity entity )
{
    return entity_of( frame, entity )->fabric;
}

const struct wisp_samples* wisp_frame_samples( wisp_frame* frame, wisp_entity surface )
{
    return entity_of( frame, surface )->samples;
}

wisp_span wisp_frame_particles( wisp_frame* frame, const wisp_span* span )
{
    int count = entity_of( frame, span->entity )->rows[WISP_TABLE_PARTICLE].count;
    int end = span->end * WISP_PARTICLE_BLOCK;
    wisp_span particles = *span;
    particles.begin = span->begin * WISP_PARTICLE_BLOCK;
    particles.end = end < count ? end : count;
    return particles;
}

int execute_substeps( const wisp_frame* frame, int slot )
{
    return plan_substeps_of_rate( frame->registry, plan_rate( frame->plan->entities + slot, frame->registry ),
                                  frame->substeps );
}

// What a substep of the world has of something, for a substep of an entity.
static float in_substep( const wisp_frame* frame, wisp_entity entity, float of_world )
{
    const plan_entity* e = frame->plan->entities + entity.index - 1;
    return e->fewer > 0 && frame->substeps > 0
               ? of_world * (float)frame->substeps / (float)wisp_frame_substeps( frame, entity )
               : of_world / (float)e->split;
}

float wisp_frame_dt( const wisp_frame* frame, wisp_entity entity )
{
    return frame->even > 0.0f ? frame->even / (float)wisp_frame_substeps( frame, entity )
                              : in_substep( frame, entity, frame->seconds );
}

int wisp_frame_substeps( const wisp_frame* frame, wisp_entity entity )
{
    return execute_substeps( frame, (int)entity.index - 1 );
}

float wisp_frame_progress( const wisp_frame* frame, wisp_entity entity, int substeps )
{
    const float progress = in_substep( frame, entity, frame->progress ) * (float)substeps;
    return frame->progress == 0.0f ? (float)substeps / (float)wisp_frame_substeps( frame, entity )
           : progress < 1.0f       ? progress
                                   : 1.0f;
}

float wisp_frame_progress_left( const wisp_frame* frame, wisp_entity entity, int substep )
{
    const float progress = in_substep( frame, entity, frame->progress );
    const float left = 1.0f - progress * (float)substep;
    return progress == 0.0f  ? 1.0f / (float)( wisp_frame_substeps( frame, entity ) - substep )
           : left > progress ? progress / left
                             : 1.0f;
}

wisp_transform wisp_frame_reached( const wisp_frame* frame, wisp_transform from, wisp_transform to )
{
    const bool is_there = frame->reached == 1.0f || memcmp( &from, &to, sizeof( from ) ) == 0;
    return is_there ? to : wisp_transform_interpolate( from, to, frame->reached );
}

int wisp_frame_iterations( const wisp_frame* frame )
{
    return frame->iterations;
}

bool wisp_frame_is_halted( wisp_frame* frame, wisp_entity entity )
{
    const store_entity* e = entity_of( frame, entity );
    return e->halted != 0 || e->sleep != STORE_AWAKE || e->detail.level == WISP_DETAIL_NOTHING;
}

wisp_detail_frame wisp_frame_detail( wisp_frame* frame, wisp_entity entity )
{
    return entity_of( frame, entity )->detail;
}

bool wisp_frame_is_asleep( wisp_frame* frame, wisp_entity entity )
{
    return entity_of( frame, entity )->sleep != STORE_AWAKE;
}

void wisp_frame_halt( wisp_frame* frame, wisp_entity entity, const char* message )
{
    entity_of( frame, entity )->halted = 1; // only passes that run on the entity halt it, one at a time
    wisp_frame_count( frame, WISP_COUNT_HALTED, 1 );
    if ( atomic_flag_test_and_set( &frame->halting ) == false )
    {
        snprintf( frame->halted_message, sizeof( frame->halted_message ), "%s", message );
    }
}

const wisp_kernels* wisp_frame_kernels( wisp_frame* frame )
{
    return frame->kernels;
}

const wisp_parallel* wisp_frame_parallel( wisp_frame* frame, const wisp_span* span )
{
    return frame->wide ? jobs_everyone( frame->pool ) : jobs_alone( frame->pool, span->worker );
}

void* wisp_frame_workspace( wisp_frame* frame, int workspace, int worker )
{
    const plan_workspace* w = frame->registry->workspaces + workspace;
    return (char*)w->blocks + (size_t)worker * w->size;
}

uint64_t wisp_frame_step( wisp_frame* frame )
{
    return frame->step;
}

void wisp_frame_fail( wisp_frame* frame, wisp_status status, const char* format, ... )
{
    if ( atomic_flag_test_and_set( &frame->failing ) )
    {
        return; // keep the first message
    }
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( frame->error.message, sizeof( frame->error.message ), format, arguments );
    va_end( arguments );
    frame->error.status = status;
    atomic_store( &frame->failed, true );
}

void wisp_frame_count( wisp_frame* frame, wisp_counter counter, uint64_t amount )
{
    atomic_fetch_add_explicit( frame->counters + counter, amount, memory_order_relaxed );
}
