#include "fabric.h"

#include "alloc.h"
#include "wisp/module/double3.h"

#include "wisp/module/definition.h"
#include <math.h>
#include <string.h>

// ---- hash ----

_Static_assert( sizeof( int ) == 4 && sizeof( float ) == 4 && sizeof( wisp_vec3 ) == 12,
                "a fabric is made of words" );

// Contents of a fabric, listed once, in the order of the hash, with all counts before the arrays. All data is 32-bit words;
// w( n ) is a length in a type that cannot overflow.

#define FABRIC_COUNTS( X )                                                                                           \
    X( vertex_count )                                                                                                \
    X( triangle_count )                                                                                              \
    X( tile_size )                                                                                                   \
    X( tile_count )                                                                                                  \
    X( slot_count )                                                                                                  \
    X( edge_count )                                                                                                  \
    X( hinge_count )                                                                                                 \
    X( open_edge_count )                                                                                             \
    X( nonmanifold_edge_count )                                                                                      \
    X( link_count )                                                                                                  \
    X( ring_slice_count )                                                                                            \
    X( tether_count )                                                                                                \
    X( attachment_count )                                                                                            \
    X( level_count )

#define FABRIC_SCHEDULE_COUNTS( X )                                                                                  \
    X( slot_count )                                                                                                  \
    X( tile_count )                                                                                                  \
    X( colour_count )

#define FABRIC_LEVEL_COUNTS( X )                                                                                     \
    X( vertex_count )                                                                                                \
    X( tile_size )                                                                                                   \
    X( row_count )                                                                                                   \
    X( first_row )                                                                                                   \
    X( first_link )                                                                                                  \
    X( unlinked_count )                                                                                              \
    X( link_count )                                                                                                  \
    X( chain_group_count )                                                                                           \
    X( finer_row_count )

#define FABRIC_SCHEDULE_ARRAYS( X, o )                                                                               \
    X( colour_tile, w( o->colour_count ) + 1 )                                                                       \
    X( tile_begin, w( o->tile_count ) + 1 )                                                                          \
    X( constraint, w( o->slot_count ) )

#define FABRIC_ARRAYS( X, o )                                                                                        \
    X( vertex_slot, w( o->vertex_count ) )                                                                           \
    X( slot_vertex, w( o->slot_count ) )                                                                             \
    X( rest, 3 * w( o->slot_count ) )                                                                                \
    X( area, w( o->slot_count ) )                                                                                    \
    X( triangles, 3 * w( o->triangle_count ) )                                                                       \
    X( edges, 2 * w( o->edge_count ) )                                                                               \
    X( hinges, 4 * w( o->hinge_count ) )                                                                             \
    X( link_a_x4, w( o->link_order.slot_count ) )                                                                    \
    X( link_b_x4, w( o->link_order.slot_count ) )                                                                    \
    X( link_rest, w( o->link_order.slot_count ) )                                                                    \
    X( hinge_slot_x4, 4 * w( o->hinge_order.slot_count ) )                                                           \
    X( ring_begin, w( o->ring_slice_count ) + 1 )                                                                    \
    X( ring_x4, WISP_FABRIC_LANES* w( o->ring_begin[o->ring_slice_count] ) )                                         \
    X( tether_x4, w( o->tether_count ) * w( o->slot_count ) )                                                        \
    X( tether_rest, w( o->tether_count ) * w( o->slot_count ) )                                                      \
    X( attachments, w( o->attachment_count ) )

#define FABRIC_LEVEL_ARRAYS( X, o )                                                                                  \
    X( slot_x4, w( o->row_count ) )                                                                                  \
    X( a_x4, w( o->schedule.slot_count ) )                                                                           \
    X( b_x4, w( o->schedule.slot_count ) )                                                                           \
    X( rest, w( o->schedule.slot_count ) )                                                                           \
    X( fraction, w( o->schedule.slot_count ) )                                                                       \
    X( chain_begin, w( o->chain_group_count ) + 1 )                                                                  \
    X( chain_x4, WISP_FABRIC_LANES* w( o->chain_begin[o->chain_group_count] ) )                                      \
    X( chain_rest, w( o->schedule.slot_count ) )                                                                     \
    X( parent_x4, WISP_FABRIC_PARENTS* padded_w( o->finer_row_count ) )                                              \
    X( weight, WISP_FABRIC_PARENTS* padded_w( o->finer_row_count ) )

