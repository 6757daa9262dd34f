// Sheets that slide down inclines, ropes over a rod, and bodies that fall or rise through air.
#include "validate/validate.h"

#include "surfaces.h"
#include "validate/validate_bodies.h"

#include "balloon/balloon.h"
#include "collision/collision.h"
#include "oracle/plate_theory.h"

#include <math.h>

// The spacing of a sheet 6 cm wide.
static double spacing_of( int cells )
{
    return 0.06 / cells;
}

static double speed_along( const wisp_motion_stats* motion, int axis )
{
    return motion->momentum[axis] / motion->mass;
}

// ---- inclines ----

enum
{
    INCLINES = 4,
    SLIDE_STEPS = 30, // 0.5 s
};

static const struct
{
    double degrees, friction;
} inclines[INCLINES] = { { 20.0, 0.2 }, { 40.0, 0.5 }, { 11.0, 0.2 }, { 26.0, 0.5 } };

// The ground stays level, and the gravity of each sheet is turned instead. Sheets start in contact.
static wisp_status lay_on_inclines( validate_bodies* b, wisp_error* error )
{
    const int cells = b->def.cells;
    wisp_mesh mesh = { .points = NULL };
    wisp_status status = surface_plane( cells + 1, cells + 1, spacing_of( cells ), &mesh, error );
    for ( int i = 0; i < mesh.vertex_count; ++i )
    {
        mesh.points[i].y = SHEET_MARGIN;
    }
    for ( int i = 0; i < INCLINES && status == WISP_OK; ++i )
    {
        const double angle = inclines[i].degrees * VALIDATE_PI / 180.0;
        const sheet_def def = {
            .solver = (sheet_solver)b->method,
            .mesh = &mesh,
            .row = cells + 1,
            .density = SHEET_DENSITY,
            .gravity = { (float)( SHEET_GRAVITY * sin( angle ) ), (float)( -SHEET_GRAVITY * cos( angle ) ), 0.0f },
            .friction = inclines[i].friction,
        };
        status = sheet_add( &b->world, &def, error );
    }
    wisp_mesh_release( &mesh );
    return status;
}

// In % of the speed without friction, so that a sheet that sticks has an error too.
static wisp_status measure_slides( validate_world* world, wisp_error* error )
{
    const double time = SLIDE_STEPS * (double)VALIDATE_STEP;
    double sum = 0.0;
    for ( int i = 0; i < INCLINES; ++i )
    {
        const double angle = inclines[i].degrees * VALIDATE_PI / 180.0;
        const double exact = time * sheet_slide( SHEET_GRAVITY, angle, inclines[i].friction );
        wisp_motion_stats motion = { 0 };
        WISP_TRY( validate_world_motion( world, i, &motion, error ) );
        const double speed = speed_along( &motion, 0 );
        const double wrong = ( speed - exact ) / ( time * sheet_slide( SHEET_GRAVITY, angle, 0.0 ) );
        // of those that slide the error in %, of those that stick how far they crept
        world->run->measures[i] = exact > 0.0 ? 100.0 * wrong : 1e3 * motion.centre[0];
        sum += wrong * wrong;
    }
    world->run->error = 100.0 * sqrt( sum / INCLINES );
    return WISP_OK;
}

static wisp_status play_incline( validate_bodies* b, wisp_error* error )
{
    WISP_TRY( sheet_world_create( b, true, error ) );
    WISP_TRY( lay_on_inclines( b, error ) );
    WISP_TRY( validate_step( b, SLIDE_STEPS, error ) );
    return b->world.is_observed ? measure_slides( &b->world, error ) : WISP_OK;
}

const validate_case validate_incline = {
    .name = "incline",
    .title = "sheets and strands on inclined planes with friction",
    .scene = { .reference = "Coulomb's law; root mean square over four inclines, after 0.5 s",
               .error_name = "error of speed",
               .error_unit = "% of no friction",
               .measure_names = { "20 deg, mu 0.2: error, %", "40 deg, mu 0.5: error, %", "11 deg, mu 0.2: creep, mm",
                                  "26 deg, mu 0.5: creep, mm" },
               .measure_count = INCLINES },
    .grid = { sheet_solver_names, 1 << SHEET_STRANDS | 1 << SHEET_XPBD | 1 << SHEET_IMPLICIT, .cells = { 2, 4, 8 },
              .cell = "cell / width", .substeps = 10, .middle = 4, .fewer = { 1, 2, 5, 20 },
              .starts_with_substeps = true },
    .play = play_incline,
};

