#include "commands.h"

#include "interruption.h"
#include "io_file.h"
#include "picture_draw.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define FRAME_MAX 100000000
#define TURNTABLE_MAX 10000
#define COLUMNS_MAX 1000

// ---- values of options; each ends the program with STATUS_USAGE if the text is invalid ----

static picture_options default_options( void )
{
    render_scene scene = render_default_scene();
    return ( picture_options ){
        .samples = render_default_options().samples,
        .view = render_default_view(),
        .background = { scene.background_top, scene.background_bottom },
    };
}

// Numbers between commas, exactly `count`, finite.
static void parse_numbers( const options_state* o, const char* text, int count, float* out )
{
    const char* at = text;
    for ( int i = 0; i < count; ++i )
    {
        char* end = NULL;
        out[i] = strtof( at, &end );
        char requested = i + 1 < count ? ',' : '\0';
        if ( end == at || *end != requested || !isfinite( out[i] ) )
        {
            options_fail( o, "%s: got '%s', expected %d number%s", o->name, text, count,
                          count == 1 ? "" : "s separated by commas" );
        }
        at = end + 1;
    }
}

// Such as 640x480.
static void parse_size( const options_state* o, const char* text )
{
    picture_options* out = o->input;
    char* end = NULL;
    long width = strtol( text, &end, 10 );
    long height = *end == 'x' ? strtol( end + 1, &end, 10 ) : 0;
    if ( *end || width < 1 || height < 1 || width > RENDER_MAX_SIDE || height > RENDER_MAX_SIDE )
    {
        options_fail( o, "--size: got '%s', expected a size such as 640x480, each side from 1 to %d", text,
                      RENDER_MAX_SIDE );
    }
    out->width = (int)width;
    out->height = (int)height;
}

// ---- frames ----

static void choose_frames( const options_state* o, picture_choice choice )
{
    picture_options* options = o->input;
    if ( options->choice != PICTURE_LAST )
    {
        options_fail( o, "got several of --frame, --time and --frames, expected one" );
    }
    options->choice = choice;
}

static void parse_frame( const options_state* o, const char* text )
{
    choose_frames( o, PICTURE_FRAME );
    ( (picture_options*)o->input )->first = option_whole( o, text, 0, FRAME_MAX );
}

static void parse_time( const options_state* o, const char* text )
{
    float seconds;
    choose_frames( o, PICTURE_TIME );
    parse_numbers( o, text, 1, &seconds );
    ( (picture_options*)o->input )->seconds = (double)seconds;
}

static void parse_sheet( const options_state* o, const char* text )
{
    picture_options* out = o->input;
    out->is_sheet = true;
    out->columns = text ? option_whole( o, text, 1, COLUMNS_MAX ) : 0;
}

/// A part of A:B:STEP. @return the text after it
static const char* parse_part( const char* text, int empty, int* value, bool* is_good )
{
    char* end = NULL;
    errno = 0;
    long number = strtol( text, &end, 10 );
    *value = end == text ? empty : (int)number;
    *is_good = *is_good && ( end == text || ( !errno && number >= 0 && number < INT_MAX ) ) &&
               ( *end == ':' || *end == '\0' );
    return *end == ':' ? end + 1 : end;
}

// Such as 10:50:5; each part may be empty.
static void parse_frames( const options_state* o, const char* text )
{
    picture_options* out = o->input;
    choose_frames( o, PICTURE_FRAMES );
    bool is_good = strchr( text, ':' ) != NULL;
    const char* at = parse_part( text, 0, &out->first, &is_good );
    at = parse_part( at, PICTURE_FRAME_END, &out->last, &is_good );
    at = parse_part( at, 1, &out->step, &is_good );
    if ( !is_good || *at || out->step < 1 || ( out->last != PICTURE_FRAME_END && out->last < out->first ) )
    {
        options_fail( o, "--frames: got '%s', expected FIRST:LAST or FIRST:LAST:STEP with rising whole numbers",
                      text );
    }
}

