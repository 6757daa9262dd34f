// Fans of a mesh whose vertices split. The corners of a vertex are a range of one array; a split cuts the range in two.
#include "tearing_mesh.h"

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
