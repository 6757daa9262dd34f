// Writes the reference of all keys from the tables of the reader. Defaults are read from the structs that the reader
// starts from, so nothing is written twice.
#include "scene_keys.h"

#include "nearest.h"
#include "scene_parts.h"
#include "scene_schema.h"
#include "wisp/module/definition.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- schema ----

// ---- values of more than one scalar ----

wisp_status scene_expect_list( scene_reader* r, const text_node* node, const char* what )
{
    return node->kind == TEXT_LIST ? WISP_OK : scene_refuse_kind( r, node, what );
}

wisp_status scene_read_vector( scene_reader* r, const text_node* node, const scene_field* field, wisp_vec3* out )
{
    if ( node->kind != TEXT_LIST )
    {
        return scene_refuse_kind( r, node, "a list of three numbers" );
    }
    if ( node->count != 3 )
    {
        return scene_refuse_node( r, node, "got a list of %d, expected a list of three numbers", node->count );
    }
    float parts[3];
    WISP_TRY( scene_read_numbers( r, node, field, parts ) );
    *out = ( wisp_vec3 ){ parts[0], parts[1], parts[2] };
    return WISP_OK;
}

wisp_status scene_read_pair( scene_reader* r, const text_node* node, const char* requested,
                             const scene_field fields[2], float* first, float* second )
{
    WISP_TRY( scene_expect_pair( r, node, requested ) );
    const text_node* item = text_first( node );
    WISP_TRY( scene_read_number( r, item, &fields[0], first ) );
    return scene_read_number( r, item->next, &fields[1], second );
}

// One number for all strands, or a list with one a strand. How many strands there are is known if they are made.
static wisp_status read_numbers( scene_reader* r, const text_node* node, const scene_field* field,
                                 wisp_scene_strands* strands )
{
    char* base = (char*)strands;
    if ( node->kind != TEXT_LIST )
    {
        return node->kind == TEXT_MAP ? scene_refuse_kind( r, node, "a number, or a list with one per strand" )
                                      : scene_read_number( r, node, field, (float*)(void*)( base + field->at ) );
    }
    if ( node->count == 0 )
    {
        return scene_refuse_node( r, node, "got an empty list, expected one number per strand" );
    }
    if ( strands->is_generated && node->count != strands->generator.strand_count )
    {
        return scene_refuse_node( r, node, "got %d numbers, expected %d, one per strand", node->count,
                                  strands->generator.strand_count );
    }
    float* values = scene_take( r->scene, (size_t)node->count, sizeof *values );
    if ( !values )
    {
        return scene_no_memory( r );
    }
    *(const float**)(void*)( base + field->list ) = values;
    *(int*)(void*)( base + field->list_count ) = node->count;
    return scene_read_numbers( r, node, field, values );
}

static wisp_status read_choice( scene_reader* r, const text_node* node, const scene_field* field, void* out )
{
    int choice = 0;
    WISP_TRY( scene_read_choice( r, node, field->choices, &choice ) );
    if ( field->type == SCENE_EITHER )
    {
        *(bool*)out = choice == 1;
        return WISP_OK;
    }
    // Enumerations of the headers are as wide as an int; a copy of bytes does not ask which type exactly they are.
    _Static_assert( sizeof( wisp_gap ) == sizeof choice && sizeof( wisp_frozen_base ) == sizeof choice &&
                        sizeof( wisp_frozen_update ) == sizeof choice && sizeof( wisp_groom_shape ) == sizeof choice,
                    "an enumeration is not as wide as an int" );
    _Static_assert( sizeof( wisp_solver ) == sizeof choice && sizeof( wisp_cloth_bending ) == sizeof choice &&
                        sizeof( wisp_solve_order ) == sizeof choice,
                    "an enumeration is not as wide as an int" );
    _Static_assert( sizeof( wisp_strand_stretch ) == sizeof choice && sizeof( wisp_strand_bend ) == sizeof choice &&
                        sizeof( wisp_strand_rest ) == sizeof choice &&
                        sizeof( wisp_ghost_elastic ) == sizeof choice && sizeof( wisp_curve_kind ) == sizeof choice,
                    "an enumeration is not as wide as an int" );
    _Static_assert( sizeof( wisp_implicit_weights ) == sizeof choice &&
                        sizeof( wisp_implicit_stiffness ) == sizeof choice &&
                        sizeof( wisp_integrator ) == sizeof choice,
                    "an enumeration is not as wide as an int" );
    memcpy( out, &choice, sizeof choice );
    return WISP_OK;
}