// ---- surroundings of the bodies ----

// The words of the option, auto and none, or a height.
static void parse_ground( const options_state* o, const char* text )
{
    picture_options* out = o->input;
    char* end = NULL;
    float height = strtof( text, &end );
    if ( end != text && !*end && isfinite( height ) )
    {
        out->ground = PICTURE_GROUND_HEIGHT;
        out->ground_height = height;
        return;
    }
    out->ground = (picture_ground)option_word( o, text );
}

static float linear_of_srgb( unsigned long byte )
{
    float fraction = (float)byte / 255.0f;
    return fraction <= 0.04045f ? fraction / 12.92f : powf( ( fraction + 0.055f ) / 1.055f, 2.4f );
}

static const char* parse_colour( const char* text, wisp_vec3* out )
{
    char digits[7] = "";
    size_t count = *text == '#' ? strspn( text + 1, "0123456789abcdefABCDEF" ) : 0;
    if ( count != 6 )
    {
        return NULL;
    }
    memcpy( digits, text + 1, 6 );
    unsigned long value = strtoul( digits, NULL, 16 );
    *out = ( wisp_vec3 ){ linear_of_srgb( value >> 16 ), linear_of_srgb( value >> 8 & 255 ),
                          linear_of_srgb( value & 255 ) };
    return text + 7;
}

// The words of the option, studio, white and dark, or one or two colours such as #20242c.
static void parse_background( const options_state* o, const char* text )
{
    picture_options* out = o->input;
    const render_scene studio = render_default_scene();
    const wisp_vec3 colours[][2] = {
        { studio.background_top, studio.background_bottom },
        { { 1.0f, 1.0f, 1.0f }, { 1.0f, 1.0f, 1.0f } },
        { { 0.012f, 0.014f, 0.018f }, { 0.045f, 0.050f, 0.060f } },
    };
    if ( *text != '#' )
    {
        int word = option_word( o, text );
        out->background[0] = colours[word][0];
        out->background[1] = colours[word][1];
        return;
    }
    const char* end = parse_colour( text, &out->background[0] );
    out->background[1] = out->background[0];
    if ( end && *end == ',' )
    {
        end = parse_colour( end + 1, &out->background[1] );
    }
    if ( !end || *end )
    {
        options_fail( o, "--background: got '%s', expected a colour such as #20242c, or two separated by a comma",
                      text );
    }
}

static void parse_range( const options_state* o, const char* argument )
{
    picture_options* options = o->input;
    parse_numbers( o, argument, 2, options->range );
    if ( !( options->range[0] < options->range[1] ) )
    {
        options_fail( o, "--range: got '%s', expected two rising numbers", argument );
    }
    options->has_range = true;
}

static void parse_camera( const options_state* o, const char* argument )
{
    picture_options* options = o->input;
    float n[6];
    parse_numbers( o, argument, 6, n );
    options->eye = ( wisp_vec3 ){ n[0], n[1], n[2] };
    options->target = ( wisp_vec3 ){ n[3], n[4], n[5] };
    options->has_camera = true;
}

static void parse_from( const options_state* o, const char* argument )
{
    picture_options* options = o->input;
    float n[2];
    parse_numbers( o, argument, 2, n );
    if ( !( n[1] >= -89.0f && n[1] <= 89.0f ) )
    {
        options_fail( o, "--from: got an elevation of %g, expected -89 to 89 degrees", (double)n[1] );
    }
    options->view.azimuth_degrees = n[0];
    options->view.elevation_degrees = n[1];
    options->has_from = true;
}

static void parse_cut( const options_state* o, const char* argument )
{
    picture_options* options = o->input;
    float n[4];
    parse_numbers( o, argument, 4, n );
    options->cut_normal = ( wisp_vec3 ){ n[0], n[1], n[2] };
    options->cut_offset = n[3];
    if ( n[0] == 0.0f && n[1] == 0.0f && n[2] == 0.0f )
    {
        options_fail( o, "--cut: got '%s', expected a direction that is not zero, and a distance", argument );
    }
}

