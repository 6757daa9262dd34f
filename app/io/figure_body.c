// The body: a smooth union of round cones, some of them flattened; its skeleton; weights by distances and planes at joints.
#include "figure_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum part
{
    TORSO,
    HEAD,
    ARM, // left; the right one is its mirror image
    LEG,
    PARTS
} part;

// A round cone from a to b, made thinner by `thin` along a direction.
typedef struct cone
{
    part part;
    mesh_vector a, b;
    double radius_a, radius_b;
    mesh_vector across;
    double thin;
} cone;

#define X                                                                                                            \
    {                                                                                                                \
        1, 0, 0                                                                                                      \
    }
#define Y                                                                                                            \
    {                                                                                                                \
        0, 1, 0                                                                                                      \
    }
#define Z                                                                                                            \
    {                                                                                                                \
        0, 0, 1                                                                                                      \
    }
#define PALM                                                                                                         \
    {                                                                                                                \
        0.85, 0.527, 0                                                                                               \
    }

static const cone CONES[] = {
    { TORSO, { 0, 0.555, 0 }, { 0, 0.61, 0 }, 0.082, 0.068, Z, 0.76 },                // pelvis
    { TORSO, { -0.04, 0.517, -0.024 }, { 0.04, 0.517, -0.024 }, 0.046, 0.046, Z, 1 }, // buttocks
    { TORSO, { 0, 0.61, 0.002 }, { 0, 0.68, 0 }, 0.066, 0.071, Z, 0.76 },             // waist
    { TORSO, { 0, 0.68, 0.002 }, { 0, 0.75, 0.002 }, 0.073, 0.083, Z, 0.74 },         // ribs
    { TORSO, { -0.075, 0.787, -0.01 }, { 0.075, 0.787, -0.01 }, 0.036, 0.036, Z, 1 }, // shoulders
    { TORSO, { 0, 0.842, -0.014 }, { 0.085, 0.802, -0.01 }, 0.028, 0.026, Z, 1 },
    { TORSO, { 0, 0.842, -0.014 }, { -0.085, 0.802, -0.01 }, 0.028, 0.026, Z, 1 },
    { HEAD, { 0, 0.8, -0.012 }, { 0, 0.885, -0.002 }, 0.036, 0.032, Z, 1 },       // neck
    { HEAD, { 0, 0.942, -0.014 }, { 0, 0.944, 0.008 }, 0.0525, 0.0505, X, 0.84 }, // skull
    { HEAD, { 0, 0.93, 0.012 }, { 0, 0.895, 0.027 }, 0.045, 0.026, X, 0.92 },     // face
    { ARM, { 0.112, 0.786, -0.008 }, { 0.13, 0.755, -0.009 }, 0.038, 0.034, Z, 1 },
    { ARM, { 0.118, 0.78, -0.009 }, { 0.212, 0.647, -0.012 }, 0.034, 0.0255, Z, 1 },
    { ARM, { 0.212, 0.647, -0.012 }, { 0.235, 0.61, -0.006 }, 0.0255, 0.0275, Z, 1 },
    { ARM, { 0.235, 0.61, -0.006 }, { 0.29, 0.52, 0.006 }, 0.0275, 0.018, Z, 1 },
    { ARM, { 0.294, 0.513, 0.008 }, { 0.317, 0.474, 0.014 }, 0.019, 0.025, PALM, 0.58 },
    { ARM, { 0.319, 0.471, 0.015 }, { 0.338, 0.434, 0.022 }, 0.0235, 0.0145, PALM, 0.58 },
    { ARM, { 0.301, 0.498, 0.024 }, { 0.309, 0.468, 0.042 }, 0.0115, 0.0095, Z, 1 }, // thumb
    { LEG, { 0.056, 0.515, -0.002 }, { 0.073, 0.28, 0.003 }, 0.0575, 0.0335, Z, 1 },
    { LEG, { 0.073, 0.28, 0.003 }, { 0.079, 0.21, -0.012 }, 0.0335, 0.0335, Z, 1 },
    { LEG, { 0.079, 0.21, -0.012 }, { 0.088, 0.05, -0.014 }, 0.0335, 0.02, Z, 1 },
    { LEG, { 0.088, 0.026, -0.024 }, { 0.098, 0.021, 0.058 }, 0.0255, 0.0285, Y, 0.74 }, // foot
    { LEG, { 0.098, 0.0205, 0.058 }, { 0.101, 0.0155, 0.084 }, 0.0285, 0.021, Y, 0.72 },
    { LEG, { 0.088, 0.05, -0.012 }, { 0.098, 0.026, 0.052 }, 0.0215, 0.0175, Z, 1 },
};

