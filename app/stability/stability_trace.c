#include "stability_judges.h"
#include "stability_parts.h"

#include "interruption.h"
#include "text_tree.h"
#include "wisp/module/components.h"
#include "wisp/module/definition.h"
#include "wisp/module/random.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- softness ----

// How soft bodies are: the stretch that their weight, the wind and their solver explain.

// The stretch of an edge that carries the weight of everything: by its compliance c, and by what a projection of
// weight w leaves, which is about 2 w h^2 for each newton: a chain of n masses m hangs longer by n g h^2 in every
// link.
static double softness_of( double compliance, double stiffness, double inverse_mass, double h, double force,
                           double edge )
{
    return ( compliance + 2.0 * inverse_mass * h * h / fmax( stiffness, 1e-2 ) ) * force / edge;
}

static double surface_softness( const wisp_scene_surface* s, const stability_body* body, double inverse_mass,
                                double force )
{
    const double h = body->substep;
    if ( s->has_implicit )
    {
        return softness_of( 1.0 / (double)s->implicit.stretch_stiffness, 1.0, 0.0, h, force, body->edge );
    }
    if ( s->has_cloth && !s->has_membrane )
    {
        const bool is_pbd = s->cloth.solver == WISP_SOLVER_PBD;
        const double c = fmax( (double)s->cloth.warp_compliance,
                               fmax( (double)s->cloth.weft_compliance, (double)s->cloth.shear_compliance ) );
        const double k = is_pbd ? fmin( (double)s->cloth.stretch_stiffness, (double)s->cloth.shear_stiffness ) : 1.0;
        return softness_of( is_pbd ? 0.0 : c, k, inverse_mass, h, force, body->edge );
    }
    return INFINITY; // a skin that gas stretches, rubber, or vertices without links
}

static double strands_softness( const wisp_scene_strands* s, const stability_body* body, double inverse_mass,
                                double force )
{
    const double h = body->substep;
    if ( s->dynamics.stretch != WISP_STRAND_STRETCH_LINKS )
    {
        return (double)s->dynamics.stretch_tolerance;
    }
    const bool is_pbd = s->dynamics.solver == WISP_SOLVER_PBD;
    return softness_of( is_pbd ? 0.0 : (double)s->dynamics.stretch_compliance,
                        is_pbd ? (double)s->dynamics.stretch_stiffness : 1.0, inverse_mass, h, force, body->edge );
}

static double total_mass( const scene_world* world )
{
    double mass = 0.0;
    for ( int body = 0; body < scene_world_moving_count( world ); ++body )
    {
        wisp_motion_stats m;
        mass += scene_world_motion_stats( world, body, &m, NULL ) == WISP_OK ? m.mass : 0.0;
    }
    return mass;
}

// Fill softness and burden of all bodies. The inputs are known.
static void find_softness( const scene_world* world, stability_trace* trace )
{
    const wisp_scene* scene = world->scene;
    const double mass = total_mass( world );
    for ( int i = 0; i < trace->body_count; ++i )
    {
        stability_body* b = &trace->bodies[i];
        // What stands on the body counts, as does the wind.
        const double force = mass * fmax( b->gravity, 1.0 ) + trace->inputs.drag + trace->inputs.lift;
        const int vertices = scene_world_body( world, i ).vertex_count;
        const double inverse_mass = b->mass > 0.0 ? vertices / b->mass : 0.0;
        b->burden = ( b->has_contact ? fmax( mass - b->mass, 0.0 ) * fmax( b->gravity, 1.0 ) : 0.0 ) +
                    trace->inputs.drag + trace->inputs.lift;
        if ( b->moves )
        {
            b->softness = i < scene->strands_count ? strands_softness( &scene->strands[i], b, inverse_mass, force )
                                                   : surface_softness( &scene->surfaces[i - scene->strands_count], b,
                                                                       inverse_mass, force );
        }
    }
}

// ---- inputs ----

// What a scene brings into motion by itself, from the scene alone: how fast, how far, until when, and with which
// energy. The judges compare a run with this.

static double length_of( wisp_vec3 v )
{
    return sqrt( (double)v.x * (double)v.x + (double)v.y * (double)v.y + (double)v.z * (double)v.z );
}

static double distance( wisp_vec3 a, wisp_vec3 b )
{
    return length_of( ( wisp_vec3 ){ a.x - b.x, a.y - b.y, a.z - b.z } );
}

// ---- bounds ----

typedef struct bounds
{
    wisp_vec3 lower, upper;
} bounds;

static const bounds NOTHING = { { FLT_MAX, FLT_MAX, FLT_MAX }, { -FLT_MAX, -FLT_MAX, -FLT_MAX } };

