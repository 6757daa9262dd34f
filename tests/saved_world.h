/// Snapshots of worlds.
#pragma once

#include "unit.h"

#include "wisp/wisp.h"

typedef struct saved_world
{
    void* bytes; ///< for free()
    size_t size;
} saved_world;

static inline saved_world save_world( wisp_world* world )
{
    saved_world saved = { .size = wisp_world_snapshot_size( world ) };
    saved.bytes = checked_malloc( saved.size );
    assert_int_equal( wisp_world_snapshot( world, saved.bytes, saved.size ), WISP_OK );
    return saved;
}
