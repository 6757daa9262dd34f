// A flag in the wind in double precision: links and angles by the constraint oracle, air as in the first lines of
// engine/kernels/ring_air.c, damping as in modules/cloth/cloth_damping.c; one pass per substep.
#include "accuracy_references.h"
#include "converge.h"

#include "accuracy/flag_in_wind.h"
#include "oracle/constraint_oracle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
    SUBSTEPS = 10240, // of each 1/60 s
};

#define STEP ( 1.0 / 60.0 ) // s
#define TOLERANCE 2e-3      // m

/// A flag that moves, by slots of the fabric.
typedef struct flag_run
{
    const wisp_fabric* fabric;
    wisp_cloth_def def;
    int count;
    double3 *x, *before, *v, *pull; // [count] m, m, m/s, N
    double *weight, *rate;          // [count] 1/kg; N s/m, coupling of a vertex to the wind
    double* rest;                   // [edge_count] m
    double* angle_compliance;       // [hinge_count] 1/J
} flag_run;

static double3 widen( wisp_vec3 p )
{
    return double3_make( (double)p.x, (double)p.y, (double)p.z );
}

// ---- the flag ----

static void free_run( flag_run* run )
{
    free( run->x );
    free( run->before );
    free( run->v );
    free( run->pull );
    free( run->weight );
    free( run->rate );
    free( run->rest );
    free( run->angle_compliance );
}

static wisp_status make_room( flag_run* run, wisp_error* error )
{
    const wisp_fabric* f = run->fabric;
    const size_t n = (size_t)run->count;
    run->x = calloc( n, sizeof( double3 ) );
    run->before = calloc( n, sizeof( double3 ) );
    run->v = calloc( n, sizeof( double3 ) );
    run->pull = calloc( n, sizeof( double3 ) );
    run->weight = calloc( n, sizeof( double ) );
    run->rate = calloc( n, sizeof( double ) );
    run->rest = calloc( (size_t)f->edge_count, sizeof( double ) );
    run->angle_compliance = calloc( (size_t)f->hinge_count, sizeof( double ) );
    return run->x && run->before && run->v && run->pull && run->weight && run->rate && run->rest &&
                   run->angle_compliance
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "no memory for a flag in double precision" );
}

// Twice the area of a triangle, as a vector.
static double3 area_vector( double3 a, double3 b, double3 c )
{
    return double3_cross( double3_sub( b, a ), double3_sub( c, a ) );
}

// The energy of an angle t over an edge e whose triangles have the total area A is 1/2 B e^2 t^2 / A.
static double angle_compliance_of( const double3* x, const int32_t* hinge, double rigidity )
{
    const double3 i = x[hinge[0]], j = x[hinge[1]], k = x[hinge[2]], l = x[hinge[3]];
    const double edge = double3_distance( i, j );
    const double area = 0.5 * ( double3_length( area_vector( i, j, k ) ) + double3_length( area_vector( j, i, l ) ) );
    return area / ( rigidity * edge * edge );
}

static void hang_up( const flag_body* body, flag_run* run )
{
    const wisp_fabric* f = run->fabric;
    for ( int i = 0; i < run->count; ++i )
    {
        run->x[i] = widen( f->rest[i] );
        run->weight[i] = 1.0 / ( (double)FLAG_DENSITY * (double)f->area[i] );
    }
    for ( int row = 0; row < FLAG_ROWS; ++row )
    {
        run->weight[f->vertex_slot[body->pins[row]]] = 0.0;
    }
    for ( int e = 0; e < f->edge_count; ++e )
    {
        run->rest[e] = double3_distance( run->x[f->edges[2 * e]], run->x[f->edges[2 * e + 1]] );
    }
    for ( int h = 0; h < f->hinge_count; ++h )
    {
        run->angle_compliance[h] = angle_compliance_of( run->x, f->hinges + 4 * h, (double)run->def.bend_rigidity );
    }
}

