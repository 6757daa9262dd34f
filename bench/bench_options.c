#include "bench_options.h"

bench_options bench_default_options( void )
{
    return ( bench_options ){ .workers = 2 };
}

double bench_seconds( const bench_options* options )
{
    return options->seconds > 0.0 ? options->seconds : options->quick ? 18.0 : 85.0;
}

const char* bench_workers_word( int workers )
{
    return workers == 1 ? "worker" : "workers";
}

void bench_progress( const bench_options* options, double fraction, const char* what )
{
    if ( options->progress )
    {
        options->progress( options->progress_user, fraction, what );
    }
}
