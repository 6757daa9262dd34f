// Points sampled on a triangle mesh: stages of an update, memory, and fallback normals where those of the vertices
// cancel.
#include "samples_parts.h"

#include "alloc.h"
#include "wisp/module/double3.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>
#include <string.h>

// ---- law ----

// Counts and fractions from lengths (boundary particle paper, sections 2 and 3), in double precision.

// Distance in spacings below which a point coincides with the second end of an edge.
static const double END = 1e-6;

// Minimum and maximum length for a count of n = 0.
static double first_length( const wisp_samples_args* args )
{
    return args->rounding == WISP_ROUND_DOWN ? 0.0 : ( args->rounding == WISP_ROUND_NEAREST ? -0.5 : -1.0 );
}

double samples_count_of( const wisp_samples_args* args, double length )
{
    switch ( args->rounding )
    {
        case WISP_ROUND_NEAREST:
            return floor( length + 0.5 );
        case WISP_ROUND_UP:
            return ceil( length );
        default:
            return floor( length );
    }
}

double samples_points_of( const wisp_samples_args* args, double n, double length )
{
    const double inside = args->policy == WISP_SPACING_EVEN ? n - 1.0 : ceil( length - END ) - 1.0;
    const double points = inside < n ? inside : n;
    return points > 0.0 ? points : 0.0;
}

double samples_fraction( const wisp_samples_args* args, double i, double n, double length )
{
    return args->policy == WISP_SPACING_EVEN ? i / n : i / length;
}

bool samples_may_stay( const wisp_samples_args* args, double n, double length )
{
    const double from = n + first_length( args ), h = (double)args->hysteresis;
    return length > from - h && length < from + 1.0 + h;
}

samples_bounds samples_bounds_of( const wisp_samples_args* args, double n, double points )
{
    // without hysteresis only the points matter, so n = 0 and n = 1 of the even policy are equal
    const double h = (double)args->hysteresis;
    samples_bounds b = { -1.0, DBL_MAX };
    if ( h > 0.0 )
    {
        const double from = n + first_length( args );
        b = ( samples_bounds ){ from - h, from + 1.0 + h };
    }
    else if ( args->policy == WISP_SPACING_EVEN )
    {
        const double from = points + 1.0 + first_length( args );
        b = ( samples_bounds ){ points > 0.0 ? from : -1.0, from + 1.0 };
    }
    if ( args->policy == WISP_SPACING_EXACT )
    {
        const double lower = points > 0.0 ? points + END : -1.0, upper = points + 1.0 + END;
        b.lower = lower > b.lower ? lower : b.lower;
        b.upper = points == n && h > 0.0 ? b.upper : ( upper < b.upper ? upper : b.upper );
    }
    return b;
}

// ---- extents ----

static double3 between( const float* a, const float* b )
{
    return double3_sub( double3_from( b ), double3_from( a ) );
}

static bool is_finite_number( const float* p )
{
    return fabsf( p[0] ) <= FLT_MAX && fabsf( p[1] ) <= FLT_MAX && fabsf( p[2] ) <= FLT_MAX;
}

bool samples_measure_edge( const wisp_samples_args* args, int edge, double* length )
{
    const float* a = args->position + (size_t)args->edges[2 * (size_t)edge] * 4;
    const float* b = args->position + (size_t)args->edges[2 * (size_t)edge + 1] * 4;
    const double d = (double)( args->edge_spacing != NULL ? args->edge_spacing[edge] : args->spacing );
    const double3 along = between( a, b );
    *length = double3_length( along ) / d;
    return is_finite_number( a ) && is_finite_number( b );
}

bool samples_measure_triangle( const wisp_samples_args* args, int triangle, samples_extent* out )
{
    const int32_t* slots = args->triangles + 3 * (size_t)triangle;
    const double d = (double)( args->triangle_spacing != NULL ? args->triangle_spacing[triangle] : args->spacing );
    const float* p[3];
    double3 side[3];
    bool finite = true;
    for ( int k = 0; k < 3; ++k )
    {
        p[k] = args->position + (size_t)slots[k] * 4;
        finite = finite && is_finite_number( p[k] );
    }
    double squared[3];
    int axis = 0;
    for ( int k = 0; k < 3; ++k )
    {
        side[k] = between( p[k], p[( k + 1 ) % 3] );
        squared[k] = double3_dot( side[k], side[k] );
        axis = squared[k] < squared[axis] ? k : axis;
    }
    *out = ( samples_extent ){ .axis = axis, .base = sqrt( squared[axis] ) };
    if ( out->base > 0.0 )
    {
        // u = (c - a) - ((c - a) . s) s; the side from c to a has the opposite direction, which does not change its
        // length
        const double3 s = side[axis], up = side[( axis + 2 ) % 3];
        const double along = double3_dot( up, s ) / squared[axis];
        const double3 u = double3_mul_add( up, -along, s );
        out->height = double3_length( u ) / d;
        out->base /= d;
    }
    return finite;
}

