/// A locale with a decimal comma, for tests of readers and writers of numbers.
#pragma once

#include "unit.h"

#include <locale.h>

/// Enter a locale with a decimal comma, or skip the case. The case goes back by setlocale( LC_ALL, "C" ).
static inline void enter_comma_locale( void )
{
    static const char* const names[] = { "de_DE.UTF-8", "de_DE.utf8",  "fr_FR.UTF-8", "fr_FR.utf8",
                                         "sv_SE.UTF-8", "ru_RU.UTF-8", "de_DE",       "fr_FR" };
    for ( int i = 0; i < (int)( sizeof names / sizeof names[0] ); ++i )
    {
        if ( setlocale( LC_ALL, names[i] ) != NULL && localeconv()->decimal_point[0] == ',' )
        {
            return;
        }
    }
    setlocale( LC_ALL, "C" );
    SKIP( "no locale with a decimal comma is installed" );
}
