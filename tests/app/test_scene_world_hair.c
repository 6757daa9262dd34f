// Frozen hair of a scene: its events do what a host does by calls.
#include "saved_world.h"
#include "scene_world_fixture.h"

// What an editor does between two steps, and what it writes of that into a scene.
static void edit_hair( wisp_world* world, wisp_entity hair, wisp_frozen_hair_def* def, int n, char* entry,
                       size_t size )
{
    const wisp_vec3 cursor = { -0.05f + 0.01f * (float)n, -0.2f + 0.005f * (float)( n % 5 ), 0.0f };
    char changes[200] = "", place[100] = "";
    if ( n % 7 == 0 )
    {
        def->intensity = 0.1f * (float)( n % 10 );
        def->reach = 0.03f + 0.001f * (float)n;
        def->stretch_stiffness = 3.0f + 0.1f * (float)n;
        def->bend_stiffness = 5.0f + 0.1f * (float)n;
        def->clump_radius = 0.004f + 0.0002f * (float)n;
        snprintf( changes, sizeof changes,
                  ", intensity: %.9g, reach: %.9g, stretch_stiffness: %.9g, bend_stiffness: %.9g, clump_radius: %.9g",
                  (double)def->intensity, (double)def->reach, (double)def->stretch_stiffness,
                  (double)def->bend_stiffness, (double)def->clump_radius );
        assert_int_equal( wisp_set_frozen_hair( world, hair, def ), WISP_OK );
    }
    if ( n == 20 )
    {
        assert_int_equal( wisp_begin_frozen_hair_stroke( world, hair ), WISP_OK );
    }
    if ( n % 14 != 7 )
    {
        snprintf( place, sizeof place, ", cursor: [%.9g, %.9g, 0]", (double)cursor.x, (double)cursor.y );
        assert_int_equal( wisp_command_frozen_hair( world, hair, cursor ), WISP_OK );
    }
    snprintf( entry, size, "  - { step: %d, strands: hair%s%s%s }\n", n, place, n == 20 ? ", begin_stroke: true" : "",
              changes );
}

// Strokes by calls, with snapshots and restores in between, are what a scene of their commands computes.
TEST( a_scene_repeats_the_strokes_of_a_host_bit_for_bit )
{
    enum
    {
        steps = 40
    };
    static const char begin[] = "wisp: 1\nsteps: 40\nstrands:\n  - name: hair\n"
                                "    generate: { shape: wavy, dimension: 2, strands: 60, vertices: 20 }\n"
                                "    frozen_hair: { base: stroke, freeze: {}, align: {}, clump: {} }\n";
    char text[16384];
    size_t used = (size_t)snprintf( text, sizeof text, "%shair_events:\n", begin );
    fixture host, scene;
    build( &host, begin );
    wisp_world* world = host.world.world;
    const wisp_entity hair = host.world.entities[0];
    wisp_frozen_hair_def def = host.scene.strands[0].frozen_hair;
    uint64_t hashes[steps];
    for ( int n = 0; n < steps; ++n )
    {
        char entry[400], unused[400];
        edit_hair( world, hair, &def, n, entry, sizeof entry );
        assert_int_equal( wisp_world_step( world, 1.0f / 60.0f ), WISP_OK );
        assert_int_equal( wisp_world_hash_column( world, hair, WISP_STRAND_POINTS, &hashes[n] ), WISP_OK );
        used += (size_t)snprintf( text + used, sizeof text - used, "%s", entry );
        assert_true( used < sizeof text );

        // a sample that the user takes back
        const saved_world saved = save_world( world );
        wisp_frozen_hair_def taken_back = def;
        edit_hair( world, hair, &taken_back, 35 - n % 3, unused, sizeof unused );
        assert_int_equal( wisp_world_step( world, 1.0f / 60.0f ), WISP_OK );
        assert_int_equal( wisp_world_restore( world, saved.bytes, saved.size ), WISP_OK );
        free( saved.bytes );
    }
    build( &scene, text );
    for ( int n = 0; n < steps; ++n )
    {
        uint64_t hash;
        step( &scene, 1 );
        assert_int_equal(
            wisp_world_hash_column( scene.world.world, scene.world.entities[0], WISP_STRAND_POINTS, &hash ),
            WISP_OK );
        if ( hash != hashes[n] )
        {
            fail_msg( "step %d of the scene differs from what the host saw", n );
        }
    }
    release( &scene );
    release( &host );
}
