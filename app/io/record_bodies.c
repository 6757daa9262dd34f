// Bodies and their points: checks that writers and readers share, copies, bytes, checksums.
#include "record_internal.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

// ---- checks ----------------------------------------------------------------------------------------------------

static bool is_letter( char c )
{
    return ( c >= 'a' && c <= 'z' ) || ( c >= 'A' && c <= 'Z' ) || ( c >= '0' && c <= '9' ) || c == '_' || c == '-';
}

// Names become parts of paths, so a slash or a leading dot must not be accepted.
static bool is_name( const char* text )
{
    size_t length = 0;
    while ( length <= WISP_RECORD_MAX_NAME && is_letter( text[length] ) )
    {
        ++length;
    }
    return length >= 1 && length <= WISP_RECORD_MAX_NAME && text[length] == 0;
}

wisp_status record_check_mesh( const wisp_record_body* body, const char* name, wisp_error* error )
{
    // Three corners a triangle must fit an int, because ParaView counts them.
    if ( body->triangle_count < 0 || body->triangle_count > INT_MAX / 3 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: body %s: got %d triangles, expected 0 .. %d", name, body->name,
                          body->triangle_count, INT_MAX / 3 );
    }
    if ( body->triangle_count > 0 && body->triangles == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: body %s: the list of its %d triangles is missing", name,
                          body->name, body->triangle_count );
    }
    for ( int t = 0; t < body->triangle_count; ++t )
    {
        for ( int k = 0; k < 3; ++k )
        {
            int32_t vertex = body->triangles[3 * (size_t)t + (size_t)k];
            if ( vertex < 0 || vertex >= body->vertex_count )
            {
                return wisp_fail( error, WISP_BAD_INPUT, "%s: body %s: triangle %d: got vertex %d, expected 0 .. %d",
                                  name, body->name, t, vertex, body->vertex_count - 1 );
            }
        }
    }
    return WISP_OK;
}

static wisp_status check_strands( const wisp_record_body* body, const char* name, wisp_error* error )
{
    if ( body->strand_count < 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: body %s: got %d strands, expected at least 1", name, body->name,
                          body->strand_count );
    }
    if ( body->offsets[0] != 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: body %s: strand 0 starts at vertex %d, expected 0", name,
                          body->name, body->offsets[0] );
    }
    for ( int s = 0; s < body->strand_count; ++s )
    {
        if ( body->offsets[s + 1] < body->offsets[s] || body->offsets[s + 1] > body->vertex_count )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: body %s: strand %d runs from vertex %d to %d of %d", name,
                              body->name, s, body->offsets[s], body->offsets[s + 1], body->vertex_count );
        }
    }
    int end = body->offsets[body->strand_count];
    return end == body->vertex_count
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "%s: body %s: the strands end at vertex %d of %d", name,
                            body->name, end, body->vertex_count );
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
    return is_name( text ) && strchr( text, '-' ) == NULL && !( text[0] >= '0' && text[0] <= '9' );
}

static bool is_fraction( wisp_vec3 c )
{
    return c.x >= 0.0f && c.x <= 1.0f && c.y >= 0.0f && c.y <= 1.0f && c.z >= 0.0f && c.z <= 1.0f;
}

static wisp_status check_appearance( const wisp_record_body* body, const char* name, wisp_error* error )
{
    if ( !is_fraction( body->base_colour ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: body %s: got a colour of (%g, %g, %g), expected 0 to 1", name,
                          body->name, (double)body->base_colour.x, (double)body->base_colour.y,
                          (double)body->base_colour.z );
    }
    // Readers have neither, and a count of vertices that nothing confirms.
    for ( int v = 0; body->colours != NULL && v < body->vertex_count; ++v )
    {
        const wisp_vec3 c = body->colours[v];
        if ( !is_fraction( c ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "%s: body %s, vertex %d: got a colour of (%g, %g, %g), expected 0 to 1", name,
                              body->name, v, (double)c.x, (double)c.y, (double)c.z );
        }
    }
    for ( int v = 0; body->widths != NULL && v < body->vertex_count; ++v )
    {
        if ( !isfinite( body->widths[v] ) || body->widths[v] < 0.0f )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "%s: body %s, vertex %d: got a width of %g m, expected at least 0", name, body->name, v,
                              (double)body->widths[v] );
        }
    }
    return WISP_OK;
}

