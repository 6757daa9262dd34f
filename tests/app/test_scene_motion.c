// Moving strands, ghosts, scattered strands and curves in scenes: every key sets its field, and missing keys have
// their defaults.
#define _XOPEN_SOURCE 700

#include "scene_fixture.h"

// ---- missing keys ----

TEST( strands_stand_still_and_are_shown_unless_they_say_otherwise )
{
    wisp_scene scene = parsed( "wisp: 1\nstrands:\n  - { name: hair, generate: {} }\n" );
    const wisp_scene_strands* s = &scene.strands[0];
    assert_false( s->has_dynamics || s->has_head || s->has_grid || s->has_ghosts || s->is_scattered || s->is_curves );
    assert_int_equal( s->on_surface, -1 );
    assert_int_equal( s->targets, -1 );
    assert_int_equal( s->curves_of, -1 );
    assert_int_equal( s->scatter.around, -1 );
    assert_int_equal( s->scatter.count, 4 ); // ghosts per target
    assert_true( s->is_shown );
    assert_true( s->scale == 1.0f );
    wisp_scene_release( &scene );
}

TEST( dynamics_without_keys_are_the_modules_defaults_under_the_gravity_of_the_scene )
{
    wisp_scene scene =
        parsed( "wisp: 1\nstrands:\n  - { name: hair, generate: {}, dynamics: {} }\ngravity: [0, -1, 2]\n" );
    const wisp_strand_dynamics_def* def = &scene.strands[0].dynamics;
    const wisp_strand_dynamics_def expected = wisp_default_strand_dynamics_def();
    assert_true( scene.strands[0].has_dynamics );
    assert_vector( def->gravity, 0, -1, 2 );
    assert_true( def->stretch == expected.stretch && def->bending == expected.bending && def->rest == expected.rest );
    assert_true( def->bend_rigidity == expected.bend_rigidity && def->line_density == expected.line_density );
    assert_true( def->clamped == expected.clamped && def->diameter == expected.diameter );
    assert_int_equal( def->stretch_passes, expected.stretch_passes );
    assert_int_equal( def->size, expected.size );
    assert_null( def->pins );
    assert_null( def->vertex_masses );
    wisp_scene_release( &scene );
}

TEST( ghosts_and_curves_without_keys_are_the_modules_defaults )
{
    wisp_scene scene = parsed( "wisp: 1\nstrands:\n  - { name: guides, generate: {}, dynamics: {}, grid: {} }\n"
                               "  - { name: ghosts, generate: {}, ghosts: { targets: guides } }\n"
                               "  - { name: drawn, curves: { of: ghosts } }\n" );
    wisp_ghosts_def ghosts = wisp_default_ghosts_def();
    wisp_curves_def curves = wisp_default_curves_def();
    wisp_strand_grid_def grid = wisp_default_strand_grid_def();
    assert_true( scene.strands[0].grid.enabled && scene.strands[0].grid.cell_size == grid.cell_size );
    assert_true( scene.strands[0].grid.friction == grid.friction );
    assert_int_equal( scene.strands[0].grid.size, grid.size );
    assert_int_equal( scene.strands[1].ghosts.target_count, ghosts.target_count );
    assert_true( scene.strands[1].ghosts.tip_gain == ghosts.tip_gain );
    assert_int_equal( scene.strands[1].ghosts.size, ghosts.size );
    assert_int_equal( scene.strands[2].curves.kind, curves.kind );
    assert_int_equal( scene.strands[2].curves.samples, curves.samples );
    assert_int_equal( scene.strands[2].curves.size, curves.size );
    wisp_scene_release( &scene );
}

// ---- given keys ----

