// ParaView: a .vtp file per body and frame, and a .pvd file that lists them with their times. Arrays are base64
// inside the XML: exact like raw bytes, and still XML for every other reader. The array's length in bytes and its
// numbers are one base64 stream, as in VTK's own writer.
#include "base64.h"
#include "groom_internal.h"

#include "record_internal.h"

#include "wisp/module/definition.h"
#include <limits.h>
#include <math.h>
#include <stdarg.h>

// ---- bodies ----

// Bodies and their points: checks that writers and readers share, copies, normals, boxes.

// ---- checks ----------------------------------------------------------------------------------------------------

// A body of a file, for messages.
typedef struct checked
{
    const wisp_record_body* body;
    const char* file;
    wisp_error* error;
} checked;

// @param vertex -1: none
WISP_PRINTF( 3, 4 )
static wisp_status wrong( const checked* c, int vertex, const char* format, ... )
{
    char message[512];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( message, sizeof message, format, arguments );
    va_end( arguments );
    return vertex < 0 ? record_wrong( c->error, c->file, "body %s: %s", c->body->name, message )
                      : record_wrong( c->error, c->file, "body %s, vertex %d: %s", c->body->name, vertex, message );
}

static wisp_status check_mesh( const checked* c )
{
    const wisp_record_body* body = c->body;
    // Three corners a triangle must fit an int, because ParaView counts them.
    if ( body->triangle_count < 0 || body->triangle_count > INT_MAX / 3 )
    {
        return wrong( c, -1, "got %d triangles, expected 0 .. %d", body->triangle_count, INT_MAX / 3 );
    }
    if ( body->triangle_count > 0 && body->triangles == NULL )
    {
        return wrong( c, -1, "the list of its %d triangles is missing", body->triangle_count );
    }
    for ( int i = 0; i < 3 * body->triangle_count; ++i )
    {
        if ( body->triangles[i] < 0 || body->triangles[i] >= body->vertex_count )
        {
            return wrong( c, -1, "triangle %d: got vertex %d, expected 0 .. %d", i / 3, body->triangles[i],
                          body->vertex_count - 1 );
        }
    }
    return WISP_OK;
}

wisp_status record_check_mesh( const wisp_record_body* body, const char* name, wisp_error* error )
{
    return check_mesh( &( checked ){ body, name, error } );
}

static wisp_status check_strands( const checked* c )
{
    const wisp_record_body* body = c->body;
    if ( body->strand_count < 1 )
    {
        return wrong( c, -1, "got %d strands, expected at least 1", body->strand_count );
    }
    const groom_defect defect = groom_check_offsets( body->offsets, body->strand_count, body->vertex_count );
    return defect.text[0] == '\0' ? WISP_OK : wrong( c, -1, "%s", defect.text );
}

// Names that files use themselves, and USD's rule for names.
static bool is_value_name( const char* text )
{
    static const char* const taken[] = { "Normals", "Points", "RGB", "width", "displayColor" };
    for ( int i = 0; i < WISP_COUNT( taken ); ++i )
    {
        if ( strcmp( text, taken[i] ) == 0 )
        {
            return false;
        }
    }
    return io_is_name( text, WISP_RECORD_MAX_NAME ) && strchr( text, '-' ) == NULL &&
           !( text[0] >= '0' && text[0] <= '9' );
}

static wisp_status check_colour( const checked* c, int vertex, wisp_vec3 rgb )
{
    return rgb.x >= 0.0f && rgb.x <= 1.0f && rgb.y >= 0.0f && rgb.y <= 1.0f && rgb.z >= 0.0f && rgb.z <= 1.0f
               ? WISP_OK
               : wrong( c, vertex, "got a colour of (%g, %g, %g), expected 0 to 1", (double)rgb.x, (double)rgb.y,
                        (double)rgb.z );
}

// Readers have no colours and widths, and a count of vertices that nothing confirms.
static wisp_status check_appearance( const checked* c )
{
    const wisp_record_body* body = c->body;
    wisp_status status = check_colour( c, -1, body->base_colour );
    for ( int v = 0; body->colours != NULL && v < body->vertex_count && status == WISP_OK; ++v )
    {
        status = check_colour( c, v, body->colours[v] );
    }
    for ( int v = 0; body->widths != NULL && v < body->vertex_count && status == WISP_OK; ++v )
    {
        if ( !isfinite( body->widths[v] ) || body->widths[v] < 0.0f )
        {
            status = wrong( c, v, "got a width of %g m, expected at least 0", (double)body->widths[v] );
        }
    }
    return status;
}

