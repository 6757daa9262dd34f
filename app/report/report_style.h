/// The stylesheet of the page: light and dark, narrow and wide, screen and paper.
#pragma once

#include <stdio.h>

void report_put_style( FILE* stream );