static const char EVERY_KEY[] =
    "wisp: 1\nsteps: 9\ndt: 0.5\n"
    "events: [ { step: 3, strands: hair, wind: [7, 8, 9] }, { step: 3, surface: cloth, velocity: [1, 0, 0] } ]\n"
    "strands:\n"
    "  - name: hair\n"
    "    generate: { dimension: 2, strands: 2, vertices: 3 }\n"
    "    transform: { scale: 2, translate: [1, 2, 3], rotate: { axis: [0, 0, 1], degrees: 180 } }\n"
    "    dynamics: { stretch: links, stretch_passes: 5, stretch_tolerance: 0.25, integrator: bdf2, bending: "
    "bend_links, "
    "bend_rigidity: 1, twist_rigidity: 2, bend_damping: 3, rest: straight, clamped: false, solver: pbd, "
    "stretch_compliance: 4, bend_compliance: 5, stretch_stiffness: 0.25, bend_stiffness: 0.75, line_density: 6, "
    "vertex_masses: [1, 2, 3, 4, 5, 6], pins: [2, 5], gravity: [1, 2, 3], damping: 7, wind: [4, 5, 6], "
    "air_density: 8, drag_coefficient: 9, diameter: 10, teleport: 11 }\n"
    "    head: { pivot: [1, 1, 1], keyframes: [ { time: 1, position: [2, 0, 0], rotation: { axis: [0, 0, 1], "
    "degrees: "
    "180 } }, { time: 2, position: [3, 0, 0] } ] }\n"
    "    grid: { cell_size: 0.5, friction: 0.25, repulsion: 12 }\n"
    "    collision: { thickness: 0.5, friction_scale: 0.25, max_push_out_speed: 2, mask: [0, 3] }\n    compute: "
    "[motion_stats, "
    "collision_stats, strain, speed]\n    show: true\n"
    "  - name: ghosts\n"
    "    scatter: { around: hair, count: 3, radius: 0.125, seed: 18446744073709551615 }\n"
    "    ghosts: { targets: hair, target_count: 2, resample: true, elastic: off, tip_gain: 1, centre_gain: 2, time: "
    "3, "
    "spread: 4, repair_length: true }\n"
    "    frozen_hair: { freeze: { stretch_stiffness: [1, 2, 3, 4, 5, 6] } }\n"
    "  - name: drawn\n    curves: { of: ghosts, kind: bezier, samples: 6 }\n    show: false\n"
    "  - { name: rooted, generate: {}, dynamics: { vertex_mass: 13 }, on_surface: cloth }\n"
    "surfaces: [ { name: other, generate: { shape: plane } }, { name: cloth, generate: { shape: plane } } ]\n";

static void assert_dynamics( const wisp_strand_dynamics_def* d )
{
    assert_int_equal( d->stretch, WISP_STRAND_STRETCH_LINKS );
    assert_int_equal( d->bending, WISP_STRAND_BEND_LINKS );
    assert_int_equal( d->rest, WISP_STRAND_REST_STRAIGHT );
    assert_int_equal( d->solver, WISP_SOLVER_PBD );
    assert_int_equal( d->stretch_passes, 5 );
    assert_int_equal( d->integrator, WISP_INTEGRATOR_BDF2 );
    assert_false( d->clamped );
    assert_true( d->stretch_tolerance == 0.25f && d->bend_rigidity == 1.0f );
    assert_true( d->twist_rigidity == 2.0f && d->bend_damping == 3.0f && d->stretch_compliance == 4.0f );
    assert_true( d->bend_compliance == 5.0f && d->stretch_stiffness == 0.25f && d->bend_stiffness == 0.75f );
    assert_true( d->line_density == 6.0f && d->damping == 7.0f && d->air_density == 8.0f &&
                 d->drag_coefficient == 9.0f );
    assert_true( d->diameter == 10.0f && d->teleport == 11.0f );
    assert_vector( d->gravity, 1, 2, 3 );
    assert_vector( d->wind, 4, 5, 6 );
    assert_int_equal( d->pin_count, 2 );
    assert_int_equal( d->pins[0], 2 );
    assert_int_equal( d->pins[1], 5 );
    for ( int v = 0; v < 6; ++v )
    {
        assert_true( d->vertex_masses[v] == (float)( v + 1 ) );
    }
}