static void parse_fov( const options_state* o, const char* argument )
{
    picture_options* options = o->input;
    parse_numbers( o, argument, 1, &options->view.fov_degrees );
    if ( !( options->view.fov_degrees >= 1.0f && options->view.fov_degrees <= 150.0f ) )
    {
        options_fail( o, "--fov: got '%s', expected 1 to 150 degrees", argument );
    }
}

static void parse_boundary( const options_state* o, const char* text )
{
    static const picture_layer_look looks[] = { PICTURE_LAYER_NORMAL, PICTURE_LAYER_CLASS, PICTURE_LAYER_NONE };
    ( (picture_options*)o->input )->source.layer = looks[option_word( o, text )];
}

// ---- the command ----

static const char* const value_words[] = { "body", "strain", "speed", "map" };
static const char* const layer_words[] = { "normal", "class", "none" };
static const char* const ground_words[] = { "auto", "none" };
static const char* const background_words[] = { "studio", "white", "dark" };

static const option_row render_rows[] = {
    OPTION_TITLE( "Picture:" ),
    { "output", 'o', "FILE.png", "Write the picture to FILE.png; required",
      OPTION_TEXT( picture_options, output, ".png" ) },
    { "size", 0, "WxH", "Pixels, default 640x480; on a sheet 400x300 each", OPTION_TAKEN( parse_size ) },
    { "samples", 0, "N", "Rays per pixel, 1 to 4096, default 16",
      OPTION_WHOLE( picture_options, samples, 1, RENDER_MAX_SAMPLES ) },
    { "workers", 'w', "N", "Use N workers, 1 to 64, default one per core",
      OPTION_WHOLE( picture_options, workers, 1, WISP_MAX_WORKERS ) },
    OPTION_TITLE( "Frames, default the last one:" ),
    { "steps", 's', "N", "Of a scene: its last frame follows N steps, not those of the scene",
      OPTION_WHOLE( picture_options, source.steps, 1, FRAME_MAX ) },
    { "frame", 0, "N", "Frame N, counted from 0", OPTION_TAKEN( parse_frame ) },
    { "time", 0, "S", "The frame nearest to S seconds", OPTION_TAKEN( parse_time ) },
    { "frames", 0, "A:B:STEP", "Frames A to B, both included; parts can be omitted", OPTION_TAKEN( parse_frames ) },
    { "sheet", 0, "[COLUMNS]", "One contact sheet of --frames, or of twelve frames", OPTION_TAKEN( parse_sheet ) },
    OPTION_TITLE( "Camera:" ),
    { "from", 0, "AZIMUTH,ELEVATION",
      "Direction in degrees: about y from +z to +x, and up; default 32,16, or 0,0 for strands in a plane",
      OPTION_TAKEN( parse_from ) },
    { "fov", 0, "DEGREES", "Vertical angle of view, 1 to 150, default 28", OPTION_TAKEN( parse_fov ) },
    { "camera", 0, "X,Y,Z,X,Y,Z", "Eye and target in metres, instead of --from", OPTION_TAKEN( parse_camera ) },
    { "turntable", 0, "N", "N views around one frame", OPTION_WHOLE( picture_options, turntable, 1, TURNTABLE_MAX ) },
    OPTION_TITLE( "Appearance:" ),
    { "colour", 0, "WHAT", "body (default), strain, speed, or map: the first map of a surface",
      OPTION_WORD( picture_options, source.value, value_words ) },
    { "color", 0, "WHAT", NULL, OPTION_WORD( picture_options, source.value, value_words ) },
    { "range", 0, "LOW,HIGH", "Values at the ends of the colour scale", OPTION_TAKEN( parse_range ) },
    { "boundary",
      0,
      "WHAT",
      "Boundary points by normal (default) or class, or none",
      { OPTION_LIST( layer_words ), .to = { .take = parse_boundary } } },
    { "cut", 0, "X,Y,Z,D", "Cut bodies open: draw what has X x + Y y + Z z <= D", OPTION_TAKEN( parse_cut ) },
    { "normals", 0, NULL, "Draw normals of boundary points",
      OPTION_FLAG( picture_options, source.has_layer_normals ) },
    { "ground",
      0,
      "WHERE",
      "auto (default), none, or y in metres",
      { OPTION_LIST( ground_words ), .to = { .take = parse_ground } } },
    { "background",
      0,
      "WHAT",
      "studio (default), white, dark, #20242c, or #top,#bottom",
      { OPTION_LIST( background_words ), .to = { .take = parse_background } } },
    { "mesh", 0, "FILE", "Triangles for a point cache (.obj, .ply)",
      OPTION_TEXT( picture_options, source.mesh, ".obj .ply" ) },
};

