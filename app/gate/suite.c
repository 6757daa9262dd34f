#include "suite.h"

#include "io_file.h"
#include "nearest.h"
#include "scene_text.h"
#include "text_tree.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

const suite_measure_info suite_measures[SUITE_MEASURE_COUNT] = {
    [SUITE_INSTRUCTIONS] = { "instructions", { 0.005, 0.0 } },
    [SUITE_BYTES] = { "bytes", { 0.01, 0.0 } },
    [SUITE_ALLOCATIONS] = { "allocations", { 0.0, 0.0 } },
    [SUITE_STRETCH] = { "stretch", { 0.05, 1e-4 } },
    [SUITE_ENERGY] = { "energy", { 0.05, 1e-9 } },
    [SUITE_PENETRATION] = { "penetration", { 0.05, 1e-5 } },
    [SUITE_INTERSECTIONS] = { "intersections", { 0.0, 0.0 } },
    [SUITE_RESETS] = { "resets", { 0.0, 0.0 } },
    [SUITE_NOT_CONVERGED] = { "not_converged", { 0.0, 0.0 } },
    [SUITE_HALTED] = { "halted", { 0.0, 0.0 } },
};

enum
{
    MAX_SETTINGS = 16, // that vary in an entry
    MAX_BYTES = 1 << 20,
};

typedef struct reader
{
    scene_source source;
    scene_tree tree;
    gate_suite* out;
    int capacity;
    suite_budget budgets[SUITE_MEASURE_COUNT]; // of all entries
} reader;

// What an entry says.
typedef struct entry
{
    const scene_node *file, *name, *steps, *set, *vary, *budgets;
} entry;

__attribute__( ( format( printf, 3, 4 ) ) ) static wisp_status refuse( const reader* r, const scene_node* node,
                                                                       const char* format, ... )
{
    char message[400];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( message, sizeof message, format, arguments );
    va_end( arguments );
    return scene_refuse( &r->source, node->line, node->column, "", "%s", message );
}

static wisp_status refuse_key( const reader* r, const scene_node* node, const char* const* keys, int count )
{
    const scene_quote quote = scene_shorten( scene_key_of( &r->tree, node ) );
    const char* nearest = nearest_word( quote.text, keys, count );
    char all[160] = "";
    for ( int i = 0; i < count; ++i )
    {
        strncat( all, i > 0 ? ", " : "", sizeof all - strlen( all ) - 1 );
        strncat( all, keys[i], sizeof all - strlen( all ) - 1 );
    }
    return nearest ? scene_refuse( &r->source, node->key_line, node->key_column, "",
                                   "got key '%s'; did you mean '%s'?", quote.text, nearest )
                   : scene_refuse( &r->source, node->key_line, node->key_column, "",
                                   "got key '%s', expected one of %s", quote.text, all );
}

// ---- budgets ----

static wisp_status read_budgets( const reader* r, const scene_node* map, suite_budget* budgets )
{
    const char* names[SUITE_MEASURE_COUNT];
    for ( int m = 0; m < SUITE_MEASURE_COUNT; ++m )
    {
        names[m] = suite_measures[m].name;
    }
    if ( map->kind != SCENE_MAP )
    {
        return refuse( r, map, "expected budgets, such as { instructions: 0.005 }" );
    }
    for ( const scene_node* n = scene_first( &r->tree, map ); n; n = scene_next( &r->tree, n ) )
    {
        int m = 0;
        while ( m < SUITE_MEASURE_COUNT && strcmp( names[m], scene_key_of( &r->tree, n ) ) != 0 )
        {
            ++m;
        }
        if ( m == SUITE_MEASURE_COUNT )
        {
            return refuse_key( r, n, names, SUITE_MEASURE_COUNT );
        }
        char* end = NULL;
        const char* text = n->kind == SCENE_SCALAR ? scene_text_of( &r->tree, n ) : "";
        const double value = strtod( text, &end );
        if ( end == text || *end != '\0' || !( value >= 0.0 && value <= 100.0 ) )
        {
            return refuse( r, n, "got budget '%s' of %s, expected a fraction of the base's value, 0 to 100",
                           scene_shorten( text ).text, names[m] );
        }
        budgets[m].relative = value;
    }
    return WISP_OK;
}

