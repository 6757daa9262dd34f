// Values of vertices: where they start, maps, and how strong they are.
#include "world_from_scene_parts.h"

#include "wisp/maps.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"
#include "wisp/module/random.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// ---- starts ----

// Surfaces and strands that start away from their rest shape, and masses that grow along them.

// Bounds of points, with the middle in double.
typedef struct start_box
{
    double lower[3], upper[3], middle[3];
    double size; // m, the longest edge
} start_box;

static start_box box_of( const wisp_vec3* points, int count )
{
    start_box box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY }, { 0 }, 0.0 };
    for ( int i = 0; i < count; ++i )
    {
        const double p[3] = { (double)points[i].x, (double)points[i].y, (double)points[i].z };
        for ( int k = 0; k < 3; ++k )
        {
            box.lower[k] = fmin( box.lower[k], p[k] );
            box.upper[k] = fmax( box.upper[k], p[k] );
        }
    }
    for ( int k = 0; k < 3; ++k )
    {
        box.middle[k] = 0.5 * ( box.lower[k] + box.upper[k] );
        box.size = fmax( box.size, box.upper[k] - box.lower[k] );
    }
    return box;
}

// Turned about the vertical through the middle, in proportion to the depth.
static void twist( const start_box* box, double turns, double p[3] )
{
    const double height = box->upper[1] - box->lower[1];
    const double angle = height > 0.0 ? 6.283185307179586 * turns * ( box->upper[1] - p[1] ) / height : 0.0;
    const double x = p[0] - box->middle[0], z = p[2] - box->middle[2];
    p[0] = box->middle[0] + cos( angle ) * x + sin( angle ) * z;
    p[2] = box->middle[2] - sin( angle ) * x + cos( angle ) * z;
}

// Pinned vertices are only scaled.
static wisp_vec3 start_of( const wisp_scene_start* start, const start_box* box, double mirror, wisp_vec3 rest,
                           int vertex, bool is_pinned )
{
    const wisp_scene_start_shape shape = is_pinned ? WISP_SCENE_START_REST : start->shape;
    const double scale[3] = { (double)start->scale.x, (double)start->scale.y, (double)start->scale.z };
    double p[3] = { (double)rest.x, (double)rest.y, (double)rest.z };
    const wisp_random_key key = wisp_random_make_key( start->seed, 0, 0 );
    for ( int k = 0; k < 3; ++k )
    {
        p[k] = box->middle[k] + scale[k] * ( p[k] - box->middle[k] );
        switch ( shape )
        {
            case WISP_SCENE_START_RANDOM:
                p[k] =
                    box->middle[k] + box->size * ( wisp_random_unit( key, (uint32_t)vertex, (uint32_t)k, 0 ) - 0.5 );
                break;
            case WISP_SCENE_START_PLANE:
                p[k] = k == 1 ? box->middle[k] : p[k];
                break;
            case WISP_SCENE_START_POINT:
                p[k] = box->middle[k];
                break;
            case WISP_SCENE_START_INSIDE_OUT:
                p[k] = 2.0 * ( k == 1 ? mirror : box->middle[k] ) - p[k];
                break;
            case WISP_SCENE_START_REST:
            case WISP_SCENE_START_TWISTED:
                break;
        }
    }
    if ( shape == WISP_SCENE_START_TWISTED )
    {
        twist( box, (double)start->turns, p );
    }
    for ( int k = 0; k < 3 && start->shake > 0.0f && !is_pinned; ++k )
    {
        // other numbers than those of random places
        p[k] += (double)start->shake * ( 2.0 * wisp_random_unit( key, (uint32_t)vertex, (uint32_t)k, 1 ) - 1.0 );
    }
    return ( wisp_vec3 ){ (float)p[0], (float)p[1], (float)p[2] };
}

// A file has the vertices of the mesh, or those of the file of the mesh before its repair.
static wisp_status place_file( const wisp_scene_surface* entry, float scale, const wisp_mesh_repairs* repairs,
                               const wisp_mesh* file, wisp_mesh* mesh, wisp_error* error )
{
    const bool is_unrepaired = repairs->kept != NULL && file->vertex_count == repairs->original_count;
    if ( file->vertex_count != mesh->vertex_count && !is_unrepaired )
    {
        char before[60] = "";
        if ( repairs->kept != NULL && repairs->original_count != mesh->vertex_count )
        {
            snprintf( before, sizeof before, ", or %d as before its repair", repairs->original_count );
        }
        return wisp_fail( error, WISP_BAD_INPUT, "start.file: %.200s: got %d vertices, expected %d as the mesh has%s",
                          entry->start.file, file->vertex_count, mesh->vertex_count, before );
    }
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        const wisp_vec3 p = file->points[is_unrepaired ? repairs->kept[v] : v];
        mesh->points[v] =
            wisp_transform_to_world( entry->pose, ( wisp_vec3 ){ scale * p.x, scale * p.y, scale * p.z } );
    }
    return WISP_OK;
}

