// Bad topology. The doctor names the element; the engine cooks valid parts, rejects the others with a message, and
// accepted ones stay finite.
#include "stability_cloth.h"
#include "stability_strands.h"

#include "cloth/cloth.h"
#include "wisp/module/components.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SIDE 6
#define EXTRA 4 // vertices and triangles that a defect may add

enum
{
    DUPLICATE,
    NO_AREA,
    NO_LENGTH,
    ISOLATED,
    THREE_AT_AN_EDGE,
    TWO_FANS,
    NAMED_TWICE,
};

static void add_triangle( wisp_mesh* mesh, int a, int b, int c )
{
    int32_t* t = mesh->triangles + 3 * (size_t)mesh->triangle_count++;
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

static int add_point( wisp_mesh* mesh, float x, float y, float z )
{
    mesh->points[mesh->vertex_count] = ( wisp_vec3 ){ x, y, z };
    return mesh->vertex_count++;
}

static void spoil( wisp_mesh* mesh, int ailment )
{
    const int last = mesh->vertex_count - 1;
    switch ( ailment )
    {
        case DUPLICATE:
            add_triangle( mesh, mesh->triangles[0], mesh->triangles[1], mesh->triangles[2] );
            break;
        case NO_AREA: // a vertex in the middle of the last edge of the sheet
            add_triangle( mesh, last - 1, last,
                          add_point( mesh, 0.5f * ( mesh->points[last].x + mesh->points[last - 1].x ),
                                     mesh->points[last].y, 0.0f ) );
            break;
        case NO_LENGTH: // two vertices at one position
            mesh->points[last] = mesh->points[last - 1];
            break;
        case ISOLATED:
            add_point( mesh, 0.0f, 0.1f, 0.0f );
            break;
        case THREE_AT_AN_EDGE:
            add_triangle( mesh, 1, 2, add_point( mesh, mesh->points[1].x, mesh->points[1].y, 0.05f ) );
            add_triangle( mesh, 1, 2, add_point( mesh, mesh->points[1].x, mesh->points[1].y, -0.05f ) );
            break;
        case TWO_FANS: // a second sheet that hangs at one vertex
        {
            const wisp_vec3 p = mesh->points[last];
            const int a = add_point( mesh, p.x + 0.05f, p.y - 0.05f, 0.0f );
            add_triangle( mesh, last, a, add_point( mesh, p.x, p.y - 0.05f, 0.0f ) );
            break;
        }
        default:
            add_triangle( mesh, 0, 1, 1 );
            break;
    }
}

// The defects found, of the planted kind.
static int found( const wisp_mesh_diagnostics* r, int ailment )
{
    const int counts[] = { r->duplicates.count,   r->degenerates.count,       r->degenerates.count,
                           r->unreferenced.count, r->nonmanifold_edges.count, r->nonmanifold_vertices.count,
                           r->degenerates.count };
    return counts[ailment];
}

static wisp_status make_bad_mesh( int ailment, wisp_mesh* out, wisp_error* error )
{
    wisp_mesh sound;
    wisp_status status = stability_hanging_mesh( SIDE, 0.05f, &sound, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    *out = ( wisp_mesh ){
        .points = calloc( (size_t)sound.vertex_count + EXTRA, sizeof( wisp_vec3 ) ),
        .triangles = calloc( (size_t)sound.triangle_count + EXTRA, 3 * sizeof( int32_t ) ),
        .vertex_count = sound.vertex_count,
        .triangle_count = sound.triangle_count,
    };
    if ( out->points == NULL || out->triangles == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for a mesh" );
        free( out->points );
        free( out->triangles );
    }
    else
    {
        memcpy( out->points, sound.points, (size_t)sound.vertex_count * sizeof( wisp_vec3 ) );
        memcpy( out->triangles, sound.triangles, (size_t)sound.triangle_count * 3 * sizeof( int32_t ) );
        spoil( out, ailment );
    }
    wisp_mesh_release( &sound );
    return status;
}

static wisp_status enter( int ailment, int workers, stability_surface* s, wisp_error* error )
{
    static const stability_axes usual = { STABILITY_START_REST, STABILITY_FRAME, 1.0f, 0.0f, 1.0f };
    const int32_t pins[2] = { 0, SIDE - 1 };
    surface_generator generator = surface_default_generator( &wisp_cloth_module, NULL );
    generator.pins = pins;
    generator.pin_count = 2;
    generator.gravity = ( wisp_vec3 ){ 0.0f, -STABILITY_GRAVITY, 0.0f };
    generator.damping = 4.0f;
    generator.substeps = 10;
    generator.workers = workers;
    wisp_fabric_def def = wisp_default_fabric_def();
    def.hinges = true;
    wisp_status status = make_bad_mesh( ailment, &s->mesh, error );
    if ( status == WISP_OK )
    {
        status = stability_surface_enter( s, &def, generator, &usual, error );
        s->implementation.generator.pins = NULL;
    }
    if ( status == WISP_OK )
    {
        wisp_cloth_def cloth = wisp_default_cloth_def();
        cloth.bending = WISP_CLOTH_BENDING_DIHEDRAL;
        status = wisp_set_cloth( s->implementation.world, s->implementation.entity, &cloth );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( s->implementation.world, status, error );
    }
    return status;
}

// Strain of an edge without length is NaN and has no limit: such cloth must stay finite and come to rest.
static wisp_status observe( void* context, int frame, stability_observation* out, wisp_error* error )
{
    const wisp_status status = stability_surface_observe( context, frame, out, error );
    out->strain = 0.0;
    out->energy = 0.0;
    return status;
}

static wisp_status run( int ailment, int workers, stability_outcome* out, wisp_error* error )
{
    static const stability_axes usual = { STABILITY_START_REST, STABILITY_FRAME, 1.0f, 0.0f, 1.0f };
    stability_surface* s = calloc( 1, sizeof( *s ) );
    if ( s == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a cell" );
    }
    const bool must_refuse = ailment == NAMED_TWICE;
    const wisp_status entered = enter( ailment, workers, s, error );
    wisp_mesh_diagnostics report = { 0 };
    wisp_status status = s->mesh.points != NULL ? wisp_mesh_examine( &s->mesh, &report, error ) : entered;
    const int named = found( &report, ailment );
    *out = ( stability_outcome ){ .is_refused = entered == WISP_BAD_INPUT };
    if ( status != WISP_OK || entered != WISP_OK )
    {
        stability_surface_close( s );
        if ( status == WISP_OK && out->is_refused )
        {
            stability_claim( out, must_refuse && named > 0, "%.100s", error->message );
            return WISP_OK;
        }
        return status != WISP_OK ? status : entered;
    }
    stability_trial trial = stability_surface_trial( s, &usual );
    trial.observe = observe;
    status = stability_run( &trial, out, error );
    stability_claim( out, named > 0 && must_refuse == false, "the doctor names %d", named );
    return status;
}

// ---- strands ----

// Neither strain nor energy is defined without lengths and masses.
static wisp_status observe_strands( void* context, int frame, stability_observation* out, wisp_error* error )
{
    const wisp_status status = stability_strands_observe( context, frame, out, error );
    out->is_finite = isfinite( out->speed );
    out->strain = 0.0;
    out->energy = 0.0;
    return status;
}

// Segments without length: in the middle, and of a strand that is a point. Each should get a thousandth of the mean
// length.
static wisp_status run_strands( int way, int workers, stability_outcome* out, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_strands_module };
    static const stability_axes usual = { STABILITY_START_REST, STABILITY_FRAME, 1.0f, 0.0f, 1.0f };
    stability_strands* s = calloc( 1, sizeof( *s ) );
    if ( s == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a cell" );
    }
    s->def = stability_strand_def( way, &usual );
    s->has_points = true;
    const wisp_status status = stability_strands_enter( s, modules, WISP_COUNT( modules ), &usual, workers, error );
    if ( status != WISP_OK )
    {
        stability_strands_close( s );
        return status;
    }
    stability_trial trial = stability_strands_trial( s, &usual );
    trial.limits.energy = INFINITY;
    trial.limits.jitter = stability_usual_limits( s->size, 1.0, s->seconds, s->substep ).jitter;
    trial.observe = observe_strands;
    return stability_run( &trial, out, error );
}

static const stability_named cells[] = {
    { "mesh: rod with segments without length", true, false, STABILITY_ROD, run_strands },
    { "mesh: xpbd strand with segments without length", false, false, STABILITY_STRAND_XPBD, run_strands },
    { "mesh: duplicate triangle", true, false, DUPLICATE, run },
    { "mesh: triangle without area", true, false, NO_AREA, run },
    { "mesh: edge without length", true, false, NO_LENGTH, run },
    { "mesh: isolated vertex", true, false, ISOLATED, run },
    { "mesh: edge of four triangles", true, false, THREE_AT_AN_EDGE, run },
    { "mesh: vertex of two fans", true, false, TWO_FANS, run },
    { "mesh: triangle that names a vertex twice", true, false, NAMED_TWICE, run },
};

const stability_named* stability_meshes( int* count )
{
    *count = WISP_COUNT( cells );
    return cells;
}