static void widen( bounds* b, wisp_vec3 p )
{
    b->lower = ( wisp_vec3 ){ fminf( b->lower.x, p.x ), fminf( b->lower.y, p.y ), fminf( b->lower.z, p.z ) };
    b->upper = ( wisp_vec3 ){ fmaxf( b->upper.x, p.x ), fmaxf( b->upper.y, p.y ), fmaxf( b->upper.z, p.z ) };
}

static double diagonal( const bounds* b )
{
    return b->lower.x <= b->upper.x ? distance( b->lower, b->upper ) : 0.0;
}

// Points of a collider's mesh, which a plane has too: those of the square that a picture shows.
static bounds bounds_of_collider( const scene_world* world, int collider )
{
    const scene_world_collider* c = &world->colliders[collider];
    bounds b = NOTHING;
    for ( int i = 0; i < c->mesh.vertex_count; ++i )
    {
        widen( &b, wisp_transform_to_world( world->scene->colliders[collider].def.pose, c->mesh.points[i] ) );
    }
    return b;
}

static const wisp_vec3* points_of( const scene_world* world, int body )
{
    const int strands = world->scene->strands_count;
    return body < strands ? world->grooms[body].points : world->surfaces[body - strands].mesh.points;
}

static double farthest( const bounds* b )
{
    const double x = fmax( fabs( (double)b->lower.x ), fabs( (double)b->upper.x ) );
    const double y = fmax( fabs( (double)b->lower.y ), fabs( (double)b->upper.y ) );
    const double z = fmax( fabs( (double)b->lower.z ), fabs( (double)b->upper.z ) );
    return b->lower.x <= b->upper.x ? fmax( x, fmax( y, z ) ) : 0.0;
}

static double find_extent( const scene_world* world, double* rounding )
{
    bounds all = NOTHING;
    int most = 0;
    for ( int body = 0; body < scene_world_moving_count( world ); ++body )
    {
        const wisp_vec3* points = points_of( world, body );
        const int count = scene_world_body( world, body ).vertex_count,
                  substeps = scene_world_substeps( world, body );
        most = substeps > most ? substeps : most;
        for ( int i = 0; i < count; ++i )
        {
            widen( &all, points[i] );
        }
    }
    for ( int i = 0; i < world->scene->collider_count; ++i )
    {
        const bounds b = bounds_of_collider( world, i );
        if ( world->scene->colliders[i].def.kind != WISP_COLLIDER_PLANE && b.lower.x <= b.upper.x )
        {
            widen( &all, b.lower );
            widen( &all, b.upper );
        }
    }
    *rounding = (double)FLT_EPSILON * farthest( &all ) * most / (double)world->scene->dt;
    return diagonal( &all );
}

// ---- drivers ----

static double shortest_step( const wisp_scene* scene )
{
    double shortest = (double)scene->dt;
    for ( int i = 0; i < scene->dt_factor_count; ++i )
    {
        shortest = fmin( shortest, (double)wisp_scene_step_length( scene, i ) );
    }
    return shortest;
}

// A path between two poses takes the time between them, but no less than a step. What turns moves the farther, the
// farther it is from the pivot.
static void add_path( const wisp_scene* scene, const wisp_scene_path* path, wisp_transform start, double reach,
                      stability_inputs* inputs )
{
    wisp_scene_pose before = { .pose = start };
    for ( int i = 0; i < path->count; ++i )
    {
        const wisp_scene_pose now = path->poses[i];
        const wisp_quat a = before.pose.rotation, b = now.pose.rotation;
        const double cosine = fabs( (double)a.x * (double)b.x + (double)a.y * (double)b.y +
                                    (double)a.z * (double)b.z + (double)a.w * (double)b.w );
        const double angle = 2.0 * acos( fmin( 1.0, cosine ) );
        const double way = distance( before.pose.translation, now.pose.translation ) + angle * reach;
        const double time = fmax( (double)now.time - (double)before.time, shortest_step( scene ) );
        inputs->path += way;
        inputs->speed = fmax( inputs->speed, way / time );
        inputs->last = fmax( inputs->last, (double)now.time );
        inputs->moves_pins = true;
        before = now;
    }
}

