// USD text: a mesh or linear curves per body, points as time samples. All samples of a body are together in the file,
// while frames arrive with all bodies together: they are kept in a file without a name and written at the end.
#define _XOPEN_SOURCE 700

#include "record_internal.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <unistd.h>

// m. Curves without widths are drawn a metre thick; this is a hair.
static const float drawn_width = 1e-4f;

typedef struct usda_file
{
    io_output output;
    FILE* waiting;   // the points of all bodies, frame after frame, as they are in memory
    double* codes;   // [frame_count] times in steps
    int capacity;    // of codes
    wisp_vec3* body; // [largest vertex_count]
} usda_file;

// ---- opening ---------------------------------------------------------------------------------------------------

// USD's names allow neither a dash nor a leading digit.
static void make_name( const char* name, char* out )
{
    size_t at = 0;
    if ( name[0] >= '0' && name[0] <= '9' )
    {
        out[at++] = '_';
    }
    for ( ; *name != 0; ++name )
    {
        out[at++] = *name == '-' ? '_' : *name;
    }
    out[at] = 0;
}

static wisp_status check_names( const wisp_recorder* recorder, wisp_error* error )
{
    const wisp_record_body* list = recorder->bodies.list;
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        char name[WISP_RECORD_MAX_NAME + 2];
        make_name( list[b].name, name );
        for ( int other = 0; other < b; ++other )
        {
            char taken[WISP_RECORD_MAX_NAME + 2];
            make_name( list[other].name, taken );
            if ( strcmp( name, taken ) == 0 )
            {
                return wisp_fail( error, WISP_BAD_INPUT, "%s: bodies %s and %s would both be called %s in USD",
                                  io_short_name( recorder->path ), list[other].name, list[b].name, name );
            }
        }
    }
    return WISP_OK;
}

// A linear curve of one vertex has no segment: USD calls it invalid, so it is rejected here rather than dropped.
static wisp_status check_strands( const wisp_recorder* recorder, wisp_error* error )
{
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies.list[b];
        for ( int s = 0; s < body->strand_count; ++s )
        {
            int count = body->offsets[s + 1] - body->offsets[s];
            if ( count < 2 )
            {
                return wisp_fail( error, WISP_BAD_INPUT,
                                  "%s: body %s: strand %d has %d vertices; a curve in a .usda file needs at least 2",
                                  io_short_name( recorder->path ), body->name, s, count );
            }
        }
    }
    return WISP_OK;
}

// Next to the recording, where there is space for it; without a name, so that a crash leaves nothing behind.
static wisp_status open_waiting( const char* path, FILE** waiting, wisp_error* error )
{
    static const char hidden[] = ".wisp-XXXXXX";
    const char* slash = strrchr( path, '/' );
    size_t folder = slash == NULL ? 0 : (size_t)( slash - path ) + 1;
    char* name = malloc( folder + sizeof hidden );
    if ( name == NULL )
    {
        return record_no_memory( path, error );
    }
    memcpy( name, path, folder );
    memcpy( name + folder, hidden, sizeof hidden );
    int descriptor = mkstemp( name );
    if ( descriptor >= 0 )
    {
        unlink( name );
        *waiting = fdopen( descriptor, "w+b" );
    }
    wisp_status status =
        *waiting != NULL ? WISP_OK : record_refused( path, "create a file for frames beside it", error );
    if ( *waiting == NULL && descriptor >= 0 )
    {
        close( descriptor );
    }
    free( name );
    return status;
}

static void release_file( usda_file* file )
{
    if ( file->output.stream != NULL )
    {
        io_output_discard( &file->output );
    }
    if ( file->waiting != NULL )
    {
        fclose( file->waiting );
    }
    free( file->codes );
    free( file->body );
    free( file );
}

static wisp_status usda_start( const wisp_recorder* recorder, usda_file* file, wisp_error* error )
{
    int largest = 0;
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        int count = recorder->bodies.list[b].vertex_count;
        largest = count > largest ? count : largest;
    }
    file->body = malloc( (size_t)largest * sizeof *file->body );
    if ( file->body == NULL )
    {
        return record_no_memory( recorder->path, error );
    }
    wisp_status status = open_waiting( recorder->path, &file->waiting, error );
    return status == WISP_OK ? io_output_open( recorder->path, &file->output, error ) : status;
}