static void assert_ghosts( const wisp_ghosts_def* g )
{
    assert_int_equal( g->target_count, 2 );
    assert_int_equal( g->elastic, WISP_GHOST_ELASTIC_OFF );
    assert_true( g->resample && g->repair_length );
    assert_true( g->tip_gain == 1.0f && g->centre_gain == 2.0f && g->time == 3.0f && g->spread == 4.0f );
}

TEST( every_key_of_motion_reaches_its_place )
{
    wisp_scene scene = parsed( EVERY_KEY );
    const wisp_scene_strands *hair = &scene.strands[0], *ghosts = &scene.strands[1], *drawn = &scene.strands[2];
    assert_dynamics( &hair->dynamics );
    assert_int_equal( hair->mass_count, 6 );
    assert_true( hair->scale == 2.0f && fabsf( hair->pose.rotation.z ) == 1.0f );
    assert_vector( hair->pose.translation, 1, 2, 3 );
    assert_true( hair->has_head && hair->has_head_pivot && hair->head.count == 2 );
    assert_vector( hair->head_pivot, 1, 1, 1 );
    assert_vector( hair->head.poses[1].pose.translation, 3, 0, 0 );
    // a missing turn is that of the previous keyframe
    assert_memory_equal( &hair->head.poses[0].pose.rotation, &hair->head.poses[1].pose.rotation,
                         sizeof( wisp_quat ) );
    assert_true( hair->has_grid && hair->grid.cell_size == 0.5f && hair->grid.friction == 0.25f &&
                 hair->grid.repulsion == 12.0f );
    assert_true( hair->has_collision && hair->collision.thickness == 0.5f &&
                 hair->collision.friction_scale == 0.25f );
    assert_true( hair->collision.max_push_out_speed == 2.0f && hair->collision.mask == 9u && hair->request_contacts );
    assert_true( hair->request_strain && hair->request_speed && hair->request_motion_stats && !hair->request_points );

    assert_true( ghosts->is_scattered && ghosts->scatter.around == 0 && ghosts->scatter.count == 3 );
    assert_true( ghosts->scatter.radius == 0.125f && ghosts->scatter.seed == UINT64_MAX );
    assert_true( ghosts->has_ghosts && ghosts->targets == 0 && ghosts->stretch_count == 6 );
    assert_ghosts( &ghosts->ghosts );

    assert_true( drawn->is_curves && drawn->curves_of == 1 && drawn->curves.kind == WISP_CURVE_BEZIER );
    assert_int_equal( drawn->curves.samples, 6 );
    assert_int_equal( scene.strands[3].on_surface, 1 );
    assert_true( scene.strands[3].dynamics.vertex_mass == 13.0f );
    wisp_scene_release( &scene );
}

TEST( what_others_draw_is_hidden_unless_it_says_that_it_is_shown )
{
    wisp_scene scene = parsed( EVERY_KEY );
    assert_true( scene.strands[0].is_shown );  // it has ghosts, but sets the key
    assert_false( scene.strands[1].is_shown ); // curves run through it
    assert_false( scene.strands[2].is_shown ); // it sets the key
    assert_true( scene.strands[3].is_shown );
    wisp_scene_release( &scene );
}

TEST( events_are_for_strands_as_well_as_for_surfaces )
{
    wisp_scene scene = parsed( EVERY_KEY );
    assert_int_equal( scene.event_count, 2 );
    assert_int_equal( scene.events[0].strands, -1 );
    assert_int_equal( scene.events[0].surface, 1 );
    assert_int_equal( scene.events[1].strands, 0 );
    assert_int_equal( scene.events[1].surface, -1 );
    assert_vector( scene.events[1].wind, 7, 8, 9 );
    wisp_scene_release( &scene );
}

TEST( scattered_ghosts_follow_what_they_are_scattered_around )
{
    wisp_scene scene =
        parsed( "wisp: 1\nstrands:\n  - { name: a, generate: {}, dynamics: {} }\n"
                "  - { name: b, generate: {}, dynamics: {} }\n"
                "  - { name: c, scatter: { around: b, count: 2, radius: 0 }, ghosts: {} }\n"
                "  - { name: d, scatter: { around: b, count: 2, radius: 0 }, ghosts: { targets: a } }\n"
                "  - { name: e, scatter: { around: b, count: 2, radius: 0 } }\n" );
    assert_int_equal( scene.strands[2].targets, 1 );
    assert_int_equal( scene.strands[3].targets, 0 );
    assert_int_equal( scene.strands[4].targets, -1 );
    wisp_scene_release( &scene );
}

