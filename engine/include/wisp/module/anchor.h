/// For modules: a point bound to a triangle of a surface. A triangle keeps its number when its corners become other vertices
/// (wisp_world_change_triangles()), so what is bound to it goes along.
///
///     wisp_collision_mesh* mesh;
///     WISP_TRY( wisp_world_build_mesh( world, surface, &mesh ) );
///     const wisp_anchor anchor = wisp_find_anchor( mesh, point );
///     wisp_collision_mesh_release( mesh );
///     const wisp_triangle t = wisp_triangle_of( wisp_world_fabric( world, surface ), position, anchor.triangle );
///     const wisp_vec3 foot = wisp_triangle_point( &t, anchor.weights );
#pragma once

#include "wisp/module/collision_mesh.h"
#include "wisp/module/module.h"
#include "wisp/module/vec.h"

WISP_BEGIN_C

typedef struct wisp_anchor
{
    int32_t triangle; ///< the user's order
    float weights[3]; ///< barycentric
} wisp_anchor;

typedef struct wisp_triangle
{
    wisp_vec3 corner[3]; ///< m
} wisp_triangle;

/// Build the mesh of a surface as it is now, for wisp_find_anchor(). @return WISP_CONFLICT it is no surface with triangles; WISP_NO_MEMORY
WISP_API wisp_status wisp_world_build_mesh( wisp_world* world, wisp_entity surface, wisp_collision_mesh** out );

/// Find the triangle that is closest to a point, the lowest of equals. @return triangle -1 if the point is not finite
static inline wisp_anchor wisp_find_anchor( wisp_collision_mesh* mesh, wisp_vec3 point )
{
    const wisp_mesh_query query = { point, INFINITY, 0.0f };
    wisp_mesh_nearest n;
    wisp_collision_mesh_closest( mesh, &query, 1, &n, NULL );
    const wisp_anchor anchor = { n.triangle, { n.weights[0], n.weights[1], n.weights[2] } };
    return anchor;
}

/// @param position [slot][4] of the surface
static inline wisp_triangle wisp_triangle_of( const wisp_fabric* fabric, const float* position, int32_t triangle )
{
    const int32_t* slot = fabric->triangles + 3 * (size_t)triangle;
    const wisp_triangle t = { { wisp_v3_load( position + 4 * (size_t)slot[0] ),
                                wisp_v3_load( position + 4 * (size_t)slot[1] ),
                                wisp_v3_load( position + 4 * (size_t)slot[2] ) } };
    return t;
}

static inline wisp_vec3 wisp_triangle_point( const wisp_triangle* t, const float weights[3] )
{
    const wisp_vec3 ab =
        wisp_v3_add( wisp_v3_scale( t->corner[0], weights[0] ), wisp_v3_scale( t->corner[1], weights[1] ) );
    return wisp_v3_add( ab, wisp_v3_scale( t->corner[2], weights[2] ) );
}

/// Find the frame of a triangle: x along its first edge, z along its normal. @return false for a triangle without area
static inline bool wisp_triangle_axes( const wisp_triangle* t, wisp_vec3 axes[3] )
{
    const wisp_vec3 edge = wisp_v3_sub( t->corner[1], t->corner[0] );
    const wisp_vec3 normal = wisp_v3_cross( edge, wisp_v3_sub( t->corner[2], t->corner[0] ) );
    const float length = wisp_v3_length( edge ), area = wisp_v3_length( normal );
    if ( !( length > 0.0f && area > 0.0f ) )
    {
        return false;
    }
    axes[0] = wisp_v3_scale( edge, 1.0f / length );
    axes[2] = wisp_v3_scale( normal, 1.0f / area );
    axes[1] = wisp_v3_cross( axes[2], axes[0] );
    return true;
}

WISP_END_C
