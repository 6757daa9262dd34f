// Strands in the matrix: eight of sixteen vertices, 10 cm long, that hang from their roots.
#include "stability_strands.h"

#include "collision/collision.h"

#include <math.h>
#include <stdlib.h>

#define DAMPING 4.0f // 1/s

wisp_strand_dynamics_def stability_strand_def( int way, const stability_axes* axes )
{
    const float cube = axes->scale * axes->scale * axes->scale;
    const float soft = axes->stiffness > 0.0f ? 1.0f / axes->stiffness : 0.0f;
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    // equal mass per length, and equal sag over length
    def.bend_rigidity = axes->stiffness > 0.0f ? axes->stiffness : def.bend_rigidity * cube;
    def.twist_rigidity = axes->stiffness > 0.0f ? axes->stiffness : def.twist_rigidity * cube;
    def.damping = DAMPING / sqrtf( axes->scale );
    def.stretch = way == STABILITY_FOLLOW       ? WISP_STRAND_STRETCH_FOLLOW
                  : way >= STABILITY_STRAND_PBD ? WISP_STRAND_STRETCH_LINKS
                                                : WISP_STRAND_STRETCH_DIRECT;
    def.bending = way == STABILITY_FOLLOW   ? WISP_STRAND_BEND_NONE
                  : way >= STABILITY_DIRECT ? WISP_STRAND_BEND_LINKS
                                            : WISP_STRAND_BEND_ROD;
    def.rest = way == STABILITY_CURL ? WISP_STRAND_REST_SAG_FREE : WISP_STRAND_REST_STRAIGHT;
    def.solver = way == STABILITY_STRAND_PBD ? WISP_SOLVER_PBD : WISP_SOLVER_XPBD;
    def.stretch_compliance = way == STABILITY_STRAND_XPBD ? soft : 0.0f;
    def.bend_compliance = way == STABILITY_DIRECT || way == STABILITY_STRAND_XPBD ? soft : 0.0f;
    return def;
}

static wisp_status enter( int way, const stability_axes* axes, int workers, stability_trial* out, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_collision_module, &wisp_strands_module };
    stability_strands* s = calloc( 1, sizeof( *s ) );
    if ( s == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a cell" );
    }
    s->def = stability_strand_def( way, axes );
    s->is_curl = way == STABILITY_CURL;
    s->compliance = (double)s->def.stretch_compliance;
    const wisp_status status = stability_strands_enter( s, modules, WISP_COUNT( modules ), axes, workers, error );
    if ( status != WISP_OK )
    {
        stability_strands_close( s );
        return status;
    }
    *out = stability_strands_trial( s, axes );
    return WISP_OK;
}

static const stability_subject subjects[] = {
    { "strand rod", STABILITY_ROD, enter, true, true, true, 0.0f },
    { "strand curl", STABILITY_CURL, enter, true, true, false, 0.0f },
    { "strand direct", STABILITY_DIRECT, enter, true, true, false, 0.0f },
    { "strand pbd", STABILITY_STRAND_PBD, enter, false, true, false, 0.0f },
    { "strand xpbd", STABILITY_STRAND_XPBD, enter, true, true, true, 0.0f },
    { "strand follow", STABILITY_FOLLOW, enter, false, true, false, 0.0f },
};

const stability_subject* stability_strand_subjects( int* count )
{
    *count = WISP_COUNT( subjects );
    return subjects;
}
