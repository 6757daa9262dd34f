#include "picture_draw.h"

#include "interruption.h"
#include "io_file.h"
#include "picture_survey.h"

#include <errno.h>
#include <math.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum
{
    SHEET_PICTURES = 12, // on a sheet without --frames
    SHEET_WIDTH = 400,   // pixels of each, without --size
    SHEET_HEIGHT = 300,
    PATH_SIZE = 4096,
};

/// The pictures in their order.
typedef struct plan
{
    int count;
    int first, step; ///< frames
    int spread;      ///< > 0: the last of `count` frames spread evenly from 0
    bool is_turning; ///< one frame from all sides
} plan;

typedef struct drawing
{
    const picture_options* options;
    picture_source source;
    plan plan;
    picture_look look;
    picture_survey survey;
    picture_fit* fits; ///< [plan.count] bounds of each picture; one if it is turned
    render_options render;
    image* sheet;         ///< [plan.count] pictures kept for their sheet, or null
    char ( *labels )[32]; ///< [plan.count] below them
    progress bar;
    int picture; ///< the one being drawn
} drawing;

// ---- choice of pictures ----

static int frame_of( const plan* p, int picture )
{
    if ( p->spread > 0 )
    {
        return (int)( (int64_t)picture * p->spread / ( p->count - 1 ) );
    }
    return p->is_turning ? p->first : p->first + picture * p->step;
}

static wisp_status check_frame( const picture_source* source, int frame, wisp_error* error )
{
    return frame < source->frame_count ? WISP_OK
                                       : wisp_fail( error, WISP_BAD_INPUT, "%s: got frame %d, expected 0 to %d",
                                                    source->path, frame, source->frame_count - 1 );
}

static wisp_status choose( drawing* d, wisp_error* error )
{
    const picture_options* options = d->options;
    plan* p = &d->plan;
    int last = d->source.frame_count - 1;
    *p = ( plan ){ .count = 1, .first = last, .step = 1, .is_turning = options->turntable > 0 };
    switch ( options->choice )
    {
        case PICTURE_LAST:
            if ( options->is_sheet && !p->is_turning && last > 0 )
            {
                p->count = last + 1 < SHEET_PICTURES ? last + 1 : SHEET_PICTURES;
                p->spread = last;
            }
            break;
        case PICTURE_FRAME:
            p->first = options->first;
            break;
        case PICTURE_TIME:
        {
            wisp_status status = picture_source_find( &d->source, options->seconds, &p->first, error );
            if ( status != WISP_OK )
            {
                return status;
            }
            break;
        }
        case PICTURE_FRAMES:
            p->first = options->first;
            p->step = options->step;
            last = options->last == PICTURE_FRAME_END ? last : options->last;
            p->count = last >= p->first ? ( last - p->first ) / p->step + 1 : 1;
            break;
    }
    p->count = p->is_turning ? options->turntable : p->count;
    wisp_status status = check_frame( &d->source, p->first, error );
    return status == WISP_OK ? check_frame( &d->source, frame_of( p, p->count - 1 ), error ) : status;
}

// Checked before anything is drawn: minutes of pictures should not end in a sheet that cannot be written.
static wisp_status check_sheet( const drawing* d, wisp_error* error )
{
    int64_t count = d->plan.count, columns = d->options->columns < d->plan.count ? d->options->columns : count;
    int64_t rows = columns > 0 ? ( count + columns - 1 ) / columns : 1;
    // A gap is at most four pixels or a fiftieth, a label at most an eighth of a picture or as high as its letters.
    int64_t width = d->render.width + d->render.width / 50 + 4, height = d->render.height + d->render.height / 8 + 32;
    bool fits = width * height * count <= IMAGE_MAX_PIXELS && width * ( columns + 1 ) <= IMAGE_MAX_SIDE &&
                height * ( rows + 1 ) <= IMAGE_MAX_SIDE;
    return fits ? WISP_OK
                : wisp_fail(
                      error, WISP_BAD_INPUT,
                      "%s: %d pictures of %d x %d pixels are too large for one sheet; draw fewer or smaller ones",
                      d->options->output, d->plan.count, d->render.width, d->render.height );
}