// ---- fields by path ----

// Find the node that a path leads to and that is to be set: `dt`, `surfaces[0].cloth.bending`, `surfaces[*].damping`.
// @param rest the path, changed @return how many fields were set
static int set_path( text_node* at, char* rest, const text_node* value )
{
    char* dot = strchr( rest, '.' );
    char* next = dot ? dot + 1 : NULL;
    if ( dot )
    {
        *dot = '\0';
    }
    char* bracket = strchr( rest, '[' );
    char index[16] = "";
    if ( bracket )
    {
        snprintf( index, sizeof index, "%.*s", (int)strcspn( bracket + 1, "]" ), bracket + 1 );
        *bracket = '\0';
    }
    int count = 0;
    if ( next == NULL && bracket == NULL )
    {
        text_put( at, rest, text_copy( value ) );
        count = 1;
    }
    else
    {
        text_node* list = text_find( at, rest );
        text_node* block = bracket ? NULL : list ? list : text_put( at, rest, text_map() );
        for ( int i = 0; bracket && next && list && list->kind == TEXT_LIST && i < list->count; ++i )
        {
            char number[16], own[64];
            snprintf( number, sizeof number, "%d", i );
            char* copy = text_alloc( strlen( next ) );
            strcpy( copy, next );
            snprintf( own, sizeof own, "%s", text_at( list->children[i], "name" ) );
            const bool is_meant =
                strcmp( index, "*" ) == 0 || strcmp( index, number ) == 0 || strcmp( index, own ) == 0;
            count += is_meant && list->children[i]->kind == TEXT_MAP ? set_path( list->children[i], copy, value ) : 0;
            free( copy );
        }
        count += block && next && block->kind == TEXT_MAP ? set_path( block, next, value ) : 0;
    }
    if ( bracket )
    {
        *bracket = '[';
    }
    if ( dot )
    {
        *dot = '.';
    }
    return count;
}

static text_node* value_of( const reader* r, const scene_node* node )
{
    if ( node->kind == SCENE_SCALAR )
    {
        return text_scalar( "%s", scene_text_of( &r->tree, node ) );
    }
    text_node* out = node->kind == SCENE_LIST ? text_list() : text_map();
    for ( const scene_node* n = scene_first( &r->tree, node ); n; n = scene_next( &r->tree, n ) )
    {
        if ( node->kind == SCENE_LIST )
        {
            text_add( out, value_of( r, n ) );
        }
        else
        {
            text_put( out, scene_key_of( &r->tree, n ), value_of( r, n ) );
        }
    }
    return out;
}

static wisp_status set_field( const reader* r, text_node* scene, const scene_node* field, const scene_node* value )
{
    const char* path = scene_key_of( &r->tree, field );
    char* copy = text_alloc( strlen( path ) );
    strcpy( copy, path );
    text_node* own = value_of( r, value );
    const int count = set_path( scene, copy, own );
    text_release( own );
    free( copy );
    return count > 0 ? WISP_OK
                     : scene_refuse( &r->source, field->key_line, field->key_column, "",
                                     "'%s' names nothing of the scene, such as surfaces[0].cloth.bending",
                                     scene_shorten( path ).text );
}

// ---- rows ----

static char* resolve( const char* suite_path, const char* file )
{
    const char* slash = strrchr( suite_path, '/' );
    const int folder = file[0] != '/' && slash ? (int)( slash - suite_path ) + 1 : 0;
    char* path = text_alloc( (size_t)folder + strlen( file ) );
    sprintf( path, "%.*s%s", folder, suite_path, file );
    return path;
}

