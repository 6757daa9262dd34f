#include "run_memory.h"

#include <stdio.h>
#include <stdlib.h>

// Parts below this percentage are one line, and those that are not in use.
static const double SMALL_PERCENT = 1.0;

static const char* const KINDS[] = {
    [WISP_MEMORY_ENGINE] = "engine",
    [WISP_MEMORY_MODULE] = "module",
    [WISP_MEMORY_COMPONENT] = "component",
    [WISP_MEMORY_OUTSIDE] = "outside the world",
};

// @return null without memory
static wisp_memory_part* list_parts( const wisp_world* world, int* count, double* sum )
{
    *count = wisp_world_memory_parts( world, NULL, 0 );
    wisp_memory_part* parts = calloc( (size_t)*count, sizeof *parts );
    *sum = 0.0;
    if ( parts )
    {
        wisp_world_memory_parts( world, parts, *count );
        for ( int i = 0; i < *count; ++i )
        {
            *sum += (double)parts[i].capacity;
        }
    }
    return parts;
}

static void add_line( results* out, int table, const char* name, const char* kind, double bytes, double percent,
                      int vertices )
{
    char text[3][24];
    snprintf( text[0], sizeof text[0], "%.1f", bytes / 1024.0 );
    snprintf( text[1], sizeof text[1], "%.1f", vertices > 0 ? bytes / vertices : 0.0 );
    snprintf( text[2], sizeof text[2], "%.1f", percent );
    results_add_cells( out, table, ( const char* const[] ){ name, kind, text[0], text[1], text[2] } );
}

void run_memory_report( const wisp_world* world, int vertices, results* out )
{
    const char* const header[] = { "part", "of", "KiB", "bytes / vertex", "%" };
    double sum, small = 0.0;
    int count, small_count = 0;
    wisp_memory_part* parts = list_parts( world, &count, &sum );
    if ( parts == NULL )
    {
        return;
    }
    const int table = results_add_table( out, "Memory by part (allocated, with fabrics and Embree)", 5, header );
    for ( int i = 0; i < count; ++i )
    {
        const double bytes = (double)parts[i].capacity, percent = 100.0 * bytes / sum;
        // a module without entities has a state all the same
        if ( percent < SMALL_PERCENT || parts[i].bytes == 0 )
        {
            small += bytes;
            ++small_count;
            continue;
        }
        add_line( out, table, parts[i].name, KINDS[parts[i].kind], bytes, percent, vertices );
    }
    if ( small_count > 0 )
    {
        char name[48];
        snprintf( name, sizeof name, "other (%d part%s)", small_count, small_count == 1 ? "" : "s" );
        add_line( out, table, name, "", small, 100.0 * small / sum, vertices );
    }
    free( parts );
}

void run_memory_put( const wisp_world* world, results_values* out )
{
    static const char* const names[] = { "engine_bytes", "module_bytes", "component_bytes", "outside_bytes" };
    double bytes[WISP_COUNT( names )] = { 0 }, sum;
    int count;
    wisp_memory_part* parts = list_parts( world, &count, &sum );
    for ( int i = 0; parts && i < count; ++i )
    {
        bytes[parts[i].kind] += (double)parts[i].capacity;
    }
    for ( int i = 0; parts && i < WISP_COUNT( names ); ++i )
    {
        results_put( out, names[i], bytes[i] );
    }
    free( parts );
}
