// Contact sheets: many small pictures on one large one.
#include "image.h"

#include <math.h>
#include <string.h>

static const image_colour PAPER = { 246, 246, 244 };
static const image_colour INK = { 58, 60, 64 };

typedef struct sheet
{
    int columns, rows;
    int cell_width, cell_height; // of the largest picture
    int gap, scale, label_height;
} sheet;

static wisp_status check_pictures( const image* pictures, int count, int columns, wisp_error* error )
{
    if ( count < 1 || columns < 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "contact sheet: %d pictures in %d columns", count, columns );
    }
    for ( int i = 0; i < count; ++i )
    {
        if ( pictures[i].rgb == NULL )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "contact sheet: picture %d of %d is empty", i, count );
        }
    }
    return WISP_OK;
}

// The sheet is as close to a square as whole cells allow.
static int square_columns( int count, int cell_width, int cell_height )
{
    double columns = sqrt( (double)count * cell_height / cell_width );
    int nearest = (int)( columns + 0.5 );
    return nearest < 1 ? 1 : nearest > count ? count : nearest;
}

static sheet lay_out( const image* pictures, int count, int columns, bool has_labels )
{
    sheet out = { .gap = 0 };
    for ( int i = 0; i < count; ++i )
    {
        out.cell_width = pictures[i].width > out.cell_width ? pictures[i].width : out.cell_width;
        out.cell_height = pictures[i].height > out.cell_height ? pictures[i].height : out.cell_height;
    }
    out.columns = columns > 0 ? columns : square_columns( count, out.cell_width, out.cell_height );
    out.columns = out.columns < count ? out.columns : count;
    out.rows = count / out.columns + ( count % out.columns != 0 ? 1 : 0 );
    out.gap = out.cell_width / 50 > 4 ? out.cell_width / 50 : 4;
    out.scale = image_text_scale( &( image ){ out.cell_width, out.cell_height, NULL } );
    out.label_height = has_labels ? 8 * out.scale + out.gap / 2 : 0;
    return out;
}

static void paste( const image* from, image* to, int x, int y )
{
    for ( int row = 0; row < from->height; ++row )
    {
        memcpy( to->rgb + 3 * ( (size_t)( y + row ) * (size_t)to->width + (size_t)x ),
                from->rgb + 3 * (size_t)row * (size_t)from->width, 3 * (size_t)from->width );
    }
}

// A label wider than its picture is cut, so that it does not overlap its neighbour.
static void put_label( image* to, const sheet* s, int x, int y, const char* label )
{
    char shown[256];
    size_t most = (size_t)( ( s->cell_width + s->scale ) / ( 6 * s->scale ) );
    size_t length = strlen( label );
    length = length < most ? length : most;
    length = length < sizeof( shown ) - 1 ? length : sizeof( shown ) - 1;
    memcpy( shown, label, length );
    shown[length] = '\0';
    image_text( to, x + ( s->cell_width - image_text_width( shown, s->scale ) ) / 2, y, s->scale, INK, shown );
}

wisp_status image_sheet( const image* pictures, int count, int columns, const char* const* labels, image* out,
                         wisp_error* error )
{
    wisp_status status = check_pictures( pictures, count, columns, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    sheet s = lay_out( pictures, count, columns, labels != NULL );
    int64_t width = (int64_t)s.columns * ( s.cell_width + s.gap ) + s.gap;
    int64_t height = (int64_t)s.rows * ( s.cell_height + s.label_height + s.gap ) + s.gap;
    if ( width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "contact sheet: %lld x %lld pixels are more than %d on a side",
                          (long long)width, (long long)height, IMAGE_MAX_SIDE );
    }
    image made = { 0 };
    status = image_make( (int)width, (int)height, PAPER, &made, error );
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        const image* from = &pictures[i];
        int x = s.gap + ( i % s.columns ) * ( s.cell_width + s.gap );
        int y = s.gap + ( i / s.columns ) * ( s.cell_height + s.label_height + s.gap );
        paste( from, &made, x + ( s.cell_width - from->width ) / 2, y + ( s.cell_height - from->height ) / 2 );
        if ( labels != NULL && labels[i] != NULL )
        {
            put_label( &made, &s, x, y + s.cell_height + s.gap / 2, labels[i] );
        }
    }
    if ( status == WISP_OK )
    {
        image_release( out );
        *out = made;
    }
    return status;
}
