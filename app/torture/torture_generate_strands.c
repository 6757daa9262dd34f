#include "torture_builder.h"

#include <stdlib.h>
#include <string.h>

typedef struct strands_maker
{
    torture_builder* b;
    text_node* entry;
    torture_block block;
    int strands, vertices;
} strands_maker;

static bool chance( strands_maker* m, int percent )
{
    return torture_random_chance( &m->b->random, percent );
}

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
    if ( chance( m, 70 ) )
    {
        torture_put_log( m->b, dynamics, "damping", 0.5, 10.0 );
    }
    if ( m->strands * m->vertices < 60 && chance( m, 10 ) )
    {
        put_masses( m, dynamics );
    }
    const bool is_free = strcmp( text_at( dynamics, "free_roots" ), "true" ) == 0;
    if ( m->b->surfaces->count > 0 && chance( m, 30 ) && is_free == false )
    {
        text_put( m->entry, "on_surface", text_scalar( "%s", text_at( m->b->surfaces->children[0], "name" ) ) );
    }
    else if ( chance( m, 60 ) )
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
        if ( ( !is_contact || m->b->has_contact ) && chance( m, percents[i] ) )
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
        if ( chance( m, 60 ) )
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
    if ( chance( m, 40 ) )
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
    if ( chance( &m, 25 ) )
    {
        torture_put_block( b, m.block, entry, "collision", 30 );
    }
    if ( chance( &m, 20 ) )
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
    const bool is_frozen = torture_random_chance( &b->random, 15 );
    put_groom( &m, is_frozen );
    if ( is_frozen )
    {
        put_frozen_hair( &m );
    }
    else
    {
        put_dynamics( &m );
    }
    if ( chance( &m, 15 ) )
    {
        torture_put_block( b, m.block, entry, "appearance", 40 );
    }
    const char* source = text_at( entry, "name" );
    if ( !is_frozen && chance( &m, 35 ) )
    {
        make_followers( b, source );
    }
    if ( chance( &m, 15 ) )
    {
        make_curves( b, source );
    }
}
