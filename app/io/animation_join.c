// Clips one after the other: for each property of a joint, one track of the keyframes of all of them.
#include "skeleton.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const wisp_animation_track* find_track( const wisp_animation* animation, int joint,
                                               wisp_joint_property property )
{
    for ( int t = 0; t < animation->track_count; ++t )
    {
        if ( animation->tracks[t].joint == joint && animation->tracks[t].property == property )
        {
            return &animation->tracks[t];
        }
    }
    return NULL;
}

static const float* rest_value( const wisp_joint* joint, wisp_joint_property property )
{
    return property == WISP_JOINT_TRANSLATION ? &joint->rest.translation.x
           : property == WISP_JOINT_ROTATION  ? &joint->rest.rotation.x
                                              : &joint->rest.scale.x;
}

// ---- one track ----

// With null arrays it only counts.
typedef struct key_list
{
    int count;
    float last; // s, time of the last keyframe
    float *times, *values;
} key_list;

static void put( key_list* list, int width, float time, const float* value )
{
    if ( list->count > 0 && !( time > list->last ) )
    {
        return; // the end of a round is the start of the next one
    }
    if ( list->times != NULL )
    {
        list->times[list->count] = time;
        memcpy( list->values + (size_t)list->count * (size_t)width, value, (size_t)width * sizeof *value );
    }
    list->last = time;
    list->count += 1;
}

static void put_clip( key_list* list, const wisp_clip* clip, const wisp_animation_track* track )
{
    const int width = wisp_joint_property_width( track->property ),
              stride = track->interpolation == WISP_INTERPOLATION_CUBIC ? 3 : 1;
    const float period = clip->animation->duration / clip->speed;
    const int rounds = clip->animation->loops ? 1 + (int)fminf( ( clip->end - clip->begin ) / period, 1e6f ) : 1;
    for ( int round = 0; round < rounds && list->count <= WISP_ANIMATION_MAX_KEYS; ++round )
    {
        for ( int k = 0; k < track->key_count; ++k )
        {
            const float time = clip->begin + (float)round * period + track->times[k] / clip->speed;
            if ( time <= clip->end )
            {
                put( list, width, time,
                     track->values + ( (size_t)k * (size_t)stride + ( stride == 3 ) ) * (size_t)width );
            }
        }
    }
}

// A clip that does not move the joint brings it to rest.
static void put_all( key_list* list, const wisp_clip* clips, int count, const wisp_joint* rest, int joint,
                     wisp_joint_property property )
{
    const int width = wisp_joint_property_width( property );
    const float* still = rest_value( rest, property );
    if ( clips[0].begin > 0.0f )
    {
        put( list, width, 0.0f, still );
    }
    for ( int c = 0; c < count; ++c )
    {
        const wisp_animation_track* track = find_track( clips[c].animation, joint, property );
        if ( track != NULL )
        {
            put_clip( list, &clips[c], track );
        }
        else
        {
            put( list, width, clips[c].begin, still );
            put( list, width, clips[c].end, still );
        }
    }
}

static wisp_status join_property( const wisp_clip* clips, int count, const wisp_skeleton* skeleton, int joint,
                                  wisp_joint_property property, wisp_animation* out, wisp_error* error )
{
    const wisp_animation_track* first = NULL;
    for ( int c = 0; c < count && first == NULL; ++c )
    {
        first = find_track( clips[c].animation, joint, property );
    }
    if ( first == NULL )
    {
        return WISP_OK;
    }
    key_list list = { 0 };
    put_all( &list, clips, count, &skeleton->joints[joint], joint, property );
    if ( list.count > WISP_ANIMATION_MAX_KEYS )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "animation: the clips have more than %d keyframes of a joint",
                          WISP_ANIMATION_MAX_KEYS );
    }
    wisp_animation_track* track = &out->tracks[out->track_count++];
    *track = ( wisp_animation_track ){ .joint = joint,
                                       .property = property,
                                       .interpolation = first->interpolation == WISP_INTERPOLATION_STEP
                                                            ? WISP_INTERPOLATION_STEP
                                                            : WISP_INTERPOLATION_LINEAR,
                                       .key_count = list.count };
    track->times = malloc( (size_t)list.count * sizeof *track->times );
    track->values =
        malloc( (size_t)list.count * (size_t)wisp_joint_property_width( property ) * sizeof *track->values );
    if ( track->times == NULL || track->values == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d keyframes", list.count );
    }
    list = ( key_list ){ .times = track->times, .values = track->values };
    put_all( &list, clips, count, &skeleton->joints[joint], joint, property );
    return track->interpolation == WISP_INTERPOLATION_STEP ? WISP_OK : wisp_animation_track_smooth( track, error );
}

// ---- the whole ----

static wisp_status copy_track( const wisp_animation_track* from, wisp_animation_track* to, wisp_error* error )
{
    const size_t rows = from->interpolation == WISP_INTERPOLATION_CUBIC ? 3 : 1;
    const size_t times = (size_t)from->key_count * sizeof *from->times,
                 values = (size_t)from->key_count * rows * (size_t)wisp_joint_property_width( from->property ) *
                          sizeof *from->values;
    *to = *from;
    to->times = malloc( times );
    to->values = malloc( values );
    if ( to->times == NULL || to->values == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d keyframes", from->key_count );
    }
    memcpy( to->times, from->times, times );
    memcpy( to->values, from->values, values );
    return WISP_OK;
}

static wisp_status copy_tracks( const wisp_animation* from, wisp_animation* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    out->duration = from->duration;
    out->loops = from->loops;
    for ( int t = 0; t < from->track_count && status == WISP_OK; ++t )
    {
        status = copy_track( &from->tracks[t], &out->tracks[out->track_count++], error );
    }
    return status;
}

wisp_status wisp_animation_join( const wisp_clip* clips, int count, const wisp_skeleton* skeleton,
                                 wisp_animation* out, wisp_error* error )
{
    const bool alone = count == 1 && clips[0].begin <= 0.0f && clips[0].speed == 1.0f;
    *out = ( wisp_animation ){ .duration = clips[count - 1].end };
    out->tracks = calloc( 3 * (size_t)skeleton->joint_count + 1, sizeof *out->tracks );
    wisp_status status =
        out->tracks != NULL
            ? WISP_OK
            : wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d joints", skeleton->joint_count );
    if ( status == WISP_OK && alone )
    {
        status = copy_tracks( clips[0].animation, out, error );
    }
    for ( int i = 0; i < 3 * skeleton->joint_count && !alone && status == WISP_OK; ++i )
    {
        status = join_property( clips, count, skeleton, i / 3, (wisp_joint_property)( i % 3 ), out, error );
    }
    if ( status != WISP_OK )
    {
        wisp_animation_release( out );
    }
    return status;
}
