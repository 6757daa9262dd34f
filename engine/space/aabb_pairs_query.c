// Queries of a grid of boxes (aabb_pairs_grid.c): runs of slots, compared with groups of query boxes.
#include "box_search.h"

#include <string.h>

enum
{
    MAX_RUNS = 64, // passed to a kernel at once
};

static int eights( int count )
{
    return ( count + WISP_SLICE - 1 ) & ~( WISP_SLICE - 1 );
}

static void overlap_scalar( const wisp_aabb_stream* s, const int32_t* runs, int run_count, wisp_aabb_group* group )
{
    for ( int l = 0; l < group->count; ++l )
    {
        const float* box = group->box[l];
        group->found[l] = l > 0 ? group->found[l - 1] + group->found_count[l - 1] + WISP_SLICE : group->found[0];
        int32_t *found = group->found[l], count = group->found_count[l];
        for ( int r = 0; r < run_count; ++r )
        {
            const int begin = runs[2 * r], end = begin + eights( runs[2 * r + 1] - begin );
            for ( int j = begin; j < end; j += WISP_SLICE )
            {
                // separate statements, so that a compiler can vectorise them
                int32_t hit[WISP_SLICE];
                for ( int i = 0; i < WISP_SLICE; ++i )
                {
                    int x = ( s->lower[0][j + i] <= box[3] ) & ( box[0] <= s->upper[0][j + i] );
                    int y = ( s->lower[1][j + i] <= box[4] ) & ( box[1] <= s->upper[1][j + i] );
                    int z = ( s->lower[2][j + i] <= box[5] ) & ( box[2] <= s->upper[2][j + i] );
                    hit[i] = x & y & z & ( s->item[j + i] > group->above[l] );
                }
                for ( int i = 0; i < WISP_SLICE; ++i )
                {
                    found[count] = s->item[j + i];
                    count += hit[i];
                }
            }
        }
        group->found_count[l] = count;
    }
}

// Runs of slots to be passed to a kernel.
typedef struct run_list
{
    const box_grid* grid;
    box_question* question;
    int count;
    int slots;   // of all runs, rounded up to groups of eight
    int covered; // slots below this are done
    int32_t runs[2 * MAX_RUNS];
} run_list;

static void compare_runs( run_list* list )
{
    const box_grid* grid = list->grid;
    box_question* q = list->question;
    q->tested += (uint64_t)list->slots * (uint64_t)q->group.count;
    if ( grid->kernels != NULL )
    {
        grid->kernels->box_overlap( &grid->stream, list->runs, list->count, &q->group );
    }
    else
    {
        overlap_scalar( &grid->stream, list->runs, list->count, &q->group );
    }
    list->count = list->slots = 0;
}

// Adds a run. Runs are in increasing order and compared in groups of eight slots, so a run that begins in the last
// group of the previous run extends it.
// @return false if there are too many for several queries
static bool add_run( run_list* list, int begin, int end )
{
    int32_t* last = list->runs + 2 * list->count - 2;
    if ( end <= list->covered )
    {
        return true;
    }
    if ( list->count > 0 && begin <= list->covered )
    {
        last[1] = end;
    }
    else
    {
        if ( list->count == MAX_RUNS )
        {
            if ( list->question->group.count > 1 )
            {
                return false;
            }
            compare_runs( list );
        }
        last = list->runs + 2 * list->count;
        last[0] = begin > list->covered ? begin : list->covered;
        last[1] = end;
        ++list->count;
    }
    int covered = last[0] + eights( end - last[0] );
    list->slots += covered - ( last[0] > list->covered ? last[0] : list->covered );
    list->covered = covered;
    return true;
}

static bool query_level( const box_level* level, const wisp_aabb* around, run_list* list )
{
    int first[3], last[3];
    for ( int k = 0; k < 3; ++k )
    {
        float lower = around->lower[k] - level->extent[k];
        if ( around->upper[k] < level->origin[k] || lower > level->end[k] )
        {
            return true;
        }
        first[k] = box_cell_along( level, lower, k );
        last[k] = box_cell_along( level, around->upper[k], k );
    }
    const int fast = level->axis[0], middle = level->axis[1], slow = level->axis[2];
    const int32_t* begin = list->grid->begin + level->cell_first;
    for ( int c = first[slow]; c <= last[slow]; ++c )
    {
        const int32_t* row = begin + c * level->stride[slow] + first[middle] * level->stride[middle];
        for ( int b = first[middle]; b <= last[middle]; ++b, row += level->stride[middle] )
        {
            if ( !add_run( list, row[first[fast]], row[last[fast] + 1] ) )
            {
                return false;
            }
        }
    }
    return true;
}

static wisp_aabb find_box_around( const wisp_aabb_group* group )
{
    wisp_aabb around;
    memcpy( &around, group->box[0], sizeof( around ) );
    for ( int l = 1; l < group->count; ++l )
    {
        for ( int k = 0; k < 3; ++k )
        {
            float lower = group->box[l][k], upper = group->box[l][3 + k];
            around.lower[k] = lower < around.lower[k] ? lower : around.lower[k];
            around.upper[k] = upper > around.upper[k] ? upper : around.upper[k];
        }
    }
    return around;
}

bool box_grid_find( const box_grid* grid, box_question* question )
{
    run_list list;
    list.grid = grid;
    list.question = question;
    list.count = list.slots = list.covered = 0;
    const wisp_aabb around = find_box_around( &question->group );
    for ( int level = 0; level < grid->level_count; ++level )
    {
        if ( !query_level( grid->levels + level, &around, &list ) )
        {
            return false;
        }
    }
    if ( question->group.count > 1 && list.slots > WISP_MAX_SHARED_AABBS )
    {
        return false;
    }
    if ( list.count > 0 )
    {
        compare_runs( &list );
    }
    return true;
}
