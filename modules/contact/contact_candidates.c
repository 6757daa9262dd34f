// Candidates: pairs whose boxes were near enough, and whose pieces are. They come in the order of points and of edges,
// whatever searched, in blocks that are coloured so that those of one colour share no point.
#include "contact_internal.h"

#include <string.h>

enum
{
    CHECK_GRAIN = 1024, // candidates a block of checking
};

static int append_pairs( contact_soup* s, const wisp_box_pairs* pairs, size_t first, int count )
{
    const float* gaps = s->pair_gap + first;
    for ( int a = 0; a < pairs->asker_count; ++a )
    {
        for ( int k = pairs->begin[a]; k < pairs->begin[a + 1]; ++k )
        {
            if ( gaps[k] > 0.0f )
            {
                s->candidates[count++] = ( contact_candidate ){
                    .a = a,
                    .b = pairs->item[k],
                    .gap = gaps[k],
                    .due = -INFINITY,
                };
            }
        }
    }
    return count;
}

static size_t count_gaps( const float* gaps, size_t pairs )
{
    size_t count = 0;
    for ( size_t k = 0; k < pairs; ++k )
    {
        count += gaps[k] > 0.0f ? 1 : 0;
    }
    return count;
}

// ---- exact distances ----

// Are the boxes around the two sides of a pair nearer than a distance?
static bool boxes_are_within( const float* quads, const int32_t points[4], int split, float distance )
{
    bool within = true;
    for ( size_t k = 0; k < 3 && within; ++k )
    {
        float low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
        for ( int i = 0; i < 4; ++i )
        {
            const float x = quads[(size_t)points[i] * 4 + k];
            low[i >= split] = contact_smaller( low[i >= split], x );
            high[i >= split] = contact_larger( high[i >= split], x );
        }
        within = low[0] - high[1] < distance && low[1] - high[0] < distance;
    }
    return within;
}

typedef struct check_loop
{
    const contact_work* work;
    int first; // candidate
    bool are_edges;
} check_loop;

static void drop_far( const check_loop* loop, int32_t* list, int count, contact_row* rows )
{
    const contact_work* work = loop->work;
    contact_soup* s = work->soup;
    contact_measure_pairs( work, s->searched, list, count, loop->are_edges, rows );
    for ( int i = 0; i < count; ++i )
    {
        contact_candidate* c = s->candidates + list[i];
        const int split = rows[i].split;
        const float reach =
            contact_reach_of( s, rows[i].point, split ) + contact_reach_of( s, rows[i].point + split, 4 - split );
        c->gap = rows[i].distance < c->gap + reach ? c->gap : 0.0f;
    }
}

// A guest is not pushed apart where it is thinner at rest.
static void thin_gaps( const check_loop* loop, int32_t* list, int count, contact_row* rows )
{
    static const float REST_SHARE = 0.9f; // so that nothing presses at rest
    const contact_work* work = loop->work;
    contact_soup* s = work->soup;
    int thin = 0;
    for ( int i = 0; i < count; ++i )
    {
        const contact_candidate* c = s->candidates + list[i];
        const int32_t* points = rows[i].point;
        const bool is_own = contact_guest_of( work, points[0] ) == contact_guest_of( work, points[3] );
        if ( is_own && c->gap > 0.0f && boxes_are_within( s->rest, points, rows[i].split, 2.0f * c->gap ) )
        {
            list[thin++] = list[i];
        }
    }
    contact_measure_pairs( work, s->rest, list, thin, loop->are_edges, rows );
    for ( int i = 0; i < thin; ++i )
    {
        contact_candidate* c = s->candidates + list[i];
        c->gap = contact_smaller( c->gap, REST_SHARE * rows[i].distance );
    }
}

static void check_candidates( void* context, int begin, int end, int worker )
{
    (void)worker;
    const check_loop* loop = context;
    for ( int from = begin; from < end; from += CONTACT_BLOCK )
    {
        int32_t list[CONTACT_BLOCK];
        contact_row rows[CONTACT_BLOCK];
        int count = 0;
        for ( int c = from; c < end && count < CONTACT_BLOCK; ++c )
        {
            list[count++] = loop->first + c;
        }
        drop_far( loop, list, count, rows );
        thin_gaps( loop, list, count, rows );
    }
}

// Close the ranks. @return how many of the first `split` stayed
static int close_ranks( contact_soup* s, int split )
{
    int kept = 0, kept_split = 0;
    for ( int c = 0; c < s->candidate_count; ++c )
    {
        kept_split = c == split ? kept : kept_split;
        s->candidates[kept] = s->candidates[c];
        kept += s->candidates[c].gap > 0.0f ? 1 : 0;
    }
    kept_split = split == s->candidate_count ? kept : kept_split;
    s->candidate_count = kept;
    return kept_split;
}