static wisp_status make_sheet_room( drawing* d, wisp_error* error )
{
    wisp_status status = check_sheet( d, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    d->sheet = calloc( (size_t)d->plan.count, sizeof *d->sheet );
    d->labels = calloc( (size_t)d->plan.count, sizeof *d->labels );
    return d->sheet && d->labels ? WISP_OK
                                 : wisp_fail( error, WISP_NO_MEMORY,
                                              "render: out of memory for a sheet of %d pictures", d->plan.count );
}

// ---- the camera, the light of all pictures ----

// What of the loaded frame a collider hides: those through which it must be seen are drawn as glass.
static wisp_status find_glass( drawing* d, const picture_fit* frame, wisp_error* error )
{
    render_camera camera;
    wisp_status status = picture_survey_camera( &d->survey, frame, &camera, error );
    wisp_error cause = { 0 };
    status = status == WISP_OK ? picture_stage_find_glass( &d->source, &camera, &d->look, &cause ) : status;
    return cause.status == WISP_OK ? status : wisp_fail( error, status, "%s: %s", d->source.path, cause.message );
}

static wisp_status survey_frames( drawing* d, wisp_error* error )
{
    int frames = d->plan.is_turning ? 1 : d->plan.count;
    float aspect = (float)d->render.width / (float)d->render.height;
    d->fits = calloc( (size_t)frames, sizeof *d->fits );
    if ( !d->fits )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "render: out of memory for %d pictures", frames );
    }
    wisp_status status = picture_source_load( &d->source, frame_of( &d->plan, 0 ), error );
    if ( status != WISP_OK )
    {
        return status;
    }
    d->survey = picture_survey_begin( d->options, &d->source, aspect );
    for ( int i = 0; i < frames && status == WISP_OK; ++i )
    {
        status = picture_source_load( &d->source, frame_of( &d->plan, i ), error );
        if ( status == WISP_OK )
        {
            d->fits[i] = picture_survey_add( &d->source, &d->survey );
        }
        progress_show( &d->bar, (double)( i + 1 ) / frames, "frames" );
    }
    if ( status != WISP_OK )
    {
        return status;
    }
    d->look = picture_survey_look( &d->survey );
    return find_glass( d, &d->fits[frames - 1], error );
}

// A turntable turns about the vertical axis through the camera's target.
static wisp_status camera_of( const drawing* d, int picture, render_camera* out, wisp_error* error )
{
    const picture_fit* frame = &d->fits[d->plan.is_turning ? 0 : picture];
    wisp_status status = picture_survey_camera( &d->survey, frame, out, error );
    if ( status == WISP_OK && d->plan.is_turning )
    {
        double angle = 6.283185307179586 * picture / d->plan.count;
        double c = cos( angle ), s = sin( angle );
        double x = (double)( out->eye.x - out->target.x ), z = (double)( out->eye.z - out->target.z );
        out->eye.x = (float)( (double)out->target.x + c * x + s * z );
        out->eye.z = (float)( (double)out->target.z - s * x + c * z );
    }
    return status;
}

// ---- one picture ----

static void show_fraction( void* user, double fraction )
{
    drawing* d = user;
    char what[48];
    snprintf( what, sizeof( what ), "picture %d of %d", d->picture + 1, d->plan.count );
    progress_show( &d->bar, ( d->picture + fraction ) / d->plan.count, what );
}

static void put_legend( const drawing* d, image* picture )
{
    // A sheet has one legend for all pictures.
    if ( d->look.value == PICTURE_BODY || ( d->sheet && d->picture > 0 ) )
    {
        return;
    }
    const char* title = d->look.value == PICTURE_STRAIN ? "strain"
                        : d->look.value == PICTURE_MAP  ? "map"
                        : d->source.has_seconds         ? "speed, m/s"
                                                        : "speed, m a frame";
    image_legend( picture, COLOUR_MAP_RISING, (double)d->look.range[0], (double)d->look.range[1], title );
}

