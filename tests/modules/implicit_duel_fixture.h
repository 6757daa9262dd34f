/// Implicit cloth in the engine and in the oracle: the same disturbed sheet with the same switches, substep by
/// substep. The oracle takes its bodies from the engine.
#pragma once

#include "implicit_cloth_fixture.h"

#include "oracle/triangle_oracle.h"

enum
{
    DUEL_SIDE = 8,
    DUEL_VERTICES = DUEL_SIDE * DUEL_SIDE,
    DUEL_TRIANGLES = 2 * ( DUEL_SIDE - 1 ) * ( DUEL_SIDE - 1 ),
};

typedef struct duel
{
    const char* name;
    wisp_implicit_weights weights;
    wisp_implicit_stiffness stiffness;
    wisp_integrator integrator;
    int repeats;                  // 0: one
    float damping;                // N s/m; 0: the default
    bool by_hand, carried, loose; // pairs; a pin that moves; no pins
    float recovery;               // m/s, of bodies
    float dt;                     // s
} duel;

typedef struct match
{
    const duel* rules;
    hosted h;
    wisp_entity cloth;
    triangle_oracle oracle;
    int32_t pairs[4 * DUEL_VERTICES];
    int pair_count;
    int steps;
} match;

static inline size_t slot_of( match* m, int vertex )
{
    return (size_t)wisp_world_fabric( m->h.world, m->cloth )->vertex_slot[vertex];
}

static inline const float* quad_of( match* m, int vertex, wisp_component component )
{
    const float* column = wisp_world_column( m->h.world, m->cloth, component, 0 );
    return column + slot_of( m, vertex ) * 4;
}

// Rows and columns of the sheet, which stretch.
static inline void list_pairs( match* m )
{
    for ( int v = 0; v < DUEL_VERTICES; ++v )
    {
        const int others[2] = { v % DUEL_SIDE + 1 < DUEL_SIDE ? v + 1 : -1,
                                v + DUEL_SIDE < DUEL_VERTICES ? v + DUEL_SIDE : -1 };
        for ( int k = 0; k < 2; ++k )
        {
            if ( others[k] >= 0 )
            {
                m->pairs[2 * m->pair_count] = v;
                m->pairs[2 * m->pair_count++ + 1] = others[k];
            }
        }
    }
}

static inline wisp_implicit_cloth_def duel_def( match* m )
{
    const duel* r = m->rules;
    wisp_implicit_cloth_def def = exact_def();
    def.weights = r->weights;
    def.stiffness_model = r->stiffness;
    def.integrator = r->integrator;
    def.newton_iterations = r->repeats > 0 ? r->repeats : 1;
    def.max_newton_iterations = 1; // the oracle makes no substep again
    def.link_damping = r->damping > 0.0f ? r->damping : def.link_damping;
    if ( r->by_hand )
    {
        list_pairs( m );
        def.stretch_pairs = m->pairs;
        def.stretch_pair_count = m->pair_count;
    }
    return def;
}

static inline void match_params( const wisp_implicit_cloth_def* def, triangle_oracle_params* p )
{
    *p = triangle_oracle_default_params();
    p->weights = (triangle_oracle_weights)def->weights;
    p->stiffness = (triangle_oracle_stiffness)def->stiffness_model;
    p->integrator = (triangle_oracle_integrator)def->integrator;
    p->stretch_stiffness = (double)def->stretch_stiffness;
    p->bend_stiffness = (double)def->bend_stiffness;
    p->bend_rigidity = (double)def->bend_rigidity;
    p->damping = (double)def->link_damping;
    p->gravity = double3_make( 0.0, (double)EARTH.y, 0.0 );
    p->newton_iterations = def->newton_iterations;
    p->max_iterations = 1000;
}

// The oracle starts from the engine's floats and masses.
static inline void start_oracle( match* m, const test_mesh* mesh, const wisp_implicit_cloth_def* def )
{
    double3 points[DUEL_VERTICES];
    double masses[DUEL_VERTICES];
    int triangles[3 * DUEL_TRIANGLES], pairs[4 * DUEL_VERTICES];
    for ( int v = 0; v < DUEL_VERTICES; ++v )
    {
        const float weight = quad_of( m, v, WISP_PARTICLE_POSITION )[3];
        points[v] = double3_from( &mesh->points[v].x );
        masses[v] = weight > 0.0f ? 1.0 / (double)weight : 1.0;
    }
    for ( int i = 0; i < 3 * DUEL_TRIANGLES; ++i )
    {
        triangles[i] = mesh->triangles[i];
    }
    for ( int i = 0; i < 2 * m->pair_count; ++i )
    {
        pairs[i] = m->pairs[i];
    }
    const triangle_oracle_def sheet = {
        .count = DUEL_VERTICES,
        .points = points,
        .triangle_count = DUEL_TRIANGLES,
        .triangles = triangles,
        .masses = masses,
        .stretch_pairs = m->pair_count > 0 ? pairs : NULL,
        .stretch_pair_count = m->pair_count,
    };
    triangle_oracle_params params;
    match_params( def, &params );
    m->oracle = triangle_oracle_create( &sheet, &params );
    for ( int v = 0; v < DUEL_VERTICES; ++v )
    {
        m->oracle.x[v] = double3_from( quad_of( m, v, WISP_PARTICLE_POSITION ) );
        m->oracle.v[v] = double3_from( quad_of( m, v, WISP_PARTICLE_VELOCITY ) );
        if ( quad_of( m, v, WISP_PARTICLE_POSITION )[3] == 0.0f )
        {
            triangle_oracle_pin( &m->oracle, v );
        }
    }
}

