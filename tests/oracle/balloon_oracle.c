#include "balloon_oracle.h"

#include <stdlib.h>
#include <string.h>

static const double3 zero = { 0.0, 0.0, 0.0 };

// Rigid motion.

static double3 balloon_oracle_apply( const balloon_oracle_matrix* matrix, double3 v )
{
    const double( *m )[3] = matrix->m;
    return double3_make( m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
                         m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z );
}

static balloon_oracle_matrix multiply( const balloon_oracle_matrix* a, const balloon_oracle_matrix* b,
                                       bool transpose_a )
{
    balloon_oracle_matrix c = { { { 0.0 } } };
    for ( int i = 0; i < 3; ++i )
    {
        for ( int j = 0; j < 3; ++j )
        {
            for ( int k = 0; k < 3; ++k )
            {
                c.m[i][j] += ( transpose_a ? a->m[k][i] : a->m[i][k] ) * b->m[k][j];
            }
        }
    }
    return c;
}

// One Jacobi rotation in the plane (p, q) makes that element zero.
static void rotate_plane( balloon_oracle_matrix* a, balloon_oracle_matrix* axes, int p, int q )
{
    if ( a->m[p][q] == 0.0 )
    {
        return;
    }
    double angle = 0.5 * atan2( 2.0 * a->m[p][q], a->m[q][q] - a->m[p][p] );
    balloon_oracle_matrix r = { { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } } };
    r.m[p][p] = r.m[q][q] = cos( angle );
    r.m[p][q] = sin( angle );
    r.m[q][p] = -sin( angle );
    balloon_oracle_matrix ar = multiply( a, &r, false );
    *a = multiply( &r, &ar, true );
    a->m[p][q] = a->m[q][p] = 0.0;
    *axes = multiply( axes, &r, false );
}

// Eigenvalues of a symmetric matrix (cyclic Jacobi).
// @param axes receives the unit eigenvectors, one per column
static double3 balloon_oracle_eigen( const balloon_oracle_matrix* symmetric, balloon_oracle_matrix* axes )
{
    balloon_oracle_matrix a = *symmetric;
    *axes = ( balloon_oracle_matrix ){ { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } } };
    // convergence is quadratic: five sweeps reach rounding, eight are a safe number
    for ( int sweep = 0; sweep < 8; ++sweep )
    {
        rotate_plane( &a, axes, 0, 1 );
        rotate_plane( &a, axes, 0, 2 );
        rotate_plane( &a, axes, 1, 2 );
    }
    return double3_make( a.m[0][0], a.m[1][1], a.m[2][2] );
}

// Pseudo-inverse of a symmetric matrix. Eigenvalues below 1e-12 of the largest count as 0, so a body whose vertices
// are on a line has no spin about it.
static balloon_oracle_matrix balloon_oracle_pseudo_inverse( const balloon_oracle_matrix* symmetric )
{
    balloon_oracle_matrix axes, inverse = { { { 0.0 } } };
    double3 eigen = balloon_oracle_eigen( symmetric, &axes );
    const double value[3] = { eigen.x, eigen.y, eigen.z };
    double largest = fmax( fabs( value[0] ), fmax( fabs( value[1] ), fabs( value[2] ) ) );
    for ( int k = 0; k < 3; ++k )
    {
        if ( fabs( value[k] ) <= 1e-12 * largest )
        {
            continue;
        }
        for ( int i = 0; i < 3; ++i )
        {
            for ( int j = 0; j < 3; ++j )
            {
                inverse.m[i][j] += axes.m[i][k] * axes.m[j][k] / value[k];
            }
        }
    }
    return inverse;
}

static balloon_oracle_quaternion product( balloon_oracle_quaternion a, balloon_oracle_quaternion b )
{
    balloon_oracle_quaternion c = {
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
    };
    return c;
}

balloon_oracle_quaternion balloon_oracle_turn( balloon_oracle_quaternion q, double3 omega, double dt )
{
    balloon_oracle_quaternion rate = product( ( balloon_oracle_quaternion ){ 0.0, omega.x, omega.y, omega.z }, q );
    balloon_oracle_quaternion next = { q.w + 0.5 * dt * rate.w, q.x + 0.5 * dt * rate.x, q.y + 0.5 * dt * rate.y,
                                       q.z + 0.5 * dt * rate.z };
    double norm = sqrt( next.w * next.w + next.x * next.x + next.y * next.y + next.z * next.z );
    return ( balloon_oracle_quaternion ){ next.w / norm, next.x / norm, next.y / norm, next.z / norm };
}

