// Any bytes as a .glb or .gltf file: rejected with a message, or read, posed and described.
#include "fuzz.h"

#include "gltf.h"

static void pose( const gltf_model* model )
{
    double* work = malloc( ( gltf_pose_work( model ) + 1 ) * sizeof *work );
    demand( work != NULL );
    for ( int a = -1; a < model->animation_count; ++a )
    {
        for ( int s = 0; s < model->skin_count; ++s )
        {
            double* matrices = malloc( 12 * (size_t)model->skins[s].joint_count * sizeof *matrices );
            demand( matrices != NULL );
            gltf_pose( model, s, a, 0.4, work, matrices );
            free( matrices );
        }
    }
    free( work );
}

// Every mesh at a time of the first animation, and its last morph target alone.
static void morph( const gltf_model* model )
{
    for ( int n = 0; n < model->node_count; ++n )
    {
        if ( model->nodes[n].mesh < 0 || model->meshes[model->nodes[n].mesh].mesh.triangle_count == 0 )
        {
            continue;
        }
        const int last = model->meshes[model->nodes[n].mesh].target_count - 1;
        const gltf_moment moments[] = { { model->animation_count > 0 ? 0 : -1, 0.4, -1 }, { -1, 0.0, last } };
        for ( int i = 0; i < 2; ++i )
        {
            wisp_mesh mesh;
            const wisp_status status = gltf_mesh_at( model, n, moments[i], "fuzz", &mesh, NULL );
            demand( status == WISP_OK || status == WISP_BAD_INPUT );
            wisp_mesh_release( &mesh );
        }
    }
}

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size )
{
    gltf_model model;
    wisp_error error = { .status = WISP_OK };
    const wisp_status status = gltf_read_bytes( data, size, NULL, "fuzz.glb", 0, &model, &error );
    if ( status != WISP_OK )
    {
        demand_refusal( status, &error );
        demand( model.nodes == NULL && model.meshes == NULL );
        return 0;
    }
    pose( &model );
    morph( &model );
    char* text = NULL;
    size_t length = 0;
    FILE* stream = open_memstream( &text, &length );
    demand( stream != NULL );
    // Finite transforms may overflow when they are multiplied, which is then what the description says.
    const wisp_status described = gltf_info( stream, &model, "fuzz.glb" );
    demand( described == WISP_OK || described == WISP_BAD_INPUT );
    fclose( stream );
    free( text );
    gltf_release( &model );
    return 0;
}