// ---- lists ----

static wisp_status scene_read_field( scene_reader* r, const text_node* node, const scene_field* field, void* base );

static wisp_status read_words( scene_reader* r, const text_node* node, const scene_field* field, void* base )
{
    char* const at = (char*)base + field->at;
    char list[200] = "a list of ";
    int count = 0, i = 0;
    while ( field->choices[count].word != NULL )
    {
        ++count;
    }
    for ( int k = 0; k < count; ++k )
    {
        snprintf( list + strlen( list ), sizeof list - strlen( list ), "%s%s",
                  k == 0          ? ""
                  : k + 1 < count ? ", "
                                  : " and ",
                  field->choices[k].word );
    }
    WISP_TRY( scene_expect_list( r, node, list ) );
    for ( const text_node* item = text_first( node ); item; item = item->next )
    {
        const size_t outside = scene_enter_index( r, i++ );
        int word = 0;
        WISP_TRY( scene_read_choice( r, item, field->choices, &word ) );
        bool* const is_on = field->switches != NULL ? (bool*)at + field->switches[word] : NULL;
        int* const bits = is_on != NULL ? NULL : (int*)(void*)at;
        if ( is_on != NULL ? *is_on : ( *bits & field->bits[word] ) != 0 )
        {
            return scene_refuse_node( r, item, "'%s' is listed twice", field->choices[word].word );
        }
        WISP_TRY( field->check != NULL ? field->check( r, item, word, base ) : WISP_OK );
        if ( is_on != NULL )
        {
            *is_on = true;
        }
        else
        {
            *bits |= field->bits[word];
        }
        scene_leave( r, outside );
    }
    return WISP_OK;
}

static wisp_status read_entries( scene_reader* r, const text_node* node, const scene_field* field, void* base )
{
    const scene_list* list = field->of;
    const bool is_one = list->is_one_too && node->kind != TEXT_LIST;
    const int count = is_one ? 1 : node->count;
    char* items = NULL;
    WISP_TRY( is_one ? WISP_OK : scene_expect_list( r, node, list->what ) );
    if ( list->most > 0 && count > list->most )
    {
        return scene_refuse_node( r, node, "got %d entries, expected at most %d", count, list->most );
    }
    if ( count == 0 )
    {
        return list->empty ? scene_refuse_node( r, node, "%s", list->empty ) : WISP_OK;
    }
    items = scene_take( r->scene, (size_t)count, list->size );
    if ( items == NULL )
    {
        return scene_no_memory( r );
    }
    memcpy( (char*)base + field->at, &items, sizeof items );
    memcpy( (char*)base + ( field->list_count > 0 ? field->list_count : field->at + sizeof items ), &count,
            sizeof count );
    const text_node* item = is_one ? node : text_first( node );
    for ( int i = 0; i < count; ++i, item = item->next )
    {
        const size_t outside = is_one ? r->path_length : scene_enter_index( r, i );
        WISP_TRY( list->each ? scene_read_field( r, item, list->each, items + (size_t)i * list->size )
                             : list->read( r, item, i, items ) );
        scene_leave( r, outside );
    }
    WISP_TRY( list->is_named ? scene_register( r, list->named, items, list->size, count ) : WISP_OK );
    return list->finish ? list->finish( r, node, base ) : WISP_OK;
}

