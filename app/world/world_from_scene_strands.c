// Strands of a scene: their grooms read or generated and placed, and their effects.
#include "scene_calls.h"
#include "world_from_scene_parts.h"

#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- grooms ----

// The length of a list per strand can only be checked once the groom's file has given the number of strands.
static wisp_status check_list( const wisp_scene* scene, int strands, const char* what, int listed, int strand_count,
                               wisp_error* error )
{
    if ( listed == 0 || listed == strand_count )
    {
        return WISP_OK;
    }
    char message[200];
    snprintf( message, sizeof( message ), "%s: got %d numbers, expected one for each of %d strands", what, listed,
              strand_count );
    return SCENE_FAIL_AT( scene, strands, strands, "strands", WISP_BAD_INPUT, message, error );
}

static wisp_status read_or_make( const wisp_scene_strands* entry, const wisp_groom* source, wisp_groom* out,
                                 wisp_error* error )
{
    if ( entry->is_scattered )
    {
        return wisp_scene_make_scatter( &entry->scatter, source, out, error );
    }
    if ( entry->is_curves )
    {
        return wisp_scene_make_curves( &entry->curves, source, out, error );
    }
    if ( entry->is_generated )
    {
        return wisp_groom_generate( &entry->generator, out, error );
    }
    const wisp_scene_arrays* a = entry->arrays;
    if ( a )
    {
        return wisp_groom_of_arrays( a->points, a->point_count, a->offsets, a->strand_count, entry->file, out,
                                     error );
    }
    wisp_status status = wisp_groom_read( entry->file, out, error );
    return status == WISP_OK ? wisp_groom_check( out, error ) : status;
}

static bool is_placed( const wisp_scene_strands* entry )
{
    const wisp_transform pose = entry->pose;
    return entry->scale != 1.0f || pose.rotation.w != 1.0f || pose.translation.x != 0.0f ||
           pose.translation.y != 0.0f || pose.translation.z != 0.0f;
}

// Strands that a pose moves out of the plane are no longer flat.
static void place_groom( const wisp_scene_strands* entry, wisp_groom* groom )
{
    const float scale = entry->scale;
    const int count = is_placed( entry ) ? groom->vertex_count : 0;
    for ( int v = 0; v < count; ++v )
    {
        wisp_vec3* p = &groom->points[v];
        *p = wisp_transform_to_world( entry->pose, ( wisp_vec3 ){ scale * p->x, scale * p->y, scale * p->z } );
        groom->dimension = p->z != 0.0f ? 3 : groom->dimension;
    }
}

static wisp_status check_lists( const wisp_scene* scene, int strands, const wisp_groom* groom, wisp_error* error )
{
    const wisp_scene_strands* entry = &scene->strands[strands];
    const int count = groom->strand_count;
    WISP_TRY( check_list( scene, strands, "stretch stiffness", entry->stretch_count, count, error ) );
    WISP_TRY( check_list( scene, strands, "bend stiffness", entry->bend_count, count, error ) );
    WISP_TRY( check_list( scene, strands, "intensity", entry->intensity_count, count, error ) );
    if ( entry->mass_count > 0 && entry->mass_count != groom->vertex_count )
    {
        char message[100];
        snprintf( message, sizeof( message ),
                  "dynamics.vertex_masses: got %d masses, expected one for each of %d vertices", entry->mass_count,
                  groom->vertex_count );
        WISP_TRY( SCENE_FAIL_AT( scene, strands, strands, "strands", WISP_BAD_INPUT, message, error ) );
    }
    return WISP_OK;
}

wisp_status scene_groom_of( const wisp_scene* scene, int strands, const wisp_groom* source, wisp_groom* out,
                            wisp_error* error )
{
    const wisp_scene_strands* entry = &scene->strands[strands];
    *out = ( wisp_groom ){ 0 };
    wisp_error cause = { 0 };
    wisp_status status = read_or_make( entry, source, out, &cause );
    if ( status != WISP_OK )
    {
        status = SCENE_FAIL_AT( scene, strands, strands, "strands", status, cause.message, error );
    }
    else
    {
        place_groom( entry, out );
        status = check_lists( scene, strands, out, error );
    }
    if ( status != WISP_OK )
    {
        wisp_groom_release( out );
    }
    return status;
}

int scene_groom_source( const wisp_scene* scene, int strands )
{
    const wisp_scene_strands* entry = &scene->strands[strands];
    return entry->is_curves ? entry->curves_of : entry->scatter.around;
}