TEST( frozen_hair_on_ghosts_is_new_in_every_frame_unless_it_says_otherwise )
{
    wisp_scene scene =
        parsed( "wisp: 1\nstrands:\n  - { name: a, generate: {}, dynamics: {} }\n"
                "  - { name: b, frozen_hair: {}, generate: {}, ghosts: { targets: a } }\n"
                "  - { name: c, generate: {}, ghosts: { targets: a }, frozen_hair: { update_on: hair_event } }\n"
                "  - { name: d, generate: {}, frozen_hair: {} }\n" );
    assert_int_equal( scene.strands[1].frozen_hair.update_on, WISP_FROZEN_UPDATE_FRAME );
    assert_int_equal( scene.strands[2].frozen_hair.update_on, WISP_FROZEN_UPDATE_HAIR_EVENT );
    assert_int_equal( scene.strands[3].frozen_hair.update_on, WISP_FROZEN_UPDATE_HAIR_EVENT );
    wisp_scene_release( &scene );
}

TEST( a_scene_with_every_key_of_moving_strands_is_read )
{
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_scene_read( WISP_SOURCE_ROOT "/tests/app/scenes/moving_strands.yaml", &scene, &error ), error );
    assert_int_equal( scene.strands_count, 3 );
    assert_true( scene.strands[0].has_dynamics && scene.strands[0].has_head && scene.strands[0].has_grid );
    assert_true( scene.strands[1].has_ghosts && scene.strands[2].is_curves );
    assert_int_equal( scene.events[0].step, 30 );
    wisp_scene_release( &scene );
}

// ---- scattered strands ----

static wisp_groom straight_groom( int dimension )
{
    wisp_groom_generator generator = wisp_default_groom_generator( WISP_GROOM_STRAIGHT, dimension );
    generator.strand_count = 5;
    generator.vertices_per_strand = 4;
    wisp_groom groom;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_groom_generate( &generator, &groom, &error ), WISP_OK );
    return groom;
}