static void add_paths( const scene_world* world, stability_trace* trace )
{
    const wisp_scene* scene = world->scene;
    const wisp_transform still = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        const double size = trace->bodies[scene->strands_count + i].size;
        for ( int g = -1; g < scene->surfaces[i].pin_group_count; ++g )
        {
            const wisp_scene_pins* pins = g < 0 ? &scene->surfaces[i].pins : &scene->surfaces[i].pin_groups[g];
            add_path( scene, &pins->path, still, size + length_of( pins->pivot ), &trace->inputs );
        }
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        const wisp_scene_strands* s = &scene->strands[i];
        const wisp_vec3 pivot = s->has_head_pivot ? s->head_pivot : s->pose.translation;
        const wisp_transform start = { still.rotation, pivot };
        add_path( scene, &s->head, start, trace->bodies[i].size + distance( pivot, s->pose.translation ),
                  &trace->inputs );
    }
    for ( int i = 0; i < scene->collider_count; ++i )
    {
        const bounds b = bounds_of_collider( world, i );
        const bool is_plane = scene->colliders[i].def.kind == WISP_COLLIDER_PLANE;
        const double reach = is_plane ? 2.0 * trace->extent : diagonal( &b );
        add_path( scene, &scene->colliders[i].path, scene->colliders[i].def.pose, reach, &trace->inputs );
    }
}

// Bounding spheres of two colliders meet, or one reaches into a half space: what is between them can be squeezed.
static bool are_close( const scene_world* world, int a, int b )
{
    const wisp_collider_def *p = &world->scene->colliders[a].def, *q = &world->scene->colliders[b].def;
    const bounds s = bounds_of_collider( world, b );
    const double MARGIN = 0.05;
    const wisp_vec3 middle = { 0.5f * ( s.lower.x + s.upper.x ), 0.5f * ( s.lower.y + s.upper.y ),
                               0.5f * ( s.lower.z + s.upper.z ) };
    if ( q->kind == WISP_COLLIDER_PLANE )
    {
        return p->kind == WISP_COLLIDER_PLANE || are_close( world, b, a );
    }
    const wisp_vec3 local = wisp_transform_to_local( p->pose, middle );
    const double radius = 0.5 * diagonal( &s ) + MARGIN;
    const bounds r = bounds_of_collider( world, a );
    return p->kind == WISP_COLLIDER_PLANE ? (double)local.y < radius
                                          : length_of( local ) < radius + 0.5 * diagonal( &r );
}

static bool find_close_colliders( const scene_world* world )
{
    bool any = false;
    for ( int a = 0; a < world->scene->collider_count; ++a )
    {
        for ( int b = a + 1; b < world->scene->collider_count; ++b )
        {
            any |= are_close( world, a, b ) || world->scene->colliders[a].path.count > 0 ||
                   world->scene->colliders[b].path.count > 0;
        }
    }
    return any;
}

// ---- events, wind and gas ----

// Energy that gas of V_0 = r V at the pressure of the air sets free until it fills V, and the air that presses on a
// skin of too little gas: P V ( r ln r - r + 1 ).
static double gas_energy( const wisp_scene_surface* s, double ratio, double volume )
{
    return (double)s->balloon.atmospheric_pressure * volume * ( ratio * log( ratio ) - ratio + 1.0 );
}

static void add_balloon( const scene_world* world, int surface, stability_trace* trace )
{
    const wisp_scene* scene = world->scene;
    const wisp_scene_surface* s = &scene->surfaces[surface];
    const stability_body* body = &trace->bodies[scene->strands_count + surface];
    const double volume = pow( body->size, 3.0 );
    double most = (double)s->balloon.gas_ratio, sum = gas_energy( s, most, volume );
    for ( int i = 0; i < s->gas_ratio_keyframe_count; ++i )
    {
        most = fmax( most, (double)s->gas_ratio_keyframes[i].gas_ratio );
        sum += gas_energy( s, (double)s->gas_ratio_keyframes[i].gas_ratio, volume );
        trace->inputs.last = fmax( trace->inputs.last, (double)s->gas_ratio_keyframes[i].time );
    }
    for ( int i = 0; i < scene->event_count; ++i )
    {
        const wisp_scene_event* e = &scene->events[i];
        if ( e->surface == surface && e->has_gas_ratio )
        {
            most = fmax( most, (double)e->gas_ratio );
            sum += gas_energy( s, (double)e->gas_ratio, volume );
        }
    }
    const bool flows = s->balloon.inflation_rate != 0.0f,
               has_outlet = s->balloon.outlet_count > 0 || s->has_outlet_nearest;
    trace->inputs.last = flows || has_outlet ? INFINITY : trace->inputs.last;
    trace->inputs.gas += flows ? INFINITY : sum;
    const double AIR = (double)s->balloon.atmospheric_pressure * (double)s->balloon.air_molar_mass /
                       ( 8.314 * (double)s->balloon.temperature );
    trace->inputs.lift += s->balloon.buoyancy ? AIR * most * volume * body->gravity : 0.0;
    trace->inputs.lift +=
        has_outlet ? 2.0 * (double)s->balloon.atmospheric_pressure * (double)s->balloon.outlet_area * most : 0.0;
}

