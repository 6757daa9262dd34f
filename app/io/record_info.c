// Output of `wisp info` for recordings and point caches: their statistics, then their defects, by frame.
#include "record_internal.h"

#include <math.h>
#include <stdlib.h>

enum
{
    LISTED = 10, // limit of listed damaged frames; the others are counted
};

void record_extend_bounds( record_bounds* bounds, const wisp_vec3* points, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        wisp_vec3 p = points[v];
        wisp_vec3 a = bounds->filled ? bounds->least : p;
        wisp_vec3 b = bounds->filled ? bounds->most : p;
        bounds->least = ( wisp_vec3 ){ fminf( a.x, p.x ), fminf( a.y, p.y ), fminf( a.z, p.z ) };
        bounds->most = ( wisp_vec3 ){ fmaxf( b.x, p.x ), fmaxf( b.y, p.y ), fmaxf( b.z, p.z ) };
        bounds->filled = true;
    }
}

static void print_bounds( FILE* out, const record_bounds* bounds )
{
    if ( bounds->filled )
    {
        fprintf( out, ", x %.6g .. %.6g, y %.6g .. %.6g, z %.6g .. %.6g m", (double)bounds->least.x,
                 (double)bounds->most.x, (double)bounds->least.y, (double)bounds->most.y, (double)bounds->least.z,
                 (double)bounds->most.z );
    }
    fputs( "\n", out );
}

// ---- damage ----------------------------------------------------------------------------------------------------

typedef struct findings
{
    wisp_error first[LISTED];
    int count;
} findings;

static void note( findings* f, const wisp_error* error )
{
    if ( f->count < LISTED )
    {
        f->first[f->count] = *error;
    }
    ++f->count;
}

static wisp_status print_findings( FILE* out, const findings* f, wisp_error* error )
{
    int listed = f->count < LISTED ? f->count : LISTED;
    for ( int i = 0; i < listed; ++i )
    {
        fprintf( out, "  wrong: %s\n", f->first[i].message );
    }
    if ( f->count > LISTED )
    {
        fprintf( out, "  wrong: and %d more frames\n", f->count - LISTED );
    }
    return f->count == 0 ? WISP_OK : wisp_fail( error, f->first[0].status, "%s", f->first[0].message );
}

// ---- recordings ------------------------------------------------------------------------------------------------

// Results of reading every frame.
typedef struct survey
{
    wisp_vec3** points;    // [body_count], null without a frame
    record_bounds* bounds; // [body_count]
    double first_time, last_time;
    int read_count;   // frames that are not damaged
    int hashed_count; // of them, those with a hash of the world
    findings found;
} survey;

static void release_survey( survey* s, int body_count )
{
    for ( int b = 0; s->points != NULL && b < body_count; ++b )
    {
        free( s->points[b] );
    }
    free( s->points );
    free( s->bounds );
    free( s );
}

// Vertex counts are used only if there is a frame: the file is then long enough to fill the memory.
static bool allocate_points( survey* s, const wisp_recording* recording, const wisp_recording_info* info )
{
    bool enough = true;
    for ( int b = 0; enough && info->frame_count > 0 && b < info->body_count; ++b )
    {
        size_t count = (size_t)wisp_recording_body( recording, b )->vertex_count;
        s->points[b] = malloc( count * sizeof **s->points );
        enough = s->points[b] != NULL;
    }
    return enough;
}

static survey* make_survey( const wisp_recording* recording, const wisp_recording_info* info )
{
    survey* s = calloc( 1, sizeof *s );
    if ( s == NULL )
    {
        return NULL;
    }
    s->points = calloc( (size_t)info->body_count, sizeof *s->points );
    s->bounds = calloc( (size_t)info->body_count, sizeof *s->bounds );
    if ( s->points == NULL || s->bounds == NULL || !allocate_points( s, recording, info ) )
    {
        release_survey( s, info->body_count );
        return NULL;
    }
    return s;
}

static void add_frame( survey* s, const wisp_recording* recording, int body_count, double time, uint64_t hash )
{
    s->first_time = s->read_count == 0 ? time : s->first_time;
    s->last_time = time;
    ++s->read_count;
    s->hashed_count += hash != 0;
    for ( int b = 0; b < body_count; ++b )
    {
        int count = wisp_recording_body( recording, b )->vertex_count;
        record_extend_bounds( &s->bounds[b], s->points[b], count );
    }
}

// Damage of one frame is noted and the next one read; an error of the operating system ends it.
static wisp_status read_frames( survey* s, wisp_recording* recording, const wisp_recording_info* info,
                                const char* name, wisp_error* error )
{
    for ( int f = 0; f < info->frame_count; ++f )
    {
        wisp_error cause = { .status = WISP_OK };
        double time = 0.0;
        uint64_t hash = 0;
        wisp_status status = wisp_recording_frame( recording, f, s->points, &time, &hash, &cause );
        if ( status == WISP_OK && s->read_count > 0 && time <= s->last_time )
        {
            wisp_fail( &cause, WISP_BAD_INPUT,
                       "%s: frame %d: got time %.9g s, expected more than %.9g s, that of the frame before",
                       io_short_name( name ), f, time, s->last_time );
            note( &s->found, &cause );
        }
        if ( status == WISP_BAD_INPUT )
        {
            note( &s->found, &cause );
        }
        else if ( status != WISP_OK )
        {
            return wisp_fail( error, status, "%s", cause.message );
        }
        else
        {
            add_frame( s, recording, info->body_count, time, hash );
        }
    }
    return WISP_OK;
}

