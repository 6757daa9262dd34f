// State of the module: the surfaces that tear, and what their rows hold.
#pragma once

#include "tearing.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

#define TEARING_SETTINGS( X ) X( tearing_settings, settings, 1 )
#define TEARING_STRENGTH( X )                                                                                        \
    X( float, strength, 1 )                     /* N/m */                                                            \
    X( float, width, 1 )                        /* m, that the edge stands for */
#define TEARING_LIMIT( X ) X( float, limit, 1 ) /* N; infinite: no edge */
#define TEARING_RESULT( X ) X( tearing_result, result, 1 )

enum
{
    TEARING_MAX_SPLITS = 1000000,
};

typedef struct tearing_settings
{
    int32_t max_splits;
    int32_t split_count;
} tearing_settings;

/// Of the last step.
typedef struct tearing_result
{
    int32_t over_count;
    float max_load;
    float inverse_dt2; // 1/s^2, of the last substep
    int32_t is_new;    // 1: no split was made for it; the pass leaves halted and sleeping surfaces as they are
} tearing_result;

typedef struct tearing_state
{
    wisp_component settings, result; // of entities
    wisp_component strength;         // of edges
    wisp_component limit;            // of links
    wisp_entity* surfaces;           // in the order in which they were set
    int count, capacity;
} tearing_state;

/// The pass: compare links with their limits. (tearing_links.c)
void tearing_measure( wisp_frame* frame, const wisp_span* span, void* user );

/// Fill the limits of links from the strengths of edges. (tearing_links.c)
void tearing_fill_limits( wisp_world* world, const tearing_state* state, wisp_entity surface );

/// An edge above its strength.
typedef struct tearing_edge
{
    float load;          // tension by strength
    int32_t vertices[2]; // the user's order, the lower one first
    int32_t slots[2];    // of them
} tearing_edge;

/// List the edges above their strength, the largest load first. (tearing_links.c)
/// @param out [over_count of the result]
/// @return how many
int tearing_list_edges( wisp_world* world, const tearing_state* state, wisp_entity surface, tearing_edge* out );

/// Split vertices of a surface at the end of a step. (tearing_split.c)
wisp_status tearing_split( wisp_world* world, const tearing_state* state, wisp_entity surface );

/// Check that a surface can tear. (tearing_definition.c)
wisp_status tearing_check( wisp_world* world, wisp_entity surface );

/// Take a surface off the list. (tearing_definition.c)
void tearing_forget( tearing_state* state, wisp_entity surface );
