#include "picture_survey.h"

#include <math.h>

#define DEGREE 0.017453292519943295 // radians

// ---- directions ----

// Hair in a plane, as in the paper, is viewed from the front.
static bool is_flat( const picture_source* source )
{
    for ( int i = 0; i < source->body_count; ++i )
    {
        const picture_body* body = &source->bodies[i];
        for ( int v = 0; v < body->vertex_count; ++v )
        {
            if ( body->kind != SCENE_BODY_STRANDS || body->points[v].z != 0.0f )
            {
                return false;
            }
        }
    }
    return true;
}

static picture_fit empty_fit( void )
{
    return ( picture_fit ){ { -INFINITY, -INFINITY }, { -INFINITY, -INFINITY }, -INFINITY, INFINITY };
}

picture_survey picture_survey_begin( const picture_options* options, const picture_source* source, float aspect )
{
    picture_survey survey = {
        .options = options,
        .is_turning = options->turntable > 0,
        .aspect = aspect,
        .view = options->view,
        .fit = empty_fit(),
    };
    survey.view.is_turntable = survey.is_turning;
    if ( !options->has_from && !survey.is_turning && is_flat( source ) )
    {
        survey.view.azimuth_degrees = 0.0f;
        survey.view.elevation_degrees = 0.0f;
    }
    double azimuth = DEGREE * fmod( (double)survey.view.azimuth_degrees, 360.0 );
    double elevation = DEGREE * (double)survey.view.elevation_degrees;
    double c = cos( azimuth ), s = sin( azimuth ), ce = cos( elevation ), se = sin( elevation );
    survey.right = ( wisp_vec3 ){ (float)c, 0.0f, (float)-s };
    survey.up = ( wisp_vec3 ){ (float)( -s * se ), (float)ce, (float)( -c * se ) };
    survey.back = ( wisp_vec3 ){ (float)( s * ce ), (float)se, (float)( c * ce ) };
    survey.along = tan( 0.5 * DEGREE * (double)survey.view.fov_degrees ) * ( 1.0 - 2.0 * (double)survey.view.margin );
    survey.across = survey.along * (double)aspect;
    return survey;
}

// ---- bodies ----

static double dot( wisp_vec3 a, wisp_vec3 b )
{
    return (double)a.x * (double)b.x + (double)a.y * (double)b.y + (double)a.z * (double)b.z;
}

// A point at lateral position x, viewed by a camera at depth d and lateral position c, is left of the right edge if x
// - c <= (d - z) t, and right of the left one if c - x <= (d - z) t. Over all points of all frames only the largest
// x/t + z and z - x/t matter.
static void fit_point( const picture_survey* survey, wisp_vec3 p, picture_fit* fit )
{
    double x = dot( p, survey->right ) / survey->across, y = dot( p, survey->up ) / survey->along;
    double z = dot( p, survey->back );
    fit->right[0] = fmax( fit->right[0], z + x );
    fit->right[1] = fmax( fit->right[1], z - x );
    fit->up[0] = fmax( fit->up[0], z + y );
    fit->up[1] = fmax( fit->up[1], z - y );
    fit->nearest = fmax( fit->nearest, z );
    fit->farthest = fmin( fit->farthest, z );
}

// Unreferenced vertices are invisible and must not move the camera away.
static size_t corner_count( const picture_body* body )
{
    return body->offsets ? (size_t)body->vertex_count : 3 * (size_t)body->triangle_count;
}

static wisp_vec3 corner( const picture_body* body, size_t k )
{
    return body->points[body->offsets ? (int32_t)k : body->triangles[k]];
}

static render_bounds bounds_of( const picture_body* body )
{
    render_bounds bounds = { .is_filled = false };
    for ( size_t k = 0; k < corner_count( body ); ++k )
    {
        wisp_vec3 p = corner( body, k );
        bounds = render_bounds_union( bounds, ( render_bounds ){ p, p, true } );
    }
    return bounds;
}

static float clamp( float value, float lower, float upper )
{
    return fminf( fmaxf( value, lower ), upper );
}

// A point that is cut away counts as if it was on the cut.
static wisp_vec3 before_cut( const picture_options* options, wisp_vec3 p )
{
    const wisp_vec3 n = options->cut_normal;
    const double beyond = dot( n, p ) - (double)options->cut_offset, square = dot( n, n );
    const float back = square > 0.0 && beyond > 0.0 ? (float)( -beyond / square ) : 0.0f;
    return ( wisp_vec3 ){ p.x + back * n.x, p.y + back * n.y, p.z + back * n.z };
}

