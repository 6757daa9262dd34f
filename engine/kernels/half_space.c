// Contact of particles with half spaces, with Coulomb friction, eight particles
// at a time. With q a point of the surface and n its normal away from the body:
//
//   N <- max( 0, N + gap - n (p - q) )
//   u = tangential part of (p - previous) - motion, without the friction
//   applied so far T <- -u if |u| <= mu_s N, else -mu_k N u / |u|
//
// N and T are the accumulated normal and tangential corrections. They are
// clamped in place, so another call with the same rows is another sweep of
// projected Gauss-Seidel. A row is 64 bytes, one cache line, and is loaded into
// lanes by four transpositions.
//
// Half spaces come from the planes in which particles meet a body. With h the
// thickness, `start` the signed distance less h at the start of the substep and
// `now` the distance at its end, a particle that starts too near is moved out
// by the recovered depth, together with its previous position, so that the
// correction gives no velocity. While it is deep, its own outward motion gives
// none either.
//
// Of shapes in closed form they are found where they are projected, and stored
// nowhere (stay_outside). Everything is computed along the axes of the world,
// relative to the shape: a particle goes from f, as seen from where the shape
// was, to e. The shape is convex, so a path crosses it only if its start is not
// in front of the plane at the closest point to its end.
#include "pose.h"
#include "shape_lanes.h"

typedef struct half_space
{
    lane8v point, normal, motion, tangential_correction;
    lane8 gap, normal_correction, static_friction, kinetic_friction;
} half_space;

static half_space load_rows( const float* rows, const int32_t* row16 )
{
    half_space h;
    lane8_load_xyzw( rows, row16, &h.point.x, &h.point.y, &h.point.z, &h.normal.x );
    lane8_load_xyzw( rows + 4, row16, &h.normal.y, &h.normal.z, &h.motion.x, &h.motion.y );
    lane8_load_xyzw( rows + 8, row16, &h.motion.z, &h.gap, &h.normal_correction, &h.tangential_correction.x );
    lane8_load_xyzw( rows + 12, row16, &h.tangential_correction.y, &h.tangential_correction.z, &h.static_friction,
                     &h.kinetic_friction );
    return h;
}

static void store_rows( float* rows, const int32_t* row16, const half_space* h )
{
    lane8_store_xyzw( rows + 8, row16, h->motion.z, h->gap, h->normal_correction, h->tangential_correction.x );
    lane8_store_xyzw( rows + 12, row16, h->tangential_correction.y, h->tangential_correction.z, h->static_friction,
                      h->kinetic_friction );
}

// Computes the new tangential correction.
// @return the value that replaces h->tangential_correction
LANE_INLINE lane8v find_friction( const half_space* h, lane8v p, lane8v previous )
{
    lane8v u = lane8v_sub( lane8v_sub( p, previous ), h->motion );
    u = lane8v_mul_add( u, lane8_neg( lane8v_dot( h->normal, u ) ), h->normal );
    u = lane8v_sub( u, h->tangential_correction );
    lane8 length = lane8v_length( u );
    lane8m sticks = lane8_le( length, lane8_mul( h->static_friction, h->normal_correction ) );
    lane8 slides = lane8_div( lane8_mul( h->kinetic_friction, h->normal_correction ), length );
    return lane8v_scale( u, lane8_neg( lane8_select( sticks, lane8_set1( 1.0f ), slides ) ) );
}

// Pushes particles out and rubs them, in one sweep of projected Gauss-Seidel.
LANE_INLINE lane8v project( half_space* h, lane8v p, lane8v previous )
{
    lane8 violation = lane8_sub( h->gap, lane8v_dot( h->normal, lane8v_sub( p, h->point ) ) );
    lane8 normal_correction = lane8_max( lane8_add( h->normal_correction, violation ), lane8_zero() );
    p = lane8v_mul_add( p, lane8_sub( normal_correction, h->normal_correction ), h->normal );
    h->normal_correction = normal_correction;

    const lane8v tangential_correction = find_friction( h, p, previous );
    p = lane8v_add( p, lane8v_sub( tangential_correction, h->tangential_correction ) );
    h->tangential_correction = tangential_correction;
    return p;
}

