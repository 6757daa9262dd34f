// A ball with mass, moved by the host, and a sheet of cloth that moves it too: wisp_read_reaction() gives the host's rigid body what the
// sheet gave to its collider, and where the sheet has moved it.
//
//     cc -std=c17 reaction.c $(pkg-config --cflags --libs wisp) -o reaction && ./reaction
//
// A sheet that is held at its corners catches a falling ball, which comes to rest. Then a free sheet meets a free ball without
// gravity, and the momentum of both together stays. Exit status 0 if all is as it should be, 1 if not.
#include <wisp/cloth.h>
#include <wisp/collision.h>
#include <wisp/fabric.h>
#include <wisp/generate.h>
#include <wisp/wisp.h>

#include <math.h>
#include <stdio.h>

#define SIDE 33 // vertices
#define SPACING ( 1.0f / ( SIDE - 1 ) )
#define STEP ( 1.0f / 60.0f )

static wisp_vec3 points[WISP_GRID_VERTICES( SIDE, SIDE )];
static int32_t triangles[WISP_GRID_TRIANGLES( SIDE, SIDE )][3];
static const int32_t corners[4] = { 0, SIDE - 1, SIDE*( SIDE - 1 ), SIDE* SIDE - 1 };

// A rigid ball, in double so that it keeps small impulses. It turns too: its inertia is 2/5 m r^2.
typedef struct ball
{
    double mass, radius, position[3], velocity[3], spin[3];
    wisp_quat rotation;
} ball;

typedef struct stage
{
    wisp_world* world;
    wisp_entity sheet, collider;
} stage;

static wisp_status add_sheet( stage* s, bool is_held )
{
    wisp_fabric_def fabric_def = wisp_default_fabric_def();
    fabric_def.points = points;
    fabric_def.vertex_count = WISP_COUNT( points );
    fabric_def.triangles = &triangles[0][0];
    fabric_def.triangle_count = WISP_COUNT( triangles );
    wisp_fabric* fabric;
    wisp_status status = wisp_fabric_cook( &fabric_def, NULL, &fabric, NULL );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_surface_def surface = wisp_default_surface_def();
    surface.fabric = fabric;
    surface.pins = is_held ? corners : NULL;
    surface.pin_count = is_held ? WISP_COUNT( corners ) : 0;
    surface.gravity = ( wisp_vec3 ){ 0.0f, is_held ? -9.81f : 0.0f, 0.0f };
    status = wisp_add_surface( s->world, &surface, &s->sheet );
    wisp_fabric_release( fabric );
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.internal_damping = 0.0f; // it would round the momentum that is compared
    status = status == WISP_OK ? wisp_set_cloth( s->world, s->sheet, &cloth ) : status;
    const wisp_collision_def collision = wisp_default_collision_def();
    status = status == WISP_OK ? wisp_set_collision( s->world, s->sheet, &collision ) : status;
    status = status == WISP_OK && is_held ? wisp_set_damping( s->world, s->sheet, 30.0f ) : status;
    return status == WISP_OK ? wisp_request( s->world, s->sheet, WISP_MOTION_STATS ) : status;
}

static wisp_transform pose_of( const ball* b )
{
    return ( wisp_transform ){ b->rotation, { (float)b->position[0], (float)b->position[1], (float)b->position[2] } };
}

static wisp_status add_ball( stage* s, const ball* b )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_SPHERE;
    def.radius = (float)b->radius;
    def.pose = pose_of( b );
    def.mass = (float)b->mass;
    const float inertia = 0.4f * def.mass * def.radius * def.radius;
    def.inertia = ( wisp_vec3 ){ inertia, inertia, inertia };
    return wisp_add_collider( s->world, &def, &s->collider );
}

// Move the ball with the velocities that it has, let the sheet answer, and take the answer.
static wisp_status step( const stage* s, ball* b, double gravity )
{
    const double dt = (double)STEP, inertia = 0.4 * b->mass * b->radius * b->radius;
    b->velocity[1] -= gravity * dt;
    const double* w = b->spin;
    const wisp_quat q = b->rotation;
    const double turn[4] = { 0.5 * dt * ( w[0] * q.w + w[1] * q.z - w[2] * q.y ),
                             0.5 * dt * ( w[1] * q.w + w[2] * q.x - w[0] * q.z ),
                             0.5 * dt * ( w[2] * q.w + w[0] * q.y - w[1] * q.x ),
                             0.5 * dt * ( -w[0] * q.x - w[1] * q.y - w[2] * q.z ) };
    b->rotation = ( wisp_quat ){ (float)( q.x + turn[0] ), (float)( q.y + turn[1] ), (float)( q.z + turn[2] ),
                                 (float)( q.w + turn[3] ) };
    for ( int k = 0; k < 3; ++k )
    {
        b->position[k] += dt * b->velocity[k];
    }
    wisp_status status = wisp_move_collider( s->world, s->collider, pose_of( b ) );
    status = status == WISP_OK ? wisp_world_step( s->world, STEP ) : status;
    wisp_reaction r;
    status = status == WISP_OK ? wisp_read_reaction( s->world, s->collider, &r ) : status;
    if ( status == WISP_OK )
    {
        b->rotation = r.pose.rotation;
        const float impulse[3] = { r.impulse.x, r.impulse.y, r.impulse.z };
        const float to[3] = { r.pose.translation.x, r.pose.translation.y, r.pose.translation.z };
        const float torque[3] = { r.torque_impulse.x, r.torque_impulse.y, r.torque_impulse.z };
        for ( int k = 0; k < 3; ++k )
        {
            b->velocity[k] += impulse[k] / b->mass;
            b->position[k] = to[k];
            b->spin[k] += torque[k] / inertia;
        }
    }
    return status;
}

