// Measures of a body over a run that must come near a value: a closed form, a measurement.
#include "stability_judges.h"
#include "stability_parts.h"

#include "mesh.h"
#include "strands.h"
#include "text_tree.h"
#include "wisp/sleep.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- what is measured ----

typedef struct stability_seen seen;

static double coordinate_of( wisp_vec3 p, int axis )
{
    return (double)( axis == 0 ? p.x : axis == 1 ? p.y : p.z );
}

static double tip( const seen* s, int axis )
{
    return coordinate_of( s->at[s->shape.vertex_count - 1], axis );
}

static double mean( const seen* s, int axis )
{
    double sum = 0.0;
    for ( int v = 0; v < s->shape.vertex_count; ++v )
    {
        sum += coordinate_of( s->at[v], axis );
    }
    return sum / s->shape.vertex_count;
}

static double extreme( const seen* s, int axis, double sign )
{
    double most = -INFINITY;
    for ( int v = 0; v < s->shape.vertex_count; ++v )
    {
        most = fmax( most, sign * coordinate_of( s->at[v], axis ) );
    }
    return sign * most;
}

static double least( const seen* s, int axis )
{
    return extreme( s, axis, -1.0 );
}

static double most( const seen* s, int axis )
{
    return extreme( s, axis, 1.0 );
}

// The farthest that a vertex is from where it started.
static double drift( const seen* s, int axis )
{
    (void)axis;
    double farthest = 0.0;
    for ( int v = 0; v < s->shape.vertex_count; ++v )
    {
        farthest = fmax( farthest, wisp_mesh_distance( s->at[v], s->start[v] ) );
    }
    return farthest;
}

// The mean of strands.
static double length( const seen* s, int axis )
{
    (void)axis;
    double sum = 0.0;
    for ( int k = 0; k < s->shape.strand_count; ++k )
    {
        for ( int v = s->shape.offsets[k] + 1; v < s->shape.offsets[k + 1]; ++v )
        {
            sum += wisp_mesh_distance( s->at[v], s->at[v - 1] );
        }
    }
    return s->shape.strand_count > 0 ? sum / s->shape.strand_count : NAN;
}

// Of the segment at the first root.
static double tension( const seen* s, int axis )
{
    float* all = text_alloc( (size_t)s->shape.vertex_count * sizeof *all );
    const bool is_read = axis == 0 && s->shape.strand_count > 0 &&
                         wisp_read_strand_tension( s->world->world, s->entity, all ) == WISP_OK;
    const double at_root = is_read ? (double)all[0] : NAN;
    free( all );
    return at_root;
}

static double volume( const seen* s, int axis )
{
    (void)axis;
    double sum = 0.0;
    for ( int t = 0; t < s->shape.triangle_count; ++t )
    {
        const int32_t* corner = s->shape.triangles + 3 * (size_t)t;
        const wisp_vec3 a = s->at[corner[0]], b = s->at[corner[1]], c = s->at[corner[2]];
        sum += (double)a.x * ( (double)b.y * (double)c.z - (double)b.z * (double)c.y ) +
               (double)a.y * ( (double)b.z * (double)c.x - (double)b.x * (double)c.z ) +
               (double)a.z * ( (double)b.x * (double)c.y - (double)b.y * (double)c.x );
    }
    return sum / 6.0;
}

#define VECTOR( name, value )                                                                                        \
    static double name( const seen* s, int axis )                                                                    \
    {                                                                                                                \
        return ( value )[axis];                                                                                      \
    }
VECTOR( momentum, s->motion.momentum )
VECTOR( spin, s->motion.angular_momentum )
VECTOR( centre, s->motion.centre )
VECTOR( buoyancy, s->balloon.buoyancy )
VECTOR( drag, s->balloon.drag )
VECTOR( jet, s->balloon.jet )
VECTOR( torque, s->balloon.torque )
VECTOR( turning, s->balloon.angular_velocity )

