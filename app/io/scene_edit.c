// Values are found by the places that the reader's tree keeps, and what stands there is compared with what the tree says
// before a byte is changed: whatever is written in an unusual way is refused and not guessed at.
#include "scene_edit.h"

#include "io_file.h"
#include "scene.h"
#include "scene_text.h"

#include "wisp/module/definition.h"

#include <stdlib.h>
#include <string.h>

/// Bytes that go and bytes that come.
typedef struct patch
{
    size_t at, removed;
    int order; // of patches at one place
    char text[120];
} patch;

typedef struct editor
{
    scene_source source;
    text_node* root;
    patch* patches; // [patch_count]
    int patch_count;
} editor;

// ---- places ----

static bool stands_at( const editor* e, size_t at, const char* text )
{
    const size_t length = strlen( text );
    return at <= e->source.size && length <= e->source.size - at && memcmp( e->source.text + at, text, length ) == 0;
}

static char letter( const editor* e, size_t at )
{
    return at < e->source.size ? e->source.text[at] : '\0';
}

static size_t line_start( const editor* e, size_t at )
{
    while ( at > 0 && e->source.text[at - 1] != '\n' )
    {
        --at;
    }
    return at;
}

// Behind the line's end; the size of the text for the last line.
static size_t next_line( const editor* e, size_t at )
{
    const char* end = memchr( e->source.text + at, '\n', e->source.size - at );
    return end ? (size_t)( end + 1 - e->source.text ) : e->source.size;
}

// ---- nodes ----

static const text_node* find_map( const editor* e, const wisp_scene_edit* edit )
{
    const text_node* node = e->root;
    if ( edit->list )
    {
        node = text_find_path( node, edit->list );
        node = node && node->kind == TEXT_LIST ? text_first( node ) : NULL;
        for ( int i = 0; node && i < edit->index; ++i )
        {
            node = node->next;
        }
    }
    node = node && edit->block ? text_find_path( node, edit->block ) : node;
    return node && node->kind == TEXT_MAP ? node : NULL;
}

static bool takes_out( const wisp_scene_edit* edit )
{
    return edit->value[0] == '\0';
}

static wisp_status refuse_edit( const editor* e, const text_node* node, const wisp_scene_edit* edit )
{
    const int line = node ? node->line : 0, column = node ? node->column : 0;
    if ( takes_out( edit ) )
    {
        return scene_refuse( &e->source, line, column, "",
                             "'%s' cannot be removed here automatically; remove it by hand", edit->key );
    }
    return scene_refuse( &e->source, line, column, "", "'%s' cannot be set to %s here automatically; set it by hand",
                         edit->key, edit->value );
}

// ---- patches ----

// A value whose bytes are those that were read.
static bool is_as_written( const editor* e, const text_node* node )
{
    const char* text = text_value( node );
    return node->plain && text[0] && stands_at( e, node->at, text );
}

// @param text one line at most, with its indentation
static void add_patch( editor* e, size_t at, size_t removed, const char* text )
{
    patch* p = &e->patches[e->patch_count];
    *p = ( patch ){ .at = at, .removed = removed, .order = e->patch_count };
    snprintf( p->text, sizeof p->text, "%s", text );
    ++e->patch_count;
}

static wisp_status replace_value( editor* e, const text_node* node, const wisp_scene_edit* edit )
{
    if ( !is_as_written( e, node ) )
    {
        return refuse_edit( e, node, edit );
    }
    add_patch( e, node->at, strlen( text_value( node ) ), edit->value );
    return WISP_OK;
}

// Another key comes behind one that comes as well: a comma parts them, and the blank before a brace is not its own.
static void go_on_behind( editor* e, size_t at )
{
    int i = e->patch_count - 1;
    while ( i >= 0 && ( e->patches[i].at != at || e->patches[i].removed > 0 ) )
    {
        --i;
    }
    if ( i >= 0 )
    {
        char* text = e->patches[i].text;
        size_t length = strlen( text );
        length -= text[length - 1] == ' ';
        const char* comma = text[length - 1] == ',' ? "" : ",";
        snprintf( text + length, sizeof e->patches[i].text - length, "%s", comma );
    }
}

