#include "stage.h"

#include <stdlib.h>

static const wisp_vec3 UP = { 0.0f, 1.0f, 0.0f };

// Positions of the lamps relative to the camera: key at the upper left, the rim box behind at the right.
static const float KEY_AZIMUTH = -1.25f, KEY_HEIGHT = 0.75f; // radians beside the eye; height over one horizontal
static const float RIM_AZIMUTH = 2.45f, RIM_HEIGHT = 0.35f;

enum
{
    SQUARES_ACROSS = 6, // approximate limit of ground squares under the bodies
};

// ---- normals ---------------------------------------------------------------------------------------------------

// The cross product is twice the area long, so the plain sum is weighted by area.
static void sum_normals( const render_mesh* mesh, wisp_vec3* normals )
{
    for ( size_t k = 0; k < 3 * (size_t)mesh->triangle_count; k += 3 )
    {
        const int32_t* t = mesh->triangles + k;
        wisp_vec3 a = mesh->points[t[0]];
        wisp_vec3 n = wisp_v3_cross( wisp_v3_sub( mesh->points[t[1]], a ), wisp_v3_sub( mesh->points[t[2]], a ) );
        for ( int corner = 0; corner < 3; ++corner )
        {
            normals[t[corner]] = wisp_v3_add( normals[t[corner]], n );
        }
    }
}

// Squares of small areas leave the range of floats long before the areas do.
static wisp_vec3 direction_of_sum( wisp_vec3 sum )
{
    float largest = fmaxf( fabsf( sum.x ), fmaxf( fabsf( sum.y ), fabsf( sum.z ) ) );
    wisp_vec3 none = { 0.0f, 0.0f, 0.0f };
    return largest > 0.0f ? wisp_v3_normalize_or( wisp_v3_scale( sum, 1.0f / largest ), none ) : none;
}

static wisp_status add_normals( stage* out, const render_scene* scene, wisp_error* error )
{
    out->normals = calloc( (size_t)scene->mesh_count + 1, sizeof( *out->normals ) );
    bool good = out->normals != NULL;
    for ( int i = 0; i < scene->mesh_count && good; ++i )
    {
        const render_mesh* mesh = &scene->meshes[i];
        if ( mesh->is_faceted )
        {
            continue;
        }
        wisp_vec3* normals = calloc( (size_t)mesh->vertex_count + 1, sizeof( wisp_vec3 ) );
        out->normals[i] = normals;
        good = normals != NULL;
        if ( good )
        {
            sum_normals( mesh, normals );
        }
        for ( int v = 0; v < mesh->vertex_count && good; ++v )
        {
            normals[v] = direction_of_sum( normals[v] );
        }
    }
    return good ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "picture: out of memory for the normals" );
}

// ---- lamps and ground ------------------------------------------------------------------------------------------

static void span_across( wisp_vec3 axis, wisp_vec3* x, wisp_vec3* y )
{
    wisp_vec3 other = fabsf( axis.y ) > 0.99f ? ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f } : UP;
    *x = wisp_v3_normalize_or( wisp_v3_cross( other, axis ), ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f } );
    *y = wisp_v3_cross( axis, *x );
}

// Lamps follow the camera around the vertical axis, as on a turntable, but not its height.
static wisp_vec3 lamp_direction( wisp_vec3 towards_eye, float azimuth, float height )
{
    wisp_vec3 turned = wisp_v3_rotate( UP, sinf( azimuth ), cosf( azimuth ), towards_eye );
    turned.y = height;
    return wisp_v3_normalize_or( turned, UP );
}

static void set_lamps( stage* out, const render_camera* camera, const render_options* options )
{
    wisp_vec3 level = wisp_v3_sub( camera->eye, camera->target );
    level.y = 0.0f;
    wisp_vec3 towards_eye = wisp_v3_normalize_or( level, ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f } );
    stage_lamps* lamps = &out->lamps;
    lamps->key = lamp_direction( towards_eye, KEY_AZIMUTH, KEY_HEIGHT );
    lamps->key = wisp_v3_normalize_or( options->light, lamps->key );
    lamps->rim = lamp_direction( towards_eye, RIM_AZIMUTH, RIM_HEIGHT );
    span_across( lamps->key, &lamps->key_x, &lamps->key_y );
    span_across( lamps->rim, &lamps->rim_x, &lamps->rim_y );
}

// The largest of 1, 2 and 5 times a power of ten that is not above `limit`.
static float round_length( float limit )
{
    float power = powf( 10.0f, floorf( log10f( limit ) ) );
    float times = limit / power;
    return power * ( times >= 5.0f ? 5.0f : times >= 2.0f ? 2.0f : 1.0f );
}

