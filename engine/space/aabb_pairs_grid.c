// Search by grids, one level per range of box sizes. A box is stored in the cell of its lower corner. A query
// visits the cells that can contain the lower corner of an overlapping box. Both corners are rounded in the same
// way, and rounding is monotonic, so no box is missed and no margin is needed. A level holds sizes of two octaves,
// or a few boxes of any size. Its cells are as wide as its largest box, or a quarter of that along the axis with
// most cells.
#include "box_search.h"

#include <string.h>

enum
{
    OCTAVES = 256,     // box sizes, by the exponent of a float
    MAX_FLAT = 16,     // up to this many boxes share one cell
    CELLS_PER_BOX = 2, // more cells would be empty and cost more to clear than they save
    SLOT_PADDING = 8,  // slots after the last one that a wide load may read
    SIDE_PER_CELL = 4, // cells per box along the fastest axis, where narrow cells need no further runs
};

static const double MAX_CELLS = 1 << 30;
static const double MAX_SIDE = 1 << 22; // cells along an axis must be exact in float too

// Bounds of a group of boxes.
typedef struct box_span
{
    int count;
    float lower[3], upper[3]; // bounds of the lower corners
    float extent[3];          // maximum of the boxes
} box_span;

static const box_span NO_SPAN = { 0, { FLT_MAX, FLT_MAX, FLT_MAX }, { -FLT_MAX, -FLT_MAX, -FLT_MAX }, { 0, 0, 0 } };

typedef struct box_survey
{
    box_span span;
    int32_t octaves[OCTAVES]; // number of boxes per size
} box_survey;

// Data shared by the loops of a build.
typedef struct box_grid_builder
{
    box_grid* grid;
    const wisp_aabb* boxes;
    int box_count;
    box_survey* surveys;                 // [block]
    box_span ( *spans )[MAX_BOX_LEVELS]; // [block]
    int level_of[OCTAVES];
    int32_t* cell_of; // [box] octave of its size, later its cell; -1 if it overlaps nothing
    int32_t* begin;
    float *lower[3], *upper[3];
    int32_t* item;
} box_grid_builder;

// ---- sizes ----

static float size_along( const wisp_aabb* box, int axis )
{
    return box->upper[axis] - box->lower[axis];
}

static int octave_of( const wisp_aabb* box )
{
    float x = size_along( box, 0 ), y = size_along( box, 1 ), z = size_along( box, 2 );
    float size = x > y ? x : y;
    size = size > z ? size : z;
    uint32_t bits;
    memcpy( &bits, &size, sizeof( bits ) );
    return (int)( bits >> 23 & 0xffu );
}

static void add_box( box_span* span, const wisp_aabb* box )
{
    ++span->count;
    for ( int k = 0; k < 3; ++k )
    {
        float size = size_along( box, k ), lower = box->lower[k];
        span->lower[k] = lower < span->lower[k] ? lower : span->lower[k];
        span->upper[k] = lower > span->upper[k] ? lower : span->upper[k];
        span->extent[k] = size > span->extent[k] ? size : span->extent[k];
    }
}

static void join_spans( box_span* span, const box_span* other )
{
    span->count += other->count;
    for ( int k = 0; k < 3; ++k )
    {
        span->lower[k] = fminf( span->lower[k], other->lower[k] );
        span->upper[k] = fmaxf( span->upper[k], other->upper[k] );
        span->extent[k] = fmaxf( span->extent[k], other->extent[k] );
    }
}

static void survey( void* context, int begin, int end, int worker )
{
    (void)worker;
    const box_grid_builder* b = context;
    box_survey* s = b->surveys + begin / BOX_GRAIN;
    memset( s->octaves, 0, sizeof( s->octaves ) );
    box_span span = NO_SPAN;
    for ( int i = begin; i < end; ++i )
    {
        const wisp_aabb* box = b->boxes + i;
        int octave = -1;
        if ( box_is_valid( box ) )
        {
            add_box( &span, box );
            octave = octave_of( box );
            s->octaves[octave] += 1;
        }
        b->cell_of[i] = octave;
    }
    s->span = span;
}

// Assigns sizes to levels, from large to small: two octaves each, or more while boxes are few.
// @return number of levels
static int group_sizes( const int32_t octaves[OCTAVES], int count, int level_of[OCTAVES] )
{
    int level = -1, top = OCTAVES, grouped = 0;
    for ( int o = OCTAVES - 1; o >= 0; --o )
    {
        bool is_last = level == MAX_BOX_LEVELS - 1 || count <= MAX_FLAT;
        bool fits = o >= top - 1 || grouped + octaves[o] <= MAX_FLAT || is_last;
        if ( octaves[o] > 0 && ( level < 0 || !fits ) )
        {
            ++level;
            top = o;
            grouped = 0;
        }
        grouped += octaves[o];
        count -= octaves[o];
        level_of[o] = level;
    }
    return level + 1;
}