static wisp_vec3 minus( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static float dot( wisp_vec3 a, wisp_vec3 b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

TEST( scattered_strands_are_their_targets_moved_across_the_root_within_the_radius )
{
    const wisp_scene_scatter scatter = { .around = 0, .count = 200, .radius = 0.01f, .seed = 3 };
    for ( int dimension = 2; dimension <= 3; ++dimension )
    {
        wisp_groom source = straight_groom( dimension ), out;
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( wisp_scene_make_scatter( &scatter, &source, &out, &error ), WISP_OK );
        assert_int_equal( out.strand_count, 1000 );
        assert_int_equal( out.vertex_count, 4000 );
        assert_int_equal( out.dimension, dimension );
        assert_non_null( out.thickness );
        int outer = 0;
        for ( int g = 0; g < out.strand_count; ++g )
        {
            const wisp_vec3 *y = out.points + out.offsets[g], *x = source.points + source.offsets[g / 200];
            const wisp_vec3 offset = minus( y[0], x[0] ), along = minus( x[1], x[0] );
            // coordinates are below 0.5 m, so that a difference of two is within 6e-8 m
            assert_true( sqrtf( dot( offset, offset ) ) <= 0.01f + 1e-7f );
            assert_true( fabsf( dot( offset, along ) ) <= 1e-7f * sqrtf( dot( along, along ) ) * 4.0f );
            for ( int v = 1; v < 4; ++v )
            {
                const wisp_vec3 slip = minus( minus( y[v], x[v] ), offset );
                assert_true( dot( slip, slip ) <= 1e-7f * 1e-7f );
            }
            outer += dot( offset, offset ) > 0.5f * 0.01f * 0.01f;
        }
        // Half of a disc lies beyond radius / sqrt 2, and 1 - 1 / sqrt 2 of a line; five sigma of 1000 draws are 79.
        assert_true( abs( outer - ( dimension == 3 ? 500 : 293 ) ) < 79 );
        wisp_groom_release( &out );
        wisp_groom_release( &source );
    }
}

TEST( scattering_more_strands_around_each_keeps_those_that_there_were )
{
    wisp_groom source = straight_groom( 3 ), few, many;
    wisp_error error = { .status = WISP_OK };
    wisp_scene_scatter scatter = { .around = 0, .count = 2, .radius = 0.01f, .seed = 3 };
    assert_int_equal( wisp_scene_make_scatter( &scatter, &source, &few, &error ), WISP_OK );
    scatter.count = 7;
    assert_int_equal( wisp_scene_make_scatter( &scatter, &source, &many, &error ), WISP_OK );
    for ( int g = 0; g < 5 * 2; ++g )
    {
        const int same = g / 2 * 7 + g % 2;
        assert_memory_equal( few.points + few.offsets[g], many.points + many.offsets[same], 4 * sizeof( wisp_vec3 ) );
    }
    wisp_groom_release( &few );
    wisp_groom_release( &many );
    wisp_groom_release( &source );
}

TEST( scattering_too_many_strands_is_refused_before_memory_is_queried_for )
{
    wisp_groom source = straight_groom( 3 ), out;
    wisp_error error = { .status = WISP_OK };
    const wisp_scene_scatter scatter = { .around = 0, .count = 6710887, .radius = 0.01f, .seed = 3 };
    assert_int_equal( wisp_scene_make_scatter( &scatter, &source, &out, &error ), WISP_BAD_INPUT );
    assert_string_equal( error.message,
                         "6710887 strands around each of 5 have 134217740 vertices, expected at most 134217728" );
    assert_null( out.points );
    wisp_groom_release( &source );
}

// ---- curves at the start ----

TEST( curves_begin_and_end_where_their_strands_do_and_pass_through_what_they_promise )
{
    // strands of 1, 2, 3, 4 and 6 vertices: no curve, a line, a quadratic, a whole group, a group and a remainder
    static const int counts[] = { 1, 2, 3, 4, 6 };
    static const int bezier[] = { 0, 5, 5, 5, 9 }, catmull_rom[] = { 0, 5, 9, 13, 21 };
    wisp_vec3 points[16];
    int offsets[6] = { 0 };
    for ( int s = 0; s < 5; ++s )
    {
        offsets[s + 1] = offsets[s] + counts[s];
    }
    for ( int v = 0; v < 16; ++v )
    {
        points[v] = ( wisp_vec3 ){ (float)v, (float)( v * v % 7 ), (float)( v % 3 ) };
    }
    const wisp_groom source = { 5, 16, 3, offsets, points, NULL, NULL, NULL };
    for ( int kind = 0; kind < WISP_CURVE_KIND_COUNT; ++kind )
    {
        wisp_curves_def def = wisp_default_curves_def();
        def.kind = (wisp_curve_kind)kind;
        def.samples = 4;
        wisp_groom out;
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( wisp_scene_make_curves( &def, &source, &out, &error ), WISP_OK );
        assert_int_equal( out.strand_count, 5 );
        for ( int s = 0; s < 5; ++s )
        {
            const int count = out.offsets[s + 1] - out.offsets[s];
            const int stride = kind == WISP_CURVE_CATMULL_ROM ? 1 : 3;
            assert_int_equal( count, kind == WISP_CURVE_CATMULL_ROM ? catmull_rom[s] : bezier[s] );
            for ( int n = 0; n < count; n += def.samples )
            {
                int vertex = n / def.samples * stride;
                vertex = vertex < counts[s] ? vertex : counts[s] - 1;
                const wisp_vec3 slip = minus( out.points[out.offsets[s] + n], points[offsets[s] + vertex] );
                assert_true( dot( slip, slip ) == 0.0f ); // weights at the ends are 0 and 1
            }
        }
        wisp_groom_release( &out );
    }
}
