// Teleports: an entity is moved at once, as a rigid body, so that nothing on the way is met and no velocity comes of it. And
// the pose in which an instance starts.
// In: a rigid motion. Out: positions, velocities and targets of pins, and what views show of them.
#include "world.h"

#include "plan.h"
#include "wisp/module/vec.h"
#include "wisp/module/components.h"

#include <math.h>

static const float FARTHEST = 1e6f; // m from the origin

wisp_transform wisp_teleport_pose( const wisp_teleport_motion* teleport, wisp_transform pose )
{
    return wisp_transform_make( wisp_quat_multiply( teleport->motion.rotation, pose.rotation ),
                                wisp_transform_to_world( teleport->motion, pose.translation ) );
}

// Where the coordinates of a row are: one after another, or a lane of sixteen vectors.
typedef struct row_shape
{
    size_t row, coordinate; // floats from row to row, and from x to y
} row_shape;

static const row_shape XYZW = { 4, 1 }, XYZ = { 3, 1 };

static wisp_vec3 get( const float* p, row_shape shape )
{
    return ( wisp_vec3 ){ p[0], p[shape.coordinate], p[2 * shape.coordinate] };
}

static void put( float* p, row_shape shape, wisp_vec3 v )
{
    p[0] = v.x;
    p[shape.coordinate] = v.y;
    p[2 * shape.coordinate] = v.z;
}

static void move_points( float* rows, row_shape shape, int count, wisp_transform motion )
{
    for ( int i = 0; i < count && rows != NULL; ++i )
    {
        float* p = rows + (size_t)i * shape.row;
        put( p, shape, wisp_transform_to_world( motion, get( p, shape ) ) );
    }
}

static void turn_velocities( float* rows, row_shape shape, int count, const wisp_teleport_motion* teleport )
{
    for ( int i = 0; i < count && rows != NULL; ++i )
    {
        float* p = rows + (size_t)i * shape.row;
        const wisp_vec3 v = wisp_quat_rotate( teleport->motion.rotation, get( p, shape ) );
        put( p, shape, teleport->keep_velocity ? v : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    }
}

void wisp_teleport_lanes( const wisp_teleport_motion* teleport, float* points, float* velocities, int row_count )
{
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        const row_shape shape = { (size_t)3 * WISP_LANES, WISP_LANES };
        move_points( points != NULL ? points + lane : NULL, shape, row_count, teleport->motion );
        turn_velocities( velocities != NULL ? velocities + lane : NULL, shape, row_count, teleport );
    }
}

void wisp_teleport_rows( const wisp_teleport_motion* teleport, float* points, float* velocities, int row_count,
                         int row_floats )
{
    const row_shape shape = { (size_t)row_floats, 1 };
    move_points( points, shape, row_count, teleport->motion );
    turn_velocities( velocities, shape, row_count, teleport );
}

// ---- columns that all effects share ----

static void move_poses( char* rows, int count, size_t bytes, wisp_transform motion )
{
    const wisp_teleport_motion teleport = { .motion = motion };
    for ( int i = 0; i < 3 * count; ++i )
    {
        wisp_transform* pose = (wisp_transform*)(void*)( rows + (size_t)( i / 3 ) * bytes ) + i % 3;
        *pose = wisp_teleport_pose( &teleport, *pose );
    }
}

// Move the places of a column: some rows of vectors side by side, or poses.
static void move_column( float* rows, int count, size_t bytes, wisp_place_shape shape, wisp_transform motion )
{
    const int side = shape == WISP_PLACE_LANES ? WISP_LANES : shape == WISP_PLACE_EIGHTS ? 8 : 1;
    const int vectors = shape == WISP_PLACE_LANES ? (int)( bytes / ( 3 * WISP_LANES * sizeof( float ) ) ) : 1;
    const int floats = shape == WISP_PLACE_EIGHTS ? 3 * 8 : (int)( bytes / sizeof( float ) );
    for ( int i = 0; i < vectors * side && shape != WISP_PLACE_POSES; ++i )
    {
        move_points( rows + i / side * 3 * side + i % side, ( row_shape ){ (size_t)floats, (size_t)side },
                     shape == WISP_PLACE_EIGHTS ? count / 8 : count, motion );
    }
    if ( shape == WISP_PLACE_POSES )
    {
        move_poses( (char*)rows, count, bytes, motion );
    }
}

void world_move_place( wisp_world* world, store_entity* e, const plan_place_column* place, wisp_transform motion )
{
    const wisp_component_def* def = &world->store.components[place->component].def;
    float* rows = store_column( &world->store, e, place->component, place->column );
    if ( rows != NULL )
    {
        move_column( rows, e->rows[def->table].count, def->columns[place->column].row_size, place->shape, motion );
        store_touch( &world->store, e, place->component );
    }
}