static double length_of( const double v[3] )
{
    return sqrt( v[0] * v[0] + v[1] * v[1] + v[2] * v[2] );
}

// ---- two scenes ----

static wisp_status catch_ball( stage* s )
{
    ball b = { .mass = 0.5, .radius = 0.1, .position = { 0.0, 0.3, 0.0 }, .rotation = { 0.0f, 0.0f, 0.0f, 1.0f } };
    wisp_status status = add_sheet( s, true );
    status = status == WISP_OK ? add_ball( s, &b ) : status;
    for ( int n = 1; n <= 480 && status == WISP_OK; ++n )
    {
        status = step( s, &b, 9.81 );
        if ( n % 120 == 0 )
        {
            printf( "%d s: the ball is at %.3f m and moves at %.3f m/s\n", n / 60, b.position[1],
                    length_of( b.velocity ) );
        }
    }
    const bool rests = length_of( b.velocity ) < 0.1 && b.position[1] > -0.5 && b.position[1] < 0.1;
    return status == WISP_OK && rests == false ? WISP_BAD_INPUT : status;
}

static wisp_status momentum_of( const stage* s, const ball* b, double out[3] )
{
    wisp_motion_stats stats;
    wisp_status status = wisp_read_motion_stats( s->world, s->sheet, &stats );
    for ( int k = 0; k < 3; ++k )
    {
        out[k] = stats.momentum[k] + b->mass * b->velocity[k];
    }
    return status;
}

static wisp_status meet_freely( stage* s )
{
    ball b = { .mass = 0.2,
               .radius = 0.1,
               .position = { 0.1, 0.3, 0.05 },
               .velocity = { 0.0, -1.0, 0.2 },
               .rotation = { 0.0f, 0.0f, 0.0f, 1.0f } };
    wisp_status status = add_sheet( s, false );
    status = status == WISP_OK ? add_ball( s, &b ) : status;
    double before[3] = { 0.0 }, after[3] = { 0.0 }, difference[3];
    const double thrown = length_of( b.velocity );
    for ( int n = 0; n < 120 && status == WISP_OK; ++n )
    {
        status = step( s, &b, 0.0 );
        status = status == WISP_OK ? momentum_of( s, &b, n == 0 ? before : after ) : status;
    }
    for ( int k = 0; k < 3; ++k )
    {
        difference[k] = after[k] - before[k];
    }
    const double error = length_of( difference ) / length_of( before );
    printf( "free: the ball slows down from %.3f to %.3f m/s, the momentum of both changes by %.1e of itself\n",
            thrown, length_of( b.velocity ), error );
    return status == WISP_OK && ( error > 1e-5 || length_of( b.velocity ) > 0.9 * thrown ) ? WISP_BAD_INPUT : status;
}

static int play( wisp_status ( *scene )( stage* ) )
{
    static const wisp_module* const modules[] = { &wisp_cloth_module, &wisp_collision_module };
    wisp_world_def def = wisp_default_world_def();
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    def.substeps = 8; // a sheet of 1000 vertices without coarse sheets stretches less
    wisp_error error = { 0 };
    stage s;
    if ( wisp_world_create( &def, &s.world, &error ) != WISP_OK )
    {
        printf( "%s\n", error.message );
        return 1;
    }
    const wisp_status status = scene( &s );
    if ( status != WISP_OK )
    {
        printf( "not as it should be: %s\n", wisp_world_message( s.world ) );
    }
    wisp_world_destroy( s.world );
    return status == WISP_OK ? 0 : 1;
}

int main( void )
{
    if ( wisp_generate_grid( SIDE, SIDE, SPACING, SPACING, points, &triangles[0][0], NULL ) != WISP_OK )
    {
        return 1;
    }
    return play( catch_ball ) | play( meet_freely );
}
