// The passes of a substep of strands are fused where no other pass runs between them (fusion "strands.substeps").
// Every bit must be as if they ran one after another: the same strands run in a world where a pass of another module
// prevents the fusion.
#include "modules/strands_fixture.h"

#include "wisp/explain.h"
#include "wisp/module/module.h"

#define SECONDS ( 1.0f / 60.0f )

enum
{
    STRANDS = 75, // five groups: two pairs and one alone
    STEPS = 20,   // so that each substep is timed at least once
};

// ---- a pass of another module ----

static wisp_component stranger_mark;

static void do_nothing( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)frame, (void)span, (void)user;
}

static wisp_status declare_stranger( wisp_registry* r )
{
    static const wisp_column_def columns[] = { { "value", 4 } };
    stranger_mark =
        wisp_declare_component( r, &( wisp_component_def ){ "stranger.mark", WISP_TABLE_STRAND_GROUP, columns, 1 } );
    const wisp_pass pass = {
        WISP_PASS( "stranger.pass", FORCE, STRAND_GROUP, do_nothing ),
        .writes = { stranger_mark },
    };
    return wisp_declare_pass( r, &pass );
}

static const wisp_module stranger_module = { .name = "stranger", .declare = declare_stranger };

// ---- cases ----

typedef struct shape_case
{
    const char* name;
    wisp_strand_bend bend;
    wisp_solver solver;
    int substeps, passes;
    bool mixed_lengths, with_pins, damped, blown, heavy_tips, short_strands, on_surface, loses_surface, jumps, tight;
    bool curled, bdf2;
} shape_case;

static const shape_case CASES[] = {
    { "alone", .bend = WISP_STRAND_BEND_NONE, .substeps = 10, .passes = 8 },
    { "links, xpbd", .bend = WISP_STRAND_BEND_LINKS, .solver = WISP_SOLVER_XPBD, .substeps = 10, .passes = 8 },
    { "links, pbd", .bend = WISP_STRAND_BEND_LINKS, .solver = WISP_SOLVER_PBD, .substeps = 10, .passes = 8 },
    { "one substep", .bend = WISP_STRAND_BEND_LINKS, .substeps = 1, .passes = 8 },
    { "two substeps, one pass", .bend = WISP_STRAND_BEND_LINKS, .substeps = 2, .passes = 1 },
    { "mixed lengths", .bend = WISP_STRAND_BEND_LINKS, .substeps = 4, .mixed_lengths = true, .passes = 8 },
    { "strands of one to three vertices", .bend = WISP_STRAND_BEND_LINKS, .substeps = 4, .short_strands = true,
      .passes = 8 },
    { "pins", .bend = WISP_STRAND_BEND_LINKS, .substeps = 5, .with_pins = true, .passes = 8 },
    { "damping", .bend = WISP_STRAND_BEND_LINKS, .substeps = 5, .damped = true, .passes = 8 },
    { "air", .bend = WISP_STRAND_BEND_LINKS, .substeps = 5, .blown = true, .passes = 8 },
    { "damping and air", .bend = WISP_STRAND_BEND_NONE, .substeps = 5, .damped = true, .blown = true, .passes = 8 },
    { "laid out", .bend = WISP_STRAND_BEND_NONE, .substeps = 3, .passes = 1, .heavy_tips = true, .tight = true },
    { "on a surface", .bend = WISP_STRAND_BEND_LINKS, .substeps = 5, .on_surface = true, .passes = 8 },
    { "on a surface, damped", .bend = WISP_STRAND_BEND_LINKS, .substeps = 5, .on_surface = true, .damped = true,
      .passes = 8 },
    { "on a surface that is removed", .bend = WISP_STRAND_BEND_LINKS, .substeps = 5, .on_surface = true,
      .loses_surface = true, .passes = 8 },
    { "rods", .bend = WISP_STRAND_BEND_ROD, .substeps = 5, .passes = 8 },
    { "rods, mixed lengths", .bend = WISP_STRAND_BEND_ROD, .substeps = 4, .mixed_lengths = true, .passes = 8 },
    { "rods, damping and air", .bend = WISP_STRAND_BEND_ROD, .substeps = 5, .damped = true, .blown = true,
      .passes = 8 },
    { "rods of one to three vertices", .bend = WISP_STRAND_BEND_ROD, .substeps = 4, .short_strands = true,
      .passes = 8 },
    { "rods with pins", .bend = WISP_STRAND_BEND_ROD, .substeps = 5, .with_pins = true, .passes = 8 },
    { "curls", .bend = WISP_STRAND_BEND_ROD, .curled = true, .substeps = 5, .passes = 8 },
    { "curls on a surface", .bend = WISP_STRAND_BEND_ROD, .curled = true, .substeps = 5, .on_surface = true,
      .passes = 8 },
    { "curls on a head that jumps", .bend = WISP_STRAND_BEND_ROD, .curled = true, .substeps = 5, .jumps = true,
      .passes = 8 },
    { "a head that jumps", .bend = WISP_STRAND_BEND_LINKS, .substeps = 5, .jumps = true, .passes = 8 },
    { "bdf2", .bend = WISP_STRAND_BEND_NONE, .substeps = 5, .passes = 8, .bdf2 = true },
    { "bdf2, one substep", .bend = WISP_STRAND_BEND_LINKS, .substeps = 1, .passes = 8, .bdf2 = true },
    { "bdf2, links, xpbd", .bend = WISP_STRAND_BEND_LINKS, .solver = WISP_SOLVER_XPBD, .substeps = 5, .passes = 8,
      .bdf2 = true, .mixed_lengths = true },
    { "bdf2, pins, damping and air", .bend = WISP_STRAND_BEND_LINKS, .substeps = 5, .with_pins = true, .damped = true,
      .blown = true, .passes = 8, .bdf2 = true },
    { "bdf2, laid out", .bend = WISP_STRAND_BEND_NONE, .substeps = 3, .passes = 1, .heavy_tips = true, .tight = true,
      .bdf2 = true },
    { "bdf2, rods on a surface", .bend = WISP_STRAND_BEND_ROD, .substeps = 5, .on_surface = true, .damped = true,
      .passes = 8, .bdf2 = true },
    { "bdf2, curls on a head that jumps", .bend = WISP_STRAND_BEND_ROD, .curled = true, .substeps = 5, .jumps = true,
      .passes = 8, .bdf2 = true },
};

