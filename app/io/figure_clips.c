// Clips of keyframes from YAML, along tables like those of scenes.
#include "figure.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "scene_parts.h"
#include "scene_ranges.h"

// One joint or, after the last one, the root's translation.
typedef struct channel
{
    int count;
    float* times;  // [key_count + 1]
    float* values; // [key_count + 1][4]
} channel;

typedef struct clip
{
    const char* name;
    float duration;
    bool loops;
    int interpolation;
    const scene_node* keys;
} clip;

typedef struct clip_key
{
    float time;
    wisp_vec3 translation;
    bool has_translation;
    const scene_node* rotations;
} clip_key;

static wisp_status keep_node( scene_reader* r, const scene_node* node, void* at )
{
    (void)r;
    *(const scene_node**)at = node;
    return WISP_OK;
}

static wisp_status keep_text( scene_reader* r, const scene_node* node, void* at )
{
    if ( node->kind != SCENE_SCALAR || scene_text_of( r->tree, node )[0] == 0 )
    {
        return scene_refuse_kind( r, node, "a name" );
    }
    *(const char**)at = scene_text_of( r->tree, node );
    return WISP_OK;
}

static const scene_choice INTERPOLATIONS[] = { { "step", "the keyframe before" },
                                               { "linear", "uniform between keyframes" },
                                               { "cubic", "a smooth curve" },
                                               { NULL, NULL } };

static const scene_field CLIP_FIELDS[] = {
    { "name", SCENE_CUSTOM, .required = true, .at = offsetof( clip, name ), .read = keep_text, .help = "Name." },
    { "duration", SCENE_NUMBER, .required = true, .at = offsetof( clip, duration ), .range = RANGE( 1e-3, 1e6 ),
      .unit = SECONDS, .help = "Duration." },
    { "loops", SCENE_SWITCH, .at = offsetof( clip, loops ), .help = "Whether the clip begins again after its end." },
    { "interpolation", SCENE_CHOICE, .at = offsetof( clip, interpolation ), .choices = INTERPOLATIONS,
      .help = "What is between keyframes." },
    { "keys", SCENE_CUSTOM, .required = true, .at = offsetof( clip, keys ), .read = keep_node, .help = "Keyframes." },
};
static const scene_field KEY_FIELDS[] = {
    { "time", SCENE_NUMBER, .required = true, .at = offsetof( clip_key, time ), .range = TIME, .unit = SECONDS,
      .help = "Time; the times of a list rise." },
    { "translation", SCENE_VECTOR, .at = offsetof( clip_key, translation ), .range = COORDINATE, .unit = METRES,
      .given = offsetof( clip_key, has_translation ), .help = "Place of the root from that at rest." },
    { "rotations", SCENE_CUSTOM, .at = offsetof( clip_key, rotations ), .read = keep_node,
      .help = "Rotations of joints." },
};
static const scene_block CLIP_BLOCK = { CLIP_FIELDS, WISP_COUNT( CLIP_FIELDS ) };
static const scene_block KEY_BLOCK = { KEY_FIELDS, WISP_COUNT( KEY_FIELDS ) };

// ---- keyframes ----

static wisp_status put_key( scene_reader* r, channel* c, int key_count, float time, const float* value )
{
    if ( c->times == NULL )
    {
        c->times = malloc( (size_t)( key_count + 1 ) * sizeof *c->times );
        c->values = malloc( (size_t)( key_count + 1 ) * 4 * sizeof *c->values );
    }
    if ( c->times == NULL || c->values == NULL )
    {
        return scene_no_memory( r );
    }
    c->times[c->count] = time;
    memcpy( c->values + 4 * c->count, value, 4 * sizeof *value );
    c->count += 1;
    return WISP_OK;
}