void KERNEL( half_space )( const wisp_half_space_args* args, int begin, int end )
{
    for ( int k = begin; k < end; k += LANES )
    {
        half_space h = load_rows( args->rows, args->row_x16 + k );
        lane8v p, previous;
        lane8 inverse_mass;
        lane8_load_xyzw( args->position, args->particle_x4 + k, &p.x, &p.y, &p.z, &inverse_mass );
        lane8_load_xyz( args->previous, args->particle_x4 + k, &previous.x, &previous.y, &previous.z );
        p = project( &h, p, previous );
        lane8_store_xyzw( args->position, args->particle_x4 + k, p.x, p.y, p.z, inverse_mass );
        store_rows( args->rows, args->row_x16 + k, &h );
    }
}

// ---- half spaces of planes ----

// Displacement of a particle and the gap that it must keep.
typedef struct push_out
{
    lane8 recovered; // m, of position and previous position
    lane8 absorbed;  // m, outward displacement that shall give no velocity
    lane8 gap;       // m
} push_out;

LANE_INLINE push_out find_push_out( lane8 h, lane8 shallow, lane8 recovery, lane8 now, lane8 start )
{
    const lane8 zero = lane8_zero();
    const lane8 outward = lane8_max( lane8_sub( lane8_sub( now, h ), start ), zero );
    const lane8 depth = lane8_sub( lane8_neg( start ), outward );
    const lane8 most = lane8_max( lane8_sub( recovery, outward ), zero );
    push_out out;
    out.recovered = lane8_select( lane8_lt( lane8_add( start, outward ), zero ), lane8_min( depth, most ), zero );
    out.absorbed = lane8_select( lane8_lt( start, lane8_neg( shallow ) ), outward, zero );
    out.gap = lane8_select( lane8_lt( start, zero ), lane8_add( lane8_add( h, start ), out.recovered ), h );
    return out;
}

// Stores positions where one differs: adding zero changes the sign of a
// negative zero.
LANE_INLINE bool move_out( const wisp_half_space_rows_args* args, int at, lane8v normal, const push_out* out )
{
    lane8v p, previous;
    lane8 mass, none;
    lane8_load_xyzw( args->position, args->particle_x4 + at, &p.x, &p.y, &p.z, &mass );
    lane8_load_xyzw( args->previous, args->particle_x4 + at, &previous.x, &previous.y, &previous.z, &none );
    const lane8v moved = lane8v_mul_add( p, out->recovered, normal );
    const lane8v from = lane8v_mul_add( previous, lane8_add( out->recovered, out->absorbed ), normal );
    const lane8 each[6][2] = { { p.x, moved.x },       { p.y, moved.y },       { p.z, moved.z },
                               { previous.x, from.x }, { previous.y, from.y }, { previous.z, from.z } };
    lane8i changed = lane8i_set1( 0 );
    for ( int k = 0; k < 6; ++k )
    {
        changed = lane8i_or( changed, lane8i_xor( lane8_cast_int( each[k][0] ), lane8_cast_int( each[k][1] ) ) );
    }
    if ( lane8m_all( lane8i_eq( changed, lane8i_set1( 0 ) ) ) )
    {
        return false;
    }
    lane8_store_xyzw( args->position, args->particle_x4 + at, moved.x, moved.y, moved.z, mass );
    lane8_store_xyzw( args->previous, args->particle_x4 + at, from.x, from.y, from.z, none );
    return true;
}

