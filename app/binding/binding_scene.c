// Scenes: their text, what was read of it, and the parameters that may change.
#include "binding_internal.h"

#include "io_file.h"
#include "scene_text.h"
#include "text_tree.h"
#include "tune_parameters.h"
#include "tune_scene.h"

#include <stdlib.h>
#include <string.h>

#define TEXT_MAX ( (size_t)1 << 30 ) // the reader of scenes has a lower limit of its own

// ---- arrays ----

static void* copy_block( const void* from, size_t size )
{
    void* copy = from ? malloc( size + 1 ) : NULL;
    return copy ? memcpy( copy, from, size ) : NULL;
}

static void release_arrays( binding_scene* s )
{
    for ( int i = 0; s->arrays && i < s->array_count; ++i )
    {
        wisp_scene_arrays* a = &s->arrays[i];
        free( (void*)(uintptr_t)a->file );
        free( (void*)(uintptr_t)a->points );
        free( (void*)(uintptr_t)a->triangles );
        free( (void*)(uintptr_t)a->offsets );
    }
    free( s->arrays );
}

static bool copy_arrays( binding_scene* s, const wisp_scene_arrays* arrays, int count )
{
    s->arrays = calloc( (size_t)count + 1, sizeof *s->arrays );
    for ( int i = 0; s->arrays && i < count; ++i )
    {
        const wisp_scene_arrays* from = &arrays[i];
        wisp_scene_arrays* to = &s->arrays[s->array_count++];
        *to = *from;
        to->file = copy_block( from->file, strlen( from->file ) + 1 );
        to->points = copy_block( from->points, (size_t)from->point_count * sizeof *from->points );
        to->triangles = copy_block( from->triangles, 3 * (size_t)from->triangle_count * sizeof *from->triangles );
        to->offsets = copy_block( from->offsets, ( (size_t)from->strand_count + 1 ) * sizeof *from->offsets );
        if ( !to->file || !to->points || ( from->triangles && !to->triangles ) || ( from->offsets && !to->offsets ) )
        {
            return false;
        }
    }
    return s->arrays != NULL;
}

// ---- life ----

void binding_scene_close( binding_scene* s )
{
    if ( s )
    {
        wisp_scene_release( &s->scene );
        release_arrays( s );
        free( s->text );
        free( s->name );
        free( s );
    }
}

wisp_status binding_scene_again( const binding_scene* s, wisp_scene* out, wisp_error* error )
{
    wisp_status status = wisp_scene_parse( s->text, s->size, s->name, out, error );
    if ( status == WISP_OK && wisp_scene_set_arrays( out, s->arrays, s->array_count, error ) != WISP_OK )
    {
        status = error->status;
        wisp_scene_release( out );
    }
    return status;
}

wisp_status binding_scene_parse( const char* text, size_t size, const char* name, const wisp_scene_arrays* arrays,
                                 int array_count, binding_scene** out, wisp_error* error )
{
    *out = NULL;
    binding_scene* s = calloc( 1, sizeof *s );
    bool is_there = s != NULL;
    if ( is_there )
    {
        s->size = size;
        s->text = malloc( size + 1 );
        s->name = copy_block( name, strlen( name ) + 1 );
        is_there = s->text && s->name && copy_arrays( s, arrays, array_count );
    }
    if ( !is_there )
    {
        binding_scene_close( s );
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for the scene", io_short_name( name ) );
    }
    memcpy( s->text, text, size );
    s->text[size] = '\0';
    const wisp_status status = binding_scene_again( s, &s->scene, error );
    if ( status != WISP_OK )
    {
        binding_scene_close( s );
        return status;
    }
    wisp_error nothing_moves;
    if ( tune_parameters_find( &s->scene, &s->parameters, &nothing_moves ) != WISP_OK )
    {
        s->parameters.count = 0;
    }
    *out = s;
    return WISP_OK;
}

wisp_status binding_scene_read( const char* path, binding_scene** out, wisp_error* error )
{
    *out = NULL;
    unsigned char* bytes = NULL;
    size_t size = 0;
    wisp_status status = io_file_read( path, TEXT_MAX, &bytes, &size, error );
    if ( status == WISP_OK )
    {
        status = binding_scene_parse( bytes ? (const char*)bytes : "", size, path, NULL, 0, out, error );
    }
    free( bytes );
    return status;
}

const char* binding_scene_text( const binding_scene* s, size_t* size )
{
    *size = s->size;
    return s->text;
}

double binding_scene_dt( const binding_scene* s )
{
    return (double)s->scene.dt;
}

int binding_scene_steps( const binding_scene* s )
{
    return s->scene.steps;
}

void binding_scene_gravity( const binding_scene* s, float* out )
{
    out[0] = s->scene.gravity.x;
    out[1] = s->scene.gravity.y;
    out[2] = s->scene.gravity.z;
}

// ---- parameters ----

int binding_parameter_count( const binding_scene* s )
{
    return s->parameters.count;
}

const char* binding_parameter_name( const binding_scene* s, int parameter )
{
    return s->parameters.parameters[parameter].name;
}

bool binding_parameter_is_unordered( const binding_scene* s, int parameter )
{
    return s->parameters.parameters[parameter].is_unordered;
}

