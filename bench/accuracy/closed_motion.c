// Closed forms of motion: free fall, free spin, a plate in air, a cloth on an incline.
#include "closed_forms.h"

#include "collision/collision.h"

#include <math.h>

enum
{
    SIDE = 8, // vertices of a sheet
};

#define SPACING 0.02
#define DENSITY 0.15 // kg/m^2

static double radians( double degrees )
{
    return degrees * 3.14159265358979323846 / 180.0;
}

static int frames_of( double seconds )
{
    return (int)lrint( seconds / (double)ACCURACY_FRAME );
}

static double length( const double a[3] )
{
    return sqrt( a[0] * a[0] + a[1] * a[1] + a[2] * a[2] );
}

static wisp_cloth_def inextensible( void )
{
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    return cloth;
}

static wisp_status throw_body( closed_body* body, wisp_vec3 linear, wisp_vec3 angular, wisp_error* error )
{
    wisp_status status =
        wisp_set_velocity( body->implementation.world, body->implementation.entity, linear, angular );
    return status == WISP_OK ? WISP_OK : bench_world_fail( body->implementation.world, status, error );
}

// z = v t - g t^2 / 2 at every vertex, so that all links stay at rest length.
wisp_status closed_fall( closed_run* run, wisp_error* error )
{
    const wisp_cloth_def cloth = inextensible();
    const wisp_vec3 thrown = { 0.5f, 1.0f, 0.0f };
    const double t = run->first;
    closed_body body = { .fabric = NULL };
    wisp_motion_stats seen = { 0 };
    wisp_status status = surface_plane( SIDE, SIDE, SPACING, &body.mesh, error );
    status = status == WISP_OK ? closed_enter( run, closed_generator( run ), &cloth, &body, error ) : status;
    status = status == WISP_OK ? throw_body( &body, thrown, ( wisp_vec3 ){ 0, 0, 0 }, error ) : status;
    status = status == WISP_OK ? closed_advance( run, &body, frames_of( t ), &seen, error ) : status;
    if ( status == WISP_OK && run->is_observed )
    {
        const double speed = (double)thrown.y - CLOSED_GRAVITY * t;
        const double lost[3] = { seen.momentum[0] - seen.mass * (double)thrown.x,
                                 seen.momentum[1] - seen.mass * speed, seen.momentum[2] };
        run->measured = -seen.centre[1];
        run->reference = -( (double)thrown.y * t - 0.5 * CLOSED_GRAVITY * t * t );
        run->momentum_error = length( lost ) / ( seen.mass * hypot( (double)thrown.x, speed ) );
    }
    closed_leave( &body );
    return status;
}

// Only its own links act, which hold it together against its spin.
wisp_status closed_spin( closed_run* run, wisp_error* error )
{
    const wisp_cloth_def cloth = inextensible();
    const wisp_vec3 thrown = { 0.5f, 0.0f, 0.0f }, turned = { 0.0f, 6.0f, 0.0f };
    closed_body body = { .fabric = NULL };
    wisp_motion_stats seen = { 0 };
    wisp_status status = surface_plane( SIDE, SIDE, SPACING, &body.mesh, error );
    surface_generator generator = closed_generator( run );
    generator.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    status = status == WISP_OK ? closed_enter( run, generator, &cloth, &body, error ) : status;
    status = status == WISP_OK ? throw_body( &body, thrown, turned, error ) : status;
    status = status == WISP_OK ? closed_advance( run, &body, frames_of( run->first ), &seen, error ) : status;
    if ( status == WISP_OK && run->is_observed )
    {
        const wisp_fabric* f = body.fabric;
        for ( int i = 0; i < f->vertex_count; ++i )
        {
            const double x = (double)f->rest[i].x, z = (double)f->rest[i].z;
            run->reference += DENSITY * (double)f->area[i] * (double)turned.y * ( x * x + z * z );
        }
        const double lost[3] = { seen.momentum[0] - seen.mass * (double)thrown.x, seen.momentum[1],
                                 seen.momentum[2] };
        run->measured = length( seen.angular_momentum );
        run->momentum_error = length( lost ) / ( seen.mass * (double)thrown.x );
    }
    closed_leave( &body );
    return status;
}

