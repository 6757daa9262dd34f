// Case `collision`: what a mesh body costs when it is searched by a tree of Embree's and by voxels, and that both
// find what brute force finds. A single voxel around the whole mesh is brute force: it tests every triangle.
#include "bench_options.h"

#include "bench_world.h"
#include "cells.h"
#include "mesh.h"
#include "stats.h"
#include "surface_implementation.h"

#include "cloth/cloth.h"
#include "collision/collision.h"
#include "collision_features.h"
#include "wisp/fabric.h"
#include "wisp/module/collision_mesh.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"
#include "wisp/module/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    QUESTIONS = 4096,    // of each kind
    FAR_QUESTIONS = 512, // of those without a limit of distance
    SAMPLE = 64,         // of them, also answered by brute force
    ROUNDS_MIN = 3,
    ROUNDS_MAX = 200,
    CLOTH_SIDE = 17,
    CLOTH_STEPS = 20,
};

// ---- searches ----

typedef struct search_kind
{
    const char* name;
    wisp_mesh_search search;
    float voxel_size; // m
} search_kind;

static const search_kind searches[] = {
    { "tree", WISP_MESH_SEARCH_TREE, 0.0f },
    { "voxels", WISP_MESH_SEARCH_VOXELS, 0.0f },
};
static const search_kind brute_force = { "brute force", WISP_MESH_SEARCH_VOXELS, 1e6f };

// A ball of 1 m with bumps, of 20 4^level triangles.
static wisp_status make_body( int level, wisp_mesh* out, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_ICOSPHERE );
    generator.level = level;
    generator.radius = 1.0f;
    wisp_status status = wisp_mesh_generate( &generator, out, error );
    for ( int v = 0; status == WISP_OK && v < out->vertex_count; ++v )
    {
        wisp_vec3* p = out->points + v;
        float r = 1.0f + 0.1f * sinf( 9.0f * p->x ) * sinf( 8.0f * p->y ) * cosf( 7.0f * p->z );
        *p = ( wisp_vec3 ){ r * p->x, r * p->y, r * p->z };
    }
    return status;
}

static wisp_collision_mesh_def search_def( const wisp_mesh* mesh, const search_kind* kind )
{
    return ( wisp_collision_mesh_def ){
        .points = mesh->points,
        .triangles = mesh->triangles,
        .point_count = mesh->vertex_count,
        .triangle_count = mesh->triangle_count,
        .deforms = true,
        .search = kind->search,
        .voxel_size = kind->voxel_size,
    };
}

// ---- queries ----

typedef struct questions
{
    wisp_mesh_query near[QUESTIONS];    // particles of a cloth on the body: less than an edge away, limit of an edge
    wisp_mesh_query far[FAR_QUESTIONS]; // anywhere around and inside, without a limit
    wisp_mesh_path steps[QUESTIONS];    // of a particle close to the surface
    wisp_mesh_path across[QUESTIONS];   // from outside to the middle
} questions;

typedef struct answers
{
    wisp_mesh_nearest near[QUESTIONS], far[FAR_QUESTIONS];
    wisp_mesh_hit steps[QUESTIONS], across[QUESTIONS];
    wisp_collision_mesh_query_stats work; // of the near ones
} answers;

static wisp_vec3 shift( wisp_vec3 p, float size, int i, uint64_t stream )
{
    float by[3];
    wisp_random_key key = wisp_random_make_key( 5, stream, 0 );
    for ( uint32_t k = 0; k < 3; ++k )
    {
        by[k] = size * ( 2.0f * wisp_random_unit_float( key, (uint32_t)i, k, 0 ) - 1.0f );
    }
    return ( wisp_vec3 ){ p.x + by[0], p.y + by[1], p.z + by[2] };
}

