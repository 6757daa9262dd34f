// USD text: a mesh or linear curves per body, points as time samples. All samples of an attribute are together in the
// file, while frames arrive with all bodies together: they wait until the recorder is closed.
#include "record_usda.h"

#include <math.h>
#include <stdlib.h>

// ---- opening ---------------------------------------------------------------------------------------------------

void usda_name( const char* name, char* out )
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
        usda_name( list[b].name, name );
        for ( int other = 0; other < b; ++other )
        {
            char taken[WISP_RECORD_MAX_NAME + 2];
            usda_name( list[other].name, taken );
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

static void release_file( usda_file* file )
{
    if ( file->output.stream != NULL )
    {
        io_output_discard( &file->output );
    }
    record_waiting_close( file->waiting );
    free( file->points[0] );
    free( file->points[1] );
    free( file->numbers );
    free( file->triangles );
    free( file );
}

static wisp_status usda_start( const wisp_recorder* recorder, usda_file* file, wisp_error* error )
{
    size_t largest = 0, triangles = 0;
    for ( int b = 0; b < recorder->bodies.count; ++b )
    {
        const size_t count = (size_t)recorder->bodies.list[b].vertex_count;
        const size_t bytes = (size_t)record_triangle_bytes( &recorder->bodies.list[b] );
        largest = count > largest ? count : largest;
        triangles = bytes > triangles ? bytes : triangles;
    }
    file->points[0] = malloc( largest * sizeof( wisp_vec3 ) );
    file->points[1] = malloc( largest * sizeof( wisp_vec3 ) );
    file->numbers = malloc( largest * sizeof( float ) );
    file->triangles = malloc( triangles + 1 );
    if ( !file->points[0] || !file->points[1] || !file->numbers || !file->triangles )
    {
        return record_no_memory( recorder->path, error );
    }
    wisp_status status = record_waiting_open( recorder, &file->waiting, error );
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

double usda_code( const wisp_recorder* recorder, int frame )
{
    const usda_file* file = recorder->file;
    return to_code( record_waiting_time( file->waiting, frame ), recorder->dt );
}

static wisp_status usda_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    const usda_file* file = recorder->file;
    const double code = to_code( frame->time, recorder->dt );
    const int count = recorder->frame_count;
    if ( !isfinite( code ) || ( count > 0 && code <= usda_code( recorder, count - 1 ) ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: frame %d: no time code of its own, %.9g is not after the frame before",
                          io_short_name( recorder->path ), count, code );
    }
    return record_waiting_add( recorder, file->waiting, frame, error );
}

// ---- whole file ------------------------------------------------------------------------------------------------

// 1/60 as a float, or as 0.0166667 in a scene, is not exact; programs expect 60 frames a second.
static double rate_of( double dt )
{
    double rate = 1.0 / dt;
    double whole = round( rate );
    return whole >= 1.0 && fabs( rate - whole ) <= 1e-5 * whole ? whole : rate;
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
             count > 0 ? usda_code( recorder, count - 1 ) : 0.0, rate, count > 0 ? usda_code( recorder, 0 ) : 0.0,
             rate );
    wisp_status status = WISP_OK;
    for ( int b = 0; status == WISP_OK && b < recorder->bodies.count; ++b )
    {
        status = usda_write_body( recorder, b, error );
    }
    fputs( "}\n", out );
    return status;
}

static wisp_status usda_finish( const wisp_recorder* recorder, wisp_error* error )
{
    usda_file* file = recorder->file;
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

const record_format record_format_usda = { ".usda", true, true, usda_open, usda_frame, usda_close };
