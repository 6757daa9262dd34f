#include "scene_schema.h"

#include "io_file.h"
#include "nearest.h"
#include "scene_parts.h"
#include "scene_reader.h"
#include "scene_keys.h"

#include "wisp/module/definition.h"
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- names ----

// Entries that have a name, and values that name them.

static const struct
{
    const char *one, *there_is;
} WORDS[] = {
    [SCENE_STRANDS] = { "strands", "there are no strands" },
    [SCENE_SURFACE] = { "surface", "there is no surface" },
    [SCENE_COLLIDER] = { "collider", "there is no collider" },
    [SCENE_SEAM] = { "seam", "there is no seam" },
};

// Entries of one name stay in the order of the lists, and within a list in that of the file.
static int compare_names( const void* a, const void* b )
{
    const scene_name *x = a, *y = b;
    int order = strcmp( x->text, y->text );
    order = order ? order : (int)x->what - (int)y->what;
    return order ? order : ( x->index > y->index ) - ( x->index < y->index );
}

// Sorted first: comparing each with each would take minutes for a hostile list.
static wisp_status refuse_equal_names( scene_reader* r )
{
    for ( int i = 1; i < r->name_count; ++i )
    {
        const scene_name *name = &r->names[i], *before = name - 1;
        if ( strcmp( name->text, before->text ) == 0 )
        {
            scene_enter_index( r, name->index );
            return scene_refuse( r->source, name->line, name->column, r->path,
                                 "the name '%s' is taken by the %s in line %d", name->text, WORDS[before->what].one,
                                 before->line );
        }
    }
    return WISP_OK;
}

wisp_status scene_register( scene_reader* r, scene_named what, const void* entries, size_t size, int count )
{
    if ( count == 0 )
    {
        return WISP_OK;
    }
    scene_name* names = scene_take( r->scene, (size_t)r->name_count + (size_t)count, sizeof *names );
    if ( !names )
    {
        return scene_no_memory( r );
    }
    if ( r->name_count > 0 )
    {
        memcpy( names, r->names, (size_t)r->name_count * sizeof *names );
    }
    for ( int i = 0; i < count; ++i )
    {
        const scene_entry* entry = (const void*)( (const char*)entries + (size_t)i * size );
        names[r->name_count + i] = ( scene_name ){ entry->name, i, entry->line, entry->column, what };
    }
    r->names = names;
    r->name_count += count;
    qsort( names, (size_t)r->name_count, sizeof *names, compare_names );
    return refuse_equal_names( r );
}

// ---- values that name an entry ----

static wisp_status refuse_name( scene_reader* r, const text_node* node, const char* text, const scene_name* other,
                                scene_named what )
{
    const scene_quote quote = scene_shorten( text );
    if ( other )
    {
        return scene_refuse_node( r, node, "%s '%s': that is the %s in line %d", WORDS[what].there_is, quote.text,
                                  WORDS[other->what].one, other->line );
    }
    const char** known = scene_take( r->scene, (size_t)r->name_count + 1, sizeof *known );
    if ( !known )
    {
        return scene_no_memory( r );
    }
    int count = 0;
    for ( int i = 0; i < r->name_count; ++i )
    {
        if ( r->names[i].what == what )
        {
            known[count++] = r->names[i].text;
        }
    }
    const char* near = nearest_word( text, known, count );
    return scene_refuse_node( r, node, "%s '%s'%s%s%s%s", WORDS[what].there_is, quote.text,
                              count == 0 ? ": the scene has none" : "", near ? ", did you mean '" : "",
                              near ? near : "", near ? "'?" : "" );
}

static int compare_text( const void* key, const void* element )
{
    return strcmp( key, ( (const scene_name*)element )->text );
}

const scene_name* scene_find_name( const scene_reader* r, const char* text )
{
    return r->name_count ? bsearch( text, r->names, (size_t)r->name_count, sizeof( scene_name ), compare_text )
                         : NULL;
}

wisp_status scene_read_named( scene_reader* r, const text_node* node, scene_named what, int* index )
{
    const char* text = NULL;
    WISP_TRY( scene_read_text( r, node, &text ) );
    const scene_name* found = scene_find_name( r, text );
    if ( !found || found->what != what )
    {
        return refuse_name( r, node, text, found, what );
    }
    *index = found->index;
    return WISP_OK;
}

// ---- reader ----

// ---- memory ----

