// A crowd: a thousand characters with a scarf each, one world per character, all worlds on a few threads of the host.
//
//     cc -std=c17 -pthread crowd.c $(pkg-config --cflags --libs wisp) -lm -o crowd && ./crowd
//     ./crowd 1000 8 out           1000 characters, 8 threads, and a film in out/crowd.usda
//
// A world with one worker never starts threads of its own, so a host steps many of them side by side on its own. What a character's scarf does
// depends on nobody else: the example runs some of them alone again and compares every bit. The film is in one file per thread, which the file
// crowd.usda lays over each other, so no thread waits for another one to write. Exit status 0 if all is as it should be, 1 if not.
#define _POSIX_C_SOURCE 200809L

#include <wisp/cloth.h>
#include <wisp/collision.h>
#include <wisp/fabric.h>
#include <wisp/generate.h>
#include <wisp/wisp.h>

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define COLUMNS 7 // vertices across a scarf
#define ROWS 25
#define VERTICES WISP_GRID_VERTICES( COLUMNS, ROWS )
#define STEP ( 1.0f / 60.0f )
#define STEPS 120
#define FRAME_STEPS 4 // steps per frame of the film
#define FRAMES ( STEPS / FRAME_STEPS )
#define MOST_THREADS 64
#define ALONE 8 // characters that are run again

static wisp_vec3 points[VERTICES];
static int32_t triangles[WISP_GRID_TRIANGLES( COLUMNS, ROWS )][3];
static int32_t pins[COLUMNS];

// ---- a character ----

typedef struct character
{
    int number;
    wisp_world* world;
    wisp_entity scarf, body;
    wisp_vec3* film; // [FRAMES][VERTICES]; null: it is not filmed
    uint64_t hash;   // of all points after all steps
    wisp_status failed;
} character;

// The neck walks in a circle of its own, and goes up and down with the steps.
static wisp_vec3 neck_of( int number, int step )
{
    const float time = STEP * (float)step, phase = 2.4f * (float)number, pace = 1.0f + 0.1f * (float)( number % 5 );
    return ( wisp_vec3 ){ 3.0f * (float)( number % 32 ) + 0.8f * cosf( phase + pace * time ),
                          1.5f + 0.03f * sinf( 11.0f * pace * time + phase ),
                          3.0f * (float)( number / 32 ) + 0.8f * sinf( phase + pace * time ) };
}

static wisp_vec3 moved( wisp_vec3 p, wisp_vec3 by )
{
    return ( wisp_vec3 ){ p.x + by.x, p.y + by.y, p.z + by.z };
}

static wisp_status add_scarf( character* c, wisp_fabric* fabric )
{
    wisp_vec3 start[VERTICES];
    for ( int v = 0; v < VERTICES; ++v )
    {
        start[v] = moved( points[v], neck_of( c->number, 0 ) );
    }
    wisp_surface_def surface = wisp_default_surface_def();
    surface.fabric = fabric; // shared by all worlds
    surface.points = start;
    surface.pins = pins;
    surface.pin_count = COLUMNS;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.drag_coefficient = 1.0f;
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = 0.01f;
    wisp_collider_def body = wisp_default_collider_def();
    body.kind = WISP_COLLIDER_CAPSULE;
    body.radius = 0.18f;
    body.half_length = 0.3f;
    wisp_status status = wisp_add_surface( c->world, &surface, &c->scarf );
    status = status == WISP_OK ? wisp_set_cloth( c->world, c->scarf, &cloth ) : status;
    status = status == WISP_OK ? wisp_add_collider( c->world, &body, &c->body ) : status;
    status = status == WISP_OK ? wisp_set_collision( c->world, c->scarf, &collision ) : status;
    return status == WISP_OK ? wisp_request( c->world, c->scarf, WISP_SURFACE_POINTS ) : status;
}

static wisp_status create( character* c, int number, wisp_fabric* fabric )
{
    *c = ( character ){ .number = number, .hash = 0xcbf29ce484222325u };
    static const wisp_module* const modules[] = { &wisp_cloth_module, &wisp_collision_module };
    wisp_world_def def = wisp_default_world_def();
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    def.workers = 1;
    def.substeps = 8;
    const wisp_status status = wisp_world_create( &def, &c->world, NULL );
    return status == WISP_OK ? add_scarf( c, fabric ) : status;
}

