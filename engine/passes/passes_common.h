/// Declarations shared by the files of passes.
#pragma once

#include "wisp/module/module.h"