/// A sheet whose vertices are 1.5 mm off a grid of a 32nd of a metre at rest. At the start they are displaced by
/// another 2 mm and move at up to 0.2 m/s.
static inline match* open_match( const duel* rules )
{
    match* m = checked_calloc( 1, sizeof( match ) );
    m->rules = rules;
    open_implicit( &m->h, 1 );
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( DUEL_SIDE, 0.03125f );
    for ( int v = 0; v < DUEL_VERTICES; ++v )
    {
        mesh.points[v].x += test_random_float( v, 200, -1.5e-3f, 1.5e-3f );
        mesh.points[v].z += test_random_float( v, 201, -1.5e-3f, 1.5e-3f );
    }
    const int32_t pins[2] = { 0, DUEL_SIDE - 1 };
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = pins;
    surface.pin_count = rules->loose ? 0 : 2;
    m->cloth = test_surface_of( m->h.world, &fabric, surface );
    const wisp_implicit_cloth_def def = duel_def( m );
    set_implicit( m->h.world, m->cloth, &def );
    assert_status( m->h.world, wisp_set_gravity( m->h.world, m->cloth, EARTH ), WISP_OK );
    crumple_sheet( m->h.world, m->cloth, 2e-3f, 0.2f );
    start_oracle( m, &mesh, &def );
    return m;
}

static inline void close_match( match* m )
{
    assert_int_equal( count_of( m->h.world, WISP_COUNT_HALTED ), 0 );
    triangle_oracle_destroy( &m->oracle );
    close_world( &m->h );
    free( m );
}

// ---- bodies ----

// The engine's contact input in this substep for the body with this friction; its rows have everything except
// identifiers.
static inline bool sensed_touch( void* user, int vertex, double3 x, triangle_oracle_touch* touch )
{
    match* m = user;
    (void)x;
    const size_t row = slot_of( m, vertex ) * WISP_MAX_PARTICLE_CONTACTS;
    const float* plane = wisp_world_column( m->h.world, m->cloth, WISP_PARTICLE_CONTACTS, 1 );
    const float* motion = wisp_world_column( m->h.world, m->cloth, WISP_PARTICLE_CONTACTS, 2 );
    const float* friction = wisp_world_column( m->h.world, m->cloth, WISP_PARTICLE_CONTACTS, 3 );
    for ( size_t k = row; k < row + WISP_MAX_PARTICLE_CONTACTS; ++k )
    {
        const double3 n = double3_from( plane + 4 * k );
        if ( double3_length( n ) > 0.5 && fabs( (double)friction[3 * k] - touch->still ) < 1e-6 )
        {
            touch->normal = double3_scale( 1.0 / double3_length( n ), n );
            touch->gap = (double)plane[4 * k + 3];
            touch->motion = double3_from( motion + 4 * k );
            touch->margin = (double)motion[4 * k + 3];
            touch->still = (double)friction[3 * k];
            touch->slip = (double)friction[3 * k + 1];
            touch->recovery = (double)friction[3 * k + 2];
            return true;
        }
    }
    return false;
}

// ---- a step of both ----

static inline void carry_pin( match* m )
{
    const int32_t pin = DUEL_SIDE - 1;
    const float t = (float)m->steps * m->rules->dt;
    const wisp_vec3 target = { 0.21875f - 0.3f * t, 0.4f * t, 0.2f * t };
    assert_status( m->h.world, wisp_move_pins( m->h.world, m->cloth, &pin, &target, 1 ), WISP_OK );
    m->oracle.target[pin] = double3_from( &target.x );
}

/// @param friction [body_count] static friction, different for each body
static inline void step_both( match* m, const double* friction, int body_count )
{
    triangle_oracle_body body[WISP_MAX_PARTICLE_CONTACTS];
    for ( int k = 0; k < body_count; ++k )
    {
        body[k] = ( triangle_oracle_body ){
            .shape = TRIANGLE_ORACLE_GIVEN, .still = friction[k], .touch = sensed_touch, .user = m
        };
    }
    const triangle_oracle_bodies bodies = { body_count, body };
    m->steps += 1;
    if ( m->rules->carried )
    {
        carry_pin( m );
    }
    run_steps( m->h.world, 1, m->rules->dt );
    triangle_oracle_step( &m->oracle, (double)m->rules->dt, &bodies );
}

/// The largest distance between a vertex of one and the same vertex of the other, m.
static inline double apart( match* m, int* vertex )
{
    double most = 0.0;
    for ( int v = 0; v < DUEL_VERTICES; ++v )
    {
        const double distance =
            double3_distance( double3_from( quad_of( m, v, WISP_PARTICLE_POSITION ) ), m->oracle.x[v] );
        if ( isnan( most ) == false && !( distance <= most ) )
        {
            most = distance;
            *vertex = v;
        }
    }
    return most;
}