static void keep_points( character* c, int step )
{
    wisp_view view;
    if ( wisp_world_view( c->world, c->scarf, WISP_SURFACE_POINTS, &view ) != WISP_OK )
    {
        return;
    }
    const unsigned char* bytes = view.data;
    for ( size_t i = 0; i < VERTICES * sizeof( wisp_vec3 ); ++i )
    {
        c->hash = ( c->hash ^ bytes[i] ) * 0x100000001b3u;
    }
    if ( c->film != NULL && step % FRAME_STEPS == FRAME_STEPS - 1 )
    {
        memcpy( c->film + (size_t)( step / FRAME_STEPS ) * VERTICES, view.data, VERTICES * sizeof( wisp_vec3 ) );
    }
}

static void step_character( character* c, int step )
{
    const wisp_vec3 neck = neck_of( c->number, step + 1 );
    const wisp_quat upright = { 0.0f, 0.0f, 0.0f, 1.0f };
    wisp_vec3 targets[COLUMNS];
    for ( int i = 0; i < COLUMNS; ++i )
    {
        targets[i] = moved( points[pins[i]], neck );
    }
    wisp_status status = wisp_move_pins( c->world, c->scarf, pins, targets, COLUMNS );
    const wisp_transform pose = wisp_transform_make( upright, moved( neck, ( wisp_vec3 ){ 0.0f, -0.5f, -0.2f } ) );
    status = status == WISP_OK ? wisp_move_collider( c->world, c->body, pose ) : status;
    status = status == WISP_OK ? wisp_world_step( c->world, STEP ) : status;
    keep_points( c, step );
    c->failed = c->failed == WISP_OK ? status : c->failed;
}

// ---- all of them, on the host's threads ----

typedef struct crowd
{
    character* all;
    int count, threads;
    _Atomic int next; // character of this step
    pthread_barrier_t step_done;
} crowd;

// Whoever is free takes the next character. A step is over when all have made it, as a frame of a game is.
static void* work( void* user )
{
    crowd* c = user;
    for ( int step = 0; step < STEPS; ++step )
    {
        for ( int i = atomic_fetch_add( &c->next, 1 ); i < c->count; i = atomic_fetch_add( &c->next, 1 ) )
        {
            step_character( c->all + i, step );
        }
        if ( pthread_barrier_wait( &c->step_done ) == PTHREAD_BARRIER_SERIAL_THREAD )
        {
            c->next = 0;
        }
        pthread_barrier_wait( &c->step_done );
    }
    return NULL;
}

