#include "newton.h"

#include <stdlib.h>
#include <string.h>

enum
{
    ITERATIONS_MAX = 60,
    HALVINGS_MAX = 12,
    BLOCK = 9,
};

static const double standard_gravity = 9.81; // m/s^2, of the weight to which residuals are relative

static double3 add_scaled( double3 a, double s, double3 b )
{
    return double3_add( a, double3_scale( s, b ) );
}

static double3 times( const triangle_oracle_matrix* a, double3 v )
{
    return double3_make( a->m[0][0] * v.x + a->m[0][1] * v.y + a->m[0][2] * v.z,
                         a->m[1][0] * v.x + a->m[1][1] * v.y + a->m[1][2] * v.z,
                         a->m[2][0] * v.x + a->m[2][1] * v.y + a->m[2][2] * v.z );
}

// a b
static triangle_oracle_matrix product( const triangle_oracle_matrix* a, const triangle_oracle_matrix* b )
{
    triangle_oracle_matrix out;
    for ( int i = 0; i < BLOCK; ++i )
    {
        out.m[i / 3][i % 3] = 0.0;
        for ( int k = 0; k < 3; ++k )
        {
            out.m[i / 3][i % 3] += a->m[i / 3][k] * b->m[k][i % 3];
        }
    }
    return out;
}

// ---- memory ----

wisp_status newton_create( triangle_oracle* cloth, newton* out, wisp_error* error )
{
    const size_t n = (size_t)cloth->count, blocks = n + (size_t)cloth->link_count;
    *out = ( newton ){ .cloth = cloth };
    cholmod_start( &out->common );
    // errors are returned as a status, not printed on the terminal
    out->common.print = 0;
    out->triplets = cholmod_allocate_triplet( 3 * n, 3 * n, BLOCK * blocks, -1, CHOLMOD_REAL, &out->common );
    out->right = cholmod_zeros( 3 * n, 1, CHOLMOD_REAL, &out->common );
    double3** vectors[] = { &out->x_hat, &out->v_hat, &out->v, &out->trial, &out->missing, &out->scratch };
    bool good = out->triplets && out->right;
    for ( size_t k = 0; k < sizeof( vectors ) / sizeof( vectors[0] ); ++k )
    {
        *vectors[k] = calloc( n, sizeof( double3 ) );
        good = good && *vectors[k];
    }
    if ( !good )
    {
        newton_destroy( out );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the matrix of %zu vertices", n );
    }
    return WISP_OK;
}

void newton_destroy( newton* n )
{
    cholmod_free_factor( &n->factor, &n->common );
    cholmod_free_triplet( &n->triplets, &n->common );
    cholmod_free_dense( &n->right, &n->common );
    cholmod_finish( &n->common );
    double3* vectors[] = { n->x_hat, n->v_hat, n->v, n->trial, n->missing, n->scratch };
    for ( size_t k = 0; k < sizeof( vectors ) / sizeof( vectors[0] ); ++k )
    {
        free( vectors[k] );
    }
    *n = ( newton ){ .cloth = NULL };
}

// ---- the matrix S A S + (1 - S) m ----

// Blocks of the diagonal are complete in the sums, but only their lower halves are passed on.
static void put_block( newton* n, int row, int column, const triangle_oracle_matrix* block )
{
    int *rows = n->triplets->i, *columns = n->triplets->j;
    double* values = n->triplets->x;
    for ( int k = 0; k < BLOCK; ++k )
    {
        if ( row == column && k / 3 < k % 3 )
        {
            continue;
        }
        const size_t at = n->triplets->nnz++;
        rows[at] = 3 * row + k / 3;
        columns[at] = 3 * column + k % 3;
        values[at] = block->m[k / 3][k % 3];
    }
}

static void put_filtered( newton* n, int row, int column, const triangle_oracle_matrix* block, double sign )
{
    const triangle_oracle_matrix* s = n->cloth->freedom;
    triangle_oracle_matrix left = product( s + row, block );
    triangle_oracle_matrix both = product( &left, s + column );
    for ( int k = 0; k < BLOCK; ++k )
    {
        both.m[k / 3][k % 3] *= sign;
    }
    put_block( n, row, column, &both );
}

static triangle_oracle_matrix block_of( const triangle_oracle* cloth, int link )
{
    const triangle_oracle_term* t = cloth->term + link;
    const double s = cloth->s, rate = t->length > 0.0 ? cloth->link[link].scale * cloth->params.damping : 0.0;
    const double along = s * s * t->k1 + s * rate, across = s * s * t->k2 + s * rate;
    const double d[3] = { t->direction.x, t->direction.y, t->direction.z };
    triangle_oracle_matrix block;
    for ( int k = 0; k < BLOCK; ++k )
    {
        const int a = k / 3, b = k % 3;
        block.m[a][b] = ( along - across ) * d[a] * d[b] + ( a == b ? across : 0.0 );
    }
    return block;
}

