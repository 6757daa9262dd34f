// ParaView: a .vtp file per body and frame, and a .pvd file that lists them with their times. Arrays are base64
// inside the XML: exact like raw bytes, and still XML for every other reader. The array's length in bytes and its
// numbers are one base64 stream, as in VTK's own writer.
#include "base64.h"
#include "record_internal.h"

#include "wisp/module/definition.h"

#include <math.h>

// Triangles or lines of a body.
typedef struct vtk_cells
{
    const int32_t* vertices; // [vertex_count] of all cells
    int32_t* ends;           // [count] of each cell in `vertices`
    int vertex_count, count;
} vtk_cells;

// ---- arrays ----------------------------------------------------------------------------------------------------

static io_base64 begin_array( FILE* out, const char* type, const char* name, const char* components, size_t bytes )
{
    fprintf( out, "        <DataArray type=\"%s\" Name=\"%s\"%s format=\"binary\">", type, name, components );
    io_base64 stream = { .out = out };
    unsigned char size[8];
    io_put_u64( size, bytes );
    io_base64_put( &stream, size, sizeof size );
    return stream;
}

static void end_array( io_base64* stream )
{
    io_base64_end( stream );
    fputs( "</DataArray>\n", stream->out );
}

// Numbers of 4 bytes each.
static void write_words( FILE* out, const char* type, const char* name, const char* components, const void* words,
                         size_t count )
{
    io_base64 stream = begin_array( out, type, name, components, 4 * count );
    for ( size_t i = 0; i < count; ++i )
    {
        unsigned char bytes[4];
        io_put_words( bytes, (const unsigned char*)words + 4 * i, 1 );
        io_base64_put( &stream, bytes, sizeof bytes );
    }
    end_array( &stream );
}

static void write_floats( FILE* out, const char* name, const float* numbers, int count )
{
    write_words( out, "Float32", name, "", numbers, (size_t)count );
}

static void write_vectors( FILE* out, const char* name, const wisp_vec3* vectors, int count )
{
    write_words( out, "Float32", name, " NumberOfComponents=\"3\"", vectors, 3 * (size_t)count );
}

static void write_cells( FILE* out, const char* kind, const vtk_cells* cells )
{
    fprintf( out, "      <%s>\n", kind );
    write_words( out, "Int32", "connectivity", "", cells->vertices, (size_t)cells->vertex_count );
    write_words( out, "Int32", "offsets", "", cells->ends, (size_t)cells->count );
    fprintf( out, "      </%s>\n", kind );
}

// VTK takes bytes for colours as they are, and shows them without a conversion: they have the transfer function of sRGB.
static unsigned char to_byte( float linear )
{
    const float shown = linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf( linear, 1.0f / 2.4f ) - 0.055f;
    return (unsigned char)( 255.0f * shown + 0.5f );
}

static void write_colours( FILE* out, const wisp_vec3* colours, int count )
{
    io_base64 stream = begin_array( out, "UInt8", "RGB", " NumberOfComponents=\"3\"", 3 * (size_t)count );
    for ( int v = 0; v < count; ++v )
    {
        const unsigned char bytes[3] = { to_byte( colours[v].x ), to_byte( colours[v].y ), to_byte( colours[v].z ) };
        io_base64_put( &stream, bytes, sizeof bytes );
    }
    end_array( &stream );
}

// ---- .vtp ------------------------------------------------------------------------------------------------------

/// @param normals null: none
static void write_point_data( FILE* out, const wisp_record_body* body, const wisp_vec3* normals )
{
    // What ParaView colours by at first: a value, else the width.
    const char* scalars = body->value_count > 0 ? body->values[0].name : body->widths != NULL ? "width" : NULL;
    fputs( "      <PointData", out );
    if ( scalars != NULL )
    {
        fprintf( out, " Scalars=\"%s\"", scalars );
    }
    fputs( normals != NULL ? " Normals=\"Normals\">\n" : ">\n", out );
    if ( normals != NULL )
    {
        write_vectors( out, "Normals", normals, body->vertex_count );
    }
    for ( int i = 0; i < body->value_count; ++i )
    {
        write_floats( out, body->values[i].name, body->values[i].numbers, body->vertex_count );
    }
    if ( body->widths != NULL )
    {
        write_floats( out, "width", body->widths, body->vertex_count );
    }
    if ( body->colours != NULL )
    {
        write_colours( out, body->colours, body->vertex_count );
    }
    fputs( "      </PointData>\n", out );
}

// The first file of a static body without values serves all frames, and has no time.
static bool is_for_all_frames( const wisp_record_body* body )
{
    return body->is_static && body->value_count == 0;
}

