#include "check_layers.h"

#include "layer_rules.h"
#include "layer_tree.h"

#include <limits.h>
#include <regex.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define EFFECTS_MAX 256
#define NAME_SIZE 256 ///< an include or a word in a message; longer ones are cut

/// Patterns of the rules that search for words.
typedef enum pattern
{
    PATTERN_INCLUDE,      ///< 1: quote or bracket, 2: the name
    PATTERN_MACRO,        ///< an include whose name is computed
    PATTERN_OPENMP,       ///< in C
    PATTERN_INTRINSICS,   ///< in C
    PATTERN_MESON_LAYER,  ///< 2: store_include, store_lib ...
    PATTERN_MESON_OPENMP, ///< the dependency
    PATTERN_MESON_WIDE,   ///< flags of an instruction set
    PATTERN_MESON_OUT,    ///< a path that leaves the folder
    PATTERN_COUNT,
} pattern;

#define WORD_BEGIN "(^|[^A-Za-z0-9_])"

static const char* const pattern_texts[PATTERN_COUNT] = {
    [PATTERN_INCLUDE] = "^[ \t]*#[ \t]*include[ \t]*([\"<])([^\">]*)[\">]",
    [PATTERN_MACRO] = "^[ \t]*#[ \t]*include[ \t]*[A-Za-z_]",
    [PATTERN_OPENMP] = "([<\"]omp\\.h[>\"])|(#[ \t]*pragma[ \t]+omp)|(_Pragma[ \t]*\\([ \t]*\"[ \t]*omp)|" WORD_BEGIN
                       "omp_[a-z_]+[ \t]*\\(",
    [PATTERN_INTRINSICS] =
        "([<\"][a-z0-9]*intrin\\.h[>\"])|([<\"](arm_neon|arm_sve)\\.h[>\"])|([<\"]simde/)|" WORD_BEGIN
        "(_mm(256|512)?_[a-z0-9_]+|__m(64|128|256|512)[a-z]*|__mmask(8|16|32|64)|__builtin_ia32_[a-z0-9_]+)",
    [PATTERN_MESON_LAYER] = WORD_BEGIN "([a-z]+)_(include|includes|lib|libs|dep)([^a-z_]|$)",
    [PATTERN_MESON_OPENMP] = "openmp",
    [PATTERN_MESON_WIDE] = "'-m(avx|sse|fma|bmi|arch=)",
    [PATTERN_MESON_OUT] = "'[^']*(\\.\\.|engine/)[^']*'",
};

/// A word that the engine must not contain, and the folder it comes from.
typedef struct effect_word
{
    char word[64];
    regex_t pattern;
} effect_word;

typedef struct checker
{
    const char* root;
    FILE* out;
    layer_tree tree;
    regex_t patterns[PATTERN_COUNT];
    effect_word effects[EFFECTS_MAX];
    int effect_count;
    int found;
} checker;

/// A line of a file, prepared for the rules.
typedef struct place
{
    const char* path;
    int line;
    const char* text;
} place;

static void report( checker* c, const place* at, const char* word, const char* message )
{
    fprintf( c->out, "%s:%d: '%s': %s\n", at->path, at->line, word, message );
    ++c->found;
}

static bool ends( const char* text, const char* end )
{
    size_t size = strlen( text ), tail = strlen( end );
    return size >= tail && strcmp( text + size - tail, end ) == 0;
}

static bool begins( const char* text, const char* start )
{
    return strncmp( text, start, strlen( start ) ) == 0;
}

/// Match and copy group `group` of the first match.
static bool match( const regex_t* regex, const char* text, int group, char* out, size_t size )
{
    regmatch_t groups[4];
    if ( regexec( regex, text, 4, groups, 0 ) != 0 || groups[group].rm_so < 0 )
    {
        return false;
    }
    snprintf( out, size, "%.*s", (int)( groups[group].rm_eo - groups[group].rm_so ), text + groups[group].rm_so );
    return true;
}

