// The cases of `wisp validate`, and where their answers are from.
#include "validate.h"

#include "validate_plates.h"
#include "validate_slender.h"

accuracy_scene_fn accuracy_closed_forms, accuracy_strands_chain, accuracy_balloon_inflate;

static const validate_case cases[] = {
    {
        .name = "cantilever",
        .title = "clamped rods and strips bend under their own weight",
        .make = validate_cantilever,
        .tests = "bending at large rotation, from G = 1, nearly straight, to G = 1000, nearly hanging; the master "
                 "curve of the first test of "
                 "Romero et al. 2021, of rods and of narrow plates",
        .left_out = "width: strips are one cell wide and bend to cylinders, so Poisson's ratio does not show",
        .formula = "theta'' = -G (1 - s) cos theta, theta(0) = 0, theta'(1) = 0, with G = rho g L^3 / EI",
        .source = "heavy elastica: Bickley 1934; the curve as a validation: Romero, Ly, Rasheed, Charrondiere, "
                  "Lazarus, Neukirch and Bertails-Descoubes "
                  "2021",
    },
    {
        .name = "column",
        .title = "upright rods and strips give way under their own weight",
        .make = validate_column,
        .tests = "stability at a bifurcation: 31 bodies from 0.7 to 1.3 of the critical load start a "
                 "little aside; the first that goes on "
                 "instead of coming back is the measured load",
        .left_out = "what happens after the column has given way",
        .formula = "theta'' + G (1 - s) theta = 0, theta(0) = 0, theta'(1) = 0: G = 7.837",
        .source = "Greenhill 1881",
    },
    {
        .name = "blade",
        .title = "level blades on edge turn aside under their own weight",
        .make = validate_blade,
        .tests = "bending coupled with twist, as in the lateral buckling of Romero et al. 2021, at the end of narrow "
                 "plates",
        .left_out = "wide plates, whose curve needs measurements or a shell; strips of cloth, whose twist is not "
                    "that of a plate when they are one cell "
                    "wide",
        .formula =
            "phi'' + k^2 (1 - s)^4 / 4 phi = 0, phi(0) = 0, phi'(1) = 0, k = rho g L^3 / sqrt(EI GJ): k = 12.85",
        .source = "Michell 1899, Prandtl 1899",
    },
    {
        .name = "lateral_buckling",
        .title = "level plates on edge turn aside under their own weight",
        .make = validate_lateral_buckling,
        .tests = "bending of a plate coupled with its twist, from narrow to square, on three kinds of mesh; the "
                 "third test of Romero "
                 "et al. 2021. Seven sheets from 0.6 to 1.8 of the critical load start a little aside, and the "
                 "measured load is where "
                 "growth turns into decay",
        .left_out = "Poisson's ratio of bending other than that of the solvers, 0; what happens after a plate has "
                    "turned; stretch, "
                    "as sheets stretch like plates 25 times as wide as thick, which raises loads by 0.1 to 0.3 %",
        .formula =
            "the energy D / 2 int (w_xx + w_yy)^2 - 2 (1 - nu) (w_xx w_yy - w_xy^2) + 1/2 int N : grad w grad w of "
            "all w with "
            "w = w_x = 0 at the clamp stops being positive, with N the plane stress under the weight, nu = 0 and "
            "G = rho g L^3 / D",
        .source =
            "Kirchhoff 1850, Bryan 1891; the method of Ritz 1909; a narrow plate is the blade of Michell and Prandtl "
            "(1899), G = 12.85 sqrt( 2 (1 - nu) (1 - nu^2) )",
    },
    {
        .name = "plate_column",
        .title = "upright plates give way under their own weight",
        .make = validate_plate_column,
        .tests = "stability of a sheet of many cells across, narrow and wide, on three kinds of mesh, measured as in "
                 "`lateral_buckling`",
        .left_out =
            "Poisson's ratio of bending other than that of the solvers, 0, with which width makes no difference",
        .formula = "as in `lateral_buckling`, with the weight along the plate; G = 7.837 at any width",
        .source = "Kirchhoff 1850, Bryan 1891; for nu = 0 Greenhill 1881",
    },
    {
        .name = "chain",
        .title = "hanging chains swing in their two slowest modes",
        .make = accuracy_strands_chain,
        .tests = "periods and lost amplitude of strands without bending",
        .left_out = "large swings",
        .formula = "w_k = sqrt(n g x_k / L) of n masses, x_k the roots of the Laguerre polynomial L_n",
        .source = "exact for a chain of n links; Bernoulli 1738 for the continuous one",
    },
    {
        .name = "forms",
        .title = "free fall, air, inclines, hanging at rest, gas",
        .make = accuracy_closed_forms,
        .tests = "each law alone: fall, angular momentum, terminal velocity, Coulomb's incline, an elastic bar, a "
                 "catenary, the lift of helium, the law of Laplace, "
                 "an outlet",
        .left_out = "what laws do to each other",
        .formula = "in the names of the series",
        .source = "statics and mechanics of textbooks",
    },
    {
        .name = "balloon",
        .title = "a sphere filled with gas: pressure and size",
        .make = accuracy_balloon_inflate,
        .tests = "gas law and skin in balance, over the peak of the pressure",
        .left_out = "skins with a strain energy, such as rubber",
        .formula = "p = sum(k l^2) (s - 1) / (3 V0 s^2), exact for the mesh",
        .source = "the balance of a spring mesh that is scaled by s",
    },
};

const validate_case* validate_cases( int* count )
{
    *count = WISP_COUNT( cases );
    return cases;
}
