// Makes the stored references of `wisp bench accuracy`, of scenes that need the oracle for it.
#include "accuracy_references.h"

#include <stdio.h>
#include <string.h>

typedef struct reference_item
{
    const char* name;
    accuracy_reference_fn* make;
} reference_item;

static const reference_item items[] = {
    { "balloon_flight", reference_of_balloon_flight },
    { "balloon_meshes", reference_of_balloon_meshes },
};

static int make( const reference_item* item, const char* folder )
{
    wisp_error error = { 0 };
    accuracy_reference reference = { .numbers = NULL };
    const double begin = wisp_clock_seconds();
    wisp_status status = item->make( &reference, &error );
    status = status == WISP_OK ? accuracy_reference_write( &reference, folder, &error ) : status;
    accuracy_reference_free( &reference );
    if ( status != WISP_OK )
    {
        fprintf( stderr, "wisp_reference: %s: %s\n", item->name, error.message );
        return 1;
    }
    printf( "%s: %.1f s\n", item->name, wisp_clock_seconds() - begin );
    return 0;
}

int main( int argc, char** argv )
{
    const bool has_scene = argc == 4 && strcmp( argv[1], "--scene" ) == 0;
    if ( argc != 2 && !has_scene )
    {
        fputs( "usage: wisp_reference [--scene NAME] FOLDER\n"
               "Write FOLDER/NAME.reference for every scene, or for one.\n",
               stderr );
        return 64;
    }
    int made = 0, failed = 0;
    for ( int i = 0; i < WISP_COUNT( items ) && failed == 0; ++i )
    {
        if ( !has_scene || strcmp( argv[2], items[i].name ) == 0 )
        {
            failed = make( &items[i], argv[argc - 1] );
            ++made;
        }
    }
    if ( made == 0 )
    {
        fprintf( stderr, "wisp_reference: there is no scene '%s' that has a stored reference\n", argv[2] );
    }
    return made == 0 ? 64 : failed;
}
