// Skeletons and animations: memory, checks, tangents, and the pose at a time.
#include "skeleton.h"

#include "gltf.h"
#include "gltf_internal.h"
#include "trig.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- rigs ----

// Rigs: where skeleton, weights and clips come from.

void wisp_rig_release( wisp_rig* rig )
{
    if ( rig != NULL )
    {
        wisp_skin_release( rig->skin );
        wisp_skeleton_release( &rig->skeleton );
        wisp_animation_release( &rig->animation );
        *rig = ( wisp_rig ){ 0 };
    }
}

// ---- the mesh's side ----

static wisp_status load_skeleton( const wisp_scene_mesh* mesh, gltf_model* model, wisp_rig* out, wisp_error* error )
{
    if ( mesh->file == NULL || mesh->arrays != NULL || !gltf_is_path( mesh->file ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "animation: the mesh has no skeleton, expected a glTF file" );
    }
    int node = 0;
    const wisp_status status = gltf_model_read( mesh->file, model, &node, error );
    return status == WISP_OK ? gltf_rig( model, node, mesh->file, &out->skeleton, &out->skin, error ) : status;
}

// ---- clips ----

static wisp_status load_clips( const gltf_model* model, const char* file, const wisp_scene_animation* animation,
                               float duration, const wisp_skeleton* skeleton, wisp_animation* all, wisp_clip* clips,
                               wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int c = 0; c < animation->clip_count && status == WISP_OK; ++c )
    {
        const wisp_scene_clip* from = &animation->clips[c];
        status = gltf_rig_animation( model, from->name, file, skeleton, &all[c], error );
        all[c].loops = all[c].loops && from->loop;
        const bool is_last = c + 1 == animation->clip_count;
        const float rest = is_last ? duration : from[1].time - animation->blend;
        const float once = from->time + all[c].duration / from->speed;
        clips[c] = ( wisp_clip ){ .animation = &all[c],
                                  .begin = from->time,
                                  .end = is_last && rest < once ? once : rest,
                                  .speed = from->speed };
    }
    return status;
}

static wisp_status join( const gltf_model* model, const char* file, const wisp_scene_animation* animation,
                         float duration, wisp_rig* out, wisp_error* error )
{
    const size_t count = (size_t)animation->clip_count;
    io_memory scratch = { 0 };
    wisp_animation* all = io_get( &scratch, count * sizeof *all );
    wisp_clip* clips = io_get( &scratch, count * sizeof *clips );
    wisp_status status =
        scratch.is_short
            ? wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d clips", animation->clip_count )
            : load_clips( model, file, animation, duration, &out->skeleton, all, clips, error );
    status = status == WISP_OK
                 ? wisp_animation_join( clips, animation->clip_count, &out->skeleton, &out->animation, error )
                 : status;
    for ( size_t c = 0; c < count && all != NULL; ++c )
    {
        wisp_animation_release( &all[c] );
    }
    io_release( &scratch );
    return status;
}

// The file of the clips is that of the mesh unless it is named.
static wisp_status load_animation( const wisp_scene_mesh* mesh, const wisp_scene_animation* animation, float duration,
                                   const gltf_model* model, wisp_rig* out, wisp_error* error )
{
    if ( animation->file == NULL )
    {
        return join( model, mesh->file, animation, duration, out, error );
    }
    gltf_model other;
    wisp_status status = gltf_read( animation->file, 0, &other, error );
    status = status == WISP_OK ? join( &other, animation->file, animation, duration, out, error ) : status;
    gltf_release( &other );
    return status;
}

wisp_status wisp_rig_load( const wisp_scene_mesh* mesh, const wisp_scene_animation* animation, float duration,
                           wisp_rig* out, wisp_error* error )
{
    gltf_model model = { 0 };
    *out = ( wisp_rig ){ 0 };
    wisp_status status = load_skeleton( mesh, &model, out, error );
    status = status == WISP_OK ? load_animation( mesh, animation, duration, &model, out, error ) : status;
    gltf_release( &model );
    if ( status != WISP_OK )
    {
        wisp_rig_release( out );
    }
    return status;
}

// ---- animations ----

// Clips one after the other: for each property of a joint, one track of the keyframes of all of them.

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

