#include "kernel_tables.h"

#include <stdlib.h>
#include <string.h>

// A build for this machine alone (-Dkernels=native) leaves sets out.
extern const wisp_kernels kernels_baseline;
#if defined( __x86_64__ ) && !defined( WISP_WITHOUT_AVX2 )
extern const wisp_kernels kernels_avx2;
#define AVX2 &kernels_avx2
#else
#define AVX2 NULL
#endif
#if defined( __x86_64__ ) && !defined( WISP_WITHOUT_AVX512 )
extern const wisp_kernels kernels_avx512;
#define AVX512 &kernels_avx512
#else
#define AVX512 NULL
#endif

typedef struct isa
{
    const char* name;
    const wisp_kernels* kernels; ///< null: this build has none
    bool is_supported;           ///< by this processor
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
        { "avx2", AVX2, __builtin_cpu_supports( "avx2" ) },
        { "avx512", AVX512, avx512 },
    };
#else
    const isa known[] = { { "baseline", &kernels_baseline, true },
                          { "avx2", NULL, false },
                          { "avx512", NULL, false } };
#endif
    const wisp_kernels* best = NULL;
    for ( int i = 0; i < WISP_COUNT( known ); ++i )
    {
        const bool is_cap = cap != NULL && strcmp( cap, known[i].name ) == 0;
        if ( is_cap && known[i].is_supported && known[i].kernels == NULL )
        {
            wisp_fail( error, WISP_BAD_INPUT, "%s: got '%s', which this build leaves out; -Dkernels=all has it",
                       source, cap );
            return NULL;
        }
        best = known[i].is_supported && known[i].kernels != NULL ? known[i].kernels : best;
        if ( is_cap )
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