static wisp_status check_values( const checked* c )
{
    const wisp_record_value* values = c->body->values;
    for ( int i = 0; i < c->body->value_count; ++i )
    {
        if ( values[i].name == NULL || !is_value_name( values[i].name ) || values[i].numbers == NULL )
        {
            return wrong( c, -1,
                          "value %d has no numbers, or a name that files use or that has other characters than "
                          "A-Z a-z 0-9 _",
                          i );
        }
        for ( int other = 0; other < i; ++other )
        {
            if ( strcmp( values[other].name, values[i].name ) == 0 )
            {
                return wrong( c, -1, "two values are called %s", values[i].name );
            }
        }
    }
    return WISP_OK;
}

static wisp_status check_body( const wisp_record_body* bodies, int b, const char* name, wisp_error* error )
{
    const wisp_record_body* body = &bodies[b];
    const checked c = { body, name, error };
    if ( body->name == NULL || !io_is_name( body->name, WISP_RECORD_MAX_NAME ) )
    {
        return record_wrong( error, name, "body %d: expected a name of 1 to %d of the characters A-Z a-z 0-9 _ -", b,
                             WISP_RECORD_MAX_NAME );
    }
    for ( int other = 0; other < b; ++other )
    {
        if ( strcmp( bodies[other].name, body->name ) == 0 )
        {
            return record_wrong( error, name, "bodies %d and %d are both called %s", other, b, body->name );
        }
    }
    if ( body->vertex_count < 1 )
    {
        return wrong( &c, -1, "got %d vertices, expected at least 1", body->vertex_count );
    }
    wisp_status status = body->offsets != NULL ? check_strands( &c ) : check_mesh( &c );
    status = status == WISP_OK ? check_appearance( &c ) : status;
    return status == WISP_OK ? check_values( &c ) : status;
}

wisp_status record_check_bodies( const wisp_record_body* bodies, int count, const char* name, wisp_error* error )
{
    if ( count < 1 || count > WISP_RECORD_MAX_BODIES )
    {
        return record_wrong( error, name, "got %d bodies, expected 1 to %d", count, WISP_RECORD_MAX_BODIES );
    }
    int64_t vertices = 0;
    for ( int b = 0; b < count; ++b )
    {
        WISP_TRY( check_body( bodies, b, name, error ) );
        vertices += bodies[b].vertex_count;
    }
    // Formats that number the vertices of all bodies together use an int, and some count from 1.
    return vertices < INT_MAX
               ? WISP_OK
               : record_wrong( error, name, "%lld vertices are more than a recording can hold", (long long)vertices );
}

// ---- copies ----------------------------------------------------------------------------------------------------

wisp_record_body* record_copy_bodies( io_memory* memory, const wisp_record_body* bodies, int count )
{
    wisp_record_body* list = io_copy( memory, bodies, (size_t)count * sizeof *bodies );
    for ( int b = 0; list != NULL && b < count; ++b )
    {
        wisp_record_body* to = &list[b];
        const size_t vertices = (size_t)to->vertex_count;
        to->triangle_count = to->offsets != NULL ? 0 : to->triangle_count;
        to->strand_count = to->offsets != NULL ? to->strand_count : 0;
        to->name = io_copy( memory, to->name, strlen( to->name ) + 1 );
        to->triangles = io_copy( memory, to->triangles, 3 * (size_t)to->triangle_count * sizeof *to->triangles );
        to->offsets = io_copy( memory, to->offsets, ( (size_t)to->strand_count + 1 ) * sizeof *to->offsets );
        to->widths = io_copy( memory, to->widths, vertices * sizeof *to->widths );
        to->colours = io_copy( memory, to->colours, vertices * sizeof *to->colours );
        wisp_record_value* values = io_copy( memory, to->values, (size_t)to->value_count * sizeof *values );
        for ( int i = 0; values != NULL && i < to->value_count; ++i )
        {
            values[i].name = io_copy( memory, values[i].name, strlen( values[i].name ) + 1 );
        }
        to->values = values;
    }
    return memory->is_short ? NULL : list;
}

