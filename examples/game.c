// A game loop: steps of constant length in frames of any length, on threads of the game. Flags come and go, the wind turns, a ball
// flies through, and the game goes back to a moment that it has kept.
//
//     cc -std=c17 game.c $(pkg-config --cflags --libs wisp) -lm -o game && ./game
//
// Plays the same once on one thread and once on four; exit status 0 if both, and the repeated second, end with the same bits.
#include <wisp/create.h>
#include <wisp/generate.h>

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#define WORKERS 4
#define SIDE 17 // vertices
#define FLAGS 3 // at a time
#define STEP ( 1.0f / 60.0f )

// ---- the threads of the game: all of them run the blocks of a wave, and the one that steps is worker 0 ----

typedef struct pool
{
    pthread_mutex_t lock;
    pthread_cond_t begins, ends;
    pthread_t threads[WORKERS - 1];
    wisp_block_fn* run;
    void* context;
    atomic_int next, seats;
    int block_count, busy, waves;
    bool stops;
} pool;

static void take_blocks( pool* p, int worker )
{
    for ( int block = p->next++; block < p->block_count; block = p->next++ )
    {
        p->run( p->context, block, worker );
    }
}

static void* work( void* user )
{
    pool* p = user;
    const int worker = ++p->seats;
    pthread_mutex_lock( &p->lock );
    for ( int seen = 0; true; )
    {
        while ( p->waves == seen && p->stops == false )
        {
            pthread_cond_wait( &p->begins, &p->lock );
        }
        if ( p->stops )
        {
            break;
        }
        seen = p->waves;
        pthread_mutex_unlock( &p->lock );
        take_blocks( p, worker );
        pthread_mutex_lock( &p->lock );
        if ( --p->busy == 0 )
        {
            pthread_cond_signal( &p->ends );
        }
    }
    pthread_mutex_unlock( &p->lock );
    return NULL;
}

static void pool_for( void* user, int block_count, wisp_block_fn* run, void* context )
{
    pool* p = user;
    pthread_mutex_lock( &p->lock );
    p->run = run, p->context = context, p->block_count = block_count, p->next = 0;
    p->busy = WORKERS - 1, ++p->waves;
    pthread_cond_broadcast( &p->begins );
    pthread_mutex_unlock( &p->lock );
    take_blocks( p, 0 );
    pthread_mutex_lock( &p->lock );
    while ( p->busy > 0 ) // a thread that woke late may still read the wave
    {
        pthread_cond_wait( &p->ends, &p->lock );
    }
    pthread_mutex_unlock( &p->lock );
}

static void pool_open( pool* p )
{
    pthread_mutex_init( &p->lock, NULL );
    pthread_cond_init( &p->begins, NULL );
    pthread_cond_init( &p->ends, NULL );
    for ( int t = 0; t < WORKERS - 1; ++t )
    {
        pthread_create( &p->threads[t], NULL, work, p );
    }
}

static void pool_close( pool* p )
{
    pthread_mutex_lock( &p->lock );
    p->stops = true;
    pthread_cond_broadcast( &p->begins );
    pthread_mutex_unlock( &p->lock );
    for ( int t = 0; t < WORKERS - 1; ++t )
    {
        pthread_join( p->threads[t], NULL );
    }
}

// ---- the game ----

typedef struct game
{
    wisp_world* world;
    wisp_entity ball, flags[FLAGS]; // a flag that is gone is no entity
    int step, spawned;
} game;

static wisp_status spawn_flag( game* g )
{
    static wisp_vec3 points[WISP_GRID_VERTICES( SIDE, SIDE )];
    static int32_t triangles[WISP_GRID_TRIANGLES( SIDE, SIDE )][3];
    static const int32_t corners[] = { 0, SIDE - 1 };
    wisp_entity* flag = &g->flags[g->spawned++ % FLAGS];
    if ( wisp_is_alive( g->world, *flag ) )
    {
        wisp_remove( g->world, *flag ); // its handle is stale from now on, also when another entity takes its slot
    }
    wisp_generate_grid( SIDE, SIDE, 0.05f, 0.05f, points, &triangles[0][0], NULL );
    wisp_create_cloth_def def = wisp_default_create_cloth_def();
    def.points = points, def.vertex_count = WISP_COUNT( points );
    def.triangles = &triangles[0][0], def.triangle_count = WISP_COUNT( triangles );
    def.pins = corners, def.pin_count = WISP_COUNT( corners );
    def.drag_coefficient = 1.0f;
    return wisp_create_cloth( g->world, &def, flag );
}

