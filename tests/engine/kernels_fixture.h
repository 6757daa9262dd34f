/// Every kernel table that runs on this processor, and constraints between particles for tests of kernels.
#pragma once

#include "support.h"

#include "oracle/double3.h"
#include "kernel_tables.h"

#include "wisp/base.h"

extern const wisp_kernels kernels_plain;
#if defined( TEST_AVX512_EMULATED )
extern const wisp_kernels kernels_avx512_emulated;
#endif

enum
{
    MAX_TABLES = 5,
};

/// Every table of the processor, the one without intrinsics, and AVX-512 emulated; NULL behind the last one.
static inline const wisp_kernels* const* every_table( void )
{
    static const wisp_kernels* tables[MAX_TABLES + 1];
    int count = 0;
    tables[count++] = kernels_select( "baseline", NULL );
    tables[count++] = &kernels_plain;
#if defined( TEST_AVX512_EMULATED )
    tables[count++] = &kernels_avx512_emulated;
#endif
    const char* const caps[] = { "avx2", "avx512" };
    for ( int i = 0; i < WISP_COUNT( caps ); ++i )
    {
        const wisp_kernels* k = kernels_select( caps[i], NULL );
        if ( strcmp( k->isa, caps[i] ) == 0 )
        {
            tables[count++] = k;
        }
    }
    return tables;
}

/// The widest table without emulation.
static inline const wisp_kernels* widest_table( void )
{
    return kernels_select( "avx512", NULL );
}

/// Fails for NaN too.
static inline void assert_near( double found, double expected, double tolerance, const char* what, int number )
{
    if ( !( fabs( found - expected ) <= tolerance ) )
    {
        fail_msg( "%s %d: %.9g, expected %.9g within %.2g", what, number, found, expected, tolerance );
    }
}

/// Each component is near.
static inline void assert_near3( double3 found, double3 expected, double tolerance, const char* what, int number )
{
    assert_near( found.x, expected.x, tolerance, what, number );
    assert_near( found.y, expected.y, tolerance, what, number );
    assert_near( found.z, expected.z, tolerance, what, number );
}

/// The distance is small.
static inline void assert_near_vector( double3 found, double3 expected, double tolerance, const char* what,
                                       int number )
{
    assert_near( double3_distance( found, expected ), 0.0, tolerance, what, number );
}

/// Clear what follows the used elements of an array, which kernels leave open.
#define FORGET_BEHIND( array, used )                                                                                 \
    memset( ( array ) + ( used ), 0, sizeof( array ) - (size_t)( used ) * sizeof( ( array )[0] ) )

/// The vector of a lane in rows of eight.
static inline double3 lane_vector( float ( *rows )[8], int lane )
{
    return double3_make( (double)rows[0][lane], (double)rows[1][lane], (double)rows[2][lane] );
}

/// Zeros at a cache line. Free with free().
static inline void* new_aligned( size_t size )
{
    void* memory = aligned_alloc( 64, ( size + 63 ) / 64 * 64 );
    assert_non_null( memory );
    return memset( memory, 0, ( size + 63 ) / 64 * 64 );
}

// ---- rows ----

/// A case of kernels: a state with their arguments and outputs, how to run them, and what must hold afterwards.
typedef struct kernel_row
{
    const char* name;
    size_t size;                                ///< of the state, in bytes
    int variants;                               ///< 0 is 1
    int begin, end;                             ///< range to run
    int grain;                                  ///< smallest range; 0: may not be cut
    void ( *fill )( void* state, int variant ); ///< of zeros
    void ( *run )( const wisp_kernels* kernels, void* state, int begin, int end );
    void ( *check )( void* start, void* end ); ///< by the oracle; NULL: none
    void ( *release )( void* start );          ///< of what a state points to; NULL: nothing
} kernel_row;

/// The same bits, but for the sign of what is no number, which arithmetic leaves open.
static inline bool are_same_bits( uint32_t a, uint32_t b )
{
    const uint32_t nan = 0x7fc00000u, sign = 0x80000000u;
    return a == b || ( ( a | sign ) == ( nan | sign ) && ( b | sign ) == ( nan | sign ) );
}

static inline void assert_same_state( const kernel_row* row, int variant, const char* how, const void* found,
                                      const void* expected )
{
    const uint32_t *a = found, *b = expected;
    for ( size_t i = 0; memcmp( found, expected, row->size ) != 0 && i < row->size / sizeof( uint32_t ); ++i )
    {
        if ( are_same_bits( a[i], b[i] ) == false )
        {
            float numbers[2];
            memcpy( numbers, a + i, sizeof( float ) );
            memcpy( numbers + 1, b + i, sizeof( float ) );
            fail_msg( "%s, variant %d, %s: number %zu of the state is %.9g, expected %.9g", row->name, variant, how,
                      i, (double)numbers[0], (double)numbers[1] );
        }
    }
}