// Read one value as its field describes.
static wisp_status scene_read_field( scene_reader* r, const text_node* node, const scene_field* field, void* base )
{
    void* out = (char*)base + field->at;
    wisp_status status = WISP_OK;
    bool is_off = false;
    text_node whole = *node;
    const char* word;
    switch ( field->type )
    {
        case SCENE_NUMBER:
            return field->map != 0 && node->kind == TEXT_MAP ? scene_read_map( r, node, field, base )
                                                             : scene_read_number( r, node, field, out );
        case SCENE_NUMBERS:
            return read_numbers( r, node, field, base );
        case SCENE_WHOLE:
            return scene_read_whole( r, node, field, out );
        case SCENE_SEED:
            return scene_read_seed( r, node, out );
        case SCENE_SWITCH:
            return scene_read_switch( r, node, out );
        case SCENE_CHOICE:
        case SCENE_EITHER:
            return read_choice( r, node, field, out );
        case SCENE_VECTOR:
            return scene_read_vector( r, node, field, out );
        case SCENE_TEXT:
            return scene_read_text( r, node, out );
        case SCENE_USUAL:
        case SCENE_BLOCK:
            word = field->type == SCENE_USUAL && node->plain ? text_value( node ) : "";
            is_off = strcmp( word, "false" ) == 0;
            whole.kind = strcmp( word, "true" ) == 0 ? TEXT_MAP : node->kind; // as {}
            status = is_off ? WISP_OK : scene_read_block( r, &whole, field->block, base );
            if ( field->at )
            {
                *(bool*)out = status == WISP_OK && is_off == false;
            }
            return status;
        case SCENE_WORDS:
            return read_words( r, node, field, base );
        case SCENE_ENTRIES:
            return read_entries( r, node, field, base );
        case SCENE_MEMBER:
        case SCENE_CUSTOM:
            break;
    }
    return field->read( r, node, out );
}

// ---- fields of definitions ----

static scene_type type_of( const scene_field* field, const wisp_field* f )
{
    static const scene_type TYPES[] = {
        [WISP_FIELD_NUMBER] = SCENE_NUMBER, [WISP_FIELD_WHOLE] = SCENE_WHOLE, [WISP_FIELD_CHOICE] = SCENE_CHOICE,
        [WISP_FIELD_SWITCH] = SCENE_SWITCH, [WISP_FIELD_SEED] = SCENE_SEED,   [WISP_FIELD_VECTOR] = SCENE_VECTOR,
        [WISP_FIELD_POINT] = SCENE_VECTOR
    };
    WISP_ASSERT( f->type < WISP_COUNT( TYPES ) );
    return field->list_count != 0                                   ? SCENE_NUMBERS
           : f->type == WISP_FIELD_SWITCH && field->choices != NULL ? SCENE_EITHER
                                                                    : TYPES[f->type];
}

scene_field scene_field_at( const scene_block* block, int i )
{
    scene_field field = block->fields[i];
    if ( field.type != SCENE_MEMBER )
    {
        field.at += block->of == NULL ? block->at : 0;
        return field;
    }
    const char* member = field.member != NULL ? field.member : field.key;
    const wisp_field* f = block->of->rows;
    while ( strcmp( f->name, member ) != 0 )
    {
        ++f;
        WISP_ASSERT( f < block->of->rows + block->of->count );
    }
    field.type = type_of( &field, f );
    field.at = block->at + f->offset;
    field.unit = field.unit != NULL ? field.unit : f->unit;
    if ( field.range.lower == 0.0 && field.range.upper == 0.0 )
    {
        // coordinates of a vector whose length is bounded: less than the bound over the square root of three
        const bool is_vector = f->type == WISP_FIELD_VECTOR;
        field.range =
            ( scene_range ){ is_vector ? -0.5 * f->upper : f->lower, is_vector ? 0.5 * f->upper : f->upper };
    }
    return field;
}

