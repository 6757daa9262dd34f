#include "render.h"

#include "check.h"
#include "shade.h"

#include <pthread.h>
#include <stdatomic.h>

// ---- threads for callers without a job system ----

typedef struct thread_team
{
    _Atomic int next; // next block to run
    int block_count;
    wisp_block_fn* run;
    void* context;
} thread_team;

typedef struct member
{
    thread_team* thread_team;
    int worker;
    pthread_t thread;
} member;

static void* work( void* context )
{
    const member* self = context;
    thread_team* c = self->thread_team;
    for ( int block = atomic_fetch_add( &c->next, 1 ); block < c->block_count;
          block = atomic_fetch_add( &c->next, 1 ) )
    {
        c->run( c->context, block, self->worker );
    }
    return NULL;
}

void threads_parallel_for( void* user, int block_count, wisp_block_fn* run, void* context )
{
    const int* requested = user;
    thread_team c = { .block_count = block_count, .run = run, .context = context };
    member members[WISP_MAX_WORKERS];
    members[0] = ( member ){ .thread_team = &c };
    int started = 1;
    for ( ; started < *requested && started < block_count; ++started )
    {
        members[started] = ( member ){ .thread_team = &c, .worker = started };
        if ( pthread_create( &members[started].thread, NULL, work, &members[started] ) != 0 )
        {
            break;
        }
    }
    work( &members[0] );
    for ( int k = 1; k < started; ++k )
    {
        pthread_join( members[k].thread, NULL );
    }
}

// ---- pictures ----

// From pixels to rays and from light to bytes. A pixel is a pure function of scene, camera, options and its own place,
// so it does not matter which thread draws it.

enum
{
    TILE = 16,                  // pixels, side of a tile of one thread
    RANDOM_STREAM = 0x70696374, // any number that no other stream of the program uses
};

// The camera, prepared for rays: pixel (x, y) is corner + x right + y down, at a metre in front of it.
typedef struct lens
{
    wisp_vec3 eye, corner, right, down;
} lens;

typedef struct picture
{
    const render_scene* scene;
    const render_options* options;
    stage stage;
    lens lens;
    wisp_random_key key;
    image target;
    int columns, tiles; // of tiles in a row, and in all
    _Atomic int done;   // tiles
    _Atomic bool sees_bodies;
} picture;

// Width of a pixel at a metre in front of the camera.
static float pixel_size( const render_camera* camera, int height )
{
    const float half_degree = 0.00872664626f;
    return 2.0f * tanf( half_degree * camera->fov_degrees ) / (float)height;
}

static lens make_lens( const render_camera* camera, const render_options* options )
{
    wisp_vec3 ahead = { 0.0f, 0.0f, -1.0f };
    wisp_vec3 forward = wisp_v3_normalize_or( wisp_v3_sub( camera->target, camera->eye ), ahead );
    wisp_vec3 right =
        wisp_v3_normalize_or( wisp_v3_cross( forward, wisp_v3_normalize_or( camera->up, ahead ) ), ahead );
    float size = pixel_size( camera, options->height );
    lens out = {
        .eye = camera->eye,
        .right = wisp_v3_scale( right, size ),
        .down = wisp_v3_scale( wisp_v3_cross( forward, right ), size ),
    };
    out.corner = wisp_v3_mul_add( forward, -0.5f * (float)options->width, out.right );
    out.corner = wisp_v3_mul_add( out.corner, -0.5f * (float)options->height, out.down );
    return out;
}

// ---- light -----------------------------------------------------------------------------------------------------

// By the height in the picture and not by direction, so that a fading ground needs no horizon.
static wisp_vec3 background_at( const picture* p, float y )
{
    float fraction = y / (float)p->options->height;
    return rgb_mix( p->scene->background_top, p->scene->background_bottom, smooth_step( 0.0f, 0.85f, fraction ) );
}

static float ground_hit( const stage* s, const trace_ray* ray )
{
    float height = ray->origin.y - s->ground.height;
    bool is_seen = s->ground.is_there && height > 0.0f && ray->direction.y < -1e-6f;
    return is_seen ? -height / ray->direction.y : INFINITY;
}

// @param panes_left of glass that the ray may still pass
static wisp_vec3 light_along( picture* p, const trace_ray* ray, float y, shade_sample sample, int panes_left )
{
    const stage* s = &p->stage;
    float ground = ground_hit( s, ray );
    trace_hit hit;
    if ( trace_nearest( s->tree, ray, &hit ) && hit.distance < ground )
    {
        atomic_store_explicit( &p->sees_bodies, true, memory_order_relaxed );
        surface at = stage_surface( s, ray, &hit );
        wisp_vec3 light = shade_surface( s, ray, &at, sample );
        if ( !stage_is_glass( s, hit.body ) || panes_left == 0 )
        {
            return light;
        }
        trace_ray behind = *ray;
        behind.origin = wisp_v3_mul_add( ray->origin, hit.distance + s->lift, ray->direction );
        wisp_vec3 through = stage_passage( s, hit.body, at.colour );
        return wisp_v3_add( light, rgb_mul( through, light_along( p, &behind, y, sample, panes_left - 1 ) ) );
    }
    wisp_vec3 background = background_at( p, y );
    return isfinite( ground ) ? shade_ground( s, ray, ground, background, sample ) : background;
}

// A tent filter as wide as two pixels, sampled by its own density so that every sample has the same weight: edges
// without aliasing.
static float tent( float u )
{
    return u < 0.5f ? sqrtf( 2.0f * u ) - 0.5f : 1.5f - sqrtf( 2.0f - 2.0f * u );
}

