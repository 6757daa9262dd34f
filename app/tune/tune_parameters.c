#include "tune_parameters.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- fields ----

// Keys that `wisp tune` may change. A key is listed only if its last value is that of the reference run, and if it
// does not change the material. For strands this excludes (measured with
// `wisp bench data/suites/accuracy/strands_swing.yaml`):
//
// - `stretch`: links with a compliance are another strand, and without one they reach the error of the direct solve in
//   no less time.
// - `stretch_tolerance`: decides which strands are reset; a smaller one resets more of them, which is no nearer to the reference.
// - the grid's cell and friction: a smaller cell is friction with fewer neighbours.
// - counts of strands and vertices, and ghosts: the compared points must be as many as those of the reference.
//
// Rods have nothing to tune: bending is one direct solve per substep.

static const char* const LEVELS[] = { "exact", "triangles", "spheres" };

#define IN_SURFACE( member ) offsetof( wisp_scene_surface, member )

const tune_field tune_fields[FIELD_COUNT] = {
    [FIELD_SUBSTEPS] = { "substeps", NULL, NULL, "substeps", OF_SCENE, offsetof( wisp_scene, substeps ),
                         .candidates = { 1, 2, 4, 8, 16 } },
    [FIELD_ITERATIONS] = { "iterations", NULL, NULL, "iterations", OF_SCENE, offsetof( wisp_scene, iterations ),
                           .candidates = { 1, 2, 4 } },
    [FIELD_TETHERS] = { "cloth.tethers", "surfaces", "cloth", "tethers", OF_PINNED_CLOTH, IN_SURFACE( cloth.tethers ),
                        .is_switch = true, .is_unordered = true, .candidates = { 1 } },
    [FIELD_COARSE] = { "cloth.coarse_substeps", "surfaces", "cloth", "coarse_substeps", OF_XPBD_CLOTH,
                       IN_SURFACE( cloth.coarse_substeps ), .is_unordered = true, .candidates = { 1, 2 } },
    [FIELD_TOLERANCE] = { "implicit.tolerance", "surfaces", "implicit", "tolerance", OF_IMPLICIT,
                          IN_SURFACE( implicit.tolerance ), .is_fraction = true, .is_falling = true,
                          .candidates = { 1e-1, 1e-2, 1e-3, 1e-4 } },
    [FIELD_REPEATS] = { "implicit.newton_iterations", "surfaces", "implicit", "newton_iterations", OF_IMPLICIT,
                        IN_SURFACE( implicit.newton_iterations ), .candidates = { 1, 2, 4 } },
    [FIELD_PASSES] = { "dynamics.stretch_passes", "strands", "dynamics", "stretch_passes", OF_DIRECT_STRANDS,
                       offsetof( wisp_scene_strands, dynamics.stretch_passes ), .candidates = { 1, 2, 8 } },
    [FIELD_LEVEL] = { "contact.level", NULL, "contact", "level", OF_CONTACT, offsetof( wisp_scene, contact.level ),
                      .is_unordered = true, .candidates = { 1, 2 }, .words = LEVELS },
};

// ---- what a scene has ----

// Length of the list that contains a field's entries; the scene itself is one entry.
static int field_entries( const wisp_scene* scene, int which )
{
    const tune_place place = tune_fields[which].place;
    return place == OF_SCENE || place == OF_CONTACT ? 1
           : place == OF_DIRECT_STRANDS             ? scene->strands_count
                                                    : scene->surface_count;
}

// An instance shares the fabric of its source, including the anchors of tethers.
static const wisp_scene_surface* fabric_of( const wisp_scene* scene, const wisp_scene_surface* surface )
{
    return surface->instance_of < 0 ? surface : &scene->surfaces[surface->instance_of];
}

// Tethers reach to the pins of the source, and hold where the instance is pinned.
static bool may_have_tethers( const wisp_scene* scene, const wisp_scene_surface* surface )
{
    return surface->has_cloth && wisp_scene_has_pins( surface ) && wisp_scene_has_pins( fabric_of( scene, surface ) );
}

static bool is_direct( const wisp_scene_strands* strands )
{
    return strands->has_dynamics && strands->dynamics.stretch == WISP_STRAND_STRETCH_DIRECT;
}

static bool has_contact( const wisp_scene* scene )
{
    bool has = false;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        has = has || scene->surfaces[i].has_contact;
    }
    return has;
}

// Whether an entry of the list has the field.
static bool field_is_in( const wisp_scene* scene, int which, int entry )
{
    switch ( tune_fields[which].place )
    {
        case OF_XPBD_CLOTH:
            return scene->surfaces[entry].has_cloth && !scene->surfaces[entry].has_membrane &&
                   scene->surfaces[entry].cloth.solver == WISP_SOLVER_XPBD;
        case OF_PINNED_CLOTH:
            return may_have_tethers( scene, &scene->surfaces[entry] );
        case OF_IMPLICIT:
            return scene->surfaces[entry].has_implicit;
        case OF_DIRECT_STRANDS:
            return is_direct( &scene->strands[entry] );
        case OF_CONTACT:
            return has_contact( scene );
        case OF_SCENE:
            break;
    }
    return true;
}

