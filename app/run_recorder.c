#include "run_recorder.h"

#include "io_file.h"
#include "nearest.h"
#include "world_from_scene.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- bodies ----

// The bodies of a world as a recording has them: names and elements, colours and widths, and the points and values of the present step.

const char* const run_value_names[RUN_VALUE_COUNT] = { "strain", "speed" };
static const scene_request value_requests[RUN_VALUE_COUNT] = { SCENE_REQUEST_STRAIN, SCENE_REQUEST_SPEED };

/// Arrays that the entry of a body points to.
typedef struct run_body_data
{
    wisp_record_value values[RUN_VALUE_COUNT];
    float* numbers[RUN_VALUE_COUNT]; ///< of the values, in their order
    int requests[RUN_VALUE_COUNT];   ///< which values they are
} run_body_data;

// All bodies except planes, which are infinite. Zero-initialised is empty.
typedef struct run_bodies
{
    int count;
    int* numbers;           // [count] of the bodies in the world
    wisp_record_body* list; // [count]
    wisp_vec3** points;     // [count] of the present step
    run_body_data* data;
    io_memory memory; // all of these
} run_bodies;

static wisp_status no_memory( const scene_world* world, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its recording", world->scene->name );
}

// ---- points ----

// Room for the points of all bodies, unless its memory is short.
static wisp_vec3** make_points( run_bodies* bodies )
{
    wisp_vec3** points = io_get( &bodies->memory, ( (size_t)bodies->count + 1 ) * sizeof *points );
    for ( int i = 0; points && i < bodies->count; ++i )
    {
        points[i] = io_get( &bodies->memory, ( (size_t)bodies->list[i].vertex_count + 1 ) * sizeof *points[i] );
    }
    return points;
}

static wisp_status request_points( scene_world* world, wisp_error* error )
{
    const int moving = scene_world_moving_count( world );
    for ( int i = 0; i < moving; ++i )
    {
        WISP_TRY( scene_world_request( world, i, SCENE_REQUEST_POINTS, error ) );
    }
    return WISP_OK;
}

// ---- appearance ----

// An appearance replaces the widths and colours of the groom.
static void dress_strands( const scene_world* world, int strands, const scene_body* body, io_memory* memory,
                           wisp_record_body* to )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    const wisp_groom* groom = &world->grooms[strands];
    const size_t count = (size_t)body->vertex_count;
    const bool is_new = entry->has_appearance;
    float* widths = is_new ? io_get( memory, count * sizeof *widths )
                           : io_copy( memory, groom->thickness, count * sizeof *widths );
    wisp_vec3* colours = is_new ? io_get( memory, count * sizeof *colours )
                                : io_copy( memory, groom->colour, count * sizeof *colours );
    for ( int s = 0; is_new && !memory->is_short && s < body->strand_count; ++s )
    {
        const int first = body->offsets[s], vertices = body->offsets[s + 1] - first;
        for ( int v = 0; v < vertices; ++v )
        {
            const float t = vertices > 1 ? (float)v / (float)( vertices - 1 ) : 0.0f;
            wisp_strand_appearance_at( &entry->appearance, t, &widths[first + v], &colours[first + v] );
        }
    }
    to->widths = widths;
    to->colours = colours;
}

// ---- values ----

static bool scene_computes( const scene_world* world, int body, scene_request request )
{
    const wisp_scene* scene = world->scene;
    if ( body < scene->strands_count )
    {
        const wisp_scene_strands* entry = &scene->strands[body];
        return request == SCENE_REQUEST_STRAIN ? entry->request_strain : entry->request_speed;
    }
    const wisp_scene_surface* entry = &scene->surfaces[body - scene->strands_count];
    return request == SCENE_REQUEST_STRAIN ? entry->request_strain : entry->request_speed;
}

