// Checks of a loaded fabric, so that kernels can rely on it. Messages name the element of the fabric, since a
// binary file has no lines.
#include "fabric_check.h"

#include <string.h>

// ---- counts and vertices ----

static wisp_status check_counts( const check_state* c )
{
    const wisp_fabric* f = c->f;
    if ( f->vertex_count > FABRIC_MAX_VERTICES || f->triangle_count > FABRIC_MAX_TRIANGLES )
    {
        return BAD( "too many vertices (%d) or triangles (%d)", f->vertex_count, f->triangle_count );
    }
    if ( f->tile_size < FABRIC_MIN_TILE || f->tile_size > FABRIC_MAX_TILE || f->tile_size % WISP_FABRIC_LANES != 0 ||
         f->tile_count != fabric_tiles( f->vertex_count, f->tile_size ) )
    {
        return BAD( "%d tiles of %d vertices, expected tiles for %d vertices", f->tile_count, f->tile_size,
                    f->vertex_count );
    }
    if ( f->slot_count != fabric_padded( f->vertex_count + f->tile_count ) ||
         f->ring_slice_count != f->slot_count / WISP_FABRIC_LANES )
    {
        return BAD( "%d slots and %d slices of rings, which do not match %d vertices and %d tiles", f->slot_count,
                    f->ring_slice_count, f->vertex_count, f->tile_count );
    }
    if ( (int64_t)f->hinge_count + f->open_edge_count + f->nonmanifold_edge_count != f->edge_count ||
         f->edge_count > (int64_t)3 * f->triangle_count )
    {
        return BAD( "%d edges, %d hinges, %d open edges and %d nonmanifold edges, which are inconsistent",
                    f->edge_count, f->hinge_count, f->open_edge_count, f->nonmanifold_edge_count );
    }
    if ( f->link_count < f->edge_count || f->link_count > (int64_t)f->edge_count + f->hinge_count )
    {
        return BAD( "%d links, which do not match %d edges and %d hinges", f->link_count, f->edge_count,
                    f->hinge_count );
    }
    if ( f->tether_count > WISP_FABRIC_MAX_TETHERS || f->attachment_count > f->vertex_count ||
         (int)f->solve_order >= WISP_SOLVE_ORDER_COUNT )
    {
        return BAD( "%d tethers per vertex, %d attachments and solve order %d, one of which is out of range",
                    f->tether_count, f->attachment_count, (int)f->solve_order );
    }
    return WISP_OK;
}

static wisp_status check_vertices( const check_state* c )
{
    const wisp_fabric* f = c->f;
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        int32_t slot = f->vertex_slot[v];
        if ( fabric_is_vertex( f, slot ) == false || f->slot_vertex[slot] != v )
        {
            return BAD( "vertex %d in slot %d, but the vertex has another slot", v, slot );
        }
    }
    for ( int s = 0; s < f->slot_count; ++s )
    {
        wisp_vec3 p = f->rest[s];
        if ( s >= f->vertex_count && f->slot_vertex[s] != -1 )
        {
            return BAD( "vertex %d in slot %d, which is a dummy", f->slot_vertex[s], s );
        }
        bool inside = fabsf( p.x ) <= FABRIC_MAX_COORDINATE && fabsf( p.y ) <= FABRIC_MAX_COORDINATE &&
                      fabsf( p.z ) <= FABRIC_MAX_COORDINATE;
        if ( inside == false || fabric_is_length( f->area[s] ) == false )
        {
            return BAD( "a point or an area in slot %d that is too large or not finite", s );
        }
    }
    return WISP_OK;
}

static wisp_status check_attachments( const check_state* c )
{
    const wisp_fabric* f = c->f;
    bool* attached = fabric_pool_push_zeroed( c->scratch, (size_t)f->vertex_count, sizeof( bool ) );
    if ( attached == NULL )
    {
        return SHORT_OF_MEMORY;
    }
    for ( int i = 0; i < f->attachment_count; ++i )
    {
        int32_t slot = f->attachments[i];
        if ( fabric_is_vertex( f, slot ) == false || attached[slot] )
        {
            return BAD( "attachment %d at slot %d, which holds no vertex or is a duplicate", i, slot );
        }
        attached[slot] = true;
    }
    size_t count = (size_t)f->tether_count * (size_t)f->slot_count;
    for ( size_t i = 0; i < count; ++i )
    {
        int32_t to = f->tether_x4[i], own = (int32_t)( i % (size_t)f->slot_count );
        bool is_attached = to == 4 * own || ( fabric_is_vertex_x4( f, to ) && attached[to / 4] );
        if ( is_attached == false || fabric_is_length( f->tether_rest[i] ) == false )
        {
            return BAD( "a tether of slot %d without an attachment or without a length", own );
        }
    }
    return WISP_OK;
}

