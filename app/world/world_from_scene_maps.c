// Maps of a scene: numbers of a text file, one per vertex; an image sampled at texture coordinates, or at the natural ones of a
// plane; or colours of vertices.
#include "world_from_scene_parts.h"

#include "wisp/maps.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if defined( WISP_PNG )
#include <png.h>
#endif

// ---- images ----

// What a map takes of a colour.
static double of_channel( wisp_scene_map_channel channel, double r, double g, double b )
{
    return channel == WISP_SCENE_MAP_RED     ? r
           : channel == WISP_SCENE_MAP_GREEN ? g
           : channel == WISP_SCENE_MAP_BLUE  ? b
                                             : ( r + g + b ) / 3.0;
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

static wisp_status open_texture( const char* file, wisp_scene_map_channel channel, texture* out, wisp_error* error )
{
    png_image image = { .version = PNG_IMAGE_VERSION };
    *out = ( texture ){ 0 };
    if ( access( file, R_OK ) != 0 )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: cannot open: %s", file, strerror( errno ) );
    }
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
        const uint8_t* from = rgb + 3 * i;
        rgb[i] = channel == WISP_SCENE_MAP_MEAN ? (uint8_t)( ( from[0] + from[1] + from[2] + 1 ) / 3 )
                                                : from[channel - WISP_SCENE_MAP_RED];
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

// A texture coordinate within the image: outside 0 .. 1 the image repeats, and both borders of it are its own.
static double wrapped( float coordinate )
{
    const double c = (double)coordinate;
    return c >= 0.0 && c <= 1.0 ? c : c - floor( c );
}

// @param uvs [count][2] from the lower left; null: a flat piece
static wisp_status read_image( const wisp_scene_map* map, const float* uvs, const wisp_vec3* rest, int count,
                               float* out, wisp_error* error )
{
    texture t;
    const wisp_status status = open_texture( map->file, map->channel, &t, error );
    if ( status == WISP_OK && uvs == NULL )
    {
        sample_plane( &t, rest, count, out );
    }
    for ( int v = 0; v < count && status == WISP_OK && uvs != NULL; ++v )
    {
        out[v] = (float)sample( &t, wrapped( uvs[2 * v] ), 1.0 - wrapped( uvs[2 * v + 1] ) );
    }
    free( t.grey );
    return status;
}

#else

static wisp_status read_image( const wisp_scene_map* map, const float* uvs, const wisp_vec3* rest, int count,
                               float* out, wisp_error* error )
{
    (void)uvs;
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

static wisp_status read_colours( const wisp_scene_map* map, const wisp_mesh* mesh, float* out, wisp_error* error )
{
    for ( int v = 0; v < mesh->vertex_count && mesh->colours != NULL; ++v )
    {
        const wisp_vec3 c = mesh->colours[v];
        out[v] = (float)of_channel( map->channel, (double)c.x, (double)c.y, (double)c.z );
    }
    return mesh->colours != NULL
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT,
                            "map: the mesh has no colours; files with a colour of each vertex have" );
}

// What a file lacks of some vertices has a value all the same, which is said.
static void tell_missing( const scene_world* world, const wisp_scene_surface* entry, const wisp_scene_map* map,
                          const wisp_mesh* mesh )
{
    const int missing = map->file == NULL ? mesh->colour_missing_count : mesh->uv_missing_count;
    if ( missing > 0 && !world->is_quiet )
    {
        char text[400];
        snprintf( text, sizeof text, "%.120s:%d:%d: surface '%s': %s: vertices of the file without %s: %d",
                  world->scene->name, map->line, map->column, entry->name, map->path,
                  map->file == NULL ? "a colour, which are white" : "texture coordinates, which are at (0, 0)",
                  missing );
        scene_tell( world, WISP_LOG_WARNING, text );
    }
}

// @param source the surface that has the mesh with its attributes
static wisp_status read_values( const scene_world* world, const wisp_scene_map* map, int source,
                                const wisp_vec3* rest, int count, float* out, wisp_error* error )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[source];
    const wisp_mesh* mesh = &world->surfaces[source].mesh;
    const bool is_image = wisp_scene_map_is_image( map );
    if ( map->file != NULL && !is_image )
    {
        return wisp_scene_map_numbers( map, count, out, error );
    }
    tell_missing( world, entry, map, mesh );
    if ( !is_image )
    {
        return read_colours( map, mesh, out, error );
    }
    return is_flat( &entry->mesh ) ? read_image( map, NULL, rest, count, out, error )
           : mesh->uvs != NULL     ? read_image( map, mesh->uvs, rest, count, out, error )
                                   : wisp_fail( error, WISP_BAD_INPUT,
                                                "%s: the mesh has no coordinates of an image; files with texture "
                                                    "coordinates, and planes, Delaunay rectangles and garments have",
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
            return wisp_fail( error, WISP_BAD_INPUT, "%s: vertex %d: got %g, expected %g to %g",
                              map->file != NULL ? map->file : "map: colours", v, (double)value, (double)map->lower,
                              (double)map->upper );
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

// The values of a map as its source has them. @param out [vertex_count] of the mesh
static wisp_status sample_map( const scene_world* world, int surface, const wisp_scene_map* map, float* out,
                               wisp_error* error )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    const int source = entry->instance_of >= 0 ? entry->instance_of : surface;
    const scene_world_surface* s = &world->surfaces[surface];
    const int count = s->mesh.vertex_count, own = count - s->spare_count;
    wisp_vec3* rest = malloc( (size_t)count * sizeof *rest + 1 );
    if ( rest == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for a map" );
    }
    for ( int v = 0; v < count; ++v )
    {
        rest[v] = s->fabric->rest[s->fabric->vertex_slot[v]];
    }
    const wisp_status status = read_values( world, map, source, rest, own, out, error );
    for ( int v = own; v < count && status == WISP_OK; ++v )
    {
        out[v] = out[0]; // until it is a copy of another vertex
    }
    free( rest );
    return status;
}

wisp_status scene_world_map( const scene_world* world, int surface, float* out, wisp_error* error )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    WISP_ASSERT( entry->map_count > 0 );
    return sample_map( world, surface, entry->maps, out, error );
}

static wisp_status set_map( scene_world* world, int surface, const wisp_scene_map* map, wisp_error* error )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    const int count = world->surfaces[surface].mesh.vertex_count;
    float* values = malloc( (size_t)count * sizeof *values + 1 );
    wisp_error cause = { 0 };
    wisp_status status = values == NULL ? wisp_fail( &cause, WISP_NO_MEMORY, "out of memory for a map" ) : WISP_OK;
    status = status == WISP_OK ? sample_map( world, surface, map, values, &cause ) : status;
    status = status == WISP_OK ? scale( map, count, values, &cause ) : status;
    if ( status == WISP_OK && set_values( world, surface, map, values ) != WISP_OK )
    {
        status = wisp_fail( &cause, WISP_BAD_INPUT, "%s", wisp_world_message( world->world ) );
    }
    free( values );
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
