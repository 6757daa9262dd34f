// embed.c in C++: a host with its own memory and log, frozen hair that follows a cursor, a snapshot to go back to.
//
//     c++ -std=c++17 embed.cpp $(pkg-config --cflags --libs wisp) -o embed && ./embed
//
// Prints what it sees; exit status 0 if all is as it should be, 1 if not.
#include <wisp/generate.h>
#include <wisp/wisp.hpp>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace
{

constexpr int COLUMNS = 20, ROWS = 10, VERTICES = 12;
constexpr float STEP = 1.0f / 60.0f;

// The host's memory: every block is counted. Worker threads may call it, so the counts are atomic.
struct memory
{
    std::atomic<long> allocations{ 0 }, blocks{ 0 };

    static void* allocate( void* user, std::size_t size, std::size_t alignment )
    {
        memory* self = static_cast<memory*>( user );
        self->allocations += 1;
        self->blocks += 1;
        return std::aligned_alloc( alignment, ( size + alignment - 1 ) / alignment * alignment );
    }
    static void release( void* user, void* block, std::size_t size )
    {
        (void)size;
        memory* self = static_cast<memory*>( user );
        self->blocks -= block != nullptr ? 1 : 0;
        std::free( block );
    }
};

void print_log( void* user, wisp_log_level level, const char* message )
{
    (void)user;
    std::printf( "  log: %s: %s\n", level == WISP_LOG_ERROR ? "error" : "warning", message );
}

wisp::result<wisp_entity> add_hair( wisp::world& world )
{
    static wisp_vec3 points[COLUMNS * ROWS * VERTICES];
    static int32_t offsets[COLUMNS * ROWS + 1];
    wisp_generate_strand_rows( COLUMNS, ROWS, 0.008f, VERTICES, 0.22f, points, offsets, nullptr );
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = COLUMNS * ROWS;
    wisp::result<wisp_entity> hair = world.add( def );
    wisp_frozen_hair_def frozen = wisp_default_frozen_hair_def();
    frozen.clump_radius = 0.012f;
    frozen.reach = 0.3f;
    hair.status = hair ? world.set( hair.value, frozen ) : hair.status;
    hair.status = hair ? world.request( hair.value, WISP_STRAND_POINTS ) : hair.status;
    return hair;
}

bool command( wisp::world& world, wisp_entity hair, wisp_vec3 cursor )
{
    const bool is_good =
        wisp_command_frozen_hair( world.get(), hair, cursor ) == WISP_OK && world.step( STEP ) == WISP_OK;
    const wisp_vec3 tip = is_good ? world.points( hair )[VERTICES - 1] : wisp_vec3{};
    std::printf( "tip of the first strand at %.4f %.4f %.4f m, hash %016llx\n", static_cast<double>( tip.x ),
                 static_cast<double>( tip.y ), static_cast<double>( tip.z ),
                 static_cast<unsigned long long>( world.hash() ) );
    return is_good;
}

bool run( wisp::world& world )
{
    const auto hair = add_hair( world );
    if ( !hair || !command( world, hair.value, wisp_vec3{ 0.3f, -0.3f, 0.04f } ) )
    {
        return false;
    }
    // A command can be undone: its world is a snapshot.
    std::vector<std::byte> before( world.snapshot_size() );
    const std::uint64_t hash = world.hash();
    const bool is_kept = world.snapshot( wisp::span<std::byte>( before.data(), before.size() ) ) == WISP_OK;
    const bool is_changed = command( world, hair.value, wisp_vec3{ -0.2f, -0.2f, 0.04f } ) && world.hash() != hash;
    const bool is_back = world.restore( wisp::span<const std::byte>( before.data(), before.size() ) ) == WISP_OK;
    for ( const wisp_profile_line& line : world.profile() )
    {
        std::printf( "  %-22s %8.1f us\n", line.pass, 1e6 * line.seconds );
    }
    return is_kept && is_changed && is_back && world.hash() == hash;
}

} // namespace

int main()
{
    memory counted;
    bool is_good = false;
    {
        wisp_world_def def = wisp_default_world_def();
        def.modules = wisp_all_modules( &def.module_count );
        def.allocator = wisp_allocator{ memory::allocate, memory::release, &counted };
        def.log = print_log;
        wisp::error error;
        wisp::world world( def, error );
        is_good = world && run( world );
        std::printf( "%s%s\n", error.message, world.message() );
    } // the world is released here
    std::printf( "%ld allocations, %ld blocks left\n", counted.allocations.load(), counted.blocks.load() );
    return is_good && counted.blocks == 0 ? 0 : 1;
}
