// Origins: the place in the world that rows of an entity are relative to, so that floats keep their digits wherever it is. In: positions,
// ties and meetings between entities. Out: rows relative to a place near them, store_entity.offset.
//
// Entities that are tied, or that may touch and are near each other, are a group with one origin, in whose rows passes may calculate.
// The origin of a group moves when its middle is farther away than REACH, by whole metres: those are multiples of the last digit
// of coordinates, so rows lose nothing on the way towards 0. Near the host's origin that one stays. Groups are a function of the rows, so a
// world that is restored makes the same ones.

#include "alloc.h"
#include "world.h"

#include "wisp/module/components.h"
#include "wisp/module/vec.h"
#include "wisp/moving_frame.h"
#include <math.h>
#include <string.h>

// ---- frames ----

// Moving frames and largest speeds of surfaces and strands: the calls of the host.

static const wisp_field MOVING_FRAME_FIELDS[] = {
    WISP_NUMBER( wisp_moving_frame_def, linear_inertia, 1, 0, 1, NULL ),
    WISP_NUMBER( wisp_moving_frame_def, angular_inertia, 1, 0, 1, NULL ),
    WISP_POSE( wisp_moving_frame_def, pose ),
};
WISP_DEFINE( moving_frame_def, "moving frame", MOVING_FRAME_FIELDS )

// Check that an entity is a surface, or strands that move.
static wisp_status check_framed_entity( wisp_world* world, wisp_entity entity )
{
    store_entity* e;
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    if ( wisp_world_strands( world, entity ) != NULL &&
         wisp_world_has( world, entity, WISP_STRAND_VELOCITY ) == false )
    {
        return wisp_world_fail( world, WISP_CONFLICT,
                                "entity %u: has strands that do not move: give them dynamics first", entity.index );
    }
    return wisp_world_strands( world, entity ) != NULL ? WISP_OK : world_find_surface( world, entity, &e );
}

static wisp_status check_frame( wisp_world* world, wisp_entity entity )
{
    return wisp_world_has( world, entity, WISP_PARTICLE_EXTERNAL_SOLVER )
               ? wisp_world_fail( world, WISP_CONFLICT,
                                  "moving frame: entity %u has an external solver, which has none", entity.index )
               : WISP_OK;
}

wisp_status wisp_set_moving_frame( wisp_world* world, wisp_entity entity, const wisp_moving_frame_def* given )
{
    wisp_moving_frame_def def;
    WISP_TRY( wisp_world_begin_def( world, NULL, &wisp_moving_frame_def_fields, &def, given ) );
    WISP_TRY( check_framed_entity( world, entity ) );
    WISP_TRY( check_frame( world, entity ) );
    if ( def.linear_inertia == 1.0f && def.angular_inertia == 1.0f )
    {
        return wisp_world_detach( world, entity, WISP_PARTICLE_FRAME );
    }
    WISP_TRY( wisp_world_attach( world, entity, WISP_PARTICLE_FRAME ) );
    wisp_transform* pose = wisp_world_column( world, entity, WISP_PARTICLE_FRAME, 0 );
    float* felt = wisp_world_column( world, entity, WISP_PARTICLE_FRAME, 1 );
    pose[0] = pose[1] = pose[2] = wisp_pose_to_rows( def.pose, wisp_world_offset( world, entity ) );
    felt[0] = def.linear_inertia;
    felt[1] = def.angular_inertia;
    return WISP_OK;
}

wisp_status wisp_move_frame( wisp_world* world, wisp_entity entity, wisp_transform pose )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( check_framed_entity( world, entity ) );
    WISP_TRY( wisp_world_check_values( world, &wisp_moving_frame_def_fields, "pose", &pose, 1, NULL ) );
    wisp_transform* poses = wisp_world_column( world, entity, WISP_PARTICLE_FRAME, 0 );
    if ( poses != NULL )
    {
        poses[2] = wisp_pose_to_rows( pose, wisp_world_offset( world, entity ) );
    }
    return WISP_OK;
}

