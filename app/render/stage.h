/// A scene prepared for rays: trees, normals, lamps, and the characteristic lengths.
#pragma once

#include "sampler.h"
#include "trace.h"
#include "wisp/module/vec.h"

// ---- colours: vectors with a componentwise product ----

static inline wisp_vec3 rgb_mul( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x * b.x, a.y * b.y, a.z * b.z };
}

static inline wisp_vec3 rgb_grey( float level )
{
    return ( wisp_vec3 ){ level, level, level };
}

/// a at share 0, b at share 1.
static inline wisp_vec3 rgb_mix( wisp_vec3 a, wisp_vec3 b, float fraction )
{
    return wisp_v3_mul_add( wisp_v3_scale( a, 1.0f - fraction ), fraction, b );
}

static inline float rgb_largest( wisp_vec3 a )
{
    return fmaxf( a.x, fmaxf( a.y, a.z ) );
}

static inline float clamp01( float value )
{
    return fminf( 1.0f, fmaxf( 0.0f, value ) );
}

/// 0 below low, 1 above high, smooth between.
static inline float smooth_step( float lower, float upper, float value )
{
    float t = clamp01( ( value - lower ) / ( upper - lower ) );
    return t * t * ( 3.0f - 2.0f * t );
}

// ---- the stage ----

/// The lamps. The key light is far away and round; the rest is a sky with two soft boxes, seen in glossy bodies only.
typedef struct stage_lamps
{
    wisp_vec3 key;          ///< direction towards the middle of the key light
    wisp_vec3 key_x, key_y; ///< across it
    wisp_vec3 rim;          ///< towards the narrow box behind the bodies
    wisp_vec3 rim_x, rim_y; ///< across it
} stage_lamps;

/// Surfaces apart from bodies.
typedef struct stage_ground
{
    bool is_there;
    float height;  ///< m
    float square;  ///< m, side of a square
    float visible; ///< m, distance from the middle at which squares and shadows fade
} stage_ground;

typedef struct stage
{
    const render_scene* scene;
    trace_tree* tree;
    wisp_vec3** normals;     ///< [mesh_count] by vertex; null for faceted meshes
    bool has_translucent;    ///< some body is translucent, so that shadows have colours
    trace_widening widening; ///<
    stage_lamps lamps;       ///<
    stage_ground ground;     ///<
    wisp_vec3 middle;        ///< m, of all bodies
    float size;              ///< m, half the diagonal of all bodies
    float lift;              ///< m, offset of a ray's start above its surface
} stage;

/// A point of a body, with the data for shading.
typedef struct surface
{
    wisp_vec3 place;   ///< m
    wisp_vec3 lifted;  ///< start of rays to the lamps: above the flat triangle of a round body
    wisp_vec3 face;    ///< the flat normal on the viewer's side
    wisp_vec3 normal;  ///< the smooth one
    wisp_vec3 tangent; ///< of a strand, from root to tip
    wisp_vec3 colour;  ///< linear RGB
    float radius;      ///< m, of a strand
    int body;          ///<
    bool is_curve;     ///<
    bool is_back;      ///< the side from which the triangle's corners are seen clockwise
    bool is_painted;   ///< colours are numbers or patterns, which the material must not change
    render_material material;
} surface;

/// @param scene checked
/// @param pixel_fraction width of a pixel at a metre from the camera
wisp_status stage_build( stage* out, const render_scene* scene, const render_camera* camera,
                         const render_options* options, float pixel_fraction, wisp_error* error );

/// A zero stage, or one that failed to be built, is allowed.
void stage_release( stage* s );

/// The colour of a hit body there.
wisp_vec3 stage_colour( const stage* s, const trace_hit* hit );

/// Light transmitted once through the skin of a body; nothing for solids.
wisp_vec3 stage_passage( const stage* s, int body, wisp_vec3 colour );

/// The kind of the body with this number.
bool stage_is_curve( const stage* s, int body );
bool stage_is_glass( const stage* s, int body );

surface stage_surface( const stage* s, const trace_ray* ray, const trace_hit* hit );
