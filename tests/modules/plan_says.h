/// What the printed plan of a world says of a pass.
#pragma once

#include "support.h"

typedef struct told_plan
{
    char text[32768];
    size_t length;
} told_plan;

static inline void told_plan_add( void* user, const char* line )
{
    told_plan* t = user;
    const int n = snprintf( t->text + t->length, sizeof( t->text ) - t->length, "%s\n", line );
    t->length += n > 0 ? (size_t)n : 0;
    assert_true( t->length < sizeof( t->text ) );
}

/// True if a line names the pass and contains the word.
static inline bool plan_says( wisp_world* world, const char* pass, const char* word )
{
    static told_plan t;
    t.length = 0;
    assert_int_equal( wisp_world_plan( world, told_plan_add, &t ), WISP_OK );
    char name[80];
    snprintf( name, sizeof( name ), " %s ", pass );
    for ( char* line = strtok( t.text, "\n" ); line != NULL; line = strtok( NULL, "\n" ) )
    {
        if ( strstr( line, name ) != NULL && strstr( line, word ) != NULL )
        {
            return true;
        }
    }
    return false;
}
