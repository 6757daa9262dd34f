#include "commands.h"

#include "file_kind.h"
#include "gltf.h"
#include "host_source.h"
#include "io_file.h"
#include "record.h"
#include "results_read.h"
#include "scene_keys.h"
#include "world_from_scene.h"

#include "wisp/module/definition.h"

#include <string.h>

typedef struct info_options
{
    const char* argument; // a file, or a block of keys
    bool keys, host;
} info_options;

static const option_row info_rows[] = {
    { "host", 0, NULL, "Print the C of a host that makes the world of a scene", OPTION_FLAG( info_options, host ) },
    { "keys", 'k', NULL, "Print every key of a scene, or those of a BLOCK such as surfaces.cloth",
      OPTION_FLAG( info_options, keys ) },
};

const command_text info_text = {
    .name = "info",
    .operands = "FILE\n--keys [BLOCK]",
    .noun = "file",
    .summary = "describe a file and report what is wrong with it",
    .about = "Describe a file, and report what is wrong with it.",
    .notes = "Known are grooms (.hair), meshes (.obj, .ply, .glb, .gltf), scenes (.yaml, .yml,\n"
             ".json), recordings (.wisp, .pc2) and results (.json).\n"
             "\n"
             "A mesh is checked for open and non-manifold edges, inconsistent winding, inverted\n"
             "components, degenerate triangles and more; each finding names the elements. Such\n"
             "findings are no failure (status 0). A file that cannot be read is (status 2).",
    .examples = "wisp info data/bunny.obj\n"
                "wisp info data/scenes/flag.yaml\n"
                "wisp info --host data/scenes/cloth_on_ball.yaml > host.c",
    .rows = info_rows,
    .row_count = WISP_COUNT( info_rows ),
    .values = OPTION_INPUT( OPTION_TO_INPUT_IF_ANY, info_options, argument,
                            ".yaml .yml .json .wisp .pc2 .obj .ply .glb .gltf .hair" ),
};

static void check_info_options( const options_state* o )
{
    const info_options* given = o->input;
    if ( !given->argument && !given->keys )
    {
        options_fail( o, "expected a file" );
    }
}

// ---- grooms ----

static wisp_status info_groom( const char* path, wisp_error* error )
{
    wisp_groom groom;
    WISP_TRY( wisp_groom_read( path, &groom, error ) );
    // Describe first and reject afterwards: the whole list of findings is more useful than the first one.
    wisp_status status = wisp_groom_info( stdout, &groom, io_input_name( path ) );
    if ( status == WISP_OK )
    {
        wisp_error cause = { 0 };
        status = wisp_groom_check( &groom, &cause );
        if ( status != WISP_OK )
        {
            wisp_fail( error, status, "%s: %s", io_input_name( path ), cause.message );
        }
    }
    else
    {
        wisp_fail( error, status, "%s: cannot be described: %s", path, wisp_status_name( status ) );
    }
    wisp_groom_release( &groom );
    return status;
}

// ---- meshes ----

// All that a file has; one mesh of it, by name, is described as any other.
static wisp_status info_gltf( const char* path, wisp_error* error )
{
    gltf_model model;
    wisp_status status = gltf_read( path, 0, &model, error );
    if ( status == WISP_OK )
    {
        status = gltf_info( stdout, &model, path );
        if ( status != WISP_OK )
        {
            wisp_fail( error, status, "%s: cannot be described: %s", path, wisp_status_name( status ) );
        }
    }
    gltf_release( &model );
    return status;
}

static wisp_status info_mesh( const char* path, wisp_error* error )
{
    if ( gltf_is_path( path ) && strchr( path, '#' ) == NULL )
    {
        return info_gltf( path, error );
    }
    wisp_mesh mesh;
    WISP_TRY( wisp_mesh_read( path, &mesh, error ) );
    wisp_status status = wisp_mesh_info( stdout, &mesh, io_input_name( path ) );
    if ( status != WISP_OK )
    {
        wisp_fail( error, status, "%s: cannot be examined: %s", path, wisp_status_name( status ) );
    }
    wisp_mesh_release( &mesh );
    return status;
}

// ---- recordings ----