// What contact gave the body in the last step.
static double impulse( const seen* s, int axis )
{
    double given[3];
    return wisp_read_contact_impulse( s->world->world, s->entity, given ) == WISP_OK ? given[axis] : NAN;
}

#define SCALAR( name, value )                                                                                        \
    static double name( const seen* s, int axis )                                                                    \
    {                                                                                                                \
        return axis == 0 ? ( value ) : NAN;                                                                          \
    }
SCALAR( speed, s->motion.speed_max )
SCALAR( kinetic, s->motion.kinetic_energy )
SCALAR( potential, s->motion.potential_energy )
SCALAR( mass, s->motion.mass )
SCALAR( strain, s->motion.strain_max )
SCALAR( mean_strain, s->motion.strain_mean )
SCALAR( contacts, (double)s->sample->contacts )
SCALAR( penetration, s->sample->penetration )
SCALAR( pressure, s->balloon.pressure )
SCALAR( rest_volume, s->balloon.rest_volume )
SCALAR( gas, s->balloon.target_volume )
SCALAR( lost, s->balloon.gas_lost )
SCALAR( outflow, s->balloon.outlet_speed )
SCALAR( resets, (double)wisp_world_counter( s->world->world, WISP_COUNT_STRAND_RESET ) )
SCALAR( sagging, (double)wisp_world_counter( s->world->world, WISP_COUNT_SAGGING ) )
SCALAR( stretched, (double)wisp_world_counter( s->world->world, WISP_COUNT_STRETCHED ) )
SCALAR( lightened, (double)wisp_world_counter( s->world->world, WISP_COUNT_GRAVITY_SCALED ) )

SCALAR( limited, (double)wisp_world_counter( s->world->world, WISP_COUNT_SPEED_LIMITED ) )
SCALAR( solves, (double)s->implicit.newton_iterations )
SCALAR( first_order, (double)wisp_world_counter( s->world->world, WISP_COUNT_FIRST_ORDER ) )
SCALAR( softened, (double)wisp_world_counter( s->world->world, WISP_COUNT_STIFFNESS_CLAMPED ) )
SCALAR( asleep, wisp_is_asleep( s->world->world, s->entity ) ? 1.0 : 0.0 )
SCALAR( held, (double)( s->implicit.sticking + s->implicit.sliding ) )
SCALAR( crossings, (double)s->contact.intersections )
SCALAR( gap, (double)s->contact.min_gap )
SCALAR( splits, (double)s->tearing.split_count )

// Of the body in its last step.
static double substeps( const seen* s, int axis )
{
    int count = 0;
    return axis == 0 && wisp_read_substeps( s->world->world, s->entity, &count ) == WISP_OK ? (double)count : NAN;
}

static const struct
{
    const char* name;
    double ( *of )( const seen* s, int axis );
    bool has_axis;
} MEASURES[] = {
    { "tip", tip, true },
    { "mean", mean, true },
    { "min", least, true },
    { "max", most, true },
    { "centre", centre, true },
    { "momentum", momentum, true },
    { "spin", spin, true },
    { "buoyancy", buoyancy, true },
    { "drag", drag, true },
    { "jet", jet, true },
    { "torque", torque, true },
    { "turning", turning, true },
    { "impulse", impulse, true },
    { "speed", speed, false },
    { "kinetic", kinetic, false },
    { "potential", potential, false },
    { "mass", mass, false },
    { "strain", strain, false },
    { "mean_strain", mean_strain, false },
    { "drift", drift, false },
    { "length", length, false },
    { "tension", tension, false },
    { "contacts", contacts, false },
    { "penetration", penetration, false },
    { "volume", volume, false },
    { "rest_volume", rest_volume, false },
    { "pressure", pressure, false },
    { "gas", gas, false },
    { "lost", lost, false },
    { "outflow", outflow, false },
    { "resets", resets, false },
    { "sagging", sagging, false },
    { "stretched", stretched, false },
    { "lightened", lightened, false },
    { "limited", limited, false },
    { "substeps", substeps, false },
    { "solves", solves, false },
    { "first_order", first_order, false },
    { "softened", softened, false },
    { "asleep", asleep, false },
    { "held", held, false },
    { "crossings", crossings, false },
    { "gap", gap, false },
    { "splits", splits, false },
};
const char* const stability_near_takes[STABILITY_TAKE_COUNT] = { "end", "mean", "min", "max", "period", "change" };

