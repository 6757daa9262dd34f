// Drives beyond any material: pins that jump 100 m, a ball at 100 m/s, cloth that falls on itself and on the ground.
#include "stability_cloth.h"
#include "stability_strands.h"

#include "collision/collision.h"
#include "contact/contact.h"
#include "wisp/module/components.h"
#include "wisp/module/random.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#define JUMP 100.0f       // m, in one step
#define BALL_SPEED 100.0f // m/s
#define BALL_RADIUS 0.15f
#define BALL_FRAMES 12 // in which it arrives and returns
#define REPEATS 10     // of contact, each with vertices moved a little
#define JITTER 1e-3f   // m, largest displacement

static const stability_axes usual = { STABILITY_START_REST, STABILITY_FRAME, 1.0f, 0.0f, 1.0f };

// ---- pins that jump ----

static wisp_status jump( stability_surface* s, int frame )
{
    const int32_t pins[2] = { 0, 11 };
    wisp_vec3 targets[2];
    for ( int i = 0; i < 2; ++i )
    {
        const wisp_vec3 p = s->mesh.points[pins[i]];
        targets[i] = ( wisp_vec3 ){ p.x + JUMP, p.y, p.z };
    }
    return frame == 1 ? wisp_move_pins( s->implementation.world, s->implementation.entity, pins, targets, 2 )
                      : WISP_OK;
}

static wisp_status jump_head( stability_strands* s, int frame )
{
    const wisp_transform pose =
        wisp_transform_make( ( wisp_quat ){ 0.0f, 0.0f, 0.0f, 1.0f }, ( wisp_vec3 ){ JUMP, 0.0f, 0.0f } );
    return frame == 1 ? wisp_move_strand_head( s->world, s->entity, pose ) : WISP_OK;
}

// A coordinate of 100 m is rounded by 8 um: a displacement of that size in a substep is no motion.
static void allow_rounding( stability_trial* trial, double substep )
{
    trial->limits.driven_frames = 1;
    trial->limits.jitter = fmax( trial->limits.jitter, 8.0 * (double)FLT_EPSILON * (double)JUMP / substep );
}

static wisp_status pins_jump( int way, int workers, stability_outcome* out, wisp_error* error )
{
    const stability_cloth_plan plan = stability_default_cloth_plan( way );
    stability_surface* s;
    const wisp_status status = stability_cloth_enter( &plan, &usual, workers, &s, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    stability_trial trial = stability_surface_trial( s, &usual );
    s->drive = jump;
    allow_rounding( &trial, (double)usual.seconds / plan.substeps );
    return stability_run( &trial, out, error );
}

static wisp_status enter_strands( int way, int workers, stability_strands** out, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_collision_module, &wisp_strands_module };
    stability_strands* s = *out = calloc( 1, sizeof( **out ) );
    if ( s == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a cell" );
    }
    s->def = stability_strand_def( way, &usual );
    const wisp_status status = stability_strands_enter( s, modules, WISP_COUNT( modules ), &usual, workers, error );
    if ( status != WISP_OK )
    {
        stability_strands_close( s );
    }
    return status;
}

static wisp_status head_jumps( int way, int workers, stability_outcome* out, wisp_error* error )
{
    stability_strands* s;
    const wisp_status status = enter_strands( way, workers, &s, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    stability_trial trial = stability_strands_trial( s, &usual );
    s->drive = jump_head;
    allow_rounding( &trial, s->substep );
    return stability_run( &trial, out, error );
}

// ---- a fast ball ----

static wisp_transform ball_at( int frame, wisp_vec3 aim )
{
    // through the plane of the body to 1.7 m behind it, and back
    const int turn = BALL_FRAMES / 2 + 1, way = frame <= turn ? frame : 2 * turn - frame;
    const float z = BALL_SPEED * STABILITY_FRAME * ( (float)way - 0.5f * BALL_FRAMES );
    return wisp_transform_make( ( wisp_quat ){ 0.0f, 0.0f, 0.0f, 1.0f }, ( wisp_vec3 ){ aim.x, aim.y, aim.z + z } );
}

static wisp_status add_ball( wisp_world* world, wisp_entity participant, float radius, wisp_vec3 aim,
                             wisp_entity* ball )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_SPHERE;
    def.radius = radius;
    def.pose = ball_at( 0, aim );
    const wisp_collision_def collision = wisp_default_collision_def();
    const wisp_status status = wisp_add_collider( world, &def, ball );
    return status == WISP_OK ? wisp_set_collision( world, participant, &collision ) : status;
}

