// Instances of a fabric side by side: lane l is instance l. A link is then read without shuffles and needs no
// partners that share none of its particles, so padding of the schedule costs nothing. Each lane computes what link.c
// and particle.c compute, operation by operation.
#include "kernel_isa.h"

enum
{
    LANES = WISP_INSTANCE_LANES,
    ROW = 4 * LANES,    // floats of a particle
    VECTOR = 3 * LANES, // and of its velocity
    ALL_LANES = ( 1 << LANES ) - 1,
};

// Minimum denominator as in link.c: squared length times inverse mass, m^2/kg.
#define MIN_DENOMINATOR 1e-18f

// ---- columns to lanes and back ----

uint32_t KERNEL( instances_load )( const wisp_instances_args* args )
{
    uint32_t pinned = 0;
    for ( int slot = 0; slot < args->slot_count; ++slot )
    {
        lane8 low[4], high[4];
        const float* position = args->position_column + 4 * (size_t)slot;
        lane8_load_xyzw( position, args->offset, low, low + 1, low + 2, low + 3 );
        lane8_load_xyzw( position, args->offset + 8, high, high + 1, high + 2, high + 3 );
        for ( int k = 0; k < 4; ++k )
        {
            lane16_store( args->position + (size_t)slot * ROW + k * LANES, lane16_join( low[k], high[k] ) );
        }
        if ( args->area[slot] > 0.0f )
        {
            pinned |= lane16m_bits( lane16_eq( lane16_join( low[3], high[3] ), lane16_zero() ) );
        }
        if ( args->velocity == NULL )
        {
            continue;
        }
        const float* velocity = args->velocity_column + 4 * (size_t)slot;
        lane8_load_xyz( velocity, args->offset, low, low + 1, low + 2 );
        lane8_load_xyz( velocity, args->offset + 8, high, high + 1, high + 2 );
        for ( int k = 0; k < 3; ++k )
        {
            lane16_store( args->velocity + (size_t)slot * VECTOR + k * LANES, lane16_join( low[k], high[k] ) );
        }
    }
    return pinned;
}

// Writes rows of one slot to those of eight lanes that are selected.
LANE_INLINE void store_eight( float* column, const int32_t* offset, uint32_t selected, lane8 x, lane8 y, lane8 z,
                              lane8 w )
{
    if ( selected == 0xffu )
    {
        lane8_store_xyzw( column, offset, x, y, z, w );
        return;
    }
    _Alignas( 64 ) float rows[32];
    lane8_store_xyzw_contiguous( rows, x, y, z, w );
    for ( ; selected != 0; selected &= selected - 1 )
    {
        const int lane = __builtin_ctz( selected );
        memcpy( column + offset[lane], rows + 4 * lane, 4 * sizeof( float ) );
    }
}

// Writes what only moving surfaces have.
LANE_INLINE void store_motion( const wisp_instances_args* args, int slot, int l, uint32_t selected, lane8 weight )
{
    const size_t column = 4 * (size_t)slot;
    const float *v = args->velocity + (size_t)slot * VECTOR + l, *old = args->previous + (size_t)slot * VECTOR + l;
    store_eight( args->velocity_column + column, args->offset + l, selected, lane8_load( v ), lane8_load( v + LANES ),
                 lane8_load( v + 2 * LANES ), lane8_zero() );
    store_eight( args->previous_column + column, args->offset + l, selected, lane8_load( old ),
                 lane8_load( old + LANES ), lane8_load( old + 2 * LANES ), weight );
}

void KERNEL( instances_store )( const wisp_instances_args* args, uint32_t lanes )
{
    for ( int slot = 0; slot < args->slot_count; ++slot )
    {
        for ( int l = 0; l < LANES; l += 8 )
        {
            const float* p = args->position + (size_t)slot * ROW + l;
            const uint32_t selected = lanes >> l & 0xffu;
            const lane8 weight = lane8_load( p + 3 * LANES );
            store_eight( args->position_column + 4 * (size_t)slot, args->offset + l, selected, lane8_load( p ),
                         lane8_load( p + LANES ), lane8_load( p + 2 * LANES ), weight );
            if ( args->velocity != NULL )
            {
                store_motion( args, slot, l, selected, weight );
            }
        }
    }
}

