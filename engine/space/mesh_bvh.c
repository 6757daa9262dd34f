#include "mesh_bvh.h"

#include "alloc.h"
#include "lane.h"

#include <float.h>
#include <string.h>

enum
{
    REFIT_GRAIN = 64, // groups of leaves per block
    MAX_STACK = MESH_BVH_MAX_LEVELS * MESH_BVH_WIDTH,
};

// Relative to the mesh's largest coordinate: more than the rounding of a distance to a box.
static const double WIDENING = 4e-6;

// ---- order ----

// Doubled centres of triangles, and the order that is sorted.
typedef struct splitter
{
    float ( *centre )[3];
    int32_t* order;
} splitter;

static int find_longest_axis( const splitter* s, int begin, int end )
{
    float lower[3], upper[3];
    memcpy( lower, s->centre[s->order[begin]], sizeof( lower ) );
    memcpy( upper, lower, sizeof( upper ) );
    for ( int i = begin + 1; i < end; ++i )
    {
        const float* c = s->centre[s->order[i]];
        for ( int k = 0; k < 3; ++k )
        {
            lower[k] = fminf( lower[k], c[k] );
            upper[k] = fmaxf( upper[k], c[k] );
        }
    }
    int axis = 0;
    for ( int k = 1; k < 3; ++k )
    {
        axis = upper[k] - lower[k] > upper[axis] - lower[axis] ? k : axis;
    }
    return axis;
}

// Orders triangles along an axis, equals by their index.
static bool is_before( const splitter* s, int axis, int32_t a, int32_t b )
{
    const float x = s->centre[a][axis], y = s->centre[b][axis];
    return x < y || ( x == y && a < b );
}

static void exchange( int32_t* a, int32_t* b )
{
    const int32_t kept = *a;
    *a = *b;
    *b = kept;
}

// Partition so that what is before `middle` is before all others along the axis (Hoare 1961).
static void select_middle( const splitter* s, int axis, int begin, int end, int middle )
{
    int first = begin, last = end - 1;
    while ( first < last )
    {
        const int32_t pivot = s->order[first + ( last - first ) / 2];
        int i = first, j = last;
        while ( i <= j )
        {
            while ( is_before( s, axis, s->order[i], pivot ) )
            {
                ++i;
            }
            while ( is_before( s, axis, pivot, s->order[j] ) )
            {
                --j;
            }
            if ( i <= j )
            {
                exchange( s->order + i++, s->order + j-- );
            }
        }
        if ( middle > j && middle < i )
        {
            return;
        }
        first = middle >= i ? i : first;
        last = middle <= j ? j : last;
    }
}

// Split a range at a multiple of the size of its children, which is 8 to some power, so that only the last child of a level
// is smaller.
static void split( const splitter* s, int begin, int end )
{
    const int count = end - begin;
    if ( count <= MESH_BVH_WIDTH )
    {
        return;
    }
    int64_t child = MESH_BVH_WIDTH;
    while ( child * MESH_BVH_WIDTH < count )
    {
        child *= MESH_BVH_WIDTH;
    }
    const int64_t children = ( count + child - 1 ) / child;
    const int middle = begin + (int)( children / 2 * child );
    select_middle( s, find_longest_axis( s, begin, end ), begin, end, middle );
    split( s, begin, middle );
    split( s, middle, end );
}

// ---- construction ----

static size_t leaves_of( const mesh_surface* s )
{
    return ( (size_t)s->triangle_count + MESH_BVH_WIDTH - 1 ) / MESH_BVH_WIDTH;
}

static size_t triangle_bytes( const mesh_bvh* bvh )
{
    return leaves_of( bvh->surface ) * MESH_BVH_WIDTH * sizeof( int32_t );
}

static size_t shift_bytes( const mesh_bvh* bvh )
{
    return leaves_of( bvh->surface ) * MESH_BVH_WIDTH * sizeof( float );
}

static size_t group_bytes( const mesh_bvh* bvh )
{
    return (size_t)bvh->first[bvh->level_count] * sizeof( mesh_bvh_group );
}

static void lay_out_levels( mesh_bvh* bvh )
{
    size_t count = leaves_of( bvh->surface );
    bvh->level_count = 0;
    bvh->first[0] = 0;
    for ( bool is_root = false; is_root == false; count = ( count + MESH_BVH_WIDTH - 1 ) / MESH_BVH_WIDTH )
    {
        is_root = count == 1;
        bvh->first[bvh->level_count + 1] = bvh->first[bvh->level_count] + (int)count;
        bvh->level_count += 1;
    }
}

static void sort_triangles( mesh_bvh* bvh, float ( *centre )[3] )
{
    const mesh_surface* s = bvh->surface;
    const int padded = (int)leaves_of( s ) * MESH_BVH_WIDTH;
    for ( int32_t t = 0; t < s->triangle_count; ++t )
    {
        float lower[3], upper[3];
        mesh_surface_box( s, t, lower, upper );
        for ( int k = 0; k < 3; ++k )
        {
            centre[t][k] = lower[k] + upper[k];
        }
        bvh->triangle[t] = t;
    }
    for ( int i = s->triangle_count; i < padded; ++i )
    {
        bvh->triangle[i] = -1;
    }
    split( &( splitter ){ centre, bvh->triangle }, 0, s->triangle_count );
}

