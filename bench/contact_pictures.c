// What contact looks like: balloons that flatten on each other, whole and cut open, a stack of them, and a cloth
// whose two sides have two colours, so that its layers can be told apart.
#include "contact_bench.h"

#include "picture_sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SHOTS_MAX 6
#define BODIES_MAX ( CONTACT_SURFACES_MAX + 2 )
#define BALL_LEVEL 4
#define STRIPES 16 // of the cloth, along either side

static const wisp_vec3 FRONT = { 0.78f, 0.16f, 0.05f }, FRONT_STRIPE = { 0.92f, 0.5f, 0.28f };
static const wisp_vec3 BACK = { 0.03f, 0.24f, 0.5f }, BACK_STRIPE = { 0.3f, 0.62f, 0.8f };

/// A body of a picture; what it points to is its own.
typedef struct body
{
    wisp_vec3 *points, *colours;
    int32_t* triangles;
    int vertex_count, triangle_count;
    wisp_vec3 colour;
    render_material material;
    bool is_faceted;
} body;

typedef struct shot
{
    body bodies[BODIES_MAX];
    int count;
    char label[40];
} shot;

typedef struct album
{
    shot shots[SHOTS_MAX];
    int count, columns;
    float aspect; // width / height of a picture
    render_view view;
    const char *name, *caption;
} album;

static void free_album( album* all )
{
    for ( int s = 0; s < all->count; ++s )
    {
        for ( int b = 0; b < all->shots[s].count; ++b )
        {
            free( all->shots[s].bodies[b].points );
            free( all->shots[s].bodies[b].colours );
            free( all->shots[s].bodies[b].triangles );
        }
    }
    all->count = 0;
}

// ---- bodies ----

static wisp_status add_body( shot* s, const wisp_mesh* mesh, const wisp_vec3* points, render_material material,
                             wisp_vec3 colour, wisp_error* error )
{
    const size_t bytes = (size_t)mesh->vertex_count * sizeof( wisp_vec3 );
    const size_t corners = 3 * (size_t)mesh->triangle_count * sizeof( int32_t );
    body* b = s->bodies + s->count++;
    *b = ( body ){
        .points = malloc( bytes ),
        .triangles = malloc( corners ),
        .vertex_count = mesh->vertex_count,
        .triangle_count = mesh->triangle_count,
        .colour = colour,
        .material = material,
    };
    if ( b->points == NULL || b->triangles == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a picture" );
    }
    memcpy( b->points, points, bytes );
    memcpy( b->triangles, mesh->triangles, corners );
    return WISP_OK;
}

static wisp_vec3 on_plane( wisp_vec3 a, wisp_vec3 b, float z )
{
    const float t = ( z - a.z ) / ( b.z - a.z );
    return ( wisp_vec3 ){ a.x + t * ( b.x - a.x ), a.y + t * ( b.y - a.y ), z };
}

// What a triangle has behind the plane: up to four corners.
static int clip( const wisp_vec3* corners, float z, wisp_vec3* out )
{
    int count = 0;
    for ( int i = 0; i < 3; ++i )
    {
        const wisp_vec3 a = corners[i], b = corners[( i + 1 ) % 3];
        if ( a.z <= z )
        {
            out[count++] = a;
        }
        if ( ( a.z <= z ) != ( b.z <= z ) )
        {
            out[count++] = on_plane( a, b, z );
        }
    }
    return count;
}

// Leave what is behind a plane across z. Triangles that it cuts get corners of their own, behind those of the mesh.
static wisp_status cut_open( body* b, float z, wisp_error* error )
{
    const size_t triangles = (size_t)b->triangle_count, vertices = (size_t)b->vertex_count;
    wisp_vec3* points = realloc( b->points, ( vertices + 4 * triangles ) * sizeof( wisp_vec3 ) );
    b->points = points != NULL ? points : b->points;
    int32_t* kept = malloc( 2 * 3 * triangles * sizeof( int32_t ) );
    if ( points == NULL || kept == NULL )
    {
        free( kept );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a picture" );
    }
    int count = 0;
    for ( int t = 0; t < b->triangle_count; ++t )
    {
        const int32_t* v = b->triangles + 3 * (size_t)t;
        const wisp_vec3 corners[3] = { points[v[0]], points[v[1]], points[v[2]] };
        wisp_vec3 left[4];
        const int left_count = clip( corners, z, left );
        if ( left_count == 3 && memcmp( left, corners, sizeof( corners ) ) == 0 )
        {
            memcpy( kept + 3 * (size_t)count++, v, 3 * sizeof( int32_t ) );
            continue;
        }
        for ( int i = 2; i < left_count; ++i )
        {
            const int32_t fan[3] = { b->vertex_count, b->vertex_count + i - 1, b->vertex_count + i };
            memcpy( kept + 3 * (size_t)count++, fan, sizeof( fan ) );
        }
        memcpy( points + b->vertex_count, left, (size_t)left_count * sizeof( wisp_vec3 ) );
        b->vertex_count += left_count;
    }
    free( b->triangles );
    b->triangles = kept;
    b->triangle_count = count;
    return WISP_OK;
}