static void make_questions( const wisp_mesh* mesh, float edge, questions* q )
{
    const wisp_vec3 middle = { 0.0f, 0.0f, 0.0f };
    for ( int i = 0; i < QUESTIONS; ++i )
    {
        // neighbours one after another, like the particles of a cloth
        int v = (int)( (int64_t)mesh->vertex_count * i / QUESTIONS );
        wisp_vec3 on = mesh->points[v], beside = shift( on, 0.5f * edge, i, 0 );
        q->near[i] = ( wisp_mesh_query ){ .point = beside, .radius = edge };
        q->far[i % FAR_QUESTIONS] = ( wisp_mesh_query ){ .point = shift( middle, 1.5f, i, 1 ), .radius = INFINITY };
        q->steps[i] = ( wisp_mesh_path ){ .from = beside, .to = shift( beside, 0.5f * edge, i, 2 ) };
        q->across[i] = ( wisp_mesh_path ){ .from = { 2.0f * on.x, 2.0f * on.y, 2.0f * on.z },
                                           .to = shift( middle, 0.1f, i, 3 ) };
    }
}

static void ask( wisp_collision_mesh* tree, const questions* q, int count, answers* a )
{
    wisp_collision_mesh_closest( tree, q->near, count, a->near, &a->work );
    wisp_collision_mesh_closest( tree, q->far, count, a->far, NULL );
    wisp_collision_mesh_cast( tree, q->steps, count, a->steps, NULL );
    wisp_collision_mesh_cast( tree, q->across, count, a->across, NULL );
}

static bool are_same( const answers* a, const answers* b, int count )
{
    size_t far = (size_t)( count < FAR_QUESTIONS ? count : FAR_QUESTIONS ) * sizeof( wisp_mesh_nearest );
    size_t nearest = (size_t)count * sizeof( wisp_mesh_nearest ), hits = (size_t)count * sizeof( wisp_mesh_hit );
    return memcmp( a->near, b->near, nearest ) == 0 && memcmp( a->far, b->far, far ) == 0 &&
           memcmp( a->steps, b->steps, hits ) == 0 && memcmp( a->across, b->across, hits ) == 0;
}

// ---- one size ----

enum
{
    BUILD,
    UPDATE,
    NEAR,
    FAR,
    STEPS,
    ACROSS,
    TIMES,
};

static const struct
{
    const char* name;
    int questions;
} timed[TIMES] = {
    { "build", 1 },           { "update", 1 },       { "near", QUESTIONS },
    { "far", FAR_QUESTIONS }, { "step", QUESTIONS }, { "path", QUESTIONS },
};

typedef struct implementation
{
    const search_kind* kind;
    wisp_collision_mesh* tree;
    answers* found;
    double samples[TIMES][ROUNDS_MAX]; // s
    int rounds;
} implementation;

