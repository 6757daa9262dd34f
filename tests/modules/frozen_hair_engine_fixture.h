/// Shared by the tests of the engine's frozen hair: grooms, worlds and runs that must succeed, and the oracle with
/// exactly the engine's floats.
#pragma once

#include "support.h"

#include "environment.h"
#include "frozen_hair.h"
#include "oracle/frozen_hair_oracle.h"
#include "strand_appearance.h"
#include "wisp/module/random.h"
#include "wisp/wisp.h"

typedef enum hair_shape
{
    HAIR_STRAIGHT, ///< exact coordinates and exact tangents: every bend needs the fallback axis, in any precision
    HAIR_WAVY,     ///< a wave in one plane, no two neighbouring segments parallel
    HAIR_CURLY,    ///< a helix, or loops in the plane
} hair_shape;

/// A strand set in the user's order, made without the C library's mathematics: the same bits on every machine.
typedef struct hair_groom
{
    int strand_count, vertex_count, dimension;
    int32_t* offsets;  ///< [strand_count + 1]
    wisp_vec3* points; ///< [vertex_count], m; about 7 mm per segment
} hair_groom;

/// Make a groom with roots on a line (2D) or on a square lattice (3D).
/// @param spacing m between roots, rounded to a multiple of 2^-14 m
hair_groom hair_groom_create( hair_shape shape, int dimension, int strands, int vertices, float spacing );
/// As hair_groom_create(); strand s has counts[s] vertices.
hair_groom hair_groom_create_mixed( hair_shape shape, int dimension, int strands, const int* counts, float spacing );
/// From given points; strand s has counts[s] vertices.
hair_groom hair_groom_from( int dimension, int strands, const int* counts, const wisp_vec3* points );
void hair_groom_destroy( hair_groom* groom );

/// Settings of the engine. Zero-initialised: one worker, the best instruction set, the C library's memory.
typedef struct hair_host
{
    int workers; ///< 0 counts as 1
    const char* isa;
    wisp_parallel_for_fn* parallel_for;
    void* user;
    wisp_allocator allocator;
} hair_host;

/// A world with the modules frozen_hair, environment and strand_appearance and a silent log.
wisp_world* hair_world_create( const hair_host* host );
/// Add a groom and request its points.
wisp_entity hair_add( wisp_world* world, const hair_groom* groom );
/// Add a groom with frozen hair and request its points.
wisp_entity hair_add_frozen( wisp_world* world, const hair_groom* groom, const wisp_frozen_hair_def* def );
void hair_set( wisp_world* world, wisp_entity entity, const wisp_frozen_hair_def* def );
void hair_step( wisp_world* world );
void hair_command( wisp_world* world, wisp_entity entity, wisp_vec3 cursor );
/// The present points, valid until the world changes.
const wisp_vec3* hair_view( wisp_world* world, wisp_entity entity, int vertex_count );
/// A copy of the present points, to be freed.
wisp_vec3* hair_points( wisp_world* world, wisp_entity entity, int vertex_count );
wisp_frozen_hair_stats hair_stats( wisp_world* world, wisp_entity entity );

/// The points of a groom after its first command, to be freed. @param host may be null
wisp_vec3* hair_run( const hair_host* host, const hair_groom* groom, const wisp_frozen_hair_def* def );

/// Defaults with all three stages off.
wisp_frozen_hair_def hair_no_stages( void );
/// Defaults with the freeze stage alone.
wisp_frozen_hair_def hair_freeze_only( void );
/// Defaults with the align stage alone: a cursor that reaches every strand.
wisp_frozen_hair_def hair_align_only( wisp_vec3 cursor );
/// Defaults with the clump stage alone.
wisp_frozen_hair_def hair_clump_only( void );

/// The oracle's input for a groom and its parameters: every number is the engine's float, widened.
typedef struct hair_oracle
{
    frozen_oracle_hair hair;
    frozen_oracle_options options;
    int vertex_count;
    double3* rest;
    double* per_strand; ///< k_s, k_b, x one after another
} hair_oracle;

hair_oracle hair_oracle_create( const hair_groom* groom, const wisp_frozen_hair_def* def, uint64_t event );
void hair_oracle_destroy( hair_oracle* oracle );

/// @return a copy in double precision, to be freed
double3* hair_widen_all( const wisp_vec3* points, int count );
double3* hair_new_points( int count );

bool hair_same_bits( const wisp_vec3* a, const wisp_vec3* b, int count );
/// Distance of two points of float precision, in double.
double hair_distance( wisp_vec3 a, wisp_vec3 b );
/// Fails unless |actual - expected| <= tolerance; a NaN fails.
void hair_assert_close( double actual, double expected, double tolerance );
/// Fails unless every coordinate is finite.
void hair_assert_finite( const wisp_vec3* points, int count );

/// 2^-24, the unit of rounding of a float.
#define HAIR_ROUNDING 0x1p-24