// ---- time integration ----

// Velocity at the end of a substep, as in velocity().
LANE_INLINE lane16 reached( const wisp_instances_args* args, lane16m free, lane16 position, lane16 previous,
                            lane16 velocity )
{
    const lane16 dt = lane16_set1( args->dt ), predicted = lane16_mul_add( velocity, dt, previous );
    const lane16 v = lane16_add( velocity, lane16_div( lane16_sub( position, predicted ), dt ) );
    const lane16 moving = lane16_select( free, v, lane16_zero() );
    return args->damps ? lane16_mul( moving, lane16_loadu( args->keep ) ) : moving;
}

LANE_INLINE lane16m is_finite( lane16 a )
{
    return lane16_lt( lane16_abs( a ), lane16_set1( INFINITY ) );
}

uint32_t KERNEL( instances_find_lost )( const wisp_instances_args* args )
{
    uint32_t finite = ALL_LANES;
    for ( int slot = 0; slot < args->slot_count; ++slot )
    {
        for ( int k = 0; k < VECTOR; k += LANES )
        {
            finite &= lane16m_bits( is_finite( lane16_load( args->position + (size_t)slot * ROW + k ) ) );
        }
    }
    return ~finite & ALL_LANES;
}

// Ends a substep and begins the next one, in one sweep.
LANE_INLINE uint32_t advance( const wisp_instances_args mine, const lane16 change[3], bool ends, bool begins )
{
    uint32_t finite = ALL_LANES;
    const lane16 dt = lane16_set1( mine.dt );
    for ( int slot = 0; slot < mine.slot_count; ++slot )
    {
        float *p = mine.position + (size_t)slot * ROW, *v = mine.velocity + (size_t)slot * VECTOR,
              *old = mine.previous + (size_t)slot * VECTOR;
        const lane16m free = lane16_lt( lane16_zero(), lane16_load( p + 3 * LANES ) );
        for ( int k = 0; k < VECTOR; k += LANES )
        {
            const lane16 position = lane16_load( p + k );
            lane16 velocity = lane16_load( v + k );
            if ( ends )
            {
                velocity = reached( &mine, free, position, lane16_load( old + k ), velocity );
            }
            if ( begins )
            {
                velocity = mine.accelerates
                               ? lane16_select( free, lane16_add( velocity, change[k / LANES] ), velocity )
                               : velocity;
                lane16_store( old + k, position );
                const lane16 moved = lane16_mul_add( velocity, dt, position );
                lane16_store( p + k, lane16_select( free, moved, position ) );
            }
            else
            {
                finite &= lane16m_bits( lane16m_and( is_finite( position ), is_finite( velocity ) ) );
            }
            lane16_store( v + k, velocity );
        }
    }
    return ~finite & ALL_LANES;
}

uint32_t KERNEL( instances_advance )( const wisp_instances_args* args, bool ends, bool begins )
{
    lane16 change[3];
    for ( int k = 0; k < 3; ++k )
    {
        change[k] = lane16_mul( lane16_loadu( args->acceleration + k * LANES ), lane16_set1( args->dt ) );
    }
    return ends && begins ? advance( *args, change, true, true ) : advance( *args, change, ends, begins );
}

// ---- damping towards rigid motion, as in rigid.c ----

enum
{
    PART = 256, // slots that are summed in floats
    SUMS = 16,  // numbers of wisp_rigid_sums
    EIGHTS = 8, // sums side by side of rigid.c
};

// What rigid.c has of a surface, a surface a lane.
typedef struct rigid_lanes
{
    lane16v origin, drift, turning;
    lane16 inverse_mass, fraction;
} rigid_lanes;

