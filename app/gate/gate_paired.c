// A round is A B B A: each a process of its own, on one processor. Its figure is the mean logarithm of B over A, free of a linear drift. A row
// is slower if the rounds say so beyond what is allowed, by an exact test that flips signs (Fisher 1935), at a level that is shared
// by all rows (Holm 1979).
#include "gate_paired.h"

#include "stats.h"
#include "world_from_scene.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum
{
    LEAST_ROUNDS = 4,
    MOST_ROUNDS = 12,
    LEAST_RUNS = 5, // of a row in a process
    MOST_RUNS = 200,
};

static const double PROCESS_SECONDS = 0.25; // of runs
static const double ALLOWED = 0.02;         // slow-down
static const double LEVEL = 0.005;          // of false alarms, of all rows together
static const double MOST_NOISE = 0.05;      // of one program against itself

// ---- in the measured process ----

static double seconds_used( void )
{
    struct timespec now;
    clock_gettime( CLOCK_THREAD_CPUTIME_ID, &now );
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static wisp_status time_run( const wisp_scene* scene, int steps, const char* isa, double slow, double* out,
                             wisp_error* error )
{
    const scene_world_options options = { .workers = 1, .isa = isa, .is_quiet = true };
    scene_world world;
    wisp_status status = scene_world_create( scene, &options, &world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const double start = seconds_used();
    for ( int step = 0; step < steps && status == WISP_OK; ++step )
    {
        const double before = seconds_used();
        status = scene_world_step( &world, error );
        const double after = seconds_used();
        while ( slow > 0.0 && seconds_used() - after < slow * ( after - before ) )
        {
        }
    }
    *out = seconds_used() - start;
    scene_world_destroy( &world );
    return status;
}

static int by_size( const void* a, const void* b )
{
    const double x = *(const double*)a, y = *(const double*)b;
    return ( x > y ) - ( x < y );
}

wisp_status gate_time_row( const suite_row* row, const char* isa, double slow, double* out, wisp_error* error )
{
    double times[MOST_RUNS], sum = 0.0;
    wisp_scene scene;
    wisp_status status = suite_scene( row, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    int count = 0;
    for ( ; status == WISP_OK && count < MOST_RUNS && ( count < LEAST_RUNS || sum < PROCESS_SECONDS ); ++count )
    {
        status = time_run( &scene, row->steps > 0 ? row->steps : scene.steps, isa, slow, times + count, error );
        sum += times[count];
    }
    wisp_scene_release( &scene );
    qsort( times, (size_t)count, sizeof times[0], by_size );
    *out = 1e9 * times[count / 10];
    return status;
}

// ---- processes ----

typedef struct timed_program
{
    const char* path;
    double slow;
} timed_program;

static _Noreturn void be_child( const timed_program* program, const char* suite, int number, const char* isa,
                                int out )
{
    char row[32], set[32], slow[32];
    snprintf( row, sizeof row, "--row=%d", number );
    snprintf( slow, sizeof slow, "--slow=%g", program->slow );
    snprintf( set, sizeof set, "--isa=%s", isa );
    char* arguments[] = { (char*)(uintptr_t)program->path, "gate", "step", "--times", row, set,
                          (char*)(uintptr_t)suite,         NULL,   NULL };
    if ( program->slow > 0.0 )
    {
        arguments[7] = slow; // other programs need not know it
    }
    // the last processor: the first one serves most interrupts
    cpu_set_t mine;
    CPU_ZERO( &mine );
    CPU_SET( (size_t)sysconf( _SC_NPROCESSORS_ONLN ) - 1, &mine );
    sched_setaffinity( 0, sizeof mine, &mine );
    dup2( out, STDOUT_FILENO );
    dup2( open( "/dev/null", O_RDWR ), STDERR_FILENO );
    execv( program->path, arguments );
    _exit( 127 );
}

static wisp_status time_in_process( const timed_program* program, const char* suite, int number, const char* isa,
                                    double* out, wisp_error* error )
{
    int ends[2];
    fflush( NULL );
    if ( pipe( ends ) != 0 )
    {
        return wisp_fail( error, WISP_IO_ERROR, "gate: no pipe: %s", strerror( errno ) );
    }
    const pid_t child = fork();
    if ( child == 0 )
    {
        close( ends[0] );
        be_child( program, suite, number, isa, ends[1] );
    }
    close( ends[1] );
    char text[128];
    size_t used = 0;
    for ( ssize_t got = 1; got > 0 && used < sizeof text - 1; used += (size_t)got )
    {
        got = read( ends[0], text + used, sizeof text - 1 - used );
        got = got < 0 ? 0 : got;
    }
    text[used] = '\0';
    close( ends[0] );
    int ended = -1;
    const bool is_good = child > 0 && waitpid( child, &ended, 0 ) == child && WIFEXITED( ended ) &&
                         WEXITSTATUS( ended ) == 0 && strncmp( text, "wisp_gate_ns 1 ", 15 ) == 0;
    *out = is_good ? strtod( text + 15, NULL ) : 0.0;
    return *out > 0.0 ? WISP_OK
                      : wisp_fail( error, WISP_BAD_INPUT, "%s: expected a Wisp that can run and time row %d of %s",
                                   program->path, number, suite );
}

// ---- statistics ----

double gate_sign_flip( const double* values, int count )
{
    double sum = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        sum += values[i];
    }
    long at_least = 0;
    for ( long signs = 0; signs < 1L << count; ++signs )
    {
        double flipped = 0.0;
        for ( int i = 0; i < count; ++i )
        {
            flipped += signs >> i & 1 ? -values[i] : values[i];
        }
        at_least += flipped >= sum - 1e-12 * fabs( sum ) ? 1 : 0;
    }
    return (double)at_least / (double)( 1L << count );
}

static double mean_of( const double* values, int count )
{
    double sum = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        sum += values[i];
    }
    return sum / count;
}

static double deviation_of( const double* values, int count )
{
    const double mean = mean_of( values, count );
    double sum = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        sum += ( values[i] - mean ) * ( values[i] - mean );
    }
    return sqrt( sum / ( count - 1 ) );
}