static void write_vtp( FILE* out, const wisp_recorder* recorder, int b, const record_frame* frame )
{
    const wisp_record_body* body = &recorder->bodies[b];
    const vtk_cells* cells = (const vtk_cells*)recorder->file + b;
    const wisp_vec3* points = frame->points[b];
    fputs( "<?xml version=\"1.0\"?>\n"
           "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
           "  <PolyData>\n",
           out );
    if ( !is_for_all_frames( body ) )
    {
        fprintf( out,
                 "    <FieldData>\n"
                 "      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">%.17g"
                 "</DataArray>\n"
                 "    </FieldData>\n",
                 frame->time );
    }
    fprintf( out,
             "    <Piece NumberOfPoints=\"%d\" NumberOfVerts=\"0\" NumberOfLines=\"%d\" NumberOfStrips=\"0\" "
             "NumberOfPolys=\"%d\">\n",
             body->vertex_count, body->offsets != NULL ? cells->count : 0, body->triangle_count );
    write_point_data( out, body, body->triangle_count > 0 ? record_normals( recorder, b, points ) : NULL );
    fputs( "      <Points>\n", out );
    write_vectors( out, "Points", points, body->vertex_count );
    fputs( "      </Points>\n", out );
    write_cells( out, body->offsets != NULL ? "Lines" : "Polys", cells );
    fputs( "    </Piece>\n  </PolyData>\n</VTKFile>\n", out );
}

// ---- .pvd ------------------------------------------------------------------------------------------------------

// A polyline needs two vertices; the vertex of a shorter strand stays a point without a line.
static void list_cells( wisp_recorder* recorder, const wisp_record_body* body, vtk_cells* cells )
{
    const bool strands = body->offsets != NULL;
    const int most = strands ? body->strand_count : body->triangle_count;
    int32_t* vertices =
        strands ? record_get( &recorder->memory, (size_t)body->vertex_count * sizeof *vertices ) : NULL;
    cells->ends = record_get( &recorder->memory, (size_t)most * sizeof *cells->ends );
    cells->vertices = strands ? vertices : body->triangles;
    for ( int i = 0; i < most && !recorder->memory.is_short; ++i )
    {
        const int size = strands ? body->offsets[i + 1] - body->offsets[i] : 3;
        for ( int v = 0; v < size && size >= 2 && strands; ++v )
        {
            vertices[cells->vertex_count + v] = body->offsets[i] + v;
        }
        if ( size >= 2 )
        {
            cells->vertex_count += size;
            cells->ends[cells->count++] = cells->vertex_count;
        }
    }
}

static wisp_status pvd_begin( wisp_recorder* recorder, wisp_error* error )
{
    if ( record_extension( recorder )[0] == 0 )
    {
        return record_wrong( error, recorder->path,
                             "expected a name with an extension; without it, it is the folder of the frames" );
    }
    vtk_cells* cells = record_get( &recorder->memory, (size_t)recorder->body_count * sizeof *cells );
    recorder->file = cells;
    for ( int b = 0; cells != NULL && b < recorder->body_count; ++b )
    {
        list_cells( recorder, &recorder->bodies[b], &cells[b] );
    }
    if ( recorder->memory.is_short )
    {
        return record_no_memory( recorder->path, error );
    }
    io_output* list = &recorder->outputs[0];
    WISP_TRY( io_output_open( recorder->path, list, error ) );
    WISP_TRY( io_folder_make( record_path_beside( recorder, "%s", "" ), error ) );
    fputs( "<?xml version=\"1.0\"?>\n"
           "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
           "  <Collection>\n",
           list->stream );
    return WISP_OK;
}

static void write_escaped( FILE* out, const char* text )
{
    for ( ; *text != 0; ++text )
    {
        const char* name = *text == '&' ? "&amp;" : *text == '<' ? "&lt;" : *text == '"' ? "&quot;" : NULL;
        name != NULL ? fputs( name, out ) : fputc( *text, out );
    }
}

// Number of the file that has a body in this frame.
static int file_number( const wisp_recorder* recorder, int b )
{
    return is_for_all_frames( &recorder->bodies[b] ) ? 1 : recorder->frame_count + 1;
}

static wisp_status write_body( wisp_recorder* recorder, int b, const record_frame* frame, wisp_error* error )
{
    io_output output;
    const char* path =
        record_path_beside( recorder, "/%s_%04d.vtp", recorder->bodies[b].name, file_number( recorder, b ) );
    WISP_TRY( io_output_open( path, &output, error ) );
    write_vtp( output.stream, recorder, b, frame );
    return io_output_commit( &output, error );
}

static wisp_status pvd_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int b = 0; b < recorder->body_count && status == WISP_OK; ++b )
    {
        if ( file_number( recorder, b ) == recorder->frame_count + 1 )
        {
            status = write_body( recorder, b, frame, error );
        }
    }
    // Paths in the list are relative to it, so that both can move together.
    FILE* out = recorder->outputs[0].stream;
    for ( int b = 0; b < recorder->body_count && status == WISP_OK; ++b )
    {
        const char* name = recorder->bodies[b].name;
        fprintf( out, "    <DataSet timestep=\"%.17g\" group=\"\" part=\"%d\" name=\"%s\" file=\"", frame->time, b,
                 name );
        write_escaped( out, io_file_name( record_path_beside( recorder, "%s", "" ) ) );
        fprintf( out, "/%s_%04d.vtp\"/>\n", name, file_number( recorder, b ) );
    }
    return status;
}

static wisp_status pvd_end( wisp_recorder* recorder, wisp_error* error )
{
    (void)error;
    fputs( "  </Collection>\n</VTKFile>\n", recorder->outputs[0].stream );
    return WISP_OK;
}

const record_format record_format_pvd = {
    ".pvd", .has_values = true, .has_normals = true, .begin = pvd_begin, .frame = pvd_frame, .end = pvd_end,
};
