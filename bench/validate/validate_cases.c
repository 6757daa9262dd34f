// The cases of `wisp validate`, where their answers are from, and the overview of how near solvers come to them.
#include "validate/validate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const validate_case all_cases[] = {
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
        .make = validate_chain,
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
        .name = "capstan",
        .title = "ropes over a rod stick by their own tension, or slide",
        .make = validate_capstan,
        .tests =
            "tension, contact and friction together: 13 ropes of 1.32 m hang over a round rod of 0.2 m, of which "
            "60, 70 or 80 % of what hangs is on one side, with 0.7 to 1.3 of the critical friction. The least "
            "friction with which one stays is the measured one; what then still moves is its creep",
        .left_out = "rods that turn, ropes that are stiff or stretch, more than half a turn around the rod",
        .formula = "T' = R cos a + mu (T + R sin a), T in lengths of rope: heavy = light e^(pi mu) + 2 mu R (1 + "
                   "e^(pi mu)) / (1 + mu^2), which is mu = 0.1018, 0.2093 and 0.3306",
        .source = "Euler 1769, Eytelwein 1808; here with the weight of the part on the rod, without which mu is log( "
                  "heavy / light ) / pi",
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
    {
        .name = "balloon",
        .title = "a sphere filled with gas: pressure and size",
        .make = validate_inflate,
        .tests = "gas law and skin in balance, over the peak of the pressure",
        .left_out = "skins with a strain energy, such as rubber",
        .formula = "p = sum(k l^2) (s - 1) / (3 V0 s^2), exact for the mesh",
        .source = "the balance of a spring mesh that is scaled by s",
    },
    {
        .name = "rubber",
        .title = "spheres with a neo-Hookean skin: pressure over the limit point",
        .make = validate_rubber,
        .tests = "a skin with a strain energy from 1.1 to 3 times its size: the pressure rises to a limit point and "
                 "falls again, as that of "
                 "a party balloon",
        .left_out = "the second rise of the pressure of real rubber, whose chains have a finite length; shapes that "
                    "lose their symmetry",
        .formula = "p = 2 G t / R (1 / s - 1 / s^7), largest at s = 7^(1/6) = 1.383",
        .source = "Treloar 1943; Green and Shield 1950",
    },
    {
        .name = "mylar",
        .title = "two discs of foil, joined at the rim and filled",
        .make = validate_mylar,
        .tests = "the shape of a skin that wrinkles but does not stretch: radius, thickness and volume, by skins of "
                 "springs, of a strain limit and of membranes with a tension field, on meshes with straight spokes "
                 "and without",
        .left_out =
            "implicit cloth and cloth with bending, which cannot be balloons; the number of wrinkles; stiffness "
            "and pressure of real foil: p a / k = 0.001 of springs, and checks with ten times more and less",
        .formula = "z' = -x^2 / sqrt(r^4 - x^4), the meridian as long as the radius a of the disc: r = 0.7627 a, "
                   "thickness 1.1981 r, V = 1.2185 a^3",
        .source = "Paulsen 1994; Mladenov and Oprea 2003",
    },
    {
        .name = "jet",
        .title = "a balloon empties through an outlet: the speed it gets",
        .make = validate_jet,
        .tests = "thrust = mass flow x outlet speed, with the pressure of a skin that shrinks; solvers of skin "
                 "and gas, the area of the outlet, which must not matter",
        .left_out = "the mass of the gas, which the law does not have (with it the balloon is a rocket: Tsiolkovsky "
                    "1903); friction in the outlet; air and weight; spin, since the outlet is on the axis",
        .formula =
            "v_e = sqrt(2 p / rho), dV_0/dt = -A v_e, m dv/dt = rho A v_e^2: v = rho / m times the integral of "
            "v_e over V_0",
        .source = "Torricelli 1643, Bernoulli 1738; p of a spring mesh in balance, as in `balloon`",
    },
    {
        .name = "lift_off",
        .title = "helium balloons lift what the air they displace weighs",
        .make = validate_lift_off,
        .tests = "buoyancy of a skin under pressure: 31 balloons in one world with loads from 0.94 to 1.06 of the "
                 "balance; what they lift is between the heaviest that rises and the next",
        .left_out = "a load that hangs from a line: it is spread over the skin; air that gets thinner with height",
        .formula = "m = rho_air V - rho_He V_0, V of the skin in balance with p V = P_atm V_0",
        .source = "Archimedes; Boyle 1662; p of a spring mesh in balance, as in `balloon`",
    },
    {
        .name = "rising_balloon",
        .title = "helium balloons rise at the speed at which drag holds their lift",
        .make = validate_rising_balloon,
        .tests = "the law of drag on a sphere, by its integral, with lift; by mesh and substeps",
        .left_out =
            "the coefficient: C = 0.5 by default, and 0.47 was measured of spheres at Reynolds numbers of 1e3 to "
            "1e5, so they rise 3 % slower than real ones; added mass, wobble and wake",
        .formula = "v = sqrt(2 (lift - weight) / (rho C pi R^2))",
        .source = "Newton 1687; measured spheres: Hoerner 1965",
    },
};

