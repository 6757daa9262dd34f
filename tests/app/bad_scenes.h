// A file of tests/bad/scene and the message of its rejection. There are several tables for one folder.
#pragma once

typedef struct bad_scene
{
    const char* file;
    const char* message; // the text after the file's name
} bad_scene;

extern const bad_scene BAD_SCENES_MOTION[];
extern const int BAD_SCENES_MOTION_COUNT;
extern const bad_scene BAD_SCENES_IMPLICIT[];
extern const int BAD_SCENES_IMPLICIT_COUNT;
extern const bad_scene BAD_SCENES_FILES[];
extern const int BAD_SCENES_FILES_COUNT;
extern const bad_scene BAD_SCENES_CONTACT[];
extern const int BAD_SCENES_CONTACT_COUNT;