// One sample that hits a lamp in a mirror must not outshine the pixel's others: that would be a single white dot.
static wisp_vec3 tamed( wisp_vec3 light )
{
    const float most = 6.0f;
    float largest = rgb_largest( light );
    return largest > most ? wisp_v3_scale( light, most / largest ) : light;
}

static wisp_vec3 light_of_pixel( picture* p, int column, int row )
{
    int samples = p->options->samples;
    sampler pixel = sampler_of_pixel( p->key, column, row, samples );
    wisp_vec3 sum = { 0.0f, 0.0f, 0.0f };
    for ( int k = 0; k < samples; ++k )
    {
        sampler_point at = sampler_at( &pixel, k, SAMPLER_PIXEL );
        float x = (float)column + tent( at.x ), y = (float)row + tent( at.y );
        wisp_vec3 aim = wisp_v3_mul_add( wisp_v3_mul_add( p->lens.corner, x, p->lens.right ), y, p->lens.down );
        trace_ray ray = { p->lens.eye, wisp_v3_normalize_or( aim, aim ), INFINITY };
        sum = wisp_v3_add(
            sum, tamed( light_along( p, &ray, (float)row + 0.5f, ( shade_sample ){ &pixel, k }, SHADE_PANES_MAX ) ) );
    }
    return wisp_v3_scale( sum, 1.0f / (float)samples );
}

// ---- bytes -----------------------------------------------------------------------------------------------------

// Colours up to here stay as they are; above, the brightest channel approaches one and the others follow it to white.
// The shape is that of Khronos' "PBR neutral" curve without its toe.
static wisp_vec3 rolled_off( wisp_vec3 light )
{
    const float start = 0.72f, room = 1.0f - start, whitening = 0.18f;
    float peak = rgb_largest( light );
    if ( peak <= start )
    {
        return light;
    }
    float pressed = 1.0f - room * room / ( peak + room - start );
    float left = 1.0f / ( whitening * ( peak - pressed ) + 1.0f );
    return rgb_mix( rgb_grey( pressed ), wisp_v3_scale( light, pressed / peak ), left );
}

static void store( picture* p, int column, int row, wisp_vec3 light )
{
    light = wisp_v3_scale( light, p->options->exposure );
    wisp_vec3 shown = p->options->tone == RENDER_TONE_FILMIC ? rolled_off( light ) : light;
    uint8_t* rgb = p->target.rgb + 3 * ( (size_t)row * (size_t)p->options->width + (size_t)column );
    rgb[0] = image_byte_of_linear( shown.x );
    rgb[1] = image_byte_of_linear( shown.y );
    rgb[2] = image_byte_of_linear( shown.z );
}

// Worker 0 reports the progress of all, without a lock.
static void draw_tile( void* context, int tile, int worker )
{
    picture* p = context;
    if ( p->options->is_cancelled != NULL && p->options->is_cancelled() )
    {
        return;
    }
    int left = TILE * ( tile % p->columns ), top = TILE * ( tile / p->columns );
    for ( int row = top; row < top + TILE && row < p->options->height; ++row )
    {
        for ( int column = left; column < left + TILE && column < p->options->width; ++column )
        {
            store( p, column, row, light_of_pixel( p, column, row ) );
        }
    }
    int done = atomic_fetch_add( &p->done, 1 ) + 1;
    if ( worker == 0 && p->options->progress != NULL )
    {
        p->options->progress( p->options->progress_user, (double)done / p->tiles );
    }
}

static void draw( picture* p )
{
    const render_options* options = p->options;
    p->columns = ( options->width + TILE - 1 ) / TILE;
    p->tiles = p->columns * ( ( options->height + TILE - 1 ) / TILE );
    int threads = options->threads;
    bool is_hosted = options->parallel_for != NULL;
    wisp_parallel_for_fn* parallel_for = is_hosted ? options->parallel_for : threads_parallel_for;
    parallel_for( is_hosted ? options->parallel_user : &threads, p->tiles, draw_tile, p );
    if ( options->progress != NULL )
    {
        options->progress( options->progress_user, 1.0 );
    }
}

wisp_status render_picture( const render_scene* scene, const render_camera* camera, const render_options* options,
                            image* out, wisp_error* error )
{
    wisp_status status = check_options( options, error );
    status = status == WISP_OK ? check_camera( camera, error ) : status;
    status = status == WISP_OK ? check_scene( scene, error ) : status;
    picture p = { .scene = scene, .options = options };
    if ( status == WISP_OK )
    {
        status = image_make( options->width, options->height, ( image_colour ){ 0, 0, 0 }, &p.target, error );
    }
    if ( status == WISP_OK )
    {
        float fraction = pixel_size( camera, options->height );
        status = stage_build( &p.stage, scene, camera, options, fraction, error );
    }
    if ( status != WISP_OK )
    {
        image_release( &p.target );
        return status;
    }
    p.lens = make_lens( camera, options );
    p.key = wisp_random_make_key( options->seed, RANDOM_STREAM, 0 );
    draw( &p );
    stage_release( &p.stage );
    if ( atomic_load( &p.done ) < p.tiles )
    {
        image_release( &p.target );
        return wisp_fail( error, WISP_CONFLICT, "the picture was cancelled" );
    }
    if ( options->sees_bodies != NULL )
    {
        *options->sees_bodies = atomic_load( &p.sees_bodies );
    }
    image_release( out );
    *out = p.target;
    return WISP_OK;
}