static wisp_status usda_open( wisp_recorder* recorder, wisp_error* error )
{
    wisp_status status = check_names( recorder, error );
    if ( status == WISP_OK )
    {
        status = check_strands( recorder, error );
    }
    if ( status != WISP_OK )
    {
        return status;
    }
    usda_file* file = calloc( 1, sizeof *file );
    if ( file == NULL )
    {
        return record_no_memory( recorder->path, error );
    }
    status = usda_start( recorder, file, error );
    if ( status != WISP_OK )
    {
        release_file( file );
        return status;
    }
    recorder->file = file;
    return WISP_OK;
}

// ---- frames ----------------------------------------------------------------------------------------------------

// A whole number if the time is one up to rounding: programs show samples at whole frames.
static double to_code( double time, double dt )
{
    double code = time / dt;
    double whole = round( code );
    return fabs( code - whole ) <= 1e-9 * fmax( 1.0, fabs( whole ) ) ? whole : code;
}

static wisp_status add_code( usda_file* file, const wisp_recorder* recorder, double code, wisp_error* error )
{
    int count = recorder->frame_count;
    if ( !isfinite( code ) || ( count > 0 && code <= file->codes[count - 1] ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: frame %d: no time code of its own, %.9g is not after the frame before",
                          io_short_name( recorder->path ), count, code );
    }
    if ( count == file->capacity )
    {
        size_t capacity = file->capacity > 0 ? 2 * (size_t)file->capacity : 256;
        double* larger = realloc( file->codes, capacity * sizeof *larger );
        if ( larger == NULL || capacity > INT32_MAX )
        {
            file->codes = larger != NULL ? larger : file->codes;
            return record_no_memory( recorder->path, error );
        }
        file->codes = larger;
        file->capacity = (int)capacity;
    }
    file->codes[count] = code;
    return WISP_OK;
}

static wisp_status usda_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    usda_file* file = recorder->file;
    wisp_status status = add_code( file, recorder, to_code( frame->time, recorder->dt ), error );
    for ( int b = 0; status == WISP_OK && b < recorder->bodies.count; ++b )
    {
        size_t count = (size_t)recorder->bodies.list[b].vertex_count;
        if ( fwrite( frame->points[b], sizeof( wisp_vec3 ), count, file->waiting ) != count )
        {
            status = record_refused( recorder->path, "write", error );
            recorder->lost = true;
        }
    }
    return status;
}

// ---- text ------------------------------------------------------------------------------------------------------

static void write_vector( FILE* out, wisp_vec3 v )
{
    // Nine digits restore every float bit for bit.
    fprintf( out, "(%.9g, %.9g, %.9g)", (double)v.x, (double)v.y, (double)v.z );
}

// The box of a body as drawn: half a width around the points of curves.
static void write_extent( FILE* out, const wisp_record_body* body, const wisp_vec3* points )
{
    record_bounds bounds = { .filled = false };
    record_extend_bounds( &bounds, points, body->vertex_count );
    float half = body->offsets != NULL ? 0.5f * drawn_width : 0.0f;
    wisp_vec3 least = bounds.least, most = bounds.most;
    write_vector( out, ( wisp_vec3 ){ least.x - half, least.y - half, least.z - half } );
    fputs( ", ", out );
    write_vector( out, ( wisp_vec3 ){ most.x + half, most.y + half, most.z + half } );
}

static void write_points( FILE* out, const wisp_record_body* body, const wisp_vec3* points )
{
    for ( int v = 0; v < body->vertex_count; ++v )
    {
        fputs( v > 0 ? ", " : "", out );
        write_vector( out, points[v] );
    }
}

typedef void sample_writer( FILE* out, const wisp_record_body* body, const wisp_vec3* points );

// Read the stored frames for one body and one attribute.
static wisp_status write_samples( const wisp_recorder* recorder, int b, const char* type_and_name,
                                  sample_writer* write, wisp_error* error )
{
    const usda_file* file = recorder->file;
    const wisp_record_body* body = &recorder->bodies.list[b];
    FILE* out = file->output.stream;
    const record_bodies before = { recorder->bodies.list, b };
    uint64_t frame_bytes = record_point_bytes( &recorder->bodies );
    size_t count = (size_t)body->vertex_count;
    fprintf( out, "        %s.timeSamples = {\n", type_and_name );
    for ( int f = 0; f < recorder->frame_count; ++f )
    {
        uint64_t at = (uint64_t)f * frame_bytes + record_point_bytes( &before );
        if ( fseeko( file->waiting, (off_t)at, SEEK_SET ) != 0 ||
             fread( file->body, sizeof *file->body, count, file->waiting ) != count )
        {
            return record_refused( recorder->path, "read the frames that waited beside it", error );
        }
        fprintf( out, "            %.17g: [", file->codes[f] );
        write( out, body, file->body );
        fputs( "],\n", out );
    }
    fputs( "        }\n", out );
    return WISP_OK;
}

