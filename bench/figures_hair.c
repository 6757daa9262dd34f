#include "figures_hair.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define SIDE 480

void figures_hair_begin( const figures_case* page, figures_hair_album* album, const char* format, ... )
{
    if ( !page->pictures || album->count == FIGURES_HAIR_SHOTS_MAX )
    {
        return;
    }
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( album->labels[album->count], sizeof( album->labels[0] ), format, arguments );
    va_end( arguments );
    ++album->count;
}

wisp_status figures_hair_add( const figures_case* page, figures_hair_album* album, const wisp_vec3* points,
                              int strand_count, int vertices, wisp_vec3 colour, float radius, wisp_error* error )
{
    int shot = album->count - 1;
    if ( !page->pictures || shot < 0 || album->layer_count[shot] == FIGURES_HAIR_LAYERS_MAX )
    {
        return WISP_OK;
    }
    figures_hair_layer* layer = &album->layers[shot][album->layer_count[shot]++];
    size_t bytes = (size_t)strand_count * (size_t)vertices * sizeof( wisp_vec3 );
    *layer = ( figures_hair_layer ){
        .points = malloc( bytes ),
        .offsets = malloc( ( (size_t)strand_count + 1 ) * sizeof( int32_t ) ),
        .strand_count = strand_count,
        .colour = colour,
        .radius = radius,
    };
    if ( !layer->points || !layer->offsets )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a picture" );
    }
    memcpy( layer->points, points, bytes );
    for ( int s = 0; s <= strand_count; ++s )
    {
        layer->offsets[s] = s * vertices;
    }
    return WISP_OK;
}

static float blend( float a, float b, float t )
{
    return a + ( b - a ) * t;
}

wisp_status figures_hair_add_blended( const figures_case* page, figures_hair_album* album, const wisp_vec3* points,
                                      int strand_count, int vertices, wisp_vec3 root_colour, wisp_vec3 tip_colour,
                                      float radius, wisp_error* error )
{
    const int shot = album->count - 1;
    const int layers = page->pictures && shot >= 0 ? album->layer_count[shot] : FIGURES_HAIR_LAYERS_MAX;
    wisp_status status = figures_hair_add( page, album, points, strand_count, vertices, root_colour, radius, error );
    if ( status != WISP_OK || layers == FIGURES_HAIR_LAYERS_MAX )
    {
        return status;
    }
    wisp_vec3* colours = malloc( (size_t)strand_count * (size_t)vertices * sizeof( wisp_vec3 ) );
    for ( int i = 0; i < strand_count * vertices && colours; ++i )
    {
        const float t = vertices > 1 ? (float)( i % vertices ) / (float)( vertices - 1 ) : 0.0f;
        colours[i] = ( wisp_vec3 ){ blend( root_colour.x, tip_colour.x, t ), blend( root_colour.y, tip_colour.y, t ),
                                    blend( root_colour.z, tip_colour.z, t ) };
    }
    album->layers[shot][layers].colours = colours;
    return colours ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for a picture" );
}

void figures_hair_free( figures_hair_album* album )
{
    for ( int shot = 0; shot < album->count; ++shot )
    {
        for ( int i = 0; i < album->layer_count[shot]; ++i )
        {
            free( album->layers[shot][i].points );
            free( album->layers[shot][i].offsets );
            free( album->layers[shot][i].colours );
        }
    }
    *album = ( figures_hair_album ){ .count = 0 };
}

static void set_scene( const figures_hair_album* album, int shot, render_curves* curves, render_scene* scene )
{
    for ( int i = 0; i < album->layer_count[shot]; ++i )
    {
        const figures_hair_layer* layer = &album->layers[shot][i];
        curves[i] = render_default_curves();
        curves[i].points = layer->points;
        curves[i].offsets = layer->offsets;
        curves[i].strand_count = layer->strand_count;
        curves[i].colour = layer->colour;
        curves[i].colours = layer->colours;
        curves[i].radius = layer->radius;
        curves[i].is_hair = album->is_flat && layer->colours;
    }
    *scene = render_default_scene();
    scene->curves = curves;
    scene->curves_count = album->layer_count[shot];
    if ( album->is_flat )
    {
        scene->background_top = scene->background_bottom = ( wisp_vec3 ){ 1.0f, 1.0f, 1.0f };
    }
}

static wisp_status shot_bounds( const figures_hair_album* album, int shot, render_bounds* bounds, wisp_error* error )
{
    render_curves curves[FIGURES_HAIR_LAYERS_MAX];
    render_scene scene;
    *bounds = ( render_bounds ){ .is_filled = false };
    set_scene( album, shot, curves, &scene );
    return render_scene_bounds( &scene, bounds, error );
}

static wisp_vec3 half_sum( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ 0.5f * ( a.x + b.x ), 0.5f * ( a.y + b.y ), 0.5f * ( a.z + b.z ) };
}

// All shots have one scale, so that they can be compared. Hair in the plane is seen from one place; other shots, which swing
// or differ in size, each have their own in the middle.
static wisp_status find_camera( const figures_hair_album* album, int shot, render_camera* camera, wisp_error* error )
{
    render_bounds all = { .is_filled = false }, own, other;
    wisp_vec3 half = { 0.0f, 0.0f, 0.0f }; // of the largest
    wisp_status status = shot_bounds( album, shot, &own, error );
    for ( int i = 0; i < album->count && status == WISP_OK; ++i )
    {
        status = shot_bounds( album, i, &other, error );
        const wisp_vec3 low = other.lower, high = other.upper;
        half = ( wisp_vec3 ){ fmaxf( half.x, 0.5f * ( high.x - low.x ) ), fmaxf( half.y, 0.5f * ( high.y - low.y ) ),
                              fmaxf( half.z, 0.5f * ( high.z - low.z ) ) };
        all = render_bounds_union( all, other );
    }
    render_view view = render_default_view();
    const wisp_vec3 middle = half_sum( own.lower, own.upper );
    const render_bounds box = { { middle.x - half.x, middle.y - half.y, middle.z - half.z },
                                { middle.x + half.x, middle.y + half.y, middle.z + half.z },
                                own.is_filled };
    if ( album->is_flat )
    {
        view.azimuth_degrees = view.elevation_degrees = 0.0f;
    }
    return status == WISP_OK ? render_frame_camera( album->is_flat ? &all : &box, &view, 1.0f, camera, error )
                             : status;
}

static wisp_status draw( const figures_hair_album* album, picture_sheet* sheet, wisp_error* error )
{
    render_options options = render_default_options();
    options.width = SIDE;
    options.height = SIDE;
    options.threads = 2;
    wisp_status status = WISP_OK;
    for ( int shot = 0; shot < album->count && status == WISP_OK; ++shot )
    {
        render_camera camera;
        render_curves curves[FIGURES_HAIR_LAYERS_MAX];
        render_scene scene;
        set_scene( album, shot, curves, &scene );
        status = find_camera( album, shot, &camera, error );
        status =
            status == WISP_OK ? render_picture( &scene, &camera, &options, &sheet->pictures[shot], error ) : status;
        sheet->labels[shot] = album->labels[shot];
        sheet->count = shot + 1;
    }
    return status;
}

wisp_status figures_hair_write( figures_case* page, const figures_hair_album* album, const char* name,
                                const char* caption, wisp_error* error )
{
    if ( !page->pictures || album->count == 0 )
    {
        return WISP_OK;
    }
    picture_sheet sheet = { .count = 0 };
    const wisp_status status = draw( album, &sheet, error );
    return picture_sheet_finish( &sheet, status, page->pictures, name, caption, page->out, error );
}
