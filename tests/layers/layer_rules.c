#include "layer_rules.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/// A layer of the engine, and the highest public headers that it may include. Layers of one level must not include
/// each other.
typedef struct engine_room
{
    const char* name;
    int level;
    const char* public_headers; ///< null: all
} engine_room;

static const engine_room engine_rooms[] = {
    { "base", 0, " base.h definition.h " },
    { "math", 1, " base.h random.h shapes.h " },
    { "jobs", 2, " base.h random.h jobs.h " },
    { "kernels", 3, " base.h random.h jobs.h fabric.h kernels.h shapes.h skin.h springs.h variants.h " },
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

int layer_level( const char* name )
{
    const engine_room* found = find_room( name );
    return found ? found->level : -1;
}

static bool begins( const char* text, const char* start )
{
    return strncmp( text, start, strlen( start ) ) == 0;
}

// The folder after the prefix; empty for a file directly in it.
static void copy_folder( char* out, size_t size, const char* rest )
{
    const char* slash = strchr( rest, '/' );
    snprintf( out, size, "%.*s", slash ? (int)( slash - rest ) : 0, rest );
}

layer_info layer_of( const char* path )
{
    static const struct
    {
        const char* prefix;
        layer_kind kind;
    } kinds[] = {
        { "engine/include/", LAYER_PUBLIC },
        { "engine/", LAYER_ENGINE },
        { "modules/", LAYER_MODULE },
        { "app/io/", LAYER_IO },
        { "app/render/", LAYER_IO },
        { "app/report/", LAYER_IO },
        { "app/results/", LAYER_IO },
        { "app/stability/", LAYER_IO },
        { "app/suite/", LAYER_IO },
        { "app/world/", LAYER_IO },
        { "app/", LAYER_APP },
        { "bench/", LAYER_BENCH },
        { "create/", LAYER_CREATE },
        { "tests/", LAYER_TESTS },
        { "examples/", LAYER_EXAMPLES },
    };
    layer_info out = { .kind = LAYER_NOWHERE, .level = -1 };
    if ( begins( path, "tests/oracle/" ) )
    {
        out.kind = LAYER_ORACLE;
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
    out.level = out.kind == LAYER_ENGINE ? layer_level( out.name ) : -1;
    return out;
}

static const char* file_name( const char* path )
{
    const char* slash = strrchr( path, '/' );
    return slash ? slash + 1 : path;
}

// Headers of the engine that only modules include; a host does not need them.
static bool is_for_modules( const char* path )
{
    return begins( path, "engine/include/wisp/module/" );
}

// A module publishes one header, modules/<name>/<name>.h; the rest of its folder is private.
static bool is_module_face( const char* path, const char* module )
{
    char face[160];
    snprintf( face, sizeof( face ), "modules/%s/%s.h", module, module );
    return strcmp( path, face ) == 0;
}

static const char* engine_fault( const layer_info* from, const layer_info* to, const char* to_path )
{
    if ( from->level < 0 )
    {
        return "the order of the engine's layers does not name this layer";
    }
    if ( to->kind == LAYER_PUBLIC )
    {
        const char* allowed = find_room( from->name )->public_headers;
        char word[128];
        snprintf( word, sizeof( word ), " %s ", file_name( to_path ) );
        return !allowed || strstr( allowed, word ) ? NULL : "this public header belongs to a layer above";
    }
    if ( to->kind != LAYER_ENGINE )
    {
        return "the engine knows nothing outside engine/";
    }
    if ( strcmp( from->name, to->name ) == 0 || ( to->level >= 0 && to->level < from->level ) )
    {
        return NULL;
    }
    return to->level == from->level ? "that layer is beside this one, not below it" : "that layer is above this one";
}

// Headers for hosts include no headers for modules.
static const char* public_fault( const char* from_path, const layer_info* to, const char* to_path )
{
    if ( to->kind != LAYER_PUBLIC )
    {
        return "a public header may include public headers only";
    }
    return is_for_modules( to_path ) && !is_for_modules( from_path ) ? "wisp/module/ is for modules, not for hosts"
                                                                     : NULL;
}

static const char* module_fault( const char* from_path, const layer_info* from, const char* to_path,
                                 const layer_info* to )
{
    if ( is_for_modules( to_path ) && is_module_face( from_path, from->name ) )
    {
        return "wisp/module/ is for modules, not for hosts";
    }
    if ( to->kind == LAYER_PUBLIC || ( to->kind == LAYER_MODULE && strcmp( from->name, to->name ) == 0 ) )
    {
        return NULL;
    }
    return to->kind == LAYER_MODULE ? "a module never includes another module; two modules meet at a component"
                                    : "a module may include wisp/*.h and its own folder, nothing else";
}

// Everything above the modules: what each may see besides the public headers and the modules' own faces.
static const char* upper_fault( const layer_info* from, const layer_info* to, const char* to_path )
{
    if ( from->kind == LAYER_EXAMPLES && is_for_modules( to_path ) )
    {
        return "wisp/module/ is for modules, not for hosts";
    }
    if ( to->kind == LAYER_PUBLIC || to->kind == LAYER_CREATE || to->kind == from->kind )
    {
        return NULL;
    }
    if ( to->kind == LAYER_MODULE )
    {
        const bool is_list = strcmp( to_path, "modules/modules.inc" ) == 0;
        return is_list || is_module_face( to_path, to->name ) ? NULL : "that header is the module's own";
    }
    if ( to->kind == LAYER_ENGINE )
    {
        // Grooms that are made have the same bits everywhere, so their sines come from the engine's headers.
        bool is_for_grooms = from->kind == LAYER_IO && strcmp( to->name, "math" ) == 0;
        return is_for_grooms ? NULL : "outside the engine only engine/include/wisp is seen";
    }
    if ( from->kind == LAYER_APP )
    {
        return to->kind == LAYER_IO || to->kind == LAYER_BENCH
                   ? NULL
                   : "the program stands on bench, app/io and the folders next to it";
    }
    if ( from->kind == LAYER_BENCH )
    {
        bool is_below = to->kind == LAYER_IO || to->kind == LAYER_ORACLE;
        return is_below ? NULL : "the benchmark stands on app/io, app/world, app/suite and the oracle, not on this";
    }
    if ( from->kind == LAYER_CREATE )
    {
        return "covers stand on the engine and the modules";
    }
    return from->kind == LAYER_IO ? "that is above app/io, app/render, app/results, app/world and app/suite"
                                  : "an example sees what an installed library shows";
}

const char* layer_fault( const char* from_path, const char* to_path )
{
    layer_info from = layer_of( from_path );
    layer_info to = layer_of( to_path );
    switch ( from.kind )
    {
        case LAYER_PUBLIC:
            return public_fault( from_path, &to, to_path );
        case LAYER_ENGINE:
            return engine_fault( &from, &to, to_path );
        case LAYER_MODULE:
            return module_fault( from_path, &from, to_path, &to );
        case LAYER_IO:
        case LAYER_BENCH:
        case LAYER_APP:
        case LAYER_CREATE:
        case LAYER_EXAMPLES:
            return upper_fault( &from, &to, to_path );
        case LAYER_ORACLE:
        case LAYER_TESTS:
        case LAYER_NOWHERE:
            break;
    }
    return NULL;
}
