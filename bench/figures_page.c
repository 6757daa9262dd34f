#include "figures_page.h"

#include <stdarg.h>

void figures_add( figures_case* page, const char* id, const char* experiment, const char* expected, bool meets_target,
                  const char* format, ... )
{
    char measured[300];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( measured, sizeof( measured ), format, arguments );
    va_end( arguments );
    const char* const row[] = { id, experiment, expected, measured, meets_target ? "yes" : "NO" };
    results_add_cells( page->out, page->table, row );
    if ( !meets_target )
    {
        results_add_failure( page->out, "%s, %s: expected %s; measured %s.", id, experiment, expected, measured );
    }
}
