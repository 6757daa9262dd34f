// Bodies and their points: checks that writers and readers share, copies, normals, boxes.
#include "record_internal.h"

#include "wisp/module/definition.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>

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
    const int32_t* offsets = body->offsets;
    if ( body->strand_count < 1 )
    {
        return wrong( c, -1, "got %d strands, expected at least 1", body->strand_count );
    }
    if ( offsets[0] != 0 )
    {
        return wrong( c, -1, "strand 0 starts at vertex %d, expected 0", offsets[0] );
    }
    for ( int s = 0; s < body->strand_count; ++s )
    {
        if ( offsets[s + 1] < offsets[s] || offsets[s + 1] > body->vertex_count )
        {
            return wrong( c, -1, "strand %d runs from vertex %d to %d of %d", s, offsets[s], offsets[s + 1],
                          body->vertex_count );
        }
    }
    const int end = offsets[body->strand_count];
    return end == body->vertex_count ? WISP_OK
                                     : wrong( c, -1, "the strands end at vertex %d of %d", end, body->vertex_count );
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
    if ( body->name == NULL || !is_name( body->name ) )
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

wisp_record_body* record_copy_bodies( record_memory* memory, const wisp_record_body* bodies, int count )
{
    wisp_record_body* list = record_copy( memory, bodies, (size_t)count * sizeof *bodies );
    for ( int b = 0; list != NULL && b < count; ++b )
    {
        wisp_record_body* to = &list[b];
        const size_t vertices = (size_t)to->vertex_count;
        to->triangle_count = to->offsets != NULL ? 0 : to->triangle_count;
        to->strand_count = to->offsets != NULL ? to->strand_count : 0;
        to->name = record_copy( memory, to->name, strlen( to->name ) + 1 );
        to->triangles = record_copy( memory, to->triangles, 3 * (size_t)to->triangle_count * sizeof *to->triangles );
        to->offsets = record_copy( memory, to->offsets, ( (size_t)to->strand_count + 1 ) * sizeof *to->offsets );
        to->widths = record_copy( memory, to->widths, vertices * sizeof *to->widths );
        to->colours = record_copy( memory, to->colours, vertices * sizeof *to->colours );
        wisp_record_value* values = record_copy( memory, to->values, (size_t)to->value_count * sizeof *values );
        for ( int i = 0; values != NULL && i < to->value_count; ++i )
        {
            values[i].name = record_copy( memory, values[i].name, strlen( values[i].name ) + 1 );
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

void record_extend_bounds( record_bounds* bounds, const wisp_vec3* points, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        const wisp_vec3 p = points[v];
        const wisp_vec3 a = bounds->filled ? bounds->least : p;
        const wisp_vec3 b = bounds->filled ? bounds->most : p;
        bounds->least = ( wisp_vec3 ){ fminf( a.x, p.x ), fminf( a.y, p.y ), fminf( a.z, p.z ) };
        bounds->most = ( wisp_vec3 ){ fmaxf( b.x, p.x ), fmaxf( b.y, p.y ), fmaxf( b.z, p.z ) };
        bounds->filled = true;
    }
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