// @param limit what is outside counts as if it was on its border; an empty one limits nothing
static void fit_body( const picture_survey* survey, const picture_body* body, const render_bounds* limit,
                      picture_fit* fit )
{
    for ( size_t k = 0; k < corner_count( body ); ++k )
    {
        wisp_vec3 p = corner( body, k );
        if ( limit->is_filled )
        {
            p.x = clamp( p.x, limit->lower.x, limit->upper.x );
            p.y = clamp( p.y, limit->lower.y, limit->upper.y );
            p.z = clamp( p.z, limit->lower.z, limit->upper.z );
        }
        fit_point( survey, before_cut( survey->options, p ), fit );
    }
}

static void survey_values( const picture_body* body, picture_survey* survey )
{
    for ( int v = 0; body->values && v < body->vertex_count; ++v )
    {
        float value = body->values[v];
        survey->square_sum += (double)value * (double)value;
        survey->max_value = fmaxf( survey->max_value, value );
    }
    survey->value_count += body->values ? body->vertex_count : 0;
}

static double size_of( const render_bounds* bounds )
{
    double x = (double)( bounds->upper.x - bounds->lower.x ), y = (double)( bounds->upper.y - bounds->lower.y );
    double z = (double)( bounds->upper.z - bounds->lower.z );
    return bounds->is_filled ? sqrt( x * x + y * y + z * z ) : 0.0;
}

// What moves in the loaded frame, and the floor.
static render_bounds add_moving( const picture_source* source, picture_survey* survey, picture_fit* fit )
{
    const render_bounds no_limit = { .is_filled = false };
    render_bounds moving = { .is_filled = false };
    for ( int i = 0; i < source->body_count; ++i )
    {
        const picture_body* body = &source->bodies[i];
        survey->has_mesh = survey->has_mesh || body->kind != SCENE_BODY_STRANDS;
        if ( picture_is_floor( body ) )
        {
            survey->has_floor = true;
            survey->floor_height = body->points[0].y;
        }
        else if ( body->kind != SCENE_BODY_COLLIDER && body->kind != SCENE_BODY_PLANE )
        {
            moving = render_bounds_union( moving, bounds_of( body ) );
            fit_body( survey, body, &no_limit, fit );
            survey_values( body, survey );
        }
    }
    survey->moving = render_bounds_union( survey->moving, moving );
    return moving;
}

// A collider is in the picture as far as it is near to what moves: a mast, a large table or a hall would make that a speck.
static void add_colliders( const picture_source* source, const render_bounds* moving, picture_survey* survey,
                           picture_fit* fit )
{
    const double hall = 3.0, near = 0.35; // sizes of what moves
    const float reach = (float)( near * size_of( moving ) );
    render_bounds limit = *moving;
    limit.lower = ( wisp_vec3 ){ limit.lower.x - reach, limit.lower.y - reach, limit.lower.z - reach };
    limit.upper = ( wisp_vec3 ){ limit.upper.x + reach, limit.upper.y + reach, limit.upper.z + reach };
    for ( int i = 0; i < source->body_count; ++i )
    {
        const picture_body* body = &source->bodies[i];
        if ( body->kind != SCENE_BODY_COLLIDER )
        {
            continue;
        }
        const render_bounds bounds = bounds_of( body );
        survey->colliders = render_bounds_union( survey->colliders, bounds );
        if ( !moving->is_filled || size_of( &bounds ) <= hall * size_of( moving ) )
        {
            fit_body( survey, body, &limit, fit );
        }
    }
}

static double distance_of( const picture_fit* fit )
{
    double distance = fmax( 0.5 * ( fit->right[0] + fit->right[1] ), 0.5 * ( fit->up[0] + fit->up[1] ) );
    // A single point has no size; the camera keeps a distance all the same.
    return fmax( distance, fit->nearest + 1e-3 );
}

static double middle_of( const picture_fit* fit )
{
    return 0.5 * ( fit->nearest + fit->farthest );
}

picture_fit picture_survey_add( const picture_source* source, picture_survey* survey )
{
    picture_fit fit = empty_fit();
    const render_bounds moving = add_moving( source, survey, &fit );
    add_colliders( source, &moving, survey, &fit );
    for ( int k = 0; k < 2; ++k )
    {
        survey->fit.right[k] = fmax( survey->fit.right[k], fit.right[k] );
        survey->fit.up[k] = fmax( survey->fit.up[k], fit.up[k] );
    }
    survey->fit.nearest = fmax( survey->fit.nearest, fit.nearest );
    survey->fit.farthest = fmin( survey->fit.farthest, fit.farthest );
    survey->zoom = fmax( survey->zoom, distance_of( &fit ) - middle_of( &fit ) );
    return fit;
}

