#include "check.h"

#include "palette.h"
#include "render.h"
#include "wisp/module/definition.h"
#include "wisp/module/vec.h"

#include <stdio.h>

// ---- default values of definitions ----

// Default values of definitions.

static wisp_vec3 default_colour( render_material material )
{
    switch ( material )
    {
        case RENDER_CLOTH:
            return palette_body( 1 );
        case RENDER_LATEX:
            return palette_body( 0 );
        case RENDER_GLASS:
        case RENDER_SOLID:
            break;
    }
    return palette_solid();
}

render_mesh render_default_mesh( render_material material )
{
    return ( render_mesh ){ .material = material, .colour = default_colour( material ) };
}

render_curves render_default_curves( void )
{
    return ( render_curves ){ .radius = 4e-5f, .colour = palette_hair() };
}

render_points render_default_points( void )
{
    return ( render_points ){ .radius = 0.01f, .colour = palette_body( 7 ) };
}

render_scene render_default_scene( void )
{
    return ( render_scene ){
        .background_top = { 0.21f, 0.24f, 0.28f },
        .background_bottom = { 0.46f, 0.46f, 0.45f },
    };
}

render_options render_default_options( void )
{
    return ( render_options ){
        .width = 640,
        .height = 480,
        .samples = 16,
        .threads = 1,
        .seed = 1,
        .exposure = 1.0f,
        .tone = RENDER_TONE_FILMIC,
        .min_curve_pixels = 0.7f,
    };
}

// ---- checks ----

enum
{
    NAME_SHOWN = 80, // limit of characters of a body's name in a message
    BODIES_MAX = 1 << 20,
};

// Name of a body in messages: mesh "flag", or mesh 3.
typedef struct body_name
{
    char text[NAME_SHOWN + 24];
} body_name;

static body_name name_of( const char* kind, const char* name, int number )
{
    body_name out;
    if ( name != NULL )
    {
        snprintf( out.text, sizeof( out.text ), "%s \"%.*s\"", kind, NAME_SHOWN, name );
    }
    else
    {
        snprintf( out.text, sizeof( out.text ), "%s %d", kind, number );
    }
    return out;
}

static bool is_finite( wisp_vec3 v )
{
    return isfinite( v.x ) && isfinite( v.y ) && isfinite( v.z );
}

static bool is_near( wisp_vec3 v )
{
    return fabsf( v.x ) <= RENDER_FARTHEST && fabsf( v.y ) <= RENDER_FARTHEST && fabsf( v.z ) <= RENDER_FARTHEST;
}

// Brighter than white is allowed: a body may be a little overexposed, not a sun.
static bool is_colour( wisp_vec3 c )
{
    return c.x >= 0.0f && c.y >= 0.0f && c.z >= 0.0f && c.x <= 10.0f && c.y <= 10.0f && c.z <= 10.0f;
}

// ---- shared by meshes and curves -------------------------------------------------------------------------------

static wisp_status check_points( const body_name* body, const wisp_vec3* points, int count, wisp_error* error )
{
    for ( int v = 0; v < count; ++v )
    {
        wisp_vec3 p = points[v];
        if ( !is_finite( p ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: vertex %d is not finite (%g, %g, %g)", body->text, v,
                              (double)p.x, (double)p.y, (double)p.z );
        }
        if ( !is_near( p ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "%s: vertex %d at (%g, %g, %g) is more than %g m from the origin", body->text, v,
                              (double)p.x, (double)p.y, (double)p.z, (double)RENDER_FARTHEST );
        }
    }
    return WISP_OK;
}

static wisp_status check_colours( const body_name* body, wisp_vec3 colour, const wisp_vec3* colours, int count,
                                  wisp_error* error )
{
    if ( !is_colour( colour ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: colour (%g, %g, %g) is not in 0 .. 10", body->text,
                          (double)colour.x, (double)colour.y, (double)colour.z );
    }
    for ( int v = 0; v < count && colours != NULL; ++v )
    {
        if ( !is_colour( colours[v] ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: colour (%g, %g, %g) of vertex %d is not in 0 .. 10",
                              body->text, (double)colours[v].x, (double)colours[v].y, (double)colours[v].z, v );
        }
    }
    return WISP_OK;
}

// ---- meshes ----------------------------------------------------------------------------------------------------

static wisp_status check_triangles( const body_name* body, const render_mesh* mesh, wisp_error* error )
{
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        for ( int k = 0; k < 3; ++k )
        {
            int32_t v = mesh->triangles[3 * (size_t)t + (size_t)k];
            if ( v < 0 || v >= mesh->vertex_count )
            {
                return wisp_fail( error, WISP_BAD_INPUT, "%s: triangle %d names vertex %d of %d", body->text, t,
                                  (int)v, mesh->vertex_count );
            }
        }
    }
    return WISP_OK;
}

