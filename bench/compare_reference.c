#include "compare_reference.h"

#include "reference_bytes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    VERSION = 1,
    HEAD = REFERENCE_MAGIC_SIZE + 4 * 4 + 8 + 8 * ( COMPARE_INFO + 4 ),
    OBSERVATION_NUMBERS = 6,
    TAIL = 8,
};

static size_t observation_size( int vertices )
{
    return OBSERVATION_NUMBERS * 8 + (size_t)vertices * 12;
}

static size_t file_size( int vertices, int observations )
{
    return HEAD + (size_t)observations * observation_size( vertices ) + TAIL;
}

void compare_reference_info( const compare_physics* physics, double info[COMPARE_INFO] )
{
    const float all[COMPARE_INFO] = {
        COMPARE_STRETCH_STIFFNESS,
        physics->bend,
        physics->damping,
        physics->damping_link,
        TRIANGLE_DENSITY,
        TRIANGLE_GRAVITY,
        physics->drop,
        physics->widening,
        physics->has_ball ? TRIANGLE_BALL_RADIUS : 0.0f,
        TRIANGLE_MARGIN,
        TRIANGLE_STATIC_FRICTION,
        TRIANGLE_KINETIC_FRICTION,
    };
    for ( int i = 0; i < COMPARE_INFO; ++i )
    {
        info[i] = (double)all[i];
    }
}

void compare_reference_free( compare_reference* reference )
{
    free( reference->points );
    *reference = ( compare_reference ){ .points = NULL };
}

// ---- reading ----

static wisp_status check_frame( const unsigned char* bytes, size_t size, const char* name, wisp_error* error )
{
    const wisp_status status = reference_check_beginning( bytes, size, HEAD, TAIL, name, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const unsigned char* at = bytes + REFERENCE_MAGIC_SIZE;
    const uint32_t version = (uint32_t)reference_take( &at, 4 ), scenario = (uint32_t)reference_take( &at, 4 );
    const uint32_t vertices = (uint32_t)reference_take( &at, 4 ), observations = (uint32_t)reference_take( &at, 4 );
    if ( version != VERSION || scenario >= COMPARE_SCENARIO_COUNT )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte 8: version %u and scenario %u are not known", name,
                          version, scenario );
    }
    if ( vertices < 3 || vertices > COMPARE_VERTICES_MAX || observations < 2 ||
         observations > COMPARE_OBSERVATIONS_MAX )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte 16: %u vertices and %u samples are out of range", name,
                          vertices, observations );
    }
    const size_t requested = file_size( (int)vertices, (int)observations );
    if ( size != requested )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: %u samples of %u vertices take %zu bytes, there are %zu", name,
                          observations, vertices, requested, size );
    }
    at = bytes + size - TAIL;
    if ( reference_take( &at, TAIL ) != reference_checksum( bytes, size - TAIL ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %zu: the checksum is wrong, the file is broken", name,
                          size - TAIL );
    }
    return WISP_OK;
}

static void take_head( const unsigned char** at, compare_reference* out )
{
    *at += REFERENCE_MAGIC_SIZE + 4;
    out->scenario = (int)reference_take( at, 4 );
    out->vertex_count = (int)reference_take( at, 4 );
    out->observation_count = (int)reference_take( at, 4 );
    out->mesh_hash = reference_take( at, 8 );
    for ( int i = 0; i < COMPARE_INFO; ++i )
    {
        out->info[i] = reference_take_double( at );
    }
    out->rate = reference_take_double( at );
    out->rest_rate = reference_take_double( at );
    out->order = reference_take_double( at );
    out->residual = reference_take_double( at );
}

// @return whether all of it is finite, and later than the previous sample
static bool take_observation( const unsigned char** at, int number, compare_reference* out )
{
    compare_reference_observation* to = &out->observations[number];
    double* numbers[OBSERVATION_NUMBERS] = { &to->time,
                                             &to->observation.hem,
                                             &to->observation.strain,
                                             &to->observation.energy,
                                             &to->observation.slack,
                                             &to->uncertainty };
    bool good = true;
    for ( int i = 0; i < OBSERVATION_NUMBERS; ++i )
    {
        *numbers[i] = reference_take_double( at );
        good = good && isfinite( *numbers[i] );
    }
    float* points = out->points + (size_t)number * 3 * (size_t)out->vertex_count;
    for ( int i = 0; i < 3 * out->vertex_count; ++i )
    {
        points[i] = reference_take_float( at );
        good = good && fabsf( points[i] ) < 1e6f;
    }
    return good && to->time <= 1e3 && ( number == 0 || to->time > to[-1].time );
}

