// Strands of a scene: their grooms read or generated and placed, and their effects.
#include "world_from_scene_parts.h"

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
    return scene_fail_at_strands( scene, strands, WISP_BAD_INPUT, message, error );
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
static void place( const wisp_scene_strands* entry, wisp_groom* groom )
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
    wisp_status status = check_list( scene, strands, "stretch stiffness", entry->stretch_count, count, error );
    if ( status == WISP_OK )
    {
        status = check_list( scene, strands, "bend stiffness", entry->bend_count, count, error );
    }
    if ( status == WISP_OK )
    {
        status = check_list( scene, strands, "intensity", entry->intensity_count, count, error );
    }
    if ( status == WISP_OK && entry->mass_count > 0 && entry->mass_count != groom->vertex_count )
    {
        char message[100];
        snprintf( message, sizeof( message ),
                  "dynamics.vertex_masses: got %d masses, expected one for each of %d vertices", entry->mass_count,
                  groom->vertex_count );
        status = scene_fail_at_strands( scene, strands, WISP_BAD_INPUT, message, error );
    }
    return status;
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
        status = scene_fail_at_strands( scene, strands, status, cause.message, error );
    }
    else
    {
        place( entry, out );
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
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( columns ) && status == WISP_OK; ++i )
    {
        status =
            columns[i].requested ? wisp_request( out->world, out->entities[strands], columns[i].component ) : WISP_OK;
    }
    return status;
}

wisp_status scene_strands_dress( scene_world* out, int strands )
{
    const wisp_scene_strands* entry = &out->scene->strands[strands];
    wisp_entity entity = out->entities[strands];
    wisp_status status = WISP_OK;
    if ( entry->has_frozen_hair )
    {
        status = wisp_set_frozen_hair( out->world, entity, &entry->frozen_hair );
    }
    if ( status == WISP_OK && entry->has_environment )
    {
        status = wisp_set_environment( out->world, entity, &entry->environment );
    }
    if ( status == WISP_OK && entry->has_appearance )
    {
        status = wisp_set_strand_appearance( out->world, entity, &entry->appearance );
    }
    return status == WISP_OK ? request_all( out, strands ) : status;
}
