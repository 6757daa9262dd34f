// The nine known failures of other engines, each stated not to happen here: cells that compare several runs of a
// cloth.
#include "stability_cloth.h"

#include "collision/collision.h"
#include "wisp/module/components.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const stability_axes usual = { STABILITY_START_REST, STABILITY_FRAME, 1.0f, 0.0f, 1.0f };

/// The compared values of a run.
typedef struct report
{
    double lowest; // m, of the vertices, from the point of suspension
    double strain;
    stability_outcome outcome;
} report;

typedef struct setup
{
    stability_cloth_plan plan;
    stability_axes axes;
    wisp_status ( *dress )( stability_surface* surface ); // additional to the plan; may be null
    double seconds;                                       // 0: the usual
} setup;

static setup setup_of( int way )
{
    return ( setup ){ .plan = stability_default_cloth_plan( way ), .axes = usual };
}

// Final positions are read before the trial is closed, instead of its hash.
static report* reading;

static uint64_t read_end( void* context )
{
    stability_surface* s = context;
    reading->lowest = INFINITY;
    for ( int i = 0; i < s->fabric->vertex_count; ++i )
    {
        reading->lowest = fmin( reading->lowest, (double)s->seen[i].y - (double)s->start[0].y );
    }
    return stability_surface_hash( s );
}

static wisp_status run_setup( const setup* one, int workers, report* out, wisp_error* error )
{
    stability_surface* s;
    wisp_status status = stability_cloth_enter( &one->plan, &one->axes, workers, &s, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    stability_trial trial = stability_surface_trial( s, &one->axes );
    status = one->dress != NULL ? one->dress( s ) : WISP_OK;
    if ( status != WISP_OK )
    {
        bench_world_fail( s->implementation.world, status, error );
        stability_surface_close( s );
        return status;
    }
    trial.frame_count =
        one->seconds > 0.0 ? stability_frames( one->seconds, (double)one->axes.seconds ) : trial.frame_count;
    // a coordinate that far out is rounded by this much, which limits the resolution of speeds
    trial.limits.jitter = fmax( trial.limits.jitter, 8.0 * (double)FLT_EPSILON * fabs( (double)one->plan.at.x ) *
                                                         one->plan.substeps / (double)one->axes.seconds );
    trial.hash = read_end;
    reading = out;
    status = stability_run( &trial, &out->outcome, error );
    out->strain = out->outcome.score.last.strain;
    return status;
}

// All runs; the cell has the worst of their verdicts. @param count of the runs, at most 4
static wisp_status run_all( const setup* setups, int count, int workers, report* reports, stability_outcome* out,
                            wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        status = run_setup( setups + i, workers, reports + i, error );
        if ( i == 0 || out->verdict.broke == STABILITY_LIMIT_NONE )
        {
            *out = reports[i].outcome;
        }
    }
    return status;
}

static double spread( const report* reports, int count )
{
    double lower = INFINITY, upper = -INFINITY;
    for ( int i = 0; i < count; ++i )
    {
        lower = fmin( lower, reports[i].lowest );
        upper = fmax( upper, reports[i].lowest );
    }
    return upper - lower;
}

// 1: one kilogramme on a square metre, on increasingly fine meshes. A vertex of the finest weighs 0.4 g.
static wisp_status fine_and_light( int way, int workers, stability_outcome* out, wisp_error* error )
{
    static const int sides[3] = { 13, 25, 49 };
    setup setups[3];
    report reports[3];
    for ( int i = 0; i < 3; ++i )
    {
        setups[i] = setup_of( way );
        setups[i].plan.side = sides[i];
        setups[i].plan.spacing = 1.0f / (float)( sides[i] - 1 );
        setups[i].plan.density = 1.0f;
        setups[i].plan.damping = 3.0f;
    }
    const wisp_status status = run_all( setups, 3, workers, reports, out, error );
    const double difference = spread( reports, 3 );
    stability_claim( out, difference < 0.05, "13, 25 and 49 per side hang to %.3f, %.3f and %.3f m",
                     reports[0].lowest, reports[1].lowest, reports[2].lowest );
    return status;
}