double3 balloon_oracle_rotate( balloon_oracle_quaternion q, double3 v )
{
    balloon_oracle_quaternion conjugate = { q.w, -q.x, -q.y, -q.z };
    balloon_oracle_quaternion turned =
        product( product( q, ( balloon_oracle_quaternion ){ 0.0, v.x, v.y, v.z } ), conjugate );
    return double3_make( turned.x, turned.y, turned.z );
}

double balloon_oracle_angle( balloon_oracle_quaternion q )
{
    return 2.0 * atan2( sqrt( q.x * q.x + q.y * q.y + q.z * q.z ), fabs( q.w ) );
}

// Eq. 1-2.

double3 balloon_oracle_predict( double3 x, double3* v, double w, double3 force, double dt )
{
    *v = double3_add_scaled( *v, dt * w, force );
    return double3_add_scaled( x, dt, *v );
}

double3 balloon_oracle_velocity( double3 x, double3 p, double dt )
{
    return double3_scale( 1.0 / dt, double3_sub( p, x ) );
}

// Geometry of the skin.

static double3 area_vector( const double3* x, const int* corner )
{
    double3 a = x[corner[0]];
    return double3_scale( 0.5, double3_cross( double3_sub( x[corner[1]], a ), double3_sub( x[corner[2]], a ) ) );
}

void balloon_oracle_masses( const double3* x, int vertex_count, const int* triangles, int triangle_count,
                            double areal_density, double* mass )
{
    for ( int i = 0; i < vertex_count; ++i )
    {
        mass[i] = 0.0;
    }
    for ( int n = 0; n < 3 * triangle_count; ++n )
    {
        mass[triangles[n]] += areal_density * double3_length( area_vector( x, triangles + n - n % 3 ) ) / 3.0;
    }
}

int balloon_oracle_skin( const double3* x, int vertex_count, const int* triangles, int triangle_count,
                         double3* normal, double* area )
{
    for ( int i = 0; i < vertex_count; ++i )
    {
        normal[i] = zero;
        area[i] = 0.0;
    }
    for ( int n = 0; n < 3 * triangle_count; ++n )
    {
        double3 s = area_vector( x, triangles + n - n % 3 );
        normal[triangles[n]] = double3_add( normal[triangles[n]], s );
        area[triangles[n]] += double3_length( s ) / 3.0;
    }
    int zero_count = 0;
    for ( int i = 0; i < vertex_count; ++i )
    {
        double length = double3_length( normal[i] );
        bool cancelled = length <= 1e-12 * 3.0 * area[i];
        normal[i] = cancelled ? zero : double3_scale( 1.0 / length, normal[i] );
        zero_count += cancelled ? 1 : 0;
    }
    return zero_count;
}

double3 balloon_oracle_centre( const double3* x, const double* mass, int vertex_count )
{
    double3 sum = zero;
    double total = 0.0;
    for ( int i = 0; i < vertex_count; ++i )
    {
        // differences from the first vertex: a body far from the origin keeps its digits
        sum = double3_add_scaled( sum, mass[i], double3_sub( x[i], x[0] ) );
        total += mass[i];
    }
    return double3_add_scaled( x[0], 1.0 / total, sum );
}

balloon_oracle_matrix balloon_oracle_inertia( const double3* x, const double* mass, int vertex_count, double3 centre )
{
    balloon_oracle_matrix inertia = { { { 0.0 } } };
    for ( int n = 0; n < vertex_count; ++n )
    {
        double3 d = double3_sub( x[n], centre );
        const double r[3] = { d.x, d.y, d.z };
        for ( int i = 0; i < 3; ++i )
        {
            for ( int j = 0; j < 3; ++j )
            {
                inertia.m[i][j] += mass[n] * ( ( i == j ? double3_dot( d, d ) : 0.0 ) - r[i] * r[j] );
            }
        }
    }
    return inertia;
}

double3 balloon_oracle_momentum( const double3* v, const double* mass, int vertex_count )
{
    double3 sum = zero;
    for ( int i = 0; i < vertex_count; ++i )
    {
        sum = double3_add_scaled( sum, mass[i], v[i] );
    }
    return sum;
}

