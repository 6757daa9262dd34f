#include "run_motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

// ---- statistics ----

static bool is_requested( const scene_world* world, int body )
{
    const wisp_scene* scene = world->scene;
    return body < scene->strands_count ? scene->strands[body].request_motion_stats
                                       : scene->surfaces[body - scene->strands_count].request_motion_stats;
}

static void add_body( results* out, int table, const char* name, const wisp_motion_stats* m )
{
    const double values[] = {
        m->mass,      m->kinetic_energy, m->potential_energy, 100.0 * m->strain_mean, 100.0 * m->strain_max,
        m->speed_max, m->volume
    };
    char text[WISP_COUNT( values )][24];
    const char* cells[WISP_COUNT( values ) + 1] = { name };
    for ( int i = 0; i < WISP_COUNT( values ); ++i )
    {
        snprintf( text[i], sizeof( text[i] ), "%.4g", values[i] );
        cells[i + 1] = text[i];
    }
    results_add_cells( out, table, cells );
}

void run_motion_add_table( const scene_world* world, results* out )
{
    int table = -1;
    for ( int body = 0; body < scene_world_moving_count( world ); ++body )
    {
        wisp_motion_stats m;
        wisp_error error;
        if ( is_requested( world, body ) == false || scene_world_motion_stats( world, body, &m, &error ) != WISP_OK )
        {
            continue;
        }
        if ( table < 0 )
        {
            table =
                results_add_table( out, "Motion at the end", 8,
                                   ( const char* const[] ){ "body", "mass kg", "kinetic J", "potential J",
                                                            "strain % mean", "% max", "speed m/s", "volume m3" } );
        }
        add_body( out, table, scene_world_body( world, body ).name, &m );
    }
}

// ---- level of detail ----

static bool has_event( const wisp_scene* scene, int body )
{
    bool found = false;
    for ( int i = 0; i < scene->event_count; ++i )
    {
        const wisp_scene_event* e = &scene->events[i];
        const int of = e->strands >= 0 ? e->strands : scene->strands_count + e->surface;
        found = found || ( e->has_detail && of == body );
    }
    return found;
}

void run_motion_add_detail( const scene_world* world, results* out )
{
    static const char* const LEVELS[WISP_DETAIL_COUNT] = { "full", "fewer substeps", "coarse", "nothing" };
    const wisp_scene* scene = world->scene;
    int table = -1;
    for ( int body = 0; body < scene->strands_count + scene->surface_count; ++body )
    {
        const int surface = body - scene->strands_count;
        const bool is_set = surface < 0 ? scene->strands[body].has_detail : scene->surfaces[surface].has_detail;
        if ( is_set == false && has_event( scene, body ) == false )
        {
            continue;
        }
        if ( table < 0 )
        {
            table = results_add_table( out, "Level of detail at the end", 3,
                                       ( const char* const[] ){ "body", "level", "substeps" } );
        }
        const wisp_entity entity = scene_world_entity( world, body );
        int substeps;
        char text[24];
        const bool is_known = wisp_read_substeps( world->world, entity, &substeps ) == WISP_OK;
        snprintf( text, sizeof( text ), "%d", is_known ? substeps : 0 );
        results_add_cells(
            out, table,
            ( const char* const[] ){ surface < 0 ? scene->strands[body].name : scene->surfaces[surface].name,
                                     LEVELS[wisp_detail_of( world->world, entity )], text } );
    }
}

// ---- stretch ----

typedef struct stretch_sums
{
    double stretch; // of all edges that are longer than at rest
    int count;      // of all edges
} stretch_sums;

static double distance( wisp_vec3 a, wisp_vec3 b )
{
    const double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
    return sqrt( x * x + y * y + z * z );
}

static void add_edge( stretch_sums* sums, const wisp_vec3* now, const wisp_vec3* rest, int a, int b )
{
    const double length = distance( rest[a], rest[b] );
    sums->stretch += length > 0.0 ? fmax( distance( now[a], now[b] ) / length - 1.0, 0.0 ) : 0.0;
    sums->count += 1;
}

// Inner edges of a surface count twice.
static double stretch_of( const scene_body* body, const wisp_vec3* now, const wisp_vec3* rest )
{
    stretch_sums sums = { 0.0, 0 };
    for ( int i = 0; i < 3 * body->triangle_count; ++i )
    {
        const int first = i - i % 3;
        add_edge( &sums, now, rest, body->triangles[i], body->triangles[first + ( i + 1 ) % 3] );
    }
    for ( int s = 0; s < body->strand_count; ++s )
    {
        for ( int v = body->offsets[s] + 1; v < body->offsets[s + 1]; ++v )
        {
            add_edge( &sums, now, rest, v - 1, v );
        }
    }
    return sums.count > 0 ? sums.stretch / sums.count : 0.0;
}

// Return the rest shape of a body that keeps its lengths by projection or by springs; null of others.
static const wisp_vec3* rest_of( const scene_world* world, int body )
{
    const wisp_scene* scene = world->scene;
    if ( body < scene->strands_count )
    {
        return scene->strands[body].has_dynamics ? world->grooms[body].points : NULL;
    }
    const int surface = body - scene->strands_count;
    const wisp_scene_surface* entry = scene->surfaces + surface;
    const bool keeps_lengths = ( entry->has_cloth && !entry->has_membrane ) || entry->has_implicit;
    return keeps_lengths ? world->surfaces[surface].mesh.points : NULL;
}

// Return the mean stretch from what the scene computes, its points or its statistics; 0 if it computes neither.
static double find_stretch( const scene_world* world, int b, const scene_body* body )
{
    const wisp_vec3* rest = rest_of( world, b );
    wisp_vec3* now = rest != NULL ? calloc( (size_t)body->vertex_count + 1, sizeof( *now ) ) : NULL;
    wisp_error error;
    wisp_motion_stats m;
    double stretch = 0.0;
    if ( now != NULL && scene_world_points( world, b, now, &error ) == WISP_OK )
    {
        stretch = stretch_of( body, now, rest );
    }
    else if ( now != NULL && is_requested( world, b ) && scene_world_motion_stats( world, b, &m, &error ) == WISP_OK )
    {
        stretch = m.strain_mean;
    }
    free( now );
    return stretch;
}

static void add_hold_note( const scene_world* world, int b, const char* name, results* out )
{
    wisp_strand_hold hold;
    if ( scene_world_strand_hold( world, b, &hold, NULL ) == WISP_OK && hold.sagging > 0 )
    {
        results_add_note( out,
                          "%s: %d strands are too soft for their shape and sag; the softest holds it up to %.3g m, "
                          "or with bend_rigidity: %.2g",
                          name, (int)hold.sagging, (double)hold.max_length, (double)hold.bend_rigidity );
    }
}

void run_motion_add_warnings( const scene_world* world, results* out )
{
    const double TOO_LONG = 0.1;
    for ( int b = 0; b < scene_world_moving_count( world ); ++b )
    {
        const scene_body body = scene_world_body( world, b );
        add_hold_note( world, b, body.name, out );
        const double stretch = find_stretch( world, b, &body );
        if ( stretch > TOO_LONG )
        {
            results_add_note( out, "%s is stretched by %.0f %%; more than %d substeps keep lengths better", body.name,
                              100.0 * stretch, scene_world_substeps( world, b ) );
        }
    }
}
