// Strands: what no table can say about an entry, and the entries that it names.
#include "scene_detail.h"
#include "scene_parts.h"

#include <string.h>

// ---- an entry ----

static wisp_status check_source( scene_reader* r, const scene_node* node, const wisp_scene_strands* s )
{
    int sources = ( s->file != NULL ) + s->is_generated + s->is_scattered + s->is_curves;
    if ( sources == 0 )
    {
        return scene_refuse_node( r, node,
                                  "got none of 'file', 'generate', 'scatter' and 'curves', expected one of them" );
    }
    if ( sources > 1 )
    {
        return scene_refuse_node(
            r, node, "got more than one of 'file', 'generate', 'scatter' and 'curves', expected one of them" );
    }
    return WISP_OK;
}

// Curves are drawn and nothing else: where they are is up to the strands that they run through.
static wisp_status check_curves( scene_reader* r, const scene_node* node )
{
    static const char* const keys[] = { "transform", "dynamics",    "head",        "on_surface", "grid",
                                        "ghosts",    "frozen_hair", "environment", "collision",  "contact" };
    for ( int i = 0; i < WISP_COUNT( keys ); ++i )
    {
        const scene_node* child = scene_child( r, node, keys[i] );
        if ( child )
        {
            return scene_refuse_node( r, child, "'%s' is not possible with 'curves'", keys[i] );
        }
    }
    return WISP_OK;
}

static wisp_status check_dynamics( scene_reader* r, const scene_node* node, const wisp_scene_strands* s )
{
    if ( s->has_ghosts )
    {
        return scene_refuse_node( r, node, "got both 'dynamics' and 'ghosts', expected one of them" );
    }
    if ( s->has_frozen_hair )
    {
        return scene_refuse_node(
            r, node, "got both 'dynamics' and 'frozen_hair', expected one of them; ghosts can have 'frozen_hair'" );
    }
    if ( s->mass_count > 0 && s->dynamics.vertex_mass > 0.0f )
    {
        return scene_refuse_node( r, node,
                                  "got both dynamics.vertex_mass and dynamics.vertex_masses, expected one of them" );
    }
    if ( s->has_head && scene_child( r, node, "on_surface" ) )
    {
        return scene_refuse_node( r, node, "got both 'head' and 'on_surface', expected one of them" );
    }
    for ( int i = 0; i < s->frame_path.count; ++i )
    {
        if ( s->frame_path.poses[i].jump )
        {
            return scene_refuse_node( r, scene_child( r, node, "frame" ),
                                      "'jump' in keyframe %d: only keyframes of pins, colliders and heads can jump",
                                      i );
        }
    }
    if ( s->has_tips && ( s->tips_hold & WISP_STRAND_TIP_GUIDED ) != 0 &&
         s->dynamics.bending != WISP_STRAND_BEND_ROD )
    {
        return scene_refuse_node( r, scene_child( r, node, "tips" ),
                                  "got tips whose direction is held, expected them with dynamics.bending: rod" );
    }
    return WISP_OK;
}

// What only strands that move can take; ghosts are at least kept out of bodies.
static wisp_status check_still( scene_reader* r, const scene_node* node, const wisp_scene_strands* s )
{
    static const char* const keys[] = { "head", "tips",      "frame",   "max_speed", "on_surface",
                                        "grid", "collision", "contact", "sleep",     "start" };
    for ( int i = 0; i < WISP_COUNT( keys ); ++i )
    {
        const scene_node* child = scene_child( r, node, keys[i] );
        const bool is_free = ( s->has_ghosts || !s->has_collision ) && strcmp( keys[i], "collision" ) == 0;
        if ( child && !is_free )
        {
            return scene_refuse_node( r, child, "'%s' needs the key 'dynamics'", keys[i] );
        }
    }
    return WISP_OK;
}

wisp_status scene_check_strands( scene_reader* r, const scene_node* node, const wisp_scene_strands* s )
{
    wisp_status status = check_source( r, node, s );
    if ( !status && s->is_curves )
    {
        return check_curves( r, node );
    }
    const scene_node* transform = s->is_scattered ? scene_child( r, node, "transform" ) : NULL;
    if ( !status && transform )
    {
        return scene_refuse_node( r, transform, "'transform' is not possible with 'scatter'" );
    }
    if ( !status && s->has_ghosts && !s->is_scattered &&
         !scene_child( r, scene_child( r, node, "ghosts" ), "targets" ) )
    {
        return scene_refuse_node( r, node, "got neither ghosts.targets nor 'scatter', expected one of them" );
    }
    const scene_node* detail = scene_child( r, node, "detail" );
    if ( !status && detail )
    {
        const scene_node* level = scene_child( r, detail, "level" );
        status = scene_check_strands_detail( r, level ? level : detail, s, s->detail.level );
    }
    if ( !status && s->has_frozen_hair && s->frozen_hair.base == WISP_FROZEN_BASE_STROKE && s->has_cursor )
    {
        return scene_refuse_node(
            r, scene_child( r, node, "frozen_hair" ),
            "'align.cursor' is not possible with 'base: stroke', where only hair events turn strands" );
    }
    return status ? status : s->has_dynamics ? check_dynamics( r, node, s ) : check_still( r, node, s );
}

