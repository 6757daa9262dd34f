/// Colours of bodies in pictures and recordings: linear red, green, blue.
#pragma once

#include "wisp/base.h"

/// Colours that suit each other, for the bodies of one scene. @param body any number, taken modulo their count
wisp_vec3 palette_body( int body );
/// Hair, and bodies that do not deform.
wisp_vec3 palette_hair( void );
wisp_vec3 palette_solid( void );