// ---- a substep ----

// A triangle of area A with unit normal n and mean velocity v, u = wind - v, has the force F = 1/2 rho A |u.n| ( C_d
// u + C_l ( |u| n' - (u.n') / |u| u ) ), n' = n turned to the leeward side; a third for each corner.
static void blow_on( flag_run* run, const int32_t* corner )
{
    const wisp_cloth_def* def = &run->def;
    const double3 twice = area_vector( run->x[corner[0]], run->x[corner[1]], run->x[corner[2]] );
    const double3 sum = double3_add( run->v[corner[0]], double3_add( run->v[corner[1]], run->v[corner[2]] ) );
    const double3 u = double3_sub( widen( def->wind ), double3_scale( 1.0 / 3.0, sum ) );
    const double size = double3_length( twice ), speed = double3_length( u );
    if ( size == 0.0 || speed == 0.0 )
    {
        return;
    }
    const double facing = double3_dot( u, twice ) / size, pressing = fabs( facing );
    const double3 n = double3_scale( copysign( 1.0, facing ) / size, twice );
    const double pressure = 0.25 * (double)def->air_density * size * pressing;
    const double3 lift = double3_sub( double3_scale( speed, n ), double3_scale( pressing / speed, u ) );
    const double3 force =
        double3_scale( pressure / 3.0, double3_add( double3_scale( (double)def->drag_coefficient, u ),
                                                    double3_scale( (double)def->lift_coefficient, lift ) ) );
    for ( int k = 0; k < 3; ++k )
    {
        run->pull[corner[k]] = double3_add( run->pull[corner[k]], force );
        run->rate[corner[k]] += pressure * (double)( def->drag_coefficient + def->lift_coefficient ) / 3.0;
    }
}

// Implicit in its own rate, as in the engine; shorter substeps bring both to the same limit.
static void blow( flag_run* run, double h )
{
    for ( int i = 0; i < run->count; ++i )
    {
        run->pull[i] = double3_make( 0.0, 0.0, 0.0 );
        run->rate[i] = 0.0;
    }
    for ( int t = 0; t < run->fabric->triangle_count; ++t )
    {
        blow_on( run, run->fabric->triangles + 3 * t );
    }
    for ( int i = 0; i < run->count; ++i )
    {
        const double reach = h * run->weight[i];
        run->v[i] = double3_add( run->v[i], double3_scale( reach / ( 1.0 + reach * run->rate[i] ), run->pull[i] ) );
    }
}

static void project( flag_run* run, double h )
{
    const wisp_fabric* f = run->fabric;
    constraint_oracle_skips skips = { { 0 } };
    const double edge_alpha = (double)run->def.warp_compliance / ( h * h );
    for ( int e = 0; e < f->edge_count; ++e )
    {
        const int* ends = f->edges + 2 * e;
        const constraint_oracle_term term =
            constraint_oracle_distance( run->x[ends[0]], run->x[ends[1]], run->rest[e] );
        double lambda = 0.0;
        constraint_oracle_project_compliant( &term, ends, run->weight, edge_alpha, &lambda, run->x, &skips );
    }
    for ( int k = 0; k < f->hinge_count; ++k )
    {
        const int* corners = f->hinges + 4 * k;
        const double3 p[4] = { run->x[corners[0]], run->x[corners[1]], run->x[corners[2]], run->x[corners[3]] };
        const constraint_oracle_term term = constraint_oracle_dihedral( p, 0.0 );
        double lambda = 0.0;
        constraint_oracle_project_compliant( &term, corners, run->weight, run->angle_compliance[k] / ( h * h ),
                                             &lambda, run->x, &skips );
    }
}

