// Every key of every table of the scene reader, by a walk over the tables: it sets its member and no other of its definition, each
// word is the enumerator of its name, and a value outside of its range is refused at its place. Without keys a definition has
// the defaults of its module.
#include "scene_fixture.h"

#include "scene_parts.h"

#include "wisp/module/definition.h"

#include <math.h>

enum
{
    TEXT_MAX = 1024,
};

// ---- blocks ----

// A block in a scene of one line.
typedef struct place
{
    char path[100], before[500], after[120]; // of messages; the text around its keys
    const scene_block* block;
    const void* ( *entry_of )( const wisp_scene* ); // the struct that the block fills; null: it is gone once the scene is read
} place;

static const void* scene_of( const wisp_scene* scene )
{
    return scene;
}

static const void* strands_of( const wisp_scene* scene )
{
    return &scene->strands[scene->strands_count - 1];
}

static const void* groom_of( const wisp_scene* scene )
{
    return &scene->strands->generator;
}

static const void* surface_of( const wisp_scene* scene )
{
    return scene->surfaces;
}

static const void* mesh_of( const wisp_scene* scene )
{
    return &scene->surfaces->mesh.generator;
}

static const void* clip_of( const wisp_scene* scene )
{
    return scene->surfaces->animation.clips;
}

static const void* group_of( const wisp_scene* scene )
{
    return scene->surfaces->pin_groups;
}

static const void* collider_of( const wisp_scene* scene )
{
    return scene->colliders;
}

static const void* seam_of( const wisp_scene* scene )
{
    return scene->seams;
}

static const void* hair_event_of( const wisp_scene* scene )
{
    return scene->commands;
}

#define STRANDS "strands: [ { name: a, generate: { strands: 3 }"
#define SURFACE "surfaces: [ { name: a, generate: { shape: plane, columns: 3, rows: 3 }"

// What a block of this name needs in its entry besides the entry's own keys; of strands also an entry before it.
static const struct
{
    const char *path, *before;
} NEEDS[] = {
    { "strands[0].ghosts", "strands: [ { name: b, generate: {}, dynamics: {} }, { name: a, scatter: { around: b, count: 2 }, " },
    { "strands[0].scatter", "strands: [ { name: b, generate: {} }, { name: a, " },
    { "strands[0].curves", "strands: [ { name: b, generate: {} }, { name: a, " },
    { "strands[0].head", STRANDS ", dynamics: {}, " },
    { "strands[0].tips", STRANDS ", dynamics: {}, " },
    { "strands[0].frame", STRANDS ", dynamics: {}, head: { keyframes: [ { time: 1 } ] }, " },
    { "strands[0].grid", STRANDS ", dynamics: {}, " },
    { "strands[0].collision", STRANDS ", dynamics: {}, " },
    { "strands[0].contact", STRANDS ", dynamics: {}, " },
    { "strands[0].sleep", STRANDS ", dynamics: {}, " },
    { "strands[0].detail", STRANDS ", dynamics: {}, " },
    { "surfaces[0].tearing", SURFACE ", cloth: {}, " },
    { "surfaces[0].membrane", SURFACE ", cloth: {}, " },
    { "surfaces[0].motion_constraints", SURFACE ", cloth: {}, " },
    { "surfaces[0].frame", SURFACE ", cloth: {}, pins: [0], pin_keyframes: [ { time: 1 } ], " },
    { "surfaces[0].animation", "surfaces: [ { name: a, file: m.glb, " },
};

// Keys that a key asks for.
static const struct
{
    const char *path, *with;
} WITH[] = {
    { "surfaces[0].boundary.eye", "eye_angle: 0.1" },
    { "surfaces[0].balloon.outlet_radius", "outlet_nearest: [0, 0, 0]" },
};

static const char* with_of( const char* path )
{
    for ( int i = 0; i < WISP_COUNT( WITH ); ++i )
    {
        if ( strcmp( WITH[i].path, path ) == 0 )
        {
            return WITH[i].with;
        }
    }
    return "";
}

// ---- one key ----

typedef struct attempt
{
    wisp_scene scene;
    wisp_error error;
    int column; // of the value
} attempt;

