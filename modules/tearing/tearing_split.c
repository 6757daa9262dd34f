// Splits. In: edges above their strength. Out: triangles in which some vertices are two.
//
// A fan of triangles around a vertex v is cut along the spokes that are nearest to the perpendicular of the pulled edge v u in the rest
// shape: one spoke of an open fan, two of a closed one. The part that has u keeps v; the other part gets a new vertex. It must hold
// against the pull, or nothing would give way: one of its spokes points away from u. A spoke that is cut is an open edge from then on,
// so its other end may join two fans by a point; these part as well.
#include "tearing_state.h"
#include "wisp/module/double3.h"

#include <math.h>

// Where an edge can be cut at one of its ends.
typedef struct tearing_cut
{
    int32_t vertex;
    int first, last; // triangles [first, last) of the fan leave; of a closed fan those counted from the pulled edge
    int pulled;      // spoke
    tearing_fan fan;
    int spares;     // vertices that it needs
    bool is_inside; // the fan is closed
    double cost;    // cosine of the angle between spokes that are cut and the perpendicular's plane
} tearing_cut;

// ---- geometry at rest ----

static double3 from( const tearing_mesh* m, int32_t a, int32_t b )
{
    return double3_between( m->fabric->rest[m->parents[a]], m->fabric->rest[m->parents[b]] );
}

// Cosine of the angle between two spokes; 1 for one without length, which nothing is perpendicular to.
static double cosine( double3 a, double3 b )
{
    const double bottom = sqrt( double3_dot( a, a ) * double3_dot( b, b ) );
    return bottom > 0.0 ? double3_dot( a, b ) / bottom : 1.0;
}

// Sum of the normals of a fan, by area.
static double3 normal_of( const tearing_mesh* m, int32_t vertex, tearing_fan fan )
{
    double3 sum = { 0.0, 0.0, 0.0 };
    for ( int i = 0; i < fan.end - fan.begin; ++i )
    {
        const double3 n = double3_cross( from( m, vertex, tearing_spoke( m, fan, i ) ),
                                         from( m, vertex, tearing_spoke( m, fan, i + 1 ) ) );
        sum = ( double3 ){ sum.x + n.x, sum.y + n.y, sum.z + n.z };
    }
    return sum;
}

// A vertex that is new has no mass yet.
static bool is_pinned( const tearing_mesh* m, const float* position, int32_t vertex )
{
    return position[4 * (size_t)m->parents[vertex] + 3] == 0.0f;
}

// ---- where to cut ----

// Fans that a vertex at a spoke has more of once the spoke is cut.
static int fans_more( const tearing_mesh* m, const float* position, int32_t vertex, int32_t spoke )
{
    // a fan that is cut in two is open, and has triangles on both sides of the spoke
    for ( int32_t at = m->begin[spoke]; at < m->end[spoke] && is_pinned( m, position, spoke ) == false; )
    {
        const tearing_fan fan = tearing_next_fan( m, spoke, at );
        for ( int i = 1; i < fan.end - fan.begin; ++i )
        {
            if ( tearing_spoke( m, fan, i ) == vertex && fan.is_closed == false )
            {
                return 1;
            }
        }
        at = fan.end;
    }
    return 0;
}

// Spokes of a fan, of a closed one counted from the pulled edge.
static int32_t spoke_at( const tearing_mesh* m, const tearing_cut* cut, int i )
{
    const int count = cut->fan.end - cut->fan.begin;
    return tearing_spoke( m, cut->fan, cut->fan.is_closed ? ( cut->pulled + i ) % count : i );
}

// Does a part of a fan, spokes between two that are cut, hold against a pull?
static bool holds( const tearing_mesh* m, const tearing_cut* cut, double3 pull, int first, int last )
{
    const double AWAY = -0.1; // cosine
    bool does = false;
    for ( int i = first; i <= last && does == false; ++i )
    {
        does = cosine( pull, from( m, cut->vertex, spoke_at( m, cut, i ) ) ) < AWAY;
    }
    return does;
}

static bool cut_open( const tearing_mesh* m, double3 pull, tearing_cut* cut )
{
    const int count = cut->fan.end - cut->fan.begin;
    bool found = false;
    for ( int k = 1; k < count; ++k )
    {
        const double cost = fabs( cosine( pull, from( m, cut->vertex, spoke_at( m, cut, k ) ) ) );
        const bool is_behind = k > cut->pulled; // the part behind the spoke leaves
        if ( k != cut->pulled && ( found == false || cost < cut->cost ) &&
             holds( m, cut, pull, is_behind ? k + 1 : 0, is_behind ? count : k - 1 ) )
        {
            cut->first = is_behind ? k : 0;
            cut->last = is_behind ? count : k;
            cut->cost = cost;
            found = true;
        }
    }
    return found;
}

