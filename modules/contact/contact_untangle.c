// What starts crossed: pairs around a crossing have no side that is right, so they are let go. Where crossed edges part a
// surface in two, the smaller part went through, and its edges are drawn back to the larger one (after Baraff, Witkin and Kass
// 2003, "Untangling cloth"). Where nothing is parted, edge and triangle are drawn along the direction in which their line of
// intersection shrinks (Volino and Magnenat-Thalmann 2006, "Resolving surface collisions through intersection contour
// minimization"). Like recovery it gives no velocity.
#include "contact_internal.h"

#include <string.h>

// Of the thickness, in a substep.
static const float STEP = 0.25f, MOST_STEP = 1.0f;

static wisp_status find_crossings( const contact_work* work, wisp_error* error )
{
    contact_soup* s = work->soup;
    const wisp_crossing_job job = {
        .quads = s->safe,
        .edges = s->edges,
        .edge_count = s->edge_count,
        .triangles = s->triangles,
        .triangle_count = s->triangle_count,
        .search = work->state->world.search,
    };
    return wisp_crossings_find( &s->crossings, work->parallel, &job, error );
}

// Guests that do not meet may pass through each other.
static bool may_cross( const contact_work* work, const wisp_crossing* crossing )
{
    const contact_soup* s = work->soup;
    const int ga = (int)s->rest[(size_t)s->edges[2 * (size_t)crossing->edge] * 4 + 3];
    const int gb = (int)s->rest[(size_t)s->triangles[3 * (size_t)crossing->triangle] * 4 + 3];
    return contact_may_meet( work->state->guests + ga, work->state->guests + gb ) == false;
}

static void mark( contact_soup* s, const wisp_crossing* crossing )
{
    for ( int i = 0; i < 2; ++i )
    {
        s->is_tangled[s->edges[2 * (size_t)crossing->edge + (size_t)i]] = 1;
    }
    for ( int i = 0; i < 3; ++i )
    {
        s->is_tangled[s->triangles[3 * (size_t)crossing->triangle + (size_t)i]] = 1;
    }
}

wisp_status contact_mark_tangles( const contact_work* work, wisp_error* error )
{
    contact_soup* s = work->soup;
    memset( s->is_tangled, 0, (size_t)s->point_count );
    if ( work->memory->tangled == 0 || work->state->world.features == WISP_CONTACT_SAMPLES )
    {
        work->memory->tangled = 0; // particles know of no crossing
        return WISP_OK;
    }
    const wisp_status status = find_crossings( work, error );
    int count = 0;
    for ( int c = 0; c < s->crossings.count && status == WISP_OK; ++c )
    {
        if ( may_cross( work, s->crossings.list + c ) == false )
        {
            mark( s, s->crossings.list + c );
            count += 1;
        }
    }
    work->memory->figures.tangled = count;
    work->memory->tangled = status == WISP_OK && count == 0 ? 0 : 1;
    return status;
}

// ---- which triangles an edge has ----

// Edges of a guest rise by their first point, then by their second.
int contact_find_edge( const contact_soup* s, const contact_guest* guest, int a, int b )
{
    int low = guest->first_edge, high = guest->first_edge + guest->edge_count - 1;
    while ( low < high )
    {
        const int middle = low + ( high - low ) / 2;
        const int32_t* e = s->edges + 2 * (size_t)middle;
        const bool is_before = e[0] < a || ( e[0] == a && e[1] < b );
        low = is_before ? middle + 1 : low;
        high = is_before ? high : middle;
    }
    return low;
}

