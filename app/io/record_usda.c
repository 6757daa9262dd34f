// USD text: a mesh or linear curves per body, points as time samples. All samples of an attribute are together in the
// file, while frames arrive with all bodies together: they wait until the recorder is closed.
#include "record_internal.h"

#include "wisp/module/definition.h"

#include <math.h>

enum
{
    NAME_ROOM = WISP_RECORD_MAX_NAME + 2,
};

// m. Curves without widths are drawn a metre thick; this is a hair.
static const float drawn_width = 1e-4f;

// A body as a prim that is being written.
typedef struct usda_prim
{
    wisp_recorder* recorder;
    const wisp_record_body* body;
    int number; // of the body
    int value;  // of the body, for write_numbers()
    FILE* out;
} usda_prim;

// ---- opening ---------------------------------------------------------------------------------------------------

// The name of a prim: USD allows neither a dash nor a leading digit.
static void name_prim( const char* name, char out[NAME_ROOM] )
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

static wisp_status check_name( const wisp_recorder* recorder, int b, wisp_error* error )
{
    char name[NAME_ROOM], taken[NAME_ROOM];
    name_prim( recorder->bodies[b].name, name );
    for ( int other = 0; other < b; ++other )
    {
        name_prim( recorder->bodies[other].name, taken );
        if ( strcmp( name, taken ) == 0 )
        {
            return record_wrong( error, recorder->path, "bodies %s and %s would both be called %s in USD",
                                 recorder->bodies[other].name, recorder->bodies[b].name, name );
        }
    }
    return WISP_OK;
}

// A linear curve of one vertex has no segment: USD calls it invalid, so it is rejected here rather than dropped.
static wisp_status check_strands( const wisp_recorder* recorder, const wisp_record_body* body, wisp_error* error )
{
    for ( int s = 0; s < body->strand_count; ++s )
    {
        const int count = body->offsets[s + 1] - body->offsets[s];
        if ( count < 2 )
        {
            return record_wrong( error, recorder->path,
                                 "body %s: strand %d has %d vertices; a curve in a .usda file needs at least 2",
                                 body->name, s, count );
        }
    }
    return WISP_OK;
}

static wisp_status usda_begin( wisp_recorder* recorder, wisp_error* error )
{
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        WISP_TRY( check_name( recorder, b, error ) );
        WISP_TRY( check_strands( recorder, &recorder->bodies[b], error ) );
    }
    return record_wait_open( recorder, error );
}

// ---- frames ----------------------------------------------------------------------------------------------------

// A whole number if the time is one up to rounding: programs show samples at whole frames.
static double to_code( double time, double dt )
{
    const double code = time / dt, whole = round( code );
    return fabs( code - whole ) <= 1e-9 * fmax( 1.0, fabs( whole ) ) ? whole : code;
}

// Time code of a frame that waits.
static double code_of( const wisp_recorder* recorder, int frame )
{
    return to_code( record_wait_time( recorder, frame ), recorder->dt );
}

static wisp_status usda_frame( wisp_recorder* recorder, const record_frame* frame, wisp_error* error )
{
    const double code = to_code( frame->time, recorder->dt );
    const int count = recorder->frame_count;
    return isfinite( code ) && ( count == 0 || code > code_of( recorder, count - 1 ) )
               ? record_wait_add( recorder, frame, error )
               : record_wrong( error, recorder->path,
                               "frame %d: no time code of its own, %.9g is not after the frame before", count, code );
}

// ---- one sample ------------------------------------------------------------------------------------------------

// Writes the sample of a frame, without brackets.
typedef void sample_writer( const usda_prim* prim, int frame );

static void write_vectors( FILE* out, const wisp_vec3* vectors, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        // Nine digits restore every float bit for bit.
        fprintf( out, "%s(%.9g, %.9g, %.9g)", v > 0 ? ", " : "", (double)vectors[v].x, (double)vectors[v].y,
                 (double)vectors[v].z );
    }
}

static void write_floats( FILE* out, const float* numbers, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        fprintf( out, "%s%.9g", v > 0 ? ", " : "", (double)numbers[v] );
    }
}

static void write_corners( FILE* out, const wisp_record_body* body )
{
    for ( int i = 0; i < 3 * body->triangle_count; ++i )
    {
        fprintf( out, "%s%d", i > 0 ? ", " : "", body->triangles[i] );
    }
}

