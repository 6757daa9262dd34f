// Hair events: points that frozen hair turns towards, before chosen steps.
#include "scene_parts.h"
#include "scene_ranges.h"

#include <stddef.h>
#include <stdlib.h>

static wisp_status read_strands( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene_hair_event* command = base;
    wisp_status status = scene_read_named( r, node, SCENE_STRANDS, &command->strands );
    if ( !status && !r->scene->strands[command->strands].has_frozen_hair )
    {
        return scene_refuse_node( r, node, "got '%s', expected strands with the key 'frozen_hair'",
                                  r->scene->strands[command->strands].name );
    }
    return status;
}

#define AT( member ) offsetof( wisp_scene_hair_event, member )
static const scene_field COMMAND_FIELDS[] = {
    { "step", SCENE_WHOLE, .required = true, .at = AT( step ), .range = RANGE( 0, 999999 ),
      .help = "Step before which the event comes, counted from 0." },
    { "strands", SCENE_CUSTOM, .required = true, .read = read_strands, .help = "Strands with `frozen_hair`.",
      .form = "name of strands" },
    { "cursor", SCENE_VECTOR, .required = true, .at = AT( cursor ), .range = COORDINATE, .unit = METRES,
      .help = "Point that strands turn towards." },
};
#undef AT
const scene_block SCENE_COMMAND_BLOCK = { COMMAND_FIELDS, WISP_COUNT( COMMAND_FIELDS ) };

// Places rise with the file, so equals keep their order, which qsort does not promise.
static int compare_commands( const void* a, const void* b )
{
    const wisp_scene_hair_event *x = a, *y = b;
    int order = ( x->step > y->step ) - ( x->step < y->step );
    order = order ? order : ( x->strands > y->strands ) - ( x->strands < y->strands );
    order = order ? order : ( x->line > y->line ) - ( x->line < y->line );
    return order ? order : ( x->column > y->column ) - ( x->column < y->column );
}

static wisp_status read_command( scene_reader* r, const scene_node* node, wisp_scene_hair_event* command )
{
    command->line = node->line;
    command->column = node->column;
    wisp_status status = scene_read_block( r, node, &SCENE_COMMAND_BLOCK, command );
    if ( !status && command->step >= r->scene->steps )
    {
        return scene_refuse_node( r, node, "got step %d, expected a step below %d, the number of steps",
                                  command->step, r->scene->steps );
    }
    return status;
}

wisp_status scene_read_commands( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene* scene = base;
    wisp_status status = scene_expect_list( r, node, "a list of hair events" );
    if ( status || node->count == 0 )
    {
        return status;
    }
    scene->commands = scene_take( scene, (size_t)node->count, sizeof *scene->commands );
    if ( !scene->commands )
    {
        return scene_no_memory( r );
    }
    for ( const scene_node* item = scene_first( r->tree, node ); item; item = scene_next( r->tree, item ) )
    {
        size_t outside = scene_enter_index( r, scene->command_count );
        status = read_command( r, item, &scene->commands[scene->command_count++] );
        if ( status )
        {
            return status;
        }
        scene_leave( r, outside );
    }

    // Sort by step, as the program reads them. Of two entries for one step the first would have no effect.
    qsort( scene->commands, (size_t)scene->command_count, sizeof *scene->commands, compare_commands );
    for ( int i = 1; i < scene->command_count; ++i )
    {
        const wisp_scene_hair_event *c = &scene->commands[i], *before = c - 1;
        if ( c->step == before->step && c->strands == before->strands )
        {
            return scene_refuse( r->source, c->line, c->column, r->path,
                                 "got a second entry of strands '%s' for step %d, the first is in line %d",
                                 scene->strands[c->strands].name, c->step, before->line );
        }
    }
    return WISP_OK;
}