// Build it again, move it, and time all queries.
static wisp_status run_round( implementation* e, const wisp_mesh* mesh, const questions* q, wisp_error* error )
{
    double at[TIMES + 1];
    wisp_collision_mesh_def def = search_def( mesh, e->kind );
    wisp_collision_mesh_release( e->tree );
    e->found->work = ( wisp_collision_mesh_query_stats ){ 0 };
    at[BUILD] = wisp_clock_seconds();
    wisp_status status = wisp_collision_mesh_create( &def, NULL, &e->tree, error );
    at[UPDATE] = wisp_clock_seconds();
    status = status == WISP_OK ? wisp_collision_mesh_update( e->tree, NULL, mesh->points, NULL, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    at[NEAR] = wisp_clock_seconds();
    wisp_collision_mesh_closest( e->tree, q->near, QUESTIONS, e->found->near, &e->found->work );
    at[FAR] = wisp_clock_seconds();
    wisp_collision_mesh_closest( e->tree, q->far, FAR_QUESTIONS, e->found->far, NULL );
    at[STEPS] = wisp_clock_seconds();
    wisp_collision_mesh_cast( e->tree, q->steps, QUESTIONS, e->found->steps, NULL );
    at[ACROSS] = wisp_clock_seconds();
    wisp_collision_mesh_cast( e->tree, q->across, QUESTIONS, e->found->across, NULL );
    at[TIMES] = wisp_clock_seconds();
    for ( int k = 0; k < TIMES; ++k )
    {
        e->samples[k][e->rounds] = at[k + 1] - at[k];
    }
    e->rounds += 1;
    return WISP_OK;
}

static int count_found( const answers* a )
{
    int count = 0;
    for ( int i = 0; i < QUESTIONS; ++i )
    {
        count += a->near[i].triangle >= 0 ? 1 : 0;
    }
    return count;
}

static void add_implementation_row( implementation* e, const wisp_mesh* mesh, bool same, int table, results* out )
{
    double median[TIMES];
    results_row* row = results_add_row( out, "collision", e->kind->name );
    for ( int k = 0; k < TIMES; ++k )
    {
        stats_summary summary = stats_summarise( e->samples[k], e->rounds );
        median[k] = summary.median;
        double scale = 1e3 / timed[k].questions;
        if ( row != NULL )
        {
            results_put( &row->stages, timed[k].name, scale * summary.median );
        }
        if ( row != NULL && k == NEAR )
        {
            stats_scale( &summary, scale );
            results_put_times( row, &summary );
        }
    }
    double bytes = (double)wisp_collision_mesh_bytes( e->tree );
    if ( row != NULL )
    {
        results_put( &row->size, "triangles", mesh->triangle_count );
        results_put( &row->size, "bytes", bytes );
        row->workers = 1;
        row->steps = e->rounds;
    }
    cells c = { .count = 0 };
    cells_put( &c, "%d", mesh->triangle_count );
    cells_put( &c, "%s", e->kind->name );
    cells_put_number( &c, 1e3 * median[BUILD], 2 );
    cells_put_number( &c, 1e3 * median[UPDATE], 2 );
    cells_put_number( &c, bytes / mesh->triangle_count, 0 );
    for ( int k = NEAR; k < TIMES; ++k )
    {
        cells_put_number( &c, 1e9 * median[k] / timed[k].questions, 0 );
    }
    cells_put_number( &c, (double)e->found->work.tested / QUESTIONS, 1 );
    cells_put( &c, "%d", count_found( e->found ) );
    cells_put( &c, "%s", same ? "yes" : "no" );
    cells_end_row( &c, table, out );
}

typedef struct contest
{
    wisp_mesh mesh;
    questions queried;
    answers reference;
    answers found[WISP_COUNT( searches )];
    implementation implementations[WISP_COUNT( searches )];
} contest;

static wisp_status ask_brute_force( contest* c, wisp_error* error )
{
    wisp_collision_mesh* all;
    wisp_collision_mesh_def def = search_def( &c->mesh, &brute_force );
    wisp_status status = wisp_collision_mesh_create( &def, NULL, &all, error );
    if ( status == WISP_OK )
    {
        ask( all, &c->queried, SAMPLE, &c->reference );
        wisp_collision_mesh_release( all );
    }
    return status;
}

static wisp_status run_contest( contest* c, int level, double seconds, int table, results* out, wisp_error* error )
{
    const double edge_of_level_0 = 1.0515; // of an icosahedron in the unit sphere; each level halves it
    wisp_status status = make_body( level, &c->mesh, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    make_questions( &c->mesh, (float)ldexp( edge_of_level_0, -level ), &c->queried );
    status = ask_brute_force( c, error );
    double end = wisp_clock_seconds() + seconds;
    for ( int k = 0; k < WISP_COUNT( searches ); ++k )
    {
        c->implementations[k] = ( implementation ){ .kind = searches + k, .found = c->found + k };
    }
    for ( int round = 0; round < ROUNDS_MAX && ( round < ROUNDS_MIN || wisp_clock_seconds() < end ); ++round )
    {
        for ( int k = 0; k < WISP_COUNT( searches ) && status == WISP_OK; ++k )
        {
            status = run_round( c->implementations + k, &c->mesh, &c->queried, error );
        }
    }
    bool agree = status == WISP_OK && are_same( c->found, c->found + 1, QUESTIONS );
    for ( int k = 0; k < WISP_COUNT( searches ); ++k )
    {
        bool same = status == WISP_OK && agree && are_same( c->found + k, &c->reference, SAMPLE );
        if ( status == WISP_OK )
        {
            add_implementation_row( c->implementations + k, &c->mesh, same, table, out );
        }
        if ( status == WISP_OK && !same )
        {
            results_add_failure( out, "At %d triangles the answers of the %s differ from the others.",
                                 c->mesh.triangle_count, searches[k].name );
        }
        wisp_collision_mesh_release( c->implementations[k].tree );
    }
    wisp_mesh_release( &c->mesh );
    return status;
}

static wisp_status run_contests( const bench_options* options, results* out, wisp_error* error )
{
    static const int levels[] = { 4, 5, 6 };
    char title[160];
    snprintf( title, sizeof( title ),
              "Mesh body searched for %d points and %d paths: ns per query, medians, 1 thread",
              QUESTIONS + FAR_QUESTIONS, 2 * QUESTIONS );
    cells header = { .count = 0 };
    static const char* const names[] = {
        "triangles", "search", "build ms", "update ms", "bytes per triangle", "near",
        "far",       "step",   "path",     "visited",   "near found",         "same"
    };
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        cells_put( &header, "%s", names[i] );
    }
    int table = cells_begin_table( &header, title, out );
    contest* c = calloc( 1, sizeof( contest ) );
    if ( c == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the questions to a body" );
    }
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( levels ) && status == WISP_OK; ++i )
    {
        bench_progress( options, 0.2 * i, "bodies of triangles" );
        status = run_contest( c, levels[i], 0.07 * bench_seconds( options ), table, out, error );
    }
    free( c );
    results_add_note( out, "near: within an edge length of the surface, searched as far; far: anywhere, without "
                           "limit; step: half an edge near the surface; path: from outside to the centre. update: "
                           "all points move; the tree is refitted, voxels are listed again." );
    results_add_note( out,
                      "visited: triangles per near query. same: tree and voxels agree bit for bit, and with brute "
                      "force for %d queries of each kind.",
                      SAMPLE );
    return status;
}

