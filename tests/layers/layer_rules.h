/// The layer of a file, and the layers that each may include.
#pragma once

typedef enum layer_kind
{
    LAYER_PUBLIC,   ///< engine/include/wisp
    LAYER_ENGINE,   ///< engine/<name>
    LAYER_MODULE,   ///< modules/<name>
    LAYER_IO,       ///< app/io, app/render, app/results
    LAYER_BENCH,    ///< bench
    LAYER_APP,      ///< app
    LAYER_CREATE,   ///< create
    LAYER_EXAMPLES, ///< examples
    LAYER_ORACLE,   ///< tests/oracle
    LAYER_TESTS,    ///< tests: may include everything
    LAYER_NOWHERE,
} layer_kind;

typedef struct layer_info
{
    layer_kind kind;
    char name[64]; ///< of the engine's layer or of the module; empty for the files that list them
    int level;     ///< of an engine's layer, from 0 at the bottom; -1 for an unlisted layer
} layer_info;

layer_info layer_of( const char* path );
/// Level of an engine's layer by name, -1 if there is no such layer.
int layer_level( const char* name );

/// @return null if it may, else the violation: "plan is above store"
const char* layer_fault( const char* from, const char* to );
