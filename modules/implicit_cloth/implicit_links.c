// Rows of links: the vertex of each row, and the entries of each slice of eight.
#include "implicit_pairs.h"

#include <string.h>

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
    if ( *out != NULL )
    {
        ( *out )->entity = surface;
    }
    return status;
}

void implicit_links_release( implicit_links* links, const wisp_allocator* allocator )
{
    if ( links != NULL )
    {
        wisp_plate_release( links->plate, allocator );
        allocator->release( allocator->user, links, links->bytes );
    }
}

// ---- the links of the world ----

int implicit_find_index( const implicit_state* state, wisp_entity entity )
{
    for ( int i = 0; i < state->link_count; ++i )
    {
        if ( wisp_entity_equal( state->links[i]->entity, entity ) )
        {
            return i;
        }
    }
    return -1;
}

implicit_links* implicit_find_links( const implicit_state* state, wisp_entity entity )
{
    const int i = implicit_find_index( state, entity );
    return i >= 0 ? state->links[i] : NULL;
}
