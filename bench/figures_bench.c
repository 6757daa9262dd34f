// The case `figures`: its page, its pictures, and the figures of the balloon paper that are shapes.
#include "figures_bench.h"

#include "figures_drape.h"

#include "cloth/cloth.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

wisp_status figures_run( figures_fn* const* experiments, int count, const bench_options* options, results* out,
                         wisp_error* error )
{
    figures_case page = { .out = out, .pictures = options->pictures, .quick = options->quick };
    page.table = results_begin_table( out, "Figures of the papers as experiments",
                                      "figure\texperiment\texpected\tmeasured\tmet" );
    wisp_status status = balloon_mesh_figure( &page.figure, &page.figure_name, error );
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        bench_progress( options, (double)i / count, "figures" );
        status = experiments[i]( &page, error );
    }
    if ( status == WISP_OK )
    {
        results_add_note( out,
                          "Figures: the scanned body is the %s, %d vertices, scaled to the area of a sphere of 0.15 "
                          "m. Unless stated: steps of 1/60 s, 10 x 2, 0.02 kg/m^2, k_edge 2000 N/m, helium.",
                          page.figure_name, page.figure.vertex_count );
    }
    wisp_mesh_release( &page.figure );
    return status;
}

wisp_status figures_bench( const bench_options* options, results* out, wisp_error* error )
{
    static figures_fn* const all[] = {
        figures_two_particles,
        figures_links,
        figures_fixed_volume,
        figures_four_forces,
        figures_inflate_release,
        figures_spin,
        figures_rise_and_reverse,
        figures_real_time,
        figures_ghost_centre,
        figures_ghost_sway,
        figures_ghost_block,
        figures_ghost_apart,
        figures_ghost_curves,
        figures_ghost_spread,
        figures_ghost_pairing,
        figures_frozen_intensity,
        figures_frozen_stiffness,
        figures_frozen_clumps,
        figures_drape,
        figures_drape_steps,
        figures_free_flight,
        figures_hang_accuracy,
        figures_hang_refined,
    };
    return figures_run( all, WISP_COUNT( all ), options, out, error );
}

// ---- the page ----

static void add_figure( figures_case* page, const char* const told[3], bool meets_target, bool is_known,
                        const char* format, va_list arguments )
{
    char measured[300];
    vsnprintf( measured, sizeof( measured ), format, arguments );
    results_add_line( page->out, page->table, "%s\t%s\t%s\t%s\t%s", told[0], told[1], told[2], measured,
                      meets_target ? "yes"
                      : is_known   ? "known"
                                   : "NO" );
    if ( !meets_target && !is_known )
    {
        results_add_failure( page->out, "%s, %s: expected %s; measured %s.", told[0], told[1], told[2], measured );
    }
}

void figures_add( figures_case* page, const char* id, const char* experiment, const char* expected, bool meets_target,
                  const char* format, ... )
{
    va_list arguments;
    va_start( arguments, format );
    add_figure( page, ( const char* const[] ){ id, experiment, expected }, meets_target, false, format, arguments );
    va_end( arguments );
}

void figures_add_known( figures_case* page, const char* id, const char* experiment, const char* expected,
                        bool meets_target, const char* format, ... )
{
    va_list arguments;
    va_start( arguments, format );
    add_figure( page, ( const char* const[] ){ id, experiment, expected }, meets_target, true, format, arguments );
    va_end( arguments );
}

// ---- pictures ----

#define SHAPE_PIXELS 360

// Linear RGB, apart from each other and from the body.
static const wisp_vec3 TRACK_COLOURS[FIGURES_TRACKS_MAX] = {
    { 0.02f, 0.12f, 0.60f }, { 0.75f, 0.42f, 0.0f }, { 0.0f, 0.30f, 0.08f }, { 0.02f, 0.02f, 0.02f }
};

static void move_to_origin( wisp_vec3* points, int count )
{
    double centre[3] = { 0.0, 0.0, 0.0 };
    for ( int i = 0; i < count; ++i )
    {
        centre[0] += (double)points[i].x / count;
        centre[1] += (double)points[i].y / count;
        centre[2] += (double)points[i].z / count;
    }
    for ( int i = 0; i < count; ++i )
    {
        points[i].x -= (float)centre[0];
        points[i].y -= (float)centre[1];
        points[i].z -= (float)centre[2];
    }
}

