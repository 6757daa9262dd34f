// Pictures of layers: points on edges and inside triangles in two colours, with short normals.
#include "boundary_bench.h"

#include "picture_sheet.h"

#include <math.h>
#include <stdlib.h>

#define MARGIN 1.06 // of the distance, for the lines on a shape
#define SHOTS_MAX 3

static const wisp_vec3 EDGE_COLOUR = { 0.85f, 0.22f, 0.03f };
static const wisp_vec3 INNER_COLOUR = { 0.03f, 0.22f, 0.62f };
static const wisp_vec3 SKIN_COLOUR = { 0.72f, 0.72f, 0.7f };
static const wisp_vec3 NORMAL_COLOUR = { 0.12f, 0.12f, 0.14f };

/// A copy of a surface and the points on it.
typedef struct shot
{
    wisp_vec3 *vertices, *points, *colours, *lines; // lines: two per point
    int32_t* offsets;                               // [count + 1] of the lines
    int count;
    float radius, line_radius; // m, of a point and of a normal
    char label[64];
} shot;

typedef struct shots
{
    const wisp_mesh* mesh;
    shot all[SHOTS_MAX];
    int count;
    bool has_normals;
} shots;

static void free_shots( shots* s )
{
    for ( int i = 0; i < s->count; ++i )
    {
        free( s->all[i].vertices );
        free( s->all[i].points );
        free( s->all[i].colours );
        free( s->all[i].lines );
        free( s->all[i].offsets );
    }
    s->count = 0;
}

static bool make_room( shot* out, int vertices, int points )
{
    const size_t n = (size_t)points + 1; // a layer may be empty
    out->vertices = malloc( (size_t)vertices * sizeof( wisp_vec3 ) );
    out->points = malloc( n * sizeof( wisp_vec3 ) );
    out->colours = malloc( n * sizeof( wisp_vec3 ) );
    out->lines = malloc( 2 * n * sizeof( wisp_vec3 ) );
    out->offsets = malloc( n * sizeof( int32_t ) );
    return out->vertices && out->points && out->colours && out->lines && out->offsets;
}

static void fill( shot* out, const wisp_samples* s, float line_length )
{
    out->offsets[0] = 0;
    for ( int p = 0; p < s->count; ++p )
    {
        const float *q = s->xyzw + 4 * (size_t)p, *n = s->normals + 4 * (size_t)p;
        out->points[p] = ( wisp_vec3 ){ q[0], q[1], q[2] };
        out->colours[p] = p < s->edge_count ? EDGE_COLOUR : INNER_COLOUR;
        out->lines[2 * p] = out->points[p];
        out->lines[2 * p + 1] =
            ( wisp_vec3 ){ q[0] + line_length * n[0], q[1] + line_length * n[1], q[2] + line_length * n[2] };
        out->offsets[p + 1] = 2 * ( p + 1 );
    }
}

// @param gap m, distance of the points, which determines their size
static wisp_status take( shots* all, surface_implementation* implementation, float gap, const char* what,
                         wisp_error* error )
{
    const wisp_vec3* vertices;
    wisp_boundary_view view;
    wisp_status status = surface_implementation_points( implementation, &vertices, error );
    status = status == WISP_OK ? layer_read( implementation, &view, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    shot* s = all->all + all->count++;
    *s = ( shot ){ .count = view.samples->count, .radius = 0.28f * gap, .line_radius = 0.05f * gap };
    if ( !make_room( s, all->mesh->vertex_count, s->count ) )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a picture" );
    }
    for ( int v = 0; v < all->mesh->vertex_count; ++v )
    {
        s->vertices[v] = vertices[v];
    }
    fill( s, view.samples, 1.4f * gap );
    snprintf( s->label, sizeof( s->label ), "%s: %d on edges, %d inside", what, view.samples->edge_count,
              view.samples->count - view.samples->edge_count );
    return WISP_OK;
}

// ---- drawing ----

typedef struct stage
{
    render_mesh mesh;
    render_points points;
    render_curves normals;
    render_scene scene;
} stage;

