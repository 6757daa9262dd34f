// Which pieces of patches may meet in this substep. Of two patches it is known how far their pieces are from their gaps, less
// what they came nearer since: so only those are looked at that might come to it.
#include "contact_internal.h"

#include <stdatomic.h>
#include <string.h>

enum
{
    PLACE_GRAIN = 64,
    DUE_GRAIN = 16, // pairs of patches
};

// Pieces are measured that may be nearer than so many gaps beside their gap: the more, the longer what is measured holds. Of
// others it is known how far a plane between them is; what is so many gaps from the other patch is not looked at.
static const float MEASURED_GAPS = 0.6f, SEEN_GAPS = 1.5f;
// What is farther apart as a whole than so many gaps beside its gap is not looked at piece by piece.
static const float APART_GAPS = 0.5f;

typedef struct near_loop
{
    const contact_work* work;
    contact_soup* soup;
    bool late_only;
    int due_count;
    _Atomic int total[CONTACT_KIND_COUNT];
    _Atomic bool lacks_memory;
} near_loop;

// ---- pairs of patches ----

// Those whose pieces might come to their gaps in this substep. Pairs that nothing is known of are due, and so are those with what
// is no number.
static void find_due( void* context, int begin, int end, int worker )
{
    (void)worker;
    const near_loop* loop = context;
    contact_soup* s = loop->soup;
    const wisp_slack_job job = {
        .gone = loop->late_only ? NULL : s->gone->middle,
        .ways = s->ways->middle,
        .first = s->pairs[0].patch,
        .second = s->pairs[0].other,
        .slack = s->pairs[0].slack,
        .due = s->due,
    };
    s->due_count[begin / CONTACT_PAIRS_PART] = wisp_frame_kernels( loop->work->frame )->slack_due( &job, begin, end );
}

// Those of patches that are asked, behind each other.
static int gather_due( contact_soup* s, bool late_only )
{
    const contact_patch_pairs* pairs = s->pairs;
    int count = 0;
    for ( int first = 0; first < pairs->count; first += CONTACT_PAIRS_PART )
    {
        for ( int i = first; i < first + s->due_count[first / CONTACT_PAIRS_PART]; ++i )
        {
            const int32_t pair = s->due[i];
            s->due[count] = pair;
            count += late_only == false || ( s->patch_late[pairs->patch[pair]] | s->patch_late[pairs->other[pair]] );
        }
    }
    return count;
}

// ---- where their pieces are ----

// Of all its triangles; 0 without any.
static void take_normal( contact_soup* s, int p )
{
    const contact_patch* patch = s->patches + p;
    const wisp_piece_row* row = s->pieces + patch->kind_row[2];
    float* normal = s->patch_normals + 3 * (size_t)p;
    normal[0] = normal[1] = normal[2] = 0.0f;
    for ( int lane = 0; lane < WISP_SLICE && patch->rows[2] > 0 && row->item[lane] >= 0; ++lane )
    {
        for ( int k = 0; k < 3; ++k )
        {
            normal[k] += row->normal[k][lane];
        }
    }
}

static void place_patches( void* context, int begin, int end, int worker )
{
    (void)worker;
    const near_loop* loop = context;
    contact_soup* s = loop->soup;
    const wisp_kernels* kernels = wisp_frame_kernels( loop->work->frame );
    for ( int i = begin; i < end; ++i )
    {
        const int p = s->asked[i];
        s->patch_boxes[p] = contact_box_around( loop->work, s->patches + p );
        for ( int kind = 0; kind < 3; ++kind )
        {
            const int row = s->patches[p].kind_row[kind];
            kernels->piece_place( s->safe, s->pieces, kind + 1, row, row + s->patches[p].rows[kind] );
        }
        take_normal( s, p );
    }
}

// Patches of pairs that are due, each once in a substep.
static void place_due( near_loop* loop )
{
    contact_soup* s = loop->soup;
    if ( loop->late_only == false )
    {
        memset( s->is_placed, 0, (size_t)s->patch_count );
    }
    int count = 0;
    for ( int i = 0; i < loop->due_count; ++i )
    {
        const int32_t both[2] = { s->pairs[0].patch[s->due[i]], s->pairs[0].other[s->due[i]] };
        for ( int k = 0; k < 2; ++k )
        {
            s->asked[count] = both[k];
            count += s->is_placed[both[k]] == 0 ? 1 : 0;
            s->is_placed[both[k]] = 1;
        }
    }
    wisp_parallel_for( loop->work->parallel, count, PLACE_GRAIN, place_patches, loop );
}

