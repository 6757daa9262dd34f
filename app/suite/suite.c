// The whole file: its keys, and what the reader of entries shares with it.
#include "suite_reader.h"

#include "io_file.h"
#include "nearest.h"
#include "suite.h"
#include "suite_measure.h"
#include "text_tree.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

const suite_measure_info suite_measures[SUITE_BUDGET_COUNT] = {
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
    [SUITE_HASH] = { "hash", { 1.0, 0.0 } },
};

wisp_status suite_refuse( const suite_reader* r, const text_node* node, const char* format, ... )
{
    char message[400];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( message, sizeof message, format, arguments );
    va_end( arguments );
    return scene_refuse( &r->source, node->line, node->column, "", "%s", message );
}

static wisp_status refuse_key( const suite_reader* r, const text_node* node, const char* const* suite_keys,
                               int count )
{
    const scene_quote quote = scene_shorten( node->key );
    const char* nearest = nearest_word( quote.text, suite_keys, count );
    char all[240] = "";
    for ( int i = 0; i < count; ++i )
    {
        strncat( all, i > 0 ? ", " : "", sizeof all - strlen( all ) - 1 );
        strncat( all, suite_keys[i], sizeof all - strlen( all ) - 1 );
    }
    return nearest ? scene_refuse( &r->source, node->key_line, node->key_column, "",
                                   "got key '%s'; did you mean '%s'?", quote.text, nearest )
                   : scene_refuse( &r->source, node->key_line, node->key_column, "",
                                   "got key '%s', expected one of %s", quote.text, all );
}

wisp_status suite_take_keys( const suite_reader* r, const text_node* block, const char* expected,
                             const char* const* suite_keys, int count, const text_node** values )
{
    memset( values, 0, (size_t)count * sizeof *values );
    if ( block->kind != TEXT_MAP )
    {
        return suite_refuse( r, block, "expected %s", expected );
    }
    for ( const text_node* n = text_first( block ); n; n = n->next )
    {
        int k = 0;
        while ( k < count && strcmp( suite_keys[k], n->key ) != 0 )
        {
            ++k;
        }
        if ( k == count )
        {
            return refuse_key( r, n, suite_keys, count );
        }
        values[k] = n;
    }
    return WISP_OK;
}

// ---- budgets ----

