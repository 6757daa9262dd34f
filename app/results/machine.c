#include "machine.h"

#include "build_commit.h"
#include "build_facts.h"
#include "wisp/base.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

// The value of the first line "key<blanks>mark value" of a file, without quotes and the newline.
static bool read_value( const char* path, const char* key, char mark, char* out, size_t size )
{
    FILE* file = fopen( path, "r" );
    if ( !file )
    {
        return false;
    }
    char line[8192];
    bool found = false;
    while ( !found && fgets( line, sizeof( line ), file ) )
    {
        char* value = strchr( line, mark );
        if ( strncmp( line, key, strlen( key ) ) == 0 && value )
        {
            value += 1 + strspn( value + 1, " \t\"" );
            value[strcspn( value, "\"\n" )] = '\0';
            snprintf( out, size, "%s", value );
            found = true;
        }
    }
    fclose( file );
    return found;
}

static void describe_system( machine_info* info )
{
    char distribution[64] = "";
    read_value( "/etc/os-release", "PRETTY_NAME", '=', distribution, sizeof( distribution ) );

    struct utsname name;
    if ( uname( &name ) == 0 )
    {
        snprintf( info->os, sizeof( info->os ), "%s%s%.32s %.64s", distribution, *distribution ? ", " : "",
                  name.sysname, name.release );
        snprintf( info->host, sizeof( info->host ), "%.64s", name.nodename );
    }
}

// Vector instruction sets among all flags of the processor.
static void describe_flags( machine_info* info )
{
    static const char* const beginnings[] = { "sse", "ssse", "avx", "fma", "f16c", "bmi", "asimd", "sve" };
    char all[8192] = "";
    read_value( "/proc/cpuinfo", "flags", ':', all, sizeof all );
    char* rest = NULL;
    for ( char* flag = strtok_r( all, " ", &rest ); flag; flag = strtok_r( NULL, " ", &rest ) )
    {
        for ( int i = 0; i < WISP_COUNT( beginnings ); ++i )
        {
            const size_t used = strlen( info->cpu_flags );
            if ( strncmp( flag, beginnings[i], strlen( beginnings[i] ) ) == 0 &&
                 used + strlen( flag ) + 2 < sizeof info->cpu_flags )
            {
                snprintf( info->cpu_flags + used, sizeof info->cpu_flags - used, "%s%s", used > 0 ? " " : "", flag );
            }
        }
    }
}

double machine_cpu_seconds( void )
{
    struct timespec now;
    return clock_gettime( CLOCK_PROCESS_CPUTIME_ID, &now ) == 0 ? (double)now.tv_sec + 1e-9 * (double)now.tv_nsec
                                                                : NAN;
}

const char* machine_kernels( void )
{
    return WISP_BUILD_KERNELS;
}

machine_info machine_describe( const char* isa )
{
    machine_info info = {
        .cpu = "unknown",
        .os = "unknown",
        .host = "unknown",
        .version = WISP_VERSION_STRING,
        .commit = WISP_BUILD_COMMIT,
        .build_type = WISP_BUILD_TYPE,
    };
    snprintf( info.compiler, sizeof info.compiler, "%s", WISP_BUILD_COMPILER );
    snprintf( info.flags, sizeof info.flags, "%s", WISP_BUILD_FLAGS );
    snprintf( info.isa, sizeof( info.isa ), "%s", isa );
    describe_system( &info );
    describe_flags( &info );
    const time_t now = time( NULL );
    struct tm utc;
    if ( gmtime_r( &now, &utc ) )
    {
        strftime( info.date, sizeof info.date, "%Y-%m-%dT%H:%M:%SZ", &utc );
    }
    read_value( "/proc/cpuinfo", "model name", ':', info.cpu, sizeof( info.cpu ) );

    char mhz[32];
    if ( read_value( "/proc/cpuinfo", "cpu MHz", ':', mhz, sizeof( mhz ) ) )
    {
        info.mhz = strtod( mhz, NULL );
    }
    long cores = sysconf( _SC_NPROCESSORS_ONLN );
    long pages = sysconf( _SC_PHYS_PAGES ), page_size = sysconf( _SC_PAGE_SIZE );
    info.cores = cores > 0 ? (int)cores : 0;
    info.memory_bytes = pages > 0 && page_size > 0 ? (double)pages * (double)page_size : 0.0;
    return info;
}