static wisp_status check_mesh( const render_mesh* mesh, int number, wisp_error* error )
{
    body_name body = name_of( "mesh", mesh->name, number );
    if ( mesh->vertex_count < 0 || mesh->triangle_count < 0 || ( mesh->vertex_count > 0 && mesh->points == NULL ) ||
         ( mesh->triangle_count > 0 && mesh->triangles == NULL ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: %d vertices and %d triangles do not fit their arrays",
                          body.text, mesh->vertex_count, mesh->triangle_count );
    }
    if ( (int)mesh->material < RENDER_SOLID || (int)mesh->material > RENDER_GLASS )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: material %d is none of solid, cloth, latex and glass",
                          body.text, (int)mesh->material );
    }
    wisp_status status = check_points( &body, mesh->points, mesh->vertex_count, error );
    if ( status == WISP_OK )
    {
        status = check_colours( &body, mesh->colour, mesh->colours, mesh->vertex_count, error );
    }
    return status == WISP_OK ? check_triangles( &body, mesh, error ) : status;
}

// ---- curves ----------------------------------------------------------------------------------------------------

static wisp_status check_offsets( const body_name* body, const render_curves* curves, wisp_error* error )
{
    if ( curves->strand_count < 0 || curves->offsets == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: %d strands do not fit their offsets", body->text,
                          curves->strand_count );
    }
    if ( curves->offsets[0] != 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the first strand begins at vertex %d instead of 0", body->text,
                          (int)curves->offsets[0] );
    }
    for ( int s = 0; s < curves->strand_count; ++s )
    {
        if ( curves->offsets[s + 1] < curves->offsets[s] )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: strand %d ends at vertex %d, before it begins at %d",
                              body->text, s, (int)curves->offsets[s + 1], (int)curves->offsets[s] );
        }
    }
    if ( curves->offsets[curves->strand_count] > 0 && curves->points == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: %d strands have no points", body->text, curves->strand_count );
    }
    return WISP_OK;
}

static wisp_status check_radii( const body_name* body, const render_curves* curves, wisp_error* error )
{
    if ( !( curves->radius >= 0.0f && curves->radius <= RENDER_FARTHEST ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: radius %g is not in 0 .. %g", body->text,
                          (double)curves->radius, (double)RENDER_FARTHEST );
    }
    for ( int v = 0; v < curves->offsets[curves->strand_count] && curves->radii != NULL; ++v )
    {
        if ( !( curves->radii[v] >= 0.0f && curves->radii[v] <= RENDER_FARTHEST ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: radius %g of vertex %d is not in 0 .. %g", body->text,
                              (double)curves->radii[v], v, (double)RENDER_FARTHEST );
        }
    }
    return WISP_OK;
}

static wisp_status check_curves( const render_curves* curves, int number, wisp_error* error )
{
    body_name body = name_of( "curves", curves->name, number );
    WISP_TRY( check_offsets( &body, curves, error ) );
    const int count = curves->offsets[curves->strand_count];
    WISP_TRY( check_points( &body, curves->points, count, error ) );
    WISP_TRY( check_colours( &body, curves->colour, curves->colours, count, error ) );
    return check_radii( &body, curves, error );
}

// ---- points ----------------------------------------------------------------------------------------------------

