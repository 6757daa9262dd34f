// From the nodes, skins and channels of a model to joints, weights and tracks.
#include "gltf_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io_file.h"

// ---- joints ----

// Columns of a matrix that are at right angles are a rotation times a scale; one of them is mirrored in a left-handed matrix.
static bool split_matrix( const double m[12], double rotation[4], double scale[3] )
{
    double r[3][3];
    const double determinant = m[0] * ( m[5] * m[10] - m[6] * m[9] ) - m[1] * ( m[4] * m[10] - m[6] * m[8] ) +
                               m[2] * ( m[4] * m[9] - m[5] * m[8] );
    for ( int c = 0; c < 3; ++c )
    {
        const double length = sqrt( m[c] * m[c] + m[4 + c] * m[4 + c] + m[8 + c] * m[8 + c] );
        if ( !( length > 1e-12 ) )
        {
            return false;
        }
        scale[c] = c == 0 && determinant < 0.0 ? -length : length;
        for ( int row = 0; row < 3; ++row )
        {
            r[row][c] = m[4 * row + c] / scale[c];
        }
    }
    for ( int c = 0; c < 3; ++c )
    {
        const int d = ( c + 1 ) % 3;
        if ( fabs( r[0][c] * r[0][d] + r[1][c] * r[1][d] + r[2][c] * r[2][d] ) > 1e-4 )
        {
            return false;
        }
    }
    // the largest of the four squares keeps the most digits (Shepperd 1978)
    const double squares[4] = { 1.0 + r[0][0] - r[1][1] - r[2][2], 1.0 - r[0][0] + r[1][1] - r[2][2],
                                1.0 - r[0][0] - r[1][1] + r[2][2], 1.0 + r[0][0] + r[1][1] + r[2][2] };
    int most = 3;
    for ( int i = 0; i < 3; ++i )
    {
        most = squares[i] > squares[most] ? i : most;
    }
    const double pairs[4][4] = { { squares[0], r[0][1] + r[1][0], r[0][2] + r[2][0], r[2][1] - r[1][2] },
                                 { r[0][1] + r[1][0], squares[1], r[1][2] + r[2][1], r[0][2] - r[2][0] },
                                 { r[0][2] + r[2][0], r[1][2] + r[2][1], squares[2], r[1][0] - r[0][1] },
                                 { r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1], squares[3] } };
    for ( int i = 0; i < 4; ++i )
    {
        rotation[i] = pairs[most][i] / ( 2.0 * sqrt( squares[most] ) );
    }
    return true;
}

static wisp_status fill_joint( const gltf_node* node, const char* name, wisp_joint* out, wisp_error* error )
{
    double rotation[4], scale[3], translation[3];
    memcpy( rotation, node->rotation, sizeof rotation );
    memcpy( scale, node->scale, sizeof scale );
    memcpy( translation, node->translation, sizeof translation );
    if ( node->has_matrix )
    {
        if ( !split_matrix( node->matrix, rotation, scale ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "%s: node '%.60s' has a matrix that is not a scale and a rotation",
                              io_short_name( name ), node->name );
        }
        for ( int i = 0; i < 3; ++i )
        {
            translation[i] = node->matrix[4 * i + 3];
        }
    }
    out->rest.rotation =
        ( wisp_quat ){ (float)rotation[0], (float)rotation[1], (float)rotation[2], (float)rotation[3] };
    out->rest.translation = ( wisp_vec3 ){ (float)translation[0], (float)translation[1], (float)translation[2] };
    out->rest.scale = ( wisp_vec3 ){ (float)scale[0], (float)scale[1], (float)scale[2] };
    out->inverse_bind = wisp_affine_identity();
    out->name = strdup( node->name );
    return out->name != NULL
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its nodes", io_short_name( name ) );
}

// Nodes may have equal names in a file; a joint keeps its name if no other has it.
static void drop_equal_names( wisp_skeleton* skeleton )
{
    for ( int j = 0; j < skeleton->joint_count; ++j )
    {
        if ( skeleton->joints[j].name != NULL && wisp_skeleton_find( skeleton, skeleton->joints[j].name ) != j )
        {
            free( skeleton->joints[j].name );
            skeleton->joints[j].name = NULL;
        }
    }
}

