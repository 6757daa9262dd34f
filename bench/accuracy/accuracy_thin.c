// Selects the settings of a quick run.
#include "accuracy_parts.h"

#include <string.h>

// Rank of a setting in its series: 0 is the coarsest.
static int rank_of( const accuracy_scene* scene, int setting, int* series_count )
{
    const accuracy_setting* mine = &scene->settings[setting];
    int rank = 0;
    *series_count = 0;
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        if ( strcmp( scene->settings[i].series, mine->series ) == 0 )
        {
            rank += scene->settings[i].parameter > mine->parameter ? 1 : 0;
            ++*series_count;
        }
    }
    return rank;
}

static const char* first_series( const accuracy_scene* scene )
{
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        if ( scene->settings[i].series[0] != '\0' )
        {
            return scene->settings[i].series;
        }
    }
    return "";
}

static bool is_kept( const accuracy_scene* scene, int setting, const char* first )
{
    const char* series = scene->settings[setting].series;
    if ( series[0] == '\0' )
    {
        return true;
    }
    int count;
    const int rank = rank_of( scene, setting, &count );
    return rank == 0 || rank == count / 2 || ( rank == count - 1 && strcmp( series, first ) == 0 );
}

bool accuracy_names_quick( const wisp_suite* suite )
{
    for ( int i = 0; suite && i < suite->row_count; ++i )
    {
        if ( suite->rows[i].is_slow )
        {
            return true;
        }
    }
    return false;
}

void accuracy_thin( accuracy_scene* scene, const wisp_suite* suite, int* numbers )
{
    const char* first = first_series( scene );
    const bool is_named = accuracy_names_quick( suite );

    // All are chosen before any is moved, because ranks refer to all.
    int kept = 0;
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        if ( is_named ? !suite->rows[i].is_slow : is_kept( scene, i, first ) )
        {
            numbers[kept++] = i;
        }
    }
    for ( int k = 0; k < kept; ++k )
    {
        scene->settings[k] = scene->settings[numbers[k]];
    }
    scene->setting_count = kept;
}
