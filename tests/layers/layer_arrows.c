#include "layer_arrows.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/// A room of the engine, and how far up the public headers it may see reach. Rooms of one level do not see each other.
typedef struct engine_room
{
    const char* name;
    int level;
    const char* public_headers; ///< null: all
} engine_room;

static const engine_room engine_rooms[] = {
    { "base", 0, " base.h " },
    { "math", 1, " base.h random.h " },
    { "jobs", 2, " base.h random.h jobs.h " },
    { "kernels", 3, " base.h random.h jobs.h fabric.h kernels.h springs.h variants.h " },
    { "space", 3,
      " base.h random.h jobs.h kernels.h space.h collision_mesh.h shapes.h samples.h sampling.h aabb_pairs.h "
      "intersections.h "
      "variants.h " },
    { "store", 3, NULL },
    { "cook", 3, NULL },
    { "plan", 4, NULL },
    { "passes", 5, NULL },
    { "world", 6, NULL },
    { "tune", 7, NULL },
};

static const engine_room* find_room( const char* name )
{
    for ( size_t i = 0; i < sizeof( engine_rooms ) / sizeof( engine_rooms[0] ); ++i )
    {
        if ( strcmp( engine_rooms[i].name, name ) == 0 )
        {
            return &engine_rooms[i];
        }
    }
    return NULL;
}

int room_level( const char* name )
{
    const engine_room* found = find_room( name );
    return found ? found->level : -1;
}

static bool begins( const char* text, const char* start )
{
    return strncmp( text, start, strlen( start ) ) == 0;
}

// The folder behind the prefix; nothing for a file that lies right in it.
static void copy_folder( char* out, size_t size, const char* rest )
{
    const char* slash = strchr( rest, '/' );
    snprintf( out, size, "%.*s", slash ? (int)( slash - rest ) : 0, rest );
}

room_info room_of( const char* path )
{
    static const struct
    {
        const char* prefix;
        room_kind kind;
    } kinds[] = {
        { "engine/include/", ROOM_PUBLIC },
        { "engine/", ROOM_ENGINE },
        { "modules/", ROOM_MODULE },
        { "app/io/", ROOM_IO },
        { "app/render/", ROOM_IO },
        { "app/results/", ROOM_IO },
        { "app/", ROOM_APP },
        { "bench/", ROOM_BENCH },
        { "tests/", ROOM_TESTS },
        { "examples/", ROOM_EXAMPLES },
    };
    room_info out = { .kind = ROOM_NOWHERE, .level = -1 };
    if ( begins( path, "tests/oracle/" ) )
    {
        out.kind = ROOM_ORACLE;
        return out;
    }
    for ( size_t i = 0; i < sizeof( kinds ) / sizeof( kinds[0] ); ++i )
    {
        if ( begins( path, kinds[i].prefix ) )
        {
            out.kind = kinds[i].kind;
            copy_folder( out.name, sizeof( out.name ), path + strlen( kinds[i].prefix ) );
            break;
        }
    }
    out.level = out.kind == ROOM_ENGINE ? room_level( out.name ) : -1;
    return out;
}

static const char* file_name( const char* path )
{
    const char* slash = strrchr( path, '/' );
    return slash ? slash + 1 : path;
}

// Headers of the engine that only modules include; a host needs none of them.
static bool is_for_modules( const char* path )
{
    return begins( path, "engine/include/wisp/module/" );
}

// A module shows one header, modules/<name>/<name>.h; the rest of its folder is its own.
static bool is_module_face( const char* path, const char* module )
{
    char face[160];
    snprintf( face, sizeof( face ), "modules/%s/%s.h", module, module );
    return strcmp( path, face ) == 0;
}

