// The text of `wisp info` for a glTF file.
#include "gltf_internal.h"

#include <stdlib.h>

#include "io_file.h"

static void print_mesh_stats( FILE* out, const gltf_mesh* mesh )
{
    if ( mesh->skipped_count > 0 )
    {
        fprintf( out, "  note: primitives of points or lines, which are skipped: %d\n", mesh->skipped_count );
    }
    if ( mesh->merged_count > 0 )
    {
        fprintf( out, "  note: vertices of equal position and weights, merged: %d\n", mesh->merged_count );
    }
    if ( mesh->dropped_influence_count > 0 )
    {
        fprintf( out, "  note: vertices with more than four weights, of which the largest are kept: %d\n",
                 mesh->dropped_influence_count );
    }
}

static void print_skins( FILE* out, const gltf_model* model )
{
    for ( int s = 0; s < model->skin_count; ++s )
    {
        const gltf_skin* skin = &model->skins[s];
        fprintf( out, "skin %s: %d joints\n", skin->name, skin->joint_count );
        for ( int j = 0; j < skin->joint_count; ++j )
        {
            const int node = skin->joints[j], parent = model->nodes[node].parent;
            fprintf( out, "  joint %d: %s%s%s\n", j, model->nodes[node].name, parent >= 0 ? ", under " : "",
                     parent >= 0 ? model->nodes[parent].name : "" );
        }
    }
}

static void print_animations( FILE* out, const gltf_model* model )
{
    for ( int a = 0; a < model->animation_count; ++a )
    {
        const gltf_animation* animation = &model->animations[a];
        fprintf( out, "animation %s: %.6g s, %d channels\n", animation->name, animation->duration,
                 animation->channel_count + animation->weights_count );
        if ( animation->skipped_count > 0 )
        {
            fprintf( out,
                     "  note: channels without a node, or of weights without morph targets, which are skipped: %d\n",
                     animation->skipped_count );
        }
    }
}

// Morph targets, and when the first animation shows each of them alone: the frames of a recording.
static void print_targets( FILE* out, const gltf_model* model, int n )
{
    const gltf_mesh* mesh = &model->meshes[model->nodes[n].mesh];
    if ( mesh->target_count > 0 )
    {
        fprintf( out, "  morph targets: %d\n", mesh->target_count );
    }
    for ( int t = 0; t < mesh->target_count && t < WISP_MESH_LISTED; ++t )
    {
        const double time = model->animation_count > 0 ? gltf_target_time( model, n, 0, t ) : -1.0;
        fprintf( out, "    target %d, %s", t, mesh->target_names[t] );
        if ( time >= 0.0 )
        {
            fprintf( out, ", at %.6g s", time );
        }
        fputc( '\n', out );
    }
    if ( mesh->target_count > WISP_MESH_LISTED )
    {
        fprintf( out, "    and %d more\n", mesh->target_count - WISP_MESH_LISTED );
    }
}

static wisp_status print_node( FILE* out, const gltf_model* model, int n, const char* name )
{
    const gltf_node* node = &model->nodes[n];
    const gltf_mesh* mesh = &model->meshes[node->mesh];
    char title[400];
    snprintf( title, sizeof title, "%s#%s", name, node->name );
    if ( mesh->mesh.triangle_count == 0 )
    {
        fprintf( out, "%s: no triangles\n", title );
        print_mesh_stats( out, mesh );
        return WISP_OK;
    }
    wisp_mesh placed;
    wisp_error error = { .status = WISP_OK };
    wisp_status status = gltf_mesh_at_rest( model, n, name, &placed, &error );
    if ( status != WISP_OK )
    {
        fprintf( out, "%s: %s\n", title, error.message );
        return status;
    }
    status = wisp_mesh_info( out, &placed, title );
    wisp_mesh_release( &placed );
    fprintf( out, "  mesh %s of %d %s", mesh->name, mesh->primitive_count,
             mesh->primitive_count == 1 ? "primitive" : "primitives" );
    fprintf( out, node->skin >= 0 ? ", skin %s\n" : "\n", node->skin >= 0 ? model->skins[node->skin].name : "" );
    print_targets( out, model, n );
    print_mesh_stats( out, mesh );
    return status;
}

wisp_status gltf_info( FILE* out, const gltf_model* model, const char* name )
{
    io_numbers numbers = { 0 };
    const wisp_status plain = io_numbers_begin( &numbers, NULL );
    fprintf( out, "%s: glTF, %d nodes, %d meshes, %d skins, %d animations\n", name, model->node_count,
             model->mesh_count, model->skin_count, model->animation_count );
    print_skins( out, model );
    print_animations( out, model );
    wisp_status status = WISP_OK;
    for ( int n = 0; n < model->node_count && status == WISP_OK; ++n )
    {
        status = model->nodes[n].mesh >= 0 ? print_node( out, model, n, name ) : WISP_OK;
    }
    if ( plain == WISP_OK )
    {
        io_numbers_end( &numbers );
    }
    return status;
}