// ---- lines ----

samples_lines samples_lines_of( const wisp_samples_args* args, const samples_extent* made, const samples_extent* now )
{
    const double n = samples_count_of( args, made->height );
    return ( samples_lines ){
        .args = args,
        .made_base = made->base,
        .made_height = made->height,
        .base = now->base,
        .height = now->height,
        .n = n,
        .most = samples_points_of( args, n, now->height ),
    };
}

bool samples_next_line( samples_lines* lines )
{
    if ( lines->k >= lines->most )
    {
        return false;
    }
    const wisp_samples_args* args = lines->args;
    lines->k += 1.0;
    lines->fraction = samples_fraction( args, lines->k, lines->n, lines->height );
    lines->length = lines->base * ( 1.0 - lines->fraction );
    lines->m = samples_count_of(
        args, lines->made_base * ( 1.0 - samples_fraction( args, lines->k, lines->n, lines->made_height ) ) );
    lines->points = samples_points_of( args, lines->m, lines->length );
    return lines->points > 0.0;
}

// ---- samples ----

enum
{
    PLACE_GRAIN = 1024, // points per block, a multiple of 8
    WEIGH_GRAIN = 256,  // elements per block
    BUFFER_MEMORY = 0,
    BUFFER_POINTS = 1, // and the following index
};

size_t wisp_samples_bytes( const wisp_samples* samples )
{
    return wisp_buffer_bytes( samples->buffers, WISP_COUNT( samples->buffers ) );
}

void wisp_samples_release( wisp_samples* samples, const wisp_allocator* allocator )
{
    for ( int i = 0; i < WISP_COUNT( samples->buffers ); ++i )
    {
        wisp_buffer_release( samples->buffers + i, allocator );
    }
    *samples = ( wisp_samples ){ 0 };
}

// ---- memory ----

// Assigns arrays one after another, each aligned to a cache line. Without a base it only measures.
typedef struct layout
{
    char* base;
    size_t used;
} layout;

static void* take( layout* l, size_t count, size_t row )
{
    void* at = l->base != NULL ? l->base + l->used : NULL;
    l->used += ( count * row + BASE_BUFFER_ALIGNMENT - 1 ) / BASE_BUFFER_ALIGNMENT * BASE_BUFFER_ALIGNMENT;
    return at;
}

static void lay_group( samples_group* g, layout* l, int count, int first, int extents )
{
    const size_t padded = ( (size_t)count + 7 ) / 8 * 8;
    g->count = count;
    g->first = first;
    g->points = take( l, padded, sizeof( int32_t ) );
    g->extent = take( l, padded * (size_t)extents, sizeof( float ) );
    g->axis = take( l, padded, sizeof( int32_t ) );
    g->next_extent = take( l, padded * (size_t)extents, sizeof( float ) );
    g->next_axis = take( l, padded, sizeof( int32_t ) );
    g->lower = take( l, padded, sizeof( float ) );
    g->upper = take( l, padded, sizeof( float ) );
    g->low_height = take( l, padded, sizeof( float ) );
    g->high_height = take( l, padded, sizeof( float ) );
    g->held = take( l, padded / 8, 1 );
}

static int blocks_of( int count )
{
    return ( count + SAMPLES_BLOCK - 1 ) / SAMPLES_BLOCK;
}