static wisp_status render_one( drawing* d, image* out, wisp_error* error )
{
    wisp_status status = picture_source_load( &d->source, frame_of( &d->plan, d->picture ), error );
    picture_stage stage = { 0 };
    if ( status == WISP_OK )
    {
        status = picture_stage_make( &d->source, &d->look, &stage, error );
    }
    render_camera camera;
    status = status == WISP_OK ? camera_of( d, d->picture, &camera, error ) : status;
    if ( status == WISP_OK )
    {
        wisp_error cause = { 0 };
        status = render_picture( &stage.scene, &camera, &d->render, out, &cause );
        if ( status != WISP_OK )
        {
            wisp_fail( error, status, "%s: frame %d: %s", d->source.path, frame_of( &d->plan, d->picture ),
                       cause.message );
        }
    }
    picture_stage_release( &stage );
    if ( status == WISP_OK )
    {
        put_legend( d, out );
    }
    return status;
}

// ---- files ----

static void write_label( drawing* d )
{
    char* label = d->labels[d->picture];
    int frame = frame_of( &d->plan, d->picture );
    double seconds = 0.0;
    wisp_error error = { 0 };
    if ( d->plan.is_turning )
    {
        snprintf( label, sizeof *d->labels, "%.0f degrees", 360.0 * d->picture / d->plan.count );
    }
    else if ( d->source.has_seconds && d->source.input->time( &d->source, frame, &seconds, &error ) == WISP_OK )
    {
        snprintf( label, sizeof *d->labels, d->source.step < 0.01 ? "%.4f s" : "%.2f s", seconds );
    }
    else
    {
        snprintf( label, sizeof *d->labels, "frame %d", frame );
    }
}

/// The name of a picture in a sequence: file_0001.png of file.png.
static void name_of( const drawing* d, int picture, char* path )
{
    const char* output = d->options->output;
    if ( d->plan.count == 1 )
    {
        snprintf( path, PATH_SIZE, "%s", output );
        return;
    }
    snprintf( path, PATH_SIZE, "%.*s_%04d.png", (int)( strlen( output ) - strlen( ".png" ) ), output, picture + 1 );
}

static wisp_status write_picture( const drawing* d, const image* picture, wisp_error* error )
{
    char path[PATH_SIZE];
    name_of( d, d->picture, path );
    return image_write_png( path, picture, error );
}

// @param count of pictures that are drawn
static wisp_status write_sheet( const drawing* d, int count, wisp_error* error )
{
    const char** labels = calloc( (size_t)d->plan.count, sizeof *labels );
    if ( !labels )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "render: out of memory for a sheet of %d pictures", d->plan.count );
    }
    for ( int i = 0; i < count; ++i )
    {
        labels[i] = d->labels[i];
    }
    image sheet = { 0 };
    wisp_status status = image_sheet( d->sheet, count, d->options->columns, labels, &sheet, error );
    if ( status == WISP_OK )
    {
        status = image_write_png( d->options->output, &sheet, error );
    }
    image_release( &sheet );
    free( labels );
    return status;
}

static wisp_status draw_all( drawing* d, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( ; d->picture < d->plan.count && status == WISP_OK; ++d->picture )
    {
        image picture = { 0 };
        status = render_one( d, &picture, error );
        if ( status == WISP_OK && d->sheet )
        {
            write_label( d );
            d->sheet[d->picture] = picture;
            continue;
        }
        if ( status == WISP_OK )
        {
            status = write_picture( d, &picture, error );
        }
        image_release( &picture );
    }
    // After an interruption the pictures that are whole are kept. The loop counted the one that is not.
    if ( status != WISP_OK && interruption_came() && d->picture > 1 )
    {
        --d->picture;
        status = WISP_OK;
    }
    return status == WISP_OK && d->sheet ? write_sheet( d, d->picture, error ) : status;
}

