// A window with a cloth, hair and a ball that swings through both, drawn by OpenGL ES 2 from the views of the engine.
//
//     cc -std=c17 window.c $(pkg-config --cflags --libs wisp sdl2 glesv2) -lm -o window && ./window
//
// The key L shows lines of what is simulated: links by their stretch, pins, contacts, the collider, frames of hair.
//
// `window 150 frame.ppm` draws 150 frames, writes the last one as a picture, and ends with status 0 if all three are in it.
#include <wisp/create.h>
#include <wisp/generate.h>
#include <wisp/lines.h>

#include <GLES2/gl2.h>
#include <SDL.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define WIDTH 960
#define HEIGHT 720
#define SIDE 41 // vertices of the cloth
#define SEGMENTS 24
#define RINGS 16
#define STEP ( 1.0f / 60.0f )

static wisp_vec3 cloth_points[WISP_GRID_VERTICES( SIDE, SIDE )], ball_points[WISP_SPHERE_VERTICES( SEGMENTS, RINGS )];
static int32_t cloth_triangles[WISP_GRID_TRIANGLES( SIDE, SIDE )][3];
static int32_t ball_triangles[WISP_SPHERE_TRIANGLES( SEGMENTS, RINGS )][3];
static wisp_vec3 hair_points[20 * 5 * 16];
static int32_t hair_offsets[20 * 5 + 1];

typedef struct stage
{
    wisp_world* world;
    wisp_entity cloth, hair, ball;
    wisp_vec3 place; // of the ball, m
    float time;      // s
    int shows_lines;
} stage;

// ---- what moves ----

static wisp_status build( stage* s, wisp_error* error )
{
    static const int32_t corners[] = { 0, SIDE - 1 };
    wisp_world_def world_def = wisp_default_world_def();
    wisp_create_cloth_def cloth_def = wisp_default_create_cloth_def();
    wisp_create_hair_def hair_def = wisp_default_create_hair_def();
    wisp_collider_def ball_def = wisp_default_collider_def();
    world_def.modules = wisp_all_modules( &world_def.module_count );
    wisp_status status = wisp_world_create( &world_def, &s->world, error );
    wisp_generate_grid( SIDE, SIDE, 0.025f, 0.025f, cloth_points, &cloth_triangles[0][0], NULL );
    wisp_generate_sphere( SEGMENTS, RINGS, 0.15f, ball_points, &ball_triangles[0][0], NULL );
    wisp_generate_strand_rows( 20, 5, 0.01f, 16, 0.5f, hair_points, hair_offsets, NULL );
    for ( int i = 0; i < WISP_COUNT( cloth_points ); ++i ) // upright
    {
        cloth_points[i] = ( wisp_vec3 ){ cloth_points[i].x - 0.5f, -cloth_points[i].z, 0.0f };
    }
    for ( int i = 0; i < WISP_COUNT( hair_points ); ++i )
    {
        hair_points[i].x += 0.5f, hair_points[i].y += 0.4f;
    }
    cloth_def.points = cloth_points, cloth_def.vertex_count = WISP_COUNT( cloth_points );
    cloth_def.triangles = &cloth_triangles[0][0], cloth_def.triangle_count = WISP_COUNT( cloth_triangles );
    cloth_def.pins = corners, cloth_def.pin_count = 2, cloth_def.drag_coefficient = 1.0f;
    hair_def.points = hair_points, hair_def.offsets = hair_offsets, hair_def.drag_coefficient = 1.0f;
    hair_def.strand_count = WISP_COUNT( hair_offsets ) - 1;
    ball_def.kind = WISP_COLLIDER_SPHERE, ball_def.radius = 0.15f;
    ball_def.pose.translation = s->place = ( wisp_vec3 ){ -0.1f, -0.1f, -0.5f };
    status = status ? status : wisp_create_cloth( s->world, &cloth_def, &s->cloth );
    status = status ? status : wisp_create_hair( s->world, &hair_def, &s->hair );
    return status ? status : wisp_add_collider( s->world, &ball_def, &s->ball );
}

static void before_step( void* user, wisp_world* world )
{
    stage* s = user;
    s->time += STEP;
    s->place = ( wisp_vec3 ){ -0.1f - 0.6f * sinf( 2.0f * s->time ), -0.1f, -0.5f * cosf( 2.0f * s->time ) };
    wisp_move_collider( world, s->ball, wisp_transform_make( ( wisp_quat ){ 0, 0, 0, 1 }, s->place ) );
}

// ---- what is drawn ----