// v = v_t tanh( g t / v_t ), v_t = sqrt( 2 m g / ( rho A C_d ) )
wisp_status closed_plate( closed_run* run, wisp_error* error )
{
    wisp_cloth_def cloth = inextensible();
    cloth.air_density = 1.225f;
    cloth.drag_coefficient = 1.28f;
    closed_body body = { .fabric = NULL };
    wisp_motion_stats seen = { 0 };
    wisp_status status = surface_plane( SIDE, SIDE, SPACING, &body.mesh, error );
    status = status == WISP_OK ? closed_enter( run, closed_generator( run ), &cloth, &body, error ) : status;
    status = status == WISP_OK ? closed_advance( run, &body, frames_of( run->first ), &seen, error ) : status;
    if ( status == WISP_OK && run->is_observed )
    {
        const double terminal =
            sqrt( 2.0 * DENSITY * CLOSED_GRAVITY / ( (double)cloth.air_density * (double)cloth.drag_coefficient ) );
        run->measured = length( seen.momentum ) / seen.mass;
        run->reference = terminal * tanh( CLOSED_GRAVITY * run->first / terminal );
    }
    closed_leave( &body );
    return status;
}

// ---- the incline ----

#define SLIDE_SECONDS 0.5
#define THICKNESS 0.005f

static wisp_status lay_down( closed_body* body, double mu, wisp_error* error )
{
    wisp_collider_def ground = wisp_default_collider_def();
    ground.kind = WISP_COLLIDER_PLANE;
    ground.static_friction = ground.kinetic_friction = (float)mu;
    wisp_collision_def meets = wisp_default_collision_def();
    meets.thickness = THICKNESS;
    wisp_entity plane;
    wisp_status status = wisp_add_collider( body->implementation.world, &ground, &plane );
    status = status == WISP_OK ? wisp_set_collision( body->implementation.world, body->implementation.entity, &meets )
                               : status;
    return status == WISP_OK ? WISP_OK : bench_world_fail( body->implementation.world, status, error );
}

// The plane stays level and gravity is turned instead. The cloth starts in contact, so that it does not fall first.
wisp_status closed_slide( closed_run* run, wisp_error* error )
{
    const wisp_cloth_def cloth = inextensible();
    const double angle = radians( run->first ), mu = run->second;
    const double along = CLOSED_GRAVITY * sin( angle ), across = CLOSED_GRAVITY * cos( angle );
    const double path = 0.5 * SLIDE_SECONDS * SLIDE_SECONDS;
    closed_body body = { .fabric = NULL };
    wisp_motion_stats seen = { 0 };
    wisp_status status = surface_plane( SIDE / 2, SIDE / 2, SPACING, &body.mesh, error );
    for ( int i = 0; i < body.mesh.vertex_count; ++i )
    {
        body.mesh.points[i].y = THICKNESS;
    }
    surface_generator generator = closed_generator( run );
    generator.gravity = ( wisp_vec3 ){ (float)along, (float)-across, 0.0f };
    status = status == WISP_OK ? closed_enter( run, generator, &cloth, &body, error ) : status;
    status = status == WISP_OK ? lay_down( &body, mu, error ) : status;
    status = status == WISP_OK ? closed_advance( run, &body, frames_of( SLIDE_SECONDS ), &seen, error ) : status;
    if ( status == WISP_OK && run->is_observed )
    {
        // a cloth that sticks has no distance to be relative to: use that of the same incline without friction
        run->measured = seen.centre[0];
        run->reference = fmax( 0.0, along - mu * across ) * path;
        run->scale = run->reference > 0.0 ? run->reference : along * path;
    }
    closed_leave( &body );
    return status;
}