static wisp_status info_recording( const char* path, bool is_cache, wisp_error* error )
{
    wisp_recording* recording = NULL;
    wisp_status status =
        is_cache ? wisp_pc2_open( path, &recording, error ) : wisp_recording_open( path, &recording, error );
    if ( status == WISP_OK )
    {
        status = wisp_recording_print( stdout, recording, io_input_name( path ), error );
    }
    wisp_recording_close( recording );
    return status;
}

// ---- scenes ----

// A line above what a list of the scene has; an empty list has none.
static void print_count( const char* what, int count )
{
    if ( count > 0 )
    {
        printf( "%s: %d\n", what, count );
    }
}

static const char* shape_name( wisp_groom_shape shape )
{
    static const char* const NAMES[] = { "straight", "wavy", "curly", "ring" };
    return NAMES[shape];
}

static void print_stages( const wisp_frozen_hair_def* def )
{
    printf( "    frozen hair:%s%s%s\n", def->freeze ? " freeze" : "", def->align ? " align" : "",
            def->clump ? " clump" : "" );
}

// A number that the scene leaves out comes from the mesh.
static void print_layer( const wisp_boundary_def* layer )
{
    char spacing[40] = "half of the mean edge";
    if ( layer->spacing > 0.0f )
    {
        snprintf( spacing, sizeof spacing, "%g m", (double)layer->spacing );
    }
    printf( "    boundary points: %s, spacing %s\n", layer->policy == WISP_SPACING_EVEN ? "even" : "exact", spacing );
}

static void print_contact( const wisp_contact_def* contact, const char* self )
{
    char thickness[48] = "a quarter of the mean edge";
    if ( contact->thickness > 0.0f )
    {
        snprintf( thickness, sizeof thickness, "%g m", (double)contact->thickness );
    }
    printf( "    contact%s: thickness %s, friction %g%s\n", self, thickness, (double)contact->friction,
            contact->enabled ? "" : ", disabled" );
}

static void print_motion( const wisp_scene* scene, const wisp_scene_strands* entry )
{
    static const char* const stretches[] = { "direct", "links" };
    static const char* const bends[] = { "rod", "links", "none" };
    if ( entry->has_dynamics )
    {
        printf( "    dynamics: stretch %s, bend %s%s\n", stretches[entry->dynamics.stretch],
                bends[entry->dynamics.bending], entry->has_grid ? ", grid" : "" );
    }
    if ( entry->has_contact )
    {
        print_contact( &entry->contact, "" );
    }
    if ( entry->on_surface >= 0 )
    {
        printf( "    rooted on %s\n", scene->surfaces[entry->on_surface].name );
    }
    if ( entry->targets >= 0 )
    {
        printf( "    ghosts that follow %s\n", scene->strands[entry->targets].name );
    }
}

static void print_strands( const wisp_scene* scene, const wisp_scene_strands* entry, const wisp_groom* groom )
{
    printf( "  %s (line %d): %d strands, %d vertices, %d dimensions, ", entry->name, entry->line, groom->strand_count,
            groom->vertex_count, groom->dimension );
    if ( entry->is_generated )
    {
        printf( "generated: %s\n", shape_name( entry->generator.shape ) );
    }
    else if ( entry->is_scattered )
    {
        printf( "scattered around %s\n", scene->strands[entry->scatter.around].name );
    }
    else if ( entry->is_curves )
    {
        printf( "curves of %s\n", scene->strands[entry->curves_of].name );
    }
    else
    {
        printf( "read from %s\n", entry->file );
    }
    print_motion( scene, entry );
    if ( entry->has_frozen_hair )
    {
        print_stages( &entry->frozen_hair );
    }
    if ( entry->has_environment )
    {
        printf( "    climate: %g degrees Celsius, wetness %g\n", (double)entry->environment.temperature_celsius,
                (double)entry->environment.wetness );
    }
    if ( entry->has_appearance )
    {
        printf( "    appearance: width %g m at the root, %g m at the tip\n", (double)entry->appearance.root_width,
                (double)entry->appearance.tip_width );
    }
    if ( entry->request_points || entry->request_width || entry->request_colour || entry->request_strain ||
         entry->request_speed || entry->request_motion_stats )
    {
        printf( "    requests:%s%s%s%s%s%s\n", entry->request_points ? " points" : "",
                entry->request_width ? " width" : "", entry->request_colour ? " colour" : "",
                entry->request_strain ? " strain" : "", entry->request_speed ? " speed" : "",
                entry->request_motion_stats ? " motion_stats" : "" );
    }
}