static size_t values_size( const wisp_animation_track* track )
{
    const size_t rows = track->interpolation == WISP_INTERPOLATION_CUBIC ? 3 : 1;
    return (size_t)track->key_count * rows * (size_t)wisp_joint_property_width( track->property ) *
           sizeof *track->values;
}

static wisp_status make_keys( wisp_animation_track* track, wisp_error* error )
{
    track->times = malloc( (size_t)track->key_count * sizeof *track->times );
    track->values = malloc( values_size( track ) );
    return track->times != NULL && track->values != NULL
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d keyframes", track->key_count );
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
    WISP_TRY( make_keys( track, error ) );
    list = ( key_list ){ .times = track->times, .values = track->values };
    put_all( &list, clips, count, &skeleton->joints[joint], joint, property );
    return track->interpolation == WISP_INTERPOLATION_STEP ? WISP_OK : wisp_animation_track_smooth( track, error );
}

// ---- the whole ----

static wisp_status copy_track( const wisp_animation_track* from, wisp_animation_track* to, wisp_error* error )
{
    *to = *from;
    WISP_TRY( make_keys( to, error ) );
    memcpy( to->times, from->times, (size_t)from->key_count * sizeof *from->times );
    memcpy( to->values, from->values, values_size( from ) );
    return WISP_OK;
}

static wisp_status copy_tracks( const wisp_animation* from, wisp_animation* out, wisp_error* error )
{
    out->duration = from->duration;
    out->loops = from->loops;
    for ( int t = 0; t < from->track_count; ++t )
    {
        WISP_TRY( copy_track( &from->tracks[t], &out->tracks[out->track_count++], error ) );
    }
    return WISP_OK;
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

// ---- skeletons ----

// ---- memory ----

void wisp_skeleton_release( wisp_skeleton* skeleton )
{
    for ( int j = 0; skeleton != NULL && j < skeleton->joint_count; ++j )
    {
        free( skeleton->joints[j].name );
    }
    if ( skeleton != NULL )
    {
        free( skeleton->joints );
        *skeleton = ( wisp_skeleton ){ 0 };
    }
}

void wisp_animation_release( wisp_animation* animation )
{
    for ( int t = 0; animation != NULL && t < animation->track_count; ++t )
    {
        free( animation->tracks[t].times );
        free( animation->tracks[t].values );
    }
    if ( animation != NULL )
    {
        free( animation->name );
        free( animation->tracks );
        *animation = ( wisp_animation ){ 0 };
    }
}

int wisp_skeleton_find( const wisp_skeleton* skeleton, const char* name )
{
    for ( int j = 0; j < skeleton->joint_count; ++j )
    {
        if ( skeleton->joints[j].name != NULL && strcmp( skeleton->joints[j].name, name ) == 0 )
        {
            return j;
        }
    }
    return -1;
}

// ---- checks ----

static bool are_finite( const float* values, int count )
{
    bool finite = true;
    for ( int i = 0; i < count; ++i )
    {
        finite = finite && isfinite( values[i] );
    }
    return finite;
}

// Floats of a keyframe.
static int stride_of( const wisp_animation_track* track )
{
    return wisp_joint_property_width( track->property ) *
           ( track->interpolation == WISP_INTERPOLATION_CUBIC ? 3 : 1 );
}

static const float* value_at( const wisp_animation_track* track, int key )
{
    const int width = wisp_joint_property_width( track->property ), stride = stride_of( track );
    return track->values + (size_t)key * (size_t)stride + ( stride > width ? width : 0 );
}

static wisp_status check_track( const wisp_animation* animation, int t, int joint_count, wisp_error* error )
{
    const wisp_animation_track* track = &animation->tracks[t];
    if ( track->joint < 0 || track->joint >= joint_count )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "track %d: got joint %d, but the skeleton has %d joints", t,
                          track->joint, joint_count );
    }
    if ( (int)track->property < 0 || track->property > WISP_JOINT_SCALE || (int)track->interpolation < 0 ||
         track->interpolation > WISP_INTERPOLATION_CUBIC )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "track %d: got property %d and interpolation %d, which do not exist",
                          t, (int)track->property, (int)track->interpolation );
    }
    if ( track->key_count < 1 || track->key_count > WISP_ANIMATION_MAX_KEYS )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "track %d: got %d keyframes, expected 1 to %d", t, track->key_count,
                          WISP_ANIMATION_MAX_KEYS );
    }
    const int stride = stride_of( track );
    for ( int k = 0; k < track->key_count; ++k )
    {
        const float* v = value_at( track, k );
        const bool rises = k == 0 ? track->times[0] >= 0.0f : track->times[k] > track->times[k - 1];
        if ( !rises || !isfinite( track->times[k] ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "track %d, keyframe %d: got time %g, expected ascending times from 0", t, k,
                              (double)track->times[k] );
        }
        if ( !are_finite( track->values + (size_t)k * (size_t)stride, stride ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "track %d, keyframe %d: got a value that is not finite", t, k );
        }
        if ( track->property == WISP_JOINT_ROTATION &&
             !( v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3] >= 1e-6f ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "track %d, keyframe %d: got a rotation of length 0", t, k );
        }
    }
    return WISP_OK;
}

