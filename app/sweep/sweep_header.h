/// The header of a part as a line.
#pragma once

#include "sweep_part.h"

/// @return the line without its end, for free(); null without memory
char* sweep_header_write( const sweep_header* header );
/// @return false: the line is no header
bool sweep_header_read( const char* line, size_t size, sweep_header* out );
