// Events: changes of surfaces and strands before chosen steps.
#include "scene_parts.h"
#include "scene_ranges.h"

#include "wisp/module/definition.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

static wisp_status read_surface_name( scene_reader* r, const text_node* node, void* at )
{
    return scene_read_named( r, node, SCENE_SURFACE, at );
}

static wisp_status read_strands_name( scene_reader* r, const text_node* node, void* at )
{
    return scene_read_named( r, node, SCENE_STRANDS, at );
}

#define AT( member ) offsetof( scene_event, member )
#define EVENT( member ) offsetof( scene_event, event.member )

static const scene_field EVENT_FIELDS[] = {
    { "step", SCENE_WHOLE, .at = EVENT( step ), .range = RANGE( 0, 999999 ), .given = AT( has_step ),
      .help = "Step before which the event comes, counted from 0.", .initial = "by `time`" },
    { "time", SCENE_NUMBER, .at = AT( time ), .range = TIME, .unit = SECONDS, .given = AT( has_time ),
      .help = "Time instead of `step`; the event comes before the first step that starts then or later.",
      .initial = "by `step`" },
    { "strands", SCENE_CUSTOM, .at = EVENT( strands ), .read = read_strands_name,
      .help = "Strands with `dynamics.drag_coefficient`; they take `wind`; all strands take `detail`.",
      .form = "name of strands", .initial = "none" },
    { "surface", SCENE_CUSTOM, .at = EVENT( surface ), .read = read_surface_name,
      .help = "Surface; exactly one of `strands` and `surface` is given.", .form = "name of a surface",
      .initial = "none" },
    { "gas_ratio", SCENE_NUMBER, .at = EVENT( gas_ratio ), .range = RANGE( 1e-3, 1e6 ),
      .given = EVENT( has_gas_ratio ), .help = "New gas ratio of a balloon.", .initial = "unchanged" },
    { "inflation_rate", SCENE_NUMBER, .at = EVENT( inflation_rate ), .range = RANGE( -1e6, 1e6 ), .unit = FLOWS,
      .given = EVENT( has_inflation_rate ), .help = "New inflation rate of a balloon.", .initial = "unchanged" },
    { "outlet_open", SCENE_SWITCH, .at = EVENT( open ), .given = EVENT( has_open ),
      .help = "Opens or closes the outlet of a balloon.", .initial = "unchanged" },
    { "wind", SCENE_VECTOR, .at = EVENT( wind ), .range = WIND, .unit = SPEEDS, .given = EVENT( has_wind ),
      .help = "New velocity of the air, for cloth with drag or lift and strands with drag.", .initial = "unchanged" },
    { "velocity", SCENE_VECTOR, .at = EVENT( velocity ), .range = VELOCITY, .unit = SPEEDS,
      .given = EVENT( has_velocity ),
      .help = "New velocity of all vertices; [0, 0, 0] where only `angular_velocity` is given.",
      .initial = "unchanged" },
    { "angular_velocity", SCENE_VECTOR, .at = EVENT( angular_velocity ), .range = VELOCITY, .unit = TURNS,
      .given = EVENT( has_angular_velocity ),
      .help =
          "New angular velocity of all vertices about the centre of mass; [0, 0, 0] where only `velocity` is given.",
      .initial = "unchanged" },
    { "gust", SCENE_VECTOR, .at = EVENT( gust ), .range = VELOCITY, .unit = SPEEDS, .given = EVENT( has_gust ),
      .help =
          "Velocity that is added at once to the vertices of all triangles whose normal is against it; pins stay.",
      .initial = "none" },
    { "gust_per_triangle", SCENE_SWITCH, .at = EVENT( gust_per_triangle ), .given = AT( has_gust_per_triangle ),
      .help = "Adds `gust` to a vertex once for each such triangle around it, as published, not once." },
    { "teleport", SCENE_VECTOR, .at = EVENT( teleport ), .range = COORDINATE, .unit = METRES,
      .given = EVENT( has_teleport ),
      .help =
          "Displacement by which the surface moves at once, with its pins and the strands on it. It meets nothing on "
          "the way and keeps its velocity, unless `velocity` is given too.",
      .initial = "none" },
    { "detail", SCENE_CHOICE, .at = EVENT( detail ), .given = EVENT( has_detail ), SCENE_DETAIL_CHOICES,
      .help = "New level of detail, blended as the entry's `detail` says; of strands too.", .initial = "unchanged" },
    { "pin_group", SCENE_TEXT, .at = AT( pin_group ), .form = "name of a group",
      .help = "Group whose pins `release`, `hold`, `attach_pins` or `detach_pins` changes.", .initial = "all pins" },
    { "release", SCENE_SWITCH, .at = EVENT( release ),
      .help = "Releases pins. They keep the velocity that they were moved with." },
    { "hold", SCENE_SWITCH, .at = EVENT( hold ),
      .help = "Holds pins again that were released, or that start free, where they are. Keyframes move them from "
              "there." },
    { "attach_pins", SCENE_CUSTOM, .at = EVENT( attach_to ), .read = read_surface_name,
      .help = "Holds pins and lets them go along with this surface, as the key of a surface does.",
      .form = "name of a surface", .initial = "none" },
    { "detach_pins", SCENE_SWITCH, .at = EVENT( detach ),
      .help = "Detaches pins from the surface that they go along with, and holds them where they are." },
};
#undef AT
const scene_block SCENE_EVENT_BLOCK = SCENE_BLOCK_ALONE( EVENT_FIELDS );