wisp_status scene_start_load( const wisp_scene* scene, int surface, const wisp_mesh_repairs* repairs,
                              scene_world_surface* out, wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    const wisp_scene_arrays* a = entry->start.arrays;
    if ( !entry->has_start || entry->start.file == NULL )
    {
        return WISP_OK;
    }
    const float scale = scene->surfaces[entry->instance_of >= 0 ? entry->instance_of : surface].mesh.scale;
    wisp_mesh file = { 0 };
    wisp_error cause = { 0 };
    wisp_status status = a != NULL ? wisp_mesh_of_arrays( a->points, a->point_count, a->triangles, a->triangle_count,
                                                          entry->start.file, &file, &cause )
                                   : wisp_mesh_read( entry->start.file, &file, &cause );
    status = status == WISP_OK ? place_file( entry, scale, repairs, &file, &out->mesh, &cause ) : status;
    wisp_mesh_release( &file );
    return status == WISP_OK ? WISP_OK
                             : scene_fail_at( scene, entry->line, entry->column, "surface", entry->name, status,
                                              cause.message, error );
}

void scene_start_place( const wisp_scene_surface* entry, scene_world_surface* surface )
{
    wisp_mesh* mesh = &surface->mesh;
    const start_box box = box_of( mesh->points, mesh->vertex_count );
    double mirror = surface->pin_count > 0 ? 0.0 : box.middle[1];
    for ( int i = 0; i < surface->pin_count; ++i )
    {
        mirror += (double)mesh->points[surface->pins[i]].y / surface->pin_count;
    }
    for ( int v = 0, pin = 0; v < mesh->vertex_count && entry->has_start; ++v )
    {
        // pins are in ascending order
        const bool is_pinned = pin < surface->pin_count && surface->pins[pin] == v;
        pin += is_pinned ? 1 : 0;
        mesh->points[v] = start_of( &entry->start, &box, mirror, mesh->points[v], v, is_pinned );
    }
}

void scene_surface_weigh( const wisp_scene_surface* entry, const scene_world_surface* surface, wisp_world* world )
{
    const wisp_fabric* f = surface->fabric;
    float* x = wisp_world_column( world, surface->entity, WISP_PARTICLE_POSITION, 0 );
    double lower = INFINITY, upper = -INFINITY;
    for ( int i = 0; i < f->vertex_count && entry->mass_ratio != 1.0f; ++i )
    {
        const double y = (double)wisp_transform_to_world( entry->pose, f->rest[i] ).y;
        lower = fmin( lower, y );
        upper = fmax( upper, y );
    }
    for ( int i = 0; i < f->vertex_count && upper > lower; ++i )
    {
        const double y = (double)wisp_transform_to_world( entry->pose, f->rest[i] ).y;
        x[4 * i + 3] *= (float)pow( (double)entry->mass_ratio, -( upper - y ) / ( upper - lower ) );
    }
}

void scene_strands_weigh( const wisp_scene_strands* entry, const wisp_groom* groom, float* out )
{
    const wisp_strand_dynamics_def* d = &entry->dynamics;
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        const int begin = groom->offsets[s], end = groom->offsets[s + 1];
        for ( int v = begin; v < end; ++v )
        {
            const double depth = end - begin > 1 ? (double)( v - begin ) / ( end - begin - 1 ) : 0.0;
            const double before = v > begin ? wisp_mesh_distance( groom->points[v - 1], groom->points[v] ) : 0.0,
                         behind = v + 1 < end ? wisp_mesh_distance( groom->points[v], groom->points[v + 1] ) : 0.0;
            const double mass = d->vertex_masses        ? (double)d->vertex_masses[v]
                                : d->vertex_mass > 0.0f ? (double)d->vertex_mass
                                                        : 0.5 * (double)d->line_density * ( before + behind );
            out[v] = (float)fmin( fmax( mass * pow( (double)entry->mass_ratio, depth ), 1e-15 ), 1e12 );
        }
    }
}

// Rows of x, y and z of sixteen strands.
static void write_lanes( const wisp_strand_topology* t, const wisp_vec3* points, float* column )
{
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        const int strand = t->lane_strand[lane];
        for ( int v = 0; strand >= 0 && v < t->lane_count[lane]; ++v )
        {
            const wisp_vec3 p = points[t->offsets[strand] + v];
            float* to = column + (size_t)( t->group_row[lane / WISP_LANES] + v ) * 3 * WISP_LANES + lane % WISP_LANES;
            to[0] = p.x;
            to[WISP_LANES] = p.y;
            to[2 * WISP_LANES] = p.z;
        }
    }
}

