// Searches of a hierarchy: closest points, paths, overlaps.
#include "mesh_bvh.h"

#include "lane.h"
#include "lane_vec.h"

#include <float.h>
#include <string.h>

enum
{
    MAX_STACK = MESH_BVH_MAX_LEVELS * MESH_BVH_WIDTH,
};

// Relative to the mesh's largest coordinate: more than the rounding of a distance to a triangle.

// ---- closest points ----

typedef struct stack_entry
{
    float squared; // m^2, of the distance to the box
    int16_t level;
    int32_t group; // of its level
} stack_entry;

LANE_INLINE lane8 gap_of( const float* lower, const float* upper, lane8 p )
{
    const lane8 below = lane8_sub( lane8_loadu( lower ), p ), above = lane8_sub( p, lane8_loadu( upper ) );
    return lane8_max( lane8_max( below, above ), lane8_zero() );
}

LANE_INLINE lane8 squares_of( const mesh_bvh_group* g, const lane8 p[3] )
{
    const lane8 x = gap_of( g->lower[0], g->upper[0], p[0] ), y = gap_of( g->lower[1], g->upper[1], p[1] ),
                z = gap_of( g->lower[2], g->upper[2], p[2] );
    return lane8_add( lane8_add( lane8_mul( x, x ), lane8_mul( y, y ) ), lane8_mul( z, z ) );
}

// Limits of a search.
typedef struct closest_limits
{
    float squared; // m^2, boxes that are farther are skipped
    float near;    // m^2, likewise, however far the best triangle is
    float exact;   // m^2, triangles that are farther, in single precision, are not tested in doubles
    float slack;   // m, more than the rounding of their distance
    float clear;   // m, no triangle that was tested comes nearer in the motion
} closest_limits;

// Boxes are skipped beyond the best distance, rounded up by more than the slack of a search.
static void set_limits( const mesh_closest* search, closest_limits* limits )
{
    const float squared = (float)( search->best.squared * 1.00001 + 1e-30 );
    const float widest = sqrtf( squared ) * 1.001f + limits->slack;
    limits->squared = squared < limits->near ? squared : limits->near;
    limits->exact = widest * widest;
}

LANE_INLINE lane8v corner_of( const mesh_bvh_leaf* leaf, int corner, lane8 time, const lane8 p[3] )
{
    const float( *start )[MESH_BVH_WIDTH] = leaf->start + 3 * corner;
    const float( *displacement )[MESH_BVH_WIDTH] = leaf->displacement + 3 * corner;
    lane8 x[3];
    for ( int k = 0; k < 3; ++k )
    {
        x[k] = lane8_sub( lane8_mul_add( time, lane8_loadu( displacement[k] ), lane8_loadu( start[k] ) ), p[k] );
    }
    return ( lane8v ){ x[0], x[1], x[2] };
}

// Return the squared distance of the origin from an edge.
LANE_INLINE lane8 edge_squared( lane8v from, lane8v along )
{
    const lane8 squared = lane8_max( lane8v_dot( along, along ), lane8_set1( FLT_MIN ) );
    lane8 t = lane8_div( lane8_neg( lane8v_dot( from, along ) ), squared );
    t = lane8_min( lane8_max( t, lane8_zero() ), lane8_set1( 1.0f ) );
    const lane8v at = lane8v_mul_add( from, t, along );
    return lane8v_dot( at, at );
}

