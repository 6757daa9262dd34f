// Values of accessors, dense and sparse; what they refer to must be in the file.
#include "gltf_parse.h"

#include <cfloat>
#include <stdexcept>

namespace gltf
{

[[noreturn]] void refuse( const string& where, const string& what )
{
    throw std::runtime_error( where + ": " + what );
}

string printable( const string& name, const char* kind, size_t index, size_t most )
{
    string clean = name.substr( 0, most );
    for ( char& c : clean )
    {
        c = static_cast<unsigned char>( c ) < ' ' || c == 127 ? '?' : c;
    }
    return clean.empty() ? string( kind ) + " " + to_string( index ) : clean;
}

char* copy_text( const string& text )
{
    char* copy = static_cast<char*>( std::malloc( text.size() + 1 ) );
    if ( copy == nullptr )
    {
        throw std::bad_alloc();
    }
    std::memcpy( copy, text.c_str(), text.size() + 1 );
    return copy;
}

void check_element( int index, size_t count, const string& where, const char* kind )
{
    if ( index < 0 || static_cast<size_t>( index ) >= count )
    {
        refuse( where, string( "got " ) + kind + " " + to_string( index ) + ", the file has " + to_string( count ) );
    }
}

namespace
{

double component( const unsigned char* at, int type, bool normalized )
{
    switch ( type )
    {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        {
            int8_t value;
            std::memcpy( &value, at, sizeof value );
            return normalized ? std::fmax( value / 127.0, -1.0 ) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return normalized ? *at / 255.0 : *at;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        {
            int16_t value;
            std::memcpy( &value, at, sizeof value );
            return normalized ? std::fmax( value / 32767.0, -1.0 ) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        {
            uint16_t value;
            std::memcpy( &value, at, sizeof value );
            return normalized ? value / 65535.0 : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        {
            uint32_t value;
            std::memcpy( &value, at, sizeof value );
            return value;
        }
        default:
        {
            float value;
            std::memcpy( &value, at, sizeof value );
            return static_cast<double>( value );
        }
    }
}

// `count` values at an offset of a view, packed.
const unsigned char* packed( const tinygltf::Model& model, int view_index, size_t offset, size_t count, size_t item,
                             const string& where )
{
    check_element( view_index, model.bufferViews.size(), where, "buffer view" );
    const tinygltf::BufferView& view = model.bufferViews[static_cast<size_t>( view_index )];
    check_element( view.buffer, model.buffers.size(), where, "buffer" );
    const std::vector<unsigned char>& bytes = model.buffers[static_cast<size_t>( view.buffer )].data;
    const bool fits = view.byteOffset <= bytes.size() && view.byteLength <= bytes.size() - view.byteOffset &&
                      offset <= view.byteLength && count <= ( view.byteLength - offset ) / item;
    if ( !fits )
    {
        refuse( where, "its " + to_string( count ) + " sparse values are not within the bytes of the file" );
    }
    return bytes.data() + view.byteOffset + offset;
}

} // namespace

numbers take( const tinygltf::Model& model, int index, size_t least_width, size_t most_width, const string& where )
{
    check_element( index, model.accessors.size(), where, "accessor" );
    const tinygltf::Accessor& a = model.accessors[static_cast<size_t>( index )];
    const string place = where + ": accessor " + to_string( index );
    const int width =
        a.type == TINYGLTF_TYPE_SCALAR ? 1 : tinygltf::GetNumComponentsInType( static_cast<uint32_t>( a.type ) );
    const int size = tinygltf::GetComponentSizeInBytes( static_cast<uint32_t>( a.componentType ) );
    const bool known = size > 0 && size <= 4 && a.componentType != TINYGLTF_COMPONENT_TYPE_INT;
    if ( width < static_cast<int>( least_width ) || width > static_cast<int>( most_width ) || !known )
    {
        refuse( place, "got values of " + to_string( width ) + " numbers of type " + to_string( a.componentType ) +
                           ", expected " + to_string( least_width ) +
                           ( most_width > least_width ? " .. " + to_string( most_width ) : string() ) );
    }
    if ( a.sparse.isSparse || a.bufferView < 0 )
    {
        refuse( place, a.sparse.isSparse ? "sparse values are not read" : "it has no buffer view" );
    }
    check_element( a.bufferView, model.bufferViews.size(), place, "buffer view" );
    const tinygltf::BufferView& view = model.bufferViews[static_cast<size_t>( a.bufferView )];
    check_element( view.buffer, model.buffers.size(), place, "buffer" );
    const std::vector<unsigned char>& bytes = model.buffers[static_cast<size_t>( view.buffer )].data;
    const size_t item = static_cast<size_t>( width ) * static_cast<size_t>( size );
    const size_t stride = view.byteStride > 0 ? view.byteStride : item;
    const bool fits = view.byteOffset <= bytes.size() && view.byteLength <= bytes.size() - view.byteOffset &&
                      a.byteOffset <= view.byteLength && a.count >= 1 && stride >= item && stride <= 65536 &&
                      item <= view.byteLength - a.byteOffset &&
                      ( a.count - 1 ) <= ( view.byteLength - a.byteOffset - item ) / stride;
    if ( !fits )
    {
        refuse( place, "its " + to_string( a.count ) + " values are not within the bytes of the file" );
    }
    numbers out{ a.count, static_cast<size_t>( width ),
                 std::vector<double>( a.count * static_cast<size_t>( width ) ) };
    const unsigned char* first = bytes.data() + view.byteOffset + a.byteOffset;
    for ( size_t i = 0; i < out.values.size(); ++i )
    {
        const size_t k = i % out.width;
        const double value = component( first + i / out.width * stride + k * static_cast<size_t>( size ),
                                        a.componentType, a.normalized );
        if ( !std::isfinite( value ) )
        {
            refuse( place,
                    "value " + to_string( i / out.width ) + " is " + ( std::isnan( value ) ? "NaN" : "infinite" ) );
        }
        out.values[i] = value;
    }
    return out;
}

std::vector<double> take_displacements( const tinygltf::Model& model, int index, size_t count, const string& where )
{
    check_element( index, model.accessors.size(), where, "accessor" );
    tinygltf::Accessor a = model.accessors[static_cast<size_t>( index )];
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
    const int size = tinygltf::GetComponentSizeInBytes( static_cast<uint32_t>( type ) );
    if ( !is_index || size <= 0 || size > 4 || type == TINYGLTF_COMPONENT_TYPE_INT || given > count )
    {
        refuse( place, "got sparse values of type " + to_string( type ) + " and indices of type " +
                           to_string( index_type ) );
    }
    const size_t index_size =
        static_cast<size_t>( tinygltf::GetComponentSizeInBytes( static_cast<uint32_t>( index_type ) ) );
    const size_t part = static_cast<size_t>( size );
    const unsigned char* indices =
        packed( model, a.sparse.indices.bufferView, static_cast<size_t>( a.sparse.indices.byteOffset ), given,
                index_size, place );
    const unsigned char* values = packed( model, a.sparse.values.bufferView,
                                          static_cast<size_t>( a.sparse.values.byteOffset ), given, 3 * part, place );
    std::vector<double> out( 3 * count, 0.0 );
    for ( size_t i = 0; i < given; ++i )
    {
        const double vertex = component( indices + i * index_size, index_type, false );
        if ( !( vertex < static_cast<double>( count ) ) )
        {
            refuse( place, "sparse value " + to_string( i ) + " is of a vertex that the mesh does not have" );
        }
        for ( size_t k = 0; k < 3; ++k )
        {
            const double value = component( values + ( 3 * i + k ) * part, type, a.normalized );
            if ( !std::isfinite( value ) )
            {
                refuse( place, "sparse value " + to_string( i ) + " is not finite" );
            }
            out[3 * static_cast<size_t>( vertex ) + k] = value;
        }
    }
    return out;
}

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

} // namespace gltf
