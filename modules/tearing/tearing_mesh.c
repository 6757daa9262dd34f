// Fans of a mesh whose vertices split. The corners of a vertex are a range of one array; a split cuts the range in two.

#include "tearing_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t mesh_bytes( const wisp_fabric* f )
{
    const size_t slots = (size_t)f->slot_count, corners = 3 * (size_t)f->triangle_count;
    return ( 2 * corners + 3 * slots ) * sizeof( int32_t ) + slots;
}

static void list_corners( tearing_mesh* m )
{
    const wisp_fabric* f = m->fabric;
    const int32_t corners = 3 * f->triangle_count;
    memset( m->end, 0, (size_t)f->slot_count * sizeof( int32_t ) );
    for ( int32_t i = 0; i < corners; ++i )
    {
        m->end[m->triangles[i]] += 1;
    }
    int32_t at = 0;
    for ( int slot = 0; slot < f->slot_count; ++slot )
    {
        m->begin[slot] = at;
        at += m->end[slot];
        m->end[slot] = m->begin[slot];
    }
    for ( int32_t i = 0; i < corners; ++i )
    {
        m->corner[m->end[m->triangles[i]]++] = i;
    }
}

bool tearing_mesh_create( const wisp_fabric* f, const wisp_allocator* allocator, tearing_mesh* out )
{
    const size_t slots = (size_t)f->slot_count, corners = 3 * (size_t)f->triangle_count;
    *out = ( tearing_mesh ){ .fabric = f, .bytes = mesh_bytes( f ) };
    out->memory = allocator->allocate( allocator->user, out->bytes, 64 );
    if ( out->memory == NULL )
    {
        return false;
    }
    out->triangles = out->memory;
    out->corner = out->triangles + corners;
    out->parents = out->corner + corners;
    out->begin = out->parents + slots;
    out->end = out->begin + slots;
    out->touched = (uint8_t*)( out->end + slots );
    memcpy( out->triangles, f->triangles, corners * sizeof( int32_t ) );
    memset( out->touched, 0, slots );
    for ( int slot = 0; slot < f->slot_count; ++slot )
    {
        out->parents[slot] = slot;
    }
    list_corners( out );
    return true;
}

void tearing_mesh_release( tearing_mesh* mesh, const wisp_allocator* allocator )
{
    wisp_release( allocator, mesh->memory, mesh->bytes );
    *mesh = ( tearing_mesh ){ 0 };
}

// ---- fans ----

// Neighbour where the triangle of a corner begins (step 1) or ends (step 2), seen from the corner's vertex.
static int32_t other_end( const tearing_mesh* m, int32_t corner, int step )
{
    return m->triangles[corner - corner % 3 + ( corner + step ) % 3];
}

// Return the corner among [begin, end) whose triangle begins (step 1) or ends (step 2) at a neighbour, -1: none.
static int32_t find_corner( const tearing_mesh* m, int32_t begin, int32_t end, int step, int32_t neighbour )
{
    for ( int32_t i = begin; i < end; ++i )
    {
        if ( other_end( m, m->corner[i], step ) == neighbour )
        {
            return i;
        }
    }
    return -1;
}

static void swap( int32_t* a, int32_t* b )
{
    const int32_t kept = *a;
    *a = *b;
    *b = kept;
}

// A corner from which no other one leads to it, the one with the lowest triangle; -1: all fans are closed.
static int32_t find_open( const tearing_mesh* m, int32_t begin, int32_t end )
{
    int32_t first = -1;
    for ( int32_t i = begin; i < end; ++i )
    {
        const bool is_lower = first < 0 || m->corner[i] < m->corner[first];
        if ( is_lower && find_corner( m, begin, end, 2, other_end( m, m->corner[i], 1 ) ) < 0 )
        {
            first = i;
        }
    }
    return first;
}

static int32_t find_lowest( const tearing_mesh* m, int32_t begin, int32_t end )
{
    int32_t first = begin;
    for ( int32_t i = begin; i < end; ++i )
    {
        first = m->corner[i] < m->corner[first] ? i : first;
    }
    return first;
}