wisp_status suite_read_budgets( const suite_reader* r, const text_node* map, suite_budget* budgets )
{
    const char* names[SUITE_BUDGET_COUNT];
    for ( int m = 0; m < SUITE_BUDGET_COUNT; ++m )
    {
        names[m] = suite_measures[m].name;
    }
    if ( map->kind != TEXT_MAP )
    {
        return suite_refuse( r, map, "expected budgets, such as { instructions: 0.005 }" );
    }
    for ( const text_node* n = text_first( map ); n; n = n->next )
    {
        int m = 0;
        while ( m < SUITE_BUDGET_COUNT && strcmp( names[m], n->key ) != 0 )
        {
            ++m;
        }
        if ( m == SUITE_BUDGET_COUNT )
        {
            return refuse_key( r, n, names, SUITE_BUDGET_COUNT );
        }
        char* end = NULL;
        const char* text = text_value( n );
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

// ---- the block `reference` ----

// The block `reference` of a suite: what it says, and the runs that it asks for.

enum
{
    REFERENCE_START,
    REFERENCE_OVERLAP,
    REFERENCE_STORED,
    REFERENCE_DOUBT,
    REFERENCE_FILE,
    REFERENCE_EXTRAPOLATE,
    REFERENCE_SET,
    REFERENCE_CHECK,
    REFERENCE_COUNT,
};

static const char* const reference_keys[REFERENCE_COUNT] = { "start", "overlap",     "stored", "doubt",
                                                             "file",  "extrapolate", "set",    "check" };

static void release_row( suite_row* row )
{
    free( row->path );
    free( row->text );
}

static void release_runs( suite_runs* runs )
{
    release_row( &runs->fine );
    release_row( &runs->check );
    release_row( &runs->coarsest );
    *runs = ( suite_runs ){ 0 };
}

// A half and a quarter of the substeps of the reference.
static wisp_status read_halves( const suite_reader* r, suite_run run, const text_node* place, suite_runs* out )
{
    wisp_scene scene;
    wisp_status status = suite_scene( &out->fine, &scene, r->source.error );
    const int substeps = scene.substeps;
    wisp_scene_release( &scene );
    if ( status == WISP_OK && substeps % 4 != 0 )
    {
        return suite_refuse( r, place, "got a reference of %d substeps, expected a multiple of 4 to extrapolate from",
                             substeps );
    }
    run.substeps = substeps / 2;
    status = status == WISP_OK ? suite_read_run( r, &run, "reference, half", &out->check ) : status;
    run.substeps = substeps / 4;
    return status == WISP_OK ? suite_read_run( r, &run, "reference, quarter", &out->coarsest ) : status;
}

// A reference is finer than what is measured with it, also where entities have substeps of their own.
static wisp_status check_own_substeps( const suite_reader* r, const suite_row* run, const text_node* place )
{
    wisp_scene scene;
    wisp_status status = suite_scene( run, &scene, r->source.error );
    const int own = wisp_scene_own_substeps( &scene ), substeps = scene.substeps;
    wisp_scene_release( &scene );
    return status == WISP_OK && own > 0 && 4 * (int64_t)own > substeps
               ? suite_refuse( r, place,
                               "got a reference of %d substeps and an entity with %d of its own, expected at least "
                               "four times as many",
                               substeps, own )
               : status;
}

static wisp_status read_runs_of( const suite_reader* r, const text_node* block, const text_node* const* values,
                                 const suite_row* of, suite_runs* out )
{
    suite_run run = { .file = values[REFERENCE_FILE], .set = values[REFERENCE_SET], .of = of };
    WISP_TRY( out->fine.text ? WISP_OK : suite_read_run( r, &run, "reference", &out->fine ) );
    WISP_TRY( check_own_substeps( r, &out->fine, values[REFERENCE_SET] ? values[REFERENCE_SET] : block ) );
    if ( values[REFERENCE_EXTRAPOLATE] )
    {
        return read_halves( r, run, values[REFERENCE_EXTRAPOLATE], out );
    }
    run.coarser = values[REFERENCE_CHECK];
    WISP_TRY( suite_read_run( r, &run, "reference, check", &out->check ) );
    return strcmp( out->check.text, out->fine.text ) == 0
               ? suite_refuse( r, run.coarser, "expected a coarser run; the reference would be certain of itself" )
               : WISP_OK;
}

static int find_runs( const wisp_suite* suite, const suite_row* fine )
{
    int i = 0;
    while ( i < suite->reference_count && ( suite->references[i].fine.steps != fine->steps ||
                                            strcmp( suite->references[i].fine.text, fine->text ) != 0 ) )
    {
        ++i;
    }
    return i;
}

// The runs of the suite's file, and those of every row whose scene is another text with the fields of the reference. Whether it is another
// scene, only its world can tell; where the fields are not of such a scene, as of another solver, the row has the first runs.
static wisp_status read_runs( const suite_reader* r, const text_node* block, const text_node* const* values )
{
    wisp_suite* suite = r->out;
    suite->references = text_alloc( ( (size_t)suite->row_count + 1 ) * sizeof *suite->references );
    suite->reference_count = 1;
    wisp_status status = read_runs_of( r, block, values, NULL, suite->references );
    for ( int i = 0; i < suite->row_count && values[REFERENCE_FILE] == NULL && status == WISP_OK; ++i )
    {
        suite_row* row = suite->rows + i;
        suite_runs* next = suite->references + suite->reference_count;
        const suite_run run = { .set = values[REFERENCE_SET], .of = row };
        wisp_error inner = { 0 };
        suite_reader quiet = *r;
        quiet.source.error = &inner;
        if ( row->is_refused || suite_read_run( &quiet, &run, "reference", &next->fine ) != WISP_OK )
        {
            release_runs( next );
            continue;
        }
        row->reference = find_runs( suite, &next->fine );
        if ( row->reference == suite->reference_count )
        {
            status = read_runs_of( r, block, values, row, next );
            ++suite->reference_count;
        }
        else
        {
            release_runs( next );
        }
    }
    return status;
}

// Read `reference`, after the entries.
static wisp_status read_reference( suite_reader* r, const text_node* block )
{
    const text_node* values[REFERENCE_COUNT];
    const wisp_status status =
        suite_take_keys( r, block, "a reference, such as { set: { substeps: 320 }, check: { substeps: 160 } }",
                         reference_keys, REFERENCE_COUNT, values );
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int i = 0; i < REFERENCE_COUNT; ++i )
    {
        const bool is_text = i <= REFERENCE_EXTRAPOLATE;
        if ( values[i] && values[i]->kind != ( is_text ? TEXT_SCALAR : TEXT_MAP ) )
        {
            return suite_refuse( r, values[i], "expected %s",
                                 is_text ? "a text or a number"
                                         : "fields and their values, such as { substeps: 320 }" );
        }
    }
    for ( int k = REFERENCE_START; k <= REFERENCE_OVERLAP; ++k )
    {
        const char* word = k == REFERENCE_START ? "true" : "none";
        *( k == REFERENCE_START ? &r->out->compares_start : &r->out->compares_overlap ) = values[k] != NULL;
        if ( values[k] )
        {
            return strcmp( text_value( values[k] ), word ) == 0 && block->count == 1
                       ? WISP_OK
                       : suite_refuse( r, block, "expected %s: %s alone", reference_keys[k], word );
        }
    }
    const text_node* order = values[REFERENCE_EXTRAPOLATE];
    r->out->extrapolate = order ? suite_number_of( order ) : 0.0;
    if ( order && r->out->extrapolate != 1.0 && r->out->extrapolate != 2.0 )
    {
        return suite_refuse( r, order, "got extrapolate '%s', expected the order at which the runs converge, 1 or 2",
                             scene_shorten( text_value( order ) ).text );
    }
    if ( order && ( values[REFERENCE_STORED] || values[REFERENCE_CHECK] ) )
    {
        return suite_refuse( r, order, "got extrapolate with %s, expected one of them",
                             values[REFERENCE_STORED] ? "stored" : "check" );
    }
    if ( values[REFERENCE_STORED] )
    {
        r->out->stored = suite_resolve( r, text_value( values[REFERENCE_STORED] ) );
        r->out->stored_doubt = values[REFERENCE_DOUBT] ? suite_number_of( values[REFERENCE_DOUBT] ) : 0.0;
        return r->out->stored_doubt >= 0.0 ? WISP_OK
                                           : suite_refuse( r, values[REFERENCE_DOUBT], "expected a distance in m" );
    }
    if ( values[REFERENCE_SET] == NULL || ( values[REFERENCE_CHECK] == NULL && order == NULL ) )
    {
        return suite_refuse( r, block,
                             "expected set, the fields of the converged run, and check, those that make a coarser "
                             "one, or extrapolate, the order at which runs converge" );
    }
    return read_runs( r, block, values );
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

static const char* const suite_keys[KEY_COUNT] = { "wisp_suite", "title",  "note",  "seconds", "scenes", "budgets",
                                                   "reference",  "checks", "known", "quick",   "long",   "axes" };

static wisp_status read_texts( suite_reader* r, const text_node* title, const text_node* note )
{
    if ( ( title && title->kind != TEXT_SCALAR ) || ( note && note->kind != TEXT_SCALAR ) )
    {
        return suite_refuse( r, title && title->kind != TEXT_SCALAR ? title : note, "expected a text" );
    }
    snprintf( r->out->title, sizeof r->out->title, "%s", title ? text_value( title ) : "" );
    if ( note )
    {
        const char* text = text_value( note );
        r->out->note = text_alloc( strlen( text ) );
        strcpy( r->out->note, text );
    }
    return WISP_OK;
}

static wisp_status read_suite( suite_reader* r )
{
    const text_node* root = r->tree;
    const text_node* values[KEY_COUNT];
    WISP_TRY( suite_take_keys( r, root, "a suite, which begins with wisp_suite: 1", suite_keys, KEY_COUNT, values ) );
    const text_node *version = values[KEY_VERSION], *scenes = values[KEY_SCENES];
    if ( version == NULL || version->kind != TEXT_SCALAR || strcmp( text_value( version ), "1" ) != 0 )
    {
        return suite_refuse( r, version ? version : root, "expected wisp_suite: 1" );
    }
    if ( scenes == NULL || scenes->kind != TEXT_LIST || scenes->count == 0 )
    {
        return suite_refuse( r, scenes ? scenes : root,
                             "expected scenes, a list of at least one, such as - file: scene.yaml" );
    }
    r->seconds = values[KEY_SECONDS];
    r->axes = values[KEY_AXES];
    WISP_TRY( read_texts( r, values[KEY_TITLE], values[KEY_NOTE] ) );
    WISP_TRY( values[KEY_CHECKS] ? suite_read_checks( r, values[KEY_CHECKS], &r->checks, &r->limits ) : WISP_OK );
    WISP_TRY( r->axes ? suite_check_axes( r ) : WISP_OK );
    WISP_TRY( values[KEY_BUDGETS] ? suite_read_budgets( r, values[KEY_BUDGETS], r->budgets ) : WISP_OK );
    for ( const text_node* n = text_first( scenes ); n; n = n->next )
    {
        WISP_TRY( suite_read_entry( r, n ) );
    }
    WISP_TRY( suite_mark_rows( r, values[KEY_KNOWN], values[KEY_QUICK], values[KEY_LONG] ) );
    for ( int i = 0; i < r->out->row_count; ++i )
    {
        r->out->has_checks = r->out->has_checks || r->out->rows[i].checks != 0;
    }
    return values[KEY_REFERENCE] ? read_reference( r, values[KEY_REFERENCE] ) : WISP_OK;
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

wisp_status suite_parse( const char* text, size_t size, const char* path, const suite_given* given, wisp_suite* out,
                         wisp_error* error )
{
    *out = ( wisp_suite ){ 0 };
    suite_stem( path, out->name, sizeof out->name );
    suite_reader r = { .source = { .name = path, .text = text, .size = size, .error = error },
                       .out = out,
                       .given = given };
    for ( int m = 0; m < SUITE_BUDGET_COUNT; ++m )
    {
        r.budgets[m] = suite_measures[m].budget;
    }
    wisp_status status = scene_read_tree( &r.source, &r.tree );
    status = status == WISP_OK ? read_suite( &r ) : status;
    status = status == WISP_OK ? check_names( &r ) : status;
    text_release( r.tree );
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
        status = suite_parse( bytes ? (const char*)bytes : "", size, path, NULL, out, error );
    }
    free( bytes );
    return status;
}

void suite_release( wisp_suite* suite )
{
    for ( int i = 0; i < suite->row_count; ++i )
    {
        release_row( suite->rows + i );
    }
    for ( int i = 0; i < suite->reference_count; ++i )
    {
        release_runs( suite->references + i );
    }
    free( suite->references );
    free( suite->rows );
    free( suite->stored );
    free( suite->note );
    *suite = ( wisp_suite ){ 0 };
}

wisp_status suite_scene( const suite_row* row, wisp_scene* out, wisp_error* error )
{
    wisp_error inner = { 0 };
    wisp_status status = wisp_scene_parse( row->text, strlen( row->text ), row->path, out, &inner );
    if ( status == WISP_OK && row->given )
    {
        status = wisp_scene_set_arrays( out, row->given->arrays, row->given->array_count, &inner );
    }
    if ( status != WISP_OK )
    {
        wisp_scene_release( out );
        // the line is that of the text with its settings, which nobody sees
        const char* message = inner.message;
        return wisp_fail( error, status, "%s%s%s: %.300s", row->name, row->variant[0] ? ", " : "", row->variant,
                          message );
    }
    out->steps = row->steps > 0 && row->steps < out->steps ? row->steps : out->steps;
    return WISP_OK;
}

// ---- the suite of a scene ----

enum
{
    BYTES_MAX = 1 << 20,
    SUBSTEPS_MAX = 160, // of the reference
};

static const double LENGTH_MAX = 1.0; // s: later most motions are chaotic, and distances say nothing

typedef struct writer
{
    const suite_of_scene_def* def;
    text_node* scene;
    wisp_scene read;
    double length;                 // s
    int substeps, iterations;      // of the scene
    int finest, finest_iterations; // of the reference
    bool has_links, has_linear;    // solved by iterations of links, by linear solves
    FILE* out;
} writer;

// ---- the reference ----

static void look_at_solvers( writer* w )
{
    for ( int i = 0; i < w->read.surface_count; ++i )
    {
        w->has_linear = w->has_linear || w->read.surfaces[i].has_implicit;
        w->has_links = w->has_links || !w->read.surfaces[i].has_implicit;
    }
    for ( int i = 0; i < w->read.strands_count; ++i )
    {
        w->has_links = w->has_links || w->read.strands[i].has_dynamics;
    }
}

// Estimate what a second of motion costs, s. A clock would give a scene another reference the next time.
static wisp_status estimate_pace( const writer* w, double* out, wisp_error* error )
{
    static const double LINK_NS = 20.0, SOLVE_NS = 2000.0, CONTACT_NS = 500.0; // of a vertex in a substep
    const scene_world_options options = { .workers = 1, .log = w->def->log, .log_user = w->def->log_user };
    scene_world world;
    WISP_TRY( scene_world_create( &w->read, &options, &world, error ) );
    const double ns = ( w->has_links ? LINK_NS * w->iterations : 0.0 ) + ( w->has_linear ? SOLVE_NS : 0.0 ) +
                      ( scene_has_contact( &w->read ) ? CONTACT_NS : 0.0 );
    *out = 1e-9 * ns * scene_world_vertices( &world ) * w->substeps / (double)w->read.dt;
    scene_world_destroy( &world );
    return WISP_OK;
}

// As fine as takes less than a minute or so. The coarser run that tells its doubt takes half of it again.
static wisp_status choose_reference( writer* w, wisp_error* error )
{
    const double budget = 40.0; // s
    double pace = 0.0;
    const wisp_status status = estimate_pace( w, &pace, error );
    w->finest_iterations = w->has_links ? 10 * w->iterations : w->iterations;
    const int own = wisp_scene_own_substeps( &w->read ); // a reference has four times as many
    w->finest = 4 * own > SUBSTEPS_MAX ? 4 * own : SUBSTEPS_MAX;
    while ( w->finest > 4 * w->substeps && w->finest / 2 >= 4 * own &&
            pace * w->length * w->finest / w->substeps * w->finest_iterations / w->iterations > budget )
    {
        w->finest /= 2;
    }
    return status;
}

// ---- entries ----

// @param most substeps
static void write_series( const writer* w, const char* name, const char* settings, int most )
{
    static const int SUBSTEPS[] = { 1, 2, 5, 10, 20, 40 };
    char values[64] = "";
    const int limit = most < w->finest / 4 ? most : w->finest / 4;
    for ( size_t i = 0; i < sizeof SUBSTEPS / sizeof SUBSTEPS[0] && SUBSTEPS[i] <= limit; ++i )
    {
        const size_t used = strlen( values );
        snprintf( values + used, sizeof values - used, "%s%d", i > 0 ? ", " : "", SUBSTEPS[i] );
    }
    fprintf( w->out, "  - file: \"%s\"\n    name: \"%s\"\n", w->def->file, name );
    if ( settings[0] != '\0' )
    {
        fprintf( w->out, "    set: { %s }\n", settings );
    }
    fprintf( w->out, "    along: { substeps: [%s] }\n", values );
}

// Another way to solve the same scene: fields of every body of a list that has a block.
typedef struct method
{
    const char *name, *list, *block;
    bool needs_pins, needs_xpbd;
    int most_substeps;        // with more there are better ways; 0: as many as the others
    const char* fields[3][2]; // within the body, and their values
} method;

static const method methods[] = {
    { .name = "links alone",
      .list = "surfaces",
      .block = "cloth",
      .fields = { { "cloth.tethers", "false" }, { "cloth.coarse_substeps", "0" } } },
    { .name = "tethers",
      .list = "surfaces",
      .block = "cloth",
      .needs_pins = true,
      .fields = { { "cloth.tethers", "true" }, { "cloth.coarse_substeps", "0" } } },
    { .name = "coarse sheets",
      .list = "surfaces",
      .block = "cloth",
      .needs_xpbd = true,
      .most_substeps = 5,
      .fields = { { "cloth.tethers", "false" }, { "cloth.coarse_substeps", "2" } } },
    { .name = "euler", .list = "surfaces", .block = "implicit", .fields = { { "implicit.integrator", "euler" } } },
    { .name = "bdf2", .list = "surfaces", .block = "implicit", .fields = { { "implicit.integrator", "bdf2" } } },
    { .name = "bdf2, 4 solves",
      .list = "surfaces",
      .block = "implicit",
      .fields = { { "implicit.integrator", "bdf2" }, { "implicit.newton_iterations", "4" } } },
    { .name = "strands: direct",
      .list = "strands",
      .block = "dynamics",
      .fields = { { "dynamics.stretch", "direct" }, { "dynamics.integrator", "euler" } } },
    { .name = "strands: direct, bdf2",
      .list = "strands",
      .block = "dynamics",
      .fields = { { "dynamics.stretch", "direct" }, { "dynamics.integrator", "bdf2" } } },
    { .name = "strands: links",
      .list = "strands",
      .block = "dynamics",
      .fields = { { "dynamics.stretch", "links" }, { "dynamics.integrator", "euler" } } },
};

// Defaults of fields that a scene need not name.
static const char* const defaults[][2] = {
    { "cloth.tethers", "false" },          { "cloth.coarse_substeps", "0" }, { "implicit.integrator", "euler" },
    { "implicit.newton_iterations", "1" }, { "dynamics.stretch", "direct" }, { "dynamics.integrator", "euler" },
};

static bool is_same( const text_node* body, const char* field, const char* value )
{
    char block[32];
    const char* dot = strchr( field, '.' );
    snprintf( block, sizeof block, "%.*s", dot ? (int)( dot - field ) : 0, field );
    const char* own = text_at( dot ? text_find( body, block ) : body, dot ? dot + 1 : field );
    for ( size_t i = 0; own[0] == '\0' && i < sizeof defaults / sizeof defaults[0]; ++i )
    {
        own = strcmp( defaults[i][0], field ) == 0 ? defaults[i][1] : own;
    }
    return strcmp( own, value ) == 0;
}

static bool may_have( const text_node* body, const method* m )
{
    const text_node* block = text_find( body, m->block );
    const bool is_pinned =
        text_find( body, "pins" ) || text_find( body, "pin_box" ) || text_find( body, "pin_nearest" );
    return block && ( is_pinned || !m->needs_pins ) &&
           !( m->needs_xpbd &&
              ( strcmp( text_at( block, "solver" ), "pbd" ) == 0 || text_find( body, "membrane" ) != NULL ) );
}

// Write the fields that a method changes of all bodies. @return whether the scene is not already solved this way
static bool name_changes( const writer* w, const method* m, char* out, size_t size )
{
    const text_node* bodies = text_find( w->scene, m->list );
    bool changes = false;
    out[0] = '\0';
    for ( int i = 0; bodies && i < bodies->count; ++i )
    {
        const text_node* body = bodies->children[i];
        for ( int k = 0; k < 3 && m->fields[k][0] && may_have( body, m ); ++k )
        {
            const size_t used = strlen( out );
            changes = changes || !is_same( body, m->fields[k][0], m->fields[k][1] );
            snprintf( out + used, size - used, "%s\"%s[%d].%s\": %s", used > 0 ? ", " : "", m->list, i,
                      m->fields[k][0], m->fields[k][1] );
        }
    }
    return changes;
}

enum
{
    SETTINGS_MAX = 4096,
};

static void write_entries( const writer* w )
{
    char name[64], settings[SETTINGS_MAX];
    write_series( w, "as written", "", SUBSTEPS_MAX );
    if ( w->has_links )
    {
        snprintf( name, sizeof name, "%d iterations", 4 * w->iterations );
        snprintf( settings, sizeof settings, "iterations: %d", 4 * w->iterations );
        write_series( w, name, settings, SUBSTEPS_MAX );
    }
    for ( size_t i = 0; i < sizeof methods / sizeof methods[0]; ++i )
    {
        if ( name_changes( w, methods + i, settings, sizeof settings ) )
        {
            const int most = methods[i].most_substeps;
            write_series( w, methods[i].name, settings, most > 0 ? most : SUBSTEPS_MAX );
        }
    }
}

static void write_suite( const writer* w )
{
    fprintf( w->out, "# What accuracy costs in %s\nwisp_suite: 1\nseconds: %.9g\n", io_short_name( w->def->file ),
             w->length );
    // tethers and coarse sheets are short cuts that the converged motion has no need of
    char settings[SETTINGS_MAX];
    const bool has_short_cuts = name_changes( w, &methods[0], settings, sizeof settings );
    fprintf( w->out, "reference: { set: { substeps: %d, iterations: %d%s%s }, check: { substeps: %d } }\nscenes:\n",
             w->finest, w->finest_iterations, has_short_cuts ? ", " : "", has_short_cuts ? settings : "",
             w->finest / 2 );
    write_entries( w );
}

// ---- the scene ----

static wisp_status read_scene_twice( writer* w, wisp_error* error )
{
    const suite_given* given = w->def->given;
    unsigned char* bytes = NULL;
    size_t size = given ? given->size : 0;
    wisp_status status = given ? WISP_OK : io_file_read( w->def->path, BYTES_MAX, &bytes, &size, error );
    const char* text = given ? given->text : bytes ? (const char*)bytes : "";
    status = status == WISP_OK ? wisp_scene_parse( text, size, w->def->path, &w->read, error ) : status;
    status = status == WISP_OK && given ? wisp_scene_set_arrays( &w->read, given->arrays, given->array_count, error )
                                        : status;
    status = status == WISP_OK ? text_parse( text, size, w->def->path, &w->scene, error ) : status;
    free( bytes );
    if ( status != WISP_OK )
    {
        return status;
    }
    look_at_solvers( w );
    w->substeps = w->read.substeps;
    w->iterations = w->read.iterations;
    const double all = (double)w->read.dt * w->read.steps;
    w->length = w->def->length > 0.0 ? w->def->length : all > 0.0 ? fmin( all, LENGTH_MAX ) : LENGTH_MAX;
    return w->has_links || w->has_linear
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT,
                            "%s: nothing in the scene is solved over time, so its accuracy costs nothing",
                            w->def->path );
}

wisp_status suite_of_scene( const suite_of_scene_def* def, char** out, wisp_error* error )
{
    writer w = { .def = def };
    size_t size = 0;
    *out = NULL;
    wisp_status status = read_scene_twice( &w, error );
    status = status == WISP_OK ? choose_reference( &w, error ) : status;
    if ( status == WISP_OK )
    {
        w.out = open_memstream( out, &size );
        status = w.out ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for a suite" );
    }
    if ( status == WISP_OK )
    {
        write_suite( &w );
        fclose( w.out );
    }
    text_release( w.scene );
    wisp_scene_release( &w.read );
    return status;
}
