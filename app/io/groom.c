// The container: memory and checks.
#include "groom_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io_file.h"

#include "wisp/module/definition.h"

// ---- memory ----------------------------------------------------------------------------------------------------

void wisp_groom_release( wisp_groom* groom )
{
    free( groom->offsets );
    free( groom->points );
    free( groom->thickness );
    free( groom->transparency );
    free( groom->colour );
    *groom = ( wisp_groom ){ 0 };
}

wisp_status groom_allocate( wisp_groom* groom, int strand_count, int vertex_count, int columns, const char* name,
                            wisp_error* error )
{
    size_t vertices = (size_t)vertex_count;
    bool thick = ( columns & GROOM_THICKNESS ) != 0;
    bool clear = ( columns & GROOM_TRANSPARENCY ) != 0;
    bool coloured = ( columns & GROOM_COLOUR ) != 0;
    *groom = ( wisp_groom ){
        .strand_count = strand_count,
        .vertex_count = vertex_count,
        .dimension = 3,
        .offsets = malloc( ( (size_t)strand_count + 1 ) * sizeof( int ) ),
        .points = malloc( vertices * sizeof( wisp_vec3 ) ),
        .thickness = thick ? malloc( vertices * sizeof( float ) ) : NULL,
        .transparency = clear ? malloc( vertices * sizeof( float ) ) : NULL,
        .colour = coloured ? malloc( vertices * sizeof( wisp_vec3 ) ) : NULL,
    };
    if ( groom->offsets == NULL || groom->points == NULL || ( thick && groom->thickness == NULL ) ||
         ( clear && groom->transparency == NULL ) || ( coloured && groom->colour == NULL ) )
    {
        wisp_groom_release( groom );
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d strands with %d vertices",
                          io_short_name( name ), strand_count, vertex_count );
    }
    return WISP_OK;
}

// ---- checks ----------------------------------------------------------------------------------------------------

int groom_dimension_of( const wisp_groom* groom )
{
    for ( int v = 0; v < groom->vertex_count; ++v )
    {
        if ( groom->points[v].z != 0.0f )
        {
            return 3;
        }
    }
    return 2;
}

static wisp_status check_offsets( const wisp_groom* groom, const char* name, wisp_error* error )
{
    if ( groom->strand_count < 1 || groom->vertex_count < 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the groom is empty: %d strands, %d vertices", name,
                          groom->strand_count, groom->vertex_count );
    }
    if ( groom->offsets == NULL || groom->points == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the groom has no %s", name,
                          groom->offsets == NULL ? "offsets" : "points" );
    }
    if ( groom->offsets[0] != 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: strand 0 starts at vertex %d, expected 0", name,
                          groom->offsets[0] );
    }
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        if ( groom->offsets[s + 1] < groom->offsets[s] || groom->offsets[s + 1] > groom->vertex_count )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: strand %d runs from vertex %d to %d of %d", name, s,
                              groom->offsets[s], groom->offsets[s + 1], groom->vertex_count );
        }
    }
    if ( groom->offsets[groom->strand_count] != groom->vertex_count )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the strands end at vertex %d of %d", name,
                          groom->offsets[groom->strand_count], groom->vertex_count );
    }
    return WISP_OK;
}

// The numbers of one vertex with their names in messages.
typedef struct vertex_numbers
{
    const char* name[8];
    float value[8];
    int count;
} vertex_numbers;

static void add_number( vertex_numbers* numbers, const char* name, float value )
{
    numbers->name[numbers->count] = name;
    numbers->value[numbers->count] = value;
    ++numbers->count;
}

static vertex_numbers gather( const wisp_groom* groom, int v )
{
    vertex_numbers numbers = { .count = 0 };
    add_number( &numbers, "x", groom->points[v].x );
    add_number( &numbers, "y", groom->points[v].y );
    add_number( &numbers, "z", groom->points[v].z );
    if ( groom->thickness != NULL )
    {
        add_number( &numbers, "thickness", groom->thickness[v] );
    }
    if ( groom->transparency != NULL )
    {
        add_number( &numbers, "transparency", groom->transparency[v] );
    }
    if ( groom->colour != NULL )
    {
        add_number( &numbers, "red", groom->colour[v].x );
        add_number( &numbers, "green", groom->colour[v].y );
        add_number( &numbers, "blue", groom->colour[v].z );
    }
    return numbers;
}