// ---- their pieces ----

// A pair of patches that is being looked at.
typedef struct looked
{
    int patch[2];
    float gap, closing, within;             // m
    float slack;                            // m, over what was measured
    _Alignas( 32 ) float least[WISP_SLICE]; // m, that what was not is apart
} looked;

// What a worker looks at: some pairs of patches, and of each kind of pieces those that are to be measured.
typedef struct looking
{
    near_loop* loop;
    looked of[DUE_GRAIN];
    contact_batch batches[CONTACT_KIND_COUNT];
} looking;

static void measure( looking* l, contact_kind kind )
{
    contact_batch* batch = l->batches + kind;
    contact_measure_batch( l->loop->work, kind, batch );
    int met = 0;
    for ( int i = 0; i < batch->count; )
    {
        const int number = batch->of[i];
        looked* of = l->of + number;
        const float gap = of->gap, limit = gap + of->closing;
        float nearest = INFINITY;
        for ( ; i < batch->count && batch->of[i] == number; ++i )
        {
            const float distance = batch->distance[i];
            nearest = contact_smaller( distance, nearest );
            batch->gap[i] = gap;
            batch->met[met] = i;
            met += distance < limit ? 1 : 0;
        }
        of->slack = contact_smaller( nearest - 1.001f * gap, of->slack );
    }
    contact_meet( l->loop->work, kind, batch, met, l->loop->total + kind );
    batch->count = 0;
}

// One patch asks the other with pieces of a kind, if it is not the same.
static void ask( looking* l, const int* numbers, int count, int asker, const int kinds[2], contact_kind kind )
{
    const contact_soup* s = l->loop->soup;
    const wisp_kernels* kernels = wisp_frame_kernels( l->loop->work->frame );
    contact_batch* batch = l->batches + kind;
    wisp_piece_near_job jobs[WISP_PIECE_JOBS];
    int job_count = 0;
    for ( int i = 0; i < count; ++i )
    {
        looked* of = l->of + numbers[i];
        const bool is_own = of->patch[0] == of->patch[1];
        const int one = of->patch[asker], other = of->patch[1 - asker];
        const contact_patch *a = s->patches + one, *b = s->patches + other;
        jobs[job_count] = ( wisp_piece_near_job ){
            .askers = s->pieces + a->kind_row[kinds[0]],
            .rows = s->pieces + b->kind_row[kinds[1]],
            .asker_rows = a->rows[kinds[0]],
            .row_count = b->rows[kinds[1]],
            .asker_box = s->patch_boxes + one,
            .box = s->patch_boxes + other,
            .within = of->within,
            .seen = of->within + SEEN_GAPS * of->gap,
            .least = of->least,
            .is_own = is_own,
            .number = numbers[i],
        };
        job_count += asker == 0 || is_own == false ? 1 : 0;
    }
    wisp_piece_pairs to;
    contact_take_room( batch, &to );
    batch->count += ( kind == CONTACT_EDGES ? kernels->edges_near : kernels->points_near )( jobs, job_count, &to );
}

// How far patches are apart as a whole, along the way between them or across one of them.
static float distance_of( const wisp_kernels* kernels, const contact_soup* s, int a, int b )
{
    const contact_patch *pa = s->patches + a, *pb = s->patches + b;
    wisp_apart_job job = {
        .quads = s->safe,
        .point4 = { s->patch_points + pa->first_point, s->patch_points + pb->first_point },
        .count = { pa->point_count, pb->point_count },
    };
    memcpy( job.along[0], s->patch_normals + 3 * (size_t)a, sizeof( job.along[0] ) );
    memcpy( job.along[1], s->patch_normals + 3 * (size_t)b, sizeof( job.along[1] ) );
    const wisp_box *box = s->patch_boxes + a, *other = s->patch_boxes + b;
    for ( int k = 0; k < 3; ++k )
    {
        job.along[2][k] = ( box->low[k] + box->high[k] ) - ( other->low[k] + other->high[k] );
    }
    return kernels->apart( &job );
}