wisp_status figures_take( const figures_case* page, figures_album* album, surface_implementation* implementation,
                          wisp_error* error, const char* format, ... )
{
    if ( !page->pictures || album->count == FIGURES_SHOTS_MAX )
    {
        return WISP_OK;
    }
    const wisp_vec3* points;
    wisp_status status = surface_implementation_points( implementation, &points, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    size_t bytes = (size_t)album->mesh->vertex_count * sizeof( wisp_vec3 );
    wisp_vec3* shot = malloc( bytes );
    if ( !shot )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a picture" );
    }
    memcpy( shot, points, bytes );
    if ( album->is_centred )
    {
        move_to_origin( shot, album->mesh->vertex_count );
    }
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( album->labels[album->count], sizeof( album->labels[0] ), format, arguments );
    va_end( arguments );
    album->shots[album->count++] = shot;
    return WISP_OK;
}

void figures_album_free( figures_album* album )
{
    for ( int i = 0; i < album->count; ++i )
    {
        free( album->shots[i] );
    }
    album->count = 0;
}

/// A scene of one or more shapes and perhaps tracks.
typedef struct shot_scene
{
    const figures_album* album;
    const figures_tracks* tracks; // [picture]; null: none
    int shots_per_picture;
    render_mesh meshes[FIGURES_SHOTS_MAX];
    render_curves curves[FIGURES_TRACKS_MAX];
    int32_t offsets[2];
    render_scene scene;
} shot_scene;

static const render_scene* set_shape_scene( void* context, int picture )
{
    shot_scene* out = context;
    const figures_album* album = out->album;
    out->scene = render_default_scene();
    out->scene.meshes = out->meshes;
    out->scene.mesh_count = out->shots_per_picture;
    for ( int i = 0; i < out->shots_per_picture; ++i )
    {
        out->meshes[i] = render_default_mesh( RENDER_LATEX );
        out->meshes[i].points = album->shots[picture * out->shots_per_picture + i];
        out->meshes[i].triangles = album->mesh->triangles;
        out->meshes[i].vertex_count = album->mesh->vertex_count;
        out->meshes[i].triangle_count = album->mesh->triangle_count;
    }
    if ( out->tracks )
    {
        const figures_tracks* tracks = out->tracks + picture;
        out->offsets[0] = 0;
        out->offsets[1] = tracks->length;
        for ( int i = 0; i < tracks->track_count; ++i )
        {
            out->curves[i] = render_default_curves();
            out->curves[i].points = tracks->points + (size_t)i * (size_t)tracks->length;
            out->curves[i].offsets = out->offsets;
            out->curves[i].strand_count = 1;
            out->curves[i].radius = tracks->radius;
            out->curves[i].colour = TRACK_COLOURS[i];
        }
        out->scene.curves = out->curves;
        out->scene.curves_count = tracks->track_count;
    }
    return &out->scene;
}

wisp_status figures_write( figures_case* page, const figures_album* album, const figures_tracks* tracks,
                           const char* name, const char* caption, wisp_error* error )
{
    if ( !page->pictures || album->count == 0 )
    {
        return WISP_OK;
    }
    picture_sheet sheet = { .count = 0 };
    const int each = album->shots_per_picture > 0 ? album->shots_per_picture : 1;
    shot_scene one = { .album = album, .tracks = tracks, .shots_per_picture = each };
    const picture_shots shots = { .scene = set_shape_scene,
                                  .context = &one,
                                  .count = album->count / each,
                                  .view = render_default_view(),
                                  .width = SHAPE_PIXELS,
                                  .height = SHAPE_PIXELS };
    const wisp_status status =
        picture_sheet_draw( &shots, album->labels[each - 1], (size_t)each * sizeof album->labels[0], &sheet, error );
    return picture_sheet_finish( &sheet, status, page->pictures, name, caption, page->out, error );
}

// ---- pictures of cloth on a ball ----

#define DRAPE_PIXELS 400
#define SHEET_COLUMNS 5 // more pictures make two rows
#define BALL_LEVEL 4    // of the icosphere that stands for the ball