static wisp_status check_balls( const render_points* points, int number, wisp_error* error )
{
    body_name body = name_of( "points", points->name, number );
    if ( points->count < 0 || ( points->count > 0 && points->points == NULL ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: %d points do not fit their array", body.text, points->count );
    }
    if ( !( points->radius > 0.0f && points->radius <= RENDER_FARTHEST ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: radius %g is not above 0 and up to %g", body.text,
                          (double)points->radius, (double)RENDER_FARTHEST );
    }
    wisp_status status = check_points( &body, points->points, points->count, error );
    return status == WISP_OK ? check_colours( &body, points->colour, points->colours, points->count, error ) : status;
}

// ---- the whole -------------------------------------------------------------------------------------------------

static wisp_status check_surroundings( const render_scene* scene, wisp_error* error )
{
    body_name background = { "background" };
    wisp_status status = check_colours( &background, scene->background_top, &scene->background_bottom, 1, error );
    if ( status == WISP_OK && scene->has_ground && !( fabsf( scene->ground_height ) <= RENDER_FARTHEST ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "ground: height %g is not in -%g .. %g",
                          (double)scene->ground_height, (double)RENDER_FARTHEST, (double)RENDER_FARTHEST );
    }
    const float steep = wisp_v3_length( scene->cut_normal );
    const bool is_whole = scene->cut_normal.x == 0.0f && scene->cut_normal.y == 0.0f && scene->cut_normal.z == 0.0f;
    if ( status == WISP_OK && !( ( is_whole || steep >= 1e-6f ) && steep <= RENDER_FARTHEST &&
                                 fabsf( scene->cut_offset ) <= RENDER_FARTHEST ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "cut: normal is not 0 or 1e-6 .. %g long, or offset not in -%g .. %g",
                          (double)RENDER_FARTHEST, (double)RENDER_FARTHEST, (double)RENDER_FARTHEST );
    }
    return status;
}

wisp_status check_scene( const render_scene* scene, wisp_error* error )
{
    if ( scene->mesh_count < 0 || scene->curves_count < 0 || scene->mesh_count > BODIES_MAX ||
         scene->curves_count > BODIES_MAX || ( scene->mesh_count > 0 && scene->meshes == NULL ) ||
         ( scene->curves_count > 0 && scene->curves == NULL ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "picture: %d meshes and %d sets of curves do not fit their arrays",
                          scene->mesh_count, scene->curves_count );
    }
    if ( scene->points_count < 0 || scene->points_count > BODIES_MAX ||
         ( scene->points_count > 0 && scene->points == NULL ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "picture: %d sets of points do not fit their array",
                          scene->points_count );
    }
    WISP_TRY( check_surroundings( scene, error ) );
    for ( int i = 0; i < scene->mesh_count; ++i )
    {
        WISP_TRY( check_mesh( &scene->meshes[i], i, error ) );
    }
    for ( int i = 0; i < scene->curves_count; ++i )
    {
        WISP_TRY( check_curves( &scene->curves[i], i, error ) );
    }
    for ( int i = 0; i < scene->points_count; ++i )
    {
        WISP_TRY( check_balls( &scene->points[i], i, error ) );
    }
    return WISP_OK;
}

wisp_status check_camera( const render_camera* camera, wisp_error* error )
{
    if ( !is_finite( camera->eye ) || !is_finite( camera->target ) || !is_finite( camera->up ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "camera: eye, target or up is not finite" );
    }
    if ( !is_near( wisp_v3_scale( camera->eye, 1e-3f ) ) || !is_near( wisp_v3_scale( camera->target, 1e-3f ) ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "camera: eye or target is more than %g m from the origin",
                          1e3 * (double)RENDER_FARTHEST );
    }
    if ( !( camera->fov_degrees >= 1.0f && camera->fov_degrees <= 150.0f ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "camera: the angle of view is %g degrees and must be in 1 .. 150",
                          (double)camera->fov_degrees );
    }
    wisp_vec3 none = { 0.0f, 0.0f, 0.0f };
    wisp_vec3 forward = wisp_v3_normalize_or( wisp_v3_sub( camera->target, camera->eye ), none );
    wisp_vec3 up = wisp_v3_normalize_or( camera->up, none );
    if ( wisp_v3_length( forward ) == 0.0f )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "camera: eye and target are the same point" );
    }
    if ( wisp_v3_length( wisp_v3_cross( forward, up ) ) < 1e-4f )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "camera: up has no length or lies along the view" );
    }
    return WISP_OK;
}

static wisp_status check_range( const char* name, double value, double least, double most, wisp_error* error )
{
    // Written so that NaN fails.
    if ( !( value >= least && value <= most ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "picture: %s is %g and must be in %g .. %g", name, value, least,
                          most );
    }
    return WISP_OK;
}

wisp_status check_options( const render_options* options, wisp_error* error )
{
    const struct
    {
        const char* name;
        double value, least, most;
    } ranges[] = {
        { "width", options->width, 1, RENDER_MAX_SIDE },
        { "height", options->height, 1, RENDER_MAX_SIDE },
        { "the number of samples", options->samples, 1, RENDER_MAX_SAMPLES },
        { "the number of threads", options->threads, 1, WISP_MAX_WORKERS },
        { "exposure", (double)options->exposure, 1e-3, 1e3 },
        { "the tone", (double)(int)options->tone, RENDER_TONE_FILMIC, RENDER_TONE_SRGB },
        { "the least width of curves", (double)options->min_curve_pixels, 0, 8 },
    };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( ranges ) && status == WISP_OK; ++i )
    {
        status = check_range( ranges[i].name, ranges[i].value, ranges[i].least, ranges[i].most, error );
    }
    if ( status == WISP_OK && ( !is_finite( options->light ) || !is_near( options->light ) ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "picture: the direction of the light is not finite or too long" );
    }
    return status;
}
