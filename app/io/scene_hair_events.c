// Hair events: points that frozen hair turns towards, and changes of its parameters, before chosen steps.
#include "scene_parts.h"
#include "scene_ranges.h"

#include "wisp/module/definition.h"

#include <stddef.h>
#include <stdlib.h>

static wisp_status read_strands( scene_reader* r, const text_node* node, void* base )
{
    wisp_scene_hair_event* command = base;
    WISP_TRY( scene_read_named( r, node, SCENE_STRANDS, &command->strands ) );
    return r->scene->strands[command->strands].has_frozen_hair
               ? WISP_OK
               : scene_refuse_node( r, node, "got '%s', expected strands with the key 'frozen_hair'",
                                    r->scene->strands[command->strands].name );
}

#define AT( member ) offsetof( wisp_scene_hair_event, member )
static const scene_field COMMAND_FIELDS[] = {
    { "step", SCENE_WHOLE, .required = true, .at = AT( step ), .range = RANGE( 0, 999999 ),
      .help = "Step before which the event comes, counted from 0." },
    { "strands", SCENE_CUSTOM, .required = true, .read = read_strands, .help = "Strands with `frozen_hair`.",
      .form = "name of strands" },
    { "cursor", SCENE_VECTOR, .at = AT( cursor ), .range = COORDINATE, .unit = METRES, .given = AT( has_cursor ),
      .help = "Point that strands turn towards; required unless the strands have `base: stroke`.",
      .initial = "none" },
    { "begin_stroke", SCENE_SWITCH, .at = AT( begin_stroke ),
      .help = "Forgets the alignment of the strands and draws new random numbers; needs `base: stroke`." },
    { "intensity", SCENE_NUMBER, .at = AT( intensity ), .range = UNIT_RANGE, .given = AT( has_intensity ),
      .help = "New intensity, from this event on.", .initial = "unchanged" },
    { "reach", SCENE_NUMBER, .at = AT( reach ), .range = RANGE( 0, 1e7 ), .unit = METRES, .given = AT( has_reach ),
      .help = "New reach, from this event on.", .initial = "unchanged" },
    { "stretch_stiffness", SCENE_NUMBER, .at = AT( stretch_stiffness ), .range = FROZEN_STIFFNESS,
      .given = AT( has_stretch_stiffness ), .help = "New stiffness against stretching, from this event on.",
      .initial = "unchanged" },
    { "bend_stiffness", SCENE_NUMBER, .at = AT( bend_stiffness ), .range = FROZEN_STIFFNESS,
      .given = AT( has_bend_stiffness ), .help = "New stiffness against bending, from this event on.",
      .initial = "unchanged" },
    { "clump_radius", SCENE_NUMBER, .at = AT( clump_radius ), .range = SIZE, .unit = METRES,
      .given = AT( has_clump_radius ), .help = "New radius of the clump stage, from this event on.",
      .initial = "unchanged" },
};
#undef AT
const scene_block SCENE_COMMAND_BLOCK = SCENE_BLOCK_ALONE( COMMAND_FIELDS );

// Places rise with the file, so equals keep their order, which qsort does not promise.
static int compare_commands( const void* a, const void* b )
{
    const wisp_scene_hair_event *x = a, *y = b;
    int order = ( x->step > y->step ) - ( x->step < y->step );
    order = order ? order : ( x->strands > y->strands ) - ( x->strands < y->strands );
    order = order ? order : ( x->line > y->line ) - ( x->line < y->line );
    return order ? order : ( x->column > y->column ) - ( x->column < y->column );
}

