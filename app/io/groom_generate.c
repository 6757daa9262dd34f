// Procedural grooms. Only + - * /, square roots, the engine's own sine and counter-based random numbers: the same
// definition gives the same bits with every compiler and C library.
#include "groom_internal.h"

#include <math.h>

#include "trig.h"
#include "wisp/module/definition.h"
#include "wisp/module/random.h"

static const float TWO_PI = 6.28318531f;
static const double GOLDEN_TURN = 0.38196601125010515; // turns from one root to the next: (3 - sqrt 5) / 2

// Hair grows on the cap above this height, in scalp radii: a little more than ten degrees above the equator.
static const double CAP_HEIGHT = 0.2;

// A strand has bent from its root's normal to straight down after this many scalp radii.
static const float BEND_LENGTH = 0.6f;

// The fraction of a turn by which neighbours differ: waves of one head of hair are in phase, curls are not.
static const float WAVE_PHASES = 0.25f;
static const float CURL_PHASES = 1.0f;

static const float MAX_WAVES = 10000.0f;

enum
{
    RANDOM_STREAM = 0x67726f6f, // any number that no other stream of the program uses
    DRAW_LENGTH = 0,
    DRAW_PHASE = 1,
};

wisp_groom_generator wisp_default_groom_generator( wisp_groom_shape shape, int dimension )
{
    bool curly = shape == WISP_GROOM_CURLY;
    return ( wisp_groom_generator ){
        .shape = shape,
        .dimension = dimension,
        .strand_count = dimension == 2 ? 64 : 2000,
        .vertices_per_strand = curly ? 64 : 24,
        .length = 0.25f,
        .spacing = 0.002f,
        .scalp_radius = 0.1f,
        .wave_amplitude = curly ? 0.008f : 0.006f,
        .wave_length = curly ? 0.04f : 0.07f,
        .length_variation = 0.08f,
        .thickness = 8e-5f,
        .seed = 1,
    };
}

// ---- checks ----------------------------------------------------------------------------------------------------

static wisp_status check_counts( const wisp_groom_generator* r, wisp_error* error )
{
    if ( (int)r->shape < WISP_GROOM_STRAIGHT || (int)r->shape > WISP_GROOM_RING )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "groom generator: shape: got %d, expected straight, wavy, curly or ring", (int)r->shape );
    }
    if ( r->shape == WISP_GROOM_RING && r->vertices_per_strand < 4 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "groom generator: got rings of %d vertices, expected at least 4",
                          r->vertices_per_strand );
    }
    if ( r->dimension != 2 && r->dimension != 3 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "groom generator: dimension: got %d, expected 2 or 3",
                          r->dimension );
    }
    if ( r->strand_count < 1 || r->vertices_per_strand < 2 )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "groom generator: got %d strands of %d vertices, expected at least 1 strand of 2 vertices",
                          r->strand_count, r->vertices_per_strand );
    }
    if ( (int64_t)r->strand_count * r->vertices_per_strand > WISP_GROOM_MAX_GENERATED )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "groom generator: got %d strands of %d vertices, expected at most %d vertices in all",
                          r->strand_count, r->vertices_per_strand, WISP_GROOM_MAX_GENERATED );
    }
    return WISP_OK;
}

static wisp_status check_values( const wisp_groom_generator* r, wisp_error* error )
{
    bool flat = r->dimension == 2;
    bool waves = r->shape == WISP_GROOM_WAVY || r->shape == WISP_GROOM_CURLY;
    const struct
    {
        const char* name;
        bool used;
        float value, least, most;
    } values[] = {
        { "length", true, r->length, 1e-6f, WISP_GROOM_MAX_COORDINATE },
        { "length variation", true, r->length_variation, 0.0f, 0.99f },
        { "thickness", true, r->thickness, 0.0f, WISP_GROOM_MAX_COORDINATE },
        { "spacing", flat, r->spacing, 0.0f, WISP_GROOM_MAX_COORDINATE },
        { "scalp radius", !flat, r->scalp_radius, 1e-6f, WISP_GROOM_MAX_COORDINATE },
        { "wave amplitude", waves, r->wave_amplitude, 0.0f, WISP_GROOM_MAX_COORDINATE },
        { "wave length", waves, r->wave_length, r->length / MAX_WAVES, WISP_GROOM_MAX_COORDINATE },
    };
    for ( int i = 0; i < WISP_COUNT( values ); ++i )
    {
        // Written so that NaN fails.
        if ( values[i].used && !( values[i].value >= values[i].least && values[i].value <= values[i].most ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "groom generator: %s: got %g, expected %g .. %g", values[i].name,
                              (double)values[i].value, (double)values[i].least, (double)values[i].most );
        }
    }
    double reach = (double)r->length * ( 1.0 + (double)r->length_variation );
    reach += flat ? 0.5 * (double)r->spacing * r->strand_count : (double)r->scalp_radius;
    reach += waves ? 2.0 * (double)r->wave_amplitude : 0.0;
    if ( reach > (double)WISP_GROOM_MAX_COORDINATE )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "groom generator: strands reach %g m from the origin, expected at most %g m", reach,
                          (double)WISP_GROOM_MAX_COORDINATE );
    }
    return WISP_OK;
}

