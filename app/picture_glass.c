// Which colliders hide what moves. A surface that nothing solves, such as a figure that wears cloth, hides half of it by nature.
#include "picture_stage.h"

#include <stdlib.h>

enum
{
    SIGHTS_MAX = 400, // points of a surface that are looked at
};

// A surface is hidden if a quarter of it would be seen but for colliders; each that hides a tenth of it is glass.
static const double HIDDEN = 0.25, HIDES = 0.10;

static bool is_surface( const picture_body* body )
{
    return body->kind == SCENE_BODY_CLOTH || body->kind == SCENE_BODY_BALLOON;
}

/// Points of all surfaces and what is seen before them.
typedef struct sights
{
    wisp_vec3* points;  // [count]
    int *owner, *first; // [count] bodies of the source; first is -1 where the view is free
    int count;
} sights;

static wisp_status make_sights( const picture_source* source, sights* out, wisp_error* error )
{
    const size_t room = (size_t)source->body_count * SIGHTS_MAX + 1;
    *out = ( sights ){
        .points = malloc( room * sizeof *out->points ),
        .owner = malloc( room * sizeof *out->owner ),
        .first = malloc( room * sizeof *out->first ),
    };
    if ( !out->points || !out->owner || !out->first )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for its picture" );
    }
    for ( int i = 0; i < source->body_count; ++i )
    {
        const picture_body* body = &source->bodies[i];
        const int step = 1 + ( body->vertex_count - 1 ) / SIGHTS_MAX;
        for ( int v = 0; v < body->vertex_count && is_surface( body ); v += step )
        {
            out->owner[out->count] = i;
            out->points[out->count++] = body->points[v];
        }
    }
    return WISP_OK;
}

static void free_sights( sights* s )
{
    free( s->points );
    free( s->owner );
    free( s->first );
}

// Numbers of the stage's meshes as bodies of the source: the stage has them in the source's order.
static void name_bodies( const picture_source* source, const picture_stage* stage, sights* s )
{
    for ( int k = 0; k < s->count; ++k )
    {
        int mesh = s->first[k], body = -1;
        for ( int i = 0; i < source->body_count && mesh >= 0 && mesh < stage->scene.mesh_count && body < 0; ++i )
        {
            body = stage->meshes[mesh].points == source->bodies[i].points ? i : -1;
        }
        s->first[k] = body;
    }
}

static bool is_collider( const picture_source* source, int body )
{
    return body >= 0 && source->bodies[body].kind == SCENE_BODY_COLLIDER && !source->bodies[body].is_led;
}

// @param begin, end sights of one surface
// @param hides [body_count] zero, and zero afterwards
static void judge( const picture_source* source, const sights* s, int begin, int end, int* hides, bool* is_glass )
{
    const double count = (double)( end - begin );
    int hidden = 0;
    for ( int k = begin; k < end; ++k )
    {
        if ( is_collider( source, s->first[k] ) )
        {
            ++hides[s->first[k]];
            ++hidden;
        }
    }
    for ( int i = 0; i < source->body_count; ++i )
    {
        is_glass[i] = is_glass[i] || ( (double)hidden > HIDDEN * count && (double)hides[i] > HIDES * count );
        hides[i] = 0;
    }
}

static void judge_all( const picture_source* source, const sights* s, int* hides, bool* is_glass )
{
    for ( int begin = 0, end = 0; begin < s->count; begin = end )
    {
        for ( end = begin; end < s->count && s->owner[end] == s->owner[begin]; )
        {
            ++end;
        }
        judge( source, s, begin, end, hides, is_glass );
    }
}

wisp_status picture_stage_find_glass( const picture_source* source, const render_camera* camera, picture_look* look,
                                      wisp_error* error )
{
    picture_stage stage = { 0 };
    sights s = { .count = 0 };
    look->is_glass = calloc( (size_t)source->body_count + 1, sizeof *look->is_glass );
    int* hides = calloc( (size_t)source->body_count + 1, sizeof *hides );
    wisp_status status = look->is_glass && hides
                             ? make_sights( source, &s, error )
                             : wisp_fail( error, WISP_NO_MEMORY, "out of memory for its picture" );
    status = status == WISP_OK ? picture_stage_make( source, look, &stage, error ) : status;
    if ( status == WISP_OK )
    {
        status = render_find_hiding( &stage.scene, camera, s.points, s.count, s.first, error );
    }
    if ( status == WISP_OK )
    {
        name_bodies( source, &stage, &s );
        judge_all( source, &s, hides, look->is_glass );
    }
    picture_stage_release( &stage );
    free_sights( &s );
    free( hides );
    return status;
}