// ---- the camera ----

// A large collider around a small cloth does not say where the ground is.
static bool is_hall( const picture_survey* survey )
{
    return survey->moving.is_filled && size_of( &survey->colliders ) > 3.0 * size_of( &survey->moving );
}

static render_bounds bounds_of_all( const picture_survey* survey )
{
    return is_hall( survey ) ? survey->moving : render_bounds_union( survey->moving, survey->colliders );
}

static wisp_vec3 place( const picture_survey* survey, double right, double up, double back )
{
    wisp_vec3 r = survey->right, u = survey->up, b = survey->back;
    return ( wisp_vec3 ){
        (float)( right * (double)r.x + up * (double)u.x + back * (double)b.x ),
        (float)( right * (double)r.y + up * (double)u.y + back * (double)b.y ),
        (float)( right * (double)r.z + up * (double)u.z + back * (double)b.z ),
    };
}

// Both edges of an axis touch where d = (first + second) / 2 and c = t (first - second) / 2.
static render_camera fitted_camera( const picture_survey* survey, const picture_fit* fit, double distance )
{
    double aside = 0.5 * survey->across * ( fit->right[0] - fit->right[1] );
    double above = 0.5 * survey->along * ( fit->up[0] - fit->up[1] );
    return ( render_camera ){
        .eye = place( survey, aside, above, distance ),
        .target = place( survey, aside, above, middle_of( fit ) ),
        .up = { 0.0f, 1.0f, 0.0f },
        .fov_degrees = survey->view.fov_degrees,
    };
}

wisp_status picture_survey_camera( const picture_survey* survey, const picture_fit* frame, render_camera* camera,
                                   wisp_error* error )
{
    const double travelled = 2.5; // sizes
    const picture_options* options = survey->options;
    render_bounds bounds = bounds_of_all( survey );
    wisp_status status = render_frame_camera( &bounds, &survey->view, survey->aspect, camera, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( options->has_camera )
    {
        camera->eye = options->eye;
        camera->target = options->target;
    }
    else if ( bounds.is_filled && !survey->is_turning )
    {
        const double distance = distance_of( &survey->fit );
        const bool follows =
            isfinite( frame->nearest ) && distance - middle_of( &survey->fit ) > travelled * survey->zoom;
        *camera = follows ? fitted_camera( survey, frame, middle_of( frame ) + survey->zoom )
                          : fitted_camera( survey, &survey->fit, distance );
    }
    return WISP_OK;
}

// ---- colours and ground ----

// A few vertices are stretched far more than all others, and would leave those the first colours of the map only.
static void find_range( const picture_survey* survey, picture_look* look )
{
    double root = survey->value_count > 0.0 ? sqrt( survey->square_sum / survey->value_count ) : 0.0;
    const bool is_map = survey->options->source.value == PICTURE_MAP; // what few vertices have there is meant
    double upper = is_map ? (double)survey->max_value : fmin( (double)survey->max_value, 3.0 * root );
    look->range[0] = 0.0f;
    look->range[1] = upper > 0.0 ? (float)upper : 1.0f;
}

picture_look picture_survey_look( const picture_survey* survey )
{
    const picture_options* options = survey->options;
    picture_look look = {
        .value = options->source.value,
        .range = { options->range[0], options->range[1] },
        .layer = options->source.layer,
        .has_layer_normals = options->source.has_layer_normals,
        .has_ground = options->ground == PICTURE_GROUND_HEIGHT,
        .ground_height = options->ground_height,
        .background = { options->background[0], options->background[1] },
        .cut_normal = options->cut_normal,
        .cut_offset = options->cut_offset,
    };
    if ( !options->has_range )
    {
        find_range( survey, &look );
    }
    // Strands alone hang in the air, as hair does; whatever else there is stands on something. The little that the
    // ground lies below keeps flat cloth from being in it.
    render_bounds bounds = bounds_of_all( survey );
    if ( options->ground == PICTURE_GROUND_AUTO && survey->has_floor )
    {
        look.has_ground = true;
        look.ground_height = survey->floor_height;
    }
    else if ( options->ground == PICTURE_GROUND_AUTO && survey->has_mesh && bounds.is_filled )
    {
        look.has_ground = true;
        look.ground_height = bounds.lower.y - (float)( 2e-3 * size_of( &bounds ) );
    }
    return look;
}
