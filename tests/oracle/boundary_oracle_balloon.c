#include "balloon_oracle.h"
#include "boundary_oracle.h"

#include <stdlib.h>
#include <string.h>

boundary_oracle_balloon_options boundary_oracle_default_balloon_options( void )
{
    return ( boundary_oracle_balloon_options ){
        .iterations = 5,
        .distance_k = 0.9,
        .volume_k = 1.0,
        .multiplier = 1.0,
        .decay = 31.7,
    };
}

static bool allocate( const balloon_mesh* mesh, int edge_count, boundary_oracle_balloon* b )
{
    const size_t n = (size_t)mesh->vertex_count + 1, t = 3 * (size_t)mesh->triangle_count + 1;
    const size_t e = (size_t)edge_count + 1;
    b->x = calloc( n, sizeof( double3 ) );
    b->p = calloc( n, sizeof( double3 ) );
    b->v = calloc( n, sizeof( double3 ) );
    b->gradient = calloc( n, sizeof( double3 ) );
    b->w = calloc( n, sizeof( double ) );
    b->triangles = calloc( t, sizeof( int ) );
    b->hits = calloc( n, sizeof( int ) );
    b->edges = calloc( 2 * e, sizeof( int ) );
    b->rest = calloc( e, sizeof( double ) );
    return b->x != NULL && b->p != NULL && b->v != NULL && b->gradient != NULL && b->w != NULL &&
           b->triangles != NULL && b->hits != NULL && b->edges != NULL && b->rest != NULL;
}

bool boundary_oracle_balloon_create( const balloon_mesh* mesh, boundary_oracle_balloon* out )
{
    balloon_mesh_topology topology;
    if ( !balloon_mesh_build_topology( mesh, &topology ) )
    {
        return false;
    }
    boundary_oracle_balloon made = { .options = boundary_oracle_default_balloon_options(),
                                     .vertex_count = mesh->vertex_count,
                                     .triangle_count = mesh->triangle_count };
    if ( !allocate( mesh, topology.edge_count, &made ) )
    {
        balloon_mesh_destroy_topology( &topology );
        boundary_oracle_balloon_destroy( &made );
        return false;
    }
    memcpy( made.x, mesh->positions, (size_t)mesh->vertex_count * sizeof( double3 ) );
    memcpy( made.triangles, mesh->triangles, 3 * (size_t)mesh->triangle_count * sizeof( int ) );
    made.edge_count = balloon_mesh_structural_pairs( &topology, made.edges );
    balloon_mesh_destroy_topology( &topology );
    for ( int i = 0; i < made.vertex_count; ++i )
    {
        made.w[i] = 1.0;
    }
    for ( int e = 0; e < made.edge_count; ++e )
    {
        made.rest[e] = double3_distance( made.x[made.edges[2 * e]], made.x[made.edges[2 * e + 1]] );
    }
    made.rest_volume = boundary_oracle_balloon_volume( &made );
    *out = made;
    return true;
}

void boundary_oracle_balloon_destroy( boundary_oracle_balloon* balloon )
{
    void* blocks[] = { balloon->x,         balloon->p,     balloon->v,    balloon->gradient, balloon->w,
                       balloon->triangles, balloon->edges, balloon->rest, balloon->hits };
    for ( size_t k = 0; k < sizeof( blocks ) / sizeof( blocks[0] ); ++k )
    {
        free( blocks[k] );
    }
    *balloon = ( boundary_oracle_balloon ){ 0 };
}

double boundary_oracle_balloon_volume( const boundary_oracle_balloon* balloon )
{
    return constraint_oracle_volume( balloon->x, balloon->triangles, balloon->triangle_count );
}

// s = C / sum w |grad C|^2 at the present p, 0 where nothing can move.
static double volume_scale( boundary_oracle_balloon* b, double target )
{
    const double c = constraint_oracle_volume( b->p, b->triangles, b->triangle_count ) - target;
    constraint_oracle_volume_gradient( b->p, b->vertex_count, b->triangles, b->triangle_count, b->gradient );
    double sum = 0.0;
    for ( int i = 0; i < b->vertex_count; ++i )
    {
        sum += b->w[i] * double3_dot( b->gradient[i], b->gradient[i] );
    }
    return sum > 0.0 ? c / sum : 0.0;
}

// The scale is taken before the distances, the gradients after them.
static void push_with( boundary_oracle_balloon* b, double scale )
{
    constraint_oracle_volume_gradient( b->p, b->vertex_count, b->triangles, b->triangle_count, b->gradient );
    for ( int i = 0; i < b->vertex_count; ++i )
    {
        const double along = -b->options.volume_k * scale * b->w[i];
        b->p[i] = double3_add( b->p[i], double3_scale( along, b->gradient[i] ) );
    }
}

