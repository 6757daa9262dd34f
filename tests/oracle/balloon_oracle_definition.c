// What a balloon of the oracle is made of: options, checks, creation.
#include "balloon_oracle.h"

#include "oracle_check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

balloon_oracle_options balloon_oracle_default_options( void )
{
    balloon_oracle_options options = {
        .dt = 1.0 / 60.0,
        .substeps = 10,
        .iterations = 2,
        .volume = BALLOON_ORACLE_VOLUME_XPBD,
        .pressure = BALLOON_ORACLE_PRESSURE_VIRIAL,
        .drag = BALLOON_ORACLE_DRAG_MAX,
        .spin = BALLOON_ORACLE_SPIN_KICK,
        .use_gravity = true,
        .use_buoyancy = true,
        .use_drag = true,
        .use_jet = true,
        .limit_drag = true,
        .gravity = { 0.0, -9.8, 0.0 },
        .atmosphere = 101325.0,
        .temperature = 293.15,
        .gas_molar_mass = BALLOON_ORACLE_HELIUM,
        .air_molar_mass = BALLOON_ORACLE_AIR,
        .drag_coefficient = 0.5,
        .outlet_area = 1e-4,
        .structural_k = 0.9,
        .bend_k = 0.1,
        .volume_k = 1.0,
        .structural_stiffness = 2000.0,
        .bend_stiffness = 20.0,
        .close_at = 1e-4,
        .open_at = 5e-4,
        .min_volume = 1.0,
    };
    return options;
}

// Check the definition.

static wisp_status check_options( const balloon_oracle_options* o, wisp_error* error )
{
    const oracle_limit limits[] = {
        { "dt", o->dt, 1e-9, 1e3 },
        { "substeps", o->substeps, 1.0, 1e6 },
        { "iterations", o->iterations, 1.0, 1e6 },
        { "gravity", double3_length( o->gravity ), 0.0, 1e6 },
        { "atmosphere", o->atmosphere, 1e-3, 1e12 },
        { "temperature", o->temperature, 1e-3, 1e6 },
        { "gas molar mass", o->gas_molar_mass, 1e-6, 10.0 },
        { "air molar mass", o->air_molar_mass, 1e-6, 10.0 },
        { "drag coefficient", o->drag_coefficient, 0.0, 1e6 },
        { "outlet area", o->outlet_area, 0.0, 1e6 },
        { "structural k", o->structural_k, 1e-12, 1.0 },
        { "bend k", o->bend_k, 0.0, 1.0 },
        { "volume k", o->volume_k, 0.0, 1.0 },
        { "structural stiffness", o->structural_stiffness, 1e-12, 1e12 },
        { "bend stiffness", o->bend_stiffness, 1e-12, 1e12 },
        { "velocity decay", o->velocity_decay, 0.0, 1e12 },
        { "close_at", o->close_at, 0.0, o->open_at },
        { "least volume", o->min_volume, 1e-3, 1.0 },
        { "inflow", o->inflow, -1e6, 1e6 },
    };
    const wisp_status status = oracle_check_limits( limits, WISP_COUNT( limits ), error );
    if ( status != WISP_OK )
    {
        return status;
    }
    return WISP_OK;
}

static wisp_status check_indices( const int* list, int count, int limit, const char* what, wisp_error* error )
{
    for ( int n = 0; n < count; ++n )
    {
        if ( list[n] < 0 || list[n] >= limit )
        {
            return refuse( error, WISP_BAD_INPUT, "index %d of the %s list is %d, must be in [0, %d)", n, what,
                           list[n], limit );
        }
    }
    return WISP_OK;
}

