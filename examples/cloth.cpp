// cloth.c in C++: a cloth that hangs from two corners in the wind, and a ball that comes towards it.
//
//     c++ -std=c++17 cloth.cpp $(pkg-config --cflags --libs wisp) -o cloth && ./cloth
//
// Prints a line a second; exit status 0 if all is as it should be, 1 if not.
#include <wisp/generate.h>
#include <wisp/wisp.hpp>

#include <cstdio>

namespace
{

constexpr int SIDE = 33; // vertices
constexpr float SPACING = 1.0f / ( SIDE - 1 ), STEP = 1.0f / 60.0f;

wisp_vec3 points[WISP_GRID_VERTICES( SIDE, SIDE )];
int32_t triangles[WISP_GRID_TRIANGLES( SIDE, SIDE )][3];
const int32_t corners[2] = { 0, SIDE - 1 };

wisp::result<wisp_entity> add_cloth( wisp::world& world )
{
    wisp_cloth_def material = wisp_default_cloth_def();
    material.tethers = true;
    material.drag_coefficient = 1.0f;
    material.wind = wisp_vec3{ 0.0f, 0.0f, -2.0f };
    wisp_create_cloth_def def = wisp_default_create_cloth_def();
    def.points = points;
    def.vertex_count = WISP_COUNT( points );
    def.triangles = &triangles[0][0];
    def.triangle_count = WISP_COUNT( triangles );
    def.pins = corners;
    def.pin_count = WISP_COUNT( corners );
    def.material = &material;
    return world.create( def );
}

wisp_status run( wisp::world& world, wisp_entity cloth, wisp_entity ball )
{
    for ( int step = 1; step <= 180; ++step )
    {
        const float away = 0.6f - 0.2f * STEP * static_cast<float>( step ); // m; it comes at 20 cm/s
        wisp_status status = wisp_move_collider(
            world.get(), ball, wisp_transform{ { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, -0.5f, -0.5f - away } } );
        status = status == WISP_OK ? world.step( STEP ) : status;
        if ( status != WISP_OK )
        {
            return status;
        }
        if ( step % 60 == 0 )
        {
            const wisp_vec3 last = world.points( cloth )[SIDE * SIDE - 1]; // in our own order
            const auto stats = world.motion_stats( cloth );
            std::printf( "%d s: a free corner is at (%.2f, %.2f, %.2f), the largest strain is %.2f %%\n", step / 60,
                         static_cast<double>( last.x ), static_cast<double>( last.y ), static_cast<double>( last.z ),
                         100.0 * stats.value.strain_max );
            if ( !stats || stats.value.strain_max > 0.1 || last.y > 0.0f )
            {
                return WISP_BAD_INPUT;
            }
        }
    }
    return WISP_OK;
}

} // namespace

int main()
{
    wisp::error error;
    wisp::world world( error ); // every module; those without entities cost nothing in a step
    if ( error || wisp_generate_grid( SIDE, SIDE, SPACING, SPACING, points, &triangles[0][0], &error ) != WISP_OK )
    {
        std::printf( "%s\n", error.message );
        return 1;
    }
    wisp_collider_def ball_def = wisp_default_collider_def();
    ball_def.kind = WISP_COLLIDER_SPHERE;
    ball_def.radius = 0.2f;
    ball_def.pose.translation = wisp_vec3{ 0.0f, -0.5f, -1.1f };
    const auto cloth = add_cloth( world );
    const auto ball = world.add( ball_def );
    const bool is_there = cloth && ball && world.request( cloth.value, WISP_MOTION_STATS ) == WISP_OK;
    if ( !is_there || run( world, cloth.value, ball.value ) != WISP_OK )
    {
        std::printf( "not as it should be: %s\n", world.message() );
        return 1;
    }
    return 0;
}