static uint64_t w( int count )
{
    return count > 0 ? (uint64_t)count : 0;
}

static uint64_t padded_w( int count )
{
    return ( w( count ) + WISP_FABRIC_LANES - 1 ) / WISP_FABRIC_LANES * WISP_FABRIC_LANES;
}

// Each step is a bijection of the hash, so that a single different word always changes the result.
static uint64_t hash_word( uint64_t hash, uint32_t word )
{
    hash = ( hash ^ word ) * 0xff51afd7ed558ccdu;
    return hash ^ hash >> 32;
}

static uint64_t hash_array( uint64_t hash, const void* array, uint64_t words )
{
    for ( uint64_t i = 0; i < words; ++i )
    {
        uint32_t word;
        memcpy( &word, (const char*)array + 4 * i, 4 );
        hash = hash_word( hash, word );
    }
    return hash;
}

#define HASH_COUNT( name ) hash = hash_word( hash, (uint32_t)o->name );
#define HASH_ARRAY( name, words ) hash = hash_array( hash, o->name, words );

static uint64_t hash_schedule( uint64_t hash, const wisp_schedule* o )
{
    FABRIC_SCHEDULE_COUNTS( HASH_COUNT )
    FABRIC_SCHEDULE_ARRAYS( HASH_ARRAY, o )
    return hash;
}

static uint64_t hash_level( uint64_t hash, const wisp_fabric_level* o )
{
    FABRIC_LEVEL_COUNTS( HASH_COUNT )
    hash = hash_schedule( hash, &o->schedule );
    FABRIC_LEVEL_ARRAYS( HASH_ARRAY, o )
    return hash;
}

// Compute the hash of a fabric, without the hash itself.
static uint64_t fabric_hash( const wisp_fabric* o )
{
    uint64_t hash = 0;
    FABRIC_COUNTS( HASH_COUNT )
    hash = hash_word( hash, (uint32_t)o->solve_order );
    hash = hash_schedule( hash, &o->link_order );
    hash = hash_schedule( hash, &o->hinge_order );
    FABRIC_ARRAYS( HASH_ARRAY, o )
    for ( int i = 0; i < o->level_count; ++i )
    {
        hash = hash_level( hash, &o->levels[i] );
    }
    return hash;
}

// ---- pool ----

// Memory of a fabric: arrays that are released together, and the reference count.

// ---- memory ----

struct fabric_block
{
    fabric_block* previous;
    size_t size; // including this header
};

// The header occupies a cache line, so that the array after it is aligned to one.
#define BLOCK_HEAD BASE_BUFFER_ALIGNMENT

void* fabric_pool_push( fabric_pool* pool, size_t count, size_t element_size )
{
    size_t size = 0;
    if ( base_size_multiply( count, element_size, &size ) == false || size > SIZE_MAX - BLOCK_HEAD )
    {
        return NULL;
    }
    size += BLOCK_HEAD;
    fabric_block* block = base_allocate( pool->allocator, size, BASE_BUFFER_ALIGNMENT );
    if ( block == NULL )
    {
        return NULL;
    }
    *block = ( fabric_block ){ .previous = pool->last, .size = size };
    pool->last = block;
    pool->bytes += size;
    return (char*)block + BLOCK_HEAD;
}

void* fabric_pool_push_zeroed( fabric_pool* pool, size_t count, size_t element_size )
{
    void* array = fabric_pool_push( pool, count, element_size );
    if ( array != NULL )
    {
        memset( array, 0, count * element_size );
    }
    return array;
}

void fabric_pool_release( fabric_pool* pool )
{
    while ( pool->last != NULL )
    {
        fabric_block* block = pool->last;
        pool->last = block->previous;
        base_release( pool->allocator, block, block->size );
    }
    pool->bytes = 0;
}