wisp_status wisp_set_max_speed( wisp_world* world, wisp_entity entity, float speed )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( check_framed_entity( world, entity ) );
    if ( !( speed > 0.0f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "max_speed: got %g m/s, expected a number above 0",
                                (double)speed );
    }
    return wisp_world_set_row( world, entity, WISP_PARTICLE_MAX_SPEED, speed < INFINITY ? &speed : NULL,
                               sizeof( speed ) );
}

// ---- origins ----

static const double HOME_REACH =
    16.0;                            // m, and a size, from the host's origin: cloth at rest is as calm there as at 0
static const double REACH = 1.0;     // m, and half a size, from any other: the digits are those at 0
static const double MEETING = 8.0;   // m, between bounds: farther than anything goes in a step
static const double OUTERMOST = 9e5; // m: beyond, rows are the host's coordinates, whose bound the state checks know
static const double LIMITLESS = 1e7; // m: bounds of what a velocity takes out of all bounds

static bool is_zero( wisp_vec3 v )
{
    return v.x == 0.0f && v.y == 0.0f && v.z == 0.0f;
}

// Move places with what does not fit their digits, dividing both anew.
static void shift_with_low( const wisp_world* world, store_entity* e, const plan_place_column* place, wisp_vec3 by )
{
    const wisp_component_def* def = &world->store.components[place->component].def;
    float* rows = store_column( &world->store, e, place->component, place->column );
    float* low = store_column( &world->store, e, place->low, place->low_column );
    const double shift[3] = { (double)by.x, (double)by.y, (double)by.z };
    const size_t floats = def->columns[place->column].row_size / sizeof( float ) * (size_t)e->rows[def->table].count;
    for ( size_t i = 0; i < floats && rows != NULL && low != NULL; ++i )
    {
        const double sum = (double)rows[i] + (double)low[i] + shift[i / WISP_LANES % 3];
        rows[i] = (float)sum;
        low[i] = (float)( sum - (double)rows[i] );
    }
    store_touch( &world->store, e, place->component );
}

static void shift( wisp_world* world, store_entity* e, wisp_vec3 by )
{
    if ( is_zero( by ) == false )
    {
        const bool sleeps_on = e->is_touched == false;
        for ( int i = 0; i < world->registry.place_count; ++i )
        {
            const plan_place_column* place = world->registry.places + i;
            if ( place->low != 0 && store_mask_has( &e->components, place->low ) )
            {
                shift_with_low( world, e, place, by );
                continue;
            }
            world_move_place( world, e, place, ( wisp_transform ){ { 0.0f, 0.0f, 0.0f, 1.0f }, by } );
        }
        e->offset = wisp_v3_add( e->offset, by );
        e->is_touched = sleeps_on == false || world_sleep_shift( world, e, by ) == false;
    }
}

// ---- groups ----

/// An entity in the search for groups.
typedef struct origin_member
{
    double lower[3], upper[3]; // m, in the world
    int32_t group;             // lowest slot
    int32_t next;              // slot of the group, -1: the last
    bool moves;                // it has bounds
} origin_member;

static bool can_move( const store_entity* e )
{
    return e->alive &&
           ( e->fabric != NULL || ( e->strands != NULL && store_mask_has( &e->components, WISP_STRAND_VELOCITY ) ) );
}

// Return how far poses take a point of an entity in the coming step: a head that jumps has its digits where it goes.
static wisp_vec3 find_displacement( const wisp_world* world, const store_entity* e, wisp_vec3 point )
{
    const int column = world->plan.entities[e - world->store.entities].pose;
    const plan_place_column* place = world->registry.places + column;
    const wisp_transform* pose =
        column >= 0 ? store_column( &world->store, e, place->component, place->column ) : NULL;
    return pose != NULL && memcmp( pose + 1, pose + 2, sizeof( *pose ) ) != 0
               ? wisp_v3_sub( wisp_transform_to_world( pose[2], wisp_transform_to_local( pose[1], point ) ), point )
               : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
}