// The spoke on one side of the pull that is nearest to its perpendicular, 0: none. Fans turn around their normal, so that spokes on
// the left come first.
static int perpendicular( const tearing_mesh* m, const tearing_cut* cut, double3 pull, double3 normal, bool is_left,
                          double* cost )
{
    const int count = cut->fan.end - cut->fan.begin;
    int best = 0;
    for ( int k = 1; k < count; ++k )
    {
        const double3 spoke = from( m, cut->vertex, spoke_at( m, cut, k ) );
        const double side = double3_dot( double3_cross( pull, spoke ), normal ), c = fabs( cosine( pull, spoke ) );
        if ( ( is_left ? side > 0.0 : side < 0.0 ) && ( best == 0 || c < *cost ) )
        {
            best = k;
            *cost = c;
        }
    }
    return best;
}

static bool cut_closed( const tearing_mesh* m, double3 pull, tearing_cut* cut )
{
    const double3 normal = normal_of( m, cut->vertex, cut->fan );
    double left = 0.0, right = 0.0;
    cut->first = perpendicular( m, cut, pull, normal, true, &left );
    cut->last = perpendicular( m, cut, pull, normal, false, &right );
    cut->cost = 0.5 * ( left + right );
    return cut->first > 0 && cut->first < cut->last &&
           ( holds( m, cut, pull, cut->first + 1, cut->last - 1 ) || cut->last == cut->first + 1 );
}

static bool find_pulled( const tearing_mesh* m, int32_t neighbour, tearing_cut* cut )
{
    for ( int32_t at = m->begin[cut->vertex]; at < m->end[cut->vertex]; at = cut->fan.end )
    {
        cut->fan = tearing_next_fan( m, cut->vertex, at );
        for ( cut->pulled = 0; cut->pulled <= cut->fan.end - cut->fan.begin; ++cut->pulled )
        {
            if ( tearing_spoke( m, cut->fan, cut->pulled ) == neighbour )
            {
                return true;
            }
        }
    }
    return false;
}

static bool find_cut( const tearing_mesh* m, const float* position, int32_t vertex, int32_t neighbour,
                      tearing_cut* out )
{
    *out = ( tearing_cut ){ .vertex = vertex, .spares = 1 };
    if ( is_pinned( m, position, vertex ) || find_pulled( m, neighbour, out ) == false )
    {
        return false;
    }
    out->is_inside = out->fan.is_closed;
    const double3 pull = from( m, vertex, neighbour );
    if ( ( out->is_inside ? cut_closed( m, pull, out ) : cut_open( m, pull, out ) ) == false )
    {
        return false;
    }
    const int count = out->fan.end - out->fan.begin;
    out->spares += out->first > 0 ? fans_more( m, position, vertex, spoke_at( m, out, out->first ) ) : 0;
    out->spares += out->last < count ? fans_more( m, position, vertex, spoke_at( m, out, out->last ) ) : 0;
    return true;
}

// ---- cutting ----

// Turn a closed fan so that it begins at a spoke.
static void turn_fan( tearing_mesh* m, tearing_fan fan, int spoke )
{
    for ( int turn = 0; turn < spoke; ++turn )
    {
        const int32_t first = m->corner[fan.begin];
        for ( int32_t i = fan.begin; i + 1 < fan.end; ++i )
        {
            m->corner[i] = m->corner[i + 1];
        }
        m->corner[fan.end - 1] = first;
    }
}

static void reverse( int32_t* corners, int32_t begin, int32_t end )
{
    for ( int32_t i = begin, j = end - 1; i < j; ++i, --j )
    {
        const int32_t kept = corners[i];
        corners[i] = corners[j];
        corners[j] = kept;
    }
}

// Exchange two neighbouring ranges, so that what leaves is at the end of the corners of a vertex.
static void put_last( int32_t* corners, int32_t begin, int32_t middle, int32_t end )
{
    reverse( corners, begin, middle );
    reverse( corners, middle, end );
    reverse( corners, begin, end );
}

// Part the fans of a vertex. @return vertices that it became, beyond one
static int part_fans( tearing_mesh* m, const float* position, int32_t vertex )
{
    int parted = 0;
    m->touched[vertex] = 1;
    while ( is_pinned( m, position, vertex ) == false && tearing_count_fans( m, vertex ) > 1 )
    {
        const tearing_fan first = tearing_next_fan( m, vertex, m->begin[vertex] );
        const tearing_fan second = tearing_next_fan( m, vertex, first.end );
        put_last( m->corner, second.begin, second.end, m->end[vertex] );
        const int32_t end = m->end[vertex];
        const int32_t made = tearing_move_corners( m, vertex, end - ( second.end - second.begin ), end );
        m->touched[made] = 1;
        parted += 1;
    }
    return parted;
}

