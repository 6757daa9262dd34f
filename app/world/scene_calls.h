/// Calls that a scene makes before a step. Where the world of the scene has a file for them, they are written to it as C too.
#pragma once

#include "world_from_scene.h"

typedef struct number_text
{
    char text[40];
} number_text;

/// Nine digits are every bit of a float.
number_text c_number( float value );
void c_vector( FILE* out, wisp_vec3 v );
void c_transform( FILE* out, wisp_transform t );

void scene_call_begin( scene_world* world, const char* function, wisp_entity entity );
void scene_call_number( scene_world* world, float value );
void scene_call_whole( scene_world* world, int value );
void scene_call_switch( scene_world* world, bool value );
void scene_call_vector( scene_world* world, wisp_vec3 value );
void scene_call_transform( scene_world* world, wisp_transform value );
void scene_call_entity( scene_world* world, wisp_entity value );
void scene_call_vertices( scene_world* world, const int32_t* vertices, int count );
void scene_call_points( scene_world* world, const wisp_vec3* points, int count );
/// @param last as C, what follows the values
void scene_call_end( scene_world* world, const char* last );

#define SCENE_CALL_VALUE( world, value )                                                                             \
    _Generic( ( value ), float                                                                                       \
              : scene_call_number, bool                                                                              \
              : scene_call_switch, wisp_vec3                                                                         \
              : scene_call_vector, wisp_transform                                                                    \
              : scene_call_transform, default                                                                        \
              : scene_call_whole )( world, value )

/// Make a call whose values follow the entity.
#define SCENE_CALL( w, function, entity, a )                                                                         \
    ( scene_call_begin( w, #function, entity ), SCENE_CALL_VALUE( w, a ), scene_call_end( w, "" ),                   \
      function( ( w )->world, entity, a ) )
#define SCENE_CALL_2( w, function, entity, a, b )                                                                    \
    ( scene_call_begin( w, #function, entity ), SCENE_CALL_VALUE( w, a ), SCENE_CALL_VALUE( w, b ),                  \
      scene_call_end( w, "" ), function( ( w )->world, entity, a, b ) )
/// The same of vertices of a surface, and of a point for each.
#define SCENE_CALL_VERTICES( w, function, entity, vertices, count )                                                  \
    ( scene_call_begin( w, #function, entity ), scene_call_vertices( w, vertices, count ),                           \
      scene_call_whole( w, count ), scene_call_end( w, "" ), function( ( w )->world, entity, vertices, count ) )
#define SCENE_CALL_POINTS( w, function, entity, vertices, points, count )                                            \
    ( scene_call_begin( w, #function, entity ), scene_call_vertices( w, vertices, count ),                           \
      scene_call_points( w, points, count ), scene_call_whole( w, count ), scene_call_end( w, "" ),                  \
      function( ( w )->world, entity, vertices, points, count ) )