// ---- references ----

// Create an empty fabric with one reference.
// @return null if out of memory
static cook_fabric* fabric_create( const wisp_allocator* allocator )
{
    cook_fabric* cooked = base_allocate( allocator, sizeof( cook_fabric ), BASE_BUFFER_ALIGNMENT );
    if ( cooked != NULL )
    {
        memset( cooked, 0, sizeof( *cooked ) );
        cooked->keep.allocator = cooked->edges.allocator = cooked->hinges.allocator = allocator;
        cooked->rings.allocator = cooked->spans.allocator = cooked->strips.allocator = allocator;
        atomic_flag_clear( &cooked->is_making );
        atomic_init( &cooked->owners, 1 );
    }
    return cooked;
}

void wisp_fabric_retain( wisp_fabric* fabric )
{
    cook_fabric* cooked = (cook_fabric*)fabric;
    if ( cooked != NULL )
    {
        atomic_fetch_add_explicit( &cooked->owners, 1, memory_order_relaxed );
    }
}

void wisp_fabric_release( wisp_fabric* fabric )
{
    cook_fabric* cooked = (cook_fabric*)fabric;

    // acquire: the last reference must see the writes of the others before it frees
    if ( cooked != NULL && atomic_fetch_sub_explicit( &cooked->owners, 1, memory_order_acq_rel ) == 1 )
    {
        fabric_pool keep = cooked->keep;
        fabric_pool_release( &cooked->edges );
        fabric_pool_release( &cooked->hinges );
        fabric_pool_release( &cooked->rings );
        fabric_pool_release( &cooked->spans );
        fabric_pool_release( &cooked->strips );
        fabric_pool_release( &keep );
        base_release( keep.allocator, cooked, sizeof( *cooked ) );
    }
}

size_t wisp_fabric_bytes( const wisp_fabric* fabric )
{
    const cook_fabric* cooked = (const cook_fabric*)fabric;
    return cooked != NULL ? sizeof( cook_fabric ) + cooked->keep.bytes + cooked->edges.bytes + cooked->hinges.bytes +
                                cooked->rings.bytes + cooked->spans.bytes + cooked->strips.bytes
                          : 0;
}

// ---- fabric ----

// ---- input ----

static const wisp_field FABRIC_FIELDS[] = {
    WISP_WHOLE( wisp_fabric_def, vertex_count, 0, 0, FABRIC_MAX_VERTICES ),
    WISP_WHOLE( wisp_fabric_def, triangle_count, 0, 0, FABRIC_MAX_TRIANGLES ),
    WISP_WHOLE( wisp_fabric_def, attachment_count, 0, 0, FABRIC_MAX_VERTICES ),
    WISP_SWITCH( wisp_fabric_def, bend_links, true ),
    WISP_SWITCH( wisp_fabric_def, hinges, false ),
    WISP_SWITCH( wisp_fabric_def, tethers, false ),
    WISP_SWITCH( wisp_fabric_def, coarse_sheets, false ),
    WISP_SWITCH( wisp_fabric_def, lean, false ),
    WISP_CHOICE( wisp_fabric_def, solve_order, WISP_SOLVE_ORDER_COLOUR, WISP_SOLVE_ORDER_COUNT ),
    WISP_WHOLE_OR( wisp_fabric_def, tile_size, 0, FABRIC_MIN_TILE, FABRIC_MAX_TILE ),
    WISP_WHOLE( wisp_fabric_def, workers, 1, 1, WISP_MAX_WORKERS ),
};
WISP_DEFINE( fabric_def, "fabric", FABRIC_FIELDS )

static wisp_status check_numbers( const wisp_fabric_def* def, wisp_error* error )
{
    if ( ( def->points == NULL && def->vertex_count > 0 ) || ( def->triangles == NULL && def->triangle_count > 0 ) ||
         ( def->attachments == NULL && def->attachment_count > 0 ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "fabric: got a null list, expected lists of %d vertices, %d triangles and %d attachments",
                          def->vertex_count, def->triangle_count, def->attachment_count );
    }
    if ( def->tile_size % WISP_FABRIC_LANES != 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "fabric: got tiles of %d vertices, expected 0 or a multiple of %d from %d to %d",
                          def->tile_size, WISP_FABRIC_LANES, FABRIC_MIN_TILE, FABRIC_MAX_TILE );
    }
    return WISP_OK;
}

