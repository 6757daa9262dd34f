/// Level of detail at run time: what is far away or out of sight costs less, by a level that the host sets per entity.
///
///     wisp_detail_def detail = wisp_default_detail_def();
///     detail.level = WISP_DETAIL_COARSE;
///     wisp_set_detail( world, surface, &detail );
///
/// The state itself goes from one level to the next, so nothing jumps: positions go on from where they are, and what would give or
/// take velocity at once does so over some steps.
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

/// Levels, from the one that costs most to the one that costs least.
typedef enum wisp_detail
{
    WISP_DETAIL_FULL = 0,           ///< everything
    WISP_DETAIL_FEWER_SUBSTEPS = 1, ///< everything, in fewer and longer substeps
    /// What carries an entity alone. Of a surface with coarse sheets these, in fewer substeps too: fine vertices are where the sheets take
    /// them, and their offsets from there vanish. Of strands that follow others, a rigid motion with the root of what they follow.
    WISP_DETAIL_COARSE = 2,
    /// Nothing is solved. A surface keeps its shape and goes along with its pins, or, without any, with its moving frame
    /// (moving_frame.h); strands go along with their roots, and what follows strands with the roots of those. Without any of
    /// them it stays where it is. Nothing that it touches moves it; what touches it meets it at rest.
    WISP_DETAIL_NOTHING = 3,
    WISP_DETAIL_COUNT = 4,
} wisp_detail;

/// Fill from wisp_default_detail_def(). Copied.
typedef struct wisp_detail_def
{
    uint32_t size;     ///< bytes; set by wisp_default_detail_def()
    wisp_detail level; ///< default WISP_DETAIL_FULL
    int substep_divisor; ///< 1 .. 1000000, default 4: of the substeps of the entity, for two of the levels; rounded up to whole ones
    /// 0 .. 1000000, default 15: over which a change is blended. Before the first step of the world nothing is.
    int blend_steps;
} wisp_detail_def;

WISP_DEFINITION( detail_def );

/// Set the level of an entity from the next step on. Entities run at full detail unless this is called.
///
///  - To more or fewer substeps their number changes step by step, because shorter substeps are stiffer: all at once would shorten
///    what is stretched within a substep, and give it that velocity.
///  - To coarse sheets alone, offsets of fine vertices from where the sheets take them decay.
///  - To nothing, the entity goes on at the level that it has, while its velocity relative to the rigid motion falls to 0. From
///    there, it starts with the velocity of that motion.
///
/// Entities that meet in the substep loop make the substeps of the one with the most (wisp_set_substeps). Setting what is set changes
/// nothing. A change compiles the plan again, and so does each step in which the number of substeps changes; it needs no memory but at
/// the first call of an entity. Results do not depend on the number of workers, and snapshots hold the level and its change.
/// @param entity a surface or strands
/// @return WISP_BAD_INPUT a number is out of range; WISP_CONFLICT the entity has neither vertices nor strands, or, for
///         WISP_DETAIL_COARSE, nothing coarse; WISP_NO_MEMORY
WISP_API wisp_status wisp_set_detail( wisp_world* world, wisp_entity entity, const wisp_detail_def* def );

/// @return the level that was set; WISP_DETAIL_FULL if none was, or the entity was removed
WISP_API wisp_detail wisp_detail_of( const wisp_world* world, wisp_entity entity );

WISP_END_C