wisp_status mesh_bvh_build( mesh_bvh* bvh, const mesh_surface* surface, wisp_error* error )
{
    *bvh = ( mesh_bvh ){ .surface = surface };
    lay_out_levels( bvh );
    const wisp_allocator* allocator = &surface->allocator;
    const size_t centre_bytes = (size_t)surface->triangle_count * 3 * sizeof( float );
    float( *centre )[3] = base_allocate( allocator, centre_bytes, BASE_BUFFER_ALIGNMENT );
    bvh->triangle = base_allocate( allocator, triangle_bytes( bvh ), BASE_BUFFER_ALIGNMENT );
    bvh->shift = base_allocate( allocator, shift_bytes( bvh ), BASE_BUFFER_ALIGNMENT );
    bvh->groups = base_allocate( allocator, group_bytes( bvh ), BASE_BUFFER_ALIGNMENT );
    const bool enough = centre != NULL && bvh->triangle != NULL && bvh->shift != NULL && bvh->groups != NULL;
    if ( enough )
    {
        sort_triangles( bvh, centre );
        mesh_bvh_refit( bvh, NULL );
        bvh->refit_count = 0;
    }
    else
    {
        mesh_bvh_release( bvh );
    }
    base_release( allocator, centre, centre_bytes );
    return enough ? WISP_OK
                  : wisp_fail( error, WISP_NO_MEMORY, "out of memory for a mesh collider of %d triangles",
                               surface->triangle_count );
}

void mesh_bvh_release( mesh_bvh* bvh )
{
    if ( bvh->surface != NULL )
    {
        base_release( &bvh->surface->allocator, bvh->triangle, triangle_bytes( bvh ) );
        base_release( &bvh->surface->allocator, bvh->shift, shift_bytes( bvh ) );
        base_release( &bvh->surface->allocator, bvh->groups, group_bytes( bvh ) );
    }
    *bvh = ( mesh_bvh ){ 0 };
}

size_t mesh_bvh_bytes( const mesh_bvh* bvh )
{
    return triangle_bytes( bvh ) + shift_bytes( bvh ) + group_bytes( bvh );
}

// ---- refit ----

static void clear_child( mesh_bvh_group* group, int child )
{
    for ( int k = 0; k < 3; ++k )
    {
        group->lower[k][child] = FLT_MAX;
        group->upper[k][child] = -FLT_MAX;
    }
}

static float shift_of( const mesh_surface* s, int32_t triangle )
{
    float most = 0.0f;
    for ( int corner = 0; corner < 3 && s->start != NULL; ++corner )
    {
        const size_t quad = 4 * (size_t)s->triangles[3 * (size_t)triangle + (size_t)corner];
        const float x = s->xyzw[quad] - s->start[quad], y = s->xyzw[quad + 1] - s->start[quad + 1],
                    z = s->xyzw[quad + 2] - s->start[quad + 2], squared = x * x + y * y + z * z;
        most = squared > most ? squared : most;
    }
    return 1.00001f * sqrtf( most );
}

static void refit_leaf( const mesh_bvh* bvh, int leaf, float widening )
{
    mesh_bvh_group* group = bvh->groups + leaf;
    for ( int child = 0; child < MESH_BVH_WIDTH; ++child )
    {
        const int32_t triangle = bvh->triangle[leaf * MESH_BVH_WIDTH + child];
        if ( triangle < 0 )
        {
            clear_child( group, child );
            continue;
        }
        float lower[3], upper[3];
        mesh_surface_box( bvh->surface, triangle, lower, upper );
        bvh->shift[leaf * MESH_BVH_WIDTH + child] = shift_of( bvh->surface, triangle );
        for ( int k = 0; k < 3; ++k )
        {
            group->lower[k][child] = lower[k] - widening;
            group->upper[k][child] = upper[k] + widening;
        }
    }
}

static void refit_leaves( void* context, int begin, int end, int worker )
{
    (void)worker;
    const mesh_bvh* bvh = context;
    const float widening = (float)( WIDENING * bvh->surface->largest + MIN_SEARCH_SLACK );
    for ( int leaf = begin; leaf < end; ++leaf )
    {
        refit_leaf( bvh, leaf, widening );
    }
}

static float least_of( const float* v )
{
    float least = v[0];
    for ( int i = 1; i < MESH_BVH_WIDTH; ++i )
    {
        least = v[i] < least ? v[i] : least;
    }
    return least;
}

static float most_of( const float* v )
{
    float most = v[0];
    for ( int i = 1; i < MESH_BVH_WIDTH; ++i )
    {
        most = v[i] > most ? v[i] : most;
    }
    return most;
}