static wisp_status find_step( scene_reader* r, const text_node* node, scene_event* read )
{
    WISP_TRY( scene_expect_one( r, node, "step", read->has_step, "time", read->has_time ) );
    double step = read->has_step ? (double)read->event.step : wisp_scene_step_at( r->scene, read->time );
    if ( !( step < (double)r->scene->steps ) )
    {
        return scene_refuse_node( r, node, "got step %.0f, expected a step below %d, the number of steps", step,
                                  r->scene->steps );
    }
    read->event.step = (int)step;
    return WISP_OK;
}

static bool changes_motion( const wisp_scene_event* e )
{
    return e->has_gas_ratio || e->has_inflation_rate || e->has_open || e->has_velocity || e->has_angular_velocity ||
           e->has_gust || e->has_teleport;
}

static int pin_changes( const wisp_scene_event* e )
{
    return e->release + e->hold + e->detach + ( e->attach_to >= 0 );
}

// The group that an event names; it changes nothing but pins then.
static wisp_status find_group( scene_reader* r, const text_node* node, scene_event* read )
{
    wisp_scene_event* e = &read->event;
    const wisp_scene_surface* s = read->pin_group && e->surface >= 0 ? &r->scene->surfaces[e->surface] : NULL;
    for ( int g = 0; s && g < s->pin_group_count; ++g )
    {
        e->pin_group = strcmp( s->pin_groups[g].name, read->pin_group ) == 0 ? g : e->pin_group;
    }
    if ( read->pin_group && e->pin_group < 0 )
    {
        return scene_refuse_node( r, text_find_path( node, "pin_group" ), "got '%s', which is no group of pins of %s",
                                  scene_shorten( read->pin_group ).text, s ? s->name : "a surface" );
    }
    if ( e->pin_group >= 0 && ( pin_changes( e ) == 0 || e->has_wind || e->has_detail || changes_motion( e ) ) )
    {
        return scene_refuse_node(
            r, node,
            "'pin_group' needs one of 'release', 'hold', 'attach_pins' and 'detach_pins', and no other change" );
    }
    return WISP_OK;
}

static wisp_status check_gust( scene_reader* r, const text_node* node, const scene_event* read )
{
    return read->has_gust_per_triangle && !read->event.has_gust
               ? scene_refuse_node( r, node, "'gust_per_triangle' needs the key 'gust'" )
               : WISP_OK;
}

// ---- checks against the surface or the strands ----

