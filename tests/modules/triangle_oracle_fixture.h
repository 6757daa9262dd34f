/// What the tests of the triangle cloth oracle share: small meshes, a crumpled sheet, comparisons.
#pragma once

#include "oracle_support.h"

#include "oracle/triangle_oracle.h"

static const uint64_t random_seed = 53;

static const double3 zero = { 0.0, 0.0, 0.0 };
static const double3 up = { 0.0, 1.0, 0.0 };
static const double fall = 9.81; // m/s^2

static inline double component( double3 v, int axis )
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static inline double3 along_axis( int axis, double length )
{
    return double3_make( axis == 0 ? length : 0.0, axis == 1 ? length : 0.0, axis == 2 ? length : 0.0 );
}

// ---- cloths ----

static inline triangle_oracle make_cloth( const triangle_oracle_def* def, const triangle_oracle_params* params )
{
    triangle_oracle cloth;
    wisp_error error = { 0 };
    assert_ok( triangle_oracle_create( def, params, &cloth, &error ), error );
    return cloth;
}

// Triangles on points at random, each vertex of 1 g.
static inline triangle_oracle make_mesh( int count, const int* triangles, int triangle_count )
{
    double3 points[16];
    double masses[16];
    for ( int i = 0; i < count; ++i )
    {
        points[i] = random_vector( 1, i );
        masses[i] = 1e-3;
    }
    const triangle_oracle_def def = {
        .count = count, .points = points, .triangle_count = triangle_count, .triangles = triangles, .masses = masses
    };
    const triangle_oracle_params params = triangle_oracle_default_params();
    return make_cloth( &def, &params );
}

// Two vertices along x with one link between them.
static inline triangle_oracle make_pair_of( const triangle_oracle_params* params, bool bends, double length,
                                            double mass )
{
    static const int ends[2] = { 0, 1 };
    const double3 points[2] = { zero, { length, 0.0, 0.0 } };
    const double masses[2] = { mass, mass };
    const triangle_oracle_def def = { .count = 2,
                                      .points = points,
                                      .masses = masses,
                                      .stretch_pairs = bends ? NULL : ends,
                                      .bend_pairs = bends ? ends : NULL,
                                      .stretch_pair_count = bends ? 0 : 1,
                                      .bend_pair_count = bends ? 1 : 0 };
    return make_cloth( &def, params );
}

// Vertices that nothing joins, at rest.
static inline triangle_oracle make_dust( const triangle_oracle_params* params, const double3* points, int count )
{
    double masses[16];
    for ( int i = 0; i < count; ++i )
    {
        masses[i] = 1e-3 * ( i + 1 );
    }
    const triangle_oracle_def def = { .count = count, .points = points, .masses = masses };
    return make_cloth( &def, params );
}

static inline triangle_oracle_params still_params( void )
{
    triangle_oracle_params params = triangle_oracle_default_params();
    params.gravity = zero;
    params.damping = 0.0;
    return params;
}

enum
{
    SHEET_SIDE = 6,
    SHEET_COUNT = SHEET_SIDE * SHEET_SIDE,
    SHEET_TRIANGLES = 2 * ( SHEET_SIDE - 1 ) * ( SHEET_SIDE - 1 ),
};

// A square of 6 x 6 vertices in the plane y = 0, 3 cm apart but for a disturbance, with diagonals both ways, so
// that valences differ.
static inline triangle_oracle make_sheet( const triangle_oracle_params* params )
{
    double3 points[SHEET_COUNT];
    double masses[SHEET_COUNT];
    int triangles[3 * SHEET_TRIANGLES];
    int n = 0;
    for ( int i = 0; i < SHEET_COUNT; ++i )
    {
        const double3 off = double3_scale( 0.005, random_vector( 2, i ) );
        points[i] = double3_make( 0.03 * ( i % SHEET_SIDE ) + off.x, 0.0, 0.03 * ( i / SHEET_SIDE ) + off.z );
    }
    for ( int cell = 0; cell < SHEET_TRIANGLES / 2; ++cell )
    {
        const int a = cell / ( SHEET_SIDE - 1 ) * SHEET_SIDE + cell % ( SHEET_SIDE - 1 );
        const int b = a + 1, c = a + SHEET_SIDE, d = c + 1;
        const bool other = random_between( 3, cell, 0.0, 1.0 ) < 0.5;
        const int corners[6] = { a, c, other ? d : b, other ? a : b, other ? d : c, other ? b : d };
        memcpy( triangles + n, corners, sizeof( corners ) );
        n += 6;
    }
    triangle_oracle_def def = { .count = SHEET_COUNT,
                                .points = points,
                                .triangle_count = SHEET_TRIANGLES,
                                .triangles = triangles,
                                .masses = masses };
    triangle_oracle_lump( &def, 0.2, masses );
    return make_cloth( &def, params );
}

// Every vertex elsewhere, so that about half of the links are longer than at rest.
static inline void crumple( triangle_oracle* cloth, int key, double by, double speed )
{
    for ( int i = 0; i < cloth->count; ++i )
    {
        cloth->x[i] = double3_add( cloth->x[i], double3_scale( by, random_vector( key, i ) ) );
        cloth->v[i] = double3_scale( speed, random_vector( key + 1, i ) );
    }
}

static inline double energy( const triangle_oracle* cloth )
{
    return triangle_oracle_kinetic_energy( cloth ) + triangle_oracle_stretch_energy( cloth, cloth->x ) +
           triangle_oracle_bend_energy( cloth, cloth->x );
}

static inline void steps( triangle_oracle* cloth, double h, int count, const triangle_oracle_bodies* bodies )
{
    for ( int k = 0; k < count; ++k )
    {
        triangle_oracle_step( cloth, h, bodies );
    }
}