// Curves of strands scattered around others: at most three deep.
wisp_status scene_groom( const wisp_scene* scene, int strands, wisp_groom* out, wisp_error* error )
{
    const int from = scene_groom_source( scene, strands );
    wisp_groom source = { 0 };
    wisp_status status = from >= 0 ? scene_groom( scene, from, &source, error ) : WISP_OK;
    *out = ( wisp_groom ){ 0 };
    if ( status == WISP_OK )
    {
        status = scene_groom_of( scene, strands, &source, out, error );
    }
    wisp_groom_release( &source );
    return status;
}

// ---- effects of strands ----

static wisp_status request_all( scene_world* out, int strands )
{
    const wisp_scene_strands* entry = &out->scene->strands[strands];
    const struct
    {
        bool requested;
        wisp_component component;
    } columns[] = {
        { entry->request_points, WISP_STRAND_POINTS }, { entry->request_width, WISP_POINT_WIDTH },
        { entry->request_colour, WISP_POINT_COLOUR },  { entry->request_strain, WISP_POINT_STRAIN },
        { entry->request_speed, WISP_POINT_SPEED },    { entry->request_motion_stats, WISP_MOTION_STATS },
    };
    for ( int i = 0; i < WISP_COUNT( columns ); ++i )
    {
        WISP_TRY( columns[i].requested ? wisp_request( out->world, out->entities[strands], columns[i].component )
                                       : WISP_OK );
    }
    return WISP_OK;
}

wisp_status scene_strands_dress( scene_world* out, int strands )
{
    const wisp_scene_strands* entry = &out->scene->strands[strands];
    wisp_entity entity = out->entities[strands];
    WISP_TRY( entry->has_frozen_hair ? wisp_set_frozen_hair( out->world, entity, &entry->frozen_hair ) : WISP_OK );
    WISP_TRY( entry->has_environment ? wisp_set_environment( out->world, entity, &entry->environment ) : WISP_OK );
    WISP_TRY( entry->has_appearance ? wisp_set_strand_appearance( out->world, entity, &entry->appearance )
                                    : WISP_OK );
    return request_all( out, strands );
}

// ---- motion ----

// Moving strands of a scene, their ghosts, curves through them, and the heads that carry them.

static wisp_status fail_here( const scene_world* world, int strands, wisp_status status, wisp_error* error )
{
    return status == WISP_OK ? WISP_OK
                             : SCENE_FAIL_AT( world->scene, strands, strands, "strands", status,
                                              wisp_world_message( world->world ), error );
}

static wisp_status set_collision( scene_world* world, int strands )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    const wisp_entity entity = world->entities[strands];
    WISP_TRY( entry->has_collision ? wisp_set_collision( world->world, entity, &entry->collision ) : WISP_OK );
    if ( entry->request_contacts )
    {
        WISP_TRY( wisp_request_collision_stats( world->world, entity, true ) );
    }
    return WISP_OK;
}

// With masses that grow along strands, which are copied.
static wisp_status set_weighed( scene_world* world, int strands )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    wisp_strand_dynamics_def def = entry->dynamics;
    float* masses = malloc( (size_t)world->grooms[strands].vertex_count * sizeof *masses + 1 );
    if ( !masses )
    {
        return wisp_world_fail( world->world, WISP_NO_MEMORY, "out of memory for masses" );
    }
    scene_strands_weigh( entry, &world->grooms[strands], masses );
    def.vertex_masses = masses;
    const wisp_status status = wisp_set_strand_dynamics( world->world, world->entities[strands], &def );
    free( masses );
    return status;
}

wisp_status scene_hold_tips( scene_world* world, int strands, wisp_strand_tip hold )
{
    const wisp_groom* groom = &world->grooms[strands];
    for ( int i = 0; i < groom->strand_count; ++i )
    {
        if ( groom->offsets[i + 1] - groom->offsets[i] > 1 ) // a root alone has no tip
        {
            WISP_TRY( SCENE_CALL_2( world, wisp_hold_strand_tip, world->entities[strands], i, hold ) );
        }
    }
    return WISP_OK;
}

wisp_vec3 scene_strand_frame_pivot( const wisp_scene_strands* entry )
{
    return entry->has_frame_pivot  ? entry->frame_pivot
           : entry->has_head_pivot ? entry->head_pivot
                                   : entry->pose.translation;
}