// Behind the brace. A file whose root has braces is taken for JSON, whose keys are quoted.
static void add_to_braces( editor* e, const text_node* map, size_t at, const wisp_scene_edit* edit )
{
    const text_node* root = e->root;
    const char* quote = letter( e, root->at ) == '{' ? "\"" : "";
    const char next = letter( e, at + 1 );
    const bool is_apart = next == ' ' || next == '\n' || next == '\r' || next == '\t';
    char text[120];
    snprintf( text, sizeof text, " %s%s%s: %s%s%s", quote, edit->key, quote, edit->value, map->count > 0 ? "," : "",
              is_apart ? "" : " " );
    go_on_behind( e, at + 1 );
    add_patch( e, at + 1, 0, text );
}

// The first key whose value ends where its line does: a new line fits behind it.
static const text_node* find_one_line( const editor* e, const text_node* map )
{
    for ( const text_node* child = text_first( map ); child; child = child->next )
    {
        if ( child->line == child->key_line && is_as_written( e, child ) )
        {
            return child;
        }
    }
    return NULL;
}

static bool is_blank( const editor* e, size_t begin, size_t end )
{
    while ( begin < end && e->source.text[begin] == ' ' )
    {
        ++begin;
    }
    return begin == end;
}

// The first key that has its line for itself: a new line fits before it.
static const text_node* find_own_line( const editor* e, const text_node* map )
{
    for ( const text_node* child = text_first( map ); child; child = child->next )
    {
        const size_t start = line_start( e, child->key_at );
        const size_t key = child->key_at;
        if ( stands_at( e, key, child->key ) && is_blank( e, start, key ) )
        {
            return child;
        }
    }
    return NULL;
}

static wisp_status add_line( editor* e, const text_node* map, const wisp_scene_edit* edit )
{
    const text_node* before = find_one_line( e, map );
    const text_node* behind = before ? NULL : find_own_line( e, map );
    const text_node* near = before ? before : behind;
    if ( !near || near->key_column > 60 )
    {
        return refuse_edit( e, map, edit );
    }
    const size_t end = next_line( e, near->key_at );
    const bool has_return = end > 1 && e->source.text[end - 2] == '\r' && e->source.text[end - 1] == '\n';
    // The last line of a file may have no end of its own.
    const bool is_open = before && end > 0 && e->source.text[end - 1] != '\n';
    const char* line_end = has_return ? "\r\n" : "\n";
    char text[120];
    snprintf( text, sizeof text, "%s%*s%s: %s%s", is_open ? line_end : "", near->key_column - 1, "", edit->key,
              edit->value, is_open ? "" : line_end );
    add_patch( e, before ? end : line_start( e, near->key_at ), 0, text );
    return WISP_OK;
}

// ---- keys that go ----

static size_t skip( const editor* e, size_t at, const char* letters )
{
    while ( at < e->source.size && strchr( letters, e->source.text[at] ) && e->source.text[at] )
    {
        ++at;
    }
    return at;
}

// From the key to the end of its value, on one line. @return false: something else is in between
static bool find_pair( const editor* e, const text_node* node, size_t* begin, size_t* end )
{
    const char* key = node->key;
    size_t at = *begin = node->key_at;
    const bool is_quoted = letter( e, at ) == '"' || letter( e, at ) == '\'';
    at += is_quoted;
    if ( !stands_at( e, at, key ) )
    {
        return false;
    }
    at = skip( e, at + strlen( key ) + is_quoted, " \t" );
    const bool has_colon = letter( e, at ) == ':';
    at = skip( e, at + has_colon, " \t" );
    *end = at + strlen( text_value( node ) );
    return has_colon && is_as_written( e, node ) && at == node->at;
}

