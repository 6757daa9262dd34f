// The cases of `wisp validate`, and where their answers are from.
#include "validate.h"

#include "validate_drape.h"
#include "validate_motion.h"
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
    {
        .name = "drape",
        .title = "Cusick's test: named fabrics drape over a disc",
        .make = validate_drape,
        .tests = "a plate at large rotation that falls into folds: circles of 30 cm of four fabrics, held between "
                 "discs of 18 cm, with the bending rigidity B and the weight measured by others, against the drape "
                 "coefficient measured by them. Each fabric is draped on two meshes, whose spread is shown. It is at "
                 "rest where the change per second is small. The last measure is how far the worst fabric is outside "
                 "of what Cusick's regression allows for its bending length at any shear",
        .left_out =
            "the friction of yarns (2HB): cotton broad, bent and let go, keeps a radius of 19 mm by it; stretch and "
            "shear of each "
            "fabric (all membranes are isotropic, 100 N/m); warp and weft, which bend differently; contact of folds; "
            "the size of specimen and disc in the source, which was not at hand; strands, which are no sheets",
        .formula =
            "DC = (shadow - disc) / (cloth - disc). The band is the measured coefficient +- 5 points, the scatter "
            "that is assumed for a test whose folds differ from trial to trial. Cusick: DC = 35.6 c - 3.61 c^2 - "
            "2.59 A + 0.0461 A^2 + 17.0 %, c = (B / w)^(1/3) in cm, A from 0 to 28.1 degrees, where it is least",
        .source = "Matsudaira, Masuda, Wada and Yokura 2015, J. Textile Eng. 61(6), tables 1 and 2, as others "
                  "transcribed them: faille 28.3 %, wool 49.8 %, polyester tropical 50.7 %, cotton 82.9 %; Cusick "
                  "1965; Peirce 1930 for c",
    },
    {
        .name = "catenary",
        .title = "strips and strands hang between two supports",
        .make = validate_catenary,
        .tests = "shape at rest of a body of length L without bending between supports 0.8 L apart: every vertex "
                 "against the point of the curve at its arc length",
        .left_out = "bending; stretch: strands and xpbd have none, implicit cloth cannot do without and has 2000 "
                    "N/m; pbd, which with full stiffness solves the same constraints as xpbd",
        .formula = "y = a cosh(x / a), 2 a sinh(0.4 L / a) = L",
        .source = "Leibniz, Huygens and Johann Bernoulli 1691",
    },
    {
        .name = "incline",
        .title = "sheets and strands on inclined planes with friction",
        .make = validate_incline,
        .tests = "Coulomb's friction, mu = 0.2 and 0.5: speed after 0.5 s at 20 and 40 degrees, where they slide; "
                 "creep at 11 and 26 degrees, just below atan(mu) = 11.3 and 26.6, where they must not",
        .left_out = "pbd, which with full stiffness solves the same constraints as xpbd; balloons, which roll; guide "
                    "hair and frozen hair, which have no dynamics of contact; different static and kinetic friction",
        .formula = "a = g (sin alpha - mu cos alpha), 0 if negative",
        .source = "Coulomb 1785",
    },
    {
        .name = "terminal_velocity",
        .title = "sheets and strands fall, and a balloon rises, through air",
        .make = validate_terminal,
        .tests = "the law of drag: speed from rest after one time constant w / a, and after eight, when it is the "
                 "terminal speed w",
        .left_out =
            "implicit cloth, which has no air; pbd, which with full stiffness solves the same constraints as xpbd; "
            "guide hair and frozen hair, which follow others; lift; flutter; the air that a body carries along",
        .formula = "v = w tanh(a t / w), w = sqrt(2 F / (rho C A)), with F the weight of the body, or its lift less "
                   "its weight",
        .source = "Newton 1687, book II",
    },
};

const validate_case* validate_cases( int* count )
{
    *count = WISP_COUNT( cases );
    return cases;
}
