// Checks of a loaded fabric, so that kernels can rely on it. Messages name the element of the fabric, since a
// binary file has no lines.
#include "fabric.h"

#include <math.h>
#include <string.h>

typedef struct check_state
{
    const wisp_fabric* f;
    fabric_pool* scratch;
    wisp_error* error;
} check_state;

#define BAD( ... ) wisp_fail( c->error, WISP_BAD_INPUT, "saved fabric: got " __VA_ARGS__ )
#define SHORT_OF_MEMORY wisp_fail( c->error, WISP_NO_MEMORY, "out of memory to check a saved fabric" )

static bool is_vertex( const wisp_fabric* f, int32_t slot )
{
    return slot >= 0 && slot < f->vertex_count;
}

static bool is_vertex_x4( const wisp_fabric* f, int32_t slot_x4 )
{
    return slot_x4 >= 0 && slot_x4 % 4 == 0 && slot_x4 / 4 < f->vertex_count;
}

static bool is_length( float value )
{
    return value >= 0.0f && isfinite( value );
}

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
        if ( is_vertex( f, slot ) == false || f->slot_vertex[slot] != v )
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
        if ( inside == false || is_length( f->area[s] ) == false )
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
        if ( is_vertex( f, slot ) == false || attached[slot] )
        {
            return BAD( "attachment %d at slot %d, which holds no vertex or is a duplicate", i, slot );
        }
        attached[slot] = true;
    }
    size_t count = (size_t)f->tether_count * (size_t)f->slot_count;
    for ( size_t i = 0; i < count; ++i )
    {
        int32_t to = f->tether_x4[i], own = (int32_t)( i % (size_t)f->slot_count );
        bool is_attached = to == 4 * own || ( is_vertex_x4( f, to ) && attached[to / 4] );
        if ( is_attached == false || is_length( f->tether_rest[i] ) == false )
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
        if ( is_vertex( f, v[0] ) == false || is_vertex( f, v[1] ) == false || is_vertex( f, v[2] ) == false ||
             v[0] == v[1] || v[1] == v[2] || v[2] == v[0] )
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
        if ( is_vertex( f, v[0] ) == false || is_vertex( f, v[1] ) == false || is_vertex( f, v[2] ) == false ||
             is_vertex( f, v[3] ) == false || distinct == false )
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

// ---- schedules ----

// Constraints in the layout of kernels: slots times 4, one constraint per lane.
typedef struct lane_reader
{
    int arity;
    const int32_t *a_x4, *b_x4; // two vertices
    const int32_t* slot_x4;     // four vertices, [group][4][8]
    int vertex_count;           // tiles have their dummies behind the vertices
    int tile_size, tile_count;
} lane_reader;

static void read_lane( const lane_reader* lanes, int32_t at, int32_t* slot_x4 )
{
    if ( lanes->arity == 2 )
    {
        slot_x4[0] = lanes->a_x4[at];
        slot_x4[1] = lanes->b_x4[at];
        return;
    }
    for ( int k = 0; k < 4; ++k )
    {
        size_t group = (size_t)( at / WISP_FABRIC_LANES ) * 4 + (size_t)k;
        slot_x4[k] = lanes->slot_x4[group * WISP_FABRIC_LANES + (size_t)( at % WISP_FABRIC_LANES )];
    }
}

// Checks offsets.
// @param rising minimum increment
static bool offsets_rise( const int32_t* begin, int count, int end, int step )
{
    bool fine = begin[0] == 0 && begin[count] == end;
    for ( int i = 0; i < count && fine; ++i )
    {
        fine = begin[i + 1] > begin[i] && begin[i + 1] <= end && begin[i + 1] % step == 0;
    }
    return fine;
}

// Checks that every constraint occurs exactly once.
static wisp_status check_schedule( const check_state* c, const char* what, const wisp_schedule* s, int count )
{
    if ( offsets_rise( s->colour_tile, s->colour_count, s->tile_count, 1 ) == false ||
         offsets_rise( s->tile_begin, s->tile_count, s->slot_count, WISP_FABRIC_LANES ) == false )
    {
        return BAD( "an order of %s whose colours or tiles do not ascend to its %d slots", what, s->slot_count );
    }
    bool* seen = fabric_pool_push_zeroed( c->scratch, (size_t)count, sizeof( bool ) );
    if ( seen == NULL )
    {
        return SHORT_OF_MEMORY;
    }
    int found = 0;
    for ( int32_t i = 0; i < s->slot_count; ++i )
    {
        int32_t number = s->constraint[i];
        if ( number < -1 || number >= count || ( number >= 0 && seen[number] ) )
        {
            return BAD( "an order of %s with number %d at %d, which is out of range or a duplicate", what, number,
                        i );
        }
        if ( number >= 0 )
        {
            seen[number] = true;
            found += 1;
        }
    }
    return found == count ? WISP_OK : BAD( "an order of %s with %d entries, expected %d", what, found, count );
}

// Last lane and tile to use each vertex, and whether it is a dummy.
typedef struct touch_state
{
    int32_t* lane; // [vertex_count] lane + 1
    int32_t* tile; // [vertex_count] tile of the schedule + 1
    bool* dummy;   // [tile_count]
} touch_state;

// Returns the dummy of the tile that contains the constraints of a schedule's tile, or -1 if there are several.
static int32_t own_dummy4( const wisp_schedule* s, const lane_reader* lanes, int tile )
{
    int32_t own = -1;
    for ( int32_t i = s->tile_begin[tile]; i < s->tile_begin[tile + 1]; ++i )
    {
        int32_t slot_x4[4], smallest = INT32_MAX;
        read_lane( lanes, i, slot_x4 );
        for ( int k = 0; k < lanes->arity; ++k )
        {
            smallest = slot_x4[k] < smallest ? slot_x4[k] : smallest;
        }
        int32_t dummy4 = 4 * ( lanes->vertex_count + smallest / 4 / lanes->tile_size );
        if ( s->constraint[i] >= 0 && own != -1 && own != dummy4 )
        {
            return -1;
        }
        own = s->constraint[i] >= 0 ? dummy4 : own;
    }
    return own;
}

// Checks that no lane that runs at the same time uses the same vertex.
// @param colour_begin first tile of the tile's colour
static bool touch( touch_state* touched, int32_t slot, int32_t lane, int tile, int colour_begin )
{
    // the first lane that may run in parallel with this one
    int32_t together = lane - lane % WISP_FABRIC_LANES;
    bool lane_free = touched->lane[slot] <= together || touched->lane[slot] == lane + 1;
    bool tile_free = touched->tile[slot] <= colour_begin || touched->tile[slot] == tile + 1;
    touched->lane[slot] = lane + 1;
    touched->tile[slot] = tile + 1;
    return lane_free && tile_free;
}

static wisp_status check_tile( const check_state* c, const char* what, const wisp_schedule* s,
                               const lane_reader* lanes, touch_state* touched, int tile, int colour_begin )
{
    int32_t pad4 = own_dummy4( s, lanes, tile );
    int32_t number = pad4 / 4 - lanes->vertex_count;
    if ( pad4 < 0 || number < 0 || number >= lanes->tile_count || touched->dummy[number] )
    {
        return BAD( "tile %d in the order of %s without a dummy of its own", tile, what );
    }
    touched->dummy[number] = true;
    for ( int32_t i = s->tile_begin[tile]; i < s->tile_begin[tile + 1]; ++i )
    {
        int32_t slot_x4[4];
        read_lane( lanes, i, slot_x4 );
        for ( int k = 0; k < lanes->arity; ++k )
        {
            if ( s->constraint[i] < 0 && slot_x4[k] != pad4 )
            {
                return BAD( "lane %d in the order of %s padded by the dummy of another tile", i, what );
            }
            if ( s->constraint[i] >= 0 && touch( touched, slot_x4[k] / 4, i, tile, colour_begin ) == false )
            {
                return BAD( "two constraints at slot %d at the same time, one of them in lane %d of the order of %s",
                            slot_x4[k] / 4, i, what );
            }
        }
    }
    return WISP_OK;
}

// Checks that lanes of a group and tiles of a colour share no vertex. Indices and slots are already checked.
static wisp_status check_conflicts( const check_state* c, const char* what, const wisp_schedule* s,
                                    const lane_reader* lanes )
{
    touch_state touched = {
        .lane = fabric_pool_push_zeroed( c->scratch, (size_t)lanes->vertex_count, sizeof( int32_t ) ),
        .tile = fabric_pool_push_zeroed( c->scratch, (size_t)lanes->vertex_count, sizeof( int32_t ) ),
        .dummy = fabric_pool_push_zeroed( c->scratch, (size_t)lanes->tile_count, sizeof( bool ) ),
    };
    if ( touched.lane == NULL || touched.tile == NULL || touched.dummy == NULL )
    {
        return SHORT_OF_MEMORY;
    }
    wisp_status status = WISP_OK;
    for ( int colour = 0; colour < s->colour_count; ++colour )
    {
        for ( int tile = s->colour_tile[colour]; tile < s->colour_tile[colour + 1] && status == WISP_OK; ++tile )
        {
            status = check_tile( c, what, s, lanes, &touched, tile, s->colour_tile[colour] );
        }
    }
    return status;
}

// Checks that lanes contain the slots of their constraints, and that bend links join two different vertices.
static wisp_status check_link_lanes( const check_state* c )
{
    const wisp_fabric* f = c->f;
    for ( int32_t i = 0; i < f->link_order.slot_count; ++i )
    {
        int32_t number = f->link_order.constraint[i], a = f->link_a_x4[i], b = f->link_b_x4[i];
        bool fine = is_length( f->link_rest[i] ) && ( number >= 0 || f->link_rest[i] == 0.0f );
        if ( number >= f->edge_count )
        {
            fine = fine && is_vertex_x4( f, a ) && is_vertex_x4( f, b ) && a != b;
        }
        else if ( number >= 0 )
        {
            fine = fine && a == 4 * f->edges[2 * (size_t)number] && b == 4 * f->edges[2 * (size_t)number + 1];
        }
        if ( fine == false )
        {
            return BAD( "link %d in lane %d with invalid slots or an invalid length", number, i );
        }
    }
    return WISP_OK;
}

static wisp_status check_hinge_lanes( const check_state* c, const lane_reader* lanes )
{
    const wisp_fabric* f = c->f;
    for ( int32_t i = 0; i < f->hinge_order.slot_count; ++i )
    {
        int32_t number = f->hinge_order.constraint[i], slot_x4[4];
        read_lane( lanes, i, slot_x4 );
        for ( int k = 0; k < 4 && number >= 0; ++k )
        {
            if ( slot_x4[k] != 4 * f->hinges[4 * (size_t)number + (size_t)k] )
            {
                return BAD( "hinge %d in lane %d with a vertex of another hinge", number, i );
            }
        }
    }
    return WISP_OK;
}

static wisp_status check_links( const check_state* c )
{
    const wisp_fabric* f = c->f;
    lane_reader lanes = {
        .arity = 2,
        .a_x4 = f->link_a_x4,
        .b_x4 = f->link_b_x4,
        .vertex_count = f->vertex_count,
        .tile_size = f->tile_size,
        .tile_count = f->tile_count,
    };
    wisp_status status = check_schedule( c, "links", &f->link_order, f->link_count );
    status = status == WISP_OK ? check_link_lanes( c ) : status;
    return status == WISP_OK ? check_conflicts( c, "links", &f->link_order, &lanes ) : status;
}

static wisp_status check_hinges( const check_state* c )
{
    const wisp_fabric* f = c->f;
    lane_reader lanes = {
        .arity = 4,
        .slot_x4 = f->hinge_slot_x4,
        .vertex_count = f->vertex_count,
        .tile_size = f->tile_size,
        .tile_count = f->tile_count,
    };
    int count = f->hinge_order.slot_count > 0 ? f->hinge_count : 0;
    wisp_status status = check_schedule( c, "hinges", &f->hinge_order, count );
    status = status == WISP_OK ? check_hinge_lanes( c, &lanes ) : status;
    return status == WISP_OK ? check_conflicts( c, "hinges", &f->hinge_order, &lanes ) : status;
}

// ---- levels ----

// Checks counts, and that the vertices are a subset of the next finer level.
// @param level_of [vertex_count] coarsest level so far that has each slot, 0: none
static wisp_status check_level_rows( const check_state* c, int number, int32_t* level_of )
{
    const wisp_fabric* f = c->f;
    const wisp_fabric_level *level = &f->levels[number], *finer = number > 0 ? level - 1 : NULL;
    if ( level->vertex_count < 1 || level->link_count < 1 || level->vertex_count > f->vertex_count ||
         level->tile_size < WISP_FABRIC_LANES || level->tile_size > fabric_padded( f->vertex_count ) ||
         level->row_count !=
             fabric_padded( level->vertex_count + fabric_tiles( level->vertex_count, level->tile_size ) ) ||
         level->chain_group_count != level->schedule.slot_count / WISP_FABRIC_LANES ||
         level->finer_row_count != ( finer != NULL ? finer->row_count : f->slot_count ) ||
         level->first_row != ( finer != NULL ? finer->first_row + finer->row_count : 0 ) ||
         level->first_link != ( finer != NULL ? finer->first_link + finer->schedule.slot_count : 0 ) )
    {
        return BAD( "level %d with %d vertices in %d rows and tiles of %d, and %d links, which do not match",
                    number + 1, level->vertex_count, level->row_count, level->tile_size, level->link_count );
    }
    for ( int i = 0; i < level->row_count; ++i )
    {
        const int32_t slot_x4 = level->slot_x4[i];
        const bool fine = i < level->vertex_count ? is_vertex_x4( f, slot_x4 ) && level_of[slot_x4 / 4] == number &&
                                                        ( i == 0 || slot_x4 > level->slot_x4[i - 1] )
                                                  : slot_x4 == 4 * f->vertex_count;
        if ( fine == false )
        {
            return BAD( "level %d whose vertex %d is missing from the finer level or out of order", number + 1, i );
        }
        level_of[slot_x4 / 4] = i < level->vertex_count ? number + 1 : level_of[slot_x4 / 4];
    }
    return WISP_OK;
}

static wisp_status check_parents( const check_state* c, int number )
{
    const wisp_fabric_level* level = &c->f->levels[number];
    for ( int row = 0; row < level->finer_row_count; ++row )
    {
        float sum = 0.0f;
        for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
        {
            const int i =
                ( row / WISP_FABRIC_LANES * WISP_FABRIC_PARENTS + k ) * WISP_FABRIC_LANES + row % WISP_FABRIC_LANES;
            const int32_t parent_x4 = level->parent_x4[i];
            const float weight = level->weight[i];

            // a row that follows nothing refers to the first dummy, which does not move
            const int32_t rows = weight > 0.0f ? level->vertex_count : level->vertex_count + 1;
            if ( parent_x4 < 0 || parent_x4 % 4 != 0 || parent_x4 / 4 >= rows ||
                 !( weight >= 0.0f && weight <= 1.0f ) )
            {
                return BAD( "level %d whose parent %d is out of range", number + 1, i );
            }
            sum += weight;
        }
        if ( sum != 0.0f && !( fabsf( sum - 1.0f ) <= 1e-5f ) )
        {
            return BAD( "level %d whose row %d follows others with weights that sum to %g, expected 0 or 1",
                        number + 1, row, (double)sum );
        }
    }
    return WISP_OK;
}

static bool is_row_x4( const wisp_fabric_level* level, int32_t row_x4 )
{
    return row_x4 >= 0 && row_x4 % 4 == 0 && row_x4 / 4 < level->vertex_count;
}

static wisp_status check_level_links( const check_state* c, int number )
{
    const wisp_fabric_level* level = &c->f->levels[number];
    wisp_status status = check_schedule( c, "links of a level", &level->schedule, level->link_count );
    for ( int32_t i = 0; i < level->schedule.slot_count && status == WISP_OK; ++i )
    {
        const int32_t a = level->a_x4[i], b = level->b_x4[i];
        const float rest = level->rest[i], chain = level->chain_rest[i], fraction = level->fraction[i];
        const bool real = level->schedule.constraint[i] >= 0;
        const bool fine = real ? is_row_x4( level, a ) && is_row_x4( level, b ) && a != b && is_length( rest ) &&
                                     is_length( chain ) && fraction > 0.0f && fraction <= 1.0f
                               : rest == 0.0f && chain == 0.0f && fraction == 0.0f;
        if ( fine == false )
        {
            status = BAD( "level %d whose lane %d links vertices of another level or has no length", number + 1, i );
        }
    }
    const lane_reader lanes = {
        .arity = 2,
        .a_x4 = level->a_x4,
        .b_x4 = level->b_x4,
        .vertex_count = level->vertex_count,
        .tile_size = level->tile_size,
        .tile_count = fabric_tiles( level->vertex_count, level->tile_size ),
    };
    return status == WISP_OK ? check_conflicts( c, "links of a level", &level->schedule, &lanes ) : status;
}

static wisp_status check_chains( const check_state* c, int number )
{
    const wisp_fabric* f = c->f;
    const wisp_fabric_level* level = &f->levels[number];
    const int count = level->chain_begin[level->chain_group_count];
    if ( offsets_rise( level->chain_begin, level->chain_group_count, count, 1 ) == false )
    {
        return BAD( "level %d whose chains do not ascend", number + 1 );
    }
    for ( int e = 0; e < count; ++e )
    {
        for ( int lane = 0; lane < WISP_FABRIC_LANES; ++lane )
        {
            const int32_t slot_x4 = level->chain_x4[e][lane];
            if ( is_vertex_x4( f, slot_x4 ) == false && slot_x4 != 4 * f->vertex_count )
            {
                return BAD( "level %d with slot %d in a chain, which is out of range", number + 1, slot_x4 / 4 );
            }
        }
    }
    return WISP_OK;
}

static wisp_status check_levels( const check_state* c )
{
    const wisp_fabric* f = c->f;
    int32_t* level_of = fabric_pool_push_zeroed( c->scratch, (size_t)f->slot_count, sizeof( int32_t ) );
    wisp_status status = level_of != NULL ? WISP_OK : SHORT_OF_MEMORY;
    for ( int i = 0; i < f->level_count && status == WISP_OK; ++i )
    {
        status = check_level_rows( c, i, level_of );
        status = status == WISP_OK ? check_parents( c, i ) : status;
        status = status == WISP_OK ? check_level_links( c, i ) : status;
        status = status == WISP_OK ? check_chains( c, i ) : status;
    }
    return status;
}

wisp_status fabric_check( const wisp_fabric* fabric, fabric_pool* scratch, wisp_error* error )
{
    // each step relies on the checks of the previous steps
    static wisp_status ( *const steps[] )( const check_state* ) = {
        check_counts, check_vertices, check_attachments, check_mesh,
        check_rings,  check_links,    check_hinges,      check_levels,
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