// A parameter of a stage that does not run would have no effect.
static wisp_status check_stages( scene_reader* r, const text_node* node, const wisp_scene_hair_event* e )
{
    const wisp_scene_strands* s = &r->scene->strands[e->strands];
    const struct
    {
        const char *key, *stage;
        bool is_given, runs;
    } rows[] = {
        { "cursor", "align", e->has_cursor && s->frozen_hair.base == WISP_FROZEN_BASE_STROKE, s->frozen_hair.align },
        { "intensity", "align", e->has_intensity, s->frozen_hair.align },
        { "reach", "align", e->has_reach, s->frozen_hair.align },
        { "stretch_stiffness", "freeze", e->has_stretch_stiffness, s->frozen_hair.freeze },
        { "bend_stiffness", "freeze", e->has_bend_stiffness, s->frozen_hair.freeze },
        { "clump_radius", "clump", e->has_clump_radius, s->frozen_hair.clump },
    };
    for ( int i = 0; i < WISP_COUNT( rows ); ++i )
    {
        if ( rows[i].is_given && !rows[i].runs )
        {
            return scene_refuse_node( r, node, "'%s' needs a stage that the strands '%s' lack, frozen_hair.%s",
                                      rows[i].key, s->name, rows[i].stage );
        }
    }
    if ( s->has_environment && ( e->has_stretch_stiffness || e->has_bend_stiffness ) )
    {
        return scene_refuse_node( r, node, "the stiffness of the strands '%s' comes from their environment",
                                  s->name );
    }
    return WISP_OK;
}

static wisp_status check_command( scene_reader* r, const text_node* node, const wisp_scene_hair_event* e )
{
    const wisp_scene_strands* s = &r->scene->strands[e->strands];
    const bool is_stroke = s->frozen_hair.base == WISP_FROZEN_BASE_STROKE;
    if ( e->step >= r->scene->steps )
    {
        return scene_refuse_node( r, node, "got step %d, expected a step below %d, the number of steps", e->step,
                                  r->scene->steps );
    }
    if ( !e->has_cursor && !is_stroke )
    {
        return scene_refuse_node( r, node, "key 'cursor' is missing" );
    }
    if ( e->begin_stroke && !is_stroke )
    {
        return scene_refuse_node( r, node, "'begin_stroke' needs strands with 'base: stroke', '%s' have none",
                                  s->name );
    }
    if ( !e->has_cursor && !e->begin_stroke && !e->changes )
    {
        return scene_refuse_node( r, node,
                                  "got no change, expected one of cursor, begin_stroke: true, intensity, reach, "
                                  "stretch_stiffness, bend_stiffness and clump_radius" );
    }
    return check_stages( r, node, e );
}

static wisp_status read_command( scene_reader* r, const text_node* node, int index, void* commands )
{
    wisp_scene_hair_event* command = (wisp_scene_hair_event*)commands + index;
    command->line = node->line;
    command->column = node->column;
    WISP_TRY( scene_read_block( r, node, &SCENE_COMMAND_BLOCK, command ) );
    command->changes = command->has_intensity || command->has_reach || command->has_stretch_stiffness ||
                       command->has_bend_stiffness || command->has_clump_radius;
    return check_command( r, node, command );
}

// What an event leaves unchanged is what the last one before it gave.
static void carry_values( wisp_scene_hair_event* e, const wisp_scene_hair_event* before )
{
#define CARRY( value )                                                                                               \
    if ( !e->has_##value && before->has_##value )                                                                    \
    {                                                                                                                \
        e->has_##value = true;                                                                                       \
        e->value = before->value;                                                                                    \
    }
    CARRY( intensity )
    CARRY( reach )
    CARRY( stretch_stiffness )
    CARRY( bend_stiffness )
    CARRY( clump_radius )
#undef CARRY
}

static wisp_status carry_all( scene_reader* r )
{
    wisp_scene* scene = r->scene;
    const wisp_scene_hair_event** last =
        scene_take( scene, (size_t)scene->strands_count, sizeof *last ); // of each strands, in the order of steps
    for ( int i = 0; i < scene->command_count && last; ++i )
    {
        wisp_scene_hair_event* e = &scene->commands[i];
        if ( last[e->strands] )
        {
            carry_values( e, last[e->strands] );
        }
        last[e->strands] = e;
    }
    return last ? WISP_OK : scene_no_memory( r );
}

// Sort by step, as the program reads them. Of two entries for one step the first would have no effect.
static wisp_status sort_commands( scene_reader* r, const text_node* node, void* at )
{
    (void)node;
    wisp_scene* scene = at;
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
    return carry_all( r );
}

const scene_list SCENE_COMMANDS_LIST = { .what = "a list of hair events",
                                         .size = sizeof( wisp_scene_hair_event ),
                                         .read = read_command,
                                         .finish = sort_commands };
