#include "collision_features.h"

#include "bench_world.h"
#include "cells.h"
#include "mesh.h"
#include "surface_implementation.h"

#include "cloth/cloth.h"
#include "collision/collision.h"
#include "wisp/fabric.h"
#include "wisp/module/components.h"
#include "wisp/module/shapes.h"

#include <math.h>
#include <stdio.h>

enum
{
    SIDE = 41,  // vertices
    STEPS = 60, // of 1/60 s
    SUBSTEPS = 10,
    SAMPLES = 8, // per side of a triangle
};

static const float CELL = 0.02f, THICKNESS = 0.005f;

// A body under a sheet that falls on it.
typedef struct features_body
{
    const char* name;
    wisp_collider_kind kind;
    wisp_shape_kind shape;
    float radius, half_length;
    wisp_vec3 half_extent;
    wisp_transform pose;
} features_body;

static const features_body BODIES[] = {
    { "ball, 0.2 m",
      WISP_COLLIDER_SPHERE,
      WISP_SHAPE_SPHERE,
      0.2f,
      0.0f,
      { 0.0f, 0.0f, 0.0f },
      { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.003f, -0.21f, 0.004f } } },
    { "box, 0.3 x 0.2 x 0.25 m",
      WISP_COLLIDER_BOX,
      WISP_SHAPE_BOX,
      0.0f,
      0.0f,
      { 0.15f, 0.1f, 0.125f },
      { { 0.0f, 0.149438132f, 0.0f, 0.988771077f }, { 0.003f, -0.11f, 0.004f } } },
    { "needle, 2 mm thick",
      WISP_COLLIDER_CAPSULE,
      WISP_SHAPE_CAPSULE,
      0.001f,
      0.6f,
      { 0.0f, 0.0f, 0.0f },
      { { -0.13007f, 0.13007f, -0.69504f, 0.69504f }, { 0.003f, -0.01f, 0.004f } } },
};

typedef struct features_run
{
    wisp_world* world;
    wisp_entity cloth;
    wisp_mesh mesh;
    double ms, distance; // m, the least of all points of triangles at the end
    uint64_t hash;
} features_run;

