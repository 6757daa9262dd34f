// The JSON part of a .glb file: what the binary part means.
#define _XOPEN_SOURCE 700

#include "record_glb.h"

#include <stdlib.h>

enum
{
    FLOAT = 5126,
    UNSIGNED_INT = 5125,
    POINTS = 0,
    LINES = 1,
    TRIANGLES = 4,
};

typedef struct glb_text
{
    FILE* out;
    const wisp_recorder* recorder;
    const glb_layout* layout;
    bool is_first; // the next item of a list has no comma before it
} glb_text;

static void begin_list( glb_text* text, const char* name )
{
    fprintf( text->out, ",\"%s\":[", name );
    text->is_first = true;
}

static void begin_item( glb_text* text )
{
    fputs( text->is_first ? "" : ",", text->out );
    text->is_first = false;
}

static void end_list( const glb_text* text )
{
    fputs( "]", text->out );
}

static const wisp_record_body* body_of( const glb_text* text, int b )
{
    return &text->recorder->bodies.list[b];
}

// ---- scene -----------------------------------------------------------------------------------------------------

static void write_nodes( glb_text* text )
{
    fputs( ",\"scene\":0,\"scenes\":[{\"nodes\":[", text->out );
    text->is_first = true;
    for ( int b = 0; b < text->recorder->bodies.count; ++b )
    {
        begin_item( text );
        fprintf( text->out, "%d", b );
    }
    fputs( "]}]", text->out );
    begin_list( text, "nodes" );
    for ( int b = 0; b < text->recorder->bodies.count; ++b )
    {
        begin_item( text );
        fprintf( text->out, "{\"name\":\"%s\",\"mesh\":%d}", body_of( text, b )->name, b );
    }
    end_list( text );
}

// ---- meshes ----------------------------------------------------------------------------------------------------

static void write_targets( glb_text* text, int b, int accessor )
{
    const glb_body* place = &text->layout->bodies[b];
    begin_list( text, "targets" );
    for ( int t = 0; t < place->target_count; ++t )
    {
        begin_item( text );
        fprintf( text->out, "{\"POSITION\":%d", accessor++ );
        if ( place->has_normals )
        {
            fprintf( text->out, ",\"NORMAL\":%d", accessor++ );
        }
        fputs( "}", text->out );
    }
    end_list( text );
}

// Modelling programs show these names.
static void write_target_names( glb_text* text, int b )
{
    fputs( ",\"extras\":{\"targetNames\":[", text->out );
    text->is_first = true;
    for ( int t = 0; t < text->layout->bodies[b].target_count; ++t )
    {
        begin_item( text );
        fprintf( text->out, "\"frame_%04d\"", t + 2 );
    }
    fputs( "]}", text->out );
}

// @return the accessors that it names
static int write_mesh( glb_text* text, int b, int accessor )
{
    FILE* out = text->out;
    const wisp_record_body* body = body_of( text, b );
    const glb_body* place = &text->layout->bodies[b];
    const int mode = place->index_count == 0 ? POINTS : body->offsets != NULL ? LINES : TRIANGLES;
    int next = accessor;
    fprintf( out, "{\"name\":\"%s\",\"primitives\":[{\"mode\":%d,\"material\":%d", body->name, mode, b );
    if ( place->index_count > 0 )
    {
        fprintf( out, ",\"indices\":%d", next++ );
    }
    fprintf( out, ",\"attributes\":{\"POSITION\":%d", next++ );
    if ( place->has_normals )
    {
        fprintf( out, ",\"NORMAL\":%d", next++ );
    }
    if ( body->colours != NULL )
    {
        fprintf( out, ",\"COLOR_0\":%d", next++ );
    }
    fputs( "}", out );
    if ( place->target_count > 0 )
    {
        write_targets( text, b, next );
    }
    fputs( "}]", out );
    if ( place->target_count > 0 )
    {
        write_target_names( text, b );
    }
    fputs( "}", out );
    return next - accessor + place->target_count * glb_target_blocks( place );
}

static void write_meshes( glb_text* text )
{
    int accessor = 0;
    fputs( ",\"meshes\":[", text->out );
    for ( int b = 0; b < text->recorder->bodies.count; ++b )
    {
        // Lists inside a mesh have begun and ended since the last one.
        fputs( b > 0 ? "," : "", text->out );
        accessor += write_mesh( text, b, accessor );
    }
    end_list( text );
}

// The colours of vertices are multiplied with that of the material, which is then white.
static void write_materials( glb_text* text )
{
    begin_list( text, "materials" );
    for ( int b = 0; b < text->recorder->bodies.count; ++b )
    {
        const wisp_record_body* body = body_of( text, b );
        const wisp_vec3 c = body->colours != NULL ? ( wisp_vec3 ){ 1.0f, 1.0f, 1.0f } : record_base_colour( body );
        begin_item( text );
        fprintf( text->out,
                 "{\"name\":\"%s\",\"doubleSided\":true,\"pbrMetallicRoughness\":{\"baseColorFactor\":"
                 "[%.9g,%.9g,%.9g,1],\"metallicFactor\":0,\"roughnessFactor\":0.8}}",
                 body->name, (double)c.x, (double)c.y, (double)c.z );
    }
    end_list( text );
}

// ---- data ------------------------------------------------------------------------------------------------------

// @param at bytes from the start of the view @param bounds null: none
static void write_accessor( glb_text* text, int view, uint64_t at, int component, uint64_t count, const char* type,
                            const record_bounds* bounds )
{
    begin_item( text );
    fprintf( text->out, "{\"bufferView\":%d,\"byteOffset\":%llu,\"componentType\":%d,\"count\":%llu,\"type\":\"%s\"",
             view, (unsigned long long)at, component, (unsigned long long)count, type );
    if ( bounds != NULL )
    {
        const wisp_vec3 a = bounds->least, b = bounds->most;
        fprintf( text->out, ",\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]", (double)a.x, (double)a.y,
                 (double)a.z, (double)b.x, (double)b.y, (double)b.z );
    }
    fputs( "}", text->out );
}

