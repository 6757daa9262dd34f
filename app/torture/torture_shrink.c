#include "torture_shrink.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct shrinker
{
    const torture_shrink_def* def;
    text_node* scene;
    int tries;
    double end;
} shrinker;

static bool has_time( const shrinker* s )
{
    return s->tries < s->def->max_tries && wisp_clock_seconds() < s->end;
}

static bool shows( shrinker* s )
{
    ++s->tries;
    return s->def->shows( s->def->user, s->scene );
}

// ---- parts that go ----

// Put a child back where it was.
static void insert( text_node* parent, int place, text_node* child )
{
    text_add( parent, child );
    for ( int i = parent->count - 1; i > place; --i )
    {
        parent->children[i] = parent->children[i - 1];
    }
    parent->children[place] = child;
}

static bool try_without( shrinker* s, text_node* parent, int place )
{
    text_node* child = parent->children[place];
    --parent->count;
    memmove( parent->children + place, parent->children + place + 1,
             (size_t)( parent->count - place ) * sizeof *parent->children );
    if ( shows( s ) )
    {
        text_release( child );
        return true;
    }
    insert( parent, place, child );
    return false;
}

// Outer parts first: an entry that goes takes all of its keys with it. Later ones may name earlier ones, so they go
// first.
static bool take_out( shrinker* s, text_node* node )
{
    bool has_changed = false;
    for ( int i = node->count - 1; i >= 0 && has_time( s ); --i )
    {
        const bool is_vector = node->kind == TEXT_LIST && text_is_number( node->children[i], NULL );
        has_changed |= !is_vector && try_without( s, node, i );
    }
    for ( int i = node->count - 1; i >= 0 && has_time( s ); --i )
    {
        has_changed |= take_out( s, node->children[i] );
    }
    return has_changed;
}

// ---- numbers that get simpler ----

static bool is_simpler( const char* text, const char* than )
{
    double a = strtod( text, NULL ), b = strtod( than, NULL );
    const bool are_whole =
        strspn( text, "0123456789" ) == strlen( text ) && strspn( than, "0123456789" ) == strlen( than );
    return are_whole
               ? a < b
               : strlen( text ) < strlen( than ) || ( strlen( text ) == strlen( than ) && fabs( a ) < fabs( b ) );
}

static bool try_text( shrinker* s, text_node* scalar, const char* text )
{
    if ( !has_time( s ) || !is_simpler( text, scalar->text ) )
    {
        return false;
    }
    char before[64];
    snprintf( before, sizeof before, "%s", scalar->text );
    text_set( scalar, text );
    if ( shows( s ) )
    {
        return true;
    }
    text_set( scalar, before );
    return false;
}

// Nothing, one digit, two digits; of a whole number also its half and the one below.
static bool simplify_number( shrinker* s, text_node* scalar, double value )
{
    char candidates[5][64];
    const bool is_whole = value >= 2.0 && value == floor( value ) && value < 1e9;
    int count = 0;
    snprintf( candidates[count++], sizeof candidates[0], "0" );
    if ( is_whole )
    {
        snprintf( candidates[count++], sizeof candidates[0], "%.0f", floor( value / 2.0 ) );
        snprintf( candidates[count++], sizeof candidates[0], "%.0f", value - 1.0 );
    }
    else
    {
        snprintf( candidates[count++], sizeof candidates[0], "%.1g", value );
        snprintf( candidates[count++], sizeof candidates[0], "%.2g", value );
    }
    for ( int i = 0; i < count; ++i )
    {
        if ( try_text( s, scalar, candidates[i] ) )
        {
            return true;
        }
    }
    return false;
}

static bool simplify( shrinker* s, text_node* node )
{
    double value;
    if ( text_is_number( node, &value ) && strlen( node->text ) < 60 )
    {
        return simplify_number( s, node, value );
    }
    bool has_changed = false;
    for ( int i = 0; i < node->count && has_time( s ); ++i )
    {
        has_changed |= simplify( s, node->children[i] );
    }
    return has_changed;
}

int torture_shrink( const torture_shrink_def* def, text_node* scene )
{
    shrinker s = { def, scene, 0, wisp_clock_seconds() + def->max_seconds };
    for ( bool has_changed = true; has_changed && has_time( &s ); )
    {
        has_changed = take_out( &s, scene );
        has_changed |= simplify( &s, scene );
    }
    return s.tries;
}
