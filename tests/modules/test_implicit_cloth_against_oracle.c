// The engine of implicit cloth, in single precision, compared with the oracle, in double, substep by substep: a sheet
// of 64 vertices, alone and on bodies, with each switch of the method.
#include "implicit_duel_fixture.h"

#include "implicit_internal.h"

// m. Positions are 0.25 m at most, so each is rounded by 1.5e-8 m in memory, and by as much again in the differences
// for lengths. The error of a substep stays in the velocity, of which damping and the implicit step remove most.
static const double A_SUBSTEP = 6e-8;
// m, of any number of substeps.
static const double MOST = 2e-6;

enum
{
    SUBSTEPS = 50,
    SURE = 8,      // substeps in which no vertex may be at a threshold of friction that the two decide differently
    MAX_TURNS = 8, // substeps that may be skipped because a link is at a corner of its force law
};

static const float FAST = 1.0f / 240.0f, SLOW = 1.0f / 60.0f; // s

// ---- switches of the equations ----

// A link pulls from its rest length on, and bends on its ramp or on its arc. Where rounding decides which, both are
// right, and their next velocities differ by h^2 k of the link, tens of times a mass.
static int side_of( const triangle_oracle_link* l, double3 a, double3 b )
{
    const double r = double3_distance( a, b ), y = r / l->length;
    if ( l->bends == false || y >= 1.0 )
    {
        return y >= 1.0 ? 1 : 0;
    }
    const double load = l->bend / ( l->length * l->length );
    return load * triangle_oracle_arc_load( y ) > l->ramp * ( r - l->length ) ? 2 : 3;
}

// Positions at which forces are evaluated: x^ of BDF2, whose substeps are all alike here.
static double3 queried_at( const triangle_oracle* o, int vertex )
{
    const bool two = o->params.integrator == TRIANGLE_ORACLE_BDF2 && o->h_before > 0.0;
    const double3 ahead = double3_scale( 1.0 / 3.0, double3_sub( o->x[vertex], o->x_before[vertex] ) );
    return two ? double3_add( o->x[vertex], ahead ) : o->x[vertex];
}

// True if the state of a link depends on rounding, and on the present difference of both.
static bool is_at_a_corner( match* m, bool at_the_end )
{
    int vertex = -1;
    const triangle_oracle* o = &m->oracle;
    const double off = 4.0 * apart( m, &vertex );
    for ( int k = 0; k < o->link_count; ++k )
    {
        const triangle_oracle_link* l = o->link + k;
        const double3 a = at_the_end ? o->x[l->i] : queried_at( o, l->i );
        const double3 b = at_the_end ? o->x[l->j] : queried_at( o, l->j );
        const double3 way = double3_scale( 3e-7 + off / l->length, double3_sub( b, a ) );
        if ( side_of( l, a, double3_add( b, way ) ) != side_of( l, a, double3_sub( b, way ) ) )
        {
            return true;
        }
    }
    return false;
}

// The oracle continues from the engine's state.
static void follow( match* m )
{
    const implicit_state* state = wisp_world_module_state( m->h.world, "implicit_cloth" );
    const bool two = m->oracle.params.integrator == TRIANGLE_ORACLE_BDF2;
    for ( int v = 0; v < DUEL_VERTICES; ++v )
    {
        m->oracle.x[v] = double3_from( quad_of( m, v, WISP_PARTICLE_POSITION ) );
        m->oracle.v[v] = double3_from( quad_of( m, v, WISP_PARTICLE_VELOCITY ) );
        for ( int column = 0; two && column < 2; ++column )
        {
            const float* before = wisp_world_column( m->h.world, m->cloth, state->history, column );
            double3* to = column == 0 ? m->oracle.x_before : m->oracle.v_before;
            to[v] = double3_from( before + slot_of( m, v ) * 4 );
        }
    }
}

// Friction is a threshold, too.
static bool do_contacts_agree( match* m )
{
    const implicit_state* state = wisp_world_module_state( m->h.world, "implicit_cloth" );
    const implicit_contact* contact = wisp_world_column( m->h.world, m->cloth, state->contact, 0 );
    for ( int v = 0; v < DUEL_VERTICES; ++v )
    {
        const implicit_contact* c = contact + slot_of( m, v );
        const bool held = c->body[0] != 0 || c->body[1] != 0;
        const triangle_oracle_contact_state engine = held == false    ? TRIANGLE_ORACLE_FREE
                                                     : c->slides != 0 ? TRIANGLE_ORACLE_SLIDING
                                                                      : TRIANGLE_ORACLE_STICKING;
        const triangle_oracle_contact_state oracle = m->oracle.contact[v].state;
        // a landing vertex slides
        if ( engine != ( oracle == TRIANGLE_ORACLE_LANDING ? TRIANGLE_ORACLE_SLIDING : oracle ) )
        {
            return false;
        }
    }
    return true;
}