// ---- resolution of includes ----

// Remove "." and ".." from folder/name, as a compiler would find the file.
static void join( char* out, size_t size, const char* from_path, const char* name )
{
    const char* slash = strrchr( from_path, '/' );
    char path[2 * PATH_MAX];
    snprintf( path, sizeof( path ), "%.*s/%s", slash ? (int)( slash - from_path ) : 0, from_path, name );
    out[0] = 0;
    for ( char *rest = path, *part = strsep( &rest, "/" ); part; part = strsep( &rest, "/" ) )
    {
        size_t length = strlen( out );
        if ( strcmp( part, ".." ) == 0 )
        {
            char* last = strrchr( out, '/' );
            *( last ? last : out ) = 0;
        }
        else if ( part[0] != 0 && strcmp( part, "." ) != 0 )
        {
            snprintf( out + length, size - length, "%s%s", length > 0 ? "/" : "", part );
        }
    }
}

// Whether `path` can be the file `name` on some include path. Public headers are included as wisp/<name>, where an
// installed module's header is too. Generated headers are in the tree with .in appended.
static bool could_mean( const char* path, const char* name )
{
    char text[2 * NAME_SIZE + 32];
    if ( begins( name, "wisp/" ) )
    {
        const char* file = name + strlen( "wisp/" );
        size_t stem = strcspn( file, "." );
        snprintf( text, sizeof( text ), "engine/include/%s", name );
        bool is_public = strcmp( path, text ) == 0;
        snprintf( text, sizeof( text ), "modules/%.*s/%s", (int)stem, file, file );
        return is_public || strcmp( path, text ) == 0;
    }
    snprintf( text, sizeof( text ), "/%s", name );
    size_t tail = strlen( path ) - ( ends( path, ".in" ) ? 3 : 0 );
    size_t size = strlen( text );
    bool is_end = tail >= size && strncmp( path + tail - size, text, size ) == 0;
    return ( is_end && layer_of( path ).kind != LAYER_PUBLIC ) || strcmp( path, name ) == 0;
}

// A name that occurs in several layers is judged by the best of them: the include paths of meson decide which one it
// is.
// @return null if it is allowed; "" if no file of the tree has the name
static const char* include_fault( const checker* c, const char* from, const char* name, bool is_quoted )
{
    char beside[PATH_MAX];
    join( beside, sizeof( beside ), from, name );
    if ( is_quoted && layer_tree_has( &c->tree, beside ) )
    {
        return layer_fault( from, beside );
    }
    const char* fault = "";
    for ( int i = 0; i < c->tree.count && fault; ++i )
    {
        if ( could_mean( c->tree.paths[i], name ) )
        {
            const char* candidate = layer_fault( from, c->tree.paths[i] );
            fault = candidate && fault[0] != 0 ? fault : candidate;
        }
    }
    return fault;
}

// System headers allowed in libwisp. OpenMP and intrinsics have rules of their own.
static bool is_system_header_fine( const layer_info* here, const char* name )
{
    static const char standard[] =
        " assert.h complex.h ctype.h errno.h fenv.h float.h inttypes.h iso646.h limits.h locale.h math.h setjmp.h "
        "signal.h stdalign.h stdarg.h stdatomic.h stdbool.h stddef.h stdint.h stdio.h stdlib.h stdnoreturn.h "
        "string.h "
        "tgmath.h time.h uchar.h wchar.h wctype.h ";
    char word[NAME_SIZE + 2];
    snprintf( word, sizeof( word ), " %s ", name );
    if ( strstr( standard, word ) || strcmp( name, "omp.h" ) == 0 || ends( name, "intrin.h" ) ||
         begins( name, "simde/" ) )
    {
        return true;
    }
    bool is_jobs = here->kind == LAYER_ENGINE && strcmp( here->name, "jobs" ) == 0;
    bool is_space = here->kind == LAYER_ENGINE && strcmp( here->name, "space" ) == 0;
    const bool is_of_threads =
        strcmp( name, "sched.h" ) == 0 || strcmp( name, "pthread.h" ) == 0 || strcmp( name, "unistd.h" ) == 0;
    return ( is_jobs && is_of_threads ) || ( is_space && begins( name, "embree" ) );
}

