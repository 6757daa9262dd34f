#include "reference_run.h"

#include "newton.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double reference_distance( const double* a, const double* b, int vertex_count )
{
    double sum = 0.0;
    for ( int i = 0; i < 3 * vertex_count; ++i )
    {
        sum += ( a[i] - b[i] ) * ( a[i] - b[i] );
    }
    return sqrt( sum / vertex_count );
}

// ---- the cloth ----

static triangle_oracle_params params_of( const compare_scene* scene, const reference_plan* plan )
{
    triangle_oracle_params params = triangle_oracle_default_params();
    params.weights = TRIANGLE_ORACLE_WEIGHTS_NONE;
    params.jacobian = TRIANGLE_ORACLE_JACOBIAN_FULL;
    params.integrator = plan->integrator;
    params.stretch_stiffness = (double)COMPARE_STRETCH_STIFFNESS;
    params.bend_stiffness = (double)scene->physics.bend;
    params.damping = (double)scene->physics.damping_link;
    params.drag = (double)scene->physics.damping;
    params.gravity = double3_make( 0.0, -(double)TRIANGLE_GRAVITY, 0.0 );
    return params;
}

static wisp_status make_cloth( const compare_scene* scene, const reference_plan* plan, triangle_oracle* out,
                               wisp_error* error )
{
    const wisp_mesh* mesh = &scene->base.mesh;
    double3* points = calloc( (size_t)mesh->vertex_count, sizeof( double3 ) );
    if ( !points )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %d vertices", mesh->vertex_count );
    }
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        const wisp_vec3 p = mesh->points[i];
        points[i] = double3_make( (double)p.x, (double)p.y, (double)p.z );
    }
    const triangle_oracle_def def = { .count = mesh->vertex_count,
                                      .points = points,
                                      .triangle_count = mesh->triangle_count,
                                      .triangles = mesh->triangles,
                                      .masses = scene->masses };
    const triangle_oracle_params params = params_of( scene, plan );
    wisp_status status = triangle_oracle_create( &def, &params, out, error );
    free( points );
    for ( int i = 0; i < mesh->vertex_count && status == WISP_OK; ++i )
    {
        const wisp_vec3 p = scene->start[i];
        out->x[i] = double3_make( (double)p.x, (double)p.y, (double)p.z );
    }
    for ( int k = 0; k < scene->border_count && status == WISP_OK && !scene->physics.has_ball; ++k )
    {
        triangle_oracle_pin( out, scene->border[k] );
    }
    return status;
}

// Without gravity, in steps so long that no motion remains: the flat cloth relaxes to balance of its edges. The files
// keep floats of that, and every solver starts there, so the reference does too.
static wisp_status balance( newton* n, wisp_error* error )
{
    enum
    {
        STEPS = 30,
    };
    triangle_oracle* cloth = n->cloth;
    const triangle_oracle_params params = cloth->params;
    cloth->params.gravity = double3_make( 0.0, 0.0, 0.0 );
    cloth->params.integrator = TRIANGLE_ORACLE_EULER;
    wisp_status status = WISP_OK;
    for ( int k = 0; k < STEPS && status == WISP_OK; ++k )
    {
        status = newton_step( n, 1.0, NULL, error );
    }
    cloth->params = params;
    cloth->h_before = 0.0;
    for ( int i = 0; i < cloth->count; ++i )
    {
        cloth->x[i] =
            double3_make( (double)(float)cloth->x[i].x, (double)(float)cloth->x[i].y, (double)(float)cloth->x[i].z );
        cloth->v[i] = double3_make( 0.0, 0.0, 0.0 );
    }
    n->worst = 0.0;
    n->unconverged = 0;
    return status;
}

// ---- the run ----

static void observe( const compare_scene* scene, const triangle_oracle* cloth, double time, int number,
                     compare_reference* out, double* points )
{
    const size_t floats = 3 * (size_t)cloth->count;
    double* to = points + (size_t)number * floats;
    memcpy( to, cloth->x, floats * sizeof( double ) );
    out->observations[number].time = time;
    out->observations[number].observation = compare_observe( scene, to, (const double*)cloth->v );
    for ( size_t i = 0; i < floats; ++i )
    {
        out->points[(size_t)number * floats + i] = (float)to[i];
    }
}

