#include "strands_plain.h"

#include <math.h>
#include <stdlib.h>

static float distance( wisp_vec3 a, wisp_vec3 b )
{
    float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
    return sqrtf( x * x + y * y + z * z );
}

static void measure( plain_strands* strands, float line_density )
{
    int n = strands->vertices;
    for ( int s = 0; s < strands->strand_count; ++s )
    {
        size_t first = (size_t)s * (size_t)n;
        const wisp_vec3* p = strands->position + first;
        float* length = strands->length + first;
        for ( int v = 0; v + 1 < n; ++v )
        {
            length[v] = distance( p[v], p[v + 1] );
            strands->pair[first + (size_t)v] = v + 2 < n ? distance( p[v], p[v + 2] ) : 0.0f;
        }
        for ( int v = 1; v < n; ++v )
        {
            float around = length[v - 1] + ( v + 1 < n ? length[v] : 0.0f );
            strands->inverse_mass[first + (size_t)v] = 1.0f / ( 0.5f * line_density * around );
        }
    }
}

bool plain_strands_create( plain_strands* strands, const wisp_vec3* points, int strand_count, int vertices,
                           float line_density )
{
    size_t count = (size_t)strand_count * (size_t)vertices;
    *strands = ( plain_strands ){
        .strand_count = strand_count,
        .vertices = vertices,
        .position = calloc( count, sizeof( wisp_vec3 ) ),
        .previous = calloc( count, sizeof( wisp_vec3 ) ),
        .velocity = calloc( count, sizeof( wisp_vec3 ) ),
        .inverse_mass = calloc( count, sizeof( float ) ),
        .length = calloc( count, sizeof( float ) ),
        .pair = calloc( count, sizeof( float ) ),
        .gravity = { 0.0f, -9.81f, 0.0f },
        .bends = true,
        .passes = 2,
        .substeps = 1,
    };
    bool complete = strands->position && strands->previous && strands->velocity && strands->inverse_mass &&
                    strands->length && strands->pair && vertices >= 2 && vertices <= PLAIN_STRAND_VERTICES_MAX;
    if ( !complete )
    {
        plain_strands_destroy( strands );
        return false;
    }
    for ( size_t v = 0; v < count; ++v )
    {
        strands->position[v] = points[v];
    }
    measure( strands, line_density );
    return true;
}

void plain_strands_destroy( plain_strands* strands )
{
    free( strands->position );
    free( strands->previous );
    free( strands->velocity );
    free( strands->inverse_mass );
    free( strands->length );
    free( strands->pair );
    *strands = ( plain_strands ){ 0 };
}

// One distance. A compliance over dt^2 makes it soft; a single pass per substep needs no stored multiplier.
static void project( wisp_vec3* a, wisp_vec3* b, float wa, float wb, float rest, float softness )
{
    float x = a->x - b->x, y = a->y - b->y, z = a->z - b->z;
    float length = sqrtf( x * x + y * y + z * z );
    float weight = length * ( wa + wb + softness );
    if ( weight == 0.0f || wa + wb == 0.0f )
    {
        return;
    }
    float s = ( length - rest ) / weight;
    a->x -= wa * s * x;
    a->y -= wa * s * y;
    a->z -= wa * s * z;
    b->x += wb * s * x;
    b->y += wb * s * y;
    b->z += wb * s * z;
}

static void sweep( const plain_strands* strands, size_t first, int stride, const float* rest, float softness )
{
    wisp_vec3* p = strands->position + first;
    const float* w = strands->inverse_mass + first;
    for ( int v = 0; v + stride < strands->vertices; ++v )
    {
        project( &p[v], &p[v + stride], w[v], w[v + stride], rest[first + (size_t)v], softness );
    }
}

