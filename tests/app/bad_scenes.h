// A file of tests/bad/scene and the message of its rejection. There are several tables for one folder.
#pragma once

typedef struct bad_scene
{
    const char* file;
    const char* message; // the text after the file's name
} bad_scene;

extern const bad_scene BAD_SCENES_EFFECTS[];
extern const int BAD_SCENES_EFFECTS_COUNT;
extern const bad_scene BAD_SCENES_IMPLICIT[];
extern const int BAD_SCENES_IMPLICIT_COUNT;