/// Cut into one, two, three, one ... grains.
static inline void run_cut( const kernel_row* row, void* state )
{
    for ( int begin = row->begin, n = 0; begin < row->end; ++n )
    {
        const int most = begin + ( 1 + n % 3 ) * row->grain, end = most < row->end ? most : row->end;
        row->run( widest_table(), state, begin, end );
        begin = end;
    }
}

/// Every table and every cut gives the same bits of the whole state, which changes and passes the check.
static inline void check_kernel( const kernel_row* row )
{
    SCOPED( free_local )
    void *start = new_aligned( row->size ), *first = new_aligned( row->size ), *other = new_aligned( row->size );
    for ( int variant = 0; variant == 0 || variant < row->variants; ++variant )
    {
        memset( start, 0, row->size );
        row->fill( start, variant );
        memcpy( first, start, row->size );
        row->run( every_table()[0], first, row->begin, row->end );
        assert_memory_not_equal( first, start, row->size );
        for ( const wisp_kernels* const* k = every_table() + 1; *k != NULL; ++k )
        {
            memcpy( other, start, row->size );
            row->run( *k, other, row->begin, row->end );
            assert_same_state( row, variant, ( *k )->isa, other, first );
        }
        if ( row->grain > 0 )
        {
            memcpy( other, start, row->size );
            run_cut( row, other );
            assert_same_state( row, variant, "cut", other, first );
        }
        if ( row->check != NULL )
        {
            row->check( start, first );
        }
        if ( row->release != NULL )
        {
            row->release( start );
        }
    }
}

/// A row whose state is of a type; its name is that of the test.
#define KERNEL_ROW( type, variants_, begin_, end_, grain_, fill_, run_, check_ )                                     \
    &( kernel_row )                                                                                                  \
    {                                                                                                                \
        .name = __func__, .size = sizeof( type ), .variants = variants_, .begin = begin_, .end = end_,               \
        .grain = grain_, .fill = fill_, .run = run_, .check = check_                                                 \
    }

/// Define the case of such a row.
#define TEST_KERNEL( name, ... )                                                                                     \
    TEST( name )                                                                                                     \
    {                                                                                                                \
        check_kernel( KERNEL_ROW( __VA_ARGS__ ) );                                                                   \
    }

/// Define how to run one kernel, with arguments that a function makes of the state.
#define RUN_KERNEL( name, kernel, args_type, args_of )                                                               \
    static void name( const wisp_kernels* kernels, void* state, int begin, int end )                                 \
    {                                                                                                                \
        const args_type args = args_of( state );                                                                     \
        kernels->kernel( &args, begin, end );                                                                        \
    }

// ---- rings ----

enum
{
    RING = 7, // entries of a slice
    RING_SLOTS = 64,
};

/// Fans of triangles around vertices. Every third one is short: its own slot pads.
static inline void make_rings( int32_t begin[RING_SLOTS / 8 + 1], int32_t ring_x4[RING_SLOTS / 8 * RING][8] )
{
    for ( int i = 0; i < RING_SLOTS * RING; ++i )
    {
        const int own = i / RING, e = i % RING, other = ( own + 1 + e * 7 % 5 + e ) % RING_SLOTS;
        begin[own / 8 + 1] = ( own / 8 + 1 ) * RING;
        ring_x4[own / 8 * RING + e][own % 8] = 4 * ( own % 3 == 0 && e > 3 ? own : other );
    }
}

// ---- constraints ----

enum
{
    GROUPS = 32,
    CONSTRAINTS = 8 * GROUPS,
    BODIES = 4 * CONSTRAINTS,
};

/// Constraints of up to four particles, and all arrays that their arguments point to.
typedef struct constraints
{
    _Alignas( 64 ) float position[BODIES][4];
    int32_t slot_x4[GROUPS][4][8];                // corners of hinges; the first two are ends of links
    int32_t a_x4[CONSTRAINTS], b_x4[CONSTRAINTS]; // the same two, in the layout of links
    float rest[CONSTRAINTS];                      // m
    float angle[CONSTRAINTS];                     // rad
    float weights[GROUPS][4][8];                  // of isometric hinges
    float scale[CONSTRAINTS];                     // 1/m^2
    float stiffness[CONSTRAINTS];
    float compliance[CONSTRAINTS];
    float lambda[CONSTRAINTS];
} constraints;

static inline void set_slot( constraints* s, int c, int corner, int slot )
{
    s->slot_x4[c / 8][corner][c % 8] = 4 * slot;
    s->a_x4[c] = corner == 0 ? 4 * slot : s->a_x4[c];
    s->b_x4[c] = corner == 1 ? 4 * slot : s->b_x4[c];
}