static void project_distances( boundary_oracle_balloon* b )
{
    for ( int e = 0; e < b->edge_count; ++e )
    {
        const int* ends = b->edges + 2 * e;
        const constraint_oracle_term term = constraint_oracle_distance( b->p[ends[0]], b->p[ends[1]], b->rest[e] );
        constraint_oracle_project( &term, ends, b->w, b->options.distance_k, b->p, &b->skips );
    }
}

void boundary_oracle_balloon_step( boundary_oracle_balloon* b, double dt )
{
    const boundary_oracle_balloon_options* o = &b->options;
    const double target = o->multiplier * b->rest_volume, keep = exp( -o->decay * dt );
    for ( int i = 0; i < b->vertex_count; ++i )
    {
        const double3 weight = double3_scale( b->w[i] > 0.0 ? 1.0 / b->w[i] : 0.0, o->gravity );
        b->p[i] = balloon_oracle_predict( b->x[i], &b->v[i], b->w[i], weight, dt );
    }
    for ( int n = 0; n < o->iterations; ++n )
    {
        const double stale = o->stale_scale ? volume_scale( b, target ) : 0.0;
        project_distances( b );
        if ( o->stale_scale )
        {
            push_with( b, stale );
        }
        else
        {
            constraint_oracle_project_volume( b->p, b->w, b->vertex_count, b->triangles, b->triangle_count, target,
                                              o->volume_k, b->gradient, &b->skips );
        }
    }
    for ( int i = 0; i < b->vertex_count; ++i )
    {
        b->v[i] = double3_scale( keep, balloon_oracle_velocity( b->x[i], b->p[i], dt ) );
        b->x[i] = b->p[i];
    }
}

int boundary_oracle_balloon_gust( boundary_oracle_balloon* b, double3 gust )
{
    int total = 0;
    memset( b->hits, 0, (size_t)b->vertex_count * sizeof( int ) );
    for ( int t = 0; t < b->triangle_count; ++t )
    {
        const int* v = b->triangles + 3 * t;
        const double3 n = boundary_oracle_face_normal( ( const double3[3] ){ b->x[v[0]], b->x[v[1]], b->x[v[2]] } );
        for ( int k = 0; k < 3 && double3_dot( n, gust ) < 0.0; ++k )
        {
            if ( b->w[v[k]] > 0.0 && ( b->options.gust_per_face || b->hits[v[k]] == 0 ) )
            {
                b->v[v[k]] = double3_add( b->v[v[k]], gust );
                b->hits[v[k]] += 1;
                total += 1;
            }
        }
    }
    return total;
}

bool boundary_oracle_sphere( balloon_mesh* mesh, int slices, int stacks, double radius )
{
    const double pi = 3.14159265358979323846;
    const int rings = stacks - 1, south = slices * rings + 1;
    *mesh = ( balloon_mesh ){ .vertex_count = slices * rings + 2, .triangle_count = 2 * slices * rings };
    mesh->positions = calloc( (size_t)mesh->vertex_count, sizeof( double3 ) );
    mesh->triangles = calloc( 3 * (size_t)mesh->triangle_count, sizeof( int ) );
    if ( mesh->positions == NULL || mesh->triangles == NULL )
    {
        balloon_mesh_destroy( mesh );
        return false;
    }
    mesh->positions[0] = double3_make( 0.0, radius, 0.0 );
    mesh->positions[south] = double3_make( 0.0, -radius, 0.0 );
    int* out = mesh->triangles;
    for ( int n = 0; n < slices * rings; ++n )
    {
        // ring r, slice s; `east` is the next on the ring, `below` the ring or the pole further south
        const int r = n / slices, s = n % slices, east = 1 + r * slices + ( s + 1 ) % slices, here = 1 + n;
        const double polar = pi * ( r + 1 ) / stacks, around = 2.0 * pi * s / slices;
        mesh->positions[here] = double3_make( radius * sin( polar ) * cos( around ), radius * cos( polar ),
                                              -radius * sin( polar ) * sin( around ) );
        const bool first = r == 0, last = r == rings - 1;
        const int below = last ? south : here + slices, below_east = last ? south : east + slices;
        const int corner[6] = { here, below, east, east, below, below_east };
        memcpy( out, corner, 3 * sizeof( int ) );
        out += 3;
        if ( !last )
        {
            memcpy( out, corner + 3, 3 * sizeof( int ) );
            out += 3;
        }
        if ( first )
        {
            const int cap[3] = { 0, here, east };
            memcpy( out, cap, sizeof( cap ) );
            out += 3;
        }
    }
    return true;
}