static wisp_status check_vertices( const balloon_oracle_def* def, wisp_error* error )
{
    for ( int i = 0; i < def->vertex_count; ++i )
    {
        if ( !is_coordinate( def->positions[i] ) )
        {
            return refuse( error, WISP_BAD_INPUT, "vertex %d is not finite or beyond 1e6 m", i );
        }
    }
    for ( int i = 0; i < def->vertex_count; ++i )
    {
        if ( !is_within( def->mass[i], 1e-12, 1e12 ) )
        {
            return refuse( error, WISP_BAD_INPUT, "vertex %d has a mass of %g kg, must be in [1e-12, 1e12]", i,
                           def->mass[i] );
        }
    }
    return WISP_OK;
}

static wisp_status check_edge( const balloon_mesh_edge* edge, bool allow_open, wisp_error* error )
{
    if ( edge->a == edge->b )
    {
        return refuse( error, WISP_BAD_INPUT, "triangle %d has vertex %d twice", edge->triangle[0], edge->a );
    }
    if ( edge->uses == 1 && !allow_open )
    {
        return refuse( error, WISP_BAD_INPUT, "the mesh is open at edge %d-%d: it has no volume", edge->a, edge->b );
    }
    if ( edge->uses > 2 )
    {
        return refuse( error, WISP_BAD_INPUT, "edge %d-%d has %d faces, must have two", edge->a, edge->b,
                       edge->uses );
    }
    if ( edge->uses == 2 && edge->ascending != 1 )
    {
        return refuse( error, WISP_BAD_INPUT, "triangles %d and %d run along edge %d-%d in the same direction",
                       edge->triangle[0], edge->triangle[1], edge->a, edge->b );
    }
    return WISP_OK;
}

static wisp_status check_shell( const balloon_oracle_def* def, wisp_error* error )
{
    // the topology only reads these two arrays
    balloon_mesh mesh = { .vertex_count = def->vertex_count, .triangle_count = def->triangle_count };
    mesh.triangles = calloc( 3 * (size_t)def->triangle_count, sizeof( int ) );
    balloon_mesh_topology topology;
    if ( mesh.triangles == NULL )
    {
        return refuse( error, WISP_NO_MEMORY, "out of memory for %d triangles", def->triangle_count );
    }
    memcpy( mesh.triangles, def->triangles, 3 * (size_t)def->triangle_count * sizeof( int ) );
    bool made = balloon_mesh_build_topology( &mesh, &topology );
    free( mesh.triangles );
    if ( !made )
    {
        return refuse( error, WISP_NO_MEMORY, "out of memory for the edges of %d triangles", def->triangle_count );
    }
    wisp_status status = WISP_OK;
    for ( int e = 0; e < topology.edge_count && status == WISP_OK; ++e )
    {
        status = check_edge( topology.edges + e, def->allow_open, error );
    }
    if ( status == WISP_OK && topology.component_count != 1 )
    {
        status =
            refuse( error, WISP_BAD_INPUT, "the mesh has %d shells, this body takes one", topology.component_count );
    }
    balloon_mesh_destroy_topology( &topology );
    return status;
}

static wisp_status check_def( const balloon_oracle_def* def, wisp_error* error )
{
    int n = def->vertex_count, m = def->triangle_count;
    if ( n < 4 || m < 4 || n > 1000000 || m > 1000000 )
    {
        return refuse( error, WISP_BAD_INPUT, "%d vertices and %d triangles, a closed mesh has 4 to 1000000 of both",
                       n, m );
    }
    if ( def->structural_count < 0 || def->bend_count < 0 || def->outlet_count < 0 )
    {
        return refuse( error, WISP_BAD_INPUT, "a list has a negative count" );
    }
    if ( def->structural_count > 10000000 || def->bend_count > 10000000 || def->outlet_count > n )
    {
        return refuse( error, WISP_BAD_INPUT, "a list is longer than a mesh of this size can need" );
    }
    wisp_status status = check_vertices( def, error );
    const struct
    {
        const int* list;
        int count, limit;
        const char* what;
    } lists[] = {
        { def->triangles, 3 * m, n, "triangle" },
        { def->structural, 2 * def->structural_count, n, "structural" },
        { def->bend, 2 * def->bend_count, n, "bend" },
        { def->outlet, def->outlet_count, n, "outlet" },
    };
    for ( int k = 0; k < WISP_COUNT( lists ) && status == WISP_OK; ++k )
    {
        status = check_indices( lists[k].list, lists[k].count, lists[k].limit, lists[k].what, error );
    }
    return status == WISP_OK ? check_shell( def, error ) : status;
}