static wisp_status go_on( newton* n, const compare_scene* scene, double seconds, double rate, wisp_error* error )
{
    triangle_oracle_body ball = triangle_oracle_sphere( double3_make( 0.0, (double)TRIANGLE_BALL_HEIGHT, 0.0 ),
                                                        (double)TRIANGLE_BALL_RADIUS );
    ball.margin = (double)TRIANGLE_MARGIN;
    ball.still = (double)TRIANGLE_STATIC_FRICTION;
    ball.slip = (double)TRIANGLE_KINETIC_FRICTION;
    const triangle_oracle_bodies bodies = { 1, &ball };
    const long steps = lround( seconds * rate );
    wisp_status status = WISP_OK;
    for ( long k = 0; k < steps && status == WISP_OK; ++k )
    {
        status = newton_step( n, 1.0 / rate, scene->physics.has_ball ? &bodies : NULL, error );
    }
    return status;
}

static wisp_status run( newton* n, const compare_scene* scene, const reference_plan* plan, compare_reference* out,
                        double* points, wisp_error* error )
{
    const compare_physics* physics = &scene->physics;
    const double between = 0.05; // COMPARE_OBSERVATION_SECONDS without the rounding of a float
    wisp_status status = physics->has_ball ? WISP_OK : balance( n, error );
    observe( scene, n->cloth, 0.0, 0, out, points );
    for ( int k = 1; k < physics->observation_count && status == WISP_OK; ++k )
    {
        status = go_on( n, scene, between, plan->rate, error );
        observe( scene, n->cloth, k * between, k, out, points );
    }
    const double now = ( physics->observation_count - 1 ) * between;
    if ( status == WISP_OK && plan->has_rest )
    {
        // much longer steps would keep short-lived motion for too long
        n->cloth->h_before = 0.0;
        status = go_on( n, scene, (double)physics->rest_seconds - now, plan->rest_rate, error );
    }
    observe( scene, n->cloth, (double)physics->rest_seconds, physics->observation_count, out, points );
    fprintf( stderr, "%s, %g steps per second: %ld steps, %.2f systems per step, residual %.1e, %ld unconverged\n",
             physics->name, plan->rate, n->steps, (double)n->solves / (double)n->steps, n->worst, n->unconverged );
    return status;
}

wisp_status reference_run( const compare_scene* scene, const reference_plan* plan, compare_reference* out,
                           double** points, wisp_error* error )
{
    const int vertices = scene->base.mesh.vertex_count, observations = scene->physics.observation_count + 1;
    *out = ( compare_reference ){ .vertex_count = vertices,
                                  .observation_count = observations,
                                  .mesh_hash = scene->hash,
                                  .rate = plan->rate,
                                  .rest_rate = plan->rest_rate,
                                  .order = plan->integrator == TRIANGLE_ORACLE_BDF2 ? 2.0 : 1.0 };
    compare_reference_info( &scene->physics, out->info );
    triangle_oracle cloth = { .count = 0 };
    newton n = { .cloth = NULL };
    out->points = calloc( (size_t)vertices * (size_t)observations, 3 * sizeof( float ) );
    *points = calloc( (size_t)vertices * (size_t)observations, 3 * sizeof( double ) );
    wisp_status status = out->points && *points
                             ? make_cloth( scene, plan, &cloth, error )
                             : wisp_fail( error, WISP_NO_MEMORY, "no memory for the observations" );
    if ( status == WISP_OK )
    {
        status = newton_create( &cloth, &n, error );
        if ( status == WISP_OK )
        {
            status = run( &n, scene, plan, out, *points, error );
            out->residual = n.worst;
            if ( status == WISP_OK && n.unconverged > 0 )
            {
                status = wisp_fail( error, WISP_CONFLICT, "%ld of %ld steps did not converge: take shorter ones",
                                    n.unconverged, n.steps );
            }
            newton_destroy( &n );
        }
        triangle_oracle_destroy( &cloth );
    }
    if ( status != WISP_OK )
    {
        compare_reference_free( out );
        free( *points );
        *points = NULL;
    }
    return status;
}
