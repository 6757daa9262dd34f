#include "commands.h"

#include "io_file.h"
#include "picture_draw.h"

#include <stdlib.h>

#define FRAME_MAX 100000000
#define TURNTABLE_MAX 10000
#define COLUMNS_MAX 1000

enum
{
    KEY_OUTPUT = 'o',
    KEY_WORKERS = 'w',
    KEY_SIZE = 256,
    KEY_SAMPLES,
    KEY_FRAME,
    KEY_TIME,
    KEY_FRAMES,
    KEY_SHEET,
    KEY_TURNTABLE,
    KEY_COLOUR,
    KEY_RANGE,
    KEY_MESH,
    KEY_CAMERA,
    KEY_FROM,
    KEY_FOV,
    KEY_GROUND,
    KEY_BACKGROUND,
    KEY_BOUNDARY,
    KEY_NORMALS,
};

static const char doc[] = "Draw pictures of a scene, recording, mesh or groom by ray tracing.\n"
                          "\v"
                          "Inputs are scenes (.yaml, .yml, .json), recordings (.wisp, .pc2), meshes (.obj,\n"
                          ".ply) and grooms (.hair, .tfx). A scene is simulated as far as the pictures need.\n"
                          "Frame 0 is the start, frame N follows step N; by default the last frame is drawn.\n"
                          "The default camera shows all bodies in all frames. Several pictures are written as\n"
                          "FILE_0001.png and so on, or as one contact sheet.\n"
                          "\n"
                          "Examples:\n"
                          "  wisp render data/scenes/flag.yaml -o flag.png\n"
                          "  wisp render flag.wisp --sheet -o sheet.png\n"
                          "  wisp render flag.wisp --frames 0::2 --colour strain -o film.png\n"
                          "  wisp render data/bunny.obj --turntable 36 -o bunny.png\n"
                          "\n" STATUS_HELP;

static const struct argp_option option_list[] = {
    { 0, 0, 0, 0, "Picture:", 1 },
    { "output", KEY_OUTPUT, "FILE.png", 0, "Write the picture to FILE.png; required", 1 },
    { "size", KEY_SIZE, "WxH", 0, "Pixels, default 640x480; on a sheet 400x300 each", 1 },
    { "samples", KEY_SAMPLES, "N", 0, "Rays per pixel, 1 to 4096, default 16", 1 },
    { "workers", KEY_WORKERS, "N", 0, "Use N workers, 1 to 64, default one per core", 1 },
    { 0, 0, 0, 0, "Frames, default the last one:", 2 },
    { "frame", KEY_FRAME, "N", 0, "Frame N, counted from 0", 2 },
    { "time", KEY_TIME, "S", 0, "The frame nearest to S seconds", 2 },
    { "frames", KEY_FRAMES, "A:B:STEP", 0, "Frames A to B, both included; parts can be omitted", 2 },
    { "sheet", KEY_SHEET, "COLUMNS", OPTION_ARG_OPTIONAL, "One contact sheet of --frames, or of twelve frames", 2 },
    { 0, 0, 0, 0, "Camera:", 3 },
    { "from", KEY_FROM, "AZIMUTH,ELEVATION", 0,
      "Direction in degrees: about y from +z to +x, and up; default 32,16, or 0,0 for strands in a plane", 3 },
    { "fov", KEY_FOV, "DEGREES", 0, "Vertical angle of view, 1 to 150, default 28", 3 },
    { "camera", KEY_CAMERA, "X,Y,Z,X,Y,Z", 0, "Eye and target in metres, instead of --from", 3 },
    { "turntable", KEY_TURNTABLE, "N", 0, "N views around one frame", 3 },
    { 0, 0, 0, 0, "Appearance:", 4 },
    { "colour", KEY_COLOUR, "WHAT", 0, "body (default), strain or speed", 4 },
    { "color", 0, 0, OPTION_ALIAS | OPTION_HIDDEN, 0, 4 },
    { "range", KEY_RANGE, "LOW,HIGH", 0, "Strain or speed at the ends of the colour scale", 4 },
    { "boundary", KEY_BOUNDARY, "WHAT", 0, "Boundary points by normal (default) or class, or none", 4 },
    { "normals", KEY_NORMALS, 0, 0, "Draw normals of boundary points", 4 },
    { "ground", KEY_GROUND, "WHERE", 0, "auto (default), none, or y in metres", 4 },
    { "background", KEY_BACKGROUND, "WHAT", 0, "studio (default), white, dark, #20242c, or #top,#bottom", 4 },
    { "mesh", KEY_MESH, "FILE", 0, "Triangles for a point cache (.obj, .ply)", 4 },
    { 0 },
};

