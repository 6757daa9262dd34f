// Strands in double precision by their oracle: one that falls from the horizontal, and those on a shaken head.
#include "accuracy_references.h"
#include "converge.h"

#include "accuracy/strands_guides.h"
#include "accuracy/strands_swing.h"
#include "oracle/strand_oracle.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum
{
    SWING_SUBSTEPS = 20480, // of each 1/60 s
    GUIDES_SUBSTEPS = 640,
    GUIDES_PASSES = 8, // of Newton, as the engine's limit
};

#define SWING_TOLERANCE 1e-5 // m
#define GUIDES_TOLERANCE 1e-4

static double3 widen( wisp_vec3 p )
{
    return double3_make( (double)p.x, (double)p.y, (double)p.z );
}

// ---- a fall ----

static wisp_status fall( void* context, int substeps, double* numbers, wisp_error* error )
{
    (void)context;
    (void)error;
    strand_oracle strand;
    double3 points[STRANDS_VERTICES];
    for ( int v = 0; v < STRANDS_VERTICES; ++v )
    {
        points[v] = double3_make( (double)STRANDS_SPACING * v, 0.0, 0.0 );
    }
    strand_oracle_shape( &strand, points, STRANDS_VERTICES );
    strand_oracle_weigh( &strand, (double)wisp_default_strand_dynamics_def().line_density, true );
    const strand_oracle_settings settings = strand_oracle_default_settings( (double)STRANDS_STEP / substeps );
    for ( int s = 0; s < STRANDS_REFERENCE_STEPS * substeps; ++s )
    {
        strand_oracle_substep( &strand, &settings, NULL );
    }
    for ( int v = 0; v < STRANDS_VERTICES; ++v )
    {
        numbers[2 * v] = strand.position[v].x;
        numbers[2 * v + 1] = strand.position[v].y;
    }
    return WISP_OK;
}

wisp_status reference_of_strands_swing( accuracy_reference* out, wisp_error* error )
{
    *out = strands_swing_reference();
    const converge_plan plan = { .run = fall,
                                 .unit = "substeps",
                                 .substeps = SWING_SUBSTEPS,
                                 .compared = out->number_count,
                                 .dimension = 2,
                                 .converging = out->number_count,
                                 .tolerance = SWING_TOLERANCE };
    snprintf( out->reference, sizeof( out->reference ),
              "the direct solve in double precision, all vertices of strands of %.2f m after %.2f s",
              (double)STRANDS_SPACING * ( STRANDS_VERTICES - 1 ), STRANDS_REFERENCE_STEPS * (double)STRANDS_STEP );
    snprintf( out->solver, sizeof( out->solver ),
              "lengths by Newton's method, directly (tests/oracle/strand_oracle.h); substeps are of 1/60 s" );
    snprintf( out->precision, sizeof( out->precision ), "double" );
    snprintf( out->layout, sizeof( out->layout ), "float64 [%d vertices][along, up], m, of one strand",
              STRANDS_VERTICES );
    return converge( &plan, out, error );
}

// ---- a shaken head ----

typedef struct head_pose
{
    strand_oracle_quaternion rotation;
    double3 place;
} head_pose;

// Between the poses of two steps the engine's head moves in a straight line, and along the chord from one quaternion
// to the other.
static head_pose pose_between( wisp_transform from, wisp_transform to, double fraction )
{
    const wisp_quat a = from.rotation, b = to.rotation;
    const double s = 1.0 - fraction;
    strand_oracle_quaternion q = { s * (double)a.x + fraction * (double)b.x, s * (double)a.y + fraction * (double)b.y,
                                   s * (double)a.z + fraction * (double)b.z,
                                   s * (double)a.w + fraction * (double)b.w };
    const double length = sqrt( q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w );
    q = ( strand_oracle_quaternion ){ q.x / length, q.y / length, q.z / length, q.w / length };
    return ( head_pose ){ q, double3_add( double3_scale( s, widen( from.translation ) ),
                                          double3_scale( fraction, widen( to.translation ) ) ) };
}

/// A strand at rest in balance, as the engine's are.
typedef struct balanced_strand
{
    strand_oracle strand;
    double3 root;                      // at rest
    double tension[MAX_STRAND_ORACLE]; // in balance
    double3 gravity;
} balanced_strand;

