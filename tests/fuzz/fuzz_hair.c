// Any bytes as a .hair file: rejected with a message, or read, checked, described, written and read back.
#include "fuzz.h"

#include "groom.h"

static bool fuzz_same( const void* a, const void* b, size_t size )
{
    return ( a == NULL ) == ( b == NULL ) && ( a == NULL || memcmp( a, b, size ) == 0 );
}

typedef wisp_status fuzz_writer( FILE* out, const wisp_groom* groom, const char* name, wisp_error* error );

/// @return the text or bytes, for free(); null when the format cannot hold the groom
static char* fuzz_write( fuzz_writer* write, const wisp_groom* groom, size_t* size )
{
    char* bytes = NULL;
    *size = 0;
    FILE* stream = open_memstream( &bytes, size );
    demand( stream != NULL );
    wisp_error error = { .status = WISP_OK };
    wisp_status status = write( stream, groom, "fuzz", &error );
    fclose( stream );
    if ( status != WISP_OK )
    {
        demand( status == WISP_BAD_INPUT && error.message[0] != 0 && *size == 0 );
        free( bytes );
        return NULL;
    }
    return bytes;
}

static void fuzz_round_trip( const wisp_groom* groom )
{
    size_t size = 0;
    char* bytes = fuzz_write( wisp_groom_write_hair, groom, &size );
    if ( bytes == NULL )
    {
        return;
    }
    wisp_groom again;
    demand( wisp_groom_read_hair( bytes, size, "again", &again, NULL ) == WISP_OK );
    free( bytes );
    size_t vertices = (size_t)groom->vertex_count;
    demand( again.strand_count == groom->strand_count && again.vertex_count == groom->vertex_count );
    demand( again.dimension == groom->dimension );
    demand( fuzz_same( again.offsets, groom->offsets, ( (size_t)groom->strand_count + 1 ) * sizeof( int ) ) );
    demand( fuzz_same( again.points, groom->points, vertices * sizeof( wisp_vec3 ) ) );
    demand( fuzz_same( again.thickness, groom->thickness, vertices * sizeof( float ) ) );
    demand( fuzz_same( again.transparency, groom->transparency, vertices * sizeof( float ) ) );
    demand( fuzz_same( again.colour, groom->colour, vertices * sizeof( wisp_vec3 ) ) );
    wisp_groom_release( &again );
}

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size )
{
    wisp_groom groom;
    wisp_error error = { .status = WISP_OK };
    const wisp_status status = wisp_groom_read_hair( data, size, "fuzz.hair", &groom, &error );
    if ( status != WISP_OK )
    {
        demand_refusal( status, &error );
        demand( groom.offsets == NULL && groom.points == NULL );
        return 0;
    }
    // The groom may be accepted or rejected; a rejection must come with its message.
    demand( wisp_groom_check( &groom, &error ) == WISP_OK || error.message[0] != 0 );
    fuzz_round_trip( &groom );
    free( fuzz_write( wisp_groom_write_usda, &groom, &size ) );
    free( fuzz_write( wisp_groom_write_obj, &groom, &size ) );
    char* text = NULL;
    FILE* stream = open_memstream( &text, &size );
    demand( stream != NULL );
    demand( wisp_groom_info( stream, &groom, "fuzz" ) == WISP_OK );
    fclose( stream );
    free( text );
    wisp_groom_release( &groom );
    return 0;
}