static void choose_frames( struct argp_state* state, picture_options* options, picture_choice choice )
{
    if ( options->choice != PICTURE_LAST )
    {
        argp_error( state, "got several of --frame, --time and --frames, expected one" );
    }
    options->choice = choice;
}

static void parse_range( struct argp_state* state, const char* argument, picture_options* options )
{
    picture_parse_numbers( state, "--range", argument, 2, options->range );
    if ( !( options->range[0] < options->range[1] ) )
    {
        argp_error( state, "--range: got '%s', expected two rising numbers", argument );
    }
    options->has_range = true;
}

static void parse_camera( struct argp_state* state, const char* argument, picture_options* options )
{
    float n[6];
    picture_parse_numbers( state, "--camera", argument, 6, n );
    options->eye = ( wisp_vec3 ){ n[0], n[1], n[2] };
    options->target = ( wisp_vec3 ){ n[3], n[4], n[5] };
    options->has_camera = true;
}

static void parse_from( struct argp_state* state, const char* argument, picture_options* options )
{
    float n[2];
    picture_parse_numbers( state, "--from", argument, 2, n );
    if ( !( n[1] >= -89.0f && n[1] <= 89.0f ) )
    {
        argp_error( state, "--from: got an elevation of %g, expected -89 to 89 degrees", (double)n[1] );
    }
    options->view.azimuth_degrees = n[0];
    options->view.elevation_degrees = n[1];
    options->has_from = true;
}

static void parse_fov( struct argp_state* state, const char* argument, picture_options* options )
{
    picture_parse_numbers( state, "--fov", argument, 1, &options->view.fov_degrees );
    if ( !( options->view.fov_degrees >= 1.0f && options->view.fov_degrees <= 150.0f ) )
    {
        argp_error( state, "--fov: got '%s', expected 1 to 150 degrees", argument );
    }
}

/// Options about time and place. @return whether it was one of them
static bool parse_view( int key, char* argument, struct argp_state* state )
{
    picture_options* options = state->input;
    switch ( key )
    {
        case KEY_FRAME:
            choose_frames( state, options, PICTURE_FRAME );
            options->first = option_whole( state, "--frame", argument, 0, FRAME_MAX );
            return true;
        case KEY_TIME:
        {
            float seconds;
            choose_frames( state, options, PICTURE_TIME );
            picture_parse_numbers( state, "--time", argument, 1, &seconds );
            options->seconds = (double)seconds;
            return true;
        }
        case KEY_FRAMES:
            choose_frames( state, options, PICTURE_FRAMES );
            picture_parse_frames( state, argument, options );
            return true;
        case KEY_SHEET:
            options->is_sheet = true;
            options->columns = argument ? option_whole( state, "--sheet", argument, 1, COLUMNS_MAX ) : 0;
            return true;
        case KEY_TURNTABLE:
            options->turntable = option_whole( state, "--turntable", argument, 1, TURNTABLE_MAX );
            return true;
        case KEY_CAMERA:
            parse_camera( state, argument, options );
            return true;
        case KEY_FROM:
            parse_from( state, argument, options );
            return true;
        case KEY_FOV:
            parse_fov( state, argument, options );
            return true;
        default:
            return false;
    }
}

