#include "scene_text.h"
#include "io_file.h"

#include "wisp/module/definition.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <yaml.h>

typedef struct builder
{
    const scene_source* source;
    text_node* root;
    yaml_parser_t parser;

    text_node* open[SCENE_MAX_DEPTH]; // containers being filled, outermost first
    int depth, node_count, documents;

    char* key; // of a map, was read, its value comes next
    int key_line, key_column;
    size_t key_at;

    size_t cursor_byte, cursor_character; // see byte_at()
} builder;

static bool is_continuation( char c )
{
    return ( (unsigned char)c & 0xc0u ) == 0x80u;
}

scene_quote scene_shorten( const char* text )
{
    scene_quote quote;
    size_t room = sizeof quote.text - sizeof "...";
    size_t length = strlen( text );
    if ( length < sizeof quote.text )
    {
        memcpy( quote.text, text, length + 1 );
        return quote;
    }
    while ( room > 0 && is_continuation( text[room] ) )
    {
        --room;
    }
    memcpy( quote.text, text, room );
    memcpy( quote.text + room, "...", sizeof "..." );
    return quote;
}

wisp_status scene_refuse( const scene_source* source, int line, int column, const char* path, const char* format,
                          ... )
{
    const char* name = io_short_name( source->name );
    while ( is_continuation( *name ) )
    {
        ++name;
    }

    char place[32] = "";
    if ( line > 0 )
    {
        snprintf( place, sizeof place, ":%d:%d", line, column );
    }
    char message[440];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( message, sizeof message, format, arguments );
    va_end( arguments );

    char whole_message[sizeof( (wisp_error*)0 )->message];
    snprintf( whole_message, sizeof whole_message, "%s%s: %s%s%s", name, place, path, path[0] ? ": " : "", message );
    for ( char* c = whole_message; *c; ++c )
    {
        if ( (unsigned char)*c < 0x20u || *c == 0x7f )
        {
            *c = '?';
        }
    }
    return wisp_fail( source->error, WISP_BAD_INPUT, "%s", whole_message );
}

static wisp_status out_of_memory( const scene_source* source )
{
    return wisp_fail( source->error, WISP_NO_MEMORY, "%s: out of memory for the scene",
                      io_short_name( source->name ) );
}

// Bytes of the UTF-8 character at the start of the text and its code point; 0 if there is none.
static int decode( const unsigned char* text, size_t size, uint32_t* point )
{
    static const uint32_t smallest[5] = { 0, 0, 0x80, 0x800, 0x10000 };
    int length = text[0] < 0x80   ? 1
                 : text[0] < 0xc0 ? 0
                 : text[0] < 0xe0 ? 2
                 : text[0] < 0xf0 ? 3
                 : text[0] < 0xf8 ? 4
                                  : 0;
    if ( length == 0 || (size_t)length > size )
    {
        return 0;
    }
    uint32_t value = length == 1 ? text[0] : text[0] & ( 0x7fu >> length );
    for ( int i = 1; i < length; ++i )
    {
        if ( ( text[i] & 0xc0u ) != 0x80u )
        {
            return 0;
        }
        value = value << 6 | ( text[i] & 0x3fu );
    }
    *point = value;
    bool surrogate = value >= 0xd800 && value <= 0xdfff;
    return value < smallest[length] || surrogate || value > 0x10ffff ? 0 : length;
}

// Characters that YAML lets a text hold; libyaml would refuse the others without a line.
static bool is_printable( uint32_t c )
{
    return c == '\t' || c == '\n' || c == '\r' || ( c >= 0x20 && c < 0x7f ) || c == 0x85 ||
           ( c >= 0xa0 && c <= 0xfffd && c != 0xfeff ) || c > 0xffff;
}

// Look at every byte once, before a parser that keeps less exact places does. Directives are refused here because
// libyaml compares each with all before it, which is quadratic.
static wisp_status check_letters( const scene_source* source )
{
    const unsigned char* text = (const unsigned char*)source->text;
    int line = 1, column = 1;
    for ( size_t at = 0; at < source->size; )
    {
        uint32_t c = 0;
        int length = decode( text + at, source->size - at, &c );
        if ( length == 0 )
        {
            return scene_refuse( source, line, column, "", "got byte 0x%02x, expected UTF-8", text[at] );
        }
        if ( c == 0 )
        {
            return scene_refuse( source, line, column, "", "got a NUL byte, expected text" );
        }
        if ( !is_printable( c ) )
        {
            return scene_refuse( source, line, column, "", "got control character U+%04X, expected text",
                                 (unsigned)c );
        }
        if ( c == '%' && column == 1 )
        {
            return scene_refuse( source, line, column, "", "YAML directives are not supported" );
        }

        at += (size_t)length;
        bool pair = c == '\r' && at < source->size && text[at] == '\n';
        bool new_line = ( c == '\n' || c == '\r' ) && !pair;
        line += new_line;
        column = new_line ? 1 : column + 1;
    }
    return WISP_OK;
}

