// USD text: one BasisCurves prim, linear, so that a strand is exactly its polyline. Metres, y up.
#include "groom_internal.h"

#include "io_file.h"

#include "wisp/module/definition.h"
#include <math.h>

// ---- .obj ----

// Wavefront OBJ: every vertex in order, then the segments. A segment is an `l` line of its own, although the format
// allows a whole strand in one: Blender reads only the first segment of a longer line.

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

// ---- .usda ----

// A linear curve of one vertex has no segment: USD calls it invalid, so it is rejected here rather than dropped.
static wisp_status check_fits( const wisp_groom* groom, const char* name, wisp_error* error )
{
    wisp_status status = groom_check_finite( groom, name, error );
    for ( int s = 0; status == WISP_OK && s < groom->strand_count; ++s )
    {
        int count = groom->offsets[s + 1] - groom->offsets[s];
        if ( count < 2 )
        {
            status = wisp_fail( error, WISP_BAD_INPUT,
                                "%s: strand %d has %d vertices; a curve in a .usda file needs at least 2",
                                io_short_name( name ), s, count );
        }
    }
    return status;
}

static void write_counts( FILE* out, const wisp_groom* groom )
{
    fputs( "    int[] curveVertexCounts = [", out );
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        fprintf( out, "%s%d", s > 0 ? ", " : "", groom->offsets[s + 1] - groom->offsets[s] );
    }
    fputs( "]\n", out );
}

// Nine digits restore every float bit for bit.
static void write_vector( FILE* out, wisp_vec3 v )
{
    fprintf( out, "(%.9g, %.9g, %.9g)", (double)v.x, (double)v.y, (double)v.z );
}

// One line per strand: files with a single very long line stop editors.
static void write_values( FILE* out, const wisp_groom* groom, const char* type_and_name, const float* values,
                          int width, bool from_one )
{
    fprintf( out, "    %s = [\n", type_and_name );
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        fputs( "        ", out );
        for ( int v = groom->offsets[s]; v < groom->offsets[s + 1]; ++v )
        {
            const float* value = values + (size_t)width * (size_t)v;
            if ( width == 3 )
            {
                write_vector( out, ( wisp_vec3 ){ value[0], value[1], value[2] } );
            }
            else
            {
                fprintf( out, "%.9g", (double)( from_one ? 1.0f - *value : *value ) );
            }
            fputs( v + 1 == groom->vertex_count ? "\n" : v + 1 == groom->offsets[s + 1] ? ",\n" : ", ", out );
        }
    }
    fputs( "    ]", out );
}

// The box of the curves as drawn: half the largest width around the points.
static void write_extent( FILE* out, const wisp_groom* groom )
{
    io_bounds bounds = { .filled = false };
    float width = 0.0f;
    io_extend_bounds( &bounds, groom->points, groom->vertex_count );
    for ( int v = 0; groom->thickness != NULL && v < groom->vertex_count; ++v )
    {
        width = fmaxf( width, groom->thickness[v] );
    }
    const wisp_vec3 least = bounds.least, most = bounds.most;
    const float half = 0.5f * width;
    fputs( "    float3[] extent = [", out );
    write_vector( out, ( wisp_vec3 ){ least.x - half, least.y - half, least.z - half } );
    fputs( ", ", out );
    write_vector( out, ( wisp_vec3 ){ most.x + half, most.y + half, most.z + half } );
    fputs( "]\n", out );
}

static void write_curves( FILE* out, const wisp_groom* groom )
{
    static const char per_vertex[] = " (\n        interpolation = \"vertex\"\n    )\n";
    fputs( "def BasisCurves \"Groom\"\n{\n"
           "    uniform token type = \"linear\"\n"
           "    uniform token wrap = \"nonperiodic\"\n",
           out );
    write_counts( out, groom );
    write_extent( out, groom );
    write_values( out, groom, "point3f[] points", (const float*)groom->points, 3, false );
    fputs( "\n", out );
    if ( groom->thickness != NULL )
    {
        write_values( out, groom, "float[] widths", groom->thickness, 1, false );
        fputs( per_vertex, out );
    }
    if ( groom->colour != NULL )
    {
        write_values( out, groom, "color3f[] primvars:displayColor", (const float*)groom->colour, 3, false );
        fputs( per_vertex, out );
    }
    if ( groom->transparency != NULL )
    {
        write_values( out, groom, "float[] primvars:displayOpacity", groom->transparency, 1, true );
        fputs( per_vertex, out );
    }
    fputs( "}\n", out );
}

wisp_status wisp_groom_write_usda( FILE* out, const wisp_groom* groom, const char* name, wisp_error* error )
{
    WISP_TRY( check_fits( groom, name, error ) );
    io_numbers numbers;
    WISP_TRY( io_numbers_begin( &numbers, error ) );
    fputs( "#usda 1.0\n(\n"
           "    defaultPrim = \"Groom\"\n"
           "    doc = \"Wisp " WISP_VERSION_STRING "\"\n"
           "    metersPerUnit = 1\n"
           "    upAxis = \"Y\"\n"
           ")\n\n",
           out );
    write_curves( out, groom );
    io_numbers_end( &numbers );
    return WISP_OK;
}