uint64_t record_triangle_bytes( const wisp_record_body* body )
{
    return body->triangles_change ? 3 * sizeof( int32_t ) * (uint64_t)body->triangle_count : 0;
}

void record_set_triangles( const wisp_record_body* body, const int32_t* triangles )
{
    if ( record_triangle_bytes( body ) > 0 )
    {
        memcpy( (void*)(uintptr_t)body->triangles, triangles, (size_t)record_triangle_bytes( body ) );
    }
}

void record_keep_triangles( const wisp_record_body* body, int32_t* out )
{
    if ( record_triangle_bytes( body ) > 0 )
    {
        memcpy( out, body->triangles, (size_t)record_triangle_bytes( body ) );
    }
}

// ---- points ----------------------------------------------------------------------------------------------------

int64_t record_find_not_finite( const float* numbers, size_t count )
{
    for ( size_t i = 0; i < count; ++i )
    {
        if ( !isfinite( numbers[i] ) )
        {
            return (int64_t)i;
        }
    }
    return -1;
}

// In double: the edges of small triangles far from the origin are exact, and their products do not overflow.
static void add_triangle( double* sums, const wisp_vec3* points, const int32_t* corner )
{
    const wisp_vec3 a = points[corner[0]], b = points[corner[1]], c = points[corner[2]];
    const double p[3] = { (double)b.x - (double)a.x, (double)b.y - (double)a.y, (double)b.z - (double)a.z };
    const double q[3] = { (double)c.x - (double)a.x, (double)c.y - (double)a.y, (double)c.z - (double)a.z };
    for ( int k = 0; k < 3; ++k )
    {
        const int i = ( k + 1 ) % 3, j = ( k + 2 ) % 3;
        const double n = p[i] * q[j] - p[j] * q[i];
        sums[3 * (size_t)corner[0] + (size_t)k] += n;
        sums[3 * (size_t)corner[1] + (size_t)k] += n;
        sums[3 * (size_t)corner[2] + (size_t)k] += n;
    }
}

const wisp_vec3* record_normals( const wisp_recorder* recorder, int b, const wisp_vec3* points )
{
    const wisp_record_body* body = &recorder->bodies[b];
    double* sums = recorder->normal_sums;
    memset( sums, 0, 3 * (size_t)body->vertex_count * sizeof *sums );
    for ( int t = 0; t < body->triangle_count; ++t )
    {
        add_triangle( sums, points, body->triangles + 3 * (size_t)t );
    }
    for ( int v = 0; v < body->vertex_count; ++v )
    {
        const double* n = sums + 3 * (size_t)v;
        const double length = sqrt( n[0] * n[0] + n[1] * n[1] + n[2] * n[2] );
        recorder->normals[v] = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
        if ( length > 0.0 )
        {
            recorder->normals[v] =
                ( wisp_vec3 ){ (float)( n[0] / length ), (float)( n[1] / length ), (float)( n[2] / length ) };
        }
    }
    return recorder->normals;
}

void record_carry_corners( const wisp_record_body* body, const int32_t* now, const int32_t* later,
                           wisp_vec3* vectors )
{
    for ( size_t i = 0; i < 3 * (size_t)body->triangle_count; ++i )
    {
        vectors[later[i]] = vectors[now[i]];
    }
}

wisp_vec3 record_base_colour( const wisp_record_body* body )
{
    const wisp_vec3 c = body->base_colour;
    return c.x > 0.0f || c.y > 0.0f || c.z > 0.0f ? c : ( wisp_vec3 ){ 0.6f, 0.6f, 0.6f };
}

// ---- files ----

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
    int32_t* vertices = strands ? io_get( &recorder->memory, (size_t)body->vertex_count * sizeof *vertices ) : NULL;
    cells->ends = io_get( &recorder->memory, (size_t)most * sizeof *cells->ends );
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
    vtk_cells* cells = io_get( &recorder->memory, (size_t)recorder->body_count * sizeof *cells );
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