static void attempt_release( attempt* a )
{
    wisp_scene_release( &a->scene );
}

// Read the scene with a value for a key. @param key null: none
static attempt try_value( const place* p, const char* key, const char* value )
{
    char text[TEXT_MAX], path[160];
    attempt a = { .error = { .status = WISP_OK } };
    snprintf( path, sizeof path, "%s%s%s", p->path, p->path[0] ? "." : "", key ? key : "" );
    const char* with = with_of( path );
    const int before = snprintf( text, sizeof text, "{ wisp: 1, %s%s%s", p->before, key ? key : "", key ? ": " : "" );
    const int length = before + snprintf( text + before, sizeof text - (size_t)before, "%s%s%s%s }", value,
                                          with[0] ? ", " : "", with, p->after );
    assert_in_range( length, 1, TEXT_MAX - 1 );
    a.column = before + 1;
    wisp_scene_parse( text, strlen( text ), "test.yaml", &a.scene, &a.error );
    return a;
}

static void demand_range( const place* p, const char* key, const char* part, const scene_field* field, const char* value, int column )
{
    char expected[400];
    SCOPED( attempt_release ) attempt a = try_value( p, key, value );
    const char* number = value + column;
    const int digits = (int)strcspn( number, "," "]" );
    snprintf( expected, sizeof expected, "test.yaml:1:%d: %s%s%s%s: got %.*s, expected a value in [%.9g, %.9g]",
              a.column + column, p->path, p->path[0] ? "." : "", key, part, digits, number, field->range.lower,
              field->range.upper );
    assert_string_equal( a.error.message, expected );
}

// Numbers one step outside, of a float or of an int.
static void print_outside( const scene_field* field, bool above, char out[40] )
{
    const double end = above ? field->range.upper : field->range.lower;
    if ( field->type == SCENE_WHOLE )
    {
        snprintf( out, 40, "%.0f", end + ( above ? 1.0 : -1.0 ) );
        return;
    }
    snprintf( out, 40, "%.9g", (double)nextafterf( (float)end, above ? INFINITY : -INFINITY ) );
}

static void refuse_outside( const place* p, const scene_field* field )
{
    char number[40], value[100];
    for ( int above = 0; above < 2; ++above )
    {
        print_outside( field, above, number );
        const bool is_vector = field->type == SCENE_VECTOR;
        for ( int k = 0; k < ( is_vector ? 3 : 1 ); ++k )
        {
            char part[8] = "";
            snprintf( value, sizeof value, "%s", number );
            if ( is_vector )
            {
                snprintf( value, sizeof value, "[%s%s%s", k > 0 ? "0, " : "", k > 1 ? "0, " : "", number );
                snprintf( part, sizeof part, "[%d]", k );
                strcat( value, k < 1 ? ", 0, 0]" : k < 2 ? ", 0]" : "]" );
            }
            demand_range( p, field->key, part, field, value, is_vector ? 1 + 3 * k : 0 );
        }
    }
}

// The bytes of a value, behind each other.
static size_t print_value( const scene_field* field, double x, char* text, unsigned char bytes[12] )
{
    const float number = (float)x, vector[3] = { number, 2.0f * number, 3.0f * number };
    const int whole = (int)x;
    const bool on = x != 0.0;
    switch ( field->type )
    {
        case SCENE_VECTOR:
            snprintf( text, 100, "[%.9g, %.9g, %.9g]", (double)vector[0], (double)vector[1], (double)vector[2] );
            memcpy( bytes, vector, 12 );
            return 12;
        case SCENE_WHOLE:
            snprintf( text, 100, "%d", whole );
            memcpy( bytes, &whole, sizeof whole );
            return sizeof whole;
        case SCENE_CHOICE:
            snprintf( text, 100, "%s", field->choices[whole].word );
            memcpy( bytes, &whole, sizeof whole );
            return sizeof whole;
        case SCENE_SWITCH:
        case SCENE_EITHER:
            snprintf( text, 100, "%s", field->type == SCENE_EITHER ? field->choices[on].word : on ? "true" : "false" );
            memcpy( bytes, &on, sizeof on );
            return sizeof on;
        default:
            snprintf( text, 100, "%.9g", (double)number );
            memcpy( bytes, &number, sizeof number );
            return sizeof number;
    }
}