static bool find_bounds( const wisp_world* world, const store_entity* e, origin_member* out )
{
    wisp_sleep_bounds bounds;
    if ( can_move( e ) == false || sleep_find_bounds( world, e, 0.0f, &bounds ) == false )
    {
        return false;
    }
    double origin[3];
    store_row_origin( e, origin );
    const wisp_vec3 middle = { 0.5f * bounds.lower[0] + 0.5f * bounds.upper[0],
                               0.5f * bounds.lower[1] + 0.5f * bounds.upper[1],
                               0.5f * bounds.lower[2] + 0.5f * bounds.upper[2] };
    const wisp_vec3 displacement = find_displacement( world, e, middle );
    const double displacements[3] = { (double)displacement.x, (double)displacement.y, (double)displacement.z };
    bool is_bounded = true;
    for ( int k = 0; k < 3; ++k )
    {
        out->lower[k] = origin[k] + (double)bounds.lower[k] + displacements[k];
        out->upper[k] = origin[k] + (double)bounds.upper[k] + displacements[k];
        is_bounded = is_bounded && (double)bounds.lower[k] > -LIMITLESS && (double)bounds.upper[k] < LIMITLESS;
    }
    return is_bounded;
}

static int find_root( const origin_member* members, int i )
{
    while ( members[i].group != i )
    {
        i = members[i].group;
    }
    return i;
}

// The root of a group is its lowest slot.
static void join( origin_member* members, int i, int j )
{
    const int a = find_root( members, i ), b = find_root( members, j );
    members[a > b ? a : b].group = a > b ? b : a;
}

static bool are_near( const origin_member* a, const origin_member* b )
{
    bool near = a->moves && b->moves;
    for ( int k = 0; k < 3 && near; ++k )
    {
        near = a->lower[k] - MEETING <= b->upper[k] && b->lower[k] - MEETING <= a->upper[k];
    }
    return near;
}

static void join_tied( const wisp_world* world, origin_member* members )
{
    const store_entity* e = world->store.entities;
    for ( int i = 0; i < world->store.entity_count; ++i )
    {
        for ( int j = i - 1; j >= 0 && e[i].alive && e[i].tie != 0; --j )
        {
            if ( e[j].alive && e[j].tie == e[i].tie )
            {
                join( members, i, j );
                break;
            }
        }
    }
}

static void find_groups( const wisp_world* world, origin_member* members )
{
    const store_entity* e = world->store.entities;
    const int count = world->store.entity_count;
    for ( int i = 0; i < count; ++i )
    {
        members[i].group = i;
        members[i].moves = find_bounds( world, e + i, members + i );
    }
    join_tied( world, members );
    for ( int i = 0; i < count; ++i )
    {
        for ( int j = 0; j < count && members[i].moves && e[i].meets; ++j )
        {
            if ( ( j > i || e[j].meets == false ) && are_near( members + i, members + j ) )
            {
                join( members, i, j );
            }
        }
    }
    for ( int i = 0; i < count; ++i )
    {
        members[i].group = members[members[i].group].group; // roots come first
        members[i].next = -1;
    }
    for ( int i = count - 1; i >= 0; --i )
    {
        origin_member* root = members + members[i].group;
        members[i].next = root->next;
        root->next = root == members + i ? root->next : i;
    }
}

// ---- following ----

// Find where the origin of a group goes. It stays while the middle of the group is in reach, and is that of the host beyond OUTERMOST.
// @return false if nothing of the group moves
static bool find_origin( const wisp_world* world, const origin_member* members, int group, double out[3] )
{
    double lower[3] = { INFINITY, INFINITY, INFINITY }, upper[3] = { -INFINITY, -INFINITY, -INFINITY };
    const store_entity* first = NULL;
    for ( int i = group; i >= 0; i = members[i].next )
    {
        first = first == NULL && members[i].moves ? world->store.entities + i : first;
        for ( int k = 0; k < 3 && members[i].moves; ++k )
        {
            lower[k] = fmin( lower[k], members[i].lower[k] );
            upper[k] = fmax( upper[k], members[i].upper[k] );
        }
    }
    if ( first == NULL )
    {
        return false;
    }
    store_row_origin( first, out );
    const double size = fmax( upper[0] - lower[0], fmax( upper[1] - lower[1], upper[2] - lower[2] ) );
    const double reach = is_zero( first->offset ) ? HOME_REACH + size : REACH + 0.5 * size;
    bool is_beyond = false;
    for ( int k = 0; k < 3; ++k )
    {
        const double middle = 0.5 * ( lower[k] + upper[k] ), away = middle - out[k];
        out[k] += fabs( away ) > reach ? rint( away ) : 0.0;
        is_beyond = is_beyond || fabs( middle - first->origin[k] ) > OUTERMOST;
    }
    memcpy( out, is_beyond ? first->origin : out, 3 * sizeof( *out ) );
    return true;
}

