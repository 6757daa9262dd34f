// Checks of the coarse sheets of a loaded fabric.
#include "fabric_check.h"

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
        const bool fine = i < level->vertex_count
                              ? fabric_is_vertex_x4( f, slot_x4 ) && level_of[slot_x4 / 4] == number &&
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
    wisp_status status = fabric_check_schedule( c, "links of a level", &level->schedule, level->link_count );
    for ( int32_t i = 0; i < level->schedule.slot_count && status == WISP_OK; ++i )
    {
        const int32_t a = level->a_x4[i], b = level->b_x4[i];
        const float rest = level->rest[i], chain = level->chain_rest[i], fraction = level->fraction[i];
        const bool real = level->schedule.constraint[i] >= 0;
        const bool fine = real ? is_row_x4( level, a ) && is_row_x4( level, b ) && a != b &&
                                     fabric_is_length( rest ) && fabric_is_length( chain ) && fraction > 0.0f &&
                                     fraction <= 1.0f
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
    return status == WISP_OK ? fabric_check_conflicts( c, "links of a level", &level->schedule, &lanes ) : status;
}

static wisp_status check_chains( const check_state* c, int number )
{
    const wisp_fabric* f = c->f;
    const wisp_fabric_level* level = &f->levels[number];
    const int count = level->chain_begin[level->chain_group_count];
    if ( fabric_offsets_rise( level->chain_begin, level->chain_group_count, count, 1 ) == false )
    {
        return BAD( "level %d whose chains do not ascend", number + 1 );
    }
    for ( int e = 0; e < count; ++e )
    {
        for ( int lane = 0; lane < WISP_FABRIC_LANES; ++lane )
        {
            const int32_t slot_x4 = level->chain_x4[e][lane];
            if ( fabric_is_vertex_x4( f, slot_x4 ) == false && slot_x4 != 4 * f->vertex_count )
            {
                return BAD( "level %d with slot %d in a chain, which is out of range", number + 1, slot_x4 / 4 );
            }
        }
    }
    return WISP_OK;
}

wisp_status fabric_check_levels( const check_state* c )
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
