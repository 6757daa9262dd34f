// Which vertices are linked, how long, how strongly: from the mesh or from pairs given by hand (Noh and Jung, section 3).
#include "implicit_pairs.h"

#include <stdlib.h>
#include <string.h>

// ---- memory of the cooking ----

void* implicit_cook_push( implicit_cook* cook, size_t count, size_t size )
{
    WISP_ASSERT( cook->block_count < WISP_COUNT( cook->blocks ) );
    const wisp_allocator* a = cook->allocator;
    const size_t bytes = ( count > 0 ? count : 1 ) * size;
    void* block = a->allocate( a->user, bytes, 64 );
    if ( block != NULL )
    {
        memset( block, 0, bytes );
        cook->bytes[cook->block_count] = bytes;
        cook->blocks[cook->block_count++] = block;
    }
    return block;
}

void implicit_cook_release( implicit_cook* cook )
{
    for ( int i = 0; i < cook->block_count; ++i )
    {
        cook->allocator->release( cook->allocator->user, cook->blocks[i], cook->bytes[i] );
    }
    cook->block_count = 0;
}

// ---- pairs of the mesh ----

// A triangle seen from one of its edges.
typedef struct edge_side
{
    int32_t a, b; // slots, a < b
    int32_t opposite;
    float area; // m^2
} edge_side;

static int compare_sides( const void* first, const void* second )
{
    const edge_side *p = first, *q = second;
    const int32_t by[3] = { p->a - q->a, p->b - q->b, p->opposite - q->opposite };
    return by[0] != 0 ? by[0] : ( by[1] != 0 ? by[1] : by[2] );
}

static int compare_pairs( const void* first, const void* second )
{
    const implicit_pair *p = first, *q = second;
    return p->a != q->a ? p->a - q->a : p->b - q->b;
}

static float triangle_area( const wisp_fabric* f, const int32_t* t )
{
    const wisp_vec3 p = f->rest[t[0]], q = f->rest[t[1]], r = f->rest[t[2]];
    const double e[3] = { (double)q.x - (double)p.x, (double)q.y - (double)p.y, (double)q.z - (double)p.z };
    const double g[3] = { (double)r.x - (double)p.x, (double)r.y - (double)p.y, (double)r.z - (double)p.z };
    const double n[3] = { e[1] * g[2] - e[2] * g[1], e[2] * g[0] - e[0] * g[2], e[0] * g[1] - e[1] * g[0] };
    return (float)( 0.5 * sqrt( n[0] * n[0] + n[1] * n[1] + n[2] * n[2] ) );
}

static implicit_pair make_pair( int32_t a, int32_t b, float area )
{
    return a < b ? ( implicit_pair ){ .a = a, .b = b, .area = area }
                 : ( implicit_pair ){ .a = b, .b = a, .area = area };
}

// Merge equal pairs and sum their areas.
static int merge_pairs( implicit_pair* pairs, int count )
{
    qsort( pairs, (size_t)count, sizeof( *pairs ), compare_pairs );
    int kept = 0;
    for ( int i = 0; i < count; ++i )
    {
        if ( kept > 0 && compare_pairs( pairs + kept - 1, pairs + i ) == 0 )
        {
            pairs[kept - 1].area += pairs[i].area;
        }
        else
        {
            pairs[kept++] = pairs[i];
        }
    }
    return kept;
}

static void list_sides( const wisp_fabric* f, edge_side* sides )
{
    for ( int t = 0; t < f->triangle_count; ++t )
    {
        const int32_t* corner = f->triangles + 3 * (size_t)t;
        const float area = triangle_area( f, corner );
        for ( int k = 0; k < 3; ++k )
        {
            const int32_t a = corner[k], b = corner[( k + 1 ) % 3];
            sides[3 * (size_t)t + (size_t)k] =
                ( edge_side ){ a < b ? a : b, a < b ? b : a, corner[( k + 2 ) % 3], area };
        }
    }
}

// Upper bound of the diagonals at an edge of `count` sides.
static size_t diagonals_of( size_t count )
{
    return count * ( count - 1 ) / 2;
}

static size_t run_length( const edge_side* sides, size_t at, size_t end )
{
    size_t n = 1;
    while ( at + n < end && sides[at + n].a == sides[at].a && sides[at + n].b == sides[at].b )
    {
        ++n;
    }
    return n;
}