// A flag pinned at one side does not move as a whole, so all of its velocity is damped.
static void advance( flag_run* run, double h )
{
    const double keep = 1.0 / ( 1.0 + (double)run->def.internal_damping * h );
    blow( run, h );
    for ( int i = 0; i < run->count; ++i )
    {
        run->before[i] = run->x[i];
        if ( run->weight[i] > 0.0 )
        {
            run->v[i].y -= h * (double)FLAG_GRAVITY;
            run->x[i] = double3_add( run->x[i], double3_scale( h, run->v[i] ) );
        }
    }
    project( run, h );
    for ( int i = 0; i < run->count; ++i )
    {
        run->v[i] = double3_scale( keep / h, double3_sub( run->x[i], run->before[i] ) );
    }
}

// ---- a run ----

static void keep_path( const flag_run* run, int observation, double* numbers )
{
    numbers += 3 * observation * FLAG_VERTICES;
    for ( int i = 0; i < FLAG_VERTICES; ++i )
    {
        const double3 p = run->x[run->fabric->vertex_slot[i]];
        *numbers++ = p.x;
        *numbers++ = p.y;
        *numbers++ = p.z;
    }
}

static double kinetic_energy( const flag_run* run )
{
    double sum = 0.0;
    for ( int i = 0; i < run->count; ++i )
    {
        sum += run->weight[i] > 0.0 ? 0.5 / run->weight[i] * double3_dot( run->v[i], run->v[i] ) : 0.0;
    }
    return sum;
}

// Only the coarsest run continues: the average after the compared path is of chaotic motion, and no more accurate
// than that.
static wisp_status run_flag( void* context, int substeps, double* numbers, wisp_error* error )
{
    const flag_body* body = context;
    flag_run run = { .fabric = body->fabric, .def = flag_cloth(), .count = body->fabric->vertex_count };
    wisp_status status = make_room( &run, error );
    if ( status == WISP_OK )
    {
        const int steps = substeps == SUBSTEPS / 4 ? FLAG_STEPS : FLAG_EARLY_STEPS;
        hang_up( body, &run );
        for ( int step = 1; step <= steps; ++step )
        {
            for ( int s = 0; s < substeps; ++s )
            {
                advance( &run, STEP / substeps );
            }
            if ( step > FLAG_EARLY_STEPS )
            {
                numbers[FLAG_PATH] += kinetic_energy( &run ) / ( FLAG_STEPS - FLAG_EARLY_STEPS );
            }
            else if ( step % FLAG_OBSERVATION_STEPS == 0 )
            {
                keep_path( &run, step / FLAG_OBSERVATION_STEPS - 1, numbers );
            }
        }
    }
    free_run( &run );
    return status;
}

wisp_status reference_of_flag( accuracy_reference* out, wisp_error* error )
{
    flag_body body;
    wisp_status status = flag_make( &body, error );
    if ( status == WISP_OK )
    {
        *out = flag_reference( &body );
        const converge_plan plan = { .run = run_flag,
                                     .context = &body,
                                     .unit = "substeps",
                                     .substeps = SUBSTEPS,
                                     .compared = FLAG_PATH,
                                     .dimension = 3,
                                     .converging = FLAG_PATH,
                                     .tolerance = TOLERANCE };
        snprintf( out->reference, sizeof( out->reference ),
                  "the same flag by xpbd of one pass in double precision, at %d observations within 0.2 s",
                  FLAG_OBSERVATIONS );
        snprintf( out->solver, sizeof( out->solver ),
                  "xpbd, one pass a substep, bending by angle (tests/oracle/constraint_oracle.h); substeps are of "
                  "1/60 s" );
        snprintf( out->precision, sizeof( out->precision ), "double" );
        snprintf( out->layout, sizeof( out->layout ),
                  "float64 [%d observations][%d vertices][x, y, z], m; then the mean kinetic energy from 0.2 to 1 s, "
                  "J, with "
                  "%d substeps",
                  FLAG_OBSERVATIONS, FLAG_VERTICES, SUBSTEPS / 4 );
        status = converge( &plan, out, error );
    }
    flag_free( &body );
    return status;
}
