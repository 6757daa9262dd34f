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

// Print a text that must have room.
__attribute__( ( format( printf, 3, 4 ) ) ) static void print( char* out, size_t size, const char* format, ... )
{
    va_list arguments;
    va_start( arguments, format );
    assert_in_range( vsnprintf( out, size, format, arguments ), 0, size - 1 );
    va_end( arguments );
}

// ---- blocks ----

// What a block fills.
typedef enum entry
{
    SCENE,
    STRANDS_ENTRY, // the last one
    GROOM,
    SURFACE_ENTRY,
    MESH,
    CLIP,
    PIN_GROUP,
    COLLIDER,
    SEAM,
    HAIR_EVENT,
    NOTHING, // that is there once the scene is read
} entry;

// A block in a scene of one line.
typedef struct place
{
    char path[100], before[500], after[120]; // of messages; the text around its keys
    const scene_block* block;
    entry entry;
} place;

static const char* entry_of( const place* p, const wisp_scene* scene )
{
    const wisp_scene_surface* surface = scene->surfaces;
    const void* const entries[] = {
        [SCENE] = scene,
        [STRANDS_ENTRY] = scene->strands ? &scene->strands[scene->strands_count - 1] : NULL,
        [GROOM] = scene->strands ? &scene->strands->generator : NULL,
        [SURFACE_ENTRY] = surface,
        [MESH] = surface ? &surface->mesh.generator : NULL,
        [CLIP] = surface ? surface->animation.clips : NULL,
        [PIN_GROUP] = surface ? surface->pin_groups : NULL,
        [COLLIDER] = scene->colliders,
        [SEAM] = scene->seams,
        [HAIR_EVENT] = scene->commands,
    };
    return entries[p->entry];
}

#define STRANDS "strands: [ { name: a, generate: { strands: 3 }"
#define SURFACE "surfaces: [ { name: a, generate: { shape: plane, columns: 3, rows: 3 }"

// What blocks of these names need in their entry besides its own keys; of strands also an entry before it.
static const struct
{
    const char *path, *before;
} NEEDS[] = {
    { "strands[0].ghosts", "strands: [ { name: b, generate: {}, dynamics: {} }, { name: a, scatter: { around: b, "
                           "count: 2, radius: 0.01 }, " },
    { "strands[0].scatter", "strands: [ { name: b, generate: {} }, { name: a, " },
    { "strands[0].curves", "strands: [ { name: b, generate: {} }, { name: a, " },
    { "strands[0].frame", STRANDS ", dynamics: {}, head: { keyframes: [ { time: 1, position: [0, 0, 0] } ] }, " },
    { "strands[0].head start tips grid collision contact sleep detail", STRANDS ", dynamics: {}, " },
    { "surfaces[0].tearing", SURFACE ", cloth: {}, " },
    { "surfaces[0].membrane", SURFACE ", cloth: { bending: none }, " },
    { "surfaces[0].motion_constraints", SURFACE ", cloth: {}, " },
    { "surfaces[0].frame", SURFACE ", cloth: {}, pins: [0], pin_keyframes: [ { time: 1 } ], " },
    { "surfaces[0].animation", "surfaces: [ { name: a, file: m.glb, " },
};