// @return vertices that are new
static int apply_cut( tearing_mesh* m, const float* position, const tearing_cut* cut )
{
    const int count = cut->fan.end - cut->fan.begin;
    const int32_t ends[2] = { cut->first > 0 ? spoke_at( m, cut, cut->first ) : -1,
                              cut->last < count ? spoke_at( m, cut, cut->last ) : -1 };
    if ( cut->is_inside )
    {
        turn_fan( m, cut->fan, cut->pulled );
    }
    const int32_t begin = cut->fan.begin + cut->first, end = cut->fan.begin + cut->last;
    put_last( m->corner, begin, end, m->end[cut->vertex] );
    const int32_t last = m->end[cut->vertex];
    const int32_t made = tearing_move_corners( m, cut->vertex, last - ( end - begin ), last );
    m->touched[cut->vertex] = m->touched[made] = 1;
    int splits = 1;
    for ( int k = 0; k < 2; ++k )
    {
        splits += ends[k] >= 0 ? part_fans( m, position, ends[k] ) : 0;
    }
    return splits;
}

// A vertex at the rim of the cloth or of a tear goes before one inside, the better cut before the worse.
static bool is_better( const tearing_cut* a, const tearing_cut* b )
{
    return a->is_inside != b->is_inside ? b->is_inside : a->cost < b->cost;
}

// @return vertices that are new, 0 if the edge cannot be relieved
static int split_edge( tearing_mesh* m, const float* position, const tearing_edge* edge, int spares )
{
    tearing_cut cuts[2];
    if ( m->touched[edge->slots[0]] || m->touched[edge->slots[1]] )
    {
        return 0;
    }
    const bool first = find_cut( m, position, edge->slots[0], edge->slots[1], cuts ) && cuts[0].spares <= spares;
    const bool second = find_cut( m, position, edge->slots[1], edge->slots[0], cuts + 1 ) && cuts[1].spares <= spares;
    if ( first == false && second == false )
    {
        return 0;
    }
    const bool takes_second = second && ( first == false || is_better( cuts + 1, cuts ) );
    return apply_cut( m, position, cuts + ( takes_second ? 1 : 0 ) );
}

// ---- a step ----

static int split_edges( tearing_mesh* m, const float* position, const tearing_edge* edges, int edge_count,
                        int max_splits )
{
    const int spares = tearing_count_spares( m );
    const int most = spares < max_splits ? spares : max_splits;
    int splits = 0;
    for ( int i = 0; i < edge_count && splits < most; ++i )
    {
        splits += split_edge( m, position, edges + i, most - splits );
    }
    return splits;
}

static wisp_status out_of_memory( wisp_world* world, wisp_entity surface )
{
    return wisp_world_fail( world, WISP_NO_MEMORY, "tearing: out of memory for the splits of entity %u",
                            surface.index );
}

static wisp_status split_mesh( wisp_world* world, const tearing_state* state, wisp_entity surface,
                               tearing_edge* edges )
{
    const wisp_allocator* allocator = wisp_world_allocator( world );
    const float* position = wisp_world_column( world, surface, WISP_PARTICLE_POSITION, 0 );
    tearing_settings* settings = wisp_world_column( world, surface, state->settings, 0 );
    tearing_mesh mesh;
    if ( tearing_mesh_create( wisp_world_fabric( world, surface ), allocator, &mesh ) == false )
    {
        return out_of_memory( world, surface );
    }
    const int count = tearing_list_edges( world, state, surface, edges );
    const int splits = split_edges( &mesh, position, edges, count, settings->max_splits );
    wisp_status status = WISP_OK;
    if ( splits > 0 )
    {
        const wisp_fabric* before = mesh.fabric;
        status = wisp_world_change_triangles( world, surface, mesh.triangles, mesh.parents );
        // what fails last are modules that make things anew: the triangles have changed by then
        settings->split_count += wisp_world_fabric( world, surface ) != before ? splits : 0;
        tearing_fill_limits( world, state, surface );
    }
    tearing_mesh_release( &mesh, allocator );
    return status;
}

wisp_status tearing_split( wisp_world* world, const tearing_state* state, wisp_entity surface )
{
    tearing_result* result = wisp_world_column( world, surface, state->result, 0 );
    if ( result == NULL || result->is_new == 0 || result->over_count == 0 )
    {
        return WISP_OK;
    }
    result->is_new = 0;
    const wisp_allocator* allocator = wisp_world_allocator( world );
    const size_t bytes = (size_t)result->over_count * sizeof( tearing_edge );
    tearing_edge* edges = allocator->allocate( allocator->user, bytes, 64 );
    if ( edges == NULL )
    {
        return out_of_memory( world, surface );
    }
    const wisp_status status = split_mesh( world, state, surface, edges );
    allocator->release( allocator->user, edges, bytes );
    return status;
}