static wisp_status set_dynamics( scene_world* world, int strands )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    wisp_entity entity = world->entities[strands];
    wisp_world* w = world->world;
    WISP_TRY( entry->mass_ratio != 1.0f ? set_weighed( world, strands )
                                        : wisp_set_strand_dynamics( w, entity, &entry->dynamics ) );
    WISP_TRY( wisp_set_substeps( w, entity, entry->substeps ) );
    WISP_TRY( entry->has_grid ? wisp_set_strand_grid( w, entity, &entry->grid ) : WISP_OK );
    if ( entry->has_frame )
    {
        wisp_moving_frame_def frame = entry->frame;
        frame.pose.translation = scene_strand_frame_pivot( entry );
        WISP_TRY( wisp_set_moving_frame( w, entity, &frame ) );
    }
    WISP_TRY( entry->max_speed < INFINITY ? wisp_set_max_speed( w, entity, entry->max_speed ) : WISP_OK );
    WISP_TRY( entry->has_tips ? scene_hold_tips( world, strands, entry->tips_hold ) : WISP_OK );
    WISP_TRY( set_collision( world, strands ) );
    WISP_TRY( entry->has_contact ? wisp_set_contact( w, entity, &entry->contact ) : WISP_OK );
    WISP_TRY( entry->has_sleep ? wisp_set_sleep( w, entity, &entry->sleep ) : WISP_OK );
    return entry->on_surface >= 0 ? wisp_root_strands( w, entity, world->surfaces[entry->on_surface].entity )
                                  : WISP_OK;
}

// Frozen hair on ghosts starts from their moved positions, which are kept separate from its output.
static wisp_status set_ghosts( scene_world* world, int strands )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    wisp_ghosts_def def = entry->ghosts;
    def.targets = world->entities[entry->targets];
    def.between = world->scene->frames_per_step > 1;
    if ( entry->has_frozen_hair )
    {
        WISP_TRY( wisp_request( world->world, world->entities[strands], WISP_STRAND_POSED ) );
    }
    WISP_TRY( wisp_set_ghosts( world->world, world->entities[strands], &def ) );
    return set_collision( world, strands );
}

static wisp_status add_curves( scene_world* world, int strands, wisp_error* error )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    WISP_TRY(
        scene_groom_of( world->scene, strands, &world->grooms[entry->curves_of], &world->grooms[strands], error ) );
    wisp_curves_def def = entry->curves;
    def.source = world->entities[entry->curves_of];
    wisp_status status = wisp_add_curves( world->world, &def, &world->entities[strands] );
    status = status == WISP_OK ? scene_strands_dress( world, strands ) : status;
    return fail_here( world, strands, status, error );
}

// Ghosts need their targets, and curves need either.
wisp_status scene_motion_set( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        WISP_TRY( scene->strands[i].has_dynamics ? fail_here( world, i, set_dynamics( world, i ), error ) : WISP_OK );
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        WISP_TRY( scene->strands[i].has_ghosts ? fail_here( world, i, set_ghosts( world, i ), error ) : WISP_OK );
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        WISP_TRY( scene->strands[i].is_curves ? add_curves( world, i, error ) : WISP_OK );
    }
    // last, because ghosts and curves are placed by the rest shape of what they follow
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        if ( scene->strands[i].has_start && scene->strands[i].has_dynamics )
        {
            scene_strands_start( &scene->strands[i], world->world, world->entities[i], &world->grooms[i] );
        }
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        const wisp_detail_def* detail = &scene->strands[i].detail;
        WISP_TRY( scene->strands[i].has_detail
                      ? fail_here( world, i, wisp_set_detail( world->world, world->entities[i], detail ), error )
                      : WISP_OK );
    }
    return WISP_OK;
}

void scene_request_points( wisp_scene* scene )
{
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        scene->strands[i].request_points = true;
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        scene->surfaces[i].request_points = true;
    }
}

void scene_request_statistics( wisp_scene* scene )
{
    scene_request_points( scene );
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        wisp_scene_strands* s = &scene->strands[i];
        s->request_motion_stats = s->has_dynamics;
        s->request_contacts = s->has_collision;
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        wisp_scene_surface* s = &scene->surfaces[i];
        s->request_motion_stats = true;
        s->request_contacts = s->has_collision;
        s->request_stats = s->request_stats || s->has_implicit;
    }
}

void scene_request_intersections( wisp_scene* scene )
{
    scene->request_contact_stats = scene->request_intersections = true;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        wisp_scene_surface* s = &scene->surfaces[i];
        if ( !s->has_contact && !s->has_implicit )
        {
            s->has_contact = true;
            s->contact.self = false;
            s->contact.mask = 0;
        }
    }
}

bool scene_has_contact( const wisp_scene* scene )
{
    bool any = false;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        any = any || scene->surfaces[i].has_contact;
    }
    return any;
}
