// Bodies, and vertices that touch them, as lines (wisp/lines.h). In: poses and positions at the end of the step.
#include "body_queries.h"
#include "collision_maps.h"
#include "collision_state.h"

#include "wisp/module/sleep.h"

#include <math.h>

enum
{
    SEGMENTS = 24, // of a circle
    CELLS = 10,    // of 1 m, along a side of a plane
};

static const float SLACK = 1.01f; // of a thickness: what projections leave
static const wisp_vec3 CYAN = { 0.0f, 0.8f, 1.0f }, YELLOW = { 1.0f, 1.0f, 0.0f };

// A body where the step has left it.
typedef struct body_lines
{
    wisp_line_list* list;
    const collision_body* body;
    wisp_entity entity; // in whose rows it is
    wisp_transform pose;
} body_lines;

static void add_line( const body_lines* to, wisp_vec3 a, wisp_vec3 b, wisp_vec3 colour )
{
    wisp_add_line( to->list, to->entity, wisp_transform_to_world( to->pose, a ),
                   wisp_transform_to_world( to->pose, b ), colour );
}

// ---- bodies ----

static wisp_vec3 on_circle( int i, float y, float radius )
{
    const float angle = 6.2831853f * (float)i / SEGMENTS;
    return wisp_v3( radius * cosf( angle ), y, radius * sinf( angle ) );
}

// The hull of two balls on the y axis: four meridians, and the circles where it leaves the balls.
static void add_round( const body_lines* to, float half, float bottom, float top )
{
    const bool is_ball = fabsf( bottom - top ) >= 2.0f * half; // one holds the other
    const float slope = is_ball ? 0.0f : asinf( ( bottom - top ) / ( 2.0f * half ) ), quarter = 1.5707963f;
    float last_y = 0.0f, last = 0.0f;
    for ( int i = 0; i <= SEGMENTS + 1; i += is_ball && i == SEGMENTS / 2 ? 2 : 1 )
    {
        const bool is_upper = i > SEGMENTS / 2, of_top = is_ball ? top > bottom : is_upper;
        const float fraction = (float)( is_upper ? i - SEGMENTS / 2 - 1 : i ) / ( SEGMENTS / 2 );
        const float angle =
            is_upper ? slope + fraction * ( quarter - slope ) : fraction * ( slope + quarter ) - quarter;
        const float ball = of_top ? top : bottom, radius = ball * cosf( angle );
        const float y = ( of_top ? half : -half ) + ball * sinf( angle );
        const bool is_rim = i == SEGMENTS / 2 || ( i == SEGMENTS / 2 + 1 && is_ball == false );
        for ( int m = 0; m < SEGMENTS; ++m )
        {
            if ( i > 0 && m % ( SEGMENTS / 4 ) == 0 )
            {
                add_line( to, on_circle( m, last_y, last ), on_circle( m, y, radius ), CYAN );
            }
            if ( is_rim )
            {
                add_line( to, on_circle( m, y, radius ), on_circle( m + 1, y, radius ), CYAN );
            }
        }
        last_y = y, last = radius;
    }
}

static wisp_vec3 box_corner( wisp_vec3 half, int corner )
{
    return wisp_v3( ( corner & 1 ) != 0 ? half.x : -half.x, ( corner & 2 ) != 0 ? half.y : -half.y,
                    ( corner & 4 ) != 0 ? half.z : -half.z );
}

static void add_box( const body_lines* to, wisp_vec3 half )
{
    for ( int i = 0; i < 24; ++i )
    {
        const int corner = i / 3, other = corner | 1 << i % 3;
        if ( other != corner )
        {
            add_line( to, box_corner( half, corner ), box_corner( half, other ), CYAN );
        }
    }
}

static wisp_vec3 grid_point( const wisp_height_field* f, int i, int k )
{
    return wisp_v3( ( (float)i - 0.5f * (float)( f->count_x - 1 ) ) * f->spacing,
                    f->heights != NULL ? f->heights[(size_t)k * (size_t)f->count_x + (size_t)i] : 0.0f,
                    ( (float)k - 0.5f * (float)( f->count_z - 1 ) ) * f->spacing );
}

static void add_grid( const body_lines* to, const wisp_height_field* f )
{
    for ( int k = 0; k < f->count_z; ++k )
    {
        for ( int i = 0; i < f->count_x; ++i )
        {
            if ( i + 1 < f->count_x )
            {
                add_line( to, grid_point( f, i, k ), grid_point( f, i + 1, k ), CYAN );
            }
            if ( k + 1 < f->count_z )
            {
                add_line( to, grid_point( f, i, k ), grid_point( f, i, k + 1 ), CYAN );
            }
        }
    }
}

static wisp_vec3 corner_of( const collision_body* body, int corner )
{
    float weights[3] = { 0.0f, 0.0f, 0.0f };
    weights[corner % 3] = 1.0f;
    return body->tree != NULL ? wisp_collision_mesh_place( body->tree, corner / 3, weights, 1.0f ).point
                              : wisp_convex_corner( body->convex, corner / 3, corner % 3 );
}

// The edges of a closed mesh are there in both directions, one of which counts.
static void add_triangles( const body_lines* to, int count )
{
    for ( int i = 0; i < 3 * count; ++i )
    {
        const wisp_vec3 a = corner_of( to->body, i ), b = corner_of( to->body, i % 3 == 2 ? i - 2 : i + 1 );
        const bool counts = a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
        if ( counts || to->body->double_sided )
        {
            add_line( to, a, b, CYAN );
        }
    }
}

