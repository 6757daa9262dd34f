/// Private to the glTF files.
#pragma once

#include "gltf.h"

#ifdef __cplusplus
extern "C"
{
#endif

    /// gltf_parse.cc, through tinygltf: bytes that gltf.c has checked become a model whose numbers are
    /// within their arrays and finite.
    /// @param folder of other buffers, null: refused
    wisp_status gltf_parse( const void* bytes, size_t size, bool is_binary, const char* folder, const char* name,
                            gltf_model* out, wisp_error* error );

    /// gltf_merge.c: merge vertices of exactly equal position, joints and weights; the first stays.
    wisp_status gltf_merge_seams( gltf_mesh* mesh, const char* name, wisp_error* error );

    /// The last key at or before a time that is not before the first. @param times [count] rising
    int gltf_find_key( const double* times, int count, double time );

    /// Hermite's cubic (appendix C.5) from p to q in dt seconds, at t in 0 .. 1; tangents per second.
    double gltf_spline( double p, double out_tangent, double in_tangent, double q, double dt, double t );

    /// product = a * b, rows of 3 x 4 matrices.
    void gltf_multiply( const double a[12], const double b[12], double product[12] );

#ifdef __cplusplus
}
#endif
