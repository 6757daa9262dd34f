// The lamps, and visibility between them and a point.
#include "shade.h"

const float light_key_strength = 1.75f;
const float light_sky_strength = 0.26f;

// Tangent of the key light's half angle: about seven degrees, like a window rather than the sun.
static const float KEY_WIDTH = 0.12f;

enum
{
    SKINS_MAX = 32, // limit of bodies that light passes through
};

// Colours of the sky in the upper half, and of the floor of the room in the lower one, where there is no ground.
static const wisp_vec3 ZENITH = { 0.86f, 0.95f, 1.12f };
static const wisp_vec3 HORIZON = { 1.06f, 1.02f, 0.97f };
static const wisp_vec3 FLOOR = { 0.52f, 0.49f, 0.46f };

// The fraction of light that a shadowed body still receives from everywhere: bounces that are not followed.
static const float BOUNCE = 0.36f;

// ---- directions ------------------------------------------------------------------------------------------------

// From the square to the disc without a seam: rings become rings (Shirley and Chiu 1997).
static sampler_point disc_of_square( sampler_point p )
{
    float a = 2.0f * p.x - 1.0f, b = 2.0f * p.y - 1.0f;
    if ( a == 0.0f && b == 0.0f )
    {
        return ( sampler_point ){ 0.0f, 0.0f };
    }
    const float eighth = 0.785398163f;
    bool is_wide = fabsf( a ) > fabsf( b );
    float radius = is_wide ? a : b;
    float angle = is_wide ? eighth * ( b / a ) : 2.0f * eighth - eighth * ( a / b );
    return ( sampler_point ){ radius * cosf( angle ), radius * sinf( angle ) };
}

wisp_vec3 light_key_direction( const stage* s, shade_sample sample )
{
    sampler_point p = disc_of_square( sampler_at( sample.pixel, sample.number, SAMPLER_LIGHT ) );
    wisp_vec3 d = v3_mul_add( s->lamps.key, KEY_WIDTH * p.x, s->lamps.key_x );
    return v3_normalize_or( v3_mul_add( d, KEY_WIDTH * p.y, s->lamps.key_y ), s->lamps.key );
}

wisp_vec3 light_sky_direction( wisp_vec3 normal, shade_sample sample )
{
    sampler_point p = disc_of_square( sampler_at( sample.pixel, sample.number, SAMPLER_SKY ) );

    // A frame without a branch that could jump between neighbouring normals (Duff et al. 2017).
    float sign = copysignf( 1.0f, normal.z );
    float a = -1.0f / ( sign + normal.z ), b = normal.x * normal.y * a;
    wisp_vec3 x = { 1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x };
    wisp_vec3 y = { b, sign + normal.y * normal.y * a, -normal.y };
    float height = sqrtf( fmaxf( 0.0f, 1.0f - p.x * p.x - p.y * p.y ) );
    wisp_vec3 d = v3_mul_add( v3_mul_add( v3_scale( normal, height ), p.x, x ), p.y, y );
    return v3_normalize_or( d, normal );
}

// ---- shadows ---------------------------------------------------------------------------------------------------

wisp_vec3 light_of_key( const stage* s, wisp_vec3 place, wisp_vec3 towards, float far )
{
    wisp_vec3 left = rgb_grey( light_key_strength );
    trace_ray ray = { place, towards, far };
    if ( !s->has_translucent )
    {
        return trace_blocked( s->tree, &ray ) ? rgb_grey( 0.0f ) : left;
    }
    trace_hit hit;
    for ( int skin = 0; trace_nearest( s->tree, &ray, &hit ); ++skin )
    {
        left = rgb_mul( left, stage_passage( s, hit.body, stage_colour( s, &hit ) ) );
        if ( skin == SKINS_MAX || rgb_largest( left ) < 0.05f )
        {
            return rgb_grey( 0.0f );
        }
        // Past the whole strand, so that it counts once; past the skin of a mesh by a small offset.
        float step = s->lift;
        if ( stage_is_curve( s, hit.body ) )
        {
            const render_curves* curves = &s->scene->curves[hit.body - s->scene->mesh_count];
            step += 2.0f * trace_radius( &s->widening, curves, hit.primitive );
        }
        ray.origin = v3_mul_add( ray.origin, hit.distance + step, towards );
    }
    return left;
}