int binding_parameter_values( const binding_scene* s, int parameter, double* out )
{
    const tune_parameter* p = &s->parameters.parameters[parameter];
    memcpy( out, p->values, (size_t)p->value_count * sizeof *out );
    return p->value_count;
}

double binding_parameter_value( const binding_scene* s, int parameter )
{
    double own = 0.0;
    tune_field_own( &s->scene, s->parameters.fields[parameter], &own );
    return own;
}

static wisp_status set_fields( const char* name, const char* fields, char** text, size_t* size, wisp_error* error )
{
    text_node *scene = NULL, *values = NULL;
    wisp_status status = text_parse( fields, strlen( fields ), name, &values, error );
    status = status == WISP_OK ? text_parse( *text, *size, name, &scene, error ) : status;
    for ( int i = 0; status == WISP_OK && i < values->count; ++i )
    {
        const char* path = values->children[i]->key;
        status = text_set_path( scene, path, values->children[i] ) > 0
                     ? WISP_OK
                     : wisp_fail( error, WISP_BAD_INPUT,
                                  "%s: '%s' names nothing of the scene, such as surfaces[0].cloth.bending", name,
                                  scene_shorten( path ).text );
    }
    free( *text );
    *text = status == WISP_OK ? text_write( scene, NULL ) : NULL;
    *size = *text ? strlen( *text ) : 0;
    text_release( scene );
    text_release( values );
    return status;
}

wisp_status binding_scene_edit( const binding_scene* s, const double* values, const char* fields, char** out,
                                size_t* size, wisp_error* error )
{
    const int first[TUNE_MAX_PARAMETERS] = { 0 };
    tune_parameters changed = s->parameters;
    for ( int k = 0; k < changed.count; ++k )
    {
        changed.values[k][0] = values[k];
    }
    const wisp_status status = tune_parameters_edit( &changed, first, &s->scene, s->text, s->size, out, size, error );
    return status == WISP_OK && fields ? set_fields( s->name, fields, out, size, error ) : status;
}

wisp_status binding_scene_edit_file( const binding_scene* s, const char* from, const int* configuration,
                                     const char* to, wisp_error* error )
{
    return tune_parameters_write( &s->parameters, configuration, &s->scene, from, to, error );
}

void binding_free( void* block )
{
    free( block );
}

// ---- what accuracy costs ----

struct binding_reference
{
    const binding_scene* scene;
    suite_observer observer;
    bool ( *go_on )( void );
    tune_scene from;
};

static wisp_status observe( void* user, const scene_world* world, wisp_error* error )
{
    const binding_reference* r = user;
    return r->go_on == NULL || r->go_on() ? WISP_OK
                                          : wisp_fail( error, WISP_CONFLICT, "%s: a run was ended after step %d",
                                                       r->scene->name, world->next_step );
}

static suite_given given_of( const binding_scene* s )
{
    return ( suite_given ){ s->text, s->size, s->arrays, s->array_count };
}

void binding_reference_close( binding_reference* r )
{
    if ( r )
    {
        tune_scene_close( &r->from );
        free( r );
    }
}

wisp_status binding_reference_open( const binding_scene* scene, double length, bool ( *go_on )( void ),
                                    wisp_log_fn* log, binding_reference** out, binding_reference_info* info,
                                    wisp_error* error )
{
    *out = NULL;
    binding_reference* r = calloc( 1, sizeof *r );
    if ( r == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its reference", scene->name );
    }
    *r = ( binding_reference ){ .scene = scene, .observer = { .observe = observe, .user = r }, .go_on = go_on };
    const tune_scene_def def = {
        .path = scene->name, .given = given_of( scene ), .length = length, .observer = &r->observer, .log = log
    };
    tune_parameters parameters;
    wisp_status status = tune_parameters_find( &scene->scene, &parameters, error );
    status = status == WISP_OK ? tune_scene_open( &def, &r->from, error ) : status;
    if ( status != WISP_OK )
    {
        binding_reference_close( r );
        return status;
    }
    const suite_reference* made = r->from.reference;
    *info = ( binding_reference_info ){ made->doubt.distance, made->until, suite_reference_parts( made ) };
    *out = r;
    return WISP_OK;
}

wisp_status binding_reference_measure( const binding_reference* r, const binding_scene* scene, int workers,
                                       const char* isa, tune_sample* out, wisp_error* error )
{
    const suite_given given = given_of( scene );
    const tune_machine machine = { workers, isa };
    suite_measurement measured = { .steps = 0 };
    const wisp_status status = tune_scene_run( &r->from, &given, &machine, &measured, out, error );
    return status == WISP_OK && out->is_halted
               ? wisp_fail( error, WISP_CONFLICT, "%s: an entity was halted, and has no error to speak of",
                            scene->name )
               : status;
}

wisp_status binding_tune( const binding_reference* r, const binding_tune_def* def, tune_result* out,
                          wisp_error* error )
{
    const tune_scene_search_def search = {
        .scene = &r->scene->scene,
        .parameters = &r->scene->parameters,
        .error = def->error,
        .budget_ms = def->budget_ms,
        .limit = def->limit,
        .machine = { def->workers, def->isa },
        .progress = def->progress,
        .progress_user = def->user,
    };
    suite_measurement last;
    *out = ( tune_result ){ 0 };
    return tune_scene_search( &r->from, &search, &last, out, error );
}