static wisp_status check_gas( scene_reader* r, const text_node* node, const wisp_scene_event* e,
                              const wisp_scene_surface* s )
{
    const char* key = e->has_gas_ratio        ? "gas_ratio"
                      : e->has_inflation_rate ? "inflation_rate"
                      : e->has_open           ? "outlet_open"
                                              : NULL;
    if ( key && !s->has_balloon )
    {
        return scene_refuse_node( r, node, "'%s' needs a balloon, but the surface '%s' has no key 'balloon'", key,
                                  s->name );
    }
    if ( e->has_open && s->balloon.outlet_count == 0 && !s->has_outlet_nearest )
    {
        return scene_refuse_node( r, node, "the balloon '%s' has no outlet to open or close", s->name );
    }
    if ( e->has_gas_ratio && e->gas_ratio < s->balloon.min_gas_ratio )
    {
        return scene_refuse_node( r, node, "got gas_ratio %g, expected at least min_gas_ratio of '%s', %g",
                                  (double)e->gas_ratio, s->name, (double)s->balloon.min_gas_ratio );
    }
    // Keyframes would overwrite it before the next step.
    const double time = wisp_scene_step_time( r->scene, e->step );
    const wisp_scene_gas_ratio_keyframe* last =
        s->gas_ratio_keyframe_count > 0 ? &s->gas_ratio_keyframes[s->gas_ratio_keyframe_count - 1] : NULL;
    if ( e->has_gas_ratio && last && time < (double)last->time )
    {
        return scene_refuse_node( r, node, "the gas ratio of '%s' follows its gas_ratio_keyframes until %g s",
                                  s->name, (double)last->time );
    }
    return WISP_OK;
}

// Keyframes of pins and animations would move what is attached to a surface away from it.
static wisp_status check_pins( scene_reader* r, const text_node* node, const wisp_scene_event* e,
                               const wisp_scene_surface* s )
{
    if ( pin_changes( e ) > 1 )
    {
        return scene_refuse_node(
            r, node,
            "got more than one of 'release', 'hold', 'attach_pins' and 'detach_pins', expected one of them" );
    }
    if ( !wisp_scene_has_pins( s ) && s->pin_group_count == 0 )
    {
        return scene_refuse_node( r, node, "the surface '%s' has no pins%s", s->name,
                                  e->release ? " to release" : "" );
    }
    const char* key = e->hold ? "hold" : "attach_pins";
    if ( s->has_animation && ( e->hold || e->attach_to >= 0 ) )
    {
        return scene_refuse_node( r, node, "'%s' is not possible: the pins of '%s' follow its animation", key,
                                  s->name );
    }
    if ( e->attach_to >= 0 && e->attach_to == e->surface )
    {
        return scene_refuse_node( r, node, "'attach_pins': got '%s', expected another surface", s->name );
    }
    for ( int g = -1; g < s->pin_group_count && e->attach_to >= 0; ++g )
    {
        const wisp_scene_pins* pins = g < 0 ? &s->pins : &s->pin_groups[g];
        if ( ( e->pin_group < 0 || e->pin_group == g ) && pins->path.count > 0 )
        {
            return scene_refuse_node( r, node, "'attach_pins' is not possible: pins of '%s' have pin_keyframes",
                                      s->name );
        }
    }
    return WISP_OK;
}

// Ghosts and curves follow others and have no air of their own.
static wisp_status check_strands( scene_reader* r, const text_node* node, const wisp_scene_event* e )
{
    const wisp_scene_strands* s = &r->scene->strands[e->strands];
    const scene_case cases[] = {
        { changes_motion( e ) || pin_changes( e ) > 0, NULL, "strands take only 'wind' and 'detail'" },
        { !e->has_wind && !e->has_detail, NULL, "got no change, expected 'wind' or 'detail'" },
    };
    WISP_TRY( scene_refuse_cases( r, node, cases, WISP_COUNT( cases ) ) );
    WISP_TRY( e->has_detail ? scene_check_strands_detail( r, text_find_path( node, "detail" ), s, e->detail )
                            : WISP_OK );
    return !e->has_wind || ( s->has_dynamics && s->dynamics.drag_coefficient > 0.0f )
               ? WISP_OK
               : scene_refuse_node(
                     r, node, "'wind' needs drag, but the strands '%s' have no dynamics.drag_coefficient", s->name );
}