static wisp_status check_triangles( const wisp_fabric_def* def, wisp_error* error )
{
    for ( int t = 0; t < def->triangle_count; ++t )
    {
        const int32_t* v = def->triangles + 3 * (size_t)t;
        for ( int k = 0; k < 3; ++k )
        {
            if ( v[k] < 0 || v[k] >= def->vertex_count )
            {
                return wisp_fail( error, WISP_BAD_INPUT, "triangle %d: got vertex %d, but the mesh has %d vertices",
                                  t, v[k], def->vertex_count );
            }
        }
        if ( v[0] == v[1] || v[1] == v[2] || v[2] == v[0] )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "triangle %d: got vertex %d twice, expected three different ones", t,
                              v[0] == v[1] ? v[0] : v[2] );
        }
    }
    return WISP_OK;
}

static wisp_status check_def( const wisp_fabric_def* def, wisp_error* error )
{
    WISP_TRY( check_numbers( def, error ) );
    for ( int v = 0; v < def->vertex_count; ++v )
    {
        wisp_vec3 p = def->points[v];

        // comparisons with NaN are false
        bool inside = fabsf( p.x ) <= FABRIC_MAX_COORDINATE && fabsf( p.y ) <= FABRIC_MAX_COORDINATE &&
                      fabsf( p.z ) <= FABRIC_MAX_COORDINATE;
        if ( inside == false )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "vertex %d: got (%g, %g, %g), expected finite coordinates within %g m of the origin", v,
                              (double)p.x, (double)p.y, (double)p.z, (double)FABRIC_MAX_COORDINATE );
        }
    }
    WISP_TRY( check_triangles( def, error ) );
    for ( int i = 0; i < def->attachment_count; ++i )
    {
        if ( def->attachments[i] < 0 || def->attachments[i] >= def->vertex_count )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "attachment %d: got vertex %d, but the mesh has %d vertices", i,
                              def->attachments[i], def->vertex_count );
        }
    }
    return WISP_OK;
}

// ---- stages ----

// Computes the vertex order, or takes that of another fabric, and the neighbours by slot.
static bool order( const wisp_fabric_def* def, const wisp_fabric* like, cook_fabric* cooked, fabric_pool* scratch,
                   fabric_graph* graph )
{
    wisp_fabric* f = &cooked->fabric;
    fabric_pool user = { .allocator = scratch->allocator };
    fabric_graph by_vertex;
    int32_t* vertex_slot = fabric_pool_push( &cooked->keep, (size_t)f->vertex_count, sizeof( int32_t ) );
    int32_t* slot_vertex = fabric_pool_push( &cooked->keep, (size_t)f->slot_count, sizeof( int32_t ) );
    f->vertex_slot = vertex_slot;
    f->slot_vertex = slot_vertex;
    bool done = vertex_slot != NULL && slot_vertex != NULL &&
                fabric_graph_make( &user, def->triangles, def->triangle_count, def->vertex_count, &by_vertex );
    if ( done && like != NULL )
    {
        memcpy( vertex_slot, like->vertex_slot, (size_t)f->vertex_count * sizeof( int32_t ) );
        memcpy( slot_vertex, like->slot_vertex, (size_t)f->vertex_count * sizeof( int32_t ) );
    }
    else if ( done )
    {
        done = fabric_order_vertices( user.allocator, &by_vertex, def->attachments, def->attachment_count,
                                      vertex_slot, slot_vertex );
    }
    done = done && fabric_graph_relist( scratch, &by_vertex, slot_vertex, vertex_slot, graph );
    for ( int s = f->vertex_count; s < f->slot_count && done; ++s )
    {
        slot_vertex[s] = -1;
    }
    fabric_pool_release( &user );
    return done;
}