static wisp_status add_values( scene_world* world, int body, unsigned asked, io_memory* memory, wisp_record_body* to,
                               run_body_data* data, wisp_error* error )
{
    to->values = data->values;
    for ( int k = 0; k < RUN_VALUE_COUNT; ++k )
    {
        const bool is_asked = ( asked >> k & 1 ) != 0;
        if ( !scene_world_has( world, body, value_requests[k] ) ||
             !( is_asked || scene_computes( world, body, value_requests[k] ) ) )
        {
            continue;
        }
        WISP_TRY( is_asked ? scene_world_request( world, body, value_requests[k], error ) : WISP_OK );
        float* numbers = io_get( memory, ( (size_t)to->vertex_count + 1 ) * sizeof *numbers );
        data->numbers[to->value_count] = numbers;
        data->requests[to->value_count] = k;
        data->values[to->value_count] = ( wisp_record_value ){ run_value_names[k], numbers };
        ++to->value_count;
    }
    return WISP_OK;
}

// Something that is asked for and exists nowhere is a mistake.
static wisp_status check_asked( const scene_world* world, unsigned asked, wisp_error* error )
{
    const int moving = scene_world_moving_count( world );
    for ( int k = 0; k < RUN_VALUE_COUNT; ++k )
    {
        bool is_there = ( asked >> k & 1 ) == 0;
        for ( int i = 0; i < moving && !is_there; ++i )
        {
            is_there = scene_world_has( world, i, value_requests[k] );
        }
        if ( !is_there )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "--record-with: %s has no body with %s, which surfaces and strands with dynamics have",
                              world->scene->name, run_value_names[k] );
        }
    }
    return WISP_OK;
}

// ---- all bodies ----

static wisp_record_body entry_of( const scene_body* body, wisp_vec3 colour )
{
    return ( wisp_record_body ){
        .name = body->name,
        .triangles = body->triangles,
        .offsets = body->offsets,
        .vertex_count = body->vertex_count,
        .triangle_count = body->triangle_count,
        .strand_count = body->strand_count,
        .base_colour = colour,
        .triangles_change = body->tears,
    };
}

static bool is_static( const scene_world* world, int body )
{
    const int collider = body - scene_world_moving_count( world );
    return collider >= 0 && world->scene->colliders[collider].path.count == 0;
}

static wisp_status list_bodies( scene_world* world, bool has_values, unsigned asked, run_bodies* out,
                                wisp_error* error )
{
    int cloths = 0, balloons = 0;
    for ( int i = 0; i < scene_world_body_count( world ); ++i )
    {
        const scene_body body = scene_world_body( world, i );
        if ( body.kind == SCENE_BODY_PLANE )
        {
            continue;
        }
        wisp_record_body* to = &out->list[out->count];
        const scene_body_kind drawn = body.is_led ? SCENE_BODY_COLLIDER : body.kind;
        *to = entry_of( &body, scene_body_colour( drawn, &cloths, &balloons ) );
        out->numbers[out->count] = i;
        run_body_data* data = &out->data[out->count++];
        to->is_static = is_static( world, i );
        if ( body.kind == SCENE_BODY_STRANDS )
        {
            dress_strands( world, i, &body, &out->memory, to );
        }
        if ( has_values && i < scene_world_moving_count( world ) )
        {
            WISP_TRY( add_values( world, i, asked, &out->memory, to, data, error ) );
        }
    }
    return WISP_OK;
}

// Request the points of all bodies, list them, and prepare their values: those that the scene computes and those that
// are asked for, which are requested too. Call before the first step.
// @param has_values the recording holds values; false: they are left out
// @param asked set of RUN_VALUE_..; each must exist in one body at least
// @param out zero; its memory is to be released, after a failure too
// @return WISP_BAD_INPUT no body has the value that is asked for; WISP_NO_MEMORY
static wisp_status open_bodies( scene_world* world, bool has_values, unsigned asked, run_bodies* out,
                                wisp_error* error )
{
    const size_t room = (size_t)scene_world_body_count( world ) + 1;
    out->numbers = io_get( &out->memory, room * sizeof *out->numbers );
    out->list = io_get( &out->memory, room * sizeof *out->list );
    out->data = io_get( &out->memory, room * sizeof *out->data );
    WISP_TRY( out->memory.is_short ? no_memory( world, error ) : WISP_OK );
    WISP_TRY( check_asked( world, asked, error ) );
    WISP_TRY( list_bodies( world, has_values, asked, out, error ) );
    out->points = make_points( out );
    return out->memory.is_short ? no_memory( world, error ) : request_points( world, error );
}

