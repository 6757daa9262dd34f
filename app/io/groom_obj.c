// Wavefront OBJ: every vertex in order, then the segments. A segment is an `l` line of its own, although the format
// allows a whole strand in one: Blender reads only the first segment of a longer line.
#include "groom_internal.h"

#include "io_file.h"

#include "wisp/module/definition.h"

wisp_status wisp_groom_write_obj( FILE* out, const wisp_groom* groom, const char* name, wisp_error* error )
{
    WISP_TRY( groom_check_finite( groom, name, error ) );
    io_numbers numbers;
    WISP_TRY( io_numbers_begin( &numbers, error ) );
    fprintf( out, "# Wisp %s: %d strands, %d vertices, metres\no groom\n", WISP_VERSION_STRING, groom->strand_count,
             groom->vertex_count );
    for ( int v = 0; v < groom->vertex_count; ++v )
    {
        wisp_vec3 p = groom->points[v];
        // Nine digits restore every float bit for bit.
        fprintf( out, "v %.9g %.9g %.9g\n", (double)p.x, (double)p.y, (double)p.z );
    }
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        // OBJ counts from 1, so vertex v + 1 has the number v + 2.
        for ( int v = groom->offsets[s]; v + 1 < groom->offsets[s + 1]; ++v )
        {
            fprintf( out, "l %d %d\n", v + 1, v + 2 );
        }
    }
    io_numbers_end( &numbers );
    return WISP_OK;
}
