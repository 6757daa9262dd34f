#include "torture_keys.h"

#include "wisp/module/random.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- random numbers ----

// SplitMix64 (Steele, Lea and Flood 2014).
torture_random torture_random_start( uint64_t seed, uint64_t number )
{
    return ( torture_random ){ wisp_random_mix( wisp_random_mix( seed + 0x9e3779b97f4a7c15u ) + number ) };
}

uint64_t torture_random_next( torture_random* random )
{
    random->state += 0x9e3779b97f4a7c15u;
    return wisp_random_mix( random->state );
}

int torture_random_whole( torture_random* random, int lower, int upper )
{
    const uint64_t count = (uint64_t)( (int64_t)upper - lower + 1 );
    return lower + (int)( ( torture_random_next( random ) >> 11 ) % count );
}

bool torture_random_chance( torture_random* random, int percent )
{
    return torture_random_whole( random, 0, 99 ) < percent;
}

torture_number torture_random_linear( torture_random* random, double lower, double upper )
{
    const int STEPS = 40;
    torture_number number;
    const double value = lower + ( upper - lower ) * torture_random_whole( random, 0, STEPS ) / STEPS;
    snprintf( number.text, sizeof number.text, "%.3g", value == 0.0 ? 0.0 : value );
    return number;
}

torture_number torture_random_log( torture_random* random, double lower, double upper )
{
    static const int DIGITS[] = { 1, 2, 3, 5, 7 };
    enum
    {
        DIGIT_COUNT = 5,
        LOWEST = -15,
        HIGHEST = 15,
    };
    torture_number found = { "" };
    int count = 0;
    // Each candidate within the range replaces the one before with the probability that makes all equally likely.
    for ( int i = DIGIT_COUNT * LOWEST; i < DIGIT_COUNT * HIGHEST; ++i )
    {
        const int exponent = i / DIGIT_COUNT - ( i % DIGIT_COUNT < 0 );
        torture_number candidate;
        snprintf( candidate.text, sizeof candidate.text, "%de%d", DIGITS[i - DIGIT_COUNT * exponent], exponent );
        const double value = strtod( candidate.text, NULL );
        if ( value >= lower * ( 1.0 - 1e-6 ) && value <= upper * ( 1.0 + 1e-6 ) &&
             torture_random_whole( random, 0, count++ ) == 0 )
        {
            snprintf( found.text, sizeof found.text, "%.3g", value );
        }
    }
    if ( count == 0 )
    {
        snprintf( found.text, sizeof found.text, "%.3g", lower );
    }
    return found;
}

// ---- blocks ----

// Defaults of everything, made at the first use.
typedef struct defaults
{
    bool is_made;
    wisp_scene scene;
    wisp_scene_strands strands;
    wisp_scene_surface surface;
    wisp_scene_collider collider;
    wisp_scene_seam seam;
    wisp_groom_generator grooms[3];
    wisp_mesh_generator meshes[WISP_MESH_SHAPE_COUNT];
    wisp_scene_hair_event hair_event;
    scene_event event;
    wisp_scene_output output;
    wisp_scene_pose pose;
    wisp_scene_box box;
} defaults;

static const defaults* find_defaults( void )
{
    static defaults d;
    if ( !d.is_made )
    {
        d.scene = scene_defaults();
        d.strands = scene_default_strands( d.scene.gravity );
        d.surface = scene_default_surface( d.scene.gravity );
        d.collider = scene_default_collider();
        d.seam = scene_default_seam();
        for ( int i = 0; i < WISP_COUNT( d.grooms ); ++i )
        {
            d.grooms[i] = wisp_default_groom_generator( (wisp_groom_shape)i, 3 );
        }
        for ( int i = 0; i < WISP_MESH_SHAPE_COUNT; ++i )
        {
            d.meshes[i] = wisp_default_mesh_generator( (wisp_mesh_shape)i );
        }
        d.is_made = true;
    }
    return &d;
}

torture_block torture_block_of_scene( void )
{
    return ( torture_block ){ &SCENE_BLOCK_OF_ALL, &find_defaults()->scene };
}

static const scene_field* find_field( const scene_block* table, const char* key )
{
    for ( int i = 0; i < table->field_count; ++i )
    {
        if ( strcmp( table->fields[i].key, key ) == 0 )
        {
            return &table->fields[i];
        }
    }
    return NULL;
}

