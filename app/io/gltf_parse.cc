// glTF files through tinygltf: their elements, all numbers checked. What is wrong is thrown as std::runtime_error, and no
// exception leaves this file: its callers are C. The library is linked where the system has it, and else compiled in here.
#ifdef WISP_COMPILE_TINYGLTF
// The library uses both without including them.
#include <fstream>
#include <sstream>

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#define TINYGLTF_IMPLEMENTATION
#endif
#include <tiny_gltf.h>

#include "gltf_internal.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{

using std::string;
using std::to_string;

// ---- messages and memory ---------------------------------------------------------------------------------------

[[noreturn]] void refuse( const string& where, const string& what )
{
    throw std::runtime_error( where + ": " + what );
}

// A name of the file without control characters, which would reach a terminal.
string printable( const string& name, const char* kind, size_t index, size_t most = 64 )
{
    string clean = name.substr( 0, most );
    for ( char& c : clean )
    {
        c = static_cast<unsigned char>( c ) < ' ' || c == 127 ? '?' : c;
    }
    return clean.empty() ? string( kind ) + " " + to_string( index ) : clean;
}

template <typename T> T* allocate( io_memory* memory, size_t count )
{
    T* block = static_cast<T*>( io_get( memory, count * sizeof( T ) ) );
    if ( block == nullptr )
    {
        throw std::bad_alloc();
    }
    return block;
}

template <typename T> T* copy( io_memory* memory, const std::vector<T>& from )
{
    T* to = allocate<T>( memory, from.size() );
    std::copy( from.begin(), from.end(), to );
    return to;
}

wisp_vec3* copy_vectors( io_memory* memory, const std::vector<float>& from )
{
    return reinterpret_cast<wisp_vec3*>( copy( memory, from ) );
}

char* copy( io_memory* memory, const string& text )
{
    return copy( memory, std::vector<char>( text.c_str(), text.c_str() + text.size() + 1 ) );
}

void check_element( int index, size_t count, const string& where, const char* kind )
{
    if ( index < 0 || static_cast<size_t>( index ) >= count )
    {
        refuse( where, string( "got " ) + kind + " " + to_string( index ) + ", the file has " + to_string( count ) );
    }
}

template <typename T> const T& element( const std::vector<T>& all, int index, const string& where, const char* kind )
{
    check_element( index, all.size(), where, kind );
    return all[static_cast<size_t>( index )];
}

// ---- values of accessors, dense and sparse ---------------------------------------------------------------------

struct items
{
    const unsigned char* first;
    size_t stride; // bytes from one to the next
};

// Items of a buffer view, which must lie in it and that in its buffer. Sparse ones are packed, and may be none.
items find_items( const tinygltf::Model& model, int view_index, size_t offset, size_t count, size_t size,
                  bool is_sparse, const string& where )
{
    const tinygltf::BufferView& view = element( model.bufferViews, view_index, where, "buffer view" );
    const std::vector<unsigned char>& bytes = element( model.buffers, view.buffer, where, "buffer" ).data;
    const size_t stride = view.byteStride > 0 && !is_sparse ? view.byteStride : size;
    const bool has_view = view.byteOffset <= bytes.size() && view.byteLength <= bytes.size() - view.byteOffset &&
                          offset <= view.byteLength && stride >= size && stride <= 65536;
    const size_t length = has_view ? view.byteLength - offset : 0;
    const bool fits = count == 0 ? is_sparse : size <= length && count - 1 <= ( length - size ) / stride;
    if ( !has_view || !fits )
    {
        refuse( where, "its " + to_string( count ) + ( is_sparse ? " sparse" : "" ) +
                           " values are not within the bytes of the file" );
    }
    return { bytes.data() + view.byteOffset + offset, stride };
}

struct numbers
{
    size_t count;
    size_t width;
    std::vector<double> values; // [count][width]
};