static void add_wind( stability_trace* trace, const stability_body* body, wisp_vec3 wind, double coefficient,
                      double density )
{
    const double speed = length_of( wind );
    if ( coefficient > 0.0 && speed > 0.0 )
    {
        trace->inputs.wind = fmax( trace->inputs.wind, speed );
        trace->inputs.drag += 0.5 * density * coefficient * body->area * speed * speed;
        trace->inputs.last = INFINITY;
    }
}

static void add_air( const scene_world* world, stability_trace* trace )
{
    const wisp_scene* scene = world->scene;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        const wisp_cloth_def* c = &scene->surfaces[i].cloth;
        if ( scene->surfaces[i].has_cloth )
        {
            add_wind( trace, &trace->bodies[scene->strands_count + i], c->wind,
                      fmax( (double)c->drag_coefficient, (double)c->lift_coefficient ), (double)c->air_density );
        }
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        const wisp_strand_dynamics_def* d = &scene->strands[i].dynamics;
        if ( scene->strands[i].has_dynamics )
        {
            add_wind( trace, &trace->bodies[i], d->wind, (double)d->drag_coefficient, (double)d->air_density );
        }
    }
}

// How often a vertex may get a gust: at most once for each of its triangles.
static int most_hits( const wisp_mesh* mesh, bool per_triangle )
{
    int most = 1;
    int* hits = per_triangle ? calloc( (size_t)mesh->vertex_count, sizeof( int ) ) : NULL;
    for ( int corner = 0; corner < 3 * mesh->triangle_count && hits != NULL; ++corner )
    {
        const int count = ++hits[mesh->triangles[corner]];
        most = count > most ? count : most;
    }
    most = per_triangle && hits == NULL ? mesh->triangle_count : most;
    free( hits );
    return most;
}

static void add_events( const scene_world* world, stability_trace* trace )
{
    const wisp_scene* scene = world->scene;
    double gusts = 0.0;
    for ( int i = 0; i < scene->event_count; ++i )
    {
        const wisp_scene_event* e = &scene->events[i];
        const int body = e->surface >= 0 ? scene->strands_count + e->surface : e->strands;
        trace->inputs.last = fmax( trace->inputs.last, wisp_scene_step_time( scene, e->step ) );
        if ( e->has_velocity || e->has_angular_velocity )
        {
            const double speed =
                length_of( e->velocity ) + length_of( e->angular_velocity ) * trace->bodies[body].size;
            trace->inputs.speed = fmax( trace->inputs.speed, speed );
        }
        if ( e->has_gust )
        {
            gusts += length_of( e->gust ) * most_hits( &world->surfaces[e->surface].mesh, e->gust_per_triangle );
        }
        if ( e->has_wind )
        {
            const bool is_surface = e->surface >= 0;
            const wisp_cloth_def* c = is_surface ? &scene->surfaces[e->surface].cloth : NULL;
            const wisp_strand_dynamics_def* d = is_surface ? NULL : &scene->strands[e->strands].dynamics;
            add_wind( trace, &trace->bodies[body], e->wind,
                      is_surface ? fmax( (double)c->drag_coefficient, (double)c->lift_coefficient )
                                 : (double)d->drag_coefficient,
                      is_surface ? (double)c->air_density : (double)d->air_density );
        }
    }
    trace->inputs.speed += gusts; // each comes on top
}

// ---- hair that starts bent ----

// A rod without a rest shape of its own stores ( EI + GJ ) angle^2 / 2 l at every vertex.
static double rod_energy( const wisp_scene_strands* s, const wisp_groom* groom )
{
    double sum = 0.0;
    for ( int strand = 0; strand < groom->strand_count; ++strand )
    {
        for ( int v = groom->offsets[strand] + 2; v < groom->offsets[strand + 1]; ++v )
        {
            const wisp_vec3 a = groom->points[v - 2], b = groom->points[v - 1], c = groom->points[v];
            const double ab = distance( a, b ), bc = distance( b, c ), ac = distance( a, c );
            const double cosine = ab > 0.0 && bc > 0.0 ? ( ac * ac - ab * ab - bc * bc ) / ( 2.0 * ab * bc ) : 1.0;
            const double angle = acos( fmax( -1.0, fmin( 1.0, cosine ) ) );
            sum += 2.0 * angle * angle / fmax( ab + bc, 1e-9 );
        }
    }
    return ( (double)s->dynamics.bend_rigidity + (double)s->dynamics.twist_rigidity ) * sum;
}

// ---- contact ----

