// Untangling: surfaces that intersect are drawn apart. In: intersections, positions. Out: a step of their points that
// gives no velocity.
//
// - Where the intersecting edges cut a surface in two, the smaller part went through. Its edges are drawn back to the
//   side of the larger part (after Baraff, Witkin and Kass 2003, "Untangling cloth").
// - Elsewhere edge and triangle move in the direction in which the line of intersection shrinks (Volino and
//   Magnenat-Thalmann 2006, "Resolving surface collisions through intersection contour minimization").
//
// Each intersection asks for a quarter of the thickness per substep, and a point moves by one thickness at most.
// Points that are drawn go on with their common mean velocity.
#include "untangling.h"

#include "constraints.h"

#include <string.h>

// In thicknesses per substep, of an intersection and of a point.
static const float STEP = 0.25f, MAX_STEP = 1.0f;

// ---- the triangles of an edge ----

static bool find_faces( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    const size_t bytes = (size_t)s->edge_count * sizeof( *s->untangling->faces );
    if ( s->untangling->has_faces )
    {
        return true;
    }
    if ( contact_reserve( work, &s->untangling->buffer, bytes, (void**)&s->untangling->faces ) == false )
    {
        return false;
    }
    memset( s->untangling->faces, -1, bytes );
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        for ( int t = participant->first_triangle; t < participant->first_triangle + participant->triangle_count;
              ++t )
        {
            const int32_t* corner = s->triangles + 3 * (size_t)t;
            for ( int side = 0; side < 3; ++side )
            {
                const int a = corner[side], b = corner[( side + 1 ) % 3];
                int32_t* faces =
                    s->untangling->faces[contact_find_edge( s, participant, a < b ? a : b, a < b ? b : a )];
                faces[faces[0] >= 0 ? 1 : 0] = t;
            }
        }
    }
    s->untangling->has_faces = true;
    return true;
}

// ---- vectors ----

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

static const float* point_at( const contact_contact_mesh* s, int point )
{
    return s->intersection_free + (size_t)point * 4;
}

static vector normal_of( const contact_contact_mesh* s, const int32_t* t )
{
    const float* a = point_at( s, t[0] );
    return unit( cross( between( a, point_at( s, t[1] ) ), between( a, point_at( s, t[2] ) ) ) );
}

// Return the corner of a triangle that an edge does not have.
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

// ---- directions ----

// Return the direction in which the line of intersection shrinks (Volino and Magnenat-Thalmann 2006).
static vector direction_of( const contact_contact_mesh* s, const wisp_intersection* intersection )
{
    const int32_t* edge = s->edges + 2 * (size_t)intersection->edge;
    const vector along = unit( between( point_at( s, edge[0] ), point_at( s, edge[1] ) ) );
    const vector normal = normal_of( s, s->triangles + 3 * (size_t)intersection->triangle );
    const double slope = dot( along, normal );
    vector out = { 0.0, 0.0, 0.0 };
    for ( int i = 0; i < 2 && fabs( slope ) > 1e-6; ++i )
    {
        const int32_t face = s->untangling->faces[intersection->edge][i];
        if ( face < 0 )
        {
            continue;
        }
        const int32_t* t = s->triangles + 3 * (size_t)face;
        const vector inward = between( point_at( s, edge[0] ), point_at( s, opposite( t, edge ) ) );
        vector line = unit( cross( normal_of( s, t ), normal ) );
        // into the triangle: away from its edge, towards the third corner
        const vector foreign = sum( inward, scaled( along, -dot( inward, along ) ) );
        line = dot( line, foreign ) < 0.0 ? scaled( line, -1.0 ) : line;
        out = sum( out, sum( line, scaled( normal, -2.0 * dot( along, line ) / slope ) ) );
    }
    return out;
}

// The points of an intersection, with barycentric weights: of the edge first, those of the triangle negative.
typedef struct weighted_points
{
    int32_t point[5];
    float weight[5];
} weighted_points;

