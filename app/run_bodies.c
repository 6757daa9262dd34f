#include "run_bodies.h"

#include "world_from_scene.h"

#include <stdlib.h>
#include <string.h>

const char* const run_value_names[RUN_VALUE_COUNT] = { "strain", "speed" };
static const scene_request value_requests[RUN_VALUE_COUNT] = { SCENE_REQUEST_STRAIN, SCENE_REQUEST_SPEED };

/// Arrays that the entry of a body points to.
typedef struct run_body_data
{
    float* widths;
    wisp_vec3* colours;
    wisp_record_value values[RUN_VALUE_COUNT];
    float* numbers[RUN_VALUE_COUNT]; ///< of the values, in their order
    int requests[RUN_VALUE_COUNT];   ///< which values they are
} run_body_data;

static wisp_status no_memory( const scene_world* world, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its recording", world->scene->name );
}

// ---- points ----

wisp_vec3** run_bodies_make_points( const run_bodies* bodies )
{
    wisp_vec3** points = calloc( (size_t)bodies->count + 1, sizeof *points );
    bool made = points != NULL;
    for ( int i = 0; made && i < bodies->count; ++i )
    {
        points[i] = malloc( ( (size_t)bodies->list[i].vertex_count + 1 ) * sizeof *points[i] );
        made = points[i] != NULL;
    }
    if ( !made )
    {
        run_bodies_free_points( bodies, points );
        return NULL;
    }
    return points;
}

void run_bodies_free_points( const run_bodies* bodies, wisp_vec3** points )
{
    for ( int i = 0; points && i < bodies->count; ++i )
    {
        free( points[i] );
    }
    free( points );
}

static wisp_status request_points( scene_world* world, wisp_error* error )
{
    const int moving = scene_world_moving_count( world );
    wisp_status status = WISP_OK;
    for ( int i = 0; i < moving && status == WISP_OK; ++i )
    {
        status = scene_world_request( world, i, SCENE_REQUEST_POINTS, error );
    }
    return status;
}

// ---- appearance ----

// An appearance replaces the widths and colours of the groom.
static bool dress_strands( const scene_world* world, int strands, const scene_body* body, run_body_data* data )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    const wisp_groom* groom = &world->grooms[strands];
    const size_t count = (size_t)body->vertex_count;
    data->widths = entry->has_appearance || groom->thickness ? malloc( count * sizeof *data->widths + 1 ) : NULL;
    data->colours = entry->has_appearance || groom->colour ? malloc( count * sizeof *data->colours + 1 ) : NULL;
    if ( ( !data->widths && ( entry->has_appearance || groom->thickness ) ) ||
         ( !data->colours && ( entry->has_appearance || groom->colour ) ) )
    {
        return false;
    }
    if ( !entry->has_appearance && groom->thickness )
    {
        memcpy( data->widths, groom->thickness, count * sizeof *data->widths );
    }
    if ( !entry->has_appearance && groom->colour )
    {
        memcpy( data->colours, groom->colour, count * sizeof *data->colours );
    }
    for ( int s = 0; entry->has_appearance && s < body->strand_count; ++s )
    {
        const int first = body->offsets[s], vertices = body->offsets[s + 1] - first;
        for ( int v = 0; v < vertices; ++v )
        {
            const float t = vertices > 1 ? (float)v / (float)( vertices - 1 ) : 0.0f;
            wisp_strand_appearance_at( &entry->appearance, t, &data->widths[first + v], &data->colours[first + v] );
        }
    }
    return true;
}

// ---- values ----

static bool scene_computes( const scene_world* world, int body, scene_request request )
{
    const wisp_scene* scene = world->scene;
    if ( body < scene->strands_count )
    {
        const wisp_scene_strands* entry = &scene->strands[body];
        return request == SCENE_REQUEST_STRAIN ? entry->request_strain : entry->request_speed;
    }
    const wisp_scene_surface* entry = &scene->surfaces[body - scene->strands_count];
    return request == SCENE_REQUEST_STRAIN ? entry->request_strain : entry->request_speed;
}

static wisp_status add_values( scene_world* world, int body, unsigned asked, wisp_record_body* to,
                               run_body_data* data, wisp_error* error )
{
    wisp_status status = WISP_OK;
    to->values = data->values;
    for ( int k = 0; k < RUN_VALUE_COUNT && status == WISP_OK; ++k )
    {
        const bool is_asked = ( asked >> k & 1 ) != 0;
        if ( !scene_world_has( world, body, value_requests[k] ) ||
             !( is_asked || scene_computes( world, body, value_requests[k] ) ) )
        {
            continue;
        }
        status = is_asked ? scene_world_request( world, body, value_requests[k], error ) : WISP_OK;
        float* numbers = calloc( (size_t)to->vertex_count + 1, sizeof *numbers );
        status = status == WISP_OK && !numbers ? no_memory( world, error ) : status;
        data->numbers[to->value_count] = numbers;
        data->requests[to->value_count] = k;
        data->values[to->value_count] = ( wisp_record_value ){ run_value_names[k], numbers };
        ++to->value_count;
    }
    return status;
}

