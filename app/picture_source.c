#include "picture_source.h"

#include "wisp/module/definition.h"

#include <limits.h>
#include <math.h>
#include <string.h>

// ---- memory ----

// Memory for the bodies of a picture, of every kind of input.

wisp_status picture_check_memory( const picture_source* source, wisp_error* error )
{
    return source->memory.is_short
               ? wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its bodies", source->path )
               : WISP_OK;
}

wisp_status picture_start( picture_source* source, const picture_input* input, size_t state, wisp_error* error )
{
    source->input = input;
    source->state = io_get( &source->memory, state );
    return picture_check_memory( source, error );
}

wisp_status picture_make_bodies( picture_source* source, int count, wisp_error* error )
{
    if ( count < 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: contains nothing to draw", source->path );
    }
    source->bodies = io_get( &source->memory, (size_t)count * sizeof *source->bodies );
    source->points = io_get( &source->memory, (size_t)count * sizeof *source->points );
    source->body_count = source->memory.is_short ? 0 : count;
    return picture_check_memory( source, error );
}

wisp_status picture_make_points( picture_source* source, int body, bool has_values, wisp_error* error )
{
    picture_body* b = &source->bodies[body];
    size_t count = (size_t)b->vertex_count + 1;
    b->points = io_get( &source->memory, count * sizeof *b->points );
    source->points[body] = b->points;
    b->values = has_values ? io_get( &source->memory, count * sizeof *b->values ) : NULL;
    return picture_check_memory( source, error );
}

wisp_status picture_make_layer( picture_source* source, int body, int count, wisp_error* error )
{
    picture_layer* layer = &source->bodies[body].layer;
    layer->count = 0;
    if ( count <= layer->room )
    {
        return WISP_OK;
    }
    // A layer that grows from frame to frame is not reallocated in each of them.
    layer->room = count + ( count <= INT_MAX / 2 ? count / 4 : 0 );
    layer->points = io_get( &source->memory, (size_t)layer->room * sizeof *layer->points );
    layer->normals = io_get( &source->memory, (size_t)layer->room * sizeof *layer->normals );
    return picture_check_memory( source, error );
}

// Whether every edge of a mesh has two triangles or more, an even number.
static wisp_status is_mesh_closed( const picture_body* body, bool* is_closed, wisp_error* error )
{
    // The doctor only reads, but the type of a mesh has writable arrays.
    const wisp_mesh mesh = {
        .points = body->points,
        .triangles = (int32_t*)(uintptr_t)body->triangles,
        .vertex_count = body->vertex_count,
        .triangle_count = body->triangle_count,
    };
    *is_closed = false;
    if ( mesh.triangle_count == 0 )
    {
        return WISP_OK;
    }
    wisp_mesh_diagnostics report;
    wisp_status status = wisp_mesh_examine( &mesh, &report, error );
    *is_closed = status == WISP_OK && report.closed;
    return status;
}

// ---- recordings and point caches ----

// Recordings and point caches. Neither stores materials or velocities: both are derived from the points.

// Rounding to floats changes the length of an edge by far less, and anything elastic by far more.
#define RIGID_TOLERANCE 1e-4f

typedef struct playback
{
    wisp_recording* recording;
    wisp_mesh mesh;        ///< triangles of a point cache
    wisp_vec3** others[2]; ///< [body_count] of another frame each: the first for strain, neighbours for speed
    int32_t** first;       ///< [body_count] triangles of the first frame where they change, else null
} playback;

static wisp_status read_frame( picture_source* source, int frame, wisp_vec3** points, double* seconds,
                               wisp_error* error )
{
    playback* p = source->state;
    return wisp_recording_frame( p->recording, frame, points, seconds, NULL, error );
}

static wisp_status time_of_frame( picture_source* source, int frame, double* seconds, wisp_error* error )
{
    return read_frame( source, frame, NULL, seconds, error );
}

// ---- values ----

static float length_between( const wisp_vec3* points, int i, int j )
{
    float x = points[j].x - points[i].x, y = points[j].y - points[i].y, z = points[j].z - points[i].z;
    return sqrtf( x * x + y * y + z * z );
}

// An edge between two vertices, which at rest had their corners at others where the body tears.
typedef struct body_edge
{
    int32_t now[2], rest[2];
} body_edge;

typedef void edge_fn( void* context, body_edge edge );

