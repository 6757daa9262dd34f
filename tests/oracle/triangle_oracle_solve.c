// A = M - s D - s^2 K, conjugate gradients with a filter, elimination, and the substep: Noh and Jung, Eq. 16-17,
// solved as in their section 4.
#include "triangle_oracle.h"

#include <stdlib.h>
#include <string.h>

static double3* new_vectors( const triangle_oracle* cloth )
{
    return calloc( (size_t)cloth->count, sizeof( double3 ) );
}

static void copy_vectors( const triangle_oracle* cloth, double3* to, const double3* from )
{
    memcpy( to, from, (size_t)cloth->count * sizeof( double3 ) );
}

static double dot( const triangle_oracle* cloth, const double3* a, const double3* b )
{
    double sum = 0.0;
    for ( int i = 0; i < cloth->count; ++i )
    {
        sum += double3_dot( a[i], b[i] );
    }
    return sum;
}

// ---- small matrices ----

static double3 times( const triangle_oracle_matrix* a, double3 v )
{
    return double3_make( a->m[0][0] * v.x + a->m[0][1] * v.y + a->m[0][2] * v.z,
                         a->m[1][0] * v.x + a->m[1][1] * v.y + a->m[1][2] * v.z,
                         a->m[2][0] * v.x + a->m[2][1] * v.y + a->m[2][2] * v.z );
}

static double3 row_of( const triangle_oracle_matrix* a, int row )
{
    return double3_make( a->m[row][0], a->m[row][1], a->m[row][2] );
}

// By cofactors.
static triangle_oracle_matrix inverse( const triangle_oracle_matrix* a )
{
    const double3 r[3] = { row_of( a, 0 ), row_of( a, 1 ), row_of( a, 2 ) };
    const double determinant = double3_dot( r[0], double3_cross( r[1], r[2] ) );
    triangle_oracle_matrix out;
    for ( int n = 0; n < 3; ++n )
    {
        const double3 column =
            double3_scale( 1.0 / determinant, double3_cross( r[( n + 1 ) % 3], r[( n + 2 ) % 3] ) );
        out.m[0][n] = column.x;
        out.m[1][n] = column.y;
        out.m[2][n] = column.z;
    }
    return out;
}

static bool is_free( const triangle_oracle_matrix* freedom )
{
    return freedom->m[0][0] == 1.0 && freedom->m[1][1] == 1.0 && freedom->m[2][2] == 1.0;
}

// ---- A ----

void triangle_oracle_assemble( triangle_oracle* cloth, const double3* x, double s )
{
    cloth->s = s;
    cloth->coincident = 0;
    for ( int k = 0; k < cloth->link_count; ++k )
    {
        cloth->term[k] = triangle_oracle_term_at( cloth, k, x );
        cloth->coincident += cloth->term[k].length > 0.0 ? 0 : 1;
    }
}

// Contribution of a link to its blocks of A: K1' d d' + K2' (1 - d d').
static triangle_oracle_matrix block_of( const triangle_oracle* cloth, int k )
{
    const triangle_oracle_term* t = cloth->term + k;
    const double s = cloth->s;
    const double rate = t->length > 0.0 ? cloth->link[k].scale * cloth->link[k].damping : 0.0;
    const double along = s * s * t->k1 + s * rate;
    const double across = s * s * t->k2 + s * rate;
    const double d[3] = { t->direction.x, t->direction.y, t->direction.z };
    triangle_oracle_matrix block;
    for ( int a = 0; a < 3; ++a )
    {
        for ( int b = 0; b < 3; ++b )
        {
            block.m[a][b] = ( along - across ) * ( d[a] * d[b] ) + ( a == b ? across : 0.0 );
        }
    }
    return block;
}

// What a pair of the plate adds: s^2 D weight, the same in every direction.
static double plate_weight( const triangle_oracle* cloth, const plate_oracle_pair* pair )
{
    return cloth->s * cloth->s * cloth->params.bend_rigidity * pair->stiffness;
}

