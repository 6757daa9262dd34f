// Memory of one cooked thing, and a rest shape read into it.
#include "guide_internal.h"

#include <string.h>

void* guide_take( guide_memory* memory, size_t count, size_t element )
{
    WISP_ASSERT( memory->count < GUIDE_MAX_BLOCKS );
    const size_t bytes = ( count > 0 ? count : 1 ) * element;
    void* block = memory->allocator->allocate( memory->allocator->user, bytes, 64 );
    if ( block == NULL )
    {
        memory->failed = true;
        return NULL;
    }
    memset( block, 0, bytes );
    memory->blocks[memory->count] = block;
    memory->bytes[memory->count++] = bytes;
    return block;
}

void guide_give_back( guide_memory* memory )
{
    for ( int i = 0; i < memory->count; ++i )
    {
        memory->allocator->release( memory->allocator->user, memory->blocks[i], memory->bytes[i] );
    }
    memory->count = 0;
}

size_t guide_memory_bytes( const guide_memory* memory )
{
    size_t bytes = 0;
    for ( int i = 0; i < memory->count; ++i )
    {
        bytes += memory->bytes[i];
    }
    return bytes;
}

bool guide_read_shape( wisp_world* world, wisp_entity strands, guide_memory* memory, guide_shape* shape )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const float* rows = wisp_world_column( world, strands, WISP_STRAND_REST, 0 );
    shape->topology = t;
    shape->points = guide_take( memory, (size_t)t->vertex_count, sizeof( wisp_vec3 ) );
    for ( int lane = 0; lane < t->group_count * WISP_LANES && shape->points != NULL; ++lane )
    {
        const float* from = rows + (size_t)t->group_row[lane / WISP_LANES] * GUIDE_ROW + lane % WISP_LANES;
        for ( int i = 0; i < t->lane_count[lane]; ++i, from += GUIDE_ROW )
        {
            shape->points[t->offsets[t->lane_strand[lane]] + i] =
                ( wisp_vec3 ){ from[0], from[WISP_LANES], from[2 * WISP_LANES] };
        }
    }
    return shape->points != NULL;
}
