// The balloon's engine against its double-precision oracle, and its skin and gas against the closed forms. Numbers of
// equations, figures and sections are those of the balloon paper (docs/methods.md).
#include "balloon_engine_fixture.h"

#include "balloon_internal.h"
#include "kernel_tables.h"

// ---- against the oracle ----

// A full pear that moves, spins off its axis and has an open outlet: all forces act.
static balloon_scene busy_scene( const balloon_mesh* mesh )
{
    balloon_scene scene = balloon_scene_in_air( mesh );
    scene.scale = 1.05;
    scene.damping = 0.5f;
    scene.def.gas_ratio = 1.2f;
    scene.def.inflation_rate = 1e-3f;
    scene.def.bend_link_stiffness = scene.def.edge_stiffness;
    scene.def.bend_stiffness = scene.def.stretch_stiffness = 0.5f;
    balloon_scene_give_outlet_around( &scene, balloon_mesh_farthest( mesh, double3_make( 1.0, 0.3, 0.2 ) ), 0.06 );
    scene.def.outlet_open = true;
    assert_in_range( scene.def.outlet_count, 5, 20 );
    return scene;
}

// Rounding: positions of 0.3 m are kept to 1.5e-8 m, and the dozen links of a vertex, its volume and its prediction
// round once each per iteration.
static const double ROUNDING = 3e-7;

TEST( one_substep_is_the_oracles_with_both_solvers )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_pear( 2 );
    double worst = 0.0;
    for ( int solver = 0; solver < WISP_SOLVER_COUNT; ++solver )
    {
        balloon_scene scene = busy_scene( &mesh );
        scene.dt = 1.0f / 600.0f;
        scene.substeps = 1;
        scene.def.solver = scene.def.volume = (wisp_solver)solver;
        SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
        balloon_stir( &flight, 0.5f );
        SCOPED( balloon_oracle_destroy ) balloon_oracle oracle = balloon_oracle_of( &flight, BALLOON_ORDER_ENGINE );
        for ( int step = 0; step < 2; ++step )
        {
            balloon_steps( &flight, 1 );
            balloon_oracle_step( &oracle );
        }
        double distance = balloon_distance( &flight, &oracle );
        worst = distance > worst ? distance : worst;
        balloon_assert_close( distance, 0.0, ROUNDING );
    }
    print_message( "           engine and oracle are %.2g m apart at most\n", worst );
}

static void compare_stats( const balloon_scene* scene )
{
    SCOPED( balloon_end ) balloon_flight flight = balloon_start( scene );
    balloon_stir( &flight, 0.5f );
    SCOPED( balloon_oracle_destroy ) balloon_oracle oracle = balloon_oracle_of( &flight, BALLOON_ORDER_ENGINE );
    balloon_steps( &flight, 1 );
    balloon_oracle_step( &oracle );
    wisp_balloon_stats f = balloon_read( &flight );
    // sums of floats in lanes; constants of the definition are floats, too
    balloon_assert_fraction( f.rest_volume, oracle.rest_volume, 1e-12 );
    balloon_assert_fraction( f.target_volume, oracle.gas_volume, 1e-7 );
    balloon_assert_fraction( f.volume, oracle.volume, 1e-6 );
    balloon_assert_fraction( f.pressure, oracle.gauge, 1e-5 );
    balloon_assert_fraction( f.outlet_speed, oracle.outlet_speed, 1e-5 );
    balloon_assert_fraction( f.mass_flow, oracle.mass_flow, 1e-5 );
    balloon_assert_fraction( f.gas_lost, oracle.gas_lost, 1e-5 );
    const double* engine[] = { f.gravity, f.buoyancy, f.drag, f.jet, f.centre };
    const double3 reference[] = { oracle.forces.gravity, oracle.forces.buoyancy, oracle.forces.drag,
                                  oracle.forces.jet, oracle.centre };
    for ( int n = 0; n < WISP_COUNT( reference ); ++n )
    {
        double size = fmax( double3_length( reference[n] ), 0.01 );
        balloon_assert_close( double3_distance( balloon_from( engine[n] ), reference[n] ) / size, 0.0, 1e-5 );
    }
    double3 torque = balloon_oracle_torque( oracle.outlet_place, oracle.centre, oracle.forces.jet );
    balloon_assert_close( double3_distance( balloon_from( f.torque ), torque ) / double3_length( torque ), 0.0,
                          1e-5 );
    assert_true( f.jet_starts == 1.0 );
}