static const char* const VERTEX =
    "attribute vec3 point, normal, tint; uniform vec3 place; varying vec3 n, t;"
    "void main() { vec3 p = point + place - vec3( 0.0, 0.0, 2.4 ); n = normal; t = tint;"
    "gl_Position = vec4( p.x * 1.35, p.y * 1.8, -1.02 * p.z - 0.2, -p.z ); }";
static const char* const FRAGMENT =
    "precision mediump float; uniform vec3 colour; varying vec3 n, t;"
    "void main() { float light = dot( n, n ) > 0.0 ? abs( dot( normalize( n ), vec3( 0.48, 0.36, 0.8 ) ) ) : 1.0;"
    "gl_FragColor = vec4( ( colour + t ) * ( 0.3 + 0.7 * light ), 1.0 ); }";
static GLint place_at, colour_at;

static void open_program( void )
{
    const GLuint program = glCreateProgram();
    for ( int i = 0; i < 2; ++i )
    {
        const GLuint shader = glCreateShader( i == 0 ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER );
        glShaderSource( shader, 1, i == 0 ? &VERTEX : &FRAGMENT, NULL );
        glCompileShader( shader );
        glAttachShader( program, shader );
    }
    glBindAttribLocation( program, 0, "point" );
    glBindAttribLocation( program, 1, "normal" );
    glBindAttribLocation( program, 2, "tint" );
    glLinkProgram( program );
    glUseProgram( program );
    place_at = glGetUniformLocation( program, "place" );
    colour_at = glGetUniformLocation( program, "colour" );
    glEnable( GL_DEPTH_TEST );
    glEnableVertexAttribArray( 0 );
    glClearColor( 0.05f, 0.06f, 0.08f, 1.0f );
}

// The arrays are the engine's own: points and normals of a view are drawn without a copy. GLES 2 has indices of 16 bits.
static void draw_mesh( const void* points, const void* normals, const int32_t* triangles, int index_count )
{
    static GLushort indices[3 * WISP_GRID_TRIANGLES( SIDE, SIDE )];
    for ( int i = 0; i < index_count; ++i )
    {
        indices[i] = (GLushort)triangles[i];
    }
    glEnableVertexAttribArray( 1 );
    glVertexAttribPointer( 0, 3, GL_FLOAT, GL_FALSE, 0, points );
    glVertexAttribPointer( 1, 3, GL_FLOAT, GL_FALSE, 0, normals );
    glDrawElements( GL_TRIANGLES, index_count, GL_UNSIGNED_SHORT, indices );
    glDisableVertexAttribArray( 1 );
}

static wisp_status draw_lines( const stage* s )
{
    static wisp_line lines[30000];
    int count; // may be more than there is room for
    const wisp_status status = wisp_debug_lines( s->world, WISP_LINES_ALL, NULL, lines, WISP_COUNT( lines ), &count );
    glUniform3f( place_at, 0.0f, 0.0f, 0.0f );
    glUniform3f( colour_at, 0.0f, 0.0f, 0.0f );
    glVertexAttribPointer( 0, 3, GL_FLOAT, GL_FALSE, sizeof( wisp_line_end ), &lines[0].ends[0].point );
    glVertexAttribPointer( 2, 3, GL_FLOAT, GL_FALSE, sizeof( wisp_line_end ), &lines[0].ends[0].colour );
    glVertexAttrib3f( 1, 0.0f, 0.0f, 0.0f );
    glEnableVertexAttribArray( 2 );
    glDrawArrays( GL_LINES, 0, 2 * ( count < WISP_COUNT( lines ) ? count : WISP_COUNT( lines ) ) );
    glDisableVertexAttribArray( 2 );
    glVertexAttrib3f( 2, 0.0f, 0.0f, 0.0f );
    return status;
}

static wisp_status draw( const stage* s )
{
    wisp_view points, normals, hair;
    wisp_status status = wisp_world_view( s->world, s->cloth, WISP_SURFACE_POINTS, &points );
    status = status ? status : wisp_world_view( s->world, s->cloth, WISP_SURFACE_NORMALS, &normals );
    status = status ? status : wisp_world_view( s->world, s->hair, WISP_STRAND_POINTS, &hair );
    if ( status != WISP_OK )
    {
        return status;
    }
    glClear( GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT );
    if ( s->shows_lines )
    {
        return draw_lines( s );
    }
    glUniform3f( place_at, 0.0f, 0.0f, 0.0f );
    glUniform3f( colour_at, 0.9f, 0.1f, 0.1f );
    draw_mesh( points.data, normals.data, &cloth_triangles[0][0], 3 * WISP_COUNT( cloth_triangles ) );
    glUniform3f( colour_at, 0.1f, 0.9f, 0.1f );
    glVertexAttrib3f( 1, 0.0f, 0.0f, 0.0f );
    glVertexAttribPointer( 0, 3, GL_FLOAT, GL_FALSE, 0, hair.data );
    for ( int i = 0; i < WISP_COUNT( hair_offsets ) - 1; ++i )
    {
        glDrawArrays( GL_LINE_STRIP, hair_offsets[i], hair_offsets[i + 1] - hair_offsets[i] );
    }
    glUniform3f( place_at, s->place.x, s->place.y, s->place.z );
    glUniform3f( colour_at, 0.1f, 0.1f, 0.9f );
    draw_mesh( ball_points, ball_points, &ball_triangles[0][0], 3 * WISP_COUNT( ball_triangles ) );
    return WISP_OK;
}