// Joint i is the node order[i]. @param joint_of [node_count]
static wisp_status make_joints( const gltf_model* model, const char* name, int32_t* joint_of, wisp_skeleton* out,
                                wisp_error* error )
{
    if ( model->node_count > WISP_SKELETON_MAX_JOINTS )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %d nodes, expected at most %d", io_short_name( name ),
                          model->node_count, WISP_SKELETON_MAX_JOINTS );
    }
    out->joints = calloc( (size_t)model->node_count + 1, sizeof *out->joints );
    if ( out->joints == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d nodes", io_short_name( name ),
                          model->node_count );
    }
    out->joint_count = model->node_count;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < model->node_count && status == WISP_OK; ++i )
    {
        const gltf_node* node = &model->nodes[model->order[i]];
        joint_of[model->order[i]] = i;
        out->joints[i].parent = node->parent < 0 ? -1 : joint_of[node->parent];
        status = fill_joint( node, name, &out->joints[i], error );
    }
    return status;
}

// ---- the skin ----

static wisp_affine affine_of( const double m[12] )
{
    wisp_affine out;
    for ( int i = 0; i < 12; ++i )
    {
        out.m[i / 4][i % 4] = (float)m[i];
    }
    return out;
}

static wisp_status make_skin( const gltf_model* model, int node, const char* name, const int32_t* joint_of,
                              io_memory* scratch, wisp_skeleton* skeleton, wisp_skin** out, wisp_error* error )
{
    const gltf_mesh* mesh = &model->meshes[model->nodes[node].mesh];
    const gltf_skin* skin =
        model->nodes[node].skin >= 0 && mesh->joints != NULL ? &model->skins[model->nodes[node].skin] : NULL;
    const size_t count = (size_t)mesh->mesh.vertex_count;
    wisp_skin_weights weights = { .vertex_count = mesh->mesh.vertex_count,
                                  .joints = io_get( scratch, count * sizeof *weights.joints ),
                                  .weights = io_get( scratch, count * sizeof *weights.weights ) };
    if ( scratch->is_short )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d vertices", io_short_name( name ),
                          mesh->mesh.vertex_count );
    }
    for ( int j = 0; skin != NULL && j < skin->joint_count; ++j )
    {
        skeleton->joints[joint_of[skin->joints[j]]].inverse_bind = affine_of( skin->inverse_bind + 12 * (size_t)j );
    }
    for ( size_t i = 0; i < 4 * count; ++i )
    {
        weights.joints[i / 4][i % 4] = joint_of[skin != NULL ? skin->joints[mesh->joints[i]] : node];
        weights.weights[i / 4][i % 4] = skin != NULL ? mesh->weights[i] : i % 4 == 0 ? 1.0f : 0.0f;
    }
    return wisp_skeleton_skin( skeleton, mesh->mesh.points, &weights, out, error );
}

wisp_status gltf_rig( const gltf_model* model, int node, const char* name, wisp_skeleton* skeleton, wisp_skin** skin,
                      wisp_error* error )
{
    *skeleton = ( wisp_skeleton ){ 0 };
    *skin = NULL;
    io_memory scratch = { 0 };
    int32_t* joint_of = io_get( &scratch, (size_t)model->node_count * sizeof *joint_of );
    wisp_status status = joint_of != NULL ? make_joints( model, name, joint_of, skeleton, error )
                                          : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d nodes",
                                                       io_short_name( name ), model->node_count );
    if ( status == WISP_OK )
    {
        drop_equal_names( skeleton );
        status = make_skin( model, node, name, joint_of, &scratch, skeleton, skin, error );
    }
    io_release( &scratch );
    if ( status != WISP_OK )
    {
        wisp_skeleton_release( skeleton );
    }
    return status;
}

// ---- animations ----

static int joint_of_node( const gltf_model* model, int node, const wisp_skeleton* skeleton )
{
    const int by_name = wisp_skeleton_find( skeleton, model->nodes[node].name );
    for ( int i = 0; by_name < 0 && i < model->node_count && i < skeleton->joint_count; ++i )
    {
        if ( model->order[i] == node && skeleton->joints[i].name == NULL )
        {
            return i; // of equal names, the same file
        }
    }
    return by_name;
}