// ---- a match ----

static double allowed_behind( int substeps )
{
    return fmin( A_SUBSTEP * substeps, MOST );
}

// Statistics of both have the same counts, and energies that differ by rounding of lengths alone.
static void assert_stats( match* m )
{
    const wisp_implicit_cloth_stats f = stats_of( m->h.world, m->cloth );
    const triangle_oracle* o = &m->oracle;
    assert_int_equal( f.stretch_links, o->stretch_count );
    assert_int_equal( f.bend_links, o->bend_count );
    assert_int_equal( f.max_neighbours, o->max_neighbours );
    assert_int_equal( f.newton_iterations, o->params.newton_iterations );
    assert_int_equal( f.sticking, o->sticking );
    assert_int_equal( f.sliding, o->sliding );
    assert_int_equal( f.landing, o->landing );
    const double stretch = triangle_oracle_stretch_energy( o, o->x ), bend = triangle_oracle_bend_energy( o, o->x );
    assert_near( f.stretch_energy, stretch, 1e-3 * stretch + 1e-9 );
    assert_near( f.bend_energy, bend, 1e-3 * bend + 1e-9 );
}

// @return number of substeps in agreement, until friction reaches a threshold that rounding decides
static int run_match( match* m, void ( *before )( match* m ), const double* friction, int body_count )
{
    int turns = 0, together = 0;
    for ( int k = 0; k < SUBSTEPS; ++k )
    {
        bool corner = is_at_a_corner( m, false );
        if ( before != NULL )
        {
            before( m );
        }
        step_both( m, friction, body_count );
        assert_false( m->oracle.negative );
        if ( do_contacts_agree( m ) == false )
        {
            return k;
        }
        corner = corner || ( m->rules->repeats > 1 && is_at_a_corner( m, true ) );
        int vertex = -1;
        const double most = apart( m, &vertex );
        together += 1;
        if ( !( most <= allowed_behind( together ) ) )
        {
            turns += 1;
            if ( corner == false || turns > MAX_TURNS )
            {
                fail_msg(
                    "%s: vertex %d is %.3g m from the oracle behind %d substeps, %d since they were one; %d turns",
                    m->rules->name, vertex, most, m->steps, together, turns );
            }
            follow( m );
            together = 0;
        }
        else if ( corner == false )
        {
            assert_stats( m );
        }
    }
    return SUBSTEPS;
}

static void run_duels( const duel* duels, int count )
{
    for ( int k = 0; k < count; ++k )
    {
        match* m = open_match( duels + k );
        assert_int_equal( run_match( m, NULL, NULL, 0 ), SUBSTEPS );
        close_match( m );
    }
}

// ---- without bodies ----

#define EFFECTIVE .weights = WISP_IMPLICIT_WEIGHTS_EFFECTIVE, .dt = FAST
#define NONE .weights = WISP_IMPLICIT_WEIGHTS_NONE, .dt = FAST

TEST( weights_go_with_the_oracle )
{
    const duel duels[] = {
        { "effective", EFFECTIVE },
        { "effective, free", EFFECTIVE, .loose = true },
        { "none", NONE },
        { "effective, by hand", EFFECTIVE, .by_hand = true },
        { "effective, slow", .dt = SLOW },
    };
    run_duels( duels, WISP_COUNT( duels ) );
}

TEST( sheets_go_with_the_oracle )
{
    const duel duels[] = {
        { "sheet", NONE, .stiffness = WISP_IMPLICIT_STIFFNESS_MATERIAL },
        { "sheet, effective", EFFECTIVE, .stiffness = WISP_IMPLICIT_STIFFNESS_MATERIAL },
    };
    run_duels( duels, WISP_COUNT( duels ) );
}

TEST( damping_integrators_and_repeats_go_with_the_oracle )
{
    const duel duels[] = {
        { "strong damping", EFFECTIVE, .damping = 0.2f },
        { "bdf2", EFFECTIVE, .integrator = WISP_INTEGRATOR_BDF2 },
        { "three repeats", EFFECTIVE, .repeats = 3 },
        { "carried", EFFECTIVE, .carried = true },
        { "carried, bdf2", EFFECTIVE, .carried = true, .integrator = WISP_INTEGRATOR_BDF2 },
    };
    run_duels( duels, WISP_COUNT( duels ) );
}

// ---- on bodies ----

typedef struct scene
{
    duel rules;
    bool plane, ball, moves;
    float friction;
    float fall; // m/s, that the sheet begins with
} scene;

// The moving body, one scene at a time.
static struct
{
    wisp_entity body;
    wisp_transform pose;
} moving;