typedef struct run
{
    hosted s;
    wisp_entity strands, surface;
    test_mesh mesh;
    int vertex_count;
} run;

static void open_with_stranger( run* r, const shape_case* c, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module,
                                                  &wisp_strand_appearance_module, &wisp_strands_module,
                                                  &stranger_module };
    *r = ( run ){ 0 };
    prepare_strands( &r->s, MODULES, WISP_COUNT( MODULES ) );
    r->s.def.workers = workers;
    r->s.def.substeps = c->substeps;
    open_prepared( &r->s );
}

static wisp_strand_dynamics_def def_of( const shape_case* c, const int32_t* pins, int pin_count, const float* masses )
{
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    def.bending = c->bend;
    def.integrator = c->bdf2 ? WISP_INTEGRATOR_BDF2 : WISP_INTEGRATOR_EULER;
    def.rest = c->curled ? WISP_STRAND_REST_SHAPE : WISP_STRAND_REST_STRAIGHT;
    def.clamped = c->curled;
    def.solver = c->solver;
    def.bend_compliance = 1e3f;
    def.stretch_passes = c->passes;
    def.stretch_tolerance = c->tight ? 1e-6f : def.stretch_tolerance;
    def.pins = c->with_pins ? pins : NULL;
    def.pin_count = c->with_pins ? pin_count : 0;
    def.vertex_masses = c->heavy_tips ? masses : NULL;
    def.damping = c->damped ? 3.0f : 0.0f;
    def.drag_coefficient = c->blown ? 1.0f : 0.0f;
    def.wind = ( wisp_vec3 ){ 1.0f, 0.5f, 2.0f };
    return def;
}