// Pairs of patches [first, first + count) of those that the worker has.
static void look_at( looking* l, int first, int count )
{
    static const int EDGES[2] = { 1, 1 }, POINTS[2] = { 0, 2 };
    const contact_soup* s = l->loop->soup;
    const wisp_kernels* kernels = wisp_frame_kernels( l->loop->work->frame );
    int numbers[WISP_PIECE_JOBS], near_count = 0;
    for ( int i = first; i < first + count; ++i )
    {
        looked* of = l->of + i;
        const int a = of->patch[0], b = of->patch[1];
        const float apart = a == b ? 0.0f : distance_of( kernels, s, a, b );
        const bool is_apart = apart > 1.001f * of->gap + of->closing + APART_GAPS * of->gap;
        of->slack = is_apart ? apart - 1.001f * of->gap : of->slack;
        numbers[near_count] = i;
        near_count += is_apart ? 0 : 1;
    }
    ask( l, numbers, near_count, 0, EDGES, CONTACT_EDGES );
    ask( l, numbers, near_count, 0, POINTS, CONTACT_POINTS );
    ask( l, numbers, near_count, 1, POINTS, CONTACT_POINTS );
}

static void begin_look( const near_loop* loop, int pair, looked* of )
{
    const contact_soup* s = loop->soup;
    const contact_guest* guests = loop->work->state->guests;
    const int a = s->pairs[0].patch[pair], b = s->pairs[0].other[pair];
    of->patch[0] = a;
    of->patch[1] = b;
    of->gap =
        0.5f * ( guests[s->patches[a].guest].settings.thickness + guests[s->patches[b].guest].settings.thickness );
    of->closing = contact_closing_of( s->ways + a, s->ways + b );
    of->within = 1.001f * of->gap + of->closing + MEASURED_GAPS * of->gap;
    of->slack = of->within + SEEN_GAPS * of->gap - 1.001f * of->gap;
    for ( int i = 0; i < WISP_SLICE; ++i )
    {
        of->least[i] = INFINITY;
    }
}

static float slack_of( const looked* of )
{
    float least = of->least[0];
    for ( int i = 1; i < WISP_SLICE; ++i )
    {
        least = contact_smaller( least, of->least[i] );
    }
    return contact_smaller( of->slack, least - 1.001f * of->gap );
}

static void look( void* context, int begin, int end, int worker )
{
    near_loop* loop = context;
    contact_soup* s = loop->soup;
    looking* l = wisp_parallel_scratch( loop->work->parallel, worker, sizeof( *l ) );
    if ( l == NULL )
    {
        atomic_store( &loop->lacks_memory, true );
        return;
    }
    l->loop = loop;
    l->batches[CONTACT_POINTS].count = l->batches[CONTACT_EDGES].count = 0;
    for ( int i = begin; i < end; ++i )
    {
        begin_look( loop, s->due[i], l->of + ( i - begin ) );
    }
    for ( int first = 0; first < end - begin; first += WISP_PIECE_JOBS )
    {
        if ( contact_has_room( l->batches + CONTACT_POINTS ) == false ||
             contact_has_room( l->batches + CONTACT_EDGES ) == false )
        {
            measure( l, CONTACT_POINTS );
            measure( l, CONTACT_EDGES );
        }
        const int left = end - begin - first;
        look_at( l, first, left < WISP_PIECE_JOBS ? left : WISP_PIECE_JOBS );
    }
    measure( l, CONTACT_POINTS );
    measure( l, CONTACT_EDGES );
    for ( int i = begin; i < end && loop->late_only == false; ++i )
    {
        s->pairs[0].slack[s->due[i]] = slack_of( l->of + ( i - begin ) );
    }
}

// @return whether `near` had room for all
static bool look_at_all( near_loop* loop )
{
    contact_near* near = loop->soup->near;
    bool fits = true;
    atomic_init( &loop->lacks_memory, false );
    for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
    {
        atomic_init( loop->total + kind, 0 );
    }
    wisp_parallel_for( loop->work->parallel, loop->due_count, DUE_GRAIN, look, loop );
    for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
    {
        near[kind].count = atomic_load( loop->total + kind );
        fits = fits && near[kind].count <= near[kind].most;
    }
    return fits;
}

wisp_status contact_find_near( const contact_work* work, bool late_only, wisp_error* error )
{
    contact_soup* s = work->soup;
    near_loop loop = { .work = work, .soup = s, .late_only = late_only };
    wisp_parallel_for( work->parallel, s->pairs[0].count, CONTACT_PAIRS_PART, find_due, &loop );
    loop.due_count = gather_due( s, late_only );
    place_due( &loop );
    bool enough = true;
    while ( enough && look_at_all( &loop ) == false )
    {
        for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
        {
            const int count = s->near[kind].count;
            enough = enough && contact_reserve_near( work, (contact_kind)kind, count + count / 2 );
        }
    }
    return enough && atomic_load( &loop.lacks_memory ) == false
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "no memory to look at %d pairs of patches", loop.due_count );
}
