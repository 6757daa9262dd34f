// A body as a USD prim: its mesh or curves, and all samples of its attributes.
#include "record_usda.h"

#include <math.h>

// m. Curves without widths are drawn a metre thick; this is a hair.
static const float drawn_width = 1e-4f;

// ---- one sample ------------------------------------------------------------------------------------------------

// A prim that is being written.
typedef struct usda_prim
{
    const wisp_recorder* recorder;
    const usda_file* file;
    const wisp_record_body* body;
    int number; // of the body
    int value;  // of the body, for write_numbers()
    FILE* out;
} usda_prim;

// Writes the sample of a frame, without brackets.
typedef wisp_status sample_writer( const usda_prim* prim, int frame, wisp_error* error );

static void write_vector( FILE* out, wisp_vec3 v )
{
    // Nine digits restore every float bit for bit.
    fprintf( out, "(%.9g, %.9g, %.9g)", (double)v.x, (double)v.y, (double)v.z );
}

static void write_vectors( FILE* out, const wisp_vec3* vectors, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        fputs( v > 0 ? ", " : "", out );
        write_vector( out, vectors[v] );
    }
}

static void write_floats( FILE* out, const float* numbers, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        fprintf( out, "%s%.9g", v > 0 ? ", " : "", (double)numbers[v] );
    }
}

static wisp_status load_points( const usda_prim* prim, int frame, wisp_vec3* out, wisp_error* error )
{
    if ( prim->body->is_static )
    {
        memcpy( out, prim->recorder->fixed[prim->number], (size_t)prim->body->vertex_count * sizeof *out );
        return WISP_OK;
    }
    return record_waiting_points( prim->recorder, prim->file->waiting, frame, prim->number, out, error );
}

static wisp_status write_points( const usda_prim* prim, int frame, wisp_error* error )
{
    wisp_vec3* points = prim->file->points[0];
    wisp_status status = load_points( prim, frame, points, error );
    if ( status == WISP_OK )
    {
        write_vectors( prim->out, points, prim->body->vertex_count );
    }
    return status;
}

static void write_corners( FILE* out, const wisp_record_body* body )
{
    for ( size_t i = 0; i < 3 * (size_t)body->triangle_count; ++i )
    {
        fprintf( out, "%s%d", i > 0 ? ", " : "", body->triangles[i] );
    }
}

static wisp_status write_triangles( const usda_prim* prim, int frame, wisp_error* error )
{
    const wisp_status status = load_points( prim, frame, prim->file->points[0], error );
    write_corners( prim->out, prim->body );
    return status;
}

static wisp_status write_normals( const usda_prim* prim, int frame, wisp_error* error )
{
    wisp_vec3* points = prim->file->points[0];
    wisp_status status = load_points( prim, frame, points, error );
    if ( status == WISP_OK )
    {
        write_vectors( prim->out, record_normals( prim->recorder, prim->number, points ), prim->body->vertex_count );
    }
    return status;
}

static float largest_width( const wisp_record_body* body )
{
    float width = body->offsets != NULL && body->widths == NULL ? drawn_width : 0.0f;
    for ( int v = 0; body->offsets != NULL && body->widths != NULL && v < body->vertex_count; ++v )
    {
        width = fmaxf( width, body->widths[v] );
    }
    return width;
}

// The box of a body as drawn: half a width around the points of curves.
static wisp_status write_extent( const usda_prim* prim, int frame, wisp_error* error )
{
    wisp_vec3* points = prim->file->points[0];
    wisp_status status = load_points( prim, frame, points, error );
    if ( status == WISP_OK )
    {
        record_bounds bounds = { .filled = false };
        record_extend_bounds( &bounds, points, prim->body->vertex_count );
        const float half = 0.5f * largest_width( prim->body );
        const wisp_vec3 corners[2] = {
            { bounds.least.x - half, bounds.least.y - half, bounds.least.z - half },
            { bounds.most.x + half, bounds.most.y + half, bounds.most.z + half },
        };
        write_vectors( prim->out, corners, 2 );
    }
    return status;
}