// ---- rules for one line ----

static bool is_library( const layer_info* here )
{
    return here->kind == LAYER_PUBLIC || here->kind == LAYER_ENGINE || here->kind == LAYER_MODULE;
}

static void check_include( checker* c, const place* at )
{
    char mark[4], name[NAME_SIZE];
    if ( !match( &c->patterns[PATTERN_INCLUDE], at->text, 1, mark, sizeof( mark ) ) )
    {
        if ( match( &c->patterns[PATTERN_MACRO], at->text, 0, name, sizeof( name ) ) )
        {
            report( c, at, name, "an include whose name is computed cannot be checked" );
        }
        return;
    }
    match( &c->patterns[PATTERN_INCLUDE], at->text, 2, name, sizeof( name ) );
    layer_info here = layer_of( at->path );
    const char* fault = include_fault( c, at->path, name, mark[0] == '"' );
    if ( !fault )
    {
        return;
    }
    if ( fault[0] != 0 )
    {
        report( c, at, name, fault );
    }
    else if ( is_library( &here ) && !is_system_header_fine( &here, name ) )
    {
        report( c, at, name, "the library stands on the C library, OpenMP and Embree, each in its layer" );
    }
    else if ( mark[0] == '"' && !is_library( &here ) )
    {
        report( c, at, name, "no file of the tree has this name" );
    }
}

static bool may_use_openmp( const char* path )
{
    return begins( path, "engine/jobs/" );
}

static bool may_use_intrinsics( const char* path )
{
    return begins( path, "engine/math/lane" ) || begins( path, "engine/kernels/" );
}

static void check_c_line( checker* c, const place* at )
{
    char word[NAME_SIZE];
    check_include( c, at );
    if ( !may_use_openmp( at->path ) && match( &c->patterns[PATTERN_OPENMP], at->text, 0, word, sizeof( word ) ) )
    {
        report( c, at, word, "only engine/jobs knows OpenMP" );
    }
    if ( !may_use_intrinsics( at->path ) &&
         match( &c->patterns[PATTERN_INTRINSICS], at->text, 0, word, sizeof( word ) ) )
    {
        report( c, at, word, "intrinsics live in engine/math/lane*.h and engine/kernels" );
    }
}

static const char* meson_layer_fault( const layer_info* from, const char* name )
{
    int level = layer_level( name );
    bool is_engine_word = level >= 0 || strcmp( name, "engine" ) == 0;
    if ( from->kind == LAYER_ENGINE )
    {
        bool is_above = level > from->level || ( level == from->level && strcmp( name, from->name ) != 0 );
        bool is_outside = strcmp( name, "module" ) == 0 || strcmp( name, "engine" ) == 0;
        return ( level >= 0 && is_above ) || is_outside ? "that is not below this layer" : NULL;
    }
    bool is_for_grooms = from->kind == LAYER_IO && strcmp( name, "math" ) == 0;
    return is_engine_word && !is_for_grooms ? "outside the engine only engine/include/wisp is seen" : NULL;
}

// Every name on the line, each judged separately. math_lib_dep is the C library's and no layer's: "math_lib" does not
// end there, so the pattern skips it.
static void check_meson_layers( checker* c, const place* at, const layer_info* from )
{
    regmatch_t groups[4];
    for ( const char* text = at->text; regexec( &c->patterns[PATTERN_MESON_LAYER], text, 4, groups, 0 ) == 0;
          text += groups[3].rm_eo )
    {
        char name[64];
        snprintf( name, sizeof( name ), "%.*s", (int)( groups[2].rm_eo - groups[2].rm_so ), text + groups[2].rm_so );
        const char* fault = meson_layer_fault( from, name );
        if ( fault )
        {
            report( c, at, name, fault );
        }
    }
}