static const char* source_of( const wisp_scene_mesh* mesh )
{
    return mesh->is_generated ? "generated" : mesh->file;
}

static void print_surface( const wisp_scene* scene, const wisp_scene_surface* entry, const wisp_mesh* mesh )
{
    printf( "  %s (line %d): %d vertices, %d triangles, ", entry->name, entry->line, mesh->vertex_count,
            mesh->triangle_count );
    if ( entry->instance_of >= 0 )
    {
        printf( "instance of %s\n", scene->surfaces[entry->instance_of].name );
    }
    else
    {
        printf( "%s\n", source_of( &entry->mesh ) );
    }
    if ( entry->has_cloth || entry->has_balloon )
    {
        printf( "    %s\n", entry->has_cloth ? "cloth" : "balloon" );
    }
    if ( entry->has_membrane )
    {
        printf( "    membrane, shear modulus %g Pa, %g m thick%s\n", (double)entry->membrane.shear_modulus,
                (double)entry->membrane.thickness, entry->membrane.tension_field ? ", tension field" : "" );
    }
    if ( entry->has_implicit )
    {
        printf( "    implicit cloth%s\n", entry->has_quad_links ? ", quad links" : "" );
    }
    if ( entry->has_contact )
    {
        print_contact( &entry->contact, entry->contact.self ? " and self contact" : "" );
    }
    if ( entry->has_tearing )
    {
        printf( "    tears at %g N/m\n", (double)entry->tearing.strength );
    }
    if ( entry->has_boundary )
    {
        print_layer( &entry->boundary );
    }
}

static wisp_status info_surfaces( const wisp_scene* scene, wisp_error* error )
{
    wisp_status status = WISP_OK;
    print_count( "surfaces", scene->surface_count );
    for ( int i = 0; i < scene->surface_count && status == WISP_OK; ++i )
    {
        wisp_mesh mesh;
        status = scene_surface_mesh( scene, i, &mesh, error );
        if ( status == WISP_OK )
        {
            print_surface( scene, &scene->surfaces[i], &mesh );
            wisp_mesh_release( &mesh );
        }
    }
    return status;
}

static void print_colliders( const wisp_scene* scene )
{
    static const char* const kinds[] = {
        [WISP_COLLIDER_PLANE] = "plane",
        [WISP_COLLIDER_SPHERE] = "sphere",
        [WISP_COLLIDER_CAPSULE] = "capsule",
        [WISP_COLLIDER_BOX] = "box",
        [WISP_COLLIDER_MESH] = "mesh, ",
        [WISP_COLLIDER_TAPERED_CAPSULE] = "tapered capsule",
        [WISP_COLLIDER_CONVEX] = "convex hull of ",
        [WISP_COLLIDER_HEIGHT_FIELD] = "height field",
    };
    print_count( "colliders", scene->collider_count );
    for ( int i = 0; i < scene->collider_count; ++i )
    {
        const wisp_scene_collider* entry = &scene->colliders[i];
        printf( "  %s (line %d): %s%s\n", entry->name, entry->line, kinds[entry->def.kind],
                entry->def.kind == WISP_COLLIDER_MESH || entry->def.kind == WISP_COLLIDER_CONVEX
                    ? source_of( &entry->mesh )
                    : "" );
    }
}

static void print_seams( const wisp_scene* scene )
{
    print_count( "seams", scene->seam_count );
    for ( int i = 0; i < scene->seam_count; ++i )
    {
        const wisp_scene_seam* entry = &scene->seams[i];
        printf( "  %s (line %d): %s to %s, ", entry->name, entry->line, scene->surfaces[entry->surfaces[0]].name,
                scene->surfaces[entry->surfaces[1]].name );
        if ( entry->pair_count > 0 )
        {
            printf( "%d pair%s", entry->pair_count, entry->pair_count == 1 ? "" : "s" );
        }
        else
        {
            printf( "boundaries within %g m", (double)entry->def.within );
        }
        if ( entry->def.strength < INFINITY )
        {
            printf( ", strength %g N", (double)entry->def.strength );
        }
        printf( "\n" );
    }
}

static void print_outputs( const wisp_scene* scene )
{
    print_count( "outputs", scene->output_count );
    for ( int i = 0; i < scene->output_count; ++i )
    {
        const wisp_scene_output* output = &scene->outputs[i];
        printf( "  %s of %s\n", output->file,
                output->strands >= 0 ? scene->strands[output->strands].name : scene->surfaces[output->surface].name );
    }
}