static void add_body( const body_lines* to )
{
    const collision_body* body = to->body;
    const wisp_shape* shape = &body->shape;
    const wisp_height_field plane = { NULL, CELLS + 1, CELLS + 1, 1.0f };
    const int32_t* triangles;
    if ( body->tree != NULL )
    {
        add_triangles( to, wisp_collision_mesh_get_stats( body->tree ).triangle_count );
        return;
    }
    switch ( shape->kind )
    {
        case WISP_SHAPE_PLANE:
            add_grid( to, &plane );
            break;
        case WISP_SHAPE_SPHERE:
            add_round( to, 0.0f, shape->radius, shape->radius );
            break;
        case WISP_SHAPE_CAPSULE:
            add_round( to, shape->half_length, shape->radius, shape->radius );
            break;
        case WISP_SHAPE_TAPERED_CAPSULE:
            add_round( to, shape->half_length, shape->bottom_radius, shape->top_radius );
            break;
        case WISP_SHAPE_BOX:
            add_box( to, shape->half_extent );
            break;
        case WISP_SHAPE_CONVEX:
            add_triangles( to, wisp_convex_triangles( body->convex, &triangles ) );
            break;
        case WISP_SHAPE_HEIGHT_FIELD:
            add_grid( to, &shape->height_field );
            break;
    }
}

// ---- what touches a body ----

// @param p m, in the rows of the body
static void add_touch_line( const body_lines* to, wisp_vec3 p, float thickness )
{
    const wisp_mesh_query query = { .point = wisp_transform_to_local( to->pose, p ),
                                    .radius = SLACK * thickness,
                                    .time = 1.0f };
    const collision_view view = { .body = to->body, .thickness = query.radius, .end = 1.0f };
    wisp_surface_point nearest;
    bool is_near = false;
    if ( collision_box_distance( to->body, query.point ) <= query.radius )
    {
        collision_closest( &view, &query, 1, &nearest, &is_near, NULL );
    }
    if ( is_near && nearest.distance <= query.radius )
    {
        add_line( to, nearest.point, wisp_v3_mul_add( nearest.point, thickness, nearest.normal ), YELLOW );
    }
}

// Vertices that may move: of a surface, or of strands.
static void add_touch_lines( const body_lines* to, const wisp_world* world, wisp_entity entity, float own,
                             float thickness )
{
    const wisp_fabric* f = wisp_world_fabric( (wisp_world*)world, entity );
    const wisp_strand_topology* t = wisp_world_strands( (wisp_world*)world, entity );
    const float* rows =
        wisp_world_rows( world, entity, f != NULL ? WISP_PARTICLE_POSITION : WISP_STRAND_POSITION, 0 );
    const float* weights = wisp_world_rows( world, entity, WISP_STRAND_INVERSE_MASS, 0 );
    const wisp_vec3 by = wisp_world_between( world, entity, to->entity );
    const collision_maps maps = { .thickness = wisp_world_rows( world, entity, WISP_MAP_COLLISION_THICKNESS, 0 ),
                                  .own = own };
    for ( int v = 0; f != NULL && v < f->vertex_count; ++v )
    {
        const float* at = rows + 4 * (size_t)f->vertex_slot[v];
        if ( at[3] > 0.0f )
        {
            add_touch_line( to, wisp_v3_mul_add( wisp_v3_load( at ), 1.0f, by ),
                            thickness - collision_thinner( &maps, f->vertex_slot[v] ) );
        }
    }
    for ( int i = 0; t != NULL && i < WISP_LANES * t->group_count; ++i )
    {
        for ( int k = 0; k < t->lane_count[i]; ++k )
        {
            const size_t row = (size_t)( t->group_row[i / WISP_LANES] + k ), lane = (size_t)( i % WISP_LANES );
            if ( weights != NULL ? weights[WISP_LANES * row + lane] > 0.0f : k > 0 )
            {
                const wisp_vec3 at = collision_load_lane( rows + COLLISION_ROW * row + lane );
                add_touch_line( to, wisp_v3_mul_add( at, 1.0f, by ), thickness );
            }
        }
    }
}

void collision_add_lines( const void* memory, wisp_world* world, wisp_entity entity, wisp_line_kind kind,
                          wisp_line_list* list )
{
    const collision_state* state = memory;
    const collision_settings* settings = wisp_world_rows( world, entity, state->settings, 0 );
    for ( int i = 0; i < state->body_count; ++i )
    {
        const collision_body* body = state->bodies + i;
        const collision_collider* collider = wisp_world_rows( world, body->entity, state->collider, 0 );
        body_lines to = { list, body, body->entity, collider->to };
        if ( body->follows )
        {
            to.entity = body->surface;
            to.pose = ( wisp_transform ){ { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };
        }
        if ( kind == WISP_LINES_COLLIDERS && wisp_entity_equal( entity, body->entity ) && to.entity.index != 0 )
        {
            add_body( &to );
        }
        if ( kind == WISP_LINES_CONTACTS && settings != NULL && settings->enabled != 0 && to.entity.index != 0 &&
             ( collider->layers & settings->mask ) != 0 && wisp_entity_equal( entity, to.entity ) == false )
        {
            add_touch_lines( &to, world, entity, settings->thickness, settings->thickness + collider->thickness );
        }
    }
}