static wisp_status check_event( scene_reader* r, const text_node* node, const wisp_scene_event* e )
{
    WISP_TRY( scene_expect_one( r, node, "strands", e->strands >= 0, "surface", e->surface >= 0 ) );
    if ( e->strands >= 0 )
    {
        return check_strands( r, node, e );
    }
    const wisp_scene_surface* s = &r->scene->surfaces[e->surface];
    if ( !( changes_motion( e ) || e->has_wind || e->has_detail || pin_changes( e ) > 0 ) )
    {
        return scene_refuse_node(
            r, node,
            "got no change, expected one of gas_ratio, inflation_rate, outlet_open, wind, "
            "velocity, angular_velocity, gust, teleport, detail, attach_pins, and hold, release and "
            "detach_pins: true" );
    }
    WISP_TRY( e->has_detail ? scene_check_surface_detail( r, text_find_path( node, "detail" ), s, e->detail )
                            : WISP_OK );
    if ( e->has_wind &&
         !( s->has_cloth && ( s->cloth.drag_coefficient > 0.0f || s->cloth.lift_coefficient > 0.0f ) ) )
    {
        return scene_refuse_node( r, node,
                                  "'wind' needs drag or lift, but the surface '%s' has no cloth.drag_coefficient and "
                                  "no cloth.lift_coefficient",
                                  s->name );
    }
    if ( e->has_teleport && s->pins.path.count > 0 )
    {
        return scene_refuse_node(
            r, node, "the pins of '%s' have pin_keyframes: a keyframe with 'jump: true' teleports it", s->name );
    }
    if ( e->has_teleport && ( s->target_path.count + s->frame_path.count > 0 || scene_moves_groups( s ) ) )
    {
        return scene_refuse_node(
            r, node, "'%s' has keyframes of motion_constraints, frame or pin_groups, which do not teleport",
            s->name );
    }
    WISP_TRY( pin_changes( e ) > 0 ? check_pins( r, node, e, s ) : WISP_OK );
    return check_gas( r, node, e, s );
}

// ---- the list ----

static int compare_events( const void* a, const void* b )
{
    const wisp_scene_event *x = a, *y = b;
    int order = ( x->step > y->step ) - ( x->step < y->step );
    order = order ? order : ( x->strands > y->strands ) - ( x->strands < y->strands );
    order = order ? order : ( x->surface > y->surface ) - ( x->surface < y->surface );
    order = order ? order : ( x->pin_group > y->pin_group ) - ( x->pin_group < y->pin_group );
    order = order ? order : ( x->line > y->line ) - ( x->line < y->line );
    return order ? order : ( x->column > y->column ) - ( x->column < y->column );
}

// Of two entries before one step it would depend on their order which one counts, and a list has none for the reader.
static wisp_status refuse_equal_events( scene_reader* r )
{
    const wisp_scene* scene = r->scene;
    for ( int i = 1; i < scene->event_count; ++i )
    {
        const wisp_scene_event *e = &scene->events[i], *before = e - 1;
        if ( e->step == before->step && e->strands == before->strands && e->surface == before->surface &&
             e->pin_group == before->pin_group )
        {
            return scene_refuse( r->source, e->line, e->column, r->path,
                                 "got a second entry of %s '%s' for step %d, the first is in line %d",
                                 e->strands >= 0 ? "strands" : "surface",
                                 e->strands >= 0 ? scene->strands[e->strands].name : scene->surfaces[e->surface].name,
                                 e->step, before->line );
        }
    }
    return WISP_OK;
}

/// What entries have made of the pins of a group.
typedef struct group_state
{
    bool is_free, is_attached;
} group_state;