// 2: a fall of 2 s without pins, air and damping. A step of symplectic Euler falls g t (t + h) / 2.
static wisp_status free_fall( int way, int workers, stability_outcome* out, wisp_error* error )
{
    setup one = setup_of( way );
    one.plan.is_free = true;
    one.plan.damping = 0.0f;
    one.seconds = 2.0;
    report r;
    const wisp_status status = run_setup( &one, workers, &r, error );
    const double h = (double)STABILITY_FRAME / one.plan.substeps, g = (double)STABILITY_GRAVITY;
    const double euler = -0.5 * g * 2.0 * ( 2.0 + h ) - 0.55, exact = -0.5 * g * 4.0 - 0.55;
    const double off = fmin( fabs( r.lowest - euler ), fabs( r.lowest - exact ) );
    *out = r.outcome;
    // it keeps falling: the final speed is no jitter
    out->verdict = out->verdict.broke == STABILITY_LIMIT_JITTER ? ( stability_verdict ){ 0 } : out->verdict;
    stability_claim( out, off < 0.02 && r.strain < 1e-3, "%.1e m from a closed form, strain %.1e", off, r.strain );
    return status;
}

static const float body_scales[3] = { 0.1f, 1.0f, 5.0f };
static float body_scale;

static wisp_status put_on_ball( stability_surface* s )
{
    wisp_world* world = s->implementation.world;
    wisp_entity ball;
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_SPHERE;
    def.radius = 0.15f * body_scale;
    def.pose.translation = ( wisp_vec3 ){ 0.0f, -0.3f * body_scale, 0.16f * body_scale };
    const wisp_collision_def collision = wisp_default_collision_def();
    wisp_status status = wisp_add_collider( world, &def, &ball );
    status = status == WISP_OK ? wisp_set_collision( world, s->implementation.entity, &collision ) : status;
    return status;
}

// 3: a tenth, once and five times the size, in proportional times: the same shape on a ball.
static wisp_status sizes( int way, int workers, stability_outcome* out, wisp_error* error )
{
    report reports[3];
    wisp_status status = WISP_OK;
    for ( int i = 0; i < 3 && status == WISP_OK; ++i )
    {
        setup one = setup_of( way );
        body_scale = one.axes.scale = body_scales[i];
        one.axes.seconds = STABILITY_FRAME * sqrtf( body_scales[i] );
        one.dress = put_on_ball;
        status = run_all( &one, 1, workers, reports + i, out, error );
        reports[i].lowest /= (double)body_scales[i];
    }
    const double difference = spread( reports, 3 );
    stability_claim( out, difference < 0.01, "hang to %.4f, %.4f and %.4f of their size", reports[0].lowest,
                     reports[1].lowest, reports[2].lowest );
    return status;
}

// 5: links of 200 N/m in 10, 20 and 40 substeps, and 20 of half a frame.
static wisp_status same_stiffness( int way, int workers, stability_outcome* out, wisp_error* error )
{
    setup setups[4];
    report reports[4];
    for ( int i = 0; i < 4; ++i )
    {
        setups[i] = setup_of( way );
        setups[i].axes.stiffness = 200.0f;
        setups[i].plan.substeps = i < 3 ? 10 << i : 20;
    }
    setups[3].axes.seconds = 0.5f * STABILITY_FRAME;
    const wisp_status status = run_all( setups, 4, workers, reports, out, error );
    const double difference = spread( reports, 4 );
    stability_claim( out, difference < 0.01, "10, 20, 40 and 2 x 20 substeps hang to %.4f, %.4f, %.4f and %.4f m",
                     reports[0].lowest, reports[1].lowest, reports[2].lowest, reports[3].lowest );
    return status;
}

