// Rows of links: the vertex of each row, and the entries of each slice of eight.
#include "implicit_internal.h"

#include <stdlib.h>
#include <string.h>

// ---- pairs ----

// Which vertices are linked, how long, how strongly: from the mesh or from pairs given by hand (Noh and Jung, section 3).

// ---- memory of the cooking ----

// Zeroed memory until implicit_cook_release(). @return null without memory
static void* implicit_cook_push( implicit_cook* cook, size_t count, size_t size )
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

// Fill in pairs, neighbours and coefficients, or refuse with a message.
static wisp_status implicit_list_pairs( implicit_cook* cook, const wisp_implicit_cloth_def* d )
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

// Fraction of a vertex's mass in its row: 1 over the weight of its forces, or 1.
static float implicit_mass_fraction( const implicit_cook* cook, const wisp_implicit_cloth_def* d, int32_t slot )
{
    return d->weights == WISP_IMPLICIT_WEIGHTS_EFFECTIVE ? 1.0f / weight_of( cook, slot ) : 1.0f;
}

// ---- rows ----

enum
{
    WINDOW = 256, // slots that may be reordered for less padding; close enough to stay in the near caches
};

typedef struct row_cook
{
    implicit_cook* cook;
    int32_t* degree;   // [vertex_count][2] links that stretch, that bend, by slot
    int32_t* slot_row; // [vertex_count]
    int32_t* filled;   // [row_count][2] entries written
} row_cook;

static void count_degrees( row_cook* r )
{
    for ( int list = 0; list < 2; ++list )
    {
        const implicit_pair* pairs = list == 1 ? r->cook->bend : r->cook->stretch;
        for ( int i = 0; i < ( list == 1 ? r->cook->bend_count : r->cook->stretch_count ); ++i )
        {
            r->degree[2 * (size_t)pairs[i].a + (size_t)list] += 1;
            r->degree[2 * (size_t)pairs[i].b + (size_t)list] += 1;
        }
    }
}

// Within a window by falling number of links, equals in the fabric's order: an insertion sort, so it is stable.
static void order_window( const row_cook* r, int32_t* slots, int count )
{
    for ( int i = 1; i < count; ++i )
    {
        const int32_t slot = slots[i], *d = r->degree + 2 * (size_t)slot;
        int k = i;
        for ( ; k > 0; --k )
        {
            const int32_t* before = r->degree + 2 * (size_t)slots[k - 1];
            if ( before[0] > d[0] || ( before[0] == d[0] && before[1] >= d[1] ) )
            {
                break;
            }
            slots[k] = slots[k - 1];
        }
        slots[k] = slot;
    }
}

static void order_rows( row_cook* r, int32_t* row_slot, int row_count )
{
    const int count = r->cook->fabric->vertex_count;
    for ( int row = 0; row < row_count; ++row )
    {
        row_slot[row] = row < count ? row : -1;
    }
    for ( int first = 0; first < count; first += WINDOW )
    {
        order_window( r, row_slot + first, count - first < WINDOW ? count - first : WINDOW );
    }
    for ( int row = 0; row < count; ++row )
    {
        r->slot_row[row_slot[row]] = row;
    }
}

// A slice has as many entries as its longest row.
static size_t place_entries( const row_cook* r, const int32_t* row_slot, int slice_count, int32_t* begin )
{
    size_t entry = 0;
    for ( int slice = 0; slice < slice_count; ++slice )
    {
        for ( size_t list = 0; list < 2; ++list )
        {
            int32_t most = 0;
            for ( int lane = 0; lane < WISP_SLICE; ++lane )
            {
                const int32_t slot = row_slot[slice * WISP_SLICE + lane];
                const int32_t degree = slot >= 0 ? r->degree[2 * (size_t)slot + list] : 0;
                most = degree > most ? degree : most;
            }
            begin[2 * (size_t)slice + list] = (int32_t)entry;
            entry += (size_t)most;
        }
    }
    begin[2 * (size_t)slice_count] = (int32_t)entry;
    return entry;
}

// The arrays behind wisp_spring_links, to be written.
typedef struct entry_arrays
{
    int32_t ( *other_x4 )[WISP_SLICE];
    float ( *rest )[WISP_SLICE], ( *load )[WISP_SLICE], ( *ramp )[WISP_SLICE], ( *ramp_end )[WISP_SLICE],
        ( *damping )[WISP_SLICE];
} entry_arrays;

