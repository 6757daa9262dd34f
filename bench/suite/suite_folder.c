#include "suite_folder.h"

#include "accuracy/accuracy.h"
#include "program_data.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

static int is_suite( const struct dirent* entry )
{
    const char* dot = strrchr( entry->d_name, '.' );
    return dot && strcmp( dot, ".yaml" ) == 0;
}

wisp_status suite_bench_names( const char* folder, const char* const* names, int count, double seconds,
                               const bench_options* options, results* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    bench_options each = *options;
    each.seconds = seconds / count;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        char inner[128], path[1024];
        snprintf( inner, sizeof inner, "suites/%s/%s.yaml", folder, names[i] );
        program_data_path( inner, path, sizeof path );
        status = suite_bench( path, &each, out, error );
    }
    return status;
}

wisp_status suite_bench_folder( const char* folder, double seconds, const bench_options* options, results* out,
                                wisp_error* error )
{
    char inner[128], path[1024], file[1300];
    struct dirent** entries = NULL;
    snprintf( inner, sizeof inner, "suites/%s", folder );
    program_data_path( inner, path, sizeof path );
    const int count = scandir( path, &entries, is_suite, alphasort );
    wisp_status status = count > 0 ? WISP_OK
                                   : wisp_fail( error, WISP_IO_ERROR, "%s: no suites are there: %s", path,
                                                count < 0 ? strerror( errno ) : "the folder has none" );
    for ( int i = 0; i < count; ++i )
    {
        bench_options each = *options;
        each.seconds = seconds / count;
        snprintf( file, sizeof file, "%s/%s", path, entries[i]->d_name );
        status = status == WISP_OK ? suite_bench( file, &each, out, error ) : status;
        free( entries[i] );
    }
    free( entries );
    return status;
}