static const wisp_scene_pins* pins_of( const wisp_scene_surface* s, int group )
{
    return group < 0 ? &s->pins : &s->pin_groups[group];
}

// @param states [1 + groups] of the surface @return whether any pin is another one afterwards
static bool change_pins( const wisp_scene_event* e, const wisp_scene_surface* s, group_state* states )
{
    bool changes = false;
    for ( int g = -1; g < s->pin_group_count; ++g )
    {
        group_state* state = states + g + 1;
        if ( ( e->pin_group >= 0 && e->pin_group != g ) || ( g < 0 && !wisp_scene_has_pins( s ) ) )
        {
            continue;
        }
        changes = changes || e->attach_to >= 0 || e->release || ( e->hold && state->is_free ) ||
                  ( e->detach && state->is_attached );
        state->is_free = e->release || ( state->is_free && !e->hold && e->attach_to < 0 );
        state->is_attached = e->attach_to >= 0 || ( state->is_attached && !e->detach && !e->release );
    }
    return changes;
}

// Of entries that hold what is held, or detach what is not attached, something else was meant.
static wisp_status refuse_idle_pins( scene_reader* r )
{
    const wisp_scene* scene = r->scene;
    group_state** of_surface = scene_take( r->scene, (size_t)scene->surface_count + 1, sizeof *of_surface );
    for ( int s = 0; of_surface && s < scene->surface_count; ++s )
    {
        const wisp_scene_surface* surface = &scene->surfaces[s];
        of_surface[s] = scene_take( r->scene, (size_t)surface->pin_group_count + 1, sizeof **of_surface );
        for ( int g = -1; of_surface[s] && g < surface->pin_group_count; ++g )
        {
            const wisp_scene_pins* pins = pins_of( surface, g );
            of_surface[s][g + 1] = ( group_state ){ pins->starts_free, pins->attached_to >= 0 };
        }
    }
    for ( int i = 0; i < scene->event_count; ++i )
    {
        const wisp_scene_event* e = &scene->events[i];
        const bool is_of_pins = e->surface >= 0 && pin_changes( e ) > 0;
        group_state* states = is_of_pins && of_surface ? of_surface[e->surface] : NULL;
        if ( is_of_pins && !states )
        {
            return scene_no_memory( r );
        }
        if ( is_of_pins && !change_pins( e, &scene->surfaces[e->surface], states ) )
        {
            const char* key = e->release ? "release" : e->hold ? "hold" : "detach_pins";
            const char* state = e->release ? "are free" : e->hold ? "are held" : "are not attached";
            return scene_refuse( r->source, e->line, e->column, r->path,
                                 "'%s' changes nothing: its pins of '%s' %s before step %d", key,
                                 scene->surfaces[e->surface].name, state, e->step );
        }
    }
    return WISP_OK;
}

static wisp_status read_event( scene_reader* r, const text_node* item, int index, void* events )
{
    scene_event read = { .event = { .strands = -1,
                                    .surface = -1,
                                    .pin_group = -1,
                                    .attach_to = -1,
                                    .line = item->line,
                                    .column = item->column } };
    WISP_TRY( scene_read_block( r, item, &SCENE_EVENT_BLOCK, &read ) );
    WISP_TRY( find_step( r, item, &read ) );
    WISP_TRY( find_group( r, item, &read ) );
    WISP_TRY( check_gust( r, item, &read ) );
    ( (wisp_scene_event*)events )[index] = read.event;
    return check_event( r, item, &read.event );
}

static wisp_status sort_events( scene_reader* r, const text_node* node, void* at )
{
    (void)node;
    wisp_scene* scene = at;
    qsort( scene->events, (size_t)scene->event_count, sizeof *scene->events, compare_events );
    WISP_TRY( refuse_equal_events( r ) );
    return refuse_idle_pins( r );
}

const scene_list SCENE_EVENTS_LIST = {
    .what = "a list of entries", .size = sizeof( wisp_scene_event ), .read = read_event, .finish = sort_events
};
