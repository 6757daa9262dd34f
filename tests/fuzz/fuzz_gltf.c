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
