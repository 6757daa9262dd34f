/// Check that layers include only layers below them. Reads the #include lines and the meson files of a tree. README.md has the rules.
#pragma once

#include <stdio.h>

/// @param root folder that holds engine/, modules/ and whatever else there is of app, bench, examples, tests
/// @param out receives one line a violation, `path:line: message`, in the order of paths and lines
/// @return violations found; -1 if there is no engine to look at or a file cannot be read, and the reason is in `out`
int check_layers( const char* root, FILE* out );