// @return the views that they are in
static int write_body_accessors( glb_text* text, int b, int view )
{
    const wisp_record_body* body = body_of( text, b );
    const glb_body* place = &text->layout->bodies[b];
    const uint64_t vertices = (uint64_t)body->vertex_count, block = glb_block_bytes( body );
    const int base = glb_base_blocks( body, place ), per_target = glb_target_blocks( place );
    const int points = view + ( place->index_count > 0 );
    if ( place->index_count > 0 )
    {
        write_accessor( text, view, 0, UNSIGNED_INT, (uint64_t)place->index_count, "SCALAR", NULL );
    }
    for ( int i = 0; i < base; ++i )
    {
        write_accessor( text, points, (uint64_t)i * block, FLOAT, vertices, "VEC3", i == 0 ? place->bounds : NULL );
    }
    for ( int i = 0; i < place->target_count * per_target; ++i )
    {
        const bool is_position = i % per_target == 0;
        write_accessor( text, points, (uint64_t)( base + i ) * block, FLOAT, vertices, "VEC3",
                        is_position ? &place->bounds[1 + i / per_target] : NULL );
    }
    return points + 1 - view;
}

// The times and weights of the animation are the last two accessors, in the last view.
static void write_accessors( glb_text* text )
{
    const glb_layout* layout = text->layout;
    int view = 0;
    begin_list( text, "accessors" );
    for ( int b = 0; b < text->recorder->bodies.count; ++b )
    {
        view += write_body_accessors( text, b, view );
    }
    if ( layout->is_animated )
    {
        const uint64_t count = (uint64_t)layout->frame_count;
        begin_item( text );
        fprintf( text->out,
                 "{\"bufferView\":%d,\"componentType\":%d,\"count\":%llu,\"type\":\"SCALAR\",\"min\":[%.9g],"
                 "\"max\":[%.9g]}",
                 view, FLOAT, (unsigned long long)count, (double)layout->first_time, (double)layout->last_time );
        write_accessor( text, view, layout->weights_at - layout->times_at, FLOAT, count * ( count - 1 ), "SCALAR",
                        NULL );
    }
    end_list( text );
}

static void write_view( glb_text* text, uint64_t at, uint64_t size, const char* more )
{
    begin_item( text );
    fprintf( text->out, "{\"buffer\":0,\"byteOffset\":%llu,\"byteLength\":%llu%s}", (unsigned long long)at,
             (unsigned long long)size, more );
}

static void write_views( glb_text* text )
{
    const glb_layout* layout = text->layout;
    begin_list( text, "bufferViews" );
    for ( int b = 0; b < text->recorder->bodies.count; ++b )
    {
        const glb_body* place = &layout->bodies[b];
        const uint64_t end =
            b + 1 < text->recorder->bodies.count ? layout->bodies[b + 1].indices_at : layout->times_at;
        if ( place->index_count > 0 )
        {
            write_view( text, place->indices_at, place->points_at - place->indices_at,
                        ",\"target\":34963" ); // indices
        }
        write_view( text, place->points_at, end - place->points_at,
                    ",\"byteStride\":12,\"target\":34962" ); // vertices
    }
    if ( layout->is_animated )
    {
        write_view( text, layout->times_at, layout->size - layout->times_at, "" );
    }
    end_list( text );
    fprintf( text->out, ",\"buffers\":[{\"byteLength\":%llu}]", (unsigned long long)layout->size );
}

// ---- animation -------------------------------------------------------------------------------------------------

static int count_accessors( const glb_text* text )
{
    int count = 0;
    for ( int b = 0; b < text->recorder->bodies.count; ++b )
    {
        const glb_body* place = &text->layout->bodies[b];
        count += ( place->index_count > 0 ) + glb_base_blocks( body_of( text, b ), place ) +
                 place->target_count * glb_target_blocks( place );
    }
    return count;
}

// All bodies that move have the same weights.
static void write_animation( glb_text* text )
{
    const int times = count_accessors( text );
    fprintf( text->out,
             ",\"animations\":[{\"name\":\"recording\",\"samplers\":[{\"input\":%d,\"output\":%d,"
             "\"interpolation\":\"LINEAR\"}]",
             times, times + 1 );
    begin_list( text, "channels" );
    for ( int b = 0; b < text->recorder->bodies.count; ++b )
    {
        if ( text->layout->bodies[b].target_count > 0 )
        {
            begin_item( text );
            fprintf( text->out, "{\"sampler\":0,\"target\":{\"node\":%d,\"path\":\"weights\"}}", b );
        }
    }
    fputs( "]}]", text->out );
}

// ---- whole text ------------------------------------------------------------------------------------------------

bool glb_write_json( const wisp_recorder* recorder, const glb_layout* layout, char** out, size_t* size )
{
    glb_text text = { open_memstream( out, size ), recorder, layout, true };
    if ( text.out == NULL )
    {
        return false;
    }
    fputs( "{\"asset\":{\"version\":\"2.0\",\"generator\":\"Wisp " WISP_VERSION_STRING "\"}", text.out );
    if ( layout->frame_count > 0 )
    {
        write_nodes( &text );
        write_meshes( &text );
        write_materials( &text );
        write_accessors( &text );
        write_views( &text );
    }
    if ( layout->is_animated )
    {
        write_animation( &text );
    }
    fputs( "}", text.out );
    const bool written = !ferror( text.out );
    return fclose( text.out ) == 0 && written;
}