static wisp_status check_vertex_finite( const wisp_groom* groom, int s, int v, const char* name, wisp_error* error )
{
    vertex_numbers numbers = gather( groom, v );
    for ( int k = 0; k < numbers.count; ++k )
    {
        if ( !isfinite( numbers.value[k] ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: strand %d, vertex %d: %s is %s", name, s,
                              v - groom->offsets[s], numbers.name[k],
                              isnan( numbers.value[k] ) ? "NaN" : "infinite" );
        }
    }
    return WISP_OK;
}

wisp_status groom_check_finite( const wisp_groom* groom, const char* name, wisp_error* error )
{
    name = io_short_name( name );
    wisp_status status = check_offsets( groom, name, error );
    for ( int s = 0; status == WISP_OK && s < groom->strand_count; ++s )
    {
        for ( int v = groom->offsets[s]; status == WISP_OK && v < groom->offsets[s + 1]; ++v )
        {
            status = check_vertex_finite( groom, s, v, name, error );
        }
    }
    return status;
}

// Coordinates come first in gather(), thickness by name, all others are fractions.
static wisp_status check_vertex_range( const wisp_groom* groom, int s, int v, wisp_error* error )
{
    vertex_numbers numbers = gather( groom, v );
    for ( int k = 0; k < numbers.count; ++k )
    {
        bool coordinate = k < 3;
        bool thickness = groom->thickness != NULL && k == 3;
        float least = coordinate ? -WISP_GROOM_MAX_COORDINATE : 0.0f;
        float most = coordinate || thickness ? WISP_GROOM_MAX_COORDINATE : 1.0f;
        if ( numbers.value[k] < least || numbers.value[k] > most )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "groom: strand %d, vertex %d: %s: got %.9g, expected %g .. %g",
                              s, v - groom->offsets[s], numbers.name[k], (double)numbers.value[k], (double)least,
                              (double)most );
        }
    }
    if ( groom->dimension == 2 && groom->points[v].z != 0.0f )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "groom: strand %d, vertex %d: z: got %.9g, expected 0 in two dimensions", s,
                          v - groom->offsets[s], (double)groom->points[v].z );
    }
    return WISP_OK;
}

wisp_status wisp_groom_check( const wisp_groom* groom, wisp_error* error )
{
    wisp_status status = groom_check_finite( groom, "groom", error );
    if ( status == WISP_OK && groom->dimension != 2 && groom->dimension != 3 )
    {
        status = wisp_fail( error, WISP_BAD_INPUT, "groom: got %d dimensions, expected 2 or 3", groom->dimension );
    }
    for ( int s = 0; status == WISP_OK && s < groom->strand_count; ++s )
    {
        for ( int v = groom->offsets[s]; status == WISP_OK && v < groom->offsets[s + 1]; ++v )
        {
            status = check_vertex_range( groom, s, v, error );
        }
    }
    return status;
}

wisp_status wisp_groom_of_arrays( const wisp_vec3* points, int vertex_count, const int32_t* offsets, int strand_count,
                                  const char* name, wisp_groom* out, wisp_error* error )
{
    *out = ( wisp_groom ){ 0 };
    // The checks only read; there is no groom of read-only arrays.
    wisp_groom given = { .strand_count = strand_count,
                         .vertex_count = vertex_count,
                         .dimension = 3,
                         .offsets = (int*)(uintptr_t)offsets,
                         .points = (wisp_vec3*)(uintptr_t)points };
    wisp_error cause = { 0 };
    if ( wisp_groom_check( &given, &cause ) != WISP_OK )
    {
        return wisp_fail( error, cause.status, "%s: %s", io_short_name( name ), cause.message );
    }
    WISP_TRY( groom_allocate( out, strand_count, vertex_count, 0, name, error ) );
    memcpy( out->points, points, (size_t)vertex_count * sizeof *points );
    memcpy( out->offsets, offsets, ( (size_t)strand_count + 1 ) * sizeof *offsets );
    out->dimension = groom_dimension_of( out );
    return WISP_OK;
}
