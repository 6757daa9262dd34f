// Edges and corners of a mesh that stick out: those that may touch something before the faces beside them do. An edge belongs
// to the lowest of its triangles, a corner likewise, so that each is found once. Where two faces lie in one plane, or form a valley,
// their edge touches nothing that they do not touch. Of a rigid mesh such edges, and corners with nothing but them, are left out when the
// features are built; of one that deforms the sides of an edge tell it.
#include "mesh_bvh.h"

#include "alloc.h"

#include <string.h>

static int32_t point_of( const mesh_surface* s, int32_t half_edge, int next )
{
    return s->triangles[half_edge / 3 * 3 + ( half_edge % 3 + next ) % 3];
}

// Faces at an edge: their number, normals and winding, which decide whether the edge is a ridge.
typedef struct edge_faces
{
    int32_t lowest;
    int count;
    double3 normals[2]; // of the first two
    bool is_opposite;   // the first two run along the edge in opposite directions
    double3 beyond;     // the third corner of the second face, from a point of the edge
} edge_faces;

static int direction_of( const int32_t* number, int32_t a, int32_t b )
{
    for ( int k = 0; k < 3; ++k )
    {
        if ( number[k] == a && number[( k + 1 ) % 3] == b )
        {
            return 1;
        }
        if ( number[k] == b && number[( k + 1 ) % 3] == a )
        {
            return -1;
        }
    }
    return 0;
}

static edge_faces faces_of( const mesh_surface* s, int32_t a, int32_t b, double time )
{
    edge_faces out = { .lowest = -1 };
    int first = 0;
    for ( int32_t k = s->ring_begin[a]; k < s->ring_begin[a + 1]; ++k )
    {
        const triangle_corners t = mesh_surface_triangle( s, s->ring[k], time );
        const int direction = direction_of( t.number, a, b );
        if ( direction == 0 )
        {
            continue;
        }
        if ( out.count < 2 )
        {
            out.normals[out.count] = double3_unit_or_zero( triangle_normal( &t ) );
        }
        if ( out.count == 1 )
        {
            int corner = 0;
            while ( t.number[corner] != a )
            {
                ++corner;
            }
            for ( int c = 0; c < 3; ++c )
            {
                out.beyond = t.number[c] != a && t.number[c] != b ? double3_sub( t.at[c], t.at[corner] ) : out.beyond;
            }
            out.is_opposite = direction == -first;
        }
        first = out.count == 0 ? direction : first;
        out.lowest = out.count == 0 ? s->ring[k] : out.lowest;
        out.count += 1;
    }
    return out;
}

// Whether an edge is a ridge seen from the side of the normals ( 1 ) or from the other ( -1 ). An open edge is both, and so is one where
// faces meet that do not fit together, or that have no area.
static bool is_ridge( const edge_faces* f, double side )
{
    const double3 n = double3_cross( f->normals[0], f->normals[1] );
    const double cosine = double3_dot( f->normals[0], f->normals[1] );
    const bool is_any = f->count != 2 || f->is_opposite == false ||
                        double3_dot( f->normals[0], f->normals[0] ) == 0.0 ||
                        double3_dot( f->normals[1], f->normals[1] ) == 0.0;
    const bool is_plane = double3_dot( n, n ) <= MESH_FEATURES_PLANE * MESH_FEATURES_PLANE && cosine > 0.0;
    return is_any || ( !is_plane && side * double3_dot( f->normals[0], f->beyond ) < 0.0 );
}

// ---- construction ----

static bool is_bent( const edge_faces* f )
{
    return is_ridge( f, 1.0 ) || is_ridge( f, -1.0 );
}

static void mark_features( mesh_features* features, const mesh_surface* s )
{
    const bool is_rigid = s->start == NULL;
    memset( features->candidates, 0, (size_t)s->triangle_count );
    for ( int32_t h = 0; h < 3 * s->triangle_count; ++h )
    {
        const int32_t a = point_of( s, h, 0 ), b = point_of( s, h, 1 );
        const edge_faces faces = faces_of( s, a, b, 1.0 );
        if ( a != b && faces.lowest == h / 3 && ( !is_rigid || is_bent( &faces ) ) )
        {
            features->candidates[h / 3] |= (uint8_t)( 1 << ( h % 3 ) );
        }
    }
    for ( int32_t point = 0; point < s->point_count; ++point )
    {
        bool any = !is_rigid;
        for ( int32_t k = s->ring_begin[point]; k < s->ring_begin[point + 1] && !any; ++k )
        {
            const int32_t* number = s->triangles + 3 * (size_t)s->ring[k];
            for ( int c = 0; c < 3 && !any; ++c )
            {
                const edge_faces faces = faces_of( s, point, number[c], 1.0 );
                any = number[c] != point && is_bent( &faces );
            }
        }
        for ( int c = 0; c < 3 && any && s->ring_begin[point] < s->ring_begin[point + 1]; ++c )
        {
            const int32_t lowest = s->ring[s->ring_begin[point]];
            if ( s->triangles[3 * lowest + c] == point )
            {
                features->candidates[lowest] |= (uint8_t)( 8 << c );
                break;
            }
        }
    }
}

