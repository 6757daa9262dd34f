/// `wisp validate`: scenes with an answer from outside, in theory or in measurements that others published, by every solver that can do them.
#pragma once

#include "accuracy/accuracy.h"
#include "results.h"
#include "text_tree.h"

#define VALIDATE_PI 3.14159265358979323846

typedef struct validate_case
{
    const char *name, *title;
    accuracy_scene_fn* make;
} validate_case;

/// All cases in their order.
const validate_case* validate_cases( int* count );

/// Read data/suites/validate/cases.yaml: a map of cases by their names, what is said of them and the largest allowed errors of settings.
/// @param out to be released; null on failure
wisp_status validate_read( text_node** out, wisp_error* error );

/// Run cases, and add their tables, charts and descriptions. A setting beyond its limit fails.
/// @param chosen a bit for each of validate_cases(); 0: all
/// @param summary [size] receives a sentence: which solvers come near theory
wisp_status validate_run( uint64_t chosen, const bench_options* options, results* out, char* summary, size_t size,
                          wisp_error* error );

// ---- the overview ----

/// Add the first table of a validation, empty: for each case and solver, how near it comes to the answer, and with what. @return its number
int validate_begin_overview( results* out );
/// Add the lines of a case.
/// @param first_row of the case in the results; all later ones are of it
void validate_add_to_overview( int table, const char* name, int first_row, results* out );
/// Say in a sentence how many of its lines come near theory, and which do not. Also a headline.
void validate_end_overview( int table, results* out, char* summary, size_t size );

// ---- cases ----

// Cases of slender bodies under their own weight.
accuracy_scene_fn validate_cantilever; ///< tips against the heavy elastica
accuracy_scene_fn validate_tip_load;   ///< tips with a weight against the elastica
accuracy_scene_fn validate_column;     ///< the load at which an upright column gives way
accuracy_scene_fn validate_blade;      ///< the load at which a blade turns aside

// Cases of rods that give way to twist.
accuracy_scene_fn validate_ring;    ///< the twist at which a ring leaves its plane
accuracy_scene_fn validate_twisted; ///< the moment at which a rod under tension is no longer straight

// Cases of rods that have given way to twist in one place.
accuracy_scene_fn validate_writhe; ///< their shape and tension
accuracy_scene_fn validate_loop;   ///< the rotation at which they form a loop

// Cases of sheets that are wide enough to bend both ways, under their own weight.
accuracy_scene_fn validate_lateral_buckling; ///< the load at which a level sheet on edge turns aside
accuracy_scene_fn validate_plate_column;     ///< the load at which an upright sheet gives way

// Cases of rods with a natural curvature that hang from a clamp.
accuracy_scene_fn validate_curl;       ///< tips in the plane of the curl
accuracy_scene_fn validate_bend_twist; ///< the weight at which curls leave their plane

// A case of friction and elasticity together.
accuracy_scene_fn validate_stick_slip; ///< the friction with which the tip of a bowed rod or strip sticks

// Cases of chains: strands without bending.
accuracy_scene_fn validate_chain;        ///< hanging chains swing in their two slowest modes
accuracy_scene_fn validate_folded_chain; ///< the free end of a folded chain falls faster than a stone

// Cusick's test: named fabrics drape over a disc.
accuracy_scene_fn validate_drape;

// Cases of sheets and strands whose motion or rest has a closed form.
accuracy_scene_fn validate_catenary; ///< a strip hung between two supports against the catenary
accuracy_scene_fn validate_incline;  ///< sheets on inclines against the law of Coulomb
accuracy_scene_fn validate_capstan;  ///< ropes over a rod against the law of the capstan
accuracy_scene_fn validate_terminal; ///< sheets and balloons in air against their terminal speed

// Cases of balloons: a filled sphere, the pressure of rubber, the shape of a foil, the impulse of a jet, lift, and the speed of ascent.
accuracy_scene_fn validate_inflate;        ///< a filled sphere, against the closed form of its mesh
accuracy_scene_fn validate_rubber;         ///< the pressure of neo-Hookean spheres, over their limit point
accuracy_scene_fn validate_mylar;          ///< two discs that are filled, against the Mylar balloon
accuracy_scene_fn validate_jet;            ///< the speed that a jet gives, against the integral of Bernoulli's law
accuracy_scene_fn validate_lift_off;       ///< the load that helium lifts
accuracy_scene_fn validate_rising_balloon; ///< terminal speed of ascent