// What does not take part in all contacts may pass through something, and is counted.
static bool is_left_out( const wisp_contact_def* contact )
{
    const wisp_contact_def all = wisp_default_contact_def();
    return !contact->self || !contact->enabled || contact->layers != all.layers || contact->mask != all.mask;
}

static bool may_intersect( const wisp_scene* scene )
{
    bool any = scene->contact.level != WISP_CONTACT_EXACT;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        const wisp_scene_surface* s = &scene->surfaces[i];
        any |= s->has_contact && is_left_out( &s->contact );
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        const wisp_scene_strands* s = &scene->strands[i];
        any |= s->has_contact && ( s->on_surface >= 0 || is_left_out( &s->contact ) );
    }
    return any;
}

// ---- bodies ----

static void measure_edge( stability_body* body, double* area, wisp_vec3 a, wisp_vec3 b, double width )
{
    const double length = distance( a, b );
    body->edge = length > 0.0 ? fmin( body->edge, length ) : body->edge;
    *area += length * width;
}

// The rest shape in the order of the user, whatever the body starts as.
static wisp_vec3* rest_of( const scene_world* world, int body, int count )
{
    wisp_vec3* rest = text_alloc( (size_t)count * sizeof *rest );
    stability_reader* r = stability_reader_make( world, body );
    for ( int v = 0; v < count; ++v )
    {
        rest[v] = !r->moves ? points_of( world, body )[v] : r->rest[r->fabric ? r->fabric->vertex_slot[v] : v];
    }
    stability_reader_free( r );
    return rest;
}

static void measure_body( const scene_world* world, int body, stability_body* b )
{
    const scene_body shape = scene_world_body( world, body );
    wisp_vec3* p = rest_of( world, body, shape.vertex_count );
    const double diameter =
        body < world->scene->strands_count ? (double)world->scene->strands[body].dynamics.diameter : 0.0;
    bounds box = NOTHING;
    b->edge = INFINITY;
    for ( int i = 0; i < shape.vertex_count; ++i )
    {
        widen( &box, p[i] );
    }
    b->size = diagonal( &box );
    b->extent = fmax( (double)box.upper.x - (double)box.lower.x,
                      fmax( (double)box.upper.y - (double)box.lower.y, (double)box.upper.z - (double)box.lower.z ) );
    for ( int t = 0; t < shape.triangle_count; ++t )
    {
        const int32_t* v = shape.triangles + 3 * t;
        const double c = distance( p[v[0]], p[v[1]] );
        measure_edge( b, &b->area, p[v[0]], p[v[1]], 0.0 );
        measure_edge( b, &b->area, p[v[1]], p[v[2]], 0.5 * c );
        measure_edge( b, &b->area, p[v[2]], p[v[0]], 0.0 );
    }
    for ( int s = 0; s < shape.strand_count; ++s )
    {
        for ( int v = shape.offsets[s] + 1; v < shape.offsets[s + 1]; ++v )
        {
            measure_edge( b, &b->area, p[v - 1], p[v], diameter );
        }
    }
    free( p );
}

static void describe_body( const scene_world* world, int body, stability_body* b )
{
    const wisp_scene* scene = world->scene;
    const bool is_strands = body < scene->strands_count;
    const wisp_scene_strands* hair = is_strands ? &scene->strands[body] : NULL;
    const wisp_scene_surface* surface = is_strands ? NULL : &scene->surfaces[body - scene->strands_count];
    snprintf( b->name, sizeof b->name, "%s", scene_world_body( world, body ).name );
    b->moves = is_strands ? hair->has_dynamics : true;
    const int substeps = scene_world_substeps( world, body );
    b->substep = (double)scene->dt / substeps;
    b->shortest = shortest_step( scene ) / substeps;
    const int carrier = is_strands ? hair->on_surface : -1;
    b->is_carried = carrier >= 0 && !scene->surfaces[carrier].has_collision;
    b->is_pinned = is_strands || world->surfaces[body - scene->strands_count].pin_count > 0;
    b->gravity = length_of( is_strands ? hair->dynamics.gravity : surface->gravity );
    b->damping = is_strands ? (double)hair->dynamics.damping : (double)surface->damping;
    b->has_contact = is_strands ? hair->has_contact : surface->has_contact;
    b->pin_count = is_strands ? 0 : world->surfaces[body - scene->strands_count].pin_count;
    b->starts_away = is_strands ? hair->has_start
                                : ( surface->has_start || length_of( surface->velocity ) > 0.0f ||
                                    length_of( surface->angular_velocity ) > 0.0f );
    b->is_uneven = ( is_strands ? hair->mass_ratio : surface->mass_ratio ) != 1.0f;
    b->twin = INFINITY;
    wisp_motion_stats m;
    b->mass = b->moves && scene_world_motion_stats( world, body, &m, NULL ) == WISP_OK ? m.mass : 0.0;
    measure_body( world, body, b );
}