// What the rounds say. @param ratios logarithms of new over old @param own of old over old
static void judge( const double* ratios, const double* own, int count, gate_pair_check* out )
{
    // Student's t at 97.5 % with 3 to 11 degrees of freedom
    static const double T[] = { 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201 };
    const double half = T[count - LEAST_ROUNDS] * deviation_of( ratios, count ) / sqrt( count );
    double beyond[MOST_ROUNDS];
    for ( int i = 0; i < count; ++i )
    {
        beyond[i] = ratios[i] - log1p( ALLOWED );
    }
    out->rounds = count;
    out->slower = mean_of( ratios, count );
    out->lower = out->slower - half;
    out->upper = out->slower + half;
    out->noise = deviation_of( own, count );
    out->p = gate_sign_flip( beyond, count );
}

static wisp_status compare_row( int number, const timed_program programs[2], const char* suite_path, const char* isa,
                                gate_pair_check* out, wisp_error* error )
{
    static const int order[] = { 0, 1, 1, 0 };
    double ratios[MOST_ROUNDS], own[MOST_ROUNDS];
    wisp_status status = WISP_OK;
    for ( int round = 0; round < MOST_ROUNDS && status == WISP_OK; ++round )
    {
        double times[4] = { 1.0, 1.0, 1.0, 1.0 };
        for ( int k = 0; k < 4 && status == WISP_OK; ++k )
        {
            status = time_in_process( programs + order[k], suite_path, number, isa, times + k, error );
        }
        ratios[round] = 0.5 * log( times[1] * times[2] / ( times[0] * times[3] ) );
        own[round] = log( times[3] / times[0] );
        if ( round + 1 >= LEAST_ROUNDS && status == WISP_OK )
        {
            judge( ratios, own, round + 1, out );
            if ( out->upper < log1p( ALLOWED ) ) // stopping early where nothing is slower raises no false alarm
            {
                break;
            }
        }
    }
    return status;
}