// Fill the points of the present step, and the values if they are needed.
static wisp_status load_bodies( const run_bodies* bodies, const scene_world* world, bool with_values,
                                wisp_error* error )
{
    for ( int i = 0; i < bodies->count; ++i )
    {
        const run_body_data* data = &bodies->data[i];
        WISP_TRY( scene_world_points( world, bodies->numbers[i], bodies->points[i], error ) );
        for ( int k = 0; k < bodies->list[i].value_count && with_values; ++k )
        {
            WISP_TRY( scene_world_numbers( world, bodies->numbers[i], value_requests[data->requests[k]],
                                           data->numbers[k], error ) );
        }
    }
    return WISP_OK;
}

// ---- between steps ----

// The bodies of a world between its last two steps, for recordings with more frames than steps. Ghosts are on the cubic Hermite curves of
// wisp_ghosts_between(), which pass through both steps without a corner; all other points, and what collisions and frozen hair add to
// ghosts, move along straight lines.

typedef struct run_between
{
    const run_bodies* bodies;
    const scene_world* world; // its scene has frames_per_step > 1; null: frames are those of steps
    wisp_vec3** before; // of the step before the last one: ghosts as their distance to the curve, others as they are
    wisp_vec3** now;    // of the last step, the same way
    wisp_vec3** points; // of the result
} run_between;

static bool is_ghosts( const run_between* b, int body )
{
    const int strands = b->bodies->numbers[body];
    return strands < b->world->scene->strands_count && b->world->scene->strands[strands].has_ghosts;
}

// Place on the curve in time that motion alone gives.
static wisp_status read_curve( const run_between* b, int body, float fraction, wisp_vec3* out, wisp_error* error )
{
    const wisp_entity entity = b->world->entities[b->bodies->numbers[body]];
    const wisp_status status = wisp_ghosts_between( b->world->world, entity, fraction, out );
    return status == WISP_OK ? WISP_OK
                             : wisp_fail( error, status, "%s: '%s': %s", b->world->scene->name,
                                          b->bodies->list[body].name, wisp_world_message( b->world->world ) );
}

// Replace points by their distance to the curve at one of its ends.
static wisp_status take_curve_off( run_between* b, int body, float fraction, wisp_vec3* points, wisp_error* error )
{
    wisp_vec3* curve = b->points[body];
    const wisp_status status = read_curve( b, body, fraction, curve, error );
    for ( int v = 0; v < b->bodies->list[body].vertex_count && status == WISP_OK; ++v )
    {
        points[v] = ( wisp_vec3 ){ points[v].x - curve[v].x, points[v].y - curve[v].y, points[v].z - curve[v].z };
    }
    return status;
}

// Note the points of `bodies`, which load_bodies() has filled, as those of the last step.
// @return WISP_CONFLICT, with a message, if ghosts do not keep what is needed
static wisp_status note_between( run_between* b, wisp_error* error )
{
    wisp_vec3** last = b->before;
    b->before = b->now;
    b->now = last;
    for ( int i = 0; i < b->bodies->count; ++i )
    {
        const size_t bytes = (size_t)b->bodies->list[i].vertex_count * sizeof( wisp_vec3 );
        memcpy( b->now[i], b->bodies->points[i], bytes );
        WISP_TRY( is_ghosts( b, i ) ? take_curve_off( b, i, 1.0f, b->now[i], error ) : WISP_OK );
    }
    return WISP_OK;
}