const validate_case* validate_cases( int* count )
{
    *count = WISP_COUNT( all_cases );
    return all_cases;
}

// ---- the overview ----

enum
{
    MAX_SOLVERS = 32, // of a case
};

// In the unit of a case, mostly %.
static const double NEAR = 5.0;

// A solver is the part of a setting before its first comma. Its settings differ in mesh, substeps, or how they are measured.
typedef struct line
{
    char solver[64];
    const results_row* best; // of the settings with an error; null: none
    double least, largest;
    int count, without; // settings; those without an error
} line;

static void find_solver( const results_row* row, char* text, size_t size )
{
    snprintf( text, size, "%.*s", (int)strcspn( row->variant, "," ), row->variant );
}

// The error is the first value of a row that has all of them; one that is not finite is not there.
static const char* find_error_name( const results* all, int first_row )
{
    const results_row* fullest = NULL;
    for ( int i = first_row; i < all->row_count; ++i )
    {
        const results_row* row = all->rows + i;
        fullest = fullest == NULL || row->error.count > fullest->error.count ? row : fullest;
    }
    return fullest != NULL && fullest->error.count > 0 ? fullest->error.items[0].name : "";
}

static bool is_same_setting( const results* all, int a, int b )
{
    return strcmp( all->rows[a].variant, all->rows[b].variant ) == 0;
}

static void add_setting( line* l, const results_row* row, const char* error_name )
{
    const bool is_measured = row->error.count > 0 && strcmp( row->error.items[0].name, error_name ) == 0;
    const double error = is_measured ? row->error.items[0].value : NAN;
    l->count += 1;
    l->without += is_measured ? 0 : 1;
    if ( is_measured && ( l->best == NULL || error < l->least ) )
    {
        l->best = row;
        l->least = error;
    }
    l->largest = is_measured && !( l->largest > error ) ? error : l->largest;
}

static line* find_line( line lines[MAX_SOLVERS], int* count, const results_row* row )
{
    char solver[64];
    find_solver( row, solver, sizeof solver );
    int i = 0;
    while ( i < *count && strcmp( lines[i].solver, solver ) != 0 )
    {
        ++i;
    }
    if ( i == *count && i < MAX_SOLVERS )
    {
        lines[i] = ( line ){ .largest = NAN };
        memcpy( lines[i].solver, solver, sizeof solver );
        *count += 1;
    }
    return i < MAX_SOLVERS ? lines + i : NULL;
}

// Below the doubt of its reference an error says nothing more.
static bool is_below( const results_row* row )
{
    const size_t length = strlen( row->error.items[0].name );
    return row->error.count > 1 && strncmp( row->error.items[1].name, row->error.items[0].name, length ) == 0 &&
           strstr( row->error.items[1].name, "below" ) != NULL;
}

static void put_line( int table, const char* name, const line* l, results* out )
{
    char least[40] = "-", largest[60] = "-", ms[40] = "-";
    if ( l->best != NULL )
    {
        snprintf( least, sizeof least, is_below( l->best ) ? "%.3g, below the doubt" : "%.3g", l->least );
        snprintf( largest, sizeof largest, "%.3g", l->largest );
        snprintf( ms, sizeof ms, "%.3g", l->best->ms_median );
    }
    if ( l->without > 0 )
    {
        const size_t length = strlen( largest );
        snprintf( largest + length, sizeof largest - length, "; %d of %d without", l->without, l->count );
    }
    const char* const cells[] = { name, l->solver, least, largest, ms, l->best != NULL ? l->best->variant : "-" };
    results_add_cells( out, table, cells );
}

int validate_begin_overview( results* out )
{
    const char* const header[] = { "case", "solver", "least error", "largest", "ms a step", "setting of the least" };
    return results_add_table( out,
                              "Overview: how near each solver comes to theory, in the unit of the case, mostly %",
                              WISP_COUNT( header ), header );
}

