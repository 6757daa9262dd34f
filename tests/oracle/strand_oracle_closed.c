// Closed strands: systems around the loop, written down entry by entry and solved dense.
#include "strand_oracle_rod.h"

void strand_oracle_solve( int n, double* matrix, int columns, double* right )
{
    for ( int k = 0; k < n; ++k )
    {
        int best = k;
        for ( int i = k + 1; i < n; ++i )
        {
            best = fabs( matrix[i * n + k] ) > fabs( matrix[best * n + k] ) ? i : best;
        }
        for ( int j = 0; j < n; ++j )
        {
            const double swapped = matrix[k * n + j];
            matrix[k * n + j] = matrix[best * n + j];
            matrix[best * n + j] = swapped;
        }
        for ( int j = 0; j < columns; ++j )
        {
            const double swapped = right[k * columns + j];
            right[k * columns + j] = right[best * columns + j];
            right[best * columns + j] = swapped;
        }
        for ( int i = k + 1; i < n; ++i )
        {
            const double ratio = matrix[i * n + k] / matrix[k * n + k];
            for ( int j = k; j < n; ++j )
            {
                matrix[i * n + j] -= ratio * matrix[k * n + j];
            }
            for ( int j = 0; j < columns; ++j )
            {
                right[i * columns + j] -= ratio * right[k * columns + j];
            }
        }
    }
    for ( int k = n - 1; k >= 0; --k )
    {
        for ( int c = 0; c < columns; ++c )
        {
            for ( int j = k + 1; j < n; ++j )
            {
                right[k * columns + c] -= matrix[k * n + j] * right[j * columns + c];
            }
            right[k * columns + c] /= matrix[k * n + k];
        }
    }
}

void strand_oracle_closed_pass( strand_oracle* strand, double dt )
{
    const int n = strand->count - 1;
    double matrix[MAX_STRAND_ORACLE * MAX_STRAND_ORACLE] = { 0.0 }, lambda[MAX_STRAND_ORACLE];
    double3 e[MAX_STRAND_ORACLE];
    for ( int s = 0; s < n; ++s )
    {
        e[s] = double3_sub( strand->position[( s + 1 ) % n], strand->position[s] );
        lambda[s] = -0.5 * ( double3_dot( e[s], e[s] ) - strand->length[s] * strand->length[s] );
    }
    for ( int s = 0; s < n; ++s )
    {
        const int next = ( s + 1 ) % n;
        const double off = -strand->weight[next] * double3_dot( e[s], e[next] );
        matrix[s * n + s] +=
            ( strand->weight[s] + strand->weight[next] ) * double3_dot( e[s], e[s] ) * strand->held_diagonal;
        matrix[s * n + next] += off;
        matrix[next * n + s] += off;
    }
    strand_oracle_solve( n, matrix, 1, lambda );
    for ( int s = 0; s < n; ++s )
    {
        const int next = ( s + 1 ) % n;
        strand->tension[s] -= lambda[s] * double3_length( e[s] ) / ( dt * dt );
        strand->position[s] = double3_add_scaled( strand->position[s], -strand->weight[s] * lambda[s], e[s] );
        strand->position[next] = double3_add_scaled( strand->position[next], strand->weight[next] * lambda[s], e[s] );
    }
    strand->position[n] = strand->position[0];
}

void strand_oracle_close( strand_oracle* strand, double angle )
{
    const int n = strand->count - 1;
    double whole = 0.0;
    strand->closed = strand->framed = true;
    strand->held_diagonal = 1.0 + 1e-5;
    strand->weight[0] = strand->weight[n] = 1.0 / ( strand->mass[0] + strand->mass[n] );
    strand->mass[0] = strand->mass[n] = strand->mass[0] + strand->mass[n];
    for ( int s = 0; s < n; ++s )
    {
        whole += strand->length[s];
    }
    strand->stiffness[0] *= strand->length[0] / ( strand->length[0] + strand->length[n - 1] ); // L_0 was half of l_0
    strand->twist_stiffness[0] *= strand->length[0] / ( strand->length[0] + strand->length[n - 1] );
    const double carried = strand_oracle_twist( strand, 0 );
    for ( int i = 0; i < n; ++i )
    {
        const double reach = 0.5 * ( strand->length[i] + strand->length[( i + n - 1 ) % n] );
        strand->rest_twist[i] = ( i > 0 ? 0.0 : carried ) - angle * reach / whole;
    }
}