// Compute the points at a fraction of the time between the last two steps noted.
// @param fraction in (0, 1)
// @param points receives [body_count] arrays that are valid until the next call
static wisp_status find_between( run_between* b, float fraction, const wisp_vec3* const** points, wisp_error* error )
{
    const float rest = 1.0f - fraction;
    for ( int i = 0; i < b->bodies->count; ++i )
    {
        const wisp_vec3 *from = b->before[i], *to = b->now[i];
        wisp_vec3* out = b->points[i];
        const int count = b->bodies->list[i].vertex_count;
        if ( b->bodies->list[i].is_static )
        {
            memcpy( out, to, (size_t)count * sizeof *out ); // bit for bit
            continue;
        }
        memset( out, 0, (size_t)count * sizeof *out );
        WISP_TRY( is_ghosts( b, i ) ? read_curve( b, i, fraction, out, error ) : WISP_OK );
        for ( int v = 0; v < count; ++v )
        {
            out[v].x += rest * from[v].x + fraction * to[v].x;
            out[v].y += rest * from[v].y + fraction * to[v].y;
            out[v].z += rest * from[v].z + fraction * to[v].z;
        }
    }
    *points = (const wisp_vec3* const*)b->points;
    return WISP_OK;
}

// ---- files ----

struct run_recorder
{
    scene_world* world;
    int every;
    int frames_per_step; ///< 1 unless every step is recorded
    run_between between;
    double last_time;        ///< s, of the last frame that is a step
    wisp_recorder* recorder; ///< or null
    const char* record;      ///< its file
    wisp_recorder* track;    ///< or null

    run_bodies bodies;

    const char* proof_name;
    wisp_recording* proof;    ///< the recording to compare, or null
    int proof_every;          ///< steps between its frames
    int proof_frames;         ///<
    wisp_vec3** proof_points; ///< [bodies.count] recorded positions

    int written, verified;
};

// ---- writing ----

static wisp_recorder_def def_of( const run_recorder* r, const run_recorder_def* def )
{
    return ( wisp_recorder_def ){
        .bodies = r->bodies.list,
        .body_count = r->bodies.count,
        .dt = def->every * (double)r->world->scene->dt / r->frames_per_step,
        .origin = { r->world->scene->origin[0], r->world->scene->origin[1], r->world->scene->origin[2] },
        .frame_count = def->steps / def->every * r->frames_per_step + 1,
    };
}

static int find_tracked_body( const run_recorder* r, const run_track* track )
{
    for ( int i = 0; i < r->bodies.count; ++i )
    {
        const char* name = r->bodies.list[i].name;
        if ( strlen( name ) == (size_t)track->name_length && memcmp( name, track->name, strlen( name ) ) == 0 )
        {
            return i;
        }
    }
    return -1;
}

static wisp_status refuse_name( run_recorder* r, const run_track* track, wisp_error* error )
{
    char word[2 * WISP_RECORD_MAX_NAME];
    snprintf( word, sizeof( word ), "%.*s", track->name_length, track->name );
    const char** names = io_get( &r->bodies.memory, ( (size_t)r->bodies.count + 1 ) * sizeof *names );
    for ( int i = 0; names && i < r->bodies.count; ++i )
    {
        names[i] = r->bodies.list[i].name;
    }
    const char* nearest = names ? nearest_word( word, names, r->bodies.count ) : NULL;
    return nearest ? wisp_fail( error, WISP_BAD_INPUT, "--track: %s has no body '%s'; did you mean '%s'?",
                                r->world->scene->name, word, nearest )
                   : wisp_fail( error, WISP_BAD_INPUT, "--track: %s has no body '%s'", r->world->scene->name, word );
}

static wisp_status find_tracks( run_recorder* r, const run_recorder_def* def, wisp_track_point* points,
                                wisp_error* error )
{
    for ( int i = 0; i < def->track_count; ++i )
    {
        const run_track* track = &def->tracks[i];
        int body = find_tracked_body( r, track );
        if ( body < 0 )
        {
            return refuse_name( r, track, error );
        }
        if ( track->vertex >= r->bodies.list[body].vertex_count )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "--track: %s: got vertex %d, expected 0 to %d",
                              r->bodies.list[body].name, track->vertex, r->bodies.list[body].vertex_count - 1 );
        }
        points[i] = ( wisp_track_point ){ body, track->vertex };
    }
    return WISP_OK;
}

static wisp_status open_track( run_recorder* r, const run_recorder_def* def, wisp_error* error )
{
    wisp_track_point points[RUN_TRACKS_MAX];
    WISP_TRY( find_tracks( r, def, points, error ) );
    wisp_recorder_def recorder = def_of( r, def );
    recorder.tracks = points;
    recorder.track_count = def->track_count;
    return wisp_recorder_open( def->track_file, WISP_RECORD_TRACKS, &recorder, &r->track, error );
}