static void print_stats( FILE* out, const survey* s, const wisp_recording* recording, const wisp_recording_info* info,
                         const char* name )
{
    fprintf( out, "%s: recording of %d frames\n", name, info->frame_count );
    fprintf( out, "  %-20s %.6g s\n", "step", info->dt );
    if ( s->read_count > 0 )
    {
        fprintf( out, "  %-20s %.6g .. %.6g s\n", "time", s->first_time, s->last_time );
    }
    fprintf( out, "  %-20s %llu bytes\n", "frame", (unsigned long long)info->frame_bytes );
    fprintf( out, "  %-20s of %d frames\n", "hash of the world", s->hashed_count );
    fprintf( out, "  %-20s %d\n", "bodies", info->body_count );
    for ( int b = 0; b < info->body_count; ++b )
    {
        const wisp_record_body* body = wisp_recording_body( recording, b );
        bool strands = body->offsets != NULL;
        fprintf( out, "    %-18s %d %s, %d vertices", body->name, strands ? body->strand_count : body->triangle_count,
                 strands                  ? "strands"
                 : body->triangles_change ? "triangles that change"
                                          : "triangles",
                 body->vertex_count );
        print_bounds( out, &s->bounds[b] );
    }
}

// A recording that was not closed is valid up to its end, and the reader must know that end.
static void print_end( FILE* out, const wisp_recording_info* info )
{
    uint64_t end = info->first_byte + (uint64_t)info->frame_count * info->frame_bytes;
    if ( info->tail_bytes > 0 )
    {
        fprintf( out, "  wrong: the recording was cut: %llu bytes from byte %llu on are not a whole frame\n",
                 (unsigned long long)info->tail_bytes, (unsigned long long)end );
    }
    else if ( !info->complete )
    {
        fprintf( out, "  wrong: the recording was not finished: the mark of the end is missing at byte %llu\n",
                 (unsigned long long)end );
    }
}

static wisp_status print_recording( FILE* out, wisp_recording* recording, survey* s, const char* name,
                                    wisp_error* error )
{
    wisp_recording_info info = wisp_recording_describe( recording );
    wisp_status status = read_frames( s, recording, &info, name, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    print_stats( out, s, recording, &info, name );
    print_end( out, &info );
    if ( s->found.count == 0 && info.complete )
    {
        fputs( "  no defects\n", out );
    }
    return print_findings( out, &s->found, error );
}

wisp_status wisp_recording_print( FILE* out, wisp_recording* recording, const char* name, wisp_error* error )
{
    wisp_recording_info info = wisp_recording_describe( recording );
    survey* s = make_survey( recording, &info );
    if ( s == NULL )
    {
        return record_no_memory( name, error );
    }
    io_numbers numbers;
    wisp_status status = io_numbers_begin( &numbers, error );
    if ( status == WISP_OK )
    {
        status = print_recording( out, recording, s, name, error );
        io_numbers_end( &numbers );
    }
    release_survey( s, info.body_count );
    return status;
}

// ---- point caches ----------------------------------------------------------------------------------------------

static wisp_status read_samples( wisp_pc2* cache, wisp_vec3* points, record_bounds* bounds, findings* found,
                                 wisp_error* error )
{
    wisp_pc2_info info = wisp_pc2_describe( cache );
    for ( int f = 0; f < info.frame_count; ++f )
    {
        wisp_error cause = { .status = WISP_OK };
        wisp_status status = wisp_pc2_frame( cache, f, points, &cause );
        if ( status == WISP_OK )
        {
            record_extend_bounds( bounds, points, info.point_count );
        }
        else if ( status == WISP_BAD_INPUT )
        {
            note( found, &cause );
        }
        else
        {
            return wisp_fail( error, status, "%s", cause.message );
        }
    }
    return WISP_OK;
}

static wisp_status print_cache( FILE* out, wisp_pc2* cache, wisp_vec3* points, findings* found, const char* name,
                                wisp_error* error )
{
    wisp_pc2_info info = wisp_pc2_describe( cache );
    record_bounds bounds = { .filled = false };
    wisp_status status = read_samples( cache, points, &bounds, found, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    fprintf( out, "%s: point cache of %d frames\n", name, info.frame_count );
    fprintf( out, "  %-20s from %.6g, every %.6g\n", "frames", (double)info.start_frame, (double)info.sample_rate );
    fprintf( out, "  %-20s %d", "points", info.point_count );
    print_bounds( out, &bounds );
    if ( found->count == 0 )
    {
        fputs( "  no defects\n", out );
    }
    return print_findings( out, found, error );
}

wisp_status wisp_pc2_print( FILE* out, wisp_pc2* cache, const char* name, wisp_error* error )
{
    wisp_pc2_info info = wisp_pc2_describe( cache );
    // As above: without a frame nothing proves the number of points.
    size_t count = info.frame_count > 0 ? (size_t)info.point_count : 1;
    wisp_vec3* points = malloc( count * sizeof *points );
    findings* found = calloc( 1, sizeof *found );
    io_numbers numbers;
    wisp_status status =
        points != NULL && found != NULL ? io_numbers_begin( &numbers, error ) : record_no_memory( name, error );
    if ( status == WISP_OK )
    {
        status = print_cache( out, cache, points, found, name, error );
        io_numbers_end( &numbers );
    }
    free( points );
    free( found );
    return status;
}
