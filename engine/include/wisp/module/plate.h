/// Bending of a thin plate on a triangle mesh: E = 1/2 D times the integral of |curvature|^2, with Poisson's ratio 0, so that a strip
/// has the rigidity D times its width whatever the mesh.
///
/// The curvature of a triangle follows from the turns at its edges (Morley 1968): kappa = sum of ( l / A ) d n n, d the turn
/// between the triangle and its edge, l the edge's length and n its normal in the triangle. Two triangles share the turn of
/// their hinge, J = d + d'. How they share it is a linear combination of J at the hinge and at the hinges next to it, exact for
/// every quadratic surface. So a cylinder, a sphere and a saddle have their energy on any mesh, and a uniform moment
/// leaves every inner vertex in balance. A turn is the vector J = sum c x / l of four corners (Bergou et al. 2006), so the
/// energy is 1/2 D x' Q x with a constant matrix Q.
#pragma once

#include "wisp/fabric.h"
#include "wisp/module/surface_kernels.h"

WISP_BEGIN_C

typedef struct wisp_plate wisp_plate;

/// @param slot_row [vertex_count] the row of a slot; null: the slot itself
/// @param row_count rows, a multiple of 8
/// @param with_turns also the energy of angles; the fabric must have hinges
/// @param out receives the plate without coefficients, null on failure
WISP_API wisp_status wisp_plate_create( const wisp_fabric* fabric, const int32_t* slot_row, int row_count,
                                        bool with_turns, const wisp_allocator* allocator, wisp_plate** out );
/// Drop an owner; the last one releases it.
WISP_API void wisp_plate_release( wisp_plate* plate, const wisp_allocator* allocator );
/// @return bytes that it holds, over its owners; 0 of null
WISP_API size_t wisp_plate_bytes( const wisp_plate* plate );

/// What coefficients depend on besides the fabric.
typedef struct wisp_plate_input
{
    const float* position; ///< [slot][4], of which only the inverse masses are read
    const float* factors;  ///< [triangle_count] of the rigidity, of a map (wisp/maps.h); null: 1
    bool has_mass_map;     ///< masses may change between updates
    float
        max_rate; ///< 1/(kg m^2), > 0: where the share of a triangle in the largest eigenvalue of W Q could exceed this, its energy
        ///< is scaled down to it
} wisp_plate_input;

/// Compute the coefficients if that is due: the first time, where other vertices are pinned than before, where maps or the masses of
/// a map have changed, and where max_rate changes what is scaled down. A triangle between three pins is rigid, so the plate is clamped
/// at the edge of those triangles.
/// @param plate replaced by one of its own if others have it too
/// @return number of triangles that are scaled down; -1 without memory, and the coefficients are as before
WISP_API int wisp_plate_update( wisp_plate** plate, const wisp_fabric* fabric, const wisp_plate_input* input );

/// Own a plate too, if its coefficients are those that a new one would have without maps and with FLT_MAX for max_rate.
/// @return it, or null
WISP_API wisp_plate* wisp_plate_share( wisp_plate* plate, const wisp_fabric* fabric, const float* position,
                                       bool with_turns );

/// @return the matrix; the pointers stay valid as long as the plate
WISP_API wisp_plate_rows wisp_plate_get_rows( const wisp_plate* plate );
/// @return the matrix over angles, of a plate that was created with it
WISP_API wisp_plate_turns wisp_plate_get_turns( const wisp_plate* plate );
/// @return 1/(kg m^2), an upper bound of the eigenvalues of W Q, W the inverse masses at the last fill
WISP_API float wisp_plate_max_rate( const wisp_plate* plate );

WISP_END_C