// ---- triangles, edges, hinges ----

static wisp_status check_mesh( const check_state* c )
{
    const wisp_fabric* f = c->f;
    for ( int t = 0; t < f->triangle_count; ++t )
    {
        const int32_t* v = f->triangles + 3 * (size_t)t;
        if ( fabric_is_vertex( f, v[0] ) == false || fabric_is_vertex( f, v[1] ) == false ||
             fabric_is_vertex( f, v[2] ) == false || v[0] == v[1] || v[1] == v[2] || v[2] == v[0] )
        {
            return BAD( "triangle %d with the slots %d, %d and %d, which are not three different vertices", t, v[0],
                        v[1], v[2] );
        }
    }
    for ( int e = 0; e < f->edge_count; ++e )
    {
        const int32_t* v = f->edges + 2 * (size_t)e;
        bool rising = e == 0 || v[-2] < v[0] || ( v[-2] == v[0] && v[-1] < v[1] );
        if ( v[0] < 0 || v[0] >= v[1] || v[1] >= f->vertex_count || rising == false )
        {
            return BAD( "edge %d with the slots %d and %d, which are out of range or out of order", e, v[0], v[1] );
        }
    }
    for ( int h = 0; h < f->hinge_count; ++h )
    {
        const int32_t* v = f->hinges + 4 * (size_t)h;
        bool distinct = v[0] != v[1] && v[0] != v[2] && v[0] != v[3] && v[1] != v[2] && v[1] != v[3];
        if ( fabric_is_vertex( f, v[0] ) == false || fabric_is_vertex( f, v[1] ) == false ||
             fabric_is_vertex( f, v[2] ) == false || fabric_is_vertex( f, v[3] ) == false || distinct == false )
        {
            return BAD( "hinge %d with the slots %d, %d, %d and %d, which are not four different vertices", h, v[0],
                        v[1], v[2], v[3] );
        }
    }
    return WISP_OK;
}

// Checks that the rings equal those cooked from the triangles.
static wisp_status check_rings( const check_state* c )
{
    const wisp_fabric* f = c->f;
    fabric_mesh mesh = { .vertex_count = f->vertex_count, .triangle_count = f->triangle_count };
    fabric_rings rings;
    if ( fabric_mesh_list_corners( f, c->scratch, &mesh ) == false ||
         fabric_rings_list( f, &mesh, c->scratch, c->scratch, &rings ) == false )
    {
        return SHORT_OF_MEMORY;
    }
    for ( int s = 0; s < f->ring_slice_count; ++s )
    {
        if ( f->ring_begin[s] != rings.begin[s] || f->ring_begin[s + 1] != rings.begin[s + 1] )
        {
            return BAD( "rings of slice %d from %d to %d, expected %d to %d from its triangles", s, f->ring_begin[s],
                        f->ring_begin[s + 1], rings.begin[s], rings.begin[s + 1] );
        }
        for ( int32_t e = rings.begin[s]; e < rings.begin[s + 1]; ++e )
        {
            for ( int lane = 0; lane < WISP_FABRIC_LANES; ++lane )
            {
                if ( f->ring_x4[e][lane] != rings.ring_x4[e][lane] )
                {
                    return BAD( "a ring around slot %d with %d at entry %d, expected %d from its triangles",
                                s * WISP_FABRIC_LANES + lane, f->ring_x4[e][lane], e - rings.begin[s],
                                rings.ring_x4[e][lane] );
                }
            }
        }
    }
    return f->ring_begin[0] == 0 ? WISP_OK : BAD( "rings that begin at %d, expected 0", f->ring_begin[0] );
}

wisp_status fabric_check( const wisp_fabric* fabric, fabric_pool* scratch, wisp_error* error )
{
    // each step relies on the checks of the previous steps
    static wisp_status ( *const steps[] )( const check_state* ) = {
        check_counts, check_vertices,     check_attachments,   check_mesh,
        check_rings,  fabric_check_links, fabric_check_hinges, fabric_check_levels,
    };
    check_state c = { .f = fabric, .scratch = scratch, .error = error };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( steps ) && status == WISP_OK; ++i )
    {
        status = steps[i]( &c );
        fabric_pool_release( scratch );
    }
    return status;
}
