#include "io_file.h"
#include "scene_parts.h"
#include "scene_ranges.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- detail ----

// Levels of detail: their names, and which an entry can have.

const scene_choice SCENE_DETAIL_LEVELS[] = {
    { "full", "everything" },
    { "fewer_substeps", "everything, in fewer and longer substeps" },
    { "coarse", "coarse sheets alone; of ghosts, a rigid motion with the roots of what they follow" },
    { "nothing", "a rigid motion with the pins or the frame, of strands with the roots" },
    { 0 },
};

wisp_status scene_check_surface_detail( scene_reader* r, const text_node* node, const wisp_scene_surface* s,
                                        wisp_detail level )
{
    const bool is_known = s->instance_of < 0; // else the engine finds out
    return level != WISP_DETAIL_COARSE || !is_known || ( s->has_cloth && s->cloth.coarse_substeps != 0 )
               ? WISP_OK
               : scene_refuse_node( r, node,
                                    "'coarse' needs coarse sheets, but the surface '%s' has no cloth.coarse_substeps",
                                    s->name );
}

wisp_status scene_check_strands_detail( scene_reader* r, const text_node* node, const wisp_scene_strands* s,
                                        wisp_detail level )
{
    if ( !s->has_dynamics && !s->has_ghosts )
    {
        return scene_refuse_node( r, node, "'detail' needs the key 'dynamics' or 'ghosts'" );
    }
    return level != WISP_DETAIL_COARSE || s->has_ghosts
               ? WISP_OK
               : scene_refuse_node( r, node, "'coarse' needs ghosts, but the strands '%s' have no key 'ghosts'",
                                    s->name );
}

// ---- steps ----

// Lengths of steps: all `dt`, or `dt` times factors that repeat.

static const scene_field DT_FACTOR_FIELD = { "factor", SCENE_NUMBER, .range = DT_FACTOR };
static const scene_list DT_FACTORS = { .what = "a list of numbers",
                                       .size = sizeof( float ),
                                       .most = WISP_SCENE_MAX_DT_FACTORS,
                                       .each = &DT_FACTOR_FIELD,
                                       .empty = "got an empty list, expected numbers" };

float wisp_scene_step_length( const wisp_scene* scene, int step )
{
    return scene->dt_factor_count > 0 ? scene->dt * scene->dt_factors[step % scene->dt_factor_count] : scene->dt;
}

// Return the sum of the lengths of the first steps of a round.
static double sum_of( const wisp_scene* scene, int steps )
{
    double sum = 0.0;
    for ( int i = 0; i < steps; ++i )
    {
        sum += (double)wisp_scene_step_length( scene, i );
    }
    return sum;
}

double wisp_scene_step_time( const wisp_scene* scene, int step )
{
    const int count = scene->dt_factor_count;
    if ( count == 0 )
    {
        return (double)step * (double)scene->dt;
    }
    return ( step / count ) * sum_of( scene, count ) + sum_of( scene, step % count );
}

// A time is written in decimals, and a step may be 1/60 s: what is within a thousandth of a step is meant to be the same.
double wisp_scene_step_at( const wisp_scene* scene, float time )
{
    const int count = scene->dt_factor_count;
    if ( count == 0 )
    {
        return fmax( 0.0, ceil( (double)time / (double)scene->dt - 1e-3 ) );
    }
    const double target = (double)time - 1e-3 * (double)scene->dt, round = sum_of( scene, count );
    const double rounds = fmax( 0.0, floor( target / round ) );
    int step = 0;
    while ( step < count && rounds * round + sum_of( scene, step ) < target )
    {
        ++step;
    }
    return rounds * count + step;
}

void wisp_scene_refine( wisp_scene* scene, int factor )
{
    scene->substeps *= factor;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        scene->surfaces[i].substeps *= factor;
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        scene->strands[i].substeps *= factor;
    }
}

int wisp_scene_own_substeps( const wisp_scene* scene )
{
    int most = 0;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        most = scene->surfaces[i].substeps > most ? scene->surfaces[i].substeps : most;
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        most = scene->strands[i].substeps > most ? scene->strands[i].substeps : most;
    }
    return most;
}