bool KERNEL( half_space_rows )( const wisp_half_space_rows_args* args, int count )
{
    const wisp_half_space_rows_args mine = *args;
    const lane8 zero = lane8_zero(), thickness = lane8_set1( mine.thickness ), shallow = lane8_set1( mine.shallow ),
                recovery = lane8_set1( mine.recovery );
    const bool is_still = memcmp( &mine.before, &mine.after, sizeof( wisp_transform ) ) == 0;
    const bool was_turned = pose_is_turned( mine.before.rotation ), is_turned = pose_is_turned( mine.after.rotation );
    bool any_moved = false;
    for ( int i = 0; i < count; i += LANES )
    {
        const lane8v local = load_three( mine.point, i );
        const lane8v normal = pose_rotate_if( is_turned, mine.after.rotation, load_three( mine.normal, i ) );
        const lane8v point = pose_to_world( mine.after, is_turned, local );
        const lane8v was = is_still ? point : pose_to_world( mine.before, was_turned, local );
        const lane8v motion = lane8v_sub( point, was );
        const push_out out =
            find_push_out( thickness, shallow, recovery, lane8_loadu( mine.now + i ), lane8_loadu( mine.start + i ) );
        any_moved = move_out( &mine, i, normal, &out ) || any_moved;

        const int32_t* row = mine.row_x16 + i;
        lane8_store_xyzw( mine.rows, row, point.x, point.y, point.z, normal.x );
        lane8_store_xyzw( mine.rows + 4, row, normal.y, normal.z, motion.x, motion.y );
        lane8_store_xyzw( mine.rows + 8, row, motion.z, out.gap, zero, zero );
        lane8_store_xyzw( mine.rows + 12, row, zero, zero, lane8_set1( mine.static_friction ),
                          lane8_set1( mine.kinetic_friction ) );
    }
    return any_moved;
}

// ---- shapes in closed form ----

// Half spaces of eight particles, one a shape.
typedef struct near_shapes
{
    int count;
    half_space space[WISP_OUTSIDE_SHAPES];
    lane8m near[WISP_OUTSIDE_SHAPES];
    lane8 thickness[WISP_OUTSIDE_SHAPES];
    lane8 number;       // of half spaces
    lane8m moves, hard; // have inverse mass; cannot be done here
    lane8m recovered;   // previous positions have changed
    lane8v p, previous;
    lane8 path; // m
} near_shapes;

// Moves out who starts too near, and adds the half space that particles have to
// stay in.
LANE_INLINE void add_space( const wisp_shape_lanes* s, bool alike, near_shapes* all, lane8m near, lane8v surface,
                            nearest8 found, lane8 start )
{
    const lane8 h = load_row( s->thickness, alike );
    const push_out out =
        find_push_out( h, load_row( s->shallow, alike ), load_row( s->recovery, alike ), found.distance, start );
    const lane8 back = lane8_add( out.recovered, out.absorbed );
    const lane8m moved = lane8m_and( near, lane8_gt( back, lane8_zero() ) );
    if ( lane8m_any( moved ) )
    {
        all->p = lane8v_select( moved, lane8v_mul_add( all->p, out.recovered, found.normal ), all->p );
        all->previous = lane8v_select( moved, lane8v_mul_add( all->previous, back, found.normal ), all->previous );
        all->recovered = lane8m_or( all->recovered, moved );
        all->path = lane8v_length( lane8v_sub( all->p, all->previous ) );
    }
    const lane8v at = load_vector( s->at, alike ), was = load_vector( s->was, alike ),
                 none = lane8v_set1( ( wisp_vec3 ){ 0 } );
    lane8v motion = lane8v_sub( at, was );
    motion = s->turns ? lane8v_add( motion, lane8v_sub( surface, turn_back( s, surface, alike ) ) ) : motion;
    const int i = all->count++;
    all->space[i] = ( half_space ){ .point = lane8v_add( at, surface ),
                                    .normal = found.normal,
                                    .motion = motion,
                                    .tangential_correction = none,
                                    .gap = out.gap,
                                    .normal_correction = lane8_zero(),
                                    .static_friction = load_row( s->static_friction, alike ),
                                    .kinetic_friction = load_row( s->kinetic_friction, alike ) };
    all->near[i] = near;
    all->thickness[i] = h;
    all->number = lane8_add( all->number, lane8_select( near, lane8_set1( 1.0f ), lane8_zero() ) );
}

