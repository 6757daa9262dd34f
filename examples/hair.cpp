// hair.c in C++: guides on a head that is shaken, and ghosts that follow them.
//
//     c++ -std=c++17 hair.cpp $(pkg-config --cflags --libs wisp) -o hair && ./hair
//
// Prints a line a second; exit status 0 if all is as it should be, 1 if not.
#include <wisp/generate.h>
#include <wisp/wisp.hpp>

#include <cmath>
#include <cstdio>

namespace
{

constexpr int GUIDES = 4, GHOSTS = 12; // on a side
constexpr int VERTICES = 20;
constexpr float LENGTH = 0.2f, SIDE = 0.12f, STEP = 1.0f / 60.0f;

wisp_vec3 guide_points[GUIDES * GUIDES * VERTICES], ghost_points[GHOSTS * GHOSTS * VERTICES];
int32_t guide_offsets[GUIDES * GUIDES + 1], ghost_offsets[GHOSTS * GHOSTS + 1];

// A head turns from side to side, twice a second.
wisp_transform head_at( float time )
{
    const float turn = 0.4f * std::sin( 12.566f * time );
    return wisp_transform{ { 0.0f, std::sin( 0.5f * turn ), 0.0f, std::cos( 0.5f * turn ) }, { 0.0f, 0.0f, 0.0f } };
}

bool shake( wisp::world& world, wisp_entity guides )
{
    int step = 0;
    // Frames take any time; steps are constant, and the head is where it is at the end of each.
    for ( int frame = 1; frame <= 90; ++frame )
    {
        const wisp_status status = world.advance(
            2.0f * STEP, STEP,
            [&]( wisp::world& w )
            { wisp_move_strand_head( w.get(), guides, head_at( STEP * static_cast<float>( ++step ) ) ); } );
        if ( status != WISP_OK )
        {
            return false;
        }
        if ( frame % 30 == 0 )
        {
            const auto stats = world.motion_stats( guides );
            std::printf( "%d s: %5.2f m/s at most, longest stretch %.5f %%\n", frame / 30, stats.value.speed_max,
                         100.0 * stats.value.strain_max );
        }
    }
    return true;
}

// Every ghost is still about as long as it was.
bool ghosts_hang( wisp::span<const wisp_vec3> p )
{
    for ( std::size_t root = 0; root < p.size(); root += VERTICES )
    {
        const wisp_vec3 a = p[root], b = p[root + VERTICES - 1];
        const float reach = std::hypot( a.x - b.x, a.y - b.y, a.z - b.z );
        if ( !( reach > 0.5f * LENGTH && reach < 1.2f * LENGTH ) )
        {
            return false;
        }
    }
    return !p.empty();
}

} // namespace

int main()
{
    wisp::error error;
    wisp::world world( error );
    if ( error ||
         wisp_generate_strand_rows( GUIDES, GUIDES, SIDE / GUIDES, VERTICES, LENGTH, guide_points, guide_offsets,
                                    &error ) != WISP_OK ||
         wisp_generate_strand_rows( GHOSTS, GHOSTS, SIDE / GHOSTS, VERTICES, LENGTH, ghost_points, ghost_offsets,
                                    &error ) != WISP_OK )
    {
        std::printf( "%s\n", error.message );
        return 1;
    }
    wisp_create_hair_def guide_def = wisp_default_create_hair_def();
    guide_def.points = guide_points;
    guide_def.offsets = guide_offsets;
    guide_def.strand_count = GUIDES * GUIDES;
    const auto guides = world.create( guide_def );

    wisp_strands_def ghost_def = wisp_default_strands_def();
    ghost_def.points = ghost_points;
    ghost_def.offsets = ghost_offsets;
    ghost_def.strand_count = GHOSTS * GHOSTS;
    const auto ghosts = world.add( ghost_def );
    wisp_ghosts_def follow = wisp_default_ghosts_def();
    follow.targets = guides.value;

    // a request creates the passes that compute it
    const bool is_there = guides && ghosts && world.set( ghosts.value, follow ) == WISP_OK &&
                          world.request( guides.value, WISP_MOTION_STATS ) == WISP_OK &&
                          world.request( ghosts.value, WISP_STRAND_POINTS ) == WISP_OK;
    if ( !is_there || !shake( world, guides.value ) || !ghosts_hang( world.points( ghosts.value ) ) )
    {
        std::printf( "not as it should be: %s\n", world.message() );
        return 1;
    }
    return 0;
}