static void write_numbers( FILE* out, const int32_t* numbers, size_t count )
{
    for ( size_t i = 0; i < count; ++i )
    {
        fprintf( out, "%s%d", i > 0 ? ", " : "", numbers[i] );
    }
    fputs( "]\n", out );
}

static void write_mesh( FILE* out, const wisp_record_body* body )
{
    fputs( "        int[] faceVertexCounts = [", out );
    for ( int t = 0; t < body->triangle_count; ++t )
    {
        fputs( t > 0 ? ", 3" : "3", out );
    }
    fputs( "]\n        int[] faceVertexIndices = [", out );
    write_numbers( out, body->triangles, 3 * (size_t)body->triangle_count );
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
    fprintf( out,
             "]\n"
             "        uniform token type = \"linear\"\n"
             "        uniform token wrap = \"nonperiodic\"\n"
             "        float[] widths = [%.9g] (\n"
             "            interpolation = \"constant\"\n"
             "        )\n",
             (double)drawn_width );
}

static wisp_status write_body( const wisp_recorder* recorder, int b, wisp_error* error )
{
    const usda_file* file = recorder->file;
    const wisp_record_body* body = &recorder->bodies.list[b];
    FILE* out = file->output.stream;
    char name[WISP_RECORD_MAX_NAME + 2];
    make_name( body->name, name );
    fprintf( out, "\n    def %s \"%s\"\n    {\n", body->offsets != NULL ? "BasisCurves" : "Mesh", name );
    body->offsets != NULL ? write_curves( out, body ) : write_mesh( out, body );
    wisp_status status = write_samples( recorder, b, "float3[] extent", write_extent, error );
    if ( status == WISP_OK )
    {
        status = write_samples( recorder, b, "point3f[] points", write_points, error );
    }
    fputs( "    }\n", out );
    return status;
}

// 1/60 as a float is not exact; programs expect 60 frames a second.
static double rate_of( double dt )
{
    double rate = 1.0 / dt;
    double whole = round( rate );
    return whole >= 1.0 && fabs( rate - whole ) <= 1e-6 * whole ? whole : rate;
}

static wisp_status write_stage( const wisp_recorder* recorder, wisp_error* error )
{
    const usda_file* file = recorder->file;
    FILE* out = file->output.stream;
    double rate = rate_of( recorder->dt );
    int count = recorder->frame_count;
    fprintf( out,
             "#usda 1.0\n(\n"
             "    defaultPrim = \"Recording\"\n"
             "    doc = \"Wisp " WISP_VERSION_STRING "\"\n"
             "    endTimeCode = %.17g\n"
             "    framesPerSecond = %.17g\n"
             "    metersPerUnit = 1\n"
             "    startTimeCode = %.17g\n"
             "    timeCodesPerSecond = %.17g\n"
             "    upAxis = \"Y\"\n"
             ")\n\ndef Xform \"Recording\"\n{",
             count > 0 ? file->codes[count - 1] : 0.0, rate, count > 0 ? file->codes[0] : 0.0, rate );
    wisp_status status = WISP_OK;
    for ( int b = 0; status == WISP_OK && b < recorder->bodies.count; ++b )
    {
        status = write_body( recorder, b, error );
    }
    fputs( "}\n", out );
    return status;
}

static wisp_status usda_finish( const wisp_recorder* recorder, wisp_error* error )
{
    usda_file* file = recorder->file;
    if ( fflush( file->waiting ) != 0 )
    {
        return record_refused( recorder->path, "write", error );
    }
    io_numbers numbers;
    wisp_status status = io_numbers_begin( &numbers, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = write_stage( recorder, error );
    io_numbers_end( &numbers );
    // Committing ends the output, with success or without.
    return status == WISP_OK ? io_output_commit( &file->output, error ) : status;
}

static wisp_status usda_close( wisp_recorder* recorder, wisp_error* error )
{
    wisp_status status = recorder->lost ? WISP_OK : usda_finish( recorder, error );
    release_file( recorder->file );
    return status;
}

const record_format record_format_usda = { ".usda", usda_open, usda_frame, usda_close };
