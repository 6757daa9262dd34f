// Meshes and strands from a few numbers. Only + - * /, square roots and the engine's own sine: the same arguments give the same bits
// with every compiler and C library.
#include "wisp/generate.h"

#include "trig.h"

#include "wisp/module/definition.h"

#include <math.h>

static const float LARGEST_SIZE = 1e6f;   // m
static const float SMALLEST_SIZE = 1e-6f; // m

// ---- checks ----

// The arguments of a function, checked one after another; the first wrong one makes the message.
typedef struct checks
{
    const char* what;
    wisp_error* error;
    wisp_status status;
} checks;

static void check_count( checks* c, const char* name, int value, int lower )
{
    if ( c->status == WISP_OK && ( value < lower || value > WISP_GENERATE_MAX_VERTICES ) )
    {
        c->status = wisp_fail( c->error, WISP_BAD_INPUT, "%s: %s: got %d, expected %d to %d", c->what, name, value,
                               lower, WISP_GENERATE_MAX_VERTICES );
    }
}

static void check_size( checks* c, const char* name, float value, float upper )
{
    if ( c->status == WISP_OK && !( value >= SMALLEST_SIZE && value <= upper ) )
    {
        c->status = wisp_fail( c->error, WISP_BAD_INPUT, "%s: %s: got %g m, expected %g to %g", c->what, name,
                               (double)value, (double)SMALLEST_SIZE, (double)upper );
    }
}

static wisp_status check_rest( checks* c, int64_t across, int64_t along, const void* points, const void* list,
                               const char* name )
{
    if ( c->status == WISP_OK && across * along > WISP_GENERATE_MAX_VERTICES )
    {
        c->status = wisp_fail( c->error, WISP_BAD_INPUT, "%s: got %lld times %lld vertices, expected at most %d",
                               c->what, (long long)across, (long long)along, WISP_GENERATE_MAX_VERTICES );
    }
    if ( c->status == WISP_OK && ( points == NULL || list == NULL ) )
    {
        c->status =
            wisp_fail( c->error, WISP_BAD_INPUT, "%s: %s: got null", c->what, points == NULL ? "points" : name );
    }
    return c->status;
}

static int32_t* put_triangle( int32_t* t, int32_t a, int32_t b, int32_t c )
{
    t[0] = a;
    t[1] = b;
    t[2] = c;
    return t + 3;
}

// ---- grids ----

wisp_status wisp_generate_grid( int columns, int rows, float dx, float dz, wisp_vec3* points, int32_t* triangles,
                                wisp_error* error )
{
    checks c = { .what = "grid", .error = error };
    check_count( &c, "columns", columns, 2 );
    check_count( &c, "rows", rows, 2 );
    check_size( &c, "dx", dx, LARGEST_SIZE );
    check_size( &c, "dz", dz, LARGEST_SIZE );
    WISP_TRY( check_rest( &c, columns, rows, points, triangles, "triangles" ) );
    for ( int j = 0; j < rows; ++j )
    {
        for ( int i = 0; i < columns; ++i )
        {
            points[j * columns + i] = ( wisp_vec3 ){
                .x = (float)( ( i - 0.5 * ( columns - 1 ) ) * (double)dx ),
                .z = (float)( ( j - 0.5 * ( rows - 1 ) ) * (double)dz ),
            };
        }
    }
    for ( int j = 0; j + 1 < rows; ++j )
    {
        for ( int i = 0; i + 1 < columns; ++i )
        {
            const int32_t a = j * columns + i, below = a + columns;
            triangles = put_triangle( triangles, a, below, below + 1 );
            triangles = put_triangle( triangles, a, below + 1, a + 1 );
        }
    }
    return WISP_OK;
}

// ---- around an axis ----

// Rings of vertices from above to below.
typedef struct profile
{
    int segments, ring_count;
    int rings, parts;                  // as the caller gave them
    float radius, length, tube_radius; // m
    bool has_poles;                    // a vertex above the first ring and one below the last
    bool is_cyclic;                    // the last ring is the neighbour of the first
} profile;

typedef struct profile_point
{
    double out, up; // m, from the axis and along it
} profile_point;

typedef profile_point ring_fn( const profile* p, int ring );

