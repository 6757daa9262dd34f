// The key `animation` of a surface.
#include "gltf.h"
#include "scene_parts.h"
#include "scene_ranges.h"

#include "wisp/module/definition.h"

#include <stddef.h>

static wisp_status read_clip_name( scene_reader* r, const text_node* node, void* at )
{
    return scene_read_text( r, node, at );
}

#define AT( member ) offsetof( wisp_scene_clip, member )
static const scene_field CLIP_FIELDS[] = {
    { "clip", SCENE_CUSTOM, .required = true, .at = AT( name ), .read = read_clip_name, .form = "name",
      .help = "Name of the clip in the file." },
    { "time", SCENE_NUMBER, .at = AT( time ), .range = TIME, .unit = SECONDS,
      .help = "When it begins; until then the mesh goes from its pose at rest, or from the clip before, to its first "
              "pose." },
    { "speed", SCENE_NUMBER, .at = AT( speed ), .range = RANGE( 1e-3, 1e3 ),
      .help = "Seconds of the clip per second." },
    { "loop", SCENE_SWITCH, .at = AT( loop ),
      .help = "Whether it repeats until the next clip; else its last pose stays." },
};
#undef AT
const scene_block SCENE_CLIP_BLOCK = SCENE_BLOCK_ALONE( CLIP_FIELDS );

wisp_scene_clip scene_default_clip( void )
{
    return ( wisp_scene_clip ){ .speed = 1.0f, .loop = true };
}

static wisp_status read_clip( scene_reader* r, const text_node* node, int index, void* clips )
{
    wisp_scene_clip* clip = (wisp_scene_clip*)clips + index;
    *clip = scene_default_clip();
    WISP_TRY( scene_read_block( r, node, &SCENE_CLIP_BLOCK, clip ) );
    return index == 0 ? WISP_OK : scene_check_rises( r, node, clip[-1].time, clip->time );
}

static const scene_list CLIPS = { .what = "a list of clips",
                                  .size = sizeof( wisp_scene_clip ),
                                  .read = read_clip,
                                  .empty = "got no clip, expected at least one" };

static const scene_choice SKINNINGS[] = { { "linear", "mean of where joints take a vertex" },
                                          { "dual_quaternions", "mean of rigid motions, keeps the girth of joints" },
                                          { NULL, NULL } };

#define AT( member ) offsetof( wisp_scene_surface, animation.member )
static const scene_field ANIMATION_FIELDS[] = {
    { "file", SCENE_CUSTOM, .at = AT( file ), .read = scene_read_file, .form = "path",
      .help = "glTF file (`.glb`, `.gltf`) of the clips, or one with morph targets that the vertices follow.",
      .initial = "that of the mesh" },
    { "clips", SCENE_ENTRIES, .required = true, .at = AT( clips ), .of = &CLIPS,
      .form = "list of {clip, time, speed}",
      .help = "Clips, one after the other; one that loops repeats until the next." },
    { "blend", SCENE_NUMBER, .at = AT( blend ), .range = TIME, .unit = SECONDS,
      .help = "From the end of a clip to the beginning of the next." },
    { "skinning", SCENE_CHOICE, .at = AT( method ), .choices = SKINNINGS,
      .help = "How vertices follow several joints." },
};
#undef AT
const scene_block SCENE_ANIMATION_BLOCK = SCENE_BLOCK_ALONE( ANIMATION_FIELDS );

wisp_status scene_check_animation( scene_reader* r, const text_node* node, const wisp_scene_surface* s )
{
    const text_node* own = text_find_path( node, "animation" );
    const wisp_scene_animation* a = &s->animation;
    for ( int i = 0; i + 1 < a->clip_count; ++i )
    {
        if ( !( a->clips[i + 1].time - a->clips[i].time > a->blend ) )
        {
            return scene_refuse_node( r, own, "got %g s from clip %d to the next, expected more than blend, %g s",
                                      (double)( a->clips[i + 1].time - a->clips[i].time ), i, (double)a->blend );
        }
    }
    if ( text_find_path( node, "attach_pins" ) != NULL )
    {
        return scene_refuse_node( r, own, "got both 'attach_pins' and 'animation', expected one of them" );
    }
    if ( a->file != NULL && !gltf_is_path( a->file ) )
    {
        const text_node* file = text_find_path( own, "file" );
        return scene_refuse_node( r, file, "got '%s', expected a glTF file (.glb, .gltf)",
                                  scene_shorten( text_value( file ) ).text );
    }
    // vertices of a file may be those of the mesh
    return s->mesh.is_generated && a->file == NULL
               ? scene_refuse_node( r, own, "the mesh has no skeleton, expected a glTF file" )
               : WISP_OK;
}