// ---- mappings ----

static int find_field( const scene_block* block, const char* key )
{
    for ( int i = 0; i < block->field_count; ++i )
    {
        if ( strcmp( block->fields[i].key, key ) == 0 )
        {
            return i;
        }
    }
    return -1;
}

enum
{
    LISTED_KEYS = 12, // of a block with more, the nearest few
    NEAR_KEYS = 4,
};

static void list_keys( const char* const* keys, int count, char* list, size_t size )
{
    size_t used = 0;
    for ( int i = 0; i < count; ++i )
    {
        const int n = snprintf( list + used, size - used, "%s%s", i ? ", " : "", keys[i] );
        used += (size_t)n < size - used ? (size_t)n : size - used - 1;
    }
}

// The path of a block for `wisp info --keys`: without the numbers of entries.
static void path_of_keys( const char* path, char* out, size_t size )
{
    size_t used = 0;
    bool inside = false;
    for ( const char* c = path; *c != '\0' && used + 1 < size; ++c )
    {
        inside = inside || *c == '[';
        if ( !inside )
        {
            out[used++] = *c;
        }
        inside = inside && *c != ']';
    }
    out[used] = '\0';
}

static wisp_status refuse_unknown( const scene_reader* r, const text_node* node, const scene_block* block )
{
    const char* key = node->key;
    const int count = block->field_count;
    const char *known[SCENE_MAX_FIELDS], *nearest[NEAR_KEYS];
    char list[400] = "", path[200] = "";
    for ( int i = 0; i < count; ++i )
    {
        known[i] = block->fields[i].key;
    }
    const char* use = scene_find_removed( r->path, key, false );
    const char* near = use ? NULL : nearest_word( key, known, count );
    const int near_count = count > LISTED_KEYS ? nearest_words( key, known, count, nearest, NEAR_KEYS ) : 0;
    char message[720];
    list_keys( count > LISTED_KEYS ? nearest : known, count > LISTED_KEYS ? near_count : count, list, sizeof list );
    path_of_keys( r->path, path, sizeof path );
    if ( use )
    {
        snprintf( message, sizeof message, "'%s' is gone; %s", key, use );
    }
    else if ( near )
    {
        snprintf( message, sizeof message, "unknown key '%s', did you mean '%s'?", scene_shorten( key ).text, near );
    }
    else if ( count > LISTED_KEYS )
    {
        snprintf( message, sizeof message, "unknown key '%s'; %s%s%swisp info --keys%s%s lists all %d",
                  scene_shorten( key ).text, near_count > 0 ? "the nearest are " : "", list,
                  near_count > 0 ? "; " : "", path[0] != '\0' ? " " : "", path, count );
    }
    else
    {
        snprintf( message, sizeof message, "unknown key '%s', expected one of %s", scene_shorten( key ).text, list );
    }
    return scene_refuse( r->source, node->key_line, node->key_column, r->path, "%s", message );
}

// Which child is which field. Unknown keys stop at the first, so the number of comparisons is bounded by the table.
static wisp_status find_fields( scene_reader* r, const text_node* node, const scene_block* block,
                                const text_node* found[SCENE_MAX_FIELDS] )
{
    WISP_ASSERT( block->field_count <= SCENE_MAX_FIELDS );
    for ( const text_node* child = text_first( node ); child; child = child->next )
    {
        int i = find_field( block, child->key );
        if ( i < 0 )
        {
            return refuse_unknown( r, child, block );
        }
        if ( found[i] )
        {
            return scene_refuse( r->source, child->key_line, child->key_column, r->path,
                                 "key '%s' is written twice, first in line %d", block->fields[i].key,
                                 found[i]->key_line );
        }
        found[i] = child;
    }
    return WISP_OK;
}

