#include "results_text.h"

#include <string.h>

#define GAP 2            // blanks between two columns
#define CELL_WIDTH 44    // characters of a cell in one line
#define HEADING_WIDTH 12 // a heading of several words that is wider than this and than its cells is broken
#define KEYS_MAX 3
#define KEYS_WIDTH 72 // characters of all repeated columns, so that there is room for another one
#define TABLE_COLUMNS_MAX 64

/// Columns of a table that stand side by side.
typedef struct text_part
{
    int columns[RESULTS_TEXT_COLUMNS];
    int count, width;
} text_part;

static int least( int a, int b )
{
    return a < b ? a : b;
}

static int most( int a, int b )
{
    return a > b ? a : b;
}

// Count the characters of the first line of a text that is broken between words.
static int line_length( const char* text, int width )
{
    const int length = (int)strlen( text );
    if ( length <= width )
    {
        return length;
    }
    int end = width;
    while ( end > 0 && text[end] != ' ' )
    {
        --end;
    }
    return end > 0 ? end : width;
}

static int longest_word( const char* text )
{
    int longest = 0;
    for ( const char* c = text; *c; c += strspn( c, " " ) )
    {
        const int length = (int)strcspn( c, " " );
        longest = most( longest, length );
        c += length;
    }
    return longest;
}

static int column_width( const results_table* table, int column )
{
    int width = 0;
    for ( int row = 1; row < table->row_count; ++row )
    {
        width = most( width, (int)strlen( results_cell( table, row, column ) ) );
    }
    const char* heading = results_cell( table, 0, column );
    const int heading_width = least( (int)strlen( heading ), most( HEADING_WIDTH, longest_word( heading ) ) );
    return most( least( width, CELL_WIDTH ), least( heading_width, CELL_WIDTH ) );
}

// ---- which columns stand side by side ----

// Hashes and quantiles are for programs; rows for machines have them.
static bool is_for_programs( const char* heading )
{
    return strcmp( heading, "hash" ) == 0 || strstr( heading, "p10" ) != NULL;
}

static int find_shown( const results_table* table, int* shown )
{
    int count = 0;
    for ( int column = 0; column < least( table->column_count, TABLE_COLUMNS_MAX ); ++column )
    {
        if ( !is_for_programs( results_cell( table, 0, column ) ) )
        {
            shown[count++] = column;
        }
    }
    return count;
}

static bool are_distinct( const results_table* table, const int* columns, int count )
{
    for ( int a = 1; a < table->row_count; ++a )
    {
        for ( int b = a + 1; b < table->row_count; ++b )
        {
            bool same = true;
            for ( int i = 0; i < count && same; ++i )
            {
                same = strcmp( results_cell( table, a, columns[i] ), results_cell( table, b, columns[i] ) ) == 0;
            }
            if ( same )
            {
                return false;
            }
        }
    }
    return true;
}

// Count the first columns that tell all rows apart.
static int count_keys( const results_table* table, const int* shown, int shown_count )
{
    int count = 1, width = column_width( table, shown[0] );
    while ( count < least( KEYS_MAX, shown_count ) && !are_distinct( table, shown, count ) )
    {
        width += GAP + column_width( table, shown[count] );
        if ( width > KEYS_WIDTH )
        {
            break;
        }
        ++count;
    }
    return count;
}

static bool add_column( const results_table* table, int column, int count_max, text_part* part )
{
    const int width = part->width + ( part->count > 0 ? GAP : 0 ) + column_width( table, column );
    if ( part->count == count_max || width > RESULTS_TEXT_WIDTH )
    {
        return false;
    }
    part->columns[part->count++] = column;
    part->width = width;
    return true;
}

// Fill the next part: the keys again, then what follows. @return the first column of the part behind it
static int fill_part( const results_table* table, const int* shown, int shown_count, int key_count, int next,
                      int count_max, text_part* part )
{
    *part = ( text_part ){ .count = 0 };
    for ( int k = 0; k < key_count && next > 0; ++k )
    {
        add_column( table, shown[k], count_max, part );
    }
    while ( next < shown_count && add_column( table, shown[next], count_max, part ) )
    {
        ++next;
    }
    return next;
}