static bool find_faces( const contact_work* work )
{
    contact_soup* s = work->soup;
    const size_t bytes = (size_t)s->edge_count * sizeof( *s->faces );
    if ( s->has_faces )
    {
        return true;
    }
    if ( contact_reserve( work, CONTACT_FACES, bytes, (void**)&s->faces ) == false )
    {
        return false;
    }
    memset( s->faces, -1, bytes );
    for ( int g = 0; g < work->state->guest_count; ++g )
    {
        const contact_guest* guest = work->state->guests + g;
        for ( int t = guest->first_triangle; t < guest->first_triangle + guest->triangle_count; ++t )
        {
            const int32_t* corner = s->triangles + 3 * (size_t)t;
            for ( int side = 0; side < 3; ++side )
            {
                const int a = corner[side], b = corner[( side + 1 ) % 3];
                int32_t* faces = s->faces[contact_find_edge( s, guest, a < b ? a : b, a < b ? b : a )];
                faces[faces[0] >= 0 ? 1 : 0] = t;
            }
        }
    }
    s->has_faces = true;
    return true;
}

// ---- drawing apart ----

typedef struct vector
{
    double x, y, z;
} vector;

static vector between( const float* a, const float* b )
{
    return ( vector ){ (double)b[0] - (double)a[0], (double)b[1] - (double)a[1], (double)b[2] - (double)a[2] };
}