// @param cut m, what is before it is left out; infinite: nothing is
static wisp_status add_balloons( shot* s, contact_world* world, float cut, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < world->surface_count && status == WISP_OK; ++i )
    {
        const wisp_vec3* points;
        status = contact_points( world, i, &points, error );
        status = status == WISP_OK
                     ? add_body( s, &world->scene->mesh, points, RENDER_LATEX, render_palette( i ), error )
                     : status;
        if ( status == WISP_OK && cut < INFINITY )
        {
            status = cut_open( s->bodies + s->count - 1, cut, error );
        }
    }
    return status;
}

// Sums of the normals of the triangles around each vertex, made to unit length.
static void find_normals( const wisp_mesh* mesh, const wisp_vec3* x, wisp_vec3* normals )
{
    memset( normals, 0, (size_t)mesh->vertex_count * sizeof( wisp_vec3 ) );
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        const int32_t* v = mesh->triangles + 3 * (size_t)t;
        const wisp_vec3 a = x[v[0]], b = x[v[1]], c = x[v[2]];
        const wisp_vec3 u = { b.x - a.x, b.y - a.y, b.z - a.z }, w = { c.x - a.x, c.y - a.y, c.z - a.z };
        const wisp_vec3 n = { u.y * w.z - u.z * w.y, u.z * w.x - u.x * w.z, u.x * w.y - u.y * w.x };
        for ( int k = 0; k < 3; ++k )
        {
            wisp_vec3* sum = normals + v[k];
            *sum = ( wisp_vec3 ){ sum->x + n.x, sum->y + n.y, sum->z + n.z };
        }
    }
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        wisp_vec3* n = normals + i;
        const float length = sqrtf( n->x * n->x + n->y * n->y + n->z * n->z );
        const float scale = length > 0.0f ? 1.0f / length : 0.0f;
        *n = ( wisp_vec3 ){ scale * n->x, scale * n->y, scale * n->z };
    }
}

// One side of the cloth: a little above the vertices on that side, in its colour, with stripes along the rows.
static wisp_status add_side( shot* s, contact_world* world, const wisp_vec3* points, float way, wisp_vec3 colour,
                             wisp_vec3 stripe, wisp_error* error )
{
    const wisp_mesh* mesh = &world->scene->mesh;
    wisp_status status = add_body( s, mesh, points, RENDER_CLOTH, colour, error );
    body* b = s->bodies + s->count - 1;
    wisp_vec3* normals = malloc( (size_t)mesh->vertex_count * sizeof( wisp_vec3 ) );
    b->colours = malloc( (size_t)mesh->vertex_count * sizeof( wisp_vec3 ) );
    if ( status == WISP_OK && ( normals == NULL || b->colours == NULL ) )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for a picture" );
    }
    if ( status == WISP_OK )
    {
        const int side = (int)lround( sqrt( mesh->vertex_count ) ), wide = side / STRIPES > 1 ? side / STRIPES : 1;
        find_normals( mesh, points, normals );
        for ( int v = 0; v < mesh->vertex_count; ++v )
        {
            wisp_vec3 *p = b->points + v, n = normals[v];
            *p = ( wisp_vec3 ){ p->x + way * n.x, p->y + way * n.y, p->z + way * n.z };
            b->colours[v] = v / side / wide % 2 == 0 ? colour : stripe;
        }
    }
    free( normals );
    return status;
}

static wisp_status add_cloth( shot* s, contact_world* world, wisp_error* error )
{
    const wisp_vec3* points;
    const float way = 0.2f * world->scene->thickness; // the two sides of one layer stay nearer than two layers
    wisp_status status = contact_points( world, 0, &points, error );
    status = status == WISP_OK ? add_side( s, world, points, way, FRONT, FRONT_STRIPE, error ) : status;
    return status == WISP_OK ? add_side( s, world, points, -way, BACK, BACK_STRIPE, error ) : status;
}

static wisp_status add_ball( shot* s, wisp_vec3 centre, wisp_error* error )
{
    wisp_mesh mesh = { 0 };
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_ICOSPHERE );
    generator.level = BALL_LEVEL;
    generator.radius = FOLD_BALL_RADIUS;
    wisp_status status = wisp_mesh_generate( &generator, &mesh, error );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        wisp_vec3* p = mesh.points + v;
        *p = ( wisp_vec3 ){ p->x + centre.x, p->y + centre.y, p->z + centre.z };
    }
    const wisp_vec3 grey = { 0.55f, 0.55f, 0.52f };
    status = status == WISP_OK ? add_body( s, &mesh, mesh.points, RENDER_SOLID, grey, error ) : status;
    wisp_mesh_release( &mesh );
    return status;
}