// Rows in doubt are slower if their p holds at the level that all rows share.
static void decide( int count, gate_pair_check* checks )
{
    double p[SUITE_MAX_ROWS];
    bool is_slower[SUITE_MAX_ROWS];
    for ( int i = 0; i < count; ++i )
    {
        const bool is_fine = checks[i].upper < log1p( ALLOWED );
        checks[i].pace = is_fine ? PACE_FINE : checks[i].noise > MOST_NOISE ? PACE_NOT_MEASURABLE : PACE_DOUBT;
        p[i] = checks[i].pace == PACE_DOUBT ? checks[i].p : NAN;
    }
    stats_holm( p, count, count, LEVEL, is_slower );
    for ( int i = 0; i < count; ++i )
    {
        checks[i].pace = is_slower[i] ? PACE_SLOWER : checks[i].pace;
    }
}

static wisp_status find_own_path( char* out, size_t size, wisp_error* error )
{
    const ssize_t length = readlink( "/proc/self/exe", out, size - 1 );
    out[length > 0 ? length : 0] = '\0';
    return length > 0 ? WISP_OK
                      : wisp_fail( error, WISP_IO_ERROR, "gate: this program was not found: %s", strerror( errno ) );
}

wisp_status gate_compare_programs( const wisp_suite* suite, const char* suite_path, const char* old_program,
                                   const char* isa, progress* bar, gate_pair_check* out, wisp_error* error )
{
    char own[4096];
    wisp_status status = find_own_path( own, sizeof own, error );
    const timed_program programs[] = { { old_program, 0.0 }, { own, 0.0 } };
    for ( int i = 0; i < suite->row_count && status == WISP_OK; ++i )
    {
        progress_show( bar, (double)i / suite->row_count, suite->rows[i].name );
        status = compare_row( i, programs, suite_path, isa, out + i, error );
    }
    if ( status == WISP_OK )
    {
        decide( suite->row_count, out );
    }
    return status;
}

// ---- self-test ----

// Bounds of a rate of 95 % (Wilson 1927).
static void bound_rate( int found, int trials, double* lower, double* upper )
{
    const double z = 1.96, n = trials, rate = found / n, centre = rate + z * z / ( 2.0 * n );
    const double half = z * sqrt( rate * ( 1.0 - rate ) / n + z * z / ( 4.0 * n * n ) );
    *lower = ( centre - half ) / ( 1.0 + z * z / n );
    *upper = ( centre + half ) / ( 1.0 + z * z / n );
}

wisp_status gate_self_test( const wisp_suite* suite, const char* suite_path, int number, const char* isa, int trials,
                            progress* bar, results* out, wisp_error* error )
{
    static const double slow[] = { 0.0, 0.02, 0.03, 0.05 };
    const char* const header[] = { "slower by", "gates", "found", "rate", "from", "to", "not measurable" };
    const int table = results_add_table( out, "What the gate finds of itself", WISP_COUNT( header ), header );
    char own[4096];
    wisp_status status = find_own_path( own, sizeof own, error );
    for ( int k = 0; k < WISP_COUNT( slow ) && status == WISP_OK; ++k )
    {
        const timed_program programs[] = { { own, 0.0 }, { own, slow[k] } };
        int found = 0, unmeasured = 0;
        for ( int t = 0; t < trials && status == WISP_OK; ++t )
        {
            gate_pair_check check = { 0 };
            char what[64];
            snprintf( what, sizeof what, "%.0f %% slower, gate %d of %d", 100.0 * slow[k], t + 1, trials );
            progress_show( bar, ( k + (double)t / trials ) / WISP_COUNT( slow ), what );
            status = compare_row( number, programs, suite_path, isa, &check, error );
            decide( 1, &check );
            found += status == WISP_OK && check.pace == PACE_SLOWER ? 1 : 0;
            unmeasured += status == WISP_OK && check.pace == PACE_NOT_MEASURABLE ? 1 : 0;
        }
        double lower, upper;
        bound_rate( found, trials, &lower, &upper );
        char cells[7][24];
        snprintf( cells[0], sizeof cells[0], "%.0f %%", 100.0 * slow[k] );
        snprintf( cells[1], sizeof cells[1], "%d", trials );
        snprintf( cells[2], sizeof cells[2], "%d", found );
        snprintf( cells[3], sizeof cells[3], "%.1f %%", 100.0 * found / trials );
        snprintf( cells[4], sizeof cells[4], "%.1f %%", 100.0 * lower );
        snprintf( cells[5], sizeof cells[5], "%.1f %%", 100.0 * upper );
        snprintf( cells[6], sizeof cells[6], "%d", unmeasured );
        results_add_cells(
            out, table,
            ( const char* const[] ){ cells[0], cells[1], cells[2], cells[3], cells[4], cells[5], cells[6] } );
    }
    if ( status == WISP_OK )
    {
        results_add_note( out, "gate %s: row %s, slowed down by 0 %%: what is found there is a false alarm",
                          suite->name, suite->rows[number].name );
    }
    return status;
}