static void add_case( run* r, const shape_case* c, bool apart )
{
    int counts[STRANDS];
    float masses[STRANDS * 40];
    int32_t pins[STRANDS];
    for ( int s = 0; s < STRANDS; ++s )
    {
        counts[s] = c->mixed_lengths ? 2 + s % 17 : c->short_strands ? 1 + s % 3 : 12;
        pins[s] = r->vertex_count + ( counts[s] > 4 ? 4 + s % 3 : 0 );
        for ( int v = 0; v < counts[s]; ++v )
        {
            masses[r->vertex_count++] = v + 1 == counts[s] ? 1.0f : 1e-6f;
        }
    }
    r->strands = add_strands( r->s.world, counts, STRANDS, curl_down, 0.1f );
    const wisp_strand_dynamics_def def = def_of( c, pins, STRANDS, masses );
    if ( wisp_set_strand_dynamics( r->s.world, r->strands, &def ) != WISP_OK )
    {
        fail_msg( "%s: %s", c->name, wisp_world_message( r->s.world ) );
    }
    assert_int_equal( wisp_request( r->s.world, r->strands, WISP_STRAND_POINTS ), WISP_OK );
    if ( c->on_surface )
    {
        r->mesh = test_plane( 5, 0.05f );
        const wisp_fabric_def fabric = test_fabric_def( &r->mesh );
        r->surface = test_surface_of( r->s.world, &fabric, support_weightless_surface_def() );
        assert_int_equal( wisp_root_strands( r->s.world, r->strands, r->surface ), WISP_OK );
        assert_int_equal( wisp_request( r->s.world, r->surface, WISP_SURFACE_POINTS ), WISP_OK );
        assert_int_equal( wisp_set_gravity( r->s.world, r->surface, ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f } ), WISP_OK );
    }
    if ( apart )
    {
        assert_int_equal( wisp_request( r->s.world, r->strands, stranger_mark ), WISP_OK );
    }
}

static void one_step( run* r, const shape_case* c, int n )
{
    const float t = SECONDS * (float)( n + 1 );
    const wisp_vec3 place = { 0.1f * t + ( c->jumps && n > 5 ? 30.0f : 0.0f ), -0.3f * t, 0.0f };
    if ( c->loses_surface && n == STEPS / 2 )
    {
        assert_int_equal( wisp_remove( r->s.world, r->surface ), WISP_OK );
    }
    if ( c->on_surface == false )
    {
        assert_int_equal( wisp_move_strand_head( r->s.world, r->strands,
                                                 head_at( 2.0f * t, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, place ) ),
                          WISP_OK );
    }
    strand_steps( r->s.world, 1, SECONDS );
}

static bool is_together( run* r )
{
    return plan_says( r->s.world, "strands.predict", "(in strands.substeps)" );
}

static void close_run( run* r )
{
    test_mesh_free( &r->mesh );
    close_world( &r->s );
}

static void compare_rows( run* a, run* b, wisp_component component, const char* name, int step )
{
    const size_t bytes =
        (size_t)wisp_world_strands( a->s.world, a->strands )->row_count * 3 * WISP_LANES * sizeof( float );
    if ( memcmp( wisp_world_column( a->s.world, a->strands, component, 0 ),
                 wisp_world_column( b->s.world, b->strands, component, 0 ), bytes ) != 0 )
    {
        fail_msg( "%s: component %d differs behind step %d", name, (int)component, step );
    }
}

