#include "scene_schema.h"
#include "nearest.h"
#include "scene_parts.h"
#include "scene_removed.h"

#include <stdio.h>
#include <string.h>

// ---- values of more than one scalar ----

wisp_status scene_expect_list( scene_reader* r, const scene_node* node, const char* what )
{
    return node->kind == SCENE_LIST ? WISP_OK : scene_refuse_kind( r, node, what );
}

wisp_status scene_read_vector( scene_reader* r, const scene_node* node, const scene_field* field, wisp_vec3* out )
{
    if ( node->kind != SCENE_LIST )
    {
        return scene_refuse_kind( r, node, "a list of three numbers" );
    }
    if ( node->count != 3 )
    {
        return scene_refuse_node( r, node, "got a list of %d, expected a list of three numbers", node->count );
    }
    float parts[3];
    const scene_node* part = scene_first( r->tree, node );
    for ( int i = 0; i < 3; ++i, part = scene_next( r->tree, part ) )
    {
        size_t outside = scene_enter_index( r, i );
        wisp_status status = scene_read_number( r, part, field, &parts[i] );
        if ( status )
        {
            return status;
        }
        scene_leave( r, outside );
    }
    *out = ( wisp_vec3 ){ parts[0], parts[1], parts[2] };
    return WISP_OK;
}

// One number for all strands, or a list with one a strand. How many strands there are is known if they are made.
static wisp_status read_numbers( scene_reader* r, const scene_node* node, const scene_field* field,
                                 wisp_scene_strands* strands )
{
    char* base = (char*)strands;
    if ( node->kind != SCENE_LIST )
    {
        return node->kind == SCENE_MAP ? scene_refuse_kind( r, node, "a number, or a list with one per strand" )
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

static wisp_status read_choice( scene_reader* r, const scene_node* node, const scene_field* field, void* out )
{
    int choice = 0;
    wisp_status status = scene_read_choice( r, node, field->choices, &choice );
    if ( status )
    {
        return status;
    }
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

wisp_status scene_read_field( scene_reader* r, const scene_node* node, const scene_field* field, void* base )
{
    void* out = (char*)base + field->at;
    wisp_status status = WISP_OK;
    bool is_off = false;
    switch ( field->type )
    {
        case SCENE_NUMBER:
            return field->map != 0 && node->kind == SCENE_MAP ? scene_read_map( r, node, field, base )
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
            is_off = field->type == SCENE_USUAL && node->kind == SCENE_SCALAR && node->plain &&
                     strcmp( scene_text_of( r->tree, node ), "false" ) == 0;
            status = is_off ? WISP_OK : scene_read_block( r, node, field->block, base );
            if ( field->at )
            {
                *(bool*)out = status == WISP_OK && is_off == false;
            }
            return status;
        case SCENE_CUSTOM:
            break;
    }
    return field->read( r, node, out );
}

// ---- mappings ----

const scene_node* scene_child( const scene_reader* r, const scene_node* node, const char* key )
{
    const scene_node* child = node->kind == SCENE_MAP ? scene_first( r->tree, node ) : NULL;
    while ( child && strcmp( scene_key_of( r->tree, child ), key ) != 0 )
    {
        child = scene_next( r->tree, child );
    }
    return child;
}

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

static wisp_status refuse_unknown( const scene_reader* r, const scene_node* node, const scene_block* block )
{
    const char* key = scene_key_of( r->tree, node );
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
static wisp_status find_fields( scene_reader* r, const scene_node* node, const scene_block* block,
                                const scene_node* found[SCENE_MAX_FIELDS] )
{
    WISP_ASSERT( block->field_count <= SCENE_MAX_FIELDS );
    for ( const scene_node* child = scene_first( r->tree, node ); child; child = scene_next( r->tree, child ) )
    {
        int i = find_field( block, scene_key_of( r->tree, child ) );
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

wisp_status scene_read_block( scene_reader* r, const scene_node* node, const scene_block* block, void* base )
{
    if ( node->kind != SCENE_MAP )
    {
        return scene_refuse_kind( r, node, "a mapping ({} takes the defaults)" );
    }
    const scene_node* found[SCENE_MAX_FIELDS] = { NULL };
    wisp_status status = find_fields( r, node, block, found );
    if ( status )
    {
        return status;
    }
    for ( int i = 0; i < block->field_count; ++i )
    {
        const scene_field* field = &block->fields[i];
        if ( !found[i] && field->required )
        {
            return scene_refuse_node( r, node, "key '%s' is missing", field->key );
        }
        if ( found[i] )
        {
            size_t outside = scene_enter_key( r, field->key );
            status = scene_read_field( r, found[i], field, base );
            if ( status )
            {
                return status;
            }
            if ( field->given )
            {
                *( (bool*)base + field->given ) = true;
            }
            scene_leave( r, outside );
        }
        status = field->bind ? field->bind( r, node ) : WISP_OK;
        if ( status )
        {
            return status;
        }
    }
    return WISP_OK;
}