static void stem_of( const char* path, char* out, size_t size )
{
    const char* slash = strrchr( path, '/' );
    const char* name = slash ? slash + 1 : path;
    const char* dot = strrchr( name, '.' );
    snprintf( out, size, "%.*s", dot && dot != name ? (int)( dot - name ) : (int)strlen( name ), name );
}

static suite_row* add_row( reader* r )
{
    gate_suite* s = r->out;
    if ( s->row_count == r->capacity )
    {
        r->capacity = r->capacity > 0 ? 2 * r->capacity : 16;
        suite_row* rows = text_alloc( (size_t)r->capacity * sizeof *rows );
        memcpy( rows, s->rows, (size_t)s->row_count * sizeof *rows * ( s->rows != NULL ) );
        free( s->rows );
        s->rows = rows;
    }
    return &s->rows[s->row_count++];
}

static void name_variant( const reader* r, const scene_node* field, const scene_node* value, char* out, size_t size )
{
    const char* path = scene_key_of( &r->tree, field );
    const char* dot = strrchr( path, '.' );
    const size_t used = strlen( out );
    text_node* own = value_of( r, value );
    char* text = text_write( own, NULL );
    text[strcspn( text, "\n" )] = '\0';
    snprintf( out + used, size - used, "%s%s=%s", used > 0 ? ", " : "", dot ? dot + 1 : path,
              text + strspn( text, " " ) );
    free( text );
    text_release( own );
}

// @return 0: all of the scene, -1: no number of steps
static int steps_of( const reader* r, const entry* e )
{
    const char* text = e->steps == NULL                 ? "0"
                       : e->steps->kind == SCENE_SCALAR ? scene_text_of( &r->tree, e->steps )
                                                        : "";
    char* end = NULL;
    const long steps = strtol( text, &end, 10 );
    return end == text || *end != '\0' || steps < ( e->steps != NULL ? 1 : 0 ) || steps > 1000000 ? -1 : (int)steps;
}

// One row of an entry: the product's setting number `which`.
static wisp_status read_row( reader* r, const entry* e, const text_node* scene, const char* path,
                             const suite_budget* budgets, int which )
{
    suite_row* row = add_row( r );
    stem_of( path, row->name, sizeof row->name );
    if ( e->name )
    {
        snprintf( row->name, sizeof row->name, "%s", scene_text_of( &r->tree, e->name ) );
    }
    row->path = text_alloc( strlen( path ) );
    strcpy( row->path, path );
    memcpy( row->budgets, budgets, sizeof row->budgets );
    row->steps = steps_of( r, e );
    text_node* own = text_copy( scene );
    wisp_status status = WISP_OK;
    for ( const scene_node* n = e->set ? scene_first( &r->tree, e->set ) : NULL; n && status == WISP_OK;
          n = scene_next( &r->tree, n ) )
    {
        status = set_field( r, own, n, n );
    }
    for ( const scene_node* n = e->vary ? scene_first( &r->tree, e->vary ) : NULL; n && status == WISP_OK;
          n = scene_next( &r->tree, n ) )
    {
        const scene_node* value = scene_first( &r->tree, n );
        for ( int i = which % n->count; i > 0; --i )
        {
            value = scene_next( &r->tree, value );
        }
        which /= n->count;
        status = set_field( r, own, n, value );
        name_variant( r, n, value, row->variant, sizeof row->variant );
    }
    row->text = text_write( own, NULL );
    text_release( own );
    wisp_scene read = { 0 };
    status = status == WISP_OK ? suite_scene( row, &read, r->source.error ) : status;
    if ( status == WISP_OK && ( row->steps > read.steps || read.steps == 0 ) )
    {
        status = refuse( r, e->steps ? e->steps : e->file, "%s: got %d steps, the scene has %d", row->name,
                         row->steps, read.steps );
    }
    wisp_scene_release( &read );
    return status;
}

