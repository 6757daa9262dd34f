#include "kernel_isa.h"

#define TEXT_NOW( name ) #name
#define TEXT( name ) TEXT_NOW( name )

extern const wisp_kernels LANE_JOIN( kernels_, WISP_KERNEL_ISA );

const wisp_kernels LANE_JOIN( kernels_, WISP_KERNEL_ISA ) = {
    .isa = TEXT( WISP_KERNEL_ISA ),
#define WISP_KERNEL( result, name, ... ) .name = KERNEL( name ),
#if defined( WISP_WITHOUT_HAIR )
#define WISP_STRAND_KERNEL( result, name, ... )
#endif
#include "wisp/module/kernel_list.h"
};