static void lay_memory( layout* l, const wisp_samples_args* args, samples_memory* m )
{
    const size_t edges = (size_t)args->edge_count, triangles = (size_t)args->triangle_count;
    const size_t blocks = (size_t)( blocks_of( args->edge_count ) + blocks_of( args->triangle_count ) );
    take( l, 1, sizeof( samples_memory ) );
    lay_group( &m->edges, l, args->edge_count, 0, 1 );
    lay_group( &m->triangles, l, args->triangle_count, args->edge_count, 2 );
    m->begin = take( l, edges + triangles + 1, sizeof( int32_t ) );
    m->next = take( l, edges + triangles + 1, sizeof( int32_t ) );
    m->changed = take( l, edges + triangles, 1 );
    m->pair_x4 = take( l, ( edges + 7 ) / 8, sizeof( *m->pair_x4 ) );
    m->corner_x4 = take( l, ( triangles + 7 ) / 8, sizeof( *m->corner_x4 ) );
    m->counts = take( l, blocks, sizeof( samples_counts ) );
    m->block_begin = take( l, blocks, sizeof( int64_t ) );
    m->around_begin = take( l, edges + 1, sizeof( int32_t ) );
    m->around = take( l, 3 * triangles, sizeof( int32_t ) );
}

static int shorter_end( const wisp_samples_args* args, int e )
{
    const int32_t a = args->edges[2 * (size_t)e], b = args->edges[2 * (size_t)e + 1];
    return a < b ? a : b;
}

// ---- triangles at an edge ----

// Edges in linked lists by their lower slot, to find the edge of a triangle's side quickly.
typedef struct edge_chains
{
    const wisp_samples_args* args;
    int32_t *head, *next; // [slots], [edges]
} edge_chains;

static int find_edge( const edge_chains* c, int32_t a, int32_t b )
{
    const int32_t lower = a < b ? a : b, upper = a < b ? b : a;
    for ( int e = c->head[lower]; e >= 0; e = c->next[e] )
    {
        const int32_t p = c->args->edges[2 * (size_t)e], q = c->args->edges[2 * (size_t)e + 1];
        if ( ( p == lower && q == upper ) || ( p == upper && q == lower ) )
        {
            return e;
        }
    }
    return -1;
}

static int max_slots( const wisp_samples_args* args )
{
    int most = 0;
    for ( int64_t i = 0; i < 2 * (int64_t)args->edge_count; ++i )
    {
        most = args->edges[i] >= most ? args->edges[i] + 1 : most;
    }
    for ( int64_t i = 0; i < 3 * (int64_t)args->triangle_count; ++i )
    {
        most = args->triangles[i] >= most ? args->triangles[i] + 1 : most;
    }
    return most;
}

// Sorts sides by edge with a counting sort; triangles at an edge are in increasing order.
static void list_around( samples_memory* m, const edge_chains* c )
{
    const wisp_samples_args* args = c->args;
    for ( int pass = 0; pass < 2; ++pass )
    {
        for ( int64_t side = 0; side < 3 * (int64_t)args->triangle_count; ++side )
        {
            const int32_t* slots = args->triangles + side / 3 * 3;
            const int e = find_edge( c, slots[side % 3], slots[( side + 1 ) % 3] );
            if ( e >= 0 && pass == 0 )
            {
                m->around_begin[e] += 1;
            }
            else if ( e >= 0 )
            {
                m->around[m->around_begin[e]++] = (int32_t)( side / 3 );
            }
        }
        // the first pass turns counts into positions, the second resets positions that have advanced
        int32_t sum = 0;
        for ( int e = 0; e < args->edge_count && pass == 0; ++e )
        {
            const int32_t count = m->around_begin[e];
            m->around_begin[e] = sum;
            sum += count;
        }
        for ( int e = args->edge_count; e > 0 && pass == 1; --e )
        {
            m->around_begin[e] = m->around_begin[e - 1];
        }
    }
    m->around_begin[0] = 0;
}

static bool find_around( samples_memory* m, const wisp_samples_args* args, const wisp_allocator* allocator )
{
    const int slots = max_slots( args );
    const size_t bytes = ( (size_t)slots + (size_t)args->edge_count + 1 ) * sizeof( int32_t );
    int32_t* scratch = base_allocate( allocator, bytes, BASE_BUFFER_ALIGNMENT );
    if ( scratch == NULL )
    {
        return false;
    }
    memset( scratch, 0xff, bytes );
    edge_chains chains = { args, scratch, scratch + slots };
    for ( int e = args->edge_count - 1; e >= 0; --e )
    {
        chains.next[e] = chains.head[shorter_end( args, e )];
        chains.head[shorter_end( args, e )] = e;
    }
    list_around( m, &chains );
    base_release( allocator, scratch, bytes );
    return true;
}

// ---- a new layer ----