// Converts attachments to slots, without duplicates, in the user's order.
static bool rename_attachments( const wisp_fabric_def* def, cook_fabric* cooked, fabric_pool* scratch )
{
    wisp_fabric* f = &cooked->fabric;
    bool* named = fabric_pool_push_zeroed( scratch, (size_t)f->vertex_count, sizeof( bool ) );
    int32_t* attachments = fabric_pool_push( &cooked->keep, (size_t)def->attachment_count, sizeof( int32_t ) );
    if ( named == NULL || attachments == NULL )
    {
        return false;
    }
    for ( int i = 0; i < def->attachment_count; ++i )
    {
        int32_t slot = f->vertex_slot[def->attachments[i]];
        if ( named[slot] == false )
        {
            named[slot] = true;
            attachments[f->attachment_count++] = slot;
        }
    }
    f->attachments = attachments;
    return true;
}

// Converts points, triangles and attachments to the fabric's order.
static bool rename( const wisp_fabric_def* def, cook_fabric* cooked, fabric_pool* scratch )
{
    wisp_fabric* f = &cooked->fabric;
    wisp_vec3* rest = fabric_pool_push( &cooked->keep, (size_t)f->slot_count, sizeof( wisp_vec3 ) );
    int32_t* triangles = fabric_pool_push( &cooked->keep, 3 * (size_t)f->triangle_count, sizeof( int32_t ) );
    if ( rest == NULL || triangles == NULL )
    {
        return false;
    }
    for ( int s = 0; s < f->slot_count; ++s )
    {
        rest[s] = def->points[f->slot_vertex[s] >= 0 ? f->slot_vertex[s] : 0];
    }
    for ( size_t i = 0; i < 3 * (size_t)f->triangle_count; ++i )
    {
        triangles[i] = f->vertex_slot[def->triangles[i]];
    }
    f->rest = rest;
    f->triangles = triangles;
    return rename_attachments( def, cooked, scratch );
}

// Lists edges first, then the opposite vertices of hinges. Two triangles with the same three vertices have only one
// opposite vertex.
static bool list_links( bool cross, wisp_fabric* f, fabric_pool* scratch, int32_t** out )
{
    size_t most = (size_t)f->edge_count + ( cross ? (size_t)f->hinge_count : 0 );
    int32_t* links = fabric_pool_push( scratch, 2 * most, sizeof( int32_t ) );
    if ( links == NULL )
    {
        return false;
    }
    memcpy( links, f->edges, 2 * (size_t)f->edge_count * sizeof( int32_t ) );
    f->link_count = f->edge_count;
    for ( int h = 0; h < f->hinge_count && cross; ++h )
    {
        const int32_t* hinge = f->hinges + 4 * (size_t)h;
        if ( hinge[2] != hinge[3] )
        {
            links[2 * (size_t)f->link_count] = hinge[2];
            links[2 * (size_t)f->link_count + 1] = hinge[3];
            f->link_count += 1;
        }
    }
    *out = links;
    return true;
}

static bool mark_bend_links( wisp_fabric* f, fabric_pool* keep )
{
    uint8_t* bends = fabric_pool_push_zeroed( keep, (size_t)f->link_order.slot_count / 8 + 3, sizeof( uint8_t ) );
    for ( int slot = 0; slot < f->link_order.slot_count && bends != NULL; ++slot )
    {
        const unsigned is_bend = f->link_order.constraint[slot] >= f->edge_count;
        bends[slot / 8] = (uint8_t)( bends[slot / 8] | is_bend << slot % 8 );
    }
    f->link_bends = bends;
    return bends != NULL;
}

