// Picking: walks the rows of the engine, and needs no request.
#include "pick.h"

#include "wisp/fabric.h"
#include "wisp/module/module.h"
#include "wisp/module/vec.h"

static float clamp( float x )
{
    return fminf( fmaxf( x, 0.0f ), 1.0f );
}

typedef struct search
{
    wisp_vec3 from, path; // m; the way of a point is zero
    float radius;         // m
    float nearest;        // of a way its fraction, of a point m
    wisp_hit* out;
} search;

static void keep( search* s, float measure, wisp_vec3 point, int32_t vertex, int32_t triangle )
{
    s->nearest = measure;
    *s->out = ( wisp_hit ){ vertex, triangle, point, wisp_v3_length( wisp_v3_sub( point, s->from ) ) };
}

// The closest points of the way and a segment, clamped to both (Ericson 2004, section 5.1.9).
static void meet_segment( search* s, wisp_vec3 p, wisp_vec3 q, int32_t p_vertex, int32_t q_vertex, int32_t triangle )
{
    const wisp_vec3 along = wisp_v3_sub( q, p ), r = wisp_v3_sub( s->from, p );
    const float a = wisp_v3_dot( s->path, s->path ), e = wisp_v3_dot( along, along ), f = wisp_v3_dot( along, r ),
                b = wisp_v3_dot( s->path, along ), c = wisp_v3_dot( s->path, r ), d = a * e - b * b;
    float fraction = d > 0.0f ? clamp( ( b * f - c * e ) / d ) : 0.0f;
    const float t = e > 0.0f ? clamp( ( b * fraction + f ) / e ) : 0.0f;
    fraction = a > 0.0f ? clamp( ( b * t - c ) / a ) : 0.0f;
    const wisp_vec3 point = wisp_v3_mul_add( p, t, along );
    const float distance = wisp_v3_length( wisp_v3_sub( point, wisp_v3_mul_add( s->from, fraction, s->path ) ) );
    const float measure = a > 0.0f ? fraction : distance;
    if ( distance <= s->radius && measure < s->nearest )
    {
        keep( s, measure, point, t > 0.5f ? q_vertex : p_vertex, triangle );
    }
}

// Where the way crosses a triangle (Moeller and Trumbore 1997), or the foot of a point on it; else its edges may be nearest.
static void meet_triangle( search* s, const wisp_vec3 p[3], const int32_t vertices[3], int32_t triangle )
{
    const wisp_vec3 u = wisp_v3_sub( p[1], p[0] ), v = wisp_v3_sub( p[2], p[0] ), normal = wisp_v3_cross( u, v ),
                    r = wisp_v3_sub( s->from, p[0] );
    const bool is_point = wisp_v3_dot( s->path, s->path ) == 0.0f;
    const wisp_vec3 direction = is_point ? normal : s->path, q = wisp_v3_cross( r, direction );
    const float d = wisp_v3_dot( direction, normal ),
                t = -wisp_v3_dot( r, normal ) / d; // not a number where the way is in the plane
    const float second = wisp_v3_dot( v, q ) / -d, third = wisp_v3_dot( u, q ) / d, first = 1.0f - second - third;
    const wisp_vec3 point = wisp_v3_mul_add( s->from, t, direction );
    const float measure = is_point ? wisp_v3_length( wisp_v3_sub( point, s->from ) ) : t;
    if ( first >= 0.0f && second >= 0.0f && third >= 0.0f && measure >= 0.0f && measure < s->nearest &&
         measure <= ( is_point ? s->radius : 1.0f ) )
    {
        const int corner = first >= second && first >= third ? 0 : second >= third ? 1 : 2;
        keep( s, measure, point, vertices[corner], triangle );
    }
    for ( int c = 0; c < 3 && is_point; ++c )
    {
        meet_segment( s, p[c], p[( c + 1 ) % 3], vertices[c], vertices[( c + 1 ) % 3], triangle );
    }
}

static void walk_triangles( search* s, const float* rows, wisp_vec3 offset, const wisp_fabric* f )
{
    for ( int32_t t = 0; t < f->triangle_count; ++t )
    {
        wisp_vec3 p[3];
        int32_t vertices[3];
        for ( int c = 0; c < 3; ++c )
        {
            const int32_t slot = f->triangles[3 * t + c];
            const float* x = rows + 4 * (size_t)slot;
            p[c] = wisp_v3_sub( wisp_v3_load( x ), offset );
            vertices[c] = f->slot_vertex[slot];
        }
        meet_triangle( s, p, vertices, t );
    }
}

static void walk_strands( search* s, const float* rows, wisp_vec3 offset, const wisp_strand_topology* t )
{
    for ( int i = 0; i < 16 * t->group_count; ++i )
    {
        wisp_vec3 last = { 0.0f, 0.0f, 0.0f };
        for ( int k = 0; k < t->lane_count[i]; ++k )
        {
            const float* x = rows + (size_t)( t->group_row[i / 16] + k ) * 48 + i % 16;
            const wisp_vec3 p = wisp_v3_sub( ( wisp_vec3 ){ x[0], x[16], x[32] }, offset );
            const int32_t vertex = t->offsets[t->lane_strand[i]] + k;
            meet_segment( s, k > 0 ? last : p, p, k > 0 ? vertex - 1 : vertex, vertex, -1 );
            last = p;
        }
    }
}

wisp_status wisp_pick( wisp_world* world, wisp_entity entity, wisp_vec3 from, wisp_vec3 to, float radius,
                       wisp_hit* out )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    *out = ( wisp_hit ){ .vertex = -1, .triangle = -1 };
    search s = { from, wisp_v3_sub( to, from ), radius, INFINITY, out };
    if ( !( radius >= 0.0f ) || !isfinite( wisp_v3_dot( from, from ) + wisp_v3_dot( s.path, s.path ) ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "pick: expected finite points and a radius of at least 0" );
    }
    const wisp_strand_topology* strands =
        wisp_has_strands( world, entity ) ? wisp_world_strands( world, entity ) : NULL;
    const wisp_fabric* fabric = strands == NULL ? wisp_world_fabric( world, entity ) : NULL;
    const float* rows =
        wisp_world_column( world, entity, strands != NULL ? WISP_STRAND_POSITION : WISP_PARTICLE_POSITION, 0 );
    if ( rows == NULL || ( strands == NULL && fabric == NULL ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "pick: entity %u is neither a surface nor strands that move",
                                entity.index );
    }
    if ( strands != NULL )
    {
        walk_strands( &s, rows, wisp_world_offset( world, entity ), strands );
        return WISP_OK;
    }
    walk_triangles( &s, rows, wisp_world_offset( world, entity ), fabric );
    return WISP_OK;
}