static void check_meson_line( checker* c, const place* at )
{
    char word[NAME_SIZE];
    layer_info here = layer_of( at->path );
    bool is_list = is_library( &here ) && here.name[0] == 0;
    if ( !is_list )
    {
        check_meson_layers( c, at, &here );
    }
    if ( !may_use_openmp( at->path ) &&
         match( &c->patterns[PATTERN_MESON_OPENMP], at->text, 0, word, sizeof( word ) ) )
    {
        report( c, at, word, "only engine/jobs is built with OpenMP" );
    }
    if ( !may_use_intrinsics( at->path ) &&
         match( &c->patterns[PATTERN_MESON_WIDE], at->text, 0, word, sizeof( word ) ) )
    {
        report( c, at, word, "only engine/kernels is compiled for an instruction set" );
    }
    if ( is_library( &here ) && match( &c->patterns[PATTERN_MESON_OUT], at->text, 0, word, sizeof( word ) ) )
    {
        report( c, at, word, "a layer names files of its own folder only" );
    }
}

static void check_effects( checker* c, const place* at )
{
    for ( int i = 0; i < c->effect_count; ++i )
    {
        if ( regexec( &c->effects[i].pattern, at->text, 0, NULL, 0 ) == 0 )
        {
            report( c, at, c->effects[i].word, "the engine has never heard of an effect" );
        }
    }
}

// ---- files ----

typedef void line_rule( checker* c, const place* at );

static void check_lines( checker* c, const char* path, char* text, line_rule* rule )
{
    int number = 0;
    for ( char *rest = text, *line = strsep( &rest, "\n" ); line; line = strsep( &rest, "\n" ) )
    {
        rule( c, &( place ){ path, ++number, line } );
    }
}

static bool with_text( checker* c, const char* path, void ( *blank )( char* ), line_rule* rule )
{
    char* text = layer_text_read( c->root, path );
    if ( !text )
    {
        fprintf( c->out, "%s: cannot be read\n", path );
        return false;
    }
    if ( blank )
    {
        blank( text );
    }
    check_lines( c, path, text, rule );
    free( text );
    return true;
}

static bool check_file( checker* c, const char* path )
{
    layer_kind kind = layer_of( path ).kind;
    bool good = true;
    if ( kind == LAYER_ENGINE || kind == LAYER_PUBLIC )
    {
        // Names of files first, as line 0; then the text with all its comments.
        check_effects( c, &( place ){ path, 0, path + strlen( "engine/" ) } );
        good = with_text( c, path, NULL, check_effects );
    }
    if ( kind == LAYER_TESTS || kind == LAYER_ORACLE || kind == LAYER_NOWHERE )
    {
        return good;
    }
    if ( ends( path, ".c" ) || ends( path, ".h" ) || ends( path, ".cpp" ) || ends( path, ".inc" ) )
    {
        good = with_text( c, path, layer_text_blank_c, check_c_line ) && good;
    }
    else if ( ends( path, "/meson.build" ) )
    {
        good = with_text( c, path, layer_text_blank_hash, check_meson_line ) && good;
    }
    return good;
}

// ---- names of effects ----

// Words for data or geometry, which the engine may use although a folder's name contains them.
static bool is_generic( const char* word )
{
    static const char words[] = " strand strands hair look appearance collision environment cloth triangle triangles "
                                "boundary particle particles implicit contact attachments motion constraints seams ";
    char between[66];
    snprintf( between, sizeof( between ), " %s ", word );
    return strstr( words, between ) != NULL;
}

