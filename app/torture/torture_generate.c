#include "torture_builder.h"

#include "torture_generate.h"
#include "torture_twins.h"

#include <stdlib.h>
#include <string.h>

// ---- pieces ----

bool torture_chance( torture_builder* b, int percent )
{
    return torture_random_chance( &b->random, percent );
}

torture_block torture_entry_block( const char* list, const text_node* entry )
{
    return torture_block_below( torture_block_of_scene(), list, entry );
}

text_node* torture_put_block( torture_builder* b, torture_block outer, text_node* map, const char* key, int percent )
{
    text_node* block = text_put( map, key, text_map() );
    torture_draw_keys( &b->random, torture_block_below( outer, key, block ), percent, block );
    return block;
}

text_node* torture_put_linear( torture_builder* b, text_node* map, const char* key, double lower, double upper )
{
    return text_put( map, key, text_scalar( "%s", torture_random_linear( &b->random, lower, upper ).text ) );
}

text_node* torture_put_log( torture_builder* b, text_node* map, const char* key, double lower, double upper )
{
    return text_put( map, key, text_scalar( "%s", torture_random_log( &b->random, lower, upper ).text ) );
}

text_node* torture_put_vector( torture_builder* b, text_node* map, const char* key, const double lower[3],
                               const double upper[3] )
{
    text_node* list = text_put( map, key, text_list() );
    for ( int i = 0; i < 3; ++i )
    {
        text_add( list, text_scalar( "%s", torture_random_linear( &b->random, lower[i], upper[i] ).text ) );
    }
    return list;
}

static void put_rotation( torture_builder* b, text_node* map, const char* key )
{
    text_node* rotation = text_put( map, key, text_map() );
    torture_put_vector( b, rotation, "degrees", ( const double[] ){ -180, -180, -180 },
                        ( const double[] ){ 180, 180, 180 } );
}

text_node* torture_put_keyframes( torture_builder* b, text_node* map, const char* key, const char* position,
                                  const char* rotation, const double centre[3] )
{
    const double REACH = 0.3;
    const int count = torture_random_whole( &b->random, 1, 4 );
    const double lower[3] = { centre[0] - REACH, centre[1] - REACH, centre[2] - REACH };
    const double upper[3] = { centre[0] + REACH, centre[1] + REACH, centre[2] + REACH };
    text_node* list = text_put( map, key, text_list() );
    double time = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        text_node* keyframe = text_add( list, text_map() );
        // Cloth that collapses in a jump touches itself everywhere, and a step of it costs a thousand times as much.
        const bool is_jump = torture_chance( b, b->has_contact ? 2 : 15 );
        time += is_jump ? 0.001 : 0.05 * torture_random_whole( &b->random, 1, 8 );
        text_put( keyframe, "time", text_scalar( "%.5g", time ) );
        torture_put_vector( b, keyframe, position, lower, upper );
        if ( torture_chance( b, 40 ) )
        {
            put_rotation( b, keyframe, rotation );
        }
    }
    return list;
}

// Words of the shapes in the order of the reader; closed ones come last but for the tube.
void torture_put_mesh( torture_builder* b, torture_block block, text_node* entry, bool is_closed )
{
    static const char* const closed[] = { "icosphere", "uv_sphere", "torus", "capsule", "pear" };
    static const char* const open[] = { "plane",   "plane", "alternating_plane", "irregular_plane", "delaunay",
                                        "garment", "tube" };
    const torture_generator* g = b->generator;
    if ( g->mesh_count > 0 && torture_chance( b, 30 ) )
    {
        text_put( entry, "file",
                  text_scalar( "%s", g->meshes[torture_random_whole( &b->random, 0, g->mesh_count - 1 )] ) );
        return;
    }
    const bool takes_closed = is_closed || torture_chance( b, 15 );
    text_node* generate = text_put( entry, "generate", text_map() );
    const char* shape = takes_closed ? closed[torture_random_whole( &b->random, 0, WISP_COUNT( closed ) - 1 )]
                                     : open[torture_random_whole( &b->random, 0, WISP_COUNT( open ) - 1 )];
    text_put( generate, "shape", text_scalar( "%s", shape ) );
    const torture_block table = torture_block_below( block, "generate", generate );
    if ( strcmp( shape, "torus" ) == 0 )
    {
        torture_put_linear( b, generate, "radius", 0.1, 0.2 );
        torture_put_linear( b, generate, "tube_radius", 0.03, 0.08 );
    }
    const bool is_by_count = strcmp( shape, "delaunay" ) == 0 || strcmp( shape, "garment" ) == 0;
    if ( is_by_count )
    {
        text_put( generate, "vertices", text_scalar( "%d", torture_random_whole( &b->random, 64, 160 ) ) );
    }
    torture_draw_keys( &b->random, table, 100, generate );
}

