#include "suite_of_scene.h"

#include "io_file.h"
#include "suite_measure.h"
#include "text_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

// Time the first steps of the scene as it is written. @return s per second of motion
static wisp_status time_scene( const writer* w, double* out, wisp_error* error )
{
    const int STEPS = 5;
    const scene_world_options options = { .is_quiet = true };
    scene_world world;
    wisp_status status = scene_world_create( &w->read, &options, &world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    double begin = wisp_clock_seconds();
    for ( int i = 0; i <= STEPS && i < w->read.steps && status == WISP_OK; ++i )
    {
        begin = i == 1 ? wisp_clock_seconds() : begin; // the first step makes the plan
        status = scene_world_step( &world, error );
    }
    *out = ( wisp_clock_seconds() - begin ) / ( STEPS * (double)w->read.dt );
    scene_world_destroy( &world );
    return status;
}

// As fine as there is time for. The coarser run that tells its doubt takes half of it again.
static wisp_status choose_reference( writer* w, wisp_error* error )
{
    double pace = 0.0;
    const wisp_status status = time_scene( w, &pace, error );
    const double budget = w->def->seconds / 1.5;
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

static wisp_status read_scene( writer* w, wisp_error* error )
{
    unsigned char* bytes = NULL;
    size_t size = 0;
    wisp_status status = io_file_read( w->def->path, BYTES_MAX, &bytes, &size, error );
    const char* text = bytes ? (const char*)bytes : "";
    status = status == WISP_OK ? wisp_scene_parse( text, size, w->def->path, &w->read, error ) : status;
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
    w->length = w->def->length > 0.0 ? w->def->length : fmin( all, LENGTH_MAX );
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
    wisp_status status = read_scene( &w, error );
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