static inline float* body( constraints* s, int c, int corner )
{
    return s->position[s->slot_x4[c / 8][corner][c % 8] / 4];
}

static inline void place( constraints* s, int c, int corner, float x, float y, float z, float w )
{
    const float quad[4] = { x, y, z, w };
    memcpy( body( s, c, corner ), quad, sizeof( quad ) );
}

/// Each constraint has its own particles: an edge of about half a metre and two triangles on it, folded by any angle
/// but a full turn. Inverse masses 1, 1, 3, and 0 where `pins`, so that ratios of two ends are 1:1, 1:3 and 0:1.
static inline void make_constraints( constraints* s, bool pins )
{
    memset( s, 0, sizeof( *s ) );
    for ( int c = 0; c < CONSTRAINTS; ++c )
    {
        float length = test_random_float( c, 0, 0.3f, 0.8f ), fold = test_random_float( c, 1, -2.6f, 2.6f );
        float turn = test_random_float( c, 2, -3.0f, 3.0f ), up[2], along[2];
        for ( int k = 0; k < 2; ++k )
        {
            up[k] = test_random_float( c, 3 + k, 0.2f, 0.7f );
            along[k] = test_random_float( c, 5 + k, -0.2f, 0.8f ) * length;
        }
        const float at[4][3] = {
            { 0.0f, 0.0f, 0.0f },
            { length, 0.0f, 0.0f },
            { along[0], up[0] * cosf( turn ), up[0] * sinf( turn ) },
            { along[1], -up[1] * cosf( turn + fold ), -up[1] * sinf( turn + fold ) },
        };
        for ( int k = 0; k < 4; ++k )
        {
            const float weight[4] = { 1.0f, 3.0f, pins ? 0.0f : 2.0f, 1.0f };
            set_slot( s, c, k, ( 4 * c + k ) * 37 % BODIES );
            place( s, c, k, at[k][0] + test_random_float( c, 7, -1.0f, 1.0f ),
                   at[k][1] + test_random_float( c, 8, -1.0f, 1.0f ), at[k][2],
                   weight[( c + k * ( 1 + c % 3 ) ) % 4] );
        }
        // they sum to 0 without rounding
        float of_i = 0.25f * (float)( 1 + c % 7 ), of_j = 0.5f * (float)( 1 + c % 5 ), ends = of_i + of_j;
        const float weights[4] = { of_i, of_j, -0.25f * ends, -0.75f * ends };
        for ( int k = 0; k < 4; ++k )
        {
            s->weights[c / 8][k][c % 8] = weights[k];
        }
        s->stiffness[c] = test_random_float( c, 11, 0.0f, 1.0f );
        s->compliance[c] = c % 4 == 0 ? 0.0f : test_random_float( c, 12, 0.0f, 1e-4f );
        s->lambda[c] = test_random_float( c, 13, -1e-3f, 1e-3f );
        s->rest[c] = length * test_random_float( c, 14, 0.5f, 1.5f );
        s->angle[c] = test_random_float( c, 16, -3.1f, 3.1f );
        s->scale[c] = test_random_float( c, 15, 1.0f, 30.0f );
    }
}

/// The same constraints on 64 particles that many groups share, no two lanes of a group.
static inline void tangle( constraints* s )
{
    for ( int c = 0; c < CONSTRAINTS; ++c )
    {
        for ( int k = 0; k < 4; ++k )
        {
            set_slot( s, c, k, ( ( c % 8 * 4 + k ) * 5 + c / 8 * 7 ) % 64 );
        }
    }
}

static inline wisp_link_args link_args( constraints* s )
{
    static const uint8_t NO_BENDS[CONSTRAINTS / 8 + 3];
    return ( wisp_link_args ){
        .position = s->position[0],
        .a_x4 = s->a_x4,
        .b_x4 = s->b_x4,
        .rest = s->rest,
        .own = s->compliance,
        .bends = NO_BENDS,
        .lambda = s->lambda,
        .inverse_dt2 = 1e4f,
        .minimum = 0.9f,
        .maximum = 1.1f,
    };
}

/// Without a stiffness it is xpbd.
static inline wisp_hinge_args hinge_args( constraints* s, bool isometric, bool pbd )
{
    return ( wisp_hinge_args ){
        .position = s->position[0],
        .slot_x4 = s->slot_x4[0][0],
        .rest = isometric ? s->weights[0][0] : s->angle,
        .stiffness = pbd ? s->stiffness : NULL,
        .compliance = s->compliance,
        .lambda = s->lambda,
        .inverse_dt2 = 1e4f,
    };
}
