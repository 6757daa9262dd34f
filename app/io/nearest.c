#define _POSIX_C_SOURCE 200809L // strnlen

#include "nearest.h"

#include <stddef.h>
#include <string.h>

// Longer words match nothing. The cap keeps a hostile key of megabytes from costing more than its first letters.
#define LONGEST 64
#define FARTHEST 3

// Capitals count as small letters. Not tolower(), which follows the host's locale.
static unsigned char small( char c )
{
    return (unsigned char)( c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c );
}

static int least( int a, int b )
{
    return a < b ? a : b;
}

// Optimal string alignment: insertions, deletions, changes and swaps of neighbours cost one each. Three rows of the
// table are kept, because a swap refers to two rows before.
static int distance( const char* a, int a_length, const char* b, int b_length )
{
    int rows[3][LONGEST + 1];
    for ( int j = 0; j <= b_length; ++j )
    {
        rows[0][j] = j;
    }

    for ( int i = 1; i <= a_length; ++i )
    {
        int* row = rows[i % 3];
        const int* above = rows[( i + 2 ) % 3];
        const int* above_that = rows[( i + 1 ) % 3];
        row[0] = i;
        for ( int j = 1; j <= b_length; ++j )
        {
            int change = small( a[i - 1] ) != small( b[j - 1] );
            row[j] = least( above[j - 1] + change, least( above[j], row[j - 1] ) + 1 );
            if ( i > 1 && j > 1 && small( a[i - 1] ) == small( b[j - 2] ) && small( a[i - 2] ) == small( b[j - 1] ) )
            {
                row[j] = least( row[j], above_that[j - 2] + 1 );
            }
        }
    }
    return rows[a_length % 3][b_length];
}

const char* nearest_word( const char* word, const char* const* words, int count )
{
    size_t length = strnlen( word, LONGEST + 1 );
    if ( length > LONGEST )
    {
        return NULL;
    }

    const char* nearest = NULL;
    int nearest_distance = FARTHEST + 1;
    for ( int i = 0; i < count; ++i )
    {
        size_t other = strnlen( words[i], LONGEST + 1 );
        size_t longer = other > length ? other : length;
        int difference = (int)( longer - ( other > length ? length : other ) );

        // The difference in length is a lower bound of the distance and costs nothing.
        int limit = least( (int)( longer / 3 ), FARTHEST );
        if ( other > LONGEST || difference > limit || difference >= nearest_distance )
        {
            continue;
        }
        int d = distance( word, (int)length, words[i], (int)other );
        if ( d <= limit && d < nearest_distance )
        {
            nearest = words[i];
            nearest_distance = d;
        }
    }
    return nearest;
}

int nearest_words( const char* word, const char* const* words, int count, const char** out, int max )
{
    const int length = (int)strnlen( word, LONGEST + 1 );
    int found = 0;
    // Ascending distances: each word of the list goes behind those that are as near.
    for ( int wanted = 0; wanted <= LONGEST && length <= LONGEST && found < max; ++wanted )
    {
        for ( int i = 0; i < count && found < max; ++i )
        {
            const int other = (int)strnlen( words[i], LONGEST );
            if ( distance( word, length, words[i], other ) == wanted )
            {
                out[found++] = words[i];
            }
        }
    }
    return found;
}