tearing_fan tearing_next_fan( const tearing_mesh* m, int32_t vertex, int32_t begin )
{
    const int32_t end = m->end[vertex], open = find_open( m, begin, end );
    int32_t at = begin, next = open >= 0 ? open : find_lowest( m, begin, end );
    while ( next >= 0 )
    {
        swap( m->corner + at, m->corner + next );
        at += 1;
        next = find_corner( m, at, end, 1, other_end( m, m->corner[at - 1], 2 ) );
    }
    return ( tearing_fan ){ begin, at, open < 0 };
}

int32_t tearing_spoke( const tearing_mesh* m, tearing_fan fan, int i )
{
    const int32_t count = fan.end - fan.begin;
    return i < count ? other_end( m, m->corner[fan.begin + i], 1 ) : other_end( m, m->corner[fan.end - 1], 2 );
}

int tearing_count_fans( const tearing_mesh* m, int32_t vertex )
{
    int count = 0;
    for ( int32_t at = m->begin[vertex]; at < m->end[vertex]; ++count )
    {
        at = tearing_next_fan( m, vertex, at ).end;
    }
    return count;
}

// ---- new vertices ----

static bool is_spare( const tearing_mesh* m, int user_vertex )
{
    const int32_t slot = m->fabric->vertex_slot[user_vertex];
    return m->begin[slot] == m->end[slot];
}

int tearing_count_spares( const tearing_mesh* m )
{
    int count = 0;
    for ( int v = m->spare_begin; v < m->fabric->vertex_count; ++v )
    {
        count += is_spare( m, v ) ? 1 : 0;
    }
    return count;
}

int32_t tearing_move_corners( tearing_mesh* m, int32_t vertex, int32_t begin, int32_t end )
{
    while ( is_spare( m, m->spare_begin ) == false )
    {
        m->spare_begin += 1;
    }
    const int32_t to = m->fabric->vertex_slot[m->spare_begin++];
    m->begin[to] = begin;
    m->end[to] = end;
    if ( begin == m->begin[vertex] )
    {
        m->begin[vertex] = end;
    }
    else
    {
        m->end[vertex] = begin;
    }
    m->parents[to] = m->parents[vertex];
    for ( int32_t i = begin; i < end; ++i )
    {
        m->triangles[m->corner[i]] = to;
    }
    return to;
}

// ---- links ----

// Links against their limits. In: multipliers of links. Out: how many are above, and which.

enum
{
    GRAIN = 4096, // slots of links per block
};

// ---- the pass ----

typedef struct block_result
{
    int32_t over_count;
    float max_load;
} block_result;

typedef struct measure_loop
{
    const float *lambda, *limit;
    float inverse_dt2;
    block_result* blocks;
} measure_loop;

// A link that pulls has a negative multiplier. NaN is above nothing.
static void measure_range( void* context, int begin, int end, int worker )
{
    (void)worker;
    const measure_loop* loop = context;
    block_result result = { 0 };
    for ( int slot = begin; slot < end; ++slot )
    {
        const float limit = loop->limit[slot], pull = -loop->lambda[slot] * loop->inverse_dt2;
        result.over_count += pull > limit ? 1 : 0;
        const float load = limit > 0.0f ? pull / limit : 0.0f;
        result.max_load = load > result.max_load ? load : result.max_load;
    }
    loop->blocks[begin / GRAIN] = result;
}

void tearing_measure( wisp_frame* frame, const wisp_span* span, void* user )
{
    const tearing_state* state = user;
    const wisp_fabric* f = wisp_frame_fabric( frame, span->entity );
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    tearing_result* result = wisp_frame_column( frame, span->entity, state->result, 0 );
    const int slots = f->link_order.slot_count, blocks = ( slots + GRAIN - 1 ) / GRAIN;
    *result = ( tearing_result ){ 0 };
    if ( wisp_frame_substeps( frame, span->entity ) == 0 )
    {
        return; // the multipliers are those of an earlier step, which were looked at
    }
    const float inverse_dt = 1.0f / wisp_frame_dt( frame, span->entity );
    measure_loop loop = {
        .lambda = wisp_frame_column( frame, span->entity, WISP_LINK_LAMBDA, 0 ),
        .limit = wisp_frame_column( frame, span->entity, state->limit, 0 ),
        .inverse_dt2 = inverse_dt * inverse_dt,
        .blocks = wisp_parallel_scratch( parallel, span->worker, ( (size_t)blocks + 1 ) * sizeof( block_result ) ),
    };
    if ( loop.blocks == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the tension of %d links", slots );
        return;
    }
    wisp_parallel_for( parallel, slots, GRAIN, measure_range, &loop );
    result->inverse_dt2 = loop.inverse_dt2;
    result->is_new = 1;
    for ( int b = 0; b < blocks; ++b )
    {
        result->over_count += loop.blocks[b].over_count;
        result->max_load = fmaxf( result->max_load, loop.blocks[b].max_load );
    }
}

