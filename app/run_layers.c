#include "run_layers.h"

#include "mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    ROWS_MAX = 1000, // steps of a run that get a row of their own
    NUMBER_ROOM = 32,
};

/// Results of one step, over all layers and all participants.
typedef struct sample
{
    int step; ///< counted from 1
    int64_t points, edge_points, elements, changed;
    bool has_contact;
    wisp_contact_stats contact;
} sample;

struct run_layers
{
    scene_world* world;
    const char* file;
    int every;
    int layer_count;  ///< surfaces with boundary particles
    bool has_contact; ///< statistics of contact are requested

    sample* samples; ///< [sample_count] of steps that get a row
    int sample_count;
    int stride; ///< steps between two of them
    sample last;

    // Over all steps.
    int64_t elements, changed;
    int max_contacts;
    float min_gap;
    int64_t limited;

    wisp_vec3 *points, *normals; ///< of the largest surface that is written; null unless files are
    char* path;                  ///< room for the longest name
    size_t path_room;
    int written;
};

static wisp_status no_memory( const run_layers* l, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for layer statistics", l->world->scene->name );
}

// ---- opening ----

static int count_layers( const wisp_scene* scene )
{
    int count = 0;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        count += scene->surfaces[i].has_boundary;
    }
    return count;
}

/// Allocate the arrays and the file name, and request what the file holds.
static wisp_status prepare_files( run_layers* l, wisp_error* error )
{
    const wisp_scene* scene = l->world->scene;
    int most = 0;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < scene->surface_count && status == WISP_OK; ++i )
    {
        const int body = scene->strands_count + i;
        const int count = scene->surfaces[i].has_boundary ? scene_world_body( l->world, body ).vertex_count : 0;
        most = count > most ? count : most;
        status = count > 0 ? scene_world_request( l->world, body, SCENE_REQUEST_POINTS, error ) : WISP_OK;
        status = status == WISP_OK && count > 0 ? scene_world_request( l->world, body, SCENE_REQUEST_NORMALS, error )
                                                : status;
    }
    if ( status != WISP_OK )
    {
        return status;
    }
    l->points = malloc( (size_t)most * sizeof *l->points + 1 );
    l->normals = malloc( (size_t)most * sizeof *l->normals + 1 );
    l->path_room = strlen( l->file ) + WISP_SCENE_MAX_NAME + NUMBER_ROOM;
    l->path = malloc( l->path_room );
    return l->points && l->normals && l->path ? WISP_OK : no_memory( l, error );
}

static wisp_status prepare( run_layers* l, int steps, wisp_error* error )
{
    if ( l->file && l->layer_count == 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "--boundary: %s has no surface with the key 'boundary', expected at least one",
                          l->world->scene->name );
    }
    l->stride = ( steps + ROWS_MAX - 1 ) / ROWS_MAX;
    l->stride = l->stride > 1 ? l->stride : 1;
    l->samples = calloc( (size_t)( steps / l->stride ) + 1, sizeof *l->samples );
    if ( !l->samples )
    {
        return no_memory( l, error );
    }
    return l->file ? prepare_files( l, error ) : WISP_OK;
}

wisp_status run_layers_open( const run_layers_def* def, scene_world* world, int steps, run_layers** out,
                             wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    const int layer_count = count_layers( scene );
    const bool has_contact = scene->request_contact_stats || scene->request_intersections;
    *out = NULL;
    if ( layer_count == 0 && !has_contact && !def->file )
    {
        return WISP_OK;
    }
    run_layers* l = calloc( 1, sizeof *l );
    if ( !l )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "run: out of memory for layer statistics" );
    }
    l->world = world;
    l->file = def->file;
    l->every = def->every;
    l->layer_count = layer_count;
    l->has_contact = has_contact;
    l->min_gap = INFINITY;
    wisp_status status = prepare( l, steps, error );
    if ( status != WISP_OK )
    {
        run_layers_close( l );
        return status;
    }
    *out = l;
    return WISP_OK;
}

void run_layers_close( run_layers* l )
{
    if ( l )
    {
        free( l->samples );
        free( l->points );
        free( l->normals );
        free( l->path );
        free( l );
    }
}

// ---- files ----