// ---- output ----

// Output: files to write after the last step.

static wisp_status read_strands( scene_reader* r, const text_node* node, void* base )
{
    wisp_scene_output* output = base;
    WISP_TRY( scene_read_named( r, node, SCENE_STRANDS, &output->strands ) );
    r->scene->strands[output->strands].request_points = true;
    return WISP_OK;
}

static wisp_status read_surface( scene_reader* r, const text_node* node, void* base )
{
    wisp_scene_output* output = base;
    WISP_TRY( scene_read_named( r, node, SCENE_SURFACE, &output->surface ) );
    r->scene->surfaces[output->surface].request_points = true;
    return WISP_OK;
}

static bool ends_in( const char* file, const char* const* extensions )
{
    const char* last = io_file_name( file );
    const char* dot = strrchr( last, '.' );
    for ( int i = 0; dot && dot > last && extensions[i]; ++i )
    {
        if ( strcmp( dot, extensions[i] ) == 0 )
        {
            return true;
        }
    }
    return false;
}

// `strands` and `surface` stand before `file` in the table, because they decide which formats are possible.
static wisp_status read_file( scene_reader* r, const text_node* node, void* base )
{
    static const char* const of_strands[] = { ".hair", ".usda", ".obj", NULL };
    static const char* const of_surfaces[] = { ".obj", ".ply", NULL };
    wisp_scene_output* output = base;
    const bool is_surface = output->surface >= 0;
    WISP_TRY( scene_read_text( r, node, &output->file ) );
    return ends_in( output->file, is_surface ? of_surfaces : of_strands )
               ? WISP_OK
               : scene_refuse_node( r, node, "got '%s', expected a file that ends in %s",
                                    scene_shorten( output->file ).text,
                                    is_surface ? ".obj or .ply" : ".hair, .usda or .obj" );
}

static const scene_field OUTPUT_FIELDS[] = {
    { "strands", SCENE_CUSTOM, .read = read_strands, .help = "Strands to write.", .form = "name of strands",
      .initial = "none" },
    { "surface", SCENE_CUSTOM, .read = read_surface, .help = "Surface to write; exactly one of the two is given.",
      .form = "name of a surface", .initial = "none" },
    { "file", SCENE_CUSTOM, .required = true, .read = read_file,
      .help = "File to write, relative to the working directory; strands as `.hair`, `.usda` or `.obj`, a surface as "
              "`.obj` or `.ply`.",
      .form = "path" },
};
const scene_block SCENE_OUTPUT_BLOCK = SCENE_BLOCK_ALONE( OUTPUT_FIELDS );

static wisp_status read_output( scene_reader* r, const text_node* node, int index, void* outputs )
{
    wisp_scene_output* output = (wisp_scene_output*)outputs + index;
    *output = ( wisp_scene_output ){ .strands = -1, .surface = -1, .line = node->line, .column = node->column };
    WISP_TRY( scene_read_block( r, node, &SCENE_OUTPUT_BLOCK, output ) );
    return scene_expect_one( r, node, "strands", output->strands >= 0, "surface", output->surface >= 0 );
}

static int compare_files( const void* a, const void* b )
{
    const wisp_scene_output *const *x = a, *const *y = b;
    int order = strcmp( ( *x )->file, ( *y )->file );
    return order ? order : ( *x > *y ) - ( *x < *y );
}

static wisp_status refuse_equal_files( scene_reader* r, const text_node* node, void* base )
{
    (void)node;
    wisp_scene* scene = base;
    size_t count = (size_t)scene->output_count;
    const wisp_scene_output** sorted = scene_take( scene, count, sizeof *sorted );
    if ( !sorted )
    {
        return scene_no_memory( r );
    }
    for ( size_t i = 0; i < count; ++i )
    {
        sorted[i] = &scene->outputs[i];
    }
    qsort( sorted, count, sizeof *sorted, compare_files );
    for ( size_t i = 1; i < count; ++i )
    {
        if ( strcmp( sorted[i]->file, sorted[i - 1]->file ) == 0 )
        {
            return scene_refuse( r->source, sorted[i]->line, sorted[i]->column, r->path,
                                 "the file '%s' is written in line %d already", scene_shorten( sorted[i]->file ).text,
                                 sorted[i - 1]->line );
        }
    }
    return WISP_OK;
}