static wisp_status check_values( const wisp_record_body* body, const char* name, wisp_error* error )
{
    for ( int i = 0; i < body->value_count; ++i )
    {
        const wisp_record_value* value = &body->values[i];
        if ( value->name == NULL || !is_value_name( value->name ) || value->numbers == NULL )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "%s: body %s: value %d has no numbers, or a name that files use or that has other "
                              "characters than A-Z a-z 0-9 _",
                              name, body->name, i );
        }
        for ( int other = 0; other < i; ++other )
        {
            if ( strcmp( body->values[other].name, value->name ) == 0 )
            {
                return wisp_fail( error, WISP_BAD_INPUT, "%s: body %s: two values are called %s", name, body->name,
                                  value->name );
            }
        }
    }
    return WISP_OK;
}

static wisp_status check_body( const wisp_record_body* bodies, int b, const char* name, wisp_error* error )
{
    const wisp_record_body* body = &bodies[b];
    if ( body->name == NULL || !is_name( body->name ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: body %d: expected a name of 1 to %d of the characters A-Z a-z 0-9 _ -", name, b,
                          WISP_RECORD_MAX_NAME );
    }
    for ( int other = 0; other < b; ++other )
    {
        if ( strcmp( bodies[other].name, body->name ) == 0 )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: bodies %d and %d are both called %s", name, other, b,
                              body->name );
        }
    }
    if ( body->vertex_count < 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: body %s: got %d vertices, expected at least 1", name,
                          body->name, body->vertex_count );
    }
    wisp_status status =
        body->offsets != NULL ? check_strands( body, name, error ) : record_check_mesh( body, name, error );
    status = status == WISP_OK ? check_appearance( body, name, error ) : status;
    return status == WISP_OK ? check_values( body, name, error ) : status;
}

wisp_status record_check_bodies( const wisp_record_body* bodies, int count, const char* name, wisp_error* error )
{
    name = io_short_name( name );
    if ( count < 1 || count > WISP_RECORD_MAX_BODIES )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %d bodies, expected 1 to %d", name, count,
                          WISP_RECORD_MAX_BODIES );
    }
    int64_t vertices = 0;
    for ( int b = 0; b < count; ++b )
    {
        wisp_status status = check_body( bodies, b, name, error );
        if ( status != WISP_OK )
        {
            return status;
        }
        vertices += bodies[b].vertex_count;
    }
    // Formats that number the vertices of all bodies together use an int, and some count from 1.
    return vertices < INT_MAX
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "%s: %lld vertices are more than a recording can hold", name,
                            (long long)vertices );
}

// ---- memory ----------------------------------------------------------------------------------------------------

// @return null where there is nothing to copy, and without memory, which `made` then says
static void* copy_block( const void* from, size_t size, bool* made )
{
    void* copy = from != NULL && size > 0 ? malloc( size ) : NULL;
    if ( copy != NULL )
    {
        memcpy( copy, from, size );
    }
    *made = *made && ( copy != NULL || from == NULL || size == 0 );
    return copy;
}

// The numbers remain the caller's.
static bool copy_values( const wisp_record_body* from, wisp_record_body* to )
{
    wisp_record_value* values = from->value_count > 0 ? calloc( (size_t)from->value_count, sizeof *values ) : NULL;
    bool made = values != NULL || from->value_count == 0;
    to->values = values;
    for ( int i = 0; made && i < from->value_count; ++i )
    {
        values[i] = ( wisp_record_value ){ strdup( from->values[i].name ), from->values[i].numbers };
        to->value_count = i + 1;
        made = values[i].name != NULL;
    }
    return made;
}

static bool copy_body( const wisp_record_body* from, wisp_record_body* to )
{
    bool strands = from->offsets != NULL;
    *to = ( wisp_record_body ){
        .name = strdup( from->name ),
        .vertex_count = from->vertex_count,
        .triangle_count = strands ? 0 : from->triangle_count,
        .strand_count = strands ? from->strand_count : 0,
        .base_colour = from->base_colour,
        .is_static = from->is_static,
        .triangles_change = from->triangles_change,
    };
    const size_t vertices = (size_t)from->vertex_count;
    bool made = to->name != NULL;
    to->triangles = copy_block( from->triangles, 3 * (size_t)to->triangle_count * sizeof *to->triangles, &made );
    to->offsets = copy_block( from->offsets, ( (size_t)to->strand_count + 1 ) * sizeof *to->offsets, &made );
    to->widths = copy_block( from->widths, vertices * sizeof *to->widths, &made );
    to->colours = copy_block( from->colours, vertices * sizeof *to->colours, &made );
    return made && copy_values( from, to );
}

