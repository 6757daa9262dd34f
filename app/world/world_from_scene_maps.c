// Maps of a scene: numbers of a text file, one per vertex, or an image sampled at the natural coordinates of a plane.
#include "world_from_scene_parts.h"

#include "wisp/maps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#if defined( WISP_PNG )
#include <png.h>
#endif

// ---- images ----

static bool is_image( const char* file )
{
    const size_t length = strlen( file );
    return length > 4 && ( strcmp( file + length - 4, ".png" ) == 0 || strcmp( file + length - 4, ".PNG" ) == 0 );
}

#if defined( WISP_PNG )

enum
{
    MAX_SIDE = 16384,
};

typedef struct texture
{
    int width, height;
    uint8_t* grey; // [height][width] as stored, rows from the top
} texture;

// Values as the file has them: a map is data, so no curve of a display is applied.
static double texel( const texture* t, int x, int y )
{
    x = x < 0 ? 0 : ( x >= t->width ? t->width - 1 : x );
    y = y < 0 ? 0 : ( y >= t->height ? t->height - 1 : y );
    return (double)t->grey[(size_t)y * (size_t)t->width + (size_t)x] / 255.0;
}

// Between the centres of four texels. @param u, v in [0, 1], from the left and from the top
static double sample( const texture* t, double u, double v )
{
    const double x = u * t->width - 0.5, y = v * t->height - 0.5, left = floor( x ), top = floor( y );
    const int i = (int)left, j = (int)top;
    const double a = x - left, b = y - top;
    return ( 1.0 - b ) * ( ( 1.0 - a ) * texel( t, i, j ) + a * texel( t, i + 1, j ) ) +
           b * ( ( 1.0 - a ) * texel( t, i, j + 1 ) + a * texel( t, i + 1, j + 1 ) );
}

static wisp_status open_texture( const char* file, texture* out, wisp_error* error )
{
    png_image image = { .version = PNG_IMAGE_VERSION };
    *out = ( texture ){ 0 };
    if ( !png_image_begin_read_from_file( &image, file ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: is not a PNG image: %s", file, image.message );
    }
    if ( image.width > MAX_SIDE || image.height > MAX_SIDE )
    {
        png_image_free( &image );
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %u x %u pixels, expected at most %d x %d", file,
                          (unsigned)image.width, (unsigned)image.height, MAX_SIDE, MAX_SIDE );
    }
    image.format = PNG_FORMAT_RGB;
    uint8_t* rgb = malloc( PNG_IMAGE_SIZE( image ) );
    if ( rgb == NULL )
    {
        png_image_free( &image );
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its pixels", file );
    }
    const png_color background = { 0, 0, 0 };
    if ( !png_image_finish_read( &image, &background, rgb, 0, NULL ) )
    {
        free( rgb );
        return wisp_fail( error, WISP_BAD_INPUT, "%s: is damaged: %s", file, image.message );
    }
    out->width = (int)image.width;
    out->height = (int)image.height;
    const size_t pixels = (size_t)out->width * (size_t)out->height;
    for ( size_t i = 0; i < pixels; ++i )
    {
        rgb[i] = (uint8_t)( ( rgb[3 * i] + rgb[3 * i + 1] + rgb[3 * i + 2] + 1 ) / 3 );
    }
    out->grey = rgb;
    return WISP_OK;
}

// Flat pieces lie in y = 0: left to right is along x, top to bottom along z.
static void sample_plane( const texture* t, const wisp_vec3* rest, int count, float* out )
{
    float lower[2] = { INFINITY, INFINITY }, upper[2] = { -INFINITY, -INFINITY };
    for ( int v = 0; v < count; ++v )
    {
        lower[0] = fminf( lower[0], rest[v].x );
        lower[1] = fminf( lower[1], rest[v].z );
        upper[0] = fmaxf( upper[0], rest[v].x );
        upper[1] = fmaxf( upper[1], rest[v].z );
    }
    const double width = (double)upper[0] - (double)lower[0], depth = (double)upper[1] - (double)lower[1];
    for ( int v = 0; v < count; ++v )
    {
        out[v] = (float)sample( t, ( (double)rest[v].x - (double)lower[0] ) / width,
                                ( (double)rest[v].z - (double)lower[1] ) / depth );
    }
}