// Creation.

static bool allocate( const balloon_oracle_def* def, balloon_oracle* b )
{
    size_t n = (size_t)def->vertex_count;
    double3** vectors[] = { &b->x, &b->p, &b->predicted, &b->v, &b->force, &b->normal, &b->gradient };
    double** numbers[] = { &b->mass, &b->w, &b->area };
    bool complete = true;
    for ( int k = 0; k < WISP_COUNT( vectors ); ++k )
    {
        *vectors[k] = calloc( n, sizeof( double3 ) );
        complete = complete && *vectors[k] != NULL;
    }
    for ( int k = 0; k < WISP_COUNT( numbers ); ++k )
    {
        *numbers[k] = calloc( n, sizeof( double ) );
        complete = complete && *numbers[k] != NULL;
    }
    b->triangles = calloc( 3 * (size_t)def->triangle_count, sizeof( int ) );
    b->outlet = calloc( (size_t)def->outlet_count + 1, sizeof( int ) );
    b->structural = calloc( (size_t)def->structural_count + 1, sizeof( balloon_oracle_link ) );
    b->bend = calloc( (size_t)def->bend_count + 1, sizeof( balloon_oracle_link ) );
    return complete && b->triangles != NULL && b->outlet != NULL && b->structural != NULL && b->bend != NULL;
}

void balloon_oracle_destroy( balloon_oracle* b )
{
    void* blocks[] = { b->x,    b->p, b->predicted, b->v,         b->force,  b->normal,     b->gradient,
                       b->mass, b->w, b->area,      b->triangles, b->outlet, b->structural, b->bend };
    for ( int k = 0; k < WISP_COUNT( blocks ); ++k )
    {
        free( blocks[k] );
    }
    balloon_oracle_destroy_caps( &b->caps );
    *b = ( balloon_oracle ){ 0 };
}

static void copy_links( const double3* x, const int* pairs, int count, balloon_oracle_link* links )
{
    for ( int e = 0; e < count; ++e )
    {
        int a = pairs[2 * e], c = pairs[2 * e + 1];
        links[e] = ( balloon_oracle_link ){ a, c, double3_distance( x[a], x[c] ), 0.0 };
    }
}

static void turn_inside_out( int* triangles, int count )
{
    for ( int t = 0; t < count; ++t )
    {
        int* corner = triangles + 3 * t;
        int kept = corner[1];
        corner[1] = corner[2];
        corner[2] = kept;
    }
}

static void copy_def( const balloon_oracle_def* def, balloon_oracle* b )
{
    for ( int i = 0; i < def->vertex_count; ++i )
    {
        b->x[i] = b->p[i] = def->positions[i];
        b->mass[i] = def->mass[i];
        b->w[i] = def->pinned != NULL && def->pinned[i] ? 0.0 : 1.0 / def->mass[i];
        b->total_mass += def->mass[i];
    }
    memcpy( b->triangles, def->triangles, 3 * (size_t)def->triangle_count * sizeof( int ) );
    if ( def->outlet_count > 0 )
    {
        memcpy( b->outlet, def->outlet, (size_t)def->outlet_count * sizeof( int ) );
    }
    copy_links( b->x, def->structural, def->structural_count, b->structural );
    copy_links( b->x, def->bend, def->bend_count, b->bend );
}

// A closed skin needs no caps and uses the plain equations.
static bool cap( balloon_oracle* b )
{
    balloon_mesh mesh = { b->vertex_count, b->triangle_count, b->x, b->triangles };
    bool made = balloon_oracle_make_caps( &mesh, &b->caps );
    if ( made && b->caps.hub_count == 0 )
    {
        balloon_oracle_destroy_caps( &b->caps );
    }
    return made;
}

