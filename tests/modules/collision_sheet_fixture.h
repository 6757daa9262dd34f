/// A sheet of cells of 2 cm and a body that comes through it: meshes, placing, moving, and the gap between both by an oracle.
#pragma once

#include "collision_fixture.h"

#include "oracle/contact_oracle.h"
#include "wisp/module/random.h"

static const float DT = 1.0f / 60.0f;
static const float CELL = 0.02f;
static const float THICKNESS = 0.005f;
static const float GRAVITY = 9.8f;

enum
{
    SIDE = 21, // vertices
    MOST_POINTS = 600,
    MOST_CORNERS = 121, // of a collider
};

static inline wisp_vec3 random_point( uint32_t number )
{
    const wisp_random_key key = wisp_random_make_key( 7, 0, 0 );
    return ( wisp_vec3 ){ wisp_random_unit_float( key, number, 0, 0 ), wisp_random_unit_float( key, number, 1, 0 ),
                          wisp_random_unit_float( key, number, 2, 0 ) };
}

static inline test_mesh new_mesh( const wisp_vec3* points, int point_count, const int32_t* triangles,
                                  int triangle_count )
{
    test_mesh m = { calloc( (size_t)point_count, sizeof( wisp_vec3 ) ),
                    calloc( 3 * (size_t)triangle_count, sizeof( int32_t ) ), point_count, triangle_count };
    memcpy( m.points, points, (size_t)point_count * sizeof( wisp_vec3 ) );
    memcpy( m.triangles, triangles, 3 * (size_t)triangle_count * sizeof( int32_t ) );
    return m;
}

// ---- a sheet and a mesh ----

typedef struct setting
{
    wisp_collision_features features;
    bool is_held, double_sided, follows;
    const wisp_height_field* field; // that the collider is, in place of a mesh; null: it is one
    float gravity;
    int workers;
    wisp_quat rotation;
} setting;

typedef struct sheet
{
    hosted* h;
    wisp_entity surface, body, skin;
    test_mesh mesh, collider;
    setting with;
    wisp_vec3 place; // of the collider
} sheet;

// In a direction and at a place that no edge of the sheet has.
static const wisp_quat TURNED = { 0.0f, 0.18f, 0.0f, 0.98367f };

static inline wisp_vec3 place_of( const sheet* s, wisp_vec3 p )
{
    return wisp_transform_to_world( wisp_transform_make( s->with.rotation, s->place ), p );
}

static inline void move_to( sheet* s, float height )
{
    s->place.y = height;
    if ( s->with.follows == false )
    {
        const wisp_transform pose = wisp_transform_make( s->with.rotation, s->place );
        assert_int_equal( wisp_move_collider( s->h->world, s->body, pose ), WISP_OK );
        return;
    }
    wisp_vec3 targets[8];
    int32_t all[8];
    for ( int v = 0; v < s->collider.vertex_count; ++v )
    {
        all[v] = v;
        targets[v] = place_of( s, s->collider.points[v] );
    }
    assert_int_equal( wisp_move_pins( s->h->world, s->skin, all, targets, s->collider.vertex_count ), WISP_OK );
}

static inline void add_skin( sheet* s )
{
    SCOPED( test_mesh_free )
    test_mesh placed =
        new_mesh( s->collider.points, s->collider.vertex_count, s->collider.triangles, s->collider.triangle_count );
    int32_t all[8];
    for ( int v = 0; v < placed.vertex_count; ++v )
    {
        all[v] = v;
        placed.points[v] = place_of( s, placed.points[v] );
    }
    wisp_fabric_def fabric = test_fabric_def( &placed );
    wisp_surface_def def = support_weightless_surface_def();
    def.pins = all;
    def.pin_count = placed.vertex_count;
    s->skin = test_surface_of( s->h->world, &fabric, def );
}

// A sheet of cells of 2 cm in the plane y = 0, held at its border or free, and a mesh whose highest point is at a height.
static inline sheet new_sheet( test_mesh collider, float height, setting with )
{
    sheet s = { .h = new_colliding( 10, 1, with.workers > 0 ? with.workers : 1 ),
                .collider = collider,
                .with = with };
    const float half = 0.5f * CELL * (float)( SIDE - 1 );
    s.place = ( wisp_vec3 ){ half + 0.003f, height, half + 0.0045f };
    wisp_collider_def def = mesh_body( &collider );
    if ( with.follows )
    {
        add_skin( &s );
        def = wisp_default_collider_def();
        def.kind = WISP_COLLIDER_SURFACE;
        def.surface = s.skin;
    }
    else
    {
        def.pose = wisp_transform_make( with.rotation, s.place );
    }
    if ( with.field != NULL )
    {
        def = wisp_default_collider_def();
        def.kind = WISP_COLLIDER_HEIGHT_FIELD;
        def.heights = with.field->heights;
        def.height_count_x = with.field->count_x;
        def.height_count_z = with.field->count_z;
        def.spacing = with.field->spacing;
        def.pose = wisp_transform_make( with.rotation, s.place );
    }
    def.double_sided = with.double_sided;
    s.body = add_collider( s.h->world, &def );
    s.mesh = test_plane( SIDE, CELL );
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = THICKNESS;
    collision.features = with.features;
    s.surface = add_colliding( s.h->world, &s.mesh, &collision );
    SET_DEFAULT( s.h->world, s.surface, cloth );
    give_gravity( s.h->world, s.surface, with.gravity );
    for ( int32_t v = 0; with.is_held && v < s.mesh.vertex_count; ++v )
    {
        const int i = v % SIDE, k = v / SIDE;
        if ( i == 0 || k == 0 || i == SIDE - 1 || k == SIDE - 1 )
        {
            assert_int_equal( wisp_pin( s.h->world, s.surface, &v, 1 ), WISP_OK );
        }
    }
    return s;
}

static inline void free_sheet( sheet* s )
{
    test_mesh_free( &s->mesh );
    test_mesh_free( &s->collider );
    free_colliding( s->h );
}

// m; -1 if the sheet and the mesh cross.
static inline double gap_of( const sheet* s )
{
    static double3 points[MOST_POINTS];
    double3 corners[MOST_CORNERS];
    assert_true( s->mesh.vertex_count <= MOST_POINTS && s->collider.vertex_count <= MOST_CORNERS );
    for ( int v = 0; v < s->mesh.vertex_count; ++v )
    {
        points[v] = double3_widen( point_of( s->h->world, s->surface, v ) );
    }
    for ( int v = 0; v < s->collider.vertex_count; ++v )
    {
        corners[v] = double3_widen( place_of( s, s->collider.points[v] ) );
    }
    const mesh_gap_oracle_mesh a = { points, s->mesh.triangles, s->mesh.triangle_count },
                               b = { corners, s->collider.triangles, s->collider.triangle_count };
    return mesh_gap_oracle_find( &a, &b );
}

// Move a collider up by a rise at a speed, and on for some steps. @return the least gap on the way
static inline double rise( sheet* s, float from, float by, float speed, int more )
{
    double least = INFINITY;
    const int steps = (int)ceilf( by / ( speed * DT ) );
    for ( int n = 1; n <= steps + more; ++n )
    {
        move_to( s, from + fminf( by, speed * DT * (float)n ) );
        run_for( s->h->world, DT, 1 );
        least = n % 5 == 0 || n <= steps ? fmin( least, gap_of( s ) ) : least;
    }
    return least;
}