// Cosine and sine of part / whole of a turn, 0 <= part <= whole: exact at the quarters, equal where symmetry requires
// it, on the unit circle to double precision.
static void turn( int part, int whole, double* cosine, double* sine )
{
    // Down to an eighth of a turn in whole numbers, so that opposite and mirrored points are so exactly.
    int64_t quarters = 4 * (int64_t)part, quarter = quarters / whole, rest = quarters % whole;
    bool mirrored = 2 * rest > whole;
    int64_t small = mirrored ? whole - rest : rest;
    float s, c;
    trig_sincos( (float)( 1.5707963267948966 * (double)small / (double)whole ), &s, &c );
    // The engine's sine is exact to seven digits; the circle needs sixteen.
    double length = sqrt( (double)c * (double)c + (double)s * (double)s );
    double x = ( mirrored ? (double)s : (double)c ) / length, y = ( mirrored ? (double)c : (double)s ) / length;
    if ( 2 * small == whole )
    {
        x = y = sqrt( 0.5 );
    }
    switch ( quarter & 3 )
    {
        case 0:
            *cosine = x, *sine = y;
            break;
        case 1:
            *cosine = -y, *sine = x;
            break;
        case 2:
            *cosine = -x, *sine = -y;
            break;
        default:
            *cosine = y, *sine = -x;
            break;
    }
}

static profile_point sphere_ring( const profile* p, int k )
{
    double cosine, sine, radius = (double)p->radius;
    turn( k + 1, 2 * p->rings, &cosine, &sine );
    return ( profile_point ){ radius * sine, radius * cosine };
}

static profile_point cylinder_ring( const profile* p, int k )
{
    return ( profile_point ){ (double)p->radius, 0.5 * (double)p->length - (double)p->length * k / p->parts };
}

// Point k of the quarter of a circle that leads down from the pole, of `rings` parts.
static profile_point cap_point( const profile* p, int k )
{
    double cosine, sine;
    turn( k, 4 * p->rings, &cosine, &sine );
    return ( profile_point ){ (double)p->radius * sine, (double)p->radius * cosine };
}

static profile_point capsule_ring( const profile* p, int k )
{
    const double half = 0.5 * (double)p->length;
    const int below = k - ( p->rings - 1 + p->parts ); // from the lower end of the cylinder
    if ( k < p->rings )
    {
        const profile_point cap = cap_point( p, k + 1 );
        return ( profile_point ){ cap.out, half + cap.up };
    }
    if ( below >= 0 )
    {
        const profile_point cap = cap_point( p, p->rings - below );
        return ( profile_point ){ cap.out, -half - cap.up };
    }
    return ( profile_point ){ (double)p->radius, half - (double)p->length * ( k - p->rings + 1 ) / p->parts };
}

static profile_point torus_ring( const profile* p, int k )
{
    double cosine, sine;
    turn( k, p->rings, &cosine, &sine );
    return ( profile_point ){ (double)p->radius + (double)p->tube_radius * cosine, -(double)p->tube_radius * sine };
}

static void put_rings( const profile* p, ring_fn* ring_point, wisp_vec3* points )
{
    const double top = (double)p->radius + 0.5 * (double)p->length;
    wisp_vec3* ring = points + p->has_poles;
    for ( int k = 0; k < p->ring_count; ++k, ring += p->segments )
    {
        const profile_point at = ring_point( p, k );
        for ( int i = 0; i < p->segments; ++i )
        {
            double cosine, sine;
            turn( i, p->segments, &cosine, &sine );
            ring[i] = ( wisp_vec3 ){ (float)( at.out * cosine ), (float)at.up, (float)( -at.out * sine ) };
        }
    }
    if ( p->has_poles )
    {
        points[0] = ( wisp_vec3 ){ 0.0f, (float)top, 0.0f };
        *ring = ( wisp_vec3 ){ 0.0f, (float)-top, 0.0f };
    }
}

static void put_bands( const profile* p, int32_t* t )
{
    const int n = p->segments, base = p->has_poles;
    const int last = base + n * p->ring_count;
    for ( int i = 0; p->has_poles && i < n; ++i )
    {
        t = put_triangle( t, 0, base + i, base + ( i + 1 ) % n );
    }
    const int bands = p->is_cyclic ? p->ring_count : p->ring_count - 1;
    for ( int k = 0; k < bands; ++k )
    {
        const int above = base + k * n, below = base + ( k + 1 ) % p->ring_count * n;
        for ( int i = 0; i < n; ++i )
        {
            const int next = ( i + 1 ) % n;
            t = put_triangle( t, above + i, below + i, below + next );
            t = put_triangle( t, above + i, below + next, above + next );
        }
    }
    for ( int i = 0; p->has_poles && i < n; ++i )
    {
        t = put_triangle( t, last, last - n + ( i + 1 ) % n, last - n + i );
    }
}

