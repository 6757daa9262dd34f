// A body after a step: how far its vertices went, its strain next to what explains it, and its energy.
#include "stability_parts.h"

#include "text_tree.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

// ---- making ----

static void find_edges( stability_reader* r )
{
    if ( r->fabric )
    {
        r->edge_count = wisp_fabric_need( r->fabric, WISP_FABRIC_EDGES ) == WISP_OK ? r->fabric->edge_count : 0;
        r->edges = text_alloc( (size_t)r->edge_count * 2 * sizeof *r->edges );
        memcpy( r->edges, r->fabric->edges, (size_t)r->edge_count * 2 * sizeof *r->edges );
        return;
    }
    r->edges = text_alloc( (size_t)r->count * 2 * sizeof *r->edges );
    for ( int s = 0; s < r->strands->strand_count; ++s )
    {
        for ( int v = r->strands->offsets[s] + 1; v < r->strands->offsets[s + 1]; ++v )
        {
            r->edges[2 * r->edge_count] = v - 1;
            r->edges[2 * r->edge_count++ + 1] = v;
        }
    }
}

// Where a vertex of a strand is in a column of three floats a lane: `rows` times WISP_LANES floats make a row.
static size_t place_in_lanes( const wisp_strand_topology* t, int lane, int vertex, int rows )
{
    const int row = t->group_row[lane / WISP_LANES] + vertex;
    return (size_t)row * (size_t)rows * WISP_LANES + (size_t)( lane % WISP_LANES );
}

static void read_lanes( const stability_reader* r, const float* column, wisp_vec3* out )
{
    const wisp_strand_topology* t = r->strands;
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        const int strand = t->lane_strand[lane];
        for ( int v = 0; strand >= 0 && v < t->lane_count[lane]; ++v )
        {
            const float* at = column + place_in_lanes( t, lane, v, 3 );
            out[t->offsets[strand] + v] = ( wisp_vec3 ){ at[0], at[WISP_LANES], at[2 * WISP_LANES] };
        }
    }
}

static void read_lane_weights( const stability_reader* r, const float* column )
{
    const wisp_strand_topology* t = r->strands;
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        const int strand = t->lane_strand[lane];
        for ( int v = 0; strand >= 0 && v < t->lane_count[lane]; ++v )
        {
            r->weight[t->offsets[strand] + v] = (double)column[place_in_lanes( t, lane, v, 1 )];
        }
    }
}

static void read_columns( const stability_reader* r, const scene_world* world )
{
    wisp_world* w = world->world;
    if ( !r->moves )
    {
        (void)scene_world_points( world, r->body, r->now, NULL );
        return;
    }
    if ( r->strands )
    {
        read_lanes( r, wisp_world_column( w, r->entity, WISP_STRAND_POSITION, 0 ), r->now );
        read_lanes( r, wisp_world_column( w, r->entity, WISP_STRAND_VELOCITY, 0 ), r->motion );
        read_lane_weights( r, wisp_world_column( w, r->entity, WISP_STRAND_INVERSE_MASS, 0 ) );
        return;
    }
    const float* x = wisp_world_column( w, r->entity, WISP_PARTICLE_POSITION, 0 );
    const float* v = wisp_world_column( w, r->entity, WISP_PARTICLE_VELOCITY, 0 );
    for ( int i = 0; i < r->count; ++i )
    {
        r->now[i] = ( wisp_vec3 ){ x[4 * i], x[4 * i + 1], x[4 * i + 2] };
        r->motion[i] = ( wisp_vec3 ){ v[4 * i], v[4 * i + 1], v[4 * i + 2] };
        r->weight[i] = (double)x[4 * i + 3];
    }
}

