// Output of `wisp info` for recordings and point caches: their statistics, then their defects, by frame.
#include "record_internal.h"

enum
{
    LISTED = 10, // limit of listed damaged frames; the others are counted
};

// Results of reading every frame.
typedef struct survey
{
    wisp_recording* recording;
    wisp_recording_info info;
    wisp_vec3** points;    // [body_count], null without a frame
    record_bounds* bounds; // [body_count]
    double first_time, last_time;
    int read_count;   // frames that are not damaged
    int hashed_count; // of them, those with a hash of the world
    wisp_error damage[LISTED];
    int damage_count;
} survey;

// Damage of one frame is noted and the next one read; an error of the operating system ends it.
static wisp_status read_frames( survey* s, const char* name, wisp_error* error )
{
    for ( int f = 0; f < s->info.frame_count; ++f )
    {
        wisp_error cause = { .status = WISP_OK };
        double time = 0.0;
        uint64_t hash = 0;
        const wisp_status status = wisp_recording_frame( s->recording, f, s->points, &time, &hash, &cause );
        if ( status != WISP_OK && status != WISP_BAD_INPUT )
        {
            return wisp_fail( error, status, "%s", cause.message );
        }
        if ( status == WISP_OK && s->read_count > 0 && time <= s->last_time )
        {
            record_wrong( &cause, name,
                          "frame %d: got time %.9g s, expected more than %.9g s, that of the frame before", f, time,
                          s->last_time );
        }
        if ( cause.status != WISP_OK && s->damage_count++ < LISTED )
        {
            s->damage[s->damage_count - 1] = cause;
        }
        if ( status == WISP_OK )
        {
            s->first_time = s->read_count == 0 ? time : s->first_time;
            s->last_time = time;
            ++s->read_count;
            s->hashed_count += hash != 0;
        }
        for ( int b = 0; b < s->info.body_count && status == WISP_OK; ++b )
        {
            record_extend_bounds( &s->bounds[b], s->points[b], s->recording->bodies[b].vertex_count );
        }
    }
    return WISP_OK;
}

static void print_bounds( FILE* out, const record_bounds* bounds )
{
    const wisp_vec3 a = bounds->least, b = bounds->most;
    if ( bounds->filled )
    {
        fprintf( out, ", x %.6g .. %.6g, y %.6g .. %.6g, z %.6g .. %.6g m", (double)a.x, (double)b.x, (double)a.y,
                 (double)b.y, (double)a.z, (double)b.z );
    }
    fputs( "\n", out );
}

static void print_cache( FILE* out, const survey* s, const char* name )
{
    fprintf( out, "%s: point cache of %d frames\n", name, s->info.frame_count );
    fprintf( out, "  %-20s from %.6g, every %.6g\n", "frames", (double)s->recording->start_frame,
             (double)s->recording->sample_rate );
    fprintf( out, "  %-20s %d", "points", s->recording->bodies[0].vertex_count );
    print_bounds( out, &s->bounds[0] );
}

static void print_own( FILE* out, const survey* s, const char* name )
{
    fprintf( out, "%s: recording of %d frames\n", name, s->info.frame_count );
    fprintf( out, "  %-20s %.6g s\n", "step", s->info.dt );
    const double* o = s->info.origin;
    if ( o[0] != 0.0 || o[1] != 0.0 || o[2] != 0.0 )
    {
        fprintf( out, "  %-20s %.9g, %.9g, %.9g m, which points are relative to\n", "origin", o[0], o[1], o[2] );
    }
    if ( s->read_count > 0 )
    {
        fprintf( out, "  %-20s %.6g .. %.6g s\n", "time", s->first_time, s->last_time );
    }
    fprintf( out, "  %-20s %llu bytes\n", "frame", (unsigned long long)s->info.frame_bytes );
    fprintf( out, "  %-20s of %d frames\n", "hash of the world", s->hashed_count );
    fprintf( out, "  %-20s %d\n", "bodies", s->info.body_count );
    for ( int b = 0; b < s->info.body_count; ++b )
    {
        const wisp_record_body* body = &s->recording->bodies[b];
        const bool strands = body->offsets != NULL;
        fprintf( out, "    %-18s %d %s, %d vertices", body->name, strands ? body->strand_count : body->triangle_count,
                 strands                  ? "strands"
                 : body->triangles_change ? "triangles that change"
                                          : "triangles",
                 body->vertex_count );
        print_bounds( out, &s->bounds[b] );
    }
}

// A recording that was not closed is valid up to its end, and the reader must know that end.
static wisp_status print_defects( FILE* out, const survey* s, wisp_error* error )
{
    const unsigned long long end = record_frame_byte( s->recording, s->info.frame_count );
    if ( s->info.tail_bytes > 0 )
    {
        fprintf( out, "  wrong: the recording was cut: %llu bytes from byte %llu on are not a whole frame\n",
                 (unsigned long long)s->info.tail_bytes, end );
    }
    else if ( !s->info.complete )
    {
        fprintf( out, "  wrong: the recording was not finished: the mark of the end is missing at byte %llu\n", end );
    }
    for ( int i = 0; i < s->damage_count && i < LISTED; ++i )
    {
        fprintf( out, "  wrong: %s\n", s->damage[i].message );
    }
    if ( s->damage_count > LISTED )
    {
        fprintf( out, "  wrong: and %d more frames\n", s->damage_count - LISTED );
    }
    if ( s->damage_count == 0 && s->info.complete )
    {
        fputs( "  no defects\n", out );
    }
    return s->damage_count == 0 ? WISP_OK : wisp_fail( error, s->damage[0].status, "%s", s->damage[0].message );
}

// Vertex counts are used only if there is a frame: the file is then long enough to fill the memory.
static survey* make_survey( record_memory* memory, wisp_recording* recording )
{
    const wisp_recording_info info = wisp_recording_describe( recording );
    survey* s = record_get( memory, sizeof *s );
    wisp_vec3** points = record_get( memory, (size_t)info.body_count * sizeof *points );
    record_bounds* bounds = record_get( memory, (size_t)info.body_count * sizeof *bounds );
    for ( int b = 0; b < info.body_count && info.frame_count > 0 && !memory->is_short; ++b )
    {
        points[b] = record_get( memory, (size_t)recording->bodies[b].vertex_count * sizeof **points );
    }
    if ( memory->is_short )
    {
        return NULL;
    }
    *s = ( survey ){ .recording = recording, .info = info, .points = points, .bounds = bounds };
    return s;
}

wisp_status wisp_recording_print( FILE* out, wisp_recording* recording, const char* name, wisp_error* error )
{
    record_memory memory = { 0 };
    survey* s = make_survey( &memory, recording );
    io_numbers numbers;
    wisp_status status = s != NULL ? io_numbers_begin( &numbers, error ) : record_no_memory( name, error );
    if ( status == WISP_OK )
    {
        status = read_frames( s, name, error );
        if ( status == WISP_OK )
        {
            recording->is_cache ? print_cache( out, s, name ) : print_own( out, s, name );
            status = print_defects( out, s, error );
        }
        io_numbers_end( &numbers );
    }
    record_release( &memory );
    return status;
}