static double seconds( void )
{
    struct timespec now;
    clock_gettime( CLOCK_MONOTONIC, &now );
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void start( pthread_t* thread, void* ( *run )( void* user ), void* user )
{
    if ( pthread_create( thread, NULL, run, user ) != 0 )
    {
        fprintf( stderr, "a thread could not be started\n" );
        exit( 1 );
    }
}

// @return s
static double run( crowd* c )
{
    pthread_t threads[MOST_THREADS];
    const double begin = seconds();
    c->next = 0;
    pthread_barrier_init( &c->step_done, NULL, (unsigned)c->threads );
    for ( int i = 1; i < c->threads; ++i )
    {
        start( threads + i, work, c );
    }
    work( c );
    for ( int i = 1; i < c->threads; ++i )
    {
        pthread_join( threads[i], NULL );
    }
    pthread_barrier_destroy( &c->step_done );
    return seconds() - begin;
}

// ---- the film ----

typedef struct shard
{
    const crowd* crowd;
    const char* folder;
    int number; // from 0
    bool failed;
} shard;

// Each layer has its own clock, so all say the same.
static void write_head( FILE* file )
{
    fprintf( file, "#usda 1.0\n(\n    defaultPrim = \"crowd\"\n    metersPerUnit = 1\n    upAxis = \"Y\"\n" );
    fprintf( file, "    startTimeCode = 0\n    endTimeCode = %d\n    timeCodesPerSecond = %d\n", FRAMES - 1,
             60 / FRAME_STEPS );
}

static void write_mesh( FILE* file, const character* c )
{
    fprintf( file, "    def Mesh \"scarf_%04d\"\n    {\n        int[] faceVertexCounts = [", c->number );
    for ( int t = 0; t < WISP_COUNT( triangles ); ++t )
    {
        fprintf( file, t > 0 ? ", 3" : "3" );
    }
    fprintf( file, "]\n        int[] faceVertexIndices = [" );
    for ( int t = 0; t < WISP_COUNT( triangles ); ++t )
    {
        fprintf( file, "%s%d, %d, %d", t > 0 ? ", " : "", triangles[t][0], triangles[t][1], triangles[t][2] );
    }
    fprintf( file, "]\n        point3f[] points.timeSamples = {\n" );
    for ( int f = 0; f < FRAMES; ++f )
    {
        fprintf( file, "            %d: [", f );
        for ( int v = 0; v < VERTICES; ++v )
        {
            const wisp_vec3 p = c->film[(size_t)f * VERTICES + (size_t)v];
            fprintf( file, "%s(%.6g, %.6g, %.6g)", v > 0 ? ", " : "", (double)p.x, (double)p.y, (double)p.z );
        }
        fprintf( file, "],\n" );
    }
    fprintf( file, "        }\n    }\n" );
}

// The characters of a shard, each with the same name in the tree as in any other number of shards.
static void* write_shard( void* user )
{
    shard* s = user;
    const crowd* c = s->crowd;
    char path[1024];
    snprintf( path, sizeof path, "%s/crowd-%d.usda", s->folder, s->number + 1 );
    FILE* file = fopen( path, "w" );
    s->failed = file == NULL;
    if ( file == NULL )
    {
        return NULL;
    }
    write_head( file );
    fprintf( file, ")\n\ndef Xform \"crowd\"\n{\n" );
    for ( int i = s->number * c->count / c->threads; i < ( s->number + 1 ) * c->count / c->threads; ++i )
    {
        write_mesh( file, c->all + i );
    }
    fprintf( file, "}\n" );
    s->failed = ferror( file ) != 0;
    s->failed = fclose( file ) != 0 || s->failed;
    return NULL;
}

static bool write_film( const crowd* c, const char* folder )
{
    char path[1024];
    shard shards[MOST_THREADS];
    pthread_t threads[MOST_THREADS];
    bool good = mkdir( folder, 0777 ) == 0 || access( folder, W_OK ) == 0;
    for ( int i = 0; i < c->threads && good; ++i )
    {
        shards[i] = ( shard ){ c, folder, i, false };
        start( threads + i, write_shard, shards + i );
    }
    for ( int i = 0, count = good ? c->threads : 0; i < count; ++i )
    {
        good = pthread_join( threads[i], NULL ) == 0 && shards[i].failed == false && good;
    }
    snprintf( path, sizeof path, "%s/crowd.usda", folder );
    FILE* file = good ? fopen( path, "w" ) : NULL;
    if ( file == NULL )
    {
        return false;
    }
    write_head( file );
    fprintf( file, "    subLayers = [\n" );
    for ( int i = 0; i < c->threads; ++i )
    {
        fprintf( file, "        @./crowd-%d.usda@%s\n", i + 1, i + 1 < c->threads ? "," : "" );
    }
    fprintf( file, "    ]\n)\n" );
    return fclose( file ) == 0;
}

// ---- together and alone ----

static wisp_status cook( wisp_fabric** out, wisp_error* error )
{
    // it hangs down the chest from the pinned end
    wisp_generate_grid( COLUMNS, ROWS, 0.03f, 0.03f, points, &triangles[0][0], NULL );
    for ( int v = 0; v < VERTICES; ++v )
    {
        const float along = points[v].z + 0.03f * 0.5f * ( ROWS - 1 );
        points[v] = ( wisp_vec3 ){ points[v].x, -along, 0.02f };
    }
    for ( int i = 0; i < COLUMNS; ++i )
    {
        pins[i] = i;
    }
    wisp_fabric_def def = wisp_default_fabric_def();
    def.points = points;
    def.vertex_count = VERTICES;
    def.triangles = &triangles[0][0];
    def.triangle_count = WISP_COUNT( triangles );
    return wisp_fabric_cook( &def, NULL, out, error );
}

static bool is_the_same_alone( const character* together, wisp_fabric* fabric )
{
    character alone;
    bool same = create( &alone, together->number, fabric ) == WISP_OK;
    for ( int step = 0; step < STEPS && same; ++step )
    {
        step_character( &alone, step );
    }
    same = same && alone.failed == WISP_OK && alone.hash == together->hash;
    wisp_world_destroy( alone.world );
    return same;
}

static bool create_all( crowd* c, wisp_fabric* fabric, bool is_filmed )
{
    bool good = c->all != NULL;
    for ( int i = 0; i < c->count && good; ++i )
    {
        good = create( c->all + i, i, fabric ) == WISP_OK;
        if ( good == false )
        {
            fprintf( stderr, "character %d: %s\n", i,
                     c->all[i].world ? wisp_world_message( c->all[i].world ) : "no world" );
        }
        c->all[i].film = is_filmed ? calloc( (size_t)FRAMES * VERTICES, sizeof( wisp_vec3 ) ) : NULL;
        good = good && ( is_filmed == false || c->all[i].film != NULL );
    }
    return good;
}

static bool check( const crowd* c, wisp_fabric* fabric )
{
    for ( int i = 0; i < c->count; ++i )
    {
        if ( c->all[i].failed != WISP_OK )
        {
            fprintf( stderr, "character %d: %s\n", i, wisp_world_message( c->all[i].world ) );
            return false;
        }
    }
    for ( int k = 0; k < ALONE && k < c->count; ++k )
    {
        const int i = c->count < ALONE ? k : k * c->count / ALONE;
        if ( is_the_same_alone( c->all + i, fabric ) == false )
        {
            fprintf( stderr, "character %d moves otherwise when it is alone\n", i );
            return false;
        }
    }
    return true;
}

int main( int argc, char** argv )
{
    const long cores = sysconf( _SC_NPROCESSORS_ONLN );
    crowd c = { .count = argc > 1 ? atoi( argv[1] ) : 100, .threads = argc > 2 ? atoi( argv[2] ) : (int)cores };
    if ( c.count < 1 || c.count > 100000 || argc > 4 )
    {
        fprintf( stderr, "usage: crowd [CHARACTERS [THREADS [FOLDER]]], 1 to 100000 characters\n" );
        return 64;
    }
    c.threads = c.threads < 1 ? 1 : c.threads > MOST_THREADS ? MOST_THREADS : c.threads;
    wisp_error error = { 0 };
    wisp_fabric* fabric = NULL;
    if ( cook( &fabric, &error ) != WISP_OK )
    {
        fprintf( stderr, "%s\n", error.message );
        return 1;
    }
    c.all = calloc( (size_t)c.count, sizeof *c.all );
    bool good = create_all( &c, fabric, argc > 3 );
    if ( good )
    {
        const double time = run( &c ), film = STEPS * (double)STEP;
        printf( "%d characters of %d vertices on %d thread%s: %.1f ms a step, %.2f x real time, %.0f KiB a world\n",
                c.count, VERTICES, c.threads, c.threads == 1 ? "" : "s", 1e3 * time / STEPS, film / time,
                (double)wisp_world_memory( c.all[0].world ) / 1024.0 );
        good = check( &c, fabric );
        if ( good )
        {
            printf( "%d of them move the same when they are alone\n", c.count < ALONE ? c.count : ALONE );
        }
        if ( good && argc > 3 && write_film( &c, argv[3] ) == false )
        {
            fprintf( stderr, "%s: the film could not be written\n", argv[3] );
            good = false;
        }
    }
    for ( int i = 0; i < c.count && c.all != NULL; ++i )
    {
        wisp_world_destroy( c.all[i].world );
        free( c.all[i].film );
    }
    free( c.all );
    wisp_fabric_release( fabric );
    return good ? 0 : 1;
}
