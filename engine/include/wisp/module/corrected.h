/// Positions that a module corrects after another one has solved for them.
///
/// A module with an external solver (particle.external_solver) writes particle.previous on entities with this mark, and takes
/// what the position differs from its own at the end of the substep as a change of velocity. It may write
/// particle.half_spaces, which the correction respects.
#pragma once

/// A component without columns, declared by name by both modules.
#define WISP_PARTICLE_CORRECTED "particle.corrected"