wisp_status wisp_animation_check( const wisp_animation* animation, const wisp_skeleton* skeleton, wisp_error* error )
{
    if ( !( animation->duration > 0.0f && isfinite( animation->duration ) ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "animation: got a duration of %g s, expected more than 0",
                          (double)animation->duration );
    }
    bool* taken = calloc( 3 * (size_t)skeleton->joint_count, sizeof *taken );
    if ( taken == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d joints", skeleton->joint_count );
    }
    wisp_status status = WISP_OK;
    for ( int t = 0; t < animation->track_count && status == WISP_OK; ++t )
    {
        status = check_track( animation, t, skeleton->joint_count, error );
        const wisp_animation_track* track = &animation->tracks[t];
        bool* mark = status == WISP_OK ? &taken[3 * track->joint + (int)track->property] : NULL;
        if ( mark != NULL && *mark )
        {
            status = wisp_fail( error, WISP_BAD_INPUT,
                                "track %d: got a second track of the same property of joint %d", t, track->joint );
        }
        else if ( mark != NULL )
        {
            *mark = true;
        }
    }
    free( taken );
    return status;
}

// ---- tangents ----

static void turn_near( float* q, const float* before )
{
    const float dot = q[0] * before[0] + q[1] * before[1] + q[2] * before[2] + q[3] * before[3];
    for ( int i = 0; i < 4 && dot < 0.0f; ++i )
    {
        q[i] = -q[i];
    }
}

wisp_status wisp_animation_track_smooth( wisp_animation_track* track, wisp_error* error )
{
    const int width = wisp_joint_property_width( track->property ), count = track->key_count, last = count - 1;
    float* values = calloc( (size_t)count * 3 * (size_t)width, sizeof *values );
    if ( values == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d keyframes", count );
    }
    for ( int k = 1; k < count && width == 4; ++k )
    {
        turn_near( track->values + 4 * (size_t)k, track->values + 4 * (size_t)( k - 1 ) );
    }
    for ( int k = 0; k < count; ++k )
    {
        const bool is_end = k == 0 || k == last;
        const int from = is_end ? k : k - 1, to = is_end ? k : k + 1;
        const float *value = track->values + k * width, *a = track->values + from * width,
                    *b = track->values + to * width;
        const float span = is_end ? 1.0f : track->times[to] - track->times[from];
        float* out = values + (size_t)k * 3 * (size_t)width;
        for ( int i = 0; i < width; ++i )
        {
            out[width + i] = value[i];
            out[i] = out[2 * width + i] = ( b[i] - a[i] ) / span;
        }
    }
    free( track->values );
    track->values = values;
    track->interpolation = WISP_INTERPOLATION_CUBIC;
    return WISP_OK;
}

// ---- sampling ----

// Slerp (Shoemake 1985) with the engine's own sine, so that the bits are the same everywhere.
static void slerp( const float* a, const float* b, float s, float* out )
{
    float near[4] = { b[0], b[1], b[2], b[3] }, across = 0.0f, dot = 0.0f;
    turn_near( near, a );
    for ( int i = 0; i < 4; ++i )
    {
        dot += a[i] * near[i];
    }
    for ( int i = 0; i < 4; ++i )
    {
        const float d = near[i] - dot * a[i];
        across += d * d;
    }
    const float angle = trig_atan2( sqrtf( across ), dot );
    float before = 1.0f - s, after = s, sine, cosine;
    trig_sincos( angle, &sine, &cosine );
    if ( sine > 1e-4f )
    {
        float part, unused;
        trig_sincos( ( 1.0f - s ) * angle, &part, &unused );
        before = part / sine;
        trig_sincos( s * angle, &part, &unused );
        after = part / sine;
    }
    for ( int i = 0; i < 4; ++i )
    {
        out[i] = before * a[i] + after * near[i];
    }
}