// ---- cloth on a body ----

typedef struct cloth_run
{
    wisp_world* world;
    wisp_entity cloth;
    int64_t contacts; // of all steps together
    float penetration;
    double ms;
    uint64_t hash;
} cloth_run;

static wisp_status add_cloth( cloth_run* run, wisp_fabric* fabric )
{
    wisp_surface_def surface = wisp_default_surface_def();
    wisp_collision_def collision = wisp_default_collision_def();
    wisp_cloth_def cloth = wisp_default_cloth_def();
    surface.fabric = fabric;
    wisp_status status = wisp_add_surface( run->world, &surface, &run->cloth );
    status = status ? status : wisp_set_cloth( run->world, run->cloth, &cloth );
    status = status ? status : wisp_set_collision( run->world, run->cloth, &collision );
    status = status ? status : wisp_request_collision_stats( run->world, run->cloth, true );
    return status ? status : wisp_request( run->world, run->cloth, WISP_SURFACE_POINTS );
}

static wisp_status add_body( cloth_run* run, const wisp_mesh* mesh, const search_kind* kind )
{
    wisp_entity body;
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_MESH;
    def.points = mesh->points;
    def.triangles = mesh->triangles;
    def.point_count = mesh->vertex_count;
    def.triangle_count = mesh->triangle_count;
    def.search = kind->search;
    def.voxel_size = kind->voxel_size;
    return wisp_add_collider( run->world, &def, &body );
}

static wisp_status step_cloth( cloth_run* run )
{
    wisp_status status = WISP_OK;
    double begin = wisp_clock_seconds();
    for ( int n = 0; n < CLOTH_STEPS && status == WISP_OK; ++n )
    {
        wisp_collision_stats stats = { 0 };
        status = wisp_world_step( run->world, 1.0f / 60.0f );
        status = status ? status : wisp_read_collision_stats( run->world, run->cloth, &stats );
        run->contacts += stats.contacts;
        run->penetration = stats.penetration;
    }
    run->ms = 1e3 * ( wisp_clock_seconds() - begin ) / CLOTH_STEPS;
    return status ? status : wisp_world_hash_column( run->world, run->cloth, WISP_SURFACE_POINTS, &run->hash );
}

