// What contact looks like: balloons that flatten on each other, whole and cut open, a stack of them, and a cloth
// whose two sides have two colours, so that its layers can be told apart.
#include "palette.h"
#include "contact_bench.h"

#include "io_file.h"
#include "picture_sheet.h"
#include "program_data.h"
#include "suite.h"
#include "world_from_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SHOTS_MAX 6
#define BODIES_MAX 12
#define SCENE_BYTES_MAX ( 1 << 16 )
#define CUT_STACK -0.18f // m, a little behind the centres of the balloons at the back
#define STRIPES 16       // of the cloth, along either side

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
    float cut; // m, z: what is before it is left out; infinite: nothing is
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

static wisp_status add_body( shot* s, const scene_world* world, int number, render_material material,
                             wisp_vec3 colour, wisp_error* error )
{
    WISP_ASSERT( s->count < BODIES_MAX );
    const scene_body from = scene_world_body( world, number );
    const size_t corners = 3 * (size_t)from.triangle_count * sizeof( int32_t );
    body* b = s->bodies + s->count++;
    *b = ( body ){
        .points = malloc( (size_t)from.vertex_count * sizeof( wisp_vec3 ) ),
        .triangles = malloc( corners ),
        .vertex_count = from.vertex_count,
        .triangle_count = from.triangle_count,
        .colour = colour,
        .material = material,
    };
    if ( b->points == NULL || b->triangles == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a picture" );
    }
    memcpy( b->triangles, from.triangles, corners );
    return scene_world_points( world, number, b->points, error );
}

static wisp_status add_balloons( shot* s, const scene_world* world, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < scene_world_moving_count( world ) && status == WISP_OK; ++i )
    {
        status = add_body( s, world, i, RENDER_LATEX, palette_body( i ), error );
    }
    return status;
}

// Balls and plates. The ground is a part of the picture.
static wisp_status add_colliders( shot* s, const scene_world* world, wisp_error* error )
{
    const wisp_vec3 grey = { 0.57f, 0.57f, 0.55f };
    const int moving = scene_world_moving_count( world );
    wisp_status status = WISP_OK;
    for ( int i = moving; i < scene_world_body_count( world ) && status == WISP_OK; ++i )
    {
        if ( scene_world_body( world, i ).kind != SCENE_BODY_PLANE )
        {
            status = add_body( s, world, i, RENDER_SOLID, grey, error );
            s->bodies[s->count - 1].is_faceted = world->scene->colliders[i - moving].def.kind == WISP_COLLIDER_BOX;
        }
    }
    return status;
}

// Sums of the normals of the triangles around each vertex, made to unit length.
static void find_normals( const body* mesh, wisp_vec3* normals )
{
    const wisp_vec3* x = mesh->points;
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
static wisp_status add_side( shot* s, const scene_world* world, float way, wisp_vec3 colour, wisp_vec3 stripe,
                             wisp_error* error )
{
    wisp_status status = add_body( s, world, 0, RENDER_CLOTH, colour, error );
    body* b = s->bodies + s->count - 1;
    wisp_vec3* normals = malloc( (size_t)b->vertex_count * sizeof( wisp_vec3 ) );
    b->colours = malloc( (size_t)b->vertex_count * sizeof( wisp_vec3 ) );
    if ( status == WISP_OK && ( normals == NULL || b->colours == NULL ) )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for a picture" );
    }
    if ( status == WISP_OK )
    {
        const int side = (int)lround( sqrt( b->vertex_count ) ), wide = side / STRIPES > 1 ? side / STRIPES : 1;
        find_normals( b, normals );
        for ( int v = 0; v < b->vertex_count; ++v )
        {
            wisp_vec3 *p = b->points + v, n = normals[v];
            *p = ( wisp_vec3 ){ p->x + way * n.x, p->y + way * n.y, p->z + way * n.z };
            b->colours[v] = v / side / wide % 2 == 0 ? colour : stripe;
        }
    }
    free( normals );
    return status;
}

