// A scene at another size, and elsewhere. Both go by the tables of the reader: a key's unit says how it scales.
#include "torture_twins.h"
#include "torture_keys.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// ---- size ----

// The power of a length in each unit, with masses and times as they are.
static int length_power( const char* unit, const char* key )
{
    static const struct
    {
        const char* unit;
        int power;
    } powers[] = {
        { "m", 1 },       { "m/s", 1 },   { "m/s^2", 1 },   { "m^2", 2 },   { "m^3/s", 3 },
        { "kg/m^2", -2 }, { "kg/m", -1 }, { "kg/m^3", -3 }, { "Pa", -1 },   { "N m", 2 },
        { "N m^2", 3 },   { "m/N", 0 },   { "N/m", 0 },     { "N s/m", 0 }, { "N", 1 },
    };
    // R T / M is the square of a speed, and the gas constant is fixed.
    if ( strcmp( key, "temperature" ) == 0 )
    {
        return 2;
    }
    for ( int i = 0; unit && i < WISP_COUNT( powers ); ++i )
    {
        if ( strcmp( powers[i].unit, unit ) == 0 )
        {
            return powers[i].power;
        }
    }
    return 0;
}

// A number that leaves the range of its key stays at its end: lists of places have no range.
static void multiply( text_node* node, double factor, scene_range range )
{
    double value;
    if ( text_is_number( node, &value ) )
    {
        const bool has_range = range.upper > range.lower;
        value *= factor;
        text_set_number( node, has_range ? fmin( fmax( value, range.lower ), range.upper ) : value );
    }
    for ( int i = 0; i < node->count; ++i )
    {
        multiply( node->children[i], factor, range );
    }
}

// What a key has where it is not written, as a node; null where that is found from other keys, or nothing at any
// size.
static text_node* default_of( const scene_field* field, const void* base )
{
    const void* at = (const char*)base + field->at;
    if ( field->initial != NULL || ( field->type != SCENE_NUMBER && field->type != SCENE_VECTOR ) )
    {
        return NULL;
    }
    const wisp_vec3* v = at;
    const bool is_zero =
        field->type == SCENE_NUMBER ? *(const float*)at == 0.0f : v->x == 0.0f && v->y == 0.0f && v->z == 0.0f;
    if ( is_zero )
    {
        return NULL;
    }
    if ( field->type == SCENE_NUMBER )
    {
        return text_scalar( "%.9g", (double)*(const float*)at );
    }
    text_node* list = text_list();
    text_add( list, text_scalar( "%.9g", (double)v->x ) );
    text_add( list, text_scalar( "%.9g", (double)v->y ) );
    text_add( list, text_scalar( "%.9g", (double)v->z ) );
    return list;
}

// Keys whose values are places in a list that no table describes.
static bool is_list_of_places( const char* key )
{
    return strcmp( key, "pin_nearest" ) == 0;
}

// How a scene gets another size: everything whose unit holds a length, or lengths, areas and flows alone.
typedef struct resizing
{
    double factor;
    bool only_lengths;
} resizing;

static int power_of( const resizing* r, const scene_field* field )
{
    const int power = is_list_of_places( field->key ) ? 1 : length_power( field->unit, field->key );
    const char* unit = field->unit ? field->unit : "";
    const bool is_geometry = is_list_of_places( field->key ) || strcmp( unit, "m" ) == 0 ||
                             strcmp( unit, "m^2" ) == 0 || strcmp( unit, "m^3/s" ) == 0;
    return r->only_lengths && !is_geometry ? 0 : power;
}

static void scale_block( text_node* map, torture_block block, const resizing* r );

static void scale_value( text_node* value, torture_block block, const scene_field* field, const resizing* r )
{
    const int power = power_of( r, field );
    if ( power != 0 )
    {
        multiply( value, pow( r->factor, power ), field->range );
        return;
    }
    for ( int i = -1; i < value->count; ++i )
    {
        text_node* inner = i < 0 ? value : value->children[i];
        const torture_block below = inner->kind == TEXT_MAP ? torture_block_below( block, field->key, inner )
                                                            : ( torture_block ){ NULL, NULL };
        if ( below.table != NULL )
        {
            scale_block( inner, below, r );
        }
        if ( value->kind != TEXT_LIST )
        {
            break;
        }
    }
}