static bool schedule_links( bool bend_links, cook_fabric* cooked, fabric_pool* scratch )
{
    wisp_fabric* f = &cooked->fabric;
    int32_t* links = NULL;
    if ( list_links( bend_links, f, scratch, &links ) == false )
    {
        return false;
    }
    float* rest = fabric_pool_push( scratch, (size_t)f->link_count, sizeof( float ) );
    if ( rest == NULL )
    {
        return false;
    }
    for ( size_t c = 0; c < (size_t)f->link_count; ++c )
    {
        // in double, so that short edges far from the origin have no error beyond that of their points
        rest[c] = (float)double3_length( double3_between( f->rest[links[2 * c]], f->rest[links[2 * c + 1]] ) );
    }
    fabric_constraints constraints = {
        .slots = links,
        .count = f->link_count,
        .arity = 2,
        .vertex_count = f->vertex_count,
        .tile_size = f->tile_size,
        .solve_order = f->solve_order,
        .last_slots = f->attachment_count,
    };
    fabric_links lanes;
    if ( fabric_schedule_build( &constraints, &cooked->keep, &cooked->hinges, &f->link_order ) == false ||
         fabric_schedule_links( &f->link_order, &constraints, rest, &cooked->keep, &lanes ) == false )
    {
        return false;
    }
    f->link_a_x4 = lanes.a_x4;
    f->link_b_x4 = lanes.b_x4;
    f->link_rest = lanes.rest;
    return mark_bend_links( f, &cooked->keep );
}

static bool schedule_hinges( const wisp_fabric_def* def, cook_fabric* cooked )
{
    wisp_fabric* f = &cooked->fabric;
    fabric_constraints constraints = {
        .slots = f->hinges,
        .count = def->hinges ? f->hinge_count : 0,
        .arity = 4,
        .vertex_count = f->vertex_count,
        .tile_size = f->tile_size,
        .solve_order = def->solve_order,
        .last_slots = f->attachment_count,
    };
    return fabric_schedule_build( &constraints, &cooked->keep, &cooked->keep, &f->hinge_order ) &&
           fabric_schedule_corners( &f->hinge_order, &constraints, &cooked->keep, &f->hinge_slot_x4 );
}

static bool cook_rings( const fabric_mesh* mesh, cook_fabric* cooked, fabric_pool* scratch )
{
    fabric_pool fans = { .allocator = scratch->allocator };
    fabric_rings rings = { 0 };
    bool done = fabric_rings_list( &cooked->fabric, mesh, &fans, &cooked->rings, &rings );
    cooked->fabric.ring_begin = rings.begin;
    cooked->fabric.ring_x4 = rings.ring_x4;
    fabric_pool_release( &fans );
    return done;
}

// release scratch memory of each stage before the next one, to keep the peak low
static bool cook_lists( const wisp_fabric_def* def, cook_fabric* cooked, fabric_pool* scratch )
{
    fabric_pool links = { .allocator = scratch->allocator };
    bool done = schedule_links( def->bend_links, cooked, &links );
    fabric_pool_release( &links );
    return done && schedule_hinges( def, cooked );
}

static bool cook_parts( const wisp_fabric_def* def, const fabric_mesh* mesh, cook_fabric* cooked )
{
    wisp_fabric* f = &cooked->fabric;
    fabric_parts parts = {
        .mesh = mesh, .keep = &cooked->keep, .allocator = cooked->keep.allocator, .workers = def->workers
    };
    return ( def->tethers == false || fabric_cook_tethers( &parts, f ) ) &&
           ( def->coarse_sheets == false || fabric_cook_levels( &parts, f ) );
}

// ---- lean fabrics ----

static void drop_arrays( cook_fabric* cooked )
{
    wisp_fabric* f = &cooked->fabric;
    fabric_pool_release( &cooked->edges );
    fabric_pool_release( &cooked->rings );
    fabric_pool_release( &cooked->hinges );
    f->edges = f->ring_begin = f->hinges = f->link_order.constraint = NULL;
    f->ring_x4 = NULL;
    atomic_init( &cooked->made, 0u );
}

static void move_pool( fabric_pool* from, fabric_pool* to )
{
    *to = *from;
    *from = ( fabric_pool ){ .allocator = from->allocator };
}