wisp_status scene_read_block( scene_reader* r, const text_node* node, const scene_block* block, void* base )
{
    if ( node->kind != TEXT_MAP )
    {
        return scene_refuse_kind( r, node, "a mapping ({} takes the defaults)" );
    }
    const text_node* found[SCENE_MAX_FIELDS] = { NULL };
    WISP_TRY( find_fields( r, node, block, found ) );
    for ( int i = 0; i < block->field_count; ++i )
    {
        const scene_field field = scene_field_at( block, i );
        if ( !found[i] && field.required )
        {
            return scene_refuse_node( r, node, "key '%s' is missing", field.key );
        }
        if ( found[i] )
        {
            size_t outside = scene_enter_key( r, field.key );
            WISP_TRY( scene_read_field( r, found[i], &field, base ) );
            if ( field.given )
            {
                *( (bool*)base + field.given ) = true;
            }
            scene_leave( r, outside );
        }
        WISP_TRY( field.bind ? field.bind( r, node ) : WISP_OK );
    }
    return WISP_OK;
}

// ---- rules over several keys ----

wisp_status scene_refuse_cases( scene_reader* r, const text_node* node, const scene_case* cases, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( cases[i].is_wrong )
        {
            const text_node* key = cases[i].path ? text_find_path( node, cases[i].path ) : NULL;
            return scene_refuse_node( r, key ? key : node, "%s", cases[i].message );
        }
    }
    return WISP_OK;
}

wisp_status scene_refuse_keys( scene_reader* r, const text_node* node, const char* const* paths, int count,
                               const char* why )
{
    for ( int i = 0; i < count; ++i )
    {
        const text_node* key = text_find_path( node, paths[i] );
        if ( key )
        {
            return scene_refuse_node( r, key, "'%s' %s", key->key, why );
        }
    }
    return WISP_OK;
}

wisp_status scene_expect_one( scene_reader* r, const text_node* node, const char* a, bool has_a, const char* b,
                              bool has_b )
{
    return has_a != has_b ? WISP_OK
                          : scene_refuse_node( r, node, "got %s '%s' %s '%s', expected one of them",
                                               has_a ? "both" : "neither", a, has_a ? "and" : "nor", b );
}

// ---- keys ----

// Room for one field with all of its choices.
#define FIELD_SIZE 4096

/// A block of the reference. A block whose keys depend on its shape has one table for each shape.
typedef struct section
{
    const char* path; // empty: the scene itself
    const char* help;
    const scene_block* blocks; // [count]
    int count;
    const void* bases; // [count] structs with defaults, `stride` bytes apart
    size_t stride;
} section;

/// Text of limited length.
typedef struct writer
{
    char* text;
    size_t size, used;
} writer;

__attribute__( ( format( printf, 2, 3 ) ) ) static void add( writer* w, const char* format, ... )
{
    va_list arguments;
    va_start( arguments, format );
    int n = vsnprintf( w->text + w->used, w->size - w->used, format, arguments );
    va_end( arguments );
    WISP_ASSERT( n >= 0 && (size_t)n < w->size - w->used );
    w->used += (size_t)n;
}

// ---- values ----

// Append the shortest digits that read back as the same number, with exponents such as e6 and e-6.
static void add_number( writer* w, double value, bool is_float )
{
    char digits[40];
    if ( value == floor( value ) && fabs( value ) < 1e5 )
    {
        add( w, "%.0f", value );
        return;
    }
    for ( int precision = 1; precision <= 17; ++precision )
    {
        snprintf( digits, sizeof digits, "%.*g", precision, value );
        if ( is_float ? strtof( digits, NULL ) == (float)value : strtod( digits, NULL ) == value )
        {
            break;
        }
    }
    char* exponent = strchr( digits, 'e' );
    if ( exponent )
    {
        const long power = strtol( exponent + 1, NULL, 10 );
        snprintf( exponent, sizeof digits - (size_t)( exponent - digits ), "e%ld", power );
    }
    add( w, "%s", digits );
}