// ---- comparison ----

static bool same_numbers( const int32_t* a, const int32_t* b, size_t count )
{
    return count == 0 || ( a && b && memcmp( a, b, count * sizeof *a ) == 0 );
}

static bool same_body( const wisp_record_body* a, const wisp_record_body* b )
{
    return strcmp( a->name, b->name ) == 0 && a->vertex_count == b->vertex_count &&
           a->triangle_count == b->triangle_count && a->strand_count == b->strand_count &&
           a->triangles_change == b->triangles_change &&
           same_numbers( a->triangles, b->triangles, 3 * (size_t)a->triangle_count ) &&
           same_numbers( a->offsets, b->offsets, a->strand_count > 0 ? (size_t)a->strand_count + 1 : 0 );
}

// A run that compares less than the recording, or more than it has, proves nothing about the rest.
static wisp_status check_length( const run_recorder* r, const run_recorder_def* def, wisp_error* error )
{
    const int frames = def->steps / r->proof_every + 1;
    if ( frames == r->proof_frames || ( def->is_part && frames < r->proof_frames ) )
    {
        return WISP_OK;
    }
    return wisp_fail( error, WISP_BAD_INPUT, "%s: got %d frames, expected %d, since the run has %d steps%s",
                      r->proof_name, r->proof_frames, frames, def->steps,
                      frames < r->proof_frames ? "; --steps compares the first ones" : "" );
}

static wisp_status check_proof( run_recorder* r, const run_recorder_def* def, wisp_error* error )
{
    wisp_recording_info info = wisp_recording_describe( r->proof );
    const wisp_scene* scene = r->world->scene;
    if ( info.frame_count < 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got no complete frame, expected at least one", r->proof_name );
    }
    if ( !info.complete )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the recording is cut: it has no end after frame %d",
                          r->proof_name, info.frame_count - 1 );
    }
    if ( info.body_count != r->bodies.count )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %d bodies, but %s has %d", r->proof_name, info.body_count,
                          scene->name, r->bodies.count );
    }
    for ( int i = 0; i < r->bodies.count; ++i )
    {
        if ( !same_body( &r->bodies.list[i], wisp_recording_body( r->proof, i ) ) )
        {
            return wisp_fail(
                error, WISP_BAD_INPUT,
                "%s: body %d differs in its name or in its number of vertices, triangles or strands from %s of %s",
                r->proof_name, i, r->bodies.list[i].name, scene->name );
        }
    }
    double steps = info.dt / (double)scene->dt;
    r->proof_every = steps >= 1.0 && steps <= 1e9 ? (int)lround( steps ) : 0;
    r->proof_frames = info.frame_count;
    // The recorder multiplied by the number of steps, which is exact enough to be compared with a small tolerance.
    return fabs( steps - r->proof_every ) <= 1e-6 * steps
               ? check_length( r, def, error )
               : wisp_fail( error, WISP_BAD_INPUT,
                            "%s: got frames %g s apart, expected a multiple of the step of %g s", r->proof_name,
                            info.dt, (double)scene->dt );
}

static wisp_status open_proof( run_recorder* r, const run_recorder_def* def, wisp_error* error )
{
    r->proof_name = def->verify;
    WISP_TRY( wisp_recording_open( def->verify, &r->proof, error ) );
    WISP_TRY( check_proof( r, def, error ) );
    // Only now: a recording that matches the scene does not need more memory than the scene.
    r->proof_points = make_points( &r->bodies );
    return r->bodies.memory.is_short ? no_memory( r->world, error ) : WISP_OK;
}

