/// What the cases of balloons share: spheres of helium, foil balloons, and the closed form of a balloon in equilibrium.
#pragma once

#include "accuracy/scene_tools.h"
#include "surfaces.h"
#include "mesh.h"

// ---- foil balloons ----

// A foil balloon: two flat discs that are joined at the rim, of rings of vertices.

typedef enum validate_foil_mesh
{
    VALIDATE_FOIL_EVEN,   ///< rings of 6, 12, 18 ... vertices: triangles of about one shape
    VALIDATE_FOIL_SPOKES, ///< rings of equally many, so that edges run from the poles to the rim without a turn
    VALIDATE_FOIL_COUNT,
} validate_foil_mesh;

typedef struct validate_foil
{
    validate_foil_mesh mesh;
    int rings;     ///< of a disc, the rim included. The rim has six times as many vertices
    double radius; ///< m, of the discs
    double height; ///< m, of each pole over the rim, from which the discs fall as parabolas
} validate_foil;

/// Make the discs about the origin, with y for the axis.
wisp_status validate_foil_make( const validate_foil* foil, wisp_mesh* out, wisp_error* error );
/// The poles are vertices 0 and validate_foil_pole(), and the rim is those from validate_foil_rim() to the end.
int validate_foil_pole( const validate_foil* foil );
int validate_foil_rim( const validate_foil* foil );

// ---- equilibrium ----

// The closed form of a regular balloon: each link has tension k (l - d) and is s times as long as at rest,
//
//   p = sum( k l^2 ) ( s - 1 ) / ( 3 V_rest s^2 ),   V = s^3 V_rest,
//
// and a gas: p V = n R T, which is p = P_atm ( V_0 - V ) / V, or p = P_atm ( V_0 - V ) / V_0 for the constraint of
// compliance V_0 / P_atm. Exact for an icosahedron; finer spheres bulge a little where their links are short.

typedef struct balloon_equilibrium
{
    double scale;    ///< s
    double pressure; ///< Pa above the atmosphere
    double volume;   ///< V_rest, m^3
} balloon_equilibrium;

/// @param def fill, atmosphere and stiffness count; fill > 1
/// @param is_linear the gas of the constraint, else p V = n R T
balloon_equilibrium balloon_equilibrium_of( const wisp_fabric* fabric, const wisp_balloon_def* def, bool is_linear );
/// The same with another amount of gas, in double precision. @param gas_ratio V_0 / V_rest, > 1
balloon_equilibrium balloon_equilibrium_at( const wisp_fabric* fabric, const wisp_balloon_def* def, double gas_ratio,
                                            bool is_linear );

/// Edge of the mesh of a sphere whose radius is 1. It halves with each level.
static inline double validate_sphere_edge( int level )
{
    return 1.0514622242382672 / ( 1 << level ); // of an icosahedron; on a sphere the links are a little longer
}

// ---- full spheres ----

/// A setting of a case of full balloons.
typedef struct full_way
{
    int level, substeps;      ///< of the icosphere; of 1/60 s
    double fill, outlet;      ///< V_0 / V_rest; m^2, 0: none
    wisp_solver skin, volume; ///< what solves them
} full_way;

/// A sphere of a mesh, full and in balance.
typedef struct full_sphere
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
    wisp_vec3* points;       ///< full
    balloon_setting setting; ///< with these points
    balloon_equilibrium balance;
    double area; ///< m^2, at rest
} full_sphere;

/// @param setting what is the same in all settings of the case @param out to be freed, also after a failure
wisp_status full_sphere_make( const full_way* way, balloon_setting setting, int workers, full_sphere* out,
                              wisp_error* error );
void full_sphere_free( full_sphere* sphere );
/// Add "xpbd skin, pbd gas, fill 1.2, level 3, 20 substeps" to the settings. @param what of the scene, such as "fill 1.2"
/// @param by of its series; empty: it is in none
void full_way_put( accuracy_scene* out, full_way way, const char* what, const char* by, const char* parameter_name,
                   double parameter );
void full_way_put_levels( accuracy_scene* out, full_way way, const char* what, int first, int count );
/// @param substeps up to a 0
void full_way_put_substeps( accuracy_scene* out, full_way way, const char* what, const int* substeps );