// Return about the squared distances from the triangles of a leaf: no more than those plus their rounding, and 0 where a triangle
// is so narrow at its first corner, or so large, that more cannot be said.
LANE_INLINE lane8 triangles_squared( const mesh_bvh_leaf* leaf, lane8 time, const lane8 p[3] )
{
    const lane8v a = corner_of( leaf, 0, time, p ), b = corner_of( leaf, 1, time, p ),
                 c = corner_of( leaf, 2, time, p );
    const lane8v ab = lane8v_sub( b, a ), bc = lane8v_sub( c, b ), ca = lane8v_sub( a, c ),
                 normal = lane8v_cross( ab, ca ); // inwards
    const lane8 border =
        lane8_min( edge_squared( a, ab ), lane8_min( edge_squared( b, bc ), edge_squared( c, ca ) ) );
    const lane8 area = lane8v_dot( normal, normal ), height = lane8v_dot( normal, a );
    const lane8 plane = lane8_div( lane8_mul( height, height ), area );
    // on which sides of the edges the origin is
    const lane8 by_ab = lane8v_dot( normal, lane8v_cross( ab, a ) ),
                by_bc = lane8v_dot( normal, lane8v_cross( bc, b ) ),
                by_ca = lane8v_dot( normal, lane8v_cross( ca, c ) );
    const lane8m inside =
        lane8m_and( lane8_ge( by_ab, lane8_zero() ),
                    lane8m_and( lane8_ge( by_bc, lane8_zero() ), lane8_ge( by_ca, lane8_zero() ) ) );
    const lane8m wide = lane8m_and(
        lane8_gt( area, lane8_mul( lane8_set1( 0.01f ), lane8_mul( lane8v_dot( ab, ab ), lane8v_dot( ca, ca ) ) ) ),
        lane8_le( plane, lane8_set1( FLT_MAX ) ) );
    return lane8_select( wide, lane8_select( inside, plane, border ), lane8_zero() );
}

static void add_clear( closest_limits* limits, float clear )
{
    limits->clear = clear < limits->clear ? clear : limits->clear;
}

// A single triangle is tested at once.
static void propose_one( const mesh_bvh* bvh, int leaf, int child, mesh_closest* search, closest_limits* limits )
{
    if ( mesh_closest_propose( search, bvh->triangle[leaf * MESH_BVH_WIDTH + child] ) )
    {
        set_limits( search, limits );
    }
    const float left = 1.00001f - (float)search->time;
    add_clear( limits, (float)sqrt( search->measured ) - left * bvh->leaves[leaf].shift[child] );
}

// Lanes select triangles that may be the closest; these are tested in doubles.
LANE_INLINE void propose_leaf( const mesh_bvh* bvh, int leaf, uint32_t bits, lane8 boxes, const lane8 p[3],
                               mesh_closest* search, closest_limits* limits )
{
    const mesh_bvh_leaf* kept = bvh->leaves + leaf;
    const int32_t* triangle = bvh->triangle + leaf * MESH_BVH_WIDTH;
    const lane8 found = triangles_squared( kept, lane8_set1( (float)search->time ), p );
    float squares[MESH_BVH_WIDTH];
    lane8_storeu( squares, found );
    const lane8 left = lane8_set1( 1.00001f - (float)search->time );
    const lane8 now = lane8_sub( lane8_sqrt( found ), lane8_mul( left, lane8_loadu( kept->shift ) ) );
    float clear[MESH_BVH_WIDTH];
    lane8_storeu( clear, lane8_max( now, lane8_sqrt( boxes ) ) );
    for ( int child = 0; bits != 0; ++child, bits >>= 1 )
    {
        if ( ( bits & 1u ) == 0 )
        {
            continue;
        }
        add_clear( limits, clear[child] );
        if ( squares[child] <= limits->exact && mesh_closest_propose( search, triangle[child] ) )
        {
            set_limits( search, limits );
        }
    }
}

// Push the children within the limit, the nearest on top.
static int push_children( stack_entry* stack, int count, int level, int group, uint32_t bits, const float* squares )
{
    const int bottom = count;
    for ( int child = 0; bits != 0; ++child, bits >>= 1 )
    {
        if ( ( bits & 1u ) == 0 )
        {
            continue;
        }
        int at = count++;
        for ( ; at > bottom && stack[at - 1].squared < squares[child]; --at )
        {
            stack[at] = stack[at - 1];
        }
        stack[at] = ( stack_entry ){ squares[child], (int16_t)( level - 1 ), group * MESH_BVH_WIDTH + child };
    }
    return count;
}