static wisp_status make_track( const gltf_channel* from, int joint, wisp_animation_track* out, wisp_error* error )
{
    const size_t width = from->path == GLTF_ROTATION ? 4 : 3, rows = from->interpolation == GLTF_CUBICSPLINE ? 3 : 1,
                 keys = (size_t)from->key_count;
    *out = ( wisp_animation_track ){
        .joint = joint,
        .property = from->path == GLTF_TRANSLATION ? WISP_JOINT_TRANSLATION
                    : from->path == GLTF_ROTATION  ? WISP_JOINT_ROTATION
                                                   : WISP_JOINT_SCALE,
        .interpolation = from->interpolation == GLTF_STEP     ? WISP_INTERPOLATION_STEP
                         : from->interpolation == GLTF_LINEAR ? WISP_INTERPOLATION_LINEAR
                                                              : WISP_INTERPOLATION_CUBIC,
        .key_count = from->key_count,
        .times = malloc( keys * sizeof *out->times ),
        .values = malloc( keys * rows * width * sizeof *out->values ),
    };
    if ( out->times == NULL || out->values == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "animation: out of memory for %d keyframes", from->key_count );
    }
    for ( size_t k = 0; k < keys; ++k )
    {
        out->times[k] = (float)from->times[k];
    }
    for ( size_t i = 0; i < keys * rows * width; ++i )
    {
        out->values[i] = (float)from->values[i];
    }
    return WISP_OK;
}

static wisp_status refuse_name( const gltf_model* model, const char* animation, const char* name, wisp_error* error )
{
    char names[240] = "";
    for ( int a = 0; a < model->animation_count; ++a )
    {
        const size_t length = strlen( names );
        snprintf( names + length, sizeof names - length, "%s'%.40s'", a > 0 ? ", " : "", model->animations[a].name );
    }
    return wisp_fail( error, WISP_BAD_INPUT, "%s: there is no animation '%.60s', expected one of: %s",
                      io_short_name( name ), animation, names[0] != '\0' ? names : "none" );
}

static wisp_status refuse_still( const gltf_model* model, const gltf_animation* animation, const char* name,
                                 wisp_error* error )
{
    const char* file = io_short_name( name );
    const char* node = animation->weights_count > 0 ? model->nodes[animation->weights[0].node].name : NULL;
    return node != NULL
               ? wisp_fail(
                     error, WISP_BAD_INPUT,
                     "%s: animation '%.40s' moves morph targets and no joints; expected the name of their mesh "
                     "behind #, as in %s#%.60s",
                     file, animation->name, file, node )
               : wisp_fail( error, WISP_BAD_INPUT, "%s: animation '%.40s' moves no joints", file, animation->name );
}

wisp_status gltf_rig_animation( const gltf_model* model, const char* animation, const char* name,
                                const wisp_skeleton* skeleton, wisp_animation* out, wisp_error* error )
{
    *out = ( wisp_animation ){ 0 };
    const int found = gltf_find_animation( model, animation );
    if ( found < 0 )
    {
        return refuse_name( model, animation, name, error );
    }
    const gltf_animation* from = &model->animations[found];
    if ( from->channel_count == 0 )
    {
        return refuse_still( model, from, name, error );
    }
    out->duration = (float)fmax( from->duration, 1e-3 );
    out->loops = true;
    out->name = strdup( from->name );
    out->tracks = calloc( (size_t)from->channel_count + 1, sizeof *out->tracks );
    wisp_status status = out->name != NULL && out->tracks != NULL
                             ? WISP_OK
                             : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d channels",
                                          io_short_name( name ), from->channel_count );
    for ( int c = 0; c < from->channel_count && status == WISP_OK; ++c )
    {
        const gltf_channel* channel = &from->channels[c];
        const int joint = joint_of_node( model, channel->node, skeleton );
        status = joint >= 0 ? make_track( channel, joint, &out->tracks[out->track_count++], error )
                            : wisp_fail( error, WISP_BAD_INPUT,
                                         "%s: animation '%.40s' moves '%.60s', which the skeleton "
                                         "does not have",
                                         io_short_name( name ), from->name, model->nodes[channel->node].name );
    }
    status = status == WISP_OK ? wisp_animation_check( out, skeleton, error ) : status;
    if ( status != WISP_OK )
    {
        wisp_animation_release( out );
    }
    return status;
}
