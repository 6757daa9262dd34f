// Colouring: constraints in blocks of 64 that one worker projects from first to last, coloured greedily so that
// blocks of one colour share no point. In: rows. Out: blocks in the order of their colours. Blocks do not depend on
// the number of workers.
#include "colouring.h"

#include "constraints.h"

#include <string.h>

enum
{
    ROWS_PER_BLOCK = 64,
};

static void cut_blocks( contact_colouring* blocks, int split, int count )
{
    blocks->count = 0;
    for ( int begin = 0; begin < count; )
    {
        const int most = begin < split ? split : count;
        blocks->begin[blocks->count++] = begin;
        begin = begin + ROWS_PER_BLOCK < most ? begin + ROWS_PER_BLOCK : most;
    }
    blocks->begin[blocks->count] = count;
}

// Take the lowest colour that no point of the block has yet. Blocks without one get the last colour, which runs
// serially.
static int colour_block( contact_contact_mesh* s, int begin, int end )
{
    uint64_t taken = 0;
    for ( int r = begin; r < end; ++r )
    {
        for ( int i = 0; i < s->constraints->rows[r].count; ++i )
        {
            taken |= s->colouring->of_point[s->constraints->rows[r].point[i]];
        }
    }
    int colour = 0;
    while ( colour < CONTACT_COLOURS - 1 && ( taken >> colour & 1 ) != 0 )
    {
        colour += 1;
    }
    for ( int r = begin; r < end; ++r )
    {
        for ( int i = 0; i < s->constraints->rows[r].count; ++i )
        {
            s->colouring->of_point[s->constraints->rows[r].point[i]] |= UINT64_C( 1 ) << colour;
        }
    }
    return colour;
}

static void colour_blocks( contact_contact_mesh* s )
{
    contact_colouring* blocks = s->colouring;
    memset( blocks->colour, 0, sizeof( blocks->colour ) );
    memset( blocks->of_point, 0, (size_t)s->point_count * sizeof( *blocks->of_point ) );
    for ( int b = 0; b < blocks->count; ++b )
    {
        blocks->colour_of[b] = colour_block( s, blocks->begin[b], blocks->begin[b + 1] );
        blocks->colour[blocks->colour_of[b] + 1] += 1;
    }
    for ( int i = 0; i < CONTACT_COLOURS; ++i )
    {
        blocks->colour[i + 1] += blocks->colour[i];
    }
    int next[CONTACT_COLOURS];
    memcpy( next, blocks->colour, sizeof( next ) );
    for ( int b = 0; b < blocks->count; ++b )
    {
        blocks->order[next[blocks->colour_of[b]]++] = b;
    }
}

bool contact_reserve_colouring( const contact_work* work )
{
    contact_colouring* c = work->contact_mesh->colouring;
    return contact_reserve( work, &c->point_buffer, (size_t)work->contact_mesh->point_count * sizeof( *c->of_point ),
                            (void**)&c->of_point );
}

wisp_status contact_colour_rows( const contact_work* work, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    contact_colouring* c = s->colouring;
    c->count = 0;
    const size_t most = (size_t)( s->constraints->row_count / ROWS_PER_BLOCK + 2 ), index = sizeof( int32_t );
    wisp_buffer* b = c->buffers;
    if ( contact_reserve( work, b++, ( most + 1 ) * index, (void**)&c->begin ) == false ||
         contact_reserve( work, b++, most * index, (void**)&c->colour_of ) == false ||
         contact_reserve( work, b++, most * index, (void**)&c->order ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for blocks of %d pairs", s->constraints->row_count );
    }
    cut_blocks( c, s->constraints->split, s->constraints->row_count );
    colour_blocks( s );
    return WISP_OK;
}