static wisp_status compare_body( const run_recorder* r, int body, int frame, double time, wisp_error* error )
{
    const wisp_vec3 *now = r->bodies.points[body], *then = r->proof_points[body];
    for ( int v = 0; v < r->bodies.list[body].vertex_count; ++v )
    {
        if ( memcmp( &now[v], &then[v], sizeof now[v] ) != 0 )
        {
            return wisp_fail( error, WISP_CONFLICT,
                              "%s: frame %d at %g s: %s differs at vertex %d: got (%.9g, %.9g, %.9g), expected "
                              "(%.9g, %.9g, %.9g)",
                              r->proof_name, frame, time, r->bodies.list[body].name, v, (double)now[v].x,
                              (double)now[v].y, (double)now[v].z, (double)then[v].x, (double)then[v].y,
                              (double)then[v].z );
        }
    }
    const wisp_record_body* list = r->bodies.list;
    const int32_t* corners = wisp_recording_body( r->proof, body )->triangles;
    for ( int t = 0; list[body].triangles_change && t < list[body].triangle_count; ++t )
    {
        if ( same_numbers( list[body].triangles + 3 * (size_t)t, corners + 3 * (size_t)t, 3 ) == false )
        {
            return wisp_fail(
                error, WISP_CONFLICT,
                "%s: frame %d at %g s: the vertices of triangle %d of %s differ: one was torn, the other not",
                r->proof_name, frame, time, t, list[body].name );
        }
    }
    return WISP_OK;
}

static wisp_status compare( run_recorder* r, int frame, uint64_t hash, wisp_error* error )
{
    double time = 0.0;
    uint64_t old_hash = 0;
    WISP_TRY( wisp_recording_frame( r->proof, frame, r->proof_points, &time, &old_hash, error ) );
    for ( int i = 0; i < r->bodies.count; ++i )
    {
        WISP_TRY( compare_body( r, i, frame, time, error ) );
    }
    if ( old_hash != 0 && old_hash != hash )
    {
        return wisp_fail(
            error, WISP_CONFLICT,
            "%s: frame %d at %g s: all points are equal, but the world differs: got hash %016llx, expected "
            "%016llx",
            r->proof_name, frame, time, (unsigned long long)hash, (unsigned long long)old_hash );
    }
    r->verified += 1;
    return WISP_OK;
}

// ---- whole recorder ----

static wisp_status open_all( run_recorder* r, const run_recorder_def* def, wisp_error* error )
{
    const bool has_values = def->record && wisp_record_has_values( def->record );
    WISP_TRY( open_bodies( r->world, has_values, def->values, &r->bodies, error ) );
    if ( r->frames_per_step > 1 )
    {
        run_bodies* bodies = &r->bodies;
        r->between = ( run_between ){
            bodies, r->world, make_points( bodies ), make_points( bodies ), make_points( bodies ),
        };
        WISP_TRY( bodies->memory.is_short ? no_memory( r->world, error ) : WISP_OK );
    }
    // Read-only steps come first, so that a rejection leaves no file behind.
    WISP_TRY( def->verify ? open_proof( r, def, error ) : WISP_OK );
    WISP_TRY( def->track_count > 0 ? open_track( r, def, error ) : WISP_OK );
    const wisp_recorder_def recorder = def_of( r, def );
    return def->record ? wisp_recorder_open( def->record, WISP_RECORD_BY_NAME, &recorder, &r->recorder, error )
                       : WISP_OK;
}

wisp_status run_recorder_open( const run_recorder_def* def, scene_world* world, run_recorder** out,
                               wisp_error* error )
{
    *out = NULL;
    if ( !def->record && def->track_count == 0 && !def->verify )
    {
        return WISP_OK;
    }
    run_recorder* r = calloc( 1, sizeof *r );
    if ( !r )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "run: out of memory for a recording" );
    }
    r->world = world;
    r->every = def->every;
    r->record = def->record;
    // a run that leaves steps out, or writes nothing, has no frames between steps
    const bool is_dense = def->every == 1 && ( def->record || def->track_count > 0 );
    r->frames_per_step = is_dense && world->scene->frames_per_step > 1 ? world->scene->frames_per_step : 1;
    wisp_status status = open_all( r, def, error );
    if ( status != WISP_OK )
    {
        wisp_error later = { 0 };
        run_recorder_close( r, &later );
        return status;
    }
    *out = r;
    return WISP_OK;
}