// @param rest [triangle_count][3] triangles of the body at rest
static void each_edge( const picture_body* body, const int32_t* rest, edge_fn* visit, void* context )
{
    for ( int i = 0; i < 3 * body->triangle_count; ++i )
    {
        const int next = i % 3 == 2 ? i - 2 : i + 1;
        visit( context, ( body_edge ){ { body->triangles[i], body->triangles[next] }, { rest[i], rest[next] } } );
    }
    for ( int s = 0; s < body->strand_count; ++s )
    {
        for ( int v = body->offsets[s]; v + 1 < body->offsets[s + 1]; ++v )
        {
            visit( context, ( body_edge ){ { v, v + 1 }, { v, v + 1 } } );
        }
    }
}

typedef struct stretching
{
    const wisp_vec3* rest;
    const wisp_vec3* now;
    float* values; ///< or null
    float most;
} stretching;

// An inner edge occurs twice, which does not change a maximum.
static void stretch_edge( void* context, body_edge edge )
{
    stretching* s = context;
    const int i = edge.now[0], j = edge.now[1];
    float rest = length_between( s->rest, edge.rest[0], edge.rest[1] );
    float strain = rest > 0.0f ? fabsf( length_between( s->now, i, j ) / rest - 1.0f ) : 0.0f;
    s->most = fmaxf( s->most, strain );
    if ( s->values )
    {
        s->values[i] = fmaxf( s->values[i], strain );
        s->values[j] = fmaxf( s->values[j], strain );
    }
}

static void find_strain( picture_body* body, const wisp_vec3* rest, const int32_t* rest_triangles )
{
    for ( int v = 0; v < body->vertex_count; ++v )
    {
        body->values[v] = 0.0f;
    }
    stretching s = { rest, body->points, body->values, 0.0f };
    each_edge( body, rest_triangles, stretch_edge, &s );
}

static void find_speed( picture_body* body, const wisp_vec3* before, const wisp_vec3* after, double seconds )
{
    for ( int v = 0; v < body->vertex_count; ++v )
    {
        wisp_vec3 ends[2] = { before[v], after[v] };
        body->values[v] = seconds > 0.0 ? (float)( (double)length_between( ends, 0, 1 ) / seconds ) : 0.0f;
    }
}

// ---- frames ----

// From the neighbouring frames; the first and the last one have a neighbour on one side only.
static wisp_status load_speed( picture_source* source, int frame, wisp_error* error )
{
    playback* p = source->state;
    int first = frame > 0 ? frame - 1 : 0;
    int last = frame + 1 < source->frame_count ? frame + 1 : frame;
    double from = 0.0, to = 0.0;
    WISP_TRY( read_frame( source, first, p->others[0], &from, error ) );
    WISP_TRY( read_frame( source, last, p->others[1], &to, error ) );
    for ( int i = 0; i < source->body_count; ++i )
    {
        find_speed( &source->bodies[i], p->others[0][i], p->others[1][i], to - from );
    }
    return WISP_OK;
}

static const int32_t* first_triangles( const playback* p, const picture_body* body, int i )
{
    return p->first[i] != NULL ? p->first[i] : body->triangles;
}

static wisp_status load_recorded( picture_source* source, int frame, wisp_error* error )
{
    playback* p = source->state;
    double seconds = 0.0;
    // last the frame itself, because triangles are those of the frame read last
    WISP_TRY( source->value == PICTURE_SPEED ? load_speed( source, frame, error ) : WISP_OK );
    WISP_TRY( read_frame( source, frame, source->points, &seconds, error ) );
    for ( int i = 0; i < source->body_count && source->value == PICTURE_STRAIN; ++i )
    {
        find_strain( &source->bodies[i], p->others[0][i], first_triangles( p, source->bodies + i, i ) );
    }
    return WISP_OK;
}

static void close_playback( picture_source* source )
{
    playback* p = source->state;
    wisp_recording_close( p->recording );
    wisp_mesh_release( &p->mesh );
}

static const picture_input playback_input = { load_recorded, time_of_frame, close_playback };

// ---- bodies ----

static wisp_status make_room( picture_source* source, wisp_error* error )
{
    playback* p = source->state;
    const size_t count = (size_t)source->body_count;
    for ( int i = 0; i < source->body_count; ++i )
    {
        WISP_TRY( picture_make_points( source, i, source->value != PICTURE_BODY, error ) );
    }
    for ( int k = 0; k < WISP_COUNT( p->others ); ++k )
    {
        p->others[k] = io_get( &source->memory, count * sizeof *p->others[k] );
        for ( int i = 0; p->others[k] && i < source->body_count; ++i )
        {
            const size_t room = (size_t)source->bodies[i].vertex_count + 1;
            p->others[k][i] = io_get( &source->memory, room * sizeof( wisp_vec3 ) );
        }
    }
    p->first = io_get( &source->memory, count * sizeof *p->first );
    return picture_check_memory( source, error );
}