static wisp_status add_cloth( shot* s, const scene_world* world, wisp_error* error )
{
    // the two sides of one layer stay nearer than two layers, which are a quarter of an edge apart
    const float way = 0.05f / sqrtf( (float)scene_world_body( world, 0 ).vertex_count );
    const wisp_status status = add_side( s, world, way, FRONT, FRONT_STRIPE, error );
    return status == WISP_OK ? add_side( s, world, -way, BACK, BACK_STRIPE, error ) : status;
}

// ---- drawing ----

typedef struct stage
{
    const album* all;
    render_mesh meshes[BODIES_MAX];
    render_scene scene;
    bool has_ground;
} stage;

static const render_scene* set_stage( void* context, int number )
{
    stage* out = context;
    const shot* s = &out->all->shots[number];
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
    out->scene.has_ground = out->has_ground;
    if ( s->cut < INFINITY )
    {
        out->scene.cut_normal = ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f };
        out->scene.cut_offset = s->cut;
    }
    return &out->scene;
}

static wisp_status write_album( const contact_plan* plan, const album* all, bool has_ground, results* out,
                                wisp_error* error )
{
    stage one = { .all = all, .has_ground = has_ground };
    picture_sheet sheet = { .columns = all->columns };
    const picture_shots shots = {
        .scene = set_stage,
        .context = &one,
        .count = all->count,
        .view = all->view,
        .width = plan->picture_pixels,
        .height = (int)( (float)plan->picture_pixels / all->aspect ),
        .samples = 32,
    };
    const wisp_status status = picture_sheet_draw( &shots, all->shots[0].label, sizeof( shot ), &sheet, error );
    return picture_sheet_finish( &sheet, status, plan->options->pictures, all->name, all->caption, out, error );
}

// ---- the pictures ----

// A scene of data/suites with another size, to be released after its world.
static wisp_status read_scene( const char* name, const char* const ( *fields )[2], int steps, wisp_scene* out,
                               wisp_error* error )
{
    char inner[64], path[1024], number[16];
    unsigned char* bytes = NULL;
    size_t size = 0;
    text_node* tree = NULL;
    snprintf( inner, sizeof inner, "suites/scenes/%s.yaml", name );
    snprintf( number, sizeof number, "%d", steps );
    program_data_path( inner, path, sizeof path );
    wisp_status status = io_file_read( path, SCENE_BYTES_MAX, &bytes, &size, error );
    status = status == WISP_OK ? text_parse( (const char*)bytes, size, path, &tree, error ) : status;
    if ( status == WISP_OK )
    {
        text_node* value = text_scalar( "%s", number );
        (void)suite_set_field( tree, "steps", value );
        for ( int i = 0; fields[i][0]; ++i )
        {
            text_set( value, fields[i][1] );
            (void)suite_set_field( tree, fields[i][0], value );
        }
        char* text = text_write( tree, NULL );
        status = wisp_scene_parse( text, strlen( text ), path, out, error );
        free( text );
        text_release( value );
    }
    text_release( tree );
    free( bytes );
    return status;
}

static wisp_status step_to( scene_world* world, int steps, wisp_error* error )
{
    wisp_status status = WISP_OK;
    while ( world->next_step < steps && status == WISP_OK )
    {
        status = scene_world_step( world, error );
    }
    return status;
}

// @param cut m, z of a plane that balloons are cut open by; infinite: they are not
static wisp_status take_shot( album* all, scene_world* world, int steps, float cut, wisp_error* error )
{
    wisp_status status = step_to( world, steps, error );
    shot* s = all->shots + all->count++;
    s->cut = cut;
    snprintf( s->label, sizeof( s->label ), "%.2f s%s", scene_world_time( world ),
              cut < INFINITY ? ", cut open" : "" );
    const bool is_cloth = world->scene->surfaces[0].has_cloth;
    status = status != WISP_OK ? status : is_cloth ? add_cloth( s, world, error ) : add_balloons( s, world, error );
    return status == WISP_OK ? add_colliders( s, world, error ) : status;
}

/// What a sheet of pictures shows.
typedef struct subject
{
    const char *scene, *name, *caption;
    float azimuth_degrees, elevation_degrees, aspect; // 0 degrees: the default
    int columns, shot_count;
    struct
    {
        float fraction, cut; // of the steps; m, 0: whole
    } shots[SHOTS_MAX];
    bool has_ground;
} subject;