// Parts of about equal size look better than a last one with a single column.
static int balance( const results_table* table, const int* shown, int shown_count, int key_count )
{
    int parts = 0;
    text_part part;
    for ( int next = 0; next < shown_count; ++parts )
    {
        next = fill_part( table, shown, shown_count, key_count, next, RESULTS_TEXT_COLUMNS, &part );
    }
    const int others = shown_count - key_count;
    return parts > 0 ? least( key_count + most( ( others + parts - 1 ) / parts, 1 ), RESULTS_TEXT_COLUMNS ) : 0;
}

// ---- lines ----

static void write_row( const results_table* table, const text_part* part, int row, FILE* stream )
{
    const char* rest[RESULTS_TEXT_COLUMNS];
    for ( int i = 0; i < part->count; ++i )
    {
        rest[i] = results_cell( table, row, part->columns[i] );
    }
    for ( bool is_done = false; !is_done; )
    {
        is_done = true;
        int blanks = 0; // written only before further text, so that no line ends with any
        for ( int i = 0; i < part->count; ++i )
        {
            const int width = column_width( table, part->columns[i] ), length = line_length( rest[i], width );
            const bool is_right = results_is_numeric_column( table, part->columns[i] );
            blanks += ( i > 0 ? GAP : 0 ) + ( is_right ? width - length : 0 );
            if ( length > 0 )
            {
                fprintf( stream, "%*s%.*s", blanks, "", length, rest[i] );
                blanks = 0;
            }
            blanks += is_right ? 0 : width - length;
            rest[i] += length;
            rest[i] += strspn( rest[i], " " );
            is_done = is_done && rest[i][0] == '\0';
        }
        fputc( '\n', stream );
    }
}

static void write_part( const results_table* table, const text_part* part, FILE* stream )
{
    WISP_ASSERT( part->count <= RESULTS_TEXT_COLUMNS && part->width <= RESULTS_TEXT_WIDTH );
    for ( int row = 0; row < table->row_count; ++row )
    {
        write_row( table, part, row, stream );
        for ( int i = 0; row == 0 && i < part->width; ++i )
        {
            fputc( '-', stream );
        }
        fputs( row == 0 ? "\n" : "", stream );
    }
}

// A table without a title is a list of labels: it has no heading, and its last column takes the rest of the line.
static void write_labels( const results_table* table, FILE* stream )
{
    for ( int row = 1; row < table->row_count; ++row )
    {
        for ( int column = 0; column + 1 < table->column_count; ++column )
        {
            int width = 0;
            for ( int other = 1; other < table->row_count; ++other )
            {
                width = most( width, (int)strlen( results_cell( table, other, column ) ) );
            }
            fprintf( stream, "%-*s%*s", width, results_cell( table, row, column ), GAP, "" );
        }
        fprintf( stream, "%s\n", results_cell( table, row, table->column_count - 1 ) );
    }
}

void results_write_text_table( const results_table* table, FILE* stream )
{
    if ( table->title[0] == '\0' )
    {
        write_labels( table, stream );
        return;
    }
    int shown[TABLE_COLUMNS_MAX];
    const int shown_count = find_shown( table, shown );
    const int key_count = shown_count > 0 ? count_keys( table, shown, shown_count ) : 0;
    const int count_max = balance( table, shown, shown_count, key_count );
    for ( int next = 0; next < shown_count; )
    {
        text_part part;
        fputc( '\n', stream );
        results_write_text_lines( table->title, stream );
        fputs( next > 0 ? "(continued)\n\n" : "\n", stream );
        next = fill_part( table, shown, shown_count, key_count, next, count_max, &part );
        write_part( table, &part, stream );
    }
}

void results_write_text_lines( const char* text, FILE* stream )
{
    for ( int line = 0; line == 0 || *text; ++line )
    {
        const int indent = line > 0 ? 2 : 0;
        const int length = line_length( text, RESULTS_TEXT_WIDTH - indent );
        fprintf( stream, "%*s%.*s\n", indent, "", length, text );
        text += length;
        text += strspn( text, " " );
    }
}