// The value is at its place, and no other number of the definition differs from what it is without the key.
static void check_struct( const place* p, const scene_field* field, const attempt* a, const unsigned char* bytes, size_t size )
{
    if ( p->entry_of == NULL )
    {
        return;
    }
    const unsigned char* entry = p->entry_of( &a->scene );
    if ( memcmp( entry + field->at, bytes, size ) != 0 )
    {
        fail_msg( "%s.%s is not at its place", p->path, field->key );
    }
    if ( field->given && !*( const bool* )( entry + field->given ) )
    {
        fail_msg( "%s.%s is not marked as given", p->path, field->key );
    }
    SCOPED( attempt_release ) attempt without = try_value( p, NULL, "" );
    const wisp_fields* of = p->block->of;
    if ( of == NULL || without.error.status != WISP_OK || with_of( "" )[0] )
    {
        return;
    }
    const unsigned char* plain = p->entry_of( &without.scene );
    for ( int i = 0; i < of->count; ++i )
    {
        const size_t at = p->block->at + of->rows[i].offset;
        const size_t next = i + 1 < of->count ? p->block->at + of->rows[i + 1].offset : p->block->at + of->size;
        const size_t width = next > at && next - at < 4 ? next - at : 1;
        if ( at != field->at && memcmp( entry + at, plain + at, width ) != 0 )
        {
            fail_msg( "%s.%s changes %s", p->path, field->key, of->rows[i].name );
        }
    }
}

// Set a value. @return whether the scene is read with it; a rule over several keys may refuse it
static bool set_value( const place* p, const scene_field* field, double x )
{
    char text[100];
    unsigned char bytes[12];
    const size_t size = print_value( field, x, text, bytes );
    SCOPED( attempt_release ) attempt a = try_value( p, field->key, text );
    if ( a.error.status == WISP_OK )
    {
        check_struct( p, field, &a, bytes, size );
    }
    else if ( strstr( a.error.message, "expected a value in" ) || strstr( a.error.message, "expected one of" ) )
    {
        fail_msg( "%s: %s", text, a.error.message );
    }
    else if ( getenv( "KEYS_SHOW" ) ) print_message( "%s.%s: %s: %s\n", p->path, field->key, text, a.error.message );
    return a.error.status == WISP_OK;
}

static int choice_count( const scene_field* field )
{
    int count = 0;
    while ( field->choices[count].word )
    {
        ++count;
    }
    return count;
}

static void check_key( const place* p, const scene_field* field, int* checked )
{
    int taken = 0;
    const double lower = field->range.lower, upper = field->range.upper;
    switch ( field->type )
    {
        case SCENE_NUMBER:
        case SCENE_NUMBERS:
        case SCENE_WHOLE:
            taken += set_value( p, field, lower ) + set_value( p, field, upper );
            taken += set_value( p, field, fmin( lower + 1.0, lower + 0.75 * ( upper - lower ) ) );
            refuse_outside( p, field );
            break;
        case SCENE_VECTOR:
            taken += set_value( p, field, upper / 4.0 < 3.0 ? upper / 4.0 : 3.0 );
            refuse_outside( p, field );
            break;
        case SCENE_CHOICE:
        case SCENE_EITHER:
            for ( int i = 0; i < choice_count( field ); ++i )
            {
                taken += set_value( p, field, i );
            }
            break;
        case SCENE_SWITCH:
            taken += set_value( p, field, 0.0 ) + set_value( p, field, 1.0 );
            break;
        default:
            return;
    }
    if ( taken == 0 )
    {
        if ( getenv( "KEYS_SHOW" ) ) { print_message( "NONE %s.%s\n", p->path, field->key ); return; }
        fail_msg( "no value of %s.%s is taken", p->path, field->key );
    }
    ++*checked;
}

// ---- all keys ----

static void check_block( const place* p, int* checked );