static const wisp_vec3* load( const usda_prim* prim, int frame )
{
    return record_wait_load( prim->recorder, frame, prim->number );
}

static void write_points( const usda_prim* prim, int frame )
{
    write_vectors( prim->out, load( prim, frame ), prim->body->vertex_count );
}

static void write_triangles( const usda_prim* prim, int frame )
{
    load( prim, frame );
    write_corners( prim->out, prim->body );
}

static void write_normals( const usda_prim* prim, int frame )
{
    const wisp_vec3* points = load( prim, frame );
    write_vectors( prim->out, record_normals( prim->recorder, prim->number, points ), prim->body->vertex_count );
}

static void write_numbers( const usda_prim* prim, int frame )
{
    load( prim, frame );
    write_floats( prim->out, prim->body->values[prim->value].numbers, prim->body->vertex_count );
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
static void write_extent( const usda_prim* prim, int frame )
{
    io_bounds bounds = { .filled = false };
    io_extend_bounds( &bounds, load( prim, frame ), prim->body->vertex_count );
    const float half = 0.5f * largest_width( prim->body );
    const wisp_vec3 corners[2] = {
        { bounds.least.x - half, bounds.least.y - half, bounds.least.z - half },
        { bounds.most.x + half, bounds.most.y + half, bounds.most.z + half },
    };
    write_vectors( prim->out, corners, 2 );
}

// Central differences of the frames around, one-sided at the ends: what motion blur around a frame needs. Where vertices are
// split between frames, from the frame before: a vertex comes from where its corners were.
static void write_velocities( const usda_prim* prim, int frame )
{
    const wisp_record_body* body = prim->body;
    wisp_vec3* kept = prim->recorder->kept_points;
    int32_t* triangles = prim->recorder->kept_triangles;
    const int before = frame > 0 ? frame - 1 : 0;
    const bool is_last = frame + 1 >= prim->recorder->frame_count || ( body->triangles_change && frame > 0 );
    const int after = is_last ? frame : frame + 1;
    memcpy( kept, load( prim, before ), (size_t)body->vertex_count * sizeof *kept );
    record_keep_triangles( body, triangles );
    const wisp_vec3* points = load( prim, after );
    if ( body->triangles_change )
    {
        record_carry_corners( body, triangles, body->triangles, kept );
    }
    const double time = record_wait_time( prim->recorder, after ) - record_wait_time( prim->recorder, before );
    for ( int v = 0; v < body->vertex_count; ++v )
    {
        const wisp_vec3 a = kept[v], b = points[v];
        kept[v] = ( wisp_vec3 ){ (float)( ( (double)b.x - (double)a.x ) / time ),
                                 (float)( ( (double)b.y - (double)a.y ) / time ),
                                 (float)( ( (double)b.z - (double)a.z ) / time ) };
    }
    write_vectors( prim->out, kept, body->vertex_count );
}

// ---- attributes ------------------------------------------------------------------------------------------------

static void write_interpolation( FILE* out, const char* interpolation )
{
    fprintf( out, " (\n            interpolation = \"%s\"\n        )\n", interpolation );
}

// @param interpolation null: none is written
static void write_samples( const usda_prim* prim, const char* type_and_name, const char* interpolation,
                           sample_writer* write )
{
    FILE* out = prim->out;
    if ( interpolation != NULL )
    {
        // In one line: three.js takes a line with a colon and without an equals sign for a sample.
        fprintf( out, "        %s (interpolation = \"%s\")\n", type_and_name, interpolation );
    }
    fprintf( out, "        %s.timeSamples = {\n", type_and_name );
    for ( int f = 0; f < prim->recorder->frame_count; ++f )
    {
        fprintf( out, "            %.17g: [", code_of( prim->recorder, f ) );
        write( prim, f );
        fputs( "],\n", out );
    }
    fputs( "        }\n", out );
}

// An attribute of points: one default value of a static body, time samples of others.
static void write_attribute( const usda_prim* prim, const char* type_and_name, const char* interpolation,
                             sample_writer* write )
{
    if ( !prim->body->is_static )
    {
        write_samples( prim, type_and_name, interpolation, write );
        return;
    }
    fprintf( prim->out, "        %s = [", type_and_name );
    write( prim, 0 );
    fputs( interpolation != NULL ? "]" : "]\n", prim->out );
    if ( interpolation != NULL )
    {
        write_interpolation( prim->out, interpolation );
    }
}

// Without a frame there are none, because some readers refuse an empty list of samples.
static void write_all_attributes( usda_prim* prim )
{
    const wisp_record_body* body = prim->body;
    if ( prim->recorder->frame_count == 0 )
    {
        return;
    }
    write_attribute( prim, "float3[] extent", NULL, write_extent );
    write_attribute( prim, "point3f[] points", NULL, write_points );
    if ( body->triangles_change )
    {
        write_samples( prim, "int[] faceVertexIndices", NULL, write_triangles );
    }
    if ( body->triangle_count > 0 )
    {
        write_attribute( prim, "normal3f[] normals", "vertex", write_normals );
    }
    if ( !body->is_static && prim->recorder->frame_count > 1 )
    {
        write_samples( prim, "vector3f[] velocities", NULL, write_velocities );
    }
    for ( prim->value = 0; prim->value < body->value_count; ++prim->value )
    {
        char attribute[WISP_RECORD_MAX_NAME + 32];
        snprintf( attribute, sizeof attribute, "float[] primvars:%s", body->values[prim->value].name );
        write_samples( prim, attribute, "vertex", write_numbers );
    }
}

// ---- whole file ------------------------------------------------------------------------------------------------

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
    if ( !body->triangles_change )
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
    write_floats( out, body->widths != NULL ? body->widths : &drawn_width,
                  body->widths != NULL ? body->vertex_count : 1 );
    fputs( "]", out );
    write_interpolation( out, body->widths != NULL ? "vertex" : "constant" );
}

