// Wisp inside another program: its own memory, its own log, its own strands.
//
//     cc -std=c17 embed.c $(pkg-config --cflags --libs wisp) -o embed && ./embed
//
// Prints what it sees; exit status 0 if all is as it should be, 1 if not.
#include <wisp/frozen_hair.h>
#include <wisp/wisp.h>

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#define STRANDS 200
#define VERTICES 12 // a strand
#define STEP ( 1.0f / 60.0f )

// ---- the host's memory: every block is counted, so that nothing is lent without our knowledge ----

typedef struct host_memory
{
    _Atomic long allocations; // ever
    _Atomic long blocks;      // lent now
    _Atomic long bytes;       // lent now
} host_memory;

// May be called from a worker thread, so the counts are atomic.
static void* host_allocate( void* user, size_t size, size_t alignment )
{
    host_memory* memory = user;
    alignment = alignment < sizeof( void* ) ? sizeof( void* ) : alignment;
    void* block = aligned_alloc( alignment, ( size + alignment - 1 ) / alignment * alignment );
    if ( block )
    {
        memory->allocations += 1;
        memory->blocks += 1;
        memory->bytes += (long)size;
    }
    return block;
}

static void host_release( void* user, void* block, size_t size )
{
    host_memory* memory = user;
    if ( block )
    {
        memory->blocks -= 1;
        memory->bytes -= (long)size;
        free( block );
    }
}

// ---- the host's log ----

static void host_log( void* user, wisp_log_level level, const char* message )
{
    static const char* const words[] = { "info", "warning", "error" };
    int* lines = user;
    *lines += 1;
    printf( "  log: %s: %s\n", words[level], message );
}

// ---- strands: a patch of 20 x 10 hanging wisps, 8 mm apart ----

static void make_strands( wisp_vec3 points[STRANDS * VERTICES], int32_t offsets[STRANDS + 1] )
{
    for ( int s = 0; s < STRANDS; ++s )
    {
        offsets[s] = s * VERTICES;
        for ( int v = 0; v < VERTICES; ++v )
        {
            // A slight zigzag: perfectly straight hair would bend in a random direction.
            float sway = v % 2 == 0 ? 0.0f : 0.002f;
            points[s * VERTICES + v] = ( wisp_vec3 ){
                .x = 0.008f * (float)( s % 20 ) + sway,
                .y = -0.02f * (float)v,
                .z = 0.008f * (float)( s / 20 ),
            };
        }
    }
    offsets[STRANDS] = STRANDS * VERTICES;
}

static wisp_status add_hair( wisp_world* world, wisp_entity* hair )
{
    static wisp_vec3 points[STRANDS * VERTICES];
    static int32_t offsets[STRANDS + 1];
    make_strands( points, offsets );

    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = points;
    strands.offsets = offsets;
    strands.strand_count = STRANDS;
    wisp_status status = wisp_add_strands( world, &strands, hair );
    if ( status != WISP_OK )
    {
        return status;
    }

    wisp_frozen_hair_def frozen = wisp_default_frozen_hair_def();
    frozen.clump_radius = 0.012f;
    frozen.reach = 0.3f;
    status = wisp_set_frozen_hair( world, *hair, &frozen );

    // Nothing is requested yet, so no pass runs. A request for points creates the passes that compute them.
    return status == WISP_OK ? wisp_request( world, *hair, WISP_STRAND_POINTS ) : status;
}

// ---- what the host does in a frame ----

static wisp_status point_and_step( wisp_world* world, wisp_entity hair, wisp_vec3 cursor )
{
    wisp_status status = wisp_command_frozen_hair( world, hair, cursor );
    return status == WISP_OK ? wisp_world_step( world, STEP ) : status;
}

static wisp_status print_hair( wisp_world* world, wisp_entity hair, const char* what )
{
    wisp_view view;
    wisp_status status = wisp_world_view( world, hair, WISP_STRAND_POINTS, &view );
    if ( status == WISP_OK )
    {
        const wisp_vec3* points = view.data;
        wisp_vec3 tip = points[VERTICES - 1];
        printf( "%-14s %d points, tip of the first strand at %.4f %.4f %.4f m, hash %016llx\n", what, view.count,
                (double)tip.x, (double)tip.y, (double)tip.z, (unsigned long long)wisp_world_hash( world ) );
    }
    return status;
}

// A command that is given again finds all its buffers warm.
static wisp_status repeat( wisp_world* world, wisp_entity hair, const host_memory* memory, long* allocations )
{
    const wisp_vec3 cursor = { 0.1f, -0.2f, 0.04f };
    wisp_status status = WISP_OK;
    long before = 0;
    for ( int i = 0; i < 20 && status == WISP_OK; ++i )
    {
        status = wisp_replay_frozen_hair( world, hair, cursor, 7 );
        status = status == WISP_OK ? wisp_world_step( world, STEP ) : status;
        before = i == 0 ? memory->allocations : before;
    }
    *allocations = memory->allocations - before;
    return status;
}

static wisp_status run( wisp_world* world, const host_memory* memory, long* repeated_allocations )
{
    wisp_entity hair;
    wisp_status status = add_hair( world, &hair );
    const wisp_vec3 cursors[] = { { 0.3f, -0.3f, 0.04f }, { -0.2f, -0.2f, 0.04f }, { 0.0f, -0.4f, 0.3f } };
    for ( int i = 0; i < WISP_COUNT( cursors ) && status == WISP_OK; ++i )
    {
        status = point_and_step( world, hair, cursors[i] );
        status = status == WISP_OK ? print_hair( world, hair, "after command" ) : status;
    }
    status = status == WISP_OK ? repeat( world, hair, memory, repeated_allocations ) : status;
    if ( status == WISP_OK )
    {
        wisp_profile profile = wisp_world_profile( world );
        for ( int i = 0; i < profile.count; ++i )
        {
            printf( "  %-22s %8.1f us\n", profile.lines[i].pass, 1e6 * profile.lines[i].seconds );
        }
        printf( "  %-22s %8.1f us, %s, %d workers, %zu bytes\n", "the whole step", 1e6 * profile.seconds,
                wisp_world_isa( world ), wisp_world_workers( world ), wisp_world_memory( world ) );
        status = print_hair( world, hair, "at the end" );
    }
    return status;
}

int main( void )
{
    host_memory memory = { 0 };
    int log_lines = 0;
    const wisp_module* const modules[] = { &wisp_frozen_hair_module };

    wisp_world_def def = wisp_default_world_def();
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    def.allocator = ( wisp_allocator ){ host_allocate, host_release, &memory };
    def.log = host_log;
    def.log_user = &log_lines;

    wisp_world* world;
    wisp_error error = { 0 };
    if ( wisp_world_create( &def, &world, &error ) != WISP_OK )
    {
        printf( "no world: %s\n", error.message );
        return 1;
    }

    long repeated_allocations = -1;
    wisp_status status = run( world, &memory, &repeated_allocations );
    if ( status != WISP_OK )
    {
        printf( "%s: %s\n", wisp_status_name( status ), wisp_world_message( world ) );
    }
    wisp_world_destroy( world );

    printf( "%ld allocations in all, %ld in 19 repeated steps, %ld blocks and %ld bytes left, %d lines in the log\n",
            memory.allocations, repeated_allocations, memory.blocks, memory.bytes, log_lines );
    bool is_clean = repeated_allocations == 0 && memory.blocks == 0 && memory.bytes == 0;
    return status == WISP_OK && is_clean ? 0 : 1;
}