// ---- the report ----

void gate_report_pairs( const wisp_suite* suite, const gate_pair_check* checks, results* out )
{
    static const char* const names[PACE_COUNT] = { "as fast", "in doubt", "not measurable", "slower" };
    const char* const header[] = { "row", "verdict", "time", "from", "to", "noise", "rounds" };
    const int table = results_add_table( out, "Time against the other program", WISP_COUNT( header ), header );
    int counts[PACE_COUNT] = { 0 };
    for ( int i = 0; i < suite->row_count; ++i )
    {
        const gate_pair_check* c = checks + i;
        char name[SUITE_MAX_NAME + SUITE_MAX_VARIANT + 2], cells[5][24];
        snprintf( name, sizeof name, "%s%s%s", suite->rows[i].name, suite->rows[i].variant[0] ? ", " : "",
                  suite->rows[i].variant );
        const double logs[] = { c->slower, c->lower, c->upper };
        for ( int k = 0; k < 3; ++k )
        {
            snprintf( cells[k], sizeof cells[k], "%+.1f %%", 100.0 * expm1( logs[k] ) );
        }
        snprintf( cells[3], sizeof cells[3], "%.1f %%", 100.0 * c->noise );
        snprintf( cells[4], sizeof cells[4], "%d", c->rounds );
        results_add_cells(
            out, table,
            ( const char* const[] ){ name, names[c->pace], cells[0], cells[1], cells[2], cells[3], cells[4] } );
        counts[c->pace] += 1;
        results_row* row = results_add_row( out, suite->rows[i].name, suite->rows[i].variant );
        if ( row != NULL )
        {
            results_put( &row->size, "is_slower", c->pace == PACE_SLOWER ? 1.0 : 0.0 );
            results_put( &row->size, "is_as_fast", c->pace == PACE_FINE ? 1.0 : 0.0 );
            results_put( &row->size, "ratio", exp( c->slower ) );
            results_put( &row->size, "ratio_lower", exp( c->lower ) );
            results_put( &row->size, "ratio_upper", exp( c->upper ) );
            results_put( &row->size, "noise", c->noise );
            results_put( &row->size, "rounds", c->rounds );
            results_put( &row->size, "p", c->p );
        }
    }
    results_add_note(
        out, "gate %s: time: %s: %d rows, %d as fast, %d in doubt, %d not measurable, %d slower", suite->name,
        counts[PACE_SLOWER] > 0                                ? "regression"
        : counts[PACE_DOUBT] + counts[PACE_NOT_MEASURABLE] > 0 ? "inconclusive"
                                                               : "pass",
        suite->row_count, counts[PACE_FINE], counts[PACE_DOUBT], counts[PACE_NOT_MEASURABLE], counts[PACE_SLOWER] );
}