static void survey_levels( void* context, int begin, int end, int worker )
{
    (void)worker;
    const box_grid_builder* b = context;
    box_span* spans = b->spans[begin / BOX_GRAIN];
    for ( int level = 0; level < b->grid->level_count; ++level )
    {
        spans[level] = NO_SPAN;
    }
    for ( int i = begin; i < end; ++i )
    {
        if ( b->cell_of[i] >= 0 )
        {
            add_box( spans + b->level_of[b->cell_of[i]], b->boxes + i );
        }
    }
}

// ---- cells ----

// Widens cells in steps of a quarter until their number is within the limit.
static void choose_box_cells( box_level* level, const box_span* span )
{
    double size[3], extent[3], dims[3] = { 1.0, 1.0, 1.0 };
    const double most = span->count <= MAX_FLAT ? 1.0 : fmin( (double)CELLS_PER_BOX * span->count, MAX_CELLS );
    const double side = fmin( most, MAX_SIDE );
    int longest = 0;
    for ( int k = 0; k < 3; ++k )
    {
        extent[k] = (double)span->upper[k] - (double)span->lower[k];
        size[k] = fmax( fmin( (double)span->extent[k], (double)FLT_MAX ), extent[k] / side );
        size[k] = fmax( size[k], 1e-30 );
        longest = extent[k] / size[k] > extent[longest] / size[longest] ? k : longest;
    }
    size[longest] /= SIDE_PER_CELL;
    for ( double cells = most + 1.0, wider = 1.0; cells > most; wider *= 1.25 )
    {
        cells = 1.0;
        for ( int k = 0; k < 3; ++k )
        {
            level->inverse[k] = (float)( 1.0 / ( size[k] * wider ) );
            dims[k] = 1.0 + floor( extent[k] * (double)level->inverse[k] );
            cells *= dims[k];
        }
    }
    level->cell_count = 1;
    for ( int k = 0; k < 3; ++k )
    {
        level->dims[k] = (int)dims[k];
        level->last[k] = (float)( level->dims[k] - 1 );
        level->cell_count *= level->dims[k];
        level->origin[k] = span->lower[k];
        level->end[k] = span->upper[k];
        // a difference is rounded by up to half a unit in the last place
        level->extent[k] = span->extent[k] * ( 1.0f + 2.0f * FLT_EPSILON );
    }
}

// Sorts axes by number of cells, most first, so that runs are long and few; ties in the order x, y, z.
static void order_box_axes( box_level* level )
{
    for ( int k = 0; k < 3; ++k )
    {
        level->axis[k] = k;
    }
    for ( int i = 0; i < 3; ++i )
    {
        int a = level->axis[i % 2], b = level->axis[i % 2 + 1];
        bool wrong = level->dims[b] > level->dims[a];
        level->axis[i % 2] = wrong ? b : a;
        level->axis[i % 2 + 1] = wrong ? a : b;
    }
    level->stride[level->axis[0]] = 1;
    level->stride[level->axis[1]] = level->dims[level->axis[0]];
    level->stride[level->axis[2]] = level->dims[level->axis[0]] * level->dims[level->axis[1]];
}

static int32_t cell_of_box( const box_level* level, const wisp_aabb* box )
{
    int cell = level->cell_first;
    for ( int k = 0; k < 3; ++k )
    {
        cell += box_cell_along( level, box->lower[k], k ) * level->stride[k];
    }
    return cell;
}

static void find_box_cells( void* context, int begin, int end, int worker )
{
    (void)worker;
    const box_grid_builder* b = context;
    for ( int i = begin; i < end; ++i )
    {
        int octave = b->cell_of[i];
        b->cell_of[i] = octave < 0 ? -1 : cell_of_box( b->grid->levels + b->level_of[octave], b->boxes + i );
    }
}

// ---- slots ----

// Sorts boxes by cell with a stable counting sort. Runs on one worker: it moves four bytes per box.
static void sort_boxes( box_grid_builder* b, int64_t cells )
{
    memset( b->begin, 0, ( (size_t)cells + 1 ) * sizeof( int32_t ) );
    for ( int i = 0; i < b->box_count; ++i )
    {
        b->begin[b->cell_of[i] + 1] += 1; // boxes that overlap nothing are counted at index 0, which is cleared
    }
    b->begin[0] = 0;
    for ( int64_t c = 0; c < cells; ++c )
    {
        b->begin[c + 1] += b->begin[c];
    }
    for ( int i = 0; i < b->box_count; ++i )
    {
        if ( b->cell_of[i] >= 0 )
        {
            b->item[b->begin[b->cell_of[i]]++] = i;
        }
    }
    // each begin has advanced to the end of its cell, which is the begin of the next one
    memmove( b->begin + 1, b->begin, (size_t)cells * sizeof( int32_t ) );
    b->begin[0] = 0;
}

static void copy_box_slots( void* context, int begin, int end, int worker )
{
    (void)worker;
    const box_grid_builder* b = context;
    for ( int slot = begin; slot < end; ++slot )
    {
        const wisp_aabb* box = b->boxes + b->item[slot];
        for ( int k = 0; k < 3; ++k )
        {
            b->lower[k][slot] = box->lower[k];
            b->upper[k][slot] = box->upper[k];
        }
    }
}

