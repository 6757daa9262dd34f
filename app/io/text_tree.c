#include "text_tree.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void* demand( void* memory )
{
    if ( memory == NULL )
    {
        fputs( "wisp: out of memory\n", stderr );
        exit( 2 );
    }
    return memory;
}

void* text_alloc( size_t size )
{
    return demand( calloc( 1, size + 1 ) );
}

static char* copy_text( const char* text )
{
    const size_t size = strlen( text ) + 1;
    return memcpy( text_alloc( size ), text, size );
}

// ---- nodes ----

text_node* text_make( text_kind kind )
{
    text_node* node = calloc( 1, sizeof *node );
    if ( node != NULL )
    {
        node->kind = kind;
    }
    return node;
}

bool text_append( text_node* parent, text_node* child )
{
    if ( parent->count == parent->capacity )
    {
        const int capacity = 2 * parent->capacity + 4;
        text_node** children = realloc( parent->children, (size_t)capacity * sizeof *children );
        if ( children == NULL )
        {
            return false;
        }
        parent->children = children;
        parent->capacity = capacity;
    }
    if ( parent->count > 0 )
    {
        parent->children[parent->count - 1]->next = child;
    }
    child->next = NULL;
    parent->children[parent->count++] = child;
    return true;
}

static text_node* make( text_kind kind )
{
    return demand( text_make( kind ) );
}

text_node* text_list( void )
{
    return make( TEXT_LIST );
}

text_node* text_map( void )
{
    return make( TEXT_MAP );
}

text_node* text_scalar( const char* format, ... )
{
    char text[256];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( text, sizeof text, format, arguments );
    va_end( arguments );
    text_node* node = make( TEXT_SCALAR );
    node->text = copy_text( text );
    return node;
}

text_node* text_copy( const text_node* node )
{
    text_node* copy = make( node->kind );
    copy->key = node->key ? copy_text( node->key ) : NULL;
    copy->text = node->text ? copy_text( node->text ) : NULL;
    for ( int i = 0; i < node->count; ++i )
    {
        text_add( copy, text_copy( node->children[i] ) );
    }
    return copy;
}

void text_release( text_node* node )
{
    if ( node == NULL )
    {
        return;
    }
    for ( int i = 0; i < node->count; ++i )
    {
        text_release( node->children[i] );
    }
    free( node->children );
    free( node->key );
    free( node->text );
    free( node );
}

text_node* text_add( text_node* list, text_node* value )
{
    demand( text_append( list, value ) ? value : NULL );
    return value;
}

static int index_of( const text_node* map, const char* key )
{
    for ( int i = 0; map && map->kind == TEXT_MAP && i < map->count; ++i )
    {
        if ( strcmp( map->children[i]->key, key ) == 0 )
        {
            return i;
        }
    }
    return -1;
}

text_node* text_put( text_node* map, const char* key, text_node* value )
{
    char* copy = copy_text( key );
    free( value->key );
    value->key = copy;
    const int i = index_of( map, key );
    if ( i < 0 )
    {
        return text_add( map, value );
    }
    value->next = map->children[i]->next;
    if ( i > 0 )
    {
        map->children[i - 1]->next = value;
    }
    text_release( map->children[i] );
    return map->children[i] = value;
}

text_node* text_find( const text_node* map, const char* key )
{
    const int i = index_of( map, key );
    return i < 0 ? NULL : map->children[i];
}

const text_node* text_find_path( const text_node* map, const char* path )
{
    const size_t length = strcspn( path, "." );
    const text_node* child = map != NULL && map->kind == TEXT_MAP ? text_first( map ) : NULL;
    while ( child != NULL && ( strncmp( child->key, path, length ) != 0 || child->key[length] != '\0' ) )
    {
        child = child->next;
    }
    return child != NULL && path[length] == '.' ? text_find_path( child, path + length + 1 ) : child;
}

const char* text_at( const text_node* map, const char* key )
{
    const text_node* node = text_find( map, key );
    return node ? text_value( node ) : "";
}

static void text_remove( text_node* parent, int child )
{
    if ( child > 0 )
    {
        parent->children[child - 1]->next = parent->children[child]->next;
    }
    text_release( parent->children[child] );
    --parent->count;
    memmove( parent->children + child, parent->children + child + 1,
             (size_t)( parent->count - child ) * sizeof *parent->children );
}

void text_remove_key( text_node* map, const char* key )
{
    const int i = index_of( map, key );
    if ( i >= 0 )
    {
        text_remove( map, i );
    }
}

static void text_set( text_node* scalar, const char* text )
{
    char* copy = copy_text( text );
    free( scalar->text );
    scalar->text = copy;
}

bool text_is_number( const text_node* node, double* value )
{
    if ( node == NULL || node->kind != TEXT_SCALAR || node->text[0] == '\0' )
    {
        return false;
    }
    char* end;
    const double number = strtod( node->text, &end );
    if ( value )
    {
        *value = number;
    }
    return *end == '\0' && number - number == 0.0;
}

void text_set_number( text_node* scalar, double value )
{
    char text[40];
    snprintf( text, sizeof text, "%.9g", value );
    text_set( scalar, text );
}

int text_size( const text_node* node )
{
    int size = 1;
    for ( int i = 0; i < node->count; ++i )
    {
        size += text_size( node->children[i] );
    }
    return size;
}

// ---- fields by path ----

