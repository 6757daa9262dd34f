#include "accuracy_labels.h"

#include <math.h>
#include <string.h>

const char* accuracy_kind( const accuracy_scene* scene )
{
    return scene->error_name[0] ? "Accuracy" : "Suite";
}

const char* accuracy_ms_name( const accuracy_scene* scene )
{
    return scene->ms_name[0] ? scene->ms_name : "step";
}

void accuracy_error_label( const accuracy_scene* scene, char* text, int size )
{
    snprintf( text, (size_t)size, scene->error_unit[0] ? "%s, %s" : "%s", scene->error_name, scene->error_unit );
}

void accuracy_workers_label( int workers, char* text, int size )
{
    snprintf( text, (size_t)size, "%d %s", workers, bench_workers_word( workers ) );
}

void accuracy_put_digits( cells* row, double value, int digits )
{
    const double size = fabs( value );
    if ( !isfinite( value ) || size == 0.0 )
    {
        cells_put_number( row, value, 0 );
    }
    else if ( size < 1e-4 || size >= 1e7 )
    {
        cells_put( row, "%.*e", digits - 1, value );
    }
    else
    {
        const int behind = digits - 1 - (int)floor( log10( size ) );
        cells_put_number( row, value, behind > 0 ? behind : 0 );
    }
}

bool accuracy_is_below( double error, double doubt )
{
    return doubt > 0.0 && fabs( error ) <= doubt;
}

void accuracy_put_error( cells* row, double error, double doubt, int digits )
{
    if ( accuracy_is_below( error, doubt ) )
    {
        cells_put( row, "below" );
    }
    else
    {
        accuracy_put_digits( row, error, digits );
    }
}

const char* accuracy_method_of( const accuracy_setting* setting )
{
    return setting->method[0] ? setting->method : setting->series[0] ? setting->series : setting->name;
}

bool accuracy_begins_series( const accuracy_scene* scene, int setting )
{
    const accuracy_setting* settings = scene->settings;
    bool begins = settings[setting].series[0] != '\0';
    for ( int i = 0; i < setting && begins; ++i )
    {
        begins = strcmp( settings[i].series, settings[setting].series ) != 0;
    }
    return begins;
}