double3 balloon_oracle_angular_momentum( const double3* x, const double3* v, const double* mass, int vertex_count,
                                         double3 centre )
{
    double3 sum = zero;
    for ( int i = 0; i < vertex_count; ++i )
    {
        sum = double3_add_scaled( sum, mass[i], double3_cross( double3_sub( x[i], centre ), v[i] ) );
    }
    return sum;
}

// Open meshes.

void balloon_oracle_destroy_caps( balloon_oracle_caps* caps )
{
    free( caps->triangles );
    free( caps->hub );
    free( caps->size );
    free( caps->x );
    free( caps->gradient );
    *caps = ( balloon_oracle_caps ){ 0 };
}

bool balloon_oracle_make_caps( const balloon_mesh* mesh, balloon_oracle_caps* out )
{
    int n = mesh->vertex_count;
    balloon_mesh capped = { 0 };
    *out = ( balloon_oracle_caps ){ .hub = calloc( (size_t)n + 1, sizeof( int ) ) };
    if ( out->hub == NULL || !balloon_mesh_cap( mesh, &capped, out->hub ) )
    {
        balloon_oracle_destroy_caps( out );
        return false;
    }
    out->vertex_count = capped.vertex_count;
    out->triangle_count = capped.triangle_count;
    out->hub_count = capped.vertex_count - n;
    out->triangles = capped.triangles;
    out->x = capped.positions;
    out->size = calloc( (size_t)out->hub_count + 1, sizeof( int ) );
    out->gradient = calloc( (size_t)out->vertex_count + 1, sizeof( double3 ) );
    if ( out->size == NULL || out->gradient == NULL )
    {
        balloon_oracle_destroy_caps( out );
        return false;
    }
    for ( int v = 0; v < n; ++v )
    {
        if ( out->hub[v] >= 0 )
        {
            out->size[out->hub[v] - n] += 1;
        }
    }
    return true;
}

static void place_hubs( balloon_oracle_caps* caps, const double3* p )
{
    int n = caps->vertex_count - caps->hub_count;
    memcpy( caps->x, p, (size_t)n * sizeof( double3 ) );
    for ( int h = n; h < caps->vertex_count; ++h )
    {
        caps->x[h] = p[0]; // differences from a vertex: a body far from the origin keeps its digits
    }
    for ( int v = 0; v < n; ++v )
    {
        if ( caps->hub[v] >= 0 )
        {
            double3* hub = caps->x + caps->hub[v];
            *hub = double3_add_scaled( *hub, 1.0 / caps->size[caps->hub[v] - n], double3_sub( p[v], p[0] ) );
        }
    }
}

double balloon_oracle_capped_volume( balloon_oracle_caps* caps, const double3* p )
{
    place_hubs( caps, p );
    return constraint_oracle_volume( caps->x, caps->triangles, caps->triangle_count );
}

void balloon_oracle_capped_gradient( balloon_oracle_caps* caps, const double3* p, double3* gradient )
{
    int n = caps->vertex_count - caps->hub_count;
    place_hubs( caps, p );
    constraint_oracle_volume_gradient( caps->x, caps->vertex_count, caps->triangles, caps->triangle_count,
                                       caps->gradient );
    for ( int v = 0; v < n; ++v )
    {
        int hub = caps->hub[v];
        gradient[v] = hub < 0
                          ? caps->gradient[v]
                          : double3_add_scaled( caps->gradient[v], 1.0 / caps->size[hub - n], caps->gradient[hub] );
    }
}

void balloon_oracle_project_capped( balloon_oracle_caps* caps, double3* p, const double* w, double target,
                                    double stiffness, double alpha, double* lambda, double3* gradient,
                                    constraint_oracle_skips* skips )
{
    int n = caps->vertex_count - caps->hub_count;
    double error = balloon_oracle_capped_volume( caps, p ) - target, sum = 0.0, all = 0.0;
    balloon_oracle_capped_gradient( caps, p, gradient );
    for ( int i = 0; i < n; ++i )
    {
        sum += w[i] * double3_dot( gradient[i], gradient[i] );
        all += double3_dot( gradient[i], gradient[i] );
    }
    if ( sum == 0.0 )
    {
        skips->count[all == 0.0 ? CONSTRAINT_ORACLE_ZERO_GRADIENT : CONSTRAINT_ORACLE_PINNED] += 1;
        return;
    }
    double delta = -stiffness * ( error + alpha * *lambda ) / ( sum + alpha );
    *lambda += delta;
    for ( int i = 0; i < n; ++i )
    {
        p[i] = double3_add_scaled( p[i], delta * w[i], gradient[i] );
    }
}

