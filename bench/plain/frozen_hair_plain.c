#include "frozen_hair_plain.h"

#include "wisp/module/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float pi = 3.14159265358979323846f;

static wisp_vec3 add( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x + b.x, a.y + b.y, a.z + b.z };
}

static wisp_vec3 sub( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static wisp_vec3 scale( float s, wisp_vec3 a )
{
    return ( wisp_vec3 ){ s * a.x, s * a.y, s * a.z };
}

static float dot( wisp_vec3 a, wisp_vec3 b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static wisp_vec3 cross( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

static float length( wisp_vec3 a )
{
    return sqrtf( dot( a, a ) );
}

plain_frozen_hair_options plain_frozen_hair_default_options( void )
{
    plain_frozen_hair_options options = {
        .theta_max = pi / 4.0f,
        .cursor_radius = 0.15f,
        .clump_radius = 0.01f,
        .clump_iterations = 4,
        .clump_step = 0.001f,
        .min_distance = 0.0002f,
        .length_floor = 0.05f,
        .dimension = 3,
        .min_distance_clamp = true,
        .deform = true,
        .align = true,
    };
    return options;
}

// Memory

static bool create_grid( plain_hair_grid* grid, int vertex_count )
{
    size_t vertices = (size_t)vertex_count + 1;
    grid->bucket_count = 16;
    while ( grid->bucket_count < 2 * vertex_count && grid->bucket_count < 1 << 29 )
    {
        grid->bucket_count *= 2;
    }
    grid->bucket_begin = malloc( ( (size_t)grid->bucket_count + 1 ) * sizeof( int ) );
    grid->entry_vertex = malloc( vertices * sizeof( int ) );
    grid->entry_key = malloc( vertices * sizeof( uint64_t ) );
    grid->cell_key = malloc( vertices * sizeof( uint64_t ) );
    return grid->bucket_begin != NULL && grid->entry_vertex != NULL && grid->entry_key != NULL &&
           grid->cell_key != NULL;
}

static void destroy_grid( plain_hair_grid* grid )
{
    free( grid->bucket_begin );
    free( grid->entry_vertex );
    free( grid->entry_key );
    free( grid->cell_key );
}

static bool allocate( plain_frozen_hair* hair )
{
    size_t strands = (size_t)hair->strand_count + 1, vertices = (size_t)hair->vertex_count + 1;
    hair->offsets = malloc( strands * sizeof( int ) );
    hair->strand_of = malloc( vertices * sizeof( int ) );
    hair->stretch_stiffness = malloc( strands * sizeof( float ) );
    hair->bend_stiffness = malloc( strands * sizeof( float ) );
    hair->intensity = malloc( strands * sizeof( float ) );
    wisp_vec3** points[] = { &hair->rest,     &hair->deformed, &hair->aligned,
                             &hair->position, &hair->step,     &hair->tentative };
    bool ok = hair->offsets != NULL && hair->strand_of != NULL && hair->stretch_stiffness != NULL &&
              hair->bend_stiffness != NULL && hair->intensity != NULL;
    for ( int n = 0; n < WISP_COUNT( points ); ++n )
    {
        *points[n] = malloc( vertices * sizeof( wisp_vec3 ) );
        ok = ok && *points[n] != NULL;
    }
    bool grids = create_grid( &hair->aligned_grid, hair->vertex_count );
    return create_grid( &hair->grid, hair->vertex_count ) && grids && ok;
}

bool plain_frozen_hair_create( plain_frozen_hair* hair, int strand_count, const int* offsets, const float* xyz,
                               const float* stretch_stiffness, const float* bend_stiffness, const float* intensity,
                               const plain_frozen_hair_options* options )
{
    memset( hair, 0, sizeof( *hair ) );
    hair->options = *options;
    hair->strand_count = strand_count;
    hair->vertex_count = offsets[strand_count];
    if ( !allocate( hair ) )
    {
        plain_frozen_hair_destroy( hair );
        return false;
    }
    memcpy( hair->offsets, offsets, ( (size_t)strand_count + 1 ) * sizeof( int ) );
    for ( int s = 0; s < strand_count; ++s )
    {
        hair->stretch_stiffness[s] = stretch_stiffness != NULL ? stretch_stiffness[s] : 7.0f;
        hair->bend_stiffness[s] = bend_stiffness != NULL ? bend_stiffness[s] : 7.0f;
        hair->intensity[s] = intensity != NULL ? intensity[s] : 0.8f;
        for ( int v = offsets[s]; v < offsets[s + 1]; ++v )
        {
            hair->strand_of[v] = s;
            hair->rest[v] = ( wisp_vec3 ){ xyz[3 * v], xyz[3 * v + 1], xyz[3 * v + 2] };
            hair->position[v] = hair->aligned[v] = hair->rest[v];
        }
    }
    return true;
}

void plain_frozen_hair_destroy( plain_frozen_hair* hair )
{
    free( hair->offsets );
    free( hair->strand_of );
    free( hair->stretch_stiffness );
    free( hair->bend_stiffness );
    free( hair->intensity );
    free( hair->rest );
    free( hair->deformed );
    free( hair->aligned );
    free( hair->position );
    free( hair->step );
    free( hair->tentative );
    destroy_grid( &hair->aligned_grid );
    destroy_grid( &hair->grid );
    memset( hair, 0, sizeof( *hair ) );
}

// Limits: the same as the engine's and the oracle's

static bool within( float value, float lower, float upper )
{
    return value >= lower && value <= upper; // false for a NaN
}

static bool is_coordinate( wisp_vec3 p )
{
    return within( p.x, -1e6f, 1e6f ) && within( p.y, -1e6f, 1e6f ) && within( p.z, -1e6f, 1e6f );
}

static bool acceptable( const plain_frozen_hair* hair )
{
    const plain_frozen_hair_options* o = &hair->options;
    bool ok = within( o->theta_max, 0.0f, pi ) && within( o->cursor_radius, 0.0f, 1e6f ) &&
              within( o->clump_step, 0.0f, 1e6f ) && within( o->min_distance, 0.0f, 1e6f ) &&
              within( o->lambda_min, 0.0f, 1.0f ) && within( o->length_floor, 0.0f, 1.0f ) &&
              is_coordinate( o->cursor ) && ( o->dimension == 2 || o->dimension == 3 ) && o->clump_iterations >= 0 &&
              o->clump_iterations <= 1000 &&
              ( o->clump_iterations == 0 || ( o->clump_radius > 0.0f && o->clump_radius <= 1e6f ) );
    for ( int s = 0; s < hair->strand_count && ok; ++s )
    {
        ok = within( hair->stretch_stiffness[s], 1e-3f, 1e12f ) && within( hair->bend_stiffness[s], 1e-3f, 1e12f ) &&
             within( hair->intensity[s], 0.0f, 1.0f );
    }
    for ( int v = 0; v < hair->vertex_count && ok; ++v )
    {
        ok = is_coordinate( hair->rest[v] );
    }
    return ok;
}

// Stage 1: stretch and bend every segment at random (Eq. 2-7)

// R(axis, angle) v without the matrix, given the sine and cosine of the angle (Eq. 5).
static wisp_vec3 rotate( wisp_vec3 axis, float sine, float cosine, wisp_vec3 v )
{
    wisp_vec3 along = scale( ( 1.0f - cosine ) * dot( axis, v ), axis );
    return add( add( scale( cosine, v ), along ), scale( sine, cross( axis, v ) ) );
}

// Two unit vectors perpendicular to a unit vector (Duff et al. 2017).
static void frame( wisp_vec3 t, wisp_vec3* b1, wisp_vec3* b2 )
{
    float sign = t.z >= 0.0f ? 1.0f : -1.0f;
    float a = -1.0f / ( sign + t.z );
    float b = t.x * t.y * a;
    *b1 = ( wisp_vec3 ){ 1.0f + sign * t.x * t.x * a, sign * b, -sign * t.x };
    *b2 = ( wisp_vec3 ){ b, sign + t.y * t.y * a, -t.y };
}

// The axis for straight hair and for the first segment: any perpendicular one, always the same for a vertex.
static wisp_vec3 fallback_axis( wisp_vec3 t, int dimension, wisp_random_key key, uint32_t s, uint32_t i )
{
    if ( dimension == 2 )
    {
        return ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f };
    }
    wisp_vec3 b1, b2;
    float psi = 2.0f * pi * wisp_random_unit_float( key, s, i, 0 );
    frame( t, &b1, &b2 );
    return add( scale( cosf( psi ), b1 ), scale( sinf( psi ), b2 ) );
}

typedef struct deform_keys
{
    wisp_random_key eta, xi, psi;
} deform_keys;

static void deform_strand( plain_frozen_hair* hair, const deform_keys* keys, int s )
{
    const plain_frozen_hair_options* o = &hair->options;
    float alpha_s = 1.0f / hair->stretch_stiffness[s];
    float alpha_b = 1.0f / hair->bend_stiffness[s];
    int first = hair->offsets[s];
    wisp_vec3 previous = { 0.0f, 0.0f, 0.0f };
    if ( first < hair->offsets[s + 1] )
    {
        hair->deformed[first] = hair->rest[first];
    }
    for ( int v = first + 1; v < hair->offsets[s + 1]; ++v )
    {
        uint32_t i = (uint32_t)( v - first );
        wisp_vec3 d = sub( hair->rest[v], hair->rest[v - 1] );
        float l0 = length( d );
        wisp_vec3 t = l0 > 1e-12f ? scale( 1.0f / l0, d ) : previous;

        wisp_vec3 axis = cross( previous, t );
        float sine = length( axis );
        if ( i > 1 && sine >= 1e-8f )
        {
            axis = scale( 1.0f / sine, axis );
        }
        else
        {
            axis = fallback_axis( t, o->dimension, keys->psi, (uint32_t)s, i );
        }

        float eta = 2.0f * wisp_random_unit_float( keys->eta, (uint32_t)s, i, 0 ) - 1.0f;
        float xi = 2.0f * wisp_random_unit_float( keys->xi, (uint32_t)s, i, 0 ) - 1.0f;
        float target = fmaxf( l0 * ( 1.0f + alpha_s * eta ), o->length_floor * l0 );
        float theta = o->theta_max * alpha_b * xi;
        wisp_vec3 bent = rotate( axis, sinf( theta ), cosf( theta ), t );
        hair->deformed[v] = add( hair->deformed[v - 1], scale( target, bent ) );
        previous = t;
    }
}

static void deform( plain_frozen_hair* hair )
{
    const plain_frozen_hair_options* o = &hair->options;
    deform_keys keys = {
        .eta = wisp_random_make_key( o->seed, 1, o->event ),
        .xi = wisp_random_make_key( o->seed, 2, o->event ),
        .psi = wisp_random_make_key( o->seed, 4, 0 ),
    };
    for ( int s = 0; s < hair->strand_count; ++s )
    {
        deform_strand( hair, &keys, s );
    }
}

// Stage 2: turn strands whose tip is near the cursor (Eq. 8-13)

// The rotation of a strand; false when the strand stays as it is.
static bool find_turn( const plain_frozen_hair* hair, int s, wisp_vec3* axis, float* phi )
{
    const plain_frozen_hair_options* o = &hair->options;
    const wisp_vec3* p = hair->deformed + hair->offsets[s];
    int count = hair->offsets[s + 1] - hair->offsets[s];
    if ( count < 2 || length( sub( p[count - 1], o->cursor ) ) > o->cursor_radius )
    {
        return false;
    }
    wisp_vec3 sum = { 0.0f, 0.0f, 0.0f };
    for ( int i = 0; i < count; ++i )
    {
        sum = add( sum, p[i] );
    }
    wisp_vec3 v = sub( p[count - 1], scale( 1.0f / (float)count, sum ) );
    wisp_vec3 u = sub( o->cursor, p[0] );
    float v_length = length( v ), u_length = length( u );
    if ( v_length < 1e-12f || u_length < 1e-12f )
    {
        return false;
    }

    wisp_vec3 c = cross( v, u );
    float c_length = length( c );
    *phi = atan2f( c_length, dot( v, u ) );
    if ( c_length > 1e-12f * v_length * u_length )
    {
        *axis = scale( 1.0f / c_length, c );
    }
    else if ( o->dimension == 2 )
    {
        *axis = ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f };
    }
    else
    {
        wisp_vec3 unused;
        frame( scale( 1.0f / v_length, v ), axis, &unused );
    }
    return true;
}

static void turn_strand( plain_frozen_hair* hair, int s, wisp_vec3 axis, float phi )
{
    int first = hair->offsets[s], count = hair->offsets[s + 1] - first;
    wisp_vec3 root = hair->deformed[first];
    float x = hair->intensity[s], fraction = ( 1.0f - x ) / (float)( count - 1 );
    float sine = sinf( phi ), cosine = cosf( phi );
    for ( int i = 0; i < count; ++i )
    {
        float w = x + fraction * (float)i;
        wisp_vec3 arm = sub( hair->deformed[first + i], root ), turned;
        if ( hair->options.blend == PLAIN_HAIR_BLEND_ARC )
        {
            turned = rotate( axis, sinf( w * phi ), cosf( w * phi ), arm );
        }
        else
        {
            turned = add( scale( w, rotate( axis, sine, cosine, arm ) ), scale( 1.0f - w, arm ) );
        }
        hair->aligned[first + i] = add( root, turned );
    }
}

static void align( plain_frozen_hair* hair )
{
    memcpy( hair->aligned, hair->deformed, (size_t)hair->vertex_count * sizeof( wisp_vec3 ) );
    for ( int s = 0; s < hair->strand_count; ++s )
    {
        wisp_vec3 axis;
        float phi;
        if ( find_turn( hair, s, &axis, &phi ) )
        {
            turn_strand( hair, s, axis, phi );
        }
    }
}

// The grid. Cells are a thousandth wider than h, so that a pair nearer than h is in neighbouring cells in spite of
// the rounding of the cell number.

static const int key_bits = 21;

static uint64_t cell_number( float coordinate, float cells_per_metre )
{
    return (uint64_t)(int64_t)floorf( coordinate * cells_per_metre ) & ( ( 1u << key_bits ) - 1u );
}

static uint64_t pack_cell( uint64_t x, uint64_t y, uint64_t z )
{
    const uint64_t mask = ( 1u << key_bits ) - 1u;
    return ( x & mask ) | ( y & mask ) << key_bits | ( z & mask ) << 2 * key_bits;
}

static int bucket_of( const plain_hair_grid* grid, uint64_t key )
{
    uint64_t hash = key * 0x9e3779b97f4a7c15u;
    return (int)( ( hash >> 32 ) & ( (uint64_t)grid->bucket_count - 1 ) );
}

static void build_grid( plain_hair_grid* grid, const wisp_vec3* p, int count, float h )
{
    float cells_per_metre = 1.0f / ( 1.001f * h );
    int* begin = grid->bucket_begin;

    // count the entries of every bucket
    memset( begin, 0, ( (size_t)grid->bucket_count + 1 ) * sizeof( int ) );
    for ( int v = 0; v < count; ++v )
    {
        grid->cell_key[v] = pack_cell( cell_number( p[v].x, cells_per_metre ), cell_number( p[v].y, cells_per_metre ),
                                       cell_number( p[v].z, cells_per_metre ) );
        begin[bucket_of( grid, grid->cell_key[v] )] += 1;
    }

    // sum up, so that each bucket has its end; filling backwards then turns ends into beginnings
    int sum = 0;
    for ( int b = 0; b <= grid->bucket_count; ++b )
    {
        sum += begin[b];
        begin[b] = sum;
    }
    for ( int v = count - 1; v >= 0; --v )
    {
        int entry = --begin[bucket_of( grid, grid->cell_key[v] )];
        grid->entry_vertex[entry] = v;
        grid->entry_key[entry] = grid->cell_key[v];
    }
}

// The cells around a vertex, 9 in the plane and 27 in space.
static int cells_round( const plain_hair_grid* grid, int v, int dimension, uint64_t cells[27] )
{
    uint64_t key = grid->cell_key[v];
    uint64_t x = key, y = key >> key_bits, z = key >> 2 * key_bits;
    int depth = dimension == 2 ? 0 : 1, count = 0;
    for ( int k = -depth; k <= depth; ++k )
    {
        for ( int j = -1; j <= 1; ++j )
        {
            for ( int i = -1; i <= 1; ++i )
            {
                cells[count++] = pack_cell( x + (uint64_t)i, y + (uint64_t)j, z + (uint64_t)k );
            }
        }
    }
    return count;
}

// Stage 3: clump with gaps (Eq. 14-19)

// sigma times the adhesion of one vertex, limited by the overshoot guard.
static wisp_vec3 tentative_step( const plain_frozen_hair* hair, const plain_hair_grid* grid, int v )
{
    const plain_frozen_hair_options* o = &hair->options;
    const wisp_vec3* p = hair->position;
    float h = o->clump_radius, inverse_h = 1.0f / h, nearest2 = h * h;
    wisp_vec3 force = { 0.0f, 0.0f, 0.0f };
    uint64_t cells[27];
    int cell_count = cells_round( grid, v, o->dimension, cells );
    for ( int c = 0; c < cell_count; ++c )
    {
        int bucket = bucket_of( grid, cells[c] );
        for ( int n = grid->bucket_begin[bucket]; n < grid->bucket_begin[bucket + 1]; ++n )
        {
            int q = grid->entry_vertex[n];
            if ( grid->entry_key[n] != cells[c] || hair->strand_of[q] == hair->strand_of[v] )
            {
                continue;
            }
            wisp_vec3 d = sub( p[q], p[v] );
            float r2 = dot( d, d );
            if ( r2 == 0.0f || r2 >= h * h )
            {
                continue;
            }
            float r = sqrtf( r2 );
            float rest = 1.0f - r * inverse_h;
            force = add( force, scale( rest * rest / r, d ) );
            nearest2 = r2 < nearest2 ? r2 : nearest2;
        }
    }

    wisp_vec3 step = scale( o->clump_step, force );
    float step_length = length( step );
    float limit = fmaxf( 0.0f, 0.5f * ( sqrtf( nearest2 ) - o->min_distance ) );
    return o->min_distance_clamp && step_length > limit ? scale( limit / step_length, step ) : step;
}

static float pair_delta( plain_hair_gap gap, float r0, float r1, float inverse_h )
{
    float change = r1 - r0;
    if ( gap == PLAIN_HAIR_GAP_REVERSED )
    {
        change = -change;
    }
    else if ( gap == PLAIN_HAIR_GAP_ABSOLUTE )
    {
        change = fabsf( change );
    }
    // comparisons, because fminf and fmaxf are library calls unless NaN may be ignored
    float fraction = change * inverse_h;
    return fraction < 0.0f ? 0.0f : fraction > 1.0f ? 1.0f : fraction;
}

// Change of the distances around one vertex, weighted by the kernel in the reference shape.
static float vertex_delta( const plain_frozen_hair* hair, const plain_hair_grid* grid, const wisp_vec3* reference,
                           int v )
{
    const plain_frozen_hair_options* o = &hair->options;
    float h = o->clump_radius, inverse_h = 1.0f / h, weighted = 0.0f, weights = 0.0f;
    uint64_t cells[27];
    int cell_count = cells_round( grid, v, o->dimension, cells );
    for ( int c = 0; c < cell_count; ++c )
    {
        int bucket = bucket_of( grid, cells[c] );
        for ( int n = grid->bucket_begin[bucket]; n < grid->bucket_begin[bucket + 1]; ++n )
        {
            int q = grid->entry_vertex[n];
            if ( grid->entry_key[n] != cells[c] || hair->strand_of[q] == hair->strand_of[v] )
            {
                continue;
            }
            wisp_vec3 d0 = sub( reference[q], reference[v] );
            float r0_squared = dot( d0, d0 );
            if ( r0_squared == 0.0f || r0_squared >= h * h )
            {
                continue;
            }
            float r0 = sqrtf( r0_squared );
            float r1 = length( sub( hair->tentative[q], hair->tentative[v] ) );
            float rest = 1.0f - r0 * inverse_h;
            weighted += rest * rest * pair_delta( o->gap, r0, r1, inverse_h );
            weights += rest * rest;
        }
    }
    return weights > 0.0f ? weighted / weights : 0.0f;
}

static float brake( const plain_frozen_hair_options* o, float delta, float zeta )
{
    float at_full_change = o->gap == PLAIN_HAIR_GAP_ABSOLUTE ? o->lambda_min : 1.0f;
    return ( 1.0f - delta ) * zeta + delta * at_full_change;
}

// One iteration: steps of all vertices first, then the brake, which uses all of their targets.
static void clump_once( plain_frozen_hair* hair, const plain_hair_grid* grid, int iteration )
{
    const plain_frozen_hair_options* o = &hair->options;
    for ( int v = 0; v < hair->vertex_count; ++v )
    {
        bool is_root = v == hair->offsets[hair->strand_of[v]];
        hair->step[v] = is_root ? ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } : tentative_step( hair, grid, v );
        hair->tentative[v] = add( hair->position[v], hair->step[v] );
    }
    if ( o->gap == PLAIN_HAIR_GAP_NONE )
    {
        memcpy( hair->position, hair->tentative, (size_t)hair->vertex_count * sizeof( wisp_vec3 ) );
        return;
    }

    // positions may be the reference of the brake, so they are written only when every brake is known
    bool from_stage = o->gap_reference == PLAIN_HAIR_GAP_REFERENCE_STAGE;
    const plain_hair_grid* reference_grid = from_stage ? &hair->aligned_grid : grid;
    const wisp_vec3* reference = from_stage ? hair->aligned : hair->position;
    wisp_random_key key = wisp_random_make_key( o->seed, 3, o->event );
    for ( int v = 0; v < hair->vertex_count; ++v )
    {
        int s = hair->strand_of[v], i = v - hair->offsets[s];
        if ( i > 0 )
        {
            float zeta = wisp_random_unit_float( key, (uint32_t)s, (uint32_t)i, (uint32_t)iteration );
            float lambda = brake( o, vertex_delta( hair, reference_grid, reference, v ), zeta );
            hair->step[v] = scale( lambda, hair->step[v] );
        }
    }
    for ( int v = 0; v < hair->vertex_count; ++v )
    {
        hair->position[v] = add( hair->position[v], hair->step[v] );
    }
}