// What was alone on its line goes with it; a comment stays where it is, and the key's place becomes its own.
static void take_out_line( editor* e, size_t begin, size_t end )
{
    const size_t start = line_start( e, begin ), rest = skip( e, end, " \t\r" );
    const bool is_last = rest == e->source.size;
    const bool is_alone = is_blank( e, start, begin ) && ( is_last || letter( e, rest ) == '\n' );
    const size_t from = is_alone ? start : begin, to = !is_alone ? skip( e, end, " \t" ) : is_last ? rest : rest + 1;
    add_patch( e, from, to - from, "" );
}

// The comma before the last key of braces goes with it. @return the size of the text: something else is before the key
static size_t find_comma_before( const editor* e, size_t begin )
{
    size_t at = begin;
    while ( at > 0 && strchr( " \t\r\n", e->source.text[at - 1] ) && e->source.text[at - 1] )
    {
        --at;
    }
    const size_t start = line_start( e, at );
    if ( at > 0 && e->source.text[at - 1] == '{' )
    {
        return begin;
    }
    // A comment may end with a comma as well.
    const bool is_comma =
        at > 0 && e->source.text[at - 1] == ',' && !memchr( e->source.text + start, '#', at - start );
    return is_comma ? at - 1 : e->source.size;
}

static bool take_out_of_braces( editor* e, size_t begin, size_t end )
{
    const size_t behind = skip( e, end, " \t\r\n" );
    if ( letter( e, behind ) == ',' && letter( e, skip( e, behind + 1, " \t\r" ) ) == '\n' )
    {
        take_out_line( e, begin, behind + 1 );
        return true;
    }
    if ( letter( e, behind ) == ',' )
    {
        add_patch( e, begin, skip( e, behind + 1, " \t" ) - begin, "" );
        return true;
    }
    const size_t from = letter( e, behind ) == '}' ? find_comma_before( e, begin ) : e->source.size;
    if ( from == e->source.size )
    {
        return false;
    }
    add_patch( e, from, end - from, "" );
    return true;
}

static wisp_status take_out( editor* e, const text_node* map, const text_node* node, const wisp_scene_edit* edit )
{
    size_t begin, end;
    if ( !find_pair( e, node, &begin, &end ) )
    {
        return refuse_edit( e, node, edit );
    }
    if ( letter( e, map->at ) == '{' )
    {
        return take_out_of_braces( e, begin, end ) ? WISP_OK : refuse_edit( e, node, edit );
    }
    take_out_line( e, begin, end );
    return WISP_OK;
}

static wisp_status add_edit( editor* e, const wisp_scene_edit* edit )
{
    const text_node* map = find_map( e, edit );
    if ( !map )
    {
        return refuse_edit( e, NULL, edit );
    }
    const text_node* node = text_find_path( map, edit->key );
    if ( takes_out( edit ) )
    {
        return node ? take_out( e, map, node, edit ) : WISP_OK;
    }
    if ( node )
    {
        return replace_value( e, node, edit );
    }
    const size_t at = map->at;
    if ( letter( e, at ) == '{' )
    {
        add_to_braces( e, map, at, edit );
        return WISP_OK;
    }
    return add_line( e, map, edit );
}

// ---- the new text ----

// What comes at a place is in front of what goes from there.
static int compare_patches( const void* a, const void* b )
{
    const patch *x = a, *y = b;
    if ( x->at != y->at )
    {
        return ( x->at > y->at ) - ( x->at < y->at );
    }
    return ( x->removed > 0 ) != ( y->removed > 0 ) ? ( x->removed > 0 ) - ( y->removed > 0 ) : x->order - y->order;
}

// Two keys of braces that go may want the same comma.
static wisp_status check_apart( const editor* e )
{
    for ( int i = 1; i < e->patch_count; ++i )
    {
        if ( e->patches[i - 1].at + e->patches[i - 1].removed > e->patches[i].at )
        {
            return scene_refuse( &e->source, 0, 0, "", "two changes are at the same place; make them by hand" );
        }
    }
    return WISP_OK;
}