static void write_body( wisp_recorder* recorder, int b )
{
    const wisp_record_body* body = &recorder->bodies[b];
    usda_prim prim = { recorder, body, b, 0, recorder->outputs[0].stream };
    const wisp_vec3 base = record_base_colour( body );
    char name[NAME_ROOM];
    name_prim( body->name, name );
    fprintf( prim.out, "\n    def %s \"%s\"\n    {\n", body->offsets != NULL ? "BasisCurves" : "Mesh", name );
    body->offsets != NULL ? write_curves( prim.out, body ) : write_mesh( prim.out, body );
    fputs( "        color3f[] primvars:displayColor = [", prim.out );
    write_vectors( prim.out, body->colours != NULL ? body->colours : &base,
                   body->colours != NULL ? body->vertex_count : 1 );
    fputs( "]", prim.out );
    write_interpolation( prim.out, body->colours != NULL ? "vertex" : "constant" );
    write_all_attributes( &prim );
    fputs( "    }\n", prim.out );
}

// 1/60 as a float, or as 0.0166667 in a scene, is not exact; programs expect 60 frames a second.
static double rate_of( double dt )
{
    const double rate = 1.0 / dt, whole = round( rate );
    return whole >= 1.0 && fabs( rate - whole ) <= 1e-5 * whole ? whole : rate;
}

static wisp_status usda_end( wisp_recorder* recorder, wisp_error* error )
{
    (void)error;
    FILE* out = recorder->outputs[0].stream;
    const double rate = rate_of( recorder->dt );
    const int count = recorder->frame_count;
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
             count > 0 ? code_of( recorder, count - 1 ) : 0.0, rate, count > 0 ? code_of( recorder, 0 ) : 0.0, rate );
    const double* o = recorder->origin;
    if ( o[0] != 0.0 || o[1] != 0.0 || o[2] != 0.0 )
    {
        fprintf( out,
                 "\n    double3 xformOp:translate = (%.17g, %.17g, %.17g)\n"
                 "    uniform token[] xformOpOrder = [\"xformOp:translate\"]\n",
                 o[0], o[1], o[2] );
    }
    for ( int b = 0; b < recorder->body_count; ++b )
    {
        write_body( recorder, b );
    }
    fputs( "}\n", out );
    return WISP_OK;
}

const record_format record_format_usda = {
    ".usda",
    .has_values = true,
    .has_normals = true,
    .has_origin = true,
    .begin = usda_begin,
    .frame = usda_frame,
    .end = usda_end,
};
