#include "stability_parts.h"

#include "text_tree.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"
#include "wisp/module/vec.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- energy of constraints ----

// Energy of constraints. A projection moves two ends together by their error in one substep, like a spring of
// stiffness 1 / (wi + wj) h^2 in series with the compliance of the link. So a violated constraint stores C^2 / 2 over
// compliance + (wi + wj) h^2, for inextensible links too, and no more than that can become motion.

// A constraint between vertices a and b. @param softness m/N, in series with the compliance of a substep
static double energy_of_link( const stability_reader* r, int a, int b, double length, double rest, double softness,
                              double h )
{
    const double error = length - rest, whole = softness + ( r->weight[a] + r->weight[b] ) * h * h;
    return whole > 0.0 ? 0.5 * error * error / whole : 0.0;
}

// A fraction k of the error that a substep removes is the compliance that leaves 1 - k of it.
static double softness_of_fraction( double fraction, double weight, double h )
{
    return weight * h * h * ( 1.0 / fmax( fraction, 1e-6 ) - 1.0 );
}

// ---- surfaces ----

static double energy_of_links( const stability_reader* r, const scene_world* world, double h )
{
    const wisp_fabric* f = r->fabric;
    const float* alike = wisp_world_column( world->world, r->entity, WISP_LINK_COMPLIANCE, 0 );
    const float* own = wisp_world_column( world->world, r->entity, WISP_LINK_OWN, 0 );
    const float* fraction = wisp_world_column( world->world, r->entity, WISP_LINK_STIFFNESS, 0 );
    alike = fraction != NULL ? fraction : alike;
    const bool folds = wisp_world_has( world->world, r->entity, WISP_LINK_FOLDS );
    double sum = 0.0;
    for ( int i = 0; i < f->link_order.slot_count && alike != NULL; ++i )
    {
        const int kind = wisp_fabric_link_kind( f, i );
        if ( kind < 0 )
        {
            continue;
        }
        const int a = f->link_a_x4[i] / 4, b = f->link_b_x4[i] / 4;
        const double rest = (double)f->link_rest[i];
        // below half of its length a bend link gives way to its hinge in a sharp fold, and stores no more
        const double least = folds && kind == 1 ? 0.5 * rest : 0.0;
        const double value = (double)( own != NULL ? own[i] : alike[kind] );
        const double soft = fraction == NULL ? value : softness_of_fraction( value, r->weight[a] + r->weight[b], h );
        sum += energy_of_link( r, a, b, fmax( wisp_mesh_distance( r->now[a], r->now[b] ), least ), rest, soft, h );
    }
    return sum;
}

// Tethers are inextensible and only pull.
static double energy_of_pull( const stability_reader* r, int a, int b, double rest, double h )
{
    const double length = wisp_mesh_distance( r->now[a], r->now[b] );
    return length > rest ? energy_of_link( r, a, b, length, rest, 0.0, h ) : 0.0;
}

static double energy_of_tethers( const stability_reader* r, const scene_world* world, double h )
{
    const wisp_fabric* f = r->fabric;
    const float* slack = wisp_world_column( world->world, r->entity, WISP_SURFACE_TETHERS, 0 );
    double sum = 0.0;
    for ( int k = 0; slack != NULL && k < f->tether_count; ++k )
    {
        for ( int i = 0; i < f->vertex_count; ++i )
        {
            const size_t at = (size_t)k * (size_t)f->slot_count + (size_t)i;
            sum += energy_of_pull( r, f->tether_x4[at] / 4, i, (double)f->tether_rest[at] * (double)*slack, h );
        }
    }
    return sum;
}

// Coarse sheets, whose vertices have about four times the mass of the next finer ones. A short link counts in full, though it
// pushes no more than the mesh between its ends is compressed.
static double energy_of_levels( const stability_reader* r, const scene_world* world, double h )
{
    const wisp_fabric* f = r->fabric;
    const float* compliance = wisp_world_column( world->world, r->entity, WISP_LEVEL_COMPLIANCE, 0 );
    double sum = 0.0, lighter = 1.0;
    for ( int k = 0; compliance != NULL && k < f->level_count; ++k )
    {
        const wisp_fabric_level* level = f->levels + k;
        lighter /= 4.0;
        for ( int i = 0; i < level->schedule.slot_count; ++i )
        {
            const int a = level->slot_x4[level->a_x4[i] / 4] / 4, b = level->slot_x4[level->b_x4[i] / 4] / 4;
            const double error = wisp_mesh_distance( r->now[a], r->now[b] ) - (double)level->rest[i];
            const double whole =
                (double)compliance[level->first_link + i] + lighter * ( r->weight[a] + r->weight[b] ) * h * h;
            sum += level->schedule.constraint[i] >= 0 && whole > 0.0 ? 0.5 * error * error / whole : 0.0;
        }
    }
    return sum;
}