static const scene_list OUTPUTS = { .what = "a list of files to write",
                                    .size = sizeof( wisp_scene_output ),
                                    .read = read_output,
                                    .finish = refuse_equal_files };

// ---- scene ----

#define _POSIX_C_SOURCE 200809L // strndup

#include "scene.h"
#include "gltf.h"

#include <stddef.h>

static wisp_status read_version( scene_reader* r, const text_node* node, void* base )
{
    (void)base;
    static const scene_field version = { "wisp", SCENE_WHOLE, .range = { 0, 1e9 } };
    int value = 0;
    WISP_TRY( scene_read_whole( r, node, &version, &value ) );
    return value == WISP_SCENE_VERSION
               ? WISP_OK
               : scene_refuse_node( r, node, "got version %d, expected version %d", value, WISP_SCENE_VERSION );
}

// Hair events, events and output name the entries of the lists above them, and what they do must come before the last step.
// Surfaces and strands that move take the scene's gravity unless they have their own.
#define AT( member ) offsetof( wisp_scene, member )
static const scene_field SCENE_FIELDS[] = {
    { "wisp", SCENE_CUSTOM, .required = true, .read = read_version, .help = "Version of the format.", .form = "1" },
    { "dt", SCENE_NUMBER, .at = AT( dt ), .range = RANGE( 1e-9, 1e6 ), .unit = SECONDS,
      .help = "Length of a step; the default is 1/60." },
    { "dt_factors", SCENE_ENTRIES, .at = AT( dt_factors ), .of = &DT_FACTORS,
      .help = "Factors of `dt` for the steps in turn, over and over, as on a machine that does not keep its pace.",
      .form = "list of 1 to 64 numbers, 0.001 .. 1000", .initial = "none" },
    { "steps", SCENE_WHOLE, .at = AT( steps ), .range = RANGE( 0, 1000000 ), .help = "Number of steps to run." },
    { "frames_per_step", SCENE_WHOLE, .at = AT( frames_per_step ), .range = RANGE( 1, 1000 ),
      .help =
          "Frames that `wisp run` records per step. Between steps ghosts move on cubic curves with the velocities of "
          "their targets, all other points on straight lines, also across a teleport." },
    { "substeps", SCENE_WHOLE, .at = AT( substeps ), .range = RANGE( 1, 10000 ), .help = "Substeps of each step." },
    { "iterations", SCENE_WHOLE, .at = AT( iterations ), .range = RANGE( 1, 10000 ),
      .help = "Iterations of each substep." },
    { "workers", SCENE_WHOLE, .at = AT( workers ), .range = RANGE( 0, WISP_MAX_WORKERS ),
      .help = "Number of threads; 0 takes one per core." },
    { "gravity", SCENE_VECTOR, .at = AT( gravity ), .range = ACCELERATION, .unit = ACCELERATIONS,
      .help = "Gravity of surfaces and moving strands that have none of their own." },
    { "contact", SCENE_CUSTOM, .read = scene_read_contact, .help = "How contact between all participants is found.",
      .form = "block" },
    { "strands", SCENE_ENTRIES, .at = AT( strands ), .of = &SCENE_STRANDS_LIST, .bind = scene_bind_strands,
      .help = "Strands of hair.", .form = "list of blocks", .initial = "none" },
    { "surfaces", SCENE_ENTRIES, .at = AT( surfaces ), .of = &SCENE_SURFACES_LIST, .bind = scene_bind_to_surfaces,
      .help = "Cloths, balloons and other triangle meshes that move, with 16777216 vertices in all.",
      .form = "list of blocks", .initial = "none" },
    { "colliders", SCENE_ENTRIES, .at = AT( colliders ), .of = &SCENE_COLLIDERS_LIST,
      .help = "Bodies that only move as they are told.", .form = "list of blocks", .initial = "none" },
    { "seams", SCENE_ENTRIES, .at = AT( seams ), .of = &SCENE_SEAMS_LIST, .help = "Surfaces that are sewn together.",
      .form = "list of blocks", .initial = "none" },
    { "hair_events", SCENE_ENTRIES, .at = AT( commands ), .of = &SCENE_COMMANDS_LIST,
      .help = "Points that frozen hair turns towards, before chosen steps.", .form = "list of blocks",
      .initial = "none" },
    { "events", SCENE_ENTRIES, .at = AT( events ), .of = &SCENE_EVENTS_LIST,
      .help = "Changes of surfaces and strands, before chosen steps.", .form = "list of blocks", .initial = "none" },
    { "output", SCENE_ENTRIES, .at = AT( outputs ), .of = &OUTPUTS, .help = "Files to write after the last step.",
      .form = "list of blocks", .initial = "none" },
};
#undef AT
const scene_block SCENE_BLOCK_OF_ALL = SCENE_BLOCK_ALONE( SCENE_FIELDS );