static wisp_entity add_body( match* m, wisp_collider_kind kind, wisp_vec3 at, float friction )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = kind;
    def.radius = 0.1f;
    def.static_friction = friction;
    def.kinetic_friction = 0.8f * friction;
    def.pose.translation = at;
    wisp_entity e;
    assert_status( m->h.world, wisp_add_collider( m->h.world, &def, &e ), WISP_OK );
    moving.body = e;
    moving.pose = def.pose;
    return e;
}

static int add_bodies( match* m, const scene* s, double friction[WISP_MAX_PARTICLE_CONTACTS] )
{
    int count = 0;
    if ( s->plane )
    {
        friction[count++] = (double)s->friction;
        add_body( m, WISP_COLLIDER_PLANE, ( wisp_vec3 ){ 0.0f, -0.012f, 0.0f }, s->friction );
    }
    if ( s->ball )
    {
        friction[count++] = (double)( s->friction + 0.1f );
        add_body( m, WISP_COLLIDER_SPHERE, ( wisp_vec3 ){ 0.11f, -0.112f, 0.1f }, s->friction + 0.1f );
    }
    SET( m->h.world, m->cloth, collision, d.thickness = 0.01f, d.max_push_out_speed = 1.0f );
    return count;
}

// So fast that it would cross the margin in a substep.
static void let_fall( match* m, float speed )
{
    for ( int v = 0; v < DUEL_VERTICES; ++v )
    {
        velocity_of( m->h.world, m->cloth, v )[1] -= speed;
        m->oracle.v[v] = double3_from( quad_of( m, v, WISP_PARTICLE_VELOCITY ) );
    }
}

// Along x, and up into the sheet.
static void move_body( match* m )
{
    const float t = (float)( m->steps + 1 ) * m->rules->dt;
    wisp_transform pose = moving.pose;
    pose.translation.x += 0.2f * t;
    pose.translation.y += 0.1f * t;
    assert_status( m->h.world, wisp_move_collider( m->h.world, moving.body, pose ), WISP_OK );
}

static void run_scenes( const scene* scenes, int count )
{
    for ( int k = 0; k < count; ++k )
    {
        match* m = open_match( &scenes[k].rules );
        double friction[WISP_MAX_PARTICLE_CONTACTS];
        const int bodies = add_bodies( m, scenes + k, friction );
        let_fall( m, scenes[k].fall );
        const int together = run_match( m, scenes[k].moves ? move_body : NULL, friction, bodies );
        const int touching = m->oracle.sticking + m->oracle.sliding + m->oracle.landing;
        if ( together < SURE || touching == 0 )
        {
            fail_msg( "%s: together for %d substeps, %d in contact", scenes[k].rules.name, together, touching );
        }
        close_match( m );
    }
}

#define FREE .loose = true, .dt = FAST

TEST( contact_goes_with_the_oracle )
{
    const scene scenes[] = {
        { { "plane", FREE }, .plane = true, .friction = 0.5f },
        { { "plane, without friction", FREE }, .plane = true },
        { { "plane, little friction", FREE }, .plane = true, .friction = 0.05f },
        { { "plane, two repeats", FREE, .repeats = 2 }, .plane = true, .friction = 0.5f },
        { { "plane, bdf2", FREE, .integrator = WISP_INTEGRATOR_BDF2 }, .plane = true, .friction = 0.5f },
        { { "ball", FREE }, .ball = true, .friction = 0.4f },
        { { "ball, hanging", .dt = FAST }, .ball = true, .friction = 0.1f },
        { { "plane and ball", FREE }, .plane = true, .ball = true, .friction = 0.5f },
    };
    run_scenes( scenes, WISP_COUNT( scenes ) );
}

TEST( landing_goes_with_the_oracle )
{
    const scene scenes[] = {
        { { "landing", FREE }, .plane = true, .friction = 0.5f, .fall = 4.0f },
        { { "landing, bdf2", FREE, .integrator = WISP_INTEGRATOR_BDF2 },
          .plane = true,
          .friction = 0.5f,
          .fall = 4.0f },
        { { "landing without friction", FREE }, .plane = true, .fall = 4.0f },
        { { "landing on a ball", FREE }, .ball = true, .friction = 0.1f, .fall = 4.0f },
    };
    run_scenes( scenes, WISP_COUNT( scenes ) );
}

TEST( moving_bodies_go_with_the_oracle )
{
    const scene scenes[] = {
        { { "moving plane", FREE }, .plane = true, .moves = true, .friction = 0.5f },
        { { "moving plane, without friction", FREE }, .plane = true, .moves = true },
        { { "moving ball", FREE }, .ball = true, .moves = true, .friction = 0.4f },
        { { "moving ball, hanging", .dt = FAST }, .ball = true, .moves = true, .friction = 0.1f },
    };
    run_scenes( scenes, WISP_COUNT( scenes ) );
}
