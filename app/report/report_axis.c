#include "report_axis.h"

#include "report_text.h"

#include <math.h>

#define STEPS_REQUESTED 5
// Values that differ by rounding only are equal.
#define ROUNDING 1e-9
// Beyond these powers of ten leave the range of a double.
#define TINY 1e-100
#define ENORMOUS 1e100

bool report_axis_takes( bool is_log, double value )
{
    return isfinite( value ) && fabs( value ) <= ENORMOUS && ( !is_log || value >= TINY );
}

static void add_tick( report_axis* axis, double value, bool is_major, const char* label )
{
    if ( axis->tick_count < REPORT_TICKS_MAX )
    {
        report_tick* tick = &axis->ticks[axis->tick_count++];
        tick->value = value;
        tick->is_major = is_major;
        snprintf( tick->label, sizeof( tick->label ), "%s", label );
    }
}

// n * 10^exponent, nearest: powers above 1 are exact, those below are not.
static double scaled( double n, int exponent )
{
    return exponent < 0 ? n / pow( 10.0, -exponent ) : n * pow( 10.0, exponent );
}

// ---- linear ----

// Times begin at 0 unless that compresses them too much, so that lengths can be compared.
static void widen( double* least, double* most )
{
    double large = fmax( fabs( *least ), fabs( *most ) );
    if ( large < TINY )
    {
        *least = 0.0;
        *most = 1.0;
    }
    else if ( *most - *least <= ROUNDING * large )
    {
        *least = fmin( 2.0 * *least, 0.0 );
        *most = fmax( 2.0 * *most, 0.0 );
    }
    else if ( *least > 0.0 && *least < 0.5 * *most )
    {
        *least = 0.0;
    }
    else if ( *most < 0.0 && *most > 0.5 * *least )
    {
        *most = 0.0;
    }
}

// The smallest of 1, 2 and 5 times a power of ten with at most the given number of steps.
static int find_step( double span, int* exponent )
{
    double requested = span / STEPS_REQUESTED * ( 1.0 - ROUNDING );
    *exponent = (int)floor( log10( requested ) );
    int digit = 1;
    while ( scaled( digit, *exponent ) < requested && digit < 10 )
    {
        digit = digit == 1 ? 2 : digit == 2 ? 5 : 10;
    }
    return digit;
}

static report_axis make_linear( double least, double most )
{
    report_axis axis = { .is_log = false };
    int exponent;
    widen( &least, &most );
    int digit = find_step( most - least, &exponent );
    double step = scaled( digit, exponent );
    long long first = (long long)floor( least / step + ROUNDING );
    long long last = (long long)ceil( most / step - ROUNDING );
    axis.lower = scaled( (double)( first * digit ), exponent );
    axis.upper = scaled( (double)( last * digit ), exponent );
    // One power of ten for all labels, where they would be long without.
    int largest = (int)floor( log10( fmax( fabs( axis.lower ), fabs( axis.upper ) ) ) + ROUNDING );
    int power = largest < -3 || largest > 6 ? largest : 0;
    for ( long long i = first; i <= last; ++i )
    {
        char label[64];
        report_decimal( i * digit, exponent, power, label, sizeof( label ) );
        add_tick( &axis, scaled( (double)( i * digit ), exponent ), true, label );
    }
    return axis;
}

// ---- logarithmic ----

// Ends are at 1, 2 or 5 times a power of ten: three ends per decade, numbered consecutively.
static int end_digit( int end )
{
    static const int digits[3] = { 1, 2, 5 };
    return digits[( end % 3 + 3 ) % 3];
}

static int end_exponent( int end )
{
    return ( end - ( end % 3 + 3 ) % 3 ) / 3;
}

static double end_value( int end )
{
    return scaled( end_digit( end ), end_exponent( end ) );
}

// The ticks of one decade: the number of decades determines the digits with a gridline and those with a label.
static void add_decade( report_axis* axis, int exponent, int span, bool is_power )
{
    for ( int digit = 1; digit < 10; ++digit )
    {
        bool is_inside = scaled( digit, exponent ) >= axis->lower * ( 1.0 - ROUNDING ) &&
                         scaled( digit, exponent ) <= axis->upper * ( 1.0 + ROUNDING );
        bool has_line = digit == 1 || span <= 9;
        bool has_label = digit == 1 || span <= 2 || ( span <= 6 && ( digit == 2 || digit == 5 ) );
        if ( is_inside && has_line )
        {
            char label[64] = "";
            if ( has_label )
            {
                report_decimal( digit, exponent, is_power ? exponent : 0, label, sizeof( label ) );
            }
            add_tick( axis, scaled( digit, exponent ), digit == 1, label );
        }
    }
}

static report_axis make_log( double least, double most )
{
    report_axis axis = { .is_log = true };
    int first = 3 * (int)floor( log10( least ) ) - 1, last = first;
    while ( end_value( first + 1 ) <= least * ( 1.0 + ROUNDING ) )
    {
        ++first;
    }
    while ( end_value( last ) < most * ( 1.0 - ROUNDING ) )
    {
        ++last;
    }
    if ( first == last )
    {
        --first;
        ++last;
    }
    axis.lower = end_value( first );
    axis.upper = end_value( last );
    int from = end_exponent( first ), to = end_exponent( last );
    int stride = 1 + ( to - from ) / 8;
    for ( int exponent = from; exponent <= to; exponent += stride )
    {
        // One notation for all labels of an axis.
        add_decade( &axis, exponent, last - first, from < -3 || to > 6 );
    }
    return axis;
}

report_axis report_axis_make( double least, double most, bool is_log )
{
    return is_log ? make_log( least, most ) : make_linear( least, most );
}

double report_axis_place( const report_axis* axis, double value )
{
    return axis->is_log ? log( value / axis->lower ) / log( axis->upper / axis->lower )
                        : ( value - axis->lower ) / ( axis->upper - axis->lower );
}