// A times a vector, [count].
static void triangle_oracle_apply( const triangle_oracle* cloth, const double3* vector, double3* out )
{
    for ( int i = 0; i < cloth->count; ++i )
    {
        out[i] = double3_scale( cloth->mass[i], vector[i] );
    }
    for ( int k = 0; k < cloth->link_count; ++k )
    {
        const int i = cloth->link[k].i, j = cloth->link[k].j;
        const triangle_oracle_matrix block = block_of( cloth, k );
        const double3 force = times( &block, double3_sub( vector[i], vector[j] ) );
        out[i] = double3_add( out[i], force );
        out[j] = double3_sub( out[j], force );
    }
    for ( int n = 0; n < cloth->plate.pair_count; ++n )
    {
        const plate_oracle_pair* p = cloth->plate.pairs + n;
        const double3 force = double3_scale( plate_weight( cloth, p ), double3_sub( vector[p->i], vector[p->j] ) );
        out[p->i] = double3_add( out[p->i], force );
        out[p->j] = double3_sub( out[p->j], force );
    }
}

// ---- conjugate gradients ----

static void filter( const triangle_oracle* cloth, double3* vector )
{
    for ( int i = 0; i < cloth->count; ++i )
    {
        vector[i] = times( cloth->freedom + i, vector[i] );
    }
}

// P, the inverse blocks of the diagonal.
static triangle_oracle_matrix* new_preconditioner( const triangle_oracle* cloth )
{
    triangle_oracle_matrix* p = calloc( (size_t)cloth->count, sizeof( triangle_oracle_matrix ) );
    for ( int i = 0; i < cloth->count; ++i )
    {
        p[i].m[0][0] = p[i].m[1][1] = p[i].m[2][2] = cloth->mass[i];
    }
    for ( int k = 0; k < cloth->link_count; ++k )
    {
        const triangle_oracle_matrix block = block_of( cloth, k );
        for ( int n = 0; n < 9; ++n )
        {
            p[cloth->link[k].i].m[n / 3][n % 3] += block.m[n / 3][n % 3];
            p[cloth->link[k].j].m[n / 3][n % 3] += block.m[n / 3][n % 3];
        }
    }
    for ( int n = 0; n < 3 * cloth->plate.pair_count; ++n )
    {
        const plate_oracle_pair* pair = cloth->plate.pairs + n / 3;
        p[pair->i].m[n % 3][n % 3] += plate_weight( cloth, pair );
        p[pair->j].m[n % 3][n % 3] += plate_weight( cloth, pair );
    }
    for ( int i = 0; i < cloth->count; ++i )
    {
        p[i] = inverse( p + i );
    }
    return p;
}

// s = S P S r
static void precondition( const triangle_oracle* cloth, const triangle_oracle_matrix* p, const double3* r,
                          double3* s )
{
    for ( int i = 0; i < cloth->count; ++i )
    {
        s[i] = times( cloth->freedom + i, times( p + i, times( cloth->freedom + i, r[i] ) ) );
    }
}

// dv = z + S dv
static void take_prescribed( const triangle_oracle* cloth, const double3* z, double3* dv )
{
    for ( int i = 0; i < cloth->count; ++i )
    {
        const double3 free_part = double3_sub( dv[i], z[i] );
        dv[i] = double3_add( z[i], times( cloth->freedom + i, free_part ) );
    }
}

// J = -(1 - S) r
static void take_impulse( triangle_oracle* cloth, const double3* r )
{
    for ( int i = 0; i < cloth->count; ++i )
    {
        cloth->impulse[i] = double3_sub( times( cloth->freedom + i, r[i] ), r[i] );
    }
}

static void residual_of( const triangle_oracle* cloth, const double3* b, const double3* dv, double3* r )
{
    triangle_oracle_apply( cloth, dv, r );
    for ( int i = 0; i < cloth->count; ++i )
    {
        r[i] = double3_sub( b[i], r[i] );
    }
}

static void combine( const triangle_oracle* cloth, double3* a, double scale, const double3* b )
{
    for ( int i = 0; i < cloth->count; ++i )
    {
        a[i] = double3_add_scaled( a[i], scale, b[i] );
    }
}

