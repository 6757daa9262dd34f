#include "picture_draw.h"

#include "interruption.h"
#include "io_file.h"
#include "picture_stage.h"
#include "stats.h"

#include "wisp/module/definition.h"

#include <errno.h>
#include <math.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// ---- the survey of all frames ----

// Bounds over all drawn frames: positions and values, and from them the camera, the ground and the colour range. Frames are processed
// one after the other and none is kept.

// Bounds of the content of a picture from one direction; see fit_distance() for the sums.
typedef struct picture_fit
{
    double right[2], up[2]; ///< the edges of the picture against depth
    double nearest, farthest;
} picture_fit;

typedef struct picture_survey
{
    const picture_options* options;
    const double* origin; ///< [3] m, of the source
    bool is_turning;
    float aspect;
    render_view view;
    wisp_vec3 right, up, back;       ///< directions of the picture
    double across, along;            ///< tangents of the half angles of view, without the margin
    render_bounds moving, colliders; ///< colliders: without planes
    picture_fit fit;                 ///< of all frames
    double zoom;                     ///< m, largest distance that a single frame needs from its own middle
    bool has_mesh;
    bool has_floor; ///< a level plane
    float floor_height;
    double square_sum; ///< of the values
    double value_count;
    float max_value;
} picture_survey;

#define DEGREE 0.017453292519943295 // radians
#define MOST_SAMPLES 4096           // vertices that say where most of what moves is

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