static mesh_vector between( mesh_vector from, mesh_vector to )
{
    return ( mesh_vector ){ to.x - from.x, to.y - from.y, to.z - from.z };
}

static mesh_vector scaled( double s, mesh_vector v )
{
    return ( mesh_vector ){ s * v.x, s * v.y, s * v.z };
}

static mesh_vector mixed( double s, mesh_vector a, double t, mesh_vector b )
{
    return ( mesh_vector ){ s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z };
}

// Exact outside and inside: two spheres and the cone that touches both.
static figure_sample round_cone( const cone* c, double radius_a, double radius_b, mesh_vector p )
{
    const double squash = ( 1.0 / c->thin - 1.0 ) / mesh_dot( c->across, c->across );
    mesh_vector o = between( c->a, p );
    o = mixed( 1.0, o, squash * mesh_dot( o, c->across ), c->across );
    const mesh_vector axis = between( c->a, c->b );
    const double squared = mesh_dot( axis, axis ), length = sqrt( squared ), slope = ( radius_a - radius_b ) / length;
    const double cosine = sqrt( 1.0 - slope * slope ), y = mesh_dot( o, axis ) / length;
    const mesh_vector off = mixed( 1.0, o, -y / length, axis );
    const double x = sqrt( mesh_dot( off, off ) ),
                 foot = y - x * slope / cosine; // where the normal of the cone meets the axis
    figure_sample s;
    if ( foot > 0.0 && foot < length )
    {
        s.distance = x * cosine + y * slope - radius_a;
        s.gradient = mixed( x > 1e-12 ? cosine / x : 0.0, off, slope / length, axis );
    }
    else
    {
        const mesh_vector d = foot <= 0.0 ? o : mixed( 1.0, o, -1.0, axis );
        const double far = sqrt( mesh_dot( d, d ) );
        s.distance = far - ( foot <= 0.0 ? radius_a : radius_b );
        s.gradient = scaled( far > 1e-12 ? 1.0 / far : 0.0, d );
    }
    s.gradient = mixed( 1.0, s.gradient, squash * mesh_dot( s.gradient, c->across ), c->across );
    return s;
}

// The smaller of two distances, rounded where they differ by less than k.
static figure_sample smooth_union( figure_sample a, figure_sample b, double k )
{
    const figure_sample near = a.distance <= b.distance ? a : b, far = a.distance <= b.distance ? b : a;
    const double difference = far.distance - near.distance;
    const double h = difference < k ? 1.0 - difference / k : 0.0;
    return ( figure_sample ){ near.distance - 0.25 * k * h * h,
                              mixed( 1.0 - 0.5 * h, near.gradient, 0.5 * h, far.gradient ) };
}

// Distance from the box around a part; where it is larger than any rounding, the part itself does not matter.
static double box_distance( part wanted, double least, mesh_vector p )
{
    static const double boxes[PARTS][6] = { // lower, upper
                                            { -0.12, 0.465, -0.1, 0.12, 0.87, 0.09 },
                                            { -0.05, 0.76, -0.075, 0.05, 1.0, 0.07 },
                                            { 0.07, 0.41, -0.05, 0.36, 0.83, 0.06 },
                                            { -0.005, -0.005, -0.065, 0.135, 0.58, 0.115 }
    };
    const double* box = boxes[wanted];
    const double at[3] = { p.x, p.y, p.z };
    double most = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        const double outside = fmax( box[k] - at[k], at[k] - box[k + 3] ) - 2.0 * least;
        most = outside > most ? outside : most;
    }
    return most;
}

static figure_sample sample_part( part wanted, double least, mesh_vector p )
{
    static const double rounding[PARTS] = { 0.05, 0.04, 0.008, 0.008 };
    const double box = box_distance( wanted, least, p );
    if ( box > 0.06 )
    {
        return ( figure_sample ){ box, { 0.0, 0.0, 0.0 } };
    }
    figure_sample sum = { 10.0, { 0.0, 0.0, 0.0 } };
    for ( int i = 0; i < WISP_COUNT( CONES ); ++i )
    {
        const cone* c = &CONES[i];
        if ( c->part == wanted )
        {
            // thin parts grow with the cubes, so that no cube loses them
            const double a = c->radius_a * c->thin < least ? least / c->thin : c->radius_a,
                         b = c->radius_b * c->thin < least ? least / c->thin : c->radius_b;
            sum = smooth_union( sum, round_cone( c, a, b, p ), rounding[wanted] );
        }
    }
    return sum;
}

static figure_sample sample_right( part wanted, double least, mesh_vector p )
{
    figure_sample s = sample_part( wanted, least, ( mesh_vector ){ -p.x, p.y, p.z } );
    s.gradient.x = -s.gradient.x;
    return s;
}

