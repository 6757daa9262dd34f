#include "torture_random.h"

#include <stdio.h>
#include <stdlib.h>

// SplitMix64 (Steele, Lea and Flood 2014).
static uint64_t mix( uint64_t z )
{
    z = ( z ^ ( z >> 30 ) ) * 0xbf58476d1ce4e5b9u;
    z = ( z ^ ( z >> 27 ) ) * 0x94d049bb133111ebu;
    return z ^ ( z >> 31 );
}

torture_random torture_random_start( uint64_t seed, uint64_t number )
{
    return ( torture_random ){ mix( mix( seed + 0x9e3779b97f4a7c15u ) + number ) };
}

uint64_t torture_random_next( torture_random* random )
{
    random->state += 0x9e3779b97f4a7c15u;
    return mix( random->state );
}

int torture_random_whole( torture_random* random, int lower, int upper )
{
    const uint64_t count = (uint64_t)( (int64_t)upper - lower + 1 );
    return lower + (int)( ( torture_random_next( random ) >> 11 ) % count );
}

bool torture_random_chance( torture_random* random, int percent )
{
    return torture_random_whole( random, 0, 99 ) < percent;
}

torture_number torture_random_linear( torture_random* random, double lower, double upper )
{
    const int STEPS = 40;
    torture_number number;
    const double value = lower + ( upper - lower ) * torture_random_whole( random, 0, STEPS ) / STEPS;
    snprintf( number.text, sizeof number.text, "%.3g", value == 0.0 ? 0.0 : value );
    return number;
}

torture_number torture_random_log( torture_random* random, double lower, double upper )
{
    static const int DIGITS[] = { 1, 2, 3, 5, 7 };
    enum
    {
        DIGIT_COUNT = 5,
        LOWEST = -15,
        HIGHEST = 15,
    };
    torture_number found = { "" };
    int count = 0;
    // Each candidate within the range replaces the one before with the probability that makes all equally likely.
    for ( int i = DIGIT_COUNT * LOWEST; i < DIGIT_COUNT * HIGHEST; ++i )
    {
        const int exponent = i / DIGIT_COUNT - ( i % DIGIT_COUNT < 0 );
        torture_number candidate;
        snprintf( candidate.text, sizeof candidate.text, "%de%d", DIGITS[i - DIGIT_COUNT * exponent], exponent );
        const double value = strtod( candidate.text, NULL );
        if ( value >= lower * ( 1.0 - 1e-6 ) && value <= upper * ( 1.0 + 1e-6 ) &&
             torture_random_whole( random, 0, count++ ) == 0 )
        {
            snprintf( found.text, sizeof found.text, "%.3g", value );
        }
    }
    if ( count == 0 )
    {
        snprintf( found.text, sizeof found.text, "%.3g", lower );
    }
    return found;
}