// ---- the sky ---------------------------------------------------------------------------------------------------

static wisp_vec3 sky( wisp_vec3 direction )
{
    float rise = direction.y;
    wisp_vec3 above = rgb_mix( HORIZON, ZENITH, sqrtf( clamp01( rise ) ) );
    return v3_scale( rgb_mix( above, FLOOR, smooth_step( 0.0f, 0.25f, -rise ) ), light_sky_strength );
}

// A soft box: a rounded rectangle around an axis, with soft edges. Sides are tangents of half angles.
static float soft_box( wisp_vec3 direction, wisp_vec3 axis, wisp_vec3 x, wisp_vec3 y, float wide, float upper )
{
    float front = v3_dot( direction, axis );
    if ( front <= 0.05f )
    {
        return 0.0f;
    }
    float a = v3_dot( direction, x ) / ( front * wide ), b = v3_dot( direction, y ) / ( front * upper );
    float power = a * a * a * a + b * b * b * b;
    return 1.0f - smooth_step( 0.75f, 1.25f, power );
}

static wisp_vec3 lamps_in_mirror( const stage* s, wisp_vec3 direction )
{
    const stage_lamps* lamps = &s->lamps;
    float key = soft_box( direction, lamps->key, lamps->key_x, lamps->key_y, 0.30f, 0.36f );
    float rim = soft_box( direction, lamps->rim, lamps->rim_x, lamps->rim_y, 0.20f, 0.85f );
    wisp_vec3 white = { 15.0f, 14.7f, 14.2f }, cool = { 4.2f, 4.6f, 5.2f };
    return v3_add( v3_scale( white, key ), v3_scale( cool, rim ) );
}

static float ground_distance( const stage* s, const trace_ray* ray )
{
    float fall = -ray->direction.y, height = ray->origin.y - s->ground.height;
    return s->ground.is_there && fall > 1e-6f && height >= 0.0f ? height / fall : INFINITY;
}

// Near a body the ground is in its shadow, so it reflects less the nearer it is. The shadow itself is not computed:
// that would take two more rays.
static wisp_vec3 ground_light( const stage* s, float distance )
{
    float open = 0.25f + 0.75f * smooth_step( 0.0f, 0.9f, distance / s->size );
    return v3_scale( s->scene->background_bottom, BOUNCE * open );
}

bool light_find_opaque( const stage* s, trace_ray* ray, trace_hit* hit )
{
    bool is_found = trace_nearest( s->tree, ray, hit );
    for ( int pane = 0; is_found && stage_is_glass( s, hit->body ) && pane < SHADE_PANES_MAX; ++pane )
    {
        ray->origin = v3_mul_add( ray->origin, hit->distance + s->lift, ray->direction );
        is_found = trace_nearest( s->tree, ray, hit );
    }
    return is_found && !stage_is_glass( s, hit->body );
}

static wisp_vec3 surroundings( const stage* s, const trace_ray* start, bool is_mirror )
{
    trace_ray moved = *start;
    const trace_ray* ray = &moved;
    trace_hit hit;
    if ( light_find_opaque( s, &moved, &hit ) )
    {
        return v3_scale( stage_colour( s, &hit ), BOUNCE );
    }
    float ground = ground_distance( s, ray );
    if ( isfinite( ground ) )
    {
        return ground_light( s, ground );
    }
    wisp_vec3 seen = sky( ray->direction );
    return is_mirror ? v3_add( seen, lamps_in_mirror( s, ray->direction ) ) : seen;
}

wisp_vec3 light_of_surroundings( const stage* s, const trace_ray* ray )
{
    return surroundings( s, ray, false );
}

wisp_vec3 light_in_mirror( const stage* s, const trace_ray* ray )
{
    return surroundings( s, ray, true );
}
