/// Random springs in rows, and all arrays that the arguments of springs and conjugate gradients point to.
#pragma once

#include "kernels_fixture.h"

#include "triangle_oracle.h"

enum
{
    SLICES = 140, // three blocks of 64 for sums, the last of them not full
    ROWS = 8 * SLICES,
    VERTICES = ROWS - 11, // a slice and a half pad
    LINKS = 4 * VERTICES,
    MAX_ENTRIES = 40 * SLICES,
};

static const double EPSILON = (double)FLT_EPSILON;

typedef struct spring
{
    int i, j;
    bool bends;
    float rest, load, ramp, ramp_end, damping;
} spring;

// Random links, and all arrays that the arguments point to.
typedef struct springs
{
    int link_count, entry_count;
    spring link[LINKS];
    _Alignas( 64 ) float position[ROWS][4];
    _Alignas( 64 ) float velocity[ROWS][4];
    _Alignas( 64 ) float start[ROWS][4];
    int32_t begin[2 * SLICES + 1];
    _Alignas( 64 ) int32_t other_x4[MAX_ENTRIES][8];
    _Alignas( 64 ) float rest[MAX_ENTRIES][8], load[MAX_ENTRIES][8], ramp[MAX_ENTRIES][8], damping[MAX_ENTRIES][8];
    _Alignas( 64 ) float ramp_end[MAX_ENTRIES][8];
    _Alignas( 64 ) float axis[MAX_ENTRIES][4][8];
    _Alignas( 64 ) float rhs[SLICES][3][8], inverse[SLICES][6][8], filter[SLICES][6][8];
    _Alignas( 64 ) float direction[ROWS][4];
    _Alignas( 64 ) float product[SLICES][3][8], solution[SLICES][3][8], search[SLICES][3][8];
    uint8_t filtered[SLICES];
    double sum[2];
    int undirected, variant;
} springs;

static inline double3 row_vector( float ( *vectors )[3][8], int row )
{
    return lane_vector( vectors[row / 8], row % 8 );
}

// ---- random links ----

static inline void place_entries( springs* s )
{
    int degree[ROWS][2] = { { 0 } }, filled[ROWS][2] = { { 0 } };
    for ( int k = 0; k < s->link_count; ++k )
    {
        degree[s->link[k].i][s->link[k].bends] += 1;
        degree[s->link[k].j][s->link[k].bends] += 1;
    }
    int entry = 0;
    for ( int part = 0; part < 2 * SLICES; ++part )
    {
        int most = 0;
        for ( int lane = 0; lane < 8; ++lane )
        {
            const int n = degree[part / 2 * 8 + lane][part % 2];
            most = n > most ? n : most;
        }
        s->begin[part] = entry;
        entry += most;
    }
    s->begin[2 * SLICES] = s->entry_count = entry;
    assert_true( entry <= MAX_ENTRIES );
    for ( int slice = 0; slice < SLICES; ++slice )
    {
        for ( int e = s->begin[2 * slice]; e < s->begin[2 * slice + 2]; ++e )
        {
            for ( int lane = 0; lane < 8; ++lane )
            {
                s->other_x4[e][lane] = 4 * ( 8 * slice + lane );
            }
        }
    }
    for ( int k = 0; k < 2 * s->link_count; ++k )
    {
        const spring* l = s->link + k / 2;
        const int own = k % 2 == 0 ? l->i : l->j, other = k % 2 == 0 ? l->j : l->i;
        const int e = s->begin[2 * ( own / 8 ) + ( l->bends ? 1 : 0 )] + filled[own][l->bends]++;
        s->other_x4[e][own % 8] = 4 * other;
        s->rest[e][own % 8] = l->rest;
        s->load[e][own % 8] = l->load;
        s->ramp[e][own % 8] = l->ramp;
        s->ramp_end[e][own % 8] = l->ramp_end;
        s->damping[e][own % 8] = l->damping;
    }
}

// Where a ramp, from y = 1 down, first meets the arc; 0: nowhere. In units of load / length.
static inline float find_ramp_end( double ramp )
{
    double y = 1.0;
    while ( y > 0.0 && triangle_oracle_arc_load( y ) < ramp * ( y - 1.0 ) )
    {
        y -= 1e-3;
    }
    double lower = fmax( y, 0.0 ), upper = fmin( y + 1e-3, 1.0 );
    for ( int i = 0; i < 40 && y > 0.0; ++i )
    {
        const double middle = 0.5 * ( lower + upper );
        const bool ramps = triangle_oracle_arc_load( middle ) < ramp * ( middle - 1.0 );
        lower = ramps ? lower : middle;
        upper = ramps ? middle : upper;
    }
    return (float)lower;
}

