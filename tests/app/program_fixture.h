/// Runs the built program and reads exit status, standard output and error stream.
#pragma once

#include "files.h"

#include "wisp/base.h"

#include <fcntl.h>
#include <ftw.h>
#include <sys/wait.h>

#define OUTPUT_MAX 262144
#define ARGUMENTS_MAX 24

static char program[4096];

/// Find the program, whose path is the only argument of main().
static inline bool find_program( int argc, char** argv )
{
    const bool found = argc == 2 && realpath( argv[1], program ) != NULL;
    if ( !found )
    {
        fprintf( stderr, "usage: %s PROGRAM\n", argv[0] );
    }
    return found;
}

/// Results of a run.
typedef struct run_result
{
    int status; ///< exit status, -1 if a signal ended it
    char out[OUTPUT_MAX], err[OUTPUT_MAX];
} run_result;

static run_result result;

// ---- starting it ----

static inline void read_back( FILE* file, char* text )
{
    rewind( file );
    text[fread( text, 1, OUTPUT_MAX - 1, file )] = '\0';
    fclose( file );
}

static inline _Noreturn void become_program( char** arguments, int out, int err )
{
    dup2( out, STDOUT_FILENO );
    dup2( err, STDERR_FILENO );
    execv( program, arguments );
    _exit( 127 );
}

static inline int wait_for( pid_t child )
{
    int status = 0;
    assert_int_equal( waitpid( child, &status, 0 ), child );
    return WIFEXITED( status ) ? WEXITSTATUS( status ) : -1;
}

/// Words of a command line, split at blanks.
static inline void split( char* line, char** arguments )
{
    int count = 0;
    arguments[count++] = program;
    for ( char* word = strtok( line, " " ); word && count < ARGUMENTS_MAX; word = strtok( NULL, " " ) )
    {
        arguments[count++] = word;
    }
    arguments[count] = NULL;
}

/// Run the program with its two streams in files; fills `result`.
static inline void run( const char* command )
{
    char line[1024], *arguments[ARGUMENTS_MAX + 1];
    snprintf( line, sizeof( line ), "%s", command );
    split( line, arguments );
    FILE *out = tmpfile(), *err = tmpfile();
    assert_true( out && err );
    pid_t child = fork();
    if ( child == 0 )
    {
        become_program( arguments, fileno( out ), fileno( err ) );
    }
    result.status = wait_for( child );
    read_back( out, result.out );
    read_back( err, result.err );
}

static inline int line_count( const char* text )
{
    int count = 0;
    for ( ; *text; ++text )
    {
        count += *text == '\n';
    }
    return count;
}

/// The run must succeed.
static inline void run_ok( const char* command )
{
    run( command );
    if ( result.status != 0 )
    {
        fail_msg( "'%s' ended with %d and said: %s", command, result.status, result.err );
    }
}

// ---- a folder of its own ----

static inline int remove_entry( const char* path, const struct stat* info, int kind, struct FTW* place )
{
    (void)info;
    (void)kind;
    (void)place;
    return remove( path );
}

/// Make a folder and enter it. @return 0, or -1
static inline int enter_new_folder( void** state )
{
    static char folder[] = P_tmpdir "/wisp_program_XXXXXX";
    *state = mkdtemp( folder );
    unsetenv( "NO_COLOR" );
    return *state && chdir( folder ) == 0 ? 0 : -1;
}

typedef struct text_file
{
    const char *name, *text;
} text_file;

/// Make a folder, enter it and write files. @return 0, or -1
static inline int enter_folder_with( void** state, const text_file* files, int count )
{
    const int status = enter_new_folder( state );
    for ( int i = 0; i < count && status == 0; ++i )
    {
        write_text( files[i].name, files[i].text );
    }
    return status;
}

/// Remove the folder with everything that the program left in it.
static inline int leave_folder( void** state )
{
    return chdir( "/" ) == 0 ? nftw( *state, remove_entry, 8, FTW_DEPTH | FTW_PHYS ) : -1;
}
