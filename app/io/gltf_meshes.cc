// Meshes, whose primitives are joined, with their weights and morph targets.
#include "gltf_parse.h"

#include <algorithm>

namespace gltf
{

namespace
{

// A mesh while its primitives are joined.
struct joined
{
    std::vector<wisp_vec3> points, colours;
    std::vector<float> uvs, weights;
    std::vector<std::vector<float>> targets; // displacements, of each morph target
    std::vector<int32_t> triangles, joints;
    size_t colour_count = 0, uv_count = 0;
    int skinned = 0, plain = 0; // primitives
};

int find( const tinygltf::Primitive& primitive, const char* attribute )
{
    const auto found = primitive.attributes.find( attribute );
    return found == primitive.attributes.end() ? -1 : found->second;
}

numbers take_attribute( const tinygltf::Model& model, const tinygltf::Primitive& primitive, const char* attribute,
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
    const bool eight = find( primitive, "JOINTS_1" ) >= 0 && find( primitive, "WEIGHTS_1" ) >= 0;
    std::vector<numbers> joints, weights;
    joints.push_back( take_attribute( model, primitive, "JOINTS_0", 4, 4, count, where ) );
    weights.push_back( take_attribute( model, primitive, "WEIGHTS_0", 4, 4, count, where ) );
    if ( eight )
    {
        joints.push_back( take_attribute( model, primitive, "JOINTS_1", 4, 4, count, where ) );
        weights.push_back( take_attribute( model, primitive, "WEIGHTS_1", 4, 4, count, where ) );
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
        mesh->dropped_influence_count += eight && all[4].first > 0.0;
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
    const size_t base = out->points.size() - count;
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
    const bool is_first = out->points.size() == count;
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
        const std::vector<double> values =
            found != primitive.targets[t].end()
                ? take_displacements( model, found->second, count, where + ": target " + to_string( t ) )
                : std::vector<double>( 3 * count, 0.0 );
        for ( double value : values )
        {
            out->targets[t].push_back( static_cast<float>( value ) );
        }
    }
}

void take_primitive( const tinygltf::Model& model, const tinygltf::Primitive& primitive, const string& where,
                     size_t* left, joined* out, gltf_mesh* mesh )
{
    const numbers points = take_attribute( model, primitive, "POSITION", 3, 3, 0, where );
    const size_t count = points.count, before = out->points.size();
    if ( before + count > WISP_MESH_VERTEX_CAP )
    {
        refuse( where, "expected at most " + to_string( WISP_MESH_VERTEX_CAP ) + " vertices" );
    }
    out->colours.resize( before + count, wisp_vec3{ 1.0f, 1.0f, 1.0f } );
    out->uvs.resize( 2 * ( before + count ), 0.0f );
    for ( size_t v = 0; v < count; ++v )
    {
        const double* p = points.values.data() + 3 * v;
        out->points.push_back(
            wisp_vec3{ static_cast<float>( p[0] ), static_cast<float>( p[1] ), static_cast<float>( p[2] ) } );
    }
    if ( find( primitive, "COLOR_0" ) >= 0 )
    {
        const numbers c = take_attribute( model, primitive, "COLOR_0", 3, 4, count, where );
        out->colour_count += count;
        for ( size_t v = 0; v < count; ++v )
        {
            const double* from = c.values.data() + c.width * v;
            out->colours[before + v] = wisp_vec3{ static_cast<float>( from[0] ), static_cast<float>( from[1] ),
                                                  static_cast<float>( from[2] ) };
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

template <typename T> T* copy( const std::vector<T>& from )
{
    T* to = allocate<T>( from.size() );
    if ( !from.empty() )
    {
        std::memcpy( to, from.data(), from.size() * sizeof( T ) );
    }
    return to;
}

// Names are in no part of the standard, but everywhere.
string target_name( const tinygltf::Mesh& mesh, size_t t )
{
    const bool has_names = mesh.extras.IsObject() && mesh.extras.Has( "targetNames" ) &&
                           mesh.extras.Get( "targetNames" ).IsArray() &&
                           t < mesh.extras.Get( "targetNames" ).ArrayLen() &&
                           mesh.extras.Get( "targetNames" ).Get( static_cast<int>( t ) ).IsString();
    return printable( has_names ? mesh.extras.Get( "targetNames" ).Get( static_cast<int>( t ) ).Get<string>()
                                : string(),
                      "target", t );
}

void copy_targets( const tinygltf::Mesh& mesh, const joined& all, const string& where, gltf_mesh* out )
{
    const size_t count = all.targets.size(), numbers_each = 3 * all.points.size();
    if ( count == 0 )
    {
        return;
    }
    out->target_names = allocate<char*>( count );
    out->targets = allocate<float>( count * numbers_each );
    out->weights_at_rest = allocate<double>( count );
    out->target_count = static_cast<int>( count );
    for ( size_t t = 0; t < count; ++t )
    {
        out->target_names[t] = copy_text( target_name( mesh, t ) );
        std::memcpy( out->targets + t * numbers_each, all.targets[t].data(), numbers_each * sizeof( float ) );
    }
    if ( !mesh.weights.empty() )
    {
        take_vector( mesh.weights, count, out->weights_at_rest, where + ": weights" );
    }
}

} // namespace

void take_mesh( const tinygltf::Model& model, size_t m, size_t* left, gltf_mesh* out )
{
    const tinygltf::Mesh& mesh = model.meshes[m];
    joined all;
    out->name = copy_text( printable( mesh.name, "mesh", m ) );
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
    const size_t count = all.points.size();
    out->mesh.vertex_count = static_cast<int>( count );
    out->mesh.triangle_count = static_cast<int>( all.triangles.size() / 3 );
    out->mesh.points = copy( all.points );
    out->mesh.triangles = copy( all.triangles );
    out->mesh.colours = all.colour_count > 0 ? copy( all.colours ) : nullptr;
    out->mesh.uvs = all.uv_count > 0 ? copy( all.uvs ) : nullptr;
    out->mesh.colour_missing_count = all.colour_count > 0 ? static_cast<int>( count - all.colour_count ) : 0;
    out->mesh.uv_missing_count = all.uv_count > 0 ? static_cast<int>( count - all.uv_count ) : 0;
    out->joints = all.skinned > 0 ? copy( all.joints ) : nullptr;
    out->weights = all.skinned > 0 ? copy( all.weights ) : nullptr;
    copy_targets( mesh, all, "mesh " + to_string( m ), out );
}

} // namespace gltf