static void clump( plain_frozen_hair* hair )
{
    const plain_frozen_hair_options* o = &hair->options;
    size_t bytes = (size_t)hair->vertex_count * sizeof( wisp_vec3 );
    memcpy( hair->position, hair->aligned, bytes );
    for ( int k = 0; k < o->clump_iterations; ++k )
    {
        // the first iteration starts at p'', whose grid the brake uses too
        plain_hair_grid* grid = k == 0 ? &hair->aligned_grid : &hair->grid;
        build_grid( grid, hair->position, hair->vertex_count, o->clump_radius );
        clump_once( hair, grid, k );
    }
}

bool plain_frozen_hair_run( plain_frozen_hair* hair )
{
    if ( !acceptable( hair ) )
    {
        return false;
    }
    size_t bytes = (size_t)hair->vertex_count * sizeof( wisp_vec3 );
    if ( hair->options.deform )
    {
        deform( hair );
    }
    else
    {
        memcpy( hair->deformed, hair->rest, bytes );
    }
    if ( hair->options.align )
    {
        align( hair );
    }
    else
    {
        memcpy( hair->aligned, hair->deformed, bytes );
    }
    clump( hair );
    return true;
}

double plain_frozen_hair_mean_neighbours( plain_frozen_hair* hair )
{
    const plain_frozen_hair_options* o = &hair->options;
    double pairs = 0.0;
    if ( hair->vertex_count == 0 || !( o->clump_radius > 0.0f ) )
    {
        return 0.0;
    }
    build_grid( &hair->grid, hair->aligned, hair->vertex_count, o->clump_radius );
    for ( int v = 0; v < hair->vertex_count; ++v )
    {
        uint64_t cells[27];
        int cell_count = cells_round( &hair->grid, v, o->dimension, cells );
        for ( int c = 0; c < cell_count; ++c )
        {
            int bucket = bucket_of( &hair->grid, cells[c] );
            for ( int n = hair->grid.bucket_begin[bucket]; n < hair->grid.bucket_begin[bucket + 1]; ++n )
            {
                int q = hair->grid.entry_vertex[n];
                wisp_vec3 d = sub( hair->aligned[q], hair->aligned[v] );
                float r2 = dot( d, d );
                pairs += hair->grid.entry_key[n] == cells[c] && hair->strand_of[q] != hair->strand_of[v] &&
                         r2 > 0.0f && r2 < o->clump_radius * o->clump_radius;
            }
        }
    }
    return pairs / hair->vertex_count;
}