wisp_status mesh_features_build( mesh_features* features, const mesh_surface* s, bool needs_boxes, wisp_error* error )
{
    features->candidates = base_allocate( &s->allocator, (size_t)s->triangle_count, BASE_BUFFER_ALIGNMENT );
    wisp_status status = features->candidates != NULL
                             ? WISP_OK
                             : wisp_fail( error, WISP_NO_MEMORY, "out of memory for the edges of a mesh collider" );
    if ( status == WISP_OK && needs_boxes )
    {
        status = mesh_bvh_build( &features->boxes, s, error );
    }
    if ( status != WISP_OK )
    {
        mesh_features_release( features, s );
        return status;
    }
    if ( needs_boxes )
    {
        mesh_bvh_refit( &features->boxes, NULL );
    }
    mark_features( features, s );
    return WISP_OK;
}

void mesh_features_release( mesh_features* features, const mesh_surface* s )
{
    mesh_bvh_release( &features->boxes );
    base_release( &s->allocator, features->candidates, (size_t)s->triangle_count );
    *features = ( mesh_features ){ 0 };
}

size_t mesh_features_bytes( const mesh_features* features, const mesh_surface* s )
{
    return ( features->candidates != NULL ? (size_t)s->triangle_count : 0 ) +
           ( features->boxes.surface != NULL ? mesh_bvh_bytes( &features->boxes ) : 0 );
}

// ---- queries ----

enum
{
    NEAR = 64, // triangles that are looked at together
};

int mesh_features_find( const mesh_features* features, const mesh_bvh* boxes, const float lower[3],
                        const float upper[3], bool corners, int32_t* out, int capacity )
{
    int32_t triangles[NEAR];
    int found = 0;
    for ( mesh_bvh_overlap search = mesh_bvh_overlap_begin( boxes ); search.count > 0; )
    {
        const int count = mesh_bvh_next_overlaps( boxes, &search, lower, upper, triangles, NEAR );
        for ( int i = 0; i < count; ++i )
        {
            const unsigned bits = features->candidates[triangles[i]] >> ( corners ? 3 : 0 );
            for ( int k = 0; k < 3; ++k )
            {
                if ( ( bits >> k & 1u ) != 0 && found < capacity )
                {
                    out[found++] = 3 * triangles[i] + k;
                }
            }
        }
    }
    return found;
}

static wisp_vec3 place_of( const mesh_surface* s, int32_t point, float time )
{
    const float* end = s->xyzw + 4 * (size_t)point;
    if ( s->start == NULL || time >= 1.0f )
    {
        return ( wisp_vec3 ){ end[0], end[1], end[2] };
    }
    const float* start = s->start + 4 * (size_t)point;
    return ( wisp_vec3 ){ start[0] + time * ( end[0] - start[0] ), start[1] + time * ( end[1] - start[1] ),
                          start[2] + time * ( end[2] - start[2] ) };
}

wisp_mesh_feature mesh_features_place( const mesh_surface* s, int32_t feature, bool is_corner, float begin,
                                       float end )
{
    const int32_t a = point_of( s, feature, 0 ), b = point_of( s, feature, is_corner ? 0 : 1 );
    return ( wisp_mesh_feature ){ { place_of( s, a, begin ), place_of( s, b, begin ) },
                                  { place_of( s, a, end ), place_of( s, b, end ) } };
}

wisp_mesh_sides mesh_features_sides( const mesh_surface* s, int32_t feature, bool is_corner, double time )
{
    const int32_t a = point_of( s, feature, 0 );
    if ( is_corner )
    {
        return ( wisp_mesh_sides ){ double3_narrow( mesh_surface_corner_normal( s, a, time ) ), true, true };
    }
    const edge_faces faces = faces_of( s, a, point_of( s, feature, 1 ), time );
    const double3 sum =
        faces.count > 1 ? double3_mul_add( faces.normals[0], 1.0, faces.normals[1] ) : faces.normals[0];
    return ( wisp_mesh_sides ){ double3_narrow( double3_unit_or_zero( sum ) ), is_ridge( &faces, 1.0 ),
                                is_ridge( &faces, -1.0 ) };
}