void strand_oracle_closed_move( strand_oracle* strand, double scale, double3* right )
{
    const int n = strand->count - 1;
    double matrix[MAX_STRAND_ORACLE * MAX_STRAND_ORACLE] = { 0.0 }, x[3 * MAX_STRAND_ORACLE];
    for ( int i = 0; i < n; ++i )
    {
        const int at[3] = { ( i + n - 1 ) % n, i, ( i + 1 ) % n };
        const double before = 1.0 / strand->length[at[0]], behind = 1.0 / strand->length[i];
        const double c[3] = { before, -before - behind, behind };
        for ( int a = 0; a < 3; ++a )
        {
            for ( int b = 0; b < 3; ++b )
            {
                matrix[at[a] * n + at[b]] += scale * strand->stiffness[i] * c[a] * c[b];
            }
        }
    }
    for ( int i = 0; i < n; ++i )
    {
        const bool is_held = strand->weight[i] <= 0.0;
        matrix[i * n + i] += is_held ? 0.0 : 1.0 / strand->weight[i];
        for ( int j = 0; j < n && is_held; ++j )
        {
            matrix[i * n + j] = matrix[j * n + i] = i == j ? 1.0 : 0.0;
        }
        x[3 * i] = is_held ? 0.0 : right[i].x;
        x[3 * i + 1] = is_held ? 0.0 : right[i].y;
        x[3 * i + 2] = is_held ? 0.0 : right[i].z;
    }
    strand_oracle_solve( n, matrix, 3, x );
    for ( int i = 0; i < n; ++i )
    {
        strand->position[i] =
            double3_add( strand->position[i], double3_make( x[3 * i], x[3 * i + 1], x[3 * i + 2] ) );
    }
    strand->position[n] = strand->position[0];
}

void rod_closed_turns( const strand_oracle* strand, const rod_vertex* v, double* turn )
{
    const int n = strand->count - 1;
    double matrix[MAX_STRAND_ORACLE * MAX_STRAND_ORACLE] = { 0.0 };
    for ( int s = 0; s < n; ++s )
    {
        const int next = ( s + 1 ) % n, before = ( s + n - 1 ) % n;
        const double own = strand->twist_stiffness[s], behind = strand->twist_stiffness[next];
        matrix[s * n + s] += ( own + v[s].slope + behind + v[next].slope ) * ( 1.0 + 1e-5 );
        matrix[s * n + before] += v[s].slope - own;
        matrix[s * n + next] += v[next].slope - behind;
        turn[s] = -( v[s].moment - v[next].moment + 0.5 * ( v[s].load + v[next].load ) );
    }
    strand_oracle_solve( n, matrix, 1, turn );
}

void rod_closed_rate( const strand_oracle* strand, const double3* way, double3* gradient )
{
    for ( int i = 0; i < rod_bending_count( strand ); ++i )
    {
        const int n = strand->count - 1, at[3] = { ( i + n - 1 ) % n, i, ( i + 1 ) % n };
        const double a = 1.0 / strand->length[at[0]], b = 1.0 / strand->length[i], c[3] = { a, -a - b, b };
        double3 change = rod_none;
        for ( int k = 0; k < 3; ++k )
        {
            change = double3_add_scaled( change, c[k], way[at[k]] );
        }
        for ( int k = 0; k < 3; ++k )
        {
            gradient[at[k]] = double3_add_scaled( gradient[at[k]], strand->stiffness[i] * c[k], change );
        }
    }
}