// Take the arrays that are asked for.
static void adopt( cook_fabric* cooked, cook_fabric* from, unsigned arrays )
{
    wisp_fabric *f = &cooked->fabric, *made = &from->fabric;
    if ( ( arrays & WISP_FABRIC_EDGES ) != 0 )
    {
        move_pool( &from->edges, &cooked->edges );
        f->edges = made->edges;
    }
    if ( ( arrays & WISP_FABRIC_HINGES ) != 0 )
    {
        move_pool( &from->hinges, &cooked->hinges );
        f->hinges = made->hinges;
        f->link_order.constraint = made->link_order.constraint;
    }
    if ( ( arrays & WISP_FABRIC_RINGS ) != 0 )
    {
        move_pool( &from->rings, &cooked->rings );
        f->ring_begin = made->ring_begin;
        f->ring_x4 = made->ring_x4;
    }
}

// Cooks once more what was dropped, from the triangles.
static bool make_topology( cook_fabric* cooked, unsigned arrays )
{
    fabric_pool scratch = { .allocator = cooked->keep.allocator };
    cook_fabric again = {
        .fabric = cooked->fabric, .keep = scratch, .edges = scratch, .hinges = scratch, .rings = scratch
    };
    const bool bend_links = again.fabric.link_count > again.fabric.edge_count;
    fabric_graph listed, graph;
    fabric_mesh mesh;
    const wisp_fabric* f = &again.fabric;
    again.fabric.hinge_count = again.fabric.open_edge_count = again.fabric.nonmanifold_edge_count = 0;
    const bool done = fabric_graph_make( &scratch, f->triangles, f->triangle_count, f->vertex_count, &listed ) &&
                      fabric_graph_relist( &scratch, &listed, NULL, NULL, &graph ) &&
                      fabric_mesh_connect( &graph, false, &scratch, &again, &mesh ) &&
                      ( ( arrays & WISP_FABRIC_RINGS ) == 0 || cook_rings( &mesh, &again, &scratch ) ) &&
                      ( ( arrays & WISP_FABRIC_HINGES ) == 0 || schedule_links( bend_links, &again, &scratch ) );
    if ( done )
    {
        adopt( cooked, &again, arrays );
    }
    fabric_pool* left[] = { &scratch, &again.keep, &again.edges, &again.hinges, &again.rings };
    for ( int i = 0; i < WISP_COUNT( left ); ++i )
    {
        fabric_pool_release( left[i] );
    }
    return done;
}

static bool make_spans( cook_fabric* cooked )
{
    wisp_fabric* f = &cooked->fabric;
    float* span2 = fabric_pool_push( &cooked->spans, (size_t)f->hinge_order.slot_count, sizeof( float ) );
    for ( int slot = 0; slot < f->hinge_order.slot_count && span2 != NULL; ++slot )
    {
        const int32_t* lane =
            f->hinge_slot_x4 + 4 * (size_t)( slot - slot % WISP_FABRIC_LANES ) + slot % WISP_FABRIC_LANES;
        const wisp_vec3 k = f->rest[lane[2 * WISP_FABRIC_LANES] / 4], l = f->rest[lane[3 * WISP_FABRIC_LANES] / 4];
        const float x = l.x - k.x, y = l.y - k.y, z = l.z - k.z;
        span2[slot] = x * x + y * y + z * z;
    }
    f->hinge_span2 = span2;
    return span2 != NULL;
}

static bool make_strips( cook_fabric* cooked )
{
    const bool done = fabric_strips_build( &cooked->fabric, &cooked->strips, &cooked->fabric.strips );
    if ( done == false )
    {
        fabric_pool_release( &cooked->strips );
    }
    return done;
}

wisp_status wisp_fabric_need( const wisp_fabric* fabric, unsigned arrays )
{
    if ( fabric == NULL )
    {
        return WISP_BAD_INPUT;
    }
    cook_fabric* cooked = (cook_fabric*)(uintptr_t)fabric;
    if ( ( arrays & ~atomic_load_explicit( &cooked->made, memory_order_acquire ) ) == 0 )
    {
        return WISP_OK;
    }
    while ( atomic_flag_test_and_set_explicit( &cooked->is_making, memory_order_acquire ) )
    {
        // another thread makes arrays of the same fabric, which takes milliseconds, once
    }
    const unsigned missing = arrays & ~atomic_load( &cooked->made );
    const unsigned topology = missing & ( WISP_FABRIC_EDGES | WISP_FABRIC_HINGES | WISP_FABRIC_RINGS );
    const bool done = ( topology == 0 || make_topology( cooked, topology ) ) &&
                      ( ( missing & WISP_FABRIC_SPANS ) == 0 || make_spans( cooked ) ) &&
                      ( ( missing & WISP_FABRIC_STRIPS ) == 0 || make_strips( cooked ) );
    atomic_fetch_or_explicit( &cooked->made, done ? missing : 0, memory_order_release );
    atomic_flag_clear_explicit( &cooked->is_making, memory_order_release );
    return done ? WISP_OK : WISP_NO_MEMORY;
}