// Values of keys that must be there, and keys that a key asks for.
static const struct
{
    const char *key, *value;
} REQUIRED[] = {
    { "around", "b" },
    { "of", "b" },
    { "radius", "0.01" },
    { "count", "2" },
    { "spacing", "[1, 0, 0]" },
    { "strength", "1" },
    { "step", "0" },
    { "keyframes", "[ { time: 1, position: [0, 0, 0] } ]" },
    { "clips", "[ { clip: walk } ]" },
};
// The first row that a path begins with counts.
static const struct
{
    const char *path, *with;
} WITH[] = {
    { "strands[0].max_speed", ", dynamics: {}" },
    { "surfaces[0].cloth.solver", ", coarse_substeps: 0" }, // which pbd does not have
    { "colliders[0].weld_distance", ", repair: [weld]" },
    { "surfaces[0].weld_distance", ", repair: [weld]" },
    { "surfaces[0].pin_pivot", ", pins: [0], pin_keyframes: [ { time: 1 } ]" },
    { "surfaces[0].boundary.eye.", ", eye_angle: 0.1" },
    { "surfaces[0].balloon.outlet_radius", ", outlet_nearest: [0, 0, 0]" },
    { "surfaces[0].motion_constraints.max_distance", "" },
    { "surfaces[0].motion_constraints.pivot", ", max_distance: 1, keyframes: [ { time: 1 } ]" },
    { "surfaces[0].motion_constraints.backstop.", "" },
    { "surfaces[0].motion_constraints", ", max_distance: 1, backstop: 0.1" },
    { "seams[0].within", "" },
    { "seams[0]", ", within: 0.1" },
    { "hair_events[0].cursor", "" },
    { "hair_events[0]", ", cursor: [0, 0, 0]" },
    { "events[0].step", ", surface: a, teleport: [1, 0, 0]" },
    { "events[0].time", ", surface: a, teleport: [1, 0, 0]" },
    { "events[0].wind", ", surface: b, step: 0" },
    { "events[0].hold", ", surface: b, step: 0, pin_group: g" },
    { "events[0].detach_pins", ", surface: c, step: 0" },
    { "events[0].gust_per_triangle", ", surface: a, step: 0, gust: [1, 0, 0]" },
    { "events[0]", ", surface: a, step: 0" },
};

