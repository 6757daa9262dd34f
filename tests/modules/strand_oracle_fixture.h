/// Shared by the tests of moving strands: shapes, velocities, sums over a strand, frames that are carried along.
#pragma once

#include "oracle_support.h"

#include "oracle/strand_oracle.h"

static const uint64_t random_seed = 41;

static const double line_density = 6.5e-6; // kg/m, a hair
static const double3 zero = { 0.0, 0.0, 0.0 };
static const double fall = 9.81; // m/s^2
static const double3 gravity = { 0.0, -9.81, 0.0 };

// A straight strand of equal masses from the origin.
static inline strand_oracle new_chain( int count, double length, double3 direction, bool held )
{
    strand_oracle strand;
    double3 points[MAX_STRAND_ORACLE];
    for ( int i = 0; i < count; ++i )
    {
        points[i] = double3_scale( length * i / fmax( count - 1, 1 ), direction );
    }
    assert_true( strand_oracle_shape( &strand, points, count ) );
    strand_oracle_weigh_equal( &strand, 1e-3, held );
    return strand;
}

// A crooked one with the density of a hair.
static inline strand_oracle new_crooked( int key, int count, bool held )
{
    strand_oracle strand;
    double3 points[MAX_STRAND_ORACLE];
    for ( int i = 0; i < count; ++i )
    {
        const double3 line = double3_make( 0.3 * i / count, 0.05 * i / count, -0.1 * i / count );
        points[i] = double3_add( line, double3_scale( 0.01, random_vector( key, i ) ) );
    }
    assert_true( strand_oracle_shape( &strand, points, count ) );
    strand_oracle_weigh( &strand, line_density, held );
    return strand;
}

static inline strand_oracle new_straight( int count, double length, bool held )
{
    strand_oracle strand;
    double3 points[MAX_STRAND_ORACLE];
    for ( int i = 0; i < count; ++i )
    {
        points[i] = double3_make( length * i / ( count - 1 ), 0.0, 0.0 );
    }
    assert_true( strand_oracle_shape( &strand, points, count ) );
    strand_oracle_weigh( &strand, line_density, held );
    strand_oracle_rest_straight( &strand );
    return strand;
}

// A curl of the given turns that hangs down.
static inline strand_oracle new_curl( int count, double turns, bool held )
{
    strand_oracle strand;
    double3 points[MAX_STRAND_ORACLE];
    for ( int i = 0; i < count; ++i )
    {
        const double fraction = i / ( count - 1.0 ), angle = 2.0 * pi * turns * fraction;
        points[i] = double3_make( 0.02 * cos( angle ), -0.04 * turns * fraction, 0.02 * sin( angle ) );
    }
    assert_true( strand_oracle_shape( &strand, points, count ) );
    strand_oracle_weigh( &strand, line_density, held );
    return strand;
}

static inline void kick( strand_oracle* strand, int key, double speed )
{
    for ( int i = 0; i < strand->count; ++i )
    {
        const bool moves = strand->weight[i] > 0.0;
        strand->velocity[i] = moves ? double3_scale( speed, random_vector( key, i ) ) : zero;
    }
}

static inline double3 momentum( const strand_oracle* strand )
{
    double3 sum = zero;
    for ( int i = 0; i < strand->count; ++i )
    {
        sum = double3_add( sum, double3_scale( strand->mass[i], strand->velocity[i] ) );
    }
    return sum;
}

static inline double3 angular_momentum( const strand_oracle* strand )
{
    double3 sum = zero;
    for ( int i = 0; i < strand->count; ++i )
    {
        const double3 spin = double3_cross( strand->position[i], strand->velocity[i] );
        sum = double3_add( sum, double3_scale( strand->mass[i], spin ) );
    }
    return sum;
}

static inline double kinetic( const strand_oracle* strand )
{
    double sum = 0.0;
    for ( int i = 0; i < strand->count; ++i )
    {
        sum += 0.5 * strand->mass[i] * double3_dot( strand->velocity[i], strand->velocity[i] );
    }
    return sum;
}

static inline double whole_length( const strand_oracle* strand )
{
    double sum = 0.0;
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        sum += strand->length[s];
    }
    return sum;
}

static inline double whole_weight( const strand_oracle* strand )
{
    return whole_length( strand ) * line_density * fall;
}

static inline double farthest( const strand_oracle* a, const strand_oracle* b )
{
    double most = 0.0;
    for ( int i = 0; i < a->count; ++i )
    {
        most = fmax( most, double3_distance( a->position[i], b->position[i] ) );
    }
    return most;
}

static inline strand_oracle_settings rod_settings( double dt )
{
    strand_oracle_settings settings = strand_oracle_default_settings( dt );
    settings.bending = STRAND_ORACLE_BENDING_ROD;
    settings.looks_back = true;
    return settings;
}

static inline void steps( strand_oracle* strand, const strand_oracle_settings* settings, int count )
{
    for ( int k = 0; k < count; ++k )
    {
        strand_oracle_substep( strand, settings, NULL );
    }
}

static inline bool is_finite( const strand_oracle* strand )
{
    bool finite = true;
    for ( int i = 0; i < strand->count; ++i )
    {
        const double3 p = strand->position[i], v = strand->velocity[i];
        finite = finite && isfinite( p.x + p.y + p.z ) && isfinite( v.x + v.y + v.z );
    }
    return finite;
}

static inline void carry_frames( strand_oracle* strand )
{
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const double3 e = double3_sub( strand->position[s + 1], strand->position[s] );
        strand->frame[s] = strand_oracle_carried( strand->frame[s], e );
    }
}

// Displaced at random, with rest lengths; frames are carried along.
static inline void deform( strand_oracle* strand, int key, double by )
{
    double3 direction[MAX_STRAND_ORACLE];
    for ( int i = 1; i < strand->count; ++i )
    {
        strand->position[i] = double3_add( strand->position[i], double3_scale( by, random_vector( key, i ) ) );
    }
    strand_oracle_directions( strand, direction );
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const double3 e = double3_scale( strand->length[s], direction[s] );
        strand->position[s + 1] = double3_add( strand->position[s], e );
    }
    carry_frames( strand );
}

// The rod's twist alone, iterated until it converges: nothing moves, because everything is held.
static inline void settle_twist( strand_oracle* strand )
{
    strand_oracle held = *strand;
    memset( held.weight, 0, sizeof( held.weight ) );
    memset( held.tension, 0, sizeof( held.tension ) );
    strand_oracle_rod_factor( &held, 0.0, 1e-3 );
    for ( int k = 0; k < 60; ++k )
    {
        strand_oracle_rod( &held, 0.0, 1e-3, NULL );
    }
    memcpy( strand->frame, held.frame, sizeof( held.frame ) );
}

static inline strand_oracle_settings settings_of( strand_oracle_lengths lengths, bool compliant, double dt )
{
    strand_oracle_settings settings = strand_oracle_default_settings( dt );
    settings.lengths = lengths;
    settings.along.inverse_dt2 = compliant ? 1.0 / ( dt * dt ) : 0.0;
    settings.bend.inverse_dt2 = settings.along.inverse_dt2;
    settings.along.compliance = settings.bend.compliance = 1e-3;
    return settings;
}
