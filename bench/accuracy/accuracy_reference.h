/// The reference of a scene without a closed form: a converged run, made by bench/reference and stored in
/// data/reference as two files. NAME.json is the recipe: the run, its precision and resolution, its criterion of
/// convergence, the remaining uncertainty, facts of the scene and the hash of the numbers. NAME.reference has the
/// numbers:
///
///     bytes                content, little-endian
///     8                    "WISPTRUT"
///     u32 [2]              version, numbers
///     f64 [numbers]        in the order of `layout` in the recipe
///     u64                  FNV-1a of all bytes before, as in the recipe
#pragma once

#include "accuracy.h"

#define ACCURACY_REFERENCE_VERSION 2 // 1 is that of compare_reference.h
#define ACCURACY_REFERENCE_NUMBERS_MAX ( 1 << 20 )
#define ACCURACY_REFERENCE_GENERATOR_MAX ( (size_t)1 << 16 ) // bytes
#define ACCURACY_INFO_MAX 24

/// A number on which a reference and a scene must agree.
typedef struct accuracy_fact
{
    char name[40]; ///< with its unit
    double value;
} accuracy_fact;

typedef struct accuracy_reference
{
    char scene[32];      ///< as in scenes.inc; the files are named after it
    char reference[200]; ///< reference of the error, as in accuracy_scene
    char solver[200];    ///< method of the run
    char precision[16];  ///< "double", or "float" if nothing else can run the scene
    int substeps;        ///< of the finest run; `solver` gives the unit
    char converged[400]; ///< criterion of convergence, and the observed values
    double uncertainty;  ///< m, estimated distance to the limit of infinitely many substeps
    char layout[200];    ///< of the numbers
    accuracy_fact info[ACCURACY_INFO_MAX];
    int fact_count;
    double* numbers; ///< [number_count]
    int number_count;
} accuracy_reference;

/// Add a fact. @param name with its unit
void accuracy_reference_put( accuracy_reference* reference, const char* name, double value );
/// Add the start of a scene as one fact: a weighted mean of all coordinates, m, which differs between meshes.
void accuracy_reference_put_start( accuracy_reference* reference, const wisp_vec3* points, int count );
void accuracy_reference_free( accuracy_reference* reference );

/// Folder of the benchmark's references.
const char* accuracy_reference_folder( void );

/// Read the reference of a scene from untrusted files, and check that it belongs to the present scene.
/// @param requested scene, facts and number_count
/// @return WISP_IO_ERROR a file is missing; WISP_BAD_INPUT one is broken, of another version or of another scene;
///        WISP_NO_MEMORY; out is then empty
wisp_status accuracy_reference_read( const char* folder, const accuracy_reference* requested, accuracy_reference* out,
                                     wisp_error* error );
/// Parse the recipe alone, from bytes; `number_count` and the hash are read from it. @param name for messages
wisp_status accuracy_reference_parse_generator( const char* bytes, size_t size, const char* name,
                                                accuracy_reference* out, uint64_t* hash, wisp_error* error );
/// Parse the numbers alone, [number_count] of a recipe.
wisp_status accuracy_reference_parse_numbers( const unsigned char* bytes, size_t size, const char* name, int count,
                                              uint64_t hash, double** out, wisp_error* error );

/// Write both files. @return WISP_IO_ERROR, WISP_NO_MEMORY
wisp_status accuracy_reference_write( const accuracy_reference* reference, const char* folder, wisp_error* error );

/// Fill in the description of the reference in a scene. @param unit units of its error per metre
void accuracy_describe_reference( const accuracy_reference* reference, double unit, accuracy_scene* out );
