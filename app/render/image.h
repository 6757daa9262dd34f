/// Pictures in memory: eight bits per channel, sRGB, rows from the top. They become files and contact sheets here.
#pragma once

#include "wisp/base.h"

// ---- numbers as colours ----

/// Both maps are curves in Oklab (Ottosson 2020), a space in which equal distances look equal, and are computed here from that
/// definition.
typedef enum colour_map
{
    COLOUR_MAP_RISING,    ///< dark violet, blue, green, yellow: lightness increases evenly, also in black and white
    COLOUR_MAP_DIVERGING, ///< blue, light grey in the middle, red: for values with a sign
} colour_map;

/// @param share in [0, 1], clamped. NaN is a mid grey, which neither map contains.
/// @return linear RGB in [0, 1]
wisp_vec3 colour_map_at( colour_map map, float fraction );

/// Colours of many values. Where low and high are equal, all are in the middle.
/// @param low, high the values at the ends of the map
/// @param colours [count] linear RGB
void colour_map_apply( colour_map map, const float* values, int count, float lower, float upper, wisp_vec3* colours );

// ---- pictures ----

#define IMAGE_MAX_SIDE 65535
#define IMAGE_MAX_PIXELS ( 1 << 28 )

/// Zero-initialised is empty. Release with image_release().
typedef struct image
{
    int width, height;
    uint8_t* rgb; ///< [height][width][3]
} image;

/// A colour as bytes of a picture.
typedef struct image_colour
{
    uint8_t r, g, b;
} image_colour;

/// A picture of one colour.
/// @return WISP_BAD_INPUT a side outside [1, IMAGE_MAX_SIDE], or more than IMAGE_MAX_PIXELS; WISP_NO_MEMORY
wisp_status image_make( int width, int height, image_colour colour, image* out, wisp_error* error );

/// Null and an empty image are allowed; the image is empty afterwards.
void image_release( image* picture );

/// The sRGB byte of a linear value; values outside [0, 1] are clamped, NaN is 0.
uint8_t image_byte_of_linear( float linear );

/// Write a PNG file. It replaces an old one in a single step: a failed write leaves the old file.
/// @return WISP_IO_ERROR an error of the operating system; WISP_BAD_INPUT the image is empty; WISP_NO_MEMORY
wisp_status image_write_png( const char* path, const image* picture, wisp_error* error );

/// Arrange pictures side by side, in rows from the top, with gaps. Smaller pictures are centred in their cell.
/// @param columns 0: as many as make the sheet nearly square
/// @param labels [count] one line below each picture (null: none), or null
/// @return WISP_BAD_INPUT no picture, an empty one, negative columns, or a sheet beyond the limits; WISP_NO_MEMORY
wisp_status image_sheet( const image* pictures, int count, int columns, const char* const* labels, image* out,
                         wisp_error* error );

// ---- drawing; parts outside the picture are skipped ----

/// Letters of 5 x 7 squares in cells of 6 x 8, each square `scale` pixels wide. Characters other than printable ASCII
/// are drawn as a box.
/// @param x, y the upper left corner
void image_text( image* picture, int x, int y, int scale, image_colour colour, const char* text );

/// Pixels that image_text() takes from the left edge of the first letter to the right edge of the last.
int image_text_width( const char* text, int scale );

/// @param opacity in [0, 1] blends the colour with the picture
void image_fill( image* picture, int x, int y, int width, int height, image_colour colour, float opacity );

/// A bar with the colours of a map, its ends in numbers and a title above it, in the lower left corner.
/// @param title such as "strain", or null
void image_legend( image* picture, colour_map map, double lower, double upper, const char* title );
