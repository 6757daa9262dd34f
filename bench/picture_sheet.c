#include "picture_sheet.h"

wisp_status picture_path( const char* folder, const char* name, char* out, size_t size, wisp_error* error )
{
    return snprintf( out, size, "%s/%s.png", folder, name ) < (int)size
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "the folder for pictures has too long a name" );
}

wisp_status picture_sheet_finish( picture_sheet* sheet, wisp_status drawn, const char* folder, const char* name,
                                  const char* caption, results* out, wisp_error* error )
{
    char path[4096];
    image all = { 0 };
    const int columns = sheet->columns > 0 ? sheet->columns : sheet->count;
    wisp_status status = drawn;
    status = status == WISP_OK ? picture_path( folder, name, path, sizeof( path ), error ) : status;
    status = status == WISP_OK ? image_sheet( sheet->pictures, sheet->count, columns, sheet->labels, &all, error )
                               : status;
    status = status == WISP_OK ? image_write_png( path, &all, error ) : status;
    for ( int i = 0; i < sheet->count; ++i )
    {
        image_release( &sheet->pictures[i] );
    }
    image_release( &all );
    if ( status == WISP_OK )
    {
        results_add_note( out, "%s: ![%s](%s)", caption, caption, path );
        results_add_picture( out, path, caption );
    }
    return status;
}
