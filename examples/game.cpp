// A game loop in C++, by <wisp/wisp.hpp>: a flag in a turning wind, a ball that pushes it, a pin that lets go, a second flag that
// comes and goes, and a moment that the game goes back to.
//
//     c++ -std=c++17 game.cpp $(pkg-config --cflags --libs wisp) -o game && ./game
//
// Exit status 0 if the repeated second ends with the same bits, with others where the wind drops, and the flag hangs from its last pin.
#include <wisp/generate.h>
#include <wisp/wisp.hpp>

#include <cmath>
#include <cstdio>
#include <vector>

constexpr int SIDE = 17; // vertices
constexpr float STEP = 1.0f / 60.0f;
constexpr std::int32_t corners[] = { 0, SIDE - 1 };

static wisp::result<wisp_entity> add_flag( wisp::world& world )
{
    static wisp_vec3 points[WISP_GRID_VERTICES( SIDE, SIDE )];
    static std::int32_t triangles[WISP_GRID_TRIANGLES( SIDE, SIDE )][3];
    wisp_generate_grid( SIDE, SIDE, 0.05f, 0.05f, points, &triangles[0][0], nullptr );
    wisp_create_cloth_def def = wisp_default_create_cloth_def();
    def.points = points, def.vertex_count = WISP_COUNT( points );
    def.triangles = &triangles[0][0], def.triangle_count = WISP_COUNT( triangles );
    def.pins = corners, def.pin_count = WISP_COUNT( corners );
    return world.create( def );
}

int main()
{
    wisp::error error;
    wisp::world world( error );
    const auto [status, flag] = add_flag( world );
    wisp_collider_def ball_def = wisp_default_collider_def();
    ball_def.kind = WISP_COLLIDER_SPHERE, ball_def.radius = 0.2f, ball_def.pose.translation.y = -0.4f;
    const auto [ball_status, ball] = world.add( ball_def );
    if ( error || status != WISP_OK || ball_status != WISP_OK )
    {
        std::printf( "%s%s\n", error.message, world.message() );
        return 1;
    }
    int step = 0;
    float wind = 1.0f; // m/s
    const auto before_step = [&step, &wind, flag = flag, ball = ball]( wisp::world& w )
    {
        const float time = STEP * static_cast<float>( ++step );
        const wisp_vec3 place = { 0.0f, -0.4f, 1.2f * std::sin( 2.0f * time ) };
        w.move( ball, wisp_transform_make( { 0.0f, 0.0f, 0.0f, 1.0f }, place ) );
        w.set_wind( flag, { 2.0f * wind * std::cos( time ), 0.0f, wind } );
    };
    const auto play = [&world, &before_step]( int frame_count )
    {
        for ( int frame = 0; frame < frame_count; ++frame )
        {
            world.advance( frame % 2 == 0 ? 0.007f : 0.029f, STEP, before_step ); // s, of frames that vary
        }
    };
    play( 60 );
    const wisp::result<wisp_entity> other = add_flag( world );
    play( 30 );
    world.remove( other.value );
    world.unpin( flag, corners, 1 );

    std::vector<std::byte> kept( world.snapshot_size() );
    world.snapshot( { kept.data(), kept.size() } );
    std::uint64_t hashes[3] = {};
    const int then = step;
    for ( std::uint64_t& hash : hashes )
    {
        world.restore( { kept.data(), kept.size() } );
        step = then, wind = &hash == hashes ? 0.0f : 1.0f;
        for ( int i = 0; i < 60; ++i )
        {
            before_step( world );
            world.step( STEP );
        }
        hash = world.hash();
    }
    const wisp::span<const wisp_vec3> points = world.points( flag );
    const wisp_vec3 loose = points[0], held = points[SIDE - 1];
    std::printf( "a pin at %.2f m, the other corner at %.2f m, hash %016llx %s\n", static_cast<double>( held.y ),
                 static_cast<double>( loose.y ), static_cast<unsigned long long>( hashes[2] ), world.message() );
    const bool is_good = hashes[0] != hashes[1] && hashes[1] == hashes[2] && loose.y < -0.2f && held.y == 0.0f &&
                         world.is_alive( other.value ) == false && world.normals( flag ).size() == points.size();
    return is_good ? 0 : 1;
}