// ---- a rope over a rod ----

// Ropes with rising friction lie on one rod, without tension yet, and are let go.

enum
{
    ROPES = 13,
};

static const double ROD = 0.1, ROPE_MARGIN = 0.003; // m
static const double ROPE_SLOW = 1.0;                // mm/s, of a rope that stays
static const double SETTLE_SECONDS = 1.0, CREEP_SECONDS = 0.5;

static const char* const split_names[] = { "60 : 40", "70 : 30", "80 : 20" };
static const double heavy_sides[] = { 0.6, 0.7, 0.8 }; // m, of 1 m that hangs

static double critical_friction( int split, double radius )
{
    return sheet_capstan( 1.0 - heavy_sides[split], heavy_sides[split], radius );
}

static wisp_status set_rope_friction( validate_bodies* b, double critical, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < ROPES && status == WISP_OK; ++i )
    {
        wisp_collision_def collision = wisp_default_collision_def();
        collision.thickness = (float)ROPE_MARGIN;
        collision.friction_scale = (float)( critical * validate_rung( i, ROPES ) );
        status = wisp_set_collision( b->world.world, b->world.bodies[i].entity, &collision );
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

// The last vertex is the heavy end.
static wisp_status hang_ropes( validate_bodies* b, double heavy, wisp_error* error )
{
    const double radius = ROD + ROPE_MARGIN, arc = VALIDATE_PI * radius;
    wisp_vec3 points[VALIDATE_MAX_CELLS + 1];
    for ( int i = 0; i <= b->def.cells; ++i )
    {
        const double s = ( 1.0 + arc ) * i / b->def.cells - ( 1.0 - heavy ),
                     turn = fmin( fmax( s, 0.0 ), arc ) / radius;
        const double below = fmax( -s, 0.0 ) + fmax( s - arc, 0.0 );
        points[i] = ( wisp_vec3 ){ (float)( -radius * cos( turn ) ), (float)( radius * sin( turn ) - below ), 0.0f };
    }
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.bending = WISP_STRAND_BEND_NONE;
    dynamics.free_roots = true;
    dynamics.line_density = 0.05f;
    dynamics.damping = 1.0f;
    dynamics.gravity = ( wisp_vec3 ){ 0.0f, (float)-SHEET_GRAVITY, 0.0f };
    wisp_collider_def rod = wisp_default_collider_def();
    rod.kind = WISP_COLLIDER_CAPSULE;
    rod.radius = (float)ROD;
    rod.half_length = 0.3f;
    rod.static_friction = rod.kinetic_friction = 1.0f;
    rod.pose.rotation = ( wisp_quat ){ sqrtf( 0.5f ), 0.0f, 0.0f, sqrtf( 0.5f ) };
    wisp_entity collider;
    const wisp_status status = wisp_add_collider( b->world.world, &rod, &collider );
    WISP_TRY( status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error ) );
    for ( int i = 0; i < ROPES; ++i )
    {
        WISP_TRY( validate_add_strands( b, 1, points, &dynamics, error ) );
    }
    return WISP_OK;
}

// Step, and read how far the heavy ends have come down, m.
static wisp_status slide_ropes( validate_bodies* b, double seconds, double* depths, wisp_error* error )
{
    WISP_TRY( validate_step_for( b, seconds, error ) );
    for ( int i = 0; i < ROPES; ++i )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        WISP_TRY( validate_tip( b, i, &tip, error ) );
        depths[i] = -(double)tip.y;
    }
    return WISP_OK;
}