typedef struct drape_stage
{
    const figures_album* album;
    const wisp_mesh* ball;
    render_mesh meshes[2];
    render_scene scene;
} drape_stage;

static const render_scene* set_drape_scene( void* context, int shot )
{
    drape_stage* out = context;
    const figures_album* album = out->album;
    const wisp_mesh* ball = out->ball;
    out->meshes[0] = render_default_mesh( RENDER_CLOTH );
    out->meshes[0].points = album->shots[shot];
    out->meshes[0].triangles = album->mesh->triangles;
    out->meshes[0].vertex_count = album->mesh->vertex_count;
    out->meshes[0].triangle_count = album->mesh->triangle_count;
    out->meshes[1] = render_default_mesh( RENDER_SOLID );
    out->meshes[1].points = ball->points;
    out->meshes[1].triangles = ball->triangles;
    out->meshes[1].vertex_count = ball->vertex_count;
    out->meshes[1].triangle_count = ball->triangle_count;
    out->scene = render_default_scene();
    out->scene.meshes = out->meshes;
    out->scene.mesh_count = ball->vertex_count > 0 ? 2 : 1;
    return &out->scene;
}

static wisp_status make_ball( wisp_mesh* out, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_ICOSPHERE );
    generator.level = BALL_LEVEL;
    generator.radius = TRIANGLE_BALL_RADIUS;
    wisp_status status = wisp_mesh_generate( &generator, out, error );
    for ( int i = 0; i < out->vertex_count; ++i )
    {
        out->points[i].y += TRIANGLE_BALL_HEIGHT;
    }
    return status;
}

// Each picture as a file of its own, numbered from 1.
static wisp_status write_each( const figures_case* page, const picture_sheet* sheet, const char* name,
                               wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < sheet->count && status == WISP_OK; ++i )
    {
        char path[4096], numbered[128];
        snprintf( numbered, sizeof( numbered ), "%s_%d", name, i + 1 );
        status = picture_path( page->pictures, numbered, path, sizeof( path ), error );
        status = status == WISP_OK ? image_write_png( path, &sheet->pictures[i], error ) : status;
    }
    return status;
}

wisp_status drape_write( figures_case* page, const figures_album* album, bool has_ball, const char* name,
                         const char* caption, wisp_error* error )
{
    if ( !page->pictures || album->count == 0 )
    {
        return WISP_OK;
    }
    picture_sheet sheet = { .columns = album->count > SHEET_COLUMNS ? ( album->count + 1 ) / 2 : album->count };
    wisp_mesh ball = { 0 };
    wisp_status status = has_ball ? make_ball( &ball, error ) : WISP_OK;
    drape_stage one = { .album = album, .ball = &ball };
    const picture_shots shots = { .scene = set_drape_scene,
                                  .context = &one,
                                  .count = album->count,
                                  .view = render_default_view(),
                                  .width = DRAPE_PIXELS,
                                  .height = DRAPE_PIXELS };
    status = status == WISP_OK
                 ? picture_sheet_draw( &shots, album->labels[0], sizeof album->labels[0], &sheet, error )
                 : status;
    wisp_mesh_release( &ball );
    status = status == WISP_OK ? write_each( page, &sheet, name, error ) : status;
    return picture_sheet_finish( &sheet, status, page->pictures, name, caption, page->out, error );
}

// ---- shapes ----

// Figures 1 to 3: what a projection does, which links there are, and how a body follows its volume.

// ---- F1 ----

static const wisp_vec3 triangle_points[] = { { 0.0f, 0.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 0.5f, 0.0f, -0.8f } };
static const int32_t triangle[] = { 0, 1, 2 };

// Only the link between the first two vertices answers; the third makes a triangle of them and stays out of it.
static void leave_two( surface_implementation* implementation, float w0, float w1 )
{
    const wisp_fabric* f = implementation->fabric;
    float* stiffness = wisp_world_column( implementation->world, implementation->entity, WISP_LINK_STIFFNESS, 0 );
    float* position = wisp_world_column( implementation->world, implementation->entity, WISP_PARTICLE_POSITION, 0 );
    int first = 4 * f->vertex_slot[0], second = 4 * f->vertex_slot[1];
    for ( int slot = 0; slot < f->link_order.slot_count; ++slot )
    {
        int a = f->link_a_x4[slot], b = f->link_b_x4[slot];
        bool is_theirs = ( a == first && b == second ) || ( a == second && b == first );
        stiffness[slot] = is_theirs ? 1.0f : 0.0f;
    }
    position[first + 3] = w0;
    position[second + 3] = w1;
}