static void fill_triplets( newton* n )
{
    const triangle_oracle* cloth = n->cloth;
    triangle_oracle_matrix* diagonal = calloc( (size_t)cloth->count, sizeof( triangle_oracle_matrix ) );
    n->triplets->nnz = 0;
    for ( int k = 0; k < cloth->link_count && diagonal; ++k )
    {
        const int i = cloth->link[k].i, j = cloth->link[k].j;
        const triangle_oracle_matrix block = block_of( cloth, k );
        put_filtered( n, i > j ? i : j, i > j ? j : i, &block, -1.0 );
        for ( int e = 0; e < BLOCK; ++e )
        {
            diagonal[i].m[e / 3][e % 3] += block.m[e / 3][e % 3];
            diagonal[j].m[e / 3][e % 3] += block.m[e / 3][e % 3];
        }
    }
    for ( int i = 0; i < cloth->count && diagonal; ++i )
    {
        const triangle_oracle_matrix* s = cloth->freedom + i;
        for ( int a = 0; a < 3; ++a )
        {
            diagonal[i].m[a][a] += cloth->mass[i];
        }
        triangle_oracle_matrix left = product( s, diagonal + i ), both = product( &left, s );
        for ( int e = 0; e < BLOCK; ++e )
        {
            const double whole = e / 3 == e % 3 ? 1.0 : 0.0;
            both.m[e / 3][e % 3] += cloth->mass[i] * ( whole - s->m[e / 3][e % 3] );
        }
        put_block( n, i, i, &both );
    }
    free( diagonal );
}

// Solve; the result is in n->scratch. @param right [count] filtered
// @return WISP_CONFLICT the matrix is not positive definite, and n->scratch is unchanged
static wisp_status solve( newton* n, const double3* right, wisp_error* error )
{
    fill_triplets( n );
    cholmod_sparse* matrix = cholmod_triplet_to_sparse( n->triplets, n->triplets->nnz, &n->common );
    if ( !n->factor )
    {
        n->factor = cholmod_analyze( matrix, &n->common );
    }
    cholmod_factorize( matrix, n->factor, &n->common );
    const bool good = n->common.status == CHOLMOD_OK;
    memcpy( n->right->x, right, (size_t)n->cloth->count * sizeof( double3 ) );
    cholmod_dense* answer = good ? cholmod_solve( CHOLMOD_A, n->factor, n->right, &n->common ) : NULL;
    if ( answer )
    {
        memcpy( n->scratch, answer->x, (size_t)n->cloth->count * sizeof( double3 ) );
    }
    wisp_status status = answer ? WISP_OK
                                : wisp_fail( error, WISP_CONFLICT, "step %ld: CHOLMOD cannot factorise (status %d)",
                                             n->steps, n->common.status );
    cholmod_free_dense( &answer, &n->common );
    cholmod_free_sparse( &matrix, &n->common );
    ++n->solves;
    return status;
}

// At the positions in n->scratch, with all derivatives. In long steps bending may make that matrix indefinite;
// without the negative part of its derivatives Newton's method takes more steps, but to the same solution.
static wisp_status solve_at( newton* n, double s, const double3* right, wisp_error* error )
{
    triangle_oracle* cloth = n->cloth;
    triangle_oracle_assemble( cloth, n->scratch, s );
    wisp_status status = solve( n, right, error );
    if ( status == WISP_CONFLICT )
    {
        cloth->params.jacobian = TRIANGLE_ORACLE_JACOBIAN_DROPPED;
        triangle_oracle_assemble( cloth, n->scratch, s );
        status = solve( n, right, error );
        cloth->params.jacobian = TRIANGLE_ORACLE_JACOBIAN_FULL;
    }
    return status;
}

// ---- a step ----

// Extrapolate as in the oracle. @return the replacement of h
static double predict( newton* n, double h )
{
    const triangle_oracle* cloth = n->cloth;
    const bool second = cloth->params.integrator == TRIANGLE_ORACLE_BDF2 && cloth->h_before > 0.0;
    const double w = second ? h / cloth->h_before : 0.0;
    const double now = ( 1.0 + w ) * ( 1.0 + w ) / ( 1.0 + 2.0 * w ), before = -w * w / ( 1.0 + 2.0 * w );
    const double s = h * ( second ? ( 1.0 + w ) / ( 1.0 + 2.0 * w ) : 1.0 );
    const double kept = 1.0 / ( 1.0 + cloth->params.drag * s );
    for ( int i = 0; i < cloth->count; ++i )
    {
        n->x_hat[i] = add_scaled( double3_scale( now, cloth->x[i] ), before, cloth->x_before[i] );
        const double3 v = add_scaled( double3_scale( now, cloth->v[i] ), before, cloth->v_before[i] );
        n->v_hat[i] = add_scaled( double3_scale( kept, v ), s, cloth->params.gravity );
    }
    return s;
}