void scene_strands_start( const wisp_scene_strands* entry, wisp_world* world, wisp_entity entity, wisp_groom* groom )
{
    const start_box box = box_of( groom->points, groom->vertex_count );
    double mirror = 0.0;
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        mirror += (double)groom->points[groom->offsets[s]].y / groom->strand_count;
    }
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        for ( int v = groom->offsets[s]; v < groom->offsets[s + 1]; ++v )
        {
            groom->points[v] = start_of( &entry->start, &box, mirror, groom->points[v], v, v == groom->offsets[s] );
        }
    }
    write_lanes( wisp_world_strands( world, entity ), groom->points,
                 wisp_world_column( world, entity, WISP_STRAND_POSITION, 0 ) );
}

// ---- maps ----

// Maps of a scene: numbers of a text file, one per vertex; an image sampled at texture coordinates, or at the natural ones of a
// plane; or colours of vertices.

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
    for ( int i = 0; i < entry->map_count; ++i )
    {
        WISP_TRY( ( entry->maps[i].map == WISP_MAP_AREA_DENSITY ) == of_mass
                      ? set_map( world, surface, entry->maps + i, error )
                      : WISP_OK );
    }
    return WISP_OK;
}

// ---- tearing ----

// Surfaces of a scene that tear: spare vertices of their meshes, the strength, triangles that change.

// ---- spare vertices ----

static int spares_of( const wisp_scene_surface* entry, int vertex_count )
{
    enum
    {
        MIN_SPARES = 64,
        PART = 4, // of the vertices
    };
    const int usual = vertex_count / PART > MIN_SPARES ? vertex_count / PART : MIN_SPARES;
    return entry->has_tearing == false ? 0 : entry->max_new_vertices >= 0 ? entry->max_new_vertices : usual;
}

wisp_status scene_tearing_reserve( const wisp_scene* scene, int surface, scene_world_surface* out, wisp_error* error )
{
    wisp_mesh* mesh = &out->mesh;
    int spares = 0;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        const bool has_mesh = i == surface || scene->surfaces[i].instance_of == surface;
        const int count = has_mesh ? spares_of( &scene->surfaces[i], mesh->vertex_count ) : 0;
        spares = count > spares ? count : spares;
    }
    if ( spares == 0 || mesh->vertex_count == 0 )
    {
        return WISP_OK;
    }
    wisp_vec3* points =
        realloc( mesh->points, ( (size_t)mesh->vertex_count + (size_t)spares ) * sizeof *mesh->points );
    if ( !points )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d spare vertices", spares );
    }
    mesh->points = points;
    for ( int i = 0; i < spares; ++i )
    {
        points[mesh->vertex_count + i] = points[0];
    }
    mesh->vertex_count += spares;
    out->spare_count = spares;
    return WISP_OK;
}

// ---- the strength ----

wisp_status scene_tearing_set( scene_world* world, int surface, const float* factors )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    wisp_tearing_def def = entry->tearing;
    def.factors = factors;
    return entry->has_tearing ? wisp_set_tearing( world->world, world->surfaces[surface].entity, &def ) : WISP_OK;
}

// ---- triangles ----

static wisp_status fail_without_memory( const scene_world* world, int surface, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "%s: '%s': out of memory for its triangles", world->scene->name,
                      world->scene->surfaces[surface].name );
}

wisp_status scene_tearing_prepare( scene_world* world, int surface, wisp_error* error )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    scene_world_surface* s = &world->surfaces[surface];
    if ( !entry->has_tearing || entry->instance_of < 0 )
    {
        return WISP_OK;
    }
    const wisp_mesh* source = &world->surfaces[entry->instance_of].mesh;
    const size_t bytes = 3 * (size_t)source->triangle_count * sizeof *source->triangles;
    s->mesh.triangles = malloc( bytes + 1 );
    if ( !s->mesh.triangles )
    {
        return fail_without_memory( world, surface, error );
    }
    memcpy( s->mesh.triangles, source->triangles, bytes );
    s->mesh.triangle_count = source->triangle_count;
    return WISP_OK;
}

static wisp_status follow( scene_world* world, int surface )
{
    scene_world_surface* s = &world->surfaces[surface];
    wisp_tearing_stats stats;
    wisp_status status = wisp_read_tearing_stats( world->world, s->entity, &stats );
    if ( status == WISP_OK && stats.split_count != s->split_count )
    {
        s->split_count = stats.split_count;
        status = wisp_read_triangles( world->world, s->entity, s->mesh.triangles, s->mesh.triangle_count );
    }
    return status;
}

wisp_status scene_tearing_follow( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        if ( scene->surfaces[i].has_tearing && follow( world, i ) != WISP_OK )
        {
            return wisp_fail( error, WISP_CONFLICT, "%s: '%s': %s", scene->name, scene->surfaces[i].name,
                              wisp_world_message( world->world ) );
        }
    }
    return WISP_OK;
}
