#include "suite_callgrind.h"

#include "interruption.h"

#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

// ---- the process ----

enum
{
    MAX_PATH = 4096,
};

// Run `wisp gate step` under callgrind, which counts inside of wisp_world_step(), and what the self-test wastes. Its environment
// is empty, because the C library and the place of the stack depend on it.
static _Noreturn void be_child( const char* program, const char* suite, int number,
                                const suite_count_options* options, const char* out )
{
    char row[16], file[MAX_PATH + 32];
    snprintf( row, sizeof row, "--row=%d", number );
    snprintf( file, sizeof file, "--callgrind-out-file=%s", out );
    char* const arguments[] = { "valgrind",
                                "--tool=callgrind",
                                "--toggle-collect=wisp_world_step",
                                "--toggle-collect=gate_slow_waste",
                                "--dump-instr=yes", // tells passes by the addresses of their functions
                                "--compress-pos=no",
                                "--compress-strings=no",
                                options->has_cycles ? "--cache-sim=yes" : "--cache-sim=no",
                                "--I1=32768,8,64", // caches of one machine, whatever this one has
                                "--D1=32768,8,64",
                                "--LL=4194304,16,64",
                                file,
                                "--",
                                (char*)(uintptr_t)program,
                                "gate",
                                "step",
                                row,
                                "--isa=avx2",
                                (char*)(uintptr_t)suite,
                                (char*)(uintptr_t)options->step,
                                NULL };
    char* const environment[] = { "PATH=/usr/local/bin:/usr/bin:/bin", "LC_ALL=C", NULL };
    interruption_leave_to_parent();
    const int nothing = open( "/dev/null", O_RDWR );
    dup2( nothing, STDIN_FILENO );
    dup2( nothing, STDOUT_FILENO );
    dup2( nothing, STDERR_FILENO );
    execvpe( "valgrind", arguments, environment );
    _exit( 127 );
}

// ---- the file that callgrind writes ----

// What callgrind counts, in the order of its columns.
enum
{
    INSTRUCTIONS,
    READS,
    WRITES,
    MISSES_I1,
    MISSES_D1_READ,
    MISSES_D1_WRITE,
    MISSES_LL_CODE,
    MISSES_LL_READ,
    MISSES_LL_WRITE,
    EVENTS,
};

// Cycles that a miss or a slow instruction is taken to cost, beyond the one of the instruction.
static const double FIRST_LEVEL = 10.0, LAST_LEVEL = 100.0, SLOW = 10.0;

typedef struct call
{
    char caller[160], callee[160]; // without the marks of recursion
    uintptr_t code;                // of the callee, in its file
    double instructions;
} call;

// What a file says beside its calls.
typedef struct totals
{
    double events[EVENTS]; // NaN: the file has no such line
    double slow;           // divisions and roots of the program
    bool is_program;       // whether lines are of the program, not of a library
} totals;

static void copy_name( const char* from, char* out, size_t size )
{
    snprintf( out, size, "%.*s", (int)strcspn( from, "\n'" ), from );
}

// Whether an instruction divides or takes a root, which takes several times as long as others.
static bool is_slow( const uint8_t* code )
{
#if defined( __x86_64__ )
    while ( *code == 0x66 || *code == 0xf2 || *code == 0xf3 || ( *code & 0xf0 ) == 0x40 )
    {
        ++code; // prefixes
    }
    if ( *code == 0xf6 || *code == 0xf7 ) // of integers
    {
        return ( code[1] & 0x30 ) == 0x30;
    }
    const bool is_map = *code == 0x0f || *code == 0xc5 || ( *code == 0xc4 && ( code[1] & 0x1f ) == 1 ) ||
                        ( *code == 0x62 && ( code[1] & 0x07 ) == 1 );
    const uint8_t operation = code[*code == 0x0f ? 1 : *code == 0xc5 ? 2 : *code == 0xc4 ? 3 : 4];
    return is_map && ( operation == 0x5e || operation == 0x51 );
#else
    (void)code;
    return false;
#endif
}

// A line of an instruction: its address, the line of its source, and what it cost. @param bias where the program was loaded
static void add_own_cost( const char* line, uintptr_t bias, totals* t )
{
    char* end;
    const uintptr_t place = (uintptr_t)strtoull( line, &end, 16 ) + bias;
    (void)strtol( end, &end, 10 );
    const double count = strtod( end, NULL );
    t->slow += t->is_program && is_slow( (const uint8_t*)place ) ? count : 0.0;
}

static void read_totals( const char* text, totals* t )
{
    char* end = (char*)(uintptr_t)text;
    for ( int i = 0; i < EVENTS; ++i ) // without caches there is one
    {
        t->events[i] = strtod( end, &end );
    }
}