static wisp_status read_image( const wisp_scene_map* map, const wisp_vec3* rest, int count, float* out,
                               wisp_error* error )
{
    texture t;
    const wisp_status status = open_texture( map->file, &t, error );
    if ( status == WISP_OK )
    {
        sample_plane( &t, rest, count, out );
    }
    free( t.grey );
    return status;
}

#else

static wisp_status read_image( const wisp_scene_map* map, const wisp_vec3* rest, int count, float* out,
                               wisp_error* error )
{
    (void)rest;
    (void)count;
    (void)out;
    return wisp_fail( error, WISP_BAD_INPUT, "%s: this program was built without libpng, which reads images",
                      map->file );
}

#endif

// ---- values ----

static bool is_flat( const wisp_scene_mesh* mesh )
{
    return mesh->is_generated && mesh->generator.shape <= WISP_MESH_GARMENT;
}

static wisp_status read_values( const wisp_scene_map* map, const wisp_scene_mesh* mesh, const wisp_vec3* rest,
                                int count, float* out, wisp_error* error )
{
    if ( is_image( map->file ) == false )
    {
        return wisp_scene_map_numbers( map, count, out, error );
    }
    return is_flat( mesh )
               ? read_image( map, rest, count, out, error )
               : wisp_fail( error, WISP_BAD_INPUT,
                            "%s: the mesh has no coordinates of an image; planes, Delaunay rectangles and "
                            "garments that are generated have",
                            map->file );
}

// From what a file has to factors of the constant.
static wisp_status scale( const wisp_scene_map* map, int count, float* values, wisp_error* error )
{
    for ( int v = 0; v < count; ++v )
    {
        const float value = map->from + ( map->to - map->from ) * values[v];
        if ( !( value >= map->lower && value <= map->upper ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: vertex %d: got %g, expected %g to %g", map->file, v,
                              (double)value, (double)map->lower, (double)map->upper );
        }
        values[v] = value / map->constant;
    }
    return WISP_OK;
}

static wisp_status set_values( scene_world* world, int surface, const wisp_scene_map* map, const float* values )
{
    const scene_world_surface* s = &world->surfaces[surface];
    return map->map == WISP_SCENE_MAP_TEARING
               ? scene_tearing_set( world, surface, values )
               : wisp_set_map( world->world, s->entity, map->map, values, s->mesh.vertex_count );
}

static wisp_status set_map( scene_world* world, int surface, const wisp_scene_map* map, wisp_error* error )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    const int source = entry->instance_of >= 0 ? entry->instance_of : surface;
    const scene_world_surface* s = &world->surfaces[surface];
    const int count = s->mesh.vertex_count, own = count - s->spare_count;
    float* values = malloc( (size_t)count * sizeof *values + 1 );
    wisp_vec3* rest = malloc( (size_t)count * sizeof *rest + 1 );
    wisp_error cause = { 0 };
    wisp_status status =
        values == NULL || rest == NULL ? wisp_fail( &cause, WISP_NO_MEMORY, "out of memory for a map" ) : WISP_OK;
    for ( int v = 0; v < count && status == WISP_OK; ++v )
    {
        rest[v] = s->fabric->rest[s->fabric->vertex_slot[v]];
    }
    status = status == WISP_OK ? read_values( map, &world->scene->surfaces[source].mesh, rest, own, values, &cause )
                               : status;
    for ( int v = own; v < count && status == WISP_OK; ++v )
    {
        values[v] = values[0]; // until it is a copy of another vertex
    }
    status = status == WISP_OK ? scale( map, count, values, &cause ) : status;
    if ( status == WISP_OK && set_values( world, surface, map, values ) != WISP_OK )
    {
        status = wisp_fail( &cause, WISP_BAD_INPUT, "%s", wisp_world_message( world->world ) );
    }
    free( values );
    free( rest );
    return status == WISP_OK ? WISP_OK
                             : scene_fail_at( world->scene, map->line, map->column, "surface", entry->name, status,
                                              cause.message, error );
}

wisp_status scene_maps_set( scene_world* world, int surface, bool of_mass, wisp_error* error )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    wisp_status status = WISP_OK;
    for ( int i = 0; i < entry->map_count && status == WISP_OK; ++i )
    {
        status = ( entry->maps[i].map == WISP_MAP_AREA_DENSITY ) == of_mass
                     ? set_map( world, surface, entry->maps + i, error )
                     : WISP_OK;
    }
    return status;
}
