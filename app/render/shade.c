#include "shade.h"

// ---- light ----

// The lamps, and visibility between them and a point.

// The brightness of the key light on a surface that faces it, and of the whole sky without occlusion.
static const float light_key_strength = 1.75f;
static const float light_sky_strength = 0.26f;

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

// A direction towards a point of the key light.
static wisp_vec3 light_key_direction( const stage* s, shade_sample sample )
{
    sampler_point p = disc_of_square( sampler_at( sample.pixel, sample.number, SAMPLER_LIGHT ) );
    wisp_vec3 d = wisp_v3_mul_add( s->lamps.key, KEY_WIDTH * p.x, s->lamps.key_x );
    return wisp_v3_normalize_or( wisp_v3_mul_add( d, KEY_WIDTH * p.y, s->lamps.key_y ), s->lamps.key );
}

// A direction around a normal, distributed by the cosine.
static wisp_vec3 light_sky_direction( wisp_vec3 normal, shade_sample sample )
{
    sampler_point p = disc_of_square( sampler_at( sample.pixel, sample.number, SAMPLER_SKY ) );

    // A frame without a branch that could jump between neighbouring normals (Duff et al. 2017).
    float sign = copysignf( 1.0f, normal.z );
    float a = -1.0f / ( sign + normal.z ), b = normal.x * normal.y * a;
    wisp_vec3 x = { 1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x };
    wisp_vec3 y = { b, sign + normal.y * normal.y * a, -normal.y };
    float height = sqrtf( fmaxf( 0.0f, 1.0f - p.x * p.x - p.y * p.y ) );
    wisp_vec3 d = wisp_v3_mul_add( wisp_v3_mul_add( wisp_v3_scale( normal, height ), p.x, x ), p.y, y );
    return wisp_v3_normalize_or( d, normal );
}

// ---- shadows ---------------------------------------------------------------------------------------------------

// Light from the key light at a point, through all translucent bodies in between.
// @param towards unit length @param far m, may be infinite
static wisp_vec3 light_of_key( const stage* s, wisp_vec3 place, wisp_vec3 towards, float far )
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
        ray.origin = wisp_v3_mul_add( ray.origin, hit.distance + step, towards );
    }
    return left;
}

// ---- the sky ---------------------------------------------------------------------------------------------------

static wisp_vec3 sky( wisp_vec3 direction )
{
    float rise = direction.y;
    wisp_vec3 above = rgb_mix( HORIZON, ZENITH, sqrtf( clamp01( rise ) ) );
    return wisp_v3_scale( rgb_mix( above, FLOOR, smooth_step( 0.0f, 0.25f, -rise ) ), light_sky_strength );
}

// A soft box: a rounded rectangle around an axis, with soft edges. Sides are tangents of half angles.
static float soft_box( wisp_vec3 direction, wisp_vec3 axis, wisp_vec3 x, wisp_vec3 y, float wide, float upper )
{
    float front = wisp_v3_dot( direction, axis );
    if ( front <= 0.05f )
    {
        return 0.0f;
    }
    float a = wisp_v3_dot( direction, x ) / ( front * wide ), b = wisp_v3_dot( direction, y ) / ( front * upper );
    float power = a * a * a * a + b * b * b * b;
    return 1.0f - smooth_step( 0.75f, 1.25f, power );
}

static wisp_vec3 lamps_in_mirror( const stage* s, wisp_vec3 direction )
{
    const stage_lamps* lamps = &s->lamps;
    float key = soft_box( direction, lamps->key, lamps->key_x, lamps->key_y, 0.30f, 0.36f );
    float rim = soft_box( direction, lamps->rim, lamps->rim_x, lamps->rim_y, 0.20f, 0.85f );
    wisp_vec3 white = { 15.0f, 14.7f, 14.2f }, cool = { 4.2f, 4.6f, 5.2f };
    return wisp_v3_add( wisp_v3_scale( white, key ), wisp_v3_scale( cool, rim ) );
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
    return wisp_v3_scale( s->scene->background_bottom, BOUNCE * open );
}

// The nearest body that is not glass. The ray starts at the last pane before it, afterwards.
static bool light_find_opaque( const stage* s, trace_ray* ray, trace_hit* hit )
{
    bool is_found = trace_nearest( s->tree, ray, hit );
    for ( int pane = 0; is_found && stage_is_glass( s, hit->body ) && pane < SHADE_PANES_MAX; ++pane )
    {
        ray->origin = wisp_v3_mul_add( ray->origin, hit->distance + s->lift, ray->direction );
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
        return wisp_v3_scale( stage_colour( s, &hit ), BOUNCE );
    }
    float ground = ground_distance( s, ray );
    if ( isfinite( ground ) )
    {
        return ground_light( s, ground );
    }
    wisp_vec3 seen = sky( ray->direction );
    return is_mirror ? wisp_v3_add( seen, lamps_in_mirror( s, ray->direction ) ) : seen;
}