static void set_stage( const shots* all, int i, stage* out )
{
    const shot* s = all->all + i;
    out->mesh = render_default_mesh( RENDER_SOLID );
    out->mesh.points = s->vertices;
    out->mesh.triangles = all->mesh->triangles;
    out->mesh.vertex_count = all->mesh->vertex_count;
    out->mesh.triangle_count = all->mesh->triangle_count;
    out->mesh.colour = SKIN_COLOUR;
    out->points = render_default_points();
    out->points.points = s->points;
    out->points.colours = s->colours;
    out->points.count = s->count;
    out->points.radius = s->radius;
    out->normals = render_default_curves();
    out->normals.points = s->lines;
    out->normals.offsets = s->offsets;
    out->normals.strand_count = s->count;
    out->normals.radius = s->line_radius;
    out->normals.colour = NORMAL_COLOUR;
    out->scene = render_default_scene();
    out->scene.meshes = &out->mesh;
    out->scene.mesh_count = 1;
    out->scene.points = &out->points;
    out->scene.points_count = 1;
    out->scene.curves = &out->normals;
    out->scene.curves_count = all->has_normals ? 1 : 0;
}

// The ball about the middle of all shots, with the lines on them.
static double find_ball( const shots* all, wisp_vec3* middle )
{
    wisp_vec3 lower = { INFINITY, INFINITY, INFINITY }, upper = { -INFINITY, -INFINITY, -INFINITY };
    double square = 0.0;
    for ( int pass = 0; pass < 2; ++pass )
    {
        for ( int i = 0; i < all->count; ++i )
        {
            for ( int v = 0; v < all->mesh->vertex_count; ++v )
            {
                const wisp_vec3 p = all->all[i].vertices[v];
                const double x = (double)( p.x - middle->x ), y = (double)( p.y - middle->y ),
                             z = (double)( p.z - middle->z );
                square = pass == 1 ? fmax( square, x * x + y * y + z * z ) : 0.0;
                lower = ( wisp_vec3 ){ fminf( lower.x, p.x ), fminf( lower.y, p.y ), fminf( lower.z, p.z ) };
                upper = ( wisp_vec3 ){ fmaxf( upper.x, p.x ), fmaxf( upper.y, p.y ), fmaxf( upper.z, p.z ) };
            }
        }
        *middle =
            ( wisp_vec3 ){ 0.5f * ( lower.x + upper.x ), 0.5f * ( lower.y + upper.y ), 0.5f * ( lower.z + upper.z ) };
    }
    return sqrt( square );
}

// One camera for all shots, so that sizes can be compared. It is close enough to show points: it fits a ball, not a
// box.
static render_camera find_camera( const shots* all )
{
    const double degrees = 57.29577951308232;
    const render_view view = render_default_view();
    const double azimuth = (double)view.azimuth_degrees / degrees,
                 elevation = (double)view.elevation_degrees / degrees;
    render_camera camera = { .up = { 0.0f, 1.0f, 0.0f }, .fov_degrees = view.fov_degrees };
    camera.target = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    const double radius = find_ball( all, &camera.target );
    const double away = MARGIN * radius / sin( 0.5 * (double)view.fov_degrees / degrees );
    camera.eye = ( wisp_vec3 ){ camera.target.x + (float)( away * cos( elevation ) * sin( azimuth ) ),
                                camera.target.y + (float)( away * sin( elevation ) ),
                                camera.target.z + (float)( away * cos( elevation ) * cos( azimuth ) ) };
    return camera;
}

static wisp_status draw( const boundary_plan* plan, const shots* all, picture_sheet* sheet, wisp_error* error )
{
    const render_camera camera = find_camera( all );
    render_options options = render_default_options();
    options.width = options.height = all->count == 1 ? 2 * plan->picture_side : plan->picture_side;
    options.threads = 2;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < all->count && status == WISP_OK; ++i )
    {
        stage one;
        set_stage( all, i, &one );
        status = render_picture( &one.scene, &camera, &options, sheet->pictures + i, error );
        sheet->labels[i] = all->all[i].label;
        sheet->count = i + 1;
    }
    return status;
}

static wisp_status write_shots( const boundary_plan* plan, const shots* all, const char* name, const char* caption,
                                results* out, wisp_error* error )
{
    picture_sheet sheet = { .count = 0 };
    const wisp_status status = draw( plan, all, &sheet, error );
    return picture_sheet_finish( &sheet, status, plan->options->pictures, name, caption, out, error );
}

// ---- the pictures ----