// The number of the word that `shape` has, 0 if it has none.
static int shape_of( const scene_block* table, const text_node* map )
{
    const scene_field* field = find_field( table, "shape" );
    const char* word = text_at( map, "shape" );
    for ( int i = 0; field && field->choices[i].word; ++i )
    {
        if ( strcmp( field->choices[i].word, word ) == 0 )
        {
            return i;
        }
    }
    return 0;
}

static bool is_collider( const scene_block* table )
{
    return table >= SCENE_COLLIDER_BLOCKS && table < SCENE_COLLIDER_BLOCKS + WISP_COLLIDER_COUNT;
}

static torture_block block_of_scene_key( const char* key, const text_node* value )
{
    const defaults* d = find_defaults();
    const struct
    {
        const char* key;
        torture_block block;
    } rows[] = {
        { "contact", { &SCENE_WORLD_CONTACT_BLOCK, &d->scene } },
        { "strands", { &SCENE_STRANDS_BLOCK, &d->strands } },
        { "surfaces", { &SCENE_SURFACE_BLOCK, &d->surface } },
        { "colliders", { &SCENE_COLLIDER_BLOCKS[shape_of( SCENE_COLLIDER_BLOCKS, value )], &d->collider } },
        { "seams", { &SCENE_SEAM_BLOCK, &d->seam } },
        { "hair_events", { &SCENE_COMMAND_BLOCK, &d->hair_event } },
        { "events", { &SCENE_EVENT_BLOCK, &d->event } },
        { "output", { &SCENE_OUTPUT_BLOCK, &d->output } },
    };
    for ( int i = 0; i < WISP_COUNT( rows ); ++i )
    {
        if ( strcmp( rows[i].key, key ) == 0 )
        {
            return rows[i].block;
        }
    }
    return ( torture_block ){ NULL, NULL };
}

torture_block torture_block_below( torture_block block, const char* key, const text_node* value )
{
    const defaults* d = find_defaults();
    if ( block.table == &SCENE_BLOCK_OF_ALL )
    {
        return block_of_scene_key( key, value );
    }
    const scene_field* field = block.table ? find_field( block.table, key ) : NULL;
    if ( field == NULL || field->block != NULL )
    {
        return ( torture_block ){ field ? field->block : NULL, block.base };
    }
    const bool is_mesh = block.table == &SCENE_SURFACE_BLOCK || is_collider( block.table );
    if ( strcmp( key, "generate" ) == 0 )
    {
        const int mesh = is_mesh ? shape_of( SCENE_MESH_BLOCKS, value ) : 0;
        return is_mesh
                   ? ( torture_block ){ &SCENE_MESH_BLOCKS[mesh], &d->meshes[mesh] }
                   : ( torture_block ){ &SCENE_GENERATE_BLOCK, &d->grooms[shape_of( &SCENE_GENERATE_BLOCK, value )] };
    }
    if ( strcmp( key, "keyframes" ) == 0 )
    {
        return ( torture_block ){ &SCENE_POSITION_BLOCK, &d->pose };
    }
    if ( strcmp( key, "pin_keyframes" ) == 0 )
    {
        return ( torture_block ){ &SCENE_PIN_POSE_BLOCK, &d->pose };
    }
    return strcmp( key, "pin_box" ) == 0 ? ( torture_block ){ &SCENE_BOX_BLOCK, &d->box }
                                         : ( torture_block ){ NULL, NULL };
}

// ---- spans ----

// Where values of a key are sensible. Both 0: the generator sets the key, or it must not be drawn.
typedef struct span
{
    const char* key;
    double lower, upper;
} span;