// @param error_out receives the larger error of length (m) and of the ratio of the two ways
static wisp_status project_pair( float w0, float w1, double* error_out, wisp_error* error )
{
    const wisp_vec3 stretched[] = { { -0.25f, 0.0f, 0.0f }, { 1.25f, 0.0f, 0.0f }, { 0.5f, 0.0f, -0.8f } };
    wisp_fabric_def def = wisp_default_fabric_def();
    def.points = triangle_points;
    def.triangles = triangle;
    def.vertex_count = 3;
    def.triangle_count = 1;
    wisp_fabric* fabric = NULL;
    surface_implementation implementation = { 0 };
    wisp_status status = wisp_fabric_cook( &def, NULL, &fabric, error );
    if ( status == WISP_OK )
    {
        surface_generator generator = surface_default_generator( &wisp_cloth_module, fabric );
        generator.points = stretched;
        generator.vertex_mass = 1.0f;
        status = surface_implementation_create( &generator, &implementation, error );
    }
    if ( status == WISP_OK )
    {
        wisp_cloth_def cloth = wisp_default_cloth_def();
        cloth.solver = WISP_SOLVER_PBD;
        cloth.internal_damping = 0.0f;
        status = wisp_set_cloth( implementation.world, implementation.entity, &cloth );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( implementation.world, status, error );
    }
    const wisp_vec3* points = NULL;
    if ( status == WISP_OK )
    {
        leave_two( &implementation, w0, w1 );
        status = surface_implementation_step( &implementation, error );
        status = status == WISP_OK ? surface_implementation_points( &implementation, &points, error ) : status;
    }
    if ( status == WISP_OK )
    {
        double way0 = (double)( points[0].x - stretched[0].x ), way1 = (double)( stretched[1].x - points[1].x );
        double wrong_length = fabs( (double)( points[1].x - points[0].x ) - 1.0 );
        double wrong_ratio = fabs( way0 * (double)w1 - way1 * (double)w0 );
        *error_out = fmax( *error_out, fmax( wrong_length, wrong_ratio ) );
    }
    surface_implementation_destroy( &implementation );
    wisp_fabric_release( fabric );
    return status;
}

wisp_status figures_two_particles( figures_case* page, wisp_error* error )
{
    static const float weights[][2] = { { 1.0f, 1.0f }, { 1.0f, 3.0f }, { 0.0f, 1.0f } };
    double largest = 0.0;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( weights ) && status == WISP_OK; ++i )
    {
        status = project_pair( weights[i][0], weights[i][1], &largest, error );
    }
    if ( status == WISP_OK )
    {
        // a handful of roundings of coordinates of 1 m
        figures_add( page, "F1", "two particles 1.5 m apart, rest 1 m, w1 : w2 = 1:1, 1:3, 0:1",
                     "one projection restores 1 m, ways in the ratio of w", largest < 1e-6, "largest error %.1e m",
                     largest );
    }
    return status;
}

// ---- F2 ----

wisp_status figures_links( figures_case* page, wisp_error* error )
{
    const wisp_vec3 points[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0.5f, 0, 0.8f }, { 0.5f, 0, -0.8f } };
    const int32_t pair[] = { 0, 2, 1, 0, 1, 3 };
    wisp_fabric_def def = wisp_default_fabric_def();
    def.points = points;
    def.triangles = pair;
    def.vertex_count = 4;
    def.triangle_count = 2;
    wisp_fabric* fabric = NULL;
    wisp_status status = wisp_fabric_cook( &def, NULL, &fabric, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    int bends = fabric->link_count - fabric->edge_count;
    figures_add( page, "F2", "a pair of triangles", "5 structural edges, 1 bend pair",
                 fabric->edge_count == 5 && bends == 1, "%d edges, %d bend pairs", fabric->edge_count, bends );
    wisp_fabric_release( fabric );

    status = surface_cook( &page->figure, wisp_default_fabric_def(), &fabric, error );
    if ( status == WISP_OK )
    {
        bends = fabric->link_count - fabric->edge_count;
        figures_add( page, "F2", "a closed mesh", "edges = 3/2 triangles, as many bend pairs",
                     2 * fabric->edge_count == 3 * fabric->triangle_count && bends == fabric->edge_count,
                     "%d triangles, %d edges, %d bend pairs", fabric->triangle_count, fabric->edge_count, bends );
        wisp_fabric_release( fabric );
    }
    return status;
}

