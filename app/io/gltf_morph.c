// Meshes at a moment: morph targets and their weights over time, and what a path asks for.
#include "gltf_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io_file.h"
#include "mesh_internal.h"

#include "wisp/module/definition.h"

// ---- weights ---------------------------------------------------------------------------------------------------

void gltf_weights_at( const gltf_model* model, int node, gltf_moment moment, double* out )
{
    const gltf_node* n = &model->nodes[node];
    const gltf_mesh* mesh = &model->meshes[n->mesh];
    for ( int t = 0; t < mesh->target_count; ++t )
    {
        out[t] = moment.target >= 0    ? ( t == moment.target ? 1.0 : 0.0 )
                 : t < n->weight_count ? n->weights[t]
                                       : mesh->weights_at_rest[t];
    }
    const gltf_animation* animation = moment.animation >= 0 ? &model->animations[moment.animation] : NULL;
    for ( int w = 0; animation != NULL && moment.target < 0 && w < animation->weights_count; ++w )
    {
        if ( animation->weights[w].node == node )
        {
            gltf_sample( &animation->weights[w], moment.time, out );
        }
    }
}

// Whether the target alone has a weight at a key.
static bool is_alone( const gltf_channel* from, int key, int target )
{
    const size_t rows = from->interpolation == GLTF_CUBICSPLINE ? 3 : 1;
    const double* values = from->values + (size_t)from->width * ( rows * (size_t)key + rows / 2 );
    bool is = values[target] == 1.0;
    for ( int t = 0; t < from->width && is; ++t )
    {
        is = t == target || values[t] == 0.0;
    }
    return is;
}

double gltf_target_time( const gltf_model* model, int node, int animation, int target )
{
    const gltf_animation* a = &model->animations[animation];
    for ( int w = 0; w < a->weights_count; ++w )
    {
        for ( int key = 0; a->weights[w].node == node && key < a->weights[w].key_count; ++key )
        {
            if ( is_alone( &a->weights[w], key, target ) )
            {
                return a->weights[w].times[key];
            }
        }
    }
    return -1.0;
}

// ---- meshes ----------------------------------------------------------------------------------------------------

static void add_scaled( const double m[12], double weight, const double p[3], double sum[3] )
{
    const double x = p[0], y = p[1], z = p[2];
    for ( int row = 0; row < 3; ++row )
    {
        const double* r = m + 4 * row;
        sum[row] += weight * ( r[0] * x + r[1] * y + r[2] * z + r[3] );
    }
}

// A vertex and its displacements, which are added in double precision.
static void morph( const gltf_mesh* mesh, const double* weights, int v, double p[3] )
{
    const wisp_vec3 base = mesh->mesh.points[v];
    p[0] = (double)base.x;
    p[1] = (double)base.y;
    p[2] = (double)base.z;
    for ( int t = 0; t < mesh->target_count; ++t )
    {
        const float* d = mesh->targets + 3 * ( (size_t)t * (size_t)mesh->mesh.vertex_count + (size_t)v );
        for ( int k = 0; k < 3 && weights[t] != 0.0; ++k )
        {
            p[k] += weights[t] * (double)d[k];
        }
    }
}

size_t gltf_points_work( const gltf_model* model, int node )
{
    const gltf_mesh* mesh = &model->meshes[model->nodes[node].mesh];
    const int skin = model->nodes[node].skin;
    return gltf_pose_work( model ) + (size_t)mesh->target_count +
           ( skin >= 0 ? 12 * (size_t)model->skins[skin].joint_count : 0 );
}

// A skin alone places its mesh (glTF 2.0, section 3.7.3.3), else the node does.
void gltf_points_at( const gltf_model* model, int n, gltf_moment moment, double* work, wisp_vec3* out )
{
    const gltf_node* node = &model->nodes[n];
    const gltf_mesh* mesh = &model->meshes[node->mesh];
    const bool is_skinned = node->skin >= 0 && mesh->joints != NULL;
    double *weights = work + gltf_pose_work( model ), *matrices = weights + mesh->target_count;
    const double* global = gltf_pose_nodes( model, moment.animation, moment.time, work ) + 12 * (size_t)n;
    gltf_weights_at( model, n, moment, weights );
    if ( is_skinned )
    {
        gltf_pose( model, node->skin, moment.animation, moment.time, work, matrices );
    }
    for ( int v = 0; v < mesh->mesh.vertex_count; ++v )
    {
        double from[3], p[3] = { 0.0, 0.0, 0.0 };
        morph( mesh, weights, v, from );
        for ( int k = 0; k < ( is_skinned ? 4 : 1 ); ++k )
        {
            const size_t i = 4 * (size_t)v + (size_t)k;
            add_scaled( is_skinned ? matrices + 12 * mesh->joints[i] : global,
                        is_skinned ? (double)mesh->weights[i] : 1.0, from, p );
        }
        out[v] = ( wisp_vec3 ){ (float)p[0], (float)p[1], (float)p[2] };
    }
}