static void move_group( wisp_world* world, const origin_member* members, int group, const double to[3] )
{
    for ( int i = group; i >= 0; i = members[i].next )
    {
        store_entity* e = world->store.entities + i;
        double now[3];
        store_row_origin( e, now );
        if ( e->alive && ( members[i].moves || e->tie != 0 ) )
        {
            shift( world, e,
                   ( wisp_vec3 ){ (float)( now[0] - to[0] ), (float)( now[1] - to[1] ), (float)( now[2] - to[2] ) } );
        }
    }
}

const float* world_find_vertex( const wisp_world* world, const store_entity* e, size_t* coordinate )
{
    *coordinate = e->fabric != NULL ? 1 : WISP_LANES;
    return e->fabric != NULL || ( e->strands != NULL && e->strands->row_count > 0 )
               ? store_column( &world->store, e, e->fabric != NULL ? WISP_PARTICLE_POSITION : WISP_STRAND_POSITION,
                               0 )
               : NULL;
}

static bool is_out_of_reach( const wisp_world* world, const store_entity* e, wisp_vec3 vertex )
{
    const float reach = (float)( is_zero( e->offset ) ? HOME_REACH : REACH );
    const wisp_vec3 p = wisp_v3_add( vertex, find_displacement( world, e, vertex ) );
    return !( fabsf( p.x ) <= reach && fabsf( p.y ) <= reach && fabsf( p.z ) <= reach );
}

static bool needs_search( const wisp_world* world )
{
    const store_entity* first = NULL; // of those that may meet
    for ( int i = 0; i < world->store.entity_count; ++i )
    {
        const store_entity* e = world->store.entities + i;
        size_t coordinate;
        const float* p = can_move( e ) ? world_find_vertex( world, e, &coordinate ) : NULL;
        if ( p != NULL && is_out_of_reach( world, e, ( wisp_vec3 ){ p[0], p[coordinate], p[2 * coordinate] } ) )
        {
            return true;
        }
        if ( p != NULL && ( e->meets || e->tie != 0 ) )
        {
            first = first != NULL ? first : e;
            if ( is_zero( store_between( first, e ) ) == false )
            {
                return true;
            }
        }
    }
    return false;
}

wisp_status world_origins_begin( wisp_world* world )
{
    const int count = world->store.entity_count;
    if ( needs_search( world ) == false )
    {
        return WISP_OK;
    }
    if ( base_buffer_reserve( &world->allocator, &world->origin_members, (size_t)count * sizeof( origin_member ) ) ==
         false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for the origins of %d entities", count );
    }
    origin_member* members = world->origin_members.data;
    find_groups( world, members );
    for ( int i = 0; i < count; ++i )
    {
        double to[3];
        if ( members[i].group == i && find_origin( world, members, i, to ) )
        {
            move_group( world, members, i, to );
        }
    }
    return WISP_OK;
}

// ---- modules ----

wisp_vec3 wisp_world_offset( const wisp_world* world, wisp_entity entity )
{
    const store_entity* e = store_find( &world->store, entity );
    return e != NULL ? e->offset : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
}

wisp_vec3 wisp_world_between( const wisp_world* world, wisp_entity from, wisp_entity to )
{
    const store_entity *a = store_find( &world->store, from ), *b = store_find( &world->store, to );
    return a != NULL && b != NULL ? store_between( a, b ) : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
}