// Edges are sorted by their first slot, then by their second.
int wisp_fabric_find_edge( const wisp_fabric* f, int32_t a, int32_t b )
{
    const int32_t first = a < b ? a : b, second = a < b ? b : a;
    int lower = 0, upper = f->edge_count - 1;
    while ( lower < upper )
    {
        const int middle = lower + ( upper - lower ) / 2;
        const int32_t* edge = f->edges + 2 * (size_t)middle;
        const bool is_before = edge[0] < first || ( edge[0] == first && edge[1] < second );
        lower = is_before ? middle + 1 : lower;
        upper = is_before ? upper : middle;
    }
    return lower;
}

static bool cook_all( const wisp_fabric_def* def, const wisp_fabric* like, cook_fabric* cooked, fabric_pool* scratch )
{
    wisp_fabric* f = &cooked->fabric;
    f->vertex_count = def->vertex_count;
    f->triangle_count = def->triangle_count;
    f->tile_size = def->tile_size != 0 ? def->tile_size : fabric_choose_tile_size( def->vertex_count );
    f->tile_count = fabric_tiles( f->vertex_count, f->tile_size );
    f->slot_count = fabric_padded( f->vertex_count + f->tile_count );
    f->ring_slice_count = f->slot_count / WISP_FABRIC_LANES;
    f->solve_order = def->solve_order;

    fabric_graph graph;
    fabric_mesh mesh;
    bool across = def->tethers || def->coarse_sheets;
    bool done = order( def, like, cooked, scratch, &graph ) && rename( def, cooked, scratch ) &&
                fabric_mesh_connect( &graph, across, scratch, cooked, &mesh ) &&
                fabric_mesh_measure_areas( &mesh, scratch, cooked ) && cook_rings( &mesh, cooked, scratch ) &&
                cook_lists( def, cooked, scratch ) && cook_parts( def, &mesh, cooked );
    if ( done )
    {
        f->hash = fabric_hash( f );
    }
    atomic_init( &cooked->made, WISP_FABRIC_EDGES | WISP_FABRIC_HINGES | WISP_FABRIC_RINGS );
    if ( done && def->lean )
    {
        drop_arrays( cooked );
    }
    return done;
}

wisp_status fabric_cook_checked( const wisp_fabric_def* def, const wisp_fabric* like, const wisp_allocator* allocator,
                                 wisp_fabric** out, wisp_error* error )
{
    fabric_pool scratch = { .allocator = allocator };
    cook_fabric* cooked = fabric_create( allocator );
    bool done = cooked != NULL && cook_all( def, like, cooked, &scratch );
    fabric_pool_release( &scratch );
    if ( done == false )
    {
        wisp_fabric_release( (wisp_fabric*)cooked );
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory to cook a fabric of %d vertices and %d triangles",
                          def->vertex_count, def->triangle_count );
    }
    *out = &cooked->fabric;
    return WISP_OK;
}

wisp_status wisp_fabric_cook( const wisp_fabric_def* given, const wisp_allocator* allocator, wisp_fabric** out,
                              wisp_error* error )
{
    if ( out == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "out: got null, expected where to store the fabric" );
    }
    *out = NULL;
    wisp_fabric_def values;
    const wisp_fabric_def* def = &values;
    WISP_TRY( wisp_def_read( &wisp_fabric_def_fields, &values, given, error ) );
    wisp_status status = check_def( def, error );
    return status == WISP_OK ? fabric_cook_checked( def, NULL, allocator, out, error ) : status;
}
