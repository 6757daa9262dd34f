/// Check that layers include only layers below them. Reads the #include lines and the meson files of a tree. README.md has the rules.
#pragma once

#include <stdio.h>

/// @param root folder that contains engine/, modules/ and any of app, bench, examples, tests
/// @param out receives one line per violation, `path:line: message`, in the order of paths and lines
/// @return number of violations; -1 if there is no engine to check or a file cannot be read, with the reason in `out`
int check_layers( const char* root, FILE* out );