// Light from the sky or from the nearest body in a direction, by one ray.
static wisp_vec3 light_of_surroundings( const stage* s, const trace_ray* ray )
{
    return surroundings( s, ray, false );
}

// The same with the lamps as seen in a mirror.
static wisp_vec3 light_in_mirror( const stage* s, const trace_ray* ray )
{
    return surroundings( s, ray, true );
}

// ---- materials ----

// Materials. Each adds three terms: the key light, the light from all around, and reflections.

static wisp_vec3 sky_on( const stage* s, const surface* at, shade_sample sample )
{
    wisp_vec3 d = light_sky_direction( at->normal, sample );

    // A smooth normal allows directions that lead into the flat triangle; they are mirrored out of it.
    float depth = wisp_v3_dot( d, at->face );
    if ( depth < 0.0f && !at->is_curve )
    {
        d = wisp_v3_mul_add( d, -2.0f * depth, at->face );
    }
    trace_ray ray = { at->lifted, d, INFINITY };
    return light_of_surroundings( s, &ray );
}

// Schlick 1994.
static float fresnel( float base, float cosine )
{
    float away = 1.0f - clamp01( cosine );
    float squared = away * away;
    return base + ( 1.0f - base ) * squared * squared * away;
}

// Glossy reflection, spread over a disc according to the roughness.
static wisp_vec3 mirror( const stage* s, const trace_ray* ray, const surface* at, float rough, shade_sample sample )
{
    float cosine = -wisp_v3_dot( ray->direction, at->normal );
    wisp_vec3 back = wisp_v3_mul_add( ray->direction, 2.0f * cosine, at->normal );
    sampler_point p = sampler_at( sample.pixel, sample.number, SAMPLER_MIRROR );
    wisp_vec3 x, y;
    wisp_vec3 other = fabsf( back.y ) > 0.9f ? ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f } : ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f };
    x = wisp_v3_normalize_or( wisp_v3_cross( other, back ), other );
    y = wisp_v3_cross( back, x );
    back = wisp_v3_mul_add( wisp_v3_mul_add( back, rough * ( 2.0f * p.x - 1.0f ), x ), rough * ( 2.0f * p.y - 1.0f ),
                            y );
    float depth = wisp_v3_dot( back, at->face );
    if ( depth < 0.0f )
    {
        back = wisp_v3_mul_add( back, -2.0f * depth, at->face );
    }
    trace_ray out = { at->lifted, wisp_v3_normalize_or( back, at->normal ), INFINITY };
    return light_in_mirror( s, &out );
}

// ---- meshes ----------------------------------------------------------------------------------------------------

static wisp_vec3 shade_solid( const stage* s, const trace_ray* ray, const surface* at, shade_sample sample )
{
    wisp_vec3 towards = light_key_direction( s, sample );
    float facing = wisp_v3_dot( at->normal, towards );
    wisp_vec3 light = sky_on( s, at, sample );
    if ( facing > 0.0f )
    {
        wisp_vec3 key = light_of_key( s, at->lifted, towards, INFINITY );
        light = wisp_v3_mul_add( light, facing, key );
        wisp_vec3 half = wisp_v3_normalize_or( wisp_v3_sub( towards, ray->direction ), at->normal );
        float gloss = 0.10f * powf( clamp01( wisp_v3_dot( half, at->normal ) ), 24.0f );
        return wisp_v3_mul_add( rgb_mul( at->colour, light ), gloss * facing, key );
    }
    return rgb_mul( at->colour, light );
}

// Oren and Nayar's rough diffuse in Fujii's form, for a standard deviation of 0.5 radians: folds look soft because
// light that grazes them is not lost.
static float rough_diffuse( float facing, float seen, float between )
{
    float s = between - facing * seen;
    float t = s > 0.0f ? fmaxf( facing, seen ) : 1.0f;
    const float a = 0.80f, b = 0.38f;
    return facing * ( a + b * s / fmaxf( t, 1e-3f ) );
}

// The back of a cloth is paler, so that the eye can follow folds and hems.
static wisp_vec3 cloth_colour( const surface* at )
{
    const wisp_vec3 pale = { 0.66f, 0.60f, 0.50f };
    return at->is_back && !at->is_painted ? rgb_mix( at->colour, pale, 0.55f ) : at->colour;
}