stability_reader* stability_reader_make( const scene_world* world, int body )
{
    const int strands = world->scene->strands_count;
    stability_reader* r = text_alloc( sizeof *r );
    r->body = body;
    if ( body < strands )
    {
        r->hair = &world->scene->strands[body];
        r->entity = world->entities[body];
        r->strands = wisp_world_strands( world->world, r->entity );
        r->moves = r->hair->has_dynamics;
    }
    else
    {
        r->surface = &world->scene->surfaces[body - strands];
        r->entity = world->surfaces[body - strands].entity;
        r->fabric = world->surfaces[body - strands].fabric;
        r->moves = true;
    }
    r->count = scene_world_body( world, body ).vertex_count;
    const size_t bytes = (size_t)r->count * sizeof *r->now;
    r->rest = text_alloc( bytes );
    r->now = text_alloc( bytes );
    r->before = text_alloc( bytes );
    r->motion = text_alloc( bytes );
    r->weight = text_alloc( (size_t)r->count * sizeof *r->weight );
    if ( r->moves )
    {
        find_edges( r );
    }
    if ( r->fabric )
    {
        memcpy( r->rest, r->fabric->rest, bytes );
    }
    else if ( r->moves )
    {
        read_lanes( r, wisp_world_column( world->world, r->entity, WISP_STRAND_REST, 0 ), r->rest );
    }
    return r;
}

void stability_reader_free( stability_reader* r )
{
    if ( r )
    {
        free( r->rest );
        free( r->now );
        free( r->before );
        free( r->motion );
        free( r->weight );
        free( r->edges );
        free( r );
    }
}

// ---- motion ----

// The larger one, and NaN if there is one, which fmax would ignore.
static double worse( double before, double now )
{
    return now <= before || isnan( before ) ? before : now;
}

static void read_travel( const stability_reader* r, double dt, stability_sample* out )
{
    double farthest = 0.0;
    out->coordinate = 0.0;
    for ( int i = 0; i < r->count; ++i )
    {
        const wisp_vec3 p = r->now[i];
        farthest = worse( farthest, stability_distance( p, r->before[i] ) );
        out->coordinate =
            worse( out->coordinate, fmax( fabs( (double)p.x ), fmax( fabs( (double)p.y ), fabs( (double)p.z ) ) ) );
    }
    out->travel = dt > 0.0 ? farthest / dt : 0.0;
    memcpy( r->before, r->now, (size_t)r->count * sizeof *r->now );
}

static wisp_vec3 gravity_of( const stability_reader* r )
{
    return r->surface ? r->surface->gravity : r->hair->dynamics.gravity;
}

static double dot( wisp_vec3 a, wisp_vec3 b )
{
    return (double)a.x * (double)b.x + (double)a.y * (double)b.y + (double)a.z * (double)b.z;
}

static double energy_of_motion( const stability_reader* r )
{
    const wisp_vec3 g = gravity_of( r );
    double sum = 0.0;
    for ( int i = 0; i < r->count; ++i )
    {
        const double mass = r->weight[i] > 0.0 ? 1.0 / r->weight[i] : 0.0;
        sum += mass * ( 0.5 * dot( r->motion[i], r->motion[i] ) - dot( g, r->now[i] ) );
    }
    return sum;
}

static double free_mass( const stability_reader* r )
{
    double mass = 0.0;
    for ( int i = 0; i < r->count; ++i )
    {
        mass += r->weight[i] > 0.0 ? 1.0 / r->weight[i] : 0.0;
    }
    return mass;
}

// ---- strain ----

// What pulls at the softest edge: the weight on a pin, or of a strand, and the centripetal force of what moves.
static double load_of( const stability_reader* r, const stability_body* body, double speed )
{
    const double held = r->strands ? r->strands->strand_count : fmax( body->pin_count, 1.0 );
    return free_mass( r ) / held * ( body->gravity + 2.0 * speed * speed / fmax( body->extent, 1e-30 ) ) +
           body->burden;
}

