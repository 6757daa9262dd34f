#include "commands.h"

#include "interruption.h"
#include "io_file.h"
#include "picture_draw.h"

#include <stdlib.h>
#include <unistd.h>

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
    KEY_CUT,
};

static const char* const value_words[] = { "body", "strain", "speed", "map" };
static const char* const layer_words[] = { "normal", "class", "none" };
static const char* const ground_words[] = { "auto", "none" };
static const char* const background_words[] = { "studio", "white", "dark" };

static const option_row rows[] = {
    OPTION_TITLE( "Picture:" ),
    { "output", KEY_OUTPUT, "FILE.png", "Write the picture to FILE.png; required", OPTION_FILES( ".png" ) },
    { "size", KEY_SIZE, "WxH", "Pixels, default 640x480; on a sheet 400x300 each", OPTION_ANY },
    { "samples", KEY_SAMPLES, "N", "Rays per pixel, 1 to 4096, default 16", OPTION_ANY },
    { "workers", KEY_WORKERS, "N", "Use N workers, 1 to 64, default one per core", OPTION_ANY },
    OPTION_TITLE( "Frames, default the last one:" ),
    { "frame", KEY_FRAME, "N", "Frame N, counted from 0", OPTION_ANY },
    { "time", KEY_TIME, "S", "The frame nearest to S seconds", OPTION_ANY },
    { "frames", KEY_FRAMES, "A:B:STEP", "Frames A to B, both included; parts can be omitted", OPTION_ANY },
    { "sheet", KEY_SHEET, "[COLUMNS]", "One contact sheet of --frames, or of twelve frames", OPTION_ANY },
    OPTION_TITLE( "Camera:" ),
    { "from", KEY_FROM, "AZIMUTH,ELEVATION",
      "Direction in degrees: about y from +z to +x, and up; default 32,16, or 0,0 for strands in a plane",
      OPTION_ANY },
    { "fov", KEY_FOV, "DEGREES", "Vertical angle of view, 1 to 150, default 28", OPTION_ANY },
    { "camera", KEY_CAMERA, "X,Y,Z,X,Y,Z", "Eye and target in metres, instead of --from", OPTION_ANY },
    { "turntable", KEY_TURNTABLE, "N", "N views around one frame", OPTION_ANY },
    OPTION_TITLE( "Appearance:" ),
    { "colour", KEY_COLOUR, "WHAT", "body (default), strain, speed, or map: the first map of a surface",
      OPTION_WORDS( value_words ) },
    { "color", KEY_COLOUR, "WHAT", NULL, OPTION_WORDS( value_words ) },
    { "range", KEY_RANGE, "LOW,HIGH", "Values at the ends of the colour scale", OPTION_ANY },
    { "boundary", KEY_BOUNDARY, "WHAT", "Boundary points by normal (default) or class, or none",
      OPTION_WORDS( layer_words ) },
    { "cut", KEY_CUT, "X,Y,Z,D", "Cut bodies open: draw what has X x + Y y + Z z <= D", OPTION_ANY },
    { "normals", KEY_NORMALS, NULL, "Draw normals of boundary points", OPTION_ANY },
    { "ground", KEY_GROUND, "WHERE", "auto (default), none, or y in metres", OPTION_WORDS( ground_words ) },
    { "background", KEY_BACKGROUND, "WHAT", "studio (default), white, dark, #20242c, or #top,#bottom",
      OPTION_WORDS( background_words ) },
    { "mesh", KEY_MESH, "FILE", "Triangles for a point cache (.obj, .ply)", OPTION_FILES( ".obj .ply" ) },
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
    .rows = rows,
    .row_count = WISP_COUNT( rows ),
    .values = OPTION_FILES( ".yaml .yml .json .wisp .pc2 .obj .ply .glb .gltf .hair" ),
};

static void choose_frames( const options_state* o, picture_options* options, picture_choice choice )
{
    if ( options->choice != PICTURE_LAST )
    {
        options_fail( o, "got several of --frame, --time and --frames, expected one" );
    }
    options->choice = choice;
}

static void parse_range( const options_state* o, const char* argument, picture_options* options )
{
    picture_parse_numbers( o, argument, 2, options->range );
    if ( !( options->range[0] < options->range[1] ) )
    {
        options_fail( o, "--range: got '%s', expected two rising numbers", argument );
    }
    options->has_range = true;
}

static void parse_camera( const options_state* o, const char* argument, picture_options* options )
{
    float n[6];
    picture_parse_numbers( o, argument, 6, n );
    options->eye = ( wisp_vec3 ){ n[0], n[1], n[2] };
    options->target = ( wisp_vec3 ){ n[3], n[4], n[5] };
    options->has_camera = true;
}

static void parse_from( const options_state* o, const char* argument, picture_options* options )
{
    float n[2];
    picture_parse_numbers( o, argument, 2, n );
    if ( !( n[1] >= -89.0f && n[1] <= 89.0f ) )
    {
        options_fail( o, "--from: got an elevation of %g, expected -89 to 89 degrees", (double)n[1] );
    }
    options->view.azimuth_degrees = n[0];
    options->view.elevation_degrees = n[1];
    options->has_from = true;
}

