#include "stability_trace.h"

#include "text_tree.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- requests ----

static void request_all( wisp_scene* scene )
{
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        wisp_scene_strands* s = &scene->strands[i];
        s->request_points = true;
        s->request_motion_stats = s->has_dynamics;
        s->request_contacts = s->has_collision;
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        wisp_scene_surface* s = &scene->surfaces[i];
        s->request_points = s->request_motion_stats = true;
        s->request_contacts = s->has_collision;
    }
}

static bool has_contact( const wisp_scene* scene )
{
    bool any = false;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        any |= scene->surfaces[i].has_contact;
    }
    return any;
}

// ---- samples ----

static wisp_entity entity_of( const scene_world* world, int body )
{
    const int strands = world->scene->strands_count;
    return body < strands ? world->entities[body] : world->surfaces[body - strands].entity;
}

static bool collides( const wisp_scene* scene, int body )
{
    return body < scene->strands_count ? scene->strands[body].has_collision
                                       : scene->surfaces[body - scene->strands_count].has_collision;
}

static bool are_finite( const wisp_vec3* points, int count )
{
    bool is_finite = true;
    for ( int i = 0; i < count; ++i )
    {
        is_finite &= isfinite( points[i].x ) && isfinite( points[i].y ) && isfinite( points[i].z );
    }
    return is_finite;
}

static void sample_motion( const scene_world* world, int body, stability_sample* sample )
{
    wisp_motion_stats m;
    if ( scene_world_motion_stats( world, body, &m, NULL ) == WISP_OK )
    {
        sample->kinetic = m.kinetic_energy;
        sample->potential = m.potential_energy;
        sample->speed = m.speed_max;
        memcpy( sample->centre, m.centre, sizeof m.centre );
        sample->is_finite &=
            isfinite( m.kinetic_energy ) && isfinite( m.potential_energy ) && isfinite( m.speed_max );
    }
}

static void sample_body( const scene_world* world, const stability_trace* trace, int body, wisp_vec3* points,
                         stability_sample* sample )
{
    const scene_body shape = scene_world_body( world, body );
    sample->is_finite =
        scene_world_points( world, body, points, NULL ) != WISP_OK || are_finite( points, shape.vertex_count );
    if ( trace->bodies[body].moves )
    {
        sample_motion( world, body, sample );
    }
    wisp_collision_stats stats;
    if ( collides( world->scene, body ) && scene_world_collision_stats( world, body, &stats, NULL ) == WISP_OK )
    {
        sample->penetration = stats.vertex >= 0 ? (double)stats.penetration : 0.0;
        sample->thickness = (double)stats.thickness;
    }
}

static void sample_all( const scene_world* world, stability_trace* trace, int row, wisp_vec3* points )
{
    trace->times[row] = scene_world_time( world );
    for ( int body = 0; body < trace->body_count; ++body )
    {
        sample_body( world, trace, body, points, stability_sample_of( trace, row, body ) );
    }
}

// ---- stretch ----

static double distance( wisp_vec3 a, wisp_vec3 b )
{
    const double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
    return sqrt( x * x + y * y + z * z );
}

static double stretch_of_edge( const wisp_vec3* now, const wisp_vec3* rest, int a, int b )
{
    const double length = distance( rest[a], rest[b] );
    return length > 0.0 ? distance( now[a], now[b] ) / length - 1.0 : 0.0;
}

static double stretch_of( const scene_body* shape, const wisp_vec3* now, const wisp_vec3* rest )
{
    double stretch = 0.0;
    for ( int i = 0; i < 3 * shape->triangle_count; ++i )
    {
        const int first = i - i % 3;
        stretch = fmax( stretch,
                        stretch_of_edge( now, rest, shape->triangles[i], shape->triangles[first + ( i + 1 ) % 3] ) );
    }
    for ( int s = 0; s < shape->strand_count; ++s )
    {
        for ( int v = shape->offsets[s] + 1; v < shape->offsets[s + 1]; ++v )
        {
            stretch = fmax( stretch, stretch_of_edge( now, rest, v - 1, v ) );
        }
    }
    return stretch;
}

