// ParaView: a .vtp file per body and frame, and a .pvd file that lists them with their times. Arrays are base64
// inside the XML: exact like raw bytes, and still XML for every other reader. The array's length in bytes and its
// numbers are one base64 stream, as in VTK's own writer.

#include "base64.h"
#include "record_internal.h"

#include <math.h>
#include <stdlib.h>

// ---- arrays ----------------------------------------------------------------------------------------------------

static void put_number( io_base64* stream, int value )
{
    unsigned char bytes[4];
    io_put_u32( bytes, (uint32_t)value );
    io_base64_put( stream, bytes, sizeof bytes );
}

static io_base64 begin_array( FILE* out, const char* attributes, uint64_t byte_count )
{
    fprintf( out, "        <DataArray %s format=\"binary\">", attributes );
    io_base64 stream = { .out = out };
    unsigned char bytes[8];
    io_put_u64( bytes, byte_count );
    io_base64_put( &stream, bytes, sizeof bytes );
    return stream;
}

static void end_array( io_base64* stream )
{
    io_base64_end( stream );
    fputs( "</DataArray>\n", stream->out );
}

// ---- .vtp ------------------------------------------------------------------------------------------------------

static const char connectivity[] = "type=\"Int32\" Name=\"connectivity\"";
static const char ends[] = "type=\"Int32\" Name=\"offsets\"";

static void write_vectors( FILE* out, const char* name, const wisp_vec3* vectors, int count )
{
    char attributes[100];
    snprintf( attributes, sizeof attributes, "type=\"Float32\" Name=\"%s\" NumberOfComponents=\"3\"", name );
    io_base64 stream = begin_array( out, attributes, RECORD_POINT_SIZE * (uint64_t)count );
    for ( int v = 0; v < count; ++v )
    {
        unsigned char bytes[RECORD_POINT_SIZE];
        io_put_vec3( bytes, vectors[v] );
        io_base64_put( &stream, bytes, sizeof bytes );
    }
    end_array( &stream );
}

static void write_numbers( FILE* out, const char* name, const float* numbers, int count )
{
    char attributes[60 + WISP_RECORD_MAX_NAME];
    snprintf( attributes, sizeof attributes, "type=\"Float32\" Name=\"%s\"", name );
    io_base64 stream = begin_array( out, attributes, 4 * (uint64_t)count );
    for ( int v = 0; v < count; ++v )
    {
        unsigned char bytes[4];
        io_put_float( bytes, numbers[v] );
        io_base64_put( &stream, bytes, sizeof bytes );
    }
    end_array( &stream );
}

// VTK takes bytes for colours as they are, and shows them without a conversion: they have the transfer function of sRGB.
static unsigned char to_byte( float linear )
{
    const float shown = linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf( linear, 1.0f / 2.4f ) - 0.055f;
    return (unsigned char)( 255.0f * shown + 0.5f );
}

static void write_colours( FILE* out, const wisp_vec3* colours, int count )
{
    io_base64 stream =
        begin_array( out, "type=\"UInt8\" Name=\"RGB\" NumberOfComponents=\"3\"", 3 * (uint64_t)count );
    for ( int v = 0; v < count; ++v )
    {
        const unsigned char bytes[3] = { to_byte( colours[v].x ), to_byte( colours[v].y ), to_byte( colours[v].z ) };
        io_base64_put( &stream, bytes, sizeof bytes );
    }
    end_array( &stream );
}

// What ParaView colours by at first: a value, else the width.
static const char* scalars_of( const wisp_record_body* body )
{
    return body->value_count > 0 ? body->values[0].name : body->widths != NULL ? "width" : NULL;
}

/// @param normals null: none
static void write_point_data( FILE* out, const wisp_record_body* body, const wisp_vec3* normals )
{
    const char* scalars = scalars_of( body );
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
        write_numbers( out, body->values[i].name, body->values[i].numbers, body->vertex_count );
    }
    if ( body->widths != NULL )
    {
        write_numbers( out, "width", body->widths, body->vertex_count );
    }
    if ( body->colours != NULL )
    {
        write_colours( out, body->colours, body->vertex_count );
    }
    fputs( "      </PointData>\n", out );
}

