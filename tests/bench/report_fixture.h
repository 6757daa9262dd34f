/// Pages in memory, and the parts that tests read: tags, ticks of axes, points, data of pictures.
#pragma once

#include "unit.h"

#include "report.h"

#include <ctype.h>

static const report_run quiet_run = { .what = "a case", .how = "quick" };

/// The page of some results, to be freed. Never inlined, because gcc 12 would mistake the stream's text for the
/// variable that points to it, and warn at its end.
static __attribute__( ( noinline ) ) char* page_of( const results* all, const report_run* run )
{
    char* text = NULL;
    size_t size = 0;
    FILE* stream = open_memstream( &text, &size );
    wisp_error error = { 0 };
    assert_non_null( stream );
    assert_int_equal( report_write( all, run, stream, &error ), WISP_OK );
    fclose( stream );
    assert_int_equal( strlen( text ), size );
    return text;
}

static inline results empty_results( void )
{
    return ( results ){ .machine = machine_describe( "avx2" ) };
}

static inline void assert_near( double value, double expected, double tolerance )
{
    if ( !( fabs( value - expected ) <= tolerance ) )
    {
        fail_msg( "%.17g is not within %g of %.17g", value, tolerance, expected );
    }
}

static inline int count_of( const char* page, const char* text )
{
    int count = 0;
    for ( const char* at = strstr( page, text ); at; at = strstr( at + 1, text ) )
    {
        ++count;
    }
    return count;
}

// ---- tags ----

#define DEPTH_MAX 64

static inline const char* skip_name( const char* at )
{
    while ( isalnum( (unsigned char)*at ) || *at == '-' )
    {
        ++at;
    }
    return at;
}

/// One attribute, name="value", with its preceding blank.
static inline const char* skip_attribute( const char* at, const char* tag )
{
    const char* end = skip_name( at );
    if ( end == at || end[0] != '=' || end[1] != '"' )
    {
        fail_msg( "an attribute of <%.30s is not name=\"value\"", tag );
    }
    end += 2;
    end += strcspn( end, "\"<" );
    if ( *end != '"' )
    {
        fail_msg( "an attribute of <%.30s does not end", tag );
    }
    return end + 1;
}

static inline void check_entity( const char* at )
{
    static const char* const known[] = { "&amp;", "&lt;", "&gt;", "&quot;", "&#39;" };
    for ( int i = 0; i < WISP_COUNT( known ); ++i )
    {
        if ( strncmp( at, known[i], strlen( known[i] ) ) == 0 )
        {
            return;
        }
    }
    fail_msg( "'%.20s' is not escaped", at );
}

/// Every tag is closed in the right order, every attribute is quoted, and nothing else resembles a tag.
static inline void assert_well_formed( const char* page )
{
    const char* open[DEPTH_MAX];
    int depth = 0;
    const char* start = "<!DOCTYPE html>\n";
    assert_memory_equal( page, start, strlen( start ) );
    for ( const char* at = page + strlen( start ); *at; )
    {
        if ( *at == '&' )
        {
            check_entity( at );
        }
        if ( *at != '<' )
        {
            unsigned char c = (unsigned char)*at++;
            assert_true( c >= 0x20 || c == '\n' || c == '\t' );
            continue;
        }
        const char* tag = at + 1 + ( at[1] == '/' );
        const char* end = skip_name( tag );
        assert_true( end > tag );
        if ( at[1] == '/' )
        {
            assert_true( depth > 0 && *end == '>' );
            const char* begun = open[--depth];
            if ( strncmp( begun, tag, (size_t)( end - tag ) ) != 0 || skip_name( begun ) - begun != end - tag )
            {
                fail_msg( "<%.30s ends with </%.30s", begun, tag );
            }
            at = end + 1;
            continue;
        }
        while ( *end == ' ' )
        {
            end = skip_attribute( end + 1, tag );
        }
        bool is_alone = *end == '/';
        end += is_alone;
        if ( *end != '>' )
        {
            fail_msg( "<%.30s does not end", tag );
        }
        assert_true( is_alone || depth < DEPTH_MAX );
        if ( !is_alone )
        {
            open[depth++] = tag;
        }
        at = end + 1;
    }
    assert_int_equal( depth, 0 );
}

