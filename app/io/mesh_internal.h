/// Private to the mesh files.
#pragma once

#include "io_file.h"
#include "mesh.h"

// ---- mesh.c: memory and checks ----

/// Allocate the arrays, contents undefined.
/// @return WISP_NO_MEMORY and an empty mesh
wisp_status mesh_allocate( wisp_mesh* mesh, int vertex_count, int triangle_count, const char* name,
                           wisp_error* error );

/// Copy everything.
/// @return WISP_NO_MEMORY and an empty mesh
wisp_status mesh_copy( const wisp_mesh* mesh, wisp_mesh* out, const char* name, wisp_error* error );

/// Malformed or not finite: rejected by readers, writers and the doctor.
wisp_status mesh_check( const wisp_mesh* mesh, const char* name, wisp_error* error );

/// The first coordinate of vertex v that is not finite, as a message.
wisp_status mesh_check_vertex( wisp_vec3 p, int v, const char* name, wisp_error* error );

/// Memory for colours or texture coordinates of all vertices, zeroed.
/// @return WISP_NO_MEMORY
wisp_status mesh_allocate_colours( wisp_mesh* mesh, const char* name, wisp_error* error );
wisp_status mesh_allocate_uvs( wisp_mesh* mesh, const char* name, wisp_error* error );

/// The writers behind the paths.
wisp_status mesh_put_obj( FILE* out, const wisp_mesh* mesh, const char* name, wisp_error* error );
wisp_status mesh_put_ply( FILE* out, const wisp_mesh* mesh, const char* name, wisp_error* error );

/// Rows of `property list uchar int`.
void mesh_put_triangles( FILE* out, const wisp_mesh* mesh );

// ---- mesh.c: triangles added one by one ----

/// A polygon becomes a fan around its first corner as its corners arrive; memory grows with the triangles.
typedef struct mesh_fan
{
    wisp_mesh* mesh;  ///< receives the triangles
    const char* name; ///< for messages
    int capacity;     ///< capacity in triangles
    int corner_count; ///< of the current polygon
    int32_t first, previous;
} mesh_fan;

/// @return WISP_BAD_INPUT more than WISP_MESH_TRIANGLE_CAP; WISP_NO_MEMORY
wisp_status mesh_fan_corner( mesh_fan* fan, int32_t vertex, wisp_error* error );

/// Release the unused capacity.
void mesh_fan_finish( mesh_fan* fan );

// ---- mesh.c: text of untrusted files ----

enum
{
    MESH_WORD_LONGEST = 64, // characters of a number
};

/// A piece of text, not zero-terminated.
typedef struct mesh_word
{
    const char* text;
    size_t length;
} mesh_word;

/// The next word of a line and the rest after it; words are separated by spaces and tabs.
mesh_word mesh_next_word( mesh_word* line );

/// The next line without its end, which is \n, \r or \r\n; false at the end of the text.
bool mesh_next_line( mesh_word* rest, mesh_word* line );

bool mesh_word_is( mesh_word word, const char* expected );

/// [+-] digits [. digits] [e [+-] digits], with a digit before or after the point, at most four in the exponent.
bool mesh_word_is_number( mesh_word word );

/// The value of a word that mesh_word_is_number(), at most MESH_WORD_LONGEST long, between io_numbers_begin() and
/// io_numbers_end().
double mesh_word_value( mesh_word word );

/// [+-] digits, within int32_t.
bool mesh_word_is_integer( mesh_word word, int32_t* value );

/// A word for a message: at most 24 characters, without control characters of a terminal.
typedef struct mesh_quote
{
    char text[32];
} mesh_quote;

mesh_quote mesh_quote_word( mesh_word word );

// ---- mesh_edges.c: neighbours ----

/// Half-edge 3 * t + k runs from corner k of triangle t to the next. Triangles with a repeated vertex have none.
typedef struct mesh_edges
{
    int half_count;  ///< entries of half
    int edge_count;  ///< runs
    int32_t* half;   ///< [half_count] half-edges, those of one edge side by side, lowest first
    int32_t* starts; ///< [edge_count + 1] where each edge begins in `half`; edges by lower, then higher vertex
} mesh_edges;

/// @param memory receives them @return WISP_NO_MEMORY
wisp_status mesh_edges_build( const wisp_mesh* mesh, io_memory* memory, mesh_edges* edges, wisp_error* error );

static inline int32_t mesh_from( const wisp_mesh* mesh, int32_t half )
{
    return mesh->triangles[half];
}

static inline int32_t mesh_next_half( int32_t half )
{
    return half % 3 == 2 ? half - 2 : half + 1;
}

static inline int32_t mesh_to( const wisp_mesh* mesh, int32_t half )
{
    return mesh->triangles[mesh_next_half( half )];
}

/// Whether triangle t has a repeated vertex.
bool mesh_names_twice( const wisp_mesh* mesh, int t );

/// Whether triangle t has a repeated vertex or no area.
bool mesh_is_degenerate( const wisp_mesh* mesh, int t );

/// first_of[t] becomes the lowest triangle with the same vertices as t, t itself as a rule.
/// @param skip [triangle_count] triangles to leave out, whose first_of is their own number; null: those with a repeated vertex alone,
///             which are left out always: they have a defect of their own
/// @return WISP_NO_MEMORY
wisp_status mesh_find_duplicates( const wisp_mesh* mesh, const bool* skip, int32_t* first_of, wisp_error* error );

/// Disjoint sets. The lowest member represents its set.
int32_t* mesh_sets_make( io_memory* memory, int count );
int32_t mesh_sets_find( int32_t* sets, int32_t member );
void mesh_sets_merge( int32_t* sets, int32_t a, int32_t b );

/// Twice the area's vector of a triangle, in double precision: finite for all finite floats.
typedef struct mesh_vector
{
    double x, y, z;
} mesh_vector;

mesh_vector mesh_between( wisp_vec3 from, wisp_vec3 to );
mesh_vector mesh_cross( mesh_vector a, mesh_vector b );
double mesh_dot( mesh_vector a, mesh_vector b );

// ---- mesh_repair.c ----

/// became[v] is the lowest vertex that stays within a distance of vertex v, or v itself, which stays.
/// @param distance m; 0: WISP_MESH_WELD_FRACTION of the longest side of the bounds
/// @return WISP_BAD_INPUT the distance is less than a billionth of the size; WISP_NO_MEMORY
wisp_status mesh_weld_find( const wisp_mesh* mesh, float distance, int32_t* became, wisp_error* error );

// ---- mesh_generate_*.c: shapes ----

wisp_status mesh_generate_irregular( const wisp_mesh_generator* generator, wisp_mesh* out, wisp_error* error );
wisp_status mesh_generate_delaunay( const wisp_mesh_generator* generator, wisp_mesh* out, wisp_error* error );
wisp_status mesh_generate_icosphere( const wisp_mesh_generator* generator, wisp_mesh* out, wisp_error* error );
wisp_status mesh_generate_turned( const wisp_mesh_generator* generator, wisp_mesh* out, wisp_error* error );