// One Newton pass: the system is tridiagonal because a segment shares vertices with its two neighbours only.
static void solve_strand( const plain_strands* strands, size_t first )
{
    wisp_vec3 direction[PLAIN_STRAND_VERTICES_MAX];
    float upper[PLAIN_STRAND_VERTICES_MAX], lambda[PLAIN_STRAND_VERTICES_MAX];
    wisp_vec3* p = strands->position + first;
    const float *w = strands->inverse_mass + first, *rest = strands->length + first;
    int segments = strands->vertices - 1;

    // forward: eliminate the coupling to the previous segment
    float last_upper = 0.0f, last_lambda = 0.0f;
    for ( int s = 0; s < segments; ++s )
    {
        wisp_vec3 d = { p[s + 1].x - p[s].x, p[s + 1].y - p[s].y, p[s + 1].z - p[s].z };
        float length = sqrtf( d.x * d.x + d.y * d.y + d.z * d.z );
        float inverse = length > 0.0f ? 1.0f / length : 0.0f;
        direction[s] = ( wisp_vec3 ){ d.x * inverse, d.y * inverse, d.z * inverse };
        float coupling = 0.0f;
        if ( s > 0 )
        {
            wisp_vec3 a = direction[s - 1], b = direction[s];
            coupling = -w[s] * ( a.x * b.x + a.y * b.y + a.z * b.z );
            last_upper = coupling * upper[s - 1];
            upper[s - 1] = last_upper;
        }
        float pivot = w[s] + w[s + 1] - coupling * last_upper;
        float inverse_pivot = pivot > 0.0f ? 1.0f / pivot : 0.0f;
        last_lambda = ( rest[s] - length - coupling * last_lambda ) * inverse_pivot;
        lambda[s] = last_lambda;
        upper[s] = inverse_pivot;
    }

    // backward: substitute, and move both ends of each segment
    float behind = 0.0f;
    for ( int s = segments - 1; s >= 0; --s )
    {
        float l = lambda[s] - ( s + 1 < segments ? upper[s] * behind : 0.0f );
        wisp_vec3 d = direction[s];
        p[s].x -= w[s] * l * d.x;
        p[s].y -= w[s] * l * d.y;
        p[s].z -= w[s] * l * d.z;
        p[s + 1].x += w[s + 1] * l * d.x;
        p[s + 1].y += w[s + 1] * l * d.y;
        p[s + 1].z += w[s + 1] * l * d.z;
        behind = l;
    }
}

static void predict( plain_strands* strands, float dt )
{
    size_t count = (size_t)strands->strand_count * (size_t)strands->vertices;
    for ( size_t v = 0; v < count; ++v )
    {
        wisp_vec3 *p = &strands->position[v], *u = &strands->velocity[v];
        strands->previous[v] = *p;
        if ( strands->inverse_mass[v] > 0.0f )
        {
            u->x += dt * strands->gravity.x;
            u->y += dt * strands->gravity.y;
            u->z += dt * strands->gravity.z;
            p->x += dt * u->x;
            p->y += dt * u->y;
            p->z += dt * u->z;
        }
    }
}

static void constrain( plain_strands* strands, float dt )
{
    float softness = strands->bend_compliance / ( dt * dt );
    for ( int s = 0; s < strands->strand_count; ++s )
    {
        size_t first = (size_t)s * (size_t)strands->vertices;
        if ( strands->bends )
        {
            sweep( strands, first, 2, strands->pair, softness );
        }
        if ( strands->stretch == PLAIN_STRAND_SWEEP )
        {
            sweep( strands, first, 1, strands->length, 0.0f );
        }
        for ( int pass = 0; strands->stretch == PLAIN_STRAND_TRIDIAGONAL && pass < strands->passes; ++pass )
        {
            solve_strand( strands, first );
        }
    }
}

static void read_velocity( plain_strands* strands, float dt )
{
    size_t count = (size_t)strands->strand_count * (size_t)strands->vertices;
    for ( size_t v = 0; v < count; ++v )
    {
        wisp_vec3 p = strands->position[v], q = strands->previous[v];
        strands->velocity[v] = ( wisp_vec3 ){ ( p.x - q.x ) / dt, ( p.y - q.y ) / dt, ( p.z - q.z ) / dt };
    }
}

void plain_strands_step( plain_strands* strands, float seconds )
{
    float dt = seconds / (float)strands->substeps;
    for ( int substep = 0; substep < strands->substeps; ++substep )
    {
        predict( strands, dt );
        constrain( strands, dt );
        read_velocity( strands, dt );
    }
}
