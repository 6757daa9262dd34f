// Energies of the links, on request: plain loops in double precision, in a fixed order.
#include "implicit_internal.h"

static const double PI = 3.14159265358979323846;

// sinc u = y on [0, pi] by Newton's method.
static double arc_angle( double y )
{
    double u = fmin( sqrt( 6.0 * fmax( 0.0, 1.0 - y ) ), PI );
    for ( int i = 0; i < 20 && u > 1e-6; ++i )
    {
        const double sine = sin( u ), slope = ( cos( u ) - sine / u ) / u, change = ( sine / u - y ) / slope;
        u = fmin( fmax( u - change, 1e-6 ), PI );
        if ( fabs( change ) < 1e-13 )
        {
            break;
        }
    }
    return u;
}

// f_b L^2 / k_b (Noh and Jung, eq. 11).
static double arc_load( double y )
{
    const double u = arc_angle( y );
    return u < 1e-2 ? -12.0 - 7.2 * ( 1.0 - y ) : 4.0 * u * u / ( cos( u ) - sin( u ) / u );
}

// y = 1 + q F(y). The iteration from y = 1 converges to the first intersection, since q F' < 1 up to it.
double implicit_ramp_end( double load, double ramp, double rest )
{
    if ( !( load > 0.0 && ramp > 0.0 && rest > 0.0 ) )
    {
        return 1.0;
    }
    const double q = load / ( ramp * rest );
    double y = 1.0;
    for ( int i = 0; i < 200; ++i )
    {
        const double next = 1.0 + q * arc_load( y ), change = next - y;
        y = next;
        if ( !( y > 0.0 ) )
        {
            return 0.0;
        }
        if ( fabs( change ) < 1e-13 )
        {
            break;
        }
    }
    return y;
}

// The potential of eq. 12: the integral of the force from the rest length down. Along the arc it is a difference of
// 1/2 k_b L kappa^2 = 2 k_b / L u^2.
static double bend_energy( double load, double ramp, double rest, double length )
{
    if ( !( length < rest ) || load <= 0.0 )
    {
        return 0.0;
    }
    const double y = length / rest, meets = implicit_ramp_end( load, ramp, rest );
    const double straight = fmin( 1.0 - y, 1.0 - meets ) * rest;
    const double energy = 0.5 * ramp * straight * straight;
    if ( y >= meets )
    {
        return energy;
    }
    const double from = arc_angle( meets ), to = arc_angle( y );
    return energy + 2.0 * load * rest * ( to * to - from * from );
}

static double row_distance( const float* position, const implicit_links* links, int row, int other )
{
    const float *p = position + (size_t)links->row_slot[row] * 4, *q = position + (size_t)links->row_slot[other] * 4;
    const double d[3] = { (double)q[0] - (double)p[0], (double)q[1] - (double)p[1], (double)q[2] - (double)p[2] };
    return sqrt( d[0] * d[0] + d[1] * d[1] + d[2] * d[2] );
}

// Each link is listed at both ends, and counts at the lower row.
static void add_entry( const implicit_links* links, const float* position, float stiffest, int slice, int entry,
                       bool bends, wisp_implicit_cloth_stats* out )
{
    const float most = stiffest > 0.0f ? stiffest : INFINITY;
    for ( int lane = 0; lane < WISP_SLICE; ++lane )
    {
        const int row = slice * WISP_SLICE + lane, other = links->springs.other_x4[entry][lane] / 4;
        if ( other <= row )
        {
            continue;
        }
        const double length = row_distance( position, links, row, other );
        const double rest = (double)links->springs.rest[entry][lane],
                     load = (double)links->springs.stiffness[entry][lane];
        const double ramp = (double)fminf( links->springs.ramp_stiffness[entry][lane], most );
        const double over = fmax( 0.0, length - rest );
        out->stretch_energy += bends ? 0.0 : 0.5 * fmin( load, (double)most ) * over * over;
        out->bend_energy += bends ? bend_energy( load, ramp, rest, length ) : 0.0;
    }
}

// 1/2 D x' Q x, as a sum over pairs.
static double plate_energy( const implicit_links* links, const float* position )
{
    const wisp_plate_rows rows = wisp_plate_get_rows( links->plate );
    double sum = 0.0;
    for ( int row = 0; row < links->row_count; ++row )
    {
        for ( int entry = rows.begin[row / WISP_SLICE]; entry < rows.begin[row / WISP_SLICE + 1]; ++entry )
        {
            const int other = rows.other_x4[entry][row % WISP_SLICE] / 4;
            if ( other > row )
            {
                const double length = row_distance( position, links, row, other );
                sum += (double)rows.weight[entry][row % WISP_SLICE] * length * length;
            }
        }
    }
    return 0.5 * (double)links->rigidity * sum;
}

void implicit_measure( wisp_frame* frame, const wisp_span* span, void* user )
{
    const implicit_state* state = user;
    const implicit_links* links = implicit_find_links( state, span->entity );
    const implicit_tally* tally = wisp_frame_column( frame, span->entity, state->tally, 0 );
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    wisp_implicit_cloth_stats stats = {
        .iterations = tally->iterations,
        .residual = tally->residual,
        .newton_iterations = tally->repeats,
        .stretch_links = links->stretch_count,
        .bend_links = links->bend_count,
        .max_neighbours = links->max_neighbours,
        .sticking = tally->sticking,
        .sliding = tally->sliding,
        .landing = tally->landing,
        .released = tally->released,
        .newton_residual = (double)tally->newton_residual,
    };
    for ( int slice = 0; slice < links->slice_count; ++slice )
    {
        const int32_t* parts = links->springs.begin + 2 * (size_t)slice;
        for ( int entry = parts[0]; entry < parts[2]; ++entry )
        {
            add_entry( links, position, tally->stiffest, slice, entry, entry >= parts[1], &stats );
        }
    }
    stats.bend_energy += links->plate != NULL ? plate_energy( links, position ) : 0.0;
    *(wisp_implicit_cloth_stats*)wisp_frame_column( frame, span->entity, state->stats, 0 ) = stats;
}
