// What a balloon of the oracle is made of: options, creation.
#include "balloon_oracle.h"

#include "oracle_check.h"

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
    made.volume = made.gas_volume = made.rest_volume;
    made.centre = balloon_oracle_centre( made.x, made.mass, made.vertex_count );
    *out = made;
    return WISP_OK;
}

wisp_status balloon_oracle_create_from_mesh( const balloon_mesh* mesh, double areal_density, int outlet_vertex,
                                             const balloon_oracle_options* options, balloon_oracle* out,
                                             wisp_error* error )
{
    balloon_mesh_topology topology;
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
