#include "tune_knobs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// Where a field is: in the scene itself, or in surfaces of one kind.
typedef enum field_place
{
    OF_SCENE,
    OF_CLOTH,        ///< surfaces with `cloth`
    OF_PINNED_CLOTH, ///< those of them that hang by something
    OF_IMPLICIT,     ///< surfaces with `implicit`
} field_place;

#define CANDIDATES_MAX 6

/// Coarse levels that a fabric gets which has none and is to be passed over.
#define LEVELS 3

/// One row a knob. Values go from rough to fine; the scene's own joins them. Short cuts that help a rough setting, and
/// that a fine one does without, have no order: the last value, without them, is the truth's.
typedef struct field
{
    const char* name; ///< as the scene writes it
    const char* block;
    const char* key;
    field_place place;
    bool is_unordered, is_switch;
    double candidates[CANDIDATES_MAX]; ///< end with 0, unless it is full
} field;

enum
{
    FIELD_SUBSTEPS,
    FIELD_ITERATIONS,
    FIELD_TETHERS,
    FIELD_LEVEL_PASSES,
    FIELD_TOLERANCE,
    FIELD_REPEATS,
    FIELD_COUNT,
};

_Static_assert( (int)FIELD_COUNT <= WISP_TUNE_MAX_KNOBS, "a scene may have all of them" );

static const field fields[FIELD_COUNT] = {
    [FIELD_SUBSTEPS] = { "substeps", NULL, "substeps", OF_SCENE, .candidates = { 1, 2, 4, 8, 16 } },
    [FIELD_ITERATIONS] = { "iterations", NULL, "iterations", OF_SCENE, .candidates = { 1, 2, 4 } },
    [FIELD_TETHERS] = { "cloth.tethers", "cloth", "tethers", OF_PINNED_CLOTH, true, true, { 1 } },
    [FIELD_LEVEL_PASSES] = { "cloth.level_passes", "cloth", "level_passes", OF_CLOTH, true, .candidates = { 1 } },
    [FIELD_TOLERANCE] = { "implicit.tolerance", "implicit", "tolerance", OF_IMPLICIT,
                          .candidates = { 1e-1, 1e-2, 1e-3, 1e-4 } },
    [FIELD_REPEATS] = { "implicit.newton_repeats", "implicit", "newton_repeats", OF_IMPLICIT,
                        .candidates = { 1, 2, 4 } },
};

// ---- what a scene has ----

// An instance shares the fabric of its source, and with it what the fabric was cooked for.
static bool has_field( const wisp_scene_surface* surface, int which )
{
    const bool is_cloth = surface->has_cloth && surface->instance_of < 0;
    switch ( fields[which].place )
    {
        case OF_CLOTH:
            return is_cloth;
        case OF_PINNED_CLOTH:
            return is_cloth && surface->pin_count + surface->pin_box_count + surface->pin_nearest_count > 0;
        case OF_IMPLICIT:
            return surface->has_implicit;
        case OF_SCENE:
            break;
    }
    return false;
}

static double surface_value( const wisp_scene_surface* surface, int which )
{
    switch ( which )
    {
        case FIELD_TETHERS:
            return surface->cloth.tethers ? 1.0 : 0.0;
        case FIELD_LEVEL_PASSES:
            return surface->levels > 0 ? surface->cloth.level_passes : 0.0;
        case FIELD_TOLERANCE:
            return (double)surface->implicit.tolerance;
        default:
            return surface->implicit.newton_repeats;
    }
}

static void set_surface( wisp_scene_surface* surface, int which, double value )
{
    switch ( which )
    {
        case FIELD_TETHERS:
            surface->cloth.tethers = value > 0.0;
            break;
        case FIELD_LEVEL_PASSES:
            surface->cloth.level_passes = (int)value;
            surface->levels = value > 0.0 && surface->levels == 0 ? LEVELS : surface->levels;
            break;
        case FIELD_TOLERANCE:
            surface->implicit.tolerance = (float)value;
            break;
        default:
            surface->implicit.newton_repeats = (int)value;
            break;
    }
}

/// The scene's own value of a field. @return false: nothing has it
static bool find_own( const wisp_scene* scene, int which, double* out )
{
    if ( fields[which].place == OF_SCENE )
    {
        *out = which == FIELD_SUBSTEPS ? scene->substeps : scene->iterations;
        return true;
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        if ( has_field( &scene->surfaces[i], which ) )
        {
            *out = surface_value( &scene->surfaces[i], which );
            return true;
        }
    }
    return false;
}

// Implicit cloth has its own loop: the scene's iterations change it only where something else is solved for with it.
static bool uses_iterations( const wisp_scene* scene )
{
    bool uses = false;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        uses |= !scene->surfaces[i].has_implicit;
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        uses |= scene->strands[i].has_dynamics;
    }
    return uses;
}

static bool moves( const wisp_scene* scene )
{
    bool does = scene->surface_count > 0;
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        does |= scene->strands[i].has_dynamics;
    }
    return does;
}

// ---- values ----

// Rising, but for tolerances, which get finer as they fall. Equal as floats is equal: the scene's own came from one.
static void insert_value( tune_knobs* out, double value, bool is_falling )
{
    wisp_tune_knob* knob = &out->knobs[out->count];
    double* values = out->values[out->count];
    int place = knob->value_count;
    while ( place > 0 && ( is_falling ? values[place - 1] < value : values[place - 1] > value ) )
    {
        --place;
    }
    if ( place > 0 && (float)values[place - 1] == (float)value )
    {
        return;
    }
    // A float that is a hair below its decimal stands behind it.
    if ( place < knob->value_count && (float)values[place] == (float)value )
    {
        return;
    }
    memmove( values + place + 1, values + place, (size_t)( knob->value_count - place ) * sizeof *values );
    values[place] = value;
    ++knob->value_count;
}