static const void* field_at( const wisp_scene* scene, int which, int entry )
{
    const tune_place place = tune_fields[which].place;
    const void* base = place == OF_SCENE || place == OF_CONTACT ? (const void*)scene
                       : place == OF_DIRECT_STRANDS             ? (const void*)&scene->strands[entry]
                                                                : (const void*)&scene->surfaces[entry];
    return (const char*)base + tune_fields[which].offset;
}

// Automatic coarse sheets, -1, count as 1, so that 1 leaves them as they are.
static double own_value( const wisp_scene* scene, int which, int entry )
{
    const void* at = field_at( scene, which, entry );
    const tune_field* f = &tune_fields[which];
    return f->is_fraction ? (double)*(const float*)at : f->is_switch ? *(const bool*)at : abs( *(const int*)at );
}

static void set_field( wisp_scene* scene, int which, int entry, double value )
{
    const float fraction = (float)value;
    const bool is_on = value > 0.0;
    const int whole = (int)value;
    const tune_field* f = &tune_fields[which];
    memcpy( (void*)(uintptr_t)field_at( scene, which, entry ),
            f->is_fraction ? (const void*)&fraction
            : f->is_switch ? (const void*)&is_on
                           : (const void*)&whole,
            f->is_fraction ? sizeof fraction
            : f->is_switch ? sizeof is_on
                           : sizeof whole );
}

bool tune_field_own( const wisp_scene* scene, int which, double* out )
{
    for ( int i = 0; i < field_entries( scene, which ); ++i )
    {
        if ( field_is_in( scene, which, i ) )
        {
            *out = own_value( scene, which, i );
            return true;
        }
    }
    return false;
}

// ---- parameters ----

_Static_assert( (int)FIELD_COUNT <= TUNE_MAX_PARAMETERS, "a scene may have all of them" );
_Static_assert( (int)FIELD_COUNT <= 8 && 3 * 3 * 3 * 3 * 3 * 3 * 2 * 2 <= TUNE_MAX_SETTINGS,
                "three values of most can be searched" );

// ---- parameters of a scene ----

// Implicit cloth has its own loop: the scene's iterations change it only if something else is solved with it.
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

// Ascending, except for fields that become finer as they fall. Compared as floats, because the scene's own value came
// from one.
static void insert_value( tune_parameters* out, double value, bool is_falling )
{
    tune_parameter* parameter = &out->parameters[out->count];
    double* values = out->values[out->count];
    int place = parameter->value_count;
    while ( place > 0 && ( is_falling ? values[place - 1] < value : values[place - 1] > value ) )
    {
        --place;
    }
    if ( place > 0 && (float)values[place - 1] == (float)value )
    {
        return;
    }
    // A float slightly below its decimal sorts after it.
    if ( place < parameter->value_count && (float)values[place] == (float)value )
    {
        return;
    }
    memmove( values + place + 1, values + place, (size_t)( parameter->value_count - place ) * sizeof *values );
    values[place] = value;
    ++parameter->value_count;
}

static void add_parameter( tune_parameters* out, int which, double own )
{
    const tune_field* f = &tune_fields[which];
    out->fields[out->count] = which;
    out->parameters[out->count] =
        ( tune_parameter ){ .name = f->name, .values = out->values[out->count], .is_unordered = f->is_unordered };
    for ( int i = 0; i < TUNE_CANDIDATES_MAX && f->candidates[i] > 0.0; ++i )
    {
        insert_value( out, f->candidates[i], f->is_falling );
    }
    if ( own > 0.0 )
    {
        insert_value( out, own, f->is_falling );
    }
    if ( f->is_unordered )
    {
        out->values[out->count][out->parameters[out->count].value_count++] = 0.0;
    }
    ++out->count;
}

// ---- a scene of everything ----

static int setting_count( const tune_parameters* parameters )
{
    int count = 1;
    for ( int k = 0; k < parameters->count; ++k )
    {
        count *= parameters->parameters[k].value_count;
    }
    return count;
}

// The coarsest value between both ends that is not the scene's own is removed.
static void drop_value( const wisp_scene* scene, tune_parameters* parameters, int k )
{
    double own = 0.0;
    tune_field_own( scene, parameters->fields[k], &own );
    double* values = parameters->values[k];
    const int place = (float)values[1] == (float)own ? 2 : 1;
    const int behind = --parameters->parameters[k].value_count - place;
    memmove( values + place, values + place + 1, (size_t)behind * sizeof *values );
}

// Few scenes have all parameters; theirs may give more settings than can be searched. The longest lists lose values
// until there are few enough, which three of most are.
static void thin_out( const wisp_scene* scene, tune_parameters* parameters )
{
    while ( setting_count( parameters ) > TUNE_MAX_SETTINGS )
    {
        int longest = 0;
        for ( int k = 1; k < parameters->count; ++k )
        {
            longest =
                parameters->parameters[k].value_count > parameters->parameters[longest].value_count ? k : longest;
        }
        drop_value( scene, parameters, longest );
    }
}