static void check_inner( const place* p, const scene_field* field, int* checked )
{
    place inner = *p;
    snprintf( inner.path, sizeof inner.path, "%s%s%s", p->path, p->path[0] ? "." : "", field->key );
    for ( int i = 0; i < WISP_COUNT( NEEDS ); ++i )
    {
        if ( strcmp( NEEDS[i].path, inner.path ) == 0 )
        {
            snprintf( inner.before, sizeof inner.before, "%s", NEEDS[i].before );
            char* index = strstr( inner.path, "[0]" );
            index[1] = strstr( inner.before, "name: b" ) ? '1' : '0';
        }
    }
    snprintf( inner.before + strlen( inner.before ), sizeof inner.before - strlen( inner.before ), "%s: { ", field->key );
    snprintf( inner.after, sizeof inner.after, " }%s", p->after );
    inner.block = field->block;
    check_block( &inner, checked );
}

static void check_block( const place* p, int* checked )
{
    for ( int i = 0; i < p->block->field_count; ++i )
    {
        const scene_field field = scene_field_at( p->block, i );
        if ( field.block )
        {
            check_inner( p, &field, checked );
        }
        else
        {
            check_key( p, &field, checked );
        }
    }
}

TEST( every_key_reaches_its_place_and_keeps_its_range )
{
    static const place places[] = {
        { "", "", "", &SCENE_BLOCK_OF_ALL, scene_of },
        { "contact", "contact: { ", " }", &SCENE_WORLD_CONTACT_BLOCK, scene_of },
        { "strands[0]", STRANDS ", ", " } ]", &SCENE_STRANDS_BLOCK, strands_of },
        { "strands[0].generate", "strands: [ { name: a, generate: { ", " } } ]", &SCENE_GENERATE_BLOCK, groom_of },
        { "surfaces[0]", SURFACE ", ", " } ]", &SCENE_SURFACE_BLOCK, surface_of },
        { "surfaces[0].animation.clips[0]", "surfaces: [ { name: a, file: m.glb, animation: { clips: [ { name: walk, ",
          " } ] } } ]", &SCENE_CLIP_BLOCK, clip_of },
        { "surfaces[0].pin_groups[0]", SURFACE ", pin_groups: [ { name: g, pins: [0], ", " } ] } ]",
          &SCENE_PIN_GROUP_BLOCK, group_of },
        { "seams[0]", "surfaces: [ { name: a, generate: { shape: plane }, cloth: {} } ], seams: [ { name: s, surfaces: [a, a], ",
          " } ]", &SCENE_SEAM_BLOCK, seam_of },
        { "hair_events[0]", STRANDS ", frozen_hair: { freeze: {}, align: {}, clump: {} } } ], hair_events: [ { step: 0, strands: a, ",
          " } ]", &SCENE_COMMAND_BLOCK, hair_event_of },
        { "events[0]", SURFACE ", cloth: {} } ], events: [ { step: 0, surface: a, ", " } ]", &SCENE_EVENT_BLOCK, NULL },
    };
    int checked = 0;
    for ( int i = 0; i < WISP_COUNT( places ); ++i )
    {
        check_block( &places[i], &checked );
    }
    for ( int shape = 0; shape < WISP_MESH_SHAPE_COUNT; ++shape )
    {
        place p = { .path = "surfaces[0].generate", .after = " } } ]", .block = &SCENE_MESH_BLOCKS[shape], .entry_of = mesh_of };
        snprintf( p.before, sizeof p.before, "surfaces: [ { name: a, generate: { shape: %s, ",
                  SCENE_MESH_BLOCKS[shape].fields[0].choices[shape].word );
        check_block( &p, &checked );
    }
    for ( int shape = 0; shape < WISP_COLLIDER_COUNT; ++shape )
    {
        place p = { .path = "colliders[0]", .after = " } ]", .block = &SCENE_COLLIDER_BLOCKS[shape], .entry_of = collider_of };
        snprintf( p.before, sizeof p.before, "colliders: [ { name: a, shape: %s, ",
                  SCENE_COLLIDER_BLOCKS[shape].fields[0].choices[shape].word );
        check_block( &p, &checked );
    }
    assert_true( checked > 300 );
}