static void write_points( FILE* out, const wisp_vec3* points, int count )
{
    fputs( "      <Points>\n", out );
    write_vectors( out, "Points", points, count );
    fputs( "      </Points>\n", out );
}

static void write_triangles( FILE* out, const wisp_record_body* body )
{
    size_t corners = 3 * (size_t)body->triangle_count;
    fputs( "      <Polys>\n", out );
    io_base64 stream = begin_array( out, connectivity, 4 * (uint64_t)corners );
    for ( size_t i = 0; i < corners; ++i )
    {
        put_number( &stream, body->triangles[i] );
    }
    end_array( &stream );
    stream = begin_array( out, ends, 4 * (uint64_t)body->triangle_count );
    for ( int t = 0; t < body->triangle_count; ++t )
    {
        put_number( &stream, 3 * ( t + 1 ) );
    }
    end_array( &stream );
    fputs( "      </Polys>\n", out );
}

// A polyline needs two vertices; the vertex of a shorter strand stays a point without a line.
static bool is_line( const wisp_record_body* body, int s )
{
    return body->offsets[s + 1] - body->offsets[s] >= 2;
}

typedef struct line_counts
{
    int lines, vertices;
} line_counts;

static line_counts count_lines( const wisp_record_body* body )
{
    line_counts counts = { 0, 0 };
    for ( int s = 0; s < body->strand_count; ++s )
    {
        bool line = is_line( body, s );
        counts.lines += line;
        counts.vertices += line ? body->offsets[s + 1] - body->offsets[s] : 0;
    }
    return counts;
}

static void write_lines( FILE* out, const wisp_record_body* body, line_counts counts )
{
    fputs( "      <Lines>\n", out );
    io_base64 stream = begin_array( out, connectivity, 4 * (uint64_t)counts.vertices );
    for ( int s = 0; s < body->strand_count; ++s )
    {
        for ( int v = body->offsets[s]; is_line( body, s ) && v < body->offsets[s + 1]; ++v )
        {
            put_number( &stream, v );
        }
    }
    end_array( &stream );
    stream = begin_array( out, ends, 4 * (uint64_t)counts.lines );
    for ( int s = 0, end = 0; s < body->strand_count; ++s )
    {
        if ( is_line( body, s ) )
        {
            end += body->offsets[s + 1] - body->offsets[s];
            put_number( &stream, end );
        }
    }
    end_array( &stream );
    fputs( "      </Lines>\n", out );
}

// The first file of a static body without values serves all frames, and has no time.
static bool is_for_all_frames( const wisp_record_body* body )
{
    return body->is_static && body->value_count == 0;
}

static void write_vtp( FILE* out, const wisp_recorder* recorder, int b, const record_frame* frame )
{
    const wisp_record_body* body = &recorder->bodies.list[b];
    const wisp_vec3* points = frame->points[b];
    line_counts counts = count_lines( body );
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
             body->vertex_count, counts.lines, body->triangle_count );
    write_point_data( out, body, body->triangle_count > 0 ? record_normals( recorder, b, points ) : NULL );
    write_points( out, points, body->vertex_count );
    if ( body->offsets != NULL )
    {
        write_lines( out, body, counts );
    }
    else
    {
        write_triangles( out, body );
    }
    fputs( "    </Piece>\n  </PolyData>\n</VTKFile>\n", out );
}

// ---- .pvd ------------------------------------------------------------------------------------------------------

typedef struct pvd_file
{
    io_output list; // the .pvd
    char* folder;   // of the .vtp files
} pvd_file;

static void write_escaped( FILE* out, const char* text )
{
    for ( ; *text != 0; ++text )
    {
        switch ( *text )
        {
            case '&':
                fputs( "&amp;", out );
                break;
            case '<':
                fputs( "&lt;", out );
                break;
            case '"':
                fputs( "&quot;", out );
                break;
            default:
                fputc( *text, out );
        }
    }
}

