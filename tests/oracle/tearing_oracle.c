#include "tearing_oracle.h"

#include <math.h>
#include <string.h>

enum
{
    MAX_SPOKES = 64,
};

static const double PI = 3.14159265358979323846;

static double area_of( const tearing_oracle_mesh* m, int t )
{
    const double *a = m->rest[m->corner[t][0]], *b = m->rest[m->corner[t][1]], *c = m->rest[m->corner[t][2]];
    return 0.5 * fabs( ( b[0] - a[0] ) * ( c[1] - a[1] ) - ( b[1] - a[1] ) * ( c[0] - a[0] ) );
}

static bool has( const tearing_oracle_mesh* m, int t, int vertex )
{
    return m->corner[t][0] == vertex || m->corner[t][1] == vertex || m->corner[t][2] == vertex;
}

double tearing_oracle_tension( const tearing_oracle_mesh* m, int a, int b, double force )
{
    double areas = 0.0;
    for ( int t = 0; t < m->triangle_count; ++t )
    {
        areas += has( m, t, a ) && has( m, t, b ) ? area_of( m, t ) : 0.0;
    }
    return force * hypot( m->rest[a][0] - m->rest[b][0], m->rest[a][1] - m->rest[b][1] ) / areas;
}

// Angle from the pulled edge to another place, in [0, 2 pi).
static double angle_to( const tearing_oracle_mesh* m, int vertex, int neighbour, const double* place )
{
    const double *v = m->rest[vertex], *u = m->rest[neighbour];
    const double angle = atan2( place[1] - v[1], place[0] - v[0] ) - atan2( u[1] - v[1], u[0] - v[0] );
    return angle < 0.0 ? angle + 2.0 * PI : angle;
}

static int count_shared( const tearing_oracle_mesh* m, int a, int b )
{
    int count = 0;
    for ( int t = 0; t < m->triangle_count; ++t )
    {
        count += has( m, t, a ) && has( m, t, b ) ? 1 : 0;
    }
    return count;
}

// Neighbours of a vertex, each once.
static int list_spokes( const tearing_oracle_mesh* m, int vertex, int* spokes )
{
    int count = 0;
    for ( int t = 0; t < m->triangle_count; ++t )
    {
        for ( int k = 0; k < 3 && has( m, t, vertex ); ++k )
        {
            bool is_new = m->corner[t][k] != vertex;
            for ( int i = 0; i < count; ++i )
            {
                is_new = is_new && spokes[i] != m->corner[t][k];
            }
            if ( is_new && count < MAX_SPOKES )
            {
                spokes[count++] = m->corner[t][k];
            }
        }
    }
    return count;
}

// Triangles at the vertex that hang together with those at `start` when some spokes are cut, by spreading until nothing changes.
static void spread( const tearing_oracle_mesh* m, int vertex, int start, const int* cut, int cut_count,
                    bool* reached )
{
    memset( reached, 0, (size_t)m->triangle_count * sizeof( bool ) );
    for ( int t = 0; t < m->triangle_count; ++t )
    {
        reached[t] = has( m, t, vertex ) && has( m, t, start );
    }
    for ( bool grows = true; grows; )
    {
        grows = false;
        for ( int t = 0; t < m->triangle_count; ++t )
        {
            for ( int s = 0; s < m->triangle_count && reached[t] == false && has( m, t, vertex ); ++s )
            {
                for ( int k = 0; k < 3 && reached[s]; ++k )
                {
                    const int spoke = m->corner[s][k];
                    bool joins = spoke != vertex && has( m, t, spoke );
                    for ( int i = 0; i < cut_count; ++i )
                    {
                        joins = joins && spoke != cut[i];
                    }
                    reached[t] = reached[t] || joins;
                }
                grows = grows || reached[t];
            }
        }
    }
}

// Does what leaves hold: is one of its spokes, that is not cut, more than 95.7 degrees from the pulled edge?
static bool holds( const tearing_oracle_mesh* m, int vertex, int neighbour, const int* cut, int cut_count,
                   const bool* leaves )
{
    bool does = false;
    for ( int t = 0; t < m->triangle_count; ++t )
    {
        for ( int k = 0; k < 3 && leaves[t]; ++k )
        {
            const int spoke = m->corner[t][k];
            bool counts = spoke != vertex;
            for ( int i = 0; i < cut_count; ++i )
            {
                counts = counts && spoke != cut[i];
            }
            does = does || ( counts && cos( angle_to( m, vertex, neighbour, m->rest[spoke] ) ) < -0.1 );
        }
    }
    return does;
}

static bool take_rest( const tearing_oracle_mesh* m, int vertex, int neighbour, const int* cut, int cut_count,
                       bool* leaves )
{
    spread( m, vertex, neighbour, cut, cut_count, leaves );
    bool any = false;
    for ( int t = 0; t < m->triangle_count; ++t )
    {
        leaves[t] = has( m, t, vertex ) && leaves[t] == false;
        any = any || leaves[t];
    }
    return any;
}

bool tearing_oracle_is_inside( const tearing_oracle_mesh* m, int vertex )
{
    int spokes[MAX_SPOKES];
    const int count = list_spokes( m, vertex, spokes );
    bool is_inside = true;
    for ( int i = 0; i < count; ++i )
    {
        is_inside = is_inside && count_shared( m, vertex, spokes[i] ) == 2;
    }
    return is_inside;
}

tearing_oracle_cut tearing_oracle_cut_at( const tearing_oracle_mesh* m, int vertex, int neighbour, bool* leaves )
{
    int spokes[MAX_SPOKES];
    const int count = list_spokes( m, vertex, spokes );
    tearing_oracle_cut best = { .is_inside = tearing_oracle_is_inside( m, vertex ) };
    int chosen[2] = { -1, -1 }; // left and right of the pulled edge, or the one
    double costs[2] = { 2.0, 2.0 };
    for ( int i = 0; i < count; ++i )
    {
        const double angle = angle_to( m, vertex, neighbour, m->rest[spokes[i]] ), cost = fabs( cos( angle ) );
        const int side = best.is_inside && angle > PI ? 1 : 0;
        const bool is_inner = spokes[i] != neighbour && count_shared( m, vertex, spokes[i] ) == 2;
        if ( is_inner && cost < costs[side] &&
             ( best.is_inside || ( take_rest( m, vertex, neighbour, spokes + i, 1, leaves ) &&
                                   holds( m, vertex, neighbour, spokes + i, 1, leaves ) ) ) )
        {
            costs[side] = cost;
            chosen[side] = spokes[i];
        }
    }
    const int cut_count = best.is_inside ? 2 : 1;
    best.cost = best.is_inside ? 0.5 * ( costs[0] + costs[1] ) : costs[0];
    memcpy( best.ends, chosen, sizeof( chosen ) );
    best.is_possible = chosen[0] >= 0 && ( best.is_inside == false || chosen[1] >= 0 ) &&
                       take_rest( m, vertex, neighbour, chosen, cut_count, leaves );
    return best;
}
