#include "validate_material.h"

#include <math.h>

// Membrane of implicit cloth that has to be inextensible, N/m.
static const double STIFF = 2000.0;

wisp_implicit_cloth_def validate_implicit_material( double rigidity, double stiffness )
{
    wisp_implicit_cloth_def cloth = wisp_default_implicit_cloth_def();
    cloth.stiffness_model = WISP_IMPLICIT_STIFFNESS_MATERIAL;
    cloth.weights = WISP_IMPLICIT_WEIGHTS_NONE;
    cloth.link_damping = 0.0f; // of a strip that bends it would be drag
    cloth.integrator = WISP_INTEGRATOR_BDF2;
    cloth.bend_rigidity = (float)rigidity;
    cloth.stretch_stiffness = (float)( stiffness > 0.0 ? stiffness : STIFF );
    return cloth;
}

wisp_cloth_def validate_cloth_material( wisp_cloth_bending bending, double rigidity, double stiffness )
{
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = bending;
    if ( rigidity > 0.0 )
    {
        cloth.bend_rigidity = (float)rigidity;
    }
    if ( stiffness > 0.0 )
    {
        // equilateral triangles of links of stiffness k have 2 / sqrt( 3 ) k; a mesh of squares has 4/3 instead
        cloth.warp_compliance = cloth.weft_compliance = 2.0f / ( sqrtf( 3.0f ) * (float)stiffness );
        cloth.shear_compliance = 2.0f * cloth.warp_compliance;
    }
    return cloth;
}
