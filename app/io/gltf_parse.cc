// A whole file through tinygltf, which is compiled in rather than linked, so that sanitizers and the fuzzer cover it. No exception
// leaves this file: its callers are C.

// The library uses both without including them.
#include <fstream>
#include <sstream>

#define TINYGLTF_IMPLEMENTATION
#include "gltf_parse.h"

extern "C"
{
#include "io_file.h"
}

#include <algorithm>
#include <exception>
#include <stdexcept>

namespace gltf
{

namespace
{

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

bool no_image( tinygltf::Image* /*image*/, const int /*index*/, string* /*err*/, string* /*warn*/, int /*width*/,
               int /*height*/, const unsigned char* /*bytes*/, int /*size*/, void* /*user*/ )
{
    return true;
}

// Buffers beside a .gltf: in its folder or below.
bool is_beside( const string& path )
{
    return !path.empty() && path[0] != '/' && path.find( ".." ) == string::npos && path.find( ':' ) == string::npos;
}

bool file_exists( const string& path, void* user )
{
    return user != nullptr && !path.empty();
}

string expand( const string& path, void* /*user*/ )
{
    return path;
}

bool read_whole( std::vector<unsigned char>* out, string* err, const string& path, void* user )
{
    const char* folder = static_cast<const char*>( user );
    const string name =
        path.substr( folder != nullptr && path.rfind( folder, 0 ) == 0 ? std::strlen( folder ) + 1 : 0 );
    unsigned char* bytes = nullptr;
    size_t size = 0;
    wisp_error error = {};
    if ( folder == nullptr || !is_beside( name ) )
    {
        *err += "the buffer '" + printable( name, "", 0 ) + "' is not in the folder of the file";
        return false;
    }
    if ( io_file_read( path.c_str(), WISP_MESH_FILE_CAP, &bytes, &size, &error ) != WISP_OK )
    {
        *err += error.message;
        return false;
    }
    out->assign( bytes, bytes + size );
    std::free( bytes );
    return true;
}

bool write_nothing( string* err, const string& /*path*/, const std::vector<unsigned char>& /*bytes*/, void* /*user*/ )
{
    *err += "nothing is written";
    return false;
}

void check_extensions( const tinygltf::Model& model )
{
    static const char* const harmless[] = { "KHR_materials_", "KHR_texture_", "KHR_lights_", "KHR_mesh_quantization",
                                            "EXT_texture_" };
    for ( const string& extension : model.extensionsRequired )
    {
        bool is_known = false;
        for ( const char* start : harmless )
        {
            is_known = is_known || extension.rfind( start, 0 ) == 0;
        }
        if ( !is_known )
        {
            refuse( "extensionsRequired", "the extension " + printable( extension, "", 0 ) + " is not read" );
        }
    }
}

void check_counts( const tinygltf::Model& model )
{
    const size_t most = std::max( std::max( model.nodes.size(), model.meshes.size() ),
                                  std::max( model.skins.size(), model.animations.size() ) );
    if ( most > GLTF_ELEMENT_CAP )
    {
        refuse( "the file", "got " + to_string( most ) + " elements of a kind, expected at most " +
                                to_string( GLTF_ELEMENT_CAP ) );
    }
}

string first_line( const string& text )
{
    const string line = text.substr( 0, text.find( '\n' ) );
    return printable( line, "unknown error", 0, 180 );
}

void load( const unsigned char* bytes, size_t size, bool is_binary, const char* folder, tinygltf::Model* model )
{
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader( no_image, nullptr );
    // The library keeps the pointer and never writes through it.
    loader.SetFsCallbacks( { file_exists, expand, read_whole, write_nothing, const_cast<char*>( folder ) } );
    string err, warn;
    const string base = folder != nullptr ? folder : "";
    const unsigned length = static_cast<unsigned>( size );
    const bool good = is_binary ? loader.LoadBinaryFromMemory( model, &err, &warn, bytes, length, base )
                                : loader.LoadASCIIFromString( model, &err, &warn,
                                                              reinterpret_cast<const char*>( bytes ), length, base );
    if ( !good )
    {
        throw std::runtime_error( first_line( err ) );
    }
}

void convert( const tinygltf::Model& model, gltf_model* out )
{
    check_extensions( model );
    check_counts( model );
    size_t left = buffer_bytes( model ), left_weights = left;
    out->nodes = allocate<gltf_node>( model.nodes.size() );
    out->order = allocate<int32_t>( model.nodes.size() );
    for ( ; static_cast<size_t>( out->node_count ) < model.nodes.size(); )
    {
        gltf_node* node = &out->nodes[out->node_count++];
        node->parent = -1;
        take_node( model, static_cast<size_t>( out->node_count - 1 ), node );
    }
    take_parents( model, out );
    out->meshes = allocate<gltf_mesh>( model.meshes.size() );
    for ( size_t m = 0; m < model.meshes.size(); ++m )
    {
        take_mesh( model, m, &left, &out->meshes[out->mesh_count++] );
    }
    out->skins = allocate<gltf_skin>( model.skins.size() );
    for ( size_t s = 0; s < model.skins.size(); ++s )
    {
        take_skin( model, s, &out->skins[out->skin_count++] );
    }
    out->animations = allocate<gltf_animation>( model.animations.size() );
    for ( size_t a = 0; a < model.animations.size(); ++a )
    {
        take_animation( model, a, out, &left_weights, &out->animations[out->animation_count++] );
    }
}

} // namespace

} // namespace gltf

wisp_status gltf_parse( const void* bytes, size_t size, bool is_binary, const char* folder, const char* name,
                        gltf_model* out, wisp_error* error )
{
    try
    {
        tinygltf::Model model;
        gltf::load( static_cast<const unsigned char*>( bytes ), size, is_binary, folder, &model );
        gltf::convert( model, out );
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
