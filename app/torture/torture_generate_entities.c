// Surfaces and strands of a scene.
#include "torture_builder.h"

#include <stdlib.h>
#include <string.h>

// ---- surfaces ----

typedef struct surface_maker
{
    torture_builder* b;
    text_node* entry;
    torture_block block;
    double place[3];
} surface_maker;

// ---- where ----

static void put_transform( surface_maker* m, int number )
{
    text_node* transform = text_put( m->entry, "transform", text_map() );
    if ( torture_chance( m->b, 50 ) )
    {
        text_node* rotate = text_put( transform, "rotate", text_map() );
        torture_put_vector( m->b, rotate, "degrees", ( const double[] ){ -90, -90, -90 },
                            ( const double[] ){ 90, 90, 90 } );
    }
    const double y = 0.3 + 0.35 * number;
    const text_node* place = torture_put_vector( m->b, transform, "translate", ( const double[] ){ -0.1, y, -0.1 },
                                                 ( const double[] ){ 0.1, y + 0.1, 0.1 } );
    for ( int i = 0; i < 3; ++i )
    {
        text_is_number( place->children[i], &m->place[i] );
    }
}

static bool put_pins( surface_maker* m )
{
    text_node* columns = text_find( text_find( m->entry, "generate" ), "columns" );
    if ( columns && torture_chance( m->b, 50 ) )
    {
        text_node* pins = text_put( m->entry, "pins", text_list() );
        text_add( pins, text_scalar( "0" ) );
        text_add( pins, text_scalar( "%d", atoi( columns->text ) - 1 ) );
    }
    else
    {
        text_node* list = text_put( m->entry, "pin_nearest", text_list() );
        for ( int i = torture_random_whole( &m->b->random, 1, 3 ); i > 0; --i )
        {
            text_node* point = text_add( list, text_list() );
            for ( int k = 0; k < 3; ++k )
            {
                text_add(
                    point,
                    text_scalar(
                        "%s", torture_random_linear( &m->b->random, m->place[k] - 0.3, m->place[k] + 0.3 ).text ) );
            }
        }
    }
    if ( torture_chance( m->b, 45 ) )
    {
        torture_put_keyframes( m->b, m->entry, "pin_keyframes", "translate", "rotate",
                               ( const double[] ){ 0, 0, 0 } );
    }
    return true;
}

// ---- effects ----

// Other meshes are too small for a coarse sheet.
static void put_coarse_sheets( surface_maker* m, text_node* cloth )
{
    const int substeps = torture_random_whole( &m->b->random, 1, 3 );
    const int passes = torture_random_whole( &m->b->random, 1, 20 );
    text_node* generate = text_find( m->entry, "generate" );
    const bool is_plane = strstr( text_at( generate, "shape" ), "plane" ) != NULL;
    if ( is_plane && strcmp( text_at( cloth, "solver" ), "pbd" ) != 0 )
    {
        text_put( generate, "columns", text_scalar( "27" ) );
        text_put( generate, "rows", text_scalar( "27" ) );
        text_put( cloth, "coarse_substeps", text_scalar( "%d", substeps ) );
        text_put( cloth, "coarse_passes", text_scalar( "%d", passes ) );
    }
}

static void put_cloth( surface_maker* m, bool is_pinned, bool is_instance )
{
    text_node* cloth = torture_put_block( m->b, m->block, m->entry, "cloth", 30 );
    if ( !is_pinned || is_instance )
    {
        text_remove_key( cloth, "tethers" );
    }
    if ( !is_instance && torture_chance( m->b, 20 ) )
    {
        put_coarse_sheets( m, cloth );
    }
}

static void put_balloon( surface_maker* m )
{
    text_node* balloon = torture_put_block( m->b, m->block, m->entry, "balloon", 25 );
    torture_put_linear( m->b, balloon, "gas_ratio", 1.0, 1.6 );
    if ( torture_chance( m->b, 25 ) )
    {
        text_node* list = text_put( balloon, "gas_ratio_keyframes", text_list() );
        for ( int i = 0; i < 3; ++i )
        {
            text_node* pair = text_add( list, text_list() );
            text_add( pair, text_scalar( "%.3g", 0.4 * i ) );
            text_add( pair, text_scalar( "%s", torture_random_linear( &m->b->random, 1.0, 1.8 ).text ) );
        }
    }
    if ( torture_chance( m->b, 10 ) )
    {
        torture_put_log( m->b, balloon, "inflation_rate", 1e-5, 1e-2 );
    }
    if ( torture_chance( m->b, 25 ) )
    {
        torture_put_vector( m->b, balloon, "outlet_nearest", ( const double[] ){ -0.2, 0, -0.2 },
                            ( const double[] ){ 0.2, 0.6, 0.2 } );
        text_put( balloon, "outlet_open", text_scalar( "%s", torture_chance( m->b, 50 ) ? "true" : "false" ) );
    }
    if ( text_find( m->entry, "file" ) )
    {
        text_put( balloon, "allow_open", text_scalar( "true" ) );
    }
}