void triangle_oracle_solve( triangle_oracle* cloth, const double3* b, const double3* z, double3* dv )
{
    const int limit = cloth->params.max_iterations > 0 ? cloth->params.max_iterations
                                                       : ( cloth->count > 34 ? 3 * cloth->count : 100 );
    triangle_oracle_matrix* p = new_preconditioner( cloth );
    double3 *r = new_vectors( cloth ), *c = new_vectors( cloth ), *q = new_vectors( cloth ),
            *s = new_vectors( cloth );

    precondition( cloth, p, b, s );
    double delta_0 = dot( cloth, b, s );
    take_prescribed( cloth, z, dv );
    residual_of( cloth, b, dv, r );
    precondition( cloth, p, r, s );
    copy_vectors( cloth, c, s );
    double delta = dot( cloth, r, s );
    delta_0 = delta_0 == 0.0 ? delta : delta_0;
    const double enough = cloth->params.tolerance * cloth->params.tolerance * delta_0;

    int done = 0;
    // an indefinite P is reported here, before any direction shows it
    bool negative = !( delta_0 >= 0.0 && delta >= 0.0 );
    for ( ; delta > enough && done < limit && !negative; ++done )
    {
        triangle_oracle_apply( cloth, c, q );
        const double curvature = dot( cloth, c, q );
        if ( !( curvature > 0.0 ) )
        {
            negative = true;
            break;
        }
        // r is kept whole: the part that contact absorbs is the impulse
        const double a = delta / curvature;
        combine( cloth, dv, a, c );
        combine( cloth, r, -a, q );
        precondition( cloth, p, r, s );
        const double delta_new = dot( cloth, r, s ), along = delta_new / delta;
        for ( int i = 0; i < cloth->count; ++i )
        {
            c[i] = double3_add_scaled( s[i], along, c[i] );
        }
        delta = delta_new;
        negative = !( delta >= 0.0 );
    }
    cloth->negative = cloth->negative || negative;
    cloth->limited = cloth->limited || ( delta > enough && done == limit );
    cloth->iterations += done;
    cloth->residual = delta_0 > 0.0 ? sqrt( fabs( delta / delta_0 ) ) : 0.0;
    take_impulse( cloth, r );
    free( p );
    free( r );
    free( c );
    free( q );
    free( s );
}

// ---- elimination ----

// Gauss elimination with column pivoting. @param matrix [n][n] by rows, overwritten
static void eliminate( double* matrix, double* right, size_t n )
{
    for ( size_t column = 0; column < n; ++column )
    {
        size_t pivot = column;
        for ( size_t row = column + 1; row < n; ++row )
        {
            pivot = fabs( matrix[row * n + column] ) > fabs( matrix[pivot * n + column] ) ? row : pivot;
        }
        for ( size_t k = 0; k < n; ++k )
        {
            const double swapped = matrix[column * n + k];
            matrix[column * n + k] = matrix[pivot * n + k];
            matrix[pivot * n + k] = swapped;
        }
        const double swapped = right[column];
        right[column] = right[pivot];
        right[pivot] = swapped;
        for ( size_t row = column + 1; row < n; ++row )
        {
            const double factor = matrix[row * n + column] / matrix[column * n + column];
            for ( size_t k = column; k < n && factor != 0.0; ++k )
            {
                matrix[row * n + k] -= factor * matrix[column * n + k];
            }
            right[row] -= factor * right[column];
        }
    }
    for ( size_t row = n; row-- > 0; )
    {
        for ( size_t k = row + 1; k < n; ++k )
        {
            right[row] -= matrix[row * n + k] * right[k];
        }
        right[row] /= matrix[row * n + row];
    }
}