TEST( every_bit_is_as_if_passes_ran_one_after_another )
{
    uint64_t laid = 0;
    for ( int n = 0; n < WISP_COUNT( CASES ); ++n )
    {
        const shape_case* c = CASES + n;
        for ( int workers = 1; workers <= 2; ++workers )
        {
            run together, apart;
            open_with_stranger( &together, c, workers );
            open_with_stranger( &apart, c, 1 );
            add_case( &together, c, false );
            add_case( &apart, c, true );
            assert_true( is_together( &together ) );
            assert_false( is_together( &apart ) );
            for ( int i = 0; i < STEPS; ++i )
            {
                one_step( &together, c, i );
                one_step( &apart, c, i );
                compare_rows( &together, &apart, WISP_STRAND_POSITION, c->name, i );
                compare_rows( &together, &apart, WISP_STRAND_VELOCITY, c->name, i );
                float own[STRANDS * 40], other[STRANDS * 40];
                assert_int_equal( wisp_read_strand_tension( together.s.world, together.strands, own ), WISP_OK );
                assert_int_equal( wisp_read_strand_tension( apart.s.world, apart.strands, other ), WISP_OK );
                assert_memory_equal( own, other, (size_t)together.vertex_count * sizeof( float ) );
            }
            const uint64_t counted = wisp_world_counter( together.s.world, WISP_COUNT_STRAND_RESET );
            assert_true( counted == wisp_world_counter( apart.s.world, WISP_COUNT_STRAND_RESET ) );
            assert_int_equal( wisp_world_counter( together.s.world, WISP_COUNT_HALTED ), 0 );
            laid += counted;
            close_run( &together );
            close_run( &apart );
        }
    }
    assert_true( laid > 0 );
}

// What the guard takes as checked in the loop must have been checked there; where the last substep is timed, nothing
// was.
TEST( what_leaves_its_bounds_is_put_back_all_the_same )
{
    const shape_case two_substeps = { "two substeps", .bend = WISP_STRAND_BEND_LINKS, .substeps = 2, .passes = 8 };
    for ( int k = 0; k < 2 * 8; ++k )
    {
        run r;
        open_with_stranger( &r, &two_substeps, 1 );
        add_case( &r, &two_substeps, k % 2 == 1 );
        assert_true( is_together( &r ) == ( k % 2 == 0 ) );
        strand_steps( r.s.world, 2 + k / 2, SECONDS );
        wisp_vec3 before[STRANDS * 12];
        memcpy( before, strand_points( r.s.world, r.strands ), sizeof( before ) );
        const wisp_strand_topology* t = wisp_world_strands( r.s.world, r.strands );
        float* velocity = wisp_world_column( r.s.world, r.strands, WISP_STRAND_VELOCITY, 0 );
        for ( int g = 3; g > 0; g -= 2 )
        {
            velocity[(size_t)( t->group_row[g] + 7 ) * 3 * WISP_LANES + 5] = NAN;
        }
        strand_steps( r.s.world, 1, SECONDS );
        assert_true( wisp_is_halted( r.s.world, r.strands ) );
        assert_memory_equal( strand_points( r.s.world, r.strands ), before, sizeof( before ) );
        char first[40];
        snprintf( first, sizeof( first ), "strand %d, vertex", t->lane_strand[WISP_LANES + 5] );
        assert_non_null( strstr( r.s.log.last, first ) );
        assert_int_equal( wisp_resume( r.s.world, r.strands ), WISP_OK );
        strand_steps( r.s.world, 5, SECONDS );
        assert_false( wisp_is_halted( r.s.world, r.strands ) );
        close_run( &r );
    }
}

TEST( contacts_and_other_lengths_run_apart )
{
    for ( int k = 0; k < 3; ++k )
    {
        hosted s;
        open_strands( &s, 4, k == 2 ? 2 : 1, 1 );
        wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
        def.bending = WISP_STRAND_BEND_LINKS;
        def.stretch = k == 0 ? WISP_STRAND_STRETCH_LINKS : WISP_STRAND_STRETCH_DIRECT;
        const wisp_entity e = add_moving( s.world, 20, 8, straight_down, 0.1f, &def );
        if ( k == 1 )
        {
            const wisp_collision_def collision = wisp_default_collision_def();
            const wisp_collider_def ball = wisp_default_collider_def();
            wisp_entity collider;
            assert_int_equal( wisp_add_collider( s.world, &ball, &collider ), WISP_OK );
            assert_int_equal( wisp_set_collision( s.world, e, &collision ), WISP_OK );
        }
        strand_steps( s.world, 1, SECONDS );
        assert_false( plan_says( s.world, "strands.predict", "strands.substeps" ) );
        close_world( &s );
    }
}