// The next call of a file; `caller` lasts from one to the next. @param t receives what is not of calls
static bool next_call( FILE* file, const char* program, uintptr_t bias, call* out, totals* t )
{
    char line[4096];
    while ( fgets( line, sizeof line, file ) )
    {
        if ( strncmp( line, "totals:", 7 ) == 0 )
        {
            read_totals( line + 7, t );
        }
        else if ( strncmp( line, "ob=", 3 ) == 0 )
        {
            line[strcspn( line, "\n" )] = '\0';
            t->is_program = strcmp( line + 3, program ) == 0;
        }
        else if ( line[0] == '0' )
        {
            add_own_cost( line, bias, t );
        }
        else if ( strncmp( line, "fn=", 3 ) == 0 )
        {
            copy_name( line + 3, out->caller, sizeof out->caller );
        }
        else if ( strncmp( line, "cfn=", 4 ) == 0 )
        {
            copy_name( line + 4, out->callee, sizeof out->callee );
        }
        else if ( strncmp( line, "calls=", 6 ) == 0 )
        {
            // calls=COUNT CODE LINE, then a line with the place of the call, its line and what it cost
            const char* place = strchr( line, ' ' );
            out->code = place ? (uintptr_t)strtoull( place, NULL, 16 ) : 0;
            char* cost = fgets( line, sizeof line, file ) ? strchr( line, ' ' ) : NULL;
            cost = cost ? strchr( cost + 1, ' ' ) : NULL;
            out->instructions = cost ? strtod( cost, NULL ) : 0.0;
            return true;
        }
    }
    return false;
}

// Where the program was loaded, since files have addresses without that.
static int keep_bias( struct dl_phdr_info* info, size_t size, void* user )
{
    (void)size;
    *(uintptr_t*)user = (uintptr_t)info->dlpi_addr;
    return 1; // the first is the program
}

static suite_pass* pass_at( suite_measurement* m, uintptr_t code )
{
    for ( int i = 0; i < m->pass_count; ++i )
    {
        if ( m->passes[i].code == code )
        {
            return &m->passes[i];
        }
    }
    return NULL;
}

// Calls of passes count with all that they call, unless a pass makes them: that has them already.
static totals read_counts( const char* path, const char* program, suite_measurement* out )
{
    char names[SUITE_MAX_PASSES][160] = { "" };
    totals t = { .events = { NAN } };
    uintptr_t bias = 0;
    dl_iterate_phdr( keep_bias, &bias );
    FILE* file = fopen( path, "r" );
    for ( int round = 0; round < 2 && file; ++round )
    {
        call c = { .caller = "" };
        t = ( totals ){ .events = { NAN } };
        rewind( file );
        while ( next_call( file, program, bias, &c, &t ) )
        {
            suite_pass* pass = pass_at( out, c.code + bias );
            bool is_inside = false;
            for ( int i = 0; i < out->pass_count; ++i )
            {
                is_inside = is_inside || strcmp( names[i], c.caller ) == 0;
            }
            if ( pass && round == 0 )
            {
                snprintf( names[pass - out->passes], sizeof names[0], "%s", c.callee );
            }
            else if ( pass && !is_inside )
            {
                pass->instructions = ( isfinite( pass->instructions ) ? pass->instructions : 0.0 ) + c.instructions;
            }
        }
    }
    if ( file )
    {
        fclose( file );
    }
    return t;
}

static void keep_counts( const totals* t, bool has_cycles, suite_measurement* out )
{
    const double* e = t->events;
    out->values[SUITE_INSTRUCTIONS] = e[INSTRUCTIONS];
    const double first = e[MISSES_I1] + e[MISSES_D1_READ] + e[MISSES_D1_WRITE];
    const double last = e[MISSES_LL_CODE] + e[MISSES_LL_READ] + e[MISSES_LL_WRITE];
    out->values[SUITE_CYCLES] =
        has_cycles ? e[INSTRUCTIONS] + FIRST_LEVEL * first + LAST_LEVEL * last + SLOW * t->slow : NAN;
}

wisp_status suite_count_instructions( const char* suite, int number, const suite_count_options* options,
                                      suite_measurement* out, wisp_error* error )
{
    char program[MAX_PATH], path[] = "/tmp/wisp-gate-XXXXXX";
    const ssize_t length = readlink( "/proc/self/exe", program, sizeof program - 1 );
    const int file = length > 0 ? mkstemp( path ) : -1;
    if ( file < 0 )
    {
        return wisp_fail( error, WISP_IO_ERROR, "gate: no file for counts of instructions: %s", strerror( errno ) );
    }
    close( file );
    program[length] = '\0';
    fflush( NULL );
    const pid_t child = fork();
    if ( child == 0 )
    {
        be_child( program, suite, number, options, path );
    }
    int ended = 0xff00;
    if ( child > 0 )
    {
        interruption_wait( child, &ended );
    }
    const bool is_good = WIFEXITED( ended ) && WEXITSTATUS( ended ) == 0;
    const totals t = is_good ? read_counts( path, program, out ) : ( totals ){ .events = { NAN } };
    keep_counts( &t, options->has_cycles, out );
    unlink( path );
    if ( !is_good && interruption_came() )
    {
        return interruption_check( error );
    }
    if ( !( out->values[SUITE_INSTRUCTIONS] > 0.0 ) )
    {
        return wisp_fail( error, WISP_IO_ERROR, "gate: valgrind %s",
                          WIFEXITED( ended ) && WEXITSTATUS( ended ) == 127
                              ? "is not installed; --no-instructions gates without it"
                              : "counted no instructions of this row" );
    }
    return WISP_OK;
}