// Edges, and the opposite vertices of every two triangles of an edge, in sorted order.
static bool pairs_of_mesh( implicit_cook* cook )
{
    const wisp_fabric* f = cook->fabric;
    const size_t side_count = 3 * (size_t)f->triangle_count;
    edge_side* sides = implicit_cook_push( cook, side_count, sizeof( edge_side ) );
    if ( sides == NULL )
    {
        return false;
    }
    list_sides( f, sides );
    qsort( sides, side_count, sizeof( *sides ), compare_sides );
    size_t edges = 0, diagonals = 0;
    for ( size_t at = 0, n; at < side_count; at += n )
    {
        n = run_length( sides, at, side_count );
        edges += 1;
        diagonals += diagonals_of( n );
    }
    if ( diagonals > INT32_MAX / 2 )
    {
        return false; // an edge of tens of thousands of triangles
    }
    cook->stretch = implicit_cook_push( cook, edges, sizeof( implicit_pair ) );
    cook->bend = implicit_cook_push( cook, diagonals, sizeof( implicit_pair ) );
    if ( cook->stretch == NULL || cook->bend == NULL )
    {
        return false;
    }
    for ( size_t at = 0, n; at < side_count; at += n )
    {
        n = run_length( sides, at, side_count );
        implicit_pair* edge = cook->stretch + cook->stretch_count++;
        *edge = make_pair( sides[at].a, sides[at].b, 0.0f );
        for ( size_t i = at; i < at + n; ++i )
        {
            edge->area += sides[i].area;
            for ( size_t k = i + 1; k < at + n; ++k )
            {
                if ( sides[i].opposite != sides[k].opposite )
                {
                    cook->bend[cook->bend_count++] =
                        make_pair( sides[i].opposite, sides[k].opposite, sides[i].area + sides[k].area );
                }
            }
        }
    }
    cook->bend_count = merge_pairs( cook->bend, cook->bend_count );
    return true;
}

// ---- pairs given by hand ----

static wisp_status check_given( const implicit_cook* cook, const char* what, const int32_t* pairs, int count )
{
    const int vertices = cook->fabric->vertex_count;
    if ( count < 0 || count > INT32_MAX / 4 || ( count > 0 && pairs == NULL ) )
    {
        return wisp_world_fail( cook->world, WISP_BAD_INPUT, "implicit cloth: got %d %s pairs, but the list is null",
                                count, what );
    }
    for ( int i = 0; i < count; ++i )
    {
        const int32_t a = pairs[2 * (size_t)i], b = pairs[2 * (size_t)i + 1];
        if ( a < 0 || b < 0 || a >= vertices || b >= vertices || a == b )
        {
            return wisp_world_fail( cook->world, WISP_BAD_INPUT,
                                    "implicit cloth: %s pair %d: got (%d, %d), expected two of %d vertices", what, i,
                                    a, b, vertices );
        }
    }
    return WISP_OK;
}

static bool copy_given( implicit_cook* cook, const int32_t* pairs, int count, implicit_pair** out, int* out_count )
{
    *out = implicit_cook_push( cook, (size_t)count, sizeof( implicit_pair ) );
    for ( int i = 0; i < count && *out != NULL; ++i )
    {
        const int32_t* slot = cook->fabric->vertex_slot;
        ( *out )[i] = make_pair( slot[pairs[2 * (size_t)i]], slot[pairs[2 * (size_t)i + 1]], 0.0f );
    }
    *out_count = *out != NULL ? merge_pairs( *out, count ) : 0;
    return *out != NULL;
}

// ---- lengths, neighbours, coefficients ----

static wisp_status measure( const implicit_cook* cook, implicit_pair* pairs, int count )
{
    const wisp_fabric* f = cook->fabric;
    for ( int i = 0; i < count; ++i )
    {
        const wisp_vec3 p = f->rest[pairs[i].a], q = f->rest[pairs[i].b];
        const double d[3] = { (double)q.x - (double)p.x, (double)q.y - (double)p.y, (double)q.z - (double)p.z };
        pairs[i].rest = (float)sqrt( d[0] * d[0] + d[1] * d[1] + d[2] * d[2] );
        if ( !( pairs[i].rest >= 1e-9f ) )
        {
            return wisp_world_fail(
                cook->world, WISP_BAD_INPUT,
                "implicit cloth: link of vertices %d and %d: got a rest length of %g m, expected more",
                f->slot_vertex[pairs[i].a], f->slot_vertex[pairs[i].b], (double)pairs[i].rest );
        }
    }
    return WISP_OK;
}

// Count |N_i|: a vertex linked in both ways counts once. Both lists are sorted, so they are merged.
static void count_neighbours( implicit_cook* cook )
{
    int i = 0, k = 0;
    while ( i < cook->stretch_count || k < cook->bend_count )
    {
        const implicit_pair* s = i < cook->stretch_count ? cook->stretch + i : NULL;
        const implicit_pair* b = k < cook->bend_count ? cook->bend + k : NULL;
        const int order = s == NULL ? 1 : ( b == NULL ? -1 : compare_pairs( s, b ) );
        const implicit_pair* pair = order <= 0 ? s : b;
        cook->neighbours[pair->a] += 1;
        cook->neighbours[pair->b] += 1;
        i += order <= 0 ? 1 : 0;
        k += order >= 0 ? 1 : 0;
    }
    for ( int slot = 0; slot < cook->fabric->vertex_count; ++slot )
    {
        cook->max_neighbours =
            cook->neighbours[slot] > cook->max_neighbours ? cook->neighbours[slot] : cook->max_neighbours;
    }
}

