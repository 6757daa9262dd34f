// Nodes, their parents, and skins.
#include "gltf_parse.h"

#include <algorithm>

namespace gltf
{

void normalize( double* q, const string& where )
{
    const double length = std::sqrt( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] );
    if ( !( length > 1e-6 ) )
    {
        refuse( where, "the rotation is zero" );
    }
    for ( int k = 0; k < 4; ++k )
    {
        q[k] /= length;
    }
}

namespace
{

// From columns of 4 x 4 to rows of 3 x 4.
void take_matrix( const double* columns, double* rows )
{
    for ( int i = 0; i < 12; ++i )
    {
        rows[i] = columns[4 * ( i % 4 ) + i / 4];
    }
}

} // namespace

void take_node( const tinygltf::Model& model, size_t n, gltf_node* out )
{
    const tinygltf::Node& node = model.nodes[n];
    const string name = printable( node.name, "node", n ), where = "node " + to_string( n );
    out->name = copy_text( name );
    out->mesh = node.mesh;
    out->skin = node.skin;
    if ( node.mesh != -1 )
    {
        check_element( node.mesh, model.meshes.size(), where, "mesh" );
    }
    if ( node.skin != -1 )
    {
        check_element( node.skin, model.skins.size(), where, "skin" );
    }
    out->rotation[3] = out->scale[0] = out->scale[1] = out->scale[2] = 1.0;
    take_vector( node.translation, 3, out->translation, where + ": translation" );
    take_vector( node.rotation, 4, out->rotation, where + ": rotation" );
    take_vector( node.scale, 3, out->scale, where + ": scale" );
    normalize( out->rotation, where );
    if ( !node.weights.empty() )
    {
        // More than a mesh can have are of no use.
        out->weight_count = static_cast<int>( std::min( node.weights.size(), size_t{ GLTF_ELEMENT_CAP } ) );
        out->weights = allocate<double>( node.weights.size() );
        take_vector( node.weights, node.weights.size(), out->weights, where + ": weights" );
    }
    double columns[16];
    take_vector( node.matrix, 16, columns, where + ": matrix" );
    out->has_matrix = !node.matrix.empty();
    if ( out->has_matrix )
    {
        take_matrix( columns, out->matrix );
    }
}

void take_parents( const tinygltf::Model& model, gltf_model* out )
{
    for ( size_t n = 0; n < model.nodes.size(); ++n )
    {
        for ( int child : model.nodes[n].children )
        {
            check_element( child, model.nodes.size(), "node " + to_string( n ), "child" );
            if ( out->nodes[child].parent >= 0 )
            {
                refuse( "node " + to_string( child ), "it has two parents, nodes " +
                                                          to_string( out->nodes[child].parent ) + " and " +
                                                          to_string( n ) );
            }
            out->nodes[child].parent = static_cast<int>( n );
        }
    }
}

void take_skin( const tinygltf::Model& model, size_t s, gltf_skin* out )
{
    const tinygltf::Skin& skin = model.skins[s];
    const string where = "skin " + to_string( s );
    out->name = copy_text( printable( skin.name, "skin", s ) );
    if ( skin.joints.empty() || skin.joints.size() > GLTF_ELEMENT_CAP )
    {
        refuse( where, "got " + to_string( skin.joints.size() ) + " joints, expected 1 .. " +
                           to_string( GLTF_ELEMENT_CAP ) );
    }
    out->joint_count = static_cast<int>( skin.joints.size() );
    out->joints = allocate<int32_t>( skin.joints.size() );
    out->inverse_bind = allocate<double>( 12 * skin.joints.size() );
    for ( size_t j = 0; j < skin.joints.size(); ++j )
    {
        check_element( skin.joints[j], model.nodes.size(), where + ": joint " + to_string( j ), "node" );
        out->joints[j] = skin.joints[j];
        double* rows = out->inverse_bind + 12 * j;
        rows[0] = rows[5] = rows[10] = 1.0;
    }
    if ( skin.inverseBindMatrices >= 0 )
    {
        const numbers matrices = take( model, skin.inverseBindMatrices, 16, 16, where + ": inverseBindMatrices" );
        if ( matrices.count < skin.joints.size() )
        {
            refuse( where, "got " + to_string( matrices.count ) + " inverse bind matrices, expected " +
                               to_string( skin.joints.size() ) + ", one for each joint" );
        }
        for ( size_t j = 0; j < skin.joints.size(); ++j )
        {
            take_matrix( matrices.values.data() + 16 * j, out->inverse_bind + 12 * j );
        }
    }
}

} // namespace gltf
