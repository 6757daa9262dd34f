// Measures of a body over a run that must come near a value: a closed form, a measurement.
#include "stability_judges.h"
#include "stability_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- what is measured ----

enum
{
    TIP,    // the last vertex
    VERTEX, // by number
    MEAN,   // of all vertices
    LEAST,
    MOST,
    CENTRE, // of mass
    MOMENTUM,
    SPIN, // angular momentum about the centre of mass
    SPEED,
    KINETIC,
    POTENTIAL,
    VOLUME,
};

static const char* const point_words[] = { "tip", "v", "mean", "min", "max", "centre", "momentum", "spin" };
static const char* const scalar_words[] = { "speed", "kinetic", "potential", "volume" };
const char* const stability_near_takes[STABILITY_TAKE_COUNT] = { "end", "mean", "min", "max", "period", "change" };

static bool parse_point( const char* text, size_t length, stability_near* out )
{
    for ( int i = 0; i < WISP_COUNT( point_words ); ++i )
    {
        const size_t word = strlen( point_words[i] );
        if ( i != VERTEX && length == word && memcmp( text, point_words[i], word ) == 0 )
        {
            out->kind = i;
            return true;
        }
    }
    char* end = NULL;
    out->kind = VERTEX;
    out->vertex = text[0] == 'v' && text[1] >= '0' && text[1] <= '9' ? (int)strtol( text + 1, &end, 10 ) : -1;
    return end == text + length && out->vertex >= 0;
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
    for ( int i = 0; i < WISP_COUNT( scalar_words ); ++i )
    {
        if ( strcmp( dot + 1, scalar_words[i] ) == 0 )
        {
            out->kind = SPEED + i;
            return true;
        }
    }
    const char* point = dot - 1;
    while ( point > of && *point != '.' )
    {
        --point;
    }
    out->axis = dot[1] - 'x';
    out->name_length = (int)( point - of );
    return dot[1] >= 'x' && dot[1] <= 'z' && dot[2] == '\0' && point > of &&
           parse_point( point + 1, (size_t)( dot - point - 1 ), out );
}

static double coordinate_of( const stability_near* near, wisp_vec3 p )
{
    return (double)( near->axis == 0 ? p.x : near->axis == 1 ? p.y : p.z );
}

static double enclosed_volume( const scene_body* body, const wisp_vec3* at )
{
    double sum = 0.0;
    for ( int t = 0; t < body->triangle_count; ++t )
    {
        const int32_t* corner = body->triangles + 3 * (size_t)t;
        const wisp_vec3 a = at[corner[0]], b = at[corner[1]], c = at[corner[2]];
        sum += (double)a.x * ( (double)b.y * (double)c.z - (double)b.z * (double)c.y ) +
               (double)a.y * ( (double)b.z * (double)c.x - (double)b.x * (double)c.z ) +
               (double)a.z * ( (double)b.x * (double)c.y - (double)b.y * (double)c.x );
    }
    return sum / 6.0;
}

static double extreme_of( const stability_near* near, const wisp_vec3* at, int count )
{
    const double sign = near->kind == LEAST ? -1.0 : 1.0;
    double most = -INFINITY;
    for ( int v = 0; v < count; ++v )
    {
        most = fmax( most, sign * coordinate_of( near, at[v] ) );
    }
    return sign * most;
}

static double mean_of( const stability_near* near, const wisp_vec3* at, int count )
{
    double sum = 0.0;
    for ( int v = 0; v < count; ++v )
    {
        sum += coordinate_of( near, at[v] );
    }
    return sum / count;
}

double stability_near_measure( const stability_near* near, const scene_body* body, const wisp_vec3* at,
                               const stability_sample* sample )
{
    const int count = body->vertex_count;
    if ( (int)strlen( body->name ) != near->name_length ||
         strncmp( body->name, near->of, strlen( body->name ) ) != 0 ||
         ( near->kind == VERTEX && near->vertex >= count ) )
    {
        return NAN;
    }
    switch ( near->kind )
    {
        case TIP:
            return coordinate_of( near, at[count - 1] );
        case VERTEX:
            return coordinate_of( near, at[near->vertex] );
        case MEAN:
            return mean_of( near, at, count );
        case CENTRE:
            return sample->centre[near->axis];
        case MOMENTUM:
            return sample->momentum[near->axis];
        case SPIN:
            return sample->spin[near->axis];
        case SPEED:
            return sample->speed;
        case KINETIC:
            return sample->kinetic;
        case POTENTIAL:
            return sample->potential;
        case VOLUME:
            return enclosed_volume( body, at );
        default:
            return extreme_of( near, at, count );
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
            snprintf( out->message, sizeof out->message, "%s%s%s%s is %.6g, expected %.6g within %.3g%s%s", near->of,
                      near->take == STABILITY_TAKE_END ? "" : ", ",
                      near->take == STABILITY_TAKE_END ? "" : stability_near_takes[near->take], when, found,
                      near->value, near->within, near->from[0] ? ": " : "", near->from );
            return false;
        }
    }
    return true;
}