// ---- entries that are named ----

// A value of an entry, or null; the path leads to it then.
static const scene_node* enter( scene_reader* r, const scene_node* entry, const char* block, const char* key )
{
    const scene_node* outer = block ? scene_child( r, entry, block ) : entry;
    const scene_node* node = outer ? scene_child( r, outer, key ) : NULL;
    if ( node && block )
    {
        scene_enter_key( r, block );
    }
    if ( node )
    {
        scene_enter_key( r, key );
    }
    return node;
}

// A source comes before what is scattered around it, so there is no circle, and it is read or made itself.
static wisp_status bind_scatter( scene_reader* r, const scene_node* entry, int i )
{
    wisp_scene_strands* s = &r->scene->strands[i];
    const scene_node* node = enter( r, entry, "scatter", "around" );
    wisp_status status = node ? scene_read_named( r, node, SCENE_STRANDS, &s->scatter.around ) : WISP_OK;
    if ( status || !node )
    {
        return status;
    }
    const wisp_scene_strands* source = &r->scene->strands[s->scatter.around];
    if ( s->scatter.around >= i )
    {
        return scene_refuse_node( r, node, "got '%s', expected an entry above this one", source->name );
    }
    if ( source->is_scattered || source->is_curves )
    {
        return scene_refuse_node( r, node, "got '%s', expected strands with 'file' or 'generate'", source->name );
    }
    int64_t made = source->is_generated ? scene_made_vertices( source ) * s->scatter.count : 0;
    return made <= WISP_GROOM_MAX_GENERATED
               ? WISP_OK
               : scene_refuse_node( r, node, "%d strands around each of '%s' have %lld vertices, expected at most %d",
                                    s->scatter.count, source->name, (long long)made, WISP_GROOM_MAX_GENERATED );
}

static wisp_status bind_curves( scene_reader* r, const scene_node* entry, int i )
{
    wisp_scene_strands* s = &r->scene->strands[i];
    const scene_node* node = enter( r, entry, "curves", "of" );
    wisp_status status = node ? scene_read_named( r, node, SCENE_STRANDS, &s->curves_of ) : WISP_OK;
    if ( status || !node )
    {
        return status;
    }
    wisp_scene_strands* source = &r->scene->strands[s->curves_of];
    if ( source->is_curves )
    {
        return scene_refuse_node( r, node, "got '%s', expected strands that are not curves", source->name );
    }
    source->is_shown = source->has_show && source->is_shown;
    return WISP_OK;
}

// Scattered ghosts follow what they are scattered around, unless they say otherwise.
static wisp_status bind_ghosts( scene_reader* r, const scene_node* entry, int i )
{
    wisp_scene_strands* s = &r->scene->strands[i];
    if ( !s->has_ghosts )
    {
        return WISP_OK;
    }
    const scene_node* node = enter( r, entry, "ghosts", "targets" );
    s->targets = s->scatter.around;
    wisp_status status = node ? scene_read_named( r, node, SCENE_STRANDS, &s->targets ) : WISP_OK;
    if ( status )
    {
        return status;
    }
    wisp_scene_strands* targets = &r->scene->strands[s->targets];
    if ( !targets->has_dynamics )
    {
        return scene_refuse_node( r, node ? node : entry, "got '%s', expected strands with the key 'dynamics'",
                                  targets->name );
    }
    targets->is_shown = targets->has_show && targets->is_shown;
    return WISP_OK;
}

static wisp_status bind_root( scene_reader* r, const scene_node* entry, int i )
{
    const scene_node* node = enter( r, entry, NULL, "on_surface" );
    return node ? scene_read_named( r, node, SCENE_SURFACE, &r->scene->strands[i].on_surface ) : WISP_OK;
}

typedef wisp_status bind_fn( scene_reader* r, const scene_node* entry, int i );

static wisp_status bind_all( scene_reader* r, const scene_node* list, bind_fn* bind )
{
    int i = 0;
    for ( const scene_node* item = scene_first( r->tree, list ); item; item = scene_next( r->tree, item ) )
    {
        size_t outside = scene_enter_index( r, i );
        wisp_status status = bind( r, item, i++ );
        if ( status )
        {
            return status;
        }
        scene_leave( r, outside );
    }
    return WISP_OK;
}

static wisp_status bind_list( scene_reader* r, const scene_node* root, const char* key, bind_fn* bind )
{
    const scene_node* list = scene_child( r, root, key );
    size_t outside = scene_enter_key( r, key );
    wisp_status status = list ? bind_all( r, list, bind ) : WISP_OK;
    if ( !status )
    {
        scene_leave( r, outside );
    }
    return status;
}

wisp_status scene_bind_strands( scene_reader* r, const scene_node* root )
{
    wisp_status status = bind_list( r, root, "strands", bind_scatter );
    status = status ? status : bind_list( r, root, "strands", bind_curves );
    return status ? status : bind_list( r, root, "strands", bind_ghosts );
}

wisp_status scene_bind_to_surfaces( scene_reader* r, const scene_node* root )
{
    const wisp_status status = bind_list( r, root, "strands", bind_root );
    return status ? status : bind_list( r, root, "surfaces", scene_bind_attachments );
}