// Bodies as they start, and the inputs. Fills all of both but what the run shows.
static void find_inputs( const scene_world* world, stability_trace* trace )
{
    const wisp_scene* scene = world->scene;
    trace->inputs = ( stability_inputs ){ 0 };
    trace->extent = find_extent( world, &trace->rounding );
    for ( int body = 0; body < trace->body_count; ++body )
    {
        describe_body( world, body, &trace->bodies[body] );
    }
    add_paths( world, trace );
    trace->inputs.may_intersect = may_intersect( scene );
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        trace->inputs.gains_energy |= scene->surfaces[i].solve_order == WISP_SOLVE_ORDER_LIST;
        if ( scene->surfaces[i].has_balloon )
        {
            add_balloon( world, i, trace );
        }
    }
    for ( int i = 0; i < world->scene->surface_count; ++i )
    {
        // what a surface stores that starts away from its rest shape is not known
        trace->inputs.rods += world->scene->surfaces[i].has_start ? INFINITY : 0.0;
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        const wisp_scene_strands* s = &scene->strands[i];
        const bool is_straightened = s->has_dynamics && s->dynamics.bending == WISP_STRAND_BEND_ROD &&
                                     s->dynamics.rest == WISP_STRAND_REST_STRAIGHT;
        // A grid that pushes strands apart works on them as long as they are close.
        trace->inputs.rods += s->has_start ? INFINITY : 0.0;
        trace->inputs.rods += s->has_grid && s->grid.repulsion > 0.0f ? INFINITY : 0.0;
        trace->inputs.rods += is_straightened ? rod_energy( s, &world->grooms[i] ) : 0.0;
    }
    add_air( world, trace );
    add_events( world, trace );
    int touching = 0;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        touching += trace->bodies[body].has_contact ? 1 : 0;
    }
    trace->inputs.is_uneven = scene->dt_factor_count > 0 || touching > 1;
    trace->inputs.has_events = scene->event_count > 0;
    trace->inputs.works = trace->inputs.lift > 0.0 || trace->inputs.drag > 0.0;
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        const wisp_scene_strands* s = &scene->strands[i];
        trace->inputs.works |= s->on_surface >= 0 || ( s->has_grid && s->grid.repulsion > 0.0f );
    }
    trace->inputs.has_colliders_close = find_close_colliders( world );
    find_softness( world, trace );
}

// ---- a run ----

// ---- samples ----

static bool collides( const wisp_scene* scene, int body )
{
    return body < scene->strands_count ? scene->strands[body].has_collision
                                       : scene->surfaces[body - scene->strands_count].has_collision;
}

static bool are_finite( const wisp_vec3* points, int count )
{
    bool is_finite = true;
    for ( int i = 0; i < count; ++i )
    {
        is_finite &= isfinite( points[i].x ) && isfinite( points[i].y ) && isfinite( points[i].z );
    }
    return is_finite;
}

static bool is_layer_finite( const scene_world* world, int surface )
{
    wisp_boundary_view view;
    bool is_finite = scene_world_layer( world, surface, &view, NULL ) == WISP_OK;
    for ( int i = 0; is_finite && i < view.samples->count * 4; ++i )
    {
        is_finite = i % 4 == 3 || isfinite( view.samples->xyzw[i] );
    }
    return is_finite;
}

static void sample_motion( const scene_world* world, int body, stability_sample* sample )
{
    wisp_motion_stats m;
    if ( scene_world_motion_stats( world, body, &m, NULL ) == WISP_OK )
    {
        sample->kinetic = m.kinetic_energy;
        sample->potential = m.potential_energy;
        sample->speed = m.speed_max;
        memcpy( sample->centre, m.centre, sizeof m.centre );
        sample->is_finite &=
            isfinite( m.kinetic_energy ) && isfinite( m.potential_energy ) && isfinite( m.speed_max );
    }
}

static void sample_body( const scene_world* world, stability_trace* trace, int body, int row, wisp_vec3* points,
                         stability_sample* sample )
{
    const scene_body shape = scene_world_body( world, body );
    sample->is_finite =
        scene_world_points( world, body, points, NULL ) != WISP_OK || are_finite( points, shape.vertex_count );
    if ( trace->bodies[body].moves )
    {
        sample_motion( world, body, sample );
    }
    wisp_collision_stats stats;
    if ( collides( world->scene, body ) && scene_world_collision_stats( world, body, &stats, NULL ) == WISP_OK )
    {
        sample->penetration = stats.vertex >= 0 ? (double)stats.penetration : 0.0;
        sample->thickness = (double)stats.thickness;
        sample->contacts = stats.contacts;
    }
    if ( trace->start )
    {
        stability_measure_near( world, body, points, sample, row, trace );
    }
}