// @param source the first frame is loaded
static picture_survey begin_survey( const picture_options* options, const picture_source* source, float aspect )
{
    picture_survey survey = {
        .origin = source->origin,
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

// @param limit an empty one limits nothing
static wisp_vec3 within( wisp_vec3 p, const render_bounds* limit )
{
    const wisp_vec3 a = limit->lower, b = limit->upper;
    return limit->is_filled ? ( wisp_vec3 ){ clamp( p.x, a.x, b.x ), clamp( p.y, a.y, b.y ), clamp( p.z, a.z, b.z ) }
                            : p;
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
        fit_point( survey, before_cut( survey->options, within( corner( body, k ), limit ) ), fit );
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

static bool is_moving( const picture_body* body )
{
    return body->kind != SCENE_BODY_COLLIDER && body->kind != SCENE_BODY_PLANE;
}

static render_bounds grown( render_bounds b, float by )
{
    b.lower = ( wisp_vec3 ){ b.lower.x - by, b.lower.y - by, b.lower.z - by };
    b.upper = ( wisp_vec3 ){ b.upper.x + by, b.upper.y + by, b.upper.z + by };
    return b;
}

// What moves without the outer tenth of its vertices on each side, and half of that around it: a scrap far away would make all else
// a speck. Empty where all is within four times the rest.
static render_bounds bounds_of_most( const picture_source* source, const render_bounds* all )
{
    double places[3][MOST_SAMPLES];
    size_t corners = 0, at = 0;
    int count = 0;
    for ( int i = 0; i < source->body_count; ++i )
    {
        corners += is_moving( &source->bodies[i] ) ? corner_count( &source->bodies[i] ) : 0;
    }
    const size_t step = corners / MOST_SAMPLES + 1;
    for ( int i = 0; i < source->body_count; ++i )
    {
        const picture_body* body = &source->bodies[i];
        for ( size_t k = 0; is_moving( body ) && k < corner_count( body ); ++k )
        {
            if ( at++ % step == 0 )
            {
                const wisp_vec3 p = corner( body, k );
                places[0][count] = (double)p.x;
                places[1][count] = (double)p.y;
                places[2][count++] = (double)p.z;
            }
        }
    }
    const stats_summary x = stats_summarise( places[0], count ), y = stats_summarise( places[1], count ),
                        z = stats_summarise( places[2], count );
    const render_bounds most = {
        { (float)x.p10, (float)y.p10, (float)z.p10 },
        { (float)x.p90, (float)y.p90, (float)z.p90 },
        count > 0,
    };
    return size_of( &most ) > 0.0 && size_of( all ) > 4.0 * size_of( &most )
               ? grown( most, (float)( 0.5 * size_of( &most ) ) )
               : ( render_bounds ){ .is_filled = false };
}

// What moves in the loaded frame, and the floor: a level plane that most of it is above.
static render_bounds add_moving( const picture_source* source, picture_survey* survey, picture_fit* fit )
{
    render_bounds moving = { .is_filled = false };
    for ( int i = 0; i < source->body_count; ++i )
    {
        const picture_body* body = &source->bodies[i];
        moving = is_moving( body ) ? render_bounds_union( moving, bounds_of( body ) ) : moving;
    }
    const render_bounds most = bounds_of_most( source, &moving );
    moving.lower = within( moving.lower, &most );
    moving.upper = within( moving.upper, &most );
    for ( int i = 0; i < source->body_count; ++i )
    {
        const picture_body* body = &source->bodies[i];
        survey->has_mesh = survey->has_mesh || body->kind != SCENE_BODY_STRANDS;
        if ( picture_is_floor( body ) )
        {
            const float height = body->points[0].y;
            const bool is_below = !moving.is_filled || height <= 0.5f * ( moving.lower.y + moving.upper.y );
            survey->floor_height = is_below ? height : survey->floor_height;
            survey->has_floor = survey->has_floor || is_below;
        }
        else if ( is_moving( body ) )
        {
            fit_body( survey, body, &most, fit );
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
    const render_bounds limit = grown( *moving, reach );
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

// Add the loaded frame. @return the bounds of this frame alone
static picture_fit add_to_survey( const picture_source* source, picture_survey* survey )
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

static wisp_vec3 place_in_picture( const picture_survey* survey, double right, double up, double back )
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
        .eye = place_in_picture( survey, aside, above, distance ),
        .target = place_in_picture( survey, aside, above, middle_of( fit ) ),
        .up = { 0.0f, 1.0f, 0.0f },
        .fov_degrees = survey->view.fov_degrees,
    };
}

static wisp_vec3 relative_to( const double origin[3], wisp_vec3 p )
{
    return ( wisp_vec3 ){ (float)( (double)p.x - origin[0] ), (float)( (double)p.y - origin[1] ),
                          (float)( (double)p.z - origin[2] ) };
}

// The closest camera that shows everything in all frames, or the one given by the user. What travels several times its own
// size would be a speck in it: then the camera goes along and keeps its distance.
// @param frame bounds of the frame to be drawn, as add_to_survey() returned them
static wisp_status survey_camera( const picture_survey* survey, const picture_fit* frame, render_camera* camera,
                                  wisp_error* error )
{
    const double travelled = 2.5; // sizes
    const picture_options* options = survey->options;
    render_bounds bounds = bounds_of_all( survey );
    WISP_TRY( render_frame_camera( &bounds, &survey->view, survey->aspect, camera, error ) );
    if ( options->has_camera )
    {
        camera->eye = relative_to( survey->origin, options->eye );
        camera->target = relative_to( survey->origin, options->target );
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

static picture_look survey_look( const picture_survey* survey )
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

// ---- pictures and their files ----

enum
{
    SHEET_PICTURES = 12, // on a sheet without --frames
    SHEET_WIDTH = 400,   // pixels of each, without --size
    SHEET_HEIGHT = 300,
    PATH_SIZE = 4096,
};

/// The pictures in their order.
typedef struct plan
{
    int count;
    int first, step; ///< frames
    int spread;      ///< > 0: the last of `count` frames spread evenly from 0
    bool is_turning; ///< one frame from all sides
} plan;

typedef struct drawing
{
    const picture_options* options;
    picture_source source;
    plan plan;
    picture_look look;
    picture_survey survey;
    picture_fit* fits; ///< [plan.count] bounds of each picture; one if it is turned
    render_options render;
    image* sheet;        ///< [plan.count] pictures kept for their sheet, or null
    const char** labels; ///< [plan.count] below them
    progress bar;
    int picture;  ///< the one being drawn
    bool is_seen; ///< a body, in any picture so far
    io_memory memory;
} drawing;

// ---- choice of pictures ----

static int frame_of( const plan* p, int picture )
{
    if ( p->spread > 0 )
    {
        return (int)( (int64_t)picture * p->spread / ( p->count - 1 ) );
    }
    return p->is_turning ? p->first : p->first + picture * p->step;
}

static wisp_status check_frame( const picture_source* source, int frame, wisp_error* error )
{
    return frame < source->frame_count ? WISP_OK
                                       : wisp_fail( error, WISP_BAD_INPUT, "%s: got frame %d, expected 0 to %d",
                                                    source->path, frame, source->frame_count - 1 );
}

static wisp_status choose( drawing* d, wisp_error* error )
{
    const picture_options* options = d->options;
    plan* p = &d->plan;
    int last = d->source.frame_count - 1;
    *p = ( plan ){ .count = 1, .first = last, .step = 1, .is_turning = options->turntable > 0 };
    switch ( options->choice )
    {
        case PICTURE_LAST:
            if ( options->is_sheet && !p->is_turning && last > 0 )
            {
                p->count = last + 1 < SHEET_PICTURES ? last + 1 : SHEET_PICTURES;
                p->spread = last;
            }
            break;
        case PICTURE_FRAME:
            p->first = options->first;
            break;
        case PICTURE_TIME:
        {
            WISP_TRY( picture_source_find( &d->source, options->seconds, &p->first, error ) );
            break;
        }
        case PICTURE_FRAMES:
            p->first = options->first;
            p->step = options->step;
            last = options->last == PICTURE_FRAME_END ? last : options->last;
            p->count = last >= p->first ? ( last - p->first ) / p->step + 1 : 1;
            break;
    }
    p->count = p->is_turning ? options->turntable : p->count;
    wisp_status status = check_frame( &d->source, p->first, error );
    return status == WISP_OK ? check_frame( &d->source, frame_of( p, p->count - 1 ), error ) : status;
}

// Checked before anything is drawn: minutes of pictures should not end in a sheet that cannot be written.
static wisp_status check_sheet( const drawing* d, wisp_error* error )
{
    int64_t count = d->plan.count, columns = d->options->columns < d->plan.count ? d->options->columns : count;
    int64_t rows = columns > 0 ? ( count + columns - 1 ) / columns : 1;
    // A gap is at most four pixels or a fiftieth, a label at most an eighth of a picture or as high as its letters.
    int64_t width = d->render.width + d->render.width / 50 + 4, height = d->render.height + d->render.height / 8 + 32;
    bool fits = width * height * count <= IMAGE_MAX_PIXELS && width * ( columns + 1 ) <= IMAGE_MAX_SIDE &&
                height * ( rows + 1 ) <= IMAGE_MAX_SIDE;
    return fits ? WISP_OK
                : wisp_fail(
                      error, WISP_BAD_INPUT,
                      "%s: %d pictures of %d x %d pixels are too large for one sheet; draw fewer or smaller ones",
                      d->options->output, d->plan.count, d->render.width, d->render.height );
}

static wisp_status no_sheet( const drawing* d, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "render: out of memory for a sheet of %d pictures", d->plan.count );
}

static wisp_status make_sheet_room( drawing* d, wisp_error* error )
{
    WISP_TRY( check_sheet( d, error ) );
    d->sheet = io_get( &d->memory, (size_t)d->plan.count * sizeof *d->sheet );
    d->labels = io_get( &d->memory, (size_t)d->plan.count * sizeof *d->labels );
    return d->memory.is_short ? no_sheet( d, error ) : WISP_OK;
}

// ---- the camera, the light of all pictures ----

// What of the loaded frame a collider hides: those through which it must be seen are drawn as glass.
static wisp_status find_glass( drawing* d, const picture_fit* frame, wisp_error* error )
{
    render_camera camera;
    wisp_status status = survey_camera( &d->survey, frame, &camera, error );
    wisp_error cause = { 0 };
    status =
        status == WISP_OK ? picture_stage_find_glass( &d->source, &camera, &d->look, &d->memory, &cause ) : status;
    return cause.status == WISP_OK ? status : wisp_fail( error, status, "%s: %s", d->source.path, cause.message );
}

static wisp_status survey_frames( drawing* d, wisp_error* error )
{
    int frames = d->plan.is_turning ? 1 : d->plan.count;
    float aspect = (float)d->render.width / (float)d->render.height;
    d->fits = io_get( &d->memory, (size_t)frames * sizeof *d->fits );
    if ( !d->fits )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "render: out of memory for %d pictures", frames );
    }
    WISP_TRY( picture_source_load( &d->source, frame_of( &d->plan, 0 ), error ) );
    d->survey = begin_survey( d->options, &d->source, aspect );
    for ( int i = 0; i < frames; ++i )
    {
        WISP_TRY( picture_source_load( &d->source, frame_of( &d->plan, i ), error ) );
        d->fits[i] = add_to_survey( &d->source, &d->survey );
        progress_show( &d->bar, (double)( i + 1 ) / frames, "frames" );
    }
    d->look = survey_look( &d->survey );
    return find_glass( d, &d->fits[frames - 1], error );
}

// A turntable turns about the vertical axis through the camera's target.
static wisp_status camera_of( const drawing* d, int picture, render_camera* out, wisp_error* error )
{
    const picture_fit* frame = &d->fits[d->plan.is_turning ? 0 : picture];
    wisp_status status = survey_camera( &d->survey, frame, out, error );
    if ( status == WISP_OK && d->plan.is_turning )
    {
        double angle = 6.283185307179586 * picture / d->plan.count;
        double c = cos( angle ), s = sin( angle );
        double x = (double)( out->eye.x - out->target.x ), z = (double)( out->eye.z - out->target.z );
        out->eye.x = (float)( (double)out->target.x + c * x + s * z );
        out->eye.z = (float)( (double)out->target.z - s * x + c * z );
    }
    return status;
}

// ---- one picture ----

static void show_fraction( void* user, double fraction )
{
    drawing* d = user;
    char what[48];
    snprintf( what, sizeof( what ), "picture %d of %d", d->picture + 1, d->plan.count );
    progress_show( &d->bar, ( d->picture + fraction ) / d->plan.count, what );
}

static void put_legend( const drawing* d, image* picture )
{
    // A sheet has one legend for all pictures.
    if ( d->look.value == PICTURE_BODY || ( d->sheet && d->picture > 0 ) )
    {
        return;
    }
    const char* title = d->look.value == PICTURE_STRAIN ? "strain"
                        : d->look.value == PICTURE_MAP  ? "map"
                        : d->source.has_seconds         ? "speed, m/s"
                                                        : "speed, m a frame";
    image_legend( picture, COLOUR_MAP_RISING, (double)d->look.range[0], (double)d->look.range[1], title );
}

static wisp_status render_one( drawing* d, image* out, wisp_error* error )
{
    wisp_status status = picture_source_load( &d->source, frame_of( &d->plan, d->picture ), error );
    picture_stage stage = { 0 };
    if ( status == WISP_OK )
    {
        status = picture_stage_make( &d->source, &d->look, &stage, error );
    }
    render_camera camera;
    status = status == WISP_OK ? camera_of( d, d->picture, &camera, error ) : status;
    if ( status == WISP_OK )
    {
        wisp_error cause = { 0 };
        bool sees_bodies = false;
        d->render.sees_bodies = &sees_bodies;
        status = render_picture( &stage.scene, &camera, &d->render, out, &cause );
        d->is_seen = d->is_seen || sees_bodies;
        if ( status == WISP_OK && !d->is_seen && d->picture + 1 == d->plan.count )
        {
            status = wisp_fail( &cause, WISP_BAD_INPUT, "the picture is empty: no body is in it%s%s",
                                d->options->has_camera ? ", seen from --camera" : "",
                                dot( d->look.cut_normal, d->look.cut_normal ) > 0.0 ? ", before --cut" : "" );
        }
        if ( status != WISP_OK )
        {
            wisp_fail( error, status, "%s: frame %d: %s", d->source.path, frame_of( &d->plan, d->picture ),
                       cause.message );
        }
    }
    picture_stage_release( &stage );
    if ( status == WISP_OK )
    {
        put_legend( d, out );
    }
    return status;
}

// ---- files ----

static wisp_status write_label( drawing* d, wisp_error* error )
{
    const int frame = frame_of( &d->plan, d->picture );
    double seconds = 0.0;
    wisp_error no_time = { 0 };
    char label[32];
    if ( d->plan.is_turning )
    {
        snprintf( label, sizeof label, "%.0f degrees", 360.0 * d->picture / d->plan.count );
    }
    else if ( d->source.has_seconds && d->source.input->time( &d->source, frame, &seconds, &no_time ) == WISP_OK )
    {
        snprintf( label, sizeof label, d->source.step < 0.01 ? "%.4f s" : "%.2f s", seconds );
    }
    else
    {
        snprintf( label, sizeof label, "frame %d", frame );
    }
    d->labels[d->picture] = io_copy( &d->memory, label, sizeof label );
    return d->memory.is_short ? no_sheet( d, error ) : WISP_OK;
}

/// The name of a picture in a sequence: file_0001.png of file.png.
static void name_of( const drawing* d, int picture, char* path )
{
    const char* output = d->options->output;
    if ( d->plan.count == 1 )
    {
        snprintf( path, PATH_SIZE, "%s", output );
        return;
    }
    snprintf( path, PATH_SIZE, "%.*s_%04d.png", (int)( strlen( output ) - strlen( ".png" ) ), output, picture + 1 );
}

static wisp_status write_picture( const drawing* d, const image* picture, wisp_error* error )
{
    char path[PATH_SIZE];
    name_of( d, d->picture, path );
    return image_write_png( path, picture, error );
}

// @param count of pictures that are drawn
static wisp_status write_contact_sheet( const drawing* d, int count, wisp_error* error )
{
    image sheet = { 0 };
    wisp_status status = image_sheet( d->sheet, count, d->options->columns, d->labels, &sheet, error );
    status = status == WISP_OK ? image_write_png( d->options->output, &sheet, error ) : status;
    image_release( &sheet );
    return status;
}

static wisp_status draw_all( drawing* d, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( ; d->picture < d->plan.count && status == WISP_OK; ++d->picture )
    {
        image picture = { 0 };
        status = render_one( d, &picture, error );
        if ( status == WISP_OK && d->sheet )
        {
            d->sheet[d->picture] = picture;
            status = write_label( d, error );
            continue;
        }
        if ( status == WISP_OK )
        {
            status = write_picture( d, &picture, error );
        }
        image_release( &picture );
    }
    // After an interruption the pictures that are whole are kept. The loop counted the one that is not.
    if ( status != WISP_OK && interruption_came() && d->picture > 1 )
    {
        --d->picture;
        status = WISP_OK;
    }
    return status == WISP_OK && d->sheet ? write_contact_sheet( d, d->picture, error ) : status;
}

// Checked before anything is drawn; changes of the folder meanwhile are reported at the end.
static wisp_status check_folder( const char* output, wisp_error* error )
{
    const char* slash = strrchr( output, '/' );
    char folder[PATH_SIZE] = ".";
    if ( io_is_standard( output ) )
    {
        return WISP_OK;
    }
    if ( strlen( output ) + sizeof( "_2147483647" ) >= sizeof( folder ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "-o: got a file name that is too long, expected at most %d characters",
                          PATH_SIZE - (int)sizeof( "_2147483647" ) );
    }
    if ( slash )
    {
        snprintf( folder, sizeof( folder ), "%.*s", slash > output ? (int)( slash - output ) : 1, output );
    }
    return access( folder, W_OK | X_OK ) == 0
               ? WISP_OK
               : wisp_fail( error, WISP_IO_ERROR, "%s: cannot be written: %s", output, strerror( errno ) );
}

// ---- all together ----

static int count_cores( void )
{
    cpu_set_t set;
    int count = sched_getaffinity( 0, sizeof( set ), &set ) == 0 ? CPU_COUNT( &set ) : 1;
    return count < WISP_MAX_WORKERS ? count : WISP_MAX_WORKERS;
}

static void set_render_options( drawing* d )
{
    const picture_options* options = d->options;
    d->render = render_default_options();
    if ( options->is_sheet )
    {
        d->render.width = SHEET_WIDTH;
        d->render.height = SHEET_HEIGHT;
    }
    if ( options->width > 0 )
    {
        d->render.width = options->width;
        d->render.height = options->height;
    }
    d->render.samples = options->samples;
    d->render.threads = options->workers > 0 ? options->workers : count_cores();
    d->render.progress = show_fraction;
    d->render.progress_user = d;
    d->render.is_cancelled = interruption_came;
}

static void print_summary( const drawing* d, double seconds )
{
    const plan* p = &d->plan;
    FILE* out = io_is_standard( d->options->output ) ? stderr : stdout; // which has the picture
    char first[PATH_SIZE];
    name_of( d, 0, first );
    fprintf( out, "%s: ", p->count > 1 && d->sheet ? d->options->output : first );
    if ( p->count > 1 )
    {
        fprintf( out, "%s%d pictures of ", d->sheet ? "" : "the first of ", d->picture );
    }
    fprintf( out, "%d x %d pixels, ", d->render.width, d->render.height );
    if ( p->count > 1 && !p->is_turning )
    {
        fprintf( out, "frames %d to %d of ", frame_of( p, 0 ), frame_of( p, d->picture - 1 ) );
    }
    else
    {
        fprintf( out, "frame %d of ", p->first );
    }
    fprintf( out, "%s, %.2f s\n", d->source.path, seconds );
    if ( d->picture < p->count )
    {
        fprintf( out, "interrupted at picture %d of %d\n", d->picture + 1, p->count );
    }
}

static void release( drawing* d )
{
    for ( int i = 0; d->sheet && i < d->plan.count; ++i )
    {
        image_release( &d->sheet[i] );
    }
    io_release( &d->memory );
    picture_source_close( &d->source );
}

wisp_status picture_draw( const picture_options* options, wisp_error* error )
{
    double start = wisp_clock_seconds();
    drawing d = { .options = options, .bar = progress_begin() };
    set_render_options( &d );
    wisp_status status = check_folder( options->output, error );
    status = status == WISP_OK ? picture_source_open( &options->source, &d.source, error ) : status;
    if ( status == WISP_OK )
    {
        interruption_begin(); // before that there is nothing to keep
        d.source.bar = &d.bar;
        status = choose( &d, error );
    }
    status = status == WISP_OK && options->is_sheet ? make_sheet_room( &d, error ) : status;
    status = status == WISP_OK ? survey_frames( &d, error ) : status;
    if ( status == WISP_OK )
    {
        // From here on the progress bar counts pictures; steps between two of them would make it jump.
        d.source.bar = NULL;
        status = draw_all( &d, error );
    }
    progress_end( &d.bar );
    if ( status == WISP_OK )
    {
        print_summary( &d, wisp_clock_seconds() - start );
    }
    release( &d );
    return status;
}