// Links of quads need a regular plane and stiffnesses of links.
static void put_implicit( surface_maker* m, const text_node* source )
{
    text_node* implicit = torture_put_block( m->b, m->block, m->entry, "implicit", 30 );
    const bool is_plane = strcmp( text_at( text_find( source, "generate" ), "shape" ), "plane" ) == 0;
    if ( !is_plane || strcmp( text_at( implicit, "stiffness_model" ), "link" ) != 0 )
    {
        text_remove_key( implicit, "links" );
    }
}

static void put_strain_limit( surface_maker* m )
{
    text_node* pair = text_put( m->entry, "strain_limit", text_list() );
    text_add( pair, text_scalar( "%s", torture_random_linear( &m->b->random, 0.0, 0.95 ).text ) );
    text_add( pair, text_scalar( "%s", torture_random_linear( &m->b->random, 1.02, 1.5 ).text ) );
}

// What stands by the effect of a surface: damping, what stops it, points on it.
static void put_surroundings( surface_maker* m, bool is_implicit )
{
    if ( torture_chance( m->b, 65 ) )
    {
        torture_put_log( m->b, m->entry, "damping", 0.5, 10.0 );
    }
    if ( torture_chance( m->b, 85 ) )
    {
        text_node* collision = torture_put_block( m->b, m->block, m->entry, "collision", 25 );
        if ( is_implicit )
        {
            text_remove_key( collision, "features" );
        }
    }
    if ( m->b->has_contact && torture_chance( m->b, 80 ) )
    {
        text_node* contact = torture_put_block( m->b, m->block, m->entry, "contact", 25 );
        torture_put_log( m->b, contact, "thickness", 1e-3, 5e-3 );
    }
    if ( !is_implicit && torture_chance( m->b, 15 ) )
    {
        put_strain_limit( m );
    }
    if ( torture_chance( m->b, 20 ) )
    {
        torture_put_block( m->b, m->block, m->entry, "sleep", 30 );
    }
    if ( torture_chance( m->b, 8 ) )
    {
        torture_put_block( m->b, m->block, m->entry, "boundary", 20 );
    }
}

// A cloth of a stack: it lies flat, a few centimetres above the one below, and weighs what it likes.
static void make_layer( torture_builder* b )
{
    const int number = b->surfaces->count;
    text_node* entry = text_add( b->surfaces, text_map() );
    surface_maker m = { b, entry, torture_entry_block( "surfaces", entry ), { 0.0, 0.0, 0.0 } };
    text_put( entry, "name", text_scalar( "surface%d", number ) );
    text_node* generate = text_put( entry, "generate", text_map() );
    text_put( generate, "shape", text_scalar( "%s", torture_chance( m.b, 50 ) ? "plane" : "alternating_plane" ) );
    torture_draw_keys( &b->random, torture_block_below( m.block, "generate", generate ), 100, generate );
    text_node* transform = text_put( entry, "transform", text_map() );
    text_node* rotate = text_put( transform, "rotate", text_map() );
    const double y = 0.03 + 0.05 * number;
    torture_put_vector( b, rotate, "degrees", ( const double[] ){ 0, -90, 0 }, ( const double[] ){ 0, 90, 0 } );
    torture_put_vector( b, transform, "translate", ( const double[] ){ -0.05, y, -0.05 },
                        ( const double[] ){ 0.05, y, 0.05 } );
    torture_put_log( b, entry, "area_density", 0.02, 20.0 );
    torture_put_log( b, entry, "damping", 0.5, 10.0 );
    torture_put_block( b, m.block, entry, "cloth", 15 );
    text_remove_key( text_find( entry, "cloth" ), "tethers" );
    text_remove_key( text_find( entry, "cloth" ), "wind" );
    torture_put_block( b, m.block, entry, "collision", 15 );
    text_node* contact = torture_put_block( b, m.block, entry, "contact", 15 );
    torture_put_log( b, contact, "thickness", 2e-3, 0.02 );
}

