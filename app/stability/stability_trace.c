#include "stability_parts.h"

#include "interruption.h"
#include "text_tree.h"
#include "wisp/module/components.h"
#include "wisp/module/random.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- samples ----

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

static bool is_layer_finite( const scene_world* world, int surface )
{
    wisp_boundary_view view;
    bool is_finite = scene_world_layer( world, surface, &view, NULL ) == WISP_OK;
    for ( int i = 0; is_finite && i < view.samples->count * 4; ++i )
    {
        is_finite = i % 4 == 3 || isfinite( view.samples->xyzw[i] );
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
        sample->contacts = stats.contacts;
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

// @param readers [body_count]
static void read_all( const scene_world* world, stability_reader* const* readers, stability_trace* trace, int row )
{
    const double dt = row > 0 ? trace->times[row] - trace->times[row - 1] : 0.0;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        stability_sample* sample = stability_sample_of( trace, row, body );
        // a step however short moves what starts away from its rest shape
        sample->is_finite |= row == 0 && trace->bodies[body].starts_away;
        stability_read( readers[body], world, &trace->bodies[body], dt, sample );
    }
    for ( int i = 0; i < world->scene->surface_count && row > 0; ++i )
    {
        stability_sample* sample = stability_sample_of( trace, row, world->scene->strands_count + i );
        sample->is_finite &= !world->scene->surfaces[i].has_boundary || is_layer_finite( world, i );
    }
}

// ---- the end ----

static double stretch_of_edge( const wisp_vec3* now, const wisp_vec3* rest, int a, int b )
{
    const double length = stability_distance( rest[a], rest[b] );
    return length > 0.0 ? stability_distance( now[a], now[b] ) / length - 1.0 : 0.0;
}

static double find_depth( const stability_reader* r, const wisp_vec3* start, double extent )
{
    double lowest = INFINITY, highest = -INFINITY;
    for ( int i = 0; i < r->count; ++i )
    {
        lowest = fmin( lowest, (double)r->now[i].y );
        highest = fmax( highest, (double)start[i].y );
    }
    return extent > 0.0 ? ( highest - lowest ) / extent : 0.0;
}

static void read_end( const scene_world* world, stability_trace* trace )
{
    for ( int body = 0; body < trace->body_count; ++body )
    {
        uint64_t hash = 0;
        const bool is_strands = body < world->scene->strands_count;
        (void)wisp_world_hash_column( world->world, scene_world_entity( world, body ),
                                      is_strands ? WISP_STRAND_POINTS : WISP_SURFACE_POINTS, &hash );
        trace->hash = body > 0 ? wisp_random_mix( trace->hash ^ hash ) : hash;
    }
    trace->resets = wisp_world_counter( world->world, WISP_COUNT_STRAND_RESET );
    trace->not_converged = wisp_world_counter( world->world, WISP_COUNT_NOT_CONVERGED );
    trace->degenerate = wisp_world_counter( world->world, WISP_COUNT_DEGENERATE_LINK );
}

static void finish_bodies( const scene_world* world, stability_reader* const* readers, stability_trace* trace )
{
    for ( int body = 0; body < trace->body_count; ++body )
    {
        stability_body* b = &trace->bodies[body];
        const stability_reader* r = readers[body];
        b->is_halted = wisp_is_halted( world->world, scene_world_entity( world, body ) );
        for ( int i = 0; i < r->edge_count; ++i )
        {
            b->stretch = fmax( b->stretch, stretch_of_edge( r->now, r->rest, r->edges[2 * i], r->edges[2 * i + 1] ) );
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
static void make_steps( scene_world* world, stability_reader* const* readers, stability_trace* trace,
                        wisp_vec3* points )
{
    const int steps = world->scene->steps;
    const bool counts = scene_has_contact( world->scene ), counts_all = counts && world->scene->request_intersections;
    wisp_error error = { 0 };
    for ( int step = 0;
          step < steps && trace->status == WISP_OK && is_finite_row( trace, step ) && !interruption_came(); ++step )
    {
        const bool is_end = step == 0 || step + 1 == steps;
        if ( counts && !counts_all && ( step < 2 || is_end ) )
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
        read_all( world, readers, trace, step + 1 );
        trace->intersections_before =
            step == 0 && counts ? count_intersections( world ) : trace->intersections_before;
        trace->intersections_after = is_end && counts ? count_intersections( world ) : -1;
        const int now = step > 0 && counts_all ? count_intersections( world ) : -1;
        trace->intersections_most = now > trace->intersections_most ? now : trace->intersections_most;
    }
}

wisp_status stability_trace_run( wisp_scene* scene, stability_trace* out, wisp_error* error )
{
    const size_t bodies = (size_t)scene->strands_count + (size_t)scene->surface_count;
    const size_t rows = (size_t)scene->steps + 1;
    *out = ( stability_trace ){
        .body_count = (int)bodies, .intersections_before = -1, .intersections_after = -1, .intersections_most = -1
    };
    scene_request_statistics( scene );
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
    stability_reader** readers = text_alloc( bodies * sizeof *readers );
    status = sample_start( scene, out, points, error );
    if ( status == WISP_OK )
    {
        for ( size_t body = 0; body < bodies; ++body )
        {
            readers[body] = stability_reader_make( &world, (int)body );
        }
        read_all( &world, readers, out, 0 );
        wisp_vec3* start = text_alloc( bodies > 0 ? (size_t)readers[0]->count * sizeof *start : 1 );
        memcpy( start, bodies > 0 ? readers[0]->now : start,
                bodies > 0 ? (size_t)readers[0]->count * sizeof *start : 0 );
        make_steps( &world, readers, out, points );
        finish_bodies( &world, readers, out );
        read_end( &world, out );
        out->depth = bodies > 0 ? find_depth( readers[0], start, out->bodies[0].extent ) : 0.0;
        free( start );
    }
    for ( size_t body = 0; body < bodies; ++body )
    {
        stability_reader_free( readers[body] );
    }
    free( readers );
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