static void fill_pairs( samples_memory* m, const wisp_samples_args* args )
{
    for ( int e = 0; e < args->edge_count; ++e )
    {
        m->pair_x4[e / 8][0][e % 8] = 4 * args->edges[2 * (size_t)e];
        m->pair_x4[e / 8][1][e % 8] = 4 * args->edges[2 * (size_t)e + 1];
    }
    for ( int t = 0; t < args->triangle_count; ++t )
    {
        for ( int k = 0; k < 3; ++k )
        {
            m->corner_x4[t / 8][k][t % 8] = 4 * args->triangles[3 * (size_t)t + (size_t)k];
        }
    }
}

// Sets empty bounds, which contain no length.
static void open_bounds( samples_group* g )
{
    for ( int i = 0; i < g->count; ++i )
    {
        g->lower[i] = g->low_height[i] = 1.0f;
        g->upper[i] = g->high_height[i] = 0.0f;
    }
}

static samples_memory* memory_of( const wisp_samples* samples )
{
    return samples->buffers[BUFFER_MEMORY].data;
}

// Reserves memory for these elements, without points. Discards previous contents.
static bool make_memory( wisp_samples* samples, const wisp_samples_args* args, const wisp_allocator* allocator )
{
    samples_memory measured = { 0 };
    layout l = { 0 };
    lay_memory( &l, args, &measured );
    if ( wisp_buffer_reserve( samples->buffers + BUFFER_MEMORY, allocator, l.used ) == false )
    {
        return false;
    }
    memset( samples->buffers[BUFFER_MEMORY].data, 0, l.used );
    l = ( layout ){ .base = samples->buffers[BUFFER_MEMORY].data };
    samples_memory* m = memory_of( samples );
    lay_memory( &l, args, m );
    fill_pairs( m, args );
    open_bounds( &m->edges );
    open_bounds( &m->triangles );
    samples->count = samples->edge_count = 0;
    samples->begin = m->begin;
    m->needs_resampling = true;
    return true;
}

static bool fits( const samples_memory* m, const wisp_samples_args* args )
{
    return m != NULL && m->edges.count == args->edge_count && m->triangles.count == args->triangle_count;
}

static bool is_sampled_alike( const samples_memory* m, const wisp_samples_args* args )
{
    return m->policy == args->policy && m->rounding == args->rounding && m->hysteresis == args->hysteresis;
}

static bool prepare( wisp_samples* samples, const wisp_samples_args* args, const wisp_allocator* allocator )
{
    if ( fits( memory_of( samples ), args ) == false )
    {
        if ( make_memory( samples, args, allocator ) == false )
        {
            return false;
        }
        if ( find_around( memory_of( samples ), args, allocator ) == false )
        {
            memory_of( samples )->edges.count = -1; // incomplete, so that it matches no arguments
            return false;
        }
    }
    samples_memory* m = memory_of( samples );
    m->needs_resampling =
        m->needs_resampling || is_sampled_alike( m, args ) == false || ( args->normal != NULL ) != m->has_normals;
    m->has_normals = args->normal != NULL;
    m->policy = args->policy;
    m->rounding = args->rounding;
    m->hysteresis = args->hysteresis;
    return true;
}

// Returns the arrays of one of the two layers. They have 8 extra rows, since rows are written eight at a time.
static samples_points points_of( const wisp_samples* samples, int turn, bool normals )
{
    const samples_memory* m = memory_of( samples );
    const size_t rows = (size_t)m->capacity[turn] + 8, row = 4 * sizeof( float );
    layout l = { .base = samples->buffers[BUFFER_POINTS + turn].data };
    samples_points p = { 0 };
    p.xyzw = take( &l, rows, row );
    p.parents = take( &l, rows, row );
    p.weights = take( &l, rows, row );
    p.normals = normals ? take( &l, rows, row ) : NULL;
    return p;
}

static bool reserve_points( wisp_samples* samples, int turn, int count, bool normals,
                            const wisp_allocator* allocator )
{
    samples_memory* m = memory_of( samples );
    wisp_buffer* buffer = samples->buffers + BUFFER_POINTS + turn;
    const size_t row = ( 3 + ( normals ? 1u : 0u ) ) * 4 * sizeof( float );
    const size_t around = 5 * BASE_BUFFER_ALIGNMENT + 8 * row;
    if ( wisp_buffer_reserve( buffer, allocator, (size_t)count * row + around ) == false )
    {
        return false;
    }
    const size_t room = ( buffer->size - around ) / row;
    m->capacity[turn] = room < (size_t)INT32_MAX - 8 ? (int)room : INT32_MAX - 8;
    return true;
}