wisp_status compare_reference_parse( const void* bytes, size_t size, const char* name, compare_reference* out,
                                     wisp_error* error )
{
    *out = ( compare_reference ){ .points = NULL };
    wisp_status status = check_frame( bytes, size, name, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const unsigned char* at = bytes;
    take_head( &at, out );
    out->points = calloc( (size_t)out->observation_count * (size_t)out->vertex_count, 3 * sizeof( float ) );
    if ( !out->points )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: no memory for the reference", name );
    }
    for ( int k = 0; k < out->observation_count && status == WISP_OK; ++k )
    {
        if ( !take_observation( &at, k, out ) )
        {
            status = wisp_fail( error, WISP_BAD_INPUT, "%s: sample %d has a number that is out of range", name, k );
        }
    }
    if ( status != WISP_OK )
    {
        compare_reference_free( out );
    }
    return status;
}

wisp_status compare_reference_read( const char* path, compare_reference* out, wisp_error* error )
{
    unsigned char* bytes = NULL;
    size_t size = 0;
    *out = ( compare_reference ){ .points = NULL };
    // One byte more than the largest reference, to detect a longer file.
    const size_t room = file_size( COMPARE_VERTICES_MAX, COMPARE_OBSERVATIONS_MAX ) + 1;
    wisp_status status = reference_read_bytes( path, room, &bytes, &size, error );
    if ( status == WISP_OK )
    {
        status = compare_reference_parse( bytes, size, path, out, error );
    }
    free( bytes );
    return status;
}

wisp_status compare_reference_check( const compare_reference* reference, const compare_scene* scene, const char* name,
                                     wisp_error* error )
{
    double info[COMPARE_INFO];
    compare_reference_info( &scene->physics, info );
    if ( reference->vertex_count != scene->base.mesh.vertex_count || reference->mesh_hash != scene->hash )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: it is of another mesh, of %d vertices; `./dev reference` writes it again", name,
                          reference->vertex_count );
    }
    if ( reference->observation_count != scene->physics.observation_count + 1 ||
         memcmp( reference->info, info, sizeof( info ) ) != 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: it is of another material or scene than `%s`; `./dev reference` writes it again", name,
                          scene->physics.name );
    }
    return WISP_OK;
}

// ---- writing ----

static void put_all( const compare_reference* reference, unsigned char* bytes, size_t size )
{
    unsigned char* at = bytes;
    memcpy( at, REFERENCE_MAGIC, REFERENCE_MAGIC_SIZE );
    at += REFERENCE_MAGIC_SIZE;
    reference_put( &at, 4, VERSION );
    reference_put( &at, 4, (uint64_t)reference->scenario );
    reference_put( &at, 4, (uint64_t)reference->vertex_count );
    reference_put( &at, 4, (uint64_t)reference->observation_count );
    reference_put( &at, 8, reference->mesh_hash );
    for ( int i = 0; i < COMPARE_INFO; ++i )
    {
        reference_put_double( &at, reference->info[i] );
    }
    const double how[4] = { reference->rate, reference->rest_rate, reference->order, reference->residual };
    for ( int i = 0; i < 4; ++i )
    {
        reference_put_double( &at, how[i] );
    }
    for ( int k = 0; k < reference->observation_count; ++k )
    {
        const compare_reference_observation* observation = &reference->observations[k];
        const double numbers[OBSERVATION_NUMBERS] = { observation->time,
                                                      observation->observation.hem,
                                                      observation->observation.strain,
                                                      observation->observation.energy,
                                                      observation->observation.slack,
                                                      observation->uncertainty };
        for ( int i = 0; i < OBSERVATION_NUMBERS; ++i )
        {
            reference_put_double( &at, numbers[i] );
        }
        const float* points = reference->points + (size_t)k * 3 * (size_t)reference->vertex_count;
        for ( int i = 0; i < 3 * reference->vertex_count; ++i )
        {
            reference_put_float( &at, points[i] );
        }
    }
    reference_put( &at, TAIL, reference_checksum( bytes, size - TAIL ) );
}

wisp_status compare_reference_write( const compare_reference* reference, const char* path, wisp_error* error )
{
    const size_t size = file_size( reference->vertex_count, reference->observation_count );
    unsigned char* bytes = malloc( size );
    if ( !bytes )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: no memory for the file", path );
    }
    put_all( reference, bytes, size );
    const wisp_status status = reference_write_bytes( path, bytes, size, error );
    free( bytes );
    return status;
}