static wisp_status check_settings( const reader* r, const entry* e, int* rows )
{
    *rows = 1;
    if ( steps_of( r, e ) < 0 )
    {
        return refuse( r, e->steps, "expected a number of steps, 1 to 1000000" );
    }
    if ( e->set && e->set->kind != SCENE_MAP )
    {
        return refuse( r, e->set, "expected fields and their values, such as { steps: 60 }" );
    }
    if ( e->vary && ( e->vary->kind != SCENE_MAP || e->vary->count > MAX_SETTINGS ) )
    {
        return refuse( r, e->vary, "expected up to %d fields and lists of values, such as { substeps: [4, 10] }",
                       (int)MAX_SETTINGS );
    }
    for ( const scene_node* n = e->vary ? scene_first( &r->tree, e->vary ) : NULL; n; n = scene_next( &r->tree, n ) )
    {
        if ( n->kind != SCENE_LIST || n->count == 0 )
        {
            return refuse( r, n, "%s: expected a list of values, at least one",
                           scene_shorten( scene_key_of( &r->tree, n ) ).text );
        }
        *rows = *rows > SUITE_MAX_ROWS / n->count ? SUITE_MAX_ROWS + 1 : *rows * n->count;
    }
    return *rows + r->out->row_count <= SUITE_MAX_ROWS
               ? WISP_OK
               : refuse( r, e->vary ? e->vary : e->file, "the suite has more than %d rows", (int)SUITE_MAX_ROWS );
}

static wisp_status read_scene_text( const reader* r, const scene_node* file, char** path, text_node** out )
{
    *path = resolve( r->source.name, scene_text_of( &r->tree, file ) );
    unsigned char* bytes = NULL;
    size_t size = 0;
    wisp_error inner = { 0 };
    wisp_status status = io_file_read( *path, MAX_BYTES, &bytes, &size, &inner );
    status = status == WISP_OK ? text_parse( (const char*)bytes, size, *path, out, &inner ) : status;
    free( bytes );
    return status == WISP_OK ? WISP_OK : refuse( r, file, "%s", inner.message );
}

static wisp_status read_entry( reader* r, const scene_node* map )
{
    static const char* const keys[] = { "file", "name", "steps", "set", "vary", "budgets" };
    entry e = { 0 };
    const scene_node** places[] = { &e.file, &e.name, &e.steps, &e.set, &e.vary, &e.budgets };
    if ( map->kind != SCENE_MAP )
    {
        return refuse( r, map, "expected a scene, such as { file: scene.yaml }" );
    }
    for ( const scene_node* n = scene_first( &r->tree, map ); n; n = scene_next( &r->tree, n ) )
    {
        int k = 0;
        while ( k < WISP_COUNT( keys ) && strcmp( keys[k], scene_key_of( &r->tree, n ) ) != 0 )
        {
            ++k;
        }
        if ( k == WISP_COUNT( keys ) )
        {
            return refuse_key( r, n, keys, WISP_COUNT( keys ) );
        }
        *places[k] = n;
    }
    if ( e.file == NULL || e.file->kind != SCENE_SCALAR || ( e.name && e.name->kind != SCENE_SCALAR ) )
    {
        return refuse( r, map, "expected a file and at most one name of it, such as { file: scene.yaml }" );
    }
    suite_budget budgets[SUITE_MEASURE_COUNT];
    memcpy( budgets, r->budgets, sizeof budgets );
    int rows;
    wisp_status status = e.budgets ? read_budgets( r, e.budgets, budgets ) : WISP_OK;
    status = status == WISP_OK ? check_settings( r, &e, &rows ) : status;
    char* path = NULL;
    text_node* scene = NULL;
    status = status == WISP_OK ? read_scene_text( r, e.file, &path, &scene ) : status;
    for ( int i = 0; status == WISP_OK && i < rows; ++i )
    {
        status = read_row( r, &e, scene, path, budgets, i );
    }
    text_release( scene );
    free( path );
    return status;
}