static void grow( const wisp_vec3* points, balanced_strand* out )
{
    const wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    double3 wide[SHAKE_VERTICES];
    for ( int v = 0; v < SHAKE_VERTICES; ++v )
    {
        wide[v] = widen( points[v] );
    }
    out->root = wide[0];
    out->gravity = widen( def.gravity );
    strand_oracle_shape( &out->strand, wide, SHAKE_VERTICES );
    strand_oracle_weigh( &out->strand, (double)def.line_density, true );
    strand_oracle_stiffen( &out->strand, (double)def.bend_rigidity, (double)def.twist_rigidity, def.clamped, 0.0 );
    strand_oracle_balance( &out->strand, out->gravity );
    memcpy( out->tension, out->strand.tension, sizeof( out->tension ) );
}

static void go_on( balanced_strand* own, head_pose pose, double dt )
{
    strand_oracle* strand = &own->strand;
    const double3 root = double3_add( pose.place, strand_oracle_turned( pose.rotation, own->root ) );
    strand_oracle_predict( strand, &root, own->gravity, dt );
    memcpy( strand->tension, own->tension, sizeof( own->tension ) );
    strand->turn = pose.rotation;
    strand_oracle_rod_factor( strand, 0.0, dt );
    strand_oracle_rod( strand, 0.0, dt, &own->gravity );
    (void)strand_oracle_stretch( strand, STRAND_ORACLE_SQUARE, GUIDES_PASSES, INFINITY, true, dt );
    strand_oracle_velocity( strand, dt );
}

static void shake( balanced_strand* own, int number, int substeps, double* numbers )
{
    wisp_transform from = hair_head_pose( 0.0 );
    for ( int step = 1; step <= SHAKE_STEPS; ++step )
    {
        const wisp_transform to = hair_head_pose( (double)STRANDS_STEP * step );
        for ( int s = 1; s <= substeps; ++s )
        {
            go_on( own, pose_between( from, to, (double)s / substeps ), (double)STRANDS_STEP / substeps );
        }
        from = to;
        for ( int i = 0; i < SHAKE_SEEN_VERTICES && step % SHAKE_OBSERVATION == 0; ++i )
        {
            const int place = number * SHAKE_SEEN_VERTICES + i;
            const double3 p = own->strand.position[shake_seen_vertex( place ) % SHAKE_VERTICES];
            double* observation =
                numbers + 3 * ( ( step / SHAKE_OBSERVATION - 1 ) * SHAKE_SEEN * SHAKE_SEEN_VERTICES + place );
            observation[0] = p.x;
            observation[1] = p.y;
            observation[2] = p.z;
        }
    }
}

static wisp_status shake_all( void* context, int substeps, double* numbers, wisp_error* error )
{
    (void)error;
    const strands_shape* hair = context;
    for ( int n = 0; n < SHAKE_SEEN; ++n )
    {
        balanced_strand own;
        grow( hair->points + (size_t)( SHAKE_STRIDE * n * SHAKE_VERTICES ), &own );
        shake( &own, n, substeps, numbers );
    }
    return WISP_OK;
}

wisp_status reference_of_strands_guides( accuracy_reference* out, wisp_error* error )
{
    strands_shape hair = { 0 };
    wisp_status status = shake_make_hair( &hair, error );
    if ( status == WISP_OK )
    {
        *out = strands_guides_reference( &hair );
        const converge_plan plan = { .run = shake_all,
                                     .context = &hair,
                                     .unit = "substeps",
                                     .substeps = GUIDES_SUBSTEPS,
                                     .compared = out->number_count,
                                     .dimension = 3,
                                     .converging = out->number_count,
                                     .tolerance = GUIDES_TOLERANCE };
        snprintf( out->reference, sizeof( out->reference ),
                  "all strands simulated in double precision, every second vertex of %d of %d strands at %d "
                  "observations at "
                  "a shaken head",
                  SHAKE_SEEN, hair.strand_count, SHAKE_OBSERVATIONS );
        snprintf( out->solver, sizeof( out->solver ),
                  "balanced rods, lengths by Newton's method, directly (tests/oracle/strand_oracle.h); substeps are "
                  "of 1/60 s" );
        snprintf( out->precision, sizeof( out->precision ), "double" );
        snprintf( out->layout, sizeof( out->layout ),
                  "float64 [%d observations][%d strands, every fifth][%d vertices, every second][x, y, z], m",
                  SHAKE_OBSERVATIONS, SHAKE_SEEN, SHAKE_SEEN_VERTICES );
        status = converge( &plan, out, error );
    }
    strands_shape_free( &hair );
    return status;
}
