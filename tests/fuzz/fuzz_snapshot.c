// Snapshots of the smallest scene of every module and of some larger ones, with words that any bytes choose, and hashes that fit:
// refused with a message while the world stays what it was, or restored and stepped.
#include "fuzz.h"

#include "world.h"
#include "world_from_scene.h"

#include <glob.h>

enum
{
    MAX_SCENES = 64,
    MAX_WOUNDS = 4,
    HASHED = 24, // place of the hash in the header
    HEADER = 32,
};

// A scene after some steps.
typedef struct subject
{
    wisp_scene scene;
    scene_world world;
    unsigned char *good, *bad; // snapshots
    size_t size;
} subject;

static void open_subject( const char* path, subject* out )
{
    const scene_world_options options = { .workers = 1, .isa = "baseline", .is_quiet = true };
    demand( wisp_scene_read( path, &out->scene, NULL ) == WISP_OK );
    demand( scene_world_create( &out->scene, &options, &out->world, NULL ) == WISP_OK );
    demand( scene_world_step( &out->world, NULL ) == WISP_OK && scene_world_step( &out->world, NULL ) == WISP_OK );
    out->size = wisp_world_snapshot_size( out->world.world );
    out->good = malloc( out->size );
    out->bad = malloc( out->size );
    demand( out->good != NULL && out->bad != NULL );
    demand( wisp_world_snapshot( out->world.world, out->good, out->size ) == WISP_OK );
}

static void close_subject( subject* s )
{
    scene_world_destroy( &s->world );
    wisp_scene_release( &s->scene );
    free( s->good );
    free( s->bad );
    *s = ( subject ){ .good = NULL };
}

static uint32_t word_at( const uint8_t* data, size_t size, size_t at )
{
    uint32_t word = 0;
    for ( size_t i = 0; i < 4; ++i )
    {
        word = word << 8 | data[( at + i ) % size];
    }
    return word;
}

// A value that tells: out of every range, beside what was there, not finite, or any.
static uint32_t wounded( uint32_t was, uint32_t kind, uint32_t any )
{
    const uint32_t telling[] = { 0xffffffffu, 0x80000000u, 0x7fffffffu, 0x7fc00000u, 0x7f800000u, 0u,
                                 was + 1,     was - 1,     was * 4u,    any & 255u,  any };
    return telling[kind % ( sizeof telling / sizeof *telling )];
}

// Write a word of a column in the world; each column is as likely as any other, however few rows it has.
static void wound_column( const store* s, uint32_t choice, uint32_t kind, uint32_t any )
{
    const store_entity* e = s->entities + choice % (uint32_t)s->entity_count;
    for ( uint32_t k = choice >> 8; e->alive; ++k )
    {
        const int c = 1 + (int)( k % (uint32_t)( s->component_count - 1 ) );
        const wisp_component_def* def = &s->components[c].def;
        if ( store_mask_has( &e->components, c ) && def->column_count > 0 && e->rows[def->table].count > 0 )
        {
            const int column = (int)( ( choice >> 4 ) % (uint32_t)def->column_count );
            const size_t words = (size_t)e->rows[def->table].count * def->columns[column].row_size / 4;
            uint32_t* rows = store_column( s, e, (wisp_component)c, column );
            uint32_t* word = rows + any % words;
            *word = wounded( *word, kind, any );
            return;
        }
    }
}

static void seal( const subject* s )
{
    const size_t content = s->size - HEADER - sizeof( step_clock );
    const uint64_t hash = store_hash_bytes( 0, s->bad + HEADER, content );
    memcpy( s->bad + HASHED, &hash, sizeof hash );
}

static void make_bad( const subject* s, const uint8_t* data, size_t size )
{
    const int count = 1 + data[size - 1] % MAX_WOUNDS;
    for ( int i = 0; i < count; ++i )
    {
        const size_t at = 1 + size * (size_t)i / MAX_WOUNDS;
        wound_column( &s->world.world->store, word_at( data, size, at ), data[( at + 4 ) % size],
                      word_at( data, size, at + 5 ) );
    }
    demand( wisp_world_snapshot( s->world.world, s->bad, s->size ) == WISP_OK );
    if ( size > 16 && data[size - 2] % 8 == 0 )
    {
        s->bad[word_at( data, size, 9 ) % s->size] ^= data[13];
        seal( s );
    }
}

// @return false if the world has to be built again: what tears has other columns
static bool run( const subject* s )
{
    wisp_world* world = s->world.world;
    demand( wisp_world_restore( world, s->good, s->size ) == WISP_OK );
    const uint64_t before = wisp_world_hash( world );
    if ( wisp_world_restore( world, s->bad, s->size ) != WISP_OK )
    {
        wisp_error error = { .status = WISP_BAD_INPUT };
        snprintf( error.message, sizeof error.message, "%s", wisp_world_message( world ) );
        demand_refusal( WISP_BAD_INPUT, &error );
        demand( wisp_world_hash( world ) == before );
        return true;
    }
    bool steps = true;
    for ( int i = 0; i < 2 && steps; ++i )
    {
        steps = wisp_world_step( world, s->scene.dt ) == WISP_OK;
    }
    return steps && wisp_world_snapshot_size( world ) == s->size &&
           wisp_world_restore( world, s->good, s->size ) == WISP_OK;
}

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size )
{
    static subject subjects[MAX_SCENES];
    static glob_t found;
    if ( found.gl_pathc == 0 )
    {
        demand( glob( WISP_SOURCE_ROOT "/data/suites/scenes/effects/*.yaml", 0, NULL, &found ) == 0 );
        demand( glob( WISP_SOURCE_ROOT "/data/scenes/{detail,hair_on_balloon,pear_jet,solids,swinging_guides}.yaml",
                      GLOB_APPEND | GLOB_BRACE, NULL, &found ) == 0 );
        demand( found.gl_pathc <= MAX_SCENES );
    }
    if ( size < 2 )
    {
        return 0;
    }
    const size_t chosen = ( data[0] + data[size / 2] ) % found.gl_pathc;
    subject* s = subjects + chosen;
    if ( s->good == NULL )
    {
        open_subject( found.gl_pathv[chosen], s );
    }
    make_bad( s, data, size );
    if ( run( s ) == false )
    {
        close_subject( s );
    }
    return 0;
}