// Links that stretch and that bend, about half of them longer than at rest; bending ones on the ramp and on the arc.
static inline void add_spring( springs* s, int i, int j, bool bends )
{
    const int n = s->link_count;
    const float length = (float)double3_distance( double3_from( s->position[i] ), double3_from( s->position[j] ) );
    s->link[s->link_count++] = ( spring ){
        .i = i,
        .j = j,
        .bends = bends,
        .rest = length > 0.0f ? length * test_random_float( n, 20, 0.6f, 1.6f ) : 0.03f,
        .load = bends ? test_random_float( n, 21, 0.5f, 2.0f ) * 1e-3f : test_random_float( n, 22, 50.0f, 400.0f ),
        .ramp = bends ? ( n % 3 == 0 ? 0.2f : 40.0f ) : 0.0f,
        .damping = n % 4 == 0 ? 0.0f : test_random_float( n, 23, 0.0f, 0.1f ),
    };
    spring* l = s->link + n;
    l->ramp_end = bends ? find_ramp_end( (double)l->ramp * (double)l->rest / (double)l->load ) : 0.0f;
}

static inline void fill_springs( springs* s )
{
    memset( s, 0, sizeof( *s ) );
    for ( int row = 0; row < ROWS; ++row )
    {
        for ( int k = 0; k < 3 && row < VERTICES; ++k )
        {
            s->position[row][k] = test_random_float( row, k, -0.1f, 0.1f );
            s->velocity[row][k] = test_random_float( row, 3 + k, -1.0f, 1.0f );
            s->start[row][k] = test_random_float( row, 6 + k, -1.0f, 1.0f );
            s->direction[row][k] = test_random_float( row, 9 + k, -1.0f, 1.0f );
        }
        s->position[row][3] = row < VERTICES ? test_random_float( row, 12, 1e-4f, 1e-3f ) : 1.0f;
        s->direction[row][3] = s->position[row][3];
    }
    // two pairs of coincident vertices, and one without links
    memcpy( s->position[40], s->position[41], 3 * sizeof( float ) );
    memcpy( s->position[300], s->position[900], 3 * sizeof( float ) );
    add_spring( s, 40, 41, false );
    add_spring( s, 300, 900, true );
    for ( int i = 1; i < VERTICES; ++i )
    {
        const int near = 1 + test_random( i, 31, i < 20 ? i : 20 ), far = test_random( i, 32, VERTICES );
        add_spring( s, i, i - near, false );
        add_spring( s, i, far != i ? far : 1 + i % 7, i % 3 != 0 );
        add_spring( s, i, ( i + 13 ) % VERTICES, true );
    }
    place_entries( s );
}

// They are the same at each call, and made once: the ends of ramps are searched for.
static inline void copy_springs( springs* s )
{
    static _Alignas( 64 ) springs made;
    if ( made.link_count == 0 )
    {
        fill_springs( &made );
    }
    memcpy( s, &made, sizeof( *s ) );
}

static inline springs* new_springs( void )
{
    springs* s = new_aligned( sizeof( springs ) );
    copy_springs( s );
    return s;
}

static inline wisp_spring_links links_of( const springs* s )
{
    return ( wisp_spring_links ){
        .begin = s->begin,
        .other_x4 = s->other_x4,
        .rest = s->rest,
        .stiffness = s->load,
        .ramp_stiffness = s->ramp,
        .damping = s->damping,
        .ramp_end = s->ramp_end,
    };
}

static const float STEP = 1.0f / 120.0f;

enum
{
    REPEAT = 1,
    VARIANTS = 2,
};

static inline wisp_spring_args spring_args( springs* s, int variant )
{
    return ( wisp_spring_args ){
        .links = links_of( s ),
        .position = s->position[0],
        .velocity = s->velocity[0],
        .start_velocity = s->start[0],
        .dt = STEP,
        .is_repeat = ( variant & REPEAT ) != 0,
        .axis = s->axis,
        .rhs = s->rhs,
        .inverse = s->inverse,
    };
}

static inline void assemble( const wisp_kernels* k, springs* s, int variant )
{
    const wisp_spring_args args = spring_args( s, variant );
    s->undirected = k->spring_assemble( &args, 0, SLICES );
}

static inline wisp_conjugate_args conjugate( springs* s )
{
    return ( wisp_conjugate_args ){
        .links = links_of( s ),
        .axis = (const float( * )[4][8])s->axis,
        .inverse = (const float( * )[6][8])s->inverse,
        .filter = (const float( * )[6][8])s->filter,
        .filtered = s->filtered,
        .direction = s->direction[0],
        .product = s->product,
        .residual = s->rhs,
        .solution = s->solution,
        .search = s->search,
    };
}

// Every third slice is filtered: rows are free, slide, move along a line or stick.
static inline void make_filters( springs* s )
{
    for ( int row = 0; row < ROWS; ++row )
    {
        float n[3];
        for ( int k = 0; k < 3; ++k )
        {
            n[k] = test_random_float( row, 40 + k, -1.0f, 1.0f );
        }
        const float length = sqrtf( n[0] * n[0] + n[1] * n[1] + n[2] * n[2] );
        const int kind = row % 4;
        for ( int a = 0, i = 0; a < 3; ++a )
        {
            for ( int b = a; b < 3; ++b, ++i )
            {
                const float unit = a == b ? 1.0f : 0.0f, nn = n[a] * n[b] / ( length * length );
                s->filter[row / 8][i][row % 8] = kind == 0 ? unit : kind == 1 ? unit - nn : kind == 2 ? nn : 0.0f;
            }
        }
        s->filtered[row / 8] = row / 8 % 3 == 0 ? 1 : 0;
    }
}
