// Output: files to write after the last step.
#include "io_file.h"
#include "scene_parts.h"
#include "scene_ranges.h"

#include <stdlib.h>
#include <string.h>

static wisp_status read_strands( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene_output* output = base;
    wisp_status status = scene_read_named( r, node, SCENE_STRANDS, &output->strands );
    if ( !status )
    {
        r->scene->strands[output->strands].request_points = true;
    }
    return status;
}

static wisp_status read_surface( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene_output* output = base;
    wisp_status status = scene_read_named( r, node, SCENE_SURFACE, &output->surface );
    if ( !status )
    {
        r->scene->surfaces[output->surface].request_points = true;
    }
    return status;
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
static wisp_status read_file( scene_reader* r, const scene_node* node, void* base )
{
    static const char* const of_strands[] = { ".hair", ".usda", ".obj", NULL };
    static const char* const of_surfaces[] = { ".obj", ".ply", NULL };
    wisp_scene_output* output = base;
    const bool is_surface = output->surface >= 0;
    wisp_status status = scene_read_text( r, node, &output->file );
    if ( !status && !ends_in( output->file, is_surface ? of_surfaces : of_strands ) )
    {
        return scene_refuse_node( r, node, "got '%s', expected a file that ends in %s",
                                  scene_shorten( output->file ).text,
                                  is_surface ? ".obj or .ply" : ".hair, .usda or .obj" );
    }
    return status;
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
const scene_block SCENE_OUTPUT_BLOCK = { OUTPUT_FIELDS, WISP_COUNT( OUTPUT_FIELDS ) };

static wisp_status read_output( scene_reader* r, const scene_node* node, int index, void* context )
{
    wisp_scene* scene = context;
    wisp_scene_output* output = &scene->outputs[index];
    scene->output_count = index + 1;
    *output = ( wisp_scene_output ){ .strands = -1, .surface = -1, .line = node->line, .column = node->column };
    wisp_status status = scene_read_block( r, node, &SCENE_OUTPUT_BLOCK, output );
    if ( !status && ( output->strands >= 0 ) == ( output->surface >= 0 ) )
    {
        return scene_refuse_node( r, node,
                                  output->strands >= 0
                                      ? "got both 'strands' and 'surface', expected one of them"
                                      : "got neither 'strands' nor 'surface', expected one of them" );
    }
    return status;
}

static int compare_files( const void* a, const void* b )
{
    const wisp_scene_output *const *x = a, *const *y = b;
    int order = strcmp( ( *x )->file, ( *y )->file );
    return order ? order : ( *x > *y ) - ( *x < *y );
}

static wisp_status refuse_equal_files( scene_reader* r )
{
    wisp_scene* scene = r->scene;
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

wisp_status scene_read_outputs( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene* scene = base;
    void* items;
    wisp_status status =
        scene_begin_list( r, node, "a list of files to write", SCENE_MAX_NODES, sizeof *scene->outputs, &items );
    scene->outputs = items;
    status = status ? status : scene_read_items( r, node, read_output, scene );
    if ( status || !items )
    {
        return status;
    }
    return refuse_equal_files( r );
}