static void sample_between( const wisp_animation_track* track, int k, float time, float* out )
{
    const int width = wisp_joint_property_width( track->property );
    const float *a = value_at( track, k ), *b = value_at( track, k + 1 );
    const float span = track->times[k + 1] - track->times[k], s = ( time - track->times[k] ) / span;
    if ( track->interpolation == WISP_INTERPOLATION_STEP )
    {
        memcpy( out, a, (size_t)width * sizeof *out );
    }
    else if ( track->interpolation == WISP_INTERPOLATION_LINEAR && width == 4 )
    {
        slerp( a, b, s, out );
    }
    else
    {
        const bool cubic = track->interpolation == WISP_INTERPOLATION_CUBIC;
        const float after = cubic ? s * s * ( 3.0f - 2.0f * s ) : s, leave = span * s * ( 1.0f - s ) * ( 1.0f - s ),
                    arrive = span * s * s * ( s - 1.0f );
        for ( int i = 0; i < width; ++i )
        {
            out[i] = ( 1.0f - after ) * a[i] + after * b[i];
            out[i] += cubic ? leave * a[width + i] + arrive * b[i - width] : 0.0f;
        }
    }
}

static void sample( const wisp_animation_track* track, float time, float* out )
{
    const int width = wisp_joint_property_width( track->property ), last = track->key_count - 1;
    if ( time <= track->times[0] || time >= track->times[last] )
    {
        memcpy( out, value_at( track, time <= track->times[0] ? 0 : last ), (size_t)width * sizeof *out );
        return;
    }
    int low = 0, high = last;
    while ( high - low > 1 )
    {
        const int middle = low + ( high - low ) / 2;
        *( track->times[middle] <= time ? &low : &high ) = middle;
    }
    sample_between( track, low, time, out );
}

static wisp_affine matrix_of( wisp_joint_transform t )
{
    return wisp_affine_from_transform( wisp_transform_make( t.rotation, t.translation ), t.scale );
}

void wisp_skeleton_pose( const wisp_skeleton* skeleton, const wisp_animation* animation, float time,
                         wisp_affine* joints )
{
    for ( int j = 0; j < skeleton->joint_count; ++j )
    {
        wisp_joint_transform local = skeleton->joints[j].rest;
        const float duration = animation != NULL ? animation->duration : 1.0f;
        const float at = animation != NULL && animation->loops ? time - duration * floorf( time / duration ) : time;
        for ( int t = 0; animation != NULL && t < animation->track_count; ++t )
        {
            float* to[3] = { &local.translation.x, &local.rotation.x, &local.scale.x };
            if ( animation->tracks[t].joint == j )
            {
                sample( &animation->tracks[t], at, to[animation->tracks[t].property] );
            }
        }
        const wisp_affine own = matrix_of( local );
        const int parent = skeleton->joints[j].parent;
        joints[j] = parent < 0 ? own : wisp_affine_multiply( &joints[parent], &own );
    }
}

wisp_status wisp_skeleton_skin( const wisp_skeleton* skeleton, const wisp_vec3* points,
                                const wisp_skin_weights* weights, wisp_skin** out, wisp_error* error )
{
    *out = NULL;
    wisp_affine* binds = malloc( (size_t)( skeleton->joint_count + 1 ) * sizeof *binds );
    if ( binds == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "skeleton: out of memory for %d joints", skeleton->joint_count );
    }
    for ( int j = 0; j < skeleton->joint_count; ++j )
    {
        binds[j] = skeleton->joints[j].inverse_bind;
    }
    wisp_skin_def def = wisp_default_skin_def();
    def.points = points;
    def.bones = (const int32_t( * )[WISP_SKIN_MAX_INFLUENCES])weights->joints;
    def.weights = (const float( * )[WISP_SKIN_MAX_INFLUENCES])weights->weights;
    def.point_count = weights->vertex_count;
    def.bone_count = skeleton->joint_count;
    def.inverse_bind = binds;
    const wisp_status status = wisp_skin_create( &def, NULL, out, error );
    free( binds );
    return status;
}