static void finish_bodies( const scene_world* world, stability_trace* trace, wisp_vec3* points )
{
    const int strands = world->scene->strands_count;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        stability_body* b = &trace->bodies[body];
        const scene_body shape = scene_world_body( world, body );
        const wisp_vec3* rest =
            body < strands ? world->grooms[body].points : world->surfaces[body - strands].mesh.points;
        b->is_halted = wisp_is_halted( world->world, entity_of( world, body ) );
        if ( b->moves && scene_world_points( world, body, points, NULL ) == WISP_OK )
        {
            b->stretch = stretch_of( &shape, points, rest );
        }
    }
}

// ---- the run ----

// Masses and the energy of the start, from a step that is too short to change anything.
static wisp_status sample_start( const wisp_scene* scene, stability_trace* trace, wisp_vec3* points,
                                 wisp_error* error )
{
    const float MOMENT = 1e-6f;
    scene_world world;
    const scene_world_options options = { .workers = 1, .is_quiet = true };
    wisp_status status = scene_world_create( scene, &options, &world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = wisp_world_step( world.world, MOMENT );
    status = status == WISP_OK ? WISP_OK : wisp_fail( error, status, "%s", wisp_world_message( world.world ) );
    if ( status == WISP_OK )
    {
        stability_find_inputs( &world, trace );
        sample_all( &world, trace, 0, points );
        trace->times[0] = 0.0;
        for ( int body = 0; body < trace->body_count; ++body )
        {
            const stability_sample* s = stability_sample_of( trace, 0, body );
            memcpy( trace->bodies[body].start, s->centre, sizeof s->centre );
            trace->bodies[body].starts_inside = s->penetration > s->thickness;
        }
    }
    scene_world_destroy( &world );
    return status;
}

static int count_intersections( scene_world* world )
{
    wisp_contact_stats stats;
    return wisp_read_contact_stats( world->world, &stats ) == WISP_OK ? stats.intersections : -1;
}

static bool is_finite_row( const stability_trace* trace, int row )
{
    bool is_finite = true;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        is_finite &= stability_sample_of( trace, row, body )->is_finite;
    }
    return is_finite;
}

// Counting intersections costs a search, so only the first and the last step are asked for it.
static void make_steps( scene_world* world, stability_trace* trace, wisp_vec3* points )
{
    const int steps = world->scene->steps;
    const bool counts = has_contact( world->scene );
    wisp_error error = { 0 };
    for ( int step = 0; step < steps && trace->status == WISP_OK && is_finite_row( trace, step ); ++step )
    {
        const bool is_end = step == 0 || step + 1 == steps;
        if ( counts && ( step < 2 || is_end ) )
        {
            (void)wisp_request_contact_stats( world->world, is_end, is_end );
        }
        trace->status = scene_world_step( world, &error );
        if ( trace->status != WISP_OK )
        {
            snprintf( trace->message, sizeof trace->message, "%s", error.message );
            return;
        }
        trace->steps = step + 1;
        sample_all( world, trace, step + 1, points );
        trace->intersections_before =
            step == 0 && counts ? count_intersections( world ) : trace->intersections_before;
        trace->intersections_after = is_end && counts ? count_intersections( world ) : -1;
    }
}

wisp_status stability_trace_run( wisp_scene* scene, stability_trace* out, wisp_error* error )
{
    const size_t bodies = (size_t)scene->strands_count + (size_t)scene->surface_count;
    const size_t rows = (size_t)scene->steps + 1;
    *out = ( stability_trace ){ .body_count = (int)bodies, .intersections_before = -1, .intersections_after = -1 };
    request_all( scene );
    scene_world world;
    const scene_world_options options = { .workers = 1, .is_quiet = true };
    wisp_status status = scene_world_create( scene, &options, &world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    out->bodies = text_alloc( bodies * sizeof *out->bodies );
    out->samples = text_alloc( rows * bodies * sizeof *out->samples );
    out->times = text_alloc( rows * sizeof *out->times );
    wisp_vec3* points = text_alloc( (size_t)scene_world_vertices( &world ) * sizeof *points );
    status = sample_start( scene, out, points, error );
    if ( status == WISP_OK )
    {
        make_steps( &world, out, points );
        finish_bodies( &world, out, points );
    }
    free( points );
    scene_world_destroy( &world );
    return status;
}

void stability_trace_release( stability_trace* trace )
{
    free( trace->bodies );
    free( trace->samples );
    free( trace->times );
    *trace = ( stability_trace ){ 0 };
}