// ---- a strand --------------------------------------------------------------------------------------------------

// Data of a single strand.
typedef struct strand_draw
{
    float length; // m
    float phase;  // turns
} strand_draw;

static strand_draw draw_strand( const wisp_groom_generator* r, wisp_random_key key, int s )
{
    float u = wisp_random_unit_float( key, (uint32_t)s, DRAW_LENGTH, 0 );
    float w = wisp_random_unit_float( key, (uint32_t)s, DRAW_PHASE, 0 );
    return ( strand_draw ){
        .length = r->length * ( 1.0f + r->length_variation * ( 2.0f * u - 1.0f ) ),
        .phase = w * ( r->shape == WISP_GROOM_CURLY ? CURL_PHASES : WAVE_PHASES ),
    };
}

// Offset from the centre line at arc length t: sideways, and away from the head.
typedef struct wave_offset
{
    float aside, away; // m
} wave_offset;

// Waves swell over the first wave length, so that a root stays where it is whatever the phase.
static wave_offset wave_at( const wisp_groom_generator* r, const strand_draw* draw, float t )
{
    wave_offset offset = { 0.0f, 0.0f };
    if ( r->shape == WISP_GROOM_STRAIGHT || r->shape == WISP_GROOM_RING )
    {
        return offset;
    }
    float waves = t / r->wave_length;
    float amplitude = r->wave_amplitude * ( waves < 1.0f ? waves : 1.0f );
    float turns = waves + draw->phase;
    float sine, cosine;
    trig_sincos( TWO_PI * ( turns - floorf( turns ) ), &sine, &cosine );
    offset.aside = amplitude * sine;
    if ( r->shape == WISP_GROOM_CURLY )
    {
        // Never towards the head: a curl touches its centre line and bulges outwards.
        offset.away = amplitude * ( 1.0f - cosine );
    }
    return offset;
}

// A vertex of a ring: aside, and away from the root, where the ring touches the line through it. The segments of a strand are as
// long as it is in all.
static wave_offset ring_at( const wisp_groom_generator* r, const strand_draw* draw, int k )
{
    int segments = r->vertices_per_strand - 1;
    float sine, cosine, half_sine, half_cosine;
    trig_sincos( TWO_PI * 0.5f / (float)segments, &half_sine, &half_cosine );
    trig_sincos( TWO_PI * ( (float)( k % segments ) / (float)segments ), &sine, &cosine );
    float radius = 0.5f * draw->length / ( (float)segments * half_sine );
    return ( wave_offset ){ radius * sine, radius * ( 1.0f - cosine ) };
}

static void make_flat_strand( const wisp_groom_generator* r, const strand_draw* draw, int s, wisp_vec3* points )
{
    float root = (float)( ( s - 0.5 * ( r->strand_count - 1 ) ) * (double)r->spacing );
    for ( int k = 0; k < r->vertices_per_strand; ++k )
    {
        float t = draw->length * ( (float)k / (float)( r->vertices_per_strand - 1 ) );
        if ( r->shape == WISP_GROOM_RING )
        {
            wave_offset ring = ring_at( r, draw, k );
            points[k] = ( wisp_vec3 ){ root + ring.aside, 0.0f - ring.away, 0.0f };
            continue;
        }
        wave_offset offset = wave_at( r, draw, t );
        // In the plane there is no direction away from the head: a curl runs ahead and returns, a cycloid.
        points[k] = ( wisp_vec3 ){ root + offset.aside, 0.0f - t - offset.away, 0.0f };
    }
}

// The half plane that holds the axis of the head and a root. A strand's centre line never leaves it.
typedef struct meridian
{
    float out, up; // m, or a direction
} meridian;

static meridian normalised( meridian v )
{
    float length = sqrtf( v.out * v.out + v.up * v.up );
    return ( meridian ){ v.out / length, v.up / length };
}

