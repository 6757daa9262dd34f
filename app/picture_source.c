#include "picture_source.h"

#include "io_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    wisp_status status = wisp_groom_read( path, groom, error );
    wisp_error cause = { 0 };
    if ( status == WISP_OK && wisp_groom_check( groom, &cause ) != WISP_OK )
    {
        status = wisp_fail( error, cause.status, "%s: %s", source->path, cause.message );
    }
    if ( status != WISP_OK )
    {
        return status;
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
    // The body owns them from here on, like those that a scene fills.
    groom->thickness = NULL;
    groom->colour = NULL;
    return picture_make_points( source, 0, false, error );
}

static wisp_status read_still_mesh( picture_source* source, const char* path, wisp_error* error )
{
    wisp_mesh* mesh = &( (still*)source->state )->mesh;
    wisp_status status = wisp_mesh_read( path, mesh, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    picture_body* body = &source->bodies[0];
    *body = ( picture_body ){
        .name = "mesh",
        .vertex_count = mesh->vertex_count,
        .triangles = mesh->triangles,
        .triangle_count = mesh->triangle_count,
    };
    status = picture_make_points( source, 0, false, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    load_still( source, 0, error );
    bool is_closed;
    status = picture_is_closed( body, &is_closed, error );
    body->kind = is_closed ? SCENE_BODY_COLLIDER : SCENE_BODY_CLOTH;
    return status;
}

wisp_status picture_open_still( picture_source* source, file_kind kind, const picture_source_def* def,
                                wisp_error* error )
{
    if ( def->value != PICTURE_BODY )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          def->value == PICTURE_MAP ? "%s: only surfaces of scenes have maps"
                                                    : "%s: a single shape without motion has no strain and no speed",
                          source->path );
    }
    source->input = &still_input;
    source->frame_count = 1;
    source->state = calloc( 1, sizeof( still ) );
    wisp_status status = source->state ? WISP_OK : picture_no_memory( source, error );
    if ( status == WISP_OK )
    {
        status = picture_make_bodies( source, 1, error );
    }
    if ( status == WISP_OK )
    {
        status = kind == FILE_GROOM ? read_still_groom( source, def->path, error )
                                    : read_still_mesh( source, def->path, error );
    }
    return status;
}

// ---- any input ----

static wisp_status open_kind( picture_source* source, file_kind kind, const picture_source_def* def,
                              wisp_error* error )
{
    if ( def->mesh && kind != FILE_POINT_CACHE )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: --mesh expects a point cache (.pc2)", def->path );
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
            return picture_open_recording( source, def, error );
        case FILE_POINT_CACHE:
            return picture_open_cache( source, def, error );
        case FILE_GROOM:
        case FILE_MESH:
            return picture_open_still( source, kind, def, error );
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
    if ( status == WISP_OK )
    {
        status = open_kind( out, kind, def, error );
    }
    if ( status == WISP_OK )
    {
        status = check_layers( out, def, error );
    }
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
    for ( int i = 0; i < source->body_count; ++i )
    {
        free( source->bodies[i].points );
        free( source->bodies[i].widths );
        free( source->bodies[i].colours );
        free( source->bodies[i].values );
        free( source->bodies[i].layer.points );
        free( source->bodies[i].layer.normals );
    }
    free( source->bodies );
    free( source->points );
    free( source->state );
    *source = ( picture_source ){ 0 };
}