static void parse_cut( const options_state* o, const char* argument, picture_options* options )
{
    float n[4];
    picture_parse_numbers( o, argument, 4, n );
    options->cut_normal = ( wisp_vec3 ){ n[0], n[1], n[2] };
    options->cut_offset = n[3];
    if ( n[0] == 0.0f && n[1] == 0.0f && n[2] == 0.0f )
    {
        options_fail( o, "--cut: got '%s', expected a direction that is not zero, and a distance", argument );
    }
}

static void parse_fov( const options_state* o, const char* argument, picture_options* options )
{
    picture_parse_numbers( o, argument, 1, &options->view.fov_degrees );
    if ( !( options->view.fov_degrees >= 1.0f && options->view.fov_degrees <= 150.0f ) )
    {
        options_fail( o, "--fov: got '%s', expected 1 to 150 degrees", argument );
    }
}

/// Options about time and place. @return whether it was one of them
static bool parse_view( const options_state* o, int key, const char* argument )
{
    picture_options* options = o->input;
    switch ( key )
    {
        case KEY_FRAME:
            choose_frames( o, options, PICTURE_FRAME );
            options->first = option_whole( o, argument, 0, FRAME_MAX );
            return true;
        case KEY_TIME:
        {
            float seconds;
            choose_frames( o, options, PICTURE_TIME );
            picture_parse_numbers( o, argument, 1, &seconds );
            options->seconds = (double)seconds;
            return true;
        }
        case KEY_FRAMES:
            choose_frames( o, options, PICTURE_FRAMES );
            picture_parse_frames( o, argument, options );
            return true;
        case KEY_SHEET:
            options->is_sheet = true;
            options->columns = argument ? option_whole( o, argument, 1, COLUMNS_MAX ) : 0;
            return true;
        case KEY_TURNTABLE:
            options->turntable = option_whole( o, argument, 1, TURNTABLE_MAX );
            return true;
        case KEY_CAMERA:
            parse_camera( o, argument, options );
            return true;
        case KEY_FROM:
            parse_from( o, argument, options );
            return true;
        case KEY_FOV:
            parse_fov( o, argument, options );
            return true;
        case KEY_CUT:
            parse_cut( o, argument, options );
            return true;
        default:
            return false;
    }
}

/// Options about the look of things. @return whether it was one of them
static bool parse_look( const options_state* o, int key, const char* argument )
{
    static const picture_layer_look looks[] = { PICTURE_LAYER_NORMAL, PICTURE_LAYER_CLASS, PICTURE_LAYER_NONE };
    picture_options* options = o->input;
    switch ( key )
    {
        case KEY_COLOUR:
            options->source.value = (picture_value)option_word( o, argument );
            return true;
        case KEY_BOUNDARY:
            options->source.layer = looks[option_word( o, argument )];
            return true;
        case KEY_NORMALS:
            options->source.has_layer_normals = true;
            return true;
        case KEY_RANGE:
            parse_range( o, argument, options );
            return true;
        case KEY_GROUND:
            picture_parse_ground( o, argument, options );
            return true;
        case KEY_BACKGROUND:
            picture_parse_background( o, argument, options );
            return true;
        case KEY_MESH:
            options->source.mesh = argument;
            return true;
        case KEY_SIZE:
            picture_parse_size( o, argument, options );
            return true;
        case KEY_SAMPLES:
            options->samples = option_whole( o, argument, 1, RENDER_MAX_SAMPLES );
            return true;
        case KEY_OUTPUT:
            options->output = argument;
            return true;
        case KEY_WORKERS:
            options->workers = option_whole( o, argument, 1, WISP_MAX_WORKERS );
            options->source.world.workers = options->workers;
            return true;
        default:
            return false;
    }
}

static void check( const options_state* o, const picture_options* options )
{
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

static bool take( options_state* o, int key, const char* argument )
{
    picture_options* options = o->input;
    switch ( key )
    {
        case OPTIONS_OPERAND:
            return option_input( o, key, argument, &options->source.path );
        case OPTIONS_END:
            if ( !options->source.path )
            {
                options_fail( o, "expected a scene, recording, mesh or groom" );
            }
            check( o, options );
            return true;
        default:
            return parse_view( o, key, argument ) || parse_look( o, key, argument );
    }
}

int command_render( int argc, char** argv )
{
    picture_options options = picture_default_options();
    options_parse( &render_text, take, &options, argc, argv );

    wisp_error error = { 0 };
    wisp_status status = picture_draw( &options, &error );
    if ( status == WISP_OK && ( fflush( stdout ) != 0 || ferror( stdout ) ) )
    {
        status = wisp_fail( &error, WISP_IO_ERROR, "standard output: the list of pictures could not be written" );
    }
    return status == WISP_OK ? interruption_status( STATUS_GOOD ) : command_fail( &error );
}