// A plate as a thin box.
static wisp_status add_plate( shot* s, int number, int step, wisp_error* error )
{
    static const int32_t triangles[] = { 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                         2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
    const float at = contact_plate_at( number, (float)step ).x, thick = number == 0 ? -0.01f : 0.01f;
    const float half = 1.1f * PRESS_RADIUS;
    wisp_vec3 points[8];
    for ( int i = 0; i < 8; ++i )
    {
        points[i] = ( wisp_vec3 ){ i & 4 ? at + thick : at, i & 2 ? half : -half, i & 1 ? half : -half };
    }
    int32_t corners[WISP_COUNT( triangles )];
    memcpy( corners, triangles, sizeof( corners ) );
    const wisp_mesh mesh = { points, corners, 8, WISP_COUNT( triangles ) / 3 };
    const wisp_vec3 grey = { 0.6f, 0.6f, 0.58f };
    const wisp_status status = add_body( s, &mesh, points, RENDER_SOLID, grey, error );
    s->bodies[s->count - 1].is_faceted = true;
    return status;
}

// ---- drawing ----

typedef struct stage
{
    render_mesh meshes[BODIES_MAX];
    render_scene scene;
} stage;

static void set_stage( const shot* s, bool has_ground, stage* out )
{
    out->scene = render_default_scene();
    for ( int i = 0; i < s->count; ++i )
    {
        const body* b = s->bodies + i;
        render_mesh* mesh = out->meshes + i;
        *mesh = render_default_mesh( b->material );
        mesh->points = b->points;
        mesh->triangles = b->triangles;
        mesh->colours = b->colours;
        mesh->vertex_count = b->vertex_count;
        mesh->triangle_count = b->triangle_count;
        mesh->colour = b->colour;
        mesh->is_faceted = b->is_faceted;
    }
    out->scene.meshes = out->meshes;
    out->scene.mesh_count = s->count;
    out->scene.has_ground = has_ground;
}

// One camera for all shots, so that they can be compared.
static wisp_status draw( const album* all, int pixels, bool has_ground, picture_sheet* sheet, wisp_error* error )
{
    stage one;
    render_camera camera;
    render_bounds bounds = { .is_filled = false };
    render_options options = render_default_options();
    options.width = pixels;
    options.height = (int)( (float)pixels / all->aspect );
    options.threads = 2;
    options.samples = 32;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < all->count && status == WISP_OK; ++i )
    {
        render_bounds box = { .is_filled = false };
        set_stage( all->shots + i, has_ground, &one );
        status = render_scene_bounds( &one.scene, &box, error );
        bounds = render_bounds_union( bounds, box );
    }
    status = status == WISP_OK ? render_frame_camera( &bounds, &all->view, all->aspect, &camera, error ) : status;
    for ( int i = 0; i < all->count && status == WISP_OK; ++i )
    {
        set_stage( all->shots + i, has_ground, &one );
        status = render_picture( &one.scene, &camera, &options, sheet->pictures + i, error );
        sheet->labels[i] = all->shots[i].label;
        sheet->count = i + 1;
    }
    return status;
}

static wisp_status write_album( const contact_plan* plan, const album* all, bool has_ground, results* out,
                                wisp_error* error )
{
    picture_sheet sheet = { .columns = all->columns };
    const wisp_status status = draw( all, plan->picture_pixels, has_ground, &sheet, error );
    return picture_sheet_finish( &sheet, status, plan->options->pictures, all->name, all->caption, out, error );
}

// ---- the pictures ----

static wisp_status step_to( contact_world* world, int steps, wisp_error* error )
{
    wisp_status status = WISP_OK;
    while ( world->steps < steps && status == WISP_OK )
    {
        status = contact_step( world, error );
    }
    return status;
}

static wisp_status take_balloons( album* all, contact_world* world, int steps, float cut, wisp_error* error )
{
    wisp_status status = step_to( world, steps, error );
    shot* s = all->shots + all->count++;
    snprintf( s->label, sizeof( s->label ), "%.2f s%s", (double)( CONTACT_STEP * (float)world->steps ),
              cut < INFINITY ? ", cut open" : "" );
    status = status == WISP_OK ? add_balloons( s, world, cut, error ) : status;
    for ( int i = 0; i < world->mover_count && status == WISP_OK; ++i )
    {
        status = add_plate( s, i, world->steps, error );
    }
    return status;
}

