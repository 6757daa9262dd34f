// Colliders, and what happens to surfaces and strands in the course of a scene.
#include "torture_builder.h"

#include <stdlib.h>
#include <string.h>

// ---- colliders ----

static void put_friction( torture_builder* b, text_node* collider )
{
    if ( torture_random_chance( &b->random, 70 ) )
    {
        torture_put_linear( b, collider, "friction", 0.0, 1.2 );
        return;
    }
    text_node* pair = text_put( collider, "friction", text_list() );
    text_add( pair, text_scalar( "%s", torture_random_linear( &b->random, 0.6, 1.2 ).text ) );
    text_add( pair, text_scalar( "%s", torture_random_linear( &b->random, 0.0, 0.6 ).text ) );
}

// The defaults are a metre: everything else would start inside.
static void put_size( torture_builder* b, text_node* collider, const char* shape )
{
    const bool is_capsule = strcmp( shape, "capsule" ) == 0;
    if ( is_capsule || strcmp( shape, "sphere" ) == 0 )
    {
        torture_put_log( b, collider, "radius", 0.02, 0.2 );
    }
    const bool is_tapered = strcmp( shape, "tapered_capsule" ) == 0;
    if ( is_tapered )
    {
        torture_put_log( b, collider, "top_radius", 0.02, 0.2 );
        torture_put_log( b, collider, "bottom_radius", 0.02, 0.2 );
    }
    if ( is_capsule || is_tapered )
    {
        torture_put_linear( b, collider, "half_length", 0.0, 0.4 );
    }
    if ( strcmp( shape, "box" ) == 0 )
    {
        torture_put_vector( b, collider, "half_extent", ( const double[] ){ 0.02, 0.02, 0.02 },
                            ( const double[] ){ 0.3, 0.15, 0.3 } );
    }
}

// Of few points: a hull has at most 1024.
static void put_hull( torture_builder* b, text_node* collider )
{
    text_node* generate = text_put( collider, "generate", text_map() );
    text_put( generate, "shape", text_scalar( "icosphere" ) );
    text_put( generate, "level", text_scalar( "%d", torture_random_whole( &b->random, 0, 2 ) ) );
    torture_put_log( b, generate, "radius", 0.02, 0.2 );
}

static void put_heights( torture_builder* b, text_node* collider )
{
    text_node* rows = text_put( collider, "heights", text_list() );
    const int count_x = torture_random_whole( &b->random, 2, 8 ), count_z = torture_random_whole( &b->random, 2, 8 );
    for ( int k = 0; k < count_z; ++k )
    {
        text_node* row = text_add( rows, text_list() );
        for ( int i = 0; i < count_x; ++i )
        {
            text_add( row, text_scalar( "%s", torture_random_linear( &b->random, -0.3, 0.1 ).text ) );
        }
    }
    torture_put_log( b, collider, "spacing", 0.05, 0.5 );
}

// The first one is the ground, most of the time.
void torture_make_collider( torture_builder* b )
{
    static const char* const words[] = { "plane", "sphere",          "capsule", "box",
                                         "mesh",  "tapered_capsule", "convex",  "height_field" };
    const bool is_ground = b->colliders->count == 0 && ( b->is_stack || torture_random_chance( &b->random, 85 ) );
    const char* shape = is_ground ? words[0] : words[torture_random_whole( &b->random, 1, WISP_COUNT( words ) - 1 )];
    text_node* collider = text_add( b->colliders, text_map() );
    text_put( collider, "name", text_scalar( "body%d", b->colliders->count ) );
    text_put( collider, "shape", text_scalar( "%s", shape ) );
    const torture_block block = torture_entry_block( "colliders", collider );
    const bool is_mesh = strcmp( shape, "mesh" ) == 0;
    const bool is_open = is_mesh && torture_random_chance( &b->random, 30 );
    double centre[3] = { 0.0, 0.0, 0.0 };
    if ( is_mesh )
    {
        torture_put_mesh( b, block, collider, !is_open );
    }
    if ( strcmp( shape, "convex" ) == 0 )
    {
        put_hull( b, collider );
    }
    if ( is_mesh && ( is_open || text_find( collider, "file" ) ) )
    {
        text_put( collider, "double_sided", text_scalar( "true" ) );
    }
    if ( !is_ground )
    {
        text_node* position = torture_put_vector( b, collider, "position", ( const double[] ){ -0.2, -0.1, -0.2 },
                                                  ( const double[] ){ 0.2, 0.2, 0.2 } );
        for ( int i = 0; i < 3; ++i )
        {
            text_is_number( position->children[i], &centre[i] );
        }
    }
    if ( strcmp( shape, "height_field" ) == 0 )
    {
        put_heights( b, collider );
    }
    put_friction( b, collider );
    put_size( b, collider, shape );
    torture_draw_keys( &b->random, block, 35, collider );
    if ( torture_random_chance( &b->random, is_ground ? 10 : 45 ) )
    {
        torture_put_keyframes( b, collider, "keyframes", "position", "rotation", centre );
    }
}

// ---- seams ----