void* scene_take( wisp_scene* scene, size_t count, size_t size )
{
    io_memory memory = { .last = scene->blocks };
    void* block = count > 0 && count <= SIZE_MAX / 2 / size ? io_get( &memory, count * size ) : NULL;
    scene->blocks = memory.last;
    return block;
}

const char* scene_print( wisp_scene* scene, const char* format, ... )
{
    va_list arguments, again;
    va_start( arguments, format );
    va_copy( again, arguments );
    const int length = vsnprintf( NULL, 0, format, arguments );
    char* text = scene_take( scene, (size_t)length + 1, 1 );
    if ( text )
    {
        vsnprintf( text, (size_t)length + 1, format, again );
    }
    va_end( again );
    va_end( arguments );
    return text;
}

void wisp_scene_release( wisp_scene* scene )
{
    if ( scene )
    {
        io_release( &( io_memory ){ .last = scene->blocks } );
        *scene = ( wisp_scene ){ 0 };
    }
}

wisp_status scene_no_memory( const scene_reader* r )
{
    return wisp_fail( r->source->error, WISP_NO_MEMORY, "%s: out of memory for the scene",
                      io_short_name( r->source->name ) );
}

// ---- where we are ----

static size_t lengthen( scene_reader* r, int printed )
{
    size_t before = r->path_length;
    size_t room = sizeof r->path - before - 1;
    r->path_length += (size_t)printed < room ? (size_t)printed : room;
    return before;
}

size_t scene_enter_key( scene_reader* r, const char* key )
{
    return lengthen( r, snprintf( r->path + r->path_length, sizeof r->path - r->path_length, "%s%s",
                                  r->path_length ? "." : "", key ) );
}

size_t scene_enter_index( scene_reader* r, int index )
{
    return lengthen( r, snprintf( r->path + r->path_length, sizeof r->path - r->path_length, "[%d]", index ) );
}

void scene_leave( scene_reader* r, size_t path_length )
{
    r->path_length = path_length;
    r->path[path_length] = 0;
}

wisp_status scene_refuse_node( const scene_reader* r, const text_node* node, const char* format, ... )
{
    char message[420];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( message, sizeof message, format, arguments );
    va_end( arguments );
    return scene_refuse( r->source, node->line, node->column, r->path, "%s", message );
}

// ---- values ----

// A float needs no more letters.
#define LONGEST_NUMBER 64

static const char SEED_RANGE[] = "a whole number in [0, 18446744073709551615]";

// Not isdigit() and its kin, which follow the host's locale.
static bool is_digit( char c )
{
    return c >= '0' && c <= '9';
}

static bool is_letter( char c )
{
    return ( c >= 'a' && c <= 'z' ) || ( c >= 'A' && c <= 'Z' );
}

static bool is_nothing( const char* text )
{
    return text[0] == 0 || strcmp( text, "~" ) == 0 || strcmp( text, "null" ) == 0;
}

static size_t digits( const char* text )
{
    size_t n = 0;
    while ( is_digit( text[n] ) )
    {
        ++n;
    }
    return n;
}

// Letters of the decimal number that a text begins with: [+-] digits [. digits] [e [+-] digits]; 0 if there is none.
// Hexadecimal, octal, underscores and base 60 are numbers in YAML 1.1 and are refused here.
static size_t number_prefix( const char* text, bool* whole )
{
    size_t n = text[0] == '-' || text[0] == '+';
    size_t integral = digits( text + n );
    n += integral;
    *whole = integral > 0;
    size_t fraction = text[n] == '.' ? digits( text + n + 1 ) : 0;
    if ( text[n] == '.' && integral + fraction > 0 )
    {
        n += 1 + fraction;
        *whole = false;
    }
    if ( integral + fraction == 0 )
    {
        return 0;
    }
    if ( text[n] == 'e' || text[n] == 'E' )
    {
        size_t sign = text[n + 1] == '-' || text[n + 1] == '+';
        size_t exponent = digits( text + n + 1 + sign );
        if ( exponent > 0 )
        {
            n += 1 + sign + exponent;
            *whole = false;
        }
    }
    return n;
}

// YAML 1.1 reads 010 as 8, JSON refuses it, people mean 10.
static bool has_leading_zero( const char* text )
{
    text += *text == '-' || *text == '+';
    return text[0] == '0' && is_digit( text[1] );
}

