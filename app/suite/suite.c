// The whole file: its keys, and what the reader of entries shares with it.
#include "suite_reader.h"

#include "io_file.h"
#include "nearest.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

const suite_measure_info suite_measures[SUITE_MEASURE_COUNT] = {
    [SUITE_INSTRUCTIONS] = { "instructions", { 0.005, 0.0 } },
    [SUITE_CYCLES] = { "cycles", { 0.02, 0.0 } },
    [SUITE_BYTES] = { "bytes", { 0.01, 0.0 } },
    [SUITE_ALLOCATIONS] = { "allocations", { 0.0, 0.0 } },
    [SUITE_ERROR] = { "error", { 0.05, 1e-6 } },
    [SUITE_STRETCH] = { "stretch", { 0.05, 1e-4 } },
    [SUITE_ENERGY] = { "energy", { 0.05, 1e-9 } },
    [SUITE_PENETRATION] = { "penetration", { 0.05, 1e-5 } },
    [SUITE_INTERSECTIONS] = { "intersections", { 0.0, 0.0 } },
    [SUITE_SOLVER_ITERATIONS] = { "solver_iterations", { 0.05, 0.0 } },
    [SUITE_RESETS] = { "resets", { 0.0, 0.0 } },
    [SUITE_NOT_CONVERGED] = { "not_converged", { 0.0, 0.0 } },
    [SUITE_HALTED] = { "halted", { 0.0, 0.0 } },
};

wisp_status suite_refuse( const suite_reader* r, const scene_node* node, const char* format, ... )
{
    char message[400];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( message, sizeof message, format, arguments );
    va_end( arguments );
    return scene_refuse( &r->source, node->line, node->column, "", "%s", message );
}

static wisp_status refuse_key( const suite_reader* r, const scene_node* node, const char* const* keys, int count )
{
    const scene_quote quote = scene_shorten( scene_key_of( &r->tree, node ) );
    const char* nearest = nearest_word( quote.text, keys, count );
    char all[240] = "";
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

wisp_status suite_take_keys( const suite_reader* r, const scene_node* block, const char* expected,
                             const char* const* keys, int count, const scene_node** values )
{
    memset( values, 0, (size_t)count * sizeof *values );
    if ( block->kind != SCENE_MAP )
    {
        return suite_refuse( r, block, "expected %s", expected );
    }
    for ( const scene_node* n = scene_first( &r->tree, block ); n; n = scene_next( &r->tree, n ) )
    {
        int k = 0;
        while ( k < count && strcmp( keys[k], scene_key_of( &r->tree, n ) ) != 0 )
        {
            ++k;
        }
        if ( k == count )
        {
            return refuse_key( r, n, keys, count );
        }
        values[k] = n;
    }
    return WISP_OK;
}

// ---- budgets ----

wisp_status suite_read_budgets( const suite_reader* r, const scene_node* map, suite_budget* budgets )
{
    const char* names[SUITE_MEASURE_COUNT];
    for ( int m = 0; m < SUITE_MEASURE_COUNT; ++m )
    {
        names[m] = suite_measures[m].name;
    }
    if ( map->kind != SCENE_MAP )
    {
        return suite_refuse( r, map, "expected budgets, such as { instructions: 0.005 }" );
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
            return suite_refuse( r, n, "got budget '%s' of %s, expected a fraction of the base's value, 0 to 100",
                                 scene_shorten( text ).text, names[m] );
        }
        budgets[m].relative = value;
    }
    return WISP_OK;
}

// ---- the file ----

enum
{
    KEY_VERSION,
    KEY_TITLE,
    KEY_NOTE,
    KEY_SECONDS,
    KEY_SCENES,
    KEY_BUDGETS,
    KEY_REFERENCE,
    KEY_CHECKS,
    KEY_KNOWN,
    KEY_QUICK,
    KEY_LONG,
    KEY_AXES,
    KEY_COUNT,
};

static const char* const keys[KEY_COUNT] = { "wisp_suite", "title",  "note",  "seconds", "scenes", "budgets",
                                             "reference",  "checks", "known", "quick",   "long",   "axes" };

static wisp_status read_texts( suite_reader* r, const scene_node* title, const scene_node* note )
{
    if ( ( title && title->kind != SCENE_SCALAR ) || ( note && note->kind != SCENE_SCALAR ) )
    {
        return suite_refuse( r, title && title->kind != SCENE_SCALAR ? title : note, "expected a text" );
    }
    snprintf( r->out->title, sizeof r->out->title, "%s", title ? scene_text_of( &r->tree, title ) : "" );
    if ( note )
    {
        const char* text = scene_text_of( &r->tree, note );
        r->out->note = text_alloc( strlen( text ) );
        strcpy( r->out->note, text );
    }
    return WISP_OK;
}