static wisp_status write_points( run_recorder* r, double time, uint64_t hash, const wisp_vec3* const* points,
                                 wisp_error* error )
{
    WISP_TRY( r->recorder ? wisp_recorder_frame( r->recorder, time, hash, points, error ) : WISP_OK );
    WISP_TRY( r->track ? wisp_recorder_frame( r->track, time, hash, points, error ) : WISP_OK );
    r->written += 1;
    return WISP_OK;
}

// Frames between the step before and this one have no hash, because no world was ever in their state.
static wisp_status write_between( run_recorder* r, double time, wisp_error* error )
{
    WISP_TRY( note_between( &r->between, error ) );
    for ( int k = 1; k < r->frames_per_step && r->world->next_step > 0; ++k )
    {
        const double fraction = (double)k / r->frames_per_step;
        const wisp_vec3* const* points = NULL;
        WISP_TRY( find_between( &r->between, (float)fraction, &points, error ) );
        WISP_TRY( write_points( r, r->last_time + fraction * ( time - r->last_time ), 0, points, error ) );
    }
    return WISP_OK;
}

static wisp_status write_frame( run_recorder* r, uint64_t hash, wisp_error* error )
{
    const double time = scene_world_time( r->world );
    WISP_TRY( r->between.world ? write_between( r, time, error ) : WISP_OK );
    r->last_time = time;
    return write_points( r, time, hash, (const wisp_vec3* const*)r->bodies.points, error );
}

wisp_status run_recorder_step( run_recorder* r, wisp_error* error )
{
    const int step = r ? r->world->next_step : 0;
    const bool is_written = r && ( r->recorder || r->track ) && step % r->every == 0;
    const bool is_compared = r && r->proof && step % r->proof_every == 0 && step / r->proof_every < r->proof_frames;
    if ( !is_written && !is_compared )
    {
        return WISP_OK;
    }
    WISP_TRY( load_bodies( &r->bodies, r->world, is_written, error ) );
    const uint64_t hash = wisp_world_hash( r->world->world );
    WISP_TRY( is_written ? write_frame( r, hash, error ) : WISP_OK );
    return is_compared ? compare( r, step / r->proof_every, hash, error ) : WISP_OK;
}

// Point caches are a file of each body, .obj files one of each frame.
static void name_files( const run_recorder* r, char* out, size_t size )
{
    const char *path = r->record, *dot = strrchr( path, '.' );
    const int stem = (int)( dot - path ), count = r->bodies.count;
    size_t used = 0;
    snprintf( out, size, "%s", path );
    if ( io_has_extension( path, ".obj" ) && r->written > 0 )
    {
        snprintf( out, size, "%.*s_0001%s to %.*s_%04d%s", stem, path, dot, stem, path, r->written, dot );
    }
    for ( int i = 0; i < count && count > 1 && io_has_extension( path, ".pc2" ); ++i )
    {
        const size_t more = (size_t)stem + strlen( r->bodies.list[i].name ) + 20;
        if ( used + more > size )
        {
            snprintf( out + used, size - used, " and %d more", count - i );
            break;
        }
        used += (size_t)snprintf( out + used, size - used, "%s%.*s_%s%s", i > 0 ? ", " : "", stem, path,
                                  r->bodies.list[i].name, dot );
    }
}

run_recorder_counts run_recorder_count( const run_recorder* r )
{
    run_recorder_counts counts = { 0 };
    if ( r )
    {
        counts = ( run_recorder_counts ){ r->written, r->verified, r->proof_frames - r->verified, "" };
    }
    if ( r && r->record )
    {
        name_files( r, counts.files, sizeof counts.files );
    }
    return counts;
}

wisp_status run_recorder_close( run_recorder* r, wisp_error* error )
{
    if ( !r )
    {
        return WISP_OK;
    }
    wisp_status status = wisp_recorder_close( r->recorder, error );
    wisp_error later = { 0 };
    wisp_status track = wisp_recorder_close( r->track, status == WISP_OK ? error : &later );
    wisp_recording_close( r->proof );
    io_release( &r->bodies.memory );
    free( r );
    return status == WISP_OK ? track : status;
}
