// Lines of entities for a host's renderer, and picking: both walk the rows of the engine, and need no request.
#include "inspect.h"

#include "wisp/fabric.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>

static wisp_vec3 add_scaled( wisp_vec3 a, wisp_vec3 b, float s )
{
    return ( wisp_vec3 ){ a.x + s * b.x, a.y + s * b.y, a.z + s * b.z };
}

static wisp_vec3 minus( wisp_vec3 a, wisp_vec3 b )
{
    return add_scaled( a, b, -1.0f );
}

static float dot( wisp_vec3 a, wisp_vec3 b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static wisp_vec3 cross( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

static float length( wisp_vec3 a )
{
    return sqrtf( dot( a, a ) );
}

// ---- segments of an entity: edges of a surface, or of strands ----

typedef struct segment
{
    wisp_vec3 ends[2];   // m, the host's
    int32_t vertices[2]; // the user's
    float rest;          // m; 0: unknown
} segment;

typedef void segment_fn( void* user, const segment* s );

static wisp_vec3 row( const float* rows, int32_t slot, wisp_vec3 offset )
{
    const float* x = rows + (size_t)slot * 4;
    return minus( ( wisp_vec3 ){ x[0], x[1], x[2] }, offset );
}

static wisp_status walk_edges( wisp_world* world, wisp_entity surface, const wisp_fabric* f, segment_fn* run,
                               void* user )
{
    WISP_TRY( wisp_world_need_fabric( world, surface, WISP_FABRIC_EDGES ) );
    const float* x = wisp_world_column( world, surface, WISP_PARTICLE_POSITION, 0 );
    const wisp_vec3 offset = wisp_world_offset( world, surface );
    for ( int e = 0; e < f->edge_count; ++e )
    {
        const int32_t a = f->edges[2 * e], b = f->edges[2 * e + 1];
        const segment s = { { row( x, a, offset ), row( x, b, offset ) },
                            { f->slot_vertex[a], f->slot_vertex[b] },
                            length( minus( f->rest[a], f->rest[b] ) ) };
        run( user, &s );
    }
    return WISP_OK;
}

static wisp_vec3 lane( const float* rows, int r, int l, wisp_vec3 offset )
{
    const float* x = rows + (size_t)r * 48 + l;
    return minus( ( wisp_vec3 ){ x[0], x[16], x[32] }, offset );
}

static void walk_strands( wisp_world* world, wisp_entity strands, const wisp_strand_topology* t, segment_fn* run,
                          void* user )
{
    const float* x = wisp_world_column( world, strands, WISP_STRAND_POSITION, 0 );
    const float* rest = wisp_world_column( world, strands, WISP_STRAND_LENGTH, 0 );
    const wisp_vec3 offset = wisp_world_offset( world, strands );
    for ( int i = 0; i < 16 * t->group_count; ++i )
    {
        const int l = i % 16, first = t->group_row[i / 16];
        for ( int k = 0; k + 1 < t->lane_count[i]; ++k )
        {
            const int32_t vertex = t->offsets[t->lane_strand[i]] + k;
            const segment s = { { lane( x, first + k, l, offset ), lane( x, first + k + 1, l, offset ) },
                                { vertex, vertex + 1 },
                                rest ? rest[( first + k ) * 16 + l] : 0.0f };
            run( user, &s );
        }
    }
}

// ---- lines ----

typedef struct line_list
{
    wisp_line* lines;
    int capacity, count;
    double lengths; // m, of all links
} line_list;

static void put( line_list* list, wisp_vec3 from, wisp_vec3 to, wisp_line_kind kind, float value )
{
    if ( list->count < list->capacity )
    {
        list->lines[list->count] = ( wisp_line ){ from, to, kind, value };
    }
    ++list->count;
}

static void put_link( void* user, const segment* s )
{
    line_list* list = user;
    const float now = length( minus( s->ends[1], s->ends[0] ) );
    list->lengths += (double)now;
    put( list, s->ends[0], s->ends[1], WISP_LINE_LINK, s->rest > 0.0f ? now / s->rest - 1.0f : 0.0f );
}

static void put_pins( line_list* list, wisp_world* world, wisp_entity surface, const wisp_fabric* f )
{
    const wisp_vec3 axes[] = { { 1.0f, 0.0f, 0.0f }, { 0.0f, 1.0f, 0.0f }, { 0.0f, 0.0f, 1.0f } };
    const float* x = wisp_world_column( world, surface, WISP_PARTICLE_POSITION, 0 );
    const float size = list->count > 0 ? (float)( 0.25 * list->lengths / list->count ) : 0.0f;
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        const int32_t slot = f->vertex_slot[v];
        const wisp_vec3 p = row( x, slot, wisp_world_offset( world, surface ) );
        for ( int axis = 0; axis < 3 && x[4 * slot + 3] == 0.0f; ++axis )
        {
            put( list, add_scaled( p, axes[axis], -size ), add_scaled( p, axes[axis], size ), WISP_LINE_PIN, 0.0f );
        }
    }
}

static wisp_status find_kind( wisp_world* world, wisp_entity entity, const wisp_fabric** fabric,
                              const wisp_strand_topology** strands )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    *strands = wisp_has_strands( world, entity ) ? wisp_world_strands( world, entity ) : NULL;
    *fabric = *strands ? NULL : wisp_world_fabric( world, entity );
    return *fabric || *strands
               ? WISP_OK
               : wisp_world_fail( world, WISP_CONFLICT, "entity %u is neither a surface nor strands", entity.index );
}