// ---- colliders ----

static void put_friction( torture_builder* b, text_node* collider )
{
    if ( torture_chance( b, 70 ) )
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
static void make_collider( torture_builder* b )
{
    static const char* const words[] = { "plane", "sphere",          "capsule", "box",
                                         "mesh",  "tapered_capsule", "convex",  "height_field" };
    const bool is_ground = b->colliders->count == 0 && ( b->is_stack || torture_chance( b, 85 ) );
    const char* shape = is_ground ? words[0] : words[torture_random_whole( &b->random, 1, WISP_COUNT( words ) - 1 )];
    text_node* collider = text_add( b->colliders, text_map() );
    text_put( collider, "name", text_scalar( "body%d", b->colliders->count ) );
    text_put( collider, "shape", text_scalar( "%s", shape ) );
    const torture_block block = torture_entry_block( "colliders", collider );
    const bool is_mesh = strcmp( shape, "mesh" ) == 0;
    const bool is_open = is_mesh && torture_chance( b, 30 );
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
    if ( torture_chance( b, is_ground ? 10 : 45 ) )
    {
        torture_put_keyframes( b, collider, "keyframes", "position", "rotation", centre );
    }
}

// ---- seams ----

// The first vertices are there in every mesh.
static void make_seam( torture_builder* b, text_node* seams )
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
    if ( has_air && torture_chance( b, 50 ) )
    {
        put_wind( b, event );
    }
    else if ( is_pinned && torture_chance( b, 30 ) )
    {
        if ( is_released( b, text_at( surface, "name" ) ) )
        {
            torture_put_vector( b, event, "velocity", ( const double[] ){ -3, -3, -3 },
                                ( const double[] ){ 3, 3, 3 } );
            return;
        }
        text_put( event, "release", text_scalar( "true" ) );
    }
    else if ( balloon && text_find( balloon, "outlet_nearest" ) && torture_chance( b, 40 ) )
    {
        text_put( event, "outlet_open", text_scalar( "%s", torture_chance( b, 70 ) ? "true" : "false" ) );
    }
    else if ( balloon && !text_find( balloon, "gas_ratio_keyframes" ) && torture_chance( b, 60 ) )
    {
        torture_put_linear( b, event, "gas_ratio", 1.0, 1.6 );
    }
    else
    {
        torture_draw_keys( &b->random, torture_block_below( torture_block_of_scene(), "events", event ), 0, event );
        const bool is_gust = torture_chance( b, 25 );
        const double most = is_gust ? 1.0 : 3.0;
        torture_put_vector( b, event, is_gust ? "gust" : "velocity", ( const double[] ){ -most, -most, -most },
                            ( const double[] ){ most, most, most } );
        if ( is_gust && torture_chance( b, 30 ) )
        {
            text_put( event, "gust_per_triangle", text_scalar( "true" ) );
        }
    }
}

static void make_event( torture_builder* b, int number )
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

// ---- scenes ----

static text_node* make_steps( torture_builder* b, text_node* scene )
{
    static const char* const lengths[] = { "0.004", "0.008", "0.0166667", "0.0166667", "0.0166667", "0.033", "0.05" };
    static const char* const substeps[] = { "2", "4", "5", "8", "10", "10", "10", "16", "20" };
    const double seconds = torture_random_whole( &b->random, 2, 5 );
    const char* dt = lengths[torture_random_whole( &b->random, 0, WISP_COUNT( lengths ) - 1 )];
    const int MOST = b->has_contact ? 150 : 240; // contact is what costs most
    const int steps = (int)( seconds / strtod( dt, NULL ) );
    b->steps = steps < MOST ? steps : MOST;
    text_put( scene, "dt", text_scalar( "%s", dt ) );
    if ( torture_chance( b, 25 ) )
    {
        text_node* factors = text_put( scene, "dt_factors", text_list() );
        for ( int i = torture_random_whole( &b->random, 2, 7 ); i > 0; --i )
        {
            text_add( factors, text_scalar( "%s", torture_random_log( &b->random, 0.1, 3.0 ).text ) );
        }
    }
    text_put( scene, "steps", text_scalar( "%d", b->steps ) );
    text_put( scene, "substeps",
              text_scalar( "%s", substeps[torture_random_whole( &b->random, 0, WISP_COUNT( substeps ) - 1 )] ) );
    if ( torture_chance( b, 25 ) )
    {
        text_put( scene, "iterations", text_scalar( "%d", torture_random_whole( &b->random, 1, 4 ) ) );
    }
    return scene;
}