// ---- limits ----

static double triangle_area( const wisp_fabric* f, int32_t a, int32_t b, int32_t c )
{
    const wisp_vec3 p = f->rest[a], q = f->rest[b], r = f->rest[c];
    const double ux = (double)q.x - (double)p.x, uy = (double)q.y - (double)p.y, uz = (double)q.z - (double)p.z;
    const double vx = (double)r.x - (double)p.x, vy = (double)r.y - (double)p.y, vz = (double)r.z - (double)p.z;
    const double x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    return 0.5 * sqrt( x * x + y * y + z * z );
}

// Areas by length: the width that an edge stands for. @param width [edge_count]
static void fill_widths( const wisp_fabric* f, float* width )
{
    memset( width, 0, (size_t)f->edge_count * sizeof( float ) );
    for ( int t = 0; t < f->triangle_count; ++t )
    {
        const int32_t* v = f->triangles + 3 * (size_t)t;
        const float area = (float)triangle_area( f, v[0], v[1], v[2] );
        for ( int k = 0; k < 3; ++k )
        {
            width[wisp_fabric_find_edge( f, v[k], v[( k + 1 ) % 3] )] += area;
        }
    }
    for ( int e = 0; e < f->edge_count; ++e )
    {
        const wisp_vec3 a = f->rest[f->edges[2 * (size_t)e]], b = f->rest[f->edges[2 * (size_t)e + 1]];
        const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z, length = sqrtf( x * x + y * y + z * z );
        width[e] = length > 0.0f ? width[e] / length : 0.0f;
    }
}

void tearing_fill_limits( wisp_world* world, const tearing_state* state, wisp_entity surface )
{
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    const float* strength = wisp_world_column( world, surface, state->strength, 0 );
    float* width = wisp_world_column( world, surface, state->strength, 1 );
    float* limit = wisp_world_column( world, surface, state->limit, 0 );
    fill_widths( f, width );
    for ( int slot = 0; slot < f->link_order.slot_count; ++slot )
    {
        const int edge = f->link_order.constraint[slot];
        const bool is_edge = edge >= 0 && edge < f->edge_count && width[edge] > 0.0f;
        limit[slot] = is_edge ? strength[edge] * width[edge] : INFINITY;
    }
}

// ---- edges above their strength ----

// A total order, so that the result is that of any sort.
static int compare_edges( const void* left, const void* right )
{
    const tearing_edge *a = left, *b = right;
    if ( a->load != b->load )
    {
        return a->load > b->load ? -1 : 1;
    }
    if ( a->vertices[0] != b->vertices[0] )
    {
        return a->vertices[0] < b->vertices[0] ? -1 : 1;
    }
    return a->vertices[1] < b->vertices[1] ? -1 : a->vertices[1] > b->vertices[1] ? 1 : 0;
}

int tearing_list_edges( wisp_world* world, const tearing_state* state, wisp_entity surface, tearing_edge* out )
{
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    const tearing_result* result = wisp_world_column( world, surface, state->result, 0 );
    const float* lambda = wisp_world_column( world, surface, WISP_LINK_LAMBDA, 0 );
    const float* limit = wisp_world_column( world, surface, state->limit, 0 );
    int count = 0;
    for ( int slot = 0; slot < f->link_order.slot_count && count < result->over_count; ++slot )
    {
        const float pull = -lambda[slot] * result->inverse_dt2;
        if ( pull > limit[slot] )
        {
            const int32_t a = f->link_a_x4[slot] / 4, b = f->link_b_x4[slot] / 4;
            const bool rises = f->slot_vertex[a] < f->slot_vertex[b];
            const int32_t first = rises ? a : b, second = rises ? b : a;
            out[count++] = ( tearing_edge ){ pull / limit[slot],
                                             { f->slot_vertex[first], f->slot_vertex[second] },
                                             { first, second } };
        }
    }
    qsort( out, (size_t)count, sizeof( *out ), compare_edges );
    return count;
}
