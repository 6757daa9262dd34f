/// Which room a file is in, and which rooms each may look into.
#pragma once

typedef enum room_kind
{
    ROOM_PUBLIC,   ///< engine/include/wisp
    ROOM_ENGINE,   ///< engine/<name>
    ROOM_MODULE,   ///< modules/<name>
    ROOM_IO,       ///< app/io, app/render, app/results
    ROOM_BENCH,    ///< bench
    ROOM_APP,      ///< app
    ROOM_EXAMPLES, ///< examples
    ROOM_ORACLE,   ///< tests/oracle
    ROOM_TESTS,    ///< tests: free to look anywhere
    ROOM_NOWHERE,
} room_kind;

typedef struct room_info
{
    room_kind kind;
    char name[64]; ///< of the engine's room or of the module; empty for the files that list them
    int level;     ///< of an engine's room, from 0 at the bottom; -1 if the order does not know it
} room_info;

room_info room_of( const char* path );
/// Level of an engine's room by name, -1 if there is no such room.
int room_level( const char* name );

/// @return null if the arrow points down, else what is wrong with it: "plan is above store"
const char* room_arrow_fault( const char* from, const char* to );