// Checked before anything is drawn; changes of the folder meanwhile are reported at the end.
static wisp_status check_folder( const char* output, wisp_error* error )
{
    const char* slash = strrchr( output, '/' );
    char folder[PATH_SIZE] = ".";
    if ( io_is_standard( output ) )
    {
        return WISP_OK;
    }
    if ( strlen( output ) + sizeof( "_2147483647" ) >= sizeof( folder ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "-o: got a file name that is too long, expected at most %d characters",
                          PATH_SIZE - (int)sizeof( "_2147483647" ) );
    }
    if ( slash )
    {
        snprintf( folder, sizeof( folder ), "%.*s", slash > output ? (int)( slash - output ) : 1, output );
    }
    return access( folder, W_OK | X_OK ) == 0
               ? WISP_OK
               : wisp_fail( error, WISP_IO_ERROR, "%s: cannot be written: %s", output, strerror( errno ) );
}

// ---- all together ----

static int core_count( void )
{
    cpu_set_t set;
    int count = sched_getaffinity( 0, sizeof( set ), &set ) == 0 ? CPU_COUNT( &set ) : 1;
    return count < WISP_MAX_WORKERS ? count : WISP_MAX_WORKERS;
}

static void set_render_options( drawing* d )
{
    const picture_options* options = d->options;
    d->render = render_default_options();
    if ( options->is_sheet )
    {
        d->render.width = SHEET_WIDTH;
        d->render.height = SHEET_HEIGHT;
    }
    if ( options->width > 0 )
    {
        d->render.width = options->width;
        d->render.height = options->height;
    }
    d->render.samples = options->samples;
    d->render.threads = options->workers > 0 ? options->workers : core_count();
    d->render.progress = show_fraction;
    d->render.progress_user = d;
    d->render.is_cancelled = interruption_came;
}

static void print_summary( const drawing* d, double seconds )
{
    const plan* p = &d->plan;
    FILE* out = io_is_standard( d->options->output ) ? stderr : stdout; // which has the picture
    char first[PATH_SIZE];
    name_of( d, 0, first );
    fprintf( out, "%s: ", p->count > 1 && d->sheet ? d->options->output : first );
    if ( p->count > 1 )
    {
        fprintf( out, "%s%d pictures of ", d->sheet ? "" : "the first of ", d->picture );
    }
    fprintf( out, "%d x %d pixels, ", d->render.width, d->render.height );
    if ( p->count > 1 && !p->is_turning )
    {
        fprintf( out, "frames %d to %d of ", frame_of( p, 0 ), frame_of( p, d->picture - 1 ) );
    }
    else
    {
        fprintf( out, "frame %d of ", p->first );
    }
    fprintf( out, "%s, %.2f s\n", d->source.path, seconds );
    if ( d->picture < p->count )
    {
        fprintf( out, "interrupted at picture %d of %d\n", d->picture + 1, p->count );
    }
}

static void release( drawing* d )
{
    for ( int i = 0; d->sheet && i < d->plan.count; ++i )
    {
        image_release( &d->sheet[i] );
    }
    free( d->sheet );
    free( d->labels );
    free( d->fits );
    free( d->look.is_glass );
    picture_source_close( &d->source );
}

wisp_status picture_draw( const picture_options* options, wisp_error* error )
{
    double start = wisp_clock_seconds();
    drawing d = { .options = options, .bar = progress_begin() };
    set_render_options( &d );
    wisp_status status = check_folder( options->output, error );
    if ( status == WISP_OK )
    {
        status = picture_source_open( &options->source, &d.source, error );
    }
    if ( status == WISP_OK )
    {
        interruption_begin(); // before that there is nothing to keep
        d.source.bar = &d.bar;
        status = choose( &d, error );
    }
    if ( status == WISP_OK && options->is_sheet )
    {
        status = make_sheet_room( &d, error );
    }
    if ( status == WISP_OK )
    {
        status = survey_frames( &d, error );
    }
    if ( status == WISP_OK )
    {
        // From here on the progress bar counts pictures; steps between two of them would make it jump.
        d.source.bar = NULL;
        status = draw_all( &d, error );
    }
    progress_end( &d.bar );
    if ( status == WISP_OK )
    {
        print_summary( &d, wisp_clock_seconds() - start );
    }
    release( &d );
    return status;
}