// ---- stages ----

typedef struct totals
{
    int64_t points, edge_points;
    double beyond;
    int changed, skipped;
} totals;

static totals count_all( samples_update* u, const wisp_parallel* parallel )
{
    const int blocks = u->edge_blocks + u->triangle_blocks;
    totals sum = { 0 };
    wisp_parallel_for( parallel, blocks, 1, samples_count_block, u );
    for ( int b = 0; b < blocks; ++b )
    {
        const samples_counts* t = u->memory->counts + b;
        sum.edge_points = b == u->edge_blocks ? sum.points : sum.edge_points;
        u->memory->block_begin[b] = sum.points;
        sum.points += t->points;
        sum.beyond += t->beyond;
        sum.changed += t->changed;
        sum.skipped += t->skipped;
    }
    sum.edge_points = u->triangle_blocks == 0 ? sum.points : sum.edge_points;
    return sum;
}

// Pads the last slice with copies of the last point.
static void pad_points( const samples_update* u )
{
    const size_t row = 4 * sizeof( float );
    for ( int p = u->count; u->count > 0 && p % 8 != 0; ++p )
    {
        memcpy( u->to.xyzw + 4 * (size_t)p, u->to.xyzw + 4 * (size_t)( p - 1 ), row );
        memcpy( u->to.parents + p, u->to.parents + p - 1, row );
        if ( u->to.normals != NULL )
        {
            memset( u->to.normals + 4 * (size_t)p, 0, row );
        }
    }
}

// Computes positions and normals. Padding has the weights of the last point, so its normal fails only if that
// point's fails.
static void pad_weights( const samples_update* u )
{
    for ( int p = u->count; u->count > 0 && p % 8 != 0; ++p )
    {
        memcpy( u->to.weights + p, u->to.weights + p - 1, 4 * sizeof( float ) );
    }
}

static void show_points( wisp_samples* samples, const samples_update* u )
{
    samples->count = u->count;
    samples->edge_count = u->edge_points;
    samples->begin = u->memory->begin;
    samples->xyzw = u->to.xyzw;
    samples->normals = u->to.normals;
    samples->parents = (const int32_t( * )[4])u->to.parents;
    samples->weights = (const float( * )[4])u->to.weights;
}

// Builds a new layer: all points move to the other layer. Once memory is reserved this cannot fail.
static bool fill_all( wisp_samples* samples, samples_update* u, const totals* sum, const wisp_parallel* parallel )
{
    samples_memory* m = u->memory;
    const int turn = 1 - m->turn, elements = m->edges.count + m->triangles.count;
    const bool normals = u->args->normal != NULL;
    if ( reserve_points( samples, turn, (int)sum->points, normals, wisp_parallel_allocator( parallel ) ) == false )
    {
        return false;
    }
    u->to = points_of( samples, turn, normals );
    u->count = (int)sum->points;
    u->edge_points = (int)sum->edge_points;
    wisp_parallel_for( parallel, u->edge_blocks + u->triangle_blocks, 1, samples_fill_block, u );
    m->next[elements] = u->count;
    int32_t* before = m->begin;
    m->begin = m->next;
    m->next = before;
    m->turn = turn;
    m->needs_resampling = false;
    m->shown = u->to;
    pad_points( u );
    pad_weights( u );
    show_points( samples, u );
    return true;
}

static void place_block( void* context, int begin, int end, int worker )
{
    (void)worker;
    samples_update* u = context;
    const wisp_blend_args args = {
        .position = u->args->position,
        .normal = u->to.normals != NULL ? u->args->normal : NULL,
        .parents = (const int32_t( * )[4])u->to.parents,
        .weights = (const float( * )[4])u->to.weights,
        .xyzw = u->to.xyzw,
        .normals = u->to.normals,
    };
    const int edges = u->edge_points / 8 * 8, first = begin * 8, last = end * 8;
    const int middle = edges < first ? first : ( edges > last ? last : edges );
    int unknown = u->kernels->blend_two( &args, first, middle );
    unknown += u->kernels->blend_three( &args, middle, last );
    if ( unknown > 0 )
    {
        // a sum of integers, so the order does not matter
        atomic_fetch_add_explicit( &u->unknown, unknown, memory_order_relaxed );
    }
}