static const char* name_of_type( const scene_field* field )
{
    switch ( field->type )
    {
        case SCENE_NUMBER:
            return field->map != 0 ? "number or [map](#maps)" : "number";
        case SCENE_NUMBERS:
            return "number, or list of numbers, one per strand";
        case SCENE_WHOLE:
        case SCENE_SEED:
            return "whole number";
        case SCENE_SWITCH:
            return "true or false";
        case SCENE_CHOICE:
        case SCENE_EITHER:
            return "choice";
        case SCENE_VECTOR:
            return "[x, y, z]";
        case SCENE_TEXT:
            return "text";
        case SCENE_BLOCK:
            return "block";
        case SCENE_USUAL:
            return "block, true or false";
        case SCENE_WORDS:
            return "list of words";
        case SCENE_MEMBER:
        case SCENE_ENTRIES:
        case SCENE_CUSTOM:
            break;
    }
    return field->form;
}

static void add_range( writer* w, const scene_field* field )
{
    if ( field->type == SCENE_SEED )
    {
        add( w, ", 0 .. 18446744073709551615" );
    }
    const bool is_vector = field->type == SCENE_VECTOR;
    if ( is_vector || field->type == SCENE_NUMBER || field->type == SCENE_NUMBERS || field->type == SCENE_WHOLE )
    {
        add( w, ", " );
        add_number( w, field->range.lower, false );
        add( w, " .. " );
        add_number( w, field->range.upper, false );
        add( w, "%s", is_vector ? " each" : "" );
    }
}

static void add_choice( writer* w, const scene_field* field, const void* at )
{
    int choice = 0;
    if ( field->type == SCENE_EITHER )
    {
        choice = *(const bool*)at;
    }
    else
    {
        memcpy( &choice, at, sizeof choice );
    }
    add( w, "`%s`", field->choices[choice].word );
}

static void add_value( writer* w, const scene_field* field, const void* base )
{
    const void* at = (const char*)base + field->at;
    const wisp_vec3* v = at;
    switch ( field->type )
    {
        case SCENE_NUMBER:
        case SCENE_NUMBERS:
            add_number( w, (double)*(const float*)at, true );
            break;
        case SCENE_WHOLE:
            add( w, "%d", *(const int*)at );
            break;
        case SCENE_SEED:
            add( w, "%llu", (unsigned long long)*(const uint64_t*)at );
            break;
        case SCENE_SWITCH:
            add( w, "`%s`", *(const bool*)at ? "true" : "false" );
            break;
        case SCENE_CHOICE:
        case SCENE_EITHER:
            add_choice( w, field, at );
            break;
        case SCENE_VECTOR:
            add( w, "[" );
            add_number( w, (double)v->x, true );
            add( w, ", " );
            add_number( w, (double)v->y, true );
            add( w, ", " );
            add_number( w, (double)v->z, true );
            add( w, "]" );
            break;
        case SCENE_MEMBER:
        case SCENE_TEXT:
        case SCENE_BLOCK:
        case SCENE_USUAL:
        case SCENE_WORDS:
        case SCENE_ENTRIES:
        case SCENE_CUSTOM:
            WISP_ASSERT( false );
    }
}

// ---- fields ----

// Everything about a field that follows its key.
static void describe( writer* w, const scene_field* field, const void* base )
{
    WISP_ASSERT( field->help && name_of_type( field ) );
    add( w, " (%s%s%s", name_of_type( field ), field->unit ? ", " : "", field->unit ? field->unit : "" );
    add_range( w, field );
    if ( field->required )
    {
        add( w, ", required" );
    }
    else if ( field->initial )
    {
        add( w, ", default %s", field->initial );
    }
    else if ( field->type != SCENE_BLOCK && field->type != SCENE_CUSTOM )
    {
        add( w, ", default " );
        add_value( w, field, base );
    }
    add( w, "): %s\n", field->help );
    for ( const scene_choice* choice = field->choices; choice && choice->word; ++choice )
    {
        add( w, "  - `%s`: %s\n", choice->word, choice->help );
    }
}