static void make_world( torture_builder* b, text_node* scene )
{
    if ( torture_chance( b, 20 ) )
    {
        torture_put_vector( b, scene, "gravity", ( const double[] ){ -4, -20, -4 }, ( const double[] ){ 4, 0, 4 } );
    }
    if ( b->has_contact && torture_chance( b, 40 ) )
    {
        torture_put_block( b, torture_block_of_scene(), scene, "contact", 30 );
    }
}

// Lists that nothing is in are not written.
static void take_list( text_node* scene, const char* key, text_node* list )
{
    if ( list->count > 0 )
    {
        text_put( scene, key, list );
    }
    else
    {
        text_release( list );
    }
}

text_node* torture_generate( const torture_generator* generator, int number )
{
    torture_builder b = { .random = torture_random_start( generator->seed, (uint64_t)number ),
                          .generator = generator,
                          .surfaces = text_list(),
                          .strands = text_list(),
                          .colliders = text_list(),
                          .events = text_list(),
                          .hair_events = text_list() };
    text_node* scene = text_map();
    text_put( scene, "wisp", text_scalar( "1" ) );
    b.is_stack = torture_chance( &b, 8 );
    // hair, a surface and a body meet in a third; by numbers of their own, so that other scenes of a seed stay what they are
    torture_random mixing = torture_random_start( generator->seed ^ UINT64_C( 0x3157 ), (uint64_t)number );
    const bool is_mixed = b.is_stack == false && torture_random_chance( &mixing, 33 );
    b.has_contact = b.is_stack || torture_chance( &b, 45 ) || is_mixed;
    make_steps( &b, scene );
    make_world( &b, scene );
    const int surfaces = torture_random_whole( &b.random, b.is_stack ? 2 : is_mixed ? 1 : 0, is_mixed ? 2 : 3 );
    const int strands = surfaces == 0 || is_mixed ? 1 : torture_random_whole( &b.random, 0, 5 ) / 4;
    for ( int i = 0; i < surfaces; ++i )
    {
        torture_make_surface( &b );
    }
    for ( int i = 0; i < strands; ++i )
    {
        torture_make_strands( &b );
    }
    for ( int i = b.is_stack ? 1 : torture_random_whole( &b.random, is_mixed ? 1 : 0, 3 ); i > 0; --i )
    {
        make_collider( &b );
    }
    for ( int i = torture_random_whole( &b.random, 0, 3 ); i > 0; --i )
    {
        make_event( &b, i );
    }
    take_list( scene, "surfaces", b.surfaces );
    take_list( scene, "strands", b.strands );
    take_list( scene, "colliders", b.colliders );
    // by numbers of their own: other scenes of a seed stay what they are without seams
    text_node* seams = text_list();
    const torture_random random = b.random;
    b.random = torture_random_start( generator->seed ^ UINT64_C( 0x5ea5 ), (uint64_t)number );
    if ( surfaces > 0 && torture_chance( &b, 15 ) )
    {
        make_seam( &b, seams );
    }
    b.random = random;
    take_list( scene, "seams", seams );
    take_list( scene, "events", b.events );
    take_list( scene, "hair_events", b.hair_events );
    // The same materials at another size are stiff or soft, and fall through their own size at once or never.
    static const double sizes[] = { 0.01, 0.02, 0.1, 5.0 };
    if ( torture_chance( &b, 18 ) )
    {
        torture_resize( scene, sizes[torture_random_whole( &b.random, 0, WISP_COUNT( sizes ) - 1 )] );
    }
    return scene;
}