static const wisp_vec3 cloth_aim = { 0.02f, -0.3f, 0.01f }, strand_aim = { 0.02f, -0.06f, 0.0f };

static wisp_status move_ball( stability_surface* s, int frame )
{
    return frame <= 2 * BALL_FRAMES
               ? wisp_move_collider( s->implementation.world, s->body, ball_at( frame, cloth_aim ) )
               : WISP_OK;
}

static wisp_status move_strand_ball( stability_strands* s, int frame )
{
    return frame <= 2 * BALL_FRAMES ? wisp_move_collider( s->world, s->body, ball_at( frame, strand_aim ) ) : WISP_OK;
}

// An elastic hit by a body of that speed gives twice its speed; taut links of a chain add once more.
static void allow_ball( stability_trial* trial )
{
    trial->limits.driven_frames = 2 * BALL_FRAMES; // it carries what it has caught
    trial->limits.speed = 4.0 * (double)BALL_SPEED;
}

static wisp_status ball_comes( int way, int workers, stability_outcome* out, wisp_error* error )
{
    const stability_cloth_plan plan = stability_default_cloth_plan( way );
    stability_surface* s;
    wisp_status status = stability_cloth_enter( &plan, &usual, workers, &s, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_ball( s->implementation.world, s->implementation.entity, BALL_RADIUS, cloth_aim, &s->body );
    if ( status != WISP_OK )
    {
        bench_world_fail( s->implementation.world, status, error );
        stability_surface_close( s );
        return status;
    }
    stability_trial trial = stability_surface_trial( s, &usual );
    s->drive = move_ball;
    allow_ball( &trial );
    return stability_run( &trial, out, error );
}

static wisp_status ball_meets_strands( int way, int workers, stability_outcome* out, wisp_error* error )
{
    stability_strands* s;
    wisp_status status = enter_strands( way, workers, &s, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_ball( s->world, s->entity, 0.2f * BALL_RADIUS, strand_aim, &s->body );
    if ( status != WISP_OK )
    {
        bench_world_fail( s->world, status, error );
        stability_strands_close( s );
        return status;
    }
    stability_trial trial = stability_strands_trial( s, &usual );
    s->drive = move_strand_ball;
    allow_ball( &trial );
    return stability_run( &trial, out, error );
}

// ---- contact ----

static double count_intersections( stability_surface* s )
{
    wisp_contact_stats stats = { 0 };
    return wisp_read_contact_stats( s->implementation.world, &stats ) == WISP_OK ? (double)stats.intersections : 0.0;
}

static wisp_status lay_ground( stability_surface* s )
{
    wisp_world* world = s->implementation.world;
    wisp_entity plane;
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_PLANE;
    def.pose.translation.y = -0.6f;
    const wisp_collision_def collision = wisp_default_collision_def();
    const wisp_contact_def contact = wisp_default_contact_def();
    wisp_status status = wisp_add_collider( world, &def, &plane );
    status = status == WISP_OK ? wisp_set_collision( world, s->implementation.entity, &collision ) : status;
    status = status == WISP_OK ? wisp_set_contact( world, s->implementation.entity, &contact ) : status;
    return status == WISP_OK ? wisp_request_contact_stats( world, true, true ) : status;
}

static void shake( stability_surface* s, int repeat )
{
    const wisp_random_key key = wisp_random_make_key( 7, (uint64_t)repeat, 0 );
    float* x = wisp_world_column( s->implementation.world, s->implementation.entity, WISP_PARTICLE_POSITION, 0 );
    for ( int i = 0; i < 4 * s->fabric->vertex_count; ++i )
    {
        const float shift = wisp_random_unit_float( key, (uint32_t)( i / 4 ), (uint32_t)( i % 4 ), 0 ) - 0.5f;
        x[i] += i % 4 == 3 ? 0.0f : 2.0f * JITTER * shift;
    }
}

static wisp_status fall_once( int way, int repeat, int workers, stability_outcome* out, wisp_error* error )
{
    stability_cloth_plan plan = stability_default_cloth_plan( way );
    plan.is_free = true;
    stability_surface* s;
    wisp_status status = stability_cloth_enter( &plan, &usual, workers, &s, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = lay_ground( s );
    if ( status != WISP_OK )
    {
        bench_world_fail( s->implementation.world, status, error );
        stability_surface_close( s );
        return status;
    }
    shake( s, repeat );
    stability_trial trial = stability_surface_trial( s, &usual );
    s->breach = count_intersections;
    return stability_run( &trial, out, error );
}

// The first repeat that breaks, else the last one; hashes of all are combined.
static wisp_status fall_in_folds( int way, int workers, stability_outcome* out, wisp_error* error )
{
    uint64_t hash = 0;
    wisp_status status = WISP_OK;
    stability_outcome broken = { 0 };
    for ( int i = 0; i < REPEATS && status == WISP_OK; ++i )
    {
        status = fall_once( way, i, workers, out, error );
        hash = wisp_random_mix( hash ^ out->hash );
        if ( out->verdict.broke != STABILITY_LIMIT_NONE && broken.verdict.broke == STABILITY_LIMIT_NONE )
        {
            broken = *out;
            snprintf( broken.said, sizeof( broken.said ), "in repeat %d of %d", i + 1, REPEATS );
        }
    }
    *out = broken.verdict.broke != STABILITY_LIMIT_NONE ? broken : *out;
    out->hash = hash;
    return status;
}

static const stability_named cells[] = {
    { "cloth pbd: pins jump 100 m", false, false, STABILITY_PBD, pins_jump },
    { "cloth xpbd: pins jump 100 m", true, false, STABILITY_XPBD, pins_jump },
    { "cloth xpbd far: pins jump 100 m", false, false, STABILITY_XPBD_FAR, pins_jump },
    { "cloth dihedral: pins jump 100 m", false, false, STABILITY_XPBD_DIHEDRAL, pins_jump },
    { "implicit euler: pins jump 100 m", false, false, STABILITY_IMPLICIT_EULER, pins_jump },
    { "implicit bdf2: pins jump 100 m", false, false, STABILITY_IMPLICIT_BDF2, pins_jump },
    { "strand rod: head jumps 100 m", true, false, STABILITY_ROD, head_jumps },
    { "strand direct: head jumps 100 m", false, false, STABILITY_DIRECT, head_jumps },
    { "strand xpbd: head jumps 100 m", false, false, STABILITY_STRAND_XPBD, head_jumps },
    { "strand follow: head jumps 100 m", false, false, STABILITY_FOLLOW, head_jumps },
    { "cloth pbd: ball at 100 m/s", false, false, STABILITY_PBD, ball_comes },
    { "cloth xpbd: ball at 100 m/s", true, false, STABILITY_XPBD, ball_comes },
    { "cloth dihedral: ball at 100 m/s", false, false, STABILITY_XPBD_DIHEDRAL, ball_comes },
    { "implicit euler: ball at 100 m/s", false, false, STABILITY_IMPLICIT_EULER, ball_comes },
    { "strand rod: ball at 100 m/s", true, false, STABILITY_ROD, ball_meets_strands },
    { "strand xpbd: ball at 100 m/s", false, false, STABILITY_STRAND_XPBD, ball_meets_strands },
    { "contact: cloth xpbd falls in folds", false, false, STABILITY_XPBD, fall_in_folds },
    { "contact: cloth dihedral falls in folds", false, false, STABILITY_XPBD_DIHEDRAL, fall_in_folds },
};

const stability_named* stability_drives( int* count )
{
    *count = WISP_COUNT( cells );
    return cells;
}
