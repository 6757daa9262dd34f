// Surfaces and strands that start away from their rest shape, and masses that grow along them.
#include "world_from_scene_parts.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include "wisp/module/random.h"

#include <math.h>

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

static double length_of( const wisp_groom* groom, int a )
{
    const wisp_vec3 p = groom->points[a], q = groom->points[a + 1];
    const double x = (double)q.x - (double)p.x, y = (double)q.y - (double)p.y, z = (double)q.z - (double)p.z;
    return sqrt( x * x + y * y + z * z );
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
            const double before = v > begin ? length_of( groom, v - 1 ) : 0.0,
                         behind = v + 1 < end ? length_of( groom, v ) : 0.0;
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