// [x, y, z] in degrees, or a quaternion [x, y, z, w].
static wisp_status read_turn( scene_reader* r, const scene_node* node, float* out )
{
    static const scene_field degrees = { "degrees", SCENE_NUMBER, .range = RANGE( -36000, 36000 ) };
    if ( node->kind != SCENE_LIST || ( node->count != 3 && node->count != 4 ) )
    {
        return scene_refuse_kind( r, node, "[x, y, z] in degrees or a quaternion [x, y, z, w]" );
    }
    wisp_status status = WISP_OK;
    const scene_node* part = scene_first( r->tree, node );
    for ( int i = 0; part != NULL && status == WISP_OK; ++i, part = scene_next( r->tree, part ) )
    {
        status = scene_read_number( r, part, &degrees, out + i );
    }
    if ( status == WISP_OK && node->count == 3 )
    {
        const wisp_quat q = scene_quat_of_degrees( ( wisp_vec3 ){ out[0], out[1], out[2] } );
        memcpy( out, &q.x, sizeof( q ) );
    }
    const float squared = out[0] * out[0] + out[1] * out[1] + out[2] * out[2] + out[3] * out[3];
    if ( status == WISP_OK && !( squared >= 1e-6f ) )
    {
        status = scene_refuse_node( r, node, "got a quaternion of length 0" );
    }
    for ( int i = 0; i < 4 && status == WISP_OK; ++i )
    {
        out[i] /= sqrtf( squared );
    }
    return status;
}

static wisp_status read_key( scene_reader* r, const scene_node* node, const wisp_skeleton* skeleton, float scale,
                             int key_count, channel* channels, float* before )
{
    clip_key key = { 0 };
    wisp_status status = scene_read_block( r, node, &KEY_BLOCK, &key );
    if ( status == WISP_OK && !( key.time > *before ) )
    {
        status = scene_refuse_node( r, node, "got time %g after %g, expected rising times", (double)key.time,
                                    (double)*before );
    }
    *before = key.time;
    if ( status == WISP_OK && key.has_translation )
    {
        const wisp_vec3 rest = skeleton->joints[0].rest.translation, t = key.translation;
        const float value[4] = { rest.x + scale * t.x, rest.y + scale * t.y, rest.z + scale * t.z, 0.0f };
        status = put_key( r, &channels[skeleton->joint_count], key_count, key.time, value );
    }
    if ( status == WISP_OK && key.rotations != NULL && key.rotations->kind != SCENE_MAP )
    {
        status = scene_refuse_kind( r, key.rotations, "a mapping from joints to rotations" );
    }
    const scene_node* turn =
        status == WISP_OK && key.rotations != NULL ? scene_first( r->tree, key.rotations ) : NULL;
    for ( ; turn != NULL && status == WISP_OK; turn = scene_next( r->tree, turn ) )
    {
        const char* name = scene_key_of( r->tree, turn );
        const int joint = wisp_skeleton_find( skeleton, name );
        float value[4] = { 0.0f };
        status = joint >= 0
                     ? read_turn( r, turn, value )
                     : scene_refuse_node( r, turn, "the skeleton has no joint '%s'", scene_shorten( name ).text );
        status = status == WISP_OK ? put_key( r, &channels[joint], key_count, key.time, value ) : status;
    }
    return status;
}

// ---- tracks ----

// A loop ends as it begins.
static void close_loop( channel* c, float duration )
{
    if ( c->count > 0 && c->times[0] <= 0.0f && c->times[c->count - 1] < duration )
    {
        c->times[c->count] = duration;
        memcpy( c->values + 4 * c->count, c->values, 4 * sizeof *c->values );
        c->count += 1;
    }
}

static wisp_status put_track( const clip* from, channel* c, int joint, bool is_turn, wisp_animation* out,
                              wisp_error* error )
{
    for ( int k = 0; k < c->count && !is_turn; ++k )
    {
        memmove( c->values + 3 * k, c->values + 4 * k, 3 * sizeof *c->values );
    }
    wisp_animation_track* track = &out->tracks[out->track_count++];
    *track = ( wisp_animation_track ){ .joint = joint,
                                       .property = is_turn ? WISP_JOINT_ROTATION : WISP_JOINT_TRANSLATION,
                                       .interpolation = from->interpolation == 0 ? WISP_INTERPOLATION_STEP
                                                                                 : WISP_INTERPOLATION_LINEAR,
                                       .key_count = c->count,
                                       .times = c->times,
                                       .values = c->values };
    *c = ( channel ){ 0 };
    return from->interpolation == 2 ? wisp_animation_track_smooth( track, from->loops, error ) : WISP_OK;
}

