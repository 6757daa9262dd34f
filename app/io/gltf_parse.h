/// Private to the glTF files of C++, the only ones that use tinygltf. It checks little of what it reads, so its indices, sizes and
/// numbers are all checked here. What is wrong is thrown as std::runtime_error, and gltf_parse() catches it.
#pragma once

#include "gltf_internal.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>
#include <vector>

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

namespace gltf
{

using std::string;
using std::to_string;

// ---- messages and memory ---------------------------------------------------------------------------------------

[[noreturn]] void refuse( const string& where, const string& what );

// A name of the file without control characters, which would reach a terminal.
string printable( const string& name, const char* kind, size_t index, size_t most = 64 );

void check_element( int index, size_t count, const string& where, const char* kind );

char* copy_text( const string& text );

template <typename T> T* allocate( size_t count )
{
    T* memory = static_cast<T*>( std::calloc( count > 0 ? count : 1, sizeof( T ) ) );
    if ( memory == nullptr )
    {
        throw std::bad_alloc();
    }
    return memory;
}

// ---- gltf_accessors.cc -----------------------------------------------------------------------------------------

struct numbers
{
    size_t count;
    size_t width;
    std::vector<double> values; // [count][width]
};

// All values of an accessor, whose bytes must lie in its view and that in its buffer.
numbers take( const tinygltf::Model& model, int index, size_t least_width, size_t most_width, const string& where );

// Displacements of a morph target, which are often sparse: only vertices that move are in the file.
std::vector<double> take_displacements( const tinygltf::Model& model, int index, size_t count, const string& where );

// Numbers of a node or mesh, none or `count`.
void take_vector( const std::vector<double>& from, size_t count, double* to, const string& where );

// ---- elements of a file ----------------------------------------------------------------------------------------

// `left` is how many more numbers the file may ask for.
void take_node( const tinygltf::Model& model, size_t n, gltf_node* out );
void take_parents( const tinygltf::Model& model, gltf_model* out );
void take_skin( const tinygltf::Model& model, size_t s, gltf_skin* out );
void take_mesh( const tinygltf::Model& model, size_t m, size_t* left, gltf_mesh* out );
void take_animation( const tinygltf::Model& model, size_t i, const gltf_model* known, size_t* left,
                     gltf_animation* out );

// A rotation of a node or key to length 1.
void normalize( double* q, const string& where );

} // namespace gltf