// Check the version first: a newer scene has keys that would only be called unknown.
static wisp_status check_version( scene_reader* r, const text_node* root )
{
    const text_node* version = text_find_path( root, "wisp" );
    const size_t outside = scene_enter_key( r, "wisp" );
    WISP_TRY( version ? read_version( r, version, NULL ) : WISP_OK );
    scene_leave( r, outside );
    return WISP_OK;
}

// Without the key `compute` a scene would simulate nothing, since passes without a request do not exist.
static void request_by_default( wisp_scene* scene )
{
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        wisp_scene_strands* strands = scene->strands + i;
        strands->request_points |= strands->has_compute == false && strands->is_shown;
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        scene->surfaces[i].request_points |= scene->surfaces[i].has_compute == false;
    }
}

static int count_bodies( const text_node* root )
{
    const text_node *colliders = text_find_path( root, "colliders" ), *surfaces = text_find_path( root, "surfaces" );
    int count = colliders != NULL ? colliders->count : 0;
    for ( const text_node* s = surfaces != NULL ? text_first( surfaces ) : NULL; s != NULL; s = s->next )
    {
        count += text_find_path( s, "collider" ) != NULL;
    }
    return count;
}

static wisp_status read_root( const scene_source* source, const text_node* root, wisp_scene* scene )
{
    scene_reader r = { .source = source, .scene = scene };
    scene->name = scene_print( scene, "%s", source->name );
    if ( !scene->name )
    {
        return scene_no_memory( &r );
    }
    if ( root->kind != TEXT_MAP )
    {
        return scene_refuse_kind( &r, root, "a mapping with the key 'wisp'" );
    }
    r.body_count = count_bodies( root );
    WISP_TRY( check_version( &r, root ) );
    WISP_TRY( scene_read_block( &r, root, &SCENE_BLOCK_OF_ALL, scene ) );
    request_by_default( scene );
    scene_find_origin( scene );
    return scene_make_copies( &r );
}

wisp_scene scene_defaults( void )
{
    return ( wisp_scene ){
        .dt = 1.0f / 60.0f,
        .steps = 1,
        .substeps = 10,
        .frames_per_step = 1,
        .iterations = 1,
        .gravity = wisp_default_surface_def().gravity,
        .contact = wisp_default_contact_settings(),
    };
}

wisp_status wisp_scene_parse( const char* text, size_t size, const char* name, wisp_scene* out, wisp_error* error )
{
    WISP_ASSERT( name != NULL );
    *out = ( wisp_scene ){ 0 };
    const scene_source source = { name, text, size, error };
    wisp_scene scene = scene_defaults();

    io_numbers numbers;
    WISP_TRY( io_numbers_begin( &numbers, error ) );
    text_node* root = NULL;
    wisp_status status = scene_read_tree( &source, &root );
    if ( !status )
    {
        status = read_root( &source, root, &scene );
    }
    text_release( root );
    io_numbers_end( &numbers );

    if ( status )
    {
        wisp_scene_release( &scene );
        return status;
    }
    *out = scene;
    return WISP_OK;
}