// ---- F3 ----

#define RAMP_STEPS 60
#define SETTLE_STEPS 30

typedef struct volume_run
{
    double error;  // V / V_0 - 1 at the end
    int reversals; // steps in which the volume went against the ramp by more than rounding
} volume_run;

static wisp_status follow_volume( figures_case* page, wisp_fabric* fabric, float gas_ratio, figures_album* album,
                                  volume_run* out, wisp_error* error )
{
    balloon_setting setting = balloon_setting_in_vacuum();
    setting.def.solver = WISP_SOLVER_PBD;
    setting.def.volume = WISP_SOLVER_PBD;
    setting.def.min_gas_ratio = 0.5f;
    setting.damping = 5.0f;
    surface_implementation implementation = { 0 };
    wisp_status status = balloon_implementation_create( fabric, &setting, &implementation, error );
    double rest = balloon_volume( &page->figure, page->figure.points ), before = rest;
    for ( int s = 1; s <= RAMP_STEPS + SETTLE_STEPS && status == WISP_OK; ++s )
    {
        float fraction = fminf( (float)s / RAMP_STEPS, 1.0f );
        status = wisp_set_balloon_gas_ratio( implementation.world, implementation.entity,
                                             1.0f + fraction * ( gas_ratio - 1.0f ) );
        status = status == WISP_OK ? surface_implementation_step( &implementation, error )
                                   : bench_world_fail( implementation.world, status, error );
        const wisp_vec3* points = NULL;
        status = status == WISP_OK ? surface_implementation_points( &implementation, &points, error ) : status;
        if ( status == WISP_OK )
        {
            double now = balloon_volume( &page->figure, points );
            double along = ( now - before ) * ( gas_ratio < 1.0f ? -1.0 : 1.0 );
            out->reversals += s <= RAMP_STEPS && along < -1e-4 * rest;
            before = now;
        }
    }
    out->error = before / ( rest * (double)gas_ratio ) - 1.0;
    status = status == WISP_OK
                 ? figures_take( page, album, &implementation, error, "V0 / V = %.1f", (double)gas_ratio )
                 : status;
    surface_implementation_destroy( &implementation );
    return status;
}

wisp_status figures_fixed_volume( figures_case* page, wisp_error* error )
{
    static const float fills[] = { 0.5f, 1.0f, 1.5f, 2.0f };
    figures_album album = { .mesh = &page->figure };
    wisp_fabric* fabric = NULL;
    wisp_status status = surface_cook( &page->figure, wisp_default_fabric_def(), &fabric, error );
    for ( int i = 0; i < WISP_COUNT( fills ) && status == WISP_OK; ++i )
    {
        volume_run run = { 0.0, 0 };
        char experiment[80];
        status = follow_volume( page, fabric, fills[i], &album, &run, error );
        snprintf( experiment, sizeof( experiment ), "the %s led to %.1f of its volume in 1 s", page->figure_name,
                  (double)fills[i] );
        if ( status == WISP_OK )
        {
            figures_add( page, "F3", experiment, "V within 1 % of V_0, never against the ramp",
                         fabs( run.error ) < 0.01 && run.reversals == 0, "V / V_0 - 1 = %.4f %%, %d steps against it",
                         100.0 * run.error, run.reversals );
        }
    }
    status = status == WISP_OK ? figures_write( page, &album, NULL, "f3_volume", "F3, shrinking and swelling", error )
                               : status;
    figures_album_free( &album );
    wisp_fabric_release( fabric );
    return status;
}