const command_text render_text = {
    .name = "render",
    .operands = "SCENE|RECORDING|MESH|GROOM",
    .noun = "file",
    .summary = "draw pictures of a scene, recording, mesh or groom",
    .about = "Draw pictures of a scene, recording, mesh or groom by ray tracing.",
    .notes = "Inputs are scenes (.yaml, .yml, .json), recordings (.wisp, .pc2), meshes (.obj,\n"
             ".ply, .glb, .gltf) and grooms (.hair). A scene is simulated as far as needed.\n"
             "Frame 0 is the start, frame N follows step N; by default the last frame is drawn.\n"
             "The default camera shows all bodies in all frames. Several pictures are written as\n"
             "FILE_0001.png and so on, or as one contact sheet.",
    .examples = "wisp render data/scenes/flag.yaml -o flag.png\n"
                "wisp render flag.wisp --sheet -o sheet.png\n"
                "wisp render flag.wisp --frames 0::2 --colour strain -o film.png\n"
                "wisp render data/bunny.obj --turntable 36 -o bunny.png",
    .rows = render_rows,
    .row_count = WISP_COUNT( render_rows ),
    .values = OPTION_INPUT( OPTION_TO_INPUT_IF_ANY, picture_options, source.path,
                            ".yaml .yml .json .wisp .pc2 .obj .ply .glb .gltf .hair" ),
};

static void check_render_options( const options_state* o )
{
    picture_options* options = o->input;
    options->source.world.workers = options->workers;
    if ( !options->source.path )
    {
        options_fail( o, "expected a scene, recording, mesh or groom" );
    }
    if ( !options->output )
    {
        options_fail( o, "expected -o FILE.png" );
    }
    if ( io_is_standard( options->output ) )
    {
        if ( isatty( STDOUT_FILENO ) )
        {
            options_fail( o, "-o: got '-', but standard output is a terminal, which cannot show a PNG file" );
        }
        if ( !options->is_sheet && ( options->turntable > 1 || options->choice == PICTURE_FRAMES ) )
        {
            options_fail( o, "-o: got '-', expected a file name for several pictures" );
        }
    }
    else if ( !io_has_extension( options->output, ".png" ) )
    {
        options_fail( o, "-o: got '%s', expected a file name that ends in .png", options->output );
    }
    if ( options->turntable > 0 && options->choice == PICTURE_FRAMES )
    {
        options_fail( o, "--turntable: expected one frame, but --frames selects several" );
    }
    if ( options->has_range && options->source.value == PICTURE_BODY )
    {
        options_fail( o, "--range: expected together with --colour strain, speed or map" );
    }
}

int command_render( int argc, char** argv )
{
    picture_options options = default_options();
    options_parse( &render_text, check_render_options, &options, argc, argv );

    wisp_error error = { 0 };
    wisp_status status = picture_draw( &options, &error );
    return command_end( status, &error );
}
