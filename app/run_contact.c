#include "run_contact.h"

#include "io_file.h"
#include "mesh.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- boundary particles and contact ----

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

static wisp_status no_contact_memory( wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "run: out of memory for statistics of contact" );
}

typedef struct run_layers
{
    scene_world* world;
    const char* file;
    int every;
    int layer_count;  ///< surfaces with boundary particles
    bool has_contact; ///< statistics of contact are requested

    sample* samples; ///< [sample_count] of steps that get a row
    int sample_count;
    int stride; ///< steps between two of them; 0: there is nothing to report or to write
    sample last;

    // Over all steps.
    int64_t elements, changed;
    int max_contacts;
    float min_gap;
    int64_t limited, outran;

    wisp_vec3 *points, *normals; ///< of the largest surface that is written; null unless files are
    char* path;                  ///< room for the longest name
    size_t path_room;
    int written;
} run_layers;

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
static wisp_status prepare_files( run_layers* l, io_memory* memory, wisp_error* error )
{
    const wisp_scene* scene = l->world->scene;
    int most = 0;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        const int body = scene->strands_count + i;
        const int count = scene->surfaces[i].has_boundary ? scene_world_body( l->world, body ).vertex_count : 0;
        most = count > most ? count : most;
        WISP_TRY( count > 0 ? scene_world_request( l->world, body, SCENE_REQUEST_POINTS, error ) : WISP_OK );
        WISP_TRY( count > 0 ? scene_world_request( l->world, body, SCENE_REQUEST_NORMALS, error ) : WISP_OK );
    }
    l->points = io_get( memory, (size_t)most * sizeof *l->points );
    l->normals = io_get( memory, (size_t)most * sizeof *l->normals );
    l->path_room = strlen( l->file ) + WISP_SCENE_MAX_NAME + NUMBER_ROOM;
    l->path = io_get( memory, l->path_room );
    return WISP_OK;
}

static wisp_status open_layers( const run_contact_def* def, scene_world* world, int steps, io_memory* memory,
                                run_layers* l, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    *l = ( run_layers ){
        .world = world,
        .file = def->file,
        .every = def->every,
        .layer_count = count_layers( scene ),
        .has_contact = scene->request_contact_stats || scene->request_intersections,
        .min_gap = INFINITY,
    };
    if ( l->layer_count == 0 && !l->has_contact && !def->file )
    {
        return WISP_OK;
    }
    if ( l->file && l->layer_count == 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "--boundary: %s has no surface with the key 'boundary', expected at least one",
                          scene->name );
    }
    l->stride = ( steps + ROWS_MAX - 1 ) / ROWS_MAX;
    l->stride = l->stride > 1 ? l->stride : 1;
    l->samples = io_get( memory, ( (size_t)( steps / l->stride ) + 1 ) * sizeof *l->samples );
    return l->file ? prepare_files( l, memory, error ) : WISP_OK;
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
    WISP_TRY( scene_world_layer( l->world, surface, &view, error ) );
    WISP_TRY( scene_world_points( l->world, body_number, l->points, error ) );
    WISP_TRY( scene_world_normals( l->world, body_number, l->normals, error ) );
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
    wisp_status status = wisp_mesh_write_layer( l->path, &mesh, &layer, error );
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
        l->outran += s->contact.outran;
    }
}