static wisp_status put_tracks( const clip* from, channel* channels, const wisp_skeleton* skeleton,
                               wisp_animation* out, wisp_error* error )
{
    const int count = skeleton->joint_count + 1;
    out->tracks = calloc( (size_t)count, sizeof *out->tracks );
    out->name = malloc( strlen( from->name ) + 1 );
    if ( out->tracks == NULL || out->name == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d tracks", count );
    }
    strcpy( out->name, from->name );
    out->duration = from->duration;
    out->loops = from->loops;
    wisp_status status = WISP_OK;
    for ( int j = 0; j < count && status == WISP_OK; ++j )
    {
        const bool is_turn = j < skeleton->joint_count;
        if ( from->loops )
        {
            close_loop( &channels[j], from->duration );
        }
        status =
            channels[j].count > 0 ? put_track( from, &channels[j], is_turn ? j : 0, is_turn, out, error ) : WISP_OK;
    }
    return status == WISP_OK ? wisp_animation_check( out, skeleton, error ) : status;
}

static wisp_status read_clip( scene_reader* r, const clip* from, const wisp_skeleton* skeleton, float scale,
                              wisp_animation* out )
{
    wisp_status status = scene_expect_list( r, from->keys, "a list of keyframes" );
    const int count = skeleton->joint_count + 1;
    channel* channels = calloc( (size_t)count, sizeof *channels );
    if ( status == WISP_OK && channels == NULL )
    {
        status = scene_no_memory( r );
    }
    float before = -1.0f;
    const scene_node* key = status == WISP_OK ? scene_first( r->tree, from->keys ) : NULL;
    for ( int i = 0; key != NULL && status == WISP_OK; ++i, key = scene_next( r->tree, key ) )
    {
        const size_t outside = scene_enter_index( r, i );
        status = read_key( r, key, skeleton, scale, from->keys->count, channels, &before );
        scene_leave( r, outside );
    }
    if ( status == WISP_OK && before > from->duration )
    {
        status = scene_refuse_node( r, from->keys, "got a keyframe at %g s, expected at most the duration, %g s",
                                    (double)before, (double)from->duration );
    }
    status = status == WISP_OK ? put_tracks( from, channels, skeleton, out, r->source->error ) : status;
    for ( int j = 0; j < count && channels != NULL; ++j )
    {
        free( channels[j].times );
        free( channels[j].values );
    }
    free( channels );
    return status;
}

static wisp_status read_clips( scene_reader* r, const char* wanted, const wisp_skeleton* skeleton, float scale,
                               wisp_animation* out )
{
    static const scene_field fields[] = { { "clips", SCENE_CUSTOM, .required = true, .read = keep_node,
                                            .help = "Clips." } };
    static const scene_block block = { fields, 1 };
    const scene_node* list = NULL;
    wisp_status status = scene_read_block( r, &r->tree->nodes[0], &block, &list );
    status = status == WISP_OK ? scene_expect_list( r, list, "a list of clips" ) : status;
    bool found = false;
    const scene_node* node = status == WISP_OK ? scene_first( r->tree, list ) : NULL;
    for ( int i = 0; node != NULL && status == WISP_OK; ++i, node = scene_next( r->tree, node ) )
    {
        clip from = { .interpolation = 2 };
        scene_enter_key( r, "clips" );
        scene_enter_index( r, i );
        status = scene_read_block( r, node, &CLIP_BLOCK, &from );
        if ( status == WISP_OK && !found && strcmp( from.name, wanted ) == 0 )
        {
            found = true;
            status = read_clip( r, &from, skeleton, scale, out );
        }
        scene_leave( r, 0 );
    }
    if ( status == WISP_OK && !found )
    {
        status = scene_refuse_node( r, list, "there is no clip '%s'", scene_shorten( wanted ).text );
    }
    return status;
}

wisp_status wisp_animation_parse( const void* bytes, size_t size, const char* name, const char* clip_name,
                                  const wisp_skeleton* skeleton, float scale, wisp_animation* out, wisp_error* error )
{
    *out = ( wisp_animation ){ 0 };
    const scene_source source = { .name = name, .text = bytes, .size = size, .error = error };
    scene_tree tree = { 0 };
    wisp_status status = scene_tree_build( &source, &tree );
    if ( status == WISP_OK )
    {
        scene_reader reader = { .source = &source, .tree = &tree };
        status = read_clips( &reader, clip_name, skeleton, scale, out );
    }
    scene_tree_release( &tree );
    if ( status != WISP_OK )
    {
        wisp_animation_release( out );
    }
    return status;
}