// Creep is that of the fastest one beyond the first rope that stays.
static void measure_ropes( validate_bodies* b, double depths[2][ROPES] )
{
    accuracy_run* out = b->world.run;
    bool stays[ROPES];
    double creep = NAN;
    for ( int i = 0; i < ROPES; ++i )
    {
        const double speed = 1e3 * fabs( depths[1][i] - depths[0][i] ) / CREEP_SECONDS;
        stays[i] = speed < ROPE_SLOW;
        creep = i > 0 && stays[i - 1] ? fmax( creep, speed ) : creep;
    }
    validate_judge_ladder( b, stays, ROPES, critical_friction( b->method, ROD + ROPE_MARGIN ) );
    out->measures[2] = critical_friction( b->method, 0.0 );
    out->measures[3] = creep;
}

static wisp_status play_capstan( validate_bodies* b, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_strands_module, &wisp_collision_module };
    const bench_world_def def = { modules, WISP_COUNT( modules ), b->def.workers, b->def.substeps, 1 };
    double depths[2][ROPES];
    WISP_TRY( validate_world_create( &def, &b->world, error ) );
    WISP_TRY( hang_ropes( b, heavy_sides[b->method], error ) );
    WISP_TRY( set_rope_friction( b, critical_friction( b->method, ROD + ROPE_MARGIN ), error ) );
    WISP_TRY( slide_ropes( b, SETTLE_SECONDS, depths[0], error ) );
    WISP_TRY( slide_ropes( b, CREEP_SECONDS, depths[1], error ) );
    measure_ropes( b, depths );
    return WISP_OK;
}

const validate_case validate_capstan = {
    .name = "capstan",
    .title = "ropes over a rod stick by their own tension, or slide",
    .scene = { .reference = "the law of the capstan with the weight of the rope on the rod",
               .error_name = "distance of the critical friction",
               .error_unit = "%",
               .measure_names = { "measured mu", "theory mu", "theory without weight on the rod",
                                  "creep above it, mm/s" },
               .measure_count = 4,
               .note = "Expected are 10 % with 10 substeps, 20 % with 4, and a creep below 0.1 mm/s, which 4 "
                       "substeps miss: known." },
    .rungs = ROPES,
    .grid = { split_names, ( 1 << WISP_COUNT( split_names ) ) - 1, .cells = { 34, 67 }, .substeps = 10, .middle = 67,
              .fewer = { 4, 40 } },
    .play = play_capstan,
};

// ---- air ----

static const double PLATE_DRAG = 1.28, BALL_DRAG = 0.5;

// What theory knows of a body: terminal speed, and acceleration without air.
typedef struct flight
{
    double terminal, acceleration;
} flight;

// Plates and strands by their area; a balloon by its volume, m^3, as a sphere. Its gas has weight but, as the engine documents, no
// inertia.
static flight flight_of( sheet_solver solver, double volume )
{
    const double g = SHEET_GRAVITY;
    if ( solver != SHEET_BALLOON )
    {
        const flight falls = { sheet_terminal_speed( SHEET_DENSITY * g, (double)SHEET_AIR, PLATE_DRAG, 1.0 ), g };
        return falls;
    }
    const wisp_balloon_def def = wisp_default_balloon_def();
    const double gas = 8.31446262 * (double)def.temperature;
    const double air = (double)def.atmospheric_pressure * (double)def.air_molar_mass / gas;
    const double helium = (double)def.atmospheric_pressure * (double)def.gas_molar_mass / gas;
    const double rest = (double)BALLOON_RADIUS, skin = (double)BALLOON_AREA_DENSITY * 4.0 * VALIDATE_PI * rest * rest;
    const double r = cbrt( volume / ( 4.0 / 3.0 * VALIDATE_PI ) ), lift = g * ( ( air - helium ) * volume - skin );
    const flight rises = { sheet_terminal_speed( lift, air, BALL_DRAG, VALIDATE_PI * r * r ), lift / skin };
    return rises;
}