// ---- build ----

static bool reserve_boxes( box_grid_builder* b, wisp_buffer* buffers, const wisp_allocator* allocator )
{
    size_t count = (size_t)b->box_count, slots = ( count + SLOT_PADDING + 15 ) & ~(size_t)15;
    size_t blocks = count / BOX_GRAIN + 1;
    if ( wisp_buffer_reserve( buffers + 0, allocator, 7 * slots * 4 ) == false ||
         wisp_buffer_reserve( buffers + 1, allocator, count * 4 ) == false ||
         wisp_buffer_reserve( buffers + 2, allocator, blocks * ( sizeof( box_survey ) + sizeof( *b->spans ) ) ) ==
             false )
    {
        return false;
    }
    b->item = buffers[0].data;
    for ( int k = 0; k < 3; ++k )
    {
        b->lower[k] = (float*)( b->item + (size_t)( 1 + k ) * slots );
        b->upper[k] = (float*)( b->item + (size_t)( 4 + k ) * slots );
    }
    b->cell_of = buffers[1].data;
    b->surveys = buffers[2].data;
    b->spans = (void*)( b->surveys + blocks );
    return true;
}

// Pads the slots with boxes that overlap nothing.
static void clear_padding( box_grid_builder* b )
{
    for ( int slot = b->grid->slot_count; slot < b->grid->slot_count + SLOT_PADDING; ++slot )
    {
        b->item[slot] = 0;
        for ( int k = 0; k < 3; ++k )
        {
            b->lower[k][slot] = INFINITY;
            b->upper[k][slot] = -INFINITY;
        }
    }
}

static void find_levels( box_grid_builder* b, const wisp_parallel* parallel )
{
    box_grid* grid = b->grid;
    const int blocks = ( b->box_count + BOX_GRAIN - 1 ) / BOX_GRAIN;
    wisp_parallel_for( parallel, b->box_count, BOX_GRAIN, survey, b );
    box_span levels[MAX_BOX_LEVELS] = { NO_SPAN };
    int32_t octaves[OCTAVES] = { 0 };
    for ( int block = 0; block < blocks; ++block )
    {
        join_spans( levels, &b->surveys[block].span );
        for ( int o = 0; o < OCTAVES; ++o )
        {
            octaves[o] += b->surveys[block].octaves[o];
        }
    }
    grid->slot_count = levels[0].count;
    grid->level_count = group_sizes( octaves, grid->slot_count, b->level_of );
    if ( grid->level_count > 1 )
    {
        wisp_parallel_for( parallel, b->box_count, BOX_GRAIN, survey_levels, b );
        for ( int level = 0; level < grid->level_count; ++level )
        {
            levels[level] = NO_SPAN;
            for ( int block = 0; block < blocks; ++block )
            {
                join_spans( levels + level, b->spans[block] + level );
            }
        }
    }
    for ( int level = 0; level < grid->level_count; ++level )
    {
        choose_box_cells( grid->levels + level, levels + level );
        order_box_axes( grid->levels + level );
    }
}

wisp_status box_grid_build( box_grid* grid, wisp_buffer* buffers, const wisp_parallel* parallel,
                            const wisp_aabb_args* args )
{
    const wisp_allocator* allocator = wisp_parallel_allocator( parallel );
    box_grid_builder b = { .grid = grid, .boxes = args->boxes, .box_count = args->box_count };
    *grid = ( box_grid ){ .kernels = args->kernels };
    if ( !reserve_boxes( &b, buffers, allocator ) )
    {
        return WISP_NO_MEMORY;
    }
    find_levels( &b, parallel );
    clear_padding( &b );
    int64_t cells = 0;
    for ( int level = 0; level < grid->level_count && cells < INT32_MAX; ++level )
    {
        grid->levels[level].cell_first = (int32_t)cells;
        cells += grid->levels[level].cell_count;
    }
    if ( cells >= INT32_MAX ||
         !wisp_buffer_reserve( buffers + 3, allocator, ( (size_t)cells + 1 ) * sizeof( int32_t ) ) )
    {
        return WISP_NO_MEMORY;
    }
    b.begin = buffers[3].data;
    wisp_parallel_for( parallel, b.box_count, BOX_GRAIN, find_box_cells, &b );
    sort_boxes( &b, cells );
    wisp_parallel_for( parallel, grid->slot_count, BOX_GRAIN, copy_box_slots, &b );
    grid->begin = b.begin;
    grid->cell_of = b.cell_of;
    grid->stream = ( wisp_aabb_stream ){ .lower = { b.lower[0], b.lower[1], b.lower[2] },
                                         .upper = { b.upper[0], b.upper[1], b.upper[2] },
                                         .item = b.item };
    return WISP_OK;
}

// ---- query ----

// Queries of a grid of boxes (aabb_pairs_grid.c): runs of slots, compared with groups of query boxes.

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