wisp_status record_copy_bodies( const wisp_record_body* bodies, int count, const char* name, record_bodies* out,
                                wisp_error* error )
{
    *out = ( record_bodies ){ calloc( (size_t)count, sizeof *out->list ),
                              calloc( (size_t)count, sizeof( const int32_t* ) ), count };
    bool copied = out->list != NULL && out->sources != NULL;
    for ( int b = 0; copied && b < count; ++b )
    {
        copied = copy_body( &bodies[b], &out->list[b] );
        out->sources[b] = bodies[b].triangles_change ? bodies[b].triangles : NULL;
    }
    if ( !copied )
    {
        record_release_bodies( out );
        return record_no_memory( name, error );
    }
    return WISP_OK;
}

// The structs are read-only for callers, and owned here.
static void release( const void* block )
{
    free( (void*)(uintptr_t)block );
}

void record_release_bodies( record_bodies* bodies )
{
    for ( int b = 0; bodies->list != NULL && b < bodies->count; ++b )
    {
        const wisp_record_body* body = &bodies->list[b];
        for ( int i = 0; i < body->value_count; ++i )
        {
            release( body->values[i].name );
        }
        release( body->values );
        release( body->name );
        release( body->triangles );
        release( body->offsets );
        release( body->widths );
        release( body->colours );
    }
    free( bodies->list );
    free( bodies->sources );
    *bodies = ( record_bodies ){ 0 };
}

// ---- points ----------------------------------------------------------------------------------------------------

uint64_t record_triangle_bytes( const wisp_record_body* body )
{
    return body->triangles_change ? 3 * sizeof( int32_t ) * (uint64_t)body->triangle_count : 0;
}

uint64_t record_frame_bytes( const record_bodies* bodies )
{
    uint64_t bytes = 0;
    for ( int b = 0; b < bodies->count; ++b )
    {
        bytes +=
            RECORD_POINT_SIZE * (uint64_t)bodies->list[b].vertex_count + record_triangle_bytes( &bodies->list[b] );
    }
    return bytes;
}

void record_set_triangles( const wisp_record_body* body, const int32_t* triangles )
{
    if ( body->triangle_count > 0 )
    {
        memcpy( (void*)(uintptr_t)body->triangles, triangles, (size_t)record_triangle_bytes( body ) );
    }
}

int64_t record_find_not_finite( const wisp_vec3* points, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        const float numbers[3] = { points[v].x, points[v].y, points[v].z };
        for ( int k = 0; k < 3; ++k )
        {
            if ( !isfinite( numbers[k] ) )
            {
                return 3 * (int64_t)v + k;
            }
        }
    }
    return -1;
}

void record_get_points( const unsigned char* bytes, int count, wisp_vec3* points )
{
    for ( int v = 0; v < count; ++v )
    {
        points[v] = io_get_vec3( bytes + RECORD_POINT_SIZE * (size_t)v );
    }
}

void record_put_points( unsigned char* bytes, const wisp_vec3* points, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        io_put_vec3( bytes + RECORD_POINT_SIZE * (size_t)v, points[v] );
    }
}

uint64_t record_checksum( uint64_t seed, const unsigned char* bytes, size_t size )
{
    uint64_t hash = seed ^ ( (uint64_t)size * 0x9e3779b97f4a7c15u );
    for ( size_t at = 0; at < size; at += 8 )
    {
        uint64_t word = 0;
        if ( size - at >= 8 )
        {
            word = io_get_u64( bytes + at );
        }
        else
        {
            for ( size_t i = at; i < size; ++i )
            {
                word |= (uint64_t)bytes[i] << ( 8 * ( i - at ) );
            }
        }
        hash = ( hash ^ word ) * 0xff51afd7ed558ccdu;
        hash ^= hash >> 32;
    }
    return hash;
}