static wisp_status run_cloth( const wisp_mesh* body, wisp_fabric* fabric, const search_kind* kind, cloth_run* run,
                              wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_cloth_module, &wisp_collision_module };
    *run = ( cloth_run ){ 0 };
    const bench_world_def def = { modules, WISP_COUNT( modules ), .substeps = 2, .iterations = 2 };
    wisp_status status = bench_world_create( &def, &run->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_body( run, body, kind );
    status = status ? status : add_cloth( run, fabric );
    status = status ? status : step_cloth( run );
    if ( status != WISP_OK )
    {
        bench_world_fail( run->world, status, error );
    }
    wisp_world_destroy( run->world );
    return status;
}

static wisp_status cook_cloth( wisp_fabric** out, wisp_error* error )
{
    wisp_mesh mesh;
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_ALTERNATING );
    generator.columns = generator.rows = CLOTH_SIDE;
    generator.spacing = 0.09f;
    wisp_status status = wisp_mesh_generate( &generator, &mesh, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        mesh.points[v].y += 1.12f; // just above the body's highest bump
    }
    status = surface_cook( &mesh, wisp_default_fabric_def(), out, error );
    wisp_mesh_release( &mesh );
    return status;
}

static void add_cloth_row( const search_kind* kind, const cloth_run* run, bool same, int table, results* out )
{
    cells c = { .count = 0 };
    cells_put( &c, "%s", kind->name );
    cells_put_number( &c, run->ms, 3 );
    cells_put( &c, "%lld", (long long)run->contacts );
    cells_put_number( &c, 1e3 * (double)run->penetration, 4 );
    cells_put_hash( &c, run->hash );
    cells_put( &c, "%s", same ? "yes" : "no" );
    cells_end_row( &c, table, out );
}

static wisp_status compare_cloth( const wisp_mesh* body, wisp_fabric* fabric, results* out, wisp_error* error )
{
    char title[160];
    snprintf( title, sizeof( title ),
              "Cloth of %d vertices on a body of %d triangles, %d steps of 2 substeps, 1 worker",
              CLOTH_SIDE * CLOTH_SIDE, body->triangle_count, CLOTH_STEPS );
    cells header = { .count = 0 };
    static const char* const names[] = { "search", "ms per step", "contacts", "max penetration mm", "hash", "same" };
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        cells_put( &header, "%s", names[i] );
    }
    int table = cells_begin_table( &header, title, out );
    cloth_run reference, run;
    wisp_status status = run_cloth( body, fabric, &brute_force, &reference, error );
    for ( int k = 0; k < WISP_COUNT( searches ) && status == WISP_OK; ++k )
    {
        status = run_cloth( body, fabric, searches + k, &run, error );
        bool same = run.contacts == reference.contacts && run.hash == reference.hash && run.contacts > 0;
        if ( status == WISP_OK )
        {
            add_cloth_row( searches + k, &run, same, table, out );
        }
        if ( status == WISP_OK && !same )
        {
            results_add_failure( out, "Cloth on a body searched by %s has other contacts than by brute force.",
                                 searches[k].name );
        }
    }
    if ( status == WISP_OK )
    {
        add_cloth_row( &brute_force, &reference, true, table, out );
    }
    return status;
}

wisp_status collision_bench( const bench_options* options, results* out, wisp_error* error )
{
    wisp_status status = run_contests( options, out, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    bench_progress( options, 0.7, "cloth on a body" );
    wisp_mesh body;
    wisp_fabric* fabric;
    status = make_body( 4, &body, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = cook_cloth( &fabric, error );
    if ( status == WISP_OK )
    {
        status = compare_cloth( &body, fabric, out, error );
        wisp_fabric_release( fabric );
    }
    wisp_mesh_release( &body );
    return status ? status : collision_features_table( options, out, error );
}