// The byte at a mark, 0 at the end. libyaml's marks count characters and mostly rise, so a cursor that walks along
// finds them all in one pass over the text.
static size_t byte_at( builder* b, const yaml_mark_t* mark )
{
    if ( mark->index < b->cursor_character )
    {
        b->cursor_byte = b->cursor_character = 0;
    }
    while ( b->cursor_character < mark->index && b->cursor_byte < b->source->size )
    {
        do
        {
            ++b->cursor_byte;
        } while ( b->cursor_byte < b->source->size && is_continuation( b->source->text[b->cursor_byte] ) );
        ++b->cursor_character;
    }
    return b->cursor_byte;
}

static char letter_at( builder* b, const yaml_mark_t* mark )
{
    const size_t at = byte_at( b, mark );
    return at < b->source->size ? b->source->text[at] : 0;
}

static wisp_status refuse_mark( const builder* b, const yaml_mark_t* mark, const char* whole_message )
{
    return scene_refuse( b->source, (int)mark->line + 1, (int)mark->column + 1, "", "%s", whole_message );
}

static wisp_status refuse_syntax( builder* b )
{
    const yaml_parser_t* p = &b->parser;
    if ( p->error == YAML_MEMORY_ERROR )
    {
        return out_of_memory( b->source );
    }
    if ( letter_at( b, &p->problem_mark ) == '\t' )
    {
        return refuse_mark( b, &p->problem_mark, "got a tab, expected spaces" );
    }
    return scene_refuse( b->source, (int)p->problem_mark.line + 1, (int)p->problem_mark.column + 1, "",
                         "not YAML: %s%s%s", p->context ? p->context : "", p->context ? ", " : "",
                         p->problem ? p->problem : "unknown problem" );
}

// Append a value to the innermost open container, under the pending key if that is a map.
static wisp_status add_node( builder* b, text_kind kind, const yaml_mark_t* mark, text_node** out )
{
    if ( b->node_count++ == SCENE_MAX_NODES )
    {
        return scene_refuse( b->source, (int)mark->line + 1, (int)mark->column + 1, "", "expected at most %d values",
                             SCENE_MAX_NODES );
    }
    text_node* node = text_make( kind );
    if ( node == NULL || ( b->depth > 0 && !text_append( b->open[b->depth - 1], node ) ) )
    {
        text_release( node );
        return out_of_memory( b->source );
    }
    b->root = b->depth > 0 ? b->root : node;
    node->line = (int)mark->line + 1;
    node->column = (int)mark->column + 1;
    node->key_line = b->key_line;
    node->key_column = b->key_column;
    node->key_at = b->key_at;
    node->at = byte_at( b, mark );
    node->key = b->key;
    b->key = NULL;
    *out = node;
    return WISP_OK;
}

static bool requests_key( const builder* b )
{
    return b->depth > 0 && b->open[b->depth - 1]->kind == TEXT_MAP && b->key == NULL;
}

static wisp_status take_scalar( builder* b, const yaml_event_t* event )
{
    const yaml_mark_t* mark = &event->start_mark;
    const char* value = (const char*)event->data.scalar.value;
    size_t length = event->data.scalar.length;
    bool plain = event->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
    if ( memchr( value, 0, length ) )
    {
        return refuse_mark( b, mark, "got a NUL character, expected text" );
    }
    // libyaml drops the tag "!", which turns a number into text: only the byte itself tells.
    if ( event->data.scalar.plain_implicit && length > 0 && letter_at( b, mark ) == '!' )
    {
        return refuse_mark( b, mark, "YAML tags are not supported" );
    }

    text_node* node = NULL;
    char* text = strdup( value );
    if ( text == NULL )
    {
        return out_of_memory( b->source );
    }
    if ( requests_key( b ) )
    {
        b->key = text;
        b->key_line = (int)mark->line + 1;
        b->key_column = (int)mark->column + 1;
        b->key_at = byte_at( b, mark );
        return WISP_OK;
    }
    const wisp_status status = add_node( b, TEXT_SCALAR, mark, &node );
    if ( status != WISP_OK )
    {
        free( text );
        return status;
    }
    node->text = text;
    node->plain = plain;
    return WISP_OK;
}