static void write_end( row_cook* r, const int32_t* begin, const entry_arrays* out, const implicit_pair* pair,
                       int list, int32_t own, int32_t other )
{
    const int32_t row = r->slot_row[own];
    const int32_t entry = begin[2 * ( row / WISP_SLICE ) + list] + r->filled[2 * (size_t)row + (size_t)list]++;
    const int lane = row % WISP_SLICE;
    out->other_x4[entry][lane] = 4 * r->slot_row[other];
    out->rest[entry][lane] = pair->rest;
    out->load[entry][lane] = pair->load;
    out->ramp[entry][lane] = pair->ramp;
    out->ramp_end[entry][lane] = pair->ramp_end;
    out->damping[entry][lane] = pair->damping;
}

static void write_entries( row_cook* r, const int32_t* begin, int slice_count, const entry_arrays* out )
{
    for ( int slice = 0; slice < slice_count; ++slice )
    {
        for ( int entry = begin[2 * slice]; entry < begin[2 * slice + 2]; ++entry )
        {
            for ( int lane = 0; lane < WISP_SLICE; ++lane )
            {
                out->other_x4[entry][lane] = 4 * ( slice * WISP_SLICE + lane );
            }
        }
    }
    for ( int list = 0; list < 2; ++list )
    {
        const implicit_pair* pairs = list == 1 ? r->cook->bend : r->cook->stretch;
        for ( int i = 0; i < ( list == 1 ? r->cook->bend_count : r->cook->stretch_count ); ++i )
        {
            write_end( r, begin, out, pairs + i, list, pairs[i].a, pairs[i].b );
            write_end( r, begin, out, pairs + i, list, pairs[i].b, pairs[i].a );
        }
    }
}

static float stiffest_of( const implicit_cook* cook )
{
    float most = 0.0f;
    for ( int i = 0; i < cook->stretch_count; ++i )
    {
        most = fmaxf( most, cook->stretch[i].load );
    }
    for ( int i = 0; i < cook->bend_count; ++i )
    {
        most = fmaxf( most, cook->bend[i].ramp );
    }
    return most;
}

// One block of memory: a header, then arrays on lines of their own.
static size_t reserve( size_t* at, size_t count, size_t size )
{
    const size_t offset = *at;
    *at += ( count * size + 63 ) & ~(size_t)63;
    return offset;
}

static implicit_links* assemble( row_cook* r, const wisp_implicit_cloth_def* def, const int32_t* row_slot,
                                 int row_count, const int32_t* begin, size_t entry_count )
{
    const implicit_cook* cook = r->cook;
    const size_t lanes = WISP_SLICE * sizeof( float ), slices = (size_t)row_count / WISP_SLICE;
    size_t bytes = 0;
    reserve( &bytes, 1, sizeof( implicit_links ) );
    const size_t slot_at = reserve( &bytes, (size_t)row_count, sizeof( int32_t ) );
    const size_t share_at = reserve( &bytes, (size_t)row_count, sizeof( float ) );
    const size_t begin_at = reserve( &bytes, 2 * slices + 1, sizeof( int32_t ) );
    size_t at[6];
    for ( int i = 0; i < 6; ++i )
    {
        at[i] = reserve( &bytes, entry_count, lanes );
    }
    char* memory = cook->allocator->allocate( cook->allocator->user, bytes, 64 );
    if ( memory == NULL )
    {
        return NULL;
    }
    memset( memory, 0, bytes );
    const entry_arrays out = {
        .other_x4 = ( int32_t( * )[WISP_SLICE] )(void*)( memory + at[0] ),
        .rest = ( float( * )[WISP_SLICE] )(void*)( memory + at[1] ),
        .load = ( float( * )[WISP_SLICE] )(void*)( memory + at[2] ),
        .ramp = ( float( * )[WISP_SLICE] )(void*)( memory + at[3] ),
        .ramp_end = ( float( * )[WISP_SLICE] )(void*)( memory + at[4] ),
        .damping = ( float( * )[WISP_SLICE] )(void*)( memory + at[5] ),
    };
    implicit_links* links = (implicit_links*)(void*)memory;
    *links = ( implicit_links ){
        .row_count = row_count,
        .slice_count = row_count / WISP_SLICE,
        .stretch_count = cook->stretch_count,
        .bend_count = cook->bend_count,
        .max_neighbours = cook->max_neighbours,
        .stiffest = stiffest_of( cook ),
        .row_slot = (int32_t*)(void*)( memory + slot_at ),
        .fraction = (float*)(void*)( memory + share_at ),
        .bytes = bytes,
    };
    memcpy( memory + slot_at, row_slot, (size_t)row_count * sizeof( int32_t ) );
    memcpy( memory + begin_at, begin, ( 2 * slices + 1 ) * sizeof( int32_t ) );
    for ( int row = 0; row < row_count; ++row )
    {
        links->fraction[row] = row_slot[row] >= 0 ? implicit_mass_fraction( cook, def, row_slot[row] ) : 1.0f;
    }
    write_entries( r, begin, links->slice_count, &out );
    links->springs = ( wisp_spring_links ){
        .begin = (const int32_t*)(void*)( memory + begin_at ),
        .other_x4 = (const int32_t( * )[WISP_SLICE])out.other_x4,
        .rest = (const float( * )[WISP_SLICE])out.rest,
        .stiffness = (const float( * )[WISP_SLICE])out.load,
        .ramp_stiffness = (const float( * )[WISP_SLICE])out.ramp,
        .damping = (const float( * )[WISP_SLICE])out.damping,
        .ramp_end = (const float( * )[WISP_SLICE])out.ramp_end,
    };
    return links;
}