// The signed volume inside the triangles. @param gradient [vertex][3] to add to, m^2; null: none
static double volume_of( const wisp_fabric* f, const wisp_vec3* x, double ( *gradient )[3] )
{
    double sum = 0.0;
    for ( int t = 0; t < f->triangle_count; ++t )
    {
        const int32_t* corners = f->triangles + 3 * (size_t)t;
        for ( int i = 0; i < 3; ++i )
        {
            const wisp_vec3 p = x[corners[( i + 1 ) % 3]], q = x[corners[( i + 2 ) % 3]], own = x[corners[i]];
            const double area[3] = { ( (double)p.y * (double)q.z - (double)p.z * (double)q.y ) / 6.0,
                                     ( (double)p.z * (double)q.x - (double)p.x * (double)q.z ) / 6.0,
                                     ( (double)p.x * (double)q.y - (double)p.y * (double)q.x ) / 6.0 };
            sum += ( area[0] * (double)own.x + area[1] * (double)own.y + area[2] * (double)own.z ) / 3.0;
            for ( int k = 0; k < 3 && gradient != NULL; ++k )
            {
                gradient[corners[i]][k] += area[k];
            }
        }
    }
    return sum;
}

// A spring between the volume and its target: compliance V0 / P_atm for the gas, plus sum w |dV/dx|^2 h^2 for that of a
// projection within a substep, which is all with pbd. Gas that flows, and its buoyancy, do work that is not counted here.
static double energy_of_gas( const stability_reader* r, double h )
{
    const wisp_balloon_def* def = &r->surface->balloon;
    if ( def->allow_open || r->surface->gas_ratio_keyframe_count > 0 || def->inflation_rate != 0.0f )
    {
        return NAN;
    }
    double( *gradient )[3] = calloc( (size_t)r->count + 1, sizeof *gradient );
    if ( gradient == NULL )
    {
        return NAN;
    }
    const double target = (double)def->gas_ratio * volume_of( r->fabric, r->rest, NULL );
    const double error = volume_of( r->fabric, r->now, gradient ) - target;
    double soft = def->volume == WISP_SOLVER_PBD ? 0.0 : target / (double)def->atmospheric_pressure;
    for ( int i = 0; i < r->count; ++i )
    {
        const double* g = gradient[i];
        soft += r->weight[i] * h * h * ( g[0] * g[0] + g[1] * g[1] + g[2] * g[2] );
    }
    free( gradient );
    return soft > 0.0 ? 0.5 * error * error / soft : 0.0;
}

// Upper bound before the first step: a diagonal under pressure never stores more than by its initial slope, and no
// link is stiffer than sheet stiffness times area over length squared, which is at most 1 for the two halves of a
// right triangle.
static double springs_from_above( const stability_reader* r )
{
    const wisp_fabric* f = r->fabric;
    const double stiffness = (double)r->surface->implicit.stretch_stiffness;
    double sum = 0.0;
    for ( int e = 0; e < r->edge_count; ++e )
    {
        const int a = r->edges[2 * e], b = r->edges[2 * e + 1];
        const double error =
            wisp_mesh_distance( r->now[a], r->now[b] ) - wisp_mesh_distance( r->rest[a], r->rest[b] );
        sum += error > 0.0 ? 0.5 * stiffness * error * error : 0.0;
    }
    for ( int i = 0; i < f->hinge_count; ++i )
    {
        const int a = f->hinges[4 * i + 2], b = f->hinges[4 * i + 3];
        const double error =
            wisp_mesh_distance( r->now[a], r->now[b] ) - wisp_mesh_distance( r->rest[a], r->rest[b] );
        sum += error < 0.0 ? 0.5 * stiffness * error * error : 0.0;
    }
    return sum;
}

static double energy_of_springs( const stability_reader* r, const scene_world* world, bool is_start )
{
    wisp_implicit_cloth_stats stats = { 0 };
    if ( is_start )
    {
        return springs_from_above( r );
    }
    return wisp_read_implicit_cloth_stats( world->world, r->entity, &stats ) == WISP_OK
               ? stats.stretch_energy + stats.bend_energy
               : NAN;
}

// ---- strands ----

// @param apart 1: the segments; 2: links over two of them
static double energy_of_segments( const stability_reader* r, int apart, double compliance, double fraction, double h )
{
    double sum = 0.0;
    for ( int s = 0; s < r->strands->strand_count; ++s )
    {
        for ( int v = r->strands->offsets[s] + apart; v < r->strands->offsets[s + 1]; ++v )
        {
            const int a = v - apart;
            const double soft = compliance + softness_of_fraction( fraction, r->weight[a] + r->weight[v], h );
            sum += energy_of_link( r, a, v, wisp_mesh_distance( r->now[a], r->now[v] ),
                                   wisp_mesh_distance( r->rest[a], r->rest[v] ), soft, h );
        }
    }
    return sum;
}