void validate_add_to_overview( int table, const char* name, int first_row, results* out )
{
    line lines[MAX_SOLVERS];
    int count = 0;
    const char* error_name = find_error_name( out, first_row );
    for ( int i = first_row; i < out->row_count; ++i )
    {
        // rows of one setting with several workers follow each other, and have one error
        line* l =
            i > first_row && is_same_setting( out, i, i - 1 ) ? NULL : find_line( lines, &count, out->rows + i );
        if ( l != NULL )
        {
            add_setting( l, out->rows + i, error_name );
        }
    }
    for ( int i = 0; i < count; ++i )
    {
        put_line( table, name, lines + i, out );
    }
}

// Columns of the overview.
enum
{
    CASE = 0,
    SOLVER = 1,
    LEAST = 2,
};

void validate_end_overview( int table, results* out, char* summary, size_t size )
{
    char far[480] = "";
    int near_count = 0, count = 0, unnamed = 0;
    for ( int row = 1; table >= 0 && row < out->tables[table].row_count; ++row )
    {
        const results_table* t = out->tables + table;
        const char* least = results_cell( t, row, LEAST );
        const bool is_near = least[0] != '-' && atof( least ) <= NEAR;
        const size_t length = strlen( far );
        count += 1;
        near_count += is_near ? 1 : 0;
        if ( is_near == false && sizeof far - length < 120 )
        {
            unnamed += 1;
        }
        else if ( is_near == false )
        {
            snprintf( far + length, sizeof far - length, "%s`%s` by %s (%s)", length > 0 ? ", " : "; not ",
                      results_cell( t, row, CASE ), results_cell( t, row, SOLVER ), least );
        }
    }
    results_append_count( far, sizeof far, unnamed, "more" );
    snprintf( summary, size, "%d of %d lines of the overview have a setting within %g %% or points of the answer%s.",
              near_count, count, NEAR, far );
    results_add_headline( out, "%s", summary );
}

// ---- running cases ----

static const double CASE_SECONDS = 20.0, CASE_SECONDS_QUICK = 3.0;

static void describe( const validate_case* c, results* out )
{
    const char* const header[] = { "case", c->title };
    const char* const lines[][2] = {
        { "tests", c->tests }, { "leaves out", c->left_out }, { "theory", c->formula }, { "source", c->source }
    };
    char title[160];
    snprintf( title, sizeof title, "Case `%s`", c->name );
    const int table = results_add_table( out, title, WISP_COUNT( header ), header );
    for ( int i = 0; i < WISP_COUNT( lines ); ++i )
    {
        results_add_cells( out, table, lines[i] );
    }
}

#define VALIDATE_LIMIT( name, setting, most ) { name, setting, most },
static const validate_limit all_limits[] = {
#include "validate/limits.inc"
};
#undef VALIDATE_LIMIT

const validate_limit* validate_limits( int* count )
{
    *count = WISP_COUNT( all_limits );
    return all_limits;
}

static void hold_to_limits( const char* name, int first_row, results* out )
{
    for ( int i = first_row; i < out->row_count; ++i )
    {
        const results_row* row = out->rows + i;
        const double error = row->error.count > 0 ? row->error.items[0].value : (double)NAN;
        for ( int k = 0; k < WISP_COUNT( all_limits ); ++k )
        {
            const validate_limit* limit = all_limits + k;
            // written so that a NaN fails
            if ( strcmp( limit->name, name ) == 0 && strcmp( limit->setting, row->variant ) == 0 &&
                 !( error <= limit->most ) )
            {
                results_add_failure( out, "validate, %s, %s: an error of %.4g, expected at most %g", name,
                                     row->variant, error, limit->most );
            }
        }
    }
}

wisp_status validate_run( uint64_t chosen, const bench_options* options, results* out, char* summary, size_t size,
                          wisp_error* error )
{
    int count;
    const validate_case* cases = validate_cases( &count );
    const int overview = validate_begin_overview( out );
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        if ( chosen != 0 && ( chosen >> i & 1 ) == 0 )
        {
            continue;
        }
        const accuracy_entry entry = { cases[i].name, cases[i].title, cases[i].make, NULL };
        const double seconds = options->seconds > 0.0 ? options->seconds
                               : options->quick       ? CASE_SECONDS_QUICK
                                                      : CASE_SECONDS;
        const int first_row = out->row_count;
        describe( cases + i, out );
        status = accuracy_bench_run( &entry, 1, seconds, options, out, error );
        validate_add_to_overview( overview, cases[i].name, first_row, out );
        hold_to_limits( cases[i].name, first_row, out );
    }
    validate_end_overview( overview, out, summary, size );
    return status;
}