static bool is_not_finite( const char* text )
{
    static const char* const words[] = { "nan", "inf", "infinity" };
    text += *text == '-' || *text == '+';
    text += *text == '.';
    for ( int i = 0; i < WISP_COUNT( words ); ++i )
    {
        size_t n = 0;
        while ( words[i][n] && ( text[n] == words[i][n] || text[n] == words[i][n] - 'a' + 'A' ) )
        {
            ++n;
        }
        if ( !words[i][n] && !text[n] )
        {
            return true;
        }
    }
    return false;
}

// What follows a number is a unit if it is made of letters, powers, a percent or a degree sign; 0x10 is not ten x.
static bool is_unit( const char* text, size_t number )
{
    const char* rest = text + number;
    if ( text[number - 1] == '0' && ( *rest == 'x' || *rest == 'o' || *rest == 'b' ) )
    {
        return false;
    }
    while ( *rest == ' ' )
    {
        ++rest;
    }
    bool power = false; // behind a ^
    for ( ; *rest; ++rest )
    {
        bool exponent = power && ( is_digit( *rest ) || *rest == '-' );
        if ( !exponent && !is_letter( *rest ) && *rest != '%' && *rest != '/' && *rest != '^' &&
             (unsigned char)*rest < 0x80 )
        {
            return false;
        }
        power = exponent || *rest == '^';
    }
    return true;
}

wisp_status scene_refuse_kind( const scene_reader* r, const text_node* node, const char* requested )
{
    if ( node->kind != TEXT_SCALAR )
    {
        return scene_refuse_node( r, node, "got a %s, expected %s", node->kind == TEXT_LIST ? "list" : "mapping",
                                  requested );
    }
    const char* text = text_value( node );
    if ( text[0] == 0 || ( node->plain && is_nothing( text ) ) )
    {
        return scene_refuse_node( r, node, "got nothing, expected %s", requested );
    }
    return scene_refuse_node( r, node, "got %s'%s', expected %s", node->plain ? "" : "the text ",
                              scene_shorten( text ).text, requested );
}

// A text that is a number, whole or not. On refusal the message guesses what was meant.
static wisp_status expect_number( scene_reader* r, const text_node* node, const char* unit, const char* requested,
                                  bool* whole )
{
    if ( node->kind != TEXT_SCALAR )
    {
        return scene_refuse_kind( r, node, requested );
    }
    const char* text = text_value( node );
    size_t length = strlen( text );
    size_t prefix = length > LONGEST_NUMBER ? 0 : number_prefix( text, whole );
    scene_quote quote = scene_shorten( text );
    if ( prefix == 0 && is_not_finite( text ) )
    {
        return scene_refuse_node( r, node, "got '%s', expected a finite number", quote.text );
    }
    if ( prefix == 0 )
    {
        return scene_refuse_kind( r, node, requested );
    }
    if ( prefix == length && !node->plain )
    {
        return scene_refuse_node( r, node, "got the text '%s', expected %s; write it without quotes", quote.text,
                                  requested );
    }
    if ( prefix == length && has_leading_zero( text ) )
    {
        return scene_refuse_node( r, node, "got '%s', which is octal in YAML 1.1, expected no leading zero",
                                  quote.text );
    }
    if ( prefix == length )
    {
        return WISP_OK;
    }
    if ( text[prefix] == ',' && is_digit( text[prefix + 1] ) )
    {
        return scene_refuse_node( r, node, "got '%s', expected a decimal point instead of the comma", quote.text );
    }
    if ( is_unit( text, prefix ) )
    {
        return scene_refuse_node( r, node, "got '%s', expected a number %s%s%s", quote.text,
                                  unit ? "in " : "without a unit", unit ? unit : "",
                                  unit ? " without its unit" : "" );
    }
    return scene_refuse_kind( r, node, requested );
}

static wisp_status refuse_range( const scene_reader* r, const text_node* node, const scene_range* range )
{
    return scene_refuse_node( r, node, "got %s, expected a value in [%.9g, %.9g]",
                              scene_shorten( text_value( node ) ).text, range->lower, range->upper );
}

wisp_status scene_read_number( scene_reader* r, const text_node* node, const scene_field* field, float* out )
{
    bool whole = false;
    WISP_TRY( expect_number( r, node, field->unit, "a number", &whole ) );
    // The range is checked as the module will see the number: after rounding. 1e999 becomes infinite here and is out
    // of every range.
    float value = strtof( text_value( node ), NULL );
    if ( !( value >= (float)field->range.lower && value <= (float)field->range.upper ) )
    {
        return refuse_range( r, node, &field->range );
    }
    *out = value;
    return WISP_OK;
}