numbers take( const tinygltf::Model& model, int index, size_t least_width, size_t most_width, const string& where )
{
    const tinygltf::Accessor& a = element( model.accessors, index, where, "accessor" );
    const string place = where + ": accessor " + to_string( index );
    const int width =
        a.type == TINYGLTF_TYPE_SCALAR ? 1 : tinygltf::GetNumComponentsInType( static_cast<uint32_t>( a.type ) );
    const size_t size = gltf_component_size( a.componentType );
    if ( width < static_cast<int>( least_width ) || width > static_cast<int>( most_width ) || size == 0 )
    {
        refuse( place, "got values of " + to_string( width ) + " numbers of type " + to_string( a.componentType ) +
                           ", expected " + to_string( least_width ) +
                           ( most_width > least_width ? " .. " + to_string( most_width ) : string() ) );
    }
    if ( a.sparse.isSparse || a.bufferView < 0 )
    {
        refuse( place, a.sparse.isSparse ? "sparse values are not read" : "it has no buffer view" );
    }
    numbers out{ a.count, static_cast<size_t>( width ), {} };
    const items from = find_items( model, a.bufferView, a.byteOffset, a.count, out.width * size, false, place );
    out.values.resize( out.count * out.width );
    for ( size_t i = 0; i < out.values.size(); ++i )
    {
        const unsigned char* at = from.first + i / out.width * from.stride + i % out.width * size;
        const double value = gltf_component( at, a.componentType, a.normalized );
        if ( !std::isfinite( value ) )
        {
            refuse( place,
                    "value " + to_string( i / out.width ) + " is " + ( std::isnan( value ) ? "NaN" : "infinite" ) );
        }
        out.values[i] = value;
    }
    return out;
}

// Displacements of a morph target, which are often sparse: only vertices that move are in the file.
std::vector<double> take_displacements( const tinygltf::Model& model, int index, size_t count, const string& where )
{
    const tinygltf::Accessor& a = element( model.accessors, index, where, "accessor" );
    const string place = where + ": accessor " + to_string( index );
    if ( a.count != count )
    {
        refuse( place,
                "got " + to_string( a.count ) + " values, expected " + to_string( count ) + ", one for each vertex" );
    }
    if ( !a.sparse.isSparse )
    {
        return take( model, index, 3, 3, where ).values;
    }
    if ( a.bufferView >= 0 || a.type != TINYGLTF_TYPE_VEC3 || a.sparse.count < 0 )
    {
        refuse( place, "sparse values are read of three numbers, without others below" );
    }
    const size_t given = static_cast<size_t>( a.sparse.count );
    const int index_type = a.sparse.indices.componentType, type = a.componentType;
    const bool is_index = index_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                          index_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                          index_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    const size_t size = gltf_component_size( type );
    if ( !is_index || size == 0 || given > count )
    {
        refuse( place, "got sparse values of type " + to_string( type ) + " and indices of type " +
                           to_string( index_type ) );
    }
    const auto find = [&]( int view, int offset, size_t item )
    { return find_items( model, view, static_cast<size_t>( offset ), given, item, true, place ); };
    const items indices =
        find( a.sparse.indices.bufferView, a.sparse.indices.byteOffset, gltf_component_size( index_type ) );
    const items values = find( a.sparse.values.bufferView, a.sparse.values.byteOffset, 3 * size );
    std::vector<double> out( 3 * count, 0.0 );
    for ( size_t i = 0; i < given; ++i )
    {
        const double vertex = gltf_component( indices.first + i * indices.stride, index_type, false );
        if ( !( vertex < static_cast<double>( count ) ) )
        {
            refuse( place, "sparse value " + to_string( i ) + " is of a vertex that the mesh does not have" );
        }
        for ( size_t k = 0; k < 3; ++k )
        {
            const double value = gltf_component( values.first + i * values.stride + k * size, type, a.normalized );
            if ( !std::isfinite( value ) )
            {
                refuse( place, "sparse value " + to_string( i ) + " is not finite" );
            }
            out[3 * static_cast<size_t>( vertex ) + k] = value;
        }
    }
    return out;
}

std::vector<float> to_floats( const std::vector<double>& values )
{
    std::vector<float> floats;
    for ( double value : values )
    {
        floats.push_back( static_cast<float>( value ) );
    }
    return floats;
}

void append( std::vector<float>* to, const std::vector<float>& more )
{
    to->insert( to->end(), more.begin(), more.end() );
}