// Load the points of two frames. A vertex that is split between them comes from where its corners were.
static wisp_status load_two( const usda_prim* prim, int before, int after, wisp_error* error )
{
    const usda_file* file = prim->file;
    const wisp_record_body* body = prim->body;
    wisp_status status = load_points( prim, before, file->points[0], error );
    if ( body->triangles_change )
    {
        memcpy( file->triangles, body->triangles, (size_t)record_triangle_bytes( body ) );
    }
    status = status == WISP_OK ? load_points( prim, after, file->points[1], error ) : status;
    if ( status == WISP_OK && body->triangles_change )
    {
        record_carry_corners( body, file->triangles, body->triangles, file->points[0] );
    }
    return status;
}

// Central differences of the frames around, one-sided at the ends: what motion blur around a frame needs. Where vertices are
// split between frames, from the frame before.
static wisp_status write_velocities( const usda_prim* prim, int frame, wisp_error* error )
{
    const usda_file* file = prim->file;
    const int before = frame > 0 ? frame - 1 : 0;
    const bool is_last = frame + 1 >= prim->recorder->frame_count || ( prim->body->triangles_change && frame > 0 );
    const int after = is_last ? frame : frame + 1;
    const wisp_status status = load_two( prim, before, after, error );
    if ( status == WISP_OK )
    {
        const double time =
            record_waiting_time( file->waiting, after ) - record_waiting_time( file->waiting, before );
        for ( int v = 0; v < prim->body->vertex_count; ++v )
        {
            const wisp_vec3 a = file->points[0][v], b = file->points[1][v];
            file->points[1][v] = ( wisp_vec3 ){ (float)( ( (double)b.x - (double)a.x ) / time ),
                                                (float)( ( (double)b.y - (double)a.y ) / time ),
                                                (float)( ( (double)b.z - (double)a.z ) / time ) };
        }
        write_vectors( prim->out, file->points[1], prim->body->vertex_count );
    }
    return status;
}

static wisp_status write_numbers( const usda_prim* prim, int frame, wisp_error* error )
{
    wisp_status status = record_waiting_numbers( prim->recorder, prim->file->waiting, frame, prim->number,
                                                 prim->value, prim->file->numbers, error );
    if ( status == WISP_OK )
    {
        write_floats( prim->out, prim->file->numbers, prim->body->vertex_count );
    }
    return status;
}

// ---- attributes ------------------------------------------------------------------------------------------------

static void write_interpolation( FILE* out, const char* interpolation )
{
    fprintf( out, " (\n            interpolation = \"%s\"\n        )\n", interpolation );
}

// @param interpolation null: none is written
static wisp_status write_samples( const usda_prim* prim, const char* type_and_name, const char* interpolation,
                                  sample_writer* write, wisp_error* error )
{
    FILE* out = prim->out;
    if ( interpolation != NULL )
    {
        // In one line: three.js takes a line with a colon and without an equals sign for a sample.
        fprintf( out, "        %s (interpolation = \"%s\")\n", type_and_name, interpolation );
    }
    fprintf( out, "        %s.timeSamples = {\n", type_and_name );
    wisp_status status = WISP_OK;
    for ( int f = 0; f < prim->recorder->frame_count && status == WISP_OK; ++f )
    {
        fprintf( out, "            %.17g: [", usda_code( prim->recorder, f ) );
        status = write( prim, f, error );
        fputs( "],\n", out );
    }
    fputs( "        }\n", out );
    return status;
}

// An attribute of points: one default value of a static body, time samples of others.
static wisp_status write_attribute( const usda_prim* prim, const char* type_and_name, const char* interpolation,
                                    sample_writer* write, wisp_error* error )
{
    if ( !prim->body->is_static )
    {
        return write_samples( prim, type_and_name, interpolation, write, error );
    }
    fprintf( prim->out, "        %s = [", type_and_name );
    wisp_status status = write( prim, 0, error );
    fputs( "]", prim->out );
    if ( interpolation != NULL )
    {
        write_interpolation( prim->out, interpolation );
    }
    else
    {
        fputs( "\n", prim->out );
    }
    return status;
}