wisp_status wisp_scene_read( const char* path, wisp_scene* out, wisp_error* error )
{
    *out = ( wisp_scene ){ 0 };
    unsigned char* bytes = NULL;
    size_t size = 0;
    WISP_TRY( io_file_read( path, SCENE_MAX_BYTES, &bytes, &size, error ) );
    const wisp_status status =
        wisp_scene_parse( bytes ? (const char*)bytes : "", size, io_input_name( path ), out, error );
    free( bytes );
    return status;
}

// ---- arrays in place of files ----

static bool take_arrays( const wisp_scene* scene, const char* file, const wisp_scene_arrays* arrays,
                         const wisp_scene_arrays** out )
{
    const size_t folder = io_folder_length( scene->name );
    const bool is_it =
        file && strncmp( file, scene->name, folder ) == 0 && strcmp( file + folder, arrays->file ) == 0;
    *out = is_it ? arrays : *out;
    return is_it;
}

static int give_arrays( wisp_scene* scene, const wisp_scene_arrays* arrays )
{
    int found = 0;
    for ( int i = 0; i < scene->strands_count && arrays->triangles == NULL; ++i )
    {
        wisp_scene_strands* s = &scene->strands[i];
        found += take_arrays( scene, s->file, arrays, &s->arrays );
    }
    for ( int i = 0; i < scene->surface_count && arrays->triangles != NULL; ++i )
    {
        wisp_scene_mesh* mesh = &scene->surfaces[i].mesh;
        wisp_scene_start* start = &scene->surfaces[i].start;
        found += take_arrays( scene, mesh->file, arrays, &mesh->arrays );
        found += take_arrays( scene, start->file, arrays, &start->arrays );
    }
    for ( int i = 0; i < scene->collider_count && arrays->triangles != NULL; ++i )
    {
        wisp_scene_mesh* mesh = &scene->colliders[i].mesh;
        found += take_arrays( scene, mesh->file, arrays, &mesh->arrays );
    }
    return found;
}

wisp_status wisp_scene_set_arrays( wisp_scene* scene, const wisp_scene_arrays* arrays, int count, wisp_error* error )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( give_arrays( scene, &arrays[i] ) == 0 )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: got %s for '%s', but no entry has that file", scene->name,
                              arrays[i].triangles ? "a mesh" : "strands", arrays[i].file );
        }
    }
    return WISP_OK;
}

// ---- files ----

typedef struct file_walk
{
    wisp_status ( *each )( void* user, const char* file, wisp_error* error );
    void* user;
    wisp_error* error;
} file_walk;

static wisp_status visit( const file_walk* walk, const char* file )
{
    if ( file == NULL )
    {
        return WISP_OK;
    }
    const char* hash = gltf_is_path( file ) ? strrchr( file, '#' ) : NULL;
    char* plain = strndup( file, hash != NULL ? (size_t)( hash - file ) : strlen( file ) );
    const wisp_status status = plain != NULL ? walk->each( walk->user, plain, walk->error )
                                             : wisp_fail( walk->error, WISP_NO_MEMORY, "out of memory for a path" );
    free( plain );
    return status;
}

static wisp_status visit_surface( const file_walk* walk, const wisp_scene_surface* surface )
{
    wisp_status status = visit( walk, surface->mesh.file );
    status = status ? status : visit( walk, surface->start.file );
    status = status ? status : visit( walk, surface->animation.file );
    for ( int i = 0; i < surface->map_count && !status; ++i )
    {
        status = visit( walk, surface->maps[i].file );
    }
    return status;
}

wisp_status wisp_scene_files( const wisp_scene* scene,
                              wisp_status ( *each )( void* user, const char* file, wisp_error* error ), void* user,
                              wisp_error* error )
{
    const file_walk walk = { each, user, error };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < scene->strands_count && !status; ++i )
    {
        status = visit( &walk, scene->strands[i].file );
    }
    for ( int i = 0; i < scene->surface_count && !status; ++i )
    {
        status = visit_surface( &walk, &scene->surfaces[i] );
    }
    for ( int i = 0; i < scene->collider_count && !status; ++i )
    {
        status = visit( &walk, scene->colliders[i].mesh.file );
    }
    return status;
}