// Bending of a material, in the rows of the links.
static bool add_plate( row_cook* r, const wisp_implicit_cloth_def* def, implicit_links* links )
{
    const implicit_cook* cook = r->cook;
    if ( def->stiffness_model != WISP_IMPLICIT_STIFFNESS_MATERIAL || !( def->bend_rigidity > 0.0f ) )
    {
        return true;
    }
    links->rigidity = def->bend_rigidity;
    return wisp_plate_create( cook->fabric, r->slot_row, links->row_count, false, cook->allocator, &links->plate ) ==
           WISP_OK;
}

static implicit_links* cook_rows( implicit_cook* cook, const wisp_implicit_cloth_def* def )
{
    const size_t vertices = (size_t)cook->fabric->vertex_count,
                 rows = ( vertices + WISP_SLICE - 1 ) / WISP_SLICE * WISP_SLICE;
    row_cook r = {
        .cook = cook,
        .degree = implicit_cook_push( cook, 2 * vertices, sizeof( int32_t ) ),
        .slot_row = implicit_cook_push( cook, vertices, sizeof( int32_t ) ),
        .filled = implicit_cook_push( cook, 2 * rows, sizeof( int32_t ) ),
    };
    int32_t* row_slot = implicit_cook_push( cook, rows, sizeof( int32_t ) );
    int32_t* begin = implicit_cook_push( cook, 2 * rows / WISP_SLICE + 1, sizeof( int32_t ) );
    if ( r.degree == NULL || r.slot_row == NULL || r.filled == NULL || row_slot == NULL || begin == NULL )
    {
        return NULL;
    }
    count_degrees( &r );
    order_rows( &r, row_slot, (int)rows );
    const size_t entries = place_entries( &r, row_slot, (int)( rows / WISP_SLICE ), begin );
    implicit_links* links = assemble( &r, def, row_slot, (int)rows, begin, entries );
    if ( links != NULL && add_plate( &r, def, links ) == false )
    {
        implicit_links_release( links, cook->allocator );
        return NULL;
    }
    return links;
}

wisp_status implicit_links_create( wisp_world* world, wisp_entity surface, const wisp_implicit_cloth_def* def,
                                   implicit_links** out )
{
    *out = NULL;
    implicit_cook cook = {
        .world = world,
        .allocator = wisp_world_allocator( world ),
        .fabric = wisp_world_fabric( world, surface ),
    };
    wisp_status status = implicit_list_pairs( &cook, def );
    if ( status == WISP_OK )
    {
        *out = cook_rows( &cook, def );
        status = *out != NULL ? WISP_OK
                              : wisp_world_fail( world, WISP_NO_MEMORY,
                                                 "implicit cloth: out of memory for the rows of %d vertices",
                                                 cook.fabric->vertex_count );
    }
    implicit_cook_release( &cook );
    return status;
}

void implicit_links_release( void* memory, const wisp_allocator* allocator )
{
    implicit_links* links = memory;
    if ( links != NULL )
    {
        wisp_plate_release( links->plate, allocator );
        allocator->release( allocator->user, links, links->bytes );
    }
}