// Eq. 9.

double balloon_oracle_density( double pressure, double molar_mass, double temperature )
{
    return pressure * molar_mass / ( BALLOON_ORACLE_GAS_CONSTANT * temperature );
}

// P = N R T / V, Pa.
static double balloon_oracle_gas_pressure( double amount, double volume, double temperature )
{
    return amount * BALLOON_ORACLE_GAS_CONSTANT * temperature / volume;
}

double balloon_oracle_gas_pressure_printed( double added_volume, double volume, double temperature )
{
    return balloon_oracle_gas_pressure( added_volume, volume, temperature );
}

double balloon_oracle_virial( const double3* x, const balloon_oracle_link* links, int link_count,
                              double edge_stiffness )
{
    double sum = 0.0;
    for ( int e = 0; e < link_count; ++e )
    {
        double length = double3_distance( x[links[e].a], x[links[e].b] );
        sum += edge_stiffness * ( length - links[e].rest ) * length;
    }
    return sum;
}

// Eq. 10-11.

double3 balloon_oracle_buoyancy( double3 gravity, double volume, double air_density, double gas_density )
{
    return double3_scale( -volume * ( air_density - gas_density ), gravity );
}

double3 balloon_oracle_drag_force( balloon_oracle_drag drag, double coefficient, double3 v, double3 normal,
                                   double limit_rate )
{
    double speed = double3_length( v );
    if ( speed == 0.0 )
    {
        return zero;
    }
    double along = double3_dot( v, normal ) / speed; // cosine of motion and normal
    double c = coefficient;
    switch ( drag )
    {
        case BALLOON_ORACLE_DRAG_MAX:
            c *= fmax( 0.0, along );
            break;
        case BALLOON_ORACLE_DRAG_SIGNED:
            c *= along;
            break;
        case BALLOON_ORACLE_DRAG_ABS:
            c *= fabs( along );
            break;
        case BALLOON_ORACLE_DRAG_NORMAL:
            break;
    }
    double limit = 1.0 + fabs( c ) * speed * limit_rate;
    double3 against = drag == BALLOON_ORACLE_DRAG_NORMAL ? double3_scale( speed * along, normal ) : v;
    return double3_scale( -c * speed / limit, against );
}

// Eq. 12.

double balloon_oracle_outlet_speed( double gauge_pressure, double gas_density )
{
    return sqrt( 2.0 * fmax( 0.0, gauge_pressure ) / gas_density );
}

double balloon_oracle_outlet_speed_printed( double start_pressure, double pressure, double gas_density )
{
    return balloon_oracle_outlet_speed( start_pressure - pressure, gas_density );
}

double balloon_oracle_mass_flow( double gas_density, double outlet_area, double speed )
{
    return gas_density * outlet_area * speed;
}

double3 balloon_oracle_reaction( double mass_flow, double speed, double3 outlet_normal )
{
    return double3_scale( -mass_flow * speed, outlet_normal );
}

bool balloon_oracle_jet_runs( bool running, double gauge_pressure, double atmosphere, double close, double open )
{
    return gauge_pressure > ( running ? close : open ) * atmosphere;
}

// Eq. 13-14.

double3 balloon_oracle_torque( double3 outlet, double3 centre, double3 force )
{
    return double3_cross( double3_sub( outlet, centre ), force );
}

double3 balloon_oracle_spin_increment( const balloon_oracle_matrix* inertia, double3 torque, double dt )
{
    balloon_oracle_matrix inverse = balloon_oracle_pseudo_inverse( inertia );
    return double3_scale( dt, balloon_oracle_apply( &inverse, torque ) );
}

void balloon_oracle_spin_kick( const double3* x, double3* v, const double* w, int vertex_count, double3 centre,
                               double3 increment )
{
    for ( int i = 0; i < vertex_count; ++i )
    {
        if ( w[i] > 0.0 )
        {
            v[i] = double3_add( v[i], double3_cross( increment, double3_sub( x[i], centre ) ) );
        }
    }
}

// Closed forms.

double balloon_oracle_true_scaled_pressure( double sum_k_length_squared, double rest_volume, double scale )
{
    return sum_k_length_squared * ( scale - 1.0 ) / ( 3.0 * rest_volume * scale * scale );
}

double balloon_oracle_true_shell_inertia( double mass, double radius )
{
    return 2.0 / 3.0 * mass * radius * radius;
}
