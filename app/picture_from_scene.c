// A scene is simulated up to the requested frame; frame 0 is the start, frame n follows step n.
#include "picture_source.h"

#include "interruption.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <string.h>

typedef struct simulation
{
    wisp_scene scene;
    scene_world world;
    scene_world_options options;
    bool has_world;
    bool shows_layers; ///< boundary particles or their normals are drawn
} simulation;

static bool has_appearance( const simulation* s, int body )
{
    return body < s->scene.strands_count && s->scene.strands[body].has_appearance;
}

static bool has_map( const simulation* s, int body )
{
    const int surface = body - s->scene.strands_count;
    return surface >= 0 && surface < s->scene.surface_count && s->scene.surfaces[surface].map_count > 0;
}

// Guides, whose ghosts or curves are shown instead.
static bool is_hidden( const simulation* s, int body )
{
    return body < s->scene.strands_count && !s->scene.strands[body].is_shown;
}

// ---- the world ----

static scene_request request_of( picture_value value )
{
    return value == PICTURE_STRAIN ? SCENE_REQUEST_STRAIN : SCENE_REQUEST_SPEED;
}

static wisp_status request_all( const picture_source* source, simulation* s, wisp_error* error )
{
    int moving = scene_world_moving_count( &s->world );
    for ( int i = 0; i < moving; ++i )
    {
        if ( is_hidden( s, i ) )
        {
            continue;
        }
        WISP_TRY( scene_world_request( &s->world, i, SCENE_REQUEST_POINTS, error ) );
        if ( source->bodies[i].values && source->value != PICTURE_MAP )
        {
            WISP_TRY( scene_world_request( &s->world, i, request_of( source->value ), error ) );
        }
        if ( has_appearance( s, i ) )
        {
            WISP_TRY( scene_world_request( &s->world, i, SCENE_REQUEST_WIDTH, error ) );
            WISP_TRY( scene_world_request( &s->world, i, SCENE_REQUEST_COLOUR, error ) );
        }
    }
    return WISP_OK;
}

static wisp_status start_world( simulation* s, wisp_error* error )
{
    if ( s->has_world )
    {
        scene_world_destroy( &s->world );
    }
    wisp_status status = scene_world_create( &s->scene, &s->options, &s->world, error );
    s->has_world = status == WISP_OK;
    return status;
}

// ---- boundary particles ----

static const wisp_boundary_def* layer_of( const simulation* s, int body )
{
    const int surface = body - s->scene.strands_count;
    const bool has_layer = s->shows_layers && surface >= 0 && surface < s->scene.surface_count &&
                           s->scene.surfaces[surface].has_boundary;
    return has_layer ? &s->scene.surfaces[surface].boundary : NULL;
}

// The radius of the balls. A missing spacing is half of the mean edge of the initial mesh; edges of two triangles
// count twice here, which is accurate enough for a picture.
static float layer_spacing( const simulation* s, int body, const wisp_boundary_def* def )
{
    const scene_body from = scene_world_body( &s->world, body );
    const wisp_vec3* points = s->world.surfaces[body - s->scene.strands_count].mesh.points;
    double sum = 0.0;
    for ( int t = 0; t < from.triangle_count; ++t )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const wisp_vec3 a = points[from.triangles[3 * t + k]], b = points[from.triangles[3 * t + ( k + 1 ) % 3]];
            sum += sqrt( (double)( ( b.x - a.x ) * ( b.x - a.x ) + ( b.y - a.y ) * ( b.y - a.y ) +
                                   ( b.z - a.z ) * ( b.z - a.z ) ) );
        }
    }
    const float half_edge = from.triangle_count > 0 ? (float)( sum / ( 6.0 * from.triangle_count ) ) : 0.0f;
    return def->spacing > 0.0f ? def->spacing : fmaxf( half_edge, 1e-6f );
}