LANE_INLINE void meet( const wisp_shape_lanes* s, wisp_shape_kind kind, bool alike, near_shapes* all )
{
    const lane8 h = load_row( s->thickness, alike ), zero = lane8_zero();
    const lane8v e = lane8v_sub( all->p, load_vector( s->at, alike ) );
    const lane8m is_there = lane8m_and( all->moves, lane8_ge( h, zero ) );
    if ( kind != WISP_SHAPE_PLANE )
    {
        // most groups are beyond twice the thickness and the longest path of the test below
        const lane8 longest =
            lane8_mul( load_row( s->farther, alike ), lane8_add( all->path, load_row( s->shift, alike ) ) );
        const lane8m far = is_beyond( s, kind, alike, e, lane8_max( lane8_add( h, h ), longest ) );
        if ( lane8m_any( lane8m_and_not( is_there, far ) ) == false )
        {
            return;
        }
    }
    const nearest8 found = nearest_to( s, kind, alike, e );
    const lane8m near = lane8m_and( is_there, lane8_le( found.distance, lane8_add( h, h ) ) );
    // a bound of the path, seen from the shape
    const lane8 turned = lane8_mul( load_row( s->rate, alike ), lane8_add( all->path, lane8_abs( found.distance ) ) );
    const lane8 reach =
        lane8_mul_add( all->path, lane8_set1( 1.001f ), lane8_add( load_row( s->shift, alike ), turned ) );
    const lane8m may_cross = lane8m_and( is_there, lane8_le( found.distance, reach ) );
    if ( lane8m_any( lane8m_or( near, may_cross ) ) == false )
    {
        return;
    }
    const lane8v back = lane8v_sub( all->previous, load_vector( s->was, alike ) ),
                 f = s->turns ? turn( s, back, alike ) : back;
    const lane8m crosses = lane8m_and( may_cross, lane8_le( found.distance, lane8v_length( lane8v_sub( e, f ) ) ) );
    const lane8m either = lane8m_or( near, crosses );
    if ( lane8m_any( either ) == false )
    {
        return;
    }
    const lane8v surface = lane8v_mul_add( e, lane8_neg( found.distance ), found.normal );
    const lane8 height = lane8v_dot( found.normal, lane8v_sub( f, surface ) );
    lane8 start = lane8_sub( height, h );
    if ( kind != WISP_SHAPE_PLANE )
    {
        const lane8m in_front = lane8m_and( lane8_gt( found.distance, zero ), lane8_gt( height, zero ) );
        all->hard = lane8m_or( all->hard, lane8m_and_not( either, in_front ) );
        // the surface is curved between start and end
        const lane8m deep = lane8m_and( near, lane8_lt( start, lane8_neg( load_row( s->shallow, alike ) ) ) );
        if ( lane8m_any( deep ) )
        {
            const lane8 exact = lane8_sub( nearest_to( s, kind, alike, f ).distance, h );
            start = lane8_select( deep, lane8_max( start, exact ), start );
        }
    }
    if ( lane8m_any( near ) )
    {
        add_space( s, alike, all, near, surface, found, start );
    }
}

// Marks particles that two shapes squeeze.
static void find_squeezed( near_shapes* all )
{
    for ( int j = 1; j < all->count; ++j )
    {
        for ( int i = 0; i < j; ++i )
        {
            const half_space *a = all->space + i, *b = all->space + j;
            const lane8 both = lane8_add( all->thickness[i], all->thickness[j] );
            const lane8 apart = lane8_add( lane8v_dot( a->normal, lane8v_sub( all->p, a->point ) ),
                                           lane8v_dot( b->normal, lane8v_sub( all->p, b->point ) ) );
            const lane8m opposed = lane8_lt( lane8v_dot( a->normal, b->normal ), lane8_zero() );
            const lane8m pressed =
                lane8m_and( opposed, lane8m_and( lane8_lt( apart, both ), lane8_ge( apart, lane8_neg( both ) ) ) );
            all->hard = lane8m_or( all->hard, lane8m_and( pressed, lane8m_and( all->near[i], all->near[j] ) ) );
        }
    }
}

// Sweeps over several half spaces of a particle: pushing out of one may push
// into another.
static void resolve( near_shapes* all )
{
    if ( all->count == 1 )
    {
        all->p = lane8v_select( all->near[0], project( all->space, all->p, all->previous ), all->p );
        return;
    }
    const lane8m several = lane8_gt( all->number, lane8_set1( 1.0f ) );
    const bool any = lane8m_any( several );
    if ( any )
    {
        find_squeezed( all );
    }
    for ( int sweep = 0; sweep < ( any ? WISP_OUTSIDE_SWEEPS : 1 ); ++sweep )
    {
        for ( int i = 0; i < all->count; ++i )
        {
            const lane8m moves = sweep == 0 ? all->near[i] : lane8m_and( all->near[i], several );
            all->p = lane8v_select( moves, project( all->space + i, all->p, all->previous ), all->p );
        }
    }
}