// Before each step: where everything is at its end.
static void before_step( void* user, wisp_world* world )
{
    game* g = user;
    const float time = STEP * (float)++g->step;
    const wisp_vec3 place = { 0.0f, -0.4f, 1.2f * sinf( 2.0f * time ) };
    wisp_move_collider( world, g->ball, wisp_transform_make( ( wisp_quat ){ 0, 0, 0, 1 }, place ) );
    for ( int f = 0; f < FLAGS; ++f )
    {
        if ( wisp_is_alive( world, g->flags[f] ) )
        {
            wisp_set_cloth_wind( world, g->flags[f], ( wisp_vec3 ){ 2.0f * cosf( time ), 0.0f, 2.0f } );
        }
    }
}

// Frames of 7 to 33 ms. What is drawn lies between the last two steps.
static wisp_status play( game* g, int frame_count )
{
    static const float frames[] = { 0.007f, 0.033f, 0.016f, 0.017f };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < frame_count && status == WISP_OK; ++i )
    {
        status = wisp_world_advance( g->world, frames[i % 4], STEP, before_step, g );
    }
    return status;
}

static wisp_status play_all( game* g, uint64_t* hash, bool* repeats )
{
    wisp_collider_def ball_def = wisp_default_collider_def();
    ball_def.kind = WISP_COLLIDER_SPHERE, ball_def.radius = 0.2f;
    ball_def.pose.translation.y = -0.4f;
    wisp_status status = wisp_add_collider( g->world, &ball_def, &g->ball );
    for ( int second = 0; second < 5 && status == WISP_OK; ++second )
    {
        status = spawn_flag( g );
        status = status ? status : play( g, 60 );
    }
    // A snapshot has the state of the entities, so that going back needs the same ones.
    const size_t size = wisp_world_snapshot_size( g->world );
    void* kept = malloc( size );
    status = status || kept == NULL ? status : wisp_world_snapshot( g->world, kept, size );
    const int step = g->step;
    for ( int time = 0; time < 2 && status == WISP_OK; ++time )
    {
        status = time == 0 ? WISP_OK : wisp_world_restore( g->world, kept, size );
        g->step = step;
        for ( int i = 0; i < 60 && status == WISP_OK; ++i )
        {
            before_step( g, g->world );
            status = wisp_world_step( g->world, STEP );
        }
        *repeats = time == 1 && *hash == wisp_world_hash( g->world );
        *hash = wisp_world_hash( g->world );
    }
    free( kept );
    return status;
}

static bool run( pool* p, uint64_t* hash )
{
    game g = { 0 };
    bool repeats = false;
    wisp_error error = { 0 };
    wisp_world_def def = wisp_default_world_def();
    def.modules = wisp_all_modules( &def.module_count );
    def.workers = p ? WORKERS : 1;
    def.parallel_for = p ? pool_for : NULL;
    def.parallel_for_user = p;
    if ( wisp_world_create( &def, &g.world, &error ) != WISP_OK )
    {
        printf( "no world: %s\n", error.message );
        return false;
    }
    const wisp_status status = play_all( &g, hash, &repeats );
    printf( "%d workers: %d flags in %d steps, hash %016llx %s%s\n", wisp_world_workers( g.world ), g.spawned, g.step,
            (unsigned long long)*hash, repeats ? "twice" : "", wisp_world_message( g.world ) );
    wisp_world_destroy( g.world );
    return status == WISP_OK && repeats;
}

int main( void )
{
    static pool threads;
    uint64_t alone = 0, together = 0;
    pool_open( &threads );
    const bool is_good = run( NULL, &alone ) && run( &threads, &together ) && alone == together;
    printf( "%d waves\n", threads.waves );
    pool_close( &threads );
    return is_good ? 0 : 1;
}