wisp_status tune_parameters_find( const wisp_scene* scene, tune_parameters* out, wisp_error* error )
{
    *out = ( tune_parameters ){ 0 };
    if ( !moves( scene ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: nothing in the scene moves, so there is nothing to tune",
                          scene->name );
    }
    for ( int which = 0; which < FIELD_COUNT; ++which )
    {
        double own;
        if ( tune_field_own( scene, which, &own ) && ( which != FIELD_ITERATIONS || uses_iterations( scene ) ) )
        {
            add_parameter( out, which, own );
        }
    }
    thin_out( scene, out );
    return WISP_OK;
}

void tune_parameters_set( const tune_parameters* parameters, const int* configuration, wisp_scene* scene )
{
    for ( int k = 0; k < parameters->count; ++k )
    {
        const int which = parameters->fields[k];
        for ( int i = 0; i < field_entries( scene, which ); ++i )
        {
            const double value = parameters->values[k][configuration[k]];
            if ( field_is_in( scene, which, i ) && own_value( scene, which, i ) != value )
            {
                set_field( scene, which, i, value );
                scene->has_contact = scene->has_contact || which == FIELD_LEVEL;
            }
        }
    }
}

// ---- the file ----

void tune_parameters_text( int field, double value, char* out, size_t size )
{
    if ( tune_fields[field].words )
    {
        snprintf( out, size, "%s", tune_fields[field].words[(int)value] );
    }
    else if ( tune_fields[field].is_switch )
    {
        snprintf( out, size, "%s", value > 0.0 ? "true" : "false" );
    }
    else
    {
        snprintf( out, size, "%.7g", value );
    }
}

/// A change to make.
typedef struct edit_list
{
    wisp_scene_edit* edits; // room for one an entry and parameter
    int count;
} edit_list;

// @return the edit, which takes its key out as long as it has no value
static wisp_scene_edit* add_edit( edit_list* list, int which, int entry )
{
    const tune_field* f = &tune_fields[which];
    wisp_scene_edit* edit = &list->edits[list->count++];
    *edit = ( wisp_scene_edit ){ .list = f->list, .index = entry, .block = f->block, .key = f->key };
    return edit;
}

static void add_edits( const tune_parameters* parameters, int parameter, double value, const wisp_scene* scene,
                       edit_list* list )
{
    const int which = parameters->fields[parameter];
    for ( int i = 0; i < field_entries( scene, which ); ++i )
    {
        if ( field_is_in( scene, which, i ) && (float)own_value( scene, which, i ) != (float)value )
        {
            wisp_scene_edit* edit = add_edit( list, which, i );
            tune_parameters_text( which, value, edit->value, sizeof edit->value );
            if ( which == FIELD_LEVEL && scene->has_contact == false )
            {
                snprintf( edit->value, sizeof edit->value, "{ level: %s }", LEVELS[(int)value] );
                edit->block = NULL; // there is none yet
                edit->key = "contact";
            }
        }
    }
}

wisp_status tune_parameters_edits( const tune_parameters* parameters, const int* configuration,
                                   const wisp_scene* scene, wisp_scene_edit** out, int* count, wisp_error* error )
{
    const size_t entries = (size_t)scene->surface_count + (size_t)scene->strands_count + 1;
    edit_list list = { .edits = malloc( ( entries * (size_t)parameters->count + 1 ) * sizeof *list.edits ) };
    *out = list.edits;
    *count = 0;
    if ( !list.edits )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for the changes", scene->name );
    }
    for ( int k = 0; k < parameters->count; ++k )
    {
        add_edits( parameters, k, parameters->values[k][configuration[k]], scene, &list );
    }
    *count = list.count;
    return WISP_OK;
}

wisp_status tune_parameters_write( const tune_parameters* parameters, const int* configuration,
                                   const wisp_scene* scene, const char* from, const char* to, wisp_error* error )
{
    wisp_scene_edit* edits;
    int count;
    wisp_status status = tune_parameters_edits( parameters, configuration, scene, &edits, &count, error );
    status = status == WISP_OK ? wisp_scene_edit_file( from, edits, count, to, error ) : status;
    free( edits );
    return status;
}

wisp_status tune_parameters_edit( const tune_parameters* parameters, const int* configuration,
                                  const wisp_scene* scene, const char* text, size_t text_size, char** out,
                                  size_t* size, wisp_error* error )
{
    wisp_scene_edit* edits;
    int count;
    *out = NULL;
    wisp_status status = tune_parameters_edits( parameters, configuration, scene, &edits, &count, error );
    status = status == WISP_OK ? wisp_scene_edit_text( text, text_size, scene->name, edits, count, out, size, error )
                               : status;
    free( edits );
    return status;
}

bool tune_parameters_agree( const tune_parameters* parameters, const int* configuration, const wisp_scene* scene )
{
    wisp_scene_edit* edits;
    int count;
    const bool knows = tune_parameters_edits( parameters, configuration, scene, &edits, &count, NULL ) == WISP_OK;
    free( edits );
    return knows && count == 0;
}