void torture_make_surface( torture_builder* b )
{
    if ( b->is_stack )
    {
        make_layer( b );
        return;
    }
    const int number = b->surfaces->count, kind = torture_random_whole( &b->random, 0, 99 );
    const bool is_balloon = kind < 30, is_implicit = kind >= 30 && kind < 50, is_cloth = kind >= 50 && kind < 95;
    const text_node* first = number > 0 ? b->surfaces->children[0] : NULL;
    const bool is_instance =
        first && text_find( first, "generate" ) && text_find( first, "balloon" ) && torture_chance( b, 30 );
    text_node* entry = text_add( b->surfaces, text_map() );
    surface_maker m = { b, entry, torture_entry_block( "surfaces", entry ), { 0.0, 0.0, 0.0 } };
    text_put( entry, "name", text_scalar( "surface%d", number ) );
    if ( is_instance )
    {
        text_put( entry, "instance_of", text_scalar( "%s", text_at( first, "name" ) ) );
    }
    else
    {
        torture_put_mesh( b, m.block, entry, is_balloon );
    }
    put_transform( &m, number );
    const bool is_pinned = torture_chance( b, is_balloon ? 20 : 55 ) && put_pins( &m );
    torture_draw_keys( &b->random, m.block, 20, entry );
    if ( is_instance )
    {
        text_remove_key( entry, "solve_order" );
    }
    if ( is_cloth )
    {
        put_cloth( &m, is_pinned, is_instance );
    }
    else if ( is_balloon )
    {
        put_balloon( &m );
    }
    else if ( is_implicit )
    {
        put_implicit( &m, is_instance ? first : entry );
    }
    put_surroundings( &m, is_implicit );
}

// ---- strands ----

typedef struct strands_maker
{
    torture_builder* b;
    text_node* entry;
    torture_block block;
    int strands, vertices;
} strands_maker;

static text_node* begin_entry( torture_builder* b, const char* name )
{
    text_node* entry = text_add( b->strands, text_map() );
    text_put( entry, "name", text_scalar( "%s%d", name, b->strands->count ) );
    return entry;
}

static void put_groom( strands_maker* m, bool is_frozen )
{
    static const char* const shapes[] = { "straight", "wavy", "curly" };
    text_node* generate = text_put( m->entry, "generate", text_map() );
    text_put( generate, "shape", text_scalar( "%s", shapes[torture_random_whole( &m->b->random, 0, 2 )] ) );
    m->strands = torture_random_whole( &m->b->random, 1, 12 );
    m->vertices = torture_random_whole( &m->b->random, is_frozen ? 4 : 2, 24 );
    text_put( generate, "strands", text_scalar( "%d", m->strands ) );
    text_put( generate, "vertices", text_scalar( "%d", m->vertices ) );
    torture_draw_keys( &m->b->random, torture_block_below( m->block, "generate", generate ), 100, generate );
    text_node* transform = text_put( m->entry, "transform", text_map() );
    torture_put_vector( m->b, transform, "translate", ( const double[] ){ -0.1, 0.4, -0.1 },
                        ( const double[] ){ 0.1, 0.8, 0.1 } );
}

static void put_masses( strands_maker* m, text_node* dynamics )
{
    text_node* list = text_put( dynamics, "vertex_masses", text_list() );
    text_remove_key( dynamics, "vertex_mass" );
    for ( int i = m->strands * m->vertices; i > 0; --i )
    {
        text_add( list, text_scalar( "%s", torture_random_log( &m->b->random, 1e-6, 1e-4 ).text ) );
    }
}

// Only rods have an elliptic section, and it is stiffer across its width.
static void keep_section( text_node* dynamics )
{
    double edgewise = 0.0, flat = 0.0;
    text_is_number( text_find( dynamics, "edgewise_rigidity" ), &edgewise );
    text_is_number( text_find( dynamics, "bend_rigidity" ), &flat );
    const char* const bending = text_at( dynamics, "bending" );
    if ( edgewise < flat || edgewise > 1e5 * flat || flat <= 0.0 ||
         ( bending[0] != 0 && strcmp( bending, "rod" ) != 0 ) )
    {
        text_remove_key( dynamics, "edgewise_rigidity" );
        edgewise = 0.0;
    }
    if ( edgewise <= 0.0 )
    {
        text_remove_key( dynamics, "natural_twist" );
        text_remove_key( dynamics, "flat_normal" );
    }
}

// Closed strands are rings and nothing else. Roots are free of strands that are not sag-free, or do not bend as rods.
static void keep_roots( strands_maker* m, text_node* dynamics )
{
    const char *const bending = text_at( dynamics, "bending" ), *const rest = text_at( dynamics, "rest" );
    const bool is_rod = bending[0] == 0 || strcmp( bending, "rod" ) == 0;
    text_remove_key( dynamics, "closed" );
    text_remove_key( dynamics, "closing_twist" );
    if ( ( is_rod && ( rest[0] == 0 || strcmp( rest, "sag_free" ) == 0 ) ) || text_find( m->entry, "tips" ) != NULL )
    {
        text_remove_key( dynamics, "free_roots" );
    }
}