static const char* engine_fault( const room_info* from, const room_info* to, const char* to_path )
{
    if ( from->level < 0 )
    {
        return "the order of the engine's rooms does not name this room";
    }
    if ( to->kind == ROOM_PUBLIC )
    {
        const char* allowed = find_room( from->name )->public_headers;
        char word[128];
        snprintf( word, sizeof( word ), " %s ", file_name( to_path ) );
        return !allowed || strstr( allowed, word ) ? NULL : "this public header belongs to a room above";
    }
    if ( to->kind != ROOM_ENGINE )
    {
        return "the engine knows nothing outside engine/";
    }
    if ( strcmp( from->name, to->name ) == 0 || ( to->level >= 0 && to->level < from->level ) )
    {
        return NULL;
    }
    return to->level == from->level ? "that room is beside this one, not below it" : "that room is above this one";
}

// What a host includes leads to nothing that only modules need.
static const char* public_fault( const char* from_path, const room_info* to, const char* to_path )
{
    if ( to->kind != ROOM_PUBLIC )
    {
        return "a public header may include public headers only";
    }
    return is_for_modules( to_path ) && !is_for_modules( from_path ) ? "wisp/module/ is for modules, not for hosts"
                                                                     : NULL;
}

static const char* module_fault( const char* from_path, const room_info* from, const char* to_path,
                                 const room_info* to )
{
    if ( is_for_modules( to_path ) && is_module_face( from_path, from->name ) )
    {
        return "wisp/module/ is for modules, not for hosts";
    }
    if ( to->kind == ROOM_PUBLIC || ( to->kind == ROOM_MODULE && strcmp( from->name, to->name ) == 0 ) )
    {
        return NULL;
    }
    return to->kind == ROOM_MODULE ? "a module never includes another module; two modules meet at a component"
                                   : "a module may include wisp/*.h and its own folder, nothing else";
}

// Everything above the modules: what each may see besides the public headers and the modules' own faces.
static const char* upper_fault( const room_info* from, const room_info* to, const char* to_path )
{
    if ( from->kind == ROOM_EXAMPLES && is_for_modules( to_path ) )
    {
        return "wisp/module/ is for modules, not for hosts";
    }
    if ( to->kind == ROOM_PUBLIC || to->kind == from->kind )
    {
        return NULL;
    }
    if ( to->kind == ROOM_MODULE )
    {
        return is_module_face( to_path, to->name ) ? NULL : "that header is the module's own";
    }
    if ( to->kind == ROOM_ENGINE )
    {
        // Grooms that are made have the same bits everywhere, so their sines come from the engine's headers.
        bool is_for_grooms = from->kind == ROOM_IO && strcmp( to->name, "math" ) == 0;
        return is_for_grooms ? NULL : "outside the engine only engine/include/wisp is seen";
    }
    if ( from->kind == ROOM_APP )
    {
        return to->kind == ROOM_IO || to->kind == ROOM_BENCH
                   ? NULL
                   : "the program stands on bench, app/io and the folders next to it";
    }
    if ( from->kind == ROOM_BENCH )
    {
        // modules.inc is data: the one list that names engine and modules in one breath.
        bool is_below = to->kind == ROOM_IO || to->kind == ROOM_ORACLE || strcmp( to_path, "app/modules.inc" ) == 0;
        return is_below ? NULL : "the benchmark stands on app/io and the oracle, not on this";
    }
    return from->kind == ROOM_IO ? "that is above app/io, app/render and app/results"
                                 : "an example sees what an installed library shows";
}

const char* room_arrow_fault( const char* from_path, const char* to_path )
{
    room_info from = room_of( from_path );
    room_info to = room_of( to_path );
    switch ( from.kind )
    {
        case ROOM_PUBLIC:
            return public_fault( from_path, &to, to_path );
        case ROOM_ENGINE:
            return engine_fault( &from, &to, to_path );
        case ROOM_MODULE:
            return module_fault( from_path, &from, to_path, &to );
        case ROOM_IO:
        case ROOM_BENCH:
        case ROOM_APP:
        case ROOM_EXAMPLES:
            return upper_fault( &from, &to, to_path );
        case ROOM_ORACLE:
        case ROOM_TESTS:
        case ROOM_NOWHERE:
            break;
    }
    return NULL;
}