static wisp_vec3 shade_cloth( const stage* s, const trace_ray* ray, const surface* at, shade_sample sample )
{
    wisp_vec3 colour = cloth_colour( at );
    wisp_vec3 towards = light_key_direction( s, sample );
    float facing = wisp_v3_dot( at->normal, towards ), seen = clamp01( -wisp_v3_dot( at->normal, ray->direction ) );
    wisp_vec3 sky = sky_on( s, at, sample );
    wisp_vec3 sum = rgb_mul( colour, sky );
    if ( facing > 0.0f )
    {
        wisp_vec3 key = light_of_key( s, at->lifted, towards, INFINITY );
        float amount = rough_diffuse( facing, seen, -wisp_v3_dot( towards, ray->direction ) );
        sum = wisp_v3_add( sum, rgb_mul( colour, wisp_v3_scale( key, fmaxf( 0.0f, amount ) ) ) );
    }
    else
    {
        // The lamp is behind the cloth: the ray starts on the lit side, and a little of the light passes through.
        wisp_vec3 behind = wisp_v3_mul_add( at->place, -2.0f * s->lift, at->face );
        wisp_vec3 key = light_of_key( s, behind, towards, INFINITY );
        sum = wisp_v3_add( sum, rgb_mul( colour, wisp_v3_scale( key, -0.14f * facing ) ) );
    }
    // Fuzz: raised fibres shine at grazing angles.
    float rim = 1.0f - seen;
    float fuzz = 0.22f * rim * rim * rim;
    return wisp_v3_mul_add( sum, fuzz, rgb_mul( sky, rgb_mix( rgb_grey( 1.0f ), colour, 0.5f ) ) );
}

// Light enters latex and leaves elsewhere: the shadow's edge is soft and the far side glows. At the rim the skin is
// thicker along the view, so its colour is deeper there.
static wisp_vec3 shade_latex( const stage* s, const trace_ray* ray, const surface* at, shade_sample sample )
{
    wisp_vec3 towards = light_key_direction( s, sample );
    float facing = wisp_v3_dot( at->normal, towards ), seen = clamp01( -wisp_v3_dot( at->normal, ray->direction ) );
    float depth = 0.85f + 0.75f * ( 1.0f - seen ) * ( 1.0f - seen );
    wisp_vec3 colour = { powf( at->colour.x, depth ), powf( at->colour.y, depth ), powf( at->colour.z, depth ) };

    // What scatters inside the skin has no edge at the terminator, where flat triangles would show in a shadow.
    const float wrap = 0.45f;
    float scattered = clamp01( ( facing + wrap ) / ( 1.0f + wrap ) );
    float lit = clamp01( facing ) * clamp01( 0.4f + facing );
    wisp_vec3 key = light_of_key( s, at->lifted, towards, INFINITY );
    wisp_vec3 sum = rgb_mul( colour, wisp_v3_mul_add( sky_on( s, at, sample ), 0.75f * lit, key ) );
    float inside = light_key_strength * 0.30f * scattered * scattered + 0.10f * light_sky_strength;

    // Light from the lamp on the other side.
    float through = clamp01( 0.5f - 0.5f * facing );
    sum = wisp_v3_add( sum, rgb_mul( colour, wisp_v3_mul_add( rgb_grey( inside ), 0.20f * through, key ) ) );
    return wisp_v3_mul_add( sum, fminf( fresnel( 0.045f, seen ), 0.45f ), mirror( s, ray, at, 0.035f, sample ) );
}

// What a pane of glass adds to what is seen through it: a grey veil, and reflections at the rim.
static wisp_vec3 shade_glass( const stage* s, const trace_ray* ray, const surface* at, shade_sample sample )
{
    float seen = clamp01( -wisp_v3_dot( at->normal, ray->direction ) );
    wisp_vec3 veil = wisp_v3_scale( rgb_mul( at->colour, sky_on( s, at, sample ) ), 0.12f );
    return wisp_v3_mul_add( veil, 0.6f * fresnel( 0.04f, seen ), mirror( s, ray, at, 0.01f, sample ) );
}

// ---- strands ---------------------------------------------------------------------------------------------------

static float sine_to( wisp_vec3 tangent, wisp_vec3 direction )
{
    float cosine = wisp_v3_dot( tangent, direction );
    return sqrtf( fmaxf( 0.0f, 1.0f - cosine * cosine ) );
}

// A highlight of Kajiya and Kay 1989 whose tangent is tilted, as the scales of a hair tilt it.
static float strand_gloss( const surface* at, wisp_vec3 half, float tilt, float power )
{
    wisp_vec3 tilted = wisp_v3_normalize_or( wisp_v3_mul_add( at->tangent, tilt, at->normal ), at->tangent );
    return powf( sine_to( tilted, half ), power );
}

