/// Definitions with one wrong value each. A file lists them as BROKEN_DEFS( X ), in which each line is X( what the
/// message must name, the statement that breaks the definition `d` ), and includes this one afterwards.
#pragma once

enum
{
#define COUNT_ONE( message, statement ) +1
    BROKEN_COUNT = 0 BROKEN_DEFS( COUNT_ONE )
#undef COUNT_ONE
};

/// Break a definition in one of these ways. @return what the message must name
static const char* break_def( int number, BROKEN_TYPE* d )
{
    int n = 0;
    const char* expected = NULL;
#define BREAK_ONE( message, statement )                                                                              \
    if ( n++ == number )                                                                                             \
    {                                                                                                                \
        statement;                                                                                                   \
        expected = message;                                                                                          \
    }
    BROKEN_DEFS( BREAK_ONE )
#undef BREAK_ONE
    return expected;
}