LANE_INLINE rigid_lanes rigid_of( const wisp_rigid_args* rigid )
{
    _Alignas( 64 ) float rows[11][LANES];
    for ( int lane = 0; lane < LANES; ++lane )
    {
        const wisp_rigid_args* r = rigid + lane;
        const float all[11] = { r->origin.x,
                                r->origin.y,
                                r->origin.z,
                                r->linear_velocity.x,
                                r->linear_velocity.y,
                                r->linear_velocity.z,
                                r->angular_velocity.x,
                                r->angular_velocity.y,
                                r->angular_velocity.z,
                                r->inverse_mass,
                                r->fraction };
        for ( int k = 0; k < 11; ++k )
        {
            rows[k][lane] = all[k];
        }
    }
    return ( rigid_lanes ){ lane16v_load( rows[0] ), lane16v_load( rows[3] ), lane16v_load( rows[6] ),
                            lane16_load( rows[9] ), lane16_load( rows[10] ) };
}

LANE_INLINE void add_to( lane16* sum, lane16 term )
{
    *sum = lane16_add( *sum, term );
}

LANE_INLINE void add_vector( lane16 sum[3], lane16v term )
{
    add_to( sum, term.x );
    add_to( sum + 1, term.y );
    add_to( sum + 2, term.z );
}

// Each eighth slot from the first one on.
LANE_INLINE void sum_slots( const wisp_instances_args* args, const rigid_lanes* rigid, int first, int end,
                            lane16 sums[SUMS] )
{
    for ( int k = 0; k < SUMS; ++k )
    {
        sums[k] = lane16_zero();
    }
    for ( int slot = first; slot < end; slot += EIGHTS )
    {
        const float* row = args->position + (size_t)slot * ROW;
        const lane16 inverse_mass = lane16_load( row + 3 * LANES ), zero = lane16_zero();
        const lane16 mass =
            lane16_select( lane16_gt( inverse_mass, zero ), lane16_div( rigid->inverse_mass, inverse_mass ), zero );
        const lane16v r = lane16v_sub( lane16v_load( row ), rigid->origin ), heavy = lane16v_scale( r, mass ),
                      u = lane16v_sub( lane16v_load( args->velocity + (size_t)slot * VECTOR ), rigid->drift );
        add_to( sums, mass );
        add_vector( sums + 1, heavy );
        add_vector( sums + 4, lane16v_scale( u, mass ) );
        add_vector( sums + 7, lane16v_cross( heavy, u ) );
        add_vector( sums + 10, ( lane16v ){ lane16_mul( heavy.x, r.x ), lane16_mul( heavy.y, r.y ),
                                            lane16_mul( heavy.z, r.z ) } );
        add_vector( sums + 13, ( lane16v ){ lane16_mul( heavy.x, r.y ), lane16_mul( heavy.x, r.z ),
                                            lane16_mul( heavy.y, r.z ) } );
    }
}

// Adds to doubles [sum][lane].
LANE_INLINE void add_doubles( double* total, const double* term )
{
    for ( int i = 0; i < SUMS * LANES; ++i )
    {
        total[i] += term[i];
    }
}

void KERNEL( instances_rigid_sums )( const wisp_instances_args* args, const wisp_rigid_args* rigid, int begin,
                                     int end, wisp_rigid_sums* sums )
{
    const rigid_lanes lanes = rigid_of( rigid );
    double total[SUMS * LANES] = { 0.0 };
    for ( int part = begin; part < end; part += PART )
    {
        double of_part[SUMS * LANES] = { 0.0 };
        const int behind = end - part < PART ? end : part + PART;
        for ( int first = part; first < part + EIGHTS; ++first )
        {
            lane16 terms[SUMS];
            sum_slots( args, &lanes, first, behind, terms );
            for ( int k = 0; k < SUMS; ++k )
            {
                float each[LANES];
                lane16_storeu( each, terms[k] );
                for ( int lane = 0; lane < LANES; ++lane )
                {
                    of_part[k * LANES + lane] += (double)each[lane];
                }
            }
        }
        add_doubles( total, of_part );
    }
    for ( int lane = 0; lane < LANES; ++lane )
    {
        double own[SUMS];
        for ( int k = 0; k < SUMS; ++k )
        {
            own[k] = total[k * LANES + lane];
        }
        memcpy( sums + lane, own, sizeof( own ) );
    }
}