static wisp_status write_values( usda_prim* prim, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < prim->body->value_count && status == WISP_OK; ++i )
    {
        char attribute[WISP_RECORD_MAX_NAME + 32];
        snprintf( attribute, sizeof attribute, "float[] primvars:%s", prim->body->values[i].name );
        prim->value = i;
        status = write_samples( prim, attribute, "vertex", write_numbers, error );
    }
    return status;
}

// Without a frame there are none, because some readers refuse an empty list of samples.
static wisp_status write_all_attributes( usda_prim* prim, wisp_error* error )
{
    const wisp_record_body* body = prim->body;
    if ( prim->recorder->frame_count == 0 )
    {
        return WISP_OK;
    }
    wisp_status status = write_attribute( prim, "float3[] extent", NULL, write_extent, error );
    status = status == WISP_OK ? write_attribute( prim, "point3f[] points", NULL, write_points, error ) : status;
    if ( status == WISP_OK && body->triangles_change )
    {
        status = write_samples( prim, "int[] faceVertexIndices", NULL, write_triangles, error );
    }
    if ( status == WISP_OK && body->triangle_count > 0 )
    {
        status = write_attribute( prim, "normal3f[] normals", "vertex", write_normals, error );
    }
    if ( status == WISP_OK && !body->is_static && prim->recorder->frame_count > 1 )
    {
        status = write_samples( prim, "vector3f[] velocities", NULL, write_velocities, error );
    }
    return status == WISP_OK ? write_values( prim, error ) : status;
}

// ---- prims -----------------------------------------------------------------------------------------------------

static void write_mesh( FILE* out, const wisp_record_body* body )
{
    fputs( "        uniform bool doubleSided = 1\n"
           "        int[] faceVertexCounts = [",
           out );
    for ( int t = 0; t < body->triangle_count; ++t )
    {
        fputs( t > 0 ? ", 3" : "3", out );
    }
    fputs( "]\n", out );
    if ( body->triangles_change == false )
    {
        fputs( "        int[] faceVertexIndices = [", out );
        write_corners( out, body );
        fputs( "]\n", out );
    }
    // Without this the mesh would be drawn as a subdivision surface, smoother than what was simulated.
    fputs( "        uniform token subdivisionScheme = \"none\"\n", out );
}

static void write_curves( FILE* out, const wisp_record_body* body )
{
    fputs( "        int[] curveVertexCounts = [", out );
    for ( int s = 0; s < body->strand_count; ++s )
    {
        fprintf( out, "%s%d", s > 0 ? ", " : "", body->offsets[s + 1] - body->offsets[s] );
    }
    fputs( "]\n"
           "        uniform token type = \"linear\"\n"
           "        uniform token wrap = \"nonperiodic\"\n"
           "        float[] widths = [",
           out );
    body->widths != NULL ? write_floats( out, body->widths, body->vertex_count )
                         : write_floats( out, &drawn_width, 1 );
    fputs( "]", out );
    write_interpolation( out, body->widths != NULL ? "vertex" : "constant" );
}

static void write_colour( FILE* out, const wisp_record_body* body )
{
    const wisp_vec3 base = record_base_colour( body );
    fputs( "        color3f[] primvars:displayColor = [", out );
    body->colours != NULL ? write_vectors( out, body->colours, body->vertex_count ) : write_vectors( out, &base, 1 );
    fputs( "]", out );
    write_interpolation( out, body->colours != NULL ? "vertex" : "constant" );
}

wisp_status usda_write_body( const wisp_recorder* recorder, int b, wisp_error* error )
{
    const wisp_record_body* body = &recorder->bodies.list[b];
    const usda_file* file = recorder->file;
    usda_prim prim = { recorder, file, body, b, 0, file->output.stream };
    char name[WISP_RECORD_MAX_NAME + 2];
    usda_name( body->name, name );
    fprintf( prim.out, "\n    def %s \"%s\"\n    {\n", body->offsets != NULL ? "BasisCurves" : "Mesh", name );
    body->offsets != NULL ? write_curves( prim.out, body ) : write_mesh( prim.out, body );
    write_colour( prim.out, body );
    wisp_status status = write_all_attributes( &prim, error );
    fputs( "    }\n", prim.out );
    return status;
}