// Something that is asked for and exists nowhere is a mistake.
static wisp_status check_asked( const scene_world* world, unsigned asked, wisp_error* error )
{
    const int moving = scene_world_moving_count( world );
    for ( int k = 0; k < RUN_VALUE_COUNT; ++k )
    {
        bool is_there = ( asked >> k & 1 ) == 0;
        for ( int i = 0; i < moving && !is_there; ++i )
        {
            is_there = scene_world_has( world, i, value_requests[k] );
        }
        if ( !is_there )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "--record-with: %s has no body with %s, which surfaces and strands with dynamics have",
                              world->scene->name, run_value_names[k] );
        }
    }
    return WISP_OK;
}

// ---- all bodies ----

static wisp_record_body entry_of( const scene_body* body, wisp_vec3 colour )
{
    return ( wisp_record_body ){
        .name = body->name,
        .triangles = body->triangles,
        .offsets = body->offsets,
        .vertex_count = body->vertex_count,
        .triangle_count = body->triangle_count,
        .strand_count = body->strand_count,
        .base_colour = colour,
        .triangles_change = body->tears,
    };
}

static bool is_static( const scene_world* world, int body )
{
    const int collider = body - scene_world_moving_count( world );
    return collider >= 0 && world->scene->colliders[collider].path.count == 0;
}

static wisp_status add_appearance( const scene_world* world, int number, const scene_body* body, wisp_record_body* to,
                                   run_body_data* data, wisp_error* error )
{
    to->is_static = is_static( world, number );
    if ( body->kind == SCENE_BODY_STRANDS && !dress_strands( world, number, body, data ) )
    {
        return no_memory( world, error );
    }
    to->widths = data->widths;
    to->colours = data->colours;
    return WISP_OK;
}

static wisp_status list_bodies( scene_world* world, bool has_values, unsigned asked, run_bodies* out,
                                wisp_error* error )
{
    int cloths = 0, balloons = 0;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < scene_world_body_count( world ) && status == WISP_OK; ++i )
    {
        const scene_body body = scene_world_body( world, i );
        if ( body.kind == SCENE_BODY_PLANE )
        {
            continue;
        }
        wisp_record_body* to = &out->list[out->count];
        const scene_body_kind drawn = body.is_led ? SCENE_BODY_COLLIDER : body.kind;
        *to = entry_of( &body, scene_body_colour( drawn, &cloths, &balloons ) );
        out->numbers[out->count] = i;
        run_body_data* data = &out->data[out->count++];
        status = add_appearance( world, i, &body, to, data, error );
        if ( status == WISP_OK && has_values && i < scene_world_moving_count( world ) )
        {
            status = add_values( world, i, asked, to, data, error );
        }
    }
    return status;
}

wisp_status run_bodies_open( scene_world* world, bool has_values, unsigned asked, run_bodies* out, wisp_error* error )
{
    const size_t all = (size_t)scene_world_body_count( world );
    *out = ( run_bodies ){ 0 };
    out->numbers = calloc( all + 1, sizeof *out->numbers );
    out->list = calloc( all + 1, sizeof *out->list );
    out->data = calloc( all + 1, sizeof *out->data );
    if ( !out->numbers || !out->list || !out->data )
    {
        return no_memory( world, error );
    }
    wisp_status status = check_asked( world, asked, error );
    status = status == WISP_OK ? list_bodies( world, has_values, asked, out, error ) : status;
    if ( status == WISP_OK )
    {
        out->points = run_bodies_make_points( out );
        status = out->points ? request_points( world, error ) : no_memory( world, error );
    }
    return status;
}

wisp_status run_bodies_load( const run_bodies* bodies, const scene_world* world, bool with_values, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < bodies->count && status == WISP_OK; ++i )
    {
        const run_body_data* data = &bodies->data[i];
        status = scene_world_points( world, bodies->numbers[i], bodies->points[i], error );
        for ( int k = 0; k < bodies->list[i].value_count && status == WISP_OK && with_values; ++k )
        {
            status = scene_world_numbers( world, bodies->numbers[i], value_requests[data->requests[k]],
                                          data->numbers[k], error );
        }
    }
    return status;
}

void run_bodies_release( run_bodies* bodies )
{
    run_bodies_free_points( bodies, bodies->points );
    for ( int i = 0; i < bodies->count; ++i )
    {
        free( bodies->data[i].widths );
        free( bodies->data[i].colours );
        for ( int k = 0; k < RUN_VALUE_COUNT; ++k )
        {
            free( bodies->data[i].numbers[k] );
        }
    }
    free( bodies->data );
    free( bodies->list );
    free( bodies->numbers );
    *bodies = ( run_bodies ){ 0 };
}