static wisp_status take_cloth( album* all, contact_world* world, int steps, wisp_error* error )
{
    wisp_status status = step_to( world, steps, error );
    shot* s = all->shots + all->count++;
    snprintf( s->label, sizeof( s->label ), "%.2f s", (double)( CONTACT_STEP * (float)world->steps ) );
    status = status == WISP_OK ? add_cloth( s, world, error ) : status;
    return status == WISP_OK ? add_ball( s, contact_ball_at( 0, world->pace * (float)world->steps ), error ) : status;
}

static contact_setting setting_of( const contact_plan* plan )
{
    return ( contact_setting ){ .way = { .name = "exact", .margin = 2.0f },
                                .workers = plan->teams.workers[plan->teams.count - 1] };
}

/// Balloons at the end, whole and cut open, and where `has_start` before they touch.
typedef struct balloon_picture
{
    contact_enter_fn* enter;
    const char *name, *caption;
    float azimuth_degrees, elevation_degrees, aspect;
    float cut; // m, z of the plane
    bool has_start, has_ground;
} balloon_picture;

static const balloon_picture pair_picture = {
    .enter = contact_enter_pair,
    .name = "contact_pair",
    .caption = "Two balloons pressed together",
    .azimuth_degrees = 14.0f,
    .elevation_degrees = 10.0f,
    .aspect = 1.4f,
    .has_start = true,
};
static const balloon_picture stack_picture = {
    .enter = contact_enter_stack,
    .name = "contact_stack",
    .caption = "Ten balloons in a box, and a cut through those at the back",
    .azimuth_degrees = 24.0f,
    .elevation_degrees = 14.0f,
    .aspect = 1.0f,
    .cut = -1.2f * PRESS_RADIUS,
    .has_ground = true,
};

static wisp_status picture_balloons( const contact_plan* plan, const balloon_picture* picture, int level,
                                     results* out, wisp_error* error )
{
    const contact_setting setting = setting_of( plan );
    contact_scene scene;
    contact_world world = { .world = NULL };
    album all = { .columns = picture->has_start ? 3 : 2, .name = picture->name, .caption = picture->caption };
    all.view = render_default_view();
    all.view.azimuth_degrees = picture->azimuth_degrees;
    all.view.elevation_degrees = picture->elevation_degrees;
    all.aspect = picture->aspect;
    wisp_status status = contact_make_balloon( level, &scene, error );
    status = status == WISP_OK ? picture->enter( &scene, &setting, &world, error ) : status;
    if ( status == WISP_OK && picture->has_start )
    {
        status = take_balloons( &all, &world, 1, INFINITY, error );
    }
    status = status == WISP_OK ? take_balloons( &all, &world, plan->picture_steps, INFINITY, error ) : status;
    status = status == WISP_OK ? take_balloons( &all, &world, plan->picture_steps, picture->cut, error ) : status;
    contact_leave( &world );
    contact_scene_free( &scene );
    status = status == WISP_OK ? write_album( plan, &all, picture->has_ground, out, error ) : status;
    free_album( &all );
    return status;
}

static wisp_status picture_cloth( const contact_plan* plan, results* out, wisp_error* error )
{
    static const float fractions[SHOTS_MAX] = { 0.07f, 0.1f, 0.18f, 0.3f, 0.6f, 1.0f };
    const contact_setting setting = setting_of( plan );
    contact_scene scene;
    contact_world world = { .world = NULL };
    album all = { .columns = 3,
                  .name = "contact_cloth",
                  .caption = "A cloth folding over a moving ball, its two sides in two colours" };
    all.view = render_default_view();
    all.view.elevation_degrees = 28.0f;
    all.aspect = 1.25f;
    wisp_status status = contact_make_cloth( plan->picture_side, &scene, error );
    status = status == WISP_OK ? contact_enter_fold( &scene, &setting, &world, error ) : status;
    for ( int i = 0; i < SHOTS_MAX && status == WISP_OK; ++i )
    {
        status = take_cloth( &all, &world, (int)( fractions[i] * (float)plan->picture_steps ), error );
    }
    contact_leave( &world );
    contact_scene_free( &scene );
    status = status == WISP_OK ? write_album( plan, &all, true, out, error ) : status;
    free_album( &all );
    return status;
}

wisp_status contact_pictures( const contact_plan* plan, results* out, wisp_error* error )
{
    if ( plan->options->pictures == NULL )
    {
        return WISP_OK;
    }
    bench_progress( plan->options, 0.9, "contact, pictures" );
    wisp_status status = picture_balloons( plan, &pair_picture, plan->picture_level, out, error );
    status =
        status == WISP_OK ? picture_balloons( plan, &stack_picture, plan->picture_level - 1, out, error ) : status;
    return status == WISP_OK ? picture_cloth( plan, out, error ) : status;
}
