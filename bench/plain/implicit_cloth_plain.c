// The scalar C implicit cloth: a step.
#include "implicit_cloth_plain.h"

#include <math.h>
#include <string.h>

static inline wisp_vec3 sum( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x + b.x, a.y + b.y, a.z + b.z };
}

static inline wisp_vec3 difference( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static inline wisp_vec3 scaled( float s, wisp_vec3 a )
{
    return ( wisp_vec3 ){ s * a.x, s * a.y, s * a.z };
}

static inline float length( wisp_vec3 a )
{
    return sqrtf( a.x * a.x + a.y * a.y + a.z * a.z );
}

static inline wisp_vec3 times( const plain_block* block, wisp_vec3 a )
{
    const float( *m )[3] = (const float( * )[3])block->m;
    return ( wisp_vec3 ){ m[0][0] * a.x + m[0][1] * a.y + m[0][2] * a.z,
                          m[1][0] * a.x + m[1][1] * a.y + m[1][2] * a.z,
                          m[2][0] * a.x + m[2][1] * a.y + m[2][2] * a.z };
}

// ---- forces ----

// A force along a spring and its derivative by the length.
typedef struct pull
{
    float force; // N, above 0: the ends attract each other
    float along; // N/m
} pull;

// The load of an arc over its chord y, in k_b / L^2: -12 where it is straight. @param slope receives its derivative
// by y
static double arc_load( double y, double* slope )
{
    double u = fmin( sqrt( 6.0 * ( 1.0 - y ) ), 3.14159265358979 );
    for ( int i = 0; i < 5 && u > 1e-2; ++i )
    {
        double s = sin( u ) / u;
        u = fmin( fmax( u - ( s - y ) * u / ( cos( u ) - s ), 1e-3 ), 3.14159265358979 );
    }
    if ( u < 1e-2 )
    {
        *slope = 7.2;
        return -12.0 - 7.2 * ( 1.0 - y );
    }
    double g = cos( u ) - sin( u ) / u;
    *slope = 4.0 * u * u * ( 3.0 * g + u * sin( u ) ) / ( g * g * g );
    return 4.0 * u * u / g;
}

static pull pull_of( const plain_implicit_material* m, const plain_spring* s, float r )
{
    float longer = r - s->rest, k = m->stretch_stiffness;
    if ( s->bends == ( longer >= 0.0f ) )
    {
        return ( pull ){ 0.0f, 0.0f };
    }
    if ( !s->bends )
    {
        return ( pull ){ k * longer, k };
    }
    float load = m->bend_stiffness / ( s->rest * s->rest ), ramp = m->compression_stiffness * longer;
    if ( ramp >= -12.0f * load )
    {
        return ( pull ){ ramp, m->compression_stiffness }; // an arc would push with 12 at least
    }
    double slope;
    float arc = load * (float)arc_load( (double)( r / s->rest ), &slope );
    return arc < ramp ? ( pull ){ ramp, m->compression_stiffness } : ( pull ){ arc, load * (float)slope / s->rest };
}

// ---- the linear system: A dv = h f - ( A - M ) v ----

static inline void add_block( plain_block* block, float sign, const plain_block* k )
{
    for ( int i = 0; i < 3; ++i )
    {
        for ( int j = 0; j < 3; ++j )
        {
            block->m[i][j] += sign * k->m[i][j];
        }
    }
}

static void add_spring( plain_implicit_cloth* cloth, const plain_spring* s, float h )
{
    const plain_implicit_material* m = &cloth->material;
    wisp_vec3 x = difference( cloth->position[s->b], cloth->position[s->a] );
    float r = length( x );
    if ( r == 0.0f )
    {
        return;
    }
    wisp_vec3 d = scaled( 1.0f / r, x );
    pull p = pull_of( m, s, r );
    // lateral stiffness is left out where it would be negative: the matrix stays positive
    float across = s->bends ? 0.0f : p.force / r, everywhere = h * h * across + h * m->damping;
    const float axis[3] = { d.x, d.y, d.z };
    plain_block k;
    for ( int i = 0; i < 3; ++i )
    {
        for ( int j = 0; j < 3; ++j )
        {
            k.m[i][j] = h * h * ( p.along - across ) * axis[i] * axis[j] + ( i == j ? everywhere : 0.0f );
        }
    }
    add_block( &cloth->block[cloth->diagonal[s->a]], 1.0f, &k );
    add_block( &cloth->block[cloth->diagonal[s->b]], 1.0f, &k );
    add_block( &cloth->block[s->to_a_of_b], -1.0f, &k );
    add_block( &cloth->block[s->to_b_of_a], -1.0f, &k );
    wisp_vec3 drag = times( &k, difference( cloth->velocity[s->a], cloth->velocity[s->b] ) );
    wisp_vec3 impulse = difference( scaled( h * p.force, d ), drag );
    cloth->right[s->a] = sum( cloth->right[s->a], impulse );
    cloth->right[s->b] = difference( cloth->right[s->b], impulse );
}

static void invert( const plain_block* block, plain_block* inverted )
{
    const float( *m )[3] = (const float( * )[3])block->m;
    float( *out )[3] = inverted->m;
    float a = m[1][1] * m[2][2] - m[1][2] * m[2][1], b = m[1][2] * m[2][0] - m[1][0] * m[2][2];
    float c = m[1][0] * m[2][1] - m[1][1] * m[2][0];
    float inverse = 1.0f / ( m[0][0] * a + m[0][1] * b + m[0][2] * c );
    out[0][0] = a * inverse;
    out[1][0] = b * inverse;
    out[2][0] = c * inverse;
    out[0][1] = ( m[0][2] * m[2][1] - m[0][1] * m[2][2] ) * inverse;
    out[1][1] = ( m[0][0] * m[2][2] - m[0][2] * m[2][0] ) * inverse;
    out[2][1] = ( m[0][1] * m[2][0] - m[0][0] * m[2][1] ) * inverse;
    out[0][2] = ( m[0][1] * m[1][2] - m[0][2] * m[1][1] ) * inverse;
    out[1][2] = ( m[0][2] * m[1][0] - m[0][0] * m[1][2] ) * inverse;
    out[2][2] = ( m[0][0] * m[1][1] - m[0][1] * m[1][0] ) * inverse;
}

static void assemble( plain_implicit_cloth* cloth, float h )
{
    int n = cloth->vertex_count;
    memset( cloth->block, 0, (size_t)cloth->row_begin[n] * sizeof( plain_block ) );
    memset( cloth->right, 0, (size_t)n * sizeof( wisp_vec3 ) );
    for ( int i = 0; i < cloth->spring_count; ++i )
    {
        add_spring( cloth, &cloth->springs[i], h );
    }
    for ( int v = 0; v < n; ++v )
    {
        plain_block* own = &cloth->block[cloth->diagonal[v]];
        for ( int k = 0; k < 3; ++k )
        {
            own->m[k][k] += cloth->mass[v];
        }
        invert( own, &cloth->inverse[v] );
    }
}

// ---- conjugate gradients ----

static void multiply( const plain_implicit_cloth* cloth, const wisp_vec3* x, wisp_vec3* out )
{
    for ( int row = 0; row < cloth->vertex_count; ++row )
    {
        wisp_vec3 y = { 0.0f, 0.0f, 0.0f };
        for ( int k = cloth->row_begin[row]; k < cloth->row_begin[row + 1]; ++k )
        {
            y = sum( y, times( &cloth->block[k], x[cloth->column[k]] ) );
        }
        out[row] = y;
    }
}

static double dot( int count, const wisp_vec3* a, const wisp_vec3* b )
{
    double s = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        s += (double)( a[i].x * b[i].x + a[i].y * b[i].y + a[i].z * b[i].z );
    }
    return s;
}

