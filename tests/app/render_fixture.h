/// Bodies and pictures shared by the picture tests.
#pragma once

#include "unit.h"

#include "render.h"

#define FIXTURE_RINGS 24
#define FIXTURE_AROUND 48

/// A ball of 2304 triangles. Free with fixture_ball_free().
typedef struct fixture_ball
{
    wisp_vec3* points;
    int32_t* triangles;
    int vertex_count, triangle_count;
} fixture_ball;

static inline fixture_ball fixture_ball_make( wisp_vec3 centre, float radius )
{
    fixture_ball b = { .vertex_count = FIXTURE_AROUND * ( FIXTURE_RINGS + 1 ) };
    b.points = calloc( (size_t)b.vertex_count, sizeof( wisp_vec3 ) );
    b.triangles = calloc( (size_t)( 6 * FIXTURE_AROUND * FIXTURE_RINGS ), sizeof( int32_t ) );
    assert_non_null( b.points );
    assert_non_null( b.triangles );
    const float pi = 3.14159265f;
    for ( int v = 0; v < b.vertex_count; ++v )
    {
        float down = pi * (float)( v / FIXTURE_AROUND ) / FIXTURE_RINGS;
        float around = 2.0f * pi * (float)( v % FIXTURE_AROUND ) / FIXTURE_AROUND;
        b.points[v] = ( wisp_vec3 ){
            centre.x + radius * sinf( down ) * cosf( around ),
            centre.y + radius * cosf( down ),
            centre.z + radius * sinf( down ) * sinf( around ),
        };
    }
    for ( int q = 0; q < FIXTURE_AROUND * FIXTURE_RINGS; ++q )
    {
        int right = q % FIXTURE_AROUND == FIXTURE_AROUND - 1 ? q + 1 - FIXTURE_AROUND : q + 1;
        const int32_t two[] = { q, right, q + FIXTURE_AROUND, right, right + FIXTURE_AROUND, q + FIXTURE_AROUND };
        memcpy( b.triangles + 6 * q, two, sizeof( two ) );
        b.triangle_count += 2;
    }
    return b;
}

static inline void fixture_ball_free( fixture_ball* b )
{
    free( b->points );
    free( b->triangles );
}

static inline render_mesh fixture_mesh( const fixture_ball* b, render_material material )
{
    render_mesh mesh = render_default_mesh( material );
    mesh.points = b->points;
    mesh.triangles = b->triangles;
    mesh.vertex_count = b->vertex_count;
    mesh.triangle_count = b->triangle_count;
    return mesh;
}

/// From (0, 1, 5) level along -z, 40 degrees high.
static inline render_camera fixture_camera( void )
{
    return ( render_camera ){
        .eye = { 0.0f, 1.0f, 5.0f },
        .target = { 0.0f, 1.0f, 0.0f },
        .up = { 0.0f, 1.0f, 0.0f },
        .fov_degrees = 40.0f,
    };
}

/// Small and quick: 96 x 72 pixels of 4 samples.
static inline render_options fixture_options( void )
{
    render_options options = render_default_options();
    options.width = 96;
    options.height = 72;
    options.samples = 4;
    return options;
}

/// Render, which must succeed. Release the image.
static inline image fixture_picture( const render_scene* scene, const render_camera* camera,
                                     const render_options* options )
{
    image out = { 0 };
    wisp_error error = { .status = WISP_OK };
    assert_ok( render_picture( scene, camera, options, &out, &error ), error );
    assert_int_equal( out.width, options->width );
    assert_int_equal( out.height, options->height );
    return out;
}

static inline const uint8_t* fixture_pixel( const image* picture, int x, int y )
{
    assert_in_range( x, 0, picture->width - 1 );
    assert_in_range( y, 0, picture->height - 1 );
    return picture->rgb + 3 * ( (size_t)y * (size_t)picture->width + (size_t)x );
}

static inline int fixture_brightness( const image* picture, int x, int y )
{
    const uint8_t* p = fixture_pixel( picture, x, y );
    return p[0] + p[1] + p[2];
}

/// True if the pictures differ there by more than rounding.
static inline bool fixture_differs( const image* a, const image* b, int x, int y )
{
    const uint8_t *p = fixture_pixel( a, x, y ), *q = fixture_pixel( b, x, y );
    return abs( p[0] - q[0] ) > 1 || abs( p[1] - q[1] ) > 1 || abs( p[2] - q[2] ) > 1;
}

/// The number of pixels that differ.
static inline int fixture_count_differing( const image* a, const image* b )
{
    int count = 0;
    for ( int y = 0; y < a->height; ++y )
    {
        for ( int x = 0; x < a->width; ++x )
        {
            count += fixture_differs( a, b, x, y ) ? 1 : 0;
        }
    }
    return count;
}

/// Position of a point in the picture, in pixels from the upper left corner; for cameras whose up is y.
typedef struct fixture_place
{
    double x, y;
} fixture_place;

static inline fixture_place fixture_project( const render_camera* camera, const render_options* options, wisp_vec3 p )
{
    double f[3] = { (double)camera->target.x - (double)camera->eye.x,
                    (double)camera->target.y - (double)camera->eye.y,
                    (double)camera->target.z - (double)camera->eye.z };
    double length = sqrt( f[0] * f[0] + f[1] * f[1] + f[2] * f[2] ), level = sqrt( f[0] * f[0] + f[2] * f[2] );
    double right[3] = { -f[2] / level, 0.0, f[0] / level };
    double up[3] = { right[1] * f[2] - right[2] * f[1], right[2] * f[0] - right[0] * f[2],
                     right[0] * f[1] - right[1] * f[0] };
    double d[3] = { (double)p.x - (double)camera->eye.x, (double)p.y - (double)camera->eye.y,
                    (double)p.z - (double)camera->eye.z };
    double depth = 0.0, x = 0.0, y = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        depth += d[k] * f[k] / length;
        x += d[k] * right[k];
        y += d[k] * up[k] / length;
    }
    double scale = 0.5 * options->height / ( tan( (double)camera->fov_degrees * 3.14159265358979 / 360.0 ) * depth );
    return ( fixture_place ){ 0.5 * options->width + scale * x, 0.5 * options->height - scale * y };
}