static void sample_all( const scene_world* world, stability_trace* trace, int row, wisp_vec3* points )
{
    trace->times[row] = scene_world_time( world );
    for ( int body = 0; body < trace->body_count; ++body )
    {
        sample_body( world, trace, body, row, points, stability_sample_of( trace, row, body ) );
    }
}

// @param readers [body_count]
static void read_all( const scene_world* world, stability_reader* const* readers, stability_trace* trace, int row )
{
    const double dt = row > 0 ? trace->times[row] - trace->times[row - 1] : 0.0;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        stability_sample* sample = stability_sample_of( trace, row, body );
        // a step however short moves what starts away from its rest shape
        sample->is_finite |= row == 0 && trace->bodies[body].starts_away;
        stability_read( readers[body], world, &trace->bodies[body], dt, sample );
    }
    for ( int i = 0; i < world->scene->surface_count && row > 0; ++i )
    {
        stability_sample* sample = stability_sample_of( trace, row, world->scene->strands_count + i );
        sample->is_finite &= !world->scene->surfaces[i].has_boundary || is_layer_finite( world, i );
    }
}

// ---- the end ----

static double stretch_of_edge( const wisp_vec3* now, const wisp_vec3* rest, int a, int b )
{
    const double length = wisp_mesh_distance( rest[a], rest[b] );
    return length > 0.0 ? wisp_mesh_distance( now[a], now[b] ) / length - 1.0 : 0.0;
}

static double find_depth( const stability_reader* r, const wisp_vec3* start, double extent )
{
    double lowest = INFINITY, highest = -INFINITY;
    for ( int i = 0; i < r->count; ++i )
    {
        lowest = fmin( lowest, (double)r->now[i].y );
        highest = fmax( highest, (double)start[i].y );
    }
    return extent > 0.0 ? ( highest - lowest ) / extent : 0.0;
}

static void read_end( const scene_world* world, stability_trace* trace )
{
    for ( int body = 0; body < trace->body_count; ++body )
    {
        uint64_t hash = 0;
        const bool is_strands = body < world->scene->strands_count;
        (void)wisp_world_hash_column( world->world, scene_world_entity( world, body ),
                                      is_strands ? WISP_STRAND_POINTS : WISP_SURFACE_POINTS, &hash );
        trace->hash = body > 0 ? wisp_random_mix( trace->hash ^ hash ) : hash;
    }
    trace->resets = wisp_world_counter( world->world, WISP_COUNT_STRAND_RESET );
    trace->not_converged = wisp_world_counter( world->world, WISP_COUNT_NOT_CONVERGED );
    trace->degenerate = wisp_world_counter( world->world, WISP_COUNT_DEGENERATE_LINK );
}

static void finish_bodies( const scene_world* world, stability_reader* const* readers, stability_trace* trace )
{
    for ( int body = 0; body < trace->body_count; ++body )
    {
        stability_body* b = &trace->bodies[body];
        const stability_reader* r = readers[body];
        b->is_halted = wisp_is_halted( world->world, scene_world_entity( world, body ) );
        for ( int i = 0; i < r->edge_count; ++i )
        {
            b->stretch = fmax( b->stretch, stretch_of_edge( r->now, r->rest, r->edges[2 * i], r->edges[2 * i + 1] ) );
        }
    }
}

// ---- the run ----

// Masses and the energy of the start, from a step that is too short to change anything.
static wisp_status sample_start( const wisp_scene* scene, stability_trace* trace, wisp_vec3* points,
                                 wisp_error* error )
{
    const float MOMENT = 1e-6f;
    scene_world world;
    const scene_world_options options = { .workers = 1, .is_quiet = true };
    WISP_TRY( scene_world_create( scene, &options, &world, error ) );
    wisp_status status = wisp_world_step( world.world, MOMENT );
    status = status == WISP_OK ? WISP_OK : wisp_fail( error, status, "%s", wisp_world_message( world.world ) );
    if ( status == WISP_OK )
    {
        find_inputs( &world, trace );
        sample_all( &world, trace, 0, points );
        trace->times[0] = 0.0;
        for ( int body = 0; body < trace->body_count; ++body )
        {
            const stability_sample* s = stability_sample_of( trace, 0, body );
            memcpy( trace->bodies[body].start, s->centre, sizeof s->centre );
            trace->bodies[body].starts_inside = s->penetration > s->thickness;
        }
    }
    scene_world_destroy( &world );
    return status;
}

