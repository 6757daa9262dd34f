// Shapes of rods at rest: as laid, straight, and in balance with gravity.
#include "strand_oracle_rod.h"

#include <string.h>

// Frames carried along the present shape from the clamp; twist is 0 everywhere.
static void lay_frames( strand_oracle* strand )
{
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const double3 e = double3_sub( strand->position[s + 1], strand->position[s] );
        strand->frame[s] = strand_oracle_carried( rod_frame_before( strand, s ), e );
        strand->rest_twist[s] = 0.0;
    }
    if ( strand->guided ) // held as it is
    {
        strand->frame[strand->count - 1] = strand->frame[strand->count - 2];
        strand->rest_twist[strand->count - 1] = 0.0;
        strand->rest[strand->count - 1] = rod_none;
    }
    strand->framed = true;
}

static double3 into_middle( const strand_oracle* strand, int i, double3 k )
{
    return strand_oracle_turned(
        quaternion_conjugate( rod_middle_frame( rod_frame_before( strand, i ), strand->frame[i] ) ), k );
}

void strand_oracle_rest_shape( strand_oracle* strand )
{
    lay_frames( strand );
    for ( int i = 0; i + 1 < strand->count; ++i )
    {
        strand->rest[i] = into_middle( strand, i, rod_measure( strand, strand->position, i ).bend );
    }
}

void strand_oracle_rest_straight( strand_oracle* strand )
{
    lay_frames( strand );
    memset( strand->rest, 0, sizeof( strand->rest ) );
    strand->framed = strand->guided || strand->flatness > 0.0;
}

// Values that the recursion from the tip passes to the previous segment.
typedef struct hanging
{
    double3 weight;       // N, W_s
    double3 moment;       // M_{s+1}
    double twist, load;   // T_{s+1}, b_{s+1}
    double3 twist_moment; // (T_{s+1} - r b_{s+1}) kb_{s+1}
    double3 turn;         // rad, sum of M / (EI / L) from the tip
    double largest_turn;  // rad
} hanging;

// With u = bend x z, b_s = M_s . u. M_s = A - l alpha t_s - (T_s + r b_s) kb_s / 2 and t_s . u = 0 make T_s and b_s
// linear equations.
static void balance_vertex( strand_oracle* strand, int s, hanging* h )
{
    const rod_vertex v = rod_measure( strand, strand->position, s );
    const double l = strand->length[s];
    const double3 t = rod_tangent( strand, strand->position, s );
    const double3 z =
        strand_oracle_turned( rod_middle_frame( rod_frame_before( strand, s ), strand->frame[s] ), rod_z );
    const double3 u = double3_cross( v.bend, z );
    double3 m = double3_add_scaled( double3_add_scaled( h->moment, l, h->weight ), -0.5, h->twist_moment );
    const double across = double3_dot( m, u ), along = double3_dot( v.kb, u ), own = 1.0 + 0.5 * v.ratio * along;
    double twist = 0.0;
    if ( strand->twist_stiffness[s] > 0.0 )
    {
        twist = h->twist - 0.5 * ( across / own + h->load );
        twist /= 1.0 - 0.25 * along / own;
    }
    const double load = ( across - 0.5 * twist * along ) / own;
    h->twist_moment = double3_scale( twist - v.ratio * load, v.kb );
    m = double3_add_scaled( m, -0.5 * ( twist + v.ratio * load ), v.kb );
    const double lean = double3_dot( t, z );
    const double alpha = lean > 1e-12 ? double3_dot( m, z ) / ( l * lean ) : 0.0;
    m = double3_add_scaled( m, -l * alpha, t );
    h->moment = m;
    h->twist = twist;
    h->load = double3_dot( m, u );

    const bool bends = strand->stiffness[s] > 0.0;
    // C_i of an elliptic section under M_i
    const double3 axis =
        strand_oracle_turned( rod_middle_frame( rod_frame_before( strand, s ), strand->frame[s] ), rod_x );
    const double flat = strand->flatness * strand->flatness;
    m = double3_add_scaled( m, flat / ( 1.0 - flat ) * double3_dot( m, axis ), axis );
    h->turn = bends ? double3_add_scaled( h->turn, 1.0 / strand->stiffness[s], m ) : h->turn;
    h->largest_turn = fmax( h->largest_turn, double3_length( h->turn ) );
    const double3 k = bends ? double3_add_scaled( v.bend, -1.0 / strand->stiffness[s], m ) : v.bend;
    strand->rest[s] = into_middle( strand, s, k );
    strand->rest_twist[s] = twist != 0.0 ? -2.0 * atan( 0.5 * twist / strand->twist_stiffness[s] ) : 0.0;
    strand->tension[s] = alpha;
}

// @return rad, the largest turn of the rest shape against the load between the tip and a vertex
static double balance( strand_oracle* strand, double3 gravity )
{
    hanging h = { .twist = 0.0 };
    lay_frames( strand );
    for ( int s = strand->count - 2; s >= 0; --s )
    {
        const bool is_held = strand->weight[s + 1] <= 0.0;
        h.weight = is_held ? rod_none : double3_add_scaled( h.weight, strand->mass[s + 1], gravity );
        balance_vertex( strand, s, &h );
    }
    strand->tension[strand->count - 1] = 0.0;
    return h.largest_turn;
}

double strand_oracle_balance_stably( strand_oracle* strand, double3 gravity, double max_turn )
{
    const double turn = balance( strand, gravity );
    const double fraction = turn > max_turn ? max_turn / turn : 1.0;
    if ( fraction < 1.0 )
    {
        balance( strand, double3_scale( fraction, gravity ) );
    }
    return fraction;
}