static wisp_status open_container( builder* b, text_kind kind, const yaml_mark_t* mark )
{
    if ( requests_key( b ) )
    {
        return refuse_mark( b, mark, "got a list or mapping, expected a key" );
    }
    if ( b->depth == SCENE_MAX_DEPTH )
    {
        return scene_refuse( b->source, (int)mark->line + 1, (int)mark->column + 1, "",
                             "expected at most %d levels of lists and mappings", SCENE_MAX_DEPTH );
    }
    text_node* node = NULL;
    WISP_TRY( add_node( b, kind, mark, &node ) );
    b->open[b->depth++] = node;
    return WISP_OK;
}

static wisp_status refuse_properties( const builder* b, const yaml_mark_t* mark, const yaml_char_t* anchor,
                                      const yaml_char_t* tag )
{
    if ( anchor )
    {
        return refuse_mark( b, mark, "YAML anchors (&) are not supported; repeat the value" );
    }
    return tag ? refuse_mark( b, mark, "YAML tags are not supported" ) : WISP_OK;
}

static wisp_status take_event( builder* b, const yaml_event_t* event )
{
    const yaml_mark_t* mark = &event->start_mark;
    switch ( event->type )
    {
        case YAML_DOCUMENT_START_EVENT:
            return b->documents++ ? refuse_mark( b, mark, "got a second document, expected one" ) : WISP_OK;
        case YAML_ALIAS_EVENT:
            return refuse_mark( b, mark, "YAML aliases (*) are not supported; repeat the value" );
        case YAML_SCALAR_EVENT:
            WISP_TRY( refuse_properties( b, mark, event->data.scalar.anchor, event->data.scalar.tag ) );
            return take_scalar( b, event );
        case YAML_SEQUENCE_START_EVENT:
            WISP_TRY(
                refuse_properties( b, mark, event->data.sequence_start.anchor, event->data.sequence_start.tag ) );
            return open_container( b, TEXT_LIST, mark );
        case YAML_MAPPING_START_EVENT:
            WISP_TRY( refuse_properties( b, mark, event->data.mapping_start.anchor, event->data.mapping_start.tag ) );
            return open_container( b, TEXT_MAP, mark );
        case YAML_SEQUENCE_END_EVENT:
        case YAML_MAPPING_END_EVENT:
            b->depth--;
            return WISP_OK;
        default:
            return WISP_OK;
    }
}

static wisp_status take_events( builder* b )
{
    for ( ;; )
    {
        yaml_event_t event;
        if ( !yaml_parser_parse( &b->parser, &event ) )
        {
            return refuse_syntax( b );
        }
        bool done = event.type == YAML_STREAM_END_EVENT;
        wisp_status status = take_event( b, &event );
        yaml_event_delete( &event );
        if ( status || done )
        {
            return status;
        }
    }
}

wisp_status scene_read_tree( const scene_source* given, text_node** out )
{
    *out = NULL;
    scene_source source = *given;
    if ( source.size > SCENE_MAX_BYTES )
    {
        return scene_refuse( &source, 0, 0, "", "expected at most %zu MiB", SCENE_MAX_BYTES >> 20 );
    }
    // A byte order mark says nothing in UTF-8, and would push the columns of the first line.
    if ( source.size >= 3 && memcmp( source.text, "\xef\xbb\xbf", 3 ) == 0 )
    {
        source.text += 3;
        source.size -= 3;
    }
    WISP_TRY( check_letters( &source ) );
    builder b = { .source = &source };
    if ( !yaml_parser_initialize( &b.parser ) )
    {
        return out_of_memory( &source );
    }
    yaml_parser_set_encoding( &b.parser, YAML_UTF8_ENCODING );
    yaml_parser_set_input_string( &b.parser, (const void*)( source.size > 0 ? source.text : "" ), source.size );
    wisp_status status = take_events( &b );
    yaml_parser_delete( &b.parser );
    free( b.key );
    if ( status == WISP_OK && b.root == NULL )
    {
        status = scene_refuse( &source, 0, 0, "", "got an empty file" );
    }
    if ( status != WISP_OK )
    {
        text_release( b.root );
        return status;
    }
    *out = b.root;
    return WISP_OK;
}

wisp_status text_parse( const char* text, size_t size, const char* name, text_node** out, wisp_error* error )
{
    return scene_read_tree( &( scene_source ){ name, text, size, error }, out );
}