static wisp_status step_layers( run_layers* l, wisp_error* error )
{
    const wisp_scene* scene = l->world->scene;
    const int step = l->world->next_step;
    sample s = { .step = step };
    if ( l->stride == 0 )
    {
        return WISP_OK;
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        WISP_TRY( scene->surfaces[i].has_boundary ? add_layer( l, i, &s, error ) : WISP_OK );
        if ( scene->surfaces[i].has_boundary && l->file && step % l->every == 0 )
        {
            WISP_TRY( write_layer( l, i, error ) );
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
    return WISP_OK;
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
        results_put( values, "contact_outran", s->contact.outran );
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

static void put_layers( const run_layers* l, results_values* values )
{
    if ( l->last.step > 0 )
    {
        put_sample( l, &l->last, values );
    }
    if ( l->elements > 0 )
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
    const bool is_exact = l->world->scene->contact.level == WISP_CONTACT_EXACT;
    results_add_note( out, "contact: %d entities, up to %d active pairs, %s, %lld %s", f->participants,
                      l->max_contacts, gap, (long long)( is_exact ? l->limited : l->outran ),
                      is_exact ? "displacements limited" : "times a point left the margin of the search" );
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

static void report_layers( const run_layers* l, results* out )
{
    if ( l->last.step == 0 )
    {
        return;
    }
    for ( int i = 0; i < l->sample_count; ++i )
    {
        char variant[NUMBER_ROOM];
        snprintf( variant, sizeof variant, "step %d", l->samples[i].step );
        results_row* row = results_add_row( out, io_file_name( l->world->scene->name ), variant );
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

// ---- collision ----

typedef struct body_record
{
    int body;                           ///< of the scene's world
    int step;                           ///< of `deepest`, counted from 1; 0: nothing was too near to a collider
    wisp_collision_stats deepest, last; ///< of the run; of the last step
} body_record;

/// What participants give to a collider.
typedef struct reaction_record
{
    int collider;
    double impulse[3]; ///< N s, of the run
    double largest;    ///< N, of a step: impulse over its length
    int step;          ///< of the largest, counted from 1; 0: there was none
} reaction_record;

typedef struct run_collision
{
    scene_world* world;
    body_record* bodies; ///< [count]
    int count;
    reaction_record* reactions; ///< [reaction_count]
    int reaction_count;
    double seconds; ///< that were simulated
} run_collision;

// ---- reading ----

static bool has_contacts( const wisp_scene* scene, int body )
{
    return body < scene->strands_count ? scene->strands[body].request_contacts
                                       : scene->surfaces[body - scene->strands_count].request_contacts;
}

static void open_collision( scene_world* world, io_memory* memory, run_collision* c )
{
    const int body_count = scene_world_moving_count( world ), collider_count = world->scene->collider_count;
    *c = ( run_collision ){
        .world = world,
        .bodies = io_get( memory, (size_t)body_count * sizeof *c->bodies ),
        .reactions = io_get( memory, (size_t)collider_count * sizeof *c->reactions ),
    };
    for ( int i = 0; i < collider_count && !memory->is_short; ++i )
    {
        if ( world->scene->colliders[i].request_reaction )
        {
            c->reactions[c->reaction_count++].collider = i;
        }
    }
    for ( int body = 0; body < body_count && !memory->is_short; ++body )
    {
        if ( has_contacts( world->scene, body ) )
        {
            c->bodies[c->count++].body = body;
        }
    }
}

static wisp_status add_reactions( run_collision* c, wisp_error* error )
{
    const scene_world* world = c->world;
    const double seconds = (double)wisp_scene_step_length( world->scene, world->next_step - 1 );
    c->seconds += seconds;
    for ( int i = 0; i < c->reaction_count; ++i )
    {
        reaction_record* r = &c->reactions[i];
        wisp_reaction now;
        const wisp_status status = wisp_read_reaction( world->world, world->colliders[r->collider].entity, &now );
        if ( status != WISP_OK )
        {
            return wisp_fail( error, status, "%s: %s", world->scene->name, wisp_world_message( world->world ) );
        }
        const double p[3] = { (double)now.impulse.x, (double)now.impulse.y, (double)now.impulse.z };
        const double force = sqrt( p[0] * p[0] + p[1] * p[1] + p[2] * p[2] ) / seconds;
        for ( int k = 0; k < 3; ++k )
        {
            r->impulse[k] += p[k];
        }
        r->step = force > r->largest ? world->next_step : r->step;
        r->largest = fmax( r->largest, force );
    }
    return WISP_OK;
}

static wisp_status step_collision( run_collision* c, wisp_error* error )
{
    for ( int i = 0; i < c->count; ++i )
    {
        body_record* b = &c->bodies[i];
        WISP_TRY( scene_world_collision_stats( c->world, b->body, &b->last, error ) );
        if ( b->last.vertex >= 0 && ( b->step == 0 || b->last.penetration > b->deepest.penetration ) )
        {
            b->deepest = b->last;
            b->step = c->world->next_step;
        }
    }
    return add_reactions( c, error );
}

// ---- the summary ----

static void put_collision( const run_collision* c, results_values* values )
{
    float deepest = 0.0f;
    for ( int i = 0; i < c->count; ++i )
    {
        const body_record* b = &c->bodies[i];
        deepest = b->step > 0 && b->deepest.penetration > deepest ? b->deepest.penetration : deepest;
    }
    if ( c->count > 0 )
    {
        results_put( values, "collision_penetration", (double)deepest );
    }
}

// Vertices keep the thickness; those of an implicit cloth may be within it, and their penetration is below the surface.
static double depth_below_surface( const run_collision* collision, const body_record* b )
{
    const int surface = b->body - collision->world->scene->strands_count;
    const bool is_implicit = surface >= 0 && collision->world->scene->surfaces[surface].has_implicit;
    return (double)b->deepest.penetration - ( is_implicit ? 0.0 : (double)b->deepest.thickness );
}

static void add_collision_body( const run_collision* collision, const body_record* b, int table, results* out )
{
    const char* name = scene_world_body( collision->world, b->body ).name;
    const double deepest = 1e3 * (double)b->deepest.penetration;
    const double last = b->last.vertex >= 0 ? 1e3 * (double)b->last.penetration : 0.0;
    if ( b->step > 0 )
    {
        results_add_line( out, table, "%s\t%.4g\t%.4g\t%d\t%d\t%.4g\t%d", name, deepest,
                          1e3 * (double)b->deepest.thickness, b->deepest.vertex, b->step, last, b->last.contacts );
    }
    else
    {
        results_add_line( out, table, "%s\t%.4g\t\t\t\t%.4g\t%d", name, deepest, last, b->last.contacts );
    }
}

static void report_reactions( const run_collision* c, results* out )
{
    const int table = results_begin_table( out, "Reaction of colliders, mean force of the run and largest of a step",
                                           "collider\tmean x N\tmean y N\tmean z N\tlargest N\tstep" );
    for ( int i = 0; i < c->reaction_count; ++i )
    {
        const reaction_record* r = &c->reactions[i];
        const char* name = c->world->scene->colliders[r->collider].name;
        results_add_line( out, table, r->step > 0 ? "%s\t%.4g\t%.4g\t%.4g\t%.4g\t%d" : "%s\t%.4g\t%.4g\t%.4g\t%.4g\t",
                          name, r->impulse[0] / c->seconds, r->impulse[1] / c->seconds, r->impulse[2] / c->seconds,
                          r->largest, r->step );
    }
}

static void report_collision( const run_collision* collision, results* out )
{
    if ( collision->reaction_count > 0 )
    {
        report_reactions( collision, out );
    }
    if ( collision->count == 0 )
    {
        return;
    }
    const int table = results_begin_table( out, "Penetration into the thickness, deepest of the run and at the end",
                                           "body\tdeepest mm\tthickness mm\tvertex\tstep\tend mm\tcontacts" );
    for ( int i = 0; i < collision->count; ++i )
    {
        const body_record* b = &collision->bodies[i];
        add_collision_body( collision, b, table, out );
        const double below = depth_below_surface( collision, b );
        if ( b->step > 0 && below > 0.0 )
        {
            results_add_note( out, "%s: vertex %d was %.3g mm below the surface of a collider in step %d",
                              scene_world_body( collision->world, b->body ).name, b->deepest.vertex, 1e3 * below,
                              b->step );
        }
    }
}

// ---- intersections ----

/// Intersections of some entities in the steps of a run.
typedef struct tally
{
    int first, second; ///< bodies of the scene's world; the same: of a body with itself
    int steps;         ///< that ended with any
    int most, most_at; ///< the most of a step, and that step, counted from 1
    int last, last_at; ///< of the last step that ended with any, and that step
} tally;

typedef struct run_intersections
{
    scene_world* world;
    tally all;
    tally* pairs; ///< [pair_count] that ever intersected, in the order of that
    int pair_count, pair_room;
    int steps; ///< that were counted
} run_intersections;

// ---- reading ----

static bool takes_part( const wisp_scene* scene, int body )
{
    return body < scene->strands_count ? scene->strands[body].has_contact
                                       : scene->surfaces[body - scene->strands_count].has_contact;
}

static void add_count( tally* t, int count, int step )
{
    t->steps += 1;
    t->most_at = count > t->most ? step : t->most_at;
    t->most = count > t->most ? count : t->most;
    t->last = count;
    t->last_at = step;
}

// Of two bodies; made if they have none yet. @return null without memory
static tally* find_tally( run_intersections* x, int first, int second )
{
    for ( int i = 0; i < x->pair_count; ++i )
    {
        if ( x->pairs[i].first == first && x->pairs[i].second == second )
        {
            return &x->pairs[i];
        }
    }
    if ( x->pair_count == x->pair_room )
    {
        const int room = 2 * x->pair_room + 8;
        tally* grown = realloc( x->pairs, (size_t)room * sizeof *grown );
        if ( grown == NULL )
        {
            return NULL;
        }
        x->pairs = grown;
        x->pair_room = room;
    }
    x->pairs[x->pair_count] = ( tally ){ .first = first, .second = second };
    return &x->pairs[x->pair_count++];
}

static wisp_status add_pair( run_intersections* x, int first, int second, int* left, wisp_error* error )
{
    wisp_world* world = x->world->world;
    int count = 0;
    const wisp_status status = wisp_read_contact_intersections( world, scene_world_entity( x->world, first ),
                                                                scene_world_entity( x->world, second ), &count );
    if ( status != WISP_OK || count == 0 )
    {
        return status == WISP_OK
                   ? WISP_OK
                   : wisp_fail( error, status, "%s: %s", x->world->scene->name, wisp_world_message( world ) );
    }
    tally* pair = find_tally( x, first, second );
    if ( pair == NULL )
    {
        return no_contact_memory( error );
    }
    add_count( pair, count, x->world->next_step );
    *left -= count;
    return WISP_OK;
}

static wisp_status step_intersections( run_intersections* x, wisp_error* error )
{
    wisp_contact_stats stats;
    // Without participants there are no statistics. The notes on contact say so.
    if ( !x->world->scene->request_intersections || wisp_read_contact_stats( x->world->world, &stats ) != WISP_OK ||
         stats.intersections < 0 )
    {
        return WISP_OK;
    }
    x->steps += 1;
    if ( stats.intersections > 0 )
    {
        add_count( &x->all, stats.intersections, x->world->next_step );
    }
    const int body_count = scene_world_moving_count( x->world );
    int left = stats.intersections;
    for ( int a = 0; a < body_count && left > 0; ++a )
    {
        for ( int b = a; b < body_count && left > 0; ++b )
        {
            const bool are_in = takes_part( x->world->scene, a ) && takes_part( x->world->scene, b );
            WISP_TRY( are_in ? add_pair( x, a, b, &left, error ) : WISP_OK );
        }
    }
    return WISP_OK;
}

// ---- the summary ----

static int last_of( const run_intersections* x, const tally* t )
{
    return t->last_at == x->world->next_step ? t->last : 0;
}

static void put_intersections( const run_intersections* x, results_values* values )
{
    if ( x->steps > 0 )
    {
        results_put( values, "max_intersections", x->all.most );
        results_put( values, "steps_with_intersections", x->all.steps );
    }
}

static void report_intersections( const run_intersections* x, results* out )
{
    if ( x->pair_count == 0 )
    {
        return;
    }
    const int table = results_begin_table( out, "Intersections: edges through triangles at the end of a step",
                                           "of\twith\tsteps\tmost\tin step\tat the end" );
    for ( int i = 0; i < x->pair_count; ++i )
    {
        const tally* t = &x->pairs[i];
        results_add_line( out, table, "%s\t%s\t%d\t%d\t%d\t%d", scene_world_body( x->world, t->first ).name,
                          t->first == t->second ? "itself" : scene_world_body( x->world, t->second ).name, t->steps,
                          t->most, t->most_at, last_of( x, t ) );
    }
}

// ---- all of them ----

struct run_contact
{
    run_layers layers;
    run_collision collision;
    run_intersections intersections;
    io_memory memory;
};

wisp_status run_contact_open( const run_contact_def* def, scene_world* world, int steps, run_contact** out,
                              wisp_error* error )
{
    run_contact* c = calloc( 1, sizeof *c );
    *out = NULL;
    WISP_TRY( c ? WISP_OK : no_contact_memory( error ) );
    wisp_status status = open_layers( def, world, steps, &c->memory, &c->layers, error );
    open_collision( world, &c->memory, &c->collision );
    c->intersections.world = world;
    status = status == WISP_OK && c->memory.is_short ? no_contact_memory( error ) : status;
    if ( status != WISP_OK )
    {
        run_contact_close( c );
        return status;
    }
    *out = c;
    return WISP_OK;
}

void run_contact_close( run_contact* c )
{
    if ( c )
    {
        io_release( &c->memory );
        free( c->intersections.pairs );
        free( c );
    }
}

wisp_status run_contact_step( run_contact* c, wisp_error* error )
{
    WISP_TRY( step_layers( &c->layers, error ) );
    WISP_TRY( step_collision( &c->collision, error ) );
    return step_intersections( &c->intersections, error );
}

void run_contact_put( const run_contact* c, results_values* values )
{
    put_layers( &c->layers, values );
    put_collision( &c->collision, values );
    put_intersections( &c->intersections, values );
}

void run_contact_describe( const run_contact* c, char* out, size_t size )
{
    const run_intersections* x = &c->intersections;
    if ( x->steps == 0 )
    {
        snprintf( out, size, "%s", "" );
    }
    else if ( x->all.steps == 0 )
    {
        snprintf( out, size, "none in %d steps", x->steps );
    }
    else
    {
        snprintf( out, size, "in %d of %d steps; at most %d, in step %d; %d at the end", x->all.steps, x->steps,
                  x->all.most, x->all.most_at, last_of( x, &x->all ) );
    }
}

void run_contact_report( const run_contact* c, results* out )
{
    report_collision( &c->collision, out );
    report_intersections( &c->intersections, out );
}

void run_contact_report_steps( const run_contact* c, results* out )
{
    report_layers( &c->layers, out );
}
