#include "profile_samples.h"

#include "stats.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Plans have few passes and are nearly always in the same order, so the expected position is tried first.
static profile_pass* find_pass( profile_samples* samples, const char* name, int expected )
{
    if ( expected < samples->pass_count && strcmp( samples->passes[expected].name, name ) == 0 )
    {
        return &samples->passes[expected];
    }
    for ( int i = 0; i < samples->pass_count; ++i )
    {
        if ( strcmp( samples->passes[i].name, name ) == 0 )
        {
            return &samples->passes[i];
        }
    }
    return NULL;
}

static profile_pass* add_pass( profile_samples* samples, const char* name )
{
    if ( samples->pass_count == samples->pass_capacity )
    {
        int capacity = samples->pass_capacity > 0 ? 2 * samples->pass_capacity : 16;
        profile_pass* grown = realloc( samples->passes, (size_t)capacity * sizeof( profile_pass ) );
        if ( !grown )
        {
            return NULL;
        }
        samples->passes = grown;
        samples->pass_capacity = capacity;
    }
    profile_pass* pass = &samples->passes[samples->pass_count++];
    *pass = ( profile_pass ){ 0 };
    snprintf( pass->name, sizeof( pass->name ), "%s", name );
    return pass;
}

static wisp_status add_sample( profile_pass* pass, double seconds )
{
    if ( pass->count == pass->capacity )
    {
        int capacity = pass->capacity > 0 ? 2 * pass->capacity : 64;
        double* grown = realloc( pass->seconds, (size_t)capacity * sizeof( double ) );
        if ( !grown )
        {
            return WISP_NO_MEMORY;
        }
        pass->seconds = grown;
        pass->capacity = capacity;
    }
    pass->seconds[pass->count++] = seconds;
    return WISP_OK;
}

wisp_status profile_samples_add( profile_samples* samples, wisp_profile profile )
{
    for ( int i = 0; i < profile.count; ++i )
    {
        const wisp_profile_line* line = &profile.lines[i];
        profile_pass* pass = find_pass( samples, line->pass, i );
        if ( !pass )
        {
            pass = add_pass( samples, line->pass );
        }
        if ( !pass || add_sample( pass, line->seconds ) != WISP_OK )
        {
            return WISP_NO_MEMORY;
        }
        pass->items = line->items;
    }
    return WISP_OK;
}

double profile_samples_median( profile_samples* samples, int pass )
{
    return stats_summarise( samples->passes[pass].seconds, samples->passes[pass].count ).median;
}

void profile_samples_free( profile_samples* samples )
{
    for ( int i = 0; i < samples->pass_count; ++i )
    {
        free( samples->passes[i].seconds );
    }
    free( samples->passes );
    *samples = ( profile_samples ){ 0 };
}