// @return false if the shape has no such key
static bool describe_in( const section* s, int shape, const char* key, char text[FIELD_SIZE] )
{
    const int i = find_field( &s->blocks[shape], key );
    if ( i >= 0 )
    {
        writer w = { text, FIELD_SIZE, 0 };
        const scene_field field = scene_field_at( &s->blocks[shape], i );
        describe( &w, &field, (const char*)s->bases + (size_t)shape * s->stride );
    }
    return i >= 0;
}

// Shapes whose key has the same text share a line, written at the first of them.
static void write_field( FILE* out, const section* s, int shape, const char* key )
{
    char text[FIELD_SIZE], other[FIELD_SIZE], shapes[400] = "";
    writer w = { shapes, sizeof shapes, 0 };
    int count = 0;
    describe_in( s, shape, key, text );
    for ( int i = 0; i < s->count; ++i )
    {
        const bool is_same = describe_in( s, i, key, other ) && strcmp( text, other ) == 0;
        if ( is_same && i < shape )
        {
            return;
        }
        if ( is_same )
        {
            const int word = find_field( &s->blocks[i], "shape" );
            const scene_choice* words = word >= 0 ? s->blocks[i].fields[word].choices : NULL;
            add( &w, "%s`%s`", count > 0 ? ", " : " of ", words ? words[i].word : "" );
            ++count;
        }
    }
    fprintf( out, "- `%s`%s%s", key, count < s->count ? shapes : "", text );
}

// ---- sections ----

static bool matches( const char* path, const char* block )
{
    char plain[120];
    size_t length = 0;
    for ( const char* c = path; *c && length < sizeof plain - 1; ++c )
    {
        if ( *c != '[' && *c != ']' )
        {
            plain[length++] = *c;
        }
    }
    plain[length] = 0;
    const size_t size = block ? strlen( block ) : 0;
    if ( !block )
    {
        return true;
    }
    for ( const char* at = plain; at; at = strchr( at, '.' ) ? strchr( at, '.' ) + 1 : NULL )
    {
        if ( strncmp( at, block, size ) == 0 && ( at[size] == 0 || at[size] == '.' ) )
        {
            return true;
        }
    }
    return false;
}

static int write_section( FILE* out, const section* s, const char* only )
{
    int count = 0;
    if ( matches( s->path[0] ? s->path : "scene", only ) )
    {
        const char* quote = s->path[0] ? "`" : "";
        fprintf( out, "### %s%s%s\n\n%s\n\n", quote, s->path[0] ? s->path : "The scene", quote, s->help );
        for ( int shape = 0; shape < s->count; ++shape )
        {
            for ( int i = 0; i < s->blocks[shape].field_count; ++i )
            {
                write_field( out, s, shape, s->blocks[shape].fields[i].key );
            }
        }
        fputc( '\n', out );
        count = 1;
    }
    for ( int i = 0; s->count == 1 && i < s->blocks->field_count; ++i )
    {
        const scene_field* field = &s->blocks->fields[i];
        if ( field->block )
        {
            char path[120];
            snprintf( path, sizeof path, "%s%s%s", s->path, s->path[0] ? "." : "", field->key );
            const section inner = { path, field->help, field->block, 1, s->bases, 0 };
            count += write_section( out, &inner, only );
        }
    }
    return count;
}

