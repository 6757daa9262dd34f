/// Cloth carried by coarse sheets, in plain double precision (docs/methods.md, "Coarse sheets"). Topology is that of a cooked
/// fabric; links are projected in its order, one after another.
#pragma once

#include "double3.h"
#include "wisp/fabric.h"

/// A link of a coarse sheet. Lambda is below 0 while it pulls and above 0 while it pushes.
typedef struct coarse_oracle_link
{
    double rest, lower; ///< m; between them the link is slack
    double alpha;       ///< compliance / dt^2, 1/kg
    double lambda;      ///< in and out
    double relaxation;
} coarse_oracle_link;

/// Project once: C = l - rest above the rest length, l - lower below the lower one, else 0; Dlambda = -relaxation (C + alpha lambda) /
/// (wa + wb + alpha), of which the part that raises lambda above 0 is halved; Dp = +-w Dlambda u. Without a direction, or with two
/// pinned ends, nothing moves.
void coarse_oracle_project( coarse_oracle_link* link, double wa, double wb, double3* a, double3* b );

/// The length below which a link pushes: rest where it is not shorter, else its length and what its chain lacks of its own, at
/// most a tenth of the rest length.
double coarse_oracle_lower( double length, double rest, double chain, double chain_rest );

/// A surface of links without bending, pinned where its inverse mass is 0.
typedef struct coarse_oracle
{
    const wisp_fabric* fabric;
    double3 *x, *v;  ///< [slot_count] m, m/s
    double* w;       ///< [slot_count] 1/kg
    double3 gravity; ///< m/s^2
    double compliance;
    int substeps, passes; ///< of the coarsest sheet
    double relaxation;    ///< of this substep
    double held;          ///< fraction of its rest length by which a link may not shorten in this substep
    double3 *start, *change, *lag,
        *before; ///< [rows of the coarsest sheet] history; start: velocity at the substep's start
    bool has_history;
} coarse_oracle;

/// @param fabric with coarse sheets; must outlive the oracle @param position [slot_count][4] m, inverse mass
void coarse_oracle_make( const wisp_fabric* fabric, const float* position, coarse_oracle* out );
void coarse_oracle_free( coarse_oracle* o );
/// One substep. @param h s
void coarse_oracle_step( coarse_oracle* o, double h );