static wisp_status let_go( validate_bodies* b, wisp_error* error )
{
    const int cells = b->def.cells;
    const bool is_ball = b->method == SHEET_BALLOON;
    wisp_mesh mesh = { .points = NULL };
    wisp_status status = is_ball ? balloon_mesh_sphere( (int)lrint( log2( cells ) ), BALLOON_RADIUS, &mesh, error )
                                 : surface_plane( cells + 1, cells + 1, spacing_of( cells ), &mesh, error );
    if ( status == WISP_OK )
    {
        const sheet_def def = {
            .solver = (sheet_solver)b->method,
            .mesh = &mesh,
            .row = cells + 1,
            .density = is_ball ? (double)BALLOON_AREA_DENSITY : SHEET_DENSITY,
            .gravity = { 0.0f, (float)-SHEET_GRAVITY, 0.0f },
            .friction = -1.0,
            .drag = is_ball ? BALL_DRAG : PLATE_DRAG,
        };
        status = sheet_add( &b->world, &def, error );
    }
    wisp_mesh_release( &mesh );
    return status;
}

// Step to a time, in time constants, and compare the speed with theory, in % of the terminal speed.
// @param wrong NaN while it is not observed
static wisp_status fly_to( validate_bodies* b, double constants, double* wrong, wisp_error* error )
{
    validate_world* world = &b->world;
    const sheet_solver solver = (sheet_solver)b->method;
    const flight planned = flight_of( solver, 4.0 / 3.0 * VALIDATE_PI * pow( (double)BALLOON_RADIUS, 3.0 ) );
    const int steps = (int)lrint( constants * planned.terminal / planned.acceleration / (double)VALIDATE_STEP );
    *wrong = NAN;
    WISP_TRY( validate_world_step( world, steps - world->steps, error ) );
    if ( world->is_observed )
    {
        wisp_motion_stats motion = { 0 };
        WISP_TRY( validate_world_motion( world, 0, &motion, error ) );
        const flight exact = flight_of( solver, motion.volume );
        const double speed = fabs( speed_along( &motion, 1 ) );
        const double time = steps * (double)VALIDATE_STEP;
        *wrong = 100.0 * ( speed - sheet_fall_speed( exact.terminal, exact.acceleration, time ) ) / exact.terminal;
        world->run->measures[2] = speed;
        world->run->measures[3] = exact.terminal;
    }
    return WISP_OK;
}

static wisp_status play_terminal( validate_bodies* b, wisp_error* error )
{
    double* wrong = b->world.run->measures; // early, late
    WISP_TRY( sheet_world_create( b, false, error ) );
    WISP_TRY( let_go( b, error ) );
    WISP_TRY( fly_to( b, 1.0, wrong, error ) );
    WISP_TRY( fly_to( b, 8.0, wrong + 1, error ) );
    b->world.run->error = fmax( fabs( wrong[0] ), fabs( wrong[1] ) );
    return WISP_OK;
}

// A plate is flat on any mesh, but a ball is round on a fine one.
static void put_balls( accuracy_scene* out )
{
    static const int cells[] = { 2, 4, 8, 16, 0 };
    validate_put_cells( out, SHEET_BALLOON, sheet_solver_names[SHEET_BALLOON], "cell / edge of an icosahedron", cells,
                        40 );
}

const validate_case validate_terminal = {
    .name = "terminal_velocity",
    .title = "sheets and strands fall, and a balloon rises, through air",
    .scene = { .reference = "v = w tanh(a t / w); the larger error of two times, one and eight w / a",
               .error_name = "error of speed",
               .error_unit = "% of w",
               .measure_names = { "after w / a, %", "after 8 w / a, %", "speed then, m/s", "theory w, m/s" },
               .measure_count = 4 },
    .grid = { sheet_solver_names, 1 << SHEET_STRANDS | 1 << SHEET_XPBD | 1 << SHEET_BALLOON, .middle = 8,
              .fewer = { 1, 2, 5, 20, 80 } },
    .put = put_balls,
    .play = play_terminal,
};

// ---- the catenary ----

// A strip of one row of cells, or a strand, hung between two supports: its rest is the catenary.

#define SPAN 0.8 // m, of a strip of 1 m

enum
{
    MAX_CELLS = 64,
    CATENARY_STEPS = 240, // some 20 periods of the slowest swing, with its critical damping
};

static const double CATENARY_DAMPING = 12.0; // 1/s