wisp_status balloon_oracle_create( const balloon_oracle_def* def, const balloon_oracle_options* options,
                                   balloon_oracle* out, wisp_error* error )
{
    wisp_status status = check_options( options, error );
    status = status == WISP_OK ? check_def( def, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    balloon_oracle made = { .options = *options,
                            .vertex_count = def->vertex_count,
                            .triangle_count = def->triangle_count,
                            .structural_count = def->structural_count,
                            .bend_count = def->bend_count,
                            .outlet_count = def->outlet_count,
                            .q = { 1.0, 0.0, 0.0, 0.0 } };
    if ( !allocate( def, &made ) )
    {
        balloon_oracle_destroy( &made );
        return refuse( error, WISP_NO_MEMORY, "out of memory for a balloon of %d vertices", def->vertex_count );
    }
    copy_def( def, &made );
    if ( def->allow_open && !cap( &made ) )
    {
        balloon_oracle_destroy( &made );
        return refuse( error, WISP_BAD_INPUT, "a border is no simple loop" );
    }
    made.rest_volume = balloon_oracle_present_volume( &made );
    if ( made.rest_volume < 0.0 )
    {
        turn_inside_out( made.triangles, made.triangle_count );
        turn_inside_out( made.caps.triangles, made.caps.triangle_count );
        made.rest_volume = -made.rest_volume;
    }
    if ( made.rest_volume == 0.0 )
    {
        balloon_oracle_destroy( &made );
        return refuse( error, WISP_BAD_INPUT, "the mesh encloses no volume" );
    }
    made.volume = made.gas_volume = made.rest_volume;
    made.centre = balloon_oracle_centre( made.x, made.mass, made.vertex_count );
    *out = made;
    return WISP_OK;
}

wisp_status balloon_oracle_create_from_mesh( const balloon_mesh* mesh, double areal_density, int outlet_vertex,
                                             const balloon_oracle_options* options, balloon_oracle* out,
                                             wisp_error* error )
{
    wisp_status sound =
        check_indices( mesh->triangles, 3 * mesh->triangle_count, mesh->vertex_count, "triangle", error );
    balloon_mesh_topology topology;
    if ( sound != WISP_OK )
    {
        return sound;
    }
    if ( !balloon_mesh_build_topology( mesh, &topology ) )
    {
        return refuse( error, WISP_NO_MEMORY, "out of memory for the edges of %d triangles", mesh->triangle_count );
    }
    int* pairs = calloc( 4 * (size_t)topology.edge_count + 1, sizeof( int ) );
    double* mass = calloc( (size_t)mesh->vertex_count + 1, sizeof( double ) );
    wisp_status status = WISP_NO_MEMORY;
    if ( pairs == NULL || mass == NULL )
    {
        refuse( error, WISP_NO_MEMORY, "out of memory for a mesh of %d vertices", mesh->vertex_count );
    }
    else
    {
        balloon_oracle_def def = { .vertex_count = mesh->vertex_count,
                                   .triangle_count = mesh->triangle_count,
                                   .positions = mesh->positions,
                                   .mass = mass,
                                   .triangles = mesh->triangles,
                                   .structural = pairs,
                                   .outlet = &outlet_vertex,
                                   .outlet_count = outlet_vertex < 0 ? 0 : 1 };
        balloon_oracle_masses( mesh->positions, mesh->vertex_count, mesh->triangles, mesh->triangle_count,
                               areal_density, mass );
        def.structural_count = balloon_mesh_structural_pairs( &topology, pairs );
        def.bend = pairs + 2 * topology.edge_count;
        def.bend_count = balloon_mesh_bend_pairs( &topology, pairs + 2 * topology.edge_count );
        status = balloon_oracle_create( &def, options, out, error );
    }
    free( pairs );
    free( mass );
    balloon_mesh_destroy_topology( &topology );
    return status;
}