wisp_status scene_read_whole( scene_reader* r, const text_node* node, const scene_field* field, int* out )
{
    bool whole = false;
    WISP_TRY( expect_number( r, node, field->unit, "a whole number", &whole ) );
    if ( !whole )
    {
        return scene_refuse_kind( r, node, "a whole number" );
    }
    // strtoll stops at the ends of its range, and every field's range is narrower.
    long long value = strtoll( text_value( node ), NULL, 10 );
    if ( (double)value < field->range.lower || (double)value > field->range.upper )
    {
        return refuse_range( r, node, &field->range );
    }
    *out = (int)value;
    return WISP_OK;
}

wisp_status scene_read_seed( scene_reader* r, const text_node* node, uint64_t* out )
{
    bool whole = false;
    WISP_TRY( expect_number( r, node, NULL, SEED_RANGE, &whole ) );
    const char* text = text_value( node );
    errno = 0;
    unsigned long long value = strtoull( text, NULL, 10 );
    if ( !whole || text[0] == '-' || errno == ERANGE )
    {
        return scene_refuse_kind( r, node, SEED_RANGE );
    }
    *out = value;
    return WISP_OK;
}

// YAML 1.1 has yes, no, on and off as well; JSON and YAML 1.2 read those as text.
wisp_status scene_read_switch( scene_reader* r, const text_node* node, bool* out )
{
    const char* text = text_value( node );
    bool yes = strcmp( text, "true" ) == 0, no = strcmp( text, "false" ) == 0;
    if ( node->kind != TEXT_SCALAR || !node->plain || ( !yes && !no ) )
    {
        return scene_refuse_kind( r, node, "true or false" );
    }
    *out = yes;
    return WISP_OK;
}

wisp_status scene_read_choice( scene_reader* r, const text_node* node, const scene_choice* choices, int* out )
{
    const char* words[SCENE_MAX_CHOICES];
    int count = 0;
    char list[160] = "one of ";
    for ( size_t used = strlen( list ); count < SCENE_MAX_CHOICES && choices[count].word; ++count )
    {
        words[count] = choices[count].word;
        int n = snprintf( list + used, sizeof list - used, "%s%s", count ? ", " : "", words[count] );
        used += (size_t)n < sizeof list - used ? (size_t)n : sizeof list - used - 1;
    }
    const char* text = text_value( node );
    if ( node->kind != TEXT_SCALAR || ( node->plain && is_nothing( text ) ) )
    {
        return scene_refuse_kind( r, node, list );
    }
    for ( int i = 0; i < count; ++i )
    {
        if ( strcmp( text, words[i] ) == 0 )
        {
            *out = i;
            return WISP_OK;
        }
    }
    const char* use = scene_find_removed( r->path, text, true );
    if ( use )
    {
        return scene_refuse_node( r, node, "'%s' is gone; %s", text, use );
    }
    const char* near = nearest_word( text, words, count );
    return scene_refuse_node( r, node, "got '%s', expected %s%s%s%s", scene_shorten( text ).text, list,
                              near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "" );
}

wisp_status scene_read_shape( scene_reader* r, const text_node* node, const scene_choice* shapes, int* out )
{
    const text_node* child = text_find_path( node, "shape" );
    if ( !child )
    {
        return node->kind == TEXT_MAP ? scene_refuse_node( r, node, "key 'shape' is missing" )
                                      : scene_refuse_kind( r, node, "a mapping with the key 'shape'" );
    }
    size_t outside = scene_enter_key( r, "shape" );
    WISP_TRY( scene_read_choice( r, child, shapes, out ) );
    scene_leave( r, outside );
    return WISP_OK;
}

wisp_status scene_expect_pair( scene_reader* r, const text_node* node, const char* requested )
{
    if ( node->kind != TEXT_LIST )
    {
        return scene_refuse_kind( r, node, requested );
    }
    return node->count == 2 ? WISP_OK
                            : scene_refuse_node( r, node, "got a list of %d, expected %s", node->count, requested );
}

wisp_status scene_read_text( scene_reader* r, const text_node* node, const char** out )
{
    const char* text = text_value( node );
    if ( node->kind != TEXT_SCALAR || text[0] == 0 || ( node->plain && is_nothing( text ) ) )
    {
        return scene_refuse_kind( r, node, "text" );
    }
    size_t length = strlen( text );
    if ( length > 1000 )
    {
        return scene_refuse_node( r, node, "got %zu letters, expected at most 1000", length );
    }
    *out = scene_print( r->scene, "%s", text );
    return *out ? WISP_OK : scene_no_memory( r );
}