static wisp_status put_turned( checks* c, const profile* p, ring_fn* ring_point, wisp_vec3* points,
                               int32_t* triangles )
{
    WISP_TRY( check_rest( c, p->segments, p->ring_count, points, triangles, "triangles" ) );
    put_rings( p, ring_point, points );
    put_bands( p, triangles );
    return WISP_OK;
}

wisp_status wisp_generate_sphere( int segments, int rings, float radius, wisp_vec3* points, int32_t* triangles,
                                  wisp_error* error )
{
    checks c = { .what = "sphere", .error = error };
    check_count( &c, "segments", segments, 3 );
    check_count( &c, "rings", rings, 2 );
    check_size( &c, "radius", radius, LARGEST_SIZE );
    const profile p = {
        .segments = segments, .rings = rings, .ring_count = rings - 1, .radius = radius, .has_poles = true
    };
    return put_turned( &c, &p, sphere_ring, points, triangles );
}

wisp_status wisp_generate_cylinder( int segments, int parts, float radius, float length, wisp_vec3* points,
                                    int32_t* triangles, wisp_error* error )
{
    checks c = { .what = "cylinder", .error = error };
    check_count( &c, "segments", segments, 3 );
    check_count( &c, "parts", parts, 1 );
    check_size( &c, "radius", radius, LARGEST_SIZE );
    check_size( &c, "length", length, LARGEST_SIZE );
    const profile p = {
        .segments = segments, .parts = parts, .ring_count = parts + 1, .radius = radius, .length = length
    };
    return put_turned( &c, &p, cylinder_ring, points, triangles );
}

wisp_status wisp_generate_capsule( int segments, int rings, int parts, float radius, float length, wisp_vec3* points,
                                   int32_t* triangles, wisp_error* error )
{
    checks c = { .what = "capsule", .error = error };
    check_count( &c, "segments", segments, 3 );
    check_count( &c, "rings", rings, 1 );
    check_count( &c, "parts", parts, 1 );
    check_size( &c, "radius", radius, LARGEST_SIZE );
    check_size( &c, "length", length, LARGEST_SIZE );
    WISP_TRY( c.status );
    const profile p = { .segments = segments,
                        .rings = rings,
                        .parts = parts,
                        .ring_count = 2 * rings + parts - 1,
                        .radius = radius,
                        .length = length,
                        .has_poles = true };
    return put_turned( &c, &p, capsule_ring, points, triangles );
}

wisp_status wisp_generate_torus( int segments, int rings, float radius, float tube_radius, wisp_vec3* points,
                                 int32_t* triangles, wisp_error* error )
{
    checks c = { .what = "torus", .error = error };
    check_count( &c, "segments", segments, 3 );
    check_count( &c, "rings", rings, 3 );
    check_size( &c, "radius", radius, LARGEST_SIZE );
    check_size( &c, "tube radius", tube_radius, 0.999f * radius );
    const profile p = { .segments = segments,
                        .rings = rings,
                        .ring_count = rings,
                        .radius = radius,
                        .tube_radius = tube_radius,
                        .is_cyclic = true };
    return put_turned( &c, &p, torus_ring, points, triangles );
}

// ---- strands ----

wisp_status wisp_generate_strand_rows( int columns, int rows, float spacing, int vertices, float length,
                                       wisp_vec3* points, int32_t* offsets, wisp_error* error )
{
    checks c = { .what = "strand rows", .error = error };
    check_count( &c, "columns", columns, 1 );
    check_count( &c, "rows", rows, 1 );
    check_size( &c, "spacing", spacing, LARGEST_SIZE );
    check_count( &c, "vertices", vertices, 2 );
    check_size( &c, "length", length, LARGEST_SIZE );
    WISP_TRY( c.status );
    WISP_TRY( check_rest( &c, (int64_t)columns * rows, vertices, points, offsets, "offsets" ) );
    const int strand_count = columns * rows;
    for ( int s = 0; s < strand_count; ++s )
    {
        offsets[s] = s * vertices;
        for ( int v = 0; v < vertices; ++v )
        {
            points[s * vertices + v] = ( wisp_vec3 ){
                .x = (float)( ( s % columns - 0.5 * ( columns - 1 ) ) * (double)spacing ),
                .y = (float)( -(double)length * v / ( vertices - 1 ) ),
                .z = (float)( ( s / columns - 0.5 * ( rows - 1 ) ) * (double)spacing ),
            };
        }
    }
    offsets[strand_count] = strand_count * vertices;
    return WISP_OK;
}