static float weight_of( const implicit_cook* cook, int32_t slot )
{
    const int32_t n = cook->neighbours[slot];
    return n > 0 ? (float)cook->max_neighbours / (float)n : 1.0f;
}

// A material bends as a plate. Its edges, not the diagonals, take pressure, up to that under which the strip around an edge buckles:
// a plate that bends keeps the lengths of edges, while diagonals shorten. Neighbours have been counted with diagonals.
static bool press_edges( implicit_cook* cook )
{
    cook->bend = implicit_cook_push( cook, (size_t)cook->stretch_count, sizeof( implicit_pair ) );
    if ( cook->bend == NULL )
    {
        return false;
    }
    memcpy( cook->bend, cook->stretch, (size_t)cook->stretch_count * sizeof( implicit_pair ) );
    cook->bend_count = cook->stretch_count;
    return true;
}

static void set_coefficients( const implicit_cook* cook, const wisp_implicit_cloth_def* d )
{
    const bool sheet = d->stiffness_model == WISP_IMPLICIT_STIFFNESS_MATERIAL;
    const float compression = d->compression_stiffness > 0.0f ? d->compression_stiffness : d->stretch_stiffness;
    for ( int list = 0; list < 2; ++list )
    {
        const bool bends = list == 1;
        implicit_pair* pairs = bends ? cook->bend : cook->stretch;
        for ( int i = 0; i < ( bends ? cook->bend_count : cook->stretch_count ); ++i )
        {
            implicit_pair* p = pairs + i;
            const float inverse = 1.0f / p->rest;
            const float fraction = sheet ? p->area * inverse * inverse : 1.0f;
            const float arc = sheet ? d->bend_rigidity * p->area * inverse : d->bend_stiffness;
            p->load = bends ? arc * inverse * inverse : fraction * d->stretch_stiffness;
            p->ramp = bends ? fraction * compression : 0.0f;
            p->ramp_end =
                bends ? (float)implicit_ramp_end( (double)p->load, (double)p->ramp, (double)p->rest ) : 0.0f;
            p->damping = fraction * d->link_damping;
        }
    }
}

wisp_status implicit_list_pairs( implicit_cook* cook, const wisp_implicit_cloth_def* d )
{
    WISP_TRY( check_given( cook, "stretch", d->stretch_pairs, d->stretch_pair_count ) );
    WISP_TRY( check_given( cook, "bend", d->bend_pairs, d->bend_pair_count ) );
    const bool stretch_given = d->stretch_pair_count > 0, bend_given = d->bend_pair_count > 0;
    cook->neighbours = implicit_cook_push( cook, (size_t)cook->fabric->vertex_count, sizeof( int32_t ) );
    bool made = cook->neighbours != NULL && ( stretch_given || pairs_of_mesh( cook ) );
    if ( stretch_given )
    {
        made =
            made && copy_given( cook, d->stretch_pairs, d->stretch_pair_count, &cook->stretch, &cook->stretch_count );
    }
    if ( bend_given )
    {
        made = made && copy_given( cook, d->bend_pairs, d->bend_pair_count, &cook->bend, &cook->bend_count );
    }
    if ( made == false )
    {
        return wisp_world_fail( cook->world, WISP_NO_MEMORY,
                                "implicit cloth: out of memory for the links of %d vertices",
                                cook->fabric->vertex_count );
    }
    WISP_TRY( measure( cook, cook->stretch, cook->stretch_count ) );
    WISP_TRY( measure( cook, cook->bend, cook->bend_count ) );
    count_neighbours( cook );
    if ( d->stiffness_model == WISP_IMPLICIT_STIFFNESS_MATERIAL && press_edges( cook ) == false )
    {
        return wisp_world_fail( cook->world, WISP_NO_MEMORY, "implicit cloth: out of memory for %d edges",
                                cook->stretch_count );
    }
    set_coefficients( cook, d );
    return WISP_OK;
}

float implicit_mass_fraction( const implicit_cook* cook, const wisp_implicit_cloth_def* d, int32_t slot )
{
    return d->weights == WISP_IMPLICIT_WEIGHTS_EFFECTIVE ? 1.0f / weight_of( cook, slot ) : 1.0f;
}