/// FILE_0002.ply, or FILE_ball_0002.ply where there are several. The number is that of the frame in a recording.
static void name_file( run_layers* l, int surface, int number )
{
    const int stem = (int)( strlen( l->file ) - strlen( ".ply" ) );
    if ( l->layer_count > 1 )
    {
        snprintf( l->path, l->path_room, "%.*s_%s_%04d.ply", stem, l->file, l->world->scene->surfaces[surface].name,
                  number );
        return;
    }
    snprintf( l->path, l->path_room, "%.*s_%04d.ply", stem, l->file, number );
}

static wisp_status write_layer( run_layers* l, int surface, wisp_error* error )
{
    const int body_number = l->world->scene->strands_count + surface;
    const scene_body body = scene_world_body( l->world, body_number );
    wisp_boundary_view view;
    wisp_status status = scene_world_layer( l->world, surface, &view, error );
    status = status == WISP_OK ? scene_world_points( l->world, body_number, l->points, error ) : status;
    status = status == WISP_OK ? scene_world_normals( l->world, body_number, l->normals, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    WISP_ASSERT( view.samples->normals || view.samples->count == 0 );
    // The writer does not change the mesh; there is no read-only type.
    const wisp_mesh mesh = { .points = l->points,
                             .triangles = (int32_t*)(uintptr_t)body.triangles,
                             .vertex_count = body.vertex_count,
                             .triangle_count = body.triangle_count };
    const wisp_mesh_layer layer = {
        .normals = l->normals,
        .edges = view.edges,
        .edge_count = view.edge_count,
        .points = view.samples->xyzw,
        .point_normals = view.samples->normals,
        .point_count = view.samples->count,
    };
    name_file( l, surface, l->world->next_step / l->every + 1 );
    status = wisp_mesh_write_layer( l->path, &mesh, &layer, error );
    l->written += status == WISP_OK;
    return status;
}

// ---- a step ----

static wisp_status add_layer( run_layers* l, int surface, sample* s, wisp_error* error )
{
    wisp_boundary_stats f;
    wisp_status status = wisp_read_boundary_stats( l->world->world, l->world->surfaces[surface].entity, &f );
    if ( status != WISP_OK )
    {
        return wisp_fail( error, status, "%s: '%s': %s", l->world->scene->name,
                          l->world->scene->surfaces[surface].name, wisp_world_message( l->world->world ) );
    }
    s->points += f.points;
    s->edge_points += f.edge_points;
    s->elements += f.elements;
    s->changed += f.changed_elements;
    return WISP_OK;
}

static void add_contact( run_layers* l, sample* s )
{
    // Without participants there are no statistics. The summary says so.
    s->has_contact = l->has_contact && wisp_read_contact_stats( l->world->world, &s->contact ) == WISP_OK;
    if ( s->has_contact )
    {
        l->max_contacts = s->contact.contacts > l->max_contacts ? s->contact.contacts : l->max_contacts;
        l->min_gap = fminf( l->min_gap, s->contact.min_gap );
        l->limited += s->contact.displacement_limited;
    }
}

wisp_status run_layers_step( run_layers* l, wisp_error* error )
{
    if ( !l )
    {
        return WISP_OK;
    }
    const wisp_scene* scene = l->world->scene;
    const int step = l->world->next_step;
    sample s = { .step = step };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < scene->surface_count && status == WISP_OK; ++i )
    {
        status = scene->surfaces[i].has_boundary ? add_layer( l, i, &s, error ) : WISP_OK;
        if ( status == WISP_OK && scene->surfaces[i].has_boundary && l->file && step % l->every == 0 )
        {
            status = write_layer( l, i, error );
        }
    }
    add_contact( l, &s );
    l->elements += s.elements;
    l->changed += s.changed;
    l->last = s;
    if ( step % l->stride == 0 )
    {
        l->samples[l->sample_count++] = s;
    }
    return status;
}

// ---- the summary ----

static double fraction_of( int64_t part, int64_t whole )
{
    return whole > 0 ? (double)part / (double)whole : 0.0;
}

