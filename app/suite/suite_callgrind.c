#include "suite_callgrind.h"

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

// Run `wisp gate step` under callgrind, which counts inside of wisp_world_step(). Its environment is empty, because the C library
// and the place of the stack depend on it.
static _Noreturn void be_child( const char* program, const char* suite, int number, const char* out )
{
    char row[16], file[MAX_PATH + 32];
    snprintf( row, sizeof row, "--row=%d", number );
    snprintf( file, sizeof file, "--callgrind-out-file=%s", out );
    char* const arguments[] = { "valgrind",
                                "--tool=callgrind",
                                "--toggle-collect=wisp_world_step",
                                "--dump-instr=yes", // tells passes by the addresses of their functions
                                "--compress-pos=no",
                                "--compress-strings=no",
                                file,
                                "--",
                                (char*)(uintptr_t)program,
                                "gate",
                                "step",
                                row,
                                "--isa=avx2",
                                (char*)(uintptr_t)suite,
                                NULL };
    char* const environment[] = { "PATH=/usr/local/bin:/usr/bin:/bin", "LC_ALL=C", NULL };
    const int nothing = open( "/dev/null", O_RDWR );
    dup2( nothing, STDIN_FILENO );
    dup2( nothing, STDOUT_FILENO );
    dup2( nothing, STDERR_FILENO );
    execvpe( "valgrind", arguments, environment );
    _exit( 127 );
}

// ---- the file that callgrind writes ----

typedef struct call
{
    char caller[160], callee[160]; // without the marks of recursion
    uintptr_t code;                // of the callee, in its file
    double instructions;
} call;

static void copy_name( const char* from, char* out, size_t size )
{
    snprintf( out, size, "%.*s", (int)strcspn( from, "\n'" ), from );
}

// The next call of a file; `caller` lasts from one to the next. @param total receives the sum when its line comes
static bool next_call( FILE* file, call* out, double* total )
{
    char line[4096];
    while ( fgets( line, sizeof line, file ) )
    {
        if ( strncmp( line, "totals:", 7 ) == 0 )
        {
            *total = strtod( line + 7, NULL );
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
            const char* cost = fgets( line, sizeof line, file ) ? strrchr( line, ' ' ) : NULL;
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
static double read_counts( const char* path, suite_measurement* out )
{
    char names[SUITE_MAX_PASSES][160] = { "" };
    double total = NAN;
    uintptr_t bias = 0;
    dl_iterate_phdr( keep_bias, &bias );
    FILE* file = fopen( path, "r" );
    for ( int round = 0; round < 2 && file; ++round )
    {
        call c = { .caller = "" };
        rewind( file );
        while ( next_call( file, &c, &total ) )
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
    return total;
}

wisp_status suite_count_instructions( const char* suite, int number, suite_measurement* out, wisp_error* error )
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
        be_child( program, suite, number, path );
    }
    int ended = -1;
    const bool is_over = child > 0 && waitpid( child, &ended, 0 ) == child;
    const bool is_good = is_over && WIFEXITED( ended ) && WEXITSTATUS( ended ) == 0;
    out->values[SUITE_INSTRUCTIONS] = is_good ? read_counts( path, out ) : NAN;
    unlink( path );
    if ( !( out->values[SUITE_INSTRUCTIONS] > 0.0 ) )
    {
        return wisp_fail( error, WISP_IO_ERROR, "gate: valgrind %s",
                          is_over && WIFEXITED( ended ) && WEXITSTATUS( ended ) == 127
                              ? "is not installed; --no-instructions gates without it"
                              : "counted no instructions of this row" );
    }
    return WISP_OK;
}