static void put_dynamics( strands_maker* m )
{
    text_node* dynamics = torture_put_block( m->b, m->block, m->entry, "dynamics", 30 );
    if ( strcmp( text_at( dynamics, "integrator" ), "bdf2" ) == 0 )
    {
        text_remove_key( dynamics, "stretch" ); // BDF2 needs direct lengths, the default
    }
    keep_section( dynamics );
    keep_roots( m, dynamics );
    if ( torture_chance( m->b, 70 ) )
    {
        torture_put_log( m->b, dynamics, "damping", 0.5, 10.0 );
    }
    if ( m->strands * m->vertices < 60 && torture_chance( m->b, 10 ) )
    {
        put_masses( m, dynamics );
    }
    const bool is_free = strcmp( text_at( dynamics, "free_roots" ), "true" ) == 0;
    if ( m->b->surfaces->count > 0 && torture_chance( m->b, 30 ) && is_free == false )
    {
        text_put( m->entry, "on_surface", text_scalar( "%s", text_at( m->b->surfaces->children[0], "name" ) ) );
    }
    else if ( torture_chance( m->b, 60 ) )
    {
        double centre[3] = { 0.0, 0.0, 0.0 };
        const text_node* place = text_find( text_find( m->entry, "transform" ), "translate" );
        for ( int i = 0; i < 3; ++i )
        {
            text_is_number( place->children[i], &centre[i] );
        }
        text_node* head = text_put( m->entry, "head", text_map() );
        torture_put_keyframes( m->b, head, "keyframes", "position", "rotation", centre );
    }
    static const char* const blocks[] = { "grid", "collision", "contact", "sleep" };
    static const int percents[] = { 25, 55, 60, 20 };
    for ( int i = 0; i < WISP_COUNT( blocks ); ++i )
    {
        const bool is_contact = strcmp( blocks[i], "contact" ) == 0;
        if ( ( !is_contact || m->b->has_contact ) && torture_chance( m->b, percents[i] ) )
        {
            torture_put_block( m->b, m->block, m->entry, blocks[i], 30 );
        }
    }
}

static void put_frozen_hair( strands_maker* m )
{
    text_node* frozen = torture_put_block( m->b, m->block, m->entry, "frozen_hair", 30 );
    const torture_block block = torture_block_below( m->block, "frozen_hair", frozen );
    static const char* const stages[] = { "freeze", "align", "clump" };
    for ( int i = 0; i < WISP_COUNT( stages ); ++i )
    {
        if ( torture_chance( m->b, 60 ) )
        {
            torture_put_block( m->b, block, frozen, stages[i], 30 );
        }
    }
    // A stroke has its cursors from hair events, and they need strands that align.
    const bool is_stroke = strcmp( text_at( frozen, "base" ), "stroke" ) == 0;
    text_node* align = text_find( frozen, "align" );
    if ( is_stroke && align )
    {
        text_remove_key( align, "cursor" );
    }
    else if ( is_stroke )
    {
        text_remove_key( frozen, "base" );
    }
    if ( torture_chance( m->b, 40 ) )
    {
        torture_put_block( m->b, m->block, m->entry, "environment", 40 );
    }
}

// Ghosts around what moves, with or without frozen hair on top; and curves through either.
static void make_followers( torture_builder* b, const char* source )
{
    text_node* entry = begin_entry( b, "ghosts" );
    strands_maker m = { b, entry, torture_entry_block( "strands", entry ), 0, 0 };
    text_node* scatter = text_put( entry, "scatter", text_map() );
    text_put( scatter, "around", text_scalar( "%s", source ) );
    text_put( scatter, "count", text_scalar( "%d", torture_random_whole( &b->random, 1, 4 ) ) );
    torture_put_linear( b, scatter, "radius", 0.0, 0.02 );
    torture_put_block( b, m.block, entry, "ghosts", 30 );
    if ( torture_chance( m.b, 25 ) )
    {
        torture_put_block( b, m.block, entry, "collision", 30 );
    }
    if ( torture_chance( m.b, 20 ) )
    {
        put_frozen_hair( &m );
    }
}

static void make_curves( torture_builder* b, const char* source )
{
    text_node* entry = begin_entry( b, "curves" );
    text_node* curves = torture_put_block( b, torture_entry_block( "strands", entry ), entry, "curves", 50 );
    text_put( curves, "of", text_scalar( "%s", source ) );
}

void torture_make_strands( torture_builder* b )
{
    text_node* entry = begin_entry( b, "hair" );
    strands_maker m = { b, entry, torture_entry_block( "strands", entry ), 0, 0 };
    const bool is_frozen = torture_chance( b, 15 );
    put_groom( &m, is_frozen );
    if ( is_frozen )
    {
        put_frozen_hair( &m );
    }
    else
    {
        put_dynamics( &m );
    }
    if ( torture_chance( m.b, 15 ) )
    {
        torture_put_block( b, m.block, entry, "appearance", 40 );
    }
    const char* source = text_at( entry, "name" );
    if ( !is_frozen && torture_chance( m.b, 35 ) )
    {
        make_followers( b, source );
    }
    if ( torture_chance( m.b, 15 ) )
    {
        make_curves( b, source );
    }
}