figure_sample figure_body( const void* context, mesh_vector p )
{
    const double least = *(const double*)context;
    const figure_sample legs = smooth_union( sample_part( LEG, least, p ), sample_right( LEG, least, p ), 0.006 );
    figure_sample body = smooth_union( sample_part( TORSO, least, p ), sample_part( HEAD, least, p ), 0.03 );
    body = smooth_union( body, sample_part( ARM, least, p ), 0.03 );
    body = smooth_union( body, sample_right( ARM, least, p ), 0.03 );
    return smooth_union( body, legs, 0.03 );
}

// ---- skeleton ----

enum
{
    HIPS,
    SPINE,
    CHEST,
    NECK,
    SKULL,
    SHOULDER, // left; the right one follows the hand
    UPPER_ARM,
    FOREARM,
    HAND,
    RIGHT_SHOULDER,
    THIGH = RIGHT_SHOULDER + 4,
    SHIN,
    FOOT,
    RIGHT_THIGH,
    JOINTS = RIGHT_THIGH + 3,
};

static const struct
{
    const char* name;
    int parent;
    mesh_vector at;
} RIG[JOINTS] = {
    { "hips", -1, { 0, 0.53, 0 } },
    { "spine", HIPS, { 0, 0.595, -0.004 } },
    { "chest", SPINE, { 0, 0.68, -0.006 } },
    { "neck", CHEST, { 0, 0.835, -0.012 } },
    { "head", NECK, { 0, 0.882, -0.002 } },
    { "left_shoulder", CHEST, { 0.025, 0.795, -0.006 } },
    { "left_upper_arm", SHOULDER, { 0.112, 0.786, -0.008 } },
    { "left_forearm", UPPER_ARM, { 0.212, 0.647, -0.012 } },
    { "left_hand", FOREARM, { 0.29, 0.52, 0.006 } },
    { "right_shoulder", CHEST, { -0.025, 0.795, -0.006 } },
    { "right_upper_arm", RIGHT_SHOULDER, { -0.112, 0.786, -0.008 } },
    { "right_forearm", RIGHT_SHOULDER + 1, { -0.212, 0.647, -0.012 } },
    { "right_hand", RIGHT_SHOULDER + 2, { -0.29, 0.52, 0.006 } },
    { "left_thigh", HIPS, { 0.056, 0.515, -0.002 } },
    { "left_shin", THIGH, { 0.073, 0.28, 0.003 } },
    { "left_foot", SHIN, { 0.088, 0.05, -0.012 } },
    { "right_thigh", HIPS, { -0.056, 0.515, -0.002 } },
    { "right_shin", RIGHT_THIGH, { -0.073, 0.28, 0.003 } },
    { "right_foot", RIGHT_THIGH + 1, { -0.088, 0.05, -0.012 } },
};

wisp_status wisp_figure_skeleton( float height, wisp_skeleton* out, wisp_error* error )
{
    *out = ( wisp_skeleton ){ JOINTS, calloc( JOINTS, sizeof( wisp_joint ) ) };
    bool done = out->joints != NULL;
    out->joint_count = done ? JOINTS : 0;
    for ( int j = 0; j < JOINTS && done; ++j )
    {
        wisp_joint* joint = &out->joints[j];
        const mesh_vector none = { 0 }, at = RIG[j].at, from = RIG[j].parent < 0 ? none : RIG[RIG[j].parent].at;
        const double h = (double)height;
        joint->name = strdup( RIG[j].name );
        joint->parent = RIG[j].parent;
        joint->rest = ( wisp_joint_transform ){ .rotation = { 0.0f, 0.0f, 0.0f, 1.0f },
                                                .translation = { (float)( h * ( at.x - from.x ) ),
                                                                 (float)( h * ( at.y - from.y ) ),
                                                                 (float)( h * ( at.z - from.z ) ) },
                                                .scale = { 1.0f, 1.0f, 1.0f } };
        joint->inverse_bind = wisp_affine_identity();
        joint->inverse_bind.m[0][3] = (float)( -h * at.x );
        joint->inverse_bind.m[1][3] = (float)( -h * at.y );
        joint->inverse_bind.m[2][3] = (float)( -h * at.z );
        done = joint->name != NULL;
    }
    if ( !done )
    {
        wisp_skeleton_release( out );
        return wisp_fail( error, WISP_NO_MEMORY, "figure: out of memory for a skeleton" );
    }
    return WISP_OK;
}

// ---- weights ----

// From 0 at `from` to 1 at `to`.
static double ramp( double x, double from, double to )
{
    const double s = ( x - from ) / ( to - from ), t = s < 0.0 ? 0.0 : s > 1.0 ? 1.0 : s;
    return t * t * ( 3.0 - 2.0 * t );
}