static wisp_vec3 turned( wisp_quat q, wisp_vec3 v )
{
    return q.x == 0.0f && q.y == 0.0f && q.z == 0.0f ? v : wisp_quat_rotate( q, v );
}

// Views show the new place at once, and are not interpolated across the jump. @param before the offset of the rows
static void move_views( wisp_world* world, const store_entity* e, const wisp_teleport_motion* teleport,
                        wisp_vec3 before )
{
    wisp_transform motion = teleport->motion;
    motion.translation =
        wisp_v3_add( motion.translation, wisp_v3_sub( turned( motion.rotation, before ), e->offset ) );
    static const wisp_component POINTS[] = { WISP_SURFACE_POINTS, WISP_STRAND_POINTS };
    const int count = e->rows[WISP_TABLE_POINT].count;
    for ( int k = 0; k < WISP_COUNT( POINTS ); ++k )
    {
        move_points( store_column( &world->store, e, POINTS[k], 0 ), XYZ, count, motion );
        move_points( world_kept_rows( world, e, POINTS[k] ), XYZ, count, motion );
    }
    const wisp_teleport_motion turn = { .motion = motion, .keep_velocity = true };
    turn_velocities( store_column( &world->store, e, WISP_SURFACE_NORMALS, 0 ), XYZ, count, &turn );
}

void wisp_world_move_columns( wisp_world* world, wisp_entity entity, const wisp_teleport_motion* teleport )
{
    store_entity* e = store_find( &world->store, entity );
    const wisp_vec3 before = e->offset;
    e->offset = wisp_v3_sub( before, teleport->far );
    for ( int i = 0; i < world->registry.place_count; ++i )
    {
        world_move_place( world, e, world->registry.places + i, teleport->motion );
    }
    if ( e->fabric != NULL )
    {
        wisp_teleport_rows( teleport, NULL, wisp_world_column( world, entity, WISP_PARTICLE_VELOCITY, 0 ),
                            e->fabric->slot_count, 4 );
        wisp_world_restart_levels( world, entity );
    }
    else if ( e->strands != NULL )
    {
        wisp_teleport_lanes( teleport, NULL, wisp_world_column( world, entity, WISP_STRAND_VELOCITY, 0 ),
                             e->strands->row_count );
    }
    move_views( world, e, teleport, before );
}

// ---- the calls ----

// @param what the message begins with
static wisp_status check_motion( wisp_world* world, wisp_transform motion, const char* what )
{
    const wisp_vec3 p = motion.translation;
    const wisp_quat q = motion.rotation;
    const float squared = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if ( !( squared >= 1e-12f && squared <= 1e12f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "%s: the quaternion (%g, %g, %g, %g) is not a rotation", what,
                                (double)q.x, (double)q.y, (double)q.z, (double)q.w );
    }
    if ( !( fabsf( p.x ) <= FARTHEST && fabsf( p.y ) <= FARTHEST && fabsf( p.z ) <= FARTHEST ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "%s: got (%g, %g, %g), expected at most 1e6 m", what,
                                (double)p.x, (double)p.y, (double)p.z );
    }
    return WISP_OK;
}

static wisp_status check_places( wisp_world* world, const float* rows, row_shape shape, int count,
                                 wisp_transform motion, const char* what )
{
    for ( int i = 0; i < count && rows != NULL; ++i )
    {
        const wisp_vec3 p = wisp_transform_to_world( motion, get( rows + (size_t)i * shape.row, shape ) );
        if ( !( fabsf( p.x ) <= FARTHEST && fabsf( p.y ) <= FARTHEST && fabsf( p.z ) <= FARTHEST ) )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "%s: a vertex would be at (%g, %g, %g), farther than 1e6 m from the origin", what,
                                    (double)p.x, (double)p.y, (double)p.z );
        }
    }
    return WISP_OK;
}

// @param lanes [row][3][16] of strands; null: there are none
static wisp_status check_lanes( wisp_world* world, const float* lanes, int row_count, wisp_transform motion,
                                const char* what )
{
    for ( int lane = 0; lane < WISP_LANES && lanes != NULL; ++lane )
    {
        WISP_TRY( check_places( world, lanes + lane, ( row_shape ){ (size_t)3 * WISP_LANES, WISP_LANES }, row_count,
                                motion, what ) );
    }
    return WISP_OK;
}