// Append what a block needs besides a key.
static void add_needs( const place* p, const char* key, char* text )
{
    char path[160];
    print( path, sizeof path, "%s.%s.", p->path, key );
    for ( int i = 0; i < WISP_COUNT( WITH ); ++i )
    {
        if ( strncmp( WITH[i].path, path, strlen( WITH[i].path ) ) == 0 )
        {
            strcat( text, WITH[i].with );
            break;
        }
    }
    for ( int i = 0; i < p->block->field_count; ++i )
    {
        const scene_field* field = &p->block->fields[i];
        for ( int k = 0; k < WISP_COUNT( REQUIRED ); ++k )
        {
            if ( field->required && strcmp( REQUIRED[k].key, field->key ) == 0 && strcmp( field->key, key ) != 0 )
            {
                sprintf( text + strlen( text ), ", %s: %s", field->key, REQUIRED[k].value );
            }
        }
    }
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

// Read the scene with a value for a key. @param value null: without the key
static attempt try_value( const place* p, const char* key, const char* value )
{
    char text[TEXT_MAX], needs[300] = "";
    attempt a = { .error = { .status = WISP_OK } };
    add_needs( p, key, needs );
    const char* others = value ? needs : needs[0] ? needs + 2 : "";
    const int before =
        snprintf( text, sizeof text, "{ wisp: 1, %s%s%s", p->before, value ? key : "", value ? ": " : "" );
    const int length = before + snprintf( text + before, sizeof text - (size_t)before, "%s%s%s }", value ? value : "",
                                          others, p->after );
    assert_in_range( length, 1, TEXT_MAX - 1 );
    a.column = before + 1;
    wisp_scene_parse( text, strlen( text ), "test.yaml", &a.scene, &a.error );
    return a;
}

static void demand_refusal( const place* p, const char* key, const char* value, int column, const char* words )
{
    char expected[600];
    SCOPED( attempt_release ) attempt a = try_value( p, key, value );
    print( expected, sizeof expected, "test.yaml:1:%d: %s%s%s%s", a.column + column, p->path, p->path[0] ? "." : "",
           key, words );
    assert_string_equal( a.error.message, expected );
}

// A word that is none of the choices, or a number that has a word, is refused with all of them.
static void refuse_words( const place* p, const scene_field* field )
{
    char words[500] = ": got 'q', expected true or false";
    for ( int i = 0; field->type != SCENE_SWITCH && field->choices[i].word; ++i )
    {
        const size_t used = i > 0 ? strlen( words ) : 0;
        print( words + used, sizeof words - used, "%s%s", i > 0 ? ", " : ": got 'q', expected one of ",
               field->choices[i].word );
    }
    demand_refusal( p, field->key, "q", 0, words );
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
    char number[40], value[100], words[200];
    const int parts = field->type == SCENE_VECTOR ? 3 : 1;
    for ( int i = 0; i < 2 * parts; ++i )
    {
        const int k = i / 2;
        const char* other = field->range.lower > 0.0 ? "1" : "0"; // in the range
        print_outside( field, i % 2 == 1, number );
        print( value, sizeof value, parts > 1 ? "[%s, %s, %s]" : "%s", k == 0 ? number : other,
               k == 1 ? number : other, k == 2 ? number : other );
        print( words, sizeof words, "[%d]: got %s, expected a value in [%.9g, %.9g]", k, number, field->range.lower,
               field->range.upper );
        demand_refusal( p, field->key, value, parts > 1 ? 1 + 3 * k : 0, words + ( parts > 1 ? 0 : 3 ) );
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
            snprintf( text, 100, "%s",
                      field->type == SCENE_EITHER ? field->choices[on].word
                      : on                        ? "true"
                                                  : "false" );
            memcpy( bytes, &on, sizeof on );
            return sizeof on;
        default:
            snprintf( text, 100, "%.9g", (double)number );
            memcpy( bytes, &number, sizeof number );
            return sizeof number;
    }
}

// A member of two definitions must be the same.
static void compare( const place* p, const char* key, const wisp_field* row, const char* found, const char* expected )
{
    static const size_t WIDTHS[] = {
        [WISP_FIELD_DOUBLE] = 8,  [WISP_FIELD_SWITCH] = 1, [WISP_FIELD_SEED] = 8,
        [WISP_FIELD_VECTOR] = 12, [WISP_FIELD_POINT] = 12, [WISP_FIELD_POSE] = 4,
    };
    const size_t width = WIDTHS[row->type] > 0 ? WIDTHS[row->type] : 4;
    if ( memcmp( found + row->offset, expected + row->offset, width ) != 0 )
    {
        fail_msg( "%s: %s differs with the key '%s'", p->path, row->name, key );
    }
}

// The value is at its place, and no other number of the definition differs from what it is without the key.
static void check_struct( const place* p, const scene_field* field, const attempt* a, const unsigned char* bytes,
                          size_t size )
{
    if ( p->entry == NOTHING )
    {
        return;
    }
    const char* filled = entry_of( p, &a->scene );
    if ( memcmp( filled + field->at, bytes, size ) != 0 )
    {
        fail_msg( "%s.%s is not at its place", p->path, field->key );
    }
    if ( field->given && !*(const bool*)( filled + field->given ) )
    {
        fail_msg( "%s.%s is not marked as given", p->path, field->key );
    }
    SCOPED( attempt_release ) attempt without = try_value( p, field->key, NULL );
    for ( int i = 0; p->block->of && without.error.status == WISP_OK && i < p->block->of->count; ++i )
    {
        const wisp_field* row = &p->block->of->rows[i];
        if ( p->block->at + row->offset != field->at )
        {
            compare( p, field->key, row, filled + p->block->at, entry_of( p, &without.scene ) + p->block->at );
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
    else if ( strstr( a.error.message, ": got" ) &&
              strstr( a.error.message, field->key ) == strstr( a.error.message, ": got" ) - strlen( field->key ) )
    {
        fail_msg( "%s: %s", text, a.error.message );
    }
    return a.error.status == WISP_OK;
}

// A number for each of three strands.
static void check_list( const place* p, const scene_field* field )
{
    if ( field->type == SCENE_NUMBERS )
    {
        SCOPED( attempt_release ) attempt a = try_value( p, field->key, "[0.5, 0.25, 1]" );
        assert_ok( a.error.status, a.error );
        const char* filled = entry_of( p, &a.scene );
        const float expected[] = { 0.5f, 0.25f, 1.0f };
        assert_int_equal( *(const int*)( filled + field->list_count ), 3 );
        assert_memory_equal( *(const float* const*)( filled + field->list ), expected, sizeof expected );
    }
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
    if ( strcmp( field->key, "shape" ) == 0 &&
         ( p->block->fields == SCENE_COLLIDER_BLOCKS[0].fields || field->required ) )
    {
        return; // it is there already
    }
    const double lower = field->range.lower, upper = field->range.upper;
    switch ( field->type )
    {
        case SCENE_NUMBER:
        case SCENE_NUMBERS:
        case SCENE_WHOLE:
            check_list( p, field );
            taken += set_value( p, field, lower ) + set_value( p, field, upper );
            taken += set_value( p, field, fmin( lower + 1.0, lower + 0.75 * ( upper - lower ) ) );
            taken += lower <= 1000.0 && upper >= 1000.0 && set_value( p, field, 1000.0 );
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
            refuse_words( p, field );
            break;
        case SCENE_SWITCH:
            taken += set_value( p, field, 0.0 ) + set_value( p, field, 1.0 );
            refuse_words( p, field );
            break;
        default:
            return;
    }
    if ( taken == 0 )
    {
        fail_msg( "no value of %s.%s is taken", p->path, field->key );
    }
    ++*checked;
}

// ---- all keys ----

static void check_block( const place* p, int* checked );

static bool is_word( const char* word, const char* words )
{
    const size_t length = strlen( word );
    const char* at = strstr( words, word );
    return at && ( at == words || at[-1] == ' ' ) && ( at[length] == ' ' || at[length] == '\0' );
}

static void check_inner( const place* p, const scene_field* field, int* checked )
{
    place inner = *p;
    print( inner.path, sizeof inner.path, "%s%s%s", p->path, p->path[0] ? "." : "", field->key );
    for ( int i = 0; i < WISP_COUNT( NEEDS ); ++i )
    {
        const size_t root = strlen( p->path );
        if ( strncmp( NEEDS[i].path, p->path, root ) == 0 && NEEDS[i].path[root] == '.' &&
             is_word( field->key, NEEDS[i].path + root + 1 ) )
        {
            print( inner.before, sizeof inner.before, "%s", NEEDS[i].before );
            inner.path[sizeof "strands[" - 1] =
                strstr( inner.before, "name: b" ) ? '1' : inner.path[sizeof "strands[" - 1];
        }
    }
    print( inner.before + strlen( inner.before ), sizeof inner.before - strlen( inner.before ), "%s: { ",
           field->key );
    print( inner.after, sizeof inner.after, " }%s", p->after );
    inner.block = field->block;
    check_block( &inner, checked );
}

// The stages of frozen hair, which their blocks switch on, and counts of heights.
static bool is_from_elsewhere( const place* p, const char* name )
{
    return ( strcmp( p->block->of->definition, "frozen_hair_def" ) == 0 && is_word( name, "freeze align clump" ) ) ||
           ( strstr( p->before, "heights: " ) && strstr( name, "height_count" ) );
}

static const char* key_of( const scene_block* block, const wisp_field* row )
{
    for ( int i = 0; i < block->field_count; ++i )
    {
        const scene_field field = scene_field_at( block, i );
        if ( field.type < SCENE_BLOCK && field.at == block->at + row->offset )
        {
            return field.key;
        }
    }
    return row->name;
}

// Without keys a definition is that of its module.
static void check_defaults( const place* p )
{
    const wisp_fields* of = p->block->of;
    char needs[300] = "";
    if ( of == NULL || p->entry == NOTHING )
    {
        return;
    }
    SCOPED( attempt_release ) attempt a = try_value( p, "", NULL );
    SCOPED( free_local ) char* expected = checked_calloc( of->size, 1 );
    add_needs( p, "", needs );
    wisp_def_init( of, expected, of->size );
    assert_ok( a.error.status, a.error );
    for ( int i = 0; i < of->count; ++i )
    {
        const wisp_field* row = &of->rows[i];
        char key[80];
        print( key, sizeof key, " %s: ", key_of( p->block, row ) );
        if ( !strstr( needs, key ) && !strstr( p->before, key ) && !is_from_elsewhere( p, row->name ) )
        {
            compare( p, "", row, entry_of( p, &a.scene ) + p->block->at, expected );
        }
    }
}

static void check_block( const place* p, int* checked )
{
    check_defaults( p );
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

static const char* shape_word( const scene_block* block, int shape )
{
    const scene_field* field = block->fields;
    while ( strcmp( field->key, "shape" ) != 0 )
    {
        ++field;
    }
    return field->choices[shape].word;
}

TEST( every_key_reaches_its_place_and_keeps_its_range )
{
    static const place places[] = {
        { "", "", "", &SCENE_BLOCK_OF_ALL, SCENE },
        { "contact", "contact: { ", " }", &SCENE_WORLD_CONTACT_BLOCK, SCENE },
        { "strands[0]", STRANDS ", ", " } ]", &SCENE_STRANDS_BLOCK, STRANDS_ENTRY },
        { "strands[0].generate", "strands: [ { name: a, generate: { ", " } } ]", &SCENE_GENERATE_BLOCK, GROOM },
        { "surfaces[0]", SURFACE ", ", " } ]", &SCENE_SURFACE_BLOCK, SURFACE_ENTRY },
        { "surfaces[0].animation.clips[0]",
          "surfaces: [ { name: a, file: m.glb, animation: { clips: [ { clip: walk, ", " } ] } } ]", &SCENE_CLIP_BLOCK,
          CLIP },
        { "surfaces[0].pin_groups[0]", SURFACE ", pin_groups: [ { name: g, pins: [0], ", " } ] } ]",
          &SCENE_PIN_GROUP_BLOCK, PIN_GROUP },
        { "seams[0]",
          SURFACE ", cloth: {} }, { name: b, instance_of: a, cloth: {} } ], seams: [ { name: s, surfaces: [a, b], ",
          " } ]", &SCENE_SEAM_BLOCK, SEAM },
        { "hair_events[0]",
          "steps: 1000000, " STRANDS
          ", frozen_hair: { base: stroke, freeze: {}, align: {}, clump: {} } } ], hair_events: [ { strands: a, ",
          " } ]", &SCENE_COMMAND_BLOCK, HAIR_EVENT },
        { "events[0]",
          "steps: 1000000, surfaces: [ { name: a, generate: { shape: icosphere }, balloon: { outlet: [0] }, pins: "
          "[1] }, "
          "{ name: b, generate: { shape: plane }, cloth: { drag_coefficient: 1 }, pin_groups: [ { name: g, pins: "
          "[0], starts_free: true } ] }, "
          "{ name: c, generate: { shape: plane }, pins: [0], attach_pins: b } ], events: [ { ",
          " } ]", &SCENE_EVENT_BLOCK, NOTHING },
    };
    int checked = 0;
    for ( int i = 0; i < WISP_COUNT( places ); ++i )
    {
        check_block( &places[i], &checked );
    }
    for ( int shape = 0; shape < WISP_MESH_SHAPE_COUNT; ++shape )
    {
        place p = {
            .path = "surfaces[0].generate", .after = " } } ]", .block = &SCENE_MESH_BLOCKS[shape], .entry = MESH
        };
        print( p.before, sizeof p.before, "surfaces: [ { name: a, generate: { shape: %s, ",
               shape_word( p.block, shape ) );
        check_block( &p, &checked );
    }
    for ( int shape = 0; shape < WISP_COLLIDER_SURFACE; ++shape )
    {
        const bool has_mesh = shape == WISP_COLLIDER_MESH || shape == WISP_COLLIDER_CONVEX;
        place p = {
            .path = "colliders[0]", .after = " } ]", .block = &SCENE_COLLIDER_BLOCKS[shape], .entry = COLLIDER
        };
        print( p.before, sizeof p.before, "colliders: [ { name: a, shape: %s, %s", shape_word( p.block, shape ),
               has_mesh                              ? "generate: { shape: icosphere }, "
               : shape == WISP_COLLIDER_HEIGHT_FIELD ? "heights: [[0, 0], [0, 0]], "
                                                     : "" );
        check_block( &p, &checked );
    }
    assert_true( checked > 300 );
}