// search = S P r, S without pinned vertices. @return r' S P r
static double precondition( plain_implicit_cloth* cloth, const wisp_vec3* r )
{
    for ( int v = 0; v < cloth->vertex_count; ++v )
    {
        cloth->search[v] = cloth->pinned[v] ? ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } : times( &cloth->inverse[v], r[v] );
    }
    return dot( cloth->vertex_count, r, cloth->search );
}

static void advance( plain_implicit_cloth* cloth, float step )
{
    for ( int v = 0; v < cloth->vertex_count; ++v )
    {
        cloth->change[v] = sum( cloth->change[v], scaled( step, cloth->direction[v] ) );
        cloth->residual[v] = difference( cloth->residual[v], scaled( step, cloth->product[v] ) );
    }
}

static void turn( plain_implicit_cloth* cloth, float fraction )
{
    for ( int v = 0; v < cloth->vertex_count; ++v )
    {
        cloth->direction[v] = sum( cloth->search[v], scaled( fraction, cloth->direction[v] ) );
    }
}

static void solve( plain_implicit_cloth* cloth )
{
    double least = precondition( cloth, cloth->right );
    least *= (double)cloth->material.tolerance * (double)cloth->material.tolerance;
    multiply( cloth, cloth->change, cloth->product );
    for ( int v = 0; v < cloth->vertex_count; ++v )
    {
        cloth->residual[v] = difference( cloth->right[v], cloth->product[v] );
    }
    double delta = precondition( cloth, cloth->residual );
    turn( cloth, 0.0f );
    cloth->iterations = 0;
    while ( delta > least && cloth->iterations < 3 * cloth->vertex_count )
    {
        multiply( cloth, cloth->direction, cloth->product );
        double curvature = dot( cloth->vertex_count, cloth->direction, cloth->product );
        advance( cloth, (float)( delta / curvature ) );
        double next = precondition( cloth, cloth->residual );
        turn( cloth, (float)( next / delta ) );
        delta = next;
        ++cloth->iterations;
    }
    cloth->is_solved = delta <= least;
    cloth->iterations_all += cloth->iterations;
}

void plain_implicit_cloth_step( plain_implicit_cloth* cloth, float seconds )
{
    for ( int v = 0; v < cloth->vertex_count; ++v )
    {
        if ( !cloth->pinned[v] )
        {
            cloth->velocity[v] = sum( cloth->velocity[v], scaled( seconds, cloth->material.gravity ) );
        }
    }
    assemble( cloth, seconds );
    solve( cloth );
    for ( int v = 0; v < cloth->vertex_count; ++v )
    {
        cloth->velocity[v] = sum( cloth->velocity[v], cloth->change[v] );
        cloth->position[v] = sum( cloth->position[v], scaled( seconds, cloth->velocity[v] ) );
    }
}