static wisp_status read_suite( suite_reader* r )
{
    const scene_node* root = &r->tree.nodes[0];
    const scene_node* values[KEY_COUNT];
    wisp_status status =
        suite_take_keys( r, root, "a suite, which begins with wisp_suite: 1", keys, KEY_COUNT, values );
    if ( status != WISP_OK )
    {
        return status;
    }
    const scene_node *version = values[KEY_VERSION], *scenes = values[KEY_SCENES];
    if ( version == NULL || version->kind != SCENE_SCALAR || strcmp( scene_text_of( &r->tree, version ), "1" ) != 0 )
    {
        return suite_refuse( r, version ? version : root, "expected wisp_suite: 1" );
    }
    if ( scenes == NULL || scenes->kind != SCENE_LIST || scenes->count == 0 )
    {
        return suite_refuse( r, scenes ? scenes : root,
                             "expected scenes, a list of at least one, such as - file: scene.yaml" );
    }
    r->seconds = values[KEY_SECONDS];
    r->axes = values[KEY_AXES];
    status = read_texts( r, values[KEY_TITLE], values[KEY_NOTE] );
    status = status == WISP_OK && values[KEY_CHECKS]
                 ? suite_read_checks( r, values[KEY_CHECKS], &r->checks, &r->limits )
                 : status;
    status = status == WISP_OK && r->axes ? suite_check_axes( r ) : status;
    if ( status == WISP_OK && values[KEY_BUDGETS] )
    {
        status = suite_read_budgets( r, values[KEY_BUDGETS], r->budgets );
    }
    for ( const scene_node* n = scene_first( &r->tree, scenes ); n && status == WISP_OK;
          n = scene_next( &r->tree, n ) )
    {
        status = suite_read_entry( r, n );
    }
    status =
        status == WISP_OK ? suite_mark_rows( r, values[KEY_KNOWN], values[KEY_QUICK], values[KEY_LONG] ) : status;
    for ( int i = 0; i < r->out->row_count; ++i )
    {
        r->out->has_checks = r->out->has_checks || r->out->rows[i].checks != 0;
    }
    return status == WISP_OK && values[KEY_REFERENCE] ? suite_read_reference( r, values[KEY_REFERENCE] ) : status;
}

// Two rows of one name and variant could not be told apart in a base.
static wisp_status check_names( const suite_reader* r )
{
    const wisp_suite* s = r->out;
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

wisp_status suite_parse( const char* text, size_t size, const char* path, wisp_suite* out, wisp_error* error )
{
    *out = ( wisp_suite ){ 0 };
    suite_stem( path, out->name, sizeof out->name );
    suite_reader r = { .source = { .name = path, .text = text, .size = size, .error = error }, .out = out };
    for ( int m = 0; m < SUITE_MEASURE_COUNT; ++m )
    {
        r.budgets[m] = suite_measures[m].budget;
    }
    wisp_status status = scene_tree_build( &r.source, &r.tree );
    status = status == WISP_OK ? read_suite( &r ) : status;
    status = status == WISP_OK ? check_names( &r ) : status;
    scene_tree_release( &r.tree );
    return status;
}

wisp_status suite_read( const char* path, wisp_suite* out, wisp_error* error )
{
    unsigned char* bytes = NULL;
    size_t size = 0;
    *out = ( wisp_suite ){ 0 };
    wisp_status status = io_file_read( path, SUITE_MAX_BYTES, &bytes, &size, error );
    if ( status == WISP_OK )
    {
        // an empty file has no block
        status = suite_parse( bytes ? (const char*)bytes : "", size, path, out, error );
    }
    free( bytes );
    return status;
}

static void release_row( suite_row* row )
{
    free( row->path );
    free( row->text );
}

void suite_release( wisp_suite* suite )
{
    for ( int i = 0; i < suite->row_count; ++i )
    {
        release_row( suite->rows + i );
    }
    release_row( &suite->reference );
    release_row( &suite->check );
    release_row( &suite->coarsest );
    free( suite->rows );
    free( suite->stored );
    free( suite->note );
    *suite = ( wisp_suite ){ 0 };
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