static void set_lengths( stage* out, const render_scene* scene, const render_bounds* bounds )
{
    wisp_vec3 none = { 0.0f, scene->has_ground ? scene->ground_height : 0.0f, 0.0f };
    out->middle = bounds->is_filled ? wisp_v3_scale( wisp_v3_add( bounds->lower, bounds->upper ), 0.5f ) : none;
    out->size = bounds->is_filled ? 0.5f * wisp_v3_length( wisp_v3_sub( bounds->upper, bounds->lower ) ) : 1.0f;
    out->size = fmaxf( out->size, 1e-4f );

    // Offset of a ray's start: the step of floats far from the origin, a fraction of the bodies' size near it.
    float farthest = fmaxf( fabsf( out->middle.x ), fmaxf( fabsf( out->middle.y ), fabsf( out->middle.z ) ) );
    out->lift = fmaxf( 3e-5f * out->size, 1e-6f * ( farthest + out->size ) );
    out->ground = ( stage_ground ){
        .is_there = scene->has_ground,
        .height = scene->ground_height,
        .square = round_length( 2.0f * out->size / ( 0.5f * SQUARES_ACROSS ) ),
        .visible = 5.0f * out->size,
    };
}

static bool lets_light_through( const render_scene* scene )
{
    bool any = scene->curves_count > 0;
    for ( int i = 0; i < scene->mesh_count && !any; ++i )
    {
        any = scene->meshes[i].material != RENDER_SOLID;
    }
    return any;
}

wisp_status stage_build( stage* out, const render_scene* scene, const render_camera* camera,
                         const render_options* options, float pixel_fraction, wisp_error* error )
{
    *out = ( stage ){ .scene = scene, .has_translucent = lets_light_through( scene ) };
    out->widening = ( trace_widening ){ camera->eye, 0.5f * options->min_curve_pixels * pixel_fraction };
    render_bounds bounds;
    wisp_status status = render_scene_bounds( scene, &bounds, error );
    if ( status == WISP_OK )
    {
        set_lamps( out, camera, options );
        set_lengths( out, scene, &bounds );
        status = add_normals( out, scene, error );
    }
    if ( status == WISP_OK )
    {
        status = trace_build( scene, &out->widening, &out->tree, error );
    }
    if ( status != WISP_OK )
    {
        stage_release( out );
    }
    return status;
}

void stage_release( stage* s )
{
    trace_release( s->tree );
    for ( int i = 0; s->normals != NULL && i < s->scene->mesh_count; ++i )
    {
        free( s->normals[i] );
    }
    free( s->normals );
    *s = ( stage ){ .scene = NULL };
}

// ---- hits ------------------------------------------------------------------------------------------------------

static bool is_points( const stage* s, int body )
{
    return body >= s->scene->mesh_count + s->scene->curves_count;
}

bool stage_is_curve( const stage* s, int body )
{
    return body >= s->scene->mesh_count && !is_points( s, body );
}

static const render_curves* curves_of( const stage* s, int body )
{
    return &s->scene->curves[body - s->scene->mesh_count];
}

static wisp_vec3 point_colour( const stage* s, const trace_hit* hit )
{
    const render_points* points = &s->scene->points[hit->body - s->scene->mesh_count - s->scene->curves_count];
    return points->colours != NULL ? points->colours[hit->primitive] : points->colour;
}

// Strands of one colour would merge into one surface, so each is a little lighter or darker than the next. The strand
// is not known, but its root's neighbours are: a hash of the vertex would give every segment another colour.
static int strand_of( const render_curves* curves, int vertex )
{
    int lower = 0, upper = curves->strand_count - 1;
    while ( lower < upper )
    {
        int half = lower + ( upper - lower ) / 2;
        if ( curves->offsets[half + 1] > vertex )
        {
            upper = half;
        }
        else
        {
            lower = half + 1;
        }
    }
    return lower;
}

static wisp_vec3 curve_colour( const render_curves* curves, const trace_hit* hit )
{
    int v = hit->primitive;
    wisp_vec3 colour = curves->colour;
    if ( curves->colours != NULL )
    {
        colour = rgb_mix( curves->colours[v], curves->colours[v + 1], hit->u );
    }
    if ( !curves->is_hair )
    {
        return colour;
    }
    wisp_random_key key = wisp_random_make_key( 0, 0, 0 );
    float fraction = wisp_random_unit_float( key, (uint32_t)strand_of( curves, v ), 0, 0 );
    return wisp_v3_scale( colour, 0.65f + 0.70f * fraction );
}

wisp_vec3 stage_colour( const stage* s, const trace_hit* hit )
{
    if ( is_points( s, hit->body ) )
    {
        return point_colour( s, hit );
    }
    if ( stage_is_curve( s, hit->body ) )
    {
        return curve_colour( curves_of( s, hit->body ), hit );
    }
    const render_mesh* mesh = &s->scene->meshes[hit->body];
    if ( mesh->colours == NULL )
    {
        return mesh->colour;
    }
    const int32_t* t = mesh->triangles + 3 * (size_t)hit->primitive;
    wisp_vec3 colour = wisp_v3_scale( mesh->colours[t[0]], 1.0f - hit->u - hit->v );
    colour = wisp_v3_mul_add( colour, hit->u, mesh->colours[t[1]] );
    return wisp_v3_mul_add( colour, hit->v, mesh->colours[t[2]] );
}

