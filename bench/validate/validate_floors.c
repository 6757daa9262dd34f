#include "validate_floors.h"

#include "collision/collision.h"

#include <math.h>

// How far bodies stay off their floors: less than the last cell rises from it.
static double gap_of( const validate_def* def )
{
    return 0.125 * VALIDATE_LENGTH / def->cells;
}

static wisp_status set_collision( validate_bodies* b, int body, double mu )
{
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = (float)gap_of( &b->def );
    collision.friction_scale = (float)mu;
    collision.mask = b->masks[body];
    return wisp_set_collision( b->world.world, b->world.bodies[body].entity, &collision );
}

// A plane behind x, with a friction of 1 that is scaled for each body, and a layer of its own.
static wisp_status add_floor( validate_bodies* b, double x, uint32_t layer )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_PLANE;
    def.static_friction = def.kinetic_friction = 1.0f;
    def.layers = layer;
    def.pose.translation.x = (float)( VALIDATE_LENGTH * x + gap_of( &b->def ) );
    def.pose.rotation = ( wisp_quat ){ 0.0f, 0.0f, sqrtf( 0.5f ), sqrtf( 0.5f ) }; // up is -x
    wisp_entity floor;
    return wisp_add_collider( b->world.world, &def, &floor );
}

wisp_status validate_add_floors( validate_bodies* b, wisp_error* error )
{
    const double* floors = b->def.floors;
    uint32_t layer = 1;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < b->def.count && status == WISP_OK; ++i )
    {
        const bool is_new = i == 0 || floors[i] != floors[i - 1];
        layer = is_new && i > 0 ? layer << 1 : layer;
        b->masks[i] = layer;
        status = is_new ? add_floor( b, floors[i], layer ) : WISP_OK;
        status = status == WISP_OK ? set_collision( b, i, b->def.friction ) : status;
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

wisp_status validate_set_friction( validate_bodies* b, const double* mu, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < b->def.count && status == WISP_OK; ++i )
    {
        status = set_collision( b, i, mu[i] );
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}
