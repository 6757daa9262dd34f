// Checks of the schedules of a loaded fabric: order, lanes, conflicts.
#include "fabric_check.h"

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

bool fabric_offsets_rise( const int32_t* begin, int count, int end, int step )
{
    bool fine = begin[0] == 0 && begin[count] == end;
    for ( int i = 0; i < count && fine; ++i )
    {
        fine = begin[i + 1] > begin[i] && begin[i + 1] <= end && begin[i + 1] % step == 0;
    }
    return fine;
}

wisp_status fabric_check_schedule( const check_state* c, const char* what, const wisp_schedule* s, int count )
{
    if ( fabric_offsets_rise( s->colour_tile, s->colour_count, s->tile_count, 1 ) == false ||
         fabric_offsets_rise( s->tile_begin, s->tile_count, s->slot_count, WISP_FABRIC_LANES ) == false )
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

wisp_status fabric_check_conflicts( const check_state* c, const char* what, const wisp_schedule* s,
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
        bool fine = fabric_is_length( f->link_rest[i] ) && ( number >= 0 || f->link_rest[i] == 0.0f );
        if ( number >= f->edge_count )
        {
            fine = fine && fabric_is_vertex_x4( f, a ) && fabric_is_vertex_x4( f, b ) && a != b;
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

wisp_status fabric_check_links( const check_state* c )
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
    wisp_status status = fabric_check_schedule( c, "links", &f->link_order, f->link_count );
    status = status == WISP_OK ? check_link_lanes( c ) : status;
    return status == WISP_OK ? fabric_check_conflicts( c, "links", &f->link_order, &lanes ) : status;
}

wisp_status fabric_check_hinges( const check_state* c )
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
    wisp_status status = fabric_check_schedule( c, "hinges", &f->hinge_order, count );
    status = status == WISP_OK ? check_hinge_lanes( c, &lanes ) : status;
    return status == WISP_OK ? fabric_check_conflicts( c, "hinges", &f->hinge_order, &lanes ) : status;
}
