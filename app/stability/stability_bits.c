// The same scene with other numbers of workers and other instruction sets.
#include "stability_judges.h"

#include "text_tree.h"

#include <stdio.h>
#include <stdlib.h>

bool stability_compare_bits( const uint64_t* expected, int expected_count, const uint64_t* found, int found_count,
                             stability_check judge, int first, const char* how, stability_verdict* out )
{
    int same = 0;
    while ( same < expected_count && same < found_count && expected[same] == found[same] )
    {
        ++same;
    }
    if ( same == expected_count && same == found_count )
    {
        return true;
    }
    *out = ( stability_verdict ){ .check = judge, .step = first + same + 1, .severity = 1.0 };
    snprintf( out->message, sizeof out->message, "step %d has other bits %s", first + same + 1, how );
    return false;
}

// Make steps and keep the hash after each. @return steps that were made
static int hash_steps( scene_world* world, int steps, uint64_t* hashes )
{
    int made = 0;
    while ( made < steps && scene_world_step( world, NULL ) == WISP_OK )
    {
        hashes[made++] = wisp_world_hash( world->world );
    }
    return made;
}

static int hash_scene( const wisp_scene* scene, const scene_world_options* options, int steps, uint64_t* hashes )
{
    scene_world world;
    if ( scene_world_create( scene, options, &world, NULL ) != WISP_OK )
    {
        return 0;
    }
    const int made = hash_steps( &world, steps, hashes );
    scene_world_destroy( &world );
    return made;
}

bool stability_judge_bits( const wisp_scene* scene, int steps, stability_verdict* out )
{
    static const struct
    {
        int workers;
        const char *isa, *how;
    } places[] = { { 2, "baseline", "with 2 workers than with one" },
                   { 5, "avx2", "with 5 workers and AVX2 than with one and without" },
                   { 1, "avx512", "with AVX-512 than without" } };
    uint64_t *expected = text_alloc( (size_t)steps * sizeof *expected ),
             *found = text_alloc( (size_t)steps * sizeof *found );
    const scene_world_options plain = { .workers = 1, .isa = "baseline", .is_quiet = true };
    const int made = hash_scene( scene, &plain, steps, expected );
    bool holds = true;
    for ( int i = 0; i < WISP_COUNT( places ) && holds; ++i )
    {
        const scene_world_options options = { .workers = places[i].workers, .isa = places[i].isa, .is_quiet = true };
        const int count = hash_scene( scene, &options, steps, found );
        holds = stability_compare_bits( expected, made, found, count, STABILITY_BITS, 0, places[i].how, out );
    }
    free( expected );
    free( found );
    return holds;
}
