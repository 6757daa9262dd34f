/// A foil balloon: two flat discs that are joined at the rim, of rings of vertices.
#pragma once

#include "mesh.h"

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
