// Pairs of neighbours of a grid of vertices, for cloth that is made of quads.
#include "mesh.h"

#include <stdlib.h>

void wisp_quad_pairs_release( wisp_quad_pairs* pairs )
{
    if ( pairs )
    {
        free( pairs->stretch );
        free( pairs->bend );
        *pairs = ( wisp_quad_pairs ){ 0 };
    }
}

// Every pair once: from each vertex to the right, down, and down both diagonals.
static int put_pairs( int columns, int rows, int apart, int32_t* pairs )
{
    const int steps[][2] = { { apart, 0 }, { 0, apart }, { apart, apart }, { -apart, apart } };
    int count = 0;
    for ( int j = 0; j < rows; ++j )
    {
        for ( int i = 0; i < columns; ++i )
        {
            for ( int s = 0; s < WISP_COUNT( steps ); ++s )
            {
                int x = i + steps[s][0], y = j + steps[s][1];
                if ( x >= 0 && x < columns && y < rows )
                {
                    pairs[2 * (size_t)count] = j * columns + i;
                    pairs[2 * (size_t)count + 1] = y * columns + x;
                    ++count;
                }
            }
        }
    }
    return count;
}

static size_t count_pairs( int columns, int rows, int apart )
{
    size_t c = (size_t)columns, r = (size_t)rows;
    size_t across = columns > apart ? c - (size_t)apart : 0, down = rows > apart ? r - (size_t)apart : 0;
    return across * r + c * down + 2 * across * down;
}

wisp_status wisp_quad_pairs_make( int columns, int rows, wisp_quad_pairs* out, wisp_error* error )
{
    *out = ( wisp_quad_pairs ){ 0 };
    if ( columns < 2 || rows < 2 || (int64_t)columns * rows > WISP_MESH_VERTEX_CAP )
    {
        return wisp_fail(
            error, WISP_BAD_INPUT,
            "quad pairs: got %d columns times %d rows, expected at least 2 each and a product of at most %d", columns,
            rows, WISP_MESH_VERTEX_CAP );
    }
    const size_t stretch = count_pairs( columns, rows, 1 ), bend = count_pairs( columns, rows, 2 );
    out->stretch = malloc( stretch * 2 * sizeof( int32_t ) );
    out->bend = malloc( bend * 2 * sizeof( int32_t ) + 1 );
    if ( !out->stretch || !out->bend )
    {
        wisp_quad_pairs_release( out );
        return wisp_fail( error, WISP_NO_MEMORY, "quad pairs: out of memory for %zu pairs", stretch + bend );
    }
    out->stretch_count = put_pairs( columns, rows, 1, out->stretch );
    out->bend_count = put_pairs( columns, rows, 2, out->bend );
    return WISP_OK;
}
