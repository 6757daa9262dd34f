/// Where the programs find meshes, suites, references and the page of `wisp view`.
#pragma once

#include <stddef.h>

/// The path of a file of the project's data: in the folder of the environment variable WISP_DATA, else in `build-web` or
/// `data` of the source tree if the program is in a build folder there, else in `share/wisp` beside the program's folder.
/// @param inner such as "bunny.obj" @param out receives the path, whether there is such a file or not
void program_data_path( const char* inner, char* out, size_t size );