static bool is_rigid( const picture_body* body, const wisp_vec3* rest, const int32_t* first )
{
    stretching s = { rest, body->points, NULL, 0.0f };
    each_edge( body, first, stretch_edge, &s );
    return s.most <= RIGID_TOLERANCE;
}

// Of the frame that was read last.
static wisp_status keep_first_triangles( picture_source* source, wisp_error* error )
{
    const playback* p = source->state;
    for ( int i = 0; i < source->body_count; ++i )
    {
        const wisp_record_body* body = wisp_recording_body( p->recording, i );
        const size_t bytes = 3 * (size_t)body->triangle_count * sizeof *body->triangles;
        p->first[i] = body->triangles_change ? io_copy( &source->memory, body->triangles, bytes ) : NULL;
    }
    return picture_check_memory( source, error );
}

// A body whose edges all keep their length is a collider; of the rest, closed meshes are balloons. A single frame
// does not show what is rigid. The first frame stays in others[0], where the strain is computed from it.
static wisp_status guess_kinds( picture_source* source, wisp_error* error )
{
    playback* p = source->state;
    const int seen[2] = { source->frame_count / 2, source->frame_count - 1 };
    double seconds;
    WISP_TRY( read_frame( source, 0, p->others[0], &seconds, error ) );
    WISP_TRY( keep_first_triangles( source, error ) );
    for ( int i = 0; i < source->body_count; ++i )
    {
        picture_body* body = &source->bodies[i];
        body->kind = body->offsets             ? SCENE_BODY_STRANDS
                     : source->frame_count > 1 ? SCENE_BODY_COLLIDER
                                               : SCENE_BODY_CLOTH;
    }
    for ( int k = 0; k < 2; ++k )
    {
        WISP_TRY( read_frame( source, seen[k], source->points, &seconds, error ) );
        for ( int i = 0; i < source->body_count; ++i )
        {
            picture_body* body = &source->bodies[i];
            bool is_bent = body->kind == SCENE_BODY_COLLIDER &&
                           !is_rigid( body, p->others[0][i], first_triangles( p, body, i ) );
            body->kind = is_bent ? SCENE_BODY_CLOTH : body->kind;
        }
    }
    for ( int i = 0; i < source->body_count; ++i )
    {
        picture_body* body = &source->bodies[i];
        bool is_closed = false;
        WISP_TRY( body->kind == SCENE_BODY_CLOTH ? is_mesh_closed( body, &is_closed, error ) : WISP_OK );
        body->kind = is_closed ? SCENE_BODY_BALLOON : body->kind;
    }
    return WISP_OK;
}

static wisp_status finish_playback( picture_source* source, wisp_error* error )
{
    WISP_TRY( make_room( source, error ) );
    return guess_kinds( source, error );
}

static wisp_status refuse_empty( const picture_source* source, wisp_error* error )
{
    return wisp_fail( error, WISP_BAD_INPUT, "%s: got no complete frame, expected at least one", source->path );
}

static wisp_status open_recording( picture_source* source, const picture_source_def* def, wisp_error* error )
{
    WISP_TRY( picture_start( source, &playback_input, sizeof( playback ), error ) );
    playback* p = source->state;
    WISP_TRY( wisp_recording_open( def->path, &p->recording, error ) );
    wisp_recording_info info = wisp_recording_describe( p->recording );
    source->frame_count = info.frame_count;
    memcpy( source->origin, info.origin, sizeof source->origin );
    source->step = info.dt;
    source->has_seconds = true;
    WISP_TRY( info.frame_count > 0 ? picture_make_bodies( source, info.body_count, error )
                                   : refuse_empty( source, error ) );
    for ( int i = 0; i < source->body_count; ++i )
    {
        const wisp_record_body* body = wisp_recording_body( p->recording, i );
        source->bodies[i] = ( picture_body ){
            .name = body->name,
            .vertex_count = body->vertex_count,
            .triangles = body->triangles,
            .triangle_count = body->triangle_count,
            .offsets = body->offsets,
            .strand_count = body->strand_count,
        };
    }
    return finish_playback( source, error );
}