static wisp_status read_suite( reader* r )
{
    static const char* const keys[] = { "wisp_suite", "scenes", "budgets" };
    const scene_node* root = &r->tree.nodes[0];
    const scene_node *version = NULL, *scenes = NULL;
    if ( root->kind != SCENE_MAP )
    {
        return refuse( r, root, "expected a suite, which begins with wisp_suite: 1" );
    }
    wisp_status status = WISP_OK;
    for ( const scene_node* n = scene_first( &r->tree, root ); n && status == WISP_OK; n = scene_next( &r->tree, n ) )
    {
        const char* key = scene_key_of( &r->tree, n );
        version = strcmp( key, keys[0] ) == 0 ? n : version;
        scenes = strcmp( key, keys[1] ) == 0 ? n : scenes;
        if ( strcmp( key, keys[2] ) == 0 )
        {
            status = read_budgets( r, n, r->budgets );
        }
        else if ( version != n && scenes != n )
        {
            status = refuse_key( r, n, keys, WISP_COUNT( keys ) );
        }
    }
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( version == NULL || version->kind != SCENE_SCALAR || strcmp( scene_text_of( &r->tree, version ), "1" ) != 0 )
    {
        return refuse( r, version ? version : root, "expected wisp_suite: 1" );
    }
    if ( scenes == NULL || scenes->kind != SCENE_LIST || scenes->count == 0 )
    {
        return refuse( r, scenes ? scenes : root,
                       "expected scenes, a list of at least one, such as - file: scene.yaml" );
    }
    for ( const scene_node* n = scene_first( &r->tree, scenes ); n && status == WISP_OK;
          n = scene_next( &r->tree, n ) )
    {
        status = read_entry( r, n );
    }
    return status;
}

// Two rows of one name and variant could not be told apart in a base.
static wisp_status check_names( const reader* r )
{
    const gate_suite* s = r->out;
    for ( int i = 0; i < s->row_count; ++i )
    {
        for ( int k = 0; k < i; ++k )
        {
            if ( strcmp( s->rows[i].name, s->rows[k].name ) == 0 &&
                 strcmp( s->rows[i].variant, s->rows[k].variant ) == 0 )
            {
                return wisp_fail( r->source.error, WISP_BAD_INPUT,
                                  "%s: two rows are called '%s'%s%s; give one a name",
                                  io_short_name( r->source.name ), s->rows[i].name, s->rows[i].variant[0] ? ", " : "",
                                  s->rows[i].variant );
            }
        }
    }
    return WISP_OK;
}

wisp_status suite_read( const char* path, gate_suite* out, wisp_error* error )
{
    *out = ( gate_suite ){ 0 };
    stem_of( path, out->name, sizeof out->name );
    unsigned char* bytes = NULL;
    reader r = { .source = { .name = path, .error = error }, .out = out };
    for ( int m = 0; m < SUITE_MEASURE_COUNT; ++m )
    {
        r.budgets[m] = suite_measures[m].budget;
    }
    wisp_status status = io_file_read( path, MAX_BYTES, &bytes, &r.source.size, error );
    if ( status == WISP_OK )
    {
        r.source.text = bytes ? (const char*)bytes : ""; // an empty file has no block
        status = scene_tree_build( &r.source, &r.tree );
        status = status == WISP_OK ? read_suite( &r ) : status;
        status = status == WISP_OK ? check_names( &r ) : status;
        scene_tree_release( &r.tree );
    }
    free( bytes );
    return status;
}

void suite_release( gate_suite* suite )
{
    for ( int i = 0; i < suite->row_count; ++i )
    {
        free( suite->rows[i].path );
        free( suite->rows[i].text );
    }
    free( suite->rows );
    suite->rows = NULL;
    suite->row_count = 0;
}

wisp_status suite_scene( const suite_row* row, wisp_scene* out, wisp_error* error )
{
    wisp_error inner = { 0 };
    const wisp_status status = wisp_scene_parse( row->text, strlen( row->text ), row->path, out, &inner );
    if ( status != WISP_OK )
    {
        // the line is that of the text with its settings, which nobody sees
        const char* message = inner.message;
        return wisp_fail( error, status, "%s%s%s: %.300s", row->name, row->variant[0] ? ", " : "", row->variant,
                          message );
    }
    return WISP_OK;
}