// S A S + (1 - S), which is regular, column by column.
static double* new_filtered( const triangle_oracle* cloth )
{
    const size_t n = 3 * (size_t)cloth->count;
    double* matrix = calloc( n * n, sizeof( double ) );
    double3 *unit = new_vectors( cloth ), *image = new_vectors( cloth );
    for ( size_t column = 0; column < n; ++column )
    {
        memset( unit, 0, n * sizeof( double ) );
        const double3 axis = double3_make( column % 3 == 0, column % 3 == 1, column % 3 == 2 );
        unit[column / 3] = times( cloth->freedom + column / 3, axis );
        triangle_oracle_apply( cloth, unit, image );
        filter( cloth, image );
        image[column / 3] = double3_add( image[column / 3], double3_sub( axis, unit[column / 3] ) );
        for ( size_t i = 0; i < n / 3; ++i )
        {
            matrix[3 * i * n + column] = image[i].x;
            matrix[( 3 * i + 1 ) * n + column] = image[i].y;
            matrix[( 3 * i + 2 ) * n + column] = image[i].z;
        }
    }
    free( unit );
    free( image );
    return matrix;
}

void triangle_oracle_solve_dense( triangle_oracle* cloth, const double3* b, const double3* z, double3* dv )
{
    double* matrix = new_filtered( cloth );
    double3* r = new_vectors( cloth );
    memset( dv, 0, (size_t)cloth->count * sizeof( double3 ) );
    take_prescribed( cloth, z, dv );
    residual_of( cloth, b, dv, r );
    filter( cloth, r );
    double* right = calloc( 3 * (size_t)cloth->count, sizeof( double ) );
    memcpy( right, r, (size_t)cloth->count * sizeof( double3 ) );
    eliminate( matrix, right, 3 * (size_t)cloth->count );
    memcpy( r, right, (size_t)cloth->count * sizeof( double3 ) );
    filter( cloth, r );
    combine( cloth, dv, 1.0, r );
    residual_of( cloth, b, dv, r );
    take_impulse( cloth, r );
    cloth->residual = 0.0;
    free( right );
    free( matrix );
    free( r );
}

// ---- a substep ----

// x^ and v^. @return s, which replaces h
static double predict( const triangle_oracle* cloth, double h, double3* x_hat, double3* v_hat )
{
    const bool second = cloth->params.integrator == TRIANGLE_ORACLE_BDF2 && cloth->h_before > 0.0;
    const double w = second ? h / cloth->h_before : 0.0;
    const double now = ( 1.0 + w ) * ( 1.0 + w ) / ( 1.0 + 2.0 * w ), before = -w * w / ( 1.0 + 2.0 * w );
    const double s = second ? h * ( 1.0 + w ) / ( 1.0 + 2.0 * w ) : h;
    const double kept = 1.0 / ( 1.0 + cloth->params.drag * s );
    for ( int i = 0; i < cloth->count; ++i )
    {
        x_hat[i] = double3_add_scaled( double3_scale( now, cloth->x[i] ), before, cloth->x_before[i] );
        const double3 v = double3_add_scaled( double3_scale( now, cloth->v[i] ), before, cloth->v_before[i] );
        v_hat[i] = double3_add_scaled( double3_scale( kept, v ), s, cloth->params.gravity );
    }
    return s;
}

// The right side of the first solve: s f - (A - M) v^.
static void first_right( const triangle_oracle* cloth, const double3* x, const double3* v_hat, double3* b )
{
    double3* force = new_vectors( cloth );
    triangle_oracle_forces( cloth, x, force );
    triangle_oracle_apply( cloth, v_hat, b );
    for ( int i = 0; i < cloth->count; ++i )
    {
        b[i] = double3_sub( double3_scale( cloth->mass[i], v_hat[i] ), b[i] );
        b[i] = double3_add_scaled( b[i], cloth->s, force[i] );
    }
    free( force );
}

// Residual of the nonlinear step: M (v^ - v) + s f(x) + s D v.
static void missing( const triangle_oracle* cloth, double s, const double3* x, const double3* v_hat, const double3* v,
                     double3* b )
{
    double3 *force = new_vectors( cloth ), *damping = new_vectors( cloth );
    triangle_oracle_forces( cloth, x, force );
    triangle_oracle_damping_forces( cloth, x, v, damping );
    for ( int i = 0; i < cloth->count; ++i )
    {
        b[i] = double3_scale( cloth->mass[i], double3_sub( v_hat[i], v[i] ) );
        b[i] = double3_add_scaled( b[i], s, double3_add( force[i], damping[i] ) );
    }
    free( force );
    free( damping );
}