wisp_status gltf_mesh_at( const gltf_model* model, int node, gltf_moment moment, const char* name, wisp_mesh* out,
                          wisp_error* error )
{
    *out = ( wisp_mesh ){ 0 };
    double* work = malloc( gltf_points_work( model, node ) * sizeof *work );
    wisp_status status = work != NULL ? mesh_copy( &model->meshes[model->nodes[node].mesh].mesh, out, name, error )
                                      : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d nodes",
                                                   io_short_name( name ), model->node_count );
    if ( status == WISP_OK )
    {
        gltf_points_at( model, node, moment, work, out->points );
        status = mesh_check( out, name, error );
    }
    if ( status != WISP_OK )
    {
        wisp_mesh_release( out );
    }
    free( work );
    return status;
}

wisp_status gltf_mesh_at_rest( const gltf_model* model, int node, const char* name, wisp_mesh* out,
                               wisp_error* error )
{
    return gltf_mesh_at( model, node, ( gltf_moment ){ -1, 0.0, -1 }, name, out, error );
}

// ---- paths -----------------------------------------------------------------------------------------------------

static wisp_status find_target( const gltf_mesh* mesh, const char* wanted, const char* name, int* target,
                                wisp_error* error )
{
    for ( int t = 0; t < mesh->target_count; ++t )
    {
        if ( strcmp( mesh->target_names[t], wanted ) == 0 )
        {
            *target = t;
            return WISP_OK;
        }
    }
    return mesh->target_count == 0
               ? wisp_fail( error, WISP_BAD_INPUT,
                            "%s: mesh '%.60s' has no morph targets, got '%.60s' behind @, expected a time in s", name,
                            mesh->name, wanted )
               : wisp_fail( error, WISP_BAD_INPUT,
                            "%s: got '%.60s' behind @, expected a time in s or one of the %d morph targets '%.60s' "
                            ".. '%.60s'",
                            name, wanted, mesh->target_count, mesh->target_names[0],
                            mesh->target_names[mesh->target_count - 1] );
}

// A time, or the name of a morph target.
static wisp_status read_moment( const gltf_model* model, int node, const char* text, const char* name,
                                gltf_moment* moment, wisp_error* error )
{
    const mesh_word word = { text, strlen( text ) };
    double time = -1.0;
    if ( mesh_word_is_number( word ) && word.length <= MESH_WORD_LONGEST && text[0] != '-' )
    {
        io_numbers numbers;
        WISP_TRY( io_numbers_begin( &numbers, error ) );
        time = mesh_word_value( word );
        io_numbers_end( &numbers );
    }
    if ( !( time >= 0.0 && time < INFINITY ) )
    {
        return find_target( &model->meshes[model->nodes[node].mesh], text, name, &moment->target, error );
    }
    moment->animation = 0;
    moment->time = time;
    return model->animation_count > 0
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "%s: got the time %.20s s behind @, but the file has no animation",
                            name, text );
}

// A name may have an @ of its own: then it is all of it.
static bool is_a_name( const gltf_model* model, const char* text )
{
    bool is = false;
    for ( int n = 0; n < model->node_count; ++n )
    {
        const int mesh = model->nodes[n].mesh;
        is = is || ( mesh >= 0 &&
                     ( strcmp( model->nodes[n].name, text ) == 0 || strcmp( model->meshes[mesh].name, text ) == 0 ) );
    }
    return is;
}

// @param wanted what is behind #, which is cut
static wisp_status take_mesh( const gltf_model* model, char* wanted, const char* file, const char* path,
                              wisp_mesh* out, wisp_error* error )
{
    char* at = wanted != NULL && !is_a_name( model, wanted ) ? strrchr( wanted, '@' ) : NULL;
    if ( at != NULL )
    {
        *at++ = '\0';
    }
    const char* node_name = wanted != NULL && ( wanted[0] != '\0' || at == NULL ) ? wanted : NULL;
    gltf_moment moment = { -1, 0.0, -1 };
    int node = -1;
    wisp_status status = gltf_find_mesh( model, node_name, file, &node, error );
    if ( status == WISP_OK && at != NULL )
    {
        status = read_moment( model, node, at, io_short_name( file ), &moment, error );
    }
    return status == WISP_OK ? gltf_mesh_at( model, node, moment, path, out, error ) : status;
}

wisp_status gltf_mesh_read( const char* path, wisp_mesh* out, wisp_error* error )
{
    *out = ( wisp_mesh ){ 0 };
    gltf_model model = { 0 };
    char* file = strdup( path );
    if ( file == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory", io_short_name( path ) );
    }
    char* hash = strrchr( file, '#' );
    if ( hash != NULL )
    {
        *hash++ = '\0';
    }
    wisp_status status = gltf_read( file, 0, &model, error );
    status = status == WISP_OK ? take_mesh( &model, hash, file, path, out, error ) : status;
    gltf_release( &model );
    free( file );
    return status;
}