// A cloth stretched straight between its pins carries far more than its weight: a cable of stiffness EA and weight W
// without sag stretches by (1/24)^(1/3) (W / EA)^(2/3).
static double cable_strain( const stability_reader* r, const stability_body* body, double compliance, double rest )
{
    const bool is_cable = r->surface && r->surface->has_implicit && body->pin_count >= 2;
    return is_cable ? cbrt( 1.0 / 24.0 ) * pow( free_mass( r ) * body->gravity * compliance / rest, 2.0 / 3.0 ) : 0.0;
}

// Lengths that hold whatever the load: those of the direct solve, of a skin that gas stretches.
static double least_reach( const stability_reader* r )
{
    if ( r->strands && r->hair->dynamics.stretch != WISP_STRAND_STRETCH_LINKS )
    {
        return fmax( (double)r->hair->dynamics.stretch_tolerance, 1e-4 );
    }
    if ( r->surface && r->surface->has_balloon )
    {
        // twice at five-fold vertices, twice around what is held
        double most = fmax( 1.0, (double)r->surface->balloon.gas_ratio );
        for ( int i = 0; i < r->surface->gas_ratio_keyframe_count; ++i )
        {
            most = fmax( most, (double)r->surface->gas_ratio_keyframes[i].gas_ratio );
        }
        return 1e-4 + 4.0 * ( cbrt( most ) - 1.0 );
    }
    return 1e-4;
}

static bool has_links( const stability_reader* r )
{
    return r->strands ? r->hair->dynamics.stretch == WISP_STRAND_STRETCH_LINKS
                      : ( r->surface->has_cloth || r->surface->has_balloon ) && !r->surface->has_membrane;
}

// A sweep removes the addition of a substep only where a link is stretched by (wi + wj) h^2 of its load, a linear
// solve anywhere, but for its tolerance, which is of the norm over all vertices.
static void read_strain( const stability_reader* r, const stability_body* body, double h, stability_sample* out )
{
    const bool is_solved = r->surface && r->surface->has_implicit;
    const bool has_none = r->surface && !is_solved && !has_links( r );
    const double load = load_of( r, body, out->travel ), compliance = stability_compliance( r, h );
    const double left =
        is_solved ? (double)r->surface->implicit.tolerance * sqrt( r->count ) * body->gravity * h * h : 0.0;
    const double least = least_reach( r );
    out->reach = least;
    out->strain = 0.0;
    for ( int i = 0; i < r->edge_count && !has_none; ++i )
    {
        const int a = r->edges[2 * i], b = r->edges[2 * i + 1];
        const double rest = stability_distance( r->rest[a], r->rest[b] );
        if ( !( rest > 0.0 ) )
        {
            continue; // an edge without length has no strain
        }
        const double strain = stability_distance( r->now[a], r->now[b] ) / rest - 1.0;
        const double sweep = has_links( r ) ? ( r->weight[a] + r->weight[b] ) * h * h : 0.0;
        const double soft = has_links( r ) || is_solved ? compliance + sweep : 0.0;
        const double rounding = 4.0 * (double)FLT_EPSILON * out->coordinate / rest;
        out->strain = worse( out->strain, is_solved && strain < 0.0 ? 0.0 : fabs( strain ) );
        out->reach = fmax( out->reach, least + ( soft * load + left ) / rest + rounding );
        out->reach = fmax( out->reach, cable_strain( r, body, compliance, rest ) );
    }
    out->reach = has_none ? INFINITY : out->reach;
}

void stability_read( stability_reader* r, const scene_world* world, const stability_body* body, double dt,
                     stability_sample* out )
{
    const double h = dt > 0.0 ? body->substep * dt / (double)world->scene->dt : body->substep;
    read_columns( r, world );
    read_travel( r, dt, out );
    out->is_finite &= isfinite( out->travel ) && isfinite( out->coordinate );
    if ( r->moves )
    {
        read_strain( r, body, h, out );
        out->stored = stability_stored_energy( r, world, h, dt <= 0.0 );
        out->bent = stability_bent_energy( r, h );
        out->energy = energy_of_motion( r ) + out->stored;
        out->is_finite &= isfinite( out->strain ) && !isinf( out->energy );
    }
}