// A mesh from a file has its scale, which has no unit.
static void scale_file( text_node* map, double factor )
{
    if ( text_find( map, "file" ) == NULL )
    {
        return;
    }
    text_node* owner = text_find( map, "shape" ) ? map : text_find( map, "transform" );
    owner = owner ? owner : text_put( map, "transform", text_map() );
    double scale = 1.0;
    text_is_number( text_find( owner, "scale" ), &scale );
    text_put( owner, "scale", text_scalar( "%.9g", scale * factor ) );
}

static void scale_block( text_node* map, torture_block block, const resizing* r )
{
    const bool is_event = block.table == &SCENE_EVENT_BLOCK;
    for ( int i = 0; i < block.table->field_count; ++i )
    {
        const scene_field* field = &block.table->fields[i];
        text_node* value = text_find( map, field->key );
        // Gravity of a body is that of the scene unless it is written, and an event changes only what is written.
        const bool has_default = !is_event && power_of( r, field ) != 0;
        if ( value == NULL && has_default )
        {
            value = default_of( field, block.base );
            value = value ? text_put( map, field->key, value ) : NULL;
        }
        if ( value != NULL )
        {
            scale_value( value, block, field, r );
        }
    }
    scale_file( map, r->factor );
}

void torture_scale( text_node* scene, double factor )
{
    scale_block( scene, torture_block_of_scene(), &( resizing ){ factor, false } );
}

void torture_resize( text_node* scene, double factor )
{
    scale_block( scene, torture_block_of_scene(), &( resizing ){ factor, true } );
}

// ---- place ----

static void add_offset( text_node* vector, const double offset[3] )
{
    for ( int i = 0; i < 3 && i < vector->count; ++i )
    {
        double value = 0.0;
        text_is_number( vector->children[i], &value );
        text_set_number( vector->children[i], value + offset[i] );
    }
}

static text_node* vector_of( text_node* map, const char* key )
{
    text_node* vector = text_find( map, key );
    if ( vector == NULL )
    {
        vector = text_put( map, key, text_list() );
        for ( int i = 0; i < 3; ++i )
        {
            text_add( vector, text_scalar( "0" ) );
        }
    }
    return vector;
}

// Keys that are a place of the world wherever they stand; displacements such as those of pins are none.
static void shift_below( text_node* node, const double offset[3] )
{
    static const char* const places[] = { "position", "cursor",         "pivot", "pin_pivot",
                                          "eye",      "outlet_nearest", "min",   "max" };
    for ( int i = 0; i < node->count; ++i )
    {
        text_node* child = node->children[i];
        bool is_place = false;
        for ( int k = 0; child->key && k < WISP_COUNT( places ); ++k )
        {
            is_place |= strcmp( child->key, places[k] ) == 0;
        }
        if ( is_place && child->kind == TEXT_LIST )
        {
            add_offset( child, offset );
        }
        for ( int k = 0; child->key && is_list_of_places( child->key ) && k < child->count; ++k )
        {
            add_offset( child->children[k], offset );
        }
        shift_below( child, offset );
    }
}

void torture_shift( text_node* scene, const double offset[3] )
{
    static const char* const lists[] = { "surfaces", "strands", "colliders" };
    for ( int k = 0; k < WISP_COUNT( lists ); ++k )
    {
        text_node* list = text_find( scene, lists[k] );
        for ( int i = 0; list && i < list->count; ++i )
        {
            text_node* entry = list->children[i];
            const bool follows = text_find( entry, "scatter" ) || text_find( entry, "curves" );
            if ( k < 2 && !follows )
            {
                text_node* transform = text_find( entry, "transform" );
                transform = transform ? transform : text_put( entry, "transform", text_map() );
                add_offset( vector_of( transform, "translate" ), offset );
            }
            else if ( k == 2 )
            {
                (void)vector_of( entry, "position" );
            }
        }
    }
    shift_below( scene, offset );
}