// ---- fallback normals ----

typedef struct face_sum
{
    double x, y, z;
} face_sum;

static void add_face( face_sum* sum, const wisp_samples_args* args, int t )
{
    double e[2][3];
    const float* a = args->position + (size_t)args->triangles[3 * (size_t)t] * 4;
    for ( int k = 0; k < 2; ++k )
    {
        const float* b = args->position + (size_t)args->triangles[3 * (size_t)t + (size_t)k + 1] * 4;
        for ( int i = 0; i < 3; ++i )
        {
            e[k][i] = (double)b[i] - (double)a[i];
        }
    }
    const double x = e[0][1] * e[1][2] - e[0][2] * e[1][1], y = e[0][2] * e[1][0] - e[0][0] * e[1][2],
                 z = e[0][0] * e[1][1] - e[0][1] * e[1][0];
    const double length = sqrt( x * x + y * y + z * z );
    if ( length > 0.0 && length <= DBL_MAX )
    {
        *sum = ( face_sum ){ sum->x + x / length, sum->y + y / length, sum->z + z / length };
    }
}

// Computes the mean normal of the triangles at a point's element; otherwise its last normal, or 0.
static void replace_normal( const samples_update* u, int point )
{
    const samples_memory* m = u->memory;
    int32_t element;
    memcpy( &element, u->to.xyzw + 4 * (size_t)point + 3, sizeof( element ) );
    face_sum sum = { 0.0, 0.0, 0.0 };
    const bool edge = element < m->edges.count;
    for ( int i = edge ? m->around_begin[element] : 0; i < ( edge ? m->around_begin[element + 1] : 1 ); ++i )
    {
        add_face( &sum, u->args, edge ? m->around[i] : element - m->edges.count );
    }
    const double length = sqrt( sum.x * sum.x + sum.y * sum.y + sum.z * sum.z );
    float* n = u->to.normals + 4 * (size_t)point;
    if ( length >= (double)WISP_MIN_BLEND_LENGTH )
    {
        n[0] = (float)( sum.x / length );
        n[1] = (float)( sum.y / length );
        n[2] = (float)( sum.z / length );
    }
    n[3] = 0.0f;
}

static void place_all( samples_update* u, const wisp_parallel* parallel, bool weighs )
{
    const int elements = u->memory->edges.count + u->memory->triangles.count;
    if ( weighs && u->args->policy == WISP_SPACING_EXACT )
    {
        wisp_parallel_for( parallel, elements, WEIGH_GRAIN, samples_weigh_block, u );
        pad_weights( u );
    }
    wisp_parallel_for( parallel, ( u->count + 7 ) / 8, PLACE_GRAIN / 8, place_block, u );
    for ( int p = 0; p < u->count && u->unknown > 0; ++p )
    {
        if ( u->to.normals[4 * (size_t)p + 3] != 0.0f )
        {
            replace_normal( u, p );
        }
    }
}

// ---- public functions ----

wisp_status wisp_samples_update( wisp_samples* samples, const wisp_parallel* parallel, const wisp_kernels* kernels,
                                 const wisp_samples_args* args )
{
    if ( prepare( samples, args, wisp_parallel_allocator( parallel ) ) == false )
    {
        return WISP_NO_MEMORY;
    }
    samples_memory* m = memory_of( samples );
    samples_update u = {
        .args = args,
        .kernels = kernels,
        .memory = m,
        .from = m->shown,
        .to = m->shown,
        .edge_blocks = blocks_of( args->edge_count ),
        .triangle_blocks = blocks_of( args->triangle_count ),
        .most = 4.0 * (double)args->limit + 1000.0, // more than allowed, and quick to count
        .count = samples->count,
        .edge_points = samples->edge_count,
    };
    const totals sum = count_all( &u, parallel );
    const bool refused = sum.beyond > 0.0 || sum.points > (int64_t)args->limit;
    if ( refused == false && ( sum.changed > 0 || m->needs_resampling ) &&
         fill_all( samples, &u, &sum, parallel ) == false )
    {
        return WISP_NO_MEMORY;
    }
    samples->changed_elements = refused ? 0 : sum.changed;
    samples->skipped_elements = sum.skipped;
    samples->refused = refused;
    samples->requested = (double)sum.points + sum.beyond;
    place_all( &u, parallel, refused == false );
    return WISP_OK;
}