// 6: the same cloth in tiles of 64 and of 1024, and with two workers.
static wisp_status regrouped( int way, int workers, stability_outcome* out, wisp_error* error )
{
    setup setups[2];
    report reports[2], parallel;
    for ( int i = 0; i < 2; ++i )
    {
        setups[i] = setup_of( way );
        setups[i].plan.side = 24;
        setups[i].plan.spacing = 0.025f;
        setups[i].plan.tile_size = i == 0 ? 64 : 1024;
    }
    wisp_status status = run_all( setups, 2, workers, reports, out, error );
    if ( status == WISP_OK )
    {
        status = run_setup( setups, 2, &parallel, error );
    }
    const bool same = parallel.outcome.hash == reports[0].outcome.hash;
    const double difference = spread( reports, 2 );
    stability_claim( out, same && difference < 0.01, "tiles of 64 and 1024 hang to %.4f and %.4f m, %s bits",
                     reports[0].lowest, reports[1].lowest, same ? "same" : "OTHER" );
    return status;
}

// 8: a kilometre from the origin, where a float is rounded by 0.06 mm.
static wisp_status far_away( int way, int workers, stability_outcome* out, wisp_error* error )
{
    setup setups[2];
    report reports[2];
    for ( int i = 0; i < 2; ++i )
    {
        setups[i] = setup_of( way );
        setups[i].plan.at.x = i == 0 ? 0.0f : 1000.0f;
        setups[i].plan.at.z = i == 0 ? 0.0f : -1000.0f;
    }
    const wisp_status status = run_all( setups, 2, workers, reports, out, error );
    const double difference = spread( reports, 2 );
    stability_claim( out, difference < 0.01, "at the origin and 1.4 km from it hang to %.4f and %.4f m",
                     reports[0].lowest, reports[1].lowest );
    return status;
}

// A million steps of a cloth that hangs at rest: nothing may creep or start to move.
static wisp_status soak( int way, int workers, stability_outcome* out, wisp_error* error )
{
    setup one = setup_of( way );
    one.axes.seconds = STABILITY_FRAME / (float)one.plan.substeps;
    one.plan.substeps = 1;
    one.seconds = 1e6 * (double)one.axes.seconds;
    report r;
    const wisp_status status = run_setup( &one, workers, &r, error );
    *out = r.outcome;
    stability_claim( out, r.outcome.score.frames >= 1000000 && fabs( r.lowest + 0.55 ) < 0.05,
                     "hangs to %.4f m after %d steps", r.lowest, r.outcome.score.frames );
    return status;
}

// 7: a second cloth changes no bit of the first, adds no pass, and only its own memory.
static wisp_status costs_add_up( int way, int workers, stability_outcome* out, wisp_error* error )
{
    const setup one = setup_of( way );
    uint64_t hashes[3] = { 0 };
    size_t bytes[3] = { 0 };
    int passes[3] = { 0 };
    wisp_status status = WISP_OK;
    for ( int more = 0; more < 3 && status == WISP_OK; ++more )
    {
        stability_surface* s;
        status = stability_cloth_enter( &one.plan, &one.axes, workers, &s, error );
        for ( int i = 0; i < more && status == WISP_OK; ++i )
        {
            wisp_entity other;
            status = wisp_add_instance( s->implementation.world, s->implementation.entity, &other );
        }
        for ( int i = 0; i < 60 && status == WISP_OK; ++i )
        {
            status = surface_implementation_step( &s->implementation, error );
        }
        if ( status == WISP_OK )
        {
            hashes[more] = stability_surface_hash( s );
            bytes[more] = wisp_world_memory( s->implementation.world );
            passes[more] = wisp_world_plan_passes( s->implementation.world );
        }
        if ( s != NULL )
        {
            stability_surface_close( s );
        }
    }
    const double first = (double)bytes[1] - (double)bytes[0], second = (double)bytes[2] - (double)bytes[1];
    *out = ( stability_outcome ){ .hash = hashes[0] };
    stability_claim(
        out, hashes[0] == hashes[1] && hashes[0] == hashes[2] && passes[0] == passes[2] && second <= 1.05 * first,
        "%d passes with one and %d with three, %.0f and %.0f bytes more", passes[0], passes[2], first, second );
    return status;
}