int wisp_scene_write_keys( FILE* out, const char* only )
{
    const wisp_scene scene = scene_defaults();
    const wisp_scene_strands strands = scene_default_strands( scene.gravity );
    const wisp_scene_surface surface = scene_default_surface( scene.gravity );
    const wisp_groom_generator groom = wisp_default_groom_generator( WISP_GROOM_STRAIGHT, 3 );
    const wisp_scene_hair_event command = { 0 };
    const scene_event event = { 0 };
    const wisp_scene_output output = { 0 };
    const wisp_scene_pose pose = { 0 };
    const wisp_scene_box box = { 0 };
    const wisp_scene_pins pins = scene_default_pins();
    const wisp_scene_clip clip = scene_default_clip();
    const wisp_scene_collider collider = scene_default_collider();
    const wisp_scene_seam seam = scene_default_seam();
    wisp_mesh_generator meshes[WISP_MESH_SHAPE_COUNT];
    for ( int i = 0; i < WISP_MESH_SHAPE_COUNT; ++i )
    {
        meshes[i] = wisp_default_mesh_generator( (wisp_mesh_shape)i );
    }
    const section sections[] = {
        { "", "Keys of the file itself.", &SCENE_BLOCK_OF_ALL, 1, &scene, 0 },
        { "contact", "How contact between all participants is found.", &SCENE_WORLD_CONTACT_BLOCK, 1, &scene, 0 },
        { "strands[]", "Strands come from exactly one of `file`, `generate`, `scatter` and `curves`.",
          &SCENE_STRANDS_BLOCK, 1, &strands, 0 },
        { "strands[].generate", "Generated strands. Defaults are those of straight strands in three dimensions.",
          &SCENE_GENERATE_BLOCK, 1, &groom, 0 },
        { "surfaces[]",
          "A surface comes from exactly one of `file`, `generate` and `instance_of`. Without `cloth`, `balloon` and "
          "`implicit` its vertices move independently.",
          &SCENE_SURFACE_BLOCK, 1, &surface, 0 },
        { "surfaces[].generate", "A generated mesh, also of a collider.", SCENE_MESH_BLOCKS, WISP_MESH_SHAPE_COUNT,
          meshes, sizeof meshes[0] },
        { "surfaces[].animation.clips[]", "A clip, played from a time on.", &SCENE_CLIP_BLOCK, 1, &clip, 0 },
        { "surfaces[].pin_box", "A box along the axes.", &SCENE_BOX_BLOCK, 1, &box, 0 },
        { "surfaces[].pin_groups[]",
          "Pins that move together. No vertex is in two groups, or in one and among the surface's own pins.",
          &SCENE_PIN_GROUP_BLOCK, 1, &pins, 0 },
        { "surfaces[].pin_keyframes[]", "A pose of the pins, relative to where they started.", &SCENE_PIN_POSE_BLOCK,
          1, &pose, 0 },
        { "colliders[]", "A collider pushes surfaces and strands and is not pushed.", SCENE_COLLIDER_BLOCKS,
          WISP_COLLIDER_COUNT, &collider, 0 },
        { "colliders[].keyframes[]", "A pose of a collider or of a head.", &SCENE_POSITION_BLOCK, 1, &pose, 0 },
        { "seams[]", "A seam joins pairs of vertices of two surfaces, or of one.", &SCENE_SEAM_BLOCK, 1, &seam, 0 },
        { "rotation", "A rotation: `{axis: [x, y, z], degrees: 90}` or `{degrees: [x, y, z]}`.",
          &SCENE_ROTATION_BLOCK, 1, &pose, 0 },
        { "hair_events[]", "Strands have at most one entry before each step.", &SCENE_COMMAND_BLOCK, 1, &command, 0 },
        { "events[]", "A surface, or strands, have at most one entry before each step.", &SCENE_EVENT_BLOCK, 1,
          &event, 0 },
        { "output[]", "A file to write after the last step; no two are alike.", &SCENE_OUTPUT_BLOCK, 1, &output, 0 },
    };
    int count = 0;
    for ( int i = 0; i < WISP_COUNT( sections ); ++i )
    {
        count += write_section( out, &sections[i], only );
    }
    return count;
}