// Diffuse of Kajiya and Kay, and two highlights after Marschner et al. 2003 in the form of Scheuermann 2004: white
// light from the outside, tilted to the root, and light that went through the strand, coloured and tilted to the tip.
// Light behind the strand comes through it forwards.
static wisp_vec3 shade_strand( const stage* s, const trace_ray* ray, const surface* at, shade_sample sample )
{
    wisp_vec3 towards = light_key_direction( s, sample );
    wisp_vec3 start = wisp_v3_mul_add( at->place, 2.0f * at->radius + s->lift, towards );
    wisp_vec3 key = light_of_key( s, start, towards, INFINITY );
    wisp_vec3 half = wisp_v3_normalize_or( wisp_v3_sub( towards, ray->direction ), at->normal );

    float facing = wisp_v3_dot( at->normal, towards );
    float diffuse = sine_to( at->tangent, towards ) * ( 0.45f + 0.55f * clamp01( 0.5f + 0.5f * facing ) );
    float first = 0.22f * strand_gloss( at, half, -0.10f, 70.0f ) * clamp01( 0.3f + facing );
    float second = 1.30f * strand_gloss( at, half, 0.12f, 14.0f ) * clamp01( 0.4f + facing );
    float forward = clamp01( wisp_v3_dot( towards, ray->direction ) );
    float through = 1.2f * forward * forward * forward * forward;

    surface outer = *at;
    outer.lifted = wisp_v3_mul_add( at->place, 2.0f * at->radius + s->lift, at->normal );
    wisp_vec3 sum = rgb_mul( at->colour, wisp_v3_scale( sky_on( s, &outer, sample ), 1.15f ) );
    sum = wisp_v3_add( sum, rgb_mul( at->colour, wisp_v3_scale( key, 0.75f * diffuse + second + through ) ) );
    return wisp_v3_mul_add( sum, first, key );
}

wisp_vec3 shade_surface( const stage* s, const trace_ray* ray, const surface* at, shade_sample sample )
{
    if ( at->is_curve )
    {
        return shade_strand( s, ray, at, sample );
    }
    switch ( at->material )
    {
        case RENDER_CLOTH:
            return shade_cloth( s, ray, at, sample );
        case RENDER_LATEX:
            return shade_latex( s, ray, at, sample );
        case RENDER_GLASS:
            return shade_glass( s, ray, at, sample );
        case RENDER_SOLID:
            break;
    }
    return shade_solid( s, ray, at, sample );
}

// ---- ground ----------------------------------------------------------------------------------------------------

static float checker( const stage* s, wisp_vec3 place )
{
    float x = floorf( place.x / s->ground.square ), z = floorf( place.z / s->ground.square );
    return fmodf( fabsf( x + z ), 2.0f ) < 0.5f ? 1.0f : 0.95f;
}

// The fraction of all light that reaches a point of the ground.
static wisp_vec3 ground_fraction( const stage* s, wisp_vec3 place, shade_sample sample )
{
    wisp_vec3 up = { 0.0f, 1.0f, 0.0f }, start = wisp_v3_mul_add( place, s->lift, up );
    wisp_vec3 towards = light_key_direction( s, sample );
    float facing = clamp01( towards.y );
    wisp_vec3 key = wisp_v3_scale( light_of_key( s, start, towards, INFINITY ), facing );
    trace_ray out = { start, light_sky_direction( up, sample ), INFINITY };
    trace_hit hit;
    wisp_vec3 sky = rgb_grey( light_sky_strength );
    if ( light_find_opaque( s, &out, &hit ) )
    {
        sky = wisp_v3_scale( stage_colour( s, &hit ), 0.30f * light_sky_strength );
    }
    return wisp_v3_scale( wisp_v3_add( key, sky ), 1.0f / ( light_key_strength * facing + light_sky_strength ) );
}

// The ground has no colour of its own. It darkens the background by the light that bodies block, so it fades into the
// background without an edge.
wisp_vec3 shade_ground( const stage* s, const trace_ray* ray, float distance, wisp_vec3 background,
                        shade_sample sample )
{
    wisp_vec3 place = wisp_v3_mul_add( ray->origin, distance, ray->direction );
    place.y = s->ground.height;
    wisp_vec3 aside = wisp_v3_sub( place, s->middle );
    aside.y = 0.0f;
    float fraction = wisp_v3_length( aside ) / s->ground.visible;
    float shown = 1.0f - smooth_step( 0.25f, 1.0f, fraction );
    if ( shown <= 0.0f )
    {
        return background;
    }
    wisp_vec3 lit = wisp_v3_scale( ground_fraction( s, place, sample ), checker( s, place ) );
    return rgb_mix( background, rgb_mul( background, lit ), shown );
}
