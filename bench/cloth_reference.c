#include "cloth_scene.h"

#include <math.h>
#include <stdlib.h>

// The schedule runs tile by tile and colour by colour; parallel parts share no vertex, so a sequential order gives
// the same.
static void collect_links( cloth_reference* reference )
{
    const wisp_fabric* f = reference->fabric;
    for ( int slot = 0; slot < f->link_order.slot_count; ++slot )
    {
        int link = f->link_order.constraint[slot];
        if ( link >= 0 )
        {
            int i = reference->link_count++;
            reference->links[i][0] = f->link_a_x4[slot] / 4;
            reference->links[i][1] = f->link_b_x4[slot] / 4;
            reference->rest[i] = (double)f->link_rest[slot];
            reference->stiffness[i] = link < f->edge_count ? 1.0 : (double)CLOTH_BEND_STIFFNESS;
        }
    }
}

static void place_vertices( const cloth_scene* scene, cloth_reference* reference )
{
    const wisp_fabric* f = reference->fabric;
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        int slot = f->vertex_slot[v];
        wisp_vec3 p = scene->mesh.points[v];
        reference->position[slot][0] = (double)p.x;
        reference->position[slot][1] = (double)p.y;
        reference->position[slot][2] = (double)p.z;
        reference->inverse_mass[slot] = v == scene->pins[0] || v == scene->pins[1] ? 0.0 : 1.0;
    }
}

wisp_status cloth_reference_create( const cloth_scene* scene, const wisp_fabric* fabric, cloth_reference* out,
                                    wisp_error* error )
{
    size_t slots = (size_t)fabric->slot_count, links = (size_t)fabric->link_count;
    *out = ( cloth_reference ){
        .slot_count = fabric->slot_count,
        .position = calloc( slots, sizeof( *out->position ) ),
        .previous = calloc( slots, sizeof( *out->previous ) ),
        .velocity = calloc( slots, sizeof( *out->velocity ) ),
        .inverse_mass = calloc( slots, sizeof( double ) ),
        .links = calloc( links, sizeof( *out->links ) ),
        .rest = calloc( links, sizeof( double ) ),
        .stiffness = calloc( links, sizeof( double ) ),
        .fabric = fabric,
    };
    if ( !out->position || !out->previous || !out->velocity || !out->inverse_mass || !out->links || !out->rest ||
         !out->stiffness )
    {
        cloth_reference_destroy( out );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the cloth in double precision" );
    }
    collect_links( out );
    place_vertices( scene, out );
    return WISP_OK;
}

void cloth_reference_destroy( cloth_reference* reference )
{
    free( reference->position );
    free( reference->previous );
    free( reference->velocity );
    free( reference->inverse_mass );
    free( reference->links );
    free( reference->rest );
    free( reference->stiffness );
    *reference = ( cloth_reference ){ 0 };
}

static void predict( cloth_reference* reference, double h )
{
    for ( int i = 0; i < reference->slot_count; ++i )
    {
        bool moves = reference->inverse_mass[i] > 0.0;
        reference->velocity[i][1] -= moves ? h * (double)CLOTH_GRAVITY : 0.0;
        for ( int k = 0; k < 3; ++k )
        {
            reference->previous[i][k] = reference->position[i][k];
            reference->position[i][k] += moves ? h * reference->velocity[i][k] : 0.0;
        }
    }
}

// Eq. 6 of the balloon paper times stiffness.
static void project( cloth_reference* reference )
{
    for ( int i = 0; i < reference->link_count; ++i )
    {
        double *a = reference->position[reference->links[i][0]], *b = reference->position[reference->links[i][1]];
        double wa = reference->inverse_mass[reference->links[i][0]],
               wb = reference->inverse_mass[reference->links[i][1]];
        double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
        double length = sqrt( x * x + y * y + z * z );
        double weight = length * ( wa + wb );
        double s = weight > 0.0 ? reference->stiffness[i] * ( length - reference->rest[i] ) / weight : 0.0;
        a[0] -= wa * s * x;
        a[1] -= wa * s * y;
        a[2] -= wa * s * z;
        b[0] += wb * s * x;
        b[1] += wb * s * y;
        b[2] += wb * s * z;
    }
}

void cloth_reference_step( cloth_reference* reference, int substeps )
{
    double h = (double)CLOTH_STEP / substeps;
    for ( int s = 0; s < substeps; ++s )
    {
        predict( reference, h );
        project( reference );
        for ( int i = 0; i < reference->slot_count; ++i )
        {
            for ( int k = 0; k < 3; ++k )
            {
                reference->velocity[i][k] = ( reference->position[i][k] - reference->previous[i][k] ) / h;
            }
        }
    }
}

double cloth_reference_distance( const cloth_reference* reference, const wisp_vec3* points )
{
    double largest = 0.0;
    for ( int v = 0; v < reference->fabric->vertex_count; ++v )
    {
        const double* q = reference->position[reference->fabric->vertex_slot[v]];
        double x = (double)points[v].x - q[0], y = (double)points[v].y - q[1], z = (double)points[v].z - q[2];
        double distance = sqrt( x * x + y * y + z * z );

        // Not fmax, which would ignore a NaN.
        largest = distance <= largest ? largest : distance;
    }
    return largest;
}
