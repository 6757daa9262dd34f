// Who wakes whom: the search along an axis finds what a comparison of all pairs finds.
#include "support.h"

#include "sleep_bounds.h"
#include "wisp/module/random.h"

enum
{
    MOST = 400,
};

static float pair_reach( const sleep_box* a, const sleep_box* b )
{
    float longest = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        longest = fmaxf( longest, a->bounds.upper[k] - a->bounds.lower[k] );
    }
    return a->reach + b->reach + 1e-3f * longest;
}

// All pairs, over and over.
static void stir_slowly( sleep_box* boxes, int count )
{
    for ( bool changed = true; changed; )
    {
        changed = false;
        for ( int i = 0; i < count; ++i )
        {
            for ( int k = 0; k < count && boxes[i].is_still && boxes[i].reach >= 0.0f; ++k )
            {
                const bool stirs =
                    boxes[k].is_still == false && boxes[k].reach >= 0.0f &&
                    wisp_bounds_touch( &boxes[i].bounds, &boxes[k].bounds, pair_reach( boxes + i, boxes + k ) );
                boxes[i].is_still = stirs ? false : boxes[i].is_still;
                changed = changed || stirs;
            }
        }
    }
}

// Boxes of several sizes in a room that is longer along one axis; some act on none, and few are not still.
static void make_boxes( uint64_t seed, int count, float room, sleep_box* out )
{
    const wisp_random_key key = wisp_random_make_key( seed, 0, 0 );
    for ( int i = 0; i < count; ++i )
    {
        float u[9];
        for ( uint32_t k = 0; k < 9; ++k )
        {
            u[k] = wisp_random_unit_float( key, (uint32_t)i, k, 0 );
        }
        out[i].reach = u[6] < 0.1f ? -1.0f : 0.2f * u[6];
        out[i].is_still = u[7] > 0.03f;
        for ( int k = 0; k < 3; ++k )
        {
            const float at = room * u[k] * ( k == (int)( seed % 3 ) ? 10.0f : 1.0f );
            const float size = u[8] > 0.95f ? room : u[3 + k];
            out[i].bounds.lower[k] = at;
            out[i].bounds.upper[k] = i % 7 == 0 ? at : at + size; // some are points
        }
    }
}

TEST( a_search_along_an_axis_stirs_whom_all_pairs_stir )
{
    static sleep_box found[MOST], expected[MOST];
    void* room = checked_calloc( sleep_stir_bytes( MOST ), 1 );
    int stirred = 0, left = 0;
    for ( uint64_t seed = 0; seed < 60; ++seed )
    {
        const int count = seed < 3 ? (int)seed : MOST - (int)( 5 * seed );
        make_boxes( seed, count, 4.0f + 0.5f * (float)( seed % 10 ), found );
        memcpy( expected, found, sizeof found );
        sleep_stir( found, count, room );
        const sleep_box* before = expected;
        for ( int i = 0; i < count; ++i )
        {
            stirred += before[i].is_still && !found[i].is_still;
            left += found[i].is_still && found[i].reach >= 0.0f;
        }
        stir_slowly( expected, count );
        for ( int i = 0; i < count; ++i )
        {
            assert_int_equal( found[i].is_still, expected[i].is_still );
        }
    }
    assert_true( stirred > 1000 && left > 1000 );
    free( room );
}

TEST( a_chain_is_stirred_from_its_end_in_any_order )
{
    static sleep_box boxes[MOST];
    void* room = checked_calloc( sleep_stir_bytes( MOST ), 1 );
    for ( int way = 0; way < 2; ++way )
    {
        for ( int i = 0; i < MOST; ++i )
        {
            const float at = (float)( way == 0 ? i : MOST - 1 - i );
            boxes[i] = ( sleep_box ){ { { at, 0, 0 }, { at + 1.0f, 1, 1 } }, 0.0f, i > 0 };
        }
        boxes[MOST - 2].bounds.upper[0] = boxes[MOST - 2].bounds.lower[0] + 0.9f; // a gap on one side
        boxes[MOST - 2].bounds.lower[0] += 0.1f;
        sleep_stir( boxes, MOST, room );
        for ( int i = 0; i < MOST; ++i )
        {
            assert_int_equal( boxes[i].is_still, i >= MOST - 2 );
        }
    }
    free( room );
}