static void add_knob( tune_knobs* out, int which, double own )
{
    const field* f = &fields[which];
    out->fields[out->count] = which;
    out->knobs[out->count] =
        ( wisp_tune_knob ){ .name = f->name, .values = out->values[out->count], .is_unordered = f->is_unordered };
    for ( int i = 0; i < CANDIDATES_MAX && f->candidates[i] > 0.0; ++i )
    {
        // One switched-on value is enough, and the scene's is the better one.
        const bool is_own = f->is_unordered && own > 0.0;
        insert_value( out, is_own ? own : f->candidates[i], which == FIELD_TOLERANCE );
    }
    if ( f->is_unordered )
    {
        out->values[out->count][out->knobs[out->count].value_count++] = 0.0;
    }
    else
    {
        insert_value( out, own, which == FIELD_TOLERANCE );
    }
    ++out->count;
}

wisp_status tune_knobs_find( const wisp_scene* scene, tune_knobs* out, wisp_error* error )
{
    *out = ( tune_knobs ){ 0 };
    if ( !moves( scene ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: nothing in the scene moves in time, so there is nothing to tune", scene->name );
    }
    for ( int which = 0; which < FIELD_COUNT; ++which )
    {
        double own;
        if ( find_own( scene, which, &own ) && ( which != FIELD_ITERATIONS || uses_iterations( scene ) ) )
        {
            add_knob( out, which, own );
        }
    }
    return WISP_OK;
}

void tune_knobs_set( const tune_knobs* knobs, const int* choice, wisp_scene* scene )
{
    for ( int k = 0; k < knobs->count; ++k )
    {
        const int which = knobs->fields[k];
        const double value = knobs->values[k][choice[k]];
        if ( fields[which].place == OF_SCENE )
        {
            *( which == FIELD_SUBSTEPS ? &scene->substeps : &scene->iterations ) = (int)value;
        }
        for ( int i = 0; i < scene->surface_count; ++i )
        {
            if ( has_field( &scene->surfaces[i], which ) )
            {
                set_surface( &scene->surfaces[i], which, value );
            }
        }
    }
}

// ---- the file ----

void tune_knobs_text( const tune_knobs* knobs, int knob, double value, char* out, size_t size )
{
    if ( fields[knobs->fields[knob]].is_switch )
    {
        snprintf( out, size, "%s", value > 0.0 ? "true" : "false" );
    }
    else
    {
        snprintf( out, size, "%.7g", value );
    }
}

static bool has_value( double own, double value )
{
    return (float)own == (float)value;
}

// Room for two edits a knob and place must be there.
static void add_surface_edits( const tune_knobs* knobs, int knob, double value, const wisp_scene* scene,
                               wisp_scene_edit* edits, int* count )
{
    const int which = knobs->fields[knob];
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        const wisp_scene_surface* surface = &scene->surfaces[i];
        if ( !has_field( surface, which ) || has_value( surface_value( surface, which ), value ) )
        {
            continue;
        }
        wisp_scene_edit* edit = &edits[( *count )++];
        *edit = ( wisp_scene_edit ){ "surfaces", i, fields[which].block, fields[which].key, "" };
        tune_knobs_text( knobs, knob, value, edit->value, sizeof edit->value );
        // A file has levels and passes over them, or neither.
        if ( which == FIELD_LEVEL_PASSES && ( value > 0.0 ) != ( surface->levels > 0 ) )
        {
            edit = &edits[( *count )++];
            *edit = ( wisp_scene_edit ){ "surfaces", i, NULL, "levels", "" };
            snprintf( edit->value, sizeof edit->value, "%d", value > 0.0 ? LEVELS : 0 );
        }
    }
}

wisp_status tune_knobs_edits( const tune_knobs* knobs, const int* choice, const wisp_scene* scene,
                              wisp_scene_edit** out, int* count, wisp_error* error )
{
    *count = 0;
    const size_t room = 2 * (size_t)knobs->count * ( (size_t)scene->surface_count + 1 );
    *out = malloc( room * sizeof **out + 1 );
    if ( !*out )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: no memory for the changes", scene->name );
    }
    for ( int k = 0; k < knobs->count; ++k )
    {
        const field* f = &fields[knobs->fields[k]];
        const double value = knobs->values[k][choice[k]];
        double own = value;
        if ( f->place == OF_SCENE && find_own( scene, knobs->fields[k], &own ) && !has_value( own, value ) )
        {
            wisp_scene_edit* edit = &( *out )[( *count )++];
            *edit = ( wisp_scene_edit ){ .key = f->key };
            tune_knobs_text( knobs, k, value, edit->value, sizeof edit->value );
        }
        add_surface_edits( knobs, k, value, scene, *out, count );
    }
    return WISP_OK;
}

bool tune_knobs_agree( const tune_knobs* knobs, const int* choice, const wisp_scene* scene )
{
    wisp_scene_edit* edits;
    int count;
    const bool knows = tune_knobs_edits( knobs, choice, scene, &edits, &count, NULL ) == WISP_OK;
    free( edits );
    return knows && count == 0;
}
