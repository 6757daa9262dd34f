// The case `cloth`: the suites in data/suites/cloth.
#include "bench_options.h"

#include "suite/suite_folder.h"

wisp_status cloth_bench( const bench_options* options, results* out, wisp_error* error )
{
    return suite_bench_folder( "cloth", bench_seconds( options ), options, out, error );
}
