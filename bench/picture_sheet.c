#include "picture_sheet.h"

static wisp_status find_camera( const picture_shots* shots, float aspect, render_camera* camera, wisp_error* error )
{
    render_bounds all = { .is_filled = false };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < shots->count && status == WISP_OK; ++i )
    {
        render_bounds one = { .is_filled = false };
        status = render_scene_bounds( shots->scene( shots->context, i ), &one, error );
        all = render_bounds_union( all, one );
    }
    return status == WISP_OK ? render_frame_camera( &all, &shots->view, aspect, camera, error ) : status;
}

wisp_status picture_sheet_draw( const picture_shots* shots, const char* labels, size_t label_distance,
                                picture_sheet* sheet, wisp_error* error )
{
    render_camera camera;
    render_options options = render_default_options();
    options.width = shots->width;
    options.height = shots->height;
    options.threads = 2;
    options.samples = shots->samples > 0 ? shots->samples : options.samples;
    wisp_status status = find_camera( shots, (float)shots->width / (float)shots->height, &camera, error );
    for ( int i = 0; i < shots->count && status == WISP_OK; ++i )
    {
        status = render_picture( shots->scene( shots->context, i ), &camera, &options, &sheet->pictures[i], error );
        sheet->labels[i] = labels + (size_t)i * label_distance;
        sheet->count = i + 1;
    }
    return status;
}

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