static double turn_at( const wisp_vec3* x, const wisp_vec3* rest, int i )
{
    const double l = wisp_mesh_distance( rest[i], rest[i - 1] ), m = wisp_mesh_distance( rest[i + 1], rest[i] );
    const double d[3] = { (double)( x[i + 1].x - x[i].x ) / m - (double)( x[i].x - x[i - 1].x ) / l,
                          (double)( x[i + 1].y - x[i].y ) / m - (double)( x[i].y - x[i - 1].y ) / l,
                          (double)( x[i + 1].z - x[i].z ) / m - (double)( x[i].z - x[i - 1].z ) / l };
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

// EI / 2L |turn - rest turn|^2 is at most EI / L ( turn^2 + rest turn^2 ), with the largest EI of a substep. The clamp
// of the root differs at most by the opposite direction, over half of the first segment.
static double energy_of_rod( const stability_reader* r, int begin, int end, double h )
{
    double sum = 0.0;
    for ( int i = begin; i + 1 < end; ++i )
    {
        const double l = wisp_mesh_distance( r->rest[i], r->rest[i + 1] );
        const double weight = r->weight[i] > 0.0 ? r->weight[i] : r->weight[i + 1];
        const double most = weight > 0.0 ? 6e4 / weight * l * l * l / ( h * h ) : INFINITY;
        const double rigidity = fmin( (double)r->hair->dynamics.bend_rigidity, most );
        sum += i == begin ? rigidity / ( 0.5 * l ) * 0.5 * 4.0
                          : rigidity / l * ( turn_at( r->now, r->rest, i ) + turn_at( r->rest, r->rest, i ) );
    }
    return sum;
}

static double stored_in_strands( const stability_reader* r, double h )
{
    const wisp_strand_dynamics_def* d = &r->hair->dynamics;
    const bool is_pbd = d->solver == WISP_SOLVER_PBD, is_links = d->stretch == WISP_STRAND_STRETCH_LINKS;
    double sum = energy_of_segments( r, 1, is_links && !is_pbd ? (double)d->stretch_compliance : 0.0,
                                     is_links && is_pbd ? (double)d->stretch_stiffness : 1.0, h );
    if ( d->bending == WISP_STRAND_BEND_LINKS )
    {
        sum += energy_of_segments( r, 2, is_pbd ? 0.0 : (double)d->bend_compliance,
                                   is_pbd ? (double)d->bend_stiffness : 1.0, h );
    }
    return sum;
}

// ---- both ----

// J, that violated constraints and springs store; NaN: not known. @param h s, a substep @param is_start before the first step
static double stored_energy( const stability_reader* r, const scene_world* world, double h, bool is_start )
{
    if ( r->strands )
    {
        return stored_in_strands( r, h );
    }
    if ( r->surface->has_membrane )
    {
        return NAN; // what a projection adds to its energy has no closed form
    }
    double sum = energy_of_links( r, world, h ) + energy_of_tethers( r, world, h ) + energy_of_levels( r, world, h );
    sum += r->surface->has_implicit ? energy_of_springs( r, world, is_start ) : 0.0;
    return sum + ( r->surface->has_balloon ? energy_of_gas( r, h ) : 0.0 );
}

static wisp_vec3 apart( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ b.x - a.x, b.y - a.y, b.z - a.z };
}

// A plate of rigidity D that turns by an angle at an edge e between areas A and B stores at most 3 D angle^2 e^2 / (A + B).
static double energy_of_hinge( const stability_reader* r, const int32_t* hinge )
{
    static const wisp_vec3 zero = { 0.0f, 0.0f, 0.0f };
    const wisp_vec3 *x = r->now, i = x[hinge[0]], e = apart( i, x[hinge[1]] );
    const wisp_vec3 *rest = r->rest, p = rest[hinge[0]], f = apart( p, rest[hinge[1]] );
    const wisp_vec3 m = wisp_v3_cross( e, apart( i, x[hinge[2]] ) ), n = wisp_v3_cross( apart( i, x[hinge[3]] ), e );
    const double areas = 0.5 * ( wisp_mesh_distance( zero, wisp_v3_cross( f, apart( p, rest[hinge[2]] ) ) ) +
                                 wisp_mesh_distance( zero, wisp_v3_cross( f, apart( p, rest[hinge[3]] ) ) ) );
    const double sizes = wisp_mesh_distance( zero, m ) * wisp_mesh_distance( zero, n );
    const double cosine =
        sizes > 0.0 ? ( (double)m.x * (double)n.x + (double)m.y * (double)n.y + (double)m.z * (double)n.z ) / sizes
                    : 1.0;
    const double angle = acos( fmax( -1.0, fmin( 1.0, cosine ) ) ), length = wisp_mesh_distance( zero, f );
    return areas > 0.0 ? 3.0 * (double)r->surface->cloth.bend_rigidity * angle * angle * length * length / areas
                       : 0.0;
}

