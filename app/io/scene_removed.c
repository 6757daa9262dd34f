// Keys and words that are gone. A scene that has one is refused with what to use, not as unknown.
#include "scene_removed.h"

#include <stddef.h>
#include <string.h>

#include "wisp/base.h"

static const struct
{
    const char* block; // null: any block
    const char* key;
    const char* word; // null: the key itself is gone
    const char* use;
} REMOVED[] = {
    // strands
    { "dynamics", "leader_correction", NULL, "leave it out: it belonged to `stretch: follow`" },
    { "dynamics", "stretch", "follow", "use `links` with `solver: xpbd`, or `direct`" },
    // contact
    { "contact", "displacement_limit", NULL, "use `level`: `exact` limits displacements, `triangles` does not" },
    { "contact", "primitives", NULL, "use `level`: `exact` for triangles, `spheres` for particles" },
    { "contact", "particle_spacing", NULL, "leave it out: spheres are vertices, and the points of `boundary`" },
    { "contact", "search", NULL, "leave it out: pairs are found by grids, the fastest of the searches" },
    // meshes
    { "generate", "shape", "figure", "use `file: figure.glb` of the folder data, which has its clips too" },
    // boundary
    { "boundary", "by_screen", NULL, "use `eye_angle`, above 0, alone" },
    { "boundary", "pixels", NULL, "use `eye_angle`: the pixels times the angle of one" },
    { "boundary", "pixel_angle", NULL, "use `eye_angle`: the pixels times the angle of one" },
    { "boundary", "scanline_normals", NULL, "leave it out: normals of inner points have the three weights" },
    // colliders
    { "colliders", "search", NULL, "leave it out: meshes are searched by trees, with Embree and without" },
    { "colliders", "voxel_size", NULL, "leave it out: meshes are searched by trees" },
    // balloon
    { "balloon", "pressure", NULL, "leave it out: the pressure is that of the skin's tensions" },
    { "balloon", "drag_model", NULL, "leave it out: drag acts where the normal faces the motion" },
    { "balloon", "outlet_constant", NULL, "leave it out: the jet has the present pressure" },
    { "balloon", "spin", NULL, "leave it out: the torque of the jet changes velocities" },
    { "balloon", "keep_angular_momentum", NULL, "leave it out: projections turn no balloon without pins" },
    // ghosts and curves
    { "ghosts", "elastic", "cosine", "use `elastic: change`, which grows with the change of direction" },
    { "ghosts", "elastic", "dot", "use `elastic: change`, which has a direction for any speed" },
    { "ghosts", "capped", NULL, "leave it out: no vertex sways farther than a segment" },
    { "ghosts", "keep_offset", NULL, "leave it out: a ghost that is alone at its target keeps its offset" },
    { "ghosts", "frame", NULL, "leave it out: offsets turn with the target" },
    { "ghosts", "feedback", NULL, "leave it out: ghosts return when their target rests" },
    { "curves", "kind", "bezier_printed", "use `kind: bezier`, which has no corners" },
    // frozen hair
    { "frozen_hair", "epsilon", NULL, "leave it out: nothing is added to denominators" },
    { "frozen_hair", "base", "previous", "use `base: stroke`, where noise does not add up" },
    { "align", "blend", NULL, "leave it out: vertices turn along an arc, which keeps distances to the root" },
    { "align", "direction", NULL, "leave it out: a strand has the direction from its mean to its tip" },
    { "clump", "gap", "signed", "use `gap: absolute`, where a large change brakes" },
    { "clump", "gap", "reversed", "use `gap: absolute`, where a large change brakes" },
    { "clump", "gap_reference", NULL, "leave it out: changes are measured from distances before the stage" },
    { "clump", "min_distance_clamp", NULL, "leave it out: moves are always limited; `min_distance: 0` limits least" },
    // implicit cloth
    { "implicit", "damping_form", NULL, "leave it out, and use `link_damping: 0` to spare rotation" },
    { "implicit", "jacobian", NULL, "leave it out: the negative term of bending is always dropped" },
    { "implicit", "speculative", NULL, "leave it out: a vertex lands on what it would pass into" },
    { "implicit", "warm_start", NULL, "leave it out: a solve starts from the last answer" },
    { "implicit", "weights", "pair", "use `weights: none`, which has true masses as well" },
};

// Compare the last key of path[0 .. *length), without indices, and step over it.
static bool take_key( const char* path, size_t* length, const char* key )
{
    size_t begin = *length;
    while ( begin > 0 && path[begin - 1] != '.' )
    {
        --begin;
    }
    const size_t size = strcspn( path + begin, ".[" );
    *length = begin > 0 ? begin - 1 : 0;
    return strlen( key ) == size && memcmp( path + begin, key, size ) == 0;
}

const char* scene_find_removed( const char* path, const char* name, bool is_word )
{
    for ( int i = 0; i < WISP_COUNT( REMOVED ); ++i )
    {
        const char *block = REMOVED[i].block, *key = REMOVED[i].key, *word = REMOVED[i].word;
        size_t length = strlen( path );
        if ( is_word ? word && strcmp( word, name ) == 0 && take_key( path, &length, key )
                     : !word && strcmp( key, name ) == 0 )
        {
            if ( !block || take_key( path, &length, block ) )
            {
                return REMOVED[i].use;
            }
        }
    }
    return NULL;
}
