// Writes the reference of all keys from the tables of the reader. Defaults are read from the structs that the reader
// starts from, so nothing is written twice.
#include "scene_keys.h"
#include "scene_parts.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

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
            return "block or false";
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
        case SCENE_TEXT:
        case SCENE_BLOCK:
        case SCENE_USUAL:
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

static const scene_field* find_key( const scene_block* block, const char* key )
{
    for ( int i = 0; i < block->field_count; ++i )
    {
        if ( strcmp( block->fields[i].key, key ) == 0 )
        {
            return &block->fields[i];
        }
    }
    return NULL;
}

// @return false if the shape has no such key
static bool describe_in( const section* s, int shape, const char* key, char text[FIELD_SIZE] )
{
    const scene_field* field = find_key( &s->blocks[shape], key );
    if ( field )
    {
        writer w = { text, FIELD_SIZE, 0 };
        describe( &w, field, (const char*)s->bases + (size_t)shape * s->stride );
    }
    return field != NULL;
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
            const scene_choice* words =
                find_key( &s->blocks[i], "shape" ) ? find_key( &s->blocks[i], "shape" )->choices : NULL;
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