static void put_sample( const run_layers* l, const sample* s, results_values* values )
{
    if ( l->layer_count > 0 )
    {
        results_put( values, "boundary_points", (double)s->points );
        results_put( values, "boundary_edge_points", (double)s->edge_points );
        results_put( values, "boundary_changed_fraction", fraction_of( s->changed, s->elements ) );
    }
    if ( s->has_contact )
    {
        results_put( values, "contacts", s->contact.contacts );
        results_put( values, "contact_limited", s->contact.displacement_limited );
        results_put( values, "contact_impulse", s->contact.impulse );
        // Without a near pair there is no gap, and intersections are counted on request only.
        if ( isfinite( s->contact.min_gap ) )
        {
            results_put( values, "contact_min_gap", (double)s->contact.min_gap );
        }
        if ( s->contact.intersections >= 0 )
        {
            results_put( values, "contact_intersections", s->contact.intersections );
        }
    }
}

void run_layers_put( const run_layers* l, results_values* values )
{
    if ( l && l->last.step > 0 )
    {
        put_sample( l, &l->last, values );
    }
    if ( l && l->elements > 0 )
    {
        results_put( values, "boundary_changed_fraction_of_run", fraction_of( l->changed, l->elements ) );
    }
}

static void tell_layer( const run_layers* l, int surface, results* out )
{
    const wisp_scene_surface* entry = &l->world->scene->surfaces[surface];
    wisp_boundary_stats f;
    if ( wisp_read_boundary_stats( l->world->world, l->world->surfaces[surface].entity, &f ) != WISP_OK )
    {
        return;
    }
    results_add_note( out, "%s: %d boundary points: %d on edges, %d in triangles; resampled %.1f %% of %d elements",
                      entry->name, f.points, f.edge_points, f.inner_points,
                      100.0 * fraction_of( f.changed_elements, f.elements ), f.elements );
    if ( f.refused )
    {
        results_add_note( out, "%s: got %.0f boundary points, expected at most %d: the previous points were kept",
                          entry->name, f.requested, entry->boundary.max_points );
    }
    if ( f.skipped_elements > 0 )
    {
        results_add_note( out, "%s: %d elements without boundary points, because a corner is not finite", entry->name,
                          f.skipped_elements );
    }
}

static void tell_contact( const run_layers* l, results* out )
{
    const wisp_contact_stats* f = &l->last.contact;
    if ( !l->last.has_contact )
    {
        results_add_note( out, "contact: no entity takes part" );
        return;
    }
    char gap[80] = "no near pair";
    if ( isfinite( l->min_gap ) )
    {
        snprintf( gap, sizeof gap, "min gap %.4f thicknesses", (double)l->min_gap );
    }
    results_add_note( out, "contact: %d entities, up to %d active pairs, %s, %lld displacements limited",
                      f->participants, l->max_contacts, gap, (long long)l->limited );
    char intersections[60] = "";
    if ( f->intersections >= 0 )
    {
        snprintf( intersections, sizeof intersections, ", %d intersections", f->intersections );
    }
    results_add_note( out, "contact, last step: %d active pairs%s, impulses %.3e N s, sum %.1e N s", f->contacts,
                      intersections, f->impulse,
                      sqrt( f->net_impulse[0] * f->net_impulse[0] + f->net_impulse[1] * f->net_impulse[1] +
                            f->net_impulse[2] * f->net_impulse[2] ) );
}

void run_layers_report( const run_layers* l, results* out )
{
    if ( !l || l->last.step == 0 )
    {
        return;
    }
    const char* slash = strrchr( l->world->scene->name, '/' );
    for ( int i = 0; i < l->sample_count; ++i )
    {
        char variant[NUMBER_ROOM];
        snprintf( variant, sizeof variant, "step %d", l->samples[i].step );
        results_row* row = results_add_row( out, slash ? slash + 1 : l->world->scene->name, variant );
        if ( row )
        {
            row->workers = wisp_world_workers( l->world->world );
            put_sample( l, &l->samples[i], &row->size );
        }
    }
    for ( int i = 0; i < l->world->scene->surface_count; ++i )
    {
        if ( l->world->scene->surfaces[i].has_boundary )
        {
            tell_layer( l, i, out );
        }
    }
    if ( l->layer_count > 0 )
    {
        results_add_note( out, "boundary points, whole run: %.2f %% of the elements were resampled per step",
                          100.0 * fraction_of( l->changed, l->elements ) );
    }
    if ( l->has_contact )
    {
        tell_contact( l, out );
    }
    if ( l->file )
    {
        results_add_note( out, "boundary points written: %d files, the last is %s", l->written,
                          l->written > 0 ? l->path : "none" );
    }
}
