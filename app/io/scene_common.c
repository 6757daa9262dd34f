// Values that strands, surfaces and colliders have: names, files, layers.
#include "io_file.h"

#include "scene_parts.h"
#include "scene_ranges.h"
#include "scene_keys.h"

#include "wisp/module/definition.h"
#include <stddef.h>
#include <string.h>

// ---- suggestions ----

#define _POSIX_C_SOURCE 200809L // strnlen

#include "nearest.h"

// Longer words match nothing. The cap keeps a hostile key of megabytes from costing more than its first letters.
#define LONGEST 64
#define FARTHEST 3

// Capitals count as small letters. Not tolower(), which follows the host's locale.
static unsigned char small( char c )
{
    return (unsigned char)( c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c );
}

static int least( int a, int b )
{
    return a < b ? a : b;
}

// Optimal string alignment: insertions, deletions, changes and swaps of neighbours cost one each. Three rows of the
// table are kept, because a swap refers to two rows before.
static int distance( const char* a, int a_length, const char* b, int b_length )
{
    int rows[3][LONGEST + 1];
    for ( int j = 0; j <= b_length; ++j )
    {
        rows[0][j] = j;
    }

    for ( int i = 1; i <= a_length; ++i )
    {
        int* row = rows[i % 3];
        const int* above = rows[( i + 2 ) % 3];
        const int* above_that = rows[( i + 1 ) % 3];
        row[0] = i;
        for ( int j = 1; j <= b_length; ++j )
        {
            int change = small( a[i - 1] ) != small( b[j - 1] );
            row[j] = least( above[j - 1] + change, least( above[j], row[j - 1] ) + 1 );
            if ( i > 1 && j > 1 && small( a[i - 1] ) == small( b[j - 2] ) && small( a[i - 2] ) == small( b[j - 1] ) )
            {
                row[j] = least( row[j], above_that[j - 2] + 1 );
            }
        }
    }
    return rows[a_length % 3][b_length];
}

const char* nearest_word( const char* word, const char* const* words, int count )
{
    size_t length = strnlen( word, LONGEST + 1 );
    if ( length > LONGEST )
    {
        return NULL;
    }

    const char* nearest = NULL;
    int nearest_distance = FARTHEST + 1;
    for ( int i = 0; i < count; ++i )
    {
        size_t other = strnlen( words[i], LONGEST + 1 );
        size_t longer = other > length ? other : length;
        int difference = (int)( longer - ( other > length ? length : other ) );

        // The difference in length is a lower bound of the distance and costs nothing.
        int limit = least( (int)( longer / 3 ), FARTHEST );
        if ( other > LONGEST || difference > limit || difference >= nearest_distance )
        {
            continue;
        }
        int d = distance( word, (int)length, words[i], (int)other );
        if ( d <= limit && d < nearest_distance )
        {
            nearest = words[i];
            nearest_distance = d;
        }
    }
    return nearest;
}

int nearest_words( const char* word, const char* const* words, int count, const char** out, int max )
{
    const int length = (int)strnlen( word, LONGEST + 1 );
    int found = 0;
    // Ascending distances: each word of the list goes behind those that are as near.
    for ( int wanted = 0; wanted <= LONGEST && length <= LONGEST && found < max; ++wanted )
    {
        for ( int i = 0; i < count && found < max; ++i )
        {
            const int other = (int)strnlen( words[i], LONGEST );
            if ( distance( word, length, words[i], other ) == wanted )
            {
                out[found++] = words[i];
            }
        }
    }
    return found;
}

// ---- removed keys ----

// Keys and words that are gone. A scene that has one is refused with what to use, not as unknown.

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

// ---- common ----

wisp_status scene_read_name( scene_reader* r, const text_node* node, void* at )
{
    const char** name = at;
    WISP_TRY( scene_read_text( r, node, name ) );
    return io_is_name( *name, WISP_SCENE_MAX_NAME )
               ? WISP_OK
               : scene_refuse_node( r, node, "got '%s', expected 1 to %d of the characters A-Z a-z 0-9 _ -",
                                    scene_shorten( *name ).text, WISP_SCENE_MAX_NAME );
}

// The value is looked up once all names are known; here it is only made sure that it is one.
wisp_status scene_read_later_name( scene_reader* r, const text_node* node, void* at )
{
    (void)at;
    const char* name = NULL;
    return scene_read_name( r, node, &name );
}

// Relative files are relative to the folder of the scene, not to the working directory.
wisp_status scene_read_file( scene_reader* r, const text_node* node, void* at )
{
    const char** file = at;
    WISP_TRY( scene_read_text( r, node, file ) );
    const size_t folder = io_folder_length( r->source->name );
    if ( folder > 0 && ( *file )[0] != '/' )
    {
        *file = scene_print( r->scene, "%.*s%s", (int)folder, r->source->name, *file );
    }
    return *file ? WISP_OK : scene_no_memory( r );
}

static wisp_status read_layer( scene_reader* r, const text_node* item, int index, void* layers )
{
    (void)index;
    static const scene_field layer = { "layer", SCENE_WHOLE, .range = RANGE( 0, 31 ) };
    uint32_t* bits = layers;
    int number = 0;
    WISP_TRY( scene_read_whole( r, item, &layer, &number ) );
    if ( *bits & ( 1u << number ) )
    {
        return scene_refuse_node( r, item, "layer %d is listed twice", number );
    }
    *bits |= 1u << number;
    return WISP_OK;
}

wisp_status scene_read_layers( scene_reader* r, const text_node* node, void* at )
{
    WISP_TRY( scene_expect_list( r, node, "a list of layers" ) );
    *(uint32_t*)at = 0;
    return scene_read_items( r, node, read_layer, at );
}

wisp_status scene_read_items( scene_reader* r, const text_node* list, scene_item_fn* read, void* context )
{
    int i = 0;
    for ( const text_node* item = text_first( list ); item; item = item->next )
    {
        const size_t outside = scene_enter_index( r, i );
        WISP_TRY( read( r, item, i++, context ) );
        scene_leave( r, outside );
    }
    return WISP_OK;
}

typedef struct number_list
{
    const scene_field* field;
    float* out;
} number_list;

static wisp_status read_number( scene_reader* r, const text_node* item, int index, void* context )
{
    const number_list* list = context;
    return scene_read_number( r, item, list->field, &list->out[index] );
}

wisp_status scene_read_numbers( scene_reader* r, const text_node* list, const scene_field* field, float* out )
{
    number_list numbers = { field, out };
    return scene_read_items( r, list, read_number, &numbers );
}

wisp_status scene_check_vertex( scene_reader* r, const text_node* node, int vertex, bool is_known, int64_t count,
                                const char* of )
{
    return !is_known || vertex < count
               ? WISP_OK
               : scene_refuse_node( r, node, "got vertex %d%s%s%s, expected 0 .. %lld", vertex, of ? " of '" : "",
                                    of ? of : "", of ? "'" : "", (long long)( count - 1 ) );
}

wisp_status scene_refuse_jumps( scene_reader* r, const text_node* node, const wisp_scene_path* path, const char* why )
{
    for ( int i = 0; i < path->count; ++i )
    {
        if ( path->poses[i].jump )
        {
            return scene_refuse_node( r, node, "'jump' in keyframe %d: %s", i, why );
        }
    }
    return WISP_OK;
}

wisp_status scene_check_rises( scene_reader* r, const text_node* node, float before, float time )
{
    return time > before ? WISP_OK
                         : scene_refuse_node( r, node, "got time %g, expected more than the time before, %g",
                                              (double)time, (double)before );
}