// Whether an index, which is a number, a name or `*`, means an entry of a list.
static bool is_entry_meant( const text_node* list, int i, const char* index )
{
    char number[16];
    snprintf( number, sizeof number, "%d", i );
    return strcmp( index, "*" ) == 0 || strcmp( index, number ) == 0 ||
           strcmp( index, text_at( list->children[i], "name" ) ) == 0;
}

// From the end, so that numbers stay. @return how many were removed
static int remove_entries( text_node* list, const char* index )
{
    int count = 0;
    for ( int i = list->count - 1; i >= 0; --i )
    {
        if ( is_entry_meant( list, i, index ) )
        {
            text_remove( list, i );
            ++count;
        }
    }
    return count;
}

int text_set_path( text_node* scene, const char* path, const text_node* value )
{
    char key[80] = "", index[80] = "";
    const bool is_entry = sscanf( path, "%79[^.[][%79[^]]", key, index ) == 2;
    const bool is_removal = value->kind == TEXT_SCALAR && strcmp( value->text, "null" ) == 0;
    const char* dot = strchr( path + strlen( key ) + strlen( index ), '.' );
    text_node* child = text_find( scene, key );
    if ( scene->kind != TEXT_MAP || ( is_entry && ( child == NULL || child->kind != TEXT_LIST ) ) )
    {
        return 0;
    }
    if ( is_entry )
    {
        int count = dot == NULL && is_removal ? remove_entries( child, index ) : 0;
        for ( int i = 0; dot && i < child->count; ++i )
        {
            count += is_entry_meant( child, i, index ) ? text_set_path( child->children[i], dot + 1, value ) : 0;
        }
        return count;
    }
    if ( dot )
    {
        return text_set_path( child ? child : text_put( scene, key, text_map() ), dot + 1, value );
    }
    if ( is_removal )
    {
        text_remove_key( scene, key );
        return 1;
    }
    text_put( scene, key, text_copy( value ) );
    return 1;
}

// ---- writing ----

static const int LINE_LENGTH = 118;

// Numbers, words and names stand as they are; a path may hold anything and gets quotes.
static bool needs_quotes( const char* text )
{
    return text[0] == '\0' ||
           strspn( text, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.+-" ) != strlen( text );
}

static void write_scalar( FILE* out, const char* text )
{
    if ( !needs_quotes( text ) )
    {
        fputs( text, out );
        return;
    }
    fputc( '"', out );
    for ( ; *text; ++text )
    {
        fprintf( out, *text == '"' || *text == '\\' ? "\\%c" : "%c", *text );
    }
    fputc( '"', out );
}

static void write_flow( FILE* out, const text_node* node )
{
    if ( node->kind == TEXT_SCALAR )
    {
        write_scalar( out, node->text );
        return;
    }
    const bool is_map = node->kind == TEXT_MAP, is_empty = node->count == 0;
    fputs( !is_map ? "[" : is_empty ? "{" : "{ ", out );
    for ( int i = 0; i < node->count; ++i )
    {
        fputs( i > 0 ? ", " : "", out );
        if ( is_map )
        {
            fprintf( out, "%s: ", node->children[i]->key );
        }
        write_flow( out, node->children[i] );
    }
    fputs( !is_map ? "]" : is_empty ? "}" : " }", out );
}

static int flow_length( const text_node* node )
{
    int length = node->kind == TEXT_SCALAR ? (int)strlen( node->text ) + 2 : 4;
    for ( int i = 0; i < node->count; ++i )
    {
        const text_node* child = node->children[i];
        length += flow_length( child ) + 2 + ( child->key ? (int)strlen( child->key ) + 2 : 0 );
    }
    return length;
}

static bool fits_a_line( const text_node* node, int depth )
{
    const bool is_entry_list =
        depth == 1 && node->kind == TEXT_LIST && node->count > 0 && node->children[0]->kind == TEXT_MAP;
    return node->kind == TEXT_SCALAR || node->count == 0 ||
           ( !is_entry_list && depth > 0 && flow_length( node ) + 2 * depth < LINE_LENGTH - 24 );
}

// Write what follows a key or a dash, up to the end of the line: entries of the scene's lists have lines of their
// own.
static void write_block( FILE* out, const text_node* node, int depth, bool is_after_dash )
{
    if ( fits_a_line( node, depth ) )
    {
        fputc( ' ', out );
        write_flow( out, node );
        fputc( '\n', out );
        return;
    }
    fputs( is_after_dash ? " " : depth > 0 ? "\n" : "", out );
    for ( int i = 0; i < node->count; ++i )
    {
        const text_node* child = node->children[i];
        const bool is_map = node->kind == TEXT_MAP;
        fprintf( out, "%*s%s%s", is_after_dash && i == 0 ? 0 : 2 * depth, "", is_map ? child->key : "-",
                 is_map ? ":" : "" );
        write_block( out, child, depth + 1, !is_map );
    }
}

char* text_write( const text_node* root, const char* comment )
{
    char* text = NULL;
    size_t size = 0;
    FILE* out = open_memstream( &text, &size );
    if ( out == NULL )
    {
        return copy_text( "" );
    }
    for ( const char* line = comment; line && *line; )
    {
        const int length = (int)strcspn( line, "\n" );
        fprintf( out, "# %.*s\n", length, line );
        line += length + ( line[length] == '\n' );
    }
    write_block( out, root, 0, false );
    fclose( out );
    return text;
}
