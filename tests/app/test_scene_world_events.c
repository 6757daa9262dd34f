// From a scene to a running world: keyframes and events of surfaces, balloons and colliders.
#include "scene_world_fixture.h"

TEST( pins_follow_their_keyframes_and_stay_at_the_last )
{
    fixture f;
    build( &f,
           "wisp: 1\ndt: 0.1\nsteps: 100\nsurfaces:\n"
           "  - name: a\n    generate: { shape: plane, columns: 2, rows: 2, spacing: 2 }\n    pins: [0, 1, 2, 3]\n"
           "    compute: [points]\n    pin_keyframes:\n"
           "      - { time: 1, translate: [0, 1, 0] }\n"
           "      - { time: 2, translate: [0, 1, 0], rotate: { axis: [0, 1, 0], degrees: 90 } }\n" );
    step( &f, 5 );
    assert_point_at( point_of( &f, 0, 0 ), -1.0f, 0.5f, -1.0f );
    step( &f, 5 );
    assert_point_at( point_of( &f, 0, 0 ), -1.0f, 1.0f, -1.0f );
    step( &f, 10 );
    assert_point_at( point_of( &f, 0, 0 ), -1.0f, 1.0f, 1.0f );
    step( &f, 5 );
    assert_point_at( point_of( &f, 0, 0 ), -1.0f, 1.0f, 1.0f );
    release( &f );
}

TEST( a_released_surface_falls_and_its_pins_follow_no_keyframe )
{
    fixture f;
    build( &f, "wisp: 1\ndt: 0.01\nsteps: 100\nsubsteps: 1\nsurfaces:\n"
               "  - name: a\n    generate: { shape: plane, columns: 2, rows: 2 }\n    pins: [0, 1, 2, 3]\n"
               "    compute: [points]\n    pin_keyframes: [{ time: 10, translate: [5, 0, 0] }]\n"
               "events: [{ time: 0.1, surface: a, release: true, velocity: [0, 0, 1] }]\n" );
    step( &f, 10 );
    wisp_vec3 held = point_of( &f, 0, 0 );
    assert_point_at( held, -0.01f + 0.05f, 0.0f, -0.01f );
    step( &f, 50 );
    wisp_vec3 free_fall = point_of( &f, 0, 0 );
    // half g t^2, and half a step more of g t because velocities are updated first
    assert_point_at( free_fall, held.x, -9.8f * ( 0.125f + 0.0025f ), held.z + 0.5f );
    release( &f );
}

// Two triangles over four vertices: the ends of the diagonal belong to both. A gust comes on top of a velocity that is set.
TEST( a_gust_is_added_once_or_for_each_triangle )
{
    for ( int per_triangle = 0; per_triangle < 2; ++per_triangle )
    {
        fixture f;
        char text[512];
        snprintf( text, sizeof text,
                  "wisp: 1\ndt: 0.01\nsteps: 100\nsubsteps: 1\ngravity: [0, 0, 0]\nsurfaces:\n"
                  "  - { name: a, generate: { shape: plane, columns: 2, rows: 2 }, pins: [3], compute: [points] }\n"
                  "events: [{ step: 10, surface: a, velocity: [0, 0, 1], gust: [0.5, -1, 0], "
                  "gust_per_triangle: %s }]\n",
                  per_triangle == 1 ? "true" : "false" );
        build( &f, text );
        step( &f, 10 );
        wisp_vec3 start[4];
        for ( int i = 0; i < 4; ++i )
        {
            start[i] = point_of( &f, 0, i );
        }
        step( &f, 1 );
        int twice = 0;
        for ( int i = 0; i < 3; ++i )
        {
            const wisp_vec3 p = point_of( &f, 0, i );
            const bool is_double = p.y < -0.015f;
            const float times = is_double ? 0.02f : 0.01f;
            assert_point_at( p, start[i].x + 0.5f * times, -times, start[i].z + 0.01f );
            twice += is_double ? 1 : 0;
        }
        // the pinned vertex is an end of the diagonal, or not
        assert_true( per_triangle == 1 ? twice == 1 || twice == 2 : twice == 0 );
        assert_point_at( point_of( &f, 0, 3 ), start[3].x, start[3].y, start[3].z );
        release( &f );
    }
}