// Reads and checks the files of the scene as a whole: existence alone is not enough.
static wisp_status info_strands( const wisp_scene* scene, wisp_error* error )
{
    wisp_status status = WISP_OK;
    print_count( "strands", scene->strands_count );
    for ( int i = 0; i < scene->strands_count && status == WISP_OK; ++i )
    {
        wisp_groom groom;
        status = scene_groom( scene, i, &groom, error );
        if ( status == WISP_OK )
        {
            print_strands( scene, &scene->strands[i], &groom );
            wisp_groom_release( &groom );
        }
    }
    return status;
}

// What the log would say of the world. A scene that cannot be built has no notes: `run` tells what is wrong.
static void print_notes( const wisp_scene* scene )
{
    const scene_world_options options = { .workers = 1, .is_quiet = true };
    scene_world world;
    if ( scene_world_create( scene, &options, &world, NULL ) == WISP_OK )
    {
        for ( int i = 0; i < world.note_count; ++i )
        {
            printf( "note: %s\n", world.notes[i] );
        }
        scene_world_destroy( &world );
    }
}

static wisp_status info_scene( const char* path, wisp_error* error )
{
    wisp_scene scene;
    WISP_TRY( wisp_scene_read( path, &scene, error ) );
    printf( "%s: scene, %.4g s in %d step%s of %.4g ms, %d substep%s and %d iteration%s each\n",
            io_input_name( path ), wisp_scene_step_time( &scene, scene.steps ), scene.steps,
            scene.steps == 1 ? "" : "s", 1e3 * (double)scene.dt, scene.substeps, scene.substeps == 1 ? "" : "s",
            scene.iterations, scene.iterations == 1 ? "" : "s" );
    wisp_status status = info_strands( &scene, error );
    if ( status == WISP_OK )
    {
        status = info_surfaces( &scene, error );
    }
    if ( status == WISP_OK )
    {
        print_colliders( &scene );
        if ( scene.seam_count > 0 )
        {
            print_seams( &scene );
        }
        print_count( "hair events", scene.command_count );
        print_count( "events", scene.event_count );
        print_outputs( &scene );
        print_notes( &scene );
    }
    wisp_scene_release( &scene );
    return status;
}

// ---- any file ----

static wisp_status info_file( const char* path, wisp_error* error )
{
    file_kind kind = FILE_UNKNOWN;
    WISP_TRY( file_kind_find( path, &kind, error ) );
    switch ( kind )
    {
        case FILE_GROOM:
            return info_groom( path, error );
        case FILE_MESH:
            return info_mesh( path, error );
        case FILE_SCENE:
            return info_scene( path, error );
        case FILE_RECORDING:
            return info_recording( path, false, error );
        case FILE_POINT_CACHE:
            return info_recording( path, true, error );
        case FILE_RESULTS:
            return info_results( path, stdout, error );
        case FILE_UNKNOWN:
            break;
    }
    return wisp_fail( error, WISP_BAD_INPUT,
                      "%s: unknown kind of file, expected a groom (.hair), a mesh (.obj, .ply, .glb, .gltf), a "
                      "scene (.yaml, .yml, "
                      ".json), a recording (.wisp, .pc2) or results (.json)",
                      io_input_name( path ) );
}

static wisp_status info_host( const char* path, wisp_error* error )
{
    wisp_scene scene;
    wisp_status status = path != NULL ? wisp_scene_read( path, &scene, error )
                                      : wisp_fail( error, WISP_BAD_INPUT, "--host: expected a scene" );
    if ( status == WISP_OK )
    {
        status = host_source_write( stdout, &scene, error );
        wisp_scene_release( &scene );
    }
    return status;
}

static wisp_status info_keys( const char* block, wisp_error* error )
{
    return wisp_scene_write_keys( stdout, block ) > 0
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "--keys: got '%s', expected a block such as surfaces.cloth",
                            block );
}

int command_info( int argc, char** argv )
{
    info_options given = { 0 };
    options_parse( &info_text, check_info_options, &given, argc, argv );

    wisp_error error = { 0 };
    wisp_status status = given.host   ? info_host( given.argument, &error )
                         : given.keys ? info_keys( given.argument, &error )
                                      : info_file( given.argument, &error );
    return command_end( status, &error );
}