// A layer on a static mesh.
static wisp_status take_still( shots* all, wisp_fabric* fabric, float spacing, const char* what, wisp_error* error )
{
    const wisp_boundary_def def = layer_def( &layer_laws[0], spacing );
    layer_implementation implementation;
    wisp_status status = layer_enter( fabric, &def, 1, &implementation, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = layer_step( &implementation, error );
    status = status == WISP_OK ? take( all, &implementation.surface, spacing, what, error ) : status;
    surface_implementation_destroy( &implementation.surface );
    return status;
}

static wisp_status picture_body( const boundary_plan* plan, results* out, wisp_error* error )
{
    const char* name;
    wisp_mesh mesh = { 0 };
    wisp_fabric* fabric = NULL;
    shots all = { .mesh = &mesh, .has_normals = true };
    wisp_status status = balloon_mesh_figure( &mesh, &name, error );
    status = status == WISP_OK ? layer_cook( &mesh, &fabric, error ) : status;
    status = status == WISP_OK ? take_still( &all, fabric, 0.004f, "d = 4 mm", error ) : status;
    status = status == WISP_OK
                 ? write_shots( plan, &all, "boundary_body", "Boundary points and their normals", out, error )
                 : status;
    free_shots( &all );
    wisp_fabric_release( fabric );
    wisp_mesh_release( &mesh );
    return status;
}

static wisp_status picture_spacings( const boundary_plan* plan, const wisp_mesh* mesh, wisp_fabric* fabric,
                                     results* out, wisp_error* error )
{
    shots all = { .mesh = mesh };
    wisp_status status = take_still( &all, fabric, 0.2f, "d = 0.2 m", error );
    status = status == WISP_OK ? take_still( &all, fabric, 0.05f, "d = 0.05 m", error ) : status;
    status = status == WISP_OK
                 ? write_shots( plan, &all, "boundary_spacing", "The reference sphere at two spacings", out, error )
                 : status;
    free_shots( &all );
    return status;
}

static wisp_status swell( surface_implementation* balloon, float from, float to, int steps, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int step = 1; step <= steps && status == WISP_OK; ++step )
    {
        const float gas_ratio = from + ( to - from ) * (float)step / (float)steps;
        status = wisp_set_balloon_gas_ratio( balloon->world, balloon->entity, gas_ratio );
        status = status == WISP_OK ? surface_implementation_step( balloon, error )
                                   : bench_world_fail( balloon->world, status, error );
    }
    return status;
}

static wisp_status picture_inflation( const boundary_plan* plan, const wisp_mesh* mesh, wisp_fabric* fabric,
                                      results* out, wisp_error* error )
{
    const layer_balloon setting = layer_default_balloon();
    const wisp_boundary_def def = layer_def( &layer_laws[0], LAYER_SPACING );
    surface_implementation balloon = { 0 };
    shots all = { .mesh = mesh };
    wisp_status status = layer_enter_balloon( fabric, mesh, &setting, &balloon, error );
    status = status == WISP_OK ? layer_set( &balloon, &def, error ) : status;
    status = status == WISP_OK ? swell( &balloon, 1.0f, 1.0f, 10, error ) : status;
    status = status == WISP_OK ? take( &all, &balloon, LAYER_SPACING, "V x 1", error ) : status;
    status = status == WISP_OK ? swell( &balloon, 1.0f, 2.0f, 60, error ) : status;
    status = status == WISP_OK ? take( &all, &balloon, LAYER_SPACING, "V x 2", error ) : status;
    status = status == WISP_OK ? swell( &balloon, 2.0f, 1.0f, 60, error ) : status;
    status = status == WISP_OK ? swell( &balloon, 1.0f, 1.0f, 10, error ) : status;
    status = status == WISP_OK ? take( &all, &balloon, LAYER_SPACING, "V x 1 again", error ) : status;
    surface_implementation_destroy( &balloon );
    status = status == WISP_OK
                 ? write_shots( plan, &all, "boundary_inflation", "The sphere inflated 1 -> 2 -> 1", out, error )
                 : status;
    free_shots( &all );
    return status;
}

wisp_status boundary_pictures( const boundary_plan* plan, results* out, wisp_error* error )
{
    if ( plan->options->pictures == NULL )
    {
        return WISP_OK;
    }
    wisp_mesh mesh = { 0 };
    wisp_fabric* fabric = NULL;
    wisp_status status = layer_sphere( LAYER_SEGMENTS, LAYER_RADIUS, &mesh, error );
    status = status == WISP_OK ? layer_cook( &mesh, &fabric, error ) : status;
    status = status == WISP_OK ? picture_body( plan, out, error ) : status;
    status = status == WISP_OK ? picture_inflation( plan, &mesh, fabric, out, error ) : status;
    status = status == WISP_OK ? picture_spacings( plan, &mesh, fabric, out, error ) : status;
    wisp_fabric_release( fabric );
    wisp_mesh_release( &mesh );
    return status;
}