static weighted_points weigh( const contact_contact_mesh* s, const wisp_intersection* intersection )
{
    const int32_t *edge = s->edges + 2 * (size_t)intersection->edge,
                  *t = s->triangles + 3 * (size_t)intersection->triangle;
    const vector normal = normal_of( s, t );
    const double p = dot( normal, between( point_at( s, t[0] ), point_at( s, edge[0] ) ) );
    const double q = dot( normal, between( point_at( s, t[0] ), point_at( s, edge[1] ) ) );
    const float at = p != q ? (float)( p / ( p - q ) ) : 0.5f;
    const float third = 1.0f / 3.0f; // where in the triangle the edge passes hardly matters
    return ( weighted_points ){
        .point = { edge[0], edge[1], t[0], t[1], t[2] },
        .weight = { 1.0f - at, at, -third, -third, -third },
    };
}

// ---- steps of points ----

// Sum of the steps that all intersections of a point ask for, m. It is bounded by MAX_STEP: many together would
// throw the point.
typedef struct point_step
{
    float way[3];
} point_step;

// Add the step of an intersection to its points, distributed so that momentum is kept. Its length is always the same:
// inside a straight line of intersections, which has to move as a whole, the gradient is nearly zero.
static void add_step( contact_contact_mesh* s, point_step* steps, const wisp_intersection* intersection,
                      vector direction )
{
    const double length = sqrt( dot( direction, direction ) );
    const weighted_points row = weigh( s, intersection );
    float weights = 0.0f;
    for ( int i = 0; i < 5; ++i )
    {
        weights += s->now[(size_t)row.point[i] * 4 + 3] * row.weight[i] * row.weight[i];
    }
    if ( !( length > 0.0 ) || !( weights > 0.0f ) )
    {
        return;
    }
    const double step = (double)( STEP * s->min_thickness );
    const vector by = scaled( direction, step / ( length * (double)weights ) );
    for ( int i = 0; i < 5; ++i )
    {
        point_step* a = steps + row.point[i];
        const float fraction = s->now[(size_t)row.point[i] * 4 + 3] * row.weight[i];
        a->way[0] += fraction * (float)by.x;
        a->way[1] += fraction * (float)by.y;
        a->way[2] += fraction * (float)by.z;
    }
}

static bool has_step( const contact_contact_mesh* s, const point_step* steps, int i )
{
    const float* way = steps[i].way;
    return s->now[(size_t)i * 4 + 3] > 0.0f && ( way[0] != 0.0f || way[1] != 0.0f || way[2] != 0.0f );
}

// Compute the mean displacement in this substep of all points with a step, weighted by mass.
static void find_mean_way( const contact_contact_mesh* s, const point_step* steps, float mean[3] )
{
    double sum[3] = { 0.0, 0.0, 0.0 }, mass = 0.0;
    for ( int i = 0; i < s->point_count; ++i )
    {
        const float* now = s->now + (size_t)i * 4;
        const double m = has_step( s, steps, i ) ? 1.0 / (double)now[3] : 0.0;
        mass += m;
        for ( int k = 0; k < 3; ++k )
        {
            const size_t at = (size_t)i * 4 + (size_t)k;
            sum[k] += m * (double)( now[k] - s->intersection_free[at] - s->shift[at] );
        }
    }
    for ( int k = 0; k < 3; ++k )
    {
        mean[k] = mass > 0.0 ? (float)( sum[k] / mass ) : 0.0f;
    }
}

// Apply the steps. Points with a step get their mean velocity, which keeps momentum: a velocity of each would
// oscillate with the constraints between them.
static void apply_steps( contact_contact_mesh* s, const point_step* steps )
{
    const float most = MAX_STEP * s->min_thickness;
    float mean[3];
    find_mean_way( s, steps, mean );
    for ( int i = 0; i < s->point_count; ++i )
    {
        const float* way = steps[i].way;
        const float length = sqrtf( way[0] * way[0] + way[1] * way[1] + way[2] * way[2] );
        const float fraction = length > most ? most / length : 1.0f;
        for ( size_t k = 0, at = (size_t)i * 4; k < 3 && has_step( s, steps, i ); ++k )
        {
            s->now[at + k] += fraction * way[k];
            s->shift[at + k] = s->now[at + k] - s->intersection_free[at + k] - mean[k];
        }
    }
}