static int count_intersections( scene_world* world )
{
    wisp_contact_stats stats;
    return wisp_read_contact_stats( world->world, &stats ) == WISP_OK ? stats.intersections : -1;
}

static bool is_finite_row( const stability_trace* trace, int row )
{
    bool is_finite = true;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        is_finite &= stability_sample_of( trace, row, body )->is_finite;
    }
    return is_finite;
}

// Counting intersections costs a search, so only the first and the last step are asked for it.
static void make_steps( scene_world* world, stability_reader* const* readers, stability_trace* trace,
                        wisp_vec3* points )
{
    const int steps = world->scene->steps;
    const bool counts = scene_has_contact( world->scene ), counts_all = counts && world->scene->request_intersections;
    wisp_error error = { 0 };
    for ( int step = 0;
          step < steps && trace->status == WISP_OK && is_finite_row( trace, step ) && !interruption_came(); ++step )
    {
        const bool is_end = step == 0 || step + 1 == steps;
        if ( counts && !counts_all && ( step < 2 || is_end ) )
        {
            (void)wisp_request_contact_stats( world->world, is_end, is_end );
        }
        trace->status = scene_world_step( world, &error );
        if ( trace->status != WISP_OK )
        {
            snprintf( trace->message, sizeof trace->message, "%s", error.message );
            return;
        }
        trace->steps = step + 1;
        sample_all( world, trace, step + 1, points );
        read_all( world, readers, trace, step + 1 );
        trace->intersections_before =
            step == 0 && counts ? count_intersections( world ) : trace->intersections_before;
        trace->intersections_after = is_end && counts ? count_intersections( world ) : -1;
        const int now = step > 0 && counts_all ? count_intersections( world ) : -1;
        trace->intersections_most = now > trace->intersections_most ? now : trace->intersections_most;
    }
}

wisp_status stability_trace_run( wisp_scene* scene, const stability_limits* limits, stability_trace* out,
                                 wisp_error* error )
{
    const size_t bodies = (size_t)scene->strands_count + (size_t)scene->surface_count;
    const size_t rows = (size_t)scene->steps + 1;
    *out = ( stability_trace ){ .body_count = (int)bodies,
                                .limits = limits,
                                .steps_most = scene->steps,
                                .intersections_before = -1,
                                .intersections_after = -1,
                                .intersections_most = -1 };
    scene_request_statistics( scene );
    scene_world world;
    const scene_world_options options = { .workers = 1, .is_quiet = true };
    WISP_TRY( scene_world_create( scene, &options, &world, error ) );
    out->bodies = text_alloc( bodies * sizeof *out->bodies );
    out->samples = text_alloc( rows * bodies * sizeof *out->samples );
    out->times = text_alloc( rows * sizeof *out->times );
    out->near = text_alloc( rows * (size_t)( limits ? limits->near_count : 0 ) * sizeof *out->near );
    for ( size_t i = 0; limits && i < rows * (size_t)limits->near_count; ++i )
    {
        out->near[i] = NAN;
    }
    const size_t vertices = (size_t)scene_world_vertices( &world );
    wisp_vec3* points = text_alloc( vertices * sizeof *points );
    out->start = limits && limits->near_count > 0 ? text_alloc( vertices * sizeof *points ) : NULL;
    stability_reader** readers = text_alloc( bodies * sizeof *readers );
    wisp_status status = sample_start( scene, out, points, error );
    if ( status == WISP_OK )
    {
        for ( size_t body = 0; body < bodies; ++body )
        {
            readers[body] = stability_reader_make( &world, (int)body );
        }
        read_all( &world, readers, out, 0 );
        wisp_vec3* start = text_alloc( bodies > 0 ? (size_t)readers[0]->count * sizeof *start : 1 );
        memcpy( start, bodies > 0 ? readers[0]->now : start,
                bodies > 0 ? (size_t)readers[0]->count * sizeof *start : 0 );
        make_steps( &world, readers, out, points );
        finish_bodies( &world, readers, out );
        read_end( &world, out );
        out->depth = bodies > 0 ? find_depth( readers[0], start, out->bodies[0].extent ) : 0.0;
        free( start );
    }
    for ( size_t body = 0; body < bodies; ++body )
    {
        stability_reader_free( readers[body] );
    }
    free( readers );
    free( points );
    scene_world_destroy( &world );
    return status;
}

void stability_trace_release( stability_trace* trace )
{
    free( trace->bodies );
    free( trace->samples );
    free( trace->times );
    free( trace->near );
    free( trace->start );
    *trace = ( stability_trace ){ 0 };
}