// Keys of the same name mean the same in all blocks, so that a name is enough. What is not here spans two powers of
// ten on each side of its default.
static const span SPANS[] = {
    { "dt", 0, 0 },
    { "steps", 0, 0 },
    { "workers", 0, 0 },
    { "substeps", 2, 20 },
    { "iterations", 1, 4 },
    { "gravity", 0, 0 },
    { "show", 0, 0 },
    { "max_points", 0, 0 },
    { "eye_angle", 0, 0 },
    { "min_spacing", 0, 0 },
    { "max_spacing", 0, 0 },
    { "strain_gain", 0, 1 },
    { "scale", 0, 0 },
    { "translate", 0, 0 },
    { "position", 0, 0 },
    { "shape", 0, 0 },
    { "time", 0, 0 },
    { "step", 0, 0 },
    { "cursor", 0, 0 },
    { "pivot", 0, 0 },
    { "pin_pivot", 0, 0 },
    { "eye", 0, 0 },
    // meshes and grooms: a few hundred vertices, centimetres apart
    { "columns", 2, 14 },
    { "rows", 2, 14 },
    { "spacing", 0.01, 0.07 },
    { "width", 0.1, 0.7 },
    { "depth", 0.1, 0.7 },
    { "level", 0, 2 },
    { "segments", 3, 14 },
    { "rings", 3, 10 },
    { "length_segments", 1, 8 },
    { "radius", 0.03, 0.3 },
    { "tube_radius", 0.01, 0.02 },
    { "length", 0.03, 0.5 },
    { "half_length", 0, 0.5 },
    { "half_extent", 0.02, 0.5 },
    { "strands", 1, 12 },
    { "vertices", 0, 0 },
    { "dimension", 3, 3 },
    { "scalp_radius", 0.03, 0.1 },
    { "wave_amplitude", 1e-3, 0.02 },
    { "wave_length", 0.02, 0.2 },
    { "samples", 1, 8 },
    { "count", 1, 4 },
    // what things are made of
    { "area_density", 0.01, 5 },
    { "vertex_mass", 1e-5, 1e-2 },
    { "line_density", 1e-6, 1e-3 },
    { "warp_compliance", 1e-8, 1e-2 },
    { "weft_compliance", 1e-8, 1e-2 },
    { "shear_compliance", 1e-8, 1e-2 },
    { "stretch_compliance", 1e-8, 1e-2 },
    { "bend_compliance", 1e-4, 10 },
    { "edge_stiffness", 50, 2e4 },
    { "bend_link_stiffness", 0.2, 2e3 },
    { "compression_stiffness", 1, 1e4 },
    { "link_damping", 1e-4, 1 },
    { "internal_damping", 0.05, 20 },
    { "damping", 0.05, 20 },
    { "bend_damping", 1e-4, 0.1 },
    { "strain_limit", 0, 0 },
    { "warp", -1, 1 },
    { "tether_slack", 1, 1.5 },
    { "coarse_substeps", 0, 0 },
    { "coarse_passes", 0, 0 },
    { "tile_size", 0, 0 },
    { "teleport", 1, 20 },
    // solvers
    { "max_iterations", 0, 0 },
    { "newton_iterations", 1, 4 },
    { "max_newton_iterations", 1, 16 },
    { "tolerance", 1e-6, 1e-2 },
    { "stretch_passes", 2, 8 },
    { "stretch_tolerance", 1e-4, 0.1 },
    { "max_neighbours", 8, 256 },
    { "margin", 0.1, 10 },
    // air, gas and weather
    { "wind", -8, 8 },
    { "air_density", 0.1, 5 },
    { "drag_coefficient", 0.05, 2 },
    { "lift_coefficient", 0.05, 2 },
    { "gas_ratio", 0, 0 },
    { "min_gas_ratio", 0.2, 1 },
    { "inflation_rate", 0, 0 },
    { "atmospheric_pressure", 1e3, 5e5 },
    { "temperature", 200, 400 },
    { "gas_molar_mass", 2e-3, 0.05 },
    { "air_molar_mass", 0.01, 0.05 },
    { "outlet_nearest", 0, 0 },
    { "outlet_radius", 0, 0 },
    { "outlet_open", 0, 0 },
    { "allow_open", 0, 0 },
    { "temperature_celsius", -30, 30 },
    { "freezing_celsius", -5, 5 },
    { "velocity", -3, 3 },
    { "angular_velocity", -6, 6 },
    { "gust", 0, 0 },
    { "gust_per_triangle", 0, 0 },
    // contact
    { "thickness", 1e-3, 0.02 },
    { "friction", 0, 1.5 },
    { "friction_scale", 0, 2 },
    { "max_push_out_speed", 0.05, 2 },
    { "repulsion", 0, 20 },
    { "enabled", 0, 0 },
    // seams, whose pairs the generator draws
    { "within", 0, 0 },
    { "distance", 0, 0.05 },
    { "compliance", 1e-6, 10 },
    { "strength", 0.01, 100 },
    // ghosts
    { "target_count", 1, 3 },
    { "resample", 0, 0 },
    { "tip_gain", 0, 2 },
    { "centre_gain", 0, 2 },
    { "spread", 0.2, 3 },
};

static const span* find_span( const char* key )
{
    for ( int i = 0; i < WISP_COUNT( SPANS ); ++i )
    {
        if ( strcmp( SPANS[i].key, key ) == 0 )
        {
            return &SPANS[i];
        }
    }
    return NULL;
}