// ---- parts of a surface ----

// Find the root of a point, with path halving (union-find).
static int32_t root_of( int32_t* parent, int32_t point )
{
    while ( parent[point] != point )
    {
        parent[point] = parent[parent[point]];
        point = parent[point];
    }
    return point;
}

// Unite two sets. The lower index becomes the root, whatever the order of calls.
static void unite( int32_t* parent, int32_t a, int32_t b )
{
    a = root_of( parent, a );
    b = root_of( parent, b );
    parent[a < b ? b : a] = a < b ? a : b;
}

typedef struct parts
{
    int32_t *whole, *cut;  // [point] roots: of a connected surface, and of its parts without intersecting edges
    int32_t *size, *major; // [point] of a cut root: points; of a whole root: its largest part
} parts;

// Find the parts into which intersecting edges cut each surface, and the largest of each.
static bool find_parts( const contact_work* work, parts* p )
{
    const contact_contact_mesh* s = work->contact_mesh;
    const size_t count = (size_t)s->point_count;
    int32_t* numbers = wisp_parallel_scratch( work->parallel, work->worker, 4 * count * sizeof( int32_t ) );
    if ( numbers == NULL )
    {
        wisp_frame_fail( work->frame, WISP_NO_MEMORY, "out of memory for the parts of %d points", s->point_count );
        return false;
    }
    *p = ( parts ){ numbers, numbers + count, numbers + 2 * count, numbers + 3 * count };
    for ( int i = 0; i < s->point_count; ++i )
    {
        p->whole[i] = p->cut[i] = i;
        p->size[i] = 0;
        p->major[i] = -1;
    }
    int next = 0; // intersections come in the order of edges
    for ( int e = 0; e < s->edge_count; ++e )
    {
        const int32_t* ends = s->edges + 2 * (size_t)e;
        bool is_crossed = false;
        for ( ; next < s->intersections->intersections.count && s->intersections->intersections.list[next].edge == e;
              ++next )
        {
            is_crossed = is_crossed || contact_is_forbidden( work, s->intersections->intersections.list + next );
        }
        unite( p->whole, ends[0], ends[1] );
        if ( is_crossed == false )
        {
            unite( p->cut, ends[0], ends[1] );
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

// Return the direction of the edge relative to the triangle: towards the larger part, if the edge connects two parts;
// none if the triangle does, because its own edges move; else the one that shrinks the line of intersection.
static vector way_back( const contact_contact_mesh* s, const parts* p, const wisp_intersection* intersection )
{
    const int32_t *edge = s->edges + 2 * (size_t)intersection->edge,
                  *t = s->triangles + 3 * (size_t)intersection->triangle;
    const bool first = is_minor( p, edge[0] ), second = is_minor( p, edge[1] );
    if ( first != second )
    {
        const vector normal = normal_of( s, t );
        const double side = dot( normal, between( point_at( s, t[0] ), point_at( s, edge[first ? 1 : 0] ) ) );
        return scaled( normal, side < 0.0 ? -1.0 : 1.0 );
    }
    const bool a = is_minor( p, t[0] ), b = is_minor( p, t[1] ), c = is_minor( p, t[2] );
    return a == b && b == c ? direction_of( s, intersection ) : ( vector ){ 0.0, 0.0, 0.0 };
}

void contact_untangle( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    parts p;
    if ( work->memory->tangled == 0 || find_parts( work, &p ) == false )
    {
        return;
    }
    const size_t bytes = (size_t)s->point_count * sizeof( point_step );
    point_step* steps = wisp_parallel_scratch( work->parallel, work->worker, bytes );
    if ( steps == NULL || find_faces( work ) == false )
    {
        wisp_frame_fail( work->frame, WISP_NO_MEMORY, "out of memory to untangle %d edges", s->edge_count );
        return;
    }
    memset( steps, 0, bytes );
    for ( int c = 0; c < s->intersections->intersections.count; ++c )
    {
        if ( contact_is_forbidden( work, s->intersections->intersections.list + c ) )
        {
            add_step( s, steps, s->intersections->intersections.list + c,
                      way_back( s, &p, s->intersections->intersections.list + c ) );
        }
    }
    apply_steps( s, steps );
}

// Intersections: edges that pass through triangles, found exactly (wisp/intersections.h). In: positions. Out: the list of
// intersections; the points of those between participants that are kept apart are marked. Constraints between marked
// points are dropped, because their plane would have no right side, and untangling.c draws them apart.

bool contact_reserve_intersections( const contact_work* work )
{
    contact_intersections* x = work->contact_mesh->intersections;
    const size_t points = (size_t)work->contact_mesh->point_count;
    const bool enough = contact_reserve( work, &x->buffer, points, (void**)&x->is_tangled );
    if ( enough )
    {
        memset( x->is_tangled, 0, points );
    }
    return enough;
}

wisp_status contact_find_intersections( const contact_work* work, const float* xyzw, wisp_error* error )
{
    const contact_contact_mesh* s = work->contact_mesh;
    const wisp_intersection_args args = {
        .xyzw = xyzw,
        .edges = s->edges,
        .edge_count = s->edge_count,
        .triangles = s->triangles,
        .triangle_count = s->triangle_count,
        .kernels = wisp_frame_kernels( work->frame ),
    };
    return wisp_intersections_find( &s->intersections->intersections, work->parallel, &args, error );
}

bool contact_is_forbidden( const contact_work* work, const wisp_intersection* intersection )
{
    const contact_contact_mesh* s = work->contact_mesh;
    return contact_may_meet( contact_participant_of( work, s->edges[2 * (size_t)intersection->edge] ),
                             contact_participant_of( work, s->triangles[3 * (size_t)intersection->triangle] ) );
}

bool contact_is_movable( const contact_contact_mesh* s, const wisp_intersection* intersection )
{
    const int32_t *edge = s->edges + 2 * (size_t)intersection->edge,
                  *triangle = s->triangles + 3 * (size_t)intersection->triangle;
    const int32_t points[5] = { edge[0], edge[1], triangle[0], triangle[1], triangle[2] };
    for ( int i = 0; i < 5; ++i )
    {
        if ( s->now[(size_t)points[i] * 4 + 3] > 0.0f )
        {
            return true;
        }
    }
    return false;
}

int contact_count_intersections( const contact_contact_mesh* s, int a, int b )
{
    const wisp_intersections* found = &s->intersections->intersections;
    int count = 0;
    for ( int i = 0; i < found->count; ++i )
    {
        const int edge_of = (int)s->rest[(size_t)s->edges[2 * (size_t)found->list[i].edge] * 4 + 3],
                  triangle_of = (int)s->rest[(size_t)s->triangles[3 * (size_t)found->list[i].triangle] * 4 + 3];
        const bool is_theirs = ( edge_of == a && triangle_of == b ) || ( edge_of == b && triangle_of == a );
        count += is_theirs && contact_is_movable( s, found->list + i );
    }
    return count;
}

static void mark( contact_contact_mesh* s, const wisp_intersection* intersection )
{
    uint8_t* is_tangled = s->intersections->is_tangled;
    for ( size_t i = 0; i < 2; ++i )
    {
        is_tangled[s->edges[2 * (size_t)intersection->edge + i]] = 1;
    }
    for ( size_t i = 0; i < 3; ++i )
    {
        is_tangled[s->triangles[3 * (size_t)intersection->triangle + i]] = 1;
    }
}

wisp_status contact_mark_intersections( const contact_work* work, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    const wisp_intersections* intersections = &s->intersections->intersections;
    memset( s->intersections->is_tangled, 0, (size_t)s->point_count );
    if ( work->memory->tangled == 0 )
    {
        return WISP_OK;
    }
    const wisp_status status = contact_find_intersections( work, s->intersection_free, error );
    int count = 0;
    for ( int c = 0; c < intersections->count && status == WISP_OK; ++c )
    {
        if ( contact_is_forbidden( work, intersections->list + c ) )
        {
            mark( s, intersections->list + c );
            count += 1;
        }
    }
    work->memory->stats.tangled = count;
    work->memory->tangled = status == WISP_OK && count == 0 ? 0 : 1;
    if ( work->memory->tangled == 0 && work->counts_intersections == false )
    {
        // a kilobyte per vertex, not used again before positions are replaced
        wisp_intersections_release( &s->intersections->intersections, wisp_parallel_allocator( work->parallel ) );
    }
    return status;
}

// ---- what starts in one place ----

// In: rows after a start or a jump. Out: positions, previous and intersection-free positions of points that lay on another
// participant. Two sheets in one plane have no normal between them, so their rows can push nothing, and the first rounding would
// lay each of their points on a side of its own.

static const float COINCIDENT = 1e-3f; // of the distance to keep: nearer counts as the same place
static const float PARTED = 0.1f;      // of it: what is nearer is pushed aside as much as apart

typedef struct parting_point
{
    float normal[3]; // sum over its triangles
    float way[3];    // sum of the directions that what it lies on faces
} parting_point;

// Participants that lie in one place form a group, in the order of their numbers. One that has pins stays.
typedef struct ply
{
    int32_t group; // the lowest number in it
    int32_t level; // participants below
    int32_t base;  // of a group: level of what stays
    float step;    // m, from level to level
    bool has_pins;
} ply;

typedef struct parting
{
    const contact_work* work;
    parting_point* points;
    ply* plies;
} parting;

static int number_of( const contact_contact_mesh* s, int point )
{
    return (int)s->rest[(size_t)point * 4 + 3];
}

static bool is_coincident( const contact_work* work, const contact_row* row )
{
    const contact_participant *a = contact_participant_of( work, row->point[0] ),
                              *b = contact_participant_of( work, row->point[row->split] );
    return a != b && a->is_strands == false && b->is_strands == false && row->distance < COINCIDENT * row->requested;
}

static void add_normals( const contact_contact_mesh* s, parting_point* points )
{
    for ( int t = 0; t < s->triangle_count; ++t )
    {
        const int32_t* corner = s->triangles + 3 * (size_t)t;
        const float *a = s->intersection_free + (size_t)corner[0] * 4,
                    *b = s->intersection_free + (size_t)corner[1] * 4,
                    *c = s->intersection_free + (size_t)corner[2] * 4;
        const float e[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] },
                    f[3] = { c[0] - a[0], c[1] - a[1], c[2] - a[2] };
        for ( int k = 0; k < 3; ++k )
        {
            const int m = ( k + 1 ) % 3, n = ( k + 2 ) % 3;
            for ( int i = 0; i < 3; ++i )
            {
                points[corner[i]].normal[k] += e[m] * f[n] - e[n] * f[m];
            }
        }
    }
}

// All points of a row part along the normal of its earlier side.
static void add_ways( const parting* p, const contact_row* row )
{
    const contact_contact_mesh* s = p->work->contact_mesh;
    const bool is_first = number_of( s, row->point[0] ) < number_of( s, row->point[row->split] );
    float way[3] = { 0.0f };
    for ( int i = is_first ? 0 : row->split; i < ( is_first ? row->split : CONTACT_MAX_POINTS ); ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            way[k] += fabsf( row->weight[i] ) * p->points[row->point[i]].normal[k];
        }
    }
    const float square = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
    for ( int i = 0; i < CONTACT_MAX_POINTS && square > 0.0f; ++i )
    {
        for ( int k = 0; k < 3 && fabsf( row->weight[i] ) > COINCIDENT; ++k )
        {
            p->points[row->point[i]].way[k] += way[k] / sqrtf( square );
        }
    }
}

// Join the groups of both sides and lay the later one on the earlier one. @return whether anything changed
static bool lay( const parting* p, const contact_row* row )
{
    const int a = number_of( p->work->contact_mesh, row->point[0] ),
              b = number_of( p->work->contact_mesh, row->point[row->split] );
    ply *below = p->plies + ( a < b ? a : b ), *above = p->plies + ( a < b ? b : a );
    const float step = contact_larger( contact_larger( below->step, above->step ), PARTED * row->requested );
    const int group = below->group < above->group ? below->group : above->group;
    const bool changes = below->group != group || above->group != group || above->level <= below->level ||
                         below->step < step || above->step < step;
    below->group = above->group = group;
    below->step = above->step = step;
    above->level = above->level > below->level ? above->level : below->level + 1;
    return changes;
}

// Find which participants have pins, and at which level the first of a group is.
static void find_bases( const parting* p )
{
    const contact_contact_mesh* s = p->work->contact_mesh;
    for ( int i = 0; i < s->point_count; ++i )
    {
        ply* own = p->plies + number_of( s, i );
        own->has_pins = own->has_pins || s->now[(size_t)i * 4 + 3] == 0.0f;
    }
    for ( int g = p->work->participant_count - 1; g >= 0; --g )
    {
        if ( p->plies[g].has_pins )
        {
            p->plies[p->plies[g].group].base = p->plies[g].level;
        }
    }
}

static void move_points( const parting* p, int number )
{
    contact_contact_mesh* s = p->work->contact_mesh;
    const contact_participant* participant = p->work->participants + number;
    const ply* own = p->plies + number;
    const float length = own->step * (float)( own->level - p->plies[own->group].base );
    float* position = wisp_frame_column( p->work->frame, participant->entity, WISP_PARTICLE_POSITION, 0 );
    float* previous = wisp_frame_column( p->work->frame, participant->entity, WISP_PARTICLE_PREVIOUS, 0 );
    for ( int i = 0; i < participant->point_count; ++i )
    {
        const size_t at = (size_t)( participant->first_point + i ) * 4;
        const float* way = p->points[participant->first_point + i].way;
        const float sum = sqrtf( way[0] * way[0] + way[1] * way[1] + way[2] * way[2] );
        for ( size_t k = 0; k < 3 && sum > 0.5f && s->now[at + 3] > 0.0f; ++k )
        {
            const float step = length * way[k] / sum;
            s->now[at + k] += step;
            s->intersection_free[at + k] += step;
            position[(size_t)i * 4 + k] += step;
            previous[(size_t)i * 4 + k] += step;
        }
    }
}

// @return false without memory
static bool begin_parting( parting* p )
{
    const contact_contact_mesh* s = p->work->contact_mesh;
    const size_t points = (size_t)s->point_count * sizeof( *p->points ),
                 plies = (size_t)p->work->participant_count * sizeof( *p->plies );
    p->points = wisp_parallel_scratch( p->work->parallel, p->work->worker, points );
    p->plies = wisp_parallel_scratch( p->work->parallel, p->work->worker, plies );
    if ( p->points == NULL || p->plies == NULL )
    {
        return false;
    }
    memset( p->points, 0, points );
    memset( p->plies, 0, plies );
    for ( int g = 0; g < p->work->participant_count; ++g )
    {
        p->plies[g].group = g;
    }
    add_normals( s, p->points );
    return true;
}

bool contact_part_coincident( const contact_work* work )
{
    const contact_constraints* constraints = work->contact_mesh->constraints;
    parting p = { .work = work };
    bool any = false, changes = true;
    for ( int r = 0; r < constraints->row_count; ++r )
    {
        const contact_row* row = constraints->rows + r;
        if ( is_coincident( work, row ) )
        {
            if ( any == false && begin_parting( &p ) == false )
            {
                return false; // without memory they stay in one place
            }
            any = true;
            add_ways( &p, row );
        }
    }
    for ( int sweep = 0; sweep < work->participant_count && any && changes; ++sweep )
    {
        changes = false;
        for ( int r = 0; r < constraints->row_count; ++r )
        {
            const contact_row* row = constraints->rows + r;
            changes = ( is_coincident( work, row ) && lay( &p, row ) ) || changes;
        }
    }
    if ( any )
    {
        find_bases( &p );
    }
    for ( int g = 0; g < work->participant_count && any; ++g )
    {
        if ( work->participants[g].is_strands == false && work->participants[g].halted == false )
        {
            move_points( &p, g );
        }
    }
    return any;
}
