/// The engine's workers, kernels and memory for something that is measured outside of a module: a world without
/// effects, whose one pass calls back.
#pragma once

#include "wisp/module/module.h"

typedef wisp_status contact_probe_fn( void* context, const wisp_parallel* parallel, const wisp_kernels* kernels,
                                      wisp_error* error );

typedef struct contact_probe
{
    wisp_world* world;
    wisp_entity entity;
} contact_probe;

wisp_status contact_probe_open( int workers, contact_probe* out, wisp_error* error );
/// Memory of its parallel loops, to release what was filled there.
const wisp_allocator* contact_probe_allocator( const contact_probe* probe );
void contact_probe_close( contact_probe* probe );
/// Call once, within a step, with all workers.
wisp_status contact_probe_run( contact_probe* probe, contact_probe_fn* run, void* context, wisp_error* error );