// Before the first step there are none.
static wisp_status read_layer( picture_source* source, simulation* s, int body, wisp_error* error )
{
    picture_layer* layer = &source->bodies[body].layer;
    layer->count = 0;
    if ( layer->spacing == 0.0f )
    {
        return WISP_OK;
    }
    wisp_boundary_view view;
    WISP_TRY( scene_world_layer( &s->world, body - s->scene.strands_count, &view, error ) );
    WISP_TRY( picture_make_layer( source, body, view.samples->count, error ) );
    WISP_ASSERT( view.samples->normals || view.samples->count == 0 );
    for ( int i = 0; i < view.samples->count; ++i )
    {
        const float* p = view.samples->xyzw + 4 * (size_t)i;
        const float* n = view.samples->normals + 4 * (size_t)i;
        layer->points[i] = ( wisp_vec3 ){ p[0], p[1], p[2] };
        layer->normals[i] = ( wisp_vec3 ){ n[0], n[1], n[2] };
    }
    layer->count = view.samples->count;
    layer->edge_count = view.samples->edge_count;
    return WISP_OK;
}

// ---- frames ----

static wisp_status read_body( picture_source* source, simulation* s, int body, wisp_error* error )
{
    picture_body* b = &source->bodies[body];
    WISP_TRY( scene_world_points( &s->world, body, b->points, error ) );
    if ( b->values && source->value != PICTURE_MAP )
    {
        WISP_TRY( scene_world_numbers( &s->world, body, request_of( source->value ), b->values, error ) );
    }
    // Width and colour are not computed before the first step; the bodies keep their own.
    if ( has_appearance( s, body ) && s->world.next_step > 0 )
    {
        WISP_TRY( scene_world_numbers( &s->world, body, SCENE_REQUEST_WIDTH, b->widths, error ) );
        WISP_TRY( scene_world_colours( &s->world, body, b->colours, error ) );
    }
    return read_layer( source, s, body, error );
}

static wisp_status step_to( picture_source* source, simulation* s, int frame, wisp_error* error )
{
    const int first = s->world.next_step;
    while ( s->world.next_step < frame )
    {
        WISP_TRY( interruption_check( error ) );
        WISP_TRY( scene_world_step( &s->world, error ) );
        if ( source->bar )
        {
            progress_show( source->bar, (double)( s->world.next_step - first ) / ( frame - first ), "steps" );
        }
    }
    return WISP_OK;
}

// Names, triangles and offsets belonged to the previous world; those of the new one have the same content.
static wisp_status start_again( picture_source* source, simulation* s, wisp_error* error )
{
    WISP_TRY( start_world( s, error ) );
    for ( int i = 0; i < source->body_count; ++i )
    {
        scene_body body = scene_world_body( &s->world, i );
        source->bodies[i].name = body.name;
        source->bodies[i].triangles = body.triangles;
        source->bodies[i].offsets = body.offsets;
    }
    return request_all( source, s, error );
}

static wisp_status load_simulated( picture_source* source, int frame, wisp_error* error )
{
    simulation* s = source->state;
    // A restart that failed left no world behind.
    WISP_TRY( !s->has_world || s->world.next_step > frame ? start_again( source, s, error ) : WISP_OK );
    WISP_TRY( step_to( source, s, frame, error ) );
    for ( int i = 0; i < source->body_count; ++i )
    {
        WISP_TRY( is_hidden( s, i ) ? WISP_OK : read_body( source, s, i, error ) );
    }
    return WISP_OK;
}

static wisp_status time_of_step( picture_source* source, int frame, double* seconds, wisp_error* error )
{
    (void)error;
    *seconds = frame * source->step;
    return WISP_OK;
}

static void close_scene( picture_source* source )
{
    simulation* s = source->state;
    if ( s->has_world )
    {
        scene_world_destroy( &s->world );
    }
    wisp_scene_release( &s->scene );
}

static const picture_input scene_input = { load_simulated, time_of_step, close_scene };

// ---- bodies ----

