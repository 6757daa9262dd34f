#include "kernel_tables.h"

#include <stdlib.h>
#include <string.h>

extern const wisp_kernels kernels_baseline;
#if defined( __x86_64__ )
extern const wisp_kernels kernels_avx2;
extern const wisp_kernels kernels_avx512;
#endif

typedef struct isa
{
    const char* name;
    const wisp_kernels* kernels;
    bool usable;
} isa;

const wisp_kernels* kernels_select( const char* cap, wisp_error* error )
{
    const char* source = cap != NULL ? "isa" : "WISP_ISA in the environment";
    cap = cap != NULL ? cap : getenv( "WISP_ISA" );
#if defined( __x86_64__ )
    bool avx512 = __builtin_cpu_supports( "avx512f" ) && __builtin_cpu_supports( "avx512vl" ) &&
                  __builtin_cpu_supports( "avx512bw" ) && __builtin_cpu_supports( "avx512dq" );
    const isa known[] = {
        { "baseline", &kernels_baseline, true },
        { "avx2", &kernels_avx2, __builtin_cpu_supports( "avx2" ) },
        { "avx512", &kernels_avx512, avx512 },
    };
#else
    const isa known[] = { { "baseline", &kernels_baseline, true },
                          { "avx2", NULL, false },
                          { "avx512", NULL, false } };
#endif
    const wisp_kernels* best = NULL;
    for ( int i = 0; i < WISP_COUNT( known ); ++i )
    {
        best = known[i].usable ? known[i].kernels : best;
        if ( cap != NULL && strcmp( cap, known[i].name ) == 0 )
        {
            return best;
        }
    }
    if ( cap != NULL && cap[0] != 0 )
    {
        wisp_fail( error, WISP_BAD_INPUT, "%s: got '%s', expected baseline, avx2 or avx512", source, cap );
        return NULL;
    }
    return best;
}
