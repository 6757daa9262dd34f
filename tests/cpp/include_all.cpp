// Every public header compiles as C++, in one program, and links as C. The build fails if a header is missing here.
#include "wisp/base.h"
#include "wisp/explain.h"
#include "wisp/fabric.h"
#include "wisp/generate.h"
#include "wisp/lines.h"
#include "wisp/maps.h"
#include "wisp/module/jobs.h"
#include "wisp/module/anchor.h"
#include "wisp/module/collision_mesh.h"
#include "wisp/samples.h"
#include "wisp/shapes.h"
#include "wisp/moving_frame.h"
#include "wisp/skin.h"
#include "wisp/detail.h"
#include "wisp/sleep.h"
#include "wisp/wisp.h"

#include "wisp/module/aabb_pairs.h"
#include "wisp/module/components.h"
#include "wisp/module/corrected.h"
#include "wisp/module/definition.h"
#include "wisp/module/elastic_triangles.h"
#include "wisp/module/instances.h"
#include "wisp/module/intersections.h"
#include "wisp/module/kernel_list.h"
#include "wisp/module/kernels.h"
#include "wisp/module/module.h"
#include "wisp/module/plate.h"
#include "wisp/module/primitives.h"
#include "wisp/module/random.h"
#include "wisp/module/sampling.h"
#include "wisp/module/shapes.h"
#include "wisp/module/detail.h"
#include "wisp/module/double3.h"
#include "wisp/module/sleep.h"
#include "wisp/module/space.h"
#include "wisp/module/springs.h"
#include "wisp/module/taper.h"
#include "wisp/module/strand_kernels.h"
#include "wisp/module/surface_kernels.h"
#include "wisp/module/particle_batch.h"
#include "wisp/module/vec.h"

#include "attachments.h"
#include "balloon.h"
#include "boundary.h"
#include "create.h"
#include "environment.h"
#include "cloth.h"
#include "collision.h"
#include "contact.h"
#include "frozen_hair.h"
#include "guide_hair.h"
#include "implicit_cloth.h"
#include "motion_constraints.h"
#include "pick.h"
#include "membrane.h"
#include "seams.h"
#include "strand_appearance.h"
#include "strands.h"
#include "tearing.h"
#include "wisp.hpp"

#include <cstdio>

// A module written in C++ declares itself like one written in C.
static wisp_status declare( wisp_registry* registry )
{
    static const wisp_column_def columns[] = { WISP_COLUMN_DEF( float, value, 1 ) };
    const wisp_component_def component = { "cpp.value", WISP_TABLE_ENTITY, columns, WISP_COUNT( columns ) };
    return wisp_declare_component( registry, &component ) != 0 ? WISP_OK : WISP_NO_MEMORY;
}

static bool can_step( const wisp_module* const* modules, int count )
{
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.modules = modules;
    def.module_count = count;
    def.workers = 1;
    wisp_world* world = nullptr;
    wisp_error error = {};
    if ( wisp_world_create( &def, &world, &error ) != WISP_OK )
    {
        std::printf( "no world: %s\n", error.message );
        return false;
    }
    const bool good = wisp_world_step( world, 1.0f / 60.0f ) == WISP_OK;
    wisp_world_destroy( world );
    return good;
}

// What a header defines inline works here too.
static bool draws_numbers()
{
    const wisp_random_key key = wisp_random_make_key( 1, 2, 3 );
    const double unit = wisp_random_unit( key, 4, 5, 6 );
    return unit >= 0.0 && unit < 1.0 && wisp_random_unit_float( key, 4, 5, 6 ) <= static_cast<float>( unit );
}

int main()
{
    const wisp_module own = { "cpp", declare };
    const wisp_module* const modules[] = { &wisp_environment_module, &wisp_frozen_hair_module,
                                           &wisp_strand_appearance_module, &own };
    const bool stepped = can_step( modules, WISP_COUNT( modules ) );
    const bool drew = draws_numbers();
    std::printf( "a world with a module in C++ steps: %s\nrandom numbers: %s\n", stepped ? "yes" : "no",
                 drew ? "yes" : "no" );
    return stepped && drew ? 0 : 1;
}
