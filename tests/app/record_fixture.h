/// Bodies, points and folders that the recording tests share.
#pragma once

#ifndef _XOPEN_SOURCE
#define _XOPEN_SOURCE 700
#endif

#include "unit.h"

#include "record.h"

#include <dirent.h>
#include <unistd.h>

enum
{
    FIXTURE_BODIES = 2,
    CLOTH_VERTICES = 4,
    HAIR_VERTICES = 5,
};

static const int32_t fixture_triangles[] = { 0, 1, 2, 2, 1, 3 };
static const int32_t fixture_offsets[] = { 0, 3, 5 };

/// A square of two triangles, and two strands.
static const wisp_record_body fixture_bodies[FIXTURE_BODIES] = {
    { .name = "cloth", .triangles = fixture_triangles, .vertex_count = CLOTH_VERTICES, .triangle_count = 2 },
    { .name = "hair-2", .offsets = fixture_offsets, .vertex_count = HAIR_VERTICES, .strand_count = 2 },
};

/// Points of all bodies in one frame.
typedef struct fixture_frame
{
    wisp_vec3 cloth[CLOTH_VERTICES];
    wisp_vec3 hair[HAIR_VERTICES];
} fixture_frame;

/// Numbers that only nine digits bring back, other ones in every frame.
static inline fixture_frame fixture_points( int f )
{
    fixture_frame frame = {
        .cloth = { { 0.1f, -0.0f, 1e-40f },
                   { 1.0f / 3.0f, -123456.789f, 0x1.fffffep-1f },
                   { 1.17549435e-38f, 2.5f, -7.0f },
                   { 16777217.0f, 1e6f, -1e-10f } },
        .hair = { { 0.3f, 0.6f, 0.9f },
                  { 3.4028235e38f, -0.7f, 8.0f },
                  { 0.0f, 0.0f, 0.0f },
                  { -0.1f, -0.2f, -0.3f },
                  { 121.360634f, 122.243706f, 100.670395f } },
    };
    frame.cloth[2].y += 0.1f * (float)f;
    frame.hair[4].x *= (float)( f + 1 );
    return frame;
}

static inline double fixture_time( int f )
{
    return ( f + 1 ) / 60.0;
}

static inline uint64_t fixture_hash( int f )
{
    return 0x0123456789abcdefu * (uint64_t)( f + 1 );
}

static inline wisp_recorder_def fixture_def( void )
{
    return ( wisp_recorder_def ){ fixture_bodies, FIXTURE_BODIES, 1.0 / 60.0 };
}

static inline wisp_status fixture_add_frame( wisp_recorder* recorder, int f, wisp_error* error )
{
    fixture_frame frame = fixture_points( f );
    const wisp_vec3* points[] = { frame.cloth, frame.hair };
    return wisp_recorder_frame( recorder, fixture_time( f ), fixture_hash( f ), points, error );
}

static inline void assert_good( wisp_status status, const wisp_error* error )
{
    if ( status != WISP_OK )
    {
        fail_msg( "%s: %s", wisp_status_name( status ), error->message );
    }
}

/// Record that many frames of the fixture; everything must succeed.
static inline void fixture_record( const char* path, const wisp_recorder_def* def, int frame_count )
{
    wisp_error error = { .status = WISP_OK };
    wisp_recorder* recorder = NULL;
    assert_good( wisp_recorder_open( path, WISP_RECORD_BY_NAME, def, &recorder, &error ), &error );
    for ( int f = 0; f < frame_count; ++f )
    {
        assert_good( fixture_add_frame( recorder, f, &error ), &error );
    }
    assert_good( wisp_recorder_close( recorder, &error ), &error );
}

static inline void assert_contains( const char* text, const char* words )
{
    if ( text == NULL || strstr( text, words ) == NULL )
    {
        fail_msg( "expected \"%s\" in:\n%s", words, text == NULL ? "nothing at all" : text );
    }
}

static inline void assert_one_message( const wisp_error* error, wisp_status status, const char* words )
{
    assert_int_equal( error->status, status );
    assert_null( strchr( error->message, '\n' ) );
    assert_contains( error->message, words );
}

// ---- a folder of its own for every test ----

typedef struct folder
{
    char path[64];
} folder;

static inline int make_folder( void** state )
{
    folder* f = malloc( sizeof *f );
    if ( f == NULL )
    {
        return -1;
    }
    strcpy( f->path, "test-record-XXXXXX" );
    *state = f;
    return mkdtemp( f->path ) != NULL ? 0 : -1;
}

/// @return static storage, overwritten by the fourth call after this one
static inline char* path_in( void** state, const char* name )
{
    static char paths[4][512];
    static int turn;
    char* path = paths[turn++ % 4];
    snprintf( path, sizeof paths[0], "%s/%s", ( (folder*)*state )->path, name );
    return path;
}

/// Files in a folder, hidden ones too; or remove them and what is one level below.
static inline int walk_folder( const char* path, bool removing )
{
    DIR* walk = opendir( path );
    int count = 0;
    for ( struct dirent* entry = walk != NULL ? readdir( walk ) : NULL; entry != NULL; entry = readdir( walk ) )
    {
        if ( strcmp( entry->d_name, "." ) != 0 && strcmp( entry->d_name, ".." ) != 0 )
        {
            char inner[1024];
            snprintf( inner, sizeof inner, "%s/%s", path, entry->d_name );
            if ( removing && remove( inner ) != 0 )
            {
                walk_folder( inner, true );
                remove( inner );
            }
            ++count;
        }
    }
    if ( walk != NULL )
    {
        closedir( walk );
    }
    return count;
}

static inline int count_files( void** state )
{
    return walk_folder( ( (folder*)*state )->path, false );
}

static inline int remove_folder( void** state )
{
    walk_folder( ( (folder*)*state )->path, true );
    int status = rmdir( ( (folder*)*state )->path );
    free( *state );
    return status;
}

static inline void put_file( const char* path, const void* bytes, size_t size )
{
    FILE* file = fopen( path, "wb" );
    assert_non_null( file );
    assert_int_equal( fwrite( bytes, 1, size, file ), size );
    fclose( file );
}

/// @return zero-terminated, for free()
static inline unsigned char* get_file( const char* path, size_t* size )
{
    FILE* file = fopen( path, "rb" );
    if ( file == NULL )
    {
        fail_msg( "%s: missing", path );
        return NULL;
    }
    fseek( file, 0, SEEK_END );
    *size = (size_t)ftell( file );
    rewind( file );
    unsigned char* bytes = malloc( *size + 1 );
    assert_non_null( bytes );
    assert_int_equal( fread( bytes, 1, *size, file ), *size );
    bytes[*size] = 0;
    fclose( file );
    return bytes;
}

#define TEST_IN_FOLDER( name ) cmocka_unit_test_setup_teardown( name, make_folder, remove_folder )