// @return whether there is a shape near
LANE_INLINE bool keep_outside( const wisp_shape_lanes* shapes, int count, int stride, bool alike, near_shapes* all )
{
    const lane8m none = lane8_lt( lane8_zero(), lane8_zero() );
    all->count = 0;
    all->number = lane8_zero();
    all->path = lane8v_length( lane8v_sub( all->p, all->previous ) );
    all->hard = all->recovered = none;
    for ( int i = 0; i < count; ++i )
    {
        const wisp_shape_lanes* s = shapes + (size_t)i * (size_t)stride;
        switch ( s->kind )
        {
            case WISP_SHAPE_SPHERE:
                meet( s, WISP_SHAPE_SPHERE, alike, all );
                break;
            case WISP_SHAPE_CAPSULE:
                meet( s, WISP_SHAPE_CAPSULE, alike, all );
                break;
            case WISP_SHAPE_BOX:
                meet( s, WISP_SHAPE_BOX, alike, all );
                break;
            case WISP_SHAPE_TAPERED_CAPSULE:
                meet( s, WISP_SHAPE_TAPERED_CAPSULE, alike, all );
                break;
            default:
                meet( s, WISP_SHAPE_PLANE, alike, all );
                break;
        }
    }
    if ( all->count > 0 )
    {
        resolve( all );
    }
    return all->count > 0;
}

uint32_t KERNEL( stay_outside )( const wisp_outside_args* args, int begin, int end )
{
    uint32_t hard = 0;
    for ( int slot = begin; slot < end; slot += LANES )
    {
        float *position = args->position + (size_t)slot * 4, *previous = args->previous + (size_t)slot * 4;
        near_shapes all;
        lane8 mass, none;
        lane8_load_xyzw_contiguous( position, &all.p.x, &all.p.y, &all.p.z, &mass );
        lane8_load_xyzw_contiguous( previous, &all.previous.x, &all.previous.y, &all.previous.z, &none );
        all.moves = lane8_gt( mass, lane8_zero() );
        const bool met = keep_outside( args->shapes, args->count, 1, true, &all );
        if ( lane8m_any( all.hard ) )
        {
            hard |= 1u << ( slot - begin ) / LANES;
            continue;
        }
        if ( met )
        {
            lane8_store_xyzw_contiguous( position, all.p.x, all.p.y, all.p.z, mass );
        }
        if ( lane8m_any( all.recovered ) )
        {
            lane8_store_xyzw_contiguous( previous, all.previous.x, all.previous.y, all.previous.z, none );
        }
    }
    return hard;
}

uint32_t KERNEL( instances_stay_outside )( const wisp_instances_args* args, const wisp_shape_lanes* shapes,
                                           int count )
{
    uint32_t hard = 0;
    for ( int slot = 0; slot < args->slot_count; ++slot )
    {
        for ( int half = 0; half < 2; ++half )
        {
            float *p = args->position + (size_t)slot * 4 * WISP_INSTANCE_LANES + half * LANES,
                  *previous = args->previous + (size_t)slot * 3 * WISP_INSTANCE_LANES + half * LANES;
            near_shapes all;
            all.p = ( lane8v ){ lane8_load( p ), lane8_load( p + WISP_INSTANCE_LANES ),
                                lane8_load( p + 2 * WISP_INSTANCE_LANES ) };
            all.previous = ( lane8v ){ lane8_load( previous ), lane8_load( previous + WISP_INSTANCE_LANES ),
                                       lane8_load( previous + 2 * WISP_INSTANCE_LANES ) };
            all.moves = lane8_gt( lane8_load( p + 3 * WISP_INSTANCE_LANES ), lane8_zero() );
            if ( keep_outside( shapes + half, count, 2, false, &all ) )
            {
                lane8_store( p, all.p.x );
                lane8_store( p + WISP_INSTANCE_LANES, all.p.y );
                lane8_store( p + 2 * WISP_INSTANCE_LANES, all.p.z );
                lane8_store( previous, all.previous.x );
                lane8_store( previous + WISP_INSTANCE_LANES, all.previous.y );
                lane8_store( previous + 2 * WISP_INSTANCE_LANES, all.previous.z );
            }
            hard |= lane8m_bits( all.hard ) << half * LANES;
        }
    }
    return hard;
}