static const subject pair = {
    .scene = "pressed_pair",
    .name = "contact_pair",
    .caption = "Two balloons pressed together",
    .azimuth_degrees = 14.0f,
    .elevation_degrees = 10.0f,
    .aspect = 1.4f,
    .columns = 3,
    .shot_count = 3,
    .shots = { { 0.0f, INFINITY }, { 1.0f, INFINITY }, { 1.0f, 0.0f } },
};
static const subject stack = {
    .scene = "balloons_in_box",
    .name = "contact_stack",
    .caption = "Ten balloons in a box, and a cut through those at the back",
    .azimuth_degrees = 24.0f,
    .elevation_degrees = 14.0f,
    .aspect = 1.0f,
    .columns = 2,
    .shot_count = 2,
    .shots = { { 1.0f, INFINITY }, { 1.0f, CUT_STACK } },
    .has_ground = true,
};
static const subject cloth = {
    .scene = "folding_cloth",
    .name = "contact_cloth",
    .caption = "A cloth folding over a moving ball, its two sides in two colours",
    .elevation_degrees = 28.0f,
    .aspect = 1.25f,
    .columns = 3,
    .shot_count = 6,
    .shots = { { 0.07f, INFINITY },
               { 0.1f, INFINITY },
               { 0.18f, INFINITY },
               { 0.3f, INFINITY },
               { 0.6f, INFINITY },
               { 1.0f, INFINITY } },
    .has_ground = true,
};

static wisp_status take_shots( const contact_plan* plan, const subject* what, const wisp_scene* scene, album* all,
                               wisp_error* error )
{
    const scene_world_options options = { .workers = plan->teams.workers[plan->teams.count - 1], .is_quiet = true };
    scene_world world;
    wisp_status status = scene_world_create( scene, &options, &world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int i = 0; i < what->shot_count && status == WISP_OK; ++i )
    {
        const int steps = (int)( what->shots[i].fraction * (float)plan->picture_steps );
        status = take_shot( all, &world, steps > 1 ? steps : 1, what->shots[i].cut, error );
    }
    scene_world_destroy( &world );
    return status;
}

// @param fields that make the scene as large as the plan has it
static wisp_status picture( const contact_plan* plan, const subject* what, const char* const ( *fields )[2],
                            results* out, wisp_error* error )
{
    wisp_scene scene = { 0 };
    album all = { .columns = what->columns, .name = what->name, .caption = what->caption, .aspect = what->aspect };
    all.view = render_default_view();
    all.view.azimuth_degrees = what->azimuth_degrees > 0.0f ? what->azimuth_degrees : all.view.azimuth_degrees;
    all.view.elevation_degrees = what->elevation_degrees;
    wisp_status status = read_scene( what->scene, fields, plan->picture_steps, &scene, error );
    status = status == WISP_OK ? take_shots( plan, what, &scene, &all, error ) : status;
    wisp_scene_release( &scene );
    status = status == WISP_OK ? write_album( plan, &all, what->has_ground, out, error ) : status;
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
    char level[16], coarser[16], side[16], spacing[32];
    snprintf( level, sizeof level, "%d", plan->picture_level );
    snprintf( coarser, sizeof coarser, "%d", plan->picture_level - 1 );
    snprintf( side, sizeof side, "%d", plan->picture_side );
    snprintf( spacing, sizeof spacing, "%.6f", 1.0 / ( plan->picture_side - 1 ) );
    const char* const fine[][2] = { { "surfaces[0].generate.level", level }, { NULL, NULL } };
    const char* const coarse[][2] = { { "surfaces[0].generate.level", coarser }, { NULL, NULL } };
    const char* const sheet[][2] = { { "surfaces[0].generate.columns", side },
                                     { "surfaces[0].generate.rows", side },
                                     { "surfaces[0].generate.spacing", spacing },
                                     { NULL, NULL } };
    wisp_status status = picture( plan, &pair, fine, out, error );
    status = status == WISP_OK ? picture( plan, &stack, coarse, out, error ) : status;
    return status == WISP_OK ? picture( plan, &cloth, sheet, out, error ) : status;
}