static wisp_status read_triangles( picture_source* source, const picture_source_def* def, int point_count,
                                   wisp_error* error )
{
    playback* p = source->state;
    if ( !def->mesh )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: a point cache has no triangles; --mesh names a mesh that has them", def->path );
    }
    WISP_TRY( wisp_mesh_read( def->mesh, &p->mesh, error ) );
    return p->mesh.vertex_count == point_count
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "%s: got %d vertices, but %s has %d points", def->mesh,
                            p->mesh.vertex_count, def->path, point_count );
}

static wisp_status open_cache( picture_source* source, const picture_source_def* def, wisp_error* error )
{
    WISP_TRY( picture_start( source, &playback_input, sizeof( playback ), error ) );
    playback* p = source->state;
    WISP_TRY( wisp_pc2_open( def->path, &p->recording, error ) );
    source->frame_count = wisp_recording_describe( p->recording ).frame_count;
    WISP_TRY( source->frame_count > 0
                  ? read_triangles( source, def, wisp_recording_body( p->recording, 0 )->vertex_count, error )
                  : refuse_empty( source, error ) );
    WISP_TRY( picture_make_bodies( source, 1, error ) );
    source->bodies[0] = ( picture_body ){
        .name = "mesh",
        .vertex_count = p->mesh.vertex_count,
        .triangles = p->mesh.triangles,
        .triangle_count = p->mesh.triangle_count,
    };
    return finish_playback( source, error );
}

// ---- meshes and grooms, which do not move ----

typedef struct still
{
    wisp_mesh mesh;
    wisp_groom groom;
} still;

static wisp_status load_still( picture_source* source, int frame, wisp_error* error )
{
    (void)frame;
    (void)error;
    const still* s = source->state;
    picture_body* body = &source->bodies[0];
    const wisp_vec3* points = body->offsets ? s->groom.points : s->mesh.points;
    memcpy( body->points, points, (size_t)body->vertex_count * sizeof *points );
    return WISP_OK;
}

static wisp_status time_of_still( picture_source* source, int frame, double* seconds, wisp_error* error )
{
    (void)source;
    (void)error;
    *seconds = frame;
    return WISP_OK;
}

static void close_still( picture_source* source )
{
    still* s = source->state;
    wisp_mesh_release( &s->mesh );
    wisp_groom_release( &s->groom );
}

static const picture_input still_input = { load_still, time_of_still, close_still };

static wisp_status read_still_groom( picture_source* source, const char* path, wisp_error* error )
{
    wisp_groom* groom = &( (still*)source->state )->groom;
    picture_body* body = &source->bodies[0];
    WISP_TRY( wisp_groom_read( path, groom, error ) );
    wisp_error cause = { 0 };
    if ( wisp_groom_check( groom, &cause ) != WISP_OK )
    {
        return wisp_fail( error, cause.status, "%s: %s", source->path, cause.message );
    }
    *body = ( picture_body ){
        .name = "hair",
        .kind = SCENE_BODY_STRANDS,
        .vertex_count = groom->vertex_count,
        .offsets = groom->offsets,
        .strand_count = groom->strand_count,
        .widths = groom->thickness,
        .colours = groom->colour,
    };
    return picture_make_points( source, 0, false, error );
}

static wisp_status read_still_mesh( picture_source* source, const char* path, wisp_error* error )
{
    wisp_mesh* mesh = &( (still*)source->state )->mesh;
    WISP_TRY( wisp_mesh_read( path, mesh, error ) );
    picture_body* body = &source->bodies[0];
    *body = ( picture_body ){
        .name = "mesh",
        .vertex_count = mesh->vertex_count,
        .triangles = mesh->triangles,
        .triangle_count = mesh->triangle_count,
    };
    WISP_TRY( picture_make_points( source, 0, false, error ) );
    load_still( source, 0, error );
    bool is_closed;
    wisp_status status = is_mesh_closed( body, &is_closed, error );
    body->kind = is_closed ? SCENE_BODY_COLLIDER : SCENE_BODY_CLOTH;
    return status;
}

static wisp_status open_still( picture_source* source, file_kind kind, const picture_source_def* def,
                               wisp_error* error )
{
    if ( def->value != PICTURE_BODY )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          def->value == PICTURE_MAP ? "%s: only surfaces of scenes have maps"
                                                    : "%s: a single shape without motion has no strain and no speed",
                          source->path );
    }
    source->frame_count = 1;
    WISP_TRY( picture_start( source, &still_input, sizeof( still ), error ) );
    WISP_TRY( picture_make_bodies( source, 1, error ) );
    return kind == FILE_GROOM ? read_still_groom( source, def->path, error )
                              : read_still_mesh( source, def->path, error );
}

