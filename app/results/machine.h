/// The environment of a measurement: without it, a time has no meaning.
#pragma once

typedef struct machine_info
{
    char cpu[128]; ///< model name as given by the kernel
    char os[192];  ///< distribution and kernel
    char host[65];
    int cores;           ///< processors that are online
    double memory_bytes; ///< physical memory
    double mhz;          ///< of the first processor now; 0: unknown
    char isa[16];        ///< instruction set that the engine's kernels use
    char cpu_flags[256]; ///< vector instruction sets of the processor, as the kernel names them
    char date[24];       ///< of the description, in UTC as 2026-01-31T23:59:59Z

    char version[32];    ///< of this program
    char commit[64];     ///< "unknown" outside a git checkout
    char compiler[128];  ///< name and version
    char flags[1000];    ///< those that affect speed and rounding
    char build_type[32]; ///< meson's
} machine_info;

/// The instruction sets whose kernels this build has, such as "baseline avx2 avx512".
const char* machine_kernels( void );

/// Read the facts from the running system. Missing ones are "unknown" or 0.
/// @param isa instruction set in use, as wisp_world_isa() names it
machine_info machine_describe( const char* isa );

/// Processor time that all threads of this process have taken. NaN: unknown.
double machine_cpu_seconds( void );
