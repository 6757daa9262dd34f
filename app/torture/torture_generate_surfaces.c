#include "torture_builder.h"

#include <stdlib.h>
#include <string.h>

typedef struct surface_maker
{
    torture_builder* b;
    text_node* entry;
    torture_block block;
    double place[3];
} surface_maker;

static bool chance( surface_maker* m, int percent )
{
    return torture_random_chance( &m->b->random, percent );
}

// ---- where ----

static void put_transform( surface_maker* m, int number )
{
    text_node* transform = text_put( m->entry, "transform", text_map() );
    if ( chance( m, 50 ) )
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
    if ( columns && chance( m, 50 ) )
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
    if ( chance( m, 45 ) )
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
    if ( !is_instance && chance( m, 20 ) )
    {
        put_coarse_sheets( m, cloth );
    }
}

static void put_balloon( surface_maker* m )
{
    text_node* balloon = torture_put_block( m->b, m->block, m->entry, "balloon", 25 );
    torture_put_linear( m->b, balloon, "gas_ratio", 1.0, 1.6 );
    if ( chance( m, 25 ) )
    {
        text_node* list = text_put( balloon, "gas_ratio_keyframes", text_list() );
        for ( int i = 0; i < 3; ++i )
        {
            text_node* pair = text_add( list, text_list() );
            text_add( pair, text_scalar( "%.3g", 0.4 * i ) );
            text_add( pair, text_scalar( "%s", torture_random_linear( &m->b->random, 1.0, 1.8 ).text ) );
        }
    }
    if ( chance( m, 10 ) )
    {
        torture_put_log( m->b, balloon, "inflation_rate", 1e-5, 1e-2 );
    }
    if ( chance( m, 25 ) )
    {
        torture_put_vector( m->b, balloon, "outlet_nearest", ( const double[] ){ -0.2, 0, -0.2 },
                            ( const double[] ){ 0.2, 0.6, 0.2 } );
        text_put( balloon, "outlet_open", text_scalar( "%s", chance( m, 50 ) ? "true" : "false" ) );
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
    if ( !is_plane || strcmp( text_at( implicit, "stiffness_model" ), "material" ) == 0 )
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
    if ( chance( m, 65 ) )
    {
        torture_put_log( m->b, m->entry, "damping", 0.5, 10.0 );
    }
    if ( chance( m, 85 ) )
    {
        text_node* collision = torture_put_block( m->b, m->block, m->entry, "collision", 25 );
        if ( is_implicit )
        {
            text_remove_key( collision, "features" );
        }
    }
    if ( m->b->has_contact && chance( m, 80 ) )
    {
        text_node* contact = torture_put_block( m->b, m->block, m->entry, "contact", 25 );
        torture_put_log( m->b, contact, "thickness", 1e-3, 5e-3 );
    }
    if ( !is_implicit && chance( m, 15 ) )
    {
        put_strain_limit( m );
    }
    if ( chance( m, 20 ) )
    {
        torture_put_block( m->b, m->block, m->entry, "sleep", 30 );
    }
    if ( chance( m, 8 ) )
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
    text_put( generate, "shape", text_scalar( "%s", chance( &m, 50 ) ? "plane" : "alternating_plane" ) );
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
    const bool is_instance = first && text_find( first, "generate" ) && text_find( first, "balloon" ) &&
                             torture_random_chance( &b->random, 30 );
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
    const bool is_pinned = torture_random_chance( &b->random, is_balloon ? 20 : 55 ) && put_pins( &m );
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
