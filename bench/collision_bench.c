// Case `collision`: what a mesh body costs to search, rigid by a tree of Embree's if there is one, and deforming by the engine's own,
// and that both find the same.
#include "bench_options.h"

#include "cells.h"
#include "mesh.h"
#include "stats.h"

#include "collision_features.h"
#include "wisp/module/collision_mesh.h"
#include "wisp/module/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    QUESTIONS = 4096,    // of each kind
    FAR_QUESTIONS = 512, // of those without a limit of distance
    ROUNDS_MIN = 3,
    ROUNDS_MAX = 200,
};

// ---- searches ----

typedef struct search_kind
{
    const char* name;
    bool deforms;
} search_kind;

static const search_kind searches[] = { { "rigid", false }, { "deforms", true } };

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
        .deforms = kind->deforms,
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

static bool are_same( const answers* a, const answers* b )
{
    return memcmp( a->near, b->near, sizeof( a->near ) ) == 0 && memcmp( a->far, b->far, sizeof( a->far ) ) == 0 &&
           memcmp( a->steps, b->steps, sizeof( a->steps ) ) == 0 &&
           memcmp( a->across, b->across, sizeof( a->across ) ) == 0;
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
    if ( status == WISP_OK && def.deforms )
    {
        status = wisp_collision_mesh_update( e->tree, NULL, mesh->points, NULL, error );
    }
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
    cells_put_number( &c, e->kind->deforms ? 1e3 * median[UPDATE] : (double)NAN, 2 );
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
    answers found[WISP_COUNT( searches )];
    implementation implementations[WISP_COUNT( searches )];
} contest;

static wisp_status run_contest( contest* c, int level, double seconds, int table, results* out, wisp_error* error )
{
    const double edge_of_level_0 = 1.0515; // of an icosahedron in the unit sphere; each level halves it
    wisp_status status = make_body( level, &c->mesh, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    make_questions( &c->mesh, (float)ldexp( edge_of_level_0, -level ), &c->queried );
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
    bool agree = status == WISP_OK && are_same( c->found, c->found + 1 );
    for ( int k = 0; k < WISP_COUNT( searches ); ++k )
    {
        if ( status == WISP_OK )
        {
            add_implementation_row( c->implementations + k, &c->mesh, agree, table, out );
        }
        wisp_collision_mesh_release( c->implementations[k].tree );
    }
    if ( status == WISP_OK && !agree )
    {
        results_add_failure( out, "At %d triangles a rigid mesh and one that deforms answer differently.",
                             c->mesh.triangle_count );
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
        bench_progress( options, 0.3 * i, "bodies of triangles" );
        status = run_contest( c, levels[i], 0.1 * bench_seconds( options ), table, out, error );
    }
    free( c );
    results_add_note( out, "near: within an edge length of the surface, searched as far; far: anywhere, without "
                           "limit; step: half an edge near the surface; path: from outside to the centre. update: "
                           "all points move, and the tree is refitted." );
    results_add_note( out, "visited: triangles per near query. same: both trees agree bit for bit." );
    return status;
}

wisp_status collision_bench( const bench_options* options, results* out, wisp_error* error )
{
    const wisp_status status = run_contests( options, out, error );
    return status ? status : collision_features_table( options, out, error );
}
