/// Materials of cloth in SI units.
#pragma once

#include "cloth/cloth.h"
#include "implicit_cloth/implicit_cloth.h"

/// @param rigidity N m, against bending @param stiffness N/m, of the membrane; 0: as stiff as it can be
wisp_implicit_cloth_def validate_implicit_material( double rigidity, double stiffness );
/// @param rigidity N m, against bending; 0: the default
/// @param stiffness N/m, of the membrane; 0: inextensible
wisp_cloth_def validate_cloth_material( wisp_cloth_bending bending, double rigidity, double stiffness );
