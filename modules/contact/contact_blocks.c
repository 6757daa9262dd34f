// Rows in blocks that one worker projects from the first row to the last, coloured so that blocks of one colour share no point.
#include "contact_internal.h"

#include <string.h>

static void cut_blocks( contact_blocks* blocks, int split, int count )
{
    blocks->count = 0;
    for ( int begin = 0; begin < count; )
    {
        const int most = begin < split ? split : count;
        blocks->begin[blocks->count++] = begin;
        begin = begin + CONTACT_BLOCK < most ? begin + CONTACT_BLOCK : most;
    }
    blocks->begin[blocks->count] = count;
}

static void forget_colours( contact_soup* s )
{
    for ( int r = 0; r < s->row_count; ++r )
    {
        for ( int i = 0; i < s->rows[r].count; ++i )
        {
            s->colours[s->rows[r].point[i]] = 0;
        }
    }
}

// The lowest colour that no point of the block has yet; the last one is for all that find none, and runs in order.
static int colour_block( contact_soup* s, int begin, int end )
{
    uint64_t taken = 0;
    for ( int r = begin; r < end; ++r )
    {
        for ( int i = 0; i < s->rows[r].count; ++i )
        {
            taken |= s->colours[s->rows[r].point[i]];
        }
    }
    int colour = 0;
    while ( colour < CONTACT_COLOURS - 1 && ( taken >> colour & 1 ) != 0 )
    {
        colour += 1;
    }
    for ( int r = begin; r < end; ++r )
    {
        for ( int i = 0; i < s->rows[r].count; ++i )
        {
            s->colours[s->rows[r].point[i]] |= UINT64_C( 1 ) << colour;
        }
    }
    return colour;
}

static void colour_blocks( contact_soup* s )
{
    contact_blocks* blocks = &s->blocks;
    memset( blocks->colour, 0, sizeof( blocks->colour ) );
    forget_colours( s );
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

bool contact_make_blocks( const contact_work* work )
{
    contact_soup* s = work->soup;
    contact_blocks* b = &s->blocks;
    b->count = 0;
    const size_t most = (size_t)( s->row_count / CONTACT_BLOCK + 2 ), number = sizeof( int32_t );
    if ( contact_reserve( work, CONTACT_BLOCK_BEGIN, ( most + 1 ) * number, (void**)&b->begin ) == false ||
         contact_reserve( work, CONTACT_BLOCK_COLOUR, most * number, (void**)&b->colour_of ) == false ||
         contact_reserve( work, CONTACT_BLOCK_ORDER, most * number, (void**)&b->order ) == false )
    {
        return false;
    }
    cut_blocks( b, s->split, s->row_count );
    colour_blocks( s );
    return true;
}