TEST( keyframes_tell_the_fill_and_leave_the_gas_alone_afterwards )
{
    fixture f;
    build( &f, "wisp: 1\ndt: 0.1\nsteps: 40\nsubsteps: 4\nsurfaces:\n"
               "  - { name: a, generate: { shape: icosphere, level: 1 }, compute: [effect_stats], "
               "balloon: { gas_ratio: 1.5, gas_ratio_keyframes: [[1, 1], [2, 2]] } }\n"
               "events: [{ step: 25, surface: a, gas_ratio: 1.25 }]\n" );
    static const struct
    {
        int steps;
        double gas_ratio;
    } story[] = { { 5, 1.5 }, { 5, 1.0 }, { 5, 1.5 }, { 5, 2.0 }, { 5, 2.0 }, { 1, 1.25 }, { 5, 1.25 } };
    for ( int i = 0; i < WISP_COUNT( story ); ++i )
    {
        step( &f, story[i].steps );
        wisp_balloon_stats stats;
        assert_int_equal( wisp_read_balloon_stats( f.world.world, f.world.surfaces[0].entity, &stats ), WISP_OK );
        // times and fills are floats
        assert_true( fabs( stats.target_volume / stats.rest_volume - story[i].gas_ratio ) < 1e-5 );
    }
    release( &f );
}

TEST( the_outlet_opens_and_closes_when_an_event_says )
{
    fixture f;
    build( &f, "wisp: 1\ndt: 0.01\nsteps: 40\nsubsteps: 4\nsurfaces:\n"
               "  - { name: a, generate: { shape: icosphere, level: 2, radius: 0.2 }, compute: [effect_stats], "
               "balloon: { gas_ratio: 1.5, outlet: [0] } }\n"
               "events:\n  - { step: 5, surface: a, outlet_open: true }\n  - { step: 10, surface: a, outlet_open: "
               "false }\n" );
    double lost[3];
    for ( int i = 0; i < 3; ++i )
    {
        step( &f, 5 );
        wisp_balloon_stats stats;
        assert_int_equal( wisp_read_balloon_stats( f.world.world, f.world.surfaces[0].entity, &stats ), WISP_OK );
        lost[i] = stats.gas_lost;
    }
    assert_true( lost[0] == 0.0 && lost[1] > 0.0 && lost[2] == lost[1] );
    release( &f );
}

TEST( wind_of_an_event_blows_from_its_step_on )
{
    fixture f;
    build( &f,
           "wisp: 1\ndt: 0.01\nsteps: 40\nsurfaces:\n"
           "  - { name: a, generate: { shape: plane, columns: 4, rows: 4 }, gravity: [0, 0, 0], compute: [points], "
           "cloth: { drag_coefficient: 1 } }\n"
           "events: [{ step: 5, surface: a, wind: [0, 3, 0] }]\n" );
    step( &f, 5 );
    assert_point_at( point_of( &f, 0, 0 ), -0.03f, 0.0f, -0.03f );
    step( &f, 5 );
    assert_true( point_of( &f, 0, 0 ).y > 1e-3f );
    release( &f );
}

TEST( colliders_follow_their_keyframes )
{
    fixture f;
    build( &f,
           "wisp: 1\ndt: 0.1\nsteps: 40\ncolliders:\n"
           "  - { name: a, shape: box, half_extent: [1, 1, 1], position: [1, 0, 0], keyframes: "
           "[{ time: 1, position: [3, 0, 0] }, { time: 2, position: [3, 0, 0], rotation: { degrees: [0, 180, 0] } "
           "}] }\n" );
    assert_point_at( point_of( &f, 0, 7 ), 2.0f, 1.0f, 1.0f );
    step( &f, 5 );
    assert_point_at( point_of( &f, 0, 7 ), 3.0f, 1.0f, 1.0f );
    step( &f, 15 );
    assert_point_at( point_of( &f, 0, 7 ), 2.0f, 1.0f, -1.0f );
    step( &f, 2 );
    assert_point_at( point_of( &f, 0, 7 ), 2.0f, 1.0f, -1.0f );
    release( &f );
}

TEST( a_surface_with_collision_rests_on_the_ground_and_one_without_falls_through )
{
    fixture f;
    build( &f,
           "wisp: 1\nsteps: 60\nsubsteps: 4\nsurfaces:\n"
           "  - { name: a, generate: { shape: plane, columns: 4, rows: 4 }, compute: [points], cloth: {}, "
           "transform: { translate: [0, 0.2, 0] }, collision: { thickness: 0.01 } }\n"
           "  - { name: b, instance_of: a, compute: [points], cloth: {}, transform: { translate: [0, 0.2, 0] } }\n"
           "colliders: [{ name: ground, shape: plane }]\n" );
    step( &f, 60 );
    // a contact is solved exactly in a step; float rounding of 0.2 m remains
    assert_true( fabsf( point_of( &f, 0, 5 ).y - 0.01f ) < 1e-3f );
    assert_true( point_of( &f, 1, 5 ).y < -4.0f );
    release( &f );
}