// @param word as in a folder's name; an underscore matches any separator or none
static bool add_effect( checker* c, const char* word )
{
    for ( int i = 0; i < c->effect_count; ++i )
    {
        if ( strcmp( c->effects[i].word, word ) == 0 )
        {
            return true;
        }
    }
    if ( c->effect_count == EFFECTS_MAX )
    {
        fprintf( c->out, "modules: more than %d words in the names of effects\n", EFFECTS_MAX );
        return false;
    }
    // An underscore next to the word is a border too: frozen_look and WISP_FROZEN contain frozen.
    char text[512] = "(^|[^[:alnum:]])";
    size_t length = strlen( text );
    for ( const char* at = word; *at && length < sizeof( text ) - 64; ++at )
    {
        length += (size_t)snprintf( text + length, sizeof( text ) - length, *at == '_' ? "[ _-]?" : "%c", *at );
    }
    snprintf( text + length, sizeof( text ) - length, "s?([^[:alnum:]]|$)" );
    effect_word* effect = &c->effects[c->effect_count];
    snprintf( effect->word, sizeof( effect->word ), "%s", word );
    bool good = regcomp( &effect->pattern, text, REG_EXTENDED | REG_ICASE | REG_NOSUB ) == 0;
    c->effect_count += good ? 1 : 0;
    return good;
}

static bool add_effects_of( checker* c, const char* folder )
{
    char words[64];
    snprintf( words, sizeof( words ), "%s", folder );
    bool good = true;
    int special = 0;
    for ( char *rest = words, *word = strsep( &rest, "_" ); word && good; word = strsep( &rest, "_" ) )
    {
        if ( word[0] != 0 && !is_generic( word ) )
        {
            ++special;
            good = add_effect( c, word );
        }
    }
    // Where every word is generic, only the whole name identifies the effect; a single such word does not.
    return good && ( special > 0 || strchr( folder, '_' ) == NULL || add_effect( c, folder ) );
}

static bool collect_effects( checker* c )
{
    // The engine's first promise names the balloon, which has no folder of its own yet.
    bool good = add_effect( c, "balloon" );
    for ( int i = 0; i < c->tree.count && good; ++i )
    {
        layer_info here = layer_of( c->tree.paths[i] );
        if ( here.kind == LAYER_MODULE && here.name[0] != 0 )
        {
            good = add_effects_of( c, here.name );
        }
    }
    return good;
}

// ---- the whole tree ----

static bool read_tree( checker* c )
{
    static const char* const folders[] = { "engine", "modules", "create", "app", "bench", "examples", "tests" };
    bool good = true;
    for ( size_t i = 0; i < sizeof( folders ) / sizeof( folders[0] ) && good; ++i )
    {
        good = layer_tree_add( &c->tree, c->root, folders[i] );
    }
    layer_tree_sort( &c->tree );
    bool has_engine = false;
    for ( int i = 0; i < c->tree.count && !has_engine; ++i )
    {
        has_engine = layer_of( c->tree.paths[i] ).kind == LAYER_ENGINE;
    }
    if ( !has_engine )
    {
        fprintf( c->out, "%s: there is no engine to look at\n", c->root );
    }
    return good && has_engine;
}

int check_layers( const char* root, FILE* out )
{
    checker* c = calloc( 1, sizeof( checker ) );
    if ( !c )
    {
        return -1;
    }
    c->root = root;
    c->out = out;
    for ( int i = 0; i < PATTERN_COUNT; ++i )
    {
        if ( regcomp( &c->patterns[i], pattern_texts[i], REG_EXTENDED ) != 0 )
        {
            abort(); // the texts are constants
        }
    }
    bool good = read_tree( c ) && collect_effects( c );
    for ( int i = 0; i < c->tree.count && good; ++i )
    {
        good = check_file( c, c->tree.paths[i] );
    }
    for ( int i = 0; i < c->effect_count; ++i )
    {
        regfree( &c->effects[i].pattern );
    }
    for ( int i = 0; i < PATTERN_COUNT; ++i )
    {
        regfree( &c->patterns[i] );
    }
    layer_tree_release( &c->tree );
    int found = good ? c->found : -1;
    free( c );
    return found;
}