// J, that bending stores at most.
static double bent_energy( const stability_reader* r, double h )
{
    double sum = 0.0;
    if ( r->strands && r->hair->dynamics.bending == WISP_STRAND_BEND_ROD )
    {
        for ( int s = 0; s < r->strands->strand_count; ++s )
        {
            sum += energy_of_rod( r, r->strands->offsets[s], r->strands->offsets[s + 1], h );
        }
    }
    if ( r->surface && r->surface->has_cloth && r->surface->cloth.bending != WISP_CLOTH_BENDING_NONE )
    {
        for ( int i = 0; i < r->fabric->hinge_count; ++i )
        {
            sum += energy_of_hinge( r, r->fabric->hinges + 4 * i );
        }
    }
    return sum;
}

static double mean_weight( const stability_reader* r )
{
    double sum = 0.0;
    int count = 0;
    for ( int i = 0; i < r->count; ++i )
    {
        sum += r->weight[i];
        count += r->weight[i] > 0.0 ? 1 : 0;
    }
    return count > 0 ? sum / count : 0.0;
}

// m/N, of the softest edge, by its compliance and its stiffness in a substep.
static double softest_compliance( const stability_reader* r, double h )
{
    if ( r->strands )
    {
        const wisp_strand_dynamics_def* d = &r->hair->dynamics;
        return d->solver == WISP_SOLVER_PBD
                   ? softness_of_fraction( (double)d->stretch_stiffness, 2.0 * mean_weight( r ), h )
                   : (double)d->stretch_compliance;
    }
    const wisp_scene_surface* s = r->surface;
    if ( s->has_implicit )
    {
        return 2.0 / fmax( (double)s->implicit.stretch_stiffness, 1e-30 ); // open edges have half of it
    }
    if ( s->has_balloon )
    {
        return s->balloon.solver == WISP_SOLVER_PBD
                   ? softness_of_fraction( (double)s->balloon.stretch_stiffness, 2.0 * mean_weight( r ), h )
                   : 1.0 / (double)s->balloon.edge_stiffness;
    }
    const wisp_cloth_def* c = &s->cloth;
    return c->solver == WISP_SOLVER_PBD
               ? softness_of_fraction( fmin( (double)c->stretch_stiffness, (double)c->shear_stiffness ),
                                       2.0 * mean_weight( r ), h )
               : fmax( (double)c->warp_compliance, fmax( (double)c->weft_compliance, (double)c->shear_compliance ) );
}

// ---- a body after a step ----

// A body after a step: how far its vertices went, its strain next to what explains it, and its energy.

// ---- making ----

static void find_edges( stability_reader* r )
{
    if ( r->fabric )
    {
        const wisp_status status = wisp_fabric_need( r->fabric, WISP_FABRIC_EDGES | WISP_FABRIC_HINGES );
        r->edge_count = status == WISP_OK ? r->fabric->edge_count : 0;
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

// From coordinates in rows to those of the scene.
static void take_offset( const stability_reader* r, wisp_vec3 o )
{
    for ( int i = 0; i < r->count; ++i )
    {
        const wisp_vec3 p = r->now[i];
        r->now[i] = ( wisp_vec3 ){ p.x - o.x, p.y - o.y, p.z - o.z };
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
        take_offset( r, wisp_world_offset( w, r->entity ) );
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
    take_offset( r, wisp_world_offset( w, r->entity ) );
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
        farthest = worse( farthest, wisp_mesh_distance( p, r->before[i] ) );
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
    const double load = load_of( r, body, out->travel ), compliance = softest_compliance( r, h );
    const double left =
        is_solved ? (double)r->surface->implicit.tolerance * sqrt( r->count ) * body->gravity * h * h : 0.0;
    const double least = least_reach( r );
    out->reach = least;
    out->strain = 0.0;
    for ( int i = 0; i < r->edge_count && !has_none; ++i )
    {
        const int a = r->edges[2 * i], b = r->edges[2 * i + 1];
        const double rest = wisp_mesh_distance( r->rest[a], r->rest[b] );
        if ( !( rest > 0.0 ) )
        {
            continue; // an edge without length has no strain
        }
        const double strain = wisp_mesh_distance( r->now[a], r->now[b] ) / rest - 1.0;
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
        out->stored = stored_energy( r, world, h, dt <= 0.0 );
        out->bent = bent_energy( r, h );
        out->energy = energy_of_motion( r ) + out->stored;
        out->is_finite &= isfinite( out->strain ) && !isinf( out->energy );
    }
}