/// Options about the look of things. @return whether it was one of them
static bool parse_look( int key, char* argument, struct argp_state* state )
{
    static const char* const values[] = { "body", "strain", "speed" };
    static const char* const layers[] = { "normal", "class", "none" };
    static const picture_layer_look looks[] = { PICTURE_LAYER_NORMAL, PICTURE_LAYER_CLASS, PICTURE_LAYER_NONE };
    picture_options* options = state->input;
    switch ( key )
    {
        case KEY_COLOUR:
            options->source.value =
                (picture_value)option_word( state, "--colour", argument, values, WISP_COUNT( values ) );
            return true;
        case KEY_BOUNDARY:
            options->source.layer = looks[option_word( state, "--boundary", argument, layers, WISP_COUNT( layers ) )];
            return true;
        case KEY_NORMALS:
            options->source.has_layer_normals = true;
            return true;
        case KEY_RANGE:
            parse_range( state, argument, options );
            return true;
        case KEY_GROUND:
            picture_parse_ground( state, argument, options );
            return true;
        case KEY_BACKGROUND:
            picture_parse_background( state, argument, options );
            return true;
        case KEY_MESH:
            options->source.mesh = argument;
            return true;
        case KEY_SIZE:
            picture_parse_size( state, argument, options );
            return true;
        case KEY_SAMPLES:
            options->samples = option_whole( state, "--samples", argument, 1, RENDER_MAX_SAMPLES );
            return true;
        case KEY_OUTPUT:
            options->output = argument;
            return true;
        case KEY_WORKERS:
            options->workers = option_whole( state, "--workers", argument, 1, WISP_MAX_WORKERS );
            options->source.world.workers = options->workers;
            return true;
        default:
            return false;
    }
}

static void check( struct argp_state* state, const picture_options* options )
{
    if ( !options->output )
    {
        argp_error( state, "expected -o FILE.png" );
    }
    if ( !io_has_extension( options->output, ".png" ) )
    {
        argp_error( state, "-o: got '%s', expected a file name that ends in .png", options->output );
    }
    if ( options->turntable > 0 && options->choice == PICTURE_FRAMES )
    {
        argp_error( state, "--turntable: expected one frame, but --frames selects several" );
    }
    if ( options->has_range && options->source.value == PICTURE_BODY )
    {
        argp_error( state, "--range: expected together with --colour strain or --colour speed" );
    }
}

static error_t parse( int key, char* argument, struct argp_state* state )
{
    picture_options* options = state->input;
    switch ( key )
    {
        case ARGP_KEY_ARG:
            if ( options->source.path )
            {
                argp_error( state, "got a second file '%s', expected one", argument );
            }
            options->source.path = argument;
            return 0;
        case ARGP_KEY_NO_ARGS:
            argp_error( state, "expected a scene, recording, mesh or groom" );
            return 0;
        case ARGP_KEY_SUCCESS:
            check( state, options );
            return 0;
        default:
            return parse_view( key, argument, state ) || parse_look( key, argument, state ) ? 0 : ARGP_ERR_UNKNOWN;
    }
}

int command_render( int argc, char** argv )
{
    picture_options options = picture_default_options();
    const struct argp parser = { option_list, parse, "SCENE|RECORDING|MESH|GROOM", doc, NULL, NULL, NULL };
    argp_parse( &parser, argc, argv, 0, NULL, &options );

    wisp_error error = { 0 };
    wisp_status status = picture_draw( &options, &error );
    if ( status == WISP_OK && ( fflush( stdout ) != 0 || ferror( stdout ) ) )
    {
        status = wisp_fail( &error, WISP_IO_ERROR, "standard output: the list of pictures could not be written" );
    }
    return status == WISP_OK ? STATUS_GOOD : command_fail( &error );
}