// Strands without an appearance keep the widths and colours of their groom.
static void give_looks( picture_source* source, const simulation* s, int body, picture_body* b )
{
    const wisp_groom* groom = &s->world.grooms[body];
    const size_t widths = (size_t)b->vertex_count * sizeof *b->widths;
    const size_t colours = (size_t)b->vertex_count * sizeof *b->colours;
    b->widths = io_copy( &source->memory, groom->thickness, widths );
    b->colours = io_copy( &source->memory, groom->colour, colours );
    if ( has_appearance( s, body ) )
    {
        b->widths = b->widths ? b->widths : io_get( &source->memory, widths );
        b->colours = b->colours ? b->colours : io_get( &source->memory, colours );
    }
}

static wisp_status add_picture_body( picture_source* source, simulation* s, int body, wisp_error* error )
{
    scene_body from = scene_world_body( &s->world, body );
    picture_body* to = &source->bodies[body];
    if ( is_hidden( s, body ) )
    {
        *to = ( picture_body ){ .name = from.name, .kind = from.kind, .offsets = from.offsets };
        return picture_make_points( source, body, false, error );
    }
    *to = ( picture_body ){
        .name = from.name,
        .kind = from.is_led ? SCENE_BODY_COLLIDER : from.kind,
        .is_led = from.is_led,
        .vertex_count = from.vertex_count,
        .triangles = from.triangles,
        .triangle_count = from.triangle_count,
        .offsets = from.offsets,
        .strand_count = from.strand_count,
    };
    const bool has_values =
        source->value == PICTURE_MAP ? has_map( s, body ) : source->value != PICTURE_BODY && picture_is_surface( to );
    WISP_TRY( picture_make_points( source, body, has_values, error ) );
    if ( has_values && source->value == PICTURE_MAP )
    {
        WISP_TRY( scene_world_map( &s->world, body - s->scene.strands_count, to->values, error ) );
    }
    if ( from.kind == SCENE_BODY_STRANDS )
    {
        give_looks( source, s, body, to );
    }
    const wisp_boundary_def* layer = layer_of( s, body );
    to->layer.spacing = layer ? layer_spacing( s, body, layer ) : 0.0f;
    return picture_check_memory( source, error );
}

// A picture of the start shows hair with the appearance of its first step.
static wisp_status borrow_first_look( picture_source* source, simulation* s, wisp_error* error )
{
    bool is_needed = false;
    for ( int i = 0; i < s->scene.strands_count; ++i )
    {
        is_needed = is_needed || has_appearance( s, i );
    }
    return is_needed && s->scene.steps > 0 ? load_simulated( source, 1, error ) : WISP_OK;
}

static wisp_status add_bodies( picture_source* source, simulation* s, wisp_error* error )
{
    WISP_TRY( picture_make_bodies( source, scene_world_body_count( &s->world ), error ) );
    bool has_values = false;
    for ( int i = 0; i < source->body_count; ++i )
    {
        WISP_TRY( add_picture_body( source, s, i, error ) );
        has_values = has_values || source->bodies[i].values;
    }
    if ( source->value != PICTURE_BODY && !has_values )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          source->value == PICTURE_MAP
                              ? "%s: no surface has a map"
                              : "%s: got no surface, but only surfaces have strain and speed",
                          source->path );
    }
    return WISP_OK;
}

wisp_status picture_open_scene( picture_source* source, const picture_source_def* def, wisp_error* error )
{
    WISP_TRY( picture_start( source, &scene_input, sizeof( simulation ), error ) );
    simulation* s = source->state;
    s->options = def->world;
    s->shows_layers = def->layer != PICTURE_LAYER_NONE || def->has_layer_normals;
    WISP_TRY( wisp_scene_read( def->path, &s->scene, error ) );
    s->scene.steps = def->steps > 0 ? def->steps : s->scene.steps;
    WISP_TRY( start_world( s, error ) );
    source->frame_count = s->scene.steps + 1;
    memcpy( source->origin, s->scene.origin, sizeof source->origin );
    source->step = (double)s->scene.dt;
    source->has_seconds = true;
    WISP_TRY( add_bodies( source, s, error ) );
    WISP_TRY( request_all( source, s, error ) );
    return borrow_first_look( source, s, error );
}
