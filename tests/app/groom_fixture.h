/// Grooms and texts shared by the groom tests.
#pragma once

#include "folder_fixture.h"

#include "groom.h"

/// Strands of 3, 1 and 2 vertices with all arrays, and numbers that need nine digits to be restored. Static storage:
/// never release it.
static inline wisp_groom fixture_groom( void )
{
    static int offsets[] = { 0, 3, 4, 6 };
    static wisp_vec3 points[] = {
        { 0.1f, -0.0f, 1e-40f },
        { 1.0f / 3.0f, -123456.789f, 0x1.fffffep-1f },
        { 1.17549435e-38f, 2.5f, -7.0f },
        { 16777217.0f, 1e6f, -1e-10f },
        { 0.3f, 0.6f, 0.9f },
        { 3.4028235e38f, -0.7f, 8.0f },
    };
    static float thickness[] = { 1e-4f, 0.9e-4f, 0.1e-4f, 8e-5f, 0.0f, 1.0f / 7.0f };
    static float transparency[] = { 0.0f, 0.25f, 0.5f, 0.75f, 1.0f, 0.125f };
    static wisp_vec3 colour[] = {
        { 0.0f, 0.1f, 0.2f }, { 0.3f, 0.4f, 0.5f },          { 0.6f, 0.7f, 0.8f },
        { 0.9f, 1.0f, 0.0f }, { 1.0f / 3.0f, 0.01f, 0.02f }, { 0.03f, 0.04f, 0.05f },
    };
    return ( wisp_groom ){ 3, 6, 3, offsets, points, thickness, transparency, colour };
}

/// The fixture without its strand of one vertex, which USD cannot hold.
static inline wisp_groom fixture_curves( void )
{
    static int offsets[] = { 0, 4, 6 };
    wisp_groom groom = fixture_groom();
    groom.strand_count = 2;
    groom.offsets = offsets;
    return groom;
}

static inline void assert_same_groom( const wisp_groom* a, const wisp_groom* b )
{
    assert_int_equal( a->strand_count, b->strand_count );
    assert_int_equal( a->vertex_count, b->vertex_count );
    assert_int_equal( a->dimension, b->dimension );
    size_t vertices = (size_t)a->vertex_count;
    assert_memory_equal( a->offsets, b->offsets, ( (size_t)a->strand_count + 1 ) * sizeof( int ) );
    assert_memory_equal( a->points, b->points, vertices * sizeof( wisp_vec3 ) );
    assert_int_equal( a->thickness == NULL, b->thickness == NULL );
    assert_int_equal( a->transparency == NULL, b->transparency == NULL );
    assert_int_equal( a->colour == NULL, b->colour == NULL );
    if ( a->thickness != NULL )
    {
        assert_memory_equal( a->thickness, b->thickness, vertices * sizeof( float ) );
    }
    if ( a->transparency != NULL )
    {
        assert_memory_equal( a->transparency, b->transparency, vertices * sizeof( float ) );
    }
    if ( a->colour != NULL )
    {
        assert_memory_equal( a->colour, b->colour, vertices * sizeof( wisp_vec3 ) );
    }
}

typedef wisp_status fixture_writer( FILE* out, const wisp_groom* groom, const char* name, wisp_error* error );

/// The output of a writer.
/// @return zero-terminated, for free()
/// Not inlined: gcc 12 would mistake the stream's buffer for the local that held its address.
__attribute__( ( noinline, unused ) ) static char* fixture_written( fixture_writer* write, const wisp_groom* groom,
                                                                    size_t* size )
{
    char* text = NULL;
    size_t length = 0;
    FILE* stream = open_memstream( &text, &length );
    assert_non_null( stream );
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( write( stream, groom, "written", &error ), WISP_OK );
    fclose( stream );
    if ( size != NULL )
    {
        *size = length;
    }
    return text;
}