// In the climate of the paper, and in that of 5 km height with hydrogen: every density is another one.
TEST( the_stats_of_a_substep_are_the_oracles_in_two_climates )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_pear( 2 );
    balloon_scene scene = busy_scene( &mesh );
    scene.dt = 1.0f / 600.0f;
    scene.substeps = 1;
    compare_stats( &scene );
    scene.def.temperature = 255.65f;
    scene.def.atmospheric_pressure = 54020.0f;
    scene.def.gas_molar_mass = 2.016e-3f;
    compare_stats( &scene );
}

// Differences between engine and oracle.
typedef struct quantities
{
    double volume, target;   // shares
    double pressure;         // a share, of 100 Pa at least
    double centre, velocity; // m, m/s
    double impulse;          // of the jet, a share
} quantities;

static quantities differences( const balloon_flight* flight, const balloon_oracle* b, double3 engine_impulse )
{
    wisp_motion_stats q = balloon_motion_stats( flight );
    wisp_balloon_stats f = balloon_read( flight );
    double3 momentum = balloon_oracle_momentum( b->v, b->mass, b->vertex_count );
    double3 centre = balloon_oracle_centre( b->x, b->mass, b->vertex_count );
    quantities d = {
        .volume = q.volume / balloon_oracle_present_volume( b ) - 1.0,
        .target = f.target_volume / b->gas_volume - 1.0,
        .pressure = ( f.pressure - b->gauge ) / fmax( b->gauge, 100.0 ),
        .centre = double3_distance( balloon_from( q.centre ), centre ),
        .velocity = double3_distance( balloon_from( q.momentum ), momentum ) / b->total_mass,
        .impulse =
            double3_distance( engine_impulse, b->jet_impulse ) / fmax( double3_length( b->jet_impulse ), 1e-9 ),
    };
    return d;
}

typedef struct course
{
    const char* name;
    bool pinned, outlet;
    float gas_ratio, rate;
} course;

static const course COURSES[] = {
    { "held", true, false, 1.2f, 0.0f },
    { "inflating", false, false, 1.0f, 5e-3f },
    { "flying", false, true, 1.2f, 0.0f },
};

static balloon_scene course_scene( const course* c, const balloon_mesh* mesh, const int32_t* pins, int pin_count )
{
    balloon_scene scene = balloon_scene_in_air( mesh );
    scene.damping = 2.0f;
    scene.def.gas_ratio = c->gas_ratio;
    scene.def.inflation_rate = c->rate;
    scene.pins = c->pinned ? pins : NULL;
    scene.pin_count = c->pinned ? pin_count : 0;
    if ( c->outlet )
    {
        balloon_scene_give_outlet( &scene, balloon_mesh_farthest( mesh, double3_make( 1.0, 0.3, 0.2 ) ), true );
    }
    return scene;
}

// One substep per step, so that every substep's jet is read.
static void fly_both( const balloon_flight* flight, balloon_oracle* oracle, int steps, double3* impulse )
{
    *impulse = double3_make( 0.0, 0.0, 0.0 );
    for ( int n = 0; n < steps; ++n )
    {
        balloon_steps( flight, 1 );
        balloon_oracle_step( oracle );
        wisp_balloon_stats f = balloon_read( flight );
        *impulse = double3_add( *impulse, double3_scale( (double)flight->scene->dt, balloon_from( f.jet ) ) );
    }
}

