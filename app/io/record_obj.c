// Wavefront OBJ, one file per frame: for programs without a notion of time. A segment of a strand is an `l` line of
// its own, although the format allows a whole strand in one: Blender reads only the first segment of a longer line.
#include "record_internal.h"

#include "wisp/module/definition.h"

// The vertices of all bodies are numbered together, from 1.
static void write_elements( FILE* out, const wisp_record_body* body, int first )
{
    for ( int t = 0; body->offsets == NULL && t < body->triangle_count; ++t )
    {
        const int32_t* corner = body->triangles + 3 * (size_t)t;
        fprintf( out, "f %d %d %d\n", first + corner[0], first + corner[1], first + corner[2] );
    }
    for ( int s = 0; body->offsets != NULL && s < body->strand_count; ++s )
    {
        for ( int v = body->offsets[s]; v + 1 < body->offsets[s + 1]; ++v )
        {
            fprintf( out, "l %d %d\n", first + v, first + v + 1 );
        }
    }
}

// Every frame is a file that is finished on its own.
static wisp_status obj_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    const int number = recorder->frame_count + 1;
    const char* path = record_path_beside( recorder, "_%04d%s", number, record_extension( recorder ) );
    io_output output;
    WISP_TRY( io_output_open( path, &output, error ) );
    FILE* out = output.stream;
    fprintf( out, "# Wisp %s: frame %d at %.17g s, metres\n", WISP_VERSION_STRING, number, frame->time );
    int first = 1;
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        const wisp_record_body* body = &recorder->bodies[b];
        fprintf( out, "o %s\n", body->name );
        for ( int v = 0; v < body->vertex_count; ++v )
        {
            const wisp_vec3 p = frame->points[b][v];
            // Nine digits restore every float bit for bit.
            fprintf( out, "v %.9g %.9g %.9g\n", (double)p.x, (double)p.y, (double)p.z );
        }
        write_elements( out, body, first );
        first += body->vertex_count;
    }
    return io_output_commit( &output, error );
}

const record_format record_format_obj = { ".obj", .frame = obj_frame };