void wisp_world_tie( wisp_world* world, wisp_entity a, wisp_entity b )
{
    store_entity *to = store_find( &world->store, a ), *from = store_find( &world->store, b );
    to->tie = to->tie != 0 ? to->tie : ++world->tie_count;
    const uint32_t old = from->tie;
    for ( int i = 0; i < world->store.entity_count; ++i )
    {
        store_entity* e = world->store.entities + i;
        if ( e->alive && ( e == from || ( old != 0 && e->tie == old ) ) )
        {
            shift( world, e, store_between( e, to ) );
            e->tie = to->tie;
        }
    }
}

void wisp_world_let_meet( wisp_world* world, wisp_entity entity )
{
    store_find( &world->store, entity )->meets = true;
}

bool wisp_world_lets_meet( const wisp_world* world, wisp_entity entity )
{
    return store_find( &world->store, entity )->meets;
}

wisp_status world_declare_places( wisp_registry* registry )
{
    static const struct
    {
        wisp_component component;
        wisp_place_shape shape;
    } SHARED[] = {
        { WISP_STRAND_POSITION, WISP_PLACE_LANES },   { WISP_STRAND_PREVIOUS, WISP_PLACE_LANES },
        { WISP_STRAND_ROOT, WISP_PLACE_LANES },       { WISP_STRAND_POSED, WISP_PLACE_LANES },
        { WISP_PARTICLE_POSITION, WISP_PLACE_QUADS }, { WISP_PARTICLE_PREVIOUS, WISP_PLACE_QUADS },
        { WISP_PARTICLE_TARGET, WISP_PLACE_QUADS },   { WISP_PARTICLE_UNCARRIED, WISP_PLACE_QUADS },
        { WISP_PARTICLE_FRAME, WISP_PLACE_POSES },
    };
    for ( int i = 0; i < WISP_COUNT( SHARED ); ++i )
    {
        wisp_declare_places( registry, SHARED[i].component, 0, SHARED[i].shape );
    }
    return registry->error.status;
}

// ---- snapshots ----

size_t world_origins_size( const wisp_world* world )
{
    return (size_t)world->store.entity_count * sizeof( wisp_vec3 );
}

void world_origins_write( const wisp_world* world, void* out )
{
    for ( int i = 0; i < world->store.entity_count; ++i )
    {
        memcpy( (char*)out + (size_t)i * sizeof( wisp_vec3 ), &world->store.entities[i].offset, sizeof( wisp_vec3 ) );
    }
}

bool world_origins_check( const wisp_world* world, const void* bytes )
{
    bool is_valid = true;
    for ( size_t i = 0; i < 3 * (size_t)world->store.entity_count; ++i )
    {
        float offset;
        memcpy( &offset, (const char*)bytes + i * sizeof( offset ), sizeof( offset ) );
        is_valid = is_valid && fabsf( offset ) < 1e9f;
    }
    return is_valid;
}

void world_origins_read( wisp_world* world, const void* bytes )
{
    for ( int i = 0; i < world->store.entity_count; ++i )
    {
        memcpy( &world->store.entities[i].offset, (const char*)bytes + (size_t)i * sizeof( wisp_vec3 ),
                sizeof( wisp_vec3 ) );
    }
}

// ---- calls of the host ----

wisp_status wisp_set_origin( wisp_world* world, wisp_entity entity, const double origin[3] )
{
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    WISP_TRY( wisp_world_check_pointer( world, "origin", origin ) );
    for ( int k = 0; k < 3; ++k )
    {
        if ( !( fabs( origin[k] ) <= 1e12 ) )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT, "origin: got (%g, %g, %g), expected at most 1e12 m",
                                    origin[0], origin[1], origin[2] );
        }
    }
    store_entity* e = store_find( &world->store, entity );
    for ( int k = 0; k < 3; ++k )
    {
        e->origin[k] = origin[k] + 0.0; // -0 becomes 0
    }
    world_sleep_disturb( world ); // surroundings are others
    return WISP_OK;
}

wisp_status wisp_read_origin( wisp_world* world, wisp_entity entity, double out[3] )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    memset( out, 0, 3 * sizeof( *out ) );
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    memcpy( out, store_find( &world->store, entity )->origin, 3 * sizeof( *out ) );
    return WISP_OK;
}
