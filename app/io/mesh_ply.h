/// Contents of a PLY header. Shared by the two files that read PLY.
#pragma once

#include "mesh_internal.h"

enum
{
    PLY_MAX_ELEMENTS = 32,
    PLY_MAX_PROPERTIES = 256, // of all elements together
    PLY_NAME_ROOM = 32,
};

typedef enum ply_encoding
{
    PLY_TEXT,
    PLY_LITTLE,
    PLY_BIG,
} ply_encoding;

typedef enum ply_type
{
    PLY_NONE,
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_FLOAT,
    PLY_DOUBLE,
} ply_type;

/// Meaning of a property for a mesh.
typedef enum ply_role
{
    PLY_X,
    PLY_Y,
    PLY_Z,
    PLY_RED,
    PLY_GREEN,
    PLY_BLUE,
    PLY_U,
    PLY_V,
    PLY_CORNERS,
    PLY_PASSED_OVER,
} ply_role;

typedef struct ply_property
{
    ply_type count_type; ///< PLY_NONE unless it is a list
    ply_type type;
    ply_role role;
    char name[PLY_NAME_ROOM]; ///< cut if longer
} ply_property;

typedef struct ply_element
{
    int64_t count;
    int first_property, property_count;
    char name[PLY_NAME_ROOM];
} ply_element;

typedef struct ply_header
{
    const char* name; ///< for messages
    ply_encoding encoding;
    int element_count, property_count;
    ply_element elements[PLY_MAX_ELEMENTS];
    ply_property properties[PLY_MAX_PROPERTIES];
    int vertex_element, face_element;
    int line_count; ///< of the header
    size_t size;    ///< bytes of the header; the first row begins here
} ply_header;