static wisp_status add_sheet( features_run* run, wisp_collision_features features, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_ALTERNATING );
    generator.columns = generator.rows = SIDE;
    generator.spacing = CELL;
    wisp_fabric* fabric;
    wisp_status status = wisp_mesh_generate( &generator, &run->mesh, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = surface_cook( &run->mesh, wisp_default_fabric_def(), &fabric, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_surface_def surface = wisp_default_surface_def();
    surface.fabric = fabric;
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = THICKNESS;
    collision.features = features;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    status = wisp_add_surface( run->world, &surface, &run->cloth );
    wisp_fabric_release( fabric );
    status = status ? status : wisp_set_cloth( run->world, run->cloth, &cloth );
    status = status ? status : wisp_set_damping( run->world, run->cloth, 2.0f );
    status = status ? status : wisp_set_collision( run->world, run->cloth, &collision );
    status = status ? status : wisp_request( run->world, run->cloth, WISP_SURFACE_POINTS );
    return status ? bench_world_fail( run->world, status, error ) : WISP_OK;
}

static wisp_status add_body( features_run* run, const features_body* body, wisp_error* error )
{
    wisp_collider_def def = wisp_default_collider_def();
    wisp_entity entity;
    def.kind = body->kind;
    def.pose = body->pose;
    def.radius = body->radius > 0.0f ? body->radius : def.radius;
    def.half_length = body->half_length;
    def.half_extent = body->half_extent.x > 0.0f ? body->half_extent : def.half_extent;
    const wisp_status status = wisp_add_collider( run->world, &def, &entity );
    return status ? bench_world_fail( run->world, status, error ) : WISP_OK;
}

// Sample all triangles: the cells are small against all bodies but the needle, whose error is below a fifth of a cell's eighth.
static void measure_distance( features_run* run, const features_body* body, const wisp_vec3* points )
{
    const wisp_shape shape = { .kind = body->shape,
                               .radius = body->radius,
                               .half_length = body->half_length,
                               .half_extent = body->half_extent };
    run->distance = INFINITY;
    for ( int t = 0; t < run->mesh.triangle_count; ++t )
    {
        const int32_t* c = run->mesh.triangles + 3 * (size_t)t;
        const wisp_vec3 a = points[c[0]], b = points[c[1]], d = points[c[2]];
        for ( int i = 0; i <= SAMPLES; ++i )
        {
            for ( int k = 0; k <= SAMPLES - i; ++k )
            {
                const float u = (float)i / SAMPLES, v = (float)k / SAMPLES, w = 1.0f - u - v;
                const wisp_vec3 p = { w * a.x + u * b.x + v * d.x, w * a.y + u * b.y + v * d.y,
                                      w * a.z + u * b.z + v * d.z };
                wisp_surface_point s;
                wisp_shape_closest( &shape, wisp_transform_to_local( body->pose, p ), &s );
                run->distance = fmin( run->distance, (double)s.distance );
            }
        }
    }
}

static wisp_status run_features( const features_body* body, wisp_collision_features features, features_run* run,
                                 wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_cloth_module, &wisp_collision_module };
    *run = ( features_run ){ 0 };
    const bench_world_def def = { modules, WISP_COUNT( modules ), .substeps = SUBSTEPS, .iterations = 1 };
    wisp_status status = bench_world_create( &def, &run->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_body( run, body, error );
    status = status ? status : add_sheet( run, features, error );
    const double begin = wisp_clock_seconds();
    int steps = 0, halted_at = 0;
    for ( int n = 0; n < STEPS && status == WISP_OK; ++n )
    {
        status = bench_world_step( run->world, run->cloth, 1.0f / 60.0f, &steps, &halted_at, error );
    }
    run->ms = 1e3 * ( wisp_clock_seconds() - begin ) / STEPS;
    const wisp_vec3* points;
    status = status ? status
                    : bench_world_points( run->world, run->cloth, WISP_SURFACE_POINTS, run->mesh.vertex_count,
                                          &points, error );
    if ( status == WISP_OK )
    {
        measure_distance( run, body, points );
        status = bench_world_hash( run->world, run->cloth, WISP_SURFACE_POINTS, &run->hash, error );
    }
    wisp_mesh_release( &run->mesh );
    wisp_world_destroy( run->world );
    return status;
}

static void add_row( const features_body* body, wisp_collision_features features, const features_run* run, int table,
                     results* out )
{
    cells c = { .count = 0 };
    cells_put( &c, "%s", body->name );
    cells_put( &c, "%s", features == WISP_COLLISION_ALL ? "all" : "vertices" );
    cells_put_number( &c, run->ms, 3 );
    cells_put_number( &c, 1e3 * run->distance, 3 );
    cells_put_number( &c, 1e3 * fmax( 0.0, (double)THICKNESS - run->distance ), 3 );
    cells_put_hash( &c, run->hash );
    cells_end_row( &c, table, out );
}

wisp_status collision_features_table( const bench_options* options, results* out, wisp_error* error )
{
    static const char* const names[] = { "body", "features", "ms per step", "distance mm", "penetration mm", "hash" };
    char title[160];
    snprintf( title, sizeof( title ),
              "Edges and triangles: a sheet of %d vertices, cells of 2 cm, thickness 5 mm, falls on a body, %d steps "
              "of %d substeps, "
              "1 worker",
              SIDE * SIDE, STEPS, SUBSTEPS );
    cells header = { .count = 0 };
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        cells_put( &header, "%s", names[i] );
    }
    const int table = cells_begin_table( &header, title, out );
    wisp_status status = WISP_OK;
    for ( int i = 0; i < 2 * WISP_COUNT( BODIES ) && status == WISP_OK; ++i )
    {
        const features_body* body = BODIES + i / 2;
        const wisp_collision_features features = i % 2 == 0 ? WISP_COLLISION_VERTICES : WISP_COLLISION_ALL;
        features_run run;
        bench_progress( options, 0.8 + 0.03 * i, "edges and triangles" );
        status = run_features( body, features, &run, error );
        if ( status == WISP_OK )
        {
            add_row( body, features, &run, table, out );
        }
        if ( status == WISP_OK && features == WISP_COLLISION_ALL && run.distance < 0.9 * (double)THICKNESS - 1e-4 )
        {
            results_add_failure( out, "A sheet whose edges and triangles collide comes within %.3f mm of a %s.",
                                 1e3 * run.distance, body->name );
        }
    }
    results_add_note(
        out, "distance: the least of sampled points of all triangles at the end; penetration: what is missing of the "
             "thickness. Vertices alone leave edges of a box in the sheet, and a needle passes through it." );
    return status;
}
