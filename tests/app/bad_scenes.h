// A file of tests/bad/scene and the message that refuses it. The tables are several, the folder is one.
#pragma once

typedef struct bad_scene
{
    const char* file;
    const char* message; // what follows the file's name
} bad_scene;

extern const bad_scene BAD_SCENES_MOTION[];
extern const int BAD_SCENES_MOTION_COUNT;
extern const bad_scene BAD_SCENES_IMPLICIT[];
extern const int BAD_SCENES_IMPLICIT_COUNT;
extern const bad_scene BAD_SCENES_CONTACT[];
extern const int BAD_SCENES_CONTACT_COUNT;