static wisp_status check_entity( wisp_world* world, const store_entity* e, wisp_transform motion )
{
    if ( e->fabric != NULL )
    {
        return check_places( world, store_column( &world->store, e, WISP_PARTICLE_POSITION, 0 ), XYZW,
                             e->fabric->slot_count, motion, "teleport" );
    }
    return e->strands != NULL ? check_lanes( world, store_column( &world->store, e, WISP_STRAND_POSITION, 0 ),
                                             e->strands->row_count, motion, "teleport" )
                              : WISP_OK;
}

// Strands of dimension 2 are computed in their plane.
static bool leaves_plane( const wisp_strand_topology* t, wisp_transform pose )
{
    return t->dimension == 2 && ( pose.translation.z != 0.0f || pose.rotation.x != 0.0f || pose.rotation.y != 0.0f );
}

wisp_status world_check_pose( wisp_world* world, const store_entity* source, wisp_transform pose )
{
    wisp_status status = check_motion( world, pose, "pose" );
    const wisp_transform placed = wisp_transform_make( pose.rotation, pose.translation );
    if ( status == WISP_OK && source->fabric != NULL )
    {
        return check_places( world, &source->fabric->rest[0].x, XYZ, source->fabric->slot_count, placed, "pose" );
    }
    if ( status == WISP_OK && leaves_plane( source->strands, pose ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "pose: strands of dimension 2 cannot leave the plane z = 0" );
    }
    return status == WISP_OK ? check_lanes( world, store_column( &world->store, source, WISP_STRAND_REST, 0 ),
                                            source->strands->row_count, placed, "pose" )
                             : status;
}

void world_place( wisp_world* world, wisp_entity entity, wisp_transform pose )
{
    const wisp_teleport_motion placed = { .motion = wisp_transform_make( pose.rotation, pose.translation ) };
    const wisp_strand_topology* strands = wisp_world_strands( world, entity );
    if ( strands != NULL )
    {
        wisp_teleport_lanes( &placed, wisp_world_column( world, entity, WISP_STRAND_REST, 0 ), NULL,
                             strands->row_count );
    }
    wisp_world_move_columns( world, entity, &placed );
}

// Return a motion of the host's coordinates as one from coordinates in rows to the host's.
static wisp_transform motion_to_host( const store_entity* e, wisp_transform motion )
{
    const wisp_transform pose = wisp_transform_make( motion.rotation, motion.translation );
    return ( wisp_transform ){ pose.rotation, wisp_v3_sub( pose.translation, turned( pose.rotation, e->offset ) ) };
}

static float far_of( float displacement )
{
    const float longest = 16.0f; // m, that rows go
    return fabsf( displacement ) > longest && fabsf( displacement ) <= 2.0f * FARTHEST ? rintf( displacement ) : 0.0f;
}

// Return the motion of rows. On a long way their origin goes along, so that they keep their digits.
static wisp_teleport_motion teleport_of_rows( const wisp_world* world, const store_entity* e, wisp_transform motion,
                                              bool keep_velocity )
{
    const wisp_transform to = motion_to_host( e, motion );
    wisp_teleport_motion teleport = { .motion = to, .keep_velocity = keep_velocity };
    size_t coordinate;
    const float* p = world_find_vertex( world, e, &coordinate );
    if ( p != NULL )
    {
        const wisp_vec3 at = { p[0], p[coordinate], p[2 * coordinate] };
        const wisp_vec3 displacement = wisp_v3_sub( wisp_transform_to_world( to, at ), wisp_v3_sub( at, e->offset ) );
        teleport.far = ( wisp_vec3 ){ far_of( displacement.x ), far_of( displacement.y ), far_of( displacement.z ) };
    }
    teleport.motion.translation = wisp_v3_sub( wisp_to_rows( to.translation, e->offset ), teleport.far );
    return teleport;
}

wisp_status wisp_teleport( wisp_world* world, wisp_entity entity, wisp_transform motion, bool keep_velocity )
{
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    const store_entity* e = store_find( &world->store, entity );
    wisp_status status = check_motion( world, motion, "teleport" );
    const wisp_teleport_motion teleport = teleport_of_rows( world, e, motion, keep_velocity );
    status = status == WISP_OK ? check_entity( world, e, motion_to_host( e, motion ) ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    bool is_moved = e->fabric != NULL;
    status = plan_registry_teleported( &world->registry, world, entity, &teleport, &is_moved );
    if ( status == WISP_OK && is_moved == false )
    {
        status = wisp_world_fail( world, WISP_CONFLICT,
                                  "teleport: entity %u is neither a surface nor a collider, nor strands that move",
                                  entity.index );
    }
    if ( status == WISP_OK )
    {
        wisp_world_move_columns( world, entity, &teleport );
    }
    return status;
}
