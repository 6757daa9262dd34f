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
    { "contact", "search", NULL, "leave it out: pairs are found by grids, the fastest of the searches" },
    // meshes
    { "generate", "shape", "figure", "use `file: figure.glb` of the folder data, which has its clips too" },
    // boundary
    { "boundary", "by_screen", NULL, "use `eye_angle`, above 0, alone" },
    { "boundary", "pixels", NULL, "use `eye_angle`: the pixels times the angle of one" },
    { "boundary", "pixel_angle", NULL, "use `eye_angle`: the pixels times the angle of one" },
    // colliders
    { "colliders", "search", NULL, "leave it out: meshes are searched by trees, with Embree and without" },
    { "colliders", "voxel_size", NULL, "leave it out: meshes are searched by trees" },
    // implicit cloth
    { "implicit", "damping_form", NULL, "leave it out: links damp all relative velocity of their ends" },
    { "implicit", "jacobian", NULL, "leave it out: the negative term of bending is always dropped" },
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