static int anchor;
static double anchor_moved; // m

static uint64_t read_anchor( void* context )
{
    stability_surface* s = context;
    anchor_moved = stability_distance( s->seen[anchor], s->start[anchor] );
    return stability_surface_hash( s );
}

// 4: a full balloon falls on the ground with its anchor held: energy does not grow, and the anchor stays.
static wisp_status balloon_lands( int way, int workers, stability_outcome* out, wisp_error* error )
{
    stability_axes axes = usual;
    int count;
    const stability_subject* subject = stability_balloons( &count ) + way;
    stability_trial trial = { 0 };
    wisp_status status = subject->enter( subject->way, &axes, workers, &trial, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    stability_surface* s = trial.context;
    wisp_entity plane;
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_PLANE;
    def.pose.translation.y = -0.14f; // the lowest centimetre of the sphere is compressed
    const wisp_collision_def collision = wisp_default_collision_def();
    status = wisp_add_collider( s->implementation.world, &def, &plane );
    status = status == WISP_OK ? wisp_set_collision( s->implementation.world, s->implementation.entity, &collision )
                               : status;
    if ( status != WISP_OK )
    {
        bench_world_fail( s->implementation.world, status, error );
        trial.close( s );
        return status;
    }
    // the ground lifts it for a fifth of a second; its motion after that is its own
    trial.limits.driven_frames = 12;
    anchor = s->mesh.triangles[0];
    trial.hash = read_anchor;
    status = stability_run( &trial, out, error );
    stability_claim( out, anchor_moved == 0.0, "the anchor has moved by %.1e m", anchor_moved );
    return status;
}

static const stability_named cells[] = {
    { "failure 1: fine and light, xpbd far", false, false, STABILITY_XPBD_FAR, fine_and_light },
    { "failure 1: fine and light, implicit", false, false, STABILITY_IMPLICIT_EULER, fine_and_light },
    { "failure 2: free fall, pbd", true, false, STABILITY_PBD, free_fall },
    { "failure 2: free fall, dihedral", true, false, STABILITY_XPBD_DIHEDRAL, free_fall },
    { "failure 2: free fall, implicit", false, false, STABILITY_IMPLICIT_EULER, free_fall },
    { "failure 3: body of another size, xpbd", false, false, STABILITY_XPBD_DIHEDRAL, sizes },
    { "failure 4: balloon pbd pressed, with an anchor", false, false, 0, balloon_lands },
    { "failure 4: balloon xpbd pressed, with an anchor", true, false, 1, balloon_lands },
    { "failure 5: frame rate and substeps, xpbd", false, false, STABILITY_XPBD_DIHEDRAL, same_stiffness },
    { "failure 6: regrouped, xpbd", false, false, STABILITY_XPBD_DIHEDRAL, regrouped },
    { "failure 7: costs add up", true, false, STABILITY_XPBD, costs_add_up },
    { "failure 8: far from the origin, xpbd", false, false, STABILITY_XPBD_DIHEDRAL, far_away },
    { "soak: cloth xpbd, 1e6 steps at rest", false, true, STABILITY_XPBD, soak },
    { "soak: cloth pbd, 1e6 steps at rest", false, true, STABILITY_PBD, soak },
    { "soak: implicit euler, 1e6 steps at rest", false, true, STABILITY_IMPLICIT_EULER, soak },
};

const stability_named* stability_failures( int* count )
{
    *count = WISP_COUNT( cells );
    return cells;
}