// Distances from the point of the curve at the same arc length, in % of the span.
static void compare_catenary( const wisp_vec3* points, int count, int cells, accuracy_run* out )
{
    double sum = 0.0, lowest = 0.0;
    for ( int v = 0; v < count; ++v )
    {
        double exact[2];
        sheet_catenary( SPAN, (double)( v % ( cells + 1 ) ) / cells, exact );
        const double x = (double)points[v].x - exact[0], y = (double)points[v].y - exact[1];
        sum += x * x + y * y;
        lowest = fmin( lowest, (double)points[v].y );
    }
    double middle[2];
    sheet_catenary( SPAN, 0.5, middle );
    out->error = 100.0 * sqrt( sum / count ) / SPAN;
    out->measures[0] = -100.0 * lowest;
    out->measures[1] = -100.0 * middle[1];
}

static wisp_status measure_catenary( validate_bodies* b, wisp_error* error )
{
    const wisp_vec3* points = NULL;
    wisp_motion_stats motion = { 0 };
    WISP_TRY( validate_world_points( &b->world, 0, &points, error ) );
    WISP_TRY( validate_world_motion( &b->world, 0, &motion, error ) );
    compare_catenary( points, b->world.bodies[0].vertex_count, b->def.cells, b->world.run );
    b->world.run->measures[2] = 100.0 * motion.strain_max;
    b->world.run->measures[3] = 1e3 * motion.speed_max;
    return WISP_OK;
}

// Half of the strip over half of the span, a right triangle.
static void lay_halves( const wisp_mesh* mesh, int cells, wisp_vec3* out )
{
    const double depth = sqrt( 0.25 - 0.25 * SPAN * SPAN );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        const double t = (double)( v % ( cells + 1 ) ) / cells;
        out[v] = ( wisp_vec3 ){ (float)( SPAN * ( t - 0.5 ) ), (float)( -2.0 * depth * fmin( t, 1.0 - t ) ),
                                mesh->points[v].z };
    }
}

static wisp_status hang_between( validate_bodies* b, wisp_error* error )
{
    const int cells = b->def.cells;
    const int32_t pins[] = { 0, cells, cells + 1, 2 * cells + 1 };
    wisp_mesh mesh = { .points = NULL };
    wisp_vec3 start[2 * ( MAX_CELLS + 1 )];
    wisp_status status = surface_plane( cells + 1, 2, 1.0 / cells, &mesh, error );
    if ( status == WISP_OK )
    {
        lay_halves( &mesh, cells, start );
        const sheet_def def = {
            .solver = (sheet_solver)b->method,
            .mesh = &mesh,
            .row = cells + 1,
            .start = start,
            .pins = pins,
            .pin_count = WISP_COUNT( pins ),
            .density = SHEET_DENSITY,
            .damping = CATENARY_DAMPING,
            .gravity = { 0.0f, (float)-SHEET_GRAVITY, 0.0f },
            .friction = -1.0,
        };
        status = sheet_add( &b->world, &def, error );
    }
    wisp_mesh_release( &mesh );
    return status;
}

static wisp_status play_catenary( validate_bodies* b, wisp_error* error )
{
    WISP_TRY( sheet_world_create( b, false, error ) );
    WISP_TRY( hang_between( b, error ) );
    WISP_TRY( validate_step( b, CATENARY_STEPS, error ) );
    return b->world.is_observed ? measure_catenary( b, error ) : WISP_OK;
}

const validate_case validate_catenary = {
    .name = "catenary",
    .title = "strips and strands hang between two supports",
    .scene = { .reference = "the catenary; root mean square over vertices, after 4 s",
               .error_name = "distance from the catenary",
               .error_unit = "% of span",
               .measure_names = { "sag, % of L", "theory", "largest strain, %", "speed left, mm/s" },
               .measure_count = 4 },
    .grid = { sheet_solver_names, 1 << SHEET_STRANDS | 1 << SHEET_XPBD | 1 << SHEET_IMPLICIT,
              .cells = { 8, 16, 32, 64 }, .substeps = 32, .middle = 32, .fewer = { 16, 8, 4 } },
    .play = play_catenary,
};