// Signed distance from the plane through a joint that halves the angle between the bones before and after it.
static double beyond( mesh_vector p, mesh_vector before, mesh_vector joint, mesh_vector after )
{
    const mesh_vector a = between( before, joint ), b = between( joint, after );
    const mesh_vector n = mixed( 1.0 / sqrt( mesh_dot( a, a ) ), a, 1.0 / sqrt( mesh_dot( b, b ) ), b );
    return mesh_dot( between( joint, p ), n ) / sqrt( mesh_dot( n, n ) );
}

// Shares of a limb among its three bones.
static void share_limb( double* weights, int first, double share, double second, double third )
{
    weights[first] += share * ( 1.0 - second );
    weights[first + 1] += share * second * ( 1.0 - third );
    weights[first + 2] += share * second * third;
}

static void weigh( mesh_vector p, double weights[JOINTS] )
{
    const bool left = p.x >= 0.0;
    const mesh_vector q = { fabs( p.x ), p.y, p.z }, tip = { 0.338, 0.434, 0.022 }, toe = { 0.094, 0.0, 0.02 };
    const double torso = sample_part( TORSO, 0.0, p ).distance, arm_distance = sample_part( ARM, 0.0, q ).distance,
                 leg_distance = sample_part( LEG, 0.0, q ).distance, other_leg = sample_right( LEG, 0.0, q ).distance;

    // limbs, where their own cones are nearer than others; far from a part there are only distances from boxes, which may be shorter
    const double arm = ramp( torso - arm_distance, -0.006, 0.03 ) * ramp( leg_distance - arm_distance, 0.0, 0.02 );
    const double leg = ramp( torso - leg_distance, -0.012, 0.03 ) * ramp( other_leg - leg_distance, 0.0, 0.01 ) *
                       ramp( arm_distance - leg_distance, 0.0, 0.02 );
    const double elbow = ramp( beyond( q, RIG[UPPER_ARM].at, RIG[FOREARM].at, RIG[HAND].at ), -0.028, 0.028 );
    const double wrist = ramp( beyond( q, RIG[FOREARM].at, RIG[HAND].at, tip ), -0.018, 0.018 );
    const double knee = ramp( beyond( q, RIG[THIGH].at, RIG[SHIN].at, RIG[FOOT].at ), -0.036, 0.036 );
    const double ankle = ramp( beyond( q, RIG[SHIN].at, RIG[FOOT].at, toe ), -0.02, 0.02 );
    share_limb( weights, left ? UPPER_ARM : RIGHT_SHOULDER + 1, arm, elbow, wrist );
    share_limb( weights, left ? THIGH : RIGHT_THIGH, leg, knee, ankle );

    // the rest along the spine, by height; the chin belongs to the head
    const double rest = 1.0 - arm - leg > 0.0 ? 1.0 - arm - leg : 0.0;
    const double spine = ramp( p.y, 0.555, 0.635 ), chest = ramp( p.y, 0.64, 0.72 ),
                 neck = ramp( p.y, 0.805, 0.86 ) *
                        ( 1.0 - ramp( q.x, 0.035, 0.07 ) * ( 1.0 - ramp( p.y, 0.86, 0.885 ) ) ),
                 head = ramp( p.y + 0.6 * p.z, 0.862, 0.9 ),
                 shoulder = ramp( q.x, 0.025, 0.085 ) * ramp( p.y, 0.745, 0.8 );
    const double upper = rest * spine * chest;
    weights[HIPS] += rest * ( 1.0 - spine );
    weights[SPINE] += rest * spine * ( 1.0 - chest );
    weights[CHEST] += upper * ( 1.0 - neck ) * ( 1.0 - shoulder );
    weights[left ? SHOULDER : RIGHT_SHOULDER] += upper * ( 1.0 - neck ) * shoulder;
    weights[NECK] += upper * neck * ( 1.0 - head );
    weights[SKULL] += upper * neck * head;
}

void figure_weights( mesh_vector p, int32_t joints[4], float weights[4] )
{
    double all[JOINTS] = { 0.0 }, sum = 0.0;
    weigh( p, all );
    for ( int k = 0; k < 4; ++k )
    {
        int largest = 0;
        for ( int j = 1; j < JOINTS; ++j )
        {
            largest = all[j] > all[largest] ? j : largest;
        }
        joints[k] = largest;
        weights[k] = (float)all[largest];
        sum += all[largest];
        all[largest] = 0.0;
    }
    for ( int k = 0; k < 4; ++k )
    {
        weights[k] = (float)( (double)weights[k] / sum );
    }
}
