/// The reference of a scene that has no closed form: a converged run, made by bench/reference and stored in
/// data/reference as two files. NAME.json is the recipe, for people and for the reader: what ran, in which precision,
/// how finely, when it counts as converged, what is still missing, the facts of the scene that it was made of, and
/// the hash of the numbers. NAME.truth has the numbers:
///
///     bytes                what, all of it little-endian
///     8                    "WISPTRUT"
///     u32 [2]              version, numbers
///     f64 [numbers]        as `layout` of the recipe says
///     u64                  FNV-1a of all bytes before: the hash of the recipe
#pragma once

#include "accuracy.h"

#define ACCURACY_REFERENCE_VERSION 2 // 1 is that of compare_reference.h
#define ACCURACY_REFERENCE_NUMBERS_MAX ( 1 << 20 )
#define ACCURACY_REFERENCE_GENERATOR_MAX ( (size_t)1 << 16 ) // bytes
#define ACCURACY_INFO_MAX 24

/// A number that a reference and a scene must agree in.
typedef struct accuracy_fact
{
    char name[40]; ///< with its unit
    double value;
} accuracy_fact;

typedef struct accuracy_reference
{
    char scene[32];      ///< as scenes.inc has it; the files are named after it
    char reference[200]; ///< what the error is measured against, as accuracy_scene has it
    char solver[200];    ///< what ran
    char precision[16];  ///< "double", or "float" where nothing else can run the scene
    int substeps;        ///< of the finest run; what they are of is in `solver`
    char converged[400]; ///< when it counts as converged, and what was seen of it
    double doubt;        ///< m, estimated distance to what infinitely many substeps would give
    char layout[200];    ///< of the numbers
    accuracy_fact info[ACCURACY_INFO_MAX];
    int fact_count;
    double* numbers; ///< [number_count]
    int number_count;
} accuracy_reference;

/// Another fact. @param name with its unit
void accuracy_reference_put( accuracy_reference* reference, const char* name, double value );
/// Where a scene begins, as one fact: a mean of all coordinates with weights of their own, m. Another mesh has
/// another one.
void accuracy_reference_put_start( accuracy_reference* reference, const wisp_vec3* points, int count );
void accuracy_reference_free( accuracy_reference* reference );

/// Where the benchmark's references are.
const char* accuracy_reference_folder( void );

/// Read the reference of a scene from untrusted files, and check that it belongs to the present scene.
/// @param wanted scene, facts and number_count
/// @return WISP_IO_ERROR a file is not there; WISP_BAD_INPUT one is broken, of another version or of another scene;
///         WISP_NO_MEMORY; out is then empty
wisp_status accuracy_reference_read( const char* folder, const accuracy_reference* requested, accuracy_reference* out,
                                     wisp_error* error );
/// The recipe alone, from bytes; `number_count` and the hash are those that it speaks of. @param name what messages
/// call them
wisp_status accuracy_reference_parse_generator( const char* bytes, size_t size, const char* name,
                                                accuracy_reference* out, uint64_t* hash, wisp_error* error );
/// The numbers alone, [number_count] of a recipe.
wisp_status accuracy_reference_parse_numbers( const unsigned char* bytes, size_t size, const char* name, int count,
                                              uint64_t hash, double** out, wisp_error* error );

/// Both files. @return WISP_IO_ERROR, WISP_NO_MEMORY
wisp_status accuracy_reference_write( const accuracy_reference* reference, const char* folder, wisp_error* error );

/// What a scene says of its reference. @param unit how many of the unit of its error a metre has
void accuracy_describe_reference( const accuracy_reference* reference, double unit, accuracy_scene* out );