// ---- any input ----

static wisp_status open_kind( picture_source* source, file_kind kind, const picture_source_def* def,
                              wisp_error* error )
{
    if ( def->mesh && kind != FILE_POINT_CACHE )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: --mesh expects a point cache (.pc2)", def->path );
    }
    if ( def->steps > 0 && kind != FILE_SCENE )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: --steps expects a scene", source->path );
    }
    if ( def->value == PICTURE_MAP && ( kind == FILE_RECORDING || kind == FILE_POINT_CACHE ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: only surfaces of scenes have maps", source->path );
    }
    switch ( kind )
    {
        case FILE_SCENE:
            return picture_open_scene( source, def, error );
        case FILE_RECORDING:
            return open_recording( source, def, error );
        case FILE_POINT_CACHE:
            return open_cache( source, def, error );
        case FILE_GROOM:
        case FILE_MESH:
            return open_still( source, kind, def, error );
        case FILE_RESULTS:
        case FILE_UNKNOWN:
            break;
    }
    return wisp_fail(
        error, WISP_BAD_INPUT,
        "%s: unknown kind of file, expected a scene (.yaml, .yml, .json), a recording (.wisp, .pc2), a mesh (.obj, "
        ".ply, .glb, .gltf) or a groom (.hair)",
        def->path );
}

// An option for boundary points needs a scene with a layer of them.
static wisp_status check_layers( const picture_source* source, const picture_source_def* def, wisp_error* error )
{
    bool has_layer = false;
    for ( int i = 0; i < source->body_count; ++i )
    {
        has_layer = has_layer || source->bodies[i].layer.spacing > 0.0f;
    }
    const bool is_queried = def->layer == PICTURE_LAYER_NORMAL || def->layer == PICTURE_LAYER_CLASS;
    if ( has_layer || !( is_queried || def->has_layer_normals ) )
    {
        return WISP_OK;
    }
    return wisp_fail( error, WISP_BAD_INPUT,
                      "%s: has no boundary points; the key 'boundary' adds them to a surface of a scene", def->path );
}

wisp_status picture_source_open( const picture_source_def* def, picture_source* out, wisp_error* error )
{
    *out = ( picture_source ){ .path = io_input_name( def->path ), .value = def->value, .frame = -1, .step = 1.0 };
    file_kind kind = FILE_UNKNOWN;
    wisp_status status = file_kind_find( def->path, &kind, error );
    status = status == WISP_OK ? open_kind( out, kind, def, error ) : status;
    status = status == WISP_OK ? check_layers( out, def, error ) : status;
    if ( status != WISP_OK )
    {
        picture_source_close( out );
    }
    return status;
}

wisp_status picture_source_load( picture_source* source, int frame, wisp_error* error )
{
    if ( frame == source->frame )
    {
        return WISP_OK;
    }
    wisp_status status = source->input->load( source, frame, error );
    source->frame = status == WISP_OK ? frame : -1;
    return status;
}

// Times increase, so the last frame that is not later is found by bisection.
wisp_status picture_source_find( picture_source* source, double seconds, int* frame, wisp_error* error )
{
    if ( !source->has_seconds )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: its frames have no times; select one with --frame",
                          source->path );
    }
    int lower = 0, upper = source->frame_count;
    double before = 0.0, after = 0.0;
    wisp_status status = source->input->time( source, 0, &before, error );
    while ( status == WISP_OK && upper - lower > 1 )
    {
        int middle = lower + ( upper - lower ) / 2;
        double at = 0.0;
        status = source->input->time( source, middle, &at, error );
        lower = at <= seconds ? middle : lower;
        upper = at <= seconds ? upper : middle;
        before = lower == middle ? at : before;
        after = upper == middle ? at : after;
    }
    if ( status != WISP_OK )
    {
        return status;
    }
    bool is_nearer_to_next = upper < source->frame_count && after - seconds < seconds - before;
    *frame = is_nearer_to_next ? lower + 1 : lower;
    double found = is_nearer_to_next ? after : before;
    if ( fabs( found - seconds ) > source->step )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: no frame at %g s; the nearest is at %g s", source->path,
                          seconds, found );
    }
    return WISP_OK;
}

void picture_source_close( picture_source* source )
{
    if ( source->state )
    {
        source->input->close( source );
    }
    io_release( &source->memory );
    *source = ( picture_source ){ 0 };
}
