/// Calls that a scene makes before a step. Where the world of the scene has a file for them, they are written to it as C too.
#pragma once

#include "world_from_scene.h"

/// A value as C.
typedef struct c_text
{
    char text[200];
} c_text;

/// Nine digits are every bit of a float.
c_text c_number( float value );
c_text c_whole( int64_t value );
c_text c_switch( bool value );
c_text c_vector( wisp_vec3 v );
c_text c_transform( wisp_transform t );

void scene_call_begin( scene_world* world, const char* function, wisp_entity entity );
void scene_call_value( scene_world* world, c_text value );
void scene_call_entity( scene_world* world, wisp_entity value );
void scene_call_vertices( scene_world* world, const int32_t* vertices, int count );
void scene_call_points( scene_world* world, const wisp_vec3* points, int count );
/// @param last as C, what follows the values
void scene_call_end( scene_world* world, const char* last );

#define SCENE_CALL_VALUE( world, value )                                                                             \
    scene_call_value( world, _Generic( ( value ), float                                                              \
                                       : c_number, bool                                                              \
                                       : c_switch, wisp_vec3                                                         \
                                       : c_vector, wisp_transform                                                    \
                                       : c_transform, default                                                        \
                                       : c_whole )( value ) )

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
      scene_call_value( w, c_whole( count ) ), scene_call_end( w, "" ),                                              \
      function( ( w )->world, entity, vertices, count ) )
#define SCENE_CALL_POINTS( w, function, entity, vertices, points, count )                                            \
    ( scene_call_begin( w, #function, entity ), scene_call_vertices( w, vertices, count ),                           \
      scene_call_points( w, points, count ), scene_call_value( w, c_whole( count ) ), scene_call_end( w, "" ),       \
      function( ( w )->world, entity, vertices, points, count ) )