int wisp_draw_lines( wisp_world* world, wisp_entity entity, wisp_line* out, int capacity )
{
    line_list list = { out, capacity, 0, 0.0 };
    const wisp_fabric* fabric;
    const wisp_strand_topology* strands;
    if ( find_kind( world, entity, &fabric, &strands ) != WISP_OK ||
         ( capacity != 0 && wisp_world_check_list( world, "out", out, capacity ) != WISP_OK ) )
    {
        return -1;
    }
    if ( strands )
    {
        walk_strands( world, entity, strands, put_link, &list );
        return list.count;
    }
    if ( walk_edges( world, entity, fabric, put_link, &list ) != WISP_OK )
    {
        return -1;
    }
    put_pins( &list, world, entity, fabric );
    return list.count;
}

// ---- picking ----

typedef struct search
{
    wisp_vec3 from, way;   // m
    float radius, nearest; // m; of a way its fraction, of a point the distance
    wisp_pick* out;
} search;

static void keep( search* s, float measure, wisp_vec3 point, int32_t vertex, int32_t triangle )
{
    s->nearest = measure;
    *s->out = ( wisp_pick ){ vertex, triangle, point, length( minus( point, s->from ) ) };
}

// The closest points of the way and the segment, clamped to both (Ericson 2004, section 5.1.9).
static void meet_segment( void* user, const segment* g )
{
    search* s = user;
    const wisp_vec3 along = minus( g->ends[1], g->ends[0] ), r = minus( s->from, g->ends[0] );
    const float a = dot( s->way, s->way ), e = dot( along, along ), f = dot( along, r ), b = dot( s->way, along ),
                c = dot( s->way, r ), d = a * e - b * b;
    float way = d > 0.0f ? fminf( fmaxf( ( b * f - c * e ) / d, 0.0f ), 1.0f ) : 0.0f;
    const float t = e > 0.0f ? fminf( fmaxf( ( b * way + f ) / e, 0.0f ), 1.0f ) : 0.0f;
    way = a > 0.0f ? fminf( fmaxf( ( b * t - c ) / a, 0.0f ), 1.0f ) : 0.0f;
    const wisp_vec3 point = add_scaled( g->ends[0], along, t );
    const float distance = length( minus( point, add_scaled( s->from, s->way, way ) ) );
    const float measure = a > 0.0f ? way : distance;
    if ( distance <= s->radius && measure < s->nearest )
    {
        keep( s, measure, point, g->vertices[t > 0.5f], -1 );
    }
}

// Where a way crosses a triangle (Moeller and Trumbore 1997), or the foot of a point on it. Edges are met as segments.
static void meet_triangle( search* s, const wisp_vec3 p[3], const int32_t vertices[3], int32_t triangle )
{
    const wisp_vec3 u = minus( p[1], p[0] ), v = minus( p[2], p[0] ), normal = cross( u, v ),
                    r = minus( s->from, p[0] );
    const bool is_point = dot( s->way, s->way ) == 0.0f;
    const wisp_vec3 way = is_point ? normal : s->way;
    const float d = dot( way, normal );
    const wisp_vec3 q = cross( r, way );
    const float weights[] = { dot( v, q ) / -d, dot( u, q ) / d };
    const float t = -dot( r, normal ) / d; // not a number where the way is in the plane
    const wisp_vec3 point = add_scaled( s->from, way, t );
    const float measure = is_point ? length( minus( point, s->from ) ) : t;
    if ( weights[0] >= 0.0f && weights[1] >= 0.0f && weights[0] + weights[1] <= 1.0f && measure >= 0.0f &&
         measure < s->nearest && measure <= ( is_point ? s->radius : 1.0f ) )
    {
        const float third = 1.0f - weights[0] - weights[1];
        const int corner = third >= weights[0] && third >= weights[1] ? 0 : weights[0] >= weights[1] ? 1 : 2;
        keep( s, measure, point, vertices[corner], triangle );
    }
}

wisp_status wisp_pick_entity( wisp_world* world, wisp_entity entity, wisp_vec3 from, wisp_vec3 to, float radius,
                              wisp_pick* out )
{
    const wisp_fabric* f;
    const wisp_strand_topology* strands;
    WISP_TRY( find_kind( world, entity, &f, &strands ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    *out = ( wisp_pick ){ .vertex = -1, .triangle = -1 };
    search s = { from, minus( to, from ), radius, INFINITY, out };
    if ( !( radius >= 0.0f ) || !isfinite( dot( from, from ) + dot( s.way, s.way ) ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "pick: got a radius or a point that is negative or not finite" );
    }
    if ( strands )
    {
        walk_strands( world, entity, strands, meet_segment, &s );
        return WISP_OK;
    }
    const float* x = wisp_world_column( world, entity, WISP_PARTICLE_POSITION, 0 );
    const wisp_vec3 offset = wisp_world_offset( world, entity );
    const bool is_point = dot( s.way, s.way ) == 0.0f;
    for ( int32_t t = 0; t < f->triangle_count; ++t )
    {
        wisp_vec3 p[3];
        int32_t vertices[3];
        for ( int c = 0; c < 3; ++c )
        {
            p[c] = row( x, f->triangles[3 * t + c], offset );
            vertices[c] = f->slot_vertex[f->triangles[3 * t + c]];
        }
        meet_triangle( &s, p, vertices, t );
        for ( int c = 0; c < 3 && is_point; ++c )
        {
            const float before = s.nearest;
            const segment edge = { { p[c], p[( c + 1 ) % 3] }, { vertices[c], vertices[( c + 1 ) % 3] }, 0.0f };
            meet_segment( &s, &edge );
            out->triangle = s.nearest < before ? t : out->triangle;
        }
    }
    return WISP_OK;
}
