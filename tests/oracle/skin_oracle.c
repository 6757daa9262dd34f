#include "skin_oracle.h"

typedef struct quat
{
    double w, x, y, z;
} quat;

double3 skin_oracle_linear( const skin_oracle_bone* bones, const double* weights, int count, double3 p )
{
    double sum[3] = { 0.0 };
    for ( int k = 0; k < count; ++k )
    {
        for ( int r = 0; r < 3; ++r )
        {
            const double* m = bones[k].m[r];
            sum[r] += weights[k] * ( m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3] );
        }
    }
    return double3_make( sum[0], sum[1], sum[2] );
}

static quat multiply( quat a, quat b )
{
    return ( quat ){ a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                     a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w };
}

static quat add_scaled( quat a, double s, quat b )
{
    return ( quat ){ a.w + s * b.w, a.x + s * b.x, a.y + s * b.y, a.z + s * b.z };
}

static double dot( quat a, quat b )
{
    return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}

// Bar-Itzhack's way: the column of largest length of 4 q q^T, whose entries are sums of those of the matrix.
static quat rotation_of( const skin_oracle_bone* b )
{
    const double( *m )[4] = b->m;
    const double trace = m[0][0] + m[1][1] + m[2][2];
    const quat columns[4] = {
        { 1.0 + trace, m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1] },
        { m[2][1] - m[1][2], 1.0 + 2.0 * m[0][0] - trace, m[0][1] + m[1][0], m[0][2] + m[2][0] },
        { m[0][2] - m[2][0], m[0][1] + m[1][0], 1.0 + 2.0 * m[1][1] - trace, m[1][2] + m[2][1] },
        { m[1][0] - m[0][1], m[0][2] + m[2][0], m[1][2] + m[2][1], 1.0 + 2.0 * m[2][2] - trace },
    };
    quat best = columns[0];
    for ( int i = 1; i < 4; ++i )
    {
        best = dot( columns[i], columns[i] ) > dot( best, best ) ? columns[i] : best;
    }
    const double scale = 1.0 / sqrt( dot( best, best ) );
    return ( quat ){ scale * best.w, scale * best.x, scale * best.y, scale * best.z };
}

double3 skin_oracle_dual_quaternion( const skin_oracle_bone* bones, const double* weights, int count, double3 p )
{
    int pivot = 0;
    for ( int k = 1; k < count; ++k )
    {
        pivot = weights[k] > weights[pivot] ? k : pivot;
    }
    const quat near = rotation_of( &bones[pivot] );
    quat real = { 0 }, dual = { 0 };
    for ( int k = 0; k < count; ++k )
    {
        const quat q = rotation_of( &bones[k] );
        const quat t = { 0.0, bones[k].m[0][3], bones[k].m[1][3], bones[k].m[2][3] };
        const double weight = dot( q, near ) < 0.0 ? -weights[k] : weights[k];
        real = add_scaled( real, weight, q );
        dual = add_scaled( dual, 0.5 * weight, multiply( t, q ) );
    }
    const double length = sqrt( dot( real, real ) );
    const quat none = { 0 }, q = add_scaled( none, 1.0 / length, real ), d = add_scaled( none, 1.0 / length, dual );
    const quat conjugate = { q.w, -q.x, -q.y, -q.z };
    const quat turned = multiply( multiply( q, ( quat ){ 0.0, p.x, p.y, p.z } ), conjugate );
    const quat moved = multiply( d, conjugate );
    return double3_make( turned.x + 2.0 * moved.x, turned.y + 2.0 * moved.y, turned.z + 2.0 * moved.z );
}