static wisp_status pvd_start( const wisp_recorder* recorder, pvd_file* file, wisp_error* error )
{
    wisp_status status = io_output_open( recorder->path, &file->list, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = io_folder_make( file->folder, error );
    if ( status != WISP_OK )
    {
        io_output_discard( &file->list );
        return status;
    }
    fputs( "<?xml version=\"1.0\"?>\n"
           "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
           "  <Collection>\n",
           file->list.stream );
    return WISP_OK;
}

static wisp_status pvd_open( wisp_recorder* recorder, wisp_error* error )
{
    size_t stem = record_stem_length( recorder->path );
    if ( recorder->path[stem] == 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: expected a name with an extension; without it, it is the folder of the frames",
                          io_short_name( recorder->path ) );
    }
    pvd_file* file = calloc( 1, sizeof *file );
    wisp_status status = WISP_NO_MEMORY;
    if ( file == NULL || ( file->folder = strndup( recorder->path, stem ) ) == NULL )
    {
        status = record_no_memory( recorder->path, error );
    }
    else
    {
        status = pvd_start( recorder, file, error );
    }
    if ( status != WISP_OK )
    {
        free( file != NULL ? file->folder : NULL );
        free( file );
        return status;
    }
    recorder->file = file;
    return WISP_OK;
}

static wisp_status write_body( const char* path, const wisp_recorder* recorder, int b, const record_frame* frame,
                               wisp_error* error )
{
    io_output output;
    wisp_status status = io_output_open( path, &output, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    write_vtp( output.stream, recorder, b, frame );
    return io_output_commit( &output, error );
}

static bool is_written( const wisp_recorder* recorder, const wisp_record_body* body )
{
    return recorder->frame_count == 0 || !is_for_all_frames( body );
}

static wisp_status write_bodies( const wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    const pvd_file* file = recorder->file;
    size_t room = strlen( file->folder ) + WISP_RECORD_MAX_NAME + 32;
    char* path = malloc( room );
    wisp_status status = path != NULL ? WISP_OK : record_no_memory( recorder->path, error );
    for ( int b = 0; status == WISP_OK && b < recorder->bodies.count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies.list[b];
        if ( is_written( recorder, body ) )
        {
            snprintf( path, room, "%s/%s_%04d.vtp", file->folder, body->name, recorder->frame_count + 1 );
            status = write_body( path, recorder, b, frame, error );
        }
    }
    free( path );
    return status;
}

// Paths in the list are relative to it, so that both can move together.
static void list_bodies( const wisp_recorder* recorder, const record_frame* frame )
{
    const pvd_file* file = recorder->file;
    const char* slash = strrchr( file->folder, '/' );
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies.list[b];
        const char* name = body->name;
        FILE* out = file->list.stream;
        fprintf( out, "    <DataSet timestep=\"%.17g\" group=\"\" part=\"%d\" name=\"%s\" file=\"", frame->time, b,
                 name );
        write_escaped( out, slash == NULL ? file->folder : slash + 1 );
        fprintf( out, "/%s_%04d.vtp\"/>\n", name, is_written( recorder, body ) ? recorder->frame_count + 1 : 1 );
    }
}

static wisp_status pvd_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    io_numbers numbers;
    wisp_status status = io_numbers_begin( &numbers, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = write_bodies( recorder, frame, error );
    if ( status == WISP_OK )
    {
        list_bodies( recorder, frame );
    }
    io_numbers_end( &numbers );
    return status;
}

static wisp_status pvd_close( wisp_recorder* recorder, wisp_error* error )
{
    pvd_file* file = recorder->file;
    fputs( "  </Collection>\n</VTKFile>\n", file->list.stream );
    wisp_status status = io_output_commit( &file->list, error );
    free( file->folder );
    free( file );
    return status;
}

const record_format record_format_pvd = { ".pvd", true, true, pvd_open, pvd_frame, pvd_close };
