/// Scenes: a YAML (or JSON) file that says which strands there are, what they wear, and what is wanted of them.
/// docs/scenes.md describes the format. A scene is untrusted: bounded, checked, and refused with one sentence such as
/// `scene.yaml:12:7: strands[0].frozen_hair.clump.radius: 'ten' is not a number`.
#pragma once

#include "climate/climate.h"
#include "frozen_hair/frozen_hair.h"
#include "strand_look/strand_look.h"

#include "groom.h"

#ifdef __cplusplus
extern "C"
{
#endif

#define WISP_SCENE_VERSION 1
#define WISP_SCENE_MAX_STRANDS 10000 ///< entries of the list `strands`
#define WISP_SCENE_MAX_NAME 64       ///< letters of a name

    /// One entry of `strands`. Texts and arrays belong to the scene; the definitions point at them.
    typedef struct wisp_scene_strands
    {
        const char* name; ///< unique in the scene
        int line, column; ///< of the entry, for messages about it that come later

        const char* file;         ///< where to read the strands, already relative to the scene's folder; null if made
        bool is_made;             ///< `recipe` tells how to make them
        wisp_groom_recipe recipe; ///< the defaults if not made

        bool has_frozen_hair, has_climate, has_look;
        wisp_frozen_hair_def frozen_hair; ///< the defaults without a stage if the scene has none
        wisp_climate_def climate;
        wisp_strand_look_def look;

        int stretch_count; ///< length of frozen_hair.strand_stretch_stiffness, 0 if that is null; must be the number
        int bend_count;    ///< of strands, which is known here, and checked, only if they are made
        int intensity_count; ///< so for strand_bend_stiffness and strand_intensity

        bool want_points, want_width, want_colour; ///< points also if an output writes them
    } wisp_scene_strands;

    /// The user points at a place before a step.
    typedef struct wisp_scene_command
    {
        int step;    ///< in [0, steps)
        int strands; ///< index into the scene's strands
        wisp_vec3 cursor;
        int line, column; ///< of the entry, for messages
    } wisp_scene_command;

    typedef struct wisp_scene_output
    {
        int strands;      ///< index into the scene's strands
        const char* file; ///< as written, ends in .hair, .usda or .obj
        int line, column;
    } wisp_scene_output;

    typedef struct wisp_scene
    {
        const char* name; ///< of the file, as messages show it
        float step_seconds;
        int steps;
        int substeps, iterations;
        int workers; ///< 0 is one a core

        wisp_scene_strands* strands; ///< [strands_count], in the order of the file
        int strands_count;
        wisp_scene_command* commands; ///< [command_count], by step, and by strands within a step
        int command_count;
        wisp_scene_output* outputs; ///< [output_count], in the order of the file
        int output_count;

        void* blocks; ///< memory of everything above
    } wisp_scene;

    /// Read a scene from a file.
    /// @param out receives the scene; all zero on failure
    /// @return WISP_BAD_INPUT the file is not a scene; WISP_IO_ERROR it cannot be read; WISP_NO_MEMORY
    WISP_API wisp_status wisp_scene_read( const char* path, wisp_scene* out, wisp_error* error );

    /// Read a scene from memory.
    /// @param text UTF-8, need not end in a zero
    /// @param name what messages call it, and whose folder relative files are in
    WISP_API wisp_status wisp_scene_parse( const char* text, size_t size, const char* name, wisp_scene* out,
                                           wisp_error* error );

    /// Null and a zero scene are allowed.
    WISP_API void wisp_scene_release( wisp_scene* scene );

#ifdef __cplusplus
}
#endif