// Whether a step from `place` comes closer to the centre of the head than the scalp: the nearest point of the
// segment, not only its end, because a long segment can cut through and come out again.
static bool enters_scalp( float scalp_radius, meridian place, meridian direction, float step )
{
    float nearest = -( place.out * direction.out + place.up * direction.up );
    nearest = nearest < 0.0f ? 0.0f : nearest < step ? nearest : step;
    float out = place.out + nearest * direction.out;
    float up = place.up + nearest * direction.up;
    return nearest > 0.0f && out * out + up * up < scalp_radius * scalp_radius;
}

// Direction of the centre line at `place`, t from the root: from the root's normal over outwards to down. The outward
// direction keeps the strand of the crown from turning back into itself. Where the direction leads into the scalp it
// follows a tangent instead, outwards and down.
static meridian heading( const wisp_groom_generator* r, meridian normal, meridian place, float t, float step )
{
    float bend = t / ( BEND_LENGTH * r->scalp_radius );
    bend = bend < 1.0f ? bend : 1.0f;
    float w = bend * bend * ( 3.0f - 2.0f * bend );
    meridian request = normalised( ( meridian ){
        .out = ( 1.0f - w ) * normal.out + 2.0f * w * ( 1.0f - w ),
        .up = ( 1.0f - w ) * normal.up - w,
    } );
    if ( enters_scalp( r->scalp_radius, place, request, step ) )
    {
        meridian away = normalised( place );
        return ( meridian ){ away.up, -away.out };
    }
    return request;
}

static void make_round_strand( const wisp_groom_generator* r, const strand_draw* draw, int s, wisp_vec3* points )
{
    // Fibonacci lattice: equal areas along the axis, a golden part of a turn around it.
    double height = 1.0 - ( s + 0.5 ) / r->strand_count * ( 1.0 - CAP_HEIGHT );
    double turns = s * GOLDEN_TURN;
    float east, north;
    trig_sincos( TWO_PI * (float)( turns - floor( turns ) ), &north, &east );
    meridian normal = { (float)sqrt( 1.0 - height * height ), (float)height };

    meridian place = { r->scalp_radius * normal.out, r->scalp_radius * normal.up };
    for ( int k = 0; r->shape == WISP_GROOM_RING && k < r->vertices_per_strand; ++k )
    {
        wave_offset ring = ring_at( r, draw, k );
        float out = place.out + normal.out * ring.away;
        points[k] = ( wisp_vec3 ){ out * east - ring.aside * north, place.up + normal.up * ring.away,
                                   out * north + ring.aside * east };
    }
    if ( r->shape == WISP_GROOM_RING )
    {
        return;
    }
    meridian ahead = normal;
    float step = draw->length / (float)( r->vertices_per_strand - 1 );
    for ( int k = 0; k < r->vertices_per_strand; ++k )
    {
        wave_offset offset = wave_at( r, draw, (float)k * step );
        float out = place.out - ahead.up * offset.away;
        float up = place.up + ahead.out * offset.away;
        points[k] = ( wisp_vec3 ){ out * east - offset.aside * north, up, out * north + offset.aside * east };

        ahead = heading( r, normal, place, ( (float)k + 0.5f ) * step, step );
        place.out += step * ahead.out;
        place.up += step * ahead.up;
    }
}

wisp_status wisp_groom_generate( const wisp_groom_generator* generator, wisp_groom* out, wisp_error* error )
{
    *out = ( wisp_groom ){ 0 };
    WISP_TRY( check_counts( generator, error ) );
    WISP_TRY( check_values( generator, error ) );
    WISP_TRY( groom_allocate( out, generator->strand_count, generator->strand_count * generator->vertices_per_strand,
                              generator->thickness > 0.0f ? GROOM_THICKNESS : 0, "groom generator", error ) );
    wisp_random_key key = wisp_random_make_key( generator->seed, RANDOM_STREAM, 0 );
    for ( int s = 0; s < generator->strand_count; ++s )
    {
        strand_draw draw = draw_strand( generator, key, s );
        out->offsets[s] = s * generator->vertices_per_strand;
        wisp_vec3* points = out->points + out->offsets[s];
        if ( generator->dimension == 2 )
        {
            make_flat_strand( generator, &draw, s, points );
        }
        else
        {
            make_round_strand( generator, &draw, s, points );
        }
    }
    out->offsets[generator->strand_count] = out->vertex_count;
    out->dimension = generator->dimension;
    for ( int v = 0; out->thickness != NULL && v < out->vertex_count; ++v )
    {
        out->thickness[v] = generator->thickness;
    }
    return WISP_OK;
}