// The first vertices are there in every mesh.
void torture_make_seam( torture_builder* b, text_node* seams )
{
    const int first = torture_random_whole( &b->random, 0, b->surfaces->count - 1 ),
              second = torture_random_whole( &b->random, 0, b->surfaces->count - 1 );
    text_node* seam = text_add( seams, text_map() );
    text_put( seam, "name", text_scalar( "seam%d", seams->count ) );
    text_node* names = text_put( seam, "surfaces", text_list() );
    text_add( names, text_scalar( "%s", text_at( b->surfaces->children[first], "name" ) ) );
    text_add( names, text_scalar( "%s", text_at( b->surfaces->children[second], "name" ) ) );
    text_node* pairs = text_put( seam, "pairs", text_list() );
    for ( int i = torture_random_whole( &b->random, 0, 1 ); i < 3; ++i )
    {
        text_node* pair = text_add( pairs, text_list() );
        text_add( pair, text_scalar( "%d", i ) );
        text_add( pair, text_scalar( "%d", ( i + 1 ) % 3 ) );
    }
    torture_draw_keys( &b->random, torture_entry_block( "seams", seam ), 40, seam );
}

// ---- events ----

static bool has_number_above( const text_node* map, const char* key, double limit )
{
    double value = 0.0;
    return text_is_number( text_find( map, key ), &value ) && value > limit;
}

static void put_wind( torture_builder* b, text_node* event )
{
    torture_put_vector( b, event, "wind", ( const double[] ){ -8, -2, -8 }, ( const double[] ){ 8, 2, 8 } );
}

// Return whether an event releases the pins of a surface; a second one is refused.
static bool is_released( const torture_builder* b, const char* surface )
{
    bool found = false;
    for ( int i = 0; i < b->events->count; ++i )
    {
        const text_node* event = b->events->children[i];
        found = found || ( text_find( event, "release" ) && strcmp( text_at( event, "surface" ), surface ) == 0 );
    }
    return found;
}

static void change_surface( torture_builder* b, text_node* event, const text_node* surface )
{
    const text_node* cloth = text_find( surface, "cloth" );
    const text_node* balloon = text_find( surface, "balloon" );
    const bool has_air =
        has_number_above( cloth, "drag_coefficient", 0.0 ) || has_number_above( cloth, "lift_coefficient", 0.0 );
    const bool is_pinned =
        text_find( surface, "pins" ) || text_find( surface, "pin_nearest" ) || text_find( surface, "pin_box" );
    text_put( event, "surface", text_scalar( "%s", text_at( surface, "name" ) ) );
    if ( has_air && torture_random_chance( &b->random, 50 ) )
    {
        put_wind( b, event );
    }
    else if ( is_pinned && torture_random_chance( &b->random, 30 ) )
    {
        if ( is_released( b, text_at( surface, "name" ) ) )
        {
            torture_put_vector( b, event, "velocity", ( const double[] ){ -3, -3, -3 },
                                ( const double[] ){ 3, 3, 3 } );
            return;
        }
        text_put( event, "release", text_scalar( "true" ) );
    }
    else if ( balloon && text_find( balloon, "outlet_nearest" ) && torture_random_chance( &b->random, 40 ) )
    {
        text_put( event, "outlet_open",
                  text_scalar( "%s", torture_random_chance( &b->random, 70 ) ? "true" : "false" ) );
    }
    else if ( balloon && !text_find( balloon, "gas_ratio_keyframes" ) && torture_random_chance( &b->random, 60 ) )
    {
        torture_put_linear( b, event, "gas_ratio", 1.0, 1.6 );
    }
    else
    {
        torture_draw_keys( &b->random, torture_block_below( torture_block_of_scene(), "events", event ), 0, event );
        const bool is_gust = torture_random_chance( &b->random, 25 );
        const double most = is_gust ? 1.0 : 3.0;
        torture_put_vector( b, event, is_gust ? "gust" : "velocity", ( const double[] ){ -most, -most, -most },
                            ( const double[] ){ most, most, most } );
        if ( is_gust && torture_random_chance( &b->random, 30 ) )
        {
            text_put( event, "gust_per_triangle", text_scalar( "true" ) );
        }
    }
}

void torture_make_event( torture_builder* b, int number )
{
    const int count = b->surfaces->count + b->strands->count;
    const int entry = torture_random_whole( &b->random, 0, count - 1 );
    const bool is_surface = entry < b->surfaces->count;
    const text_node* changed =
        is_surface ? b->surfaces->children[entry] : b->strands->children[entry - b->surfaces->count];
    const text_node* dynamics = text_find( changed, "dynamics" );
    const bool has_frozen = text_find( changed, "frozen_hair" ) != NULL;
    if ( !is_surface && !has_frozen && !has_number_above( dynamics, "drag_coefficient", 0.0 ) )
    {
        return;
    }
    text_node* event = text_add( has_frozen ? b->hair_events : b->events, text_map() );
    text_put( event, "step", text_scalar( "%d", number * b->steps / 10 ) );
    if ( is_surface )
    {
        change_surface( b, event, changed );
        return;
    }
    text_put( event, "strands", text_scalar( "%s", text_at( changed, "name" ) ) );
    if ( has_frozen )
    {
        torture_put_vector( b, event, "cursor", ( const double[] ){ -0.3, 0, -0.3 },
                            ( const double[] ){ 0.3, 0.8, 0.3 } );
        return;
    }
    put_wind( b, event );
}
