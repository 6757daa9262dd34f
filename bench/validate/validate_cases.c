// The cases of `wisp validate`, and where their answers are from.
#include "validate.h"

#include "validate_buckling.h"
#include "validate_chains.h"
#include "validate_slender.h"
#include "validate_writhe.h"

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
        .name = "tip_load",
        .title = "clamped rods and strips bend under a weight at the free end",
        .make = validate_tip_load,
        .tests =
            "bending at large rotation by a force at the end, P L^2 / EI = 0.5, 1, 3 and 10: a vertex, or the end of "
            "a strip, that is ten times as heavy as the rest of the body",
        .left_out = "forces that turn with the body; widths of more than one cell",
        .formula =
            "theta'' = -(P (1 - s) / 10 + P) cos theta, theta(0) = 0, theta'(1) = 0: the weight of the body is "
            "in it",
        .source = "elastica with an end load: Bisshopp and Drucker 1945; with a weight along it: Bickley 1934",
    },
    {
        .name = "ring",
        .title = "twisted rings leave their plane",
        .make = validate_ring,
        .tests = "twist that turns into bending: 31 closed rods, straight without load and twisted by 0.7 to 1.3 of "
                 "the critical twist before they were joined, start a little out of their plane. The least twist at "
                 "which one becomes three times as thick within a second is the measured one",
        .left_out = "what a ring becomes: it folds over to an eight and passes through itself, since closed strands "
                    "do not touch themselves here",
        .formula = "2 pi sqrt(3) EI / GJ = 10.88 rad, for GJ = EI",
        .source = "Michell 1889; Zajac 1962; Goriely 2006",
    },
    {
        .name = "twisted",
        .title = "rods under tension give way to twist",
        .make = validate_twisted,
        .tests = "twist and tension against bending: 31 straight rods at each of two tensions, whose ends keep their "
                 "directions while one of them moves freely, are twisted by 0.7 to 1.3 of the critical moment. A "
                 "small weight aside acts while they are turned. The least moment at which a rod then leaves its "
                 "line is the measured one",
        .left_out = "rods whose ends may turn; dynamics of twist, which is in balance in each substep",
        .formula = "M^2 / 4 EI = F + pi^2 EI / L^2, with half of the weight of the rod, 3 % of F, added to F",
        .source = "Greenhill 1883",
    },
    {
        .name = "writhe",
        .title = "rods that gave way to twist, in one place",
        .make = validate_writhe,
        .tests = "large bending and twist in space: three rods, shortened by a tenth of their length and turned by "
                 "5.8 to 6.5 turns, give way in one place, where they make angles of 60 to 72 degrees with the line "
                 "of their ends. Compared are the angle and the tension",
        .left_out =
            "plectonemes: at 93 degrees there is no balance without contact, a loop forms and touches "
            "itself. Theory is that of an infinite rod, which is less than a degree from straight where these end",
        .formula = "sin(angle / 2) = q = sqrt(1 - t^2), t = M / 2 sqrt(EI F): shortening 4 q sqrt(EI / F), rotation "
                   "M L / GJ + 4 acos t",
        .source = "Coyne 1990; van der Heijden and Thompson 2000",
    },
    {
        .name = "loop",
        .title = "rods that are twisted on form a loop",
        .make = validate_loop,
        .tests = "where the shapes of `writhe` end: 31 rods, shortened by a tenth of their length, are turned by 0.7 "
                 "to 1.3 of the largest rotation that has a balance. The least rotation that leads beyond 95 "
                 "degrees, which no balance has, is the measured one",
        .left_out =
            "the plectoneme that follows, which needs a rod that touches itself: here it passes through itself",
        .formula = "R = 8 (L / D) (EI / GJ) t sqrt(1 - t^2) + 4 acos t is largest where cos(2 acos t) = -D GJ / 2 L "
                   "EI: 43.2 "
                   "rad",
        .source = "the fold of the solution of Coyne 1990; van der Heijden and Thompson 2000",
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
        .name = "folded_chain",
        .title = "a folded chain is let go at one end",
        .make = validate_folded_chain,
        .tests = "a whip: a chain hangs folded, one link wide, both ends at one height. One is let go and falls "
                 "faster than a stone, since the energy of ever more links that stop goes to the ever fewer that "
                 "move. Compared is its speed when it has fallen 0.9 of the length",
        .left_out = "the last tenth, in which the end turns over; strips of cloth, whose diagonals are other links",
        .formula = "Lagrange's equations of as many masses on rigid links, by Runge and Kutta; beside them v^2 = g x "
                   "(2 L - x) / (L - x) of a continuous chain without width",
        .source = "Calkin and March 1989, who also measured it: 0.85 of the time of free fall",
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
