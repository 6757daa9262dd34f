/// Passes that every world has.
#pragma once

#include "wisp/module/module.h"

wisp_status passes_declare( wisp_registry* registry );

wisp_status passes_declare_particles( wisp_registry* registry );
wisp_status passes_declare_carry( wisp_registry* registry );
wisp_status passes_declare_levels( wisp_registry* registry );
wisp_status passes_declare_max_speed( wisp_registry* registry );
wisp_status passes_declare_tethers( wisp_registry* registry );
wisp_status passes_declare_uncarry( wisp_registry* registry );
wisp_status passes_declare_constraints( wisp_registry* registry );
wisp_status passes_declare_state_check( wisp_registry* registry );
wisp_status passes_declare_surface( wisp_registry* registry );
wisp_status passes_declare_instances( wisp_registry* registry );