const char* stability_near_words( void )
{
    static char words[600];
    int used = snprintf( words, sizeof words, "v12, v4-v7" );
    for ( int i = 0; i < WISP_COUNT( MEASURES ); ++i )
    {
        const bool is_last_point = MEASURES[i].has_axis && !MEASURES[i + 1].has_axis;
        used += snprintf( words + used, sizeof words - (size_t)used, ", %s%s", MEASURES[i].name,
                          is_last_point ? " (each with an axis, or three values)" : "" );
    }
    return words;
}

// The number of a vertex. @return behind it, null if it is none
static const char* parse_vertex( const char* text, int* vertex )
{
    char* end = NULL;
    *vertex = text[0] == 'v' && text[1] >= '0' && text[1] <= '9' ? (int)strtol( text + 1, &end, 10 ) : -1;
    return end;
}

// A measure by its name, a vertex by its number, or the distance of two.
static bool find_measure( const char* text, size_t size, bool has_axis, stability_near* out )
{
    for ( int i = 0; i < WISP_COUNT( MEASURES ); ++i )
    {
        if ( MEASURES[i].has_axis == has_axis && strlen( MEASURES[i].name ) == size &&
             memcmp( text, MEASURES[i].name, size ) == 0 )
        {
            out->measure = i;
            return true;
        }
    }
    out->measure = -1;
    const char* end = parse_vertex( text, &out->vertex );
    if ( has_axis == false && end != NULL && *end == '-' )
    {
        return parse_vertex( end + 1, &out->other ) == text + size;
    }
    return has_axis && end == text + size;
}

bool stability_near_parse( const char* of, stability_near* out )
{
    const char* dot = strrchr( of, '.' );
    if ( dot == NULL || dot == of || strlen( of ) >= sizeof out->of )
    {
        return false;
    }
    snprintf( out->of, sizeof out->of, "%s", of );
    out->name_length = (int)( dot - of );
    out->axis = 0;
    out->other = -1;
    if ( find_measure( dot + 1, strlen( dot + 1 ), false, out ) )
    {
        return true;
    }
    const char* point = dot - 1;
    while ( point > of && *point != '.' )
    {
        --point;
    }
    out->axis = dot[1] - 'x';
    out->name_length = (int)( point - of );
    return dot[1] >= 'x' && dot[1] <= 'z' && dot[2] == '\0' && point > of &&
           find_measure( point + 1, (size_t)( dot - point - 1 ), true, out );
}

static bool is_sum( const stability_near* near )
{
    return near->name_length == 1 && near->of[0] == '*';
}

static bool is_body( const stability_near* near, const scene_body* body )
{
    return is_sum( near ) || ( (int)strlen( body->name ) == near->name_length &&
                               strncmp( body->name, near->of, (size_t)near->name_length ) == 0 );
}

void stability_measure_near( const scene_world* world, int body, const wisp_vec3* at, const stability_sample* sample,
                             int row, stability_trace* trace )
{
    seen s = { .world = world,
               .entity = scene_world_entity( world, body ),
               .shape = scene_world_body( world, body ),
               .at = at,
               .start = trace->start,
               .sample = sample };
    for ( int i = 0; i < body; ++i )
    {
        s.start += scene_world_body( world, i ).vertex_count;
    }
    if ( row == 0 )
    {
        memcpy( trace->start + ( s.start - trace->start ), at, (size_t)s.shape.vertex_count * sizeof *at );
    }
    (void)scene_world_motion_stats( world, body, &s.motion, NULL );
    (void)wisp_read_balloon_stats( world->world, s.entity, &s.balloon );
    (void)wisp_read_implicit_cloth_stats( world->world, s.entity, &s.implicit );
    (void)wisp_read_contact_stats( world->world, &s.contact );
    (void)wisp_read_tearing_stats( world->world, s.entity, &s.tearing );
    for ( int i = 0; trace->limits && i < trace->limits->near_count; ++i )
    {
        const stability_near* near = &trace->limits->near[i];
        const bool has_vertices = near->vertex < s.shape.vertex_count && near->other < s.shape.vertex_count;
        if ( is_body( near, &s.shape ) && ( near->measure >= 0 || has_vertices ) )
        {
            double* value = trace->near + (size_t)i * (size_t)( trace->steps_most + 1 ) + (size_t)row;
            *value = ( is_sum( near ) && body > 0 ? *value : 0.0 ) +
                     ( near->measure >= 0 ? MEASURES[near->measure].of( &s, near->axis )
                       : near->other >= 0 ? wisp_mesh_distance( at[near->vertex], at[near->other] )
                                          : coordinate_of( at[near->vertex], near->axis ) );
        }
    }
}

