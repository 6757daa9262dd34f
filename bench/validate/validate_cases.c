// The cases of `wisp validate`, and where their answers are from.
#include "validate.h"

#include "validate_curls.h"
#include "validate_slender.h"
#include "validate_slip.h"

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
        .name = "curl",
        .title = "suspended curls hang in their plane",
        .make = validate_curl,
        .tests =
            "bending of rods with a natural curvature, from a curl that nearly keeps its shape to one that is nearly "
            "straightened; curl is the natural curvature times the length",
        .left_out =
            "solvers without a natural curvature in SI units: cloth strips are flat at rest, links and guide hair "
            "hold curls by weights that are no EI; contact of a curl with itself",
        .formula = "theta'' = G (1 - s) sin theta, theta(0) = 0, theta'(1) = curl, with theta from down and "
                   "G = rho g L^3 / EI",
        .source = "Miller, Lazarus, Audoly and Reis 2014; as a validation: Romero et al. 2021",
    },
    {
        .name = "bend_twist",
        .title = "suspended curls leave their plane under their own weight",
        .make = validate_bend_twist,
        .tests = "bending coupled with twist in rods with a natural curvature: 13 rods from 0.7 to 1.3 of the "
                 "critical weight, "
                 "for each of two curls, hang in their plane and are pushed out of it; the first that goes on "
                 "instead of "
                 "coming back is the measured weight",
        .left_out =
            "shapes beyond the critical weight; the second weight, at which a curl of about one turn is planar "
            "again; contact of a curl with itself; solvers without twist",
        .formula =
            "the first G at which the second variation, integral of (beta' + theta' phi)^2 + GJ/EI (phi' - theta' "
            "beta)^2 - 2 M phi beta' - M theta' (phi^2 + beta^2) + G (1 - s) cos theta beta^2 with "
            "M = theta' - curl, is 0 about the planar equilibrium: 14.54 and 24.30 for GJ = 2/3 EI",
        .source =
            "Kirchhoff rods: Love 1927; the curls: Miller, Lazarus, Audoly and Reis 2014; as a validation: Romero "
            "et al. 2021",
    },
    {
        .name = "stick_slip",
        .title = "bowed rods and strips stick to a rough floor, or slip",
        .make = validate_stick_slip,
        .tests =
            "friction and bending together: 13 bodies with 0.7 to 1.3 of the critical friction press a floor with "
            "their free ends, from a clamp that is 0.75 of their length high; the least friction with which one "
            "sticks "
            "is the measured one",
        .left_out = "weight; the way there: bodies start bowed and are held, the clamp is not lowered; other heights "
                    "and inclined clamps; "
                    "what happens after the slip; contact of more than the end",
        .formula =
            "theta'' = F_x sin theta - F_y cos theta, theta(0) = 0, theta'(1) = 0, the end under the clamp: sticks "
            "if |F_y| <= mu |F_x|, which is mu = 0.2807",
        .source = "Sano, Yamaguchi and Wada 2017; as a validation: Romero et al. 2021",
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