static void find_closest_in_tree( const mesh_bvh* bvh, mesh_closest* search, closest_limits* limits )
{
    const lane8 p[3] = { lane8_set1( (float)search->point.x ), lane8_set1( (float)search->point.y ),
                         lane8_set1( (float)search->point.z ) };
    stack_entry stack[MAX_STACK];
    int count = 1;
    stack[0] = ( stack_entry ){ 0.0f, (int16_t)( bvh->level_count - 1 ), 0 };
    while ( count > 0 )
    {
        const stack_entry top = stack[--count];
        if ( top.squared > limits->squared )
        {
            continue;
        }
        const lane8 found = squares_of( bvh->groups + bvh->first[top.level] + top.group, p );
        const uint32_t bits = lane8m_bits( lane8_le( found, lane8_set1( limits->squared ) ) );
        if ( bits != 0 && top.level == 0 && ( bits & ( bits - 1 ) ) == 0 )
        {
            propose_one( bvh, top.group, __builtin_ctz( bits ), search, limits );
        }
        else if ( bits != 0 && top.level == 0 )
        {
            propose_leaf( bvh, top.group, bits, found, p, search, limits );
        }
        else if ( bits != 0 )
        {
            float squares[MESH_BVH_WIDTH];
            lane8_storeu( squares, found );
            count = push_children( stack, count, top.level, top.group, bits, squares );
        }
    }
}

static closest_limits limits_of( const mesh_bvh* bvh, const mesh_closest* search, float near )
{
    closest_limits limits = { .near = fminf( near * near * 1.00001f + 1e-30f, 1e37f ),
                              .slack = (float)( MESH_WIDENING * bvh->surface->largest + MIN_SEARCH_SLACK ),
                              .clear = near };
    set_limits( search, &limits );
    return limits;
}

void mesh_bvh_find_closest( const mesh_bvh* bvh, mesh_closest* search )
{
    closest_limits limits = limits_of( bvh, search, INFINITY );
    find_closest_in_tree( bvh, search, &limits );
}

float mesh_bvh_find_approach( const mesh_bvh* bvh, mesh_closest* search, float near )
{
    closest_limits limits = limits_of( bvh, search, near );
    find_closest_in_tree( bvh, search, &limits );
    // boxes were skipped that are beyond the best triangle; less by the rounding of all this
    const float best = (float)sqrt( search->best.squared ), clear = best < limits.clear ? best : limits.clear;
    return clear - 1e-3f * fabsf( clear ) - limits.slack;
}

// ---- paths ----

// Test a path against the boxes of a group, slab by slab, as bits. `inverse` is 1 / step, 0 where a path does not move
// along an axis. `last` is the end, a fraction of the step.
LANE_INLINE uint32_t meets( const mesh_bvh_group* g, const float* from, const float* inverse, lane8 slack,
                            float last )
{
    lane8 begin = lane8_zero(), end = lane8_set1( last );
    lane8m inside = lane8_le( begin, end );
    for ( int k = 0; k < 3; ++k )
    {
        const lane8 p = lane8_set1( from[k] );
        const lane8 low = lane8_sub( lane8_sub( lane8_loadu( g->lower[k] ), slack ), p );
        const lane8 high = lane8_sub( lane8_add( lane8_loadu( g->upper[k] ), slack ), p );
        if ( inverse[k] == 0.0f )
        {
            inside =
                lane8m_and( inside, lane8m_and( lane8_le( low, lane8_zero() ), lane8_ge( high, lane8_zero() ) ) );
            continue;
        }
        // in the order of the path, so that an empty box, whose sides are exchanged, is never met
        const lane8 i = lane8_set1( inverse[k] ), near = lane8_mul( inverse[k] > 0.0f ? low : high, i ),
                    far = lane8_mul( inverse[k] > 0.0f ? high : low, i );
        begin = lane8_max( near, begin );
        end = lane8_min( far, end );
    }
    return lane8m_bits( lane8m_and( inside, lane8_le( begin, end ) ) );
}