// ---- values ----

static text_node* draw_word( torture_random* random, const scene_field* field )
{
    int count = 0;
    while ( field->choices[count].word )
    {
        ++count;
    }
    return text_scalar( "%s", field->choices[torture_random_whole( random, 0, count - 1 )].word );
}

// A number in the span of its key; without a span around its default, or anywhere in a range that is short.
static torture_number draw_number( torture_random* random, const scene_field* field, double initial )
{
    const double FACTOR = 100.0, SHORT = 10.0;
    const span* s = find_span( field->key );
    initial = isfinite( initial ) ? initial : 1.0; // no limit, until there is one
    double lower = s ? s->lower : initial / FACTOR, upper = s ? s->upper : initial * FACTOR;
    if ( !s && ( initial <= 0.0 || field->range.upper - field->range.lower <= SHORT ) )
    {
        lower = field->range.lower;
        upper = fmin( field->range.upper, lower + SHORT );
    }
    lower = fmax( lower, field->range.lower );
    upper = fmin( upper, field->range.upper );
    return lower > 0.0 && upper / lower > 20.0 ? torture_random_log( random, lower, upper )
                                               : torture_random_linear( random, lower, upper );
}

static text_node* draw_whole( torture_random* random, const scene_field* field, int initial )
{
    const span* s = find_span( field->key );
    const double lower = fmax( s ? s->lower : initial / 2, field->range.lower );
    const double upper = fmin( s ? s->upper : 2 * initial + 1, field->range.upper );
    return text_scalar( "%d", torture_random_whole( random, (int)lower, (int)upper ) );
}

static text_node* draw_vector( torture_random* random, const scene_field* field )
{
    text_node* list = text_list();
    for ( int i = 0; i < 3; ++i )
    {
        text_add( list, text_scalar( "%s", draw_number( random, field, 0.0 ).text ) );
    }
    return list;
}

// Draw a value for a key. @return false: no number, word or vector, or a key that the generator sets itself
static bool draw_key( torture_random* random, const scene_field* field, const void* base, text_node** value )
{
    const void* at = (const char*)base + field->at;
    const span* s = find_span( field->key );
    if ( s && s->lower == 0.0 && s->upper == 0.0 )
    {
        return false;
    }
    switch ( field->type )
    {
        case SCENE_NUMBER:
        case SCENE_NUMBERS:
            *value = text_scalar( "%s", draw_number( random, field, (double)*(const float*)at ).text );
            return true;
        case SCENE_WHOLE:
            *value = draw_whole( random, field, *(const int*)at );
            return true;
        case SCENE_SEED:
            *value = text_scalar( "%d", torture_random_whole( random, 1, 999 ) );
            return true;
        case SCENE_SWITCH:
            *value = text_scalar( "%s", torture_random_chance( random, 50 ) ? "true" : "false" );
            return true;
        case SCENE_CHOICE:
        case SCENE_EITHER:
            *value = draw_word( random, field );
            return true;
        case SCENE_VECTOR:
            *value = draw_vector( random, field );
            return true;
        case SCENE_TEXT:
        case SCENE_BLOCK:
        case SCENE_USUAL:
        case SCENE_CUSTOM:
            return false;
    }
    return false;
}

// Keys that only suites ask for. A draw for it would make every scene of a seed another one.
static bool is_left_out( const scene_field* field )
{
    static const char* const KEYS[] = { "mass_ratio", "copies", "weld_distance" };
    bool is_out = false;
    for ( int i = 0; i < WISP_COUNT( KEYS ); ++i )
    {
        is_out = is_out || strcmp( field->key, KEYS[i] ) == 0;
    }
    return is_out;
}

void torture_draw_keys( torture_random* random, torture_block block, int percent, text_node* map )
{
    const int WORDS = 60; // words choose the code that runs, numbers only what it computes
    for ( int i = 0; i < block.table->field_count; ++i )
    {
        const scene_field* field = &block.table->fields[i];
        const bool is_word = field->type == SCENE_CHOICE || field->type == SCENE_EITHER;
        const int chance = is_word && percent > 0 && percent < WORDS ? WORDS : percent;
        text_node* value = NULL;
        if ( !is_left_out( field ) && text_find( map, field->key ) == NULL &&
             torture_random_chance( random, chance ) && draw_key( random, field, block.base, &value ) )
        {
            text_put( map, field->key, value );
        }
    }
}