// Write the frame, and say whether cloth, hair and ball are in it: red, green and blue pixels.
static int write_picture( const char* path )
{
    static unsigned char pixels[HEIGHT][WIDTH][3], rgba[HEIGHT][WIDTH][4];
    int seen[3] = { 0 };
    glReadPixels( 0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, rgba );
    for ( int p = 0; p < WIDTH * HEIGHT; ++p )
    {
        const unsigned char* from = rgba[HEIGHT - 1 - p / WIDTH][p % WIDTH];
        for ( int c = 0; c < 3; ++c )
        {
            pixels[p / WIDTH][p % WIDTH][c] = from[c];
            seen[c] += from[c] > 60 && from[c] > 2 * from[( c + 1 ) % 3] && from[c] > 2 * from[( c + 2 ) % 3];
        }
    }
    FILE* file = fopen( path, "wb" );
    const int is_written = file && fprintf( file, "P6\n%d %d\n255\n", WIDTH, HEIGHT ) > 0 &&
                           fwrite( pixels, sizeof pixels, 1, file ) == 1;
    const int is_closed = file && fclose( file ) == 0;
    printf( "%s: %d pixels of cloth, %d of hair, %d of the ball\n", path, seen[0], seen[1], seen[2] );
    return is_written && is_closed && seen[0] > 20000 && seen[1] > 2000 && seen[2] > 3000;
}

static wisp_status show( stage* s, SDL_Window* window, int frame_count )
{
    Uint64 last = SDL_GetPerformanceCounter();
    for ( int frame = 0; frame_count == 0 || frame < frame_count; ++frame )
    {
        SDL_Event event;
        while ( SDL_PollEvent( &event ) )
        {
            if ( event.type == SDL_QUIT )
            {
                return WISP_OK;
            }
            s->shows_lines ^= event.type == SDL_KEYDOWN && event.key.keysym.sym == SDLK_l;
        }
        const Uint64 now = SDL_GetPerformanceCounter();
        const float seconds = (float)( now - last ) / (float)SDL_GetPerformanceFrequency();
        last = now;
        // a number of frames is for a picture, which should not depend on the machine
        wisp_status status = wisp_world_advance( s->world, frame_count > 0 ? STEP : seconds, STEP, before_step, s );
        status = status ? status : draw( s );
        if ( status != WISP_OK )
        {
            return status;
        }
        if ( frame + 1 != frame_count )
        {
            SDL_GL_SwapWindow( window );
        }
    }
    return WISP_OK;
}

int main( int argument_count, char** arguments )
{
    const int frame_count = argument_count > 2 ? atoi( arguments[1] ) : 0;
    stage s = { 0 };
    wisp_error error = { 0 };
    SDL_Init( SDL_INIT_VIDEO );
    SDL_SetHint( SDL_HINT_OPENGL_ES_DRIVER, "1" ); // by EGL, which every driver has
    SDL_GL_SetAttribute( SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_ES );
    SDL_GL_SetAttribute( SDL_GL_CONTEXT_MAJOR_VERSION, 2 );
    SDL_Window* window = SDL_CreateWindow( "wisp", SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, WIDTH, HEIGHT,
                                           SDL_WINDOW_OPENGL );
    SDL_GLContext context = window ? SDL_GL_CreateContext( window ) : NULL;
    if ( context == NULL )
    {
        fprintf( stderr, "no window: %s\n", SDL_GetError() );
        return 1;
    }
    open_program();
    wisp_status status = build( &s, &error );
    status =
        status ? status
               : wisp_world_advance( s.world, STEP, STEP, before_step, &s ); // the first frame has something to draw
    status = status ? status : show( &s, window, frame_count );
    int is_good = status == WISP_OK;
    if ( is_good && frame_count > 0 )
    {
        is_good = write_picture( arguments[2] );
    }
    printf( "%s%s\n", error.message, wisp_world_message( s.world ) );
    wisp_world_destroy( s.world );
    SDL_GL_DeleteContext( context );
    SDL_DestroyWindow( window );
    SDL_Quit();
    return is_good ? 0 : 1;
}