// ---- what is taken of a run ----

// Mean time between passes through the mean from below, by linear interpolation between steps. @return NaN: fewer than two passes
static double period_of( const double* value, const double* time, int first, int last, double mean )
{
    double begin = NAN, end = NAN;
    int count = -1;
    for ( int row = first; row < last; ++row )
    {
        const double a = value[row] - mean, b = value[row + 1] - mean;
        if ( a < 0.0 && b >= 0.0 )
        {
            end = time[row] + ( time[row + 1] - time[row] ) * a / ( a - b );
            begin = count < 0 ? end : begin;
            ++count;
        }
    }
    return count > 0 ? ( end - begin ) / count : NAN;
}

static double taken_of( const stability_near* near, const stability_trace* trace, const double* value )
{
    int first = near->take == STABILITY_TAKE_END && !( near->at > 0.0 ) ? trace->steps : 0;
    while ( first < trace->steps && trace->times[first] < near->at - 1e-9 )
    {
        ++first;
    }
    double sum = 0.0, least = INFINITY, most = -INFINITY;
    for ( int row = first; row <= trace->steps; ++row )
    {
        sum += value[row];
        least = fmin( least, value[row] );
        most = fmax( most, value[row] );
    }
    const double mean = sum / ( trace->steps - first + 1 );
    return near->take == STABILITY_TAKE_END      ? value[first]
           : near->take == STABILITY_TAKE_MEAN   ? mean
           : near->take == STABILITY_TAKE_MIN    ? least
           : near->take == STABILITY_TAKE_MAX    ? most
           : near->take == STABILITY_TAKE_CHANGE ? value[trace->steps] - value[first]
                                                 : period_of( value, trace->times, first, trace->steps, mean );
}

bool stability_judge_near( const stability_trace* trace, const stability_limits* limits, stability_verdict* out )
{
    for ( int i = 0; i < limits->near_count; ++i )
    {
        const stability_near* near = &limits->near[i];
        const double found = taken_of( near, trace, trace->near + (size_t)i * (size_t)( trace->steps_most + 1 ) );
        const double off = fabs( found - near->value );
        if ( !( off <= near->within ) )
        {
            *out = ( stability_verdict ){ .check = STABILITY_NEAR,
                                          .step = trace->steps,
                                          .severity = isfinite( off ) ? off / near->within : INFINITY };
            char when[40] = "";
            if ( isnan( found ) )
            {
                snprintf( out->message, sizeof out->message,
                          "%s has no value: no such body or vertex, or no two passes through the mean", near->of );
                return false;
            }
            snprintf( when, sizeof when, near->at > 0.0 ? " from %.4g s" : "", near->at );
            snprintf( out->message, sizeof out->message, "%s%s%s%s is %.9g, expected %.9g within %.3g%s%s", near->of,
                      near->take == STABILITY_TAKE_END ? "" : ", ",
                      near->take == STABILITY_TAKE_END ? "" : stability_near_takes[near->take], when, found,
                      near->value, near->within, near->from[0] ? ": " : "", near->from );
            return false;
        }
    }
    return true;
}