void KERNEL( instances_rigid_approach )( const wisp_instances_args* args, const wisp_rigid_args* rigid )
{
    const rigid_lanes lanes = rigid_of( rigid );
    for ( int slot = 0; slot < args->slot_count; ++slot )
    {
        const float* row = args->position + (size_t)slot * ROW;
        float* velocity = args->velocity + (size_t)slot * VECTOR;
        const lane16v old = lane16v_load( velocity ), at = lane16v_sub( lane16v_load( row ), lanes.origin );
        const lane16v motion = lane16v_add( lanes.drift, lane16v_cross( lanes.turning, at ) );
        const lane16v nearer = lane16v_mul_add( old, lanes.fraction, lane16v_sub( motion, old ) );
        const lane16m free = lane16_gt( lane16_load( row + 3 * LANES ), lane16_zero() );
        lane16v_store( velocity, lane16v_select( free, nearer, old ) );
    }
}

// ---- links ----

// The dummy particle of a tile, which pads its groups, is moved once, by nothing, as in link.c: that makes 0 of -0.
LANE_INLINE uint32_t project( const wisp_instances_args mine, bool compliant, bool folds, bool are_alike )
{
    uint32_t folded = 0;
    int32_t last_dummy_x4 = -1;
    const lane16 least = lane16_set1( MIN_DENOMINATOR );
    const float scale = compliant ? mine.inverse_dt2 : 1.0f;
    const float alike[2] = { mine.alike[0] * scale, mine.alike[1] * scale };
    for ( int group = 0; group < mine.link_count / 8; ++group )
    {
        unsigned bends = mine.bends[group];
        for ( int link = 8 * group; link < 8 * group + 8; ++link, bends >>= 1 )
        {
            if ( mine.a_x4[link] == mine.b_x4[link] )
            {
                if ( mine.a_x4[link] == last_dummy_x4 )
                {
                    continue;
                }
                last_dummy_x4 = mine.a_x4[link];
            }
            float *row_a = mine.position + (size_t)mine.a_x4[link] * LANES,
                  *row_b = mine.position + (size_t)mine.b_x4[link] * LANES;
            const lane16v a = lane16v_load( row_a ), b = lane16v_load( row_b );
            const lane16 weight_a = lane16_load( row_a + 3 * LANES ), weight_b = lane16_load( row_b + 3 * LANES );
            const lane16v along = lane16v_sub( a, b );
            const lane16 squared = lane16v_dot( along, along ), length = lane16_sqrt( squared );
            const lane16 rest = lane16_set1( mine.rest[link] ), error = lane16_sub( length, rest );
            const lane16 own = lane16_set1( are_alike ? alike[bends & 1] : mine.own[link] * scale );
            const lane16 weight = lane16_add( weight_a, weight_b );
            const lane16 denominator =
                lane16_max( lane16_mul( squared, compliant ? lane16_add( weight, own ) : weight ), least );
            const lane16 fraction = compliant ? lane16_set1( 1.0f ) : own;
            const lane16 step = lane16_mul( error, lane16_mul( length, lane16_div( fraction, denominator ) ) );
            const lane16v move = lane16v_scale( along, step );
            lane16v_store( row_a, lane16v_sub( a, lane16v_scale( move, weight_a ) ) );
            lane16v_store( row_b, lane16v_add( b, lane16v_scale( move, weight_b ) ) );
            if ( folds && ( bends & 1 ) != 0 )
            {
                folded |= lane16m_bits( lane16_lt( lane16_add( length, length ), rest ) );
            }
        }
    }
    return folded;
}

uint32_t KERNEL( instances_link )( const wisp_instances_args* args, bool folds )
{
    if ( args->own != NULL )
    {
        return args->is_compliant ? project( *args, true, folds, false ) : project( *args, false, folds, false );
    }
    if ( args->is_compliant )
    {
        return folds ? project( *args, true, true, true ) : project( *args, true, false, true );
    }
    return folds ? project( *args, false, true, true ) : project( *args, false, false, true );
}