static double largest_missing( const triangle_oracle* cloth, const double3* b )
{
    double most = 0.0;
    for ( int i = 0; i < cloth->count; ++i )
    {
        if ( is_free( cloth->freedom + i ) )
        {
            most = fmax( most, double3_length( b[i] ) / cloth->mass[i] );
        }
    }
    return most;
}

// One linear solve: adds its change to v. @param repeat 0 linearises at x^ and v^
static void solve_once( triangle_oracle* cloth, int repeat, double s, const double3* x_hat, const double3* v_hat,
                        double3* v )
{
    double3 *x = new_vectors( cloth ), *b = new_vectors( cloth ), *z = new_vectors( cloth ),
            *dv = new_vectors( cloth );
    copy_vectors( cloth, x, x_hat );
    if ( repeat > 0 )
    {
        combine( cloth, x, s, v );
    }
    triangle_oracle_assemble( cloth, x, s );
    if ( repeat > 0 )
    {
        missing( cloth, s, x, v_hat, v, b );
    }
    else
    {
        first_right( cloth, x, v_hat, b );
    }
    for ( int i = 0; i < cloth->count; ++i )
    {
        const double3 whole = double3_sub( cloth->prescribed[i], v[i] );
        z[i] = double3_sub( whole, times( cloth->freedom + i, whole ) );
        b[i] = double3_add( b[i], cloth->push[i] );
    }
    // the change of a repeated solve is small and unrelated to the previous one
    if ( repeat == 0 )
    {
        copy_vectors( cloth, dv, cloth->change );
    }
    ( cloth->params.dense ? triangle_oracle_solve_dense : triangle_oracle_solve )( cloth, b, z, dv );
    combine( cloth, v, 1.0, dv );
    if ( repeat == 0 )
    {
        copy_vectors( cloth, cloth->change, dv );
    }
    free( x );
    free( b );
    free( z );
    free( dv );
}

// x+ = x^ + s v+; a pinned vertex is set to its target to the last digit.
static void advance( triangle_oracle* cloth, double h, double s, const double3* x_hat, const double3* v )
{
    copy_vectors( cloth, cloth->x_before, cloth->x );
    copy_vectors( cloth, cloth->v_before, cloth->v );
    for ( int i = 0; i < cloth->count; ++i )
    {
        cloth->v[i] = v[i];
        cloth->x[i] = cloth->pinned[i] ? cloth->target[i] : double3_add_scaled( x_hat[i], s, v[i] );
    }
    cloth->h_before = h;
}

void triangle_oracle_step( triangle_oracle* cloth, double h, const triangle_oracle_bodies* bodies )
{
    double3 *x_hat = new_vectors( cloth ), *v_hat = new_vectors( cloth ), *v = new_vectors( cloth );
    const double s = predict( cloth, h, x_hat, v_hat );
    triangle_oracle_contact_begin( cloth, h, s, x_hat, v_hat, bodies );
    for ( int i = 0; i < cloth->count; ++i )
    {
        if ( cloth->pinned[i] )
        {
            // velocity that takes it to its target: (target - x) / h for Euler
            const double3 way = double3_sub( cloth->target[i], x_hat[i] );
            cloth->prescribed[i] = double3_scale( 1.0 / s, way );
        }
    }

    cloth->iterations = 0;
    cloth->negative = cloth->limited = false;
    copy_vectors( cloth, v, v_hat );
    for ( int repeat = 0; repeat < cloth->params.newton_iterations; ++repeat )
    {
        solve_once( cloth, repeat, s, x_hat, v_hat, v );
    }
    triangle_oracle_contact_end( cloth, h );
    advance( cloth, h, s, x_hat, v );

    double3* b = new_vectors( cloth );
    missing( cloth, s, cloth->x, v_hat, cloth->v, b );
    cloth->newton_residual = largest_missing( cloth, b );
    if ( cloth->params.integrator == TRIANGLE_ORACLE_BDF2 )
    {
        triangle_oracle_contact_settle( cloth, h );
    }
    free( b );
    free( x_hat );
    free( v_hat );
    free( v );
}