// Residual of the step: M (v^ - v) + s f(x) + s D v + push. @return its norm at free vertices
static double find_missing( newton* n, double s, const double3* v )
{
    const triangle_oracle* cloth = n->cloth;
    double sum = 0.0;
    for ( int i = 0; i < cloth->count; ++i )
    {
        n->scratch[i] = add_scaled( n->x_hat[i], s, v[i] );
        n->missing[i] = add_scaled( cloth->push[i], cloth->mass[i], double3_sub( n->v_hat[i], v[i] ) );
    }
    for ( int k = 0; k < cloth->link_count; ++k )
    {
        const int i = cloth->link[k].i, j = cloth->link[k].j;
        const triangle_oracle_term term = triangle_oracle_term_at( cloth, k, n->scratch );
        const double3 apart = double3_sub( v[i], v[j] );
        const double rate = term.length > 0.0 ? cloth->link[k].scale * cloth->params.damping : 0.0;
        const double3 force = add_scaled( double3_scale( s * term.force, term.direction ), -s * rate, apart );
        n->missing[i] = double3_add( n->missing[i], force );
        n->missing[j] = double3_sub( n->missing[j], force );
    }
    for ( int i = 0; i < cloth->count; ++i )
    {
        const double3 freely = times( cloth->freedom + i, n->missing[i] );
        sum += double3_dot( freely, freely );
    }
    return sqrt( sum );
}

static double weight_impulse( const triangle_oracle* cloth, double s )
{
    double sum = 0.0;
    for ( int i = 0; i < cloth->count; ++i )
    {
        sum += cloth->mass[i] * cloth->mass[i];
    }
    return s * standard_gravity * sqrt( sum );
}

// Move along the change in n->scratch, halved until the residual falls: links that change between slack and taut on
// the way may make a full step too long. @return the residual then
static double search( newton* n, double s, double missing )
{
    const triangle_oracle* cloth = n->cloth;
    double3* change = malloc( (size_t)cloth->count * sizeof( double3 ) );
    double fraction = 1.0, now = missing;
    if ( !change )
    {
        return missing;
    }
    memcpy( change, n->scratch, (size_t)cloth->count * sizeof( double3 ) );
    for ( int halving = 0; halving <= HALVINGS_MAX; ++halving, fraction *= 0.5 )
    {
        for ( int i = 0; i < cloth->count; ++i )
        {
            n->trial[i] = add_scaled( n->v[i], fraction, times( cloth->freedom + i, change[i] ) );
        }
        now = find_missing( n, s, n->trial );
        if ( now < missing )
        {
            break;
        }
    }
    free( change );
    return now;
}

// Start where vertices would go without forces, with contact applied.
static wisp_status converge( newton* n, double s, wisp_error* error )
{
    triangle_oracle* cloth = n->cloth;
    for ( int i = 0; i < cloth->count; ++i )
    {
        const double3 beyond = double3_sub( n->v_hat[i], cloth->prescribed[i] );
        n->v[i] = double3_add( cloth->prescribed[i], times( cloth->freedom + i, beyond ) );
    }
    const double scale = weight_impulse( cloth, s );
    double missing = find_missing( n, s, n->v );
    wisp_status status = WISP_OK;
    for ( int k = 0; k < ITERATIONS_MAX && missing > NEWTON_TOLERANCE * scale && status == WISP_OK; ++k )
    {
        for ( int i = 0; i < cloth->count; ++i )
        {
            n->trial[i] = times( cloth->freedom + i, n->missing[i] );
        }
        status = solve_at( n, s, n->trial, error );
        const double less = status == WISP_OK ? search( n, s, missing ) : missing;
        if ( !( less < missing ) )
        {
            missing = find_missing( n, s, n->v );
            break;
        }
        missing = less;
        memcpy( n->v, n->trial, (size_t)cloth->count * sizeof( double3 ) );
    }
    n->worst = fmax( n->worst, missing / scale );
    n->unconverged += missing > NEWTON_TOLERANCE * scale ? 1 : 0;
    return status;
}

wisp_status newton_step( newton* n, double h, const triangle_oracle_bodies* bodies, wisp_error* error )
{
    triangle_oracle* cloth = n->cloth;
    const double s = predict( n, h );
    triangle_oracle_contact_begin( cloth, h, s, n->x_hat, n->v_hat, bodies );
    for ( int i = 0; i < cloth->count; ++i )
    {
        if ( cloth->pinned[i] )
        {
            cloth->prescribed[i] = double3_scale( 1.0 / s, double3_sub( cloth->target[i], n->x_hat[i] ) );
        }
    }
    wisp_status status = converge( n, s, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int i = 0; i < cloth->count; ++i )
    {
        cloth->impulse[i] = double3_sub( times( cloth->freedom + i, n->missing[i] ), n->missing[i] );
        cloth->x_before[i] = cloth->x[i];
        cloth->v_before[i] = cloth->v[i];
        cloth->v[i] = n->v[i];
        cloth->x[i] = cloth->pinned[i] ? cloth->target[i] : add_scaled( n->x_hat[i], s, n->v[i] );
    }
    triangle_oracle_contact_end( cloth, h );
    cloth->h_before = h;
    if ( cloth->params.integrator == TRIANGLE_ORACLE_BDF2 )
    {
        triangle_oracle_contact_settle( cloth, h );
    }
    ++n->steps;
    return WISP_OK;
}