// 60 frames of 10 substeps. In the engine's order of links the difference is rounding; with all edges before all
// cross links, as in the paper, both agree only as closely as the solver has converged.
TEST( a_second_of_a_held_an_inflating_and_a_flying_balloon_is_the_oracles )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_pear( 2 );
    // three vertices, because two let it swing
    const int32_t pins[3] = { balloon_mesh_farthest( &mesh, double3_make( 0.0, -1.0, 0.0 ) ),
                              balloon_mesh_farthest( &mesh, double3_make( 0.0, 0.0, 1.0 ) ),
                              balloon_mesh_farthest( &mesh, double3_make( 1.0, 0.0, 0.0 ) ) };
    for ( int n = 0; n < WISP_COUNT( COURSES ) * 2; ++n )
    {
        const course* c = COURSES + n / 2;
        balloon_order order = n % 2 == 0 ? BALLOON_ORDER_ENGINE : BALLOON_ORDER_PARTED;
        balloon_scene scene = course_scene( c, &mesh, pins, WISP_COUNT( pins ) );
        scene.dt = 1.0f / 600.0f;
        scene.substeps = 1;
        if ( order == BALLOON_ORDER_ENGINE )
        {
            scene.def.bend_link_stiffness = scene.def.edge_stiffness;
        }
        SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
        SCOPED( balloon_oracle_destroy ) balloon_oracle oracle = balloon_oracle_of( &flight, order );
        double3 impulse;
        fly_both( &flight, &oracle, 600, &impulse );
        quantities d = differences( &flight, &oracle, impulse );
        print_message(
            "           %s, %s order: V %.1e, V_0 %.1e, P %.1e, centre %.1e m, velocity %.1e m/s, jet %.1e, "
            "vertices %.1e m\n",
            c->name, order == BALLOON_ORDER_ENGINE ? "engine's" : "source's", d.volume, d.target, d.pressure,
            d.centre, d.velocity, d.impulse, balloon_distance( &flight, &oracle ) );
        bool same = order == BALLOON_ORDER_ENGINE;
        balloon_assert_close( d.volume, 0.0, same ? 1e-6 : 0.01 );
        balloon_assert_close( d.target, 0.0, same ? 1e-6 : 0.01 );
        balloon_assert_close( d.pressure, 0.0, same ? 1e-3 : 0.05 );
        balloon_assert_close( d.impulse, 0.0, same ? 1e-5 : 0.05 );
        // after moving 1.5 m at 2 m/s; a pear that turns in the air amplifies small differences
        balloon_assert_close( d.centre, 0.0, same ? 2e-4 : 0.1 );
        balloon_assert_close( d.velocity, 0.0, same ? 2e-3 : 0.3 );
    }
}

// ---- volume and gas ----

// P - P_atm of a static sphere in the three ways of section III.2
typedef struct settled
{
    double virial, multiplier, gas;
} settled;

static settled settled_pressures( const balloon_mesh* mesh, int substeps, int iterations )
{
    balloon_scene scene = balloon_scene_of( mesh );
    scene.area_density = 0.05f;
    scene.damping = 30.0f;
    scene.substeps = substeps;
    scene.iterations = iterations;
    scene.bend_links = false;
    scene.def.gas_ratio = 1.2f;
    SCOPED( balloon_end ) balloon_flight flight = balloon_start( &scene );
    balloon_steps( &flight, 30 );
    const wisp_balloon_stats f = balloon_read( &flight );
    const balloon_state* s = wisp_world_module_state( flight.world, "balloon" );
    const balloon_gas* gas = wisp_world_column( flight.world, flight.entity, s->gas, 0 );
    const double dt = (double)scene.dt / substeps;
    return ( settled ){ f.pressure, gas->lambda / ( dt * dt ), 101325.0 * ( f.target_volume - f.volume ) / f.volume };
}

// Pressures of a static sphere, computed in double and in another order of links. Its virial agrees within 1 % and
// its converged rows within 3 % in every reading, as for the oracle. Another percent is for floats: a volume of 0.017
// m^3 is exact to 1e-7, hence to 0.01 Pa, but links round to 1e-7 of lengths that strain by 6 %.
TEST( the_pressure_readings_agree_where_substeps_make_them )
{
    const struct
    {
        int substeps, iterations;
        settled reads;
    } row[] = { { 10, 10, { 2674, 918, 747 } },
                { 50, 1, { 2593, 1331, 1253 } },
                { 100, 1, { 2475, 2007, 2033 } },
                { 400, 1, { 2417, 2383, 2440 } } };
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = balloon_sphere( 1, 0.15 );
    for ( int n = 0; n < WISP_COUNT( row ); ++n )
    {
        const settled p = settled_pressures( &mesh, row[n].substeps, row[n].iterations );
        print_message( "           %3d x %2d: virial %.0f, multiplier %.0f, gas %.0f Pa\n", row[n].substeps,
                       row[n].iterations, p.virial, p.multiplier, p.gas );
        balloon_assert_fraction( p.virial, row[n].reads.virial, 0.01 );
        double allowed = row[n].substeps >= 100 ? 0.03 * 2410.0 : 100.0;
        balloon_assert_close( p.multiplier, row[n].reads.multiplier, allowed );
        balloon_assert_close( p.gas, row[n].reads.gas, allowed );
        if ( row[n].substeps == 400 )
        {
            balloon_assert_fraction( p.multiplier, p.virial, 0.05 );
            balloon_assert_fraction( p.gas, p.virial, 0.05 );
            balloon_assert_fraction( p.gas, p.multiplier, 0.05 );
        }
    }
}