// The path begins at the box of the mesh: from far away, single precision would miss the boxes.
void mesh_bvh_find_intersection( const mesh_bvh* bvh, mesh_cast* search )
{
    double begin, end;
    if ( !mesh_cast_clip( search, &begin, &end ) )
    {
        return;
    }
    const double3 step = double3_sub( search->to, search->from );
    const double3 origin = double3_mul_add( search->from, begin, step );
    const float from[3] = { (float)origin.x, (float)origin.y, (float)origin.z };
    const double each[3] = { step.x, step.y, step.z };
    float inverse[3];
    // a step along an axis that is lost within the slack counts as none: its quotient would not be finite
    const double slack = search->slack;
    for ( int k = 0; k < 3; ++k )
    {
        inverse[k] = fabs( each[k] ) > 1e-6 * slack ? (float)( 1.0 / each[k] ) : 0.0f;
    }
    const lane8 wide = lane8_set1( (float)slack );
    stack_entry stack[MAX_STACK];
    int count = 1;
    stack[0] = ( stack_entry ){ 0.0f, (int16_t)( bvh->level_count - 1 ), 0 };
    while ( count > 0 )
    {
        const stack_entry top = stack[--count];
        const double last = search->triangle >= 0 ? fmin( end, search->best.time + slack / search->length ) : end;
        uint32_t bits = meets( bvh->groups + bvh->first[top.level] + top.group, from, inverse, wide,
                               (float)( last - begin ) * 1.000001f );
        for ( int child = 0; bits != 0; ++child, bits >>= 1 )
        {
            const int32_t below = top.group * MESH_BVH_WIDTH + child;
            if ( ( bits & 1u ) != 0 && top.level > 0 )
            {
                stack[count++] = ( stack_entry ){ 0.0f, (int16_t)( top.level - 1 ), below };
            }
            else if ( ( bits & 1u ) != 0 && bvh->triangle[below] >= 0 )
            {
                mesh_cast_propose( search, bvh->triangle[below] );
            }
        }
    }
}

// ---- overlaps ----

LANE_INLINE uint32_t overlaps_box( const mesh_bvh_group* g, const float lower[3], const float upper[3] )
{
    lane8m meets = lane8_le( lane8_zero(), lane8_zero() );
    for ( int k = 0; k < 3; ++k )
    {
        meets = lane8m_and( meets, lane8_le( lane8_loadu( g->lower[k] ), lane8_set1( upper[k] ) ) );
        meets = lane8m_and( meets, lane8_ge( lane8_loadu( g->upper[k] ), lane8_set1( lower[k] ) ) );
    }
    return lane8m_bits( meets );
}

int mesh_bvh_next_overlaps( const mesh_bvh* bvh, mesh_bvh_overlap* search, const float lower[3], const float upper[3],
                            int32_t* triangles, int most )
{
    int found = 0;
    while ( search->count > 0 && found + MESH_BVH_WIDTH <= most )
    {
        const int level = search->level[--search->count];
        const int32_t group = search->group[search->count];
        uint32_t bits = overlaps_box( bvh->groups + bvh->first[level] + group, lower, upper );
        for ( int child = 0; bits != 0; ++child, bits >>= 1 )
        {
            const int32_t below = group * MESH_BVH_WIDTH + child;
            if ( ( bits & 1u ) != 0 && level > 0 )
            {
                search->group[search->count] = below;
                search->level[search->count++] = (int16_t)( level - 1 );
            }
            else if ( ( bits & 1u ) != 0 && bvh->triangle[below] >= 0 )
            {
                triangles[found++] = bvh->triangle[below];
            }
        }
    }
    return found;
}