static double dot( vector a, vector b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vector cross( vector a, vector b )
{
    return ( vector ){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

static vector scaled( vector a, double s )
{
    return ( vector ){ s * a.x, s * a.y, s * a.z };
}

static vector sum( vector a, vector b )
{
    return ( vector ){ a.x + b.x, a.y + b.y, a.z + b.z };
}

static vector unit( vector a )
{
    const double length = sqrt( dot( a, a ) );
    return length > 0.0 ? scaled( a, 1.0 / length ) : a;
}

static const float* safe_point( const contact_soup* s, int point )
{
    return s->safe + (size_t)point * 4;
}

static vector normal_of( const contact_soup* s, const int32_t* t )
{
    const float* a = safe_point( s, t[0] );
    return unit( cross( between( a, safe_point( s, t[1] ) ), between( a, safe_point( s, t[2] ) ) ) );
}

// Corner of a triangle that an edge does not have.
static int opposite( const int32_t* t, const int32_t* edge )
{
    for ( int i = 0; i < 3; ++i )
    {
        if ( t[i] != edge[0] && t[i] != edge[1] )
        {
            return t[i];
        }
    }
    return t[0];
}

// So that the line of intersection shrinks.
static vector direction_of( const contact_soup* s, const wisp_crossing* crossing )
{
    const int32_t* edge = s->edges + 2 * (size_t)crossing->edge;
    const vector along = unit( between( safe_point( s, edge[0] ), safe_point( s, edge[1] ) ) );
    const vector normal = normal_of( s, s->triangles + 3 * (size_t)crossing->triangle );
    const double slope = dot( along, normal );
    vector out = { 0.0, 0.0, 0.0 };
    for ( int i = 0; i < 2 && fabs( slope ) > 1e-6; ++i )
    {
        const int32_t face = s->faces[crossing->edge][i];
        if ( face < 0 )
        {
            continue;
        }
        const int32_t* t = s->triangles + 3 * (size_t)face;
        const vector inward = between( safe_point( s, edge[0] ), safe_point( s, opposite( t, edge ) ) );
        vector line = unit( cross( normal_of( s, t ), normal ) );
        // into the triangle: away from its edge, towards the third corner
        const vector across = sum( inward, scaled( along, -dot( inward, along ) ) );
        line = dot( line, across ) < 0.0 ? scaled( line, -1.0 ) : line;
        out = sum( out, sum( line, scaled( normal, -2.0 * dot( along, line ) / slope ) ) );
    }
    return out;
}

static void weigh( const contact_soup* s, const wisp_crossing* crossing, contact_row* row )
{
    const int32_t *edge = s->edges + 2 * (size_t)crossing->edge, *t = s->triangles + 3 * (size_t)crossing->triangle;
    const vector normal = normal_of( s, t );
    const double p = dot( normal, between( safe_point( s, t[0] ), safe_point( s, edge[0] ) ) );
    const double q = dot( normal, between( safe_point( s, t[0] ), safe_point( s, edge[1] ) ) );
    const float at = p != q ? (float)( p / ( p - q ) ) : 0.5f;
    const float third = 1.0f / 3.0f; // of the triangle: where in it the edge passes hardly matters
    *row = ( contact_row ){
        .count = 5,
        .split = 2,
        .point = { edge[0], edge[1], t[0], t[1], t[2] },
        .weight = { 1.0f - at, at, -third, -third, -third },
    };
}

// What all crossings of a point ask of it, m. It goes no farther than MOST_STEP, or many together would throw it.
typedef struct asked_way
{
    float way[3];
} asked_way;

static void ask( contact_soup* s, asked_way* asked, const wisp_crossing* crossing, vector direction )
{
    const double length = sqrt( dot( direction, direction ) );
    contact_row row;
    weigh( s, crossing, &row );
    float weights = 0.0f;
    for ( int i = 0; i < row.count; ++i )
    {
        weights += s->now[(size_t)row.point[i] * 4 + 3] * row.weight[i] * row.weight[i];
    }
    if ( !( length > 0.0 ) || !( weights > 0.0f ) )
    {
        return;
    }
    const double step = (double)( STEP * s->least_thickness ) * ( length < 1.0 ? length : 1.0 );
    const vector by = scaled( direction, step / ( length * (double)weights ) );
    for ( int i = 0; i < row.count; ++i )
    {
        asked_way* a = asked + row.point[i];
        const float share = s->now[(size_t)row.point[i] * 4 + 3] * row.weight[i];
        a->way[0] += share * (float)by.x;
        a->way[1] += share * (float)by.y;
        a->way[2] += share * (float)by.z;
    }
}

static bool is_asked( const contact_soup* s, const asked_way* asked, int i )
{
    const float* way = asked[i].way;
    return s->now[(size_t)i * 4 + 3] > 0.0f && ( way[0] != 0.0f || way[1] != 0.0f || way[2] != 0.0f );
}

// What those that are drawn would go in this substep by themselves, all together, by mass.
static void find_mean_way( const contact_soup* s, const asked_way* asked, float mean[3] )
{
    double sum[3] = { 0.0, 0.0, 0.0 }, mass = 0.0;
    for ( int i = 0; i < s->point_count; ++i )
    {
        const float* now = s->now + (size_t)i * 4;
        const double m = is_asked( s, asked, i ) ? 1.0 / (double)now[3] : 0.0;
        mass += m;
        for ( int k = 0; k < 3; ++k )
        {
            const size_t at = (size_t)i * 4 + (size_t)k;
            sum[k] += m * (double)( now[k] - s->safe[at] - s->shift[at] );
        }
    }
    for ( int k = 0; k < 3; ++k )
    {
        mean[k] = mass > 0.0 ? (float)( sum[k] / mass ) : 0.0f;
    }
}

// Links that were drawn along would throw points back and forth, so those that are drawn go on together: momentum is kept.
static void go( contact_soup* s, const asked_way* asked )
{
    const float most = MOST_STEP * s->least_thickness;
    float mean[3];
    find_mean_way( s, asked, mean );
    for ( int i = 0; i < s->point_count; ++i )
    {
        const float* way = asked[i].way;
        const float length = sqrtf( way[0] * way[0] + way[1] * way[1] + way[2] * way[2] );
        const float share = length > most ? most / length : 1.0f;
        for ( size_t k = 0, at = (size_t)i * 4; k < 3 && is_asked( s, asked, i ); ++k )
        {
            s->now[at + k] += share * way[k];
            s->shift[at + k] = s->now[at + k] - s->safe[at + k] - mean[k];
        }
    }
}

// ---- which part of a surface is on the wrong side ----

// Find with halving of ways.
static int32_t root_of( int32_t* parent, int32_t point )
{
    while ( parent[point] != point )
    {
        parent[point] = parent[parent[point]];
        point = parent[point];
    }
    return point;
}

// The lower number is the root, so that it depends on nothing else.
static void join( int32_t* parent, int32_t a, int32_t b )
{
    a = root_of( parent, a );
    b = root_of( parent, b );
    parent[a < b ? b : a] = a < b ? a : b;
}

typedef struct parts
{
    int32_t *whole, *cut;  // [point] roots: of a connected surface, and of what is left of it without crossed edges
    int32_t *size, *major; // [point] of a cut root: points; of a whole root: its largest part
} parts;

// Crossed edges may part a surface in two: then the smaller part is what went through.
static bool find_parts( const contact_work* work, parts* p )
{
    const contact_soup* s = work->soup;
    const size_t count = (size_t)s->point_count;
    int32_t* numbers = wisp_parallel_scratch( work->parallel, work->worker, 4 * count * sizeof( int32_t ) );
    if ( numbers == NULL )
    {
        wisp_frame_fail( work->frame, WISP_NO_MEMORY, "no memory for the parts of %d points", s->point_count );
        return false;
    }
    *p = ( parts ){ numbers, numbers + count, numbers + 2 * count, numbers + 3 * count };
    for ( int i = 0; i < s->point_count; ++i )
    {
        p->whole[i] = p->cut[i] = i;
        p->size[i] = 0;
        p->major[i] = -1;
    }
    int next = 0; // crossings come in the order of edges
    for ( int e = 0; e < s->edge_count; ++e )
    {
        const int32_t* ends = s->edges + 2 * (size_t)e;
        bool is_crossed = false;
        for ( ; next < s->crossings.count && s->crossings.list[next].edge == e; ++next )
        {
            is_crossed = is_crossed || may_cross( work, s->crossings.list + next ) == false;
        }
        join( p->whole, ends[0], ends[1] );
        if ( is_crossed == false )
        {
            join( p->cut, ends[0], ends[1] );
        }
    }
    for ( int i = 0; i < s->point_count; ++i )
    {
        p->size[root_of( p->cut, i )] += 1;
    }
    for ( int i = 0; i < s->point_count; ++i )
    {
        const int32_t whole = root_of( p->whole, i );
        const bool is_larger = p->major[whole] < 0 || p->size[i] > p->size[p->major[whole]];
        p->major[whole] = is_larger ? i : p->major[whole];
    }
    return true;
}

static bool is_minor( const parts* p, int point )
{
    return root_of( p->cut, point ) != p->major[root_of( p->whole, point )];
}

// Where the edge goes against the triangle: back to where the larger part is, if it joins two; if the triangle does, its own
// edges are drawn; and where nothing is parted the line of intersection shrinks.
static vector way_back( const contact_soup* s, const parts* p, const wisp_crossing* crossing )
{
    const int32_t *edge = s->edges + 2 * (size_t)crossing->edge, *t = s->triangles + 3 * (size_t)crossing->triangle;
    const bool first = is_minor( p, edge[0] ), second = is_minor( p, edge[1] );
    if ( first != second )
    {
        const vector normal = normal_of( s, t );
        const double side = dot( normal, between( safe_point( s, t[0] ), safe_point( s, edge[first ? 1 : 0] ) ) );
        return scaled( normal, side < 0.0 ? -1.0 : 1.0 );
    }
    const bool a = is_minor( p, t[0] ), b = is_minor( p, t[1] ), c = is_minor( p, t[2] );
    return a == b && b == c ? direction_of( s, crossing ) : ( vector ){ 0.0, 0.0, 0.0 };
}

void contact_untangle( const contact_work* work )
{
    contact_soup* s = work->soup;
    parts p;
    if ( work->memory->tangled == 0 || find_parts( work, &p ) == false )
    {
        return;
    }
    const size_t bytes = (size_t)s->point_count * sizeof( asked_way );
    asked_way* asked = wisp_parallel_scratch( work->parallel, work->worker, bytes );
    if ( asked == NULL || find_faces( work ) == false )
    {
        wisp_frame_fail( work->frame, WISP_NO_MEMORY, "no memory to untangle %d edges", s->edge_count );
        return;
    }
    memset( asked, 0, bytes );
    for ( int c = 0; c < s->crossings.count; ++c )
    {
        if ( may_cross( work, s->crossings.list + c ) == false )
        {
            ask( s, asked, s->crossings.list + c, way_back( s, &p, s->crossings.list + c ) );
        }
    }
    go( s, asked );
}