// @param out receives a block for free()
static wisp_status apply( editor* e, char** out, size_t* out_size )
{
    const scene_source* s = &e->source;
    char* text = malloc( s->size + (size_t)e->patch_count * sizeof e->patches->text + 1 );
    if ( !text )
    {
        return wisp_fail( s->error, WISP_NO_MEMORY, "%s: out of memory for the scene", s->name );
    }
    size_t read = 0, written = 0;
    for ( int i = 0; i < e->patch_count; ++i )
    {
        const patch* p = &e->patches[i];
        memcpy( text + written, s->text + read, p->at - read );
        written += p->at - read;
        memcpy( text + written, p->text, strlen( p->text ) );
        written += strlen( p->text );
        read = p->at + p->removed;
    }
    memcpy( text + written, s->text + read, s->size - read );
    *out = text;
    *out_size = written + s->size - read;
    return WISP_OK;
}

static wisp_status edit_text( const scene_source* source, const wisp_scene_edit* edits, int count, char** out,
                              size_t* out_size )
{
    editor e = { .source = *source };
    e.patches = malloc( ( (size_t)count + 1 ) * sizeof *e.patches );
    wisp_status status = e.patches
                             ? scene_read_tree( source, &e.root )
                             : wisp_fail( source->error, WISP_NO_MEMORY, "out of memory for %d changes", count );
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        status = add_edit( &e, &edits[i] );
    }
    if ( status == WISP_OK )
    {
        qsort( e.patches, (size_t)e.patch_count, sizeof *e.patches, compare_patches );
        status = check_apart( &e );
    }
    status = status == WISP_OK ? apply( &e, out, out_size ) : status;
    text_release( e.root );
    free( e.patches );
    return status;
}

// The result is read as any scene is. Places of the tree do not count a byte order mark, which is kept.
wisp_status wisp_scene_edit_text( const char* text, size_t size, const char* name, const wisp_scene_edit* edits,
                                  int count, char** out, size_t* out_size, wisp_error* error )
{
    *out = NULL;
    *out_size = 0;
    const size_t mark = size >= 3 && memcmp( text, "\xef\xbb\xbf", 3 ) == 0 ? 3 : 0;
    const scene_source source = { name, text + mark, size - mark, error };
    char* edited = NULL;
    size_t edited_size = 0;
    wisp_status status = edit_text( &source, edits, count, &edited, &edited_size );
    wisp_scene scene = { 0 };
    status = status == WISP_OK ? wisp_scene_parse( edited, edited_size, name, &scene, error ) : status;
    wisp_scene_release( &scene );
    char* whole = status == WISP_OK ? malloc( mark + edited_size + 1 ) : NULL;
    if ( status == WISP_OK && !whole )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for the scene", name );
    }
    if ( status == WISP_OK )
    {
        memcpy( whole, text, mark );
        memcpy( whole + mark, edited, edited_size );
        whole[mark + edited_size] = '\0';
        *out = whole;
        *out_size = mark + edited_size;
    }
    free( edited );
    return status;
}

wisp_status wisp_scene_edit_file( const char* from, const wisp_scene_edit* edits, int count, const char* to,
                                  wisp_error* error )
{
    unsigned char* bytes = NULL;
    size_t size = 0;
    WISP_TRY( io_file_read( from, SCENE_MAX_BYTES, &bytes, &size, error ) );
    char* edited = NULL;
    size_t edited_size = 0;
    wisp_status status = wisp_scene_edit_text( bytes ? (const char*)bytes : "", size, from, edits, count, &edited,
                                               &edited_size, error );
    status = status == WISP_OK && to ? io_file_write( to, edited, edited_size, error ) : status;
    free( edited );
    free( bytes );
    return status;
}