wisp_vec3 stage_passage( const stage* s, int body, wisp_vec3 colour )
{
    if ( is_points( s, body ) )
    {
        return rgb_grey( 0.0f );
    }
    if ( stage_is_curve( s, body ) )
    {
        // Brown hair absorbs blue first; light through several strands is warm.
        return ( wisp_vec3 ){ 0.62f * sqrtf( sqrtf( colour.x ) ), 0.62f * sqrtf( sqrtf( colour.y ) ),
                              0.62f * sqrtf( sqrtf( colour.z ) ) };
    }
    switch ( s->scene->meshes[body].material )
    {
        case RENDER_CLOTH:
            return wisp_v3_scale( colour, 0.10f );
        case RENDER_LATEX:
            return ( wisp_vec3 ){ 0.62f * sqrtf( colour.x ), 0.62f * sqrtf( colour.y ), 0.62f * sqrtf( colour.z ) };
        case RENDER_GLASS:
            return rgb_grey( 0.90f );
        case RENDER_SOLID:
            break;
    }
    return rgb_grey( 0.0f );
}

bool stage_is_glass( const stage* s, int body )
{
    return body < s->scene->mesh_count && s->scene->meshes[body].material == RENDER_GLASS;
}

static float away( wisp_vec3 place, wisp_vec3 vertex, wisp_vec3 normal )
{
    return fminf( 0.0f, wisp_v3_dot( wisp_v3_sub( place, vertex ), normal ) );
}

// A coarse round body has flat triangles, and with smooth normals a lamp is above the horizon before it is above the
// triangle. The start of the ray is lifted to the position on the round surface (Hanika 2021, "Hacking the Shadow
// Terminator").
static wisp_vec3 lift_to_round( const render_mesh* mesh, const wisp_vec3* normals, const trace_hit* hit, float side,
                                wisp_vec3 place )
{
    const int32_t* t = mesh->triangles + 3 * (size_t)hit->primitive;
    const float weights[3] = { 1.0f - hit->u - hit->v, hit->u, hit->v };
    wisp_vec3 lifted = place;
    for ( int k = 0; k < 3; ++k )
    {
        wisp_vec3 normal = wisp_v3_scale( normals[t[k]], side );
        lifted = wisp_v3_mul_add( lifted, -weights[k] * away( place, mesh->points[t[k]], normal ), normal );
    }
    return lifted;
}

static void shape_mesh( const stage* s, const trace_hit* hit, surface* out )
{
    const render_mesh* mesh = &s->scene->meshes[hit->body];
    const wisp_vec3* normals = s->normals[hit->body];
    out->material = mesh->material;
    out->is_painted = mesh->colours != NULL;
    if ( normals == NULL )
    {
        return;
    }
    const int32_t* t = mesh->triangles + 3 * (size_t)hit->primitive;
    wisp_vec3 sum = wisp_v3_scale( normals[t[0]], 1.0f - hit->u - hit->v );
    sum = wisp_v3_mul_add( wisp_v3_mul_add( sum, hit->u, normals[t[1]] ), hit->v, normals[t[2]] );
    float side = wisp_v3_dot( sum, out->face ) < 0.0f ? -1.0f : 1.0f;
    out->normal = wisp_v3_normalize_or( wisp_v3_scale( sum, side ), out->face );
    out->lifted = lift_to_round( mesh, normals, hit, side, out->lifted );
}

static void shape_curve( const stage* s, const trace_ray* ray, const trace_hit* hit, surface* out )
{
    const render_curves* curves = curves_of( s, hit->body );
    int strand = strand_of( curves, hit->primitive );
    // The tangent runs smoothly through the vertices, also where the drawn segments are straight.
    wisp_vec3 tangent = rgb_mix( trace_tangent( curves, strand, hit->primitive ),
                                 trace_tangent( curves, strand, hit->primitive + 1 ), hit->u );
    out->is_curve = true;
    out->tangent = wisp_v3_normalize_or( tangent, UP );
    out->radius = trace_radius( &s->widening, curves, hit->primitive );

    // A strand is thinner than a pixel, so its own round normal would only be noise: it faces the camera.
    wisp_vec3 across = wisp_v3_mul_add( ray->direction, -wisp_v3_dot( ray->direction, out->tangent ), out->tangent );
    out->normal = wisp_v3_normalize_or( wisp_v3_scale( across, -1.0f ), out->face );
}

surface stage_surface( const stage* s, const trace_ray* ray, const trace_hit* hit )
{
    surface out = { .body = hit->body, .colour = stage_colour( s, hit ) };
    out.place = wisp_v3_mul_add( ray->origin, hit->distance, ray->direction );
    out.face = wisp_v3_dot( hit->normal, ray->direction ) > 0.0f ? wisp_v3_scale( hit->normal, -1.0f ) : hit->normal;
    out.normal = out.face;
    out.is_back = wisp_v3_dot( hit->normal, ray->direction ) > 0.0f;
    out.lifted = wisp_v3_mul_add( out.place, s->lift, out.face );
    // A ball has its exact normal, and is solid like an empty surface.
    if ( stage_is_curve( s, hit->body ) )
    {
        shape_curve( s, ray, hit, &out );
    }
    else if ( !is_points( s, hit->body ) )
    {
        shape_mesh( s, hit, &out );
    }
    return out;
}