// ---- blocks ----

static void cut_blocks( contact_blocks* blocks, int split, int count )
{
    blocks->count = 0;
    for ( int begin = 0; begin < count; )
    {
        const int most = begin < split ? split : count;
        blocks->begin[blocks->count++] = begin;
        begin = begin + CONTACT_BLOCK < most ? begin + CONTACT_BLOCK : most;
        blocks->first_edge_block = begin <= split ? blocks->count : blocks->first_edge_block;
    }
    blocks->begin[blocks->count] = count;
}

// The lowest colour that no point of the block has yet; the last one is for all that find none, and runs in order.
static void colour_blocks( const contact_work* work )
{
    contact_soup* s = work->soup;
    contact_blocks* blocks = &s->blocks;
    memset( s->colours, 0, (size_t)s->point_count * sizeof( uint64_t ) );
    memset( blocks->colour, 0, ( CONTACT_COLOURS + 1 ) * sizeof( int32_t ) );
    for ( int b = 0; b < blocks->count; ++b )
    {
        uint64_t taken = 0;
        contact_row row;
        for ( int c = blocks->begin[b]; c < blocks->begin[b + 1]; ++c )
        {
            contact_set_points( work, c, b >= blocks->first_edge_block, &row );
            for ( int i = 0; i < row.count; ++i )
            {
                taken |= s->colours[row.point[i]];
            }
        }
        int colour = 0;
        while ( colour < CONTACT_COLOURS - 1 && ( taken >> colour & 1 ) != 0 )
        {
            colour += 1;
        }
        for ( int c = blocks->begin[b]; c < blocks->begin[b + 1]; ++c )
        {
            contact_set_points( work, c, b >= blocks->first_edge_block, &row );
            for ( int i = 0; i < row.count; ++i )
            {
                s->colours[row.point[i]] |= UINT64_C( 1 ) << colour;
            }
        }
        blocks->rows[b] = colour; // until rows are counted
        blocks->colour[colour + 1] += 1;
    }
    for ( int i = 0; i < CONTACT_COLOURS; ++i )
    {
        blocks->colour[i + 1] += blocks->colour[i];
    }
    int next[CONTACT_COLOURS];
    memcpy( next, blocks->colour, sizeof( next ) );
    for ( int b = 0; b < blocks->count; ++b )
    {
        blocks->order[next[blocks->rows[b]]++] = b;
    }
    memset( blocks->rows, 0, (size_t)blocks->count * sizeof( int32_t ) );
}

static bool reserve_blocks( const contact_work* work )
{
    contact_soup* s = work->soup;
    const size_t count = (size_t)s->candidate_count, most = count / CONTACT_BLOCK + 2, number = sizeof( int32_t );
    contact_blocks* b = &s->blocks;
    return contact_reserve( work, CONTACT_ROWS, count * sizeof( contact_row ), (void**)&s->rows ) &&
           contact_reserve( work, CONTACT_BLOCK_BEGIN, ( most + 1 ) * number, (void**)&b->begin ) &&
           contact_reserve( work, CONTACT_BLOCK_ROWS, most * number, (void**)&b->rows ) &&
           contact_reserve( work, CONTACT_BLOCK_ORDER, most * number, (void**)&b->order ) &&
           contact_reserve( work, CONTACT_BLOCK_COLOUR, ( CONTACT_COLOURS + 1 ) * number, (void**)&b->colour );
}

bool contact_make_candidates( const contact_work* work )
{
    contact_soup* s = work->soup;
    const size_t point_pairs = s->point_pairs.pair_count;
    const size_t count = count_gaps( s->pair_gap, point_pairs + s->edge_pairs.pair_count );
    if ( count > INT32_MAX / 2 || contact_reserve( work, CONTACT_CANDIDATES, count * sizeof( contact_candidate ),
                                                   (void**)&s->candidates ) == false )
    {
        return false;
    }
    int split = append_pairs( s, &s->point_pairs, 0, 0 );
    s->candidate_count = append_pairs( s, &s->edge_pairs, point_pairs, split );
    if ( work->state->world.features == WISP_CONTACT_EXACT )
    {
        check_loop points = { work, 0, false }, edges = { work, split, true };
        wisp_parallel_for( work->parallel, split, CHECK_GRAIN, check_candidates, &points );
        wisp_parallel_for( work->parallel, s->candidate_count - split, CHECK_GRAIN, check_candidates, &edges );
        split = close_ranks( s, split );
    }
    if ( reserve_blocks( work ) == false )
    {
        return false;
    }
    s->blocks.first_edge_block = 0;
    cut_blocks( &s->blocks, split, s->candidate_count );
    colour_blocks( work );
    return true;
}