/// Needs no network and runs no script.
static inline void assert_stands_alone( const char* page )
{
    static const char* const foreign[] = { "http:",   "https:", "<script", "<link",
                                           "<iframe", "url(",   "@import", "javascript:" };
    for ( int i = 0; i < WISP_COUNT( foreign ); ++i )
    {
        assert_null( strstr( page, foreign[i] ) );
    }
    for ( const char* at = strstr( page, "src=\"" ); at; at = strstr( at + 1, "src=\"" ) )
    {
        assert_memory_equal( at, "src=\"data:image/png;base64,", strlen( "src=\"data:image/png;base64," ) );
    }
}

/// Every link leads to one position of the page.
static inline void assert_anchors( const char* page )
{
    for ( const char* at = strstr( page, "href=\"#" ); at; at = strstr( at + 1, "href=\"#" ) )
    {
        char id[80];
        const char* name = at + strlen( "href=\"#" );
        snprintf( id, sizeof( id ), " id=\"%.*s\"", (int)strcspn( name, "\"" ), name );
        if ( count_of( page, id ) != 1 )
        {
            fail_msg( "there are %d places%s", count_of( page, id ), id );
        }
    }
}

// ---- charts ----

/// The number after `name="` of the tag at a position.
static inline double attribute_of( const char* tag, const char* name )
{
    char requested[40];
    snprintf( requested, sizeof( requested ), " %s=\"", name );
    const char* found = strstr( tag, requested );
    assert_non_null( found );
    assert_true( found < tag + strcspn( tag, ">" ) );
    return strtod( found + strlen( requested ), NULL );
}

/// The plot of the first chart.
static inline const char* plot_of( const char* page )
{
    const char* plot = strstr( page, "<svg class=\"plot\"" );
    assert_non_null( plot );
    return plot;
}

/// Coordinate of the tick with this label. @param axis 'x' or 'y'
static inline double tick_at( const char* page, char axis, const char* label )
{
    char requested[40], end[80];
    snprintf( requested, sizeof( requested ), "<text class=\"tick %c\"", axis );
    snprintf( end, sizeof( end ), ">%s</text>", label );
    for ( const char* at = strstr( plot_of( page ), requested ); at; at = strstr( at + 1, requested ) )
    {
        if ( strncmp( strchr( at, '>' ), end, strlen( end ) ) == 0 )
        {
            // A label of the y axis is slightly below its line.
            return axis == 'x' ? attribute_of( at, "x" ) : attribute_of( at, "y" ) - 4.0;
        }
    }
    fail_msg( "there is no %c tick '%s'", axis, label );
    return NAN;
}

typedef struct drawn_point
{
    double x, y;
} drawn_point;

/// A point of the first plot, in the order of drawing.
static inline drawn_point point_at( const char* page, int number )
{
    const char* at = strstr( plot_of( page ), "<use " );
    for ( int i = 0; i < number && at; ++i )
    {
        at = strstr( at + 1, "<use " );
    }
    assert_non_null( at );
    return ( drawn_point ){ attribute_of( at, "x" ), attribute_of( at, "y" ) };
}

/// Points of the first plot; those of the key come after its end.
static inline int point_count( const char* page )
{
    const char* plot = plot_of( page );
    const char* end = strstr( plot, "</svg>" );
    int count = 0;
    for ( const char* at = strstr( plot, "<use " ); at && at < end; at = strstr( at + 1, "<use " ) )
    {
        ++count;
    }
    return count;
}

// ---- base64 ----

static inline int digit_of( char c )
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char* found = strchr( digits, c );
    return found && c ? (int)( found - digits ) : -1;
}

/// @return the number of bytes of a text that ends with a quote
static inline size_t decode_base64( const char* text, unsigned char* out, size_t size )
{
    size_t count = 0;
    unsigned bits = 0;
    int held = 0;
    for ( ; *text != '"' && *text != '='; ++text )
    {
        assert_true( digit_of( *text ) >= 0 );
        bits = bits << 6 | (unsigned)digit_of( *text );
        held += 6;
        if ( held >= 8 )
        {
            held -= 8;
            assert_true( count < size );
            out[count++] = (unsigned char)( bits >> held );
        }
    }
    return count;
}