// Bound the children of the groups of a level by the groups below.
static void refit_level( mesh_bvh* bvh, int level )
{
    const mesh_bvh_group* below = bvh->groups + bvh->first[level - 1];
    const int count = bvh->first[level] - bvh->first[level - 1];
    const int padded = ( bvh->first[level + 1] - bvh->first[level] ) * MESH_BVH_WIDTH;
    for ( int i = 0; i < padded; ++i )
    {
        mesh_bvh_group* group = bvh->groups + bvh->first[level] + i / MESH_BVH_WIDTH;
        const int child = i % MESH_BVH_WIDTH;
        if ( i >= count )
        {
            clear_child( group, child );
            continue;
        }
        for ( int k = 0; k < 3; ++k )
        {
            group->lower[k][child] = least_of( below[i].lower[k] );
            group->upper[k][child] = most_of( below[i].upper[k] );
        }
    }
}

void mesh_bvh_refit( mesh_bvh* bvh, const wisp_parallel* parallel )
{
    const int leaves = bvh->first[1];
    if ( parallel != NULL )
    {
        wisp_parallel_for( parallel, leaves, REFIT_GRAIN, refit_leaves, bvh );
    }
    else
    {
        refit_leaves( bvh, 0, leaves, 0 );
    }
    for ( int level = 1; level < bvh->level_count; ++level )
    {
        refit_level( bvh, level );
    }
    bvh->refit_count += 1;
}

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
    double clear;  // m, no triangle that was tested comes nearer in the motion
} closest_limits;

// Return the square beyond which boxes are skipped, rounded up by more than the slack of a search.
static float limit_of( const mesh_closest* search, float near )
{
    const float limit = (float)( search->best.squared * 1.00001 + 1e-30 );
    return limit < near ? limit : near;
}

static void propose_leaf( const mesh_bvh* bvh, int leaf, uint32_t bits, const float* squares, bool is_approach,
                          mesh_closest* search, closest_limits* limits )
{
    const int32_t* triangle = bvh->triangle + leaf * MESH_BVH_WIDTH;
    for ( int child = 0; bits != 0; ++child, bits >>= 1 )
    {
        if ( ( bits & 1u ) == 0 || squares[child] > limits->squared )
        {
            continue;
        }
        if ( mesh_closest_propose( search, triangle[child] ) )
        {
            limits->squared = limit_of( search, limits->near );
        }
        if ( is_approach )
        {
            const double left = 1.0 - search->time, shift = (double)bvh->shift[leaf * MESH_BVH_WIDTH + child];
            const double clear = sqrt( search->measured ) - left * shift;
            limits->clear = clear < limits->clear ? clear : limits->clear;
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

LANE_INLINE void find_closest( const mesh_bvh* bvh, bool is_approach, mesh_closest* search, closest_limits* limits )
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
        if ( bits == 0 )
        {
            continue;
        }
        float squares[MESH_BVH_WIDTH];
        lane8_storeu( squares, found );
        if ( top.level == 0 )
        {
            propose_leaf( bvh, top.group, bits, squares, is_approach, search, limits );
        }
        else
        {
            count = push_children( stack, count, top.level, top.group, bits, squares );
        }
    }
}

void mesh_bvh_find_closest( const mesh_bvh* bvh, mesh_closest* search )
{
    const float all = 1e37f;
    closest_limits limits = { limit_of( search, all ), all, INFINITY };
    find_closest( bvh, false, search, &limits );
}

float mesh_bvh_find_approach( const mesh_bvh* bvh, mesh_closest* search, float near )
{
    const float square = fminf( near * near * 1.00001f + 1e-30f, 1e37f );
    closest_limits limits = { limit_of( search, square ), square, (double)near };
    find_closest( bvh, true, search, &limits );
    // boxes were skipped that are beyond the best triangle; less by the rounding of all this
    const double best = sqrt( search->best.squared ), clear = best < limits.clear ? best : limits.clear;
    return (float)( clear - 1e-6 * ( fabs( clear ) + bvh->surface->largest ) );
}

// ---- paths ----

// Test a path against the boxes of a group, slab by slab, as bits. `inverse` is 1 / step, 0 where a path does not move
// along an axis.
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

void mesh_bvh_find_intersection( const mesh_bvh* bvh, mesh_cast* search )
{
    const double3 step = double3_sub( search->to, search->from );
    const float from[3] = { (float)search->from.x, (float)search->from.y, (float)search->from.z };
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
        const float last =
            search->triangle >= 0 ? (float)fmin( 1.0, search->best.time + slack / search->length ) : 1.0f;
        uint32_t bits =
            meets( bvh->groups + bvh->first[top.level] + top.group, from, inverse, wide, last * 1.000001f );
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

LANE_INLINE uint32_t overlaps( const mesh_bvh_group* g, const float lower[3], const float upper[3] )
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
        uint32_t bits = overlaps( bvh->groups + bvh->first[level] + group, lower, upper );
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
