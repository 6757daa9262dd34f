#include "strands_setting.h"

// As other engines were measured: ten substeps of one pass. The most important ones come first.
const strands_setting strands_comparison_settings[] = {
    { "direct, bend links", WISP_STRAND_STRETCH_DIRECT, WISP_STRAND_BEND_LINKS, 2, 10 },
    { "direct, rod", WISP_STRAND_STRETCH_DIRECT, WISP_STRAND_BEND_ROD, 2, 10 },
    { "links, bend links", WISP_STRAND_STRETCH_LINKS, WISP_STRAND_BEND_LINKS, 2, 10 },
    { "direct one pass, bend links", WISP_STRAND_STRETCH_DIRECT, WISP_STRAND_BEND_LINKS, 1, 10 },
    { "direct, rod", WISP_STRAND_STRETCH_DIRECT, WISP_STRAND_BEND_ROD, 2, 4 },
};
const int strands_comparison_setting_count = WISP_COUNT( strands_comparison_settings );

wisp_strand_dynamics_def strands_setting_dynamics( const strands_setting* setting )
{
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    def.stretch = setting->stretch;
    def.stretch_passes = setting->passes;
    def.bending = setting->bend;
    def.bend_compliance = STRANDS_BEND_COMPLIANCE;
    def.rest = WISP_STRAND_REST_STRAIGHT;
    def.clamped = false;
    return def;
}