// Numbers of a node or mesh, none or `count`.
void take_vector( const std::vector<double>& from, size_t count, double* to, const string& where )
{
    if ( !from.empty() && from.size() != count )
    {
        refuse( where, "got " + to_string( from.size() ) + " numbers, expected " + to_string( count ) );
    }
    for ( size_t k = 0; k < from.size(); ++k )
    {
        if ( !( std::fabs( from[k] ) <= static_cast<double>( FLT_MAX ) ) )
        {
            refuse( where, "a number is not finite in single precision" );
        }
        to[k] = from[k];
    }
}

// ---- nodes and skins -------------------------------------------------------------------------------------------

void normalize( double* q, const string& where )
{
    if ( !gltf_normalize( q ) )
    {
        refuse( where, "the rotation is zero" );
    }
}

// From columns of 4 x 4 to rows of 3 x 4.
void take_matrix( const double* columns, double* rows )
{
    for ( int i = 0; i < 12; ++i )
    {
        rows[i] = columns[4 * ( i % 4 ) + i / 4];
    }
}

void take_node( const tinygltf::Model& model, size_t n, io_memory* memory, gltf_node* out )
{
    const tinygltf::Node& node = model.nodes[n];
    const string where = "node " + to_string( n );
    out->name = copy( memory, printable( node.name, "node", n ) );
    out->parent = -1;
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
        out->weights = allocate<double>( memory, node.weights.size() );
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

void take_skin( const tinygltf::Model& model, size_t s, io_memory* memory, gltf_skin* out )
{
    const tinygltf::Skin& skin = model.skins[s];
    const string where = "skin " + to_string( s );
    out->name = copy( memory, printable( skin.name, "skin", s ) );
    if ( skin.joints.empty() || skin.joints.size() > GLTF_ELEMENT_CAP )
    {
        refuse( where, "got " + to_string( skin.joints.size() ) + " joints, expected 1 .. " +
                           to_string( GLTF_ELEMENT_CAP ) );
    }
    out->joint_count = static_cast<int>( skin.joints.size() );
    out->joints = allocate<int32_t>( memory, skin.joints.size() );
    out->inverse_bind = allocate<double>( memory, 12 * skin.joints.size() );
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

// ---- meshes, whose primitives are joined -----------------------------------------------------------------------

// A mesh while its primitives are joined.
struct joined
{
    std::vector<float> points, colours, uvs, weights;
    std::vector<std::vector<float>> targets; // displacements, of each morph target
    std::vector<int32_t> triangles, joints;
    size_t colour_count = 0, uv_count = 0;
    int skinned = 0, plain = 0; // primitives
};

int find( const tinygltf::Primitive& primitive, const string& attribute )
{
    const auto found = primitive.attributes.find( attribute );
    return found == primitive.attributes.end() ? -1 : found->second;
}

numbers take_attribute( const tinygltf::Model& model, const tinygltf::Primitive& primitive, const string& attribute,
                        size_t least, size_t most, size_t count, const string& where )
{
    const string place = where + ": " + attribute;
    numbers values = take( model, find( primitive, attribute ), least, most, place );
    if ( count > 0 && values.count != count )
    {
        refuse( place, "got " + to_string( values.count ) + " values, expected " + to_string( count ) +
                           ", one for each vertex" );
    }
    return values;
}

// The four largest of up to eight weights, divided by their sum.
void take_weights( const tinygltf::Model& model, const tinygltf::Primitive& primitive, size_t count,
                   const string& where, joined* out, gltf_mesh* mesh )
{
    std::vector<numbers> joints, weights;
    for ( const string set : { "_0", "_1" } )
    {
        if ( find( primitive, "JOINTS" + set ) >= 0 && find( primitive, "WEIGHTS" + set ) >= 0 )
        {
            joints.push_back( take_attribute( model, primitive, "JOINTS" + set, 4, 4, count, where ) );
            weights.push_back( take_attribute( model, primitive, "WEIGHTS" + set, 4, 4, count, where ) );
        }
    }
    for ( size_t v = 0; v < count; ++v )
    {
        std::vector<std::pair<double, int32_t>> all;
        for ( size_t k = 0; k < 4 * joints.size(); ++k )
        {
            const double weight = weights[k / 4].values[4 * v + k % 4], joint = joints[k / 4].values[4 * v + k % 4];
            if ( weight < 0.0 || joint < 0.0 || joint != std::floor( joint ) || joint >= GLTF_ELEMENT_CAP )
            {
                refuse( where + ": vertex " + to_string( v ),
                        weight < 0.0 ? "a weight is negative" : "a joint is not an index" );
            }
            all.emplace_back( weight, weight > 0.0 ? static_cast<int32_t>( joint ) : 0 );
        }
        std::stable_sort( all.begin(), all.end(), []( const auto& a, const auto& b ) { return a.first > b.first; } );
        const double sum = all[0].first + all[1].first + all[2].first + all[3].first;
        if ( !( sum > 1e-6 ) )
        {
            refuse( where + ": vertex " + to_string( v ), "its weights sum to 0" );
        }
        mesh->dropped_influence_count += all.size() > 4 && all[4].first > 0.0;
        for ( size_t k = 0; k < 4; ++k )
        {
            out->joints.push_back( all[k].second );
            out->weights.push_back( static_cast<float>( all[k].first / sum ) );
        }
    }
}

void take_triangles( const tinygltf::Model& model, const tinygltf::Primitive& primitive, size_t count,
                     const string& where, joined* out )
{
    std::vector<int32_t> corners;
    const size_t base = out->points.size() / 3 - count;
    if ( primitive.indices >= 0 )
    {
        const numbers indices = take( model, primitive.indices, 1, 1, where + ": indices" );
        for ( size_t i = 0; i < indices.count; ++i )
        {
            const double index = indices.values[i];
            if ( !( index >= 0.0 && index < static_cast<double>( count ) ) || index != std::floor( index ) )
            {
                refuse( where, "index " + to_string( i ) + ": got vertex " +
                                   to_string( static_cast<long long>( index ) ) + ", expected 0 .. " +
                                   to_string( count - 1 ) );
            }
            corners.push_back( static_cast<int32_t>( base + static_cast<size_t>( index ) ) );
        }
    }
    for ( size_t i = 0; primitive.indices < 0 && i < count; ++i )
    {
        corners.push_back( static_cast<int32_t>( base + i ) );
    }
    const bool is_list =
        primitive.mode != TINYGLTF_MODE_TRIANGLE_STRIP && primitive.mode != TINYGLTF_MODE_TRIANGLE_FAN;
    if ( corners.size() < 3 || ( is_list && corners.size() % 3 != 0 ) )
    {
        refuse( where, "got " + to_string( corners.size() ) + " corners, expected those of triangles" );
    }
    for ( size_t i = 0; i + 2 < corners.size(); i += is_list ? 3 : 1 )
    {
        const bool swap = primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2 == 1;
        const bool fan = primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
        out->triangles.push_back( fan ? corners[0] : corners[swap ? i + 1 : i] );
        out->triangles.push_back( corners[swap ? i : i + 1] );
        out->triangles.push_back( corners[i + 2] );
    }
}

// Each primitive of a mesh has the same morph targets.
void take_targets( const tinygltf::Model& model, const tinygltf::Primitive& primitive, size_t count,
                   const string& where, size_t* left, joined* out )
{
    const bool is_first = out->points.size() == 3 * count;
    if ( primitive.targets.size() > GLTF_ELEMENT_CAP ||
         ( !is_first && primitive.targets.size() != out->targets.size() ) )
    {
        refuse( where, "got " + to_string( primitive.targets.size() ) + " morph targets, expected " +
                           ( is_first ? "at most " + to_string( GLTF_ELEMENT_CAP )
                                      : to_string( out->targets.size() ) + " as of the primitive before" ) );
    }
    out->targets.resize( primitive.targets.size() );
    for ( size_t t = 0; t < primitive.targets.size(); ++t )
    {
        if ( count > *left )
        {
            refuse( where, "its " + to_string( primitive.targets.size() ) +
                               " morph targets are the same bytes again and again" );
        }
        *left -= count;
        const auto found = primitive.targets[t].find( "POSITION" );
        const std::vector<float> values =
            found != primitive.targets[t].end()
                ? to_floats( take_displacements( model, found->second, count, where + ": target " + to_string( t ) ) )
                : std::vector<float>( 3 * count, 0.0f );
        append( &out->targets[t], values );
    }
}

void take_primitive( const tinygltf::Model& model, const tinygltf::Primitive& primitive, const string& where,
                     size_t* left, joined* out, gltf_mesh* mesh )
{
    const numbers points = take_attribute( model, primitive, "POSITION", 3, 3, 0, where );
    const size_t count = points.count, before = out->points.size() / 3;
    if ( before + count > WISP_MESH_VERTEX_CAP )
    {
        refuse( where, "expected at most " + to_string( WISP_MESH_VERTEX_CAP ) + " vertices" );
    }
    append( &out->points, to_floats( points.values ) );
    out->colours.resize( 3 * ( before + count ), 1.0f );
    out->uvs.resize( 2 * ( before + count ), 0.0f );
    if ( find( primitive, "COLOR_0" ) >= 0 )
    {
        const numbers c = take_attribute( model, primitive, "COLOR_0", 3, 4, count, where );
        out->colour_count += count;
        for ( size_t i = 0; i < 3 * count; ++i )
        {
            out->colours[3 * before + i] = static_cast<float>( c.values[i / 3 * c.width + i % 3] );
        }
    }
    if ( find( primitive, "TEXCOORD_0" ) >= 0 )
    {
        const numbers uv = take_attribute( model, primitive, "TEXCOORD_0", 2, 2, count, where );
        out->uv_count += count;
        for ( size_t v = 0; v < count; ++v )
        {
            // The origin of glTF is the upper left.
            out->uvs[2 * ( before + v )] = static_cast<float>( uv.values[2 * v] );
            out->uvs[2 * ( before + v ) + 1] = static_cast<float>( 1.0 - uv.values[2 * v + 1] );
        }
    }
    const bool is_skinned = find( primitive, "JOINTS_0" ) >= 0 && find( primitive, "WEIGHTS_0" ) >= 0;
    ( is_skinned ? out->skinned : out->plain ) += 1;
    if ( out->skinned > 0 && out->plain > 0 )
    {
        refuse( where, string( "it has " ) + ( is_skinned ? "" : "no " ) + "weights, unlike the primitives before" );
    }
    if ( is_skinned )
    {
        take_weights( model, primitive, count, where, out, mesh );
    }
    take_targets( model, primitive, count, where, left, out );
    take_triangles( model, primitive, count, where, out );
}

// Names are in no part of the standard, but everywhere.
string target_name( const tinygltf::Mesh& mesh, size_t t )
{
    const tinygltf::Value none;
    const tinygltf::Value& names = mesh.extras.IsObject() ? mesh.extras.Get( "targetNames" ) : none;
    const tinygltf::Value& name = names.IsArray() ? names.Get( static_cast<int>( t ) ) : none;
    return printable( name.IsString() ? name.Get<string>() : string(), "target", t );
}

void copy_targets( const tinygltf::Mesh& mesh, const joined& all, const string& where, io_memory* memory,
                   gltf_mesh* out )
{
    const size_t count = all.targets.size(), numbers_each = all.points.size();
    if ( count == 0 )
    {
        return;
    }
    out->target_names = allocate<char*>( memory, count );
    out->targets = allocate<float>( memory, count * numbers_each );
    out->weights_at_rest = allocate<double>( memory, count );
    out->target_count = static_cast<int>( count );
    for ( size_t t = 0; t < count; ++t )
    {
        out->target_names[t] = copy( memory, target_name( mesh, t ) );
        std::memcpy( out->targets + t * numbers_each, all.targets[t].data(), numbers_each * sizeof( float ) );
    }
    if ( !mesh.weights.empty() )
    {
        take_vector( mesh.weights, count, out->weights_at_rest, where + ": weights" );
    }
}

void take_mesh( const tinygltf::Model& model, size_t m, size_t* left, io_memory* memory, gltf_mesh* out )
{
    const tinygltf::Mesh& mesh = model.meshes[m];
    joined all;
    out->name = copy( memory, printable( mesh.name, "mesh", m ) );
    for ( size_t p = 0; p < mesh.primitives.size(); ++p )
    {
        const tinygltf::Primitive& primitive = mesh.primitives[p];
        if ( primitive.mode >= TINYGLTF_MODE_POINTS && primitive.mode <= TINYGLTF_MODE_LINE_STRIP )
        {
            ++out->skipped_count;
            continue;
        }
        take_primitive( model, primitive, "mesh " + to_string( m ) + ": primitive " + to_string( p ), left, &all,
                        out );
        ++out->primitive_count;
    }
    if ( all.triangles.size() / 3 > WISP_MESH_TRIANGLE_CAP )
    {
        refuse( "mesh " + to_string( m ), "expected at most " + to_string( WISP_MESH_TRIANGLE_CAP ) + " triangles" );
    }
    if ( all.points.empty() )
    {
        return;
    }
    const size_t count = all.points.size() / 3;
    out->mesh.vertex_count = static_cast<int>( count );
    out->mesh.triangle_count = static_cast<int>( all.triangles.size() / 3 );
    out->mesh.points = copy_vectors( memory, all.points );
    out->mesh.triangles = copy( memory, all.triangles );
    out->mesh.colours = all.colour_count > 0 ? copy_vectors( memory, all.colours ) : nullptr;
    out->mesh.uvs = all.uv_count > 0 ? copy( memory, all.uvs ) : nullptr;
    out->mesh.colour_missing_count = all.colour_count > 0 ? static_cast<int>( count - all.colour_count ) : 0;
    out->mesh.uv_missing_count = all.uv_count > 0 ? static_cast<int>( count - all.uv_count ) : 0;
    out->joints = all.skinned > 0 ? copy( memory, all.joints ) : nullptr;
    out->weights = all.skinned > 0 ? copy( memory, all.weights ) : nullptr;
    copy_targets( mesh, all, "mesh " + to_string( m ), memory, out );
}

// ---- animations of nodes and of weights of morph targets -------------------------------------------------------

gltf_interpolation take_interpolation( const string& kind, const string& where )
{
    if ( kind != "STEP" && kind != "LINEAR" && kind != "CUBICSPLINE" )
    {
        refuse( where,
                "got the interpolation " + printable( kind, "", 0 ) + ", expected STEP, LINEAR or CUBICSPLINE" );
    }
    return kind == "STEP" ? GLTF_STEP : kind == "LINEAR" ? GLTF_LINEAR : GLTF_CUBICSPLINE;
}

struct keys
{
    gltf_interpolation interpolation;
    size_t rows; // of values for a key
    numbers times, values;
};

keys take_keys( const tinygltf::Model& model, const tinygltf::AnimationSampler& sampler, size_t width,
                const string& where )
{
    const gltf_interpolation interpolation = take_interpolation( sampler.interpolation, where );
    keys out{ interpolation, interpolation == GLTF_CUBICSPLINE ? size_t{ 3 } : size_t{ 1 },
              take( model, sampler.input, 1, 1, where + ": times" ),
              take( model, sampler.output, width, width, where + ": values" ) };
    const std::vector<double>& times = out.times.values;
    for ( size_t k = 0; k < times.size(); ++k )
    {
        if ( times[k] < 0.0 || ( k > 0 && times[k] <= times[k - 1] ) )
        {
            refuse( where,
                    "key " + to_string( k ) + " at " + to_string( times[k] ) + " s is not after the one before" );
        }
    }
    return out;
}

bool take_channel( const tinygltf::Model& model, const tinygltf::Animation& animation, size_t c, const string& where,
                   io_memory* memory, gltf_channel* out )
{
    const tinygltf::AnimationChannel& channel = animation.channels[c];
    const string& path = channel.target_path;
    const bool is_known = path == "translation" || path == "rotation" || path == "scale";
    if ( !is_known || channel.target_node == -1 )
    {
        return false;
    }
    check_element( channel.target_node, model.nodes.size(), where, "node" );
    const size_t width = path == "rotation" ? 4 : 3;
    const keys from =
        take_keys( model, element( animation.samplers, channel.sampler, where, "sampler" ), width, where );
    const size_t count = from.times.count;
    if ( from.values.count != from.rows * count || count > INT32_MAX / 16 )
    {
        refuse( where, "got " + to_string( from.values.count ) + " values, expected " +
                           to_string( from.rows * count ) + ", for " + to_string( count ) + " keys" );
    }
    out->node = channel.target_node;
    out->path = path == "translation" ? GLTF_TRANSLATION : path == "rotation" ? GLTF_ROTATION : GLTF_SCALE;
    out->interpolation = from.interpolation;
    out->width = static_cast<int>( width );
    out->key_count = static_cast<int>( count );
    out->times = copy( memory, from.times.values );
    out->values = copy( memory, from.values.values );
    for ( size_t k = 0; k < count && out->path == GLTF_ROTATION; ++k )
    {
        normalize( out->values + ( from.rows * k + from.rows / 2 ) * 4, where + ": key " + to_string( k ) );
    }
    return true;
}

// Weights of a node with morph targets. Channels of one sampler share its arrays: a recording has one for all bodies.
bool take_weights_channel( const tinygltf::Model& model, const tinygltf::Animation& animation, size_t c,
                           const string& where, gltf_model* known, size_t* left, gltf_animation* out )
{
    const tinygltf::AnimationChannel& channel = animation.channels[c];
    if ( channel.target_path != "weights" || channel.target_node == -1 )
    {
        return false;
    }
    check_element( channel.target_node, model.nodes.size(), where, "node" );
    const int mesh = known->nodes[channel.target_node].mesh;
    const size_t width = mesh >= 0 ? static_cast<size_t>( known->meshes[mesh].target_count ) : 0;
    if ( width == 0 )
    {
        return false;
    }
    io_memory* const memory = &known->memory;
    gltf_channel* weights = &out->weights[out->weights_count];
    for ( int w = 0; w < out->weights_count; ++w )
    {
        const gltf_channel* before = &out->weights[w];
        if ( before->sampler == channel.sampler && static_cast<size_t>( before->width ) == width )
        {
            *weights = *before;
            weights->node = channel.target_node;
            ++out->weights_count;
            return true;
        }
    }
    const keys from = take_keys( model, element( animation.samplers, channel.sampler, where, "sampler" ), 1, where );
    const size_t count = from.times.count, each = width * from.rows;
    if ( count > INT32_MAX / 16 || from.values.count / each != count || from.values.count % each != 0 )
    {
        refuse( where, "got " + to_string( from.values.count ) + " weights, expected one for each of " +
                           to_string( count ) + " keys and " + to_string( width ) + " morph targets" );
    }
    if ( from.values.count > *left )
    {
        refuse( where, "the weights of this file are the same bytes again and again" );
    }
    *left -= from.values.count;
    ++out->weights_count;
    weights->node = channel.target_node;
    weights->sampler = channel.sampler;
    weights->path = GLTF_WEIGHTS;
    weights->width = static_cast<int>( width );
    weights->interpolation = from.interpolation;
    weights->key_count = static_cast<int>( count );
    weights->times = copy( memory, from.times.values );
    weights->values = copy( memory, from.values.values );
    for ( size_t i = 0; i < from.values.values.size(); ++i )
    {
        // In single precision, as most files have them.
        weights->values[i] = static_cast<double>( static_cast<float>( weights->values[i] ) );
    }
    out->duration = std::fmax( out->duration, from.times.values.back() );
    return true;
}

void take_animation( const tinygltf::Model& model, size_t i, gltf_model* known, size_t* left, gltf_animation* out )
{
    io_memory* const memory = &known->memory;
    const tinygltf::Animation& animation = model.animations[i];
    out->name = copy( memory, printable( animation.name, "animation", i ) );
    out->channels = allocate<gltf_channel>( memory, animation.channels.size() );
    out->weights = allocate<gltf_channel>( memory, animation.channels.size() );
    for ( size_t c = 0; c < animation.channels.size(); ++c )
    {
        const string where = "animation " + to_string( i ) + ": channel " + to_string( c );
        if ( take_weights_channel( model, animation, c, where, known, left, out ) )
        {
            continue;
        }
        gltf_channel* channel = &out->channels[out->channel_count++];
        if ( take_channel( model, animation, c, where, memory, channel ) )
        {
            out->duration = std::fmax( out->duration, channel->times[channel->key_count - 1] );
        }
        else
        {
            --out->channel_count;
            ++out->skipped_count;
        }
    }
}

// ---- the file --------------------------------------------------------------------------------------------------

// Bytes of all buffers: no file needs more numbers of morph targets, and a short one cannot ask for more memory by naming
// the same bytes again and again.
size_t buffer_bytes( const tinygltf::Model& model )
{
    size_t sum = 0;
    for ( const tinygltf::Buffer& buffer : model.buffers )
    {
        sum += buffer.data.size();
    }
    return sum;
}

bool read_whole( std::vector<unsigned char>* out, string* err, const string& path, void* user )
{
    unsigned char* bytes = nullptr;
    size_t size = 0;
    wisp_error error = {};
    if ( gltf_read_beside( static_cast<const char*>( user ), path.c_str(), &bytes, &size, &error ) != WISP_OK )
    {
        *err += error.message;
        return false;
    }
    out->assign( bytes, bytes + size );
    std::free( bytes );
    return true;
}

void check_extensions( const tinygltf::Model& model )
{
    for ( const string& extension : model.extensionsRequired )
    {
        if ( !gltf_is_harmless( extension.c_str() ) )
        {
            refuse( "extensionsRequired", "the extension " + printable( extension, "", 0 ) + " is not read" );
        }
    }
}

void check_counts( const tinygltf::Model& model )
{
    const size_t most =
        std::max( { model.nodes.size(), model.meshes.size(), model.skins.size(), model.animations.size() } );
    if ( most > GLTF_ELEMENT_CAP )
    {
        refuse( "the file", "got " + to_string( most ) + " elements of a kind, expected at most " +
                                to_string( GLTF_ELEMENT_CAP ) );
    }
}

void load( const unsigned char* bytes, size_t size, bool is_binary, const char* folder, tinygltf::Model* model )
{
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader( []( tinygltf::Image*, const int, string*, string*, int, int, const unsigned char*, int,
                               void* ) { return true; },
                           nullptr );
    const auto exists = []( const string& path, void* user )
    { return user != nullptr && !gltf_is_image( path.c_str() ); };
    const auto expand = []( const string& path, void* ) { return path; };
    // The library keeps the pointer and never writes through it.
    loader.SetFsCallbacks( { exists, expand, read_whole, nullptr, const_cast<char*>( folder ) } );
    string err, warn;
    const string base = folder != nullptr ? folder : "";
    const unsigned length = static_cast<unsigned>( size );
    const bool good = is_binary ? loader.LoadBinaryFromMemory( model, &err, &warn, bytes, length, base )
                                : loader.LoadASCIIFromString( model, &err, &warn,
                                                              reinterpret_cast<const char*>( bytes ), length, base );
    if ( !good )
    {
        throw std::runtime_error( printable( err.substr( 0, err.find( '\n' ) ), "unknown error", 0, 180 ) );
    }
}

void convert( const tinygltf::Model& model, gltf_model* out )
{
    check_extensions( model );
    check_counts( model );
    size_t left = buffer_bytes( model ), left_weights = left;
    io_memory* const memory = &out->memory;
    out->nodes = allocate<gltf_node>( memory, model.nodes.size() );
    out->order = allocate<int32_t>( memory, model.nodes.size() );
    for ( size_t n = 0; n < model.nodes.size(); ++n )
    {
        take_node( model, n, memory, &out->nodes[out->node_count++] );
    }
    take_parents( model, out );
    out->meshes = allocate<gltf_mesh>( memory, model.meshes.size() );
    for ( size_t m = 0; m < model.meshes.size(); ++m )
    {
        take_mesh( model, m, &left, memory, &out->meshes[out->mesh_count++] );
    }
    out->skins = allocate<gltf_skin>( memory, model.skins.size() );
    for ( size_t s = 0; s < model.skins.size(); ++s )
    {
        take_skin( model, s, memory, &out->skins[out->skin_count++] );
    }
    out->animations = allocate<gltf_animation>( memory, model.animations.size() );
    for ( size_t a = 0; a < model.animations.size(); ++a )
    {
        take_animation( model, a, out, &left_weights, &out->animations[out->animation_count++] );
    }
}

} // namespace

wisp_status gltf_parse( const void* bytes, size_t size, bool is_binary, const char* folder, const char* name,
                        gltf_model* out, wisp_error* error )
{
    try
    {
        tinygltf::Model model;
        load( static_cast<const unsigned char*>( bytes ), size, is_binary, folder, &model );
        convert( model, out );
        return WISP_OK;
    }
    catch ( const std::bad_alloc& )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for the file", name );
    }
    catch ( const std::exception& problem )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: %.200s", name, problem.what() );
    }
    catch ( ... )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the glTF library refused the file", name );
    }
}
